"""README has two shell commands of one line each, which name existing files and extras. Its
example prints the numbers in its comments, and its measured figures are those of the pages.
"""

from __future__ import annotations

import ast
import re
import shlex
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import contact
import sie
from contact import extras
from contact.model.registry import CONTROLS, INTERACTIONS, LAWS, PROFILES, SUBSTRATES
from contact.solution.stress_report import stress_report

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
PAGES = [
    ROOT / "README.md",
    ROOT / "CHANGELOG.md",
    ROOT / "CONTRIBUTING.md",
    *sorted((ROOT / "docs").glob("*.md")),
]
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
            assert anchor in {
                re.sub(r"[^\w -]", "", h.lower()).strip().replace(" ", "-") for h in headings
            }, target


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_python_blocks_are_python(page: Path) -> None:
    for block in re.findall(
        r"^```python\n(.*?)^```", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL
    ):
        if not block.startswith("--8<--"):
            compile(block, page.name, "exec")


# A number with a decimal point, such as 4.848e+09. The groups are the decimals and the exponent.
NUMBER = re.compile(r"-?\d+\.(\d+)(?:e([+-]?\d+))?")
BLOCKS = re.findall(r"^```python\n(.*?)^```", README, re.MULTILINE | re.DOTALL)


def missed(
    block: str, capsys: pytest.CaptureFixture[str], known: dict[str, Any] | None = None
) -> tuple[list[str], dict[str, Any]]:
    """(numbers in comments of a code block that its lines do not print, names that the block
    defines). Numbers are compared up to their last given digit. known: names of an earlier
    block.
    """
    names = dict(known or {})
    lacking: list[str] = []
    for statement in ast.parse(block).body:
        exec(compile(ast.Module([statement], []), "README.md", "exec"), names)
        printed = [float(number[0]) for number in NUMBER.finditer(capsys.readouterr().out)]
        _, _, comment = block.splitlines()[(statement.end_lineno or 1) - 1].partition("#")
        for said in NUMBER.finditer(comment):
            half = 0.5000001 * 10.0 ** (int(said[2] or 0) - len(said[1]))
            lacking += (
                [] if any(abs(float(said[0]) - number) <= half for number in printed) else [said[0]]
            )
    return lacking, names


def test_the_python_example_of_the_readme_prints_what_it_says(
    capsys: pytest.CaptureFixture[str],
) -> None:
    (block,) = BLOCKS
    assert len(NUMBER.findall(block.partition("print")[2])) >= 4
    lacking, names = missed(block, capsys)
    assert lacking == []
    tol = float(re.search(r"tol=([\de.-]+)", block)[1])  # type: ignore[index]
    assert names["solution"].error <= tol


@pytest.mark.slow
def test_the_picture_of_the_readme_is_drawn_from_the_scene_of_its_caption() -> None:
    pytest.importorskip("matplotlib")
    from docs.pictures import PAGES, limited_trace

    (picture,) = re.findall(r"^!\[.*\]\(docs/(images/\w+)\.png\)\n\n(?=A stylus)", README, re.M)
    assert picture in PAGES
    caption = README.partition("A stylus trace")[2].partition("\n\n")[0]
    solution = limited_trace()
    assert f"{1e3 * solution.scene.profile.period:.1f} mm long" in caption
    assert len(solution.zones) == 6 and "Six spikes" in caption
    assert f"hardness, {1e-9 * solution.max_pressure:g} GPa" in caption
    place = stress_report(solution).mises.x
    width = np.diff(solution.zones)[np.argmin(np.abs(solution.zones.mean(axis=1) - place)), 0]
    assert f"{1e6 * width:.2f} µm wide" in caption


def test_the_readme_is_short_and_has_one_table() -> None:
    words = re.sub(r"^```.*?^```", "", README, flags=re.MULTILINE | re.DOTALL).split()
    assert 400 <= len(words) <= 600
    assert len(re.findall(r"^\|[-| ]+\|$", README, re.MULTILINE)) == 1


def test_a_number_that_is_not_printed_is_noticed(capsys: pytest.CaptureFixture[str]) -> None:
    assert missed("print(1.17319304)  # 1.1732, and 1.1733, 1.17319304\n", capsys)[0] == ["1.1733"]


