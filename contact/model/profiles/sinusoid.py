"""Sinusoidal waviness (Westergaard 1939): f(x) = amplitude (1 - cos(2 pi x/L))."""

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import ArrayLike

from contact.model.checks import keep, positive
from contact.model.profiles.base import AT_ORIGIN, Array, Profile, read_from
from contact.model.registry import register_profile


@register_profile("sinusoid")
@dataclass(frozen=True)
class Sinusoid(Profile):
    """f = amplitude (1 - cos(2 pi x/period)). The amplitude is half the height from valley to
    peak.

    The contact is full above the mean pressure pi E* amplitude / period (H. M. Westergaard, J.
    Appl. Mech. 6, 1939, A49, doi 10.1115/1.4008919).

    Parameters
    ----------
    amplitude : float
        [m]
    period : float
        [m]

    Raises
    ------
    SceneError
        If one of them is not a finite positive number.

    Examples
    --------
    >>> import contact
    >>> contact.Sinusoid(amplitude=1e-6, period=1e-4).height([0.0, 5e-5]).tolist()
    [0.0, 2e-06]
    """

    amplitude: float
    period: float
    units = {"amplitude": "m", "period": "m"}
    symmetric = True
    summits = AT_ORIGIN
    resolution = read_from("period")

    def __post_init__(self) -> None:
        keep(self, positive, "amplitude", "period")

    def _turns(self, x: ArrayLike) -> Array:
        """x divided by the period, minus the nearest whole number; this is cheaper than `wrap`."""
        turns = np.asarray(x, dtype=np.float64) / self.period
        return np.asarray(turns - np.rint(turns))

    def height(self, x: ArrayLike) -> Array:
        # The form 2 sin(a/2)^2 of 1 - cos(a) keeps all digits near the tip.
        return np.asarray(2 * self.amplitude * np.sin(pi * self._turns(x)) ** 2)

    def slope(self, x: ArrayLike) -> Array:
        return np.asarray(2 * pi * self.amplitude / self.period * np.sin(2 * pi * self._turns(x)))

    def slope_conjugate(self, x: ArrayLike) -> Array:
        """The Hilbert transform of the slope f', which maps sin to -cos."""
        return np.asarray(-2 * pi * self.amplitude / self.period * np.cos(2 * pi * self._turns(x)))
