"""The command `contact stress`: the stresses below the surface of a scene."""

from pathlib import Path

import click

from contact.commands.options import (
    AS_JSON,
    OVERWRITE,
    QUIET,
    SCENE,
    TOL,
    Outputs,
    plot_option,
    save_option,
    scene_of,
)
from contact.inside.largest import Peak
from contact.inside.stress import LATERAL
from contact.inside.yielding import CRITERIA
from contact.model.units import quantity, with_error
from contact.solution.report import HEADS, Row, numbers
from contact.solution.stress_plot import SHOWN, place_of, plot_stress
from contact.solution.stress_report import StressReport, stress_report, write_json, write_netcdf
from contact.solution.terminal import Progress, show_table
from contact.solver import solve


@click.command("stress")
@SCENE
@click.option("--nu", type=float, default=0.3, show_default=True, help="Poisson's ratio of body 1.")
@click.option(
    "--strength",
    type=float,
    help="Yield strength [Pa] (in tension for mises, in shear for tresca); the load at first yield "
    "is then computed.",
)
@click.option("--criterion", type=click.Choice(CRITERIA), default="mises", show_default=True)
@click.option(
    "--lateral",
    type=click.Choice(LATERAL),
    default="as loaded",
    show_default=True,
    help="Sides of a periodic body: under the mean pressure (as loaded), free to move (free), or "
    "held by rigid walls (confined).",
)
@AS_JSON
@save_option(
    "Write the stresses over x and depth as netCDF (OUT.nc), or the largest stresses and the first "
    "yield as JSON (OUT.json)."
)
@plot_option("Draw the stresses.")
@click.option(
    "--show",
    type=click.Choice(SHOWN),
    default="shear",
    show_default=True,
    help="Draw contours of the largest shear stress (shear) or of the von Mises stress (mises), or "
    "photoelastic fringes (fringes).",
)
@OVERWRITE
@QUIET
@TOL
def stress_command(
    scene: Path,
    nu: float,
    strength: float | None,
    criterion: str,
    lateral: str,
    as_json: bool,
    save: Path | None,
    figure: Path | None,
    show: str,
    overwrite: bool,
    quiet: bool,
    tol: float,
) -> None:
    """Solve a SCENE and print the largest stresses in body 1, and where it first yields."""
    problem = scene_of(scene)
    outputs = Outputs(overwrite)
    outputs.add("--save", save, {".nc": write_netcdf, ".json": write_json})
    outputs.add_figure(figure, lambda report: plot_stress(report, show))
    with Progress(wanted=not quiet) as progress:
        solution = solve(problem, tol=tol, progress=progress)
    report = stress_report(solution, nu, lateral, strength, criterion)
    outputs.finish(report, as_json, quiet, lambda: _show(report))


def _show(report: StressReport) -> None:
    known = ("load", "largest pressure")
    rows = [
        *(row for row in numbers(report.solution) if row[0] in known),
        *_rows("largest shear stress", report.shear),
        *_rows("largest von Mises stress", report.mises),
    ]
    found = report.yields
    if found is not None:
        load = with_error(found.load, found.error * found.load, "N/m")
        rows += [("first yield at the load", *load), *_place(found.x, found.y)]
        rows += [("  because of", found.note, "")] if found.note else []
    if report.not_found:
        rows += [("first yield", "not found", "-"), ("  because", report.not_found, "")]
    show_table("stresses in body 1", HEADS, rows, numeric=(1, 2))


def _rows(name: str, peak: Peak | None) -> list[Row]:
    if peak is None:
        return [(name, "infinite", "-")]
    return [(name, *with_error(peak.stress, peak.error, "Pa")), *_place(peak.x, peak.y)]


def _place(x: float, y: float) -> list[Row]:
    return [
        ("  at x", quantity(place_of(x, y), "m", 7), ""),
        ("  at the depth", quantity(y, "m", 7), ""),
    ]
