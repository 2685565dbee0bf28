"""The command line.

Commands: `contact solve | slip | stress | plan | compare | path | sweep | explore | trace | figures
| bench | stability`, and lists of the names that a scene may use: `contact profiles |
interactions | substrates | laws | controls`.

Exit status 0: solved; 2: bad input or out of range; 3: not converged; 130: interrupted. Every
status but 0 prints one line on stderr, after one line for each warning.
"""

import inspect
import os
import sys
import time
import warnings
from collections.abc import Callable, Mapping
from operator import attrgetter
from pathlib import Path
from typing import Any, NoReturn

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
    scene_of,
)
from contact.commands.path import path_command
from contact.commands.slip import slip_command
from contact.commands.stress import stress_command
from contact.commands.sweep import sweep_command
from contact.commands.trace import show_profile, trace_command
from contact.errors import ContactError, ModelWarning, NotConverged
from contact.extras import other_package, owners, require, version
from contact.interrupts import ExitStatus
from contact.model.registry import controls, interactions, laws, profiles, substrates
from contact.model.units import quantity
from contact.solution import export, report
from contact.solution.plan import Part, Plan, plan
from contact.solution.plotting import plot
from contact.solution.solution import Solution
from contact.solution.terminal import Progress, show_columns, show_table
from contact.solver import solve
from contact.sweeps.compare import compare, refusals, tables
from contact.sweeps.compare_plot import plot_comparison


@click.command("explore")
@click.argument("scene", type=click.Path(path_type=Path), required=False)
@click.option(
    "--port",
    type=click.IntRange(1, 65535),
    help="Port of the page; by default a free port is used.",
)
@click.option("--show/--no-show", default=True, help="Open a browser.")
@TOL
def explore_command(scene: Path | None, port: int | None, show: bool, tol: float) -> None:
    """Show a SCENE with sliders in a browser: its surfaces, pressure, load curve and stated error
    follow the sliders. Without a SCENE, a sine wave is shown.

    The page and all that it loads are served to this machine only (127.0.0.1). Ctrl-C ends it.
    """

    given = scene_of(scene) if scene is not None and str(scene) == "-" else scene
    page = require("contact.explorer.explore").explore(given, tol, port)
    click.echo(f"{page.address}  (Ctrl-C ends it)")
    if show:
        page.show()
    page.wait()


class Commands(click.Group):
    """A click group that turns each error into an exit status and one line on stderr."""

    def main(self, *args: Any, standalone_mode: bool = True, **extra: Any) -> Any:
        run: Callable[..., Any] = super().main
        if not standalone_mode:
            return run(*args, standalone_mode=False, **extra)
        try:
            with warnings.catch_warnings():
                # Every ModelWarning is printed, one line for each, unless Python's own warning
                # options say otherwise.
                warnings.filterwarnings("always", category=ModelWarning, append=True)
                warnings.showwarning = _show_warning
                status = run(*args, standalone_mode=False, **extra)
        except NotConverged as error:
            _stop(ExitStatus.NOT_CONVERGED, str(error))
        except BrokenPipeError:
            # The program that reads the output has closed the pipe. Without a new stdout, Python's
            # flush at exit would print an error.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            sys.exit(1)
        except click.ClickException as error:
            _stop(ExitStatus.BAD_INPUT, error.format_message())
        except (ContactError, OSError, ModelWarning) as error:
            # A ModelWarning arrives here if PYTHONWARNINGS turns warnings into errors.
            _stop(ExitStatus.BAD_INPUT, str(error))
        except click.Abort:
            _stop(ExitStatus.INTERRUPTED, "interrupted")
        sys.exit(status if isinstance(status, int) else 0)


def _show_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    click.echo(f"contact: warning: {' '.join(str(message).split())}", err=True)


def _stop(status: int, message: str) -> NoReturn:
    click.echo(f"contact: {' '.join(message.split())}", err=True)
    sys.exit(status)


def _say_version(context: click.Context, _: click.Parameter, asked: bool) -> None:
    if not asked:
        return
    click.echo(f"contact {version()}")
    others = ", ".join(owners())
    if others:
        click.echo(
            f"contact: warning: {others} is imported as `contact` too: "
            "keep one of them in an environment",
            err=True,
        )
    context.exit()


@click.group(
    cls=Commands,
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)
@click.option(
    "--version",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_say_version,
    help="Show the version, and whether another package is also imported as `contact`.",
)
@click.pass_context
def main(context: click.Context) -> None:
    """Exact elastic contact of rough and wavy bodies, from scene files in TOML. If SCENE is -, the
    scene is read from standard input.

    Exit status: 0 solved; 1 the reader of the output closed its pipe; 2 bad input or out of range;
    3 not converged; 130 interrupted.
    """
    if warning := other_package():
        click.echo(f"contact: warning: {warning}", err=True)
    if context.invoked_subcommand is None:
        click.echo(context.get_help())


