"""Scene files in TOML: reading a scene from one, and writing a scene as the text of one.

A scene has the tables [profile], [material], [interaction] and [control]. It may have [counter], a
rough counter body, and [substrate] and [law], if they are not the default ones. The table
[tangential] is read by `contact slip` and is no part of the scene. The keys of a table are the
arguments of the Python object that the table describes, in the same units. So every registered
profile, interaction, substrate or law can be read. File names are relative to the scene file.
"""

import json
from collections.abc import Callable, Mapping
from numbers import Integral, Real
from os import PathLike
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from contact.errors import SceneError
from contact.extras import require
from contact.model.checks import one_of, text
from contact.model.controls import CONTROLS, TURNING, fields_under
from contact.model.profiles.base import Profile
from contact.model.profiles.combined import PLACEMENT_KEYS, Combined
from contact.model.registry import CONTROLS as REGISTERED
from contact.model.registry import (
    INTERACTIONS,
    LAWS,
    PROFILES,
    SUBSTRATES,
    Registry,
    from_table,
    parameters,
)
from contact.model.scene import E_star, Scene
from contact.model.tangential import Tangential

Table = Mapping[str, Any]
T = TypeVar("T")

TABLES = ("profile", "material", "interaction", "control")
# Tables of a scene file that may be left out, with the registries of their classes.
OPTIONAL = {"substrate": SUBSTRATES, "law": LAWS}
# The table of a rough counter body. It has the keys of [profile], and further keys for the position
# of the body.
COUNTER = "counter"
# The table of the friction, with a tangential load or a creepage.
TANGENTIAL = "tangential"
MODULI = ("E_star", "E1", "nu1", "E2", "nu2")


def load_scene(path: str | PathLike[str]) -> Scene:
    """Read a scene from a file. An error in the file is a SceneError that names the file, the
    table and the key.

    Parameters
    ----------
    path : str or path
        Name of a TOML file; docs/scenes.md has its tables and keys. Files that it names are looked
        for from its folder.

    Returns
    -------
    Scene

    Raises
    ------
    SceneError
        If the file cannot be read, is no TOML, or a table or key is wrong.

    Examples
    --------
    >>> import contact, pathlib, tempfile
    >>> text = '''
    ... profile = {shape = "sinusoid", amplitude = 1e-6, period = 1e-4}
    ... material = {E_star = 1.1e11}
    ... interaction = {model = "periodic"}
    ... control = {mean_pressure = 1.7e9}
    ... '''
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = pathlib.Path(folder) / "wave.toml"
    ...     _ = file.write_text(text)
    ...     scene = contact.load_scene(file)
    >>> scene.profile
    Sinusoid(amplitude=1e-06, period=0.0001)
    """
    return _under(f"{path}:", scene_from_tables, load_tables(path), Path(path).parent)


def load_tables(path: str | PathLike[str]) -> Table:
    """The tables of a scene file; SceneError if the file cannot be read or is not TOML."""
    if not isinstance(path, (str, PathLike)):
        raise SceneError.of("path", path, "the name of a scene file")
    path = Path(path)
    try:
        written = path.read_bytes()
    except (OSError, ValueError) as error:
        raise SceneError(
            f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}"
        ) from error
    # The user may have given a measured trace instead of a scene file.
    of_trace = (
        f" with a scene (for a trace, `contact trace {path.name} --scene NEW.toml` writes one)"
    )
    return read_tables(written, str(path), "" if path.suffix.lower() == ".toml" else of_trace)


def read_scene(text: bytes, name: str, directory: str | PathLike[str] = ".") -> Scene:
    """The scene that a TOML text describes.

    name: the name of the text in messages.
    directory: the folder to which file names are relative.
    """
    return _under(f"{name}:", scene_from_tables, read_tables(text, name), directory)


def read_tables(text: bytes, name: str, hint: str = "") -> Table:
    """The tables of a TOML text; SceneError if the text is not TOML.
    `hint` is advice that the error message then contains.
    """
    try:
        tables: Table = require("tomllib").loads(text.decode("utf-8"))
    except ValueError as error:
        raise SceneError(f"{name}: is not a TOML file{hint}: {error}") from error
    return tables


