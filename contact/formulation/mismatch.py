r"""Sliding of elastically different bodies: what kappa adds to the equations of a contact.

In scaled variables, with p the pressure, T p its transform with the kernel, P its total, g the
scaled slope of the profile, L the period and lambda = kappa P / L,

    T p + kappa p = g + lambda    on the zones (lambda = 0 without a period).

With V the potential of p and Q(x) the integral of p up to x, the surface is displaced by

    u = -V + lambda x - kappa Q + c.

The constant c makes the mean of u zero over a period: c = kappa P / 2 - kappa M / L, with the
moment M of p about x = 0. Without a period M / L is left out. Then the shear part c - kappa Q of u
has opposite values on both sides of the contact, so that the datum of u keeps its meaning.

On the gaps of a periodic contact the slope s of the gap obeys

    T s - kappa s = (1 + kappa^2) (R - mean p),    R = (H f' - kappa f') / (1 + kappa^2),

and the pressure of the zones is p = mean p - R + T s / (1 + kappa^2). H is the Hilbert transform.
On the whole period, H p + kappa (p - mean p) = f' - s. Apply the operator kappa - H to this
equation: both equations for the gaps follow.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

import sie
from contact.formulation.problem import Problem
from contact.formulation.relief import Relief, ScaledRelief
from sie import Array, record


def _same(x: Array) -> Array:
    return np.asarray(x, dtype=float)


# Term of the right side with the unknown amplitude lambda: the constant 1, with the primitive x.
MEAN = sie.Forcing(np.ones_like, _same, resolution=sie.Resolution(modes=1))


def shift(kappa: float, period: float | None, total: float, moment: float) -> float:
    """The constant c of the displacement u, from load P = `total` and moment M = `moment`."""
    return kappa * (0.5 * total - (0.0 if period is None else moment / period))


@dataclass(frozen=True)
class MeanLevel(sie.Condition):
    """The condition that the level of every zone is `value`, which is minus the approach.

    The level is V - F - lambda x + kappa Q (as in `sie.Level`) minus the constant c. The head of
    this module has the symbols; F is the scaled profile.
    """

    value: float
    kappa: float
    period: float | None
    levels = True

    def count(self, zones: sie.Zones) -> int:
        return len(zones.solved)

    def rows(self, system: sie.Rows) -> tuple[Array, Array, Array]:
        matrix, constants = system.levels()
        totals, known = system.totals()
        matrix = matrix - 0.5 * self.kappa * totals.sum(axis=0)
        constants = constants - 0.5 * self.kappa * known.sum()
        if self.period is not None:
            moments, known = system.integrals(_same, 1)
            matrix = matrix + self.kappa / self.period * moments.sum(axis=0)
            constants = constants + self.kappa / self.period * known.sum()
        return matrix, constants, np.full(len(constants), self.value)


@record
class SlidingRelief(Relief):
    """The relief R for sliding bodies (kappa): in full contact p = mean pressure - (E*/2) R."""

    kappa: float

    @property
    def kink_factor(self) -> float:  # type: ignore[override]
        return 1 / (1 + self.kappa**2)

    @cached_property
    def kinks(self) -> Array:  # type: ignore[override]
        """Places of the profile's kinks, and the factors of their logarithms in R (k, 2)."""
        return np.asarray(self._plain.kinks * [1.0, self.kink_factor])

    @property
    def error(self) -> float:  # type: ignore[override]
        return (1 + abs(self.kappa)) * self.kink_factor * self._plain.error

    @cached_property
    def smooth(self) -> Callable[[Array], Array]:  # type: ignore[override]
        """The relief R minus the logarithms of the kinks; this function jumps at the kinks."""
        conjugate, slope = self._plain.smooth, self.profile.slope

        def value(x: Array) -> Array:
            skew = self.kappa * np.asarray(slope(self.profile.wrap(x)))
            return np.asarray(self.kink_factor * (conjugate(x) - skew))

        return value


def gap_equation(
    problem: Problem,
    relief: ScaledRelief,
    conditions: tuple[sie.Condition, ...],
    ends: tuple[sie.TotalWidth, ...],
) -> sie.Equation:
    """Integral equation for the slope of the gap; its unknown amplitude is the mean pressure."""
    kappa = problem.kappa
    factor = 1 + kappa**2
    tips = sie.Jumps(singular_at=problem.forcing.kinks[0])
    right = sie.Forcing(lambda x: factor * relief(x), jumps=tips)
    mean = sie.Forcing(lambda x: np.full(np.shape(x), -factor), resolution=sie.Resolution(modes=1))
    return sie.Equation(problem.inverse_kernel, right, conditions, (mean,), ends, -kappa)
