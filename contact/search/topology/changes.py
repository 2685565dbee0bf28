"""What changes between two contacts, by the zones of both that overlap: zones begin or vanish, meet
or part.
"""

from dataclasses import dataclass

import numpy as np

from contact.formulation.tables import ascending, centred_on
from sie import Array


@dataclass(frozen=True)
class Change:
    """kind: birth or merge, and death or split, the same on the way back; where: the zone that
    begins or vanishes, or the gap between two that meet or part, and a little beside it.
    """

    kind: str
    where: tuple[float, float]

    @property
    def of_gap(self) -> bool:
        """Whether it is the gap that is zero there, else the pressure."""
        return self.kind in ("birth", "death")

    @property
    def ahead(self) -> bool:
        """Whether the contact before it has the zones with which its condition is a smooth one:
        without the zone that begins, or with the two as one.
        """
        return self.kind in ("birth", "split")


def changes(
    before: Array, after: Array, period: float | None, only_grows: bool, shared: float = 0.0
) -> list[Change]:
    """Changes that lead from the zones of one contact (n, 2) to those of another (m, 2).
    only_grows: none vanish or part; shared: see `held`.
    """
    found = _grown(before, after, period, shared, "birth", "merge")
    return found if only_grows else found + _grown(after, before, period, shared, "death", "split")


def held(zones: Array, a: float, b: float, period: float | None, shared: float = 0.0) -> Array:
    """Those of the zones, moved by periods, that overlap the one from a to b (k, 2), by more than a
    part of the narrower one.
    """
    zones = ascending(centred_on(zones, 0.5 * (a + b), period))
    zones = zones[(zones[:, 0] < b) & (zones[:, 1] > a)]
    overlap = np.minimum(zones[:, 1], b) - np.maximum(zones[:, 0], a)
    return zones[overlap >= shared * np.minimum(zones[:, 1] - zones[:, 0], b - a)]


def _grown(
    low: Array, high: Array, period: float | None, shared: float, new: str, met: str
) -> list[Change]:
    """What is new among the zones `high` beside those of `low`, and which of these have met."""
    found = []
    for a, b in high.tolist():
        parts = held(low, a, b, period, shared)
        if len(parts) == 0:
            found.append(Change(new, (a, b)))
        for left, right in zip(parts[:-1, 1].tolist(), parts[1:, 0].tolist(), strict=True):
            found.append(Change(met, (left - 0.25 * (right - left), right + 0.25 * (right - left))))
    return found
