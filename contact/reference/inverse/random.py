"""Random exact problems for property-based tests."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from contact.reference.inverse.designed import DesignedContact

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
