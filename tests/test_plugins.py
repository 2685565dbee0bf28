"""User-defined profiles, interactions, substrates, laws and side conditions, each in one file
outside the package.

They can be imported, named in a scene file, or found in an installed package. Their solutions
agree with closed forms.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import contact
from contact.model import registry

FOLDER = Path(__file__).parents[1] / "examples"
REGISTRIES = {
    "profile": registry.PROFILES,
    "interaction": registry.INTERACTIONS,
    "substrate": registry.SUBSTRATES,
    "law": registry.LAWS,
}
# For each file: (kind, name, class, keys in a scene file). A side condition has no name of its
# own, because an interaction brings it.
OWN: dict[str, tuple[str, str, str, dict[str, Any]]] = {
    "own_profile": ("profile", "rounded-wedge", "RoundedWedge", {"tangent": 0.05, "r": 1e-5}),
    "own_interaction": ("interaction", "bed", "Bed", {"eps": 0.5}),
    "own_substrate": (
        "substrate",
        "coats",
        "Coats",
        {"thicknesses": [1e-6, 2e-6], "moduli": [2.0, 4.0]},
    ),
    "own_law": ("law", "adhesive", "Adhesive", {"work": 0.05}),
    "own_condition": ("interaction", "surrounded", "Surrounded", {"share": 0.4}),
}


def loaded(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"plugins_{name}", FOLDER / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(autouse=True)
def names() -> Iterator[None]:
    """The names that a test registers are removed after the test."""
    before = {kind: set(known.all()) for kind, known in REGISTRIES.items()}
    yield
    for kind, known in REGISTRIES.items():
        for name in set(known.all()) - before[kind]:
            known.forget(name)


class Package:
    """Stand-in for the entry point of an installed package. It has the name of a plug-in, and
    loads the class from the module of the plug-in.
    """

    def __init__(self, file: str) -> None:
        self.file, (_, self.name, self.cls, _) = file, OWN[file]

    def load(self) -> Any:
        return getattr(loaded(self.file), self.cls)


def table_of(name: str, key: str, values: dict[str, Any]) -> str:
    return "\n".join(
        [f"{key} = {name!r}".replace("'", '"'), *(f"{k} = {v!r}" for k, v in values.items())]
    )


def scene_file(file: str, folder: Path) -> Path:
    """The path of a scene file that names the plug-in."""
    kind, name, _, values = OWN[file]
    tables = {
        "profile": 'shape = "sinusoid"\namplitude = 1e-6\nperiod = 1e-4',
        "material": "E_star = 1e9",
        "interaction": f'model = "{"isolated" if kind == "profile" else "periodic"}"',
        "control": "load = 100.0",
    } | {kind: table_of(name, "shape" if kind == "profile" else "model", values)}
    path = folder / "scene.toml"
    path.write_text(
        "".join(f"[{table}]\n{lines}\n" for table, lines in tables.items()), encoding="utf-8"
    )
    return path


@pytest.mark.parametrize("file", OWN)
def test_a_plug_in_is_made_in_python_by_its_class_and_by_its_name(file: str) -> None:
    kind, name, cls, values = OWN[file]
    module = loaded(file)
    assert getattr(contact, kind)(name, **values) == getattr(module, cls)(**values)


@pytest.mark.parametrize("file", OWN)
def test_a_scene_file_that_names_a_plug_in_is_solved_as_the_scene_in_python(
    file: str, tmp_path: Path
) -> None:
    kind, _, cls, values = OWN[file]
    module = loaded(file)
    read = contact.load_scene(scene_file(file, tmp_path))
    parts: dict[str, Any] = {
        "profile": contact.Sinusoid(1e-6, 1e-4),
        "interaction": contact.Periodic(),
    }
    parts |= {"interaction": contact.Isolated()} if kind == "profile" else {}
    made = contact.Scene(**(parts | {kind: getattr(module, cls)(**values)}), E_star=1e9, load=100.0)
    assert read == made
    solution = contact.solve(read)
    assert solution.certificate.holds and solution.error <= 1e-8
    assert np.array_equal(solution.zones, contact.solve(made).zones)


@pytest.mark.parametrize("file", OWN)
def test_an_installed_package_brings_a_plug_in_to_a_scene_file(
    file: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kind, name, _, _ = OWN[file]
    known = REGISTRIES[kind]
    asked: list[str] = []

    def entry_points(group: str) -> list[Package]:
        asked.append(group)
        return [Package(file)] if group == known.group else []

    monkeypatch.setattr(registry, "entry_points", entry_points)
    monkeypatch.setattr(known, "_plugins_loaded", False)
    assert contact.solve(contact.load_scene(scene_file(file, tmp_path))).certificate.holds
    assert asked == [f"contact.{kind}s"] and name in known.all()


def test_the_bed_carries_the_load_of_its_closed_form() -> None:
    solution, closed = loaded("own_interaction").main()
    assert solution.load == pytest.approx(closed, rel=1e-12)
    assert solution.load != pytest.approx(closed * (1 + 1e-11), rel=1e-12)


def test_the_coated_body_comes_into_full_contact_at_the_pressure_of_its_symbol() -> None:
    body, q = loaded("own_substrate").Coats((1e-6, 2e-6), (2.0, 4.0)), 2 * np.pi / 1e-4
    full = contact.Scene(
        contact.Sinusoid(1e-6, 1e-4), 1e11, contact.Periodic(), substrate=body, contact_fraction=1.0
    )
    closed = 1e11 * q * 1e-6 / (2 * body.symbol(np.array([q]))[0])
    assert contact.solve(full).mean_pressure == pytest.approx(closed, rel=1e-13)


def test_the_adhering_wave_carries_the_load_of_its_closed_form() -> None:
    solution, closed = loaded("own_law").main()
    assert solution.mean_pressure == pytest.approx(closed, rel=1e-12)
    assert solution.mean_pressure != pytest.approx(closed * (1 + 1e-11), rel=1e-12)


def test_a_share_of_one_is_the_self_consistent_localization_and_a_smaller_one_touches_more() -> (
    None
):
    less, one, localized = loaded("own_condition").main()
    assert one.zones == pytest.approx(localized.zones, rel=1e-12)
    assert less.contact_fraction > 1.01 * one.contact_fraction
