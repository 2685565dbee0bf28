"""Nearly full contact by its gaps: the unknown is the slope of the gap on the few places without contact.

With s the slope of the gap (zero in contact), u' = s - f', and p = pbar + (E*/2) H u', H the periodic Hilbert transform. No
pressure in the gaps means

    (1/pi) PV int_gaps s(xi) K(x - xi) dxi = H f'(x) - 2 pbar / E*     on the gaps,     int_gap s = 0 on each,

the same equation as that of the zones, with the roles of contact and gap exchanged, bounded at free ends. Its unknowns are
few where the contact is nearly full, however narrow the gaps (theory: derived here from (5); see docs/theory).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

import sie
from contact import lazy
from contact.certificate import ROUNDING, Certificate, runs_of
from contact.extrema import maximum
from contact.fields import mean_shape
from contact.problem import Control, Problem
from contact.topology import WrongTopology

Array = NDArray[np.float64]

_ROUNDS = 8
# Newton steps: from the first guess of gaps a few are enough, or it is no problem for gaps.
_STEPS = 25


@dataclass(frozen=True, eq=False)
class GapFields:
    """Fields of a periodic contact from the slope of its gaps; scaled inside, SI in the public methods.

    mean: scaled mean pressure. conjugate: H f' over the unit slope, of scaled x.
    """

    problem: Problem
    state: sie.AnyState
    mean: float
    conjugate: Callable[[Array], Array]

    @property
    def density(self) -> sie.Density:
        """Slope of the gap on the gaps."""
        assert isinstance(self.state.density, sie.Density)
        return self.state.density

    @property
    def period(self) -> float:
        assert self.problem.period is not None
        return self.problem.period

    @cached_property
    def zones(self) -> Array:
        """Scaled contact zones, between the gaps."""
        gaps = self.density.zones
        return np.column_stack((gaps.b, np.append(gaps.a[1:], gaps.a[0] + self.period)))

    # scaled -----------------------------------------------------------------------------------------------------------
    def scaled_pressure(self, x: Array) -> Array:
        """pbar - H f' + H s where there is contact, zero in the gaps."""
        inside = self.density.locate(x)[2]
        return np.where(inside, 0.0, self.mean - self.conjugate(x) + self.density.transform(x))

    def pressure_in(self, zone: int, left: Array, right: Array) -> Array:
        """Scaled pressure at distances over the half width from the ends of a contact zone."""
        a, b = self.zones[zone]
        half = 0.5 * (b - a)
        x = np.where(left <= right, a + half * left, b - half * right)
        return self.mean - self.conjugate(x) + self.density.transform(x)

    # SI ---------------------------------------------------------------------------------------------------------------
    def pressure(self, x: ArrayLike) -> Array:
        return self.scaled_pressure(self.problem.units.scaled(np.asarray(x, dtype=float))) * self.problem.units.pressure

    def pressure_at(self, zone: int, t: ArrayLike) -> Array:
        t = np.asarray(t, dtype=float)
        value = self.pressure_in(zone, 1 + t, 1 - t)
        return np.where(np.abs(t) == 1, 0.0, value) * self.problem.units.pressure

    def gap(self, x: ArrayLike) -> Array:
        scaled = self.problem.units.scaled(np.asarray(x, dtype=float))
        return np.maximum(self.density.integral(scaled), 0.0) * self.problem.units.height

    def displacement(self, x: ArrayLike) -> Array:
        """u = approach - f + gap."""
        height = np.asarray(self.problem.profile.height(x)) - self.problem.lowest
        return np.asarray(self.approach - height + self.gap(x))

    @property
    def starts(self) -> Array:
        return self.problem.units.x(self.zones[:, 0])

    @property
    def contact_fraction(self) -> float:
        gaps = self.density.zones
        return 1.0 - float((gaps.b - gaps.a).sum()) / self.period

    @property
    def load(self) -> float:
        return self.mean * self.period * self.problem.units.load

    @cached_property
    def loads(self) -> Array:
        """Load of each contact zone [N/m], by Gauss-Chebyshev of the second kind, doubled until it stays."""
        out = []
        for zone, (a, b) in enumerate(self.zones):
            last, n = np.inf, 32
            while n <= 8192:
                theta = np.arange(1, n + 1) * np.pi / (n + 1)
                value = self.pressure_in(zone, 2 * np.cos(theta / 2) ** 2, 2 * np.sin(theta / 2) ** 2)
                here = 0.5 * (b - a) * np.pi / (n + 1) * float(value @ np.sin(theta))
                if abs(here - last) <= 1e-13 * abs(here):
                    break
                last, n = here, 2 * n
            out.append(here * self.problem.units.load)
        return np.array(out)

    @cached_property
    def max_pressure(self) -> float:
        if np.any(self.problem.forcing.orders == 0) and np.any(self.problem.profile.kinks[:, 1] > 0):
            return np.inf
        resolution = self.problem.profile.resolution or self.problem.units.length * self.period / 16
        n = int(np.clip(16 * self.period * self.problem.units.length / resolution, 256, 2**17))
        x = self.period * (np.arange(n + 1) / n) + self.density.zones.a[0]
        return maximum(self.scaled_pressure, x)[1] * self.problem.units.pressure

    @cached_property
    def approach(self) -> float:
        """min f = 0 and mean u = 0: the mean of f less the mean gap [m]."""
        return mean_shape(self.problem) * self.problem.units.height - self.mean_gap

    @property
    def mean_gap(self) -> float:
        """The gap vanishes at the ends, so its integral is minus the moment of its slope [m]."""
        return -self.density.moment() / self.period * self.problem.units.height

    @cached_property
    def stiffness(self) -> float:
        """d load / d approach [N/m^2]: the gap's response to the mean pressure, ends held."""
        values = np.zeros(len(self.state.condition_scale))
        values[self.state.condition_index[0]] = 1.0
        response = self.state.response(values)
        rate = response.moment() / self.period * self.problem.units.height
        return self.period * self.problem.units.load / rate


