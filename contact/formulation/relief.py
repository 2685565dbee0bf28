r"""R, what full contact takes of the pressure: p = pbar - (E*/2) R, R_q = q f_q / L(q), of a
periodic profile on a body of symbol L.

For the half-plane L = 1 and R = H f' = (1/l) PV int f'(xi) cot(pi (x - xi)/l) dxi (cos kx -> sin
kx, sin kx -> -cos kx); for others the few waves with L_n != 1 are put right, R = H f' + sum_n q_n
(1/L_n - 1) 2 Re f_n exp(i q_n x). A convex jump J of f' makes R -inf there (infinite pressure), a
concave one, a valley with a kink, +inf: the logarithm (J/pi) ln|2 sin(pi (x - s)/l)| whatever the
body.
"""

from collections.abc import Callable
from functools import cached_property

import numpy as np

import sie
from contact.formulation.conjugate import Conjugate, log_sine, logarithms
from contact.formulation.noise import PLACES, STEP, noise
from contact.formulation.problem import Problem
from contact.formulation.quadrature import over_period
from contact.formulation.units import Units
from contact.model.operator import Operator
from contact.model.profiles.base import Profile
from contact.model.profiles.trigonometric import Sum, coefficients
from sie import Array, Complex, Index, record

# Samples of R a shortest length of the profile.
_CLOSE = 20
# Places for an estimate of the noise of heights; its largest value over its standard deviation.
_LOOKS = 256
_PEAK = 4.0


@record
class Relief(Conjugate):
    """R of x [m] of a periodic profile, with its kinks (k, 2) as it declares them; breakpoints: the
    profile's others.
    """

    operator: Operator

    @cached_property
    def smooth(self) -> Callable[[Array], Array]:
        """All of R but the logarithms of the kinks."""
        conjugate, waves = self._plain.smooth, self._sum
        return (
            conjugate if waves is None else lambda x: np.asarray(conjugate(x) + self._at(x, waves))
        )

    @cached_property
    def _plain(self) -> Conjugate:
        """H f' itself, as on a half-plane."""
        return Conjugate(self.profile)

    def of_waves(self, x: Array) -> Array:
        """What the kinks add to R through the waves in which the body is no half-plane: (J/pi)
        times the smooth part of the inverse kernel's potential, of all of them.
        """
        x = np.asarray(x, dtype=np.float64)
        if self._sum is None or len(self.kinks) == 0:
            return np.zeros(x.shape)
        return self._at(x, self._kinked)

    def _at(self, x: Array, waves: Sum) -> Array:
        turns = np.asarray((self.profile.wrap(x) - self.profile.x0) / self.period)
        return waves(turns.ravel()).reshape(turns.shape)

    @cached_property
    def _q(self) -> Array:
        return np.asarray(
            2 * np.pi / self.period * np.arange(1, len(self.inverse) + 1), dtype=np.float64
        )

    @cached_property
    def inverse(self) -> Array:
        """1 / L_n - 1."""
        inverse = self.operator.inverse_excess
        assert inverse is not None
        return inverse

    @cached_property
    def _sum(self) -> Sum | None:
        if len(self.inverse) == 0:
            return None
        return Sum.of(
            np.asarray(
                2 * self._q * self.inverse * harmonics(self.profile, len(self.inverse)),
                dtype=np.complex128,
            )
        )

    @cached_property
    def _kinked(self) -> Sum:
        turns = (self.kinks[:, 0] - self.profile.x0) / self.period
        n = np.arange(1, len(self.inverse) + 1)
        at_kinks = np.exp(-2j * np.pi * (np.outer(n, turns) % 1.0)) @ self.kinks[:, 1]
        return Sum.of(np.asarray(-self.inverse / (np.pi * n) * at_kinks, dtype=np.complex128))

    @cached_property
    def error(self) -> float:
        """Estimate of the largest error of R.

        It is that of H f', and on a body with a base the noise of the heights in the waves.
        """
        if len(self.inverse) == 0:
            return self._plain.error
        of_heights = height_noise(self.profile) * float(np.sum(self._q * np.abs(self.inverse)))
        return self._plain.error + 2 * of_heights

    @property
    def limit(self) -> str:
        """Cause of that error, in words."""
        return self._plain.limit or "noise of the heights is large in the transform for this body"


