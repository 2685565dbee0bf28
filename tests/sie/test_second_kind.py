"""Equations of the second kind, kappa phi + T phi = g, compared with designed and known
solutions.
"""

import pickle

import numpy as np
import pytest
from scipy.integrate import quad

import sie
from contact.studies.engine_problems import judged
from sie.dense import modes
from tests.tiers import diagonal, quick

KAPPAS = [-25.0, -1.0, -0.2, 1e-9, 0.3, 2.0, 25.0]
S, B = sie.SINGULAR, sie.BOUNDED


def alpha(kappa):
    return np.arctan2(1.0, kappa) / np.pi


# The slow seeds have thirty zones, or zones so close that 256 modes do not suffice.
@pytest.mark.parametrize(
    "seed", quick([seed for seed in range(24) if seed != 8], {*range(24)} - {2, 6, 20, 21, 22, 23})
)
def test_designed_problems_are_solved_or_refused_and_stated(seed):
    """The true error is at most the stated one, or the problem is refused with a reason.

    The problems have one to thirty zones, kappa from -25 to 25, all kinds of ends, both kernels,
    and right sides with poles close to the zones.
    """
    one = judged(seed, second_kind=True)
    assert one.fault(np.inf) == "", one


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(100, 160))
def test_more_designed_problems(seed):
    one = judged(seed, second_kind=True)
    assert one.fault(np.inf) == "", one


@pytest.mark.parametrize("kappa", KAPPAS)
def test_the_sliding_flat_punch(kappa):
    """A sliding flat punch on [-1, 1] with the total 1 has the density
    phi = sin(pi alpha) / pi (1 - x)^(alpha - 1) (1 + x)^(-alpha).
    """
    equation = sie.Equation(sie.cauchy(), np.zeros_like, sie.Total(1.0), kappa=kappa)
    found = sie.solve(equation, sie.Zones.of([[-1.0, 1.0]], S, S))
    a, x = alpha(kappa), np.array([-0.9, 0.1, 0.8])
    exact = np.sin(np.pi * a) / np.pi * (1 - x) ** (a - 1) * (1 + x) ** -a
    assert found.density(x) == pytest.approx(exact, rel=1e-12)
    assert found.density.exponents.ravel().tolist() == pytest.approx([-a, a - 1], abs=1e-15)
    d = 1e-12
    at_right = float(found.density.at(0, 2 - d, d)) * d ** (1 - a)
    assert found.density.intensities[1][0] == pytest.approx(at_right, rel=1e-9)
    assert found.error < 1e-10


@pytest.mark.parametrize("kappa", KAPPAS)
def test_the_sliding_cylinder_finds_its_ends(kappa):
    """A sliding cylinder, g = x, has the density
    phi = sin(pi alpha) (b - x)^alpha (x - a)^(1 - alpha).

    Its total is pi / 2 (b - a)^2 alpha (1 - alpha), and the middle of its zone is
    (1 - 2 alpha) (b - a) / 2. Both follow from its transform F = z -
    (z - b)^alpha (z - a)^(1 - alpha) as z -> infinity.
    """
    a = alpha(kappa)
    width = 1 / np.sqrt(a * (1 - a))
    total = 0.5 * np.pi * width**2 * a * (1 - a)
    equation = sie.Equation(sie.cauchy(), lambda x: x, sie.Total(total), kappa=kappa)
    found = sie.solve(equation, sie.Zones.of([[-0.9, 1.2]]))
    left, right = found.zones.table[0]
    assert right - left == pytest.approx(width, rel=1e-9)
    assert a * right + (1 - a) * left == pytest.approx(0.0, abs=1e-9 * width)
    x = left + (right - left) * np.array([0.1, 0.5, 0.95])
    exact = np.sin(np.pi * a) * (right - x) ** a * (x - left) ** (1 - a)
    assert found.density(x) == pytest.approx(exact, rel=1e-8)


