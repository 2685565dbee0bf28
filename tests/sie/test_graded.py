"""Narrow gaps beside singular and bounded ends: exact solutions for gap widths of many decades."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import mpmath
import numpy as np
import pytest

import sie
from sie.graded import grading as graded
from sie.graded.grading import Grading
from tests.tiers import diagonal, quick

GAPS = [10.0**-e for e in range(3, 15)]
S, B = sie.SINGULAR, sie.BOUNDED


def still(x):
    return np.zeros_like(x)


def sides() -> tuple[np.ndarray, np.ndarray]:
    """(distances from the left end, from the right end), in half widths, over many decades."""
    few = np.concatenate((10.0 ** np.arange(-13, 0, 0.5), [0.6, 1.0]))
    return np.concatenate((few, 2 - few)), np.concatenate((2 - few, few))


@dataclass
class Design:
    """An exact solution with the transform F = Q - X M off the zones.

    X^2 is a product of factors (z - end) or 1 / (z - end). The density is the absolute value of X
    M, with a sign on each zone. powers: the exponents of X at left and at right ends, 1/2 or
    -1/2; factor: M as a function of x.
    """

    table: np.ndarray
    powers: tuple[float, float]
    factor: Callable[[np.ndarray], np.ndarray]
    period: float | None = None

    def at(self, zone: int, left: np.ndarray, right: np.ndarray) -> np.ndarray:
        """Absolute value of the density at distances from a zone's ends, in half widths."""
        a, b = self.table.T
        half = 0.5 * (b[zone] - a[zone])
        from_a, from_b = left * half, right * half
        out = np.zeros(len(left))
        for j in range(len(a)):
            if j == zone:
                of_a, of_b = from_a, from_b
            elif j < zone:
                of_a, of_b = from_a + (a[zone] - a[j]), from_a + (a[zone] - b[j])
            else:
                of_a, of_b = from_b + (a[j] - b[zone]), from_b + (b[j] - b[zone])
            for power, lag in zip(self.powers, (of_a, of_b), strict=True):
                out += power * self._log(lag)
        x = np.where(left < right, a[zone] + from_a, b[zone] - from_b)
        return np.exp(out) * np.abs(self.factor(x))

    def _log(self, lag: np.ndarray) -> np.ndarray:
        if self.period is None:
            return np.log(lag)
        near = np.minimum(lag, self.period - lag)
        return np.log(np.sin(np.pi * near / self.period))

    def errors(self, density) -> tuple[float, np.ndarray]:
        """(error of the density over all zones, over each zone), as `Solution` states them."""
        left, right = sides()
        root, wrong, size = np.sqrt(left * right), [], []
        for zone in range(len(self.table)):
            values, exact = density.at(zone, left, right), self.at(zone, left, right)
            wrong.append(np.max(np.abs(np.abs(values) - exact) * root))
            size.append(np.max(exact * root))
        return max(wrong) / max(size), np.array(wrong) / np.array(size)


def hold(found: sie.Solution, design: Design, most: float = 1e-10) -> None:
    """Assert that the density is graded and that its error <= the stated error <= `most`."""
    assert isinstance(found.density, sie.GradedDensity)
    error, errors = design.errors(found.density)
    assert error <= found.error <= most
    assert np.all(errors <= found.errors)


@pytest.mark.parametrize("gap", GAPS)
def test_collinear_cracks_under_pressure_have_willmore_s_intensities(gap):
    """phi = (x^2 - E(k')/K(k')) / sqrt((x^2 - k^2)(1 - x^2)) (T. J. Willmore, Quart. J. Mech. Appl.
    Math. 2, 1949, 53-64).
    """
    k = 0.5 * gap
    cracks = sie.Equation(sie.cauchy(), np.ones_like, sie.ZoneTotals(0.0))
    found = sie.solve(cracks, sie.Zones.of([[-1, -k], [k, 1]], S, S))
    with mpmath.workdps(40):
        square = mpmath.mpf(k) ** 2
        c = mpmath.ellipe(1 - square) / mpmath.ellipk(1 - square)
        inner = float((c - square) / mpmath.sqrt(2 * mpmath.mpf(k) * (1 - square)))
        outer = float((1 - c) / mpmath.sqrt(2 * (1 - square)))
        mean = float(c)
    left, right = np.abs(found.density.intensities)
    assert left == pytest.approx([outer, inner], rel=1e-11)
    assert right == pytest.approx([inner, outer], rel=1e-11)
    hold(found, Design(found.zones.table, (-0.5, -0.5), lambda x: x**2 - mean))
    assert np.abs(found.density.totals).max() < 1e-13


