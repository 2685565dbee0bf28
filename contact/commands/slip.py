"""`contact slip SCENE`: what sticks and what slips under the table [tangential] of a scene file."""

import time
from pathlib import Path
from typing import Any

import click

from contact.commands.options import (
    AS_JSON,
    OVERWRITE,
    QUIET,
    SCENE,
    TOL,
    Outputs,
    csv_option,
    plot_option,
    save_option,
    scene_and_tangential_of,
)
from contact.commands.trace import show_profile
from contact.extras import require
from contact.model.tangential import Tangential
from contact.model.units import headed, quantity
from contact.solution.solution import Solution
from contact.solution.terminal import Progress, show_columns, show_table
from contact.solver import solve

# Modules that only a scene with friction needs.
_EXPORT = "contact.slip.export"
_PLOT = "contact.slip.plotting"
_PARTIAL = "contact.slip.partial_slip"
_ROLLING = "contact.slip.rolling"


@click.command("slip")
@SCENE
@AS_JSON
@save_option("Write intervals and fields as netCDF, or OUT.json.")
@csv_option("Write what sticks and what slips as CSV.")
@csv_option("Write pressure and shear over x as CSV.", "--fields", "fields")
@plot_option("Draw the shear and what sticks.")
@OVERWRITE
@QUIET
@TOL
def slip_command(
    scene: Path,
    as_json: bool,
    save: Path | None,
    table: Path | None,
    fields: Path | None,
    figure: Path | None,
    overwrite: bool,
    quiet: bool,
    tol: float,
) -> None:
    """Solve a SCENE with a table [tangential], and print what sticks and what slips.

    The table has friction, and load [N/m] or creepage; model is "partial slip" or "rolling".
    """
    problem, tangential = scene_and_tangential_of(scene)
    export = require(_EXPORT)
    outputs = Outputs(overwrite)
    outputs.add("--save", save, {".nc": export.write_netcdf, ".json": export.write_json})
    outputs.add("--csv", table, {".csv": export.write_csv})
    outputs.add("--fields", fields, {".csv": export.write_fields})
    outputs.add_figure(figure, require(_PLOT).plot)
    start = time.perf_counter()
    with Progress(wanted=not quiet) as progress:
        slip = _slip(solve(problem, tol=tol, progress=progress), tangential, tol)
    seconds = time.perf_counter() - start
    outputs.finish(slip, as_json, quiet, lambda: _show(slip, seconds))


def _slip(solution: Solution, given: Tangential, tol: float) -> Any:
    """The `contact.Slip` of a solution, for the friction and the load that `given` holds."""
    if given.model == "rolling":
        rolls = given.friction, given.load, given.creepage, given.leading
        return require(_ROLLING).rolling(solution, *rolls, tol=tol)
    slips = given.friction, given.load, given.bulk_stress
    return require(_PARTIAL).partial_slip(solution, *slips, tol=tol)


def _show(slip: Any, seconds: float, rows_shown: int = 20) -> None:
    """Print a slip as tables; of its intervals, only the first `rows_shown` are listed."""
    solution = slip.solution
    show_profile(solution.scene.profile)
    rolled = [("creepage", "not defined" if slip.creepage is None else f"{slip.creepage:.10g}")]
    slid = [
        ("shift", quantity(slip.shift, "m", 10)),
        ("lost energy", quantity(slip.dissipated, "J/m", 6)),
    ]
    show_table(
        f"{slip.model}, {solution.scene.profile.title} profile, "
        f"{solution.scene.interaction.name} interaction",
        ("quantity", "value"),
        [
            ("load", quantity(solution.load, "N/m", 10)),
            ("tangential load", quantity(slip.tangential_load, "N/m", 10)),
            ("friction", f"{slip.friction:.10g}"),
            *(rolled if slip.model == "rolling" else slid),
            ("zones", str(len(solution.zones)) if len(solution.zones) else "full contact"),
            ("zones that stick", str(len(slip.stick_zones))),
            ("intervals that slip", str(len(slip.slip_zones))),
            ("error, at most", f"{slip.error:.2g}"),
            ("time", quantity(seconds, "s", 3)),
        ],
    )
    export = require(_EXPORT)
    rows = export.interval_table(slip)
    shown = rows[:rows_shown]
    columns = [("state", [row[3] for row in shown])]
    for place, name in enumerate(export.INTERVAL_COLUMNS[:3]):
        columns.append(headed(name, [float(row[place]) for row in shown], "m", 9))
    show_columns("intervals", columns, words=(0,))
    if len(rows) > rows_shown:
        click.echo(f"{len(rows) - rows_shown} more intervals: --csv writes them all")
