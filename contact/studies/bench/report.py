"""Tables of the measurements, as CSV files and as Markdown."""

from __future__ import annotations

import csv
import dataclasses
import math
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


@dataclasses.dataclass(frozen=True)
class SingleZoneLimits:
    """Upper bounds of the processor time of a single scene, as docs/benchmarks.md requires."""

    seconds_per_zone: float = 5e-4
    dense_solves: float = 0.12  # times 100 dense solves (`scaling.yardstick`), per zone
    floors: float = 25.0  # times the floor of `scaling.floor_seconds`


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
    """Return a line of text: time for one size of a series, also in units of its floor."""
    floors = f"{row.seconds / row.floor:.3g} times the floor"
    return f"{row.series}, {row.size}: {_time(row.seconds)}, {floors}"


def of(rows: Iterable[Row], scene: str, method: str) -> list[Row]:
    """Return the rows of one method for one scene."""
    return [row for row in rows if row.scene == scene and row.method == method]


def names(rows: Iterable[Row]) -> list[str]:
    """Return the names of the scenes, in the order of the rows."""
    return list(dict.fromkeys(row.scene for row in rows))


def precision_table(rows: list[Row]) -> Table:
    """Table of the solver's time, true error and stated error at every second tolerance."""
    out: list[tuple[str, ...]] = []
    for scene in names(rows):
        for row in of(rows, scene, OURS):
            if row.met and round(-math.log10(row.setting)) % 2:
                continue
            out.append(
                (
                    scene,
                    f"{row.setting:.0e}",
                    _time(row.seconds),
                    _number(row.error),
                    _number(row.stated),
                    _number(row.at_x),
                    "" if row.met else "not met: best state",
                )
            )
    return Table(
        "precision",
        "work and precision",
        ("scene", "tol", "time", "true error", "stated", "at equal x, max", ""),
        out,
    )


def hierarchy_table(rows: list[Row]) -> Table:
    """Table of the times and errors of the localized models."""
    chosen = [row for row in rows if row.method.startswith("localized")]
    out: list[tuple[str, ...]] = [
        (row.scene, row.method, _time(row.seconds), _number(row.error), _number(row.stated))
        for row in chosen
    ]
    columns = ("scene", "model", "time", "true error", "stated, of its own")
    return Table("hierarchy", "localized models against the exact one", columns, out)


def peers_table(
    rows: list[Row],
    peers: Sequence[str],
    scenes: Sequence[str],
    targets: Sequence[float] = (1e-2, 1e-3, 1e-4),
) -> Table:
    """Table of the times of all codes to reach an error of p(x), and of ratios of these times.

    The ratio is the time of the faster peer divided by ours. An error counts as reached if all
    finer runs have at most this error as well.
    """
    out: list[tuple[str, ...]] = []
    for measure, label in (("at_x", "max"), ("mean_at_x", "mean")):
        for scene in scenes:
            for target in targets:
                ours = time_to(of(rows, scene, OURS), target, measure)
                theirs = [time_to(of(rows, scene, peer), target, measure) for peer in peers]
                known = [t for t in theirs if t is not None]
                ratio = (
                    f"{min(known) / ours:.3g}"
                    if known and ours
                    else "no peer reaches it"
                    if ours
                    else "-"
                )
                cells = [
                    _reach(of(rows, scene, p), t, measure)
                    for p, t in zip(peers, theirs, strict=True)
                ]
                out.append(
                    (
                        scene,
                        f"{label} {target:.0e}",
                        "-" if ours is None else _time(ours),
                        *cells,
                        ratio,
                    )
                )
    return Table(
        "peers",
        "peers at equal error of p(x)",
        ("scene", "error", OURS, *peers, "faster peer / contact"),
        out,
    )


def _reach(rows: list[Row], seconds: float | None, measure: str) -> str:
    if seconds is not None:
        return _time(seconds)
    if not rows:
        return "did not converge"
    best = min(rows, key=lambda row: getattr(row, measure))
    return f"not by {_time(max(row.seconds for row in rows))} (best {getattr(best, measure):.1e})"


def scaling_table(rows: list[Scaled]) -> Table:
    """Table of time and memory for every size of every series."""
    out: list[tuple[str, ...]] = [
        (
            row.series,
            str(row.size),
            str(row.zones),
            str(row.nodes),
            str(row.unknowns),
            _time(row.seconds),
            f"{row.peak_bytes / 1e6:.3g} MB",
            _time(row.floor),
            f"{row.seconds / row.floor:.3g}",
        )
        for row in rows
    ]
    columns = (
        "series",
        "size",
        "zones",
        "nodes",
        "unknowns",
        "time",
        "peak memory",
        "floor",
        "time / floor",
    )
    return Table("scaling", "cost against size, and against the floor", columns, out)


def exponents_table(rows: list[Scaled]) -> Table:
    """Table of the fitted exponents of time and memory for every series."""
    out: list[tuple[str, ...]] = []
    for series in dict.fromkeys(row.series for row in rows):
        some = fitted([row for row in rows if row.series == series])
        if len(some) < 3:
            continue
        sizes, nodes = (
            np.array([float(getattr(row, name)) for row in some]) for name in ("size", "nodes")
        )
        time, memory = (
            np.array([float(getattr(row, name)) for row in some])
            for name in ("seconds", "peak_bytes")
        )
        out.append(
            (
                series,
                f"{some[0].size} to {some[-1].size}" + (", fast sums" if some[-1].fast else ""),
                f"{exponent(sizes, time):.2f}",
                f"{exponent(nodes, time):.2f}",
                f"{exponent(sizes, memory):.2f}",
            )
        )
    columns = ("series", "sizes fitted", "time by size", "time by nodes", "memory by size")
    return Table("exponents", "fitted exponents", columns, out)


def single_table(rows: list[Scaled], solves: float) -> Table:
    """Table of the times of single scenes, and of the limits for these times."""
    limits = SingleZoneLimits()
    out: list[tuple[str, ...]] = [
        (
            row.series,
            _time(row.seconds),
            _time(row.zones * limits.seconds_per_zone),
            f"{row.seconds / row.floor:.3g}",
            f"{limits.floors:g}",
            f"{row.seconds / solves:.3f}",
            f"{row.zones * limits.dense_solves:g}",
            "yes" if within(row, solves) else "no",
        )
        for row in rows
    ]
    columns = (
        "scene",
        "time",
        "at most",
        "over the floor",
        "at most",
        "over 100 dense solves",
        "at most",
        "within",
    )
    return Table("single", "single scenes to 1e-12", columns, out)


def within(row: Scaled, solves: float) -> bool:
    """Whether the time of a single scene is within all limits of `SingleZoneLimits`."""
    limits = SingleZoneLimits()
    by_zones = row.zones * min(limits.seconds_per_zone, limits.dense_solves * solves)
    return row.seconds <= min(by_zones, limits.floors * row.floor)


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
    return Table("stability", "stiff and extreme scenes", columns, out)


def _time(seconds: float) -> str:
    return quantity(seconds, "s", 3)


def _number(value: float | None) -> str:
    if value is None:
        return "-"
    return f"{value:.1e}" if math.isfinite(value) else "none"
