"""Designed JKR contacts are checked against laws that the design does not compute.
The laws are the singular integral equation, the load, the intensities and the potential.
"""

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given

from contact import JKR, Dugdale, exact, inverse
from contact.errors import SceneError
from tests.contact import reference
from tests.contact.strategies import adhesive_designs

TOL = 2e-11


def nodes(problem):
    """Number of quadrature nodes at which only round-off is left (test_inverse.py, nodes_for)."""
    return 200 + int(40 / np.sqrt(min(problem.nearness, 1.0)))


@given(adhesive_designs())
def test_the_pressure_solves_the_singular_integral_equation_and_carries_the_load(problem):
    assert reference.equation_error(problem, nodes=nodes(problem)) < TOL
    assert reference.load_of(problem, nodes(problem)) == pytest.approx(problem.load, rel=1e-11)
    assert np.sum(problem.zone_loads) == pytest.approx(problem.load, rel=1e-12)


@given(adhesive_designs())
def test_every_end_carries_the_intensity_and_the_gap_that_release_the_work_of_adhesion(problem):
    assert problem.is_admissible
    ends = problem.zones.ravel()
    for zone, width in enumerate(problem.zone_widths):
        d = 2.0**-40 * 0.5 * width
        for side in (-1.0, 1.0):
            p = problem.pressure_at(side * (1.0 - 2.0**-40), zone)
            assert -p * np.sqrt(d) == pytest.approx(problem.intensity, rel=1e-4)
    gaps = np.append(
        np.diff(ends)[1::2], problem.period + ends[0] - ends[-1] if problem.period else np.ptp(ends)
    )
    for end, room in zip(ends[1::2], gaps, strict=True):
        d = 1e-8 * min(room, np.min(problem.zone_widths))
        x = end + d  # x is rounded, so the distance is x - end below
        # The gap opens as (4/E*) K sqrt(d), since the energy release rate is (pi/E*) K^2 = w.
        assert problem.gap(x) == pytest.approx(
            4.0 / problem.E_star * problem.intensity * np.sqrt(x - end), rel=1e-3
        )


@given(adhesive_designs(periodic=True))
def test_the_displacement_is_the_logarithmic_potential_of_the_pressure(problem):
    """The pressure alone determines the approach, the gaps between all zones and the heights."""
    ends = np.append(problem.zones.ravel(), problem.zones[0, 0] + problem.period)
    x = np.concatenate(
        [
            b + (a - b) * np.array([0.1, 0.5, 0.9])
            for b, a in zip(ends[1::2], ends[2::2], strict=True)
        ]
    )
    u = reference.displacement_of(problem, x, 4 * nodes(problem))
    scale = np.max(np.abs(u)) + np.max(np.abs(problem.height(x)))
    np.testing.assert_allclose(problem.displacement(x), u, rtol=0.0, atol=1e-10 * scale)


@dataclass(frozen=True)
class WithDatum:
    """An isolated design with a datum, which the potential needs."""

    problem: inverse.AdhesiveDesign
    datum: float
    zones = property(lambda self: self.problem.zones)
    period = None
    E_star = property(lambda self: self.problem.E_star)

    def pressure_at(self, t, zone=0):
        return self.problem.pressure_at(t, zone)


@given(adhesive_designs(periodic=False))
def test_alone_all_zones_have_one_approach(problem):
    """The approach u + f - gap is the same in the middles of all gaps and outside all zones."""
    ends = problem.zones.ravel()
    x = np.append(
        0.5 * (ends[1:-1:2] + ends[2::2]),
        [ends[0] - 0.1 * np.ptp(ends), ends[-1] + 0.2 * np.ptp(ends)],
    )
    u = reference.displacement_of(WithDatum(problem, float(np.ptp(ends))), x, 4 * nodes(problem))
    level = u + problem.height(x) - problem.gap(x)
    scale = np.max(np.abs(u)) + np.ptp(problem.height(x)) + np.max(problem.gap(x))
    assert np.ptp(level) < 1e-10 * scale


@given(adhesive_designs())
def test_the_gap_closes_from_either_side(problem):
    """The slope of the gap, integrated from either end, gives the same gap in the middle."""
    ends = problem.zones.ravel()
    for left, right in zip(ends[1:-1:2], ends[2::2], strict=True):
        step = 1e-9 * (right - left)
        before, after = problem.gap(0.5 * (left + right) + np.array([-step, step]))
        assert before == pytest.approx(after, rel=1e-7)


