"""The homogeneous elastic half-plane: L = 1 (Muskhelishvili 1953, Shtaerman 1949)."""

from dataclasses import dataclass

import numpy as np

from contact.model.registry import register_substrate
from contact.model.substrates.base import Substrate
from sie import Array


@register_substrate("half-plane")
@dataclass(frozen=True)
class HalfPlane(Substrate):
    """A deep and wide body, whose symbol L is 1, and whose kernel of a line load is 1/r.

    Examples
    --------
    >>> import contact
    >>> import numpy as np
    >>> contact.HalfPlane().symbol(np.array([1.0, 10.0])).tolist()
    [1.0, 1.0]
    """

    def symbol(self, q: Array) -> Array:
        return np.ones_like(q)
