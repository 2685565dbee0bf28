r"""The smooth part of an elastic body's line load, from its symbol: two Fourier integrals, as
tables of Chebyshev series.

With L(q) the symbol, the kernel of a line load is 1/r + m(r) and its primitive ln(r / d) + M(r),

    m(r) = int_0^inf (L(q) - 1) sin(qr) dq,    M' = m,

m odd and M even in r. Of a body with a base (L(0) = 0) the primitive is that which vanishes far
away, -int_0^inf L(q) cos(qr) dq / q; of others M(0) = 0, and the datum d is the user's. N, the
primitive of M, is what a uniform pressure needs.

Near r = 0, up to a few hundred waves over the range of L - 1, the integral is summed by
Gauss-Legendre panels that halve towards q = 0; beyond, by the double exponential formula of Ooura &
Mori (1999), J. Comput. Appl. Math. 112, 229-241, doi 10.1016/S0377-0427(99)00223-X, whose nodes run
into the zeros of the sine. Panels of r double in width up to where r m(r) is its own limit L(0) -
1, and in each a series of 24 terms is good to rounding: singularities of m lie off the real axis,
or at r = 0 as seen from far away.

The symbol L(q) of an elastic body over the harmonics of a period, and the kernel that has it.

A pressure p_q exp(iqx) displaces the surface by u_q = 2 L(q) p_q / (E* q): L is the surface
compliance over that of the half-plane and tends to 1 for waves that are short. With L_n = L(2 pi n
/ l), the kernel of a period l is Hilbert's plus the smooth

    K = (2 pi / l) sum_n (L_n - 1) sin(2 pi n d / l),    Lambda = -sum_n (L_n - 1) cos(2 pi n d / l) / n,    d = x - xi,

since (1/pi) int cos(k xi) ln|2 sin(pi d / l)| dxi = -cos(kx) / k.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

import sie
from contact.errors import SceneError
from contact.model.checks import as_array, of_author
from contact.model.profiles.trigonometric import Sum
from sie import Array, record

Symbol = Callable[[Array], Array]

# Waves [1/m] at which a symbol is looked at, and what is taken for L = 1.
WAVES = 10.0 ** np.arange(-9, 12.01, 0.125)
ONE = 1e-17
# Terms of a series, its nodes, the end of its first panel over the shortest wave length, and panels
# at the most.
_TERMS = 24
_FIRST = 12.0
_MOST = 120
# Phases up to which panels of q are summed, the longest of one of them, and its nodes.
_SUMMED = 400.0
_TURN = 20.0
_NODES = 32
_HALVINGS = 60
# Half the nodes to a unit of Ooura and Mori's variable, and how far it is summed.
_M = 40.0
_REACH = 7.0
# r m(r) is its limit.
_SETTLED = 3e-15


@record
class SmoothPart:
    """m, M and N of the distance r [m].

    length: about how near to the real axis the singularities of m are [m]. first: the end of the
    first panel [m], from which on they double; m, M, N: Chebyshev coefficients (panels, terms) of
    the panels, of lengths in units of `first`; beyond the last panel r m = limit. scale: the length
    in the logarithm of a body with a base [m]; None without.
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
        """Of a symbol of q [1/m]; grounded: the body has a base."""
        top = _shortest(symbol)
        if top is None:
            zero = np.zeros((1, _TERMS))
            return cls(1.0, zero, zero, zero, 0.0, None, np.inf)
        first = _FIRST / top
        integral = _integral(symbol, top)
        # Where L goes over to its limit for long waves: beyond the inverse of that r m(r) may
        # settle.
        slow = _longest(symbol)
        panels: list[Array] = []
        lo, hi, limit = 0.0, first, 0.0
        while len(panels) < _MOST:
            r = 0.5 * (lo + hi) + 0.5 * (hi - lo) * _POINTS
            values = integral(r)
            panels.append(_TO_SERIES @ (values * first))
            limit = float((r * values)[0])
            spread = float(np.ptp(r * values))
            lo, hi = hi, 2 * hi
            if lo > 10 / slow and spread <= _SETTLED * max(1.0, abs(limit)):
                break
        if grounded:
            limit = -1.0
        m = np.array(panels)
        # Half widths of the panels in units of `first`.
        half = 0.5 * np.concatenate(([1.0], 2.0 ** np.arange(len(m) - 1)))
        start = -(np.log(2.0 * half[-1] * 2 if len(m) > 1 else 1.0) if grounded else 0.0)
        M = _integrated(m, half)
        M[:, 0] += start - _at_end(M) if grounded else 0.0
        N = _integrated(M, half)
        # L - 1 falls by so much as exp(-q length) does.
        return cls(first, m, M, N, limit, first if grounded else None, -np.log(ONE) / top)

    @property
    def is_zero(self) -> bool:
        return not self.m.any()

    def value(self, r: Array) -> Array:
        """m(r) [1/m]."""
        t = np.abs(r) / self.first
        inner = _summed(self.m, t)
        with np.errstate(divide="ignore"):
            out = np.where(t > self._end, self.limit / t, inner)
        return np.asarray(np.sign(r) * out / self.first)

    def potential(self, r: Array) -> Array:
        """M(r); of a body with a base that of ln(r / scale) + M."""
        t = np.abs(r) / self.first
        out = _summed(self.M, t)
        far = t > self._end
        return np.where(
            far, _at_end(self.M) + self.limit * np.log(np.where(far, t, self._end) / self._end), out
        )

    def primitive(self, r: Array) -> Array:
        """N(r) = int_0^r M [m]."""
        t = np.abs(r) / self.first
        end, x = self._end, np.maximum(t / self._end, 1.0)
        beyond = end * ((x - 1) * _at_end(self.M) + self.limit * (x * np.log(x) - x + 1))
        return np.asarray(np.sign(r) * self.first * (_summed(self.N, np.minimum(t, end)) + beyond))

    @property
    def _end(self) -> float:
        """End of the last panel in units of `first`."""
        return float(2.0 ** (len(self.m) - 1))


