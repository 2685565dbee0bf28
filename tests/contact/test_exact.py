"""Closed forms without adhesion are checked against laws that they do not contain.
The laws are the singular integral equation, the load, and the displacement by the pressure.
"""

import inspect
import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from contact.errors import OutOfRange, SceneError
from contact.reference import exact
from tests.contact import reference

L = 1e-4
E_STAR = 1.1e11
SHARES = (0.05, 0.25, 0.45, 0.49)  # a/L
# Gauss-Chebyshev quadrature with 400 nodes sums terms about 400 times as large as the result,
# and 400 eps is about 1e-13.
TOL = 1e-12


def smooth_solutions():
    """Solutions without kinks in zones; the isolated ones have a datum."""
    for share in SHARES:
        a = share * L
        yield exact.Westergaard(1e-6, L, E_STAR, a)
        yield exact.PeriodicParabola(2e-3, L, E_STAR, a)
        yield exact.PeriodicPunch(a, L, E_STAR, 300.0)
        yield exact.IsolatedSinusoid(1e-6, L, E_STAR, a, datum=3 * L)
    yield exact.HertzLine(2e-3, E_STAR, 0.3 * L, datum=2 * L)
    yield exact.IsolatedPunch(0.3 * L, E_STAR, 300.0, datum=2 * L)
    for over in (1e-6, 0.1, 0.9, 1.0 - 1e-9, 1.0, 1.7, 40.0):
        merging = exact.IsolatedBiquadratic(2e-3, 0.5 * L, E_STAR, 1.0).merging_load
        yield exact.IsolatedBiquadratic(2e-3, 0.5 * L, E_STAR, over * merging, datum=L)


def wedges():
    for share in SHARES:
        yield exact.PeriodicWedge(0.02, L, E_STAR, share * L)
    yield exact.IsolatedWedge(0.02, E_STAR, 0.3 * L, datum=2 * L)


def localized():
    for closure in ("first-order", "self-consistent"):
        for share in (0.05, 0.25, 0.43):
            a = share * L
            yield exact.LocalizedZone(exact.HertzLine(2e-3, E_STAR, a), L, closure)
            yield exact.LocalizedZone(exact.IsolatedSinusoid(1e-6, L, E_STAR, a), L, closure)


def name(solution):
    width = float(np.sum(solution.zone_widths))
    return f"{type(solution).__name__}-{getattr(solution, 'closure', '')}{width / L:.3g}"


SMOOTH = list(smooth_solutions())
WEDGES = list(wedges())
LOCALIZED = list(localized())


@pytest.mark.parametrize("solution", SMOOTH, ids=name)
def test_the_pressure_solves_the_singular_integral_equation(solution):
    # If two zones are about to merge, the pressure of one zone has a branch point at a distance of
    # 1e-5 widths from an end. The number of nodes for the quadrature grows with the inverse
    # square root of this distance.
    nodes = (
        12000 if getattr(solution, "inner_end", 1.0) and name(solution).endswith("0.707") else 400
    )
    assert reference.equation_error(solution, nodes=nodes) < TOL * nodes / 400


@pytest.mark.parametrize("solution", WEDGES, ids=name)
@pytest.mark.parametrize("t", (-0.9, -0.2, 0.01, 0.5, 0.999))
def test_a_wedge_solves_the_equation_by_folded_quadrature(solution, t):
    a = solution.half_width
    left = reference.folded_transform(solution, t * a, [-a, 0.0, a])
    # Round-off of the positions x - s changes the pressure at an end of the zone by sqrt(eps),
    # but only at a few nodes of tiny weight.
    assert left == pytest.approx(0.5 * E_STAR * np.sign(t) * solution.wedge_slope, rel=1e-10)


@pytest.mark.parametrize("solution", LOCALIZED, ids=name)
def test_a_localized_zone_solves_the_equation_with_the_nominal_pressure_outside_the_strip(solution):
    def outside(x):
        return 2.0 * solution.nominal_load / (np.pi * L) * np.arctanh(2.0 * x / L)

    assert reference.equation_error(solution, outside) < TOL


