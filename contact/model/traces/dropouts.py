"""Missing heights and points out of order: recognized, corrected on request, and reported."""

import re
from dataclasses import dataclass
from math import nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact.extras import require
from contact.model.profiles.noise import ROUND_OFF
from contact.model.profiles.sampled import MIN_POINTS
from contact.model.traces.text import Row, Source, at
from contact.model.units import quantity
from sie import Array

FILLS = ("linear", "drop")
# Number of rows from which a table counts as long. A shorter table may show a pattern, such as an
# even pitch, by chance.
LONG_TABLE = 32
# Words that stand for a missing height, in lower case.
_WORDS = (
    "", "n/a", "n.a.", "na", "null", "none", "bad", "invalid", "missing", "masked", "nodata",
    "no data", "no_data", "undefined", "undef", "void",
)  # fmt: skip
# Error values of spreadsheets, such as #N/A.
_ERRORS = r"#(?:n/a|nv|wert!|value!|valor!|div/0!|num!|zahl!|ref!|null!)"
_NO_NUMBER = re.compile(
    rf"[-+]?(?:nan|inf|infinity|nan\(\w*\)|1\.#\w+)|[-*?.]+|{_ERRORS}", re.IGNORECASE
)
_COMMENT = re.compile(rf"\s*(?!{_ERRORS})#", re.IGNORECASE)


@dataclass(frozen=True)
class WarningLimits:
    """Limits above which heights cause a warning.

    In all known cases, limits half or twice as large give the same warnings.
    """

    # A spike is a point that differs from its neighbours by more than this multiple of the range of
    # the other heights. A value such as -32768 may mark missing heights if every step to or from it
    # is larger than this multiple of the usual step.
    far: float = 10.0
    # Number of points of the running median. A spike has less than half as many points, so that the
    # median does not follow it.
    median_points: int = 9
    # Largest fraction of missing heights without a warning. It is also the largest fraction of
    # points that may be spikes: more points than that belong to the surface.
    max_part: float = 0.1


_LIMITS = WarningLimits()


def no_height(cell: str, missing: Any) -> bool:
    """Whether the text in a cell of a table stands for a missing height.
    `missing` is a further text for missing heights that the user gives, or None.
    """
    lower = cell.lower()
    named = isinstance(missing, str) and lower == missing.strip().lower()
    return named or lower in _WORDS or _NO_NUMBER.fullmatch(cell) is not None


def missing_number(missing: Any) -> float:
    """The number that marks missing heights, given as a number or a text; NaN if the text is a
    word.
    """
    try:
        return nan if missing is None else float(str(missing).replace(",", "."))
    except ValueError:
        return nan


def without_phrases(rows: list[Row], missing: Any) -> list[Row]:
    """Rows in which phrases such as "no data" are replaced by nan. The blank in such a phrase
    could be taken for a delimiter of columns.
    """
    given = missing.split() if isinstance(missing, str) else []
    phrases = [r"no\s+data"] + [r"\s+".join(map(re.escape, given))] * (len(given) > 1)
    phrase = re.compile(rf"(?<!\w)(?:{'|'.join(phrases)})(?!\w)", re.IGNORECASE)
    return [(line, phrase.sub("nan", text)) for line, text in rows]


def is_comment(text: str) -> bool:
    """Whether a row is a comment, which begins with #. An error value such as #N/A is no
    comment.
    """
    return _COMMENT.match(text) is not None


def filled(
    path: Source, x: Array, height: Array, lines: NDArray[np.int64], fill: str | None
) -> tuple[Array, Array, NDArray[np.int64], str]:
    """Positions, heights and line numbers, with missing heights filled or dropped, and a note
    that says so.
    """
    lost = ~np.isfinite(height)
    if not lost.any():
        return x, height, lines, ""
    count = int(lost.sum())
    if fill is None:
        first = int(np.flatnonzero(lost)[0])
        more = f" here and at {count - 1} more of {x.size} points" if count > 1 else ""
        choices = (
            'use fill = "linear" for straight lines across gaps, or fill = "drop" to omit points'
        )
        raise at(path, lines[first], f"no finite height{more}; for missing heights {choices}")
    kept = np.flatnonzero(~lost)
    if kept.size < MIN_POINTS:
        have = f"only {kept.size} of the {x.size} points from here on have a height"
        raise at(path, lines[0], f"{have}, but at least {MIN_POINTS} are needed")
    first, last = int(kept[0]), int(kept[-1])
    cut = x.size - (last + 1 - first)
    gaps = np.diff(kept) - 1
    inner = int(gaps.sum())
    note = f"{count} of {x.size} heights are missing"
    if cut:
        note += f"; {cut} at the ends cut off"
    if inner:
        widest = float(np.max(np.diff(x[kept])[gaps > 0]))
        how = "filled by straight lines" if fill == "linear" else "left out"
        note += (
            f"; {inner} in {int((gaps > 0).sum())} gaps, the widest {quantity(widest, 'm')}, {how}"
        )
    if fill == "drop":
        return x[kept], height[kept], lines[kept], note
    whole = slice(first, last + 1)
    return x[whole], np.interp(x[whole], x[kept], height[kept]), lines[whole], note


