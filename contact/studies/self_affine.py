"""Self-affine roughness from a hundred zones to twenty thousand: python -m
contact.studies.self_affine [--out FILE] [KMAX ...].

Hurst exponent 0.8, harmonics 4 ... kmax with random phases, rms slope 0.1, mean pressure 0.05 E*
slope, tolerance 1e-8. Each size in a process of its own, on one thread, for its time and peak
memory. Prints a table, the exponent fitted to processor time over the number of zones, and how far
a hundred zones are from a solution by a matrix to a tighter tolerance; FILE, for instance
OUT/self-affine.md, takes it as Markdown, and `python -m contact.studies.pages OUT` sets it in
docs/many-zones.md.
"""

from __future__ import annotations

import json
import resource
import sys
import time
from pathlib import Path

import numpy as np

import contact
from contact.studies.alone import measured, tell
from contact.studies.bench.report import Table
from sie.collocation import fixed as engine

SIZES = (1_000, 3_000, 10_000, 30_000, 100_000, 300_000)
SLOPE = 0.1
PRESSURE = 0.05
HURST = 0.8
FIRST = 4
NAMES = (
    "kmax",
    "zones",
    "tol",
    "wanted",
    "processor time [s]",
    "of the wall clock: search, ends, certificate [s]",
    "peak memory [GB]",
    "Newton steps, rounds",
    "stated error",
    "certificate",
)
# Times asked for: 100, 1,000 and 10,000 zones [s].
WANTED = {1_000: 2, 10_000: 20, 100_000: 300}
PARTS = ("coarse search", "zone ends", "certificate")


def profile(kmax: int, seed: int = 0) -> contact.Fourier:
    """The period is 1 m."""
    return contact.self_affine(
        hurst=HURST, period=1.0, shortest=1 / kmax, longest=1 / FIRST, rms_slope=SLOPE, seed=seed
    )


def scene(kmax: int) -> contact.Scene:
    return contact.Scene(profile(kmax), 1.0, contact.Periodic(), mean_pressure=PRESSURE * SLOPE)


def measure(kmax: int) -> dict[str, float | bool | str]:
    """One solution: zones, processor time [s], peak memory [GB], steps, stated error, whether the
    certificate holds.
    """
    given, tol = scene(kmax), 1e-8
    start = time.process_time()
    solution = contact.solve(given, tol=tol)
    return {
        "kmax": kmax,
        "tol": tol,
        "zones": len(solution.zones),
        "seconds": time.process_time() - start,
        "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20,
        "error": solution.error,
        "steps": solution.plan["zone ends"]
        .detail.replace(" Newton steps", "")
        .replace(" rounds", ""),
        "holds": solution.certificate.holds,
        "parts": ", ".join(f"{solution.plan[name].seconds:.2f}" for name in PARTS),
    }


def against_a_matrix(kmax: int, tol: float = 1e-10) -> dict[str, float]:
    """Largest differences from the same scene by a matrix to a tighter tolerance: ends over their
    zone's width, and pressures at equal normalised position over the peak; with the two errors
    stated.
    """
    fast = contact.solve(scene(kmax), tol=1e-8)
    engine.MANY_UNKNOWNS = 10**9
    direct = contact.solve(scene(kmax), tol=tol)
    t = np.cos(np.pi * (np.arange(12) + 0.5) / 12)
    ends = np.abs((fast.zones - direct.zones) / np.diff(direct.zones, axis=1)).max()
    pressures = max(
        np.abs(fast.pressure_at(t, i) - direct.pressure_at(t, i)).max()
        for i in range(len(direct.zones))
    )
    return {
        "ends": float(ends),
        "pressure": float(pressures) / direct.max_pressure,
        "stated": fast.error + direct.error,
    }


def main(sizes: tuple[int, ...], out: Path | None) -> None:
    found = [measured(__file__, "--one", str(kmax)) for kmax in sizes]
    rows = [
        (
            f"{r['kmax']:,}",
            f"{r['zones']:,}",
            f"{r['tol']:.0e}",
            f"{WANTED[int(r['kmax'])]} s" if r["kmax"] in WANTED else "",
            f"{r['seconds']:.2f}",
            str(r["parts"]),
            f"{r['memory']:.2f}",
            str(r["steps"]),
            f"{r['error']:.1e}",
            "holds" if r["holds"] else "fails",
        )
        for r in found
    ]
    remarks = []
    if len(found) > 1:
        growth = np.polyfit(
            np.log([r["zones"] for r in found]), np.log([r["seconds"] for r in found]), 1
        )[0]
        remarks.append(f"Processor time grows as zones^{growth:.2f} (fitted).")
    check = measured(__file__, "--check", str(SIZES[0]))
    remarks.append(
        f"kmax = {SIZES[0]:,} by a matrix to 1e-10: ends differ by {check['ends']:.1e} of their zone's width, pressures by "
        f"{check['pressure']:.1e} of the peak; stated together {check['stated']:.1e}."
    )
    tell(Table("self-affine", "self-affine roughness", NAMES, rows), remarks, out)


if __name__ == "__main__":
    given = sys.argv[1:]
    if given[:1] == ["--one"]:
        print(json.dumps(measure(int(given[1]))))
    elif given[:1] == ["--check"]:
        print(json.dumps(against_a_matrix(int(given[1]))))
    else:
        file = Path(given[1]) if given[:1] == ["--out"] else None
        main(tuple(map(int, given[2 if file else 0 :])) or SIZES, file)
