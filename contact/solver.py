"""Scene -> plan -> equation -> density -> solution."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from numbers import Real

import numpy as np
from numpy.typing import NDArray

import sie
from contact.errors import NotConverged, OutOfRange, SceneError, warn
from contact.formulation.conjugate import ScaledConjugate
from contact.formulation.fields import ZoneFields, mean_shape
from contact.formulation.full import FullFields, FullLimit, period_samples
from contact.formulation.gaps import GapFields
from contact.formulation.problem import Control, Problem, Units
from contact.formulation.single import guess_half_width, largest_single_load, single_half_width
from contact.model.interactions.periodic import Periodic
from contact.model.scene import Scene
from contact.search.bounded import refuse_unbounded
from contact.search.by_load import approach, contact_fraction, nearer
from contact.search.coarse import MOST_POINTS
from contact.search.first_order import FirstOrder
from contact.search.gap_topology import find_gaps, settle_gaps
from contact.search.plateau import refuse_below_plateau
from contact.search.proposals import about, load_of_width, placed, proposed
from contact.search.scaling import Framed, framed, framed_about, lowest
from contact.search.tilt import known_part
from contact.search.topology import Progress, WrongTopology, same_end, settle
from contact.solution import plan as planning
from contact.solution import validity
from contact.solution.plan import Plan
from contact.solution.solution import Solution, limit_of_approach
from contact.testing import check_profile
from contact.verify.accuracy import Found, limit, of_positions, stated_error
from contact.verify.certificate import Certificate
from contact.verify.gap_accuracy import Gapped

Array = NDArray[np.float64]

# Finest coarse grid; a scene whose zones are narrower needs more than a grid to find them.
_MOST_POINTS = 2**17
# Contact of more than this part of the period is solved by its gaps.
_NEARLY_FULL = 0.7
# The same of a body that is no half-plane, where that is why its zones are not found.
_ALMOST_FULL = 0.99
# Zones of a lone body farther than so many times their span from the origin of places.
_FAR_OFF = 64.0
# The same for several asperities whose valleys have kinks: gaps over them, however narrow, are unknowns like any others.
_WITH_KINKS = 0.25
# Of a load: near enough for the zones to lead to those of the approach, and to be about them.
_NEAR_LOAD, _NEARER_LOAD = 1e-2, 1e-5
# Of a load: near enough for the zones to lead to those of a width; where they did not, how much nearer before it is tried again.
_NEAR_WIDTH, _MUCH_NEARER = 5e-3, 0.1
# A contact fraction is not told by the load where it is missed by more than this when the bracket is closed.
_JUMP = 1e-9
# Of what is in contact, or of what is not: a change by more is searched for by a grid.
_BESIDE = 0.3
# What is left open, of the period, where the gaps are looked for at once.
_LAST_OPEN = 1e-3
# Newton steps and rounds from zones so near; and where a bracket on the load is closed.
_FEW, _FEW_ROUNDS, _CLOSED = 12, 5, 1e-14
# Tolerance of solutions on the way to an approach or a contact fraction; at first, while these are far off.
_ON_THE_WAY, _FIRST_ONES = 1e-7, 1e-5
# An end of a gap moves all of the pressure beside it: gaps are found to this part of what zones are.
_OF_GAPS = 0.01
# Steps of the centre of a strip, how much longer than its miss a secant's step may be, and how often one is shortened.
_CENTRINGS, _LONGER, _SHORTENED = 30, 16.0, 3
# A smaller inner tolerance that leaves more of the error than this does no good: what is left is rounding.
_USELESS = 0.5
# Half widths of a zone over the length of the kernel's smooth part: the modes of a zone show it to rounding, or not at all.
_RESOLVED, _HOPELESS = 40.0, 150.0
# The smallest tolerance that is asked of the engine.
_LEAST = 2e-15
# In how many steps of it the miss must halve.
_STALLED = 4


def solve(
    scene: Scene, tol: float = 1e-8, progress: Progress | None = None, near: Solution | None = None
) -> Solution:
    """Solve a scene: zones, pressure, gap, and numbers, with error at most `tol` (see `Solution.error`).

    tol: relative, 1e-13 <= tol < 1. progress: called with (stage, done, total or None). near: a solution of the same
    profile and model whose zones are a good start; it saves the search, and never changes the answer.
    Raises SceneError (bad input), OutOfRange (no contact answers the control), NotConverged (with the best state). What the
    model hardly covers is a ModelWarning, and in the `warnings` of the solution.
    """
    if not isinstance(scene, Scene):
        raise SceneError.of("scene", scene, "a contact.Scene")
    if isinstance(tol, bool) or not isinstance(tol, Real) or not 1e-13 <= float(tol) < 1.0:
        raise SceneError.of("tol", tol, "a number from 1e-13 to below 1")
    if near is not None and not isinstance(near, Solution):
        raise SceneError.of("near", near, "None, or a contact.Solution")
    if near is not None and _of(near.scene) != _of(scene):
        raise SceneError("near must be a solution of the same profile, interaction model, substrate and law", "near", near.scene)
    of_scene = validity.of_scene(scene)
    warn(of_scene)
    solution = _solved(scene, float(tol), progress, near)
    warn(validity.of_solution(solution)[len(of_scene) :])
    return solution


def _of(scene: Scene) -> tuple[object, ...]:
    """All of a scene but its control and its modulus."""
    return scene.profile, scene.interaction, scene.substrate, scene.law


def _solved(scene: Scene, tol: float, progress: Progress | None, near: Solution | None) -> Solution:
    return _Run(scene, tol, planning.plan(scene), progress, near).solution()


_AT_BORDER = "a contact zone reaches the border of the part of the profile that is known"
_EXACT = "interaction = Periodic() needs no strip"
_AT_STRIP = f"a contact zone reaches the border of the strip that the localized model solves; {_EXACT}"


@dataclass(frozen=True, eq=False)
class _Centring:
    """Centre of a strip, how far off it the zones' middle is, and the zones."""

    centre: float
    miss: float
    table: Array