TWO = sie.Zones.of([[-1.0, -0.2], [0.3, 1.1]], S, S)
FREE = sie.Zones.of([[-0.75, -0.55], [0.55, 0.8]])
WAVE = sie.Forcing(lambda x: np.sin(2 * x), lambda x: -np.cos(2 * x) / 2)
KINKED = sie.Forcing(
    lambda x: x + np.sign(x - 0.4) + np.maximum(x + 0.5, 0.0),
    None,
    sie.Jumps([0.4, -0.5], [2.0, 1.0], [0, 1]),
)
# Slope of a profile with two tips. The slope jumps close to the right tip, and has a kink close
# to each tip.
TIPS = sie.Forcing(
    lambda x: (
        4 * x * (x * x - 0.45) + 0.1 * np.sign(x - 0.65) + 0.5 * np.maximum(abs(x) - 0.62, 0.0)
    ),
    None,
    sie.Jumps([0.65, -0.62, 0.62], [0.2, 0.5, 0.5], [0, 1, 1]),
)
SMOOTH = sie.Smooth(
    lambda x, xi: np.cos(x - xi),
    lambda x, xi: np.sin(x - xi),
    lambda x, xi: -np.sin(x - xi),
    length=1.0,
)
PROBLEMS = {
    "totals": (sie.cauchy(), WAVE, (sie.ZoneTotals((0.3, 0.7)),), (), TWO),
    "potentials": (sie.cauchy(), WAVE, (sie.Total(1.0), sie.EqualPotential()), (), TWO),
    "levels": (sie.hilbert(4.0), WAVE, (sie.Level(0.7),), (), TWO),
    "images": (sie.images(3.0, 2), WAVE, (sie.ZoneTotals((0.3, 0.7)),), (), TWO),
    "smooth part": (sie.cauchy() + SMOOTH, WAVE, (sie.ZoneTotals((0.3, 0.7)),), (), TWO),
    "column": (sie.cauchy(), WAVE, (sie.ZoneTotals(), sie.moment(0.2)), (np.ones_like,), TWO),
    "jumps": (sie.cauchy(), KINKED, (sie.ZoneTotals((0.3, 0.7)),), (), TWO),
    "free ends": (sie.cauchy(), TIPS, (sie.ZoneTotals((0.05, 0.06)),), (), FREE),
    "free, periodic": (sie.hilbert(4.0), TIPS, (sie.ZoneTotals((0.05, 0.06)),), (), FREE),
}


def posed(name, kappa):
    kernel, forcing, conditions, columns, zones = PROBLEMS[name]
    return sie.Equation(kernel, forcing, conditions, columns, kappa=kappa), zones


@pytest.mark.parametrize("name", PROBLEMS)
def test_small_kappa_tends_to_the_equation_of_the_first_kind(name):
    plain, near = (sie.solve(*posed(name, kappa), tol=1e-9) for kappa in (0.0, 1e-12))
    assert near.zones.table == pytest.approx(plain.zones.table, abs=1e-10)
    t = np.linspace(-0.9, 0.9, 7)
    for zone in range(2):
        one, other = (found.density.at_t(zone, t) for found in (near, plain))
        assert one == pytest.approx(other, abs=1e-9 * plain.state.size)
    z = np.array([0.05 + 0.3j, -0.7 + 0.01j, 0.4 + 0.2j])
    assert near.density.transform(z) == pytest.approx(plain.density.transform(z), rel=1e-8)
    slopes = near.density.transform_slope(z), plain.density.transform_slope(z)
    assert slopes[0] == pytest.approx(slopes[1], rel=1e-8)
    if not len(plain.density.jumps):
        x = np.array([-0.6, -0.25, 0.5])
        assert near.density.integral(x) == pytest.approx(plain.density.integral(x), abs=1e-9)
    assert near.density.moment(0.3) == pytest.approx(plain.density.moment(0.3), abs=1e-9)


