"""README promises two commands to a newcomer; they are there once each, one line each, and name what exists."""

from __future__ import annotations

import re
import shlex
import tomllib
from pathlib import Path

import pytest

import contact
from contact import extras

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").glob("*.md"))]
MARKED = re.findall(r"^<!-- ci: (\w+) -->\n```bash\n(.*?)\n```$", README, re.MULTILINE | re.DOTALL)


def test_there_are_two_commands_of_one_line_and_no_other_shell_block() -> None:
    assert [name for name, _ in MARKED] == ["run", "test"]
    assert len(re.findall(r"^```(bash|sh|shell|console)\b", README, re.MULTILINE)) == 2
    assert all("\n" not in command for _, command in MARKED)


def test_each_command_makes_an_environment_installs_and_runs() -> None:
    for (_, command), last in zip(MARKED, ["contact", "python"], strict=True):
        make, install, run = (shlex.split(part) for part in command.split(" && "))
        assert make[:3] == ["python3", "-m", "venv"]
        assert install[1:4] == ["-m", "pip", "install"]
        extra = re.fullmatch(r"\.\[(\w+)\]", install[-1])
        assert extra is not None and extra[1] in PROJECT["optional-dependencies"]
        assert run[0] == f"$VENV/bin/{last}"


def test_the_first_command_solves_a_scene_that_is_there() -> None:
    words = shlex.split(MARKED[0][1])
    scene = ROOT / words[words.index("solve") + 1]
    assert contact.load_scene(scene).profile.name == "sampled"


def test_every_extra_that_an_error_names_can_be_installed() -> None:
    source = Path(extras.__file__).read_text(encoding="utf-8")
    assert set(extras.EXTRAS.values()) <= set(PROJECT["optional-dependencies"])
    assert f"pip install '{PROJECT['name']}[" in source


def test_the_console_script_is_there() -> None:
    module, _, function = PROJECT["scripts"]["contact"].partition(":")
    assert module == "contact.__main__"
    assert f"def {function}(" in (ROOT / "contact" / "__main__.py").read_text(encoding="utf-8")


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_links_and_headings_they_point_to_exist(page: Path) -> None:
    for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text(encoding="utf-8")):
        if re.match(r"https?://", target):
            continue
        path, _, anchor = target.partition("#")
        file = page.parent / path if path else page
        assert file.exists(), target
        if anchor:
            headings = re.findall(r"^#+ (.*)$", file.read_text(encoding="utf-8"), re.MULTILINE)
            assert anchor in {re.sub(r"[^\w -]", "", h.lower()).strip().replace(" ", "-") for h in headings}, target


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_python_blocks_are_python(page: Path) -> None:
    for block in re.findall(r"^```python\n(.*?)^```", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL):
        if not block.startswith("--8<--"):
            compile(block, page.name, "exec")


def test_the_python_example_of_the_readme_prints_what_it_says(capsys: pytest.CaptureFixture[str]) -> None:
    (block,) = re.findall(r"^```python\n(.*?)^```", README, re.MULTILINE | re.DOTALL)
    names: dict[str, object] = {}
    exec(compile(block, "README.md", "exec"), names)
    printed = capsys.readouterr().out
    assert "[[-2.4743" in printed and "4.847" in printed and "0.4948" in printed
    assert names["solution"].error <= 1e-10  # type: ignore[attr-defined]
