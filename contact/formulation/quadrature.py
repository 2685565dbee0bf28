"""Gauss rules over a period, and on panels whose nodes crowd at both ends.

The crowded nodes integrate logarithms and powers at the ends of a panel without loss of digits.
"""

import math
from functools import lru_cache

import numpy as np

from contact.model.profiles.base import Profile
from contact.model.profiles.noise import EPS
from sie import Array

IN_PANEL = 32  # nodes of a panel with crowded nodes
_PERIOD_NODES = 12  # nodes of a panel in a rule over a period
# Number of halvings of the panels next to an algebraic point. At the distance y from this point,
# the profile varies as |y|^n with n > 1. So its integral over the last panel, of width h, is below
# h^2. After these halvings, h^2 is round-off.
_HALVINGS = int(-np.log2(np.sqrt(EPS)))


@lru_cache(maxsize=1)
def crowded() -> tuple[Array, Array]:
    """Gauss nodes on (0, 1), concentrated at both ends by a polynomial, and their weights.

    The polynomial is u^5 (126 - 420 u + 540 u^2 - 315 u^3 + 70 u^4), with slope 630 u^4 (1 - u)^4.
    """
    t, weight = np.polynomial.legendre.leggauss(IN_PANEL)
    u = 0.5 * (1 + t)
    nodes = u**5 * (126 - 420 * u + 540 * u**2 - 315 * u**3 + 70 * u**4)
    return nodes, 0.5 * weight * 630 * (u * (1 - u)) ** 4


def chebyshev_nodes(count: int) -> Array:
    """Chebyshev nodes cos((k + 1/2) pi / count) on (-1, 1), from right to left."""
    return np.asarray(np.cos((np.arange(count) + 0.5) * np.pi / count))


def sides(angle: Array) -> tuple[Array, Array]:
    """Distances of x = middle + half cos(angle) from both interval ends, divided by `half`."""
    return 2 * np.cos(angle / 2) ** 2, 2 * np.sin(angle / 2) ** 2


@lru_cache(maxsize=8)
def _legendre(count: int) -> tuple[Array, Array]:
    """Gauss nodes and weights on (-1, 1), cached: to compute them takes an eigenvalue problem."""
    return np.polynomial.legendre.leggauss(count)


def gauss(cuts: Array, count: int) -> tuple[Array, Array]:
    """Gauss nodes and weights, with `count` nodes between each cut and the next."""
    t, weights = _legendre(count)
    half, middle = 0.5 * np.diff(cuts)[:, None], 0.5 * (cuts[1:] + cuts[:-1])[:, None]
    return np.asarray((middle + half * t).ravel()), np.asarray((half * weights).ravel())


def cuts_between(a: float, b: float, spacing: float, breaks: Array) -> Array:
    """Places from a to b, at most `spacing` apart, and the breaks between a and b."""
    even = np.linspace(a, b, max(1, math.ceil((b - a) / spacing)) + 1)
    return np.unique(np.concatenate((even, breaks[(breaks > a) & (breaks < b)])))


def panels(cuts: Array, count: int = 1) -> tuple[Array, Array]:
    """Nodes and weights on panels between ascending cuts; nodes crowd at both ends of a panel.

    There are about `count` nodes, and at least one panel between two cuts.
    """
    u, weight = crowded()
    parts = max(1, -(-count // (IN_PANEL * (len(cuts) - 1))))
    at = np.arange(parts + 1) / parts
    cuts = np.append((cuts[:-1, None] + np.diff(cuts)[:, None] * at[:-1]).ravel(), cuts[-1])
    width = np.diff(cuts)[:, None]
    # Each node is computed from the nearer end of its panel. So its distance from this end keeps
    # all digits.
    nodes = np.where(u <= 0.5, cuts[:-1, None] + width * u, cuts[1:, None] - width * (1 - u))
    return nodes.ravel(), (width * weight).ravel()


def over_period(profile: Profile, least: int = 8) -> tuple[Array, Array, Array]:
    """Gauss rule over a period: places [m], places as fractions of the period, and weights.

    The weights have the sum 1. There are at least `least` panels, split at breakpoints. They are no
    longer than half the profile's resolution, unless more than 2^16 panels would be needed.
    """
    length = profile.period
    assert length is not None
    panels = int(
        np.clip(np.ceil(2 * length / (profile.resolution or length / 8)), max(8, least), 2**16)
    )
    inner = (np.asarray(profile.breakpoints) - profile.x0) / length
    points = (np.asarray(profile.algebraic_points)[:, :1] - profile.x0) / length
    graded = (
        points + np.outer([1.0, -1.0], 0.5 ** np.arange(1, _HALVINGS + 1) / panels).ravel()
    ).ravel()
    inner = np.concatenate((inner, graded, graded + 1.0))
    cuts = np.unique(
        np.concatenate((np.arange(panels + 1) / panels, inner[(inner > 0) & (inner < 1)]))
    )
    turns, weights = gauss(cuts, _PERIOD_NODES)
    return profile.x0 + length * turns, turns, weights
