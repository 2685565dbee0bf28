"""The stylus trace from a light load to nearly full contact: python -m
contact.studies.measured_trace [--out FILE].

Then one surface sampled ever more finely, at one load: what the knots in contact cost. FILE, for
instance OUT/measured-trace.md, takes both tables as Markdown, and `python -m contact.studies.pages
OUT` sets them in docs/many-zones.md. One thread: set OMP_NUM_THREADS=1.

python -m contact.studies.measured_trace --kinds POINTS [--out FILE]: instead, traces of every kind
of trace_kinds.py, so many points at uneven positions, at parts of the full load; of each kind the
slowest.
"""

from __future__ import annotations

import resource
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

import contact
from contact.solution.terminal import show_table
from contact.studies.bench.report import Table, markdown
from contact.studies.random_scenes import OutOfTime, limited
from contact.studies.trace_kinds import KINDS, drawn

STYLUS = Path(__file__).parents[2] / "examples" / "data" / "stylus-profile.csv"
PARTS = (0.003, 0.01, 0.02, 0.03, 0.05, 0.1, 0.2, 0.5, 0.9, 0.99)
POINTS = (2_000, 4_000, 8_000, 16_000, 32_000)
HARMONICS = 200
PART = 0.12
# Processor time after which a trace of a kind is given up [s].
_LIMIT = 60.0


def stylus() -> contact.Sampled:
    """As docs/stylus.md prepares it, but for longer tapers: over a twentieth of the length each."""
    return contact.Sampled.from_file(
        STYLUS, units="um", detrend="quadratic", regrid=True, taper=0.05, period=True
    )


