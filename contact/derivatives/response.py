"""`Derivative` and `Response`: the derivatives of the numbers of a solution by one parameter."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from contact.derivatives.linear import Change
from contact.derivatives.numbers import Value
from contact.errors import SceneError
from contact.model.checks import one_of, real
from contact.solution.solution import Solution
from sie import Array

# Names of the numbers that are arrays, with an entry for each zone.
TABLES = ("zones", "zone_widths", "zone_loads")
# Names of the numbers of a solution that have derivatives.
NUMBERS = (
    "load",
    "mean_pressure",
    "approach",
    "mean_gap",
    "contact_fraction",
    "max_pressure",
    "stiffness",
    "zones",
    "zone_widths",
    "zone_loads",
)
# Numbers that are taken at special points, with a description of these points. A contact may have
# several of them.
PLACES = {
    "approach": "lowest places",
    "max_pressure": "places of largest pressure",
    "max_stress": "places of largest stress",
}
# Names of the numbers that need a criterion of yield, and names of the data of the criterion.
STRESSES = ("max_stress", "first_yield")
OF_CRITERION = ("strength", "nu")


@dataclass(frozen=True)
class Derivative:
    """The derivative of a number of a solution, with its stated error.

    Parameters
    ----------
    value : float or ndarray
        The derivative; an array for zones, their widths and their loads, and by an array of
        parameters.
    error : float or ndarray
        Bound of the error of the derivative, of the same shape.
    note : str
        Why the derivative is one-sided and holds only for a growing parameter; empty if it is not.

    Examples
    --------
    The half width of a cylinder's contact grows like the square root of the load.

    >>> import contact
    >>> hertz = contact.Scene(contact.Parabola(1.0), 1e9, contact.Isolated(), load=1e4)
    >>> by = contact.sensitivity(contact.solve(hertz, tol=1e-11)).of("zones", to="control.load")
    >>> (by.value * 2e4 / by.value[0, 1] / 2e4).round(9).tolist(), bool(by.error.max() < 1e-15)
    ([[-1.0, 1.0]], True)
    """

    value: Value
    error: Value
    note: str = ""

    def __float__(self) -> float:
        return float(self.value)


@dataclass(frozen=True, eq=False)
class Response:
    """Derivatives of all numbers of a contact by one parameter, at a fixed value of the control.

    `of(number)` is the derivative of a number with its error; `pressure(x)` is the derivative of
    the pressure at fixed x.

    Parameters
    ----------
    solution : Solution
        The solution.
    change : Change
        Derivatives of all numbers, their errors, and the derivative of the pressure.
    note : str
        Why the derivatives are one-sided; empty if they are not.
    of_period : float
        Derivative of the period by the parameter, on which the mean pressure depends.
    by_load : Change or None
        The derivatives by the load, from which the derivative of first yield is computed.

    Examples
    --------
    In full contact the pressure follows the load everywhere.

    >>> import contact
    >>> wave = contact.Sinusoid(1e-6, 1e-4)
    >>> full = contact.solve(contact.Scene(wave, 1e9, contact.Periodic(), load=5e3))
    >>> by_load = contact.sensitivity(full).by("control.load")
    >>> (by_load.pressure([0.0, 3e-5]) * 1e-4).round(12).tolist()
    [1.0, 1.0]
    """

    solution: Solution = field(repr=False)
    change: Change = field(repr=False)
    note: str = ""
    of_period: float = 0.0
    by_load: Change | None = field(default=None, repr=False)

    def of(self, number: str) -> Derivative:
        """The derivative of a number of the solution.

        Parameters
        ----------
        number : str
            One of "load", "mean_pressure", "approach", "mean_gap", "contact_fraction",
            "max_pressure", "stiffness", "zones", "zone_widths", "zone_loads"; with a criterion also
            "max_stress" and "first_yield".

        Returns
        -------
        Derivative

        Raises
        ------
        SceneError
            If the scene does not define the number, or its derivative is not known.
        """
        one_of("number", number, NUMBERS + STRESSES)
        values, errors = self.change.values, self.change.errors
        if number in STRESSES and values.max_stress.size == 0:
            raise SceneError(
                f"{number} needs a criterion: contact.sensitivity(solution, nu=0.3), or "
                "contact.sensitivity(solution.first_yield(strength, nu))",
                "number",
                number,
            )
        if number == "first_yield":
            return self._first_yield()
        if number == "zone_widths":
            return Derivative(np.diff(values.zones)[:, 0], errors.zones.sum(axis=1), self.note)
        if number == "mean_pressure":
            period = self.solution.scene.profile.period
            if period is None:
                raise SceneError("without a period there is no mean pressure", "number")
            mean = (values.load - self.solution.load * self.of_period / period) / period
            return Derivative(mean, errors.load / period, self.note)
        value, error = values.largest(number), errors.largest(number)
        if not np.all(np.isfinite(value)):
            raise SceneError(f"{number}: {self._missing(number)}", "number", number)
        note = self.note
        if number in PLACES:
            table, slack = getattr(values, number), 4 * float(np.max(error))
            if np.ptp(table) > slack:
                note = (
                    f"there are {len(table)} {PLACES[number]}: the derivative is one-sided, the "
                    "largest of those at these places"
                )
        return Derivative(value, error, note)

    def _first_yield(self) -> Derivative:
        """Derivative of the load of first yield, under which the largest stress stays the same."""
        assert self.by_load is not None
        rise, unsure = _rise_of_stress(self.by_load)
        values, errors = self.change.values, self.change.errors
        rates = values.load - values.max_stress / rise
        error = errors.load + errors.max_stress / rise + np.abs(values.max_stress) * unsure
        first = int(np.argmin(rates))
        note = self.note
        if np.ptp(rates) > 4 * float(error.max()):
            note = (
                f"{len(rates)} places yield first, at the same load: the derivative is one-sided, "
                "the smallest of those at these places"
            )
        return Derivative(float(rates[first]), float(error[first]), note)

    def _missing(self, number: str) -> str:
        if number == "max_pressure":
            return "the largest pressure is infinite or fixed at a limit: it has no derivative"
        if number == "max_stress":
            return "the stress is infinite at ends of zones: the largest stress has no derivative"
        if number == "stiffness":
            return (
                "the derivative is available only if the stiffness is finite, without adhesion and "
                "without friction between elastically different bodies"
            )
        return "the scene does not define this number, or its derivative is infinite"

    def pressure(self, x: ArrayLike) -> Array:
        """Derivative of the pressure by the parameter, at fixed x [m] of any array shape.
        It is infinite at ends that move.
        """
        return self.change.pressure(real("x", x))


def _rise_of_stress(by_load: Change) -> tuple[Array, Array]:
    """Derivatives of the largest stress by the load, and the errors of their inverses."""
    rise, error = by_load.values.max_stress, by_load.errors.max_stress
    if not np.all(rise > 10 * error):
        raise SceneError(
            "the largest stress does not grow with the load here: the load of first yield has no "
            "derivative",
            "number",
            "first_yield",
        )
    return rise, np.asarray(error / rise**2)
