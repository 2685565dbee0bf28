"""A text file as numbered rows, and a row as cells and numbers: encodings, line ends, delimiters, quotes, decimal marks;
and what its header says: names of columns, and units by the names that people and instruments write.
"""

import csv
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import nan
from pathlib import Path
from typing import Any

from contact.errors import SceneError
from contact.extras import require
from contact.model.checks import one_of

Row = tuple[int, str]

_COMMA_NUMBER = re.compile(r"[+-]?(\d+|\d*,\d+)([eE][+-]?\d+)?")
_COMMA_DECIMALS = re.compile(r"[+-]?\d+,\d+(?:[eE][+-]?\d+)?")


@dataclass(frozen=True)
class Layout:
    """What stands between the columns (None: white space), what marks decimals, and whether quotes keep the two apart."""

    delimiter: str | None
    decimal: str
    quoted: bool = False

    def cells(self, line: str) -> list[str]:
        """The cells of a row, without what is empty behind the last."""
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
        """A cell as a number, nan and inf among them; None if it is none."""
        if self.decimal == ",":
            if not _COMMA_NUMBER.fullmatch(cell):
                return nan if cell.lower() == "nan" else None
            cell = cell.replace(",", ".")
        try:
            return None if "_" in cell else float(cell.replace("\u2212", "-"))
        except ValueError:
            return None

    def numbers(self, cells: list[str], places: Sequence[int]) -> list[float] | None:
        """The numbers in some places of a row; None if one of them has none."""
        if len(cells) <= max(places):
            return None
        found = [self.number(cells[place]) for place in places]
        return None if None in found else [value for value in found if value is not None]


def rows_of(path: str | Path) -> list[Row]:
    """Numbered lines that are not empty; any line ending, also the doubled CR that some instruments write."""
    text = _text(path, _bytes(path))
    return [(i, line) for i, line in enumerate(re.split("\r*\n|\r", text), 1) if line.strip()]


def _bytes(path: str | Path) -> bytes:
    try:
        raw = Path(path).read_bytes()
        if raw.startswith(b"\x1f\x8b"):
            raw = require("gzip").decompress(raw)
    except (OSError, EOFError, TypeError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise SceneError.of("file", str(path), f"a file that can be read ({reason})") from None
    except Exception as error:  # zlib has an error of its own
        raise SceneError.of("file", str(path), f"a file that can be read (not a whole gzip file: {error})") from None
    return raw


def _text(path: str | Path, raw: bytes) -> str:
    try:
        if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
            return raw.decode("utf-16")
        if raw.startswith(b"PK\x03\x04"):
            raise SceneError.of("file", str(path), "a text file, not a spreadsheet or an archive: save its table as CSV")
        if b"\0" in raw:
            allowed = "a text file with a table of numbers, or an instrument's with its own ending (this one is binary)"
            raise SceneError.of("file", str(path), allowed)
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
    """Whether all commas of a row can be told apart: every number has its decimals."""
    return re.fullmatch(rf"\s*{_COMMA_DECIMALS.pattern}(\s*,\s*{_COMMA_DECIMALS.pattern})*[\s,]*", line) is not None


def at(path: str | Path, line: int, what: str) -> SceneError:
    """The error of one line of a file; 0 where it has no lines."""
    place = f", line {int(line)}" if line else ""
    return SceneError(f"file {str(path)!r}{place}: {what}", "file", str(path))


UNITS = {
    "m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "μm": 1e-6, "micron": 1e-6, "micrometer": 1e-6,
    "micrometre": 1e-6, "nm": 1e-9, "A": 1e-10, "Å": 1e-10, "pm": 1e-12, "in": 0.0254,
}  # fmt: skip
_LONG_NAMES = {
    "meter": "m", "metre": "m", "centimeter": "cm", "centimetre": "cm", "millimeter": "mm", "millimetre": "mm",
    "nanometer": "nm", "nanometre": "nm", "angstrom": "A", "picometer": "pm", "picometre": "pm", "inch": "in", "inches": "in",
}  # fmt: skip
# Alone behind a name these may as well be a part of it, as in "Height A".
ONLY_IN_BRACKETS = ("m", "A", "Å", "in")


def scales(units: Any) -> tuple[float, float]:
    """What positions and heights are multiplied by to be in metres: one unit for both, or two."""
    both = (units, units) if isinstance(units, str) else units
    if not isinstance(both, Sequence) or len(both) != 2:
        raise SceneError.of("units", units, "one unit or two, for positions and heights")
    return UNITS[one_of("units", both[0], UNITS)], UNITS[one_of("units", both[1], UNITS)]


def known(word: str) -> str | None:
    """The name in `UNITS` of a unit as headers write it, in any case and number; None if it is none."""
    word = word.strip()
    if word in UNITS:
        return word
    lower = word.lower()
    for name in (lower, lower.removesuffix("s")):
        if name in _LONG_NAMES:
            return _LONG_NAMES[name]
        if name in UNITS and name not in ONLY_IN_BRACKETS:
            return name
    return None


def written(names: Sequence[str]) -> str:
    """Units as a scene file and Python have them."""
    if len(set(names)) == 1:
        return f'"{names[0]}"'
    return "[" + ", ".join(f'"{name}"' for name in names) + "]"


_BRACKETED = re.compile(r"[\[(<{]\s*([^\[\](){}<>]+?)\s*[\])>}]\s*$|/\s*(\S+)$")
_LAST_WORD = re.compile(r"^.*[\s_](\S+?)$")


def unit_of(field: str) -> str | None:
    """The unit that a field of a header ends in, as "x [um]", "z (nm)", "Weg/mm", "Lateral um", "height_nm"; None without one."""
    found = _BRACKETED.search(field)
    if found is not None:
        return known(found[1] or found[2])
    found = _LAST_WORD.match(field)
    name = None if found is None else known(found[1])
    return None if name in ONLY_IN_BRACKETS else name


def bare_name(field: str) -> str:
    """A field of a header without its unit."""
    return _BRACKETED.sub("", field).strip() if unit_of(field) is not None else field


def header_fields(line: str, delimiter: str | None) -> Iterator[list[str]]:
    """The fields of a header, split as the data are, and as it may be split itself; units in brackets stay with their names."""
    line = line.strip().lstrip("#%!").strip()
    joined = re.sub(r"(?<=[^\s\])>}])\s+(?=[\[(<{][^\])>}]*[\])>}])", "\0", line)
    for between in dict.fromkeys((delimiter, ",", ";", "\t", None)):
        parts = unquoted(line, between) if '"' in line else [part.replace("\0", " ") for part in joined.split(between)]
        fields = [part.strip().strip('"').strip() for part in parts]
        while fields and not fields[-1]:
            fields.pop()
        yield fields