def wave(points: int, seed: int = 5) -> contact.Sampled:
    """Harmonics 2 ... 199 with amplitudes k^-1.3 and random phases, at so many points of a period."""
    k = np.arange(2, HARMONICS)
    series = np.zeros(points // 2 + 1, dtype=complex)
    series[k] = (
        0.005
        * points
        * k**-1.3
        * np.exp(1j * np.random.default_rng(seed).uniform(0, 2 * np.pi, len(k)))
    )
    height = np.fft.irfft(series, points)
    return contact.Sampled(np.arange(points + 1) / points, np.append(height, height[0]), period=1.0)


def solved(profile: contact.Sampled, full: float, part: float) -> tuple[contact.Solution, float]:
    """(contact at a part of the smallest load of full contact, processor time [s])."""
    scene = contact.Scene(profile, 1.0, contact.Periodic(), mean_pressure=part * full)
    start = time.process_time()
    return contact.solve(scene, tol=1e-8), time.process_time() - start


def told(solution: contact.Solution, seconds: float) -> tuple[str, ...]:
    widths = np.diff(solution.zones, axis=1) / (solution.scene.profile.resolution or 1.0)
    by = "gaps" if "gaps" in solution.plan["zone ends"].reason else "zones"
    return (
        f"{len(solution.zones):,}",
        f"{solution.contact_fraction:.4f}",
        f"{_steps(widths.min())}, {_steps(widths.max())}",
        f"{widths.sum():,.0f}",
        by,
        f"{seconds:.1f} s",
        f"{solution.error:.1e}",
        "holds" if solution.certificate.holds else "fails",
    )


def _steps(width: float) -> str:
    return f"{width:.2g}" if width < 10 else f"{width:,.0f}"


COLUMNS = (
    "zones",
    "contact fraction",
    "narrowest, widest [steps]",
    "knots in contact",
    "solved by",
    "time",
    "stated error",
    "certificate",
)


def smallest_full(profile: contact.Sampled) -> float:
    """The smallest mean pressure of full contact, E* = 1."""
    return float(
        contact.solve(
            contact.Scene(profile, 1.0, contact.Periodic(), contact_fraction=1.0)
        ).mean_pressure
        or 0.0
    )


def tables() -> tuple[Table, Table, str]:
    """(the stylus trace, the sampled wave, how the latter's time grows)."""
    profile = stylus()
    full = smallest_full(profile)
    trace = [(f"{part:g}", *told(*solved(profile, full, part))) for part in PARTS]
    full = smallest_full(wave(POINTS[0]))
    runs = [solved(wave(points), full, PART) for points in POINTS]
    knots = [
        float(np.diff(one.zones, axis=1).sum() / one.scene.profile.resolution) for one, _ in runs
    ]
    growth = np.polyfit(np.log(knots), np.log([seconds for _, seconds in runs]), 1)[0]
    sampled = [(f"{points:,}", *told(*run)) for points, run in zip(POINTS, runs, strict=True)]
    return (
        Table("stylus", "stylus trace", ("part of the full load", *COLUMNS), trace),
        Table("sampled", "one surface, sampled ever more finely", ("points", *COLUMNS), sampled),
        f"Time grows as (knots in contact)^{growth:.2f} (fitted).",
    )


KIND_CONTROLS = ("load_0.02", "load_0.1", "load_0.3", "load_0.8", "fraction_0.3")
KIND_COLUMNS = (
    "kind",
    "longest time",
    "under",
    "zones",
    "contact fraction",
    "mean time",
    "largest stated error",
    "peak memory so far [GB]",
    "outcome",
)


def of_kinds(
    points: int, positions: str = "uneven", seed: int = 0, out: Path | None = None
) -> Table:
    """One trace of every kind, to 1e-6: the slowest of its controls, and the largest error of all.
    out: takes the rows as they come.
    """
    rows: list[tuple[str, ...]] = []
    table = Table(
        "kinds", f"traces of {len(KINDS)} kinds, {points:,} points each", KIND_COLUMNS, rows
    )
    for number, kind in enumerate(KINDS):
        profile = drawn(np.random.default_rng([seed, number, points]), kind, points, positions)
        full = smallest_full(profile)
        slowest, times, largest, failed = ("", "", ""), [], 0.0, []
        for control in KIND_CONTROLS:
            name, value = control.split("_")
            given: dict[str, Any] = (
                {"mean_pressure": float(value) * full}
                if name == "load"
                else {"contact_fraction": float(value)}
            )
            start = time.process_time()
            try:
                with limited(_LIMIT):
                    scene = contact.Scene(profile, 1.0, contact.Periodic(), **given)  # type: ignore[arg-type]
                    solution = contact.solve(scene, tol=1e-6)
            except (contact.ContactError, OutOfTime) as failure:
                failed.append(f"{control.replace('_', ' ')}: {type(failure).__name__}")
                seen = (control.replace("_", " "), "", "")
            else:
                seen = (
                    control.replace("_", " "),
                    f"{len(solution.zones):,}",
                    f"{solution.contact_fraction:.4f}",
                )
                largest = max(largest, solution.error)
            times.append(time.process_time() - start)
            if times[-1] == max(times):
                slowest = seen
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
        ending = "; ".join(failed) or "solved"
        rows.append(
            (
                kind.replace("_", " "),
                f"{max(times):.1f} s",
                *slowest,
                f"{sum(times) / len(times):.1f} s",
                f"{largest:.1e}",
                f"{memory:.2f}",
                ending,
            )
        )
        if out is not None:
            out.write_text(markdown(table), encoding="utf-8")
    return table


if __name__ == "__main__":
    given = sys.argv[1:]
    if given[:1] == ["--kinds"]:
        kinds = of_kinds(int(given[1]), out=Path(given[3]) if given[2:3] == ["--out"] else None)
        show_table(kinds.title, kinds.columns, kinds.rows, numeric=(1, 3, 4, 5, 6, 7))
        sys.exit()
    trace_table, sampled_table, growth_told = tables()
    for table in (trace_table, sampled_table):
        show_table(table.title, table.columns, table.rows, numeric=range(1, 8))
    print(growth_told)
    if given[:1] == ["--out"]:
        text = f"{markdown(trace_table)}\n{markdown(sampled_table)}\n{growth_told}\n"
        Path(given[1]).write_text(text, encoding="utf-8")
