"""The first-order closure: the nominal pressure is the isolated load P0 of the same total width, over the period.

    pbar = P0(W) / L,      W = total width of the zones the localized equation then gives at the wanted load

(Goryacheva & Tsukanov 2020, (16) with P_s = P0). For given W both problems are ordinary ones, so the load is a function of W;
its root is taken on the branch that starts at zero load and ends at the first maximum.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from contact import lazy
from contact.errors import ContactError, OutOfRange
from contact.interactions.isolated import Isolated
from contact.interactions.localized import Localized
from contact.problem import Control, Problem
from contact.topology import Found

Array = NDArray[np.float64]
Search = Callable[[Problem, Control, Array | None], Found]

_STEPS = 60


class FirstOrder:
    """The pair of problems at a given total width, and the search for the width that carries the control."""

    def __init__(self, problem: Problem, search: Search, tolerance: float, single: bool) -> None:
        self.problem, self.search, self.tolerance, self.single = problem, search, tolerance, single
        self.isolated = replace(problem, interaction=Isolated(), centre=0.0, amplitude=None, reference=True)
        self.alone: Found | None = None
        self.together: Found | None = None
        self.seed: Found | None = None
        self.given = False  # whether one zone of given half width is asked for, wherever more would touch

    def at_width(self, width: float) -> tuple[Found, float]:
        """(localized zones of this total width, amplitude), each found from the last one's zones."""
        kind, value = ("half_width", 0.5 * width) if self.single or self.given else ("width", width)
        control = Control(kind, value)
        near = self.seed if self.alone is None else self.alone
        self.alone = self.search(self.isolated, control, _scaled(near, width))
        assert self.problem.period is not None
        amplitude = self.alone.fields.density.total / self.problem.period
        start = _scaled(self.seed if self.together is None else self.together, width)
        if start is None:
            start = self.alone.free.density.zones.table
        middle = 0.5 * float(start[0, 0] + start[-1, 1])
        # Zones about another place than the centre may reach the border of its strip, where the column is infinite.
        centre = 0.0 if abs(middle) < 1e-9 * width else middle
        self.together = self.search(self.problem.about(centre).with_amplitude(amplitude), control, start)
        return self.together, amplitude

    def found(self, control: Control, guess: float) -> tuple[Found, float]:
        """The zones that carry the control, and d amplitude / d load at them (for the stiffness)."""
        if control.kind == "half_width":
            width, self.given = 2 * control.value, True
        elif control.kind == "width":
            width = control.value
        else:
            width = self._width_for(control, guess if self.single else self._near_width(control, guess))
        found, amplitude = self.at_width(width)
        # dP0/dW over dP/dW, by central differences: the stiffness needs no more digits than they have.
        assert self.problem.period is not None
        step = min(1e-5 * width, 0.25 * (self.problem.period - width))
        ahead, more = self.at_width(width + step)
        total_ahead = ahead.fields.density.total
        behind, less = self.at_width(width - step)
        rate = (more - less) / (total_ahead - behind.fields.density.total)
        final = self.search(
            found.fields.problem.with_amplitude(amplitude), Control("load", found.fields.density.total),
            found.free.density.zones.table,
        )
        return replace(final, fields=replace(final.fields, amplitude_rate=rate)), amplitude

    def _near_width(self, control: Control, guess: float) -> float:
        """Total width of the self-consistent zones under the same control, which are kept as a start: many zones are not found
        from widths far off."""
        closed = replace(self.problem, interaction=Localized(closure="self-consistent"), amplitude=None)
        try:
            self.seed = self.search(closed, control, None)
        except ContactError:
            return guess
        zones = self.seed.free.density.zones
        return float((zones.b - zones.a).sum())

    def _width_for(self, control: Control, guess: float) -> float:
        """Bracket the root upwards from zero width, then close the bracket by the Illinois secant."""

        def miss(width: float) -> float:
            found, _ = self.at_width(width)
            got = found.fields.density.total if control.kind == "load" else -found.fields.level
            return got - control.value

        assert self.problem.period is not None
        limit = 0.9998 * self.problem.period
        high = min(guess, 0.5 * limit)
        at_high = miss(high)
        share = 0.5 if self.seed is None else 0.02
        while at_high > 0:
            high *= 1 - share
            share = min(2 * share, 0.5)
            at_high = miss(high)
        low, at_low = high, at_high
        step = (0.25 if self.seed is None else 0.02) * high
        while at_high <= 0:
            low, at_low = high, at_high
            if limit - high < 1e-9:
                self._refuse(low, at_low, control)
            high = min(high + step, limit)
            try:
                at_high = miss(high)
            except OutOfRange:
                limit, step = high, 0.25 * (high - low)
                high, at_high = low, at_low
                if step < 1e-7 * limit:
                    self._refuse(low, at_low, control)
                continue
            if at_high < at_low:
                # Past a maximum: come closer from below until it is clear that the root is not before it.
                if step < 1e-7 * high:
                    self._refuse(low, at_low, control)
                limit = min(limit, high)
                step *= 0.25
                high, at_high = low, at_low
            elif self.seed is not None:
                step *= 2
        # Rounding may keep the bracket from closing: then its last point is as good as any.
        root = lazy.scipy_optimize().brentq(miss, low, high, xtol=4e-16 * high, rtol=1e-15, maxiter=_STEPS, disp=False)
        return float(root)

    def _refuse(self, width: float, miss: float, control: Control) -> None:
        units = self.problem.units
        unit = units.load if control.kind == "load" else units.height
        raise OutOfRange(
            f"{control.kind} {control.value * unit:.6g} is beyond the largest that the first-order closure carries on the "
            f"branch from zero load, {(control.value + miss) * unit:.6g} at total width {width * units.length:.6g} m"
        )


def _scaled(found: Found | None, width: float) -> Array | None:
    """The last zones, each widened in proportion to the new total width."""
    if found is None:
        return None
    zones = found.free.density.zones
    total = float((zones.b - zones.a).sum())
    factor = width / total
    if not 0.5 < factor < 2.0 or not math.isfinite(factor):
        return None
    half = zones.half * factor
    table = np.column_stack((zones.middle - half, zones.middle + half))
    return table if np.all(np.diff(table.ravel()) > 0) else None
