"""The sliders of a scene: its control, the numbers of its parts, and the size of its shape.

This module knows no profile, law or substrate by name. Each number of a part has a slider of its
own. The lists of numbers of a profile share two sliders: the amplitude multiplies the lists that
scale all heights, and the length multiplies the lists that scale the x axis. The module doubles the
lists to find out what they scale. A further slider replaces the shape by a number of samples.
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
from contact.model.profiles.noise import ROUND_OFF
from contact.model.registry import PROFILES, parameters
from contact.model.scene import Scene
from contact.solution.solution import Solution
from contact.sweeps.sweep.keys import MODULUS, varied

_LENGTHS = "amplitude period length radius spacing width thickness height datum shift".split()
UNITS = {**TURNING, **dict.fromkeys(_LENGTHS, "m"), "E_star": "Pa", "work": "J/m²"}


@dataclass(frozen=True)
class HandleOptions:
    """Options for the ranges and the resolution of the sliders."""

    # Largest value of a slider, divided by the present value. The smallest value is the present
    # value divided by this number.
    reach: float = 10.0
    # Smallest and largest number of samples that a slider can set.
    samples: tuple[int, int] = (8, 1024)
    # Number of positions of a slider between its smallest and its largest value.
    steps: int = 400


SLIDERS = HandleOptions()


@dataclass(frozen=True)
class Handle:
    """A slider for one number of a scene, with its range.

    at: function that returns a given scene with another value of the number.

    log: whether the slider is logarithmic. whole: whether values are integers, with 0 for "as it
    is".
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
    """The sliders of a scene, in the order in which their values must be applied.

    The slider of the control comes first.

    solution: the scene's solution if it is known; its pull-off sets the range of the control.
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
    found += _placements(scene.profile)
    found += [
        handle for place in ("substrate", "law", "interaction") for handle in _numbers(scene, place)
    ]
    found.append(_times(MODULUS, scene.E_star))
    return _named_apart([*found, *_samples(scene.profile)])


def moduli_handles(material: Mapping[str, float]) -> tuple[Handle, ...]:
    """Sliders for the elastic constants of a scene file: E1, nu1, E2 and nu2.
    Empty if the file gives E_star instead.

    Their function `at` changes nothing: a scene knows E* only, which follows from all four.
    """
    if "E1" not in material:
        return ()
    return tuple(
        replace(_times(MODULUS, float(value)), name=name, at=_as_it_is)
        if name.startswith("E")
        else Handle(name, "", float(value), 0.0, 0.5, _as_it_is)
        for name, value in material.items()
    )


def _as_it_is(scene: Scene, _: float) -> Scene:
    return scene


def _named_apart(found: list[Handle]) -> tuple[Handle, ...]:
    """The sliders, with a number added to names that occur more than once."""
    names = [handle.name for handle in found]
    numbered = [
        f"{name} {names[: place + 1].count(name)}" if names.count(name) > 1 else name
        for place, name in enumerate(names)
    ]
    return tuple(replace(handle, name=name) for handle, name in zip(found, numbered, strict=True))


def with_values(scene: Scene, moved: Mapping[str, float], known: tuple[Handle, ...]) -> Scene:
    """The scene in which the sliders that were moved have their new values."""
    for handle in known:
        if handle.name in moved and moved[handle.name] != handle.value:
            scene = handle.at(scene, moved[handle.name])
    return scene


def _between(key: str, value: float, low: float, high: float, log: bool = False) -> Handle:
    """A slider with range `low` to `high`; `key` names the number of the scene that it changes.

    For keys, see `contact.sweeps.sweep.keys`.
    """
    name = key.rpartition(".")[2]
    return Handle(
        name, UNITS.get(name, ""), value, low, high, lambda now, to: varied(now, {key: to}), log
    )


def _times(key: str, value: float, decades_down: int = 1) -> Handle:
    """A logarithmic slider around the present value; `key` names the number that it changes."""
    high, low = SLIDERS.reach * value, SLIDERS.reach**-decades_down * value
    return _between(key, value, low, high, log=True)


def _control(scene: Scene, solution: Solution | None) -> Handle:
    (name, value), held = scene.control, scene.control_object.held(scene)
    key = f"control.{name}"
    if held is not None and held.quantity is Quantity.WIDTH:
        return _between(key, value, min(0.005, value), 1.0)
    if scene.law.pressure_range.has_tension and scene.control_object.signed(scene):
        known = solution is not None and scene.law.equilibria.several
        pull_off = solution.pull_off if solution is not None and known else None
        pull = getattr(pull_off, name, None) if pull_off is not None else None
        reach = max(abs(value), abs(pull or 0.0)) or scene.E_star * 1e-6
        return _between(key, value, -1.2 * reach, 2 * reach)
    if value <= 0:
        return _between(key, value, -4 * abs(value) or -1.0, 4 * abs(value) or 1.0)
    # The slider reaches from a thousandth of `value` to ten times `value`. At ten times the load,
    # most periodic contacts are full.
    return _times(key, value, decades_down=3)


def _numbers(scene: Scene, place: str) -> list[Handle]:
    """Sliders for the positive parameters of a part of the scene, such as its law."""
    part = getattr(scene, place)
    numbers = {
        name: value
        for name, value in parameters(part).items()
        if isinstance(value, float) and value > 0
    }
    found = {name: _times(f"{place}.{name}", value) for name, value in numbers.items()}
    units = getattr(type(part), "units", {})
    return [
        _allowed(scene, replace(handle, unit=handle.unit or str(units.get(name, "")).strip("1")))
        for name, handle in found.items()
    ]


def _allowed(scene: Scene, handle: Handle) -> Handle:
    """The slider with its upper limit lowered to the largest value of a valid scene."""

    def valid(value: float) -> bool:
        try:
            return handle.at(scene, value) is not None
        except ContactError:
            return False

    high = handle.high
    if not valid(high):
        low, step = handle.value, (high - handle.low) / SLIDERS.steps
        while high - low > step:
            middle = 0.5 * (low + high)
            low, high = (middle, high) if valid(middle) else (low, middle)
        high = low
    return replace(handle, high=high)


def _placements(profile: Profile) -> list[Handle]:
    """Sliders for the position of each body relative to the other one.

    The ranges reach half the body's length to each side of the present position.
    """
    found = []
    for place, table in profile.tables().items():
        body = profile.bodies[place]
        own, (lo, hi) = body.tables()["profile"], body.known or profile.known or (-0.5, 0.5)
        positions = {
            name: value
            for name, value in table.items()
            if name not in own and isinstance(value, float)
        }
        found += [
            _between(f"{place}.{name}", value, value - 0.5 * (hi - lo), value + 0.5 * (hi - lo))
            for name, value in positions.items()
        ]
    return found


def _shape(scene: Scene, place: str) -> list[Handle]:
    """Sliders for a profile's amplitude, its length, and its other positive parameters."""
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
        # Two bodies share one period. Therefore no slider changes the length of one body alone.
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
    """A slider that multiplies several parameters of one body by the same factor."""

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
    places: int = 33,
) -> tuple[str, ...]:
    """Smallest set of parameters whose doubling multiplies heights and lengths as required.
    The factors are `heights` for the heights of the profile and `lengths` for its lengths.

    The result is empty if there are no such parameters.

    places: number of places at which heights are compared.
    """
    lo, hi = profile.known or (-0.5, 0.5)
    x = lo + (hi - lo) * (np.arange(places) + 0.3) / places
    height = heights * np.asarray(profile.height(x))
    for count in range(1, len(names) + 1):
        for chosen in combinations(names, count):
            try:
                other = type(profile)(
                    **{**given, **{name: _scaled(given[name], 2.0) for name in chosen}}
                )
            except Exception:  # a user's class may raise anything for doubled parameters
                continue
            if _alike(height, np.asarray(other.height(lengths * x))):
                return chosen
    return ()


