"""Closed forms with adhesion are checked against laws that they do not contain.
The laws are the singular integral equation, the logarithmic potential, and the intensity at the
ends. In addition, the work of the load is the change of elastic and surface energy.
"""

from dataclasses import dataclass, replace

import mpmath
import numpy as np
import pytest

from contact import exact
from contact.errors import OutOfRange, SceneError
from tests.contact import reference
from tests.tiers import diagonal

L = 2.0
E_STAR = 3.0
DATUM = 2.0 * L
WAVE = dict(amplitude=0.02, period=L, E_star=E_STAR)
CYLINDER = dict(radius=0.8, E_star=E_STAR, datum=DATUM)
# The quadrature sums 400 terms about ten times as large as the result; 4000 eps is about 1e-12.
TOL = 1e-12


def frictionless():
    for share in (0.05, 0.25, 0.45):
        yield exact.Westergaard(0.02, L, E_STAR, share * L)
        yield exact.PeriodicParabola(0.8, L, E_STAR, share * L)
    yield exact.HertzLine(0.8, E_STAR, 0.3 * L, DATUM)
    yield exact.IsolatedSinusoid(0.02, L, E_STAR, 0.2 * L, DATUM)


def jkr_zones():
    for zone in frictionless():
        for work in (1e-7, 1e-3, 0.1):
            yield exact.JKRZone(zone, work)


def dugdale_zones():
    for zone in frictionless():
        room = 0.5 * L - zone.half_width
        for share, stress in ((1e-3, 2.0), (0.3, 0.01), (0.95, 0.3)):
            yield exact.DugdaleZone(zone, stress, zone.half_width + share * room)
    for share in (0.05, 0.45):
        yield exact.MetDugdaleZone(exact.Westergaard(0.02, L, E_STAR, share * L), 0.05, 0.01)


JKR, DUGDALE = list(jkr_zones()), list(dugdale_zones())


def name(state):
    of = f"{type(state).__name__}-{type(state.zone).__name__}{state.half_width / L:.3g}"
    return of + (
        f"-{state.work:.1g}"
        if isinstance(state, exact.JKRZone)
        else f"-{state.cohesive_end / L:.3g}"
    )


@pytest.mark.parametrize("state", JKR, ids=name)
def test_the_pressure_solves_the_singular_integral_equation_and_carries_the_load(state):
    # Round-off grows with the ratio of the load that adhesion takes to the load without
    # adhesion.
    assert reference.equation_error(state) < TOL * (1.0 + state.punch.load / state.zone.load)
    assert reference.load_of(state) == pytest.approx(
        state.load, rel=1e-12, abs=1e-12 * state.punch.load
    )


@pytest.mark.parametrize("state", JKR, ids=name)
def test_the_displacement_outside_is_the_potential_of_the_pressure(state):
    x = state.half_width + (0.5 * L - state.half_width) * np.array([1e-3, 0.3, 0.7, 1.0])
    u = state.displacement(x)
    scale = np.max(np.abs(u)) + np.max(state.gap(x))
    np.testing.assert_allclose(
        reference.displacement_of(state, x, 2000), u, rtol=0.0, atol=1e-11 * scale
    )
    assert np.all(state.gap(x) > 0.0)


@pytest.mark.parametrize("state", JKR, ids=name)
def test_the_energy_released_at_the_ends_is_the_work_of_adhesion(state):
    """Irwin: pi K^2/E* is the work of adhesion, with the intensity K of the pressure at an end.
    At the distance d the gap is 4 K sqrt(d)/E*, so (pi/4) K gap/sqrt(d) is this work, too.
    """
    d = state.half_width * 2.0**-40
    inside = -state.pressure_at(1.0 - 2.0**-40) * np.sqrt(d)
    assert inside == pytest.approx(state.intensity, rel=1e-5)
    assert np.pi * inside**2 / E_STAR == pytest.approx(state.work, rel=1e-5)
    opening = state._gap(np.array(d)) / np.sqrt(d)
    assert 0.25 * np.pi * inside * opening == pytest.approx(state.work, rel=1e-5)


