"""What was checked of a solution: signs of pressure and gap over the whole line, balance of load,
one approach.

The pressure is sampled on every zone, divided by its square-root ends so that it is positive up to
them; the gap is sampled between the zones, closer near their ends, and its minima are followed
below the sampling. Next to an end the sign of the gap is that of the pressure's slope A there,
since gap ~ (4 A / 3) d^(3/2) / (E*/2).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

import sie
from contact.formulation.controls import Control
from contact.formulation.fields import ZoneFields
from contact.formulation.full_contact import NARROWEST
from contact.formulation.quadrature import chebyshev_nodes, sides
from contact.formulation.tables import runs_of
from contact.model.parts import Told
from contact.verify.minima import SAMPLING, Signs, lowest, signs_on
from contact.verify.tolerances import TOLERANCES
from sie import Array, Index, Mask, record

# Distances from a concave kink over the half width of its zone, at which the pressure is sampled.
_KINK_DISTANCES = np.geomspace(NARROWEST, 0.1, SAMPLING.kink_distances)


def _thinned() -> Array:
    """The least number of points in (0, 1), but in the middle every second one."""
    every, second = (
        np.sin(0.5 * np.pi * (np.arange(n) + 0.5) / n) ** 2
        for n in (SAMPLING.min_gap_points, SAMPLING.min_gap_points // 2)
    )
    beside = np.minimum(every, 1 - every) < SAMPLING.dense_part
    return np.asarray(
        np.sort(
            np.concatenate(
                (every[beside], second[np.minimum(second, 1 - second) >= SAMPLING.dense_part])
            )
        )
    )


_THINNED = _thinned()


@dataclass(frozen=True)
class Certificate:
    """smallest_pressure: over the zones, p / sqrt(1 - t^2) [Pa]. smallest_edge: least edge slope
    over its scale. smallest_gap: between the zones [m]. load_balance: relative. level_spread:
    largest difference of the zones' approaches [m]. points: how many were looked at. dip: least
    minimum of p / sqrt(1 - t^2) inside a zone over its largest value there, inf if there is none.
    undecided: a gap within `gap_rounding` of zero, or a dip within rounding of it: whether there is
    contact in that place is below what double precision tells. moment_balance: relative to the load
    times the farthest end of a zone; None where no moment is given. intensity: largest miss at an
    end, over what the law asks for; stability: least eigenvalue of the second variation of the
    energy by the motions of the ends, over twice the work of adhesion and at equal motions over
    roots of the widths, at the control held: positive where the contact is locally stable, infinite
    where all ends are held at sharp corners; both None under laws without. negative, overlaps:
    where signs fail, scaled (n, 2); lowest: scaled places, values and second differences of the
    gap's minima (n, 3), see `minima.lowest`.
    """

    smallest_pressure: float
    smallest_gap: float | None
    points: int
    holds: bool
    gap_rounding: float = 0.0
    load_balance: float = 0.0
    level_spread: float = 0.0
    undecided: bool = False
    note: str = ""
    dip: float = np.inf
    moment_balance: float | None = None
    intensity: float | None = None
    stability: float | None = None
    negative: Array = field(default_factory=lambda: np.zeros((0, 2)), repr=False)
    overlaps: Array = field(default_factory=lambda: np.zeros((0, 2)), repr=False)
    lowest: Array = field(default_factory=lambda: np.zeros((0, 3)), repr=False)

    def to_dict(self) -> dict[str, Any]:
        names = (
            "holds",
            "undecided",
            "smallest_pressure",
            "smallest_gap",
            "gap_rounding",
            "load_balance",
            "level_spread",
            "points",
            "note",
        )
        found = {name: getattr(self, name) for name in names}
        further = {
            name: getattr(self, name) for name in ("moment_balance", "intensity", "stability")
        }
        return {**found, **{name: value for name, value in further.items() if value is not None}}


NOT_CHECKED = Certificate(
    np.nan,
    None,
    0,
    False,
    0.0,
    np.nan,
    np.nan,
    note="a formal solution: its signs were not checked",
)


def _allowed_gap(fields: ZoneFields) -> float:
    """Largest scaled gap on the zones that the error of the density explains, with a margin."""
    state, zones = fields.state, fields.density.zones
    moved = state.density_error * state.size * float((zones.b - zones.a).sum())
    return (
        TOLERANCES.gap_margin * (moved + fields.gap_rounding)
        + TOLERANCES.shape_mismatch * fields.largest_shape
    )


class Openings(NamedTuple):
    """Between the zones, scaled: the least gap, where surfaces overlap (n, 2), rounding of the gap,
    how many points were looked at; its minima; and what the gap comes to on the zones, where it is
    zero.
    """

    least: float | None
    overlaps: Array
    rounding: float
    points: int
    lowest: Array
    on_zones: float


def openings(fields: ZoneFields, few: float = 0.0) -> Openings:
    """The gap, looked at everywhere. few: part of the zones that tell nothing of its error, since
    their ends are not known.
    """
    zones = fields.density.zones
    # There the gap is zero: what it comes to is known of it no better anywhere.
    places = (zones.middle[:, None] + zones.half[:, None] * chebyshev_nodes(4)).ravel()
    on_zones = float(np.quantile(np.abs(fields.formal_gap(places)), 1.0 - few))
    return Openings(*_gaps(fields, fields.gap_rounding + 2 * on_zones), on_zones)


def certify(
    fields: ZoneFields, load: float | None, held: Control | None = None, few: float = 0.0
) -> Certificate:
    """Check the solution everywhere; `negative` and `overlaps` are the scaled intervals where it
    fails. held: the control under which the contact has to be stable, where there are several
    equilibria, the load if left out; under a half width it need not be. few: see `openings`.
    """
    law = fields.problem.law
    signs = _pressures(fields)
    pulls, least, dip, (valleys, left_out) = (
        signs.negative,
        signs.least,
        signs.dip,
        _valleys(fields),
    )
    if law.pressure_range.has_tension:
        pulls, valleys, left_out, dip = [], [], 0, np.inf
    new = [row for row in valleys if not any(lo < row[1] and row[0] < hi for lo, hi in pulls)]
    pressures = np.array(sorted([*pulls, *new])).reshape(-1, 2)
    gaps, overlaps, rounding, outside, minima, on_zones = openings(fields, few)
    units = fields.problem.units
    density = fields.density
    size = fields.load_size if law.pressure_range.has_tension else fields.problem.borne(density)
    balance = 0.0 if load is None else abs(density.total - load) / max(abs(load), size)
    turned = _moment_balance(fields)
    spread = float(np.ptp(fields.levels)) * units.height
    undecided = (gaps is not None and -rounding <= gaps <= 0.0) or (
        dip <= TOLERANCES.dip_rounding and len(pressures) == 0
    )
    holds = (
        (least > 0 or law.pressure_range.has_tension)
        and len(new) == 0
        and len(overlaps) == 0
        and balance < TOLERANCES.balance
        and (turned is None or turned < TOLERANCES.balance)
    )
    note = unresolved_gaps_note(left_out, "their zones") if left_out else ""
    if not on_zones <= _allowed_gap(fields):
        holds = False
        note = (
            f"on the zones, where it is zero, the gap comes to {on_zones * units.height:.1e} m: "
            "height and slope do not go together"
        )
    missed = stability = None
    if law.equilibria.several:
        missed = _missed(fields)
        name = "load" if held is None else held.name
        if held is None or held.half_width is None:
            stability = least_eigenvalue(
                fields.second_variation(None if held is None else held.yields)
            )
        if missed > TOLERANCES.edge_condition * max(1.0, fields.bending):
            holds, note = False, f"an end misses its intensity by {missed:.1e}"
        elif stability is not None and not stability > 0.0:
            holds, note = (
                False,
                f"not stable under a held {name}: the second variation of the energy is not "
                "positive",
            )
        else:
            told = (
                "its ends are given" if stability is None else f"locally stable under a held {name}"
            )
            told = "all ends are held at sharp corners" if stability == np.inf else told
            note = (
                "one of several equilibria: intensities at the ends, no overlap, balance, "
                f"{told}{'; ' + note if note else ''}"
            )
    broken = Told("law.fault(fields, load)", "law").text(law.fault, fields, load)
    if broken:
        holds, note = False, f"{law.name}: {broken}"
    return Certificate(
        smallest_pressure=least * units.pressure,
        smallest_gap=None if gaps is None else gaps * units.height,
        gap_rounding=rounding * units.height,
        load_balance=balance,
        level_spread=spread,
        points=signs.points + outside,
        holds=bool(holds),
        undecided=bool(undecided) or left_out > 0,
        note=note,
        dip=dip,
        moment_balance=turned,
        intensity=missed,
        stability=stability,
        negative=pressures,
        overlaps=overlaps,
        lowest=minima,
    )


def unresolved_gaps_note(gaps: int, over: str) -> str:
    return f"{gaps} gaps over kinks are left out: narrower than {2 * NARROWEST:.0e} of {over}"


def _missed(fields: ZoneFields) -> float:
    """Largest miss of the intensity that the law asks for at the ends, over it; where one is held,
    of what it asks for at the least.
    """
    wanted, zones = fields.problem.end.intensity, fields.density.zones
    assert wanted
    missed = np.array(fields.density.intensities) / wanted - 1.0
    given = np.array(
        [[end.intensity is not None for end in ends] for ends in (zones.left, zones.right)]
    )
    return float(np.where(given, np.abs(missed), missed).max(initial=0.0))


def least_eigenvalue(matrix: Array) -> float:
    """Of its symmetric part: a second variation is symmetric but for rounding. Infinite where
    nothing moves.
    """
    return float(np.linalg.eigvalsh(0.5 * (matrix + matrix.T)).min(initial=np.inf))


def _moment_balance(fields: ZoneFields) -> float | None:
    """What the moment is off, over the load times the farthest end of a zone; None where none is
    given.
    """
    given = fields.problem.moment
    if given is None:
        return None
    zones, lever = fields.density.zones, fields.problem.units.lever
    reach = max(abs(lever + zones.a[0]), abs(lever + zones.b[-1]))
    return float(abs(fields.scaled_moment - given) / (fields.density.total * reach))


def _pressures(fields: ZoneFields) -> Signs:
    """p / sqrt(1 - t^2) on the zones, in scaled units."""
    density, noise = fields.density, fields.state.noise

    def over_root(zone: Index, angle: Array) -> Array:
        left, right = sides(angle)
        return np.asarray(
            fields.problem.bearing(density, zone, left, right) / np.sqrt(left * right)
        )

    def sampled(group: Index, theta: Array) -> tuple[Array, Array, Array]:
        value = over_root(group[:, None], theta)
        finite = np.isfinite(value)
        scale = np.abs(np.where(finite, value, 0.0)).max(axis=1)
        return (
            np.where(finite, value, np.inf),
            scale * np.clip(2 * noise[group], TOLERANCES.dip_rounding, 1e-6),
            scale,
        )

    return signs_on(density.zones, density.sampling, sampled, over_root)


def _valleys(fields: ZoneFields) -> tuple[list[tuple[float, float]], int]:
    """(where the pressure is negative about valleys with a kink; how many of these have it narrower
    than can be told).

    With J < 0 the jump of f', the pressure goes to minus infinity as (E* |J| / 2 pi) ln(distance):
    there is a gap, however narrow.
    """
    density, forcing = fields.density, fields.problem.forcing
    kinks, heights = forcing.kinks
    at, zone, inside = density.locate(kinks[heights < 0])
    found: list[tuple[float, float]] = []
    left_out = 0
    for x, i in zip(at[inside], zone[inside], strict=True):
        half = density.zones.half[i]
        left, right = (x - density.zones.a[i]) / half, (density.zones.b[i] - x) / half
        away = np.concatenate((-_KINK_DISTANCES, _KINK_DISTANCES))
        away = away[(away > -left) & (away < right)]
        pulls = away[density.at(np.full(len(away), i), left + away, right - away) < 0]
        if len(pulls) == 0:
            left_out += 1
        else:
            reach = float(np.abs(pulls).max()) * half
            found.append((x - reach, x + reach))
    return found, left_out


def _gaps(fields: ZoneFields, rounding: float) -> tuple[float | None, Array, float, int, Array]:
    """(smallest gap found, intervals of overlap, rounding of the gap, points, minima), scaled: the
    points of all gaps at once, and only minima followed that may touch zero.

    Levels that are tied from neighbour to neighbour drift by rounding along a long row of zones.
    Far from all zones a turned or a lopsided body may touch as well: samples are not even there,
    and all minima are followed.
    """
    open_ = list(fields.open_intervals())
    intervals, near = [(lo, hi) for lo, hi, _, _ in open_], len(open_)
    places_of = _looked_at(fields, open_)
    for x in fields.far_stretches():
        intervals.append((float(x[0]), float(x[-1])))
        places_of.append(x)
    points = np.concatenate([np.zeros(0), *places_of])
    place = np.repeat(np.arange(len(intervals)), [len(x) for x in places_of])
    with np.errstate(over="ignore", invalid="ignore"):
        gap = _finite(fields.formal_gap(points))
        bend = gap[:-2] - 2 * gap[1:-1] + gap[2:]
        low = (gap[1:-1] <= gap[:-2]) & (gap[1:-1] <= gap[2:]) & (place[:-2] == place[2:])
        inner = np.flatnonzero(low & ((gap[1:-1] < bend) | (place[1:-1] >= near))) + 1
    minima = lowest(points, gap, np.flatnonzero(low & (gap[1:-1] > rounding)) + 1)
    lo, hi, found, values, places = points[inner - 1], points[inner + 1], [points], [gap], [place]
    for _ in range(SAMPLING.zooms if len(inner) else 0):
        fine = lo[:, None] + (hi - lo)[:, None] * np.linspace(0, 1, 9)
        with np.errstate(over="ignore", invalid="ignore"):
            value = _finite(fields.formal_gap(fine.ravel())).reshape(fine.shape)
        best = np.clip(np.argmin(value, axis=1), 1, 7)
        rows = np.arange(len(best))
        lo, hi = fine[rows, best - 1], fine[rows, best + 1]
        found.append(fine.ravel())
        values.append(value.ravel())
        places.append(np.repeat(place[inner], 9))
    x, gap, place = np.concatenate(found), np.concatenate(values), np.concatenate(places)
    order = np.lexsort((x, place))
    x, gap, place = x[order], gap[order], place[order]
    bad: list[tuple[float, float]] = []
    fails = gap < -rounding
    for i in np.unique(place[fails]):
        here = np.flatnonzero(place == i)
        bad += _overlaps(x[here], fails[here], *intervals[i])
    seen = gap[~_closing(gap, place, rounding) & (place < near)]
    smallest = float(seen.min()) if np.isfinite(seen).any() else None
    return smallest, np.array(bad).reshape(-1, 2), rounding, len(points), minima


def _closing(gap: Array, place: Index, rounding: float) -> Mask:
    """Samples, by interval and from left to right, that lie between the end of a zone and the first
    one where the gap is above its rounding: there it closes as d^(3/2), and its sign is that of the
    pressure's slope.
    """
    index, first_of = np.arange(len(gap)), np.flatnonzero(np.diff(place, prepend=-1))
    number = np.repeat(np.arange(len(first_of)), np.diff(first_of, append=len(gap)))
    open_ = gap > rounding
    first = np.minimum.reduceat(np.where(open_, index, len(gap)), first_of)[number]
    last = np.maximum.reduceat(np.where(open_, index, -1), first_of)[number]
    return np.asarray((np.abs(gap) <= rounding) & (last >= 0) & ((index < first) | (index > last)))


def _finite(gap: Array) -> Array:
    return np.where(np.isfinite(gap), gap, np.inf)


def _overlaps(x: Array, fails: Mask, lo: float, hi: float) -> list[tuple[float, float]]:
    """From the last good sample to the next one, for every run of bad samples in (lo, hi)."""
    return [
        (
            float(x[max(s - 1, 0)]) if s else lo,
            float(x[min(e + 1, len(x) - 1)]) if e < len(x) - 1 else hi,
        )
        for s, e in runs_of(fails)
    ]


def _looked_at(fields: ZoneFields, intervals: list[tuple[float, float, bool, bool]]) -> list[Array]:
    """Points in each of these: in gaps between zones without a tip that ask for no more than the
    least number, all at once.
    """
    if not intervals:
        return []
    lo, hi = np.array([row[:2] for row in intervals]).T
    between = np.array([row[2] and row[3] for row in intervals])
    tips = np.searchsorted(fields.tips, hi, side="left") > np.searchsorted(
        fields.tips, lo, side="right"
    )
    plain = between & ~tips & (4 * (hi - lo) / fields.spacing <= SAMPLING.min_gap_points // 2)
    x = np.clip(
        lo[plain, None] + (hi - lo)[plain, None] * _THINNED, lo[plain, None], hi[plain, None]
    )
    # Of gaps as narrow as rounding some are the same.
    differ = np.diff(x, axis=1, prepend=-np.inf) > 0
    every = differ.all(axis=1)
    rows = iter(
        [row if whole else row[some] for row, whole, some in zip(x, every, differ, strict=True)]
    )
    return [
        next(rows) if alike else _between(*row[:2], fields, *row[2:])
        for row, alike in zip(intervals, plain, strict=True)
    ]


def _between(lo: float, hi: float, fields: ZoneFields, left_zone: bool, right_zone: bool) -> Array:
    """Points in (lo, hi), evenly at least as close as the fields' spacing asks for, quadratically
    closer next to zones; tips among them, and the limit of what is looked at: the body may touch
    right there. Between zones no more than the spacing asks for, if that is less than the least
    number, but beside their ends.
    """
    known = fields.problem.profile.resolution is not None and (
        fields.is_bounded or (left_zone and right_zone)
    )
    asked = 4 * (hi - lo) / fields.spacing
    n = int(
        np.clip(
            asked,
            SAMPLING.min_gap_points,
            SAMPLING.max_gap_points if known else SAMPLING.max_guessed_points,
        )
    )
    s = (np.arange(n) + 0.5) / n
    if left_zone and right_zone:
        s = _THINNED if asked <= SAMPLING.min_gap_points // 2 else np.sin(0.5 * np.pi * s) ** 2
    elif left_zone:
        s = np.append(s * s, 1.0)
    elif right_zone:
        s = np.append(0.0, 1 - (1 - s) ** 2)
    x = np.clip(lo + (hi - lo) * s, lo, hi)
    tips = fields.tips
    # One at the end of a zone is in contact.
    first, last = np.searchsorted(tips, lo, side="right"), np.searchsorted(tips, hi, side="left")
    return np.unique(np.concatenate((x, tips[first:last]))) if last > first else x


@record
class Solved:
    """free: the Newton result. fields: under the load that the intervals have. rounds: corrections
    it took. tolerance: of the ends. off: how far the control may have been missed, in what the
    formulation says; of all intervals, or of each end (n, 2).
    """

    free: sie.Free
    fields: Any
    certificate: Certificate
    rounds: int
    control: Control
    tolerance: float = 0.0
    off: float | Array = 0.0

    @property
    def error(self) -> float:
        """Bound of the errors of the pressure and of the zones' ends: see `Solution.error`."""
        raise NotImplementedError
