"""Controls that are found by loads: an approach that a grid does not find, and a contact fraction.

Solutions under a load are the sure ones: a bracket on the load (contact.search.strategies.load_search) comes
so near that the zones under the load lead to those of the control itself.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from contact.errors import NotConverged, OutOfRange
from contact.formulation.controls import Control, Load
from contact.formulation.gaps import GapFields
from contact.formulation.problem import Problem
from contact.model.controls import Quantity
from contact.search.context import SolveContext
from contact.search.grid.nested_grids import Proposal
from contact.search.grid.proposals import of_width, placed
from contact.search.grid.scaling import ScaledScene, scaled_scene_about
from contact.search.grid.tilt import known_part
from contact.search.strategies.gaps import OF_GAPS, by_gaps, gaps_beside, tightened_gaps
from contact.search.strategies.load_search import approach, contact_fraction, nearer
from contact.search.topology.failure import Failure
from contact.solution.solution import Solution
from contact.verify.error import SolvedGaps, SolvedZones

# Of a load: near enough for the zones to lead to those of the approach, and to be about them.
NEAR_LOAD = 1e-2
NEARER_LOAD = 1e-5
# Of a load: near enough for the zones to lead to those of a width; where they did not, how much
# nearer before it is tried again.
_NEAR_WIDTH = 5e-3
_MUCH_NEARER = 0.1
# A contact fraction is not told by the load where it is missed by more than this when the bracket
# is closed.
_JUMP = 1e-9
# Of what is in contact, or of what is not: a change by more is searched for by a grid.
_BESIDE = 0.3
# Likewise: a solution farther off is no better a start than a grid.
_FAR = 0.1
# What is left open, of the period, where the gaps are looked for at once.
_LAST_OPEN = 1e-3
# Newton steps and rounds from zones so near; and where a bracket on the load is closed.
_FEW = 12
_FEW_ROUNDS = 5
_CLOSED = 1e-14
# Tolerance of solutions on the way to an approach or a contact fraction; at first, while these are
# far off.
_ON_THE_WAY = 1e-7
_FIRST_ONES = 1e-5


def at_approach(context: SolveContext, nearness: float) -> Solution:
    """A solution under a load that has the approach of the scene, to this part of the load."""
    scene, wanted, moment = (
        context.scene,
        context.scene.held(Quantity.APPROACH),
        context.scene.moment or 0.0,
    )
    assert wanted is not None
    known = known_part(scene.profile)
    reach = math.inf if known is None or moment == 0.0 else known[1] if moment > 0 else -known[0]
    if not reach > 0.0:
        raise OutOfRange(f"moment {moment:.6g} N: the whole body lies on the other side of x = 0")
    guess = scene.E_star * (0.3 * abs(wanted) or 1e-3 * (scene.operator.datum or 1.0))
    first = guess if context.warm_start is None else context.warm_start.load
    bounded, largest = known is not None and scene.profile.support is None, -math.inf
    concave = moment == 0.0 and context.operator.is_plain and scene.law.equilibria.unique
    for here, off in nearer(
        _on_the_way(context), approach, wanted, first, abs(moment) / reach, bounded, concave
    ):
        if off <= nearness:
            return here
        largest = max(largest, here.approach or 0.0)
    raise OutOfRange(
        f"no load has the approach {wanted:.6g} m; the largest of those tried was {largest:.6g} m"
    )


def at_level(context: SolveContext) -> SolvedZones:
    """Under the approach of a lone body, from zones of about the right load; of just about it, if
    these do not lead on.
    """
    missed, problem = Failure("no load was tried"), None
    for nearness in (NEAR_LOAD, NEARER_LOAD):
        context = context.with_warm_start(at_approach(context, nearness))
        assert context.warm_start is not None
        scaled = scaled_scene_about(
            context.scene.under("load", context.warm_start.load),
            context.warm_start.tilt or 0.0,
            context.warm_start.zones,
        )
        problem = scaled.problem
        found = context.refine_topology(
            problem, context.control(problem), placed(problem, context.warm_start.zones)
        )
        if isinstance(found, SolvedZones):
            return found
        missed = found
        context.record_failure("zones under a load of about this approach", missed)
    assert problem is not None
    raise context.error(missed, problem)


def by_fraction(context: SolveContext, scaled: ScaledScene) -> SolvedZones | SolvedGaps:
    """A width from a solution under about the load that has it, ever nearer ones until its zones
    lead on.
    """
    problem, control, goal = scaled.problem, scaled.control, context.scene.given_fraction
    assert goal is not None
    if context.warm_start is None or abs(
        (context.warm_start.contact_fraction or 0.0) - goal
    ) > _FAR * min(goal, 1 - goal):
        # What is open of a contact as full as this are tops of R, of which no grid tells the load.
        if 1 - goal < _LAST_OPEN:
            found_by_gaps = by_gaps(context, problem, control, control.value)
            if isinstance(found_by_gaps, SolvedGaps):
                return found_by_gaps
            context.record_failure("gaps", found_by_gaps)
        with context.plan.timed("coarse search"):
            proposal = of_width(scaled, problem, control.value)
        context.plan[
            "coarse search"
        ].detail = f"{proposal.points} points, {len(proposal.zones)} zones proposed"
        first, found = proposal.load, _from_grid(context, problem, control, proposal)
        if not isinstance(found, Failure):
            return found
        context.record_failure("zones of about this width from a grid", found)
    else:
        first = context.warm_start.load
    near_enough, last, off = _NEAR_WIDTH, None, 1.0

    def solved(load: float, near: Solution | None) -> Solution:
        return _to_width(context, load, near, _FIRST_ONES if off > _NEAR_WIDTH else _ON_THE_WAY)

    for here, off_load in nearer(solved, contact_fraction, goal, first, closed=_CLOSED):
        last, fraction = here, contact_fraction(here)[0]
        # Where a little more load brings much more into contact, the width is what tells how near
        # it is.
        off = max(off_load, abs(goal - fraction) / min(goal, 1 - goal))
        if off > near_enough:
            continue
        near_enough = _MUCH_NEARER * off
        found = _from(context, problem, control, here)
        if not isinstance(found, Failure):
            return found
        context.record_failure(f"zones under a load of {here.load:.6g} N/m", found)
        if found.at_border:
            raise context.error(found, problem)
    assert last is not None
    return _under_load_of(context, problem, control, last)


def _from_grid(
    context: SolveContext, problem: Problem, control: Control, proposal: Proposal
) -> SolvedZones | SolvedGaps | Failure:
    """From zones of about the width that a grid has found."""
    if proposal.full or len(proposal.zones) == 0:
        return Failure("the grid has no zones of about this width")
    table = placed(problem, proposal.zones)
    found_by_gaps = by_gaps(context, problem, control, control.value, table)
    if isinstance(found_by_gaps, SolvedGaps):
        return found_by_gaps
    # All zones are widened alike to the wanted width: ends that start as near move by less than the
    # kernel of a thin layer varies over.
    half = np.diff(table) / 2
    table = table + half * [-1.0, 1.0] * (control.value / (2 * half.sum()) - 1.0)
    return context.refine_topology(
        problem,
        control,
        table,
        load_guess=proposal.load / problem.units.load,
        max_steps=_FEW,
        rounds=_FEW_ROUNDS,
    )


def _under_load_of(
    context: SolveContext, problem: Problem, control: Control, near: Solution
) -> SolvedZones | SolvedGaps:
    """The contact under the load that has the width, where the zones of the width itself do not
    settle: right at a birth or a merger.
    """
    assert near.contact_fraction is not None and problem.period is not None
    missed = abs(near.contact_fraction - control.value / problem.period)
    if missed > _JUMP:
        raise NotConverged(
            f"no load that double precision tells from its neighbours has the contact fraction {context.scene.given_fraction:.15g}: at a "
            f"mean pressure of {near.mean_pressure:.15g} Pa it is {near.contact_fraction:.15g}, beside that beyond",
            (),
            near,
        )
    load = Load(near.load / problem.units.load)
    found = _from(context, problem, load, near)
    if isinstance(found, Failure):
        raise context.error(found, problem)
    if isinstance(found, SolvedGaps):
        return replace(found, off=found.off + _CLOSED * load.value / problem.period)
    narrowest = float(np.diff(found.free.density.zones.table, axis=1).min())
    return replace(found, off=missed * problem.period / narrowest)


def _from(
    context: SolveContext, problem: Problem, control: Control, near: Solution
) -> SolvedZones | SolvedGaps | Failure:
    """From the zones, or the gaps, of a solution near by."""
    fields = near.fields
    if not isinstance(fields, GapFields):
        value = near.load / problem.units.load
        return context.refine_topology(
            problem,
            control,
            placed(problem, near.zones),
            load_guess=value,
            max_steps=_FEW,
            rounds=_FEW_ROUNDS,
        )
    with context.plan.timed("zone ends"):
        found = gaps_beside(
            problem, fields, control, OF_GAPS * context.tolerance, abandon_if_far=False
        )
        return found if isinstance(found, Failure) else tightened_gaps(context, found)


def _to_width(context: SolveContext, load: float, near: Solution | None, tol: float) -> Solution:
    """The solution under a load; from a grid where contact is far from that of the solution near
    by.
    """
    if near is not None:
        fraction, rate = contact_fraction(near)
        near = (
            near if abs(rate * (load - near.load)) < _BESIDE * min(fraction, 1 - fraction) else None
        )
    elif context.warm_start is not None and load == context.warm_start.load:
        return context.warm_start
    return _on_the_way(context, tol)(load, near)


def _on_the_way(
    context: SolveContext, tol: float = _ON_THE_WAY
) -> Callable[[float, Solution | None], Solution]:
    """Solutions under loads, each beside another one or that at hand."""

    def solved(load: float, near: Solution | None) -> Solution:
        try:
            return context.solve_scene(
                context.scene.under("load", load), tol, near or context.warm_start, context.progress
            )
        except NotConverged as failure:
            if failure.best is None or not failure.best.error < max(1e3 * _ON_THE_WAY, 10 * tol):
                raise
            return failure.best

    return solved
