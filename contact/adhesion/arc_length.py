"""The arc-length follower: from an equilibrium along its curve, round turning points.

At a turning point J = dr/ds has a zero eigenvalue and the control has an extreme along the arc.
Motions of ends are in units of the widths of the zones. The unit of the control is the change that
moves some end by the width of its zone. So one unit tangent contains both.

Where an end reaches a sharp corner, or a pinned end is no longer driven, the curve has a kink. A
step ends there, and the next one begins with that end pinned, or free. If it is free but
unstable, it jumps off the corner, and the curve ends.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from contact.adhesion.curve import ACCURACY, Curve, NoState, State
from contact.adhesion.options import LIMITS, MOVES
from contact.errors import NotConverged
from contact.formulation.roots import smooth_root
from contact.formulation.tables import outward
from sie import Array, record


@dataclass(frozen=True)
class ArcOptions:
    """Options of the steps along a curve of equilibria; arc lengths are in units of zone widths."""

    # Upper bound of three quantities of a step: its length in zone widths, the angle [rad] between
    # the curve's tangents at both ends of the step, and the deviation of the predictor from the
    # tangent, divided by the length.
    longest_step: float = 0.5
    # Largest number of known equilibria from which `Step._about` interpolates. It is also the
    # largest number of times that `Step.at`, after failed solves, halves the distance to a known
    # equilibrium.
    interpolation_nodes: int = 3


ARC_OPTIONS = ArcOptions()


@record
class CurvePoint:
    """An equilibrium on a curve of equilibria, with the tangent of the curve there.

    scales: units of the motions of the ends and of the control (2n + 1,). tangent: unit vector
    (2n + 1,). curvature: coefficients of the square and the cube of the length in the
    deviation of the curve from the tangent (2, 2n + 1).
    """

    at: State
    scales: Array
    tangent: Array
    curvature: Array

    def ahead(self, length: float) -> Array:
        """Predicted changes of the 2n ends and the control (2n + 1,), at the arc length `length`.
        The changes are divided by `scales`, the units of ends and control.
        """
        deviation = length**2 * self.curvature[0] + length**3 * self.curvature[1]
        return np.asarray(
            length * self.tangent
            + (
                deviation
                if np.abs(deviation).max() <= ARC_OPTIONS.longest_step * abs(length)
                else 0.0
            )
        )

    @property
    def rises(self) -> float:
        """Derivative of the scaled control by the arc length; positive if the control rises."""
        return float(self.tangent[-1])

    def moved(self, to: State) -> Array:
        """Changes of ends and control (2n + 1,) from this equilibrium to the state `to`.
        They are divided by `scales`, the units of ends and control.
        """
        return np.append(outward(self.at.table, to.table), to.value - self.at.value) / self.scales

    def length(self, to: State) -> float:
        """Distance of the equilibrium `to` from this curve point, along the tangent."""
        return float(self.tangent @ self.moved(to))


@record
class Step:
    """A step along the curve of equilibria, from one equilibrium to another equilibrium.

    after: the equilibrium at its end with other ends pinned, from which the next step begins;
    None if the same ends are pinned. known: the equilibria inside the step by their length, and
    whether they were solved to full accuracy.
    """

    curve: Curve
    start: CurvePoint
    length: float
    end: CurvePoint
    after: State | None = None
    known: dict[float, tuple[State, bool]] = field(default_factory=dict)

    def at(
        self, length: float, tight: bool = True, halvings: int = ARC_OPTIONS.interpolation_nodes
    ) -> State:
        """The equilibrium at the arc length `length` from the start of the step.

        If Newton's method fails, the equilibrium half way to a known one is found first.
        """
        for place, (point, tightly) in self.known.items():
            if abs(place - length) <= ACCURACY.neutral * length and tightly >= tight:
                return point
        found = _corrected(self.curve, self.start, self._about(length), self.start.tangent, tight)
        if found is None:
            if halvings == 0:
                raise NotConverged("an equilibrium on the way along a curve was lost")
            self.at(
                0.5
                * (length + min((0.0, self.length, *self.known), key=lambda k: abs(k - length))),
                tight,
                halvings - 1,
            )
            return self.at(length, tight, halvings - 1)
        self.known[length] = found, tight
        return found

    def _about(self, length: float) -> Array:
        """First guess of the changes of ends and control at the arc length `length`.
        It is interpolated between known equilibria of the step. The changes are divided by
        `start.scales`.

        A cubic with the tangents at both ends of the step is corrected to pass through these
        equilibria.
        """
        nodes: list[float] = []
        for node in sorted(self.known, key=lambda k: abs(k - length)):
            if len(nodes) < ARC_OPTIONS.interpolation_nodes and min(
                abs(node - one) for one in (0.0, self.length, *nodes)
            ) > MOVES.small_part * abs(node - length):
                nodes.append(node)
        deviation = [
            (self.start.moved(self.known[node][0]) - self._cubic(node))
            / (node * (self.length - node)) ** 2
            for node in nodes
        ]
        for level in range(1, len(nodes)):
            for i in range(len(nodes) - level):
                here, there = nodes[i], nodes[i + level]
                deviation[i] = (
                    (length - there) * deviation[i] + (here - length) * deviation[i + 1]
                ) / (here - there)
        return self._cubic(length) + (
            deviation[0] * (length * (self.length - length)) ** 2 if nodes else 0.0
        )

    def _cubic(self, length: float) -> Array:
        """Changes of ends and control at the arc length `length`, by cubic interpolation.
        The cubic has the curve's positions and tangents at both ends of the step. The changes are
        divided by `start.scales`.
        """
        square, cube = self._leaves
        return np.asarray(length * self.start.tangent + length**2 * square + length**3 * cube)

    @cached_property
    def _leaves(self) -> Array:
        return _leaving(
            self.start.tangent,
            self.start.moved(self.end.at),
            self.end.tangent * (self.end.scales / self.start.scales),
        )

    @property
    def lets_go(self) -> bool:
        """Whether the curve stops after this step, as ends of intervals jump off sharp corners."""
        return self.after is not None and self.after.growth > ACCURACY.neutral

    @property
    def turned(self) -> float:
        """Angle [rad] between the tangents at the two ends of the step."""
        return float(np.arccos(np.clip(_alike(self.start, self.end), -1.0, 1.0)))

    @property
    def turns(self) -> bool:
        """Whether the control has a maximum or minimum in the step."""
        return self.start.rises * self.end.rises <= 0.0

    @property
    def turns_once(self) -> bool:
        """Whether the control has exactly one extremum in the step.

        At a single extremum the growth rate is zero. If the growth rate found is not zero, the step
        has several extrema and is too long.
        """
        try:
            growth = self.at(self.turning(False), False).growth
        except NotConverged:
            return False
        return abs(growth) < MOVES.small_part * max(
            abs(self.start.at.growth), abs(self.end.at.growth)
        )

    def turning(self, tight: bool = True) -> float:
        """Arc length, from the start of the step, at which the control has its extremum."""
        accuracy = ACCURACY.neutral if tight else ACCURACY.coarse
        return self.where(
            self._rising, self.start.rises, self._rising(self.end.at), None, accuracy, tight
        )

    def _rising(self, at: State) -> float:
        """Derivative of the scaled control along the curve, at the state `at`.
        The length is measured along `start.tangent`, the tangent at the start of the step.
        """
        tangent = _tangent(at, self.start.scales)
        return float(tangent[-1] / (tangent @ self.start.tangent))

    def where(
        self,
        function: Callable[[State], float],
        first: float,
        last: float,
        length: float | None = None,
        accuracy: float = ACCURACY.neutral,
        tight: bool = True,
    ) -> float:
        """Arc length, from the start of the step, at which `function` of the equilibrium is zero.

        first, last: values of the function, of opposite signs, at the start and at `length` (None:
        at the end of the step). accuracy: relative accuracy.
        """
        end = self.length if length is None else length
        known = {
            part: function(at)
            for part, (at, tightly) in self.known.items()
            if 0.0 < part < end and tightly >= tight
        }
        values = {0.0: first, end: last} | known
        return float(smooth_root(lambda part: function(self.at(part, tight)), values, accuracy))

    def arriving(self, value: float) -> State | None:
        """The equilibrium between start and end of the step, under a given value of the control.

        None if one Newton search does not find it, or if the profile has sharp corners.
        """
        start, rises, (bend, twist) = self.start, self.start.rises, self._leaves[:, -1]
        wanted = (value - start.at.value) / start.scales[-1]
        if start.at.corners is not None:
            return None
        roots = np.roots((twist, bend, rises, -wanted))
        roots = roots.real[
            (roots.imag == 0.0)
            & (roots.real >= 0.0)
            & (roots.real <= (1.0 + 10 * ACCURACY.resting_step) * self.length)
        ]
        if len(roots) == 0:
            return None
        guess, normal = self._about(float(roots.min())), np.zeros(len(start.tangent))
        guess[-1], normal[-1] = wanted, 1.0
        found = _corrected(self.curve, start, guess, normal, True)
        return (
            None
            if found is None or not 0.0 <= start.length(found) <= self.length
            else replace(found, value=value)
        )


def steps(curve: Curve, here: State, sense: float, tight: bool = True) -> Iterator[Step]:
    """Generate the steps along the curve of equilibria that starts from the equilibrium `here`.

    At `here`, the control rises (`sense` 1) or falls (-1). tight: whether the states at the ends of
    the steps are solved to full accuracy.
    """
    place, length, why, stands = (
        _stood_by(curve, here, sense),
        MOVES.small_part,
        "the curve of equilibria was not followed on",
        0,
    )
    unstable: tuple[CurvePoint, float] | None = None
    vanishing = False
    for _ in range(LIMITS.max_steps):
        reached = _corner_within(curve, place, length)
        ahead = (
            along(curve, place, length, tight)
            if reached is None
            else _to_corner(curve, place, reached)
        )
        end = None if ahead is None else onward(curve, place, ahead)
        if end is None or not (
            _keeps(place, end)
            or (vanishing and length < 1e2 * ACCURACY.resting_step and _has_lost(place, end))
        ):
            if end is not None and place.at.growth < 0.0 <= end.at.growth:
                unstable = place, length
                if length < ACCURACY.resting_step and not vanishing:
                    break
            short = curve.vanishes(place.at, place.tangent * place.scales)
            length, vanishing = (
                ((1.0 - MOVES.small_part) * short, True)
                if short < length
                else (MOVES.least_part * length, vanishing)
            )
            if length < ACCURACY.rough:
                break
            continue
        step = _to_change(
            Step(curve, place, place.length(end.at) if reached is not None else length, end)
        )
        if step.turns and not step.turns_once:
            length *= MOVES.least_part
            continue
        yield step
        if step.lets_go:
            why = "an end that was held at a sharp corner has let go"
            break
        # Several steps in a row of almost zero length end the curve, because an end at a sharp
        # corner could be pinned and freed again and again.
        stands = stands + 1 if step.length < ACCURACY.rough else 0
        if stands > ARC_OPTIONS.interpolation_nodes:
            why = "ends at sharp corners are neither held nor free"
            break
        place = step.end if step.after is None else _stood_by(curve, step.after, step.end.rises)
        # The length of the next step is chosen such that the tangent of the curve is expected to
        # turn by half of the largest allowed angle.
        aimed = 0.5 * ARC_OPTIONS.longest_step
        growth = aimed / max(step.turned, aimed * MOVES.least_part)
        length = min(growth * length, ARC_OPTIONS.longest_step)
        if vanishing:
            short = curve.vanishes(place.at, place.tangent * place.scales)
            part = 2.0 if len(place.at.contact) > 1 else 1.0 - MOVES.small_part
            length, vanishing = min(length, part * short), short < ARC_OPTIONS.longest_step
            if length < ACCURACY.rough:
                break
    if unstable is not None:
        raise SymmetryLost(curve, *unstable)
    raise NotConverged(why)


class SymmetryLost(NotConverged):
    """The curve becomes unstable without a turning point, because a symmetry breaks.

    at: the last stable equilibrium, set by `located` only.
    """

    at: State

    def __init__(self, curve: Curve, place: CurvePoint, length: float, where: str = "") -> None:
        super().__init__(
            "a contact loses its stability without a turn of its curve, to a motion that breaks a "
            f"symmetry{where}: it is not followed on, "
            "since the scene does not say which way it goes"
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
            f", at load {at.load * curve.problem.units.load:.10g} N/m",
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


def _corner_within(curve: Curve, here: CurvePoint, length: float) -> int | None:
    """Index of the end that first reaches a sharp corner in a step; None if no end does."""
    if here.at.corners is None:
        return None
    moves = (here.tangent * here.scales)[:-1]
    with np.errstate(divide="ignore", invalid="ignore"):
        away = np.where(moves > 0.0, curve.to_corners(here.at.table) / moves, np.inf)
    end = int(np.argmin(away))
    return end if away[end] <= length else None


def _to_corner(curve: Curve, here: CurvePoint, end: int) -> State | None:
    """The equilibrium on the curve at which a given end has reached its sharp corner."""
    distance = curve.to_corners(here.at.table)[end] / here.scales[end]
    return _corrected(
        curve,
        here,
        distance / here.tangent[end] * here.tangent,
        np.eye(len(here.tangent))[end],
        True,
    )


def _to_change(step: Step) -> Step:
    """The step, shortened to the point where a pinned end leaves its sharp corner.
    It is not shortened if no end leaves a corner.

    `after` is set if an end leaves its corner or is pinned at a corner.
    """
    at = step.end.at
    if at.corners is None:
        return step
    pinned = at.pinned
    least = _least_pinned_drive(at)
    if least < 0.0:
        first = max(_least_pinned_drive(step.start.at), 0.0)
        length = step.where(_least_pinned_drive, first, least)
        at = step.at(length)
        step = replace(step, length=length, end=onward(step.curve, step.start, at))
        pinned = pinned & (at.whole.residual > ACCURACY.resting_step)
    else:
        gap = step.curve.to_corners(at.table)
        at_corner = gap < ACCURACY.resting_step * at.widths
        if not np.any(gap[~pinned] == 0.0) or step.length < ACCURACY.rough:
            return step
        pinned = pinned | at_corner
        at = step.curve.at(
            step.curve.within(at.moved(np.where(at_corner, 2 * gap, 0.0))), at.value, pinned=pinned
        )
    return replace(step, after=at.with_pinned(pinned))


def _least_pinned_drive(at: State) -> float:
    """Smallest residual of the ends pinned at sharp corners; inf if no end is pinned."""
    whole = at.whole
    return float(whole.residual[whole.pinned].min(initial=np.inf))


def let_go(step: Step) -> Array:
    """Intervals at the end of a step; ends that leave sharp corners are moved a little inward."""
    assert step.after is not None
    return step.after.moved(
        -MOVES.short_move * step.after.widths * (step.end.at.pinned & ~step.after.pinned)
    )


def beyond(curve: Curve, turned: State, sense: float) -> Array:
    """The intervals at a turning point, with their ends moved a little along the curve.

    The motion is outward for sense 1, when the control rises, and inward for sense -1.
    """
    move = _begun(curve, turned, sense).tangent[:-1] * turned.widths
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


def _stood_by(curve: Curve, here: State, sense: float) -> CurvePoint:
    """The equilibrium `here`, with the tangent of the curve that begins there.
    Raises NotConverged if `here` belongs to a continuous family of equilibria at one control value.
    """
    here.refuse_neutral()
    return _begun(curve, here, sense)


def _begun(curve: Curve, here: State, sense: float) -> CurvePoint:
    """The equilibrium `here` with the curve's tangent; for sense 1 the control rises along it.

    The control falls for sense -1.
    """
    scales = np.append(here.widths, _unit(curve, here))
    tangent = _tangent(here, scales)
    return CurvePoint(
        here,
        scales,
        tangent if tangent[-1] * sense >= 0.0 else -tangent,
        np.zeros((2, len(tangent))),
    )


def onward(curve: Curve, before: CurvePoint, ahead: State) -> CurvePoint:
    """The equilibrium `ahead` with the curve's tangent, which leads away from `before`."""
    # Near a turning point, a small change of the control moves the ends far, so that `_unit`, the
    # unit of the control, tends to 0. From one point of the curve to the next, this unit falls at
    # most by the factor `MOVES.least_part`. Otherwise the tangent would turn too sharply.
    scales = np.append(ahead.widths, max(_unit(curve, ahead), MOVES.least_part * before.scales[-1]))
    tangent, carried = _tangent(ahead, scales), scales / before.scales
    tangent = tangent if before.tangent @ (tangent * carried) >= 0.0 else -tangent
    here = CurvePoint(ahead, scales, tangent, np.zeros((2, len(tangent))))
    moved = here.moved(before.at)
    # `curvature` holds coefficients of the cubic through the points `here` and `before`, which has
    # the curve's tangents at both points.
    return (
        replace(here, curvature=_leaving(tangent, moved, before.tangent / carried))
        if moved.any()
        else here
    )


