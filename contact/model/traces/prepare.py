"""Measured traces: from a file of an instrument to the points of a spline.

The steps, in this order: read positions and heights and convert them to metres; sort the points;
fill dropouts; regrid (even positions); lambda_s (Gaussian low-pass filter, against noise); detrend
(subtract a least-squares polynomial, the form); lambda_c (Gaussian high-pass filter, against
waviness); taper (bring both ends to one height, so that the length is a period). `Trace.history`
lists the steps, `Trace.warnings` the doubts, and `Trace.stages` has the points after each step.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from math import ceil, log10
from numbers import Integral
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact.errors import SceneError, shown
from contact.model.checks import checked_number, finite, integer, metres, one_of, positive
from contact.model.profiles.noise import ROUND_OFF
from contact.model.profiles.sampled import MIN_POINTS
from contact.model.profiles.sampled import OPTIONS as SAMPLED
from contact.model.traces.arrays import (
    ARRAYS,
    is_arrays,
    is_surface,
    positions_and_heights,
    source_of,
)
from contact.model.traces.dropouts import (
    FILLS,
    LONG_TABLE,
    filled,
    in_order,
    marks,
    spikes,
    too_many,
)
from contact.model.traces.file import in_metres, read_table
from contact.model.traces.filters import low_pass, refuse_cut_offs
from contact.model.traces.instruments import is_instrument_file, points_of, read_instrument
from contact.model.traces.text import Given, Source, at, short_name
from contact.model.traces.text_map import read_map
from contact.model.units import quantity
from sie import Array

# Names of the trends that can be subtracted from heights; the index of a name is the degree of the
# polynomial ("none" means no subtraction).
_TRENDS = ("none", "line", "quadratic")


@dataclass(frozen=True)
class TraceLimits:
    """Limits of the preparation, and limits of plausible values of a measured trace."""

    # Highest degree of a polynomial that is subtracted from the heights. Waves too short for such a
    # polynomial should be removed by a filter.
    max_trend: int = 12
    # Largest number of points that `regrid` may create. More points would add corners and computing
    # time, but no information.
    max_regrid: int = 20_000
    # Smallest plausible pitch [m] and range [m] of the heights: less than the size of an atom.
    atom: float = 1e-11
    # Longest plausible trace and widest plausible pitch [m], as for a guideway or a road.
    max_length: float = 1.0
    max_pitch: float = 1e-3
    # Factor on `max_length` and `max_pitch` if the file gives no units. Metres are then assumed,
    # and a trace in mm would seem a thousand times longer than it is.
    guessed: float = 0.1


_LIMITS = TraceLimits()


@dataclass(frozen=True, eq=False)
class Reading:
    """Points of a trace, read from a file or given as arrays: positions and heights [m], line
    numbers, and a text on the units.
    """

    path: Source
    x: Array
    height: Array
    lines: NDArray[np.int64]
    said: str
    depth: str = ""
    """The name of the heights if it means depths, else ""."""
    sure: bool = True
    """Whether units are given; otherwise metres are assumed."""
    doubts: tuple[str, ...] = ()


@dataclass(frozen=True)
class Preparation:
    """The steps of the preparation in order, named like the keys of [profile] in a scene file."""

    sort: bool = False
    invert: bool | None = None
    fill: str | None = None
    regrid: bool | int | None = None
    lambda_s: float | None = None
    detrend: str | int = "none"
    lambda_c: float | None = None
    taper: float | None = None
    period: bool | float | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.sort, bool):
            raise SceneError.of("sort", self.sort, "true or false")
        if self.invert is not None and not isinstance(self.invert, bool):
            raise SceneError.of("invert", self.invert, "true or false")
        _degree(self.detrend)
        # `regrid` = True means as many points as the trace has, and `period` = True means its
        # measured length. False leaves out the step. So these values need no check.
        for name, check in (("regrid", partial(integer, least=MIN_POINTS)), ("period", positive)):
            given = getattr(self, name)
            if not (given is None or isinstance(given, bool)):
                check(name, given)
        if self.taper is not None:
            checked_number(
                "taper",
                self.taper,
                "a fraction of the length, above 0 and at most 0.5",
                lambda fraction: 0 < fraction <= 0.5,
            )
        refuse_cut_offs(self.lambda_s, self.lambda_c)
        if self.fill is not None:
            one_of("fill", self.fill, FILLS)


@dataclass(frozen=True)
class Trace:
    """A prepared trace: points [m], period, history, warnings, intermediate stages and source.

    The period is None if the trace is not periodic.
    """

    x: Array
    height: Array
    period: float | None = None
    history: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    stages: tuple[tuple[str, Array, Array], ...] = ()
    source: tuple[Reading, Preparation] | None = None


# Arguments that only text tables and arrays take, with default values. `_PLACE` below has those
# for maps and the files of instruments.
_LAYOUT = {"columns": (), **dict.fromkeys(("units", "pitch", "decimal", "delimiter", "missing"))}
# Arguments that are lengths [m], and may be quantities with units.
_LENGTHS = ("pitch", "lambda_s", "lambda_c", "period")
_PLACE = dict.fromkeys(("channel", "line", "along"))
_OF_INSTRUMENTS = "only files of instruments have channels; for a text table, use columns"


def load_trace(path: Any, **keys: Any) -> Trace:
    """Read and prepare the trace of a file or of arrays. `keys` are the arguments of
    `contact.read_trace`.
    """
    keys |= {name: metres(name, keys[name]) for name in _LENGTHS if name in keys}
    layout, place = (
        {name: keys.pop(name, usual) for name, usual in known.items()}
        for known in (_LAYOUT, _PLACE)
    )
    preparation = Preparation(**keys)
    if is_surface(path):
        _left_out(layout, "an object of SurfaceTopography has its own positions and unit")
        return prepared(_surface(path, **place), preparation)
    if is_arrays(path):
        units, pitch = layout.pop("units"), layout.pop("pitch")
        _left_out({**layout, **place}, "it does not apply to arrays")
        x, height, said, sure = positions_and_heights(path, units, pitch)
        lines = np.arange(1, x.size + 1)
        return prepared(Reading(ARRAYS, x, height, lines, said, sure=sure), preparation)
    path = source_of(path)
    if not is_instrument_file(path):
        _left_out({"channel": place.pop("channel")}, _OF_INSTRUMENTS)
        is_map = any(value is not None for value in place.values())
        table = _map(path, **place, **layout) if is_map else _table(path, **layout)
        return prepared(table, preparation)
    _left_out(layout, "the format of an instrument's file already defines it")
    x, height, said = read_instrument(path, **place)
    return prepared(Reading(path, x, height, np.zeros(x.size, dtype=np.int64), said), preparation)


def _left_out(keys: Mapping[str, Any], why: str) -> None:
    """Raise SceneError if one of the arguments `keys` is given, that is, not None."""
    for name, value in keys.items():
        if value is not None and not (name == "columns" and len(value) == 0):
            raise SceneError.of(name, value, f"left out: {why}")


def _surface(surface: Any, channel: Any, line: Any, along: Any) -> Reading:
    """The points of a line scan, or of one line of a map, from the package SurfaceTopography.
    `surface` is the package's object for the line scan or the map.
    """
    given = Given(f"the {type(surface).__name__}", type(surface).__name__)
    if channel is not None:
        raise SceneError.of("channel", channel, "left out: the given object is a single channel")
    if surface.unit is None:
        what = (
            "it has no unit; set its unit, or give units and the arrays "
            "(scan.positions(), scan.heights())"
        )
        raise at(given, 0, what)
    x, height, where = points_of(given, surface, line, along)
    return Reading(given, x, height, np.arange(1, x.size + 1), f"its unit {surface.unit}{where}")


def prepared(reading: Reading, by: Preparation) -> Trace:
    """The trace that results from preparing the points of a file or of arrays."""
    path, x, height, lines, said = (
        reading.path,
        reading.x,
        reading.height,
        reading.lines,
        reading.said,
    )
    length = by.period or None
    history = [f"{x.size} points of {short_name(path)}, read in {said}"]
    stages: list[tuple[str, Array, Array]] = []

    def done(note: str) -> None:
        if note:
            history.append(note)
            stages.append((note, x, height))

    x, height, lines, note = in_order(path, x, height, lines, by.sort)
    stages.append(("as read", x, height))
    done(note)
    if _upside_down(reading, by):
        height = -height
        done("turned upside down (invert)")
    many = too_many(height)
    x, height, lines, note = filled(path, x, height, lines, by.fill)
    holes = _doubtful_heights(short_name(path), x, height, note if many else "")
    done(note)
    x, height, note = _at_places(path, x, height, lines, by.regrid or None)
    done(note)
    if by.lambda_s is not None:
        height = low_pass(x, height, by.lambda_s, "lambda_s")
        done(f"waves shorter than {quantity(by.lambda_s, 'm')} filtered out (Gaussian, lambda_s)")
    size = float(np.max(np.abs(height)))
    if by.detrend != "none":
        height = subtract_trend(x, height, by.detrend)
        is_name = isinstance(by.detrend, str)
        form = by.detrend if is_name else f"polynomial of degree {by.detrend}"
        done(f"least-squares {form} subtracted")
    if float(np.ptp(height)) <= ROUND_OFF * size:
        after = (
            ""
            if by.detrend == "none"
            else f" after the trend (detrend = {by.detrend}) is subtracted"
        )
        raise at(path, 0, f"the heights are the same everywhere{after}")
    if by.lambda_c is not None:
        height = height - low_pass(x, height, by.lambda_c, "lambda_c")
        done(f"waves longer than {quantity(by.lambda_c, 'm')} filtered out (Gaussian, lambda_c)")
    if by.taper is not None:
        height = taper_ends(x, height, by.taper)
        done(f"ends tapered to one height over {by.taper:g} of the length each")
    if length is True:
        length = _measured_length(x, height)
        history.append(f"period {quantity(length, 'm', 9)}, the measured length")
    doubts = (*holes, *(_doubts(reading, x, height, length) or reading.doubts))
    return Trace(x, height, length, tuple(history), doubts, tuple(stages), (reading, by))


def _upside_down(reading: Reading, by: Preparation) -> bool:
    """Whether the user asks to invert the heights, because they grow into the body.

    Raises SceneError if the file calls them depths and `invert` is not given.
    """
    if reading.depth and by.invert is None:
        what = f"the column of heights is called {shown(reading.depth)}"
        choices = "set invert = true if its values increase into the body, invert = false otherwise"
        raise at(reading.path, 0, f"{what}: {choices}")
    return bool(by.invert)


def _at_places(
    path: Source, x: Array, height: Array, lines: NDArray[np.int64], count: bool | int | None
) -> tuple[Array, Array, str]:
    """Positions and heights of the prepared trace, with a note on how the positions were chosen.

    Without `count` the positions are those of the file, otherwise `count` evenly spaced ones. Equal
    positions in the file raise an error, unless `count` is given and rounding explains them.
    """
    if count is None or _pitch_behind_rounding(x) is None:
        _refuse_repeated(path, x, lines)
    if count is None:
        return x, height, ""
    count, most = x.size if count is True else count, max(_LIMITS.max_regrid, x.size)
    if count > most:
        between = (
            f"further points would only lie on straight lines between the {x.size} measured ones"
        )
        allowed = f"at most {most}; {between}"
        raise SceneError.of("regrid", count, allowed)
    return to_uniform(x, height, count)


def _table(
    path: Source, columns: Any, units: Any, pitch: Any, decimal: Any, delimiter: Any, missing: Any
) -> Reading:
    """Read a text table: positions and heights, or heights alone with a given pitch."""
    step = None if pitch is None else positive("pitch", pitch)
    wanted = 2 if step is None else 1
    table = read_table(path, columns, decimal, delimiter, wanted, _missing(missing))
    values, said = in_metres(path, table, units)
    height = values[:, -1]
    x: Array = values[:, 0] if step is None else step * np.arange(height.size, dtype=float)
    doubts: tuple[str, ...] = ()
    if table.counts:
        what = "the positions are consecutive whole numbers and may count the points"
        choice = "if they do, set columns = [1] and pitch, the distance of the points [m]"
        doubts = (f"{short_name(path)}: {what}; {choice}",)
    if table.number_above:
        what = f"the number in line {table.number_above} is not read, because a word follows it"
        doubts = (
            f"{short_name(path)}: {what}; if the word marks a missing height, set missing to it",
        )
    sure = units is not None or table.header.line > 0
    return Reading(path, x, height, table.lines, said, table.header.depth, sure, doubts)


def _map(path: Source, line: Any, along: Any, pitch: Any, units: Any, **layout: Any) -> Reading:
    """Read one line of a map from a text file with the columns x, y and z."""
    if pitch is not None:
        raise SceneError.of(
            "pitch", pitch, "left out if line or along is given: a text map has x, y and z"
        )
    layout["missing"] = _missing(layout["missing"])
    x, height, said, table = read_map(path, line, along, units, **layout)
    sure = units is not None or table.header.line > 0
    lines = np.zeros(x.size, dtype=np.int64)
    return Reading(path, x, height, lines, said, table.header.depth, sure)


def _missing(mark: Any) -> Any:
    """The user's mark of missing heights, after a check: a word or a number; None if not given."""
    if mark is None or (isinstance(mark, str) and mark.strip()):
        return mark
    return finite("missing", mark, "the word or number that marks missing heights in the file")


