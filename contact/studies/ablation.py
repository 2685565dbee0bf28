"""Ablation: the value of each mechanism of `sie` and `contact`, switched off in turn.

    python -m contact.studies.ablation [--only NAME ...] [--ordinary] [--out FILE]

There are three kinds of scenes. The 95 ordinary scenes are 91 scenes of
`contact.studies.random_scenes` and four adhesive traces. The large scenes have hundreds of zones,
plateaus or knots. The extreme scenes are those of `contact.studies.bench.extremes` that take no
more than about a second.

A mechanism is switched off by replacing a function, a class attribute or a field of options, in a
process of its own; two processes run at a time. For each mechanism the table has the number of
scenes that are lost, the number of scenes whose answer changes by more than the sum of both stated
errors, and the processor time relative to the run with everything on. If the object to be replaced
does not exist, an error is raised. `--ordinary` leaves out the large and the extreme scenes, which
take most of the time.
`python -m contact.studies.pages DIR` sets DIR/ablation.md in docs/ablation.md.
"""

from __future__ import annotations

import argparse
import contextlib
import dataclasses
import json
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import contact
from contact.errors import unwarned
from contact.extras import require
from contact.studies.bench import clock, stability
from contact.studies.bench.alone import measured, publish
from contact.studies.bench.extremes import matrix
from contact.studies.bench.large_scenes import Large, self_affine, trace_of_kind
from contact.studies.bench.report import Table
from contact.studies.random_scenes import Drawn, draw
from contact.studies.trace_kinds import self_affine_heights
from sie import Array


@dataclass(frozen=True)
class Switch:
    """One replacement that switches off a mechanism: the object `target` gets a new value.

    `target` is "module:attribute" or "module:Class.attribute". `off` takes the present value of the
    target and returns the new one.
    """

    target: str
    off: Callable[[Any], Any]

    def find(self) -> tuple[Any, str]:
        """Return (owner, name) of the target; AttributeError if the target does not exist."""
        module, _, path = self.target.partition(":")
        owner: Any = require(module)
        *outer, name = path.split(".")
        for part in outer:
            owner = getattr(owner, part)
        if name not in vars(owner):
            raise AttributeError(f"{self.target} does not exist: the table MECHANISMS is outdated")
        return owner, name

    def apply(self) -> None:
        """Replace the target in its module and in all modules that imported the target by name."""
        owner, name = self.find()
        old = vars(owner)[name]
        new = self.off(old)
        setattr(owner, name, new)
        for other_name, other in list(sys.modules.items()):
            if other_name.split(".")[0] in ("sie", "contact"):
                for key in [key for key, value in vars(other).items() if value is old]:
                    setattr(other, key, new)


def returning(value: Any) -> Callable[[Any], Any]:
    """Return a function `off` (see `Switch`) that replaces a function by a constant function."""
    return lambda old: lambda *args, **kwargs: value


def returning_argument(place: int) -> Callable[[Any], Any]:
    """Return a function `off` (see `Switch`) that replaces a function by one of its arguments."""
    return lambda old: lambda *args: args[place]


def with_fields(**changed: Any) -> Callable[[Any], Any]:
    """Return a function `off` (see `Switch`) that changes these fields of an options instance."""
    return lambda old: dataclasses.replace(old, **changed)


def without(name: str) -> Callable[[Any], Any]:
    """Return a function `off` (see `Switch`) that removes a named entry from a table.

    The rows of the table are (name, function).
    """

    def off(old: tuple[tuple[str, Any], ...]) -> tuple[tuple[str, Any], ...]:
        left = tuple(entry for entry in old if entry[0] != name)
        if len(left) == len(old):
            raise AttributeError(f"there is no {name!r}: the table MECHANISMS is outdated")
        return left

    return off


def _no_gap_steps(old: Any) -> Any:
    def off(gaps: Any, widths: Any, moves: Any, k: Any, *rest: Any) -> Any:
        return np.zeros_like(k), np.zeros(k.shape, dtype=bool)

    return off


def _longest_series(old: Any) -> Any:
    return lambda search: search.decay


def _tightest_tolerance(old: Any) -> Any:
    return property(lambda progress: progress.tightest)


