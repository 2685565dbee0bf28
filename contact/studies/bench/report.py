"""Tables of the measurements, as CSV files and as Markdown."""

from __future__ import annotations

import csv
import dataclasses
import math
from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from contact.model.units import quantity
from contact.studies.bench.peers import time_to
from contact.studies.bench.precision import Row
from contact.studies.bench.scaling import Scaled, exponent, fitted
from contact.studies.bench.stability import Verdict


class Table(NamedTuple):
    """A table of text cells; `key` names the table's file and its place in a page of docs."""

    key: str
    title: str
    columns: Sequence[str]
    rows: Sequence[tuple[str, ...]]


OURS = "contact"


def write_csv(path: Path, rows: Sequence[Any]) -> None:
    """Write instances of one dataclass as CSV, in full precision, one row for each instance."""
    names = [field.name for field in dataclasses.fields(rows[0])]
    with path.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(names)
        writer.writerows([getattr(row, name) for name in names] for row in rows)


def markdown(table: Table) -> str:
    """Return the table in Markdown."""
    lines = [table.columns, ["---"] * len(table.columns), *table.rows]
    return (
        "\n".join(
            "| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines
        )
        + "\n"
    )


def line_of_scene(rows: list[Row], scene: str) -> str:
    """Return a line of text: time and errors at the smallest tolerance that a scene reached."""
    best = min(of(rows, scene, OURS), key=lambda row: (not row.met, row.setting))
    errors = f"true error {_number(best.error)}, stated {_number(best.stated)}"
    return f"{scene}: {_time(best.seconds)} to tol {best.setting:.0e}, {errors}"


def line_of_size(row: Scaled) -> str:
    """Return a line of text with the time for one size of a series.
    The time is also given in units of the floor, the time of the least work that any solver by
    direct sums must do.
    """
    floors = f"{row.seconds / row.floor:.3g} times the floor"
    return f"{row.series}, {row.size}: {_time(row.seconds)}, {floors}"


def of(rows: Iterable[Row], scene: str, method: str) -> list[Row]:
    """Return those rows that belong to one scene and one method."""
    return [row for row in rows if row.scene == scene and row.method == method]


def names(rows: Iterable[Row]) -> list[str]:
    """Return the names of the scenes, in the order of the rows."""
    return list(dict.fromkeys(row.scene for row in rows))


def precision_table(rows: list[Row], tols: Sequence[float] = (1e-4, 1e-12)) -> Table:
    """Table of the solver's time, true error and stated error, one row for each scene."""
    out: list[tuple[str, ...]] = []
    for scene in names(rows):
        cells: list[str] = [scene]
        for tol in tols:
            row = next(
                (r for r in of(rows, scene, OURS) if math.isclose(r.setting, tol, rel_tol=1e-6)),
                None,
            )
            if row is None:
                cells += ["-", "-", "-"]
            else:
                late = "" if row.met else ", not met"
                cells += [_time(row.seconds) + late, _number(row.error), _number(row.stated)]
        out.append(tuple(cells))
    columns = [
        column for tol in tols for column in (f"time, tol {tol:.0e}", "true error", "stated")
    ]
    return Table("precision", "work and precision", ("scene", *columns), out)


def stated_table(rows: list[Row]) -> Table:
    """Table that shows how often the stated error bounds the true error, and how often sharply.
    A stated error is sharp if it is at most 100 max(true error, 1e-13).
    """
    mine = [
        (row.error, row.stated)
        for row in rows
        if row.method == OURS and row.error is not None and row.stated is not None
    ]
    bounds = sum(error <= stated for error, stated in mine)
    sharp = sum(stated <= 100 * max(error, 1e-13) for error, stated in mine)
    out: list[tuple[str, ...]] = [
        (what, f"{count} of {len(mine)}")
        for what, count in (
            ("true error at most the stated error", bounds),
            ("stated error at most 100 times the true error, or 1e-11", sharp),
        )
    ]
    return Table("stated", "stated errors", ("all scenes and tolerances", "runs"), out)


def hierarchy_table(rows: list[Row]) -> Table:
    """Table of the true errors of the localized models, one row for each scene."""
    chosen = [row for row in rows if row.method.startswith("localized")]
    methods = list(dict.fromkeys(row.method for row in chosen))
    out: list[tuple[str, ...]] = []
    for scene in names(chosen):
        errors = {row.method: row.error for row in chosen if row.scene == scene}
        out.append((scene, *(_number(errors.get(method)) for method in methods)))
    columns = ("scene", *(method.removeprefix("localized, ") for method in methods))
    return Table("hierarchy", "true errors of the localized models", columns, out)