def _refuse_repeated(path: Source, x: Array, lines: NDArray[np.int64]) -> None:
    again = np.flatnonzero(np.diff(x) <= 0)
    if not again.size:
        return
    what = "a position is repeated because of rounding; set regrid = true to make positions even"
    if _pitch_behind_rounding(x) is None:
        more = f" (further repetitions: {again.size - 1})" if again.size > 1 else ""
        what = f"the position {x[again[0]]:.9g} m is repeated{more}, and "
        what += "rounding does not explain it; keep only one point at each position"
    if again.size > 1:
        pitch = float(x[-1] - x[0]) / (x.size - 1)
        what += f"; or give the heights alone (for a file, set columns) with pitch = {pitch:.6g}"
    raise at(path, lines[again[0] + 1], what)


def _measured_length(x: Array, height: Array) -> float:
    difference = float(height[-1] - height[0])
    if abs(difference) > SAMPLED.same * float(np.ptp(height)):
        apart = f"they differ by {quantity(difference, 'm', 3)}; set taper to make them agree"
        allowed = f"a length [m], or true if the heights at both ends agree ({apart})"
        raise SceneError.of("period", True, allowed)
    return float(x[-1] - x[0])


def _doubtful_heights(name: str, x: Array, height: Array, many: str) -> tuple[str, ...]:
    """Warnings about doubtful heights. `many`: note on missing heights, "" if few are missing."""
    missing = [f"more than a tenth of the heights are missing ({many})"] if many else []
    far = marks(height) or spikes(x, height)
    return tuple(f"{name}: {what}" for what in (*missing, far) if what)


