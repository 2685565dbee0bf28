"""`contact trace FILE`: a measured trace with its roughness and preparation, and a first scene
file.

The picture of --plot shows the points as read and after each step of the preparation, the
distribution of heights, and the power spectrum.
"""

import json
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from textwrap import fill
from typing import Any

import click
import numpy as np

from contact.commands.options import AS_JSON, OVERWRITE, Outputs, plot_option
from contact.errors import SceneError, warn
from contact.model.profiles.base import Profile
from contact.model.profiles.sampled import Sampled
from contact.model.scene_file import load_scene, toml
from contact.model.traces.prepare import Trace, load_trace
from contact.model.traces.roughness import Roughness, height_distribution, power_spectrum, roughness
from contact.model.units import quantity, scaled
from contact.solution.drawing import BODY, PRESSURE, SURFACE, inner_ticks, new_figure, shared_unit
from contact.solution.terminal import show_table
from sie import Array

# Material of the scene that the command writes: steel on a rigid flat.
_STEEL_MODULUS = 210e9  # [Pa]
_STEEL_POISSON_RATIO = 0.3


def _number(text: str) -> Any:
    """The value that a text has in TOML: true or false, a number, or else the text itself."""
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text


def _list(text: str) -> list[Any]:
    return [_number(part.strip()) for part in text.split(",")]


def _one_or_two(text: str) -> Any:
    parts = [part.strip() for part in text.split(",")]
    return parts[0] if len(parts) == 1 else parts


def _line(text: str) -> Any:
    parts = _list(text)
    return parts[0] if len(parts) == 1 else [parts[:2], parts[2:]]


# Keys of [profile] as options of the command: the parser of an option's text, its placeholder in
# the help, and its description.
KEYS: dict[str, tuple[Callable[[str], Any], str, str]] = {
    "columns": (_list, "X,Z", "Columns of positions and heights: numbers from 0, or names."),
    "units": (_one_or_two, "U[,U]", "Unit of the file, or two units: of positions, of heights."),
    "pitch": (_number, "M", "Distance between points [m], for a file of heights only."),
    "decimal": (str, "MARK", "Decimal mark: . or ,"),
    "delimiter": (str, "MARK", "Delimiter between columns: ; , tab or blank."),
    "channel": (_number, "NAME|N", "Channel of an instrument's file: its name or number."),
    "line": (_line, "N|X,Y,X,Y", "Line of a map: its number, or its two end points [m]."),
    "along": (str, "x|y", "Direction of a line that is given by its number."),
    "missing": (str, "MARK", "Text or number that the file has for a missing height."),
    "fill": (str, "linear|drop", "Interpolate missing heights (linear), or drop their points."),
    "sort": (_number, "true", "Sort points that are out of order."),
    "invert": (
        _number,
        "true",
        "true: the heights are depths, turn them upside down; false: keep.",
    ),
    "regrid": (_number, "true|N", "Interpolate to N even positions; true: as many as points."),
    "lambda_s": (_number, "M", "Cutoff [m] of a Gaussian filter: removes shorter waves."),
    "detrend": (_number, "KIND", "Form to subtract: none, line, quadratic, or a degree."),
    "lambda_c": (_number, "M", "Cutoff [m] of a Gaussian filter: removes longer waves."),
    "taper": (
        _number,
        "PART",
        "Fraction of the length, at each end, over which heights level out.",
    ),
    "period": (_number, "true|M", "Length of the period [m]; true: the measured length."),
}


def _with_keys(command: Callable[..., None]) -> Callable[..., None]:
    for name, (_, metavar, help_text) in reversed(KEYS.items()):
        command = click.option(
            f"--{name.replace('_', '-')}", name, metavar=metavar, help=help_text
        )(command)
    return command


