"""The answer: a density on zones that evaluates anywhere, on and off the zones, as accurately as at its nodes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sie.basis import chebyshev
from sie.basis.half_plane import What, sum_of_powers
from sie.basis.kept import Kept
from sie.basis.kernels import Kernel
from sie.basis.zones import Zones
from sie.density.field import (
    CHUNK,
    Sources,
    moments_of,
    panels_over,
    potential_at,
    quadrature,
    transform_at,
)
from sie.density.interval_potential import IntervalPotential
from sie.density.plane import Plane
from sie.density.treecode import Treecode
from sie.fast.far import reaches
from sie.fast.panels import Panels
from sie.jumps.forcing import LOG2, SERIES_REACH, ForcingJumps, of_zones

Array = NDArray[np.float64]
Index = NDArray[np.intp]

_MANY_ZONES = 8
# Distance from a singular end, over the half width, within which errors of the density are not asked for.
_BESIDE = 0.01
# Most even angles of one zone that `sampling` asks for.
_MOST_PLACES = 2**14
# Most angles of a zone at which it is looked how the density follows the ends.
LOOKS = 128


@dataclass(frozen=True, eq=False)
class Density(Kept):
    """phi(x) = sum_j c_j T_j(t) / sqrt(1 - t^2) + logarithms of the jumps, on each zone, t from -1 to 1 there.

    Called at points of the line it gives phi, zero off the zones; `transform`, `potential` and their slopes also take complex points
    off it.

    Attributes
    ----------
    zones : Zones
        The zones, Z of them.
    kernel : Kernel
        By which transform and potential are taken.
    coefficients : ndarray
        c of the smooth part (Z, n + 1).
    jumps : ForcingJumps
        The jumps of the right side within the zones.
    amplitudes : ndarray
        Those of the equation's columns (k,).
    bounded_ends : bool
        See `with_bounded_ends`.
    parts : tuple or None
        What `bounded` is, where it is known to more digits than the coefficients tell.

    Examples
    --------
    The density 1 / sqrt(1 - x^2) of a flat punch, on the zone, and its transform 1 / sqrt(z^2 - 1) off it.

    >>> import numpy as np, sie
    >>> punch = sie.Equation(sie.cauchy(), sie.Forcing(np.zeros_like), (sie.Total(np.pi),))
    >>> density = sie.solve(punch, sie.Zones.of([[-1.0, 1.0]], sie.SINGULAR, sie.SINGULAR)).density
    >>> density([0.0, 0.6, 2.0]).round(12).tolist(), density.transform(1.25).round(12).tolist()
    ([1.0, 1.25, 0.0], 1.333333333333)
    >>> float(density.transform(0.75j).imag.round(12)), float(density.transform_slope(0.75j).real.round(12))
    (-0.8, 0.384)
    """

    zones: Zones
    kernel: Kernel
    coefficients: Array
    jumps: ForcingJumps
    amplitudes: Array
    bounded_ends: bool = False
    parts: tuple[Array, Array, Array] | None = None

    # per zone -------------------------------------------------------------------------------------------------------
    @cached_property
    def bounded(self) -> tuple[Array, Array, Array]:
        alpha, beta, u = self.parts or chebyshev.bounded_part(self.coefficients)
        if not self.bounded_ends:
            return alpha, beta, u
        zones = self.zones
        left = np.array([end.moves and end.intensity == 0.0 for end in zones.left])
        right = np.array([end.moves and end.intensity == 0.0 for end in zones.right])
        k_left, k_right = np.where(left, 0.0, alpha - beta), np.where(right, 0.0, alpha + beta)
        return 0.5 * (k_left + k_right), 0.5 * (k_right - k_left), u

    @property
    def whole(self) -> Density:
        """The density without slits: this one."""
        return self

    @property
    def slit_count(self) -> int:
        """How many narrow gaps between the zones are taken as slits of wider ones; here none."""
        return 0

    def opening(self, x: ArrayLike) -> tuple[NDArray[np.bool_], Array]:
        """(whether x lies in a slit, the integral of the slack from the slit's left end to x); here nowhere, nothing."""
        shape = np.shape(x)
        return np.zeros(shape, dtype=bool), np.zeros(shape)

    def with_bounded_ends(self) -> Density:
        """The same density with the last traces of 1/sqrt(d) taken out at free ends, where the exact one has none.

        An end off by delta leaves K = A delta / 2 there: at equal normalised position the rest is right to delta over
        the width, while K / sqrt(d) would grow without bound towards the end.
        """
        return replace(self, bounded_ends=True)

    @cached_property
    def _bounded_ends(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Whether the density vanishes at the left and at the right end of each zone, by the kind of the end."""
        zones = self.zones
        return np.array([e.intensity == 0.0 for e in zones.left]), np.array([e.intensity == 0.0 for e in zones.right])

    @cached_property
    def sampling(self) -> NDArray[np.intp]:
        """Even angles per zone (Z,) that show all of the density: twice its modes and a few for every jump."""
        modes = np.count_nonzero(self.coefficients, axis=1)
        jumps = np.zeros(len(self.zones), dtype=np.intp)
        jumps[: len(self.jumps.count)] = self.jumps.count
        return np.clip(2 * modes + 4 * jumps, 24, _MOST_PLACES)

    @cached_property
    def totals(self) -> Array:
        """Integral over each zone (Z,)."""
        first = self.jumps.t_coefficients(self.zones, 1)[:, 0]
        return np.asarray(np.pi * self.zones.half * (self.coefficients[:, 0] + first))

    @property
    def total(self) -> float:
        """Integral over all zones."""
        return float(self.totals.sum())

    def moment(self, about: float = 0.0) -> float:
        """Integral of (x - about) times the density."""
        c = self.coefficients[:, 1] if self.coefficients.shape[1] > 1 else 0.0
        first = c + self.jumps.t_coefficients(self.zones, 2)[:, 1]
        w = self.zones.half
        return float(np.sum((self.zones.middle - about) * self.totals + np.pi * w * w * first / 2))

    @cached_property
    def intensities(self) -> tuple[Array, Array]:
        """K at the left and the right end of each zone: density ~ K / sqrt(d) at distance d from the end."""
        alpha, beta, _ = self.bounded
        root = np.sqrt(self.zones.half / 2)
        return root * (alpha - beta), root * (alpha + beta)

    @cached_property
    def edge_slopes(self) -> tuple[Array, Array]:
        """A at the left and the right end of each zone: density ~ K / sqrt(d) + A sqrt(d)."""
        alpha, beta, u = self.bounded
        k = np.arange(1, u.shape[1] + 1)
        sign = 1.0 - 2.0 * ((k - 1) % 2)
        step_left, step_right = self.jumps.edge_slopes(self.zones)
        w = self.zones.half
        # From (alpha + beta t) / sqrt(1 - t^2) at t = 1 - d/w, to second order.
        singular_right = ((alpha + beta) / 4 - beta) / np.sqrt(2 * w)
        singular_left = ((alpha - beta) / 4 + beta) / np.sqrt(2 * w)
        scale = np.sqrt(2 / w)
        return scale * (u @ (k * sign) + step_left) + singular_left, scale * (u @ k + step_right) + singular_right

    @cached_property
    def sensitivity(self) -> tuple[Array, Array, Array]:
        """(Z,) each: the largest density of a zone, and the largest change of its density at equal normalised position by a
        motion of its left end, of its right end, per motion over width; infinite pressures, at singular ends and kinks, count no
        nearer than _BESIDE.

        To first order the motion of an end leaves a bounded density as it is at fixed places, but for K / sqrt(d), which the
        density at the new ends does not have. At equal t = cos(theta), a motion of the right end by eps widths makes that

            eps (1 + t) phi'(t) + K's part = -eps cot(theta/2) (phi_theta(theta) - phi_theta(0)).
        """
        peak, by_left, by_right = np.zeros((3, len(self.zones)))
        alpha, beta, u = self.bounded
        counts = np.minimum(self.sampling, LOOKS)
        edge_left, edge_right = self.jumps.edge_slopes(self.zones)
        for n in np.unique(counts):
            group = np.flatnonzero(counts == n)
            theta = (np.arange(n) + 0.5) * np.pi / n
            used = np.flatnonzero(np.any(u[group] != 0, axis=0))
            k = np.arange(1, used[-1] + 2 if len(used) else 1)
            angle, sums = theta[:, None] * k, u[group][:, : len(k)].T
            value, slope = np.sin(angle) @ sums, np.cos(angle) @ (k[:, None] * sums)
            at_left = -(k * (1.0 - 2.0 * (k % 2))) @ sums + edge_left[group]
            at_right = k @ sums + edge_right[group]
            half = np.tan(0.5 * theta)[:, None]
            peak[group] = np.abs(value).max(axis=0)
            by_right[group] = np.abs((slope - at_right) / half).max(axis=0)
            by_left[group] = np.abs((slope + at_left) * half).max(axis=0)
            for column, i in enumerate(group.tolist()):
                if i not in self.jumps.by_zone:
                    continue
                peak[i] = np.abs(value[:, column] + self.jumps.density(i, 1 + np.cos(theta), 1 - np.cos(theta))).max()
                beside = self.jumps.beside_kinks(i, _BESIDE, theta)
                left, right = 2 * np.cos(0.5 * beside) ** 2, 2 * np.sin(0.5 * beside) ** 2
                bent = np.cos(beside[:, None] * k) @ (k * sums[:, column]) + self.jumps.angular_slope(i, left, right)
                tangent = np.tan(0.5 * beside)
                by_right[i] = np.abs((bent - at_right[column]) / tangent).max(initial=0.0)
                by_left[i] = np.abs((bent + at_left[column]) * tangent).max(initial=0.0)
        # A zone held at one end spreads its load over another width as the other end moves.
        edge = (np.abs(alpha) + np.abs(beta)) / np.sqrt(_BESIDE * (2 - _BESIDE))
        return peak, by_left + edge, by_right + edge

    # evaluation -----------------------------------------------------------------------------------------------------
    def at(self, zone: ArrayLike, left: ArrayLike, right: ArrayLike) -> Array:
        """Density at points given by zone index and the distances from the zone's ends over its half width
        (left + right = 2): no digit is lost near the ends."""
        zone, left, right = np.broadcast_arrays(np.asarray(zone, dtype=np.intp), *map(_float, (left, right)))
        alpha, beta, u = self.bounded
        root = np.sqrt(left * right)
        with np.errstate(divide="ignore", invalid="ignore"):
            a, b = alpha[zone], beta[zone]
            edge = (a + b * 0.5 * (left - right)) / root
            no_edge = (a == 0) & (b == 0)
            if not np.all(root):
                # At an end where the density is bounded, the rounding of its intensity is not divided by zero.
                zero_left, zero_right = self._bounded_ends
                no_edge |= (left == 0) & zero_left[zone] | (right == 0) & zero_right[zone]
            if zone.ndim == 2 and zone.strides[1] == 0 == left.strides[0] == right.strides[0]:
                sums = self._same_places(u, zone[:, 0], _angle(left[0], right[0]), left[0] < right[0])
            else:
                sums = self._sine_sum(u, zone, _angle(left, right), left < right)
            out = np.asarray(np.where(no_edge, 0.0, edge) + sums)
        if len(self.jumps):
            out = out.copy()
            flat, flat_left, flat_right = out.reshape(-1), left.ravel(), right.ravel()
            for i, here in of_zones(zone.ravel()):
                if i in self.jumps.by_zone:
                    flat[here] += self.jumps.density(i, flat_left[here], flat_right[here])
        return np.asarray(out)

    def at_t(self, zone: ArrayLike, t: ArrayLike) -> Array:
        """Density at normalised positions t in [-1, 1] of zones."""
        t = _float(t)
        return self.at(zone, 1 + t, 1 - t)

    def _same_places(self, u: Array, zones: Index, angle: Array, flip: NDArray[np.bool_]) -> Array:
        """The sums of `_sine_sum` at the same places of several zones, as matrix products of bounded size."""
        rows = u[zones]
        used = np.flatnonzero(np.any(rows != 0, axis=0))
        k = np.arange(1, used[-1] + 2 if len(used) else 1)
        rows = rows[:, : len(k)]
        # Seen from the left end, t changes sign: even modes do too.
        turned = rows * (2.0 * (k % 2) - 1.0)
        out = np.empty((len(zones), len(angle)))
        block = max(1, CHUNK * 4 // max(1, len(k)))
        for s in range(0, len(angle), block):
            here = slice(s, s + block)
            sines = np.sin(angle[here, None] * k).T
            out[:, here] = np.where(flip[here], turned @ sines, rows @ sines) if flip[here].any() else rows @ sines
        return out

    def _sine_sum(self, u: Array, zone: Index, angle: Array, flip: NDArray[np.bool_]) -> Array:
        """sum_k u_k sin((k+1) theta), by the angle from the nearer end, theta = pi - angle where `flip`: no digit is
        lost near either end. Zones one after the other, in blocks of bounded memory."""
        out = np.zeros(angle.shape)
        flat_zone, flat_angle, flat_flip, flat_out = zone.ravel(), angle.ravel(), flip.ravel(), out.reshape(-1)
        for i, here in of_zones(flat_zone):
            row = np.trim_zeros(u[i], "b")
            if len(row) == 0:
                continue
            k = np.arange(1, len(row) + 1)
            both = np.column_stack((row, row * (2.0 * (k % 2) - 1.0)))
            block = max(1, CHUNK * 4 // len(row))
            for s in range(0, len(here), block):
                part = here[s : s + block]
                sums = np.sin(flat_angle[part][:, None] * k) @ both
                flat_out[part] = np.where(flat_flip[part], sums[:, 1], sums[:, 0])
        return out

    def locate(self, x: ArrayLike) -> tuple[Array, Index, NDArray[np.bool_]]:
        """(x moved by periods to lie right of the first zone's left end, index of the last zone that starts before it,
        whether it is inside that zone)."""
        place = _float(x)
        if self.kernel.period is not None:
            place = place - np.floor((place - self.zones.a[0]) / self.kernel.period) * self.kernel.period
        i = np.asarray(np.maximum(np.searchsorted(self.zones.a, place, side="right") - 1, 0))
        return place, i, np.asarray((place >= self.zones.a[i]) & (place <= self.zones.b[i]))

    def __call__(self, x: ArrayLike) -> Array:
        """Density at x (any shape), zero off the zones."""
        x, i, inside = self.locate(x)
        out = np.where(np.isnan(x), np.nan, 0.0)
        z, w = i[inside], self.zones.half[i[inside]]
        out[inside] = self.at(z, (x[inside] - self.zones.a[z]) / w, (self.zones.b[z] - x[inside]) / w)
        return out

    def integral_at(self, zone: ArrayLike, theta: ArrayLike) -> Array:
        """Integral of the density from a zone's left end to the angle theta (t = cos theta), of densities with jumps of their own or none:
        int T_j / sqrt(1 - t^2) dt = -sin(j theta) / j, and (pi - theta) for j = 0."""
        zone, theta = np.broadcast_arrays(np.asarray(zone, dtype=np.intp), _float(theta))
        w, c = self.zones.half[zone], self.coefficients
        table = c[:, 1:] / np.arange(1, c.shape[1])
        angle, flip = np.minimum(theta, np.pi - theta), theta > 0.5 * np.pi
        if zone.ndim == 2 and zone.strides[1] == 0 == theta.strides[0]:
            sums = self._same_places(table, zone[:, 0], angle[0], flip[0])
        else:
            sums = self._sine_sum(table, zone, angle, flip)
        out = np.array(c[zone, 0] * (np.pi - theta) - sums)
        if len(self.jumps):
            flat_out, flat = out.reshape(-1), theta.ravel()
            for i, here in of_zones(zone.ravel()):
                if i in self.jumps.by_zone:
                    left, right = 2 * np.cos(flat[here] / 2) ** 2, 2 * np.sin(flat[here] / 2) ** 2
                    flat_out[here] += self.jumps.integral(i, left, right)
        return np.asarray(w * out)

    def integral(self, x: ArrayLike) -> Array:
        """Integral of the density from the left end of its zone to x, zero off the zones."""
        x, i, inside = self.locate(x)
        out = np.zeros(x.shape)
        z, w = i[inside], self.zones.half[i[inside]]
        left, right = (x[inside] - self.zones.a[z]) / w, (self.zones.b[z] - x[inside]) / w
        out[inside] = self.integral_at(z, 2 * np.arctan2(np.sqrt(right), np.sqrt(left)))
        return out

    def transform(self, x: ArrayLike) -> NDArray[Any]:
        """(1/pi) PV int phi K dxi at x (any shape), on and off the zones; infinite at a singular end. At complex x what it is
        continued to, F(x) (see `plane`); there a zero imaginary part is the upper side of the line."""
        if np.iscomplexobj(x):
            return self._in_plane(x, "transform")
        x = _float(x)
        return transform_at(self, self.into_period(x).ravel(), self.sources).reshape(x.shape)

    def transform_slope(self, z: ArrayLike) -> NDArray[np.complex128]:
        """F'(z), the derivative of `transform` at complex z (any shape)."""
        return self._in_plane(z, "derivative")

    def _in_plane(self, z: ArrayLike, what: What) -> NDArray[np.complex128]:
        points = np.asarray(z, dtype=complex)
        out, finite = np.full(points.shape, complex(np.nan, np.nan)), np.isfinite(points)
        out[finite] = self.plane(points[finite], what)
        return out

    @cached_property
    def plane(self) -> Plane:
        """The density at complex points."""
        return Plane(self)

    def potential(self, x: ArrayLike) -> NDArray[Any]:
        """(1/pi) int phi Lambda dxi at x (any shape), on and off the zones. At complex x the complex potential W, W' = F, whose real part
        is the harmonic function that is the potential on the line: it is analytic in either half plane, real on the line right of all
        zones (with a period: between the last zone and the next one), and W(conj x) = conj W(x)."""
        if np.iscomplexobj(x):
            return self._in_plane(x, "potential")
        if self.kernel.regular is not None and self.kernel.regular_potential is None:
            raise ValueError("the regular kernel has no potential")
        x = _float(x)
        return potential_at(self, self.into_period(x).ravel(), self.sources).reshape(x.shape)

    def potential_on(self, lo: float, hi: float) -> Callable[[Array], Array] | None:
        """The potential on [lo, hi], an interval without zones in it, cheap at many points; None where nothing is gained."""
        return IntervalPotential.on(self, lo, hi)

    def into_period(self, x: Array) -> Array:
        """x moved by periods to within half of one of the zones' middle, where the kernel's poles are the near ones."""
        if self.kernel.period is None:
            return x
        middle = 0.5 * (self.zones.a[0] + self.zones.b[-1])
        return np.asarray(x - np.round((x - middle) / self.kernel.period) * self.kernel.period)

    @cached_property
    def sources(self) -> Sources:
        """Every zone at every pole of the kernel."""
        return Sources.of(self.zones, self.kernel)

    @cached_property
    def treecode(self) -> Treecode | None:
        """Fast sums for many points; None where the kernel or the number of zones does not allow them."""
        return Treecode(self) if len(self.zones) >= _MANY_ZONES and reaches(self.kernel, self.zones) else None

    @property
    def has_series(self) -> bool:
        """Whether `treecode` is at hand, or was before this was copied: what is summed with it keeps its last digits."""
        return self.__dict__.get("treecode") is not None or "summed" in self.__dict__

    def __getstate__(self) -> Any:
        kept = super().__getstate__()
        return kept | {"summed": True} if self.has_series else kept

    @cached_property
    def quadrature(self) -> list[tuple[Array, Array]]:
        """Nodes and weighted density for the regular part of the kernel."""
        return quadrature(self.zones, self.kernel, self.coefficients, self.jumps)

    @cached_property
    def panel_moments(self) -> tuple[Panels, Array] | None:
        """The panels of the regular part and this density's moments on them; None where it has none."""
        panels = panels_over(self.kernel, self.zones)
        return None if panels is None else (panels, moments_of(panels, self.zones, self.kernel, self.coefficients, self.jumps))

    def own_transform(self, zone: Index, left: Array, right: Array) -> Array:
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
    def potential_coefficients(self) -> Array:
        """Coefficients of all but `ForcingJumps.sharp_potential`, those over l = 1, 2, ... divided by l: for potentials."""
        c, high = self.coefficients, self.jumps.high_coefficients(self.zones)
        table = np.zeros((len(c), max(c.shape[1], high.shape[1])))
        table[:, : c.shape[1]] = c
        table[:, : high.shape[1]] += high
        table[:, 1:] /= np.arange(1, table.shape[1])
        return table

    def near_potential(self, zone: Index, left: Array, right: Array, rho: Array, on: NDArray[np.bool_]) -> Array:
        """Potential over w of zones at points on them and beside their ends, all but `ForcingJumps.sharp_potential`, at distances from
        these over w (n,), positive on the zone; rho off it, anything in the unit circle on it."""
        series, value = self._own_series, np.empty(len(left))
        log = np.log(self.zones.half / self.kernel.datum)
        theta = 2 * np.arctan2(np.sqrt(right[on]), np.sqrt(left[on]))
        value[on] = series[zone[on], 0] * (log[zone[on]] - LOG2) - cosine_sum(series[:, 1:], zone[on], theta)
        at, r = zone[~on], rho[~on]
        value[~on] = series[at, 0] * (log[at] - np.log(2 * np.abs(r))) - r * sum_of_powers(series[:, 1:], r, at)
        for place, here in of_zones(zone) if self.jumps.summed else ():
            if place in self.jumps.summed:
                jumps = self.jumps.summed_potential(place, left[here], right[here], rho[here])
                value[here] += jumps + self.summed_totals[place] * log[place]
        return value

    def is_near(self, zone: Index, rho: Array, on: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Where `near_potential` is to be asked: on the zones, and where series of jumps end too soon."""
        if not self.jumps.summed:
            return on
        summed = np.zeros(len(self.zones), dtype=bool)
        summed[list(self.jumps.summed)] = True
        return np.asarray(on | (summed[zone] & (np.abs(rho) > SERIES_REACH)))

    @cached_property
    def _own_series(self) -> Array:
        """`potential_coefficients` without the jumps that have closed forms there."""
        if not self.jumps.summed:
            return self.potential_coefficients
        table = self.coefficients.copy()
        table[:, 1:] /= np.arange(1, table.shape[1])
        return table

    @cached_property
    def summed_totals(self) -> Array:
        """c_0 of the jumps whose potential is a series, per zone."""
        high = self.jumps.high_coefficients(self.zones)
        return np.asarray(high[:, :1].sum(axis=1))

    @cached_property
    def sharp_totals(self) -> Array:
        """c_0 of the jumps of `ForcingJumps.sharp_potential`, per zone."""
        jumps = self.jumps.t_coefficients(self.zones, 1)[:, 0]
        return np.asarray(jumps - self.summed_totals)


def _angle(left: Array, right: Array) -> Array:
    """Angle from the nearer end, at distances `left` and `right` from the ends."""
    return np.asarray(2 * np.arctan2(np.sqrt(np.minimum(left, right)), np.sqrt(np.maximum(left, right))))


def _float(x: ArrayLike) -> Array:
    return np.asarray(x, dtype=float)


def cosine_sum(scaled: Array, zone: Index, theta: Array) -> Array:
    out = np.zeros(theta.shape)
    for i, here in of_zones(zone):
        row = np.trim_zeros(scaled[i], "b")
        k = np.arange(1, len(row) + 1)
        block = max(1, CHUNK * 4 // max(1, len(row)))
        for s in range(0, len(here), block):
            part = here[s : s + block]
            out[part] = np.cos(theta[part][:, None] * k) @ row
    return out
