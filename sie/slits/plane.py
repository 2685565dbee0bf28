r"""Fields, at complex points, of the density on zones with slits.

`sie.density.plane` describes densities without slits, `sie.slits.slits` and `sie.slits.kinks` the
series on slits. The notation is theirs. The closed forms on the line off a wide zone also hold at
complex points, because sigma = s X and psi are real functions on the slits. The density P[s] that
the slack s causes has the transform

    F[P[s]] = (1/pi) int sigma / (zeta - tau) dtau / sqrt(zeta^2 - 1).

Let G_s = -i log(B/A) be the logarithmic factor of a jump in a slit (`ForcingJumps.logarithm`), and
let bars be means over the slit's equilibrium measure. The density P[psi] of the jump's part psi of
the slack has the transform

    q = 0:  (h/pi)(bar(G) - G_s) + (a_0 + a_1 rho) / sqrt,
    q = 1:  (h/pi)(bar((zeta - .) G - sin) + (m - s) bar(G) - (phi - bar(phi)) rho
            - (zeta - s) G_s + sin(phi)) + (a_0 + a_1 rho) / sqrt,
    q = 2:  as in `sie.slits.kinks`, with (zeta - s)^2 G - (zeta - 3 s/2) sin for (t - s)^2 kappa,
            and rho, rho^2/2 for X, t X,

with -i (2 log(B) - log(2 rho (zeta - s'))) for G at the place s' in the slit. The mean of log(B) is
smooth, that of log(zeta - s') is log(r / 2 rho_slit), and that of (zeta - s') log(zeta - s') is
r (zeta_slit (log(r/2) + 1 + arcosh(zeta_slit)) - sqrt(zeta_slit^2 - 1)).

The potential W is integrated along the vertical: W(z) = W(z + i Y) - i int F, with the transform F.
The integral begins at a height where the first coefficients on the wide zones give W to round-off.
"""

from collections.abc import Iterator

import numpy as np

from sie.basis import chebyshev
from sie.basis.data import DIGITS, EPS, Array, legendre, record
from sie.basis.interval import (
    Complex,
    InPlane,
    What,
    complex_of,
    half_angles,
    root_weight,
    transform_of,
    transform_slope_of,
)
from sie.basis.sums import OPTIONS as SUMS
from sie.basis.sums import pair_blocks
from sie.density.density import Density
from sie.jumps.formulas import HIGHEST
from sie.slits.kinks import SlitKink
from sie.slits.slits import OPTIONS, SlitGeometry, Slits

# Bound of |rho|, below which a short series is enough. rho = zeta - sqrt(zeta^2 - 1), with the
# coordinate zeta of a wide zone, falls with the distance from the zone. The first `min_slack_modes`
# coefficients of the slack (the unknown function in a slit) then give the slack's field to
# round-off.
_FAR = float(np.exp(-DIGITS / OPTIONS.min_slack_modes))
# Number of panels of the vertical path along which the potential is integrated. Each panel is half
# as high as the panel above it. The lowest panel is as high as the round-off of the path's height.
_PANELS = -int(np.log2(EPS))


@record
class SlitPlane:
    """Transform and potential at complex points of a density on zones with narrow gaps (slits).

    whole: density on the wide zones from its first coefficients, which give the fields far from
    these zones; slack: the slits' part of `whole`, on the wide zones with slits; series: series of
    s sqrt(1 - t^2) on each slit, with the slack s; kinks: (index of the slit, jump) for the jumps
    in slits.
    """

    geometry: SlitGeometry
    whole: Density
    slack: Density
    slits: tuple[Slits, ...]
    series: list[list[Array]]
    kinks: list[list[tuple[int, SlitKink]]]

    def __call__(self, z: Complex, what: What) -> Complex:
        """Transform, derivative of the transform, or potential, at complex points z (n,)."""
        x, y = z.real, np.abs(z.imag)
        out = self._potential(x, y) if what == "potential" else self._transform(x, y, what)
        return np.where(z.imag < 0, np.conj(out), out)

    def _transform(self, x: Array, y: Array, what: What) -> Complex:
        """Transform or its derivative at x + i y, with closed forms close to slits."""
        whole, wide = self.whole, self.geometry.wide
        x = whole.into_period(x)
        out = whole.plane(complex_of(x, y), what)
        slack = self.slack
        for number, (here, row, kinks) in enumerate(
            zip(self.slits, self.series, self.kinks, strict=True)
        ):
            w = float(wide.half[here.zone])
            for shift in whole.kernel.poles:
                at = x - shift
                seen = InPlane.of((at - wide.a[here.zone]) / w, (at - wide.b[here.zone]) / w, y / w)
                some = np.flatnonzero(np.abs(seen.rho) > _FAR)
                if len(some) == 0:
                    continue
                close = seen[some]
                out[some] -= slack.plane.of_zones(
                    at[some], y[some], np.full(len(some), number), (what,)
                )[0]
                value, slope = _of_series(here, row, at[some], y[some])
                value = (
                    value if what == "transform" else slope - value * close.zeta / close.root**2
                ) / close.root
                for k, kink in kinks:
                    slit = here.slits[k]
                    inner = InPlane.of(
                        (at[some] - here.a[k]) / slit.width,
                        (at[some] - here.b[k]) / slit.width,
                        y[some] / slit.width,
                    )
                    value = value + _of_kink(kink, close, inner, what)
                out[some] += value / w if what == "derivative" else value
        return out

    def _potential(self, x: Array, y: Array) -> Complex:
        """The potential at x + i y, integrated downwards from a height above the wide zones.

        At points above this height it is computed without integration.
        """
        top = np.maximum(y, float(self.geometry.wide.half.max()))
        out = self.whole.plane(complex_of(x, top), "potential")
        parts, weights = legendre(
            np.append(0.0, 0.5 ** np.arange(_PANELS, -1, -1)), SUMS.gauss_nodes
        )
        down = np.flatnonzero(top > y)
        for some in pair_blocks(len(down), len(parts)):
            here = down[some]
            # The panels of the path become shorter towards the end point at height y.
            height = y[here, None] + (top - y)[here, None] * parts
            place = np.broadcast_to(x[here, None], height.shape)
            field = self._transform(place.ravel(), height.ravel(), "transform").reshape(
                height.shape
            )
            out[here] -= 1j * (top - y)[here] * (field @ weights)
        return out


