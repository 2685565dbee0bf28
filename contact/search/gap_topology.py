"""Which gaps there are: where R exceeds the mean pressure, Newton on their ends, a look at the signs, corrections, and again."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

import sie
from contact.formulation.controls import Control, Load
from contact.formulation.fields import mean_shape
from contact.formulation.gaps import GapFields
from contact.formulation.maxima import maximum
from contact.formulation.problem import Problem, minus_one
from contact.formulation.relief import ScaledRelief
from contact.search.missed import Missed, WrongTopology
from contact.search.topology import TIGHT
from contact.verify.gap_accuracy import Gapped
from contact.verify.gap_certificate import NARROWEST, certify_gaps

Array = NDArray[np.float64]

_ROUNDS = 12
# Newton steps: from the first guess of gaps a few are enough, or it is no problem for gaps.
_STEPS = 25
# Samples a shortest length of the shape.
_CLOSE = 32
# Gaps over kinks that are this many samples narrow are placed by their closed form.
_UNSEEN = 4


def find_gaps(
    problem: Problem, control: Control, relief: ScaledRelief, tolerance: float, width: float, zones: Array | None = None,
    near: bool = False,
) -> Gapped | Missed:
    """The gaps under a control (load, approach, or width): first guesses, Newton, then the signs on the whole period.

    width: about that of all contact, zones: about where it is, both scaled; near: these are those of a solution, and given up as soon
    as they turn out to be far.
    """
    assert problem.period is not None
    try:
        first = _First.of(problem, relief)
        width = width if control.width is None else control.width
        mean = first.mean_of(width) if control.load is None else control.load / problem.period
        if zones is not None and len(zones) > 0:
            # Where zones are known about, so are the gaps; but not those that a grid does not see.
            between = np.column_stack((zones[:, 1], np.append(zones[1:, 0], zones[0, 0] + problem.period)))
            found = settle_gaps(problem, control, relief, _united(between, problem.period), mean, tolerance, near)
            if near or isinstance(found, Gapped):
                return found
        return settle_gaps(problem, control, relief, first.gaps(mean), mean, tolerance)
    except WrongTopology as wrong:
        return wrong.missed


def settle_gaps(
    problem: Problem, control: Control, relief: ScaledRelief, table: Array, mean: float, tolerance: float, near: bool = False
) -> Gapped | Missed:
    """From proposed gaps (n, 2) to gaps that pass; mean: the scaled mean pressure, or a guess of it; near: see `find_gaps`."""
    try:
        return _settled(problem, control, relief, table, mean, tolerance, near)
    except WrongTopology as wrong:
        return wrong.missed


def _settled(
    problem: Problem, control: Control, relief: ScaledRelief, table: Array, mean: float, tolerance: float, near: bool
) -> Gapped:
    equation = gap_equation(problem, control, relief)
    free: sie.Free | None = None
    for _ in range(_ROUNDS):
        if len(table) == 0:
            raise WrongTopology("no gap is left: they are narrower than rounding can tell from full contact", free)
        free = sie.find_ends(equation, sie.Zones.of(table), tolerance, _STEPS, value=mean, signs=(1.0, -1.0), near=near)
        mean = mean if free.value is None else free.value
        if near and not free.converged:
            raise WrongTopology("the gaps are not near those of the solution", free)
        if len(free.lost):
            table = np.delete(free.density.zones.table, free.lost, axis=0)
            continue
        if len(free.met):
            table = _merged(free.density.zones.table, free.met, problem)
            continue
        if not free.converged:
            raise WrongTopology("the ends of the gaps did not settle", free)
        mean = float(free.density.amplitudes[0])
        fields = GapFields(problem, _under_mean(problem, control, relief, free, mean, tolerance), mean, relief)
        signs = certify_gaps(fields)
        if signs.certificate.holds:
            found = Gapped(free, fields, signs.certificate, free.value_error + _rounding_of_mean(control, fields))
            if signs.certificate.dip > 10 * tolerance or tolerance <= TIGHT:
                return found
            # Whether so slight a dip is a gap, a solution to the tolerance does not tell.
            return _decided(found, problem, control, relief, mean)
        if near:
            raise WrongTopology("there are other gaps than these", free)
        table = _united(np.concatenate((_cut(free.density.zones.table, signs.overlaps), signs.negative)), fields.period)
    raise WrongTopology("the number of gaps did not settle", free)


def _decided(slight: Gapped, problem: Problem, control: Control, relief: ScaledRelief, mean: float) -> Gapped:
    """The gaps as tightly as rounding allows, where a dip of the pressure may be one more; undecided if that cannot be told."""
    tight = settle_gaps(problem, control, relief, slight.fields.density.zones.table, mean, TIGHT)
    if isinstance(tight, Missed):
        return replace(slight, certificate=replace(slight.certificate, undecided=True))
    return tight


def _under_mean(
    problem: Problem, control: Control, relief: ScaledRelief, free: sie.Free, mean: float, tolerance: float
) -> sie.AnyState:
    """The same gaps under their mean pressure, whatever the control was: stiffness is read from this state."""
    if control.load is not None:
        return free.state
    assert problem.period is not None
    equation = gap_equation(problem, Load(mean * problem.period), relief)
    return sie.solve_fixed(equation, free.density.zones, max(0.1 * tolerance, 3e-16)).settled()


def _rounding_of_mean(control: Control, fields: GapFields) -> float:
    """How far rounding may take the mean pressure that comes with an approach: a difference of numbers of the size of the
    profile, which hardly changes near full contact."""
    if control.approach is None:
        return 0.0
    units = fields.problem.units
    rate = fields.stiffness / fields.period * units.height / units.load
    return 6e-16 * (abs(fields.mean) + abs(rate) * max(control.approach, mean_shape(fields.problem)))


def with_gaps(fields: GapFields, mean: float, table: Array, tolerance: float, decay: float) -> GapFields:
    """The same profile at another mean pressure with this many gaps, whatever the signs. tolerance: of their ends, decay: of the
    coefficients."""
    equation = gap_equation(fields.problem, Load(mean * fields.period), fields.relief)
    free = sie.find_ends(equation, sie.Zones.of(table), tolerance, _STEPS, signs=(1.0, -1.0), decay=decay, settled=False)
    if not free.converged:
        raise WrongTopology("the ends of the gaps did not settle", free)
    return GapFields(fields.problem, free.state, mean, fields.relief)


def gap_equation(problem: Problem, control: Control, relief: ScaledRelief) -> sie.Equation:
    """The equation of the slope of the gap. The mean pressure is a column: taken off the right side it would leave little but
    the rounding of both."""
    assert problem.period is not None
    jumps = problem.forcing
    right = sie.Forcing(
        relief.forcing, breaks_at=np.asarray(jumps.steps_at), breaks=np.asarray(jumps.steps), break_orders=jumps.orders,
        spline=jumps.value,
    )
    conditions, ends = control.gap_conditions(problem.period, partial(mean_shape, problem), problem.compression)
    return sie.Equation(problem.inverse_kernel, right, conditions, (sie.Forcing(minus_one, modes=1),), ends)


@dataclass(frozen=True, eq=False)
class _First:
    """First guesses: where samples of R exceed the mean pressure."""

    relief: ScaledRelief
    period: float
    x: Array
    value: Array

    @classmethod
    def of(cls, problem: Problem, relief: ScaledRelief) -> _First:
        assert problem.period is not None
        resolution = problem.profile.resolution or problem.units.length * problem.period / 16
        n = int(np.clip(_CLOSE * problem.period * problem.units.length / resolution, 256, 2**18))
        start = float(problem.units.scaled(np.array(problem.profile.x0)))
        # Off the borders of the cell and of its halves and thirds, where kinks like to be.
        x = start + problem.period * (np.arange(n) + 0.4142) / n
        return cls(relief, problem.period, x, np.asarray(relief(x)))

    @property
    def step(self) -> float:
        return self.period / len(self.x)

    def gaps(self, mean: float) -> Array:
        """Runs of samples above the mean pressure, widened as a lone gap in a parabola of R would be; lone gaps over
        kinks."""
        valleys = self._over_kinks(mean)
        above = self.value > mean
        if above.all():
            raise WrongTopology("the mean pressure is below R everywhere", None)
        if above.any():
            seen = self._runs(above, mean)
            half = 0.5 * self.period
            apart = np.abs((seen.mean(axis=1)[:, None] - valleys.mean(axis=1) + half) % self.period - half)
            unseen = (apart < 2 * self.step).any(axis=1) & (seen[:, 1] - seen[:, 0] < 2 * _UNSEEN * self.step)
            return _united(np.concatenate((self._placed(seen[~unseen], mean), valleys)), self.period)
        return _united(valleys, self.period) if len(valleys) else self._last(mean)

    def mean_of(self, width: float) -> float:
        """The mean pressure whose first guess leaves about this width in contact, by bisection."""
        finite = self.value[np.isfinite(self.value)]
        low, high = float(finite.min()), float(finite.max())
        while self._open(high) > self.period - width and high < 1e3 * (1 + float(finite.max())):
            high += high - low
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self._open(middle) > self.period - width else (low, middle)
        return 0.5 * (low + high)

    def _open(self, mean: float) -> float:
        try:
            table = self.gaps(mean)
        except WrongTopology:
            return self.period
        return float(np.sum(table[:, 1] - table[:, 0]))

    def _last(self, mean: float) -> Array:
        """The gap about the highest R, narrower than the samples."""
        return self._about(*maximum(self.relief, np.append(self.x, self.x[0] + self.period)), mean)

    def _about(self, place: float, highest: float, mean: float) -> Array:
        """The gap about a top of R that is a parabola between the samples: (1, 2), or none."""
        beside = np.asarray(self.relief(np.array([place - self.step, place + self.step])))
        bend = 2 * highest - float(beside.sum())
        if highest <= mean or not bend > 0:
            return np.zeros((0, 2))
        half = 2 * self.step * np.sqrt((highest - mean) / bend)
        return np.array([[place - half, place + half]])

    def _placed(self, seen: Array, mean: float) -> Array:
        """Gaps as narrow as the samples show, put where their top is between the samples."""
        out = []
        for row in seen:
            if row[1] - row[0] < _UNSEEN * self.step:
                middle = int(round((0.5 * float(row.sum()) - self.x[0]) / self.step)) % len(self.x)
                found = self._about(*self._top(middle), mean)
                row = found[0] if len(found) and found[0, 1] - found[0, 0] < 2 * _UNSEEN * self.step else row
            out.append(row)
        return np.array(out).reshape(-1, 2)

    def _top(self, sample: int) -> tuple[float, float]:
        """(place, value) of the highest R about a sample."""
        if sample not in self._tops:
            around = self.x[0] + self.step * (sample + np.arange(-3.0, 4.0))
            self._tops[sample] = maximum(self.relief, around)
        return self._tops[sample]

    @cached_property
    def _tops(self) -> dict[int, tuple[float, float]]:
        return {}

    def _over_kinks(self, mean: float) -> Array:
        """Lone gaps over the concave kinks, where they are narrower than the samples show and wide enough to have ends."""
        kinks, rest = self._valleys
        at, heights = self.relief.at[kinks], self.relief.heights[kinks]
        half = self.period / np.pi * np.exp(np.pi * np.minimum((mean - rest) / heights, 9.0))
        which = (half < 0.5 * _UNSEEN * self.step) & (half > NARROWEST * self.period)
        return np.column_stack((at - half, at + half))[which]

    @cached_property
    def _valleys(self) -> tuple[NDArray[np.intp], Array]:
        """The concave kinks, and R there less their own logarithm."""
        kinks = np.flatnonzero(self.relief.heights < 0)
        return kinks, self.relief.without_own(kinks)

    def _runs(self, above: NDArray[np.bool_], mean: float) -> Array:
        """The runs of samples above the mean pressure, from crossing to crossing, widened by sqrt(2)."""
        shift = int(np.argmin(above))  # start in contact, so that no run crosses the border
        x = np.concatenate((self.x[shift:], self.x[:shift] + self.period))
        highest = 2 * np.abs(self.value[np.isfinite(self.value)]).max(initial=abs(mean))
        above, value = np.roll(above, -shift), np.clip(np.roll(self.value, -shift), -highest, highest)
        change = np.flatnonzero(np.diff(np.concatenate(([False], above, [False])).astype(np.int8)))
        first, last = change[::2], change[1::2] - 1
        # The crossings of the level lie between samples.
        before, after = value[first - 1] - mean, value[(last + 1) % len(x)] - mean
        a = x[first] - self.step * (value[first] - mean) / (value[first] - mean - before)
        b = x[last] + self.step * (value[last] - mean) / (value[last] - mean - after)
        middle, half = 0.5 * (a + b), 0.5 * np.sqrt(2) * (b - a)
        return _united(np.column_stack((middle - half, middle + half)), self.period)


def _united(table: Array, period: float) -> Array:
    """Overlapping intervals joined, around the period."""
    if len(table) == 0:
        return table
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


def _cut(table: Array, overlaps: Array) -> Array:
    """Gaps without the parts in which they overlap."""
    rows = []
    for a, b in table:
        left = a
        for lo, hi in overlaps[(overlaps[:, 0] < b) & (overlaps[:, 1] > a)]:
            if lo > left:
                rows.append([left, lo])
            left = max(left, hi)
        if left < b:
            rows.append([left, b])
    return np.array(rows).reshape(-1, 2)


def _merged(table: Array, met: NDArray[np.intp], problem: Problem) -> Array:
    assert problem.period is not None
    rows = [row.copy() for row in table]
    for i in sorted(met, reverse=True):
        if i + 1 < len(rows):
            rows[i][1] = rows.pop(i + 1)[1]
        elif len(rows) > 1:
            first = rows.pop(0)
            rows[-1][1] = first[1] + problem.period
    return np.array(rows)
