"""Refusal of tables that can be read in two ways; the message shows how to choose."""

import re
from collections.abc import Iterator
from dataclasses import dataclass

from contact.errors import shown
from contact.model.profiles.sampled import MIN_POINTS
from contact.model.traces.dropouts import LONG_TABLE
from contact.model.traces.header import header_fields, in_pairs, is_name, unit_of
from contact.model.traces.text import Layout, Row, Source, at

_WHOLE = re.compile(r"[+-]?\d+([eE][+-]?\d+)?")
# Names of columns that count the points.
_COUNTS = (
    "", "#", "i", "n", "no", "nr", "idx", "index", "point", "points", "sample", "samples", "row",
    "count", "punkt", "messpunkt", "nummer", "number", "numero", "номер", "№", "序号", "番号",
)  # fmt: skip
# Number of rows just above the data that are searched for a header. One of these rows may be a
# header even if its number of columns differs from that of the data.
HEADER_ROWS = 3
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}(,\d{3})+")
_NUMBER = re.compile(r"[+-]?[\d.,]")
_FREE_NUMBER = re.compile(r"(?<!\w)\d")


def is_count(name: str) -> bool:
    """Whether a column of this name counts the points."""
    return name.strip(".").lower() in _COUNTS


@dataclass(frozen=True)
class Data:
    """The rows of data with their line numbers and cells, and the rows before the data.

    places: indices of the columns that are read as positions and heights. width: number of columns.
    """

    path: Source
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
        """The text of the row just before the data; empty if there is none."""
        return self.before[-1][1] if self.before else ""

    def headers(self) -> Iterator[tuple[int, list[str]]]:
        """Line number and fields of each row that may be a header, beginning with the row nearest
        to the data.

        A header has as many fields as the data have columns. The search ends at a row that has
        numbers in the columns to be read.
        """
        candidates = self.before
        if self.width == 1:
            candidates = [r for r in candidates[-HEADER_ROWS:] if not _FREE_NUMBER.search(r[1])]
        for line, text in reversed(candidates):
            if self.layout.numbers(self.layout.cells(text), self.places) is not None:
                return
            for i, fields in enumerate(header_fields(text, self.layout.delimiter)):
                if len(fields) == 2 * self.width:
                    fields = in_pairs(fields)
                # The header may have fewer fields than columns, if the last columns have no name or
                # no unit.
                columns = text.count(self.layout.delimiter or "\n") + 1
                if i == 0 and len(fields) < columns == self.width:
                    fields = [*fields, *[""] * (self.width - len(fields))]
                # A field that begins with a number, such as "1500.0 um", is not a column's name.
                if len(fields) == self.width and not any(_NUMBER.match(field) for field in fields):
                    yield line, fields

    @property
    def names(self) -> list[str]:
        """Names of the columns, from the nearest row above the data that looks like names."""
        found = [fields for _, fields in self.headers()]
        usual = (f for f in found if any(is_name(n) or n and is_count(n) or unit_of(n) for n in f))
        return next(usual, found[0] if found else [f"column {k}" for k in range(self.width)])


