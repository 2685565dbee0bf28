"""`Sensitivity`: derivatives of the numbers of a solution by the data of its scene.

All follow from two kinds of linear problems (contact.derivatives.rates): the derivative by the load
P, and that along a change of the profile f. The control of the scene keeps its value by a change of
the load. The modulus, the edge intensity K of a law and the period follow from scaling:

    E* dJ/dE* = D_f J - h J                  J grows like the power h of heights
    K dJ/dK   = d J - P dJ/dP - E* dJ/dE*    J grows like the power d of pressures
    x -> (1 + e) x: p -> p / (1 + e), K -> K sqrt(1 + e); loads and approaches stay
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

import sie
from contact.derivatives.adjoint import Weights
from contact.derivatives.direction import (
    STEP,
    WEIGHTS,
    Direction,
    MovedPlaces,
    Parameter,
    places_of,
)
from contact.derivatives.functionals import Functionals, Weighted
from contact.derivatives.heights import by_heights
from contact.derivatives.linear import Change, Linearized
from contact.derivatives.numbers import Numbers
from contact.derivatives.pull_off import PullOffRates
from contact.derivatives.refusals import refuse
from contact.derivatives.response import (
    NUMBERS,
    OF_CRITERION,
    STRESSES,
    TABLES,
    Derivative,
    Response,
    rise_of_stress,
)
from contact.derivatives.stresses import LargestStress
from contact.errors import SceneError
from contact.formulation.full_contact import FullFields
from contact.formulation.tolerances import TOLERANCES
from contact.inside.largest import Criterion
from contact.inside.stress import LATERAL
from contact.inside.yielding import CRITERIA, Yield
from contact.model.checks import one_of, poisson_ratio
from contact.model.controls import Quantity
from contact.model.profiles.sampled import Sampled
from contact.model.registry import remade
from contact.model.units import quantity
from contact.solution.report import label, title
from contact.solution.solution import Solution
from contact.sweeps.sweep.keys import MODULUS, tables
from sie import Array

# Exponents with which numbers scale, on fixed zones, if all pressures or all heights are multiplied
# by a factor. Numbers that are not listed do not change.
OF_PRESSURE = {
    "load": 1.0,
    "max_pressure": 1.0,
    "max_stress": 1.0,
    "stiffness": 1.0,
    "zone_loads": 1.0,
}
OF_HEIGHT = {"approach": 1.0, "mean_gap": 1.0, "stiffness": -1.0}


class Sensitivity(sie.Kept):
    """Derivatives of the numbers of a solution; `contact.sensitivity` makes it.

    Every derivative has its stated error. It is at the given value of the scene's control, except
    the derivative by the control itself.

    Parameters
    ----------
    solution : Solution
        The solution.
    stated : bool
        Whether errors are stated. Without them, derivatives take a third of the time.
    stress : LargestStress or None
        The largest stress, if derivatives of it are asked for.
    tops : ndarray or None
        Local maxima of the pressure [m], which take the places of the largest pressure.

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
        self._ways: dict[str, list[tuple[Direction, float]]] = {}
        self._known: dict[str, Response] = {}
        self._weighted: dict[tuple[str, tuple[int, ...]], Weighted] = {}

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
        scene = self.solution.scene
        names = [MODULUS, f"control.{scene.control[0]}"]
        names += [f"control.{name}" for name in scene.turning]
        names += OF_CRITERION if self.stress is not None else ()
        for table, values in tables(scene).items():
            for name, value in values.items():
                numbers = np.asarray(value if value is not None else "", dtype=object)
                if table not in ("interaction", "substrate") and all(
                    isinstance(one, (int, float, np.number)) and not isinstance(one, bool)
                    for one in numbers.ravel()
                ):
                    names.append(f"{table}.{name}")
        return tuple(names)

    def of(self, number: str, to: str) -> Derivative:
        """The derivative of a number of the solution by one of the scene's data.

        Parameters
        ----------
        number : str
            See `Response.of`; or "pull_off", the load of `Solution.pull_off`, under a law of
            adhesion without range.
        to : str
            The name of the data as in a scene file: "profile.amplitude", "material.E_star",
            "law.work_of_adhesion", "control.load". An array such as "profile.cosine" has an array
            of derivatives, and "profile.cosine[2]" one. With a criterion also "strength" and "nu".

        Returns
        -------
        Derivative

        Raises
        ------
        SceneError
            If the name is not known, or the derivative is not.
        """
        name, index = _parted(to)
        one_of("to", name, self.keys)
        if name in OF_CRITERION:
            return self._by_criterion(number, to)
        value = self._value(name)
        if number == "pull_off" and (index is not None or np.ndim(value) == 0):
            return Derivative(*self._of_pull_off(name, index))
        if index is not None or np.ndim(value) == 0:
            return self.by(to).of(number)
        table, _, key = name.partition(".")
        scene = self.solution.scene
        if key == "height" and isinstance(scene.profile, Sampled):
            return self.to_heights(number)
        if number == "pull_off":
            pairs = np.array([self._of_pull_off(name, k) for k in range(len(value))])
            return Derivative(pairs[:, 0], pairs[:, 1])
        if table in scene.profile.bodies and self._adjoint and number not in TABLES:
            return self._by_array(number, table, key)
        found = [self.by(f"{name}[{k}]").of(number) for k in range(len(value))]
        return Derivative(
            np.array([one.value for one in found]),
            np.array([one.error for one in found]),
            next((one.note for one in found if one.note), ""),
        )

    def by(self, to: str) -> Response:
        """Derivatives of all numbers, and of the pressure, by one parameter of the scene."""
        name, index = _parted(to)
        one_of("to", name, [key for key in self.keys if key not in OF_CRITERION])
        value = self._value(name)
        if (index is not None) != (np.ndim(value) == 1):
            raise SceneError.of("to", to, f"{name}[k] for an array, and {name} for a number")
        if index is not None and not 0 <= index < len(value):
            raise SceneError.of("to", to, f"an index from 0 to {len(value) - 1}")
        if to not in self._known:
            self._known[to] = self._by(name, index)
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
            Its slope; left out for a profile.

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
                f"the {profile.name} profile has no heights: use `of(number, to=...)`, or "
                "contact.Sampled",
                "profile",
            )
        found = self._weights(number, index)
        return self._by_weights(found, lambda one: by_heights(profile, one), number)

    @property
    def _adjoint(self) -> bool:
        """Whether the adjoint equation can give the derivatives by all heights from one solve."""
        return self._functionals.refusal == ""

    @cached_property
    def _functionals(self) -> Functionals:
        return Functionals(self.linearized)

    def of_tops(self, to: str) -> Array:
        """Derivatives (entries, k) of the pressure where it is largest, without error.

        to: the name of data of the scene; a number counts as one entry.
        """
        value, count = self._value(to), len(self.linearized.peaks)
        if np.ndim(value) == 0:
            return self.by(to).change.values.max_pressure[None]
        table, _, key = to.partition(".")
        if self._adjoint and table in self.solution.scene.profile.bodies and count < len(value):
            found = [self._functionals.weights("max_pressure", (k,)) for k in range(count)]
            return np.array([self._sums(one.found[0], table, key)[0] for one in found]).T
        some = [self.by(f"{to}[{k}]").change.values.max_pressure for k in range(len(value))]
        return np.array(some).reshape(len(value), count)

    def _by_array(self, number: str, table: str, key: str) -> Derivative:
        """Derivatives of a number by all entries of an array parameter, from one adjoint solve."""
        found = self._weights(number, ())
        unsure = self._sums(found.found[0], table, key)[1]
        by = self._by_weights(found, lambda one: self._sums(one, table, key)[0], number)
        more = TOLERANCES.margin * unsure * np.abs(np.asarray(by.value))
        return replace(by, error=by.error + more)

    def _sums(self, weights: Weights, table: str, key: str) -> tuple[Array, Array]:
        """A functional of the changes by all entries of an array of parameters, relative errors."""
        profile = self.solution.scene.profile
        count = len(self._value(f"{table}.{key}"))
        if table == "profile" and profile.unit_of(key, 0) is not None:
            all_of = profile.unit_sums(key, weights.x, weights.heights, weights.slopes)
            if all_of is not None:
                return all_of, np.full(count, TOLERANCES.rounding)
        directions = self._directions(table, key)
        sums = [weights.of(way.height, way.slope) for way, _ in directions]
        return np.array(sums), np.array([error for _, error in directions])

    def _directions(self, table: str, key: str) -> list[tuple[Direction, float]]:
        """The changes of the profile by the entries of an array, with their relative errors."""
        profile, name = self.solution.scene.profile, f"{table}.{key}"
        if name not in self._ways:
            x = places_of(profile, self.solution.zones)
            self._ways[name] = [
                Direction.by_parameter(profile, Parameter(table, key, k), x)
                for k in range(len(self._value(name)))
            ]
        return self._ways[name]

    def _weights(self, number: str, index: int | tuple[int, ...]) -> Weighted:
        """Adjoint weights of a number, on the zones and on zones moved by their stated error."""
        one_of("number", number, NUMBERS + STRESSES)
        at = index if isinstance(index, tuple) else (index,)
        # This derivative by the load raises SceneError if the number has no derivatives.
        by_load = self.linearized.by_load
        value = np.asarray(Response(self.solution, by_load, by_load=by_load).of(number).value)
        if len(at) != value.ndim or any(
            not 0 <= k < n for k, n in zip(at, value.shape, strict=True)
        ):
            raise SceneError.of("index", index, f"an index of an array of shape {value.shape}")
        if (number, at) not in self._weighted:
            self._weighted[number, at] = self._functionals.weights(number, at)
        return self._weighted[number, at]

    def _by_weights(
        self, weighted: Weighted, table_of: Callable[[Weights], Array], number: str
    ) -> Derivative:
        """Derivatives that the function `table_of` computes from adjoint weights, with errors."""
        tables = [table_of(one) for one in weighted.found]
        value = tables[0]
        relative = 2 * self.solution.error + TOLERANCES.margin * weighted.found[0].error
        error = relative * float(np.abs(value).max(initial=0.0)) + np.zeros(value.shape)
        for other in tables[1:]:
            error = error + TOLERANCES.margin * abs(other - value)
        if weighted.control is not None:
            error = error + weighted.unsure * abs(table_of(weighted.control))
        note = self.note
        if number == "max_pressure" and len(self.linearized.peaks) > 1:
            note = "several places of largest pressure: the derivatives are those of one of them"
        if number in STRESSES and len(self.linearized.values.max_stress) > 1:
            note = "several places of largest stress: the derivatives are those of one of them"
        return Derivative(value, error, note)

    def _by_criterion(self, number: str, to: str) -> Derivative:
        """Derivative of the largest stress, or of the load of first yield, by strength or nu."""
        one_of("number", number, STRESSES)
        stress, (rise, unsure) = self.stress, rise_of_stress(self.linearized.by_load)
        assert stress is not None
        strength = np.ones(rise.shape)
        change = -stress.by_nu if to == "nu" else strength
        if number == "max_stress":
            change = strength - strength if to == "strength" else stress.by_nu
            error = 4 * (self.solution.error + stress.missed) * np.abs(change)
            first = int(np.argmax(change))
            return Derivative(float(change[first]), float(error[first]), self.note)
        first = int(np.argmin(change / rise))
        error = (unsure + 4 * (self.solution.error + stress.missed) / rise) * np.abs(change)
        return Derivative(float((change / rise)[first]), float(error[first]), self.note)

    # The next methods give the derivative by one parameter.

    def _value(self, name: str) -> Any:
        table, _, key = name.partition(".")
        scene = self.solution.scene
        if name == MODULUS:
            return scene.E_star
        if table == "control":
            return getattr(scene, key) if key in scene.turning else scene.control[1]
        return tables(scene)[table][key]

    def _by(self, name: str, index: int | None) -> Response:
        table, _, key = name.partition(".")
        scene = self.solution.scene
        if name == MODULUS:
            return self._response(self._by_modulus)
        if table == "control":
            return self._by_control(key)
        if table == "law":
            return self._by_law(key)
        if key == "period" and scene.period is not None:
            return self._by_period()
        direction, error = self._direction(name, index)
        change = self.linearized.along(direction)
        errors = change.errors + abs(change.values) * (TOLERANCES.margin * error)
        return self._response(replace(change, errors=errors))

    def _direction(self, name: str, index: int | None) -> tuple[Direction, float]:
        """(derivative of the profile by one of its parameters, relative error of it)."""
        table, _, key = name.partition(".")
        profile = self.solution.scene.profile
        try:
            x = places_of(profile, self.solution.zones)
            return Direction.by_parameter(profile, Parameter(table, key, index), x)
        except MovedPlaces:
            raise SceneError(
                f"{name}: it moves corners, kinks or jumps of the profile, and derivatives by "
                "their places are not known: use differences of solutions",
                "to",
                name,
            ) from None

    def _of_pull_off(self, name: str, index: int | None) -> tuple[float, float]:
        """(derivative, error) of the pull-off load by one parameter of the scene.
        The derivative by the value of the control is 0.
        """
        table, _, key = name.partition(".")
        scene, rates = self.solution.scene, self._pull_off
        if table == "control":
            return 0.0, 0.0
        if table in scene.profile.bodies and not (key == "period" and scene.period):
            return rates.along(self._direction(name, index)[0])
        # The pull-off load is homogeneous of degree one in E* and the edge intensity K.
        itself, error = rates.along(Direction.itself(scene.profile))
        by_intensity = rates.load - itself
        if table == "law":
            power = self._intensity_rate(name)
            return power * by_intensity, abs(power) * error
        if name == MODULUS:
            power = self._intensity_rate(name)
            return itself / scene.E_star + power * by_intensity, 2 * error / scene.E_star
        assert scene.period is not None
        stretched, more = rates.along(Direction.by_period(scene.profile))
        return (stretched + 0.5 * by_intensity) / scene.period, (more + error) / scene.period

    @cached_property
    def _pull_off(self) -> PullOffRates:
        return PullOffRates(self.solution)

    def _intensity_rate(self, name: str) -> float:
        """Derivative of ln K by the modulus or a parameter of the law; 0 without adhesion.
        K is the edge intensity.
        """
        law, E_star = self.solution.scene.law, self.solution.scene.E_star
        if not self._adheres():
            return 0.0
        value, key = float(self._value(name)), name.partition(".")[2]

        def intensity(at: float) -> float:
            if name == MODULUS:
                return law.intensity(at)
            return float(remade(law, {key: at}).intensity(E_star))

        return _difference(intensity, value, STEP * abs(value)) / law.intensity(E_star)

    @cached_property
    def _itself(self) -> Change:
        """Derivatives of all numbers along the profile f itself: f changes to f + e f."""
        return self.linearized.along(Direction.itself(self.solution.scene.profile))

    def _value_change(self, degrees: dict[str, float]) -> Change:
        """A change in which every number changes by itself times its exponent in `degrees`.
        The pressure does not change.
        """
        values = self.linearized.values
        part = Numbers.of_degrees(values, degrees)
        error = abs(part) * (3 * self.solution.error)
        return Change(part, error, lambda x: np.zeros(np.shape(x)))

    @cached_property
    def _modulus_alone(self) -> Change:
        """Derivatives of all numbers by E*, times E*, at a fixed load and edge intensity."""
        return self._itself.plus(self._value_change(OF_HEIGHT), -1.0)

    @cached_property
    def _intensity(self) -> Change:
        """Derivatives of all numbers by the edge intensity K, times K, at fixed load and E*."""
        solution = self.solution
        own = self._value_change(OF_PRESSURE)
        own = replace(own, pressure=lambda x: solution.pressure(x))
        found = own.plus(self.linearized.by_load, -solution.load)
        return found.plus(self._modulus_alone, -1.0)

    def _adheres(self) -> bool:
        scene = self.solution.scene
        return scene.law.intensity(scene.E_star) != 0.0

    @cached_property
    def _by_modulus(self) -> Change:
        scene, change = self.solution.scene, self._modulus_alone
        if self._adheres():
            change = change.plus(self._intensity, scene.E_star * self._intensity_rate(MODULUS))
        return change.times(1.0 / scene.E_star)

    def _by_control(self, key: str) -> Response:
        scene = self.solution.scene
        if key == "tilt":
            change = self.linearized.along(
                Direction.given(scene.profile, lambda x: -x, lambda x: -np.ones_like(x))
            )
            return self._response(change)
        if key == "moment":
            return self._response(self.linearized.by_moment)
        held, control = scene.control_object.held(scene), scene.control_object
        assert held is not None
        other = replace(control, value=2.0 * control.value).held(scene)
        assert other is not None
        nothing = self.linearized.by_load.times(0.0)
        return self._response(nothing, (other.value - held.value) / control.value)

    def _by_law(self, key: str) -> Response:
        law = self.solution.scene.law
        value = float(getattr(law, key))
        if law.kappa != remade(law, {key: value * (1 + STEP) or STEP}).kappa:
            raise SceneError(
                f"law.{key}: it changes the pressure of bodies that differ elastically, and "
                "derivatives by it are not known: use differences of solutions",
                "to",
                f"law.{key}",
            )
        if not self._adheres():
            return self._response(self._by_shear(key, value))
        return self._response(self._intensity.times(self._intensity_rate(f"law.{key}")))

    def _by_shear(self, key: str, value: float) -> Change:
        """The derivative by a parameter of a law of friction, which changes the stresses only."""
        nothing = self.linearized.by_load.times(0.0)
        if self.stress is None:
            return nothing
        law = self.solution.scene.law

        def ratio(at: float) -> float:
            return float(remade(law, {key: at}).shear_ratio)

        rate = _difference(ratio, value, STEP * value) if value else (ratio(STEP) - ratio(0)) / STEP
        turned = self.stress.by_shear * rate
        error = np.abs(turned) * (4 * (self.solution.error + self.stress.missed))
        return replace(
            nothing,
            values=replace(nothing.values, max_stress=turned),
            errors=replace(nothing.errors, max_stress=error),
        )

    def _by_period(self) -> Response:
        scene = self.solution.scene
        profile, period = scene.profile, scene.period
        assert period is not None
        if not scene.operator.is_plain or scene.operator.is_own or len(profile.bodies) > 1:
            raise SceneError(
                "profile.period: derivatives by it are known for one body on a half-plane",
                "to",
                "profile.period",
            )
        try:
            change = self.linearized.along(Direction.by_period(profile))
        except MovedPlaces:
            raise SceneError(
                "profile.period: the places of points, kinks or jumps do not grow with it: use "
                "differences of solutions",
                "to",
                "profile.period",
            ) from None
        degrees = {"zones": 1.0, "max_pressure": -1.0, "max_stress": -1.0}
        change = change.plus(self._value_change(degrees), 1.0)
        if self._adheres():
            change = change.plus(self._intensity, 0.5)
        unknown = replace(change.times(1.0 / period), pressure=_not_known)
        held = scene.control_object.held(scene)
        wider = scene.profile.varied({"profile": {"period": 2.0 * period}})
        other = scene.control_object.held(replace(scene, profile=wider))
        assert held is not None and other is not None
        target = (other.value - held.value) / period
        return replace(self._response(unknown, target), of_period=1.0)

    # The next method passes from a fixed load to a fixed value of the control.

    def _response(self, change: Change, target: float = 0.0) -> Response:
        """Derivatives at a fixed value of the control, from those at a fixed load (`change`).

        target: derivative of the value [SI] that the control prescribes.
        """
        held = self.solution.scene.control_object.held(self.solution.scene)
        assert held is not None
        if held.quantity is Quantity.LOAD and target == 0.0:
            by_load = self.linearized.by_load if self.stress is not None else None
            return Response(self.solution, change, self.note, by_load=by_load)
        by_load = self.linearized.by_load
        of_change, change_error = _controlled(held.quantity, change)
        of_load, load_error = _controlled(held.quantity, by_load)
        if not np.isfinite(of_load) or of_load == 0.0:
            raise SceneError(
                "the control does not depend on the load here: there are no derivatives at its "
                "given value",
                "control",
            )
        load = (target - of_change) / of_load
        error = (change_error + abs(load) * load_error) / abs(of_load)
        found = change.plus(by_load, load)
        return Response(
            self.solution,
            replace(found, errors=found.errors + abs(by_load.values) * error),
            self.note,
            by_load=by_load,
        )

    @cached_property
    def note(self) -> str:
        """Why derivatives are one-sided at this solution; empty if they are not."""
        solution = self.solution
        certificate = solution.certificate
        if certificate.undecided:
            return (
                "an event: a gap, or a minimum of the pressure, is zero within rounding, so that a "
                "zone is about to be born, to close or to part: derivatives are one-sided, those "
                "of the zones that there are"
            )
        if isinstance(solution.fields, FullFields) and (
            abs(certificate.smallest_pressure) <= 10 * solution.error * solution.max_pressure
        ):
            return (
                "an event: full contact begins here: derivatives are one-sided, those of full "
                "contact"
            )
        return ""


