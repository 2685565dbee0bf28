"""One frame of the page: the solution of a scene as numbers and curves, or an error message."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from contact.errors import ContactError, NotConverged, unwarned
from contact.explorer.handles import Handle
from contact.extras import require
from contact.model.scene import Scene
from contact.model.units import quantity, scaled
from contact.search.topology.loop import Progress
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
from contact.sweeps.curve import Curve
from contact.sweeps.path import path
from sie import Array


@dataclass(frozen=True)
class FrameOptions:
    """Numbers of points and tolerances for the pictures and load curves of the page."""

    # Number of points of a curve while a slider moves: one for every second column of pixels. More
    # points are added at the ends of contact zones.
    points_while_moving: int = 500
    # Tolerance while a slider moves. Four digits are shown, and a picture shows three.
    tol_while_moving: float = 1e-4
    curve_points: int = 33  # points of a load curve, and of each branch under adhesion
    max_text: int = 20_000  # longest scene file that the page shows [characters]


OPTIONS = FrameOptions()
_LARGEST = "contact.inside.largest"
_YIELDING = "contact.inside.yielding"
_STRESSES = "contact.solution.stress_report"
_REPORT = "contact.solution.report"


@dataclass(frozen=True)
class Frame:
    """One picture of a solution: the curves of body, surface, contact and pressure.
    All are in the units of the axes, which `names` states.

    fields: rows of x, heights of the body, heights of the deformed surface, heights in contact, and
    pressure; zones: rows of ends; names: labels of x, height and pressure. details: other numbers
    of the pictures, see `drawn`.
    """

    solution: Solution
    fields: Array
    zones: Array
    names: tuple[str, str, str]
    details: Mapping[str, Any]


def drawn(
    solution: Solution,
    points: int = POINTS.screen_points,
    stretch: tuple[float, float] | None = None,
) -> Frame:
    """The curves of a solution for the picture, with about `points` points each.
    If `stretch` is given, as many points are added in this enlarged interval of x [m].

    The details of the result are `along` (units of x per metre), the lowest and largest pressure of
    the picture, the mean pressure, and the places at which the pressure is infinite.
    """
    lo, hi = window(solution)
    x = positions(solution, lo, hi, points)
    if stretch is not None:
        near = positions(solution, *stretch, points)
        x = np.union1d(x, near[(near > lo) & (near < hi)])
    surface, body = surfaces(solution, x)
    pressure = solution.pressure(x)
    zones = zones_within(solution, lo, hi)
    seen, below = np.isfinite(body), np.isfinite(surface)
    low, high = (
        min(surface[below].min(), body[seen].min()),
        max(surface[below].max(), body[seen].max()),
    )
    # Outside its corners, a flat punch is infinitely high. The walls of the punch are drawn as high
    # as the range of all other heights.
    span = high - low
    body, surface = np.where(seen, body, high + span), np.where(below, surface, low - span)
    along = scaled(max(abs(lo), abs(hi)), "m")
    up = scaled(max(high - low, 1e-3 * max(abs(low), abs(high))), "m")
    top = top_pressure(solution)
    size = float(np.max(np.abs(pressure[np.isfinite(pressure)]), initial=0.0))
    push = scaled(size if top <= 0 else top, "Pa")
    rising, falling = _infinite(solution, x, pressure, zones)
    # The pressure is infinite at corners and at adhesive ends, so its curve is cut off there.
    # Infinite tension is drawn as far below zero as the highest pressure is above zero.
    lowest = -abs(top) if len(falling) else float(np.nanmin(pressure, initial=0.0))
    shown = np.clip(np.nan_to_num(pressure, nan=0.0), 1.5 * lowest, 1.5 * abs(top))
    touching = np.where(on_zones(x, zones), surface, np.nan)
    fields = np.array(
        [x * along[0], body * up[0], surface * up[0], touching * up[0], shown * push[0]]
    )
    names = f"x [{along[1]}]", f"height [{up[1]}]", f"pressure [{push[1]}]"
    details = {
        "along": along[0],
        "range": [push[0] * lowest, push[0] * abs(top)],
        "mean": None if solution.mean_pressure is None else push[0] * solution.mean_pressure,
        "rising": (rising * along[0]).tolist(),
        "falling": (falling * along[0]).tolist(),
    }
    return Frame(solution, fields, zones * along[0], names, details)


def _infinite(solution: Solution, x: Array, pressure: Array, zones: Array) -> tuple[Array, Array]:
    """Places in the picture at which the pressure tends to plus and to minus infinity."""
    rising = np.isposinf(pressure)
    if np.isinf(solution.max_pressure):
        kinks = solution.scene.profile.kinks
        tips = kinks[kinks[:, 1] > 0, 0]
        period = solution.scene.period
        if period is not None:
            tips = (tips[:, None] + period * np.array([-1.0, 0.0, 1.0])).ravel()
        tips = tips[on_zones(tips, zones)]
    else:
        tips = np.zeros(0)
    inside = (tips >= x[0]) & (tips <= x[-1])
    falling = zones.ravel() if solution.fields.problem.end.intensity else x[np.isneginf(pressure)]
    falling = falling[(falling > x[0]) & (falling < x[-1])]
    return np.union1d(x[rising], tips[inside]), np.unique(falling)


def numbers(frame: Frame, seconds: float, most: int = 6) -> list[tuple[str, str]]:
    """(name, value as text) of each number that the page shows for a solution.
    A value has the bound of its error and the digits that this bound allows, up to `most`.
    """
    solution = frame.solution
    zones = len(solution.zones)
    known = require(_REPORT).quantities(solution, most)
    rows = [
        ("stated error, at most", f"{solution.error:.0e}"),
        (
            "certificate",
            "holds"
            if solution.certificate.holds
            else f"does not hold: {solution.certificate.to_dict()['note']}",
        ),
        *((name, _with_bound(value, error)) for name, value, error in known),
        ("zones", str(zones) if zones else "full contact" if solution.contact_fraction else "none"),
        ("E*", quantity(solution.scene.E_star, "Pa")),
        ("solved in", quantity(seconds, "s", 3)),
    ]
    return [(name, value) for name, value in rows if value]


def _with_bound(value: str, error: str) -> str:
    """A value and the bound of its error, of the same unit, as text such as "1.07 ± 0.02 µm".
    The value alone if the error is a word, such as "given".
    """
    return f"{value.split()[0]} ± {error}" if error[0].isdigit() else value


@dataclass(frozen=True)
class Below:
    """The stress below the surface as the page draws it: values on a grid, and how to show them.

    values: rows of stresses [Pa] at the middles of equal cells, NaN where the stress is infinite;
    details: the rectangle in the units of the x axis, the kind of stress, and the largest stress
    with its place.
    """

    values: Array
    details: Mapping[str, Any]


def below(
    solution: Solution,
    kind: str,
    nu: float,
    stretch: tuple[float, float] | None,
    columns: int,
    find_largest: bool,
) -> Below:
    """The stress below the surface on a grid of `columns` columns, to be drawn as a picture.

    kind: "mises" for the von Mises stress, else the largest shear stress in the plane;
    stretch: interval of x [m], None for all; find_largest: whether the largest stress of the body
    is found, too.
    """
    report = require(_STRESSES)
    lo, hi = stretch or window(solution)
    depth = report.depth_of(solution, lo, hi)
    size = (hi - lo) / columns
    rows = max(1, round(depth / size))
    x = lo + size * (np.arange(columns) + 0.5)
    y = depth * (np.arange(rows) + 0.5) / rows
    stress = solution.stress(x, y[:, None])
    value = stress.mises(nu) if kind == "mises" else stress.shear
    value = np.where(np.isfinite(value), value, np.nan)
    peak, top = None, float(np.nanmax(value, initial=0.0))
    infinite = require(_YIELDING).infinite_at(solution) is not None
    if infinite:
        top = float(np.nanquantile(value, 0.995))
    elif find_largest:
        largest = require(_LARGEST)
        name = "mises" if kind == "mises" else "shear"
        found = largest.largest(solution, largest.Criterion(name, nu, "as loaded"))
        peak, top = found, found.stress
    along = scaled(max(abs(end) for end in window(solution)), "m")
    details: dict[str, Any] = {
        "kind": kind,
        "low": lo * along[0],
        "high": hi * along[0],
        "depth": depth * along[0],
        "top": top,
        "infinite": infinite,
    }
    if peak is not None:
        details["peak"] = [peak.x * along[0], peak.y * along[0]]
        name = "largest von Mises" if kind == "mises" else "largest shear"
        details["rows"] = [
            [name, quantity(peak.stress, "Pa")],
            ["its depth", quantity(peak.y, "m")],
        ]
    return Below(value, details)


def message(error: Exception) -> str:
    """The text that the page shows instead of a solution if `error` was raised."""
    if isinstance(error, NotConverged) and isinstance(error.best, Solution):
        return (
            f"{error}. The most accurate solution has a stated error of {error.best.error:.1e}; "
            "it is not drawn."
        )
    if isinstance(error, ContactError):
        return str(error)
    text = " ".join(str(error).split())
    return f"an error of the program, not of the scene ({type(error).__name__}: {text})"


def place_on_curve(solution: Any) -> tuple[float, float, tuple[str, str], tuple[str, str]]:
    """The point of a solution on the load curve, with the names and units of the axes.
    Returns (abscissa, ordinate, (name, unit) of the abscissa, (name, unit) of the ordinate). The
    abscissa is the approach, or the width in contact if there is no approach. The ordinate is the
    mean pressure, or the load without a period.
    """
    up = (
        (solution.load, ("load", "N/m"))
        if solution.mean_pressure is None
        else (solution.mean_pressure, ("mean pressure", "Pa"))
    )
    if solution.approach is not None:
        return float(solution.approach), float(up[0]), ("approach", "m"), up[1]
    return float(np.sum(solution.zone_widths)), float(up[0]), ("width in contact", "m"), up[1]


# A point of a load curve: abscissa, ordinate and, if it is known, the slope of the curve.
Point = list[float | None]


def point_of(solution: Solution) -> Point:
    """The point of a solution on the load curve.
    The slope of the curve is added if the abscissa is the approach and the slope is known.
    """
    across, up, *_ = place_on_curve(solution)
    slope = solution.stiffness
    if slope is None or not np.isfinite(slope):
        return [across, up, None]
    return [across, up, slope if solution.scene.period is None else slope / solution.scene.period]


def load_curve(scene: Scene, control: Handle, tol: float, progress: Progress) -> Iterator[Solution]:
    """Solutions at increasing values of the controlled quantity, such as the load.
    Values without a solution are left out.

    Points are close together where loads are small, where the curve bends most.
    """
    name = scene.control[0]
    least = 1e-5 * control.high if control.low > 0 else control.low
    share = np.linspace(0.0, 1.0, OPTIONS.curve_points)
    values = least + (control.high - least) * share**2
    curve = Curve(scene, name, tol, progress)
    for value in values:
        try:
            with unwarned():
                here = curve.at(float(value))
        except ContactError:
            continue
        yield here
        if len(here.zones) == 0:
            return  # full contact: nothing more happens


@dataclass(frozen=True)
class Branches:
    """The load curve of surfaces that adhere, as lines of points with jumps between the lines.

    advancing, receding: the lines under a rising and under a falling control; jumps: pairs of
    points, before and after each jump.
    """

    advancing: list[list[Point]]
    receding: list[list[Point]]
    jumps: list[list[Point]]


def both_branches(scene: Scene, control: Handle, tol: float, progress: Progress) -> Branches:
    """The load curve for increasing and then decreasing control, with every jump.

    The highest value is lowered until it has a solution. For example, an approach has a solution
    only up to full contact.
    """
    name, high = scene.control[0], control.high
    while True:
        rising = np.linspace(control.low, high, OPTIONS.curve_points)
        try:
            with unwarned():
                found = path(
                    scene, np.concatenate((rising, rising[-2::-1])), tol, progress, control=name
                )
            break
        except ContactError:
            if high - control.low < 1e-2 * (control.high - control.low):
                raise
            high = control.low + 0.8 * (high - control.low)
    per_load = 1.0 if scene.period is None else 1 / scene.period
    lines: dict[bool, list[list[Point]]] = {True: [[]], False: [[]]}
    jumps: list[list[Point]] = []
    turn = len(rising) - 1
    abscissa = place_on_curve(found.solutions[turn])[2]
    for place, (solution, events) in enumerate(zip(found.solutions, found.passed, strict=True)):
        branch = lines[place <= turn]
        for event in events:
            ends = [[across, load * per_load, None] for across, load in _sides(event, abscissa[0])]
            if any(across is None for across, *_ in ends):
                branch.append([])
            elif not np.allclose(ends[0][:2], ends[1][:2], rtol=1e-6, atol=0.0):
                branch[-1].append(ends[0])
                branch.append([ends[1]])
                jumps.append(ends)
        if place_on_curve(solution)[2] == abscissa:
            branch[-1].append(point_of(solution))
        if place == turn:
            lines[False][-1].append(point_of(solution))
    advancing, receding = ([line for line in lines[way] if len(line) > 1] for way in (True, False))
    return Branches(advancing, receding, jumps)


def _sides(event: Any, abscissa: str) -> list[tuple[Any, float]]:
    """(abscissa, load) just before and just after an event, such as a jump, on a loading path."""
    if abscissa == "approach":
        ways = getattr(event, "approach", None), getattr(event, "approach_after", None)
    else:
        ways = float(np.diff(event.before).sum()), float(np.diff(event.after).sum())
    loads = float(event.load), float(getattr(event, "load_after", event.load))
    return [
        (None if way is None else float(way), load) for way, load in zip(ways, loads, strict=True)
    ]


def same_curve(one: Scene, other: Scene) -> bool:
    """Whether two scenes differ only in the value of their control, such as the load.

    Then they have the same load curve.
    """
    name, value = other.control
    return one.control[0] == name and one.under(name, value) == other