def cohesive_potential(state, x):
    """The displacement by the uniform traction -s on |xi| < c, as its logarithmic potential."""
    c = state.cohesive_end
    if state.period is None:

        def whole(t):
            return t * np.log(np.maximum(np.abs(t), 1e-300) / DATUM) - t
    else:

        def whole(t):
            return np.array(
                [-L / (2 * np.pi) * float(mpmath.clsin(2, 2 * np.pi * v / L)) for v in t]
            )

    return 2.0 * state.stress / (np.pi * state.E_star) * (whole(x + c) - whole(x - c))


@dataclass(frozen=True)
class Excess:
    """The pressure plus the stress: zero at the ends, so that Gauss-Chebyshev quadrature holds.
    It is multiplied by 1 + off t^2.
    """

    state: object
    off: float = 0.0
    zones = property(lambda self: self.state.zones)
    period = property(lambda self: self.state.period)
    E_star = property(lambda self: self.state.E_star)
    datum = property(lambda self: self.state.datum)

    def pressure_at(self, t, zone=0):
        p = self.state.pressure_at(t, zone) + self.state.stress
        return p * (1.0 + self.off * np.asarray(t) ** 2)


def nodes(state):
    """Number of quadrature nodes.
    The arctan in the pressure has a pole at the relative distance (c - a)/a from the zone.
    """
    return int(min(300 + 60 / np.sqrt((state.cohesive_end - state.half_width) / L), 4000))


def cohesive_error(state, off=0.0):
    """Largest |transform of the tractions - (E*/2) f'|, divided by the largest term.
    The transform of the uniform tension has a closed form.
    """
    x, excess = reference.transform(Excess(state, off), 0, state.period, nodes(state))
    c = state.cohesive_end
    sin = (lambda v: v) if state.period is None else (lambda v: np.sin(np.pi * v / L))
    uniform = (
        0.0 if c == 0.5 * L else -state.stress / np.pi * np.log(np.abs(sin(x + c) / sin(x - c)))
    )
    right = 0.5 * E_STAR * state.slope(x)
    return np.max(np.abs(excess + uniform - right)) / max(np.max(np.abs(right)), state.stress)


@pytest.mark.parametrize("state", DUGDALE, ids=name)
def test_contact_and_cohesive_tractions_solve_the_equation_and_carry_the_load(state):
    assert cohesive_error(state) < TOL * nodes(state) / 300
    total = reference.load_of(Excess(state), nodes(state)) - 2.0 * state.stress * state.cohesive_end
    assert total == pytest.approx(
        state.load, rel=0.0, abs=1e-12 * (state.zone.load + state.stress * L)
    )
    assert state.pressure(0.5 * (state.half_width + state.cohesive_end)) == -state.stress


@pytest.mark.parametrize("state", DUGDALE, ids=name)
def test_approach_and_gap_on_either_side_of_the_cohesive_end_are_the_potential_of_the_tractions(
    state,
):
    a, c = state.half_width, state.cohesive_end
    x = np.unique([a + 1e-3 * (c - a), 0.5 * (a + c), c, 0.5 * (c + 0.5 * L), 0.5 * L])
    u = reference.displacement_of(Excess(state), x, 4 * nodes(state)) + cohesive_potential(state, x)
    scale = np.max(np.abs(u)) + np.max(state.gap(x)) + state.stress * L / E_STAR
    np.testing.assert_allclose(state.displacement(x), u, rtol=0.0, atol=1e-11 * scale)


@pytest.mark.parametrize(
    "state", [s for s in DUGDALE if isinstance(s, exact.DugdaleZone)], ids=name
)
def test_contact_ends_under_cohesion_are_bounded_and_the_gap_opens_without_overlap(state):
    near, nearer = state.pressure_at(np.array([1.0 - 2.0**-40, 1.0 - 2.0**-48])) + state.stress
    assert nearer / near == pytest.approx(2.0**-4, rel=1e-3)
    e = (0.5 * L - state.half_width) * np.array([1e-8, 1e-4, 0.1, 0.5, 1.0])
    assert np.all(state._gap(e) > 0.0)


