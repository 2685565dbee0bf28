"""Free ends stay inside the interval `within` where the right side is defined. If the solution
lies at its border or beyond, the message says so.
"""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import sie

POSITIVE = (0.0, np.inf)


def logit(x):
    return np.log(x / (1 - x))


def problem(value, within, total, calls=None):
    def watched(x):
        if calls is not None:
            calls.append((float(x.min()), float(x.max())))
        return value(x)

    return sie.Equation(sie.cauchy(), sie.Forcing(watched, within=within), sie.Total(total))


@pytest.mark.parametrize("start", [[0.5, 2.0], [0.9, 1.1], [0.01, 30.0], [1e-3, 0.1]])
@pytest.mark.parametrize("total", [0.01, 0.3, 1.0, 5.0])
def test_ends_on_a_logarithm_are_found_from_any_guess_and_no_call_leaves_its_domain(total, start):
    """A bounded density exists only if the integral of g / sqrt((x - a)(b - x)) over the zone
    vanishes.

    For g = log x this integral is 2 pi log((sqrt(a) + sqrt(b)) / 2).
    """
    calls = []
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = sie.solve(problem(np.log, POSITIVE, total, calls), sie.Zones.of([start]))
    a, b = found.zones.table[0]
    assert np.sqrt(a) + np.sqrt(b) == pytest.approx(2.0, abs=10 * found.error * (b - a) + 1e-13)
    assert found.density.total == pytest.approx(total, rel=1e-9)
    assert min(low for low, _ in calls) > 0.0


@pytest.mark.parametrize(
    ("value", "within", "total", "names"),
    [
        (np.log, POSITIVE, 20.0, "the left end of zone 0"),
        (logit, (0.0, 1.0), 5.0, "the left end of zone 0 .* and the right end of zone 0"),
        (
            lambda x: x + 0 * np.sqrt(1 - x * x),
            (-1.0, 1.0),
            5.0,
            "the left end of zone 0 .* and the right end",
        ),
        (lambda x: np.log(2 - x) * -1, (-np.inf, 2.0), 20.0, "the right end of zone 0"),
    ],
)
def test_a_root_at_the_border_or_beyond_it_is_reported(value, within, total, names):
    calls = []
    with pytest.raises(
        sie.NotConverged,
        match=f"{names}.* would leave the interval .*: the root lies outside, at a limit",
    ) as stopped:
        sie.solve(problem(value, within, total, calls), sie.Zones.of([[0.4, 0.8]]))
    best = stopped.value.best
    assert within[0] < best.zones.a[0] and best.zones.b[0] < within[1]
    assert min(low for low, _ in calls) > within[0] and max(high for _, high in calls) < within[1]


def test_a_search_that_ends_early_does_not_say_where_the_root_lies():
    with pytest.raises(
        sie.NotConverged,
        match="did not converge in 2 steps; .* would leave the interval .*, although the root may",
    ):
        sie.solve(problem(np.log, POSITIVE, 3.0), sie.Zones.of([[0.02, 0.1]]), max_steps=1)


def test_without_the_declaration_the_place_where_the_right_side_is_not_finite_is_named():
    equation = sie.Equation(sie.cauchy(), np.log, sie.Total(20.0))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(
            sie.NotConverged,
            match="the right side is not finite on the zones, for example at x = -",
        ):
            sie.solve(equation, sie.Zones.of([[0.5, 2.0]]))


def test_zones_outside_the_domain_are_refused():
    with pytest.raises(ValueError, match="do not lie inside the interval `within`"):
        sie.solve(problem(np.log, POSITIVE, 1.0), sie.Zones.of([[-0.5, 2.0]]))


@pytest.mark.parametrize("count", [4, 40])
def test_several_zones_stay_inside_the_domain_of_the_right_side_and_of_the_columns(count):
    """The right side is never evaluated outside `within`, with few zones and with many. The
    domain of an equation is the intersection of the domains of its right side and its columns.
    """

    def inside(x):
        assert x.min() > 0.0 and x.max() < count
        return np.sin(2 * np.pi * (x - 0.5)) + 0 * np.log(x * (count - x))

    value = sie.Forcing(inside, within=(0.0, float(count)))
    table = [[i + 0.2 + 0.2 * (i % 3 == 0), i + 0.9 - 0.05 * (i % 2)] for i in range(count)]
    found = sie.solve(
        sie.Equation(sie.cauchy(), value, sie.ZoneTotals(0.1)), sie.Zones.of(table), 1e-8
    )
    assert found.error < 1e-8
    assert sie.Equation(
        sie.cauchy(), np.sin, (), (value, sie.Forcing(np.sin, within=(-1.0, 2.0)))
    ).within == (0.0, 2.0)
