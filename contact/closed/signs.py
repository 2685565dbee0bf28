"""Signs of the pressure inside a zone and of the gap outside, and the stated error.

Inside, p / sqrt(1 - t^2) is, up to a positive factor, the polynomial q = sum g_k U_{k-1} of
contact.closed.series plus a positive term from a kink of the profile at x = 0. q is at least its
first coefficient minus the sum of k |g_k| over the others. If this bound does not decide the sign,
q is sampled so closely that no zero is hidden between samples. Outside, the slope of the gap is

    gap' = w (G - sum g_k rho^k) + (J/pi) arccos(tan A / tan u),

with w, G and u of contact.closed.line, rho of contact.closed.series, the jump J of the slope at the
kink, and A the value of u at the end of the zone. If the slope is nowhere negative, the gap is
least at the ends of the zone, where it is zero. If the slope is negative somewhere, as at the
border of a single wave in isolated contact, the gap itself is sampled.

The stated error is the larger one of two relative errors: the error of an end divided by the width
of the zone, and the error of the pressure divided by the mean pressure, which is at most the peak.
Ends have the error of Newton's last step and round-off. The pressure has the errors of the ends, of
the truncated series and round-off. If the half length has the relative error e, and t = cos(a),
then Phi = sum g_k sin(k a) changes by at most e sum k^2 |g_k|: each term changes by
e k g_k (1 - cos(a) cos(k a)) / sin(a), at most e k^2 |g_k|.
"""

import math
from functools import lru_cache

import numpy as np

from contact.closed.line import Value, column, everywhere, largest, least
from contact.closed.series import (
    SAMPLES_PER_DEGREE,
    outside_transform,
    outside_transform_integral,
    table,
)
from contact.closed.zone import OPTIONS, SUM_ROUND_OFF, ClosedZone
from contact.formulation.tolerances import TOLERANCES, allowed_overlap
from contact.model.profiles.noise import EPS
from sie import Array


def signs(zone: ClosedZone) -> tuple[Value, Value]:
    """(whether pressure and gap certainly have the right signs, least sampled gap [m]).

    The gap is inf where its slope is positive everywhere outside, so that it was not sampled.
    """
    if zone.problem.corner is not None:
        return zone.punch > 0.0, math.inf
    pushes = _is_compressive(zone)
    opens, gap = _opens(zone)
    return pushes & opens, gap


# The following functions check the pressure inside the zone.


