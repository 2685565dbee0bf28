"""What a path of surfaces that adhere is followed by: where it begins, how it goes on, and the
solution where it stands.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from contact.adhesion import cohesive_branch
from contact.adhesion.cohesive_events import FollowingUnderTension
from contact.adhesion.cohesive_fields import fields_of
from contact.adhesion.cohesive_zone import Cohesive, CohesivePoint
from contact.adhesion.curve import Closed, Equilibria, Point
from contact.adhesion.edge_branch import advancing, frame, to_follow
from contact.adhesion.events import Following, Jump, Standing
from contact.adhesion.inner_contact import Lost
from contact.adhesion.loading_path import History
from contact.adhesion.pull_off import pull_off
from contact.adhesion.separated_fields import LooseFields
from contact.errors import NotConverged, OutOfRange
from contact.formulation.controls import Approach
from contact.formulation.fields import ZoneFields
from contact.formulation.full_contact import FullLimit
from contact.model.scene import Scene
from contact.search.context import SolveContext
from contact.search.grid.scaling import ScaledScene
from contact.search.strategies.guesses import Outcome
from contact.search.topology.failure import Failure
from contact.solution import assemble
from sie import Array

# How far an approach is lowered for surfaces to let go, over its size and the reach of the tension.
_FAR = 1e6


@dataclass(frozen=True)
class Followed:
    """law: what happens on the way; started: the standing at a value of the control, not below
    first touch; fields: of an equilibrium; outcome: what is solved where a path stands; let_go:
    where a contact held by its approach alone comes apart, None where it was not followed so far.
    """

    law: Following
    started: Callable[[Scene, float], Standing]
    fields: Callable[[Point], ZoneFields | LooseFields]
    outcome: Callable[[SolveContext, Point], Outcome]
    let_go: Callable[[Point], Point | None]


def followed(context: SolveContext) -> Followed:
    """By the law of the context's scene, which is under no load or no approach."""
    return _under_tension(context) if context.scene.law.tension else _without_range(context)


def _without_range(context: SolveContext) -> Followed:
    scaled, curve = to_follow(context)

    def started(scene: Scene, value: float) -> Standing:
        try:
            return Standing(
                value, curve.settled(advancing(replace(context, scene=scene), scaled, curve, value))
            )
        except Closed:
            return Standing(value, closed=True)

    def outcome(context: SolveContext, here: Point) -> Outcome:
        found = context.refine_topology(
            curve.problem, replace(curve.held, value=here.value), here.table, abandon_if_far=True
        )
        if isinstance(found, Failure):
            raise context.error(found, curve.problem)
        return found

    def let_go(here: Point) -> Point | None:
        held = Equilibria(curve.problem, Approach(-here.level))
        try:
            return pull_off(held, held.at(here.table, -here.level))
        except NotConverged:
            return None

    return Followed(Following(curve, scaled.cell), started, curve.fields, outcome, let_go)


def _under_tension(context: SolveContext) -> Followed:
    scene, law = context.scene, context.scene.law
    scaled = frame(context, math.sqrt(scene.E_star * law.tension * law.reach / math.pi))
    problem = scaled.problem
    curve = Cohesive(problem, context.control(problem), loose=True)
    following = _Tension(context, scaled, curve).following

    def started(scene: Scene, value: float) -> Standing:
        try:
            return Standing(
                value,
                curve.settled(
                    cohesive_branch.advancing(replace(context, scene=scene), scaled, curve, value)
                ),
            )
        except Closed:
            return following.under_all(value)

    def outcome(context: SolveContext, here: Point) -> Outcome:
        assert isinstance(here, CohesivePoint)
        if not here.everywhere:
            return cohesive_branch.solved(context, curve, here)
        if context.spring_compliance is not None:
            context = replace(
                context,
                scene=context.scene.under("load", here.load * problem.units.load),
                spring_compliance=None,
            )
        return cohesive_branch.everywhere(context, problem)

    def let_go(here: Point) -> Point | None:
        held = replace(context, scene=scene.under("approach", 0.0), spring_compliance=None)
        return _Tension(held, scaled, Cohesive(problem, Approach(-here.level), loose=True)).let_go(
            here
        )

    return Followed(following, started, lambda here: fields_of(curve, here), outcome, let_go)


@dataclass(frozen=True)
class _Tension:
    context: SolveContext
    scaled: ScaledScene
    curve: Cohesive

    @property
    def following(self) -> FollowingUnderTension:
        full, size = self._full
        return FollowingUnderTension(
            self.curve,
            self.scaled.cell,
            lambda: cohesive_branch.advancing(self._at(0.0), self.scaled, self.curve, 0.0),
            self._pressed,
            full,
            size,
        )

    def _at(self, value: float) -> SolveContext:
        """Under a value of a load or of an approach."""
        held = self.curve.held
        name = "approach" if held.load is None else "load"
        return replace(
            self.context,
            scene=self.context.scene.under(name, value * held.unit(self.scaled.problem.units)),
            spring_compliance=None,
        )

    def _pressed(self, value: float) -> Array:
        """Zones under tension in all of a period, or a guess of them."""
        problem, known = self.scaled.problem, self.curve.known
        context = self._at(value)
        if self.curve.held.yields:
            if known and len(known[-1].zones) and value < self._full[0] - self._full[1]:
                return known[-1].zones
            # Short of full contact what the spring holds is about the load there.
            scene = context.scene
            assert scene.period is not None and scene.law.bare is not None
            full = FullLimit(scene.profile, scene.E_star, context.operator, scene.law.bare).pressure
            context = replace(
                context,
                scene=scene.under("load", (full * (1 - 1e-6) - scene.law.tension) * scene.period),
            )
        try:
            zones = cohesive_branch.under_all(context, problem)
        except (Lost, OutOfRange):
            return np.zeros((0, 2))
        return np.zeros((0, 2)) if zones is None else zones

    @cached_property
    def _full(self) -> tuple[float, float]:
        """(value of the control from which surfaces under tension everywhere are closed, what such
        values are counted in).
        """
        scene, held, units = self.context.scene, self.curve.held, self.scaled.problem.units
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
        give = (held.yields or 0.0) * units.height / units.load
        if base + give == 0.0:
            return math.inf, 0.0
        mean = assemble.mean_height(scene)
        return (mean + (base + give) * load) / units.height, mean / units.height

    def let_go(self, here: Point) -> Point | None:
        """Where the surfaces let go as the approach falls from an equilibrium; None where that was
        not followed so far.
        """
        value = -here.level
        if isinstance(here, CohesivePoint) and here.everywhere:
            start: Point = self.curve.under_all(
                value, here.zones[np.diff(here.zones, axis=1)[:, 0] > 0.0]
            )
        else:
            zones = here.contact[np.diff(here.contact, axis=1)[:, 0] > 0.0]
            start = self.curve.from_zones(here.table, value, zones)
        far = value - _FAR * (self.curve.reach + abs(value))
        try:
            for found in History(self.following).to(Standing(value, start), far):
                if isinstance(found, Jump) and found.kind == "pull-off":
                    return found.before.point
        except NotConverged:
            return None
        return None
