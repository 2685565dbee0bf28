r"""Full contact of a periodic profile, its onset, and surfaces that do not touch.

The pressure is p = pbar - (E*/2) R, with the mean pressure pbar and the relief R of the profile f.
The Fourier terms of R are R_q = q f_q / L(q), with L the symbol of the operator
(contact.formulation.relief). Full contact is possible if p is nowhere negative. For a model without
a symbol, R is unknown. A concave kink makes R infinite, so that no load closes the gap over it. As
the load grows, that gap becomes narrower than numbers resolve. The rest of the contact is then as
in full contact.
"""

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import sie
from contact.extras import require
from contact.formulation.fields import NoZones, mean_shape
from contact.formulation.problem import MISMATCH, Problem
from contact.formulation.relief import Relief, period_samples
from contact.formulation.roots import maximum
from contact.formulation.tolerances import TOLERANCES
from contact.model.laws.base import Law
from contact.model.operator import Operator
from contact.model.profiles.base import Profile
from contact.model.profiles.derive import detail_of
from sie import Array, Complex, record


class FullLimit(sie.Kept):
    """Onset of full contact of a periodic profile under growing load.
    `pressure`: mean pressure [Pa] at the onset, inf without an onset.

    approached: whether contact under growing loads tends to full contact; it does over concave
    kinks, but not between sharp corners. is_known: whether the model gives the pressure of full
    contact. possible: whether `is_known` holds and some load reaches full contact.
    """

    def __init__(self, profile: Profile, E_star: float, operator: Operator, law: Law) -> None:
        self.profile, self.E_star, self.operator, self.law = profile, E_star, operator, law
        self.approached = operator.is_periodic and profile.support is None
        self.is_known = self.approached and operator.has_inverse and law.routes.full_contact
        # No load closes the gap at a concave kink, where the slope f' jumps down.
        self.possible = self.is_known and not np.any(profile.kinks[:, 1] < 0)

    @cached_property
    def relief(self) -> Relief:
        if self.law.kappa:
            sliding: Relief = require(MISMATCH).SlidingRelief(
                self.profile, self.operator, self.law.kappa
            )
            return sliding
        return Relief(self.profile, self.operator)

    @property
    def error(self) -> float:
        """Error of the onset's mean pressure [Pa], due to the error of the slope's transform R."""
        return 0.5 * self.E_star * self.relief.error

    @cached_property
    def pressure(self) -> float:
        return self.onset_pressure if self.possible else np.inf

    @cached_property
    def onset_pressure(self) -> float:
        """Mean pressure [Pa] at which the lowest local pressure in full contact is zero.

        With concave kinks, it is the mean pressure at which a single gap at a kink is as narrow as
        `narrowest_gap` allows.
        """
        relief, samples, kinks = self.relief, period_samples(self.profile), self.profile.kinks
        valleys = np.sort(self.profile.wrap(kinks[kinks[:, 1] < 0, 0]))
        if len(valleys) == 0:
            return 0.5 * self.E_star * maximum(relief, samples)[1]
        around = np.concatenate(
            (valleys[-1:] - relief.period, valleys, valleys[:1] + relief.period)
        )
        # At the onset, the pressure of full contact is negative up to the distance `least` on each
        # side of a concave kink. The gap of the solution is then 4 `least` wide.
        least = TOLERANCES.narrowest_gap * relief.period / 2

        def beside_valleys(x: Array) -> Array:
            x = np.asarray(self.profile.wrap(x))
            nearest = around[np.searchsorted(0.5 * (around[1:] + around[:-1]), x)]
            return relief(np.where(np.abs(x - nearest) < least, nearest + least, x))

        # At a concave kink, the transform R of the slope (`relief`) has an infinitely narrow peak,
        # which the samples may miss.
        return (
            0.5
            * self.E_star
            * max(maximum(beside_valleys, samples)[1], float(beside_valleys(valleys).max()))
        )


