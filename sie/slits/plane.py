r"""A density of intervals with slits at complex points: see `plane` for the half plane, `slits` and `kinks` for the series.

Off its wide zone the closed forms hold as they are on the line, sigma = s X and psi being real functions on the slits,

    F[P[s]] = (1/pi) int sigma / (zeta - tau) dtau / sqrt(zeta^2 - 1),

and of a jump in a slit, G_s = -i log(B/A) its angle (see `plane`), bars means over the slit's equilibrium measure,

    q = 0:  (h/pi)(bar(G) - G_s) + (a_0 + a_1 rho) / sqrt,
    q = 1:  (h/pi)(bar((zeta - .) G - sin) + (m - s) bar(G) - (phi - bar(phi)) rho - (zeta - s) G_s + sin(phi)) + (a_0 + a_1 rho) / sqrt,
    q = 2:  as `kinks` has it, with (zeta - s)^2 G - (zeta - 3 s/2) sin for (t - s)^2 kappa, and rho, rho^2/2 for X, t X,

with -i (2 log(B) - log(2 rho (zeta - s'))) for G: the mean of log(B) is smooth, that of log(zeta - s') is log(r / 2 rho_slit), and that
of (zeta - s') log(zeta - s') is r (zeta_slit (log(r/2) + 1 + arcosh(zeta_slit)) - sqrt(zeta_slit^2 - 1)).

The potential is carried down from where the coefficients of the wide zones tell all of it, along the vertical: W(z) = W(z + i Y) - i int F.
"""

import numpy as np

from sie.basis import chebyshev
from sie.basis.data import Array, legendre, record
from sie.basis.interval import Complex, InPlane, What, complex_of, transform_of, transform_slope_of
from sie.density.density import Density
from sie.slits.kinks import SlitKink
from sie.slits.merged import Merged
from sie.slits.slits import Slits

# Where |rho| is below this, as many coefficients as wide zones are told of their slits tell all of them.
_TELLS = 0.44
# The height, over the largest half width, from which the potential is carried down; panels halve in height towards the line, as often
# as this, each with so many nodes.
_HEIGHT, _PANELS, _NODES = 1.0, 50, 12
_POINTS = 256


@record
class SlitPlane:
    """What intervals with slits do at complex points. whole: the density of the wide zones as others see it, told: the slits' part of
    that, by wide zone that has any; series: of sigma, slit by slit; kinks: jumps in slits."""

    merged: Merged
    whole: Density
    told: Density
    slits: tuple[Slits, ...]
    series: list[list[Array]]
    kinks: list[list[tuple[int, SlitKink]]]

    def __call__(self, z: Complex, what: What) -> Complex:
        """Transform, its derivative or potential at points z (n,)."""
        x, y = z.real, np.abs(z.imag)
        out = self._potential(x, y) if what == "potential" else self._transform(x, y, what)
        return np.where(z.imag < 0, np.conj(out), out)

    def _transform(self, x: Array, y: Array, what: What) -> Complex:
        whole, wide = self.whole, self.merged.wide
        x = whole.into_period(x)
        out = whole.plane(complex_of(x, y), what)
        told = self.told
        for number, (here, row, kinks) in enumerate(zip(self.slits, self.series, self.kinks, strict=True)):
            w = float(wide.half[here.zone])
            for shift in whole.kernel.poles:
                at = x - shift
                seen = InPlane.of((at - wide.a[here.zone]) / w, (at - wide.b[here.zone]) / w, y / w)
                some = np.flatnonzero(np.abs(seen.rho) > _TELLS)
                if len(some) == 0:
                    continue
                close = seen[some]
                out[some] -= told.plane.of_zones(at[some], y[some], np.full(len(some), number), what)
                value, slope = _of_series(here, row, at[some], y[some])
                value = (value if what == "transform" else slope - value * close.zeta / close.root**2) / close.root
                for k, kink in kinks:
                    slit = here.slits[k]
                    inner = InPlane.of((at[some] - here.a[k]) / slit.width, (at[some] - here.b[k]) / slit.width, y[some] / slit.width)
                    value = value + _of_kink(kink, close, inner, what)
                out[some] += value / w if what == "derivative" else value
        return out

    def _potential(self, x: Array, y: Array) -> Complex:
        """From a height above the wide zones' own, or from y itself where that is higher."""
        top = np.maximum(y, _HEIGHT * float(self.merged.wide.half.max()))
        out = self.whole.plane(complex_of(x, top), "potential")
        parts, weights = legendre(np.append(0.0, 0.5 ** np.arange(_PANELS, -1, -1)), _NODES)
        down = np.flatnonzero(top > y)
        for start in range(0, len(down), _POINTS):
            here = down[start : start + _POINTS]
            # In logarithmic steps towards the line: what is above y alone.
            height = y[here, None] + (top - y)[here, None] * parts
            place = np.broadcast_to(x[here, None], height.shape)
            field = self._transform(place.ravel(), height.ravel(), "transform").reshape(height.shape)
            out[here] -= 1j * (top - y)[here] * (field @ weights)
        return out


