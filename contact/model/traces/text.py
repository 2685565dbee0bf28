"""Text files as numbered rows of cells: encodings, line endings, delimiters, quotes, numbers."""

import csv
import re
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from math import nan
from pathlib import Path

from contact.errors import SceneError, shown
from contact.extras import require

Row = tuple[int, str]


@dataclass(frozen=True)
class Given:
    """A file object, or arrays of positions and heights, that a user gives in place of a path.

    words: name of this object in messages; name: its short name in the history of the trace;
    content: the bytes of a file object, None for arrays; ending: the ending of the file's name, ""
    if unknown.
    """

    words: str
    name: str
    content: bytes | None = None
    ending: str = ""

    def __str__(self) -> str:
        return self.name

    def place(self, line: int) -> str:
        """The place of a row in a message: lines count from 1, elements of arrays from 0."""
        return f", line {line}" if self.content is not None else f", element {line - 1}"


# Source of a measured trace: the path of a file, or an object given in place of a path.
Source = str | Path | Given


def short_name(path: Source) -> str:
    """The name of a file without its folders, or of the object that is given in its place."""
    return path.name if isinstance(path, Given) else Path(path).name


_COMMA_NUMBER = re.compile(r"[+-]?(\d+|\d*,\d+)([eE][+-]?\d+)?")
_FORTRAN = re.compile(r"^([+-]?[\d.]+)[dD]([+-]?\d+)$")
_COMMA_DECIMALS = re.compile(r"[+-]?\d+,\d+(?:[eE][+-]?\d+)?")


@dataclass(frozen=True)
class Layout:
    """Layout of a text table: its delimiter, its decimal mark, and whether numbers are quoted.
    The delimiter None stands for white space.
    """

    delimiter: str | None
    decimal: str
    quoted: bool = False

    def cells(self, line: str) -> list[str]:
        """The cells of a row, without empty cells at the end of the row."""
        if '"' in line:
            parts = unquoted(line, self.delimiter)
        elif self.delimiter == self.decimal and not self.quoted:
            parts = _COMMA_DECIMALS.findall(line) if _is_decimals(line) else []
        else:
            parts = line.split(self.delimiter)
        parts = [part.strip() for part in parts]
        while parts and not parts[-1]:
            parts.pop()
        return parts

    def number(self, cell: str) -> float | None:
        """The number in a cell (which may be NaN or infinite); None if the cell is no number."""
        if self.decimal == ",":
            if not _COMMA_NUMBER.fullmatch(cell):
                return nan if cell.lower() == "nan" else None
            cell = cell.replace(",", ".")
        try:
            return None if "_" in cell else float(cell)
        except ValueError:
            return _written_elsewhere(cell)

    def numbers(self, cells: list[str], places: Sequence[int]) -> list[float] | None:
        """The numbers in the given columns of a row; None if one of the cells is not a number."""
        if len(cells) <= max(places):
            return None
        found = [self.number(cells[place]) for place in places]
        return None if None in found else [value for value in found if value is not None]


def _written_elsewhere(number: str) -> float | None:
    """A number with a typographic minus sign or a Fortran exponent; None for other text."""
    try:
        return float(_FORTRAN.sub(r"\1e\2", number.replace("\u2212", "-")))
    except ValueError:
        return None


def rows_of(path: Source) -> list[Row]:
    """The non-empty lines of a file with their line numbers, for any kind of line ending."""
    text = _text(path, _bytes(path))
    return [(i, line) for i, line in enumerate(re.split("\r*\n|\r", text), 1) if line.strip()]


def _bytes(path: Source) -> bytes:
    try:
        raw = path.content or b"" if isinstance(path, Given) else Path(path).read_bytes()
        if raw.startswith(b"\x1f\x8b"):
            raw = require("gzip").decompress(raw)
    except zlib.error as error:
        raise SceneError.of(
            "file", str(path), f"a file that can be read (the gzip file is damaged: {error})"
        ) from None
    except (OSError, EOFError, TypeError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise SceneError.of("file", str(path), f"a file that can be read ({reason})") from None
    return raw


def _text(path: Source, raw: bytes) -> str:
    try:
        if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
            return raw.decode("utf-16")
        if raw.startswith(b"PK\x03\x04"):
            raise SceneError.of(
                "file",
                str(path),
                "a text file, not a spreadsheet or an archive; save the table as CSV",
            )
        if b"\0" in raw:
            allowed = "a text table of numbers, or an instrument's file with its usual ending"
            raise SceneError.of("file", str(path), f"{allowed} (this file is binary)")
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("latin-1")


def unquoted(line: str, delimiter: str | None) -> list[str]:
    if delimiter is not None:
        try:
            return next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])
        except csv.Error:
            pass
    return [part.strip('"') for part in line.split(delimiter)]


def _is_decimals(line: str) -> bool:
    """Whether every number of a row has decimals, so that decimal commas and separating commas
    can be told apart.
    """
    return (
        re.fullmatch(
            rf"\s*{_COMMA_DECIMALS.pattern}(\s*,\s*{_COMMA_DECIMALS.pattern})*[\s,]*", line
        )
        is not None
    )


def at(path: Source, line: int, what: str) -> SceneError:
    """The SceneError for a line of a file; line 0 names the file only."""
    if isinstance(path, Given):
        place = path.place(int(line)) if line else ""
        return SceneError(f"{path.words}{place}: {what}", "file", path.name)
    place = f", line {int(line)}" if line else ""
    return SceneError(f"file {shown(str(path))}{place}: {what}", "file", str(path))
