"""The load at which what grows with it has a given value: the approach of a body, or the fraction
of a surface in contact.

Solutions under a load are the sure ones, and a bracket on the load cannot fail. Newton's step is
one on a power of the load, the one that the last two rates ask for: the approach goes with 1/load^2
where a tilt makes most of it, elsewhere about with the load, the contact fraction with its root as
a rule. Every state on the way is a solution under its load, from the zones of the nearest one.
Upright, contact only grows with the load: the approach is concave in it, below its tangents, which
tell soon that no load has the approach.

Of controls of one's own the load whose contact has the value asked for is found by a bracket, too.
How the quantity and the zones change with the load is told by a second load beside each. Rates of
zones say by how much the contact may differ from that of the value itself, for what the load is
known to.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from contact.errors import NotConverged, OutOfRange
from contact.model.parts import Told
from contact.model.scene import Scene
from contact.solution.solution import Solution

_CLOSED = 1e-9
_MOST = 80
# Of the first load: the logarithm of the datum over a width changes it by less.
_LIGHT = 1e-4
# Loads at which no solution was found, beside which another is tried.
_MISSES = 4

# A quantity and its rate with the load [per N/m].
Grown = Callable[[Solution], tuple[float, float]]


def approach(solution: Solution) -> tuple[float, float]:
    """The approach [m], and its rate: beyond its maximum over a datum it is negative."""
    assert solution.approach is not None and solution.stiffness is not None
    return solution.approach, 1 / solution.stiffness


def contact_fraction(solution: Solution) -> tuple[float, float]:
    """The part of the period in contact, and its rate."""
    assert solution.contact_fraction is not None
    return solution.contact_fraction, solution.fields.widening_rate


def nearer(
    solved: Callable[[float, Solution | None], Solution],
    grown: Grown,
    goal: float,
    first: float,
    least: float = 0.0,
    bounded: bool = False,
    concave: bool = False,
    closed: float = _CLOSED,
) -> Iterator[tuple[Solution, float]]:
    """Solutions ever nearer to where the grown quantity has the value `goal`, with what part of
    their load they are off by, as far as their rate tells; ends where the bracket has closed to
    `closed` of the load, or where no load has the goal.

    solved(load, near). first: a load to begin with [N/m], least: one that is too small. bounded:
    the contact of a large load may reach the end of what is known of the body. concave: the
    quantity is, in the load. Raises OutOfRange if no load has a solution at all.
    """
    low, high, load = least, math.inf, max(first, 2 * least)
    found: list[Solution] = []  # the last below and above the goal, the newest at the end
    refused: OutOfRange | None = None
    misses, slow = 0, 0
    reach = (0.0, math.inf)  # loads between which tangents allow the goal
    for _ in range(_MOST):
        step, before = math.nan, found[-1] if found else None
        bracket = (low, high)
        try:
            here = solved(
                load,
                min(found, key=lambda other: abs(math.log(other.load / load))) if found else None,
            )
        except OutOfRange as refusal:
            refused = refusal
            too_large = bounded if before is None else load > before.load
            low, high = (low, load) if too_large else (load, high)
            if concave and before is None and load < _LIGHT * first:
                break
        except NotConverged:
            misses += 1
            if before is None or misses > _MISSES:
                raise
            step = math.sqrt(load * before.load)
        else:
            value, rate = grown(here)
            miss = goal - value
            step = _newton(
                here.load, rate, miss, None if before is None else (before.load, grown(before)[1])
            )
            # The rate is negative beyond a maximum.
            rises = rate > 0.0 and miss > 0.0
            found = [*(other for other in found[-2:] if (other.load > here.load) == rises), here]
            off = abs(miss / rate / load) if rate > 0.0 else math.inf
            yield here, off
            if off <= closed:
                break
            low, high = (load, high) if rises else (low, load)
            tangent = load + miss / rate if rate != 0.0 else math.nan
            reach = (tangent, reach[1]) if rises else (reach[0], tangent) if rate < 0.0 else reach
            # Where the rate is no guide, the bracket is halved.
            slow = 0 if high - low < 0.5 * (bracket[1] - bracket[0]) else slow + 1
        if not low < step < high or (slow > 2 and 0.0 < low and high < math.inf):
            step = (
                math.sqrt(low * high)
                if 0.0 < low and high < math.inf
                else 10 * low
                if low > 0.0
                else 0.1 * high
            )
            slow = 0
        if concave and not reach[0] < min(reach[1], high):
            break
        load = step
        if high - low <= closed * low:
            break
    if not found and refused is not None:
        raise refused


def _newton(load: float, rate: float, miss: float, before: tuple[float, float] | None) -> float:
    """The load at which value = constant + B load^q is right, with the rate found here and q from
    (load, rate) before; nan if there is none.
    """
    power = 1.0
    if before is not None and before[0] != load and before[1] * rate > 0.0:
        power += math.log(rate / before[1]) / math.log(load / before[0])
    power = min(max(power, -4.0), 1.0)
    relative = miss / rate / load if rate != 0.0 else math.nan
    if abs(power * relative) < 1e-6:
        return load * (1.0 + relative)
    grown = 1.0 + power * relative
    return (
        load * grown ** (1.0 / power)
        if grown > 0.0 and abs(math.log(grown) / power) < 300.0
        else math.nan
    )


# A load beside another one, and the tolerance under either, over what is wanted; the least that is
# asked for.
_BESIDE = 1e-4
_TIGHTER = 1e-2
_LEAST = 1e-13
# Of half the peak's place to the next: where pressures are compared.
_POSITIONS = np.cos(np.pi * (np.arange(8) + 0.5) / 8)
# Load over E* and the length of the scene to begin with.
_FIRST = 1e-3


def by_quantity(
    scene: Scene,
    tol: float,
    near: Solution | None,
    solve: Callable[[Scene, float, Solution | None], Solution],
) -> Solution:
    """The contact under a control that the solver does not hold. solve: under a load."""
    control, sign = scene.control_object, -1.0 if scene.control_object.falls else 1.0
    tighter = max(_TIGHTER * tol, _LEAST)
    told = Told(f"{control.name}.of(solution)", "control")
    pairs: dict[float, Solution] = {}

    def under(load: float, close: Solution | None) -> Solution:
        here = solve(scene.under("load", load), tighter, close or near)
        pairs[here.load] = solve(scene.under("load", load * (1.0 - _BESIDE)), tighter, here)
        return here

    def grown(solution: Solution) -> tuple[float, float]:
        beside = pairs[solution.load]
        value = told.number(control.of, solution)
        return sign * value, sign * (value - told.number(control.of, beside)) / (
            solution.load - beside.load
        )

    first = near.load if near is not None else _FIRST * scene.E_star * _length(scene)
    best: Solution | None = None
    for here, off in nearer(under, grown, sign * control.value, first, bounded=True):
        value, rate = grown(here)
        off = off + 3 * here.error * abs(value / (rate * here.load)) if rate else math.inf
        best = replace(
            here,
            scene=scene,
            error=float(here.error + off * _rate_of_error(here, pairs[here.load])),
        )
        if best.error <= tol:
            return best
    if best is None or not math.isfinite(best.error):
        raise OutOfRange(f"no load has the {control.name} {control.value:.15g}")
    raise NotConverged(
        f"not converged: the load of the {control.name} {control.value:.15g} is known too roughly",
        (),
        best,
    )


def _length(scene: Scene) -> float:
    return scene.profile.period or scene.profile.resolution or 1.0


def _rate_of_error(here: Solution, beside: Solution) -> float:
    """What ends move over their zone's width, and pressures change over the peak, with the log of
    the load; inf where zones differ.
    """
    if len(here.zones) != len(beside.zones):
        return math.inf
    if len(here.zones) == 0:
        return 1.0
    moved = np.abs(here.zones - beside.zones).max(axis=1) / here.zone_widths
    peak = (
        here.max_pressure
        if math.isfinite(here.max_pressure)
        else here.load / float(here.zone_widths.sum())
    )
    changed = [
        np.abs(here.pressure_at(_POSITIONS, zone) - beside.pressure_at(_POSITIONS, zone)).max()
        / peak
        for zone in range(len(here.zones))
    ]
    return 2.0 * float(max(moved.max(), *changed)) / _BESIDE
