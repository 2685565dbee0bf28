"""The formulation by gaps: the gap is positive inside gaps, the pressure is positive outside."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

import sie
from contact.extras import require
from contact.formulation.controls import Control, Load
from contact.formulation.fields import mean_shape
from contact.formulation.gaps import GapFields
from contact.formulation.problem import MISMATCH, Problem, minus_one
from contact.formulation.relief import ScaledRelief, height_noise
from contact.formulation.tolerances import TOLERANCES
from contact.search.topology.failure import WrongTopology
from contact.search.topology.intervals import united, without
from contact.search.topology.loop import NewtonSettings, Round
from contact.verify.certificate import Certificate, Solved
from contact.verify.error import SolvedGaps
from contact.verify.gap_certificate import certify_gaps
from sie import Array, record


@record
class GapForm:
    """A scaled contact problem with the slope of the gap as the unknown function.

    relief: minus the pressure of full contact, without its mean. most_steps: limit of Newton steps;
    if so few do not suffice, the contact is better solved by its zones.
    """

    problem: Problem
    relief: ScaledRelief
    what: str = "gap"
    most_steps: int = 25

    def equation(self, control: Control) -> sie.Equation:
        """The integral equation for the slope of the gap.

        The mean pressure is the unknown amplitude of a constant term. If it were subtracted from
        the right side instead, most digits would cancel.
        """
        problem, slope = self.problem, self.problem.forcing
        right = sie.Forcing(
            self.relief.forcing, jumps=replace(slope.jumps, of_density=True, spline=slope.value)
        )
        conditions, ends = control.gap_conditions(
            self.problem.repeat_length, partial(mean_shape, problem), problem.compression
        )
        if problem.kappa:
            equation: sie.Equation = require(MISMATCH).gap_equation(
                problem, self.relief, conditions, ends
            )
            return equation
        return sie.Equation(
            problem.inverse_kernel,
            right,
            conditions,
            (sie.Forcing(minus_one, resolution=sie.Resolution(modes=1)),),
            ends,
        )

    def intervals(self, control: Control, table: Array) -> sie.Zones:
        """The gaps `table` as intervals with free ends, which Newton's method moves."""
        if len(table) == 0:
            raise WrongTopology(
                "no gap is left: within rounding, such narrow gaps do not differ from full contact",
                None,
            )
        return sie.Zones.of(table)

    def moved(self, control: Control, zones: sie.Zones, newton: NewtonSettings) -> sie.Free:
        """The gaps, with their ends found by Newton's method."""
        newton = replace(newton, modes_like=None)
        return newton.ends(self.equation(control), zones, self.most_steps, signs=(1.0, -1.0))

    def formal(
        self, load: float, table: Array, tolerance: float, decay: float | None = None
    ) -> GapFields:
        """Pressure and gap under a load, with as many gaps as `table` has; no signs are checked.

        decay: see `sie.NewtonOptions`.
        """
        equation = self.equation(Load(load))
        free = sie.find_ends(
            equation,
            sie.Zones.of(table),
            tolerance,
            sie.NewtonOptions(
                max_steps=self.most_steps, signs=(1.0, -1.0), decay=decay, bounded_ends=False
            ),
        )
        if not free.converged:
            raise WrongTopology("the ends of the gaps did not settle", free)
        return GapFields(self.problem, free.state, load / self.problem.repeat_length, self.relief)

    def refuse(self, table: Array, free: sie.Free) -> None:
        """Accept every result. Round-off may lose a very narrow gap between zones, but not here:
        the width of each gap is an unknown of its own, which keeps all its digits.
        """

    def fields(self, control: Control, free: sie.Free, tolerance: float) -> GapFields:
        """Pressure and gap (fields) under the mean pressure that was found with the gaps."""
        state, mean = free.state, float(free.density.amplitudes[0])
        if control.load is None:
            equation = self.equation(Load(mean * self.problem.repeat_length))
            # `solve_zones` may treat a narrow interval as a slit of a wider zone; `solve_fixed`
            # never does. Equations with kappa never have slits.
            solve = sie.solve_zones if self.problem.kappa else sie.solve_fixed
            zones = free.density.zones
            state = solve(equation, zones, max(0.1 * tolerance, 3e-16)).with_bounded_ends()
        return GapFields(self.problem, state, mean, self.relief)

    def certificate(self, fields: GapFields, control: Control, few: float = 0.0) -> Certificate:
        """The check of the signs of pressure and gap on the whole period."""
        return certify_gaps(fields)

    def corrected(self, zones: sie.Zones, certificate: Certificate) -> Array:
        """The gaps, cut where the bodies overlap, and new gaps where the pressure is negative."""
        parts = np.concatenate((without(zones.table, certificate.overlaps), certificate.negative))
        return united(parts, self.problem.repeat_length, True, self.what)

    def solved(self, round: Round[SolvedGaps]) -> SolvedGaps:
        """The solution made from the last round of Newton's method and of the check of signs."""
        free, fields, control = round.free, round.fields, round.control
        return SolvedGaps(
            free,
            fields,
            round.certificate,
            round.number,
            control,
            round.tolerance,
            free.value_error + _rounding_of_mean(control, fields),
        )

    def is_slight(self, found: Solved) -> bool:
        """Whether the smallest minimum of the pressure in contact may be zero within its error."""
        return found.certificate.dip <= TOLERANCES.margin * found.tolerance


def _rounding_of_mean(control: Control, fields: GapFields) -> float:
    """Rounding error of the mean pressure if the approach is given, else 0.

    The approach is a difference of numbers as large as the profile's heights, and hardly changes
    near full contact.
    """
    if control.approach is None:
        return 0.0
    units = fields.problem.units
    rate = fields.stiffness / fields.period * units.height / units.load
    of_heights = height_noise(fields.problem.profile) / units.height
    return (
        6e-16 * (abs(fields.mean) + abs(rate) * max(control.approach, mean_shape(fields.problem)))
        + abs(rate) * of_heights
    )
