r"""Jumps of the density or of its derivatives inside the zones, in closed form.

Where the wanted density is known to jump, the right side has a logarithm. Positions are in half
widths w from the middle of a zone: t = cos(theta) of a point on the zone, z of a point off it, and
s = cos(phi) of the jump. For a point z, rho = z - sgn(z) sqrt(z^2 - 1). With

    eta(t) = theta/pi  (t > s),   theta/pi - 1  (t < s)
           = -(2/pi) sum_j (1/j) cos(j phi) sin(j theta),

which vanishes at both ends like a square root and jumps by 1 at s, the density h (t - s)^q eta(t)
has the transform

    (h/pi) ((t - s)^q ln(2 |t - s|) - P_q(t))                       on the zone,
    (h/pi) ((z - s)^q ln(1 - 2 rho cos(phi) + rho^2) - P_q(z))      off it,
    P_0 = 0,   P_1 = -s,   P_2 = -(t - 2 s) s - cos(2 phi)/4 = -s t + 3 s^2/2 + 1/4.

P_q follows from (tau - s)^q = (t - s)^q - (t - tau)(...) and the moments of eta, with tau the
variable of integration. Where the q-th derivative of the density jumps by J, the right side is
smooth once this transform, with h = J w^q / q!, is subtracted. If the density is the slope of a
gap, it jumps (q = 0) at a kink of the profile. Its derivatives jump where the curvature jumps
(q = 1) and at a knot of a cubic spline (q = 2).

For q = 0 the caller omits (J/pi) Lambda(x, s) from the values of the right side, with Lambda the
kernel's potential. `sie.jumps.logarithms` adds it. Logarithms outside a zone but close to it are
treated in `sie.jumps.exterior`.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from sie.basis.data import Array, Index, record
from sie.basis.interval import Complex, InPlane, OnLine, theta
from sie.basis.kernels import Kernel
from sie.basis.zones import Zones
from sie.jumps.exterior import ExteriorLogarithms, potential_series
from sie.jumps.formulas import HIGHEST, raised
from sie.jumps.logarithms import Logarithms
from sie.jumps.poles import NO_POLES
from sie.jumps.right_side import ForcingJumps, on_circle
from sie.jumps.spline import OPTIONS as SPLINES
from sie.jumps.spline import QuadraticSpline

# Number of Chebyshev coefficients c_l with which the potential of a spline, as part of the density,
# is computed. The coefficients decrease as l^-3.
_POTENTIAL_TERMS = SPLINES.coefficients_per_knot * SPLINES.min_density_jumps


@record
class DensityJumps(ForcingJumps):
    """Jumps J of q-th derivatives of the density, stored as J w^q / q! with the half width w.

    logarithms: terms of the right side that the jumps of order 0 cause, inside zones or not.
    """

    @classmethod
    def inside(
        cls,
        zones: Zones,
        at: Array,
        jumps: Array,
        orders: Index,
        kernel: Kernel,
        spline: Callable[[Array], Array] | None = None,
    ) -> "DensityJumps":
        """The given jumps that lie in zones. The positions `at` repeat with the kernel's period.

        spline: a quadratic spline with the jumps of order 2, if there is one.
        """
        found, kinks = cls.placed(zones, at, jumps, orders, kernel.period), orders == 0
        if np.any(kinks):
            weight = jumps[kinks] / np.pi
            at, i, inside = cls.located(zones, at[kinks], kernel.period)
            near = ExteriorLogarithms.near(zones, at, weight, kernel.period)
            found = replace(
                found,
                logarithms=Logarithms(kernel, zones, at, weight, np.where(inside, i, -1), near),
            )
        return (
            found
            if spline is None
            else found._with_splines(
                zones, spline, QuadraticSpline.inside, SPLINES.min_density_jumps
            )
        )

    @cached_property
    def _higher(self) -> ForcingJumps:
        """The jumps of the density's derivatives only."""
        return replace(self.chosen(self.order > 0), logarithms=None, poles=NO_POLES)

    @cached_property
    def _kinks(self) -> "DensityJumps":
        """The jumps of the density itself only."""
        return replace(self.chosen(self.order == 0), poles=NO_POLES)

    # The methods below give parts of the right side that jumps of the density cause.
    def smooth_part(self, zone: Index, left: Array) -> Array:
        out = -self._higher.carried(zone, left)
        if self.logarithms is not None:
            out += self.logarithms.on_zones(zone, left)
        return out - self.poles.own_transform(zone, left) if len(self.poles) else out

    def level_part(self, zone: Index, left: Array) -> Array:
        return np.zeros(left.shape)

    def mean_offsets(self, zones: Zones) -> Array:
        raise ValueError(
            "a condition on potentials cannot be combined with declared jumps of the density"
        )

    # The methods below give the part of the density that has the jumps.
    def integral_of(self, k: Index, left: Array, right: Array) -> Array:
        """Integral, from the left end to a point t, of the density h (t - s)^q eta of each jump.

        It is divided by half width * h / pi. It follows from the integral between the point t and
        the end that lies on the same side of the jump s as t. For t > s, this integral is

            int_t^1 (tau - s)^q eta dtau = (1/pi) int_0^theta (cos a - s)^q a sin(a) da.
        """
        s, q, on_right = self.s[k], self.order[k], left > self.left[k]
        inner = np.where(on_right, theta(left, right), theta(right, left))
        # For t < s the integral from the left end follows by the reflection t -> -t, s -> -s. If q
        # is odd, this changes the sign of (tau - s)^q.
        shift = np.where(on_right, s, -s)
        sine, cosine = np.sin(inner), np.cos(inner)
        first = sine - inner * cosine
        second = np.sin(2 * inner) / 8 - inner * np.cos(2 * inner) / 4
        third = (sine - sine**3 / 3 - inner * cosine**3) / 3
        square = third - 2 * shift * second + shift**2 * first
        part = np.where(q == 0, first, np.where(q == 1, second - shift * first, square))
        return np.where(on_right, self._totals[k] - part, np.where(q == 1, 1.0, -1.0) * part)

    @cached_property
    def _totals(self) -> Array:
        """Integral over the zone of the density of each jump, divided by half width * h / pi."""
        count, alone = len(self.zone), replace(self, height=np.full(len(self.zone), np.pi))
        return np.pi * alone.coefficients(np.arange(count), np.arange(count), count, 1)[:, 0]

    def _edge_slopes(self) -> tuple[Array, Array]:
        scale = self.height / np.pi
        return -scale * (-self.left) ** self.order, scale * self.right**self.order

    def high_coefficients(self, zones: Zones) -> Array:
        out = np.zeros((len(zones), _POTENTIAL_TERMS if self.splines else 0))
        for zone, spline in self.splines.items():
            out[zone] = spline.t_coefficients(_POTENTIAL_TERMS)
        return out

    # The methods below give potentials of the densities of jumps.
    def sharp_potential(self, zone: Index, seen: OnLine) -> Array:
        """Potential of the densities of jumps, poles and nearby logarithms, divided by w.
        w is the half width. The term c_0 log(w) is left out, where c_0 is the integral of the
        density, divided by pi w.

        On the zone rho = e^{i theta}. For q = 0 the formula comes from partial fractions of
        -sum_j (cos(j phi)/j) (-rho^{j-1}/(j-1) + rho^{j+1}/(j+1)). For other q see `_potential`.
        """
        rho = on_circle(seen)
        log, kinks = np.log(2 * np.abs(rho)), self._kinks
        out = kinks.summed(zone, lambda at, k: kinks.of_kinks(k, log[at], rho[at]).real)
        out += self._higher._closed_potential(zone, seen) + self.near.potential(zone, log, rho)
        return out + self.poles.potential(zone, seen) if len(self.poles) else out

    def of_kinks(self, k: Index, log: Any, rho: Any) -> Any:
        """Potential of the densities of the jumps k of order 0, divided by w h / pi.

        w: half width; h: height. The term c_0 log(w) is left out, where c_0 is the integral of the
        density, divided by pi w. log: log(2 rho).
        """
        up = np.exp(1j * self.phi[k])
        both = potential_series(up, rho) + potential_series(np.conj(up), rho)
        return np.real(up) * (log - rho**2 / 2) - both / 2

    # The methods below give values at complex points (see `sie.density.plane`).
    def logarithm(self, k: Index, seen: InPlane, away: Complex) -> Complex:
        """log(2 rho (zeta - s)) at points zeta, for jumps k at s; rho = zeta - sqrt(zeta^2 - 1).

        away: zeta - s.
        """
        with np.errstate(divide="ignore"):
            return np.asarray(np.log(2 * seen.rho[:, None] * away))

    def logarithm_slope(self, k: Index, seen: InPlane, away: Complex) -> Complex:
        """Derivative by zeta of `logarithm`, which is log(2 rho (zeta - s)) for jumps k at s."""
        return np.asarray(1 / away - 1 / seen.root[:, None])

    def plane_potential(self, k: Index, seen: InPlane, away: Complex, log: Complex) -> Complex:
        """Potential of the densities of the jumps k, divided by the half width w.
        The term c_0 log(w) is left out, where c_0 is the integral of the density, divided by pi w.
        """
        higher = self.order[k] > 0
        out = super().plane_potential(k[higher], seen, away[:, higher], log[:, higher])
        kinks = k[~higher]
        return np.asarray(
            out
            + self.of_kinks(kinks, np.log(2) - seen.log[:, None], seen.rho[:, None])
            @ (self.height[kinks] / np.pi)
        )

    # The methods below override factors in the closed forms of `PlacedJumps`. There the right side
    # has the jumps; here the density has them.
    @cached_property
    def line(self) -> tuple[Array, Array]:
        first, second = self.order == 1, self.order == HIGHEST
        return np.where(second, 1.5 * self.s**2 + 0.25, np.where(first, -self.s, 0.0)), np.where(
            second, -self.s, 0.0
        )

    def turn(self, k: Index, away: Array) -> Array:
        # At the jump itself the power (t - s)^q is zero for q > 0. A finite value replaces the
        # logarithm there, so that the product of power and logarithm is zero.
        with np.errstate(divide="ignore"):
            return np.log(np.where((away == 0) & (self.order[k] > 0), 1.0, 2 * np.abs(away)))

    def turn_off(self, k: Index, rho: Array) -> Array:
        # The result is log |1 - rho e^(i phi)|^2. It is computed from the jump's distance to that
        # end of the zone which is nearer to the point. Both terms are then positive, so that
        # nothing cancels.
        end = np.where(rho > 0, self.right[k], self.left[k])
        return np.asarray(np.log((1 - np.abs(rho)) ** 2 + 2 * np.abs(rho) * end))

    def _densities(self, zone: Index, left: Array, right: Array) -> Array:
        return self.summed(zone, lambda at, k: self.of_density(k, left[at], right[at]))

    def shape(self, k: Index, left: Array, right: Array) -> Array:
        """pi times the factor eta of a density (t - s)^q eta with a jump at s, at t = cos(theta).
        The result is theta for t > s and theta - pi for t < s.
        """
        away, from_right, from_left = left - self.left[k], theta(left, right), theta(right, left)
        return np.where(
            away == 0, 0.5 * (from_right - from_left), np.where(away > 0, from_right, -from_left)
        )

    def _potential(self, q: int, k: Index, parts: tuple[Any, ...]) -> Any:
        """Potential of the densities of jumps k of order q = 1 or 2: a primitive of the transform.

        Of all primitives it is the one that behaves as -c_0 ln(2 |rho|) far away. With
        L = ln(1 - 2 rho cos(phi) + rho^2), R = sgn(z) sqrt(z^2 - 1) and g = -ln|rho| = int dz / R,
        it is

            (z - s)^(q+1) (L / (q+1) - 1 / (q+1)^2) + int (z - s)^(q+1) / R dz / (q+1) - int P_q dz
            + C_q,

        with a constant C_q. On the zone R = g = 0. parts: z - s, z, L, g and R.
        """
        away, z, turn, grown, root = parts
        s, g = self.s[k], grown
        main = raised(away, q + 1) * (turn / (q + 1) - 1 / (q + 1) ** 2)
        if q == 1:
            rest = (
                0.5 * (0.5 * (z * root + g) - 2 * s * root + s * s * g)
                + s * z
                - (0.25 + 0.5 * s * s) * np.log(2)
                - 0.5 * s * s
            )
        else:
            turned = (z * z + 2) * root / 3 - 1.5 * s * (z * root + g) + s * s * (3 * root - s * g)
            double = np.cos(2 * self.phi[k])
            constant = (
                -(3 * s + np.cos(3 * self.phi[k]) / 3) / 12
                + s * double / 4
                - s**3
                + (1.5 * s + s**3) / 9
                + 0.25 * s
            )
            rest = (
                turned / 3
                + s * z * (0.5 * z - 2 * s)
                + 0.25 * z * double
                + (0.5 * s + s**3 / 3) * np.log(2)
                - constant
            )
        return main + rest

    def sine_weights(self, k: Index, j: Array) -> Array:
        # Angles are measured from the nearer end, so that multiples of small angles keep all
        # digits.
        from_left = (self.psi < self.phi)[k][:, None]
        cosines = np.cos(j * np.minimum(self.phi, self.psi)[k][:, None])
        return np.asarray(np.where(from_left & (j % 2 == 1), cosines, -cosines))
