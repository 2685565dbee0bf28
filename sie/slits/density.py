"""The density of wide zones with slits, as that of the pieces between the slits; see `slits` for
the equations.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from sie.basis import chebyshev
from sie.basis.data import DIGITS, Array, Index, Mask, widened, wrapped
from sie.basis.interval import Outside, sides, slope_scale
from sie.basis.interval import theta as theta_of
from sie.basis.kernels import Kernel, cauchy
from sie.basis.sums import pair_blocks
from sie.basis.zones import Zones
from sie.density.density import Density
from sie.density.located import Located
from sie.density.series import OPTIONS as SAMPLES
from sie.density.series import beside_kinks, even_angles, from_zones
from sie.jumps.forcing import ForcingJumps
from sie.slits.kinks import SlitKink
from sie.slits.plane import SlitPlane
from sie.slits.slits import OPTIONS, Merged, Slits, off_slit

# Half widths of a wide zone beyond which the coefficients of the slack that other zones see have
# all of it.
_FAR = float(np.cosh(DIGITS / OPTIONS.min_slack_modes)) - 1


@dataclass(frozen=True, eq=False)
class SlitDensity(Located):
    """phi on zones beside narrow gaps: what wide zones that span the gaps, g - s on their right
    side, have beside the slits.

    Members are those of `Density`, told of the zones as they were given. `solve_zones` makes it.

    Attributes
    ----------
    merged : Merged
        The zones (`merged.pieces`), the wide zones that span narrow gaps between them
        (`merged.wide`), and the slits in these.
    smooth : Density
        c = phi - P[s] on the wide zones, P[s] the density that the slack s asks for: as smooth as
        the right side.
    whole : Density
        phi on the wide zones, by its coefficients: what other zones see of it.
    slits : tuple of Slits
        The slits, for each wide zone that has any.
    d : tuple of ndarray
        The series of sigma = s sqrt(1 - t^2) on the slits of each of these, one after the other
        (modes,).
    bounded_ends : bool
        Whether the last traces of 1/sqrt(d) at free ends are taken out; see
        `Density.with_bounded_ends`.
    forced : bool
        Whether the right side stands behind it, with the kinks that it has in slits; not so for a
        response.

    Examples
    --------
    >>> import numpy as np, sie
    >>> wave = sie.Forcing(np.sin, lambda x: -np.cos(x))
    >>> near = sie.Zones.of([[-1.0, -0.001], [0.001, 1.0]])
    >>> density = sie.solve_zones(sie.Equation(sie.cauchy(), wave, (sie.Total(1.0), sie.EqualPotential())), near).density
    >>> type(density).__name__, density.totals.round(9).tolist()
    ('SlitDensity', [0.5, 0.5])
    """

    merged: Merged
    smooth: Density
    whole: Density
    slits: tuple[Slits, ...]
    d: tuple[Array, ...]
    bounded_ends: bool = False
    forced: bool = True

    @property
    def zones(self) -> Zones:
        return self.merged.pieces

    @property
    def kernel(self) -> Kernel:
        return self.smooth.kernel

    @property
    def jumps(self) -> ForcingJumps:
        return self.smooth.jumps

    @property
    def amplitudes(self) -> Array:
        return self.smooth.amplitudes

    @property
    def coefficients(self) -> Array:
        """Those of the wide zones."""
        return self.smooth.coefficients

    @cached_property
    def sampling(self) -> Index:
        return self.smooth.sampling[self.merged.piece_zone]

    def kinks_of(self, here: Slits) -> list[tuple[int, SlitKink]]:
        """The jumps in slits of one wide zone, by slit."""
        return here.kinks if self.forced else []

    # series of the slits
    @cached_property
    def series(self) -> list[list[Array]]:
        """d of each slit, without the traces of K where they are taken out."""
        split = [np.split(d, here.offset[1:-1]) for here, d in zip(self.slits, self.d, strict=True)]
        return [[_closed(one) for one in row] for row in split] if self.bounded_ends else split

    def _of_slits(self, power: int) -> list[list[Array]]:
        return [
            [slit.over(d, power) for slit, d in zip(here.slits, row, strict=True)]
            for here, row in zip(self.slits, self.series, strict=True)
        ]

    @cached_property
    def _tilde(self) -> list[list[Array]]:
        """Series of sigma / X^2: X H[sigma / X^2] is P[s] less (alpha + beta t) / X."""
        found = self._of_slits(2)
        return [[_closed(one) for one in row] for row in found] if self.bounded_ends else found

    @cached_property
    def sigma(self) -> Density:
        """sigma on all slits, as a density of its own."""
        return self._on_slits(self.series)

    @cached_property
    def _slack(self) -> Density:
        """s on all slits."""
        return self._on_slits(self._of_slits(1))

    def _on_slits(self, series: list[list[Array]]) -> Density:
        slits = self.merged.slits
        table = np.zeros((len(slits), max(len(one) for row in series for one in row)))
        for here, row in zip(self.slits, series, strict=True):
            for i, one in zip(here.which, row, strict=True):
                table[i, : len(one)] = one
        return Density(slits, cauchy(), table, ForcingJumps.none(), np.zeros(0))

    @cached_property
    def _edged(self) -> Density:
        """The smooth part with what P[s] adds to (alpha + beta t) / sqrt(1 - t^2)."""
        alpha, beta = (part.copy() for part in self.smooth.singular)
        for here, row in zip(self.slits, self.series, strict=True):
            for slit, d in zip(here.slits, row, strict=True):
                values = slit.at_gauss(d) / slit.x_root**2
                alpha[here.zone] += slit.half * float(np.mean(values * np.cos(slit.theta)))
                beta[here.zone] += slit.half * float(np.mean(values))
            for _, kink in self.kinks_of(here):
                alpha[here.zone] += kink.edge[0]
                beta[here.zone] += kink.edge[1]
        return replace(self.smooth, edges=(alpha, beta), bounded_ends=self.bounded_ends)

    # per piece
    def at(self, zone: ArrayLike, left: ArrayLike, right: ArrayLike) -> Array:
        """Density at points given by piece and the distances from its ends over its half width."""
        zone = np.asarray(zone, dtype=np.intp)
        if not self.merged.beside_slits[zone].any():  # a piece alone is its wide zone
            return self._edged.at(self.merged.piece_zone[zone], left, right)
        merged, wide = self.merged, self.merged.wide
        piece, lf, rt = np.broadcast_arrays(zone, np.asarray(left, float), np.asarray(right, float))
        shape = piece.shape
        piece, lf, rt = piece.ravel(), lf.ravel(), rt.ravel()
        half = self.zones.half[piece]
        i = merged.piece_zone[piece]
        w = wide.half[i]
        from_left, from_right = (
            (merged.start[piece] + lf * half) / w,
            (merged.rest[piece] + rt * half) / w,
        )
        out = self._edged.at(i, from_left, from_right).copy()
        for here, row in zip(self.slits, self._tilde, strict=True):
            on = np.flatnonzero(i == here.zone)
            if len(on) == 0:
                continue
            added = np.zeros(len(on))
            p = piece[on]
            begin, end = merged.start[p], merged.stop[p]
            for slit, a, b, d in zip(here.slits, here.start, here.stop, row, strict=True):
                past = begin >= b
                away = np.where(past, begin - b + lf[on] * half[on], a - end + rt[on] * half[on])
                added += off_slit(away / slit.width, np.where(past, 1.0, -1.0), d)
                for kink in (kink for k, kink in self.kinks_of(here) if here.slits[k] is slit):
                    out[on] += kink.beside(from_left[on], from_right[on], away / slit.width, past)
            out[on] += np.sqrt(from_left[on] * from_right[on]) * added
        if self.bounded_ends:
            at_left, at_right = self.zones.bounded[:, piece]
            out[at_left & (lf == 0) | at_right & (rt == 0)] = 0.0
        return np.asarray(out.reshape(shape))

    @cached_property
    def intensities(self) -> tuple[Array, Array]:
        """K at the left and right end of each piece. Across the end of a slit sigma / X goes on as
        the density, with the sign of K turned at its left end.
        """
        return self.edges(self._edged.intensities, self.sigma.intensities, (-1.0, 1.0))

    @cached_property
    def edge_slopes(self) -> tuple[Array, Array]:
        """A at the left and right end of each piece; at a slit's right end that of sigma with its
        sign turned.
        """
        left, right = (part.copy() for part in self._edged.edge_slopes)
        wide = self.merged.wide
        for here, row in zip(self.slits, self._tilde, strict=True):
            scale = slope_scale(wide.half[here.zone])
            for slit, before, after, d in zip(here.slits, here.start, here.rest, row, strict=True):
                left[here.zone] += scale * off_slit(np.array([before / slit.width]), -1.0, d)[0]
                right[here.zone] += scale * off_slit(np.array([after / slit.width]), 1.0, d)[0]
            for _, kink in self.kinks_of(here):
                left[here.zone] += scale * kink.edge_slopes[0]
                right[here.zone] += scale * kink.edge_slopes[1]
        slopes_left, slopes_right = self.edges((left, right), self._sigma_slopes, (1.0, -1.0))
        # 1 / X changes along the piece: K / (X sqrt(d)) has a share in A.
        k_left, k_right = self.intensities
        before, after = self.merged.slit_before, self.merged.slit_after
        by_left, by_right = (
            0.5 / from_end - 0.5 / to_end
            for from_end, to_end in zip(*self._beside_ends, strict=True)
        )  # d log X / dx
        slopes_left = slopes_left - np.where(before < 0, 0.0, (k_left * by_right[before]))
        slopes_right = slopes_right + np.where(after < 0, 0.0, (k_right * by_left[after]))
        return slopes_left, slopes_right

    @cached_property
    def _sigma_slopes(self) -> tuple[Array, Array]:
        """A of sigma at the left and right end of each slit, psi with it."""
        left, right = (part.copy() for part in self.sigma.edge_slopes)
        root_left, root_right = self.slit_roots
        for here in self.slits:
            for k, kink in self.kinks_of(here):
                i, slope = here.which[k], kink.at_ends / np.pi * slope_scale(here.slits[k].width)
                left[i] -= root_left[i] * slope
                right[i] += root_right[i] * slope
        return left, right

    @cached_property
    def sensitivity(self) -> tuple[Array, Array, Array]:
        """See `Density.sensitivity`, of the pieces; the slope by differences, since a piece has no
        series of its own.
        """
        angles = [
            self._looked_at(piece, count) for piece, count in enumerate(self._counts.tolist())
        ]
        peak, by_left, by_right = self.followed(np.arange(len(angles)), angles)
        return peak, by_left, by_right

    @cached_property
    def _counts(self) -> Index:
        """Even angles of each piece that show all of the density: its share of those of its wide
        zone, and as many again for the slits.
        """
        merged, w = self.merged, self.merged.wide.half[self.merged.piece_zone]
        left, right = (
            theta_of(merged.start / w, 2 - merged.start / w),
            theta_of(2 - merged.rest / w, merged.rest / w),
        )
        return np.clip(
            2 * self.sampling * (left - right) / np.pi, SAMPLES.min_samples, SAMPLES.max_angles
        ).astype(np.intp)

    def _looked_at(self, piece: int, count: int) -> Array:
        """So many angles of a piece, and some beside kinks."""
        merged, zone = self.merged, int(self.merged.piece_zone[piece])
        w, half, start = merged.wide.half[zone], self.zones.half[piece], merged.start[piece]
        theta = even_angles(count)
        left, height = self.jumps.sharpest(zone)
        left = (left * w - start) / half
        inside = (left > 0) & (left < 2)
        return beside_kinks(left[inside], height[inside], theta)

    def edges(
        self, wide: tuple[Array, Array], slits: tuple[Array, Array], signs: tuple[float, float]
    ) -> tuple[Array, Array]:
        """Values at the pieces' ends, from those of wide zones and of slits (over X, with signs for
        their two ends).
        """
        before, after = self.merged.slit_before, self.merged.slit_after
        root_left, root_right = self.slit_roots
        left = np.where(
            before < 0, wide[0][self.merged.piece_zone], (signs[1] * slits[1] / root_right)[before]
        )
        right = np.where(
            after < 0, wide[1][self.merged.piece_zone], (signs[0] * slits[0] / root_left)[after]
        )
        return left, right

    @cached_property
    def _beside_ends(self) -> tuple[Array, Array]:
        """Distances of the left and right ends of all slits (2, slits) from the left, from the
        right end of their wide zones.
        """
        merged, ends = self.merged, self.merged.slits.table.T
        return ends - merged.wide.a[merged.slit_zone], merged.wide.b[merged.slit_zone] - ends

    @cached_property
    def slit_roots(self) -> Array:
        """X at the left and right end of each slit (2, slits)."""
        from_left, from_right = self._beside_ends
        return np.asarray(
            np.sqrt(from_left * from_right) / self.merged.wide.half[self.merged.slit_zone]
        )

    # totals
    @property
    def total(self) -> float:
        return self.whole.total

    def moment(self, about: float = 0.0) -> float:
        return self.whole.moment(about)

    @cached_property
    def totals(self) -> Array:
        """Integral over each piece: that of its wide zone, or by Gauss-Chebyshev beside slits,
        doubled until it stays; of the logarithms of kinks in closed form.
        """
        out = self.whole.totals[self.merged.piece_zone].copy()
        wide, kinks = (
            self.merged.wide,
            replace(self.jumps.chosen(self.jumps.order == 0), splines={}),
        )
        for piece in np.flatnonzero(self.merged.beside_slits):
            zone = int(self.merged.piece_zone[piece])
            before, after = self.zones.a[piece] - wide.a[zone], wide.b[zone] - self.zones.b[piece]
            half, w = self.zones.half[piece], wide.half[zone]
            last, n, here = np.inf, 64, 0.0
            while n <= 16384:
                theta = even_angles(n)
                left, right = sides(theta)
                value = self.at(piece, left, right)
                if zone in kinks.by_zone:
                    value = value - kinks.density(
                        zone, (before + half * left) / w, (after + half * right) / w
                    )
                    value = np.where(np.isfinite(value), value, 0.0)
                here = float(half) * np.pi / n * float(value @ np.sin(theta))
                if abs(here - last) <= 1e-13 * abs(here):
                    break
                last, n = here, 2 * n
            if zone in kinks.by_zone:
                ends = (
                    np.array([before, before + 2 * half]) / w,
                    np.array([after + 2 * half, after]) / w,
                )
                here += float(w * np.diff(kinks.integral(np.full(2, zone), *ends))[0])
            out[piece] = here
        return out

    # the line
    def _into_wide(self, x: Array) -> Array:
        """x moved by periods to lie right of the first wide zone's left end."""
        return wrapped(x, self.merged.wide.a[0], self.kernel.period)

    @property
    def slit_count(self) -> int:
        """How many narrow gaps between the zones are taken as slits of wider ones."""
        return len(self.merged.slits)

    def opening(self, x: ArrayLike) -> tuple[Mask, Array]:
        """(whether x lies in a slit, integral of s from the slit's left end to x)."""
        place = self._into_wide(np.asarray(x, dtype=float))
        slack = self._slack
        inside = slack.locate(place)[2]
        opened = slack.integral(place)
        for kink, width, some, left, right in self._in_kinks(place):
            opened[some] += width * kink.opening(left, right)
        return inside, opened

    def slack(self, place: Array) -> Array:
        """s at places on the wide zones, zero off the slits."""
        out = self._slack(place)
        for kink, _, some, left, right in self._in_kinks(place):
            out[some] += kink.slope(left, right)
        return out

    def _in_kinks(self, place: Array) -> Iterator[tuple[SlitKink, float, Mask, Array, Array]]:
        """For each jump in a slit: itself, the slit's half width, which places lie in it, and how
        far from its ends over that.
        """
        for here in self.slits:
            for k, kink in self.kinks_of(here):
                a, b, width = here.a[k], here.b[k], here.slits[k].width
                some = (place >= a) & (place <= b)
                yield kink, width, some, (place[some] - a) / width, (b - place[some]) / width

    @cached_property
    def plane(self) -> SlitPlane:
        """The density at complex points."""
        kinks = [self.kinks_of(here) for here in self.slits]
        return SlitPlane(
            self.merged, self.whole, self._told_density, self.slits, self.series, kinks
        )

    def _on_line(self, x: Array, potential: bool) -> Array:
        flat = x.ravel()
        out = np.array(self.whole.potential(flat) if potential else self.whole.transform(flat))
        self._near_slits(flat, out, potential)
        place = self._into_wide(flat)
        if not potential:
            return np.asarray((out - self.slack(place)).reshape(x.shape))
        # On a wide zone P[s] raises the potential by its mean opening, and takes the opening away.
        i = np.maximum(np.searchsorted(self.merged.wide.a, place, side="right") - 1, 0)
        on = (place >= self.merged.wide.a[i]) & (place <= self.merged.wide.b[i])
        out += np.where(on, self.mean_openings[i] - self.opening(place)[1], 0.0)
        return np.asarray(out.reshape(x.shape))

    @cached_property
    def mean_openings(self) -> Array:
        """Mean over each wide zone of the integral of s."""
        out = np.zeros(len(self.merged.wide))
        for here, row in zip(self.slits, self.series, strict=True):
            out[here.zone] = here.mean_row @ np.concatenate(row) + (
                here.mean_of_kinks if self.forced else 0.0
            )
        return out

    @cached_property
    def _told_density(self) -> Density:
        """s as what other zones see of it, on the wide zones that have slits."""
        some = np.array([here.zone for here in self.slits])
        count = max(self.whole.coefficients.shape[1], self.smooth.coefficients.shape[1])
        whole, smooth = (widened(d.coefficients[some], count) for d in (self.whole, self.smooth))
        zones = Zones.of(self.merged.wide.table[some])
        return Density(zones, self.kernel, whole - smooth, ForcingJumps.none(), np.zeros(0))

    def _near_slits(self, x: Array, out: Array, potential: bool) -> None:
        """Puts right what the slits do close to their wide zones and to images of these, where as
        many of their coefficients as others are told do not tell it: takes that out of `out`, and
        off the zone puts in what they do.
        """
        x = self.smooth.into_period(x)
        order = np.argsort(x, kind="stable")
        ascending = x[order]
        wide, what = self.merged.wide, self._potential if potential else self._transform
        for number, (here, row) in enumerate(zip(self.slits, self.series, strict=True)):
            w = wide.half[here.zone]
            for shift in self.kernel.poles:
                a, b = wide.a[here.zone] + shift, wide.b[here.zone] + shift
                first, last = np.searchsorted(ascending, [a - _FAR * w, b + _FAR * w])
                for block in pair_blocks(int(last - first), OPTIONS.min_slack_modes):
                    some = order[first:last][block]
                    out[some] -= from_zones(
                        self._told_density, x[some], np.full(len(some), number), shift, potential
                    )
                    left, right = (x[some] - a) / w, (b - x[some]) / w
                    off = (left < 0) | (right < 0)
                    seen = Outside(
                        np.where(left[off] < 0, -1.0, 1.0), -np.minimum(left[off], right[off])
                    )
                    out[some[off]] += what(seen, here, row)

    def _transform(self, seen: Outside, here: Slits, row: list[Array]) -> Array:
        """Transform of P[s] off its wide zone: (sgn z / sqrt(z^2 - 1)) (1/pi) int sigma / (z - tau)
        dtau.
        """
        total, past = np.zeros(seen.excess.shape), seen.sign > 0
        for slit, d in zip(here.slits, row, strict=True):
            total += off_slit(
                (seen.excess + np.where(past, slit.rest, slit.start)) / slit.half, seen.sign, d
            )
        for _, kink in self.kinks_of(here):
            left, right, _, weight = kink.seen
            away = seen.excess[:, None] + np.where(past[:, None], right, left)
            total += seen.sign / np.pi * ((np.sqrt(left * right) / away) @ weight)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(total / seen.root)

    def _potential(self, seen: Outside, here: Slits, row: list[Array]) -> Array:
        """Potential of P[s] off its wide zone: -w sum s_k rho^k / k, summed in closed form over
        each slit.
        """
        rho = seen.rho
        total = np.zeros(rho.shape)

        def angles(theta: Array) -> Array:
            return np.asarray(
                np.arctan2(rho[:, None] * np.sin(theta), 1 - rho[:, None] * np.cos(theta))
            )

        for slit, d in zip(here.slits, row, strict=True):
            values = slit.at_gauss(d) / slit.x_root / slit.nodes
            total -= 2 * slit.width * (angles(slit.theta) @ values)
        for _, kink in self.kinks_of(here):
            _, _, theta, weight = kink.seen
            total -= 2 / np.pi * here.w * (angles(theta) @ weight)
        return total


def _closed(d: Array) -> Array:
    """The series without (alpha + beta z) / sqrt(1 - z^2): from (1 - z^2) U_k = (T_k - T_(k+2)) /
    2.
    """
    u = chebyshev.bounded_part(d[None])[2][0]
    out = np.zeros(len(u) + 2)
    out[: len(u)] += 0.5 * u
    out[2:] -= 0.5 * u
    return out
