"""The curve of equilibria under a law of prescribed edge intensities (JKR).

A state is a contact on given zones. At every end i the residual is r_i = K_i - K*: the edge
intensity K_i of the pressure minus the intensity K* < 0 that the law prescribes. An end is driven
outward while r_i > 0: when it moves by ds, the energy changes by (pi/E*)(K_i^2 - K*^2) ds.
Equilibria have r = 0. They are found from zones that grow or shrink
(contact.adhesion.gradient_flow), and followed along their curve (contact.adhesion.arc_length).

A sharp corner, beyond which the profile ends, is an obstacle. An end that is driven outward there
(r >= 0) is pinned and does not move; an end that is driven inward leaves it. So an equilibrium
has r = 0 at free ends and r >= 0 at pinned ones.
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
from contact.model.profiles.noise import EPS
from sie import Array, Index, Mask, record


@dataclass(frozen=True)
class StateAccuracy:
    """Tolerances of a state on given intervals, and of an equilibrium.

    Lengths are relative to the width of the interval of each end.
    """

    # Relative accuracy of the density (the pressure on the zones) in a final state. It is the
    # round-off of the engine `sie`.
    density: float = 1e-14
    # Round-off times a condition number of 1e3. A growth rate, a step, a width or a height below
    # this counts as zero.
    neutral: float = 1e-12
    # Accuracy of intermediate states in the search for an equilibrium. A residual smaller than this
    # may have the wrong sign.
    rough: float = 1e-9
    # Largest Newton step, relative to the widths, at which an intermediate equilibrium has
    # converged. Smaller steps may be round-off.
    resting_step: float = 1e-6
    # Accuracy of auxiliary quantities: rates, residuals, turning points, solutions on grids. Errors
    # of rates make Newton's method slower, but its result no less accurate.
    coarse: float = 1e-4
    # Limits of a Newton search that must not end in another equilibrium: the relative length of a
    # step, and the number of steps.
    other_equilibrium: float = 1e-2
    max_newton_steps: int = 8


ACCURACY = StateAccuracy()


class Closed(Exception):
    """Error: all gaps of a period have closed."""


class NoState(Exception):
    """Error: there is no contact on the given intervals."""


@record
class Corners:
    """Residuals of all ends on a profile with sharp corners, as if no end were pinned.

    pinned: mask (2n,) of the ends pinned at a corner. residual, rates, by_value: as in `State`.
    """

    pinned: Mask
    residual: Array
    rates: Array
    by_value: Array


@record
class State:
    """Intervals at a value of the control, with the residuals of the ends of the intervals.
    An end is in equilibrium if its residual is 0, and tends to advance if its residual is positive.

    table: the intervals (n, 2). residual: r/|K*| of the left and then the right ends (2n,).
    rates: derivatives of the residuals with respect to outward displacements s of the ends
    (2n, 2n). by_value: derivatives of the residuals with respect to the value of the control (2n,).
    load, level: the load and minus the approach, scaled. The residual of a pinned end is 0, and its
    rates make it stable. corners: None without sharp corners. solved: the state in the engine `sie`
    and its tolerance, None where they are not kept.
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
        """Residuals and rates of all ends, as if no end were pinned."""
        return self.corners or Corners(
            np.zeros(len(self.residual), dtype=bool), self.residual, self.rates, self.by_value
        )

    @property
    def pinned(self) -> Mask:
        """Mask of the ends that are pinned at sharp corners (2n,)."""
        return self.whole.pinned

    def with_pinned(self, pinned: Mask) -> Self:
        """A copy of this state in which the ends `pinned` are pinned and all others are free."""
        whole, free = self.whole, ~pinned
        rates = np.where(free[:, None] & free, whole.rates, 0.0) - np.diag(pinned / self.widths)
        corners = replace(whole, pinned=pinned)
        return replace(
            self,
            residual=np.where(pinned, 0.0, whole.residual),
            rates=rates,
            by_value=np.where(pinned, 0.0, whole.by_value),
            corners=corners,
        )

    def at_corners(self, corners: tuple[float, float]) -> Self:
        """This state, with ends at sharp corners pinned unless they are driven inward."""
        if not np.isfinite(corners).all():
            return self
        at = (self.table == np.array(corners)).T.ravel()
        return self.with_pinned(at & (self.residual >= -ACCURACY.rough))

    @property
    def contact(self) -> Array:
        """The zones of contact (n, 2)."""
        return self.table

    @property
    def widths(self) -> Array:
        """Width (2n,) of the interval to which each end belongs."""
        return np.tile(np.diff(self.table, axis=1)[:, 0], 2)

    @property
    def weight(self) -> Array:
        """Scale (2n,) of each end's dr/ds, with its residual r and outward displacement s.
        Rates dr/ds divided by these scales are comparable between wide and narrow zones.
        """
        return np.maximum(np.abs(np.diag(self.rates)), 1.0 / self.widths)

    @property
    def gains(self) -> Array:
        """Ratio K/K* (2n,) of the edge intensity K at each end to the intensity K* of the law.

        The slope of the energy is proportional to K^2. So dr/ds times K/K* is proportional to a
        second derivative of the energy.
        """
        return 1.0 - self.residual

    @cached_property
    def growth(self) -> float:
        """Largest eigenvalue of the scaled rates dr/ds of the residuals r; negative if stable.

        Here s are the motions of the ends. The rates are divided by the scales `weight`.
        """
        return self.growth_of(np.arange(len(self.residual)))

    def growth_of(self, ends: Index) -> float:
        """Largest eigenvalue of the scaled rates dr/ds, if only the given ends move.
        r are the residuals, s the outward displacements of the ends. The rates are divided by the
        scales `weight`.
        """
        second = self._second(ends)
        values = (
            np.linalg.eigvals(self._driven(ends)).real
            if second is None
            else np.linalg.eigvalsh(second[0])
        )
        return float(values.max(initial=-1.0))

    def motions(self, ends: Index) -> tuple[Array, Array]:
        """(real parts of the eigenvalues, eigenvectors) of the derivatives dr/ds.
        r are the residuals, s the outward displacements of the given ends. The derivatives are
        divided by the scales `weight`.
        """
        second = self._second(ends)
        if second is None:
            growth, motions = np.linalg.eig(self._driven(ends))
            return growth.real, motions
        growth, motions = np.linalg.eigh(second[0])
        return growth, second[1][:, None] * motions

    def _driven(self, ends: Index) -> Array:
        """Derivatives of the given ends' residuals with respect to displacements of these ends.
        Each row is divided by the end's scale in `weight`.
        """
        return np.asarray(self.rates[np.ix_(ends, ends)] / self.weight[ends, None])

    def _second(self, ends: Index) -> tuple[Array, Array] | None:
        """(symmetric matrix with the eigenvalues of `_driven`, a factor for each end).
        `_driven` is the matrix of scaled rates of the residuals. An eigenvector of the symmetric
        matrix, times the factors, is an eigenvector of `_driven`.

        None if K/K* of an end is not positive, since the energy then does not determine the rates,
        or if the interaction derives from no energy.
        """
        gains = self.gains[ends]
        if gains.min(initial=1.0) <= 0.0:
            return None
        scale = 1.0 / np.sqrt(gains * self.weight[ends])
        matrix = (gains * scale)[:, None] * self.rates[np.ix_(ends, ends)] * scale
        # The matrix of second derivatives of an energy is symmetric, up to the accuracy of the
        # rates. A larger asymmetry means that the interaction derives from no energy.
        if np.abs(matrix - matrix.T).max(initial=0.0) > 10 * ACCURACY.rough:
            return None
        return 0.5 * (matrix + matrix.T), scale

    def damped_step(self, by: Array | float) -> Array:
        """Implicit Euler step of all ends down the slope of the energy.

        by: damping in excess of the largest growth rate, or of 0 if the state is stable.
        """
        damped = np.diag((max(self.growth, 0.0) + by) * self.weight)
        return np.asarray(np.linalg.solve(damped - self.rates, self.residual), dtype=np.float64)

    def refuse_neutral(self) -> None:
        """Raise NotConverged if some displacement of the ends changes no residual.

        Then there is a continuous family of contacts instead of one.
        """
        if abs(self.growth) <= ACCURACY.neutral:
            raise NotConverged(
                "the position of a zone is not determined: the zone can move freely, as on a level "
                "stretch of the profile. Give level stretches a slight curvature"
            )

    @cached_property
    def newton(self) -> Array:
        """Newton step of the ends (2n,), positive outward."""
        return np.asarray(np.linalg.solve(-self.rates, self.residual), dtype=np.float64)

    def moved(self, outward: Array) -> Array:
        """The intervals with their ends moved outward by given lengths (2n,)."""
        left, right = np.split(outward, 2)
        return self.table + np.column_stack((-left, right))


