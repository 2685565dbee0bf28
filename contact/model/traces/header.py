"""Names and units of the columns of a trace, as people and instruments write them in headers."""

import re
import unicodedata
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import isnan, nan
from typing import Any

from contact.errors import SceneError, shown
from contact.model.traces.text import unquoted

# Table of units. Each row has the unit's length in metres (NaN for units of other quantities) and
# the names of the unit, of which messages use the first. Case, accents, a plural s and a final dot
# do not matter.
_TABLE = (
    (1e3, "km kilometer kilometre км километр 千米 公里"),
    (1.0, "m meter metre м метр 米 メートル"),
    (1e-1, "dm decimeter decimetre дм дециметр 分米"),
    (1e-2, "cm centimeter centimetre zentimeter см сантиметр 厘米 公分 センチ センチメートル"),
    (1e-3, "mm millimeter millimetre мм миллиметр 毫米 公厘 ミリ ミリメートル 밀리미터"),
    (
        1e-6,
        "um μm μ micron micra mikron micrometer micrometre mikrometer mcm mkm мкм микрон микрометр "
        "微米 ミクロン マイクロメートル 마이크로미터 âμm",  # the last: UTF-8 read as Latin-1
    ),
    (1e-9, "nm nanometer nanometre нм нанометр 纳米 奈米 納米 ナノメートル 나노미터"),
    (1e-10, "A Å angstrom ангстрем 埃"),
    (1e-12, "pm picometer picometre пм пикометр 皮米"),
    (0.3048, "ft foot feet"),
    (0.0254, "in inch inches zoll pouce pulgada pollice дюйм 英寸 インチ \" ″ ''"),
    (2.54e-5, "mil thou"),
    (2.54e-8, "uin μin microin microinch microinches"),
    (nan, "px pix pixel V mV volt rad mrad urad μrad radian deg degree ° s ms sec second count"),
)
# Usual names of columns. They distinguish a row of names from a row of units below it.
_NAMES = frozenset(
    "x y z r h pos position dist distance height heights profile lateral length depth path "
    "weg hohe tiefe abscisse hauteur altura высота длина координата 高度 位置 高さ".split()
)
# Words that may follow a name in a header and are not units.
_NO_UNITS = frozenset(
    "raw data axis value values coord coordinate profile signal filtered corrected levelled "
    "leveled smoothed mean average abs rel left right top measured axe achse wert werte".split()
)
# Parts of column names that mean heights measured into the body, such as depth.
_DEPTHS = (
    "depth", "tiefe", "profondeur", "profundi", "profondit", "diepte", "djup", "глубин", "深",
)  # fmt: skip
# Units that have another meaning in remarks, such as pm in 3:45 pm.
_NOT_IN_REMARKS = ("pm", "dm", "km", "in")


def folded(word: str) -> str:
    """A word without accents and without a final dot, with variants of a letter (µ, ㎛) replaced
    by one form.
    """
    letters = unicodedata.normalize("NFKD", word.strip())
    return "".join(c for c in letters if not unicodedata.combining(c)).removesuffix(".")


_SCALES = {folded(name): scale for scale, names in _TABLE for name in names.split()}
# The first name of each unit of length.
_LENGTHS = tuple(next(iter(names.split())) for scale, names in _TABLE if not isnan(scale))


def scale_of(word: str) -> float | None:
    """The length of a unit [m]; NaN for a unit that is no length, None for a word that is no
    known unit.
    """
    exact = folded(word)
    lower = exact.lower()
    # Upper and lower case of a single letter differ in meaning: A (angstrom) is not a, m is not M.
    tried = (exact,) if len(exact) < 2 else (exact, lower, lower.removesuffix("s"))
    return next((_SCALES[name] for name in tried if name in _SCALES), None)


def length_of(word: Any) -> float:
    """The length of a unit [m] that a user has written."""
    scale = scale_of(word) if isinstance(word, str) else None
    if scale is None or isnan(scale):
        raise SceneError.unknown("units", word, _LENGTHS)
    return scale


def scales(units: Any) -> tuple[float, float]:
    """The lengths [m] of the units of positions and heights. One given unit counts for both."""
    both = (units, units) if isinstance(units, str) else units
    if not isinstance(both, Sequence) or len(both) != 2:
        raise SceneError.of(
            "units", units, "one unit, or a list of two: of the positions and of the heights"
        )
    return length_of(both[0]), length_of(both[1])


def written(names: Sequence[str]) -> str:
    """Units in the form in which a scene file and Python code give them."""
    if len(set(names)) == 1:
        return f'"{names[0]}"'
    return "[" + ", ".join(f'"{name}"' for name in names) + "]"