CURVES = [
    (exact.JKRWave(**WAVE, work=2e-4), (0.05, 0.3, 0.7, 0.95)),
    (exact.JKRCylinder(**CYLINDER, work=2e-4), (0.01, 0.1, 0.4)),
    (exact.DugdaleWave(**WAVE, work=2e-4, stress=0.03), (0.75, 0.95, 1.02, 1.2)),
    (exact.DugdaleWave(**WAVE, work=2e-4, stress=1.0), (0.1, 0.6, 0.95)),
    (exact.DugdaleWave(**WAVE, work=2e-4, stress=0.004), (1.1, 1.5)),
    (exact.DugdaleCylinder(**CYLINDER, work=2e-4, stress=0.03), (0.4, 1.2)),
    (exact.DugdaleCylinder(**CYLINDER, work=2e-4, stress=0.5), (0.1, 0.8)),
]
PLACES = [(curve, 0.5 * L * share) for curve, shares in CURVES for share in shares]


def slopes(states_of, middle, *quantities):
    """Derivatives by t at t = 0, from the polynomial through 11 Chebyshev points in (-1, 1).
    The place is middle (1 + 0.02 t), or middle + 0.01 t if middle is at least 0.5.
    """
    t = np.cos(np.pi * (np.arange(11) + 0.5) / 11)
    states = [
        states_of(middle * (1.0 + 0.02 * v) if middle < 0.5 else middle + 0.01 * v) for v in t
    ]
    for quantity in quantities:
        values = np.array([getattr(s, quantity) for s in states])
        yield np.polynomial.Chebyshev.fit(t, values - values[5], 10, domain=[-1, 1]).deriv()(0.0)


@pytest.mark.parametrize(("curve", "place"), PLACES)
def test_the_work_of_the_load_is_the_change_of_elastic_and_surface_energy(curve, place):
    state = curve.at(place)
    energy, approach, surface = slopes(curve.at, place, "energy", "approach", "surface_energy")
    assert state.work == pytest.approx(curve.work, rel=1e-11)
    assert energy == pytest.approx(state.load * approach, rel=1e-8, abs=1e-9 * abs(surface))


def test_a_work_of_adhesion_off_by_one_part_in_1e5_fails_the_energy_law():
    curve = CURVES[0][0]
    state = curve.at(0.3)
    energy, approach, surface = slopes(
        curve.at, 0.3, "elastic_energy", "approach", "surface_energy"
    )
    assert abs(energy + surface - state.load * approach) < 1e-9 * abs(surface)
    assert abs(energy + (1.0 + 1e-5) * surface - state.load * approach) > 1e-6 * abs(surface)


@pytest.mark.parametrize("state", [s for s in JKR + DUGDALE if s.work > 1e-5], ids=name)
def test_the_elastic_energy_is_half_the_tractions_times_the_displacement(state):
    a = state.half_width
    count = 4000
    phi, _, _, load = reference.zone_rule(
        Excess(state) if hasattr(state, "stress") else state, 0, count
    )
    total = float(np.sum(load * (state.approach - state.height(a * np.cos(phi)))))
    if hasattr(state, "stress"):
        # The tension acts on |x| < c. There u = approach - f in contact; in the strips the gap
        # is added.
        node, weight = np.polynomial.legendre.leggauss(200)
        inside = state.approach - state.height(0.5 * a * (node + 1.0))
        total -= state.stress * a * float(np.sum(weight * inside))
        length = state.cohesive_end - a
        outside = state.displacement(a + length * reference.FOLD_LEFT)
        total -= 2.0 * state.stress * length * float(np.sum(reference.FOLD_WEIGHT * outside))
    scale = abs(total) + state.zone.load * abs(state.approach)
    assert state.elastic_energy == pytest.approx(0.5 * total, rel=0.0, abs=1e-9 * scale)


@pytest.mark.parametrize(("curve", "place"), PLACES)
def test_the_rates_that_decide_stability_are_the_derivatives_along_the_curve(curve, place):
    load, approach = slopes(curve.at, place, "load", "approach")
    width = 0.02 * place if place < 0.5 else 0.01
    by_load, by_approach = curve._rates(place)
    assert by_load * width == pytest.approx(load, rel=1e-8)
    assert by_approach * width == pytest.approx(approach, rel=1e-8)


