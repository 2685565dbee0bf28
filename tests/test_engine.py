"""The engine on its own: every example of it says something true."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

ROOT = Path(__file__).parents[1]
SCRIPTS = sorted((ROOT / "examples" / "engine").glob("*.py"))


def run(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(
        f"examples_engine_{name}", ROOT / "examples" / "engine" / f"{name}.py"
    )
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda f: f.stem)
def test_an_example_of_the_engine_is_short_has_a_picture_and_needs_no_contact(script: Path) -> None:
    text = script.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 40 and "contact" not in text
    assert f"examples/engine/{script.name}" in (ROOT / "docs" / "engine.md").read_text(
        encoding="utf-8"
    )
    assert 0 < (ROOT / "docs" / "gallery" / f"{script.stem}.png").stat().st_size <= 60_000


def test_cracks_have_the_stress_intensity_factors_of_their_closed_forms() -> None:
    found, closed, error = run("cracks").main()
    assert found == pytest.approx(closed, rel=10 * error + 1e-15)
    assert found != pytest.approx(np.array(closed) * (1 + 1e-11), rel=10 * error + 1e-15)


def test_plates_in_tandem_lift_what_the_closed_form_says_and_together_no_more_than_alone() -> None:
    module = run("aerofoils")
    lifts, exact, error = module.main()
    assert lifts == pytest.approx(exact, rel=10 * error + 1e-15)
    chords = np.diff(module.PLATES)[:, 0]
    assert lifts @ chords == pytest.approx(2 * np.pi * module.ALPHA * chords.sum(), rel=1e-12)


def vortices(module: ModuleType, count: int) -> np.ndarray:
    """Lift coefficients by discrete vortices at the quarter points of panels, no flow through their
    three-quarter points (R. M. James, Comput. Methods Appl. Mech. Eng. 1 (1972) 59).
    """
    length = np.diff(module.PLATES) / count
    starts = module.PLATES[:, :1] + length * np.arange(count)
    at, through = (starts + 0.25 * length).ravel(), (starts + 0.75 * length).ravel()
    circulation = np.linalg.solve(
        1 / (through[:, None] - at), np.full(2 * count, 2 * np.pi * module.ALPHA)
    )
    return 2 * circulation.reshape(2, count).sum(axis=1) / np.diff(module.PLATES)[:, 0]


def test_plates_in_tandem_lift_what_discrete_vortices_come_to() -> None:
    module = run("aerofoils")
    lifts, _, _ = module.main()
    coarse, fine = (np.abs(vortices(module, count) / lifts - 1).max() for count in (20, 40))
    assert fine < 0.3 * coarse < 1e-3 or fine < 1e-5


def test_the_two_cuts_end_where_the_closed_form_has_them() -> None:
    found, ends = run("equilibrium").main()
    assert found.zones.table == pytest.approx(np.array([-ends[::-1], ends]), abs=10 * found.error)


def test_the_capacity_of_two_intervals_is_the_elliptic_one() -> None:
    for capacity, closed, error in run("capacity").main():
        assert capacity == pytest.approx(closed, rel=10 * error + 1e-14)


def test_the_stresses_off_the_cracks_are_those_of_the_closed_form() -> None:
    off, error = run("stresses").main()
    assert max(off) < 10 * error
