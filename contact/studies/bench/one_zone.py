"""One isolated symmetric zone under any slope f', by quadrature.

Let a be the half width. With xi = a sin(theta) and PV int dtheta/(a sin(theta) - x) = 0, pressure
and load are

    p(x) = (E*/2 pi) sqrt(a^2 - x^2) int [f'(a sin theta) - f'(x)] / (a sin theta - x) dtheta,
    P = E* int_0^(pi/2) a sin(theta) f'(a sin theta) dtheta,

where the first integral is taken over -pi/2 < theta < pi/2. The first formula is the inverse of the
finite Hilbert transform that is bounded at both ends. Between two breaks of a spline the integrand
is smooth, and eight Gauss-Legendre points integrate it to round-off.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from numpy.typing import NDArray

from contact.model.profiles.base import Profile
from contact.reference.exact import SymmetricZone

Array = NDArray[np.float64]


@cache
def gauss(nodes: int = 8) -> tuple[Array, Array]:
    """Gauss-Legendre nodes and weights on (-1, 1)."""
    return np.polynomial.legendre.leggauss(nodes)


@dataclass(frozen=True, eq=False)
class ByPieces(SymmetricZone):
    """Exact contact on [-a, a] of an even profile whose slope is smooth between `breaks`."""

    profile: Profile
    breaks: Array
    E_star: float
    half_width: float
    period = None

    @cached_property
    def _edges(self) -> Array:
        """Ends of the intervals of theta in which the slope of the profile is smooth.
        The position is x = a sin(theta), with the half width a.
        """
        inside = self.breaks[np.abs(self.breaks) < self.half_width] / self.half_width
        return np.concatenate(([-0.5 * np.pi], np.arcsin(np.unique(inside)), [0.5 * np.pi]))

    def _rule(self, edges: Array) -> tuple[Array, Array, Array]:
        """(positions x, slopes of the profile, weights) of a quadrature over theta.
        Here x = a sin(theta), with the half width a, and `edges` are the ends of the intervals of
        theta.
        """
        nodes, weights = gauss()
        half = 0.5 * np.diff(edges)
        theta = (0.5 * (edges[1:] + edges[:-1]))[:, None] + half[:, None] * nodes
        x = (self.half_width * np.sin(theta)).ravel()
        return x, np.asarray(self.profile.slope(x)), (half[:, None] * weights).ravel()

    @cached_property
    def _rule_of_zone(self) -> tuple[Array, Array, Array]:
        return self._rule(self._edges)

    @cached_property
    def load(self) -> float:  # type: ignore[override]
        x, slope, weight = self._rule_of_zone
        return 0.5 * self.E_star * float(np.sum(x * slope * weight))

    @cached_property
    def max_pressure(self) -> float:  # type: ignore[override]
        return float(self.pressure_at(np.cos((np.arange(24) + 0.5) * np.pi / 24)).max())

    def _pressure(self, r: Array, d: Array) -> Array:
        x, slope, weight = self._rule_of_zone
        edges = self._edges
        out = np.empty(r.size)
        for k, here in enumerate(r.ravel()):
            angle = float(np.arcsin(here / self.half_width))
            there = self.profile.slope(here)
            piece = int(np.clip(np.searchsorted(edges, angle), 1, len(edges) - 1))
            close = slice(max(piece - 3, 0), min(piece + 3, len(edges)))
            far = np.ones(len(x), dtype=bool)
            n = len(gauss()[0])
            far[close.start * n : (close.stop - 1) * n] = False
            total = np.sum((slope[far] - there) / (x[far] - here) * weight[far])
            xi, f, w = self._rule(_graded(edges[close], angle))
            out[k] = total + np.sum((f - there) / (xi - here) * w)
        return 0.5 * self.E_star / np.pi * np.sqrt(d * (self.half_width + r)) * out.reshape(r.shape)


def _graded(edges: Array, at: float) -> Array:
    """The interval ends `edges`, and more ends, which make the intervals near `at` shorter.

    In the neighbouring intervals the difference quotient has a pole at the angle `at`. There the
    quadrature is accurate if an interval is no wider than its distance from the pole.
    """
    steps = 2.0 ** np.arange(60) - 1
    left, right = edges[edges < at], edges[edges > at]
    more = np.concatenate((left[-1] - (at - left[-1]) * steps, right[0] + (right[0] - at) * steps))
    return np.unique(np.concatenate((edges, more[(more > edges[0]) & (more < edges[-1])])))
