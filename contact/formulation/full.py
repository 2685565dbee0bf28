r"""Full contact of a periodic profile: p = pbar - (E*/2) R, R_q = q f_q / L(q), possible when the least of it is not negative.

L is the symbol of the scene's operator (contact.model.operator): a model that declares none has no full contact that could be told. For the
half-plane L = 1 and R = H f' = (1/l) PV int f'(xi) cot(pi (x - xi)/l) dxi (cos kx -> sin kx, sin kx -> -cos kx); for others the
few waves with L_n != 1 are put right, R = H f' + sum_n q_n (1/L_n - 1) 2 Re f_n exp(i q_n x). A convex jump of f' makes R -inf
there (infinite pressure), a concave one, a valley with a kink, +inf: no load brings such a profile into full contact.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

import sie
from contact.formulation.conjugate import Conjugate, conjugate_of
from contact.formulation.maxima import maximum
from contact.formulation.problem import Problem
from contact.model.laws.base import Law
from contact.model.operator import Operator
from contact.model.profiles.base import Profile
from contact.model.profiles.trigonometric import Sum

Array = NDArray[np.float64]


def has_kinked_valley(profile: Profile) -> bool:
    """A profile whose slope jumps down somewhere never comes into full contact."""
    kinks = profile.kinks
    return bool(len(kinks) and np.any(kinks[:, 1] < 0))


class FullLimit(sie.Kept):
    """Where full contact begins: the smallest mean pressure [Pa], inf if there is none, found when first asked for.

    approached: whether growing loads come near to full contact, as they do to valleys with kinks but not past sharp corners.
    possible: whether some load reaches it, and the model tells what the pressure then is.
    """

    def __init__(self, profile: Profile, E_star: float, operator: Operator, law: Law) -> None:
        self.profile, self.E_star, self.operator, self.law = profile, E_star, operator, law
        self.approached = operator.is_periodic and profile.support is None
        self.possible = self.approached and operator.has_inverse and law.full_contact and not has_kinked_valley(profile)

    @cached_property
    def conjugate(self) -> Conjugate:
        """H f' of x [m]."""
        return conjugate_of(self.profile)

    @cached_property
    def waves(self) -> Array:
        """q_n (1/L_n - 1) f_n, complex, of the waves in which the body differs from a half-plane; none for this itself."""
        excess, period = self.operator.excess, self.profile.period
        assert excess is not None and period is not None
        if len(excess) == 0:
            return np.zeros(0, dtype=np.complex128)
        q = 2 * np.pi / period * np.arange(1, len(excess) + 1)
        return np.asarray(-q * excess / (1 + excess) * harmonics(self.profile, len(excess)))

    def relief(self, x: ArrayLike) -> Array:
        """R of x [m]."""
        x = np.asarray(x, dtype=np.float64)
        out = self.conjugate(x)
        if len(self.waves):
            assert self.profile.period is not None
            turns = np.asarray((self.profile.wrap(x) - self.profile.x0) / self.profile.period)
            out = out + self._sum(turns.ravel()).reshape(x.shape)
        return out

    @cached_property
    def _sum(self) -> Sum:
        return Sum.of(np.asarray(2 * self.waves, dtype=np.complex128))

    @cached_property
    def rounding(self) -> float:
        """What rounding of the heights may do to the pressure through the waves [Pa]."""
        excess, period = self.operator.excess, self.profile.period
        assert excess is not None and period is not None
        q = 2 * np.pi / period * np.arange(1, len(excess) + 1)
        height = float(np.ptp(np.asarray(self.profile.height(period_samples(self.profile)))))
        return self.E_star * float(np.finfo(np.float64).eps) * height * float(np.sum(q * np.abs(excess) / (1 + excess)))

    @cached_property
    def pressure(self) -> float:
        return self.relieved if self.possible else np.inf

    @cached_property
    def relieved(self) -> float:
        """The mean pressure under which the least pressure of full contact is zero [Pa], whether contact begins there or not."""
        return 0.5 * self.E_star * maximum(self.relief, period_samples(self.profile))[1]


