r"""Logarithms of the right side just outside a zone, in closed form.

The logarithm is infinite at s, in half widths from the middle of the zone, with s > 1 or s < -1.
With rho = s - sgn(s) sqrt(s^2 - 1), |rho| < 1, and t = cos(theta), the bounded density

    beta(t) = -(2/pi) sum_j (rho^j / j) sin(j theta)
            = -(2/pi) atan2(rho sin(theta), 1 - rho cos(theta))

has the transform (1/pi) ln(2 |rho| |t - s|) on the zone, and (2/pi) ln(1 - rho rho_z) off it, where
rho_z is rho of the point z. The density beta is that of `sie.jumps.density` for q = 0, with rho^j
in place of cos(j phi). Without this closed form, a logarithm close to an end would need a Chebyshev
series of about 1/sqrt(distance) terms.

If the logarithm is at the end itself, rho is 1 or -1. Then beta is (theta - pi)/pi or theta/pi: the
density with the value -1 at the right end or 1 at the left end, and 0 at the opposite end
(`sie.basis.value_mode`).
"""

import numpy as np

from sie.basis.data import Array, Index, numbered, record, wrapped
from sie.basis.interval import Complex, InPlane, Outside, What, theta
from sie.basis.sums import PerZone
from sie.basis.zones import Zones
from sie.jumps.formulas import OPTIONS


