"""The notebooks of the documentation run, and give the text and the pictures that they contain."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path
from types import ModuleType

import pytest

FILE = Path(__file__).parents[1] / "docs" / "notebooks.py"


def module() -> ModuleType:
    """The module docs/notebooks.py, which ProperDocs runs."""
    spec = importlib.util.spec_from_file_location("docs_notebooks", FILE)
    assert spec is not None and spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made


NOTEBOOKS = module()
ALL = NOTEBOOKS.notebooks()


@pytest.mark.slow
@pytest.mark.parametrize("notebook", ALL, ids=lambda file: file.stem)
def test_a_notebook_runs_and_prints_and_shows_what_is_kept_in_it(notebook: Path) -> None:
    pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    now = NOTEBOOKS.run(notebook).cells
    kept = NOTEBOOKS.cells(notebook)
    assert [NOTEBOOKS.text_of(cell) for cell in now] == [NOTEBOOKS.text_of(cell) for cell in kept]
    assert [len(NOTEBOOKS.pictures_of(cell)) for cell in now] == [
        len(NOTEBOOKS.pictures_of(cell)) for cell in kept
    ]


def test_there_are_three_notebooks_each_with_text_code_and_a_picture() -> None:
    assert len(ALL) == 3
    for notebook in ALL:
        text, pictures = NOTEBOOKS.page(notebook)
        assert text.startswith(f"# {NOTEBOOKS.title(notebook)}\n") and len(pictures) == 1
        assert all(picture.startswith(b"\x89PNG") for picture in pictures.values())
        assert "Warning" not in text and "Error" not in text


@pytest.mark.parametrize("notebook", ALL, ids=lambda file: file.stem)
def test_links_of_a_notebook_lead_to_pages(notebook: Path) -> None:
    text, pictures = NOTEBOOKS.page(notebook)
    for target in re.findall(r"\]\(([^)#\s]+)", text):
        assert target in pictures or (notebook.parent / target).is_file(), target
