r"""The map under which one symmetric zone is one interval under Cauchy's kernel.

With u = pi x/L and the slope f' of the profile f, the equation of the pressure becomes

    (1/pi) PV int Phi(eta) / (y - eta) d eta = G(y),     G = f'/w,     p = (E*/2) w Phi.

                     y          w          load divided by E*/2, per unit of int Phi d eta
    a zone alone     x          1          1
    all periods      sin u      cos u      L/pi

The first line is Shtaerman's (1949). The second follows from cot(u - v) + cot(u + v) =
sin 2u / (sin^2 u - sin^2 v), since the pressure is even.

A quantity of one load is a number, one of several loads an array with one entry for each load. The
functions below are the few that numpy does not offer for both.
"""

import math
from typing import Any

import numpy as np

from sie import Array, record

# A number, or an array with one entry for each load.
Value = Any


def column(value: Value) -> Value:
    """The value in a shape that broadcasts against places along a row."""
    return value if isinstance(value, float) else value[:, None]


def least(values: Array) -> Value:
    """The minimum of each row; nan where the row has one."""
    # For one row, argmin and item take half the time of min.
    return values.item(values.argmin()) if values.ndim == 1 else values.min(axis=-1)


def largest(values: Array) -> Value:
    """The maximum of each row; nan where the row has one."""
    return values.item(values.argmax()) if values.ndim == 1 else values.max(axis=-1)


def choose(condition: Any, value: Value, other: Value) -> Value:
    """The first value where the condition holds, else the other."""
    if isinstance(condition, np.ndarray):
        return np.where(condition, value, other)
    return value if condition else other


def everywhere(condition: Any) -> bool:
    """Whether a condition holds for all loads."""
    return bool(condition.all()) if isinstance(condition, np.ndarray) else bool(condition)


@record
class LineMap:
    """The map from places x [m] to y; period [m] is None where nothing repeats."""

    period: float | None

    @property
    def load_factor(self) -> float:
        """Load divided by E*/2 [m], per unit of int Phi d eta; also dx/dy times the weight w."""
        return 1.0 if self.period is None else self.period / math.pi

    def y(self, x: Value) -> Value:
        return x if self.period is None else np.sin(x * (math.pi / self.period))

    def at(self, y: Value) -> tuple[Value, Value]:
        """The place x at y, and the weight w there."""
        if self.period is None:
            return y, 1.0
        turn = np.arcsin(y)
        return turn * (self.period / math.pi), np.cos(turn)

    def weight(self, x: Value) -> Value:
        """The weight w at x."""
        return 1.0 if self.period is None else np.cos(x * (math.pi / self.period))

    def rise(self, start: Value, distance: Value) -> Value:
        """y(start + distance) - y(start), without loss of digits for short distances."""
        if self.period is None:
            return distance
        k = math.pi / self.period
        return 2.0 * np.cos(k * (start + 0.5 * distance)) * np.sin(0.5 * k * distance)