@pytest.mark.parametrize("solution", LOCALIZED, ids=name)
def test_the_gap_of_a_localized_zone_has_the_slope_its_pressure_makes(solution):
    """The gap g obeys (E*/2) g' = (E*/2) f' + nominal - (1/pi) int p/(x - xi).
    This is integrated over a part of the strip by Gauss-Legendre quadrature. Here `nominal` is
    the term of the nominal pressure.
    """
    a = solution.half_width
    lo, hi = a + 0.1 * (0.5 * L - a), a + 0.9 * (0.5 * L - a)
    node, weight = np.polynomial.legendre.leggauss(60)
    x = 0.5 * (lo + hi) + 0.5 * (hi - lo) * node
    phi, _, _, load = reference.zone_rule(solution, 0, 2000)
    stress = np.sum(load / (x[:, None] - a * np.cos(phi)), axis=1) / np.pi
    nominal = 2.0 * solution.nominal_load / (np.pi * L) * np.arctanh(2.0 * x / L)
    slope = solution.slope(x) + 2.0 / E_STAR * (nominal - stress)
    rise = 0.5 * (hi - lo) * np.sum(weight * slope)
    assert solution.gap(hi) - solution.gap(lo) == pytest.approx(rise, rel=1e-10)
    assert np.isfinite(solution.gap(0.5 * L))


@pytest.mark.parametrize("solution", SMOOTH + LOCALIZED, ids=name)
def test_the_pressures_add_up_to_the_load(solution):
    assert reference.load_of(solution, 4000) == pytest.approx(solution.load, rel=1e-11)
    assert np.sum(solution.zone_loads) == pytest.approx(solution.load, rel=1e-15)


@pytest.mark.parametrize("solution", WEDGES, ids=name)
def test_the_pressures_of_a_wedge_add_up_to_the_load(solution):
    x = solution.half_width * reference.FOLD_LEFT
    total = 2.0 * solution.half_width * np.sum(reference.FOLD_WEIGHT * solution.pressure(x))
    assert total == pytest.approx(solution.load, rel=1e-12)


@pytest.mark.parametrize("solution", SMOOTH, ids=name)
def test_the_displacement_outside_is_the_logarithmic_potential_of_the_pressure(solution):
    """The potential of the pressure checks approach, gap and height together."""
    ends = solution.zones
    beyond = 0.5 * L if solution.period else 2.0 * L
    x = ends[-1, 1] + (beyond - ends[-1, 1]) * np.array([0.02, 0.3, 0.7, 1.0])
    if len(ends) == 2 and ends[1, 0] > 0.05 * L:
        x = np.append(x, [0.0, 0.5 * ends[1, 0]])
    u = solution.displacement(x)
    scale = np.max(np.abs(u)) + np.max(
        solution.gap(x), where=np.isfinite(solution.gap(x)), initial=0.0
    )
    np.testing.assert_allclose(
        reference.displacement_of(solution, x, 2000), u, rtol=0.0, atol=1e-11 * scale
    )


@pytest.mark.parametrize("solution", WEDGES, ids=name)
def test_the_displacement_outside_a_wedge_is_the_logarithmic_potential_of_the_pressure(solution):
    a = solution.half_width
    x = a + ((0.5 * L if solution.period else 2.0 * L) - a) * np.array([0.1, 0.6, 1.0])
    xi = a * reference.FOLD_LEFT
    weight = a * reference.FOLD_WEIGHT * solution.pressure(xi)
    d = np.stack([x[:, None] - xi, x[:, None] + xi])
    logs = np.log(2.0 * np.sin(np.pi * d / L)) if solution.period else np.log(d / solution.datum)
    expected = -2.0 / (np.pi * E_STAR) * np.sum(logs @ weight, axis=0)
    np.testing.assert_allclose(
        solution.displacement(x), expected, rtol=0.0, atol=1e-11 * abs(solution.approach)
    )


@pytest.mark.parametrize("solution", SMOOTH + WEDGES, ids=name)
def test_the_stiffness_is_the_slope_of_load_over_approach(solution):
    """The stiffness is d load/d approach, also beyond the maximum of the load.
    For punches, load and approach are proportional.
    """
    control = (
        "half_width"
        if hasattr(solution, "half_width") and "Punch" not in type(solution).__name__
        else "load"
    )
    middle = getattr(solution, control)
    if solution.period is not None and control == "half_width":
        room = min(middle, 0.5 * L - middle)
    elif isinstance(solution, exact.IsolatedBiquadratic):
        room = min(solution.load, abs(solution.merging_load - solution.load))
        if room < 1e-6 * solution.load:
            return  # the two formulas meet here: compared below and above this load
    else:
        room = min(middle, 0.5 * L - middle) if hasattr(solution, "wavelength") else middle
    # The derivative is that of the polynomial through 13 Chebyshev points. They lie within a
    # fifth of the distance to the nearest singularity.
    nodes = np.cos(np.pi * (np.arange(13) + 0.5) / 13)
    near = [replace(solution, **{control: middle + 0.2 * room * t}) for t in nodes]

    def slope(quantity):
        values = np.array([getattr(s, quantity) for s in near])
        return np.polynomial.Chebyshev.fit(nodes, values - values[6], 12, domain=[-1, 1]).deriv()(
            0.0
        )

    assert slope("load") == pytest.approx(solution.stiffness * slope("approach"), rel=1e-8)


