r"""Propose contact zones: a grid contact (contact.search.grid.conjugate_gradient) refined until
zones and gaps are a few cells wide.

The grid decides how many zones there are and gives their ends to a fraction of a cell; making them
exact is Newton's work. Near an end p ~ A sqrt(d), so p^2 is linear there and its zero is found
below the grid. A zone of one or two cells is taken as a Hertz contact: its load P and the curvature
1/R of the gap give a = 2 sqrt(P R / (pi E)).
"""

from collections.abc import Callable
from dataclasses import field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact.errors import OutOfRange
from contact.formulation.tables import in_cell, runs_of
from contact.model.plugin_checks.declarations import require_numbers
from contact.model.profiles.base import Profile
from contact.search.grid.centring import Unrest
from contact.search.grid.conjugate_gradient import GridState, Response, solve_grid
from contact.search.topology.intervals import without
from sie import Array, record

Height = Callable[[Array], ArrayLike]

_POINTS = 128  # of a window
_SHRINKS = 40  # of a window to an eighth: from metres to below atoms, and from lengths far beyond
_TOWERING = 1e6  # heights above the lowest, over the window
COARSEST = 64  # points of the first of the nested grids
MOST_POINTS = 2**23  # of the last grid, however fine the shape is
_PASSING = 1e-3  # tolerance of the grids before the last
# Cells to the smallest length of a shape; where it has very many of these the grid is what takes
# the time, and half as many leave out one zone in a hundred or two, which the first look at the
# signs puts in.
_PER_FEATURE = 16
_FEATURES = 2**15
_PER_ONE_OF_MANY = 8
NARROW = 3  # cells: below this a zone or a gap is not resolved
_WIDEST = 0.5  # cells: half of a gap between points at the most


class NoWindow(OutOfRange):
    """However wide a window is, the contact reaches its border."""


@record
class Proposal:
    """Zones (n, 2) to start Newton from [m], the points of the last grid, whether it is in full
    contact or touches the border of what is known, the contact on it, why a strip is not where its
    centre stays, and whether they are those of a strip from border to border, wherever their widest
    gap is.
    """

    zones: Array
    points: int
    full: bool
    touches_border: bool
    grid: GridState | None = field(default=None, repr=False)
    unrest: Unrest | None = None
    in_strip: bool = False

    @property
    def width(self) -> float:
        """Total width [m], inf in full contact."""
        return np.inf if self.full else float(np.sum(self.zones[:, 1] - self.zones[:, 0]))

    @property
    def load(self) -> float:
        """[N/m], where it is that of the grid."""
        return np.nan if self.grid is None else self.grid.load

    @property
    def state(self) -> GridState:
        """The contact on the grid, where it is kept."""
        assert self.grid is not None
        return self.grid


