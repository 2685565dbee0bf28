"""Full contact of a periodic profile: p = pbar - (E*/2) H f', possible when the least of it is not negative.

H f' = (1/L) PV int f'(xi) cot(pi (x - xi)/L) dxi (cos kx -> sin kx, sin kx -> -cos kx). A convex jump of f' makes it -inf
there (infinite pressure), a concave one, a valley with a kink, +inf: no load brings such a profile into full contact.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import fft

from contact.extrema import maximum
from contact.problem import Problem
from contact.profiles.base import Profile

Array = NDArray[np.float64]

_LARGEST = 2**18


def has_kinked_valley(profile: Profile) -> bool:
    """A profile that ends, or whose slope jumps down somewhere, never comes into full contact."""
    kinks = profile.kinks
    return profile.support is not None or bool(len(kinks) and np.any(kinks[:, 1] < 0))


def conjugate_slope(profile: Profile) -> Callable[[Array], Array]:
    """H f' of a periodic profile: its own closed form, or a Fourier series of its samples with kinks taken out."""
    length = profile.period
    assert length is not None
    if profile.slope_conjugate(np.array([profile.x0])) is not None:
        return lambda x: np.asarray(profile.slope_conjugate(x))
    kinks = profile.kinks
    n = 256
    while True:
        x = profile.x0 + length * (np.arange(n) + 0.5) / n
        coefficients = np.asarray(fft.rfft(np.asarray(profile.slope(x)) - _saw(x, kinks, length))) / n
        size = np.abs(coefficients)
        if size[-n // 16 :].max() <= 1e-15 * size.max() or n >= _LARGEST:
            break
        n *= 2
    used = np.flatnonzero(size > 1e-17 * size.max())
    last = int(used[-1]) + 1 if len(used) else 1
    k = np.arange(last)
    series = 2 * coefficients[:last] * np.exp(-1j * np.pi * k / n)
    series[0] = 0.0

    def conjugate(points: ArrayLike) -> Array:
        angle = 2 * np.pi * (np.asarray(points, dtype=float) - profile.x0) / length
        out = np.zeros(angle.size)
        flat = angle.ravel()
        block = max(1, 2_000_000 // last)
        for s in range(0, len(flat), block):
            out[s : s + block] = np.imag(np.exp(1j * np.outer(flat[s : s + block], k)) @ series)
        result = out.reshape(angle.shape)
        with np.errstate(divide="ignore"):
            for at, jump in kinks:
                half = np.pi * (np.asarray(points, dtype=float) - at) / length
                result = result + jump / np.pi * np.log(np.abs(2 * np.sin(half)))
        return np.asarray(result)

    return conjugate


def _saw(x: Array, kinks: Array, length: float) -> Array:
    out = np.zeros(x.shape)
    for at, jump in kinks:
        turns = (x - at) / length
        out += jump * (0.5 - (turns - np.floor(turns)))
    return out


def largest_conjugate(profile: Profile, conjugate: Callable[[Array], Array]) -> float:
    """The maximum of H f' over a period; E*/2 times it is the mean pressure at which full contact is reached."""
    return maximum(conjugate, period_samples(profile))[1]


class FullLimit:
    """Where full contact begins: the smallest mean pressure [Pa], inf if there is none, found when first asked for."""

    def __init__(self, profile: Profile, E_star: float, periodic: bool) -> None:
        self.profile, self.E_star = profile, E_star
        self.possible = periodic and not has_kinked_valley(profile)

    @cached_property
    def conjugate(self) -> Callable[[Array], Array]:
        """H f' of x [m]."""
        return conjugate_slope(self.profile)

    @cached_property
    def pressure(self) -> float:
        if not self.possible:
            return np.inf
        return 0.5 * self.E_star * largest_conjugate(self.profile, self.conjugate)


def period_samples(profile: Profile) -> Array:
    """Even samples of a period, closer than anything varies, as far as the profile tells."""
    length = profile.period
    assert length is not None
    n = int(np.clip(16 * length / (profile.resolution or length / 16), 64, 2**17))
    return np.asarray(profile.x0 + length * np.arange(n + 1) / n)


@dataclass(frozen=True, eq=False)
class FullFields:
    """Full contact of a periodic profile: p = pbar - (E*/2) H f', with H the periodic Hilbert transform; no gap."""

    problem: Problem
    mean_pressure: float
    conjugate: Callable[[Array], Array]
    mean_height: float

    @property
    def approach(self) -> float:
        """mean f - min f, at any load: the displacement has no mean."""
        return self.mean_height

    def pressure(self, x: ArrayLike) -> Array:
        slope = self.conjugate(np.asarray(x, dtype=float))
        return np.asarray(self.mean_pressure - 0.5 * self.problem.units.E_star * slope)

    def gap(self, x: ArrayLike) -> Array:
        return np.zeros(np.shape(x))

    def displacement(self, x: ArrayLike) -> Array:
        height = np.asarray(self.problem.profile.height(x))
        return np.asarray(self.mean_height + self.problem.lowest - height)

    def pressure_at(self, zone: int, t: ArrayLike) -> Array:
        raise IndexError("full contact has no zones: use pressure(x)")

    @property
    def starts(self) -> Array:
        return np.zeros(0)

    @property
    def load(self) -> float:
        assert self.problem.profile.period is not None
        return self.mean_pressure * self.problem.profile.period

    @property
    def loads(self) -> Array:
        return np.zeros(0)

    @cached_property
    def max_pressure(self) -> float:
        profile = self.problem.profile
        return np.inf if len(profile.kinks) else maximum(self.pressure, period_samples(profile))[1]

    @property
    def contact_fraction(self) -> float:
        return 1.0

    @property
    def stiffness(self) -> float:
        return np.inf

    @property
    def mean_gap(self) -> float:
        return 0.0
