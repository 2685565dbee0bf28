"""Changes between two contacts: zones that begin or vanish, meet or part.

Zones of the two contacts correspond if they overlap.
"""

from dataclasses import dataclass

import numpy as np

from contact.formulation.tables import ascending, centred_on
from sie import Array

# The stated place of a merger or a split is the gap between the zones that meet or part, extended
# on either side by this fraction of the gap's width.
MARGIN = 0.25


@dataclass(frozen=True)
class Change:
    """One change of the number of zones between two contacts.

    kind: "birth" or "merge"; in the opposite direction "death" or "split". where: the zone that
    begins or vanishes, or the gap between two zones that meet or part, widened by a margin.
    """

    kind: str
    where: tuple[float, float]

    @property
    def of_gap(self) -> bool:
        """Whether the gap becomes zero at the change (birth, death). If not, the pressure does."""
        return self.kind in ("birth", "death")

    @property
    def ahead(self) -> bool:
        """Whether the change is located with the zones before it; if not, with the zones after it.

        The side with fewer zones is used: without the zone that begins or vanishes, or with one
        zone in place of the two that meet or part. With these zones, the gap or pressure that
        becomes zero is a smooth function of the control.
        """
        return self.kind in ("birth", "split")


def changes(
    before: Array, after: Array, period: float | None, only_grows: bool, shared: float = 0.0
) -> list[Change]:
    """Births, mergers, deaths and splits of zones, from `before` (n, 2) to `after` (m, 2).

    only_grows: no zone vanishes or parts. shared: see `overlapping`.
    """
    found = _grown(before, after, period, shared, "birth", "merge")
    return found if only_grows else found + _grown(after, before, period, shared, "death", "split")


def overlapping(
    zones: Array, a: float, b: float, period: float | None, shared: float = 0.0
) -> Array:
    """The zones (k, 2), moved by whole periods, that overlap the zone from a to b.

    shared: the least overlap, divided by the width of the narrower of the two zones.
    """
    zones = ascending(centred_on(zones, 0.5 * (a + b), period))
    zones = zones[(zones[:, 0] < b) & (zones[:, 1] > a)]
    overlap = np.minimum(zones[:, 1], b) - np.maximum(zones[:, 0], a)
    return zones[overlap >= shared * np.minimum(zones[:, 1] - zones[:, 0], b - a)]


def _grown(
    low: Array, high: Array, period: float | None, shared: float, birth: str, merger: str
) -> list[Change]:
    """Changes of the kinds `birth` and `merger` from the zones `low` to the zones `high`."""
    found = []
    for a, b in high.tolist():
        parts = overlapping(low, a, b, period, shared)
        if len(parts) == 0:
            found.append(Change(birth, (a, b)))
        for left, right in zip(parts[:-1, 1].tolist(), parts[1:, 0].tolist(), strict=True):
            margin = MARGIN * (right - left)
            found.append(Change(merger, (left - margin, right + margin)))
    return found
