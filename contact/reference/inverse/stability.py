"""Local stability of a designed JKR contact: the second variation of its energy by its ends, under a held load.

An end that moves outward by ds releases G ds and costs w ds, G = (pi/E*) K^2 of the end's own intensity, so that the potential's
second derivatives are dG_i/ds_j = 2 w d ln K_i/ds_j. Moving the end e_j at a held load adds to X R (see adhesive.py) the field

    (A/(x - e_j) + T)/X,   A = +-(product of the other factors) q_j/2,

which has the power -3/2 at e_j; T, of degree n - 2 (with a period of the frequencies n - 2, n - 4, ..), keeps the approaches of
all zones equal: the finite part of its integral over every gap vanishes. Derived here; the matrix is symmetric because it is a
second derivative, which nothing in its making supposes.
"""

from math import pi
from typing import Any

import numpy as np

from contact.reference.inverse.adhesive import AdhesiveDesign
from sie import Array


def second_variation(design: AdhesiveDesign) -> Array:
    """Second derivatives of the energy of a designed JKR contact by its ends, d^2 energy/ds_i ds_j, at a held load.

    The contact is locally stable under that load where the matrix is positive definite. Derived here, see the head of this module.

    Parameters
    ----------
    design : AdhesiveDesign
        The contact, of n zones.

    Returns
    -------
    array, (2 n, 2 n)
        [J/m^3], by the outward movements of the ends in ascending order.

    Examples
    --------
    At pull-off of a cylinder, a^3 = 2 R^2 w/(pi E*), the zone can widen on both sides without force.

    >>> import numpy as np
    >>> from contact.inverse import adhesive_design, second_variation
    >>> load = np.pi / 4 - np.pi  # R = E* = a = 1 and w = pi/2
    >>> matrix = second_variation(adhesive_design([[-1.0, 1.0]], E_star=1.0, load=load, work=np.pi / 2))
    >>> bool(np.allclose(matrix, matrix.T)), bool(abs(np.sum(matrix)) < 1e-9 * np.max(np.abs(matrix)))
    (True, True)
    """
    product, n = design._product, len(design.zones)
    m, q = 2 * n, design._poles.astype(float)
    right = np.arange(m) % 2 == 1
    outward = np.where(right, 1.0, -1.0)
    side = np.array([design._side(i) for i in range(-1, m)])  # of X on the interval i at [i + 1]
    sigma = np.where(right, side[np.arange(m) + 1], side[np.arange(m)])
    unit = float(product._unit) if design.period is None else design.period / (2.0 * pi)
    others = product.end_factors()
    root = np.sqrt(others)
    k = outward * sigma * root * q  # X R ~ k/sqrt|factor| in the gap beside the end
    poles = _between(design)
    modes = np.array([_slow(design, *_at_end(product, e)) for e in range(m)]).reshape(m, n - 1)
    strength = outward * others * q / (2.0 * unit)
    answers = _slow_parts(design, strength, unit)
    regular = np.array([_full(design, *_at_end(product, e)) for e in range(m)]) @ design._smooth.astype(float)
    regular = regular + poles @ q
    change = np.empty((m, m))  # d k_i/d e_j
    for j in range(m):
        slow = modes @ answers[j]
        change[:, j] = sigma / root * (strength[j] * poles[:, j] + slow)
        # The next power of X R at the end, half of which the moved root gives; the bend of the other factors cancels.
        change[j, j] = sigma[j] * (outward[j] * root[j] * regular[j] / (2.0 * unit) + slow[j] / root[j])
    return np.asarray(2.0 * design.work * change / k[:, None] * outward, dtype=float)


