"""Bracketed Newton method for the load at which a growing quantity has a wanted value.

A solution under a load always exists and is unique, so that a bracket on the load cannot fail.
Newton's step assumes that the quantity is a power of the load, plus a constant. The exponent is
fitted to the last two rates: about -2 for the approach of a tilted body, 1 for other approaches,
1/2 for a contact fraction. Each load is solved from the zones at the nearest load solved before.
The approach of an upright body is concave in the load and stays below its tangents, which soon show
that no load has the wanted approach.

The load for a user-defined control is found by the same method. A second solution under a slightly
smaller load gives the rates of the quantity, of the zones and of the pressure. From these the error
that comes from the load is estimated.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from contact.errors import NotConverged, OutOfRange
from contact.formulation.quadrature import chebyshev_nodes
from contact.formulation.tolerances import TOLERANCES
from contact.model.plugin_checks.forms import AuthorMethod
from contact.model.profiles.noise import EPS
from contact.model.scene import Scene
from contact.search.options import SEARCH
from contact.solution.solution import Solution

# Relative step of the load for difference quotients: the fourth root of the round-off. A smaller
# step would magnify the errors of the solutions. A larger step would make the quotient inexact.
RATE_STEP = math.sqrt(math.sqrt(EPS))


# A function that returns a quantity of a solution, and its derivative by the load [per N/m].
Quantity = Callable[[Solution], tuple[float, float]]
# A function that returns the solution under a load, found from the nearest known solution.
Solve = Callable[[float, Solution | None], Solution]


@dataclass(frozen=True)
class KnownLoads:
    """Prior knowledge about the loads of a search."""

    least: float = 0.0  # [N/m]; loads up to this one have no solution
    bounded: bool = False  # a large load may bring the contact to the end of the known profile
    concave: bool = False  # the quantity is concave in the load
    # The search ends once the width of the bracket of loads, divided by the load, is below this
    # value.
    closed: float = TOLERANCES.balance


def approach(solution: Solution) -> tuple[float, float]:
    """The approach [m] of a solution, and the derivative of the approach by the load.

    If the displacement contains the logarithm of distance / datum, this derivative may be negative.
    """
    assert solution.approach is not None and solution.stiffness is not None
    return solution.approach, 1 / solution.stiffness


def contact_fraction(solution: Solution) -> tuple[float, float]:
    """The contact fraction of a solution, and the derivative of this fraction by the load."""
    assert solution.contact_fraction is not None
    return solution.contact_fraction, solution.fields.widening_rate


def nearer(
    solve: Solve, quantity: Quantity, goal: float, first: float, limits: KnownLoads = KnownLoads()
) -> Iterator[tuple[Solution, float]]:
    """Yield solutions at which a quantity approaches `goal`, each with the error of its load.
    The error is relative to the load.

    first: the load to begin with [N/m]. The search ends when the bracket is closed, or when no load
    can give the goal. Raises OutOfRange if no load has a solution at all.
    """
    search = _Bracket(goal, limits, first)
    refused: OutOfRange | None = None
    unsolved = 0
    for _ in range(SEARCH.max_loads):
        before, load = search.last, search.load
        try:
            here = solve(load, search.nearest)
        except OutOfRange as refusal:
            refused = refusal
            search.narrow(from_above=limits.bounded if before is None else load > before.load)
            if limits.concave and before is None and load < SEARCH.light_load * first:
                break
            step = math.nan
        except NotConverged:
            unsolved += 1
            if before is None or unsolved > SEARCH.max_attempts:
                raise
            step = math.sqrt(load * before.load)
        else:
            value, rate = quantity(here)
            last_rate = None if before is None else (before.load, quantity(before)[1])
            error = abs((goal - value) / rate / load) if rate > 0.0 else math.inf
            step = search.add(here, value, rate, last_rate)
            yield here, error
            if error <= limits.closed:
                break
        if search.is_over(step):
            break
    if search.last is None and refused is not None:
        raise refused


class _Bracket:
    """An interval of loads in which the quantity reaches `goal`, with the newest solutions."""

    def __init__(self, goal: float, limits: KnownLoads, first: float) -> None:
        self.goal, self.limits = goal, limits
        self.low, self.high = limits.least, math.inf
        self.load = max(first, 2 * limits.least)
        # The last solutions of the search: at most three, the newest one last.
        self.solutions: list[Solution] = []
        # Lower and upper bound of the wanted load, from tangents of a quantity that is concave in
        # the load.
        self.tangents = (0.0, math.inf)
        # `slow_steps`: number of successive steps that halved neither the bracket nor `distance`,
        # which is the distance of the quantity from `goal`.
        self.slow_steps, self.distance = 0, math.inf

    @property
    def last(self) -> Solution | None:
        """The newest solution of the search; None before the first one."""
        return self.solutions[-1] if self.solutions else None

    @property
    def nearest(self) -> Solution | None:
        """The known solution whose load is closest to `load`, the load that is tried next."""
        if not self.solutions:
            return None
        return min(self.solutions, key=lambda other: abs(math.log(other.load / self.load)))

    def narrow(self, from_above: bool) -> None:
        """Move the upper or the lower end of the bracket to the present load."""
        if from_above:
            self.high = self.load
        else:
            self.low = self.load

    def add(
        self, here: Solution, value: float, rate: float, last_rate: tuple[float, float] | None
    ) -> float:
        """Narrow the bracket by the solution `here`; return Newton's next load, or nan."""
        load, shortfall = self.load, self.goal - value
        rises = rate > 0.0 and shortfall > 0.0  # the rate is negative beyond a maximum
        kept = [other for other in self.solutions[-2:] if (other.load > here.load) == rises]
        self.solutions = [*kept, here]
        width = self.high - self.low
        self.narrow(from_above=not rises)
        halved = self.high - self.low < 0.5 * width or abs(shortfall) < 0.5 * self.distance
        self.slow_steps, self.distance = 0 if halved else self.slow_steps + 1, abs(shortfall)
        tangent = load + shortfall / rate if rate != 0.0 else math.nan
        if rises:
            self.tangents = (tangent, self.tangents[1])
        elif rate < 0.0:
            self.tangents = (self.tangents[0], tangent)
        return _newton(here.load, rate, shortfall, last_rate)

    def is_over(self, step: float) -> bool:
        """Choose the next load, `step` or one in the bracket; return whether the search ends."""
        is_closed_above, is_closed_below = self.high < math.inf, self.low > 0.0
        stalled = self.slow_steps > 2 and is_closed_above and is_closed_below
        if not self.low < step < self.high or stalled:
            if is_closed_above and is_closed_below:
                step = math.sqrt(self.low * self.high)
            else:
                step = 10 * self.low if is_closed_below else 0.1 * self.high
            self.slow_steps = 0
        if self.limits.concave and not self.tangents[0] < min(self.tangents[1], self.high):
            return True
        self.load = step
        return self.high - self.low <= self.limits.closed * self.low


