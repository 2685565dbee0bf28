"""JKR adhesion: both branches and pull-off, against closed forms and designed contacts."""

from __future__ import annotations

import warnings
from dataclasses import replace
from itertools import cycle, product
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import assume, example, given

import contact
from contact import exact, inverse
from contact.adhesion import arc_length, gradient_flow, pull_off_of_solution
from contact.adhesion import pull_off as common_pull_off
from contact.adhesion.curve import Curve, State
from contact.reference.inverse.adhesive import second_variation
from tests.contact.strategies import adhesive_designs
from tests.tiers import diagonal, quick

E, DELTA, WORK = 1.0, 0.01, 1e-5
WAVE = exact.JKRWave(DELTA, 1.0, E, WORK)
CYLINDER = exact.JKRCylinder(1.0, E, 1e-6, datum=1.0)
INSIDE = np.array([-0.95, -0.5, 0.0, 0.3, 0.9])


def wave(work=WORK, branch="advancing", **control):
    scene = contact.Scene(
        contact.Sinusoid(DELTA, 1.0), E, contact.Periodic(), law=contact.JKR(work), **control
    )
    return contact.solve(scene, branch=branch)


def cylinder(branch="advancing", **control):
    scene = contact.Scene(
        contact.Parabola(1.0), E, contact.Isolated(datum=1.0), law=contact.JKR(1e-6), **control
    )
    return contact.solve(scene, branch=branch)


def designed(problem, branch="advancing"):
    model = contact.Isolated() if problem.period is None else contact.Periodic()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", contact.ModelWarning)
        scene = contact.Scene(
            problem.profile, problem.E_star, model, law=contact.JKR(problem.work), load=problem.load
        )
        try:
            return contact.solve(scene, branch=branch)
        except (
            contact.NotConverged
        ) as failure:  # round-off of heights of high degree may move narrow zones by more than 1e-8
            assert failure.best.error < 1e-6
            return failure.best


def agrees(solution, reference, tol=1e-10):
    a = reference.half_width
    error = max(abs(solution.zones[0, 1] - a), abs(solution.zones[0, 0] + a)) / a
    x = INSIDE * a
    pressure = (
        np.abs(solution.pressure(x) - reference.pressure(x)).max()
        / np.abs(reference.pressure(x)).max()
    )
    assert max(error, pressure) < tol
    assert max(error, pressure) < 2 * solution.error < 1e-8
    assert solution.certificate.holds and solution.certificate.stability > 0.0
    assert "convex" not in solution.certificate.note


@pytest.mark.parametrize("load", [0.01, 1e-3, 0.0, -5e-4, -1.1e-3])
def test_the_wave_is_johnsons_on_its_stable_branch(load):
    reference = WAVE.advancing(load)
    solution = wave(load=load)
    agrees(solution, reference)
    assert solution.approach == pytest.approx(reference.approach, abs=1e-12)
    x = np.array([0.4, 0.45, 0.5])
    assert solution.gap(x) == pytest.approx(reference.gap(x), rel=1e-9)


@pytest.mark.parametrize("approach", [8e-3, 1e-3, 0.0, -1e-3])
def test_under_a_fixed_approach_the_wave_has_another_pull_off(approach):
    reference, solution = WAVE.at_approach(approach), wave(approach=approach)
    agrees(solution, reference)
    assert solution.load == pytest.approx(reference.load, rel=1e-9)
    assert solution.pull_off.approach == pytest.approx(WAVE.pull_off(0.0).approach, rel=1e-10)


@pytest.mark.parametrize("branch", ["advancing", "receding"])
@pytest.mark.parametrize("load", [1e-3, 0.0, -1e-4])
def test_the_cylinder_is_barquins(load, branch):
    solution = cylinder(branch, load=load)
    agrees(solution, CYLINDER.at_load(load))
    assert solution.approach == pytest.approx(CYLINDER.at_load(load).approach, rel=1e-10)
    assert solution.pull_off.load == pytest.approx(CYLINDER.pull_off_load, rel=1e-11)
    assert solution.pull_off.approach == pytest.approx(CYLINDER.pull_off().approach, rel=1e-9)