@record
class ScaledRelief(sie.Kept):
    """R over the unit of slope, of scaled x; the kinks' places are those of the problem, bit for
    bit.
    """

    relief: Relief
    units: Units
    at: Array
    heights: Array

    @classmethod
    def of(cls, relief: Relief, problem: Problem) -> "ScaledRelief":
        return cls(relief, problem.units, *problem.forcing.kinks)

    @property
    def period(self) -> float:
        return self.relief.period / self.units.length

    @property
    def breakpoints(self) -> Array:
        """Scaled places beside which R is not smooth, of kinks those of the problem."""
        return np.concatenate((self.at, self.units.scaled(self.relief.breakpoints)))

    @property
    def error(self) -> float:
        """That of R."""
        return self.relief.error / self.units.slope

    def without_own(self, kinks: Index) -> Array:
        """R at some of the kinks themselves, less the logarithm of each."""
        at, turns = self.at[kinks], (self.at[kinks, None] - self.at) / self.period
        logs = log_sine(turns - np.round(turns))
        logs[np.arange(len(kinks)), kinks] = 0.0
        return np.asarray(self.smooth(at) + logs @ (self.heights / np.pi))

    @property
    def spacing(self) -> float:
        """The scaled length on which the profile varies."""
        return (self.relief.profile.resolution or self.relief.period / 16) / self.units.length

    @cached_property
    def samples(self) -> tuple[Array, Array]:
        """(even places over a period, closer than the profile varies, R there): the same under all
        loads.
        """
        n = int(np.clip(_CLOSE * self.period / self.spacing, 256, 2**18))
        # Off the borders of the cell and of its halves and thirds, where kinks like to be.
        x = (
            float(self.units.scaled(np.array(self.relief.profile.x0)))
            + self.period * (np.arange(n) + 0.4142) / n
        )
        return x, self(x)

    def smooth(self, x: Array) -> Array:
        """All of R but the logarithms of the kinks."""
        return np.asarray(self.relief.smooth(self.units.x(x)) / self.units.slope)

    def forcing(self, x: Array) -> Array:
        """All of R but (J/pi) times the inverse kernel's potential of the kinks."""
        return np.asarray(self.smooth(x) - self.relief.of_waves(self.units.x(x)) / self.units.slope)

    def __call__(self, x: Array) -> Array:
        return np.asarray(
            self.smooth(x) + logarithms(np.asarray(x), self.at, self.heights, self.period)
        )


def harmonics(profile: Profile, count: int) -> Complex:
    """f_n = (1/l) int f exp(-2 pi i n (x - x0)/l) dx, n = 1 ... count: Gauss-Legendre between
    breakpoints, panels as short as the resolution and as the waves.
    """
    x, turns, weights = over_period(profile, 2 * count)
    heights = np.asarray(profile.height(x), dtype=np.float64)
    return coefficients((heights - heights.min()) * weights, turns, count)


def height_noise(profile: Profile) -> float:
    """Largest noise of the heights of a periodic profile [m], at even places of the period."""
    x = period_samples(profile)
    x = x[:: max(1, len(x) // _LOOKS)]
    step = STEP * (profile.resolution or profile.period or 1.0)
    heights = np.asarray(profile.height(x + step * PLACES[:, None]), dtype=np.float64)
    return float(np.finfo(np.float64).eps) * float(np.abs(heights).max()) + _PEAK * noise(heights)


def period_samples(profile: Profile) -> Array:
    """Even samples of a period, closer than anything varies, as far as the profile tells, and its
    algebraic points.
    """
    length = profile.period
    assert length is not None
    n = int(np.clip(16 * length / (profile.resolution or length / 16), 64, 2**17))
    even = np.asarray(profile.x0 + length * np.arange(n + 1) / n)
    points = np.asarray(profile.algebraic_points)[:, 0]
    return np.union1d(even, points) if len(points) else even
