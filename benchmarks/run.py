"""Everything docs/benchmarks.md and docs/stability.md show: python benchmarks/run.py [--quick] [--peers] OUT."""

from __future__ import annotations

import sys
from pathlib import Path

from contact.bench import run
from contact.terminal import Progress, show_table


def main(arguments: list[str]) -> int:
    flags = {a for a in arguments if a.startswith("--")}
    names = [a for a in arguments if a not in flags]
    if len(names) != 1 or not flags <= {"--quick", "--peers"}:
        print(__doc__, file=sys.stderr)
        return 2
    folder, quick = Path(names[0]), "--quick" in flags
    folder.mkdir(parents=True, exist_ok=True)
    with Progress() as progress:
        tables = run.bench(folder, quick, "--peers" in flags, progress)
        table, failed = run.extremes(folder, quick, progress)
    for title, columns, rows in (*tables, table):
        show_table(title, columns, rows)
    return 3 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
