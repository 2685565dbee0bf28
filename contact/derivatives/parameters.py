"""Derivatives of the numbers of a contact by one parameter of its scene, at a fixed load.

A parameter of the profile f changes f. The derivatives of a number J by the modulus E*, by the edge
intensity K of a law and by the period follow, by scaling, from the derivative D_f J along f itself
and from that by the load P:

    E* dJ/dE* = D_f J - h J                  J grows like the power h of heights
    K dJ/dK   = d J - P dJ/dP - E* dJ/dE*    J grows like the power d of pressures
    period: x -> (1 + e) x, p -> p / (1 + e), K -> K / sqrt(1 + e); loads and approaches stay
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
from contact.derivatives.linear import Change, Linearized
from contact.derivatives.numbers import Numbers
from contact.derivatives.pull_off import PullOffRates
from contact.errors import SceneError
from contact.formulation.tolerances import TOLERANCES
from contact.model.registry import remade
from contact.sweeps.sweep.keys import MODULUS, numbers_of
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


class ParameterRates(sie.Kept):
    """Derivatives of the numbers of one solution by parameters of its scene, at a fixed load."""

    def __init__(self, linearized: Linearized) -> None:
        self.linearized, self.solution = linearized, linearized.solution
        self.scene = self.solution.scene
        self._entries: dict[str, list[tuple[Direction, float]]] = {}

    @cached_property
    def values(self) -> dict[str, Any]:
        """Values of all parameters, by their keys in scene files; some are arrays."""
        scene, (control, value) = self.scene, self.scene.control
        controls = {control: value} | {name: getattr(scene, name) for name in scene.turning}
        return numbers_of(scene) | {f"control.{name}": at for name, at in controls.items()}

    def of(self, to: Parameter) -> tuple[Change, float]:
        """Derivatives by a parameter: of all numbers, and of the value [SI] of the control.

        The control prescribes one quantity, whose value may depend on the parameter. For example, a
        given mean pressure prescribes the load, which depends on the period.
        """
        if to.key == MODULUS:
            return self._by_modulus, 0.0
        if to.table == "control":
            return self._by_control(to.name)
        if to.table == "law":
            return self._by_law(to.name), 0.0
        if self.is_period(to):
            return self._by_period()
        direction, error = self._direction(to)
        change = self.linearized.along(direction)
        errors = change.errors + abs(change.values) * (TOLERANCES.margin * error)
        return replace(change, errors=errors), 0.0

    def is_period(self, to: Parameter) -> bool:
        """Whether the parameter is the period of a periodic contact."""
        return (
            to.name == "period"
            and to.table in self.scene.profile.bodies
            and self.scene.period is not None
        )

    def sums(self, weights: Weights, key: str) -> tuple[Array, Array]:
        """Derivatives of a number by all entries of an array parameter, from its adjoint `weights`.

        The second array has the relative errors of the derivatives of the profile.
        """
        table, _, name = key.partition(".")
        profile = self.scene.profile
        if table == "profile" and profile.unit_of(name, 0) is not None:
            all_of = profile.unit_sums(name, weights.x, weights.heights, weights.slopes)
            if all_of is not None:
                return all_of, np.full(len(self.values[key]), TOLERANCES.rounding)
        if key not in self._entries:
            x = places_of(profile, self.solution.zones)
            self._entries[key] = [
                Direction.by_parameter(profile, Parameter(key, k), x)
                for k in range(len(self.values[key]))
            ]
        directions = self._entries[key]
        sums = [weights.of(way.height, way.slope) for way, _ in directions]
        return np.array(sums), np.array([error for _, error in directions])

    def _direction(self, to: Parameter) -> tuple[Direction, float]:
        """(derivative of the profile by one of its parameters, relative error of it)."""
        profile = self.scene.profile
        try:
            return Direction.by_parameter(profile, to, places_of(profile, self.solution.zones))
        except MovedPlaces:
            raise SceneError(
                f"{to.key}: this parameter moves corners, kinks or jumps of the profile, and "
                "derivatives by their positions are not available: use finite differences of "
                "solutions",
                "to",
                to.key,
            ) from None

    def of_pull_off(self, to: Parameter) -> tuple[float, float]:
        """(derivative, error) of the pull-off load by one parameter of the scene.
        The derivative by the value of the control is 0.
        """
        scene, rates = self.scene, self._pull_off
        if to.table == "control":
            return 0.0, 0.0
        if to.table in scene.profile.bodies and not self.is_period(to):
            return rates.along(self._direction(to)[0])
        # The pull-off load is homogeneous of degree one in E* and the edge intensity K.
        itself, error = rates.along(Direction.itself(scene.profile))
        by_intensity = rates.load - itself
        if to.table == "law":
            power = self._intensity_rate(to.key)
            return power * by_intensity, abs(power) * error
        if to.key == MODULUS:
            power = self._intensity_rate(MODULUS)
            return itself / scene.E_star + power * by_intensity, 2 * error / scene.E_star
        assert scene.period is not None
        stretched, more = rates.along(Direction.by_period(scene.profile))
        return (stretched + 0.5 * by_intensity) / scene.period, (more + error) / scene.period

    @cached_property
    def _pull_off(self) -> PullOffRates:
        return PullOffRates(self.solution)

    def _intensity_rate(self, key: str) -> float:
        """Derivative of ln K by the modulus or a parameter of the law; 0 without adhesion.
        K is the edge intensity.
        """
        law, E_star = self.scene.law, self.scene.E_star
        if not self._adheres():
            return 0.0
        value, name = float(self.values[key]), key.partition(".")[2]

        def intensity(at: float) -> float:
            if key == MODULUS:
                return law.intensity(at)
            return float(remade(law, {name: at}).intensity(E_star))

        return _difference(intensity, value, STEP * abs(value)) / law.intensity(E_star)

    def _value_change(self, degrees: dict[str, float]) -> Change:
        """A change of every number by its own value times its exponent in `degrees`.
        The pressure does not change.
        """
        values = self.linearized.values
        part = Numbers.of_degrees(values, degrees)
        error = abs(part) * (3 * self.solution.error)
        return Change(part, error, lambda x: np.zeros(np.shape(x)))

    @cached_property
    def _modulus_alone(self) -> Change:
        """Derivatives of all numbers by E*, times E*, at a fixed load and edge intensity."""
        along_profile = self.linearized.along(Direction.itself(self.scene.profile))
        return along_profile.plus(self._value_change(OF_HEIGHT), -1.0)

    @cached_property
    def _intensity(self) -> Change:
        """Derivatives of all numbers by the edge intensity K, times K, at fixed load and E*."""
        solution = self.solution
        own = self._value_change(OF_PRESSURE)
        own = replace(own, pressure=lambda x: solution.pressure(x))
        found = own.plus(self.linearized.by_load, -solution.load)
        return found.plus(self._modulus_alone, -1.0)

    def _adheres(self) -> bool:
        return self.scene.law.intensity(self.scene.E_star) != 0.0

    @cached_property
    def _by_modulus(self) -> Change:
        E_star, change = self.scene.E_star, self._modulus_alone
        if self._adheres():
            change = change.plus(self._intensity, E_star * self._intensity_rate(MODULUS))
        return change.times(1.0 / E_star)

    def _by_control(self, name: str) -> tuple[Change, float]:
        """Derivatives by the control or, in a tilted contact, by the given tilt or moment.
        The second number is as in `of`.
        """
        if name == "tilt":
            change = Direction.given(self.scene.profile, lambda x: -x, lambda x: -np.ones_like(x))
            return self.linearized.along(change), 0.0
        if name == "moment":
            return self.linearized.by_moment, 0.0
        control = self.scene.control_object
        other = replace(control, value=2.0 * control.value).held(self.scene)
        assert other is not None
        rate = (other.value - self.linearized.held.value) / control.value
        return self.linearized.by_load.times(0.0), rate

    def _by_law(self, name: str) -> Change:
        law = self.scene.law
        value = float(getattr(law, name))
        if law.kappa != remade(law, {name: value * (1 + STEP) or STEP}).kappa:
            raise SceneError(
                f"law.{name}: this parameter changes how friction acts on the pressure of "
                "elastically different bodies, and derivatives by it are not available: use finite "
                "differences of solutions",
                "to",
                f"law.{name}",
            )
        if not self._adheres():
            return self._by_shear(name, value)
        return self._intensity.times(self._intensity_rate(f"law.{name}"))

    def of_stress_alone(self, rates: Array) -> Change:
        """The `Change` by a parameter on which, of all numbers, only the largest stress depends.

        rates: derivatives of the stress at each place of the largest stress.
        """
        nothing, stress = self.linearized.by_load.times(0.0), self.linearized.stress
        assert stress is not None
        error = np.abs(rates) * (4 * (self.solution.error + stress.yield_error))
        return replace(
            nothing,
            values=replace(nothing.values, max_stress=rates),
            errors=replace(nothing.errors, max_stress=error),
        )

    def _by_shear(self, name: str, value: float) -> Change:
        """The derivative by a parameter of a friction law; the shear changes only the stresses."""
        stress = self.linearized.stress
        if stress is None:
            return self.linearized.by_load.times(0.0)

        def ratio(at: float) -> float:
            return float(remade(self.scene.law, {name: at}).shear_ratio)

        rate = _difference(ratio, value, STEP * value) if value else (ratio(STEP) - ratio(0)) / STEP
        return self.of_stress_alone(stress.by_shear * rate)

    def _by_period(self) -> tuple[Change, float]:
        """Derivatives by the period; the second number is as in `of`."""
        scene, period = self.scene, self.scene.period
        assert period is not None
        if not scene.operator.is_plain or scene.operator.is_own or len(scene.profile.bodies) > 1:
            raise SceneError(
                "profile.period: derivatives by the period are available only for a single "
                "profile on a half-plane, with an interaction of this package: use finite "
                "differences of solutions",
                "to",
                "profile.period",
            )
        try:
            change = self.linearized.along(Direction.by_period(scene.profile))
        except MovedPlaces:
            raise SceneError(
                "profile.period: the positions of kinks, jumps or algebraic points of the profile "
                "are not proportional to the period, so derivatives by the period are not "
                "available: use finite differences of solutions",
                "to",
                "profile.period",
            ) from None
        degrees = {"zones": 1.0, "max_pressure": -1.0, "max_stress": -1.0}
        change = change.plus(self._value_change(degrees), 1.0)
        if self._adheres():
            change = change.plus(self._intensity, 0.5)
        wider = scene.profile.varied({"profile": {"period": 2.0 * period}})
        other = scene.control_object.held(replace(scene, profile=wider))
        assert other is not None
        rate = (other.value - self.linearized.held.value) / period
        return replace(change.times(1.0 / period), pressure=_not_known), rate


def _not_known(x: Array) -> Array:
    raise SceneError(
        "the derivative of pressure(x) by the period is not available: use `of(number, to=...)` "
        "for a number such as max_pressure",
        "x",
    )


def _difference(function: Callable[[float], float], at: float, step: float) -> float:
    """Derivative of `function` at the number `at`, by a central difference of order 8."""
    terms = (
        weight * (function(at + k * step) - function(at - k * step))
        for k, weight in enumerate(WEIGHTS, 1)
    )
    return sum(terms) / step