@main.command("solve")
@SCENE
@AS_JSON
@save_option("Write zones and fields as netCDF (OUT.nc) or JSON (OUT.json).")
@csv_option("Write the zones as CSV.")
@csv_option("Write pressure and gap over x as CSV.", "--fields", "fields")
@plot_option("Draw the surfaces and the pressure.")
@click.option(
    "--branch",
    type=click.Choice(("advancing", "receding")),
    default="advancing",
    show_default=True,
    help="Under adhesion, take the contact reached by raising the control (advancing) or by "
    "lowering it (receding).",
)
@OVERWRITE
@QUIET
@TOL
def solve_command(
    scene: Path,
    as_json: bool,
    save: Path | None,
    table: Path | None,
    fields: Path | None,
    figure: Path | None,
    branch: str,
    overwrite: bool,
    quiet: bool,
    tol: float,
) -> None:
    """Solve a SCENE and print its zones, loads and checks."""
    problem = scene_of(scene)
    outputs = Outputs(overwrite)
    outputs.add("--save", save, {".nc": export.write_netcdf, ".json": export.write_json})
    outputs.add("--csv", table, {".csv": export.write_csv})
    outputs.add("--fields", fields, {".csv": export.write_fields})
    outputs.add_figure(figure, plot)
    start = time.perf_counter()
    with Progress(wanted=not quiet) as progress:
        solution = solve(problem, tol=tol, progress=progress, branch=branch)
    seconds = time.perf_counter() - start
    outputs.finish(solution, as_json, quiet, lambda: _show_solution(solution, seconds))


@main.command("plan")
@SCENE
@click.option(
    "--solve", "run", is_flag=True, help="Solve the scene, and show the time of each part."
)
@TOL
def plan_command(scene: Path, run: bool, tol: float) -> None:
    """Show which parts of the solver a SCENE needs and which it does not, without solving it.

    With --solve, the scene is solved; sizes and the time of each part are shown too.
    """
    problem = scene_of(scene)
    if not run:
        foreseen = plan(problem)
        show_table("plan", ("part", "used", "reason", "detail"), map(_cells, foreseen.parts))
        _show_decisions(foreseen)
        return
    with Progress() as progress:
        done = solve(problem, tol=tol, progress=progress).plan
    show_profile(problem.profile)
    timed = [(*_cells(part), *_time(part.seconds, done.share(part))) for part in done.parts]
    show_table("plan", ("part", "used", "reason", "detail", "time", "share"), timed, numeric=(4, 5))
    _show_decisions(done)
    sizes = [(name.replace("_", " "), str(count)) for name, count in done.counts.items()]
    show_table(
        "sizes",
        ("what", "number"),
        [*sizes, ("total time", quantity(done.seconds, "s", 3))],
        numeric=(1,),
    )


def _show_decisions(shown: Plan) -> None:
    """Print each decision of the solver between alternatives, with the reason."""
    rows = [(question, choice.way, choice.reason) for question, choice in shown.decisions.items()]
    show_table("decisions", ("question", "way", "reason"), rows)


def _cells(part: Part) -> tuple[str, str, str, str]:
    return part.name, "yes" if part.used else "no", part.reason, part.detail


def _time(seconds: float | None, share: float | None) -> tuple[str, str]:
    return (
        ("", "")
        if seconds is None or share is None
        else (quantity(seconds, "s", 3), f"{share:.0%}")
    )


@main.command("compare")
@SCENE
@plot_option("Draw the differences.")
@TOL
def compare_command(scene: Path, figure: Path | None, tol: float) -> None:
    """Solve a SCENE as isolated, localized (with and without explicit neighbours) and exact
    contact, side by side.
    """
    problem = scene_of(scene)
    outputs = Outputs()
    outputs.add_figure(figure, plot_comparison)
    with Progress() as progress:
        attempts = compare(problem, tol, progress)
    show_profile(problem.profile)
    for title, columns in tables(attempts):
        show_columns(title, columns, words=(0,))
    for line in refusals(attempts):
        click.echo(line)
    if all(attempt.solution is None for attempt in attempts):
        failures = [attempt.refusal for attempt in attempts if attempt.refusal is not None]
        raise next((error for error in failures if isinstance(error, NotConverged)), failures[-1])
    outputs.write(attempts)
    outputs.report()


main.add_command(slip_command)
main.add_command(path_command)
main.add_command(sweep_command)
main.add_command(stress_command)
main.add_command(trace_command)
main.add_command(explore_command)


