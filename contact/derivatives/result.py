"""`Sensitivity`: derivatives of the numbers of a solution by the data of its scene.

Derivatives at a fixed load come from `ParameterRates`, one parameter at a time, or from
`Functionals`, all entries of an array at once. `Linearized.at_control` then changes the load so
that the control of the scene keeps its value.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

import sie
from contact.derivatives.direction import Direction, Parameter
from contact.derivatives.functionals import Functionals
from contact.derivatives.heights import by_heights
from contact.derivatives.linear import Change, Linearized
from contact.derivatives.parameters import ParameterRates
from contact.derivatives.refusals import refuse
from contact.derivatives.response import (
    NUMBERS,
    OF_CRITERION,
    STRESSES,
    TABLES,
    Derivative,
    Response,
)
from contact.derivatives.stresses import LargestStress
from contact.errors import SceneError
from contact.formulation.full_contact import FullFields
from contact.formulation.tolerances import TOLERANCES
from contact.inside.largest import Criterion
from contact.inside.stress import LATERAL
from contact.inside.yielding import CRITERIA, Yield
from contact.model.checks import one_of, poisson_ratio
from contact.model.profiles.sampled import Sampled
from contact.model.units import quantity
from contact.solution.report import label, title
from contact.solution.solution import Solution
from sie import Array


class Sensitivity(sie.Kept):
    """Derivatives of the numbers of a solution; `contact.sensitivity` makes it.

    Every derivative has a stated error, and is taken at a fixed value of the scene's control; only
    the derivative by the control itself is not.

    Parameters
    ----------
    solution : Solution
        The solution.
    stated : bool
        Whether errors are stated. Without them, derivatives take a third of the time.
    stress : LargestStress or None
        The largest stress, if derivatives of it are asked for.
    tops : ndarray or None
        Places of local maxima of the pressure [m], used instead of those of the largest pressure.

    Examples
    --------
    The largest pressure of a cylinder is proportional to the square root of the load.

    >>> import contact
    >>> hertz = contact.Scene(contact.Parabola(1.0), 1e9, contact.Isolated(), load=1e4)
    >>> by_data = contact.sensitivity(contact.solve(hertz))
    >>> for key, size in (("control.load", 1e4), ("profile.radius", 1.0), ("material.E_star", 1e9)):
    ...     by = by_data.of("max_pressure", to=key)
    ...     print(key, round(by.value * size / by_data.solution.max_pressure, 9))
    control.load 0.5
    profile.radius -0.5
    material.E_star 0.5
    """

    def __init__(
        self,
        solution: Solution,
        stated: bool = True,
        stress: LargestStress | None = None,
        tops: Array | None = None,
    ) -> None:
        refuse(solution)
        self.solution, self.stress = solution, stress
        self.linearized = Linearized(solution, stated, stress, tops)
        self._rates = ParameterRates(self.linearized)
        self._functionals = Functionals(self.linearized)
        self._known: dict[str, Response] = {}

    def __repr__(self) -> str:
        """The scene, the control with its value, and the names for `of(number, to=key)`."""
        scene = self.solution.scene
        name, value = scene.control
        numbers = [one for one in NUMBERS if getattr(self.solution, one) is not None]
        numbers += STRESSES if self.stress is not None else ()
        return (
            f"<Sensitivity: {title(scene)}, "
            f"{label(name)} {quantity(value, scene.control_object.unit)}; "
            f"of {', '.join(numbers)}; to {', '.join(self.keys)}>"
        )

    @property
    def keys(self) -> tuple[str, ...]:
        """Names of the parameters by which derivatives are known, as in scene files."""
        return (*self._rates.values, *(() if self.stress is None else OF_CRITERION))

    def of(self, number: str, to: str) -> Derivative:
        """The derivative of one result, such as the load, by one parameter of the scene.

        Parameters
        ----------
        number : str
            See `Response.of`; or "pull_off", the load of `Solution.pull_off`, under a law of
            adhesion without range.
        to : str
            The name of the parameter as in a scene file: "profile.amplitude", "material.E_star",
            "law.work_of_adhesion", "control.load". An array such as "profile.cosine" has an array
            of derivatives, and "profile.cosine[2]" one. With a criterion also "strength" and "nu".

        Returns
        -------
        Derivative

        Raises
        ------
        SceneError
            If a name or the derivative is not known.
        """
        parameter = Parameter.parsed(to)
        one_of("to", parameter.key, self.keys)
        if parameter.key in OF_CRITERION:
            return self._by_criterion(number, to)
        value = self._rates.values[parameter.key]
        if parameter.index is not None or np.ndim(value) == 0:
            if number == "pull_off":
                return Derivative(*self._rates.of_pull_off(parameter))
            return self.by(to).of(number)
        if parameter.name == "height" and isinstance(self.solution.scene.profile, Sampled):
            return self.to_heights(number)
        if number == "pull_off":
            entries = (replace(parameter, index=k) for k in range(len(value)))
            return Derivative(*np.array([self._rates.of_pull_off(one) for one in entries]).T)
        if self._by_adjoint(parameter) and number not in TABLES:
            return self._by_array(number, to)
        found = [self.by(f"{to}[{k}]").of(number) for k in range(len(value))]
        return Derivative(
            np.array([one.value for one in found]),
            np.array([one.error for one in found]),
            next((one.note for one in found if one.note), ""),
        )

    def by(self, to: str) -> Response:
        """Derivatives of all numbers, and of the pressure, by one parameter of the scene."""
        parameter = Parameter.parsed(to)
        key, index = parameter.key, parameter.index
        one_of("to", key, self._rates.values)
        value = self._rates.values[key]
        if (index is not None) != (np.ndim(value) == 1):
            raise SceneError.of(
                "to", to, f"{key}[k] if {key} is an array, and {key} if it is a number"
            )
        if index is not None and not 0 <= index < len(value):
            raise SceneError.of("to", to, f"an index from 0 to {len(value) - 1}")
        if to not in self._known:
            change, target = self._rates.of(parameter)
            of_period = float(self._rates.is_period(parameter))
            self._known[to] = replace(self._response(change, target), of_period=of_period)
        return self._known[to]

    def response(self, dheight: Any, dslope: Callable[[Array], Array] | None = None) -> Response:
        """Derivatives of all numbers along a given change of the profile.

        Parameters
        ----------
        dheight : callable or Profile
            Change of the gap at zero load, f -> f + e dheight(x), with x [m] in the cell of the
            profile. It is smooth on the zones and, if the profile is periodic, periodic. A profile
            also declares its kinks and jumps.
        dslope : callable or None
            The slope of this change; left out if `dheight` is a profile.

        Returns
        -------
        Response
            Derivatives by e at e = 0.

        Raises
        ------
        SceneError
            If the change is not resolved on the zones.

        Examples
        --------
        >>> import contact
        >>> import numpy as np
        >>> wave = contact.Scene(
        ...     contact.Sinusoid(1e-2, 1.0), 1.0, contact.Periodic(), contact_fraction=0.5
        ... )
        >>> by_data, q = contact.sensitivity(contact.solve(wave)), 2 * np.pi
        >>> higher = by_data.response(lambda x: -np.cos(q * x), lambda x: q * np.sin(q * x))
        >>> round(higher.of("load").value, 10) == round(0.5 * np.pi, 10)
        True
        """
        profile = self.solution.scene.profile
        direction = Direction.given(profile, dheight, dslope)
        return self._response(self.linearized.along(direction))

    def to_heights(self, number: str, index: int | tuple[int, ...] = ()) -> Derivative:
        """The derivatives of one number by all heights of a measured profile, from one solve.

        Parameters
        ----------
        number : str
            See `Response.of`.
        index : int or tuple of int
            The entry of an array: that of a zone for "zone_loads" and "zone_widths", (zone, 0 or 1)
            for an end of "zones". Left out for a number.

        Returns
        -------
        Derivative
            One entry for each point of the profile. Heights count upwards, towards contact.

        Raises
        ------
        SceneError
            If the profile is no contact.Sampled, the number has no derivative, or the law is one of
            adhesion or of friction between unlike bodies.

        Examples
        --------
        If all heights rise by 1, nothing changes.

        >>> import contact
        >>> import numpy as np
        >>> x = np.linspace(0.0, 1.0, 16, endpoint=False)
        >>> wave = contact.Sampled(x, 1e-2 * np.cos(2 * np.pi * x), period=1.0)
        >>> scene = contact.Scene(wave, 1.0, contact.Periodic(), contact_fraction=0.4)
        >>> by_heights = contact.sensitivity(contact.solve(scene)).to_heights("max_pressure")
        >>> by_heights.value.shape, bool(abs(by_heights.value.sum()) < 1e-9)
        ((16,), True)
        """
        profile = self.solution.scene.profile
        if not isinstance(profile, Sampled):
            raise SceneError(
                f"the {profile.name} profile has no heights as parameters: use "
                "`of(number, to=...)`, or a contact.Sampled profile",
                "profile",
            )
        weights = self._functionals.entry(number, index)
        found = self._functionals.derivative(number, weights, lambda one: by_heights(profile, one))
        return replace(found, note=found.note or self.note)

    def _by_adjoint(self, to: Parameter) -> bool:
        """Whether one adjoint solve gives the derivatives by all entries of an array of a body."""
        return to.table in self.solution.scene.profile.bodies and not self._functionals.refusal

    def of_tops(self, to: str, number: str = "max_pressure") -> Array:
        """Derivatives (entries, k) of pressure or stress at its k local maxima; no error estimates.

        to: the name of a parameter of the scene; a single number counts as one entry.
        number: "max_pressure" or "max_stress".
        """
        value, count = self._rates.values[to], len(getattr(self.linearized.values, number))
        if np.ndim(value) == 0:
            return np.asarray(getattr(self.by(to).change.values, number))[None]
        if self._by_adjoint(Parameter(to)) and count < len(value):
            found = [self._functionals.weights(number, (k,)) for k in range(count)]
            return np.array([self._rates.sums(one.found[0], to)[0] for one in found]).T
        some = [getattr(self.by(f"{to}[{k}]").change.values, number) for k in range(len(value))]
        return np.array(some).reshape(len(value), count)

    def _by_array(self, number: str, to: str) -> Derivative:
        """Derivatives of a number by all entries of an array parameter, from one adjoint solve."""
        rates, weights = self._rates, self._functionals.entry(number)
        unsure = rates.sums(weights.found[0], to)[1]
        by = self._functionals.derivative(number, weights, lambda one: rates.sums(one, to)[0])
        more = TOLERANCES.margin * unsure * np.abs(np.asarray(by.value))
        return replace(by, error=by.error + more, note=by.note or self.note)

    def _by_criterion(self, number: str, to: str) -> Derivative:
        """Derivative of the largest stress, or of the load of first yield, by strength or nu."""
        one_of("number", number, STRESSES)
        assert self.stress is not None
        if to == "nu":
            rates = self.stress.by_nu
        else:
            # One unit more of strength acts on the load of first yield like one unit less of
            # stress.
            rates = np.full(len(self.stress.points), -1.0 if number == "first_yield" else 0.0)
        return self._response(self._rates.of_stress_alone(rates)).of(number)

    def _response(self, change: Change, target: float = 0.0) -> Response:
        """Derivatives at a fixed value of the control, from those at a fixed load (`change`).

        target: derivative, by the parameter, of the value [SI] that the control prescribes.
        """
        found = self.linearized.at_control(change, target)
        by_load = self.linearized.by_load if self.stress is not None else None
        return Response(self.solution, found, self.note, by_load=by_load)

    @cached_property
    def note(self) -> str:
        """Why derivatives are one-sided at this solution; empty if they are not."""
        solution = self.solution
        certificate = solution.certificate
        if certificate.undecided:
            return (
                "a gap or a minimum of the pressure is zero within rounding, so a zone is about to "
                "appear, to merge with another or to split: derivatives are one-sided, those of "
                "the present zones"
            )
        if isinstance(solution.fields, FullFields) and (
            abs(certificate.smallest_pressure) <= 10 * solution.error * solution.max_pressure
        ):
            return "full contact begins here: derivatives are one-sided, those of full contact"
        return ""


def sensitivity(
    solution: Solution | Yield,
    nu: float | None = None,
    criterion: str = "mises",
    lateral: str = "as loaded",
) -> Sensitivity:
    """Derivatives of the numbers of a solution by all data of its scene.

    Parameters
    ----------
    solution : Solution or Yield
        A solution of contact by zones, by gaps or in full contact, isolated or periodic, on a
        half-plane or a layer, with friction or with adhesion by edge intensities. The errors of its
        derivatives follow from its own error: solve with a small `tol` for many digits. Or the
        result of `solution.first_yield`: then derivatives of the load of first yield are known,
        too.
    nu : float or None
        Poisson's ratio of body 1, for derivatives of its largest equivalent stress, "max_stress",
        and of "first_yield", the load at which this stress keeps its present value.
    criterion, lateral : str
        The equivalent stress, as for `first_yield`.

    Returns
    -------
    Sensitivity
        `of(number, to=)`, `by(to)`, `response(dheight, dslope)`.

    Raises
    ------
    SceneError
        For localized contact, laws with a range of tension, and plateaus of the pressure; for
        stresses that are infinite, or largest at the end of a zone.

    Examples
    --------
    A wave under a mean pressure: sin^2(pi a / L) = mean pressure / (pi E* amplitude / L).

    >>> import contact
    >>> import numpy as np
    >>> wave = contact.Sinusoid(1e-6, 1e-4)
    >>> scene = contact.Scene(wave, 1e9, contact.Periodic(), mean_pressure=1e7)
    >>> solution = contact.solve(scene, tol=1e-11)
    >>> by = contact.sensitivity(solution).of("contact_fraction", to="profile.amplitude")
    >>> exact = -np.tan(np.pi / 2 * solution.contact_fraction) / np.pi / 1e-6
    >>> bool(abs(by.value - exact) < 1e-9 * abs(exact)), bool(by.error < 1e-8 * abs(exact))
    (True, True)

    A cylinder yields at a load that is proportional to its radius.

    >>> cylinder = contact.Scene(contact.Parabola(2.0), 1e9, contact.Isolated(), load=1e3)
    >>> found = contact.solve(cylinder).first_yield(1e6, nu=0.3)
    >>> by = contact.sensitivity(found)
    >>> round(by.of("first_yield", to="profile.radius").value * 2.0 / found.load, 9)
    1.0
    """
    if not isinstance(solution, Yield):
        if nu is None:
            return Sensitivity(solution)
        refuse(solution)
        one_of("criterion", criterion, CRITERIA)
        one_of("lateral", lateral, LATERAL)
        rule = Criterion(criterion, poisson_ratio("nu", nu), lateral)
        return Sensitivity(solution, stress=LargestStress(solution, rule))
    found = solution.solution
    if found is None or solution.note:
        raise SceneError(
            f"the load of first yield has no derivatives, since there is {solution.note}",
            "solution",
        )
    if nu is not None:
        raise SceneError.of(
            "nu", nu, "left out for a contact.Yield, which has its own Poisson's ratio"
        )
    refuse(found)
    assert solution.criterion is not None
    stress = LargestStress(found, solution.criterion, solution.error)
    return Sensitivity(found, stress=stress)