def _of_series(here: Slits, row: list[Array], x: Array, y: Array) -> tuple[Complex, Complex]:
    """(transform, its derivative) of s sqrt(1 - t^2) on the slits (narrow gaps) of a wide zone.

    s is the slack, the unknown function in a slit.
    """
    value, slope = np.zeros((2, len(x)), dtype=complex)
    first = np.zeros(len(x), dtype=np.intp)
    for slit, a, b, d in zip(here.slits, here.a, here.b, row, strict=True):
        seen = InPlane.of((x - a) / slit.width, (x - b) / slit.width, y / slit.width)
        parts = chebyshev.bounded_part(d[None])
        value += transform_of(*parts, seen, first)
        slope += transform_slope_of(*parts, seen, first) / slit.half
    return value, slope


def _of_kink(kink: SlitKink, seen: InPlane, inner: InPlane, what: What) -> Complex:
    """Transform, or its derivative by zeta, of the density due to psi, a part of the slack.
    psi is the part of the slack (the slit's unknown function) that a jump causes, see
    `SlitKink.slope`.

    The formula holds off the wide zone. seen, inner: the points relative to the wide zone and to
    the slit.
    """
    _, l, r = kink.mean_places
    zeta, rho, root, half, q = seen.zeta, seen.rho, seen.root, kink.half, kink.order
    (a_0, a_1), (turn, bend), scale = kink.edge, kink.polynomial, kink.jump / np.pi
    constant = turn - bend * 0.5 * (kink.start - kink.rest)
    log_b, log_rho = seen.turned(*half_angles(l, r)), np.log(2.0) - seen.log
    mean_log = np.log(0.5 * half) + inner.log
    away, (c, s) = seen.left - kink.from_left, half_angles(kink.from_left, kink.from_right)
    own = -1j * np.log((c - 1j * s) ** 2 * (c * seen.m + 1j * s * seen.p) ** 2 / away)
    sine, sines, nodes = 2 * c * s, root_weight(l, r), 0.5 * (l - r)
    moves = (seen.left[:, None] - l) / half  # zeta - s' for the nodes s'
    first = inner.zeta * (mean_log + 1) - inner.root

    def means() -> Iterator[Complex]:
        """Means over the slit for a jump of order q = 0, 1, 2, each divided by half^q.

        They are terms of the transform, see the head of this module. For q = 0 the mean is bar(G),
        for q = 1 bar((zeta - .) G - sin).
        """
        yield -1j * (2 * log_b.mean(axis=-1) - log_rho - mean_log)
        yield (
            -1j * (2 * (moves * log_b).mean(axis=-1) - inner.zeta * log_rho - first)
            - sines.mean() / half
        )
        fall = np.exp(-inner.log)
        square = (inner.zeta**2 + 0.5) * (mean_log + log_rho) + (
            2 * inner.zeta - 0.25 * fall
        ) * fall
        line = zeta * sines.mean() - 1.5 * (nodes * sines).mean()
        yield -1j * (2 * (moves**2 * log_b).mean(axis=-1) - square) - line / half**2

    def mean_slopes() -> Iterator[Complex]:
        """Derivatives of the means in `means` by the coordinate zeta."""
        b_slope = 0.5 * ((zeta[:, None] + nodes) / (root[:, None] + 1j * sines) - 1) / root[:, None]
        yield -1j * (2 * b_slope.mean(axis=-1) + 1 / root - 1 / (half * inner.root))
        slope = 2 * (log_b / half + moves * b_slope).mean(axis=-1) - (log_rho + mean_log + 1) / half
        yield -1j * (slope + inner.zeta / root)
        square = (
            2 * (moves * (2 * log_b / half + moves * b_slope)).mean(axis=-1)
            + (inner.zeta**2 + 0.5) / root
        )
        yield (
            -1j * (square - (2 * inner.zeta * log_rho + 2 * first + inner.zeta) / half)
            - sines.mean() / half**2
        )

    if what == "transform":
        its = (
            away**q * own
            - (0.0, sine, (zeta - 1.5 * 0.5 * (kink.from_left - kink.from_right)) * sine)[q]
        )
        return np.asarray(
            scale * (kink.mixed(means()) - its)
            - (constant + 0.5 * bend * rho) * rho
            + (a_0 + a_1 * rho) / root
        )
    its = (
        -(away ** (q - 1.0)) * sine / root
        + q * away ** max(q - 1, 0) * own
        - (sine if q == HIGHEST else 0.0)
    )
    edge = -(a_1 * rho / root + (a_0 + a_1 * rho) * zeta / root**2) / root
    return np.asarray(
        scale * (kink.mixed(mean_slopes()) - its) + (constant + bend * rho) * rho / root + edge
    )