def _not_known(x: Array) -> Array:
    raise SceneError(
        "the derivative of the pressure by the period at fixed x is not known: use that of numbers",
        "x",
    )


def _controlled(quantity: Quantity, change: Change) -> tuple[float, float]:
    """(derivative, error) of the quantity that a control prescribes."""
    values, errors = change.values, change.errors
    if quantity is Quantity.LOAD:
        return values.load, errors.load
    if quantity is Quantity.APPROACH:
        value, error = values.largest("approach"), errors.largest("approach")
        return float(value), float(error)
    width = float(np.diff(values.zones).sum()), float(errors.zones.sum())
    return width if quantity is Quantity.WIDTH else (0.5 * width[0], 0.5 * width[1])


def _difference(function: Callable[[float], float], at: float, step: float) -> float:
    """Derivative of `function` at the number `at`, by a central difference of order 8."""
    terms = (
        weight * (function(at + k * step) - function(at - k * step))
        for k, weight in enumerate(WEIGHTS, 1)
    )
    return sum(terms) / step


def _parted(to: str) -> tuple[str, int | None]:
    """(name, index or None) of a key such as "profile.cosine[2]"."""
    if not isinstance(to, str):
        raise SceneError.of("to", to, "a name such as 'profile.amplitude'")
    name, bracket, index = to.partition("[")
    if not bracket:
        return name, None
    if not (index.endswith("]") and index[:-1].isdigit()):
        raise SceneError.of("to", to, "a name, or a name with an index such as profile.cosine[2]")
    return name, int(index[:-1])


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
        half-plane or a layer, with friction or with adhesion by edge intensities. The errors of
        derivatives follow from its own: solve with a small `tol` for many digits. Or what
        `solution.first_yield` found: then also derivatives of the load of first yield.
    nu : float or None
        Poisson's ratio of body 1, for derivatives of its largest equivalent stress, "max_stress",
        and of "first_yield", the load at which this stress is what it is now.
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
        raise SceneError(f"first yield: {solution.note}: its load has no derivatives", "solution")
    if nu is not None:
        raise SceneError.of("nu", nu, "left out for a contact.Yield, which has its own")
    refuse(found)
    assert solution.criterion is not None
    stress = LargestStress(found, solution.criterion, solution.error)
    return Sensitivity(found, stress=stress)
