"""Exponents of a density at the ends of zones, and scales that follow from the exponents.

On a zone of half width w the scaled position t runs from -1 to 1. At a small distance d from an end
a density is K d^(-p) + A d^(1-p), with the intensity K and the edge slope A. For an equation of the
first kind p is 1/2 at all ends. For kappa phi + T phi = g, with the transform T,

    p = alpha at left ends,    p = 1 - alpha at right ends,    cot(pi alpha) = kappa

(N. I. Muskhelishvili, Singular Integral Equations, 1953, ch. 14). For a complex kappa the exponents
are complex: for i beta, alpha is 1/2 - i eps with eps = artanh(beta) / pi. Formulas that hold for
p = 1/2 only call `needs_half`. `sie.second_kind` solves equations with other exponents.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sie.basis.data import Array, Index


def alphas(kappa: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    """(alpha, 1 - alpha) for factors kappa: cot(pi alpha) = kappa, Re alpha in (0, 1).

    Both alpha and 1 - alpha have all digits even for large kappa.
    """
    if not np.iscomplexobj(kappa):
        return np.arctan2(1.0, kappa) / np.pi, np.arctan2(1.0, -kappa) / np.pi
    # alpha is 1/2 - arctan(kappa) / pi. If |Re kappa| > 1, arctan(kappa) is replaced by +-pi/2
    # minus the small arctan(1 / kappa), with the sign of Re kappa. So a small alpha or 1 - alpha
    # keeps its digits.
    large = np.abs(kappa.real) > 1
    small = np.arctan(np.where(large, 1 / np.where(large, kappa, 1.0), kappa)) / np.pi
    out = (
        np.where(large, np.where(kappa.real > 0, small, 1 + small), 0.5 - small),
        np.where(large, np.where(kappa.real > 0, 1 - small, -small), 0.5 + small),
    )
    return out


def power(base: Array, exponent: complex) -> NDArray[Any]:
    """The power base^exponent for base >= 0, also for base = 0 with a complex exponent.

    At base = 0 it is zero if the real part of the exponent is positive, else infinite, or for a
    complex exponent not a number.
    """
    out = np.asarray(base**exponent)
    return np.where(base == 0.0, 0.0, out) if np.iscomplexobj(out) and exponent.real > 0 else out


@dataclass(frozen=True, eq=False)
class Weight:
    """The exponents p of a density at ends of zones: it may grow there as distance^(-p).

    kappa: the factor of the density in the equation, one for each zone, all real or all complex;
    None for an equation of the first kind.
    """

    kappa: NDArray[Any] | None = None

    @property
    def is_half(self) -> bool:
        """Whether p = 1/2 at all ends; a density may grow there as (distance from the end)^(-p)."""
        return self.kappa is None

    @property
    def is_complex(self) -> bool:
        """Whether densities are complex."""
        return self.kappa is not None and np.iscomplexobj(self.kappa)

    @property
    def numbers(self) -> Any:
        """The Python type of the values of densities: complex if kappa is complex, else float."""
        return complex if self.is_complex else float

    @property
    def exponent(self) -> Any:
        """Exponent p at left and right ends (2, n); 1/2 for an equation of the first kind.
        Near an end, a density may grow as d^(-p), with the distance d from the end.
        """
        if self.kappa is None:
            return 0.5
        return np.array(alphas(self.kappa))

    @property
    def _factor(self) -> Any:
        """The factor sin(pi alpha) 2^(2p - 1) in `edge_scale` and `slope_scale`; 1 for p = 1/2.
        sin(pi alpha) = 1 / sqrt(1 + kappa^2).
        """
        if self.kappa is None:
            return 1.0
        kappa = self.kappa
        product = (1 + 1j * kappa) * (1 - 1j * kappa)
        root = np.sqrt(product) if self.is_complex else np.hypot(1.0, kappa)
        return 4**self.exponent / (2 * root)

    def edge_scale(self, w: Any) -> Any:
        """Intensities K of the density sin(pi alpha) (1 - t)^(alpha - 1) (1 + t)^(-alpha).
        There is one K for each end: the coefficient of d^(-p), with the distance d from the end.

        w: half width of the zone.
        """
        return self._factor * (0.5 * w) ** self.exponent

    def slope_scale(self, w: Any) -> Any:
        """Edge slopes A of the density sin(pi alpha) (1 - t)^alpha (1 + t)^(1 - alpha).
        There is one A for each end: the coefficient of d^(1 - p), with the distance d from the end.

        w: half width of the zone.
        """
        return self._factor * (2 / w) ** (1 - self.exponent)

    def end_step(self, k: Any, slope: Any) -> Any:
        """The outward motion of an end that makes its intensity k vanish, to first order.
        At the distance d from the end, the density is k / d^p + slope * d^(1 - p).

        An outward motion s of an end shifts the term A d^(1-p) by s. This changes the intensity K
        by -(1 - p) A s.
        """
        return k / ((1 - self.exponent) * slope)

    def secant_slope(self, change: Any, move: Any) -> Any:
        """Edge slope A for which the outward motion `move` of an end changes K by `change`.
        A and K are the coefficients of d^(1 - p) and d^(-p), with the distance d from the end.
        """
        return -change / ((1 - self.exponent) * move)

    def of(self, kept: Index) -> "Weight":
        """The exponents of the zones with the indices `kept` alone, as a `Weight`."""
        return self if self.kappa is None else Weight(self.kappa[kept])


HALF = Weight()


def needs_half(weight: Weight, what: str) -> None:
    """Raise ValueError unless the exponent is 1/2; `what` names the part that needs 1/2."""
    if not weight.is_half:
        raise ValueError(f"{what}: implemented for kappa = 0 only")