def _leaving(tangent: Array, moved: Array, there: Array) -> Array:
    """Coefficients (2, 2n + 1) of the square and the cube in a cubic for ends and control.
    The cubic is a function of the length along the tangent of the curve.

    The length is measured from the present point along the unit vector `tangent`. The cubic starts
    there with this tangent. It passes through a second point, displaced by `moved`, with the
    tangent `there`.
    """
    length = float(tangent @ moved)
    if abs(length) < ACCURACY.rough:
        return np.zeros((2, len(tangent)))
    deviation, turned = (
        (moved - length * tangent) / length**2,
        (there / float(tangent @ there) - tangent) / length,
    )
    return np.array((3 * deviation - turned, (turned - 2 * deviation) / length))


def _alike(before: CurvePoint, ahead: CurvePoint) -> float:
    """Cosine of the angle between the tangents at two points of the curve."""
    carried = ahead.tangent * (ahead.scales / before.scales)
    return float(before.tangent @ carried) / float(np.linalg.norm(carried))


def _keeps(before: CurvePoint, ahead: CurvePoint) -> bool:
    """Whether a step has stayed on the same curve of equilibria.

    This holds if the angle between the tangents at both ends is small, and if stability is lost
    only at a turning point.
    """
    kept = before.at.growth >= 0.0 or ahead.at.growth < 0.0 or before.rises * ahead.rises <= 0.0
    return _alike(before, ahead) >= np.cos(ARC_OPTIONS.longest_step) and kept