def refuse_unclear_commas(data: Data) -> None:
    """Refuse commas whose meaning is unclear: delimiters, decimal marks or separators of
    thousands.

    For example, 0,5,1,2 is 0 | 5 | 1 | 2 or 0.5 | 1.2; and 1,234 may be 1234.
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
        # A cell that begins with 0 and a digit (000.5 in 1,000.5, or 05 in 0,05) may be the end of
        # a number that contains a comma. If the first cell of the row also begins with 0 and a
        # digit, the numbers are taken as padded with zeros, and the commas as delimiters.
        part = next((cell for cell in cells[1:] if re.match(r"0\d", cell)), None)
        if (
            part is not None
            and not re.match(r"0\d", cells[0])
            and (data.width <= wanted or not _are_columns(cells))
        ):
            readings = f"{part!r} in {text.strip()!r} can be read as a column, or as the end of "
            readings += "a number that contains a comma"
            cure = 'decimal = "." for the first reading, or remove the commas from the numbers'
            raise at(data.path, line, f"{readings}; set {cure}")
    if data.width <= wanted:
        return
    for (_, text), cells in zip(data.rows, data.cells, strict=True):
        # Commas are delimiters if a space follows one, if there is a decimal point, or if all
        # fields after the first have a sign.
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
    """Whether a row may consist of two or more whole numbers separated by commas."""
    return len(cells) > 1 and all(_WHOLE.fullmatch(cell) for cell in cells)


def _refuse_commas(data: Data, cells: list[list[str]]) -> None:
    most = max(map(len, cells))
    i = next(i for i, row in enumerate(cells) if len(row) == most)
    pairs = " | ".join(",".join(cells[i][k : k + 2]) for k in range(0, most, 2))
    as_decimals = (
        f"as {pairs}, with decimal commas"
        if most % 2 == 0
        else "as fewer columns, some with decimal commas"
    )
    line, text = data.rows[i]
    columns = f"{most} columns, {' | '.join(cells[i])}"
    readings = f"{text.strip()!r} can be read as {columns}, or {as_decimals}"
    cure = 'set decimal = "." for the first reading, decimal = "," for the second'
    raise at(data.path, line, f"{readings}; {cure}")


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
        cure = 'set decimal = "," for the first reading, or remove the commas for the second'
        raise at(data.path, line, f"{readings}; {cure}")


def refuse_unclear_columns(data: Data) -> None:
    """Refuse a table if it is unclear which columns to read.
    This check is made only if the user has chosen no columns.
    """
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
            what = f"the first column, {first!r}, seems to count the points"
            choice = (
                "columns = [1] and pitch, the distance of the points [m]; if the first column has "
                "positions, set columns = [0, 1]"
            )
            raise at(data.path, line, f"{what}; to read the heights alone, set {choice}")
        return
    i = next(i for i, row in enumerate(data.cells) if len(row) > numeric[-1])
    choices = [numeric[:wanted], numeric[1 : 1 + wanted]]
    of_map = wanted == 2 and len(numeric) == 3
    if of_map:
        choices.insert(1, [numeric[0], numeric[2]])
    readings = ", or ".join(
        f"columns = {choice} for {' and '.join(shown(names[k]) for k in choice)}"
        for choice in choices
    )
    what = ("the heights", "positions and heights", "x, y and the heights")[wanted - 1]
    row = shown(" | ".join(data.cells[i])).strip("'")
    unclear = f"{len(numeric)} columns of numbers, {row}: it is not clear which columns hold {what}"
    cure = f"set {readings}" if of_map else f"set {readings}, or other columns (the first is 0)"
    if of_map:
        cure = f"if they are x, y and z of a map, set line to the number of a line; else {cure}"
    raise at(data.path, data.rows[i][0], f"{unclear}; {cure}")


def refuse_sideways(path: Source, rows: list[Row], layouts: list[Layout]) -> None:
    """Refuse a transposed table, which has a few rows of many numbers each."""
    for layout in layouts:
        counts = [
            (sum(layout.number(cell) is not None for cell in layout.cells(text)), line)
            for line, text in rows
        ]
        long = [(count, line) for count, line in counts if count > 1]
        least = min(long, default=(0, 0))[0]
        if least >= 2 * MIN_POINTS and 2 * len(long) <= least:
            many = (
                f"{len(long)} rows of {least} numbers"
                if len(long) > 1
                else f"a row of {least} numbers"
            )
            what = f"{many}: the table is transposed, or is a map of heights"
            raise at(
                path,
                long[0][1],
                f"{what}; write one point a line: x and z, or x, y and z for a map",
            )


def refuse_count(data: Data) -> None:
    """Refuse a table if one of its first three rows seems to give the number of points.
    Without this check, the row would be read as a point.

    Such a row begins with a whole number. In a table shorter than `LONG_TABLE`, this is the number
    of rows below the first one. In a longer table, it is the number of rows below the row itself,
    or below a later one of the three. Evenly spaced positions such as 11, 10, 9 are accepted.
    """
    total, mark = len(data.rows), data.layout.decimal
    first = [[row[k] if k < len(row) else "" for k in data.places] for row in data.cells[:5]]
    values = [data.layout.number(cells[0]) for cells in first]
    for i, (value, cells) in enumerate(zip(values[:3], first, strict=False)):
        below = range(i + 1, 4) if total >= LONG_TABLE else (1,)
        if not _WHOLE.fullmatch(cells[0]) or value not in [total - k for k in below]:
            continue
        near = [number for number in values[i : i + 3] if number is not None]
        if len(cells) == 2 and len(near) == 3 and 2 * near[1] == near[0] + near[2]:
            continue
        line, text = data.rows[i]
        what = f"{shown(text.strip())} looks like the number of points below it"
        cure = (
            f"remove the line or put # before it; if it is a point, write {cells[0]}{mark}0 there"
        )
        raise at(data.path, line, f"{what}; {cure}")
