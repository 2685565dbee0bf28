"""Traces that are given as arrays, quantities with units, line scans or file objects.

Heights that are NaN or masked count as missing, like missing heights in a file.
"""

from os import PathLike
from pathlib import PurePath
from typing import Any

import numpy as np

from contact.errors import SceneError
from contact.model.checks import as_array, metres, positive
from contact.model.profiles.sampled import MIN_POINTS
from contact.model.traces.header import scales, written
from contact.model.traces.text import Given, Source
from sie import Array

ARRAYS = Given("the points (x, z)", "the arrays x and z")


def is_surface(given: Any) -> bool:
    """Whether an object looks like a line scan or a map of the package SurfaceTopography."""
    return all(hasattr(given, name) for name in ("heights", "dim", "unit", "to_unit"))


def is_arrays(given: Any) -> bool:
    """Whether an argument is a pair of arrays (positions and heights), or heights alone."""
    return not isinstance(given, (str, bytes, Given)) and (
        any(hasattr(given, name) for name in ("__len__", "__array__", "magnitude"))
    )


def source_of(given: Any) -> Source:
    """A path unchanged; for an open file or a stream, its content together with its name."""
    if isinstance(given, (str, PathLike)):
        return str(given)
    if not hasattr(given, "read"):
        allowed = "arrays (x, z), heights with a pitch, the name of a file, or an open file"
        raise SceneError.of("path_or_arrays", given, allowed)
    path = getattr(given, "name", "")
    path = path if isinstance(path, str) else ""
    name = PurePath(path).name or type(given).__name__
    try:
        content = given.read()
    except (OSError, ValueError) as error:
        raise SceneError.of("file", given, f"open for reading ({error})") from None
    if isinstance(content, str):
        content = content.encode("utf-8")
    if not isinstance(content, bytes):
        raise SceneError.of("file", given, "a file object whose read() returns text or bytes")
    if not content:
        raise SceneError.of(
            "file", given, "a file object with rows left to read (this one is empty or at its end)"
        )
    return Given(f"file object {name}", name, content, PurePath(path).suffix)


def positions_and_heights(given: Any, units: Any, pitch: Any) -> tuple[Array, Array, str, bool]:
    """Positions and heights [m] from arrays, a text on their units, and whether units are given."""
    x, height = _pair(given, pitch)
    quantities = hasattr(height, "magnitude") or hasattr(x, "magnitude")
    if quantities and units is not None:
        raise SceneError.of("units", units, "left out: the arrays carry their own units")
    if (
        quantities
        and pitch is None
        and not (hasattr(height, "magnitude") and hasattr(x, "magnitude"))
    ):
        raise SceneError.of(
            "z", height, "given with a unit if x has a unit, and without one if x has none"
        )
    heights = _numbers("z", metres("z", height))
    if pitch is not None:
        positions = positive("pitch", pitch) * np.arange(heights.size, dtype=float)
    else:
        positions = _numbers("x", metres("x", x))
    if positions.size != heights.size:
        allowed = f"as many heights as positions x ({positions.size}, not {heights.size})"
        raise SceneError.of("z", height, allowed)
    if quantities:
        return positions, heights, "their units", True
    if units is None:
        return positions, heights, '"m" (no units given)', False
    along, up = scales(units)
    along = along if pitch is None else 1.0
    return (
        along * positions,
        up * heights,
        written((units,) * 2 if isinstance(units, str) else units),
        True,
    )


def _pair(given: Any, pitch: Any) -> tuple[Any, Any]:
    """The arrays (x, z) if a pair is given; (None, z) if only heights and a pitch are given."""
    pair = isinstance(given, (tuple, list)) and any(np.ndim(_bare(part)) for part in given)
    if pair and len(given) == 2:
        if pitch is not None:
            raise SceneError.of("pitch", pitch, "left out, since positions are given")
        return given[0], given[1]
    if pair:
        what = "a pair (x, z), or heights alone with their pitch"
        raise SceneError.of("path_or_arrays", given, what)
    if hasattr(given, "columns") or np.ndim(_bare(given)) == 2:
        columns = "(table[:, 0], table[:, 1]); for a data frame, (frame['x'], frame['z'])"
        raise SceneError.of("path_or_arrays", given, f"a pair (x, z): for a table, write {columns}")
    if pitch is None:
        allowed = "a pair (x, z), or heights with pitch, the distance [m] between points"
        raise SceneError.of("path_or_arrays", given, allowed)
    return None, given


def _bare(value: Any) -> Any:
    """An array without its unit; `np.asarray(None)` if the value is not an array."""
    return as_array(getattr(value, "magnitude", value))


def _numbers(field: str, value: Any) -> Array:
    """The given real numbers as a one-dimensional array, in which masked numbers become NaN."""
    masked = np.ma.getmask(value)
    raw = as_array(value)
    if raw.dtype.kind not in "iuf" or raw.ndim != 1 or raw.size < MIN_POINTS:
        got = f"got shape {raw.shape}, type {raw.dtype}"
        allowed = f"a one-dimensional array of at least {MIN_POINTS} real numbers ({got})"
        raise SceneError.of(field, value, allowed)
    return np.where(masked, np.nan, np.asarray(raw, dtype=np.float64))