@pytest.mark.parametrize("short", [1e-2, 1e-4, 1e-6])
def test_a_load_very_near_to_pull_off_is_still_on_the_stable_branch(short):
    load = (1 - short) * CYLINDER.pull_off_load
    solution, reference = cylinder(load=load), CYLINDER.at_load(load)
    # Near pull-off the half width changes with the square root of the distance to the load of
    # pull-off. So round-off of the load causes an error that grows towards pull-off.
    assert solution.zones[0, 1] == pytest.approx(reference.half_width, rel=1e-13 / short)
    assert 0.0 < solution.certificate.stability < 10 * np.sqrt(short)


def test_past_pull_off_there_is_no_contact_and_the_message_says_where_pull_off_is():
    with pytest.raises(
        contact.OutOfRange, match=r"past pull-off.*-0\.0001743671.*approach -0\.000586351"
    ):
        cylinder(load=1.0001 * CYLINDER.pull_off_load)
    with pytest.raises(contact.OutOfRange, match=f"{WAVE.pull_off().load:.6g}"[:9]):
        wave(load=1.001 * WAVE.pull_off().load)
    with pytest.raises(contact.OutOfRange, match="past pull-off"):
        wave(approach=1.001 * WAVE.pull_off(0.0).approach)


def test_the_wave_jumps_into_full_contact_where_johnson_says_and_stays_closed():
    jump = exact.JKRWave(DELTA, 1.0, E, 3e-5).jump_into_full_contact.load
    assert len(wave(3e-5, load=0.999 * jump).zones) == 1
    closed = wave(3e-5, load=1.001 * jump)
    assert len(closed.zones) == 0 and closed.certificate.holds and closed.pull_off is None
    assert len(wave(branch="receding", load=-0.01).zones) == 0


def test_above_the_critical_work_the_wave_closes_by_itself():
    critical = WAVE.self_closing_work
    assert len(wave(0.99 * critical, load=0.0).zones) == 1
    full = wave(1.01 * critical, load=0.0)
    assert len(full.zones) == 0
    x = np.array([0.0, 0.2, 0.5])
    assert full.pressure(x) == pytest.approx(
        np.pi * E * DELTA * np.cos(2 * np.pi * x), rel=1e-10, abs=1e-12
    )
    assert full.certificate.smallest_pressure == pytest.approx(-np.pi * E * DELTA, rel=1e-9)


@pytest.mark.parametrize(
    ("seed", "period"),
    quick(product(range(40), [None, 1.0]), always=[*zip(range(8), cycle([None, 1.0]))]),
)
def test_a_designed_contact_is_found_or_lies_between_the_advancing_and_the_receding_branch(
    seed, period
):
    count = seed % 6 + 1
    problem = inverse.random_adhesive_problem(
        np.random.default_rng(seed), count, period, pull=10.0 ** (0.5 - seed % 4)
    )
    solution = designed(problem)
    assert solution.certificate.holds and solution.certificate.stability > 0
    width = problem.zone_widths.sum()
    if len(solution.zones) == count and abs(solution.zone_widths.sum() / width - 1) < 1e-3:
        error = np.abs(np.sort(solution.zone_widths) / np.sort(problem.zone_widths) - 1).max()
        assert error < 1e-9 + 3 * solution.error
        assert np.sort(solution.zone_loads) == pytest.approx(
            np.sort(problem.zone_loads), abs=1e-7 * np.abs(problem.zone_loads).max()
        )
    else:  # some zone of the design appears only after a larger load
        assert solution.zone_widths.sum() < width
        assert period is not None or designed(problem, "receding").zone_widths.sum() > width


