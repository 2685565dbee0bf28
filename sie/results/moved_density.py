"""The derivative of a density by parameters that move ends at which it is singular.

If an end with the intensity K moves, the derivative of the density at fixed x contains a multiple
of

    S(t) = 1 / ((1 - t) sqrt(1 - t^2))      (right end;  t -> -t for the left one).

At zeta, which is t continued to the complex plane, the transform of S is
-1 / ((zeta - 1) sqrt(zeta^2 - 1)) off the zone. On the upper side of the zone this function is
-i S, which has no real part, so the transform is zero on the zone. The potential of S, divided by
the half width, is sqrt((zeta + 1) / (zeta - 1)) - 1 off the zone and -1 on it. The integral of S is
zero (finite part).
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sie.basis.data import Array, Complex
from sie.basis.interval import InPlane, OnLine, What, complex_of, root_weight
from sie.basis.kernels import Kernel
from sie.basis.zones import Zones
from sie.density.base import DensityBase
from sie.density.density import Density
from sie.density.plane import Plane
from sie.density.series import regular_at


@dataclass(frozen=True, eq=False)
class MovedDensity(DensityBase):
    """Derivative of a density by a parameter that moves ends.
    At ends that move it has terms distance^(-3/2).

    It is called like a `Density`, and has its `transform`, `transform_slope` and `potential`. The
    derivative of the transform at a fixed point off the zones is the transform of this object.

    Attributes
    ----------
    smooth : Density
        The part without the terms distance^(-3/2).
    strength : (2, Z) array
        Factors of S (see the module) for the left and the right end of each zone.
    carrier : Density
        A density of the zones' modes. With the regular part of the kernel, it has the same field as
        the singular terms.

    Examples
    --------
    The density -x / sqrt(a^2 - x^2) of a crack [-a, a] has the derivative a x / (a^2 - x^2)^(3/2)
    by a.

    >>> import numpy as np, sie
    >>> crack = sie.Equation(sie.cauchy(), np.ones_like, sie.Total(0.0))
    >>> found = sie.solve(crack, sie.Zones.of([[-1.0, 1.0]], sie.SINGULAR, sie.SINGULAR))
    >>> longer = found.derivative(dends=[[-1.0, 1.0]]).density
    >>> float(longer(0.6).round(12)), type(longer).__name__
    (1.171875, 'MovedDensity')
    """

    smooth: Density
    strength: Array
    carrier: Density

    @property
    def zones(self) -> Zones:
        return self.smooth.zones

    @property
    def kernel(self) -> Kernel:
        return self.smooth.kernel

    @property
    def amplitudes(self) -> Array:
        """Derivatives by the parameter of the unknown amplitudes of the columns."""
        return self.smooth.amplitudes

    @property
    def totals(self) -> Array:
        """Derivatives (Z,) by the parameter of the integrals of the density over each zone."""
        return self.smooth.totals

    @property
    def total(self) -> float:
        """Derivative by the parameter of the integral of the density over all zones."""
        return self.smooth.total

    def at(self, zone: ArrayLike, left: ArrayLike, right: ArrayLike) -> Array:
        zone, left, right = np.broadcast_arrays(
            np.asarray(zone, dtype=np.intp), np.asarray(left, float), np.asarray(right, float)
        )
        from_left, from_right = self.strength[:, zone]
        with np.errstate(divide="ignore", invalid="ignore"):
            singular = (from_left / left + from_right / right) / root_weight(left, right)
        singular = np.where((from_left == 0) & (from_right == 0), 0.0, singular)
        return np.asarray(self.smooth.at(zone, left, right) + singular)

    @cached_property
    def _moving(self) -> NDArray[np.intp]:
        """Indices of the zones with singular terms, which have an end that moves."""
        return np.flatnonzero(self.strength.any(axis=0))

    def _on_line(self, x: Array, potential: bool) -> Array:
        flat, zones = self.into_period(x).ravel(), self.zones
        out = self.smooth._on_line(flat, potential)
        for shift in self.kernel.poles:
            for i in self._moving:
                w, zone = zones.half[i], np.full(len(flat), i)
                seen = OnLine.of(
                    zones.beyond_a(flat - shift, zone) / w, zones.before_b(flat - shift, zone) / w
                )
                left, right = self.strength[:, i]
                with np.errstate(divide="ignore", invalid="ignore"):
                    if potential:
                        field = (left * -seen.right + right * seen.left) / seen.root
                        out += w * (np.where(seen.on, 0.0, field) - left - right)
                    else:
                        field = (left / seen.left + right / seen.right) / seen.root
                        out += np.where(seen.on, 0.0, field)
        regular = self.kernel.regular_potential if potential else self.kernel.regular
        if regular is not None:
            out += regular_at(self.carrier, flat, regular)
        return out.reshape(x.shape)

    @cached_property
    def _carried(self) -> Plane:
        return Plane(self.carrier)

    def _in_plane(self, z: ArrayLike, what: What) -> NDArray[Any]:
        points = np.asarray(z, dtype=complex)
        out = np.asarray(self.smooth._in_plane(points, what))
        finite = np.isfinite(points)
        out[finite] += self._singular_field(points[finite], what)
        return out

    def _singular_field(self, z: Complex, what: What) -> Complex:
        """Field at complex points z (n,) of the singular terms, distance^(-3/2), at moving ends."""
        zones, x, y = self.zones, self.into_period(z.real), np.abs(z.imag)
        out = np.zeros(len(x), dtype=complex)
        for shift in self.kernel.poles:
            for i in self._moving:
                w, (left, right) = zones.half[i], self.strength[:, i]
                zone = np.full(len(x), i)
                seen = InPlane.of(
                    zones.beyond_a(x - shift, zone) / w, -zones.before_b(x - shift, zone) / w, y / w
                )
                p, m = seen.left, seen.less
                if what == "potential":
                    out += w * ((left * m + right * p) / seen.root - left - right)
                elif what == "transform":
                    out += (left / p - right / m) / seen.root
                else:
                    of_left = left / p * (1.5 / p + 0.5 / m)
                    of_right = right / m * (1.5 / m + 0.5 / p)
                    out += (of_right - of_left) / seen.root / w
        regular = self._carried.regular(complex_of(x, y), what)
        if regular is not None:
            out += regular
        return np.where(z.imag < 0, np.conj(out), out)
