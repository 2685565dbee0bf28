"""Solutions as data: dictionaries, JSON, CSV tables of zones and fields, and netCDF.

All values are in SI units. JSON has no infinity. Therefore quantities that a scene does not define
(None), and infinite ones such as the largest pressure at a sharp corner, are null. An existing file
is overwritten only on request.
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

from contact.errors import SceneError
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
    "tangential_load": "N/m",
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

_FIELDS = {
    "profile": ("m", "gap at zero load, up to a constant"),
    "displacement": ("m", "displacement into the body"),
    "gap": ("m", "gap between the deformed surfaces"),
    "pressure": ("Pa", "contact pressure"),
    "shear": ("Pa", "shear traction on body 1 along +x"),
    "overlap": ("m", "depth by which the body has yielded"),
}


def to_dict(solution: Solution) -> dict[str, Any]:
    """Zones and summary numbers of the solution as a dictionary that JSON can represent."""
    values = {
        **{name: getattr(solution, name) for name in UNITS if name != "rotational_stiffness"},
        # The rotational stiffness takes one more solution of the equations. It is useful only with
        # a tilt or a moment.
        "rotational_stiffness": solution.rotational_stiffness if solution.scene.turning else None,
        "certificate": solution.certificate.to_dict(),
        "plan": solution.plan.to_dict(),
        "warnings": all_warnings(solution),
        "scene": describe(solution.scene),
        "trace": solution.scene.profile.trace_summary(),
        "units": UNITS,
        "version": version(),
    }
    if solution.scene.law.pressure_range.has_limit:
        values |= {"plateaus": solution.plateaus, "units": {**UNITS, "plateaus": "m"}}
    return {key: plain(value) for key, value in values.items()}


def to_json(solution: Solution) -> str:
    """The dictionary of `to_dict` as one line of JSON."""
    return json.dumps(to_dict(solution), allow_nan=False)


def plain(value: Any) -> Any:
    """A value in the types of JSON: numpy types become Python types, non-finite numbers None."""
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
    """One row for each zone, from left to right, with the columns ZONE_COLUMNS in ZONE_UNITS."""
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
    """The zone table as a pandas.DataFrame with `attrs["units"]`."""
    table = np.reshape(zone_table(solution), (-1, len(ZONE_COLUMNS)))
    return frame_of(dict(zip(ZONE_COLUMNS, table.T, strict=True)), ZONE_UNITS, "zone")


def frame_of(table: Mapping[str, Any], units: Sequence[str], row: str | None = None) -> Any:
    """A pandas.DataFrame of named columns, with their units in its attribute `attrs["units"]`.

    units: units of the first columns. row: name of the index, which numbers the rows from 0.
    """
    # This raises MissingExtra without pandas, even if the next module was imported before.
    require("pandas")
    frame = require("contact.solution.zone_frame").ZoneFrame(table)
    frame.index.name = row
    frame.attrs["units"] = dict(zip(table, units, strict=False))
    return frame


def to_csv(solution: Solution) -> str:
    """The zone table as CSV text with a header line, in full precision."""
    return csv_of(ZONE_COLUMNS, zone_table(solution))


def fields_to_csv(solution: Solution) -> str:
    """The fields at sampled positions as CSV text with a header line.
    The first columns are FIELD_COLUMNS [m, Pa, m, m, m].

    With friction the column shear [Pa] follows; if the law limits the pressure, overlap [m]. The
    spacing of the positions is smaller near the ends of zones.
    """
    fields = _fields(solution)
    columns = [name for name in (*FIELD_COLUMNS, "shear", "overlap") if name in fields]
    return csv_of(columns, np.column_stack([fields[name] for name in columns]).tolist())


def csv_of(columns: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table as CSV text with a header line, in full precision."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(
        [value if isinstance(value, str) else repr(value) for value in row] for row in rows
    )
    return text.getvalue()


def write_csv(solution: Solution, path: str | PathLike[str], overwrite: bool = False) -> None:
    """Write the zone table to a CSV file."""
    new_file(path, overwrite).write_text(to_csv(solution), encoding="utf-8")


def write_fields(solution: Solution, path: str | PathLike[str], overwrite: bool = False) -> None:
    """Write the table of the fields to a CSV file."""
    new_file(path, overwrite).write_text(fields_to_csv(solution), encoding="utf-8")


def write_json(solution: Solution, path: str | PathLike[str], overwrite: bool = False) -> None:
    """Write the solution as one line of JSON to a file."""
    new_file(path, overwrite).write_text(to_json(solution) + "\n", encoding="utf-8")


def new_file(
    path: str | PathLike[str], overwrite: bool, endings: Sequence[str] = (), field: str = "path"
) -> Path:
    """The path of a file to be written; SceneError if the file exists or its ending is wrong."""
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
        raise SceneError.of(field, str(path), "a file (not a folder) in a folder that exists")
    if path.exists() and not overwrite:
        raise SceneError.of(
            field,
            str(path),
            "the name of a new file; use overwrite=True to replace an existing file",
        )
    return path


def _fields(solution: Solution) -> dict[str, Any]:
    x = positions(solution, *window(solution))
    fields = {
        "x": x,
        "profile": np.asarray(solution.scene.profile.height(x)),
        "displacement": solution.displacement(x),
        "gap": solution.gap(x),
        "pressure": solution.pressure(x),
    }
    if solution.scene.law.shear_ratio:
        fields["shear"] = solution.shear(x)
    if solution.scene.law.pressure_range.has_limit:
        fields["overlap"] = solution.overlap(x)
    return fields


def to_xarray(solution: Solution) -> Any:
    """An xarray.Dataset of the zones, their loads and largest pressures, the fields, and the scene.

    The spacing of the fields' positions is smaller near the ends of zones.
    """
    fields = _fields(solution)
    attributes = {
        name: {"units": units, "long_name": label}
        for name, (units, label) in _FIELDS.items()
        if name in fields
    }
    data: dict[str, Any] = {
        name: ("x", np.asarray(fields[name]), named) for name, named in attributes.items()
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
        {"units": "Pa", "long_name": "largest pressure of a zone"},
    )
    if solution.scene.law.pressure_range.has_limit:
        data["plateaus"] = (
            ("plateau", "end"),
            np.asarray(solution.plateaus),
            {
                "units": "m",
                "long_name": "ends of the plateaus, where the pressure equals its limit",
            },
        )
    coordinates = {
        "x": ("x", fields["x"], {"units": "m", "long_name": "position"}),
        "end": ["left", "right"],
    }
    return require("xarray").Dataset(data, coords=coordinates, attrs=_attributes(solution))


def write_netcdf(solution: Solution, path: str | PathLike[str], overwrite: bool = False) -> None:
    """Write the data set of `to_xarray` to a netCDF-4 file."""
    path = new_file(path, overwrite)
    require("h5netcdf")
    require("h5py")
    to_xarray(solution).to_netcdf(path, engine="h5netcdf")


def describe(scene: Scene) -> dict[str, Any]:
    """The scene as the tables of a scene file; each long array is replaced by its shape."""
    return {
        place: {name: _short(value) for name, value in table.items() if value is not None}
        for place, table in tables(scene).items()
    }


def _short(value: Any) -> Any:
    return f"array of shape {np.shape(value)}" if is_long(value) else plain(value)


def is_long(value: Any, longest: int = 64) -> bool:
    """Whether a value is so long that a description of a scene shows only its shape.

    HDF5 stores the attributes of an object in a header of 64 KiB, so that long arrays do not fit.
    """
    return np.size(value) > longest


def _attributes(solution: Solution) -> dict[str, Any]:
    """Attributes of the data set: version, units, scene, summary numbers and certificate.

    Numbers that are None are left out, as netCDF has no value for None.
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
