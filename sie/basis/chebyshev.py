"""Chebyshev nodes, series and transforms on one zone, with the position t = cos(theta) in (-1, 1).

Densities are sums of c_j T_j(t) / sqrt(1 - t^2). Their Cauchy transforms on the zone are sums of
U_{j-1}(t) = sin(j theta) / sin(theta). The nodes are the zeros theta_k = k pi / (n + 1) of U_n. So
a sine transform of the values at the nodes gives the coefficients of the U_{j-1}. Together with the
two ends the nodes are the Lobatto nodes of the weight 1 / sqrt(1 - t^2).
"""

from functools import lru_cache

import numpy as np
from scipy import fft

from sie.basis.data import Array, widened
from sie.basis.sums import OPTIONS


@lru_cache(maxsize=64)
def angles(n: int) -> Array:
    """Angles k pi/(n + 1), k = 0 ... n + 1, of both ends and of the n zeros of Chebyshev's U_n.

    t = cos(theta) runs from +1 down to -1.
    """
    theta: Array = np.arange(n + 2.0) * (np.pi / (n + 1))
    theta.flags.writeable = False
    return theta


@lru_cache(maxsize=64)
def lobatto(n: int) -> tuple[Array, Array, Array]:
    """(t, 1 - t, 1 + t) at the ends and at the n zeros t of U_n, computed without cancellation."""
    theta = angles(n)
    right = 2 * np.sin(theta / 2) ** 2
    left = right[::-1].copy()
    t = 0.5 * (left - right)
    for x in (t, right, left):
        x.flags.writeable = False
    return t, right, left


@lru_cache(maxsize=64)
def _sine_matrix(n: int) -> Array:
    """Matrix from a function's values at the n zeros of U_n to its coefficients of U_{k-1}."""
    k = np.arange(1, n + 1)
    # Whole turns are removed from the angles k theta in integer arithmetic. Otherwise the round-off
    # of these angles would grow with k.
    sines = np.sin(_turn(2 * (n + 1)))[k[:, None] * k % (2 * (n + 1))]
    return np.ascontiguousarray((2 / (n + 1)) * sines * np.sin(angles(n)[1:-1]))


def _turn(parts: int) -> Array:
    """Angles 2 pi k / parts, k = 0 ... parts - 1, mapped to (-pi, pi]."""
    number = np.arange(parts)
    return np.asarray((2 * np.pi / parts) * np.where(2 * number > parts, number - parts, number))


def u_coefficients(values: Array) -> Array:
    """Coefficients g_k of sum g_k U_{k-1}, k = 1 ... n, from values at the n zeros of U_n.

    The transform acts along the last axis.
    """
    n = values.shape[-1]
    if n <= OPTIONS.max_direct_terms:
        return np.asarray(values @ _sine_matrix(n).T)
    return np.asarray(fft.dst(values * np.sin(angles(n)[1:-1]), type=1, axis=-1) / (n + 1))


def u_moved(g: Array, shift: Array, stretch: Array) -> Array:
    """Coefficients of U_{k-1} on zones after a move, from the coefficients g before the move.

    The function on a zone is sum g_k U_{k-1}(shift + stretch t), with the coordinate t on the moved
    zone; both tables of coefficients are (zones, n). Outside (-1, 1) the old series grows without
    bound. Places farther than 1 / n^2 outside therefore get the value at the distance 1 / n^2.
    """
    n = g.shape[1]
    if n == 0:
        return g
    beyond = 1 + 1 / n**2
    t = np.clip(shift[:, None] + stretch[:, None] * lobatto(n)[0][1:-1], -beyond, beyond)
    return u_coefficients(u_values(g, t))


def u_values(g: Array, t: Array) -> Array:
    """Values of the Chebyshev series sum g_k U_{k-1} at points t, by Clenshaw's recurrence.

    g: coefficients (zones, n); t: points (zones, points).
    """
    here, before = np.zeros_like(t), np.zeros_like(t)
    for c in g.T[::-1]:
        here, before = c[:, None] + 2 * t * here - before, here
    return here


def project_rows(values: Array) -> Array:
    """Coefficients g_k of U_{k-1}, for each column of a table of values at the zeros of U_n."""
    return u_coefficients(values.T).T


def slopes(values: Array) -> Array:
    """Derivative by t, at the n zeros of U_n, of the polynomial through values at these zeros."""
    n = values.shape[-1]
    theta, k_g = angles(n)[1:-1], np.zeros((*values.shape[:-1], n + 2))
    k_g[..., 1:-1] = np.arange(1, n + 1) * u_coefficients(values)
    # The derivative of U_{k-1} by t is (t U_{k-1} - k T_k) / (1 - t^2).
    cosines = 0.5 * fft.dct(k_g, type=1, axis=-1)[..., 1:-1]
    return np.asarray((values * np.cos(theta) - cosines) / np.sin(theta) ** 2)