@pytest.mark.parametrize("gap", [1e-4, 1e-6, *GAPS[2::3]])
@pytest.mark.parametrize("narrow", [False, True])
def test_the_capacitance_of_a_strip_line_is_that_of_elliptic_integrals(gap, narrow):
    """Strips at the potentials -1/2 and 1/2 bear the charges -Q and Q with Q = K(k') / (2 K(k)).

    For equal strips, k is the ratio of the gap to the whole width. If one strip is narrower than
    the other, k follows from the cross ratio of the four ends.
    """
    ends = np.array([-1.0, -0.5 * gap, 0.5 * gap, 0.5 * gap + (3e-5 if narrow else 1.0)])
    with mpmath.workdps(40):
        a, b, c, d = (mpmath.mpf(float(end)) for end in ends)
        # A Moebius transform takes the ends to -1, -k, k, 1. The cross ratio is invariant:
        # (c - b)(d - a) / ((c - a)(d - b)) = 4 k / (1 + k)^2.
        ratio = (c - b) * (d - a) / ((c - a) * (d - b))
        root = mpmath.sqrt(1 - ratio)
        k = (1 - root) / (1 + root)
        charge = float(mpmath.ellipk(1 - k**2) / (2 * mpmath.ellipk(k**2)))
    potentials = sie.Forcing(still, lambda x: np.where(x > 0, 0.5, -0.5))
    # The two charges add up to zero, so the datum does not matter.
    strips = sie.Equation(sie.cauchy(), potentials, (sie.EqualPotential(), sie.Total(0.0)))
    found = sie.solve(strips, sie.Zones.of(ends.reshape(2, 2), S, S))
    assert isinstance(found.density, sie.GradedDensity) and found.error < 1e-10
    assert np.abs(found.density.totals) == pytest.approx([charge, charge], rel=1e-11)


@pytest.mark.parametrize("gap", GAPS)
def test_plates_at_one_potential_share_their_charge_as_the_closed_form_says(gap):
    """The density is phi = |x| / (pi sqrt((x^2 - k^2)(1 - x^2))). Only a small part of the charge
    is near the gap, although phi is singular there.

    Round-off in the difference of the plates' potentials changes the density by about round-off /
    sqrt(gap).
    """
    k, tol = 0.5 * gap, max(1e-10, 1e-14 / gap**0.5)
    charge = sie.Equation(
        sie.cauchy(), sie.Forcing(still, still), (sie.Total(1.0), sie.EqualPotential())
    )
    found = sie.solve(charge, sie.Zones.of([[-1, -k], [k, 1]], S, S), tol)
    hold(found, Design(found.zones.table, (-0.5, -0.5), lambda x: x / np.pi), tol)
    assert found.density.totals == pytest.approx([0.5, 0.5], rel=1e-12)
    # If the potential just found is prescribed by Level(v), the charge must be the same.
    level = float(found.levels.mean())
    again = sie.solve(
        sie.Equation(sie.cauchy(), sie.Forcing(still, still), sie.Level(level)), found.zones, tol
    )
    assert again.density.total == pytest.approx(1.0, rel=1e-11)


@pytest.mark.parametrize("period", [None, 3.0])
@pytest.mark.parametrize("gap", GAPS)
def test_plates_in_tandem_with_bounded_trailing_edges(gap, period):
    """F = 1 - X with X = sqrt(prod (z - b) / (z - a)).

    With a period L, the distances in X are replaced by their sines, and X is divided by cos(pi W
    / (2 L)), where W is the sum of the widths.
    """
    table = np.array([[-1.0, 0.0], [gap, 1.0]])
    design = tandem(table, period)
    kernel = sie.cauchy() if period is None else sie.hilbert(period)
    found = sie.solve(sie.Equation(kernel, np.ones_like), sie.Zones.of(table, S, B))
    hold(found, design)


