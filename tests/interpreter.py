"""Lists the modules that a fresh interpreter has loaded."""

from __future__ import annotations

import subprocess
import sys
from functools import cache
from pathlib import Path


@cache
def loaded_after_each(*steps: str) -> list[set[str]]:
    """Returns the loaded modules' names after each step; one interpreter runs the steps in order."""
    code = "import sys\n" + "".join(f"{step}\nprint(*sys.modules)\n" for step in steps)
    run = subprocess.run(
        [sys.executable, "-c", code],
        cwd=Path(__file__).parents[1],
        capture_output=True,
        text=True,
        check=True,
        stdin=subprocess.DEVNULL,
    )
    return [set(line.split()) for line in run.stdout.splitlines()]
