r"""Zones proposed by a contact on grids, refined until zones and gaps are a few cells wide.

The grid (contact.search.grid.conjugate_gradient) gives the number of zones, and their ends to a
fraction of a cell; Newton's method then makes them exact. At a small distance d from an end the
pressure p is proportional to sqrt(d). So p^2 is linear in d, and its zero is extrapolated from the
points. A zone of one or two cells is taken as a Hertz contact: its load P and the curvature 1/R of
the gap give its half width 2 sqrt(P R / (pi E)).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy.fft
from numpy.typing import ArrayLike, NDArray

from contact.errors import OutOfRange
from contact.formulation.tables import in_cell, runs_of
from contact.formulation.tolerances import TOLERANCES
from contact.model.plugin_checks.declarations import require_numbers
from contact.model.profiles.base import Profile
from contact.model.profiles.noise import EPS
from contact.search.grid.conjugate_gradient import GridState, Response, own_displacement, solve_grid
from contact.search.options import SEARCH
from contact.search.topology.intervals import (
    NARROW,
    distance_to_nearest,
    half_width_of_new,
    without,
)
from contact.verify.minima import SAMPLING
from sie import Array, record

Height = Callable[[Array], ArrayLike]


@dataclass(frozen=True)
class NestedGridOptions:
    """Options for the numbers of points of the nested grids."""

    coarsest: int = 64  # points of the first grid
    # Number of grid cells in the smallest length over which a shape varies. The pressure has up to
    # about 6 zeros in such a length.
    per_feature: int = 16
    # If the period or window is longer than this many smallest lengths, each length gets only half
    # as many cells, to save time. About one zone in a hundred then contains no point in contact.
    # Two thirds of these zones are found between the points, the others by the first check of the
    # signs of pressure and gap.
    many_features: int = 2**15

    @property
    def window_points(self) -> int:
        """Number of grid points in the search interval (window) of an isolated contact."""
        return 2 * self.coarsest


@dataclass(frozen=True)
class WindowOptions:
    """Option of the search for a window, an interval that an isolated contact fills well."""

    # Width of the contact divided by the width of the next window. A window is accepted if the
    # contact fills at least half and at most twice this fraction of the window.
    filled: float = 0.375


OPTIONS = NestedGridOptions()
WINDOW = WindowOptions()
MOST_POINTS = 2**23  # largest number of points of the last grid: 64 MB for each array


class NoWindow(OutOfRange):
    """Raised if the contact reaches the border of the window, however wide the window is."""


@record
class Proposal:
    """Zones from which Newton's method starts, with the grid on which they were found.

    zones: (n, 2) [m]. points: number of points of the last grid. touches_border: whether contact
    touches the border of the known part of the profile. grid: the contact on the last grid.
    """

    zones: Array
    points: int
    full: bool
    touches_border: bool
    grid: GridState | None = field(default=None, repr=False)

    @property
    def width(self) -> float:
        """Total width of the zones [m]; inf in full contact."""
        return np.inf if self.full else float(np.sum(self.zones[:, 1] - self.zones[:, 0]))

    @property
    def load(self) -> float:
        """Load of the contact on the grid [N/m]; nan if `grid` is None."""
        return np.nan if self.grid is None else self.grid.load

    @property
    def state(self) -> GridState:
        """The contact on the last grid; `grid` must not be None."""
        assert self.grid is not None
        return self.grid


def grid_height(profile: Profile, x: Array) -> Array:
    """Heights f of the profile at evenly spaced, ascending points, up to a constant.

    Where rounding hides the differences of f, its slope is integrated instead. Near a summit f
    varies with the square of the distance and f' with the distance, so that f' keeps more digits.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        f = np.asarray(profile.height(x), dtype=np.float64)
        size, range_ = np.max(np.abs(f)), np.ptp(f)
        if not range_ < 1e8 * EPS * size:  # rounding leaves eight digits of the differences of f
            return f
        ends, middle = (
            np.asarray(profile.slope(x)),
            np.asarray(profile.slope(0.5 * (x[1:] + x[:-1]))),
        )
    rise = np.diff(x) * (ends[:-1] + 4 * middle + ends[1:]) / 6
    return np.concatenate(([0.0], np.cumsum(rise)))


def _midpoints(cell: tuple[float, float], n: int) -> Array:
    """The midpoints of n equal parts of the interval `cell`."""
    return np.asarray(cell[0] + (cell[1] - cell[0]) / n * (np.arange(n) + 0.5), dtype=np.float64)


