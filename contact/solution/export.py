"""Solutions as data: plain dictionaries and JSON, tables of the zones and of the fields as CSV, and
netCDF with both.

SI units everywhere. What a scene does not define (None) and what is infinite, as the peak pressure
under a sharp corner, is null in JSON, which has no infinities. A file that is there is written over
only when that is asked for.
"""

import csv
import io
import json
import math
from collections.abc import Iterable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from contact.errors import MissingExtra, SceneError
from contact.extras import require, version
from contact.model.scene import Scene
from contact.model.scene_file import tables
from contact.solution.model_warnings import all_warnings
from contact.solution.sampling import positions, window
from contact.solution.solution import Solution

ZONE_COLUMNS = ("left", "right", "width", "load", "mean_pressure", "max_pressure")
ZONE_UNITS = ("m", "m", "m", "N/m", "Pa", "Pa")
FIELD_COLUMNS = ("x", "pressure", "gap", "displacement", "profile")

UNITS = {
    "zones": "m",
    "zone_widths": "m",
    "zone_loads": "N/m",
    "zone_peaks": "Pa",
    "load": "N/m",
    "mean_pressure": "Pa",
    "max_pressure": "Pa",
    "approach": "m",
    "contact_fraction": "1",
    "stiffness": "N/m^2",
    "mean_gap": "m",
    "tilt": "rad",
    "moment": "N",
    "rotational_stiffness": "N",
    "error": "1",
}

# HDF5 keeps the attributes of an object in one header of 64 KiB: longer arrays are told by their
# shape.
_LONGEST_ARRAY = 64

_FIELDS = {
    "profile": ("m", "gap at zero load, up to a constant"),
    "displacement": ("m", "displacement into the body"),
    "gap": ("m", "gap between the deformed surfaces"),
    "pressure": ("Pa", "contact pressure"),
}


def to_dict(solution: Solution) -> dict[str, Any]:
    """The solution's zones and numbers as JSON has them: floats, strings, lists, dictionaries and
    None.
    """
    values = {
        **{name: getattr(solution, name) for name in UNITS if name != "rotational_stiffness"},
        # One more solution: worth it only where turning is what the scene is about.
        "rotational_stiffness": solution.rotational_stiffness if solution.scene.turning else None,
        "certificate": solution.certificate.to_dict(),
        "plan": solution.plan.to_dict(),
        "warnings": all_warnings(solution),
        "scene": describe(solution.scene),
        "trace": solution.scene.profile.trace_summary(),
        "units": UNITS,
        "version": version(),
    }
    return {key: plain(value) for key, value in values.items()}


def to_json(solution: Solution) -> str:
    """One JSON object, one line."""
    return json.dumps(to_dict(solution), allow_nan=False)


def plain(value: Any) -> Any:
    """A value in the types of JSON; numpy's become Python's, and a number that is not finite
    becomes None.
    """
    if isinstance(value, (np.ndarray, np.generic)):
        return plain(value.tolist())
    if value is None or isinstance(value, (bool, str, int)):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    return str(value)


def zone_table(solution: Solution) -> list[tuple[float, ...]]:
    """A row a zone, from left to right, of ZONE_COLUMNS in ZONE_UNITS."""
    loads, widths = np.asarray(solution.zone_loads), np.asarray(solution.zone_widths)
    return list(
        map(
            tuple,
            np.column_stack(
                (solution.zones, widths, loads, loads / widths, solution.zone_peaks)
            ).tolist(),
        )
    )


def zone_frame(solution: Solution) -> Any:
    """The zone table as a pandas.DataFrame; where pandas is not installed, a dictionary of an array
    for each column.
    """
    table = np.reshape(zone_table(solution), (-1, len(ZONE_COLUMNS)))
    columns = dict(zip(ZONE_COLUMNS, table.T, strict=True))
    try:
        frame = require("pandas").DataFrame(columns)
    except MissingExtra:
        return columns
    frame.attrs["units"] = dict(zip(ZONE_COLUMNS, ZONE_UNITS, strict=True))
    return frame


def to_csv(solution: Solution) -> str:
    """The zone table with a header line, every number in full precision; at full contact the header
    alone.
    """
    return csv_of(ZONE_COLUMNS, zone_table(solution))


def fields_to_csv(solution: Solution) -> str:
    """FIELD_COLUMNS [m, Pa, m, m, m] on positions closer at the zones' ends, with a header line, in
    full precision.
    """
    fields = _fields(solution)
    return csv_of(FIELD_COLUMNS, np.column_stack([fields[name] for name in FIELD_COLUMNS]).tolist())