def direct(state: sie.State, equation: sie.Equation, tolerance: float) -> sie.State:
    """The state, solved again by a factored matrix if it was found by iteration.
    The matrix then serves the rates, which need one linear solution for each end.
    """
    if state.iteration is None:
        return state
    return sie.solve_fixed(equation, state.density.zones, tolerance, direct=True)


@dataclass(frozen=True)
class Curve:
    """All states of a problem under one kind of control, such as a load, at any of its values.

    control: the control with the value that the scene asks for.
    """

    problem: Problem
    control: Control

    def at(
        self,
        table: Array,
        value: float,
        tolerance: float = ACCURACY.density,
        pinned: Mask | None = None,
    ) -> State:
        """The state on given zones: the solution of one linear problem, with residuals and rates.
        The rates are derivatives of the residuals of all ends with respect to the ends.

        Zones are cut at sharp corners. pinned: mask of the ends to be pinned; with None, ends at a
        corner are pinned unless they are driven inward.
        """
        table = self.within(table)
        problem, control = self.problem, replace(self.control, value=value)
        lo, hi = problem.borders
        if table[0, 0] <= lo or table[-1, 1] >= hi:
            raise OutOfRange(
                "a contact zone reaches the border of the known part of the profile: give the "
                'profile over a longer interval or, if branch is "receding", use "advancing"'
            )
        zones = sie.Zones.of(table, problem.end, problem.end)
        equation, wanted = problem.equation(control), problem.end.intensity
        assert wanted is not None
        solved, size = sie.solve_zones(equation, zones, tolerance), abs(wanted)
        state = solved.whole
        # A lower accuracy than that of `state` suffices for rates.
        of_rates = ACCURACY.rough if tolerance <= ACCURACY.density else ACCURACY.coarse
        rates, by_value = self._intensity_rates(state, equation, of_rates)
        here = State(
            table,
            value,
            (np.concatenate(state.density.intensities) - wanted) / size,
            rates / size,
            by_value / size,
            state.density.total,
            -value if control.approach is not None else float(state.levels.mean()),
            solved=(solved, tolerance),
        )
        if pinned is None or not np.isfinite(problem.corners).all():
            return here.at_corners(problem.corners)
        return here.with_pinned(pinned)

    def _intensity_rates(
        self, state: sie.State, equation: sie.Equation, tolerance: float
    ) -> tuple[Array, Array]:
        """(d intensity / d end (2n, 2n), d intensity / d control (2n,)) of the edge intensities."""
        state = direct(state, equation, tolerance)
        values = np.zeros(len(state.condition_scale))
        first = state.condition_index[0]
        # `values` is the derivative of the side conditions' right side with respect to the control.
        # A load changes one row, the row of the total load. An approach changes, with a minus sign,
        # the row of every zone.
        by_load = self.control.load is not None
        rows = 1 if by_load else len(state.density.zones)
        values[first : first + rows] = 1.0 if by_load else -1.0
        by_value = np.concatenate(state.response(values).intensities)
        return sie.end_rates(state).intensities, by_value

    def under(self, control: Control) -> "Curve":
        """The curve of the same problem under another control."""
        return Curve(self.problem, control)

    def again(self, here: State, value: float) -> State:
        """The state at a value of this curve's control, on the intervals of the state `here`."""
        return self.at(here.table, value)

    def unit(self, here: State) -> float:
        """Change of the control that changes the residual of the most sensitive end by 1."""
        return 1.0 / float(np.abs(here.whole.by_value).max())

    def vanishes(self, here: State, motion: Array) -> float:
        """Smallest factor on `motion`, a change of ends and control, at which a zone vanishes.
        The zone is a zone of contact inside an interval of tension.

        The factor is infinite here, since the intervals are the zones of contact.
        """
        return np.inf

    @property
    def formally(self) -> "Curve":
        """This curve without tests of the signs of pressure and gap: here the curve itself.

        `CohesiveCurve` tests signs, and overrides this property.
        """
        return self

    def has_right_zones(self, here: State) -> bool:
        """Whether the signs of pressure and gap are right; not tested here, so always True."""
        return True

    def within(self, table: Array) -> Array:
        """The zones cut at sharp corners; ends very near a corner are moved to the corner.

        Zones of a periodic body are first moved to the period between its corners.
        """
        lo, hi = self.problem.corners
        if not np.isfinite([lo, hi]).all():
            return table
        if (period := self.problem.period) is not None:
            table = ascending(centred_on(table, 0.5 * (lo + hi), period))
        table, snap = np.clip(table, lo, hi), 64 * EPS * (hi - lo)
        table[:, 0], table[:, 1] = (
            np.where(table[:, 0] <= lo + snap, lo, table[:, 0]),
            np.where(table[:, 1] >= hi - snap, hi, table[:, 1]),
        )
        return np.asarray(table)

    def to_corners(self, table: Array) -> Array:
        """Distances (2n,) of the outermost ends from the sharp corners; infinite for other ends."""
        away, (lo, hi) = np.full(table.size, np.inf), self.problem.corners
        away[0], away[-1] = table[0, 0] - lo, hi - table[-1, 1]
        return away

    def settled(self, here: State) -> State:
        """The equilibrium near a state, by Newton's method to full accuracy."""
        rough = (
            here.solved is not None
            and here.solved[1] > ACCURACY.density
            and here.growth < -ACCURACY.other_equilibrium
        )
        is_near = (
            rough and float(np.abs(here.newton / here.widths).max()) < ACCURACY.other_equilibrium
        )
        here = self.at(here.moved(here.newton) if is_near else here.table, here.value)
        here.refuse_neutral()
        for _ in range(ACCURACY.max_newton_steps):
            size = float(np.abs(here.newton / here.widths).max())
            if size > ACCURACY.other_equilibrium:
                break
            # If the `size` of this step is below `ACCURACY.neutral`, the step is the last one. The
            # error that remains is then about the square of `size`.
            here = self.at(here.moved(here.newton), here.value)
            if size < ACCURACY.neutral:
                break
        return here

    def fields(self, here: State, tolerance: float = ACCURACY.density) -> ZoneFields:
        """The fields of a state, such as pressure and gap."""
        if here.solved is not None and here.solved[1] <= tolerance:
            return ZoneFields(self.problem, here.solved[0])
        zones = sie.Zones.of(here.table, self.problem.end, self.problem.end)
        return ZoneFields(
            self.problem, sie.solve_zones(self.problem.equation(Load(here.load)), zones, tolerance)
        )

    def gaps(self, table: Array) -> Array:
        """Widths (n,) of the gaps right of the zones; without a period, the last is infinite."""
        return np.asarray(np.diff(gaps_between(table, self.problem.period))[:, 0])

    def room(self, table: Array) -> Array:
        """For each end (2n,), the smaller of the widths of its zone and of the gap next to it."""
        return np.asarray(room_beside(table, self.problem.period).T.ravel())