def grid_height(profile: Profile, x: Array) -> Array:
    """f at ascending, even points up to a constant; where its digits drown its shape there, the
    integral of its slope.

    Near a summit f varies by the square of the distance, f' by the distance: f' keeps digits that f
    has lost.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        f = np.asarray(profile.height(x), dtype=np.float64)
        size, range_ = np.max(np.abs(f)), np.ptp(f)
        if not range_ < 1e8 * np.finfo(np.float64).eps * size:
            return f
        ends, middle = (
            np.asarray(profile.slope(x)),
            np.asarray(profile.slope(0.5 * (x[1:] + x[:-1]))),
        )
    rise = np.diff(x) * (ends[:-1] + 4 * middle + ends[1:]) / 6
    return np.concatenate(([0.0], np.cumsum(rise)))


def _midpoints(cell: tuple[float, float], n: int) -> Array:
    return np.asarray(cell[0] + (cell[1] - cell[0]) / n * (np.arange(n) + 0.5), dtype=np.float64)


def narrowest(state: GridState) -> int:
    """Width in cells of the narrowest zone or gap between zones (n for full contact, 0 for no
    contact or a gap that may lie between the points of a full contact).
    """
    n = state.influence.n
    wraps = state.influence.is_periodic
    runs = np.array(runs_of(state.contact, wraps)).reshape(-1, 2)
    if state.full:
        # p is a parabola at its minimum: below one second difference it may hide a gap between two
        # points.
        p, i = state.pressure, int(np.argmin(state.pressure))
        return n if p[i] > p[i - 1] - 2.0 * p[i] + p[(i + 1) % n] else 0
    if not len(
        runs
    ):  # the lowest point of the grid lies above the level; a finer grid may go deeper
        return 0
    gaps = runs[1:, 0] - runs[:-1, 1] - 1
    if wraps:
        gaps = np.append(gaps, runs[0, 0] + n - runs[-1, 1] - 1)
    return int(min(np.min(runs[:, 1] - runs[:, 0] + 1), np.min(gaps, initial=n)))


def zones_of(state: GridState, x: ArrayLike, between_points: bool = False) -> Array:
    """(k, 2) zone ends. Periodic: left ends in the cell, ascending, a right end may exceed it; full
    contact: shape (0, 2). between_points: with gaps that no point lies in, of a grid that tells the
    pressure's shape.
    """
    points = np.asarray(x, dtype=np.float64)
    h, n, E = state.influence.h, state.influence.n, state.influence.E
    if state.full:
        return np.empty((0, 2))
    wraps, x0 = state.influence.is_periodic, float(points[0])
    runs = runs_of(state.contact, wraps)
    zones = np.empty((len(runs), 2))
    for k, (first, last) in enumerate(runs):
        cells = np.arange(first, last + 1) % n
        p = state.pressure[cells]
        left, right = x0 + h * first, x0 + h * last
        if len(cells) < NARROW:
            centre, half = _hertz(state, cells, first, E)
            a, b = x0 + h * centre - half, x0 + h * centre + half
        else:
            a, b = left - h * float(_beyond(p[0], p[1])), right + h * float(_beyond(p[-1], p[-2]))
        # The first free point on each side is outside: within this fence zones neither overlap nor
        # invert.
        zones[k] = max(a, left - 0.999 * h), min(b, right + 0.999 * h)
    if between_points:
        gaps = _gaps_between(points, state)
        zones = without(zones, np.concatenate((gaps, gaps + n * h)) if wraps else gaps)
    return in_cell(zones, x0 - 0.5 * h, n * h if wraps else None)


def _gaps_between(x: Array, state: GridState) -> Array:
    """Gaps (k, 2) between two points of a grid x, ascending: where a parabola through the pressure
    falls below zero. As wide as a lone one in it is.
    """
    p, h = state.pressure, state.influence.h
    # Beyond a window nothing presses, and where no pressure is beside a point there is none of its
    # own between them.
    before, after = np.roll(p, 1), np.roll(p, -1)
    if not state.influence.is_periodic:
        before[0] = after[-1] = 0.0
    i = np.flatnonzero((p > 0.0) & (p <= before) & (p <= after))
    slope, bend = 0.5 * (after - before)[i], (before - 2.0 * p + after)[i]
    with np.errstate(divide="ignore", invalid="ignore"):
        pulls = 0.5 * slope**2 / bend - p[i]
    open_ = pulls > 0.0
    i, slope, bend, pulls = i[open_], slope[open_], bend[open_], pulls[open_]
    middle, half = x[i] - h * slope / bend, h * np.minimum(2.0 * np.sqrt(pulls / bend), _WIDEST)
    return np.column_stack((middle - half, middle + half))


def _beyond(p_end: Array, p_next: Array) -> Array:
    """Cells from the last point in contact to the zero of p^2; half a cell where p does not fall
    there.
    """
    rise = p_next**2 - p_end**2
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(rise > 0.0, np.minimum(p_end**2 / rise, 1.0), 0.5)


def _hertz(state: GridState, cells: NDArray[np.int64], first: int, E: float) -> tuple[float, float]:
    """Centre (in cells) and half width of a zone of one or two cells: its load, the curvature of f
    there.
    """
    h, n = state.influence.h, state.influence.n
    p = state.pressure[cells]
    load = float(p.sum()) * h
    centre = float(first + p @ np.arange(len(cells)) / p.sum())
    around = np.arange(cells[0] - 1, cells[0] + len(cells) + 1)
    around = around % n if state.influence.is_periodic else np.clip(around, 0, n - 1)
    with np.errstate(invalid="ignore"):
        curvature = float(np.max(np.diff(state.f[around], 2))) / h**2
    widest = 0.5 * (len(cells) + 1) * h
    if not (np.isfinite(curvature) and curvature > 0.0):
        return centre, 0.5 * len(cells) * h
    half = 2.0 * np.sqrt(load / (np.pi * E * curvature))
    if half < 0.5 * h and len(cells) == 1:  # below the grid the tip is the vertex of the parabola
        bend = state.f[around]
        centre += float(np.clip(0.5 * (bend[0] - bend[2]) / (curvature * h**2), -0.5, 0.5))
    return centre, float(min(half, widest))


def propose(
    height: Height,
    cell: tuple[float, float],
    response: Response,
    *,
    load: float | None = None,
    level: float | None = None,
    resolution: float | None = None,
    points: int | None = None,
    max_points: int = 2**17,
    tol: float = 1e-8,
    near: GridState | None = None,
    between_points: bool = False,
) -> Proposal:
    """Zones of `height` on one period or window `cell` from nested grids.

    `resolution` is the smallest length of the shape and sets the first final grid, doubled up to
    `max_points` while something is narrower than three cells; `points` fixes the final grid
    instead. near: a contact on the same cell, under another load or to another tolerance, of which
    the first grid has the points. between_points: see `zones_of`.
    """
    width = cell[1] - cell[0]
    if points is not None:
        target = limit = int(points)
    else:
        target, limit = points_for(width, resolution, max_points)
        if _features(width, resolution) > _FEATURES:
            # What this is wrong by, the look at the signs puts right as well.
            tol = max(tol, _PASSING)
    n, start = target, None
    while n % 2 == 0 and n // 2 >= COARSEST and start is None:
        start = near.pressure if near is not None and len(near.pressure) == n else None
        n = n if start is not None else n // 2
    while True:
        x, h = _midpoints(cell, n), width / n
        f = np.asarray(height(x), dtype=np.float64)
        require_numbers(x, f)
        # What a grid before the last is wrong by, the next one puts right.
        state = solve_grid(
            f,
            response.on(n, h),
            load=load,
            level=level,
            start=start,
            tol=tol if n >= target else max(tol, _PASSING),
        )
        if n >= target and (narrowest(state) >= NARROW or 2 * n > limit):
            break
        n, start = 2 * n, _refine(state.pressure, response.periodic)
    return Proposal(zones_of(state, x, between_points), n, state.full, state.touches_border, state)


def _features(width: float, resolution: float | None) -> float:
    return 16.0 if resolution is None else width / resolution


def points_for(width: float, resolution: float | None, most: int) -> tuple[int, int]:
    """(points that a cell of this width asks for, points at the most)."""
    features = _features(width, resolution)
    wanted = max(
        4 * COARSEST, (_PER_FEATURE if features <= _FEATURES else _PER_ONE_OF_MANY) * features
    )
    target = 2 ** int(np.ceil(np.log2(wanted)))
    # A shape of known resolution is worth as many points as it asks for.
    limit = most if resolution is None else max(most, min(target, MOST_POINTS))
    return min(target, limit), limit


def _refine(p: Array, periodic: bool) -> Array:
    """Linear interpolation from the midpoints of a grid to those of the grid of twice as many,
    without what is farther in a cell beyond an end than p^2 goes on.
    """
    left, right = np.roll(p, 1), np.roll(p, -1)
    if not periodic:
        left[0], right[-1] = p[0], p[-1]
    out = np.stack((0.75 * p + 0.25 * left, 0.75 * p + 0.25 * right), axis=1)
    for side, outer, inner in ((-1, left, right), (1, right, left)):
        ends = np.flatnonzero((p > 0) & (outer == 0))
        # The nearer half of a free cell faces the end.
        beyond = (ends[_beyond(p[ends], inner[ends]) < 0.75] + side) % len(p)
        out[beyond, 0 if side > 0 else 1] = 0.0
    return np.asarray(out.ravel(), dtype=np.float64)


def find_window(
    height: Height,
    response: Response,
    *,
    load: float | None = None,
    level: float | None = None,
    start_scale: float | None = None,
    limits: tuple[float, float] | None = None,
    start: tuple[float, float] | None = None,
    light: float | None = None,
) -> tuple[float, float]:
    """A window of the line of which an isolated contact takes between about 20 % and 70 %, clear of
    its border.

    The search begins with the window `start`, or else at `start_scale` around 0 (or at `limits`,
    which it never leaves), and grows or shrinks by what the contact takes. A window returned with
    its border in contact is `limits` itself. A level is sought from a `light` load on.
    """
    if (load is None) == (level is None):
        raise ValueError("exactly one of load and level")
    search = _Window(height, response, limits)
    window = start or limits or (-(start_scale or 1.0), start_scale or 1.0)
    if load is not None:
        return search.at_load(load, window)[0]
    assert level is not None
    return search.at_level(level, window, light or 1e-3 * response.E * response.datum)


@record
class _Window:
    height: Height
    response: Response
    limits: tuple[float, float] | None

    def _heights(self, x: Array) -> Array:
        with np.errstate(
            over="ignore"
        ):  # far outside heights may overflow to inf: these points do not touch
            return np.asarray(self.height(x), dtype=np.float64)

    def _with_body(self, window: tuple[float, float]) -> tuple[float, float]:
        """The window, shrunk about its middle until some height in it is no overflow."""
        for _ in range(_SHRINKS):
            if not np.isposinf(self._heights(_midpoints(window, _POINTS))).all():
                break
            middle, half = 0.5 * (window[0] + window[1]), 0.5 * (window[1] - window[0])
            window = middle - half / 8, middle + half / 8
        return window

    def _solve(self, window: tuple[float, float], load: float) -> tuple[Array, GridState]:
        x = _midpoints(window, _POINTS)
        f = self._heights(x)
        lost = np.isnan(f) | np.isneginf(f)
        if lost.any():
            raise OutOfRange(
                f"profile.height(x) is {f[lost][0]} at x = {x[lost][0]:.9g} m, in the window {window} [m] looked at: "
                "if it is known on a part of the line only, give it an `extent`, and a `resolution` to begin with"
            )
        # So high nothing touches, and beside such heights those of the tip have no digits.
        with np.errstate(over="ignore", invalid="ignore"):
            f = np.where(
                f - f.min() > _TOWERING * (window[1] - window[0] + load / self.response.E),
                np.inf,
                f,
            )
        influence = self.response.on(_POINTS, (window[1] - window[0]) / _POINTS)
        with np.errstate(over="ignore", invalid="ignore"):
            return x, solve_grid(f, influence, load=load, tol=1e-3)

    def _clip(self, window: tuple[float, float]) -> tuple[float, float]:
        if self.limits is None:
            return window
        return max(window[0], self.limits[0]), min(window[1], self.limits[1])

    def at_load(
        self, load: float, window: tuple[float, float]
    ) -> tuple[tuple[float, float], GridState]:
        floor, shrunk = 0.0, False
        window = self._with_body(window)
        for _ in range(300):
            x, state = self._solve(window, load)
            width = window[1] - window[0]
            h = width / _POINTS
            touching = np.flatnonzero(state.contact)
            if len(touching) == 0:
                break
            left, right = float(x[touching[0]]) - 0.5 * h, float(x[touching[-1]]) + 0.5 * h
            extent = right - left
            if state.touches_border:
                if window == self.limits:
                    return window, state
                if (
                    shrunk
                ):  # asperities between the points of the wider window: do not come back here
                    floor = 1.25 * width
                shrunk = False
                new = (8.0 if extent > 0.9 * width else 3.0) * width
                centre = 0.5 * (window[0] + window[1])
            else:
                # A grid sees no more than its cells: from a few cells in contact keep a few more
                # around them.
                new = max(2.5 * extent, 12.0 * h, floor)
                centre = 0.5 * (left + right)
                if extent <= 0.7 * width and (extent >= 0.2 * width or new >= 0.8 * width):
                    return window, state
                shrunk = new < width
            if not new < 1e60:
                break
            wanted = self._clip((centre - 0.5 * new, centre + 0.5 * new))
            if (
                wanted == window or centre + 0.5 * h == centre
            ):  # at the limits, or below the digits of x
                return window, state
            window = wanted
        raise NoWindow(
            f"no window holds the contact (last tried: {window}): does the profile rise on both sides? Where it "
            "levels off, alone it bears light loads only"
        )

    def at_level(
        self, level: float, window: tuple[float, float], load: float
    ) -> tuple[float, float]:
        """The level is concave in the load up to its maximum: NewtonSettings for the load, to a tenth,
        bracketed.
        """
        low, high = 0.0, np.inf
        for _ in range(200):
            window, state = self.at_load(load, window)
            lowest = float(np.min(state.f))
            if load < 1e-40 * self.response.E * self.response.datum:
                if level <= lowest:
                    raise OutOfRange(
                        f"level {level} does not reach the profile, whose lowest point is {lowest}"
                    )
                raise OutOfRange(
                    f"level {level} is above the largest approach over a datum of {self.response.datum}"
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
        """d level / d load = -(2 / pi E) ln(capacity / datum) of the contact set, as a flat punch."""
        flat = np.where(state.contact, 0.0, np.inf)
        return solve_grid(flat, state.influence, load=1.0, tol=1e-3).level
