"""A scene in scaled variables: the origin, the units, and an interval with all zones.

The unit of length of a periodic profile is about its period. Without a period it is about the half
width of the contact, which is found roughly first. So nanometres and kilometres, and loads over
tens of decades, lead to about the same numbers. Units of length are powers of two. A turned body
has no period; where its tilt is unknown, a rough tilt is found together with the contact.
"""

import math
from collections.abc import Callable
from functools import partial

import numpy as np

from contact.closed.half_width import guess_half_width
from contact.errors import OutOfRange
from contact.formulation.controls import Control, scaled_control
from contact.formulation.full_contact import lowest
from contact.formulation.problem import Problem
from contact.formulation.units import Units
from contact.model.controls import Quantity
from contact.model.profiles.base import Profile
from contact.model.profiles.noise import ROUND_OFF
from contact.model.profiles.tilted import Tilted
from contact.model.scene import Scene
from contact.search.grid.nested_grids import Height, NoWindow, find_window, grid_height
from contact.search.grid.tilt import OPTIONS as TILT
from contact.search.grid.tilt import (
    Window,
    first_window,
    held_by,
    known_part,
    response_of,
    tilt_search,
    window_at_load,
)
from contact.search.options import SEARCH
from contact.search.topology.loop import MAX_ROUNDS
from sie import Array, record

# A profile is level far away if its heights there differ by less than this fraction of its rise.
LEVEL = 1e-12


@record
class ScaledScene:
    """The scaled problem and control, and the interval `cell` [m] that contains all contact."""

    problem: Problem
    control: Control
    cell: Window


def scaled_scene(scene: Scene, single: bool, tilt: float = 0.0) -> ScaledScene:
    """The scaled problem and control of a scene, and the interval that contains all contact.

    single: whether the first guess is one zone about x = 0. tilt: a first guess of an unknown tilt.
    """
    if scene.turned:
        return _turned(scene, tilt)
    profile, period = scene.profile, scene.profile.period
    if period is not None:
        origin = 0.0 if profile.symmetric else profile.x0 + 0.5 * period
        length, cell = period, (profile.x0, profile.x0 + period)
    else:
        origin, length, cell = _isolated_origin(scene, single)
    length = 2.0 ** round(math.log2(length))
    units = Units(origin, length, _typical_slope(scene, profile, length, cell), scene.E_star)
    problem = Problem(
        profile, scene.interaction, scene.substrate, scene.law, units, lowest(profile, cell)
    )
    return ScaledScene(problem, scaled_control(scene, units), cell)


def scaled_scene_about(scene: Scene, tilt: float, zones: Array) -> ScaledScene:
    """The scaled scene of a lone body, from approximate zones [m] and an approximate tilt."""
    lo, hi = float(zones[0, 0]), float(zones[-1, 1])
    known = known_part(scene.profile) or (-np.inf, np.inf)
    window = (max(known[0], 2 * lo - hi), min(known[1], 2 * hi - lo))
    profile = Tilted(scene.profile, tilt) if scene.turned else scene.profile
    return _scaled_by(scene, profile, scene.profile.support or window)


def _turned(scene: Scene, guess: float) -> ScaledScene:
    """The scaled scene of a body turned by a given or an unknown tilt."""
    if scene.moment is None:
        assert scene.tilt is not None
        profile = Tilted(scene.profile, scene.tilt)
        return _scaled_by(scene, profile, _window(scene, profile))
    found = tilt_search(scene, guess)
    return _scaled_by(scene, Tilted(scene.profile, found.tilt), found.window)


def _scaled_by(scene: Scene, profile: Profile, window: Window) -> ScaledScene:
    """The scaled scene; an interval that contains the contact gives its origin and unit of length.

    The approach is measured at x = 0 of the body before it is turned.
    """
    length = 2.0 ** round(math.log2(0.5 * (window[1] - window[0])))
    units = Units(
        _origin_of(profile, window),
        length,
        _typical_slope(scene, profile, length, window),
        scene.E_star,
    )
    moment = None if scene.moment is None else scene.moment / units.moment
    level = lowest(profile, window) if scene.operator.datum is None else _lowest_unturned(scene)
    problem = Problem(
        profile, scene.interaction, scene.substrate, scene.law, units, level, moment=moment
    )
    return ScaledScene(problem, scaled_control(scene, units), window)


