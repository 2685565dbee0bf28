"""States under a cohesive law: intervals of tension with the contact inside them."""

from functools import cached_property

import numpy as np

from contact.adhesion.cohesive_rates import EndRates
from contact.adhesion.curve import State
from contact.adhesion.inner_signs import sampled_gap
from contact.formulation.fields import ZoneFields
from sie import Array, record


@record
class CohesiveState(State):
    """A state under a cohesive law: the intervals of tension and the contact inside them.

    table: the intervals I (empty if the tension acts everywhere); zones: the contact (n, 2); q: the
    fields of the contact, None without contact; by_ends, level_rates: derivatives of the 2n ends of
    the zones and of the level (minus the approach), with respect to the ends of I and, in the last
    column, to the value of the control; seen: the sampled gap, None if it was not sampled.
    """

    zones: Array
    q: ZoneFields | None
    by_ends: Array
    level_rates: Array
    seen: tuple[Array, Array] | None
    everywhere: bool = False

    @classmethod
    def under_all(
        cls,
        value: float,
        load: float,
        level: float,
        zones: Array,
        q: ZoneFields | None,
        seen: tuple[Array, Array],
    ) -> "CohesiveState":
        """A state under tension on the whole period, where the tension has no ends."""
        none, still = np.zeros(0), np.zeros((2 * len(zones), 1))
        return cls(
            np.zeros((0, 2)),
            value,
            none,
            np.zeros((0, 0)),
            none,
            load,
            level,
            zones,
            q,
            still,
            np.array([-1.0]),
            seen,
            True,
        )

    @property
    def all_rates(self) -> EndRates:
        """The rates of the state, as if no end were pinned at a sharp corner."""
        return EndRates(self.whole.rates, self.whole.by_value, self.by_ends, self.level_rates)

    @cached_property
    def gap_samples(self) -> tuple[Array, Array]:
        """(ascending sample points outside the contact, gap at these points)."""
        if self.seen is not None:
            return self.seen
        assert self.q is not None
        return sampled_gap(self.q)

    @property
    def rate(self) -> float:
        """Derivative d load / d approach along the curve, for a state under fixed load."""
        ends = np.linalg.solve(-self.rates, self.by_value)
        return float(-1.0 / (self.level_rates[-1] + self.level_rates[:-1] @ ends))

    @property
    def contact(self) -> Array:
        return self.zones

    @property
    def gains(self) -> Array:
        """Factors (2n,) that turn rates of the residuals into second derivatives of the energy: 1.
        The residuals are already proportional to the first derivatives of the energy with respect
        to the ends.
        """
        return np.ones(len(self.residual))


@record
class PastState:
    """Data of an earlier state from which the solution of other states starts.

    table: the intervals of tension. value: the value of the control. by_ends: derivatives of the
    ends of the zones with respect to the ends of the intervals and to the control.
    """

    table: Array
    value: float
    zones: Array
    by_ends: Array


@record
class StateOutline(State):
    """A state given only by its intervals, zones (n, 2), load and level (minus the approach)."""

    zones: Array

    @classmethod
    def of(
        cls, table: Array, value: float, load: float, level: float, zones: Array
    ) -> "StateOutline":
        none = np.zeros(0)
        return cls(
            table, float(value), none, np.zeros((0, 0)), none, float(load), float(level), zones
        )

    @property
    def contact(self) -> Array:
        return self.zones
