"""A scene as the text of a scene file: what `contact.load_scene` reads back as the same scene."""

import dataclasses
import json
from collections.abc import Mapping
from numbers import Integral, Real
from typing import Any

import numpy as np

from contact.errors import SceneError
from contact.model.controls import TURNING
from contact.model.registry import CONTROLS, INTERACTIONS, LAWS, PROFILES, SUBSTRATES
from contact.model.scene import Scene


def to_toml(scene: Scene, written: Mapping[str, Mapping[str, Any]] | None = None) -> str:
    """The text of a scene. written: tables [profile] and [counter] as a file gave them, where they name a file of points; else all numbers
    are written.

    Raises SceneError where a part has no name that a scene file could call it by.
    """
    bodies = scene.profile.bodies
    parts = ((scene.interaction, INTERACTIONS), (scene.substrate, SUBSTRATES), (scene.law, LAWS), (scene.given, CONTROLS))
    for part, registry in (*((body, PROFILES) for body in bodies.values()), *parts):
        if part is not None and registry.all().get(getattr(part, "name", "")) is not type(part):
            raise SceneError.of(registry.kind, type(part).__name__, f"registered under a name, as by contact.register_{registry.kind}")
    told = tables(scene)
    for place, table in (written or {}).items():
        own = {"shape", *bodies[place].parameters()}
        told[place] = {**table, **{key: value for key, value in told[place].items() if key not in own}}
    return "\n".join(f"[{place}]\n{_lines(table)}" for place, table in told.items())


def tables(scene: Scene) -> dict[str, dict[str, Any]]:
    """What a scene file says of it, by table; of a substrate and a law nothing where they are the usual ones."""
    parts = {place: getattr(scene, place) for place in ("interaction", "substrate", "law")}
    given = {place: part for place, part in parts.items() if place == "interaction" or part != type(scene).__dict__[place]}
    name, value = scene.control
    return {
        **scene.profile.tables(),
        "material": {"E_star": scene.E_star},
        **{place: {"model": part.name, **parameters(part)} for place, part in given.items()},
        "control": {name: value, **{turn: getattr(scene, turn) for turn in TURNING if getattr(scene, turn) is not None}},
    }


def parameters(part: Any) -> dict[str, Any]:
    """What to give the class of an interaction, a substrate or a law, by name, to make it again."""
    return {f.name: getattr(part, f.name) for f in dataclasses.fields(part) if f.init} if dataclasses.is_dataclass(part) else {}


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
