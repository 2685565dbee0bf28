"""Signs of pressure and gap of a contact under a tension, tested at sample points.

A zone is cut where the pressure q is negative; a new zone begins where the surfaces overlap.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contact.adhesion.curve import ACCURACY
from contact.adhesion.deformed_profile import TractionLoaded
from contact.adhesion.intervals import sample_points
from contact.adhesion.options import SAMPLES
from contact.formulation.fields import ZoneFields
from contact.formulation.quadrature import sides
from contact.formulation.roots import reaches
from contact.formulation.tables import gaps_between, joined_where, runs_of
from contact.formulation.tolerances import allowed_overlap
from sie import Array


@dataclass(frozen=True)
class SignOptions:
    """Options of the sample points for a contact within intervals of tension."""

    # The gap of an isolated body is sampled up to this distance, relative to the span of its zones
    # and tension intervals.
    far: float = 1024.0
    # Number of rounds in which sample points are added near extrema of the gap or the pressure.
    refinements: int = 3


_OPTIONS = SignOptions()


def sampled_gap(fields: ZoneFields) -> tuple[Array, Array]:
    """(ascending sample points outside the contact, gap at these points)."""
    pulled = fields.problem
    assert isinstance(pulled, TractionLoaded)
    return samples_with_extremes(
        fields.formal_gap, sample_places(pulled, fields.density.zones.table)
    )


def samples_with_extremes(gap: Callable[[Array], Array], x: Array) -> tuple[Array, Array]:
    """(sample points, gap at these points); points are added at extrema of the gap.

    A new zone or interval begins at an extremum with no width, so samples alone would miss it.
    """
    order = np.argsort(x)
    x, value = x[order], gap(x[order])
    for _ in range(_OPTIONS.refinements):
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


def sample_places(pulled: TractionLoaded, zones: Array) -> Array:
    """Sample points outside the contact, denser near ends of zones and intervals of tension."""
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
        far = _OPTIONS.far * span
        # The range of the sample points is divided at these distances from the outermost ends. They
        # form a geometric series with the ratio 4.
        away = far / 4.0 ** np.arange(1, np.log(4 * _OPTIONS.far) / np.log(4.0))
        marks = np.concatenate((table.ravel(), both.min() - away, both.max() + away))
        left, right = max(lo, both.min() - far), min(hi, both.max() + far)
        edges = np.column_stack((np.append(left, zones[:, 1]), np.append(zones[:, 0], right)))
        edges = edges[edges[:, 0] < edges[:, 1]]
    found = []
    for begin, end in edges.tolist():
        cuts = [begin, *np.sort(marks[(marks > begin) & (marks < end)]).tolist(), end]
        found += [
            sample_points(a, b, 0.25 * pulled.detail)
            for a, b in zip(cuts[:-1], cuts[1:], strict=True)
        ]
    kinks = pulled.forcing.kinks[0]
    if period is not None and len(kinks):
        kinks = np.concatenate((kinks - period, kinks, kinks + period))
    inner_kinks = [kinks[(kinks > a) & (kinks < b)] for a, b in edges]
    # The gap may be smallest at a sharp corner that is not in contact. So these corners are sample
    # points.
    free = [
        corner for corner in pulled.corners if np.isfinite(corner) and not np.any(zones == corner)
    ]
    return np.unique(np.concatenate((np.zeros(0), *found, *inner_kinks, free)))


def _refined(
    fields: ZoneFields, zone: int, place: Array, q: Array, least: float
) -> tuple[Array, Array]:
    """(points x of a zone, q / sqrt(left * right) there), with points added near minima.
    q is the pressure; left and right are the distances of x from the ends of the zone, divided by
    its half width. The arguments `place` and `q` have such values at the first points.
    """
    density, zones = fields.density, fields.density.zones
    for _ in range(_OPTIONS.refinements):
        inner = np.flatnonzero((q >= least) & (reaches(-q) > 0.0))
        inner = inner[(inner > 0) & (inner < len(q) - 1)]
        if len(inner) == 0:
            break
        parts = np.linspace(0.0, 1.0, SAMPLES.samples)[1:-1]
        x = np.concatenate([place[i - 1] + (place[i + 1] - place[i - 1]) * parts for i in inner])
        x = np.unique(x[~np.isin(x, place)])
        left, right = (x - zones.a[zone]) / zones.half[zone], (zones.b[zone] - x) / zones.half[zone]
        more = fields.problem.bearing(density, np.full(len(x), zone), left, right) / np.sqrt(
            left * right
        )
        order = np.argsort(np.concatenate((place, x)), kind="stable")
        place, q = np.concatenate((place, x))[order], np.concatenate((q, more))[order]
    return place, q


def signs_hold(fields: ZoneFields, gap_samples: tuple[Array, Array]) -> bool:
    """Whether the pressure q is positive on all zones, and no gap is negative under tension."""
    return corrected(fields, gap_samples) is None


def corrected(fields: ZoneFields, gap_samples: tuple[Array, Array]) -> Array | None:
    """The zones without parts of negative pressure q, with new zones where surfaces overlap.

    None if no pressure q is negative and no surfaces overlap.
    """
    kept, cut = _compressed(fields)
    new = _overlapping(fields, *gap_samples)
    if not cut and not new:
        return None
    found = np.array(sorted(kept + new)).reshape(-1, 2)
    return joined_where(found, found[1:, 0] <= found[:-1, 1])


def _compressed(fields: ZoneFields) -> tuple[list[tuple[float, float]], bool]:
    """(parts of the zones where the pressure q is not negative, whether a part is left out)."""
    density, kept, cut = fields.density, [], False
    zones = density.zones
    varies = fields.spacing if fields.problem.profile.resolution is not None else np.inf
    # Near the ends of a zone, the tension makes the pressure q vary fast, but does not change its
    # sign. So the sample points need not resolve this variation.
    wanted = np.maximum(SAMPLES.sign_samples, 8 * zones.half / varies).astype(np.intp)
    counts = np.minimum(density.sampling, wanted)
    theta = np.concatenate([(np.arange(n) + 0.5) * np.pi / n for n in counts])
    left, right = sides(theta)
    zone = np.repeat(np.arange(len(zones)), counts)
    borne = fields.problem.bearing(density, zone, left, right) / np.sqrt(left * right)
    borders = np.cumsum(counts)[:-1]
    parts = zip(np.split(borne, borders), np.split(left, borders), strict=True)
    for i, (q, far) in enumerate(parts):
        q, place = q[::-1], zones.a[i] + zones.half[i] * far[::-1]
        begin, least = float(zones.a[i]), -ACCURACY.rough * np.abs(q).max()
        place, q = _refined(fields, i, place, q, least)
        for s, e in runs_of(q < least):
            cut = True
            if s > 0:
                kept.append((begin, float(0.5 * (place[s] + place[s - 1]))))
            begin = float(0.5 * (place[e] + place[e + 1])) if e < len(q) - 1 else np.inf
        if np.isfinite(begin):
            kept.append((begin, float(zones.b[i])))
    return kept, cut


def _overlapping(fields: ZoneFields, x: Array, gap: Array) -> list[tuple[float, float]]:
    """New zones in overlaps of the surfaces, found at the sample points x with the given gap."""
    pulled, zones = fields.problem, fields.density.zones
    assert isinstance(pulled, TractionLoaded)
    on_zones = float(np.abs(fields.formal_gap(zones.middle)).max())
    rounding = fields.gap_rounding + allowed_overlap(on_zones=on_zones)
    free, new = ~fields.density.locate(x)[2], []
    if len(pulled.pulling.table):
        # New zones begin only inside the intervals of tension.
        free &= pulled.pulling.holds(x)
    first, last = pulled.corners
    for s, e in runs_of((gap < -rounding) & free):
        lo, hi = x[max(s - 1, 0)], x[min(e + 1, len(x) - 1)]
        if (s == 0 or lo in zones.table) and (e == len(x) - 1 or hi in zones.table):
            continue
        middle = 0.5 * (x[s] + x[e])
        # The new zone is half as wide as the overlap, but at least a tenth of `hi - lo` wide, where
        # lo and hi are the sample points on both sides of the overlap.
        half = 0.25 * max(x[e] - x[s], 0.2 * (hi - lo))
        # A new zone at a sharp corner has one end at the corner.
        if x[s] == first:
            middle += half
        elif x[e] == last:
            middle -= half
        new.append((float(max(middle - half, first)), float(min(middle + half, last))))
    return new