@main.command("figures")
@click.argument("numbers", nargs=-1, metavar="[N]...")
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("figures"),
    show_default=True,
    help="Folder for figures and CSV files; it is made if it does not exist.",
)
def figures_command(numbers: tuple[str, ...], out: Path) -> None:
    """Draw figures N of the paper (2A 2B 7 8 9 10 11 12 13; all if none is named), and write the
    plotted numbers as CSV.

    Each figure shows the exact solution and the paper's curves; see docs/paper.
    """
    figures = require("contact.paper.figures")
    wanted = figures.chosen(numbers)
    with Progress() as progress:
        for done, number in enumerate(wanted):
            progress(f"figure {number}", done, len(wanted))
            for path in figures.write(number, out):
                click.echo(f"written: {path}")


@main.command("bench")
@click.option(
    "--quick", is_flag=True, help="Run fewer and smaller scenes; this takes about a minute."
)
@click.option(
    "--peers",
    is_flag=True,
    help="Run tamaas and ContactMechanics on the same scenes (extra `peers`).",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    required=True,
    help="Folder for tables, CSV files and figures; it is made if it does not exist.",
)
def bench_command(quick: bool, peers: bool, out: Path) -> None:
    """Measure error against run time, and cost against problem size; see docs/benchmarks."""
    suites = require("contact.studies.bench.run")
    require("matplotlib.figure")
    out.mkdir(parents=True, exist_ok=True)
    with Progress() as progress:
        tables = suites.bench(out, quick, peers, progress)
    for measured in tables:
        show_table(measured.title, measured.columns, measured.rows)
    click.echo(f"written: {out}")


@main.command("stability")
@click.option(
    "--quick", is_flag=True, help="Leave out scenes that take more than a few seconds each."
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="Folder for tables and a CSV file; it is made if it does not exist.",
)
def stability_command(quick: bool, out: Path | None) -> None:
    """Solve stiff and extreme scenes, and compare each error with the error that the scene's
    conditioning allows.

    Exit status 3 if a scene fails that is not known to fail.
    """
    suites = require("contact.studies.bench.run")
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
    with Progress() as progress:
        found, failed = suites.extremes(out, quick, progress)
    show_table(found.title, found.columns, found.rows)
    if failed:
        raise NotConverged(f"{failed} of {len(found.rows)} scenes fail unexpectedly")


def _listed(
    kind: str, known: Callable[[], Mapping[str, Any]], what: str, second: str = "parameters"
) -> None:
    """Add the command `kind`, which lists the names of this kind that a scene file can use."""

    @main.command(kind, help=f"List the {what} that a scene file can use.")
    def list_command() -> None:
        describe = _parameters if second == "parameters" else attrgetter(second)
        rows = [
            (name, describe(cls), ", ".join(getattr(cls, "allows", ())), _description(cls))
            for name, cls in known().items()
        ]
        heads = ("shape" if kind == "profiles" else "name", second, "controls", "what it is")
        shown = [0, 1, 2, 3] if any(row[2] for row in rows) else [0, 1, 3]
        show_table(kind, [heads[k] for k in shown], [[row[k] for k in shown] for row in rows])


_listed("profiles", profiles, "profile shapes, with their parameters,")
_listed("interactions", interactions, "interaction models, with their parameters and controls,")
_listed("substrates", substrates, "elastic bodies, with their parameters,")
_listed("laws", laws, "laws of the interface, with their parameters and controls,")
_listed("controls", controls, "controls, with their units,", "unit")


def _show_solution(solution: Solution, seconds: float, zones_shown: int = 20) -> None:
    """Print a solution as tables; of its zones, only the `zones_shown` widest are listed."""
    show_profile(solution.scene.profile)
    rows = [*report.numbers(solution), ("time", quantity(seconds, "s", 3), "")]
    show_table(report.title(solution.scene), report.HEADS, rows, numeric=(1, 2))
    show_table("checked", ("what", "value"), report.checks(solution))
    if columns := report.zone_columns(solution, zones_shown):
        show_columns("zones", columns, close=True)
    if (more := len(solution.zones) - zones_shown) > 0:
        click.echo(
            f"only the {zones_shown} widest zones are shown; --csv also writes the other {more}"
        )


def _parameters(cls: Any) -> str:
    """The parameters of a class as text, by the names that a scene file uses, with their default
    values.
    """
    text = _arguments(cls)
    return (
        f"{text}; or file, {_arguments(cls.from_file, but='path')}"
        if hasattr(cls, "from_file")
        else text
    )


def _arguments(function: Callable[..., Any], but: str = "") -> str:
    parameters = [p for p in inspect.signature(function).parameters.values() if p.name != but]
    return ", ".join(
        p.name if p.default in (p.empty, None) else f"{p.name} = {p.default!r}" for p in parameters
    )


def _description(cls: type) -> str:
    """The first paragraph of a class's docstring, as one line."""
    return " ".join((inspect.getdoc(cls) or "").partition("\n\n")[0].split())
