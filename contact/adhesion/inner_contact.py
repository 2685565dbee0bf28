"""The contact under a tension on given intervals: frictionless contact of the deformed profile.

The pressure q is K/sqrt(d) + A sqrt(d) at a small distance d from the end of a zone, with the edge
intensity K and the edge slope A. The ends of the zones are moved by Newton steps 2 K/A within the
intervals of tension. At the end of an interval the slope of the deformed profile is logarithmically
infinite. Near this end, K varies as the square root of the distance between the end of the zone and
the end of the interval. After the search, `inner_signs` tests the signs of pressure and gap.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import sie
from contact.adhesion.curve import ACCURACY, NoState
from contact.adhesion.deformed_profile import TractionLoaded
from contact.adhesion.inner_signs import corrected, sampled_gap
from contact.adhesion.intervals import fitted, interval_of
from contact.adhesion.options import LIMITS, MOVES, SAMPLES
from contact.errors import NotConverged
from contact.formulation.controls import Control
from contact.formulation.fields import ZoneFields
from contact.formulation.tables import gaps_between, joined_where
from sie import Array, Mask, record


class ContactLost(NoState):
    """Error: under the given tension, no zone of contact is left."""


class EndsCovered(NoState):
    """Error: zones of contact cover ends of intervals of tension.

    ends: mask (2m,) of the covered ends.
    """

    def __init__(self, ends: Mask) -> None:
        super().__init__("a zone of contact reaches the end of an interval of tension")
        self.ends = ends


@record
class InnerTolerances:
    """Tolerances for the solution of a contact under tension.

    density: tolerance of the density. ends: the search ends when the Newton steps of the zone ends
    are below this limit, relative to the strips of tension next to them. last: after a Newton step
    below this limit, one more step is taken without a check, since Newton's method squares the
    error.
    """

    density: float = ACCURACY.density
    ends: float = ACCURACY.neutral
    last: float = ACCURACY.rough

    @classmethod
    def intermediate(cls, density: float) -> InnerTolerances:
        """Tolerances for an intermediate state, whose ends need little accuracy."""
        return cls(density, ACCURACY.resting_step, ACCURACY.coarse)


def contact_under(
    pulled: TractionLoaded,
    control: Callable[[TractionLoaded], Control],
    zones: Array,
    formal: bool,
    tolerances: InnerTolerances,
) -> tuple[ZoneFields, tuple[Array, Array] | None]:
    """(fields of the contact pressure q under a tension, sampled gap outside the zones).
    q is the true pressure plus the tension.

    control: the control of the contact as a function of the problem; zones: a first guess; formal:
    whether the number of zones is kept and the signs are not checked (the gap is then None).
    """
    load = control(pulled).load
    if load is not None and not load > 0.0:
        raise ContactLost
    if len(zones) == 0:
        zones = _zone_at_lowest_point(pulled)
    search = _Search(pulled, control, tolerances)
    for done in range(LIMITS.max_iterations):
        fields = ZoneFields(*search.with_ends(zones, done == 0))
        if formal:
            return fields, None
        gap_samples = sampled_gap(fields)
        found = corrected(fields, gap_samples)
        if found is None:
            return fields, gap_samples
        zones = fitted(
            found, pulled.pulling.table, pulled.round, pulled.pulling.everywhere, pulled.corners
        )
        if len(zones) == 0:
            raise ContactLost
    raise NotConverged("the zones of contact under the tension did not converge")


@record
class _Search:
    """The search for the zones of contact in a problem under tension.

    control: the control of the contact as a function of the problem.
    """

    pulled: TractionLoaded
    control: Callable[[TractionLoaded], Control]
    tolerances: InnerTolerances

    def with_ends(self, zones: Array, plain: bool) -> tuple[TractionLoaded, sie.AnyState]:
        """(problem, solved state) of the zones in equilibrium, whose ends start from a guess.

        Plain Newton steps are tried first if `plain` is set. If they fail, the engine's search is
        used: it accounts for the interaction of ends across narrow gaps, but does not support sharp
        corners.
        """
        cornered = self.pulled.corners != (-np.inf, np.inf)
        if plain or cornered:
            try:
                return self.settled(zones)
            except NotConverged:
                if cornered:
                    raise
        return self.searched(zones)

    def settled(self, zones: Array) -> tuple[TractionLoaded, sie.State]:
        """(problem, state) for zones whose ends were found by Newton's method.

        The number of zones may only fall.
        """
        first = np.diff(zones, axis=1)[:, 0]
        before: tuple[Array, Array] | None = None
        best, stuck = np.inf, 0
        for _ in range(LIMITS.max_iterations):
            here, state = self.solved(zones)
            width, (room, shared) = np.diff(zones, axis=1)[:, 0], _room(self.pulled, zones)
            pinned, rests = _pinned(here, zones, np.array(state.density.intensities))
            k, step = _steps((here, state), zones, before, (room, shared), (pinned, rests))
            before = zones, k
            least = np.minimum(width, np.where(shared | pinned, np.inf, np.maximum(room, 1e-300)))
            step_size = float(np.abs(step / least).max())
            best, stuck = min(best, step_size), stuck + 1 if step_size > 0.5 * best else 0
            # The search ends if the Newton step is small enough, or if short steps no longer
            # decrease. Next to narrow strips of tension, the round-off of the steps may exceed the
            # tolerance.
            if step_size < self.tolerances.ends or (
                stuck > 2 and step_size < 10 * ACCURACY.resting_step
            ):
                return here, state
            reaches = _reaches(here, zones, k, step, room, shared)
            _refuse_covered(
                here, zones, ~shared & (room < ACCURACY.resting_step * width), step, room
            )
            share = np.where(shared, MOVES.max_move, 1 - MOVES.least_part)
            inward = MOVES.max_move * width
            limit = np.minimum(inward, share * room)
            moved = np.where(reaches, room, np.clip(step, -inward, limit))
            # Newton's method squares the error, so one more step suffices. Its result is not
            # checked.
            if float(np.abs(moved / least).max()) < self.tolerances.last and not reaches.any():
                return self.solved(_moved(here, zones, moved, reaches))
            shrinks = ((step < -inward) | (pinned & rests)).all(axis=0)
            lost = (width < MOVES.vanished * first) & shrinks
            if lost.any():
                if lost.all():
                    raise ContactLost
                zones, first = zones[~lost], first[~lost]
                continue
            zones = _moved(here, zones, moved, reaches)
            zones, first = _joined(zones, first, step)
        raise NotConverged("the ends of the zones under the tension did not converge")

    def solved(self, zones: Array) -> tuple[TractionLoaded, sie.State]:
        """(problem, state) on given zones, whose ends need not be in equilibrium."""
        here = self.pulled.over(zones)
        try:
            return here, sie.solve_fixed(
                here.equation(self.control(here)),
                sie.Zones.of(zones, self.pulled.end, self.pulled.end),
                self.tolerances.density,
            )
        except sie.SingularSystem as failure:
            raise NotConverged(
                "zones under the tension came too close to each other or to an end of the tension"
            ) from failure

    def searched(self, zones: Array) -> tuple[TractionLoaded, sie.AnyState]:
        """(problem, state) for zones found by the engine's search for ends.

        If the search fails or the zones leave their intervals, `settled` is used.
        """
        equation = self.pulled.equation(self.control(self.pulled))
        for _ in range(LIMITS.max_iterations):
            free = sie.find_ends(
                equation, sie.Zones.of(zones, self.pulled.end, self.pulled.end), 1e-10
            )
            ended = free.density.zones.table
            if len(free.lost):
                if len(free.lost) == len(ended):
                    raise ContactLost
                zones = np.delete(ended, free.lost, axis=0)
            elif len(free.met):
                zones = joined_where(ended, np.isin(np.arange(len(ended) - 1), free.met))
            else:
                own = _surrounding_intervals(self.pulled, ended)
                within = bool(np.all((ended[:, 0] > own[:, 0]) & (ended[:, 1] < own[:, 1])))
                return (
                    (self.pulled, free.state) if free.converged and within else self.settled(zones)
                )
        raise NotConverged("the number of zones under the tension did not converge")


def _zone_at_lowest_point(pulled: TractionLoaded) -> Array:
    """A narrow zone about the lowest sampled point of the deformed profile."""
    tension, count = pulled.pulling, SAMPLES.sign_samples
    table = np.array([[0.0, tension.width]]) if tension.everywhere else tension.table
    x = table[:, :1] + np.diff(table, axis=1) * (np.arange(count) + 0.5) / count
    i, j = np.unravel_index(int(np.argmin(pulled.shape(x.ravel()))), x.shape)
    half = 0.5 * float(table[i, 1] - table[i, 0]) / count
    return np.array([[x[i, j] - half, x[i, j] + half]])


def _refuse_covered(
    here: TractionLoaded, zones: Array, close: Mask, step: Array, room: Array
) -> None:
    """Raise EndsCovered if a zone covers an end of its interval of tension.
    The strip of tension there has then closed. Strips that end at a sharp corner do not count, as
    they may be arbitrarily narrow.

    close: mask (2, n) of the ends with hardly any strip of tension; step: Newton steps of the ends;
    room: widths of the strips.
    """
    covers = close & (step > 0.5 * room) & ~_beside_corners(here, zones)
    if covers.any():
        i = interval_of(zones, here.pulling.table)
        ends = np.zeros((2, len(here.pulling.table)), dtype=bool)
        for side in (0, 1):
            ends[side, i[covers[side]]] = True
        raise EndsCovered(ends.ravel())


def _steps(
    found: tuple[TractionLoaded, sie.State],
    zones: Array,
    before: tuple[Array, Array] | None,
    around: tuple[Array, Mask],
    corners: tuple[Mask, Mask],
) -> tuple[Array, Array]:
    """(edge intensities K, outward Newton steps) of the ends, each (2, n).

    before: zones and K of the previous step; around: distance to the next obstacle, and whether
    that is a zone (`_room`); corners: ends at sharp corners, and those that stay there (`_pinned`).
    """
    (here, state), (room, shared), (pinned, rests) = found, around, corners
    k, slope = np.array(state.density.intensities), edge_slopes(here, state)
    with np.errstate(divide="ignore", invalid="ignore"):
        step = np.where(slope > 0, 2 * k / slope, np.copysign(np.inf, k))
    if before is not None and len(before[0]) == len(zones):
        # If K has changed its sign, the end has passed the position at which K is 0. Then the
        # secant method is used between the last two positions.
        back = np.array([zones[:, 0] - before[0][:, 0], before[0][:, 1] - zones[:, 1]])
        overshot = np.abs(k) > MOVES.least_part * np.abs(before[1])
        turned = (k * before[1] < 0) & overshot & ~pinned
        step = np.where(turned, back * k / np.where(turned, k - before[1], 1.0), step)
    # Near the end of an interval of tension, the intensity K is linear in the square root of the
    # distance from this end. So this square root is the variable of the Newton step.
    alone = ~shared & np.isfinite(step) & (room > 0)
    own = np.where(alone, room, 1.0)
    least_root = np.sqrt(MOVES.least_part)
    root = np.clip(1 - np.where(alone, step, 0.0) / (2 * own), least_root, 4.0)
    rooted = np.where(alone, own * (1 - root**2), step)
    step = np.where(np.abs(step) < 0.1 * room, step, rooted)
    step = np.where(pinned, np.where(rests, 0.0, _released(here, k, step)), step)
    return k, step


def _moved(pulled: TractionLoaded, zones: Array, moved: Array, reaches: Mask) -> Array:
    """The zones with ends moved outward; ends that reach a sharp corner are put on the corner."""
    zones = zones + np.column_stack((-moved[0], moved[1]))
    return np.where(reaches.T, np.broadcast_to(pulled.corners, zones.shape), zones)


def edge_slopes(pulled: TractionLoaded, state: sie.AnyState) -> Array:
    """The edge slopes A (2, Z): coefficients of sqrt(distance) in p + s at the ends of the zones.

    p is the pressure and s the full tension. The density of `state` is q = p + s. On a zone pinned
    at a corner it is q = p + s eta, where eta < 1 is the local fraction of the tension
    (contact.adhesion.deformed_profile). At the other end of such a zone, s (1 - eta) adds to the
    coefficient of q.
    """
    slope, zones = np.array(state.density.edge_slopes), state.density.zones
    more = 2 * pulled.pulling.stress / np.pi / np.sqrt(2 * zones.half)
    for end, _ in pulled.pulling.spreads:
        slope[0 if end else 1, end] += more[end]
    return slope


def _pinned(pulled: TractionLoaded, zones: Array, k: Array) -> tuple[Mask, Mask]:
    """Masks (2, n) of the ends at sharp corners, and of the ends that stay at their corners.

    An end stays if its edge intensity K is compressive, up to round-off.
    """
    pinned = (zones == np.array(pulled.corners)).T
    return pinned, pinned & (k >= -ACCURACY.rough * np.abs(k).max())


def _released(pulled: TractionLoaded, k: Array, step: Array) -> Array:
    """Newton steps of ends that are released from a sharp corner.

    A narrow strip of width (pi K/(2 s))^2 under the tension s has the edge intensity -K, which
    cancels the intensity K of the end. So the end moves inward by this width. Without tension, it
    moves inward by the length of its Newton step.
    """
    stress = pulled.pulling.stress if len(pulled.pulling.table) else 0.0
    return (
        -((np.pi * k / (2 * stress)) ** 2)
        if stress
        else np.where(np.isfinite(step), -np.abs(step), step)
    )


def _beside_corners(pulled: TractionLoaded, zones: Array) -> Mask:
    """Mask (2, n) of zone ends that face the end of an interval of tension at a sharp corner."""
    return np.asarray((_surrounding_intervals(pulled, zones) == np.array(pulled.corners)).T)


def _reaches(
    pulled: TractionLoaded, zones: Array, k: Array, step: Array, room: Array, shared: Mask
) -> Mask:
    """Mask (2, n) of the ends that move all the way to the sharp corner next to them.

    The strip between an end and the corner has the width w and the tension s. The end moves to the
    corner if its edge intensity K exceeds the intensity 2 s sqrt(w)/pi of this strip.
    """
    lo, hi = pulled.corners
    if not np.isfinite(lo) or len(zones) == 0:
        return np.zeros(k.shape, dtype=bool)
    out, table, to_obstacle = (
        np.zeros(k.shape, dtype=bool),
        pulled.pulling.table,
        _beside_corners(pulled, zones),
    )
    for side, i, corner in ((0, 0, lo), (1, -1, hi)):
        if zones[i, side] != corner and not shared[side, i] and to_obstacle[side, i]:
            narrow = room[side, i] < MOVES.max_move * (zones[i, 1] - zones[i, 0])
            part = 2 / np.pi * pulled.pulling.stress * np.sqrt(room[side, i]) if len(table) else 0.0
            out[side, i] = (
                narrow
                and step[side, i] > 0.0
                and (k[side, i] > part if part else step[side, i] > room[side, i])
            )
    return out


def _room(pulled: TractionLoaded, zones: Array) -> tuple[Array, Mask]:
    """(distances (2, n) of the ends to the next obstacle, mask of obstacles that are zones).
    An obstacle is another zone, or the end of the interval of tension around the zone.
    """
    right = np.diff(gaps_between(zones, pulled.round))[:, 0]
    to_obstacle, own = np.array([np.roll(right, 1), right]), _surrounding_intervals(pulled, zones)
    away = np.array([zones[:, 0] - own[:, 0], own[:, 1] - zones[:, 1]])
    return np.minimum(to_obstacle, away), to_obstacle <= away


def _surrounding_intervals(pulled: TractionLoaded, zones: Array) -> Array:
    """Interval of tension around each zone (n, 2); without tension, the one between the corners."""
    table = pulled.pulling.table
    return (
        table[interval_of(zones, table)]
        if len(table)
        else np.broadcast_to(pulled.corners, zones.shape)
    )


def _joined(zones: Array, first: Array, step: Array) -> tuple[Array, Array]:
    """(zones joined across closed gaps, initial widths of the joined zones).

    first: the widths of the zones when the search began. A joined zone keeps this width of its
    leftmost part.
    """
    gap = zones[1:, 0] - zones[:-1, 1]
    width = np.diff(zones, axis=1)[:, 0]
    meets = (
        (gap < MOVES.vanished * np.minimum(width[1:], width[:-1]))
        & (step[1, :-1] > MOVES.least_part * gap)
        & (step[0, 1:] > MOVES.least_part * gap)
    )
    return joined_where(zones, meets), first[np.append(True, ~meets)]
