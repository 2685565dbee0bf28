"""A load path as data: a row for each load, and the events since the one before; plain types and
CSV, in SI units.
"""

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from contact.extras import version
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
        birth, death, merge, split or full.
    load : float
        Where it happens [N/m].
    position : float
        Where on the profile [m].
    before, after : ndarray
        The zones [m], (n, 2), just before and just after in the direction of the path; full contact
        has none.

    Examples
    --------
    >>> import contact
    >>> pair = contact.Scene(contact.Biquadratic(1.0, 0.2), 1e9, contact.Isolated(), load=1.0)
    >>> (event,) = contact.path(pair, [1e5, 1e7]).events
    >>> event.kind, len(event.before), len(event.after)
    ('merge', 2, 1)
    """

    kind: str
    load: float
    position: float
    before: Array
    after: Array

    def change(self) -> str:
        """How many zones there are before and after it, in words."""
        return f"{len(self.before) or 'full contact'} to {len(self.after) or 'full contact'}"


Passed = Sequence[Sequence[Event]]


def columns(solutions: Sequence[Solution]) -> dict[str, list[float]]:
    """A list for each of NUMBERS, nan for what the scene does not define."""
    rows = [numbers(solution) for solution in solutions]
    return {name: [row[name] for row in rows] for name in NUMBERS}


def to_dict(solutions: Sequence[Solution], passed: Passed) -> dict[str, Any]:
    """Columns, events, scene and units; None for what is not defined, or infinite."""
    scene = solutions[0].scene
    events = [{**_event(e), "point": point} for point, since in enumerate(passed) for e in since]
    told: dict[str, Any] = plain(
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
    return told


def _event(event: Event) -> dict[str, Any]:
    """All that an event says, of its zones how many they are."""
    said = {
        field.name: getattr(event, field.name) for field in dataclasses.fields(event) if field.repr
    }
    zones = {f"zones_{when}": len(said.pop(when)) for when in ("before", "after")}
    return {**said, **zones}


def to_csv(solutions: Sequence[Solution], passed: Passed) -> str:
    """A row a load, in full precision, `nan` for what is not defined; `events` since the row before
    are kind, load and position each.
    """
    told = [
        "; ".join(f"{e.kind} {float(e.load)!r} {float(e.position)!r}" for e in since)
        for since in passed
    ]
    rows = [
        (*numbers(solution).values(), since)
        for solution, since in zip(solutions, told, strict=True)
    ]
    return csv_of((*NUMBERS, "events"), rows)
