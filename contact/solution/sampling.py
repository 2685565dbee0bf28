"""Where to sample the fields of a solution: evenly over the scene, and closer at the ends of its
zones.

Pressure leaves an end as sqrt(d) and the gap as d^(3/2), d the distance, so each zone has its own
Chebyshev points, which are quadratically closer at the ends: sqrt(d) is smooth in the angle that
counts them.
"""

import numpy as np

from contact.errors import SceneError
from contact.solution.solution import Solution
from sie import Array, Mask

_EVEN_POINTS = 1000
_MOST_POINTS = 20_000
_POINTS_A_ZONE = (9, 97)
# Distances from a kink over the zone's half width: the pressure is logarithmic there.
_KINK_LADDER = 10.0 ** -np.arange(1.0, 7.0)


def window(solution: Solution) -> tuple[float, float]:
    """The stretch of x that shows the solution: the period, all of a trace, or the zones and once
    their span on either side.
    """
    profile, period = solution.scene.profile, solution.scene.period
    if period is not None:
        return profile.x0, profile.x0 + period
    if profile.known is not None:
        return profile.known
    if len(solution.zones) == 0:
        raise SceneError(
            "a lone body that touches nothing has no stretch to be shown on: its surfaces are apart",
            "zones",
        )
    lo, hi = float(solution.zones.min()), float(solution.zones.max())
    return lo - (hi - lo), hi + (hi - lo)


def zones_within(solution: Solution, lo: float, hi: float) -> Array:
    """The zones and their periodic images, cut to [lo, hi]; all of it at full contact, none of
    surfaces apart.
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


def positions(solution: Solution, lo: float, hi: float, most: int = _MOST_POINTS) -> Array:
    """Ascending positions in [lo, hi], both included, where straight lines between the samples show
    every field.

    `most`: of the even points, and about as many on the zones together, though never fewer than a
    few on each.
    """
    profile = solution.scene.profile
    even = _EVEN_POINTS
    if profile.resolution is not None:
        even = int(np.clip(10 * (hi - lo) / profile.resolution, even, most))
    zones = zones_within(solution, lo, hi)
    angles = np.linspace(0.0, np.pi, int(np.clip(most // max(len(zones), 1), *_POINTS_A_ZONE)))
    within = zones[:, :1] + np.diff(zones) * np.sin(0.5 * angles) ** 2
    within[:, -1] = zones[:, 1]
    x = np.concatenate(
        [np.linspace(lo, hi, even + 1), within.ravel(), _near_kinks(solution, zones)]
    )
    return np.unique(x[(x >= lo) & (x <= hi)])


def on_zones(x: Array, zones: Array) -> Mask:
    """Whether each position lies on a zone, ends included; the zones ascend."""
    if len(zones) == 0:
        return np.zeros(x.shape, dtype=bool)
    nearest = np.maximum(np.searchsorted(zones[:, 0], x, side="right") - 1, 0)
    return (x >= zones[nearest, 0]) & (x <= zones[nearest, 1])


def top_pressure(solution: Solution) -> float:
    """The highest pressure [Pa], or four times the mean on the zones where that is infinite."""
    if np.isfinite(solution.max_pressure):
        return solution.max_pressure
    return float(4.0 * abs(solution.load) / max(np.sum(solution.zone_widths), 1e-300))


def surfaces(solution: Solution, x: Array) -> tuple[Array, Array]:
    """(counter-face, body): heights [m], upwards, of the lower surface, which is given the
    displacement of both, and of the upper one.

    Beyond the sharp corners of a body there is none: the upper surface is inf and the lower one
    -inf there.
    """
    profile = solution.scene.profile
    face = profile.counter_height(x)
    surface = face - np.max(face[np.isfinite(face)], initial=-np.inf) - solution.displacement(x)
    # The body is not deformed: where it stands at one place says where it stands.
    own = np.asarray(profile.bodies["profile"].height(x)) - (solution.tilt or 0.0) * x
    zones = zones_within(solution, float(x[0]), float(x[-1]))
    there = np.isfinite(surface) & np.isfinite(own)
    touching = there & np.isin(x, zones)
    place = int(np.argmax(touching if touching.any() else there))
    away = 0.0 if touching.any() else float(solution.gap(x[place]))
    return surface, own + (surface[place] + away - own[place])


def _near_kinks(solution: Solution, zones: Array) -> Array:
    """Points closing in on each kink that lies in a zone."""
    profile, period = solution.scene.profile, solution.scene.period
    kinks = profile.kinks[:, 0]
    if period is not None:
        kinks = np.concatenate([kinks - period, kinks, kinks + period])
    owner, kink = np.nonzero((zones[:, :1] < kinks) & (kinks < zones[:, 1:]))
    steps = 0.5 * np.diff(zones)[owner] * np.concatenate([-_KINK_LADDER, _KINK_LADDER])
    return np.asarray((kinks[kink, None] + steps).ravel())


def peak_position(solution: Solution, x: Array, pressure: Array) -> float:
    """The middle of the zone of the highest sampled pressure, or the place of it at full contact."""
    # Equal peaks differ by rounding; the one nearest the middle is shown best.
    highest = x[pressure >= (1.0 - 1e-9) * np.max(pressure)]
    peak = float(highest[np.argmin(np.abs(highest - 0.5 * (x[0] + x[-1])))])
    for left, right in zones_within(solution, float(x[0]), float(x[-1])):
        if left <= peak <= right and len(solution.zones):
            return float(0.5 * (left + right))
    return peak
