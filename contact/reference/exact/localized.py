"""Localization of one zone in a period: the isolated solution plus a correction.

The neighbouring zones are replaced by their nominal pressure P_s/L outside the strip of width L
around the zone, so that (1/pi) PV int p/(x-xi) = (E*/2) f' + (2 P_s/pi L) artanh(2x/L). I. G.
Goryacheva & I. Tsukanov, Front. Mech. Eng. 6 (2020) 45, doi 10.3389/fmech.2020.00045, eq.
(13)-(17), (23)-(30).
"""

from dataclasses import dataclass
from math import pi, sqrt
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import minimize_scalar

from contact.errors import OutOfRange, SceneError
from contact.model.checks import between, one_of, positive
from contact.reference.exact.base import SymmetricZone
from contact.reference.exact.numerics import Array, arcosh1p, integrated, root
from contact.reference.exact.parabola import HertzLine
from contact.reference.exact.sinusoid import IsolatedSinusoid
from contact.reference.exact.wedge import IsolatedWedge

Isolated = HertzLine | IsolatedWedge | IsolatedSinusoid

FIRST_ORDER = "first-order"
SELF_CONSISTENT = "self-consistent"


def correction_pressure(
    x: ArrayLike, half_width: float, period: float, nominal_load: float
) -> Array:
    """Pressure p(x) [Pa] that the contact in all other periods adds to the isolated solution.

    It is (2 P_s/pi L) arctan(2 sqrt(a^2 - x^2)/sqrt(L^2 - 4a^2)) with the nominal load P_s, the
    period L and the half width a: the second term of (17) in I. G. Goryacheva & I. Tsukanov,
    Front. Mech. Eng. 6 (2020) 45, doi 10.3389/fmech.2020.00045.

    Parameters
    ----------
    x : array_like
        Positions of any shape [m]; outside the zone the correction is 0, as at its ends.
    half_width : float
        Half width a of the zone, below L/2 [m].
    period : float
        Period L [m].
    nominal_load : float
        P_s per period of the neighbours [N/m].

    Returns
    -------
    array
        [Pa], of the shape of x.

    Examples
    --------
    In the middle it is (2 P_s/pi L) arcsin(2a/L).

    >>> import numpy as np
    >>> from contact.exact import correction_pressure
    >>> p = correction_pressure(0.0, half_width=0.25, period=1.0, nominal_load=3.0)
    >>> bool(np.isclose(p, 1.0))
    True
    """
    r = np.minimum(np.abs(np.asarray(x, dtype=float)), half_width)
    return _correction(r, half_width - r, half_width, period, nominal_load)


def correction_load(half_width: float, period: float, nominal_load: float) -> float:
    """Load [N/m] that the contact in all other periods adds to the isolated solution.

    It is P_s (L - sqrt(L^2 - 4a^2))/L with the nominal load P_s, the period L and the half width a:
    the second term of (16) in the following paper.

    I. G. Goryacheva & I. Tsukanov, Front. Mech. Eng. 6 (2020) 45, doi 10.3389/fmech.2020.00045.

    Parameters
    ----------
    half_width : float
        Half width a of the zone, below L/2 [m].
    period : float
        Period L [m].
    nominal_load : float
        P_s per period of the neighbours [N/m].

    Returns
    -------
    float
        [N/m].

    Examples
    --------
    1 - sqrt(1 - 0.6^2) = 0.2.

    >>> import numpy as np
    >>> from contact.exact import correction_load
    >>> bool(np.isclose(correction_load(half_width=0.3, period=1.0, nominal_load=1.0), 0.2))
    True
    """
    return nominal_load * 4.0 * half_width**2 / (period * (period + _root(half_width, period)))


def _root(a: float, period: float) -> float:
    """The value of sqrt(L^2 - 4a^2) for the half width a of a zone and the period L."""
    return sqrt((period - 2.0 * a) * (period + 2.0 * a))


def _correction(r: Array, d: Array, a: float, period: float, nominal_load: float) -> Array:
    reach = 2.0 * np.sqrt(d * (a + r))
    return 2.0 * nominal_load / (pi * period) * np.arctan2(reach, _root(a, period))


