r"""`SmoothPart`: the kernel of a line load on an elastic body, without the half-plane's 1/r.

With L(q) the symbol of the body, the kernel is 1/r + m(r) and its primitive ln(r / d) + M(r), where

    m(r) = int_0^inf (L(q) - 1) sin(qr) dq,    M' = m.

m is odd and M is even in r. On a body with a base (L(0) = 0) the kernel's primitive vanishes far
away: it is -int_0^inf L(q) cos(qr) dq / q. On other bodies M(0) = 0, and the user chooses the datum
d. The primitive N of M gives the displacement of a uniform pressure.

For small r, the integral for m(r) is a sum of Gauss-Legendre panels in q that halve towards 0; r is
small if q r is at most a few hundred for all q at which L - 1 is not negligible. For large r, it is
computed by the double exponential formula of Ooura & Mori (1999), J. Comput. Appl. Math. 112,
229-241, doi 10.1016/S0377-0427(99)00223-X, whose nodes tend to the zeros of the sine.

The function m is stored on panels of r that double in width until r m(r) has reached its limit
L(0) - 1. A Chebyshev series of 24 terms in each panel is accurate to rounding: the singularities of
m are off the real axis or at r = 0.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contact.model.profiles.noise import EPS
from contact.model.symbols import WAVES, Symbol
from sie import Array, record


@dataclass(frozen=True)
class LineLoadOptions:
    """Options for the smooth part of a kernel: Chebyshev series on panels, exact to round-off.

    nodes: terms of the Chebyshev series in a panel of r, and nodes of Gauss's rule in a panel of q.
        n nodes resolve a function whose phase q r changes by up to n / 2 in the panel.
    max_summed_phase: largest q r up to which panels of q are summed.
    """

    nodes: int = 24
    max_summed_phase: float = 400.0


OPTIONS = LineLoadOptions()
# Number of halvings from the largest wavenumber in WAVES to the smallest. There are as many
# quadrature panels in the wavenumber q, and at most twice as many in the distance r.
_HALVINGS = int(np.log2(WAVES.max() / WAVES.min()))


@record
class SmoothPart:
    """The smooth part m of a line load's kernel, with its first and second primitives M and N,
    as functions of the distance r [m].

    first: end of the first panel [m]; the next ones double in width. m, M, N: Chebyshev
    coefficients (panels, terms), with lengths in units of `first`. limit: the constant value of
    r m(r) beyond the last panel. scale: for a body with a base, the length d [m] in the potential
    ln(r / d) + M(r); None without a base. length: rough distance [m] of the singularities of m from
    the real axis.
    """

    first: float
    m: Array
    M: Array
    N: Array
    limit: float
    scale: float | None
    length: float

    @classmethod
    def of(cls, symbol: Symbol, grounded: bool) -> SmoothPart:
        """The smooth part of a body's kernel for the symbol L(q), q in 1/m. grounded: whether the
        body has a base.
        """
        top = _shortest(symbol)
        if top is None:
            zero = np.zeros((1, OPTIONS.nodes))
            return cls(1.0, zero, zero, zero, 0.0, None, np.inf)
        first = 0.5 * OPTIONS.nodes / top
        integral = _integral(symbol, top)
        # Far away, at r well above 1 / `slow`, the product r m(r) of distance and smooth part is
        # constant. `slow` is the wavenumber [1/m] below which the symbol L(q) has its long-wave
        # limit.
        slow = _longest(symbol)
        panels: list[Array] = []
        lo, hi, limit = 0.0, first, 0.0
        while len(panels) < 2 * _HALVINGS:
            r = 0.5 * (lo + hi) + 0.5 * (hi - lo) * _POINTS
            values = integral(r)
            panels.append(_TO_SERIES @ (values * first))
            limit = float((r * values)[0])
            spread = float(np.ptp(r * values))
            lo, hi = hi, 2 * hi
            if lo > 10 / slow and spread <= 16 * EPS * max(1.0, abs(limit)):
                break
        if grounded:
            limit = -1.0
        m = np.array(panels)
        # Half widths of the panels, in units of the first panel's length `first`.
        half = 0.5 * np.concatenate(([1.0], 2.0 ** np.arange(len(m) - 1)))
        start = -(np.log(2.0 * half[-1] * 2 if len(m) > 1 else 1.0) if grounded else 0.0)
        M = _integrated(m, half)
        M[:, 0] += start - _at_end(M) if grounded else 0.0
        N = _integrated(M, half)
        # The last argument is `length`: the symbol minus 1, L(q) - 1, decreases about as
        # exp(-q length) with the wavenumber q.
        return cls(first, m, M, N, limit, first if grounded else None, -np.log(EPS) / top)

    @property
    def is_zero(self) -> bool:
        return not self.m.any()

    def value(self, r: Array) -> Array:
        """m(r), the smooth part of the kernel [1/m], at distances r [m]."""
        t = np.abs(r) / self.first
        inner = _summed(self.m, t)
        with np.errstate(divide="ignore"):
            out = np.where(t > self._end, self.limit / t, inner)
        return np.asarray(np.sign(r) * out / self.first)

    def potential(self, r: Array) -> Array:
        """M(r), the primitive of the kernel's smooth part m. On a body with a base, the line load's
        potential is ln(r / scale) + M(r), with `scale` an attribute of this class.
        """
        t = np.abs(r) / self.first
        out = _summed(self.M, t)
        far = t > self._end
        return np.where(
            far, _at_end(self.M) + self.limit * np.log(np.where(far, t, self._end) / self._end), out
        )

    def primitive(self, r: Array) -> Array:
        """N(r) = int_0^r M [m], the second primitive of the kernel's smooth part m."""
        t = np.abs(r) / self.first
        end, x = self._end, np.maximum(t / self._end, 1.0)
        beyond = end * ((x - 1) * _at_end(self.M) + self.limit * (x * np.log(x) - x + 1))
        return np.asarray(np.sign(r) * self.first * (_summed(self.N, np.minimum(t, end)) + beyond))

    @property
    def _end(self) -> float:
        """End of the last panel, in units of the first panel's length `first`."""
        return float(2.0 ** (len(self.m) - 1))


