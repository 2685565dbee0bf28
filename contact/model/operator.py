"""The elastic operator of a scene: its kernel, what it differs by from a half-plane's, and whether it can be inverted.

Zones are found, and certified, by any model's own kernel. Everything else needs more than a kernel:

    full contact  p_q = -E* q f_q / 2 L(q) + mean       a model of all periods that declares its symbol L
    by the gaps   the slope of the gap as the unknown   such a model with L = 1, the half-plane
    a maximum     u is harmonic below the surface       half-plane sources and nothing else: contact only grows with the load, and a
                                                        flat top is in contact as a whole

A model that declares no symbol has no inverse: neither full contact nor the gap formulation is offered.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

import sie
from contact.model.interactions.base import Interaction
from contact.model.spectrum import excess

Array = NDArray[np.float64]
Potential = Callable[[Array, Array], Array]

# Places over a period at which a kernel is compared with Hilbert's, and what rounding makes of no difference.
_PLACES, _NOTHING = 4096, 1e-13


@dataclass(frozen=True, eq=False)
class Operator(sie.Kept):
    """The operator of an interaction under a period [m] of the solution, None where nothing repeats."""

    interaction: Interaction
    period: float | None

    @property
    def is_periodic(self) -> bool:
        """Whether all periods act, so that harmonics stay harmonics."""
        return self.period is not None and not self.interaction.strip

    @cached_property
    def excess(self) -> Array | None:
        """L_n - 1 of the harmonics of the period, as far as it is not zero; None where no symbol is declared."""
        if not self.is_periodic:
            return None
        assert self.period is not None
        return excess(self.interaction.symbol, self.period)

    @property
    def has_inverse(self) -> bool:
        """Whether the pressure of a given displacement is known: full contact."""
        return self.excess is not None

    @property
    def is_half_plane(self) -> bool:
        """Whether the inverse is that of the half-plane: the gap formulation."""
        return self.excess is not None and len(self.excess) == 0

    def kernel(self, unit: float) -> sie.Kernel:
        """The kernel in scaled lengths; that of all periods with a potential that has no mean, so that u has none."""
        period = None if self.period is None else self.period / unit
        kernel = self.interaction.kernel(period, unit)
        if not self.is_periodic or self.is_half_plane or kernel.regular_potential is None:
            return kernel
        assert period is not None
        return replace(kernel, regular_potential=_Lowered(kernel.regular_potential, _mean_beyond(kernel, period)))

    @cached_property
    def rest(self) -> Callable[[Array], Array] | None:
        """Potential of the lag x - xi [m], less that of half-plane sources; None where there is nothing else, or only a strip."""
        if self.interaction.strip or self.is_half_plane:
            return None
        if self.period is None:
            kernel = self.interaction.kernel(None, 1.0)
            return None if kernel.regular is None else _Rest(kernel)
        kernel = self.kernel(1.0)
        lag = self.period * (np.arange(_PLACES) + 0.5) / _PLACES
        rest = _Rest(kernel, self.period)
        return rest if float(np.abs(rest(lag)).max()) > _NOTHING else None


@dataclass(frozen=True, eq=False)
class _Lowered:
    """A potential less a constant."""

    potential: Potential
    by: float

    def __call__(self, x: Array, xi: Array) -> Array:
        return np.asarray(self.potential(x, xi) - self.by)


@dataclass(frozen=True, eq=False)
class _Rest:
    """The potential of a kernel less the logarithm of its lag; with a period, less all of Hilbert's."""

    kernel: sie.Kernel
    period: float | None = None

    def __call__(self, lag: Array) -> Array:
        if self.period is None:
            return smooth_potential(self.kernel, lag)
        lag = lag - np.round(lag / self.period) * self.period
        return np.asarray(smooth_potential(self.kernel, lag) - smooth_potential(sie.hilbert(self.period), lag))


def smooth_potential(kernel: sie.Kernel, lag: Array) -> Array:
    """Lambda(lag) - ln|lag|, less the constant of the datum where that is one of a lone body."""
    out = np.zeros(np.shape(lag))
    if kernel.period is not None:
        out -= np.log(kernel.datum)
    for pole in kernel.poles[1:]:
        out += np.log(np.abs(lag - pole) / kernel.datum)
    if kernel.regular_potential is not None:
        out += kernel.regular_potential(np.asarray(lag), np.zeros(1))
    return out


def _mean_beyond(kernel: sie.Kernel, period: float) -> float:
    """Mean over a period of a kernel's potential: Hilbert's has none."""
    return float(_Rest(kernel, period)(period * (np.arange(_PLACES) + 0.5) / _PLACES).mean())