def _residual_itself(old: Any) -> Any:
    return lambda extension, residual: residual - residual.mean()


def _whole_cells(old: Any) -> Any:
    def off(state: Any, cells: Any, first: int, E: float) -> tuple[float, float]:
        return first + 0.5 * (len(cells) - 1), 0.5 * len(cells) * state.influence.h

    return off


def _none_for_all(old: Any) -> Any:
    return lambda scenes, tol: [None] * len(scenes)


def _no_context(old: Any) -> Any:
    return lambda *args, **kwargs: contextlib.nullcontext()


# Each key describes a mechanism, and the value lists the replacements that switch this mechanism
# off.
MECHANISMS: dict[str, tuple[Switch, ...]] = {
    "Newton steps of ends across a narrow gap": (
        Switch("sie.ends.step_models:gap_steps", _no_gap_steps),
    ),
    "Newton steps of ends near a jump": (
        Switch("sie.ends.step_models:StepAtJumps.steps", returning_argument(3)),
    ),
    "shorter series in the first Newton steps": (
        Switch("sie.ends.newton:_Search._size_of_last_coefficients", _longest_series),
    ),
    "loosely solved first Newton steps": (
        Switch("sie.ends.progress:Progress.linear", _tightest_tolerance),
    ),
    "Newton steps of narrow rims in other variables": (
        Switch("sie.ends.rims:with_rim_steps", returning_argument(0)),
    ),
    "shorter steps of rims that alternate": (
        Switch("sie.ends.rims:without_alternation", returning_argument(0)),
    ),
    "narrow gaps as slits": (Switch("sie.slits.slits:merge", returning(None)),),
    "splines for many jumps": (
        Switch("sie.jumps.spline:OPTIONS", with_fields(min_jumps=10**9, min_density_jumps=10**9)),
    ),
    "fast sums and GMRES": (Switch("sie.fast.system:unfit", returning("switched off")),),
    "far sums by a tree": (Switch("sie.trees.far:reaches", returning(False)),),
    "smooth kernels by panels": (Switch("sie.trees.panels:panels_over", returning(None)),),
    "coarse inverse kept for moved zones": (
        Switch("sie.fast.coarse:CoarseOperator.serves", returning(False)),
    ),
    "one zone in closed form": (
        Switch("contact.closed.solve:solve_closed", returning(None)),
        Switch("contact.closed.solve:solve_all_closed", _none_for_all),
    ),
    "formulation by gaps": (
        Switch("contact.search.strategies.gaps:gaps_are_better", returning(False)),
    ),
    "first guess of one zone": (
        Switch("contact.search.strategies.guesses:GUESSES", without("one zone")),
    ),
    "search by loads": (Switch("contact.search.find:STRATEGIES", without("loads")),),
    "a second solution, to a smaller tolerance": (
        Switch("contact.search.strategies.tightening:tightened", returning_argument(1)),
    ),
    "half of a symmetric contact": (
        Switch("contact.search.topology.pressure_form:is_symmetric", returning(False)),
    ),
    "zones after gaps, if these are less precise": (
        Switch("contact.search.refine:_by_zones", returning_argument(1)),
    ),
    "predictor of driving forces": (
        Switch("contact.adhesion.gradient_flow:_predictor", returning(None)),
    ),
    "guide of Dugdale's law by JKR": (
        Switch("contact.adhesion.jkr_guide:before_advanced", returning(None)),
    ),
    "guide of Dugdale's law by a grid": (
        Switch("contact.adhesion.cohesive_flow:guide_of", returning(None)),
    ),
    "rough rounds for many zones": (
        Switch("contact.search.topology.loop:ROUGH", with_fields(min_intervals=10**9)),
    ),
    "a looser grid for many zones": (
        Switch("contact.search.grid.nested_grids:OPTIONS", with_fields(many_features=10**9)),
    ),
    "a coarser grid as the start of a finer one": (
        Switch("contact.search.grid.nested_grids:_refine", returning(None)),
    ),
    "preconditioner of a grid": (
        Switch("contact.search.grid.conjugate_gradient:_Extension.precondition", _residual_itself),
    ),
    "narrow zones of a grid as Hertz contacts": (
        Switch("contact.search.grid.nested_grids:_hertz", _whole_cells),
    ),
    "gaps between the points of a grid": (
        Switch("contact.search.grid.nested_grids:_gaps_between", returning(np.empty((0, 2)))),
    ),
    "zones between the points of a grid": (
        Switch("contact.search.grid.nested_grids:_zones_between", returning(np.empty((0, 2)))),
    ),
    "foreseen snap into full contact": (
        Switch("contact.adhesion.full_contact:closing_foreseen", _no_context),
    ),
}

