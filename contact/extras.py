"""Imports on demand: `import contact` loads numpy and nothing heavier.

This is the only module that imports by name.
"""

import importlib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from contact.errors import MissingExtra
from sie import uncollected

# For each optional package, the extra (`pip install sie-contact[extra]`) that installs it.
EXTRAS = {
    "matplotlib": "plot",
    "pandas": "io",
    "xarray": "io",
    "h5netcdf": "io",
    "h5py": "io",
    "filelock": "io",
    "tamaas": "peers",
    "ContactMechanics": "peers",
    "SurfaceTopography": "instruments",
    "distributed": "cluster",
    "cloudpickle": "cluster",
}

# The folder that contains this package: the source folder, or that of installed packages.
SOURCE = Path(__file__).parent.parent


def require(name: str) -> Any:
    """Import and return the module of this name; raises MissingExtra if that fails."""
    try:
        with uncollected():
            return importlib.import_module(name)
    except ImportError as error:
        # `contact` modules always exist. If one of them cannot be imported, the missing package is
        # one that this module imports, so its name is taken from the error.
        package = (error.name if name.startswith("contact.") and error.name else name).partition(
            "."
        )[0]
        extra = EXTRAS.get(package)
        remedy = installing(extra) if extra else f"pip install {package}"
        # An installed package may also fail to import for other reasons, so the message shows the
        # error.
        raise MissingExtra(
            f"{name} is needed here but cannot be imported ({error}): {remedy}", name=package
        ) from error


def installing(extra: str) -> str:
    """The command that installs an extra, for an installed package or for a source folder."""
    if (SOURCE / "pyproject.toml").is_file() and (SOURCE / "contact" / "extras.py").is_file():
        return f"pip install -e '.[{extra}]' in {SOURCE}"
    return f"pip install 'sie-contact[{extra}]'"


def entry_points(group: str) -> Iterable[Any]:
    """Entry points of a group, from all installed packages."""
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
    """A warning if another package named `contact` is installed as well; else the empty text."""
    metadata = require("importlib.metadata")
    try:
        other = metadata.version("contact")
    except metadata.PackageNotFoundError:
        return ""
    return (
        f"another project named contact ({other}) is installed beside sie-contact, and both are "
        "imported as `contact`: keep only one of them in each environment (pip uninstall contact; "
        "pip install --force-reinstall --no-deps sie-contact)"
    )


def owners() -> tuple[str, ...]:
    """Names of other installed packages that also provide a module `contact`.

    It examines all installed packages, which takes 0.5 s.
    """
    found = require("importlib.metadata").packages_distributions().get("contact", ())
    return tuple(
        sorted({name for name in found if name.replace("_", "-").lower() != "sie-contact"})
    )
