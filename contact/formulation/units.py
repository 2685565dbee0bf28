"""`Units`: the units of scaled lengths, slopes, pressures and loads."""

from dataclasses import dataclass

import numpy as np

from sie import Array


@dataclass(frozen=True)
class Units:
    """Units of scaled variables, which follow from an origin, a length [m], a slope and E* [Pa].

    The length is a power of two, so that scaling loses no digit of a place.
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
        """Unit of the intensity K: the pressure is K / sqrt(d) at the distance d from an end."""
        return self.pressure * self.length**0.5

    @property
    def moment(self) -> float:
        return self.load * self.length

    @property
    def lever(self) -> float:
        """Origin divided by the unit of length. So x [m] is length * (lever + scaled x)."""
        return self.origin / self.length

    def x(self, scaled: Array) -> Array:
        return self.origin + self.length * scaled

    def scaled(self, x: Array) -> Array:
        return np.asarray((x - self.origin) / self.length)

    def placed(self, scaled: Array) -> Array:
        """Scaled places after the positions x [m] have been rounded to double precision."""
        return self.scaled(self.x(scaled))

    def minus_place(self, scaled: Array) -> Array:
        """Scaled height that a unit tilt adds: -x / (unit of length), for the position x [m]."""
        return np.asarray(-(scaled + self.lever))