COLUMNS = (
    "off",
    "ordinary scenes lost",
    "others changed",
    "time, all",
    "large scenes lost",
    "others changed",
    "time, all",
    "extreme scenes within",
    "time, all",
)


# Tolerance of the ordinary scenes.
TOLERANCE = 1e-8


def ordinary_scenes(count: int = 91, first: int = 10_000) -> list[contact.Scene]:
    """`count` random scenes, drawn from seeds that begin at `first`, and four adhesive scenes."""
    scenes: list[contact.Scene] = []
    seed = first
    while len(scenes) < count:
        one = draw(seed)
        if isinstance(one, Drawn):
            scenes.append(one.scene)
        seed += 1
    return scenes + [adhesive_scene(seed) for seed in range(4)]


def adhesive_scene(seed: int) -> contact.Scene:
    """A scene of a rough trace of 400 points under JKR's or Dugdale's law, with E* = 1 Pa."""
    rng = np.random.default_rng([5, seed])
    heights = self_affine_heights(rng, 400, 0.8, longest=10 + 5 * seed)
    period = 1.0
    profile = contact.Sampled(np.arange(400) / 400, 1e-4 * heights, period=period)
    slope = 1e-4 * float(np.std(np.gradient(heights, 1 / 400)))
    mean_pressure = 0.1 * slope
    work = 0.03 * mean_pressure**2 * period
    law = contact.JKR(work) if seed % 2 else contact.Dugdale(work, 0.5 * slope)
    return contact.Scene(profile, 1.0, contact.Periodic(), law=law, mean_pressure=mean_pressure)


def large_scenes() -> list[tuple[contact.Scene, float]]:
    """Scenes with many zones or many knots in a zone, and the tolerance of each.

    The first profile has so many waves that its grid is coarse. The second scene has a given
    contact fraction, and the third one 3,000 knots in one zone. Each trace is solved without and
    with a limit of the pressure, the hardness. It is 1.5 or 3 times the mean pressure.
    """
    waves = Large("waves", partial(self_affine, 40_000), "mean_pressure", 0.005)
    fraction = Large("fraction", partial(self_affine, 300), "contact_fraction", 0.85)
    x = np.linspace(-1.0, 1.0, 3001)
    parabola = contact.Scene(contact.Sampled(x, -0.5 * x * x), 1.0, contact.Isolated(), load=0.7)
    scenes = [(waves.scene(), waves.tol), (fraction.scene(), fraction.tol), (parabola, 1e-8)]
    for kind, points, hardness in (
        ("white_noise", 5_000, 3.0),
        ("plateaus", 5_000, 1.5),
        ("texture", 5_000, 1.5),
        ("rough", 5_000, 3.0),
        ("rough", 10_000, 1.5),
    ):
        scene = Large(kind, partial(trace_of_kind, kind, points), "full", 0.1).scene()
        limit = contact.Plastic(hardness * float(scene.mean_pressure or 0.0))
        scenes += [(scene, 1e-6), (replace(scene, law=limit), 1e-6)]
    return scenes


def solved(scene: contact.Scene, patience: float, tolerance: float = TOLERANCE) -> dict[str, Any]:
    """Solve a scene to a tolerance; return the outcome, zones, error and seconds."""
    found: dict[str, Any] = {"solved": False, "zones": [], "error": 0.0}
    start = time.process_time()
    try:
        solution = clock.limited(lambda: contact.solve(scene, tol=tolerance), patience)
        found |= {"solved": True, "zones": solution.zones.tolist(), "error": solution.error}
    except (contact.ContactError, clock.TooLong, ArithmeticError, ValueError):
        pass
    return found | {"seconds": time.process_time() - start}