def _newton(
    load: float, rate: float, shortfall: float, before: tuple[float, float] | None
) -> float:
    """Newton's next load for a quantity A + B load^`power`; nan if there is none.

    rate: the rate at this load. before: another load and its rate; both rates give `power`, which
    is limited to values from -4 to 1.
    """
    power = 1.0
    if before is not None and before[0] != load and before[1] * rate > 0.0:
        power += math.log(rate / before[1]) / math.log(load / before[0])
    power = min(max(power, -4.0), 1.0)
    relative = shortfall / rate / load if rate != 0.0 else math.nan
    # If `power * relative` is small, `base ** (1 / power)` would lose digits. Its linear
    # approximation is used instead.
    if abs(power * relative) < 1e-6:
        return load * (1.0 + relative)
    base = 1.0 + power * relative
    if base > 0.0 and abs(math.log(base) / power) < 300.0:  # no overflow
        return float(load * base ** (1.0 / power))
    return math.nan


def by_quantity(
    scene: Scene,
    tol: float,
    warm_start: Solution | None,
    solve: Callable[[Scene, float, Solution | None], Solution],
) -> Solution:
    """The contact at which a user-defined quantity has a given value.

    solve: function that returns the solution of a scene to a tolerance, from a similar solution.
    """
    control, sign = scene.control_object, -1.0 if scene.control_object.falls else 1.0
    tolerance = max(SEARCH.tight_factor * tol, SEARCH.least_error)
    method = AuthorMethod(f"{control.name}.of(solution)", "control")
    pairs: dict[float, Solution] = {}  # for each load, the solution under a slightly smaller one

    def under(load: float, start: Solution | None) -> Solution:
        here = solve(scene.under("load", load), tolerance, start or warm_start)
        smaller = scene.under("load", load * (1.0 - RATE_STEP))
        pairs[here.load] = solve(smaller, tolerance, here)
        return here

    def quantity(solution: Solution) -> tuple[float, float]:
        other = pairs[solution.load]
        value = method.number(control.of, solution)
        change = value - method.number(control.of, other)
        return sign * value, sign * change / (solution.load - other.load)

    first = (
        SEARCH.light_load * scene.E_star * _length(scene) if warm_start is None else warm_start.load
    )
    best: Solution | None = None
    # `sides` tells whether the quantity exceeded the goal at the loads tried so far. If `sides`
    # contains True and False, the goal is reached at a load between two of those loads.
    sides: set[bool] = set()
    goal, limits = sign * control.value, KnownLoads(bounded=True)
    for here, load_error in nearer(under, quantity, goal, first, limits):
        value, rate = quantity(here)
        sides.add(value > goal)
        own = 3 * here.error * abs(value / (rate * here.load)) if rate else math.inf
        error = here.error + (load_error + own) * _rate_of_error(here, pairs[here.load])
        best = replace(here, scene=scene, error=float(error))
        if best.error <= tol:
            best.plan.decide("control", "a load search", f"{control.name} is user-defined")
            return best
    if best is None or not math.isfinite(best.error) or len(sides) < 2:
        raise OutOfRange(f"no load gives {control.name} = {control.value:.15g}")
    raise NotConverged(
        f"not converged: the load that gives {control.name} = {control.value:.15g} was not found "
        "accurately enough",
        (),
        best,
    )


def _length(scene: Scene) -> float:
    """A typical length of the scene [m], from which the first load is chosen."""
    return scene.profile.period or scene.profile.resolution or 1.0


def _rate_of_error(here: Solution, other: Solution) -> float:
    """Relative change of zone ends and pressures per unit of ln(load), times 2 as a margin.

    Changes of ends are relative to the width of their zone, those of pressures to the peak.
    The result is infinite if `here` and `other` have different numbers of zones.
    """
    if len(here.zones) != len(other.zones):
        return math.inf
    if len(here.zones) == 0:
        return 1.0
    moved = np.abs(here.zones - other.zones).max(axis=1) / here.zone_widths
    peak = here.max_pressure
    if not math.isfinite(peak):
        peak = here.load / float(here.zone_widths.sum())
    changed = [
        np.abs(
            here.pressure_at(chebyshev_nodes(8), zone) - other.pressure_at(chebyshev_nodes(8), zone)
        ).max()
        / peak
        for zone in range(len(here.zones))
    ]
    return 2.0 * float(max(moved.max(), *changed)) / RATE_STEP
