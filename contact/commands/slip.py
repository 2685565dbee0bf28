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
from contact.model.units import quantity
from contact.solution.solution import Solution
from contact.solution.terminal import Progress, show_columns, show_table
from contact.solver import solve

# Modules that only a scene with friction needs.
_EXPORT = "contact.slip.export"
_PLOT = "contact.slip.plotting"
_PARTIAL = "contact.slip.partial_slip"
_REPORT = "contact.slip.report"
_ROLLING = "contact.slip.rolling"


@click.command("slip")
@SCENE
@AS_JSON
@save_option("Write zones and fields as netCDF (OUT.nc) or JSON (OUT.json).")
@csv_option("Write the stick and slip zones as CSV.")
@csv_option("Write pressure and shear over x as CSV.", "--fields", "fields")
@plot_option("Draw the shear, and the stick and slip zones.")
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
    """Solve a SCENE with a table [tangential], and print the zones that stick and that slip.

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
    """Solve for stick and slip, given the normal contact and the table [tangential] of a scene."""
    if given.model == "rolling":
        rolls = given.friction, given.load, given.creepage, given.leading
        return require(_ROLLING).rolling(solution, *rolls, tol=tol)
    slips = given.friction, given.load, given.bulk_stress
    return require(_PARTIAL).partial_slip(solution, *slips, tol=tol)


def _show(slip: Any, seconds: float, rows_shown: int = 20) -> None:
    """Print the slip solution as tables.
    Only the `rows_shown` widest zones that stick or slip are listed.
    """
    show_profile(slip.solution.scene.profile)
    report = require(_REPORT)
    rows = [*report.numbers(slip), ("time", quantity(seconds, "s", 3), "")]
    show_table(report.heading(slip), report.HEADS, rows, numeric=(1, 2))
    if columns := report.zone_columns(slip, rows_shown):
        show_columns("stick and slip zones", columns, words=(0,))
    if (more := len(slip.stick_zones) + len(slip.slip_zones) - rows_shown) > 0:
        click.echo(
            f"only the {rows_shown} widest zones are shown; --csv also writes the other {more}"
        )