@dataclass(frozen=True)
class LocalizedZone(SymmetricZone):
    """One zone under the localized model: an isolated solution plus a correction.
    The correction replaces the contact in all other periods by a nominal pressure.

    P0 is the load of the isolated solution. With the closure `first-order` (the paper's examples
    (23), (27), (30)) P_s = P0 and P = P0 (2 - sqrt(L^2 - 4a^2)/L). With `self-consistent` (equation
    (16) solved) P_s = P = P0 L/sqrt(L^2 - 4a^2). Pressure, gap and zones are in `SymmetricZone`.
    I. G. Goryacheva & I. Tsukanov, Front. Mech. Eng. 6 (2020) 45, doi 10.3389/fmech.2020.00045.

    Parameters
    ----------
    isolated : HertzLine or IsolatedWedge or IsolatedSinusoid
        The isolated solution; a sinusoid's wavelength is the period.
    period : float
        Period L [m].
    closure : str
        "first-order" or "self-consistent".

    Attributes
    ----------
    load : float
        P per period [N/m].
    nominal_load : float
        P_s [N/m].
    approach, stiffness : None
        The closures do not fix a common level of u.

    Raises
    ------
    SceneError
        If the solution is of another family, the closure unknown, or the zone as wide as the
        period.
    OutOfRange
        If the pressure would be negative at the ends.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.exact import HertzLine, LocalizedZone
    >>> isolated = HertzLine(radius=1.0, E_star=1e9, half_width=3e-3)
    >>> row = LocalizedZone(isolated, period=1e-2, closure="self-consistent")
    >>> bool(np.isclose(row.load, isolated.load / 0.8))  # sqrt(1 - 0.6^2) = 0.8
    True
    """

    isolated: Isolated
    period: float
    closure: str = FIRST_ORDER
    datum = None

    def __post_init__(self) -> None:
        positive("period", self.period)
        one_of("closure", self.closure, (FIRST_ORDER, SELF_CONSISTENT))
        if not isinstance(self.isolated, Isolated):
            raise SceneError.of(
                "isolated", self.isolated, "a HertzLine, an IsolatedWedge or an IsolatedSinusoid"
            )
        between("half_width", self.half_width, 0.0, 0.5 * self.period)
        if isinstance(self.isolated, IsolatedSinusoid) and self.isolated.wavelength != self.period:
            raise SceneError.of(
                "wavelength", self.isolated.wavelength, f"the period {self.period:.17g}"
            )
        if float(self.load_rate(np.array(self.half_width))) < 0.0:
            raise OutOfRange(
                f"half_width = {self.half_width:.6g} m is out of range: the pressure would be "
                "negative at the ends of the zone"
            )

    half_width = property(lambda self: self.isolated.half_width)  # type: ignore[assignment]
    E_star = property(lambda self: self.isolated.E_star)  # type: ignore[assignment]
    # The nominal pressure acts outside one period only. It leaves a constant in the displacement
    # undetermined. Therefore the approach and the stiffness are not defined.
    approach = property(lambda self: None)
    stiffness = property(lambda self: None)

    @property
    def nominal_load(self) -> float:
        """Nominal load [N/m]: the nominal pressure outside one period, times the period."""
        return self.isolated.load if self.closure == FIRST_ORDER else self.load

    @property
    def load(self) -> float:
        return _load(self.isolated, self.period, self.closure)

    def load_rate(self, s: Array) -> Array:
        """Derivative dP/ds of the load P of a zone by its half width s, at a fixed nominal load."""
        s = np.asarray(s)
        z = 2.0 * s / self.period
        # The half width s may be rounded to L/2, where the rate dP/ds is infinite. A lower bound of
        # `root` is allowed, because the integral of the rate is finite.
        root = np.sqrt(np.maximum(1.0 - z, 1e-16) * (1.0 + z))
        return self.isolated.load_rate(s) + 2.0 * self.nominal_load / self.period * z / root

    def _height(self, r: Array) -> Array:
        return self.isolated.height(r)

    def _slope(self, r: Array) -> Array:
        return self.isolated.slope(r)

    def _pressure(self, r: Array, d: Array) -> Array:
        correction = _correction(r, d, self.half_width, self.period, self.nominal_load)
        return self.isolated._pressure(r, d) + correction

    def _gap(self, e: Array) -> Array:
        e = np.minimum(e, 0.5 * self.period - self.half_width)
        a = self.half_width

        def integrand(y: Array, rest: Array) -> Array:
            return self.load_rate(a + y) * arcosh1p(rest / (a + y))

        return 2.0 / (pi * self.E_star) * integrated(integrand, e)


def _load(isolated: Isolated, period: float, closure: str) -> float:
    a, load = isolated.half_width, isolated.load
    if closure == FIRST_ORDER:
        return load + correction_load(a, period, load)
    return load * period / _root(a, period)


def localized_at_load(
    family: type[Isolated], load: float, period: float, closure: str = FIRST_ORDER, **shape: Any
) -> LocalizedZone:
    """The localized solution that carries a given load, on the branch that starts at zero load.

    The first-order load of a sinusoid has a maximum on that branch, near a/L = 0.44.

    Parameters
    ----------
    family : type
        HertzLine, IsolatedWedge or IsolatedSinusoid.
    load : float
        P per period [N/m].
    period : float
        Period L [m].
    closure : str
        "first-order" or "self-consistent": see `LocalizedZone`.
    **shape : float
        The other parameters of the family by name; a sinusoid's wavelength is the period if left
        out.

    Returns
    -------
    LocalizedZone

    Raises
    ------
    SceneError
        If a number is not positive and finite, or the closure unknown.
    OutOfRange
        If the load is above the greatest one.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.exact import IsolatedSinusoid, localized_at_load
    >>> row = localized_at_load(IsolatedSinusoid, 500.0, period=1e-4, amplitude=1e-6, E_star=1e9)
    >>> bool(np.isclose(row.load, 500.0)), row.isolated.load < 500.0
    (True, True)
    """
    positive("load", load)
    positive("period", period)
    one_of("closure", closure, (FIRST_ORDER, SELF_CONSISTENT))
    if family is IsolatedSinusoid:
        shape = {"wavelength": period, **shape}

    def at(a: float) -> float:
        return _load(family(half_width=a, **shape), period, closure)

    # The load first falls after `widths[i]`. So its first maximum lies between the two samples next
    # to `widths[i]`.
    widths = 0.5 * period * np.linspace(0.0, 1.0, 258)[1:-1]
    falling = np.flatnonzero(np.diff([at(a) for a in widths]) < 0.0)
    last = 0.5 * period * (1.0 - 1e-12)
    if falling.size:
        i = int(falling[0])
        bracket = float(widths[max(i - 1, 0)]), float(widths[i + 1])
        last = float(minimize_scalar(lambda a: -at(a), bounds=bracket, method="bounded").x)
    most = at(last)
    if load > most:
        raise OutOfRange(
            f"load = {load:.6g} N/m is out of range: with the {closure} closure it is at most "
            f"{most:.6g} N/m"
        )
    first = 0.25 * period
    while at(first) > load:
        first *= 0.5
    a = root(lambda w: at(w) - load, min(first, last), last)
    return LocalizedZone(family(half_width=a, **shape), period, closure)