@example(inverse.random_adhesive_problem(np.random.default_rng(13), 2, None, pull=10.0**-0.5))
@given(adhesive_designs(periodic=False))
def test_an_isolated_designed_contact_is_found_up_to_the_round_off_of_its_heights(problem):
    solution = designed(problem)
    assume(
        len(solution.zones) == len(problem.zones)
        and abs(solution.zone_widths.sum() / problem.zone_widths.sum() - 1) < 1e-3
    )
    error = float((np.abs(solution.zones - problem.zones).max(axis=1) / problem.zone_widths).max())
    # A condition number of the zone ends. `bending` is the largest end intensity that one
    # coefficient of the pressure causes, divided by the prescribed intensity. `stability` is the
    # least eigenvalue of the second variation of the energy.
    condition = solution.fields.bending / solution.certificate.stability
    assert error < 1e-10 + 20 * np.finfo(float).eps * condition
    assert error < 1e-9 or condition > 1e5
    assert error < 2 * solution.error


@pytest.mark.parametrize(("seed", "period"), [(0, None), (5, None), (1, 1.0), (7, 1.0)])
def test_the_solution_has_the_second_variation_of_the_energy_of_the_design(seed, period):
    problem = inverse.random_adhesive_problem(np.random.default_rng(seed), None, period)
    solution = designed(problem)
    root = np.sqrt(np.repeat(problem.zone_widths, 2))
    expected = np.linalg.eigvalsh(
        root[:, None] * second_variation(problem) * root / (2 * problem.work)
    )
    matrix = solution.fields.second_variation()
    assert np.linalg.eigvalsh(matrix) == pytest.approx(expected, abs=1e-9 * expected.max())
    # If one end advances, the energy that another end gains by advancing never falls. The gradient
    # flow (contact.adhesion.gradient_flow) relies on this.
    assert np.all(matrix - np.diag(np.diag(matrix)) <= 0.0)


def test_an_unstable_equilibrium_is_not_certified():
    narrow = exact.JKRWave(DELTA, 1.0, E, WORK).at_load(-5e-4, "narrow")
    given = wave(half_width=narrow.half_width)
    assert given.load == pytest.approx(-5e-4, rel=1e-9)
    eigenvalues = np.linalg.eigvalsh(given.fields.second_variation())
    assert (
        eigenvalues.min() < 0 < np.linalg.eigvalsh(wave(load=-5e-4).fields.second_variation()).min()
    )


def test_as_the_work_of_adhesion_vanishes_the_contact_becomes_the_frictionless_one():
    profile = contact.Fourier(1.0, [0.01, 0.004, 0.002], [0.0, 0.003, -0.002])
    scene = contact.Scene(profile, E, contact.Periodic(), mean_pressure=5e-3)
    bare = contact.solve(scene)
    off = [
        np.abs(contact.solve(replace(scene, law=contact.JKR(w))).zones - bare.zones).max()
        for w in (1e-12, 1e-16)
    ]
    # The zones change in proportion to the edge intensity, that is, to the square root of the work
    # of adhesion.
    assert off[0] < 1e-3 and off[0] / off[1] == pytest.approx(100.0, rel=0.05)


@pytest.mark.parametrize("load", [2e-3, 0.0, -8e-4])
def test_the_work_of_the_load_is_elastic_and_surface_energy(load):
    states = [wave(load=load + step) for step in (-1e-6, 1e-6)]
    t, weights = np.polynomial.legendre.leggauss(60)
    angle = 0.5 * np.pi * (1 + t)

    def energy(solution):
        a = solution.zones[0, 1]
        x = a * np.cos(angle)
        inner = (
            0.5
            * np.pi
            * a
            * float(
                np.sum(weights * np.sin(angle) * solution.pressure(x) * solution.displacement(x))
            )
        )
        return 0.5 * inner - 2 * a * WORK

    low, high = states
    done = 0.5 * (high.load + low.load) * (high.approach - low.approach)
    assert energy(high) - energy(low) == pytest.approx(done, rel=1e-5, abs=1e-15)
    assert (high.load - low.load) / (high.approach - low.approach) == pytest.approx(
        wave(load=load).stiffness, rel=1e-5
    )


def test_a_rough_profile_is_solved_on_its_branch_and_pulled_off():
    scene = contact.Scene(
        rough(), 1e9, contact.Periodic(), law=contact.JKR(1e-4), mean_pressure=2e6
    )
    solution = contact.solve(scene)
    assert (
        solution.certificate.holds
        and solution.certificate.stability > 0
        and len(solution.zones) > 3
    )
    last = solution.pull_off
    assert last.load < 0
    inside = contact.solve(replace(scene, mean_pressure=0.0)).pull_off
    # A larger load has brought more of the surface into contact, so pull-off needs at least as much
    # tension.
    assert last.load <= inside.load * (1 - 1e-9) < 0