def peers_tables(
    rows: list[Row], peers: Sequence[str], scenes: Sequence[str]
) -> tuple[Table, Table]:
    """Tables of the times that all codes need to reach given errors of p(x).
    One table is for the largest error, the other for the mean error.

    An error counts as reached if all finer runs have at most this error as well.
    """
    return (
        _peers_table("peers", rows, peers, scenes, "at_x", "max", (1e-2, 1e-3)),
        _peers_table("peers-mean", rows, peers, scenes, "mean_at_x", "mean", (1e-3, 1e-4)),
    )


def _peers_table(
    key: str,
    rows: list[Row],
    peers: Sequence[str],
    scenes: Sequence[str],
    measure: str,
    label: str,
    targets: Sequence[float],
) -> Table:
    codes = (OURS, *peers)
    out: list[tuple[str, ...]] = [
        (
            scene,
            *(
                _reach(of(rows, scene, code), target, measure)
                for target in targets
                for code in codes
            ),
        )
        for scene in scenes
    ]
    heads = [f"{label} {target:.0e}: {code}" for target in targets for code in codes]
    return Table(key, f"time to a {label} error of p(x)", ("scene", *heads), out)


def _reach(rows: list[Row], error: float, measure: str) -> str:
    """Return, as text, the time in which a method reaches an error.
    If the error is not reached, the text is "more than" and the time of the longest run.
    """
    if not rows:
        return "did not converge"
    seconds = time_to(rows, error, measure)
    if seconds is not None:
        return _time(seconds)
    return f"more than {_time(max(row.seconds for row in rows))}"


def scaling_table(rows: list[Scaled]) -> Table:
    """Table of the largest size of every series, and of the exponents of its time and memory."""
    out: list[tuple[str, ...]] = []
    for series in dict.fromkeys(row.series for row in rows):
        some = fitted([row for row in rows if row.series == series])
        if len(some) < 3:
            continue
        nodes, time, memory = (
            np.array([float(getattr(row, name)) for row in some])
            for name in ("nodes", "seconds", "peak_bytes")
        )
        last = some[-1]
        out.append(
            (
                series,
                f"{last.zones:,}",
                f"{last.nodes:,}",
                _time(last.seconds),
                f"{last.peak_bytes / 1e6:.3g} MB",
                f"nodes^{exponent(nodes, time):.2f}",
                f"nodes^{exponent(nodes, memory):.2f}",
            )
        )
    columns = (
        "series",
        "zones",
        "nodes",
        "time",
        "peak memory",
        "time grows as",
        "memory grows as",
    )
    return Table("scaling", "cost of the largest size, and its growth", columns, out)


def stability_table(verdicts: list[Verdict]) -> Table:
    """Table of the allowed, the true and the stated error of every extreme scene."""
    out: list[tuple[str, ...]] = [
        (
            v.group,
            v.name,
            f"{v.condition:.1e} ({v.why})",
            _number(v.allowed),
            _number(v.error),
            _number(v.stated),
            _time(v.seconds),
            v.outcome + (f": {v.note}" if v.note else ""),
        )
        for v in verdicts
    ]
    columns = ("what", "case", "condition", "allowed", "error", "stated", "time", "outcome")
    return Table("stability-scenes", "stiff and extreme scenes", columns, out)


def stability_groups_table(verdicts: list[Verdict]) -> Table:
    """Table of groups of extreme scenes: outcomes, and the worst conditioned scene that passes."""
    out: list[tuple[str, ...]] = []
    for group in dict.fromkeys(v.group for v in verdicts):
        some = [v for v in verdicts if v.group == group]
        counts = Counter(v.outcome for v in some)
        outcomes = ", ".join(f"{count} {outcome}" for outcome, count in counts.items())
        passed = [v for v in some if v.outcome == "pass"]
        if not passed:
            out.append((group, outcomes, *("-" for _ in range(6))))
            continue
        worst = max(passed, key=lambda v: (v.condition, v.error))
        out.append(
            (
                group,
                outcomes,
                worst.name,
                f"{worst.condition:.1e}",
                worst.why,
                _number(worst.allowed),
                _number(worst.error),
                _number(worst.stated),
            )
        )
    columns = (
        "scenes",
        "outcome",
        "worst that passes",
        "condition",
        "its origin",
        "allowed",
        "error",
        "stated",
    )
    return Table("stability", "groups of stiff and extreme scenes", columns, out)


def stability_exceptions_table(verdicts: list[Verdict]) -> Table:
    """Table of the extreme scenes that do not pass, with the reasons."""
    out: list[tuple[str, ...]] = [
        (f"{v.group}: {v.name}", _number(v.allowed), v.outcome, v.note)
        for v in verdicts
        if v.outcome != "pass"
    ]
    columns = ("scene", "allowed", "outcome", "reason")
    return Table("stability-exceptions", "scenes that do not pass", columns, out)


def _time(seconds: float) -> str:
    return quantity(seconds, "s", 3)


def _number(value: float | None) -> str:
    if value is None:
        return "-"
    return f"{value:.1e}" if math.isfinite(value) else "none"
