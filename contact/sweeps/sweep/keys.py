"""The keys of a scene that a sweep can vary, and scenes in which keys have other values.

A key is written as TABLE.KEY with the names of scene files, such as "profile.amplitude".
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from contact.errors import SceneError
from contact.model.checks import one_of
from contact.model.controls import TURNING, fields_under, known_controls
from contact.model.registry import parameters, remade
from contact.model.scene import Scene

Value = float | int | str

# Parts of a scene that have one table in a scene file. The profile may have two, so it is left out.
PARTS = ("interaction", "substrate", "law")
MODULUS = "material.E_star"
# The branch is not a key of scene files, since it chooses among several equilibria of one scene.
BRANCH = "branch"
BRANCHES = ("advancing", "receding")


@dataclass(frozen=True)
class Axis:
    """One varied key of a grid, its values in the given order, and their unit if it is known."""

    key: str
    values: tuple[Value, ...]
    unit: str = ""

    @property
    def name(self) -> str:
        """The key as the name of a dimension of the table, with "_" instead of the dot.
        In xarray such a dimension is also an attribute, as in `table.profile_amplitude`.
        """
        return name_of(self.key)

    @property
    def control(self) -> str:
        """The name of the control that this key varies; "" if the key is no control."""
        table, _, name = self.key.partition(".")
        return name if table == "control" and name not in TURNING else ""


def name_of(key: str) -> str:
    """A key of a scene, such as "profile.amplitude", as the name of a dimension."""
    return re.sub(r"\W", "_", key)


def axes_of(scene: Scene, over: Mapping[str, Any]) -> tuple[Axis, ...]:
    """The axes of a grid; raises SceneError for unknown keys, repeated values, or two controls."""
    if not isinstance(over, Mapping) or not over:
        raise SceneError.of(
            "over",
            over,
            "a mapping of one or more keys, such as 'control.load' or 'profile.amplitude', "
            "to their values",
        )
    known = keys_of(scene)
    for key in over:
        one_of("key", key, known)
    axes = tuple(
        Axis(key, _values(key, given, known[key]), _unit(scene, key)) for key, given in over.items()
    )
    for axis in axes:
        if axis.key == BRANCH and set(axis.values) - set(BRANCHES):
            allowed = f"a list that contains {' or '.join(BRANCHES)}, or both"
            raise SceneError.of(BRANCH, over[BRANCH], allowed)
    controls = [axis.key for axis in axes if axis.control]
    if len(controls) > 1:
        raise SceneError.of(
            "over", " and ".join(controls), "only one control: the others follow from it"
        )
    turning = [axis.key for axis in axes if axis.key.removeprefix("control.") in TURNING]
    if len(turning) > 1:
        raise SceneError.of(
            "over", " and ".join(turning), "only one of them: the other follows from it"
        )
    return axes


def keys_of(scene: Scene) -> dict[str, Any]:
    """Keys that can be varied, with their present values; keys of arrays cannot be varied."""
    known: dict[str, Any] = {MODULUS: scene.E_star}
    for table, values in tables(scene).items():
        for name, value in values.items():
            if value is None or np.ndim(value) == 0:
                known[f"{table}.{name}"] = value
    given, value = scene.control
    controls = {name: value if name == given else None for name in known_controls(scene.given)}
    if not scene.law.equilibria.unique:
        known[BRANCH] = BRANCHES[0]
    return known | {
        f"control.{name}": at
        for name, at in (controls | {name: getattr(scene, name) for name in TURNING}).items()
    }


def tables(scene: Scene) -> dict[str, dict[str, Any]]:
    """The parameters of the profile and of the other parts of a scene, by table and name."""
    shapes = {
        table: {name: value for name, value in values.items() if name != "shape"}
        for table, values in scene.profile.tables().items()
    }
    # Measured traces also have the parameters of their preparation.
    for table, body in scene.profile.bodies.items():
        shapes[table] = {**body.preparation, **shapes[table]}
    return shapes | {table: parameters(getattr(scene, table)) for table in PARTS}


def numbers_of(scene: Scene) -> dict[str, Any]:
    """The modulus, and all numbers and arrays of numbers of the profile and the law, by key."""
    found: dict[str, Any] = {MODULUS: scene.E_star}
    for table, values in tables(scene).items():
        for name, value in values.items():
            if table not in ("interaction", "substrate") and all(
                isinstance(one, (int, float, np.number)) and not isinstance(one, bool)
                for one in np.asarray(value, dtype=object).ravel()
            ):
                found[f"{table}.{name}"] = value
    return found


def varied(scene: Scene, settings: Mapping[str, Value]) -> Scene:
    """The scene with other values of some keys. A varied control replaces the scene's control."""
    changed: dict[str, Any] = {}
    others: dict[str, dict[str, Value]] = {}
    for key, value in settings.items():
        table, _, name = key.partition(".")
        if key == BRANCH:
            continue
        if key == MODULUS:
            changed["E_star"] = value
        elif table == "control":
            changed |= (
                {**dict.fromkeys(TURNING), name: value}
                if name in TURNING
                else fields_under(name, float(value), scene.given)
            )
        else:
            others.setdefault(table, {})[name] = value
    # All values of a part, such as the law, are set at once. If set one by one, they might
    # contradict each other.
    for table in PARTS:
        if table in others:
            changed[table] = remade(getattr(scene, table), others[table])
    if any(table in scene.profile.bodies for table in others):
        changed["profile"] = scene.profile.varied(others)
    return replace(scene, **changed)


def _values(key: str, given: Any, present: Any) -> tuple[Value, ...]:
    """The values of a key, after a check: at least one, all distinct, all numbers or all words.

    They are integers if the parameter is an integer.
    """
    allowed = "a list of distinct finite numbers, or of distinct words"
    if (
        isinstance(given, str)
        or not (isinstance(given, Sequence) or (isinstance(given, np.ndarray) and given.ndim == 1))
        or not len(given)
    ):
        raise SceneError.of(key, given, allowed)
    whole = isinstance(present, int) and not isinstance(present, bool)
    values = tuple(_value(value, whole) for value in given)
    if None in values or len({type(v) is str for v in values}) > 1:
        raise SceneError.of(key, given, allowed)
    twice = [value for place, value in enumerate(values) if value in values[:place]]
    if twice:
        raise SceneError.of(key, given, f"{allowed}: {twice[0]!r} is given twice")
    return tuple(value for value in values if value is not None)


def _value(value: Any, whole: bool) -> Value | None:
    if isinstance(value, str):
        return str(value)
    if (
        isinstance(value, (bool, np.bool_))
        or not isinstance(value, (int, float, np.integer, np.floating))
        or not np.isfinite(value)
    ):
        return None
    return int(value) if whole and value == int(value) else float(value)


def _unit(scene: Scene, key: str) -> str:
    """The unit of a key, as the key's class declares it; "" if the key has no unit."""
    table, _, name = key.partition(".")
    if key == BRANCH:
        return ""
    if key == MODULUS:
        return "Pa"
    if table == "control":
        return TURNING.get(name) or str(known_controls(scene.given)[name].unit)
    body = scene.profile.bodies.get(table)
    for part in (getattr(scene, table),) if body is None else (body, scene.profile):
        units = getattr(type(part), "units", {})
        if isinstance(units, Mapping) and name in units:
            return str(units[name])
    return ""
