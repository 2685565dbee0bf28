"""Inserts measured tables and figures into the pages of docs.

    python -m contact.studies.pages OUT

OUT/NAME.md replaces the text of a page between `<!-- measured: NAME -->` and `<!-- end -->`;
OUT/NAME.png becomes docs/images/bench-NAME.png. Tables that are not in OUT stay as they are.
"""

from __future__ import annotations

import re
import shutil
import sys
from pathlib import Path

import contact

ROOT = Path(contact.__file__).parent.parent
DOCS = ROOT / "docs"
PAGES = (
    "ablation.md",
    "benchmarks.md",
    "measured-engine.md",
    "many-zones.md",
    "stability.md",
    "tests.md",
)
PLACE = re.compile(r"(<!-- measured: ([\w-]+) -->\n).*?(<!-- end -->)", re.DOTALL)


def filled(page: str, folder: Path) -> str:
    """Return the text of a page in which the tables found in the folder are inserted."""

    def table(found: re.Match[str]) -> str:
        file = folder / f"{found[2]}.md"
        if not file.exists():
            return found[0]
        return f"{found[1]}\n{file.read_text(encoding='utf-8')}\n{found[3]}"

    return PLACE.sub(table, page)


def fill(folder: Path, docs: Path = DOCS) -> None:
    """Insert the tables and figures of a folder into all pages."""
    for name in PAGES:
        page = docs / name
        page.write_text(filled(page.read_text(encoding="utf-8"), folder), encoding="utf-8")
    for figure in folder.glob("*.png"):
        shutil.copy(figure, docs / "images" / f"bench-{figure.name}")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    fill(Path(sys.argv[1]))
