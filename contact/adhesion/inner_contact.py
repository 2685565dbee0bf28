"""The contact under the tension on given intervals: frictionless, of the profile that the tension
has deformed.

Newton's steps 2 K/A of the zones' ends stay within the intervals, at whose ends the deformed
profile has logarithms: beside one K goes with the root of the distance from there. Where q is
negative a zone is cut, where the surfaces overlap one begins.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import sie
from contact.adhesion.curve import NoState
from contact.adhesion.deformed_profile import Pulled
from contact.adhesion.intervals import fitted, interval_of, places
from contact.errors import NotConverged
from contact.formulation.controls import Control
from contact.formulation.fields import ZoneFields
from contact.formulation.quadrature import sides
from contact.formulation.roots import reaches
from contact.formulation.tables import gaps_between, joined_where, runs_of
from sie import Array, Index, Mask, record

# Newton's steps of the zones under a given tension, and how often their number may change.
_STEPS = 80
_ROUNDS = 16
# Of a density that is solved as tightly as any.
TIGHT = 1e-14
# After so many rounds
_PLAIN = 1
# A zone's end moves at most by these parts of its width, and of the gap beside it; it comes so much
# nearer to the end of its interval.
_INWARD = 0.3
_OUTWARD = 0.5
_INTO_GAP = 0.45
_NEARER = 0.25
# Of what an end was off by, from which on Newton's steps only take it to and fro.
_AS_FAR = 0.3
# What rounding may leave of a step, over the strip of tension beside an end.
_ROUNDED = 1e-5
# So near to the end of its interval, over its width, a zone that goes on covers it.
_COVERED = 1e-6
# A zone narrower than this part of what it was, and a gap beside which both ends go on, are gone.
_GONE = 1e-3
# Of an overlap, as wide a new zone begins.
_NEW = 0.5
# How far from the zones of a lone body it is looked, and in which parts, over what these span.
_FAR = 1e3
_CUTS = np.array([0.25, 1.0, 4.0, 16.0, 64.0])
# How often a gap is looked at more closely about its extremes.
_CLOSER = 3
# Below minus this part of its largest value q pulls; and where it is looked at more closely between
# two places.
_PULLS = 1e-9
_BETWEEN = np.linspace(0.0, 1.0, 17)[1:-1]
# Angles of a zone at which the sign of q is looked at, at the most, where the profile does not vary
# faster.
_SIGNS = 128


class Lost(NoState):
    """No contact is left under a tension."""


class Covered(NoState):
    """Contact goes on to the ends of intervals of tension. ends: which (2m,)."""

    def __init__(self, ends: Mask) -> None:
        super().__init__("contact reaches the end of an interval of tension")
        self.ends = ends


@record
class Tolerances:
    """How a contact is solved: the density; and what ends miss, and Newton's last step but one,
    over the strips beside them.
    """

    density: float = TIGHT
    ends: float = 1e-11
    last: float = 1e-9

    @classmethod
    def on_the_way(cls, density: float) -> Tolerances:
        """To a state: its ends are told roughly."""
        return cls(density, 1e-5, 1e-3)


def contact_under(
    pulled: Pulled,
    control: Callable[[Pulled], Control],
    zones: Array,
    formal: bool,
    tolerances: Tolerances,
) -> tuple[ZoneFields, tuple[Array, Array] | None]:
    """(fields of q on the zones of contact under a tension, the gap beside them). control: that of
    q; formal: as many zones as are given, whatever the signs, which are not looked at.
    """
    load = control(pulled).load
    if load is not None and not load > 0.0:
        raise Lost
    if len(zones) == 0:
        zones = _lowest(pulled)
    for done in range(_ROUNDS):
        fields = ZoneFields(*_with_ends(pulled, control, zones, tolerances, done < _PLAIN))
        if formal:
            return fields, None
        look = look_at(fields)
        found = _corrected(fields, look)
        if found is None:
            return fields, look
        zones = fitted(
            found, pulled.pulling.table, pulled.round, pulled.pulling.everywhere, pulled.corners
        )
        if len(zones) == 0:
            raise Lost
    raise NotConverged("the zones under a given tension did not settle")


def _with_ends(
    pulled: Pulled,
    control: Callable[[Pulled], Control],
    zones: Array,
    tolerances: Tolerances,
    plain: bool,
) -> tuple[Pulled, sie.AnyState]:
    """The ends of zones about these. Where narrow gaps close or open within an interval, their ends
    act on each other: the engine's own steps know how, where plain ones are not asked for or fail.
    """
    cornered = pulled.corners != (-np.inf, np.inf)
    if plain or cornered:
        try:
            return _settled(pulled, control, zones, tolerances)
        except NotConverged:
            if cornered:
                raise
    return _searched(pulled, control, zones, tolerances)


def _lowest(pulled: Pulled) -> Array:
    """A narrow zone about the lowest place of the deformed profile."""
    tension = pulled.pulling
    table = np.array([[0.0, tension.width]]) if tension.everywhere else tension.table
    x = table[:, :1] + np.diff(table, axis=1) * (np.arange(_SIGNS) + 0.5) / _SIGNS
    i, j = np.unravel_index(int(np.argmin(pulled.shape(x.ravel()))), x.shape)
    half = 0.5 * float(table[i, 1] - table[i, 0]) / _SIGNS
    return np.array([[x[i, j] - half, x[i, j] + half]])


def _settled(
    pulled: Pulled, control: Callable[[Pulled], Control], zones: Array, tolerances: Tolerances
) -> tuple[Pulled, sie.State]:
    """Newton on the ends of zones whose number is given, or falls; (the tension as these zones have
    it, the state).
    """
    first = np.diff(zones, axis=1)[:, 0]
    before: tuple[Array, Array] | None = None
    best, stuck = np.inf, 0

    def solved(zones: Array) -> tuple[Pulled, sie.State]:
        here = pulled.over(zones)
        try:
            return here, sie.solve_fixed(
                here.equation(control(here)),
                sie.Zones.of(zones, pulled.end, pulled.end),
                tolerances.density,
            )
        except sie.SingularSystem as failure:
            raise NotConverged(
                "zones under a given tension came too near to one another, or to its ends"
            ) from failure

    for _ in range(_STEPS):
        here, state = solved(zones)
        k, slope = np.array(state.density.intensities), edge_slopes(here, state)
        width, (room, shared) = np.diff(zones, axis=1)[:, 0], _room(pulled, zones)
        held, rests = _held(here, zones, k)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.where(slope > 0, 2 * k / slope, np.copysign(np.inf, k))
        if before is not None and len(before[0]) == len(zones):
            # An end that has gone too far, and nearly as far as it was off, is between its last two
            # places.
            back = np.array([zones[:, 0] - before[0][:, 0], before[0][:, 1] - zones[:, 1]])
            turned = (k * before[1] < 0) & (np.abs(k) > _AS_FAR * np.abs(before[1])) & ~held
            step = np.where(turned, back * k / np.where(turned, k - before[1], 1.0), step)
        before = zones, k
        # Beside the end of an interval K goes with the root of the distance from there.
        alone = ~shared & np.isfinite(step) & (room > 0)
        own = np.where(alone, room, 1.0)
        near = np.clip(1 - np.where(alone, step, 0.0) / (2 * own), np.sqrt(_NEARER), 4.0)
        rooted = np.where(alone, own * (1 - near**2), step)
        step = np.where(np.abs(step) < 0.1 * room, step, rooted)
        step = np.where(held, np.where(rests, 0.0, _released(here, k, step)), step)
        least = np.minimum(width, np.where(shared | held, np.inf, np.maximum(room, 1e-300)))
        miss = float(np.abs(step / least).max())
        best, stuck = min(best, miss), stuck + 1 if miss > 0.5 * best else 0
        # Of narrow strips rounding leaves more.
        if miss < tolerances.ends or (stuck > 2 and miss < _ROUNDED):
            return here, state
        reaches = _reaches(here, zones, k, step, room, shared)
        # At a sharp corner nothing is covered, and the strip may be as narrow as it comes.
        covers = (
            ~shared
            & (room < _COVERED * width)
            & (step > 0.5 * room)
            & ~_beside_corners(here, zones)
        )
        if covers.any():
            i = interval_of(zones, pulled.pulling.table)
            ends = np.zeros((2, len(pulled.pulling.table)), dtype=bool)
            for side in (0, 1):
                ends[side, i[covers[side]]] = True
            raise Covered(ends.ravel())
        limit = np.minimum(_OUTWARD * width, np.where(shared, _INTO_GAP, 1 - _NEARER) * room)
        moved = np.where(reaches, room, np.clip(step, -_INWARD * width, limit))
        # Newton's steps square what is missed, and one more is taken.
        if float(np.abs(moved / least).max()) < tolerances.last and not reaches.any():
            return solved(_moved(here, zones, moved, reaches))
        lost = (width < _GONE * first) & ((step < -_INWARD * width) | (held & rests)).all(axis=0)
        if lost.any():
            if lost.all():
                raise Lost
            zones, first = zones[~lost], first[~lost]
            continue
        zones = _moved(here, zones, moved, reaches)
        zones, first = _joined(zones, first, step)
    raise NotConverged("the ends of zones under a given tension did not come to rest")


def _moved(pulled: Pulled, zones: Array, moved: Array, reaches: Mask) -> Array:
    """The zones with ends moved outward, those that reach a sharp corner up to it."""
    zones = zones + np.column_stack((-moved[0], moved[1]))
    return np.where(reaches.T, np.broadcast_to(pulled.corners, zones.shape), zones)


def edge_slopes(pulled: Pulled, state: sie.AnyState) -> Array:
    """A at the ends (2, Z) of p + s, of which K is told by a motion of the end: where the other end
    is held at a corner q has less.
    """
    slope, zones = np.array(state.density.edge_slopes), state.density.zones
    more = 2 * pulled.pulling.stress / np.pi / np.sqrt(2 * zones.half)
    for end, _ in pulled.pulling.spreads:
        slope[0 if end else 1, end] += more[end]
    return slope


def _held(pulled: Pulled, zones: Array, k: Array) -> tuple[Mask, Mask]:
    """Which ends (2, n) are at sharp corners, and which of these stay there: pressed on, or by
    rounding not.
    """
    held = (zones == np.array(pulled.corners)).T
    return held, held & (k >= -_PULLS * np.abs(k).max())


def _released(pulled: Pulled, k: Array, step: Array) -> Array:
    """Outward steps of ends that leave a corner: of a strip with the tension s that has -K, (pi K/2
    s)^2, where it is narrow.
    """
    stress = pulled.pulling.stress if len(pulled.pulling.table) else 0.0
    return (
        -((np.pi * k / (2 * stress)) ** 2)
        if stress
        else np.where(np.isfinite(step), -np.abs(step), step)
    )


def _beside_corners(pulled: Pulled, zones: Array) -> Mask:
    """Which ends (2, n) have a sharp corner next to them, not the end of an interval or nothing."""
    return np.asarray((_own(pulled, zones) == np.array(pulled.corners)).T)


def _reaches(
    pulled: Pulled, zones: Array, k: Array, step: Array, room: Array, shared: Mask
) -> Mask:
    """Which ends go up to the sharp corner that is next to them: of K the strip up to there takes 2
    s/pi times the root of its width.
    """
    lo, hi = pulled.corners
    if not np.isfinite(lo) or len(zones) == 0:
        return np.zeros(k.shape, dtype=bool)
    out, table, beside = (
        np.zeros(k.shape, dtype=bool),
        pulled.pulling.table,
        _beside_corners(pulled, zones),
    )
    for side, i, corner in ((0, 0, lo), (1, -1, hi)):
        if zones[i, side] != corner and not shared[side, i] and beside[side, i]:
            narrow = room[side, i] < _INWARD * (zones[i, 1] - zones[i, 0])
            part = 2 / np.pi * pulled.pulling.stress * np.sqrt(room[side, i]) if len(table) else 0.0
            out[side, i] = (
                narrow
                and step[side, i] > 0.0
                and (k[side, i] > part if part else step[side, i] > room[side, i])
            )
    return out


def _searched(
    pulled: Pulled, control: Callable[[Pulled], Control], zones: Array, tolerances: Tolerances
) -> tuple[Pulled, sie.AnyState]:
    """The same by the engine's search, of zones that stay within their intervals."""
    equation = pulled.equation(control(pulled))
    for _ in range(_ROUNDS):
        free = sie.find_ends(equation, sie.Zones.of(zones, pulled.end, pulled.end), 1e-10)
        ended = free.density.zones.table
        if len(free.lost):
            if len(free.lost) == len(ended):
                raise Lost
            zones = np.delete(ended, free.lost, axis=0)
        elif len(free.met):
            zones = joined_where(ended, np.isin(np.arange(len(ended) - 1), free.met))
        else:
            own = _own(pulled, ended)
            within = bool(np.all((ended[:, 0] > own[:, 0]) & (ended[:, 1] < own[:, 1])))
            return (
                (pulled, free.state)
                if free.converged and within
                else _settled(pulled, control, zones, tolerances)
            )
    raise NotConverged("the number of zones under a given tension did not settle")


