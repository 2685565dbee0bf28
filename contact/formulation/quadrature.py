"""Gauss's rule over a period, and with nodes that crowd at both ends of a panel, so that logarithms
and powers there cost no digits.
"""

import math
from functools import lru_cache

import numpy as np

from contact.model.profiles.base import Profile
from sie import Array

# Panels on either side of an algebraic point halve in length this often: what the last one misses
# of |y|^n, n > 1, is 2^(-2 * 28).
_HALVED = 28
# Nodes of a panel that crowd at its ends, and of one of a period.
IN_PANEL = 32
_OF_PERIOD = 12


@lru_cache(maxsize=1)
def crowded() -> tuple[Array, Array]:
    """Gauss's nodes on (0, 1) by u^5 (126 - 420 u + 540 u^2 - 315 u^3 + 70 u^4), of slope 630 u^4
    (1 - u)^4, and their weights.
    """
    t, weight = np.polynomial.legendre.leggauss(IN_PANEL)
    u = 0.5 * (1 + t)
    nodes = u**5 * (126 - 420 * u + 540 * u**2 - 315 * u**3 + 70 * u**4)
    return nodes, 0.5 * weight * 630 * (u * (1 - u)) ** 4


def chebyshev_nodes(count: int) -> Array:
    """cos((k + 1/2) pi / count), from right to left on (-1, 1)."""
    return np.asarray(np.cos((np.arange(count) + 0.5) * np.pi / count))


def sides(angle: Array) -> tuple[Array, Array]:
    """Distances of middle + half cos(angle) from the left and the right end of an interval, over
    its half width.
    """
    return 2 * np.cos(angle / 2) ** 2, 2 * np.sin(angle / 2) ** 2


def gauss(cuts: Array, count: int) -> tuple[Array, Array]:
    """So many of Gauss's nodes between each two ascending cuts, and their weights."""
    t, weights = np.polynomial.legendre.leggauss(count)
    half, middle = 0.5 * np.diff(cuts)[:, None], 0.5 * (cuts[1:] + cuts[:-1])[:, None]
    return np.asarray((middle + half * t).ravel()), np.asarray((half * weights).ravel())


def cuts_between(a: float, b: float, spacing: float, breaks: Array) -> Array:
    """From a to b, no farther apart than the spacing, those of the breaks that lie between among
    them.
    """
    even = np.linspace(a, b, max(1, math.ceil((b - a) / spacing)) + 1)
    return np.unique(np.concatenate((even, breaks[(breaks > a) & (breaks < b)])))


def panels(cuts: Array, count: int = 1) -> tuple[Array, Array]:
    """About so many nodes, and weights, between ascending cuts; one panel at the least between
    neighbours.
    """
    u, weight = crowded()
    parts = max(1, -(-count // (IN_PANEL * (len(cuts) - 1))))
    at = np.arange(parts + 1) / parts
    cuts = np.append((cuts[:-1, None] + np.diff(cuts)[:, None] * at[:-1]).ravel(), cuts[-1])
    width = np.diff(cuts)[:, None]
    # From the nearer cut, so that nodes beside it keep their distance.
    nodes = np.where(u <= 0.5, cuts[:-1, None] + width * u, cuts[1:, None] - width * (1 - u))
    return nodes.ravel(), (width * weight).ravel()


def over_period(profile: Profile, least: int = 8) -> tuple[Array, Array, Array]:
    """Nodes [m], the same in periods from the beginning of the cell, and weights that add up to
    one: between breakpoints, panels as short as the resolution, and `least` of them.
    """
    length = profile.period
    assert length is not None
    panels = int(
        np.clip(np.ceil(2 * length / (profile.resolution or length / 8)), max(8, least), 2**16)
    )
    inner = (np.asarray(profile.breakpoints) - profile.x0) / length
    points = (np.asarray(profile.algebraic_points)[:, :1] - profile.x0) / length
    beside = (points + np.outer([1.0, -1.0], 0.5 ** np.arange(1, _HALVED) / panels).ravel()).ravel()
    inner = np.concatenate((inner, beside, beside + 1.0))
    cuts = np.unique(
        np.concatenate((np.arange(panels + 1) / panels, inner[(inner > 0) & (inner < 1)]))
    )
    turns, weights = gauss(cuts, _OF_PERIOD)
    return profile.x0 + length * turns, turns, weights
