"""Steps of the right side, carried exactly.

A step of height J at t = cos(phi) inside a zone is what the kernel makes of

    (J/pi) kappa(t),  kappa = ln|sin((theta + phi)/2) / sin((theta - phi)/2)| = sum_j (2/j) sin(j phi) sin(j theta),

up to the constant -J phi / pi. Off the zone its transform is 2 Im(-ln(1 - rho e^{i phi})) with the same series in rho. So
the logarithm is evaluated in closed form and only the smooth rest is expanded.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sie.zones import Zones

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Steps:
    """Steps inside the zones: zone index, distance from the zone's left and right end over its half width, height."""

    zone: NDArray[np.intp]
    left: Array
    right: Array
    height: Array

    @classmethod
    def within(cls, zones: Zones, at: Array, heights: Array, period: float | None) -> Steps:
        """The steps at positions `at` (repeated with the period) that lie inside a zone."""
        if len(at) == 0:
            return _NONE
        if period is not None:
            at = at + np.ceil((zones.a[0] - at) / period) * period
        i = np.searchsorted(zones.a, at, side="right") - 1
        inside = (i >= 0) & (at > zones.a[i]) & (at < zones.b[i])
        i, at = i[inside], at[inside]
        w = zones.half[i]
        return cls(i, (at - zones.a[i]) / w, (zones.b[i] - at) / w, heights[inside])

    def __len__(self) -> int:
        return len(self.zone)

    @cached_property
    def phi(self) -> Array:
        """Angle of each step, t = cos(phi)."""
        return np.asarray(2 * np.arctan2(np.sqrt(self.right), np.sqrt(self.left)))

    def offsets(self, zones: Zones) -> Array:
        """The constant J phi / pi per zone (Z,), by which the logarithm's transform is lower than the step."""
        return np.bincount(self.zone, self.height * self.phi / np.pi, minlength=len(zones))

    def value(self, zone: NDArray[np.intp], left: Array) -> Array:
        """Sum of the steps passed at points of given zone index and distance from its left end over w."""
        out = np.zeros(np.broadcast(zone, left).shape)
        for i, at, height in zip(self.zone, self.left, self.height, strict=True):
            out += np.where((zone == i) & (left > at), height, 0.0)
        return out

    def primitive(self, zone: NDArray[np.intp], left: Array) -> Array:
        """Sum of J (x - s)_+ / w at such points."""
        out = np.zeros(np.broadcast(zone, left).shape)
        for i, at, height in zip(self.zone, self.left, self.height, strict=True):
            out += np.where((zone == i) & (left > at), height * (left - at), 0.0)
        return out

    def primitive_means(self, zones: Zones) -> Array:
        """Mean (weight 1/sqrt(1-t^2)) over each zone of J (x - s)_+ - (J phi/pi)(x - middle), by the half width."""
        phi = self.phi
        mean = self.height * (np.sin(phi) - phi * np.cos(phi)) / np.pi
        return np.bincount(self.zone, mean, minlength=len(zones))

    def t_coefficients(self, zones: Zones, count: int) -> Array:
        """First `count` coefficients c_l of the logarithms as sums of T_l / sqrt(1 - t^2); shape (zones, count)."""
        out = np.zeros((len(zones), count))
        if len(self) and count:
            j = np.arange(1, count + 1)
            beta = (2 * self.height / np.pi)[:, None] * np.sin(j * self.phi[:, None]) / j
            c = 0.5 * beta
            c[:, 2:] -= 0.5 * beta[:, :-2]
            np.add.at(out, self.zone, c)
        return out

    def edge_slopes(self, zones: Zones) -> tuple[Array, Array]:
        """Coefficient of the angle from the left and from the right end, per zone: kappa ~ theta cot(phi/2)."""
        cot = np.sqrt(self.left / self.right)
        scale = self.height / np.pi
        n = len(zones)
        return np.bincount(self.zone, scale / cot, minlength=n), np.bincount(self.zone, scale * cot, minlength=n)

    def density(self, k: int, left: Array, right: Array) -> Array:
        """(J/pi) kappa of step k at points at distances `left`, `right` over w from the ends of its zone."""
        up, vp = np.sqrt(right * self.left[k]), np.sqrt(left * self.right[k])
        # sin((theta +- phi)/2) = (sqrt(r l_s) +- sqrt(l r_s)) / 2; their product is (s - t)/2 without cancellation.
        with np.errstate(divide="ignore"):
            ratio = np.log((up + vp) ** 2 / (2 * np.abs(left - self.left[k])))
        return np.asarray(self.height[k] / np.pi * ratio)

    def transform(self, k: int, rho: Array) -> Array:
        """Transform of (J/pi) kappa of step k off its zone."""
        phi = self.phi[k]
        return np.asarray(2 * self.height[k] / np.pi * np.arctan2(rho * np.sin(phi), 1 - rho * np.cos(phi)))

    def potential(self, k: int, rho: NDArray[np.complex128] | Array) -> Array:
        """Potential of (J/pi) kappa of step k over w, without the logarithm of w; on the zone rho = e^{i theta}.

        From sum_j (sin(j phi)/j) (-rho^{j-1}/(j-1) + rho^{j+1}/(j+1)) by partial fractions.
        """
        up = np.exp(1j * self.phi[k])
        both = _potential_series(up, rho) - _potential_series(np.conj(up), rho)
        own = np.sin(self.phi[k]) * (-np.log(2 * np.abs(rho)) + np.real(rho**2) / 2)
        return np.asarray(self.height[k] / np.pi * (own + np.real(both / 2j)))


def _potential_series(up: complex, rho: NDArray[np.complex128] | Array) -> NDArray[np.complex128]:
    q = up * np.asarray(rho, dtype=complex)
    log = -np.log1p(-q)
    rest = log - q
    return -(up * log - rest / rho) + rho * rest - np.conj(up) * (rest - q * q / 2)


_NONE = Steps(np.zeros(0, dtype=np.intp), np.zeros(0), np.zeros(0), np.zeros(0))
