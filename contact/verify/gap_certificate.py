"""Certificate of a nearly full contact that was solved by the slope of its gaps.

It checks that every gap is open, that pressures are positive in every zone, and that there is a gap
over every concave kink.
"""

import numpy as np

from contact.formulation.gaps import GapFields
from contact.formulation.quadrature import sides
from contact.formulation.tables import located, runs_of
from contact.formulation.tolerances import TOLERANCES, allowed_overlap
from contact.verify.certificate import Certificate, least_minimum, unresolved_gaps_note
from contact.verify.minima import SAMPLING, Signs, follow, lowest, may_be_negative, signs_on
from sie import Array, Index, record


def certify_gaps(fields: GapFields) -> Certificate:
    """Check the signs of the gap and of the pressure on the whole period."""
    openings, minima = _openings(fields)
    least, negative, dip, points = _pressures(fields)
    valleys, left_out = _valleys(fields)
    negative += [
        row for row in valleys if not any(lo < row[1] and row[0] < hi for lo, hi in negative)
    ]
    units = fields.problem.units
    note = "solved by its gaps"
    if left_out:
        note += f"; {unresolved_gaps_note(left_out, 'the period')}"
    return Certificate(
        smallest_pressure=least * units.pressure,
        smallest_gap=least_minimum(openings.least, minima) * units.height,
        points=openings.points + points,
        gap_rounding=fields.gap_rounding * units.height,
        holds=not (negative or openings.negative),
        undecided=left_out > 0 or (dip <= TOLERANCES.rounding and not negative),
        note=note,
        dip=dip,
        negative=np.array(sorted(negative)).reshape(-1, 2),
        overlaps=np.array(openings.negative).reshape(-1, 2),
        lowest=minima,
    )


def _openings(fields: GapFields) -> tuple[Signs, Array]:
    """Signs of the gap inside the gaps, and the minima of the gap as returned by `lowest`."""
    density, gaps, sizes = fields.gap_slope, fields.gap_slope.zones, fields.gap_sizes
    minima: list[Array] = []

    def sampled(group: Index, theta: Array) -> tuple[Array, Array, Array]:
        opening = density.integral_at(group[:, None], theta)
        row, at = np.nonzero(
            (opening[:, 1:-1] < opening[:, :-2]) & (opening[:, 1:-1] < opening[:, 2:])
        )
        x = gaps.middle[group][:, None] + gaps.half[group][:, None] * np.cos(theta)
        minima.append(lowest(x.ravel(), opening.ravel(), row * len(theta) + at + 1))
        return opening, allowed_overlap(series=1.0) * sizes[group], opening.max(axis=1)

    signs = signs_on(gaps, density.sampling, sampled, density.integral_at)
    return signs, np.concatenate(minima)


def _pressures(fields: GapFields) -> tuple[float, list[tuple[float, float]], float, int]:
    """Check that p / sin(angle) is positive in the zones, with the pressure p.
    The normalised position in a zone is cos(angle). The sine removes the zeros of p at both ends.

    Returns the least quotient, the intervals where it is negative, its least minimum between
    samples, and the number of samples. The minimum is relative to the largest value in its zone.
    """
    zones = fields.zones
    middle, half = zones.mean(axis=1), 0.5 * (zones[:, 1] - zones[:, 0])
    sampled = _sampled(fields)
    run, zone, value, rough = sampled.run, sampled.zone, sampled.value, sampled.rough
    least = float(np.where(np.abs(value) <= rough, np.abs(value), value).min())
    negative: list[tuple[float, float]] = []

    def pulls(i: int, lo: float, hi: float) -> None:
        negative.append(
            (float(middle[i] + half[i] * np.cos(hi)), float(middle[i] + half[i] * np.cos(lo)))
        )

    fails = value < -rough
    for k in np.unique(run[fails]):
        here = np.flatnonzero(run == k)
        for s, e in runs_of(fails[here]):
            first, last = sampled.angle(here[[max(s - 1, 0), min(e + 1, len(here) - 1)]])
            pulls(int(zone[here[0]]), float(first), float(last))
    inner = (
        may_be_negative(value[:-2], value[1:-1], value[2:]) & (run[:-2] == run[2:]) & ~fails[1:-1]
    )
    places = np.flatnonzero(inner) + 1
    scale = np.zeros(len(zones))
    np.maximum.at(scale, zone, np.where(np.isfinite(value), np.abs(value), 0.0))

    def over_root(i: Index, angles: Array) -> Array:
        zone, angle = np.repeat(i.ravel(), angles.shape[1]), angles.ravel()
        left, right = sides(angle)
        value = fields.pressure_in(zone, left, right)
        root = fields.bounded_weight(left, right) if fields.problem.kappa else np.sin(angle)
        return np.asarray(value / root).reshape(angles.shape)

    before, after = sampled.angle(places - 1), sampled.angle(places + 1)
    dips = follow(over_root, zone[places], before, after, scale[zone[places]], rough[places])
    for i, lo, hi in dips.negative:
        pulls(i, lo, hi)
    return min(least, dips.least, dips.lowest), negative, dips.relative, len(zone)


