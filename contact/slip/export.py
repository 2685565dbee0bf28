"""A `Slip` as data: dictionaries, JSON, CSV tables of intervals and fields, and netCDF.

All values are in SI units. The form is that of `contact.solution.export`.
"""

import json
from os import PathLike
from typing import Any

import numpy as np

from contact.extras import require, version
from contact.slip.result import Slip
from contact.solution import export
from contact.solution.sampling import positions, window

INTERVAL_COLUMNS = ("left", "right", "width", "state")
FIELD_COLUMNS = ("x", "pressure", "shear")
UNITS = {
    "friction": "1",
    "tangential_load": "N/m",
    "stick_zones": "m",
    "slip_zones": "m",
    "shift": "m",
    "shift_error": "m",
    "creepage": "1",
    "dissipated": "J/m",
    "dissipated_error": "J/m",
    "bulk_stress": "Pa",
    "error": "1",
}


def to_dict(slip: Slip) -> dict[str, Any]:
    """The stick and slip zones, the results and the normal contact as a dictionary for JSON."""
    values = {
        "model": slip.model,
        **{name: getattr(slip, name) for name in UNITS},
        "solution": export.to_dict(slip.solution),
        "units": UNITS,
        "version": version(),
    }
    return {key: export.plain(value) for key, value in values.items()}


def interval_table(slip: Slip) -> list[tuple[float, float, float, str]]:
    """Rows for all stick and slip zones, from left to right; columns are `INTERVAL_COLUMNS`."""
    rows = [
        (float(left), float(right), float(right - left), state)
        for state, table in (("stick", slip.stick_zones), ("slip", slip.slip_zones))
        for left, right in table
    ]
    return sorted(rows)


def zone_frame(slip: Slip) -> Any:
    """The table of stick and slip zones as a pandas.DataFrame with `attrs["units"]`."""
    rows = interval_table(slip)
    columns: dict[str, Any] = {
        name: np.array([row[k] for row in rows]) for k, name in enumerate(INTERVAL_COLUMNS)
    }
    return export.frame_of(columns, 3 * ["m"])


def _fields(slip: Slip) -> dict[str, Any]:
    x = positions(slip.solution, *window(slip.solution))
    return {"x": x, "pressure": slip.solution.pressure(x), "shear": slip.shear(x)}


def write_csv(slip: Slip, path: str | PathLike[str], overwrite: bool = False) -> None:
    """Write the table of stick and slip zones to a CSV file."""
    text = export.csv_of(INTERVAL_COLUMNS, interval_table(slip))
    export.new_file(path, overwrite).write_text(text, encoding="utf-8")


def write_fields(slip: Slip, path: str | PathLike[str], overwrite: bool = False) -> None:
    """Write x, pressure and shear to a CSV file [m, Pa, Pa]."""
    fields = _fields(slip)
    rows = np.column_stack([fields[name] for name in FIELD_COLUMNS]).tolist()
    export.new_file(path, overwrite).write_text(
        export.csv_of(FIELD_COLUMNS, rows), encoding="utf-8"
    )


def write_json(slip: Slip, path: str | PathLike[str], overwrite: bool = False) -> None:
    """Write the solution with friction as one line of JSON to a file."""
    text = json.dumps(to_dict(slip), allow_nan=False)
    export.new_file(path, overwrite).write_text(text + "\n", encoding="utf-8")


def write_netcdf(slip: Slip, path: str | PathLike[str], overwrite: bool = False) -> None:
    """Write the data set of `to_xarray` to a netCDF-4 file."""
    path = export.new_file(path, overwrite)
    require("h5netcdf")
    require("h5py")
    to_xarray(slip).to_netcdf(path, engine="h5netcdf")


def write(slip: Slip, path: str | PathLike[str], overwrite: bool = False) -> None:
    """Write the solution with friction to a file that ends in .json or .nc."""
    file = export.new_file(path, overwrite, (".json", ".nc"))
    if file.suffix.lower() == ".json":
        write_json(slip, file, overwrite)
    else:
        write_netcdf(slip, file, overwrite)


def to_xarray(slip: Slip) -> Any:
    """The xarray.Dataset of the contact, with the shear and with the stick and slip zones."""
    data = export.to_xarray(slip.solution)
    data["shear"] = (
        "x",
        slip.shear(data["x"].values),
        {"units": "Pa", "long_name": "traction on body 1 along +x"},
    )
    for name, label in (("stick", "zones that stick"), ("slip", "zones that slip")):
        table = getattr(slip, f"{name}_zones")
        data[f"{name}_zones"] = ((f"{name}_zone", "end"), table, {"units": "m", "long_name": label})
    numbers = {
        name: float(value)
        for name in UNITS
        if not name.endswith("zones") and (value := getattr(slip, name)) is not None
    }
    data.attrs["slip"] = json.dumps({"model": slip.model, **numbers, "units": UNITS})
    return data
