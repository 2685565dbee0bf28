"""Random exact problems for property-based tests."""

import numpy as np

from contact.reference.exact.numerics import root
from contact.reference.inverse.adhesive import AdhesiveDesign, is_stable
from contact.reference.inverse.cohesive import CohesiveDesign
from contact.reference.inverse.designed import DesignedContact
from sie import Array


def random_zones(
    rng: np.random.Generator, zones: int, spread: float = 10.0, fraction: float | None = None
) -> Array:
    """Random zones in the cell [0, 1], with log-uniform widths and gaps.

    Parameters
    ----------
    rng : numpy.random.Generator
        Random generator.
    zones : int
        Number of zones n.
    spread : float
        Largest ratio of two widths, and of two gaps.
    fraction : float or None
        Part of the cell in contact; random from 0.2 to 0.8 if left out.

    Returns
    -------
    array, (n, 2)
        The ends, ascending.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.inverse import random_zones
    >>> zones = random_zones(np.random.default_rng(0), 5, fraction=0.3)
    >>> zones.shape, bool(np.isclose(np.sum(np.diff(zones)), 0.3))
    ((5, 2), True)
    >>> bool(np.all(np.diff(zones.ravel()) > 0))
    True
    """
    share = rng.uniform(0.2, 0.8) if fraction is None else fraction
    width = np.exp(rng.uniform(0.0, np.log(spread), zones))
    gap = np.exp(rng.uniform(0.0, np.log(spread), zones))
    steps = np.stack(
        [gap * ((1.0 - share) / np.sum(gap)), width * (share / np.sum(width))], axis=1
    ).ravel()
    return np.cumsum(steps).reshape(zones, 2)


def random_problem(
    rng: np.random.Generator,
    zones: int | None = None,
    period: float | None = None,
    *,
    E_star: float = 1.0,
    strain: float = 0.05,
    length: float = 1.0,
    **spacing: float | None,
) -> DesignedContact:
    """A random frictionless contact problem with an exact solution, without symmetry.

    With a period the left ends lie in [-L/2, L/2), ascending.

    Parameters
    ----------
    rng : numpy.random.Generator
        Random generator.
    zones : int or None
        Number of zones; None: random from 1 to 12.
    period : float or None
        Period L [m]; None: the body is isolated.
    E_star : float
        Reduced modulus [Pa].
    strain : float
        The load is strain * E_star * cell; the cell is the period, or `length` without one.
    length : float
        Length of the cell of an isolated body [m].
    **spacing : float
        spread and fraction of `random_zones`, by name.

    Returns
    -------
    DesignedContact

    Raises
    ------
    SceneError
        If a number is not positive and finite.

    Examples
    --------
    The zones carry the load together.

    >>> import numpy as np
    >>> from contact.inverse import random_problem
    >>> made = random_problem(np.random.default_rng(0), zones=4, period=1.0, strain=0.02)
    >>> len(made.zones), bool(np.isclose(np.sum(made.zone_loads), 0.02))
    (4, True)
    """
    count = int(rng.integers(1, 13)) if zones is None else zones
    cell = length if period is None else period
    unit = random_zones(rng, count, **spacing)  # type: ignore[arg-type]
    shift = rng.uniform(-0.5, 0.5)
    if period is None:
        ends = cell * (unit + (shift - 0.5))
    else:
        turned = unit + shift - np.floor(unit[:, :1] + shift + 0.5)
        ends = cell * turned[np.argsort(turned[:, 0])]
    return DesignedContact(ends, E_star, strain * E_star * cell, period)


def random_adhesive_problem(
    rng: np.random.Generator,
    zones: int | None = None,
    period: float | None = None,
    *,
    pull: float = 1.0,
    stable: bool = True,
    **shape: float,
) -> AdhesiveDesign:
    """A random problem with an exact solution under JKR adhesion.

    The zones are those of `random_problem`.

    To choose the work of adhesion w, each zone is taken as an isolated flat punch, with the JKR
    intensity sqrt(E* w/pi) at its corners. The loads of these punches add up to `pull` times the
    load. `pull` is halved until the surfaces are separate between the zones and, if asked for, the
    contact is stable.

    Parameters
    ----------
    rng : numpy.random.Generator
        Random generator.
    zones : int or None
        Number of zones; None: random from 1 to 6.
    period : float or None
        Period L [m]; None: the body is isolated.
    pull : float
        First value of the load of the flat punches divided by the load.
    stable : bool
        Whether the contact must be locally stable at its load.
    **shape : float
        E_star, strain, spread, fraction and length of `random_problem`, by name.

    Returns
    -------
    AdhesiveDesign

    Raises
    ------
    SceneError
        If a number is not positive and finite.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.inverse import is_stable, random_adhesive_problem
    >>> made = random_adhesive_problem(np.random.default_rng(0), zones=2, period=1.0)
    >>> len(made.zones), made.is_admissible, is_stable(made)
    (2, True, True)
    """
    count = int(rng.integers(1, 7)) if zones is None else zones
    free = random_problem(rng, count, period, **shape)  # type: ignore[arg-type]
    unit = np.sum(np.sqrt(np.pi * free.E_star * free.zone_widths))
    while True:
        work = float((pull * free.load / unit) ** 2)
        adhesive = AdhesiveDesign(free.zones, free.E_star, free.load, work, period)
        if adhesive.is_admissible and (not stable or is_stable(adhesive)):
            return adhesive
        pull *= 0.5