@pytest.mark.parametrize(("name", "kappa"), diagonal(PROBLEMS, [-0.7, 0.4, (0.3, -2.0)]))
def test_the_equation_holds_on_the_zones(name, kappa):
    equation, zones = posed(name, kappa)
    found = sie.solve(equation, zones, tol=1e-9)
    t = np.array([-0.83, -0.31, 0.07, 0.62])
    x = found.zones.middle[:, None] + found.zones.half[:, None] * t
    left = np.broadcast_to(kappa, 2)[:, None] * found.density(x) + found.density.transform(x)
    right = equation.forcing.value(x) + sum(
        amplitude * np.ones_like(x) for amplitude in found.amplitudes
    )
    assert left == pytest.approx(right, abs=1e-8)
    above = found.density.transform(x + 0j)
    assert above.real == pytest.approx(found.density.transform(x), abs=1e-9)
    assert -above.imag == pytest.approx(found.density(x), abs=1e-9)


@pytest.mark.parametrize("kappa", [0.4, (0.3, -1.5)])
def test_equal_potentials_leave_no_integral_over_the_gap(kappa):
    """Equal potentials of two zones mean that the integral of T phi - g over the gap is zero.
    Inside the gap, the potential minus the primitive of g is the integral of T phi - g.
    """
    found = sie.solve(*posed("potentials", kappa), tol=1e-10)
    x = np.linspace(-0.2, 0.3, 9)[1:-1]
    rise = lambda a, b: quad(  # noqa: E731
        lambda s: float(found.density.transform(s)) - np.sin(2 * s), a, b, epsabs=1e-12
    )[0]
    potential = found.density.potential(np.array([-0.2, 0.3]))
    primitive = np.array(WAVE.primitive(np.array([-0.2, 0.3])))
    assert np.diff(potential - primitive) == pytest.approx(0.0, abs=1e-10)
    slope = found.density.potential(x[[1, 5]]) - WAVE.primitive(x[[1, 5]])
    assert np.diff(slope) == pytest.approx(rise(x[1], x[5]), abs=1e-9)


def test_the_level_is_the_potential_at_the_first_end():
    """At the first end the integral of kappa phi is zero. So the potential minus the primitive
    of g is the level there.
    """
    found = sie.solve(*posed("levels", 0.4), tol=1e-10)
    x = np.array([-1.0])
    assert found.density.potential(x) - WAVE.primitive(x) == pytest.approx(0.7, abs=1e-9)
    assert found.levels == pytest.approx([0.7, 0.7], abs=1e-9)


@pytest.mark.parametrize("kappa", [-0.5, 1e-9, 0.4, 3.0])
def test_prescribed_intensities_move_the_ends_of_a_sliding_adhesive_cylinder(kappa):
    """The density is phi = -sin(pi alpha) (b - x)^(alpha - 1) (x - a)^(-alpha) q(x), with a
    quadratic polynomial q.

    Its transform is F = z - X q with X = (z - b)^(alpha - 1) (z - a)^(-alpha), where a and b are
    the ends of the zone.
    """
    a, left, right = alpha(kappa), -1.0, 1.3
    # Far away X = (1 + x1/z + x2/z^2 + ...) / z and F = O(1/z). So q1 = -x1, and q0 is free. It
    # is chosen here, and determines the total.
    p, r = a - 1, -a
    x1 = -(p * right + r * left)
    x2 = 0.5 * (x1 * x1 + -(p * right**2 + r * left**2))
    q1, q0 = -x1, 0.3 - x2 + x1 * x1
    total = -np.pi * (x2 + q1 * x1 + q0)
    q = np.polynomial.Polynomial([q0, q1, 1.0])
    sine, width = np.sin(np.pi * a), right - left
    ends = [
        sie.free_with_intensity(float(-sine * width**p * q(left))),
        sie.free_with_intensity(float(-sine * width**r * q(right))),
    ]
    equation = sie.Equation(sie.cauchy(), lambda x: x, sie.Total(total), kappa=kappa)
    found = sie.solve(equation, sie.Zones.of([[-0.98, 1.31]], *ends), tol=1e-9)
    assert found.zones.table[0] == pytest.approx([left, right], abs=1e-9)
    x = np.array([-0.6, 0.4, 1.2])
    exact = -sine * (right - x) ** p * (x - left) ** r * q(x)
    assert found.density(x) == pytest.approx(exact, rel=1e-7)


