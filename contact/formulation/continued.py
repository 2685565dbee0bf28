r"""`ContinuedSlope`: the transform of the slope of a periodic profile at points of the half plane.

The transform H f' on the line is the real part of an analytic function R(z), z = x + iy with y > 0,
which is zero far from the line:

    R(z) = (1/L) int f'(xi) cot(pi (z - xi)/L) dxi,       R(x + i0) = H f' - i f'.

Let s be the place of a jump or of an algebraic point, w = exp(2 pi i (z - s)/L), and u = x - s on
the line. The parts of the slope f' (left; see contact.formulation.conjugate) contribute to R
(right)

    jump J of f' at s       (J / pi) ln(1 - w)
    piecewise quadratic     the sum over its pieces (sie.PiecewiseTransform)
    Bernoulli polynomial    (J L^2 / 4 pi^3) Li_3(w),      Li_n(w) = sum_k w^k / k^n
    Re sum c_k w^k          -i sum c_k w^k
    pole c / (u - i eta)    (pi/L) (Re c - i conj(c) cot(pi (z - s + i eta)/L))
"""

from math import pi

import numpy as np
from scipy.special import zeta

import sie
from contact.formulation.conjugate import OPTIONS, PeriodicPoles, SlopeParts, slope_parts
from contact.formulation.power_sums import power_sums
from contact.model.profiles.base import Profile
from sie import Array, Complex, wrapped

# Values of a function and of its derivative.
Pair = tuple[Complex, Complex]


class ContinuedSlope(sie.Kept):
    """The transform R(z) of the slope of a periodic profile and its derivative R'(z).

    If the profile is made of two bodies, it is the sum of both bodies' transforms.
    """

    def __init__(self, profile: Profile) -> None:
        bodies = profile.bodies if len(profile.bodies) > 1 else {"": profile}
        self.profile = profile
        self.bodies = {place: _OneBody(body) for place, body in bodies.items()}

    @property
    def error(self) -> float:
        """Estimate of the largest error of R, the transform of the profile's slope."""
        return sum(body.parts.error for body in self.bodies.values())

    def __call__(self, x: Array, y: Array) -> Pair:
        """Transform R [1] of the slope and its derivative R' [1/m] at points x + iy [m].
        y must not be negative, and x and y have the same shape.
        """
        shape, x, y = x.shape, x.ravel(), y.ravel()
        value, slope = np.zeros(len(x), dtype=complex), np.zeros(len(x), dtype=complex)
        facing = self.profile.facing(x) if "" not in self.bodies else {"": x}
        for place, at in facing.items():
            one, its_slope = self.bodies[place](np.asarray(at), y)
            if self._is_mirrored(place):
                # A mirrored body has the slope -g(-x). If g has the transform R(z), -g(-x) has the
                # transform conj(R(-conj(z))).
                one, its_slope = np.conj(one), -np.conj(its_slope)
            value, slope = value + one, slope + its_slope
        return value.reshape(shape), slope.reshape(shape)

    def _is_mirrored(self, place: str) -> bool:
        return place == "counter" and bool(getattr(self.profile, "mirrored", False))