@pytest.mark.parametrize("solution", SMOOTH + WEDGES + LOCALIZED, ids=name)
def test_pressure_is_positive_in_zones_and_the_gap_positive_outside(solution):
    if isinstance(solution, exact.IsolatedSinusoid) and not solution.admissible:
        assert solution.pressure_at(0.999999) < 0.0
        return
    t = np.concatenate([1e-12 * np.arange(1, 4) - 1.0, np.linspace(-0.999, 0.999, 200)])
    for zone in range(len(solution.zones)):
        assert np.all(solution.pressure_at(t, zone) > 0.0)
    x = np.linspace(-0.5 * L, 0.5 * L, 401)
    inside = np.any(
        (x[:, None] > solution.zones[:, 0]) & (x[:, None] < solution.zones[:, 1]), axis=1
    )
    near_end = np.min(np.abs(x[:, None] - solution.zones.ravel()), axis=1) < 1e-9 * L
    assert np.all(solution.gap(x[~inside & ~near_end]) > 0.0)
    assert np.all(solution.gap(x[inside & ~near_end]) == 0.0)


@pytest.mark.parametrize("solution", [*SMOOTH, *WEDGES, *LOCALIZED], ids=name)
def test_the_peak_is_the_largest_pressure(solution):
    t = np.cos(np.linspace(0.0, np.pi, 4001))
    largest = max(float(np.max(solution.pressure_at(t, k))) for k in range(len(solution.zones)))
    if np.isinf(solution.max_pressure):
        assert "Wedge" in type(solution).__name__ or "Punch" in type(solution).__name__
    else:
        # The largest of 4001 samples misses a smooth peak by at most (pi/4000)^2/8 times the
        # second derivative by the angle. 1e-13 is the round-off of scipy's integral of J_0.
        assert largest <= solution.max_pressure * (1.0 + 1e-13)
        assert largest == pytest.approx(solution.max_pressure, rel=2e-6)


@pytest.mark.parametrize("solution", [*SMOOTH, *WEDGES, *LOCALIZED], ids=name)
def test_pressure_follows_the_square_root_down_to_the_last_digit_of_t(solution):
    """With d = 1 - t, p is proportional to d^(1/2) at a free end, and to d^(-1/2) at a corner.
    No digit is lost between d = 2^-36 and d = 2^-52.
    """
    power = -0.5 if "Punch" in type(solution).__name__ else 0.5
    near, nearer = solution.pressure_at(
        np.array([1.0 - 2.0**-36, 1.0 - 2.0**-52]), len(solution.zones) - 1
    )
    # The relative size of the next term is d/(distance to the next singularity), which is at
    # most 100 times 2^-36.
    assert nearer / near == pytest.approx(2.0 ** (-16 * power), rel=3e-9)


@pytest.mark.parametrize(
    ("periodic", "alone"),
    [
        (
            lambda period: exact.PeriodicParabola(1.0, period, 2.0, 0.1),
            exact.HertzLine(1.0, 2.0, 0.1),
        ),
        (
            lambda period: exact.PeriodicWedge(0.1, period, 2.0, 0.1),
            exact.IsolatedWedge(0.1, 2.0, 0.1),
        ),
        (
            lambda period: exact.PeriodicPunch(0.1, period, 2.0, 1.0),
            exact.IsolatedPunch(0.1, 2.0, 1.0),
        ),
        (
            lambda period: exact.LocalizedZone(exact.HertzLine(1.0, 2.0, 0.1), period),
            exact.HertzLine(1.0, 2.0, 0.1),
        ),
    ],
)
def test_a_long_period_tends_to_the_isolated_zone_as_its_inverse_square(periodic, alone):
    t = np.array([0.1, 0.5, 0.9])
    periods = np.array([4.0, 8.0, 16.0])
    errors = [
        np.max(np.abs(periodic(p).pressure_at(t) / alone.pressure_at(t) - 1.0)) for p in periods
    ]
    rate = np.polyfit(np.log(periods), np.log(errors), 1)[0]
    assert rate == pytest.approx(-2.0, abs=0.02)


