"""Incomplete beta functions, and Lerch's function close to its singularity.

Lerch's function sum_n x^n / (n + a) is x^(-a) times the integral of y^(a - 1) / (1 - y) from 0 to
x. This is an incomplete beta function whose second parameter is zero. It has a logarithm at x = 1.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import special

from sie.basis.data import Array
from sie.basis.jacobi import log_ratio
from sie.basis.weight import power

Number = NDArray[Any]


@dataclass(frozen=True)
class LerchOptions:
    """Numbers of terms and of quadrature nodes that leave only round-off in `lerch`."""

    # Number of terms of two power series of Lerch's function, in x and in 1 - x. A series is used
    # only if |x|, or |1 - x|, is at most 1/2, so that the omitted terms are below round-off.
    terms: int = 56
    # Number of Gauss-Legendre nodes in `_by_ray`, which integrates over log y on a path no longer
    # than log 2. The pole y = 1 of the integrand is at least 0.5 from this path, so that the error
    # is 3.6^(-2 nodes).
    nodes: int = 18


OPTIONS = LerchOptions()


def lerch(a: complex, x: Number, from_one: Number) -> Number:
    """The sum of x^n / (n + a), n = 0, 1, 2, ..., for Re a > 0 and |x| <= 1.

    Parameters
    ----------
    a : float or complex
        The parameter.
    x : ndarray
        Real or complex arguments.
    from_one : ndarray
        1 - x, which must keep all its digits if x is close to one.

    Returns
    -------
    ndarray
        Of the shape of `x`; infinite at x = 1.

    Examples
    --------
    >>> import numpy as np
    >>> from sie.basis.lerch import lerch
    >>> x = np.array([0.25, 0.81])   # for a = 1/2 it is log((1 + r) / (1 - r)) / r, r^2 = x
    >>> (lerch(0.5, x, 1 - x) * np.sqrt(x) - 2 * np.arctanh(np.sqrt(x))).round(14).tolist()
    [0.0, 0.0]
    """
    out = np.empty(x.shape, dtype=np.result_type(x, np.asarray(a)))
    small, near = np.abs(x) <= 0.5, np.abs(from_one) <= 0.5
    between = ~(small | near)
    out[small] = _polynomial(_powers(a), x[small])
    with np.errstate(divide="ignore", invalid="ignore"):
        rest = from_one[near]
        power = np.exp(-a * np.log1p(-rest))
        out[near] = power * (_constant(a) - np.log(rest) - rest * near_one(a, rest))
    if between.any():
        out[between] = _by_ray(a, x[between])
    return out


def beta_share(a: complex, b: complex, x: Any, rest: Any) -> Number:
    """The regularised incomplete beta function I_x(a, b), with rest = 1 - x, for a + b = 1.

    It is computed from x or 1 - x, whichever is smaller, because the smaller number cannot be found
    from the larger one without loss of digits.
    """
    x, rest = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(rest, dtype=float))
    small = x <= rest
    if not isinstance(a, complex):
        out = np.empty(x.shape)
        out[small] = special.betainc(a, b, x[small])
        out[~small] = special.betaincc(b, a, rest[~small])
        return out
    shares = np.empty(x.shape, dtype=complex)
    shares[small] = _complex_share(a, x[small], rest[small])
    shares[~small] = 1 - _complex_share(b, rest[~small], x[~small])
    return shares


def _complex_share(a: complex, x: Array, rest: Array) -> Number:
    """The regularised incomplete beta function I_x(a, 1 - a) for x <= 1/2; `rest` is 1 - x.

    It is sin(pi a) / pi times the integral of s^(a - 1) / (1 + s) from 0 to x / (1 - x).
    """
    ratio = x / rest
    return np.asarray(np.sin(np.pi * a) / np.pi * power(ratio, a) * lerch(a, -ratio, 1 / rest))


def near_one(a: complex, from_one: Number) -> Number:
    """The regular part of Lerch's function `lerch` near x = 1, as a series for |1 - x| <= 1/2.
    It is the sum of (1 - a)_k / (k! k) (1 - x)^(k - 1) over k = 1, 2, ..., with the rising
    factorial (1 - a)_k.

    x^a times `lerch` is a constant, minus log(1 - x), minus (1 - x) times this sum.
    """
    return _polynomial(_near_one_coefficients(a), from_one)


def _by_ray(a: complex, x: Number) -> Number:
    """Lerch's function, the sum of x^n / (n + a), for 1/2 < |x| <= 1.
    It is integrated along the ray from 0 through x, starting from its value at x / (2 |x|).
    """
    nodes, weights = _legendre(OPTIONS.nodes)
    length = np.log(2 * np.abs(x))
    start = _polynomial(_powers(a), 0.5 * x / np.abs(x)) * np.exp(-a * length)
    back = -length[:, None] * nodes
    return np.asarray(
        start + length * ((np.exp(a * back) / (1 - x[:, None] * np.exp(back))) @ weights)
    )


@lru_cache(maxsize=256, typed=True)
def _powers(a: complex) -> Number:
    """Coefficients 1 / (k + a) of the powers x^k, k = 0, 1, ..., in Lerch's function."""
    return np.asarray(1 / (np.arange(OPTIONS.terms) + a))