def too_many(height: Array) -> bool:
    """Whether so many heights are missing that filling them would invent a large part of the
    shape.
    """
    return float(np.mean(~np.isfinite(height))) > _LIMITS.max_part


def marks(height: Array) -> str:
    """A warning about a value that may mark missing heights (0 or -32768, say); "" if there is
    none.

    Such a value is 0, or a repeated lowest or highest height. It is far from all others, or its
    neighbours differ from it by much more than other neighbours differ.
    """
    for value in dict.fromkeys((0.0, float(height.min()), float(height.max()))):
        here = height == value
        count = int(here.sum())
        if not (value != 0) < count < height.size - MIN_POINTS:
            continue
        others = height[~here]
        apart = float(np.min(np.abs(others - value)))
        far = apart > _LIMITS.far * float(np.ptp(others)) > 0
        if far or _jumps_around(height, here):
            often = f"occurs {count} times" if count > 1 else "occurs once"
            what = f"the height {quantity(value, 'm')} {often}, far from the heights next to it"
            return (
                f"{what}: if it marks missing heights, set missing to this mark (text files), or "
                "replace it by nan"
            )
    return ""


def _jumps_around(height: Array, here: NDArray[np.bool_]) -> bool:
    """Whether all steps between heights in the mask `here` and heights outside are very large."""
    steps = np.abs(np.diff(height))
    border = here[1:] != here[:-1]
    inner = ~here[1:] & ~here[:-1]
    # `inner` marks the steps between heights outside of `here`. If most of them are zero, equal
    # heights are normal, and do not mark missing values.
    if not inner.any() or float(np.median(steps[inner])) == 0:
        return False
    usual = float(np.quantile(steps[inner], 0.75))
    # At the top of a narrow bump, the `border` steps are large, but the steps on the flanks are
    # large, too. So the usual step is at least the median of the steps next to a `border` step.
    following = inner & (np.append(border[1:], False) | np.append(False, border[:-1]))
    if following.any():
        usual = max(usual, float(np.median(steps[following])))
    return float(steps[border].min()) > _LIMITS.far * usual


def spikes(x: Array, height: Array) -> str:
    """A warning about single points far from all others; "" if there are none."""
    points = min(_LIMITS.median_points, height.size // 4 | 1)
    median = require("scipy.ndimage").median_filter(height, points, mode="mirror")
    level = np.polynomial.Polynomial.fit(x, median, 1)(x)
    distances = np.abs(height - median)
    rest = float(np.ptp(median - level))
    least = ROUND_OFF * float(np.max(np.abs(height)))
    far = distances > _LIMITS.far * rest + least
    if not 0 < np.mean(far) < _LIMITS.max_part:
        return ""
    i = int(np.argmax(distances))
    point = f"the height {quantity(height[i], 'm')} at x = {quantity(x[i], 'm')}"
    others = f" (and {int(far.sum()) - 1} more)" if far.sum() > 1 else ""
    distance = f"differs by {quantity(float(distances[i]), 'm')} from its neighbours"
    span = f"while the other heights span {quantity(rest, 'm')}"
    return (
        f"{point}{others} {distance}, {span}: is it a spike? If it marks a missing height, set "
        "missing to this mark (text files), or replace it by nan"
    )


def in_order(
    path: Source, x: Array, height: Array, lines: NDArray[np.int64], sort: bool = False
) -> tuple[Array, Array, NDArray[np.int64], str]:
    """The points in the order of their positions, and a note that says what was done.

    Descending positions are reversed. Any other order is refused unless `sort` is set.
    """
    if not np.isfinite(x).all():
        raise at(
            path,
            lines[int(np.flatnonzero(~np.isfinite(x))[0])],
            "the position is not finite: delete such points",
        )
    if not np.ptp(x) > 0:
        raise at(
            path,
            lines[0],
            f"all positions are {x[0]:g} m: in a text file, set columns to the right columns",
        )
    steps = np.diff(x)
    back = np.flatnonzero(steps < 0)
    if not back.size:
        return x, height, lines, ""
    if np.all(steps <= 0):
        return x[::-1], height[::-1], lines[::-1], "positions descend: order reversed"
    if sort:
        order = np.argsort(x, kind="stable")
        return (
            x[order],
            height[order],
            lines[order],
            f"sorted by position ({back.size} steps went back)",
        )
    i = back[0]
    rising = height[np.isfinite(height)]
    swapped = np.all(np.diff(rising) > 0) or np.all(np.diff(rising) < 0)
    other = (
        "; the heights do: positions and heights may be interchanged (in a text file, set "
        "columns = [1, 0])"
        if swapped
        else ""
    )
    what = (
        f"positions must increase or decrease throughout, but {x[i + 1]:g} m follows "
        f"{x[i]:g} m{other}"
    )
    raise at(path, lines[i + 1], what if other else f"{what}; use sort = true to sort them")
