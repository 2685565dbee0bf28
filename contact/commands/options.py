"""Parts that several commands share: the scene argument, options, output files, lists of values.

An output file that cannot be written is refused before any work is done. A list of values is
written A:B:N, A:B:N:log, or as numbers with commas between.
"""

import json
import os
import sys
from collections.abc import Callable, Iterable, Mapping
from math import isfinite
from pathlib import Path
from typing import Any

import click
import numpy as np

from contact.errors import SceneError
from contact.extras import require
from contact.model.scene import Scene
from contact.model.scene_file import (
    load_scene,
    load_tables,
    read_scene,
    read_tables,
    scene_from_tables,
    tangential_from_tables,
)
from contact.model.tangential import Tangential
from sie import Array

SCENE = click.argument("scene", type=click.Path(path_type=Path))
QUIET = click.option(
    "-q", "--quiet", is_flag=True, help="Print only errors and warnings, no tables or progress."
)
TOL = click.option(
    "--tol", type=float, default=1e-8, show_default=True, help="Largest relative error."
)

AS_JSON = click.option(
    "--json", "as_json", is_flag=True, help="Print one JSON object instead of tables."
)


def save_option(text: str) -> Callable[[Any], Any]:
    """Decorator that adds the option --save to a command; `text` is the help of the option."""
    return _file_option("--save", "save", "OUT.nc", text)


def csv_option(text: str, option: str = "--csv", name: str = "table") -> Callable[[Any], Any]:
    """Decorator that adds the option --csv, or another option that names a CSV file.
    `text` is the help of the option.
    """
    return _file_option(option, name, "OUT.csv", text)


def plot_option(text: str) -> Callable[[Any], Any]:
    """Decorator that adds the option --plot to a command; `text` is the help of the option."""
    return _file_option("--plot", "figure", "OUT.png", text)


def _file_option(option: str, name: str, shown: str, text: str) -> Callable[[Any], Any]:
    return click.option(option, name, type=click.Path(path_type=Path), metavar=shown, help=text)


def scene_of(name: Path) -> Scene:
    """The scene of a file, or the scene read from standard input if the name is "-".

    A scene from standard input names its files relative to the working folder.
    """
    if str(name) != "-":
        return load_scene(name)
    return read_scene(_standard_input(), "standard input")


def _standard_input() -> bytes:
    # sys.stdin is None if standard input was closed.
    return b"" if sys.stdin is None else sys.stdin.buffer.read()


def scene_and_tangential_of(name: Path) -> tuple[Scene, Tangential]:
    """The scene of a file, and its table [tangential] (friction and tangential load).
    If the name is "-", both are read from standard input.
    """
    if str(name) == "-":
        tables, place, folder = read_tables(_standard_input(), "standard input"), "", Path()
    else:
        tables, place, folder = load_tables(name), f"{name}: ", name.parent
    try:
        return scene_from_tables(tables, folder), tangential_from_tables(tables)
    except SceneError as error:
        raise SceneError(f"{place}{error}", error.field, error.value, error.allowed) from error


# A function that writes a result to a file; its last argument says whether an existing file may be
# replaced.
Write = Callable[[Any, Path, bool], Any]
OVERWRITE = click.option(
    "--overwrite",
    is_flag=True,
    help="Replace existing files of numbers; existing pictures are always replaced.",
)


def checked(option: str, path: Path, endings: Iterable[str], overwrite: bool = False) -> None:
    """Raise SceneError if a file of this name cannot be written, or exists and `overwrite` is
    False.
    """
    if path.suffix.lower() not in endings:
        raise SceneError.of(
            option, str(path), f"a file name that ends in {', '.join(sorted(endings))}"
        )
    if not path.parent.is_dir():
        raise SceneError.of(option, str(path), "in a folder that exists")
    if path.is_dir() or not os.access(path if path.exists() else path.parent, os.W_OK):
        raise SceneError.of(
            option, str(path), "a file, not a folder, that you have the permission to write"
        )
    if path.exists() and not overwrite:
        raise SceneError.of(
            option, str(path), "a file that does not exist yet; --overwrite replaces existing files"
        )


