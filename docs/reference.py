"""Public names that a page of the reference does not name yet stand at its end when the site is
built: none is left out.
"""

from __future__ import annotations

import ast
import re
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
# Whose pages are lists of names; those of parts of a package name the part.
PACKAGES = ("contact", "sie")


def public(package: str) -> list[str]:
    """What a package exports."""
    tree = ast.parse((ROOT / package / "__init__.py").read_text(encoding="utf-8"))
    (names,) = (
        node.value
        for node in tree.body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__"
    )
    return list(ast.literal_eval(names))


def named(page: str) -> list[str]:
    """What a page of the reference names."""
    return [name.rpartition(".")[2] for name in re.findall(r"^::: (\S+)$", page, re.MULTILINE)]


def completed(page: str, package: str) -> str:
    """The page with all that its package exports."""
    left = [name for name in public(package) if name not in named(page)]
    more = "".join(f"\n::: {package}.{name}\n" for name in left)
    return f"{page}\n## More\n{more}" if left else page


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Called by ProperDocs with the text of every page."""
    package = page.file.src_uri.removeprefix("api/").removesuffix(".md")
    return (
        completed(markdown, package)
        if page.file.src_uri == f"api/{package}.md" and package in PACKAGES
        else markdown
    )
