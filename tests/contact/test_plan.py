"""A solve does only the work that its scene needs: plans, counts, modules and memory show it."""

from __future__ import annotations

import tracemalloc
from dataclasses import dataclass, replace

import numpy as np
import pytest

import contact
from contact.formulation.fields import ZoneFields
from contact.formulation.full_contact import ApartFields, FullFields
from contact.formulation.gaps import GapFields
from contact.model.laws.base import Routes
from contact.reference.inverse import design
from contact.search import refine
from contact.search.find import found
from contact.search.strategies import gaps
from contact.search.topology.failure import Failure
from contact.solution.decision import Decision
from tests.interpreter import loaded_after_each

L, DELTA, E = 1.0, 1e-3, 1.0
PERIODIC, ISOLATED = contact.Periodic(), contact.Isolated()
WAVE = contact.Sinusoid(DELTA, L)


def full_pressure(waves=1, amplitude=DELTA):
    return np.pi * E * amplitude * waves / L


def solve(profile, interaction=PERIODIC, tol=1e-10, **control):
    return contact.solve(contact.Scene(profile, E, interaction, **control), tol=tol)


def parts(solution):
    return {part.name: part for part in solution.plan.parts}


def waves(count, shift=0.0):
    """A profile of `count` equal waves per period, moved to the right by `shift` periods.

    With a shift the profile is not symmetric about x = 0, although each zone is still
    symmetric.
    """
    amplitude, angle = DELTA / count, 2 * np.pi * count * shift
    zeros = [0.0] * (count - 1)
    return contact.Fourier(
        L,
        [*zeros, -amplitude * np.cos(angle)],
        [*zeros, -amplitude * np.sin(angle)] if shift else [],
    )


class Counted(contact.Profile):
    """A wave or a wedge that counts the points at which slope and height are evaluated."""

    def __init__(self, kinked=False):
        self.inner = contact.Wedge(0.01, L) if kinked else WAVE
        self.slopes = self.heights = 0

    period = L
    symmetric = property(lambda self: self.inner.symmetric)
    summits = property(lambda self: self.inner.summits)
    resolution = property(lambda self: self.inner.resolution)
    kinks = property(lambda self: self.inner.kinks)

    def height(self, x):
        self.heights += np.size(x)
        return self.inner.height(x)

    def slope(self, x):
        self.slopes += np.size(x)
        return self.inner.slope(x)


SCENE = "import contact as c\ns = c.solve(c.Scene({}, 1.0, {}, {}))"
SCENES = [
    ("c.Sinusoid(1e-3, 1.0)", "c.Periodic()", "mean_pressure=1e-3"),
    ("c.Parabola(1.0)", "c.Isolated()", "load=1e-3"),
    ("c.Wedge(0.1, 1.0)", "c.Periodic()", "half_width=0.2"),
    ("c.Fourier(1.0, [-1e-3, 2e-4], [1e-4])", "c.Periodic()", "mean_pressure=1e-3"),
    ("c.Sinusoid(1e-3, 1.0)", "c.Localized('self-consistent', neighbours=2)", "half_width=0.2"),
]
SAMPLED = "c.Sampled([0.0, 0.2, 0.4, 0.6, 0.8], [0.0, 2e-3, 1e-3, 0.0, -1e-3], period=1.0)"
# Code that one fresh interpreter runs, step by step in this order.
STEPS = {
    "series": "import contact, gc; series = contact.Fourier(1.0, [-1e-3, 2e-4]); assert gc.isenabled()\n"
    "frozen = gc.get_freeze_count()\n"
    "contact.solve(contact.Scene(series, 1.0, contact.Periodic(), mean_pressure=1e-4))\n"
    "assert gc.isenabled() and gc.get_freeze_count() == frozen",
    "scenes": "\n".join(SCENE.format(*scene) for scene in SCENES),
    "sampled": SCENE.format(SAMPLED, "c.Periodic()", "mean_pressure=1e-3"),
    "commands": "import contact.commands.cli",
}


def loaded_after(step, names):
    """The modules among `names` that a fresh interpreter has loaded after a step."""
    return dict(zip(STEPS, loaded_after_each(*STEPS.values()), strict=True))[step] & set(names)