def is_stable(design: AdhesiveDesign) -> bool:
    """Whether a designed JKR contact is locally stable under a held load: the second variation is positive definite.

    Derived here, see the head of this module.

    Parameters
    ----------
    design : AdhesiveDesign
        The contact.

    Returns
    -------
    bool

    Examples
    --------
    A cylinder is stable where its zone is wider than at pull-off, a^3 = 2 R^2 w/(pi E*).

    >>> import numpy as np
    >>> from contact.inverse import adhesive_design, is_stable
    >>> works = [1.5, 1.6]  # R = E* = a = 1: pull-off at w = pi/2
    >>> loads = [np.pi / 4 - np.sqrt(2 * np.pi * w) for w in works]
    >>> [is_stable(adhesive_design([[-1.0, 1.0]], 1.0, load, w)) for load, w in zip(loads, works)]
    [True, False]
    """
    matrix = second_variation(design)
    return bool(np.min(np.linalg.eigvalsh(0.5 * (matrix + matrix.T))) > 0.0)


def _at_end(product: Any, e: int) -> tuple[int, Array, Array]:
    """Interval and distances of the place of an end."""
    i = e if e + 1 < 2 * len(product.zones) or product.period is not None else e - 1
    step = np.array([product.steps[i]])
    return (i, np.zeros(1), step) if i == e else (i, step, np.zeros(1))


def _between(design: AdhesiveDesign) -> Array:
    """[i, j]: the pole of end j seen from end i; 0 on the diagonal."""
    ends = design.zones.ravel()
    d = ends[:, None] - ends
    np.fill_diagonal(d, 1.0)
    if design.period is None:
        poles = float(design._product._unit) / d
    else:
        turned = pi / design.period * d
        poles = 0.5 / np.sin(turned) if len(design.zones) % 2 else 0.5 / np.tan(turned)
    np.fill_diagonal(poles, 0.0)
    return poles


def _full(design: AdhesiveDesign, i: int, dl: Array, dr: Array) -> Array:
    return np.asarray(design._modes(design._product, i, dl, dr), dtype=float)[0]


def _slow(design: AdhesiveDesign, i: int, dl: Array, dr: Array) -> Array:
    """The functions of which T is made, (..., n - 1): those of M without the fastest."""
    modes = np.asarray(design._modes(design._product, i, dl, dr), dtype=float)
    return modes[..., :-1] if design.period is None else modes[..., 2:]


def _slow_parts(design: AdhesiveDesign, strength: Array, unit: float) -> Array:
    """Coefficients of T for every end moved, (2n, n - 1)."""
    product, n = design._product, len(design.zones)
    others = product.end_factors()
    m, gaps = 2 * n, list(design._product.gaps)[: n - 1]  # with a period the last gap closes by itself
    matrix, given = np.zeros((n - 1, n - 1)), np.zeros((n - 1, m))
    for row, g in enumerate(gaps):
        dl, dr, weight = (np.asarray(v, dtype=float) for v in design._nodes(g))
        x_root = product.root(g, dl, dr)
        matrix[row] = weight / x_root @ _slow(design, g, dl, dr)
        poles = product.poles(g, dl, dr)
        for j in range(m):
            field = strength[j] * poles[:, j] / x_root
            if j in (g, (g + 1) % m):
                # Less a multiple of d/dx (X pole), whose integral has no finite part, it is integrable.
                share = (-2.0 if j == g else 2.0) * unit * strength[j] / others[j]
                field = field - share * _exact_slope(design, g, dl, dr, j, poles[:, j], x_root)
            given[row, j] = -np.sum(weight * field)
    return np.asarray(np.linalg.solve(matrix, given).T) if n > 1 else np.zeros((m, 0))


def _exact_slope(design: AdhesiveDesign, g: int, dl: Array, dr: Array, j: int, pole: Any, x_root: Any) -> Array:
    """d/dx (|X| pole_j) in the gap g."""
    product = design._product
    ends = product.zones.ravel()
    x = ends[g] + dl
    ahead = x[:, None] - ends
    ahead[:, g] = dl
    other = (g + 1) % len(ends)
    ahead[:, other] = -dr
    if design.period is None:
        bends, fall = 1.0 / ahead, -pole / ahead[:, j]
    else:
        turn = pi / design.period
        bends = turn / np.tan(turn * ahead)
        own = turn * ahead[:, j]
        fall = -pole * turn / np.tan(own) if len(design.zones) % 2 else -0.5 * turn / np.sin(own) ** 2
    return np.asarray(x_root * (0.5 * np.sum(bends, axis=1) * pole + fall))
