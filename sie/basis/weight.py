"""The weight of a density on a zone: its exponent, and what follows from the exponent alone.

On a zone of half width w let t = -1 ... 1 be the coordinate. A density is a sum of

    (1 - t^2)^(-p) T(t)    and    (1 - t^2)^(1-p) U(t)

with polynomials T and U. At a small distance d from an end it is K d^(-p) + A d^(1-p), with the
intensity K and the edge slope A. For Cauchy's kernel p is 1/2.

Every exponent of a density stands in six files: here, in `interval` and `chebyshev` (the functions
on one zone for p = 1/2), `sie.density.series` (moments), `sie.dense.system` (rows) and
`sie.states.state` (constants of the stated error). All other files ask the zones. What holds for
p = 1/2 only calls `needs_half`.
"""

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Weight:
    """The weight (1 - t^2)^(-p) of a density.

    exponent: p, between 0 and 1.
    """

    exponent: float = 0.5

    def edge_scale(self, w: Any) -> Any:
        """The intensity K of the weight (1 - t^2)^(-p) on a zone of half width w."""
        return (0.5 * w) ** self.exponent

    def slope_scale(self, w: Any) -> Any:
        """The edge slope A of the density (1 - t^2)^(1-p) on a zone of half width w."""
        return (2 / w) ** (1 - self.exponent)

    def end_step(self, k: Any, slope: Any) -> Any:
        """The outward motion of an end that removes its intensity k, to first order.

        The motion s of an end with K = 0 shifts A d^(1-p) by s, which changes K by -(1 - p) A s.
        """
        return k / ((1 - self.exponent) * slope)

    def secant_slope(self, change: Any, move: Any) -> Any:
        """Edge slope A for which the `move` of an end changes the end's intensity by `change`."""
        return -change / ((1 - self.exponent) * move)


HALF = Weight()


def needs_half(weight: Weight, what: str) -> None:
    """Raise ValueError unless the exponent is 1/2; `what` names the part that needs 1/2."""
    if weight != HALF:
        raise ValueError(f"{what}: known for the exponent 1/2 only, got {weight.exponent:g}")