def _alike(a: Any, b: Any) -> bool:
    """Whether two arrays differ only by a constant and by round-off."""
    away = (a - a[0]) - (b - b[0])
    return bool(np.isfinite(away).all() and np.max(np.abs(away)) <= ROUND_OFF * np.ptp(a))


def _depth(profile: Profile) -> float:
    """The range of the profile's heights, rounded to four digits."""
    lo, hi = profile.known or (-0.5, 0.5)
    height = np.asarray(profile.height(np.linspace(lo, hi, 2001)))
    return float(f"{np.ptp(height):.4g}")


def _samples(profile: Profile) -> list[Handle]:
    """A slider that replaces the shape by a spline through a number of evenly spaced points.

    It shows what a coarser instrument would measure. Empty for shapes that are not known
    everywhere.
    """
    if profile.support is not None or profile.known is None or len(profile.bodies) > 1:
        return []

    def at(now: Scene, to: float) -> Scene:
        shape, count = now.profile, round(to)
        lo, hi = shape.known or (-0.5, 0.5)
        x = np.linspace(lo, hi, count, endpoint=shape.period is None)
        trace = PROFILES.find("sampled")(x, -np.asarray(shape.height(x)), shape.period)
        return replace(now, profile=trace)

    fewest, most = SLIDERS.samples
    lengths = (len(value) for value in profile.parameters().values() if np.ndim(value) == 1)
    high = max(most, next((length for length in lengths if length > fewest), 0))
    return [Handle("samples", "", 0.0, fewest - 1, high, at, log=True, whole=True)]


def rounded(value: float) -> float:
    """A slider's value rounded to four digits, which is the resolution of the slider."""
    return float(f"{value:.4g}") if math.isfinite(value) else value