def _of_series(here: Slits, row: list[Array], x: Array, y: Array) -> tuple[Complex, Complex]:
    """(1/pi) int sigma / (zeta - tau) dtau over the slits of one wide zone, and its derivative by zeta."""
    value, slope = np.zeros((2, len(x)), dtype=complex)
    first = np.zeros(len(x), dtype=np.intp)
    for slit, a, b, d in zip(here.slits, here.a, here.b, row, strict=True):
        seen = InPlane.of((x - a) / slit.width, (x - b) / slit.width, y / slit.width)
        parts = chebyshev.bounded_part(d[None])
        value += transform_of(*parts, seen, first)
        slope += transform_slope_of(*parts, seen, first) / slit.half
    return value, slope


def _of_kink(kink: SlitKink, seen: InPlane, inner: InPlane, what: What) -> Complex:
    """What P[psi] of a jump in a slit does off the wide zone; its derivative by zeta. inner: seen from the slit."""
    _, l, r = kink.mean_places
    zeta, rho, root = seen.zeta, seen.rho, seen.root
    log_b = seen.turned(np.sqrt(0.5 * l), np.sqrt(0.5 * r))
    half, a_0, a_1 = kink.half, *kink.edge
    sine = np.sqrt(kink.from_left * kink.from_right)
    away = seen.left - kink.from_left
    c, s = np.sqrt(0.5 * kink.from_left), np.sqrt(0.5 * kink.from_right)
    scale, (turn, bend) = kink.jump / np.pi, kink.polynomial
    log_rho = np.log(2.0) - seen.log
    mean_log = np.log(0.5 * half) + inner.log
    bar = -1j * (2 * log_b.mean(axis=-1) - log_rho - mean_log)
    own = -1j * np.log((c - 1j * s) ** 2 * (c * seen.m + 1j * s * seen.p) ** 2 / away)
    moves = seen.left[:, None] - l  # zeta - s' at the nodes
    # For q = 2 the sines of all nodes, and the polynomial of which X times it is the transform's.
    sines, nodes, middle = np.sqrt(l * r), 0.5 * (l - r), 0.5 * (kink.start - kink.rest)
    s_own, shift = 0.5 * (kink.from_left - kink.from_right), half * kink.zeta
    constant, second = turn - bend * middle, half**2 * (kink.zeta**2 - 0.5)
    first = half * (inner.zeta * (mean_log + 1) - inner.root)
    if what == "transform":
        edge = (a_0 + a_1 * rho) / root
        if kink.order == 0:
            return np.asarray(scale * (bar - own) + edge)
        moment = -1j * (2 * (moves * log_b).mean(axis=-1) - half * inner.zeta * log_rho - first)
        if kink.order == 1:
            return np.asarray(scale * (moment - sines.mean() - shift * bar - away * own + sine) - turn * rho + edge)
        fall = np.exp(-inner.log)
        square = half**2 * ((inner.zeta**2 + 0.5) * (mean_log + log_rho) + (2 * inner.zeta - 0.25 * fall) * fall)
        spread = -1j * (2 * (moves**2 * log_b).mean(axis=-1) - square) - zeta * sines.mean() + 1.5 * (nodes * sines).mean()
        spread = spread - 2 * shift * (moment - sines.mean()) + second * bar
        rest = spread - away**2 * own + (zeta - 1.5 * s_own) * sine
        return np.asarray(scale * rest - (constant + 0.5 * bend * rho) * rho + edge)
    edge = -(a_1 * rho / root + (a_0 + a_1 * rho) * zeta / root**2) / root
    b_slope = 0.5 * ((zeta[:, None] + nodes) / (root[:, None] + 1j * sines) - 1) / root[:, None]
    bar_slope = -1j * (2 * b_slope.mean(axis=-1) + 1 / root - 1 / (half * inner.root))
    own_slope = -sine / (away * root)
    if kink.order == 0:
        return np.asarray(scale * (bar_slope - own_slope) + edge)
    moment = -1j * (2 * (log_b + moves * b_slope).mean(axis=-1) - log_rho + half * inner.zeta / root - (mean_log + 1))
    if kink.order == 1:
        return np.asarray(scale * (moment - shift * bar_slope - own - away * own_slope) + turn * rho / root + edge)
    spread = 2 * (moves * (2 * log_b + moves * b_slope)).mean(axis=-1) - 2 * half * inner.zeta * log_rho
    spread = -1j * (spread + half**2 * (inner.zeta**2 + 0.5) / root - 2 * first - half * inner.zeta) - sines.mean()
    spread = spread - 2 * shift * moment + second * bar_slope
    rest = spread - away * (2 * own + away * own_slope) + sine
    return np.asarray(scale * rest + (constant + bend * rho) * rho / root + edge)
