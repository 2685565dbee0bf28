r"""`Conjugate`: the periodic Hilbert transform H f' of the slope of a profile.

H f' = (1/L) PV int f'(xi) cot(pi (x - xi)/L) dxi takes cos kx to sin kx and sin kx to -cos kx.

A profile may have H f' in closed form. Otherwise the declared jumps of f', f'' and f''' are
subtracted from f' as periodic Bernoulli polynomials. Let J be the jump of the q-th derivative of f'
at s, and u = (x - s)/L. Then the transforms of these polynomials are

    q = 0   (J / pi) ln|2 sin(pi u)|
    q = 1   -(J L / 2 pi^2) Cl_2(2 pi u),    Cl_2(y) = sum_k sin(ky)/k^2
    q = 2   (J L^2 / 4 pi^3) Cl_3(2 pi u),   Cl_3(y) = sum_k cos(ky)/k^3

The rest is smooth, and its Fourier series is transformed term by term. Poles of algebraic points
(sie.AlgebraicPoints) are subtracted as well. The periodic form of 1/(y - i eta) is (pi/L) cot(pi (y
- i eta)/L); its transform is i times the cotangent term, plus pi/L. The polynomials of all jumps
together are one piecewise quadratic, whose transform takes a time that does not grow with their
number (pieces.py).

The logarithms of kinks are kept separate from the rest, `smooth`. Next to a kink, the logarithm
needs the distance from the kink to more digits than x has (sie.jumps.density).
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property
from math import pi

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import ArrayLike
from scipy import fft
from scipy.special import zeta

import sie
from contact.errors import SceneError
from contact.formulation.pieces import Pieces
from contact.model.plugin_checks.jumps import CHECKS
from contact.model.profiles.base import Profile, is_of_package
from contact.model.profiles.derive import DETAIL
from contact.model.profiles.noise import EPS
from contact.model.profiles.trigonometric import Sum
from sie import Array, Complex, record


@dataclass(frozen=True)
class ConjugateOptions:
    """Options for the Hilbert transform H f' of a sampled slope f', and for its error estimate."""

    max_samples: int = 2**18
    # Largest number of pairs (point, jump) that are evaluated at once. It limits the memory.
    block: int = 1 << 20
    # Safety factor in the stated error of H f'. The error is this number times the largest sample
    # of the residual, or of the residual's transform. The residual is the sum of the Fourier terms
    # of f' that are left out. It may be larger between the samples.
    residual_margin: float = 2.0
    # This safety factor replaces `residual_margin` if the Fourier terms are halved per octave, like
    # those of a jump. The samples of the residual may be only 1/4 of the jump, while its Hilbert
    # transform at 1e-5 periods from the jump is 4 times the jump.
    jump_margin: float = 16.0
    # Fourier terms that do not decay count as noise of the slope if they are below this fraction of
    # the largest slope or Fourier term. Larger terms may come from an undeclared kink.
    max_noise: float = 1e-9
    no_decay: float = 0.6  # ratio of terms one octave apart, above which they do not decay


OPTIONS = ConjugateOptions()
# Distance from a kink, in periods, within which a closed form of H f' is interpolated linearly. The
# interpolation has an error of about the square of this distance. The closed form itself has a
# round-off of EPS divided by the distance from the kink.
_KINK_REACH = np.cbrt(EPS)


@record
class Conjugate(sie.Kept):
    """The Hilbert transform H f' of the slope of a periodic profile, as a function of x [m].

    `kinks` (k, 2) are those of the profile, `breakpoints` its other breakpoints.
    """

    profile: Profile

    @cached_property
    def kinks(self) -> Array:
        return np.asarray(self.profile.kinks, dtype=float)

    @cached_property
    def breakpoints(self) -> Array:
        return np.setdiff1d(np.asarray(self.profile.breakpoints, dtype=float), self.kinks[:, 0])

    @property
    def period(self) -> float:
        assert self.profile.period is not None
        return self.profile.period

    @cached_property
    def smooth(self) -> Callable[[Array], Array]:
        """The transform H f' of the slope, minus the logarithmic terms of the kinks (jumps of f').

        A kink at s with the jump J has the logarithm (J / pi) ln|2 sin(pi (x - s) / L)|, L the
        period.
        """
        return self._transform.smooth

    @property
    def error(self) -> float:
        """Estimate of the largest error of the transform H f', apart from round-off of its sums.

        It contains the noise of the slopes, the truncation of their series, and the difference of a
        user's closed form from the series.
        """
        return self._transform.error

    @property
    def limit(self) -> str:
        """Main cause of the error of the transform H f', as text for messages."""
        return self._transform.limit

    @cached_property
    def _transform(self) -> "Transform":
        profile, length = self.profile, self.period
        if len(profile.bodies) > 1:
            return self._of_bodies()
        if profile.slope_conjugate(np.array([profile.x0 + 0.4142 * length])) is None:
            return _series(profile, length)
        closed = lambda x: np.asarray(profile.slope_conjugate(x))  # noqa: E731
        if is_of_package(profile) and len(self.kinks) == 0:
            return Transform(closed)
        series = _series(profile, length)
        if len(self.kinks):
            closed = _less_logarithms(profile, self.kinks, length)
        difference = 0.0 if is_of_package(profile) else self._difference(closed, series)
        if series.settled:
            return series
        return Transform(
            closed, difference, "slope_conjugate differs too much from the transform of the slope"
        )

    def _of_bodies(self) -> "Transform":
        """The transform H f' of a profile made of two bodies: the sum of both bodies' transforms.

        Each body has its own period. So the logarithmic term of a kink, which `smooth` leaves out,
        has the period of its body. It equals a sum over all repetitions of the kink in the common
        period, of logarithmic terms with the common period.
        """
        profile = self.profile
        parts = {place: Conjugate(body)._transform for place, body in profile.bodies.items()}

        def smooth(x: Array) -> Array:
            return np.asarray(
                sum(parts[place].smooth(at) for place, at in profile.facing(x).items())
            )

        worst = max(parts.values(), key=lambda part: part.error)
        return Transform(smooth, sum(part.error for part in parts.values()), worst.limit)

    def _difference(self, closed: Callable[[Array], Array], series: "Transform") -> float:
        """Error of a closed form of H f' that a user gives.
        It is twice the largest difference from the transform `series` that is computed by a Fourier
        series.

        Raises SceneError if the difference is so large that the closed form must be wrong.
        """
        checks = 2 * DETAIL.samples_per_length
        x = self.profile.x0 + self.period * (np.arange(checks) + 0.4142) / checks
        here, there = closed(x), series.smooth(x)
        difference = np.abs(here - there)
        worst = int(np.argmax(difference))
        size = max(float(np.abs(there).max()), series.scale)
        if not difference[worst] <= CHECKS.same * size + 2 * series.error:
            at, given, wanted = (float(values[worst]) for values in (x, here, there))
            less = ", both without the logarithms of the kinks" if len(self.kinks) else ""
            raise SceneError(
                f"slope_conjugate disagrees with the slope: at x = {at:.6g} m it is "
                f"{given:.6g}, but (1/L) PV int f'(xi) cot(pi (x - xi)/L) dxi is "
                f"{wanted:.6g}{less}: correct slope_conjugate, or leave it out",
                "profile",
                self.profile,
            )
        return OPTIONS.residual_margin * float(difference[worst])

    def __call__(self, x: ArrayLike) -> Array:
        x = np.asarray(x, dtype=float)
        return np.asarray(
            self.smooth(x) + logarithms(x, self.kinks[:, 0], self.kinks[:, 1], self.period)
        )


