"""The function `sie.solve` for fixed and free ends: true errors are at most the stated error,
and the reason of a failure is given in words.
"""

import math

import numpy as np
import pytest

import sie
from tests.sie import exact

T = np.cos(np.pi * np.arange(1, 40) / 39.7)
EVERY_END = {
    "flat": (exact.Flat(1.3, 2.0), sie.SINGULAR, sie.SINGULAR),
    "crack": (exact.PeriodicCracks(0.45, 1.0), sie.SINGULAR, sie.SINGULAR),
    "tilted": (exact.Tilted(-1.0, 2.0), sie.BOUNDED, sie.SINGULAR),
    "hertz": (exact.Hertz(1.0), sie.FREE, sie.FREE),
    "wedge": (exact.Wedge(0.7), sie.FREE, sie.FREE),
    "two": (exact.TwoZones(0.3, 1.0), sie.FREE, sie.FREE),
    "wave": (exact.Westergaard(0.49, 1.0), sie.FREE, sie.FREE),
}


def problem(form):
    at, jumps = np.array(getattr(form, "jumps_at", ())), np.array(getattr(form, "jumps", ()))
    forcing = sie.Forcing(form.value, form.primitive, sie.Jumps(at, jumps))
    kernel = sie.cauchy() if form.period is None else sie.hilbert(form.period)
    conditions = (
        () if isinstance(form, exact.Tilted) else (sie.Total(form.total), sie.EqualPotential())
    )
    return sie.Equation(kernel, forcing, conditions)


def true_error(found, form):
    """The largest true error of the density and of the ends, from the closed form.
    `Solution.error` is a bound of it.
    """
    table = found.zones.table
    ends = np.abs(table - form.zones).max(axis=1) / (table[:, 1] - table[:, 0])
    root = np.sqrt(1 - T * T)
    of_density = max(
        np.abs((found.density.at_t(i, T) - form.at(T, i)) * root).max() for i in range(len(table))
    )
    return max(of_density / found.state.size, float(ends.max()))


@pytest.mark.parametrize("tol", [1e-6, 1e-10])
@pytest.mark.parametrize("name", EVERY_END)
def test_the_error_is_honest_and_within_the_tolerance(name, tol):
    form, left, right = EVERY_END[name]
    start = form.zones + (np.diff(form.zones) * [0.1, -0.15] if left is sie.FREE else 0.0)
    found = sie.solve(problem(form), sie.Zones.of(start, left, right), tol)
    assert true_error(found, form) <= found.error <= tol


def test_a_wrong_answer_does_not_pass_for_one_with_the_stated_error():
    form = exact.Hertz(1.0)
    found = sie.solve(problem(form), sie.Zones.of(form.zones * 1.1))
    assert true_error(found, exact.Hertz(1.0 + 1e-8)) > found.error


def test_an_unknown_total_is_found_with_the_zones():
    form = exact.Westergaard(0.2, 1.0)
    forcing = sie.Forcing(form.value, form.primitive)
    equation = sie.Equation(
        sie.hilbert(1.0), forcing, (sie.Total(None),), end_conditions=(sie.TotalWidth(0.4),)
    )
    found = sie.solve(equation, sie.Zones.of([[-0.3, 0.25]]), value=0.1)
    assert found.value == pytest.approx(form.total, rel=1e-9)


HERTZ = problem(exact.Hertz(1.0))
ONE = sie.Zones.of([[-1.0, 1.0]])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((None, ONE), "the equation must be a sie.Equation, got NoneType"),
        ((HERTZ, [[-1.0, 1.0]]), "the zones must be sie.Zones"),
        ((HERTZ, ONE, 0.0), "tol must be a number between 0 and 1, got 0.0"),
        ((HERTZ, ONE, math.nan), "tol must be a number between 0 and 1, got nan"),
        ((HERTZ, ONE, "fine"), "tol must be a number between 0 and 1, got 'fine'"),
        (
            (sie.Equation(sie.cauchy(), sie.Forcing(np.sin), ()), ONE),
            "1 side conditions are needed",
        ),
        (
            (sie.Equation(sie.cauchy(), sie.Forcing(lambda x: 1.0), (sie.Total(1.0),)), ONE),
            "must return",
        ),
        (
            (sie.Equation(sie.cauchy(), sie.Forcing(1.0), (sie.Total(1.0),)), ONE),
            "value must be a function of x, got float",
        ),
        (
            (sie.Equation(sie.cauchy(), sie.Forcing(lambda x: x * np.nan), (sie.Total(1.0),)), ONE),
            "not finite on the zones",
        ),
        (
            (sie.Equation(sie.cauchy(), sie.Forcing(lambda x: x), (sie.Level(0.0),)), ONE),
            "primitive",
        ),
        (
            (sie.Equation(sie.hilbert(1.0), sie.Forcing(lambda x: x), (sie.Total(1.0),)), ONE),
            "the zones extend over 2, .* less than the period 1",
        ),
    ],
)
def test_wrong_input_is_a_value_error_in_words(arguments, words):
    with pytest.raises(ValueError, match=words):
        sie.solve(*arguments)


@pytest.mark.parametrize(
    "options",
    [{"signs": (1, 0)}, {"signs": 1}, {"max_steps": 0}, {"max_steps": 2.5}, {"value": math.inf}],
)
def test_wrong_options_are_value_errors_that_name_them(options):
    (name,) = options
    with pytest.raises(ValueError, match={"value": "unknown value"}.get(name, name)):
        sie.solve(HERTZ, ONE, **options)


def test_a_search_that_stops_says_why_and_gives_its_best_state():
    with pytest.raises(sie.NotConverged, match="did not converge") as stopped:
        sie.solve(HERTZ, sie.Zones.of([[-1.0, 3.0]]), max_steps=1)
    best = stopped.value.best
    assert best.error == math.inf and best.zones.table.shape == (1, 2)


