"""First guesses from a law without range (JKR), for tension on strips narrower than zones.

Under a law without range, the contact for a little less work of adhesion lies inside the contact
that is searched for, and the contact for a little more work contains it. From either of these
contacts a state with tension is built: at each tip (end of a zone) a strip of tension is added,
whose width has a closed form. The ends of all intervals of this state are driven the same way,
towards the contact that is searched for.
"""

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace

import numpy as np

from contact.adhesion import gradient_flow
from contact.adhesion import pull_off as common_pull_off
from contact.adhesion.cohesive_state import CohesiveState
from contact.adhesion.cohesive_zone import CohesiveCurve
from contact.adhesion.curve import ACCURACY, Closed, Curve, NoState, State
from contact.adhesion.energy_descent import relaxed
from contact.adhesion.inner_contact import ContactLost
from contact.adhesion.intervals import joined
from contact.adhesion.nucleation import grown
from contact.adhesion.options import LIMITS, MOVES
from contact.errors import NotConverged
from sie import Array


def before_advanced(curve: CohesiveCurve, zones: Array, value: float) -> CohesiveState | None:
    """A state whose zones are slightly narrower than those of a certain equilibrium.
    That equilibrium is the smallest one whose zones contain the given `zones`.

    All ends of the state are driven outward. The state is built around the zones of a contact under
    a law without range (JKR), whose work of adhesion is a little smaller. None if strips are wider
    than zones, or if no such state is found.
    """
    for margin in MOVES.margins:
        short = _curve_without_range(curve, zones, 1.0 - margin)
        if short is None:
            return None
        with suppress(Closed, NoState, ContactLost, NotConverged):
            found = _with_range(curve, short, grown(short, zones, value, ACCURACY.coarse), margin)
            if found is not None:
                return found
    return None


def _curve_without_range(curve: CohesiveCurve, zones: Array, share: float) -> Curve | None:
    """The equilibria under a law without range (JKR), with `share` times the work of adhesion.

    None if the strip of tension is wider than the median zone, if the profile has a `support`, or
    if the problem's law has no such limit.
    """
    if curve.problem.profile.support is not None or curve.strip > float(
        np.median(np.diff(zones, axis=1))
    ):
        return None
    law = curve.problem.law.without_range(share)
    return None if law is None else Curve(replace(curve.problem, law=law), curve.control)


def _with_range(
    curve: CohesiveCurve, short: Curve, tips: State, margin: float
) -> CohesiveState | None:
    """A state under the cohesive law, built from an equilibrium of a law without range.

    All ends of the state are driven the same way. margin: fraction of the work of adhesion that the
    law without range lacks; negative if it has more work. None if some ends of the state are driven
    outward and others inward.

    At the distance v from a tip (end of a zone of `tips`) the pressure is A sqrt(v) - K/sqrt(v). A
    strip of width d under the tension s replaces the term K/sqrt(v), where K = 2 s sqrt(d)/pi. The
    width d follows from the condition that the gap at the end of the strip is the reach h:
    4 s d/pi + 4 A d^(3/2)/3 = E* h.
    """
    wide = (1.0 - margin) * curve.strip
    by_slope = (
        np.pi
        / (3 * curve.stress)
        * np.maximum(np.concatenate(short.fields(tips, ACCURACY.rough).density.edge_slopes), 0.0)
    )
    d = np.full(len(by_slope), wide)
    for _ in range(LIMITS.max_iterations):
        d -= (d * (1 + by_slope * np.sqrt(d)) - wide) / (1 + 1.5 * by_slope * np.sqrt(d))
    # The strip of tension next to an end of a zone takes up the fraction sqrt(d / wide) of the edge
    # intensity K. So the ends of the zones of `tips` move inward until their residual is the
    # remaining fraction, 1 - sqrt(d / wide).
    inward: Array = np.asarray(
        np.linalg.solve(-tips.rates, 1 - np.sqrt(d / wide) - tips.residual), dtype=np.float64
    )
    zones, table = tips.moved(-inward), tips.moved(d - inward)
    joins = curve.gaps(table) <= 0.0
    if joins.all() or np.any(zones[:, 1] <= zones[:, 0]):
        return None
    here = curve.from_zones(
        joined(table, joins, [], curve.problem.round), tips.value, zones, ACCURACY.rough
    )
    for _ in range(ACCURACY.max_newton_steps):
        driven = here.residual * math.copysign(1.0, margin)
        if driven.min() > 0.0 and driven.max() < MOVES.hard_drive:
            return here
        if here.growth >= 0.0:
            break
        inward, outward = gradient_flow.inward_and_outward(curve, here)
        step = np.linalg.solve(-here.rates, here.residual - margin)
        here = curve.at(here.moved(np.clip(step, -inward, outward)), tips.value, ACCURACY.rough)
    return None


def near_pull_off(
    curve: CohesiveCurve,
    here: State,
    recede: Callable[[CohesiveCurve, Array, float], CohesiveState | None],
) -> CohesiveState | None:
    """An equilibrium near pull-off, found from contacts under a law without range (JKR).

    The law without range has a larger work of adhesion. recede: moves ends that are driven inward
    to an equilibrium. None if no equilibrium is found in this way.
    """
    short = _curve_without_range(curve, here.contact, 1.0 + MOVES.margins[0])
    if short is None:
        return None
    passed: list[State] = []

    def recede_on(under: Curve, table: Array, value: float) -> State | None:
        rest = gradient_flow.receded(under, table, value)
        if rest is not None:
            passed.append(rest)
        return rest

    with suppress(Closed, NoState, NotConverged):
        # The search must start from zones that contain the contact. Zones under a larger work of
        # adhesion are wider, so that they contain the contact.
        first = relaxed(short, here.table, here.value)
        if first is None:
            return None
        passed.append(first)
        last = common_pull_off.near_the_last(short, first, recede_on)
        for value in common_pull_off.controls_above(last.value, here.value):
            # `above` is the state in `passed` with the least control that is not below `value`. The
            # zones of this state recede to an equilibrium at `value`.
            above = min((one for one in passed if one.value >= value), key=lambda one: one.value)
            tips = gradient_flow.receded(short, above.table, value)
            start = None if tips is None else _with_range(curve, short, tips, -MOVES.margins[0])
            rest = None if start is None else recede(curve, start.table, value)
            if rest is not None:
                return rest
    return None
