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

from contact.conjugate import Conjugate, conjugate_of
from contact.extrema import maximum
from contact.problem import Problem
from contact.profiles.base import Profile

Array = NDArray[np.float64]


def has_kinked_valley(profile: Profile) -> bool:
    """A profile whose slope jumps down somewhere never comes into full contact."""
    kinks = profile.kinks
    return bool(len(kinks) and np.any(kinks[:, 1] < 0))


def largest_conjugate(profile: Profile, conjugate: Callable[[Array], Array]) -> float:
    """The maximum of H f' over a period; E*/2 times it is the mean pressure at which full contact is reached."""
    return maximum(conjugate, period_samples(profile))[1]


class FullLimit:
    """Where full contact begins: the smallest mean pressure [Pa], inf if there is none, found when first asked for.

    approached: whether growing loads come near to full contact, as they do to valleys with kinks but not past sharp corners.
    """

    def __init__(self, profile: Profile, E_star: float, periodic: bool) -> None:
        self.profile, self.E_star = profile, E_star
        self.approached = periodic and profile.support is None
        self.possible = self.approached and not has_kinked_valley(profile)

    @cached_property
    def conjugate(self) -> Conjugate:
        """H f' of x [m]."""
        return conjugate_of(self.profile)

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

    @property
    def widening_rate(self) -> float:
        return 0.0
