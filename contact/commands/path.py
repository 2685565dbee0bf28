"""`contact path SCENE --loads A:B:N`: a scene at many loads, with the events between them."""

from collections.abc import Mapping
from pathlib import Path

import click
import numpy as np

from contact.commands.options import (
    AS_JSON,
    OVERWRITE,
    QUIET,
    SCENE,
    TOL,
    Outputs,
    csv_option,
    plot_option,
    scene_of,
    values_of,
)
from contact.commands.trace import show_profile
from contact.errors import NotConverged, SceneError
from contact.model.scene import Scene
from contact.solution.terminal import Progress, show_columns
from contact.sweeps.path import path, refuse_unloading
from contact.sweeps.path_report import energy_line, event_columns, value_columns
from contact.sweeps.paths import Path as LoadPath
from contact.sweeps.solve_many import solve_many
from sie import Array

# For each control, the option of the command that gives its values.
_OPTIONS = {"load": "loads", "mean_pressure": "pressures", "approach": "approaches"}


@click.command("path")
@SCENE
@click.option(
    "--loads",
    metavar="A:B:N[:log]",
    help="Loads [N/m], per period if there is one: N values from A to B, or numbers separated by "
    "commas.",
)
@click.option("--pressures", metavar="A:B:N[:log]", help="Mean pressures [Pa] instead of loads.")
@click.option(
    "--approaches",
    metavar="A:B:N[:log]",
    help="Approaches [m] instead of loads, for surfaces with adhesion.",
)
@click.option(
    "--stiffness",
    type=float,
    metavar="K",
    help="Stiffness [N/m^2] of a spring; the approaches are then those of its far end.",
)
@click.option("--back", is_flag=True, help="Return through the same values.")
@click.option(
    "--no-events",
    is_flag=True,
    help="Do not search for the loads at which zones appear, vanish or merge; much faster if there "
    "are many zones.",
)
@click.option(
    "--workers",
    type=int,
    default=1,
    metavar="N",
    help="Number of parallel processes; more than 1 only with --no-events.",
    show_default=True,
)
@csv_option("Write a row for each load.")
@plot_option("Draw contact and approach over the load.")
@AS_JSON
@OVERWRITE
@QUIET
@TOL
def path_command(
    scene: Path,
    loads: str | None,
    pressures: str | None,
    approaches: str | None,
    stiffness: float | None,
    back: bool,
    no_events: bool,
    workers: int,
    table: Path | None,
    figure: Path | None,
    as_json: bool,
    overwrite: bool,
    quiet: bool,
    tol: float,
) -> None:
    """Solve a SCENE along increasing and decreasing loads, and find what happens between them:
    zones appear, merge, fill the period or snap apart.

    The scene's own control is replaced by the loads. Without adhesion a load of 0, where nothing
    touches, is left out.
    """
    problem = scene_of(scene)
    control, values = _values(
        problem, {"loads": loads, "pressures": pressures, "approaches": approaches}, back
    )
    given = {"load": loads, "mean_pressure": pressures, "approach": approaches}[control]
    name = f"--{_OPTIONS[control]}"
    refuse_unloading(
        problem, values, ("--back", True, "left out") if back else (name, given, "rising")
    )
    if no_events and problem.law.pressure_range.has_tension:
        raise SceneError.of(
            "--no-events",
            True,
            f"left out: under the law {problem.law.name} the contact depends on the loading path",
        )
    if workers != 1 and not no_events:
        raise SceneError.of(
            "--workers", workers, "1 without --no-events, since events are found one after another"
        )
    outputs = Outputs(overwrite)
    outputs.add(
        "--csv", table, {".csv": lambda found, name, overwrite: found.save(name, overwrite)}
    )
    outputs.add_figure(figure, lambda found: found.plot())
    failure = None
    try:
        with Progress(wanted=not quiet) as progress:
            if no_events:
                alone = tuple(
                    solve_many(
                        problem, values, control, tol=tol, progress=progress, workers=workers
                    )
                )
                found = LoadPath(alone, ((),) * len(alone))
            else:
                found = path(
                    problem,
                    values,
                    tol=tol,
                    progress=progress,
                    control=control,
                    stiffness=stiffness,
                )
    except SceneError as error:
        # The new error names the option of this command instead of the parameter of `path`.
        if error.allowed is None or error.field not in ("values", "control", "stiffness"):
            raise
        if error.field == "stiffness":
            raise SceneError.of("--stiffness", stiffness, error.allowed) from error
        raise SceneError.of(name, given, error.allowed) from error
    except NotConverged as error:
        # The loads that were solved are shown before the command ends with the error.
        failure, found = error, _solved_of(error, tol)
    outputs.finish(found, as_json, quiet, lambda: _show(found))
    if failure is not None:
        raise failure


def _solved_of(failure: NotConverged, tol: float) -> LoadPath:
    """The path through the loads that were solved; raises the error if there are none."""
    best = failure.best
    if isinstance(best, LoadPath):
        return best
    if not isinstance(best, list):
        raise failure
    alone = tuple(one for one in best if one is not None and one.error <= tol)
    return LoadPath(alone, ((),) * len(alone))


def _values(scene: Scene, given: Mapping[str, str | None], back: bool) -> tuple[str, Array]:
    """The name of the control, and the values that the command's options give for it."""
    names = [name for name, text in given.items() if text is not None]
    if len(names) != 1:
        if names:
            together = " and ".join(f"--{name}" for name in names)
            raise SceneError(f"{together} are given together: give only one of them", names[0])
        others = ", ".join(f"--{name}" for name in given if name != "loads")
        raise SceneError(f"--loads is missing: give --loads or one of {others}", "loads")
    text = given[names[0]] or ""
    values = values_of(f"--{names[0]}", text)
    if not scene.law.pressure_range.has_tension:
        # A load of 0 is left out: without adhesion there is no contact at zero load.
        values = values[values != 0]
        if not values.size:
            raise SceneError.of(f"--{names[0]}", text, "at least one value other than 0")
    control = next(control for control, option in _OPTIONS.items() if option == names[0])
    return control, np.concatenate([values, values[-2::-1]]) if back else values


def _show(found: LoadPath) -> None:
    show_profile(found.solutions[0].scene.profile)
    show_columns("load path", list(value_columns(found).values()), close=True)
    if found.events:
        table = event_columns(found.events)
        show_columns("events, in the order of the path", table, words=(0, len(table) - 1))
    if line := energy_line(found):
        click.echo(line)
