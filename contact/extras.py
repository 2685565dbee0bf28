"""The one place where packages are imported on demand: `import contact` loads numpy and nothing
heavier.
"""

import importlib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from contact.errors import MissingExtra
from sie import uncollected

# Which extra installs a package that a plain install does not bring.
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

# The folder that this package stands in: that of its source, or among the installed packages.
SOURCE = Path(__file__).parents[1]


def require(name: str) -> Any:
    """The module of a name; MissingExtra that says what installs it where it cannot be imported."""
    try:
        with uncollected():
            return importlib.import_module(name)
    except ImportError as error:
        # A room of this package is there: what it lacks is what it imports.
        package = (error.name if name.startswith("contact.") and error.name else name).partition(
            "."
        )[0]
        extra = EXTRAS.get(package)
        remedy = installing(extra) if extra else f"pip install {package}"
        # A submodule of an installed package can fail for other reasons; keep the cause.
        raise MissingExtra(
            f"{name} is needed here and cannot be imported ({error}): {remedy}", name=package
        ) from error


def installing(extra: str) -> str:
    """The command that brings an extra: of the package, or of the folder of source that this runs
    from.
    """
    if (SOURCE / "pyproject.toml").is_file() and (SOURCE / "contact" / "extras.py").is_file():
        return f"pip install -e '.[{extra}]' in {SOURCE}"
    return f"pip install 'sie-contact[{extra}]'"


def entry_points(group: str) -> Iterable[Any]:
    """Entry points of the installed packages in one group."""
    found: Iterable[Any] = require("importlib.metadata").entry_points(group=group)
    return found


def version() -> str:
    """The version of this package as it is installed; of a folder of source that is not, one that
    says so.
    """
    metadata = require("importlib.metadata")
    try:
        installed: str = metadata.version("sie-contact")
    except metadata.PackageNotFoundError:
        return "0+not.installed"
    return installed


def other_package() -> str:
    """What to say where the package of the index that is called `contact`, another project, is
    installed too; empty where it is not.
    """
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
    """Other installed packages, whatever they are called, that bring something imported as
    `contact`. Looks through all of them: 0.5 s.
    """
    found = require("importlib.metadata").packages_distributions().get("contact", ())
    return tuple(
        sorted({name for name in found if name.replace("_", "-").lower() != "sie-contact"})
    )
