"""Files that a command is asked to write: what cannot be written is refused before any work is done."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

from contact.errors import SceneError
from contact.extras import require


def checked_figure(path: Path) -> Path:
    """The name of a picture that can be written."""
    known = require("matplotlib.backends.backend_agg").FigureCanvasAgg.get_supported_filetypes()
    return checked("--plot", path, [f".{kind}" for kind in known])


def checked(option: str, path: Path, endings: Iterable[str]) -> Path:
    """The name of a file that can be written."""
    if path.suffix.lower() not in endings:
        raise SceneError.of(option, str(path), f"a file name that ends in {', '.join(sorted(endings))}")
    if not path.parent.is_dir():
        raise SceneError.of(option, str(path), "in a folder that exists")
    if path.is_dir() or not os.access(path if path.exists() else path.parent, os.W_OK):
        raise SceneError.of(option, str(path), "a file that may be written")
    return path