def tangential_from_tables(tables: Table) -> Tangential:
    """The `Tangential` that the table [tangential] gives; SceneError if there is no such table."""
    if TANGENTIAL not in tables:
        raise SceneError(
            "[tangential] is missing: add this table, with friction and with load or creepage",
            TANGENTIAL,
        )
    material = tables.get("material", {})
    return _under(f"[{TANGENTIAL}]", Tangential.from_table, tables[TANGENTIAL], material)


def scene_from_tables(tables: Table, directory: str | PathLike[str] = ".") -> Scene:
    """The scene that these tables describe; file names in them are relative to `directory`."""
    if not isinstance(tables, Mapping):
        raise SceneError.of("tables", tables, f"a mapping with the keys {', '.join(TABLES)}")
    for name in tables:
        one_of("table", name, (*TABLES, COUNTER, *OPTIONAL, TANGENTIAL))
    missing = [f"[{name}]" for name in TABLES if name not in tables]
    if missing:
        raise SceneError(
            f"{' and '.join(missing)} missing: a scene needs the tables {', '.join(TABLES)}"
        )
    others_given = (name for name in (COUNTER, *OPTIONAL, TANGENTIAL) if name in tables)
    for name in (*TABLES, *others_given):
        if not isinstance(tables[name], Mapping):
            raise SceneError.of(name, tables[name], f"a table, written [{name}]")
    if TANGENTIAL in tables:
        tangential_from_tables(tables)
    profile = _under("[profile]", _read_profile, tables["profile"], Path(directory))
    if COUNTER in tables:
        profile = _under(f"[{COUNTER}]", _read_counter, tables[COUNTER], Path(directory), profile)
    modulus = _under("[material]", _read_material, tables["material"])
    if "law" in tables:
        law = _under("[law]", _read_law, tables["law"], tables["material"])
        tables = {**tables, "law": law}
    model = _under("[interaction]", _read_model, tables["interaction"], INTERACTIONS)
    others = {
        name: _under(f"[{name}]", _read_model, tables[name], known)
        for name, known in OPTIONAL.items()
        if name in tables
    }
    control = _under("[control]", _read_control, tables["control"])
    try:
        return Scene(profile, modulus, model, **others, **control)
    except SceneError as error:
        raise _placed(error, tables) from error


def _read_profile(table: Table, directory: Path) -> Profile:
    shape, parameters = _named(table, "shape")
    return PROFILES.find(shape, "shape").from_table(parameters, directory)


def _read_counter(table: Table, directory: Path, profile: Profile) -> Profile:
    shape = dict(table)
    placement = {key: shape.pop(key) for key in PLACEMENT_KEYS if key in table}
    return Combined(profile, _read_profile(shape, directory), **placement)


def _read_material(table: Table) -> float:
    for name in table:
        one_of("key", name, MODULI)
    if "E_star" in table:
        if len(table) > 1:
            others = ", ".join(name for name in table if name != "E_star")
            raise SceneError(
                f"E_star and {others} are given: give only E_star, or only the moduli of the bodies"
            )
        return table["E_star"]
    for name in ("E1", "nu1"):
        if name not in table:
            raise SceneError(
                f"{name} is missing: give E_star, or E1 and nu1 (with E2 and nu2 if the "
                "counter-body is elastic)"
            )
    return E_star(**table)


def _read_law(table: Table, moduli: Table) -> Table:
    """The table of a law, with the parameters that follow from the moduli of the bodies."""
    model, given = _named(table, "model")
    completed: Table = LAWS.find(model, "model").completed(given, moduli)
    return {"model": model, **completed}


def _read_model(table: Table, registry: Registry) -> Any:
    model, parameters = _named(table, "model")
    return from_table(registry, model, parameters, "model")


def _read_control(table: Table) -> dict[str, Any]:
    if any(name not in CONTROLS for name in table):
        for name in table:
            one_of("key", name, (*REGISTERED.all(), *TURNING))
    controls = [name for name in table if name not in TURNING]
    if len(controls) != 1:
        given = " and ".join(controls) or "nothing"
        raise SceneError(f"{given} given: give exactly one of {', '.join(CONTROLS)}")
    return fields_under(controls[0], table[controls[0]]) | {
        name: table[name] for name in TURNING if name in table
    }


def _named(table: Table, key: str) -> tuple[str, dict[str, Any]]:
    """The name that stands under `key` in a table, and the table without this key."""
    if key not in table:
        raise SceneError(
            f"{key} is missing: add the name of the {key} to which the other keys belong"
        )
    rest = dict(table)
    return text(key, rest.pop(key)), rest


