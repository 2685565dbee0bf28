"""Layers from as thick as a half-plane to far thinner than the zone: the kernel (pi/2h) coth(pi r/2h), of symbol coth(q h), has a closed
form on one zone.

With v = pi x/2h and the end at v = V, (1/2h) PV int p coth(pi (x - xi)/2h) dxi = sinh(2v)/2 for p = cosh(v) sqrt(sinh^2 V - sinh^2 v)
(map sinh v to an interval), so the profile is f = (h/pi E*) cosh(2v) and the load h sinh^2 V.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact.model.interactions import Isolated
from contact.model.profiles.base import Profile
from contact.model.scene import Scene
from contact.model.substrates import Substrate
from contact.studies.bench.extremes.base import Extreme
from contact.studies.bench.truth import Exact

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Coth(Substrate):
    """L = coth(q h)."""

    h: float
    name = "coth"

    def symbol(self, q: ArrayLike) -> Array:
        return np.asarray(1 / np.tanh(np.asarray(q) * self.h))


@dataclass(frozen=True)
class Cosh(Profile):
    """The profile of the closed form, E* = 1."""

    h: float
    symmetric = True
    name = "cosh"

    def height(self, x: ArrayLike) -> Array:
        return np.asarray(2 * self.h / np.pi * np.sinh(0.5 * np.pi * np.asarray(x) / self.h) ** 2)

    def slope(self, x: ArrayLike) -> Array:
        return np.asarray(np.sinh(np.pi * np.asarray(x) / self.h))


@dataclass(frozen=True)
class CothZone:
    """One zone of half width a on the layer."""

    h: float
    a: float

    @property
    def zones(self) -> Array:
        return np.array([[-self.a, self.a]])

    @property
    def _end(self) -> float:
        return 0.5 * np.pi * self.a / self.h

    @property
    def load(self) -> float:
        return float(self.h * np.sinh(self._end) ** 2)

    @property
    def max_pressure(self) -> float:
        return float(self.pressure_at(np.linspace(0.0, 1.0, 4097)).max())

    def pressure_at(self, t: ArrayLike, zone: int = 0) -> Array:
        v = self._end * np.asarray(t)
        # sinh^2 V - sinh^2 v without its cancellation beside an end.
        return np.asarray(np.cosh(v) * np.sqrt(np.sinh(self._end - v) * np.sinh(self._end + v)))

    def pressure(self, x: ArrayLike) -> Array:
        t = np.asarray(x) / self.a
        return np.where(np.abs(t) < 1, self.pressure_at(np.clip(t, -1, 1)), 0.0)


def layers() -> Iterator[Extreme]:
    """d ln(load)/d ln(a) = 2V coth V at least 2: a is no worse determined than of a half-plane. The profile is as steep as sinh(2V)
    tells: at 30 thicknesses by 1e40, which no heights hold."""
    for ratio in (0.01, 0.1, 1.0, 3.0, 10.0):
        yield Extreme(
            "layer, kernel coth", f"half width {ratio:g} thicknesses", partial(_case, ratio), max(1.0, np.pi * ratio), "d ln p/d ln a"
        )


def _case(ratio: float) -> tuple[Scene, Exact]:
    exact = CothZone(1.0, ratio)
    return Scene(Cosh(1.0), 1.0, Isolated(), substrate=Coth(1.0), load=exact.load), exact
