"""Intervals of a prepared trace whose heights were not measured.

They are tapered ends, dropouts, and the piece that closes a period. If such intervals carry load,
this is an artefact of the preparation; contact.solution.preparation computes their share.
"""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from contact.model.traces.filters import MAX_UNEVENNESS
from sie import Array

if TYPE_CHECKING:
    from contact.model.traces.prepare import Preparation, Reading


class Kind(Enum):
    """The kinds of unmeasured intervals: a name, and advice if such an interval carries load."""

    TAPERED = (
        "the tapered ends",
        'use a smaller taper, set detrend = "quadratic" or a higher degree if the form raises the '
        "ends, or leave out period and taper",
    )
    FILLED = (
        "dropouts filled by straight lines",
        "no heights were measured there; measure again, or cut the trace",
    )
    DROPPED = (
        "dropouts bridged by the spline alone",
        "no heights were measured there; measure again, or cut the trace",
    )
    JOINED = (
        "the interval from the last point to the first point of the next period",
        "no heights were measured there; set period to the length after which the surface repeats, "
        "or set taper and period = true",
    )


class Interval(NamedTuple):
    """An unmeasured interval [m] and its kind."""

    left: float
    right: float
    kind: Kind


def intervals(
    source: tuple[Reading, Preparation] | None, x: Array, period: float | None
) -> tuple[Interval, ...]:
    """The intervals without measured heights, for a trace with points x [m].

    source: the content of the file and the preparation; None for points that come from no file.
    """
    found = [*_joined(x, period)]
    if source is not None:
        reading, by = source
        found += [*_dropouts(reading, by), *_tapered(reading, by, float(x[0]))]
    return tuple(found)


def _joined(x: Array, period: float | None) -> list[Interval]:
    """The interval between the last point and the first point of the next period, as a list. The
    list is empty if this interval is no longer than the longest step between points.
    """
    if period is None:
        return []
    left, right = float(x[-1]), float(x[0]) + period
    return (
        [Interval(left, right, Kind.JOINED)]
        if right - left > (1 + MAX_UNEVENNESS) * float(np.max(np.diff(x)))
        else []
    )


def _dropouts(reading: Reading, by: Preparation) -> list[Interval]:
    order = np.argsort(reading.x, kind="stable")
    x, known = reading.x[order], np.flatnonzero(np.isfinite(reading.height[order]))
    gaps = np.flatnonzero(np.diff(known) > 1)
    kind = Kind.FILLED if by.fill == "linear" else Kind.DROPPED
    return [Interval(float(x[known[gap]]), float(x[known[gap + 1]]), kind) for gap in gaps]


def _tapered(reading: Reading, by: Preparation, start: float) -> list[Interval]:
    if by.taper is None:
        return []
    known = reading.x[np.isfinite(reading.height)]
    length = float(np.ptp(known))
    reach = by.taper * length
    return [
        Interval(start, start + reach, Kind.TAPERED),
        Interval(start + length - reach, start + length, Kind.TAPERED),
    ]
