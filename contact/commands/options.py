"""What several commands have in common: how a scene is named, and options."""

import sys
from pathlib import Path

import click

from contact.model.scene import Scene
from contact.model.scene_file import load_scene, read_scene

SCENE = click.argument("scene", type=click.Path(path_type=Path))
QUIET = click.option("-q", "--quiet", is_flag=True, help="Print no tables and no progress, only what goes wrong.")
TOL = click.option("--tol", type=float, default=1e-8, show_default=True, help="Largest relative error.")


def scene_of(name: Path) -> Scene:
    """The scene of a file, or of what comes in on standard input; files it names are looked for from the working folder then."""
    if str(name) != "-":
        return load_scene(name)
    # None where it was closed.
    return read_scene(b"" if sys.stdin is None else sys.stdin.buffer.read(), "standard input")