def tandem(table: np.ndarray, period: float | None) -> Design:
    widths = float(np.sum(table[:, 1] - table[:, 0]))
    factor = 1.0 if period is None else 1 / np.cos(0.5 * np.pi / period * widths)
    return Design(table, (-0.5, 0.5), lambda x: factor * np.ones_like(x), period)


@pytest.mark.parametrize("gap", [1e-4, 1e-8, 1e-12])
def test_a_narrow_gap_across_the_border_of_the_period(gap):
    """The density at both ends of the gap, against X of the test above, which is computed from
    distances without cancellation.
    """
    stop = 1.0 - gap
    gap = 1.0 - stop  # the gap beside the rounded end
    zones = sie.Zones.of([[0.0, 0.4], [0.7, stop]], S, B)
    found = sie.solve(sie.Equation(sie.hilbert(1.0), np.ones_like), zones)
    assert isinstance(found.density, sie.GradedDensity) and found.error < 1e-10
    factor = 1 / np.cos(0.5 * np.pi * (0.4 + (stop - 0.7)))
    few = 10.0 ** np.arange(-14, 0.1, 0.5)

    def sine(lag):
        return np.sin(np.pi * lag)

    d = zones.half[0] * few  # right of 0, the singular left end
    wanted = np.sqrt(sine(0.4 - d) * sine(d + gap) / (sine(d) * sine(0.7 - d)))
    values = np.abs(found.density.at(0, few, 2 - few))
    assert values == pytest.approx(factor * wanted, rel=1e-11)
    d = zones.half[1] * few  # left of the bounded right end
    wanted = np.sqrt(sine(d) * sine(stop - 0.4 - d) / (sine(d + gap) * sine(stop - 0.7 - d)))
    values = np.abs(found.density.at(1, 2 - few, few))
    # The intensity at a bounded end is zero up to round-off.
    wrong = np.abs(values - factor * wanted) * np.sqrt(few)
    assert np.max(wrong / np.sqrt(few + gap)) < 1e-12


@pytest.mark.parametrize("gap", [1e-3, 1e-6, 1e-9, 1e-12])
def test_bounded_ends_with_two_columns_of_unknown_amplitude(gap):
    """F = z + c + X(p)/(z - p) - X/(z - p), so the columns x and 1 have the amplitudes 1, c."""
    table, pole = np.array([[-1.0, 0.0], [gap, 0.7]]), 1.6
    value = np.sqrt(np.prod(pole - table))
    equation = sie.Equation(
        sie.cauchy(),
        lambda x: value / (x - pole),
        (),
        (
            sie.Forcing(lambda x: x, resolution=sie.Resolution(modes=2)),
            sie.Forcing(np.ones_like, resolution=sie.Resolution(modes=1)),
        ),
    )
    found = sie.solve(equation, sie.Zones.of(table, B, B))
    hold(found, Design(table, (0.5, 0.5), lambda x: 1 / (x - pole)))
    assert found.amplitudes == pytest.approx([1.0, pole - 0.5 * table.sum()], rel=1e-11)


def test_many_plates_with_widths_and_gaps_of_many_decades():
    rng = np.random.default_rng(1)
    width, gap = 10.0 ** rng.uniform(-3, 0, 12), 10.0 ** rng.uniform(-10, 0, 12)
    stop = np.cumsum(width + gap)
    table = np.column_stack((stop - width, stop))
    found = sie.solve(sie.Equation(sie.cauchy(), np.ones_like), sie.Zones.of(table, S, B))
    hold(found, tandem(table, None))


