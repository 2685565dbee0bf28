"""Breaks the engine in named ways, one at a time, and shows that the tests notice: python benchmarks/mutations.py [NAME ...].

Each mutation replaces one piece of source in a temporary copy and runs a fast part of the suite there, up to the first failure. A
mutation that no test notices, or whose source is no longer there, is an error (exit status 1).
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from contact.terminal import show_table

ROOT = Path(__file__).parents[1]
# What is run on each broken copy, closed forms first.
SUBSET = (
    "tests/contact/test_solve_exact.py", "tests/contact/test_gapped.py", "tests/sie/test_closed_forms.py",
    "tests/sie/test_kernels.py", "tests/sie/test_solve.py", "tests/sie/test_steps.py", "tests/sie/test_free_boundary.py",
    "tests/sie/test_inverse_multizone.py",
)


@dataclass(frozen=True)
class Mutation:
    """`old` becomes `new` in `file`, where it stands exactly once."""

    name: str
    file: str
    old: str
    new: str


MUTATIONS = (
    Mutation(
        "sign of a zone's own transform", "sie/assemble.py",
        "rows[k - 1, layout.offset[i] + k] -= 1.0", "rows[k - 1, layout.offset[i] + k] += 1.0",
    ),
    Mutation(
        "factor in the load: 3 for pi", "sie/assemble.py",
        "scale = np.pi * self.zones.half[solved]", "scale = 3.0 * self.zones.half[solved]",
    ),
    Mutation(
        "dropped image: the period to the right", "sie/kernels.py",
        "return Kernel((0.0, -length, length), length,", "return Kernel((0.0, -length), length,",
    ),
    Mutation(
        "sign in the far images", "sie/kernels.py",
        "(psi(2 - d) - psi(2 + d)) / length", "(psi(2 + d) - psi(2 - d)) / length",
    ),
    Mutation(
        "wrong index: coefficients of the right side shifted by one", "sie/assemble.py",
        "g[:count] = self.g[i, 1 : count + 1]", "g[:count] = self.g[i, :count]",
    ),
    Mutation(
        "ends moved by 1e-6 of the zone's width", "contact/solver.py",
        "return self._in_cell(np.asarray(self.problem.units.x(zones.table)))",
        "return self._in_cell(np.asarray(self.problem.units.x(zones.table + 2e-6 * zones.half[:, None])))",
    ),
    Mutation(
        "datum twice as long", "sie/kernels.py",
        "return Kernel(datum=float(datum))", "return Kernel(datum=2 * float(datum))",
    ),
    Mutation(
        "height of kinks one part in 1e6 too large", "contact/problem.py",
        "units.length**orders / units.slope", "units.length**orders / units.slope * (1 + 1e-6)",
    ),
    Mutation(
        "swapped side condition: zones share the load, not the approach", "sie/conditions.py",
        "matrix, constants = system.level_steps()",
        "matrix, constants = (np.diff(part, axis=0) for part in system.totals())",
    ),
    Mutation(
        "Newton step of twice the length: 4 K / A", "sie/free_boundary.py",
        "delta = np.where(moves, 2 * residual / safe, 0.0)", "delta = np.where(moves, 4 * residual / safe, 0.0)",
    ),
    Mutation(
        "stated error of nothing", "contact/solver.py",
        "return self._within_tolerance(solution, found.free, \"zone\")",
        "return self._within_tolerance(replace(solution, error=0.0), found.free, \"zone\")",
    ),
    Mutation(
        "potential between zones without its logarithm", "sie/assemble.py",
        "block[0] += power * zero", "block[0] += 0.0 * power * zero",
    ),
)


def broken_copy(mutation: Mutation, folder: Path) -> None:
    """The packages, the tests and the configuration in `folder`, with the mutation made."""
    for name in ("sie", "contact", "tests"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", folder)
    path = folder / mutation.file
    source = path.read_text(encoding="utf-8")
    count = source.count(mutation.old)
    if count != 1:
        raise LookupError(f"{mutation.name}: its source stands {count} times in {mutation.file}")
    path.write_text(source.replace(mutation.old, mutation.new), encoding="utf-8")


def first_failure(folder: Path, patience: float) -> tuple[str | None, float]:
    """The first test of the subset that fails in `folder`, None if none does, and the seconds it took to know."""
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    command = [sys.executable, "-m", "pytest", "-x", "-q", "--no-header", "--tb=no", "-p", "no:cacheprovider", *SUBSET]
    start = time.perf_counter()
    try:
        run = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=patience)
    except subprocess.TimeoutExpired:
        # A search that no longer ends is noticed too, by whoever waits for the suite.
        return "the suite does not end", time.perf_counter() - start
    took = time.perf_counter() - start
    if run.returncode == 0:
        return None, took
    found = re.search(r"^(?:FAILED|ERROR) (?:tests/)?(\S+)", run.stdout, re.MULTILINE)
    if found is None:
        raise RuntimeError(run.stdout + run.stderr)
    return found.group(1), took


def noticed(mutation: Mutation | None, patience: float = 600.0) -> tuple[str | None, float]:
    """What notices the mutation; None: the sound engine, which nothing may notice."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "copy"
        folder.mkdir()
        broken_copy(mutation or Mutation("none", "sie/kernels.py", "def hilbert(", "def hilbert("), folder)
        return first_failure(folder, patience)


def main(names: list[str]) -> int:
    chosen = [m for m in MUTATIONS if not names or any(name in m.name for name in names)]
    rows, missed = [], 0
    wrong, seconds = noticed(None)
    rows.append(("none: the engine as it is", "-", wrong or "all pass", f"{seconds:.1f} s"))
    missed += wrong is not None
    for mutation in chosen:
        test, seconds = noticed(mutation)
        rows.append((mutation.name, mutation.file, test or "NOT NOTICED", f"{seconds:.1f} s"))
        missed += test is None
    show_table("mutations", ("what is broken", "file", "first test that fails", "after"), rows)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
