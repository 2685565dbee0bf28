"""Pages of the documentation: each is in the navigation, links lead to existing targets, the
reference lists the public names, and nothing is loaded from other servers.
"""

from __future__ import annotations

import functools
import http.server
import importlib.util
import re
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import yaml

import contact
import sie
from tests.browser import CHROMIUM, MISSING, browser

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGES = sorted(DOCS.rglob("*.md"))
EXAMPLES = {file for end in ("*.py", "*.toml") for file in (ROOT / "examples").rglob(end)}
SETUP = yaml.safe_load((ROOT / "mkdocs.yml").read_text(encoding="utf-8"))
IS_AWAY = re.compile(r"(?:https?:)?//")


def entries(nav: Any) -> Iterator[str]:
    """File names of all pages in a navigation."""
    for entry in nav.values() if isinstance(nav, dict) else nav:
        if isinstance(entry, str):
            yield entry
        else:
            yield from entries(entry)


def prose(page: Path) -> str:
    """The text of a page without code blocks and code spans."""
    return re.sub(
        r"`[^`\n]+`",
        "",
        re.sub(
            r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL
        ),
    )


def anchors(page: Path) -> set[str]:
    """Anchors that a link to a page may name: explicit ids, and those of headings."""
    found = set(re.findall(r'id="([^"]+)"', page.read_text(encoding="utf-8")))
    for heading in re.findall(r"^#+ (.*)$", prose_with_code(page), re.MULTILINE):
        plain = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading).lower()
        found.add(re.sub(r"[-\s]+", "-", re.sub(r"[^\w\s-]", "", plain).strip()))
    return found


def prose_with_code(page: Path) -> str:
    """The text of a page without code blocks, in which comments look like headings."""
    return re.sub(
        r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL
    )


def test_every_page_is_in_the_navigation_once_and_every_entry_is_a_page() -> None:
    named = list(entries(SETUP["nav"]))
    assert sorted(named) == sorted(page.relative_to(DOCS).as_posix() for page in PAGES)


def address(page: str) -> str:
    """The folder of the built site that contains a page."""
    return page.removesuffix(".md").removesuffix("index").rstrip("/")


def test_no_two_pages_have_one_address() -> None:
    taken = [address(page.relative_to(DOCS).as_posix()) for page in PAGES]
    assert sorted(taken) == sorted(set(taken))
    assert address("paper.md") == address("paper/index.md") != address("paper/spots.md")


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.relative_to(DOCS).as_posix())
def test_links_of_a_page_lead_to_what_is_there(page: Path) -> None:
    for target in re.findall(r"\]\(([^)\s]+)\)", prose(page)):
        if IS_AWAY.match(target):
            continue
        path, _, anchor = target.partition("#")
        file = (page.parent / path).resolve() if path else page
        assert file.is_file() and file.is_relative_to(DOCS) or file in EXAMPLES, target
        assert not anchor or anchor in anchors(file), target


def test_a_file_that_the_site_shows_in_a_page_is_linked_before_it() -> None:
    # A reader of the Markdown file does not see the included file, but can follow the link.
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        for block in re.finditer(r'^--8<-- "(.*)"$', text, re.MULTILINE):
            section = re.split(r"^#", text[: block.start()], flags=re.MULTILINE)[-1]
            linked = {(page.parent / one).resolve() for one in re.findall(r"\]\((\S+?)\)", section)}
            assert ROOT / block[1] in linked, (page.name, block[1])


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.relative_to(DOCS).as_posix())
def test_a_page_loads_nothing_from_elsewhere(page: Path) -> None:
    text = prose(page)
    loaded = re.findall(r"!\[[^]]*\]\(([^)\s]+)", text) + re.findall(
        r"""(?:src|srcset|data)=["']([^"']+)""", text
    )
    assert [target for target in loaded if IS_AWAY.match(target)] == []
    assert re.findall(r"<(?:script|link|iframe)\b", text) == []


