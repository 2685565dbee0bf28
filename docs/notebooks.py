"""Pages of the notebooks, made when the site is built: text, code and what each cell shows.

`python docs/notebooks.py` runs the notebooks of docs/notebooks and keeps what they show in them
(packages nbclient and ipykernel of the extra `test`).
"""

from __future__ import annotations

import base64
import json
import re
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "docs" / "notebooks"


def notebooks() -> list[Path]:
    """The notebooks, by name."""
    return sorted(FOLDER.glob("*.ipynb"))


def cells(notebook: Path) -> list[dict[str, Any]]:
    """Cells of a notebook as they are stored."""
    return list(json.loads(notebook.read_text(encoding="utf-8"))["cells"])


def title(notebook: Path) -> str:
    """The first heading of a notebook."""
    first = "".join(cells(notebook)[0]["source"])
    return first.partition("\n")[0].removeprefix("# ")


def text_of(cell: dict[str, Any]) -> str:
    """What a cell prints."""
    outputs = cell.get("outputs", ())
    return "".join("".join(one["text"]) for one in outputs if one["output_type"] == "stream")


def pictures_of(cell: dict[str, Any]) -> list[bytes]:
    """PNG pictures that a cell shows."""
    shown = (one.get("data", {}).get("image/png") for one in cell.get("outputs", ()))
    return [base64.b64decode("".join(one)) for one in shown if one]


def page(notebook: Path) -> tuple[str, dict[str, bytes]]:
    """Markdown of a notebook, and its pictures by the names of their files."""
    parts: list[str] = []
    pictures: dict[str, bytes] = {}
    for cell in cells(notebook):
        source = "".join(cell["source"])
        parts.append(source if cell["cell_type"] == "markdown" else f"```python\n{source}\n```")
        if text_of(cell):
            parts.append(f"```text\n{text_of(cell)}```")
        for picture in pictures_of(cell):
            name = f"{notebook.stem}-{len(pictures) + 1}.png"
            pictures[name] = picture
            parts.append(f"![Figure of this notebook]({name})")
    # The file itself lies beside the page.
    parts.insert(1, f"[Download this notebook]({notebook.name})")
    heading, _, rest = parts[0].partition("\n")
    return "\n\n".join([heading, parts[1], rest.strip(), *parts[2:]]) + "\n", pictures


def on_files(files: Any, config: Any, **_: Any) -> Any:
    """Called by ProperDocs with the files of the folder: the pages are added."""
    from properdocs.structure.files import File

    for notebook in notebooks():
        content, pictures = page(notebook)
        files.append(File.generated(config, f"notebooks/{notebook.stem}.md", content=content))
        for name, picture in pictures.items():
            files.append(File.generated(config, f"notebooks/{name}", content=picture))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Called by ProperDocs with the text of every page: the list of notebooks leads to their pages."""
    return markdown.replace(".ipynb)", ".md)") if page.file.src_uri == "notebooks.md" else markdown


def run(notebook: Path) -> Any:
    """The notebook, run in its folder, with what it shows."""
    import nbclient
    import nbformat

    read = nbformat.read(notebook, as_version=4)
    client = nbclient.NotebookClient(
        read,
        timeout=300,
        kernel_name="python3",
        resources={"metadata": {"path": str(notebook.parent)}},
    )
    client.execute(cwd=str(notebook.parent))
    for cell in read.cells:
        cell.metadata.pop("execution", None)
        for output in cell.get("outputs", ()):
            if "data" in output:  # numbers of a cell change from run to run, and say nothing
                output["data"].pop("text/plain", None)
                output["metadata"] = {}
    return read


if __name__ == "__main__":
    import nbformat

    for made in notebooks():
        nbformat.write(run(made), made)
        print(re.sub(r"^.*/docs/", "docs/", str(made)))
