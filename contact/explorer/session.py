"""The scene of one tab: its sliders, frames and load curve, and its replies to the page."""

import time
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from contact.errors import ContactError, SceneError, unwarned
from contact.explorer.frame import (
    OPTIONS,
    Branches,
    Frame,
    Point,
    below,
    both_branches,
    drawn,
    load_curve,
    message,
    numbers,
    place_on_curve,
    point_of,
    same_curve,
)
from contact.explorer.handles import SLIDERS, Handle, handles, moduli_handles, rounded, with_values
from contact.explorer.presets import PRESETS
from contact.model.registry import LAWS
from contact.model.scene import E_star, Scene
from contact.model.scene_file import scene_from_tables, to_toml
from contact.search.topology.extrapolation import CurvePoint
from contact.solution.plotting import close_up
from contact.solution.sampling import POINTS, window
from contact.solution.solution import Solution
from contact.solver import solve
from contact.sweeps.curve import Curve
from sie import Array


@dataclass(frozen=True)
class Given:
    """The scene that a page begins with.

    tables: tables of the scene's file, if there is one; folder: folder of this file; preset: name
    of the scene among the presets, or "".
    """

    scene: Scene
    tables: Mapping[str, Any] | None = None
    folder: str | Path = "."
    preset: str = ""


class _GaveWay(Exception):
    """Raised inside a solve to stop it, because a newer request waits."""


# Type of a reply: a JSON object, and arrays.
Parts = tuple[dict[str, Any], dict[str, Array]]