def test_an_unknown_total_follows_from_the_width():
    equation = sie.Equation(
        sie.cauchy(), lambda x: x, sie.Total(None), (), sie.TotalWidth(2.0), kappa=0.5
    )
    found = sie.solve(equation, sie.Zones.of([[-0.7, 1.5]]))
    a = alpha(0.5)
    assert found.value == pytest.approx(2 * np.pi * a * (1 - a), rel=1e-9)


def test_responses_to_conditions():
    equation, zones = posed("totals", 0.4)
    state = sie.solve_zones(equation, zones)
    change = state.response(np.array([1.0, 0.0]))
    assert change.totals == pytest.approx([1.0, 0.0], abs=1e-13)
    x = zones.middle[:, None] + zones.half[:, None] * np.array([-0.5, 0.7])
    assert 0.4 * change(x) + change.transform(x) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("name", ["jumps", "column", "free, periodic"])
def test_a_solution_has_a_residual_and_a_report_but_no_gradient_or_capacity(name):
    found = sie.solve(*posed(name, 0.4), tol=1e-9)
    x = found.zones.middle[:, None] + found.zones.half[:, None] * np.array([-0.7, 0.2])
    assert found.residual(x) == pytest.approx(0.0, abs=1e-9)
    assert "LU factors" in str(found.report())
    with pytest.raises(ValueError, match="kappa = 0"):
        found.gradient(np.ones_like)
    with pytest.raises(ValueError, match="kappa = 0"):
        _ = found.capacity


def test_a_mirror_image_has_minus_kappa():
    odd = sie.Forcing(lambda x: -np.sin(2 * -x))
    one = sie.solve(*posed("totals", 0.4))
    mirrored = sie.Equation(sie.cauchy(), odd, sie.ZoneTotals((0.7, 0.3)), kappa=-0.4)
    other = sie.solve(mirrored, sie.Zones.of([[-1.1, -0.3], [0.2, 1.0]], S, S))
    x = np.array([-0.7, 0.9])
    assert one.density(x) == pytest.approx(other.density(-x), rel=1e-9)


def test_a_solution_is_pickled():
    found = sie.solve_zones(*posed("jumps", 0.4)).density
    again = pickle.loads(pickle.dumps(found))
    assert again(0.5) == found(0.5)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (dict(kappa=np.nan), "kappa"),
        (dict(kappa=(0.1, 0.2, 0.3)), "kappa has 3 values for 2 zones"),
        (dict(kappa="a"), "kappa"),
    ],
)
def test_wrong_kappa_is_named(change, message):
    with pytest.raises(ValueError, match=message):
        sie.solve(sie.Equation(sie.cauchy(), WAVE, sie.ZoneTotals(), **change), TWO)


def test_symmetric_zones_and_solve_fixed_are_refused_with_kappa():
    even = sie.Zones.of([[-1.0, -0.2], [0.2, 1.0]], S, S, symmetric=True)
    with pytest.raises(ValueError, match="no mirror symmetry"):
        sie.solve(sie.Equation(sie.cauchy(), WAVE, sie.Total(0.0), kappa=0.1), even)
    with pytest.raises(ValueError, match="solve_zones"):
        sie.solve_fixed(sie.Equation(sie.cauchy(), WAVE, sie.ZoneTotals(), kappa=0.1), TWO)


@pytest.mark.parametrize("most", quick([767, 3071], [767]))
def test_an_unresolved_zone_is_named_as_the_reason(most, monkeypatch):
    sizes = modes.COUPLED_SIZES[modes.COUPLED_SIZES <= most]
    monkeypatch.setattr(modes, "COUPLED_SIZES", sizes)
    zones = sie.Zones.of([[0.0, 1.0], [1.0 + 1e-8, 2.0]], S, S)
    equation = sie.Equation(sie.cauchy(), WAVE, sie.ZoneTotals((0.3, 0.7)), kappa=0.4)
    with pytest.raises(sie.NotConverged, match=f"of {most} coefficients .* zone is very close"):
        sie.solve(equation, zones)