def logarithms(x: Array, at: Array, heights: Array, period: float) -> Array:
    """Logarithmic terms of the Hilbert transform H f', summed over all kinks (jumps of f').

    A kink at s with the jump J has the logarithm (J / pi) ln|2 sin(pi (x - s) / L)|, L the period.
    """
    return over_jumps(x, at, heights / pi, period, log_sine)


@record
class Transform:
    """The transform H f' minus the logarithmic terms of the kinks, with its estimated error.

    error: estimate of the largest error. limit: its cause, in words. settled: whether the series of
    the slope has converged. scale: the largest slope or term.
    """

    smooth: Callable[[Array], Array]
    error: float = 0.0
    limit: str = ""
    settled: bool = True
    scale: float = 0.0


@record
class SlopeParts:
    """The slope of a periodic profile as the sum of closed forms and of a Fourier series.

    kinks: a piecewise quadratic with the jumps of f'. jumps: a piecewise quadratic with the jumps
    of f'' and f'''. first, over: the place (1,) and the jump of f''' of a cubic Bernoulli
    polynomial; empty without jumps. points: poles of algebraic points. terms: complex Fourier terms
    c_k, k = 1, 2, ... of the rest, whose value is Re sum c_k exp(2 pi i k (x - x0)/L). error,
    limit, settled, scale: as in `Transform`.
    """

    kinks: Pieces
    jumps: Pieces
    first: Array
    over: Array
    points: "PeriodicPoles"
    terms: Complex
    error: float
    limit: str
    settled: bool
    scale: float