class Outputs:
    """The output files of a command, each with the function that writes the file.

    A file that cannot be written, or whose packages are missing, is refused when it is added,
    before any work is done.
    """

    def __init__(self, overwrite: bool = False) -> None:
        self._overwrite = overwrite
        self._writers: dict[Path, Write] = {}

    def add(self, option: str, path: Path | None, writers: Mapping[str, Write]) -> None:
        """Add an output file, with the function that writes files of its ending (such as .csv).
        If `path` is None, nothing is added.
        """
        if path is None:
            return
        if path in self._writers:
            raise SceneError.of(option, str(path), "a different file from those of other options")
        checked(option, path, writers, self._overwrite)
        if path.suffix.lower() == ".nc":
            for needed in ("xarray", "h5netcdf", "h5py"):
                require(needed)
        self._writers[path] = writers[path.suffix.lower()]

    def add_figure(self, path: Path | None, drawn: Callable[[Any], Any]) -> None:
        """Add a picture; an existing picture is always replaced, since it can be drawn again."""
        if path is not None:
            known = require(
                "matplotlib.backends.backend_agg"
            ).FigureCanvasAgg.get_supported_filetypes()
            checked("--plot", path, [f".{kind}" for kind in known], overwrite=True)
            self._writers[path] = lambda made, name, _: drawn(made).savefig(name, dpi=200)

    def write(self, made: Any) -> None:
        for path, write in self._writers.items():
            write(made, path, self._overwrite)

    def finish(self, made: Any, as_json: bool, quiet: bool, show: Callable[[], None]) -> None:
        """Write the files, then print the result: as JSON, or as tables unless `quiet` is set."""
        self.write(made)
        if as_json:
            click.echo(json.dumps(made.to_dict(), allow_nan=False))
        elif not quiet:
            show()
            self.report()

    def report(self, err: bool = False) -> None:
        """Print the names of the written files."""
        for path in self._writers:
            click.echo(f"written: {path}", err=err)


# Largest number of values in a range. A larger number is refused, as it is probably a typing error.
_MAX_VALUES = 100_000


def values_of(option: str, text: str) -> Array:
    """The values of a text from the command line.
    The text is A:B:N (N evenly spaced values), A:B:N:log (evenly spaced logarithms) or numbers
    separated by commas.

    A and B are among the values.
    """
    try:
        values = (
            _between(text.split(":"))
            if ":" in text
            else np.array([float(part) for part in text.split(",")])
        )
    except ValueError:
        values = np.zeros(0)
    if not values.size or not np.isfinite(values).all():
        count = f"N is a whole number from 2 to {_MAX_VALUES}"
        allowed = (
            f"A:B:N or A:B:N:log, such as 1e3:1e6:20:log ({count}; A and B differ; with log, A and "
            "B are above 0), or numbers separated by commas"
        )
        raise SceneError.of(option, text, allowed)
    return values


def _between(parts: list[str]) -> Array:
    """Values of a range A:B:N or A:B:N:log; empty if invalid.
    `parts` are the texts between the colons.
    """
    logarithmic = len(parts) == 4 and parts[3] == "log"
    first, last, count = float(parts[0]), float(parts[1]), int(parts[2]) if len(parts) > 2 else 0
    if (
        (len(parts) != 3 and not logarithmic)
        or not 2 <= count <= _MAX_VALUES
        or first == last
        or not isfinite(last - first)
    ):
        return np.zeros(0)
    if logarithmic and (first <= 0 or last <= 0):
        return np.zeros(0)
    # Values are rounded to 15 digits, so that a computed 0.3 equals a 0.3 written by hand.
    return np.array(
        [
            float(f"{value:.15g}")
            for value in (np.geomspace if logarithmic else np.linspace)(first, last, count)
        ]
    )
