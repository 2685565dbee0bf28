"""User input: each way to write it is accepted, wrong input is refused with a message of the
engine, and data may have any size on every route to a solution.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

import sie
from tests.sie.routes import ROUTES

ONE = sie.Zones.of([[0.3, 1.0]], sie.SINGULAR, sie.SINGULAR)
TWO = sie.Zones.of([[0.3, 1.0], [1.2, 2.0]], sie.SINGULAR, sie.SINGULAR)
OF_LAG = sie.Smooth(lambda x, xi: 0.3 * np.sin(x - xi), of_lag=True)
OF_BOTH = sie.Smooth(
    lambda x, xi: 0.2 * np.cos(x) * xi,
    lambda x, xi: 0.2 * np.sin(x) * xi,
    lambda x, xi: -0.2 * np.sin(x) * xi,
)
X = np.linspace(0.35, 0.95, 7)[:, None]


# Data of any size
# ---------------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("size", [2.0**664, 2.0**-664], ids=["large", "small"])
@pytest.mark.parametrize("route", ROUTES)
def test_scaled_data_scale_the_density_and_keep_the_ends_and_the_error(route, size):
    tol = 1e-8
    one, many = (sie.solve(*ROUTES[route](a)[:2], tol, **ROUTES[route](a)[2]) for a in (1.0, size))
    width = np.diff(one.zones.table)
    assert np.abs(many.zones.table - one.zones.table).max() <= 10 * tol * width.max()
    # Scaling by a power of two does not change the round-off.
    assert many.error == pytest.approx(one.error, rel=1e-6, abs=1e-13)
    scale = np.abs(one.density.totals).max() + one.state.size
    assert np.abs(many.density.totals / size - one.density.totals).max() <= 10 * tol * scale


@pytest.mark.parametrize("size", [1e200, 1e-200])
def test_columns_may_have_any_size(size):
    equation, zones, _ = ROUTES["column"](1.0)
    large = replace(equation, columns=(lambda x: size / (x * x + 2),))
    one, other = sie.solve(equation, zones), sie.solve(large, zones)
    assert other.amplitudes * size == pytest.approx(one.amplitudes, rel=1e-9)


# Kernels
# ------------------------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("kernel", "rest"),
    [
        (sie.cauchy() + OF_LAG, lambda x, xi: OF_LAG.value(x, xi)),
        (OF_LAG + sie.cauchy(), lambda x, xi: OF_LAG.value(x, xi)),
        (sie.cauchy() - OF_LAG, lambda x, xi: -OF_LAG.value(x, xi)),
        (
            sie.cauchy() + 2 * OF_LAG - OF_BOTH / 4,
            lambda x, xi: 2 * OF_LAG.value(x, xi) - 0.25 * OF_BOTH.value(x, xi),
        ),
        (
            sie.cauchy() + (OF_LAG - OF_BOTH) * np.float64(3),
            lambda x, xi: 3 * (OF_LAG.value(x, xi) - OF_BOTH.value(x, xi)),
        ),
        (sie.cauchy() + (lambda x, xi: x * xi), lambda x, xi: x * xi),
        ((lambda x, xi: x * xi) + sie.cauchy(), lambda x, xi: x * xi),
        (
            sie.cauchy() + -OF_BOTH + OF_LAG,
            lambda x, xi: OF_LAG.value(x, xi) - OF_BOTH.value(x, xi),
        ),
    ],
)
def test_smooth_kernels_add_and_scale_like_the_functions_that_they_are(kernel, rest):
    assert kernel.poles == (0.0,)
    assert kernel.regular(X, X.T) == pytest.approx(rest(X, X.T))


def test_a_sum_of_smooth_kernels_keeps_the_declarations_that_hold_for_both():
    assert (OF_LAG - 2 * OF_LAG).of_lag and not (OF_LAG + OF_BOTH).of_lag
    assert (OF_LAG + OF_BOTH).potential is None and (OF_BOTH - 2 * OF_BOTH).potential(
        X, X.T
    ) == pytest.approx(-OF_BOTH.potential(X, X.T))
    assert (3 * OF_BOTH).slope(X, X.T) == pytest.approx(3 * OF_BOTH.slope(X, X.T))
    assert (replace(OF_LAG, length=0.5) + replace(OF_BOTH, length=0.1)).length == 0.1


@pytest.mark.parametrize(
    "made",
    [
        lambda k: 2 * k,
        lambda k: k * 2,
        lambda k: -k,
        lambda k: k / 2,
        lambda k: OF_LAG - k,
        lambda k: k - k,
        lambda k: k + k,
        lambda k: np.float64(2) * k,
        lambda k: np.ones(3) * k,
    ],
)
@pytest.mark.parametrize(
    "kernel",
    [sie.cauchy(), sie.hilbert(2.0), sie.cauchy() + OF_LAG],
    ids=["cauchy", "hilbert", "sum"],
)
def test_the_weight_of_a_pole_is_one_and_the_refusal_says_what_to_divide(made, kernel):
    with pytest.raises(ValueError, match="has the weight 1.*divide the equation by the factor"):
        made(kernel)


@pytest.mark.parametrize(
    ("kernel", "message"),
    [
        (OF_LAG, "a smooth kernel alone"),
        (lambda x, xi: x * xi, "a smooth kernel alone"),
        (sie.cauchy, "call it"),
        (None, "a sie.Kernel"),
        ("cauchy", "a sie.Kernel"),
    ],
)
def test_an_equation_without_a_pole_is_refused(kernel, message):
    with pytest.raises(ValueError, match=message):
        sie.Equation(kernel, np.sin, sie.Total(1.0))


# Lists, numbers, functions
# ------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    "jumps",
    [
        ([0.0], [2.0]),
        (0, 2),
        ((0.0,), 2.0),
        (np.array([0]), np.array([2])),
        ([0.0], [2], [0]),
        ([0.0], 2.0, 0),
    ],
)
def test_jumps_are_arrays_lists_or_numbers(jumps):
    wedge = sie.Forcing(np.sign, np.abs, sie.Jumps(*jumps))
    found = sie.solve(
        sie.Equation(sie.cauchy(), wedge, sie.Total(2.0)), sie.Zones.of([[-0.5, 2.0]])
    )
    assert found.zones.table == pytest.approx(np.array([[-1.0, 1.0]]), abs=1e-9)


def test_one_height_or_order_stands_for_all_places():
    jumps = sie.Jumps([0.1, 0.2, 0.3], 1.5, 2)
    assert jumps.heights.tolist() == [1.5] * 3 and jumps.orders.tolist() == [2] * 3


@pytest.mark.parametrize(
    ("make", "options", "message"),
    [
        (
            sie.Jumps,
            {"at": [0.0, 1.0], "heights": [1.0]},
            "heights must be one number for each position",
        ),
        (
            sie.Jumps,
            {"at": [0.0], "heights": [1.0, 2.0]},
            "heights must be one number for each position",
        ),
        (sie.Jumps, {"at": [0.0], "heights": [1.0], "orders": [3]}, "orders must be 0, 1 or 2"),
        (sie.Jumps, {"at": [0.0], "heights": [1.0], "orders": [0.5]}, "orders must be 0, 1 or 2"),
        (sie.Jumps, {"at": [0.0], "heights": [1.0], "orders": [-1]}, "orders must be 0, 1 or 2"),
        (sie.Jumps, {"at": [math.nan], "heights": [1.0]}, "at must be an array"),
        (sie.Jumps, {"at": ["a"], "heights": [1.0]}, "at must be real numbers"),
        (sie.Jumps, {"at": [[0.0], [0.0, 1.0]], "heights": [1.0]}, "at must be an array"),
        (sie.Jumps, {"singular_at": [1j]}, "singular_at must be real"),
        (sie.Resolution, {"modes": 0}, "modes must be a whole number"),
        (sie.Resolution, {"length": -1.0}, "length must be"),
        (partial(sie.Forcing, np.sin), {"within": (1.0, 0.0)}, "within must be"),
        (partial(sie.Forcing, np.sin), {"within": 3}, "within must be"),
        (partial(sie.Forcing, np.sin), {"jumps": [0.0]}, "jumps must be a sie.Jumps"),
        (partial(sie.Forcing, np.sin), {"resolution": 0.1}, "resolution must be a sie.Resolution"),
    ],
)
def test_wrong_declarations_are_refused_by_name(make, options, message):
    with pytest.raises(ValueError, match=message):
        make(**options)


def test_functions_stand_for_right_sides_and_columns_and_one_condition_for_a_tuple():
    plain = sie.Equation(sie.cauchy(), np.ones_like, sie.Total(0.0))
    wrapped = sie.Equation(sie.cauchy(), sie.Forcing(np.ones_like), (sie.Total(0.0),))
    assert sie.solve(plain, ONE).density(X) == pytest.approx(sie.solve(wrapped, ONE).density(X))
    with_column = sie.Equation(
        sie.cauchy(), np.sin, [sie.Total(0.0), sie.moment(1.0)], np.ones_like
    )
    assert sie.solve(with_column, ONE).amplitudes.shape == (1,)


@pytest.mark.parametrize(
    ("made", "message"),
    [
        (
            lambda: sie.Equation(sie.cauchy(), 1.0, ()),
            "the right side must be a sie.Forcing or a function of x, got 1.0",
        ),
        (lambda: sie.Equation(sie.cauchy(), np.sin, (sie.Total,)), "a side condition must be"),
        (lambda: sie.Equation(sie.cauchy(), np.sin, (1.0,)), "a side condition must be"),
        (lambda: sie.Equation(sie.cauchy(), np.sin, (), (), 3), "a condition on the ends must be"),
        (lambda: sie.Equation(sie.cauchy(), np.sin, (), (3,)), "column 0 must be"),
        (lambda: sie.Total(math.nan), "Total: its value"),
        (lambda: sie.Total("a"), "Total: its value"),
        (lambda: sie.Level(1j * np.nan), "Level: its"),
        (lambda: sie.ZoneTotals("ab"), "ZoneTotals"),
        (lambda: sie.Weighted(1.0, 1.0), "weight must be a function"),
        (lambda: sie.Weighted(np.sin, 1.0, degree=-1), "degree must be"),
        (lambda: sie.TotalWidth(-1.0), "TotalWidth"),
        (lambda: sie.Amplitude(0.5), "Amplitude: its column"),
        (lambda: sie.moment(None), "moment"),
        (lambda: sie.Zones.of([["a", "b"]]), "zones must be real numbers"),
        (lambda: sie.Zones.of([[0, 1], [2]]), "zones must be an array"),
        (lambda: sie.Zones.of([[0, 1j]]), "zones must be real"),
        (lambda: sie.Zones.of([[0, 1e-200]]), "zones must be wider"),
        (lambda: sie.Zones.of([[-1.7e308, 1.7e308]]), "last end must be finite"),
        (lambda: sie.Zones.of([[0, 1]], "free"), "kinds of ends"),
        (lambda: sie.Zones.of([[0, 1]], 5), "kinds of ends"),
        (lambda: sie.free_with_intensity(math.inf), "intensity"),
        (lambda: sie.images(1.0, 2.5), "neighbours"),
        (lambda: sie.images("a", 2), "period"),
        (lambda: sie.cauchy("a"), "datum"),
        (lambda: sie.Smooth(3), "must be a function"),
        (lambda: sie.Smooth(np.add, length=-1), "length"),
    ],
)
def test_wrong_parts_are_value_errors_that_name_them(made, message):
    with pytest.raises(ValueError, match=message):
        made()


def test_a_function_that_takes_numbers_only_is_named():
    with pytest.raises(
        ValueError, match=r"the right side: value fails for arrays of shape \(3,\): TypeError"
    ):
        sie.solve(sie.Equation(sie.cauchy(), math.sin, sie.Total(1.0)), ONE)


# Claims
# -------------------------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    "zones",
    [ONE, TWO, sie.Zones.of([[i, i + 0.5] for i in range(50)], sie.SINGULAR, sie.SINGULAR)],
    ids=len,
)
def test_false_claims_are_refused_and_true_ones_accepted(zones):
    def solve(kernel=None, conditions=(), columns=()):
        return sie.solve(
            sie.Equation(
                kernel or sie.cauchy(), np.sin, (*conditions, sie.ZoneTotals(1.0)), columns
            ),
            zones,
            1e-8,
        )

    with pytest.raises(ValueError, match="declared to depend on x - xi alone"):
        solve(sie.cauchy() + sie.Smooth(lambda x, xi: x * xi + x**2, of_lag=True))
    with pytest.raises(ValueError, match="weight is not a polynomial of degree 1: on zone 0"):
        solve(None, (sie.Weighted(lambda x: x**6, 1.0, degree=1),), (np.cos,))
    with pytest.raises(ValueError, match="column 0 has more than modes=1 modes"):
        solve(
            None,
            (sie.moment(1.0),),
            (sie.Forcing(lambda x: x, resolution=sie.Resolution(modes=1)),),
        )
    solve(sie.cauchy() + sie.Smooth(lambda x, xi: 1e-3 * (x - xi) ** 2, of_lag=True))
    solve(
        None,
        (sie.Weighted(lambda x: x**2 - 1, 1.0, degree=2),),
        (sie.Forcing(lambda x: x, resolution=sie.Resolution(modes=2)),),
    )


def test_true_claims_are_accepted_for_narrow_zones_far_from_the_origin():
    zones = sie.Zones.of([[1e6, 1e6 + 1e-3], [1e6 + 2e-3, 1e6 + 3e-3]], sie.SINGULAR, sie.SINGULAR)
    kernel = sie.cauchy() + sie.Smooth(lambda x, xi: 1e3 * np.sin(1e3 * (x - xi)), of_lag=True)
    conditions = (
        sie.Total(1.0),
        sie.moment(1e-3, about=1e6),
        sie.Weighted(lambda x: (x - 1e6) ** 2, 0.0, degree=2),
    )
    sie.solve_fixed(
        sie.Equation(
            kernel,
            np.zeros_like,
            conditions,
            sie.Forcing(lambda x: x - 1e6, resolution=sie.Resolution(modes=2)),
        ),
        zones,
    )