def test_a_zone_that_shrinks_away_is_named():
    # The profile has its lowest point on the right, at x = 1.19. Under so small a load, the zone
    # on the left does not touch.
    forcing = sie.Forcing(lambda x: x**3 - x - 0.5, lambda x: x**4 / 4 - x**2 / 2 - 0.5 * x)
    equation = sie.Equation(sie.cauchy(), forcing, (sie.Total(0.02), sie.EqualPotential()))
    with pytest.raises(sie.NotConverged, match=r"a zone has vanished \(zone 0, counted from 0\)"):
        sie.solve(equation, sie.Zones.of([[-1.0, -0.8], [1.0, 1.4]]))


def test_a_tolerance_below_rounding_is_refused_with_the_best_that_was_reached():
    with pytest.raises(sie.NotConverged, match="the stated error is .*rounding") as stopped:
        sie.solve(problem(exact.Westergaard(0.499, 1.0)), sie.Zones.of([[-0.45, 0.46]]), 1e-14)
    assert (
        true_error(stopped.value.best, exact.Westergaard(0.499, 1.0))
        < stopped.value.best.error
        < 1e-9
    )


def test_a_jump_that_is_not_declared_is_suspected_in_words():
    rough = sie.Equation(sie.cauchy(), sie.Forcing(lambda x: np.sign(x - 0.2)), (sie.Total(1.0),))
    with pytest.raises(
        sie.NotConverged,
        match="the last of 8191 coefficients of the right side .* declare such jumps",
    ):
        sie.solve(rough, sie.Zones.of([[-1.0, 1.0]], sie.SINGULAR, sie.SINGULAR))


def test_zones_too_close_for_their_modes_are_named(monkeypatch):
    monkeypatch.setattr("sie.slits.system.is_graded", lambda *_: False)
    still = sie.Forcing(np.zeros_like)
    close = sie.Zones.of([[-3.0, -2.0], [-1.0, 0.0], [1e-6, 1.0]], sie.SINGULAR, sie.SINGULAR)
    with pytest.raises(
        sie.NotConverged, match=r"zone [12] \(counted from 0\) lies so close to another zone"
    ):
        sie.solve(sie.Equation(sie.cauchy(), still, (sie.ZoneTotals((1.0, 1.0, -1.0)),)), close)


def test_conditions_that_depend_on_each_other_are_wrong_input():
    twice = sie.Equation(
        sie.cauchy(), sie.Forcing(np.sin), (sie.Total(1.0), sie.Weighted(np.ones_like, 1.0))
    )
    zones = sie.Zones.of([[-2.0, -1.0], [1.0, 2.0]], sie.SINGULAR, sie.SINGULAR)
    with pytest.raises(ValueError, match="depend on each other"):
        sie.solve(twice, zones)


@pytest.mark.parametrize("beside", [0.3, 1e-2, 1e-4])
@pytest.mark.parametrize("kernel", [sie.cauchy(), sie.hilbert(5.0)], ids=["cauchy", "hilbert"])
def test_a_right_side_that_is_singular_beside_a_zone_is_sampled_once(kernel, beside):
    # If `singular_at` is not declared, the right side is sampled again whenever the number of
    # nodes doubles. For an expensive right side, this takes most of the time.
    at = np.array([-1.5 - beside, 1.0 + beside])
    shifts = [0.0] if kernel.period is None else [-5.0, 0.0, 5.0]

    def value(x):
        return x + sum(np.log(np.abs(x - s - shift)) for s in at for shift in shifts)

    zones = sie.Zones.of([[-1.5, 1.0]], sie.SINGULAR, sie.SINGULAR)
    solved = [
        sie.solve_fixed(
            sie.Equation(kernel, sie.Forcing(value, jumps=sie.Jumps(**told)), (sie.Total(1.0),)),
            zones,
            1e-12,
        )
        for told in ({}, {"singular_at": at if kernel.period is None else at + 10.0})
    ]
    x = np.linspace(-1.4, 0.9, 7)
    assert solved[1].density(x) == pytest.approx(solved[0].density(x), rel=1e-11)
    sampled = [state.sizes.profile_evaluations for state in solved]
    assert sampled[1] == solved[1].sizes.own[0] < 0.7 * sampled[0]


@pytest.mark.parametrize("gap", [1e-2, 1e-3, 1e-4, 1e-5, 1e-9])
def test_tandem_aerofoils_with_hardly_a_gap_between_them(gap):
    """Plates [a, b] in a uniform stream, each with a Kutta condition at b, have as density the
    product of sqrt(|x - b| / |x - a|) over all plates, apart from the sign.
    """
    theta = np.linspace(0.01, np.pi - 0.01, 300)
    left, right = 2 * np.cos(theta / 2) ** 2, 2 * np.sin(theta / 2) ** 2
    zones = sie.Zones.of([[-1.0, 0.0], [gap, 1.2]], sie.SINGULAR, sie.BOUNDED)
    found = sie.solve(sie.Equation(sie.cauchy(), sie.Forcing(np.ones_like, lambda x: x), ()), zones)
    (first, second), (a, b) = zones.half, (left, right)
    others = (
        np.sqrt((first * b + 2 * second + gap) / (first * b + gap)),
        np.sqrt((second * a + gap) / (second * a + gap + 2 * first)),
    )
    for zone, other in enumerate(others):
        missed = (
            np.abs(found.density.at(zone, left, right)) - np.sqrt(right / left) * other
        ) * np.sin(theta)
        assert np.abs(missed).max() < found.error * found.state.size
