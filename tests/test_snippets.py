"""Code in the documentation: the Python blocks of a page, in their order, are a script that runs
by itself, and the commands of a page succeed.
"""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
BLOCK = re.compile(r"^( *)```python\n(.*?)^\1```$", re.MULTILINE | re.DOTALL)
# Pages with calls of other codes, and the packages of these codes.
NEEDS = {"coming-from.md": ("tamaas", "ContactMechanics")}
QUICK = {"quickstart.md"}


def script(page: Path) -> str:
    """The Python blocks of a page, one after the other. Blocks that show a file are left out."""
    blocks = [textwrap.dedent(code) for _, code in BLOCK.findall(page.read_text(encoding="utf-8"))]
    return "\n".join(block for block in blocks if not block.startswith("--8<--"))


PAGES = {
    page.relative_to(ROOT).as_posix(): page
    for page in [*sorted((ROOT / "docs").rglob("*.md")), ROOT / "README.md"]
    if script(page)
}


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[] if Path(name).name in QUICK else pytest.mark.slow)
        for name in PAGES
    ],
)
def test_the_python_of_a_page_runs_from_top_to_bottom(name: str, tmp_path: Path) -> None:
    for package in NEEDS.get(Path(name).name, ()):
        pytest.importorskip(package)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    file = tmp_path / "page.py"
    file.write_text(script(PAGES[name]), encoding="utf-8")
    paths = [str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])]
    settings = {**os.environ, "PYTHONPATH": os.pathsep.join(paths), "MPLBACKEND": "Agg"}
    done = subprocess.run(
        [sys.executable, str(file)],
        cwd=tmp_path,
        env=settings,
        capture_output=True,
        text=True,
        timeout=300,
        stdin=subprocess.DEVNULL,
    )
    assert done.returncode == 0, done.stderr[-2000:]


SHELL = re.compile(r"^```(?:bash|text)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
# Commands that measure for minutes, wait for a browser or a reader, or ask another machine.
LEFT_OUT = {"bench", "stability", "figures", "explore"}


def commands(page: Path) -> list[list[str]]:
    """Arguments of the commands `contact ...` of a page, without those that a test cannot run."""
    lines = [
        line.strip()
        for block in SHELL.findall(page.read_text(encoding="utf-8"))
        for line in block.replace("\\\n", " ").splitlines()
    ]
    split = [shlex.split(line, comments=True)[1:] for line in lines if line.startswith("contact ")]
    return [words for words in split if words[0] not in LEFT_OUT and "--scheduler" not in words]


WITH_COMMANDS = [page for page in sorted((ROOT / "docs").glob("*.md")) if commands(page)]


@pytest.mark.slow
@pytest.mark.parametrize("page", WITH_COMMANDS, ids=lambda page: page.stem)
def test_the_commands_of_a_page_end_well(page: Path, tmp_path: Path) -> None:
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    paths = [str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])]
    settings = {**os.environ, "PYTHONPATH": os.pathsep.join(paths), "MPLBACKEND": "Agg"}
    run = 0
    for words in commands(page):
        # A command is skipped if its file is neither an example nor written by an earlier
        # command. Such a file stands for one of the reader.
        if not (tmp_path / words[1]).exists():
            continue
        done = subprocess.run(
            [sys.executable, "-m", "contact", *words],
            cwd=tmp_path,
            env=settings,
            capture_output=True,
            text=True,
            timeout=300,
            stdin=subprocess.DEVNULL,
        )
        assert done.returncode == 0, (words, done.stderr[-2000:])
        run += 1
    assert run


def test_blocks_that_show_a_file_are_left_out(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(
        '```python\na = 1\n```\n\n```python\n--8<-- "x.py"\n```\n\n```python\nb = a\n```\n',
        encoding="utf-8",
    )
    assert script(page) == "a = 1\n\nb = a\n"
