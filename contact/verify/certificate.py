"""`Certificate`: signs of pressure and gap on the whole line, load balance, equal approaches.

In every zone the pressure p is sampled after division by sqrt(1 - t^2), with the normalised
position t from -1 to 1. This quotient is positive up to the ends. The gap is sampled between the
zones, more closely near their ends, and its minima are followed between samples. The edge slope A
is the coefficient of sqrt(d) in the pressure at the distance d inside an end. At a small distance d
outside the end, the gap is (2 A / 3) d^(3/2) / (E*/2), so that it has the sign of A.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

import sie
from contact.formulation.controls import Control
from contact.formulation.fields import ZoneFields
from contact.formulation.quadrature import chebyshev_nodes, sides
from contact.formulation.tables import runs_of
from contact.formulation.tolerances import TOLERANCES, allowed_overlap
from contact.model.units import counted
from contact.verify.minima import SAMPLING, Signs, lowest, signs_on, zoomed
from sie import Array, Index, Mask, record


def _places(count: int) -> Array:
    """Sample positions in (0, 1), closer together near both ends, where contact is more likely."""
    return np.asarray(np.sin(0.5 * np.pi * (np.arange(count) + 0.5) / count) ** 2)


_FEW_PLACES = _places(SAMPLING.min_points)


@dataclass(frozen=True)
class Certificate:
    """The results of all checks of a solution, with the values that the checks found.

    smallest_pressure: least value of p / sqrt(1 - t^2) on the zones [Pa], with the pressure p and
    the normalised position t in a zone, from -1 to 1. smallest_gap: least minimum of the gap
    between the zones [m], negative if surfaces overlap, 0 if the gap has no minimum. points: number
    of samples. holds: whether all checks pass. gap_rounding: effect of rounding on the gap [m].
    load_balance: relative error of the load. level_spread: largest difference of the zones'
    approaches [m]. undecided: whether a gap, or a minimum of the pressure, is zero within rounding,
    so that double precision cannot decide whether there is contact. note: the checks that hold or
    fail, in words. dip: least minimum of p / sqrt(1 - t^2) inside a zone, divided by the largest
    value in that zone; inf if there is no minimum. moment_balance: error of the moment, divided by
    the load times the largest lever arm of a zone's end; None if no moment is given.

    smallest_overlap: least overlap of the surfaces on plateaus [m]; None without plateaus.

    intensity: largest relative error of the edge intensities, the factors of 1/sqrt(distance) in
    the pressure at the ends. stability: least eigenvalue of the second variation of the energy for
    motions of the ends under the given control. It is divided by twice the work of adhesion and
    scaled by the square roots of the zones' widths. It is positive if the contact is locally
    stable, and infinite if all ends are fixed at sharp corners. Both, intensity and stability, are
    None under laws with one equilibrium.

    negative, overlaps: scaled intervals (n, 2) in which the pressure (the gap) is negative. lowest:
    scaled places, values and half second derivatives of the gap's minima (n, 3), see
    `minima.lowest`.
    """

    smallest_pressure: float
    smallest_gap: float | None
    holds: bool
    points: int = 0
    gap_rounding: float = 0.0
    load_balance: float = 0.0
    level_spread: float = 0.0
    undecided: bool = False
    note: str = ""
    dip: float = np.inf
    moment_balance: float | None = None
    intensity: float | None = None
    stability: float | None = None
    smallest_overlap: float | None = None
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
            name: getattr(self, name)
            for name in ("moment_balance", "intensity", "stability", "smallest_overlap")
        }
        return {**found, **{name: value for name, value in further.items() if value is not None}}


NOT_CHECKED = Certificate(
    smallest_pressure=np.nan,
    smallest_gap=None,
    holds=False,
    load_balance=np.nan,
    level_spread=np.nan,
    note="a formal solution: the signs of pressure and gap were not checked",
)


def _allowed_gap(fields: ZoneFields) -> float:
    """Bound of the scaled gap computed on the zones, where the exact gap is zero.
    It allows for the error of the density (the scaled pressure), with a safety factor.
    """
    state, zones = fields.state, fields.density.zones
    moved = state.density_error * state.size * float((zones.b - zones.a).sum())
    return (
        TOLERANCES.gap_margin * (moved + fields.gap_rounding)
        + TOLERANCES.noise * fields.largest_shape
    )


class Openings(NamedTuple):
    """The results of sampling the scaled gap outside the zones.

    least: smallest sampled gap. overlaps: intervals where the gap is negative (n, 2). rounding:
    effect of rounding on the gap. points: number of samples. lowest: minima of the gap. on_zones:
    size of the computed gap on the zones, where the exact gap is zero.
    """

    least: float | None
    overlaps: Array
    rounding: float
    points: int
    lowest: Array
    on_zones: float


def openings(fields: ZoneFields, unresolved_fraction: float = 0.0) -> Openings:
    """The results of sampling the scaled gap on the whole line outside the zones.

    unresolved_fraction: fraction of the zones whose ends are not converged. As large a fraction of
    the places on the zones, those with the largest gaps, does not count for `on_zones`.
    """
    zones = fields.density.zones
    # The exact gap on the zones is zero, so the gap computed there measures the error of all gaps.
    # A rim is a zone at whose two ends the pressure has different values. A very narrow rim is
    # computed with a larger width than its true one, and `depth` is not 0. Such rims are left out,
    # because the gap on them would measure the error of the rim's place.
    wide = np.flatnonzero(zones.depth == 0.0)
    places = (zones.middle[wide, None] + zones.half[wide, None] * chebyshev_nodes(4)).ravel()
    errors = np.abs(fields.formal_gap(places)) if len(places) else np.zeros(1)
    on_zones = float(np.quantile(errors, 1.0 - unresolved_fraction))
    rounding = fields.gap_rounding + allowed_overlap(on_zones=on_zones)
    return Openings(*_gaps(fields, rounding), on_zones)


def certify(
    fields: ZoneFields,
    load: float | None,
    control: Control | None = None,
    unresolved_fraction: float = 0.0,
    signs: Signs | None = None,
) -> Certificate:
    """Check the signs of pressure and gap on the whole line, and the load and moment.

    If a sign is wrong, `negative` or `overlaps` of the certificate is not empty. control: under
    laws with several equilibria, the contact must be stable under this control; None: the load.
    Under a given half width the contact need not be stable. unresolved_fraction: see `openings`.
    signs: the result of `pressure_signs`, if it is known.
    """
    law, units = fields.problem.law, fields.problem.units
    signs, (valleys, left_out) = signs or pressure_signs(fields), _valleys(fields)
    negative, dip = list(signs.negative), signs.dip
    if law.pressure_range.has_tension:
        negative, valleys, left_out, dip = [], [], 0, np.inf
    new = [row for row in valleys if not any(lo < row[1] and row[0] < hi for lo, hi in negative)]
    negative = sorted([*negative, *new])
    gaps = openings(fields, unresolved_fraction)
    balance = 0.0 if load is None else _load_balance(fields, load)
    turned = _moment_balance(fields)
    holds = (
        (signs.least > 0 or law.pressure_range.has_tension)
        and len(new) == 0
        and len(gaps.overlaps) == 0
        and max(balance, turned or 0.0) < TOLERANCES.balance
    )
    note = unresolved_gaps_note(left_out, "the width of the zone") if left_out else ""
    equilibrium = _equilibrium(fields, control) if law.equilibria.several else None
    # The gap on the zones is not tested in two cases. In a rough solution, errors of the ends
    # change the gap by more than the error of the pressure does. If signs are wrong, the search
    # continues with other zones, and the time for the error of the pressure would be lost.
    tested = not unresolved_fraction and not negative and len(gaps.overlaps) == 0
    if tested and not gaps.on_zones <= _allowed_gap(fields):
        holds = False
        note = (
            f"on the zones, where it must be zero, the gap is {gaps.on_zones * units.height:.1e} "
            "m: the height and the slope of the profile do not match"
        )
    if equilibrium is not None:
        note = equilibrium.fault or f"{equilibrium.note}{'; ' + note if note else ''}"
    undecided = (gaps.least is not None and -gaps.rounding <= gaps.least <= 0.0) or (
        dip <= TOLERANCES.rounding and not negative
    )
    return Certificate(
        smallest_pressure=signs.least * units.pressure,
        smallest_gap=None
        if gaps.least is None
        else least_minimum(gaps.least, gaps.lowest) * units.height,
        gap_rounding=gaps.rounding * units.height,
        load_balance=balance,
        level_spread=float(np.ptp(fields.levels)) * units.height,
        points=signs.points + gaps.points,
        holds=bool(holds and not (equilibrium and equilibrium.fault)),
        undecided=bool(undecided) or left_out > 0,
        note=note,
        dip=dip,
        moment_balance=turned,
        intensity=None if equilibrium is None else equilibrium.intensity,
        stability=None if equilibrium is None else equilibrium.stability,
        negative=np.array(negative).reshape(-1, 2),
        overlaps=gaps.overlaps,
        lowest=gaps.lowest,
    )


def least_minimum(least: float, minima: Array) -> float:
    """The least minimum of all gaps between their ends; 0 if all gaps are positive without minima.

    At the ends of zones every gap is zero. So the least sample `least` of a positive gap only shows
    how near to an end the samples lie. minima: see `lowest`.
    """
    if least <= 0.0:
        return least
    return max(least, float(minima[:, 1].min())) if len(minima) else 0.0


def _load_balance(fields: ZoneFields, load: float) -> float:
    """Error of the load, divided by the larger of the load and the force that the zones carry."""
    law, density = fields.problem.law, fields.density
    size = fields.load_size if law.pressure_range.has_tension else fields.problem.borne(density)
    return float(abs(density.total - load) / max(abs(load), size))


class _Equilibrium(NamedTuple):
    """Result of the check of an equilibrium: error of the edge intensities, and stability.
    An edge intensity is the factor of 1/sqrt(distance) in the pressure at an end.

    fault: the checks that fail, in words. note: the checks that hold.
    """

    intensity: float
    stability: float | None
    fault: str = ""
    note: str = ""


def _equilibrium(fields: ZoneFields, control: Control | None) -> _Equilibrium:
    """Check of the edge intensities and the stability, for laws with several equilibria."""
    error, stability = _intensity_error(fields), None
    name = "load" if control is None else control.name
    if control is None or control.half_width is None:
        compliance = None if control is None else control.compliance
        stability = least_eigenvalue(fields.second_variation(compliance))
    if error > TOLERANCES.edge_condition * max(1.0, fields.bending):
        return _Equilibrium(
            error,
            stability,
            f"the intensity at an end differs from that of the law by {error:.1e} of its value",
        )
    if stability is not None and not stability > 0.0:
        fault = (
            f"not stable under a given {name}: the second variation of the energy is not positive"
        )
        return _Equilibrium(error, stability, fault)
    if stability is None:
        kind = "the ends are given"
    elif stability == np.inf:
        kind = "all ends lie at sharp corners"
    else:
        kind = f"locally stable under a given {name}"
    note = (
        "one of several equilibria; checked: intensities at the ends, no overlap, balance of the "
        f"load; {kind}"
    )
    return _Equilibrium(error, stability, note=note)


def unresolved_gaps_note(gaps: int, over: str) -> str:
    width = 2 * TOLERANCES.narrowest_gap
    missing = counted(gaps, "gap over a kink is", "gaps over kinks are")
    return f"{missing} missing from the solution (narrower than {width:.0e} of {over})"


def _intensity_error(fields: ZoneFields) -> float:
    """Largest error of the edge intensity at the ends, divided by the intensity of the law.
    The edge intensity is the factor of 1/sqrt(distance) in the pressure near an end.

    At a fixed end, such as a sharp corner, the intensity may be above the law's negative value.
    """
    wanted, zones = fields.problem.end.intensity, fields.density.zones
    assert wanted
    errors = np.array(fields.density.intensities) / wanted - 1.0
    given = np.array(
        [[end.intensity is not None for end in ends] for ends in (zones.left, zones.right)]
    )
    return float(np.where(given, np.abs(errors), errors).max(initial=0.0))


def least_eigenvalue(matrix: Array) -> float:
    """Least eigenvalue of the symmetric part of a matrix; infinite if the matrix is empty.

    A second variation is symmetric up to rounding.
    """
    return float(np.linalg.eigvalsh(0.5 * (matrix + matrix.T)).min(initial=np.inf))


def _moment_balance(fields: ZoneFields) -> float | None:
    """Relative error of the moment; None if no moment is given.

    The error is divided by the load times the largest lever of an end of a zone.
    """
    given = fields.problem.moment
    if given is None:
        return None
    zones, lever = fields.density.zones, fields.problem.units.lever
    reach = max(abs(lever + zones.a[0]), abs(lever + zones.b[-1]))
    return float(abs(fields.scaled_moment - given) / (fields.density.total * reach))


def pressure_signs(
    fields: ZoneFields, limit: float | None = None, samples: dict[int, Array] | None = None
) -> Signs:
    """Signs of the scaled pressure divided by sqrt(1 - t^2), on all zones.
    t is the normalised position in a zone, from -1 to 1.

    limit: None, or the scaled limit of the pressure; then the signs are those of the difference
    limit - pressure. samples: None, or a dict that stores the sampled pressures, with the number of
    samples in a zone as the key. A second call with the same dict does not compute them again.
    """
    density, noise = fields.density, fields.state.noise
    stored = {} if samples is None else samples

    def divided(bearing: Array, left: Array, right: Array) -> Array:
        value = bearing if limit is None else limit - bearing
        return np.asarray(value / bounded_weight(density.zones, left, right))

    def over_root(zone: Index, angle: Array) -> Array:
        left, right = sides(angle)
        return divided(fields.problem.bearing(density, zone, left, right), left, right)

    def sampled(group: Index, theta: Array) -> tuple[Array, Array, Array]:
        left, right = sides(theta)
        if len(theta) not in stored:
            stored[len(theta)] = fields.problem.bearing(density, group[:, None], left, right)
        value = divided(stored[len(theta)], left, right)
        finite = np.isfinite(value)
        scale = np.abs(np.where(finite, value, 0.0)).max(axis=1)
        return (
            np.where(finite, value, np.inf),
            scale
            * np.clip(
                TOLERANCES.pressure_noise_multiple * noise[group],
                TOLERANCES.rounding,
                TOLERANCES.noise,
            ),
            scale,
        )

    return signs_on(density.zones, density.sampling, sampled, over_root)


def bounded_weight(zones: sie.Zones, left: Array, right: Array) -> Array:
    """Factor sqrt(1 - t^2) of a pressure that is 0 at both ends.
    With elastic mismatch (kappa) the exponents differ from 1/2.
    """
    if zones.weight.is_half:
        return np.asarray(np.sqrt(left * right))
    at_left, at_right = 1 - zones.weight.exponent[:, 0]
    return np.asarray(left**at_left * right**at_right)


def _valleys(fields: ZoneFields) -> tuple[list[tuple[float, float]], int]:
    """(intervals of negative pressure around concave kinks, number of unresolved gaps at kinks).

    At a jump J < 0 of the profile's slope f', the pressure tends to -inf as
    (E* |J| / 2 pi) ln(distance). So there must be a gap over the kink, however narrow. The gap is
    unresolved if the pressure is positive at all samples, down to the least distance from the kink.
    """
    density, forcing = fields.density, fields.problem.forcing
    kinks, heights = forcing.kinks
    at, zone, inside = density.locate(kinks[heights < 0])
    found: list[tuple[float, float]] = []
    left_out = 0
    distances = np.geomspace(TOLERANCES.narrowest_gap, 1.0, SAMPLING.min_points)
    for x, i in zip(at[inside], zone[inside], strict=True):
        half = density.zones.half[i]
        left, right = (x - density.zones.a[i]) / half, (density.zones.b[i] - x) / half
        away = np.concatenate((-distances, distances))
        away = away[(away > -left) & (away < right)]
        pulls = away[density.at(np.full(len(away), i), left + away, right - away) < 0]
        if len(pulls) == 0:
            left_out += 1
        else:
            reach = float(np.abs(pulls).max()) * half
            found.append((x - reach, x + reach))
    return found, left_out


def _gaps(fields: ZoneFields, rounding: float) -> tuple[float | None, Array, float, int, Array]:
    """Check the sign of the scaled gap on all intervals outside the zones.

    Returns the least gap, the intervals of overlap, the rounding, the number of points, and the
    minima (see `lowest`). rounding: a gap above -rounding is no overlap, because rounding adds up
    from gap to gap in a long row of zones. Only minima that may be below zero are located between
    samples. Far from all zones the samples are uneven and a turned body may touch again, so that
    all minima are located there.
    """
    open_ = list(fields.open_intervals())
    intervals, near = [(lo, hi) for lo, hi, _, _ in open_], len(open_)
    places_of = _samples_in(fields, open_)
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
    inside = place[inner]
    for _ in range(SAMPLING.max_zooms):
        if len(lo) == 0:
            break
        fine = lo[:, None] + (hi - lo)[:, None] * np.linspace(0, 1, 9)
        with np.errstate(over="ignore", invalid="ignore"):
            value = _finite(fields.formal_gap(fine.ravel())).reshape(fine.shape)
        found.append(fine.ravel())
        values.append(value.ravel())
        places.append(np.repeat(inside, 9))
        lo, hi, (inside,) = zoomed(fine, value, np.full(len(fine), rounding), (inside,))
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
    """Mask of samples next to zones at which the gap is round-off, up to the first open sample.
    A sample is open if its gap is clearly above round-off.

    Samples are sorted by interval and place. At a small distance d from a zone, the gap grows as
    d^(3/2). There it has the sign of the edge slope, the coefficient of sqrt(distance) in the
    pressure.
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
    """Intervals around runs of samples that fail, each up to the next samples that pass.
    If no sample passes on one side, the interval ends at `lo` or `hi`.
    """
    return [
        (
            float(x[max(s - 1, 0)]) if s else lo,
            float(x[min(e + 1, len(x) - 1)]) if e < len(x) - 1 else hi,
        )
        for s, e in runs_of(fails)
    ]


