"""Numbers for reading: units that people use, with values between 1 and 1000, and text tables.

Tables, messages, plans and figures show results in such units. A message that refuses an input has
SI units instead, as inputs are given in SI units.
"""

import math
from collections.abc import Iterable, Sequence

# Multiples in which numbers are shown, for each unit of the package, by their power of ten.
_MULTIPLES = {
    "Pa": {0: "Pa", 3: "kPa", 6: "MPa", 9: "GPa"},
    "N/m": {-6: "µN/m", -3: "mN/m", 0: "N/m", 3: "N/mm", 6: "kN/mm"},
    "N/m^2": {0: "N/m²", 3: "kN/m²", 6: "N/mm²", 9: "kN/mm²"},
    "J/m^2": {-6: "µJ/m²", -3: "mJ/m²", 0: "J/m²", 3: "kJ/m²"},
    "rad": {-6: "µrad", -3: "mrad", 0: "rad"},
    "s": {-9: "ns", -6: "µs", -3: "ms", 0: "s"},
}
_PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M"}

_INFINITE = {True: "infinite", False: "-infinite"}


def scaled(magnitude: float, unit: str) -> tuple[float, str]:
    """Factor and multiple of a unit that bring a magnitude to between 1 and 1000.

    They are 1 and the unit itself for zero, for numbers that are not finite, and for numbers
    below a thousandth of the smallest multiple. Only multiples that people use are chosen. So a
    value in the largest of them may exceed 1000.

    A number without a unit, "1", is not scaled, and the name of its unit is empty.

    Examples
    --------
    >>> scaled(2.1e11, "Pa"), scaled(4.0e5, "N/m"), scaled(3e-7, "m")
    ((1e-09, 'GPa'), (0.001, 'N/mm'), (1000000000.0, 'nm'))
    """
    unit = "" if unit == "1" else unit
    known = _MULTIPLES.get(unit) or {power: letter + unit for power, letter in _PREFIXES.items()}
    if not (unit and math.isfinite(magnitude) and magnitude > 0.0):
        return 1.0, unit and known[0]
    # log10(1e-6) may be rounded to slightly below or above -6. The small shift avoids this error.
    power = 3 * math.floor(math.log10(magnitude) / 3.0 + 1e-12)
    least, most = min(known), max(known)
    power = min(max(power, least), most) if power >= least - 3 else 0
    return 10.0**-power, known[power]


def quantity(value: float | None, unit: str, digits: int = 4, none: str = "not defined") -> str:
    """A value with its unit, as text; the text `none` if the value is None."""
    if value is None:
        return none
    if not math.isfinite(value):
        return "infinite" if value > 0 else str(value)
    factor, name = scaled(abs(value), unit)
    return f"{rounded(value * factor, digits)} {name}".rstrip()


def rounded(value: float, digits: int) -> str:
    """A number as text with the given count of digits; no exponent between 1e-4 and 1e6.

    Examples
    --------
    >>> rounded(267.4, 2), rounded(0.02674, 2), rounded(2.674e8, 2)
    ('270', '0.027', '2.7e+08')
    """
    text = f"{value:.{digits}g}"
    return f"{float(text):.0f}" if "e+" in text and abs(value) < 1e6 else text


def counted(count: int, one: str, many: str | None = None) -> str:
    """A count with its noun: `one` for the count 1, otherwise `many`.
    If `many` is None, the plural is `one` with an s.

    Examples
    --------
    >>> counted(1, "zone"), counted(0, "zone"), counted(2, "jump of f'", "jumps of f'")
    ('1 zone', '0 zones', "2 jumps of f'")
    """
    return f"{count} {one if count == 1 else many or one + 's'}"


def headed(
    name: str,
    values: Sequence[float | None],
    unit: str,
    digits: int = 6,
    alike: Sequence[float | None] = (),
) -> tuple[str, list[str]]:
    """Header and cells of a table column; the header has the unit below the name.

    alike: values of other columns that must get the same unit.
    """
    if unit in ("", "1"):
        return name, [
            "-" if value is None or math.isnan(value) else f"{value:.{digits}g}" for value in values
        ]
    found, cells = column(values, unit, digits, alike)
    return f"{name}\n[{found}]", cells


def column(
    values: Sequence[float | None], unit: str, digits: int = 6, alike: Sequence[float | None] = ()
) -> tuple[str, list[str]]:
    """The unit of a table column, and its values as numbers without unit; '-' for None and nan.

    alike: values of other columns that must get the same unit.
    """
    sizes = [abs(v) for v in (*values, *alike) if v is not None and math.isfinite(v)]
    factor, name = scaled(max(sizes, default=0.0), unit)
    return name, [
        "-"
        if v is None or math.isnan(v)
        else rounded(v * factor, digits)
        if math.isfinite(v)
        else _INFINITE[v > 0]
        for v in values
    ]


def with_error(value: float, error: float | None, unit: str, most: int = 10) -> tuple[str, str]:
    """A value and the bound of its error as text, both in the unit that suits the value.

    The value has the digits that its error allows, up to `most`. None stands for an unknown error,
    and 0 for an exact value.

    Examples
    --------
    >>> with_error(123456789.123, 2e-1, "Pa"), with_error(0.25, 0.0, "")
    (('123.4567891 MPa', '2e-07 MPa'), ('0.25', 'exact'))
    """
    factor, name = scaled(abs(value), unit)
    if not math.isfinite(value):
        return _INFINITE[value > 0], "-"
    digits = most
    if error and value:
        digits = min(max(math.ceil(math.log10(abs(value) / error)) + 1, 2), most)
    bound = (
        "-"
        if error is None
        else f"{rounded(error * factor, 2)} {name}".strip()
        if error
        else "exact"
    )
    return f"{rounded(value * factor, digits)} {name}".strip(), bound


def text_table(
    columns: Iterable[tuple[str, Sequence[str]]], words: Iterable[int] = (0,), blanks: int = 2
) -> str:
    """A table as text, from columns (header, cells).

    Headers may have several lines. The columns with the indices `words` are aligned to the left,
    all others to the right. blanks: number of blanks between two columns.

    Examples
    --------
    >>> print(text_table([("quantity", ["load", "approach"]), ("value", ["2 N/m", "13.5 µm"])]))
    quantity    value
    load        2 N/m
    approach  13.5 µm
    """
    columns, left = list(columns), set(words)
    rows = max(name.count("\n") for name, _ in columns) + 1
    filled = []
    for place, (name, cells) in enumerate(columns):
        lines = [*name.split("\n"), *[""] * (rows - 1 - name.count("\n")), *cells]
        width = max(map(len, lines))
        filled.append([s.ljust(width) if place in left else s.rjust(width) for s in lines])
    return "\n".join((" " * blanks).join(line).rstrip() for line in zip(*filled, strict=True))