def _room(pulled: Pulled, zones: Array) -> tuple[Array, Mask]:
    """(how far each end (2, n) is from what is next to it, whether that is another zone: else the
    end of its interval).
    """
    right = np.diff(gaps_between(zones, pulled.round))[:, 0]
    beside, own = np.array([np.roll(right, 1), right]), _own(pulled, zones)
    away = np.array([zones[:, 0] - own[:, 0], own[:, 1] - zones[:, 1]])
    return np.minimum(beside, away), beside <= away


def _own(pulled: Pulled, zones: Array) -> Array:
    """The interval of tension that each zone lies in (n, 2), or what is between sharp corners."""
    table = pulled.pulling.table
    return (
        table[interval_of(zones, table)]
        if len(table)
        else np.broadcast_to(pulled.corners, zones.shape)
    )


def _joined(zones: Array, first: Array, step: Array) -> tuple[Array, Array]:
    """Zones between which nothing is left as one."""
    gap = zones[1:, 0] - zones[:-1, 1]
    width = np.diff(zones, axis=1)[:, 0]
    meets = (
        (gap < _GONE * np.minimum(width[1:], width[:-1]))
        & (step[1, :-1] > 0.3 * gap)
        & (step[0, 1:] > 0.3 * gap)
    )
    return joined_where(zones, meets), first[np.append(True, ~meets)]