def _doubts(reading: Reading, x: Array, height: Array, period: float | None) -> tuple[str, ...]:
    """Warnings about implausible lengths, pitches, heights or periods."""
    length, depth = float(x[-1] - x[0]), float(np.ptp(height))
    pitch = length / (x.size - 1)
    part = 1.0 if reading.sure else _LIMITS.guessed
    size = f"{quantity(length, 'm')} long with a pitch of {quantity(pitch, 'm')}"
    trace = f"{short_name(reading.path)}, read in {reading.said}, is a trace {size}"
    within = f"heights in a range of {quantity(depth, 'm')}"
    is_long = length > part * _LIMITS.max_length or pitch > part * _LIMITS.max_pitch
    if is_long or pitch < _LIMITS.atom:
        rare = (
            "which is implausible for a surface"
            if reading.sure
            else "which is unusual for a surface"
        )
        return (f"{trace}, {rare}; if the units are wrong, set units",)
    if depth > length:
        swap = (
            "columns may be the other way round, or positions and heights may have different units"
        )
        return (f"{trace} and {within}, more than its length; {swap}",)
    if depth < _LIMITS.atom:
        two = "positions and heights may have different units; then set units to a list of two"
        return (f"{trace} and {within}, less than an atom; {two}",)
    if period is not None and period > 2 * length:
        share = f"less than half of the period of {quantity(period, 'm')}"
        return (f"{trace}, {share}; give period in metres, whatever the units of the file are",)
    return ()


