r"""Contact on given zones under a law of prescribed intensities: what drives its ends, and how that
changes as they move.

With r_i = K_i - K* at every end, K* < 0 of the law, an end is driven outward while r_i > 0: by ds
the energy changes by (pi/E*)(K_i^2 - K*^2) ds. Equilibria have r = 0; they are followed in
contact.adhesion.gradient_flow, by growing and shrinking, and in contact.adhesion.arc_length,
along their curve.

A sharp corner, beyond which the profile ends, is an obstacle: an end that is driven outward there
(r >= 0) is held, whatever r, and does not move; one that is driven inward leaves it. So an
equilibrium has r = 0 at free ends and r >= 0 at held ones.
"""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Self

import numpy as np

import sie
from contact.errors import NotConverged, OutOfRange
from contact.formulation.controls import Control, Load
from contact.formulation.fields import ZoneFields
from contact.formulation.problem import Problem
from contact.formulation.tables import ascending, centred_on, gaps_between, room_beside
from sie import Array, Index, Mask, record

# Newton's steps to an equilibrium near by, and the last one's size over the widths; one so large is
# of another.
_STEPS = 8
_TIGHT = 1e-11
_ANOTHER = 1e-2

# To which states are solved that are none on the way; and densities by which rates are told where
# zones are many: of such a state, and of one on the way.
_EXACT = 1e-13
_OF_RATES = 1e-10
_OF_ROUGH_RATES = 1e-4


# An end nearer to a sharp corner than this part of the body's width is there; and one that is
# driven inward by so little is still held.
_SNAP = 1e-14
HELD = 1e-10


# Growth within rounding of none.
NEUTRAL = 1e-12


# Rates over the slope of the energy are told by K over K* down to this part; second derivatives
# that differ by more are of no energy.
_TELLING = 1e-3
_ALIKE = 1e-8


class Closed(Exception):
    """All gaps of a period have closed."""


class NoState(Exception):
    """There is no contact on such intervals."""


@record
class Corners:
    """Of zones of a profile with sharp corners. held: which ends rest at one (2n,); residual,
    rates, by_value: as if none did.
    """

    held: Mask
    residual: Array
    rates: Array
    by_value: Array


