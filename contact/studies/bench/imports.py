"""Processor time of importing contact and of a first small solve."""

from __future__ import annotations

import os
import subprocess
import sys

from contact.model.units import quantity
from contact.studies.bench.report import Table

BASE = "import numpy, scipy.fft, scipy.linalg, scipy.special"
SOLVED = (
    "import contact; "
    "contact.solve(contact.Scene(contact.{}, 1e9, contact.Periodic(), mean_pressure=1e7))"
)
PROGRAMS = {
    "numpy and scipy's fft, linalg, special": BASE,
    "contact": "import contact",
    "contact, and a wave solved": SOLVED.format("Sinusoid(1e-6, 1e-4)"),
    "contact, and a Fourier series solved": SOLVED.format("Fourier(1e-4, [-1e-6, 2e-7])"),
}
# This program runs another program in a child process and prints the processor time of the child.
_TIMED = (
    "import os, subprocess, sys; subprocess.run([sys.executable, '-c', sys.argv[1]], check=True); "
    "t = os.times(); print(t[2] + t[3])"
)


def seconds(program: str, runs: int = 5) -> float:
    """Least processor time [s] of several runs of a program, each in a new Python interpreter."""
    # The first run writes the compiled files of the modules, and the later runs read these files.
    # Therefore the variable that forbids to write compiled files is removed.
    environment = {
        name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"
    }
    command = [sys.executable, "-c", _TIMED, program]
    return min(
        float(
            subprocess.run(
                command, env=environment, capture_output=True, text=True, check=True
            ).stdout
        )
        for _ in range(runs + 1)
    )


def table() -> Table:
    """The table of the processor times of all `PROGRAMS`."""
    times = {name: seconds(program) for name, program in PROGRAMS.items()}
    base = next(iter(times.values()))
    rows: list[tuple[str, ...]] = [
        (name, quantity(time, "s", 3), f"{time / base:.2f}") for name, time in times.items()
    ]
    return Table(
        "imports",
        "before the first answer",
        ("a fresh interpreter that imports", "time", "over the first"),
        rows,
    )
