"""Files that a command is asked to write: what cannot be written is refused before any work is done."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

import click

from contact.errors import SceneError
from contact.extras import require

OVERWRITE = click.option("--overwrite", is_flag=True, help="Write over files of numbers that are there; pictures are drawn anew.")


def checked_figure(path: Path) -> Path:
    """The name of a picture that can be written; one that is there is drawn anew, as it holds nothing that is not drawn again."""
    known = require("matplotlib.backends.backend_agg").FigureCanvasAgg.get_supported_filetypes()
    return checked("--plot", path, [f".{kind}" for kind in known], overwrite=True)


def checked(option: str, path: Path, endings: Iterable[str], overwrite: bool = False) -> Path:
    """The name of a file that can be written; one that is there, only where it may be written over."""
    if path.suffix.lower() not in endings:
        raise SceneError.of(option, str(path), f"a file name that ends in {', '.join(sorted(endings))}")
    if not path.parent.is_dir():
        raise SceneError.of(option, str(path), "in a folder that exists")
    if path.is_dir() or not os.access(path if path.exists() else path.parent, os.W_OK):
        raise SceneError.of(option, str(path), "a file that may be written")
    if path.exists() and not overwrite:
        raise SceneError.of(option, str(path), "a file that is not there yet, or --overwrite given")
    return path
