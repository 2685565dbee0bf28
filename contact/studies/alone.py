"""What a study measures in a process of its own, on one thread, and the table that is told of it."""

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


def measured(file: str, *arguments: str) -> dict[str, Any]:
    """What a file prints as JSON when it is run with these arguments."""
    command, environment = [sys.executable, file, *arguments], {**os.environ, **ONE_THREAD}
    return dict(
        json.loads(
            subprocess.run(
                command, check=True, capture_output=True, text=True, env=environment
            ).stdout
        )
    )


def tell(table: Table, remarks: list[str], out: Path | None) -> None:
    """Show a table and what is said below it, and write both for a page."""
    remarks = [
        *remarks,
        f"Measured with {', '.join(' '.join(row) for row in machine.table(()).rows)}.",
    ]
    show_table(table.title, table.columns, table.rows, numeric=range(1, len(table.columns)))
    print("\n".join(remarks))
    if out is not None:
        out.write_text("\n".join((markdown(table), *remarks)) + "\n", encoding="utf-8")
