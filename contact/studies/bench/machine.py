"""The machine and the package versions with which the measurements were made."""

from __future__ import annotations

import os
import platform
import subprocess
from collections.abc import Sequence
from importlib import metadata
from pathlib import Path

from contact.extras import version
from contact.studies.bench.report import Table


def table(peers: Sequence[str]) -> Table:
    """Table of the processor, the threads and the versions of the packages."""
    packages = ["sie-contact", "numpy", "scipy", *peers]
    rows: list[tuple[str, ...]] = [
        ("processor", _processor()),
        ("threads", os.environ.get("OMP_NUM_THREADS", "as many as numpy takes")),
    ]
    rows += [("Python", platform.python_version()), *((name, _version(name)) for name in packages)]
    return Table("machine", "measured with", ("what", ""), rows)


def commit() -> str:
    """Return the commit of the source, with a note if files were changed after it.

    Without git, the version of the package is returned.
    """
    try:
        run = subprocess.run(
            ["git", "describe", "--always", "--abbrev=10", "--dirty= with changes", "--exclude=*"],
            cwd=Path(__file__).parent,
            capture_output=True,
            text=True,
            check=True,
            timeout=20,
        )
    except (OSError, subprocess.SubprocessError):
        return f"version {version()}"
    return f"commit {run.stdout.strip()}"


def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "from source"


def _processor() -> str:
    """Return the name of the processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()