def hook(name: str) -> ModuleType:
    """The module of a Python file in docs that ProperDocs runs."""
    spec = importlib.util.spec_from_file_location(f"docs_{name}", DOCS / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


CHANGES = (DOCS / "architecture.md").read_text(encoding="utf-8").split("## Five changes")[1]
CHANGES = CHANGES.split("\n## ")[0]


def named_files(text: str) -> list[str]:
    """Files of both packages and of the pages that a text names in code spans."""
    return re.findall(r"`((?:contact|sie|docs)/[\w/]+\.(?:py|md))`", text)


def steps_of(change: str) -> list[tuple[str, str]]:
    """(file, text) of the numbered steps of a change; a step ends at the next one or a blank line."""
    return re.findall(r"^\d+\. `([^`]+)`: (.*?)(?=^\d+\. |^$|\Z)", change, re.MULTILINE | re.DOTALL)


def words_of(text: str) -> list[str]:
    """Names in the code spans of a step before the word "Edit:", without paths of files."""
    told = re.split(r"\sEdit:", text)[0]
    spans = re.findall(r"`([A-Za-z_.]+)(?:\([^)`]*\))?`", told)
    return [span.rpartition(".")[2] for span in spans]


CHANGES_BY_TITLE = {
    change.partition("\n")[0]: change.partition("\n")[2] for change in CHANGES.split("\n### ")[1:]
}


def test_there_are_five_changes_and_all_files_that_they_name_exist() -> None:
    assert len(CHANGES_BY_TITLE) == 5
    assert not [name for name in named_files(CHANGES) if not (ROOT / name).is_file()]


@pytest.mark.parametrize("title", CHANGES_BY_TITLE)
def test_a_change_reads_at_most_six_files_or_says_why_not(title: str) -> None:
    text = CHANGES_BY_TITLE[title]
    count = len(steps_of(text))
    reason = re.search(r"more than six files[^.]*,\s+since ", text, re.IGNORECASE)
    assert 0 < count <= 6 or reason is not None
    assert [int(number) for number in re.findall(r"^(\d+)\. `", text, re.MULTILINE)] == list(
        range(1, count + 1)
    )


@pytest.mark.parametrize("title", CHANGES_BY_TITLE)
def test_a_step_names_what_stands_in_its_file(title: str) -> None:
    for name, text in steps_of(CHANGES_BY_TITLE[title]):
        source = (ROOT / name).read_text(encoding="utf-8")
        for word in words_of(text):
            assert word in source, (name, word)


def test_a_name_with_its_file_in_brackets_stands_in_that_file() -> None:
    pairs = re.findall(r"`(\w+)`\s\(`((?:contact|sie)/[\w/]+\.py)`", CHANGES)
    assert len(pairs) > 5
    for word, name in pairs:
        assert word in (ROOT / name).read_text(encoding="utf-8"), (name, word)


def test_words_before_the_edit_are_read_in_steps_of_several_lines() -> None:
    text = (
        "1. `a/b.py`: `one(x)` and\n   `two.three`. Edit: a method `new`.\n2. `c.py`: none.\n\n`no`"
    )
    assert [(name, words_of(told)) for name, told in steps_of(text)] == [
        ("a/b.py", ["one", "three"]),
        ("c.py", []),
    ]


@pytest.mark.parametrize("package", [contact, sie], ids=lambda p: p.__name__)
def test_the_reference_has_every_public_name_and_no_other(package: Any) -> None:
    reference = hook("reference")
    page = (DOCS / "api" / f"{package.__name__}.md").read_text(encoding="utf-8")
    assert sorted(reference.named(reference.completed(page, package.__name__))) == sorted(
        package.__all__
    )
    assert set(reference.named(page)) <= set(package.__all__)
    assert sorted(reference.named(reference.completed("", package.__name__))) == sorted(
        package.__all__
    )


def test_anchors_are_those_of_headings_outside_code_blocks(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("# One, two: `three`\n\n```bash\n# four\n```\n", encoding="utf-8")
    assert anchors(page) == {"one-two-three"}


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the built site."""
    if (
        importlib.util.find_spec("materialx") is None
        or importlib.util.find_spec("mkdocstrings") is None
    ):
        pytest.skip("the extra `docs` is not installed")
    folder = tmp_path_factory.mktemp("site")
    command = [
        sys.executable,
        "-m",
        "properdocs",
        "build",
        "--quiet",
        "--strict",
        "--site-dir",
        str(folder),
    ]
    subprocess.run(
        command, cwd=ROOT, check=True, capture_output=True, stdin=subprocess.DEVNULL, timeout=300
    )
    return folder


@pytest.mark.slow
def test_no_built_page_or_style_names_anything_to_load_from_elsewhere(site: Path) -> None:
    sources = r"""<(?:script|img|iframe|source)\b[^>]*?\bsrc=["']([^"']+)"""
    loads = re.compile(
        sources + r"""|<link\b(?![^>]*rel=["'](?:canonical|prev|next))[^>]*?\bhref=["']([^"']+)"""
    )
    for page in site.rglob("*.html"):
        found = [one or other for one, other in loads.findall(page.read_text(encoding="utf-8"))]
        assert found and [target for target in found if IS_AWAY.match(target)] == [], page
    for style in site.rglob("*.css"):
        assert (
            re.findall(
                r"""(?:url\(|@import\s+)["']?(?:https?:)?//""", style.read_text(encoding="utf-8")
            )
            == []
        ), style


@pytest.mark.slow
def test_the_site_is_searched_in_a_browser_that_asks_no_other_machine(site: Path) -> None:
    if CHROMIUM is None:
        pytest.skip(MISSING)
    quiet = type("Quiet", (http.server.SimpleHTTPRequestHandler,), {"log_message": lambda *_: None})
    with http.server.ThreadingHTTPServer(
        ("127.0.0.1", 0), functools.partial(quiet, directory=str(site))
    ) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        try:
            with browser() as page:
                own = f"http://127.0.0.1:{server.server_port}/"
                page.open(own)
                page.until(
                    lambda: page.run("document.querySelectorAll('input.md-search__input').length")
                )
                page.click("document.querySelector('input.md-search__input')")
                page.type("stated error")
                found = "[...document.querySelectorAll('.md-search-result__link')].map(one => one.getAttribute('href'))"
                # The results change while letters are typed. The last ones are those of the
                # whole query.
                page.until(lambda: any("errors" in link for link in page.run(found)))
                asked = [
                    address
                    for address in page.requests
                    if not address.startswith(("data:", "blob:"))
                ]
                assert (
                    len(asked) > 5
                    and [address for address in asked if not address.startswith(own)] == []
                )
        finally:
            server.shutdown()