def measure(name: str, patience: float, ordinary_only: bool) -> dict[str, Any]:
    """Solve all scenes with the named mechanism off; if `name` is empty, with all mechanisms on."""
    for switch in MECHANISMS.get(name, ()):
        switch.apply()
    with unwarned():
        ordinary = [solved(one, patience) for one in ordinary_scenes()]
        scenes = [] if ordinary_only else large_scenes()
        large = [solved(scene, 5 * patience, tolerance) for scene, tolerance in scenes]
        cases = [] if ordinary_only else matrix(quick=True)
        verdicts = [stability.run(case, patience) for case in cases]
    extreme = [
        {"within": one.outcome in ("pass", "undecided"), "seconds": one.seconds} for one in verdicts
    ]
    return {"ordinary": ordinary, "large": large, "extreme": extreme}


def changed(one: dict[str, Any], other: dict[str, Any]) -> bool:
    """Whether the zone ends of two solutions differ by more than the sum of their stated errors.

    Differences are relative to the widths of the zones.
    """
    zones, others = np.array(one["zones"]), np.array(other["zones"])
    if zones.shape != others.shape:
        return True
    if zones.size == 0:
        return False
    width = np.diff(zones, axis=1)
    return bool((np.abs(zones - others) / width).max() > one["error"] + other["error"] + 1e-13)


def compared(on: list[dict[str, Any]], off: list[dict[str, Any]]) -> tuple[str, str, Array]:
    """(number of scenes lost, number of scenes changed, seconds with and without the mechanism).

    The seconds (n, 2) are those of the scenes that are solved both with and without it.
    """
    pairs = list(zip(on, off, strict=True))
    both = [(a, b) for a, b in pairs if a["solved"] and b["solved"]]
    lost = sum(a["solved"] and not b["solved"] for a, b in pairs)
    seconds = np.array([(a["seconds"], b["seconds"]) for a, b in both])
    return str(lost), str(sum(changed(a, b) for a, b in both)), seconds


def ratio(seconds: Array) -> str:
    """The time of all scenes without a mechanism, divided by the time with it."""
    on, off = seconds.sum(axis=0)
    return f"{off / on:.2f}"


def row(name: str, on: dict[str, Any], off: dict[str, Any]) -> tuple[str, ...]:
    """Return the table row of a mechanism, from the results `on` with it and `off` without it."""
    lost, others, seconds = compared(on["ordinary"], off["ordinary"])
    cells = [lost, others, ratio(seconds)]
    if not off["extreme"]:
        return (name, *cells, "not run", "", "", "not run", "")
    lost, others, seconds = compared(on["large"], off["large"])
    within = sum(one["within"] for one in off["extreme"])
    extremes = [sum(one["seconds"] for one in run["extreme"]) for run in (on, off)]
    return (
        name,
        *cells,
        *(lost, others, ratio(seconds)),
        *(f"{within} of {len(off['extreme'])}", f"{extremes[1] / extremes[0]:.2f}"),
    )


def main(names: list[str], options: list[str], out: Path | None) -> None:
    """Measure the named mechanisms. As a run takes long, the table is published after each one."""

    def run(name: str) -> dict[str, Any]:
        return measured("contact.studies.ablation", "--one", name, *options)

    with ThreadPoolExecutor(2) as pool:
        # Two runs at a time. The first two have all mechanisms on: their difference shows by how
        # much times differ at random.
        runs = pool.map(run, ("", "", *names))
        on, rows = next(runs), []
        for name, off in zip(("nothing", *names), runs, strict=True):
            rows.append(row(name, on, off))
            publish(Table("ablation", "each mechanism off in turn", COLUMNS, rows), [], out)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", nargs="+", choices=list(MECHANISMS), default=list(MECHANISMS))
    parser.add_argument("--patience", type=float, default=10.0, help="seconds for one scene")
    parser.add_argument("--ordinary", action="store_true", help="only ordinary scenes")
    parser.add_argument("--one", help="measure one mechanism and print its figures")
    parser.add_argument("--out", type=Path)
    given = parser.parse_args()
    if given.one is not None:
        print(json.dumps(measure(given.one, given.patience, given.ordinary)))
    else:
        options = ["--patience", str(given.patience), *(["--ordinary"] if given.ordinary else [])]
        main(given.only, options, given.out)
