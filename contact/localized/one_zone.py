"""First-order closure of one zone: the nominal pressure pbar follows from the zone's width W.

    pbar = P0(W) / L,      W = width of the zone of the strip under this nominal pressure

(Goryacheva & Tsukanov 2020, (16) with P_s = P0). P0(W) is the load of the isolated contact of the
width W, and L the period. For a given W, the contacts of the strip and of the isolated profile are
ordinary problems, so the controlled quantity is a function of W. Newton's method in a bracket finds
the W for the given value of the controlled quantity, on the branch that starts at zero load and
ends at the first maximum of this quantity.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from contact.errors import NotConverged, OutOfRange
from contact.formulation.controls import Control, HalfWidth, Load, Width
from contact.formulation.problem import Problem
from contact.formulation.tolerances import TOLERANCES
from contact.localized.derivatives import ContactRates, TwoContacts, table_of
from contact.localized.several_zones import no_isolated_load
from contact.model.interactions.isolated import Isolated
from contact.model.profiles.noise import EPS
from contact.search.options import SEARCH
from contact.search.topology.failure import EXACT
from contact.verify.error import SolvedZones
from sie import Array, record

Search = Callable[[Problem, Control, Array | None], SolvedZones]


@dataclass(frozen=True)
class WidthOptions:
    """Options of Newton's method for the contact width, if the contact is one zone."""

    # Largest width of the zone, relative to the period. For wider zones, the right side of the
    # equation is not resolved.
    widest: float = 0.9998

    @property
    def converged_step(self) -> float:
        """Step of the contact width, relative to the width, below which Newton's method stops.

        A final linear correction then leaves an error of about the square of this step.
        """
        return math.sqrt(EPS)

    @property
    def at_maximum(self) -> float:
        """Relative size of the bracket at which the search for the largest load ends.
        The bracket is an interval of contact widths.
        """
        return math.sqrt(self.converged_step)


@record
class _AtWidth:
    """Two contacts of equal width: that of the strip, and that of the strip's profile alone.

    present, wanted: the controlled quantity (such as the load), and its given value. slope,
    by_load: derivatives of the controlled quantity by the width and by the load. following:
    derivatives (3,) of the strip's centre, the nominal pressure and the load, by the load.
    """

    at: TwoContacts
    width: float
    present: float
    wanted: float
    slope: float
    by_load: float
    following: Array

    @property
    def residual(self) -> float:
        return self.present - self.wanted

    @property
    def step(self) -> float:
        """Newton's step of the contact width.
        It is inf unless the controlled quantity grows with the width.
        """
        return -self.residual / self.slope if self.slope > 0.0 else math.inf


