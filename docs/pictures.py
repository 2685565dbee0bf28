"""Runs the examples and keeps what they show: python docs/pictures.py [NAME ...].

Pictures of pages are drawn, too: docs/images/NAME.png for images/NAME.

Of each script of `examples` and `examples/engine`, and of each scene file, it writes a picture of
the solutions, docs/gallery/NAME.png, and the printed text, docs/gallery/NAME.txt. The site is built
from scripts, pictures and texts (docs/gallery.py).
"""

from __future__ import annotations

import contextlib
import importlib.util
import io
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

import contact
import sie
from contact.extras import require
from contact.model.registry import parameters
from contact.model.units import quantity, scaled
from contact.solution.drawing import (
    FIGURE,
    inner_ticks,
    legend_outside,
    new_figure,
    shared_unit,
    stretches,
)
from contact.solution.plotting import Heights, draw_pressure, draw_surfaces, mark_close_up, summary
from contact.solution.sampling import positions, window
from contact.solution.stress_plot import columns_of, draw_stress, label_of, plot_stress, top_stress
from contact.solution.stress_report import stress_report

ROOT = Path(__file__).parents[1]
EXAMPLES = ROOT / "examples"
KEPT = ROOT / "docs" / "gallery"

_DASHES: tuple[Any, ...] = (
    "-",
    (0, (6, 2)),
    (0, (2, 1)),
    (0, (6, 2, 1, 2)),
    (0, (8, 1)),
    (0, (1, 1)),
)
_COLOURS = ("#1f5a92", "#b3261e", "#3d7a4a", "#8a5a00", "#6a3d8a", "#444444")
# Lines that can be told apart in grey, too.
_LINES = [
    {"color": colour, "linestyle": dashes, "lw": 1.3}
    for colour, dashes in zip(_COLOURS, _DASHES, strict=True)
]


def scripts() -> dict[str, Path]:
    """Return the file of every example by its name."""
    found = ((EXAMPLES, "*.py"), (EXAMPLES / "engine", "*.py"), (EXAMPLES, "*.toml"))
    return {file.stem: file for folder, ending in found for file in sorted(folder.glob(ending))}


@contextlib.contextmanager
def _recorded(package: Any, found: list[Any], name: str = "solve") -> Iterator[None]:
    """Collect what a function of a package returns within the block."""
    function = getattr(package, name)

    def recording(*given: Any, **options: Any) -> Any:
        result = function(*given, **options)
        found.append(result)
        return result

    setattr(package, name, recording)
    try:
        yield
    finally:
        setattr(package, name, function)


@dataclass
class Shown:
    """What a script has shown: load paths, solutions of `contact` and `sie`, what its main function
    returned, and its print.
    """

    paths: list[contact.Path]
    contacts: list[contact.Solution]
    equations: list[sie.Solution]
    returned: Any
    printed: str


def run(file: Path) -> Shown:
    """Run a script and keep what it shows."""
    spec = importlib.util.spec_from_file_location(f"gallery_{file.stem}", file)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    paths: list[Any] = []
    contacts: list[Any] = []
    equations: list[Any] = []
    printed = io.StringIO()
    with (
        _recorded(contact, paths, "path"),
        _recorded(contact, contacts),
        _recorded(sie, equations),
        contextlib.redirect_stdout(printed),
    ):
        spec.loader.exec_module(module)
        returned = module.main()
    return Shown(paths, contacts, equations, returned, printed.getvalue())


def _distinct(solutions: list[contact.Solution]) -> list[contact.Solution]:
    """Return the last solution of each model, or of each shape, or else of each scene."""
    models = {repr(one.scene.interaction): one for one in solutions}
    shapes = {repr(one.scene.profile): one for one in solutions}
    last = (
        models
        if len(models) > 1
        else shapes
        if len(shapes) > 2
        else {repr(one.scene): one for one in solutions}
    )
    return list(last.values())[-len(_LINES) :]


