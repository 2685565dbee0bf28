"""Files of profilometers and microscopes, read by the package SurfaceTopography.

The package comes with the extra `instruments`. A trace is a line scan or a line of a map z(x, y).
Lines along x are numbered in the order of their y, and lines along y in the order of their x.
Heights on a line between two points are interpolated bilinearly.
"""

import re
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from contact.errors import SceneError
from contact.extras import require
from contact.model.checks import finite_array, integer, one_of
from contact.model.traces.text import Given, Source, at
from sie import Array

# File name endings of the formats that the package SurfaceTopography reads, without those of text
# tables.
FORMATS = tuple(
    (
        "x3p sur pro sdf di spm mdt opd opdx ibw mi datx tif tiff tmd vk3 vk4 vk6 vk7 zmg zon os3d "
        "al3d ezd nid bcr bcrf dat gwy plu apx frt lext oir poir cur stp tom top plux jpk mnt qep "
        "nms mat nc xlsx"
    ).split()
)
# File name endings of instrument formats that may be plain text. Here the ending alone decides.
_OF_TEXT = ("sdf", "bcr", "bcrf")
# The file name endings of one manufacturer are numbers of three digits.
_NUMBERED = re.compile(r"\d{3}")
ALONG = ("x", "y")


def is_instrument_file(path: Source) -> bool:
    """Whether a file has an instrument's own format.
    It is judged by the ending of its name and, unless this decides, by its first bytes.
    """
    ending = (path.ending if isinstance(path, Given) else Path(path).suffix)[1:].lower()
    if isinstance(path, Given) and not ending:
        return _is_binary(path.content or b"")
    if ending not in FORMATS and not _NUMBERED.fullmatch(ending):
        return False
    if ending in _OF_TEXT:
        return True
    if isinstance(path, Given):
        return _is_binary(path.content or b"")
    try:
        with Path(path).open("rb") as stream:
            return _is_binary(stream.read(1 << 16))
    except OSError:
        return False  # the error is reported when the file is read


def _is_binary(content: bytes) -> bool:
    """Whether a file is a ZIP archive or another binary file, judged by its first bytes.
    A text that is compressed by gzip does not count as binary.
    """
    head = content[: 1 << 16]
    if head.startswith(b"\x1f\x8b"):  # text under gzip
        return False
    return head.startswith(b"PK") or (
        b"\0" in head and not head.startswith((b"\xff\xfe", b"\xfe\xff"))
    )


def read_instrument(
    path: Source, channel: Any = None, line: Any = None, along: Any = None
) -> tuple[Array, Array, str]:
    """Positions and heights [m] (NaN if not measured), and a note that says what was read."""
    package = require("SurfaceTopography")
    try:
        content = path.content if isinstance(path, Given) else None
        stream = str(path) if content is None else partial(BytesIO, content)
        reader = package.open_topography(stream)
        channels = [found for found in reader.channels if found.is_height_channel]
        names = [found.name for found in channels]
    except Exception as error:  # the readers raise many kinds of errors
        raise at(
            path, 0, f"no reader of instrument formats can read it: {_advice(error)}"
        ) from error
    chosen = channels[_place(path, names, channel)]
    try:
        surface = chosen.topography()
    except Exception as error:
        raise at(path, 0, f"the channel {chosen.name!r} cannot be read ({error})") from error
    # The lengths of a map or scan are unknown if the file gives no unit.
    if surface.unit is None:
        raise at(
            path, 0, "the file states no unit of length; export the heights as text and set units"
        )
    x, height, where = points_of(path, surface, line, along)
    return x, height, f"the file's units, channel {chosen.name!r}{where}"


def _advice(error: Exception) -> str:
    """Text for an error message: what the reader reports, or else the formats that can be read."""
    said = str(error)
    if said and "\n" not in said.strip():
        return said
    return (
        f"the known formats are {', '.join(FORMATS)} (nc only if written by SurfaceTopography, "
        "xlsx only if written by Mitutoyo SurfTest), and text with the columns x and z, or x, y "
        "and z"
    )


def points_of(path: Source, surface: Any, line: Any, along: Any) -> tuple[Array, Array, str]:
    """Positions and heights [m] of a line scan or of one line of a map.
    The third value is a text that says which line of the map was read.
    """
    try:
        surface = surface.to_unit("m")
        # Only a line scan has positions; a map has physical sizes instead.
        positions = (
            np.empty(0) if surface.dim == 2 else np.asarray(surface.positions(), dtype=float)
        )
        heights: Array = np.ma.filled(np.ma.asarray(surface.heights(), dtype=float), np.nan)
    except Exception as error:
        raise at(path, 0, f"the heights cannot be read ({error})") from error
    if heights.ndim == 1:
        for name, given in (("line", line), ("along", along)):
            if given is not None:
                raise SceneError.of(
                    name, given, "left out, because the data are one line scan, not a map"
                )
        return positions, heights, ""
    x, height, where = of_map(heights, surface.physical_sizes, line, along)
    return x, height, f", {where}"