@record
class Point:
    """Zones (n, 2) under a value of the control. residual: r over |K*| of the left and then the
    right ends (2n,); rates: dr/ds (2n, 2n); by_value: dr/d(value); load and level: scaled. At ends
    that are held nothing drives them: the residual is 0, and stays so but for motions of their own,
    against which they are stable. corners: None where the profile has none. solved: the density on
    these zones, and to what it is; None where it is not kept.
    """

    table: Array
    value: float
    residual: Array
    rates: Array
    by_value: Array
    load: float
    level: float
    corners: Corners | None = field(default=None, kw_only=True)
    solved: tuple[sie.AnyState, float] | None = field(default=None, kw_only=True)

    @property
    def whole(self) -> Corners:
        """What drives all ends, held or not."""
        return self.corners or Corners(
            np.zeros(len(self.residual), dtype=bool), self.residual, self.rates, self.by_value
        )

    @property
    def held(self) -> Mask:
        """Which ends rest at sharp corners (2n,)."""
        return self.whole.held

    def holding(self, held: Mask) -> Self:
        """The same with these ends held, and no others."""
        whole, free = self.whole, ~held
        rates = np.where(free[:, None] & free, whole.rates, 0.0) - np.diag(held / self.widths)
        corners = replace(whole, held=held)
        return replace(
            self,
            residual=np.where(held, 0.0, whole.residual),
            rates=rates,
            by_value=np.where(held, 0.0, whole.by_value),
            corners=corners,
        )

    @property
    def contact(self) -> Array:
        """The zones of contact."""
        return self.table

    @property
    def widths(self) -> Array:
        """Of the zone of each end (2n,)."""
        return np.tile(np.diff(self.table, axis=1)[:, 0], 2)

    @property
    def weight(self) -> Array:
        """What drives ends over their motion: in these, growing motions of wide and of narrow zones
        are compared.
        """
        return np.maximum(np.abs(np.diag(self.rates)), 1.0 / self.widths)

    @property
    def gains(self) -> Array:
        """K over K* (2n,): the slope of the energy goes with its square, so that dr/ds times it is
        the energy's second derivative.
        """
        return 1.0 - self.residual

    @cached_property
    def growth(self) -> float:
        """Largest eigenvalue of J over D: negative where an equilibrium is stable."""
        return self.growth_of(np.arange(len(self.residual)))

    def growth_of(self, ends: Index) -> float:
        """The same where only these ends move."""
        second = self._second(ends)
        values = (
            np.linalg.eigvals(self._driven(ends)).real
            if second is None
            else np.linalg.eigvalsh(second[0])
        )
        return float(values.max(initial=-1.0))

    def motions(self, ends: Index) -> tuple[Array, Array]:
        """(eigenvalues of J over D where only these ends move, real parts; their motions, a column
        each).
        """
        second = self._second(ends)
        if second is None:
            growth, motions = np.linalg.eig(self._driven(ends))
            return growth.real, motions
        growth, motions = np.linalg.eigh(second[0])
        return growth, second[1][:, None] * motions

    def _driven(self, ends: Index) -> Array:
        return np.asarray(self.rates[np.ix_(ends, ends)] / self.weight[ends, None])

    def _second(self, ends: Index) -> tuple[Array, Array] | None:
        """(a symmetric matrix that has the eigenvalues of J over D, motions over its eigenvectors),
        by the energy; None where an end is driven so hard that it does not tell, or where an
        interaction has none.
        """
        gains = self.gains[ends]
        if gains.min(initial=1.0) < _TELLING:
            return None
        scale = 1.0 / np.sqrt(gains * self.weight[ends])
        matrix = (gains * scale)[:, None] * self.rates[np.ix_(ends, ends)] * scale
        if np.abs(matrix - matrix.T).max(initial=0.0) > _ALIKE:
            return None
        return 0.5 * (matrix + matrix.T), scale

    def damped_step(self, by: Array | float) -> Array:
        """All ends down the slope of the energy: a step of the implicit Euler method, damped by
        what is above the largest growth.
        """
        damped = np.diag((max(self.growth, 0.0) + by) * self.weight)
        return np.asarray(np.linalg.solve(damped - self.rates, self.residual), dtype=np.float64)

    def refuse_neutral(self) -> None:
        """NotConverged where a motion of the ends drives none of them: there is not one contact,
        but a row of them.
        """
        if abs(self.growth) <= NEUTRAL:
            raise NotConverged(
                "a zone on a level stretch may be anywhere along it, and no one place is that of the contact"
            )

    @cached_property
    def newton(self) -> Array:
        """Newton's step of the ends, outward."""
        return np.asarray(np.linalg.solve(-self.rates, self.residual), dtype=np.float64)

    def moved(self, outward: Array) -> Array:
        """The zones with ends moved."""
        left, right = np.split(outward, 2)
        return self.table + np.column_stack((-left, right))