@pytest.mark.parametrize("gap", [1e-3, 1e-7, 1e-11])
def test_symmetric_zones_are_solved_with_half_of_the_unknowns(gap):
    k = 0.5 * gap
    table = np.array([[-3.0, -1.0 - gap], [-1.0, -k], [k, 1.0], [1.0 + gap, 3.0]])
    odd = sie.Forcing(lambda x: np.sin(x), lambda x: -np.cos(x))
    for conditions in ((sie.ZoneTotals(0.5),), (sie.Total(1.0), sie.EqualPotential())):
        whole, half = (
            sie.solve(
                sie.Equation(sie.cauchy(), odd, conditions),
                sie.Zones.of(table, S, S, symmetric),
                tol=max(1e-10, 3e-13 / gap**0.5),
            )
            for symmetric in (False, True)
        )
        assert half.state.coupled == half.state.density.system.nodes // 2
        assert half.density.totals == pytest.approx(whole.density.totals, rel=1e-9)
    middle = np.array([[-3.0, -1.0 - gap], [-1.0, 1.0], [1.0 + gap, 3.0]])
    pair = [
        sie.solve(
            sie.Equation(sie.cauchy(), odd, sie.ZoneTotals(0.5)),
            sie.Zones.of(middle, S, S, symmetric),
        )
        for symmetric in (False, True)
    ]
    ones, others = (np.array(found.density.intensities) for found in pair)
    assert others == pytest.approx(ones, rel=1e-10)


KERNELS = {
    "Cauchy": sie.cauchy(),
    "Hilbert": sie.hilbert(4.0),
    "images": sie.images(4.0, 2),
    "smooth": sie.cauchy()
    + sie.Smooth(lambda x, xi: np.sin(x - 0.5 * xi), lambda x, xi: -np.cos(x - 0.5 * xi)),
}


@pytest.mark.parametrize("kernel", KERNELS)
def test_graded_and_plain_coordinates_agree_where_both_resolve_the_gap(kernel, monkeypatch):
    """At a gap of 1e-3, graded coordinates and plain Chebyshev modes are both accurate. They must
    give the same totals, amplitudes, edges, levels, and fields on the line and in the plane.
    """
    forcing = sie.Forcing(np.cos, np.sin)
    column = sie.Forcing(lambda x: x, lambda x: 0.5 * x**2)
    conditions = sie.moment(0.3), sie.EqualPotential()
    equation = sie.Equation(KERNELS[kernel], forcing, conditions, column)
    zones = sie.Zones.of([[-1.0, 0.0], [1e-3, 0.7], [0.9, 1.5]], [S, S, S], [S, B, S])
    found = sie.solve(equation, zones)
    monkeypatch.setattr("sie.slits.system.is_graded", lambda *_: False)
    plain = sie.solve(equation, zones)
    one, other = found.density, plain.density
    assert isinstance(one, sie.GradedDensity) and isinstance(other, sie.Density)
    assert one.totals == pytest.approx(other.totals, rel=1e-10)
    assert found.amplitudes == pytest.approx(plain.amplitudes, rel=1e-10)
    assert np.array(one.intensities) == pytest.approx(np.array(other.intensities), abs=1e-9)
    assert np.array(one.edge_slopes) == pytest.approx(np.array(other.edge_slopes), rel=1e-6)
    assert found.levels == pytest.approx(plain.levels, rel=1e-10)
    assert one.moment(0.3) == pytest.approx(other.moment(0.3), rel=1e-10)
    x = np.array([-1.7, -0.999, -0.3, -1e-4, 5e-4, 1.1e-3, 0.4, 0.69, 0.8, 1.2, 1.9])
    for name in ("__call__", "transform", "potential", "integral"):
        values = getattr(one, name)(x)
        assert values == pytest.approx(getattr(other, name)(x), rel=1e-9, abs=1e-10), name
    angle = np.linspace(0.1, 3.0, 7)
    assert one.integral_at(1, angle) == pytest.approx(other.integral_at(1, angle), rel=1e-10)
    if kernel == "smooth":
        return
    z = np.array([-0.4 + 1e-5j, 5e-4 + 1e-4j, 0.3 - 0.2j, 1.1e-3 + 1e-6j, -1.8 + 0.5j, 0.5 + 0j])
    for name in ("transform", "potential"):
        assert getattr(one, name)(z) == pytest.approx(getattr(other, name)(z), rel=1e-9), name
    slopes = one.transform_slope(z[:-1]), other.transform_slope(z[:-1])
    assert slopes[0] == pytest.approx(slopes[1], rel=1e-7)


def bent(x):
    return np.where(x > 0.4, 1.0, 0.0) + 0.3 * np.abs(x + 0.5) + np.maximum(x - 1.1, 0.0) ** 2


