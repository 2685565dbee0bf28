"""Along the curve of equilibria, by its arc: an equilibrium is followed as the control rises or
falls, to where it ceases to be.

There J = dr/ds has a zero eigenvalue, and along the arc the control has an extreme (a turning
point). Motions are counted in the widths of the zones, the control in what moves an end by as much,
so that a unit tangent tells both.

Where an end reaches a sharp corner, or one that is held there is driven no longer, the curve has a
kink: a step ends there, and the next one begins with that end held, or free. If it is free but
unstable it lets go, and the curve ends.
"""

from collections.abc import Callable, Iterator
from dataclasses import field, replace
from functools import cached_property
from typing import Any

import numpy as np

from contact.adhesion.curve import NEUTRAL, Equilibria, NoState, Point
from contact.errors import NotConverged
from contact.formulation.roots import smooth_root
from contact.formulation.tables import outward
from sie import Array, record

# First and longest step, Newton's steps in one, how small its last one is, and how many steps; a
# step so small is none.
_FIRST = 0.1
_LONGEST = 0.5
_CORRECTIONS = 8
_TIGHT = 1e-11
_MOST_STEPS = 3000
_NO_STEP = 1e-9
# Of a step: the angle that it is to turn the tangent by, how much longer it is at the most than the
# one before, and how much shorter after one that failed.
_TURN = 0.2
_LONGER = 4.0
_SHORTER = 0.3
# The unit of the control over that of the step before, at the least.
_SLOWER = 0.5
# Of a step, how far from its tangent it begins at the most; places within it that others are told
# from, and how far these are from one another at the least, over how far they are from it.
_BENT = 0.3
_NODES = 3
_SEPARATE = 0.1
# Of a step in which stability is lost, how short it is where there is no turn before or behind.
_NO_TURN = 1e-6
# Cosine of the angle by which a step may turn the tangent.
_STRAIGHT = 0.85
# Of equations that are met, what may be left of them, over what the control does to an end at the
# most.
_NOT_MET = 1e-8
# What drives an end that is held by no more lets go together with one that is driven by nothing;
# ends so near to a corner, over the widths, reach it together.
_TOGETHER = 1e-7
# Past a turning point ends are pushed on by this part of their zones, or of the gaps beside them.
_PUSH = 0.03
# A step that fails beyond where a zone vanishes goes so far towards it; the next one so far, past
# it.
_OF_VANISHING = 0.9
_PAST_VANISHING = 2.0
# A step past there that is slight.
_SLIGHT = 1e-4
# Of an extreme, how much of the growth at the ends of a step.
_NO_GROWTH = 0.1
# Of a step, halvings by which the loss of stability in it is located, and of the way to one within
# it.
_LOCATED = 40
_HALVED = 4
# So many steps without a length come after one another at sharp corners.
_MOST_STANDS = 3
# What rounding may leave of Newton's steps; and one that is none.
_ROUNDED = 1e-6
_STILL = 1e-12
# So near a place in a step is told, over how far it is.
NEAR = 1e-12
# Where a curve is only to be followed: how tightly its states are solved, and how small Newton's
# last step is; over the step, from how near a turning point ends that are pushed on go the way they
# go from there; and what such a state may be off by.
_ROUGH = 1e-9
_ROUGHLY = 1e-9
ABOUT = 1e-3
_OFF = 1e-5


@record
class Place:
    """An equilibrium on the curve: what motions of its ends, their zones' widths, and the control
    are counted in (2n + 1,), the unit tangent (2n + 1,), and about how the curve leaves it, over
    the square and the cube of the length (2, 2n + 1).
    """

    at: Point
    scales: Array
    tangent: Array
    leaves: Array

    def ahead(self, length: float) -> Array:
        """About where the curve is, in what the tangent is told in."""
        off = length**2 * self.leaves[0] + length**3 * self.leaves[1]
        return np.asarray(
            length * self.tangent + (off if np.abs(off).max() <= _BENT * abs(length) else 0.0)
        )

    @property
    def rises(self) -> float:
        """Of the control, along the arc."""
        return float(self.tangent[-1])

    def moved(self, to: Point) -> Array:
        """How far another equilibrium is, in what the tangent is told in (2n + 1,)."""
        return np.append(outward(self.at.table, to.table), to.value - self.at.value) / self.scales

    def length(self, to: Point) -> float:
        """How far along the tangent another equilibrium is."""
        return float(self.tangent @ self.moved(to))