class _Run:
    """One solve: scene, tolerance, plan, and the scaled problem made of them."""

    def __init__(self, scene: Scene, tol: float, plan: Plan, progress: Progress | None, near: Solution | None) -> None:
        self.scene, self.tol, self.plan, self.progress = scene, tol, plan, progress
        self.tolerance = max(0.1 * tol, _LEAST)
        self.single = planning.starts_from_one_zone(scene)
        self.near = near
        # Where both load and tilt are unknown, and where the grid does not find the approach.
        self.by_loads = scene.turned and scene.moment is not None and scene.approach is not None
        self.operator = scene.operator
        self.full = FullLimit(scene.profile, scene.E_star, self.operator, scene.law)

    def solution(self) -> Solution:
        start = time.perf_counter()
        try:
            return self._solution()
        finally:
            self.plan.seconds = time.perf_counter() - start

    def _solution(self) -> Solution:
        kind, value = self.scene.control
        if kind == "contact_fraction" and value == 1.0:
            return self._full(self._full_pressure_or_refuse())
        if self.operator.is_plain and self.scene.law.convex:
            refuse_below_plateau(self.scene)
        refuse_unbounded(self.scene)
        found: Found | Gapped | None = self._beside_near()
        if found is None:
            try:
                found = self._framed_and_found()
            except (OutOfRange, NotConverged) as failure:
                found = self._found_by_loads(failure)
        if isinstance(found, Gapped) and found.error > self.tol:
            found = self._by_zones(found)
        if isinstance(found, Gapped) and found.error > self.tol:
            with self.plan.timed("zone ends"):
                found = self._tightened_gaps(self.problem, self.control, found, stuck=True)
        if isinstance(found, Found):
            found = self._tightened(self._counted_from_there(found))
        if found is None:
            return self._full(self._mean_pressure())
        return self._gapped(found) if isinstance(found, Gapped) else self._solved(found)

    def _set(self, frame: Framed) -> None:
        self.frame, self.problem, self.control = frame, frame.problem, frame.control

    def _counted_from_there(self, found: Found) -> Found:
        """Zones of a lone body that lie far from where they were looked for, solved again with places counted from there: else these
        are rounded to much of the zones' widths."""
        scene, zones = self.scene, found.free.density.zones
        span, away = float(zones.b[-1] - zones.a[0]), float(max(-zones.a[0], zones.b[-1]))
        if scene.interaction.needs_period or scene.turned or scene.profile.support is not None or away < _FAR_OFF * span:
            return found
        before, table = self.frame, self._si(zones)
        self._set(framed_about(scene, 0.0, table))
        try:
            with self.plan.timed("zone ends"):
                return self._settle(self.problem, self.control, placed(self.problem, table))
        except (WrongTopology, OutOfRange):
            self._set(before)
            return found

    def _framed_and_found(self) -> Found | Gapped | None:
        self._set(self._framed())
        return self._found()

    def _found_by_loads(self, failure: OutOfRange | NotConverged) -> Found | Gapped | None:
        """An approach that the grid did not find, by loads; raises `failure` if that does not lead on. A grid's lowest point may lie
        above the profile's by more than the approach of a lone body, and narrow gaps between its points."""
        scene = self.scene
        if self.by_loads or self.near is not None or scene.turned or scene.approach is None or not scene.interaction.exact:
            raise failure
        if scene.interaction.needs_period and isinstance(failure, OutOfRange):
            raise failure
        self.by_loads = True
        try:
            return self._framed_and_found()
        except NotConverged:
            raise failure from None

    def _framed(self) -> Framed:
        if not self.by_loads:
            tilt = None if self.near is None else self.near.tilt
            return framed(self.scene, self.single, tilt or 0.0)
        # Grids are searched by load: the zones are about those of the load that has the approach.
        self.near = self._at_approach(_NEAR_LOAD)
        return self._framed_at_level()

    def _framed_at_level(self) -> Framed:
        assert self.near is not None
        if self.scene.interaction.needs_period:
            return framed(self.scene, self.single)
        frame = framed_about(self._loaded(self.near.load), self.near.tilt or 0.0, self.near.zones)
        return replace(frame, control=Control("approach", self.scene.control[1] / frame.problem.units.height))

    def _beside_near(self) -> Found | None:
        """A body of unknown tilt, from a solution at hand: its tilt need not be searched for; None if that does not lead on."""
        near, scene = self.near, self.scene
        if near is None or len(near.zones) == 0 or scene.moment is None or not scene.turned or self.by_loads:
            return None
        self._set(framed_about(scene, near.tilt or 0.0, near.zones))
        with self.plan.timed("zone ends"):
            try:
                return self._settle(self.problem, self.control, placed(self.problem, near.zones))
            except (WrongTopology, OutOfRange):
                return None

    def _at_approach(self, nearness: float) -> Solution:
        scene, wanted, moment = self.scene, self.scene.control[1], self.scene.moment or 0.0
        known = known_part(scene.profile)
        reach = math.inf if known is None or moment == 0.0 else known[1] if moment > 0 else -known[0]
        if not reach > 0.0:
            raise OutOfRange(f"moment {moment:.6g} N: the whole body lies on the other side of x = 0")
        guess = scene.E_star * (0.3 * abs(wanted) or 1e-3 * (scene.operator.datum or 1.0))
        first = guess if self.near is None else self.near.load
        bounded, largest = known is not None and scene.profile.support is None, -math.inf
        concave = moment == 0.0 and self.operator.is_plain and scene.law.convex
        for here, off in nearer(self._on_the_way, approach, wanted, first, abs(moment) / reach, bounded, concave):
            if off <= nearness:
                return here
            largest = max(largest, here.approach or 0.0)
        raise OutOfRange(f"no load has the approach {wanted:.6g} m; the largest of those tried was {largest:.6g} m")

    def _on_the_way(self, load: float, near: Solution | None, tol: float = _ON_THE_WAY) -> Solution:
        """The solution under a load, beside a solution or that at hand."""
        try:
            return _solved(self._loaded(load), tol, self.progress, near or self.near)
        except NotConverged as failure:
            if failure.best is None or not failure.best.error < max(1e3 * _ON_THE_WAY, 10 * tol):
                raise
            return failure.best

    def _on_the_way_to_width(self, load: float, near: Solution | None, tol: float) -> Solution:
        """The same, from a grid where contact is far from that of the solution."""
        if near is not None:
            fraction, rate = contact_fraction(near)
            near = near if abs(rate * (load - near.load)) < _BESIDE * min(fraction, 1 - fraction) else None
        elif self.near is not None and load == self.near.load:
            return self.near
        return self._on_the_way(load, near, tol)

    def _loaded(self, load: float) -> Scene:
        return replace(self.scene, approach=None, contact_fraction=None, load=load)

    def _by_fraction(self, problem: Problem, control: Control) -> Found | Gapped:
        """A width from a solution under about the load that has it, ever nearer ones until its zones lead on."""
        if self.near is None:
            # What is open of a contact as full as this are tops of H f', of which no grid tells the load.
            gapped = self._by_gaps(problem, control, control.value) if 1 - self.scene.control[1] < _LAST_OPEN else None
            if gapped is not None:
                return gapped
            with self.plan.timed("coarse search"):
                first = load_of_width(self.frame, problem, control.value) * problem.units.load
        else:
            first = self.near.load
        goal, near_enough, last, off = self.scene.control[1], _NEAR_WIDTH, None, 1.0

        def solved(load: float, near: Solution | None) -> Solution:
            return self._on_the_way_to_width(load, near, _FIRST_ONES if off > _NEAR_WIDTH else _ON_THE_WAY)

        for here, off_load in nearer(solved, contact_fraction, goal, first, closed=_CLOSED):
            last, fraction = here, contact_fraction(here)[0]
            # Where a little more load brings much more into contact, the width is what tells how near it is.
            off = max(off_load, abs(goal - fraction) / min(goal, 1 - goal))
            if off > near_enough:
                continue
            near_enough = _MUCH_NEARER * off
            try:
                with self.plan.timed("zone ends"):
                    return self._at_width(problem, control, here)
            except WrongTopology:
                pass
        assert last is not None
        return self._under_load_of(problem, control, last)

    def _under_load_of(self, problem: Problem, control: Control, near: Solution) -> Found | Gapped:
        """The contact under the load that has the width, where the zones of the width itself do not settle: right at a birth or a
        merger."""
        assert near.contact_fraction is not None and problem.period is not None
        missed = abs(near.contact_fraction - control.value / problem.period)
        if missed > _JUMP:
            raise NotConverged(
                f"no load that double precision tells from its neighbours has the contact fraction {self.scene.control[1]:.15g}: at a "
                f"mean pressure of {near.mean_pressure:.15g} Pa it is {near.contact_fraction:.15g}, beside that beyond", (), near,
            )
        load = Control("load", near.load / problem.units.load)
        try:
            with self.plan.timed("zone ends"):
                found = self._at_width(problem, load, near)
        except WrongTopology as failure:
            raise self._not_converged(failure) from failure
        if isinstance(found, Gapped):
            return replace(found, off=found.off + _CLOSED * load.value / problem.period)
        narrowest = float(np.diff(found.free.density.zones.table, axis=1).min())
        return replace(found, off=missed * problem.period / narrowest)

    def _at_width(self, problem: Problem, control: Control, near: Solution) -> Found | Gapped:
        fields = near.fields
        if isinstance(fields, GapFields):
            found = settle_gaps(
                problem, control, fields.conjugate, fields.density.zones.table, fields.mean, _OF_GAPS * self.tolerance
            )
            return self._tightened_gaps(problem, control, found)
        return settle(
            problem, control, placed(problem, near.zones), self.tolerance, self.progress, timed=self.plan.timed,
            value=near.load / problem.units.load, steps=_FEW, rounds=_FEW_ROUNDS,
        )

    def _by_zones(self, found: Gapped) -> Found | Gapped:
        """The same contact with the pressure as the unknown, if that comes out better. Not under an approach: near full
        contact the level of the zones, a difference of large numbers, tells little of them."""
        if self.control.kind == "approach":
            return found
        table = found.fields.zones
        try:
            with self.plan.timed("zone ends"):
                other = self._settle(about(self.problem, table), self.control, table)
        except (WrongTopology, OutOfRange):
            return found
        return other if stated_error(other, self.control) < found.error else found

    def _tightened(self, found: Found) -> Found | Gapped | None:
        """Solved again from the same zones with a smaller inner tolerance, where the error came out above the wanted one; from
        the start, if they do not stand up to it. Where a smaller tolerance leaves the error, the least one is the last that is tried."""
        useless = False
        for _ in range(3):
            error = stated_error(found, self.control)
            hopeless = self._is_rounding(found) or self._too_thin(found.fields.problem, found.free.density.zones.table) != ""
            if error <= self.tol or self.tolerance <= _LEAST or hopeless:
                break
            self.tolerance = _LEAST if useless else max(_LEAST, 0.05 * self.tolerance * self.tol / error)
            try:
                with self.plan.timed("zone ends"):
                    better = self._again(found)
            except (WrongTopology, NotConverged, OutOfRange):
                try:
                    better = self._found()
                except (NotConverged, OutOfRange):
                    break
            if not isinstance(better, Found):
                return better
            after = stated_error(better, self.control)
            if after < error:
                found = better
            useless = after > _USELESS * error
        return found

    def _is_rounding(self, found: Found) -> bool:
        """Whether rounding alone, of a solution that no iteration left an error in, is above the wanted error."""
        return not found.free.state.iterated and bool(limit(found.free, 4 * self.tol, "zone", 4 * of_positions(found)))

    def _again(self, found: Found) -> Found | Gapped | None:
        if self.scene.interaction.follows_isolated:
            return self._first_order()
        problem, table = found.fields.problem, found.free.density.zones.table
        if self.scene.interaction.strip:
            return self._centred(problem, self.control, table)
        return self._settle(problem, self.control, table)

    def _mean_pressure(self) -> float:
        """Of full contact, from a load or an approach [Pa]."""
        kind, value = self.scene.control
        period = self.scene.profile.period
        assert period is not None
        if kind == "approach":
            # Beyond the mean of the profile, the base of the substrate gives way to a uniform pressure.
            assert self.operator.compression
            return 0.5 * self.scene.E_star * (value - self._mean_height) / self.operator.compression
        return value if kind == "mean_pressure" else value / period

    # full contact ---------------------------------------------------------------------------------------------------
    def _full_pressure_or_refuse(self) -> float:
        pressure = self.full.pressure
        if not math.isfinite(pressure):
            if self.full.approached and not self.operator.has_inverse:
                raise OutOfRange(self._no_inverse("full contact is not known"))
            raise OutOfRange("no load brings this scene into full contact: its valleys have kinks, or the model has none")
        return pressure

    def _no_inverse(self, what: str) -> str:
        name = self.scene.interaction.name
        return (
            f"{what}: the interaction {name!r} gives a kernel and no symbol, so the pressure that flattens the surface cannot be told. "
            "Give it a `symbol`, or ask for less contact"
        )

    def _full(self, mean_pressure: float) -> Solution:
        scene, profile = self.scene, self.scene.profile
        self._full_pressure_or_refuse()
        fields = FullFields(self._of_period, mean_pressure, self.full.relief, self._mean_height)
        least = mean_pressure - self.full.pressure
        certificate = Certificate(
            smallest_pressure=least, smallest_gap=None, gap_rounding=0.0, load_balance=0.0, level_spread=0.0,
            points=len(period_samples(profile)), holds=True, note="full contact: the pressure is nowhere negative",
        )
        for name in ("zone ends", "coarse search"):
            self.plan[name].used, self.plan[name].reason = False, "full contact"
        # Rounding of the closed form, in terms of the peak pressure, or of the mean where the peak is infinite.
        peak = fields.max_pressure if math.isfinite(fields.max_pressure) else mean_pressure
        error = 1e-13 + self.full.rounding / peak
        solution = Solution(scene, np.zeros((0, 2)), fields, error, certificate, self.plan)
        if error > self.tol:
            why = f"rounding of the heights leaves an error of {error:.1e} in full contact, above the tolerance {self.tol:.1e}"
            raise NotConverged(why, (), solution)
        return solution

    @property
    def _of_period(self) -> Problem:
        """The scene scaled by its period."""
        scene, profile = self.scene, self.scene.profile
        units = Units(0.0, profile.period or 1.0, 1.0, scene.E_star)
        return Problem(profile, scene.interaction, scene.substrate, scene.law, units, lowest(profile))

    @property
    def _mean_height(self) -> float:
        """mean f - min f over the period [m]."""
        problem = self._of_period
        return mean_shape(problem) * problem.units.height

    # zones ----------------------------------------------------------------------------------------------------------
    def _found(self) -> Found | Gapped | None:
        """Zones that pass the certificate; None in full contact."""
        interaction, problem = self.scene.interaction, self.problem
        if self.by_loads and not interaction.needs_period:
            return self._at_level()
        if interaction.follows_isolated:
            return self._first_order()
        if interaction.strip:
            return self._centred(problem, self.control, self._start())
        return self._search(problem, self.control, self._start(), near=True)

    def _at_level(self) -> Found:
        """Under an approach, from zones of about the right load; of just about it, if these do not lead on."""
        assert self.near is not None
        try:
            return self._settle(self.problem, self.control, placed(self.problem, self.near.zones))
        except WrongTopology:
            self.near = self._at_approach(_NEARER_LOAD)
            self._set(self._framed_at_level())
        return self._settled(self.problem, self.control, placed(self.problem, self.near.zones))

    def _start(self) -> Array | None:
        """Zones of the near solution, scaled; None if there is none or it is in full contact, or where one zone is to be found, which
        is known better in closed form."""
        if self.near is None or len(self.near.zones) == 0 or self.single:
            return None
        return placed(self.problem, self.near.zones)

    def _search(
        self, problem: Problem, control: Control, start: Array | None = None, near: bool = False
    ) -> Found | Gapped | None:
        """Zones from a start, if there is one; else, and where it does not lead on, from scratch. near: the start is a solution's, which
        is given up as soon as it turns out to be far off: from there the way may be longer than from scratch."""
        if control.kind == "approach":
            if self._is_full(control):
                return None
            self._below_full_approach(control)
        # A width that a closure looks at on its way is none of the scene's.
        if self.scene.contact_fraction is not None and not self.single:
            return self._by_fraction(problem, control)
        if start is not None:
            width = float((start[:, 1] - start[:, 0]).sum())
            gapped = self._by_gaps(problem, control, width, start, near)
            if gapped is not None:
                return gapped
            if not self._worth_gaps(problem, width):
                try:
                    return self._settle(problem, control, start, near)
                except WrongTopology:
                    pass
        if control.kind == "half_width":
            a = control.value
            return self._settled(problem, control, np.array([[-a, a]]))
        if self.single and problem.amplitude is None:
            # Only wide zones can be near full contact, and only then is it worth finding out where it begins.
            with self.plan.timed("zone ends"):
                guess = guess_half_width(problem, control)
            if problem.period is not None and guess > 0.25 * problem.period and self._is_full(control):
                return None
            gapped = self._by_gaps(problem, control, 2 * guess)
            if gapped is not None:
                return gapped
            found = self._from_one_zone(problem, control, guess)
            if found is not None:
                return found
        return self._by_fraction(problem, control) if control.kind == "width" else self._from_grid(problem, control)

    def _worth_gaps(self, problem: Problem, width: float) -> bool:
        """Whether contact of about this scaled width is better solved by its gaps."""
        if not (self.full.approached and self.operator.is_half_plane and self.scene.law.by_gaps) or problem.period is None:
            return False
        return width > (_NEARLY_FULL if self.full.possible or self.single else _WITH_KINKS) * problem.period

    def _by_gaps(
        self, problem: Problem, control: Control, width: float, zones: Array | None = None, near: bool = False
    ) -> Gapped | None:
        """The contact solved by its gaps, where it is about as wide as that; None if it is not or that fails."""
        if control.kind == "half_width" or not self._worth_gaps(problem, width):
            return None
        conjugate = ScaledConjugate.of(self.full.conjugate, problem)
        with self.plan.timed("zone ends"):
            try:
                found = self._tightened_gaps(
                    problem, control, find_gaps(problem, control, conjugate, _OF_GAPS * self.tolerance, width, zones, near)
                )
            except WrongTopology:
                return None
        return found if math.isfinite(found.error) else None

    def _tightened_gaps(self, problem: Problem, control: Control, found: Gapped, stuck: bool = False) -> Gapped:
        """Solved again from the same gaps with a smaller inner tolerance, where the error came out above the wanted one. stuck: even
        where rounding has kept the ends from the tolerance before."""
        tolerance, useless = _OF_GAPS * self.tolerance, False
        for _ in range(3):
            if found.error <= self.tol or tolerance <= _LEAST or (found.free.trace[-1].move > tolerance and not stuck):
                break
            tolerance = _LEAST if useless else max(_LEAST, 0.05 * tolerance * self.tol / found.error)
            fields = found.fields
            try:
                better = settle_gaps(
                    problem, control, fields.conjugate, fields.density.zones.table, fields.mean, tolerance, near=True
                )
            except WrongTopology:
                break
            before = found.error
            found = better if better.error < before else found
            useless = better.error > _USELESS * before
        return found

    def _is_full(self, control: Control) -> bool:
        """Whether the load, or the approach of a body with a base, is that of full contact or above."""
        if not self.full.possible or not (control.kind == "load" or (control.kind == "approach" and self.operator.compression)):
            return False
        return self._mean_pressure() >= self.full.pressure

    def _below_full_approach(self, control: Control) -> None:
        datum, support = self.operator.datum, self.scene.profile.support
        upright = self.scene.is_flat and not self.scene.turned
        # A punch as wide as four times the datum has that of a line load there: no load lowers it.
        if datum is not None and self.operator.is_plain and support is not None and upright and support[1] - support[0] >= 4 * datum:
            raise OutOfRange(
                f"approach {control.value * self.problem.units.height:.6g} m: a flat punch of width "
                f"{support[1] - support[0]:.6g} m has none above zero with a datum of {datum:.6g} m"
            )
        if not self.full.approached or (self.operator.has_inverse and not self.full.possible) or self.operator.compression:
            return
        # Without a base u has no mean: the mean gap is that of the profile less the approach.
        highest, units = mean_shape(self.problem), self.problem.units
        # Both are differences from the lowest point, rounded as heights are.
        rounding = 8.0 * float(np.finfo(np.float64).eps) * (highest + abs(self.problem.lowest) / units.height)
        if control.value >= highest - rounding:
            raise OutOfRange(
                f"approach {control.value * units.height:.15g} m is not below {highest * units.height:.15g} m, the mean of "
                "the profile: there it is in full contact, at any load above the smallest, or as near to it as digits of the approach tell"
            )

    def _settle(self, problem: Problem, control: Control, table: Array, near: bool = False) -> Found:
        thin = self._too_thin(problem, table, _HOPELESS)
        if thin:
            raise OutOfRange(thin)
        return settle(problem, control, table, self.tolerance, self.progress, timed=self.plan.timed, near=near)

    def _settled(self, problem: Problem, control: Control, table: Array) -> Found:
        try:
            return self._settle(problem, control, table)
        except WrongTopology as failure:
            if control.kind == "half_width":
                message = f"one zone of this half width carries no pressure that is positive everywhere: {failure}"
                raise OutOfRange(message) from failure
            raise self._not_converged(failure) from failure

    def _not_converged(self, failure: WrongTopology) -> NotConverged:
        trace = failure.free.trace if failure.free is not None else ()
        best = None
        if failure.free is not None:
            fields = ZoneFields(self.problem, failure.free.state)
            best = Solution(
                self.scene, self._si(failure.free.density.zones), fields, math.inf,
                Certificate(math.nan, None, 0.0, math.nan, math.nan, 0, False, note=str(failure)), self.plan, trace,
            )
        return NotConverged(f"not converged: {failure}{self._fault_of_profile()}", trace, best)

    def _fault_of_profile(self) -> str:
        """What is wrong with a profile of someone's own that did not lead to a solution, in words; empty if nothing is."""
        profile = self.scene.profile
        if type(profile).__module__.startswith("contact."):
            return ""
        faults = check_profile(profile, raises=False).faults
        return f"; the profile contradicts itself, says contact.testing.check_profile: {faults[0]}" if faults else ""

    def _from_one_zone(self, problem: Problem, control: Control, a: float) -> Found | None:
        """One zone about the tip; None if it does not pass, for the grid to find out why."""
        with self.plan.timed("zone ends"):
            try:
                return self._settle(problem, control, np.array([[-a, a]]))
            except WrongTopology:
                pass
            if control.kind in ("load", "approach"):
                # Along the branch from zero load the controlled quantity grows with the width up to its maximum.
                exact = single_half_width(problem, control)
                if exact is None:
                    if not self.scene.interaction.exact or (self.operator.is_plain and not self.operator.is_periodic):
                        top = largest_single_load(problem, control)
                        units = problem.units
                        unit = units.load if control.kind == "load" else units.height
                        raise OutOfRange(
                            f"{control.kind} {control.value * unit:.6g} is beyond the largest that "
                            f"{self.scene.interaction.name} carries on the branch from zero load, {top[1] * unit:.6g} at "
                            f"half width {top[0] * units.length:.6g} m"
                        )
                    return None
                try:
                    return self._settle(problem, control, np.array([[-exact, exact]]))
                except WrongTopology:
                    pass
        return None

    def _from_grid(self, problem: Problem, control: Control, held: bool = False) -> Found | Gapped | None:
        """Zones from a coarse grid, refined until Newton and the certificate agree with it. held: a strip stays where it is."""
        search = self.plan["coarse search"]
        search.used, search.reason = True, search.reason if search.used else "one zone did not pass the certificate"
        points: int | None = None
        failure: WrongTopology | None = None
        most, touched, full, width = _MOST_POINTS, False, False, 0.0
        while points is None or points <= most:
            if self.progress is not None:
                self.progress("coarse grid", 0, None)
            with self.plan.timed("coarse search"):
                proposal = proposed(self.frame, problem, control, points, held=held)
            if points is None:
                most = max(most, min(4 * proposal.points, MOST_POINTS))
            points, full = proposal.points, proposal.full
            if proposal.tilt is not None:
                problem = problem.turned_to(proposal.tilt)
            search.detail = f"{points} points, {len(proposal.zones)} zones proposed"
            if proposal.touches_border and self.scene.profile.support is None:
                if touched or 4 * points > most:
                    raise OutOfRange(_AT_STRIP if problem.interaction.strip else _AT_BORDER)
                # A coarse grid may touch it by its own error.
                touched, points = True, 4 * points
                continue
            width = proposal.width / problem.units.length
            if problem.period is not None and width > 0.4 * problem.period and self._is_full(control):
                return None
            gapped = self._by_gaps(problem, control, width, placed(problem, proposal.zones))
            if gapped is not None:
                return gapped
            if not proposal.full and len(proposal.zones):
                with self.plan.timed("zone ends"):
                    table = placed(problem, proposal.zones)
                    try:
                        return self._settle(problem if held else about(problem, table), control, table)
                    except WrongTopology as error:
                        if failure is not None and same_end(error, failure):
                            break
                        failure = error
            points *= 4
        if full and self.operator.is_periodic and not self.operator.has_inverse:
            raise OutOfRange(self._no_inverse(f"in full contact, or nearer to it than a grid of {points} points tells"))
        narrow = "the gaps are narrower than the finest grid tells from full contact"
        if self.operator.is_periodic and not self.operator.is_half_plane:
            narrow += "; the gaps themselves are solved for on a half-plane only"
            if failure is not None and width > _ALMOST_FULL * (problem.period or math.inf):
                failure = WrongTopology(f"{failure}, and {narrow}", failure.free)
        raise self._not_converged(failure or WrongTopology(narrow, None))

    # strips ---------------------------------------------------------------------------------------------------------
    def _centred(self, problem: Problem, control: Control, start: Array | None) -> Found:
        """Zones of a strip that is centred on them: secants on the centre, under which zones are taken as they are, and a look at the
        signs where it stays."""
        found = self._in_strip(problem if start is None else about(problem, start), control, start)
        certified, before, moved = True, None, math.inf
        passed: list[float] = []
        for _ in range(_CENTRINGS):
            zones, centre = found.free.density.zones, found.fields.problem.centre
            width = float((zones.b - zones.a).min())
            miss = 0.0 if zones.symmetric else 0.5 * float(zones.a[0] + zones.b[-1]) - centre
            # Near the digits of the zones the centre no longer comes nearer.
            if abs(miss) <= 0.1 * self.tolerance * width + np.spacing(abs(centre)) or moved / 4 < abs(miss) < 1e-7 * width:
                if certified:
                    return found
                found, certified, before, moved = self._in_strip(found.fields.problem, control, zones.table), True, None, math.inf
                continue
            passed.append(abs(miss))
            if len(passed) > _STALLED and min(passed[-_STALLED:]) > 0.5 * min(passed[:-_STALLED]):
                break
            step, rate = miss, None
            if before is not None and before.table.shape == zones.table.shape and before.miss != miss:
                step = float(np.clip(miss * (centre - before.centre) / (before.miss - miss), -_LONGER * abs(miss), _LONGER * abs(miss)))
                rate = (zones.table - before.table) / (centre - before.centre)
            before, moved = _Centring(centre, miss, zones.table), abs(miss)
            found, certified = self._moved_strip(found, control, step, rate)
        raise self._not_converged(WrongTopology(f"the centre of the strip did not settle; {_EXACT}", found.free))

    def _moved_strip(self, found: Found, control: Control, step: float, rate: Array | None) -> tuple[Found, bool]:
        """(zones after a step of the centre, or after a shorter one that they follow, whether their signs were looked at). rate: of the
        zones with the centre, where it is known."""
        problem, table = found.fields.problem, found.free.density.zones.table
        for _ in range(_SHORTENED):
            there, expected = problem.about(problem.centre + step), table if rate is None else table + step * rate
            try:
                return settle(there, control, expected, self.tolerance, formal=True, near=True), False
            except (WrongTopology, OutOfRange):
                pass
            try:
                again = self._from_grid(there, control, held=True)
                assert isinstance(again, Found)
                return again, True
            except (NotConverged, OutOfRange):
                step *= 0.25
        raise self._not_converged(WrongTopology(f"the zones do not follow the centre of the strip; {_EXACT}", found.free))

    def _in_strip(self, problem: Problem, control: Control, start: Array | None) -> Found:
        """Zones of a strip where it is."""
        found = self._search(problem, control, start, near=True)
        assert isinstance(found, Found)  # a strip has no full contact to be near to
        return found

    def _first_order(self) -> Found:
        """Closure by the isolated load of the same total width."""
        closure = FirstOrder(self.problem, self._centred, self._reference, self.tolerance, self.single)
        with self.plan.timed("isolated reference"):
            found, _ = closure.found(self.control, self._first_guess())
        return found

    def _first_guess(self) -> float:
        """Total width of one zone about the origin; else the nominal pressure of the exact contact of the period, scaled."""
        problem, control = self.problem, self.control
        assert problem.period is not None
        if self.single:
            return 2 * guess_half_width(problem, control)
        if control.kind == "load":
            return control.value / problem.period
        if control.kind == "half_width":
            return 0.0
        exact = proposed(self.frame, replace(problem, interaction=Periodic()), control, None)
        return exact.load / problem.units.load / problem.period

    def _reference(self, problem: Problem, control: Control, start: Array | None) -> Found:
        """The isolated problem of the same total width, as a formal solution: it is not asked to be a contact."""
        if control.kind == "half_width":
            start = np.array([[-control.value, control.value]])
        assert start is not None
        middle = 0.5 * float(start[0, 0] + start[-1, 1])
        if len(start) > 1 or abs(middle) > 0.25 * float(start[0, 1] - start[0, 0]):
            problem = problem.about(middle)
        try:
            return settle(problem, control, start, self.tolerance, formal=True)
        except WrongTopology as failure:
            raise OutOfRange(f"the isolated reference of the first-order closure has no solution: {failure}; {_EXACT}") from failure

    # solution -------------------------------------------------------------------------------------------------------
    def _si(self, zones: sie.Zones) -> Array:
        """Zones in metres, left ends in [x0, x0 + L) and ascending."""
        return self._in_cell(np.asarray(self.problem.units.x(zones.table)))

    def _in_cell(self, table: Array) -> Array:
        period = self.scene.period
        if period is None:
            return table
        x0 = self.scene.profile.x0
        turns = np.floor((table[:, 0] - x0) / period)
        table = table - turns[:, None] * period
        return np.asarray(table[np.argsort(table[:, 0])])

    def _solved(self, found: Found) -> Solution:
        density = found.fields.density
        error = stated_error(found, self.control)
        sizes = found.free.state.sizes
        plan = self.plan
        zones = density.zones
        plan["symmetry"].used = zones.symmetric
        if not zones.symmetric and self.scene.profile.symmetric:
            plan["symmetry"].reason = "the zones straddle the border of the cell"
        plan["zone ends"].detail = f"{len(found.free.trace)} Newton steps, {found.rounds} rounds"
        plan["certificate"].detail = f"{found.certificate.points} points"
        self._tell_iterations(sizes.iterations)
        plan["kinks"].used = len(density.steps) > 0
        if plan["kinks"].used:
            plan["kinks"].reason = f"{len(density.steps)} jumps of the slope or its derivatives inside zones"
        if isinstance(density, sie.Pierced):
            plan["holes"].used, plan["holes"].reason = True, "narrow gaps between zones"
            plan["holes"].detail = f"{len(density.cut.holes)} in {len(density.cut.wide)} wide zones"
        else:
            plan["holes"].reason = "no narrow gaps between zones"
        plan.counts.update(
            zones=len(zones), own_modes=int(sizes.own.sum()), coupled_unknowns=int(found.free.state.solver.size),
            kernel_evaluations=sizes.kernel_evaluations, profile_evaluations=sizes.profile_evaluations, solves=sizes.solves,
        )
        solution = Solution(
            self.scene, self._si(zones), replace(found.fields, problem=found.fields.problem), error, found.certificate, plan,
            found.free.trace,
        )
        return self._within_tolerance(solution, found.free, "zone", of_positions(found))

    def _tell_iterations(self, iterations: int) -> None:
        if iterations:
            sums = self.plan["fast sums"]
            sums.used, sums.reason = True, "many unknowns: sums by trees, GMRES for the matrix"
            sums.detail = f"{iterations} iterations"

    def _gapped(self, found: Gapped) -> Solution:
        """The solution of a nearly full contact from its gaps."""
        fields, plan = found.fields, self.plan
        sizes = found.free.state.sizes
        plan["zone ends"].reason = "nearly full contact: the gaps are solved for"
        plan["zone ends"].detail = f"{len(found.free.trace)} Newton steps, {len(fields.zones)} gaps"
        plan["symmetry"].used, plan["symmetry"].reason = False, "the gaps are solved for"
        self._tell_iterations(sizes.iterations)
        plan.counts.update(
            zones=len(fields.zones), own_modes=int(sizes.own.sum()),
            coupled_unknowns=int(found.free.state.solver.size), kernel_evaluations=sizes.kernel_evaluations,
            profile_evaluations=sizes.profile_evaluations, solves=sizes.solves,
        )
        error = found.error
        table = self._in_cell(np.asarray(self.problem.units.x(fields.zones)))
        solution = Solution(self.scene, table, fields, error, found.certificate, plan, found.free.trace)
        return self._within_tolerance(solution, found.free, "gap")

    def _too_thin(self, problem: Problem, table: Array, limit: float = _RESOLVED) -> str:
        """Why modes do not show the smooth part of the body's kernel on scaled zones; empty if they do."""
        kernel = problem.kernel
        half = 0.5 * float((table[:, 1] - table[:, 0]).max(initial=0.0))
        if not half > limit * kernel.length:
            return ""
        unit = self.problem.units.length
        return (
            f"the kernel of {self.scene.substrate.name} varies over {kernel.length * unit:.2g} m, 1/{2 * half / kernel.length:.0f} of a "
            "zone's width, more than the modes of a zone show: ask for a larger tolerance, or for narrower zones"
        )

    def _too_thin_of(self, solution: Solution) -> str:
        fields = solution.fields
        return self._too_thin(fields.problem, fields.density.zones.table) if isinstance(fields, ZoneFields) else ""

    def _within_tolerance(self, solution: Solution, free: sie.Free, of: str, positions: float = 0.0) -> Solution:
        if solution.error > self.tol:
            why = limit_of_approach(solution, self.tol) or self._too_thin_of(solution) or limit(free, self.tol, of, positions)
            raise NotConverged(
                f"the stated error {solution.error:.2g} is above the tolerance {self.tol:.2g}{': ' if why else ''}{why}; the best "
                "state is attached",
                solution.trace, solution,
            )
        return solution