def _shortest(symbol: Symbol) -> float | None:
    """The wavenumber [1/m] above which the symbol L is 1; None if L = 1 everywhere."""
    deviation = np.abs(np.asarray(symbol(WAVES)) - 1)
    # At the largest wavenumbers the symbol L is 1: deviations from 1 there are round-off errors of
    # L.
    level = max(EPS, 4 * float(deviation[-8:].max()))
    seen = np.flatnonzero(deviation > level)
    if len(seen) == 0:
        return None
    lo, hi = WAVES[seen[-1]], WAVES[min(seen[-1] + 1, len(WAVES) - 1)]
    finer = np.geomspace(lo, hi, 33)
    return float(finer[np.flatnonzero(np.abs(np.asarray(symbol(finer)) - 1) > level)[-1]])


def _longest(symbol: Symbol) -> float:
    """The wavenumber [1/m] below which the symbol L is nearly constant."""
    values = np.asarray(symbol(WAVES))
    changes = np.flatnonzero(np.abs(values - values[0]) > 1e-3 * np.abs(values - 1).max())
    return float(WAVES[max(changes[0] - 1, 0)])


def _integral(symbol: Symbol, top: float) -> Callable[[Array], Array]:
    """A function that computes the smooth part m(r) of the kernel at distances r [m], by
    quadrature.
    """
    # `base` is subtracted from the symbol L. It is the long-wave limit of L, or 1 if L grows
    # without bound for long waves.
    first, next_ = np.asarray(symbol(WAVES[:2]))
    base = float(first) if abs(next_ - first) <= 1e-3 * abs(first) or first < 1 else 1.0
    edges = np.concatenate(([0.0], top * 2.0 ** np.arange(-_HALVINGS, 1.0)))
    counts = np.maximum(
        np.ceil(np.diff(edges) / top * OPTIONS.max_summed_phase / (0.5 * OPTIONS.nodes)), 1
    ).astype(int)
    cuts = np.concatenate(
        [
            np.linspace(a, b, n + 1)[:-1]
            for a, b, n in zip(edges[:-1], edges[1:], counts, strict=True)
        ]
        + [[top]]
    )
    nodes, weights = np.polynomial.legendre.leggauss(OPTIONS.nodes)
    half, middle = 0.5 * np.diff(cuts), 0.5 * (cuts[1:] + cuts[:-1])
    q = (middle[:, None] + half[:, None] * nodes).ravel()
    weighted = (half[:, None] * weights).ravel() * (np.asarray(symbol(q)) - 1)

    def integral(r: Array) -> Array:
        near = r * top <= OPTIONS.max_summed_phase
        out = np.empty(len(r))
        if near.any():
            out[near] = np.sin(r[near, None] * q) @ weighted
        if not near.all():
            far = r[~near, None]
            # r m(r) is the integral of (L(x / r) - 1) sin x over all x > 0, where x = q r. The part
            # base - 1 of the first factor is integrated exactly: the integral of sin x is 1 (Abel
            # sum). The rest, L - base, tends to 0 for large r.
            out[~near] = (
                base - 1 + (np.asarray(symbol(_OOURA / far)) - base) @ _OOURA_WEIGHTS
            ) / far[:, 0]
        return out

    return integral


