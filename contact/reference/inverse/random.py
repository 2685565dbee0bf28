"""Random exact problems for property-based tests."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from contact.reference.inverse.adhesive import AdhesiveDesign
from contact.reference.inverse.designed import DesignedContact
from contact.reference.inverse.stability import is_stable

Array = NDArray[np.float64]


def random_zones(
    rng: np.random.Generator, zones: int, spread: float = 10.0, fraction: float | None = None
) -> Array:
    """n zones in a cell of length 1 from 0: widths and gaps log-uniform, each within a factor `spread` of its
    kind; the zones together take `fraction` of the cell (random from 0.2 to 0.8 if left out)."""
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

    The load is strain * E_star * cell, the cell being the period or, alone, `length`; see `random_zones` for
    the rest. With a period the left ends lie in [-L/2, L/2), ascending.
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