def test_scenes_that_jkr_does_not_allow_are_refused_by_name():
    for work in (0.0, -1.0, float("nan"), "1"):
        with pytest.raises(contact.SceneError, match="work"):
            contact.JKR(work)
    with pytest.raises(
        contact.SceneError, match="jkr is not solved with the localized interaction"
    ):
        contact.Scene(
            contact.Sinusoid(DELTA, 1.0), E, contact.Localized(), law=contact.JKR(1e-5), load=0.01
        )
    with pytest.raises(contact.SceneError, match="jkr accepts only"):
        contact.Scene(
            contact.Sinusoid(DELTA, 1.0),
            E,
            contact.Periodic(),
            law=contact.JKR(1e-5),
            contact_fraction=0.5,
        )
    with pytest.raises(contact.SceneError, match="load"):
        contact.Scene(contact.Parabola(1.0), E, contact.Isolated(), load=-1.0)
    falls = contact.Polynomial([0.0, 0.01, 0.3, 0.1, 0.0, 1.0])
    with pytest.raises(contact.OutOfRange, match="falls without bound"):
        contact.solve(
            contact.Scene(falls, E, contact.Isolated(datum=5.0), law=contact.JKR(1e-5), load=0.0)
        )
    with pytest.raises(contact.SceneError, match="branch"):
        wave(load=0.01, branch="upper")
    with pytest.raises(contact.SceneError, match="no pull-off under the law frictionless"):
        scene = contact.Scene(contact.Parabola(1.0), E, contact.Isolated(), load=1.0)
        _ = contact.solve(scene).pull_off