@click.command("trace")
@click.argument("file", type=click.Path(path_type=Path))
@_with_keys
@plot_option("Draw the preparation, the distribution of heights and the power spectrum.")
@click.option(
    "--scene",
    type=click.Path(path_type=Path),
    metavar="OUT.toml",
    help="Write a first scene file with this trace.",
)
@OVERWRITE
@AS_JSON
def trace_command(
    file: Path,
    figure: Path | None,
    scene: Path | None,
    overwrite: bool,
    as_json: bool,
    **options: str | None,
) -> None:
    """Read a trace from a FILE and print its length, pitch, heights and roughness, and the steps
    of its preparation.
    """
    if file.suffix.lower() == ".toml":
        raise SceneError.of(
            "FILE",
            str(file),
            "a file with the points of a trace; for a scene file use `contact solve`",
        )
    keys = {name: KEYS[name][0](text) for name, text in options.items() if text is not None}

    def write_scene(read: Sampled, path: Path, _: bool) -> None:
        path.write_text(
            starting_scene(file, path.parent, keys, measured, read.period), encoding="utf-8"
        )
        # Reading back the written file raises SceneError if it is not a valid scene.
        load_scene(path)

    outputs = Outputs(overwrite)
    outputs.add_figure(
        figure,
        lambda read: plot_trace(trace, measured, power_spectrum(read), height_distribution(read)),
    )
    outputs.add("--scene", scene, {".toml": write_scene})
    trace = load_trace(file, **keys)
    warn(trace.warnings)
    profile = Sampled(trace.x, trace.height, trace.period)
    measured = roughness(profile)
    if as_json:
        click.echo(
            json.dumps(
                {"file": str(file), "history": trace.history, **vars(measured)}, allow_nan=False
            )
        )
    else:
        show_trace(f"trace {file.name}", measured, trace.history)
    outputs.write(profile)
    outputs.report(err=as_json)


def show_trace(title: str, measured: Roughness, history: tuple[str, ...]) -> None:
    """Print the roughness parameters of a trace and the steps of its preparation."""
    pitch = quantity(measured.pitch, "m")
    rows = [
        ("points", str(measured.points)),
        ("length", quantity(measured.length, "m", 6)),
        ("pitch", pitch if measured.even else f"{pitch} on average, uneven"),
        ("highest to lowest point", quantity(measured.depth, "m")),
        ("Ra", quantity(measured.Ra, "m")),
        ("Rq", quantity(measured.Rq, "m")),
        ("Rsk", f"{measured.Rsk:.4g}"),
        ("Rku", f"{measured.Rku:.4g}"),
        ("rms slope", f"{measured.rms_slope:.4g}"),
        *((f"step {place}" if place else "read", done) for place, done in enumerate(history)),
    ]
    show_table(title, ("quantity", "value"), rows)


def show_profile(profile: Profile) -> None:
    """Print the traces of a profile that were read from files, and a table of its bodies if there
    are two.
    """
    pair = len(profile.bodies) > 1
    if pair:
        rows = [
            (place, str(table["shape"]), _parameters(table, {**profile.units, **body.units}))
            for (place, table), body in zip(
                profile.tables().items(), profile.bodies.values(), strict=True
            )
        ]
        show_table(
            "two bodies",
            ("body", "shape", "parameters"),
            [*rows, ("together", "", _together(profile))],
        )
    for place, body in profile.bodies.items():
        if isinstance(body, Sampled) and body.history:
            show_trace(
                f"trace of {place} after its preparation"
                if pair
                else "trace after its preparation",
                roughness(body),
                body.history,
            )


def _parameters(table: Mapping[str, Any], units: Mapping[str, str]) -> str:
    """The parameters of a body as text; a list of numbers is given by its length only."""
    given = {key: value for key, value in table.items() if key != "shape" and value is not None}
    return ", ".join(
        f"{key} {len(value)} numbers"
        if np.ndim(value)
        else f"{key} {_value(value, units.get(key))}"
        for key, value in given.items()
    )


def _value(value: Any, unit: str | None) -> str:
    """One parameter as text; a number has its unit, if that is known."""
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    return quantity(value, unit, 6) if unit and number else str(value)


def _together(profile: Profile) -> str:
    """The common period of two bodies, or the interval that both profiles cover, as text."""
    if profile.period is not None:
        cells = [
            f"{round(profile.period / body.period)} of {place}"
            for place, body in profile.bodies.items()
            if body.period
        ]
        return f"period {quantity(profile.period, 'm', 6)}: {', '.join(cells)}"
    ends = profile.support or profile.extent
    if ends is None:
        return "no period"
    return f"face each other from {quantity(ends[0], 'm', 6)} to {quantity(ends[1], 'm', 6)}"