def peak(call):
    call()  # The first call fills caches, which do not count here.
    tracemalloc.start()
    try:
        call()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


class TestSymmetricAgainstAsymmetric:
    COUNT = 9
    PRESSURE = 0.1 * full_pressure()

    def test_a_symmetric_scene_solves_half_the_unknowns(self):
        half = solve(waves(self.COUNT), mean_pressure=self.PRESSURE).plan
        whole = solve(waves(self.COUNT, shift=0.013), mean_pressure=self.PRESSURE).plan
        assert half["symmetry"].used and not whole["symmetry"].used
        assert half.counts["zones"] == whole.counts["zones"] == self.COUNT
        # The middle zone is symmetric, so its unknowns are halved, too, except for the constant
        # mode.
        assert half.counts["coupled_unknowns"] <= 0.5 * whole.counts["coupled_unknowns"] + 1

    def test_a_quarter_of_the_kernel_is_evaluated_in_a_symmetric_solve(self):
        half = solve(waves(self.COUNT), mean_pressure=self.PRESSURE).plan.counts
        whole = solve(waves(self.COUNT, shift=0.013), mean_pressure=self.PRESSURE).plan.counts
        assert (
            half["kernel_evaluations"] / half["solves"]
            < 0.3 * whole["kernel_evaluations"] / whole["solves"]
        )

    def test_both_have_the_same_answer(self):
        half = solve(waves(self.COUNT), mean_pressure=self.PRESSURE)
        whole = solve(waves(self.COUNT, shift=0.013), mean_pressure=self.PRESSURE)
        assert np.ptp(half.zone_widths) < 1e-12 * half.zone_widths[0]
        assert np.abs(half.zone_widths - whole.zone_widths).max() < 1e-9 * half.zone_widths[0]


class TestOneZoneAgainstMany:
    def test_one_isolated_zone_couples_to_nothing(self):
        solution = solve(contact.Parabola(1.0), ISOLATED, load=1e-3)
        assert solution.plan.counts["coupled_unknowns"] == 1
        assert not solution.plan["periodic kernel"].used

    def test_one_symmetric_asperity_is_not_searched_for_on_a_grid(self):
        assert not solve(WAVE, mean_pressure=0.2 * full_pressure()).plan["coarse search"].used
        assert (
            parts(solve(WAVE, mean_pressure=0.2 * full_pressure()))["coarse search"].seconds is None
        )

    def test_many_zones_are_searched_for_on_a_grid(self):
        plan = solve(waves(5), mean_pressure=0.1 * full_pressure()).plan
        assert plan["coarse search"].used and plan["coarse search"].seconds > 0

    def test_few_zones_use_no_fast_sums(self):
        assert not solve(waves(5), mean_pressure=0.1 * full_pressure()).plan["fast sums"].used

    def test_three_hundred_zones_use_fast_sums(self):
        plan = solve(waves(303), mean_pressure=0.1 * full_pressure(), tol=1e-8).plan
        assert plan["fast sums"].used and "iterations" in plan["fast sums"].detail

    def test_the_smooth_wave_needs_few_modes_whatever_else_the_solver_can_do(self):
        counts = solve(WAVE, tol=1e-12, mean_pressure=0.2 * full_pressure()).plan.counts
        assert (
            counts["own_modes"] <= 32 and counts["coupled_unknowns"] <= 32 and counts["zones"] == 1
        )


class TestGivenAgainstSearched:
    def test_a_given_zone_takes_two_solves_and_no_search(self):
        given = solve(WAVE, half_width=0.2)
        assert not given.plan["coarse search"].used and not given.plan["zone ends"].used
        assert given.plan.counts["solves"] <= 2

    def test_a_given_zone_samples_less_of_the_profile_than_a_searched_one(self):
        given, searched = Counted(), Counted()
        reference = solve(given, half_width=0.2)
        solve(searched, load=reference.load)
        assert given.slopes < searched.slopes

    def test_the_work_of_a_searched_zone_does_not_grow_with_the_digits_of_its_load(self):
        counts = [Counted(), Counted()]
        for profile, part in zip(counts, (0.2, 0.2345678901234567), strict=True):
            solve(profile, load=part * full_pressure())
        assert counts[1].slopes <= 1.5 * counts[0].slopes

    def test_a_near_solution_saves_the_grid(self):
        profile = design([[-0.4, -0.2], [0.0, 0.3]], E, 1e-3, 1.0).profile
        scene = contact.Scene(profile, E, PERIODIC, load=1e-3)
        first = contact.solve(scene)
        again = contact.solve(contact.Scene(profile, E, PERIODIC, load=1.01e-3), near=first)
        assert parts(first)["coarse search"].seconds is not None
        assert parts(again)["coarse search"].seconds is None