def to_uniform(x: Array, height: Array, count: int) -> tuple[Array, Array, str]:
    """Trace at `count` evenly spaced positions: positions, heights, and a note on what was done.

    Positions printed with too few digits (0.0, 0.2, 0.3, 0.5 for a pitch of 0.156) give a spline
    false slopes. If rounding explains all deviations from an even pitch, the positions are replaced
    by even ones and the heights are not changed.
    """
    note = "positions as given"
    pitch = _pitch_behind_rounding(x)
    if pitch is not None:
        moved = x[0] + pitch * np.arange(x.size)
        far = float(np.max(np.abs(moved - x)))
        note = f"positions replaced by even ones with pitch {quantity(pitch, 'm', 9)}: "
        note += f"rounding explains the differences (<= {quantity(far, 'm', 2)})"
        x = moved
    even = np.linspace(x[0], x[-1], count)
    unevenness = float(np.max(np.abs(even - x))) if count == x.size else np.inf
    if unevenness <= SAMPLED.same * (x[-1] - x[0]) / (count - 1):
        return x if pitch is not None else even, height, note
    return (
        even,
        np.interp(even, x, height),
        f"{note}; interpolated linearly at {count} even positions",
    )


def subtract_trend(x: Array, height: Array, kind: str | int) -> Array:
    """Heights minus their least-squares line, parabola or polynomial of the given degree."""
    return np.asarray(height - np.polynomial.Polynomial.fit(x, height, _degree(kind))(x))


