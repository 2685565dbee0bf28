"""Imports on demand: `import contact` loads numpy and nothing heavier.

This is the only module that imports by name.
"""

import importlib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from contact.errors import MissingExtra
from sie import uncollected

# The extra that installs a package which a plain install lacks.
EXTRAS = {
    "matplotlib": "plot",
    "xarray": "io",
    "h5netcdf": "io",
    "h5py": "io",
    "filelock": "io",
    "tamaas": "peers",
    "ContactMechanics": "peers",
    "SurfaceTopography": "instruments",
    "panel": "explore",
    "bokeh": "explore",
    "distributed": "cluster",
    "cloudpickle": "cluster",
}

# The folder with this package: the source, or the installed packages.
SOURCE = Path(__file__).parent.parent


def require(name: str) -> Any:
    """The module of that name; raises MissingExtra with the remedy if it cannot be imported."""
    try:
        with uncollected():
            return importlib.import_module(name)
    except ImportError as error:
        # Modules of this package exist, so that the missing package is one that they import.
        package = (error.name if name.startswith("contact.") and error.name else name).partition(
            "."
        )[0]
        extra = EXTRAS.get(package)
        remedy = installing(extra) if extra else f"pip install {package}"
        # Importing a submodule of an installed package may fail for other reasons, so the error is
        # shown.
        raise MissingExtra(
            f"{name} is needed here and cannot be imported ({error}): {remedy}", name=package
        ) from error


def installing(extra: str) -> str:
    """The command that installs an extra, for the package or for its source folder."""
    if (SOURCE / "pyproject.toml").is_file() and (SOURCE / "contact" / "extras.py").is_file():
        return f"pip install -e '.[{extra}]' in {SOURCE}"
    return f"pip install 'sie-contact[{extra}]'"


def entry_points(group: str) -> Iterable[Any]:
    """Entry points of the installed packages in a group."""
    found: Iterable[Any] = require("importlib.metadata").entry_points(group=group)
    return found


def version() -> str:
    """Installed version of this package, or a note if the source folder is not installed."""
    metadata = require("importlib.metadata")
    try:
        installed: str = metadata.version("sie-contact")
    except metadata.PackageNotFoundError:
        return "0+not.installed"
    return installed


def other_package() -> str:
    """A message if another project named `contact` is installed as well; else empty."""
    metadata = require("importlib.metadata")
    try:
        other = metadata.version("contact")
    except metadata.PackageNotFoundError:
        return ""
    return (
        f"contact {other}, another project, is installed beside sie-contact, and both are imported "
        "as `contact`: "
        "keep one of them in an environment (pip uninstall contact; pip install --force-reinstall "
        "--no-deps sie-contact)"
    )


def owners() -> tuple[str, ...]:
    """Other installed packages that provide a module `contact`, whatever their names.

    It examines all installed packages, which takes 0.5 s.
    """
    found = require("importlib.metadata").packages_distributions().get("contact", ())
    return tuple(
        sorted({name for name in found if name.replace("_", "-").lower() != "sie-contact"})
    )
