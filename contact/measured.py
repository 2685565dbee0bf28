"""Measured traces: from a text file of an instrument to points a spline may go through.

In this order: read two columns, to metres; regrid (uniform positions); detrend (subtract the least-squares
line or parabola); taper (bring both ends to one height, so that one length is a period). What was done is
said in `Trace.history`.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, log10
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact.checks import finite, integer, one_of, positive
from contact.errors import SceneError, shown

Array = NDArray[np.float64]

_UNITS = {
    "m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "μm": 1e-6, "micron": 1e-6, "micrometer": 1e-6,
    "micrometre": 1e-6, "nm": 1e-9, "A": 1e-10, "Å": 1e-10, "pm": 1e-12, "in": 0.0254,
}  # fmt: skip
_TRENDS = {"none": -1, "line": 1, "quadratic": 2}
_DELIMITERS = (";", "\t", ",", None)  # None: white space
_FEWEST = 4
_ROUNDING_SEEN_FROM = 32  # points: with fewer, coarse positions may well be meant as they stand


@dataclass(frozen=True)
class Trace:
    """Positions and heights [m], the period if there is one, and what was done to get them."""

    x: Array
    height: Array
    period: float | None = None
    history: tuple[str, ...] = ()


def load_trace(
    path: str | Path,
    columns: Sequence[int | str] = (0, 1),
    units: str | Sequence[str] = "m",
    detrend: str = "none",
    regrid: bool | int | None = None,
    taper: float | None = None,
    period: bool | float | None = None,
) -> Trace:
    """Read a file and prepare it.

    columns: two indices from 0, or names of the header; units: one for both or two; detrend: none, line or
    quadratic; regrid: a number of uniform points, or True for as many as there are; taper: fraction of the
    length at each end; period: a length [m], or True for the measured length, whose end heights must then
    agree (a taper makes them).
    """
    one_of("detrend", detrend, _TRENDS)
    count = _count(regrid)
    fraction = None if taper is None else _fraction(taper)
    length = _period(period)
    x, height, lines = read_columns(path, columns, units)
    history = [f"{x.size} points of {Path(path).name}"]
    if count is None:
        again = np.flatnonzero(np.diff(x) <= 0)
        if again.size:
            raise _at(
                path,
                lines[again[0] + 1],
                "a position is repeated: give regrid if the file's positions are rounded",
            )
    else:
        x, height, note = to_uniform(x, height, x.size if count is True else count)
        history.append(note)
    if detrend != "none":
        height = subtract_trend(x, height, detrend)
        history.append(f"least-squares {detrend} subtracted")
    if fraction is not None:
        height = taper_ends(x, height, fraction)
        history.append(f"ends tapered to one height over {fraction:g} of the length each")
    if length is True:
        length = float(x[-1] - x[0])
        step = float(height[-1] - height[0])
        if abs(step) > 1e-9 * float(np.ptp(height)):
            raise SceneError.of(
                "period",
                True,
                f"a number, or true with end heights that agree (they differ by {step:.3g} m: give taper)",
            )
        history.append(f"period {length:.9g} m, the measured length")
    return Trace(x, height, length, tuple(history))


def read_columns(
    path: str | Path, columns: Sequence[int | str] = (0, 1), units: str | Sequence[str] = "m"
) -> tuple[Array, Array, NDArray[np.int64]]:
    """Position and height [m] of a text file, and the line of each.

    The data begin with the first two rows in a run whose wanted columns are numbers, and go on to the end of
    the file; empty lines and comments (#) are passed over.
    """
    wanted = _columns(columns)
    scale = _units(units)
    rows = _rows(path)
    delimiter, indices, first = _find_table(path, rows, wanted)
    data = [(line, text) for line, text in rows[first:] if not text.lstrip().startswith("#")]
    lines = np.array([line for line, _ in data])
    try:
        table = np.loadtxt(
            [text for _, text in data], delimiter=delimiter, usecols=indices, ndmin=2, comments=None
        )
    except ValueError:
        raise _bad_row(path, data, delimiter, indices) from None
    if len(table) < _FEWEST:
        raise _at(path, lines[-1], f"only {len(table)} rows of numbers, at least {_FEWEST} are needed")
    bad = np.flatnonzero(~np.isfinite(table).all(axis=1))
    if bad.size:
        raise _at(path, lines[bad[0]], f"{table[bad[0]].tolist()} is not finite")
    back = np.flatnonzero(np.diff(table[:, 0]) < 0)
    if back.size:
        i = back[0]
        raise _at(path, lines[i + 1], f"positions must increase, {table[i + 1, 0]:g} follows {table[i, 0]:g}")
    return table[:, 0] * scale[0], table[:, 1] * scale[1], lines


def to_uniform(x: Array, height: Array, count: int) -> tuple[Array, Array, str]:
    """Heights at `count` uniform positions, and a sentence on how.

    Positions printed with too few digits (0.0, 0.2, 0.3, 0.5 for a pitch of 0.156) make a spline invent
    slopes. If rounding explains every deviation from an even pitch, the points are taken as even and their
    heights stay as measured.
    """
    note = "positions as in the file"
    pitch = _pitch_behind_rounding(x)
    if pitch is not None:
        moved = x[0] + pitch * np.arange(x.size)
        far = float(np.max(np.abs(moved - x)))
        note = (
            f"positions taken as even, pitch {pitch:.9g} m: rounding explains their shifts (<= {far:.2g} m)"
        )
        x = moved
    elif np.any(np.diff(x) <= 0):
        i = int(np.flatnonzero(np.diff(x) <= 0)[0])
        raise SceneError.of(
            "x", x, f"increasing (element {i + 1} repeats {x[i]:.9g}, and rounding does not explain it)"
        )
    even = np.linspace(x[0], x[-1], count)
    if count == x.size and float(np.max(np.abs(even - x))) <= 1e-9 * (x[-1] - x[0]) / (count - 1):
        return x if pitch is not None else even, height, note
    return even, np.interp(even, x, height), f"{note}; interpolated linearly at {count} even positions"


def subtract_trend(x: Array, height: Array, kind: str) -> Array:
    """Heights less their least-squares line or parabola ("none": as they are)."""
    degree = _TRENDS[one_of("detrend", kind, _TRENDS)]
    t = (2 * x - x[0] - x[-1]) / (x[-1] - x[0])
    basis = t[:, None] ** np.arange(degree + 1)
    coefficients = np.linalg.lstsq(basis, height, rcond=None)[0]
    return np.asarray(height - basis @ coefficients)


def taper_ends(x: Array, height: Array, fraction: float) -> Array:
    """Heights blended at both ends into their mean there by w = (1 - cos(pi s))/2; end slopes are 0."""
    length = x[-1] - x[0]
    s = np.minimum(1.0, np.minimum(x - x[0], x[-1] - x) / (_fraction(fraction) * length))
    common = float(np.mean(height[s < 1]))
    return np.asarray(common + (height - common) * (1 - np.cos(np.pi * s)) / 2)


def _pitch_behind_rounding(x: Array) -> float | None:
    """The even pitch whose positions, rounded to a decimal place, are these; None if there is none."""
    n = x.size
    length = float(x[-1] - x[0])
    if n < _ROUNDING_SEEN_FROM or length <= 0:
        return None
    slope = float(np.polyfit(np.arange(n) - (n - 1) / 2, x, 1)[0])
    index = np.arange(n)
    fitted = slope * index + float(np.mean(x - slope * index))
    for power in range(ceil(log10(slope)) + 2, ceil(log10(slope)) - 7, -1):
        place = 10.0**power
        off = np.abs(x / place - np.rint(x / place))
        if np.max(off) <= 1e-6:
            # Half a place for the rounding, and what the fit itself is off by.
            allowed = place * (0.5 + 1 / np.sqrt(n))
            return slope if float(np.max(np.abs(x - fitted))) <= allowed else None
    return None


def _rows(path: str | Path) -> list[tuple[int, str]]:
    """Numbered lines that are not empty; any line ending, also the doubled CR that some instruments write."""
    try:
        raw = Path(path).read_bytes()
    except (OSError, TypeError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise SceneError.of("file", str(path), f"a file that can be read ({reason})") from None
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    return [(i, line) for i, line in enumerate(re.split("\r*\n|\r", text), 1) if line.strip()]


def _find_table(
    path: str | Path, rows: list[tuple[int, str]], wanted: tuple[int | str, ...]
) -> tuple[str | None, tuple[int, ...], int]:
    found: list[tuple[int, str | None, tuple[int, ...]]] = []
    names = [c for c in wanted if isinstance(c, str)]
    named = not names
    for delimiter in _DELIMITERS:
        start, header = _header(rows, delimiter, names)
        if start is None:
            continue
        named = True
        indices = tuple(header.index(c) if isinstance(c, str) else c for c in wanted)
        usable = [_numbers(line, delimiter, indices) for _, line in rows[start:]]
        first = next((i for i in range(len(usable) - 1) if usable[i] and usable[i + 1]), None)
        if first is not None:
            found.append((start + first, delimiter, indices))
    if not found:
        what = "two rows of numbers in a run" if named else "a header row with the names"
        raise SceneError(f"file {str(path)!r}: no {what} in columns {list(wanted)}", "file", str(path))
    first, delimiter, indices = min(found, key=lambda f: f[0])
    return delimiter, indices, first


def _header(
    rows: list[tuple[int, str]], delimiter: str | None, names: list[str]
) -> tuple[int | None, list[str]]:
    """The row after the one that holds every name once, and its fields; row 0 if no names are asked for."""
    if not names:
        return 0, []
    for after, (_, line) in enumerate(rows, 1):
        fields = [f.strip().strip('"') for f in line.lstrip("# ").split(delimiter)]
        if all(fields.count(name) == 1 for name in names):
            return after, fields
    return None, []


def _numbers(line: str, delimiter: str | None, indices: tuple[int, ...]) -> bool:
    fields = line.split(delimiter)
    try:
        for i in indices:
            float(fields[i])
    except (ValueError, IndexError):
        return False
    return True


def _bad_row(
    path: str | Path, data: list[tuple[int, str]], delimiter: str | None, indices: tuple[int, ...]
) -> SceneError:
    for line, text in data:
        if not _numbers(text, delimiter, indices) or "_" in text:
            return _at(path, line, f"no two numbers in columns {list(indices)}: {shown(text.strip())}")
    return SceneError(f"file {str(path)!r}: the table cannot be read", "file", str(path))


def _at(path: str | Path, line: int, what: str) -> SceneError:
    return SceneError(f"file {str(path)!r}, line {int(line)}: {what}", "file", str(path))


def _columns(columns: Any) -> tuple[int | str, ...]:
    allowed = "two different column indices (from 0) or names"
    if isinstance(columns, str) or not isinstance(columns, Sequence) or len(columns) != 2:
        raise SceneError.of("columns", columns, allowed)
    if columns[0] == columns[1]:
        raise SceneError.of("columns", columns, allowed)
    return tuple(c if isinstance(c, str) else integer("columns", c) for c in columns)


def _units(units: Any) -> tuple[float, float]:
    both = (units, units) if isinstance(units, str) else units
    if not isinstance(both, Sequence) or len(both) != 2:
        raise SceneError.of("units", units, "one unit or two, for positions and heights")
    return _UNITS[one_of("units", both[0], _UNITS)], _UNITS[one_of("units", both[1], _UNITS)]


def _count(regrid: Any) -> int | bool | None:
    if regrid is None or regrid is False:
        return None
    return True if regrid is True else integer("regrid", regrid, _FEWEST)


def _fraction(taper: Any) -> float:
    allowed = "a fraction of the length > 0 and <= 0.5"
    fraction = finite("taper", taper, allowed)
    if not 0 < fraction <= 0.5:
        raise SceneError.of("taper", taper, allowed)
    return fraction


def _period(period: Any) -> float | bool | None:
    if period is None or period is False:
        return None
    return True if period is True else positive("period", period)