def taper_ends(x: Array, height: Array, fraction: float) -> Array:
    """Heights tapered to one common height at both ends, where the slopes become 0.

    The common height is the mean of the heights near both ends. The deviation from it is multiplied
    by (1 - cos(pi s))/2. s grows from 0 at an end to 1 at the distance `fraction` times the length.
    """
    length = x[-1] - x[0]
    s = np.minimum(1.0, np.minimum(x - x[0], x[-1] - x) / (fraction * length))
    common = float(np.mean(height[s < 1]))
    return np.asarray(common + (height - common) * (1 - np.cos(np.pi * s)) / 2)


def _pitch_behind_rounding(x: Array) -> float | None:
    """The pitch if positions are evenly spaced except for their rounding; None if they are not."""
    n = x.size
    length = float(x[-1] - x[0])
    if n < LONG_TABLE or length <= 0:
        return None
    slope = float(np.polyfit(np.arange(n) - (n - 1) / 2, x, 1)[0])
    index = np.arange(n)
    fitted = slope * index + float(np.mean(x - slope * index))
    for power in range(ceil(log10(slope)) + 2, ceil(log10(slope)) - 7, -1):
        place = 10.0**power
        off = np.abs(x / place - np.rint(x / place))
        if np.max(off) <= 1e-6:
            # Rounded positions are wrong by at most half a decimal place. The term 1 / sqrt(n)
            # allows for the error of the fitted line.
            allowed = place * (0.5 + 1 / np.sqrt(n))
            return slope if float(np.max(np.abs(x - fitted))) <= allowed else None
    return None


def _degree(detrend: Any) -> int:
    if isinstance(detrend, str):
        return _TRENDS.index(one_of("detrend", detrend, _TRENDS))
    highest = _LIMITS.max_trend
    allowed = f"none, line, quadratic, or the degree of a polynomial, from 0 to {highest}"
    if (
        isinstance(detrend, bool)
        or not isinstance(detrend, Integral)
        or not 0 <= int(detrend) <= highest
    ):
        raise SceneError.of("detrend", detrend, allowed)
    return int(detrend)
