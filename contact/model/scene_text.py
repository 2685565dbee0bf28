"""A scene as the text of a scene file: what `contact.load_scene` reads back as the same scene."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from numbers import Integral, Real
from typing import Any

import numpy as np

from contact.errors import SceneError
from contact.model.controls import TURNING
from contact.model.registry import CONTROLS, INTERACTIONS, LAWS, PROFILES, SUBSTRATES, Registry
from contact.model.scene import Scene


def to_toml(scene: Scene, written: Mapping[str, Mapping[str, Any]] | None = None) -> str:
    """The text of a scene. written: tables [profile] and [counter] as a file gave them, where they name a file of points; else all numbers
    are written.

    Raises SceneError where a part has no name that a scene file could call it by.
    """
    tables = []
    for place, told in scene.profile.tables().items():
        body = scene.profile.bodies[place]
        own = _named(body, PROFILES, "shape", body.parameters())
        stands = {key: value for key, value in told.items() if key not in own}
        tables.append((place, {**((written or {}).get(place) or own), **stands}))
    tables.append(("material", {"E_star": scene.E_star}))
    parts = (("interaction", INTERACTIONS), ("substrate", SUBSTRATES), ("law", LAWS))
    for place, registry in parts:
        part = getattr(scene, place)
        if place == "interaction" or part != type(scene).__dict__[place]:
            tables.append((place, _named(part, registry, "model", _fields(part))))
    if scene.given is not None:
        _named(scene.given, CONTROLS, "", {})
    name, value = scene.control
    turning = {key: getattr(scene, key) for key in TURNING if getattr(scene, key) is not None}
    tables.append(("control", {name: value, **turning}))
    return "\n".join(f"[{place}]\n{_lines(table)}" for place, table in tables)


def _named(part: Any, registry: Registry, key: str, parameters: Mapping[str, Any]) -> dict[str, Any]:
    name = getattr(part, "name", "")
    if registry.all().get(name) is not type(part):
        raise SceneError.of(registry.kind, type(part).__name__, f"registered under a name, as by contact.register_{registry.kind}")
    return {key: name, **parameters}


def _fields(part: Any) -> dict[str, Any]:
    """What a part was made of, where it is not what it is without being given."""
    if not dataclasses.is_dataclass(part):
        return {}
    fields = (field for field in dataclasses.fields(part) if field.init)
    return {field.name: value for field in fields if (value := getattr(part, field.name)) is not field.default}


def _lines(table: Mapping[str, Any]) -> str:
    return "".join(f"{key} = {toml(value)}\n" for key, value in table.items() if value is not None)


def toml(value: Any) -> str:
    """A value as TOML writes it; numbers to all their digits."""
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (Integral, np.integer)):
        return str(int(value))
    if isinstance(value, Real):
        return repr(float(value))
    if isinstance(value, (np.ndarray, list, tuple)):
        return f"[{', '.join(toml(item) for item in value)}]"
    if isinstance(value, str):
        # The strings of JSON are strings of TOML.
        return json.dumps(value, ensure_ascii=False)
    raise SceneError.of("value", value, "a number, a text, true or false, or a list of them: a scene file holds nothing else")