class TestSmoothAgainstKinked:
    def test_a_smooth_profile_does_not_use_the_part_for_kinks(self):
        smooth, kinked = solve(WAVE, half_width=0.2), solve(contact.Wedge(0.01, L), half_width=0.2)
        assert not smooth.plan["kinks"].used and kinked.plan["kinks"].used

    def test_a_declared_kink_costs_no_more_modes_than_a_smooth_profile(self):
        smooth, kinked = (
            solve(WAVE, half_width=0.2).plan.counts,
            solve(contact.Wedge(0.01, L), half_width=0.2).plan.counts,
        )
        assert kinked["own_modes"] <= 2 * smooth["own_modes"]

    def test_the_same_corner_undeclared_costs_many_times_as_much(self):
        @dataclass(frozen=True)
        class Blunted(contact.Profile):
            """A wedge with a rounded tip and no declared kink.

            The tip is rounded over 0.02 of the half width of contact.
            """

            symmetric = property(lambda self: True)
            summits = property(lambda self: np.zeros(1))

            def height(self, x):
                return 0.01 * np.sqrt(np.asarray(x) ** 2 + 0.02**2)

            def slope(self, x):
                x = np.asarray(x)
                return 0.01 * x / np.sqrt(x**2 + 0.02**2)

        declared = solve(contact.Wedge(0.01), ISOLATED, half_width=1.0).plan.counts["own_modes"]
        assert solve(Blunted(), ISOLATED, half_width=1.0).plan.counts["own_modes"] > 10 * declared

    def test_a_numerical_slope_is_only_made_for_a_profile_without_its_own(self):
        class Bare(Counted):
            slope = contact.Profile.slope

        assert solve(Bare(), half_width=0.2).plan["numerical slope"].used
        assert not solve(Counted(), half_width=0.2).plan["numerical slope"].used


class TestLocalizationAgainstNone:
    def test_only_a_localized_model_carries_the_nominal_pressure(self):
        assert not solve(WAVE, half_width=0.2).plan["localization term"].used
        assert (
            solve(WAVE, contact.Localized("self-consistent"), half_width=0.2)
            .plan["localization term"]
            .used
        )

    def test_only_the_first_order_closure_solves_the_isolated_reference(self):
        for closure in ("first-order", "self-consistent"):
            part = parts(solve(WAVE, contact.Localized(closure), half_width=0.2))[
                "isolated reference"
            ]
            assert part.used == (closure == "first-order")


class TestFieldsNotAskedFor:
    def test_pressures_evaluate_no_heights_and_gaps_do(self):
        profile = Counted()
        solution = solve(profile, half_width=0.2)
        before = profile.heights
        solution.pressure(np.linspace(-0.5, 0.5, 999))
        assert profile.heights == before
        solution.gap(np.linspace(-0.5, 0.5, 999))
        assert profile.heights > before

    def test_fields_that_are_not_evaluated_take_no_time_in_the_plan(self):
        part = parts(solve(WAVE, half_width=0.2))["fields"]
        assert not part.used and part.seconds is None


