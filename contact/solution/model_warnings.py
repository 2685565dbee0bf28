"""What the model does not cover, said and not refused: slopes, pressures, moduli and traces that
are none of a rough elastic surface.

The bodies are half-planes, their strains small and elastic. Slopes and pressures over E* are
numbers without a unit and are judged in any system of units. Lengths are judged in files, whose
numbers have a unit, and where the modulus can only be one in pascals; the modulus is judged where
lengths can only be metres.
"""

import math
from collections.abc import Iterable

import numpy as np

from contact.model.profiles.base import Profile
from contact.model.scene import Scene
from contact.model.units import quantity
from contact.solution.preparation import preparation_warnings
from contact.solution.solution import Solution
from sie import Array

STEEPEST = 0.3
HIGHEST = 0.1  # of E*
# [Pa]: gels, and diamond on diamond.
_SOFTEST = 1e3
_STIFFEST = 2e12
# Diamond has 1.2e6 MPa: a larger number is one of pascals, and lengths are metres.
_PASCALS = 1e7
# [m]: from a few atoms to the longest machine parts, as of traces (contact.model.traces.prepare);
# and an atom.
_LENGTHS = (1e-9, 1.0)
_SHALLOWEST = 1e-11
# [m]: bodies this long are not given in micrometres, and with so low a modulus their scene has
# units of its own.
_OF_NO_UNIT = 1e-2
# Places a period in full contact, and in a zone.
_PLACES = 1024
# Of the left and the right end of a zone, at Chebyshev's nodes.
_T = np.cos((np.arange(8) + 0.5) * np.pi / 8)
_SHARES = 0.5 * np.stack((1.0 - _T, 1.0 + _T))
# In a few zones the pressure is nowhere so many times its mean over them, but at what is sharp.
_FEW = 4
_PEAK = 10.0


def scene_warnings(scene: Scene) -> tuple[str, ...]:
    """What can be said before it is solved."""
    return (*_of_modulus(scene), *_of_lengths(scene))


def _length(profile: Profile) -> float | None:
    """Length of the period, or from end to end; None of a shape that goes on for ever."""
    ends = profile.extent or profile.support
    return profile.period if ends is None or profile.period is not None else ends[1] - ends[0]


def _of_lengths(scene: Scene) -> tuple[str, ...]:
    """Lengths of shapes that were written by hand: a file's are looked at when it is read."""
    profile, length = scene.profile, _length(scene.profile)
    if (
        not _PASCALS <= scene.E_star <= _STIFFEST
        or length is None
        or any(body.preparation for body in profile.bodies.values())
    ):
        return ()
    told = f"a profile {quantity(length, 'm')} long"
    if not _LENGTHS[0] <= length <= _LENGTHS[1]:
        return (
            f"{told} on E_star = {quantity(scene.E_star, 'Pa')} is not that of a surface: all "
            "lengths of a scene are in metres",
        )
    # From the lowest to the highest place it is no more than half of the slopes' integral.
    depth = 0.5 * profile.slope_sizes[1] * length
    if 0.0 < depth < _SHALLOWEST:
        return (
            f"{told} is no deeper than {quantity(depth, 'm', 2)}, less than an atom: all lengths "
            "of a scene are in metres",
        )
    return ()


def _of_modulus(scene: Scene) -> tuple[str, ...]:
    modulus, length = scene.E_star, _length(scene.profile)
    if modulus > _STIFFEST:
        return (
            f"E_star = {modulus:.3g} Pa is that of no material, diamond's being 1.2e12 Pa: E_star "
            "is in pascals",
        )
    if modulus < _SOFTEST and modulus != 1.0 and length is not None and length < _OF_NO_UNIT:
        told = f"E_star = {modulus:.3g} Pa on a length of {quantity(length, 'm')}"
        return (f"{told} is softer than any gel: E_star is in pascals, not in MPa or GPa",)
    return ()


def solution_warnings(solution: Solution) -> tuple[str, ...]:
    """What can be said of the answer."""
    inside = _inside(solution)
    return (
        *_of_slopes(solution, inside),
        *_of_pressure(solution, inside),
        *preparation_warnings(solution),
    )


def scene_and_solution_warnings(solution: Solution) -> tuple[str, ...]:
    """What can be said of the answer, and of its scene."""
    return (*scene_warnings(solution.scene), *solution_warnings(solution))


def curve_warnings(solutions: Iterable[Solution]) -> tuple[str, ...]:
    """What can be said of many answers of one scene: of the highest load, and of unmeasured load."""
    by_load = sorted(solutions, key=lambda solution: solution.load)
    highest = scene_and_solution_warnings(by_load[-1])
    at_highest = preparation_warnings(by_load[-1])
    return highest if at_highest else (*highest, *preparation_warnings(by_load[0]))


def all_warnings(solution: Solution) -> list[str]:
    """The same, and what was said of a trace when its file was read."""
    return [
        *getattr(solution.scene.profile, "warnings", ()),
        *scene_and_solution_warnings(solution),
    ]


def _of_slopes(solution: Solution, places: Array) -> tuple[str, ...]:
    profile, tilt = solution.scene.profile, solution.tilt or 0.0
    with np.errstate(all="ignore"):
        slopes = np.asarray(profile.slope(places), dtype=float)
        inside = np.abs(slopes - tilt if tilt else slopes)
    # The place is found faster than the number.
    steepest = inside.item(inside.argmax()) if inside.size else 0.0
    if not math.isfinite(steepest):
        steepest = float(inside.max(initial=0.0, where=np.isfinite(inside)))
    largest, rms = profile.slope_sizes
    if tilt and profile.slopes_seen.size:
        whole = profile.slopes_seen - tilt
        largest, rms = float(np.abs(whole).max()), float(np.sqrt(np.mean(whole**2)))
    if max(steepest, rms) <= STEEPEST:
        return ()
    told = (
        f"slopes up to {steepest:.2g} in contact"
        if rms <= STEEPEST
        else f"slopes up to {largest:.2g}, {rms:.2g} on average"
    )
    return (
        f"{told}: a surface steeper than about {STEEPEST} is not the nearly plane one of the model",
    )


def _of_pressure(solution: Solution, places: Array) -> tuple[str, ...]:
    scene = solution.scene
    widths = np.asarray(solution.zone_widths)
    width = sum(widths.tolist()) if widths.size else scene.profile.period
    if width is None or not width > 0.0:
        return ()
    highest, what = solution.load / width, "mean contact pressure"
    bound = _PEAK * highest if widths.size <= _FEW else math.inf
    if min(bound, solution.fields.pressure_bound) <= HIGHEST * scene.E_star:
        return ()
    sharp = scene.profile.support is not None or any(
        jump > 0.0 for _, jump in np.reshape(scene.profile.kinks, (-1, 2)).tolist()
    )
    if not sharp:
        highest, what = float(np.max(solution.pressure(places))), "pressure"
    if highest <= HIGHEST * scene.E_star:
        return ()
    told = f"a {what} of {quantity(highest, 'Pa', 3)}, {highest / scene.E_star:.2g} of E*"
    return (
        f"{told}: above about {HIGHEST} of it strains are large, and few materials stay elastic",
    )


def _inside(solution: Solution) -> Array:
    """Places in every zone; in full contact over the period."""
    zones, profile = np.asarray(solution.zones), solution.scene.profile
    if not len(zones):
        if profile.period is None:  # surfaces apart
            return np.zeros(0)
        return profile.x0 + profile.period * (np.arange(_PLACES) + 0.25) / _PLACES
    return np.asarray(zones.dot(_SHARES).ravel())