def harmonics(profile: Profile, count: int) -> NDArray[np.complex128]:
    """f_n = (1/l) int f exp(-2 pi i n (x - x0)/l) dx, n = 1 ... count: Gauss-Legendre between breakpoints, panels as short as the
    resolution and as the waves."""
    length = profile.period
    assert length is not None
    panels = int(np.clip(np.ceil(2 * length / (profile.resolution or length / 8)), max(8, 2 * count), 2**16))
    inner = (np.asarray(profile.breakpoints) - profile.x0) / length
    cuts = np.unique(np.concatenate((np.arange(panels + 1) / panels, inner[(inner > 0) & (inner < 1)])))
    t, weights = np.polynomial.legendre.leggauss(12)
    half, middle = 0.5 * np.diff(cuts), 0.5 * (cuts[1:] + cuts[:-1])
    turns = (middle[:, None] + half[:, None] * t).ravel()
    heights = np.asarray(profile.height(profile.x0 + length * turns), dtype=np.float64)
    heights = (heights - heights.min()) * (half[:, None] * weights).ravel()
    step = np.exp(-2j * np.pi * turns)
    wave, out = np.ones_like(step), np.zeros(count, dtype=np.complex128)
    for n in range(count):
        # Powers of the first wave, begun anew now and then so that rounding does not add up.
        wave = np.exp(-2j * np.pi * ((n + 1) * turns % 1.0)) if n % 16 == 0 else wave * step
        out[n] = heights @ wave
    return out


def period_samples(profile: Profile) -> Array:
    """Even samples of a period, closer than anything varies, as far as the profile tells."""
    length = profile.period
    assert length is not None
    n = int(np.clip(16 * length / (profile.resolution or length / 16), 64, 2**17))
    return np.asarray(profile.x0 + length * np.arange(n + 1) / n)


def lowest(profile: Profile, cell: tuple[float, float] | None = None) -> float:
    """min f, over the period or, without one, over a window that holds the tip."""
    if profile.summits is not None:
        return float(np.min(profile.height(np.asarray(profile.summits))))
    if profile.period is not None:
        x = period_samples(profile)
    else:
        assert cell is not None
        per_feature = 0.0 if profile.resolution is None else 4 * (cell[1] - cell[0]) / profile.resolution
        x = np.linspace(*cell, int(np.clip(per_feature, 1025, 2**20)))
    return -maximum(lambda points: -np.asarray(profile.height(points)), x)[1]


@dataclass(frozen=True, eq=False)
class FullFields(sie.Kept):
    """Full contact of a periodic profile: p = pbar - (E*/2) R; no gap. mean_height: mean f - min f [m]."""

    problem: Problem
    mean_pressure: float
    relief: Callable[[Array], Array]
    mean_height: float

    @property
    def approach(self) -> float:
        """mean f - min f and the mean displacement, which only a body with a base has."""
        return self.mean_height + self._compressed * self.mean_pressure

    @property
    def _compressed(self) -> float:
        """Mean displacement of a unit of mean pressure [m/Pa]."""
        return 2 * (self.problem.operator.compression or 0.0) / self.problem.units.E_star

    def pressure(self, x: ArrayLike) -> Array:
        slope = self.relief(np.asarray(x, dtype=float))
        return np.asarray(self.mean_pressure - 0.5 * self.problem.units.E_star * slope)

    def gap(self, x: ArrayLike) -> Array:
        return np.zeros(np.shape(x))

    def displacement(self, x: ArrayLike) -> Array:
        height = np.asarray(self.problem.profile.height(x))
        return np.asarray(self.approach + self.problem.lowest - height)

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
        assert self.problem.profile.period is not None
        return self.problem.profile.period / self._compressed if self._compressed else np.inf

    @property
    def mean_gap(self) -> float:
        return 0.0

    @property
    def widening_rate(self) -> float:
        return 0.0
