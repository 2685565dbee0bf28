"""Measured traces of every kind under every control: the time, the outcome and the stated error of
each, one line of CSV as it ends.

python -m contact.studies.trace_survey OUT.csv [--points 2000] [--seed 0] [--tol 1e-8] [--limit 60]
[--kinds A,B] [--positions A,B]
    [--controls A,B]

Positions and kinds are those of contact/studies/trace_kinds.py. A control is the name of one and
its value: fraction_0.3 of the period in contact, load_0.3 of the smallest load of full contact,
approach_0.3 of the approach of full contact. Warnings of numpy or Python count as faults. A table
of the slowest of each kind at the end. Seconds are of processor time.
"""

from __future__ import annotations

import argparse
import csv
import sys
import time
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

import contact
from contact.solution.terminal import show_table
from contact.studies.random_scenes import OutOfTime, limited
from contact.studies.trace_kinds import KINDS, POSITIONS, drawn

CONTROLS = (
    "fraction_0.02",
    "fraction_0.3",
    "fraction_0.8",
    "fraction_0.98",
    "load_0.02",
    "load_0.3",
    "load_0.7",
    "load_0.98",
    "approach_0.3",
)
COLUMNS = ("seed", "kind", "positions", "control", "seconds", "outcome", "zones", "error", "detail")


def scene_of(profile: contact.Sampled, control: str) -> contact.Scene:
    """A periodic scene with E* = 1 Pa under a named control."""
    name, value = control.split("_")
    if name == "load":
        full = contact.solve(contact.Scene(profile, 1.0, contact.Periodic(), contact_fraction=1.0))
        given: dict[str, Any] = {"mean_pressure": float(value) * (full.mean_pressure or 0.0)}
    elif name == "approach":
        given = {"approach": float(value) * float(profile.heights.max() - profile.heights.mean())}
    else:
        given = {"contact_fraction": float(value)}
    return contact.Scene(profile, 1.0, contact.Periodic(), **given)


def judged(scene: contact.Scene, tol: float, limit: float) -> dict[str, Any]:
    """What became of a scene."""
    row: dict[str, Any] = dict(zones="", error="", detail="")
    began = time.process_time()
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        warnings.simplefilter("ignore", contact.ModelWarning)
        try:
            with limited(limit):
                solution = contact.solve(scene, tol=tol)
            row |= dict(outcome="solved", zones=len(solution.zones), error=f"{solution.error:.1e}")
            if not solution.certificate.holds or solution.error > tol:
                row |= dict(outcome="FAULT", detail=solution.certificate.note)
        except OutOfTime:
            row["outcome"] = "stopped"
        except contact.ContactError as error:
            row |= dict(outcome=type(error).__name__, detail=str(error)[:150])
        except Exception as error:  # noqa: BLE001  (whatever it is, it is a fault to be listed)
            row |= dict(outcome="FAULT", detail=repr(error)[:150])
    if told:
        first = told[0]
        where = f"{Path(first.filename).name}:{first.lineno}"
        row |= dict(
            outcome=f"WARNING, {row['outcome']}", detail=f"{first.message} {where} {row['detail']}"
        )
    return row | dict(seconds=round(time.process_time() - began, 2))


def survey(options: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """One row a trace and control."""
    for control in options.controls.split(","):
        for kind in options.kinds.split(","):
            for positions in options.positions.split(","):
                profile = drawn(
                    np.random.default_rng(options.seed), kind, options.points, positions
                )
                about = dict(seed=options.seed, kind=kind, positions=positions, control=control)
                try:
                    scene = scene_of(profile, control)
                except contact.ContactError as error:
                    yield (
                        dict.fromkeys(COLUMNS, "")
                        | about
                        | dict(seconds=0.0, outcome=type(error).__name__, detail=str(error)[:150])
                    )
                else:
                    yield about | judged(scene, options.tol, options.limit)


def worst(rows: list[dict[str, Any]]) -> list[tuple[str, ...]]:
    """Of each kind the slowest, and how many were not solved."""
    out: list[tuple[str, ...]] = []
    for kind in dict.fromkeys(row["kind"] for row in rows):
        of_kind = [row for row in rows if row["kind"] == kind]
        slowest = max(of_kind, key=lambda row: float(row["seconds"]))
        failed = sum(row["outcome"] != "solved" for row in of_kind)
        out.append(
            (
                kind,
                str(len(of_kind)),
                str(slowest["seconds"]),
                f"{slowest['positions']}, {slowest['control']}",
                str(failed),
            )
        )
    return out


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--points", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--tol", type=float, default=1e-8)
    parser.add_argument("--limit", type=float, default=60.0)
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--positions", default=",".join(POSITIONS))
    parser.add_argument("--controls", default=",".join(CONTROLS))
    options = parser.parse_args(arguments)
    rows = []
    with options.out.open("w", newline="") as stream:
        writer = csv.DictWriter(stream, COLUMNS)
        writer.writeheader()
        for row in survey(options):
            rows.append(row)
            writer.writerow(row)
            stream.flush()
    show_table(
        "slowest of each kind",
        ("kind", "scenes", "longest [s]", "where", "not solved"),
        worst(rows),
        numeric=(1, 2, 4),
    )
    return 3 if any(row["outcome"] != "solved" for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