@pytest.mark.parametrize(("curve", "machine"), diagonal([c for c, _ in CURVES], (np.inf, 0.0, 0.5)))
def test_pull_off_is_the_minimum_of_what_the_machine_controls(curve, machine):
    """The machine controls approach + compliance * load, or the load if compliance is infinite."""
    if not curve.turning_points(machine):
        return
    state = curve.pull_off(machine)
    place = state.half_width if "JKR" in type(curve).__name__ else state.cohesive_end

    def held(s):
        return s.load if machine == np.inf else s.approach + machine * s.load

    for step in (1e-3, 1e-2):
        assert held(curve.at(place * (1.0 + step))) > held(state)
        if place * (1.0 - step) > curve._samples()[0]:  # contact begins at the first sample
            assert held(curve.at(place * (1.0 - step))) > held(state)


def test_the_cylinder_pulls_off_at_barquins_load_and_its_pull_off_does_not_depend_on_the_datum_under_a_held_load():
    curve = exact.JKRCylinder(radius=0.8, E_star=E_STAR, work=2e-4)
    state = curve.pull_off()
    assert state.load == pytest.approx(curve.pull_off_load, rel=1e-13)
    assert state.half_width**3 == pytest.approx(2 * 0.8**2 * 2e-4 / (np.pi * E_STAR), rel=1e-12)
    assert replace(curve, datum=DATUM).pull_off().load == pytest.approx(state.load, rel=1e-13)
    with pytest.raises(OutOfRange, match="stable branch goes from"):
        curve.at_load(1.01 * curve.pull_off_load)
    with pytest.raises(SceneError, match="datum"):
        _ = state.energy


def test_a_wave_closes_by_itself_from_the_work_where_the_largest_load_of_partial_contact_is_zero():
    curve = exact.JKRWave(**WAVE, work=1e-4)
    closing = replace(curve, work=curve.self_closing_work)
    widths = np.linspace(0.2, 0.49, 2001) * L
    most = max(closing.at(a).load for a in widths[(widths > 0.3 * L)])
    assert most == pytest.approx(0.0, abs=1e-6 * np.pi * E_STAR * 0.02)
    assert closing.jump_into_full_contact.load == pytest.approx(0.0, abs=1e-13)
    last = replace(curve, work=curve.last_partial_work * (1.0 + 1e-6))
    assert np.all(np.diff([last.at(a).load for a in widths]) < 0.0)
    assert len(replace(curve, work=curve.last_partial_work * (1.0 - 1e-6)).turning_points()) == 2
    with pytest.raises(OutOfRange):
        last.pull_off()


def test_the_wave_has_three_equilibria_between_pull_off_and_the_jump_into_full_contact():
    curve = exact.JKRWave(**WAVE, work=2e-4)
    low, high = curve.pull_off().load, curve.jump_into_full_contact.load
    load = 0.7 * low
    widths = [s.half_width for s in curve.all_at_load(load)]
    assert len(widths) == 3
    assert [curve.is_stable(a) for a in widths] == [False, True, False]
    for branch, a in zip(("narrow", "stable", "wide"), widths, strict=True):
        state = curve.at_load(load, branch)
        assert state.half_width == pytest.approx(a, rel=1e-12)
        assert state.load == pytest.approx(load, rel=1e-12)
    assert len(curve.all_at_load(0.5 * high)) == 2
    assert curve.all_at_load(1.01 * high) == []
    # Under a given approach the wave closes without a jump.
    assert len(curve.turning_points(0.0)) == 1
    for share in (0.1, 0.5, 0.999):
        assert curve.at_approach(share * 0.02).approach == pytest.approx(share * 0.02, rel=1e-12)


def test_loading_jumps_in_and_into_full_contact_and_unloading_comes_back_another_way():
    wave = exact.JKRWave(**WAVE, work=2e-4)
    jump = wave.jump_into_full_contact.load
    assert wave.advancing(0.0).half_width == pytest.approx(wave.jump_in.half_width, rel=1e-12)
    assert wave.advancing(0.99 * jump).half_width > wave.jump_in.half_width
    assert wave.advancing(1.01 * jump) is None and wave.receding(0.0) is None
    with pytest.raises(OutOfRange, match="pull-off is at"):
        wave.advancing(1.01 * wave.pull_off().load)
    assert replace(wave, work=1.01 * wave.self_closing_work).advancing(0.0) is None
    soft = exact.DugdaleWave(**WAVE, work=2e-4, stress=0.05)
    upper = soft._part("stable", np.inf)[1]
    load = soft.at(upper).load
    opening = soft.opening_mean_pressure * L
    assert soft.advancing(0.5 * load).load == pytest.approx(0.5 * load, rel=1e-11)
    jumped, closed = soft.advancing(1.001 * load), soft.receding(1.001 * load)
    assert (
        jumped is None
        if 1.001 * load > opening
        else jumped.half_width == pytest.approx(closed.half_width, rel=1e-11)
    )
    assert soft.receding(1.001 * opening) is None
    assert soft.receding(0.999 * opening).half_width > soft.at(upper).half_width