def random_cohesive_problem(
    rng: np.random.Generator,
    zones: int | None = None,
    *,
    pull: float = 0.5,
    strip: float = 0.1,
    **shape: float,
) -> CohesiveDesign:
    """A random isolated problem with an exact solution under Dugdale's law.

    The zones are those of `random_problem`, which gives a frictionless contact. The tension acts
    where the gap of this contact is below the reach. To choose the reach, one point is taken
    outside each zone end, at the distance `strip` times the width of the narrowest zone or gap. The
    reach is the median of the gap at these points. The first tension is `pull` times the mean
    pressure; it is quartered until the design is admissible. As the tension tends to zero, the
    design tends to the frictionless contact, which is admissible.

    Parameters
    ----------
    rng : numpy.random.Generator
        Random generator.
    zones : int or None
        Number of zones; None: random from 1 to 6.
    pull : float
        First value of the tension divided by the mean pressure of the zones.
    strip : float
        Width of a strip of tension, divided by the width of the narrowest zone or gap.
    **shape : float
        E_star, strain, spread, fraction and length of `random_problem`, by name.

    Returns
    -------
    CohesiveDesign

    Raises
    ------
    SceneError
        If a number is not positive and finite.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.inverse import random_cohesive_problem
    >>> made = random_cohesive_problem(np.random.default_rng(0), zones=4)
    >>> len(made.zones), made.is_admissible
    (4, True)
    """
    count = int(rng.integers(1, 7)) if zones is None else zones
    free = random_problem(rng, count, **shape)  # type: ignore[arg-type]
    # The coordinate x is measured from the middle of the zones, since the polynomial profile is
    # most accurate near x = 0.
    ends = free.zones - 0.5 * (free.zones[0, 0] + free.zones[-1, 1])
    free = DesignedContact(ends, free.E_star, free.load)
    width = strip * float(np.diff(ends.ravel()).min())
    outside = np.concatenate((ends[:, 0] - width, ends[:, 1] + width))
    reach = float(np.median(free.gap(outside)))
    hull = ends[-1, 1] - ends[0, 0]
    before = [ends[0, 0] - hull, *ends[:-1, 1]]
    after = [*ends[1:, 0], ends[-1, 1] + hull]
    left = [_first_at(free, *ab, reach) for ab in zip(ends[:, 0].tolist(), before, strict=True)]
    right = [_first_at(free, *ab, reach) for ab in zip(ends[:, 1].tolist(), after, strict=True)]
    # Two zones share a cohesive interval if the gap between the zones stays below `reach`, the
    # largest gap with tension.
    rows = [[left[0], 0.0]]
    for k in range(count - 1):
        if left[k + 1] > right[k]:
            rows[-1][1] = right[k]
            rows.append([left[k + 1], 0.0])
    rows[-1][1] = right[-1]
    mean = float(free.load / np.diff(ends, axis=1).sum())
    while True:
        stress, rise = pull * mean, pull * mean / free.E_star
        made = CohesiveDesign(
            ends, np.array(rows), free.E_star, stress * reach, stress, rise, free.load
        )
        if made.is_admissible:
            return made
        pull *= 0.25


def _first_at(free: DesignedContact, start: float, stop: float, reach: float) -> float:
    """The x nearest to `start`, between `start` and `stop`, at which the gap equals `reach`.
    If there is no such x, `stop` is returned.
    """
    x = start + (stop - start) * np.linspace(0.0, 1.0, 2001)[1:] ** 2
    above = np.flatnonzero(free.gap(x) > reach)
    if len(above) == 0:
        return stop
    before = start if above[0] == 0 else x[above[0] - 1]
    return root(lambda at: float(free.gap(np.array(at))) - reach, before, x[above[0]])
