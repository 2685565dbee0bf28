"""The page: sliders, pictures, numbers and the scene file, built with Panel.

A dragged slider sends more values than can be solved: when a frame is done, the latest values make
the next one. The browser loads everything from the page's own server.
"""

import math
import time
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from contact.errors import ContactError, SceneError
from contact.explorer.frame import (
    OPTIONS,
    Frame,
    drawn,
    load_curve,
    message,
    numbers,
    place_on_curve,
    same_curve,
    solved,
)
from contact.explorer.handles import SLIDERS, Handle, handles, rounded, turned
from contact.extras import require
from contact.model.scene import Scene
from contact.model.scene_file import scene_from_tables, to_toml
from contact.model.units import prefix
from contact.solution.sampling import POINTS
from contact.solution.solution import Solution


@dataclass(frozen=True)
class PageOptions:
    """Waiting times of the page, and the length of the longest text that it shows."""

    # Pause between two tasks [ms], in which events of the browser are handled.
    pause: int = 5
    # Time without a change after which the page adds the text and the load curve [ms]. If one
    # solution takes longer than this, the load curve is drawn on demand only.
    settling_time: int = 300
    # Longest scene file that the page shows [characters].
    max_text: int = 20_000


_PAGE = PageOptions()

# JavaScript that formats the number of a slider, with an SI prefix before the unit.
_READOUT = """
const value = log ? Math.pow(10, tick) : tick;
if (whole) return value < least ? 'as it is' : value.toFixed(0);
if (value == 0 || unit == '') return value.toPrecision(4).replace(/\\.?0+$/, '') + ' ' + unit;
const power = Math.max(-12, Math.min(12, 3 * Math.floor(Math.log10(Math.abs(value)) / 3 + 1e-9)));
const letter = 'pnµm kMGT'[power / 3 + 4].trim();
return (value / Math.pow(10, power)).toPrecision(4) + ' ' + letter + unit;
"""