def narrowest(state: GridState) -> int:
    """Width of the narrowest zone or gap of a grid contact, in cells.

    It is n in full contact, and 0 without contact or if a gap may lie between two points.
    """
    n = state.influence.n
    wraps = state.influence.is_periodic
    runs = np.array(runs_of(state.contact, wraps)).reshape(-1, 2)
    if state.full:
        # Near its minimum the pressure p is about a parabola. If the smallest p is below the second
        # difference of p at this point, a gap may lie between the points.
        p, i = state.pressure, int(np.argmin(state.pressure))
        return n if p[i] > p[i - 1] - 2.0 * p[i] + p[(i + 1) % n] else 0
    if not len(runs):  # there is no contact, but the lowest point of a finer grid may touch
        return 0
    gaps = runs[1:, 0] - runs[:-1, 1] - 1
    if wraps:
        gaps = np.append(gaps, runs[0, 0] + n - runs[-1, 1] - 1)
    return int(min(np.min(runs[:, 1] - runs[:, 0] + 1), np.min(gaps, initial=n)))


def zones_of(state: GridState, x: ArrayLike, between_points: bool = False) -> Array:
    """Zones (k, 2) of a contact on the grid points x; an empty array in full contact.

    On a period, left ends ascend within the cell, and the last right end may lie beyond it.
    between_points: gaps that contain no point are cut out; the grid must resolve the pressure.
    """
    points = np.asarray(x, dtype=np.float64)
    h, n, E = state.influence.h, state.influence.n, state.influence.E
    if state.full:
        return np.empty((0, 2))
    wraps, x0 = state.influence.is_periodic, float(points[0])
    runs = np.array(runs_of(state.contact, wraps), dtype=np.intp).reshape(-1, 2)
    first, last = runs.T
    count, p = last - first + 1, state.pressure
    left, right = x0 + h * first, x0 + h * last
    before_last = np.maximum(last - 1, first)
    a = left - h * _to_end(p[first % n], p[(first + 1) % n])
    b = right + h * _to_end(p[last % n], p[before_last % n])
    for k in np.flatnonzero(count < NARROW):
        cells = np.arange(first[k], last[k] + 1) % n
        centre, half = _hertz(state, cells, int(first[k]), E)
        a[k], b[k] = x0 + h * centre - half, x0 + h * centre + half
    # The left and the right neighbour of the run of points in contact lie outside the zone. So
    # zones do not overlap.
    zones = np.column_stack((np.maximum(a, left - 0.999 * h), np.minimum(b, right + 0.999 * h)))
    if between_points:
        gaps = _gaps_between(points, state)
        zones = without(zones, np.concatenate((gaps, gaps + n * h)) if wraps else gaps)
    return in_cell(zones, x0 - 0.5 * h, n * h if wraps else None)


def _gaps_between(x: Array, state: GridState) -> Array:
    """Gaps (k, 2) between grid points, where a parabola through three pressures is negative.

    A gap gets the width that a single gap has if this parabola is the pressure of full contact.
    """
    p, h = state.pressure, state.influence.h
    # Outside the window of an isolated contact the pressure is zero.
    before, after = np.roll(p, 1), np.roll(p, -1)
    if not state.influence.is_periodic:
        before[0] = after[-1] = 0.0
    i = np.flatnonzero((p > 0.0) & (p <= before) & (p <= after))
    slope, bend = 0.5 * (after - before)[i], (before - 2.0 * p + after)[i]
    with np.errstate(divide="ignore", invalid="ignore"):
        pulls = 0.5 * slope**2 / bend - p[i]
    open_ = pulls > 0.0
    i, slope, bend, pulls = i[open_], slope[open_], bend[open_], pulls[open_]
    middle, half = (x[i] - h * slope / bend, h * np.minimum(2.0 * np.sqrt(pulls / bend), 0.5))
    return np.column_stack((middle - half, middle + half))


def _zones_between(x: Array, state: GridState) -> Array:
    """Zones (k, 2) between grid points, where a parabola through three gaps is negative.

    The overlap must exceed the error of the parabola. By the third difference of the gap, this
    error is at most 1/16 of the difference between adjacent second differences.
    """
    h, n = state.influence.h, state.influence.n
    touching = np.flatnonzero(state.contact)
    gap = np.where(state.contact, np.nan, state.gap)
    before, after = np.roll(gap, 1), np.roll(gap, -1)
    if not state.influence.is_periodic:
        before[0] = after[-1] = np.nan
    with np.errstate(invalid="ignore", divide="ignore"):
        bends = before - 2.0 * gap + after
        change = np.abs(bends - np.roll(bends, 1))
        slope, error = 0.5 * (after - before), np.fmax(change, np.roll(change, -1)) / 16.0
        overlap = 0.5 * slope**2 / bends - gap
        i = np.flatnonzero((gap <= before) & (gap <= after) & (overlap > error))
    around = np.concatenate((touching[-1:] - n, touching, touching[:1] + n))
    distance = distance_to_nearest(around, i)
    middle = x[i] - h * slope[i] / bends[i]
    half = h * np.minimum(half_width_of_new(np.sqrt(2.0 * overlap[i] / bends[i]), distance), 0.5)
    return np.column_stack((middle - half, middle + half))