def _samples_in(
    fields: ZoneFields, intervals: list[tuple[float, float, bool, bool]]
) -> list[Array]:
    """Positions of the samples of the gap in each of the given intervals.

    Narrow gaps between two zones that contain no convex kink need only the smallest number of
    samples. The samples of all these gaps are computed together.
    """
    if not intervals:
        return []
    lo, hi = np.array([row[:2] for row in intervals]).T
    between = np.array([row[2] and row[3] for row in intervals])
    tips = np.searchsorted(fields.tips, hi, side="left") > np.searchsorted(
        fields.tips, lo, side="right"
    )
    plain = between & ~tips & (4 * (hi - lo) / fields.spacing <= SAMPLING.min_points)
    x = np.clip(
        lo[plain, None] + (hi - lo)[plain, None] * _FEW_PLACES, lo[plain, None], hi[plain, None]
    )
    # In gaps as narrow as round-off, some samples coincide. Only one of these samples is kept.
    differ = np.diff(x, axis=1, prepend=-np.inf) > 0
    every = differ.all(axis=1)
    rows = iter(
        [row if whole else row[some] for row, whole, some in zip(x, every, differ, strict=True)]
    )
    return [
        next(rows) if alike else _samples_between(*row[:2], fields, *row[2:])
        for row, alike in zip(intervals, plain, strict=True)
    ]


