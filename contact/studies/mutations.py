"""Breaks the package in named ways, one at a time, and shows that the tests notice: python -m contact.studies.mutations [NAME ...].

Each mutation replaces one piece of source in a temporary copy and runs the suite there, up to the first failure: the files that
look at that part first, then a fast selection, then all others. A mutation that no test notices, or whose source is no longer
there, is an error (exit status 1). --out FILE writes the table.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from contact.solution.terminal import show_table
from contact.studies.bench.report import Table, markdown

ROOT = Path(__file__).parents[2]
# What is run on each broken copy after the files that are named with it, closed forms first; and then the rest.
SUBSET = (
    "tests/contact/test_solve_exact.py", "tests/contact/test_gapped.py", "tests/sie/test_closed_forms.py",
    "tests/sie/test_kernels.py", "tests/sie/test_solve.py", "tests/sie/test_forcing_jumps.py", "tests/sie/test_free_boundary.py",
    "tests/sie/test_inverse_multizone.py", "tests/contact/test_solve_multizone.py", "tests/contact/test_plan.py",
)


@dataclass(frozen=True)
class Mutation:
    """`old` becomes `new` in `file`, where it stands exactly once; `first`: the files of tests to begin with."""

    name: str
    file: str
    old: str
    new: str
    first: tuple[str, ...] = ()


MUTATIONS = (
    Mutation(
        "sign of a zone's own transform", "sie/collocation/system.py",
        "rows[np.arange(len(rows)), self.own] -= 1.0", "rows[np.arange(len(rows)), self.own] += 1.0",
    ),
    Mutation(
        "factor in the load: 3 for pi", "sie/collocation/system.py",
        "scale = np.pi * self.zones.half[solved]", "scale = 3.0 * self.zones.half[solved]",
    ),
    Mutation(
        "dropped image: the period to the right", "sie/basis/kernels.py",
        "return Kernel((0.0, -length, length), length,", "return Kernel((0.0, -length), length,",
    ),
    Mutation(
        "sign in the far images", "sie/basis/kernels.py",
        "(psi(2 - d) - psi(2 + d)) / self.period", "(psi(2 + d) - psi(2 - d)) / self.period",
    ),
    Mutation(
        "wrong index: coefficients of the right side shifted by one", "sie/collocation/system.py",
        "self.projected(raw), layout.flat(self.lowest)[self.own]", "self.projected(raw), layout.flat(self.lowest)[self.own - 1]",
    ),
    Mutation(
        "ends moved by 1e-6 of the zone's width", "contact/solution/made.py",
        "table = in_cell(scene, np.asarray(problem.units.x(zones.table)))",
        "table = in_cell(scene, np.asarray(problem.units.x(zones.table + 2e-6 * zones.half[:, None])))",
    ),
    Mutation(
        "datum twice as long", "sie/basis/kernels.py",
        'return Kernel(datum=inputs.positive("datum", datum))', 'return Kernel(datum=2 * inputs.positive("datum", datum))',
    ),
    Mutation(
        "height of kinks one part in 1e6 too large", "contact/formulation/problem.py",
        "units.length**orders / units.slope", "units.length**orders / units.slope * (1 + 1e-6)",
    ),
    Mutation(
        "swapped side condition: zones share the load, not the approach", "sie/equation/conditions.py",
        "matrix, constants = system.level_steps()",
        "matrix, constants = (np.diff(part, axis=0) for part in system.totals())",
    ),
    Mutation(
        "Newton step of twice the length: 4 K / A", "sie/free_ends/newton.py",
        "delta = np.where(moves, 2 * residual / safe, 0.0)", "delta = np.where(moves, 4 * residual / safe, 0.0)",
    ),
    Mutation(
        "stated error of nothing", "contact/solution/made.py",
        "solution = Solution(scene, table, found.fields, error, found.certificate, plan, found.free.trace)",
        "solution = Solution(scene, table, found.fields, 0.0, found.certificate, plan, found.free.trace)",
    ),
    Mutation(
        "potential between zones without its logarithm", "sie/basis/interval.py",
        "yield power * self.first(width) if potential else power", "yield 0.0 * power * self.first(width) if potential else power",
    ),
    Mutation(
        "pressures one part in 1e9 too large", "contact/formulation/units.py",
        "return 0.5 * self.E_star * self.slope", "return 0.5 * self.E_star * self.slope * (1 + 1e-9)",
    ),
    Mutation(
        "certificate that does not look between the zones", "contact/verify/certificate.py",
        "holds = (least > 0 or law.pulls) and len(new) == 0 and len(overlaps) == 0 and", "holds = (least > 0 or law.pulls) and",
        ("tests/contact/test_certificate.py",),
    ),
    Mutation(
        "certificate that takes a pressure that pulls for one that pushes", "contact/verify/certificate.py",
        "pulls, least, dip, (valleys, left_out) = signs.negative, signs.least, signs.dip, _valleys(fields)",
        "pulls, least, dip, (valleys, left_out) = signs.negative, abs(signs.least), signs.dip, _valleys(fields)",
        ("tests/contact/test_certificate.py",),
    ),
    Mutation(
        "localization: a strip half a period too wide", "contact/model/operator.py",
        "half = 0.5 * (2 * interaction.neighbours + 1) * period", "half = 0.5 * (2 * interaction.neighbours + 2) * period",
        ("tests/contact/test_localized.py",),
    ),
    Mutation(
        "localization: a nominal pressure one part in 1e6 too small", "contact/model/interactions/localized.py",
        "sie.Amplitude(0, per_total=1 / period)", "sie.Amplitude(0, per_total=(1 - 1e-6) / period)",
        ("tests/contact/test_localized.py",),
    ),
    Mutation(
        "sign of a jump of the curvature", "sie/jumps/formulas.py",
        "-1.5 * self.s, first) * self.sine", "-1.5 * self.s, -1 * first) * self.sine", ("tests/sie/test_forcing_jumps.py",),
    ),
    Mutation(
        "knots of a spline twice as strong: 2! forgotten", "sie/jumps/forcing.py",
        "factorial = np.array([1.0, 1.0, 2.0])[q]", "factorial = np.array([1.0, 1.0, 1.0])[q]",
        ("tests/sie/test_forcing_jumps.py", "tests/contact/test_sampled.py"),
    ),
    Mutation(
        "nearly full contact: the mean gap of the wrong sign", "contact/formulation/gaps.py",
        "* self.mean) * self.problem.units.height - self.mean_gap",
        "* self.mean) * self.problem.units.height + self.mean_gap", ("tests/contact/test_gapped.py",),
    ),
    Mutation(
        "stiffness without the response of the load", "contact/formulation/fields.py",
        "state, values = self.state, self.state.values()", "state, values = self.state, 2 * self.state.values()",
        ("tests/contact/test_solve_exact.py",),
    ),
    Mutation(
        "many zones: a step between neighbours with one half left out", "sie/collocation/iterative.py",
        "across + half_rise[1:] + half_rise[:-1]", "across + half_rise[1:]", ("tests/contact/test_solve_multizone.py",),
    ),
    Mutation(
        "zones left in another cell than the profile's", "contact/formulation/tables.py",
        "table - np.floor((table[:, :1] - start) / period)", "table - np.round((table[:, :1] - start) / period)",
    ),
    Mutation(
        "events of a load path displaced", "contact/sweeps/paths.py",
        "self.position = float(self.problem.profile.wrap(self.problem.units.x(np.array(place))))",
        "self.position = float(self.problem.profile.wrap(self.problem.units.x(np.array(place + 1e-4))))", ("tests/contact/test_path.py",),
    ),
    Mutation(
        "adhesion: the intensity one part in 1e6 too strong", "contact/model/laws/jkr.py",
        "return -sqrt(E_star * self.work / pi)", "return -sqrt(E_star * self.work / pi) * (1 + 1e-6)", ("tests/contact/test_jkr.py",),
    ),
    Mutation(
        "adhesion of a finite range: what it takes to open the gap left out", "contact/model/laws/dugdale.py",
        "+ self.stress * float(fields.opened)", "+ 0.0 * self.stress * float(fields.opened)",
        ("tests/contact/test_dugdale.py", "tests/contact/test_dugdale_path.py"),
    ),
    Mutation(
        "a loop of adhesion: jumps whose work is that of the load before alone", "contact/sweeps/adhesive.py",
        "0.5 * (load + load_after)) * (approach_after - approach)", "load) * (approach_after - approach)",
        ("tests/contact/test_dugdale_path.py",),
    ),
    Mutation(
        "a module that no wave needs", "contact/search/task.py",
        "import numpy as np\n", "import numpy as np\nimport scipy.interpolate  # noqa: F401\n",
        ("tests/contact/test_plan.py",),
    ),
    Mutation(
        "symmetric zones solved as if they were not", "contact/search/topology/by_pressure.py",
        "return sie.Zones.of(table, left, right, symmetric=symmetric)", "return sie.Zones.of(table, left, right)",
        ("tests/contact/test_plan.py",),
    ),
)


def broken_copy(mutation: Mutation, folder: Path) -> None:
    """The project in `folder`, with the mutation made."""
    shutil.copytree(ROOT, folder, ignore=shutil.ignore_patterns("__pycache__", ".*"))
    path = folder / mutation.file
    source = path.read_text(encoding="utf-8")
    count = source.count(mutation.old)
    if count != 1:
        raise LookupError(f"{mutation.name}: its source stands {count} times in {mutation.file}")
    path.write_text(source.replace(mutation.old, mutation.new), encoding="utf-8")


def first_failure(folder: Path, files: Sequence[str], patience: float) -> tuple[str | None, float]:
    """The first test of the files that fails in `folder`, None if none does, and the seconds it took to know."""
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    # test_bench looks whether the sources of the mutations are there, which here they are not.
    options = ["-x", "-q", "--no-header", "--tb=no", "-p", "no:cacheprovider", "-m", "", "--ignore=tests/contact/test_bench.py"]
    command = [sys.executable, "-m", "pytest", *options, *files]
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


def noticed(mutation: Mutation | None, patience: float = 900.0) -> tuple[str | None, float]:
    """What notices the mutation; None: the sound package, which nothing of the fast selection may notice."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "copy"
        broken_copy(mutation or Mutation("none", "sie/basis/kernels.py", "def hilbert(", "def hilbert("), folder)
        first = mutation.first if mutation else ()
        test, seconds = first_failure(folder, list(dict.fromkeys((*first, *SUBSET))), patience)
        if test is None and mutation is not None:
            test, more = first_failure(folder, ["tests"], patience)
            seconds += more
        return test, seconds


def main(arguments: list[str]) -> int:
    out = Path(arguments.pop(arguments.index("--out") + 1)) if "--out" in arguments else None
    names = [name for name in arguments if name != "--out"]
    chosen = [m for m in MUTATIONS if not names or any(name in m.name for name in names)]
    wrong, seconds = noticed(None)
    rows, missed = [("none: the package as it is", "-", wrong or "all pass", f"{seconds:.0f} s")], int(wrong is not None)
    for mutation in chosen:
        test, seconds = noticed(mutation)
        rows.append((mutation.name, mutation.file, (test or "NOT NOTICED").replace("::", ": "), f"{seconds:.0f} s"))
        missed += test is None
        print(f"{mutation.name}: {rows[-1][2]}, {rows[-1][3]}", file=sys.stderr, flush=True)
    table = Table("mutations", "mutations", ("what is broken", "file", "first test that fails", "after"), rows)
    show_table(table.title, table.columns, table.rows)
    if out is not None:
        out.write_text(markdown(table), encoding="utf-8")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
