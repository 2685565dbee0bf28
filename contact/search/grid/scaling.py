"""A scene in scaled variables: where the origin is, what lengths, slopes and loads are counted in,
where zones are looked for.

A periodic profile is counted in its period; one without a period in the half width of the contact
itself, found roughly first, so that nanometres and kilometres, and loads over tens of decades, come
to about the same numbers. Either is taken to the nearest power of two. A turned body is counted
likewise, and repeats nothing; where its tilt is unknown, a rough one is found with the contact.
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
from contact.model.profiles.tilted import Tilted
from contact.model.scene import Scene
from contact.search.grid.nested_grids import NoWindow, find_window, grid_height
from contact.search.grid.tilt import (
    Window,
    held_by,
    known_part,
    response_of,
    tilt_search,
    window_at_load,
)
from sie import Array, record

# How far from a window it is looked for deeper places, over its half width, at how many, and how
# often.
_FARTHEST = 1e8
_LOOKS = 1024
_DESCENTS = 12
# Where a shape that states no size is looked at [m], how many of the last places must be level, and
# to what part of its rise; a load over E* and the approach that such a shape surely bears.
_SEEN = np.geomspace(1e-9, 1e9, 2048)
_FAR_OUT = 256
_LEVEL = 1e-12
_LIGHT = 1e-3


@record
class ScaledScene:
    """The scaled problem, the scaled control, and the cell or window [m] that holds all contact."""

    problem: Problem
    control: Control
    cell: Window


def scaled_scene(scene: Scene, single: bool, tilt: float = 0.0) -> ScaledScene:
    """Scale a scene; single: its contact is known to begin as one zone about x = 0. tilt: a first
    guess, where it is unknown.
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
    """The scaled of a lone body with about these zones [m]; of one that turns, about at this tilt."""
    lo, hi = float(zones[0, 0]), float(zones[-1, 1])
    known = known_part(scene.profile) or (-np.inf, np.inf)
    window = (max(known[0], 2 * lo - hi), min(known[1], 2 * hi - lo))
    profile = Tilted(scene.profile, tilt) if scene.turned else scene.profile
    return _frame_of(scene, profile, scene.profile.support or window)


def _turned(scene: Scene, guess: float) -> ScaledScene:
    """The scaled of a body turned by a given or an unknown tilt."""
    if scene.moment is None:
        assert scene.tilt is not None
        profile = Tilted(scene.profile, scene.tilt)
        return _frame_of(scene, profile, _window(scene, profile))
    lean = tilt_search(scene, guess)
    return _frame_of(scene, Tilted(scene.profile, lean.tilt), lean.window)