class TestModulesAndMemory:
    OPTIONAL = (
        "numba",
        "matplotlib",
        "xarray",
        "rich",
        "click",
        "scipy.interpolate",
        "scipy.optimize",
        "scipy.integrate",
    )

    def test_scenes_that_need_none_of_them_load_no_optional_module(self):
        assert loaded_after("scenes", self.OPTIONAL) == set()

    def test_a_measured_profile_loads_splines_and_nothing_else(self):
        # The import of scipy.interpolate itself loads other parts of SciPy.
        assert loaded_after("sampled", self.OPTIONAL) <= {
            "scipy.interpolate",
            "scipy.optimize",
            "scipy.integrate",
        }

    def test_the_suite_of_measurements_is_loaded_by_no_solve_and_no_other_command(self):
        measurements = (
            "contact.studies.bench",
            "contact.reference.exact",
            "contact.reference.inverse",
            "contact.slip.partial_slip",
            "contact.slip.rolling",
        )
        assert loaded_after("commands", measurements) == set()

    def test_a_given_zone_takes_less_memory_than_a_searched_one_and_both_take_little(self):
        given = peak(lambda: solve(WAVE, half_width=0.2))
        searched = peak(lambda: solve(waves(9), mean_pressure=0.1 * full_pressure()))
        assert given < 300_000 and searched < 3_000_000
        assert given < searched

    def test_memory_of_many_zones_grows_with_their_number_and_not_with_its_square(self):
        few, many = (
            peak(lambda n=n: solve(waves(n), mean_pressure=0.1 * full_pressure(), tol=1e-8))
            for n in (101, 303)
        )
        assert many < 1.5 * 3 * few

    def test_a_symmetric_scene_takes_hardly_more_than_half_the_memory_of_a_shifted_one(self):
        half = peak(lambda: solve(waves(27), mean_pressure=0.1 * full_pressure(), tol=1e-8))
        whole = peak(
            lambda: solve(waves(27, shift=0.0013), mean_pressure=0.1 * full_pressure(), tol=1e-8)
        )
        assert half < 0.6 * whole


class TestNearlyFullAgainstPartContact:
    def test_nearly_full_contact_is_solved_by_its_gaps_with_few_unknowns(self):
        almost = solve(WAVE, tol=1e-8, mean_pressure=(1 - 1e-6) * full_pressure())
        assert almost.contact_fraction > 0.999 and almost.certificate.note == "solved by its gaps"
        assert almost.plan.counts["own_modes"] <= 32

    def test_half_a_contact_is_not_solved_by_its_gaps(self):
        assert (
            solve(WAVE, mean_pressure=0.5 * full_pressure()).certificate.note
            != "solved by its gaps"
        )


class TestLooseAgainstTight:
    def test_a_looser_tolerance_needs_fewer_modes_and_kernel_evaluations(self):
        profile = design([[-0.4, -0.2], [0.0, 0.3]], E, 1e-3, 1.0).profile
        loose, tight = (solve(profile, tol=tol, load=1e-3).plan.counts for tol in (1e-2, 1e-11))
        assert (
            loose["own_modes"] < tight["own_modes"]
            and loose["kernel_evaluations"] < 0.7 * tight["kernel_evaluations"]
        )


class TestSizesAndTimes:
    SCENES = [
        (WAVE, PERIODIC, {"mean_pressure": 0.2 * full_pressure()}),
        (WAVE, PERIODIC, {"mean_pressure": (1 - 1e-6) * full_pressure()}),
        (WAVE, contact.Localized("first-order"), {"half_width": 0.2}),
        (contact.Wedge(0.01), ISOLATED, {"load": 1e-3}),
        (waves(5), PERIODIC, {"mean_pressure": 0.1 * full_pressure()}),
        (waves(101), PERIODIC, {"mean_pressure": 0.1 * full_pressure()}),
    ]

    @pytest.mark.parametrize(("profile", "model", "control"), SCENES)
    def test_every_route_counts_its_sizes_and_shares_out_its_time(self, profile, model, control):
        plan = solve(profile, model, tol=1e-7, **control).plan
        sizes = {
            "zones",
            "own_modes",
            "coupled_unknowns",
            "kernel_evaluations",
            "profile_evaluations",
            "solves",
        }
        assert sizes <= set(plan.counts) and min(plan.counts[name] for name in sizes) >= 0
        assert plan.counts["zones"] >= 1 and plan.counts["own_modes"] >= plan.counts["zones"]
        shares = [plan.share(part) for part in plan.parts if part.seconds is not None]
        assert min(shares) >= 0 and sum(shares) <= 1
        assert all(part.used for part in plan.parts if part.seconds)

    def test_a_part_within_another_is_counted_once(self, monkeypatch):
        plan = contact.plan(contact.Scene(WAVE, E, PERIODIC, half_width=0.2))
        clock = iter([0.0, 1.0, 11.0, 13.0])
        monkeypatch.setattr("time.perf_counter", lambda: next(clock))
        with plan.timed("zone ends"), plan.timed("certificate"):
            pass
        assert (plan["zone ends"].seconds, plan["certificate"].seconds) == (3.0, 10.0)

    def test_a_plan_that_has_not_run_has_no_times(self):
        plan = contact.plan(contact.Scene(WAVE, E, PERIODIC, half_width=0.2))
        assert plan.seconds is None and {plan.share(part) for part in plan.parts} == {None}


