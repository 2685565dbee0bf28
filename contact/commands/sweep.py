"""`contact sweep SCENE --vary KEY=A:B:N --out OUT.nc`: a scene on a grid of values.

The command runs on this machine or on a cluster, and continues a file OUT.nc that exists.
"""

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click
import numpy as np

from contact.commands.options import (
    QUIET,
    SCENE,
    TOL,
    Outputs,
    checked,
    plot_option,
    scene_of,
    values_of,
)
from contact.commands.trace import show_profile
from contact.errors import NotConverged, OutOfRange, SceneError
from contact.extras import require
from contact.model.units import column, quantity
from contact.solution.report import label
from contact.solution.terminal import Progress, show_table
from contact.sweeps.points import NUMBERS
from contact.sweeps.sweep.keys import BRANCHES
from contact.sweeps.sweep.run import sweep

# Name of the module that draws a sweep. It is imported only if a figure is requested.
_FIGURE = "contact.sweeps.sweep.figure"


@click.command("sweep")
@SCENE
@click.option(
    "--vary",
    "varied",
    multiple=True,
    required=True,
    metavar="KEY=A:B:N[:log]",
    help="Values of a key TABLE.KEY of the scene: N values from A to B, or values separated by "
    "commas. Repeat the option for other keys.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    required=True,
    metavar="OUT.nc",
    help="File of the results; an existing file is completed.",
)
@click.option(
    "--scheduler",
    metavar="ADDRESS",
    help="Solve on the workers of this Dask scheduler, such as tcp://host:8786.",
)
@click.option(
    "--workers",
    type=int,
    metavar="N",
    help="Number of processes on this machine; by default one for each processor.",
)
@click.option("--retry", is_flag=True, help="Solve the failed points in OUT.nc again.")
@click.option(
    "--branch",
    type=click.Choice(BRANCHES),
    default=BRANCHES[0],
    show_default=True,
    help="Under adhesion, take the contact reached by raising the control (advancing) or by "
    "lowering it (receding). --vary branch=advancing,receding takes both.",
)
@plot_option("Draw results against one key, with a line for each value of a second key.")
@click.option(
    "--show",
    "shown",
    multiple=True,
    type=click.Choice(tuple(NUMBERS)),
    help="Result to draw; repeat the option for others.  [default: max_pressure and "
    "contact_fraction or total_width]",
)
@click.option("--overwrite", is_flag=True, help="Replace OUT.nc, and solve all points again.")
@QUIET
@TOL
def sweep_command(
    scene: Path,
    varied: Sequence[str],
    out: Path,
    scheduler: str | None,
    workers: int | None,
    retry: bool,
    branch: str,
    figure: Path | None,
    shown: Sequence[str],
    overwrite: bool,
    quiet: bool,
    tol: float,
) -> None:
    """Solve a SCENE over a grid of values of its keys, such as --vary
    control.mean_pressure=1e6:1e8:20:log.

    Points that are in OUT.nc are not solved again. So the same command continues an interrupted
    sweep.
    """
    problem = scene_of(scene)
    over = _over(varied)
    checked("--out", out, (".nc",), overwrite=True)
    pictures = Outputs()
    if figure is not None:
        drawing = require(_FIGURE)
        drawing.check_drawable({key: len(values) for key, values in over.items()})
        pictures.add_figure(figure, lambda table: drawing.plot_sweep(table, shown))
    elif shown:
        raise SceneError.of("--show", ", ".join(shown), "left out without --plot")
    if scheduler is not None and workers is not None:
        raise SceneError.of(
            "--workers", workers, "left out with --scheduler, which has its own workers"
        )
    if not quiet:
        show_profile(problem.profile)
    start = time.perf_counter()
    with Progress(wanted=not quiet) as progress:
        table = sweep(
            problem,
            over,
            scheduler,
            tol=tol,
            workers=workers,
            out=out,
            overwrite=overwrite,
            retry=retry,
            branch=branch,
            progress=progress,
        )
    if not quiet:
        _show(table, time.perf_counter() - start)
        click.echo(f"written: {out}")
    _stop_where_nothing_is_solved(table)
    pictures.write(table)
    if not quiet:
        pictures.report()


def _over(varied: Sequence[str]) -> dict[str, Any]:
    over: dict[str, Any] = {}
    for text in varied:
        key, found, values = text.partition("=")
        if not found or not key or not values:
            raise SceneError.of(
                "--vary", text, "KEY=VALUES, such as control.mean_pressure=1e6:1e8:20:log"
            )
        if key in over:
            raise SceneError.of("--vary", text, f"given once for each key: {key} is given twice")
        words = values.split(",")
        over[key] = (
            words if all(_is_word(word) for word in words) else values_of(f"--vary {key}", values)
        )
    return over


def _is_word(text: str) -> bool:
    return text[:1].isalpha() and ":" not in text and text.lower() not in ("nan", "inf", "infinity")


def _show(table: Any, seconds: float) -> None:
    axes = [table[name] for name in table.dims]
    known = [(axis.attrs["key"], axis.values, axis.attrs.get("units", "")) for axis in axes]
    show_table(
        "grid",
        ("key", "values", "from to"),
        [(key, str(len(values)), _span(values, unit)) for key, values, unit in known],
        (1,),
    )
    failed, spans = (
        table["failed"],
        [
            (name, _span(table[name].values, unit, 2 if name == "error" else 6))
            for name, (unit, _) in NUMBERS.items()
        ],
    )
    rows = [
        ("points", str(failed.size)),
        ("failed", str(int(failed.sum()))),
        ("time", quantity(seconds, "s", 3)),
    ]
    rows += [(label(name), span) for name, span in spans if span]
    show_table("sweep", ("quantity", "smallest to largest"), rows)


def _span(values: Any, unit: str, digits: int = 6) -> str:
    """The least and the greatest of the values, as text in a common unit.
    If both are shown alike, one is given. If the values are texts, all are listed. The result is ""
    if there are no values.
    """
    flat = np.ravel(values)
    if flat.dtype.kind not in "iuf":
        return ", ".join(str(value) for value in flat)
    flat = flat[~np.isnan(flat)]
    if not flat.size:
        return ""
    ends = [float(flat.min()), float(flat.max())]
    if unit in ("", "1"):
        return " to ".join(dict.fromkeys(f"{end:.{digits}g}" for end in ends))
    name, cells = column(ends, unit, digits)
    return f"{' to '.join(dict.fromkeys(cells))} {name}"


def _stop_where_nothing_is_solved(table: Any) -> None:
    """Raise the error of the first point if all points of the sweep have failed."""
    if not bool(table["failed"].all()):
        return
    reasons = [str(reason) for reason in np.ravel(table["reason"].values)]
    kind = (
        NotConverged if any(reason.startswith("NotConverged") for reason in reasons) else OutOfRange
    )
    raise kind(f"all points failed; the first one: {reasons[0]}")