@dataclass(frozen=True, eq=False)
class Gapped:
    """Gaps that passed: the Newton result, the fields, the certificate, and how far the mean pressure, where it was found
    from another control, may be off relative to its distance from that of full contact."""

    free: sie.Free
    fields: GapFields
    certificate: Certificate
    off: float = 0.0

    @property
    def error(self) -> float:
        """Estimated error of the pressure over its peak and of the zones' ends over their width.

        An end of a gap off by delta shifts the normalised positions in the zone beside it, by delta over its width, and the
        pressure there by delta over the length in which it varies.
        """
        fields, gaps = self.fields, self.fields.density.zones
        units, profile = fields.problem.units, fields.problem.profile
        # A gap's width goes with the square root of that distance.
        moved = self.free.end_error + self.free.state.end_truncation + 0.5 * self.off
        shift = float((moved * (gaps.b - gaps.a)[:, None]).max())
        widths = fields.zones[:, 1] - fields.zones[:, 0]
        varies = (profile.resolution or units.length * fields.period) / units.length / (2 * np.pi)
        slopes = np.abs(fields.density.coefficients).max()
        return float(
            2 * shift / min(widths.min(), varies) + self.free.state.density_error * slopes * units.pressure / fields.max_pressure
            + ROUNDING * (1 + abs(fields.mean) * units.pressure / fields.max_pressure)
        )


def find_gaps(
    problem: Problem, control: Control, conjugate: Callable[[Array], Array], full: float, tolerance: float
) -> Gapped:
    """The gaps under a control; for an approach or a contact width the mean pressure is found by Brent's method, below the
    scaled mean pressure `full` at which full contact begins."""
    if control.kind == "load":
        assert problem.period is not None
        return solve_gaps(problem, control.value / problem.period, conjugate, tolerance)
    units = problem.units

    def miss(mean: float) -> float:
        fields = solve_gaps(problem, mean, conjugate, 0.01 * tolerance).fields
        if control.kind == "approach":
            return fields.approach / units.height - control.value
        return fields.contact_fraction * fields.period - control.value

    high, low = 1 - 1e-12, 0.9
    while miss(full * low) > 0:
        low = 1 - 2 * (1 - low)
        if low <= 0:
            raise WrongTopology("no mean pressure gives such gaps", None)
    if miss(full * high) < 0:
        raise WrongTopology("the gaps are narrower than the rounding of the load can tell from full contact", None)
    root = lazy.scipy_optimize().brentq(lambda share: miss(full * share), low, high, xtol=1e-15, rtol=1e-15)
    found = solve_gaps(problem, full * root, conjugate, tolerance)
    rounding = 1e-15 * full
    if control.kind == "approach":
        # The approach is a difference of numbers of the size of the profile, and hardly changes near full contact.
        rate = found.fields.stiffness / found.fields.period * units.height / units.load
        rounding += 3e-16 * abs(rate) * max(control.value, mean_shape(problem))
    return replace(found, off=rounding / (full - found.fields.mean))


