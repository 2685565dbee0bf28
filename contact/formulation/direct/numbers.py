"""Numbers of one load, and rows of several, by the same words.

Of so few numbers a call takes longer than what it does, and the place of the least is found by a quicker one than the least itself.
"""

from typing import Any

import numpy as np

from sie import Array

# A number, or an array of one for each load.
Value = Any


def column(value: Value) -> Value:
    """For places along a row."""
    return value if isinstance(value, float) else value[:, None]


def least(values: Array) -> Value:
    """Along each row, nan where there is one."""
    return values.item(values.argmin()) if values.ndim == 1 else values.min(axis=-1)


def largest(values: Array) -> Value:
    return values.item(values.argmax()) if values.ndim == 1 else values.max(axis=-1)


def everywhere(mask: Any) -> bool:
    """Whether a condition holds for all loads."""
    return bool(mask.all()) if isinstance(mask, np.ndarray) else bool(mask)


def smallest(value: Value) -> float:
    """Of all loads."""
    return value if isinstance(value, float) else float(value.min())
