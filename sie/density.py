"""The answer: a density on zones that evaluates anywhere, on and off the zones, as accurately as at its nodes."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sie import chebyshev
from sie.assemble import regular_size
from sie.kernels import Kernel
from sie.steps import Steps
from sie.zones import Zones

Array = NDArray[np.float64]
Index = NDArray[np.intp]

# Largest number of (point, zone) pairs handled at once: bounds the memory of an evaluation.
_CHUNK = 200_000


@dataclass(frozen=True, eq=False)
class Density:
    """phi(x) = sum_j c_j T_j(t) / sqrt(1 - t^2) + logarithms of the steps, on each zone.

    coefficients: smooth part (zones, n + 1). amplitudes: those of the equation's columns.
    """

    zones: Zones
    kernel: Kernel
    coefficients: Array
    steps: Steps
    amplitudes: Array

    # per zone -------------------------------------------------------------------------------------------------------
    @cached_property
    def _bounded(self) -> tuple[Array, Array, Array]:
        return chebyshev.bounded_part(self.coefficients)

    def settled(self) -> Density:
        """The same density with the last traces of 1/sqrt(d) taken out at free ends, where the exact one has none.

        An end off by delta leaves K = A delta / 2 there: at equal normalised position the rest is right to delta over the
        width, while K / sqrt(d) would grow without bound towards the end.
        """
        zones = self.zones
        alpha, beta, u = self._bounded
        left = np.array([end.moves and end.intensity == 0.0 for end in zones.left])
        right = np.array([end.moves and end.intensity == 0.0 for end in zones.right])
        k_left, k_right = np.where(left, 0.0, alpha - beta), np.where(right, 0.0, alpha + beta)
        other = replace(self)
        other.__dict__["_bounded"] = (0.5 * (k_left + k_right), 0.5 * (k_right - k_left), u)
        return other

    @cached_property
    def _bounded_ends(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Whether the density vanishes at the left and at the right end of each zone, by the kind of the end."""
        zones = self.zones
        return np.array([e.intensity == 0.0 for e in zones.left]), np.array([e.intensity == 0.0 for e in zones.right])

    @cached_property
    def totals(self) -> Array:
        """Integral over each zone (Z,)."""
        first = self.steps.t_coefficients(self.zones, 1)[:, 0]
        return np.asarray(np.pi * self.zones.half * (self.coefficients[:, 0] + first))

    @property
    def total(self) -> float:
        """Integral over all zones."""
        return float(self.totals.sum())

    def moment(self, about: float = 0.0) -> float:
        """Integral of (x - about) times the density."""
        c = self.coefficients[:, 1] if self.coefficients.shape[1] > 1 else 0.0
        first = c + self.steps.t_coefficients(self.zones, 2)[:, 1]
        w = self.zones.half
        return float(np.sum((self.zones.middle - about) * self.totals + np.pi * w * w * first / 2))

    @cached_property
    def intensities(self) -> tuple[Array, Array]:
        """K at the left and the right end of each zone: density ~ K / sqrt(d) at distance d from the end."""
        alpha, beta, _ = self._bounded
        root = np.sqrt(self.zones.half / 2)
        return root * (alpha - beta), root * (alpha + beta)

    @cached_property
    def edge_slopes(self) -> tuple[Array, Array]:
        """A at the left and the right end of each zone: density ~ K / sqrt(d) + A sqrt(d)."""
        alpha, beta, u = self._bounded
        k = np.arange(1, u.shape[1] + 1)
        sign = 1.0 - 2.0 * ((k - 1) % 2)
        step_left, step_right = self.steps.edge_slopes(self.zones)
        w = self.zones.half
        # From (alpha + beta t) / sqrt(1 - t^2) at t = 1 - d/w, to second order.
        singular_right = ((alpha + beta) / 4 - beta) / np.sqrt(2 * w)
        singular_left = ((alpha - beta) / 4 + beta) / np.sqrt(2 * w)
        scale = np.sqrt(2 / w)
        return scale * (u @ (k * sign) + step_left) + singular_left, scale * (u @ k + step_right) + singular_right

    # evaluation -----------------------------------------------------------------------------------------------------
    def at(self, zone: ArrayLike, left: ArrayLike, right: ArrayLike) -> Array:
        """Density at points given by zone index and the distances from the zone's ends over its half width
        (left + right = 2): no digit is lost near the ends."""
        zone, left, right = np.broadcast_arrays(np.asarray(zone, dtype=np.intp), *map(_float, (left, right)))
        alpha, beta, u = self._bounded
        root = np.sqrt(left * right)
        with np.errstate(divide="ignore", invalid="ignore"):
            a, b = alpha[zone], beta[zone]
            edge = (a + b * 0.5 * (left - right)) / root
            no_edge = (a == 0) & (b == 0)
            if not np.all(root):
                # At an end where the density is bounded, the rounding of its intensity is not divided by zero.
                zero_left, zero_right = self._bounded_ends
                no_edge |= (left == 0) & zero_left[zone] | (right == 0) & zero_right[zone]
            out = np.where(no_edge, 0.0, edge) + self._sine_sum(u, zone, _angle(left, right), left < right)
        for i in self.steps.by_zone:
            here = zone == i
            if np.any(here):
                out[here] += self.steps.density(i, left[here], right[here])
        return np.asarray(out)

    def at_t(self, zone: ArrayLike, t: ArrayLike) -> Array:
        """Density at normalised positions t in [-1, 1] of zones."""
        t = _float(t)
        return self.at(zone, 1 + t, 1 - t)

    def _sine_sum(self, u: Array, zone: Index, angle: Array, flip: NDArray[np.bool_]) -> Array:
        """sum_k u_k sin((k+1) theta), by the angle from the nearer end, theta = pi - angle where `flip`: no digit is lost
        near either end. Zones one after the other, in blocks of bounded memory."""
        out = np.zeros(angle.shape)
        flat_zone, flat_angle, flat_flip, flat_out = zone.ravel(), angle.ravel(), flip.ravel(), out.reshape(-1)
        for i in np.unique(flat_zone):
            here = np.flatnonzero(flat_zone == i)
            row = np.trim_zeros(u[i], "b")
            if len(row) == 0:
                continue
            k = np.arange(1, len(row) + 1)
            both = np.column_stack((row, row * (2.0 * (k % 2) - 1.0)))
            block = max(1, _CHUNK * 4 // len(row))
            for s in range(0, len(here), block):
                part = here[s : s + block]
                sums = np.sin(flat_angle[part][:, None] * k) @ both
                flat_out[part] = np.where(flat_flip[part], sums[:, 1], sums[:, 0])
        return out

    def locate(self, x: ArrayLike) -> tuple[Array, Index, NDArray[np.bool_]]:
        """(x moved by periods to lie right of the first zone's left end, index of the last zone that starts before it,
        whether it is inside that zone)."""
        x = _float(x)
        if self.kernel.period is not None:
            x = x - np.floor((x - self.zones.a[0]) / self.kernel.period) * self.kernel.period
        i = np.maximum(np.searchsorted(self.zones.a, x, side="right") - 1, 0)
        inside = (x >= self.zones.a[i]) & (x <= self.zones.b[i])
        return x, i, inside

    def __call__(self, x: ArrayLike) -> Array:
        """Density at x (any shape), zero off the zones."""
        x, i, inside = self.locate(x)
        out = np.where(np.isnan(x), np.nan, 0.0)
        z, w = i[inside], self.zones.half[i[inside]]
        out[inside] = self.at(z, (x[inside] - self.zones.a[z]) / w, (self.zones.b[z] - x[inside]) / w)
        return out

    def transform(self, x: ArrayLike) -> Array:
        """(1/pi) PV int phi K dxi at x (any shape), on and off the zones; infinite at a singular end."""
        return self._evaluate(x, self._transform_pairs, self.kernel.regular)

    def potential(self, x: ArrayLike) -> Array:
        """(1/pi) int phi Lambda dxi at x (any shape), on and off the zones."""
        if self.kernel.regular is not None and self.kernel.regular_potential is None:
            raise ValueError("the regular kernel has no potential")
        return self._evaluate(x, self._potential_pairs, self.kernel.regular_potential)

    def potential_along(self, x: Array) -> Array:
        """The potential at points x (n,) taken where they are, not moved by periods."""
        total = self._regular_field(x, self.kernel.regular_potential) if self.kernel.regular_potential else np.zeros(x.shape)
        for shift in self.kernel.poles:
            total += self._potential_pairs(x, shift)
        return total

    def potential_of(self, x: Array, shift: float, chosen: Index) -> Array:
        """What the chosen zones, moved by one of the kernel's poles, add to the potential at points x (n,)."""
        return self._potential_pairs(x, shift, chosen)

    def _evaluate(self, x: ArrayLike, pairs, regular) -> Array:  # type: ignore[no-untyped-def]
        x = _float(x)
        flat = self.locate(x)[0].ravel() if self.kernel.period is not None else x.ravel()
        if self.kernel.period is not None:
            # Points between the last zone and the first one's image: nearer to the image's side, but within a period.
            middle = 0.5 * (self.zones.a[0] + self.zones.b[-1])
            flat = flat - np.round((flat - middle) / self.kernel.period) * self.kernel.period
        out = np.zeros(flat.shape)
        block = max(1, _CHUNK // len(self.zones))
        for s in range(0, len(flat), block):
            part = flat[s : s + block]
            total = self._regular_field(part, regular) if regular is not None else np.zeros(part.shape)
            for shift in self.kernel.poles:
                total += pairs(part, shift)
            out[s : s + block] = total
        return out.reshape(x.shape)

    def _geometry(self, x: Array, shift: float) -> tuple[Array, Array]:
        """Distances of points from both ends of every zone over w, positive on the zone: (points, zones)."""
        w = self.zones.half
        return (x[:, None] - (self.zones.a + shift)) / w, ((self.zones.b + shift) - x[:, None]) / w

    def _transform_pairs(self, x: Array, shift: float) -> Array:
        left, right = self._geometry(x, shift)
        on = (left >= 0) & (right >= 0)
        root = np.sqrt(np.abs(left * right))
        sign = np.where(left >= 0, 1.0, -1.0)
        z = 0.5 * (left - right)
        rho = np.where(on, 0.0, sign / (np.abs(z) + root))
        alpha, beta, u = self._bounded
        with np.errstate(divide="ignore", invalid="ignore"):
            off = np.where(on, 0.0, sign * (alpha + beta * rho) / root)
        off = np.where(alpha == 0, np.where(beta == 0, 0.0, off), off)
        out = (off + rho * _power_sum(u, rho)).sum(axis=1)
        if np.any(on):
            p, i = np.nonzero(on)
            c = self.coefficients
            own = self._own_transform(i, left[p, i], right[p, i])
            np.add.at(out, p, own)
        for i in self.steps.by_zone:
            here = on[:, i]
            out[here] += self.steps.own_transform(i, left[here, i])
            away = ~here
            out[away] += self.steps.transform(i, z[away, i], rho[away, i])
        return np.asarray(out)

    def _own_transform(self, zone: Index, left: Array, right: Array) -> Array:
        """-sum c_j U_{j-1}(t) on the zones, by the angle from the nearer end."""
        c = self.coefficients[:, 1:]
        flip, angle = left < right, _angle(left, right)
        with np.errstate(invalid="ignore"):
            out = -self._sine_sum(c, zone, angle, flip) / np.sin(angle)
        for place in np.flatnonzero(angle == 0):
            j = np.arange(1, c.shape[1] + 1)
            sign = 2.0 * (j % 2) - 1.0 if flip[place] else 1.0
            out[place] = -c[zone[place]] @ (j * sign)
        return out

    @cached_property
    def _potential_coefficients(self) -> Array:
        """Coefficients of all but the logarithms of kinks, those over l = 1, 2, ... divided by l: potentials need these."""
        c, high = self.coefficients, self.steps.high_coefficients(self.zones)
        table = np.zeros((len(c), max(c.shape[1], high.shape[1])))
        table[:, : c.shape[1]] = c
        table[:, : high.shape[1]] += high
        table[:, 1:] /= np.arange(1, table.shape[1])
        return table

    @cached_property
    def _kink_totals(self) -> Array:
        kinks = self.steps.t_coefficients(self.zones, 1)[:, 0]
        return np.asarray(kinks - (self.steps.high_coefficients(self.zones)[:, :1].sum(axis=1)))

    def _potential_pairs(self, x: Array, shift: float, chosen: Index | None = None) -> Array:
        """Potential at x of the chosen zones (all if None), moved by `shift`."""
        zones = slice(None) if chosen is None else chosen
        w, table = self.zones.half[zones], self._potential_coefficients[zones]
        left = (x[:, None] - (self.zones.a[zones] + shift)) / w
        right = ((self.zones.b[zones] + shift) - x[:, None]) / w
        on = (left >= 0) & (right >= 0)
        root = np.sqrt(np.abs(left * right))
        z = 0.5 * (left - right)
        rho = np.where(on, 0.5, np.where(left >= 0, 1.0, -1.0) / (np.abs(z) + root))
        first, rest = table[:, 0], table[:, 1:]
        total = first * np.log(w / (2 * np.abs(rho) * self.kernel.datum)) - rho * _power_sum(rest, rho)
        if np.any(on):
            p, i = np.nonzero(on)
            theta = 2 * np.arctan2(np.sqrt(right[p, i]), np.sqrt(left[p, i]))
            total[p, i] = first[i] * np.log(w[i] / (2 * self.kernel.datum)) - self._cosine_sum(rest, i, theta)
        for i in self.steps.kinked:
            place = i if chosen is None else _place(chosen, i)
            if place is None:
                continue
            turn = z[:, place] + 1j * np.sqrt(np.maximum(left[:, place] * right[:, place], 0.0))
            q = np.where(on[:, place], turn, rho[:, place])
            log = math.log(w[place] / self.kernel.datum)
            total[:, place] += self.steps.kink_potential(i, q) + self._kink_totals[i] * log
        return np.asarray(total @ w)

    def _cosine_sum(self, scaled: Array, zone: Index, theta: Array) -> Array:
        out = np.zeros(theta.shape)
        k = np.arange(1, scaled.shape[1] + 1)
        for i in np.unique(zone):
            here = np.flatnonzero(zone == i)
            block = max(1, _CHUNK * 4 // max(1, len(k)))
            for s in range(0, len(here), block):
                part = here[s : s + block]
                out[part] = np.cos(theta[part][:, None] * k) @ scaled[i]
        return out

    def _regular_field(self, x: Array, regular) -> Array:  # type: ignore[no-untyped-def]
        out = np.zeros(x.shape)
        m = self.coefficients.shape[1] - 1
        sizes = np.array([regular_size(self.kernel, w, m) for w in self.zones.half])
        for q in np.unique(sizes):
            group = np.flatnonzero(sizes == q)
            count = min(int(q), m + 1)
            xi = self.zones.middle[group][:, None] + self.zones.half[group][:, None] * chebyshev.gauss(int(q))
            c = self.coefficients[group, :count]
            if len(self.steps):
                c = c + self.steps.t_coefficients(self.zones, count)[group]
            weights = (c @ chebyshev.t_matrix(int(q), count).T) * (self.zones.half[group] / q)[:, None]
            block = max(1, _CHUNK // weights.size)
            for s in range(0, len(x), block):
                values = regular(x[s : s + block, None], xi.ravel()[None, :])
                out[s : s + block] += values @ weights.ravel()
        return out


def _power_sum(u: Array, rho: Array) -> Array:
    """sum_k u_k rho^k for every (point, zone); far points stop early, where rho^k has vanished."""
    largest = float(np.abs(rho).max(initial=0.0))
    if u.shape[1] == 0 or largest == 0.0:
        return np.zeros(rho.shape) + (u[:, 0] if u.shape[1] else 0.0)
    flat = np.abs(rho).ravel()
    with np.errstate(divide="ignore"):
        need = np.fmin(u.shape[1], np.ceil(-40.0 / np.log(np.minimum(flat, 1 - 1e-12)))).astype(int)
    need = np.maximum(need, 1)
    order = np.argsort(-need, kind="stable")
    point_rho = rho.ravel()[order]
    zone = np.tile(np.arange(rho.shape[1]), rho.shape[0])[order]
    counts = need[order]
    out = np.zeros(len(order))
    active = np.searchsorted(-counts, -np.arange(1, counts[0] + 1), side="right")
    for k in range(int(counts[0]) - 1, -1, -1):
        n = active[k]
        out[:n] = out[:n] * point_rho[:n] + u[zone[:n], k]
    result = np.empty(len(order))
    result[order] = out
    return result.reshape(rho.shape)


def _place(chosen: Index, zone: int) -> int | None:
    found = np.flatnonzero(chosen == zone)
    return int(found[0]) if len(found) else None


def _angle(left: Array, right: Array) -> Array:
    """Angle from the nearer end, at distances `left` and `right` from the ends."""
    return np.asarray(2 * np.arctan2(np.sqrt(np.minimum(left, right)), np.sqrt(np.maximum(left, right))))


def _float(x: ArrayLike) -> Array:
    return np.asarray(x, dtype=float)
