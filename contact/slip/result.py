"""`Slip`: shear, zones that stick and zones that slip, under a load and a tangential load."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import sie
from contact.extras import require
from contact.formulation.protocol import Fields
from contact.inside.field import body_points, error_at, needs_half_plane, unit_pressure
from contact.inside.stress import Stress, stress_from, tension_along
from contact.model.checks import real
from contact.model.units import counted, quantity
from contact.slip.memory import SlipStep
from contact.slip.work import OF_DISPLACEMENT, LoadPoint, displacement_unit, dissipated_energy
from contact.solution.solution import Solution
from sie import Array

_FIGURES = "contact.slip.plotting"
_FILES = "contact.slip.export"
_REPORT = "contact.slip.report"
# Error of the stresses due to a shear, divided by the result of `error_at` for this shear. It is 2,
# because s_xx contains 2 Re H, with H the transform of the shear.
_ERROR_BY_SHEAR = 2.0


@dataclass(frozen=True, eq=False)
class Term(sie.Kept):
    """One term of the shear, which is a sum of pressures times factors.

    Parameters
    ----------
    weight : float
        The factor [1].
    fields : Fields
        The fields of the pressure.
    error : float
        Stated error of the pressure and of its ends (`Solution.error`).
    """

    weight: float
    fields: Fields
    error: float


@dataclass(frozen=True, eq=False)
class Slip(sie.Kept):
    """Shear, stick and slip of a contact with friction, in SI units.

    The shear q is the traction on body 1 along +x. It is a sum of pressures of contacts without
    friction, with the factors of `terms`.

    Parameters
    ----------
    solution : Solution
        The contact under the present load.
    friction : float
        Coefficient of friction [1].
    tangential_load : float
        Q = int q dx [N/m], per period if the scene is periodic.
    stick_zones : ndarray
        Intervals that stick [m], (m, 2), ascending; with a period, left ends in [x0, x0 + L). In
        full contact that sticks everywhere, one period.
    slip_zones : ndarray
        Intervals of the contact that slip [m], (k, 2), in the same form.
    shift : float or None
        Tangential displacement of body 2 along +x against body 1, far from the contact [m]. It is
        measured at the same place as the approach; None without an approach, and in rolling. Its
        error is at most `shift_error`.
    error : float
        Stated bound of two relative errors. (i) The sum, over `terms`, of the error of each
        pressure times its factor, divided by friction times the largest pressure (or times the mean
        contact pressure if the peak is infinite). Pressures are compared at equal normalised
        positions in corresponding zones. (ii) The error of each end of a zone that sticks, divided
        by the width of the zone of contact around it.
    terms : tuple of Term
        The pressures of which q is the sum.
    model : str
        "partial slip" or "rolling".
    bulk_stress : float
        Tension along x in body 1 [Pa], added to its stresses.
    creepage : float or None
        Velocity of body 2 against body 1 along +x, divided by the speed of rolling; None without
        rolling, and where everything slides under a given tangential load.
    steps : tuple
        The steps of slip on the way to this state.
    contacts : mapping
        The solutions under the loads in `steps`, and those whose pressures are in `terms`.

    Examples
    --------
    A cylinder under a tangential load of 3/4 of that at which it slides: the half of its contact
    sticks (R. D. Mindlin, J. Appl. Mech. 16, 1949, 259-268).

    >>> import contact
    >>> scene = contact.Scene(contact.Parabola(1.0), 2.0, contact.Isolated(), half_width=1.0)
    >>> slip = contact.partial_slip(contact.solve(scene), 0.5, 0.75 * 0.5 * 3.141592653589793 / 2)
    >>> slip.stick_zones.round(9).tolist()
    [[-0.5, 0.5]]
    >>> float(slip.shear(0.0).round(9))
    0.25
    """

    solution: Solution
    friction: float
    tangential_load: float
    stick_zones: Array
    slip_zones: Array
    shift: float | None
    error: float
    terms: tuple[Term, ...] = field(repr=False)
    model: str = "partial slip"
    bulk_stress: float = 0.0
    creepage: float | None = None
    steps: tuple[SlipStep, ...] = field(default=(), repr=False)
    contacts: Mapping[float, Solution] = field(default_factory=dict, repr=False)

    def shear(self, x: ArrayLike) -> Array:
        """Traction on body 1 along +x [Pa] at x [m], any array shape; 0 outside the contact."""
        x = real("x", x)
        with np.errstate(invalid="ignore"):
            out = self._summed(x)
        corner = np.isnan(out)
        if corner.any():
            # At a sharp corner, the sum of infinite terms of opposite signs is nan. The shear there
            # is infinite, with the sign of the sum next to the corner inside the zone. On the other
            # side of the corner the sum is 0.
            away = 1e-9 * float(self.solution.zone_widths.min())
            beside = self._summed(x[corner] - away) + self._summed(x[corner] + away)
            out[corner] = np.copysign(np.inf, beside)
        return out

    def _summed(self, x: Array) -> Array:
        """Sum of the terms of the shear at x."""
        out = np.zeros(x.shape)
        for term in self.terms:
            out = out + term.weight * term.fields.pressure(x)
        return np.asarray(out)

    @property
    def slides(self) -> bool:
        """Whether all of the contact slides: no zone sticks.
        The tangential load is `friction` times the load in size.
        """
        return len(self.stick_zones) == 0

    @cached_property
    def shift_error(self) -> float | None:
        """Stated bound of the error of `shift` [m].

        It is 3 e p w / E* plus the round-off of the approaches. Here e is `error` times the
        friction, and p the largest pressure. The width w is the period or, without a period, the
        width from the first to the last zone. The value is None if `shift` is None.
        """
        if self.shift is None:
            return None
        moved = OF_DISPLACEMENT * self.error * self.friction * displacement_unit(self.solution)
        contacts = (self.solution, *self.contacts.values())
        rounding = max(one.certificate.gap_rounding for one in contacts)
        return moved + rounding * sum(abs(term.weight) for term in self.terms)

    @property
    def dissipated(self) -> float | None:
        """Energy that slip has dissipated since the previous state [J/m], per period if any.

        The previous state is the end of the previous segment in a history, and the contact without
        shear for `contact.partial_slip`. The value is None in rolling, and under a bulk stress. Its
        error is at most `dissipated_error`.
        """
        # Round-off may make the sum of the energies negative.
        return None if self._lost is None else max(0.0, self._lost[0])

    @property
    def dissipated_error(self) -> float | None:
        """Stated bound of the error of `dissipated` [J/m].

        It is the sum, over `steps`, of products of a load and the error of an approach. This error
        is at most 3 e p w / E* plus the round-off of heights, with the stated error e and the
        largest pressure p. The width w is the period or, without a period, the width from the first
        to the last zone. In some steps the load changes far more, or far less, than the load whose
        zones stick. There the energy is a small difference of large terms, and its relative error
        may be larger.
        """
        return None if self._lost is None else self._lost[1]

    @cached_property
    def _lost(self) -> tuple[float, float] | None:
        """The energy that slip has lost in `steps`, and the bound of its error [J/m]."""
        if self.model == "rolling" or self.bulk_stress:
            return None
        needed = {load for step in self.steps for load in (*step.stick, *step.load)} - {0.0}
        points = {load: LoadPoint.of(self.contacts[load]) for load in needed}
        points[0.0] = LoadPoint.unloaded(self.solution)
        lost_in_steps = np.array(
            [dissipated_energy(step, self.friction, points) for step in self.steps]
        )
        energy, error = lost_in_steps.reshape(-1, 2).sum(axis=0).tolist()
        # If the load is computed from another control, the loads have errors like the approaches.
        return energy, error * _by_control(self.solution)

    # On the surface, at the ends of zones, the transforms are infinite or nan.
    @np.errstate(divide="ignore", invalid="ignore")
    def stress(
        self, x: ArrayLike, y: ArrayLike, lateral: str = "as loaded", nu: float | None = None
    ) -> Stress:
        """Plane stresses [Pa] in body 1 at points (x, y) [m], y >= 0 into the body.

        The pressure, the shear and the bulk stress cause them. For the parameters and the result
        see `Solution.stress`.

        Raises
        ------
        SceneError
            If y < 0 or `lateral` is unknown.
        """
        fields = self.solution.fields
        needs_half_plane(fields.problem.operator)
        x, y = body_points(x, y)
        along = tension_along(lateral, fields.deep_pressure, nu) + self.bulk_stress
        normal = fields.pressure_transform(x, y)
        error = error_at(fields, x, y, normal, self.solution.error)
        tangential = np.zeros(x.shape, dtype=complex), np.zeros(x.shape, dtype=complex)
        for term in self.terms:
            one = term.fields.pressure_transform(x, y)
            tangential = tangential[0] + term.weight * one[0], tangential[1] + term.weight * one[1]
            own = error_at(term.fields, x, y, one, term.error)
            error = error + _ERROR_BY_SHEAR * abs(term.weight) * own
        return stress_from(y, normal, tangential, error).with_tension(along)

    @property
    def summary(self) -> str:
        """One line of text: the loads, the zones that stick, and the stated error."""
        width = float(np.diff(self.stick_zones).sum())
        zones = len(self.stick_zones)
        what = (
            "slides everywhere"
            if self.slides
            else f"{counted(zones, 'zone')} of {quantity(width, 'm')} stick"
        )
        load, shear = (quantity(v, "N/m") for v in (self.solution.load, self.tangential_load))
        loads = f"P = {load}, Q = {shear}"
        return f"{self.model}, friction {self.friction:g}, {loads}: {what}; error {self.error:.1e}"

    def plot(self) -> Any:
        """A matplotlib figure of shear, friction times pressure, and the zones that stick."""
        return require(_FIGURES).plot(self)

    def __str__(self) -> str:
        """A text table of the numbers with units and errors, and of stick and slip zones."""
        text: str = require(_REPORT).report(self)
        return text

    def _repr_html_(self) -> str:
        return str(require(_FIGURES).to_html(self))

    def zone_table(self) -> Any:
        """One row for each interval that sticks or slips: ends and width [m], and "stick" or
        "slip".

        Returns
        -------
        pandas.DataFrame
            With the units of the columns in `attrs["units"]`.

        Raises
        ------
        MissingExtra
            Without pandas, which the extra `io` installs.
        """
        return require(_FILES).zone_frame(self)

    def to_dict(self) -> dict[str, Any]:
        """The slip and its solution as a dictionary of plain types; None for undefined values."""
        found: dict[str, Any] = require(_FILES).to_dict(self)
        return found

    def to_dataset(self) -> Any:
        """An xarray.Dataset of the solution with shear and intervals; needs xarray."""
        return require(_FILES).to_xarray(self)

    def save(self, path: str | PathLike[str], overwrite: bool = False) -> None:
        """Write intervals, numbers and scene as JSON (.json), or with the fields as netCDF (.nc).

        Raises
        ------
        SceneError
            If the name ends otherwise, or the file is there and `overwrite` is not given.
        """
        require(_FILES).write(self, path, overwrite)

    def save_zones(self, path: str | PathLike[str], overwrite: bool = False) -> None:
        """Write the table of intervals as CSV, in SI units and full precision."""
        require(_FILES).write_csv(self, path, overwrite)

    def save_fields(self, path: str | PathLike[str], overwrite: bool = False) -> None:
        """Write x, pressure and shear as CSV, in SI units and full precision."""
        require(_FILES).write_fields(self, path, overwrite)


def stated_error(
    solution: Solution, terms: tuple[Term, ...], friction: float, ends: float = 0.0
) -> float:
    """`Slip.error`, from the errors of the shear, of the sticking zones and of the solution.

    ends: error of the ends of zones that stick, divided by the width of their zone of contact.
    """
    return _by_control(solution) * max(shear_error(solution, terms, friction), ends, solution.error)


def _by_control(solution: Solution) -> float:
    """Factor of errors: 1 if the load is given; 2 if it is computed, since it then has an error."""
    return 1.0 if solution.scene.given_load is not None else 2.0


def shear_error(solution: Solution, terms: tuple[Term, ...], friction: float) -> float:
    """Error of the shear (the sum of `terms`), divided by friction times the `unit_pressure`."""
    size = friction * unit_pressure(solution.fields)
    return float(sum(abs(t.weight) * t.error * unit_pressure(t.fields) for t in terms) / size)
