"""Check of the attributes and methods of a scene's parts that users wrote.

`require_form` runs once, when a scene is made. It checks the attributes and the arguments that the
methods take, and names the first that is wrong. `AuthorMethod` checks what the methods return,
where they are called.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping
from math import isnan
from typing import Any, NamedTuple

import numpy as np

from contact.errors import SceneError
from contact.model.checks import as_array, checked_number, finite, of_author
from contact.model.controls.base import CONTROLS, Control, Held, Quantity
from contact.model.interactions.base import Interaction
from contact.model.laws.base import Law
from contact.model.profiles.base import Profile
from contact.model.substrates.base import Substrate


class Form(NamedTuple):
    """Form of an attribute: a function that tests a value, and a text that describes the allowed
    values.
    """

    holds: Callable[[Any], bool]
    allowed: str


def _is_number(value: Any) -> bool:
    return (
        isinstance(value, (int, float, np.integer, np.floating))
        and not isinstance(value, bool)
        and bool(np.isfinite(value))
    )


def _are_controls(value: Any) -> bool:
    return isinstance(value, (tuple, list)) and all(
        isinstance(name, str) and name in CONTROLS for name in value
    )


def _are_places(value: Any) -> bool:
    places = as_array(value)
    return bool(places.dtype.kind in "iuf" and places.ndim == 1 and np.isfinite(places).all())


def _is_flag(value: Any) -> bool:
    return isinstance(value, (bool, np.bool_))


def _is_text(value: Any) -> bool:
    return isinstance(value, str) and bool(value.strip())


def _is_not_negative(value: Any) -> bool:
    return _is_number(value) and bool(value >= 0)


def _is_length_or_none(value: Any) -> bool:
    return value is None or (_is_number(value) and bool(value > 0))


def _is_count(value: Any) -> bool:
    return isinstance(value, (int, np.integer)) and not isinstance(value, bool) and bool(value >= 0)


def _is_position(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isnan(value)


def _is_or_none(kind: type) -> Callable[[Any], bool]:
    return lambda value: value is None or isinstance(value, kind)


_NO_METHOD = "(a property, not a method)"
_FLAG = Form(_is_flag, f"True or False {_NO_METHOD}")
_TEXT = Form(_is_text, "a non-empty string")
_NOT_BELOW_0 = Form(_is_not_negative, f"a finite number >= 0 {_NO_METHOD}")
_LENGTH = Form(_is_length_or_none, f"None, or a length > 0 [m] {_NO_METHOD}")
_COUNT = Form(_is_count, "a whole number >= 0")
_NAMES = Form(_are_controls, f"a tuple of control names, each one of {', '.join(CONTROLS)}")
_TABLE = Form(
    _is_or_none(Mapping),  # type: ignore[type-abstract]
    'None, or a dictionary with the unit of each parameter, such as {"depth": "m"}',
)
_QUANTITY = Form(_is_or_none(Quantity), "None, or a contact.model.controls.Quantity")
_BARE = Form(_is_or_none(Law), "None, or a law, such as contact.Frictionless()")
_START = Form(_is_position, f"a position [m] {_NO_METHOD}")
_PLACES = Form(_are_places, f"a one-dimensional array of positions [m] {_NO_METHOD}")

# The forms of the attributes (`_ATTRIBUTES`) and the arguments of the methods (`_METHODS`) of each
# kind of part of a scene.
_ATTRIBUTES: dict[type, dict[str, Form]] = {
    Profile: {
        "name": _TEXT,
        "units": _TABLE,
        "x0": _START,
        "feature": _LENGTH,
        "exact_places": _FLAG,
        "breakpoints": _PLACES,
    },
    Interaction: {
        "name": _TEXT,
        "units": _TABLE,
        "allows": _NAMES,
        "datum": _LENGTH,
        "neighbours": _COUNT,
        **dict.fromkeys(("needs_period", "exact", "strip", "turns", "follows_isolated"), _FLAG),
    },
    Substrate: {"name": _TEXT, "units": _TABLE},
    Law: {
        "name": _TEXT,
        "units": _TABLE,
        "allows": _NAMES,
        "tension": _NOT_BELOW_0,
        "reach": _NOT_BELOW_0,
        "bare": _BARE,
        **dict.fromkeys(("turns", "pulls", "convex", "by_gaps", "full_contact"), _FLAG),
    },
    Control: {"name": _TEXT, "unit": _TEXT, "quantity": _QUANTITY, "falls": _FLAG},
}
_METHODS: dict[type, dict[str, tuple[str, ...]]] = {
    Profile: {"height": ("x",), "slope": ("x",), "slope_conjugate": ("x",)},
    Interaction: {
        "kernel": ("period", "unit"),
        "symbol": ("q",),
        "columns": ("period", "centre"),
        "side_conditions": ("period",),
        "placed_columns": ("period", "centre", "scaled"),
        "placed_conditions": ("period", "scaled"),
    },
    Substrate: {"symbol": ("q",)},
    Law: {
        "intensity": ("E_star",),
        "without_range": ("share",),
        "surface_energy": ("fields", "width"),
        "refuses": ("scene",),
        "fault": ("fields", "load"),
    },
    Control: {"signed": ("scene",), "check": ("scene",), "held": ("scene",), "of": ("solution",)},
}


def is_own(part: Any) -> bool:
    """Whether the class of a part was written by a user: it is not in the package `contact`."""
    return not type(part).__module__.startswith("contact.")


def require_form(kind: type, part: Any) -> None:
    """Raise a SceneError that names the first attribute or method of a wrong form. `kind` is the
    base class of the part.
    """
    if not is_own(part):
        return
    require_calls(kind, part)
    require_attributes(kind, part)


def require_calls(kind: type, part: Any) -> None:
    """Raise a SceneError that names the first method that does not accept its arguments."""
    place = kind.__name__.lower()
    for name, arguments in _METHODS[kind].items():
        with of_author(f"{place}.{name}", place):
            method = getattr(part, name)
        _require_call(method, f"{place}.{name}", arguments)


def require_attributes(kind: type, part: Any) -> None:
    """Raise a SceneError that names the first attribute of a part that has a wrong form."""
    place = kind.__name__.lower()
    for name, form in _ATTRIBUTES[kind].items():
        with of_author(f"{place}.{name}", place):
            value = getattr(part, name)
        if not form.holds(value):
            raise SceneError.of(f"{place}.{name}", value, form.allowed)


def _require_call(method: Any, place: str, arguments: tuple[str, ...]) -> None:
    allowed = f"a method that is called as {place}({', '.join(arguments)})"
    if not callable(method):
        raise SceneError.of(place, method, allowed)
    try:
        inspect.signature(method).bind(*arguments)
    except TypeError as error:
        raise SceneError(
            f"{place} is refused: it must be {allowed} ({error})", place, method, allowed
        ) from error
    except ValueError:  # the arguments of some functions written in C are unknown
        return


def require_conjugate(profile: Profile) -> None:
    """Raise SceneError if the Hilbert transform of the slope has another shape than its argument
    x.
    """
    if profile.period is None:
        return
    x = profile.x0 + profile.period * np.random.default_rng(0).random((2, 3))
    method = AuthorMethod("profile.slope_conjugate(x)", "slope_conjugate")
    value = method.value(profile.slope_conjugate, x.copy())
    array = np.zeros(x.shape) if value is None else as_array(value)
    if array.dtype.kind not in "iuf" or array.shape != x.shape:
        raise SceneError.of(
            method.what, value, f"None, or real numbers in an array of the shape of x, {x.shape}"
        )


class AuthorMethod(NamedTuple):
    """Calls a method of a user's class, and checks the value that the method returns.

    what: how messages name the method; part: the part of the scene that has it.
    """

    what: str
    part: str

    def value(self, method: Callable[..., Any], *arguments: Any) -> Any:
        """The value that the method returns; SceneError if the method raises an exception.

        Methods of `contact` itself are called directly, which saves a few microseconds.
        """
        owner = getattr(method, "__self__", None)
        if owner is not None and not is_own(owner):
            return method(*arguments)
        with of_author(self.what, self.part):
            value = method(*arguments)
        return value

    def number(
        self, method: Callable[..., Any], *arguments: Any, allowed: str = "a finite real number"
    ) -> float:
        """The finite number that the method returns; SceneError if it returns anything else."""
        return checked_number(
            self.what, self.value(method, *arguments), allowed, lambda number: True
        )

    def text(self, method: Callable[..., Any], *arguments: Any) -> str:
        """The text that the method returns; empty if it returns None."""
        value = self.value(method, *arguments)
        if value is None or isinstance(value, str):
            return value or ""
        raise SceneError.of(self.what, value, "a text that gives the reason, or None")

    def rows(self, kind: type, method: Callable[..., Any], *arguments: Any) -> tuple[Any, ...]:
        """The tuple of objects that the method returns, all of the class `kind`."""
        value = self.value(method, *arguments)
        if isinstance(value, Iterable):
            value = tuple(value)
            if all(isinstance(item, kind) for item in value):
                return value
        raise SceneError.of(self.what, value, f"a tuple of sie.{kind.__name__} objects")


def require_law(law: Law, E_star: float) -> None:
    """Raise SceneError if the intensity or the tension of a law has a value that adhesion cannot
    have.
    """
    allowed = "finite [Pa m^(1/2)]"
    if not is_own(law):
        finite("law.intensity(E_star)", law.intensity(E_star), allowed)
        return
    method = AuthorMethod("law.intensity(E_star)", "law")
    intensity = method.number(law.intensity, E_star, allowed=allowed)
    if intensity > 0:
        why = "a free end of a zone cannot carry infinite pressure"
        raise SceneError.of(method.what, intensity, f"{allowed} and at most 0: {why}")
    if intensity < 0 and not law.pulls:
        raise SceneError.of(
            "law.pulls",
            law.pulls,
            f"True, since the law's intensity {intensity:.6g} means tension at every end of a zone",
        )
    if (law.tension > 0) != (law.reach > 0):
        raise SceneError.of(
            "law.reach",
            law.reach,
            f"above 0 [m] if the tension is above 0, and 0 if it is 0 (tension = {law.tension!r})",
        )


def held_by(control: Control, scene: Any) -> Held | None:
    """The quantity that the solver prescribes under a control.
    None if the solver must search for the load at which the controlled quantity has its value.

    Raises SceneError if the control defines neither `held` nor `of`.
    """
    if not is_own(control):
        return control.held(scene)
    method = AuthorMethod("control.held(scene)", "control")
    held = method.value(control.held, scene)
    if held is None and type(control).of is Control.of:
        allowed = (
            "defined: it returns the controlled quantity of a solution (or define `held` or "
            "`quantity`)"
        )
        raise SceneError.of("control.of(solution)", None, allowed)
    if held is not None and not (isinstance(held, Held) and isinstance(held.quantity, Quantity)):
        raise SceneError.of(
            method.what, held, "None, or contact.model.controls.Held(Quantity..., value)"
        )
    return held