def lowest(profile: Profile, cell: tuple[float, float] | None = None) -> float:
    """Lowest height of the profile.

    cell: an interval that contains the lowest place. It is needed if the profile has neither
    summits nor a period.
    """
    if profile.summits is not None:
        return float(np.min(profile.height(np.asarray(profile.summits))))
    if profile.period is not None:
        x = period_samples(profile)
    else:
        assert cell is not None
        detail = profile.resolution or detail_of(profile.height, *cell)
        x = np.linspace(*cell, int(np.clip(4 * (cell[1] - cell[0]) / detail, 1025, 2**20)))
    at, highest = maximum(lambda points: -np.asarray(profile.height(points)), x)
    # `maximum` interpolates by a parabola, which is wrong at a tip.
    kinks = profile.kinks[:, 0]
    tips = np.asarray(profile.height(kinks[(kinks >= x[0]) & (kinks <= x[-1])]))
    tip = float(tips.min(initial=np.inf))
    return tip if tip <= float(profile.height(np.array(at))) else -highest


@record
class FullFields(NoZones):
    """Fields of a periodic profile in full contact, without a gap.

    The pressure is p = pbar - (E*/2) R, with the mean pressure pbar and the relief R.

    mean_height: mean f - min f [m].
    """

    problem: Problem
    mean_pressure: float
    relief: Callable[[Array], Array]
    mean_height: float
    contact_fraction, mean_gap = 1.0, 0.0

    @property
    def levels(self) -> Array:  # type: ignore[override]
        return np.array([-self.approach / self.problem.units.height])

    @property
    def approach(self) -> float:
        """Approach [m]: mean height above the lowest place, plus the mean displacement.

        The mean displacement is 0 for a body without a base.
        """
        return self.mean_height + self._compressed * self.mean_pressure

    @property
    def _compressed(self) -> float:
        """Mean displacement divided by the mean pressure [m/Pa]."""
        return 2 * (self.problem.operator.compression or 0.0) / self.problem.units.E_star

    def pressure(self, x: ArrayLike) -> Array:
        slope = self.relief(np.asarray(x, dtype=float))
        return np.asarray(self.mean_pressure - 0.5 * self.problem.units.E_star * slope)

    def pressure_transform(self, x: Array, y: Array) -> tuple[Complex, Complex]:
        # On the surface, the pressure is p = Re(`mean_pressure` - `half` * `value`), with `value`
        # the transform of the profile's slope. The returned transform F of p has Im F = -p there.
        value, slope = self._slope_inside(x, y)
        half = 0.5 * self.problem.units.E_star * self.problem.skew
        return -1j * (self.mean_pressure - half * value), 1j * half * slope

    @cached_property
    def _slope_inside(self) -> Any:
        """The transform of the profile's slope in the half plane (`ContinuedSlope`)."""
        return require("contact.formulation.continued").ContinuedSlope(self.problem.profile)

    @property
    def deep_pressure(self) -> float:
        return self.mean_pressure

    def gap(self, x: ArrayLike) -> Array:
        return np.zeros(np.shape(x))

    def displacement(self, x: ArrayLike) -> Array:
        height = np.asarray(self.problem.profile.height(x))
        return np.asarray(self.approach + self.problem.lowest - height)

    @property
    def load(self) -> float:
        assert self.problem.profile.period is not None
        return self.mean_pressure * self.problem.profile.period

    @cached_property
    def max_pressure(self) -> float:
        profile = self.problem.profile
        return np.inf if len(profile.kinks) else maximum(self.pressure, period_samples(profile))[1]

    @property
    def stiffness(self) -> float:
        assert self.problem.profile.period is not None
        return self.problem.profile.period / self._compressed if self._compressed else np.inf


@record
class ApartFields(NoZones):
    """Fields of surfaces that do not touch, at an approach [m] that is zero or negative.

    The approach is None if it is not given: then the distance is unknown, and the gap is infinite.
    """

    problem: Problem
    approach: float | None
    load = max_pressure = contact_fraction = stiffness = deep_pressure = 0.0

    def pressure(self, x: ArrayLike) -> Array:
        return np.zeros(np.shape(x))

    def pressure_transform(self, x: Array, y: Array) -> tuple[Complex, Complex]:
        zero = np.zeros(x.shape, dtype=complex)
        return zero, zero

    def displacement(self, x: ArrayLike) -> Array:
        return np.zeros(np.shape(x))

    def gap(self, x: ArrayLike) -> Array:
        if self.approach is None:
            return np.full(np.shape(x), np.inf)
        return np.asarray(
            self.problem.profile.height(np.asarray(x, dtype=float))
            - self.problem.lowest
            - self.approach
        )

    @property
    def mean_gap(self) -> float:
        if self.approach is None:
            return np.inf
        return mean_shape(self.problem) * self.problem.units.height - self.approach
