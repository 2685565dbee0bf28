r"""Maps under which one symmetric zone, or a symmetric pair of zones, is one interval of a line
under Cauchy's kernel.

The pressure is even, so that the kernel acts with that of the mirror image. With k = pi/L, u = k x,
pressures in E*/2 and f' as the right side, the equation becomes (1/pi) PV int Phi(eta) / (y - eta)
d eta = G(y), where G = f'/w, p = (E*/2) w Phi and

                    y          w          load over E*/2, per int Phi d eta
    one zone        x          1          1
      of all        sin u      cos u      L/pi
    a pair          x^2        x          1
      of all        sin^2 u    sin 2u     2 L/pi

as cot(u - v) + cot(u + v) = sin 2u / (sin^2 u - sin^2 v). The level of a pair is one by symmetry.
Without a period the first line is Shtaerman's (1949); the pair's is found by (34) of Goryacheva &
Tsukanov (2020) with two zones.

Numbers of one load, and rows of several, go by the same words. Of so few numbers a call takes
longer than what it does, and the place of the least is found by a quicker one than the least
itself.
"""

import math
from typing import Any

import numpy as np

from sie import Array, record

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


@record
class Map:
    """x [m] to y. period [m]: None where nothing repeats; pair: two zones, about x = +-s."""

    period: float | None
    pair: bool

    @property
    def load_factor(self) -> float:
        """Load over E*/2 [m, or m^-1 of a pair without a period], per int Phi d eta."""
        if self.period is None:
            return 1.0
        return (2.0 if self.pair else 1.0) * self.period / math.pi

    @property
    def rise_factor(self) -> float:
        """int w dx per unit of y."""
        return (
            self.load_factor / (2.0 if self.pair else 1.0)
            if self.period is not None
            else (0.5 if self.pair else 1.0)
        )

    def y(self, x: Value) -> Value:
        if self.period is None:
            return x * x if self.pair else x
        sine = np.sin(x * (math.pi / self.period))
        return sine * sine if self.pair else sine

    def x(self, y: Value) -> Value:
        """The place at y, of the right half where there are two."""
        return self.at(y)[0]

    def at(self, y: Value) -> tuple[Value, Value]:
        """(the place at y, w there)."""
        root = np.sqrt(y) if self.pair else y
        if self.period is None:
            return root, root if self.pair else 1.0
        turn = np.arcsin(root)
        return turn * (self.period / math.pi), np.sin(2.0 * turn) if self.pair else np.cos(turn)

    def weight(self, x: Value) -> Value:
        """w at x."""
        if self.period is None:
            return x if self.pair else 1.0
        turn = x * (math.pi / self.period)
        return np.sin(2.0 * turn) if self.pair else np.cos(turn)

    def rise(self, start: Value, distance: Value) -> Value:
        """y(start + distance) - y(start), without loss of digits for short distances."""
        if self.period is None:
            return distance * (2.0 * start + distance) if self.pair else distance
        k = math.pi / self.period
        if self.pair:
            return np.sin(k * distance) * np.sin(k * (2.0 * start + distance))
        return 2.0 * np.cos(k * (start + 0.5 * distance)) * np.sin(0.5 * k * distance)