def height(x):
    above = np.maximum(x - 1.1, 0.0) ** 3 / 3
    return np.maximum(x - 0.4, 0.0) + 0.15 * (x + 0.5) * np.abs(x + 0.5) + above


def log_slope(x):
    return np.cos(x) + (x - 0.4) / np.pi * np.log(np.abs(x - 0.4))


def power(x):
    return np.cos(x) + np.abs(x - 0.4) ** 0.6


ROUGH = {
    "jumps": sie.Forcing(bent, height, sie.Jumps([0.4, -0.5, 1.1], [1.0, 0.6, 2.0], [0, 1, 2])),
    "jumps of the density": sie.Forcing(
        np.cos, jumps=sie.Jumps([0.4, -0.5], [1.0, 0.6], [0, 0], of_density=True)
    ),
    "a kink of the density": sie.Forcing(
        log_slope, jumps=sie.Jumps([0.4], [1.0], [1], of_density=True)
    ),
    "powers": sie.Forcing(
        power, jumps=sie.Jumps(algebraic=sie.AlgebraicPoints([0.4], [0.6], [1.0], [1.0]))
    ),
}


@pytest.mark.parametrize(("kind", "kernel"), diagonal(ROUGH, ["Cauchy", "Hilbert", "smooth"]))
def test_jumps_and_powers_agree_with_plain_coordinates(kind, kernel, monkeypatch):
    forcing = ROUGH[kind]
    conditions = (sie.ZoneTotals(0.2),)
    if forcing.primitive is not None:
        conditions = (sie.moment(0.3), sie.EqualPotential(), sie.Total(0.1))
    column = () if forcing.primitive is None else (sie.Forcing(lambda x: x, lambda x: 0.5 * x**2),)
    equation = sie.Equation(KERNELS[kernel], forcing, conditions, column)
    zones = sie.Zones.of([[-1.0, 0.0], [1e-3, 0.7], [0.9, 1.5]], S, S)
    found = sie.solve(equation, zones)
    monkeypatch.setattr("sie.slits.system.is_graded", lambda *_: False)
    plain = sie.solve(equation, zones)
    one, other = found.density, plain.density
    assert isinstance(one, sie.GradedDensity) and isinstance(other, sie.Density)
    assert one.totals == pytest.approx(other.totals, abs=1e-11)
    assert np.array(one.intensities) == pytest.approx(np.array(other.intensities), rel=1e-9)
    assert np.array(one.edge_slopes) == pytest.approx(np.array(other.edge_slopes), rel=1e-5)
    x = np.array([-1.7, -0.999, -0.3, -1e-4, 5e-4, 1.1e-3, 0.4001, 0.69, 0.8, 1.2, 1.9])
    assert one(x) == pytest.approx(other(x), rel=1e-9)
    assert one.transform(x) == pytest.approx(other.transform(x), rel=1e-9, abs=1e-9)
    assert one.moment(0.3) == pytest.approx(other.moment(0.3), abs=1e-11)
    if kernel == "smooth":
        return
    z = np.array([-0.4 + 1e-5j, 5e-4 + 1e-4j, 0.3 - 0.2j, 1.1e-3 + 1e-6j, -1.8 + 0.5j, 0.5 + 0j])
    assert one.transform(z) == pytest.approx(other.transform(z), rel=1e-9)
    assert one.potential(z) == pytest.approx(other.potential(z), rel=1e-9, abs=1e-11)


@pytest.mark.parametrize("gap", [1e-3, 1e-6, 1e-9, 1e-12])
def test_a_step_of_the_pressure_on_cracks_obeys_the_reciprocal_theorem(gap):
    """For right sides G', H' and totals zero, int G phi_H = int H phi_G. Here G = x and H = max(x
    - s, 0). Then int H phi_G is the integral of the crack's opening from s to the end.
    """
    k, s = 0.5 * gap, 0.4
    zones = sie.Zones.of([[-1.0, -k], [k, 1.0]], S, S)
    step = sie.Forcing(lambda x: np.where(x > s, 1.0, 0.0), jumps=sie.Jumps([s], [1.0], 0))
    stepped = sie.solve(sie.Equation(sie.cauchy(), step, sie.ZoneTotals(0.0)), zones)
    even = sie.solve(sie.Equation(sie.cauchy(), np.ones_like, sie.ZoneTotals(0.0)), zones)
    assert isinstance(stepped.density, sie.GradedDensity) and stepped.error < 1e-10
    y, weight = np.polynomial.legendre.leggauss(60)
    root = 0.5 * (1 + y)  # the opening varies as a root near the crack's end
    opening = -even.density.integral(1.0 - (1.0 - s) * root**2)
    wanted = float(np.sum(opening * (1.0 - s) * root * weight))
    assert stepped.density.moment() == pytest.approx(wanted, rel=1e-12)


