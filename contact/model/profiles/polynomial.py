"""Polynomial profile f(x) = sum_k coefficients[k] x^k, on the cell if it is periodic."""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval
from numpy.typing import ArrayLike

from contact.errors import SceneError
from contact.model.checks import finite_array, keep, positive_or_none
from contact.model.profiles.base import Array, Profile
from contact.model.profiles.noise import ROUND_OFF
from contact.model.registry import register_profile


@register_profile("polynomial")
@dataclass(frozen=True, eq=False)
class Polynomial(Profile):
    """f = c0 + c1 x + c2 x^2 + ...; if there is a period, f must be equal at the two borders of
    the cell.

    Parameters
    ----------
    coefficients : array_like
        c0, c1, ... [m, 1, 1/m, ...], (n,), lowest power first, one beyond c0 not zero.
    period : float or None
        Length L [m] of the cell [-L/2, L/2) that repeats; None: f on the whole line.

    Raises
    ------
    SceneError
        If a coefficient is not finite, all beyond c0 are zero, or the heights at the borders of the
        period differ.

    Examples
    --------
    >>> import contact
    >>> contact.Polynomial([0.0, 0.0, 0.5, 0.0, 2.0]).height([0.0, 1.0]).tolist()
    [0.0, 2.5]
    """

    coefficients: ArrayLike
    period: float | None = None
    units = {"period": "m"}

    def __post_init__(self) -> None:
        c = finite_array("coefficients", self.coefficients)
        if not c[1:].any():
            raise SceneError.of(
                "coefficients",
                self.coefficients,
                "coefficients of ascending powers, at least one besides the constant not zero",
            )
        object.__setattr__(self, "coefficients", c)
        keep(self, positive_or_none, "period")
        if self.period is None:
            return
        half = self.period / 2
        step = polyval(half, c) - polyval(-half, c)
        if abs(step) > ROUND_OFF * float(polyval(half, np.abs(c) * (np.arange(c.size) > 0))):
            allowed = (
                "such that the heights at both ends of the period agree (they differ by "
                f"{step:.3g} m)"
            )
            raise SceneError.of("coefficients", self.coefficients, allowed)

    def height(self, x: ArrayLike) -> Array:
        return np.asarray(polyval(self.wrap(x), self._c))

    def slope(self, x: ArrayLike) -> Array:
        return np.asarray(polyval(np.asarray(self.wrap(x), dtype=np.float64), polyder(self._c)))

    @property
    def _c(self) -> Array:
        return np.asarray(self.coefficients, dtype=np.float64)

    @property
    def symmetric(self) -> bool:
        return not self._c[1::2].any()

    @property
    def kinks(self) -> Array:
        return self._jumps_at_the_border(1)[:, ::2]

    @property
    def jumps(self) -> Array:
        """Jumps of the second and third derivatives of f where the cells meet."""
        return self._jumps_at_the_border(2, 3)

    def _jumps_at_the_border(self, *orders: int) -> Array:
        """Rows (place, order, jump) of the derivatives of these orders that jump where the cells
        meet.
        """
        found = []
        for order in orders if self.period is not None else ():
            d = polyder(self._c, order)
            jump = float(polyval(self.x0, d) - polyval(-self.x0, d))
            if abs(jump) > ROUND_OFF * float(polyval(-self.x0, np.abs(d))):
                found.append((self.x0, order, jump))
        return np.array(found, dtype=np.float64).reshape(-1, 3)

    @property
    def breakpoints(self) -> Array:
        # Even if the slopes at both borders of the cell are equal, a higher derivative jumps at the
        # border between two cells.
        return np.empty(0) if self.period is None else np.array([self.x0])

    @property
    def resolution(self) -> float | None:
        return None if self.period is None else self.period / int(np.flatnonzero(self._c)[-1])