CONTRIBUTING = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
STARTS = re.findall(
    r"^\*\*(.*?)\*\*:.*?^```python\n(.*?)^```", CONTRIBUTING, re.MULTILINE | re.DOTALL
)


def test_a_new_part_of_each_kind_starts_from_under_ten_lines() -> None:
    kinds = [
        "Profile",
        "Interaction",
        "Substrate",
        "Law",
        "Side condition",
        "Control",
        "First guess",
    ]
    assert [kind for kind, _ in STARTS] == kinds
    assert all(len(block.splitlines()) < 10 for _, block in STARTS)


def test_scenes_with_the_parts_in_contributing_are_solved() -> None:
    names: dict[str, Any] = {"np": np, "contact": contact, "sie": sie, "dataclass": dataclass}
    try:
        for _, block in STARTS:
            exec(compile(block, "CONTRIBUTING.md", "exec"), names)
    finally:
        for known, name in (
            (PROFILES, "cosh"),
            (INTERACTIONS, "pair"),
            (SUBSTRATES, "coated"),
            (LAWS, "sticky"),
            (CONTROLS, "mean_gap"),
        ):
            known.forget(name)
    cosh, wave = names["Cosh"](1.0), contact.Sinusoid(0.01, 1.0)
    for scene in (
        contact.Scene(cosh, 1.0, names["Pair"](1.0), load=1e-3),
        contact.Scene(wave, 1.0, contact.Periodic(), substrate=names["Coated"](0.1), load=1e-2),
        contact.Scene(wave, 1.0, contact.Periodic(), law=names["Sticky"](1e-6), half_width=0.2),
    ):
        assert contact.solve(scene).certificate.holds
    left = sie.Equation(sie.cauchy(), sie.Forcing(np.zeros_like), (names["Left"](),))
    found = sie.solve(left, sie.Zones.of([[-1.0, 1.0]], sie.SINGULAR, sie.SINGULAR))
    assert found.density.intensities[0] == pytest.approx([2.0])
    given = contact.Scene(wave, 1.0, contact.Periodic(), given=names["MeanGap"](2e-3))
    assert contact.solve(given).mean_gap == pytest.approx(2e-3, rel=1e-7)


# Rows of a table of measured figures that name their page of docs.
MEASURED = re.compile(r"^\|.*\]\((docs/[\w-]+\.md)(?:#[\w-]+)?\).*\|$", re.MULTILINE)
# A figure: a time with its unit, an error as a power of ten, a count of thousands.
FIGURE = re.compile(r"\d+(?:\.\d+)? (?:µs|ms|s)\b|\d(?:\.\d+)?e-\d+|\d{1,3}(?:,\d{3})+")


def unfounded(text: str) -> list[tuple[str, str]]:
    """(page, figure) of every figure in a table row that is missing on the page named in the
    row.
    """
    rows = [(found[1], found[0]) for found in MEASURED.finditer(text)]
    return [
        (page, figure)
        for page, row in rows
        for figure in FIGURE.findall(re.sub(r"`[^`]*`", "", row))
        if figure not in (ROOT / page).read_text(encoding="utf-8")
    ]


def test_a_figure_of_the_readme_stands_on_the_page_it_is_taken_from() -> None:
    assert unfounded(README) == []


def test_a_figure_that_its_page_does_not_have_is_noticed() -> None:
    row = "| rough | {} | [measured](docs/benchmarks.md#cost-against-size) |\n"
    assert unfounded(row.format("123456.7 s, 9e-99, 987,654,321")) == [
        ("docs/benchmarks.md", figure) for figure in ("123456.7 s", "9e-99", "987,654,321")
    ]
    assert (
        unfounded(row.format("2187 zones")) == [] and unfounded("| no page | 123456.7 s |\n") == []
    )


def test_every_row_of_measured_figures_names_its_page() -> None:
    (table,) = re.findall(r"^\| problem \|.*\n\|[-| ]*\n((?:\|.*\n)+)", README, re.MULTILINE)
    assert len(MEASURED.findall(table)) == len(table.splitlines()) >= 8
