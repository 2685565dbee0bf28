"""The arc-length follower: follows a curve of equilibria from one of them, round turning points.

At a turning point the control has a maximum or minimum along the curve. There the derivatives dr/ds
of the residuals r with respect to the interval ends s have a zero eigenvalue.

The curve has a kink where the end of an interval reaches a sharp corner of the profile, or where an
end pinned at a corner is no longer driven outward. A step ends there, and the next step begins with
that end pinned, or free. If the state with the free end is unstable, the end jumps off the corner,
and the curve ends.
"""

from collections.abc import Iterator

import numpy as np

from contact.adhesion.arc_step import Step, corner_within, to_change, to_corner
from contact.adhesion.corrector import along
from contact.adhesion.curve import ACCURACY, Curve, State
from contact.adhesion.curve_point import ARC_OPTIONS, CurvePoint, alike, begun, onward
from contact.adhesion.options import LIMITS, MOVES
from contact.errors import NotConverged
from sie import Array


def steps(curve: Curve, here: State, sense: float, tight: bool = True) -> Iterator[Step]:
    """Generate the steps along the curve of equilibria that starts from the equilibrium `here`.

    sense: 1 if the control rises along the curve at `here`, -1 if it falls. tight: whether the
    states at the ends of the steps are solved to full accuracy.
    """
    place, length, short_steps = _point_at(curve, here, sense), MOVES.small_part, 0
    why = "the curve of equilibria could not be followed further"
    unstable: tuple[CurvePoint, float] | None = None
    vanishing = False
    for _ in range(LIMITS.max_steps):
        step = _tried(curve, place, length, tight)
        may_lose = vanishing and length < 1e2 * ACCURACY.resting_step
        if step is None or not (
            _keeps(place, step.end) or (may_lose and _has_lost(place, step.end))
        ):
            if step is not None and place.at.growth < 0.0 <= step.end.at.growth:
                unstable = place, length
                if length < ACCURACY.resting_step and not vanishing:
                    break
            short = place.vanishes(curve)
            vanishing = vanishing or short < length
            part = (1.0 - MOVES.small_part) * short
            length = part if short < length else MOVES.least_part * length
            if length < ACCURACY.rough:
                break
            continue
        step = to_change(step)
        if step.turns and not step.turns_once:
            length *= MOVES.least_part
            continue
        yield step
        if step.lets_go:
            why = (
                "the curve of equilibria ends: the end of a zone or of an interval of tension has "
                "left its sharp corner"
            )
            break
        # Several steps of almost zero length in a row end the curve. Otherwise an end at a sharp
        # corner could be pinned and freed again and again.
        short_steps = short_steps + 1 if step.length < ACCURACY.rough else 0
        if short_steps > ARC_OPTIONS.interpolation_nodes:
            why = (
                "several steps along the curve of equilibria had almost zero length: ends at "
                "sharp corners may be held and freed again and again"
            )
            break
        place = step.end if step.after is None else _point_at(curve, step.after, step.end.rises)
        length = _next_length(step, length)
        if vanishing:
            short = place.vanishes(curve)
            part = 2.0 if len(place.at.contact) > 1 else 1.0 - MOVES.small_part
            length, vanishing = min(length, part * short), short < ARC_OPTIONS.longest_step
            if length < ACCURACY.rough:
                break
    if unstable is not None:
        raise SymmetryLost(curve, *unstable)
    raise NotConverged(why)


def _tried(curve: Curve, place: CurvePoint, length: float, tight: bool) -> Step | None:
    """A step of arc length `length`, or a shorter one to the first sharp corner that is reached.

    None if Newton's method does not find the equilibrium after the step.
    """
    reached = corner_within(curve, place, length)
    if reached is None:
        ahead = along(curve, place, length, tight)
    else:
        ahead = to_corner(curve, place, reached)
    if ahead is None:
        return None
    end = onward(curve, place, ahead)
    return Step(curve, place, length if reached is None else place.length(end.at), end)


