"""One symmetric zone under a control, for one or several loads, by Newton's method on ln h.

h is the half length of the zone in the coordinate y of `contact.closed.line`. A tip may have a kink
J = f'(0+) - f'(0-). The part J/2 sgn(x), which jumps at the kink, is subtracted from the slope f'.
With the half width a, the period L, A = pi a/L and u = pi x/L, this part causes

    p = (E*/2) (J/pi) arcosh(tan A / tan |u|),      load = (E*/2) (J L/pi) artanh(sin A)

(Goryacheva & Tsukanov 2020, (25), as corrected in docs/theory.md). Without a period they are
(E*/2) (J/pi) arcosh(a/|x|) and (E*/2) J a. Under a flat punch with sharp corners at -a and a,
p = load cos u / (L sqrt(sin^2 A - sin^2 u)), or load / (pi sqrt(a^2 - x^2)) without a period
(Sadowsky 1928).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from contact.closed.line import LineMap, Value, choose, column, everywhere, largest
from contact.closed.series import orders, powers, table
from contact.formulation.full_contact import lowest
from contact.model.profiles.base import Profile
from contact.model.profiles.noise import EPS
from sie import Array, Mask, record

# Relative round-off of a sum of a few terms.
SUM_ROUND_OFF = 4 * EPS
# A zone whose half length is below this number loses digits, since such numbers are close to the
# smallest normal floating-point number.
SMALLEST = float(np.finfo(float).tiny) / EPS


@dataclass(frozen=True)
class OneZoneOptions:
    """Options of Newton's method on the half length of a zone, and of the samples around it."""

    # Number of decades in which a half length, or a position outside the zone, is searched if
    # nothing limits it. The loads of zones that are narrower are lost in round-off. A gap does not
    # close again at positions that are farther away.
    decades: int = 12
    # Number of half lengths of a zone that are scanned in each decade. The load or approach that is
    # controlled varies smoothly with the half length.
    points_per_decade: int = 4
    # Number of samples of the gap next to the zone. Farther from the zone, each decade of the
    # distance gets the same number of samples.
    outer_places: int = 32
    gauss_points: int = 64  # for the mean height, an integral of a smooth function of an angle
    first_nodes: int = 8  # a sinusoid or a parabola needs no more
    finer: int = 4  # factor to the next number of nodes if the series is not resolved
    max_nodes: int = 512  # contact over 0.95 of a period, the widest taken, needs some 250
    max_steps: int = 60  # five are usual; a load that no zone carries uses all of them
    # The number of nodes is raised only if the last Newton step in ln h was below this value, where
    # h is the half length of the zone. The series is then nearly that of the solution.
    refine_below: float = 0.1


OPTIONS = OneZoneOptions()


@record
class OneZoneProblem:
    """The data of one symmetric contact zone that are the same for all loads.

    kink: the jump J of the slope at x = 0. corner: half width [m] of a flat punch; None if the zone
    does not end at corners. limit: half width [m] that no zone exceeds.
    """

    profile: Profile
    map: LineMap
    kink: float
    corner: float | None
    limit: float

    @cached_property
    def top(self) -> float:
        """Upper limit of the half length h of the zone, in the mapped coordinate y of `LineMap`."""
        return float(self.map.y(self.limit)) if math.isfinite(self.limit) else math.inf

    def slopes(self, y: Array) -> Array:
        """The right side G(y) of the equation for one zone, at points y of the mapped line.
        G is (profile slope f' without the jump at the kink) / (weight w of the map).
        """
        x, weight = self.map.at(y)
        slope = np.asarray(self.profile.slope(x), dtype=np.float64)
        return np.asarray((slope - 0.5 * self.kink) / weight)

    def kink_load(self, half: Value) -> tuple[Value, Value]:
        """(R, dR/dh), with the half length h = `half` of the zone.
        R is the load due to the profile's kink, divided by E*/2.
        """
        if self.kink == 0.0:
            return 0.0, 0.0
        if self.map.period is None:
            return self.kink * half, self.kink
        factor = self.kink * self.map.load_factor
        return factor * np.arctanh(half), factor / ((1.0 - half) * (1.0 + half))

    def mean_height(self, half: Value) -> Value:
        """Mean over the zone of the height above the lowest point, f - min f [m].
        It is a mean over the angle arccos t, with t from -1 to 1 on the zone.
        """
        t, weights = _quarter_turn()
        height = np.asarray(self.profile.height(self.map.at(column(half) * t)[0]))
        return (height - lowest(self.profile)).dot(weights)

    def even_level(self, half: Value, datum: float | None) -> Value:
        """Logarithmic potential on the zone, under the unit load that displaces the zone uniformly.

        It is -pi E*/2 times the compliance of the fixed zone.
        """
        if self.map.period is not None:
            return np.log(half)
        assert datum is not None
        return np.log(half / (2.0 * datum))


