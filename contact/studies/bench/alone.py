"""Runs each measurement in its own process, so that the peak memory belongs to one case."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from contact.solution.terminal import show_table
from contact.studies.bench import machine
from contact.studies.bench.report import Table, markdown

ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


def measured(module: str, *arguments: str) -> dict[str, Any]:
    """Run a module in a new process and return the JSON object that the module prints."""
    environment = {**os.environ, **ONE_THREAD}
    command = [sys.executable, "-m", module, *arguments]
    run = subprocess.run(command, check=True, capture_output=True, text=True, env=environment)
    return dict(json.loads(run.stdout))


def publish(table: Table, remarks: list[str], out: Path | None) -> None:
    """Print a table with remarks; write table and remarks to `out` for a page of the docs."""
    setup = ", ".join(" ".join(row) for row in machine.table(()).rows)
    remarks = [*remarks, f"Measured with {setup}."]
    show_table(table.title, table.columns, table.rows, numeric=range(1, len(table.columns)))
    print("\n".join(remarks))
    if out is not None:
        out.write_text("\n".join((markdown(table), *remarks)) + "\n", encoding="utf-8")