@record
class ExteriorLogarithms(PerZone):
    """Pairs of a zone and of a logarithm of the right side outside the zone but close to it.

    zone: the zone; which: index of the logarithm; rho: s - sgn(s) sqrt(s^2 - 1) of its position s
    in half widths from the middle of the zone; weight: its factor J/pi in the right side.
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
        """The logarithms of the right side outside a zone but close to it, or at its end.

        at: positions of all logarithms, repeated with the period; weights: their factors J/pi.
        """
        which = np.arange(len(at))
        if period is not None:
            at = wrapped(at, zones.a[0], period)
            at, which = np.concatenate((at - period, at, at + period)), np.tile(which, 3)
        order = np.argsort(at, kind="stable")
        at, which = at[order], which[order]
        reach = OPTIONS.reach * zones.half
        if period is not None:
            # `reach` is the distance from a zone within which logarithms are selected. It is
            # limited, so that no position is close to both ends of a zone, even if the zone is
            # almost a period wide.
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
            # If the logarithm is at the end of the zone, e is 0 and |rho| is 1.
            e = np.abs(at[place] - ends[zone]) / zones.half[zone]
            found.append((zone, which[place], Outside(sign, e).rho))
        zone, which, rho = (np.concatenate(parts) for parts in zip(*found, strict=True))
        return cls(zone, which, rho, weights[which])

    def sine_coefficients(self, count: int, k: Index | slice = slice(None)) -> Array:
        """Coefficients of sin(j theta), j = 1 ... count, in the densities of the logarithms k.
        Each logarithm of the right side causes such a density on the zone next to it.
        """
        j = np.arange(1, count + 1)
        return np.asarray(-2 * self.weight[k, None] * self.rho[k, None] ** j / j)

    def edge_slopes(self) -> tuple[Array, Array]:
        """Slopes, at the zone's ends, of the density that each logarithm causes: (left, right).

        A slope is the derivative with respect to the angle from the end, taken inside the zone. If
        the logarithm is at an end, the density itself does not tend to zero there.
        """
        w, rho = self.weight, self.rho
        with np.errstate(divide="ignore"):
            left = np.where(rho == -1.0, -w, -2 * w * rho / (1 + rho))
            right = np.where(rho == 1.0, w, -2 * w * rho / (1 - rho))
        return left, right

    def mean_offsets(self, count: int) -> Array:
        """Contribution of nearby logarithms to the mean of the right side's primitive on each zone.

        It is divided by the half width. Each logarithm, with the weight v = J/pi, adds the
        transform -2 v sum rho^j T_j / j. Of the primitives of this transform, the one whose values
        at both ends have the sum zero has the mean over theta
        -2 v (-rho / 4 + sum rho^j / (j (j^2 - 1)), j = 3, 5, ...).
        """
        rho = self.rho
        # The sum of rho^j / (j (j^2 - 1)) over j = 3, 5, ... is rho E / 2 + E / (2 rho) -
        # artanh(rho) + 3 rho / 4 with E = -ln(1 - rho^2)/2. The logarithms in E and artanh are
        # combined: their infinite parts at |rho| = 1 cancel.
        size = np.abs(rho)
        with np.errstate(divide="ignore", invalid="ignore"):
            less = np.where(size < 1.0, (1 - size) ** 2 * np.log1p(-size), 0.0)
        logs = -(less + (1 + size) ** 2 * np.log1p(size)) / (4 * size)
        series = np.sign(rho) * (logs + 0.75 * size)
        parts = -2 * self.weight * (series - 0.25 * rho)
        return np.asarray(np.bincount(self.zone, parts, minlength=count), dtype=float)

    # The methods below give values at points (n,). A point is given by its zone and by its
    # distances from the zone's ends, in half widths.
    def density(self, zone: Index, left: Array, right: Array) -> Array:
        """Density on each zone that logarithms of the right side just outside this zone cause.

        At an end that is the position of a logarithm, it is the limit from within the zone.
        """
        sine = np.sqrt(left * right)

        def part(at: Index, k: Index) -> Array:
            rho, size = self.rho[k], np.abs(self.rho[k])
            # `across` is 1 - rho cos(theta), from the distance of the point to the end that is
            # nearer to the logarithm. So it does not cancel close to this end.
            across = (1 - size) + size * np.where(rho > 0, right[at], left[at])
            angle = np.arctan2(rho * sine[at], across)
            return np.asarray(np.where(across == 0.0, np.copysign(0.5 * np.pi, rho), angle))

        return self.grouped.summed(zone, -2 * self.weight, part)

    def own_transform(self, zone: Index, left: Array) -> Array:
        """Transform, on the zone itself, of the density that nearby logarithms cause.

        It is ln(1 - 2 rho t + rho^2) = ln((1 - |rho|)^2 + 2 |rho| d), with d the distance from the
        end that is nearer to the logarithm.
        """

        def part(at: Index, k: Index) -> Array:
            rho, size = self.rho[k], np.abs(self.rho[k])
            with np.errstate(divide="ignore"):
                return np.asarray(
                    np.log((1 - size) ** 2 + 2 * size * np.where(rho > 0, 2 - left[at], left[at]))
                )

        return self.grouped.summed(zone, self.weight, part)

    def transform(self, zone: Index, rho: Array) -> Array:
        """Transform, at points off the zone, of the density that nearby logarithms cause.

        rho: zeta - sqrt(zeta^2 - 1) of each point, with its coordinate zeta relative to the zone.
        """
        return self.grouped.summed(
            zone, 2 * self.weight, lambda at, k: np.log1p(-rho[at] * self.rho[k])
        )

    def integral(self, zone: Index, left: Array, right: Array) -> Array:
        """Integral, from the zone's left end, of the density that nearby logarithms cause.
        It is divided by the half width of the zone. It is computed as the integral over the whole
        zone minus the integral from the point to the right end.
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
        """Potential of the density of nearby logarithms, divided by the half width w of the zone.
        The term c_0 log(w) is left out, with c_0 the integral of the density divided by pi w.

        log: log(2 |rho|).
        """
        return self.grouped.summed(
            zone, self.weight, lambda at, k: self._potential(k, log[at], rho[at]).real
        )

    def _potential(self, k: Index, log: Complex | Array, rho: Complex) -> Complex:
        return self.rho[k] * (log - rho**2 / 2) - potential_series(self.rho[k], rho)

    # The methods below give values at complex points (see `sie.density.plane`).
    def log(self, k: Index, seen: InPlane) -> Complex:
        """2 log(1 - rho rho_z) for each point z and logarithm k, as an array (points, logarithms).
        rho is x - sgn(x) sqrt(x^2 - 1) of the position x of the logarithm, and rho_z the same for
        the point z, both in half widths from the middle of the zone.

        For rho > 0 it is computed as (1 - rho_z) + rho_z (1 - rho), which does not cancel close to
        the right end; for rho < 0 as (1 + rho_z) - rho_z (1 + rho), which does not cancel close to
        the left end.
        """
        rho, z = self.rho[k], seen.rho[:, None]
        from_left, from_right = (part[:, None] for part in seen.from_ends)
        return np.asarray(
            2 * np.log(np.where(rho > 0, from_right + z * (1 - rho), from_left - z * (1 + rho)))
        )

    def in_plane(self, k: Index, seen: InPlane, what: What) -> Complex:
        """Transform, its derivative by zeta, or potential, of the density of the logarithms k.

        The potential is divided by the half width w and lacks the term c_0 log(w).
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
    """The sum over j >= 2 of (up^j / j) (-rho^{j-1} / (j-1) + rho^{j+1} / (j+1)) in closed form.
    It is a part of the potential of a logarithm's density.

    The caller adds the term j = 1, which has a logarithm of rho.
    """
    q = up * rho
    # At the position of the logarithm, q is 1, and the terms with log(1 - q) cancel. So this
    # logarithm is set to zero there.
    log = -np.log1p(np.where(q == 1, 0.0, -q))
    rest = log - q
    return np.asarray(-(up * log - rest / rho) + rho * rest - (rest - q * q / 2) / up)


NOWHERE = ExteriorLogarithms.nothing()
