"""Checks of single values: each returns the value in its plain type or raises SceneError."""

import inspect
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import cache
from math import isfinite, nan
from numbers import Integral, Real
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from contact.errors import SceneError, UnknownArgument
from sie import Array


def checked_number(field: str, value: Any, allowed: str, holds: Callable[[float], bool]) -> float:
    """Return `value` as a float if it is a finite real number and `holds` is true for it.

    holds: a function that tests the value; allowed: the tested property in words, for messages.
    """
    try:
        number = (
            nan
            if isinstance(value, (bool, np.bool_)) or not isinstance(value, Real)
            else float(value)
        )
    except OverflowError:
        number = nan
    if hasattr(value, "magnitude"):
        allowed += ", as a plain value in SI units without a unit object"
    if not (isfinite(number) and holds(number)):
        raise SceneError.of(field, value, allowed)
    return number


def finite(field: str, value: Any, allowed: str = "a finite real number") -> float:
    """Return a finite real number as a float."""
    return checked_number(field, value, allowed, isfinite)


def as_array(value: Any) -> NDArray[Any]:
    """Return the value as an array, or `np.asarray(None)` if numpy makes no plain array of it.
    A ragged list gives no plain array. Nor does a quantity, whose unit numpy would lose.
    """
    if hasattr(value, "magnitude"):
        return np.asarray(None)
    try:
        return np.asarray(value)
    except (TypeError, ValueError):
        return np.asarray(None)


def metres(field: str, value: Any) -> Any:
    """Return the value in metres if it is a quantity with a unit (e.g. of the package pint).
    Other values are returned unchanged.
    """
    if not (hasattr(value, "magnitude") and hasattr(value, "to")):
        return value
    try:
        return value.to("m").magnitude
    except Exception as error:
        raise SceneError.of(field, value, f"a length ({error})") from error


class _ArgumentCheck:
    """Refuses an unknown argument of a class, and names the most similar argument."""

    def __new__(cls, *args: Any, **kwargs: Any) -> Self:
        known = _arguments(cls.__init__)
        for name in kwargs:
            if known is not None and name not in known:
                raise UnknownArgument.unknown(f"argument of {cls.__name__}", name, known)
        return super().__new__(cls)


class NamesArguments(_ArgumentCheck):
    """Base of classes that refuse an unknown argument and name the most similar argument."""

    def __init__(self) -> None:
        """Take no arguments. This is also the signature that `help` shows for such classes."""


@cache
def _arguments(init: Callable[..., None]) -> tuple[str, ...] | None:
    """Names of the arguments of a class with the method `init`; None if it takes any argument."""
    _, *accepted = inspect.signature(init).parameters.values()
    if any(p.kind in (p.VAR_KEYWORD, p.VAR_POSITIONAL) for p in accepted):
        return None
    return tuple(p.name for p in accepted)


@contextmanager
def of_author(what: str, field: str, given: str = "", hint: str = "") -> Iterator[None]:
    """In the `with` block, turn any exception of a user's code into a SceneError."""
    try:
        with np.errstate(all="ignore"):
            yield
    except Exception as error:
        if isinstance(error, SceneError) and not isinstance(error, UnknownArgument):
            raise
        kind = TypeError if isinstance(error, UnknownArgument) else type(error)
        raise SceneError(f"{what} raises {kind.__name__}{given}: {error}{hint}", field) from error


def both_or_neither(E2: float | None, nu2: float | None) -> None:
    """Raise SceneError if E2 and nu2, the constants of the counter-body, are not given together."""
    for name, value, other, given in (("E2", E2, "nu2", nu2), ("nu2", nu2, "E2", E2)):
        if value is None and given is not None:
            raise SceneError.of(
                name, value, f"given together with {other}; leave out both for a rigid counter-body"
            )


def positive(field: str, value: Any) -> float:
    """Return a finite number > 0."""
    return checked_number(field, value, "a finite number > 0", lambda number: number > 0)


def keep(part: Any, check: Callable[[str, Any], Any], *names: str) -> None:
    """Check the fields `names` of a frozen object and store their values in plain types."""
    for name in names:
        object.__setattr__(part, name, check(name, getattr(part, name)))


def non_negative(field: str, value: Any) -> float:
    """Return a finite number >= 0."""
    return checked_number(field, value, "a finite number >= 0", lambda number: number >= 0)