def _place(path: Source, names: list[str], channel: Any) -> int:
    """The index of the channel with this name or number.
    If no channel is given and the file has only one channel of heights, it is the index of this
    channel.
    """
    listed = ", ".join(f"{place} {name!r}" for place, name in enumerate(names)) or "none"
    if channel is None and len(names) == 1:
        return 0
    if channel is None:
        what = f"channel must be the number or name of one of its channels of heights: {listed}"
        raise SceneError(f"file {str(path)!r}: {what}", "channel")
    if not isinstance(channel, str):
        if integer("channel", channel) >= len(names):
            allowed = f"the number or name of a channel of heights: {listed}"
            raise SceneError.of("channel", channel, allowed)
        return int(channel)
    if (same := names.count(one_of("channel", channel, names))) > 1:
        allowed = f"a number, because {same} channels have this name: {listed}"
        raise SceneError.of("channel", channel, allowed)
    return names.index(channel)


def of_map(
    heights: Array, sizes: tuple[float, float], line: Any, along: Any
) -> tuple[Array, Array, str]:
    """Positions and heights on a line of an evenly spaced map, and a text that names the line.

    sizes: lengths [m] of the map in x and y. Each is one grid spacing longer than the distance from
    the first to the last point.
    """
    nx, ny = heights.shape
    dx, dy = sizes[0] / nx, sizes[1] / ny
    if isinstance(line, (list, tuple, np.ndarray)):
        if along is not None:
            raise SceneError.of("along", along, "left out if line is a pair of points")
        return _between(heights, dx, dy, line)
    direction = one_of("along", "x" if along is None else along, ALONG)
    count, most, step = (nx, ny, dx) if direction == "x" else (ny, nx, dy)
    allowed = (
        f"the number of a line along {direction}, from 0 to {most - 1}, "
        f"or two points [[x, y], [x, y]] [m]; the map has {nx} x {ny} points"
    )
    if line is None or isinstance(line, (str, bool, float)) or integer("line", line) >= most:
        raise SceneError.of("line", line, allowed)
    height = np.array(heights[:, line] if direction == "x" else heights[line, :])
    return (
        np.arange(count) * step,
        height,
        f"line {line} (of 0 to {most - 1}) along {direction} of a map of {nx} x {ny} points",
    )


def _between(heights: Array, dx: float, dy: float, line: Any) -> tuple[Array, Array, str]:
    """Heights on the straight line between two points of a map, at about the map's pitch."""
    ends = finite_array("line", line, 2)
    nx, ny = heights.shape
    far = np.array([(nx - 1) * dx, (ny - 1) * dy])
    if (
        ends.shape != (2, 2)
        or np.any(ends < 0)
        or np.any(ends > far * (1 + 1e-12))
        or np.array_equal(*ends)
    ):
        within = f"with x from 0 to {far[0]:.6g} m and y from 0 to {far[1]:.6g} m"
        raise SceneError.of("line", line, f"two different points [[x, y], [x, y]] {within}")
    length = float(np.hypot(*(ends[1] - ends[0])))
    count = max(4, int(round(length / min(dx, dy))) + 1)
    points = ends[0] + np.linspace(0, 1, count)[:, None] * (ends[1] - ends[0])
    u, v = np.minimum(points / (dx, dy), (nx - 1, ny - 1)).T
    i, j = np.minimum(u.astype(int), nx - 2), np.minimum(v.astype(int), ny - 2)
    s, t = u - i, v - j
    corners = ((0, 0, (1 - s) * (1 - t)), (1, 0, s * (1 - t)), (0, 1, (1 - s) * t), (1, 1, s * t))
    # A missing height (NaN) at a corner of a grid cell matters only if the corner has a positive
    # weight in the interpolation.
    height = sum(
        np.where(weight > 0, weight * heights[i + a, j + b], 0.0) for a, b, weight in corners
    )
    where = " to ".join(f"({x:.6g}, {y:.6g})" for x, y in ends)
    return (
        np.linspace(0, length, count),
        np.asarray(height),
        f"from {where} m, interpolated bilinearly in a map of {nx} x {ny} points",
    )