def _has_lost(before: CurvePoint, ahead: CurvePoint) -> bool:
    """Whether a step loses zones without an extremum of the control or a change of stability.

    The width of a lost zone vanishes like a square root, so that the curve bends sharply there.
    """
    cosine = before.rises * ahead.rises > 0.0 and before.at.growth * ahead.at.growth > 0.0
    return cosine and len(ahead.at.contact) < len(before.at.contact)


def _unit(curve: Curve, at: State) -> float:
    """Unit of the control: the change that moves the fastest end by the width of its zone.

    It is at least the change of the control that changes some residual by 1 (`Curve.unit`).
    """
    whole, least = at.whole, curve.unit(at)
    moves, _, rank, _ = np.linalg.lstsq(at.rates, at.by_value, rcond=None)
    if (
        rank < len(moves)
        and np.abs(at.rates @ moves - at.by_value).max() * least > ACCURACY.resting_step
    ):
        # At a turning point, the ends move while the control does not change. So the unit is set to
        # its lower bound `least`.
        return least
    # The unit of the control is chosen so that one unit changes the residual r of a pinned end by
    # at most max(1, |r|), unless `least` is larger than this unit.
    driven = np.where(
        whole.pinned,
        (whole.by_value - whole.rates @ moves) / np.maximum(1.0, np.abs(whole.residual)),
        0.0,
    )
    most = float(np.maximum(np.abs(moves / at.widths), np.abs(driven)).max())
    return max(least, 1.0 / most) if most > 0.0 else least