@pytest.mark.parametrize(
    ("jkr", "dugdale"),
    [
        pytest.param(
            exact.JKRWave(**WAVE, work=2e-4),
            lambda s: exact.DugdaleWave(**WAVE, work=2e-4, stress=s),
            marks=pytest.mark.slow,
        ),
        (
            exact.JKRCylinder(**CYLINDER, work=2e-4),
            lambda s: exact.DugdaleCylinder(**CYLINDER, work=2e-4, stress=s),
        ),
    ],
)
def test_the_pull_off_tends_to_jkr_as_the_inverse_square_of_the_stress(jkr, dugdale):
    """Under large stresses s, a cohesive interval is pi E* w/(4 s^2) long.
    This is the first correction of the half width of contact.
    """
    stresses = np.array([0.5, 1.0, 2.0, 4.0])
    exact_load, exact_width = jkr.pull_off().load, jkr.pull_off().half_width
    states = [dugdale(s).pull_off() for s in stresses]
    widths = [abs(s.half_width / exact_width - 1.0) for s in states]
    assert np.polyfit(np.log(stresses[1:]), np.log(widths[1:]), 1)[0] == pytest.approx(
        -2.0, abs=0.05
    )
    # Dugdale's interval beside a crack with K_I^2 = 2 E* w has the length pi K_I^2/(8 s^2).
    last = states[-1]
    length = 0.25 * np.pi * E_STAR * 2e-4 / stresses[-1] ** 2
    assert last.cohesive_end - last.half_width == pytest.approx(length, rel=0.02)
    assert last.load == pytest.approx(exact_load, rel=1e-5)


@pytest.mark.parametrize("law", ("jkr", "dugdale"))
def test_weak_adhesion_tends_to_the_frictionless_zone(law):
    zone = exact.Westergaard(0.02, L, E_STAR, 0.5)
    works = (1e-10, 1e-14) if law == "jkr" else (1e-12,)
    for work in works:
        if law == "jkr":
            state = exact.JKRZone(zone, work)
            assert state.load / zone.load - 1.0 == pytest.approx(
                -state.punch.load / zone.load, rel=1e-6
            )
            assert state.punch.load / zone.load < 20.0 * np.sqrt(work / (E_STAR * 0.02**2))
        else:
            curve = exact.DugdaleWave(**WAVE, work=work, stress=1e-3)
            state = curve.at_load(zone.load)
            assert state.half_width == pytest.approx(zone.half_width, rel=1e-2)


def test_gap_load_and_approach_of_a_cohesive_wave_are_those_of_its_tractions_by_mpmath():
    state = exact.DugdaleZone(exact.Westergaard(0.02, L, E_STAR, 0.3 * L), 0.3, 0.45 * L)
    with mpmath.workdps(20):
        a, c = mpmath.mpf(state.half_width), mpmath.mpf(state.cohesive_end)
        low, high = mpmath.pi * a / L, mpmath.pi * c / L

        def pressure(u):
            full = (
                2
                * mpmath.pi
                * E_STAR
                * 0.02
                / L
                * mpmath.cos(u)
                * mpmath.sqrt(mpmath.sin(low) ** 2 - mpmath.sin(u) ** 2)
            )
            ratio = (mpmath.sin(high) ** 2 - mpmath.sin(low) ** 2) / (
                mpmath.sin(low) ** 2 - mpmath.sin(u) ** 2
            )
            return full - 0.6 / mpmath.pi * mpmath.atan(
                mpmath.cos(u) / mpmath.cos(high) * mpmath.sqrt(ratio)
            )

        def potential(at):
            def both(u):
                return mpmath.log(abs(4 * mpmath.sin(at - u) * mpmath.sin(at + u)))

            total = mpmath.quad(lambda u: pressure(u) * both(u), [0, low]) - 0.3 * mpmath.quad(
                both, [low, high]
            )
            return -2 * total * L / (mpmath.pi**2 * E_STAR)

        approach = potential(low) + 0.04 * mpmath.sin(low) ** 2
        gap = potential(high) + 0.04 * mpmath.sin(high) ** 2 - approach
        mean = (2 * mpmath.quad(pressure, [0, low]) - 0.6 * (high - low)) / mpmath.pi
    assert state.approach == pytest.approx(float(approach), rel=1e-12)
    assert state.end_gap == pytest.approx(float(gap), rel=1e-12)
    assert state.mean_pressure == pytest.approx(float(mean), rel=1e-12)


