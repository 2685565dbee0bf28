"""Points without a height, and points out of order: put right as asked, and said."""

import re
from math import nan
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact.extras import require
from contact.model.traces.text import Row, at
from contact.model.units import quantity
from sie import Array

FILLS = ("linear", "drop")
FEWEST = 4
# What stands in a file where nothing was measured, in any case; so does an empty cell.
_WORDS = (
    "", "n/a", "n.a.", "na", "null", "none", "bad", "invalid", "missing", "masked", "nodata",
    "no data", "no_data", "undefined", "undef", "void",
)  # fmt: skip
_ERRORS = r"#(?:n/a|nv|wert!|value!|valor!|div/0!|num!|zahl!|ref!|null!)"  # of spreadsheets
_NO_NUMBER = re.compile(
    rf"[-+]?(?:nan|inf|infinity|nan\(\w*\)|1\.#\w+)|[-*?.]+|{_ERRORS}", re.IGNORECASE
)
_COMMENT = re.compile(rf"\s*(?!{_ERRORS})#", re.IGNORECASE)
# Spikes and marks are warned of; factors of two change none of the cases that were seen.
_SPIKE = 10  # times what the rest spans, its straight line taken off
_SPIKE_POINTS = 9  # of the running median: spikes are narrower than half of them
_JUMP = 10  # times a usual step (that of three in four points): so far are marks from neighbours
# A larger part of heights that were not measured is warned of; of spikes it is the surface.
_MANY = 0.1
_EQUAL = 1e-9  # relative to the highest: differences below it are rounding


def no_height(cell: str, missing: Any) -> bool:
    """Whether a cell says that there is no height."""
    lower = cell.lower()
    named = isinstance(missing, str) and lower == missing.strip().lower()
    return named or lower in _WORDS or _NO_NUMBER.fullmatch(cell) is not None


def missing_number(missing: Any) -> float:
    """The number that stands for no height, given as a number or as text; nan if it is a word."""
    try:
        return nan if missing is None else float(str(missing).replace(",", "."))
    except ValueError:
        return nan


def without_phrases(rows: list[Row], missing: Any) -> list[Row]:
    """Rows with nan for words for no height that have a blank in them: it may divide columns."""
    given = missing.split() if isinstance(missing, str) else []
    phrases = [r"no\s+data"] + [r"\s+".join(map(re.escape, given))] * (len(given) > 1)
    phrase = re.compile(rf"(?<!\w)(?:{'|'.join(phrases)})(?!\w)", re.IGNORECASE)
    return [(line, phrase.sub("nan", text)) for line, text in rows]


def is_comment(text: str) -> bool:
    """Whether a row is a comment; a spreadsheet's #N/A is none."""
    return _COMMENT.match(text) is not None


def filled(
    path: str | Path, x: Array, height: Array, lines: NDArray[np.int64], fill: str | None
) -> tuple[Array, Array, NDArray[np.int64], str]:
    """Positions, heights and lines without those that have no height, and a sentence on what was
    done ("" where nothing was).
    """
    lost = ~np.isfinite(height)
    if not lost.any():
        return x, height, lines, ""
    count = int(lost.sum())
    if fill is None:
        first = int(np.flatnonzero(lost)[0])
        more = f" here and at {count - 1} more of {x.size} points" if count > 1 else ""
        choices = 'fill = "linear" puts straight lines there, fill = "drop" leaves the points out'
        raise at(path, lines[first], f"no finite height{more}; for missing ones {choices}")
    kept = np.flatnonzero(~lost)
    if kept.size < FEWEST:
        raise at(
            path,
            lines[0],
            f"from here on {kept.size} of {x.size} points have a height, at least {FEWEST} are needed",
        )
    first, last = int(kept[0]), int(kept[-1])
    cut = x.size - (last + 1 - first)
    gaps = np.diff(kept) - 1
    inner = int(gaps.sum())
    said = f"{count} of {x.size} heights are missing"
    if cut:
        said += f"; {cut} at the ends cut off"
    if inner:
        widest = float(np.max(np.diff(x[kept])[gaps > 0]))
        how = "filled by straight lines" if fill == "linear" else "left out"
        said += (
            f"; {inner} in {int((gaps > 0).sum())} gaps, the widest {quantity(widest, 'm')}, {how}"
        )
    if fill == "drop":
        return x[kept], height[kept], lines[kept], said
    whole = slice(first, last + 1)
    return x[whole], np.interp(x[whole], x[kept], height[kept]), lines[whole], said


