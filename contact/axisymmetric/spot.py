r"""Equal spots on a lattice by the localization principle: the paper's equations (1) to (4).

There are N spots per unit area, with the radius a and the load P_s. p_f is the pressure, and P_f
the load, of one spot without neighbours. With `rings` = 0, equations (1) and (4) hold: the nominal
pressure N P_s acts outside the circle of radius A = (pi N)^(-1/2) around the spot,

    p(r) = p_f(r) + (2/pi) N P_s arctan(sqrt(a^2 - r^2)/sqrt(A^2 - a^2)),
    P_s = 2 pi int_0^a p r dr,

so P_s (1 - F) = P_f(a), F = (2/pi)[arcsin(a/A) - (a/A) sqrt(1 - a^2/A^2)]. With `rings` = n, n
rings of neighbours are treated at their places; with `math.inf`, all of them. Then the only
approximation is the mean over the angle.

The number of nodes is increased until the result does not change. The stated error is the observed
change.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from math import asin, inf, isinf, pi, sqrt
from typing import Any

import numpy as np

from contact.axisymmetric.answer import Spot
from contact.axisymmetric.lattices import Density, Lattice, as_lattice, own_radius
from contact.axisymmetric.neighbours import Surroundings, surroundings
from contact.axisymmetric.profiles import AxisymmetricProfile, as_profile
from contact.axisymmetric.system import (
    Condition,
    Kind,
    Linear,
    State,
    closed_edge,
    force,
    solve_radii,
    touching,
)
from contact.errors import NotConverged, OutOfRange, SceneError
from contact.model.checks import integer, positive
from contact.model.profiles.noise import EPS
from contact.reference.exact.numerics import root
from sie import Array


def solve_spot(
    profile: Any,
    E_star: float,
    lattice: Lattice | Density | None = None,
    *,
    load: float | None = None,
    nominal_pressure: float | None = None,
    spot_radius: float | None = None,
    rings: float = 0,
    tol: float = 1e-10,
) -> Spot:
    """Solve for a spot, alone or among equal ones, at a given load, pressure or radius.

    Parameters
    ----------
    profile : AxisymmetricProfile or callable
        The shape, such as `Sphere(radius)`, or f(r) [m].
    E_star : float
        Reduced modulus [Pa].
    lattice : Lattice or Density or None
        The places of the other spots; None: the spot is alone.
    load, nominal_pressure, spot_radius : float or None
        The control: exactly one of them [N, Pa, m].
    rings : float
        Number of rings of neighbours treated at their places, up to inf; 0: the first step of the
        localization.
    tol : float
        Largest allowed relative error of the solution; the error of the model is not included.

    Returns
    -------
    Spot

    Raises
    ------
    SceneError, OutOfRange, NotConverged
        If the input is invalid, the control has no solution, or the tolerance was not reached.

    Examples
    --------
    Hertz: a^3 = 3 P R / (4 E*) (K. L. Johnson, Contact Mechanics, 1985, doi
    10.1017/CBO9781139171731, section 4.2).

    >>> from contact.axisymmetric import Sphere, solve_spot
    >>> spot = solve_spot(Sphere(radius=1e-3), 1e11, load=1.0)
    >>> round(spot.radius**3 / (0.75 * 1e-3 / 1e11), 9)
    1.0
    """
    shape, E = as_profile(profile), positive("E_star", E_star)
    place = as_lattice(lattice)
    kept, tol = ring_count(rings, place), positive("tol", tol)
    name, value = one_control(load=load, nominal_pressure=nominal_pressure, spot_radius=spot_radius)
    density = 0.0 if place is None else place.density
    if name == "nominal_pressure":
        if place is None:
            raise SceneError(
                "nominal_pressure needs a lattice or a density",
                name,
                value,
                "left out for a spot alone",
            )
        value /= density

    seen = _seen(place, kept)
    kinds = [Kind(shape, 0.0, density, [seen])]
    limit = min(inf if seen.kernel is None else 0.5 * seen.kernel.nearest, seen.circle or inf)
    if name == "spot_radius":
        if not value < limit:
            raise OutOfRange(
                f"spot_radius = {value:.6g} m is out of range: it must be below {limit:.6g} m, "
                "to leave room for the neighbouring spots"
            )
        states: Iterable[State] = (
            Linear(kinds, np.array([value]), n).solve(closed_edge(0)) for n in NODES
        )
    else:
        start = first_radius(shape.load_integral, value / E, 1.0 if isinf(limit) else limit)
        states = refinements(kinds, np.array([min(start, 0.9 * limit)]), force(0, value / E))
    return refined(states, lambda state: [spot_of(0, kinds, state, E, kept)], tol)[0]


def correction_share(ratio: float) -> float:
    """Share F(a/A) of a spot's load that is due to the nominal pressure on its surroundings.
    a is the radius of the spot, A the radius of the circle whose area is the area per spot.

    F(q) = (2/pi)(arcsin q - q sqrt(1 - q^2)).

    In the first step of the localization, the nominal pressure outside the circle of radius A adds
    F P_s to the load P_s of the spot.

    Parameters
    ----------
    ratio : float
        q = a/A, from 0 to 1: radius of the spot, divided by the radius of the circle.

    Returns
    -------
    float

    Raises
    ------
    SceneError
        If the ratio is not from 0 to 1.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.axisymmetric import correction_share
    >>> correction_share(0.0), bool(np.isclose(correction_share(1.0), 1.0))
    (0.0, True)
    >>> bool(np.isclose(correction_share(0.5), 1 / 3 - np.sqrt(0.75) / np.pi))
    True
    """
    if not 0.0 <= ratio <= 1.0:
        raise SceneError.of("ratio", ratio, "a number from 0 to 1")
    return 2.0 / pi * (asin(ratio) - ratio * sqrt((1.0 - ratio) * (1.0 + ratio)))


def first_step_load(profile: Any, E_star: float, density: float, spot_radius: float) -> float:
    """Load of a spot of a given radius, with its neighbours replaced by a mean pressure.
    This is the first step of the localization method.

    The load is P_s = P_f(a)/(1 - F(a/A)), in the notation at the head of this module. It is the
    closed form of the paper's equations (1) and (4).

    Parameters
    ----------
    profile : AxisymmetricProfile or callable
        The shape, or f(r) [m].
    E_star : float
        Reduced modulus [Pa].
    density : float
        Spots per unit area [1/m^2].
    spot_radius : float
        Radius a of the spot, below A = (pi N)^(-1/2) [m].

    Returns
    -------
    float
        [N].

    Raises
    ------
    SceneError
        If a number is not positive and finite.
    OutOfRange
        If the spot is not smaller than the circle A.

    Examples
    --------
    `solve_spot` with `rings=0` gives the same.

    >>> import numpy as np
    >>> from contact.axisymmetric import Density, Sphere, first_step_load, solve_spot
    >>> spot = solve_spot(Sphere(1e-3), 1e11, Density(1e8), spot_radius=2e-5)
    >>> bool(np.isclose(spot.load, first_step_load(Sphere(1e-3), 1e11, 1e8, 2e-5)))
    True
    """
    A = own_radius(positive("density", density))
    a = positive("spot_radius", spot_radius)
    if not a < A:
        raise OutOfRange(
            f"spot_radius = {a:.6g} m is out of range: it must be below A = {A:.6g} m, the radius "
            "of a circle with the area per spot"
        )
    shape: AxisymmetricProfile = as_profile(profile)
    return positive("E_star", E_star) * shape.load_integral(a) / (1.0 - correction_share(a / A))


def one_control(**given: float | None) -> tuple[str, float]:
    """(name, value) of the control that is given, such as the load.
    Raises SceneError unless exactly one is given, with a positive value.
    """
    named = {name: value for name, value in given.items() if value is not None}
    if len(named) != 1:
        got = ", ".join(named) or "none"
        raise SceneError(f"exactly one of {', '.join(given)} must be given (got {got})")
    name, value = next(iter(named.items()))
    return name, positive(name, value)


def ring_count(rings: Any, place: Lattice | Density | None) -> float:
    """The number of rings of neighbours that are summed as single spots, whole or inf.
    Raises SceneError for a positive number without a lattice, as the neighbours then have no
    positions.
    """
    count: float = inf if isinstance(rings, float) and rings == inf else integer("rings", rings)
    if count > 0 and not isinstance(place, Lattice):
        raise SceneError.of(
            "rings", rings, "0 without a lattice, which gives the positions of the neighbours"
        )
    return count


def _seen(place: Lattice | Density | None, rings: float) -> Surroundings:
    if place is None:
        return Surroundings()
    if not isinstance(place, Lattice):
        return Surroundings(None, own_radius(place.density), place.density)
    origin = [(0.0, 0.0)]
    return surroundings(place, origin, place.cut(origin, rings))


# Numbers of Gauss nodes per spot that are tried one after another, until the solution stops
# changing.
NODES = (16, 32, 64, 128, 256)
# Radii, relative to the spot's radius, at which the pressures of two successive numbers of nodes
# are compared.
_PROBES = np.array([0.1, 0.5, 0.9])


def refinements(kinds: Sequence[Kind], start: Array, condition: Condition) -> Iterator[State]:
    """Yield solutions for increasing numbers of Gauss nodes.
    Newton's method starts each solution from the radii of the previous one.
    """
    for n in NODES:
        state = solve_radii(kinds, start, condition, n)
        start = state.radii
        yield state


def spot_of(j: int, kinds: Sequence[Kind], state: State, E_star: float, rings: float) -> Spot:
    """The spot of kind j, taken from a solved system."""
    kind, reach = kinds[j], inf
    for i in touching(state.radii):
        seen = kind.around[i]
        if seen.kernel is not None:
            reach = min(reach, seen.kernel.nearest - float(state.radii[i]))
        elif seen.circle > 0:
            reach = min(reach, seen.circle)
    return Spot(
        kind.profile,
        E_star,
        float(state.radii[j]),
        E_star * float(state.forces[j]),
        kind.depth,
        state.delta,
        kind.density,
        rings,
        state.surfaces[j],
        reach,
    )


def refined(
    states: Iterable[State], spots_of: Callable[[State], list[Spot]], tol: float
) -> list[Spot]:
    """The checked spots of the first solution that differs by at most tol from the previous one.
    The solutions in `states` have increasing numbers of Gauss nodes.
    """
    last: list[Spot] | None = None
    trace: list[float] = []
    for state in states:
        spots = spots_of(state)
        for spot in spots:
            if not spot.load > 0:
                raise OutOfRange(
                    "no contact has the given control value: a spot of radius "
                    f"{spot.radius:.6g} m would carry a negative load or none"
                )
        if not any(spot.surface.sources for spot in spots):
            trace.append(0.0)  # the first step of the localization is in closed form
        else:
            trace.append(inf if last is None else max(map(_difference, spots, last)))
        if trace[-1] <= tol:
            return [_stated(spot, trace, tol) for spot in spots]
        last = spots
    raise NotConverged(
        f"with {NODES[-1]} nodes per spot the solution still changes by {trace[-1]:.2e}, "
        f"above tol = {tol:.2e}",
        trace,
        last,
    )


def _difference(new: Spot, old: Spot) -> float:
    """Largest relative change of load, radius and pressure of a spot between two solutions.
    The solutions have different numbers of Gauss nodes.

    Pressures are compared at equal r/a, relative to the mean.
    """
    pressure = new.pressure(_PROBES * new.radius) - old.pressure(_PROBES * old.radius)
    return max(
        abs(new.load / old.load - 1.0),
        abs(new.radius / old.radius - 1.0),
        float(np.max(np.abs(pressure))) / new.mean_pressure,
    )


def _stated(spot: Spot, trace: list[float], tol: float) -> Spot:
    """The spot with its stated error, the largest of several estimates.
    Raises NotConverged if the error exceeds `tol`.

    The estimates are the last change in `trace`, the error of the balance of load and pressure, the
    error of numerical derivatives of the shape, and round-off.
    """
    spot.check()
    # The penetration of a tiny spot is the difference of two much larger numbers: the approach, and
    # the depth of its tip below the highest tips. So it has the round-off of both.
    own = float(spot.profile.line(spot.radius))
    derived = spot.profile.derived_error(spot.radius) * spot.E_star / spot.mean_pressure
    error = max(
        trace[-1],
        abs(spot.balance()),
        64 * EPS,  # round-off of a few transforms
        derived,
        4 * EPS * (abs(spot.approach) + spot.depth) / own,
    )
    spot = replace(spot, error=error)
    if error > tol and error == derived:
        raise NotConverged(
            f"rounding of the heights causes an error of {error:.2e} in the pressure, above "
            f"tol = {tol:.2e}: give slope_of, or a height function that accepts complex numbers or "
            "has no cancellation near the tip (2 sinh(r/2)^2, not cosh(r) - 1), or a larger tol",
            trace,
            spot,
        )
    if error > tol:
        raise NotConverged(
            "the error of the balance of load and pressure, or the round-off, is "
            f"{error:.2e}, above tol = {tol:.2e}: the profile's derivatives may be inaccurate, or "
            "tol may be too small for round-off",
            trace,
            spot,
        )
    return spot


def first_radius(
    growing: Callable[[float], Any], target: float, scale: float, ratio: float = 2.0**0.125
) -> float:
    """The smallest radius at which a quantity that grows from 0 reaches the target.

    It is a start for Newton's method. If the quantity falls before it reaches the target, the
    branch from zero load ends there, and OutOfRange is raised. ratio: ratio of successive trial
    radii; a smaller one only costs time.
    """
    a = 1e-3 * scale
    # The first radius `a` is halved until 0 <= growing(a) < target, where `growing` is the quantity
    # that grows with the radius. A negative value is round-off, which occurs if a steep flank
    # begins far out.
    while not 0.0 <= growing(a) < target and a >= 1e-60 * scale:
        a *= 0.5
    last = growing(a)
    for _ in range(2000):
        new = growing(a * ratio)
        if not np.isfinite(new) or new < last * (1.0 - 1e-9):
            raise OutOfRange(
                "no spot has the given load or approach: the load or approach of a spot falls "
                f"beyond a radius of {a:.6g} m"
            )
        if new >= target:
            return root(lambda radius: float(growing(radius)) - target, a, a * ratio)
        a, last = a * ratio, new
    raise OutOfRange("no spot of any radius has the given load or approach")
