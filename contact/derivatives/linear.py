"""Derivatives of all numbers of a solution along a change of its profile, with their errors.

The error has three parts. The zone ends of the solution have errors: to see their effect, the
derivatives are also computed on two copies of the zones, moved by the stated error. The equation
for the derivative has a stated error of its own. And the numbers of the solution from which the
derivatives are computed have errors.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property

import numpy as np

import sie
from contact.derivatives.direction import Direction
from contact.derivatives.numbers import Numbers, values
from contact.derivatives.places import lowest, peaks
from contact.derivatives.rates import Rate, rate_of, with_moved_zones
from contact.derivatives.stresses import LargestStress
from contact.errors import SceneError
from contact.formulation.fields import ZoneFields
from contact.formulation.gaps import GapFields
from contact.formulation.protocol import Fields
from contact.formulation.tolerances import TOLERANCES
from contact.model.controls import Quantity
from contact.model.controls.base import Held
from contact.model.profiles.base import Profile
from contact.solution.solution import Solution
from sie import Array, record


@record
class Change:
    """Derivatives of the results of a solution by one parameter, with their errors.
    The derivative of the pressure is a function of x.

    values: derivatives of the numbers. errors: errors of these derivatives. pressure: derivative of
    the pressure at fixed x.
    """

    values: Numbers
    errors: Numbers
    pressure: Callable[[Array], Array]

    def plus(self, other: Change, factor: float) -> Change:
        """Sum of this derivative and `factor` times another one."""
        first, second = self.pressure, other.pressure
        return Change(
            self.values + other.values * factor,
            self.errors + other.errors * abs(factor),
            lambda x: first(x) + factor * second(x),
        )

    def times(self, factor: float) -> Change:
        """This change times `factor`: the derivative by the parameter divided by `factor`."""
        first = self.pressure
        return Change(self.values * factor, self.errors * abs(factor), lambda x: factor * first(x))


class Linearized(sie.Kept):
    """The linear equations for the derivatives of one contact solution by its parameters."""

    def __init__(
        self,
        solution: Solution,
        stated: bool = True,
        stress: LargestStress | None = None,
        tops: Array | None = None,
    ) -> None:
        """stated: whether errors are asked for, which take two more solves.

        stress: the largest stress of the solution, if derivatives of it are asked for.
        tops: places [m] of local maxima of the pressure, used instead of those of the largest
        pressure.
        """
        self.solution, self.stated, self.stress, self.tops = solution, stated, stress, tops

    @cached_property
    def peaks(self) -> Array:
        """Places of the largest pressure [m], or the given local maxima."""
        return peaks(self.solution) if self.tops is None else self.tops

    @cached_property
    def tips(self) -> Array:
        """Places x [m] at which the height of the profile is lowest."""
        return lowest(self.solution)

    @cached_property
    def values(self) -> Numbers:
        """The results of the solution whose derivatives are computed, such as approach and load."""
        stress = np.zeros(0) if self.stress is None else self.stress.values
        found = values(self.solution, len(self.peaks), len(self.tips), stress)
        if self.tops is None:
            return found
        return replace(found, max_pressure=np.asarray(self.solution.pressure(self.tops)))

    @cached_property
    def variants(self) -> tuple[Fields, ...]:
        """Fields of the solution, and two copies with zone ends moved by the stated error.
        Their derivatives show how sensitive the results are to errors of the ends.
        """
        fields, error = self.solution.fields, self.solution.error
        if not isinstance(fields, (ZoneFields, GapFields)) or not self.stated:
            return (fields,)
        table = fields.zone_table
        n = len(table)
        if isinstance(fields, GapFields):
            of = fields.solved_zones.table * fields.problem.units.length
            narrow = float(np.diff(of, axis=1).min())
        else:
            narrow = float((table[1:, 0] - table[:-1, 1]).min(initial=np.inf))
        width = np.minimum(error * np.diff(table, axis=1), sie.NewtonOptions().max_shrink * narrow)
        signs = np.where(np.arange(2 * n).reshape(n, 2) % 3 < 2, 1.0, -1.0)
        return (
            fields,
            with_moved_zones(fields, width * np.ones(2)),
            with_moved_zones(fields, width * signs * [1.0, -1.0]),
        )

    @property
    def held(self) -> Held:
        """The quantity that the solver prescribes directly, and its value."""
        held = self.solution.scene.control_object.held(self.solution.scene)
        assert held is not None
        return held

    def controlled(self, change: Change) -> tuple[float, float]:
        """(derivative, error) of the prescribed quantity, from the derivatives of all numbers."""
        values, errors, quantity = change.values, change.errors, self.held.quantity
        if quantity is Quantity.LOAD:
            return values.load, errors.load
        if quantity is Quantity.APPROACH:
            return float(values.largest("approach")), float(errors.largest("approach"))
        part = 0.5 if quantity is Quantity.HALF_WIDTH else 1.0
        return part * float(np.diff(values.zones).sum()), part * float(errors.zones.sum())

    def at_control(self, change: Change, target: float) -> Change:
        """Derivatives at a fixed value of the control, from those at a fixed load (`change`).

        target: derivative, by the parameter, of the value [SI] that the control prescribes.
        """
        if self.held.quantity is Quantity.LOAD and target == 0.0:
            return change
        of_change, change_error = self.controlled(change)
        of_load, load_error = self.controlled(self.by_load)
        if not np.isfinite(of_load) or of_load == 0.0:
            raise SceneError(
                "the derivative of the controlled quantity by the load is zero or infinite here, "
                "so there are no derivatives at a fixed value of the control: give the load "
                "instead",
                "control",
            )
        load = (target - of_change) / of_load
        error = (change_error + abs(load) * load_error) / abs(of_load)
        found = change.plus(self.by_load, load)
        return replace(found, errors=found.errors + abs(self.by_load.values) * error)

    @cached_property
    def by_load(self) -> Change:
        """The derivative of the results by the load [N/m]."""
        return self.along(Direction.none(self.solution.scene.profile), 1.0)

    @cached_property
    def by_moment(self) -> Change:
        """The derivative of the results by the given moment [N], at a fixed load."""
        return self.along(Direction.none(self.solution.scene.profile), 0.0, 1.0)

    def along(self, direction: Profile, load: float = 0.0, moment: float = 0.0) -> Change:
        """The derivative of the results as the profile changes along `direction`.
        `load` and `moment` are the rates at which load and moment change with it.
        """
        found = [self._numbers(one, direction, load, moment) for one in self.variants]
        numbers, rate = found[0]
        errors = self._noise(rate, numbers)
        for other, _ in found[1:]:
            errors = errors + abs(other - numbers) * TOLERANCES.margin
        return Change(numbers, errors, rate.pressure)

    def _numbers(
        self, fields: Fields, direction: Profile, load: float, moment: float
    ) -> tuple[Numbers, Rate]:
        rate = rate_of(fields, direction, load, moment)
        order = self.solution._order
        ends = rate.ends[order] * [-1.0, 1.0]
        period = self.solution.scene.period
        fraction = np.nan
        if period is not None:
            fraction = float(rate.ends.sum()) / period
        sunk = np.asarray(direction.height(self.tips), dtype=float)
        numbers = Numbers(
            rate.load,
            rate.approach - sunk,
            rate.mean_gap,
            fraction,
            rate.pressure(self.peaks),
            self._stiffness(fields, rate),
            ends,
            rate.loads[order],
            np.zeros(0) if self.stress is None else self.stress.rates(fields, rate),
        )
        return numbers, rate

    def _stiffness(self, fields: Fields, rate: Rate) -> float:
        """Derivative of the stiffness S.
        If an end moves outward, the compliance 1/S falls at the rate 2 pi k^2/E*.

        k is the intensity of the derivative of p by the load. By reciprocity the compliance falls
        at the rate at which a crack releases energy (G. R. Irwin, J. Appl. Mech. 24, 1957, 361).
        """
        stiffness, problem = self.solution.stiffness, fields.problem
        follows = isinstance(fields, ZoneFields) and fields.solved_zones.follow_ends
        if stiffness is None or not np.isfinite(stiffness) or problem.kappa or follows:
            return np.nan
        k = self._intensities(fields)
        softer = float(np.sum(2 * np.pi / problem.units.E_star * k**2 * rate.ends))
        return stiffness**2 * softer

    def _intensities(self, fields: Fields) -> Array:
        """Intensities (n, 2) of the derivative of the pressure by the load, at the ends of n zones.
        An intensity is the factor of the inverse square root of the distance from the end.
        """
        known: dict[int, Array] = self.__dict__.setdefault("_by_load", {})
        if id(fields) not in known:
            none = Direction.none(self.solution.scene.profile)
            known[id(fields)] = rate_of(fields, none, 1.0).intensities
        return known[id(fields)]

    def _noise(self, rate: Rate, numbers: Numbers) -> Numbers:
        """Errors of the derivatives, apart from the effect of errors of the zone ends.
        They are due to the equation for the derivatives, and to relative errors of the results.
        """
        fields = self.solution.fields
        units, relative = fields.problem.units, self.solution.error
        noise, errors = rate.noise, abs(numbers) * (2 * relative)
        if self.stress is not None:
            relative_error = 2 * (relative + self.stress.yield_error)
            errors = replace(errors, max_stress=np.abs(numbers.max_stress) * relative_error)
        period = self.solution.scene.period
        if not isinstance(fields, (ZoneFields, GapFields)):
            size = noise * units.pressure
            length = period or units.length
            none = Numbers(
                0.0,
                errors.approach * 0 + noise * units.slope * length,
                0.0,
                0.0,
                errors.max_pressure * 0 + size,
                0.0,
                numbers.zones,
                numbers.zone_loads,
                errors.max_stress * 0 + size,
            )
            return errors + none
        solved = fields.solved_zones
        density = fields.density if isinstance(fields, ZoneFields) else fields.gap_slope
        root = np.sqrt(solved.half / 2)
        with np.errstate(divide="ignore", invalid="ignore"):
            steps = np.abs(solved.weight.end_step(1.0, np.array(density.edge_slopes)))
            moved = np.where(solved.moves, steps, 0.0) * root * noise * units.length
        ends = float(moved.max(initial=0.0))
        load = np.pi * float(solved.half.sum()) * noise * units.load
        span = float(solved.half.sum()) * noise * units.height
        widths = self.solution.zones[:, 1:] - self.solution.zones[:, :1]
        more = Numbers(
            0.0 if numbers.load in (0.0, 1.0) else load,
            np.full(numbers.approach.shape, 4 * span),
            4 * span,
            2 * float(moved.sum()) / period if period else np.nan,
            np.full(numbers.max_pressure.shape, 8 * noise * units.pressure),
            abs(numbers.stiffness) * noise,
            np.full(numbers.zones.shape, ends),
            np.full(numbers.zone_loads.shape, load) + 0 * widths[:, 0],
            np.full(numbers.max_stress.shape, 8 * noise * units.pressure),
        )
        return errors + more