def test_one_zone_is_johnson_s_wave_or_the_cylinder():
    wave = exact.JKRZone(exact.Westergaard(1e-6, 1e-4, 1.1e11, 3e-5), 0.05)
    one = inverse.AdhesiveDesign(wave.zones, 1.1e11, wave.load, 0.05, 1e-4)
    t, x = np.linspace(-0.999, 0.999, 21), np.linspace(-6e-5, 6e-5, 25)
    np.testing.assert_allclose(one.pressure_at(t), wave.pressure_at(t), rtol=1e-11)
    np.testing.assert_allclose(one.gap(x), wave.gap(x), rtol=1e-11, atol=1e-24)
    assert one.profile.cosine == pytest.approx([-1e-6], rel=1e-13)
    assert one.approach == pytest.approx(wave.approach, rel=1e-12)
    assert one.max_pressure == pytest.approx(wave.max_pressure, rel=1e-12)
    cylinder = exact.JKRZone(exact.HertzLine(2e-3, 1.1e11, 3e-5), 0.05)
    alone = inverse.AdhesiveDesign(cylinder.zones, 1.1e11, cylinder.load, 0.05)
    np.testing.assert_allclose(alone.pressure_at(t), cylinder.pressure_at(t), rtol=1e-11)
    np.testing.assert_allclose(
        alone.profile.coefficients, [0.0, 0.0, 250.0], rtol=1e-12, atol=1e-18
    )


@given(adhesive_designs())
def test_the_second_variation_is_symmetric_and_positive_where_the_design_is_stable(problem):
    """The formula of the matrix does not assume that second derivatives are symmetric."""
    matrix = inverse.second_variation(problem)
    assert np.max(np.abs(matrix - matrix.T)) < 1e-10 * np.max(np.abs(matrix))
    assert inverse.is_stable(problem)


@pytest.mark.parametrize("share", (0.05, 0.25, 0.45))
def test_the_second_variation_of_ends_that_move_together_follows_from_the_load(share):
    """For one zone of half width a, dG/da = 2 w (dP/da)/Q at a given load P.
    G is the energy release rate, w the work of adhesion, and Q the load that adhesion takes
    from P. Two waves in a period of twice the length have the same matrix.
    """
    state = exact.JKRZone(exact.Westergaard(0.02, 2.0, 3.0, share * 2.0), 1e-3)
    rate = exact.JKRWave(0.02, 2.0, 3.0, 1e-3)._rates(state.half_width)[0]
    one = inverse.second_variation(inverse.AdhesiveDesign(state.zones, 3.0, state.load, 1e-3, 2.0))
    assert np.sum(one, axis=1) == pytest.approx(
        np.full(2, 2e-3 * rate / state.punch.load), rel=1e-10
    )
    zones = np.concatenate([state.zones, state.zones + 2.0])
    two = inverse.second_variation(inverse.AdhesiveDesign(zones, 3.0, 2.0 * state.load, 1e-3, 4.0))
    np.testing.assert_allclose(
        two[:2, :2] + two[:2, 2:], one, rtol=0.0, atol=1e-10 * np.max(np.abs(one))
    )


def released(design, ends, terms=60):
    """The energy release rates G at given ends, with the design's profile and load.
    The pressure on each zone is a Chebyshev series over sqrt(1 - t^2). The equation is
    collocated, and u + f is equal in the middles of all zones.
    """
    zones = ends.reshape(-1, 2)
    half, middle = 0.5 * np.diff(zones)[:, 0], zones.mean(axis=1)
    k, psi = np.arange(terms), np.arange(1, terms) * np.pi / terms

    def transform(zone, x):
        s = (x - middle[zone]) / half[zone]
        root = np.sign(s) * np.sqrt(s * s - 1.0)
        return (1.0 / (s + root))[:, None] ** k / root[:, None]

    def potential(zone, x):
        s = (x - middle[zone]) / half[zone]
        v = s + np.sign(s) * np.sqrt(s * s - 1.0) if abs(s) > 1.0 else 1j
        series = np.append(
            -np.log(0.5 * half[zone] * abs(v)), (np.real(v ** -k[1:].astype(float)) / k[1:])
        )
        return 2.0 / design.E_star * half[zone] * series

    count = range(len(zones))
    rows, right = [], []
    for zone in count:
        x = middle[zone] + half[zone] * np.cos(psi)
        own = -np.sin(np.outer(psi, k)) / np.sin(psi)[:, None]
        rows.append(np.hstack([own if other == zone else transform(other, x) for other in count]))
        right.append(0.5 * design.E_star * design.slope(x))
    level = np.array([np.hstack([potential(zone, x) for zone in count]) for x in middle])
    load = np.hstack([np.where(k == 0, np.pi * h, 0.0) for h in half])
    rows += [level[1:] - level[0], load[None]]
    right += [design.height(middle[0]) - design.height(middle[1:]), [design.load]]
    c = np.linalg.solve(np.vstack(rows), np.concatenate(right)).reshape(len(zones), terms)
    tips = np.stack([c @ (-1.0) ** k, c.sum(axis=1)], axis=1) * np.sqrt(0.5 * half)[:, None]
    return np.pi / design.E_star * tips.ravel() ** 2


