"""Jumps within zones: where they are, and the closed forms of each, at any points that broadcast
with them; see `forcing`.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from sie.basis.data import DIGITS, Array, Index, Mask, record
from sie.basis.interval import LOG2, Outside, theta
from sie.basis.sums import OPTIONS as BLOCKS
from sie.basis.sums import PerZone

HIGHEST = 2
# Of q over p; zero for p > q.
_BINOMIAL = np.array([[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 2.0, 1.0]])


@dataclass(frozen=True)
class JumpOptions:
    """When jumps and singular points are carried in closed form, and when by their series."""

    # Singular points outside a zone nearer than this many half widths are carried in closed form;
    # farther ones are smooth on the zone. Insensitive: 0.3 to 1.
    reach: float = 0.5
    # Values of |rho| below which closed forms cancel, and the series of all jumps of a zone is
    # summed. The next larger value pays off from `far_jumps` jumps on.
    far_rho: tuple[float, ...] = (0.25, 0.6, 0.87)
    far_jumps: tuple[int, ...] = (10, 36)
    # Coefficients of the potential of a spline of the density: they fall as l^-3.
    potential_terms: int = 1024

    @property
    def far_terms(self) -> Index:
        """Terms of the series for each `far_rho`, down to round-off."""
        return np.ceil(DIGITS / -np.log(self.far_rho)).astype(np.intp)


OPTIONS = JumpOptions()


@record
class Jumps(PerZone):
    """Jumps inside the zones: zone index, distances from the zone's ends over w, h = J w^q / q!,
    and q.
    """

    zone: Index
    left: Array
    right: Array
    height: Array
    order: Index

    @staticmethod
    def nothing() -> tuple[Index, Array, Array, Array, Index]:
        """Fields of no jumps."""
        none, places = np.zeros(0, np.intp), np.zeros(0)
        return none, places, places, places, none

    def chosen(self, which: Mask | Index) -> Self:
        """Those of the jumps alone."""
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
        """Angle of each jump, s = cos(phi)."""
        return theta(self.left, self.right)

    @cached_property
    def psi(self) -> Array:
        """pi - phi, to all its digits beside the left end."""
        return theta(self.right, self.left)

    @cached_property
    def sine(self) -> Array:
        """sin(phi), to all its digits beside either end."""
        return np.asarray(np.sin(np.minimum(self.phi, self.psi)))

    @cached_property
    def s(self) -> Array:
        return 0.5 * (self.left - self.right)

    # jumps k at points
    @cached_property
    def line(self) -> tuple[Array, Array]:
        """P_q(t) = line[0] + line[1] t of each."""
        first, second = self.order == 1, self.order == HIGHEST
        return np.where(second, -1.5 * self.s, first) * self.sine, np.where(second, self.sine, 0.0)

    def polynomial(self, k: Index, t: NDArray[Any]) -> NDArray[Any]:
        """P_q(t)."""
        constant, slope = self.line
        return np.asarray(slope[k] * t + constant[k])

    def turn(self, k: Index, away: Array) -> Array:
        """What stands before (t - s)^q, away = t - s, in what the kernel makes on the zone: its
        smooth part is taken out.
        """
        return np.where(away > 0, self.psi[k], -self.phi[k])

    def turn_off(self, k: Index, rho: Array) -> Array:
        """The same off the zone."""
        return np.asarray(2 * np.arctan2(rho * self.sine[k], 1 - rho * np.cos(self.phi[k])))

    def shape(self, k: Index, left: Array, right: Array) -> Array:
        """kappa, at points by their distances from the zone's ends over w."""
        return kappa(
            np.sqrt(right * self.left[k]), np.sqrt(left * self.right[k]), left - self.left[k]
        )

    # what is made of them, over h / pi
    def on_zone(self, k: Index, left: Array) -> Array:
        """What the kernel makes of them on the zone."""
        away = left - self.left[k]
        return self.turn(k, away) * power(away, self.order[k]) - self.polynomial(k, left - 1)

    def off_zone(self, k: Index, z: Array, rho: Array) -> Array:
        """And off it."""
        return power(z - self.s[k], self.order[k]) * self.turn_off(k, rho) - self.polynomial(k, z)

    def of_density(self, k: Index, left: Array, right: Array) -> Array:
        """They themselves."""
        away, q = left - self.left[k], self.order[k]
        with np.errstate(invalid="ignore"):
            return np.where((away == 0) & (q > 0), 0.0, power(away, q) * self.shape(k, left, right))

    def integral_of(self, k: Index, left: Array, right: Array) -> Array:
        """Their integrals from the left end over w, of kinks alone: int kappa dt = (t - s) kappa -
        theta sin(phi).
        """
        if np.any(self.order[k] > 0):
            raise ValueError(
                "the integral along a zone is for kinks alone, or for densities without jumps of the right side"
            )
        away = left - self.left[k]
        with np.errstate(invalid="ignore"):
            return np.where(away == 0, 0.0, away * self.shape(k, left, right)) + self.sine[
                k
            ] * theta(right, left)

    def potential_on(self, k: Index, left: Array, right: Array) -> Array:
        """Their potentials on the zone over w, less c_0 log(w)."""
        away, nothing = left - self.left[k], np.zeros_like(left)
        return np.asarray(
            self.potential_of(k, away, 0.5 * (left - right), self.turn(k, away), nothing, nothing)
        )

    def potential_off(self, k: Index, left: Array, right: Array, rho: Array) -> Array:
        """And off it."""
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
        """Closed potentials (see the head of `forcing`), z - s, F, A and B at hand, real or
        complex.
        """
        orders = self.order[k]
        if np.all(orders == orders[:1]):
            return (
                self._potential(int(orders[0]), k, away, z, turn, grown, root) if len(k) else turn
            )
        parts, out = np.broadcast_arrays(away, z, turn, grown, root), np.empty_like(turn)
        for q in np.unique(orders).tolist():
            of = np.flatnonzero(orders == q)
            out[..., of] = self._potential(q, k[of], *(part[..., of] for part in parts))
        return out

    def _potential(
        self, q: int, k: Index, away: Any, z: Any, turn: Any, grown: Any, root: Any
    ) -> Any:
        """The same of jumps of order q."""
        s, sine = self.s[k], self.sine[k]
        if q == 0:
            rest = grown - LOG2 - 1
        elif q == 1:
            rest = 0.5 * (root - s * grown) - z + s * (0.75 + 0.5 * LOG2)
        else:
            square = sine * sine
            rest = (grown * (0.5 + s * s) + root * (0.5 * z - 2 * s)) / 3 - z * (0.5 * z - 1.5 * s)
            rest = rest + (square / 9 - s * s / 2 - 1 / 12 - LOG2 * (square / 6 + s * s / 2))
        return raised(away, q + 1) * turn / (q + 1) + sine * rest

    # their series
    def sine_weights(self, k: Index, j: Array) -> Array:
        """b_j of jumps k where their function is sum_j (2/j) b_j sin(j theta)."""
        from_left = (self.psi < self.phi)[k][:, None]
        sines = np.sin(j * np.minimum(self.phi, self.psi)[k][:, None])
        return np.asarray(np.where(from_left & (j % 2 == 0), -sines, sines))

    def coefficients(self, k: Index, row: Index, rows: int, count: int) -> Array:
        """Coefficients of jumps k, added up in rows (rows, count): (t - s)^q is expanded in powers
        of t, so that what is done with series is done once a row.
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
                weight = self.height[some] * _BINOMIAL[q, power] * (-s) ** np.maximum(q - power, 0)
                powers[power, into[first]] += np.add.reduceat(
                    weight[:, None] * sines, first, axis=0
                )
        c = of_sines(powers[highest])
        for series in powers[:highest][::-1]:
            c = _times_t(c) + of_sines(series)
        return np.asarray(c[:, :count])


def kappa(up: Array, vp: Array, away: Array) -> Array:
    """log(sin((theta + phi)/2) / |sin((theta - phi)/2)|) at points t = cos(theta), away = t - s, of
    jumps s = cos(phi), by the roots sin((theta +- phi)/2) = (up +- vp) / 2, whose product is (s -
    t)/2 without cancellation.
    """
    small, large = np.minimum(up, vp), np.maximum(up, vp)
    with np.errstate(divide="ignore", invalid="ignore"):
        # A jump beside an end, or a point, has little of it: then it is 2 artanh of the roots'
        # ratio, to all digits.
        far = 2 * np.arctanh(np.minimum(small / large, 0.5))
        return np.where(small < 0.5 * large, far, np.log((up + vp) ** 2 / (2 * np.abs(away))))


def power(away: Array, order: Index) -> Array:
    """away^order, 0 to 2; general powers take ten times as long as squares, which knots of splines
    ask for alone.
    """
    return (
        away * away
        if np.all(order == HIGHEST)
        else np.where(order == 0, 1.0, np.where(order == 1, away, away * away))
    )


def raised(away: Any, q: int) -> Any:
    """away^q by products."""
    return math.prod([away] * (q - 1), start=away)


def of_sines(beta: Array) -> Array:
    """Coefficients of T_l / sqrt(1 - t^2), l = 0, 1, ..., from those of sin(j theta), j = 1, 2,
    ..., along the last axis.
    """
    c = 0.5 * beta
    c[..., 2:] -= 0.5 * beta[..., :-2]
    return np.asarray(c)


def _times_t(c: Array) -> Array:
    """Coefficients of t times sum c_l T_l, the last one lost."""
    out = np.zeros_like(c)
    out[:, 1:] += 0.5 * c[:, :-1]
    out[:, 1] += 0.5 * c[:, 0]
    out[:, :-1] += 0.5 * c[:, 1:]
    return out
