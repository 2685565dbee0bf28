"""The two contacts of the first-order closure, and their derivatives.

One contact is that of the strip under a nominal pressure, the other is that of the profile of the
strip alone. The unknowns are the strip's centre, the nominal pressure and the load. A unit change
of an unknown adds a density on the same zones. The motions of the zones' ends follow from this
density.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

import sie
from contact.formulation.fields import by_nominal_pressure, moved_ends, moves_by
from contact.formulation.tables import room_beside
from contact.verify.error import SolvedZones
from sie import Array, Mask, record


@dataclass(frozen=True)
class DerivativeOptions:
    """Options of the derivatives of the two contacts by centre, nominal pressure and load."""

    # Tolerance of the pressures from which a central difference is computed. The difference has the
    # error `tolerance` / (2 `shift`), far below its truncation error `shift`^2.
    tolerance: float = 1e-11
    # Step of the centre in a central difference, divided by the distance from the zones to the
    # border of the strip. For the profile alone, it is divided by the width of an outermost zone or
    # of the gap next to this zone, whichever is less.
    shift: float = 1e-3


OPTIONS = DerivativeOptions()


@record
class TwoContacts:
    """Two contacts that the localized model compares, both with the profile of the strip.
    `strip` has the nominal pressure outside the strip, `reference` has no pressure there.

    unknowns: scaled centre, nominal pressure and load of the strip (3,).
    """

    unknowns: Array
    strip: SolvedZones
    reference: SolvedZones

    @property
    def period(self) -> float:
        """The scaled width of the strip (one period of the profile), which is the period."""
        assert self.strip.fields.problem.period is not None
        return self.strip.fields.problem.period

    @property
    def cut_off(self) -> Mask:
        """Mask (2,): whether zones of `reference` end at the left and right border of the strip."""
        zones = self.reference.free.density.zones
        return np.array([zones.a[0], zones.b[-1]]) == np.array(self.reference.fields.problem.cut)


@record
class ContactRates(sie.Kept):
    """Derivatives of both contacts by the strip's centre, the nominal pressure and the load.
    The contacts are those of `TwoContacts`.

    Derivatives of ends are outward motions (2, Z); those of the approach are numbers.
    """

    at: TwoContacts

    @property
    def _density(self) -> sie.AnyDensity:
        return self.at.strip.fields.state.density

    @cached_property
    def _shifted(self) -> sie.AnyState:
        return _shifted(self.at.strip)

    @cached_property
    def _pressed(self) -> sie.AnyState:
        return by_nominal_pressure(
            self.at.strip.fields.problem, self._density.zones, OPTIONS.tolerance
        )

    @cached_property
    def by_centre(self) -> Array:
        """Derivatives of the strip's zone ends (outward motions) by the position of its centre."""
        return moves_by(self._shifted.density, self._density)

    @cached_property
    def by_pressure(self) -> Array:
        """Derivatives of the strip's zone ends (outward motions) by the nominal pressure."""
        return moves_by(self._pressed.density, self._density)

    @cached_property
    def by_load(self) -> Array:
        """Derivatives of the strip's zone ends (outward motions) by the load of the strip."""
        return moved_ends(self.at.strip.fields.state, 0, tolerance=OPTIONS.tolerance)

    @cached_property
    def approach(self) -> Array:
        """Derivatives (3,) of the approach by the strip's centre, the nominal pressure and the
        load.
        """
        state = self.at.strip.fields.state
        by_load = float(state.level_rates(state.values()).mean())
        return -np.array([self._shifted.levels.mean(), self._pressed.levels.mean(), by_load])

    def of_strip(self, step: Array) -> Array:
        """Outward motions of the strip's zone ends for a step of the three unknowns.
        The unknowns are (centre of the strip, nominal pressure, load).
        """
        return step[0] * self.by_centre + step[1] * self.by_pressure + step[2] * self.by_load

    def of_ends(self, errors: Array) -> Array:
        """Bounds of the errors of the zone ends (Z, 2), relative to the width of the zone.

        errors: those of centre, nominal pressure and load (3,).
        """
        by = np.abs(self.by_centre), np.abs(self.by_pressure), np.abs(self.by_load)
        moved = sum(abs(part) * rate for part, rate in zip(errors, by, strict=True))
        return np.asarray(np.asarray(moved).T / np.diff(table_of(self.at.strip), axis=1))

    @cached_property
    def reference_by_pressure(self) -> Array:
        """Derivatives of the zone ends of the contact without images, by the nominal pressure."""
        return self.at.period * moved_ends(
            self.at.reference.fields.state, 0, tolerance=OPTIONS.tolerance
        )

    @cached_property
    def reference_by_centre(self) -> Array:
        """Derivatives of the zone ends of the contact without images, by the centre of the strip.

        An end at a border of the strip moves with this border, and the other ends react.
        """
        reference, at_border = self.at.reference, self.at.cut_off
        problem, zones = reference.fields.problem, reference.free.density.zones
        moved = np.zeros((2, len(zones)))
        if not at_border.any():
            return moved
        moved[[0, 1], [0, -1]] = at_border * (-1.0, 1.0)
        away, sides = OPTIONS.shift * float(room_beside(zones.table, None)[[0, -1]].min()), []
        for shift in (away, -away):
            equation = problem.about(problem.centre + shift).equation(reference.control)
            density = sie.solve_zones(
                equation, zones.moved(shift * moved), OPTIONS.tolerance
            ).density
            sides.append(moves_by(density, density))
        return np.asarray(moved + (sides[0] - sides[1]) / (2 * away))

    @cached_property
    def matrix(self) -> Array:
        """Jacobian (2, 2): derivatives of two conditions by the strip's centre and the nominal
        pressure. The conditions are: equal widths of the two contacts, and a strip centred on its
        zones.

        The first condition is W = W0: the zones of `at.strip` and of `at.reference` have the same
        total width. The second: the middle of the strip's zones is the centre.
        """
        wider = (
            self.by_centre.sum() - self.reference_by_centre.sum(),
            self.by_pressure.sum() - self.reference_by_pressure.sum(),
        )
        return np.array(
            [wider, (middle_motion(self.by_centre) - 1.0, middle_motion(self.by_pressure))]
        )

    @cached_property
    def following(self) -> Array:
        """Derivatives (3,) of the strip's centre, the nominal pressure and the load, by the load.
        The two conditions of `matrix` stay satisfied as the load changes.
        """
        return np.append(
            -np.linalg.solve(self.matrix, (float(self.by_load.sum()), middle_motion(self.by_load))),
            1.0,
        )


