"""What sums over the zones read of a density, whatever it is made of."""

from __future__ import annotations

from typing import Protocol

from sie.basis.arrays import Array, Index, Mask
from sie.basis.interval import OnLine
from sie.basis.kernels import Kernel
from sie.basis.zones import Zones
from sie.fast.panels import Panels
from sie.jumps.forcing import ForcingJumps


class Evaluator(Protocol):
    """Transform and potential at many points (n,) at once."""

    def transform(self, x: Array) -> Array: ...

    def potential(self, x: Array) -> Array: ...


class Series(Protocol):
    """sum_j c_j T_j(t) / sqrt(1 - t^2) and the jumps of the right side, on each zone; see `density.Density` for each member."""

    @property
    def zones(self) -> Zones: ...

    @property
    def kernel(self) -> Kernel: ...

    @property
    def coefficients(self) -> Array: ...

    @property
    def jumps(self) -> ForcingJumps: ...

    @property
    def bounded(self) -> tuple[Array, Array, Array]: ...

    @property
    def potential_coefficients(self) -> Array: ...

    @property
    def sharp_totals(self) -> Array: ...

    def own_transform(self, zone: Index, left: Array, right: Array) -> Array: ...

    def near_potential(self, zone: Index, seen: OnLine) -> Array: ...

    def is_near(self, zone: Index, rho: Array, on: Mask) -> Mask: ...


class Evaluated(Series, Protocol):
    """A series with what has been worked out for sums over all of its zones."""

    @property
    def treecode(self) -> Evaluator | None: ...

    @property
    def has_series(self) -> bool: ...

    @property
    def quadrature(self) -> list[tuple[Array, Array]]: ...

    @property
    def panel_moments(self) -> tuple[Panels, Array] | None: ...

    def into_period(self, x: Array) -> Array: ...
