"""Checks of the sign of a function on intervals, by samples and by minima between the samples.

A minimum between two samples may show a gap inside a zone, or a contact inside a gap.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import sie
from contact.formulation.tables import runs_of
from sie import Array, Index, Mask, record


@dataclass(frozen=True)
class SamplingOptions:
    """Numbers of samples at which the signs of pressure and gap are checked."""

    min_points: int = 48  # least number in an interval; 3 lie in the first hundredth of a gap
    max_points: int = 2**17  # largest number if the profile states its resolution
    max_guessed_points: int = 4000  # largest number if the resolution is a guess
    # Largest number of zooms on a minimum; each zoom narrows the bracket to a quarter or less.
    # Without this limit the zooms would not end around a minimum that touches zero, or at a kink.
    max_zooms: int = 7


SAMPLING = SamplingOptions()


@record
class Dips:
    """Minima of a function on zones, located between its samples.

    negative: (zone, angle from, angle to) of every minimum below -rounding. least: smallest
    value above rounding. relative: smallest ratio of a value to the scale of its zone; inf if there
    is no minimum. lowest: smallest negative value.
    """

    negative: list[tuple[int, float, float]]
    least: float = np.inf
    relative: float = np.inf
    lowest: float = np.inf


def may_be_negative(before: Array, here: Array, after: Array) -> Mask:
    """Whether a function may be negative between three equidistant samples around a minimum.

    The parabola through the samples falls below the middle one by at most an eighth of their second
    difference.
    """
    with np.errstate(invalid="ignore"):
        bend = before - 2 * here + after
        return np.asarray((here <= before) & (here <= after) & (here > 0) & (here < bend))


def follow(
    over_root: Callable[[Index, Array], Array],
    zone: Index,
    lo: Array,
    hi: Array,
    scale: Array,
    rounding: Array,
) -> Dips:
    """Locate the minimum of the pressure p / sqrt(1 - t^2), t = cos(angle), in each bracket.

    over_root: returns the values at zones (n, 1) and angles (n, k). zone, scale, rounding: index of
    the zone, scale and rounding of the values for each bracket (n,).
    """
    negative: list[tuple[int, float, float]] = []
    least = relative = lowest = np.inf
    for _ in range(SAMPLING.max_zooms):
        if len(zone) == 0:
            break
        angle = lo[:, None] + (hi - lo)[:, None] * np.linspace(0, 1, 17)
        here = over_root(zone[:, None], angle)
        here = np.where(np.isfinite(here), here, np.inf)
        least = min(least, float(here[here > rounding[:, None]].min(initial=np.inf)))
        relative = min(relative, float((here.min(axis=1) / scale).min()))
        fails = here < -rounding[:, None]
        for k in np.flatnonzero(fails.sum(axis=1) > 1):
            at = np.flatnonzero(fails[k])
            first, last = angle[k, max(at[0] - 1, 0)], angle[k, min(at[-1] + 1, 16)]
            negative.append((int(zone[k]), float(first), float(last)))
            lowest = min(lowest, float(here[k].min()))
        lo, hi, (zone, scale, rounding) = zoomed(angle, here, rounding, (zone, scale, rounding))
    return Dips(negative, least, relative, lowest)


def zoomed(
    at: Array, value: Array, rounding: Array, others: tuple[Any, ...]
) -> tuple[Array, Array, tuple[Any, ...]]:
    """Narrower brackets around the smallest sample of each row, for rows that need more samples.

    at, value: places and values of the samples (k, n). rounding: rounding of the values in each row
    (k,). others: arrays (k,) to be reduced to the rows that remain. Returns the lower and upper
    ends of the brackets, and the reduced arrays.

    A bracket is left out if the parabola through its samples cannot fall below -rounding. It is
    also left out if several samples of its row are below -rounding, because these samples show the
    width of the interval of wrong signs. If only one sample is below -rounding, this interval may
    be much narrower than the spacing of the samples.
    """
    each, best = np.arange(len(value)), np.clip(np.argmin(value, axis=1), 1, value.shape[1] - 2)
    before, here, after = (value[each, best + k] for k in (-1, 0, 1))
    with np.errstate(invalid="ignore"):
        may_fail = before - 2 * here + after > here + rounding
    keep = may_fail & (np.sum(value < -rounding[:, None], axis=1) < 2)
    lo, hi = at[each, best - 1][keep], at[each, best + 1][keep]
    return lo, hi, tuple(other[keep] for other in others)


def lowest(x: Array, value: Array, at: Index) -> Array:
    """Position, value and half the second derivative of the minimum near each sample `at` (n, 3).

    They are those of the parabola through the sample and its two neighbours.
    """
    before, after = x[at] - x[at - 1], x[at + 1] - x[at]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        falls, rises = (value[at] - value[at - 1]) / before, (value[at + 1] - value[at]) / after
        bend = (rises - falls) / (before + after)
        slope = falls + bend * before
        found = np.column_stack(
            (x[at] - slope / (2 * bend), value[at] - slope**2 / (4 * bend), bend)
        )
    return np.asarray(found[np.isfinite(found).all(axis=1)])


@record
class Signs:
    """Result of the check of a function's signs on several intervals.

    negative: intervals where the function is negative, in ascending order. least: the smallest
    value; a value that may be round-off counts with its absolute value. dip: least minimum between
    samples, divided by the scale of its interval; inf if there is no minimum. points: number of
    samples.
    """

    negative: list[tuple[float, float]]
    least: float
    dip: float
    points: int


def signs_on(
    intervals: sie.Zones,
    counts: Index,
    sampled: Callable[[Index, Array], tuple[Array, Array, Array]],
    over: Callable[[Index, Array], Array],
) -> Signs:
    """Check the signs of a function on several intervals, from samples at equidistant angles.

    counts: number of samples of each interval. sampled: a function of intervals (k,) and angles
    (n,) that returns the values (k, n), their rounding and their scale (k,). over: see `over_root`
    of `follow`.
    """
    negative: list[tuple[float, float]] = []
    least, points = np.inf, 0

    def within(i: int, first: float, last: float) -> tuple[float, float]:
        """Part of interval i between two angles; 0 is the interval's right end, pi its left end."""
        hi, lo = intervals.middle[i] + intervals.half[i] * np.cos([first, last])
        return float(intervals.a[i] if last == np.pi else lo), float(
            intervals.b[i] if first == 0.0 else hi
        )

    counts = _rounded_up(counts)
    # For each minimum: the index of its interval, the two angles around it, the scale of the
    # function in the interval, and the rounding of its values.
    followed: list[tuple[Index, Array, Array, Array, Array]] = []
    for n in np.unique(counts):
        group = np.flatnonzero(counts == n)
        theta = (np.arange(n) + 0.5) * np.pi / n
        value, rounding, scale = sampled(group, theta)
        points += value.size
        # Close to the ends of an interval, and close to other intervals, the values tend to zero. A
        # negative value there is not a failure if its size is at most `rounding`.
        least = min(
            least, float(np.where(np.abs(value) <= rounding[:, None], np.abs(value), value).min())
        )
        fails = value < -rounding[:, None]
        for row in np.flatnonzero(fails.any(axis=1)):
            negative += [
                within(group[row], s * np.pi / n, (e + 1) * np.pi / n)
                for s, e in runs_of(fails[row])
            ]
        rows, places = np.nonzero(may_be_negative(value[:, :-2], value[:, 1:-1], value[:, 2:]))
        followed.append(
            (group[rows], theta[places], theta[places + 2], scale[rows], rounding[rows])
        )
    zone, before, after, scale, rounding = (
        np.concatenate(part) for part in zip(*followed, strict=True)
    )
    dips = follow(over, zone, before, after, scale, rounding)
    negative += [within(*found) for found in dips.negative]
    return Signs(sorted(negative), min(least, dips.least, dips.lowest), dips.relative, points)


def _rounded_up(counts: Index) -> Index:
    """The counts rounded up to powers of two, so that many intervals have the same count."""
    return np.asarray(2 ** np.ceil(np.log2(counts)), dtype=np.intp)