def _to_end(p_end: Array, p_next: Array) -> Array:
    """Distance, in cells, from a zone's outermost point to its end, where p^2 would be zero.

    It is half a cell where p does not decrease towards the end.
    """
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        rise = (p_next / p_end) ** 2 - 1.0
        return np.where(rise > 0.0, np.minimum(1.0 / rise, 1.0), 0.5)


def _hertz(state: GridState, cells: NDArray[np.int64], first: int, E: float) -> tuple[float, float]:
    """Centre (in cells) and half width of a zone of one or two cells, taken as a Hertz contact."""
    h, n = state.influence.h, state.influence.n
    p = state.pressure[cells]
    load = float(p.sum()) * h
    around = np.arange(cells[0] - 1, cells[0] + len(cells) + 1)
    lag = np.subtract.outer(np.arange(-1.0, len(cells) + 1), np.arange(len(cells)))
    around = around % n if state.influence.is_periodic else np.clip(around, 0, n - 1)
    # Without the displacement by the zone's own pressure, the gap is about a parabola. The zone
    # lies at the vertex of this parabola, which may be a cell away from the points in contact.
    gap = state.gap[around] - own_displacement(lag, h, E) @ p
    with np.errstate(invalid="ignore"):
        bend = float(np.max(np.diff(gap, 2)))
    widest = 0.5 * (len(cells) + 1)
    if not (np.isfinite(bend) and bend > 0.0):
        return float(first + p @ np.arange(len(cells)) / p.sum()), 0.5 * len(cells) * h
    half = 2.0 * np.sqrt(load * h**2 / (np.pi * E * bend))
    slope = float(gap[-1] - gap[0]) / (len(cells) + 1)
    vertex = float(np.clip(-slope / bend, -widest, widest))
    return first + 0.5 * (len(cells) - 1) + vertex, float(min(half, widest * h))


@record
class Request:
    """Arguments of `propose`: load or level (displacement plus height), sizes of the grids.

    resolution: the smallest length of the shape. points: number of points of the last grid; None:
    as many as the resolution asks for, then doubled up to `max_points` while a zone or a gap is not
    resolved. start: a contact on the same cell, to begin with. between_points: see `zones_of`.
    """

    load: float | None = None
    level: float | None = None
    resolution: float | None = None
    points: int | None = None
    max_points: int = SAMPLING.max_points
    tol: float = 1e-8
    start: GridState | None = None
    between_points: bool = False


def propose(
    height: Height, cell: tuple[float, float], response: Response, **request: Any
) -> Proposal:
    """Contact zones of heights `height` in the period or window `cell`, from nested grids.

    request: fields of `Request`.
    """
    asked = Request(**request)
    width, tol, is_coarse = cell[1] - cell[0], asked.tol, False
    if asked.points is not None:
        target = limit = int(asked.points)
    else:
        target, limit = points_for(width, asked.resolution, asked.max_points)
        is_coarse = _features(width, asked.resolution) > OPTIONS.many_features
        if is_coarse:
            # A tolerance above `asked.tol` saves time. Wrong zones of the proposal are corrected in
            # the first check of the signs of pressure and gap.
            tol = max(tol, SEARCH.rough)
    n, start = target, None
    while n % 2 == 0 and n // 2 >= OPTIONS.coarsest and start is None:
        known = asked.start
        start = known.pressure if known is not None and len(known.pressure) == n else None
        n = n if start is not None else n // 2
    while True:
        x, h = _midpoints(cell, n), width / n
        f = np.asarray(height(x), dtype=np.float64)
        require_numbers(x, f)
        state = solve_grid(
            f,
            response.on(n, h),
            load=asked.load,
            level=asked.level,
            start=start,
            tol=tol if n >= target else max(tol, SEARCH.rough),
        )
        if n >= target and (narrowest(state) >= NARROW or 2 * n > limit):
            break
        n, start = 2 * n, _refine(state.pressure, response.periodic)
    zones = zones_of(state, x, asked.between_points)
    if is_coarse and state.converged:
        zones = np.concatenate((zones, _zones_between(x, state)))
        zones = in_cell(zones, cell[0], width if response.periodic else None)
    return Proposal(zones, n, state.full, state.touches_border, state)