def _placed(error: SceneError, tables: Table) -> SceneError:
    """A copy of the error that also names the table and the key of the wrong value."""
    table = next(
        (name for name in tables if error.field == name or error.field in tables[name]), None
    )
    if table is None or error.allowed is None:
        return error
    names = {
        **dict.fromkeys(("profile", COUNTER), ("shape", None)),
        **dict.fromkeys(("interaction", *OPTIONAL), ("model", None)),
    }
    key, value = names.get(table, (error.field, error.value))
    if value is None:
        value = tables[table].get(key)
    assert key is not None
    named = SceneError.of(key, value, error.allowed)
    return SceneError(f"[{table}] {named}", error.field, error.value, error.allowed)


def _under(place: str, read: Callable[..., T], *given: Any) -> T:
    """Return the result of `read`. If `read` raises a SceneError, its message gets `place` in
    front.
    """
    try:
        return read(*given)
    except SceneError as error:
        raise SceneError(f"{place} {error}", error.field, error.value, error.allowed) from error


def to_toml(scene: Scene, written: Mapping[str, Table] | None = None) -> str:
    """The text of a scene file that describes this scene.

    written: tables of the scene file from which the scene was read. If [profile] or [counter] names
    a file of points, the text names this file, too; otherwise it has all points. The tables
    [material] and [law] keep their keys, such as E1 and nu1 in place of E_star. Raises SceneError
    if a part has no name that a scene file could use.
    """
    bodies = scene.profile.bodies
    parts = (
        (scene.interaction, INTERACTIONS),
        (scene.substrate, SUBSTRATES),
        (scene.law, LAWS),
        (scene.given, REGISTERED),
    )
    for part, registry in (*((body, PROFILES) for body in bodies.values()), *parts):
        if part is not None and registry.all().get(getattr(part, "name", "")) is not type(part):
            raise SceneError.of(
                registry.kind,
                type(part).__name__,
                f"registered under a name, for example by contact.register_{registry.kind}",
            )
    text_tables = tables(scene)
    for place, table in (written or {}).items():
        if place == "material":
            text_tables[place] = dict(table)
            continue
        if place == "law":
            present = text_tables.get(place, {})
            text_tables[place] = {key: present.get(key, table[key]) for key in table}
            continue
        own = {"shape", *bodies[place].parameters()}
        rest = {key: value for key, value in text_tables[place].items() if key not in own}
        text_tables[place] = {**table, **rest}
    return "\n".join(f"[{place}]\n{_lines(table)}" for place, table in text_tables.items())


def tables(scene: Scene) -> dict[str, dict[str, Any]]:
    """Tables of a scene file that describe the scene, without the default substrate and law."""
    parts = {place: getattr(scene, place) for place in ("interaction", "substrate", "law")}
    given = {
        place: part
        for place, part in parts.items()
        if place == "interaction" or part != type(scene).__dict__[place]
    }
    name, value = scene.control
    return {
        **scene.profile.tables(),
        "material": {"E_star": scene.E_star},
        **{place: {"model": part.name, **parameters(part)} for place, part in given.items()},
        "control": {name: value, **scene.turning},
    }


def _lines(table: Table) -> str:
    return "".join(f"{key} = {toml(value)}\n" for key, value in table.items() if value is not None)


def toml(value: Any) -> str:
    """The TOML text of a value; numbers keep all their digits."""
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (Integral, np.integer)):
        return str(int(value))
    if isinstance(value, Real):
        return _number(float(value))
    if isinstance(value, (np.ndarray, list, tuple)):
        return f"[{', '.join(toml(item) for item in value)}]"
    if isinstance(value, str):
        # A JSON string is also a valid TOML string.
        return json.dumps(value, ensure_ascii=False)
    raise SceneError.of(
        "value",
        value,
        "a number, a text, true or false, or a list of these, as a scene file requires",
    )


def _number(value: float) -> str:
    """A number as people write it: 2.1e11, not 210000000000.0."""
    plain = repr(value)
    if not plain.endswith("000000.0"):
        return plain
    digits, exponent = plain[:-2].rstrip("0"), len(plain[:-2].lstrip("-")) - 1
    sign, digits = ("-", digits[1:]) if digits.startswith("-") else ("", digits)
    rest = f".{digits[1:]}" if len(digits) > 1 else ".0"
    return f"{sign}{digits[0]}{rest}e{exponent}"
