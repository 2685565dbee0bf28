"""Points without a height, and points out of order: put right as asked, and said."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact.model.traces.text import at
from contact.model.units import quantity
from sie import Array

FILLS = ("linear", "drop")
FEWEST = 4
# What stands in a file where nothing was measured, in any case; so does an empty cell.
WORDS = (
    "", "nan", "-nan", "nan(ind)", "inf", "-inf", "n/a", "na", "null", "none", "bad", "invalid", "missing", "-", "--", "---",
    "*", "**", "***",
)  # fmt: skip
# A height whose distance from the others is so many times what they span is hardly one.
_FAR = 100
# A larger part of heights that were not measured is warned about.
_MANY = 0.1


def no_height(cell: str, missing: Any) -> bool:
    """Whether a cell says that there is no height."""
    return cell.lower() in WORDS or (isinstance(missing, str) and cell == missing)


def filled(
    path: str | Path, x: Array, height: Array, lines: NDArray[np.int64], fill: str | None
) -> tuple[Array, Array, NDArray[np.int64], str]:
    """Positions, heights and lines without those that have no height, and a sentence on what was done ("" where nothing was)."""
    lost = ~np.isfinite(height)
    if not lost.any():
        return x, height, lines, ""
    count = int(lost.sum())
    if fill is None:
        first = int(np.flatnonzero(lost)[0])
        more = f" here and at {count - 1} more of {x.size} points" if count > 1 else ""
        choices = 'fill = "linear" puts straight lines there, fill = "drop" leaves the points out'
        raise at(path, lines[first], f"no finite height{more}: {choices}")
    kept = np.flatnonzero(~lost)
    if kept.size < FEWEST:
        raise at(path, lines[0], f"from here on {kept.size} of {x.size} points have a height, at least {FEWEST} are needed")
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
        said += f"; {inner} in {int((gaps > 0).sum())} gaps, the widest {quantity(widest, 'm')}, {how}"
    if fill == "drop":
        return x[kept], height[kept], lines[kept], said
    whole = slice(first, last + 1)
    return x[whole], np.interp(x[whole], x[kept], height[kept]), lines[whole], said


def too_many(height: Array) -> bool:
    """Whether so many heights are missing that much of the shape is made up."""
    return float(np.mean(~np.isfinite(height))) > _MANY


def marks(height: Array) -> tuple[float, int] | None:
    """The lowest or highest height and how often it occurs, where it is so far off that it may stand for none, as -32768 does."""
    for value in (float(height.min()), float(height.max())):
        others = height[height != value]
        span = float(np.ptp(others)) if others.size else 0.0
        if span > 0 and min(abs(value - float(others.min())), abs(value - float(others.max()))) > _FAR * span:
            return value, height.size - others.size
    return None


def in_order(
    path: str | Path, x: Array, height: Array, lines: NDArray[np.int64], sort: bool = False
) -> tuple[Array, Array, NDArray[np.int64], str]:
    """The points by increasing position, and a sentence on what was done. What descends is turned round; else sort must say so."""
    if not np.isfinite(x).all():
        raise at(path, lines[int(np.flatnonzero(~np.isfinite(x))[0])], "the position is not finite: cut such rows")
    if not np.ptp(x) > 0:
        raise at(path, lines[0], f"all positions are {x[0]:g} m: columns says which column holds them")
    steps = np.diff(x)
    back = np.flatnonzero(steps < 0)
    if not back.size:
        return x, height, lines, ""
    if np.all(steps <= 0):
        return x[::-1], height[::-1], lines[::-1], "positions descend: turned round"
    if sort:
        order = np.argsort(x, kind="stable")
        return x[order], height[order], lines[order], f"sorted by position, {back.size} steps having gone back"
    i = back[0]
    rising = height[np.isfinite(height)]
    swapped = np.all(np.diff(rising) > 0) or np.all(np.diff(rising) < 0)
    other = "; the heights do throughout: if the columns are the other way round, columns says so, as columns = [1, 0]" if swapped else ""
    what = f"positions must increase or decrease throughout, {x[i + 1]:g} m follows {x[i]:g} m{other}"
    raise at(path, lines[i + 1], what if other else f"{what}; sort = true sorts them")
