"""Everything that docs/benchmarks.md and docs/stability.md show:

    python -m contact.studies.run [--quick] [--peers] [--docs] OUT

Tables, CSV and figures go to OUT; --docs sets them, and what else is there, in the
pages. Runs on one thread.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

from contact.solution.terminal import Progress, show_table
from contact.studies.alone import ONE_THREAD
from contact.studies.bench import run
from contact.studies.pages import fill

_FLAGS = {"--quick", "--peers", "--docs"}


def main(arguments: list[str]) -> int:
    flags = {a for a in arguments if a.startswith("--")}
    names = [a for a in arguments if a not in flags]
    if len(names) != 1 or not flags <= _FLAGS:
        print(__doc__, file=sys.stderr)
        return 2
    if any(os.environ.get(name) != "1" for name in ONE_THREAD):
        # numpy takes its number of threads when it is loaded: once more from the start.
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
