"""The first-order closure of one zone: the nominal pressure is the isolated load P0 of the same width, over the period.

    pbar = P0(W) / L,      W = width of the zone of the strip under this nominal pressure

(Goryacheva & Tsukanov 2020, (16) with P_s = P0). For given W both problems are ordinary ones, so that what is controlled is a function of
W, whose root is taken on the branch that starts at zero load and ends at the first maximum. Of several zones: first_order_several.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from contact.errors import NotConverged, OutOfRange
from contact.formulation.controls import Control, HalfWidth, Load, Width
from contact.formulation.problem import Problem
from contact.formulation.roots import bracketed
from contact.model.interactions.isolated import Isolated
from contact.verify.accuracy import Found
from sie import Array

Search = Callable[[Problem, Control, Array | None], Found]

_STEPS = 30


class FirstOrder:
    """The pair of problems, and the search for the width that carries the control.

    strip, alone: searches for the zone of the strip under a given nominal pressure, and for that of the isolated reference. first: about
    the zone, where it is not one about the origin.
    """

    def __init__(self, problem: Problem, strip: Search, alone: Search, first: Array | None) -> None:
        self.problem, self.strip, self.alone, self.first = problem, strip, alone, first
        self.isolated = replace(problem, interaction=Isolated(), centre=0.0, amplitude=None, reference=True)
        self.together: Found | None = None

    def found(self, control: Control, guess: float) -> Found:
        """The zone that carries the control. guess: of its width, which a half width gives."""
        found, amplitude = self._at_width(guess if control.half_width is not None else self._width_for(control, guess))
        rate = self._rate(found)
        load = found.fields.density.total
        final = self.strip(found.fields.problem.with_amplitude(amplitude), Load(load), _table(found))
        return replace(final, fields=replace(final.fields, amplitude_rate=rate), control=control)

    @property
    def _period(self) -> float:
        assert self.problem.period is not None
        return self.problem.period

    def _at_width(self, width: float) -> tuple[Found, float]:
        """(zones of the strip of this total width under P0 of the same width, that nominal pressure)."""
        control = self._of_width(width)
        start = _widened(self.first if self.together is None else _table(self.together), width)
        amplitude = self.alone(self.isolated, control, start).fields.density.total / self._period
        problem = self.problem if self.together is None else self.together.fields.problem
        self.together = self.strip(problem.with_amplitude(amplitude), control, start)
        return self.together, amplitude

    def _of_width(self, width: float) -> Control:
        return HalfWidth(0.5 * width) if self.first is None else Width(width)

    def _rate(self, found: Found) -> float:
        """d amplitude / d load = dP0/dW over dP/dW, by central differences: the stiffness needs no more digits than they have."""
        width = _width(found)
        step = min(1e-5 * width, 0.25 * (self._period - width))
        (ahead, more), (behind, less) = self._at_width(width + step), self._at_width(width - step)
        return (more - less) / (ahead.fields.density.total - behind.fields.density.total)

    def _width_for(self, control: Control, guess: float) -> float:
        """Bracket the root upwards from zero width, then close the bracket."""

        def miss(width: float) -> float:
            found, _ = self._at_width(width)
            got = found.fields.density.total if control.load is not None else -found.fields.level
            return got - control.value

        limit, lost = 0.9998 * self._period, None
        high = min(guess, 0.5 * limit)
        at_high = miss(high)
        while at_high > 0:
            high *= 0.5
            at_high = miss(high)
        low, at_low = high, at_high
        step = 0.25 * high
        while at_high <= 0:
            low, at_low = high, at_high
            if limit - high < 1e-9:
                raise lost if isinstance(lost, NotConverged) else self._refused(control, low, at_low)
            high = min(high + step, limit)
            try:
                at_high = miss(high)
            except (OutOfRange, NotConverged) as refusal:
                limit, step, lost = high, 0.25 * (high - low), refusal
                high, at_high = low, at_low
                # Of zones from grids another search follows, which tells more than the last digits of a width do.
                if step < (1e-7 if self.first is None or isinstance(refusal, OutOfRange) else 1e-2) * limit:
                    # That a search has failed does not show that there is no more to be carried.
                    raise lost if isinstance(lost, NotConverged) else self._refused(control, low, at_low) from None
                continue
            if at_high < at_low:
                # Past a maximum: come closer from below until it is clear that the root is not before it.
                if step < 1e-7 * high:
                    raise self._refused(control, low, at_low)
                limit = min(limit, high)
                step *= 0.25
                high, at_high = low, at_low
        # Rounding may keep the bracket from closing: then its last point is as good as any.
        return bracketed(miss, {low: at_low, high: at_high}, xtol=4e-16 * high, rtol=1e-15, most=2 * _STEPS)

    def _refused(self, control: Control, width: float | None = None, miss: float = 0.0) -> OutOfRange:
        units = self.problem.units
        unit = control.unit(units)
        largest = "" if width is None else f", {(control.value + miss) * unit:.6g} at total width {width * units.length:.6g} m"
        return OutOfRange(
            f"{control.told(units)} is beyond the largest that the first-order closure carries on the branch from zero "
            f"load{largest}; interaction = Periodic() has no such limit"
        )


def _table(found: Found) -> Array:
    return found.free.density.zones.table


def _width(found: Found) -> float:
    zones = found.free.density.zones
    return float((zones.b - zones.a).sum())


def _widened(table: Array | None, width: float) -> Array | None:
    """Zones each widened in proportion to a new total width."""
    if table is None:
        return None
    middle, half = table.mean(axis=1), 0.5 * np.diff(table, axis=1)[:, 0]
    half = half * (0.5 * width / float(half.sum()))
    return np.column_stack((middle - half, middle + half))
