"""Formulas are set when the pages are built: TeX becomes MathML, which browsers show without a script, a font or a network."""

from __future__ import annotations

import html
import re
from typing import Any

from latex2mathml.converter import convert
from mkdocs.exceptions import PluginError

# What pymdownx.arithmatex makes of $...$ and $$...$$.
FORMULA = re.compile(r'<(span|div) class="arithmatex">\\[(\[](.*?)\\[)\]]</\1>', re.DOTALL)


def mathml(tex: str, display: bool) -> str:
    """MathML of a formula; a command that is not known is refused, not shown as it stands."""
    made = str(convert(tex, display="block" if display else "inline"))
    unknown = re.search(r"\\\w+", html.unescape(made))
    if unknown:
        raise ValueError(f"{unknown[0]} in {tex!r} is no known command")
    return made


def on_page_content(content: str, page: Any, **_: Any) -> str:
    """Called by mkdocs with the HTML of every page."""

    def set_one(found: re.Match[str]) -> str:
        try:
            made = mathml(html.unescape(found[2]).strip(), found[1] == "div")
        except Exception as fault:
            raise PluginError(f"{page.file.src_uri}: formula {found[2]!r}: {fault!r}") from fault
        return f'<{found[1]} class="formula">{made}</{found[1]}>'

    return FORMULA.sub(set_one, content)
