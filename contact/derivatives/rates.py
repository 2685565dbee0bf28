r"""The derivative of a contact by a change of its profile or load, which is again a contact field.

Let p be the pressure, f the profile, and s a parameter. At first order the zones stay: p vanishes
at free ends, so that a moved end adds nothing to an integral. On the zones the derivative p' causes
the displacement delta' - f', with the approach delta; outside the zones p' is zero. So p' solves
the equation of p with f' in place of f on the same zones, with the load P'. At a distance d from a
free end p ~ A d^(1/2), but p' ~ k d^(-1/2) is singular: the end moves outward at the rate 2 k / A.
If the gaps are the unknowns, the same holds for the slope of the gap. In full contact
p' = pbar' - (E*/2) R', with the mean pressure pbar and the relief R' of f'.

With edge intensities that a law prescribes, p' also has terms d^(-3/2) that keep these intensities
(`sie.Solution.derivative`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property

import numpy as np

import sie
from contact.errors import SceneError
from contact.formulation.controls import Load
from contact.formulation.fields import ZoneFields, mean_shape, moves_by
from contact.formulation.full_contact import FullFields, FullLimit
from contact.formulation.gaps import GapFields
from contact.formulation.problem import Problem
from contact.formulation.protocol import Fields
from contact.formulation.relief import ScaledRelief
from contact.formulation.tolerances import TOLERANCES
from contact.model.profiles.base import Profile
from contact.search.topology.gap_form import GapForm
from sie import Array, record


@record
class Rate:
    """Derivatives of the fields of a contact, in SI units, by one parameter.
    The load is fixed or grows with the parameter.

    load: derivative of the load. approach: derivative of the approach, counted from f = 0 and not
    from the lowest place; nan if it has no datum. ends: outward motions of the zones' ends (n, 2).
    loads: derivatives of the zones' loads (n,). intensities: k of p' at the ends (n, 2). All three
    are in the order of the fields' zones. pressure: p' at places x. noise: error of the
    coefficients of p', divided by the unit of pressure. fields: those of p', from which stresses
    follow; None if the stresses are infinite at ends.
    """

    load: float
    approach: float
    mean_gap: float
    ends: Array
    loads: Array
    intensities: Array
    pressure: Callable[[Array], Array]
    noise: float
    fields: Fields | None


@record
class LoadRates:
    """Derivatives of the load and the moment by the parameter, in scaled units."""

    load: float = 0.0
    moment: float = 0.0


def changed(problem: Problem, direction: Profile, moment: float) -> Problem:
    """The problem for a derivative, whose profile is the change `direction` of the profile."""
    given = None if problem.moment is None else moment
    return replace(problem, profile=direction, lowest=0.0, moment=given)


def held(zones: sie.Zones) -> sie.Zones:
    """The same zones with fixed ends, at which the pressure may be singular."""
    kinds = (sie.SINGULAR,) * len(zones)
    return replace(zones, left=kinds, right=kinds, symmetric=False)


def rate_of(fields: Fields, direction: Profile, load: float, moment: float = 0.0) -> Rate:
    """The derivative of a contact as its profile changes along `direction`.
    Meanwhile the load grows at the rate `load`, and the moment at the rate `moment`.

    load: [N/m] per unit of the parameter. moment: [N] likewise, if the moment is given.
    """
    units = fields.problem.units
    load_rates = LoadRates(load / units.load, moment / units.moment)
    try:
        if isinstance(fields, ZoneFields):
            of = _of_intensities if fields.solved_zones.follow_ends else _of_zones
            return of(fields, direction, load_rates)
        if isinstance(fields, GapFields):
            return _of_gaps(fields, direction, load_rates)
    except (ValueError, sie.SingularSystem) as error:
        raise SceneError(f"a derivative could not be computed: {error}", "change") from error
    if isinstance(fields, FullFields):
        return _of_full(fields, direction, load)
    raise SceneError(
        "derivatives are available only for a contact with zones or in full contact, not for this "
        f"solution ({type(fields).__name__})",
        "solution",
    )


@record
class RateFields(ZoneFields):
    """The derivatives of the fields of a contact by one parameter.
    A member such as `pressure` is the derivative of the contact's pressure.
    """

    @cached_property
    def levels(self) -> Array:
        # The derivatives of the levels follow from the displacement at the middles of the zones. At
        # an end the derivative of the pressure is singular, and its displacement is as steep as a
        # square root. There a rounded position would cost half of the digits.
        middle = self.density.zones.middle
        return -(self._relative_displacement(middle) + self.standing_shape(middle))


def _of_zones(fields: ZoneFields, direction: Profile, load_rates: LoadRates) -> Rate:
    problem = changed(fields.problem, direction, load_rates.moment)
    zones = held(fields.solved_zones)
    state = sie.solve_zones(problem.equation(Load(load_rates.load)), zones, TOLERANCES.rounding)
    rate, units = RateFields(problem, state), problem.units
    k = np.array(state.density.intensities)
    return Rate(
        rate.load,
        np.nan if rate.approach is None else rate.approach,
        rate.mean_gap if _fills_period(problem) else np.nan,
        moves_by(state.density, fields.density).T * units.length,
        rate.loads,
        np.where(fields.solved_zones.moves, k, 0.0).T * units.intensity,
        rate.pressure,
        state.density_error * state.size + TOLERANCES.rounding * state.size,
        rate,
    )


def _fills_period(problem: Problem) -> bool:
    """Whether a mean gap over the period is defined and finite."""
    return problem.period is not None and problem.corners == (-np.inf, np.inf)


def _of_intensities(fields: ZoneFields, direction: Profile, load_rates: LoadRates) -> Rate:
    problem = changed(fields.problem, direction, load_rates.moment)
    zones = replace(fields.solved_zones, symmetric=False)
    equation = fields.problem.equation(Load(fields.density.total))
    state = sie.solve_zones(equation, zones, TOLERANCES.rounding)
    none = np.zeros(len(zones))
    found = sie.Solution(state.density, zones, state.density_error, errors=none, state=state)
    rate = found.derivative(problem.forcing, values=[load_rates.load, 0.0])
    density, units = rate.density, problem.units
    middle = zones.middle[:1]
    level = float((density.potential(middle) - problem.shape(middle))[0])
    has_approach = problem.operator.has_approach
    gap = np.nan
    if _fills_period(problem):
        sunk = problem.compression * density.total / problem.repeat_length
        gap = (mean_shape(problem) + sunk + level) * units.height

    def pressure(x: Array) -> Array:
        scaled = fields._scaled(x)
        return np.where(fields.inside(scaled), density(scaled), 0.0) * units.pressure

    smooth = density.smooth if isinstance(density, sie.MovedDensity) else density
    size = float(np.abs(smooth(zones.middle)).max()) + abs(density.total)
    return Rate(
        density.total * units.load,
        -level * units.height if has_approach else np.nan,
        gap,
        rate.ends * [-1.0, 1.0] * units.length,
        np.asarray(density.totals) * units.load,
        np.full((len(zones), 2), np.nan),
        pressure,
        (state.density_error + TOLERANCES.rounding) * max(size, state.size),
        None,
    )


def _of_gaps(fields: GapFields, direction: Profile, load_rates: LoadRates) -> Rate:
    problem = changed(fields.problem, direction, load_rates.moment)
    units, law = problem.units, problem.law
    relief = FullLimit(direction, units.E_star, problem.operator, law).relief
    form = GapForm(problem, ScaledRelief.of(relief, problem))
    equation = form.equation(Load(load_rates.load))
    state = sie.solve_zones(equation, held(fields.solved_zones), TOLERANCES.rounding)
    mean = load_rates.load / problem.repeat_length
    rate = GapFields(problem, state, mean, form.relief)
    outward = moves_by(state.density, fields.gap_slope)
    k = np.array(state.density.intensities)
    return Rate(
        rate.load,
        rate.approach,
        rate.mean_gap,
        -_by_zones(outward) * units.length,
        rate.loads,
        _by_zones(k) * units.intensity,
        rate.pressure,
        state.density_error * state.size + TOLERANCES.rounding * state.size + form.relief.error,
        rate,
    )


def _by_zones(of_gaps: Array) -> Array:
    """Table (n, 2) of values at the ends of zones, from values (2, n) at the ends of the gaps."""
    return np.column_stack((of_gaps[1], np.roll(of_gaps[0], -1)))


def _of_full(fields: FullFields, direction: Profile, load: float) -> Rate:
    problem = changed(fields.problem, direction, 0.0)
    units, period = problem.units, problem.profile.period
    assert period is not None
    relief = FullLimit(direction, units.E_star, problem.operator, problem.law).relief
    mean = mean_shape(problem) * units.height
    rate = FullFields(problem, load / period, relief, mean)
    none = np.zeros((0, 2))
    noise = relief.error / units.slope
    return Rate(load, rate.approach, 0.0, none, np.zeros(0), none, rate.pressure, noise, rate)


def with_moved_zones(fields: Fields, outward: Array) -> Fields:
    """The fields of the same contact on zones whose ends are moved.
    `outward` (n, 2) [m] has the outward motions.

    The pressure then need not vanish at the ends. Its change shows the effect of errors of the
    ends.
    """
    if isinstance(fields, ZoneFields):
        zones = fields.solved_zones
        moved = zones.moved(np.where(zones.moves, outward.T / fields.problem.units.length, 0.0))
        moved = replace(moved, symmetric=False)
        state = sie.solve_zones(
            fields.problem.equation(Load(fields.density.total)), moved, TOLERANCES.rounding
        )
        return ZoneFields(fields.problem, state)
    if isinstance(fields, GapFields):
        gaps, form = fields.solved_zones, GapForm(fields.problem, fields.relief)
        inward = -outward.T / fields.problem.units.length
        moved = gaps.moved(np.array([np.roll(inward[1], 1), inward[0]]))
        equation = form.equation(Load(fields.mean * fields.period))
        state = sie.solve_zones(equation, moved, TOLERANCES.rounding)
        return GapFields(fields.problem, state, fields.mean, fields.relief)
    return fields
