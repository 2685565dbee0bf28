"""Closed forms of the adjoint equation: singular parts of its solution, and points in the body."""

from __future__ import annotations

from typing import Any

import numpy as np

from sie import Array, Complex, record


@record
class Source:
    """A singular part w of the adjoint weight, known in closed form, on one zone.
    It belongs to the derivative of the pressure at t = place, or of an end of the zone.

    end: 0 for a place, -1 and 1 for the left and the right end. factor: factor of w.
    """

    zone: int
    factor: float
    end: int = 0
    place: float = 0.0

    def weight(self, t: Array) -> Array:
        """The weight w at t = cos(angle), times sqrt(1 - t^2), which is |dt / d(angle)|."""
        if self.end:
            return np.asarray(self.factor * (1 + self.end * t))
        return np.asarray(self.factor * (1 - t) * (1 + t) / (t - self.place))

    def field(self, left: Array, right: Array, slope: bool) -> Array:
        """Transform T w of the weight w at z outside the zone; its derivative if `slope` is true.
        The arguments are left = z + 1 and right = z - 1.
        """
        root = np.sign(left) * np.sqrt(left * right)
        # Far from the zone, differences of nearly equal terms would lose digits. They are rewritten
        # with left - right = 2.
        if self.end == 1:
            value, rise = 2 / (right * (np.sqrt(left / right) + 1)), -1 / (right * root)
        elif self.end == -1:
            value, rise = 2 / (left * (np.sqrt(right / left) + 1)), -1 / (left * root)
        else:
            at, z = self.place, 0.5 * (left + right)
            away = z - at
            value = ((1 - at) * (1 + at) - 2 * at * away) / (away * (away + root))
            rise = (z * at - 1) / (root * away**2)
        return np.asarray(self.factor * (rise if slope else value))

    @property
    def area(self) -> float:
        """Principal value of the integral of the weight w over t from -1 to 1."""
        return np.pi * self.factor * (1.0 if self.end else -self.place)

    @property
    def on_zone(self) -> float:
        """Constant value, on the source's zone, of the transform T w of the weight w."""
        return -self.factor if self.end == 1 else self.factor


@record
class InnerPoint:
    """The function Re(A K(z - x) + B K'(z - x)) / pi of x, for a fixed point z in the body.
    K is the kernel 1 / x or its periodic sum. A (`value`) and B (`rise`) are the factors of the
    pressure's transform at z and of its derivative.

    period: that of the kernel K, None for 1 / x.
    """

    z: complex
    value: complex
    rise: complex
    period: float | None

    def field(self, x: Array, slope: bool) -> Array:
        """The function of x that the class describes, or its derivative by x if `slope` is true."""
        first, second, third = cotangents(self.z - x, self.period)
        found = self.value * second + self.rise * third if slope else None
        if found is None:
            return np.asarray((self.value * first + self.rise * second).real / np.pi)
        return np.asarray(-found.real / np.pi)


def cotangents(w: Any, period: float | None) -> tuple[Complex, Complex, Complex]:
    """The kernel K and its derivatives K' and K'' at complex w with Im w > 0.
    K(w) is 1 / w, or (pi/L) cot(pi w / L) with the period L.
    """
    if period is None:
        return 1 / w, -1 / w**2, 2 / w**3
    scale = np.pi / period
    turns = w.real / period
    power = 2j * np.pi * (turns - np.round(turns)) - 2 * scale * w.imag
    e, less = np.exp(power), -np.expm1(power)
    return (
        -1j * scale * (1 + e) / less,
        4 * scale**2 * e / less**2,
        8j * scale**3 * e * (1 + e) / less**3,
    )