def _ooura_mori(density: float = 40.0, reach: float = 7.0) -> tuple[Array, Array]:
    """Nodes x and weights w for int_0^inf f(x) sin x dx = sum w f(x), by Ooura and Mori (1999).

    The formula is a trapezoidal sum in a variable t with the step pi / density, for |t| <= reach.
    """
    h = np.pi / density
    t = h * np.arange(-int(reach / h), int(reach / h) + 1)
    beta = 0.25
    alpha = beta / np.sqrt(1 + density * np.log1p(density) / (4 * np.pi))
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        exponent = -2 * t - alpha * -np.expm1(-t) - beta * np.expm1(t)
        rate = -2 - alpha * np.exp(-t) - beta * np.exp(t)
        grown = np.exp(exponent)
        below = -np.expm1(exponent)
        phi = t / below
        slope = 1 / below + t * grown * rate / below**2
    # At t = 0 the function `phi` and its slope are 0/0: their limits are set here.
    zero = np.abs(t) < 1e-12
    first, second = 2 + alpha + beta, (alpha - beta)
    phi[zero], slope[zero] = 1 / first, 0.5 * (1 + second / first**2)
    # If the exponential overflows, phi and its slope are set to their limit 0.
    tiny = ~np.isfinite(phi) | ~np.isfinite(slope)
    phi[tiny], slope[tiny] = 0.0, 0.0
    x = density * phi
    # For t > 0 the nodes tend to multiples of pi. The sine of a node is computed from the node's
    # small distance to a multiple of pi.
    n = np.rint(t / h)
    left = density * np.where(t > 0, t * grown / np.where(t > 0, below, 1.0), 0.0)
    sine = np.where(t > 0, np.cos(np.pi * n) * np.sin(left), np.sin(x))
    weights = np.pi * sine * slope
    used = np.abs(weights) > 1e-300
    return x[used], weights[used]


_OOURA, _OOURA_WEIGHTS = _ooura_mori()


def _chebyshev_transform(terms: int) -> tuple[Array, Array]:
    """Chebyshev nodes on (-1, 1), and the matrix that maps function values at these nodes to
    Chebyshev coefficients.
    """
    angles = (np.arange(terms) + 0.5) * np.pi / terms
    matrix = 2 / terms * np.cos(np.arange(terms)[:, None] * angles)
    matrix[0] *= 0.5
    return np.cos(angles), matrix


_POINTS, _TO_SERIES = _chebyshev_transform(OPTIONS.nodes)


def _integrated(series: Array, half: Array) -> Array:
    """The primitive of a function, as one Chebyshev series on each panel; it is 0 at 0.

    series: the Chebyshev series of the function itself; half: half widths of the panels. The first
    panel begins at 0.
    """
    out, before = np.empty((len(series), series.shape[1] + 1)), 0.0
    for k, (row, width) in enumerate(zip(series, half, strict=True)):
        out[k] = width * np.polynomial.chebyshev.chebint(row, lbnd=-1)
        out[k, 0] += before
        before = float(out[k].sum())
    return out


def _at_end(series: Array) -> float:
    return float(series[-1].sum())


def _summed(series: Array, t: Array) -> Array:
    """Values at t >= 0 of a function that is given by one Chebyshev series on each panel.

    t is in units of the first panel's width. Beyond the last panel, the value is that at its end.
    """
    panels = len(series)
    end = 2.0 ** (panels - 1)
    out = np.full(np.shape(t), _at_end(series))
    inside = t <= end
    t = t[inside]
    panel = np.where(t <= 1, 0, np.frexp(np.maximum(t, 1.0) * (1 - 1e-16))[1]).astype(np.intp)
    panel = np.clip(panel, 0, panels - 1)
    width = np.where(panel == 0, 1.0, np.ldexp(1.0, panel - 1))
    x = 2 * (t - np.where(panel == 0, 0.0, width)) / width - 1
    b1, b2 = np.zeros(np.shape(t)), np.zeros(np.shape(t))
    for row in series.T[:0:-1]:
        b1, b2 = row[panel] + 2 * x * b1 - b2, b1
    out[inside] = series[:, 0][panel] + x * b1 - b2
    return out
