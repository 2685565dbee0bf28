"""A rough tilt for a given moment, from contacts on grids at successive tilts.

A rigid body on a rigid plane rests on two places on either side of the centre of its load. They are
the ends of an edge of the lower convex hull of f. The slope of this edge is the tilt under the
smallest loads, and is tried after the given guess. The root is found by
contact.search.grid.tilt_rate.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from contact.errors import OutOfRange
from contact.model.profiles.base import Profile
from contact.model.profiles.tilted import Tilted
from contact.model.scene import Scene
from contact.search.grid import nested_grids
from contact.search.grid.conjugate_gradient import Response
from contact.search.grid.nested_grids import find_window, grid_height, propose
from contact.search.grid.tilt_rate import AtTilt, balanced
from contact.search.options import SEARCH
from contact.verify.minima import SAMPLING
from sie import Array

Window = tuple[float, float]


@dataclass(frozen=True)
class TiltOptions:
    """Limits of the search for a rough tilt of the body."""

    max_tilts: int = 24  # largest number of tilts in one search
    # If no tilt is found, the limits of the search are widened by this factor, at most twice.
    farther: float = 1e3
    # Number of places sampled on each side of a window in search of the profile's lowest point. For
    # the convex hull, four times as many places are sampled.
    places: int = 1024

    @property
    def farthest(self) -> float:
        """Distance from a window's middle, in half widths, up to which the lowest point is sought.

        For a shape that becomes level and has no length of its own, it is the distance from x = 0
        in metres.
        """
        return self.farther**3


OPTIONS = TiltOptions()


def known_part(profile: Profile) -> Window | None:
    """The interval [m] on which a turned body is defined; None for the whole line.

    Its ends are the corners of a punch, the ends of one period that stands alone, or the ends of a
    trace.
    """
    return profile.support or Tilted(profile, 0.0).extent


def held_by(profile: Tilted) -> Window | None:
    """The interval [m] that a punch, or one period of a profile, occupies; None for others."""
    return profile.support or (None if profile.profile.period is None else profile.extent)


def window_at_load(
    scene: Scene,
    profile: Tilted,
    load: float,
    limits: Window | None = None,
    start: Window | None = None,
) -> Window:
    """An interval [m] that contains the contact of the tilted profile under a load."""
    return held_by(profile) or find_window(
        partial(grid_height, profile),
        response_of(scene),
        load=load,
        limits=limits or profile.extent,
        start=start or (None if limits else first_window(profile)),
    )


def first_window(profile: Profile) -> Window | None:
    """First search interval: x = 0 plus and minus the profile's smallest length.
    None if this length is unknown, or if the profile is not known on the whole line.
    """
    size = profile.resolution
    return None if size is None or profile.extent is not None else (-size, size)


def response_of(scene: Scene, datum: float = 1.0) -> Response:
    """The response of the surface of a single body to pressure."""
    return Response(scene.E_star, False, datum=datum, rest=scene.operator.rest)


def tilt_search(scene: Scene, guess: float) -> AtTilt:
    """A rough tilt at which the load has the given moment, with the contact at this tilt."""
    load = scene.given_load
    assert scene.moment is not None and load is not None
    centre, known = scene.moment / load, known_part(scene.profile)
    if known is not None and not known[0] < centre < known[1]:
        what = (
            "the corners of the profile"
            if scene.profile.support is not None
            else "the ends of the known part of the profile"
        )
        raise OutOfRange(
            f"moment {scene.moment:.6g} N puts the centre of the load at {centre:.6g} m, which is "
            f"not between {what}, {known[0]:.6g} and {known[1]:.6g} m"
        )
    try:
        first: Window | None = window_at_load(scene, Tilted(scene.profile, guess), load)
    except OutOfRange:
        # No contact is found, as the body has no lowest place at the guessed tilt.
        first = None
    size = (
        max(abs(centre), *(abs(end) for end in first or (0.0, 0.0)))
        or scene.profile.resolution
        or 1.0
    )
    resting, edge = _hull_edge(
        scene.profile, centre, known, _hull([first or (-size, size), (centre, centre)])
    )
    tilts = (guess, resting)
    if first is not None and edge is not None:
        first = _hull([first, edge])
    for reach in (OPTIONS.farther * size, OPTIONS.farther**2 * size, OPTIONS.farther**3 * size):
        search = _Tilting(scene, load, known or (-reach, reach), known is not None, first)
        best = balanced(search, centre, tilts, OPTIONS.max_tilts)
        off_centre = abs(best.centre - centre) > best.fineness
        lo, hi = _hull(search.windows.values() or [search.limits])
        if off_centre and known is None and best.window != search.limits and not lo <= centre <= hi:
            # The centre of a load lies within the window of its contact. All windows lie on one
            # side of the wanted `centre`, so that wider limits are of no use.
            break
        if off_centre and len(search.windows) > 1:
            # A search interval about one asperity may have missed another asperity. The search is
            # repeated with an interval that contains both asperities, however far apart.
            search = replace(search, whole=(lo, hi))
            best = balanced(search, centre, (best.tilt, resting), 2 * OPTIONS.max_tilts)
        if known is not None or best.window != search.limits:
            return best
    raise OutOfRange(
        f"no tilt was found that puts the centre of the load (moment / load) at {centre:.6g} m: "
        "give a smaller moment, or check that the profile rises on both sides"
    )


@dataclass
class _Tilting:
    """The function from a tilt to its contact; it stores the search intervals of earlier tilts.

    At a tilt between two others, the contact lies between the contacts at those two tilts. A window
    about both contacts therefore also contains asperities that are far apart.

    limits: the widest window. bounded: whether the body is defined within `limits` only. first: the
    window to begin with. whole: if not None, the window at every tilt.
    """

    scene: Scene
    load: float
    limits: Window
    bounded: bool
    first: Window | None
    whole: Window | None = None
    windows: dict[float, Window] = field(default_factory=dict)

    def __call__(self, tilt: float) -> AtTilt:
        """The contact on a grid at the given tilt."""
        scene, profile = self.scene, Tilted(self.scene.profile, tilt)
        window = self.whole or window_at_load(
            scene, profile, self.load, self.limits, self._about(tilt)
        )
        if window != self.limits:
            self.windows[tilt] = window
        wide = self.whole is not None or (self.bounded and window == self.limits)
        found = propose(
            partial(grid_height, profile),
            window,
            response_of(scene),
            load=self.load,
            points=None if wide else 4 * nested_grids.OPTIONS.coarsest,
            resolution=profile.resolution,
        )
        extent = float(np.ptp(found.zones)) / found.state.influence.h if len(found.zones) else 1.0
        return AtTilt.of(tilt, window, found.state, max(1.0, SEARCH.grid_error * extent))

    def _about(self, tilt: float) -> Window | None:
        """Interval that contains the windows at the nearest known tilts below and above `tilt`."""
        below = [t for t in self.windows if t <= tilt]
        above = [t for t in self.windows if t >= tilt]
        near = [
            self.windows[t]
            for t in (max(below, default=None), min(above, default=None))
            if t is not None
        ]
        return _hull(near) if near else self.first


def _hull(windows: Iterable[Window]) -> Window:
    """The smallest interval that contains all the given intervals."""
    lo, hi = zip(*windows, strict=True)
    return min(lo), max(hi)


def _hull_edge(
    profile: Profile, centre: float, known: Window | None, about: Window
) -> tuple[float, Window | None]:
    """(slope, ends) of the edge of the profile's lower convex hull that contains x = `centre`.

    The ends are None if one of them is the first or the last sample.
    """
    if known is not None:
        count = (
            0.0 if profile.resolution is None else 8 * (known[1] - known[0]) / profile.resolution
        )
        x = np.linspace(*known, int(np.clip(count, 4 * OPTIONS.places + 1, SAMPLING.max_points)))
    else:
        # The samples are dense where the body touches. They reach far enough for any profile that
        # rises faster than a straight line.
        middle, half = 0.5 * (about[0] + about[1]), 0.5 * (about[1] - about[0])
        reach = math.asinh(OPTIONS.farther**2)
        x = middle + half * np.sinh(np.linspace(-reach, reach, 4 * OPTIONS.places + 1))
    with np.errstate(over="ignore", invalid="ignore"):
        f = np.asarray(profile.height(x), dtype=np.float64)
    x, f = x[np.isfinite(f)], f[np.isfinite(f)]
    i, j = hull_edge(x, f, centre)
    edge = (float(x[i]), float(x[j]))
    return float((f[j] - f[i]) / (x[j] - x[i])), edge if i > 0 and j < len(x) - 1 else None


def hull_edge(x: Array, f: Array, at: float) -> tuple[int, int]:
    """Indices of both ends of the edge of the lower convex hull that contains x = `at`."""
    i, j = 0, len(x) - 1
    while True:
        rest = f - (f[j] - f[i]) / (x[j] - x[i]) * x
        k = int(np.argmin(rest))
        # Each step moves one end of the edge to a corner of the hull that is closer to x = `at`.
        nearer = (k > i and x[k] <= at) or (k < j and x[k] > at)
        if not nearer or rest[k] >= min(rest[i], rest[j]):
            return i, j
        i, j = (k, j) if x[k] <= at else (i, k)
