"""Positions of jumps in zones, and the closed forms derived in `sie.jumps.right_side`."""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray
from scipy.special import comb

from sie.basis.data import DIGITS, Array, Index, Mask, record
from sie.basis.interval import Outside, theta
from sie.basis.sums import OPTIONS as BLOCKS
from sie.basis.sums import PerZone

HIGHEST = 2


@dataclass(frozen=True)
class JumpOptions:
    """Limits that decide between closed forms and series for jumps and singular points."""

    # Singular points outside a zone, within this many half widths of the zone, are treated in
    # closed form. The effect of more distant points is smooth on the zone. Values from 0.3 to 1
    # work equally well.
    reach: float = 0.5
    # At points with |rho| below one of these limits, one series for all jumps of a zone replaces
    # the closed forms; rho = zeta - sqrt(zeta^2 - 1). Below the first limit closed forms lose
    # digits. The other two apply from `far_jumps` jumps on a zone, where the series is faster.
    far_rho: tuple[float, ...] = (0.25, 0.6, 0.87)
    far_jumps: tuple[int, ...] = (10, 36)

    @property
    def far_terms(self) -> Index:
        """Number of terms of the series whose last term is round-off at |rho| = each `far_rho`."""
        return np.ceil(DIGITS / -np.log(self.far_rho)).astype(np.intp)


OPTIONS = JumpOptions()