def _window(scene: Scene, profile: Tilted) -> Window:
    """An interval [m] of x that contains the contact of the body at the given tilt."""
    load, fixed, find = scene.given_load, held_by(profile), _finder(scene, profile)
    try:
        if load is not None:
            return window_at_load(scene, profile, load)
        first = fixed or find(profile.height, load=_small_load(scene))
        level, deepest = _lowest_unturned(scene), lowest(profile, first)
        value = scene.held(Quantity.APPROACH)
        assert value is not None
        if level + value <= deepest:
            raise OutOfRange(
                f"approach {value:.6g} m at x = 0 is too small: turned by the tilt "
                f"{profile.tilt:.6g}, the body first touches at {deepest - level:.6g} m"
            )
        return fixed or find(profile.height, level=level + value)
    except NoWindow as failure:
        raise OutOfRange(
            f"no contact was found for the body turned by {profile.tilt:.6g}: {failure}"
        ) from failure


def _lowest_unturned(scene: Scene) -> float:
    """Smallest height of the body before it is turned by the tilt."""
    profile = scene.profile
    cell = profile.support or profile.extent
    if cell is None and profile.period is None and profile.summits is None:
        cell = _window_about_lowest(
            profile, _finder(scene, profile), _small_load(scene), _window_of_shape(profile)
        )
    return lowest(profile, cell)


def _finder(scene: Scene, profile: Profile) -> Callable[..., Window]:
    """The function `find_window`, with the elastic response of the scene already filled in."""
    response = response_of(scene, scene.operator.datum or 1.0)

    def find(
        height: Height,
        load: float | None = None,
        level: float | None = None,
        start: Window | None = None,
    ) -> Window:
        """An interval [m] that contains the contact of a body with the given heights.

        Either the load is given, or the level, which is displacement plus height in the contact.
        """
        start = start or first_window(profile)
        return find_window(height, response, load, level, profile.extent, start)

    return find


def _small_load(scene: Scene) -> float:
    """A load so small that the contact is narrow compared with the datum, a length."""
    return SEARCH.light_load * scene.E_star * (scene.operator.datum or 1.0)


def _window_about_lowest(
    profile: Profile, find: Callable[..., Window], load: float, start: Window | None
) -> Window:
    """A search interval that contains the whole contact under a load.

    Any contact contains the lowest point. The sample points of a wide window may miss it, or find a
    tip that is not the lowest one.
    """
    window = find(partial(grid_height, profile), load=load, start=start)
    for _ in range(MAX_ROUNDS):
        deeper = _deeper_place(profile, window)
        if deeper is None:
            break
        half = 0.5 * (window[1] - window[0])
        window = find(profile.height, load=load, start=(deeper - half, deeper + half))
    return window


def _isolated_origin(scene: Scene, single: bool) -> tuple[float, float, Window]:
    """(origin of x, unit of length, search interval) of a profile without a period, in m."""
    profile = scene.profile
    half_width, load = scene.held(Quantity.HALF_WIDTH), scene.given_load
    if half_width is not None:
        return 0.0, half_width, (-half_width, half_width)
    if profile.support is not None:
        lo, hi = profile.support
        return 0.5 * (lo + hi), 0.5 * (hi - lo), (lo, hi)
    if single and scene.operator.rest is None:
        plain = Units(0.0, 1.0, 1.0, scene.E_star)
        rough = Problem(
            profile,
            scene.interaction,
            scene.substrate,
            scene.law,
            plain,
            float(profile.height(0.0)),
        )
        a = guess_half_width(rough, scaled_control(scene, rough.units))
        return 0.0, a, (-2 * a, 2 * a)
    find = _finder(scene, profile)
    if load is not None:
        window = _window_about_lowest(profile, find, load, _window_of_shape(profile))
    else:
        # The approach is measured from the profile's lowest point. This point is in contact under
        # any load, so it is sought in the contact under a light load.
        dip, value = _window_of_shape(profile), scene.held(Quantity.APPROACH)
        assert value is not None
        light = _small_load(scene) if dip is None else value * scene.E_star * SEARCH.light_load
        first = _window_about_lowest(profile, find, light, dip)
        window = find(profile.height, level=lowest(profile, first) + value, start=first, load=light)
    origin = 0.0 if profile.symmetric else _origin_of(profile, window)
    return origin, 0.5 * (window[1] - window[0]), window


