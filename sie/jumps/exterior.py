r"""Logarithms of the right side just outside a zone, in closed form.

With s > 1 or s < -1 and rho = s - sgn(s) sqrt(s^2 - 1), |rho| < 1, the bounded density

    beta(t) = -(2/pi) sum_j (rho^j / j) sin(j theta)
            = -(2/pi) atan2(rho sin(theta), 1 - rho cos(theta))

has the transform (1/pi) ln(2 |rho| |t - s|) on the zone, and (2/pi) ln(1 - rho rho_z) off it. It is
the density of `sie.jumps.density` with cos(j phi) continued to rho^j. Without it a logarithm close
to an end would need 1/sqrt(distance) modes.
"""

import numpy as np

from sie.basis.data import Array, Index, numbered, record, wrapped
from sie.basis.interval import Complex, InPlane, Outside, What, theta
from sie.basis.sums import PerZone
from sie.basis.zones import Zones
from sie.jumps.formulas import OPTIONS


@record
class ExteriorLogarithms(PerZone):
    """Logarithms outside zones, one entry for each zone that they are close to.

    zone: the zone; which: number of the logarithm; rho: its place seen from the zone; weight: J/pi.
    """

    zone: Index
    which: Index
    rho: Array
    weight: Array

    @classmethod
    def nothing(cls) -> "ExteriorLogarithms":
        none = np.zeros(0, np.intp)
        return cls(none, none, np.zeros(0), np.zeros(0))

    @classmethod
    def near(
        cls, zones: Zones, at: Array, weights: Array, period: float | None
    ) -> "ExteriorLogarithms":
        """Select the logarithms at `at` (repeated with the period) that lie outside a zone but
        close to it.
        """
        which = np.arange(len(at))
        if period is not None:
            at = wrapped(at, zones.a[0], period)
            at, which = np.concatenate((at - period, at, at + period)), np.tile(which, 3)
        order = np.argsort(at, kind="stable")
        at, which = at[order], which[order]
        reach = OPTIONS.reach * zones.half
        if period is not None:
            # A place must be close to one end only, even if the zone is almost a period wide.
            reach = np.clip(reach, 0.0, np.maximum(0.49 * period - zones.half, 0.0))
        found: list[tuple[Index, Index, Array]] = []
        for sign, ends in ((1.0, zones.b), (-1.0, zones.a)):
            lo, hi = (ends, ends + reach) if sign > 0 else (ends - reach, ends)
            first, last = (
                np.searchsorted(at, lo, side="left"),
                np.searchsorted(at, hi, side="right"),
            )
            count = last - first
            zone = np.repeat(np.arange(len(zones)), count)
            place = numbered(count) + np.repeat(first, count)
            # An end on the logarithm itself has rho = 1.
            e = np.abs(at[place] - ends[zone]) / zones.half[zone]
            found.append((zone, which[place], Outside(sign, e).rho))
        zone, which, rho = (np.concatenate(parts) for parts in zip(*found, strict=True))
        return cls(zone, which, rho, weights[which])

    def sine_coefficients(self, count: int) -> Array:
        """Coefficients of sin(j theta), j = 1 ... count, one row for each entry."""
        j = np.arange(1, count + 1)
        return np.asarray(-2 * self.weight[:, None] * self.rho[:, None] ** j / j)

    def edge_slopes(self) -> tuple[Array, Array]:
        """Coefficients of the angle from the left and from the right end, for each entry."""
        with np.errstate(divide="ignore"):
            return -2 * self.weight * self.rho / (1 + self.rho), -2 * self.weight * self.rho / (
                1 - self.rho
            )

    # Values at points (n,) of zones, given by their distances from the zone's ends over w.
    def density(self, zone: Index, left: Array, right: Array) -> Array:
        """Density of the logarithms on their own zones."""
        phi = theta(left, right)

        def part(at: Index, k: Index) -> Array:
            rho = self.rho[k]
            return np.asarray(np.arctan2(rho * np.sin(phi[at]), 1 - rho * np.cos(phi[at])))

        return self.grouped.summed(zone, -2 * self.weight, part)

    def own_transform(self, zone: Index, left: Array) -> Array:
        """Transform on the zone itself.

        ln(1 - 2 rho t + rho^2) = ln((1 - |rho|)^2 + 2 |rho| d), with d the distance from the nearer
        end.
        """

        def part(at: Index, k: Index) -> Array:
            rho, size = self.rho[k], np.abs(self.rho[k])
            with np.errstate(divide="ignore"):
                return np.asarray(
                    np.log((1 - size) ** 2 + 2 * size * np.where(rho > 0, 2 - left[at], left[at]))
                )

        return self.grouped.summed(zone, self.weight, part)

    def transform(self, zone: Index, rho: Array) -> Array:
        """Transform off the zone, at points with this rho."""
        return self.grouped.summed(
            zone, 2 * self.weight, lambda at, k: np.log1p(-rho[at] * self.rho[k])
        )

    def integral(self, zone: Index, left: Array, right: Array) -> Array:
        """Integral of the density from the zone's left end, over w.

        It is the whole integral less the one from the angle theta to the right end.
        """
        angle = theta(left, right)

        def part(at: Index, k: Index) -> Array:
            phi, rho = angle[at], self.rho[k]
            own = np.arctan2(rho * np.sin(phi), 1 - rho * np.cos(phi))
            turn = np.arctan2((1 + rho) * np.sin(phi / 2), (1 - rho) * np.cos(phi / 2))
            beyond = (
                (1 + rho**2) / (2 * rho) * turn
                - (1 - rho**2) * phi / (4 * rho)
                - np.sin(phi) / 2
                - np.cos(phi) * own
            )
            return np.asarray(2 * beyond - np.pi * rho)

        return self.grouped.summed(zone, self.weight, part)

    def potential(self, zone: Index, log: Array, rho: Complex) -> Array:
        """Potential over w, without c_0 log(w); log: log(2 |rho|)."""
        return self.grouped.summed(
            zone, self.weight, lambda at, k: self._potential(k, log[at], rho[at]).real
        )

    def _potential(self, k: Index, log: Complex | Array, rho: Complex) -> Complex:
        return self.rho[k] * (log - rho**2 / 2) - potential_series(self.rho[k], rho)

    # Values at complex points, see `sie.density.plane`.
    def log(self, k: Index, seen: InPlane) -> Complex:
        """2 log(1 - rho rho_z) of entries k, shape (points, k).

        1 - rho rho_z = (1 - rho_z) + rho_z (1 - rho); for rho < 0 the left end takes the place of
        the right.
        """
        rho, z = self.rho[k], seen.rho[:, None]
        from_left, from_right = (part[:, None] for part in seen.from_ends)
        return np.asarray(
            2 * np.log(np.where(rho > 0, from_right + z * (1 - rho), from_left - z * (1 + rho)))
        )

    def in_plane(self, k: Index, seen: InPlane, what: What) -> Complex:
        """Transform, derivative by zeta, or potential over w without c_0 log(w), summed over
        entries k.
        """
        if what == "potential":
            return np.asarray(
                self._potential(k, np.log(2.0) - seen.log[:, None], seen.rho[:, None])
                @ self.weight[k]
            )
        log = self.log(k, seen)
        if what == "transform":
            return np.asarray(log @ self.weight[k])
        return np.asarray(
            (2 * seen.rho[:, None] * self.rho[k] * np.exp(-0.5 * log)) @ self.weight[k] / seen.root
        )


def potential_series(up: Complex | Array, rho: Complex | Array) -> Complex:
    """sum_{j >= 2} (up^j / j) (-rho^{j-1} / (j-1) + rho^{j+1} / (j+1)) in closed form.

    The part of j = 1 without a logarithm of rho is added.
    """
    q = up * rho
    log = -np.log1p(-q)
    rest = log - q
    return np.asarray(-(up * log - rest / rho) + rho * rest - (rest - q * q / 2) / up)


NOWHERE = ExteriorLogarithms.nothing()