def _tangent(at: State, scales: Array) -> Array:
    """Unit tangent (2n + 1,) of the curve of equilibria, with a component for each end.
    The last component belongs to the control. All components are in units of `scales`.
    """
    return np.asarray(np.linalg.svd(np.column_stack((at.rates, at.by_value)) * scales)[2][-1])


def along(curve: Curve, here: CurvePoint, length: float, tight: bool = True) -> State | None:
    """The equilibrium at which the curve crosses a plane at the distance `length` from `here`.
    The plane is normal to the tangent at `here`.

    None if Newton's method does not reach it.
    """
    return _corrected(curve, here, here.ahead(length), here.tangent, tight)


def _corrected(
    curve: Curve, here: CurvePoint, start: Array, normal: Array, tight: bool
) -> State | None:
    """The equilibrium at which the curve crosses the plane through `start` with this normal.

    None if Newton's method does not reach it.
    """
    if curve.formally is curve:
        return _newton(curve, here, start, normal, tight)[0]
    # Newton's method runs on `curve.formally`, which keeps the number of zones of contact and does
    # not test the signs of pressure and gap. These signs are tested once, at the equilibrium
    # `found`.
    found, reached = _newton(curve.formally, here, start, normal, tight, True)
    if found is not None and curve.has_right_zones(found):
        return found
    return None if reached is None else _newton(curve, here, reached, normal, tight)[0]


