"""What lengths, slopes, pressures and loads are counted in."""

from dataclasses import dataclass

import numpy as np

from sie import Array


@dataclass(frozen=True)
class Units:
    """origin and length [m], slope [1], and what follows for pressure and load; E_star [Pa].

    The length is a power of two: counted in it, places lose no digit.
    """

    origin: float
    length: float
    slope: float
    E_star: float

    @property
    def pressure(self) -> float:
        return 0.5 * self.E_star * self.slope

    @property
    def load(self) -> float:
        return self.pressure * self.length

    @property
    def height(self) -> float:
        return self.slope * self.length

    @property
    def intensity(self) -> float:
        """Of a pressure K / sqrt(d)."""
        return self.pressure * self.length**0.5

    @property
    def moment(self) -> float:
        return self.load * self.length

    @property
    def lever(self) -> float:
        """The origin's own place, scaled: x = length (lever + scaled x)."""
        return self.origin / self.length

    def x(self, scaled: Array) -> Array:
        return self.origin + self.length * scaled

    def scaled(self, x: Array) -> Array:
        return np.asarray((x - self.origin) / self.length)

    def placed(self, scaled: Array) -> Array:
        """Where scaled places come to stand by the rounding of x."""
        return self.scaled(self.x(scaled))

    def minus_place(self, scaled: Array) -> Array:
        """-x, scaled."""
        return np.asarray(-(scaled + self.lever))
