"""All periods at once, exactly: equation (5) with the Hilbert kernel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import sie
from contact.model.interactions.base import Interaction
from contact.model.registry import register_interaction

Array = NDArray[np.float64]


@register_interaction("periodic")
@dataclass(frozen=True)
class Periodic(Interaction):
    """K = (pi/L) cot(pi (x - xi)/L) (Shtaerman 1949). The approach counts from mean u = 0 and min f = 0."""

    needs_period = True

    def symbol(self, q: Array) -> Array:
        return np.ones_like(q)

    def kernel(self, period: float | None, unit: float) -> sie.Kernel:
        assert period is not None
        return sie.hilbert(period)
