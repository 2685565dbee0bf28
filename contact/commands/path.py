"""`contact path SCENE --loads A:B:N`: a scene at many loads, up and down, with the loads at which zones come, go and merge."""

from __future__ import annotations

from pathlib import Path

import click
import numpy as np
from numpy.typing import NDArray

from contact.commands.options import QUIET, SCENE, TOL, scene_of
from contact.commands.outputs import OVERWRITE, checked, checked_figure
from contact.commands.ranges import values_of
from contact.commands.trace import show_profile
from contact.errors import SceneError
from contact.model.scene import Scene
from contact.model.units import column
from contact.solution.terminal import Progress, show_table
from contact.sweeps.curve import solve_many
from contact.sweeps.path import path
from contact.sweeps.path_table import columns, to_json
from contact.sweeps.paths import Path as LoadPath
from contact.sweeps.points import NUMBERS

# Columns of the table, with digits: what an 80-column screen holds.
_SHOWN = {
    "load": 4, "mean_pressure": 4, "max_pressure": 4, "approach": 4, "contact_fraction": 4, "total_width": 4, "mean_gap": 4, "stiffness": 3,
    "zone_count": 5, "error": 2,
}
_HEADS = {"zone_count": "zones", "stiffness": "stiff-\nness"}


@click.command("path")
@SCENE
@click.option("--loads", required=True, metavar="A:B:N[:log]", help="Loads [N/m], per period: N from A to B, or with commas between.")
@click.option("--back", is_flag=True, help="The same loads back again.")
@click.option("--no-events", is_flag=True, help="Do not look for where zones come, go and merge: much quicker where there are many.")
@click.option("--csv", "table", type=click.Path(path_type=Path), metavar="OUT.csv", help="Write a row for each load.")
@click.option("--plot", "figure", type=click.Path(path_type=Path), metavar="OUT.png", help="Draw contact and approach over the load.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of tables.")
@OVERWRITE
@QUIET
@TOL
def path_command(
    scene: Path, loads: str, back: bool, no_events: bool, table: Path | None, figure: Path | None, as_json: bool, overwrite: bool,
    quiet: bool, tol: float,
) -> None:
    """Solve a SCENE along loads, with the loads at which zones are born, merge or fill the period.

    The scene's own control is replaced by the loads. A load of 0, where nothing touches, is left out.
    """
    problem = scene_of(scene)
    values = _loads(problem, loads, back)
    if table is not None:
        checked("--csv", table, (".csv",), overwrite)
    if figure is not None:
        checked_figure(figure)
    with Progress(wanted=not quiet) as progress:
        if no_events:
            alone = tuple(solve_many(problem, values, "load", tol=tol, progress=progress))
            found = LoadPath(alone, ((),) * len(alone))
        else:
            found = path(problem, values, tol=tol, progress=progress)
    if table is not None:
        found.save(table, overwrite)
    if figure is not None:
        found.plot().savefig(figure, dpi=200)
    if as_json:
        click.echo(to_json(found.solutions, found.passed))
    if as_json or quiet:
        return
    show_profile(problem.profile)
    _show(found)
    for written in (table, figure):
        if written is not None:
            click.echo(f"written: {written}")


def _loads(scene: Scene, text: str, back: bool) -> NDArray[np.float64]:
    values = values_of("--loads", text)
    if not scene.law.pulls:
        # Without tension nothing touches under no load.
        values = values[values != 0]
        if not values.size:
            raise SceneError.of("--loads", text, "at least one load other than 0")
    return np.concatenate([values, values[-2::-1]]) if back else values


def _show(found: LoadPath) -> None:
    known = columns(found.solutions)
    names, cells = [], []
    for name, digits in _SHOWN.items():
        if np.isnan(known[name]).all() or (name == "total_width" and "contact\nfraction" in names):
            continue
        head, (unit, _) = _HEADS.get(name, name.replace("_", "\n")), NUMBERS[name]
        if unit != "1":
            unit, told = column(known[name], unit, digits)
            head = f"{head}\n[{unit}]"
        else:
            told = [f"{value:.{digits}g}" for value in known[name]]
        names.append(head)
        cells.append(told)
    show_table("load path", names, list(zip(*cells, strict=True)), numeric=range(len(names)), close=True)
    if found.events:
        of_loads, loads = column([event.load for event in found.events], "N/m", 10)
        of_places, places = column([event.position for event in found.events], "m", 10)
        kinds = [event.kind for event in found.events]
        counts = [event.change() for event in found.events]
        heads = ("event", f"load [{of_loads}]", f"position [{of_places}]", "zones")
        show_table("events, in the order of the path", heads, list(zip(kinds, loads, places, counts, strict=True)), numeric=(1, 2))
