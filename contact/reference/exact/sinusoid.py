"""Sinusoid f = Delta (1 - cos(2 pi x/L)): partial and full contact, one isolated wave.

H. M. Westergaard, "Bearing pressures and cracks", J. Appl. Mech. 6 (1939) A49-A53. One wave: I.
Tsukanov (2018a), as given by Goryacheva & Tsukanov (2020), doi 10.3389/fmech.2020.00045, eq.
(18)-(22); the factor of (18) is misprinted there.
"""

from dataclasses import dataclass
from math import inf, pi, sqrt
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import j0, j1, jn_zeros, jv

from contact.errors import OutOfRange
from contact.model.checks import between, keep, positive
from contact.reference.exact.base import IsolatedZone, PeriodicZone, refuse_load
from contact.reference.exact.numerics import Array, cosine, half_width_from_sine, root, sine


@dataclass(frozen=True)
class _Wave:
    """Parameters of a periodic wave Delta (1 - cos(2 pi x/L)), in partial or full contact."""

    amplitude: float
    period: float
    E_star: float

    @property
    def full_contact_pressure(self) -> float:
        """Smallest mean pressure [Pa] at which the contact is full: p* = pi E* amplitude/period."""
        return pi * self.E_star * self.amplitude / self.period


@dataclass(frozen=True)
class Westergaard(PeriodicZone, _Wave):
    """The partial contact of a wave f = Delta (1 - cos(2 pi x/L)) (Westergaard 1939).

    With p* = pi E* Delta/L, u = pi x/L, A = pi a/L, s = sin u and q^2 = s^2 - sin^2 A,

    (18) p = sqrt2 p* cos u sqrt(cos 2u - cos 2A),   (19) mean pressure = p* sin^2 A,
    approach = Delta sin^2 A (1 - ln sin^2 A),   gap = 2 Delta (s q - sin^2 A arcosh(s/sin A)).

    The class methods `from_load`, `from_mean_pressure` and `from_contact_fraction` start from one
    of these numbers; everything else is in `SymmetricZone`. H. M. Westergaard, J. Appl. Mech. 6
    (1939) A49-A53, doi 10.1115/1.4008919.

    Parameters
    ----------
    amplitude : float
        Delta, half of the height from valley to crest [m].
    period : float
        Period L [m].
    E_star : float
        Reduced modulus [Pa].
    half_width : float
        Half width a of the zone [m].

    Attributes
    ----------
    full_contact_pressure : float
        p*, the smallest mean pressure of full contact [Pa].

    Raises
    ------
    SceneError
        If a number is not positive and finite, or the zone is as wide as its period.
    OutOfRange
        From `from_load` and `from_mean_pressure`, if contact is full at that load.

    Examples
    --------
    Half of the period in contact carries half of the load of full contact.

    >>> import numpy as np
    >>> from contact.exact import Westergaard
    >>> wave = Westergaard.from_contact_fraction(0.5, amplitude=1e-6, period=1e-4, E_star=1e9)
    >>> bool(np.isclose(wave.mean_pressure, 0.5 * wave.full_contact_pressure))
    True
    """

    @classmethod
    def _half_width_for(cls, load: float, **shape: float) -> float:
        full = pi * shape["E_star"] * shape["amplitude"]
        refuse_load(load, full, "full contact (see FullContactSinusoid) begins")
        return half_width_from_sine(sqrt(load / full), sqrt((full - load) / full), shape["period"])

    def _height(self, r: Array) -> Array:
        return 2.0 * self.amplitude * sine(r, self.period) ** 2

    def _slope(self, r: Array) -> Array:
        return 2.0 * pi * self.amplitude / self.period * sine(2.0 * r, self.period)

    def _pressure(self, r: Array, d: Array) -> Array:
        # Equation (18) for the pressure contains sqrt(cos 2u - cos 2A), with u = pi x/L and A = pi
        # a/L. Here cos 2u - cos 2A is written as 2 sin(A - u) sin(A + u), so that nothing cancels.
        root = np.sqrt(sine(d, self.period) * sine(self.half_width + r, self.period))
        return 2.0 * self.full_contact_pressure * cosine(self.half_width, self.period, d) * root

    def load_rate(self, s: ArrayLike) -> Array:
        """Derivative dP/ds of the load P of a zone by its half width s."""
        return pi * self.full_contact_pressure * sine(2.0 * np.asarray(s), self.period)

    def load_at(self, s: Array) -> Array:
        """Load P [N/m] of a zone of half width s."""
        return pi * self.E_star * self.amplitude * sine(s, self.period) ** 2


