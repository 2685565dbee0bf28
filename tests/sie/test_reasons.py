"""The reasons that `NotConverged` gives. Each reason is given for problems that it describes,
and for no others.
"""

from __future__ import annotations

import numpy as np
import pytest

import sie

S, B = sie.SINGULAR, sie.BOUNDED
ONE = sie.Zones.of([[-1.0, 1.0]], S, S)
TWO = sie.Zones.of([[-1.0, 1.0], [2.0, 3.0]], S, S)
COLUMN = (sie.Total(0.0), sie.moment(1.0))


def noise(size):
    """A function whose values are normal random numbers times `size`, anew at every call."""
    draws = np.random.default_rng(0)
    return lambda *places: (
        size * draws.standard_normal(np.broadcast_shapes(*(np.shape(x) for x in places)))
    )


CRACK = sie.Total(0.0)


def equation(value=np.ones_like, conditions=CRACK, regular=None, columns=()):
    kernel = sie.cauchy() if regular is None else sie.cauchy() + sie.Smooth(regular)
    return sie.Equation(kernel, value, conditions, columns)


NOISY = noise(1e-9)
CASES = {
    "jump": (
        equation(lambda x: np.sign(x - 0.2)),
        ONE,
        1e-10,
        "coefficients of the right side .* jumps",
    ),
    "noisy": (
        equation(lambda x: np.sin(x) + NOISY(x)),
        ONE,
        1e-10,
        "coefficients of the right side .* no longer decay: the right side is rounded or noisy",
    ),
    "too fast": (
        equation(lambda x: 1 / (x * x + 1e-8)),
        ONE,
        1e-10,
        "coefficients of the right side .* varies too fast",
    ),
    "end": (
        equation(lambda x: 1 / (1 + x)),
        ONE,
        1e-10,
        "coefficients of the right side .* is singular",
    ),
    "declared": (
        equation(sie.Forcing(np.sin, jumps=sie.Jumps(0.1, 1.0))),
        ONE,
        1e-10,
        "right side without its 1 declared jumps",
    ),
    "kernel": (
        equation(regular=lambda x, xi: np.sin(1e3 * x * xi)),
        ONE,
        1e-10,
        "767 modes of the kernel's regular part .* varies too fast",
    ),
    "rounded kernel": (
        equation(regular=lambda x, xi: 1e12 + 0 * x * xi),
        ONE,
        1e-10,
        "rounding limits the accuracy: terms of the size 1.0e[+]12",
    ),
    "column": (
        equation(np.sin, COLUMN, None, lambda x: 1 / (x * x + 1e-7)),
        ONE,
        1e-10,
        "767 modes of a column .* varies too fast",
    ),
    "conditions": (
        equation(conditions=(sie.Total(1.0), sie.Weighted(lambda x: 1 + 1e-9 * x, 1.0))),
        TWO,
        1e-10,
        "conditions nearly depend on each other",
    ),
    "near": (
        equation(sie.Forcing(np.zeros_like, np.zeros_like), (sie.Total(1.0), sie.EqualPotential())),
        sie.Zones.of([[-1, 0], [1e-13, 1]], S, S),
        1e-10,
        "rounding limits the accuracy beside narrow gaps",
    ),
    "places": (
        equation(np.sin),
        sie.Zones.of([[1e15, 1e15 + 8]], S, S),
        1e-12,
        "positions on zone 0 .* are rounded to",
    ),
    "far ends": (
        equation(lambda x: x - 1e8, sie.Total(1.0)),
        sie.Zones.of([[1e8 - 0.5, 1e8 + 1]]),
        1e-12,
        "rounding leaves the ends of zone 0",
    ),
    "rounding": (equation(), ONE, 1e-16, "rounding limits the accuracy"),
    "rounding of rows": (
        equation(conditions=sie.ZoneTotals(0.0)),
        TWO,
        1e-16,
        "rounding limits the accuracy: terms of the size",
    ),
    "signs": (
        equation(conditions=sie.Total(1.0)),
        sie.Zones.of([[-1.0, 1.0]]),
        1e-10,
        "the density does not have the sign given by `signs`",
    ),
    "steps": (
        equation(conditions=()),
        sie.Zones.of([[-1.0, 1.0]], B),
        1e-10,
        "did not converge in [0-9]+ steps",
    ),
    "lost": (
        equation(lambda x: x**3 - x - 0.5, (sie.ZoneTotals((1e-9, 1.0)),)),
        sie.Zones.of([[-1, -0.8], [1, 1.4]]),
        1e-10,
        "a zone has vanished|did not converge",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_the_reason_is_the_one_that_holds(case):
    """The message names the cause of the failure. It mentions the right side only if the right
    side is the cause.
    """
    of, zones, tol, words = CASES[case]
    with pytest.raises(sie.NotConverged, match=words) as stopped:
        sie.solve(of, zones, tol)
    assert len(stopped.value.reason) < 400
    if case not in {"jump", "noisy", "too fast", "end", "declared"}:
        assert "right side" not in stopped.value.reason


def test_a_noisy_kernel_is_not_blamed_on_the_right_side():
    noisy = noise(1e-10)
    kernel = sie.cauchy() + sie.Smooth(
        lambda x, xi: (1 + noisy(x, xi)) / ((x - xi) ** 2 + 0.01), length=0.1
    )
    for tol in (1e-8, 1e-10):
        with pytest.raises(sie.NotConverged) as stopped:
            sie.solve(sie.Equation(kernel, lambda x: 1 / (x * x + 0.01), sie.Total(1.0)), ONE, tol)
        assert "right side" not in stopped.value.reason


def test_a_large_kernel_is_no_singular_system():
    found = sie.solve(equation(regular=lambda x, xi: 1e6 * np.cos(x) * np.cos(xi)), ONE, 1e-5)
    # Terms of the size 1e6 add up to about 1, so the solution has a round-off of at least 1e-10.
    # The stated error is larger, as it also contains the condition number of the system.
    assert found.error < 1e-5


def test_a_singular_system_is_refused_with_its_cause():
    """A density in the null space of the equation and its conditions makes the system singular.
    The message says whether the side conditions alone are the cause.
    """
    dependent = (sie.Total(1.0), sie.Weighted(np.ones_like, 1.0))
    with pytest.raises(ValueError, match="the side conditions depend on each other"):
        sie.solve(equation(conditions=dependent), TWO)
    with pytest.raises(
        ValueError, match="some density .* contributes neither to the equation nor to the side"
    ):
        sie.solve(equation(conditions=dependent, regular=lambda x, xi: 0.1 * x * xi), TWO)


# Modes
# --------------------------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("count", "noisy"),
    [(1, 0.0), (3, 0.0), (1, 1e-10), pytest.param(3, 1e-10, marks=pytest.mark.slow)],
)
@pytest.mark.parametrize("tol", [1e-6, 1e-8, 1e-10])
def test_modes_stop_growing_where_the_kernel_has_nothing_but_rounding_left(count, tol, noisy):
    """The coefficients of the kernel fall as exp(-k/10), so 350 modes reach round-off. A tighter
    tolerance or a noisy kernel must not add modes without end.
    """
    draws = noise(noisy)
    kernel = sie.cauchy() + sie.Smooth(
        lambda x, xi: (1 + draws(x, xi)) / ((x - xi) ** 2 + 0.01), length=0.1
    )
    zones = sie.Zones.of([[3 * i - 1, 3 * i + 1] for i in range(count)], S, S)
    of = sie.Equation(kernel, lambda x: 1 / (x * x + 0.01), sie.ZoneTotals(1.0))
    try:
        found = sie.solve(of, zones, tol)
    except sie.NotConverged as stopped:
        assert noisy and stopped.best.error < 1e-5
        found = stopped.best
    assert found.state.system.layout.m.max() <= (1024 if noisy else 400)


def test_modes_grow_past_a_lull_of_the_coefficients():
    # The right side has a large coefficient at the degree 40, after much smaller ones. Its
    # effect through the smooth part of the kernel shows with more than 40 modes only. The term
    # 1 / (1.1 - x) makes the solver sample the right side at many nodes. At few nodes T_40 has
    # the same values as a polynomial of low degree.
    right = sie.Forcing(lambda x: np.cos(40 * np.arccos(np.clip(x, -1, 1))) + 1 / (1.1 - x))
    kernel = sie.cauchy() + sie.Smooth(lambda x, xi: 0.1 / ((x - xi) ** 2 + 0.04))
    assert sie.solve(sie.Equation(kernel, right, sie.Total(0.0)), ONE, 1e-9).error < 1e-9