def _shortest(symbol: Symbol) -> float | None:
    """The wave [1/m] from which on L = 1; None if L = 1 everywhere."""
    off = np.abs(np.asarray(symbol(WAVES)) - 1)
    # Of the shortest waves rounding alone is left.
    level = max(ONE, 4 * float(off[-8:].max()))
    seen = np.flatnonzero(off > level)
    if len(seen) == 0:
        return None
    lo, hi = WAVES[seen[-1]], WAVES[min(seen[-1] + 1, len(WAVES) - 1)]
    finer = np.geomspace(lo, hi, 33)
    return float(finer[np.flatnonzero(np.abs(np.asarray(symbol(finer)) - 1) > level)[-1]])


def _longest(symbol: Symbol) -> float:
    """The wave [1/m] below which L hardly changes any more."""
    values = np.asarray(symbol(WAVES))
    changes = np.flatnonzero(np.abs(values - values[0]) > 1e-3 * np.abs(values - 1).max())
    return float(WAVES[max(changes[0] - 1, 0)])


def _integral(symbol: Symbol, top: float) -> Callable[[Array], Array]:
    """m(r) of the distances r [m]."""
    # A compliance that grows without bound has no limit to take off.
    first, next_ = np.asarray(symbol(WAVES[:2]))
    base = float(first) if abs(next_ - first) <= 1e-3 * abs(first) or first < 1 else 1.0
    edges = np.concatenate(([0.0], top * 2.0 ** np.arange(-_HALVINGS, 1.0)))
    counts = np.maximum(np.ceil(np.diff(edges) * _SUMMED / (top * _TURN)), 1).astype(int)
    cuts = np.concatenate(
        [
            np.linspace(a, b, n + 1)[:-1]
            for a, b, n in zip(edges[:-1], edges[1:], counts, strict=True)
        ]
        + [[top]]
    )
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    half, middle = 0.5 * np.diff(cuts), 0.5 * (cuts[1:] + cuts[:-1])
    q = (middle[:, None] + half[:, None] * nodes).ravel()
    weighted = (half[:, None] * weights).ravel() * (np.asarray(symbol(q)) - 1)

    def integral(r: Array) -> Array:
        near = r * top <= _SUMMED
        out = np.empty(len(r))
        if near.any():
            out[near] = np.sin(r[near, None] * q) @ weighted
        if not near.all():
            far = r[~near, None]
            # The integral of the sine alone is 1: what is summed is L less its limit, which
            # vanishes far away.
            out[~near] = (
                base - 1 + (np.asarray(symbol(_OOURA / far)) - base) @ _OOURA_WEIGHTS
            ) / far[:, 0]
        return out

    return integral


def _ooura_mori() -> tuple[Array, Array]:
    """Nodes x and weights w of int_0^inf f(x) sin x dx = sum w f(x)."""
    h = np.pi / _M
    t = h * np.arange(-int(_REACH / h), int(_REACH / h) + 1)
    beta = 0.25
    alpha = beta / np.sqrt(1 + _M * np.log1p(_M) / (4 * np.pi))
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        exponent = -2 * t - alpha * -np.expm1(-t) - beta * np.expm1(t)
        rate = -2 - alpha * np.exp(-t) - beta * np.exp(t)
        grown = np.exp(exponent)
        below = -np.expm1(exponent)
        phi = t / below
        slope = 1 / below + t * grown * rate / below**2
    # At t = 0 both are limits.
    zero = np.abs(t) < 1e-12
    first, second = 2 + alpha + beta, (alpha - beta)
    phi[zero], slope[zero] = 1 / first, 0.5 * (1 + second / first**2)
    # phi is small of a large grown: without overflow.
    tiny = ~np.isfinite(phi) | ~np.isfinite(slope)
    phi[tiny], slope[tiny] = 0.0, 0.0
    x = _M * phi
    # Beyond t = 0 nodes run into multiples of pi: the sine of what is left of them.
    n = np.rint(t / h)
    left = _M * np.where(t > 0, t * grown / np.where(t > 0, below, 1.0), 0.0)
    sine = np.where(t > 0, np.cos(np.pi * n) * np.sin(left), np.sin(x))
    weights = np.pi * sine * slope
    used = np.abs(weights) > 1e-300
    return x[used], weights[used]


