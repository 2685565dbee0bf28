"""Formulas are set when the pages are built: TeX becomes MathML, which browsers show without a
script, a font or a network.
"""

from __future__ import annotations

import html
import re
from typing import Any

from latex2mathml.converter import convert
from properdocs.exceptions import PluginError

# What pymdownx.arithmatex makes of $...$ and $$...$$.
FORMULA = re.compile(r'<(span|div) class="arithmatex">\\[(\[](.*?)\\[)\]]</\1>', re.DOTALL)

# What the converter leaves as letters and signs between two sides: names of functions, fractions in
# a line, bars, primes, accents.
NAMES = "arccos|arcsin|arctan|arctanh|artanh|cos|cosh|cot|coth|csc|det|exp|ln|log|sec|sgn|sin|sinh|tan|tanh|Re|Im"
TIGHT = '<mo lspace="0" rspace="0" stretchy="false">'
SPACED = (
    (
        rf"<mi>({NAMES})</mi>(?=<mo[^>]*>(?:\(|&#x00028;))",
        r'<mo lspace="0.17em" rspace="0">\1</mo>',
    ),
    (rf"<mi>({NAMES})</mi>", r'<mo lspace="0.17em" rspace="0.17em">\1</mo>'),
    (r'<mo(?: stretchy="false")?>(/|&#x0002F;|\||&#x0007C;)</mo>', rf"{TIGHT}\1</mo>"),
    (r"<mi>(&#x0203[2-4];|[\u2032-\u2034])</mi>", rf"{TIGHT}\1</mo>"),
    (
        r'<mover>(<mi>[^<]*</mi>)<mo stretchy="true">(?:&#x000AF;|\u00af)</mo>',
        rf'<mover accent="true">\1{TIGHT}&#x203E;</mo>',
    ),
)


def mathml(tex: str, display: bool) -> str:
    """MathML of a formula; a command that is not known is refused, not shown as it stands."""
    made = str(convert(tex, display="block" if display else "inline"))
    unknown = re.search(r"\\\w+", html.unescape(made))
    if unknown:
        raise ValueError(f"{unknown[0]} in {tex!r} is no known command")
    for found, spaced in SPACED:
        made = re.sub(found, spaced, made)
    return made


def on_page_content(content: str, page: Any, **_: Any) -> str:
    """Called by ProperDocs with the HTML of every page."""

    def set_one(found: re.Match[str]) -> str:
        try:
            made = mathml(html.unescape(found[2]).strip(), found[1] == "div")
        except Exception as fault:
            raise PluginError(f"{page.file.src_uri}: formula {found[2]!r}: {fault!r}") from fault
        return f'<{found[1]} class="formula">{made}</{found[1]}>'

    return FORMULA.sub(set_one, content)
