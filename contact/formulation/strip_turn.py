r"""The contact of one strip by its gaps: in the angle it is a contact of one period.

With x = c - h cos(theta) on the strip |x - c| < h of a half-plane and P(theta) = p(x) h sin(theta), odd continuations of slopes and even
ones of pressures, of int_{-pi}^{pi} P(phi) cot((theta - phi)/2)/2 dphi = h sin(theta) int p(xi)/(x - xi) dxi,

    P = m - R + H s,    R = H d/dtheta f(c - h cos theta) + q (2 h/pi - h |sin theta|),    m = load/pi,

scaled: s the slope of the gap by the angle, H the Hilbert transform of the period 2 pi, q the nominal pressure beyond the strip, which
adds q (2/pi) artanh((x - c)/h) to the slope in x and so h |sin theta| to the pressure. That is the equation of nearly full contact by its
gaps (contact.formulation.gaps), (1/pi) PV int s cot((theta - phi)/2)/2 = R - m on the gaps, int s = 0 on each: a gap at the border is one
about 0 or pi, in whose middle the slope of R jumps by -2 q h. With q = 0 it is the profile of the strip alone, cut off at its borders: a
contact that reaches a border ends there as at the corner of a punch, p ~ 1/sin(theta), where P is finite.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.fft

import sie
from contact.formulation.problem import Problem, minus_one
from sie import Array

TURN = 2 * np.pi
_BORDERS, _OF_SLOPE = np.array([0.0, np.pi]), np.ones(2, dtype=np.intp)
_KERNEL = sie.hilbert(TURN)


@dataclass(frozen=True, eq=False)
class StripTurn(sie.Kept):
    """A strip of a scaled problem about a centre, in so many even angles of half a turn."""

    problem: Problem
    centre: float
    points: int

    @cached_property
    def half(self) -> float:
        """Half the width of the strip."""
        assert self.problem.period is not None
        return 0.5 * self.problem.period

    @cached_property
    def angles(self) -> Array:
        return np.asarray(np.pi * (np.arange(self.points) + 0.5) / self.points)

    def x(self, angle: Array) -> Array:
        return np.asarray(self.centre - self.half * np.cos(angle))

    @cached_property
    def relief(self) -> Array:
        """H d/dtheta f at the angles."""
        return _conjugate_slope(self.problem.shape(self.x(self.angles)))

    @cached_property
    def by_centre(self) -> Array:
        """How that follows the centre."""
        return _conjugate_slope(self.problem.slope(self.x(self.angles)))

    def between(self, values: Array, angle: Array) -> Array:
        """Even functions given at the angles, at any: through four of these."""
        along = np.abs((angle + np.pi) % TURN - np.pi) * (self.points / np.pi) - 0.5
        first = np.floor(along).astype(np.intp)
        u = along - first
        out = np.zeros(np.shape(along))
        weights = -u * (u - 1) * (u - 2) / 6, (u + 1) * (u - 1) * (u - 2) / 2, -(u + 1) * u * (u - 2) / 2, (u + 1) * u * (u - 1) / 6
        for shift, weight in zip((-1, 0, 1, 2), weights, strict=True):
            at = first + shift
            at = np.where(at < 0, -1 - at, at)
            out += weight * values[np.where(at >= self.points, 2 * self.points - 1 - at, at)]
        return out

    def equation(self, values: Array | None, beyond: float, mean: float) -> sie.Equation:
        """Of the slope of the gap, or of its rates: on the right side what is given at the angles, less `beyond` |sin(theta)| and the
        mean."""

        def value(angle: Array) -> Array:
            given = np.zeros(np.shape(angle)) if values is None else self.between(values, angle)
            return np.asarray(given - beyond * np.abs(np.sin(angle)))

        right = sie.Forcing(value)
        if beyond != 0.0:
            right = sie.Forcing(value, jumps_at=_BORDERS, jumps=np.full(2, -2 * beyond), orders=_OF_SLOPE)
        conditions = sie.Amplitude(0, mean), sie.ZoneTotals(0.0)
        return sie.Equation(_KERNEL, right, conditions, (sie.Forcing(minus_one, modes=1),))

    def gaps_of(self, zones: Array) -> Array:
        """Gaps (n, 2) of a turn between zones of the strip; the first is that about 0, where there is one."""
        angle = np.arccos(np.clip((self.centre - zones) / self.half, -1.0, 1.0))
        inner = np.column_stack((angle[:-1, 1], angle[1:, 0]))
        first, last = float(angle[0, 0]), float(angle[-1, 1])
        left = np.array([[-first, first]] if first > 0.0 else np.zeros((0, 2)))
        right = np.array([[last, TURN - last]] if last < np.pi else np.zeros((0, 2)))
        return np.concatenate((left, inner, right, TURN - inner[::-1, ::-1]))

    def zones_of(self, gaps: Array) -> Array:
        """Zones (n, 2) of the strip between the gaps of a turn."""
        ends = np.sort(gaps.ravel())
        open_ = (bool(np.any((gaps[:, 0] < border) & (gaps[:, 1] > border))) for border in _BORDERS)
        left, right = ([] if gap else [border] for gap, border in zip(open_, _BORDERS, strict=True))
        return self.x(np.concatenate((left, ends[(ends > 0.0) & (ends < np.pi)], right)).reshape(-1, 2))


def _conjugate_slope(values: Array) -> Array:
    """H d/dtheta of an even function of the angle: k cos(k theta) for cos(k theta)."""
    waves = scipy.fft.dct(values, type=2)
    return np.asarray(scipy.fft.idct(waves * np.arange(len(values)), type=2))