def of_contact(solutions: list[contact.Solution]) -> Any:
    """A figure: the surfaces of the last solution above, the pressures of all below."""
    shown = _distinct(solutions)
    last = shown[-1]
    if len(shown) == 1:
        return last.plot()
    figure = new_figure(6.4, 5.0)
    top, bottom = figure.subplots(2, 1, sharex=True)
    ends = [window(one) for one in shown]
    whole, own = stretches((min(lo for lo, _ in ends), max(hi for _, hi in ends)), window(last))
    heights = Heights.of(last, own)
    draw_surfaces(top, last, own, (heights, *shared_unit("m", heights.size)), marked=False)
    peaks = [
        one.max_pressure
        if np.isfinite(one.max_pressure)
        else 3.0 * abs(one.load) / one.zone_widths.sum()
        for one in shown
    ]
    labels, lowest = _labels(shown), 0.0
    up, unit = scaled(max(peaks), "Pa")
    name, scales, highest = f"pressure [{unit}]", [up] * len(shown), up * max(peaks)
    if min(peaks) < FIGURE.min_visible * max(peaks):
        # A pressure that could not be seen beside the others is drawn over its own peak.
        name, scales, highest = "pressure / its largest value", [1 / peak for peak in peaks], 1.0
        labels = [f"{a}: {quantity(p, 'Pa', 3)}" for a, p in zip(labels, peaks, strict=True)]
    for place, (one, label) in enumerate(zip(shown, labels, strict=True)):
        x = positions(one, *window(one))
        pressure = np.clip(scales[place] * one.pressure(x), -highest, 1.5 * highest)
        lowest = min(lowest, float(pressure.min()))
        bottom.plot(whole.along(x), pressure, label=label, **_LINES[place])
    bottom.set(ylabel=name, xlabel=whole.label, xlim=whole.limits)
    bottom.set_ylim(1.08 * lowest, 1.08 * highest)
    for axes in (top, bottom):
        inner_ticks(axes)
    if len({repr(one.scene) for one in shown}) > 1:
        top.set_title(f"surfaces: {labels[-1]}", fontsize=8, loc="left")
    # Entries of a legend stand side by side as far as the figure is wide.
    legend_outside(figure, (bottom,), columns=max(1, 72 // (8 + max(map(len, labels)))))
    return figure


def _labels(shown: list[contact.Solution]) -> list[str]:
    """Return a label for each solution; no two are equal."""
    found = [_label(one, shown) for one in shown]
    for differing in (
        lambda one: one.scene.law.name,
        lambda one: f"modulus {quantity(one.scene.E_star, 'Pa')}",
        _shape_of(shown),
    ):
        if len(set(found)) == len(found):
            break
        parts = [differing(one) for one in shown]
        if len(set(parts)) > 1:
            found = [f"{label}, {part}" for label, part in zip(found, parts, strict=True)]
    return found


def _shape_of(shown: list[contact.Solution]) -> Callable[[contact.Solution], str]:
    """Return a function that numbers the profiles of solutions."""
    known = list(dict.fromkeys(repr(one.scene.profile) for one in shown))
    return lambda one: f"shape {1 + known.index(repr(one.scene.profile))}"


def _label(one: contact.Solution, shown: list[contact.Solution]) -> str:
    """Return a label that distinguishes a scene from the others."""
    if len({repr(other.scene.interaction) for other in shown}) > 1:
        model = one.scene.interaction
        given = {name: value for name, value in parameters(model).items() if value is not None}
        parts = [v if isinstance(v, str) else f"{name} {v:g}" for name, v in given.items()]
        return ", ".join((model.name or type(model).__name__, *parts))
    laws = [parameters(other.scene.law) for other in shown]
    alike = len({other.scene.law.name for other in shown}) == 1
    for name, value in parameters(one.scene.law).items() if alike else ():
        if len({other.get(name) for other in laws}) > 1:
            return f"{name} {value:g}"
    if len({other.moment for other in shown}) > 1 and one.scene.moment is not None:
        return f"moment {quantity(one.scene.moment, 'N')}"
    if len({other.scene.profile.name for other in shown}) > 2:
        return one.scene.profile.name
    varied = _varied(shown)
    if len(varied) == 1:
        table, name = varied[0]
        profile = one.scene.profile
        return f"{name} {quantity(profile.tables()[table][name], profile.units.get(name, ''))}"
    pressed = (
        quantity(one.load, "N/m")
        if one.mean_pressure is None
        else quantity(one.mean_pressure, "Pa")
    )
    if len(shown) > 1 and len({f"{other.load:.6g}" for other in shown}) == 1:
        return f"largest pressure {quantity(one.max_pressure, 'Pa')}"
    return f"{pressed}, {len(one.zones)} zones" if len(one.zones) > 1 else pressed


def _varied(shown: list[contact.Solution]) -> list[tuple[str, str]]:
    """Return (table, name) of every number of the profiles that differs between them."""
    tables = [one.scene.profile.tables() for one in shown]
    keys = [
        (table, name)
        for table, values in tables[0].items()
        for name, value in values.items()
        if np.isscalar(value)
    ]
    return [
        (table, name)
        for table, name in keys
        if len({repr(other.get(table, {}).get(name)) for other in tables}) > 1
    ]


def limited_trace(hardness: float = 6e9) -> contact.Solution:
    """The stylus trace under a limit of the pressure."""
    scene = contact.load_scene(EXAMPLES / "stylus.toml")
    return contact.solve(replace(scene, law=contact.Plastic(hardness)), tol=1e-6)


def of_limited_trace() -> Any:
    """A figure of the stylus trace under a limit of the pressure: all of it on the left, and the
    pressure and the stress below the spike with the largest stress on the right.
    """
    solution, show = limited_trace(), "mises"
    report = stress_report(solution)
    whole, spike = columns_of(report, show)
    figure = new_figure(10.2, 5.0)
    grid = figure.add_gridspec(2, 2, width_ratios=[1.35, 1.0], height_ratios=[1.0, 1.0])
    trace, pressure = (figure.add_subplot(grid[row, 0]) for row in range(2))
    above, below = (figure.add_subplot(grid[row, 1]) for row in range(2))
    heights = Heights.of(solution, whole.along)
    draw_surfaces(
        trace, solution, whole.along, (heights, *shared_unit("m", heights.size)), marked=False
    )
    trace.set_title("a measured trace, and the flat below it", fontsize=9)
    draw_pressure(pressure, solution, whole.along)
    draw_pressure(above, solution, spike.along)
    above.set_title("one spike: pressure, and stress below it", fontsize=9)
    field = spike.field(report, show)
    top = top_stress(report, show, [field])
    shading = draw_stress(below, report, show, field, (spike, top))
    figure.colorbar(shading, ax=below, pad=0.01, format="%.3g").set_label(label_of(show, top))
    for axes, column in ((trace, whole), (pressure, whole), (above, spike)):
        axes.set_xlim(column.along.limits)
        inner_ticks(axes)
    for axes in (trace, above):
        axes.tick_params(labelbottom=False)
    mark_close_up((trace, pressure), whole.along, spike.along)
    pressure.set_xlabel(whole.along.label)
    legend_outside(figure, (trace, above))
    figure.supxlabel(summary(solution), fontsize=9)
    return figure


def of_path() -> Any:
    """A figure of a load path with births, mergers and full contact."""
    profile = contact.Fourier(1e-4, cosine=[-1e-6, 0.3e-6, 0.25e-6], sine=[0.2e-6])
    scene = contact.Scene(profile, 1.1e11, contact.Periodic(), load=1.0)
    return contact.path(scene, np.linspace(1e4, 7e5, 24)).plot()


def _stresses(name: str, show: str, strength: float | None = None) -> Any:
    solution = contact.solve(contact.load_scene(EXAMPLES / f"{name}.toml"))
    return plot_stress(stress_report(solution, strength=strength), show)


# Pictures of pages, docs/images/NAME.png, by the name with its folder; each with its resolution.
PAGES: dict[str, tuple[Callable[[], Any], int]] = {
    "images/limited": (of_limited_trace, 200),
    "images/stylus": (
        lambda: contact.solve(contact.load_scene(EXAMPLES / "stylus.toml")).plot(),
        200,
    ),
    "images/inside": (lambda: _stresses("stylus", "mises", 2e9), 100),
    "images/fringes": (lambda: _stresses("wave", "fringes"), 90),
    "images/curve": (of_path, 130),
}


def numbers(solution: contact.Solution) -> str:
    """Return the numbers of a solution, one a line."""
    fraction = solution.contact_fraction
    lines = [
        ("zones", str(len(solution.zones))), ("load", quantity(solution.load, "N/m")),
        ("largest pressure", quantity(solution.max_pressure, "Pa")), ("approach", quantity(solution.approach, "m")),
        ("contact fraction", "not defined" if fraction is None else f"{100 * fraction:.4g} %"), ("stated error", f"{solution.error:.0e}"),
    ]  # fmt: skip
    return "".join(f"{name:18}{value}\n" for name, value in lines)


def save(figure: Any, file: Path, dpi: int = 110) -> None:
    """Write a figure as PNG of 128 colours, a third of the size of a full one."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=dpi)
    require("PIL.Image").open(stream).convert("RGB").quantize(128, method=2, dither=0).save(
        file, optimize=True
    )


def keep(name: str, file: Path, folder: Path = KEPT) -> None:
    """Run one example and write its picture and its print."""
    folder.mkdir(parents=True, exist_ok=True)
    if file.suffix == ".toml":
        solution = contact.solve(contact.load_scene(file))
        save(solution.plot(), folder / f"{name}.png", dpi=80)
        (folder / f"{name}.txt").write_text(numbers(solution), encoding="utf-8")
        return
    # This module stands beside this script.
    from engine_pictures import DENSITIES, DRAWINGS, of_densities

    shown = run(file)
    if shown.paths:
        save(shown.paths[-1].plot(), folder / f"{name}.png", dpi=80)
    elif isinstance(shown.returned, list) and isinstance(shown.returned[-1], contact.Slip):
        save(shown.returned[-1].plot(), folder / f"{name}.png", dpi=80)
    elif isinstance(shown.returned, contact.Yield):
        report = stress_report(shown.returned.solution)
        save(plot_stress(report, "mises"), folder / f"{name}.png", dpi=70)
    elif name in DRAWINGS:
        save(DRAWINGS[name](shown.returned, _LINES), folder / f"{name}.png")
    else:
        figure = (
            of_contact(shown.contacts)
            if shown.contacts
            else of_densities(shown.equations[-len(_LINES) :], DENSITIES[name], _LINES)
        )
        save(figure, folder / f"{name}.png")
    (folder / f"{name}.txt").write_text(shown.printed, encoding="utf-8")


if __name__ == "__main__":
    for name in sys.argv[1:] or [*scripts(), *PAGES]:
        if name in PAGES:
            draw, dpi = PAGES[name]
            save(draw(), ROOT / "docs" / f"{name}.png", dpi)
            print(f"written: docs/{name}.png")
        else:
            keep(name, scripts()[name])
            print(f"written: {KEPT / name}.png, .txt")