def csv_of(columns: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table with a header line, its numbers in full precision."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(
        [value if isinstance(value, str) else repr(value) for value in row] for row in rows
    )
    return text.getvalue()


def write_csv(solution: Solution, path: str | PathLike[str], overwrite: bool = False) -> None:
    """Write the zone table."""
    new_file(path, overwrite).write_text(to_csv(solution), encoding="utf-8")


def write_fields(solution: Solution, path: str | PathLike[str], overwrite: bool = False) -> None:
    """Write the table of the fields."""
    new_file(path, overwrite).write_text(fields_to_csv(solution), encoding="utf-8")


def write_json(solution: Solution, path: str | PathLike[str], overwrite: bool = False) -> None:
    """Write the object of `to_json`."""
    new_file(path, overwrite).write_text(to_json(solution) + "\n", encoding="utf-8")


def new_file(
    path: str | PathLike[str], overwrite: bool, endings: Sequence[str] = (), field: str = "path"
) -> Path:
    """The path of a file that may be written: one that is not there, or may be written over, with
    one of the endings if these are given.
    """
    if not isinstance(path, (str, PathLike)) or (
        endings and Path(path).suffix.lower() not in endings
    ):
        raise SceneError.of(
            field,
            path,
            f"the name of a file{' that ends in ' if endings else ''}{' or '.join(endings)}",
        )
    path = Path(path)
    if path.is_dir() or not path.parent.is_dir():
        raise SceneError.of(field, str(path), "a file in a folder that exists")
    if path.exists() and not overwrite:
        raise SceneError.of(
            field, str(path), "a file that is not there yet, or overwrite=True given"
        )
    return path


def _fields(solution: Solution) -> dict[str, Any]:
    x = positions(solution, *window(solution))
    return {
        "x": x,
        "profile": np.asarray(solution.scene.profile.height(x)),
        "displacement": solution.displacement(x),
        "gap": solution.gap(x),
        "pressure": solution.pressure(x),
    }


def to_xarray(solution: Solution) -> Any:
    """An xarray.Dataset: zones, their loads and peaks, the fields on positions closer at the zones'
    ends, the scene.
    """
    fields = _fields(solution)
    told = {name: {"units": units, "long_name": label} for name, (units, label) in _FIELDS.items()}
    data: dict[str, Any] = {
        name: ("x", np.asarray(fields[name]), said) for name, said in told.items()
    }
    data["zones"] = (
        ("zone", "end"),
        np.asarray(solution.zones),
        {"units": "m", "long_name": "zone ends"},
    )
    data["zone_load"] = (
        "zone",
        np.asarray(solution.zone_loads),
        {"units": "N/m", "long_name": "load of a zone"},
    )
    data["zone_peak"] = (
        "zone",
        np.asarray(solution.zone_peaks),
        {"units": "Pa", "long_name": "highest pressure of a zone"},
    )
    coordinates = {
        "x": ("x", fields["x"], {"units": "m", "long_name": "position"}),
        "end": ["left", "right"],
    }
    return require("xarray").Dataset(data, coords=coordinates, attrs=_attributes(solution))


def write_netcdf(solution: Solution, path: str | PathLike[str], overwrite: bool = False) -> None:
    """Write the data set of `to_xarray` as netCDF-4."""
    path = new_file(path, overwrite)
    require("h5netcdf")
    require("h5py")
    to_xarray(solution).to_netcdf(path, engine="h5netcdf")


def describe(scene: Scene) -> dict[str, Any]:
    """The scene in the tables of a scene file; an array too long to read is told by its shape."""
    return {
        place: {name: _short(value) for name, value in table.items() if value is not None}
        for place, table in tables(scene).items()
    }


def _short(value: Any) -> Any:
    return f"array of shape {np.shape(value)}" if np.size(value) > _LONGEST_ARRAY else plain(value)


def _attributes(solution: Solution) -> dict[str, Any]:
    """The numbers of the solution, with those the scene does not define left out; netCDF has no
    None.
    """
    values = {
        name: getattr(solution, name)
        for name in UNITS
        if not name.startswith("zone") and name != "rotational_stiffness"
    }
    numbers = {name: float(value) for name, value in values.items() if value is not None}
    trace = solution.scene.profile.trace_summary()
    read = {} if trace is None else {"trace": json.dumps(plain(trace))}
    return {
        "title": "elastic contact",
        "source": f"sie-contact {version()}",
        "version": version(),
        "units": json.dumps({name: UNITS[name] for name in numbers}),
        "scene": json.dumps(describe(solution.scene)),
        **read,
        **numbers,
        "certificate": json.dumps(plain(solution.certificate.to_dict())),
    }
