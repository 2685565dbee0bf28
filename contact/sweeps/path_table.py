"""A load path as data: a row for each load, and the events since the one before; plain types, JSON and CSV, in SI units."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Protocol

from numpy.typing import NDArray

from contact.errors import SceneError
from contact.extras import version
from contact.solution.answer import Answer
from contact.solution.export import describe, new_file, plain
from contact.sweeps.points import NUMBERS, numbers


class Change(Protocol):
    """An event of a path."""

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


def columns(solutions: Sequence[Answer]) -> dict[str, list[float]]:
    """A list for each of NUMBERS, nan for what the scene does not define."""
    rows = [numbers(solution) for solution in solutions]
    return {name: [row[name] for row in rows] for name in NUMBERS}


def to_dict(solutions: Sequence[Answer], passed: Passed) -> dict[str, Any]:
    """Columns, events, scene and units; None for what is not defined, or infinite."""
    scene = solutions[0].scene
    events = [
        {"kind": e.kind, "load": e.load, "position": e.position, "zones_before": len(e.before), "zones_after": len(e.after), "point": point}
        for point, since in enumerate(passed)
        for e in since
    ]
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


def to_json(solutions: Sequence[Answer], passed: Passed) -> str:
    """The same as one JSON object, one line."""
    return json.dumps(to_dict(solutions, passed), allow_nan=False)


def to_csv(solutions: Sequence[Answer], passed: Passed) -> str:
    """A row a load, in full precision, `nan` for what is not defined; `events` since the row before are kind, load and position each."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*NUMBERS, "events"])
    for solution, since in zip(solutions, passed, strict=True):
        told = "; ".join(f"{e.kind} {float(e.load)!r} {float(e.position)!r}" for e in since)
        writer.writerow([*(repr(value) for value in numbers(solution).values()), told])
    return text.getvalue()


def write(solutions: Sequence[Answer], passed: Passed, path: str | PathLike[str], overwrite: bool = False) -> None:
    """Write CSV or JSON, as the name ends."""
    ending = Path(path).suffix.lower() if isinstance(path, (str, PathLike)) else ""
    if ending not in (".csv", ".json"):
        raise SceneError.of("path", path, "the name of a file that ends in .csv or .json")
    text = to_csv(solutions, passed) if ending == ".csv" else to_json(solutions, passed) + "\n"
    new_file(path, overwrite).write_text(text, encoding="utf-8")