def _is_compressive(zone: ClosedZone) -> Value:
    """Whether the pressure p inside the zone, divided by sqrt(1 - t^2), is clearly positive.

    Up to a positive factor this is the polynomial q = sum g_k U_{k-1} plus a positive term of the
    profile's kink. Instead of this term, its least value is used.
    """
    most, kinked, first = zone.sums[1], zone.problem.kink / math.pi, zone.first
    bounded = kinked + first + abs(first) - most > TOLERANCES.noise * (kinked + most)
    if everywhere(bounded):
        return bounded
    value = table(zone.nodes // 2).samples(zone.g) + kinked
    # The parabola through three samples falls below the samples by at most an eighth of their
    # second difference (`bend`). Twice this amount is subtracted.
    bend = np.abs(value[..., :-2] - 2.0 * value[..., 1:-1] + value[..., 2:])
    low = np.minimum(least(value), least(value[..., 1:-1] - 0.25 * bend))
    return bounded | (low > TOLERANCES.noise * largest(value))


def least_inside(zone: ClosedZone) -> tuple[float, int]:
    """(least sample of p / sqrt(1 - t^2) in units of E*/2, number of samples), for one load."""
    if zone.problem.corner is not None:
        return float(zone.punch), 0
    nodes = table(zone.nodes // 2)
    weight = zone.problem.map.at(zone.half * nodes.cosines)[1]
    value = nodes.samples(zone.g) + zone.problem.kink / math.pi
    return float((value * weight).min()), SAMPLES_PER_DEGREE * zone.nodes // 2


# The following functions check the gap outside the zone.


def places(zone: ClosedZone) -> Array:
    """Normalised positions t > 1 at which the gap is sampled; the zone ends at t = 1.
    They are closer together near the zone. Their shape is (..., places).
    """
    problem, half = zone.problem, column(zone.half)
    if not math.isfinite(problem.limit):
        return _to_far_away() + 0.0 * half
    feature, count = problem.profile.resolution, OPTIONS.outer_places
    if feature is not None:
        room = problem.limit - float(np.min(zone.half_width))
        # More than `most` places are never needed: a profile that varies on lengths too short for
        # `OPTIONS.max_nodes` nodes is not solved in closed form.
        most = SAMPLES_PER_DEGREE * OPTIONS.max_nodes
        count = int(min(max(SAMPLES_PER_DEGREE * room / feature, count), most))
    return 1.0 + (problem.top / half - 1.0) * _graded_positions(count)


@lru_cache(maxsize=8)
def _graded_positions(count: int) -> Array:
    """Positions in (0, 1), closer together near 0."""
    return np.asarray(((np.arange(count) + 0.5) / count) ** 2)


@lru_cache(maxsize=1)
def _to_far_away() -> Array:
    """Positions t > 1 up to 4 * 10^`OPTIONS.decades`, closer together near 1."""
    far = 4.0 * np.geomspace(1.0, 10.0**OPTIONS.decades, OPTIONS.decades * OPTIONS.outer_places + 1)
    return np.concatenate((1.0 + 3.0 * _graded_positions(OPTIONS.outer_places), far))


def _opens(zone: ClosedZone) -> tuple[Value, Value]:
    """(whether the gap rises, or stays clearly positive, outside the zone; least sampled gap)."""
    problem, t = zone.problem, places(zone)
    half = column(zone.half)
    x, weight = problem.map.at(half * t)
    slope = np.asarray(problem.profile.slope(x), dtype=float)
    own = (slope - 0.5 * problem.kink) / weight
    rises = own - outside_transform(zone.g, t)
    if problem.kink > 0.0:
        ratio = 1.0 / t if problem.map.period is None else weight / (t * np.sqrt(1.0 - half**2))
        rises += problem.kink / math.pi * np.arccos(np.minimum(ratio, 1.0)) / weight
    opens = least(rises) > 0.0
    if everywhere(opens):
        return opens, math.inf
    # Slopes of the profile far from the zone may overflow to inf. Where the slope is inf, the gap
    # rises.
    rises[np.isposinf(slope)] = math.inf
    if rises.ndim == 1:
        return _stays_open(zone, t, own, rises)
    gap = np.full(len(opens), math.inf)
    for k in map(int, np.flatnonzero(~opens)):
        opens[k], gap[k] = _stays_open(zone.rows(k), t[k], own[k], rises[k])
    return opens, gap


def _stays_open(zone: ClosedZone, t: Array, own: Array, rises: Array) -> tuple[bool, float]:
    """(whether the gap stays positive outside the zone; least sampled gap), for one load.

    Called where the slope of the gap is not positive everywhere.
    """
    problem = zone.problem
    rounding = TOLERANCES.slope_rounding * (np.abs(own) + zone.sums[0] + problem.kink)
    if (rises > -rounding).all() and rises.max() > 0.0:
        return True, math.inf
    if problem.kink or not math.isfinite(problem.limit):
        return False, math.inf
    height = np.asarray(problem.profile.height(problem.map.at(zone.half * t)[0]), dtype=float)
    sunk = problem.map.load_factor * zone.half * outside_transform_integral(zone.g, t)
    gap = height - float(problem.profile.height(zone.half_width)) - sunk
    top = int(np.argmax(gap))
    lowest = float(gap[top:].min())
    lost = allowed_overlap(series=float((np.abs(height) + np.abs(sunk)).max()))
    rising = bool(np.all(np.diff(gap[: top + 1]) >= -lost))
    # The gap is positive between the samples, too, if its largest fall from one sample to the next
    # is smaller than its least sampled value.
    steepest = float(-np.diff(gap[top:]).min(initial=0.0))
    return rising and lowest > max(steepest, TOLERANCES.noise * float(gap[top])), lowest


def stated(zone: ClosedZone) -> Value:
    """The stated error of the ends and the pressure, without the stated error of the profile."""
    problem, way = zone.problem, zone.problem.map
    if problem.corner is not None:
        return TOLERANCES.singular_end * TOLERANCES.rounding + 0.0 * zone.half
    scale, _, follows = zone.sums
    scale = scale + abs(problem.kink)
    # `left` is the estimated sum of the truncated coefficients. The coefficients are assumed to
    # decrease geometrically, from 1 to `EPS` over the number of nodes.
    left = 4.0 * (1.0 - zone.nodes / math.log(EPS)) * zone.tail
    weight = way.weight(zone.half_width)
    # The weight is w = cos A and the half length sin A, with A = pi (half width)/period. So a
    # relative error e of the half length changes w by less than e/w.
    turns = 0.0 if way.period is None else 1.0 / weight
    pressure = zone.end_error * (follows + scale * turns) + left + SUM_ROUND_OFF * scale
    rise = way.load_factor / weight
    of_ends = zone.end_error * zone.half * rise / zone.widths + 0.5 * EPS
    return TOLERANCES.rounding + np.maximum(of_ends, pressure * zone.widths / zone.totals)