@lru_cache(maxsize=64)
def gauss(n: int) -> Array:
    """Zeros of T_n, which are the nodes of Gauss's rule for the weight 1 / sqrt(1 - t^2).

    All weights of the rule are pi / n.
    """
    return np.asarray(np.cos((np.arange(n) + 0.5) * (np.pi / n)))


def gauss_sides(n: int) -> tuple[Array, Array]:
    """(1 + t, 1 - t) at the n zeros t of T_n (Gauss nodes), computed without cancellation."""
    half = (np.arange(n) + 0.5) * (0.5 * np.pi / n)
    return 2 * np.cos(half) ** 2, 2 * np.sin(half) ** 2


def t_matrix(n: int, count: int) -> Array:
    """Values of T_l (columns l = 0 ... count - 1) at the n zeros of T_n (rows)."""
    return (_t_matrix if n * count <= OPTIONS.cache_pairs else _t_matrix.__wrapped__)(n, count)


@lru_cache(maxsize=64)
def _t_matrix(n: int, count: int) -> Array:
    """The matrix of `t_matrix`, cached for the 64 sizes used last."""
    return np.asarray(
        np.cos(_turn(4 * n))[np.outer(2 * np.arange(n) + 1, np.arange(count)) % (4 * n)]
    )


@lru_cache(maxsize=8)
def to_series(n: int) -> Array:
    """Matrix M: values @ M are the coefficients of T_l, for values at the n zeros of T_n."""
    out = t_matrix(n, n) * (2 / n)
    out[:, 0] *= 0.5
    return out


def t_values(c: Array, n: int) -> Array:
    """Values of sum c_l T_l at the n zeros of T_n; c has the shape (..., count), count <= n."""
    if n * c.shape[-1] <= OPTIONS.cache_pairs:
        return np.asarray(c @ t_matrix(n, c.shape[-1]).T)
    halved = 0.5 * c
    halved[..., 0] = c[..., 0]
    return np.asarray(fft.dct(halved, type=3, n=n, axis=-1))


def t_means(values: Array, count: int | None = None) -> Array:
    """Means of a function times T_l, l = 0 ... count - 1, with weight 1 / sqrt(1 - t^2).

    `values` are the function at the n nodes of `gauss`, along the last axis; count None means n.
    """
    n = values.shape[-1]
    count = n if count is None else count
    if n <= OPTIONS.max_direct_terms:
        return np.asarray(values @ (t_matrix(n, count) / n))
    return np.asarray(fft.dct(values, type=2, axis=-1)[..., :count] / (2 * n))


def edge_part(c: Array) -> tuple[Array, Array]:
    """(alpha, beta) of the part (alpha + beta t) / sqrt(1 - t^2) of sum c_j T_j / sqrt(1 - t^2)."""
    return c[:, ::2].sum(axis=1), c[:, 1::2].sum(axis=1)


def slopes_at_ends(c: Array) -> tuple[Array, Array]:
    """Values at t = -1 and t = 1 of sum u_k U_k, with the u_k that `bounded_part` gives for `c`.

    c_j contributes -2 c_j to u_(j-2), u_(j-4), ..., and U_k(1) = k + 1.
    """
    j = np.arange(c.shape[1])
    weights = -2.0 * (j * j // 4)
    return c @ (weights * (1.0 - 2.0 * (j % 2))), c @ weights


def bounded_part(c: Array) -> tuple[Array, Array, Array]:
    """(alpha, beta, u) of sum c_j T_j / X = (alpha + beta t) / X + X sum u_k U_k, X^2 = 1 - t^2.

    They follow from the identity T_j - T_{j-2} = -2 (1 - t^2) U_{j-2}. c has the shape (zones, n +
    1). Close to an end where the density is bounded, this form keeps digits that the sum over T_j
    loses to cancellation.
    """
    c = widened(c, 2)
    sums = np.empty_like(c)
    sums[:, ::2] = np.cumsum(c[:, ::2][:, ::-1], axis=1)[:, ::-1]
    sums[:, 1::2] = np.cumsum(c[:, 1::2][:, ::-1], axis=1)[:, ::-1]
    # The columns are copied, because views of them would keep the whole table in memory.
    return sums[:, 0].copy(), sums[:, 1].copy(), -2 * sums[:, 2:]
