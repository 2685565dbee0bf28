"""Equations of the paper that only tests use, as proved and as printed.

I. G. Goryacheva & I. Tsukanov, Front. Mech. Eng. 6 (2020) 45, doi 10.3389/fmech.2020.00045. Here
are the pressure of a round spot, (1) and (3); the localization principle for any shape, (6)-(17),
by quadrature; and Johnson's almost full contact, which the paper's results section names.

By the localization principle, the surface outside a strip of width L acts with its nominal pressure
P_s/L. This pressure bends the half-plane under the zone, so that the zone is an isolated one of the
profile h with

    (13) h'(x) = f'(x) + (4 P_s/pi E* L) artanh(2x/L).

Where the print and the proof differ, the plain name is the proved form. A name that begins with
`printed` (or `Printed`) is the form of the paper, so that both can be computed.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np

from contact.axisymmetric.quadrature import panels
from contact.paper import FIRST_ORDER, LocalizedPair, OneZone
from contact.reference.exact import Westergaard, correction_load, correction_pressure
from contact.reference.exact.numerics import FROM_LEFT, FROM_RIGHT, WEIGHT
from contact.reference.exact.pair import tips_slope


def strip_slope(x, strip, period, mean_pressure, E_star):
    """(12) summed: the slope u'(x) of the half-plane under a pressure p on |x| < b of every period.

    u' = -(2 p/pi E*) ln|sin(pi (x + b)/L)/sin(pi (x - b)/L)|,   strip = 2b;

    The slope is zero everywhere if 2b = L: a uniform pressure on the whole surface bends nothing.
    """
    x, b = np.asarray(x, dtype=float), 0.5 * strip
    ratio = np.sin(pi * (x + b) / period) / np.sin(pi * (x - b) / period)
    return np.asarray(-2.0 * mean_pressure / (pi * E_star) * np.log(np.abs(ratio)))


def printed_strip_slope(x, strip, period, mean_pressure, terms=4000):
    """(12) as printed, u' = (4 p/pi) sum sin(2 pi n b/L) sin(2 pi n x/L)/n.

    The factor 1/E* is missing, and the sign is the opposite one.
    """
    n = np.arange(1, terms + 1)
    waves = np.sin(2.0 * pi / period * np.multiply.outer(np.asarray(x, dtype=float), n))
    return np.asarray(4.0 / pi * mean_pressure * (waves @ (np.sin(pi * n * strip / period) / n)))


def neighbour_slope(x, period, nominal_load, E_star):
    """f2'(x) of (10) and (13): (4 P_s/pi E* L) artanh(2x/L).

    It is the slope that the pressure outside the strip causes.
    """
    return np.asarray(
        4.0 * nominal_load / (pi * E_star * period) * np.arctanh(2.0 / period * np.asarray(x))
    )


def cauchy_slope(pressure_at, half_width, E_star, t):
    """(6) for h': (2/pi E*) PV int p(xi)/(x - xi) dxi at x = a t.

    pressure_at: p as a function of t in [-1, 1]; it is bounded at both ends.
    """
    n = 400
    phi = np.arange(1, n) * pi / n
    # p = sum c_k sin(k phi), and sin(k phi) = sqrt(1 - t^2) U_(k-1) has the transform T_k.
    coefficients = 2.0 / n * (np.sin(np.outer(np.arange(1, n), phi)) @ pressure_at(np.cos(phi)))
    angle = np.arccos(np.asarray(t, dtype=float))
    return np.asarray(
        2.0 / E_star * (np.cos(np.multiply.outer(angle, np.arange(1, n))) @ coefficients)
    )


def printed_cauchy_slope(pressure_at, half_width, E_star, t):
    """(6) as printed, with 1/2pi for 1/pi: half of the slope, which contradicts (7)."""
    return 0.5 * cauchy_slope(pressure_at, half_width, E_star, t)


@dataclass(frozen=True)
class LocalizedShape:
    """(13)-(17) by quadrature, for any odd slope f'(x) without jumps except at x = 0.

    (16) P = P0 + P_s (L - sqrt(L^2 - 4a^2))/L,   P0 = (E*/2) int f' x dx/sqrt(a^2 - x^2),
    (17) p = p0 + (2 P_s/pi L) arctan(2 sqrt(a^2 - x^2)/sqrt(L^2 - 4a^2)),   p0 by (7).

    closure: P_s = P0 ("first-order", as in the paper's examples) or P_s = P ("self-consistent").
    """

    slope: object
    E_star: float
    period: float
    half_width: float
    closure: str = FIRST_ORDER

    @property
    def isolated_load(self):
        """P0, the first term of (16)."""
        angle, x = 0.5 * pi * FROM_LEFT, self.half_width * np.sin(0.5 * pi * FROM_LEFT)
        return float(
            self.E_star
            * np.sum(0.5 * pi * WEIGHT * self.slope(x) * self.half_width * np.sin(angle))
        )

    @property
    def load(self):
        """(16) with the closure's P_s."""
        if self.closure == FIRST_ORDER:
            return self.isolated_load + correction_load(
                self.half_width, self.period, self.isolated_load
            )
        a = self.half_width
        return (
            self.isolated_load
            * self.period
            / sqrt((self.period - 2.0 * a) * (self.period + 2.0 * a))
        )

    @property
    def nominal_load(self):
        """P_s."""
        return self.isolated_load if self.closure == FIRST_ORDER else self.load

    @property
    def mean_pressure(self):
        return self.load / self.period

    def contact_slope(self, x):
        """h'(x) by (13)."""
        x = np.asarray(x, dtype=float)
        return self.slope(x) + neighbour_slope(x, self.period, self.nominal_load, self.E_star)

    def printed_contact_slope(self, x):
        """(8) as printed, h = delta - (f + f2): with this sign, (7) gives a negative pressure."""
        return -self.contact_slope(x)

    def isolated_pressure(self, x):
        """p0 by (7), folded onto 0 < xi < a, with q = sqrt(a^2 - x^2).

        f'(x) is subtracted under the integral; its own integral is f'(x) ln((a + q)/(a - q)).
        """
        return self._inverse(np.asarray(np.abs(np.asarray(x, dtype=float))), self.slope)

    def pressure(self, x):
        """(17), 0 outside the zone."""
        r = np.abs(np.asarray(x, dtype=float))
        return np.where(r < self.half_width, self.isolated_pressure(r) + self._correction(r), 0.0)

    def pressure_14(self, x):
        """The pressure by (14), which agrees with (17): (7) with h' in place of f'."""
        r = np.abs(np.asarray(x, dtype=float))
        return np.where(r < self.half_width, self._inverse(r, self.contact_slope), 0.0)

    def _correction(self, x):
        return correction_pressure(x, self.half_width, self.period, self.nominal_load)

    def _inverse(self, x, slope):
        a = self.half_width
        inside = np.where(x < a, x, 0.5 * a)
        q = np.sqrt((a - inside) * (a + inside))
        own = slope(inside)
        with np.errstate(divide="ignore", invalid="ignore"):
            singular = np.where(
                own == 0.0, 0.0, own * 2.0 * np.arcsinh(q / np.where(inside > 0.0, inside, 0.0))
            )
        # With xi = a sin(psi), `quotient` is the integrand. It is smooth except for x = 0. Each
        # side of x has its own quadrature.
        top = np.arcsin(inside / a)
        regular = np.zeros_like(inside)
        for low, width in ((np.zeros_like(top), top), (top, 0.5 * pi - top)):
            psi = low[..., None] + width[..., None] * FROM_LEFT
            # xi - x = 2 a cos((psi + top)/2) sin((psi - top)/2). psi - top is computed from the
            # distance to the common end of the two parts, without cancellation.
            apart = width[..., None] * (FROM_LEFT if low is top else -FROM_RIGHT)
            xi = a * np.sin(psi)
            gap = 2.0 * a * np.cos(0.5 * (psi + top[..., None])) * np.sin(0.5 * apart)
            quotient = (slope(xi) - own[..., None]) * 2.0 * xi / (gap * (xi + inside[..., None]))
            regular += width * np.sum(WEIGHT * np.where(gap == 0.0, 0.0, quotient), axis=-1)
        return np.asarray(self.E_star / (2.0 * pi) * (singular + q * regular))


@dataclass(frozen=True)
class PrintedLocalizedShape(LocalizedShape):
    """(17) with its brackets as printed in the paper, which are wrong.

    There (xi - x) stands behind the fraction of the integrand, as a factor. So the first term is

    (E*/2pi) sqrt(a^2 - x^2) int f'(xi) (xi - x) dxi/sqrt(a^2 - xi^2) = sqrt(a^2 - x^2) P0/pi.

    It has the wrong dimension and is the same semi-ellipse for every shape.
    """

    def isolated_pressure(self, x):
        x = np.asarray(x, dtype=float)
        under = np.maximum(self.half_width**2 - x * x, 0.0)
        return np.asarray(np.sqrt(under) * self.isolated_load / pi)


@dataclass(frozen=True)
class PrintedWestergaard(Westergaard):
    """(18) as printed, with the factor sqrt(2 pi E* Delta)/L instead of sqrt(2) pi E* Delta/L.

    The root sign is drawn too far, and the factor has the dimension of sqrt(Pa/m). In a given
    system of units, this pressure is 1/sqrt(pi E* Delta) times the pressure whose mean is (19).
    """

    def pressure(self, x):
        """(18) as printed, 0 outside the zone."""
        u = 2.0 * pi / self.period * self._reduced(x)
        below = np.cos(u) - np.cos(2.0 * pi / self.period * self.half_width)
        factor = sqrt(2.0 * pi * self.E_star * self.amplitude) / self.period
        return np.asarray(factor * np.cos(0.5 * u) * np.sqrt(np.maximum(below, 0.0)))


@dataclass(frozen=True)
class AlmostFullWave:
    """Almost full contact by K. L. Johnson (1985), sec. 13.2.

    The gap of half-width b = L/2 - a is an isolated crack in the pressure of full contact. Its
    stress intensity vanishes if

    mean pressure = p* (1 - (pi b/L)^2),   p* = pi E* Delta/L.

    The exact (19) has sin^2(pi b/L) instead of (pi b/L)^2. The paper's results section names this
    formula for 2a/L above 0.7.
    """

    amplitude: float
    period: float
    E_star: float
    half_width: float

    @property
    def mean_pressure(self):
        gap = pi * (0.5 - self.half_width / self.period)
        return pi * self.E_star * self.amplitude / self.period * (1.0 - gap * gap)


@dataclass(frozen=True)
class PrintedLocalizedWedge(OneZone):
    """(26) as printed, with arcosh(a/x): correct for x > 0, and nan for x < 0."""

    def pressure(self, x):
        """(26) as printed; nan on the left half of the zone."""
        x = np.asarray(x, dtype=float)
        inside = np.abs(x) < self.half_width
        with np.errstate(divide="ignore", invalid="ignore"):
            own = np.arccosh(np.where(inside, self.half_width / x, 1.0))
        alone = self.E_star * self.isolated.wedge_slope / pi
        return np.where(
            inside, alone * own + (super().pressure(x) - self.isolated.pressure(x)), 0.0
        )


def contact_slope(pair, x):
    """h'(x) of (35) for a pair of zones in the middle of its strip."""
    a, b = pair.ends
    bend = neighbour_slope(x, pair.period, pair.period * pair._nominal(b - a), pair.E_star)
    return tips_slope(x, pair.radius, pair.spacing) + bend


@dataclass(frozen=True)
class PrintedArtanhPair(LocalizedPair):
    """(36) as printed, for zones with the ends of `LocalizedPair`.

    It is one integral over [a, b] with 1/(xi - x) and E*/2pi. The corrected form also has the term
    of the other zone, which is missing here: -(E* sqrt(Z)/2pi) int_a^b h' dxi/((xi + x) sqrt(Z)).
    """

    def pressure(self, x):
        """(36) as printed for a <= |x| <= b; 0 outside."""
        r = np.abs(np.asarray(x, dtype=float))
        pair = self.pair
        n = len(pair.ratio)
        theta = (np.arange(n) + 0.5) * pi / n
        xi = np.sqrt((pair.middle - pair.half) + 2.0 * pair.half * np.cos(0.5 * theta) ** 2)
        # dxi/sqrt(Z) = dtheta/2 xi
        own = contact_slope(self, xi) / (2.0 * xi) * pi / n
        a, b = self.ends
        root = np.sqrt(np.maximum((b - r) * (b + r) * (r - a) * (r + a), 0.0))
        other = np.sum(own / (xi + r[..., None]), axis=-1)
        return pair.pressure(r) + self.E_star * root / (2.0 * pi) * other


def direct_kernel(r, s, a, apart=None):
    """(3): H1(r, s) = int_0^2pi (2 s/(pi D)) arctan(sqrt(a^2 - r^2) sqrt(a^2 - s^2)/(a D)) dtheta,
    D^2 = r^2 - 2 r s cos theta + s^2.

    It is infinite where r = s. apart: |r - s|, if it is known more accurately than by subtraction.
    """
    r, s = np.broadcast_arrays(np.asarray(r, dtype=float), np.asarray(s, dtype=float))
    d = np.abs(r - s) if apart is None else apart
    # D^2 = d^2 + 4 r s sin^2(theta/2) is nearly singular at theta = 0. So panels end at angles
    # of the order d/(r + s) and sqrt(d/(r + s)).
    scale = np.sqrt(np.clip(d / np.maximum(r + s, 1e-300), 1e-30, 1.0))
    theta, weight = panels([np.zeros_like(d), pi * scale**2, pi * scale, np.full_like(d, pi)])
    D = np.sqrt(d[..., None] ** 2 + 4.0 * (r * s)[..., None] * np.sin(0.5 * theta) ** 2)
    reach = (np.sqrt((a - r) * (a + r)) * np.sqrt((a - s) * (a + s)))[..., None]
    inner = np.arctan2(reach, a * D) / np.maximum(D, 1e-300)
    return 4.0 * s / pi * np.sum(weight * inner, axis=-1)


def direct_pressure(profile, E_star, a, r):
    """(1) of an isolated spot of a shape without edges, at radii 0 < r < a.

    p_f(r) = (E*/4 pi) int_0^a Laplacian f(s) H1(r, s) ds

    Abel transforms are not used. The paper prints the factor E*/(4 pi^2). With H1 as printed, only
    the factor E*/(4 pi) gives Hertz's pressure for f = r^2/(2R).
    """
    total = np.zeros(r.shape)
    for width, border, sign in ((r, 0.0, -1.0), (a - r, a, 1.0)):
        # Nodes on one side of r. Close to r, they are computed from their distance to r.
        apart = width[..., None] * FROM_LEFT
        s = np.where(
            FROM_RIGHT < 0.5,
            border - sign * width[..., None] * FROM_RIGHT,
            r[..., None] + sign * apart,
        )
        kernel = direct_kernel(np.broadcast_to(r[..., None], s.shape), s, a, apart)
        total = total + np.sum(
            width[..., None] * WEIGHT * profile.r_laplacian(s) / s * kernel, axis=-1
        )
    return E_star / (4.0 * pi) * total