def _shifted(strip: SolvedZones) -> sie.AnyState:
    """Derivative of the strip's pressure by the position of its centre, as a central difference."""
    # The zones are not treated as symmetric. Even if the strip is symmetric, the difference of two
    # right sides that are shifted left and right is not.
    problem, zones = (
        strip.fields.problem,
        replace(strip.fields.state.density.zones, symmetric=False),
    )
    assert problem.period is not None and problem.amplitude is not None
    pressure, ends = problem.amplitude, zones.table[[0, -1], [0, 1]] - problem.centre
    away = OPTIONS.shift * (0.5 * problem.period - float(np.abs(ends).max()))
    ahead, behind = (problem.about(problem.centre + shift).columns[0] for shift in (away, -away))
    assert ahead.primitive is not None and behind.primitive is not None
    factor = 0.5 * pressure / away
    value = _Difference(ahead.value, behind.value, factor)
    forcing = sie.Forcing(
        value,
        _Difference(ahead.primitive, behind.primitive, factor),
        resolution=sie.Resolution(smooth_between=True),
    )
    equation = sie.Equation(problem.kernel, forcing, (sie.Total(0.0), sie.EqualPotential()))
    return sie.solve_zones(equation, zones, OPTIONS.tolerance)


@dataclass(frozen=True)
class _Difference:
    """The function x -> (ahead(x) - behind(x)) * factor."""

    ahead: Callable[[Array], Array]
    behind: Callable[[Array], Array]
    factor: float

    def __call__(self, x: Array) -> Array:
        return (self.ahead(x) - self.behind(x)) * self.factor


def middle_motion(moved: Array) -> float:
    """Motion of the middle between the two outermost ends of the zones.
    `moved` (2, Z) has the outward motions of all ends.
    """
    return 0.5 * float(moved[1, -1] - moved[0, 0])


def spread(table: Array, moved: Array) -> Array:
    """Table of the zones after outward motions (2, Z) of their ends.
    Each motion is limited to half the width of the zone or gap next to the end.
    """
    outward = np.clip(moved.T, -0.5 * np.diff(table), 0.5 * room_beside(table, None))
    return np.asarray(table + outward * [-1, 1])


def width_of(found: SolvedZones) -> float:
    """Total width of the contact zones, in scaled units."""
    zones = found.free.density.zones
    return float((zones.b - zones.a).sum())


def table_of(found: SolvedZones) -> Array:
    """Table (Z, 2) of the scaled left and right ends of the contact zones."""
    return found.free.density.zones.table