def test_the_cylinder_under_cohesion_is_baney_and_hui_s():
    curve = exact.DugdaleCylinder(radius=0.8, E_star=E_STAR, work=2e-4, stress=0.05)
    unit = (8.0 * 0.8**2 * 2e-4 / (np.pi * E_STAR)) ** (1.0 / 3.0)
    for c in (0.2, 0.5):
        state = curve.at(c)
        a, m = state.half_width / unit, c / state.half_width
        mu, lam = np.sqrt(m * m - 1.0), curve.tabor
        assert state.load / (np.pi * E_STAR * 2e-4**2 * 0.8) ** (1 / 3) == pytest.approx(
            a * a - lam * a * mu, rel=1e-11
        )
        first = 0.5 * lam * a * a * (m * mu - np.log(m + mu))
        assert first + 0.5 * lam**2 * a * (mu * np.log(m + mu) - m * np.log(m)) == pytest.approx(
            1.0, rel=1e-11
        )


def test_cohesive_intervals_meet_without_a_jump_of_load_and_open_full_contact_at_the_valley_s_strength():
    curve = exact.DugdaleWave(**WAVE, work=2e-4, stress=0.03)
    before, after = curve.at(0.5 * L * (1 - 1e-9)), curve.at(0.5 * L)
    assert isinstance(before, exact.DugdaleZone) and isinstance(after, exact.MetDugdaleZone)
    assert before.half_width == pytest.approx(after.half_width, rel=1e-6)
    assert before.load == pytest.approx(after.load, rel=1e-6)
    assert after.end_gap == pytest.approx(2e-4 / 0.03, rel=1e-12)
    closed = exact.MetDugdaleZone(
        exact.Westergaard(0.02, L, E_STAR, 0.5 * L * (1 - 1e-9)), 0.03, 2e-4
    )
    assert closed.mean_pressure == pytest.approx(curve.opening_mean_pressure, rel=1e-12)
    with pytest.raises(OutOfRange, match="meet only if"):
        exact.MetDugdaleZone(exact.Westergaard(0.02, L, E_STAR, 0.1), 0.03, 2e-4)


def test_a_pressure_off_by_one_part_in_1e8_fails_the_same_laws():
    """Under JKR's law the work of adhesion is wrong by 1e-8, under Dugdale's law the pressure."""
    for state in (JKR[1], DUGDALE[1]):
        if isinstance(state, exact.JKRZone):
            wrong = replace(state, work=state.work * (1.0 + 1e-8))
            assert reference.load_of(wrong) != pytest.approx(state.load, rel=1e-10)
        else:
            assert cohesive_error(state, off=1e-8) > 100.0 * TOL


def test_invalid_arguments_are_refused_by_name():
    zone = exact.Westergaard(0.02, L, E_STAR, 0.5)
    with pytest.raises(SceneError, match="work"):
        exact.JKRZone(zone, -1.0)
    with pytest.raises(SceneError, match="zone"):
        exact.JKRZone(exact.PeriodicPunch(0.5, L, E_STAR, 1.0), 1.0)
    with pytest.raises(SceneError, match="cohesive_end"):
        exact.DugdaleZone(zone, 1.0, 0.4)
    with pytest.raises(SceneError, match="branch"):
        exact.JKRWave(**WAVE, work=1e-4).at_load(0.0, "upper")
    with pytest.raises(SceneError, match="machine_compliance"):
        exact.JKRWave(**WAVE, work=1e-4).pull_off(-1.0)
