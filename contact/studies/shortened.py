"""Short forms of the measured tables for the pages of docs.

A study writes every column and row of a table. A page has room for the columns and rows that a
reader needs; `contact.studies.pages` keeps the whole table as a CSV file beside the page.
"""

from __future__ import annotations

import csv
import functools
import io
import math
import re
from collections.abc import Callable, Sequence
from typing import NamedTuple

Row = tuple[str, ...]

STIFF = 10.0  # a scene with a condition number below this loses at most one digit
UNITS = {"s": 1.0, "ms": 1e-3, "µs": 1e-6, "ns": 1e-9}


class Cells(NamedTuple):
    """The text cells of a Markdown table, and the lines below the table."""

    columns: Row
    rows: list[Row]
    remarks: list[str]


def parsed(text: str) -> Cells:
    """Read the first Markdown table of a text, as `contact.studies.bench.report` writes it."""
    lines = [line for line in text.splitlines() if line.strip()]
    table = [_cells(line) for line in lines if line.startswith("|")]
    return Cells(table[0], table[2:], [line for line in lines if not line.startswith("|")])


def _cells(line: str) -> Row:
    parts = re.split(r"(?<!\\)\|", line.strip())[1:-1]
    return tuple(part.strip().replace("\\|", "|") for part in parts)


def markdown(cells: Cells) -> str:
    """Write a table in Markdown, with its remarks below; without columns, only the remarks."""
    if not cells.columns:
        return "\n".join(cells.remarks) + "\n"
    lines = ["|" + "---|" * len(cells.columns)]
    for row in (cells.columns, *cells.rows):
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |")
    table = [lines[1], lines[0], *lines[2:]]
    return "\n".join([*table, "", *cells.remarks]) + "\n"


def as_csv(cells: Cells) -> str:
    """Write the table as CSV text."""
    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerows([cells.columns, *cells.rows])
    return stream.getvalue()


def columns(*names: str) -> Callable[[Cells], Cells]:
    """Return a function that keeps the named columns of a table.
    A column that the table lacks is left out.
    """

    def short(cells: Cells) -> Cells:
        # If two columns have the same name, "#2" is added to the second name, as in "true error#2".
        seen: dict[str, int] = {}
        for index, name in enumerate(cells.columns):
            seen[name if name not in seen else f"{name}#2"] = index
        return picked(cells, [seen[name] for name in names if name in seen])

    return short


def picked(cells: Cells, indices: Sequence[int]) -> Cells:
    """Return the table with the columns of these indices."""
    rows = [tuple(row[k] for k in indices) for row in cells.rows]
    return cells._replace(columns=tuple(cells.columns[k] for k in indices), rows=rows)


def in_turn(*steps: Callable[[Cells], Cells]) -> Callable[[Cells], Cells]:
    """Return a function that shortens a table by several functions, one after the other."""
    return lambda cells: functools.reduce(lambda found, step: step(found), steps, cells)


def least_and_largest(cells: Cells) -> Cells:
    """Short form of errors: the rows with the smallest and largest error in the second column."""
    ordered = sorted(cells.rows, key=lambda row: float(row[1]))
    return cells._replace(rows=[ordered[0], ordered[-1]] if len(ordered) > 1 else ordered)


def slow_scenes(cells: Cells) -> Cells:
    """Short form of a table of times.
    Of the scenes that take less than a millisecond, it keeps only the slowest.
    """
    times = [_seconds(row[1]) for row in cells.rows]
    fast = [index for index, time in enumerate(times) if time < 1e-3]
    slowest = max(fast, key=times.__getitem__, default=-1)
    rows = [row for index, row in enumerate(cells.rows) if index == slowest or index not in fast]
    if len(fast) > 1:
        place = next(k for k, row in enumerate(rows) if row == cells.rows[slowest])
        rows[place] = (f"slowest of {len(fast)} below 1 ms: {rows[place][0]}", *rows[place][1:])
    return cells._replace(rows=rows)


def stiff_groups(cells: Cells) -> Cells:
    """Short form of the table of groups of extreme scenes.
    A group is left out if all its scenes pass and its condition number is below `STIFF`.
    """
    rows = [
        row
        for row in cells.rows
        if not re.fullmatch(r"\d+ pass", row[1]) or not _number(row[3]) < STIFF
    ]
    return cells._replace(rows=rows)


def _number(cell: str) -> float:
    return float(cell) if re.match(r"\d", cell) else math.inf


