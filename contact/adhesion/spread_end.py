"""A gradual end of a uniform tension, which is spread over a zone (a, b) of contact.

The end is distributed over the zone with the equilibrium measure mu: d mu = d xi/(pi
sqrt((xi - a)(b - xi))). With z = (x - middle)/half,

    int ln|x - xi| d mu = ln(half/2) + arcosh|z|,
    int (x - xi)(ln|x - xi| - 1) d mu
        = half [z ln(half/2) + sgn(z) (|z| arcosh|z| - sqrt(z^2 - 1))],

where arcosh and the root are zero on the zone. Smooth functions are integrated by the Gauss rule of
mu: equal weights at the cosines of equidistant angles. With a period L, one of these functions is
the remainder of ln|2 sin(pi y/L)| after its singularities at y = 0, L and -L are subtracted.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.special import digamma, loggamma

from contact.formulation.quadrature import gauss
from sie import Array, Complex, nearest_image

# Number of nodes for integrals of smooth functions, such as remainders that vary on the scale of
# the period.
_SMOOTH_NODES = 64
# Number of Gauss nodes on each panel, for integrals over angles and of a kernel's regular part.
PANEL_NODES = 16


@dataclass(frozen=True)
class SpreadEnd:
    """A gradual end of a uniform tension, which fades out over the zone (a, b) of contact."""

    a: float
    b: float

    @property
    def middle(self) -> float:
        return 0.5 * (self.a + self.b)

    @property
    def half(self) -> float:
        return 0.5 * (self.b - self.a)

    def potential(self, x: Array) -> Array:
        """Potential at points x of a unit load with density 1 / (pi sqrt((xi - a) (b - xi))).
        It is the integral of ln|x - xi| times this density, for xi in the zone (a, b).
        """
        return np.asarray(np.log(0.5 * self.half) + np.arccosh(self._coordinates(x)[1]))

    def primitive(self, x: Array) -> Array:
        """Antiderivative of `potential`, odd about the middle of the zone."""
        z, size = self._coordinates(x)
        outside = size * np.arccosh(size) - np.sqrt((size - 1) * (size + 1))
        return np.asarray(self.half * (z * np.log(0.5 * self.half) + np.sign(z) * outside))

    def _coordinates(self, x: Array) -> tuple[Array, Array]:
        z = (x - self.middle) / self.half
        return z, np.maximum(np.abs(z), 1.0)

    def mean(self, function: Callable[[Array], Array], x: Array) -> Array:
        """Mean of function(x - xi) over xi in (a, b), weighted by 1 / sqrt((xi - a) (b - xi))."""
        angle = np.pi * (np.arange(_SMOOTH_NODES) + 0.5) / _SMOOTH_NODES
        xi = self.middle + self.half * np.cos(angle)
        return np.asarray(function(x[:, None] - xi).mean(axis=1))

    def periodic_potential(self, x: Array, period: float) -> Array:
        """The `potential` with a period L, from the logarithm ln|2 sin(pi (x - xi)/L)|."""
        x = nearest_image(x, self.middle, period)

        def remainder(lag: Array) -> Array:
            u = np.abs(lag) / period
            far = np.sinc(1 - u) / np.where(u > 0.5, u * (1 + u), 1.0)
            return np.asarray(
                np.log(np.where(u > 0.5, far, np.sinc(u) / np.where(u > 0.5, 1.0, 1 - u * u)))
            )

        return (
            self.potential(x)
            + self.potential(x - period)
            + self.potential(x + period)
            + np.log(2 * np.pi / period**3)
            + self.mean(remainder, x)
        )

    def in_plane(self, z: Complex, period: float | None) -> tuple[Complex, Complex]:
        """Complex potential of the spread end, and its derivative, at points z (n,), Im z >= 0.
        On the real axis its real part is `potential`, or `periodic_potential` with a period.

        With a period, only the imaginary part of the potential changes if z moves by a period.
        """
        if period is None:
            return self._isolated(z)
        turns = np.round((z.real - self.middle) / period)
        z = z - turns * period
        value: Complex = np.asarray(-1j * np.pi * turns)
        slope: Complex = np.zeros(len(z), dtype=complex)
        # At `near` points the logarithms of the zone and its next images are added in closed form,
        # and only the smooth remainder is averaged over the zone.
        near = np.flatnonzero(z.imag < period)
        far = np.flatnonzero(z.imag >= period)
        angle = np.pi * (np.arange(_SMOOTH_NODES) + 0.5) / _SMOOTH_NODES
        xi = self.middle + self.half * np.cos(angle)
        logs, rates = line_load(z[far, None] - xi, period)
        value[far] += logs.mean(axis=1)
        slope[far] = rates.mean(axis=1)
        for shift in (-period, 0.0, period):
            one = self._isolated(z[near] - shift)
            value[near], slope[near] = value[near] + one[0], slope[near] + one[1]
        rest, bend = _remainder(z[near, None] - xi, period)
        value[near] += rest.mean(axis=1)
        slope[near] += bend.mean(axis=1)
        return value, slope

    def _isolated(self, z: Complex) -> tuple[Complex, Complex]:
        t = (z - self.middle) / self.half
        root = np.sqrt(t - 1) * np.sqrt(t + 1)
        with np.errstate(divide="ignore"):
            value = np.log(0.5 * self.half) + np.log(t + root)
            return np.asarray(value), np.asarray(1 / (self.half * root))

    def periodic_primitive(
        self, x: Array, period: float, primitive: Callable[[Array], Array]
    ) -> Array:
        """Antiderivative of `periodic_potential` with respect to x.

        primitive: an antiderivative of ln|2 sin(pi y/L)| as a function of y, with L = `period`.
        """
        # The mean of ln|2 sin(pi y/L)| over a period is zero, so its antiderivative is periodic.
        x = nearest_image(x, self.middle, period)
        rate = np.log(2 * np.pi / period**3)

        def of_poles(y: Array, of_one: Callable[[Array], Array]) -> Array:
            return np.asarray(of_one(y) + of_one(y - period) + of_one(y + period))

        def remainder(lag: Array) -> Array:
            return np.asarray(primitive(lag) - of_poles(lag, _log_primitive) - rate * lag)

        return of_poles(x, self.primitive) + rate * (x - self.middle) + self.mean(remainder, x)

    def lacking(self, end: int, panels: int, breaks: Array) -> tuple[Array, Array]:
        """(points, weights) for integrals over the zone of a function times 1 - eta.
        eta is the local fraction of the tension, which fades out over the zone.

        end: 0 if the zone spreads the left end of the first interval of tension, -1 if it spreads
        the right end of the last one. The panels of the rule end at the `breaks`.
        """
        inner = breaks[(breaks > self.a) & (breaks < self.b)]
        cuts = np.unique(
            np.append(
                np.linspace(0.0, np.pi, max(panels, 2) + 1),
                np.arccos((inner - self.middle) / self.half),
            )
        )
        angle, weight = gauss(cuts, PANEL_NODES)
        part = 1 - angle / np.pi if end else angle / np.pi
        return self.middle + self.half * np.cos(angle), self.half * weight * np.sin(angle) * part


def line_load(z: Complex, period: float | None) -> tuple[Complex, Complex]:
    """The complex potential of a unit line load and its derivative at distances z, Im z >= 0.

    It is ln z, or ln(2 sin(pi z/L)) with a period L, continuous in the upper half plane.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        if period is None:
            return np.log(z), 1 / z
        # 2 sin(u) = i exp(-iu) (1 - exp(2iu)). The last factor repeats when u grows by pi. So
        # multiples of pi are removed from u in this factor.
        u = np.pi / period * z
        turned = u - np.pi * np.round(z.real / period)
        less = -np.expm1(2j * turned)
        value = 0.5j * np.pi - 1j * u + np.log(less)
        rate = -1j * np.pi / period * (1 + 2 * np.exp(2j * turned) / less)
        return np.asarray(value), np.asarray(rate)


def _remainder(z: Complex, period: float) -> tuple[Complex, Complex]:
    """(r, dr/dz), with r = `line_load` - ln(z (z - L) (z + L)) for the period L and |Re z| < L.

    Up to a constant, r is the sum of ln(1 - (z/kL)^2) over k > 1. It is computed from the gamma
    function, and dr/dz from the digamma function, at 2 - z/L and 2 + z/L.
    """
    u = z / period
    value = np.log(2 * np.pi / period**3) - loggamma(2 - u) - loggamma(2 + u) - 1j * np.pi
    return value, (digamma(2 - u) - digamma(2 + u)) / period


def _log_primitive(y: Array) -> Array:
    """The antiderivative y (ln|y| - 1) of ln|y|."""
    return np.asarray(y * (np.log(np.maximum(np.abs(y), 1e-300)) - 1.0))
