"""Steps along a curve of equilibria; a step stops where an end reaches or leaves a sharp corner."""

from collections.abc import Callable
from dataclasses import field, replace
from functools import cached_property

import numpy as np

from contact.adhesion.corrector import corrected
from contact.adhesion.curve import ACCURACY, Curve, State
from contact.adhesion.curve_point import ARC_OPTIONS, CurvePoint, alike, leaving, onward, tangent_at
from contact.adhesion.options import MOVES
from contact.errors import NotConverged
from contact.formulation.roots import smooth_root
from sie import Array, record


@record
class Step:
    """A step along the curve of equilibria, from one equilibrium to another equilibrium.

    after: the equilibrium `end` with other ends of intervals pinned, from which the next step
    begins; None if the same ends are pinned. known: maps arc lengths inside the step to pairs of
    the equilibrium there and whether it was solved to full accuracy.
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
        found = corrected(self.curve, self.start, self._about(length), self.start.tangent, tight)
        if found is None:
            if halvings == 0:
                raise NotConverged(
                    "an equilibrium inside a step along the curve of equilibria was not found"
                )
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
        return leaving(
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
        return float(np.arccos(np.clip(alike(self.start, self.end), -1.0, 1.0)))

    @property
    def turns(self) -> bool:
        """Whether the control has a maximum or minimum in the step."""
        return self.start.rises * self.end.rises <= 0.0

    @property
    def turns_once(self) -> bool:
        """Whether the control has exactly one extremum in the step.

        `growth`, the largest eigenvalue of a state's scaled rates, is zero at a single extremum. If
        it is not zero at the extremum found, the step has several extrema and is too long.
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
        tangent = tangent_at(at, self.start.scales)
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
        found = corrected(self.curve, start, guess, normal, True)
        return (
            None
            if found is None or not 0.0 <= start.length(found) <= self.length
            else replace(found, value=value)
        )


def corner_within(curve: Curve, here: CurvePoint, length: float) -> int | None:
    """Index of the end that first reaches a sharp corner within `length`; None if no end does."""
    if here.at.corners is None:
        return None
    moves = (here.tangent * here.scales)[:-1]
    with np.errstate(divide="ignore", invalid="ignore"):
        away = np.where(moves > 0.0, curve.to_corners(here.at.table) / moves, np.inf)
    end = int(np.argmin(away))
    return end if away[end] <= length else None


def to_corner(curve: Curve, here: CurvePoint, end: int) -> State | None:
    """The equilibrium on the curve at which a given end has reached its sharp corner."""
    distance = curve.to_corners(here.at.table)[end] / here.scales[end]
    return corrected(
        curve,
        here,
        distance / here.tangent[end] * here.tangent,
        np.eye(len(here.tangent))[end],
        True,
    )


def to_change(step: Step) -> Step:
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