def _features(width: float, resolution: float | None) -> float:
    """Width of a period or window, divided by `resolution`, the smallest length of the shape.
    A default number if this length is unknown.
    """
    return float(OPTIONS.per_feature) if resolution is None else width / resolution


def points_for(width: float, resolution: float | None, most: int) -> tuple[int, int]:
    """The number of grid points that a period or window needs, and the largest number allowed."""
    features = _features(width, resolution)
    per_feature = OPTIONS.per_feature
    if features > OPTIONS.many_features:
        per_feature //= 2
    target = _fast_size(max(4.0 * OPTIONS.coarsest, per_feature * features))
    # If the smallest length of the shape is known, as many points as resolve it are allowed. They
    # may be more than `most`, but not more than `MOST_POINTS`.
    limit = most if resolution is None else max(most, min(target, MOST_POINTS))
    return min(target, limit), limit


def _fast_size(least: float) -> int:
    """The number of points of the last of the nested grids: `least`, or slightly more.

    It is a fast length of the FFT: a number from `coarsest` to 2 `coarsest`, doubled several times.
    A power of two could be twice `least`. A transform of 2^19 points also takes three times as long
    as one of 320,000, as it uses the processor's cache badly.
    """
    doublings = int(math.log2(least / OPTIONS.coarsest))
    return int(scipy.fft.next_fast_len(math.ceil(least / 2**doublings), real=True)) << doublings


def _refine(p: Array, periodic: bool) -> Array:
    """The pressure p on a grid of twice as many points, by linear interpolation.

    The pressure is zero in cells beyond an end, where the extrapolation of p^2 is negative.
    """
    left, right = np.roll(p, 1), np.roll(p, -1)
    if not periodic:
        left[0], right[-1] = p[0], p[-1]
    out = np.stack((0.75 * p + 0.25 * left, 0.75 * p + 0.25 * right), axis=1)
    for side, outer, inner in ((-1, left, right), (1, right, left)):
        ends = np.flatnonzero((p > 0) & (outer == 0))
        # The nearest new point outside a zone lies 0.75 old cells from the zone's outermost old
        # point. If the extrapolated end of the zone is nearer, the pressure at the new point is 0.
        beyond = (ends[_to_end(p[ends], inner[ends]) < 0.75] + side) % len(p)
        out[beyond, 0 if side > 0 else 1] = 0.0
    return np.asarray(out.ravel(), dtype=np.float64)


def find_window(
    height: Height,
    response: Response,
    load: float | None = None,
    level: float | None = None,
    limits: tuple[float, float] | None = None,
    start: tuple[float, float] | None = None,
) -> tuple[float, float]:
    """An interval of the line (window) that an isolated contact fills to between 19 % and 75 %.

    The search begins with the window `start`, or with `limits` if there is none. The window grows
    or shrinks with the contact, but never beyond `limits`. Contact touches the border of the
    returned window only if this window is `limits`. load: if a level is given, a first guess.
    """
    if load is None and level is None:
        raise ValueError("give a load or a level")
    search = _Window(height, response, limits)
    window = search._clip(start or limits or (-1.0, 1.0))
    if level is None:
        assert load is not None
        return search.at_load(load, window)[0]
    return search.at_level(level, window, load or SEARCH.light_load * response.E * response.datum)


