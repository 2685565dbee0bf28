r"""Basis functions at complex points, in the closed upper half plane.

On an interval, zeta = (z - middle)/w, p = sqrt(zeta + 1), m = sqrt(zeta - 1), both in the first quadrant, so that no digit is lost in

    rho = zeta - p m = 2 / (p + m)^2,     1 - rho = 2 m / (p + m),     T_l / sqrt -> rho^l / (p m),     sqrt U_l -> rho^(l+1),

and the potentials are w log(w / (2 rho)) of T_0 / sqrt, -w rho^l / l of T_l / sqrt.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Index = NDArray[np.intp]
What = Literal["transform", "derivative", "potential"]


def complex_of(x: Any, y: Any) -> Complex:
    """x + i y, the sign of a zero y kept."""
    x, y = np.broadcast_arrays(x, y)
    out = np.empty(x.shape, dtype=complex)
    out.real, out.imag = x, y
    return out


@dataclass(frozen=True, eq=False)
class Seen:
    """Points of the closed upper half plane seen from intervals, pair by pair: zeta + 1, zeta - 1, and their roots."""

    left: Complex
    less: Complex

    @classmethod
    def of(cls, from_a: Array, from_b: Array, y: Array) -> Seen:
        """By x - a, x - b and y, over the half width."""
        return cls(complex_of(from_a, y), complex_of(from_b, y))

    @cached_property
    def p(self) -> Complex:
        return np.asarray(np.sqrt(self.left))

    @cached_property
    def m(self) -> Complex:
        return np.asarray(np.sqrt(self.less))

    @cached_property
    def zeta(self) -> Complex:
        return np.asarray(0.5 * (self.left + self.less))

    @cached_property
    def root(self) -> Complex:
        """sqrt(zeta^2 - 1), about zeta far away."""
        return self.p * self.m

    @cached_property
    def rho(self) -> Complex:
        return np.asarray(2 / (self.p + self.m) ** 2)

    @cached_property
    def log(self) -> Complex:
        """-log(rho) = arcosh(zeta), its imaginary part from 0 to pi."""
        return np.asarray(2 * np.log((self.p + self.m) * np.sqrt(0.5)))

    def __getitem__(self, which: Any) -> Seen:
        return Seen(self.left[which], self.less[which])

    def turned(self, c: Array, s: Array) -> Complex:
        """log(B) for jumps with cos(phi/2) = c, sin(phi/2) = s along a last axis."""
        p, m = self.p[..., None], self.m[..., None]
        return np.asarray(np.log(2 * (c - 1j * s) * (c * m + 1j * s * p) / (p + m)))


def of_t(c: Array, seen: Seen, w: Array, datum: float, row: Index, what: What) -> Complex:
    """Of sum c[row, l] T_l / sqrt(1 - t^2) on intervals of half widths w."""
    if what == "potential":
        first, rest = c[row, 0], c[:, 1:] / np.arange(1, c.shape[1])
        return np.asarray(w * (first * (np.log(w / (2 * datum)) + seen.log) - seen.rho * sum_of_powers(rest, seen.rho, row)))
    value = sum_of_powers(c, seen.rho, row)
    if what == "transform":
        return np.asarray(value / seen.root)
    slope = sum_of_powers(c * np.arange(c.shape[1]), seen.rho, row)
    return np.asarray(-(slope + seen.zeta / seen.root * value) / seen.root**2 / w)


def of_bounded(alpha: Array, beta: Array, u: Array, seen: Seen, row: Index, what: What) -> Complex:
    """Of (alpha + beta t)/sqrt(1 - t^2) + sqrt(1 - t^2) sum u_k U_k, the transform or the half width times its derivative."""
    a, b, rho = alpha[row], beta[row], seen.rho
    with np.errstate(divide="ignore", invalid="ignore"):
        edge = (a + b * rho) / seen.root
        if what == "derivative":
            edge = -(edge * seen.zeta / seen.root + b * rho / seen.root) / seen.root
            u = -u * np.arange(1, u.shape[1] + 1)
        value = rho * sum_of_powers(u, rho, row)
        if what == "derivative":
            value = np.where(value == 0, 0.0, value / seen.root)
    return np.asarray(np.where((a == 0) & (b == 0), 0.0, edge) + value)


def sum_of_powers(u: Array, rho: NDArray[Any], zone: Index) -> NDArray[Any]:
    """sum_k u[zone, k] rho^k pair by pair (n,), rho real or complex, as far as rho^k is seen."""
    count = u.shape[1]
    if count == 0 or len(rho) == 0:
        return np.zeros(rho.shape, dtype=rho.dtype)
    flat = np.abs(rho)
    with np.errstate(divide="ignore"):
        need = np.fmin(count, np.ceil(-40.0 / np.log(np.minimum(flat, 1 - 1e-12)))).astype(int)
    need = np.maximum(need, 1)
    order = np.argsort(-need, kind="stable")
    point_rho, row = rho[order], zone[order]
    counts = need[order]
    out = np.zeros(len(order), dtype=rho.dtype)
    active = np.searchsorted(-counts, -np.arange(1, counts[0] + 1), side="right")
    for k in range(int(counts[0]) - 1, -1, -1):
        n = active[k]
        out[:n] = out[:n] * point_rho[:n] + u[row[:n], k]
    result = np.empty(len(order), dtype=rho.dtype)
    result[order] = out
    return result
