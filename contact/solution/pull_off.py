"""Where a contact comes apart as its control falls."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PullOff:
    """The last equilibrium before the surfaces come apart altogether, as the control falls: load [N/m] (per period where there is one),
    approach [m] (None without), zones [m] there."""

    load: float
    approach: float | None
    zones: Array = field(repr=False)
