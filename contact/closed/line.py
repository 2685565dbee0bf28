r"""The map under which one symmetric zone is one interval under Cauchy's kernel.

With u = pi x/L and the slope f' of the profile f, the equation of the pressure becomes

    (1/pi) PV int Phi(eta) / (y - eta) d eta = G(y),     G = f'/w,     p = (E*/2) w Phi.

                              y          w          load divided by E*/2 and by int Phi d eta
    an isolated zone          x          1          1
    a zone in each period     sin u      cos u      L/pi

The first line is Shtaerman's (1949). The second follows from cot(u - v) + cot(u + v) =
sin 2u / (sin^2 u - sin^2 v), since the pressure is even.

A quantity is a number if it belongs to one load. It is an array with one entry for each load if it
belongs to several loads. The functions below are those few that numpy does not offer for both.
"""

import math
from typing import Any

import numpy as np

from sie import Array, record

# Type of a quantity: a number for one load, or an array with one entry for each load.
Value = Any


def column(value: Value) -> Value:
    """Values for several loads as a column, so that they combine with arrays (loads, positions).

    A single number is returned as it is.
    """
    return value if isinstance(value, float) else value[:, None]


def least(values: Array) -> Value:
    """The minimum of each row of an array; nan if the row contains nan."""
    # For one row, `argmin` and `item` take half the time of `min`.
    return values.item(values.argmin()) if values.ndim == 1 else values.min(axis=-1)


def largest(values: Array) -> Value:
    """The maximum of each row of an array; nan if the row contains nan."""
    return values.item(values.argmax()) if values.ndim == 1 else values.max(axis=-1)


def choose(condition: Any, value: Value, other: Value) -> Value:
    """Elementwise `value` where the condition holds, else `other`; numbers or arrays over loads."""
    if isinstance(condition, np.ndarray):
        return np.where(condition, value, other)
    return value if condition else other


def everywhere(condition: Any) -> bool:
    """Whether a condition holds for all loads."""
    return bool(condition.all()) if isinstance(condition, np.ndarray) else bool(condition)


@record
class LineMap:
    """The map from positions x [m] to y = sin(pi x / period), or to y = x without a period."""

    period: float | None

    @property
    def load_factor(self) -> float:
        """Load divided by E*/2, for a solution Phi whose integral over y is 1.

        It equals dx/dy times the weight w.
        """
        return 1.0 if self.period is None else self.period / math.pi

    def y(self, x: Value) -> Value:
        return x if self.period is None else np.sin(x * (math.pi / self.period))

    def at(self, y: Value) -> tuple[Value, Value]:
        """(position x that the map takes to y, weight w = cos(pi x / period) at x)."""
        if self.period is None:
            return y, 1.0
        turn = np.arcsin(y)
        return turn * (self.period / math.pi), np.cos(turn)

    def weight(self, x: Value) -> Value:
        """The weight w = cos(pi x / period) at the position x. It is 1 without a period."""
        return 1.0 if self.period is None else np.cos(x * (math.pi / self.period))

    def rise(self, start: Value, distance: Value) -> Value:
        """The difference y(start + distance) - y(start) of mapped positions.
        It has no cancellation for short distances.
        """
        if self.period is None:
            return distance
        k = math.pi / self.period
        return 2.0 * np.cos(k * (start + 0.5 * distance)) * np.sin(0.5 * k * distance)
