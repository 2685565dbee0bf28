"""Elastic layers, from very thick to much thinner than the zone.

The kernel (pi/2h) coth(pi r/2h), of symbol coth(q h), has a closed form on one zone. Let v = pi
x/2h, and let V be the value of v at the end. For the pressure p = cosh(v) sqrt(sinh^2 V - sinh^2 v)
the integral (1/2h) PV int p coth(pi (x - xi)/2h) dxi is sinh(2v)/2, as sinh v maps the zone to an
interval. So the profile is f = (h/pi E*) cosh(2v) and the load h sinh^2 V.

For an elastic layer of symbol L(q) the profile is designed. The pressure is the half ellipse
p = E* sqrt(1 - x^2)/2 on (-1, 1), whose cosine transform is pi E* J1(q)/2q. The profile under it
has the slope f' = x + int_0^inf (L(q) - 1) J1(q) sin(q x)/q dq. The first term is that of a
half-plane. The second term is smooth, as L - 1 falls like exp(-2qh). The gap outside is
int sqrt(x^2 - 1) dx, as without a layer.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import j1

from contact.model.interactions import Isolated
from contact.model.profiles.base import Profile
from contact.model.scene import Scene
from contact.model.substrates import Layer, Substrate
from contact.reference.exact import SymmetricZone
from contact.studies.bench.extremes.base import Extreme
from contact.studies.bench.truth import Exact

Array = NDArray[np.float64]

# Each row has the base of the layer (smooth or bonded), Poisson's ratio, and the half width of the
# contact zone divided by the layer's thickness.
ELASTIC = (
    ("smooth", 0.3, 0.01), ("smooth", 0.3, 1.0), ("smooth", 0.3, 10.0), ("smooth", 0.3, 100.0),
    ("bonded", 0.0, 0.1), ("bonded", 0.3, 1.0), ("bonded", 0.3, 30.0), ("bonded", 0.3, 100.0),
    ("bonded", 0.49, 100.0), ("bonded", 0.5, 1.0), ("bonded", 0.5, 10.0), ("bonded", 0.5, 30.0),
    ("bonded", 0.5, 100.0),
)  # fmt: skip


@dataclass(frozen=True)
class Coth(Substrate):
    """A substrate with the symbol coth(q h) at wave number q, for a layer of thickness h."""

    h: float
    name = "coth"

    def symbol(self, q: ArrayLike) -> Array:
        return np.asarray(1 / np.tanh(np.asarray(q) * self.h))


@dataclass(frozen=True)
class Cosh(Profile):
    """The profile (h/pi) (cosh(pi x/h) - 1).
    Its contact with the substrate `Coth` has a closed form.
    """

    h: float
    symmetric = True
    name = "cosh"

    def height(self, x: ArrayLike) -> Array:
        return np.asarray(2 * self.h / np.pi * np.sinh(0.5 * np.pi * np.asarray(x) / self.h) ** 2)

    def slope(self, x: ArrayLike) -> Array:
        return np.asarray(np.sinh(np.pi * np.asarray(x) / self.h))


@dataclass(frozen=True)
class CothZone(SymmetricZone):
    """The contact zone [-a, a] of the profile `Cosh` on the substrate `Coth`, for E* = 1."""

    h: float
    half_width: float
    period = None

    @property
    def _end(self) -> float:
        return 0.5 * np.pi * self.half_width / self.h

    @property
    def load(self) -> float:
        return float(self.h * np.sinh(self._end) ** 2)

    @property
    def max_pressure(self) -> float:
        return float(self.pressure_at(np.linspace(0.0, 1.0, 4097)).max())

    def _pressure(self, r: Array, d: Array) -> Array:
        unit = 0.5 * np.pi / self.h
        # The difference sinh^2 V - sinh^2 v, with v = pi x/2h and V its value at the end of the
        # zone, is computed as sinh(V - v) sinh(V + v), so that nothing cancels near an end.
        return np.asarray(
            np.cosh(unit * r) * np.sqrt(np.sinh(unit * d) * np.sinh(unit * (self.half_width + r)))
        )


@dataclass(frozen=True)
class UnderEllipse(Profile):
    """The profile of a body whose pressure on a layer is half an ellipse on (-1, 1), for E* = 1."""

    layer: Layer
    symmetric = True
    name = "under an ellipse"
    # The quadrature over the wave number q resolves sin(q x) only for x in this interval.
    extent = (-3.0, 3.0)

    @cached_property
    def _waves(self) -> tuple[Array, Array]:
        """Nodes q of the integral over wave numbers; quadrature weights times (L(q) - 1) J1(q)/q.
        L(q) is the symbol of the layer, and J1 a Bessel function.

        With the thickness h, the last node is 22/h. There L - 1 ~ exp(-2 q h) is below round-off.
        """
        last = 22 / self.layer.thickness
        nodes, weights = np.polynomial.legendre.leggauss(16)
        half = 0.5 * last / np.ceil(last / min(2.0, 0.5 / self.layer.thickness))
        q = (np.arange(half, last, 2 * half)[:, None] + half * nodes).ravel()
        return q, np.tile(half * weights, len(q) // len(nodes)) * (self.layer.symbol(q) - 1) * j1(
            q
        ) / q

    def height(self, x: ArrayLike) -> Array:
        q, weights = self._waves
        return self._summed(
            lambda x: 0.5 * x**2 + 2 * np.sin(0.5 * np.outer(x, q)) ** 2 @ (weights / q), x
        )

    def slope(self, x: ArrayLike) -> Array:
        q, weights = self._waves
        return self._summed(lambda x: x + np.sin(np.outer(x, q)) @ weights, x)

    def _summed(self, function: Callable[[Array], Array], x: ArrayLike) -> Array:
        """Values at x of a sum over all wave numbers, computed for a few x at a time to save
        memory.
        """
        x = np.asarray(x, dtype=np.float64)
        parts = np.array_split(x.ravel(), 1 + x.size * len(self._waves[0]) // 2_000_000)
        return np.concatenate([function(part) for part in parts]).reshape(x.shape)


@dataclass(frozen=True)
class Ellipse(SymmetricZone):
    """The contact whose pressure is half an ellipse on (-1, 1), for E* = 1.
    Its profile is `UnderEllipse`.
    """

    load = 0.25 * np.pi  # type: ignore[assignment]
    max_pressure = 0.5  # type: ignore[assignment]
    half_width = 1.0
    period = None

    def _pressure(self, r: Array, d: Array) -> Array:
        return np.asarray(0.5 * np.sqrt(d * (1 + r)))


def layers() -> Iterator[Extreme]:
    """Extreme scenes on layers: with the kernel coth, in closed form, and on elastic layers.

    For the kernel coth, d ln(load)/d ln(half width) = 2V coth V (head of this module) is at least
    2. The steepest slope is sinh(2V). At a half width of 30 thicknesses this slope is 1e40, too
    steep for double precision.
    """
    for ratio in (0.01, 0.1, 1.0, 3.0, 10.0):
        yield Extreme(
            "layer, kernel coth",
            f"half width {ratio:g} thicknesses",
            partial(_case, ratio),
            max(1.0, np.pi * ratio),
            "d ln p/d ln a",
        )
    for base, nu, ratio in ELASTIC:
        layer = Layer(1 / ratio, nu, base)
        # Reason for the condition number: the slope has the round-off of a sum of terms of order
        # one. To get the pressure, each wave of the slope is divided by the layer's symbol. The
        # symbol is smallest for waves as long as the zone.
        condition = max(1.0, 1 / float(layer.symbol(np.ones(1))[0]))
        name = f"{base}, nu = {nu:g}, half width {ratio:g} thicknesses"
        yield Extreme(
            "elastic layer",
            name,
            partial(_elastic, layer),
            condition,
            "1/L of the zone's half width",
            heavy=ratio > 50,
        )


def _elastic(layer: Layer) -> tuple[Scene, Exact]:
    exact = Ellipse()
    return Scene(UnderEllipse(layer), 1.0, Isolated(), substrate=layer, load=exact.load), exact


def _case(ratio: float) -> tuple[Scene, Exact]:
    exact = CothZone(1.0, ratio)
    return Scene(Cosh(1.0), 1.0, Isolated(), substrate=Coth(1.0), load=exact.load), exact