class OneZoneClosure:
    """The search for the contact width at which the controlled quantity has its given value.

    solve_strip: solves the strip under a given nominal pressure. solve_reference: solves the
    profile alone.
    first: zones near the solution; None for a zone about the origin. tol: wanted error.
    """

    def __init__(
        self,
        problem: Problem,
        solve_strip: Search,
        solve_reference: Search,
        first: Array | None,
        tol: float,
    ) -> None:
        self.problem, self.first = problem, first
        self.solve_strip, self.solve_reference = solve_strip, solve_reference
        self.tol = tol
        self.isolated = replace(
            problem, interaction=Isolated(), centre=0.0, amplitude=None, reference=True
        )
        self.last: SolvedZones | None = None
        self.options = WidthOptions()

    def found(self, control: Control, guess: float) -> SolvedZones:
        """The zones for the given controlled quantity, such as the load.
        `guess` is a first guess of their width.
        """
        given = control.half_width is not None
        here = self._at_width(control, guess) if given else self._root(control, guess)
        condition = here.slope * here.width / abs(here.present)
        if not given and TOLERANCES.rounding * condition > self.tol:
            raise no_isolated_load()
        strip, rate, more = (
            here.at.strip,
            float(here.following[1]),
            0.0 if given else -here.residual / here.by_load,
        )
        _, pressure, load = (float(unknown) for unknown in here.at.unknowns)
        problem = strip.fields.problem.with_amplitude(pressure + rate * more)
        final = self.solve_strip(
            problem, Load(load + more if control.load is None else control.load), table_of(strip)
        )
        return replace(final, fields=replace(final.fields, amplitude_rate=rate), control=control)

    @property
    def _period(self) -> float:
        assert self.problem.period is not None
        return self.problem.period

    def _at_width(self, control: Control, width: float) -> _AtWidth:
        """Two contacts of the given width: that of the strip, and that of the strip's profile
        alone.

        The load of the profile alone, divided by the period, is the strip's nominal pressure.
        """
        of_width = HalfWidth(0.5 * width) if self.first is None else Width(width)
        start = _widened(self.first if self.last is None else table_of(self.last), width)
        reference = self.solve_reference(self.isolated, of_width, start)
        pressure = reference.fields.density.total / self._period
        problem = self.problem if self.last is None else self.last.fields.problem
        strip = self.last = self.solve_strip(problem.with_amplitude(pressure), of_width, start)
        at = TwoContacts(
            np.array([strip.fields.problem.centre, pressure, strip.fields.density.total]),
            strip,
            reference,
        )
        rates = ContactRates(at)
        grows = rates.following
        present, by_load = float(at.unknowns[2]), 1.0
        if control.approach is not None:
            present, by_load = -strip.fields.level, float(rates.approach @ grows)
        return _AtWidth(
            at,
            width,
            present,
            control.value,
            by_load / float(grows[1] * rates.reference_by_pressure.sum()),
            by_load,
            grows,
        )

    def _root(self, control: Control, guess: float) -> _AtWidth:
        """Both contacts at the width at which the controlled quantity has its given value.
        Newton's method finds the width within a bracket.

        At the lower end of the bracket the controlled quantity is too small. This end lies on the
        branch from zero load.
        """
        options, low = self.options, None
        high, carries, refusal = options.widest * self._period, False, None
        width, last = min(guess, 0.5 * high), math.inf
        for _ in range(SEARCH.max_steps):
            here: _AtWidth | None = None
            try:
                here = self._at_width(control, width)
            except (OutOfRange, NotConverged) as missing:
                if low is None:
                    raise
                high, carries, refusal = width, False, missing
            if here is not None:
                step = abs(here.step)
                if step <= options.converged_step * width or (
                    step > 0.5 * last and last < TOLERANCES.noise * width
                ):
                    return here
                last = step
                if here.residual < 0.0 and here.slope > 0.0:
                    low = here
                else:
                    high, carries, refusal = width, here.residual >= 0.0, None
            if low is not None and not carries and high - low.width < options.at_maximum * high:
                raise refusal if isinstance(refusal, NotConverged) else self._refused(control, low)
            least = 0.0 if low is None else low.width
            there = math.inf if here is None else here.width + here.step
            if not least < there < high:
                there = 0.5 * (least + high)
            width = min(there, 2 * width)
        raise NotConverged(
            "not converged: the total width of the zones under the first-order closure did not "
            f"settle; {EXACT}"
        )

    def _refused(self, control: Control, low: _AtWidth) -> OutOfRange:
        units = self.problem.units
        largest = low.present * control.unit(units)
        return OutOfRange(
            f"{control.described(units)} is beyond the largest value under the first-order closure "
            f"on the branch from zero load, {largest:.6g} at a total zone width of "
            f"{low.width * units.length:.6g} m: use interaction = Periodic(), which has no such "
            "limit"
        )


def _widened(table: Array | None, width: float) -> Array | None:
    """The zones with their widths scaled in proportion to a new total width."""
    if table is None:
        return None
    middle, half = table.mean(axis=1), 0.5 * np.diff(table, axis=1)[:, 0]
    half = half * (0.5 * width / float(half.sum()))
    return np.column_stack((middle - half, middle + half))