@pytest.mark.parametrize("gap", [1e-4, 1e-7, 1e-11])
def test_equation_and_level_hold_at_all_places_of_the_zones(gap):
    """In the first case the charge density falls towards the gap. The solver then divides the
    density by this decay before it expands the quotient in a series.
    """
    t = np.concatenate((np.linspace(-0.97, 0.97, 23), [1 - 1e-3, 1 - 1e-5]))
    row = sie.Equation(sie.hilbert(1.0), sie.Forcing(still, still), sie.Total(1.0))
    tol = max(1e-10, 1e-12 / gap**0.5)  # round-off of the potential over the narrow gap
    found = sie.solve(row, sie.Zones.of([[0.0, 1.0 - gap]], S, S), tol)
    x = 0.5 * (1 - gap) * (1 + t)
    assert found.density.potential(x) == pytest.approx(np.full(len(t), found.levels[0]), abs=1e-13)
    assert found.density.transform(x) == pytest.approx(np.zeros(len(t)), abs=1e-11)
    pair = sie.Zones.of([[-1.0, 0.0], [gap, 2.0]], S, B)
    plates = sie.solve(sie.Equation(sie.cauchy(), np.ones_like), pair)
    assert isinstance(plates.density, sie.GradedDensity)
    assert plates.density.transform(t[t < 0]) == pytest.approx(np.ones(np.sum(t < 0)), abs=1e-11)
    assert plates.residual(1 + t) == pytest.approx(np.zeros(len(t)), abs=1e-11)


@pytest.mark.parametrize("gap", quick([1e-5, 1e-10], [1e-10]))
def test_fields_beside_the_gap_are_those_of_the_closed_form(gap):
    """Two cracks: F = 1 - (z^2 - c) / (sqrt(z^2 - k^2) sqrt(z^2 - 1)), k half of the gap."""
    k = 0.5 * gap
    cracks = sie.Equation(sie.cauchy(), np.ones_like, sie.ZoneTotals(0.0))
    density = sie.solve(cracks, sie.Zones.of([[-1, -k], [k, 1]], S, S)).density

    def exact(z):
        square = mpmath.mpf(k) ** 2
        c = mpmath.ellipe(1 - square) / mpmath.ellipk(1 - square)
        roots = [mpmath.sqrt(z - end) for end in (-1, -mpmath.mpf(k), mpmath.mpf(k), 1)]
        return 1 - (z**2 - c) / mpmath.fprod(roots)

    places = [1e-3j * gap, k * (1 + 1e-3j), k * (3 + 2j), 1e-3 + 1e-6j, 0.4 + 1e-9j, 1.0 + 1e-8j]
    places += [0.2 + 0.3j, -2.0 + 1.0j]
    z = np.array(places)
    with mpmath.workdps(40):
        wanted = np.array([complex(exact(mpmath.mpc(one))) for one in places])
        slopes = [
            mpmath.diff(exact, mpmath.mpc(one), h=mpmath.mpf(10) ** -18 * k) for one in places
        ]
        rises = [
            complex(mpmath.quad(exact, [mpmath.mpc(one), mpmath.mpc(one) + 0.7j, 3 + 0.7j]))
            for one in places[1::3]
        ]
    assert density.transform(z) == pytest.approx(wanted, rel=1e-11)
    assert density.transform_slope(z[1:]) == pytest.approx(
        np.array([complex(one) for one in slopes[1:]]), rel=1e-10
    )
    rise = density.potential(np.array([3 + 0.7j]))[0] - density.potential(z[1::3])
    assert rise == pytest.approx(np.array(rises), rel=1e-11)
    x = np.array([0.0, 0.4 * k, -0.99 * k, 1.0001, -5.0])
    with mpmath.workdps(40):
        on_line = [float(mpmath.re(exact(mpmath.mpf(float(one))))) for one in x]
    assert density.transform(x) == pytest.approx(np.array(on_line), rel=1e-11)
    inside = np.array([3 * k, 1e-3, 0.5, -0.2])
    assert density.transform(inside) == pytest.approx(np.ones(4), abs=1e-14 / gap)
    assert density.potential(x) == pytest.approx(density.potential(x + 0j).real, abs=1e-13)


