"""Which gaps there are: where H f' exceeds the mean pressure, Newton on their ends, a look at the signs, corrections, and again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

import sie
from contact import lazy
from contact.conjugate import ScaledConjugate
from contact.extrema import maximum
from contact.fields import mean_shape
from contact.gap_certificate import NARROWEST, certify_gaps
from contact.gapped import GapFields, Gapped
from contact.problem import Control, Problem
from contact.topology import TIGHT, WrongTopology

Array = NDArray[np.float64]

_ROUNDS = 12
# Newton steps: from the first guess of gaps a few are enough, or it is no problem for gaps.
_STEPS = 25
# Gaps over kinks that are this many samples narrow are placed by their closed form.
_UNSEEN = 4


def find_gaps(problem: Problem, control: Control, conjugate: ScaledConjugate, full: float, tolerance: float) -> Gapped:
    """The gaps under a control; for an approach or a contact width the mean pressure is found by Brent's method, below the
    scaled mean pressure `full` at which full contact begins (inf: a valley with a kink never fills)."""
    if control.kind == "load":
        assert problem.period is not None
        return solve_gaps(problem, control.value / problem.period, conjugate, tolerance)
    units = problem.units

    def miss(mean: float) -> float:
        fields = solve_gaps(problem, mean, conjugate, 0.01 * tolerance).fields
        if control.kind == "approach":
            return fields.approach / units.height - control.value
        return fields.contact_fraction * fields.period - control.value

    low, high = _bracket(miss, full) if np.isfinite(full) else _open_bracket(miss, problem, conjugate)
    mean = lazy.scipy_optimize().brentq(miss, low, high, xtol=1e-300, rtol=1e-15)
    found = solve_gaps(problem, mean, conjugate, tolerance)
    rounding = 1e-15 * abs(mean)
    if control.kind == "approach":
        # The approach is a difference of numbers of the size of the profile, and hardly changes near full contact.
        rate = found.fields.stiffness / found.fields.period * units.height / units.load
        rounding += 3e-16 * abs(rate) * max(control.value, mean_shape(problem))
    return replace(found, off=rounding)


def _bracket(miss: Callable[[float], float], full: float) -> tuple[float, float]:
    """Mean pressures below and above the wanted one, below that of full contact."""
    high, low = 1 - 1e-12, 0.9
    while miss(full * low) > 0:
        low = 1 - 2 * (1 - low)
        if low <= 0:
            raise WrongTopology("no mean pressure gives such gaps", None)
    if miss(full * high) < 0:
        raise WrongTopology("the gaps are narrower than the rounding of the load can tell from full contact", None)
    return full * low, full * high


def _open_bracket(miss: Callable[[float], float], problem: Problem, conjugate: ScaledConjugate) -> tuple[float, float]:
    """The same where no load gives full contact. A gap over a kink narrows e-fold with every |J| / pi of mean pressure."""
    step = float(-conjugate.heights.min()) / np.pi
    mean = 2 * step
    if miss(mean) > 0:
        high = mean
        while miss(mean := 0.75 * high) > 0:
            high = mean
            if mean < 0.02 * step:
                raise WrongTopology("no mean pressure gives such gaps", None)
        return mean, high
    low = mean
    while miss(mean := low + step) < 0:
        low = mean
    return low, mean


def solve_gaps(
    problem: Problem, mean: float, conjugate: ScaledConjugate, tolerance: float, table: Array | None = None
) -> Gapped:
    """Gaps at a scaled mean pressure: first where H f' exceeds it (or those of a table), then Newton, then the signs on the whole
    period.

    Raises WrongTopology where that does not come to an end that passes.
    """
    equation = gap_equation(problem, mean, conjugate)
    if table is None:
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
        signs = certify_gaps(fields)
        if signs.certificate.holds:
            found = Gapped(free, fields, signs.certificate)
            if signs.certificate.dip > 10 * tolerance or tolerance <= TIGHT:
                return found
            # Whether so slight a dip is a gap, a solution to the tolerance does not tell.
            return _decided(found, problem, mean, conjugate)
        table = _united(np.concatenate((_cut(free.density.zones.table, signs.overlaps), signs.negative)), fields.period)
    raise WrongTopology("the number of gaps did not settle", free)


def _decided(slight: Gapped, problem: Problem, mean: float, conjugate: ScaledConjugate) -> Gapped:
    """The gaps as tightly as rounding allows, where a dip of the pressure may be one more; undecided if that cannot be told."""
    table = slight.fields.density.zones.table
    try:
        return solve_gaps(problem, mean, conjugate, TIGHT, table)
    except WrongTopology:
        return replace(slight, certificate=replace(slight.certificate, undecided=True))


def with_gaps(fields: GapFields, mean: float, table: Array, tolerance: float) -> GapFields:
    """The same profile at another mean pressure with this many gaps, whatever the signs."""
    equation = gap_equation(fields.problem, mean, fields.conjugate)
    free = sie.find_ends(equation, sie.Zones.of(table), tolerance, _STEPS, signs=(1.0, -1.0))
    if not free.converged:
        raise WrongTopology("the ends of the gaps did not settle", free)
    return GapFields(fields.problem, free.state, mean, fields.conjugate)


def gap_equation(problem: Problem, mean: float, conjugate: ScaledConjugate) -> sie.Equation:
    """The equation of the slope of the gap at a scaled mean pressure."""
    jumps = problem.forcing
    right = sie.Forcing(
        conjugate.smooth, breaks_at=np.asarray(jumps.steps_at), breaks=np.asarray(jumps.steps), break_orders=jumps.orders
    )
    # The mean pressure is a column: taken off the right side it would leave little but the rounding of both.
    return sie.Equation(
        problem.kernel, right, (sie.Amplitude(0, mean), sie.ZoneTotals(0.0)),
        (sie.Forcing(lambda x: np.full(np.shape(x), -1.0), modes=1),),
    )


def _samples(problem: Problem, count: int = 32) -> Array:
    assert problem.period is not None
    resolution = problem.profile.resolution or problem.units.length * problem.period / 16
    n = int(np.clip(count * problem.period * problem.units.length / resolution, 256, 2**18))
    start = float(problem.units.scaled(np.array(problem.profile.x0)))
    # Off the borders of the cell and of its halves and thirds, where kinks like to be.
    return np.asarray(start + problem.period * (np.arange(n + 1) + 0.4142) / n)


def _first_gaps(problem: Problem, mean: float, conjugate: ScaledConjugate) -> Array:
    """Where H f' exceeds the mean pressure, widened as a lone gap in a parabola of H f' would be, and over kinks."""
    period = problem.period
    assert period is not None
    x = _samples(problem)[:-1]
    step = float(x[1] - x[0])
    value = np.asarray(conjugate(x))
    valleys = _over_kinks(period, mean, conjugate, 0.5 * _UNSEEN * step)
    above = value > mean
    if above.all():
        raise WrongTopology("the mean pressure is below H f' everywhere", None)
    if above.any():
        seen = _runs(x, value, above, mean, period)
        apart = np.abs((seen.mean(axis=1)[:, None] - valleys.mean(axis=1) + 0.5 * period) % period - 0.5 * period)
        unseen = (apart < 2 * step).any(axis=1) & (seen[:, 1] - seen[:, 0] < 2 * _UNSEEN * step)
        return _united(np.concatenate((seen[~unseen], valleys)), period)
    if len(valleys):
        return _united(valleys, period)
    place, highest = maximum(lambda points: np.asarray(conjugate(points)), np.append(x, x[0] + period))
    if highest <= mean:
        return np.zeros((0, 2))
    bend = 2 * highest - float(conjugate(np.array([place - step]))[0]) - float(conjugate(np.array([place + step]))[0])
    half = 2 * step * np.sqrt((highest - mean) / bend)
    return np.array([[place - half, place + half]])


def _over_kinks(period: float, mean: float, conjugate: ScaledConjugate, widest: float) -> Array:
    """Lone gaps over the concave kinks, where they are narrower than the samples show and wide enough to have ends."""
    kinks = np.flatnonzero(conjugate.heights < 0)
    half = period / np.pi * np.exp(np.pi * np.minimum((mean - conjugate.without_own(kinks)) / conjugate.heights[kinks], 9.0))
    which = (half < widest) & (half > NARROWEST * period)
    at, half = conjugate.at[kinks][which], half[which]
    return np.column_stack((at - half, at + half))


def _runs(x: Array, value: Array, above: NDArray[np.bool_], mean: float, period: float) -> Array:
    """The runs of samples above the mean pressure, from crossing to crossing, widened by sqrt(2)."""
    shift = int(np.argmin(above))  # start in contact, so that no run crosses the border
    x = np.concatenate((x[shift:], x[:shift] + period))
    highest = 2 * np.abs(value[np.isfinite(value)]).max(initial=abs(mean))
    above, value = np.roll(above, -shift), np.clip(np.roll(value, -shift), -highest, highest)
    change = np.flatnonzero(np.diff(np.concatenate(([False], above, [False])).astype(np.int8)))
    first, last = change[::2], change[1::2] - 1
    step = float(x[1] - x[0])
    # The crossings of the level lie between samples.
    before, after = value[first - 1] - mean, value[(last + 1) % len(x)] - mean
    a = x[first] - step * (value[first] - mean) / (value[first] - mean - before)
    b = x[last] + step * (value[last] - mean) / (value[last] - mean - after)
    middle, half = 0.5 * (a + b), 0.5 * np.sqrt(2) * (b - a)
    return _united(np.column_stack((middle - half, middle + half)), period)


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
