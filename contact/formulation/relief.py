r"""`Relief`: R, the transform of the slope that gives the pressure of full contact.

In full contact p = pbar - (E*/2) R, with the mean pressure pbar. The Fourier term of R with the
wave number q is R_q = q f_q / L(q), for a periodic profile f on a body of symbol L. On the
half-plane L = 1, and R is the Hilbert transform H f' of the slope (contact.formulation.conjugate).
On other bodies the few harmonics n with L_n = L(q_n) != 1 are corrected: R = H f' + sum_n q_n
(1/L_n - 1) 2 Re f_n exp(i q_n x), with q_n = 2 pi n / l and the period l.

If f' jumps by J at s, R has the logarithm (J/pi) ln|2 sin(pi (x - s)/l)| on any body. R tends to
-inf at a convex kink, where the pressure is infinite, and to +inf at a concave one.
"""

from collections.abc import Callable
from functools import cached_property

import numpy as np

import sie
from contact.formulation.conjugate import OPTIONS, Conjugate, log_sine, logarithms
from contact.formulation.problem import Problem
from contact.formulation.quadrature import over_period
from contact.formulation.units import Units
from contact.model.operator import Operator
from contact.model.profiles.base import Profile
from contact.model.profiles.derive import DETAIL
from contact.model.profiles.noise import noise_at
from contact.model.profiles.trigonometric import Sum, coefficients
from sie import Array, Complex, Index, record


@record
class Relief(Conjugate):
    """The relief R(x) of a periodic profile: in full contact, p = mean pressure - (E*/2) R(x).

    The place x is in metres. `kinks` (k, 2) are those of the profile, `breakpoints` its other
    breakpoints.
    """

    operator: Operator
    # Factor by which the logarithmic terms of the kinks enter the relief R.
    kink_factor = 1.0

    @cached_property
    def smooth(self) -> Callable[[Array], Array]:
        """The relief R minus the logarithmic terms of the kinks (jumps of the slope)."""
        conjugate, waves = self._plain.smooth, self._sum
        return (
            conjugate if waves is None else lambda x: np.asarray(conjugate(x) + self._at(x, waves))
        )

    @cached_property
    def _plain(self) -> Conjugate:
        """The Hilbert transform H f' of the slope; on a half-plane it is the whole relief R."""
        return Conjugate(self.profile)

    def of_waves(self, x: Array) -> Array:
        """Contribution of the kinks to the relief R, minus their contribution on a half-plane.
        On a half-plane, the symbol L_n of every harmonic n is 1.

        It is the sum over all kinks of (J/pi) times the smooth part of the inverse kernel's
        potential, with J the jump of the slope.
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
        """Factors 1 / L_n - 1 of all harmonics n of the period, with the operator's symbol L_n."""
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
        """Estimate of the largest error of the relief R.

        It is the error of H f', plus the noise of the heights in the corrected waves.
        """
        if len(self.inverse) == 0:
            return self._plain.error
        of_heights = height_noise(self.profile) * float(np.sum(self._q * np.abs(self.inverse)))
        return self._plain.error + 2 * of_heights

    @property
    def limit(self) -> str:
        """Main cause of the error of the relief R, as text for messages."""
        return self._plain.limit or "noise of the heights causes large errors for this substrate"


@record
class ScaledRelief(sie.Kept):
    """The relief R divided by the unit of slope, as a function of scaled x.

    The places of the kinks equal those of the problem bit for bit.
    """

    relief: Relief
    units: Units
    at: Array
    heights: Array

    @classmethod
    def of(cls, relief: Relief, problem: Problem) -> "ScaledRelief":
        at, heights = problem.forcing.kinks
        return cls(relief, problem.units, at, heights * relief.kink_factor)

    @property
    def period(self) -> float:
        return self.relief.period / self.units.length

    @property
    def breakpoints(self) -> Array:
        """Scaled places where the relief R is not smooth: kinks and other breakpoints."""
        return np.concatenate((self.at, self.units.scaled(self.relief.breakpoints)))

    @property
    def error(self) -> float:
        """Estimate of the largest error of the relief R, divided by the unit of slope."""
        return self.relief.error / self.units.slope

    def without_own(self, kinks: Index) -> Array:
        """The scaled relief R at each given kink, without the logarithm of that kink itself."""
        at, turns = self.at[kinks], (self.at[kinks, None] - self.at) / self.period
        logs = log_sine(turns - np.round(turns))
        logs[np.arange(len(kinks)), kinks] = 0.0
        return np.asarray(self.smooth(at) + logs @ (self.heights / np.pi))

    @property
    def spacing(self) -> float:
        """Smallest scaled length over which the profile varies."""
        return (self.relief.profile.resolution or self.relief.period / 16) / self.units.length

    @cached_property
    def samples(self) -> tuple[Array, Array]:
        """Evenly spaced places over a period, and the relief R at these places.
        Both are computed once for all loads.

        The spacing of the places is smaller than the length on which the profile varies.
        """
        n = int(
            np.clip(
                DETAIL.samples_per_length * self.period / self.spacing,
                DETAIL.min_samples,
                OPTIONS.max_samples,
            )
        )
        # The offset 0.4142 keeps the samples off simple fractions of the period, where kinks often
        # lie.
        x = (
            float(self.units.scaled(np.array(self.relief.profile.x0)))
            + self.period * (np.arange(n) + 0.4142) / n
        )
        return x, self(x)

    def smooth(self, x: Array) -> Array:
        """The scaled relief R without the logarithmic terms of the kinks (`logarithms`)."""
        return np.asarray(self.relief.smooth(self.units.x(x)) / self.units.slope)

    def forcing(self, x: Array) -> Array:
        """The scaled relief R minus the whole contribution of the kinks.
        This contribution is the kinks' logarithmic terms plus `of_waves`.

        For a kink where the slope jumps by J, it is J/pi times the inverse kernel's potential.
        """
        return np.asarray(self.smooth(x) - self.relief.of_waves(self.units.x(x)) / self.units.slope)

    def __call__(self, x: Array) -> Array:
        return np.asarray(
            self.smooth(x) + logarithms(np.asarray(x), self.at, self.heights, self.period)
        )


def harmonics(profile: Profile, count: int) -> Complex:
    """Fourier coefficients f_n of the height of a profile, n = 1 ... count.

    f_n = (1/l) int f exp(-2 pi i n (x - x0)/l) dx, with the height f and the period l.

    The integral is computed by Gauss's rule on panels between breakpoints. The number of panels
    follows from the profile's resolution and from the shortest wave.
    """
    x, turns, weights = over_period(profile, 2 * count)
    heights = np.asarray(profile.height(x), dtype=np.float64)
    return coefficients((heights - heights.min()) * weights, turns, count)


def height_noise(profile: Profile) -> float:
    """Largest noise in the heights of a periodic profile [m]."""
    x = period_samples(profile)
    x = x[:: max(1, len(x) // DETAIL.min_samples)]
    return noise_at(profile.height, x, profile.resolution or profile.period or 1.0)


def period_samples(profile: Profile) -> Array:
    """Sample places over a period, including the algebraic points of the profile.

    The other places are evenly spaced, and dense enough to resolve the profile.
    """
    length = profile.period
    assert length is not None
    n = int(
        np.clip(
            DETAIL.samples_per_length * length / (profile.resolution or length / 16),
            DETAIL.min_samples,
            OPTIONS.max_samples,
        )
    )
    even = np.asarray(profile.x0 + length * np.arange(n + 1) / n)
    points = np.asarray(profile.algebraic_points)[:, 0]
    return np.union1d(even, points) if len(points) else even
