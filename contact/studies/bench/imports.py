"""What a program pays before its first answer: importing contact and a small solve, beside numpy
and the parts of scipy that it uses.
"""

from __future__ import annotations

import os
import subprocess
import sys

from contact.model.units import quantity
from contact.studies.bench.report import Table

BASE = "import numpy, scipy.fft, scipy.linalg, scipy.special"
_SCENE = "contact.Scene(contact.{}, 1e9, contact.Periodic(), mean_pressure=1e7)"
PROGRAMS = {
    "numpy and scipy's fft, linalg, special": BASE,
    "contact": "import contact",
    "contact, and a wave solved": f"import contact; contact.solve({_SCENE.format('Sinusoid(1e-6, 1e-4)')})",
    "contact, and a Fourier series solved": f"import contact; contact.solve({_SCENE.format('Fourier(1e-4, [-1e-6, 2e-7])')})",
}
_RUNS = 5
# A process of its own runs the program and says what processor time that took.
_TIMED = "import os, subprocess, sys; subprocess.run([sys.executable, '-c', sys.argv[1]], check=True); t = os.times(); print(t[2] + t[3])"


def seconds(program: str, runs: int = _RUNS) -> float:
    """Least processor time [s] of a fresh interpreter that runs the program, the interpreter's own
    included.
    """
    # Compiled once, by the first run.
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
