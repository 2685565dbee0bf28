"""Large rough scenes: processor time, peak memory and stated error of each.

    python -m contact.studies.bench.large_scenes TABLE [--out FILE]

TABLE is one of

- `self-affine`: Hurst exponent 0.8, harmonics 4 to kmax, rms slope 0.1, mean pressure 0.005 E*;
- `measured-trace`: the stylus trace of docs/stylus.md, at fractions of its full-contact load;
- `sampling`: one surface of 198 harmonics at one load, sampled ever more finely;
- `kinds-10000`, `kinds-20000`: a trace of each kind of `contact.studies.trace_kinds` with that many
  points, at uneven positions, under five controls; the table shows the slowest of the five.

Every scene runs in a process of its own, on one thread. `python -m contact.studies.pages DIR` sets
the tables of DIR in docs/many-zones.md.
"""

from __future__ import annotations

import argparse
import json
import resource
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import contact
from contact.errors import unwarned
from contact.studies.bench import clock
from contact.studies.bench.alone import measured, publish
from contact.studies.bench.report import Table
from contact.studies.pages import ROOT
from contact.studies.trace_kinds import KINDS, drawn


@dataclass(frozen=True)
class Large:
    """A scene of a table: label, function that makes the profile, and controlled quantity."""

    label: str
    make: Callable[[], contact.Profile]
    control: str
    value: float
    tol: float = 1e-8

    def scene(self) -> contact.Scene:
        """Return the scene with this profile and controlled quantity, for E* = 1 Pa.

        The control `full` is the load divided by the smallest load of full contact.
        """
        profile, name, value = self.make(), self.control, self.value
        if name == "full":
            name, value = "mean_pressure", value * full_contact_pressure(profile)
        control: dict[str, Any] = {name: value}
        return contact.Scene(profile, 1.0, contact.Periodic(), **control)


def full_contact_pressure(profile: contact.Profile) -> float:
    """Return the smallest mean pressure [Pa] at which a profile is in full contact, E* = 1 Pa."""
    scene = contact.Scene(profile, 1.0, contact.Periodic(), contact_fraction=1.0)
    return float(contact.solve(scene).mean_pressure or 0.0)


def self_affine(kmax: int) -> contact.Fourier:
    """A self-affine profile of period 1 m with harmonics 4 to kmax."""
    return contact.self_affine(
        hurst=0.8, period=1.0, shortest=1 / kmax, longest=1 / 4, rms_slope=0.1, seed=0
    )


def stylus() -> contact.Sampled:
    """The stylus trace as docs/stylus.md prepares it; 5 % of its length is tapered at each end."""
    return contact.Sampled.from_file(
        ROOT / "examples" / "data" / "stylus-profile.csv",
        units="um",
        detrend="quadratic",
        regrid=True,
        taper=0.05,
        period=True,
    )


