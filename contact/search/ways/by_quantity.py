"""Controls of one's own: the load whose contact has the value asked for, by a bracket on the load.

How the quantity and the zones change with the load is told by a second load beside each. Rates of zones say by how much the contact may
differ from that of the value itself, for what the load is known to.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from contact.errors import NotConverged, OutOfRange
from contact.model.scene import Scene
from contact.search.ways.by_load import nearer
from contact.solution.solution import Solution

# A load beside another one, and the tolerance under either, over what is wanted; the least that is asked for.
_BESIDE, _TIGHTER, _LEAST = 1e-4, 1e-2, 1e-13
# Of half the peak's place to the next: where pressures are compared.
_POSITIONS = np.cos(np.pi * (np.arange(8) + 0.5) / 8)
# Load over E* and the length of the scene to begin with.
_FIRST = 1e-3


def by_quantity(
    scene: Scene, tol: float, near: Solution | None, solve: Callable[[Scene, float, Solution | None], Solution]
) -> Solution:
    """The contact under a control that the solver does not hold. solve: under a load."""
    control, sign = scene.control_object, -1.0 if scene.control_object.falls else 1.0
    tighter = max(_TIGHTER * tol, _LEAST)
    pairs: dict[float, Solution] = {}

    def under(load: float, close: Solution | None) -> Solution:
        here = solve(scene.under("load", load), tighter, close or near)
        pairs[here.load] = solve(scene.under("load", load * (1.0 - _BESIDE)), tighter, here)
        return here

    def grown(solution: Solution) -> tuple[float, float]:
        beside = pairs[solution.load]
        value = control.of(solution)
        return sign * value, sign * (value - control.of(beside)) / (solution.load - beside.load)

    first = near.load if near is not None else _FIRST * scene.E_star * _length(scene)
    best: Solution | None = None
    for here, off in nearer(under, grown, sign * control.value, first, bounded=True):
        value, rate = grown(here)
        off = off + 3 * here.error * abs(value / (rate * here.load)) if rate else math.inf
        best = replace(here, scene=scene, error=float(here.error + off * _rate_of_error(here, pairs[here.load])))
        if best.error <= tol:
            return best
    if best is None or not math.isfinite(best.error):
        raise OutOfRange(f"no load has the {control.name} {control.value:.15g}")
    raise NotConverged(f"not converged: the load of the {control.name} {control.value:.15g} is known too roughly", (), best)


def _length(scene: Scene) -> float:
    return scene.profile.period or scene.profile.resolution or 1.0


def _rate_of_error(here: Solution, beside: Solution) -> float:
    """What ends move over their zone's width, and pressures change over the peak, with the log of the load; inf where zones differ."""
    if len(here.zones) != len(beside.zones):
        return math.inf
    if len(here.zones) == 0:
        return 1.0
    moved = np.abs(here.zones - beside.zones).max(axis=1) / here.zone_widths
    peak = here.max_pressure if math.isfinite(here.max_pressure) else here.load / float(here.zone_widths.sum())
    changed = [
        np.abs(here.pressure_at(_POSITIONS, zone) - beside.pressure_at(_POSITIONS, zone)).max() / peak for zone in range(len(here.zones))
    ]
    return 2.0 * float(max(moved.max(), *changed)) / _BESIDE
