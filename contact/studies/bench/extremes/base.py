"""What a stiff or extreme case is: a scene, its truth, and what rounding of its data allows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from contact.model.scene import Scene
from contact.studies.bench.truth import Exact

# What is allowed of a well-conditioned scene: the solver states no error below some 5e-14.
FLOOR = 1e-13
ROUNDINGS = 100
EPS = 2.2e-16


@dataclass(frozen=True, eq=False)
class Extreme:
    """One case.

    condition: by how much the stated measure (pressure over the peak, ends over widths) changes, at
    most, for a relative change of the load, or of the slopes over the steepest; known in closed
    form or bounded, as `why` says. What is allowed is 100 roundings times that. hair: the narrowest
    gap over its zone; where it is less than what is allowed, two topologies are the same answer.
    heavy: takes more than about a second. known: why it is known to fail, if it is.
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
        return max(FLOOR, ROUNDINGS * EPS * self.condition)

    @property
    def decidable(self) -> bool:
        """Whether rounded data tell its topology from the next one."""
        return self.allowed < self.hair
