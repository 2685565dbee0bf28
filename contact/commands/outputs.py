"""Files that a command is asked to write: what cannot be written is refused before any work is done."""

import os
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import click

from contact.errors import SceneError
from contact.extras import require

# Of what is made, a file, and whether that may be written over.
Write = Callable[[Any, Path, bool], Any]
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


class Outputs:
    """The files that a command is asked for, and how each is written; what cannot be written is refused before any work is done."""

    def __init__(self, overwrite: bool = False) -> None:
        self._overwrite = overwrite
        self._writers: dict[Path, Write] = {}

    def add(self, option: str, path: Path | None, writers: Mapping[str, Write]) -> None:
        """By the endings of its name; None: none is asked for."""
        if path is None:
            return
        if path in self._writers:
            raise SceneError.of(option, str(path), "another file than the other options name")
        self._writers[checked(option, path, writers, self._overwrite)] = writers[path.suffix.lower()]

    def add_figure(self, path: Path | None, drawn: Callable[[Any], Any]) -> None:
        """A picture of what is made."""
        if path is not None:
            self._writers[checked_figure(path)] = lambda made, name, _: drawn(made).savefig(name, dpi=200)

    def write(self, made: Any) -> None:
        for path, write in self._writers.items():
            write(made, path, self._overwrite)

    def tell(self, err: bool = False) -> None:
        for path in self._writers:
            click.echo(f"written: {path}", err=err)
