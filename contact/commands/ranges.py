"""Many values in few words: A:B:N, A:B:N:log, or values with commas between them."""

from math import isfinite

import numpy as np

from contact.errors import SceneError
from sie import Array

_MOST = 100_000


def values_of(option: str, text: str) -> Array:
    """N even values from A to B, evenly spaced in their logarithm with `:log`; both ends are among them."""
    try:
        values = _between(text.split(":")) if ":" in text else np.array([float(part) for part in text.split(",")])
    except ValueError:
        values = np.zeros(0)
    if not values.size or not np.isfinite(values).all():
        many = f"N a whole number from 2 to {_MOST}"
        allowed = f"A:B:N or A:B:N:log, such as 1e3:1e6:20:log ({many}; with log A and B above 0), or numbers with commas between"
        raise SceneError.of(option, text, allowed)
    return values


def _between(parts: list[str]) -> Array:
    """Of the parts between colons; none where they make no sense."""
    logarithmic = len(parts) == 4 and parts[3] == "log"
    first, last, count = float(parts[0]), float(parts[1]), int(parts[2]) if len(parts) > 2 else 0
    if (len(parts) != 3 and not logarithmic) or not 2 <= count <= _MOST or first == last or not isfinite(last - first):
        return np.zeros(0)
    if logarithmic and (first <= 0 or last <= 0):
        return np.zeros(0)
    # 0.3, and not 0.30000000000000004: values that are read again, and written by hand, are the same.
    return np.array([float(f"{value:.15g}") for value in (np.geomspace if logarithmic else np.linspace)(first, last, count)])