@record
class ClosedZone:
    """One zone under one load (fields are numbers) or several loads (one row for each).

    half_width [m]. half: half length h in the coordinate y of `LineMap`. g: series coefficients
    (..., orders). tail: sum of the absolute values of the last two coefficients computed, plus a
    bound for those dropped.
    end_error: error of ln half. punch: for a flat punch, the load divided by E*/2, by the load
    factor and by pi times `half`. found: whether Newton's method converged to a zone below the
    limit.
    """

    problem: OneZoneProblem
    half_width: Value
    half: Value
    g: Array
    tail: Value
    end_error: Value
    steps: int
    nodes: int
    punch: Value
    found: Value

    def rows(self, chosen: Mask | int) -> "ClosedZone":
        """The zone for the chosen loads only, or for one chosen load."""
        names = ("half_width", "half", "g", "tail", "end_error", "punch", "found")
        return replace(self, **{name: getattr(self, name)[chosen] for name in names})

    @property
    def first(self) -> Value:
        """The coefficient g_1 of the zone's Chebyshev series, which gives the load.
        It is 0 for an empty series.
        """
        return self.g[..., 0] if self.g.shape[-1] else 0.0

    @cached_property
    def sums(self) -> tuple[Value, Value, Value]:
        """Sums of |g_k|, k |g_k| and k^2 |g_k| over the Chebyshev coefficients g_k."""
        plain, once, twice = np.abs(self.g).dot(powers(self.g.shape[-1])).T
        return plain, once, twice

    @property
    def widths(self) -> Value:
        """The width of the zone [m]."""
        return 2.0 * self.half_width

    @property
    def growth(self) -> Value:
        """Outward motion [m] of an end of the zone, per unit change of ln(load).
        It is 0 if the zone ends at corners.
        """
        problem, way = self.problem, self.problem.map
        if problem.corner is not None:
            return 0.0 * self.half
        edge = self.g @ orders(self.g.shape[-1])
        rate = way.load_factor * math.pi * edge + problem.kink_load(self.half)[1]
        return self.totals / rate * way.load_factor / way.weight(self.half_width)

    @cached_property
    def totals(self) -> Value:
        """The load divided by E*/2 [m]."""
        smooth = math.pi * self.half * (0.5 * self.first + self.punch)
        return self.problem.map.load_factor * smooth + self.problem.kink_load(self.half)[0]


# Type of the equation that Newton's method solves. Its arguments are the half length h, the load
# divided by E*/2, and the derivative of the latter with respect to h. With X the load or approach
# that is controlled, it returns (ln(wanted X / present X), d ln X / d ln h, round-off of ln X).
Residual = Callable[[Value, Value, Value], tuple[Value, Value, Value]]


def zone_under(problem: OneZoneProblem, loads: Value) -> ClosedZone:
    """The zone under one or several loads, which are divided by E*/2 [m]."""
    if problem.corner is not None:
        return _punch(problem, problem.corner, loads)

    def residual(half: Value, total: Value, rate: Value) -> tuple[Value, Value, Value]:
        return np.log(loads / total), half * rate / total, SUM_ROUND_OFF

    start = 0.25 * problem.top if math.isfinite(problem.top) else 1.0
    return _newton(problem, start + 0.0 * loads, residual)


def zone_at_approach(problem: OneZoneProblem, approach: float, datum: float | None) -> ClosedZone:
    """The zone at a given approach [m].

    The rate of the approach is the rate of the load times the compliance of the fixed zone.
    Pressure and gap vanish at the ends, so that the motion of the ends adds nothing.
    """

    def residual(half: Value, total: Value, rate: Value) -> tuple[Value, Value, Value]:
        compliance = -problem.even_level(half, datum) / math.pi
        present = problem.mean_height(half) + compliance * total
        lost = (
            SUM_ROUND_OFF
            * (abs(lowest(problem.profile)) + approach + abs(compliance) * total)
            / present
        )
        return np.log(approach / present), compliance * half * rate / present, lost

    # Without a period, the approach grows with the half width of the zone up to about twice the
    # datum (the length that fixes the constant of the displacement), and falls for wider zones.
    longest = min(problem.top, math.inf if datum is None else datum)
    return _newton(problem, 0.25 * longest, residual)


