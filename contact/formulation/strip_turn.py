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

from collections.abc import Callable
from functools import cached_property

import numpy as np
import scipy.fft
from numpy.polynomial.chebyshev import chebval, chebvander

import sie
from contact.formulation.conjugate import Conjugate
from contact.formulation.problem import Problem, minus_one
from contact.formulation.quadrature import gauss
from sie import Array, Index, record

TURN = 2 * np.pi
_BORDERS, _OF_SLOPE = np.array([0.0, np.pi]), np.ones(2, dtype=np.intp)
# Of the smooth part: its modes; halvings towards the corners, nodes of a panel, and between two cuts.
_MODES, _GRADED, _IN_PANEL, _IN_CUT = 128, 18, 18, 8
# Angles at which the cotangent is a series.
_SMALL = 0.05
_KERNEL = sie.hilbert(TURN)


@record
class StripTurn(sie.Kept):
    """A strip of a scaled problem about a centre, in so many even angles of half a turn."""

    problem: Problem
    centre: float
    points: int

    @cached_property
    def half(self) -> float:
        """Half the width of the strip."""
        return 0.5 * self.problem.repeat_length

    @cached_property
    def angles(self) -> Array:
        return np.asarray(np.pi * (np.arange(self.points) + 0.5) / self.points)

    @classmethod
    def serves(cls, problem: Problem) -> bool:
        """Whether a strip is one of a half-plane, of a profile without corners."""
        profile = problem.profile
        return problem.operator.strip_rest is None and profile.support is None and len(profile.kinks) + len(profile.algebraic_points) == 0

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

    def relief_at(self, angle: Array) -> Array:
        """Roughly: between samples, whose waves end."""
        return self._between(self.relief, angle)

    def exact_at(self, angle: Array) -> Array:
        """H d/dtheta f = h |sin(theta)| R - M, R that of the whole period (contact.formulation.relief), which has all that is not smooth,

            M = (1/pi) int_0^pi f'(x) h sin(phi) (cot((theta + phi)/2) + h sin(theta) rest(x(theta) - x(phi))) dphi,

        rest(r) = (pi/L) cot(pi r/L) - 1/r: its kernel is singular in the corners of the square alone."""
        folded = np.abs((angle + np.pi) % TURN - np.pi)
        units = self.problem.units
        whole = np.asarray(self._whole(units.x(self.x(folded)))) / units.slope
        return np.asarray(self.half * np.sin(folded) * whole - chebval(2 * folded / np.pi - 1, self._smooth))

    @cached_property
    def _whole(self) -> Conjugate:
        return Conjugate(self.problem.profile)

    @cached_property
    def _smooth(self) -> Array:
        """Chebyshev coefficients of M."""
        units, profile, period = self.problem.units, self.problem.profile, 2 * self.half
        at = (units.scaled(np.asarray(profile.breakpoints)) - self.centre + self.half) % period - self.half
        feature = (profile.feature or units.length * period / 16) / units.length
        # Cut where the profile is, as close as it varies.
        even = np.linspace(-self.half, self.half, int(np.clip(period / feature, 512, 2**15)))
        cuts = np.arccos(np.clip(-np.concatenate((at, even)) / self.half, -1, 1))
        corner = 0.5 * np.pi * 0.5 ** np.arange(_GRADED)
        panels = np.concatenate(([0.0], corner[::-1], np.pi - corner[1:], [np.pi]))
        cuts = np.unique(np.concatenate((cuts, panels)))
        phi, weights = gauss(cuts, _IN_CUT)
        slope = self.problem.slope(self.x(phi)) * self.half * np.sin(phi) * weights / np.pi
        # The kernel is smooth in panels ever closer to the corners: what is under it is told by its moments there.
        first, width = np.searchsorted(phi, panels[:-1]), np.diff(panels)
        along = 2 * (phi - np.repeat(panels[:-1], np.diff(first, append=len(phi)))) / np.repeat(width, np.diff(first, append=len(phi))) - 1
        moments = np.add.reduceat(chebvander(along, _IN_PANEL - 1) * slope[:, None], first, axis=0)
        node = np.cos(np.pi * (np.arange(_IN_PANEL) + 0.5) / _IN_PANEL)
        moments[:, 0] *= 0.5
        carried = (moments @ chebvander(node, _IN_PANEL - 1).T * (2 / _IN_PANEL)).ravel()
        nodes = (panels[:-1, None] + 0.5 * width[:, None] * (1 + node)).ravel()
        theta = 0.5 * np.pi * (1 - np.cos(np.pi * (np.arange(_MODES) + 0.5) / _MODES))[:, None]
        rest = self.half * np.sin(theta) * _rest(self.x(theta) - self.x(nodes), period)
        values = (1 / np.tan(0.5 * (theta + nodes)) + rest) @ carried
        waves = scipy.fft.dct(values[::-1], type=2) / _MODES
        waves[0] *= 0.5
        return np.asarray(waves)

    def by_centre_at(self, angle: Array) -> Array:
        return self._between(self.by_centre, angle)

    def _between(self, values: Array, angle: Array) -> Array:
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

    def equation(self, given: Callable[[Array], Array] | None, beyond: float, mean: float) -> sie.Equation:
        """Of the slope of the gap, or of its rates: on the right side what is given, less `beyond` |sin(theta)| and the mean."""

        def value(angle: Array) -> Array:
            smooth = np.zeros(np.shape(angle)) if given is None else given(angle)
            return np.asarray(smooth - beyond * np.abs(np.sin(angle)))

        if beyond != 0.0:
            right = sie.Forcing(value, jumps_at=_BORDERS, jumps=np.full(2, -2 * beyond), orders=_OF_SLOPE)
        elif given is not None:
            at, heights, orders = self.jumps
            right = sie.Forcing(value, density_jumps_at=at, density_jumps=heights, density_orders=orders)
        else:
            right = sie.Forcing(value)
        conditions = sie.Amplitude(0, mean), sie.ZoneTotals(0.0)
        return sie.Equation(_KERNEL, right, conditions, (sie.Forcing(minus_one, modes=1),))

    @cached_property
    def jumps(self) -> tuple[Array, Array, Index]:
        """Those of the slope's first and second derivative by the angle, in a turn: places, heights, orders."""
        forcing = self.problem.forcing
        at = np.arccos(np.clip(-((forcing.jumps_at - self.centre + self.half) % (2 * self.half) - self.half) / self.half, -1, 1))
        # Of higher orders what goes with these is left.
        orders = np.zeros(0, dtype=np.intp) if forcing.orders is None else forcing.orders
        heights = forcing.jumps * (self.half * np.sin(at)) ** (orders + 1)
        mirrored = heights * (-1.0) ** orders
        return np.concatenate((at, TURN - at)), np.concatenate((heights, mirrored)), np.concatenate((orders, orders))

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

    def of_zones(self, gaps: Array, moved: Array, centre: float = 0.0) -> Array:
        """What motions of the ends of gaps (n, 2) in the angle, and one of the centre, do to the ends of the strip's zones, over the widths
        of these (n, 2): of a strip with a gap at either border."""
        ends, inside = gaps.ravel(), (gaps.ravel() > 0.0) & (gaps.ravel() < np.pi)
        order = np.argsort(ends[inside])
        moved = centre + (moved.ravel()[inside] * self.half * np.sin(ends[inside]))[order].reshape(-1, 2)
        return np.asarray(np.abs(moved) / np.diff(self.zones_of(gaps)))


def _conjugate_slope(values: Array) -> Array:
    """H d/dtheta of an even function of the angle: k cos(k theta) for cos(k theta)."""
    waves = scipy.fft.dct(values, type=2)
    return np.asarray(scipy.fft.idct(waves * np.arange(len(values)), type=2))


def _rest(lag: Array, period: float) -> Array:
    """(pi/L) cot(pi r/L) - 1/r."""
    turn = np.pi * lag / period
    small = np.abs(turn) < _SMALL
    away = np.where(small, 1.0, turn)
    square = turn * turn
    series = -turn * (1 / 3 + square * (1 / 45 + square * (2 / 945 + square * (1 / 4725 + square * 2 / 93555))))
    return np.asarray(np.pi / period * np.where(small, series, 1 / np.tan(away) - 1 / away))
