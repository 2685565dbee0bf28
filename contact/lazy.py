"""The one place where packages are imported on demand: `import contact` loads numpy and nothing heavier.

Each function imports one module and returns it, or raises MissingExtra naming the extra that installs it.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterable
from types import ModuleType
from typing import Any

from contact.errors import MissingExtra


def _module(name: str, extra: str | None = None) -> ModuleType:
    try:
        return importlib.import_module(name)
    except ImportError as error:
        package = name.partition(".")[0]
        remedy = f"pip install 'sie-contact[{extra}]'" if extra else f"pip install {package}"
        # A submodule of an installed package can fail for other reasons; keep the cause.
        raise MissingExtra(
            f"{name} is needed here and cannot be imported ({error}): {remedy}", name=package
        ) from error


def scipy_interpolate() -> ModuleType:
    """Cubic splines of measured profiles."""
    return _module("scipy.interpolate")


def scipy_special() -> ModuleType:
    """Zeta and digamma functions, for sums over images."""
    return _module("scipy.special")


def scipy_optimize() -> ModuleType:
    """Roots and minima."""
    return _module("scipy.optimize")


def matplotlib_pyplot() -> ModuleType:
    """Figures."""
    return _module("matplotlib.pyplot", "plot")


def matplotlib_figure() -> ModuleType:
    """Figures without a window or global state."""
    return _module("matplotlib.figure", "plot")


def matplotlib_agg() -> ModuleType:
    """The canvas that draws into memory."""
    return _module("matplotlib.backends.backend_agg", "plot")


def xarray() -> ModuleType:
    """Labelled data sets."""
    return _module("xarray", "io")


def h5netcdf() -> ModuleType:
    """netCDF files."""
    return _module("h5netcdf", "io")


def h5py() -> ModuleType:
    """What h5netcdf writes through; it is an option of h5netcdf itself."""
    return _module("h5py", "io")


def click() -> ModuleType:
    """The command line."""
    return _module("click")


def rich_console() -> ModuleType:
    """Text on a terminal."""
    return _module("rich.console")


def rich_table() -> ModuleType:
    """Tables on a terminal."""
    return _module("rich.table")


def rich_box() -> ModuleType:
    """Frames of tables."""
    return _module("rich.box")


def rich_progress() -> ModuleType:
    """Progress bars."""
    return _module("rich.progress")


def command_line() -> ModuleType:
    """The module of the commands, once it is known that what it is written with is there."""
    click()
    return importlib.import_module("contact.commands.cli")


def paper_figures() -> ModuleType:
    """The figures of the paper, which only their command draws."""
    return importlib.import_module("contact.paper.figures")


def tamaas() -> ModuleType:
    """A boundary-element code to compare with."""
    return _module("tamaas", "peers")


def contact_mechanics() -> ModuleType:
    """Another one."""
    return _module("ContactMechanics", "peers")


def surface_topography() -> ModuleType:
    """The surfaces of ContactMechanics."""
    return _module("SurfaceTopography", "peers")


def bench() -> ModuleType:
    """What `contact bench` and `contact stability` run; no solve needs it."""
    return importlib.import_module("contact.studies.bench.run")


def gzip() -> ModuleType:
    """Packed traces."""
    return _module("gzip")


def entry_points(group: str) -> Iterable[Any]:
    """Entry points of the installed packages in one group."""
    metadata = _module("importlib.metadata")
    found: Iterable[Any] = metadata.entry_points(group=group)
    return found