@dataclass(frozen=True)
class FullContactSinusoid(_Wave):
    """Full contact of a wave f = Delta (1 - cos(2 pi x/L)).
    The pressure is its mean plus p* cos(2 pi x/L).

    The mean pressure is at least p* = pi E* Delta/L. H. M. Westergaard, J. Appl. Mech. 6
    (1939) A49-A53, doi 10.1115/1.4008919.

    Parameters
    ----------
    amplitude : float
        Delta, half of the height from valley to crest [m].
    period : float
        Period L [m].
    E_star : float
        Reduced modulus [Pa].
    mean_pressure : float
        Load per period, divided by the period [Pa].

    Attributes
    ----------
    load : float
        P per period [N/m].
    max_pressure, full_contact_pressure : float
        mean + p*, and p* [Pa].
    zones : array, (0, 2)
        Empty: full contact has no ends. `contact_fraction` is 1, `approach` Delta, `stiffness` inf.
    pressure, gap, displacement : callable
        p [Pa], gap (0) and u [m] at positions x [m] of any shape.

    Raises
    ------
    SceneError
        If a number is not positive and finite.
    OutOfRange
        If the mean pressure is below p*: contact is partial.

    Examples
    --------
    At p* the pressure of the valleys is just zero.

    >>> import numpy as np
    >>> from contact.exact import FullContactSinusoid
    >>> p = 1e-2 * np.pi * 1e9
    >>> wave = FullContactSinusoid(amplitude=1e-6, period=1e-4, E_star=1e9, mean_pressure=p)
    >>> bool(abs(wave.pressure(0.5e-4)) < 1e-9 * wave.max_pressure)
    True
    """

    mean_pressure: float

    def __post_init__(self) -> None:
        keep(self, positive, "amplitude", "period", "E_star", "mean_pressure")
        if self.mean_pressure < self.full_contact_pressure:
            raise OutOfRange(
                f"mean_pressure = {self.mean_pressure:.6g} Pa is out of range: "
                f"full contact begins at {self.full_contact_pressure:.6g} Pa"
            )

    zones = property(lambda self: np.empty((0, 2)))
    contact_fraction = property(lambda self: 1.0)
    load = property(lambda self: self.mean_pressure * self.period)
    max_pressure = property(lambda self: self.mean_pressure + self.full_contact_pressure)
    approach = property(lambda self: self.amplitude)
    stiffness = property(lambda self: inf)

    def pressure(self, x: ArrayLike) -> Array:
        """Pressure p(x) [Pa] in full contact: mean - p* + 2 p* cos^2(pi x/L).
        p* is `full_contact_pressure`.
        """
        full = self.full_contact_pressure
        cos = np.cos(pi / self.period * np.asarray(x))
        return self.mean_pressure - full + 2.0 * full * cos**2

    def displacement(self, x: ArrayLike) -> Array:
        """Displacement u(x) [m] of the surface into the body: amplitude times cos(2 pi x/L)."""
        return self.amplitude * np.cos(2.0 * pi / self.period * np.asarray(x, dtype=float))

    def gap(self, x: ArrayLike) -> Array:
        """The gap [m] between the surfaces, which is 0 everywhere in full contact."""
        return np.zeros_like(np.asarray(x, dtype=float))


@dataclass(frozen=True)
class _OneWave:
    """Parameters of one wave Delta (1 - cos(2 pi x/L)) that does not repeat."""

    amplitude: float
    wavelength: float


