"""Positions at which the fields of a solution are sampled for figures and files.

The positions are evenly spaced over the shown interval; Chebyshev points on each zone are added. At
a distance d from an end the pressure is proportional to sqrt(d) and the gap to d^(3/2). Both are
smooth functions of the angle of the Chebyshev points.
"""

from dataclasses import dataclass

import numpy as np

from contact.errors import SceneError
from contact.solution.quantities import PEAKS
from contact.solution.solution import Solution
from sie import Array, Mask


@dataclass(frozen=True)
class PointOptions:
    """Numbers of positions at which the fields of a solution are sampled for drawing."""

    screen_points: int = 6000  # evenly spaced over a picture: a few on each column of pixels
    zone_points: int = 97  # on each zone, in addition to the evenly spaced ones


POINTS = PointOptions()


def window(solution: Solution) -> tuple[float, float]:
    """The interval [m] that figures and files show.

    It is the period, all of a trace, or the zones with as much space again on either side.
    """
    profile, period = solution.scene.profile, solution.scene.period
    if period is not None:
        return profile.x0, profile.x0 + period
    if profile.known is not None:
        return profile.known
    if len(solution.zones) == 0:
        raise SceneError(
            "there is no interval to show: the surfaces are apart, and the profile has neither a "
            "period nor ends. Use a value of the control at which the surfaces touch",
            "zones",
        )
    lo, hi = float(solution.zones.min()), float(solution.zones.max())
    return lo - (hi - lo), hi + (hi - lo)


def zones_within(solution: Solution, lo: float, hi: float) -> Array:
    """Zones and their periodic images, cut to [lo, hi].

    In full contact there is one zone, all of [lo, hi]; if the surfaces are apart there is none.
    """
    zones, period = solution.zones, solution.scene.period
    if len(zones) == 0 and not solution.contact_fraction:
        return np.zeros((0, 2))
    if period is not None and len(zones) == 0:
        return np.array([[lo, hi]])
    if period is not None:
        turns = np.arange(
            np.floor((lo - zones.max()) / period), np.ceil((hi - zones.min()) / period) + 1
        )
        zones = (zones[None, :, :] + period * turns[:, None, None]).reshape(-1, 2)
    cut = np.clip(zones[np.argsort(zones[:, 0])], lo, hi)
    return np.asarray(cut[cut[:, 1] > cut[:, 0]])


def positions(solution: Solution, lo: float, hi: float, most: int = 20_000) -> Array:
    """Ascending positions from lo to hi, close enough to draw each field by straight lines.

    most: largest number of evenly spaced positions. All zones together get about as many more; each
    zone gets at least its ends and its middle.
    """
    # `lengths`: how many of the profile's shortest lengths fit into the interval, but at least
    # `zone_points`. A smooth profile states no shortest length.
    lengths = max((hi - lo) / (solution.scene.profile.resolution or np.inf), POINTS.zone_points)
    even = int(min(PEAKS.samples_per_length * lengths, most))
    parts = _parts_between_kinks(solution, zones_within(solution, lo, hi))
    count = int(np.clip(most // max(len(parts), 1), 3, POINTS.zone_points))
    within = parts[:, :1] + np.diff(parts) * np.sin(np.linspace(0.0, 0.5 * np.pi, count)) ** 2
    within[:, -1] = parts[:, 1]
    x = np.concatenate([np.linspace(lo, hi, even + 1), within.ravel()])
    return np.unique(x[(x >= lo) & (x <= hi)])


def on_zones(x: Array, zones: Array) -> Mask:
    """Whether each position lies in a zone or at its end; the zones are in ascending order."""
    if len(zones) == 0:
        return np.zeros(x.shape, dtype=bool)
    nearest = np.maximum(np.searchsorted(zones[:, 0], x, side="right") - 1, 0)
    return (x >= zones[nearest, 0]) & (x <= zones[nearest, 1])


def top_pressure(solution: Solution) -> float:
    """The largest pressure [Pa] for scaling a figure.
    If the largest pressure is infinite, the result is four times the mean pressure on the zones.
    """
    if np.isfinite(solution.max_pressure):
        return solution.max_pressure
    return float(4.0 * abs(solution.load) / max(np.sum(solution.zone_widths), 1e-300))


def surfaces(solution: Solution, x: Array) -> tuple[Array, Array]:
    """Heights [m] of the lower surface, drawn deformed, and of the body above, drawn rigid.

    Outside the sharp corners of a body there is no surface: the upper height is inf, the lower one
    -inf.
    """
    profile = solution.scene.profile
    face = profile.counter_height(x)
    surface = face - np.max(face[np.isfinite(face)], initial=-np.inf) - solution.displacement(x)
    # The body is drawn as rigid. So the height of one point in contact gives the position of the
    # whole body.
    own = np.asarray(profile.bodies["profile"].height(x)) - (solution.tilt or 0.0) * x
    zones = zones_within(solution, float(x[0]), float(x[-1]))
    there = np.isfinite(surface) & np.isfinite(own)
    touching = there & np.isin(x, zones)
    place = int(np.argmax(touching if touching.any() else there))
    away = 0.0 if touching.any() else float(solution.gap(x[place]))
    return surface, own + (surface[place] + away - own[place])


def _parts_between_kinks(solution: Solution, zones: Array) -> Array:
    """The zones, cut into parts (m, 2) at kinks of the profile and at the ends of plateaus.

    Next to a kink the pressure is logarithmic, and next to a plateau it changes as the square root
    of the distance. So positions must be close together at the ends of each part.
    """
    profile, period = solution.scene.profile, solution.scene.period
    kinks = profile.kinks[:, 0]
    if solution.scene.law.pressure_range.has_limit:
        kinks = np.concatenate((kinks, solution.plateaus.ravel()))
    if period is not None:
        kinks = np.concatenate([kinks - period, kinks, kinks + period])
    inside = kinks[np.any((zones[:, :1] < kinks) & (kinks < zones[:, 1:]), axis=0)]
    return np.sort(np.concatenate([zones.ravel(), inside, inside])).reshape(-1, 2)


def peak_position(solution: Solution, x: Array, pressure: Array) -> float:
    """The middle of the zone with the largest pressure; in full contact, the place of the peak."""
    # Among peaks that differ only by round-off, the peak nearest to the middle of the positions x
    # is taken.
    highest = x[pressure >= (1.0 - 1e-9) * np.max(pressure)]
    peak = float(highest[np.argmin(np.abs(highest - 0.5 * (x[0] + x[-1])))])
    for left, right in zones_within(solution, float(x[0]), float(x[-1])):
        if left <= peak <= right and len(solution.zones):
            return float(0.5 * (left + right))
    return peak
