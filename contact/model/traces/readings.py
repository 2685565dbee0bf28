"""Rows of numbers that can be read in two ways: refused, with both readings and what to write for
each.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from contact.errors import shown
from contact.model.traces.header import header_fields, in_pairs, is_name, unit_of
from contact.model.traces.text import Layout, Row, at

_WHOLE = re.compile(r"[+-]?\d+([eE][+-]?\d+)?")
# Names of columns that count the points.
_COUNTS = (
    "", "#", "i", "n", "no", "nr", "idx", "index", "point", "points", "sample", "samples", "row",
    "count", "punkt", "messpunkt", "nummer", "number", "numero", "номер", "№", "序号", "番号",
)  # fmt: skip
_REMARKS = 3  # rows before heights alone that may be about them: any remark has one field, as they
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}(,\d{3})+")
_NUMBER = re.compile(r"[+-]?[\d.,]")
_FREE_NUMBER = re.compile(r"(?<!\w)\d")
_LONG = 20  # rows: in a shorter table a whole number is its length by chance
_SIDEWAYS = 8  # numbers in a row that make it one of a table on its side


def is_count(name: str) -> bool:
    """Whether a column of that name counts the points."""
    return name.strip(".").lower() in _COUNTS


@dataclass(frozen=True)
class Data:
    """The rows from the first of numbers on: their lines and cells, and the rows before them."""

    path: str | Path
    layout: Layout
    places: tuple[int, ...]
    rows: list[Row]
    cells: list[list[str]]
    before: list[Row]

    @property
    def width(self) -> int:
        return max(map(len, self.cells))

    @property
    def heading(self) -> str:
        """The row before the first."""
        return self.before[-1][1] if self.before else ""

    def headers(self) -> Iterator[tuple[int, list[str]]]:
        """Line and fields of the rows that may be headers of the columns, the nearest first.

        They have as many fields as the data have columns; rows of other numbers end the search.
        """
        near = self.before
        if self.width == 1:
            near = [row for row in near[-_REMARKS:] if not _FREE_NUMBER.search(row[1])]
        for line, text in reversed(near):
            if self.layout.numbers(self.layout.cells(text), self.places) is not None:
                return
            for i, fields in enumerate(header_fields(text, self.layout.delimiter)):
                if len(fields) == 2 * self.width:
                    fields = in_pairs(fields)
                # Divided as the data are, the last columns may have no name, or no unit.
                columns = text.count(self.layout.delimiter or "\n") + 1
                if i == 0 and len(fields) < columns == self.width:
                    fields = [*fields, *[""] * (self.width - len(fields))]
                # What begins with a number, as "1500.0 um", is no name of a column.
                if len(fields) == self.width and not any(_NUMBER.match(field) for field in fields):
                    yield line, fields

    @property
    def names(self) -> list[str]:
        """Names of the columns, of the nearest row that looks like names."""
        found = [fields for _, fields in self.headers()]
        usual = (f for f in found if any(is_name(n) or n and is_count(n) or unit_of(n) for n in f))
        return next(usual, found[0] if found else [f"column {k}" for k in range(self.width)])


def refuse_unclear_commas(data: Data) -> None:
    """Commas between columns, or in numbers: 0,5,1,2 is 0 | 5 | 1 | 2 or 0.5 | 1.2; and 1,234 may
    be 1234.
    """
    layout, wanted = data.layout, len(data.places)
    if layout.decimal == ",":
        _refuse_unclear_thousands(data)
        if (
            wanted == 1
            and data.width == 1
            and all(_are_columns(text.split(",")) for _, text in data.rows)
        ):
            _refuse_commas(data, [text.split(",") for _, text in data.rows])
        return
    if layout.delimiter != "," or any('"' in text for _, text in data.rows):
        return
    for (line, text), cells in zip(data.rows, data.cells, strict=True):
        # 1,000.5 and 0,05: nobody writes 000.5 or 05, but where all numbers are padded.
        part = next((cell for cell in cells[1:] if re.match(r"0\d", cell)), None)
        if (
            part is not None
            and not re.match(r"0\d", cells[0])
            and (data.width <= wanted or not _are_columns(cells))
        ):
            readings = f"{part!r} in {text.strip()!r} can be read as a column, or as the end of a number with a comma in it"
            raise at(
                data.path,
                line,
                f'{readings}: write decimal = "." for the first, take the commas out of numbers for the second',
            )
    if data.width <= wanted:
        return
    for (_, text), cells in zip(data.rows, data.cells, strict=True):
        # A space behind a comma, a point, or a sign in every place but the first: commas stand
        # between columns.
        if (
            re.search(r",\s+\S", text)
            or not _are_columns(cells)
            or not any(cell[0].isdigit() for cell in cells[1:])
        ):
            return
    names = next(header_fields(data.heading, ","), [])
    if len(names) != data.width or any(layout.number(name) is not None for name in names):
        _refuse_commas(data, data.cells)


def _are_columns(cells: list[str]) -> bool:
    """Whether a row may be whole numbers between commas, two or more."""
    return len(cells) > 1 and all(_WHOLE.fullmatch(cell) for cell in cells)


def _refuse_commas(data: Data, cells: list[list[str]]) -> None:
    most = max(map(len, cells))
    i = next(i for i, row in enumerate(cells) if len(row) == most)
    pairs = " | ".join(",".join(cells[i][k : k + 2]) for k in range(0, most, 2))
    as_decimals = (
        f"as {pairs}, with decimal commas"
        if most % 2 == 0
        else "with decimal commas in some of them"
    )
    readings = f"{data.rows[i][1].strip()!r} can be read as {most} columns, {' | '.join(cells[i])}, or {as_decimals}"
    raise at(
        data.path,
        data.rows[i][0],
        f'{readings}: write decimal = "." for the first, decimal = "," for the second',
    )


def _refuse_unclear_thousands(data: Data) -> None:
    cells = (
        (line, row[k])
        for (line, _), row in zip(data.rows, data.cells, strict=True)
        for k in data.places
        if k < len(row)
    )
    marked = [(line, cell) for line, cell in cells if "," in cell]
    if marked and all(_THOUSANDS.fullmatch(cell) for _, cell in marked):
        line, cell = marked[0]
        readings = f"{cell!r} can be read as {cell.replace(',', '.')} or as {cell.replace(',', '')}"
        raise at(
            data.path,
            line,
            f'{readings}: write decimal = "," for the first, take the commas out for the second',
        )


def refuse_unclear_columns(data: Data) -> None:
    """More columns of numbers than are wanted, and none of them chosen."""
    layout, wanted, names = data.layout, len(data.places), data.names
    numeric = [
        k
        for k in range(data.width)
        if any(len(row) > k and layout.number(row[k]) is not None for row in data.cells)
    ]
    line = data.rows[0][0]
    if len(numeric) <= wanted:
        first = names[data.places[0]]
        if wanted == 2 and is_count(first):
            told = f"the first column is called {first!r}, a count, and no positions"
            choice = (
                "columns = [1] and pitch, their distance [m]; if it is positions, columns = [0, 1]"
            )
            raise at(data.path, line, f"{told}; of heights alone write {choice}")
        return
    i = next(i for i, row in enumerate(data.cells) if len(row) > numeric[-1])
    choices = [numeric[:wanted], numeric[1 : 1 + wanted]]
    readings = ", or ".join(
        f"columns = {choice} for {' and '.join(shown(names[k]) for k in choice)}"
        for choice in choices
    )
    what = "positions and heights" if wanted == 2 else "the heights"
    row = shown(" | ".join(data.cells[i])).strip("'")
    told = f"{len(numeric)} columns of numbers, {row}: which are {what} is not to be told"
    raise at(
        data.path, data.rows[i][0], f"{told}; write {readings}, or as they are, counted from 0"
    )


def refuse_sideways(path: str | Path, rows: list[Row], layouts: list[Layout]) -> None:
    """A table whose rows are what its columns should be: few rows, each of many numbers."""
    for layout in layouts:
        counts = [
            (sum(layout.number(cell) is not None for cell in layout.cells(text)), line)
            for line, text in rows
        ]
        long = [(count, line) for count, line in counts if count > 1]
        least = min(long, default=(0, 0))[0]
        if least >= _SIDEWAYS and 2 * len(long) <= least:
            many = (
                f"{len(long)} rows of {least} numbers"
                if len(long) > 1
                else f"a row of {least} numbers"
            )
            raise at(path, long[0][1], f"{many}: the table lies on its side; write a point a line")


def refuse_count(data: Data) -> None:
    """A number of points among the first rows, which would be one of them.

    It is a whole number, the number of the rows below it, or below the next two in a long table.
    Positions at even steps may begin so too, as 11, 10, 9.
    """
    total, mark = len(data.rows), data.layout.decimal
    first = [[row[k] if k < len(row) else "" for k in data.places] for row in data.cells[:5]]
    values = [data.layout.number(cells[0]) for cells in first]
    for i, (value, cells) in enumerate(zip(values[:3], first, strict=False)):
        below = range(i + 1, 4) if total >= _LONG else (1,)
        if not _WHOLE.fullmatch(cells[0]) or value not in [total - k for k in below]:
            continue
        near = [number for number in values[i : i + 3] if number is not None]
        if len(cells) == 2 and len(near) == 3 and 2 * near[1] == near[0] + near[2]:
            continue
        line, text = data.rows[i]
        told = f"{shown(text.strip())} looks like the number of points below it"
        what = f"take the line out, or put # before it; if it is a point, write {cells[0]}{mark}0"
        raise at(data.path, line, f"{told}: {what}")