def test_the_plan_made_beforehand_names_the_same_parts_as_the_one_of_the_solution():
    scene = contact.Scene(WAVE, E, PERIODIC, mean_pressure=0.2 * full_pressure())
    beforehand = contact.plan(scene)
    assert [(p.name, p.used) for p in beforehand.parts] == [
        (p.name, p.used) for p in contact.solve(scene).plan.parts
    ]


def test_the_counted_profile_evaluations_omit_only_those_of_guess_and_certificate():
    profile = Counted()
    solution = solve(profile, half_width=0.2)
    counted = solution.plan.counts["profile_evaluations"]
    assert counted <= profile.slopes <= counted + 2000


def test_modules_that_a_scene_does_not_need_are_not_loaded():
    others = [
        "contact.model.traces.prepare",
        "contact.localized.strips",
        "contact.adhesion.edge_branch",
        "contact.adhesion.cohesive_branch",
    ]
    late = [*others, "contact.adhesion.pull_off_of_solution", "tomllib", "fractions"]
    assert loaded_after("series", [*late, "sie"]) == {"sie"}


class TestDecisions:
    """The plan records each decision, its reason, and the number and threshold that decided it."""

    ROUGH = contact.Fourier(L, [-DELTA, 3e-4, 1e-4], [2e-4, -1e-4, 3e-4])

    @pytest.mark.parametrize(
        ("profile", "control", "question", "way", "because"),
        [
            (WAVE, {"half_width": 0.2}, "solver", "closed form", "no coupled system"),
            (WAVE, {"half_width": 0.2}, "first guess", "the given zone", "half width is given"),
            (ROUGH, {"mean_pressure": 2e-4}, "solver", "coupled system", "closed form needs"),
            (ROUGH, {"mean_pressure": 2e-4}, "first guess", "a grid", "number of zones is unknown"),
            (ROUGH, {"mean_pressure": 2e-4}, "unknowns", "zones", "of the period, below 0.7"),
            (ROUGH, {"mean_pressure": 4e-3}, "unknowns", "gaps", "of the period, above 0.7"),
            (ROUGH, {"mean_pressure": 0.1}, "full contact", "full contact", "Pa, above"),
            (ROUGH, {"contact_fraction": 0.3}, "first guess", "a grid", "a contact fraction"),
            (WAVE, {"contact_fraction": 1.0}, "full contact", "full contact", "fraction is 1"),
        ],
    )
    def test_a_plan_states_each_decision_and_its_reason(
        self, profile, control, question, way, because
    ):
        plan = solve(profile, tol=1e-7, **control).plan
        decision = plan.decisions[question]
        assert decision.way == way and because in decision.reason
        assert f"{way}, since {decision.reason}" in str(plan)
        assert plan.to_dict()["decisions"][question]["text"] == str(decision)

    def test_the_measured_number_is_on_the_side_of_its_threshold_that_was_chosen(self):
        for pressure in (1e-3, 2e-3, 4e-3, 6e-3):
            solution = solve(self.ROUGH, tol=1e-7, mean_pressure=pressure)
            choice = solution.plan.decisions["unknowns"]
            assert (choice.way == "gaps") == (choice.measured > choice.threshold)
            assert choice.measured == pytest.approx(solution.contact_fraction, abs=0.05)

    def test_a_lower_limit_for_kinks_of_valleys_is_explained(self):
        profile = contact.Biquadratic(radius=1.0, spacing=0.4 * L, period=L)
        choice = solve(profile, tol=1e-6, contact_fraction=0.5).plan.decisions["unknowns"]
        assert choice.way == "gaps" and choice.measured < 0.7
        assert choice.because.startswith("no load closes the gaps over kinks of valleys")

    def test_zones_that_replace_gaps_are_named(self, monkeypatch):
        monkeypatch.setattr(gaps, "refine_topology", lambda *_, **__: Failure("not today"))
        solution = solve(self.ROUGH, tol=1e-7, mean_pressure=4e-3)
        choice = solution.plan.decisions["unknowns"]
        assert isinstance(solution.fields, ZoneFields)
        assert choice.way == "zones" and choice.measured > choice.threshold == 0.7
        assert "the search for gaps failed (not today)" in choice.reason
        assert any("gaps" in one and "not today" in one for one in solution.plan.tried)

    def test_a_near_solution_is_named_as_the_first_guess(self):
        first = solve(self.ROUGH, tol=1e-7, mean_pressure=5e-4)
        again = contact.solve(
            contact.Scene(self.ROUGH, E, PERIODIC, mean_pressure=5.1e-4), near=first
        )
        assert again.plan.decisions["first guess"].way == "the warm start"

    def test_along_a_curve_the_previous_zones_are_named(self):
        scene = contact.Scene(self.ROUGH, E, PERIODIC, load=1.0)
        *_, last = contact.solve_many(scene, [5e-4, 5.5e-4, 6e-4], tol=1e-7)
        choice = last.plan.decisions["first guess"]
        assert choice.way == "the previous zones, extrapolated"
        assert choice.measured <= choice.threshold

    def test_a_plan_made_beforehand_states_the_first_guess(self):
        plan = contact.plan(contact.Scene(self.ROUGH, E, PERIODIC, mean_pressure=1e-3))
        assert str(plan.decisions["first guess"]) == "a grid, since the number of zones is unknown"

    def test_a_decision_reads_as_a_sentence(self):
        choice = Decision("gaps", "contact is {} of the period", 0.81, 0.7)
        assert str(choice) == "gaps, since contact is 0.81 of the period, above 0.7"


