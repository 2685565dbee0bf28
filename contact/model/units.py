"""Numbers for reading, with SI prefixes that bring values between 1 and 1000."""

import math
from collections.abc import Sequence

_PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}

_INFINITE = {True: "infinite", False: "-infinite"}


def prefix(magnitude: float) -> tuple[float, str]:
    """Factor and SI prefix that bring a magnitude to between 1 and 1000.

    They are 1 and none for zero and for numbers that are not finite.
    """
    if not (math.isfinite(magnitude) and magnitude > 0.0):
        return 1.0, ""
    # log10(1e-6) may be rounded to slightly below or above -6. The small shift avoids this error.
    power = 3 * math.floor(math.log10(magnitude) / 3.0 + 1e-12)
    power = min(max(power, min(_PREFIXES)), max(_PREFIXES))
    return 10.0**-power, _PREFIXES[power]


def quantity(value: float | None, unit: str, digits: int = 4, none: str = "not defined") -> str:
    """A value with its prefixed unit, as text; the text `none` if the value is None."""
    if value is None:
        return none
    if not math.isfinite(value):
        return "infinite" if value > 0 else str(value)
    factor, letter = prefix(abs(value))
    return f"{value * factor:.{digits}g} {letter}{unit}"


def headed(
    name: str, values: Sequence[float | None], unit: str, digits: int = 6
) -> tuple[str, list[str]]:
    """Header and cells of a table column; the header has the prefixed unit below the name."""
    if unit in ("", "1"):
        return name, ["-" if value is None else f"{value:.{digits}g}" for value in values]
    prefixed, cells = column(values, unit, digits)
    return f"{name}\n[{prefixed}]", cells


def column(values: Sequence[float | None], unit: str, digits: int = 6) -> tuple[str, list[str]]:
    """The prefixed unit of a table column, and its values as numbers without unit; '-' for None."""
    finite = [abs(value) for value in values if value is not None and math.isfinite(value)]
    factor, letter = prefix(max(finite, default=0.0))
    return f"{letter}{unit}", [
        "-" if v is None else f"{v * factor:.{digits}g}" if math.isfinite(v) else _INFINITE[v > 0]
        for v in values
    ]