def between(field: str, value: Any, low: float, high: float) -> float:
    """Return a finite number strictly between low and high."""
    return checked_number(
        field,
        value,
        f"a finite number above {low:.17g} and below {high:.17g}",
        lambda number: low < number < high,
    )


def poisson_ratio(field: str, value: Any) -> float:
    """Return the Poisson ratio of a stable body: above -1 and at most 0.5."""
    return checked_number(
        field, value, "a Poisson's ratio, above -1 and at most 0.5", lambda nu: -1.0 < nu <= 0.5
    )


def positive_or_none(field: str, value: Any) -> float | None:
    """Return a finite number > 0, or None if the value is left out (None)."""
    return None if value is None else positive(field, value)


def finite_or_none(field: str, value: Any) -> float | None:
    """Return a finite number, or None if the value is left out (None)."""
    return None if value is None else finite(field, value)


def integer(field: str, value: Any, least: int = 0) -> int:
    """Return a whole number >= least. The float 2.0 and the bool True are refused."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, Integral) or value < least:
        raise SceneError.of(field, value, f"a whole number >= {least}")
    return int(value)


def text(field: str, value: Any) -> str:
    """Return a non-empty string."""
    if not isinstance(value, str) or not value:
        raise SceneError.of(field, value, "a non-empty string")
    return value


def one_of(field: str, value: Any, choices: Iterable[str]) -> str:
    """Return the value if it is one of `choices`; otherwise SceneError names the nearest choice."""
    known = tuple(choices)
    if not isinstance(value, str) or value not in known:
        raise SceneError.unknown(field, value, known)
    return value


def finite_array(field: str, value: Any, ndim: int | None = 1, least: int = 1) -> Array:
    """Return a read-only float copy of an array of finite real numbers.

    The array has at least `least` elements, and `ndim` axes (None: any number of axes).
    """
    shape = {None: "an array", 0: "a number", 1: "a one-dimensional array"}.get(
        ndim, f"an array with {ndim} axes"
    )
    count = f" of at least {least}" if least > 1 else " of"
    allowed = f"{shape}{count} finite real numbers"
    if isinstance(value, (str, bytes)) or (
        isinstance(value, (list, tuple)) and any(isinstance(v, bool) for v in value)
    ):
        raise SceneError.of(field, value, allowed)
    if hasattr(value, "magnitude"):
        raise SceneError.of(
            field, value, allowed + ", as plain values in SI units without a unit object"
        )
    if np.ma.is_masked(value) or (
        isinstance(value, (list, tuple)) and any(v is np.ma.masked for v in value)
    ):
        raise SceneError.of(field, value, allowed + ", none masked")
    try:
        raw = np.asarray(value)
    except (TypeError, ValueError):
        raise SceneError.of(field, value, allowed) from None
    if raw.dtype.kind not in "iuf" or (ndim is not None and raw.ndim != ndim) or raw.size < least:
        got = f"{'an' if raw.size else 'an empty'} array of shape {raw.shape}, type {raw.dtype}"
        raise SceneError.of(field, value, f"{allowed} (got {got})")
    array = np.array(raw, dtype=np.float64)
    if not np.isfinite(array).all():
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        at = where[0] if len(where) == 1 else where
        raise SceneError.of(field, value, f"{allowed} (element {at} is {array[where]})")
    array.setflags(write=False)
    return array


def real(field: str, value: Any) -> Array:
    """Return an array of real numbers as floats; infinite and masked numbers become NaN."""
    raw = as_array(value)
    if np.ma.is_masked(value):
        raw = np.ma.filled(np.ma.asarray(value, dtype=np.float64), np.nan)
    if raw.dtype.kind not in "iuf" and raw.size:
        raise SceneError.of(
            field, value, f"real numbers in an array of any shape (got type {raw.dtype})"
        )
    array = np.asarray(raw, dtype=np.float64)
    return array if np.isfinite(array).all() else np.where(np.isinf(array), np.nan, array)


def increasing(field: str, value: Any, least: int) -> Array:
    """Return a strictly increasing array of finite numbers; SceneError names the first
    violation.
    """
    array = finite_array(field, value, 1, least)
    wrong = np.flatnonzero(np.diff(array) <= 0)
    if wrong.size:
        i = int(wrong[0])
        raise SceneError.of(
            field,
            value,
            f"strictly increasing (element {i + 1} is {array[i + 1]:.17g} after {array[i]:.17g})",
        )
    return array