def too_many(height: Array) -> bool:
    """Whether so many heights are missing that much of the shape is made up."""
    return float(np.mean(~np.isfinite(height))) > _MANY


def marks(height: Array) -> str:
    """What is said of heights that may stand for none, as 0 and -32768 do; empty without any.

    The value is 0, or the lowest or highest and stands there more than once. It is far from all
    others, or reached and left by jumps where other heights go on by steps.
    """
    for value in dict.fromkeys((0.0, float(height.min()), float(height.max()))):
        here = height == value
        count = int(here.sum())
        if not (value != 0) < count < height.size - FEWEST:
            continue
        others = height[~here]
        far = float(np.min(np.abs(others - value))) > _SPIKE * float(np.ptp(others)) > 0
        if far or _left_by_jumps(height, here):
            often = f"stands {count} times" if count > 1 else "stands once"
            told = f"the height {quantity(value, 'm')} {often}, far from all beside it"
            return f"{told}: missing names what stands for no height"
    return ""


def _left_by_jumps(height: Array, here: NDArray[np.bool_]) -> bool:
    """Whether all steps between marked heights and others are much larger than usual ones."""
    steps = np.abs(np.diff(height))
    border = here[1:] != here[:-1]
    inner = ~here[1:] & ~here[:-1]
    # Where most other steps are none, equal heights are no sign of anything.
    if not inner.any() or float(np.median(steps[inner])) == 0:
        return False
    usual = float(np.quantile(steps[inner], 0.75))
    # The top of a narrow bump is left by large steps, and the next ones are as large.
    following = inner & (np.append(border[1:], False) | np.append(False, border[:-1]))
    if following.any():
        usual = max(usual, float(np.median(steps[following])))
    return float(steps[border].min()) > _JUMP * usual


def spikes(x: Array, height: Array) -> str:
    """What is said of single points far from all others; empty without any."""
    points = min(_SPIKE_POINTS, height.size // 4 | 1)
    median = require("scipy.ndimage").median_filter(height, points, mode="mirror")
    level = np.polynomial.Polynomial.fit(x, median, 1)(x)
    off = np.abs(height - median)
    rest = float(np.ptp(median - level))
    far = off > _SPIKE * rest + _EQUAL * float(np.max(np.abs(height)))
    if not 0 < np.mean(far) < _MANY:
        return ""
    i = int(np.argmax(off))
    told = f"the height {quantity(height[i], 'm')} at x = {quantity(x[i], 'm')}"
    others = f" and {int(far.sum()) - 1} more" if far.sum() > 1 else ""
    times = f"{quantity(float(off[i]), 'm')} off its neighbours, where the rest spans {quantity(rest, 'm')}"
    return f"{told}{others} is {times}: a spike? missing takes a value for no height"


def in_order(
    path: str | Path, x: Array, height: Array, lines: NDArray[np.int64], sort: bool = False
) -> tuple[Array, Array, NDArray[np.int64], str]:
    """The points by increasing position, and a sentence on what was done. What descends is turned
    round; else sort must say so.
    """
    if not np.isfinite(x).all():
        raise at(
            path,
            lines[int(np.flatnonzero(~np.isfinite(x))[0])],
            "the position is not finite: cut such rows",
        )
    if not np.ptp(x) > 0:
        raise at(
            path, lines[0], f"all positions are {x[0]:g} m: columns says which column holds them"
        )
    steps = np.diff(x)
    back = np.flatnonzero(steps < 0)
    if not back.size:
        return x, height, lines, ""
    if np.all(steps <= 0):
        return x[::-1], height[::-1], lines[::-1], "positions descend: turned round"
    if sort:
        order = np.argsort(x, kind="stable")
        return (
            x[order],
            height[order],
            lines[order],
            f"sorted by position, {back.size} steps having gone back",
        )
    i = back[0]
    rising = height[np.isfinite(height)]
    swapped = np.all(np.diff(rising) > 0) or np.all(np.diff(rising) < 0)
    other = (
        "; the heights do throughout: if the columns are the other way round, columns says so, as columns = [1, 0]"
        if swapped
        else ""
    )
    what = (
        f"positions must increase or decrease throughout, {x[i + 1]:g} m follows {x[i]:g} m{other}"
    )
    raise at(path, lines[i + 1], what if other else f"{what}; sort = true sorts them")
