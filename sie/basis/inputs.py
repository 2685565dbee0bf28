"""Checks of a user's input: each returns the value or raises a ValueError that names it."""

import math
from typing import Any

import numpy as np

from sie.basis.data import Array


def number(name: str, value: Any) -> float:
    """The value as a finite real number."""
    if is_number(value) and math.isfinite(as_float(value)):
        return float(value)
    raise ValueError(f"{name} must be a finite number, got {shown(value)}")


def scalar(name: str, value: Any) -> complex:
    """The value as a finite number, real or complex."""
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    if not isinstance(value, complex | np.complexfloating):
        return number(name, value)
    if np.isfinite(value):
        return complex(value)
    raise ValueError(f"{name} must be a finite number, got {shown(value)}")


def scalars(name: str, values: Any) -> Array:
    """The values as finite numbers (k,), all real or all complex."""
    try:
        table = np.asarray(values)
    except (ValueError, TypeError):
        return numbers(name, values)
    if table.dtype.kind != "c":
        return numbers(name, values)
    parts = numbers(name, table.real), numbers(name, table.imag)
    return np.asarray(parts[0] + 1j * parts[1])


def is_number(value: Any) -> bool:
    """Whether a value is one real number; booleans are not."""
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    return isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)


def as_float(value: Any) -> float:
    """The number as a float; a number too large for a float becomes infinite."""
    try:
        return float(value)
    except OverflowError:
        return math.inf


def positive(name: str, value: Any) -> float:
    """The value as a finite number above zero."""
    if is_number(value) and math.isfinite(as_float(value)) and value > 0:
        return float(value)
    raise ValueError(f"{name} must be a finite positive number, got {shown(value)}")


def whole(name: str, value: Any, least: int) -> int:
    """The value as a whole number, `least` or more."""
    if isinstance(value, int | np.integer) and not isinstance(value, bool) and value >= least:
        return int(value)
    raise ValueError(f"{name} must be a whole number of at least {least}, got {shown(value)}")


def numbers(name: str, values: Any) -> Array:
    """The values as finite real numbers (k,), from an array, a sequence or one number."""
    if (
        isinstance(values, np.ndarray)
        and values.dtype == np.float64
        and values.ndim == 1
        and np.isfinite(values).all()
    ):
        return values
    table = table_of(name, values)
    if table.ndim > 1 or not np.isfinite(table).all():
        raise ValueError(f"{name} must be an array (k,) of finite numbers, got {shown(values)}")
    return np.atleast_1d(table)


def table_of(name: str, values: Any) -> Array:
    """The values as an array of real numbers of any shape."""
    try:
        table = np.asarray(values)
    except (ValueError, TypeError):
        raise ValueError(
            f"{name} must be an array of numbers with rows of equal length, got {shown(values)}"
        ) from None
    if table.dtype.kind not in "fiu" and table.size:
        raise ValueError(f"{name} must be real numbers, got {shown(values)}")
    return np.asarray(table, dtype=float)


def function(name: str, value: Any, optional: bool = False) -> None:
    """Raise ValueError unless the value can be called; if optional, None is allowed."""
    if not (callable(value) or (optional and value is None)):
        raise ValueError(f"{name} must be a function, got {shown(value)}")


def several(values: Any) -> tuple[Any, ...]:
    """A tuple of the members of a list or tuple, or of one value; empty for None."""
    if values is None:
        return ()
    return tuple(values) if isinstance(values, list | tuple) else (values,)


def shown(value: Any) -> str:
    """The value as text for a message: its repr if this is short, else the name of its type."""
    text = repr(value).replace("\n", " ")
    return text if len(text) <= 40 and not callable(value) else f"a {type(value).__name__}"
