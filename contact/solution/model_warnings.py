"""Warnings if slopes, pressures, moduli or lengths are outside the range of the model.

The model assumes half-planes and small elastic strains. Slopes, and pressures divided by E*, have
no unit: they are always checked. Lengths are checked only if the modulus is plainly in pascals,
since a scene may be given in other consistent units. Likewise, a small modulus is checked only if
the length is plainly in metres. Lengths from a file are checked when the file is read.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache

import numpy as np

from contact.formulation.quadrature import chebyshev_nodes
from contact.model.profiles.base import Profile
from contact.model.scene import Scene
from contact.model.units import quantity
from contact.solution.preparation import preparation_warnings
from contact.solution.solution import Solution
from sie import Array


@dataclass(frozen=True)
class ModelLimits:
    """Limits beyond which the model is doubtful, or a given number is probably in a wrong unit."""

    steepest: float = 0.3  # slope; steeper surfaces are not nearly plane
    highest: float = 0.1  # pressure divided by E*; above this strains are large
    softest: float = 1e3  # [Pa]: gels
    stiffest: float = 2e12  # [Pa]: diamond on diamond
    in_pascals: float = 1e7  # [Pa]: diamond has 1.2e6 MPa, so that a larger number is in pascals
    smallest: float = 1e-11  # [m]: less than an atom
    # Largest plausible length [m] of a surface, about that of a machine part. A longer surface was
    # probably given in another unit than metres.
    longest: float = 1.0


_LIMITS = ModelLimits()


def scene_warnings(scene: Scene) -> tuple[str, ...]:
    """Warnings about the scene that need no solution."""
    return (*_modulus_warnings(scene), *_length_warnings(scene))


def _length(profile: Profile) -> float | None:
    """Length [m] of the profile: its period or its extent; None for an infinite shape."""
    ends = profile.extent or profile.support
    return profile.period if ends is None or profile.period is not None else ends[1] - ends[0]


def _length_warnings(scene: Scene) -> tuple[str, ...]:
    """Warnings about the length of a profile whose numbers a user wrote by hand.
    A profile that is read from a file gives its own warnings.
    """
    profile, length = scene.profile, _length(scene.profile)
    if (
        not _LIMITS.in_pascals <= scene.E_star <= _LIMITS.stiffest
        or length is None
        or any(body.preparation for body in profile.bodies.values())
    ):
        return ()
    message = f"a profile {quantity(length, 'm')} long"
    if not _LIMITS.smallest <= length <= _LIMITS.longest:
        return (
            f"{message}, with E_star = {quantity(scene.E_star, 'Pa')}, is not realistic: give all "
            "lengths of the scene in metres",
        )
    # The height varies by at most half of the integral of |slope| over a period. This integral is
    # at most the rms slope times the length of the period.
    depth = 0.5 * profile.slope_sizes[1] * length
    if 0.0 < depth < _LIMITS.smallest:
        return (
            f"the heights of {message} vary by at most {quantity(depth, 'm', 2)}, less than an "
            "atom: give all lengths of the scene in metres",
        )
    return ()


def _modulus_warnings(scene: Scene) -> tuple[str, ...]:
    modulus, length = scene.E_star, _length(scene.profile)
    if modulus > _LIMITS.stiffest:
        return (
            f"E_star = {modulus:.3g} Pa is larger than that of any material (diamond: 1.2e12 Pa): "
            "give E_star in pascals",
        )
    if (
        modulus < _LIMITS.softest
        and modulus != 1.0
        and length is not None
        and length < _LIMITS.longest
    ):
        message = f"E_star = {modulus:.3g} Pa, for a profile {quantity(length, 'm')} long,"
        return (
            f"{message} is smaller than that of any gel: give E_star in pascals, not in MPa or GPa",
        )
    return ()


def solution_warnings(solution: Solution) -> tuple[str, ...]:
    """Warnings about the solution, without those that concern only its scene."""
    return (
        *_slope_warnings(solution),
        *_pressure_warnings(solution),
        *preparation_warnings(solution),
    )


def scene_and_solution_warnings(solution: Solution) -> tuple[str, ...]:
    """Warnings about the solution and its scene."""
    return (*scene_warnings(solution.scene), *solution_warnings(solution))


def curve_warnings(solutions: Iterable[Solution]) -> tuple[str, ...]:
    """Warnings about the solution at the highest load of a series.

    If none of them is about unmeasured intervals, such warnings at the lowest load are added.
    """
    by_load = sorted(solutions, key=lambda solution: solution.load)
    highest = scene_and_solution_warnings(by_load[-1])
    at_highest = preparation_warnings(by_load[-1])
    return highest if at_highest else (*highest, *preparation_warnings(by_load[0]))


def all_warnings(solution: Solution) -> list[str]:
    """All warnings about a solution, including warnings that were given when its trace was read."""
    return [
        *getattr(solution.scene.profile, "warnings", ()),
        *scene_and_solution_warnings(solution),
    ]


def _slope_warnings(solution: Solution) -> tuple[str, ...]:
    profile, tilt = solution.scene.profile, solution.tilt or 0.0
    with np.errstate(all="ignore"):
        slopes = np.asarray(profile.slope(_places_on_zones(solution)), dtype=float)
        inside = np.abs(slopes - tilt if tilt else slopes)
    # For few elements, argmax and item together are faster than max.
    steepest = inside.item(inside.argmax()) if inside.size else 0.0
    if not math.isfinite(steepest):
        steepest = float(inside.max(initial=0.0, where=np.isfinite(inside)))
    largest, rms = profile.slope_sizes
    if tilt and profile.slopes_seen.size:
        whole = profile.slopes_seen - tilt
        largest, rms = float(np.abs(whole).max()), float(np.sqrt(np.mean(whole**2)))
    if solution.contact_fraction == 1.0:
        steepest = largest
    if max(steepest, rms) <= _LIMITS.steepest:
        return ()
    message = (
        f"slopes up to {steepest:.2g} in contact"
        if rms <= _LIMITS.steepest
        else f"slopes up to {largest:.2g}, with an rms of {rms:.2g}"
    )
    return (
        f"{message}: the model assumes nearly plane surfaces, with slopes below about "
        f"{_LIMITS.steepest}",
    )


def _pressure_warnings(solution: Solution) -> tuple[str, ...]:
    scene = solution.scene
    widths = np.asarray(solution.zone_widths)
    width = sum(widths.tolist()) if widths.size else scene.profile.period
    if width is None or not width > 0.0:
        return ()
    highest, what = solution.load / width, "mean contact pressure"
    if solution.fields.pressure_bound <= _LIMITS.highest * scene.E_star:
        return ()
    if math.isfinite(solution.max_pressure):
        highest, what = solution.max_pressure, "largest pressure"
    if highest <= _LIMITS.highest * scene.E_star:
        return ()
    message = f"a {what} of {quantity(highest, 'Pa', 3)}, which is {highest / scene.E_star:.2g} E*"
    return (
        f"{message}: above about {_LIMITS.highest} E*, strains are large and few materials stay "
        "elastic",
    )


def _places_on_zones(solution: Solution, per_zone: int = 8) -> Array:
    """Sample places on all zones, with the same number of places on each zone."""
    return np.asarray(np.asarray(solution.zones).dot(_weights_of_ends(per_zone)).ravel())


@cache
def _weights_of_ends(count: int) -> Array:
    """Weights (2, count) that give `count` Chebyshev nodes in a zone.
    The nodes are the zone's ends (left, right) times the weights.
    """
    t = chebyshev_nodes(count)
    return 0.5 * np.stack((1.0 - t, 1.0 + t))
