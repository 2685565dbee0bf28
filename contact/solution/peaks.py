"""The highest pressure of each zone."""

from collections.abc import Callable

import numpy as np

from contact.formulation.maxima import maximum
from contact.model.scene import Scene
from sie import Array

# Even angles of a zone that is smooth, for each length over which the profile varies, and at the most.
_ANGLES, _PER_FEATURE, _MOST = 48, 12, 2**14


def peaks(scene: Scene, zones: Array, pressure_at: Callable[[Array, int], Array]) -> Array:
    """Sampled closer than the profile varies and followed below the sampling; inf where a tip with a kink is in contact.

    zones (n, 2) [m]; pressure_at(t, zone) [Pa] at normalised positions of one of them.
    """
    found = np.empty(len(zones))
    tips = _tips(scene)
    resolution = scene.profile.resolution or np.inf
    for zone, (left, right) in enumerate(zones):
        if np.any((left < tips) & (tips < right)):
            found[zone] = np.inf
            continue
        count = int(min(_ANGLES + _PER_FEATURE * (right - left) / resolution, _MOST))
        # A zone's pressure is smooth in the angle.
        found[zone] = maximum(_in_angle(pressure_at, zone), np.linspace(0.0, np.pi, count + 1), levels=7)[1]
    return found


def _in_angle(pressure_at: Callable[[Array, int], Array], zone: int) -> Callable[[Array], Array]:
    return lambda angle: pressure_at(np.clip(np.cos(angle), -1.0, 1.0), zone)


def _tips(scene: Scene) -> Array:
    """Where the slope of the profile jumps upwards, and the images of these: zones lie within a period and the next."""
    kinks = np.reshape(scene.profile.kinks, (-1, 2))
    places = kinks[kinks[:, 1] > 0, 0]
    return places if scene.period is None else np.concatenate([places + turn * scene.period for turn in (-1, 0, 1)])