class _OneBody(sie.Kept):
    """The transform R(z) of the slope of a single periodic profile, and its derivative."""

    def __init__(self, profile: Profile) -> None:
        assert profile.period is not None
        self.length, self.x0 = profile.period, profile.x0
        self.kinks = np.asarray(profile.kinks, dtype=float)
        self.parts: SlopeParts = slope_parts(profile, self.length)
        self.has_jumps = len(profile.jumps) > 0

    def __call__(self, x: Array, y: Array) -> Pair:
        pairs = [self._of_waves(x, y), self._of_kinks(x, y)]
        if self.has_jumps:
            pairs += [self._of_jumps(x, y), self._of_polynomial(x, y)]
        if self.parts.points.poles:
            pairs.append(self._of_points(self.parts.points, x, y))
        values, slopes = zip(*pairs, strict=True)
        return sum(values[1:], values[0]), sum(slopes[1:], slopes[0])

    def _exponents(self, x: Array, y: Array, at: Array | float) -> Complex:
        """Exponents 2 pi i (z - s)/L at z = x + iy; s is the image of `at` that is nearest to x."""
        turns = (x - at) / self.length
        return np.asarray(2 * pi * (1j * (turns - np.round(turns)) - y / self.length))

    def _of_kinks(self, x: Array, y: Array) -> Pair:
        value, slope = np.zeros(len(x), dtype=complex), np.zeros(len(x), dtype=complex)
        for at, height in self.kinks.tolist():
            exponent = self._exponents(x, y, at)
            with np.errstate(divide="ignore", invalid="ignore"):
                less = -np.expm1(exponent)  # 1 - w
                value += height / pi * np.log(less)
                slope -= 2j * height / self.length * np.exp(exponent) / less
        return value, slope

    def _of_jumps(self, x: Array, y: Array) -> Pair:
        pieces = self.parts.jumps
        return pieces.continued(wrapped(x - self.x0, float(pieces.places[0]), self.length), y)

    def _of_polynomial(self, x: Array, y: Array) -> Pair:
        (at,), (height,), length = self.parts.first, self.parts.over, self.length
        exponent = self._exponents(x, y, float(at))
        third, second = polylogarithms(exponent)
        size = height * length**2 / (4 * pi**3)
        return size * third, size * (2j * pi / length) * second

    def _of_waves(self, x: Array, y: Array) -> Pair:
        terms = -1j * self.parts.terms
        value, slope = power_sums(terms, self._exponents(x, y, self.x0))
        return value, slope * (2j * pi / self.length)

    def _of_points(self, points: PeriodicPoles, x: Array, y: Array) -> Pair:
        value, slope = np.zeros(len(x), dtype=complex), np.zeros(len(x), dtype=complex)
        for at, (tanh, size) in zip(points.points.places.tolist(), points.poles, strict=True):
            away = np.arctanh(tanh) * (self.length / pi)
            block = max(1, OPTIONS.block // len(tanh))
            for start in range(0, len(x), block):
                here = slice(start, start + block)
                exponent = self._exponents(x[here, None], y[here, None] + away, at)
                w, less = np.exp(exponent), -np.expm1(exponent)
                # With w = exp(2 i u), cot(u) is -i (1 + 2 w/(1 - w)), and the derivative of cot(u)
                # by u is 4 w/(1 - w)^2.
                value[here] += size.real.sum() - (1 + 2 * w / less) @ np.conj(size)
                slope[here] -= 1j * (4 * w / less**2) @ np.conj(size) * (pi / self.length)
        return value, slope


def polylogarithms(exponent: Complex) -> Pair:
    """The polylogarithms Li_3(w) and Li_2(w) at w = exp(-u), with Re u >= 0 and |Im u| <= pi.

    For |u| >= 1.25 pi, |w| is below 0.1, and the sum of w^k/k^n converges fast. Below that, series
    in u are used, which converge for |u| < 2 pi:

        Li_2 = zeta(2) - u (1 - ln u) + ...,   Li_n = sum_{k != n - 1} zeta(n - k) (-u)^k / k! + ...

    (A. Erdelyi et al., Higher Transcendental Functions I, 1953, 1.11 (9); DLMF 25.12.12).
    """
    u = -exponent
    near = np.abs(u) < 1.25 * pi
    third, second = np.empty(len(u), dtype=complex), np.empty(len(u), dtype=complex)
    third[near], second[near] = _near_one(u[near])
    k = np.arange(1, 61, dtype=float)
    third[~near] = power_sums((1 / k**3).astype(complex), exponent[~near])[0]
    second[~near] = power_sums((1 / k**2).astype(complex), exponent[~near])[0]
    return third, second


def _near_one(u: Complex) -> Pair:
    """The polylogarithms Li_3 and Li_2 of exp(-u), by their series in u for |u| < 1.25 pi."""
    with np.errstate(divide="ignore", invalid="ignore"):
        log = np.where(u == 0, 0.0, np.log(np.where(u == 0, 1.0, u)))
    # In both series, zeta is 0 at negative even integers. So after the term with zeta(0) = -1/2,
    # only terms with zeta at negative odd integers are left.
    third = 0.5 * u * u * (1.5 - log) + zeta(3) - zeta(2) * u
    second = -u * (1.0 - log) + zeta(2)
    third_terms, second_terms = _zeta_terms()
    square = u * u
    total, rate = np.zeros(len(u), dtype=complex), np.zeros(len(u), dtype=complex)
    for one, other in zip(third_terms[::-1], second_terms[::-1], strict=True):
        total, rate = total * square + one, rate * square + other
    third += u * square * (1 / 12) + square * square * total
    second += -0.25 * square + u * square * rate
    return third, second


def _zeta_terms(terms: int = 40) -> tuple[list[float], list[float]]:
    """Coefficients of the series of Li_3 and Li_2 (polylogarithms), m = 1, 2, ..., `terms`.
    They are zeta(1 - 2m)/(2m + 2)! for Li_3 and -zeta(1 - 2m)/(2m + 1)! for Li_2.

    |zeta(1 - 2m)| = 2 (2m - 1)! zeta(2m) / (2 pi)^2m, with the sign (-1)^m (DLMF 25.4.1).
    """
    m = np.arange(1, terms + 1, dtype=float)
    sign = np.where(m % 2, -1.0, 1.0)
    size = sign * 2 * zeta(2 * m) / (2 * pi) ** (2 * m) / (2 * m)
    third, second = size / ((2 * m + 1) * (2 * m + 2)), -size / (2 * m + 1)
    return third.tolist(), second.tolist()