def solve_gaps(problem: Problem, mean: float, conjugate: Callable[[Array], Array], tolerance: float) -> Gapped:
    """Gaps at a scaled mean pressure: first where H f' exceeds it, then Newton, then the signs on the whole period.

    Raises WrongTopology where that does not come to an end that passes.
    """
    equation = _equation(problem, mean, conjugate)
    table = _first_gaps(problem, mean, conjugate)
    for _ in range(_ROUNDS):
        if len(table) == 0:
            raise WrongTopology("no gap is left", None)
        free = sie.find_ends(equation, sie.Zones.of(table), tolerance, _STEPS, signs=(1.0, -1.0))
        if len(free.lost):
            table = np.delete(free.density.zones.table, free.lost, axis=0)
            continue
        if len(free.met):
            table = _merged(free.density.zones.table, free.met, problem)
            continue
        if not free.converged:
            raise WrongTopology("the ends of the gaps did not settle", free)
        fields = GapFields(problem, free.state, mean, conjugate)
        certificate, negative = _certify(fields)
        if certificate.holds:
            return Gapped(free, fields, certificate)
        if len(negative) == 0:
            raise WrongTopology("a gap is not open everywhere", free)
        table = _united(np.concatenate((free.density.zones.table, negative)), fields.period)
    raise WrongTopology("the number of gaps did not settle", free)


def with_gaps(fields: GapFields, mean: float, table: Array, tolerance: float) -> GapFields:
    """The same profile at another mean pressure with this many gaps, whatever the signs."""
    equation = _equation(fields.problem, mean, fields.conjugate)
    free = sie.find_ends(equation, sie.Zones.of(table), tolerance, _STEPS, signs=(1.0, -1.0))
    if not free.converged:
        raise WrongTopology("the ends of the gaps did not settle", free)
    return GapFields(fields.problem, free.state, mean, fields.conjugate)


def _equation(problem: Problem, mean: float, conjugate: Callable[[Array], Array]) -> sie.Equation:
    # The mean pressure is a column: taken off the right side it would leave little but the rounding of both.
    return sie.Equation(
        problem.kernel, sie.Forcing(conjugate), (sie.Amplitude(0, mean), sie.ZoneTotals(0.0)),
        (sie.Forcing(lambda x: np.full(np.shape(x), -1.0), modes=1),),
    )


def _samples(problem: Problem, count: int = 32) -> Array:
    assert problem.period is not None
    resolution = problem.profile.resolution or problem.units.length * problem.period / 16
    n = int(np.clip(count * problem.period * problem.units.length / resolution, 256, 2**18))
    start = float(problem.units.scaled(np.array(problem.profile.x0)))
    return np.asarray(start + problem.period * np.arange(n + 1) / n)


def _first_gaps(problem: Problem, mean: float, conjugate: Callable[[Array], Array]) -> Array:
    """Where H f' exceeds the mean pressure, widened as a lone gap in a parabola of H f' would be: by sqrt(2)."""
    assert problem.period is not None
    x = _samples(problem)[:-1]
    value = np.asarray(conjugate(x))
    above = value > mean
    if not above.any():
        place, highest = maximum(lambda points: np.asarray(conjugate(points)), np.append(x, x[0] + problem.period))
        if highest <= mean:
            return np.zeros((0, 2))
        step = float(x[1] - x[0])
        bend = 2 * highest - float(conjugate(np.array([place - step]))[0]) - float(conjugate(np.array([place + step]))[0])
        half = 2 * step * np.sqrt((highest - mean) / bend)
        return np.array([[place - half, place + half]])
    if above.all():
        raise WrongTopology("the mean pressure is below H f' everywhere", None)
    shift = int(np.argmin(above))  # start in contact, so that no run crosses the border
    x = np.concatenate((x[shift:], x[:shift] + problem.period))
    above, value = np.roll(above, -shift), np.roll(value, -shift)
    change = np.flatnonzero(np.diff(np.concatenate(([False], above, [False])).astype(np.int8)))
    step = float(x[1] - x[0])
    rows = []
    for first, last in zip(change[::2], change[1::2] - 1, strict=True):
        # The crossings of the level lie between samples.
        before, after = value[first - 1] - mean, value[(last + 1) % len(x)] - mean
        a = x[first] - step * (value[first] - mean) / (value[first] - mean - before)
        b = x[last] + step * (value[last] - mean) / (value[last] - mean - after)
        middle, half = 0.5 * (a + b), 0.5 * np.sqrt(2) * (b - a)
        rows.append([middle - half, middle + half])
    return _united(np.array(rows), problem.period)