def _constant(a: complex) -> complex:
    """The limit of Lerch's sum of x^n / (n + a), plus log(1 - x), as x tends to 1."""
    return -complex_or_real(special.digamma(a)) - float(np.euler_gamma)


def complex_or_real(value: Any) -> Any:
    """A number of NumPy as Python's float or complex number."""
    return np.asarray(value).item()


@lru_cache(maxsize=256, typed=True)
def _near_one_coefficients(a: complex) -> Number:
    """Coefficients (1 - a)_k / (k! k) of (1 - x)^(k - 1), k = 1, 2, ..., in `near_one`.
    (1 - a)_k is the rising factorial.
    """
    k = np.arange(1.0, OPTIONS.terms)
    return np.asarray(np.cumprod((k - a) / k) / k)


@lru_cache(maxsize=4)
def _legendre(nodes: int) -> tuple[Array, Array]:
    t, weights = np.polynomial.legendre.leggauss(nodes)
    return np.asarray(0.5 * (1 + t)), np.asarray(0.5 * weights)


def _polynomial(c: Number, x: Number) -> Number:
    """The sum of c_n x^n, by Horner's rule."""
    out = np.full(x.shape, c[-1], dtype=np.result_type(c, x))
    for coefficient in c[-2::-1]:
        out = out * x + coefficient
    return out


def value_transform(alpha: complex, rest: complex, left: Number, less: Number) -> Number:
    """Transform at zeta of the density that is 1 at the left end of (-1, 1), 0 at the right end.
    It is -1/pi int_u^1 (1 - v^(alpha - 1)) / (1 - v) dv with u = (zeta - 1) / (zeta + 1).

    See `sie.basis.value_mode`. rest: 1 - alpha; left, less: zeta + 1 and zeta - 1, real or in the
    closed upper half plane.
    """
    out = np.empty(less.shape, dtype=np.result_type(less, np.asarray(alpha)))
    logarithm = log_ratio(less, left)
    from_one = 2 / left
    far, inside = np.abs(from_one) <= 0.5, np.abs(less) <= np.abs(left)
    out[far] = -from_one[far] * near_one(alpha, from_one[far])
    # digamma(a) is digamma(1 + a) - 1 / a. The term 1 / a, which is large for small a, is combined
    # with exp(a power) / a, so that no digits are lost.
    for here, a, sign in ((inside & ~far, alpha, 1.0), (~inside, rest, -1.0)):
        power, to_end = logarithm[here] * sign, left[here]
        ratio, beside = (less[here] / to_end, 2 / to_end)
        if sign < 0:
            ratio, beside = 1 / ratio, -2 / less[here]
        series = np.exp((1 + a) * power) * lerch(1 + a, ratio, beside)
        distance = np.log(to_end) if np.iscomplexobj(less) else np.log(np.abs(to_end))
        if sign < 0 and np.iscomplexobj(less):
            distance = distance - np.pi * 1j
        constant = complex_or_real(special.digamma(1 + a)) + float(np.euler_gamma) + np.log(2.0)
        out[here] = constant - distance + np.expm1(a * power) / a + series
    return np.asarray(-out / np.pi)
