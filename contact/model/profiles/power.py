"""Power-law indenter, alone or in a row: f(x) = coefficient |x|^exponent.

V. L. Popov, M. Hess & E. Willert, Handbook of Contact Mechanics (2019), doi
10.1007/978-3-662-58709-6.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from contact.errors import SceneError
from contact.model.checks import keep, positive, positive_or_none
from contact.model.profiles.base import AT_ORIGIN, Array, Profile
from contact.model.registry import register_profile


@register_profile("power")
@dataclass(frozen=True)
class Power(Profile):
    """f = coefficient |x|^exponent on the cell; if there is a period, there is a corner where
    cells meet.

    Exponent 1 is the wedge, 2 the parabola. V. L. Popov, M. Hess & E. Willert, Handbook of Contact
    Mechanics (2019), doi 10.1007/978-3-662-58709-6.

    Parameters
    ----------
    coefficient : float
        C [m^(1 - exponent)].
    exponent : float
        n [1], at least 1. Below 1 the tip is a cusp, infinitely steep, where the theory of small
        slopes says nothing.
    period : float or None
        Length [m] after which the shape repeats; None: it stands alone.

    Raises
    ------
    SceneError
        If a number is not finite and positive, the exponent is below 1, or the heights are too
        large or too small for numbers.

    Examples
    --------
    The load of a half width a grows as a^n.

    >>> import contact
    >>> def half_width(load):
    ...     scene = contact.Scene(contact.Power(0.1, 1.5), 1e9, contact.Isolated(), load=load)
    ...     return contact.solve(scene).zones[0, 1]
    >>> float((half_width(8e3) / half_width(1e3)).round(9))
    4.0
    """

    coefficient: float
    exponent: float
    period: float | None = None
    units = {"coefficient": "m^(1-n)", "exponent": "1", "period": "m"}
    symmetric = True
    summits = AT_ORIGIN

    def __post_init__(self) -> None:
        keep(self, positive, "coefficient", "exponent")
        keep(self, positive_or_none, "period")
        if self.exponent < 1.0:
            raise SceneError.of(
                "exponent",
                self.exponent,
                "at least 1: below 1 the tip is infinitely steep, but the theory assumes small "
                "slopes; round the tip in a profile of your own, such as "
                "coefficient (x^2 + r^2)^(exponent/2)",
            )
        if self.period is not None:
            with np.errstate(all="ignore"):
                slope = float(self.slope(np.array([0.49 * self.period]))[0])
            if not 0.0 < slope < np.inf:
                raise SceneError.of(
                    "coefficient",
                    self.coefficient,
                    "such that the slope is above 0 and finite (near the end of a period it is "
                    f"{slope})",
                )

    def height(self, x: ArrayLike) -> Array:
        with np.errstate(over="ignore"):
            return np.asarray(self.coefficient * np.abs(self.wrap(x)) ** self.exponent)

    def slope(self, x: ArrayLike) -> Array:
        at = np.asarray(self.wrap(x), dtype=np.float64) + 0.0  # turns -0.0 into 0.0
        with np.errstate(over="ignore"):
            return np.copysign(
                self.coefficient * self.exponent * np.abs(at) ** (self.exponent - 1.0), at
            )

    @property
    def resolution(self) -> float | None:
        return None if self.period is None else self.period / self.exponent

    @property
    def kinks(self) -> Array:
        tip = [[0.0, 2 * self.coefficient]] if self.exponent == 1.0 else []
        return np.array([[at, jump] for at, _, jump in self._at_border(1)] + tip).reshape(-1, 2)

    @property
    def jumps(self) -> Array:
        return np.array([[at, order, 2 * jump] for at, order, jump in self._at_border(3)]).reshape(
            -1, 3
        )

    @property
    def algebraic_points(self) -> Array:
        tip = (
            [[0.0, self.exponent, self.coefficient, self.coefficient]]
            if self.exponent > 1.0
            else []
        )
        # Near the border of two periods, f contains odd powers of the distance from this border.
        # Powers 1 and 3 are declared in `kinks` and `jumps`, powers 5 and 7 here. Power 9 is smooth
        # enough to be left out.
        border = [
            [at, order, jump / (2 * order), jump / (2 * order)]
            for at, order, jump in self._at_border(5, 7)
        ]
        return np.array(tip + border).reshape(-1, 4)

    def _at_border(self, *orders: int) -> list[tuple[float, int, float]]:
        """Rows (s, k, 2k c) for odd orders k: near the place s where two cells meet, f contains c
        d^k with d the distance from s.

        f goes as (L/2 - d)^n at the distance d on both sides; even powers of d are smooth.
        """
        if self.period is None:
            return []
        found = []
        for k in orders:
            binomial = np.prod([(self.exponent - j) / (j + 1) for j in range(k)])
            size = self.coefficient * binomial * (0.5 * self.period) ** (self.exponent - k)
            if size != 0.0:
                found.append((self.x0, k, -2 * k * float(size)))
        return found