def _samples_between(
    lo: float, hi: float, fields: ZoneFields, left_zone: bool, right_zone: bool
) -> Array:
    """Positions of samples in (lo, hi): evenly spaced, but closer together towards zones.

    They include convex kinks and, if (lo, hi) does not end at a zone, its limit there. The body may
    touch exactly at these places.
    """
    known = fields.problem.profile.resolution is not None and (
        fields.is_bounded or (left_zone and right_zone)
    )
    asked = 4 * (hi - lo) / fields.spacing
    n = int(
        np.clip(
            asked,
            SAMPLING.min_points,
            SAMPLING.max_points if known else SAMPLING.max_guessed_points,
        )
    )
    s = (np.arange(n) + 0.5) / n
    if left_zone and right_zone:
        s = _places(n)
    elif left_zone:
        s = np.append(s * s, 1.0)
    elif right_zone:
        s = np.append(0.0, 1 - (1 - s) ** 2)
    x = np.clip(lo + (hi - lo) * s, lo, hi)
    tips = fields.tips
    # A kink that is the end of a zone is in contact, so it is not a sample of the open gap.
    first, last = np.searchsorted(tips, lo, side="right"), np.searchsorted(tips, hi, side="left")
    return np.unique(np.concatenate((x, tips[first:last]))) if last > first else x


@record
class Solved:
    """The contact zones (or gaps) that a search has found, with their certificate.

    free: the result of Newton's method. fields: pressure, gap and other fields of the contact.
    rounds: number of corrections of the set of intervals. tolerance: tolerance of the ends.
    control_error: possible error of the control, for all intervals or for each end (n, 2); the
    subclass says in which units.
    """

    free: sie.Free
    fields: Any
    certificate: Certificate
    rounds: int
    control: Control
    tolerance: float = 0.0
    control_error: float | Array = 0.0

    @property
    def error(self) -> float:
        """Bound of the relative errors of the pressure and of the ends; see `Solution.error`."""
        raise NotImplementedError
