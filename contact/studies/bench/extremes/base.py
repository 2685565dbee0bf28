"""`Extreme`: a scene, its exact solution, and the error that rounded data allow."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from contact.model.scene import Scene
from contact.studies.bench.truth import Exact


@dataclass(frozen=True, eq=False)
class Extreme:
    """An extreme scene, its exact solution, and the error that rounded input data allow.

    `condition` bounds the change of the result per relative change of the data. The result is the
    pressure relative to the peak, and the ends relative to the widths. The data are the load, and
    the slopes relative to the steepest one. `why` says how the bound is known. The allowed error is
    100 round-offs times the condition. `hair` is the width of the narrowest gap relative to its
    zone, or the pressure of the smallest zone relative to the peak. If the allowed error is larger
    than `hair`, contacts with and without this gap or zone both count as right. `heavy` scenes take
    more than about a second. `known` is the reason of a known failure.
    """

    group: str
    name: str
    make: Callable[[], tuple[Scene, Exact]] = field(repr=False)
    condition: float
    why: str
    heavy: bool = False
    hair: float = 1.0
    known: str = ""

    @property
    def allowed(self) -> float:
        """The allowed error of a solution, from the condition number of the scene.
        It is at least 1e-13, as no solution states an error below about 5e-14.
        """
        return max(1e-13, 100 * float(np.finfo(float).eps) * self.condition)

    @property
    def decidable(self) -> bool:
        """Whether only one number of zones is right: the allowed error is below `hair`.
        `hair` is the relative width of the narrowest gap, or the relative pressure of the smallest
        zone.
        """
        return self.allowed < self.hair
