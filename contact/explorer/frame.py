"""One frame of the page: a scene is solved, and what is drawn and said of it comes out; or a
message, where it cannot be. Its load curve comes a point at a time, so that the page goes on
answering while it is drawn.
"""

import time
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from contact.errors import ContactError, NotConverged, unwarned
from contact.explorer.handles import Handle
from contact.model.scene import Scene
from contact.model.units import prefix, quantity
from contact.solution.sampling import (
    on_zones,
    positions,
    surfaces,
    top_pressure,
    window,
    zones_within,
)
from contact.solution.solution import Solution
from contact.solver import solve
from contact.sweeps.curve import Curve
from sie import Array

POINTS = 4000  # of a stretch: a few on each pixel column of a screen
FEW = 500  # while a hand moves: one on every second column, and those at the ends of the zones
_FLANK = 0.6  # how far beyond the rest a body without end is drawn


@dataclass(frozen=True)
class Frame:
    """What is drawn of a solution, in the units of its names.

    fields: rows of x, heights of the body, of the deformed surface, of both where they touch, and
    pressure; zones: rows of ends; names: of x, heights and pressure.
    """

    solution: Solution
    seconds: float
    fields: Array
    zones: Array
    names: tuple[str, str, str]


def solved(
    scene: Scene, tol: float, near: Solution | None, branch: str, points: int = POINTS
) -> Frame:
    """The frame of a scene. near: the last solution, from whose zones the search starts where they
    are of the same shape.
    """
    start = time.perf_counter()
    alike = near is not None and all(
        getattr(near.scene, part) == getattr(scene, part) for part in _PARTS
    )
    with unwarned():
        solution = solve(
            scene, tol=tol, near=near if alike and not scene.law.pulls else None, branch=branch
        )
    return drawn(solution, time.perf_counter() - start, points)


_PARTS = ("profile", "interaction", "substrate", "law")


def drawn(solution: Solution, seconds: float, points: int = POINTS) -> Frame:
    """The fields of a solution, where straight lines between the places show them, as far as so
    many do.
    """
    lo, hi = window(solution)
    x = positions(solution, lo, hi, points)
    surface, body = surfaces(solution, x)
    pressure = solution.pressure(x)
    zones = zones_within(solution, lo, hi)
    seen, below = np.isfinite(body), np.isfinite(surface)
    low, high = (
        min(surface[below].min(), body[seen].min()),
        max(surface[below].max(), body[seen].max()),
    )
    # A body with sharp corners goes on without end beside them.
    body, surface = (
        np.where(seen, body, high + _FLANK * (high - low)),
        np.where(below, surface, low - _FLANK * (high - low)),
    )
    along, up = (
        prefix(max(abs(lo), abs(hi))),
        prefix(max(high - low, 1e-3 * max(abs(low), abs(high)))),
    )
    top = top_pressure(solution)
    push = prefix(
        float(np.max(np.abs(pressure[np.isfinite(pressure)]), initial=0.0)) if top <= 0 else top
    )
    # Where it is infinite, at corners and under adhesion, the line is cut.
    shown = np.clip(
        np.nan_to_num(pressure, nan=0.0, posinf=2 * top, neginf=-2 * top),
        -1.5 * abs(top),
        1.5 * abs(top),
    )
    touching = np.where(on_zones(x, zones), surface, np.nan)
    fields = np.array(
        [x * along[0], body * up[0], surface * up[0], touching * up[0], shown * push[0]]
    )
    names = f"x [{along[1]}m]", f"height [{up[1]}m]", f"pressure [{push[1]}Pa]"
    return Frame(solution, seconds, fields, zones * along[0], names)


def numbers(frame: Frame) -> list[tuple[str, str]]:
    """What is said of a solution, by name."""
    solution = frame.solution
    zones = len(solution.zones)
    said = [
        ("stated error, at most", f"{solution.error:.1e}"),
        (
            "certificate",
            "holds"
            if solution.certificate.holds
            else f"does not hold: {solution.certificate.to_dict()['note']}",
        ),
        ("load", quantity(solution.load, "N/m", 6)),
        ("mean pressure", quantity(solution.mean_pressure, "Pa", 6, none="")),
        ("highest pressure", quantity(solution.max_pressure, "Pa", 6)),
        ("approach", quantity(solution.approach, "m", 6, none="")),
        (
            "in contact",
            "" if solution.contact_fraction is None else f"{100 * solution.contact_fraction:.6g} %",
        ),
        ("zones", str(zones) if zones else "full contact"),
        (
            "width of the zones",
            quantity(float(np.sum(solution.zone_widths)), "m", 6) if zones else "",
        ),
        ("solved in", quantity(frame.seconds, "s", 3)),
    ]
    return [(name, value) for name, value in said if value]


def told(error: Exception) -> str:
    """What is shown in place of a solution."""
    if isinstance(error, NotConverged) and isinstance(error.best, Solution):
        return f"{error}. The best that was reached has a stated error of {error.best.error:.1e}; it is not drawn."
    if isinstance(error, ContactError):
        return str(error)
    return f"a fault of the program, not of the scene ({type(error).__name__}: {' '.join(str(error).split())})"


def place_on_curve(solution: Any) -> tuple[float, float, tuple[str, str], tuple[str, str]]:
    """Where a solution stands on its load curve: across, up, and for both what it is and its unit.

    Across the approach, or where there is none the width in contact; up the mean pressure, or where
    there is none the load.
    """
    up = (
        (solution.load, ("load", "N/m"))
        if solution.mean_pressure is None
        else (solution.mean_pressure, ("mean pressure", "Pa"))
    )
    if solution.approach is not None:
        return float(solution.approach), float(up[0]), ("approach", "m"), up[1]
    return float(np.sum(solution.zone_widths)), float(up[0]), ("width of the zones", "m"), up[1]


_VALUES = 33


def along(scene: Scene, control: Handle, tol: float, branch: str) -> Iterator[Solution]:
    """Solutions of a scene all along its control, upwards; values that have none are left out."""
    name = scene.control[0]
    values = (
        np.geomspace(control.low, control.high, _VALUES)
        if control.log
        else np.linspace(control.low, control.high, _VALUES)
    )
    # Under a law that pulls the branch matters, which each is solved on by itself.
    curve = None if scene.law.pulls else Curve(scene, name, tol)
    for value in values:
        try:
            with unwarned():
                here = (
                    curve.at(float(value))
                    if curve
                    else solve(scene.under(name, float(value)), tol=tol, branch=branch)
                )
        except ContactError:
            continue
        yield here
        if len(here.zones) == 0:
            return  # full contact: nothing more happens


def same_curve(one: Scene, other: Scene) -> bool:
    """Whether two scenes differ in the value of their control only."""
    name, value = other.control
    return one.control[0] == name and one.under(name, value) == other
