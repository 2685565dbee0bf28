"""How zones within intervals of tension change on the way from one state to another: without a jump, where a gap or a pressure is zero."""

from dataclasses import dataclass

import numpy as np

from contact.formulation.roots import maximum
from contact.formulation.tables import centred_on
from contact.formulation.tension.cohesive import Cohesive, CohesivePoint
from sie import Array

# A least gap or pressure is looked for at so many places.
_PLACES = 33


@dataclass(frozen=True)
class Change:
    """kind: birth or merge, and death or split, the same on the way back; ahead: the state before it has the zones with which its condition
    is a smooth one, without the zone that begins, or with the two as one; where: its place lies between."""

    kind: str
    ahead: bool
    where: tuple[float, float]

    @property
    def of_gap(self) -> bool:
        return self.kind in ("birth", "death")


def changes(before: CohesivePoint, after: CohesivePoint, period: float | None) -> list[Change]:
    if len(before.zones) == len(after.zones) and _alike(before.zones, after.zones, period):
        return []
    return [
        *_between(before.zones, after.zones, period, ("birth", True), ("merge", False)),
        *_between(after.zones, before.zones, period, ("death", False), ("split", True)),
    ]


def _alike(before: Array, after: Array, period: float | None) -> bool:
    """Whether each zone overlaps the one that stands for it."""
    return all(len(_held(before, a, b, period)) == 1 for a, b in after)


def _held(zones: Array, a: float, b: float, period: float | None) -> Array:
    """Those of the zones, moved by periods, that overlap one (k, 2)."""
    zones = centred_on(zones, 0.5 * (a + b), period)
    held = zones[(zones[:, 0] < b) & (zones[:, 1] > a)]
    return np.asarray(held[np.argsort(held[:, 0])])


def _between(
    low: Array, high: Array, period: float | None, new: tuple[str, bool], met: tuple[str, bool]
) -> list[Change]:
    """What is new among the zones `high` beside those of `low`, and which of these have met."""
    found = []
    for a, b in high:
        held = _held(low, a, b, period)
        if len(held) == 0:
            found.append(Change(*new, about(low, a, b, period)))
        for left, right in zip(held[:-1, 1], held[1:, 0], strict=True):
            found.append(Change(*met, (float(left - 0.25 * (right - left)), float(right + 0.25 * (right - left)))))
    return found


def about(zones: Array, a: float, b: float, period: float | None) -> tuple[float, float]:
    """Places about a zone that is not there yet, and away from others."""
    lo, hi = 1.5 * a - 0.5 * b, 1.5 * b - 0.5 * a
    for shift in (0.0,) if period is None else (-period, 0.0, period):
        for left, right in zones + shift:
            if right <= a:
                lo = max(lo, float(0.5 * (right + a)))
            elif left >= b:
                hi = min(hi, float(0.5 * (left + b)))
    return float(lo), float(hi)


def condition(curve: Cohesive, here: CohesivePoint, change: Change) -> tuple[float, float]:
    """(place, value) of the least gap where a zone begins, or of the least q where two meet."""
    x = np.linspace(*change.where, _PLACES)
    if change.of_gap:
        place, value = maximum(lambda at: -curve.gap(here, np.asarray(at)), x)
    else:
        assert here.q is not None
        density = here.q.density
        place, value = maximum(lambda at: -np.asarray(density(np.asarray(at))), x)
    return place, -value


def with_change(zones: Array, change: Change, place: float) -> Array:
    """The zones just on the other side of a change, from those with which its condition is smooth."""
    if change.of_gap:
        new = np.concatenate((zones, [[place, place]]))
        return np.asarray(new[np.argsort(new[:, 0])])
    out = []
    for a, b in zones:
        out += [(a, place), (place, b)] if a < place < b else [(a, b)]
    return np.array(out)