def _newton(
    curve: Curve, here: CurvePoint, start: Array, normal: Array, tight: bool, formal: bool = False
) -> tuple[State | None, Array | None]:
    """(equilibrium or None if not found, last iterate or None if no retry can succeed).
    The equilibrium is sought by Newton's method in the plane through `start` with the given normal.

    formal: the zones of contact inside the intervals keep their number.
    """
    at_start, length, widths, unit = (
        here.at,
        float(np.linalg.norm(start)),
        here.scales[:-1],
        float(here.scales[-1]),
    )
    how_solved: dict[str, Any] = {} if tight else {"tolerance": ACCURACY.rough}
    if at_start.corners is not None:
        how_solved["pinned"] = at_start.pinned
    before = np.inf
    for k in range(ACCURACY.max_newton_steps):
        table = at_start.moved(start[:-1] * widths)
        if at_start.corners is not None:
            table, start = curve.within(table), start.copy()
            start[:-1] = outward(at_start.table, table) / widths
        if np.any(np.diff(table.ravel()) <= 0) or curve.gaps(table)[-1] <= 0.0:
            return None, None
        try:
            at = curve.at(table, at_start.value + start[-1] * unit, **how_solved)
        except (NoState, NotConverged):
            return None, start
        if formal and len(at.contact) != len(at_start.contact):
            return None, start
        try:
            matrix = np.vstack((np.column_stack((at.rates, at.by_value)) * here.scales, normal))
            step = np.linalg.solve(matrix, np.append(-at.residual, 0.0))
        except np.linalg.LinAlgError:
            # The matrix is singular if a zone can move freely along a level stretch of the profile.
            return None, None
        size = float(np.abs(step).max())
        # The search is given up if a Newton step is too long, compared with the step along the
        # curve. The limit has a lower bound, because the first iterate may have a low accuracy.
        if size > (MOVES.least_part if k == 0 else 1.0) * max(
            abs(length), 10 * ACCURACY.resting_step
        ):
            return None, None
        rounded = 0.5 * before < size < ACCURACY.resting_step
        if (
            size < ACCURACY.neutral
            and "tolerance" not in how_solved
            or not tight
            and (size < ACCURACY.rough or rounded)
        ):
            return at, start
        start = start + step
        # The iteration ends if the next Newton step would be shorter than `ACCURACY.neutral`, where
        # steps are assumed to shrink at least by the factor `size / before`. It also ends if a
        # short step is more than half of the step before (`rounded`), because such a step is
        # round-off.
        if size * min(size / before if k else 1.0, 1.0) < ACCURACY.neutral or rounded:
            how_solved.pop("tolerance", None)
            return curve.at(
                at_start.moved(start[:-1] * widths), at_start.value + start[-1] * unit, **how_solved
            ), start
        before = size
    return None, start
