"""Zones that stick within the zones of contact, and the intervals around them that slip."""

from dataclasses import dataclass

import numpy as np

from contact.formulation import tables
from contact.solution.solution import Solution
from sie import Array, wrapped


@dataclass(frozen=True)
class StickAndSlip:
    """The intervals of a contact that stick, and those that slip.

    Parameters
    ----------
    stick, slip : ndarray
        Intervals [m], (m, 2) and (k, 2), in the form of `Solution.zones`. In full contact that
        sticks everywhere, `stick` is one period.
    is_nested : bool
        Whether all that sticks lies within the contact, up to the stated errors.
    largest : float
        Largest ratio of the width of an interval that sticks to the width of the zone of contact
        around it.
    """

    stick: Array
    slip: Array
    is_nested: bool
    largest: float = 1.0


def contact_zones(solution: Solution) -> Array:
    """Zones of a solution (n, 2) [m]; in full contact one period."""
    if len(solution.zones):
        return solution.zones
    start, period = solution.scene.profile.x0, solution.scene.period
    return np.zeros((0, 2)) if period is None else np.array([[start, start + period]])


def parted(solution: Solution, stick: Array, error: float = 0.0) -> StickAndSlip:
    """The contact of a solution, split into the given stick zones and the rest, which slips.

    error: stated error of ends, divided by the width of their zone.
    """
    zones, period = contact_zones(solution), solution.scene.period
    if len(stick) == 0:
        return StickAndSlip(stick, zones, True)
    if len(solution.zones) == 0 and period is not None:
        is_whole = bool(np.any(np.diff(stick) >= period))
        slip = np.zeros((0, 2)) if is_whole else tables.gaps_between(stick, period)
        return StickAndSlip(stick, tables.in_cell(slip, zones[0, 0], period), True)
    middle = stick.mean(axis=1)
    moved = middle if period is None else wrapped(middle, zones[0, 0], period)
    stick = tables.ascending(stick + (moved - middle)[:, None])
    zone = np.maximum(np.searchsorted(zones[:, 0], np.sort(moved), side="right") - 1, 0)
    around = zones[zone]
    # Ends of stick and contact zones that coincide in theory may differ in the last digits.
    margin = error * np.diff(around) + 8 * np.spacing(np.abs(around).max())
    over = np.column_stack((around[:, 0] - stick[:, 0], stick[:, 1] - around[:, 1]))
    is_nested = bool(np.all(over <= margin))
    largest = float((np.diff(stick) / np.diff(around)).max())
    stick = np.where(np.abs(over) <= 8 * np.spacing(np.abs(around).max()), around, stick)
    stick = np.clip(stick, around[:, :1], around[:, 1:])
    left = np.sort(np.concatenate((zones[:, 0], stick[:, 1])))
    right = np.sort(np.concatenate((zones[:, 1], stick[:, 0])))
    slip = np.column_stack((left, right))
    slip = slip[slip[:, 1] > slip[:, 0]]
    start = solution.scene.profile.x0
    return StickAndSlip(
        tables.in_cell(stick, start, period),
        tables.in_cell(slip, start, period),
        is_nested,
        min(largest, 1.0),
    )