@record
class _Samples:
    """Samples of the pressure in all zones, in several runs of neighbouring samples.

    Each sample has these entries. run: index of its run. zone: index of its zone. left, right:
    distances from the ends of the zone, divided by the half width. value: pressure divided by the
    sine of the angle. rough: rounding of `value`.
    """

    run: Index
    zone: Index
    left: Array
    right: Array
    value: Array
    rough: Array

    def angle(self, some: Index) -> Array:
        return np.asarray(2 * np.arctan2(np.sqrt(self.right[some]), np.sqrt(self.left[some])))


def _sampled(fields: GapFields) -> _Samples:
    """Samples of the pressure at equidistant angles; inside wide zones, at equidistant positions.

    The equidistant positions are those of the samples that the fields compute anyway.
    """
    zones, near_end = fields.zones, fields.relief.spacing
    half = 0.5 * (zones[:, 1] - zones[:, 0])
    x, known = fields.samples
    step = x[1] - x[0]
    # Samples at equidistant angles are least dense in the middle of a zone. With `counts` samples,
    # their spacing in the middle is `step`, like that of the samples `x`.
    counts = np.clip(np.pi * half / step, 2 * SAMPLING.min_points, SAMPLING.max_points).astype(int)
    # Evenly spaced positions are used only at distances above `near_end` from the ends of a zone.
    # Closer to a gap, the pressure varies more than the profile does.
    is_wide = half > 2 * near_end
    wide = np.flatnonzero(is_wide)
    inside = located(zones, x)[0]
    from_left, from_right = x - zones[inside, 0], zones[inside, 1] - x
    inner = np.flatnonzero(is_wide[inside] & (np.minimum(from_left, from_right) > near_end))
    # The samples near the ends of wide zones overlap with the inner samples by a few steps.
    edge_angle = 2 * np.arcsin(np.sqrt(0.5 * (near_end + 3 * step) / half[wide]))
    few = np.minimum(np.ceil(edge_angle * counts[wide] / np.pi).astype(int) + 1, counts[wide])
    lengths = counts.copy()
    lengths[wide] = few
    of_run = np.concatenate((np.arange(len(zones)), wide))
    first, lengths = (
        np.concatenate((np.zeros(len(zones), dtype=int), counts[wide] - few)),
        np.concatenate((lengths, few)),
    )
    run = np.repeat(np.arange(len(of_run)), lengths)
    place = np.arange(len(run)) - np.repeat(np.cumsum(lengths) - lengths - first, lengths)
    zone = of_run[run]
    left, right = sides((place + 0.5) * np.pi / counts[zone])
    # The order of the inner samples is reversed, so that their angles increase.
    inner = inner[::-1]
    pressure, zone = (
        np.concatenate((fields.pressure_in(zone, left, right), known[inner])),
        np.concatenate((zone, inside[inner])),
    )
    left = np.concatenate((left, from_left[inner] / half[inside[inner]]))
    right = np.concatenate((right, from_right[inner] / half[inside[inner]]))
    run = np.concatenate((run, len(of_run) + inside[inner]))
    # The pressure is a difference of numbers as large as the mean pressure. Next to an end the
    # pressure is small, and may consist only of the rounding of these numbers.
    size = abs(fields.mean) + float(np.abs(pressure[np.isfinite(pressure)]).max(initial=0.0))
    over_sine = 1 / fields.bounded_weight(left, right)
    return _Samples(
        run, zone, left, right, pressure * over_sine, TOLERANCES.rounding * size * over_sine
    )


def _valleys(fields: GapFields) -> tuple[list[tuple[float, float]], int]:
    """Gaps that are missing at concave kinks: (their intervals, number of unresolved gaps).

    There must be a gap at every concave kink. A gap is unresolved if its half width is below
    `TOLERANCES.narrowest_gap` periods; such gaps are only counted.
    """
    relief = fields.relief
    kinks = np.flatnonzero((relief.heights < 0) & ~fields.gap_slope.locate(relief.at)[2])
    if len(kinks) == 0:
        return [], 0
    half = valley_gaps(fields, kinks)
    wide = half > TOLERANCES.narrowest_gap * fields.period
    at = fields.gap_slope.locate(relief.at[kinks])[0]
    return [(float(x - w), float(x + w)) for x, w in zip(at[wide], half[wide], strict=True)], int(
        np.sum(~wide)
    )


def valley_gaps(fields: GapFields, kinks: Index) -> Array:
    """Scaled half width of the gap at each of the concave `kinks`; see contact.formulation.gaps."""
    relief = fields.relief
    at, heights = relief.at[kinks], relief.heights[kinks]
    rest = fields.mean - relief.without_own(kinks) + fields.gap_slope.transform(at)
    return np.asarray(fields.period / np.pi * np.exp(np.pi * rest / heights))