@record
class PlacedJumps(PerZone):
    """Jumps of a function or of derivatives of this function, at places inside the zones.

    zone: zone of each jump; left, right: distances from the zone's ends in half widths w; order: q,
    the number of the derivative that jumps; height: h = J w^q / q!, with J the size of the jump.
    """

    zone: Index
    left: Array
    right: Array
    height: Array
    order: Index

    @staticmethod
    def nothing() -> tuple[Index, Array, Array, Array, Index]:
        """The fields of an empty set of jumps."""
        none, places = np.zeros(0, np.intp), np.zeros(0)
        return none, places, places, places, none

    def chosen(self, which: Mask | Index) -> Self:
        """The jumps selected by `which`, a mask or an array of indices."""
        zone, left, right = self.zone[which], self.left[which], self.right[which]
        return replace(
            self,
            zone=zone,
            left=left,
            right=right,
            height=self.height[which],
            order=self.order[which],
        )

    @cached_property
    def phi(self) -> Array:
        """Angle phi of each jump, whose place in the zone is s = cos(phi)."""
        return theta(self.left, self.right)

    @cached_property
    def psi(self) -> Array:
        """The angle pi - phi of each jump from the left end, without cancellation."""
        return theta(self.right, self.left)

    @cached_property
    def sine(self) -> Array:
        """sin(phi), with the angle phi of each jump, without cancellation close to either end."""
        return np.asarray(np.sin(np.minimum(self.phi, self.psi)))

    @cached_property
    def s(self) -> Array:
        return 0.5 * (self.left - self.right)

    # The methods below give factors of the closed forms, for jumps k and points. The arrays of
    # jumps and of points are broadcast against each other.
    @cached_property
    def line(self) -> tuple[Array, Array]:
        """(constant, slope) of the polynomial P_q(t) in the transform of each jump of order q."""
        first, second = self.order == 1, self.order == HIGHEST
        return np.where(second, -1.5 * self.s, first) * self.sine, np.where(second, self.sine, 0.0)

    def polynomial(self, k: Index, t: NDArray[Any]) -> NDArray[Any]:
        """The polynomial P_q(t) in the transform of jumps k of order q, at places t."""
        constant, slope = self.line
        return np.asarray(slope[k] * t + constant[k])

    def turn(self, k: Index, away: Array) -> Array:
        """The factor of (t - s)^q in the transform at points t on the zone, for a jump at s.
        q: order of the jump.

        away: t - s.
        """
        return np.where(away > 0, self.psi[k], -self.phi[k])

    def turn_off(self, k: Index, rho: Array) -> Array:
        """The factor of (z - s)^q in the transform at points z off the zone, for a jump at s.
        q: order of the jump.
        """
        return np.asarray(2 * np.arctan2(rho * self.sine[k], 1 - rho * np.cos(self.phi[k])))

    def shape(self, k: Index, left: Array, right: Array) -> Array:
        """The function log(sin((theta + phi)/2) / |sin((theta - phi)/2)|) of jumps k at cos(phi).
        The points cos(theta) are given by their distances from the zone's ends.
        """
        return kappa(
            np.sqrt(right * self.left[k]), np.sqrt(left * self.right[k]), left - self.left[k]
        )

    # The methods below give the densities that jumps k cause, and transforms, integrals and
    # potentials of these densities, divided by `height` / pi.
    def on_zone(self, k: Index, left: Array) -> Array:
        """Transform, on the zone, of the densities of jumps k, divided by (height / pi)."""
        away = left - self.left[k]
        return self.turn(k, away) * power(away, self.order[k]) - self.polynomial(k, left - 1)

    def off_zone(self, k: Index, z: Array, rho: Array) -> Array:
        """Transform, off the zone, of the densities of jumps k, divided by (height / pi)."""
        return power(z - self.s[k], self.order[k]) * self.turn_off(k, rho) - self.polynomial(k, z)

    def of_density(self, k: Index, left: Array, right: Array) -> Array:
        """Density (t - s)^q kappa(t) of jumps k at s, of order q.
        The function `kappa` of this file gives kappa(t), a logarithm.
        """
        away, q = left - self.left[k], self.order[k]
        with np.errstate(invalid="ignore"):
            return np.where((away == 0) & (q > 0), 0.0, power(away, q) * self.shape(k, left, right))

    def integral_of(self, k: Index, left: Array, right: Array) -> Array:
        """Integral over t, from the left end, of the densities of jumps k; for order 0 only.

        An antiderivative of kappa(t) is (t - s) kappa - theta sin(phi).
        """
        if np.any(self.order[k] > 0):
            raise ValueError(
                "the integral along a zone is not known for jumps of derivatives of the right "
                "side: only the right side itself may jump"
            )
        away = left - self.left[k]
        with np.errstate(invalid="ignore"):
            return np.where(away == 0, 0.0, away * self.shape(k, left, right)) + self.sine[
                k
            ] * theta(right, left)

    def potential_on(self, k: Index, left: Array, right: Array) -> Array:
        """Potential of the densities of jumps k on the zone, divided by w h / pi.
        w: half width of the zone; h: height of the jump.

        It lacks the term c_0 log(w), where c_0 is the integral of the density, divided by pi w.
        """
        away, nothing = left - self.left[k], np.zeros_like(left)
        return np.asarray(
            self.potential_of(k, away, 0.5 * (left - right), self.turn(k, away), nothing, nothing)
        )

    def potential_off(self, k: Index, left: Array, right: Array, rho: Array) -> Array:
        """Potential of the densities of jumps k off the zone, divided by w h / pi.
        w: half width of the zone; h: height of the jump.

        It lacks the term c_0 log(w), where c_0 is the integral of the density, divided by pi w.
        """
        seen = Outside(np.where(left > 0, 1.0, -1.0), np.maximum(-left, -right))
        return np.asarray(
            self.potential_of(
                k,
                left - self.left[k],
                0.5 * (left - right),
                self.turn_off(k, rho),
                seen.log,
                seen.root,
            )
        )

    def potential_of(self, k: Index, away: Any, z: Any, turn: Any, grown: Any, root: Any) -> Any:
        """The potentials of the densities of jumps k, in closed form, at real or complex points.

        away: z - s; turn, grown, root: the functions F, A and B of `sie.jumps.right_side`.
        """
        orders = self.order[k]
        if np.all(orders == orders[:1]):
            return (
                self._potential(int(orders[0]), k, (away, z, turn, grown, root)) if len(k) else turn
            )
        parts, out = np.broadcast_arrays(away, z, turn, grown, root), np.empty_like(turn)
        for q in np.unique(orders).tolist():
            of = np.flatnonzero(orders == q)
            out[..., of] = self._potential(q, k[of], tuple(part[..., of] for part in parts))
        return out

    def _potential(self, q: int, k: Index, parts: tuple[Any, ...]) -> Any:
        """The potentials, in closed form, of the densities of jumps k that all have the order q."""
        away, z, turn, grown, root = parts
        s, sine = self.s[k], self.sine[k]
        if q == 0:
            rest = grown - np.log(2) - 1
        elif q == 1:
            rest = 0.5 * (root - s * grown) - z + s * (0.75 + 0.5 * np.log(2))
        else:
            square = sine * sine
            rest = (grown * (0.5 + s * s) + root * (0.5 * z - 2 * s)) / 3 - z * (0.5 * z - 1.5 * s)
            rest = rest + (square / 9 - s * s / 2 - 1 / 12 - np.log(2) * (square / 6 + s * s / 2))
        return raised(away, q + 1) * turn / (q + 1) + sine * rest

    # The methods below give series, in sines or Chebyshev polynomials, of the density of jumps k.
    def sine_weights(self, k: Index, j: Array) -> Array:
        """Weights b_j in the density (h/pi) sum_j (2/j) b_j sin(j theta) of jumps k of order 0.

        h: height of the jump; theta: angle of the place t = cos(theta) on the zone.
        """
        from_left = (self.psi < self.phi)[k][:, None]
        sines = np.sin(j * np.minimum(self.phi, self.psi)[k][:, None])
        return np.asarray(np.where(from_left & (j % 2 == 0), -sines, sines))

    def coefficients(self, k: Index, row: Index, rows: int, count: int) -> Array:
        """Coefficients (rows, count) of T_l / sqrt(1 - t^2) in the density of jumps.
        A row is the sum over those jumps k whose `row` is its index.

        (t - s)^q is expanded in powers of t. So only one series for each row is multiplied by t,
        not one for each jump.
        """
        highest = int(self.order[k].max(initial=0))
        j = np.arange(1.0, count + highest + 2)
        powers = np.zeros((highest + 1, rows, len(j)))
        order = np.argsort(row, kind="stable")
        block = max(1, BLOCKS.memory_pairs // len(j))
        for begin in range(0, len(k), block):
            part = order[begin : begin + block]
            some, into = k[part], row[part]
            first = np.flatnonzero(np.diff(into, prepend=-1))
            sines = self.sine_weights(some, j) * (2 / (np.pi * j))
            q, s = self.order[some], self.s[some]
            for power in range(int(q.max()) + 1):
                weight = self.height[some] * comb(q, power) * (-s) ** np.maximum(q - power, 0)
                powers[power, into[first]] += np.add.reduceat(
                    weight[:, None] * sines, first, axis=0
                )
        c = of_sines(powers[highest])
        for series in powers[:highest][::-1]:
            c = _times_t(c) + of_sines(series)
        return np.asarray(c[:, :count])


def kappa(up: Array, vp: Array, away: Array) -> Array:
    """log(sin((theta + phi)/2) / |sin((theta - phi)/2)|) at t = cos(theta), with s = cos(phi).

    up is sqrt((1 - t) (1 + s)), vp is sqrt((1 + t) (1 - s)) and away is t - s. The sum and the
    difference of up and vp are 2 sin((theta +- phi)/2). The product of these two sines is
    (s - t)/2, which away gives without cancellation.
    """
    small, large = np.minimum(up, vp), np.maximum(up, vp)
    with np.errstate(divide="ignore", invalid="ignore"):
        # If the jump or the point is close to an end, 2 artanh(small / large) keeps all digits.
        far = 2 * np.arctanh(np.minimum(small / large, 0.5))
        return np.where(small < 0.5 * large, far, np.log((up + vp) ** 2 / (2 * np.abs(away))))


def power(away: Array, order: Index) -> Array:
    """The power away^order, for orders 0, 1 and 2.

    Products are ten times as fast as general powers. Knots of splines need squares only.
    """
    return (
        away * away
        if np.all(order == HIGHEST)
        else np.where(order == 0, 1.0, np.where(order == 1, away, away * away))
    )


def raised(away: Any, q: int) -> Any:
    """The power away^q, computed by products."""
    return math.prod([away] * (q - 1), start=away)


def of_sines(beta: Array) -> Array:
    """Coefficients of T_l / sqrt(1 - t^2), l >= 0, from those of sin(j theta), j >= 1.
    Both series describe the same function of t = cos(theta).

    The sum acts along the last axis.
    """
    c = 0.5 * beta
    c[..., 2:] -= 0.5 * beta[..., :-2]
    return np.asarray(c)


def _times_t(c: Array) -> Array:
    """Chebyshev coefficients of the product t sum c_l T_l, without the last coefficient."""
    out = np.zeros_like(c)
    out[:, 1:] += 0.5 * c[:, :-1]
    out[:, 1] += 0.5 * c[:, 0]
    out[:, :-1] += 0.5 * c[:, 1:]
    return out
