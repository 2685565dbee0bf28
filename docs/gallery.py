"""Pages of the examples, made when the site is built: docstring, picture, script, and what it prints.

Pictures and prints are kept in docs/gallery, where `python -m contact.studies.gallery` puts them. Without one of them nothing is built.
"""

from __future__ import annotations

import ast
from pathlib import Path
from typing import Any

from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File

ROOT = Path(__file__).parents[1]
FOLDERS = {"Contact": ROOT / "examples", "The engine on its own": ROOT / "examples" / "engine"}
PLACE = "<!-- gallery -->"


def scripts() -> dict[str, list[Path]]:
    """The examples under the headings of the gallery."""
    return {heading: sorted(folder.glob("*.py")) for heading, folder in FOLDERS.items()}


def told(script: Path) -> tuple[str, str]:
    """Title and text of an example: the first line of its docstring, up to the colon and from there on."""
    said = ast.get_docstring(ast.parse(script.read_text(encoding="utf-8"))) or ""
    first, _, rest = said.partition("\n")
    title, colon, more = first.partition(": ")
    text = f"{more[:1].upper()}{more[1:]}" if colon else ""
    return title.rstrip("."), "\n".join(part for part in (text, rest) if part).strip()


def page(script: Path) -> str:
    """Markdown of one example."""
    title, text = told(script)
    parts = [f"# {title}", text, f"![{title}]({script.stem}.png)"]
    parts.append(f'```python\n--8<-- "{script.relative_to(ROOT).as_posix()}"\n```')
    printed = (ROOT / "docs" / "gallery" / f"{script.stem}.txt").read_text(encoding="utf-8")
    if printed:
        parts += ["It prints", f"```text\n{printed}```"]
    return "\n\n".join(part for part in parts if part) + "\n"


def index() -> str:
    """Markdown of all pictures, each a link to its page."""
    parts = []
    for heading, files in scripts().items():
        parts.append(f"## {heading}\n")
        for script in files:
            title, _ = told(script)
            parts.append(f'<a class="example" href="../gallery/{script.stem}/"><img alt="" src="../gallery/{script.stem}.png">{title}</a>')
    return "\n".join(parts)


def on_config(config: Any, **_: Any) -> Any:
    """Called by mkdocs first: the pages stand in the navigation below the gallery."""
    below = [{told(script)[0]: f"gallery/{script.stem}.md"} for files in scripts().values() for script in files]
    config["nav"] = [{"Examples": ["examples.md", *below]} if entry == {"Examples": "examples.md"} else entry for entry in config["nav"]]
    return config


def on_files(files: Any, config: Any, **_: Any) -> Any:
    """Called by mkdocs with the files of the folder: the pages are added."""
    for script in (script for found in scripts().values() for script in found):
        if not all((ROOT / "docs" / "gallery" / f"{script.stem}.{end}").exists() for end in ("png", "txt")):
            raise PluginError(f"{script.name} has no picture yet: python -m contact.studies.gallery {script.stem}")
        files.append(File.generated(config, f"gallery/{script.stem}.md", content=page(script)))
    return files


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Called by mkdocs with the text of every page."""
    return markdown.replace(PLACE, index()) if PLACE in markdown else markdown