class Session:
    """The scene that one tab of a browser shows, and the requests of this tab.

    is_awaited: function that tells whether another request waits. If so, the computation of a load
    curve, or of a solution to full accuracy, is stopped.
    """

    def __init__(self, given: Given, tol: float, is_awaited: Callable[[], bool]) -> None:
        self.given, self.tol, self.is_awaited = given, tol, is_awaited
        self.solution: Solution | None = None
        self._curve: Curve | None = None  # followed while the slider of the control moves
        self._walk: Iterator[Solution] | None = None
        self._points: list[Point] = []
        self._lines = 0  # number of load curves so far; tells the page which curve is outdated
        self._branch, self._seconds = "advancing", 0.0
        self._begin(given.scene, given.tables)

    def reply(self, request: Mapping[str, Any]) -> Parts:
        """The reply to a request of the page: "begin", "frame" or "curve".
        An error becomes a message in the reply.
        """
        ask = {"begin": self.begin, "frame": self.frame, "curve": self.curve}
        try:
            return ask[request["ask"]](request)
        except _GaveWay:
            return {"dropped": True}, {}
        except Exception as error:  # the page shows every error as a message
            return {"refused": message(error).rstrip(".") + "."}, {}

    # The next methods set the scene and its sliders.

    def begin(self, request: Mapping[str, Any]) -> Parts:
        """Begin with a preset, with the text of a scene file, or with the scene that was given."""
        given, preset = self.given, request.get("preset")
        text = PRESETS[preset].text if preset in PRESETS else request.get("text")
        if text is not None:
            try:
                tables = tomllib.loads(text)
            except ValueError as error:
                raise SceneError(f"this is not a scene file: {error}") from error
            given = Given(scene_from_tables(tables, self.given.folder), tables)
        elif preset is None:
            preset = given.preset
        self._begin(given.scene, given.tables)
        tension = given.scene.law.pressure_range.has_tension
        if tension and given.scene.law.equilibria.several:
            try:
                self._solve(self.base, fine=False)
            except ContactError:
                pass  # the first frame shows the error
            else:
                self._take_handles(self.solution)
        return {
            "sliders": [_shown(handle, self.base) for handle in (*self.known, *self.moduli)],
            "steps": SLIDERS.steps,
            "branches": tension,
            "about": PRESETS[preset].about if preset in PRESETS else "",
            "presets": list(PRESETS),
            "preset": preset or "",
            "own": not self.given.preset,
        }, {}

    def _begin(self, scene: Scene, tables: Mapping[str, Any] | None) -> None:
        self.base, self.tables = scene, dict(tables or {})
        self.solution = self._curve = self._walk = None
        self._lines += 1
        self._take_handles(None)

    def _take_handles(self, solution: Solution | None) -> None:
        self.moduli = moduli_handles(self.tables.get("material", {}))
        self.known = handles(self.base, solution)
        if self.moduli:
            # E* follows from the moduli. Parameters of the law may follow from them, too.
            given = self.tables.get("law", {})
            moduli = self.tables["material"]
            follow = set(_completed(given, moduli)) - set(given) if given else set()
            self.known = tuple(one for one in self.known if one.name not in {"E_star", *follow})

    def scene(self, values: Mapping[str, float]) -> Scene:
        """The scene with new values of some sliders."""
        moved = {name: rounded(float(value)) for name, value in values.items()}
        scene = with_values(self.base, moved, self.known)
        moduli = self._material(moved)
        if moduli == self.tables.get("material") or not self.moduli:
            return scene
        scene = replace(scene, E_star=E_star(**moduli))
        law = self.tables.get("law")
        if law:
            completed = _completed(law, moduli)
            new = {key: value for key, value in completed.items() if key not in law}
            changed: Any = replace(scene.law, **new)  # type: ignore[type-var]
            scene = replace(scene, law=changed)
        return scene

    def _material(self, moved: Mapping[str, float]) -> dict[str, float]:
        given = dict(self.tables.get("material", {}))
        return given | {one.name: moved[one.name] for one in self.moduli if one.name in moved}

    @property
    def nu(self) -> float:
        """Poisson's ratio of body 1, for von Mises stresses; 0.3 if it is not given."""
        return float(self.tables.get("material", {}).get("nu1", 0.3))

    # The next methods compute a frame: what the page shows for values of the sliders.

    def frame(self, request: Mapping[str, Any]) -> Parts:
        """The solution for values of the sliders, as numbers and curves.

        With "fine", the scene is solved to the page's tolerance, and the text of its file is added.
        """
        fine = bool(request.get("fine"))
        values = request.get("values") or {}
        scene = self.scene(values)
        branch = str(request.get("branch") or "advancing")
        last = self.solution
        if last is None or not same_curve(last.scene, scene):
            self._walk, self._points = None, []
            self._lines += 1
        self._branch = branch
        solution = self._solve(scene, fine)
        stretch = tuple(request["stretch"]) if request.get("stretch") else None
        points = POINTS.screen_points if fine else OPTIONS.points_while_moving
        frame = drawn(solution, points, stretch)
        header, arrays = self._parts(frame)
        kind = request.get("below")
        if kind in ("shear", "mises", "fringes"):
            columns = int(min(max(request.get("columns") or 200, 20), 600))
            nu = self._material(values).get("nu1", self.nu)
            try:
                body = below(solution, kind, nu, stretch, columns if fine else columns // 2, fine)
            except ContactError as error:
                header["below"] = {"refused": str(error)}
            else:
                header["below"], arrays["below"] = dict(body.details), body.values
                header["numbers"][-1:-1] = body.details.get("rows", [])
        if fine:
            header["text"] = self.text(scene, values)
            close = close_up(solution, *window(solution)) if solution.load else None
            header["close"] = None if close is None else [end * header["along"] for end in close]
        return header, arrays

    def _parts(self, frame: Frame) -> Parts:
        across, up, *names = place_on_curve(frame.solution)
        return {
            **frame.details,
            "names": frame.names,
            "title": title(frame.solution.scene),
            "here": [across, up],
            "curve": self._lines,
            "curve_names": names,
            "numbers": [list(row) for row in numbers(frame, self._seconds)],
            "warnings": list(frame.solution.warnings),
        }, {"fields": frame.fields, "zones": frame.zones.ravel()}

    def _solve(self, scene: Scene, fine: bool) -> Solution:
        """Solve a scene, starting from the last solution where that is possible."""
        tol = self.tol if fine else max(self.tol, OPTIONS.tol_while_moving)
        last, progress = self.solution, self._yielding if fine else None
        if last is not None and last.scene == scene and last.error <= tol:
            if not scene.law.pressure_range.has_tension:
                return last
        start = time.perf_counter()
        with unwarned():
            if scene.law.pressure_range.has_tension:
                found = solve(scene, tol=tol, branch=self._branch, progress=progress)
            elif fine:
                found = solve(scene, tol=tol, near=self._near(scene), progress=progress)
            else:
                found = self._along(scene, tol)
        self.solution, self._seconds = found, time.perf_counter() - start
        return found

    def _near(self, scene: Scene) -> Solution | None:
        last = self.solution
        same = last is not None and all(
            getattr(last.scene, part) == getattr(scene, part) for part in _PARTS
        )
        return last if same else None

    def _along(self, scene: Scene, tol: float) -> Solution:
        """The solution of a scene, found along the curve on which only the control changes."""
        name, value = scene.control
        if self._curve is None or not same_curve(self._curve.scene, scene):
            self._curve = Curve(scene, name, tol)
            near = self._near(scene)
            self._curve.previous = () if near is None else (CurvePoint(near),)
        try:
            return self._curve.at(value)
        except ContactError:
            self._curve = None
            raise

    def _yielding(self, *_: Any) -> None:
        if self.is_awaited():
            raise _GaveWay

    def text(self, scene: Scene, values: Mapping[str, float] | None = None) -> str:
        """The text of the scene file.

        The material is written as elastic constants if the given file has them, else as E*. An
        unchanged trace is given by the name of its file, a changed trace by its points.
        """
        read = self.base.profile.bodies
        written = {
            place: self.tables[place]
            for place, body in scene.profile.bodies.items()
            if place in self.tables and body == read.get(place)
        }
        if self.moduli:
            written["material"] = self._material(values or {})
            if "law" in self.tables:
                written["law"] = self.tables["law"]
        try:
            text = to_toml(scene, written)
        except SceneError as error:
            return f"# {error}\n"
        if len(text) > OPTIONS.max_text:
            return (
                f"# this scene has {len(text):,} characters, most of them for the points of the "
                "profile: save the points to a file and name this file in [profile]\n"
            )
        return text

    # The next methods compute the load curve.

    def curve(self, request: Mapping[str, Any]) -> Parts:
        """More of the load curve: some points, or under adhesion both branches at once.

        "done" in the reply tells that the curve is complete.
        """
        assert self.solution is not None
        scene, tol = self.solution.scene, max(self.tol, OPTIONS.tol_while_moving)
        if scene.law.equilibria.several:
            return self._reply_curve(both_branches(scene, self.known[0], tol, self._yielding), True)
        if self._walk is None:
            self._walk = load_curve(scene, self.known[0], tol, self._yielding)
            self._points = []
        end = time.perf_counter() + 0.05
        try:
            for solution in self._walk:
                self._points.append(point_of(solution))
                if self.is_awaited() or time.perf_counter() > end:
                    return self._reply_curve(Branches([self._points], [], []), False)
        except _GaveWay:
            # A generator that has raised an exception cannot go on. So the next request starts the
            # curve again.
            self._walk = None
            raise
        return self._reply_curve(Branches([self._points], [], []), True)

    def _reply_curve(self, found: Branches, done: bool) -> Parts:
        return {
            "curve": self._lines,
            "done": done,
            "advancing": found.advancing,
            "receding": found.receding,
            "jumps": found.jumps,
        }, {}


_PARTS = ("profile", "interaction", "substrate", "law")


def _completed(law: Mapping[str, Any], moduli: Mapping[str, float]) -> Mapping[str, Any]:
    """The parameters of a law's table, with those that follow from the moduli of the bodies."""
    given = {key: value for key, value in law.items() if key != "model"}
    completed: Mapping[str, Any] = LAWS.find(law["model"]).completed(given, moduli)
    return completed


def title(scene: Scene) -> str:
    """The title of a scene: its shape, interaction model, substrate and law, in a few words."""
    parts = [scene.profile.title, scene.interaction.name]
    usual = type(scene).__dict__
    parts += [
        part.name
        for part, default in ((scene.substrate, usual["substrate"]), (scene.law, usual["law"]))
        if part != default
    ]
    return ", ".join(parts)


def _shown(handle: Handle, scene: Scene) -> dict[str, Any]:
    """The data from which the page makes a slider."""
    label = handle.name.replace("E_star", "E*").replace("_", " ")
    if handle.name == "nu":  # nu1 and nu2 belong to the bodies
        label = f"nu of the {scene.substrate.name}"
    shown = {"name": handle.name, "label": label, "unit": handle.unit, "value": handle.value}
    return shown | {
        "low": handle.low,
        "high": handle.high,
        "log": handle.log,
        "whole": handle.whole,
    }
