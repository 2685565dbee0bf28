"""Pages of the examples, made when the site is built: docstring, picture, script, and what it
prints.

Pictures and prints are kept in docs/gallery, where `python docs/pictures.py` puts them.
Without one of them nothing is built.
"""

from __future__ import annotations

import ast
import json
import re
from itertools import takewhile
from pathlib import Path
from typing import Any

from properdocs.exceptions import PluginError
from properdocs.structure.files import File

ROOT = Path(__file__).parents[1]
FILES = {
    "Contact": (ROOT / "examples", "*.py"),
    "The engine on its own": (ROOT / "examples" / "engine", "*.py"),
    "Scene files": (ROOT / "examples", "*.toml"),
}
PLACE = "<!-- gallery -->"
EXAMPLE = re.compile(r"\]\((?:\.\./)+examples/(?:engine/)?([\w-]+)\.(?:py|toml)\)")


def scripts() -> dict[str, list[Path]]:
    """The examples under the headings of the gallery."""
    return {heading: sorted(folder.glob(ending)) for heading, (folder, ending) in FILES.items()}


def told(script: Path) -> tuple[str, str]:
    """Title and text of an example: the first line of its docstring, or of its comment, up to a
    colon or a full stop, and from there on.
    """
    source = script.read_text(encoding="utf-8")
    if script.suffix == ".py":
        said = ast.get_docstring(ast.parse(source)) or ""
    else:
        said = "\n".join(
            line.lstrip("# ")
            for line in takewhile(lambda line: line.startswith("#"), source.splitlines())
        )
    first, _, rest = said.partition("\n")
    title, *more = re.split(r": |\. ", first, maxsplit=1)
    text = "".join(f"{part[:1].upper()}{part[1:]}" for part in more)
    return title.rstrip("."), "\n".join(part for part in (text, rest) if part).strip()


def page(script: Path) -> str:
    """Markdown of one example."""
    title, text = told(script)
    parts = [f"# {title}", text, f"![{title}]({script.stem}.png)"]
    parts.append(
        f'```{"python" if script.suffix == ".py" else "toml"}\n--8<-- "{script.relative_to(ROOT).as_posix()}"\n```'
    )
    printed = (ROOT / "docs" / "gallery" / f"{script.stem}.txt").read_text(encoding="utf-8")
    if printed:
        parts += ["It prints" if script.suffix == ".py" else "Solved:", f"```text\n{printed}```"]
    return "\n\n".join(part for part in parts if part) + "\n"


def index() -> str:
    """Markdown of all pictures, each a link to its page."""
    parts = []
    for heading, files in scripts().items():
        parts.append(f"## {heading}\n")
        for script in files:
            title, _ = told(script)
            parts.append(
                f'<a class="example" href="../gallery/{script.stem}/"><img alt="" src="../gallery/{script.stem}.png">{title}</a>'
            )
    return "\n".join(parts)


def with_pages(nav: Any, below: dict[str, list[Any]]) -> Any:
    """A navigation in which each page that `below` names, at any depth, holds the pages of it."""
    if isinstance(nav, list):
        return [with_pages(entry, below) for entry in nav]
    if isinstance(nav, dict):
        return {title: with_pages(part, below) for title, part in nav.items()}
    return [nav, *below[nav]] if nav in below else nav


def heading_of(notebook: Path) -> str:
    """The first heading of a notebook."""
    first = json.loads(notebook.read_text(encoding="utf-8"))["cells"][0]["source"]
    return "".join(first).partition("\n")[0].removeprefix("# ")


def on_config(config: Any, **_: Any) -> Any:
    """Called by ProperDocs first: examples and notebooks stand below their pages in the navigation."""
    below = {
        "examples.md": [
            {heading: [{told(script)[0]: f"gallery/{script.stem}.md"} for script in files]}
            for heading, files in scripts().items()
        ],
        "notebooks.md": [
            {heading_of(notebook): f"notebooks/{notebook.stem}.md"}
            for notebook in sorted((ROOT / "docs" / "notebooks").glob("*.ipynb"))
        ],
    }
    config["nav"] = with_pages(config["nav"], below)
    return config


def on_files(files: Any, config: Any, **_: Any) -> Any:
    """Called by ProperDocs with the files of the folder: the pages are added."""
    for script in (script for found in scripts().values() for script in found):
        if not all(
            (ROOT / "docs" / "gallery" / f"{script.stem}.{end}").exists() for end in ("png", "txt")
        ):
            raise PluginError(
                f"{script.name} has no picture yet: python docs/pictures.py {script.stem}"
            )
        files.append(File.generated(config, f"gallery/{script.stem}.md", content=page(script)))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Called by ProperDocs with the text of every page.

    Pages link files of `examples`, for readers of the files themselves. On the site, such a link
    leads to the page of the example.
    """
    up = "../" * page.file.src_uri.count("/")
    return EXAMPLE.sub(rf"]({up}gallery/\1.md)", markdown).replace(PLACE, index())