@dataclass(frozen=True)
class Equilibria:
    """Those of a problem under one control at any value; held: at one of them."""

    problem: Problem
    held: Control

    def at(
        self, table: Array, value: float, tolerance: float = _EXACT, held: Mask | None = None
    ) -> Point:
        """The state of given zones, no farther than to sharp corners: one linear solution and its
        rates. held: at corners; None: those that are there and are not driven inward.
        """
        table = self.within(table)
        problem, control = self.problem, replace(self.held, value=value)
        lo, hi = problem.borders
        if table[0, 0] <= lo or table[-1, 1] >= hi:
            raise OutOfRange(
                "a contact zone reaches the border of the part of the profile that is known"
            )
        zones = sie.Zones.of(table, problem.end, problem.end)
        equation = problem.equation(control)
        solved = sie.solve_zones(equation, zones, tolerance)
        state = solved.whole
        follows, wanted = state, problem.end.intensity
        if state.iteration is not None:
            # There are as many right sides as ends: a matrix once, as small as rates are told by,
            # not an iteration for each.
            follows = sie.solve_fixed(
                equation,
                state.density.zones,
                _OF_RATES if tolerance <= _EXACT else _OF_ROUGH_RATES,
                direct=True,
            )
        rates = sie.end_rates(follows)
        assert wanted is not None
        size = abs(wanted)
        values = np.zeros(len(follows.condition_scale))
        first = follows.condition_index[0]
        # The load is the total; else minus the value stands in the row of every zone.
        by_load = control.load is not None
        values[first : first + (1 if by_load else len(table))] = 1.0 if by_load else -1.0
        unit = np.concatenate(follows.response(values).intensities)
        residual = (np.concatenate(state.density.intensities) - wanted) / size
        level = -value if control.approach is not None else float(state.levels.mean())
        here = Point(
            table,
            value,
            residual,
            rates.intensities / size,
            unit / size,
            state.density.total,
            level,
            solved=(solved, tolerance),
        )
        corners = problem.corners
        if not np.isfinite(corners).all():
            return here
        if held is None:
            held = (table == np.array(corners)).T.ravel() & (residual >= -HELD)
        return here.holding(held)

    def under(self, control: Control) -> "Equilibria":
        """Those under another control."""
        return Equilibria(self.problem, control)

    def again(self, here: Point, value: float) -> Point:
        """A state that was found under another control, under a value of this one."""
        return self.at(here.table, value)

    def unit(self, here: Point) -> float:
        """Of the value of the control: what changes that which drives some end by as much as is
        asked of it.
        """
        return 1.0 / float(np.abs(here.whole.by_value).max())

    def vanishes(self, here: Point, motion: Array) -> float:
        """How far along a motion of the ends and of the control (2n + 1,) contact within the zones
        of a state vanishes.
        """
        return np.inf

    @property
    def formally(self) -> "Equilibria":
        """The same of states of which it is not asked whether their zones of contact are the right
        ones.
        """
        return self

    def has_right_zones(self, here: Point) -> bool:
        """Whether zones of contact that were not asked for are."""
        return True

    def within(self, table: Array) -> Array:
        """The zones as far as sharp corners let them, and those so near to one up to it; of a body
        that repeats, in its own period.
        """
        lo, hi = self.problem.corners
        if not np.isfinite([lo, hi]).all():
            return table
        if (period := self.problem.period) is not None:
            table = ascending(centred_on(table, 0.5 * (lo + hi), period))
        table, snap = np.clip(table, lo, hi), _SNAP * (hi - lo)
        table[:, 0], table[:, 1] = (
            np.where(table[:, 0] <= lo + snap, lo, table[:, 0]),
            np.where(table[:, 1] >= hi - snap, hi, table[:, 1]),
        )
        return np.asarray(table)

    def to_corners(self, table: Array) -> Array:
        """How far ends are from the sharp corners next to them, without end where there is none
        (2n,).
        """
        away, (lo, hi) = np.full(table.size, np.inf), self.problem.corners
        away[0], away[-1] = table[0, 0] - lo, hi - table[-1, 1]
        return away

    def settled(self, here: Point) -> Point:
        """The equilibrium near by, tightly."""
        rough = here.solved is not None and here.solved[1] > _EXACT and here.growth < -_ANOTHER
        near = rough and float(np.abs(here.newton / here.widths).max()) < _ANOTHER
        here = self.at(here.moved(here.newton) if near else here.table, here.value)
        here.refuse_neutral()
        for _ in range(_STEPS):
            size = float(np.abs(here.newton / here.widths).max())
            if size > _ANOTHER:
                break
            # The last step is taken, too: a digit more.
            here = self.at(here.moved(here.newton), here.value)
            if size < _TIGHT:
                break
        return here

    def fields(self, here: Point, tolerance: float = _EXACT) -> ZoneFields:
        """Pressure and gap on these zones, under the load that they have."""
        if here.solved is not None and here.solved[1] <= tolerance:
            return ZoneFields(self.problem, here.solved[0])
        zones = sie.Zones.of(here.table, self.problem.end, self.problem.end)
        return ZoneFields(
            self.problem, sie.solve_zones(self.problem.equation(Load(here.load)), zones, tolerance)
        )

    def gaps(self, table: Array) -> Array:
        """Right of each zone; infinite beyond the last without a period."""
        return np.asarray(np.diff(gaps_between(table, self.problem.period))[:, 0])

    def room(self, table: Array) -> Array:
        """The width of the zone of each end, or of the gap beside it, whichever is less (2n,)."""
        return np.asarray(room_beside(table, self.problem.period).T.ravel())