@dataclass(frozen=True)
class Unit:
    """A word where a unit is expected, and the unit's length as returned by `scale_of`."""

    word: str
    scale: float | None

    @property
    def why_not(self) -> str:
        """Reason why the word is not a unit of length; empty if it is one."""
        if self.scale is None:
            return (
                f"{shown(self.word)}, which is not one of the known units ({', '.join(_LENGTHS)})"
            )
        return f"{shown(self.word)}, which is not a unit of length" if isnan(self.scale) else ""


_WIDE = str.maketrans("（）［］｛｝〔〕【】／：，", "()[]{}()[]/:,")
# Patterns for a word in brackets: anywhere in a field, at its start, at its end, and as the whole
# field.
_BRACKETS = re.compile(r"[\[(<{]\s*([^\[\](){}<>]+?)\s*[\])>}]")
_BRACKETS_FIRST = re.compile(rf"^\s*{_BRACKETS.pattern}")
_BRACKETS_LAST = re.compile(rf"{_BRACKETS.pattern}\s*$")
_BRACKETS_ALONE = re.compile(rf"^{_BRACKETS.pattern}$")
# Pattern for blanks between a name and the brackets after it, and pattern for blanks between
# brackets and the name after them.
_NAME_BRACKET = re.compile(r"(?<=[^\s\])>}])\s+(?=[\[(<{][^\])>}]*[\])>}])")
_BRACKET_NAME = re.compile(r"(?<=[\])>}])\s+(?=[^\s\[(<{])")
_TO_BRACKET = re.compile(r"[^\[(<{\])>}]+[\[(<{][^\])>}]*[\])>}]")  # words up to brackets
_NAME_MARK = re.compile(r"\s*([/:,])\s+(\S)|\s(in|en|в)\s+(\S)")  # between a name and a word
_MARKED = re.compile(r"(?:[/,:=]|\s(?:in|en|в)\s)\s*(\S+)$")  # the word behind a mark
_LAST_WORD = re.compile(r"(?:^.*[\s_.-]|^[xyzXYZ])(\S+?)$")
_NAME_WORD = re.compile(r"^([^\W_]+)([\s_.-]+)([^\W\d_]{2,})$")  # a name and one more word
_VALUE = re.compile(r"([.,]\d+|[=:]\s*\d+)[\s_]*\D+$")  # "pitch 0.5 um" is no name
_WORDS = re.compile(r"[^\W\d_]+")
_NUMBER_FIRST = re.compile(r"[+-]?[\d.,]*\d")


def unit_of(field: str, short: bool = False) -> Unit | None:
    """The unit in a field of a header; None if there is none.

    A unit stands in brackets or after a slash, a comma, a colon or "in": "x [um]", "Weg/mm", "X,
    мм". In other fields the last word may be a unit: "Lateral um", "height_nm", "Zmm". short:
    whether this word may be a single letter. Such a letter is mostly part of the name: "Height A".
    """
    field = field.translate(_WIDE)
    for found in _BRACKETS.finditer(field):
        if scale_of(found[1]) is not None:
            return Unit(found[1], scale_of(found[1]))
    bracketed = _BRACKETS_LAST.search(field) or _BRACKETS_FIRST.search(field)
    marked = bracketed or _MARKED.search(field)
    if marked is not None:
        unit = Unit(marked[1], scale_of(marked[1]))
        no_unit = unit.scale is None and folded(unit.word).lower() in _NAMES
        number = bracketed is None and _NUMBER_FIRST.match(unit.word)
        return None if no_unit or number else unit
    last = None if _VALUE.search(field) else _LAST_WORD.match(field)
    scale = None if last is None else scale_of(last[1])
    if last is None or scale is None or not (short or len(last[1]) > 1 or last[1] in "ÅÅ"):
        return None
    return Unit(last[1], scale)


def units_of(cells: Sequence[str]) -> tuple[Unit | None, ...]:
    """The units in the fields of a header.

    A single letter after a name is a unit if all fields have one, or if one is no length (V). A
    word after every name is a unit, though perhaps an unknown one.
    """
    units = tuple(unit_of(cell) for cell in cells)
    ends = {last[1] if (last := _LAST_WORD.match(cell)) else "" for cell in cells}
    word = ends.pop()
    if len(cells) > 1 and not (
        any(units) or ends or is_name(word) or re.search(r"\d|^$", word) or word in _NO_UNITS
    ):
        return (Unit(word, scale_of(word)),) * len(cells)
    if not any(units) and all(unknown := [_word_behind_name(cell) for cell in cells]):
        return tuple(Unit(word, scale_of(word)) for word in unknown)
    letters = tuple(unit_of(cell, short=True) for cell in cells)
    no_length = any(unit is not None and unit.why_not for unit in letters) and not any(units)
    if no_length or all(unit is not None and len(unit.word) == 1 for unit in letters):
        return letters
    return units


