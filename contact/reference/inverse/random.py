"""Random exact problems for property-based tests."""

from __future__ import annotations

import numpy as np

from contact.reference.inverse.adhesive import AdhesiveDesign
from contact.reference.inverse.designed import DesignedContact
from contact.reference.inverse.stability import is_stable
from sie import Array


def random_zones(
    rng: np.random.Generator, zones: int, spread: float = 10.0, fraction: float | None = None
) -> Array:
    """Random zones in a cell of length 1 from 0: widths and gaps log-uniform, each within a factor `spread` of its kind.

    Parameters
    ----------
    rng : numpy.random.Generator
        Where the numbers come from.
    zones : int
        How many zones n.
    spread : float
        Largest ratio of two widths, and of two gaps.
    fraction : float or None
        What the zones together take of the cell; random from 0.2 to 0.8 if left out.

    Returns
    -------
    array, (n, 2)
        The ends, ascending.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.inverse import random_zones
    >>> zones = random_zones(np.random.default_rng(0), 5, fraction=0.3)
    >>> zones.shape, bool(np.isclose(np.sum(np.diff(zones)), 0.3)), bool(np.all(np.diff(zones.ravel()) > 0))
    ((5, 2), True, True)
    """
    share = rng.uniform(0.2, 0.8) if fraction is None else fraction
    width = np.exp(rng.uniform(0.0, np.log(spread), zones))
    gap = np.exp(rng.uniform(0.0, np.log(spread), zones))
    steps = np.stack([gap * ((1.0 - share) / np.sum(gap)), width * (share / np.sum(width))], axis=1).ravel()
    return np.cumsum(steps).reshape(zones, 2)


def random_problem(
    rng: np.random.Generator,
    zones: int | None = None,
    period: float | None = None,
    *,
    E_star: float = 1.0,
    strain: float = 0.05,
    spread: float = 10.0,
    fraction: float | None = None,
    length: float = 1.0,
) -> DesignedContact:
    """A random exact problem of 1 to 12 (or the given number of) zones, asymmetric and off the origin.

    With a period the left ends lie in [-L/2, L/2), ascending.

    Parameters
    ----------
    rng : numpy.random.Generator
        Where the numbers come from.
    zones : int or None
        How many zones; None: 1 to 12.
    period : float or None
        Period L [m]; None: the body is alone.
    E_star : float
        Reduced modulus [Pa].
    strain : float
        The load is strain * E_star * cell, the cell being the period or, alone, `length`.
    spread, fraction : float
        See `random_zones`.
    length : float
        Length of the cell of a body that is alone [m].

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
    unit = random_zones(rng, count, spread, fraction)
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
    """A random JKR contact of 1 to 6 (or the given number of) zones, else as `random_problem`.

    The work of adhesion is that whose flat punches of these widths carry `pull` times the load together, halved until the
    surfaces keep apart between the zones and, if it is to be stable, the contact is so under its load.

    Parameters
    ----------
    rng : numpy.random.Generator
        Where the numbers come from.
    zones : int or None
        How many zones; None: 1 to 6.
    period : float or None
        Period L [m]; None: the body is alone.
    pull : float
        Load of the flat punches over the load, to begin with.
    stable : bool
        Whether the contact has to be locally stable under its load.
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
