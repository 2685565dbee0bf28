"""Numbers of a solution as functionals of changes of its profile, at a fixed control value."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

import sie
from contact.derivatives.adjoint import Functional, Weights, full_weights, weights_of
from contact.derivatives.linear import Linearized
from contact.derivatives.response import NUMBERS, STRESSES, Derivative, Response
from contact.errors import SceneError
from contact.formulation.fields import ZoneFields
from contact.formulation.full_contact import FullFields
from contact.formulation.tolerances import TOLERANCES
from contact.model.checks import one_of
from contact.model.controls import Quantity
from sie import Array, record


@record
class Weighted:
    """The adjoint weights of one number of the solution, such as its load.

    found: the weights on the solution's zones, then on zones moved by their stated error; the
    differences show the error of the weights. control, unsure: `unsure` times the weights `control`
    bounds a further error, due to errors of derivatives by the load. `control` is None if the load
    is given, or if errors are not asked for.
    """

    found: tuple[Weights, ...]
    control: Weights | None
    unsure: float


class Functionals(sie.Kept):
    """Derivatives of the numbers of one solution, as functionals of changes of its profile."""

    def __init__(self, linearized: Linearized) -> None:
        self.linearized, self.solution = linearized, linearized.solution
        self._known: dict[tuple[str, tuple[int, ...]], Weighted] = {}

    def entry(self, number: str, index: int | tuple[int, ...] = ()) -> Weighted:
        """Adjoint weights of a number of the solution, or of one entry of an array.

        The weights are kept. Raises SceneError if there is no such entry, or if it has no
        derivatives.
        """
        one_of("number", number, NUMBERS + STRESSES)
        at = index if isinstance(index, tuple) else (index,)
        # This derivative by the load raises SceneError if the number has no derivatives.
        by_load = self.linearized.by_load
        value = np.asarray(Response(self.solution, by_load, by_load=by_load).of(number).value)
        if len(at) != value.ndim or any(
            not 0 <= k < n for k, n in zip(at, value.shape, strict=True)
        ):
            raise SceneError.of(
                "index", index, f"a valid index of {number}, whose shape is {value.shape}"
            )
        if (number, at) not in self._known:
            self._known[number, at] = self.weights(number, at)
        return self._known[number, at]

    def derivative(
        self, number: str, weighted: Weighted, of: Callable[[Weights], Array]
    ) -> Derivative:
        """Derivatives of `number` by several parameters at once, with their errors.
        The function `of` computes them from the adjoint weights of the number, `weighted`.
        """
        tables = [of(one) for one in weighted.found]
        value = tables[0]
        relative = 2 * self.solution.error + TOLERANCES.margin * weighted.found[0].error
        error = relative * float(np.abs(value).max(initial=0.0)) + np.zeros(value.shape)
        for other in tables[1:]:
            error = error + TOLERANCES.margin * abs(other - value)
        if weighted.control is not None:
            error = error + weighted.unsure * abs(of(weighted.control))
        note = ""
        if number == "max_pressure" and len(self.linearized.peaks) > 1:
            note = (
                "the largest pressure occurs at several places: the derivatives are those at one "
                "of them"
            )
        if number in STRESSES and len(self.linearized.values.max_stress) > 1:
            note = (
                "the largest stress occurs at several places: the derivatives are those at one of "
                "them"
            )
        return Derivative(value, error, note)

    def weights(self, number: str, index: tuple[int, ...]) -> Weighted:
        """Adjoint weights of `number` at a fixed value of the scene's control.
        The derivative of the number is the sum of these weights times heights and slopes of a
        change of the profile.

        index: index of the entry, if the number is an array. For the largest pressure and the
        largest stress, it may be the index of a place where they occur.
        """
        if self.refusal:
            raise SceneError(f"{self.refusal}: use `of(number, to=...)`", "number", number)
        if number == "first_yield":
            return self._first_yield()
        functional, control = self._at_load(number, index), self._control
        fields, unsure = self.solution.fields, 0.0
        if control is not None:
            of_control = control[1]
            of_number, error = self._by_load(number, index)
            unsure = (error + abs(of_number / of_control) * control[2]) / abs(of_control)
            functional = functional.plus(control[0], -of_number / of_control)
        variants, stressed = self.linearized.variants, number == "max_stress"
        at = index[0] if stressed and index else 0
        found = tuple(
            self._on(one, self._of_stress(one, functional, at=at) if stressed else functional)
            for one in variants
        )
        if control is None or not self.linearized.stated:
            return Weighted(found, None, 0.0)
        return Weighted(found, self._on(fields, control[0]), unsure)

    def _first_yield(self) -> Weighted:
        """Adjoint weights of the load of first yield.
        This load does not depend on the value of the control.
        """
        rise, error = self._by_load("max_stress", ())
        found = tuple(
            self._on(one, self._of_stress(one, self._none(), -1 / rise))
            for one in self.linearized.variants
        )
        if not self.linearized.stated:
            return Weighted(found, None, 0.0)
        return Weighted(found, found[0], error / abs(rise))

    def _of_stress(
        self, fields: Any, functional: Functional, factor: float = 1.0, at: int = 0
    ) -> Functional:
        """`functional` plus `factor` times the derivative of the largest stress.

        `at` is the index of the place of this stress.
        """
        stress = self.linearized.stress
        assert stress is not None
        point = stress.on(fields)[at]
        value, rise = (factor * one for one in point.transform)
        if point.y > 0:
            return replace(functional, inside=(complex(point.x, point.y), value, rise))
        # On the surface in contact, the transform F of the pressure p is (E*/2) f' - i p. Here f'
        # is the slope of the profile.
        along = 0.5 * self.solution.scene.E_star * value.real
        return replace(functional, peak=(point.x, value.imag), slope=(point.x, along))

    def _on(self, fields: Any, functional: Functional) -> Weights:
        tip = float(self.linearized.tips[0])
        of = full_weights if isinstance(fields, FullFields) else weights_of
        return of(fields, functional, tip)

    @property
    def refusal(self) -> str:
        """Why derivatives by all heights at once are not known for the solution; "" if known."""
        fields, law = self.solution.fields, self.solution.scene.law
        if law.kappa or isinstance(fields, ZoneFields) and fields.solved_zones.follow_ends:
            return (
                f"the law {law.name}: derivatives by all heights at once are available only "
                "without adhesion and without friction between elastically different bodies"
            )
        if isinstance(fields, FullFields) and not fields.problem.operator.is_plain:
            return (
                "full contact: derivatives by all heights at once are available only for a "
                "half-plane"
            )
        return ""

    def _none(self) -> Functional:
        count = len(self.solution.zones)
        return Functional(np.zeros((count, 2)), np.zeros(count))

    @cached_property
    def _control(self) -> tuple[Functional, float, float] | None:
        """(functional, derivative by the load, its error) of the controlled quantity.

        None if the load is given.
        """
        quantity = self.linearized.held.quantity
        if quantity is Quantity.LOAD:
            return None
        if quantity is Quantity.APPROACH:
            functional = self._at_load("approach", ())
        else:
            none, part = self._none(), 0.5 if quantity is Quantity.HALF_WIDTH else 1.0
            functional = replace(none, ends=np.full(none.ends.shape, part))
        return functional, *self.linearized.controlled(self.linearized.by_load)

    def _by_load(self, number: str, index: tuple[int, ...]) -> tuple[float, float]:
        """(derivative by the load, its error) of a number, or of one entry of an array."""
        by_load = self.linearized.by_load
        if number in ("max_pressure", "max_stress"):
            k = index[0] if index else 0
            found = getattr(by_load.values, number)[k], getattr(by_load.errors, number)[k]
        else:
            entry = Response(self.solution, by_load).of(number)
            found = np.asarray(entry.value)[index], np.asarray(entry.error)[index]
        return float(found[0]), float(found[1])

    def _at_load(self, number: str, index: tuple[int, ...]) -> Functional:
        """The functional whose value is the derivative of `number` at a fixed load."""
        none, solution, order = self._none(), self.solution, self.solution._order
        ends, loads = none.ends, none.loads
        if number in ("load", "mean_pressure", "max_stress"):
            return none
        if number == "approach":
            return replace(none, approach=1.0, tip=-1.0)
        if number == "mean_gap":
            return replace(none, approach=-1.0, mean=1.0)
        if number == "max_pressure":
            place = float(self.linearized.peaks[index[0] if index else 0])
            return replace(none, peak=(place, 1.0))
        if number == "zone_loads":
            loads[order[index[0]]] = 1.0
        elif number == "zone_widths":
            ends[order[index[0]]] = 1.0
        elif number == "zones":
            ends[order[index[0]], index[1]] = 1.0 if index[1] else -1.0
        elif number == "contact_fraction":
            period = solution.scene.period
            assert period is not None
            ends[:] = 1.0 / period
        else:
            ends[:] = self._of_stiffness()
        return none

    def _of_stiffness(self) -> Array:
        """Derivatives of the stiffness by outward motions of the ends, (n, 2) for n zones."""
        stiffness, E_star = self.solution.stiffness, self.solution.scene.E_star
        assert stiffness is not None
        k = self.linearized._intensities(self.solution.fields)
        return np.asarray(stiffness**2 * 2 * np.pi / E_star * k**2)
