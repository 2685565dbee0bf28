"""The data of a frame and of the load curve for the browser, where pictures.js draws them."""

from pathlib import Path
from typing import Any

import param
from panel.custom import JSComponent

_STYLE = """
.head { position: sticky; top: 0; background: white; z-index: 5; padding-left: 80px; }
.head { font: 14px sans-serif; }
dl { display: grid; grid-template-columns: repeat(5, 1fr); gap: 6px 14px; }
dl { margin: 4px 0; contain: content; }
dl > div:first-child { font-weight: bold; }
dl.old { color: #999999; }
dt { font-size: 12px; color: #666666; white-space: nowrap; }
dd { margin: 0; font-variant-numeric: tabular-nums; }
p { margin: 4px 0; }
p.warning { color: #8a5a00; font-size: 13px; }
p.refused { color: #b3261e; border-left: 4px solid #b3261e; padding: 6px 10px; }
canvas { display: block; width: 100%; height: 750px; touch-action: pan-y; }
"""


class Pictures(JSComponent):  # type: ignore[misc]
    """The component of the page that draws a frame and the load curve in the browser.

    frame: numbers and curves (`Explorer._paint`); curve: abscissas and ordinates of the load curve,
    and their names; refused: the reason why the scene has no frame, or "".
    """

    frame = param.Dict(default={})
    curve = param.Dict(default={"points": [[], []], "names": ["", ""]})
    refused = param.String(default="")

    _esm = Path(__file__).with_name("pictures.js")

    def __init__(self, **given: Any) -> None:
        super().__init__(stylesheets=[_STYLE], sizing_mode="stretch_width", **given)
