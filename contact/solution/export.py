"""Solutions as data: plain dictionaries and JSON, a CSV table of the zones, and netCDF with the fields.

SI units everywhere. What a scene does not define (None) and what is infinite, as the peak pressure under a sharp
corner, is null in JSON, which has no infinities.
"""

from __future__ import annotations

import csv
import dataclasses
import io
import json
import math
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from contact.extras import require
from contact.model.interactions.base import TURNING
from contact.model.scene import Scene
from contact.solution.answer import Answer
from contact.solution.sampling import positions, window

ZONE_COLUMNS = ("left", "right", "width", "load", "mean_pressure")

# HDF5 keeps the attributes of an object in one header of 64 KiB: longer arrays are told by their shape.
_LONGEST_ARRAY = 64

_FIELDS = {
    "profile": ("m", "gap at zero load, up to a constant"),
    "displacement": ("m", "displacement into the body"),
    "gap": ("m", "gap between the deformed surfaces"),
    "pressure": ("Pa", "contact pressure"),
}


def to_dict(solution: Answer) -> dict[str, Any]:
    """The solution's zones and numbers as JSON has them: floats, strings, lists, dictionaries and None."""
    values = {
        "zones": solution.zones,
        "load": solution.load,
        "mean_pressure": solution.mean_pressure,
        "max_pressure": solution.max_pressure,
        "approach": solution.approach,
        "contact_fraction": solution.contact_fraction,
        "zone_loads": solution.zone_loads,
        "zone_widths": solution.zone_widths,
        "stiffness": solution.stiffness,
        "mean_gap": solution.mean_gap,
        "tilt": solution.tilt,
        "moment": solution.moment,
        # One more solution: worth it only where turning is what the scene is about.
        "rotational_stiffness": solution.rotational_stiffness if _is_about_turning(solution.scene) else None,
        "error": solution.error,
        "certificate": solution.certificate.to_dict(),
        "plan": solution.plan.to_dict(),
        "warnings": solution.warnings,
    }
    return {key: plain(value) for key, value in values.items()}


def _is_about_turning(scene: Scene) -> bool:
    return any(getattr(scene, name) is not None for name in TURNING)


def to_json(solution: Answer) -> str:
    """One JSON object, one line."""
    return json.dumps(to_dict(solution), allow_nan=False)


def plain(value: Any) -> Any:
    """A value in the types of JSON; numpy's become Python's, and a number that is not finite becomes None."""
    if value is None or isinstance(value, (bool, str)):
        return value
    if isinstance(value, np.bool_):
        return bool(value)
    if isinstance(value, (int, np.integer)):
        return int(value)
    if isinstance(value, (float, np.floating)):
        return float(value) if math.isfinite(value) else None
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    return str(value)


def zone_table(solution: Answer) -> list[tuple[float, ...]]:
    """A row a zone, from left to right, of ZONE_COLUMNS [m, m, m, N/m, Pa]."""
    loads, widths = np.asarray(solution.zone_loads), np.asarray(solution.zone_widths)
    return [
        (float(left), float(right), float(width), float(load), float(load / width))
        for (left, right), width, load in zip(solution.zones, widths, loads, strict=True)
    ]


def to_csv(solution: Answer) -> str:
    """The zone table with a header line, every number in full precision; at full contact the header alone."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(ZONE_COLUMNS)
    writer.writerows([repr(value) for value in row] for row in zone_table(solution))
    return text.getvalue()


def write_csv(solution: Answer, path: str | PathLike[str]) -> None:
    """Write the zone table."""
    Path(path).write_text(to_csv(solution), encoding="utf-8")


def to_xarray(solution: Answer) -> Any:
    """An xarray.Dataset: zones and their loads, the fields on positions closer at the zones' ends, the scene."""
    x = positions(solution, *window(solution))
    fields = {
        "profile": solution.scene.profile.height(x),
        "displacement": solution.displacement(x),
        "gap": solution.gap(x),
        "pressure": solution.pressure(x),
    }
    data: dict[str, Any] = {
        name: ("x", np.asarray(fields[name]), {"units": units, "long_name": label})
        for name, (units, label) in _FIELDS.items()
    }
    data["zones"] = (("zone", "end"), np.asarray(solution.zones), {"units": "m", "long_name": "zone ends"})
    data["zone_load"] = ("zone", np.asarray(solution.zone_loads), {"units": "N/m", "long_name": "load of a zone"})
    coordinates = {"x": ("x", x, {"units": "m", "long_name": "position"}), "end": ["left", "right"]}
    return require("xarray").Dataset(data, coords=coordinates, attrs=_attributes(solution))


def write_netcdf(solution: Answer, path: str | PathLike[str]) -> None:
    """Write the data set of `to_xarray` as netCDF-4."""
    require("h5netcdf")
    require("h5py")
    to_xarray(solution).to_netcdf(Path(path), engine="h5netcdf")


def describe(scene: Scene) -> dict[str, Any]:
    """The scene in the tables of a scene file; an array too long to read is told by its shape."""
    name, value = scene.control
    return {
        "profile": {"shape": scene.profile.name, **_parameters(scene.profile)},
        "material": {"E_star": scene.E_star},
        "interaction": {"model": scene.interaction.name, **_parameters(scene.interaction)},
        **_unusual(scene),
        "control": {name: value, **{turn: given for turn in TURNING if (given := getattr(scene, turn)) is not None}},
    }


def _unusual(scene: Scene) -> dict[str, Any]:
    """The tables of a substrate and a law that are not the ones that a file leaves out."""
    usual = {field.name: field.default for field in dataclasses.fields(scene)}
    parts = {name: getattr(scene, name) for name in ("substrate", "law")}
    return {name: {"model": part.name, **_parameters(part)} for name, part in parts.items() if part != usual[name]}


def _parameters(part: Any) -> dict[str, Any]:
    """What a profile or an interaction was made with, less what was left out."""
    if hasattr(part, "parameters"):
        values = part.parameters()
    elif dataclasses.is_dataclass(part):
        values = {field.name: getattr(part, field.name) for field in dataclasses.fields(part)}
    else:
        values = {}
    return {name: _short(value) for name, value in values.items() if value is not None}


def _short(value: Any) -> Any:
    return f"array of shape {np.shape(value)}" if np.size(value) > _LONGEST_ARRAY else plain(value)


def _attributes(solution: Answer) -> dict[str, Any]:
    """The numbers of the solution, with those the scene does not define left out; netCDF has no None."""
    values = {
        "load": solution.load,
        "mean_pressure": solution.mean_pressure,
        "max_pressure": solution.max_pressure,
        "approach": solution.approach,
        "contact_fraction": solution.contact_fraction,
        "tilt": solution.tilt,
        "moment": solution.moment,
        "error": solution.error,
    }
    numbers = {name: float(value) for name, value in values.items() if value is not None}
    certificate = json.dumps(plain(solution.certificate.to_dict()))
    return {
        "title": "elastic contact", "units": "SI", "scene": json.dumps(describe(solution.scene)),
        **numbers, "certificate": certificate,
    }
