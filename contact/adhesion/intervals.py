"""Operations on intervals of tension and on the zones inside, with or without a period."""

import numpy as np

from contact.adhesion.curve import Closed
from contact.adhesion.options import SAMPLES
from contact.errors import OutOfRange
from contact.formulation.tables import ascending, begun_from, joined_where, located, runs_of, united
from sie import Array, Index, Mask, wrapped


def sample_points(a: float, b: float, spacing: float) -> Array:
    """Sample points in the interval (a, b), denser near the ends of the interval."""
    count = int(np.clip((b - a) / spacing, SAMPLES.samples, SAMPLES.max_gap_samples))
    return a + (b - a) * np.sin(0.5 * np.pi * (np.arange(count) + 0.5) / count) ** 2


def within(x: Array, a: float, b: float, period: float | None) -> tuple[Index, Array]:
    """(indices of the points in (a, b) from left to right, positions of these points)."""
    place = wrapped(x, a, period)
    inner = np.flatnonzero((place > a) & (place < b))
    inner = inner[np.argsort(place[inner])]
    return inner, np.asarray(place[inner])


def interval_of(zones: Array, table: Array) -> Index:
    """The index of the interval that contains each zone."""
    return located(table, zones.mean(axis=1))[0]


def fitted(
    zones: Array,
    table: Array,
    period: float | None,
    everywhere: bool = False,
    corners: tuple[float, float] = (-np.inf, np.inf),
) -> Array:
    """The zones shifted by periods into the intervals and cut to lie strictly within them.

    A zone may reach a sharp corner. Zones outside all intervals are dropped.
    """
    if everywhere or len(table) == 0:
        return ascending(zones)
    zones = (
        zones
        if period is None
        else zones - np.floor((zones.mean(axis=1) - table[0, 0]) / period)[:, None] * period
    )
    row, inside = located(table, zones.mean(axis=1))
    (lo, hi), (a, b) = table[row].T, zones.T
    slack = 1e-2 * (hi - lo)
    a = np.where(a > lo, a, np.where(lo == corners[0], lo, lo + slack))
    b = np.where(b < hi, b, np.where(hi == corners[1], hi, hi - slack))
    return ascending(np.column_stack((a, b))[inside & (a < b)])


def below(
    zones: Array,
    gap_samples: tuple[Array, Array],
    reach: float,
    period: float | None,
    wide: bool = False,
    corners: tuple[float, float] = (-np.inf, np.inf),
) -> Array:
    """Intervals about the zones, in which the sampled gap is below the reach of the tension.

    gap_samples: sample points without contact, and the gap at these points. An interval ends
    between its last sample below the reach and the next sample: half-way from the last sample to
    the point where the interpolated gap crosses the reach; with `wide`, half-way from this point to
    the next sample. At a sharp corner it ends at the corner. Raises Closed if the gap is below the
    reach everywhere.
    """
    ends = zones.ravel() if period is None else np.append(zones.ravel(), zones[0] + period)
    x, gap = (
        np.concatenate((gap_samples[0], ends)),
        np.concatenate((gap_samples[1], np.zeros(len(ends)))),
    )
    order = np.lexsort((gap, x))
    x, gap = x[order], gap[order]
    runs = runs_of(gap < reach)
    if period is not None and len(runs) == 1 and runs[0] == (0, len(x) - 1):
        raise Closed
    if (
        period is None
        and not np.isfinite(corners[0])
        and (runs[0][0] == 0 or runs[-1][1] == len(x) - 1)
    ):
        raise OutOfRange(
            "the tension reaches the border of the known part of the profile: give the profile "
            'over a longer interval or, if branch is "receding", use "advancing"'
        )

    def crossing(inner: int, outer: int) -> float:
        way = (reach - gap[inner]) / (gap[outer] - gap[inner]) if np.isfinite(gap[outer]) else 0.0
        way = 0.5 * (1 + way) if wide else 0.5 * way
        return float(x[inner] + (x[outer] - x[inner]) * way)

    first, last = corners if np.isfinite(corners[0]) else (np.nan, np.nan)
    out = [
        [crossing(s, s - 1) if s else first, crossing(e, e + 1) if e < len(x) - 1 else last]
        for s, e in runs
    ]
    if np.isnan(out[0][0]):
        assert period is not None
        out[0][0] = out.pop()[0] - period
    return np.array(out)


def joined(
    table: Array, joins: Mask, new: list[tuple[float, float]], period: float | None
) -> Array:
    """The intervals `table` and `new`; those of `table` marked in `joins` are joined to the next.

    With a period, the interval after the last one is the first.
    """
    joins = joins.copy()
    if period is None:
        joins[-1] = False
    elif joins[-1]:
        start = int(np.flatnonzero(~joins)[0]) + 1
        table = np.concatenate((table[start:], table[:start] + period))
        joins = np.roll(joins, -start)
    table = joined_where(table, joins[:-1])
    if new:
        table = ascending(
            np.concatenate((table, begun_from(np.array(new), float(table[0, 0]), period)))
        )
    return np.asarray(table)


def united_about(table: Array, zones: Array, period: float | None) -> Array:
    """The intervals `table`, widened to contain `zones`, which may end slightly outside them."""
    rows = np.concatenate((table, begun_from(zones, float(table[0, 0]), period)))
    if period is not None:
        # A zone that begins just before the first interval is moved back by a period to join this
        # interval.
        late = (rows[:, 1] >= table[0, 0] + period) & (rows[:, 0] > table[-1, 1])
        rows[late] -= period
    return united(rows)