@record
class Step:
    """A step along the arc, of a length, from one equilibrium to another. after: the equilibrium at
    its end with other ends held at sharp corners, from which the next one begins; None where these
    are the same. known: the equilibria in it by how far they are, and whether they were solved
    tightly.
    """

    curve: Equilibria
    start: Place
    length: float
    end: Place
    after: Point | None = None
    known: dict[float, tuple[Point, bool]] = field(default_factory=dict)

    def at(self, length: float, tight: bool = True, halvings: int = _HALVED) -> Point:
        """The equilibrium at a part of the step, where need be by way of one nearer to one that is
        known.
        """
        for place, (point, tightly) in self.known.items():
            if abs(place - length) <= NEAR * length and tightly >= tight:
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
        """About where the curve is at a length: the cubic that has both ends and their tangents,
        and through what is known between them.
        """
        nodes: list[float] = []
        for node in sorted(self.known, key=lambda k: abs(k - length)):
            if len(nodes) < _NODES and min(
                abs(node - one) for one in (0.0, self.length, *nodes)
            ) > _SEPARATE * abs(node - length):
                nodes.append(node)
        off = [
            (self.start.moved(self.known[node][0]) - self._cubic(node))
            / (node * (self.length - node)) ** 2
            for node in nodes
        ]
        for level in range(1, len(nodes)):
            for i in range(len(nodes) - level):
                here, there = nodes[i], nodes[i + level]
                off[i] = ((length - there) * off[i] + (here - length) * off[i + 1]) / (here - there)
        return self._cubic(length) + (
            off[0] * (length * (self.length - length)) ** 2 if nodes else 0.0
        )

    def _cubic(self, length: float) -> Array:
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
        """Whether ends let go of sharp corners at its end, where the curve breaks off."""
        return self.after is not None and self.after.growth > NEUTRAL

    @property
    def turned(self) -> float:
        """By which angle the tangent has turned."""
        return float(np.arccos(np.clip(_alike(self.start, self.end), -1.0, 1.0)))

    @property
    def turns(self) -> bool:
        """Whether the control has its extreme in this step."""
        return self.start.rises * self.end.rises <= 0.0

    @property
    def turns_once(self) -> bool:
        """Whether stability is lost where the control has its extreme: where there are several the
        step is too long.
        """
        try:
            growth = self.at(self.turning(False), False).growth
        except NotConverged:
            return False
        return abs(growth) < _NO_GROWTH * max(abs(self.start.at.growth), abs(self.end.at.growth))

    def turning(self, tight: bool = True) -> float:
        """How far it is to there."""
        near = NEAR if tight else ABOUT
        return self.where(
            self._rising, self.start.rises, self._rising(self.end.at), None, near, tight
        )

    def _rising(self, at: Point) -> float:
        """Of the control, by the length."""
        tangent = _tangent(at, self.start.scales)
        return float(tangent[-1] / (tangent @ self.start.tangent))

    def where(
        self,
        function: Callable[[Point], float],
        first: float,
        last: float,
        length: float | None = None,
        near: float = NEAR,
        tight: bool = True,
    ) -> float:
        """How far it is to the zero of a function with these values of opposite signs at the start
        and at the end (or at a length); near: so near, over itself.
        """
        end = self.length if length is None else length
        known = {
            part: function(at)
            for part, (at, tightly) in self.known.items()
            if 0.0 < part < end and tightly >= tight
        }
        values = {0.0: first, end: last} | known
        return float(smooth_root(lambda part: function(self.at(part, tight)), values, near))

    def arriving(self, value: float) -> Point | None:
        """The equilibrium in this step under a value of the control; None if Newton does not come
        to it at once.
        """
        start, rises, (bend, twist) = self.start, self.start.rises, self._leaves[:, -1]
        wanted = (value - start.at.value) / start.scales[-1]
        if start.at.corners is not None:
            return None
        roots = np.roots((twist, bend, rises, -wanted))
        roots = roots.real[
            (roots.imag == 0.0) & (roots.real >= 0.0) & (roots.real <= (1.0 + _OFF) * self.length)
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


def steps(curve: Equilibria, here: Point, sense: float, tight: bool = True) -> Iterator[Step]:
    """From an equilibrium, steps along the curve, the control first rising (sense 1) or falling
    (-1). tight: whether their ends are states that are solved as tightly as there is.
    """
    place, length, why, stands = (
        _stood_by(curve, here, sense),
        _FIRST,
        "the curve of equilibria was not followed on",
        0,
    )
    unstable: tuple[Place, float] | None = None
    vanishing = False
    for _ in range(_MOST_STEPS):
        reached = _corner_within(curve, place, length)
        ahead = (
            along(curve, place, length, tight)
            if reached is None
            else _to_corner(curve, place, reached)
        )
        end = None if ahead is None else onward(curve, place, ahead)
        if end is None or not (
            _keeps(place, end) or (vanishing and length < _SLIGHT and _has_lost(place, end))
        ):
            if end is not None and place.at.growth < 0.0 <= end.at.growth:
                unstable = place, length
                if length < _NO_TURN and not vanishing:
                    break
            short = curve.vanishes(place.at, place.tangent * place.scales)
            length, vanishing = (
                (_OF_VANISHING * short, True) if short < length else (_SHORTER * length, vanishing)
            )
            if length < _NO_STEP:
                break
            continue
        step = _to_change(
            Step(curve, place, place.length(end.at) if reached is not None else length, end)
        )
        if step.turns and not step.turns_once:
            length *= _SHORTER
            continue
        yield step
        if step.lets_go:
            why = "an end that was held at a sharp corner has let go"
            break
        # Steps without any length would toggle between ends that are held and free.
        stands = stands + 1 if step.length < _NO_STEP else 0
        if stands > _MOST_STANDS:
            why = "ends at sharp corners are neither held nor free"
            break
        place = step.end if step.after is None else _stood_by(curve, step.after, step.end.rises)
        length = min(min(_LONGER, _TURN / max(step.turned, _TURN / _LONGER)) * length, _LONGEST)
        if vanishing:
            short = curve.vanishes(place.at, place.tangent * place.scales)
            part = _PAST_VANISHING if len(place.at.contact) > 1 else _OF_VANISHING
            length, vanishing = min(length, part * short), short < _LONGEST
            if length < _NO_STEP:
                break
    if unstable is not None:
        raise SymmetryLost(curve, *unstable)
    raise NotConverged(why)


class SymmetryLost(NotConverged):
    """A curve goes on unstably, without a turn, within a step of a length. at: the last stable
    equilibrium, told only where it was located.
    """

    at: Point

    def __init__(self, curve: Equilibria, place: Place, length: float, where: str = "") -> None:
        super().__init__(
            f"a contact loses its stability without a turn of its curve, to a motion that breaks a symmetry{where}: it is not followed on, "
            "since the scene does not say which way it goes"
        )
        self.within = curve, place, length

    def located(self) -> "SymmetryLost":
        """The same, of which it is told where."""
        curve, place, length = self.within
        low, high, at = 0.0, length, place.at
        for _ in range(_LOCATED):
            middle = 0.5 * (low + high)
            found = along(curve, place, middle)
            if found is None:
                break
            low, high, at = (middle, high, found) if found.growth < 0.0 else (low, middle, at)
        units, told = (
            curve.problem.units,
            f", at load {at.load * curve.problem.units.load:.10g} N/m",
        )
        if curve.problem.operator.has_approach:
            told += f", approach {-at.level * units.height:.10g} m"
        lost = SymmetryLost(*self.within, told)
        lost.at = at
        return lost


def beside(here: Point) -> Array:
    """Zones from which ends move on where a motion of theirs without a change of the control drives
    them.
    """
    growth, motions = here.motions(np.arange(len(here.residual)))
    motion = motions[:, int(np.argmax(growth))].real
    return here.moved(np.asarray(_PUSH * motion / np.abs(motion / here.widths).max()))


def _corner_within(curve: Equilibria, here: Place, length: float) -> int | None:
    """The end that reaches a sharp corner first within a step along the tangent; None if none does."""
    if here.at.corners is None:
        return None
    moves = (here.tangent * here.scales)[:-1]
    with np.errstate(divide="ignore", invalid="ignore"):
        away = np.where(moves > 0.0, curve.to_corners(here.at.table) / moves, np.inf)
    end = int(np.argmin(away))
    return end if away[end] <= length else None


def _to_corner(curve: Equilibria, here: Place, end: int) -> Point | None:
    """The equilibrium at which an end is at its corner."""
    distance = curve.to_corners(here.at.table)[end] / here.scales[end]
    return _corrected(
        curve,
        here,
        distance / here.tangent[end] * here.tangent,
        np.eye(len(here.tangent))[end],
        True,
    )


def _to_change(step: Step) -> Step:
    """The step up to where a held end is driven no longer; and what is held after it."""
    at = step.end.at
    if at.corners is None:
        return step
    held = at.held
    least = _least_held(at)
    if least < 0.0:
        first = max(_least_held(step.start.at), 0.0)
        length = step.where(_least_held, first, least)
        at = step.at(length)
        step = replace(step, length=length, end=onward(step.curve, step.start, at))
        held = held & (at.whole.residual > _TOGETHER)
    else:
        gap = step.curve.to_corners(at.table)
        at_corner = gap < _TOGETHER * at.widths
        if not np.any(gap[~held] == 0.0) or step.length < _NO_STEP:
            return step
        held = held | at_corner
        at = step.curve.at(
            step.curve.within(at.moved(np.where(at_corner, 2 * gap, 0.0))), at.value, held=held
        )
    return replace(step, after=at.holding(held))


def _least_held(at: Point) -> float:
    """What drives the held end least that is."""
    whole = at.whole
    return float(whole.residual[whole.held].min(initial=np.inf))


def let_go(step: Step) -> Array:
    """Zones from which ends move on that let go of sharp corners at the end of a step."""
    assert step.after is not None
    return step.after.moved(-_PUSH * step.after.widths * (step.end.at.held & ~step.after.held))


def beyond(curve: Equilibria, turned: Point, sense: float) -> Array:
    """Zones from which ends move on to another equilibrium at a turning point: inward where the
    control falls.
    """
    move = _begun(curve, turned, sense).tangent[:-1] * turned.widths
    return turned.moved(
        np.asarray(
            move
            * (sense * np.sign(move.sum()) * _PUSH / np.abs(move / curve.room(turned.table)).max())
        )
    )


def _stood_by(curve: Equilibria, here: Point, sense: float) -> Place:
    """A place to begin at, which a slight change of the control does not leave far behind."""
    here.refuse_neutral()
    return _begun(curve, here, sense)


def _begun(curve: Equilibria, here: Point, sense: float) -> Place:
    scales = np.append(here.widths, _unit(curve, here))
    tangent = _tangent(here, scales)
    return Place(
        here,
        scales,
        tangent if tangent[-1] * sense >= 0.0 else -tangent,
        np.zeros((2, len(tangent))),
    )


def onward(curve: Equilibria, before: Place, ahead: Point) -> Place:
    """The same sense of the curve at another equilibrium of it."""
    # At a turning point motions are without bound: the unit follows by and by, or the turn would be
    # all too sharp in it.
    scales = np.append(ahead.widths, max(_unit(curve, ahead), _SLOWER * before.scales[-1]))
    tangent, carried = _tangent(ahead, scales), scales / before.scales
    tangent = tangent if before.tangent @ (tangent * carried) >= 0.0 else -tangent
    here = Place(ahead, scales, tangent, np.zeros((2, len(tangent))))
    moved = here.moved(before.at)
    # On as it has come from the one before.
    return (
        replace(here, leaves=_leaving(tangent, moved, before.tangent / carried))
        if moved.any()
        else here
    )


def _leaving(tangent: Array, moved: Array, there: Array) -> Array:
    """How a curve leaves a place, over the square and the cube of the length (2, 2n + 1), as the
    cubic does that is at another one, moved from it, and has a tangent along `there`.
    """
    length = float(tangent @ moved)
    if abs(length) < _NO_STEP:
        return np.zeros((2, len(tangent)))
    off, turned = (
        (moved - length * tangent) / length**2,
        (there / float(tangent @ there) - tangent) / length,
    )
    return np.array((3 * off - turned, (turned - 2 * off) / length))


def _alike(before: Place, ahead: Place) -> float:
    """Cosine of the angle between the tangents of two places."""
    carried = ahead.tangent * (ahead.scales / before.scales)
    return float(before.tangent @ carried) / float(np.linalg.norm(carried))


def _keeps(before: Place, ahead: Place) -> bool:
    """Whether a step is short enough not to have left the curve: its tangents are alike, and
    stability was not lost without a turn.
    """
    kept = before.at.growth >= 0.0 or ahead.at.growth < 0.0 or before.rises * ahead.rises <= 0.0
    return _alike(before, ahead) >= _STRAIGHT and kept


def _has_lost(before: Place, ahead: Place) -> bool:
    """Whether contact is lost somewhere and nothing else has changed: its width vanishes as a root
    does, and the curve bends at once.
    """
    alike = before.rises * ahead.rises > 0.0 and before.at.growth * ahead.at.growth > 0.0
    return alike and len(ahead.at.contact) < len(before.at.contact)


def _unit(curve: Equilibria, at: Point) -> float:
    """What the control is counted in: by it some end moves by its zone's width; not less than what
    drives one by the intensity asked.
    """
    whole, least = at.whole, curve.unit(at)
    moves, _, rank, _ = np.linalg.lstsq(at.rates, at.by_value, rcond=None)
    if rank < len(moves) and np.abs(at.rates @ moves - at.by_value).max() * least > _NOT_MET:
        # At a turning point the ends move while the control stands still.
        return least
    # What drives a held end may double.
    driven = np.where(
        whole.held,
        (whole.by_value - whole.rates @ moves) / np.maximum(1.0, np.abs(whole.residual)),
        0.0,
    )
    most = float(np.maximum(np.abs(moves / at.widths), np.abs(driven)).max())
    return max(least, 1.0 / most) if most > 0.0 else least


def _tangent(at: Point, scales: Array) -> Array:
    """Unit vector along the curve: motions of the ends and of the control over what they are
    counted in.
    """
    return np.asarray(np.linalg.svd(np.column_stack((at.rates, at.by_value)) * scales)[2][-1])


def along(curve: Equilibria, here: Place, length: float, tight: bool = True) -> Point | None:
    """The equilibrium at a distance along the tangent, perpendicular to it; None if Newton does not
    come to it at once.
    """
    return _corrected(curve, here, here.ahead(length), here.tangent, tight)


def _corrected(
    curve: Equilibria, here: Place, start: Array, normal: Array, tight: bool
) -> Point | None:
    """The equilibrium from a start (2n + 1,) on, perpendicular to the normal; None if Newton does
    not come to it at once.
    """
    if curve.formally is curve:
        return _newton(curve, here, start, normal, tight)[0]
    # As a rule the zones of contact stay what they are, and it is asked once whether they do.
    found, reached = _newton(curve.formally, here, start, normal, tight, True)
    if found is not None and curve.has_right_zones(found):
        return found
    return None if reached is None else _newton(curve, here, reached, normal, tight)[0]


def _newton(
    curve: Equilibria, here: Place, start: Array, normal: Array, tight: bool, formal: bool = False
) -> tuple[Point | None, Array | None]:
    """(the same, how far Newton's steps have come (2n + 1,), None where it is no use to go on from
    there). formal: of as many zones of contact as there are at the start, or of none.
    """
    at_start, length, widths, unit = (
        here.at,
        float(np.linalg.norm(start)),
        here.scales[:-1],
        float(here.scales[-1]),
    )
    how: dict[str, Any] = {} if tight else {"tolerance": _ROUGH}
    if at_start.corners is not None:
        how["held"] = at_start.held
    before = np.inf
    for k in range(_CORRECTIONS):
        table = at_start.moved(start[:-1] * widths)
        if at_start.corners is not None:
            table, start = curve.within(table), start.copy()
            start[:-1] = outward(at_start.table, table) / widths
        if np.any(np.diff(table.ravel()) <= 0) or curve.gaps(table)[-1] <= 0.0:
            return None, None
        try:
            at = curve.at(table, at_start.value + start[-1] * unit, **how)
        except (NoState, NotConverged):
            return None, start
        if formal and len(at.contact) != len(at_start.contact):
            return None, start
        try:
            matrix = np.vstack((np.column_stack((at.rates, at.by_value)) * here.scales, normal))
            step = np.linalg.solve(matrix, np.append(-at.residual, 0.0))
        except np.linalg.LinAlgError:
            # Of zones on a level stretch.
            return None, None
        size = float(np.abs(step).max())
        # The start, too, may have been solved roughly.
        if size > (0.3 if k == 0 else 1.0) * max(abs(length), _OFF):
            return None, None
        rounded = 0.5 * before < size < _ROUNDED
        if size < _STILL and "tolerance" not in how or not tight and (size < _ROUGHLY or rounded):
            return at, start
        start = start + step
        # What is left falls as the steps do, or faster. Of zones far narrower than others rounding
        # leaves more: then they do not fall any more.
        if size * min(size / before if k else 1.0, 1.0) < _TIGHT or rounded:
            how.pop("tolerance", None)
            return curve.at(
                at_start.moved(start[:-1] * widths), at_start.value + start[-1] * unit, **how
            ), start
        before = size
    return None, start
