"""A scene in scaled variables: where the origin is, what lengths, slopes and loads are counted in, where zones are looked for.

A periodic profile is counted in its period; one without a period in the half width of the contact itself, found roughly
first, so that nanometres and kilometres, and loads over tens of decades, come to about the same numbers. Either is taken to the
nearest power of two.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from contact.extrema import maximum
from contact.full import period_samples
from contact.problem import Control, Problem, Units
from contact.profiles.base import Profile
from contact.scene import Scene
from contact.search import find_window, grid_height
from contact.single import guess_half_width

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Framed:
    """The scaled problem, the scaled control, and the cell or window [m] that holds all contact."""

    problem: Problem
    control: Control
    cell: tuple[float, float]


def framed(scene: Scene, single: bool) -> Framed:
    """Scale a scene; single: its contact is known to begin as one zone about x = 0."""
    profile, period = scene.profile, scene.profile.period
    if period is not None:
        origin = 0.0 if profile.symmetric else profile.x0 + 0.5 * period
        length, cell = period, (profile.x0, profile.x0 + period)
    else:
        origin, length, cell = _isolated_frame(scene, single)
    length = 2.0 ** round(math.log2(length))
    units = Units(origin, length, _typical_slope(scene, length, cell), scene.E_star)
    problem = Problem(profile, scene.interaction, units, lowest(profile, cell))
    return Framed(problem, scaled_control(scene, units), cell)


def _isolated_frame(scene: Scene, single: bool) -> tuple[float, float, tuple[float, float]]:
    """Origin, length and search window of a profile without a period."""
    profile = scene.profile
    kind, value = scene.control
    if kind == "half_width":
        return 0.0, value, (-value, value)
    if profile.support is not None:
        lo, hi = profile.support
        return 0.5 * (lo + hi), 0.5 * (hi - lo), (lo, hi)
    if single:
        rough = Problem(profile, scene.interaction, Units(0.0, 1.0, 1.0, scene.E_star), float(profile.height(0.0)))
        a = guess_half_width(rough, scaled_control(scene, rough.units))
        return 0.0, a, (-2 * a, 2 * a)
    datum = getattr(scene.interaction, "datum", None)
    find = partial(find_window, start_scale=profile.resolution, datum=datum or 1.0, limits=profile.extent)
    if kind == "load":
        window = find(partial(grid_height, profile), scene.E_star, load=value)
    else:
        # The lowest point is in contact at any load: a window of any contact holds it.
        first = find(profile.height, scene.E_star, load=1e-3 * scene.E_star * (datum or 1.0))
        window = find(profile.height, scene.E_star, level=lowest(profile, first) + value)
    origin = 0.0 if profile.symmetric else 0.5 * (window[0] + window[1])
    return origin, 0.5 * (window[1] - window[0]), window


def lowest(profile: Profile, cell: tuple[float, float] | None = None) -> float:
    """min f, over the period or, without one, over a window that holds the tip."""
    if profile.summits is not None:
        return float(np.min(profile.height(np.asarray(profile.summits))))
    if profile.period is not None:
        x = period_samples(profile)
    else:
        assert cell is not None
        x = np.linspace(*cell, 1025)
    return -maximum(lambda points: -np.asarray(profile.height(points)), x)[1]


def _typical_slope(scene: Scene, length: float, cell: tuple[float, float]) -> float:
    lo, hi = cell
    x = lo + (hi - lo) * (np.arange(32) + 0.4142) / 32
    with np.errstate(over="ignore", invalid="ignore"):
        slopes = np.abs(np.asarray(scene.profile.slope(x)))
    slope = float(np.max(slopes[np.isfinite(slopes)], initial=0.0))
    if slope > 0.0:
        return slope
    kind, value = scene.control
    return value / (scene.E_star * length) if kind == "load" else 1.0


def scaled_control(scene: Scene, units: Units) -> Control:
    """The scene's control in scaled variables."""
    kind, value = scene.control
    period = scene.profile.period
    if kind == "mean_pressure":
        assert period is not None
        return Control("load", value * period / units.load)
    if kind == "load":
        return Control("load", value / units.load)
    if kind == "approach":
        return Control("approach", value / units.height)
    if kind == "half_width":
        return Control("half_width", value / units.length)
    assert period is not None
    return Control("width", value * period / units.length)
