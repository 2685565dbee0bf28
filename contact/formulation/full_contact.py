r"""Full contact of a periodic profile: p = pbar - (E*/2) R, R_q = q f_q / L(q), possible when the
least of it is not negative.

L is the symbol of the scene's operator (contact.model.operator): a model that declares none has no
full contact that could be told. A valley with a kink makes R (contact.formulation.relief) infinite:
no load brings such a profile into full contact, but soon the gaps over kinks are narrower than
digits tell, and nothing else of the contact differs from a full one.

Surfaces that do not touch are told here too: no pressure, no displacement.
"""

from collections.abc import Callable
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

import sie
from contact.formulation.fields import NoZones, mean_shape
from contact.formulation.problem import Problem
from contact.formulation.relief import Relief, period_samples
from contact.formulation.roots import maximum
from contact.model.laws.base import Law
from contact.model.operator import Operator
from contact.model.profiles.base import Profile
from contact.model.profiles.derive import detail_of
from sie import Array, record

# Half widths of gaps below this part of the period, or of the zone they are in, are a rounding of
# the ends' positions: such gaps are left out, and said so.
NARROWEST = 1e-13


class FullLimit(sie.Kept):
    """Where full contact begins: the smallest mean pressure [Pa], inf if there is none, found when
    first asked for.

    approached: whether growing loads come near to full contact, as they do to valleys with kinks
    but not past sharp corners. told: whether the model tells what the pressure then is. possible:
    whether some load reaches it, and the model tells.
    """

    def __init__(self, profile: Profile, E_star: float, operator: Operator, law: Law) -> None:
        self.profile, self.E_star, self.operator, self.law = profile, E_star, operator, law
        self.approached = operator.is_periodic and profile.support is None
        self.told = self.approached and operator.has_inverse and law.routes.full_contact
        # Where the slope jumps down, no load closes the valley.
        self.possible = self.told and not np.any(profile.kinks[:, 1] < 0)

    @cached_property
    def relief(self) -> Relief:
        return Relief(self.profile, self.operator)

    @property
    def error(self) -> float:
        """What noise of heights and slopes may do to the pressure [Pa]."""
        return 0.5 * self.E_star * self.relief.error

    @cached_property
    def pressure(self) -> float:
        return self.relieved if self.possible else np.inf

    @cached_property
    def relieved(self) -> float:
        """The mean pressure under which the least pressure of full contact is zero [Pa], whether
        contact begins there or not; that of valleys with kinks where a lone gap over each is as
        wide as gaps that are left out.
        """
        relief, samples, kinks = self.relief, period_samples(self.profile), self.profile.kinks
        valleys = np.sort(self.profile.wrap(kinks[kinks[:, 1] < 0, 0]))
        if len(valleys) == 0:
            return 0.5 * self.E_star * maximum(relief, samples)[1]
        around = np.concatenate(
            (valleys[-1:] - relief.period, valleys, valleys[:1] + relief.period)
        )
        # A lone gap is twice as wide as the stretch on which the pressure of full contact would be
        # negative.
        least = NARROWEST * relief.period / 2

        def beside_valleys(x: Array) -> Array:
            x = np.asarray(self.profile.wrap(x))
            nearest = around[np.searchsorted(0.5 * (around[1:] + around[:-1]), x)]
            return relief(np.where(np.abs(x - nearest) < least, nearest + least, x))

        # Between samples a logarithm is as narrow as any.
        return (
            0.5
            * self.E_star
            * max(maximum(beside_valleys, samples)[1], float(beside_valleys(valleys).max()))
        )


def lowest(profile: Profile, cell: tuple[float, float] | None = None) -> float:
    """min f, over the period or, without one, over a window that holds the tip."""
    if profile.summits is not None:
        return float(np.min(profile.height(np.asarray(profile.summits))))
    if profile.period is not None:
        x = period_samples(profile)
    else:
        assert cell is not None
        detail = profile.resolution or detail_of(profile.height, *cell)
        x = np.linspace(*cell, int(np.clip(4 * (cell[1] - cell[0]) / detail, 1025, 2**20)))
    return -maximum(lambda points: -np.asarray(profile.height(points)), x)[1]


@record
class FullFields(NoZones):
    """Full contact of a periodic profile: p = pbar - (E*/2) R; no gap. mean_height: mean f - min f
    [m].
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
    """approach [m], not above zero; None where no approach is held: then they may be anywhere, and
    their gap is infinite.
    """

    problem: Problem
    approach: float | None
    load = max_pressure = contact_fraction = stiffness = 0.0

    def pressure(self, x: ArrayLike) -> Array:
        return np.zeros(np.shape(x))

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
