"""What the header of a trace says: names of columns, and units by the names that people and instruments write."""

import re
from collections.abc import Iterator, Sequence
from typing import Any

from contact.errors import SceneError
from contact.model.checks import one_of
from contact.model.traces.text import unquoted

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