def look_at(fields: ZoneFields) -> tuple[Array, Array]:
    """(places without contact, the gap there)."""
    pulled = fields.problem
    assert isinstance(pulled, Pulled)
    return looked(fields.formal_gap, look_around(pulled, fields.density.zones.table))


def looked(gap: Callable[[Array], Array], x: Array) -> tuple[Array, Array]:
    """(places, the gap there), those of its extremes among them, as parabolas have them: what
    begins there begins without width.
    """
    order = np.argsort(x)
    x, value = x[order], gap(x[order])
    for _ in range(_CLOSER):
        a, b, c = x[:-2], x[1:-1], x[2:]
        left, right = (value[1:-1] - value[:-2]) / (b - a), (value[2:] - value[1:-1]) / (c - b)
        turns = (left * right <= 0.0) & (left != right)
        with np.errstate(divide="ignore", invalid="ignore"):
            top = 0.5 * (a + b) - left * 0.5 * (c - a) / (right - left)
        top = top[turns & (top > a) & (top < c)]
        top = np.unique(top[~np.isin(top, x)])
        if len(top) == 0:
            break
        x, value = np.concatenate((x, top)), np.concatenate((value, gap(top)))
        order = np.argsort(x)
        x, value = x[order], value[order]
    return x, value


def look_around(pulled: Pulled, zones: Array) -> Array:
    """Places without contact, closer beside the ends of the zones and of the tension."""
    table, period = pulled.pulling.table, pulled.round
    lo, hi = (
        np.maximum(pulled.borders[0], pulled.corners[0]),
        np.minimum(pulled.borders[1], pulled.corners[1]),
    )
    both = np.concatenate((table.ravel(), zones.ravel()))
    if period is not None:
        marks = np.concatenate((table.ravel(), table.ravel() + period, table.ravel() - period))
        first = both[0] if len(both) else 0.0
        edges = gaps_between(zones, period) if len(zones) else np.array([[first, first + period]])
    else:
        span = float(both.max() - both.min())
        marks = np.concatenate(
            (table.ravel(), both.min() - span * _CUTS, both.max() + span * _CUTS)
        )
        left, right = max(lo, both.min() - _FAR * span), min(hi, both.max() + _FAR * span)
        edges = np.column_stack((np.append(left, zones[:, 1]), np.append(zones[:, 0], right)))
        edges = edges[edges[:, 0] < edges[:, 1]]
    found = []
    for begin, end in edges.tolist():
        cuts = [begin, *np.sort(marks[(marks > begin) & (marks < end)]).tolist(), end]
        found += [
            places(a, b, 0.25 * pulled.detail) for a, b in zip(cuts[:-1], cuts[1:], strict=True)
        ]
    kinks = pulled.forcing.kinks[0]
    if period is not None and len(kinks):
        kinks = np.concatenate((kinks - period, kinks, kinks + period))
    held = [kinks[(kinks > a) & (kinks < b)] for a, b in edges]
    # A body is lowest at its corners, or not.
    free = [
        corner for corner in pulled.corners if np.isfinite(corner) and not np.any(zones == corner)
    ]
    return np.unique(np.concatenate((np.zeros(0), *found, *held, free)))


