"""What the header of a trace says: names of columns, and units."""

import re
from collections.abc import Iterator

from contact.model.traces.text import unquoted
from contact.model.traces.units import ONLY_IN_BRACKETS, known

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
