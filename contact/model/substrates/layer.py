"""An elastic layer on a rigid base, bonded to it or resting on it without friction.

With s = q h, h the thickness, and k = 3 - 4 nu (K. L. Johnson, Contact Mechanics, 1985, 5.8),

    bonded    L = (2k sinh 2s - 4s) / (2k cosh 2s + 1 + k^2 + 4s^2),
    smooth    L = (cosh 2s - 1) / (sinh 2s + 2s).

For long waves L ~ s (1 - 2 nu) / (2 (1 - nu)^2) if bonded, and L ~ s / 2 if smooth; for waves
shorter than the thickness both are 1. Numerators and denominators are multiplied by exp(-2s), so
that nothing overflows. 2k sinh 2s - 4s is written as 2k (sinh 2s - 2s) + 4 (k - 1) s, in which
nothing cancels: k - 1 = 2 (1 - 2 nu) is 0 for an incompressible layer.
"""

from dataclasses import dataclass

import numpy as np

from contact.model.checks import keep, one_of, poisson_ratio, positive
from contact.model.profiles.noise import EPS
from contact.model.registry import register_substrate
from contact.model.substrates.base import Substrate
from sie import Array

BASES = ("bonded", "smooth")


@register_substrate("layer")
@dataclass(frozen=True)
class Layer(Substrate):
    """An elastic layer on a rigid base, to which it is bonded or on which it slides ("smooth").

    Displacements and the approach count from the base (K. L. Johnson, Contact Mechanics, 1985, doi
    10.1017/CBO9781139171731, section 5.8).

    Parameters
    ----------
    thickness : float
        h [m].
    nu : float
        Poisson's ratio [1], above -1 and at most 0.5; on a smooth base it matters in E_star only.
    base : str
        "bonded": the base holds the layer sideways; "smooth": it slides there without friction.

    Raises
    ------
    SceneError
        If the thickness is not a finite positive number, nu is out of range or the base is not one
        of these.

    Examples
    --------
    Waves much longer than the layer is thick only press it together; shorter ones do not feel its
    base.

    >>> import contact
    >>> import numpy as np
    >>> layer = contact.Layer(thickness=1e-3, nu=0.3, base="smooth")
    >>> layer.symbol(np.array([1.0, 1e5])).round(6).tolist(), layer.compression
    ([0.0005, 1.0], 0.0005)
    """

    thickness: float
    nu: float
    base: str = "bonded"
    units = {"thickness": "m", "nu": "1"}

    def __post_init__(self) -> None:
        keep(self, positive, "thickness")
        keep(self, poisson_ratio, "nu")
        one_of("base", self.base, BASES)

    @property
    def compression(self) -> float:  # type: ignore[override]
        """The limit of L(q)/q for small wavenumbers q, with L the symbol and h the thickness. It is
        h (1 - 2 nu) / (2 (1 - nu)^2) if the layer is bonded, and h/2 if it slides.
        """
        if self.base == "smooth":
            return 0.5 * self.thickness
        return 0.5 * self.thickness * (1 - 2 * self.nu) / (1 - self.nu) ** 2

    def symbol(self, q: Array) -> Array:
        s = self.thickness * np.asarray(q, dtype=np.float64)
        e, x = np.exp(-2 * s), 2 * s
        if self.base == "smooth":
            return np.asarray(np.expm1(-x) ** 2 / (x * 2 * e - np.expm1(-2 * x)))
        k, compressible = 3 - 4 * self.nu, 2 * (1 - 2 * self.nu)
        above = 2 * k * _sinh_less(x, e) + 2 * compressible * x * e
        below = k * (1 + e * e) + (1 + k * k) * e + (x * np.exp(-s)) ** 2
        return np.asarray(above / below)


def _sinh_less(x: Array, e: Array) -> Array:
    """The value of (sinh x - x) e, where e = exp(-x) is given as well."""
    # Below x = 1 the difference sinh x - x would lose digits. So the series x^3/3! + x^5/5! + ...
    # is summed instead.
    small = np.minimum(x, 1.0)
    term, series, power = small**3 / 6, np.zeros_like(x), 3
    while np.any(term > EPS * series):
        series += term
        power += 2
        term = term * small**2 / (power * (power - 1))
    return np.where(x < 1.0, series * e, 0.5 * (1 - e * e) - x * e)