def sentence(start: str, between: str) -> Callable[[Cells], Cells]:
    """Return a function that turns a table of names and values into one line of text."""

    def short(cells: Cells) -> Cells:
        parts = "; ".join(between.join(row[:2]) for row in cells.rows)
        return Cells((), [], [" ".join([f"{start}{parts}.", *cells.remarks])])

    return short


def hardest_reached(cells: Cells) -> Cells:
    """Short form of a table of times of several codes.
    For each scene it keeps the smallest error that was reached.

    The first column is the scene. The other columns are named "bound: code": for each bound of the
    error, from large to small, there is one column for each code. A bound counts as reached if a
    code other than the first reaches it. If no bound is reached, the largest one is shown.
    """
    bounds = list(dict.fromkeys(name.partition(": ")[0] for name in cells.columns[1:]))
    codes = list(dict.fromkeys(name.partition(": ")[2] for name in cells.columns[1:]))
    rows: list[Row] = []
    for scene, *times in cells.rows:
        blocks = [times[k * len(codes) : (k + 1) * len(codes)] for k in range(len(bounds))]
        reached = [
            k for k, block in enumerate(blocks) if any(cell[:1].isdigit() for cell in block[1:])
        ]
        chosen = max(reached, default=0)
        rows.append((scene, bounds[chosen].split()[-1], *blocks[chosen]))
    return cells._replace(columns=(cells.columns[0], "error", *codes), rows=rows)


def faster_elsewhere(cells: Cells) -> Cells:
    """Short form of a table of times: only scenes that another code solves faster.
    Of the columns, only those of the largest error bound are kept, which come first.
    """
    count = len({name.partition(": ")[2] for name in cells.columns[1:]})
    first = picked(cells, range(1 + count))
    rows = [row for row in first.rows if min(map(_seconds, row[2:])) < _seconds(row[1])]
    return first._replace(rows=rows)


def _seconds(cell: str) -> float:
    """Return the time of a cell such as "90.4 µs"; infinity if the cell has none."""
    number, _, unit = cell.partition(" ")
    return float(number) * UNITS[unit] if unit in UNITS else math.inf


def losses(cells: Cells) -> Cells:
    """Short form of the ablation table.
    For each mechanism that is switched off, it has the scenes lost or changed, and times.
    """
    rows: list[Row] = []
    for name, lost, changed, time, *large, within, extreme_time in cells.rows:
        counts = re.findall(r"\d+", within)
        not_within = str(int(counts[1]) - int(counts[0])) if len(counts) == 2 else "not run"
        of_large = str(int(large[0]) + int(large[1])) if large[1] else "not run"
        ordinary = str(int(lost) + int(changed))
        rows.append((name, ordinary, time, of_large, large[2], not_within, extreme_time))
    heads = (
        *("off", "ordinary scenes lost or changed", "time"),
        *("large scenes lost or changed", "time", "extreme scenes lost", "time"),
    )
    return cells._replace(columns=heads, rows=rows)


def largest(cells: Cells) -> Cells:
    """Short form of a table with several rows for each case: only the last row of each case."""
    last = {row[0]: row for row in cells.rows}
    return picked(cells._replace(rows=list(last.values())), (0, 1, 2, 5, 6, 7))


# Functions that shorten a table for the pages. Each key is the name of the table's file without its
# suffix.
SHORT: dict[str, Callable[[Cells], Cells]] = {
    "ablation": losses,
    "curves": columns("curve", "loads", "time", "largest stated error"),
    "hierarchy": in_turn(
        least_and_largest, columns("scene", "m=0", "m=1", "m=4", "m=16", "first order")
    ),
    "imports": sentence("A new interpreter that imports ", ": "),
    "machine": sentence("Measured with ", " "),
    "kinds-20000": columns("kind", "zones", "time [s]", "stated error"),
    "many-intervals": largest,
    "measured-trace": columns(
        "part of the full load", "zones", "contact fraction", "time [s]", "stated error"
    ),
    "peers": hardest_reached,
    "peers-mean": faster_elsewhere,
    "precision": in_turn(
        columns("scene", "time, tol 1e-04", "time, tol 1e-12", "true error#2", "stated#2"),
        slow_scenes,
    ),
    "sampling": columns("points", "time [s]", "stated error"),
    "scaling": columns("series", "zones", "nodes", "time", "time grows as"),
    "self-affine": columns("kmax", "zones", "time [s]", "peak memory [GB]", "stated error"),
    "stated": sentence("Runs that satisfy each condition: ", ", "),
    "stability": in_turn(
        stiff_groups, columns("scenes", "outcome", "condition", "its origin", "error")
    ),
    "stability-exceptions": columns("scene", "outcome"),
}