def _word_behind_name(field: str) -> str:
    """The unit after a usual name, as "furlong" in "Height_furlong"; "" if it cannot be a unit."""
    found = _NAME_WORD.match(field.strip())
    if found is None or not is_name(found[1]) or is_name(found[3]):
        return ""
    return "" if found[3].lower() in _NO_UNITS else found[3]


def units_row(cells: Sequence[str], above: Sequence[str]) -> tuple[Unit | None, ...] | None:
    """The units in a row that contains units only; None for other rows. `above` is the row
    before this row.
    """
    words = [_BRACKETS.sub(r"\1", cell).strip(' "') for cell in cells]
    units = tuple(Unit(word, scale_of(word)) if word else None for word in words)
    named = any(is_name(cell) for cell in above) and not any(is_name(word) for word in words)
    # Two columns do not have the same name. A word that stands in all columns is therefore a unit.
    unit_twice = len(words) > 1 and len(set(words)) == 1 and not is_name(words[0])
    known = all(unit is not None and unit.scale is not None for unit in units)
    return units if any(units) and (known or unit_twice or named) else None


def is_name(field: str) -> bool:
    """Whether a field is a usual name of a column, such as x or height."""
    return any(word in _NAMES for word in re.split(r"[\s_]+", folded(bare_name(field)).lower()))


def is_depth(field: str) -> bool:
    """Whether a field names heights that grow into the body, such as depth."""
    lower = folded(field).lower()
    return any(word in lower for word in _DEPTHS)


def mentioned(line: str) -> str | None:
    """The first unit of length in a line, apart from the metre; None if the line has none."""
    for word in _WORDS.findall(unicodedata.normalize("NFKC", line)):
        scale = scale_of(word)
        if scale in (None, 1.0) or isnan(scale) or len(word) < 2 or word.lower() in _NOT_IN_REMARKS:
            continue
        # Short words that begin with a capital letter are not units of length: Nm, MM.
        if len(word) > 3 or not word[0].isupper():
            return str(word)
    return None


def unit_words(line: str) -> list[str]:
    """The units in a line, found wherever a unit may follow a name, without regard to columns."""
    words = _NAME_MARK.sub(_with_mark, line).split()
    found = [unit_of(word) for word in words]
    return [unit.word for unit in found if unit is not None]


def bare_name(field: str) -> str:
    """The text of a header field, with the unit removed."""
    if unit_of(field) is None:
        return field
    return _MARKED.sub("", _BRACKETS.sub("", field)).strip() or field


def header_fields(line: str, delimiter: str | None) -> Iterator[list[str]]:
    """Yield the fields of a header line, split by one possible delimiter after another.
    The given `delimiter` is tried first.

    Units stay with their names: in brackets, after a slash, a comma, a colon or "in".
    """
    line = line.strip().lstrip("#%!*/").strip()
    before = line[:1] in tuple("[(<{")
    joined = (_BRACKET_NAME if before else _NAME_BRACKET).sub("\0", line)
    for between in dict.fromkeys((delimiter, ",", ";", "\t", None, "  ")):
        parts = joined.split(between)
        if '"' in line and between != "  ":
            parts = unquoted(line, between)
        elif between is None:
            parts = _NAME_MARK.sub(_with_mark, joined).split()
        elif between == "  ":
            parts = re.split(r"\s{2,}", line)
        parts = [part.replace("\0", " ") for part in parts]
        fields = [part.strip().strip('"').strip() for part in parts]
        while fields and not fields[-1]:
            fields.pop()
        yield fields
    if not before:
        yield [part.strip() for part in _TO_BRACKET.findall(line)]


def _with_mark(found: re.Match[str]) -> str:
    return f"{found[1]}{found[2]}" if found[1] else f"/{found[4]}"


def in_pairs(fields: Sequence[str]) -> list[str]:
    """Names joined with the units that follow them as separate fields: "Lateral um Raw nm".

    The list is empty unless all units are known or equal, or all names are usual ones.
    """
    names, words = fields[::2], [_BRACKETS_ALONE.sub(r"\1", word) for word in fields[1::2]]
    if any(re.search(r"[\[(<{\])>}]", part) for part in (*names, *words)):
        return []
    known = all(scale_of(word) is not None for word in words)
    if len(names) == len(words) and (known or len(set(words)) == 1 or all(map(is_name, names))):
        return [f"{name} [{word}]" for name, word in zip(names, words, strict=True)]
    return []
