"""A load path as plain data and as CSV, in SI units: one row per load, with its events."""

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from contact.extras import version
from contact.model.units import quantity
from contact.solution.export import csv_of, describe, plain
from contact.solution.solution import Solution
from contact.sweeps.points import NUMBERS, numbers
from sie import Array


@dataclass(frozen=True, eq=False)
class Event:
    """A change of the number of zones between two loads of a path.

    Parameters
    ----------
    kind : str
        birth, death, merge, split or full; onset or join if plateaus change.
    load : float
        The load at the event [N/m].
    position : float
        The place of the event on the profile [m].
    before, after : ndarray
        The zones [m], (n, 2), just before and just after the event along the path; (0, 2) in full
        contact. For the kinds onset and join they are the plateaus.
    error : float or None
        Bound of the relative error of the load; None where it is not stated.

    Examples
    --------
    >>> import contact
    >>> pair = contact.Scene(contact.Biquadratic(1.0, 0.2), 1e9, contact.Isolated(), load=1.0)
    >>> (event,) = contact.path(pair, [1e5, 1e7]).events
    >>> event.kind, len(event.before), len(event.after)
    ('merge', 2, 1)
    >>> print(event)
    merge at 3.927 kN/mm, x = 0 m, zones: 2 to 1
    """

    kind: str
    load: float
    position: float
    before: Array
    after: Array
    error: float | None = field(default=None, kw_only=True)

    def change(self) -> str:
        """Text with the numbers of zones before and after the event, such as "3 to 2"."""
        if self.kind in ("onset", "join"):
            return f"plateaus: {len(self.before)} to {len(self.after)}"
        return f"{len(self.before) or 'full contact'} to {len(self.after) or 'full contact'}"

    def __str__(self) -> str:
        """The event in one line, with units."""
        load, place, change = (
            quantity(self.load, "N/m"),
            quantity(self.position, "m"),
            self.change(),
        )
        zones = change if change.startswith("plateaus") else f"zones: {change}"
        return f"{self.kind} at {load}, x = {place}, {zones}"


Passed = Sequence[Sequence[Event]]


def columns(solutions: Sequence[Solution]) -> dict[str, list[float]]:
    """The summary numbers of all solutions, as one list for each name in `NUMBERS`.
    A quantity that the scene does not define is nan.
    """
    rows = [numbers(solution) for solution in solutions]
    return {name: [row[name] for row in rows] for name in NUMBERS}


def to_dict(solutions: Sequence[Solution], passed: Passed) -> dict[str, Any]:
    """A dictionary of the path in plain types: columns, events, scene and units.
    Undefined numbers are None.
    """
    scene = solutions[0].scene
    events = [{**_event(e), "point": point} for point, since in enumerate(passed) for e in since]
    data: dict[str, Any] = plain(
        {
            "points": columns(solutions),
            "events": events,
            "scene": {name: table for name, table in describe(scene).items() if name != "control"},
            "trace": scene.profile.trace_summary(),
            "units": {**{name: unit for name, (unit, _) in NUMBERS.items()}, "position": "m"},
            "warnings": list(
                dict.fromkeys(line for solution in solutions for line in solution.warnings)
            ),
            "version": version(),
        }
    )
    return data


def _event(event: Event) -> dict[str, Any]:
    """The fields of an event, with the numbers of zones before and after the event."""
    fields = {one.name: getattr(event, one.name) for one in dataclasses.fields(event) if one.repr}
    zones = {f"zones_{when}": len(fields.pop(when)) for when in ("before", "after")}
    return {**fields, **zones}


def to_csv(solutions: Sequence[Solution], passed: Passed) -> str:
    """CSV text with one row for each load, in full precision; `nan` for undefined values.

    The column `events` lists the events since the previous row as kind, load and position.
    """
    events = [
        "; ".join(f"{e.kind} {float(e.load)!r} {float(e.position)!r}" for e in since)
        for since in passed
    ]
    rows = [
        (*numbers(solution).values(), since)
        for solution, since in zip(solutions, events, strict=True)
    ]
    return csv_of((*NUMBERS, "events"), rows)