def test_full_contact_of_the_sinusoid_continues_partial_contact():
    shape = dict(amplitude=1e-6, period=L, E_star=E_STAR)
    full = np.pi * E_STAR * 1e-6 / L
    partial, complete = exact.sinusoid((1 - 1e-12) * full, **shape), exact.sinusoid(full, **shape)
    assert isinstance(partial, exact.Westergaard) and isinstance(
        complete, exact.FullContactSinusoid
    )
    x = np.linspace(-0.4 * L, 0.4 * L, 9)
    np.testing.assert_allclose(partial.pressure(x), complete.pressure(x), rtol=1e-10)
    assert partial.approach == pytest.approx(complete.approach, rel=1e-10)
    assert complete.pressure(0.5 * L) == pytest.approx(0.0, abs=1e-15 * full)


def test_the_paper_s_localized_formulas_come_out():
    """Equations (23), (24), (26), (27), (29) and (30) of the paper, with arcosh(a/|x|).
    The paper is Goryacheva and Tsukanov (2020).
    """
    a, x = 0.3 * L, np.array([0.01, 0.1, 0.25]) * L
    root = np.sqrt(L * L - 4 * a * a)
    angle = np.arctan(2 * np.sqrt(a * a - x * x) / root)
    wedge = exact.LocalizedZone(exact.IsolatedWedge(0.02, E_STAR, a), L)
    p26 = E_STAR * 0.02 / np.pi * np.arccosh(a / x) + 2 * E_STAR * a * 0.02 / (np.pi * L) * angle
    np.testing.assert_allclose(wedge.pressure(x), p26, rtol=1e-13)
    assert wedge.mean_pressure == pytest.approx(E_STAR * a * 0.02 / L * (2 - root / L), rel=1e-14)
    parabola = exact.LocalizedZone(exact.HertzLine(2e-3, E_STAR, a), L)
    p29 = E_STAR / (2 * 2e-3) * np.sqrt(a * a - x * x) + E_STAR * a * a / (2 * 2e-3 * L) * angle
    np.testing.assert_allclose(parabola.pressure(x), p29, rtol=1e-13)
    assert parabola.load == pytest.approx(
        np.pi * E_STAR * a * a / (4 * 2e-3) * (2 - root / L), rel=1e-14
    )
    wave = exact.LocalizedZone(exact.IsolatedSinusoid(1e-6, L, E_STAR, a), L)
    # J_1(0.6 pi) and int_0^{0.6 pi} J_0, by Gauss-Legendre quadrature of integral
    # representations.
    node, weight = np.polynomial.legendre.leggauss(40)
    theta, z = 0.5 * np.pi * (node + 1), 0.6 * np.pi
    j1 = 0.5 * np.sum(weight * np.cos(theta - z * np.sin(theta)))
    int_j0 = 0.5 * np.sum(weight * np.sin(z * np.sin(theta)) / np.sin(theta))
    isolated = np.pi**2 * 1e-6 * E_STAR / L * a * j1
    assert wave.mean_pressure == pytest.approx(isolated / L * (2 - root / L), rel=1e-13)
    peak = np.pi * 1e-6 * E_STAR / L * int_j0 + 2 * isolated / (np.pi * L) * np.arctan(2 * a / root)
    assert wave.max_pressure == pytest.approx(peak, rel=1e-13)


def test_the_kuznetsov_load_is_the_paper_s():
    """Equation (28) of the paper: a = (L/pi) arccos exp(-2 pi P R/L^2 E*)."""
    load = 150.0
    zone = exact.PeriodicParabola.from_load(load, radius=2e-3, period=L, E_star=E_STAR)
    assert zone.half_width == pytest.approx(
        L / np.pi * np.arccos(np.exp(-2 * np.pi * load * 2e-3 / (L * L * E_STAR)))
    )
    assert zone.load == pytest.approx(load, rel=1e-14)


FAMILIES = [
    (exact.Westergaard, dict(amplitude=1e-6, period=L, E_star=E_STAR), np.pi * E_STAR * 1e-6),
    (exact.PeriodicParabola, dict(radius=2e-3, period=L, E_star=E_STAR), 1e6),
    (exact.PeriodicWedge, dict(wedge_slope=0.02, period=L, E_star=E_STAR), 1e6),
    (exact.HertzLine, dict(radius=2e-3, E_star=E_STAR), 1e6),
    (exact.IsolatedWedge, dict(wedge_slope=0.02, E_star=E_STAR), 1e6),
    (exact.IsolatedSinusoid, dict(amplitude=1e-6, wavelength=L, E_star=E_STAR), 2e5),
]


