"""Measures everything that docs/benchmarks.md and docs/stability.md show.

    python -m contact.studies.run [--quick] [--peers] [--docs] OUT

Tables, CSV files and figures go to OUT. `--docs` inserts all tables and figures of OUT into the
pages of docs. The program runs on one thread.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

from contact.solution.terminal import Progress, show_table
from contact.studies.bench import run
from contact.studies.bench.alone import ONE_THREAD
from contact.studies.pages import fill


def main(arguments: list[str]) -> int:
    """Measure and show the tables. Return 3 if an extreme scene fails, 2 for wrong arguments."""
    flags = {a for a in arguments if a.startswith("--")}
    names = [a for a in arguments if a not in flags]
    if len(names) != 1 or not flags <= {"--quick", "--peers", "--docs"}:
        print(__doc__, file=sys.stderr)
        return 2
    if any(os.environ.get(name) != "1" for name in ONE_THREAD):
        # numpy chooses its number of threads at import, so the program restarts with the
        # environment variables set.
        again = [sys.executable, "-m", "contact.studies.run", *sys.argv[1:]]
        os.execve(sys.executable, again, {**os.environ, **ONE_THREAD})
    folder, quick = Path(names[0]), "--quick" in flags
    folder.mkdir(parents=True, exist_ok=True)
    with Progress() as progress:
        tables = run.bench(folder, quick, "--peers" in flags, progress)
        table, failed = run.extremes(folder, quick, progress)
    for measured in (*tables, table):
        show_table(measured.title, measured.columns, measured.rows)
    if "--docs" in flags:
        fill(folder)
    return 3 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