@pytest.mark.parametrize(("seed", "zones"), [(0, 1), (1, 2), (2, 3)])
def test_the_second_variation_is_the_derivative_of_the_energy_release_rates_of_a_direct_solution(
    seed, zones
):
    problem = inverse.random_adhesive_problem(np.random.default_rng(seed), zones, None, spread=4.0)
    ends, step = problem.zones.ravel(), 1e-3 * min(np.diff(problem.zones.ravel()))
    assert released(problem, ends) == pytest.approx(np.full(2 * zones, problem.work), rel=1e-10)
    matrix = inverse.second_variation(problem)
    for j in range(2 * zones):
        move = np.where(np.arange(2 * zones) == j, step if j % 2 else -step, 0.0)
        near = [released(problem, ends + v * move) for v in (-2, -1, 1, 2)]
        slope = (near[0] - 8.0 * near[1] + 8.0 * near[2] - near[3]) / (12.0 * step)
        np.testing.assert_allclose(
            slope, matrix[:, j], rtol=0.0, atol=1e-8 * np.max(np.abs(matrix))
        )


def test_little_work_of_adhesion_leaves_the_frictionless_design():
    free = inverse.random_problem(np.random.default_rng(4), 5, 1.0)
    t = np.linspace(-0.9, 0.9, 9)
    sizes = []
    for work in (1e-12, 1e-16):
        sticky = inverse.AdhesiveDesign(free.zones, free.E_star, free.load, work, 1.0)
        sizes.append(np.max(np.abs(sticky.pressure_at(t, 2) - free.pressure_at(t, 2))))
    assert sizes[0] / sizes[1] == pytest.approx(100.0, rel=1e-3)  # as the square root of the work


def test_a_design_for_another_work_of_adhesion_fails_the_law_of_the_ends():
    problem = inverse.random_adhesive_problem(np.random.default_rng(3), 3, 1.0)
    wrong = inverse.AdhesiveDesign(
        problem.zones, problem.E_star, problem.load, 1.001 * problem.work, 1.0
    )
    d = 2.0**-41 * problem.zone_widths[1]
    for design, holds in ((problem, True), (wrong, False)):
        found = -design.pressure_at(1.0 - 2.0**-40, 1) * np.sqrt(d)
        assert bool(abs(found / problem.intensity - 1.0) < 1e-4) is holds


@dataclass(frozen=True)
class Perturbed:
    """A design whose pressure is multiplied by 1 + 1e-8 t^2."""

    true: inverse.AdhesiveDesign
    zones = property(lambda self: self.true.zones)
    period = property(lambda self: self.true.period)
    E_star = property(lambda self: self.true.E_star)

    def slope(self, x):
        return self.true.slope(x)

    def pressure_at(self, t, zone=0):
        return self.true.pressure_at(t, zone) * (1.0 + 1e-8 * np.asarray(t) ** 2)


def test_a_pressure_off_by_one_part_in_1e8_fails_the_equation():
    problem = inverse.random_adhesive_problem(np.random.default_rng(3), 3, 1.0)
    assert reference.equation_error(problem, nodes=nodes(problem)) < TOL
    assert reference.equation_error(Perturbed(problem), nodes=nodes(problem)) > 10.0 * TOL


def test_zones_work_and_period_are_refused_by_name():
    with pytest.raises(SceneError, match="work"):
        inverse.AdhesiveDesign([[0.0, 1.0]], 1.0, 1.0, 0.0)
    with pytest.raises(SceneError, match="zones"):
        inverse.AdhesiveDesign([[0.0, 1.0], [1.0, 2.0]], 1.0, 1.0, 1.0)
    with pytest.raises(SceneError, match="zones"):
        inverse.AdhesiveDesign([[0.0, 1.0]], 1.0, 1.0, 1.0, period=1.0)


def test_design_returns_the_design_of_each_law_and_refuses_wrong_arguments():
    zones, cohesive = [[-1.0, 1.0]], [[-1.2, 1.2]]
    assert isinstance(inverse.design(zones, 1.0, 0.1), inverse.DesignedContact)
    sticky = inverse.design(zones, 1.0, -0.1, law=JKR(1e-3))
    assert isinstance(sticky, inverse.AdhesiveDesign) and sticky.work == 1e-3
    law = Dugdale(2.5e-4, 0.02)
    pulled = inverse.design(zones, 1.0, 0.1, law=law, cohesive=cohesive)
    assert isinstance(pulled, inverse.CohesiveDesign)
    assert pulled.load == pytest.approx(0.1, rel=1e-12)
    for wrong in (dict(law=law), dict(cohesive=cohesive), dict(law="jkr")):
        with pytest.raises(SceneError):
            inverse.design(zones, 1.0, 0.1, **wrong)
