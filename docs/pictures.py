"""Runs the examples and keeps what they show: python docs/pictures.py [NAME ...].

Of each script of `examples` and `examples/engine`, and of each scene file, it writes a picture of
the solutions, docs/gallery/NAME.png, and the printed text, docs/gallery/NAME.txt. The site is built
from scripts, pictures and texts (docs/gallery.py).
"""

from __future__ import annotations

import contextlib
import importlib.util
import io
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import contact
import sie
from contact.extras import require
from contact.model.registry import parameters
from contact.model.units import quantity, scaled
from contact.solution.sampling import positions, surfaces, window
from contact.solution.stress_plot import plot_stress
from contact.solution.stress_report import stress_report

ROOT = Path(__file__).parents[1]
EXAMPLES = ROOT / "examples"
KEPT = ROOT / "docs" / "gallery"

_COLOURS = ("#1f5a92", "#b3261e", "#3d7a4a", "#8a5a00", "#6a3d8a", "#444444")


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
    return list(last.values())[-len(_COLOURS) :]


def of_contact(solutions: list[contact.Solution]) -> Any:
    """A figure: the surfaces of the last solution above, the pressures of all below."""
    shown = _distinct(solutions)
    figure = require("matplotlib.figure").Figure(figsize=(6.0, 4.2), layout="constrained")
    top, bottom = figure.subplots(2, 1, sharex=True)
    lo, hi = min(window(one)[0] for one in shown), max(window(one)[1] for one in shown)
    along, unit = scaled(max(abs(lo), abs(hi)), "m")
    last = shown[-1]
    x = positions(last, *window(last))
    surface, body = (np.where(np.isfinite(side), side, np.nan) for side in surfaces(last, x))
    reach = float(np.nanmax(np.append(body, surface)) - np.nanmin(np.append(body, surface)))
    up, high = scaled(reach, "m")
    top.plot(x * along, body * up, color="#7a7a7a", lw=1.0)
    top.plot(x * along, surface * up, color="#1f5a92", lw=1.4)
    top.set_ylabel(f"height [{high}]")
    peaks = [
        one.max_pressure
        if np.isfinite(one.max_pressure)
        else 3.0 * abs(one.load) / one.zone_widths.sum()
        for one in shown
    ]
    push, size = scaled(max(peaks), "Pa")
    for one, colour in zip(shown, _COLOURS, strict=False):
        x = positions(one, *window(one))
        pressure = np.clip(one.pressure(x), -max(peaks), 1.5 * max(peaks))
        bottom.plot(x * along, pressure * push, color=colour, lw=1.2, label=_label(one, shown))
    bottom.set(ylabel=f"pressure [{size}]", xlabel=f"x [{unit}]", xlim=(lo * along, hi * along))
    bottom.set_ylim(top=1.08 * max(peaks) * push)
    bottom.legend(fontsize=7, frameon=False)
    return figure


def _label(one: contact.Solution, shown: list[contact.Solution]) -> str:
    """Return a label that distinguishes a scene from the others."""
    if len({repr(other.scene.interaction) for other in shown}) > 1:
        return f"{one.scene.interaction}".replace("closure=", "").replace("neighbours=", "")
    laws = [parameters(other.scene.law) for other in shown]
    for name, value in parameters(one.scene.law).items():
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


def of_engine(found: list[sie.Solution]) -> Any:
    """A figure of the densities of the last solutions on their intervals."""
    figure = require("matplotlib.figure").Figure(figsize=(6.0, 3.2), layout="constrained")
    axes = figure.subplots()
    t = np.sin(np.linspace(-0.5, 0.5, 301) * np.pi)
    top = low = 0.0
    for one, colour in zip(found[-len(_COLOURS) :], _COLOURS, strict=False):
        for zone, (a, b) in enumerate(zip(one.zones.a, one.zones.b, strict=True)):
            x = 0.5 * (a + b) + 0.5 * (b - a) * t[1:-1]
            density = one.density.at_t(zone, t[1:-1])
            top = max(top, 4.0 * float(np.median(np.abs(density))))
            low = min(low, float(np.min(density)))
            axes.plot(x, density, color=colour, lw=1.2)
    axes.axhline(0.0, color="black", lw=0.5)
    axes.set(xlabel="x", ylabel="density", ylim=(max(low, -top) - 0.02 * top, top))
    return figure


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
    from engine_pictures import DRAWINGS  # stands beside this script

    shown = run(file)
    if shown.paths:
        save(shown.paths[-1].plot(), folder / f"{name}.png", dpi=80)
    elif isinstance(shown.returned, list) and isinstance(shown.returned[-1], contact.Slip):
        save(shown.returned[-1].plot(), folder / f"{name}.png", dpi=80)
    elif isinstance(shown.returned, contact.Yield):
        report = stress_report(shown.returned.solution)
        save(plot_stress(report, "mises"), folder / f"{name}.png", dpi=70)
    elif name in DRAWINGS:
        save(DRAWINGS[name](shown.returned), folder / f"{name}.png")
    else:
        figure = of_contact(shown.contacts) if shown.contacts else of_engine(shown.equations)
        save(figure, folder / f"{name}.png")
    (folder / f"{name}.txt").write_text(shown.printed, encoding="utf-8")


if __name__ == "__main__":
    wanted = sys.argv[1:] or list(scripts())
    for name in wanted:
        keep(name, scripts()[name])
        print(f"written: {KEPT / name}.png, .txt")