class Explorer:
    """A scene and the page that shows it.

    layout: the object that Panel serves and that notebooks display.
    """

    def __init__(
        self,
        scene: Scene,
        tol: float,
        tables: Mapping[str, Any] | None = None,
        directory: str | Path = ".",
    ) -> None:
        self.pn, self.models = require("panel"), require("bokeh.models")
        self.tol, self.directory = tol, directory
        self.frame: Frame | None = None
        self.moved: dict[str, float] = {}
        # Whether a new frame is due, whether the page waits to be completed, and whether a new load
        # curve is due.
        self._due = self._waits = self._curve_is_due = False
        self._rest_at = 0.0
        self._walk: Iterator[Solution] | None = None
        self._make()
        self._begin(scene, tables)

    def _make(self) -> None:
        pn = self.pn
        self.sliders, self.pictures = (
            pn.Column(sizing_mode="stretch_width"),
            require("contact.explorer.pictures").Pictures(),
        )
        self.branch = pn.widgets.RadioButtonGroup(
            label="branch", options=["advancing", "receding"], visible=False
        )
        self.branch.param.watch(lambda _: self._change(), "value")
        self.text = pn.widgets.TextAreaInput(
            label="scene file",
            rows=16,
            max_length=10**7,
            sizing_mode="stretch_width",
            stylesheets=["textarea { font-family: monospace; }"],
        )
        self.read = pn.widgets.Button(label="solve this text", color="primary")
        self.read.on_click(lambda _: self._read())
        copy = pn.widgets.Button(label="copy")
        copy.js_on_click(args={"text": self.text}, code="navigator.clipboard.writeText(text.value)")
        self.draw = pn.widgets.Button(label="draw the load curve", visible=False)
        self.draw.on_click(lambda _: self._start_curve())
        left = pn.Column(
            self.branch,
            self.sliders,
            self.text,
            pn.Row(self.read, copy),
            width=380,
            margin=(0, 20, 0, 0),
        )
        self.layout = pn.Row(
            left,
            pn.Column(self.pictures, self.draw, sizing_mode="stretch_width"),
            sizing_mode="stretch_width",
        )

    # The next methods set the scene and its sliders.

    def _begin(self, scene: Scene, tables: Mapping[str, Any] | None) -> None:
        """Show a new scene with its sliders and first frame.

        tables: the tables of the scene's file.
        """
        self.base, self.tables = scene, tables or {}
        self.moved, self.known, self.frame = {}, handles(scene), None
        self.branch.visible = scene.law.pressure_range.has_tension
        self._show()
        if self.frame is not None and scene.law.pressure_range.has_tension:
            self.known = handles(scene, self.frame.solution)
        self.sliders.objects = [self._slider(handle) for handle in self.known]

    def _slider(self, handle: Handle) -> Any:
        # The low end of a slider for integers (`handle.whole`) means "as it is": the shape does not
        # change. Such a slider starts at its low end.
        start = handle.low if handle.whole else handle.value
        low, high = handle.low, handle.high
        if handle.log:
            low, high, start = math.log10(low), math.log10(high), math.log10(start)
        step = (high - low) / SLIDERS.steps
        args = {
            "log": handle.log,
            "whole": handle.whole,
            "unit": handle.unit,
            "least": handle.low + 0.5,
        }
        readout = self.models.CustomJSTickFormatter(args=args, code=_READOUT)
        slider = self.pn.widgets.FloatSlider(
            label=handle.name.replace("_star", "*").replace("_", " "),
            start=low,
            end=high,
            step=step,
            value=start,
            format=readout,
            tooltips=False,
            sizing_mode="stretch_width",
        )

        # By default Panel waits 50 ms for further values of a slider. The page waits by itself
        # instead.
        slider._debounce = 0

        def move(event: Any) -> None:
            self.moved[handle.name] = self._value(
                handle, event.new, abs(event.new - start) < 0.5 * step
            )
            self._change()

        slider.param.watch(move, "value")
        return slider

    @staticmethod
    def _value(handle: Handle, at: float, unmoved: bool) -> float:
        if unmoved:
            return handle.value
        value = 10.0**at if handle.log else at
        if handle.whole:
            return float(round(value)) if value > handle.low + 0.5 else handle.value
        return rounded(value)

    def _read(self) -> None:
        """Read the scene in the text area and show it."""
        try:
            tables = tomllib.loads(self.text.value or "")
            scene = scene_from_tables(tables, self.directory)
        except (ContactError, ValueError, OSError) as error:
            self._refuse(
                str(error) if isinstance(error, ContactError) else f"is not a scene file: {error}"
            )
            return
        self._begin(scene, tables)

    # The next methods draw frames.

    def _change(self) -> None:
        """Schedule a new frame after a change, unless one is scheduled already."""
        if not self._due:
            self._due = True
            self._soon(self._show)

    def _soon(self, do: Callable[[], None], after: int = _PAGE.pause) -> None:
        """Call a function after a pause, in which events of the browser are handled.

        Without a server, the function is called at once.
        """
        if self._is_served:
            self.pn.state.curdoc.add_timeout_callback(do, after)
        else:
            do()

    @property
    def _is_served(self) -> bool:
        document = self.pn.state.curdoc
        return document is not None and document.session_context is not None

    def _show(self) -> None:
        """Solve and draw the present scene. The browser gets the whole frame in one message."""
        self._due = False
        with self.pn.io.hold():
            self._show_all()

    def _show_all(self) -> None:
        last = self.frame
        try:
            scene = turned(self.base, self.moved, self.known)
            self.frame = solved(
                scene,
                self.tol,
                last.solution if last else None,
                self.branch.value,
                OPTIONS.points_while_moving if self._is_served else POINTS.screen_points,
            )
            if (
                last is None
                or not same_curve(last.solution.scene, scene)
                or self._of_curve != self.branch.value
            ):
                self._forget_curve()
            self._paint(self.frame)
        except Exception as error:  # the page shows every error as a message
            self._refuse(message(error))
            return
        self.pictures.refused = ""
        self._rest_at = time.monotonic() + 1e-3 * _PAGE.settling_time
        if not self._waits:
            self._waits = True
            self._soon(self._settle, _PAGE.settling_time)

    def _settle(self) -> None:
        """Complete the page after a change: draw finer curves, the text and the load curve."""
        left = self._rest_at - time.monotonic()
        if left > 0 and self._is_served:
            self._soon(self._settle, 1 + int(1e3 * left))
            return
        self._waits = False
        if self.frame is None:
            return
        with self.pn.io.hold():
            if self._is_served:
                self.frame = drawn(self.frame.solution, self.frame.seconds)
                self._paint(self.frame)
            self._write(self.frame.solution.scene)
            if self._curve_is_due:
                self.draw.visible = 1e3 * self.frame.seconds > _PAGE.settling_time
                if not self.draw.visible:
                    self._start_curve()

    def _refuse(self, message: str) -> None:
        old = (
            " What is drawn, and the numbers, are of the last scene that was solved."
            if self.pictures.frame
            else ""
        )
        self.pictures.refused = f"{message.rstrip('.')}.{old}"

    def _paint(self, frame: Frame) -> None:
        across, up, (name, unit), (what, whose) = place_on_curve(frame.solution)
        curve = self.pictures.curve
        if not curve["points"][0]:
            # The units of a load curve stay the same while points are added to it.
            self._across, self._up = prefix(abs(across)), prefix(abs(up))
            names = [f"{name} [{self._across[1]}{unit}]", f"{what} [{self._up[1]}{whose}]"]
            if names != curve["names"]:
                self.pictures.curve = {"points": [[], []], "names": names}
        self.pictures.frame = {
            "fields": frame.fields,
            "zones": frame.zones.ravel(),
            "names": list(frame.names),
            "here": [across * self._across[0], up * self._up[0]],
            "numbers": [list(row) for row in numbers(frame)],
            "warnings": list(frame.solution.warnings),
        }

    def _write(self, scene: Scene) -> None:
        """Show the text of the scene file.

        An unchanged trace is given by the name of its file, a changed trace by its points.
        """
        try:
            read = self.base.profile.bodies
            as_read = [
                place
                for place, body in scene.profile.bodies.items()
                if place in self.tables and body == read.get(place)
            ]
            text = to_toml(scene, {place: self.tables[place] for place in as_read})
        except SceneError as error:
            text = f"# {error}\n"
        if len(text) > _PAGE.max_text:
            text = (
                f"# {len(text):,} letters, most of them of points: "
                "save them to a file that [profile] names\n"
            )
        self.text.value = text

    # The next methods draw the load curve. `_of_curve` is the branch of the present curve.
    _of_curve = ""

    def _forget_curve(self) -> None:
        """Remove the previous scene's load curve, and note that the new scene's curve is due."""
        self._walk, self._curve_is_due = None, True
        self._of_curve = self.branch.value
        if self.pictures.curve["points"][0]:
            self.pictures.curve = {**self.pictures.curve, "points": [[], []]}

    def _start_curve(self) -> None:
        if self.frame is not None:
            self.draw.visible = self._curve_is_due = False
            self._walk = walk = load_curve(
                self.frame.solution.scene, self.known[0], self.tol, self.branch.value
            )
            self._soon(lambda: self._step(walk))

    def _step(self, walk: Iterator[Solution]) -> None:
        """Add the next solution of `walk` to the load curve.

        An outdated curve gets no point. If a frame is due, the point waits.
        """
        if walk is not self._walk:
            return
        here = None if self._due else next(walk, None)
        if here is not None:
            across, up, *_ = place_on_curve(here)
            ways, loads = self.pictures.curve["points"]
            points = [[*ways, across * self._across[0]], [*loads, up * self._up[0]]]
            self.pictures.curve = {**self.pictures.curve, "points": points}
        if here is not None or self._due:
            self._soon(lambda: self._step(walk))
