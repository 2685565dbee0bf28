"""A load path as data: a row for each load, and the events since the one before; plain types and CSV, in SI units."""

import csv
import dataclasses
import io
from collections.abc import Sequence
from typing import Any, ClassVar, Protocol

from numpy.typing import NDArray

from contact.extras import version
from contact.solution.export import describe, plain
from contact.solution.solution import Solution
from contact.sweeps.points import NUMBERS, numbers


class Change(Protocol):
    """An event of a path, a dataclass."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def kind(self) -> str: ...
    @property
    def load(self) -> float: ...
    @property
    def position(self) -> float: ...
    @property
    def before(self) -> NDArray[Any]: ...
    @property
    def after(self) -> NDArray[Any]: ...


Passed = Sequence[Sequence[Change]]


def columns(solutions: Sequence[Solution]) -> dict[str, list[float]]:
    """A list for each of NUMBERS, nan for what the scene does not define."""
    rows = [numbers(solution) for solution in solutions]
    return {name: [row[name] for row in rows] for name in NUMBERS}


def to_dict(solutions: Sequence[Solution], passed: Passed) -> dict[str, Any]:
    """Columns, events, scene and units; None for what is not defined, or infinite."""
    scene = solutions[0].scene
    events = [{**_event(e), "point": point} for point, since in enumerate(passed) for e in since]
    told = plain({
        "points": columns(solutions),
        "events": events,
        "scene": {name: table for name, table in describe(scene).items() if name != "control"},
        "trace": scene.profile.trace_summary(),
        "units": {**{name: unit for name, (unit, _) in NUMBERS.items()}, "position": "m"},
        "warnings": list(dict.fromkeys(line for solution in solutions for line in solution.warnings)),
        "version": version(),
    })
    assert isinstance(told, dict)
    return told


def _event(event: Change) -> dict[str, Any]:
    """All that an event says, of its zones how many they are."""
    said = {field.name: getattr(event, field.name) for field in dataclasses.fields(event) if field.repr}
    zones = {f"zones_{when}": len(said.pop(when)) for when in ("before", "after")}
    return {**said, **zones}


def to_csv(solutions: Sequence[Solution], passed: Passed) -> str:
    """A row a load, in full precision, `nan` for what is not defined; `events` since the row before are kind, load and position each."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*NUMBERS, "events"])
    for solution, since in zip(solutions, passed, strict=True):
        told = "; ".join(f"{e.kind} {float(e.load)!r} {float(e.position)!r}" for e in since)
        writer.writerow([*(repr(value) for value in numbers(solution).values()), told])
    return text.getvalue()
