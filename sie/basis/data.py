"""Array types, records, and helpers for places on a periodic line and for rows of tables."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Any, TypeVar, dataclass_transform

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Index = NDArray[np.intp]
Mask = NDArray[np.bool_]
T = TypeVar("T")

EPS = float(np.finfo(np.float64).eps)
# Absolute value above which the square of a number does not underflow.
TINY = float(np.sqrt(np.finfo(np.float64).tiny))
# Relative round-off of a value that results from a few dozen operations.
SUM_ROUNDING = 64 * EPS
# Relative difference of two numbers that agree in half of a double's digits: the root of `EPS`.
HALF_DIGITS = math.sqrt(EPS)
# The power rho^l, 0 < rho < 1, is below round-off for l > DIGITS / -log(rho), since exp(-40) is
# 4e-18.
DIGITS = 40.0


@dataclass_transform(frozen_default=True, eq_default=False, field_specifiers=(field,))
def record(cls: type[T]) -> type[T]:
    """Class decorator: an immutable data class whose instances are compared by identity.

    Type checkers report code that sets a field again; nothing is checked at run time. Python's
    frozen data classes would take three times as long to define, and their instances twice as long
    to create. This matters for the many records of every Newton step.

    Parameters
    ----------
    cls : type
        A class whose fields are annotated, as for ``dataclasses.dataclass``.

    Returns
    -------
    type
        The same class, with ``__init__``.

    Examples
    --------
    >>> import sie
    >>> @sie.record
    ... class Place:
    ...     zone: int
    ...     coordinate: float = 0.0
    >>> Place(2).coordinate
    0.0
    """
    return dataclass(eq=False, repr=False)(cls)


class Kept:
    """Base of classes whose copies and pickles leave out the values of cached properties.

    The cached properties follow exactly from the fields, so that nothing is lost.

    Examples
    --------
    >>> import pickle, sie
    >>> zones = sie.Zones.of([[0.0, 1.0]])
    >>> zones.half.tolist(), "half" in pickle.loads(pickle.dumps(zones)).__dict__
    ([0.5], False)
    """

    def __getstate__(self) -> Any:
        state: Any = super().__getstate__()
        if isinstance(state, tuple):  # the class has slots
            return self._fields_of(state[0] or {}), state[1]
        return state and self._fields_of(state)

    def _fields_of(self, values: dict[str, Any]) -> dict[str, Any]:
        """The given attributes (name: value) of an object, without the cached properties."""
        cls = type(self)
        return {
            name: value
            for name, value in values.items()
            if not isinstance(getattr(cls, name, None), cached_property)
        }


def wrapped(x: Array, start: float | Array, period: float | None) -> Array:
    """Positions x moved by whole periods into [start, start + period).
    Without a period they are not moved.

    Parameters
    ----------
    x : ndarray
        Places.
    start : float or ndarray
        Start of the interval into which the places are moved.
    period : float or None
        Length of the period; None: nothing repeats, and the places are returned unchanged.

    Returns
    -------
    ndarray
        Of the shape of `x`.

    Examples
    --------
    >>> import numpy as np, sie
    >>> sie.wrapped(np.array([-1.0, 7.0]), 0.0, 3.0)
    array([2., 1.])
    """
    return x if period is None else np.asarray(x - np.floor((x - start) / period) * period)


def nearest_image(x: Array, centre: float | Array, period: float | None) -> Array:
    """Positions x moved by whole periods to within half a period of a centre.
    Without a period they are not moved.

    Parameters
    ----------
    x : ndarray
        Places.
    centre : float or ndarray
        The centre.
    period : float or None
        Length of the period; None: nothing repeats, and the places are returned unchanged.

    Returns
    -------
    ndarray
        Of the shape of `x`.

    Examples
    --------
    >>> import numpy as np, sie
    >>> sie.nearest_image(np.array([-1.0, 8.0]), 0.0, 3.0)
    array([-1., -1.])
    """
    return x if period is None else np.asarray(x - np.round((x - centre) / period) * period)


def sum_error(x: Array, by: Array) -> Array:
    """The exact round-off error of the floating-point sum x + by.

    D. E. Knuth, The Art of Computer Programming 2, 4.2.2.
    """
    there = x + by
    back = there - x
    return np.asarray((x - (there - back)) + (by - back))


def root_of_squares(matrix: Array, x: Array | float = 1.0) -> Array:
    """sqrt(sum_j (matrix_ij x_j)^2) for each row i, without overflow or underflow of squares."""
    terms = np.abs(matrix * x)
    largest = float(terms.max(initial=0.0))
    if not 0.0 < largest < np.inf:
        return np.full(len(matrix), largest)
    terms /= largest
    return np.asarray(largest * np.sqrt(np.einsum("ij,ij->i", terms, terms)))


def numbered(counts: Index) -> Index:
    """The numbers 0 ... counts[0] - 1, then 0 ... counts[1] - 1, and so on."""
    return np.arange(int(counts.sum())) - np.repeat(np.cumsum(counts) - counts, counts)


def by_rows(function: Callable[..., Any], *tables: NDArray[Any], max_rows: int = 2048) -> Any:
    """The result of a function for long tables, computed in blocks of at most `max_rows` rows.

    The function must act on each row alone. Without blocks, its intermediate arrays would not fit
    into the cache.
    """
    if len(tables[0]) <= max_rows:
        return function(*tables)
    return np.concatenate(
        [
            function(*(table[s : s + max_rows] for table in tables))
            for s in range(0, len(tables[0]), max(1, max_rows))
        ]
    )


def row_sizes(table: Array) -> Array:
    """Largest absolute value in each row of a table; zero if the table has no columns."""
    return by_rows(lambda rows: np.abs(rows).max(axis=1, initial=0.0), table)


def widened(table: Array, columns: int) -> Array:
    """The table, extended by columns of zeros to at least `columns` columns."""
    if table.shape[1] >= columns:
        return table
    out = np.zeros((len(table), columns), dtype=table.dtype)
    out[:, : table.shape[1]] = table
    return out


@lru_cache(maxsize=16)
def _legendre(nodes: int) -> tuple[Array, Array]:
    """(places, weights) of the Gauss-Legendre rule on the interval from 0 to 1."""
    t, weights = np.polynomial.legendre.leggauss(nodes)
    return np.asarray(0.5 * (1 + t)), np.asarray(0.5 * weights)


def legendre(ends: Array, nodes: int, parts: Index | int = 1) -> tuple[Array, Array]:
    """(places, weights) of a Gauss-Legendre rule on each interval between neighbouring `ends`.

    Each interval is split into `parts` equal parts with `nodes` nodes each.
    """
    parts = np.broadcast_to(parts, len(ends) - 1)
    length = np.repeat(np.diff(ends) / parts, parts)[:, None]
    start = np.repeat(ends[:-1], parts)[:, None] + numbered(parts)[:, None] * length
    place, weight = _legendre(nodes)
    return (start + length * place).ravel(), (length * weight).ravel()