def sampled_wave(points: int) -> contact.Sampled:
    """Evenly sampled harmonics k = 2 to 199 with amplitudes ~ k^-1.3 and random phases."""
    k = np.arange(2, 200)
    phase = np.random.default_rng(5).uniform(0, 2 * np.pi, len(k))
    series = np.zeros(points // 2 + 1, dtype=complex)
    series[k] = 0.005 * points * k**-1.3 * np.exp(1j * phase)
    height = np.fft.irfft(series, points)
    return contact.Sampled(np.arange(points + 1) / points, np.append(height, height[0]), period=1.0)


def trace_of_kind(kind: str, points: int) -> contact.Sampled:
    """One random trace of a kind of surface, sampled at uneven positions."""
    rng = np.random.default_rng([0, list(KINDS).index(kind), points])
    return drawn(rng, kind, points, "uneven")


def kinds(points: int) -> Iterator[Large]:
    """Scenes of all kinds of measured traces.
    Each trace has four loads and one contact fraction; the tolerance is 1e-6.
    """
    for kind in KINDS:
        make = partial(trace_of_kind, kind, points)
        for load in (0.02, 0.1, 0.3, 0.8):
            yield Large(kind.replace("_", " "), make, "full", load, 1e-6)
        yield Large(kind.replace("_", " "), make, "contact_fraction", 0.3, 1e-6)


def scenes(table: str) -> list[Large]:
    """Return the scenes of the table of this name."""
    if table == "self-affine":
        sizes = [1_000, 3_000, 10_000, 30_000, 100_000, 300_000]
        return [Large(f"{n:,}", partial(self_affine, n), "mean_pressure", 0.005) for n in sizes]
    if table == "measured-trace":
        loads = (0.003, 0.01, 0.02, 0.03, 0.05, 0.1, 0.2, 0.5, 0.9, 0.99)
        return [Large(f"{load:g}", stylus, "full", load) for load in loads]
    if table == "sampling":
        sizes = [2_000, 4_000, 8_000, 16_000, 32_000]
        return [Large(f"{n:,}", partial(sampled_wave, n), "full", 0.12) for n in sizes]
    return list(kinds(int(table.removeprefix("kinds-"))))


LOADED = ("zones", "contact fraction", "solved by", "time [s]", "stated error", "outcome")
# The column headings of each table. The first column has the labels of the scenes.
TABLES = {
    "self-affine": ("kmax", "zones", "time [s]", "peak memory [GB]", "stated error", "outcome"),
    "measured-trace": ("part of the full load", *LOADED),
    "sampling": ("points", *LOADED),
    "kinds-10000": ("kind", "zones", "contact fraction", "time [s]", "stated error", "outcome"),
    "kinds-20000": ("kind", "zones", "contact fraction", "time [s]", "stated error", "outcome"),
}


def measure(large: Large, patience: float = 60.0) -> dict[str, Any]:
    """Solve a scene and return time, number of zones, error and outcome.
    The solver is stopped after `patience` seconds.
    """
    scene = large.scene()
    found: dict[str, Any] = {"outcome": "certified", "zones": 0, "fraction": 0.0, "error": 0.0}
    start = time.process_time()
    try:
        solution = clock.limited(lambda: contact.solve(scene, tol=large.tol), patience)
    except (contact.ContactError, clock.TooLong) as failure:
        found["outcome"] = type(failure).__name__
    else:
        found |= {"zones": len(solution.zones), "fraction": solution.contact_fraction}
        found["error"] = solution.error
        found["by"] = "gaps" if "gaps" in solution.plan["zone ends"].reason else "zones"
        if not solution.certificate.holds:
            found["outcome"] = "not certified"
    found["seconds"] = time.process_time() - start
    found["memory"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    return found


def row(columns: tuple[str, ...], label: str, figures: list[dict[str, Any]]) -> tuple[str, ...]:
    """Return the table row of all scenes that have the same label.

    Time, zones and contact fraction are those of the slowest scene; the stated error and the memory
    are the largest of all these scenes.
    """
    slowest = max(figures, key=lambda one: float(one["seconds"]))
    failed = [one["outcome"] for one in figures if one["outcome"] != "certified"]
    cells = {
        "zones": f"{slowest['zones']:,}",
        "contact fraction": f"{slowest['fraction']:.4f}",
        "solved by": str(slowest.get("by", "")),
        "time [s]": f"{slowest['seconds']:.2f}",
        "peak memory [GB]": f"{max(one['memory'] for one in figures):.2f}",
        "stated error": f"{max(one['error'] for one in figures):.1e}",
        "outcome": "; ".join(failed) or "certified",
    }
    return label, *(cells[name] for name in columns[1:])


def main(table: str, out: Path | None) -> None:
    """Measure every scene of a table and publish the table."""
    figures: dict[str, list[dict[str, Any]]] = {}
    for number, large in enumerate(scenes(table)):
        found = measured("contact.studies.bench.large_scenes", table, "--one", str(number))
        figures.setdefault(large.label, []).append(found)
    rows = [row(TABLES[table], label, found) for label, found in figures.items()]
    remarks = []
    if table == "self-affine":
        last = [found[-1] for found in figures.values()]
        zones, seconds = (np.log([one[key] for one in last]) for key in ("zones", "seconds"))
        growth = float(np.polyfit(zones, seconds, 1)[0])
        remarks = [f"Processor time grows as zones^{growth:.2f} (fitted)."]
    publish(Table(table, table.replace("-", " "), TABLES[table], rows), remarks, out)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("table", choices=list(TABLES))
    parser.add_argument("--one", type=int, help="measure one scene and print its figures")
    parser.add_argument("--out", type=Path)
    given = parser.parse_args(sys.argv[1:])
    if given.one is not None:
        with unwarned():
            print(json.dumps(measure(scenes(given.table)[given.one])))
    else:
        main(given.table, given.out)