def _united(table: Array, period: float) -> Array:
    """Overlapping intervals joined, around the period."""
    table = table[np.argsort(table[:, 0])]
    kept = [table[0].copy()]
    for row in table[1:]:
        if row[0] <= kept[-1][1]:
            kept[-1][1] = max(kept[-1][1], row[1])
        else:
            kept.append(row.copy())
    if len(kept) > 1 and kept[-1][1] >= kept[0][0] + period:
        kept[0][0] = kept.pop()[0] - period
    if kept[-1][1] - kept[0][0] >= period:
        raise WrongTopology("the gaps fill the period", None)
    return np.array(kept)


def _merged(table: Array, met: NDArray[np.intp], problem: Problem) -> Array:
    assert problem.period is not None
    rows = [row.copy() for row in table]
    for i in sorted(met, reverse=True):
        if i + 1 < len(rows):
            rows[i][1] = rows.pop(i + 1)[1]
        elif len(rows) > 1:
            rows[i][1] = rows.pop(0)[1] + problem.period
    return np.array(rows)


def _certify(fields: GapFields) -> tuple[Certificate, Array]:
    """Signs of gap and pressure on the whole period; the scaled intervals of negative pressure."""
    density, problem = fields.density, fields.problem
    gaps = density.zones
    n = int(density.sampling.max())
    theta = (np.arange(n) + 0.5) * np.pi / n
    opening = density.integral_at(np.arange(len(gaps))[:, None], theta)
    # Next to its ends a gap is of third order in the angle, and only rounding is left of it.
    rough = 64 * 2.2e-16 * (gaps.half * np.abs(density.coefficients).sum(axis=1))[:, None]
    opening = np.where(np.abs(opening) <= rough, np.abs(opening), opening)
    smallest_gap = float(opening.min())
    negative: list[list[float]] = []
    least, points = np.inf, opening.size
    spacing = (problem.profile.resolution or problem.units.length * fields.period / 16) / problem.units.length
    for zone, (a, b) in enumerate(fields.zones):
        count = int(np.clip(32 * (b - a) / spacing, 96, 40000))
        angle = (np.arange(count) + 0.5) * np.pi / count
        value, rough = _over_root(fields, zone, angle)
        pulls: list[list[float]] = []
        points += count
        least = min(least, float(np.where(np.abs(value) <= rough, np.abs(value), value).min()))
        fails = value < -rough
        for first, last in runs_of(fails):
            lo, hi = angle[max(first - 1, 0)], angle[min(last + 1, count - 1)]
            pulls.append([lo, hi])
        dips = np.flatnonzero((value[1:-1] <= value[:-2]) & (value[1:-1] <= value[2:]) & ~fails[1:-1]) + 1
        # A parabola through three samples falls below the middle one by an eighth of their second difference at most.
        dips = dips[value[dips] < value[dips - 1] - 2 * value[dips] + value[dips + 1]]
        for k in dips:
            fine = np.linspace(angle[k - 1], angle[k + 1], 129)
            value_here, rough_here = _over_root(fields, zone, fine)
            least = min(least, float(np.where(np.abs(value_here) <= rough_here, np.abs(value_here), value_here).min()))
            pulls += [[fine[max(s - 1, 0)], fine[min(e + 1, 128)]] for s, e in runs_of(value_here < -rough_here)]
        middle, half = 0.5 * (a + b), 0.5 * (b - a)
        negative += [[middle + half * np.cos(hi), middle + half * np.cos(lo)] for lo, hi in pulls]
    holds = smallest_gap >= 0 and not negative
    units = problem.units
    certificate = Certificate(
        smallest_pressure=least * units.pressure, smallest_gap=smallest_gap * units.height, gap_rounding=0.0,
        load_balance=0.0, level_spread=0.0, points=points, holds=bool(holds), note="solved by its gaps",
    )
    return certificate, np.array(negative).reshape(-1, 2)


def _over_root(fields: GapFields, zone: int, angle: Array) -> tuple[Array, Array]:
    """(pressure over the sine of the angle in a contact zone, its rounding)."""
    left, right = 2 * np.cos(angle / 2) ** 2, 2 * np.sin(angle / 2) ** 2
    pressure = fields.pressure_in(zone, left, right)
    # The pressure is a difference of numbers of the size of H f': next to an end only their rounding is left.
    rough = 64 * 2.2e-16 * (abs(fields.mean) + float(np.abs(pressure).max())) / np.sin(angle)
    return pressure / np.sin(angle), rough
