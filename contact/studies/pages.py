"""Inserts measured tables and figures into the pages of docs.

    python -m contact.studies.pages OUT

OUT/NAME.md replaces the text of a page between `<!-- measured: NAME -->` and `<!-- end -->`;
OUT/NAME.png becomes docs/images/bench-NAME.png. Tables that are not in OUT stay as they are. If a
table is long, the page shows a short form of it (`contact.studies.shortened`), and
docs/tables/NAME.csv has the whole table.
"""

from __future__ import annotations

import re
import shutil
import sys
from pathlib import Path

import contact
from contact.studies import shortened

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
        return f"{found[1]}\n{shown(found[2], file.read_text(encoding='utf-8'))}\n{found[3]}"

    return PLACE.sub(table, page)


def shown(name: str, text: str) -> str:
    """Return the Markdown that a page shows for a table: its short form, if there is one."""
    if name not in shortened.SHORT:
        return text
    cells = shortened.SHORT[name](shortened.parsed(text))
    if not cells.columns:
        return shortened.markdown(cells)
    first, *rest = cells.remarks or [""]
    link = f"[Full table](tables/{name}.csv). {first}".rstrip()
    return shortened.markdown(cells._replace(remarks=[link, *rest]))


def fill(folder: Path, docs: Path = DOCS) -> None:
    """Insert the tables and figures of a folder into all pages; write long tables as CSV."""
    for name in PAGES:
        page = docs / name
        page.write_text(filled(page.read_text(encoding="utf-8"), folder), encoding="utf-8")
    for name, short in shortened.SHORT.items():
        if (folder / f"{name}.md").exists():
            cells = shortened.parsed((folder / f"{name}.md").read_text(encoding="utf-8"))
            if not short(cells).columns:
                continue  # the short form is a line of text that has all contents of the table
            (docs / "tables").mkdir(exist_ok=True)
            (docs / "tables" / f"{name}.csv").write_text(shortened.as_csv(cells), encoding="utf-8")
    for figure in folder.glob("*.png"):
        shutil.copy(figure, docs / "images" / f"bench-{figure.name}")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    fill(Path(sys.argv[1]))
