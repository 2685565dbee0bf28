"""The one place where packages are imported on demand: `import contact` loads numpy and nothing heavier."""

from __future__ import annotations

import importlib
from collections.abc import Iterable
from typing import Any

from contact.errors import MissingExtra

# Which extra installs a package that a plain install does not bring.
EXTRAS = {
    "matplotlib": "plot", "xarray": "io", "h5netcdf": "io", "h5py": "io",
    "tamaas": "peers", "ContactMechanics": "peers", "SurfaceTopography": "instruments",
    "panel": "explore", "bokeh": "explore", "distributed": "cluster", "cloudpickle": "cluster",
}


def require(name: str) -> Any:
    """The module of a name; MissingExtra that says what installs it where it cannot be imported."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        # A room of this package is there: what it lacks is what it imports.
        package = (error.name if name.startswith("contact.") and error.name else name).partition(".")[0]
        extra = EXTRAS.get(package)
        remedy = f"pip install 'sie-contact[{extra}]'" if extra else f"pip install {package}"
        # A submodule of an installed package can fail for other reasons; keep the cause.
        raise MissingExtra(f"{name} is needed here and cannot be imported ({error}): {remedy}", name=package) from error


def entry_points(group: str) -> Iterable[Any]:
    """Entry points of the installed packages in one group."""
    found: Iterable[Any] = require("importlib.metadata").entry_points(group=group)
    return found


def version() -> str:
    """The version of this package as it is installed; of a folder of source that is not, one that says so."""
    metadata = require("importlib.metadata")
    try:
        installed: str = metadata.version("sie-contact")
    except metadata.PackageNotFoundError:
        return "0+not.installed"
    return installed


def other_package() -> str:
    """What to say where the package of the index that is called `contact`, another project, is installed too; empty where it is not."""
    metadata = require("importlib.metadata")
    try:
        other = metadata.version("contact")
    except metadata.PackageNotFoundError:
        return ""
    return (
        f"contact {other}, another project, is installed beside sie-contact, and both are imported as `contact`: "
        "keep one of them in an environment (pip uninstall contact; pip install --force-reinstall --no-deps sie-contact)"
    )