def zone_of_width(problem: OneZoneProblem, half_width: float) -> ClosedZone:
    """The zone with a given half width [m]."""

    def residual(half: Value, total: Value, rate: Value) -> tuple[Value, Value, Value]:
        return 0.0, 1.0, SUM_ROUND_OFF

    zone = _newton(problem, problem.map.y(half_width), residual)
    return replace(zone, half_width=half_width)


def _punch(problem: OneZoneProblem, corner: float, loads: Value) -> ClosedZone:
    """The contact zone of a flat punch, which extends from one corner to the other."""
    zero = 0.0 * loads
    half = problem.map.y(zero + corner)
    punch = loads / (problem.map.load_factor * math.pi * half)
    g, found = np.zeros((*np.shape(loads), 0)), np.isfinite(punch)
    return ClosedZone(problem, zero + corner, half, g, zero, zero, 0, 1, punch, found)


def _newton(
    problem: OneZoneProblem, half: Value, residual: Residual, options: OneZoneOptions = OPTIONS
) -> ClosedZone:
    """Contact zones for all loads at once, by Newton's method.
    The unknown is the logarithm of the half length of a zone.

    If load and width obey a power law, their logarithms obey a linear law. The number of nodes is
    raised until the series is resolved.
    """
    size, settled = options.first_nodes, half != half
    factor = problem.map.load_factor * math.pi
    for _step in range(options.max_steps):
        nodal = table(size)
        values = problem.slopes(column(half) * nodal.t)
        first, edge, one, other = values.dot(nodal.sums).T
        scale = largest(np.abs(values)) + abs(problem.kink)
        tail = abs(one) + abs(other)
        resolved = tail <= SUM_ROUND_OFF * scale
        kinked, kinked_rate = problem.kink_load(half)
        total = 0.5 * factor * half * first + kinked
        missing, slope, lost = residual(half, total, factor * edge + kinked_rate)
        move, rounding = missing / slope, SUM_ROUND_OFF + lost / abs(slope)
        fails = move != move
        done = resolved & (settled | (abs(move) <= 4.0 * rounding))
        if everywhere(done | fails):
            break
        # Newton's method converges quadratically. After a step below the square root of round-off,
        # the next step would be below round-off. So the iteration ends here if the Chebyshev series
        # is also resolved.
        settled = abs(move) <= math.sqrt(EPS)
        if not everywhere(fails | resolved | (abs(move) > options.refine_below)):
            size *= options.finer
            if size > options.max_nodes:
                break
        longer = half * np.exp(move)
        longer = choose(longer >= problem.top, 0.5 * (half + problem.top), longer)
        # `half` (the half length of the zone) stays as it is if no floating-point number lies
        # between `half` and `top`, its upper limit.
        half = choose(fails | (longer >= problem.top), half, longer)
    g = values.dot(nodal.matrix)
    size_of = np.abs(g) / column(scale)
    # All coefficients after the last one above round-off are dropped. If the kink of the profile
    # makes up its whole slope, no coefficient remains.
    above = ((size_of if size_of.ndim == 1 else size_of.max(axis=0)) > EPS).nonzero()[0]
    count = int(above[-1]) + 1 if len(above) else 0
    tail = tail + (size - count) * EPS * scale
    width, error = problem.map.at(half)[0], abs(move) + rounding
    found = done & (total > 0.0) & (width < problem.limit) & (half > SMALLEST)
    g = g[..., :count]
    return ClosedZone(problem, width, half, g, tail, error, _step + 1, 2 * size, 0.0 * half, found)


@lru_cache(maxsize=1)
def _quarter_turn() -> tuple[Array, Array]:
    """(Gauss points t = cos(angle), weights) for the mean over angles from 0 to pi/2."""
    s, weights = np.polynomial.legendre.leggauss(OPTIONS.gauss_points)
    return np.cos(0.25 * math.pi * (1.0 + s)), 0.5 * weights
