"""Routes of adhesive loading paths: how a path begins, its events, and its solutions."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from contact.adhesion import cohesive_branch
from contact.adhesion.cohesive_events import CohesiveEvents
from contact.adhesion.cohesive_fields import fields_of
from contact.adhesion.cohesive_state import CohesiveState
from contact.adhesion.cohesive_zone import CohesiveCurve
from contact.adhesion.curve import ACCURACY, Closed, Curve, State
from contact.adhesion.edge_branch import advancing, branch_scaling, curve_of
from contact.adhesion.events import Events, Jump, PathState
from contact.adhesion.inner_contact import ContactLost
from contact.adhesion.loading_path import LoadingPath
from contact.adhesion.pull_off import pull_off
from contact.adhesion.separated_fields import SeparatedFields
from contact.errors import NotConverged, OutOfRange
from contact.formulation.controls import Approach
from contact.formulation.fields import ZoneFields
from contact.formulation.full_contact import FullLimit
from contact.model.scene import Scene
from contact.search.context import SolveContext
from contact.search.grid.scaling import ScaledScene
from contact.search.refine import refined
from contact.search.strategies.guesses import Outcome
from contact.search.topology.failure import Failure
from contact.solution import assemble
from sie import Array


@dataclass(frozen=True)
class PathRoute:
    """Those functions of a loading path that differ between the laws of adhesion.

    events: the events of the path. started: returns the path state at a control value not below
    first touch. fields: returns the fields of an equilibrium. outcome: returns the solution at a
    state of the path. separation: returns the state at which contact under a fixed approach is
    lost, or None if it is not found.
    """

    events: Events
    started: Callable[[Scene, float], PathState]
    fields: Callable[[State], ZoneFields | SeparatedFields]
    outcome: Callable[[SolveContext, State], Outcome]
    separation: Callable[[State], State | None]


def route_of(context: SolveContext) -> PathRoute:
    """The `PathRoute` for the law of adhesion of the scene."""
    return _by_cohesive_zone(context) if context.scene.law.tension else _by_edge_intensity(context)


def _by_edge_intensity(context: SolveContext) -> PathRoute:
    scaled, curve = curve_of(context)

    def started(scene: Scene, value: float) -> PathState:
        try:
            return PathState(
                value, curve.settled(advancing(replace(context, scene=scene), scaled, curve, value))
            )
        except Closed:
            return PathState(value, closed=True)

    def outcome(context: SolveContext, here: State) -> Outcome:
        found = context.refine_topology(
            curve.problem, replace(curve.control, value=here.value), here.table, abandon_if_far=True
        )
        if isinstance(found, Failure):
            raise context.error(found, curve.problem)
        return refined(context, found)

    def separation(here: State) -> State | None:
        held = Curve(curve.problem, Approach(-here.level))
        try:
            return pull_off(held, held.at(here.table, -here.level))
        except NotConverged:
            return None

    return PathRoute(Events(curve, scaled.cell), started, curve.fields, outcome, separation)


def _by_cohesive_zone(context: SolveContext) -> PathRoute:
    scene, law = context.scene, context.scene.law
    scaled = branch_scaling(context, math.sqrt(scene.E_star * law.tension * law.reach / math.pi))
    problem = scaled.problem
    curve = CohesiveCurve(problem, context.control(problem), may_separate=True)
    events = _CohesivePath(context, scaled, curve).events

    def started(scene: Scene, value: float) -> PathState:
        try:
            return PathState(
                value,
                curve.settled(
                    cohesive_branch.advancing(replace(context, scene=scene), scaled, curve, value)
                ),
            )
        except Closed:
            return events.under_all(value)

    def outcome(context: SolveContext, here: State) -> Outcome:
        assert isinstance(here, CohesiveState)
        if not here.everywhere:
            return cohesive_branch.solved(context, curve, here)
        if context.spring_compliance is not None:
            context = replace(
                context,
                scene=context.scene.under("load", here.load * problem.units.load),
                spring_compliance=None,
            )
        return cohesive_branch.everywhere(context, problem)

    def separation(here: State) -> State | None:
        held = replace(context, scene=scene.under("approach", 0.0), spring_compliance=None)
        return _CohesivePath(
            held, scaled, CohesiveCurve(problem, Approach(-here.level), may_separate=True)
        ).separation(here)

    return PathRoute(events, started, lambda here: fields_of(curve, here), outcome, separation)


@dataclass(frozen=True)
class _CohesivePath:
    context: SolveContext
    scaled: ScaledScene
    curve: CohesiveCurve

    @property
    def events(self) -> CohesiveEvents:
        full, size = self._full
        return CohesiveEvents(
            self.curve,
            self.scaled.cell,
            lambda: cohesive_branch.advancing(self._at(0.0), self.scaled, self.curve, 0.0),
            self._zones_under_tension,
            full,
            size,
        )

    def _at(self, value: float) -> SolveContext:
        """The context at a value of the load or the approach, whichever is the control."""
        held = self.curve.control
        name = "approach" if held.load is None else "load"
        return replace(
            self.context,
            scene=self.context.scene.under(name, value * held.unit(self.scaled.problem.units)),
            spring_compliance=None,
        )

    def _zones_under_tension(self, value: float) -> Array:
        """Zones of contact under tension on the whole period, or a first guess of these zones."""
        problem, known = self.scaled.problem, self.curve.known
        context = self._at(value)
        if self.curve.control.compliance:
            if known and len(known[-1].zones) and value < self._full[0] - self._full[1]:
                return known[-1].zones
            # With a spring, the load follows only from the zones. So the first guess is the zones
            # under a load just below that of full contact.
            scene = context.scene
            assert scene.period is not None and scene.law.bare is not None
            full = FullLimit(scene.profile, scene.E_star, context.operator, scene.law.bare).pressure
            context = replace(
                context,
                scene=scene.under("load", (full * (1 - 1e-6) - scene.law.tension) * scene.period),
            )
        try:
            zones = cohesive_branch.under_all(context, problem)
        except (ContactLost, OutOfRange):
            return np.zeros((0, 2))
        return np.zeros((0, 2)) if zones is None else zones

    @cached_property
    def _full(self) -> tuple[float, float]:
        """(control value at which all gaps close under tension everywhere, scale of this value).

        Both are in the scaled units of the control. The result is (inf, 0) if no such value exists.
        """
        scene, held, units = self.context.scene, self.curve.control, self.scaled.problem.units
        period, law = scene.period, scene.law
        if period is None:
            return math.inf, 0.0
        assert law.bare is not None
        full = FullLimit(scene.profile, scene.E_star, self.context.operator, law.bare).pressure
        if not math.isfinite(full):
            return math.inf, 0.0
        load = (full - law.tension) * period
        if held.load is not None:
            return load / units.load, full * period / units.load
        base = 2 * (self.context.operator.compression or 0.0) / scene.E_star / period
        spring = (held.compliance or 0.0) * units.height / units.load
        if base + spring == 0.0:
            return math.inf, 0.0
        mean = assemble.mean_height(scene)
        return (mean + (base + spring) * load) / units.height, mean / units.height

    def separation(self, here: State) -> State | None:
        """The state at which the surfaces separate as the approach falls.

        None if the path could not be followed to that state.
        """
        value = -here.level
        if isinstance(here, CohesiveState) and here.everywhere:
            start: State = self.curve.under_all(
                value, here.zones[np.diff(here.zones, axis=1)[:, 0] > 0.0]
            )
        else:
            zones = here.contact[np.diff(here.contact, axis=1)[:, 0] > 0.0]
            start = self.curve.from_zones(here.table, value, zones)
        # `far` is an approach so low that the surfaces are surely apart. The way from `value` to
        # `far` is the sum of the tension's reach and |`value`|, divided by the small number
        # `resting_step`.
        far = value - (self.curve.reach + abs(value)) / ACCURACY.resting_step
        try:
            for found in LoadingPath(self.events).to(PathState(value, start), far):
                if isinstance(found, Jump) and found.kind == "pull-off":
                    return found.before.point
        except NotConverged:
            return None
        return None
