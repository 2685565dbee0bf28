"""The density on zones with narrow gaps, computed from wide zones with slits.

`sie.slits.slits` has the equations. The given zones are the pieces of the wide zones between the
slits. The slack s in the slits causes a density P[s] on the wide zones.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from sie.basis import chebyshev
from sie.basis.data import DIGITS, Array, Index, Mask, widened, wrapped
from sie.basis.interval import Outside, excess_of, integral_on, root_weight, sides
from sie.basis.interval import theta as theta_of
from sie.basis.kernels import Kernel, cauchy
from sie.basis.sums import pair_blocks
from sie.basis.zones import Zones
from sie.density.base import DensityBase
from sie.density.density import Density
from sie.density.series import OPTIONS as SAMPLES
from sie.density.series import angles_at_kinks, even_angles, from_zones
from sie.jumps.right_side import ForcingJumps
from sie.slits.kinks import SlitKink
from sie.slits.plane import SlitPlane
from sie.slits.slits import OPTIONS, SlitGeometry, Slits, outside_slit

# Distance from a wide zone, divided by its half width, beyond which a short series is enough. There
# the first `min_slack_modes` coefficients of the slack (the unknown function in a slit) give the
# field of the slack to round-off.
_FAR = excess_of(DIGITS / OPTIONS.min_slack_modes)


@dataclass(frozen=True, eq=False)
class SlitDensity(DensityBase):
    """The density phi on zones with narrow gaps, which are treated as cuts in wide zones.

    It has the members of `Density`, for the zones as they were given. `solve_zones` makes it. On
    the wide zones the right side is g - s, with the given right side g. The slack s is the unknown
    function in the slits (the cuts) and is zero off them.

    Attributes
    ----------
    geometry : SlitGeometry
        The zones (`geometry.pieces`), the wide zones that span the narrow gaps (`geometry.wide`),
        and the slits in the wide zones.
    smooth : Density
        c = phi - P[s] on the wide zones, as smooth as the right side; P[s] is the density that the
        slack s causes.
    whole : Density
        phi on the wide zones from a limited number of coefficients, enough for the field far away.
    slits : tuple of Slits
        The slits, for each wide zone that has any.
    d : tuple of ndarray
        For each of `slits`, the series of sigma = s sqrt(1 - t^2) on its slits, one after the other
        (modes,).
    bounded_ends : bool
        Whether round-off traces of 1/sqrt(d) at free ends are removed; see
        `Density.with_bounded_ends`.
    forced : bool
        Whether the density includes the effect of the right side and of its jumps in slits. It does
        not for a response, the density due to changed side conditions alone.

    Examples
    --------
    >>> import numpy as np, sie
    >>> wave = sie.Forcing(np.sin, lambda x: -np.cos(x))
    >>> near = sie.Zones.of([[-1.0, -0.001], [0.001, 1.0]])
    >>> charge = sie.Equation(sie.cauchy(), wave, (sie.Total(1.0), sie.EqualPotential()))
    >>> density = sie.solve_zones(charge, near).density
    >>> type(density).__name__, density.totals.round(9).tolist()
    ('SlitDensity', [0.5, 0.5])
    """

    geometry: SlitGeometry
    smooth: Density
    whole: Density
    slits: tuple[Slits, ...]
    d: tuple[Array, ...]
    bounded_ends: bool = False
    forced: bool = True

    @property
    def zones(self) -> Zones:
        return self.geometry.pieces

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
        """Coefficients of the density's smooth part on the wide zones (joined across slits)."""
        return self.smooth.coefficients

    @cached_property
    def sampling(self) -> Index:
        return self.smooth.sampling[self.geometry.piece_zone]

    def kinks_of(self, here: Slits) -> list[tuple[int, SlitKink]]:
        """Jumps of the right side in the slits `here` of a wide zone, each as (slit index, jump).

        The list is empty if the right side is zero (see `forced`).
        """
        return here.kinks if self.forced else []

    # The methods below give the series of functions on the slits (narrow gaps in wide zones).
    @cached_property
    def series(self) -> list[list[Array]]:
        """Series of sigma = s sqrt(1 - t^2) in each slit (narrow gap), with the slack s.
        The slack is the unknown function in a slit; t is the coordinate of the wide zone around it.

        If `bounded_ends`, traces of the intensity K at the slits' ends are removed.
        """
        split = [np.split(d, here.offset[1:-1]) for here, d in zip(self.slits, self.d, strict=True)]
        return [[_closed(one) for one in row] for row in split] if self.bounded_ends else split

    def _of_slits(self, power: int) -> list[list[Array]]:
        """Series of s X^(1 - power) in each slit (narrow gap), with the slack s.
        The slack is the unknown function in a slit. X = sqrt(1 - t^2), with the coordinate t of the
        wide zone around the slit.
        """
        return [
            [slit.over(d, power) for slit, d in zip(here.slits, row, strict=True)]
            for here, row in zip(self.slits, self.series, strict=True)
        ]

    @cached_property
    def _tilde(self) -> list[list[Array]]:
        """Series of s / X in each slit (narrow gap), with the slack s.
        The slack is the unknown function in a slit. X = sqrt(1 - t^2), with the coordinate t of the
        wide zone around the slit. In terms of sigma = s X, the function s / X is sigma / X^2.

        X times the Cauchy transform of sigma / X^2 is the density P[s] that the slack causes,
        except for its part (alpha + beta t) / X.
        """
        found = self._of_slits(2)
        return [[_closed(one) for one in row] for row in found] if self.bounded_ends else found

    @cached_property
    def sigma(self) -> Density:
        """s sqrt(1 - t^2) in the slits (narrow gaps), as a `Density`, with the slack s.
        The slack is the unknown function in a slit; t is the coordinate of the wide zone around it.
        """
        return self._on_slits(self.series)

    @cached_property
    def _slack(self) -> Density:
        """The slack, which is the unknown function s in the slits (narrow gaps), as a `Density`."""
        return self._on_slits(self._of_slits(1))

    def _on_slits(self, series: list[list[Array]]) -> Density:
        """A `Density` whose zones are the slits (narrow gaps), with coefficients from `series`."""
        slits = self.geometry.slits
        table = np.zeros((len(slits), max(len(one) for row in series for one in row)))
        for here, row in zip(self.slits, series, strict=True):
            for i, one in zip(here.which, row, strict=True):
                table[i, : len(one)] = one
        return Density(slits, cauchy(), table, ForcingJumps.none(), np.zeros(0))

    @cached_property
    def _edged(self) -> Density:
        """Smooth part of the density, plus the slits' part that is singular at ends of wide zones.
        A slit is a narrow gap inside a wide zone. The singular part is (alpha + beta t) / X, X =
        sqrt(1 - t^2), with the coordinate t of the wide zone.
        """
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

    # The methods below give the density on the given zones. A wide zone joins the given zones on
    # both sides of its slits (narrow gaps).
    def at(self, zone: ArrayLike, left: ArrayLike, right: ArrayLike) -> Array:
        """Density at points given by a zone and distances from the zone's ends in half widths."""
        zone = np.asarray(zone, dtype=np.intp)
        # Slits (narrow gaps) divide a wide zone into given zones. A given zone without adjacent
        # slits is itself a wide zone, and its density has no part of slits.
        if not self.geometry.next_to_slit[zone].any():
            return self._edged.at(self.geometry.piece_zone[zone], left, right)
        geometry, wide = self.geometry, self.geometry.wide
        piece, lf, rt = np.broadcast_arrays(zone, np.asarray(left, float), np.asarray(right, float))
        shape = piece.shape
        piece, lf, rt = piece.ravel(), lf.ravel(), rt.ravel()
        half = self.zones.half[piece]
        i = geometry.piece_zone[piece]
        w = wide.half[i]
        from_left, from_right = (
            (geometry.start[piece] + lf * half) / w,
            (geometry.rest[piece] + rt * half) / w,
        )
        out = self._edged.at(i, from_left, from_right).copy()
        for here, row in zip(self.slits, self._tilde, strict=True):
            on = np.flatnonzero(i == here.zone)
            if len(on) == 0:
                continue
            added = np.zeros(len(on))
            p = piece[on]
            begin, end = geometry.start[p], geometry.stop[p]
            for slit, a, b, d in zip(here.slits, here.start, here.stop, row, strict=True):
                past = begin >= b
                away = np.where(past, begin - b + lf[on] * half[on], a - end + rt[on] * half[on])
                added += outside_slit(away / slit.width, np.where(past, 1.0, -1.0), d)
                for kink in (kink for k, kink in self.kinks_of(here) if here.slits[k] is slit):
                    out[on] += kink.outside_slit(
                        from_left[on], from_right[on], away / slit.width, past
                    )
            out[on] += root_weight(from_left[on], from_right[on]) * added
        if self.bounded_ends:
            at_left, at_right = self.zones.bounded[:, piece]
            out[at_left & (lf == 0) | at_right & (rt == 0)] = 0.0
        return np.asarray(out.reshape(shape))

    @cached_property
    def intensities(self) -> tuple[Array, Array]:
        """Intensities K at the left and right end of each given zone.
        K is the coefficient of 1 / sqrt(distance) in the density close to an end.
        At an end of a slit, K is the intensity of sigma / X, with the opposite sign at the slit's
        left end. X is sqrt(1 - t^2), with the coordinate t of the wide zone.
        """
        return self.edges(self._edged.intensities, self.sigma.intensities, (-1.0, 1.0))

    @cached_property
    def edge_slopes(self) -> tuple[Array, Array]:
        """Edge slopes A of the density at the left and right end of each given zone.
        A is the coefficient of sqrt(d) at the distance d from the end.
        At an end of a slit, A is the edge slope of sigma / X, with the opposite sign at the slit's
        right end. X is sqrt(1 - t^2), with the coordinate t of the wide zone.
        """
        left, right = (part.copy() for part in self._edged.edge_slopes)
        wide = self.geometry.wide
        for here, row in zip(self.slits, self._tilde, strict=True):
            scale = wide.slope_scale[here.zone]
            for slit, before, after, d in zip(here.slits, here.start, here.rest, row, strict=True):
                left[here.zone] += scale * outside_slit(np.array([before / slit.width]), -1.0, d)[0]
                right[here.zone] += scale * outside_slit(np.array([after / slit.width]), 1.0, d)[0]
            for _, kink in self.kinks_of(here):
                left[here.zone] += scale * kink.edge_slopes[0]
                right[here.zone] += scale * kink.edge_slopes[1]
        slopes_left, slopes_right = self.edges((left, right), self._sigma_slopes, (1.0, -1.0))
        # Beside an end the density is K / sqrt(d) + A sqrt(d). It contains the wide zone's factor
        # 1 / sqrt(1 - t^2), which varies with the distance d, so that K contributes to A.
        k_left, k_right = self.intensities
        before, after = self.geometry.slit_before, self.geometry.slit_after
        by_left, by_right = (
            0.5 / from_end - 0.5 / to_end
            for from_end, to_end in zip(*self._end_distances, strict=True)
        )  # derivative of log(sqrt(1 - t^2)) by x
        slopes_left = slopes_left - np.where(before < 0, 0.0, (k_left * by_right[before]))
        slopes_right = slopes_right + np.where(after < 0, 0.0, (k_right * by_left[after]))
        return slopes_left, slopes_right

    @cached_property
    def _sigma_slopes(self) -> tuple[Array, Array]:
        """Coefficients of sqrt(d) in s sqrt(1 - t^2) at a distance d from the ends of the slits.
        s is the slack (the slit's unknown), with the part psi that jumps cause (see
        `sie.slits.kinks`).
        """
        left, right = (part.copy() for part in self.sigma.edge_slopes)
        root_left, root_right = self.slit_roots
        for here in self.slits:
            for k, kink in self.kinks_of(here):
                i = here.which[k]
                slope = kink.end_factor / np.pi * self.geometry.slits.slope_scale[i]
                left[i] -= root_left[i] * slope
                right[i] += root_right[i] * slope
        return left, right

    @cached_property
    def sensitivity(self) -> tuple[Array, Array, Array]:
        """Largest density on each zone, and its largest changes if the left or right end moves.
        Returns (densities, changes for left ends, changes for right ends); see
        `Density.sensitivity`. The derivative of the density along a zone, which the changes need,
        is a difference of values at two close points.
        """
        angles = [
            self._sample_angles(piece, count) for piece, count in enumerate(self._counts.tolist())
        ]
        peak, by_left, by_right = self.largest_changes(np.arange(len(angles)), angles)
        return peak, by_left, by_right

    @cached_property
    def _counts(self) -> Index:
        """Number of angles at which the density is sampled on each given zone.

        It is the zone's share of the angles of its wide zone, doubled because of the slits.
        """
        geometry, w = self.geometry, self.geometry.wide.half[self.geometry.piece_zone]
        left, right = (
            theta_of(geometry.start / w, 2 - geometry.start / w),
            theta_of(2 - geometry.rest / w, geometry.rest / w),
        )
        return np.clip(
            2 * self.sampling * (left - right) / np.pi, SAMPLES.samples, SAMPLES.max_angles
        ).astype(np.intp)

    def _sample_angles(self, piece: int, count: int) -> Array:
        """`count` even angles on a given zone, with angles added where the density is steepest."""
        geometry, zone = self.geometry, int(self.geometry.piece_zone[piece])
        w, half, start = geometry.wide.half[zone], self.zones.half[piece], geometry.start[piece]
        theta = even_angles(count)
        left, height = self.jumps.sharpest(zone)
        left = (left * w - start) / half
        inside = (left > 0) & (left < 2)
        return angles_at_kinks(left[inside], height[inside], theta)

    def edges(
        self, wide: tuple[Array, Array], slits: tuple[Array, Array], signs: tuple[float, float]
    ) -> tuple[Array, Array]:
        """A quantity at the given zones' ends, from its values at ends of wide zones and slits.

        A given zone ends at an end of a wide zone or at a slit, a narrow gap inside the wide zone.

        wide, slits: values at left and at right ends. The values of slits are divided by
        sqrt(1 - t^2) of the wide zone and multiplied by `signs`, one for left, one for right ends.
        """
        before, after = self.geometry.slit_before, self.geometry.slit_after
        root_left, root_right = self.slit_roots
        left = np.where(
            before < 0,
            wide[0][self.geometry.piece_zone],
            (signs[1] * slits[1] / root_right)[before],
        )
        right = np.where(
            after < 0, wide[1][self.geometry.piece_zone], (signs[0] * slits[0] / root_left)[after]
        )
        return left, right

    @cached_property
    def _end_distances(self) -> tuple[Array, Array]:
        """Distances of the slits' ends from the left and from the right end of their wide zone.

        Two arrays (2, slits): the first row is for left ends of slits, the second for right ends.
        """
        geometry, ends = self.geometry, self.geometry.slits.table.T
        return ends - geometry.wide.a[geometry.slit_zone], geometry.wide.b[
            geometry.slit_zone
        ] - ends

    @cached_property
    def slit_roots(self) -> Array:
        """sqrt(1 - t^2) of the wide zone at the left and right end of each slit (2, slits)."""
        from_left, from_right = self._end_distances
        return np.asarray(
            root_weight(from_left, from_right) / self.geometry.wide.half[self.geometry.slit_zone]
        )

    # The methods below integrate the density.
    @property
    def total(self) -> float:
        return self.whole.total

    def moment(self, about: float = 0.0) -> float:
        return self.whole.moment(about)

    @cached_property
    def totals(self) -> Array:
        """Integral of the density over each given zone.

        A zone without slits has the integral of its wide zone. The others are integrated by
        Gauss-Chebyshev quadrature, with doubled node counts until the value no longer changes. The
        logarithms of kinks are integrated in closed form.
        """
        out = self.whole.totals[self.geometry.piece_zone].copy()
        for piece in np.flatnonzero(self.geometry.next_to_slit):
            out[piece] = self._integral_on(int(piece), np.zeros(1))[0]
        return out

    def integral(self, x: ArrayLike) -> Array:
        """Integral of the density up to x from the left end of the zone that contains x.

        The integral is zero for x off the zones.
        """
        x, i, inside = self.locate(x)
        out = np.zeros(x.shape)
        for piece in np.unique(i[inside]):
            here = inside & (i == piece)
            if not self.geometry.next_to_slit[piece]:
                out[here] = self.whole.integral(x[here])
                continue
            w, at = self.zones.half[piece], np.full(np.count_nonzero(here), piece)
            left, right = self.zones.beyond_a(x[here], at), self.zones.before_b(x[here], at)
            out[here] = self._integral_on(int(piece), theta_of(left / w, right / w))
        return out

    @cached_property
    def _kinks(self) -> ForcingJumps:
        """Jumps of the right side itself (order 0), not of its derivatives, inside the given zones.

        They cause logarithms in the density. The closed forms of these logarithms vanish at the
        ends of the given zones, not of the wide ones. So the density minus the closed forms is as
        smooth there as the density.
        """
        kinks, wide = self.jumps.chosen(self.jumps.order == 0), self.geometry.wide
        at = wide.a[kinks.zone] + wide.half[kinks.zone] * kinks.left
        return type(kinks).placed(self.zones, at, kinks.height, kinks.order, self.kernel.period)

    def _integral_on(self, piece: int, angle: Array) -> Array:
        """Integral of the density from the left end of a given zone to t = cos(angle)."""
        series, row = self._smooth_series(piece), np.zeros(len(angle), dtype=np.intp)
        out = integral_on(series[None], row, angle)
        if piece in self._kinks.by_zone:
            out = out + self._kinks.integral(row + piece, *sides(angle))
        return np.asarray(self.zones.half[piece] * out)

    def _smooth_series(self, piece: int) -> Array:
        """Coefficients in T_j / sqrt(1 - t^2) of the smooth part of the density on a given zone.
        The smooth part is the density minus the logarithms that jumps of the right side cause. t is
        the coordinate of the given zone.
        """
        if piece not in self._kept_series:
            last, n = np.inf, 64
            while True:
                theta = even_angles(n)
                left, right = sides(theta)
                value = self.at(piece, left, right)
                if piece in self._kinks.by_zone:
                    value = value - self._kinks.density(piece, left, right)
                    value = np.where(np.isfinite(value), value, 0.0)
                mean = float(value @ np.sin(theta)) / n
                if abs(mean - last) <= 1e-13 * abs(mean) or n == 16384:
                    break
                last, n = mean, 2 * n
            series = 2 * chebyshev.t_means(value * np.sin(theta))
            series[0] = mean
            self._kept_series[piece] = series
        return self._kept_series[piece]

    @cached_property
    def _kept_series(self) -> dict[int, Array]:
        """The series of `_smooth_series` that have been computed, by zone."""
        return {}

    # The methods below give, at real points, the transform, the potential and the slack. The slack
    # is the unknown function in a slit, a narrow gap inside a wide zone.
    def _into_wide(self, x: Array) -> Array:
        """Points x moved by whole periods into the period that starts with the first wide zone."""
        return wrapped(x, self.geometry.wide.a[0], self.kernel.period)

    @property
    def slit_count(self) -> int:
        """Number of narrow gaps that are treated as cuts (slits) inside wider zones."""
        return len(self.geometry.slits)

    def opening(self, x: ArrayLike) -> tuple[Mask, Array]:
        """(whether x is in a slit, integral of the slack from the slit's left end to x).

        A slit is a narrow gap inside a wide zone, and the slack is the unknown function in it.
        """
        place = self._into_wide(np.asarray(x, dtype=float))
        slack = self._slack
        inside = slack.locate(place)[2]
        opened = slack.integral(place)
        for kink, width, some, left, right in self._in_kinks(place):
            opened[some] += width * kink.opening(left, right)
        return inside, opened

    def slack(self, place: Array) -> Array:
        """The slack at `place`: the unknown function in slits (narrow gaps), zero outside them."""
        out = self._slack(place)
        for kink, _, some, left, right in self._in_kinks(place):
            out[some] += kink.slope(left, right)
        return out

    def _in_kinks(self, place: Array) -> Iterator[tuple[SlitKink, float, Mask, Array, Array]]:
        """Yield (jump, half width of its slit, mask, left, right) for each jump in a slit.

        A slit is a narrow gap inside a wide zone. The mask selects the places in that slit; left
        and right are their distances from the slit's ends, in half widths of the slit.
        """
        for here in self.slits:
            for k, kink in self.kinks_of(here):
                a, b, width = here.a[k], here.b[k], here.slits[k].width
                some = (place >= a) & (place <= b)
                yield kink, width, some, (place[some] - a) / width, (b - place[some]) / width

    @cached_property
    def plane(self) -> SlitPlane:
        """Transform and potential of the density at complex points, as a function of the points."""
        kinks = [self.kinks_of(here) for here in self.slits]
        return SlitPlane(
            self.geometry, self.whole, self._slack_density, self.slits, self.series, kinks
        )

    def _on_line(self, x: Array, potential: bool) -> Array:
        """Transform or potential of the density at real points x.

        It is computed from the first coefficients of the density on the wide zones, and corrected
        close to wide zones with slits.
        """
        flat = x.ravel()
        out = np.array(self.whole.potential(flat) if potential else self.whole.transform(flat))
        self._add_slits(flat, out, potential)
        place = self._into_wide(flat)
        if not potential:
            return np.asarray((out - self.slack(place)).reshape(x.shape))
        # The slack is the unknown in a slit, and the opening at x is the integral of the slack up
        # to x. On a wide zone, the density that the slack causes adds a potential. This potential
        # is the mean of the opening over the zone minus the opening at x.
        i = np.maximum(np.searchsorted(self.geometry.wide.a, place, side="right") - 1, 0)
        on = (place >= self.geometry.wide.a[i]) & (place <= self.geometry.wide.b[i])
        out += np.where(on, self.mean_openings[i] - self.opening(place)[1], 0.0)
        return np.asarray(out.reshape(x.shape))

    @cached_property
    def mean_openings(self) -> Array:
        """Mean over each wide zone of the opening, with the weight 1 / sqrt(1 - t^2).

        The opening at x is the integral of the slack from a slit's left end to x, and 0 off the
        slits. The slack is the unknown function in the slits, the narrow gaps of the wide zone.
        """
        out = np.zeros(len(self.geometry.wide))
        for here, row in zip(self.slits, self.series, strict=True):
            out[here.zone] = here.mean_row @ np.concatenate(row) + (
                here.mean_of_kinks if self.forced else 0.0
            )
        return out

    @cached_property
    def _slack_density(self) -> Density:
        """The part of `whole` due to the slits (narrow gaps), on the wide zones that have slits.

        It has the first coefficients of the slack, the unknown function in the slits. They give the
        field far from these wide zones.
        """
        some = np.array([here.zone for here in self.slits])
        count = max(self.whole.coefficients.shape[1], self.smooth.coefficients.shape[1])
        whole, smooth = (widened(d.coefficients[some], count) for d in (self.whole, self.smooth))
        zones = Zones.of(self.geometry.wide.table[some])
        return Density(zones, self.kernel, whole - smooth, ForcingJumps.none(), np.zeros(0))

    def _add_slits(self, x: Array, out: Array, potential: bool) -> None:
        """Correct `out` (transform or potential) at points x close to wide zones with slits.

        `out` was computed from the first coefficients of the slack s, which are too few at such
        points. The field of these coefficients is subtracted. At points off the wide zone, the
        closed form is added. Points close to periodic images of the zone are treated likewise.
        """
        x = self.smooth.into_period(x)
        order = np.argsort(x, kind="stable")
        ascending = x[order]
        wide, what = self.geometry.wide, self._potential if potential else self._transform
        for number, (here, row) in enumerate(zip(self.slits, self.series, strict=True)):
            w = wide.half[here.zone]
            for shift in self.kernel.poles:
                a, b = wide.a[here.zone] + shift, wide.b[here.zone] + shift
                first, last = np.searchsorted(ascending, [a - _FAR * w, b + _FAR * w])
                for block in pair_blocks(int(last - first), OPTIONS.min_slack_modes):
                    some = order[first:last][block]
                    out[some] -= from_zones(
                        self._slack_density, x[some], np.full(len(some), number), shift, potential
                    )
                    left, right = (x[some] - a) / w, (b - x[some]) / w
                    off = (left < 0) | (right < 0)
                    seen = Outside(
                        np.where(left[off] < 0, -1.0, 1.0), -np.minimum(left[off], right[off])
                    )
                    out[some[off]] += what(seen, here, row)

    def _transform(self, seen: Outside, here: Slits, row: list[Array]) -> Array:
        """Transform, outside a wide zone, of the density due to the slack s in its narrow gaps.

        It is (sgn z / sqrt(z^2 - 1)) (1/pi) int sigma / (z - tau) dtau. In the gaps, sigma is
        s sqrt(1 - t^2).
        """
        total, past = np.zeros(seen.excess.shape), seen.sign > 0
        for slit, d in zip(here.slits, row, strict=True):
            total += outside_slit(
                (seen.excess + np.where(past, slit.rest, slit.start)) / slit.half, seen.sign, d
            )
        for _, kink in self.kinks_of(here):
            left, right, _, weight = kink.quadrature
            away = seen.excess[:, None] + np.where(past[:, None], right, left)
            total += seen.sign / np.pi * ((root_weight(left, right) / away) @ weight)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(total / seen.root)

    def _potential(self, seen: Outside, here: Slits, row: list[Array]) -> Array:
        """Potential, outside a wide zone, of the density due to the slack s in its narrow gaps.

        It is -w sum s_k rho^k / k, with the half width w of the zone and the sine coefficients s_k
        of s. The sum over k has a closed form, which is integrated over each slit.
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
            _, _, theta, weight = kink.quadrature
            total -= 2 / np.pi * here.w * (angles(theta) @ weight)
        return total


def _closed(d: Array) -> Array:
    """Coefficients of sum d_l T_l(z) / sqrt(1 - z^2) without the part unbounded at z = -1 and 1.

    It follows from (1 - z^2) U_k = (T_k - T_(k+2)) / 2.
    """
    u = chebyshev.bounded_part(d[None])[2][0]
    out = np.zeros(len(u) + 2)
    out[: len(u)] += 0.5 * u
    out[2:] -= 0.5 * u
    return out