def slope_parts(profile: Profile, length: float) -> SlopeParts:
    """The slope f' as a sum of closed forms and a Fourier series.
    The closed forms contain the declared jumps and algebraic points, the series contains the rest.
    """
    kinks, jumps = np.asarray(profile.kinks, dtype=float), np.asarray(profile.jumps, dtype=float)
    orders = jumps[:, 1] - 1
    # `over` is the sum of the jumps of f'''. `Pieces` needs jumps whose sum is 0, so the jump
    # -`over` is added at the place `first`. The cubic Bernoulli polynomial in the function `closed`
    # below has the jump `over` at `first` and cancels the added jump.
    first, over = jumps[:1, 0], np.full(len(jumps[:1]), jumps[orders == 2, 2].sum())
    at, heights = np.append(jumps[:, 0], first), jumps[:, 2, None] * (orders[:, None] == [0, 1, 2])
    of_jumps = Pieces.of(
        profile.x0, length, at, np.concatenate((heights, -over[:, None] * [0.0, 0.0, 1.0]))
    )
    of_kinks = Pieces.of(profile.x0, length, kinks[:, 0], kinks[:, 1, None] * [1.0, 0.0, 0.0])

    points = PeriodicPoles.of(profile, length)

    def closed(x: Array) -> Array:
        return np.asarray(
            of_kinks(x)
            + of_jumps(x)
            + over_jumps(x, first, -over * length**2, length, _bernoulli3)
            + points(x, False)
        )

    # The subtracted polynomials may be much larger than their sum. So the round-off is estimated
    # from the absolute values of their jumps.
    rounding = (
        EPS * float(np.abs(kinks[:, 1]).sum() + (np.abs(jumps[:, 2]) * length**orders).sum()) / 12
    )
    rounding += EPS * points.size
    series = _sampled_series(profile, length, closed, rounding)
    coefficients, size, scale = series.coefficients, np.abs(series.coefficients), series.scale
    used = np.flatnonzero(size > max(1e-17 * scale, series.noise))
    k = np.arange(int(used[-1]) + 1 if len(used) else 1)
    c = (2 * coefficients[: len(k)] * np.exp(-1j * pi * k / len(series.x)))[1:]
    error = _series_error(coefficients, len(k), rounding)
    limit = _limit_of_series(series.x, series.residual, size, series.settled)
    return SlopeParts(
        of_kinks, of_jumps, first, over, points, c, error, limit, series.settled, scale
    )


def _series(profile: Profile, length: float) -> Transform:
    """The transform H f', minus the kinks' logarithmic terms, from the parts of the slope f'.
    See `slope_parts` for the parts.
    """
    parts = slope_parts(profile, length)
    first, over, of_jumps, points = parts.first, parts.over, parts.jumps, parts.points
    # H multiplies the complex Fourier terms by -i: cos becomes sin, and sin becomes -cos. `Sum`
    # takes the real part of its terms.
    left = Sum.of(-1j * parts.terms) if len(parts.terms) else None

    def smooth(x: Array) -> Array:
        x = np.asarray(x, dtype=float)
        turns = (np.asarray(profile.wrap(x)) - profile.x0) / length
        out = np.zeros(x.shape) if left is None else left(turns.ravel()).reshape(x.shape)
        out = out + points(x, True)
        if len(profile.jumps) == 0:
            return np.asarray(out)
        return np.asarray(
            out
            + of_jumps.conjugate(x)
            + over_jumps(x, first, over * length**2 / (4 * pi**3), length, clausen3)
        )

    return Transform(smooth, parts.error, parts.limit, parts.settled, parts.scale)