@record
class _Window:
    """The search for a window, that is, an interval that contains one isolated contact."""

    height: Height
    response: Response
    limits: tuple[float, float] | None

    def _heights(self, x: Array) -> Array:
        """Heights at x; far outside, heights may overflow to inf, and such points do not touch."""
        with np.errstate(over="ignore"):
            return np.asarray(self.height(x), dtype=np.float64)

    def _with_body(self, window: tuple[float, float]) -> tuple[float, float]:
        """The window, shrunk about its middle until some height in the window does not overflow."""
        for _ in range(SEARCH.max_steps):
            if not np.isposinf(self._heights(_midpoints(window, OPTIONS.window_points))).all():
                break
            middle, half = 0.5 * (window[0] + window[1]), 0.5 * (window[1] - window[0])
            window = middle - half / 8, middle + half / 8
        return window

    def _solve(self, window: tuple[float, float], load: float) -> tuple[Array, GridState]:
        """The grid points of a window, and the contact on them under a load."""
        x = _midpoints(window, OPTIONS.window_points)
        f = self._heights(x)
        lost = np.isnan(f) | np.isneginf(f)
        if lost.any():
            raise OutOfRange(
                f"profile.height(x) is {f[lost][0]} at x = {x[lost][0]:.9g} m, in the searched "
                f"interval {window} [m]: if the profile is known on a part of the line only, give "
                "it an `extent` and a `resolution`"
            )
        width = window[1] - window[0]
        with np.errstate(over="ignore", invalid="ignore"):
            # Points that are too high never touch. They are left out, as their large heights would
            # cost digits of all other heights.
            too_high = TOLERANCES.noise * (f - f.min()) > width + load / self.response.E
            influence = self.response.on(OPTIONS.window_points, width / OPTIONS.window_points)
            f = np.where(too_high, np.inf, f)
            return x, solve_grid(f, influence, load=load, tol=SEARCH.rough)

    def _clip(self, window: tuple[float, float]) -> tuple[float, float]:
        """The part of a window that lies within the limits of the search."""
        if self.limits is None:
            return window
        return max(window[0], self.limits[0]), min(window[1], self.limits[1])

    def at_load(
        self, load: float, window: tuple[float, float]
    ) -> tuple[tuple[float, float], GridState]:
        """A window that contains the contact under a load, and the contact on this window."""
        least_width, shrunk = 0.0, False
        window = self._with_body(window)
        for _ in range(SEARCH.max_steps):
            x, state = self._solve(window, load)
            width = window[1] - window[0]
            h = width / OPTIONS.window_points
            touching = np.flatnonzero(state.contact)
            if len(touching) == 0:
                break
            left, right = float(x[touching[0]]) - 0.5 * h, float(x[touching[-1]]) + 0.5 * h
            extent = right - left
            if state.touches_border:
                if window == self.limits:
                    return window, state
                if shrunk:
                    # The points of the previous, wider window missed some asperities. The window
                    # may therefore not shrink to the present width again.
                    least_width = 1.25 * width
                shrunk = False
                wanted_width = (8.0 if extent > 0.9 * width else 3.0) * width
                centre = 0.5 * (window[0] + window[1])
            else:
                # The place of a contact is only known to about one cell of width `h`. So the next
                # window is at least twelve of these cells wide.
                wanted_width = max(extent / WINDOW.filled, 12.0 * h, least_width)
                centre = 0.5 * (left + right)
                fits = extent <= 2 * WINDOW.filled * width
                if fits and (extent >= 0.5 * WINDOW.filled * width or wanted_width >= 0.8 * width):
                    return window, state
                shrunk = wanted_width < width
            if not wanted_width < 1e60:  # powers of larger widths overflow
                break
            wanted = self._clip((centre - 0.5 * wanted_width, centre + 0.5 * wanted_width))
            if wanted == window or centre + 0.5 * h == centre:
                # The window has reached the limits, or has become as narrow as the round-off of the
                # coordinate x allows.
                return window, state
            window = wanted
        raise NoWindow(
            f"no interval of x contains the whole contact (last tried: {window} [m]): check that "
            "the profile rises on both sides. A profile that levels off far away needs an "
            "`extent` or a small load"
        )

    def at_level(
        self, level: float, window: tuple[float, float], load: float
    ) -> tuple[float, float]:
        """A window for the contact at a given level, by Newton's method for the load.

        The level is displacement plus height in the contact. It is concave in the load up to its
        maximum. The load is found to a tenth of its value.
        """
        low, high = 0.0, np.inf
        for _ in range(SEARCH.max_steps):
            window, state = self.at_load(load, window)
            lowest = float(np.min(state.f))
            # Below this load, the level (displacement plus height in contact) changes no more in
            # double precision. So no smaller load brings the contact to the given `level`.
            if load < 1e-40 * self.response.E * self.response.datum:
                if level <= lowest:
                    raise OutOfRange(
                        f"level {level} (approach plus lowest height) is not above the lowest "
                        f"height of the profile, {lowest}: give a larger approach"
                    )
                raise OutOfRange(
                    f"level {level} (approach plus lowest height) is above the largest level under "
                    f"any load with the datum {self.response.datum}"
                )
            slope = self._compliance(state)
            step = (level - state.level) / slope if slope > 0.0 else np.nan
            if abs(step) <= 0.1 * load or (high < np.inf and high - low <= 0.05 * high):
                return window
            if slope > 0.0 and step > 0.0:
                low = load
            else:
                high = load
            load += step
            if not low < load < high:
                load = float(np.sqrt(low * high)) if low > 0.0 else 0.01 * high
        return window

    def _compliance(self, state: GridState) -> float:
        """Derivative of level by load: the level of a flat punch on the same contact, under load 1.

        The level is displacement plus height in the contact.
        """
        flat = np.where(state.contact, 0.0, np.inf)
        return solve_grid(flat, state.influence, load=1.0, tol=SEARCH.rough).level