ROUGH = TestDecisions.ROUGH
VALLEYS = contact.Biquadratic(radius=1.0, spacing=0.4 * L, period=L)
LOCALIZED = contact.Localized("self-consistent", neighbours=2)


def unknowns_of(fields):
    """The unknowns for which a solution with these fields was solved."""
    if isinstance(fields, GapFields):
        return "gaps"
    if isinstance(fields, (FullFields, ApartFields)):
        return "none"
    return "zones"


class TestUnknowns:
    """The plan records the unknowns for which the fields were solved, and the true reason."""

    SCENES = [
        (WAVE, PERIODIC, "mean_pressure", (1e-3, 3.1e-3, 0.1)),
        (WAVE, PERIODIC, "half_width", (0.1, 0.2, 0.45)),
        (WAVE, PERIODIC, "contact_fraction", (0.3, 0.96, 0.97, 1.0)),
        (WAVE, PERIODIC, "approach", (1e-4, 9.9e-4)),
        (WAVE, LOCALIZED, "half_width", (0.1, 0.3)),
        (WAVE, LOCALIZED, "mean_pressure", (3e-4, 5e-4)),
        (contact.Parabola(1.0), ISOLATED, "load", (1e-3, 2e-3)),
        (ROUGH, PERIODIC, "mean_pressure", (1e-3, 2e-3, 4e-3, 6e-3, 0.1)),
        (ROUGH, PERIODIC, "load", (1e-3, 4e-3)),
        (ROUGH, PERIODIC, "contact_fraction", (0.3, 0.65, 0.72, 0.8, 0.81, 0.995)),
        (ROUGH, PERIODIC, "approach", (2e-4, 5e-4)),
        (VALLEYS, PERIODIC, "contact_fraction", (0.2, 0.5, 0.52)),
        (VALLEYS, PERIODIC, "load", (1e-3, 1e-2)),
    ]

    @pytest.mark.parametrize(("profile", "model", "control", "values"), SCENES)
    def test_the_recorded_unknowns_are_those_of_the_fields(self, profile, model, control, values):
        near = None
        for value in values:
            scene = contact.Scene(profile, E, model, **{control: value})
            alone = contact.solve(scene, tol=1e-7)
            assert alone.plan.decisions["unknowns"].way == unknowns_of(alone.fields)
            if near is not None and len(near.zones):
                beside = contact.solve(scene, tol=1e-7, near=near)
                assert beside.plan.decisions["unknowns"].way == unknowns_of(beside.fields)
            near = alone

    def test_the_recorded_unknowns_are_those_of_the_fields_along_a_curve(self):
        scene = contact.Scene(ROUGH, E, PERIODIC, load=1.0)
        loads = np.geomspace(1e-3, 6e-3, 12)
        solutions = contact.solve_many(scene, loads, tol=1e-7)
        ways = [solution.plan.decisions["unknowns"].way for solution in solutions]
        assert ways == [unknowns_of(solution.fields) for solution in solutions]
        assert set(ways) == {"zones", "gaps"}

    @pytest.mark.parametrize("law", [contact.JKR(1e-7), contact.Dugdale(1e-7, 1e-3)])
    @pytest.mark.parametrize("control", [{"mean_pressure": 1e-3}, {"mean_pressure": 0.1}])
    def test_the_recorded_unknowns_are_those_of_the_fields_under_adhesion(self, law, control):
        solution = contact.solve(contact.Scene(WAVE, E, PERIODIC, law=law, **control), tol=1e-6)
        choice = solution.plan.decisions["unknowns"]
        assert choice.way == unknowns_of(solution.fields)
        assert law.name in solution.plan.decisions["solver"].reason

    def test_a_warm_started_contact_fraction_states_the_origin_of_its_unknowns(self):
        near = solve(ROUGH, tol=1e-7, contact_fraction=0.8)
        scene = contact.Scene(ROUGH, E, PERIODIC, contact_fraction=0.81)
        plan = contact.solve(scene, tol=1e-7, near=near).plan
        first, choice = plan.decisions["first guess"], plan.decisions["unknowns"]
        assert first.way == "the warm start" and first.measured < first.threshold
        assert first.measured == pytest.approx(0.01 / 0.19)
        assert choice.way == "gaps" and choice.measured > choice.threshold
        assert choice.because.startswith("they were the unknowns under a similar load: ")

    def test_zones_whose_error_is_below_that_of_the_gaps_are_named(self, monkeypatch):
        """The gaps pass the certificate, but their stated error is above the tolerance."""
        plain = gaps.tightened_gaps
        loose = {"control_error": 1e-4}
        monkeypatch.setattr(gaps, "tightened_gaps", lambda c, f, **_: replace(plain(c, f), **loose))
        monkeypatch.setattr(refine, "replace", lambda found, **_: found)
        solution = solve(ROUGH, tol=1e-7, mean_pressure=4e-3)
        choice = solution.plan.decisions["unknowns"]
        assert isinstance(solution.fields, ZoneFields) and choice.way == "zones"
        assert choice.because == "with gaps as the unknowns, the stated error is {}"
        assert choice.measured > choice.threshold == 1e-7

    @pytest.mark.parametrize(
        ("scene", "because"),
        [
            (contact.Scene(WAVE, E, PERIODIC, law=contact.JKR(1e-7), half_width=0.1), "is given"),
            (contact.Scene(contact.Parabola(1.0), E, ISOLATED, moment=1e-5, load=1e-3), "isolated"),
            (contact.Scene(WAVE, E, LOCALIZED, mean_pressure=5e-4), "strip"),
            (contact.Scene(WAVE, E, PERIODIC, law=contact.JKR(1e-7), load=1e-3), "law jkr forbids"),
        ],
    )
    def test_each_obstacle_to_gaps_has_its_own_reason(self, scene, because):
        assert because in contact.solve(scene, tol=1e-6).plan.decisions["unknowns"].because

    def test_a_law_with_a_module_of_its_own_is_the_reason(self, monkeypatch):
        class Own(contact.Frictionless):
            name = "own"
            routes = Routes(False, False, module="contact.testing")

        monkeypatch.setattr(contact.testing, "found", found, raising=False)
        scene = contact.Scene(ROUGH, E, PERIODIC, law=Own(), mean_pressure=1e-3)
        assert contact.plan(scene).decisions["first guess"].way == "that of the module"
        decisions = contact.solve(scene, tol=1e-2).plan.decisions
        assert str(decisions["solver"]) == (
            "the module of the law, since the law own is solved by contact.testing"
        )
        assert decisions["unknowns"].because == "the law own forbids gaps as the unknowns"