@pytest.mark.parametrize(("family", "shape", "most"), FAMILIES)
@pytest.mark.parametrize("share", (1e-9, 1e-3, 0.3, 0.99))
def test_the_load_asked_for_is_the_load_got(family, shape, most, share):
    zone = family.from_load(share * most, **shape)
    # Near full contact, round-off of the half width a is a large part of the distance L/2 - a.
    rel = 1e-13 if zone.period is None else 1e-13 + 1e-15 / (0.5 - zone.half_width / L)
    assert zone.load == pytest.approx(share * most, rel=rel)


@pytest.mark.parametrize("closure", ("first-order", "self-consistent"))
@pytest.mark.parametrize(
    ("family", "shape"),
    [
        (exact.HertzLine, dict(radius=2e-3, E_star=E_STAR)),
        (exact.IsolatedWedge, dict(wedge_slope=0.02, E_star=E_STAR)),
        (exact.IsolatedSinusoid, dict(amplitude=1e-6, E_star=E_STAR)),
    ],
)
def test_the_localized_load_asked_for_is_the_load_got(family, shape, closure):
    for load in (1e-3, 100.0, 5e4):
        assert exact.localized_at_load(family, load, L, closure, **shape).load == pytest.approx(
            load, rel=1e-12
        )


def test_loads_past_the_branch_from_zero_are_out_of_range():
    wave = dict(amplitude=1e-6, E_star=E_STAR)
    full = np.pi * E_STAR * 1e-6
    with pytest.raises(OutOfRange):
        exact.Westergaard.from_load(full, period=L, **wave)
    with pytest.raises(OutOfRange):
        exact.FullContactSinusoid(1e-6, L, E_STAR, 0.99 * full / L)
    with pytest.raises(OutOfRange):
        exact.IsolatedSinusoid.from_load(0.7 * full, wavelength=L, **wave)
    with pytest.raises(OutOfRange):
        exact.localized_at_load(exact.IsolatedSinusoid, 1.2 * full, L, **wave)


@pytest.mark.parametrize("wrong", (0.0, -1.0, np.nan, np.inf, True, "1", None))
def test_numbers_that_are_not_positive_are_refused_by_name(wrong):
    with pytest.raises(SceneError, match="radius"):
        exact.HertzLine(wrong, E_STAR, 1e-5)
    with pytest.raises(SceneError, match="half_width"):
        exact.Westergaard(1e-6, L, E_STAR, wrong)
    with pytest.raises(SceneError, match="load"):
        exact.IsolatedBiquadratic(2e-3, L, E_STAR, wrong)


def test_controls_refuse_wrong_shapes_by_name():
    with pytest.raises(SceneError, match="radius"):
        exact.HertzLine.from_load(1.0, radius=-1.0, E_star=1.0)
    with pytest.raises(SceneError, match="mean_pressure"):
        exact.sinusoid("2e7", amplitude=1e-6, period=L, E_star=E_STAR)
    with pytest.raises(SceneError, match="contact_fraction"):
        exact.PeriodicWedge.from_contact_fraction(1.0, wedge_slope=0.02, period=L, E_star=E_STAR)


def test_a_zone_as_wide_as_its_period_is_refused():
    with pytest.raises(SceneError, match="half_width"):
        exact.PeriodicWedge(0.02, L, E_STAR, 0.5 * L)


@dataclass(frozen=True)
class Perturbed:
    """A solution whose pressure is multiplied by 1 + 1e-8 t^2, with t = -1 and 1 at the ends."""

    true: exact.Westergaard
    zones = property(lambda self: self.true.zones)
    period = property(lambda self: self.true.period)
    E_star = property(lambda self: self.true.E_star)

    def slope(self, x):
        return self.true.slope(x)

    def pressure_at(self, t, zone=0):
        return self.true.pressure_at(t, zone) * (1.0 + 1e-8 * np.asarray(t) ** 2)


def test_a_pressure_off_by_one_part_in_1e8_fails_the_same_law():
    true = exact.Westergaard(1e-6, L, E_STAR, 0.3 * L)
    assert reference.equation_error(true) < TOL
    assert reference.equation_error(Perturbed(true)) > 100.0 * TOL


def test_exact_solutions_import_neither_the_solver_nor_the_engine():
    for file in Path(inspect.getfile(exact)).parent.glob("*.py"):
        lines = [
            line for line in file.read_text().splitlines() if line.startswith(("import ", "from "))
        ]
        assert not [
            line
            for line in lines
            if " sie" in line or re.search(r"contact\.(solve|search|formulation)", line)
        ]