def _frame_of(scene: Scene, profile: Profile, window: Window) -> ScaledScene:
    """Scaled by a window that holds the contact. The approach counts, at x = 0, from where the body
    is not turned.
    """
    length = 2.0 ** round(math.log2(0.5 * (window[1] - window[0])))
    units = Units(
        _middle_or_tip(profile, window),
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
    """A window that holds the contact at the given tilt."""
    load, fixed, find = scene.given_load, held_by(profile), _finder(scene, profile)
    try:
        if load is not None:
            return window_at_load(scene, profile, load)
        first = fixed or find(profile.height, load=_light(scene))
        level, deepest = _lowest_unturned(scene), lowest(profile, first)
        value = scene.held(Quantity.APPROACH)
        assert value is not None
        if level + value <= deepest:
            raise OutOfRange(
                f"approach {value:.6g} m at x = 0 leaves the body clear: turned by {profile.tilt:.6g} it touches from "
                f"{deepest - level:.6g} m on"
            )
        return fixed or find(profile.height, level=level + value)
    except NoWindow as failure:
        raise OutOfRange(
            f"turned by {profile.tilt:.6g}, the body finds no hold: {failure}"
        ) from failure


def _lowest_unturned(scene: Scene) -> float:
    """min f of the body as it is given."""
    profile = scene.profile
    cell = profile.support or profile.extent
    if cell is None and profile.period is None and profile.summits is None:
        cell = _about_lowest(profile, _finder(scene, profile), _light(scene), _dip(profile))
    return lowest(profile, cell)


def _finder(scene: Scene, profile: Profile) -> Callable[..., Window]:
    """`find_window` of a body alone."""
    response = response_of(scene, scene.operator.datum or 1.0)
    return partial(
        find_window, response=response, start_scale=profile.resolution, limits=profile.extent
    )


def _light(scene: Scene) -> float:
    """A load that is light over the datum."""
    return 1e-3 * scene.E_star * (scene.operator.datum or 1.0)


def _about_lowest(
    profile: Profile, find: Callable[..., Window], load: float, start: Window | None
) -> Window:
    """A window of the contact under a load. Any contact holds the lowest point: the points of wide
    windows may miss it, or there may be a tip before it.
    """
    window = find(partial(grid_height, profile), load=load, start=start)
    for _ in range(_DESCENTS):
        deeper = _deeper(profile, window)
        if deeper is None:
            break
        half = 0.5 * (window[1] - window[0])
        window = find(profile.height, load=load, start=(deeper - half, deeper + half))
    return window


def _isolated_origin(scene: Scene, single: bool) -> tuple[float, float, Window]:
    """Origin, length and search window of a profile without a period."""
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
        window = _about_lowest(profile, find, load, _dip(profile))
    else:
        # The lowest point is in contact at any load: a window of any contact holds it.
        dip, value = _dip(profile), scene.held(Quantity.APPROACH)
        assert value is not None
        light = _light(scene) if dip is None else value * scene.E_star * _LIGHT
        first = _about_lowest(profile, find, light, dip)
        window = find(
            profile.height, level=lowest(profile, first) + value, start=first, light=light
        )
    origin = 0.0 if profile.symmetric else _middle_or_tip(profile, window)
    return origin, 0.5 * (window[1] - window[0]), window


def _dip(profile: Profile) -> Window | None:
    """Of a shape that states no size and levels off far away, where wide windows would see nothing:
    a window about its lowest place, as wide as it takes to rise by half. None of any other shape.
    """
    if profile.resolution is not None or profile.extent is not None or profile.kinks.size:
        return None
    x = np.concatenate((-_SEEN[::-1], [0.0], _SEEN))
    with np.errstate(all="ignore"):
        f = np.asarray(profile.height(x), dtype=np.float64)
    rise = f - f.min()
    if (
        not np.isfinite(rise).all()
        or np.ptp(rise[_SEEN.size + 1 :][-_FAR_OUT:]) + np.ptp(rise[:_FAR_OUT])
        > _LEVEL * rise.max()
    ):
        return None
    lowest_at = x[int(np.argmin(rise))]
    half = float(np.abs(x - lowest_at)[rise > 0.5 * rise.max()].min(initial=np.inf))
    return (float(lowest_at) - half, float(lowest_at) + half) if 0.0 < half < np.inf else None


def _deeper(profile: Profile, window: Window) -> float | None:
    """A place outside a window where the profile lies lower than in it, of declared tips and of
    places ever farther away; None if none was seen.
    """
    centre, half = 0.5 * (window[0] + window[1]), 0.5 * (window[1] - window[0])
    away = half * np.geomspace(1.0, _FARTHEST, _LOOKS)
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


def _middle_or_tip(profile: Profile, window: Window) -> float:
    """Where x is counted from: the lowest sharp tip within a window, since an end that comes close
    to one is known by its distance from it (a wedge that stands on its flank); the middle, where
    there is none.
    """
    tips = profile.kinks[profile.kinks[:, 1] > 0, 0]
    tips = tips[(window[0] < tips) & (tips < window[1])]
    return (
        float(tips[np.argmin(profile.height(tips))]) if len(tips) else 0.5 * (window[0] + window[1])
    )


def _typical_slope(scene: Scene, profile: Profile, length: float, cell: Window) -> float:
    lo, hi = cell
    x = lo + (hi - lo) * (np.arange(32) + 0.4142) / 32
    with np.errstate(over="ignore", invalid="ignore"):
        slopes = np.abs(np.asarray(profile.slope(x)))
    slope = float(np.max(slopes[np.isfinite(slopes)], initial=0.0))
    if slope > 0.0 and not scene.is_flat:
        return slope
    # A flat punch, turned or not, bears its load by its corners.
    if scene.given_load is None:
        return max(slope, 1.0)
    work = scene.law.tension * scene.law.reach
    adhesion = max(
        abs(scene.law.intensity(scene.E_star)), math.sqrt(scene.E_star * work / math.pi)
    ) / (scene.E_star * math.sqrt(length))
    return max(slope, abs(scene.given_load) / (scene.E_star * length), adhesion)
