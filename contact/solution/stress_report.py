"""Stresses below the surface of a solution: the largest stresses, first yield, and files."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from os import PathLike
from typing import Any

import numpy as np

from contact.errors import ContactError
from contact.extras import require, version
from contact.inside.largest import Criterion, Peak, largest
from contact.inside.stress import Stress
from contact.inside.yielding import Yield, check, infinite_at
from contact.solution.export import describe, new_file, plain
from contact.solution.sampling import window
from contact.solution.solution import Solution
from sie import Array


@dataclass(frozen=True)
class StressReport:
    """The largest stresses of a solution and, if a strength is given, its first yield.

    nu: Poisson's ratio. shear, mises: the largest shear stress in the plane and the largest von
    Mises stress; None if the stress is infinite, at x = `infinite` [m]. yields: first yield;
    not_found: why it was not found, or "".
    """

    solution: Solution
    nu: float
    lateral: str
    shear: Peak | None
    mises: Peak | None
    infinite: float | None = None
    strength: float | None = None
    criterion: str = "mises"
    yields: Yield | None = None
    not_found: str = ""

    def to_dict(self) -> dict[str, Any]:
        """The largest stresses and the first yield as a dictionary that JSON can represent."""
        first: dict[str, Any] | None = None
        if self.strength is not None:
            names = ("load", "x", "y", "error", "note")
            first = {name: getattr(self.yields, name, None) for name in names}
            first["note"] = first["note"] or self.not_found
            first |= {"strength": self.strength, "criterion": self.criterion}
        values = {
            "load": self.solution.load,
            "max_pressure": self.solution.max_pressure,
            "nu": self.nu,
            "lateral": self.lateral,
            "largest_shear": _of_peak(self.shear),
            "largest_mises": _of_peak(self.mises),
            "infinite_at": self.infinite,
            "first_yield": first,
            "scene": describe(self.solution.scene),
            "version": version(),
        }
        return {name: plain(value) for name, value in values.items()}

    def stress(self, x: Array, y: Array) -> Stress:
        return self.solution.stress(x, y, self.lateral, self.nu)


def _of_peak(peak: Peak | None) -> dict[str, float] | None:
    return None if peak is None else dict(vars(peak))


def stress_report(
    solution: Solution,
    nu: float = 0.3,
    lateral: str = "as loaded",
    strength: float | None = None,
    criterion: str = "mises",
) -> StressReport:
    """The largest stresses of a solution, and first yield if a strength [Pa] is given."""
    solution.stress(0.0, 1.0, lateral, nu)  # raises SceneError if an argument or the body is wrong
    if strength is not None:
        check(strength, Criterion(criterion, nu, lateral))
    infinite = infinite_at(solution)
    shear, mises = (
        None if infinite is not None else largest(solution, Criterion(name, nu, lateral))
        for name in ("shear", "mises")
    )
    report = StressReport(solution, nu, lateral, shear, mises, infinite, strength, criterion)
    if strength is None:
        return report
    try:
        return replace(report, yields=solution.first_yield(strength, nu, criterion, lateral))
    except ContactError as error:
        return replace(report, not_found=str(error))


def grid(
    report: StressReport, lo: float, hi: float, depth: float, shape: tuple[int, int] = (300, 140)
) -> tuple[Array, Array, Stress]:
    """Places x (n,), depths y (m,), denser at the surface, and the stresses (m, n) there."""
    x = np.linspace(lo, hi, shape[0])
    y = depth * np.linspace(0.0, 1.0, shape[1]) ** 2
    return x, y, report.stress(x, y[:, None])


def depth_of(solution: Solution, lo: float, hi: float) -> float:
    """Largest depth [m] in figures and files. It follows from the widest zone between lo and hi."""
    zones = solution.zones
    inside = zones[(zones[:, 1] > lo) & (zones[:, 0] < hi)]
    widest = float(np.diff(inside, axis=1).max()) if len(inside) else hi - lo
    return float(np.clip(1.5 * widest, 0.25 * (hi - lo), 0.6 * (hi - lo)))


_NAMES: Sequence[tuple[str, str]] = (
    ("xx", "stress along the surface"),
    ("yy", "stress across the surface"),
    ("xy", "shear stress"),
    ("error", "bound of the error of each stress"),
)


def to_xarray(report: StressReport) -> Any:
    """An xarray.Dataset of the stresses over x and the depth y, with the scene as attributes."""
    lo, hi = window(report.solution)
    x, y, stress = grid(report, lo, hi, depth_of(report.solution, lo, hi))
    data = {
        name: (("y", "x"), getattr(stress, name), {"units": "Pa", "long_name": label})
        for name, label in _NAMES
    }
    data["shear"] = (("y", "x"), stress.shear, {"units": "Pa", "long_name": "largest shear stress"})
    data["mises"] = (
        ("y", "x"),
        stress.mises(report.nu),
        {"units": "Pa", "long_name": "von Mises stress"},
    )
    places = {
        "x": ("x", x, {"units": "m"}),
        "y": ("y", y, {"units": "m", "long_name": "depth below the surface"}),
    }
    numbers = {"numbers": json.dumps(report.to_dict(), allow_nan=False)}
    return require("xarray").Dataset(data, places, numbers)


def write_netcdf(report: StressReport, path: str | PathLike[str], overwrite: bool = False) -> None:
    """Write the data set of `to_xarray` to a netCDF-4 file."""
    path = new_file(path, overwrite)
    require("h5netcdf")
    require("h5py")
    to_xarray(report).to_netcdf(path, engine="h5netcdf")


def write_json(report: StressReport, path: str | PathLike[str], overwrite: bool = False) -> None:
    """Write the dictionary of `to_dict` as one line of JSON to a file."""
    text = json.dumps(report.to_dict(), allow_nan=False)
    new_file(path, overwrite).write_text(text + "\n", encoding="utf-8")
