"""Contacts on strips of tension narrower than their zones, led to by a law without range.

Under a little less work of adhesion whose attraction has no range a contact lies within the one
that is looked for, under a little more it holds it. At each tip of its zones the strip has a closed
form, and all its ends are driven one way from there.
"""

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace

import numpy as np

from contact.adhesion import gradient_flow
from contact.adhesion import pull_off as apart
from contact.adhesion.cohesive_zone import Cohesive, CohesivePoint
from contact.adhesion.curve import Closed, Equilibria, NoState, Point
from contact.adhesion.energy_descent import relaxed
from contact.adhesion.inner_contact import Lost
from contact.adhesion.intervals import joined
from contact.adhesion.nucleation import grown
from contact.errors import NotConverged
from sie import Array

# Parts of the work of adhesion that it is made smaller or larger by; Newton's steps for the width
# of a strip, and to where ends are driven by as much; by what they are driven that are not far from
# rest.
_MORE = (0.02, 0.2)
_STEPS_OF_STRIP = 30
_STEPS_TO_MARGIN = 5
_NOT_FAR = 0.25
# Newton's step of tips over their zones that strips are put about: what is left of it is put into
# that.
_TIPS_AT_REST = 2e-3


def near_advanced(curve: Cohesive, zones: Array, value: float) -> CohesivePoint | None:
    """A state not far within the least equilibrium that holds these zones, of which all ends are
    driven outward, where tension acts on strips narrower than zones: from those that a little less
    adhesion without range makes of them; None where that does not tell.
    """
    for margin in _MORE:
        short = _without_range(curve, zones, 1.0 - margin)
        if short is None:
            return None
        with suppress(Closed, NoState, Lost, NotConverged):
            found = _with_range(curve, short, grown(short, zones, value, _TIPS_AT_REST), margin)
            if found is not None:
                return found
    return None


def _without_range(curve: Cohesive, zones: Array, share: float) -> Equilibria | None:
    """The equilibria under so much of the adhesion without range; None where strips are no narrower
    than zones, or there is no such law.
    """
    if curve.problem.profile.support is not None or curve.strip > float(
        np.median(np.diff(zones, axis=1))
    ):
        return None
    law = curve.problem.law.without_range(share)
    return None if law is None else Equilibria(replace(curve.problem, law=law), curve.held)


def _with_range(
    curve: Cohesive, short: Equilibria, tips: Point, margin: float
) -> CohesivePoint | None:
    """The state with range about an equilibrium under so much less adhesion without, of which all
    ends are driven outward by about the margin (inward, where it is negative); None where they are
    not.

    Beside a tip, p = A sqrt(v) - K/sqrt(v) at a depth v, contact ends farther in, where K is what a
    strip of width d takes, 2 s sqrt(d)/pi, and at the strip's end the gap is the reach h, 4 s d/pi
    + 4 A d^(3/2)/3 = E* h.
    """
    wide = (1.0 - margin) * curve.strip
    by_slope = (
        np.pi
        / (3 * curve.stress)
        * np.maximum(
            np.concatenate(short.fields(tips, gradient_flow.ROUGH).density.edge_slopes), 0.0
        )
    )
    d = np.full(len(by_slope), wide)
    for _ in range(_STEPS_OF_STRIP):
        d -= (d * (1 + by_slope * np.sqrt(d)) - wide) / (1 + 1.5 * by_slope * np.sqrt(d))
    # K over that of the tip is one less what drives an end.
    inward: Array = np.asarray(
        np.linalg.solve(-tips.rates, 1 - np.sqrt(d / wide) - tips.residual), dtype=np.float64
    )
    zones, table = tips.moved(-inward), tips.moved(d - inward)
    joins = curve.gaps(table) <= 0.0
    if joins.all() or np.any(zones[:, 1] <= zones[:, 0]):
        return None
    here = curve.from_zones(
        joined(table, joins, [], curve.problem.round), tips.value, zones, gradient_flow.ROUGH
    )
    for _ in range(_STEPS_TO_MARGIN):
        driven = here.residual * math.copysign(1.0, margin)
        if driven.min() > 0.0 and driven.max() < _NOT_FAR:
            return here
        if here.growth >= 0.0:
            break
        inward, outward = gradient_flow.inward_and_outward(curve, here)
        step = np.linalg.solve(-here.rates, here.residual - margin)
        here = curve.at(
            here.moved(np.clip(step, -inward, outward)), tips.value, gradient_flow.ROUGH
        )
    return None


def about_to_part(
    curve: Cohesive, here: Point, recede: Callable[[Cohesive, Array, float], CohesivePoint | None]
) -> CohesivePoint | None:
    """The equilibrium that this one has come to, by what recedes, under a control a little above
    the least at which there is any with a little more adhesion without range; None where that does
    not tell, or where strips are no narrower than zones.
    """
    short = _without_range(curve, here.contact, 1.0 + _MORE[0])
    if short is None:
        return None
    passed: list[Point] = []

    def recede_on(under: Equilibria, table: Array, value: float) -> Point | None:
        rest = gradient_flow.receded(under, table, value)
        if rest is not None:
            passed.append(rest)
        return rest

    with suppress(Closed, NoState, NotConverged):
        # A little more of it widens the contact.
        first = relaxed(short, here.table, here.value)
        if first is None:
            return None
        passed.append(first)
        last = apart.near_the_last(short, first, recede_on)
        for value in apart.above(last.value, here.value):
            # Under a load what is left does not depend on the way: on from the last that was passed
            # above it.
            above = min((one for one in passed if one.value >= value), key=lambda one: one.value)
            tips = gradient_flow.receded(short, above.table, value)
            start = None if tips is None else _with_range(curve, short, tips, -_MORE[0])
            rest = None if start is None else recede(curve, start.table, value)
            if rest is not None:
                return rest
    return None
