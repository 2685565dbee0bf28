"""More nodes until nothing changes: the error of a spot is stated from what was seen, not from a rate believed."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from math import inf
from typing import Any

import numpy as np

from contact.axisymmetric.answer import Spot
from contact.axisymmetric.system import Condition, Kind, State, refine_topology
from contact.errors import NotConverged, OutOfRange
from sie import Array

NODES = (16, 32, 64, 128, 256)
_PROBES = np.array([0.1, 0.5, 0.9])
_ROUNDING = 1e-14  # no statement below the rounding of a few transforms
_EPS = 2.2e-16
_GROW = 2.0**0.125


def settled(kinds: Sequence[Kind], start: Array, condition: Condition) -> Iterator[State]:
    """Newton's states on ever more nodes, each from the one before."""
    for n in NODES:
        state = refine_topology(kinds, start, condition, n)
        start = state.radii
        yield state


def spot_of(j: int, kinds: Sequence[Kind], state: State, E_star: float, rings: float) -> Spot:
    """The spot of one kind in a solved system."""
    kind, reach = kinds[j], inf
    for i in np.flatnonzero(state.radii > 0).tolist():
        seen = kind.around[i]
        if seen.kernel is not None:
            reach = min(reach, seen.kernel.nearest - float(state.radii[i]))
        elif seen.circle > 0:
            reach = min(reach, seen.circle)
    return Spot(
        kind.profile, E_star, float(state.radii[j]), E_star * float(state.forces[j]), kind.depth, state.delta,
        kind.density, rings, state.surfaces[j], reach,
    )


def refined(states: Iterable[State], spots_of: Callable[[State], list[Spot]], tol: float) -> list[Spot]:
    """The spots of the first state that differs from the one before by less than tol, checked, their error stated."""
    last: list[Spot] | None = None
    trace: list[float] = []
    for state in states:
        spots = spots_of(state)
        for spot in spots:
            if not spot.load > 0:
                raise OutOfRange(f"a spot of radius {spot.radius:.6g} m would carry no load there")
        if not any(spot.surface.sources for spot in spots):
            trace.append(0.0)  # nothing was discretised: the first step is in closed form
        else:
            trace.append(inf if last is None else max(map(_difference, spots, last)))
        if trace[-1] <= tol:
            return [_stated(spot, trace, tol) for spot in spots]
        last = spots
    raise NotConverged(f"{NODES[-1]} nodes leave a change of {trace[-1]:.2e}, above tol = {tol:.2e}", trace, last)


def _difference(new: Spot, old: Spot) -> float:
    """Largest relative change, that of the pressure at equal r/a and relative to its mean."""
    pressure = new.pressure(_PROBES * new.radius) - old.pressure(_PROBES * old.radius)
    return max(
        abs(new.load / old.load - 1.0),
        abs(new.radius / old.radius - 1.0),
        float(np.max(np.abs(pressure))) / new.mean_pressure,
    )


def _stated(spot: Spot, trace: list[float], tol: float) -> Spot:
    """The spot with its error: the last change, or the balance of load and pressure if that is worse."""
    spot.check()
    # A spot just born feels the rounding of approach and depth, which are much larger than its own penetration.
    own = float(spot.profile.line(spot.radius))
    error = max(trace[-1], abs(spot.balance()), _ROUNDING, 4.0 * _EPS * (abs(spot.approach) + spot.depth) / own)
    spot = replace(spot, error=error)
    if error > tol:
        why = "the profile's derivatives are not that good" if trace[-1] < error else "too few nodes"
        raise NotConverged(f"load and pressure balance to {error:.2e} only, tol = {tol:.2e}: {why}", trace, spot)
    return spot


def first_radius(growing: Callable[[float], Any], target: float, scale: float) -> float:
    """The smallest radius where a quantity that starts from 0 reaches the target: a start for Newton.

    A fall on the way ends the branch from zero load: OutOfRange.
    """
    a = 1e-3 * scale
    while growing(a) >= target:
        a *= 0.5
        if a < 1e-60 * scale:
            break
    last = growing(a)
    for _ in range(2000):
        new = growing(a * _GROW)
        if not np.isfinite(new) or new < last * (1.0 - 1e-9):
            raise OutOfRange(f"no spot carries this: what it carries falls beyond a radius of {a:.6g} m")
        if new >= target:
            low, high = a, a * _GROW
            for _ in range(40):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if growing(middle) < target else (low, middle)
            return 0.5 * (low + high)
        a, last = a * _GROW, new
    raise OutOfRange("no spot of any size carries this load")
