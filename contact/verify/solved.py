"""Intervals that passed, whatever the formulation: what both leave behind for their stated errors."""

from __future__ import annotations

from typing import Any

import sie
from contact.formulation.controls import Control
from contact.verify.certificate import Certificate
from sie import Array, record


@record
class Solved:
    """free: the Newton result. fields: under the load that the intervals have. rounds: corrections it took. tolerance: of the ends.
    off: how far the control may have been missed, in what the formulation says; of all intervals, or of each end (n, 2)."""

    free: sie.Free
    fields: Any
    certificate: Certificate
    rounds: int
    control: Control
    tolerance: float = 0.0
    off: float | Array = 0.0

    @property
    def error(self) -> float:
        """Bound of the errors of the pressure and of the zones' ends: see `Solution.error`."""
        raise NotImplementedError