def charge_beside(gap: mpmath.mpf, on_right: bool) -> float:
    """Charge of one zone of the next test, without sign, by quadrature over v.

    The distance from the gap is d = gap sinh(v)^2.
    """
    end = mpmath.mpf(0.7)
    reach = end - gap if on_right else mpmath.mpf(1)

    def integrand(v):
        d = gap * mpmath.sinh(v) ** 2
        x = gap + d if on_right else -d
        # Round-off must not make the root imaginary at the free end.
        root = mpmath.sqrt(abs((1 + x) * (end - x)) / (d * (d + gap)))
        return root * (x + 2) * gap * mpmath.sinh(2 * v)

    top = mpmath.asinh(mpmath.sqrt(reach / gap))
    return float(mpmath.quad(integrand, mpmath.linspace(0, top, 12)))


@pytest.mark.parametrize("gap", [1e-3, 1e-6, 1e-9, 1e-12])
def test_free_ends_are_found_on_the_far_sides_of_fixed_ends_beside_a_gap(gap):
    """F = Q - X M with X^2 = (z - a)(z - b) / (z (z - gap)), M = z + 2 and free ends a, b."""
    with mpmath.workdps(30):
        charges = [charge_beside(mpmath.mpf(gap), on_right) for on_right in (False, True)]
    shift = 2 + 0.5 * (1.0 - 0.7 + gap)
    equation = sie.Equation(
        sie.cauchy(), lambda x: x + shift, sie.ZoneTotals((-charges[0], charges[1]))
    )
    start = sie.Zones.of([[-1.2, 0.0], [gap, 0.6]], [sie.FREE, S], [S, sie.FREE])
    found = sie.solve(equation, start, signs=(-1.0, 1.0))
    assert isinstance(found.density, sie.GradedDensity)
    off = np.abs(found.zones.table - [[-1.0, 0.0], [gap, 0.7]]).max()
    assert off <= found.error < 1e-11


def test_a_user_s_condition_on_one_zone_is_met():
    class First(sie.Condition):
        """Condition: the intensity at the right end of the first zone is 2."""

        def rows(self, system):
            _, (matrix, constants) = system.intensities()
            return matrix[:1], constants[:1], np.array([2.0])

    equation = sie.Equation(sie.cauchy(), np.ones_like, (sie.Total(0.0), First()))
    found = sie.solve(equation, sie.Zones.of([[-1.0, 0.0], [1e-7, 1.0]], S, S))
    assert isinstance(found.density, sie.GradedDensity)
    assert found.density.intensities[1][0] == pytest.approx(2.0, rel=1e-11)


def test_responses_to_other_values_of_conditions_are_those_of_another_solution():
    zones = sie.Zones.of([[-1.0, 0.0], [1e-9, 2.0]], S, S)

    def solved(total):
        conditions = sie.Total(total), sie.EqualPotential()
        return sie.solve_zones(
            sie.Equation(sie.cauchy(), sie.Forcing(np.sin, lambda x: -np.cos(x)), conditions), zones
        )

    one, other = solved(1.0), solved(3.0)
    assert one.with_value(0, 2.0).density.totals == pytest.approx(other.density.totals, rel=1e-11)
    assert one.response(one.values(0)).total == pytest.approx(1.0, rel=1e-12)
    rates = one.levels + 2 * one.level_rates(one.values(0))
    assert rates == pytest.approx(other.levels, rel=1e-11)


