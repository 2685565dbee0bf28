r"""Asperities of several heights: levels that come into contact one after another.

Level i has N_i spots per unit area, and each spot carries the load P_i. The tips of level j are d_j
below the highest tips. At the approach delta, level j touches when the deformed surface reaches its
tips: delta - u(tip) = d_j. The levels in contact cause the displacement u. Neighbours treated at
their places contribute means over the angle; farther neighbours act by their nominal pressures
N_i P_i. From then on, level j is a further kind of spot in the same system. All kinds have one
delta, and sum N_i P_i is the nominal pressure. With `rings=0`, the other spots of a spot's own
level act outside the circle of radius (pi N_j)^(-1/2), whose area is the area per spot, as in the
paper's equation (1); every other level acts outside the circle of radius (pi sum N_i)^(-1/2).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import inf, isinf
from typing import Any

import numpy as np

from contact.axisymmetric.answer import Spot
from contact.axisymmetric.lattices import Lattice, Site, as_lattice, own_radius
from contact.axisymmetric.neighbours import Surroundings, surroundings
from contact.axisymmetric.profiles import as_profile
from contact.axisymmetric.spot import (
    first_radius,
    one_control,
    refined,
    refinements,
    ring_count,
    spot_of,
)
from contact.axisymmetric.system import Kind, closed_edge, room, total_load
from contact.axisymmetric.system import approach as given_approach
from contact.errors import OutOfRange, SceneError
from contact.model.checks import finite, keep, non_negative, positive
from sie import Array


@dataclass(frozen=True)
class Level:
    """A level: all asperities that share a shape and the height of their tips.

    Parameters
    ----------
    profile : AxisymmetricProfile or callable
        The shape, or f(r) [m].
    depth : float
        Distance of the tips below the highest ones [m]; 0 for the highest level.
    density : float or None
        Asperities per unit area [1/m^2], if there is no lattice.
    sites : sequence of pairs or None
        Places in fractions of the lattice's basis vectors. All sites of a level must have equal
        surroundings.

    Raises
    ------
    SceneError
        If the depth is negative, a density or site is invalid, or not exactly one of `density` and
        `sites` is given.

    Examples
    --------
    >>> from contact.axisymmetric import Level, Sphere
    >>> low = Level(Sphere(1e-3), depth=1e-8, sites=[(0.5, 0.5)])
    >>> low.depth, low.sites, low.density
    (1e-08, ((0.5, 0.5),), None)
    """

    profile: Any
    depth: float = 0.0
    density: float | None = None
    sites: Sequence[Site] | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "profile", as_profile(self.profile))
        keep(self, non_negative, "depth")
        if (self.density is None) == (self.sites is None):
            raise SceneError("exactly one of density and sites must be given for a level")
        if self.density is not None:
            keep(self, positive, "density")
        if self.sites is not None:
            object.__setattr__(self, "sites", _sites(self.sites))


@dataclass(frozen=True)
class LevelsSolution:
    """The asperities of all levels at one nominal pressure: the result of `solve_levels`.

    Parameters
    ----------
    nominal_pressure : float
        Load divided by area [Pa].
    approach : float
        Approach of the body since the highest level touched, measured from the mean plane of the
        surface [m].
    spots : tuple of Spot or None
        The spot of every level; None for a level that does not touch.
    touch_pressures, touch_approaches : array, (levels,)
        Nominal pressure [Pa] and approach [m] at which each level begins to touch; inf if spots
        would merge first.

    Attributes
    ----------
    touching : tuple of bool
        Whether each level is in contact.
    radii, loads : array, (levels,)
        Radius [m] and load [N] of one spot of each level; 0 without contact.
    shares : array, (levels,)
        Share of the nominal pressure that each level carries; the sum is one.
    error : float
        Bound of the relative error, the largest of the spots.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.axisymmetric import Level, Sphere, solve_levels
    >>> levels = [Level(Sphere(1e-3), density=1e8), Level(Sphere(1e-3), depth=1e-8, density=1e8)]
    >>> found = solve_levels(levels, 1e11, nominal_pressure=1e7)
    >>> found.touching, bool(np.isclose(np.sum(found.shares), 1.0))
    ((True, True), True)
    >>> bool(found.radii[0] > found.radii[1])
    True
    """

    nominal_pressure: float
    approach: float
    spots: tuple[Spot | None, ...]
    touch_pressures: Array
    touch_approaches: Array

    @property
    def touching(self) -> tuple[bool, ...]:
        """For each level (asperities of one shape and height), whether it is in contact."""
        return tuple(spot is not None for spot in self.spots)

    @property
    def radii(self) -> Array:
        """Radius [m] of the spots of each level of equal asperities; 0 without contact."""
        return np.array([0.0 if s is None else s.radius for s in self.spots])

    @property
    def loads(self) -> Array:
        """Load [N] of one spot of each level of equal asperities; 0 without contact."""
        return np.array([0.0 if s is None else s.load for s in self.spots])

    @property
    def shares(self) -> Array:
        """Share of the nominal pressure that the asperities of each level carry; the sum is one."""
        return (
            np.array([0.0 if s is None else s.load * s.density for s in self.spots])
            / self.nominal_pressure
        )

    @property
    def error(self) -> float:
        """Bound of the relative error of the solution: the largest error of all spots."""
        return max(s.error for s in self.spots if s is not None)


def solve_levels(
    levels: Sequence[Level],
    E_star: float,
    lattice: Lattice | None = None,
    *,
    nominal_pressure: float | None = None,
    approach: float | None = None,
    rings: float = 0,
    tol: float = 1e-10,
) -> LevelsSolution:
    """Solve for the levels (groups of equal asperities) in contact, and for their spots.
    Either the nominal pressure or the approach is given.

    Parameters
    ----------
    levels : sequence of Level
        The levels; the highest has depth 0.
    E_star : float
        Reduced modulus [Pa].
    lattice : Lattice or None
        The lattice of the sites.
    nominal_pressure, approach : float or None
        The control: exactly one of them [Pa, m].
    rings : float
        Number of rings of neighbours treated at their places, up to inf; 0: the first step of the
        localization.
    tol : float
        Largest allowed relative error of the solution; the error of the model is not included.

    Returns
    -------
    LevelsSolution

    Raises
    ------
    SceneError, OutOfRange, NotConverged
        If the input is invalid, the control has no solution, or the tolerance was not reached.

    Examples
    --------
    >>> from contact.axisymmetric import Level, Sphere, Square, solve_levels
    >>> low = Level(Sphere(1e-3), depth=1e-6, sites=[(0.5, 0.5)])
    >>> levels = [Level(Sphere(1e-3), sites=[(0, 0)]), low]
    >>> found = solve_levels(levels, 1e11, Square(1e-4), nominal_pressure=1e5)
    >>> [spot is not None for spot in found.spots]
    [True, False]
    """
    E, tol = positive("E_star", E_star), positive("tol", tol)
    name, value = one_control(nominal_pressure=nominal_pressure, approach=approach)
    kinds, kept = _system(levels, lattice, rings)
    condition = total_load(value / E) if name == "nominal_pressure" else given_approach(value)

    contacts = list(_contacts(kinds, tol))
    met = [
        c for c in contacts if (c.pressure * E if name == "nominal_pressure" else c.delta) < value
    ]
    active = sorted(j for c in met for j in c.kinds)
    start = _start(kinds, active, value / E if name == "nominal_pressure" else None, value)
    found = refined(
        refinements(kinds, start, condition),
        lambda state: [spot_of(j, kinds, state, E, kept) for j in active],
        tol,
    )
    spots = dict(zip(active, found, strict=True))
    pressures, deltas = np.full(len(kinds), inf), np.full(len(kinds), inf)
    for c in contacts:
        pressures[c.kinds], deltas[c.kinds] = E * c.pressure, c.delta
    return LevelsSolution(
        nominal_pressure=sum(s.load * s.density for s in found),
        approach=found[0].approach,
        spots=tuple(spots.get(j) for j in range(len(kinds))),
        touch_pressures=pressures,
        touch_approaches=deltas,
    )


def touch_pressures(
    levels: Sequence[Level],
    E_star: float,
    lattice: Lattice | None = None,
    *,
    rings: float = 0,
    tol: float = 1e-10,
) -> Array:
    """Nominal pressure at which each level (group of equal asperities) begins to touch.
    It is inf if the spots of other levels would merge at a lower pressure.

    Parameters
    ----------
    levels : sequence of Level
        The levels; the highest has depth 0.
    E_star : float
        Reduced modulus [Pa].
    lattice : Lattice or None
        The lattice of the sites.
    rings : float
        Number of rings of neighbours treated at their places, up to inf; 0: the first step of the
        localization.
    tol : float
        Largest allowed relative error of the solution; the error of the model is not included.

    Returns
    -------
    array, (levels,)
        [Pa]; 0 for the highest level.

    Raises
    ------
    SceneError
        If the input is invalid.
    NotConverged
        If Newton's method for the radii did not converge.

    Examples
    --------
    The low level touches just above its pressure, but not just below it.

    >>> from contact.axisymmetric import Level, Sphere, solve_levels, touch_pressures
    >>> levels = [Level(Sphere(1e-3), density=1e8), Level(Sphere(1e-3), depth=1e-8, density=1e8)]
    >>> highest, low = touch_pressures(levels, 1e11)
    >>> below = solve_levels(levels, 1e11, nominal_pressure=0.99 * low)
    >>> above = solve_levels(levels, 1e11, nominal_pressure=1.01 * low)
    >>> below.touching[1], above.touching[1]
    (False, True)
    """
    E, tol = positive("E_star", E_star), positive("tol", tol)
    kinds, _ = _system(levels, lattice, rings)
    pressures = np.full(len(kinds), inf)
    for c in _contacts(kinds, tol):
        pressures[c.kinds] = E * c.pressure
    return pressures


@dataclass(frozen=True)
class _Contact:
    """Levels (groups of equal asperities) that begin to touch at the same pressure.
    `pressure` is the nominal pressure divided by E*, `delta` the approach of the surfaces.
    """

    kinds: list[int]
    pressure: float
    delta: float


def _contacts(kinds: Sequence[Kind], tol: float) -> Iterator[_Contact]:
    """Yield the levels of equal asperities in the order in which they begin to touch."""
    active = [j for j, kind in enumerate(kinds) if kind.depth == 0.0]
    yield _Contact(list(active), 0.0, 0.0)
    while waiting := [j for j in range(len(kinds)) if j not in active]:
        # The first touch of each waiting level is computed as if this level came into contact next.
        # The result is right only for the level with the lowest pressure.
        found = [_first_touch(j, kinds, active, tol) for j in waiting]
        first = min(found, key=lambda c: c.pressure)
        if isinf(first.pressure):
            return
        together = [c.kinds[0] for c in found if c.pressure <= first.pressure * (1.0 + 1e-9)]
        yield _Contact(together, first.pressure, first.delta)
        active += together


def _first_touch(j: int, kinds: Sequence[Kind], active: list[int], tol: float) -> _Contact:
    """Pressure and approach at which level j first touches, if `active` levels are in contact.
    A level is a group of equal asperities.
    """
    last = inf
    try:
        for state in refinements(
            kinds, _start(kinds, active, None, kinds[j].depth), closed_edge(j)
        ):
            pressure = sum(
                kind.density * float(force) for kind, force in zip(kinds, state.forces, strict=True)
            )
            if not pressure > 0:
                break
            if abs(pressure - last) <= 0.1 * tol * pressure or not any(
                s.sources for s in state.surfaces
            ):
                return _Contact([j], pressure, state.delta)
            last = pressure
    except OutOfRange:
        pass
    return _Contact([j], inf, inf)


def _start(kinds: Sequence[Kind], active: list[int], pressure: float | None, delta: float) -> Array:
    """Radii that the spots would have without interaction: initial guess for Newton's method.

    Either `pressure`, the nominal pressure divided by E*, or the approach `delta` is given.
    """
    scale = min(own_radius(kind.density) for kind in kinds)
    if pressure is not None:
        # In this guess, all spots carry the same load. The highest spots under this load give
        # the approach `delta`.
        load = pressure / sum(kinds[j].density for j in active)
        highest = kinds[min(active, key=lambda j: kinds[j].depth)].profile
        delta = float(highest.line(first_radius(highest.load_integral, load, scale)))
    radii = np.zeros(len(kinds))
    for j in active:
        over = delta - kinds[j].depth
        # `over` is the approach minus the depth of level j, which is the penetration of its spots
        # without interaction. If `over` is not positive, such a spot would not touch, so its radius
        # in the initial guess is small.
        radii[j] = first_radius(kinds[j].profile.line, over, scale) if over > 0 else 0.05 * scale
    while room(kinds, radii) < 0.1:
        radii *= 0.9
    return radii


def _system(
    levels: Sequence[Level], lattice: Lattice | None, rings: float
) -> tuple[list[Kind], float]:
    """(the kinds of spots, the number of rings of single neighbours); the input is checked.
    The neighbours in these rings keep their true positions; farther ones act as a mean pressure.
    """
    levels = list(levels)
    if not levels or not all(isinstance(level, Level) for level in levels):
        raise SceneError.of("levels", levels, "a sequence of at least one Level")
    if min(level.depth for level in levels) != 0.0:
        raise SceneError.of(
            "depth", min(level.depth for level in levels), "0 for the highest level"
        )
    kept = ring_count(rings, as_lattice(lattice))
    densities, sites = (
        [given for level in levels if (given := getattr(level, name)) is not None]
        for name in ("density", "sites")
    )
    if lattice is None:
        if sites:
            raise SceneError(
                "a level has sites, but no lattice is given: give the lattice, or give the level a "
                "density instead of sites"
            )
        return _kinds(levels, densities), kept
    if not isinstance(lattice, Lattice):
        raise SceneError.of(
            "lattice", lattice, "a lattice if the levels have sites, or None if they have densities"
        )
    if densities:
        raise SceneError(
            "a lattice is given, but a level has a density instead of sites: give the level's sites"
        )
    around = []
    for own in sites:
        views = [
            [[(x - site[0], y - site[1]) for x, y in other] for other in sites] for site in own
        ]
        _same_views(lattice, views)
        if kept:
            cut = lattice.cut([s for view in views[0] for s in view], kept)
            around.append([surroundings(lattice, view, cut) for view in views[0]])
    return _kinds(levels, [lattice.density * len(s) for s in sites], around), kept


def _kinds(
    levels: Sequence[Level],
    densities: Sequence[float],
    around: Sequence[Sequence[Surroundings]] = (),
) -> list[Kind]:
    """One `Kind` of spots for each level (asperities of one shape and height).

    Without `around`, the neighbours are smeared out beyond a circle around each spot.
    """
    share = own_radius(sum(densities))
    each = range(len(densities))
    around = around or [
        [
            Surroundings(None, own_radius(densities[i]) if i == j else share, densities[i])
            for i in each
        ]
        for j in each
    ]
    return [
        Kind(level.profile, level.depth, n, seen)
        for level, n, seen in zip(levels, densities, around, strict=True)
    ]


def _same_views(lattice: Lattice, views: list[list[list[Site]]]) -> None:
    """Raise SceneError if sites of one level see neighbours at different distances."""
    rows = [
        [np.sort(np.concatenate([lattice.distances(s, 4.0) for s in shifts])) for shifts in view]
        for view in views
    ]
    for row in rows[1:]:
        for mine, first in zip(row, rows[0], strict=True):
            if mine.size != first.size or not np.allclose(mine, first, rtol=0, atol=1e-8):
                raise SceneError(
                    "the sites of one level have neighbours at different distances: put these "
                    "sites into separate levels"
                )


def _sites(value: Any) -> tuple[Site, ...]:
    """The sites as pairs of fractions; SceneError if two sites are the same point of the cell."""
    allowed = "one or more pairs of finite numbers, in fractions of the lattice's unit vectors"
    if isinstance(value, str) or not isinstance(value, (Sequence, np.ndarray)) or len(value) == 0:
        raise SceneError.of("sites", value, allowed)
    sites = []
    for pair in value:
        if isinstance(pair, str) or not isinstance(pair, (Sequence, np.ndarray)) or len(pair) != 2:
            raise SceneError.of("sites", value, allowed)
        sites.append((finite("sites", pair[0], allowed), finite("sites", pair[1], allowed)))
    folded = np.array(sites)[:, None] - np.array(sites)
    apart = np.max(np.abs(folded - np.round(folded)), axis=-1) + np.eye(len(sites))
    if np.min(apart) < 1e-9:
        raise SceneError.of(
            "sites",
            value,
            "pairs for different points of the cell (pairs that differ by whole numbers are one "
            "point)",
        )
    return tuple(sites)