def _next_length(step: Step, length: float) -> float:
    """Length of the step that follows `step`.

    During this new step, the tangent of the curve should turn by half of the largest allowed angle.
    length: the length with which `step` was tried.
    """
    aimed = 0.5 * ARC_OPTIONS.longest_step
    growth = aimed / max(step.turned, aimed * MOVES.least_part)
    return min(growth * length, ARC_OPTIONS.longest_step)


class SymmetryLost(NotConverged):
    """The curve becomes unstable without a turning point, because a symmetry breaks.

    at: the last stable equilibrium, set by `located` only.
    """

    at: State

    def __init__(self, curve: Curve, place: CurvePoint, length: float, where: str = "") -> None:
        super().__init__(
            f"the contact becomes unstable{where}: it loses its symmetry, and the scene does not "
            "determine in which of several ways. Make the profile slightly asymmetric, for "
            "example one of two equal tips slightly higher"
        )
        self.within = curve, place, length

    def located(self) -> "SymmetryLost":
        """This error, with the load and the approach at the loss of symmetry in its message."""
        curve, place, length = self.within
        low, high, at = 0.0, length, place.at
        for _ in range(LIMITS.max_iterations):
            middle = 0.5 * (low + high)
            found = along(curve, place, middle)
            if found is None:
                break
            if middle in (low, high):
                break
            low, high, at = (middle, high, found) if found.growth < 0.0 else (low, middle, at)
        units, where = (
            curve.problem.units,
            f" at load {at.load * curve.problem.units.load:.10g} N/m",
        )
        if curve.problem.operator.has_approach:
            where += f", approach {-at.level * units.height:.10g} m"
        lost = SymmetryLost(*self.within, where)
        lost.at = at
        return lost


def pushed_off(here: State) -> Array:
    """The intervals of an unstable equilibrium, displaced along its most unstable eigenvector.
    The eigenvector holds displacements of the ends of the intervals.
    """
    growth, motions = here.motions(np.arange(len(here.residual)))
    motion = motions[:, int(np.argmax(growth))].real
    return here.moved(np.asarray(MOVES.short_move * motion / np.abs(motion / here.widths).max()))


def past_turning_point(curve: Curve, turned: State, sense: float) -> Array:
    """The intervals at a turning point, with their ends moved a little along the curve.

    The motion is outward for sense 1, when the control rises, and inward for sense -1.
    """
    move = begun(curve, turned, sense).tangent[:-1] * turned.widths
    return turned.moved(
        np.asarray(
            move
            * (
                sense
                * np.sign(move.sum())
                * MOVES.short_move
                / np.abs(move / curve.room(turned.table)).max()
            )
        )
    )


def _point_at(curve: Curve, here: State, sense: float) -> CurvePoint:
    """The equilibrium `here`, with the tangent of the curve that begins there.
    Raises NotConverged if `here` belongs to a continuous family of equilibria at one control value.
    """
    here.refuse_neutral()
    return begun(curve, here, sense)


def _keeps(before: CurvePoint, ahead: CurvePoint) -> bool:
    """Whether a step has stayed on the same curve of equilibria.

    This holds if the angle between the tangents at both ends is small, and if stability is lost
    only at a turning point.
    """
    kept = before.at.growth >= 0.0 or ahead.at.growth < 0.0 or before.rises * ahead.rises <= 0.0
    return alike(before, ahead) >= np.cos(ARC_OPTIONS.longest_step) and kept


def _has_lost(before: CurvePoint, ahead: CurvePoint) -> bool:
    """Whether a step loses zones without an extremum of the control or a change of stability.

    The width of a vanishing zone is proportional to the square root of the arc length that is left.
    So the curve bends sharply there.
    """
    no_turning_point = before.rises * ahead.rises > 0.0 and before.at.growth * ahead.at.growth > 0.0
    return no_turning_point and len(ahead.at.contact) < len(before.at.contact)