def starting_scene(
    file: Path,
    folder: Path,
    keys: Mapping[str, Any],
    measured: Roughness,
    period: float | None,
    light_load: float = 0.01,
) -> str:
    """The text of a scene file with the trace pressed onto a rigid flat under a light load.

    light_load: mean pressure, divided by E* times the rms slope.
    """
    modulus = _STEEL_MODULUS / (1 - _STEEL_POISSON_RATIO**2)
    pressure = light_load * modulus * measured.rms_slope
    name = Path(os.path.relpath(file, folder)).as_posix()
    lines = [
        "[profile]",
        'shape = "sampled"',
        f"file = {toml(name)}",
        *(f"{key} = {toml(value)}" for key, value in keys.items()),
    ]
    lines += [
        "",
        "[material]              # steel; the counter-face is rigid: E2 and nu2 are left out",
        f"E1 = {_STEEL_MODULUS / 1e9:g}e9",
    ]
    lines += [f"nu1 = {_STEEL_POISSON_RATIO}", "", "[interaction]"]
    comment = f"# {light_load:g} E* times the rms slope, {measured.rms_slope:.4g}"
    if period is not None:
        lines += ['model = "periodic"', "", "[control]", comment, f"mean_pressure = {pressure:.4g}"]
    else:
        lines += ['model = "isolated"         # no period is given', "", "[control]"]
        lines += [
            f"{comment}, on a thousandth of the trace's length [N/m]",
            f"load = {1e-3 * pressure * measured.length:.4g}",
        ]
    return "\n".join(lines) + "\n"


def plot_trace(
    trace: Trace,
    measured: Roughness,
    spectrum: tuple[Array, Array],
    heights: tuple[Array, Array],
    title_length: int = 125,
) -> Any:
    """A matplotlib figure with one row for each step of the preparation. The last row shows the
    distribution of heights and the power spectrum after the last step.

    title_length: the name of a step is broken into lines of at most this many letters.
    """
    stages = list(trace.stages)
    figure = new_figure(9.0, 1.7 * len(stages) + 3.0)
    grid = figure.add_gridspec(len(stages) + 1, 2, height_ratios=[1.0] * len(stages) + [1.7])
    along, along_unit = scaled(max(float(np.nanmax(x) - np.nanmin(x)) for _, x, _ in stages), "m")
    spans = [float(np.nanmax(height) - np.nanmin(height)) for *_, height in stages]
    up, up_unit = shared_unit("m", measured.Rq, *spans)
    rows: list[Any] = []
    for row, (name, x, height) in enumerate(stages):
        rows.append(figure.add_subplot(grid[row, :], sharex=rows[0] if rows else None))
        axes, last = rows[-1], row == len(stages) - 1
        axes.plot(along * x, up * height, color=SURFACE if last else BODY, lw=0.7)
        for at in x[~np.isfinite(height)]:
            axes.axvline(along * at, color=PRESSURE, lw=0.5, alpha=0.5)
        axes.set_title(fill(name, title_length), fontsize=8, loc="left")
        axes.set_ylabel(f"height [{up_unit}]", fontsize=8)
        axes.tick_params(labelsize=8, labelbottom=last)
        inner_ticks(axes)
        axes.margins(x=0.0)
    rows[-1].set_xlabel(f"$x$ [{along_unit}]", fontsize=8)
    _distribution(figure.add_subplot(grid[-1, 0]), measured, heights, (up, up_unit))
    _spectrum(figure.add_subplot(grid[-1, 1]), measured, *spectrum)
    return figure


def _distribution(
    axes: Any, measured: Roughness, heights: tuple[Array, Array], scale: tuple[float, str]
) -> None:
    """Draw the distribution of the heights, and the normal distribution with the same Rq.
    heights: (edges of the height classes [m], probability density in each class [1/m]); scale:
    (units per metre, name of the unit) of the heights in the picture.
    """
    (edges, density), (up, unit) = heights, scale
    axes.stairs(density / up, up * edges, fill=True, color=BODY, alpha=0.5)
    z = np.linspace(edges[0], edges[-1], 200)
    gauss = np.exp(-0.5 * (z / measured.Rq) ** 2) / (measured.Rq * np.sqrt(2 * np.pi))
    axes.plot(
        up * z,
        gauss / up,
        color=SURFACE,
        lw=1.0,
        label=f"Gauss, Rq = {quantity(measured.Rq, 'm', 3)}",
    )
    axes.set_xlabel(f"height above the mean [{unit}]", fontsize=8)
    axes.set_ylabel(f"density [1/{unit}]", fontsize=8)
    axes.tick_params(labelsize=8)
    inner_ticks(axes)
    axes.legend(fontsize=8, frameon=False)


def _spectrum(axes: Any, measured: Roughness, q: Array, density: Array) -> None:
    seen = density > 1e-12 * density.max()
    axes.loglog(q[seen], density[seen], color=SURFACE, lw=0.7)
    axes.set_xlabel(r"wavenumber $q = 2\pi/\lambda$ [1/m]", fontsize=8)
    axes.set_ylabel("power spectrum C [m$^3$]", fontsize=8)
    axes.set_title(f"rms slope {measured.rms_slope:.3g}", fontsize=8, loc="left")
    axes.tick_params(labelsize=8)
    inner_ticks(axes)