@dataclass(frozen=True)
class IsolatedSinusoid(IsolatedZone, _OneWave):
    """The contact of one isolated wave Delta (1 - cos(2 pi x/L)) (Tsukanov 2018a).

    With k = 2 pi/L and t = x/a,

    (20) p = (2 pi Delta E*/L) sqrt(1 - t^2) sum_j (-1)^j J_{2j+1}(ka) U_{2j}(t),
    (21) P = (pi^2 Delta E*/L) a J_1(ka),   (22) p(0) = (pi Delta E*/L) int_0^{ka} J_0.

    The pressure is positive up to a/L = 0.3827, the first zero of J_0, where the load is greatest.
    Beyond it (`admissible` is False) the formula is only an ingredient of the localized solution.
    The class method `from_load` makes the solution at a given load; everything else is in
    `SymmetricZone`. As given by Goryacheva & Tsukanov (2020), doi 10.3389/fmech.2020.00045.

    Parameters
    ----------
    amplitude : float
        Delta, half of the height from valley to crest [m].
    wavelength : float
        L [m]; nothing repeats here.
    E_star : float
        Reduced modulus [Pa].
    half_width : float
        Half width a of the zone, below L/2 [m].
    datum : float or None
        Distance at which the far field of u is zero [m]; without it there is no approach.

    Attributes
    ----------
    admissible : bool
        Whether the pressure is positive up to the ends.

    Raises
    ------
    SceneError
        If a number is not positive and finite, or the zone is as wide as the wave.
    OutOfRange
        From `from_load`, past the greatest load of one wave.

    Examples
    --------
    Near the greatest load the load hardly depends on the half width.

    >>> import numpy as np
    >>> from contact.exact import IsolatedSinusoid
    >>> below, beyond = (
    ...     IsolatedSinusoid(1e-6, wavelength=1e-4, E_star=1e9, half_width=a)
    ...     for a in (0.382e-4, 0.383e-4)
    ... )
    >>> below.admissible, beyond.admissible
    (True, False)
    >>> bool(np.isclose(below.load, beyond.load, rtol=1e-5))
    True
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        between("half_width", self.half_width, 0.0, 0.5 * self.wavelength)

    @property
    def _k(self) -> float:
        return 2.0 * pi / self.wavelength

    @property
    def admissible(self) -> bool:
        """Whether the pressure is positive up to the ends of the zone."""
        return self._k * self.half_width <= float(jn_zeros(0, 1)[0])

    @classmethod
    def _half_width_for(cls, load: float, **shape: float) -> float:
        unit = 0.5 * pi * shape["E_star"] * shape["amplitude"]
        ka = float(jn_zeros(0, 1)[0])
        refuse_load(load, unit * ka * float(j1(ka)), "the load of one wave has its maximum")
        k = 2.0 * pi / shape["wavelength"]
        return root(lambda z: unit * z * j1(z) - load, 0.0, ka) / k

    def _height(self, r: Array) -> Array:
        return 2.0 * self.amplitude * sine(r, self.wavelength) ** 2

    def _slope(self, r: Array) -> Array:
        return self.amplitude * self._k * np.sin(self._k * r)

    def _pressure(self, r: Array, d: Array) -> Array:
        # With t = x/a = cos phi, the terms of the series (20) are sqrt(1 - t^2) U_2j(t) = sin((2j +
        # 1) phi). The angle phi is computed from the distance d to the end of the zone, without
        # cancellation.
        phi = 2.0 * np.arcsin(np.sqrt(0.5 * d / self.half_width))
        j = np.arange(20)  # J_41(pi) is below 1e-40
        weight = (-1.0) ** j * jv(2 * j + 1, self._k * self.half_width)
        series = np.sum(weight * np.sin((2 * j + 1) * phi[..., None]), axis=-1)
        return self.E_star * self.amplitude * self._k * series

    def load_rate(self, s: ArrayLike) -> Array:
        """Derivative dP/ds of the load P of a zone by its half width s."""
        z = self._k * np.asarray(s)
        return np.asarray(0.5 * pi * self.E_star * self.amplitude * self._k * z * j0(z))

    def load_at(self, s: Array) -> Array:
        """Load P [N/m] of a zone of half width s."""
        z = self._k * s
        return np.asarray(0.5 * pi * self.E_star * self.amplitude * z * j1(z))


def sinusoid(mean_pressure: float, **shape: Any) -> Westergaard | FullContactSinusoid:
    """The contact of a wave Delta (1 - cos(2 pi x/L)) at any mean pressure: partial or full.

    Parameters
    ----------
    mean_pressure : float
        Load per period, divided by the period [Pa].
    **shape : float
        amplitude Delta [m], period L [m] and E_star [Pa], by name.

    Returns
    -------
    Westergaard or FullContactSinusoid
        Full contact begins at p* = pi E* Delta/L.

    Raises
    ------
    SceneError
        If a number is not positive and finite.

    Examples
    --------
    >>> from contact.exact import sinusoid
    >>> wave = dict(amplitude=1e-6, period=1e-4, E_star=1e9)  # p* = 31.4 MPa
    >>> [type(sinusoid(p, **wave)).__name__ for p in (31e6, 32e6)]
    ['Westergaard', 'FullContactSinusoid']
    """
    positive("mean_pressure", mean_pressure)
    for field, value in shape.items():
        positive(field, value)
    full = pi * shape["E_star"] * shape["amplitude"] / shape["period"]
    if mean_pressure >= full:
        return FullContactSinusoid(mean_pressure=mean_pressure, **shape)
    return Westergaard.from_mean_pressure(mean_pressure, **shape)