def test_a_scene_file_names_the_law_jkr(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(
        '[profile]\nshape = "sinusoid"\namplitude = 0.01\nperiod = 1.0\n[material]\nE_star = 1.0\n[interaction]\nmodel = "periodic"\n'
        '[law]\nmodel = "jkr"\nwork = 1e-5\n[control]\nmean_pressure = -5e-4\n'
    )
    scene = contact.load_scene(path)
    assert scene.law == contact.JKR(1e-5)
    assert contact.solve(scene).load == pytest.approx(-5e-4, rel=1e-12)


@pytest.mark.parametrize(
    ("slopes", "after", "passed"),
    [((-1.0, 1.0), 0.1, True), ((0.0, 0.0), 0.1, False), ((-0.2, -0.2), -0.1, True)],
)
def test_a_step_past_an_equilibrium_is_noticed_by_the_sign_after_it_or_by_the_cubic_interpolant(
    slopes, after, passed
):
    table, step = np.array([[-1.0, 1.0]]), np.full(2, 0.5)
    here, ahead = (
        State(table, 0.0, np.full(2, residual), slope * np.eye(2), np.ones(2), 0.0, 0.0)
        for residual, slope in zip((0.1, after), slopes, strict=True)
    )
    assert gradient_flow.overshoots(here, ahead, step, 1.0).all() == passed


class Stiff:
    """Stands in for `Curve`: two zones, and only the left end of the second one moves far.

    This end is driven inward. It is unstable at first, and stable after it has passed a minimum of
    its residual; it comes to rest after 0.09 of its zone's width. The left end of the first zone is
    at rest 5e-5 farther outward, the right ends where they start.
    """

    problem = SimpleNamespace(detail=np.inf, borders=(-np.inf, np.inf), period=None)
    start = np.array([[-2.0, -1.0], [1.0, 2.0]])
    unit, gaps, room = Curve.unit, Curve.gaps, Curve.room

    def at(self, table, value, tolerance=0.0):
        moved = np.concatenate((self.start[:, 0] - table[:, 0], table[:, 1] - self.start[:, 1]))
        residual, rates = 5e-5 * np.array([1.0, 0.0, 0.0, 0.0]) - moved, -np.eye(4)
        d = -moved[1]
        residual[1], rates[1, 1] = 8 * d**2 - 0.5 * d - 0.02, 0.5 - 16 * d
        return State(table, value, residual, rates, np.ones(4), 0.0, 0.0)


def test_ends_at_rest_do_not_stop_an_end_that_is_far_from_rest():
    curve = Stiff()
    rest = gradient_flow.receded(curve, curve.start, 0.0)
    allowed = gradient_flow.ACCURACY.resting_step  # relative to the zone's width, which is 1
    moved = rest.table[1, 0] - 1.0
    assert moved == pytest.approx((0.5 + np.sqrt(0.25 + 0.64)) / 16, abs=allowed)
    assert np.abs(rest.residual).max() < 1e-4 and rest.growth < 0.0


class Relieved(Stiff):
    """Stands in for `Curve`: the left zone is lost, and then the right zone separates by itself.

    Without the left zone the ends of the right zone are driven inward less, but harder and harder
    as the zone narrows. `narrowest` is the smallest width of the right zone at which a state was
    computed.
    """

    def __init__(self):
        self.narrowest = 1.0

    def at(self, table, value, tolerance=0.0):
        width = np.diff(table, axis=1)[:, 0]
        self.narrowest = min(self.narrowest, width[-1])
        driven = (
            np.array([-50.0 / width[0], -50.0])
            if len(table) > 1
            else np.maximum(-2.0 * width**-0.5, -60.0)
        )
        count = 2 * len(table)
        return State(table, value, np.tile(driven, 2), np.eye(count), np.ones(count), 0.0, 0.0)


def test_after_the_loss_of_one_zone_another_one_counts_as_lost_before_its_width_vanishes():
    curve = Relieved()
    assert gradient_flow.receded(curve, np.array([[-2.0, -1.9], [1.0, 2.0]]), 0.0) is None
    assert curve.narrowest > 1e-6


def test_just_past_its_turning_point_a_last_zone_that_slides_is_lost():
    rng = np.random.default_rng(59)
    k, phase = np.arange(1, 25), 2 * np.pi * rng.random(24)
    size = 0.02 * k**-1.2 / np.sqrt(0.5 * np.sum((2 * np.pi * k**-0.2) ** 2))
    profile = contact.Fourier(1.0, size * np.cos(phase), size * np.sin(phase))
    scene = contact.Scene(profile, E, contact.Periodic(), law=contact.JKR(1e-7), mean_pressure=1e-3)
    solution = contact.solve(scene)
    assert len(solution.zones) == 3
    curve = Curve(solution.fields.problem, solution.find_pull_off.control)
    # The interval is a little narrower than the last zone at pull-off; the control has its value at
    # pull-off.
    assert (
        gradient_flow.receded(curve, np.array([[0.157164, 0.168935]]), -0.0016022921712400835)
        is None
    )


def test_past_a_turning_point_the_displaced_ends_leave_a_narrow_gap_open():
    table = np.array([[-1.0, -1e-3], [1e-3, 1.0]])
    turned = State(
        table, 0.0, np.zeros(4), 0.25 * np.ones((4, 4)) - np.eye(4), np.ones(4), 0.0, 0.0
    )
    wider, narrower = (
        arc_length.past_turning_point(Stiff(), turned, 1.0),
        arc_length.past_turning_point(Stiff(), turned, -1.0),
    )
    assert np.all(np.diff(wider.ravel()) > 0.0)
    assert np.all(wider[:, 0] < table[:, 0]) and np.all(wider[:, 1] > table[:, 1])
    assert np.all(narrower[:, 0] > table[:, 0]) and np.all(narrower[:, 1] < table[:, 1])


def rough():
    rng = np.random.default_rng(1)
    k, phase = np.arange(1, 31), rng.uniform(0, 2 * np.pi, 30)
    size = 1e-7 * k**-1.3
    return contact.Fourier(1e-4, size * np.cos(phase), size * np.sin(phase))


@pytest.mark.slow
@pytest.mark.parametrize(
    "law", [contact.JKR(1e-4), contact.Dugdale(1e-4, 2e6)], ids=["jkr", "dugdale"]
)
def test_pull_off_under_a_fixed_approach_is_where_the_path_ends(monkeypatch, law):
    frictionless = contact.solve(contact.Scene(rough(), 1e9, contact.Periodic(), mean_pressure=2e6))
    scene = contact.Scene(rough(), 1e9, contact.Periodic(), law=law, approach=frictionless.approach)
    solution = contact.solve(scene)
    # Although the approach is the control, the search for pull-off first lowers the load.
    lowered = []
    real = common_pull_off.lowered_by_load
    for room in (common_pull_off, pull_off_of_solution):
        monkeypatch.setattr(
            room, "lowered_by_load", lambda *given: lowered.append(real(*given)) or lowered[-1]
        )
    found = solution.pull_off
    assert (
        len(lowered) == 1
        and 0 < len(lowered[0].contact) < len(solution.zones)
        and lowered[0].growth < 0.0
    )
    path = contact.path(
        scene,
        [scene.approach, found.approach - 0.1 * (scene.approach - found.approach)],
        control="approach",
    )
    assert path.events[-1].kind == "pull-off"
    assert found.approach == pytest.approx(path.events[-1].value, rel=1e-9)


@pytest.mark.parametrize(
    ("part", "substrate"),
    diagonal([-0.5, 0.5, 0.9, 1.0, 1.1, 2.0], [contact.HalfPlane(), contact.Layer(3e-5, 0.2)]),
)
def test_growth_and_motions_are_eigenvalues_and_eigenvectors_of_the_rates(part, substrate):
    # The products K dK/ds are second derivatives of the energy up to a factor, so their matrix is
    # symmetric. `State.motions` uses this if all intensities K have one sign, as under smaller
    # loads.
    scene = contact.Scene(
        rough(),
        1e9,
        contact.Periodic(),
        substrate=substrate,
        law=contact.JKR(1e-4),
        mean_pressure=2e6,
    )
    solution = contact.solve(scene)
    curve, zones = (
        Curve(solution.fields.problem, solution.find_pull_off.control),
        solution.fields.density.zones.table,
    )
    here = curve.at(zones, part * curve.control.value)
    assert len(zones) > 2 and (here.gains.min() > 0.0) == (part <= 1.0)
    growth, motions = here.motions(np.arange(2 * len(zones)))
    wanted = np.linalg.eigvals(here.rates / here.weight[:, None]).real
    assert np.sort(growth) == pytest.approx(np.sort(wanted), rel=1e-9, abs=1e-9)
    assert here.growth == pytest.approx(wanted.max(), rel=1e-9)
    if part <= 1.0:
        driven = here.rates @ motions
        assert (
            np.abs(driven - here.weight[:, None] * motions * growth).max()
            < 1e-9 * np.abs(driven).max()
        )


@pytest.mark.parametrize(
    ("work", "given"),
    diagonal([1e-3, 1e-7, 1e-9, 2e-12], [(0.447, "load"), (0.447, "approach"), (0.2, "load")]),
)
def test_the_load_of_pull_off_follows_from_its_zone_however_wide_the_contact_was(work, given):
    """At pull-off the load is Westergaard's load minus sqrt(2 E* w L tan(pi a/L)).

    Westergaard's load belongs to the half width a of the zone at pull-off; the second term is the
    load of the edge intensities. work: w L/(E* A^2) with the work of adhesion w, the period L and
    the amplitude A.
    """
    half_width, control = given
    wave, law = contact.Sinusoid(1.0, 1.0), contact.JKR(work)
    at_first = contact.solve(
        contact.Scene(wave, 1.0, contact.Periodic(), law=law, half_width=half_width)
    )
    scene = contact.Scene(
        wave, 1.0, contact.Periodic(), law=law, **{control: getattr(at_first, control)}
    )
    last = contact.solve(scene).pull_off
    s = np.pi * last.zones[0, 1]
    assert last.load == pytest.approx(
        np.pi * np.sin(s) ** 2 - np.sqrt(2 * work * np.tan(s)), rel=1e-12
    )
