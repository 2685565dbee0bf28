"""`contact explore [SCENE]`: the page with sliders, served on this machine alone."""

from pathlib import Path

import click

from contact.commands.options import TOL, scene_of
from contact.extras import require


@click.command("explore")
@click.argument("scene", type=click.Path(path_type=Path), required=False)
@click.option("--port", type=click.IntRange(1, 65535), help="Of the page; one that is free if left out.")
@click.option("--show/--no-show", default=True, help="Open a browser.")
@TOL
def explore_command(scene: Path | None, port: int | None, show: bool, tol: float) -> None:
    """Turn a SCENE by sliders in a browser: surfaces, pressure, load curve and stated error follow. Without one: a wave.

    The page is served on this machine alone (127.0.0.1), with all that it loads; it ends with Ctrl-C.
    """

    def ready(address: str) -> None:
        click.echo(f"{address}  (Ctrl-C ends it)")

    given = scene_of(scene) if scene is not None and str(scene) == "-" else scene
    require("contact.explorer.explore").serve(given, tol, port, ready, show)
