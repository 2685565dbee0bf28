"""One frame of the page: the solution of a scene as numbers and curves, or an error message.

The load curve is computed one point at a time, so that the page stays responsive.
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
    POINTS,
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


@dataclass(frozen=True)
class FrameOptions:
    """Resolution of the curves in a frame."""

    # Number of points of a curve while a slider moves, one for every second pixel column. More
    # points are added at the ends of zones.
    points_while_moving: int = 500


OPTIONS = FrameOptions()


@dataclass(frozen=True)
class Frame:
    """The curves of a solution, in the units that `names` gives.

    fields: rows of x, heights of the body, heights of the deformed surface, heights in contact, and
    pressure; zones: rows of ends; names: labels of x, height and pressure.
    """

    solution: Solution
    seconds: float
    fields: Array
    zones: Array
    names: tuple[str, str, str]


def solved(
    scene: Scene,
    tol: float,
    previous: Solution | None,
    branch: str,
    points: int = POINTS.screen_points,
) -> Frame:
    """Solve a scene and return its frame.

    The search starts from the previous solution if only the control has changed.
    """
    start = time.perf_counter()
    same_parts = previous is not None and all(
        getattr(previous.scene, part) == getattr(scene, part) for part in _PARTS
    )
    with unwarned():
        warm_start = previous if same_parts and not scene.law.pressure_range.has_tension else None
        solution = solve(scene, tol=tol, near=warm_start, branch=branch)
    return drawn(solution, time.perf_counter() - start, points)


_PARTS = ("profile", "interaction", "substrate", "law")


def drawn(solution: Solution, seconds: float, points: int = POINTS.screen_points) -> Frame:
    """The frame of a solution, with about `points` points in its curves."""
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
    # A flat punch is infinitely high outside its corners. Its walls are drawn as high as the range
    # of all other heights.
    span = high - low
    body, surface = np.where(seen, body, high + span), np.where(below, surface, low - span)
    along, up = (
        prefix(max(abs(lo), abs(hi))),
        prefix(max(high - low, 1e-3 * max(abs(low), abs(high)))),
    )
    top = top_pressure(solution)
    push = prefix(
        float(np.max(np.abs(pressure[np.isfinite(pressure)]), initial=0.0)) if top <= 0 else top
    )
    # The pressure is infinite at corners and at adhesive ends: the curve of the pressure is cut off
    # there.
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
    """Names and values of the numbers shown for a solution, as text."""
    solution = frame.solution
    zones = len(solution.zones)
    rows = [
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
    return [(name, value) for name, value in rows if value]


def message(error: Exception) -> str:
    """The text that the page shows instead of a solution if `error` was raised."""
    if isinstance(error, NotConverged) and isinstance(error.best, Solution):
        return (
            f"{error}. The best that was reached has a stated error of {error.best.error:.1e}; "
            "it is not drawn."
        )
    if isinstance(error, ContactError):
        return str(error)
    text = " ".join(str(error).split())
    return f"a fault of the program, not of the scene ({type(error).__name__}: {text})"


def place_on_curve(solution: Any) -> tuple[float, float, tuple[str, str], tuple[str, str]]:
    """The point of a solution on the load curve: abscissa, ordinate, and their names and units.

    Names and units are two pairs (name, unit).

    The abscissa is the approach, or the width in contact if there is no approach. The ordinate is
    the mean pressure, or the load without a period.
    """
    up = (
        (solution.load, ("load", "N/m"))
        if solution.mean_pressure is None
        else (solution.mean_pressure, ("mean pressure", "Pa"))
    )
    if solution.approach is not None:
        return float(solution.approach), float(up[0]), ("approach", "m"), up[1]
    return float(np.sum(solution.zone_widths)), float(up[0]), ("width of the zones", "m"), up[1]


def load_curve(
    scene: Scene, control: Handle, tol: float, branch: str, points: int = 33
) -> Iterator[Solution]:
    """Solutions at increasing values of the control.

    points: number of values. Values without a solution are left out.
    """
    name = scene.control[0]
    spaced = np.geomspace if control.log else np.linspace
    values = spaced(control.low, control.high, points)
    # Under adhesion each value is solved without the previous solution, on the chosen branch.
    curve = None if scene.law.pressure_range.has_tension else Curve(scene, name, tol)
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
    """Whether two scenes differ only in the value of their control.

    Then they have the same load curve.
    """
    name, value = other.control
    return one.control[0] == name and one.under(name, value) == other
