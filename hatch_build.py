"""README.md as an index of packages shows it: there its links to files of this folder would lead
nowhere.

Where pyproject.toml gives the project a `Source` among its urls, and says by which address a file
of a version is read there (`[tool.hatch.metadata.hooks.custom]`: `files`, `images`), links and
pictures lead there. Else links are the names of the files that they lead to, which the archive of
source has, and pictures are what they show, in words. Links within the page stay, as do those to
other places.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)")
CODE = re.compile(r"(^```.*?^```$|`[^`\n]+`)", re.MULTILINE | re.DOTALL)
ELSEWHERE = re.compile(r"\w+:|//|#")
WHERE = "\nFiles named here, `docs/...` and others, are in the archive of source, `{}-{}.tar.gz`, with all pages and examples.\n"


class ReadmeHook(MetadataHookInterface):
    def update(self, metadata: dict[str, Any]) -> None:
        text = (Path(self.root) / "README.md").read_text(encoding="utf-8")
        metadata["readme"] = {
            "content-type": "text/markdown",
            "text": as_shown(text, metadata, self.config),
        }


def as_shown(text: str, project: Mapping[str, Any], addresses: Mapping[str, str]) -> str:
    """The text with its links to files as they can be followed elsewhere.

    addresses: `files` and `images`, with {source}, {version} and {path}.
    """
    source = project.get("urls", {}).get("Source", "").rstrip("/")

    def led(found: re.Match[str]) -> str:
        picture, label, target = found.groups()
        if ELSEWHERE.match(target):
            return found[0]
        address = addresses.get("images" if picture else "files") if source else None
        if address:
            return f"{picture}[{label}]({address.format(source=source, version=project['version'], path=target)})"
        path = target.partition("#")[0]
        if picture:
            return f"*{label}* (`{path}`)"
        return f"`{path}`" if label in (path, Path(path).name) else f"{label} (`{path}`)"

    # What stands between marks of code is no link: every second part.
    parts = [
        part if place % 2 else LINK.sub(led, part) for place, part in enumerate(CODE.split(text))
    ]
    told = (
        ""
        if source and addresses.get("files")
        else WHERE.format(project["name"].replace("-", "_"), project["version"])
    )
    return "".join(parts) + told
