"""Derivatives of solutions of equations with kappa, compared with closed forms and with
differences of fourth order.
"""

import numpy as np
import pytest

import sie

S, B = sie.SINGULAR, sie.BOUNDED
KAPPA = 0.6
ALPHA = np.arctan2(1.0, KAPPA) / np.pi


def test_ends_of_a_sliding_cylinder_by_its_load():
    """Under the load P = 2 pi alpha (1 - alpha) l^2 the cylinder touches from -2 alpha l to
    2 (1 - alpha) l.
    """
    load = 3.0
    half = np.sqrt(load / (2 * np.pi * ALPHA * (1 - ALPHA)))
    slid = sie.Equation(sie.cauchy(), lambda x: x, sie.Total(load), kappa=KAPPA)
    found = sie.solve(slid, sie.Zones.of([[-1.0, 1.2]]), tol=1e-13)
    by_load = found.derivative(values=[1.0])
    rate = half / (2 * load)
    assert by_load.ends[0] == pytest.approx([-2 * ALPHA * rate, 2 * (1 - ALPHA) * rate], rel=1e-11)
    assert by_load.density.total == pytest.approx(1.0, rel=1e-12)
    # The derivative of the density by the load is the density of a flat punch on the zone.
    left, right = -2 * ALPHA * half, 2 * (1 - ALPHA) * half
    x = np.array([-0.5, 0.1, 0.9])
    punch = np.sin(np.pi * ALPHA) / np.pi * (right - x) ** (ALPHA - 1) * (x - left) ** -ALPHA
    assert by_load.density(x) == pytest.approx(punch, rel=1e-10)


def moved(s):
    """The solution on two zones with fixed ends, singular and bounded, with a jump of g' and a
    column. The parameter s changes the right side and the total.
    """
    forcing = sie.Forcing(
        lambda x: x - 2 * (x > 1) + (0.1 * np.exp(x) + 0.05 * np.abs(x + 0.4)) * s,
        jumps=sie.Jumps([-0.4], 0.1 * s, 1),
    )
    conditions = sie.Total(2.0 + 0.7 * s), sie.ZoneMoments(0.1)
    equation = sie.Equation(
        sie.hilbert(9.0), forcing, conditions, columns=np.ones_like, kappa=[KAPPA, -0.3]
    )
    return sie.solve(equation, sie.Zones.of([[-1.0, 0.7], [1.6, 3.0]], [S, S], [B, S]), tol=1e-12)


def width(s):
    """The solution on one zone with free ends, a given width 2 + s and an unknown total. The
    parameter s also changes the right side.
    """
    equation = sie.Equation(
        sie.hilbert(9.0),
        lambda x: np.sin(2 * np.pi / 9 * x) + s * 0.1 * np.cos(4 * np.pi / 9 * x),
        sie.Total(None),
        end_conditions=sie.TotalWidth(2.0 + s),
        kappa=KAPPA,
    )
    return sie.solve(equation, sie.Zones.of([[-0.9, 1.1]]), value=1.0, tol=1e-12)


def level(s):
    """The solution on two zones with free ends at equal potentials. The right side is a cubic
    polynomial that the parameter s changes.
    """
    forcing = sie.Forcing(
        lambda x: x**3 - (4 + s) * x + 0.3, lambda x: 0.25 * x**4 - (2 + 0.5 * s) * x**2 + 0.3 * x
    )
    conditions = sie.Total(2.0), sie.EqualPotential()
    equation = sie.Equation(sie.cauchy(), forcing, conditions, kappa=0.4)
    return sie.solve(equation, sie.Zones.of([[-2.4, -1.6], [1.6, 2.3]]), tol=1e-12)


def crack(s):
    """The solution for a complex kappa and fixed ends. The parameter s changes the right side."""
    equation = sie.Equation(
        sie.cauchy(), lambda x: (1 + s) * np.exp(x) + 1j * s * x, sie.Total(0.0), kappa=0.3j
    )
    return sie.solve(equation, sie.Zones.of([[-1.0, 0.5]], S, S))


CASES = {
    "fixed ends, a jump, a column": (
        moved,
        {
            "dg": sie.Forcing(
                lambda x: 0.1 * np.exp(x) + 0.05 * np.abs(x + 0.4), jumps=sie.Jumps([-0.4], 0.1, 1)
            ),
            "values": [0.7, 0.0],
        },
    ),
    "free ends of a given width": (
        width,
        {"dg": lambda x: 0.1 * np.cos(4 * np.pi / 9 * x), "values": [0.0, 1.0]},
    ),
    "free ends at one level": (level, {"dg": sie.Forcing(lambda x: -x, lambda x: -0.5 * x**2)}),
    "a complex kappa": (crack, {"dg": lambda x: np.exp(x) + 1j * x}),
}


@pytest.mark.parametrize("name", CASES)
def test_derivatives_are_the_limits_of_differences(name):
    """The derivative by s of the density, the ends, the amplitudes, the transform and the
    unknown value equals a difference of fourth order.
    """
    solved, change = CASES[name]
    step, found = 0.0025, solved(0.0)  # the error of the differences is 6e-9
    near = {k: solved(k * step) for k in (-2, -1, 1, 2)}
    given = found.derivative(**change)

    def rate(of):
        outer, inner = of(near[2]) - of(near[-2]), of(near[1]) - of(near[-1])
        return (8 * inner - outer) / (12 * step)

    x = np.mean(found.zones.table[0]) + np.array([-0.3, -0.1, 0.2])
    for of, value in [
        (lambda one: one.density(x), given.density(x)),
        (lambda one: one.zones.table, given.ends),
        (lambda one: one.amplitudes, given.amplitudes),
        (lambda one: one.density.transform(1.3j + x), given.density.transform(1.3j + x)),
    ]:
        assert value == pytest.approx(rate(of), rel=1e-8, abs=1e-8)
    if found.value is not None:
        assert given.value == pytest.approx(rate(lambda one: one.value), rel=1e-8)


def test_other_parameters_are_refused_by_name():
    found = crack(0.0)
    with pytest.raises(ValueError, match="only those by dg and values"):
        found.derivative(dends=[[0.0, 1.0]])
    with pytest.raises(ValueError, match="gradients are known for kappa = 0"):
        found.gradient(np.ones_like)
