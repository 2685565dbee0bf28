"""What can be turned of a scene: its control, the numbers of its parts, the size of its shape, and
how many points a shape is read at.

Nothing here knows a profile, a law or a body by name. A number of a part is a handle of its own.
Lists of numbers are handled together: the lists that make all heights larger when they grow are the
amplitude, those that make the shape longer its length; which these are is tried out.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

import numpy as np

from contact.errors import ContactError
from contact.model.controls import TURNING, Quantity
from contact.model.profiles.base import Profile
from contact.model.registry import PROFILES, parameters
from contact.model.scene import Scene
from contact.solution.solution import Solution
from contact.sweeps.sweep.keys import MODULUS, varied

UNITS = {
    **TURNING, "E_star": "Pa", "amplitude": "m", "period": "m", "length": "m", "radius": "m", "spacing": "m", "width": "m",
    "thickness": "m", "height": "m", "work": "J/m²", "datum": "m", "shift": "m",
}  # fmt: skip
# How far a number goes either way: a control much lower than higher, as contact soon is full.
_CONTROL = (1e-3, 10.0)
_NUMBER = (0.1, 10.0)
_SAMPLES = (8, 1024)
_PLACES = 33  # where it is tried out what lists of numbers do
_SAME = 1e-9
_HALVINGS = 12


@dataclass(frozen=True)
class Handle:
    """One number that can be turned, from low to high; `at(scene, value)` is the scene with it.

    log: by equal factors. whole: whole numbers, of which 0 means as it is.
    """

    name: str
    unit: str
    value: float
    low: float
    high: float
    at: Callable[[Scene, float], Scene]
    log: bool = True
    whole: bool = False


def handles(scene: Scene, solution: Solution | None = None) -> tuple[Handle, ...]:
    """What can be turned of a scene, its control first, in the order in which it is to be applied.
    solution: of it, where there is one.
    """
    unit = str(scene.control_object.unit)
    found = [replace(_control(scene, solution), unit="" if unit == "1" else unit)]
    found += [
        _between(f"control.{name}", value, -2 * abs(value), 2 * abs(value))
        for name, value in scene.turning.items()
        if value
    ]
    found += _shape(scene, "profile")
    for place in scene.profile.bodies:
        if place != "profile":
            found += [
                replace(handle, name=f"{place} {handle.name}") for handle in _shape(scene, place)
            ]
    found += _stands(scene.profile)
    found += [
        handle for place in ("substrate", "law", "interaction") for handle in _numbers(scene, place)
    ]
    found.append(_times(MODULUS, scene.E_star))
    return _named_apart([*found, *_samples(scene.profile)])


def _named_apart(found: list[Handle]) -> tuple[Handle, ...]:
    """Numbers of two parts may have one name."""
    names = [handle.name for handle in found]
    told = [
        f"{name} {names[: place + 1].count(name)}" if names.count(name) > 1 else name
        for place, name in enumerate(names)
    ]
    return tuple(replace(handle, name=name) for handle, name in zip(found, told, strict=True))


def turned(scene: Scene, moved: Mapping[str, float], known: tuple[Handle, ...]) -> Scene:
    """The scene with the handles that were moved where they are now."""
    for handle in known:
        if handle.name in moved and moved[handle.name] != handle.value:
            scene = handle.at(scene, moved[handle.name])
    return scene


def _between(key: str, value: float, low: float, high: float, log: bool = False) -> Handle:
    """The number of a scene that has a key (`contact.sweeps.sweep.keys`)."""
    name = key.rpartition(".")[2]
    return Handle(
        name, UNITS.get(name, ""), value, low, high, lambda now, to: varied(now, {key: to}), log
    )


def _times(key: str, value: float, reach: tuple[float, float] = _NUMBER) -> Handle:
    """One above zero."""
    return _between(key, value, reach[0] * value, reach[1] * value, log=True)


def _control(scene: Scene, solution: Solution | None) -> Handle:
    (name, value), held = scene.control, scene.control_object.held(scene)
    key = f"control.{name}"
    if held is not None and held.quantity is Quantity.WIDTH:
        return _between(key, value, min(0.005, value), 1.0)
    if scene.law.pulls and scene.control_object.signed(scene):
        off = solution.pull_off if solution is not None and scene.law.bare is not None else None
        pull = getattr(off, name, None) if off is not None else None
        reach = max(abs(value), abs(pull or 0.0)) or scene.E_star * 1e-6
        return _between(key, value, -1.2 * reach, 4 * reach)
    if value <= 0:
        return _between(key, value, -4 * abs(value) or -1.0, 4 * abs(value) or 1.0)
    return _times(key, value, _CONTROL)


def _numbers(scene: Scene, place: str) -> list[Handle]:
    """Positive numbers that a part was made of."""
    numbers = {
        name: value
        for name, value in parameters(getattr(scene, place)).items()
        if isinstance(value, float) and value > 0
    }
    return [_allowed(scene, _times(f"{place}.{name}", value)) for name, value in numbers.items()]


def _allowed(scene: Scene, handle: Handle) -> Handle:
    """Reaching no higher than a scene may be made with."""

    def taken(value: float) -> bool:
        try:
            return handle.at(scene, value) is not None
        except ContactError:
            return False

    high = handle.high
    if not taken(high):
        low = handle.value
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if taken(middle) else (low, middle)
        high = max(low, handle.value * (1 + _SAME))
    return replace(handle, high=high)


# shapes
# ---------------------------------------------------------------------------------------------------------------
def _stands(profile: Profile) -> list[Handle]:
    """Lengths that tell how one of two bodies stands to the other: half of what there is of them to
    either side.
    """
    found = []
    for place, table in profile.tables().items():
        body = profile.bodies[place]
        own, (lo, hi) = body.tables()["profile"], body.known or profile.known or (-0.5, 0.5)
        stands = {
            name: value
            for name, value in table.items()
            if name not in own and isinstance(value, float)
        }
        found += [
            _between(f"{place}.{name}", value, value - 0.5 * (hi - lo), value + 0.5 * (hi - lo))
            for name, value in stands.items()
        ]
    return found


def _shape(scene: Scene, place: str) -> list[Handle]:
    """Positive numbers of the profile of a body, and what its lists of numbers do together."""
    profile = scene.profile.bodies[place]
    given = {name: value for name, value in profile.parameters().items() if value is not None}
    lists = [name for name, value in given.items() if np.ndim(value) == 1 and np.size(value)]
    found = []
    high = _together(profile, given, lists, heights=2.0)
    if high:
        found.append(
            _scale(place, "amplitude", _depth(profile), high)
            if profile.known
            else _scale(place, "heights, times", 1.0, high)
        )
    lengths = [name for name in given if name not in high and (name in lists or name == "period")]
    long = _together(profile, given, lengths, lengths=2.0) if lists else ()
    if scene.profile.period is not None and len(scene.profile.bodies) > 1:
        # Of two bodies that repeat together neither is stretched alone.
        given.pop("period", None)
    elif long:
        reach = profile.period or float(np.ptp(given[next(name for name in long if name in lists)]))
        found.append(
            _scale(place, "period" if profile.period is not None else "length", reach, long)
        )
    alone = [
        name
        for name, value in given.items()
        if name not in (*high, *long) and isinstance(value, float) and value > 0
    ]
    return found + [_times(f"{place}.{name}", given[name]) for name in alone]


def _scale(place: str, name: str, size: float, parameters: tuple[str, ...]) -> Handle:
    """Several parameters of a body at once."""

    def at(now: Scene, to: float) -> Scene:
        given = now.profile.bodies[place].parameters()
        return varied(now, {f"{place}.{key}": _scaled(given[key], to / size) for key in parameters})

    return replace(_times(name, size), at=at)


def _scaled(value: Any, factor: float) -> Any:
    return factor * np.asarray(value) if np.ndim(value) else factor * value


def _together(
    profile: Profile,
    given: Mapping[str, Any],
    names: list[str],
    heights: float = 1.0,
    lengths: float = 1.0,
) -> tuple[str, ...]:
    """The fewest parameters that multiply heights and lengths so when all are doubled."""
    lo, hi = profile.known or (-0.5, 0.5)
    x = lo + (hi - lo) * (np.arange(_PLACES) + 0.3) / _PLACES
    height = heights * np.asarray(profile.height(x))
    for count in range(1, len(names) + 1):
        for chosen in combinations(names, count):
            try:
                other = type(profile)(
                    **{**given, **{name: _scaled(given[name], 2.0) for name in chosen}}
                )
            except Exception:  # whatever an author's class raises: these are not for doubling
                continue
            if _alike(height, np.asarray(other.height(lengths * x))):
                return chosen
    return ()


def _alike(a: Any, b: Any) -> bool:
    """But for a constant."""
    away = (a - a[0]) - (b - b[0])
    return bool(np.isfinite(away).all() and np.max(np.abs(away)) <= _SAME * np.ptp(a))


def _depth(profile: Profile) -> float:
    """From the highest to the lowest place."""
    lo, hi = profile.known or (-0.5, 0.5)
    height = np.asarray(profile.height(np.linspace(lo, hi, 2001)))
    return float(f"{np.ptp(height):.4g}")


def _samples(profile: Profile) -> list[Handle]:
    """A shape read at so many even places, with the spline of measured points through them: what a
    coarser instrument would see.
    """
    if profile.support is not None or profile.known is None or len(profile.bodies) > 1:
        return []

    def at(now: Scene, to: float) -> Scene:
        shape, count = now.profile, round(to)
        lo, hi = shape.known or (-0.5, 0.5)
        x = np.linspace(lo, hi, count, endpoint=shape.period is None)
        trace = PROFILES.find("sampled")(x, -np.asarray(shape.height(x)), shape.period)
        return replace(now, profile=trace)

    points = next(
        (
            len(value)
            for value in profile.parameters().values()
            if np.ndim(value) == 1 and len(value) > _SAMPLES[0]
        ),
        0,
    )
    high = max(_SAMPLES[1], points)
    return [Handle("samples", "", 0.0, _SAMPLES[0] - 1, high, at, log=True, whole=True)]


def rounded(value: float) -> float:
    """A number that a hand has turned to, with the digits it can mean."""
    return float(f"{value:.4g}") if math.isfinite(value) else value