def _looked_closer(
    fields: ZoneFields, zone: int, place: Array, q: Array, least: float
) -> tuple[Array, Array]:
    """Samples of q on a zone, and more of them about minima that may lie below the least."""
    density, zones = fields.density, fields.density.zones
    for _ in range(_CLOSER):
        inner = np.flatnonzero((q >= least) & (reaches(-q) > 0.0))
        inner = inner[(inner > 0) & (inner < len(q) - 1)]
        if len(inner) == 0:
            break
        x = np.concatenate([place[i - 1] + (place[i + 1] - place[i - 1]) * _BETWEEN for i in inner])
        x = np.unique(x[~np.isin(x, place)])
        left, right = (x - zones.a[zone]) / zones.half[zone], (zones.b[zone] - x) / zones.half[zone]
        more = fields.problem.bearing(density, np.full(len(x), zone), left, right) / np.sqrt(
            left * right
        )
        order = np.argsort(np.concatenate((place, x)), kind="stable")
        place, q = np.concatenate((place, x))[order], np.concatenate((q, more))[order]
    return place, q


def _by_zone(values: Array, counts: Index) -> list[Array]:
    return np.split(values, np.cumsum(counts)[:-1])


def signs_hold(fields: ZoneFields, look: tuple[Array, Array]) -> bool:
    """Whether q presses on all zones and the surfaces overlap nowhere within the tension."""
    return _corrected(fields, look) is None