@record
class _SampledSeries:
    """Fourier series of a slope from which the declared jumps are subtracted.

    x: evenly spaced places. residual: the slope at these places, without its jumps. coefficients:
    complex terms. noise: size below which terms are noise. scale: the largest slope or term.
    settled: whether the series has converged.
    """

    x: Array
    residual: Array
    coefficients: Array
    noise: float
    scale: float
    settled: bool


def _sampled_series(
    profile: Profile, length: float, closed: Callable[[Array], Array], rounding: float
) -> _SampledSeries:
    """The Fourier series of a sampled slope, from more and more samples until it converges.

    closed: the part of the slope that is subtracted. rounding: rounding error of that part.
    """
    # Fewer samples than the resolution of the profile requires would cause aliasing.
    least = 2 ** np.ceil(np.log2(8 * length / (profile.resolution or length)))
    n = int(np.clip(least, DETAIL.min_samples, OPTIONS.max_samples))
    while True:
        x = profile.x0 + length * (np.arange(n) + 0.5) / n
        slope = np.asarray(profile.slope(x))
        residual = slope - closed(x)
        coefficients = np.asarray(fft.rfft(residual)) / n
        size = np.abs(coefficients)
        scale = max(float(size.max()), float(np.abs(slope).max()))
        noise = max(rounding, _noise(size, scale))
        settled = bool(size[-n // 16 :].max() <= max(1e-15 * scale, noise))
        if settled or n >= OPTIONS.max_samples:
            return _SampledSeries(x, residual, coefficients, noise, scale, settled)
        n *= 2


def _series_error(coefficients: Array, used: int, rounding: float) -> float:
    """Estimated largest error of the slope and its transform, with the first `used` Fourier terms.

    coefficients: of the slope at evenly spaced places. used: number of terms in use. The terms left
    out, at least the last octave, are the residual: noise of the slope, an undeclared jump, or
    truncation. The error of the transform is the transform of the residual. The residual and its
    transform are evaluated at the samples.

    Between the samples, the transform grows logarithmically towards a jump. So the margin is larger
    if the terms fall as slowly as those of a jump, by half per octave.
    """
    n = len(coefficients) - 1
    left_out = np.where(np.arange(n + 1) < min(used, n // 2), 0.0, coefficients)
    largest, conjugate = (
        float(np.abs(fft.irfft(factor * left_out, 2 * n)).max()) * (2 * n) for factor in (1, 1j)
    )
    last, before = _last_octaves(np.abs(coefficients))
    like_jump = min(1.0, (2.0 * last / before) ** 2) if before > 0 else 1.0
    margin = OPTIONS.residual_margin
    of_jump = (OPTIONS.jump_margin - margin) * like_jump * largest
    return margin * max(largest, conjugate) + of_jump + rounding


def _last_octaves(size: Array) -> tuple[float, float]:
    """Root mean squares of the terms n/2 ... n of a series, and of its terms n/4 ... n/2."""
    n = len(size) - 1
    last, before = (float(np.sqrt(np.mean(size[k : 2 * k] ** 2))) for k in (n // 2, n // 4))
    return last, before


def _limit_of_series(x: Array, smooth: Array, size: Array, settled: bool) -> str:
    """Main cause of the error of a Fourier series, in words.

    smooth: the slope at evenly spaced places x, without its declared jumps. size: absolute values
    of all terms.
    """
    last, before = _last_octaves(size)
    if settled or last >= OPTIONS.no_decay * before:
        return (
            f"the slope of the profile has errors of about {last * np.sqrt(len(x)):.1e}, for "
            "example because it is derived from heights with a large constant, or because x is far "
            "from 0"
        )
    steps = np.abs(np.diff(smooth, append=smooth[:1]))
    at = int(np.argmax(steps))
    if steps[at] > CHECKS.stands_out * float(np.median(steps)):
        return (
            f"the slope jumps by {steps[at]:.3g} at x = {x[at]:.6g} m, but the profile does not "
            "declare this jump in `kinks`"
        )
    return (
        "apart from its declared jumps, the slope of the profile varies over lengths below "
        f"{x[1] - x[0]:.1e} m"
    )


@record
class PeriodicPoles:
    """Poles (outside the real line) whose sum represents a periodic slope near algebraic points.
    Near such a point, the slope is a power of the distance from the point.

    A pole with distance eta from the line is stored as tanh(pi eta/L) and a coefficient, L the
    period.

    Poles farther than half a period from the line stay in the series. The term of a pole at the
    distance y along the line, with s = sin(pi y/L), k = cos(pi y/L) and T = tanh(pi eta/L), is
    cot(pi (y - i eta)/L) = (s k (1 - T^2) + i T) / (s^2 + k^2 T^2).
    """

    length: float
    points: sie.AlgebraicPoints
    poles: list[tuple[Array, Complex]]

    @classmethod
    def of(cls, profile: Profile, length: float) -> "PeriodicPoles":
        at, n, left, right = np.asarray(profile.algebraic_points, dtype=float).T
        points = sie.AlgebraicPoints(at, n - 1, -n * left, n * right)
        some = [points.poles(k, 0.5 * length) for k in range(len(points.places))]
        return cls(
            length,
            points,
            [(np.tanh(pi * away / length), size * (pi / length)) for away, size in some],
        )

    @property
    def size(self) -> float:
        """Upper bound of the absolute value of the sum of all poles' terms."""
        return float(sum((np.abs(size) / tanh).sum() for tanh, size in self.poles))

    def __call__(self, x: Array, conjugate: bool) -> Array:
        """Sum of all poles' terms at places x; if `conjugate`, of the terms' Hilbert transforms."""
        out, flat = np.zeros(np.size(x)), np.ravel(x)
        for place, (at, (tanh, size)) in enumerate(
            zip(self.points.places.tolist(), self.poles, strict=True)
        ):
            turns = (flat - at) / self.length
            turns -= np.round(turns)
            c = 1j * size if conjugate else size
            weights = np.column_stack((c.real * (1 - tanh) * (1 + tanh), c.imag * tanh))
            mean = size.real.sum() if conjugate else 0.0
            for here in range(0, len(flat), max(1, OPTIONS.block // len(tanh))):
                s, k = (
                    wave(pi * turns[here : here + OPTIONS.block // len(tanh)])
                    for wave in (np.sin, np.cos)
                )
                odd, even = (1 / ((s * s)[:, None] + (k * k)[:, None] * tanh**2) @ weights).T
                out[here : here + len(s)] += s * k * odd - even + mean
            if conjugate:
                # The list of poles omits those closest to an algebraic point (a place near which
                # the slope is a power of the distance). At the point itself their terms matter: a
                # pole c / (y - i eta) adds i c / (-i eta) = -c / eta to the transform. `left_out`
                # is the sum of c / eta.
                out[turns == 0.0] -= self.points.left_out(place, 0.5 * self.length).real
        return out.reshape(np.shape(x))


def _noise(size: Array, scale: float) -> float:
    """Size below which Fourier terms are noise of a numerically derived slope; 0 without noise.

    Terms that are noise are as large in the last octave as in the octave before. The terms of a
    profile decrease.
    """
    last, before = _last_octaves(size)
    return 6 * last if OPTIONS.no_decay * before < last < OPTIONS.max_noise * scale else 0.0


def _less_logarithms(profile: Profile, kinks: Array, length: float) -> Callable[[Array], Array]:
    """The profile's closed form of H f', minus the logarithmic terms of the kinks (jumps of f').

    Across each kink, it is interpolated linearly.
    """

    def plain(x: Array) -> Array:
        return np.asarray(profile.slope_conjugate(x)) - logarithms(
            x, kinks[:, 0], kinks[:, 1], length
        )

    def smooth(x: Array) -> Array:
        x = np.asarray(x, dtype=float)
        reach = _KINK_REACH * length
        away = (x[..., None] - kinks[:, 0] + 0.5 * length) % length - 0.5 * length
        which = np.argmin(np.abs(away), axis=-1)
        nearest = np.take_along_axis(away, which[..., None], axis=-1)[..., 0]
        close = np.abs(nearest) < reach
        out = np.array(plain(np.where(close, x - nearest + reach, x)))
        if np.any(close):
            share = 0.5 * (1 + nearest[close] / reach)
            out[close] = share * out[close] + (1 - share) * plain((x - nearest - reach)[close])
        return out

    return smooth


def log_sine(u: Array) -> Array:
    with np.errstate(divide="ignore"):
        return np.asarray(np.log(np.abs(2 * np.sin(pi * u))))


def over_jumps(
    x: Array, at: Array, weights: Array, length: float, function: Callable[[Array], Array]
) -> Array:
    """Sum over all jumps k of weights_k function(u_k), in blocks that limit the memory.

    Here u_k = (x - s_k)/L lies between -1/2 and 1/2, with the places s_k of the jumps and the
    period L.
    """
    x = np.asarray(x, dtype=float)
    out = np.zeros(x.size)
    # The function may be infinite at a jump of height 0, and 0 times infinity is no number.
    at, weights = at[weights != 0.0], weights[weights != 0.0]
    if len(at) == 0:
        return out.reshape(x.shape)
    flat = x.ravel()
    block = max(1, OPTIONS.block // len(at))
    for s in range(0, flat.size, block):
        u = (flat[s : s + block, None] - at) / length
        out[s : s + block] = function(u - np.round(u)) @ weights
    return out.reshape(x.shape)


def _bernoulli3(u: Array) -> Array:
    """Bernoulli polynomial B_3(u) / 6, u in periods; its second derivative jumps by -1 at u = 0."""
    u = u % 1.0
    return np.asarray(((u - 1.5) * u + 0.5) * u / 6)


@cache
def _clausen_series(terms: int = 26) -> tuple[Array, Array]:
    """Coefficients of the power series in `clausen2` and in `clausen3`.

    They are |B_2k| / (2k (2k+1)!) and |B_2k| / (2k (2k+2)!), with the Bernoulli numbers B_2k. Here
    |B_2k| = 2 (2k)! zeta(2k) / (2 pi)^2k (DLMF 25.6.2). For arguments within half a period, each
    term of the series is at most a quarter of the term before it.
    """
    even = 2.0 * np.arange(1, terms + 1)
    second = 2 * zeta(even) / (2 * pi) ** even / (even * (even + 1))
    return second, second / (even + 2)


def clausen2(u: Array) -> Array:
    """Clausen's function sum_k sin(k y)/k^2 of y = 2 pi u, for |u| <= 1/2.

    It is y - y ln|y| + sum_k |B_2k| y^(2k+1) / (2k (2k+1)!).
    """
    angle = 2 * pi * u
    square = angle * angle
    with np.errstate(divide="ignore", invalid="ignore"):
        own = np.where(angle == 0, 0.0, angle * (1 - np.log(np.abs(angle))))
    return np.asarray(own + angle * square * polyval(square, _clausen_series()[0]))


def clausen3(u: Array) -> Array:
    """The sum of cos(k y)/k^3 over all k > 0 for y = 2 pi u, |u| <= 1/2.

    It is zeta(3) + (y^2/2)(ln|y| - 3/2) - sum_k |B_2k| y^(2k+2) / (2k (2k+2)!).
    """
    angle = 2 * pi * u
    square = angle * angle
    with np.errstate(divide="ignore", invalid="ignore"):
        own = np.where(angle == 0, 0.0, 0.5 * square * (np.log(np.abs(angle)) - 1.5))
    return np.asarray(zeta(3) + own - square * square * polyval(square, _clausen_series()[1]))
