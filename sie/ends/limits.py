"""Limits of free ends: an interval given by the user, and the domain of the right side."""

from dataclasses import replace

import numpy as np

from sie.basis.data import Array, record
from sie.basis.zones import SINGULAR, Zones
from sie.dense import modes
from sie.ends.options import NewtonOptions
from sie.equation.equation import Equation
from sie.slits.system import AnyDensity


@record
class DomainLimit:
    """Whether a Newton step would move ends of zones out of the domain of the right side.

    reached: whether an end that would leave the domain is already as close to the domain's border
    as is allowed; reason: message that names the ends that would leave the domain, or empty.
    """

    reached: bool
    reason: str


def domain_limit(zones: Zones, equation: Equation, delta: Array) -> DomainLimit:
    """Whether and where outward steps `delta` (2, Z) of ends would leave the allowed interval.

    The right side is known in this interval (`Equation.within`).
    """
    names, is_close = [], False
    distances, last = border_distances(zones, equation), len(zones) - 1
    for side, zone, name in ((0, 0, "left end of zone 0"), (1, last, f"right end of zone {last}")):
        distance = float(distances[side, zone])
        if delta[side, zone] >= distance:
            names.append(f"the {name} (counted from 0)")
            width = float(zones.b[zone] - zones.a[zone])
            is_close |= distance <= modes.least_distance() * width
    if not names:
        return DomainLimit(False, "")
    low, high = _interval(zones, equation)
    where = ", although the root may lie inside"
    if is_close:
        part = f"{modes.least_distance():.1g} of the zone's width"
        where = f": the root lies outside, at a limit, or nearer to it than {part}"
    limit = f"({low:.6g}, {high:.6g}) set by `within` or `until`{where}"
    return DomainLimit(
        is_close, f"in the next step {' and '.join(names)} would leave the interval {limit}"
    )


def border_distances(zones: Zones, equation: Equation) -> Array:
    """Distance (2, Z) of the outermost ends from the domain's border; infinite at other ends."""
    distances = np.full((2, len(zones)), np.inf)
    low, high = _interval(zones, equation)
    distances[0, 0], distances[1, -1] = zones.a[0] - low, high - zones.b[-1]
    return distances


def _interval(zones: Zones, equation: Equation) -> tuple[float, float]:
    """Interval allowed for ends: there the right side is known, and no outer plateau vanishes."""
    low, high = equation.within
    left, right = zones.left[0].until, zones.right[-1].until
    return low if left is None else max(low, left), high if right is None else min(high, right)


def pinned_at_limits(zones: Zones, limits: tuple[float, float]) -> Zones:
    """The zones, with each outermost end beyond `limits` fixed at the limit as a singular end."""
    low, high = zones.a[0] <= limits[0], zones.b[-1] >= limits[1]
    if not (low or high):
        return zones
    a, b, rest = zones.a.copy(), zones.b.copy(), zones.rest.copy()
    left, right = list(zones.left), list(zones.right)
    if low:
        a[0], rest[0, 0], left[0] = limits[0], 0.0, SINGULAR
    if high:
        b[-1], rest[1, -1], right[-1] = limits[1], 0.0, SINGULAR
    return replace(zones, a=a, b=b, rest=rest, left=left, right=right)


def released(zones: Zones, density: AnyDensity, options: NewtonOptions) -> tuple[Zones, bool]:
    """(zones in which some ends fixed at a limit are free again, whether any end was set free).

    An end is released if its intensity is below the one prescribed for a free end.
    """
    limits, end = options.limits, options.released_end
    if not np.isfinite(limits).any():
        return zones, False
    k_left, k_right = density.intensities
    least = end.intensity if end.moves and end.intensity is not None else 0.0
    low = zones.left[0] == SINGULAR and zones.a[0] == limits[0] and k_left[0] < least
    high = zones.right[-1] == SINGULAR and zones.b[-1] == limits[1] and k_right[-1] < least
    if not (low or high):
        return zones, False
    left = [end, *zones.left[1:]] if low else zones.left
    right = [*zones.right[:-1], end] if high else zones.right
    return replace(zones, left=left, right=right), True