def _window_of_shape(profile: Profile) -> Window | None:
    """An interval about the lowest place of a shape that is flat far away.
    None for a shape that is not flat far away.

    Such a shape states no resolution, and the points of a wide window may miss its lowest place.
    The window extends to where the shape has risen by half.
    """
    if profile.resolution is not None or profile.extent is not None or profile.kinks.size:
        return None
    scales = np.geomspace(1 / TILT.farthest, TILT.farthest, 2 * TILT.places)
    x = np.concatenate((-scales[::-1], [0.0], scales))
    with np.errstate(all="ignore"):
        f = np.asarray(profile.height(x), dtype=np.float64)
    rise = f - f.min()
    outer = TILT.places // 4  # beyond these samples the shape is level
    if (
        not np.isfinite(rise).all()
        or np.ptp(rise[-outer:]) + np.ptp(rise[:outer]) > LEVEL * rise.max()
    ):
        return None
    lowest_at = x[int(np.argmin(rise))]
    half = float(np.abs(x - lowest_at)[rise > 0.5 * rise.max()].min(initial=np.inf))
    return (float(lowest_at) - half, float(lowest_at) + half) if 0.0 < half < np.inf else None


def meets_far_away(scene: Scene, window: Window) -> float | None:
    """Distance [m] at which a body that is level far away meets the other body under the load.

    The displacement of a half-plane grows like the logarithm of the distance, (2 P / pi E*) ln(x),
    and so exceeds any rise of the profile. None if the body is not level far away, if no load is
    given, or if all points where the gap is tested are nearer than this distance.
    """
    profile, load = scene.profile, scene.given_load
    known = profile.period is not None or known_part(profile) is not None
    if known or scene.turned or not load or scene.operator.rest is not None:
        return None
    half = 0.5 * (window[1] - window[0])
    far = half * TILT.farthest
    heights = np.asarray(profile.height(np.array([-far, -0.5 * far, 0.5 * far, far])))
    rise = float(heights.min()) - lowest(profile, window)
    ratio = math.pi * scene.E_star * rise / (2.0 * load)
    if not np.ptp(heights) <= LEVEL * rise or ratio > -math.log(ROUND_OFF):
        return None
    return half * math.exp(ratio)


def _deeper_place(profile: Profile, window: Window) -> float | None:
    """A sampled place outside `window`, lower than all samples inside; None if there is none.

    The samples are the declared tips, and places at increasing distances from the window.
    """
    centre, half = 0.5 * (window[0] + window[1]), 0.5 * (window[1] - window[0])
    away = half * np.geomspace(1.0, TILT.farthest, TILT.places)
    tips = (
        profile.kinks[profile.kinks[:, 1] > 0, 0]
        if profile.summits is None
        else np.asarray(profile.summits, dtype=float)
    )
    known = known_part(profile) or (-np.inf, np.inf)
    outside = np.concatenate(
        (tips, np.clip(np.concatenate((centre - away, centre + away)), *known))
    )
    inside = np.concatenate((tips, np.linspace(*window, 257)))
    with np.errstate(over="ignore", invalid="ignore"):
        inside = inside[(window[0] <= inside) & (inside <= window[1])]
        heights, floor = np.asarray(profile.height(outside)), np.min(profile.height(inside))
    heights = np.where(
        np.isnan(heights) | ((window[0] <= outside) & (outside <= window[1])), np.inf, heights
    )
    return float(outside[np.argmin(heights)]) if heights.min() < floor else None


def _origin_of(profile: Profile, window: Window) -> float:
    """The origin of x: the lowest sharp tip in a window; the window's middle if it has no tip.

    An end may come close to a tip, as for a wedge that touches with its flank. Measured from the
    tip, the position of this end keeps its digits.
    """
    tips = profile.kinks[profile.kinks[:, 1] > 0, 0]
    tips = tips[(window[0] < tips) & (tips < window[1])]
    return (
        float(tips[np.argmin(profile.height(tips))]) if len(tips) else 0.5 * (window[0] + window[1])
    )


def _typical_slope(scene: Scene, profile: Profile, length: float, cell: Window) -> float:
    """The unit of slopes: the largest sampled slope; for a flat punch, from load and adhesion."""
    lo, hi = cell
    x = lo + (hi - lo) * (np.arange(32) + 0.4142) / 32
    with np.errstate(over="ignore", invalid="ignore"):
        slopes = np.abs(np.asarray(profile.slope(x)))
    slope = float(np.max(slopes[np.isfinite(slopes)], initial=0.0))
    if slope > 0.0 and not scene.is_flat:
        return slope
    # The slope of a flat punch, tilted or not, does not determine its pressure. Load and adhesion
    # determine it, and so give the unit of slopes. Without a given load the unit is at least 1.
    if scene.given_load is None:
        return max(slope, 1.0)
    work = scene.law.tension * scene.law.reach
    adhesion = max(
        abs(scene.law.intensity(scene.E_star)), math.sqrt(scene.E_star * work / math.pi)
    ) / (scene.E_star * math.sqrt(length))
    return max(slope, abs(scene.given_load) / (scene.E_star * length), adhesion)