_OOURA, _OOURA_WEIGHTS = _ooura_mori()
_ANGLES = (np.arange(_TERMS) + 0.5) * np.pi / _TERMS
_POINTS = np.cos(_ANGLES)
_TO_SERIES = 2 / _TERMS * np.cos(np.arange(_TERMS)[:, None] * _ANGLES)
_TO_SERIES[0] *= 0.5


def _integrated(series: Array, half: Array) -> Array:
    """Series of the integral from 0 of what is piecewise these series."""
    out, before = np.empty((len(series), series.shape[1] + 1)), 0.0
    for k, (row, width) in enumerate(zip(series, half, strict=True)):
        out[k] = width * np.polynomial.chebyshev.chebint(row, lbnd=-1)
        out[k, 0] += before
        before = float(out[k].sum())
    return out


def _at_end(series: Array) -> float:
    return float(series[-1].sum())


def _summed(series: Array, t: Array) -> Array:
    """The series at t >= 0 in units of the first panel; at the end beyond the last one."""
    panels = len(series)
    t = np.minimum(t, 2.0 ** (panels - 1))
    panel = np.where(t <= 1, 0, np.frexp(np.maximum(t, 1.0) * (1 - 1e-16))[1]).astype(np.intp)
    panel = np.clip(panel, 0, panels - 1)
    width = np.where(panel == 0, 1.0, np.ldexp(1.0, panel - 1))
    x = 2 * (t - np.where(panel == 0, 0.0, width)) / width - 1
    b1, b2 = np.zeros(np.shape(t)), np.zeros(np.shape(t))
    for row in series.T[:0:-1]:
        b1, b2 = row[panel] + 2 * x * b1 - b2, b1
    return np.asarray(series[:, 0][panel] + x * b1 - b2)


# Harmonics looked at, first and at the most, and what is taken for L = 1.
_FEWEST = 2**12
_MOST_HARMONICS = 2**16
_ONE = 1e-15
# Waves from which on they tell how they fall.
_FALLING = 16


def checked(symbol: Callable[[Array], Array], q: Array, of: str) -> Array:
    """L(q); SceneError where it is none of a body. of: what the symbol belongs to."""
    name = f"{of}.symbol(q)"
    with of_author(name, of, f" for an array of shape {q.shape}"):
        value = symbol(q.copy())
    found = as_array(value)
    if found.dtype.kind not in "iuf" or found.shape != q.shape or not np.all(np.isfinite(found)):
        at = ""
        if found.dtype.kind in "iuf" and found.shape == q.shape:
            at = (
                f" (not at q = {q[~np.isfinite(found)].ravel()[0]:.6g} 1/m: exponentials that grow "
                "overflow, those that fall do not)"
            )
        raise SceneError.of(name, value, f"real, finite, and of the shape of q{at}")
    if not np.all(found > 0):
        lowest = q.ravel()[np.argmin(found)]
        raise SceneError.of(
            name,
            float(found.min()),
            f"above 0: at q = {lowest:.6g} 1/m pressure would lift the surface",
        )
    return np.asarray(found, dtype=np.float64)


def excess(symbol: Callable[[Array], Array], period: float, of: str) -> Array:
    """L_n - 1, n = 1, 2, ..., up to the last that is not zero. SceneError where the symbol is none
    of a body.
    """
    count = _FEWEST
    while True:
        q = np.asarray(2 * np.pi / period * np.arange(1, count + 1), dtype=np.float64)
        found = checked(symbol, q, of)
        off = np.asarray(found - 1.0, dtype=np.float64)
        seen = np.flatnonzero(np.abs(off) > _ONE)
        if len(seen) == 0 or seen[-1] < 0.9 * count:
            return off[: seen[-1] + 1] if len(seen) else np.zeros(0)
        if count >= _MOST_HARMONICS:
            allowed = (
                f"1 for short waves: to {_ONE:.0e} from harmonic {_MOST_HARMONICS} of the period on"
            )
            raise SceneError.of(f"{of}.symbol(q)", float(found[-1]), allowed)
        count *= 4


def _waves(sums: Sum, period: float, x: Array, xi: Array) -> Array:
    """A trigonometric sum of x - xi."""
    turns = np.asarray((x - xi) / period)
    return sums(turns.ravel()).reshape(turns.shape)


def kernel_of(excess: Array, period: float) -> sie.Kernel:
    """The kernel of a scaled period."""
    plain = sie.hilbert(period)
    if len(excess) == 0:
        return plain
    n = np.arange(1, len(excess) + 1)
    value, potential = (
        Sum.of(np.asarray(c, dtype=np.complex128))
        for c in (-2j * np.pi / period * excess, -excess / n)
    )
    # The harmonics fall by so much as exp(-2 pi n length / l) does; but for a few of them there is
    # no telling.
    length = (
        -np.log(_ONE) * period / (2 * np.pi * len(excess)) if len(excess) >= _FALLING else np.inf
    )
    return plain + sie.Smooth(
        partial(_waves, value, period),
        partial(_waves, potential, period),
        of_lag=True,
        length=float(length),
    )
