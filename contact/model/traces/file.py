"""Reads the columns of a trace from a text file of an instrument, a spreadsheet or a program.

The delimiter, the decimal mark, the columns and their units have to be recognized. A file that can
be read in one way only is read in this way. A file that can be read in two ways is refused; the
message shows both ways and the option that selects each.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations, islice, pairwise
from math import nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact.errors import SceneError, shown
from contact.model.checks import integer
from contact.model.profiles.sampled import MIN_POINTS
from contact.model.traces.dropouts import is_comment, missing_number, no_height, without_phrases
from contact.model.traces.header import (
    Unit,
    bare_name,
    header_fields,
    is_depth,
    is_name,
    mentioned,
    scales,
    unit_words,
    units_of,
    units_row,
    written,
)  # fmt: skip
from contact.model.traces.readings import (
    HEADER_ROWS,
    Data,
    refuse_count,
    refuse_sideways,
    refuse_unclear_columns,
    refuse_unclear_commas,
)  # fmt: skip
from contact.model.traces.text import Layout, Row, Source, at, rows_of
from sie import Array

# Delimiters by the names that a user may give; None stands for white space.
_DELIMITERS = {";": ";", "\t": "\t", "tab": "\t", ",": ",", " ": None, "blank": None}
_DECIMALS = (".", ",")
_QUOTED = re.compile(r'"[+-]?\d*,\d+([eE][+-]?\d+)?"')
_GROUPED = re.compile(r"(?<![\d.,])\d{1,3}([.,' \xa0\u202f])\d{3}(\1\d{3})*[.,]\d")


@dataclass(frozen=True)
class Header:
    """Units and names that the header of a file gives for the wanted columns.

    line: number of the line with the units, 0 if no line has units; units: one for each column,
    None for a column without a unit; depth: the name of the heights if it means depths; remark:
    line number and word of a unit that belongs to no column.
    """

    line: int
    units: tuple[Unit | None, ...]
    depth: str = ""
    remark: tuple[int, str] | None = None


@dataclass(frozen=True)
class Table:
    """The numbers in the wanted columns (n rows, 1 to 3 columns), line numbers, and the header."""

    values: Array
    lines: NDArray[np.int64]
    header: Header
    counts: bool = False
    """Whether the positions are 0, 1, 2, ... or 1, 2, 3, ..."""
    number_above: int = 0
    """Line number of a number just above a single column of heights; 0 if there is none."""


@dataclass(frozen=True)
class _Found:
    """Rows of numbers that one layout (delimiter and decimal mark) finds, from row `first` on.

    `places` are the indices of the wanted columns.
    """

    layout: Layout
    places: tuple[int, ...]
    first: int


def read_table(
    path: Source,
    columns: Any = (),
    decimal: Any = None,
    delimiter: Any = None,
    wanted: int = 2,
    missing: Any = None,
) -> Table:
    """Read the wanted columns of a file: 2 columns for positions and heights, 1 for heights
    alone, 3 for x, y and z of a map.

    The data begin with the first two successive rows whose columns are numbers, and reach to the
    end of the file; empty lines and comments (#) are skipped. columns: indices from 0, or names of
    the header; if left out, the file must have no other columns of numbers. missing: a further mark
    for a missing height; missing heights are nan.
    """
    given = _columns(columns, wanted)
    between, marks = _asked(decimal, delimiter)
    rows = without_phrases(rows_of(path), missing)
    quoted = any(_QUOTED.search(line) for _, line in rows)
    layouts = [Layout(delimiter, mark, quoted) for delimiter in between for mark in marks]
    places = given or tuple(range(wanted))
    found = _with_dropouts(rows, _find(path, rows, places, layouts), missing)
    data = _data(path, rows, found, layouts)
    if len(data.rows) < (MIN_POINTS if given else data.width):
        refuse_sideways(path, rows, layouts)
    if decimal is None:
        refuse_unclear_commas(data)
    if not given:
        refuse_unclear_columns(data)
    refuse_count(data)
    values = np.array([_numbers(data, i, missing) for i in range(len(data.rows))])
    values[values[:, -1] == missing_number(missing), -1] = nan
    lines = np.array([line for line, _ in data.rows])
    if wanted == 1:
        _refuse_lost_lines(path, lines)
    if len(values) < MIN_POINTS:
        least = f"only {len(values)} rows of numbers, but at least {MIN_POINTS} are needed"
        raise at(path, lines[-1], least)
    header = _header(data)
    counts = not given and wanted == 2 and header.line == 0 and _counts(data, values)
    return Table(values, lines, header, counts, _number_above(data) if wanted == 1 else 0)


def in_metres(path: Source, table: Table, units: Any) -> tuple[Array, str]:
    """The numbers of a table in metres, and a text that says the units of the file.

    Given units must not contradict those of the header.
    """
    count, said, line = table.values.shape[1], table.header.units, table.header.line
    place = f"line {line} of the file {shown(str(path))}"
    both = tuple("?" if unit is None else unit.word for unit in said)
    if units is not None:
        along, up = scales(units)
        given = (along,) * (count - 1) + (up,)
        for unit, scale in zip(said, given, strict=True):
            if unit is not None and unit.scale is not None and unit.scale != scale:
                allowed = f"left out or {written(both)}, as {place} says (or correct the header)"
                if unit.why_not:
                    allowed = f"left out: {place} says {unit.why_not}: convert the numbers"
                raise SceneError.of("units", units, allowed)
        return table.values * given, written((units, units) if isinstance(units, str) else units)
    for unit in said:
        if unit is not None and unit.why_not:
            raise SceneError(f"units must be given: {place} says {unit.why_not}", "units")
    if None in said and any(said):
        what = f"{place} gives no unit for some columns, {written(both)}"
        raise SceneError(f"units must be given: {what}", "units")
    if table.header.remark is not None and not any(said):
        line, word = table.header.remark
        what = f"line {line} of the file {shown(str(path))} mentions {word!r}, but for no column"
        raise SceneError(f"units must be given: {what} (give m if the numbers are metres)", "units")
    source = "(the header's units)" if any(said) else "(no units given)"
    metre = Unit("m", 1.0)
    known = [unit or metre for unit in said]
    lengths = np.array([unit.scale for unit in known], dtype=float)
    return table.values * lengths, f"{written([unit.word for unit in known])} {source}"


def _columns(columns: Any, wanted: int) -> tuple[int | str, ...]:
    """The columns that the user gives, after a check; empty if the user gives none."""
    allowed = {
        1: "one column of heights, such as [1] or a name in a list, since pitch is given",
        2: "two different column indices (from 0) or names",
        3: "the three columns of x, y and z of a map: indices (from 0) or names",
    }[wanted]
    if (
        isinstance(columns, str)
        or not isinstance(columns, Sequence)
        or len(columns) not in (0, wanted)
    ):
        raise SceneError.of("columns", columns, allowed)
    if any(one == other for one, other in combinations(columns, 2)):
        raise SceneError.of("columns", columns, allowed)
    return tuple(c if isinstance(c, str) else integer("columns", c) for c in columns)


def _asked(decimal: Any, delimiter: Any) -> tuple[tuple[str | None, ...], tuple[str, ...]]:
    """The possible delimiters and decimal marks: the one that the user gives, or all known ones."""
    if decimal is not None and (not isinstance(decimal, str) or decimal not in _DECIMALS):
        raise SceneError.of("decimal", decimal, '"." or ","')
    if delimiter is not None and (not isinstance(delimiter, str) or delimiter not in _DELIMITERS):
        raise SceneError.of("delimiter", delimiter, '";", ",", "tab" or "blank"')
    between = (";", "\t", ",", None) if delimiter is None else (_DELIMITERS[delimiter],)
    return between, _DECIMALS if decimal is None else (decimal,)


def _find(
    path: Source, rows: list[Row], wanted: tuple[int | str, ...], layouts: list[Layout]
) -> _Found:
    """The rows of numbers that begin earliest in the file, and the layout that finds them."""
    names = [column for column in wanted if isinstance(column, str)]
    named = not names
    # The data of most files begin early. So the first row is searched, then twice as many rows in
    # each further step.
    for power in range(len(rows).bit_length() + 1):
        among = rows[: 2**power]
        found = []
        for layout in layouts:
            start, header = _named(among, layout, names)
            if start is None:
                continue
            named = True
            places = tuple(
                header.index(column) if isinstance(column, str) else column for column in wanted
            )
            first = _first_of_two(among, start, layout, places)
            if first is not None:
                found.append(_Found(layout, places, first))
        if found:
            return min(found, key=lambda f: f.first)
    asked = f"columns {shown(list(wanted))}"
    if not named:
        raise at(path, 0, f"no header row has the names in {asked}{_no_names(rows, layouts)}")
    why = _why_none(path, rows, wanted, layouts)
    raise at(path, 0, f"no two successive rows have numbers in {asked}{why}")


def _named(rows: list[Row], layout: Layout, names: list[str]) -> tuple[int | None, list[str]]:
    """Index of the row after the header with the given names, and the fields of this header.

    The header is the first row that has all of `names`. The index is None without such a row, and
    0 if there are no names.
    """
    if not names:
        return 0, []
    for after, (_, line) in enumerate(rows, 1):
        for fields in header_fields(line, layout.delimiter):
            for cells in (fields, [bare_name(field) for field in fields]):
                if all(cells.count(name) == 1 for name in names):
                    return after, cells
    return None, []


def _first_of_two(
    rows: list[Row], start: int, layout: Layout, places: tuple[int, ...]
) -> int | None:
    numeric = (
        layout.numbers(layout.cells(line), places) is not None
        for _, line in islice(rows, start, None)
    )
    return next((i for i, both in enumerate(pairwise(numeric), start) if all(both)), None)


def _with_dropouts(rows: list[Row], found: _Found, missing: Any) -> _Found:
    """The rows `found`, which begin earlier if rows with missing heights precede them.

    Single points among these rows are included, too. They were not found, since the data begin with
    two successive rows of numbers. A row with an unknown word for a missing height is included and
    refused later. For heights alone, such a word ends the data, since it may be the header.
    """
    *others, last = found.places
    first = above = found.first
    while above > 0:
        above -= 1
        text = rows[above][1]
        cells = found.layout.cells(text)
        if found.layout.numbers(cells, found.places) is not None:
            first = above
            continue
        # A row with a single number need not be a point of the trace. The number may be, for
        # example, the count of points.
        lone = last >= len(cells) and (found.layout.delimiter or "\n") not in text
        if lone or (others and found.layout.numbers(cells, others) is None):
            break
        if no_height(cells[last] if last < len(cells) else "", missing):
            first = above
        elif not others or last >= len(cells):
            break
    return replace(found, first=first)


def _why_none(
    path: Source, rows: list[Row], wanted: tuple[int | str, ...], layouts: list[Layout]
) -> str:
    """Advice for the error message if a file has no two rows of numbers in the wanted columns."""
    refuse_sideways(path, rows, layouts)
    if any(_GROUPED.search(line) for _, line in rows):
        return ": if the numbers have thousands separators, remove them; otherwise check columns"
    if all(layout.decimal == "," for layout in layouts) and any(
        layout.delimiter == "," for layout in layouts
    ):
        return (
            ": if commas separate both columns and decimals, every number must have decimals; "
            "use ; between columns"
        )
    widths = [len(data[1]) for data in _tables(rows, layouts)]
    if len(wanted) == 2 and (wanted == (0, 1) or not widths) and _tables(rows, layouts, (0,)):
        return (
            ": if the only column has heights, give pitch, the distance [m] between points; if "
            "there are more columns, use columns to choose them (the first is 0)"
        )
    width = max(widths, default=0)
    lacking = [column for column in wanted if isinstance(column, int) and column >= width > 0]
    if lacking:
        of_map = "; line is only for a map of x, y and z" if len(wanted) == 3 else ""
        return f": there is no column {lacking[0]}, only columns 0 to {width - 1}{of_map}"
    return ": if other columns have the numbers, use columns to choose them"


def _tables(
    rows: list[Row], layouts: list[Layout], places: tuple[int, ...] = (0, 1)
) -> list[tuple[int, list[str]]]:
    """For each layout that finds rows of numbers, the index of the first such row, and its
    cells.
    """
    starts = ((layout, _first_of_two(rows, 0, layout, places)) for layout in layouts)
    return [(i, layout.cells(rows[i][1])) for layout, i in starts if i is not None]


def _no_names(rows: list[Row], layouts: list[Layout]) -> str:
    """The names in the file's header, for the error message that other names are missing."""
    for layout in layouts:
        for start, cells in _tables(rows, [layout]):
            for line, text in reversed(rows[:start]):
                for fields in header_fields(text, layout.delimiter):
                    if len(fields) == len(cells):
                        return f": line {line} has {shown(fields).strip('[]')}"
    return ""


def _data(path: Source, rows: list[Row], found: _Found, layouts: list[Layout]) -> Data:
    """The rows of the data, read with the decimal mark that fits all of them.

    The first decimal mark may come in a late row, as in "1;2" followed by "1,5;2".
    """
    tail = [row for row in rows[found.first :] if not is_comment(row[1])]

    def under(layout: Layout) -> Data:
        return Data(
            path,
            layout,
            found.places,
            tail,
            [layout.cells(line) for _, line in tail],
            rows[: found.first],
        )

    data = under(found.layout)
    if any(found.layout.numbers(row, found.places) is None for row in data.cells):
        for layout in layouts:
            if layout.delimiter == found.layout.delimiter and layout != found.layout:
                other = under(layout)
                if all(layout.numbers(row, found.places) is not None for row in other.cells):
                    return other
    return data


def _numbers(data: Data, i: int, missing: Any) -> list[float]:
    """The numbers in the wanted columns of row i; NaN for a missing height."""
    line, text = data.rows[i]
    cells = data.cells[i]
    values = data.layout.numbers(cells, data.places)
    if values is not None:
        return values
    *others, last = data.places
    rest = data.layout.numbers(cells, others) if others else []
    if rest is not None and no_height(cells[last] if last < len(cells) else "", missing):
        return [*rest, nan]
    hint = ""
    if _GROUPED.search(text):
        hint = " (if a number has thousands separators, remove them)"
    elif rest is not None and last < len(cells):
        hint = (
            f"; if the entry for the height marks a missing one, use missing = {shown(cells[last])}"
        )
    what = {1: "number in column", 2: "two numbers in columns", 3: "three numbers in columns"}[
        len(data.places)
    ]
    raise at(data.path, line, f"no {what} {list(data.places)}: {shown(text.strip())}{hint}")


def _refuse_lost_lines(path: Source, lines: NDArray[np.int64]) -> None:
    """Refuse empty lines and comments among heights without positions, as they may stand for
    missing points.

    Equal distances between all lines are accepted.
    """
    wide = np.flatnonzero(np.diff(lines) != np.min(np.diff(lines), initial=1 << 60))
    if wide.size:
        what = "an empty line or a comment between heights, which have a pitch but no positions"
        cure = "delete it, or write nan if a height is missing there"
        raise at(path, lines[wide[0]] + 1, f"{what}: {cure}")


def _counts(data: Data, values: Array) -> bool:
    """Whether the first column may count the points: 0, 1, 2, ... or 1, 2, 3, ...

    False if the values of the second column are integers too.
    """
    whole = all(row[0].isdigit() for row in data.cells if row)
    x = values[:, 0]
    heights_too = np.all(values[:, 1] == np.rint(values[:, 1]))
    return bool(whole and not heights_too and x[0] in (0, 1) and np.all(np.diff(x) == 1))


def _number_above(data: Data) -> int:
    """Line number of a decimal number just above a single column of heights; 0 if there is none.

    Whole numbers are ignored: they are numbers of points.
    """
    for line, text in data.before[-HEADER_ROWS:]:
        cells = data.layout.cells(text)
        if len(cells) == 1 and "." in cells[0] and data.layout.number(cells[0]) is not None:
            return line
    return 0


def _header(data: Data) -> Header:
    """The header of the wanted columns, found in the rows before the data."""
    named = [(line, [fields[place] for place in data.places]) for line, fields in data.headers()]
    depth = next((cells[-1] for _, cells in named if is_depth(cells[-1])), "")
    said: Header | None = None
    past_names = False
    for i, (line, cells) in enumerate(named):
        above = next((other for upper, other in named[i + 1 :] if upper != line), [])
        # Rows above the names of the columns are titles. Words in brackets in titles are not units.
        units: tuple[Unit | None, ...] | None = units_row(cells, above)
        if units is None:
            units = (None,) * len(cells) if past_names else units_of(cells)
        if any(unit is not None and unit.scale is not None for unit in units):
            return Header(line, units, depth)
        if any(units) and said is None and not past_names:
            said = Header(line, units, depth)
        past_names = past_names or any(is_name(cell) for cell in cells)
    if said is not None:
        return said
    # Units may also be given in the rows of data, as in "0.5 um  1.2 um".
    spoken = ((line, mentioned(text)) for line, text in [*data.before, data.rows[0]])
    remark = next(((line, word) for line, word in spoken if word), None)
    if remark is None and not named:
        # A header that cannot be divided into columns may still have one unit for each column.
        words = ((line, unit_words(text)) for line, text in data.before[-HEADER_ROWS:])
        remark = next(((line, w[0]) for line, w in words if len(w) == data.width > 1), None)
    return Header(0, (None,) * len(data.places), depth, remark)