def _corrected(fields: ZoneFields, look: tuple[Array, Array]) -> Array | None:
    """Zones with pulling parts cut out and new ones where the surfaces overlap; None where there
    are no such places.
    """
    assert isinstance(fields.problem, Pulled)
    density, (x, gap) = fields.density, look
    zones, out, changed = density.zones, [], False
    varies = fields.spacing if fields.problem.profile.resolution is not None else np.inf
    # Beside the ends, where the tension bends it sharply, q does not change its sign.
    counts = np.minimum(
        density.sampling, np.maximum(_SIGNS, 8 * zones.half / varies).astype(np.intp)
    )
    at = [(np.arange(n) + 0.5) * np.pi / n for n in counts]
    theta, zone = np.concatenate(at), np.repeat(np.arange(len(zones)), counts)
    left, right = sides(theta)
    borne = fields.problem.bearing(density, zone, left, right) / np.sqrt(left * right)
    for i, (q, far) in enumerate(zip(_by_zone(borne, counts), _by_zone(left, counts), strict=True)):
        q, place = q[::-1], zones.a[i] + zones.half[i] * far[::-1]
        begin, least = float(zones.a[i]), -_PULLS * np.abs(q).max()
        place, q = _looked_closer(fields, int(i), place, q, least)
        for s, e in runs_of(q < least):
            changed = True
            if s > 0:
                out.append((begin, float(0.5 * (place[s] + place[s - 1]))))
            begin = float(0.5 * (place[e] + place[e + 1])) if e < len(q) - 1 else np.inf
        if np.isfinite(begin):
            out.append((begin, float(zones.b[i])))
    rounding = fields.gap_rounding + 2 * float(np.abs(fields.formal_gap(zones.middle)).max())
    free, tension = ~density.locate(x)[2], fields.problem.pulling
    if len(tension.table):
        # Beyond the intervals of tension it is for these to grow first.
        free &= tension.holds(x)
    for s, e in runs_of((gap < -rounding) & free):
        lo, hi = x[max(s - 1, 0)], x[min(e + 1, len(x) - 1)]
        if (s == 0 or lo in zones.table) and (e == len(x) - 1 or hi in zones.table):
            continue
        middle, half = 0.5 * (x[s] + x[e]), 0.5 * _NEW * max(x[e] - x[s], 0.2 * (hi - lo))
        # At a sharp corner it begins there.
        middle += (
            half
            if x[s] == fields.problem.corners[0]
            else -half
            if x[e] == fields.problem.corners[1]
            else 0.0
        )
        out.append(
            (
                float(max(middle - half, fields.problem.corners[0])),
                float(min(middle + half, fields.problem.corners[1])),
            )
        )
        changed = True
    if not changed:
        return None
    found = np.array(sorted(out)).reshape(-1, 2)
    return joined_where(found, found[1:, 0] <= found[:-1, 1])
