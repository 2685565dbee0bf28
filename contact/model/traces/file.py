"""The two columns of a trace in a text file, as instruments, spreadsheets and programs write them.

A file has many readings: what stands between columns, what marks decimals, which columns are meant, in which units. One that
can be told is taken; where two are possible the file is refused, with both of them and what to write for each.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import islice, pairwise
from math import nan
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact.errors import SceneError, shown
from contact.model.checks import integer
from contact.model.traces.dropouts import no_height
from contact.model.traces.header import UNITS, bare_name, header_fields, known, scales, unit_of, written
from contact.model.traces.readings import Data, refuse_unclear_columns, refuse_unclear_commas
from contact.model.traces.text import Layout, Row, at, rows_of
from sie import Array

FEWEST = 4  # points
_HEAD = 500  # rows in which nearly all files have begun
_LAST = 2  # rows before the data that may be about its columns: names, and units below them
_DELIMITERS = {";": ";", "\t": "\t", "tab": "\t", ",": ",", " ": None, "blank": None}  # None: white space
_DECIMALS = (".", ",")
_QUOTED = re.compile(r'"[+-]?\d*,\d+([eE][+-]?\d+)?"')
_GROUPED = re.compile(r"(?<![\d.,])\d{1,3}([.,' \xa0\u202f])\d{3}(\1\d{3})*[.,]\d")


@dataclass(frozen=True)
class Table:
    """The wanted columns as in the file (n, 1 or 2), the line of each row, and the units that the header says, on one of its lines."""

    values: Array
    lines: NDArray[np.int64]
    header: tuple[str | None, ...]
    header_line: int


@dataclass(frozen=True)
class _Found:
    """A layout under which rows of numbers begin with row `first`, and the places of the wanted ones among the cells."""

    layout: Layout
    places: tuple[int, ...]
    first: int


def read_table(
    path: str | Path, columns: Any = (), decimal: Any = None, delimiter: Any = None, wanted: int = 2, missing: Any = None
) -> Table:
    """The numbers of a file's `wanted` columns: 2, positions and heights, or 1, heights alone.

    The data begin with the first two rows in a run whose columns are numbers, and go on to the end of the file; empty lines and
    comments (#) are passed over. columns: indices from 0, or names of the header; left out, the file must have no more than these.
    missing: what stands, besides the usual words, where there is no height; heights there are nan.
    """
    given = _columns(columns, wanted)
    between, marks = _asked(decimal, delimiter)
    rows = rows_of(path)
    quoted = any(_QUOTED.search(line) for _, line in rows)
    layouts = [Layout(delimiter, mark, quoted) for delimiter in between for mark in marks]
    found = _with_dropouts(rows, _find(path, rows, given or tuple(range(wanted)), layouts), missing)
    data = _data(path, rows, found, layouts)
    if decimal is None:
        refuse_unclear_commas(data)
    if not given:
        refuse_unclear_columns(data)
    values = np.array([_numbers(data, i, missing) for i in range(len(data.rows))])
    if missing is not None and not isinstance(missing, str):
        values[values[:, -1] == missing, -1] = nan
    lines = np.array([line for line, _ in data.rows])
    if wanted == 1:
        _refuse_empty_lines(path, lines[0], rows)
    if len(values) < FEWEST:
        raise at(path, lines[-1], f"only {len(values)} rows of numbers, at least {FEWEST} are needed")
    header_line, header = _header_units(data)
    return Table(values, lines, header, header_line)


def in_metres(path: str | Path, table: Table, units: Any) -> tuple[Array, str]:
    """The numbers of a table in metres, and the units; those of the header unless others are given, which must not contradict it."""
    count, said = table.values.shape[1], table.header
    place = f"line {table.header_line} of the file {str(path)!r}"
    both = tuple(name or "?" for name in said)
    if units is not None:
        given = scales(units)[-count:]
        if any(name is not None and UNITS[name] != scale for name, scale in zip(said, given, strict=True)):
            allowed = f"left out or {written(both)}, as {place} says (or the header put right)"
            raise SceneError.of("units", units, allowed)
        return table.values * given, written((units, units) if isinstance(units, str) else tuple(units))
    if None in said and any(said):
        raise SceneError(f"units must be given: {place} says them of one column only, {written(both)}", "units")
    names = tuple(name or "m" for name in said)
    source = "the header's units" if any(said) else "no units being given"
    return table.values * [UNITS[name] for name in names], f"{written(names)}, {source}"


# What is asked for ------------------------------------------------------------------------------------------------------------
def _columns(columns: Any, wanted: int) -> tuple[int | str, ...]:
    """The columns asked for; empty if the file is to tell."""
    allowed = "two different column indices (from 0) or names" if wanted == 2 else "with a pitch one column, of heights: [1], or a name"
    if isinstance(columns, str) or not isinstance(columns, Sequence) or len(columns) not in (0, wanted):
        raise SceneError.of("columns", columns, allowed)
    if len(columns) == 2 and columns[0] == columns[1]:
        raise SceneError.of("columns", columns, allowed)
    return tuple(c if isinstance(c, str) else integer("columns", c) for c in columns)


def _asked(decimal: Any, delimiter: Any) -> tuple[tuple[str | None, ...], tuple[str, ...]]:
    """What may stand between columns, and what may mark decimals."""
    if decimal is not None and (not isinstance(decimal, str) or decimal not in _DECIMALS):
        raise SceneError.of("decimal", decimal, '"." or ","')
    if delimiter is not None and (not isinstance(delimiter, str) or delimiter not in _DELIMITERS):
        raise SceneError.of("delimiter", delimiter, '";", ",", "tab" or "blank"')
    between = (";", "\t", ",", None) if delimiter is None else (_DELIMITERS[delimiter],)
    return between, _DECIMALS if decimal is None else (decimal,)


# The table --------------------------------------------------------------------------------------------------------------------
def _find(path: str | Path, rows: list[Row], wanted: tuple[int | str, ...], layouts: list[Layout]) -> _Found:
    """The layout under which rows of numbers begin first."""
    names = [column for column in wanted if isinstance(column, str)]
    named = not names
    for among in (rows[:_HEAD], rows):
        found = []
        for layout in layouts:
            start, header = _named(among, layout, names)
            if start is None:
                continue
            named = True
            places = tuple(header.index(column) if isinstance(column, str) else column for column in wanted)
            first = _first_of_two(among, start, layout, places)
            if first is not None:
                found.append(_Found(layout, places, first))
        if found:
            return min(found, key=lambda f: f.first)
    what = f"no header row with the names in columns {list(wanted)}"
    if named:
        what = f"no two rows of numbers in a run in columns {list(wanted)}{_why_none(rows, wanted, layouts)}"
    raise at(path, 0, what)


def _named(rows: list[Row], layout: Layout, names: list[str]) -> tuple[int | None, list[str]]:
    """The row after the one that holds every name once, with or without units, and its fields; row 0 if no names are asked for."""
    if not names:
        return 0, []
    for after, (_, line) in enumerate(rows, 1):
        for fields in header_fields(line, layout.delimiter):
            for cells in (fields, [bare_name(field) for field in fields]):
                if all(cells.count(name) == 1 for name in names):
                    return after, cells
    return None, []


def _first_of_two(rows: list[Row], start: int, layout: Layout, places: tuple[int, ...]) -> int | None:
    numeric = (layout.numbers(layout.cells(line), places) is not None for _, line in islice(rows, start, None))
    return next((i for i, both in enumerate(pairwise(numeric), start) if all(both)), None)


def _with_dropouts(rows: list[Row], found: _Found, missing: Any) -> _Found:
    """The same, begun with the rows before that lack nothing but a height: they are data, and no header."""
    *others, last = found.places
    first = found.first
    while first > 0:
        cells = found.layout.cells(rows[first - 1][1])
        if (others and found.layout.numbers(cells, others) is None) or not no_height(cells[last] if last < len(cells) else "", missing):
            break
        first -= 1
    return replace(found, first=first)


def _why_none(rows: list[Row], wanted: tuple[int | str, ...], layouts: list[Layout]) -> str:
    if any(_GROUPED.search(line) for _, line in rows):
        return ": numbers with separators of thousands are not read, write them without"
    if any(layout.delimiter == layout.decimal for layout in layouts) and all(layout.decimal == "," for layout in layouts):
        return ": commas between columns and in numbers are told apart only where every number has decimals; write ; between columns"
    if len(wanted) == 2 and any(_first_of_two(rows, 0, layout, (0,)) is not None for layout in layouts):
        return ": a column of heights alone needs pitch, their distance [m]; of more columns, columns says which (the first is 0)"
    return ": columns says in which they are"


def _data(path: str | Path, rows: list[Row], found: _Found, layouts: list[Layout]) -> Data:
    """The rows of a table. Signs of decimals may be seen in later rows only, as in 1;2 and then 1,5;2."""
    tail = [row for row in rows[found.first :] if not row[1].lstrip().startswith("#")]

    def under(layout: Layout) -> Data:
        return Data(path, layout, found.places, tail, [layout.cells(line) for _, line in tail], rows[: found.first])

    data = under(found.layout)
    if any(found.layout.numbers(row, found.places) is None for row in data.cells):
        for layout in layouts:
            if layout.delimiter == found.layout.delimiter and layout != found.layout:
                other = under(layout)
                if all(layout.numbers(row, found.places) is not None for row in other.cells):
                    return other
    return data


def _numbers(data: Data, i: int, missing: Any) -> list[float]:
    """The numbers of a row, nan for a height that is missing."""
    line, text = data.rows[i]
    cells = data.cells[i]
    values = data.layout.numbers(cells, data.places)
    if values is not None:
        return values
    *others, last = data.places
    rest = data.layout.numbers(cells, others) if others else []
    if rest is not None and no_height(cells[last] if last < len(cells) else "", missing):
        return [*rest, nan]
    hint = " (separators of thousands are not read)" if _GROUPED.search(text) else ""
    what = "two numbers in columns" if len(data.places) == 2 else "number in column"
    raise at(data.path, line, f"no {what} {list(data.places)}: {shown(text.strip())}{hint}")


def _refuse_empty_lines(path: str | Path, first: int, rows: list[Row]) -> None:
    """Of heights alone an empty line may be one that is missing; unless all lines stand as far apart."""
    lines = np.array([line for line, _ in rows if line >= first])
    wide = np.flatnonzero(np.diff(lines) != np.min(np.diff(lines), initial=1 << 60))
    if wide.size:
        what = "an empty line among heights that follow one another at a pitch: take it out, or write nan if a height is missing there"
        raise at(path, lines[wide[0]] + 1, what)


def _header_units(data: Data) -> tuple[int, tuple[str | None, ...]]:
    """The line of a header that says units of the columns, and these; None for those it does not say."""
    for line, text in reversed(data.before[-_LAST:]):
        for fields in header_fields(text, data.layout.delimiter):
            # What begins with a number, as "1500.0 um", is no name of a column.
            if len(fields) != data.width or any(re.match(r"[+-]?[\d.,]", field) for field in fields):
                continue
            cells = [fields[place] for place in data.places]
            # A row of nothing but units may stand below the names.
            alone = tuple(known(cell.strip("[]()")) for cell in cells)
            said = alone if None not in alone else tuple(unit_of(cell) for cell in cells)
            if any(said):
                return line, said
    return 0, (None,) * len(data.places)