def test_too_many_zones_beside_narrow_gaps_are_refused_at_once():
    start = np.arange(80) * (1 + 1e-8)
    table = np.column_stack((start, start + 1))
    with pytest.raises(
        ValueError, match="80 zones with gaps as narrow as 1.0e-08 need .* unknowns"
    ):
        sie.solve(sie.Equation(sie.cauchy(), np.ones_like), sie.Zones.of(table, S, B))


def test_a_right_side_that_no_modes_resolve_is_refused_with_the_zone():
    rough = sie.Equation(sie.cauchy(), lambda x: np.abs(x - 0.3) ** 0.1, sie.ZoneTotals(0.0))
    with pytest.raises(sie.NotConverged, match="zone 1 .* beside a narrow gap"):
        sie.solve(rough, sie.Zones.of([[-1.0, 0.0], [1e-6, 1.0]], S, S))


@pytest.mark.parametrize("gap", [1e-4, 1e-8, 1e-12])
def test_capacity_report_and_residual_of_a_solution(gap):
    """Two equal intervals have the capacity sqrt(b^2 - a^2) / 2."""
    k, tol = 0.5 * gap, max(1e-10, 1e-14 / gap**0.5)
    charge = sie.Equation(sie.cauchy(), np.zeros_like, (sie.Total(1.0), Balanced()))
    found = sie.solve(charge, sie.Zones.of([[-1, -k], [k, 1]], S, S), tol)
    assert found.capacity == pytest.approx(0.5 * np.sqrt(1 - k**2), rel=1e-11)
    report = found.report()
    assert report.modes.tolist() == found.state.system.sizes.tolist()
    assert report.condition < 1e6 and "unknowns, solved by LU factors" in str(report)
    assert np.abs(found.residual([-0.3, 0.1, 0.9])).max() < 1e-12


class Balanced(sie.Condition):
    """Condition: the first zone bears half of the total, so both potentials are equal."""

    def rows(self, system):
        matrix, constants = system.totals()
        return matrix[:1], constants[:1], np.array([0.5])


class TestGrading:
    GRADING = Grading(1.0, 1e-9, 3e-5)

    def test_places_and_their_coordinate_are_inverse_to_each_other(self):
        places = graded.gauss(self.GRADING, 60)
        back = self.GRADING.of(places.from_a, places.from_b)
        assert back.left == pytest.approx(places.left, rel=1e-13)
        assert back.right == pytest.approx(places.right, rel=1e-13)

    def test_the_cauchy_kernel_is_one_over_the_distance(self):
        """The distance of two places is the difference of their distances from the nearer end,
        which has all digits.
        """
        points, sources = graded.collocation(self.GRADING, 40), graded.gauss(self.GRADING, 40)
        x = points.from_a[:, None] - sources.from_a
        other = sources.from_b - points.from_b[:, None]
        lag = np.where(points.from_a[:, None] < 0.5, x, other)
        wanted = points.rate[:, None] / lag
        assert self.GRADING.kernel(points, sources) == pytest.approx(wanted, rel=1e-10)
        split = self.GRADING.smooth_kernel(points, sources) + 1 / (
            points.left[:, None] - sources.left
        )
        assert split == pytest.approx(wanted, rel=1e-10, abs=1e-12)
        steps = self.GRADING.turns(points, sources) * (2 / self.GRADING.stretch)
        ratio = np.log(lag / steps)
        assert self.GRADING.log_ratio(points, sources) == pytest.approx(ratio, rel=1e-9, abs=1e-9)

    @pytest.mark.parametrize("y", [1e-9, 0.0999, 0.1001, 2.0, 0.05 + 0.08j, 0.3 - 1.2j])
    def test_functions_without_their_poles(self, y):
        with mpmath.workdps(40):
            exact = mpmath.mpmathify(y)
            plain = complex(mpmath.coth(exact) - 1 / exact)
            slope = complex(1 / exact**2 - 1 / mpmath.sinh(exact) ** 2)
            log = complex(mpmath.log(mpmath.sinh(exact) / exact))
        at = np.array([y])
        assert complex(graded.coth_less_pole(at)[0]) == pytest.approx(plain, rel=1e-13)
        assert complex(graded.coth_less_pole_slope(at)[0]) == pytest.approx(slope, rel=1e-12)
        assert complex(graded.log_sinhc(at)[0]) == pytest.approx(log, abs=1e-15)
