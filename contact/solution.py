"""The solution of a scene: zones, fields and numbers in SI units, with its error, certificate and plan."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact import export
from contact.certificate import Certificate
from contact.extrema import maximum
from contact.fields import FullFields, ZoneFields
from contact.full import period_samples
from contact.planning import Plan
from contact.scene import Scene

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Solution:
    """Zones (n, 2) [m], pressure and gap anywhere, loads per unit thickness [N/m]; see the properties.

    error: stated bound of (i) the pressure's error at equal normalised position in corresponding zones over the peak pressure
    (over the mean contact pressure where the peak is infinite), and (ii) each end's error over its zone's width.
    """

    scene: Scene
    zones: Array
    fields: ZoneFields | FullFields = field(repr=False)
    error: float
    certificate: Certificate = field(repr=False)
    plan: Plan = field(repr=False)
    trace: tuple[Any, ...] = field(default=(), repr=False)

    # fields -----------------------------------------------------------------------------------------------------------
    def pressure(self, x: ArrayLike) -> Array:
        """Contact pressure [Pa] at x [m], any shape; 0 outside the zones."""
        return self.fields.pressure(x)

    def pressure_at(self, t: ArrayLike, zone: int = 0) -> Array:
        """Contact pressure [Pa] at normalised positions t in [-1, 1] of one zone, without loss of digits at its ends."""
        assert isinstance(self.fields, ZoneFields)
        density = self.fields.density
        order = self._order
        return density.at_t(order[zone], t) * self.fields.problem.units.pressure

    def gap(self, x: ArrayLike) -> Array:
        """Gap [m] at x [m], any shape; 0 inside the zones, inf where there is no profile."""
        return self.fields.gap(x)

    def displacement(self, x: ArrayLike) -> Array:
        """Displacement into the body [m]; for an isolated punch without a datum, less the approach."""
        return self.fields.displacement(x)

    # numbers ----------------------------------------------------------------------------------------------------------
    @property
    def _contact(self) -> ZoneFields | None:
        return self.fields if isinstance(self.fields, ZoneFields) else None

    @cached_property
    def _order(self) -> NDArray[np.intp]:
        """Solved zone that stands at each place of `zones`."""
        contact = self._contact
        if contact is None:
            return np.zeros(0, dtype=np.intp)
        a = contact.problem.units.x(contact.density.zones.a)
        period = self.scene.period
        if period is None:
            return np.argsort(a)
        x0 = self.scene.profile.x0
        return np.argsort(a - np.floor((a - x0) / period) * period)

    @cached_property
    def load(self) -> float:
        """Load [N/m], per period where there is one."""
        if self._contact is None:
            assert isinstance(self.fields, FullFields) and self.scene.period is not None
            return self.fields.mean_pressure * self.scene.period
        return self._contact.density.total * self._contact.problem.units.load

    @property
    def mean_pressure(self) -> float | None:
        """Load per period over the period [Pa]; None without a period."""
        period = self.scene.profile.period
        return None if period is None else self.load / period

    @cached_property
    def zone_loads(self) -> Array:
        """Load of each zone (n,) [N/m]."""
        contact = self._contact
        if contact is None:
            return np.zeros(0)
        return np.asarray(contact.density.totals[self._order] * contact.problem.units.load)

    @property
    def zone_widths(self) -> Array:
        """Width of each zone (n,) [m]."""
        return np.asarray(self.zones[:, 1] - self.zones[:, 0])

    @cached_property
    def max_pressure(self) -> float:
        """Highest pressure [Pa]; inf under a sharp corner or a tip with a kink."""
        if self._contact is None:
            if len(self.scene.profile.kinks):
                return np.inf
            return maximum(self.fields.pressure, period_samples(self.scene.profile))[1]
        contact = self._contact
        density = contact.density
        if any(end.intensity is None for end in (*density.zones.left, *density.zones.right)):
            left, right = density.intensities
            if max(left.max(), right.max()) > 1e-12 * np.abs(density.coefficients).max():
                return np.inf
        if np.any((density.steps.height > 0) & (density.steps.order == 0)):
            return np.inf
        peak, zone = -np.inf, 0
        counts = density.sampling
        for n in np.unique(counts):
            group = np.flatnonzero(counts == n)
            theta = (np.arange(n) + 0.5) * np.pi / n
            values = density.at(group[:, None], 2 * np.cos(theta / 2) ** 2, 2 * np.sin(theta / 2) ** 2)
            highest = values.max(axis=1)
            if highest.max() > peak:
                peak, zone = float(highest.max()), int(group[np.argmax(highest)])
        theta = np.linspace(0, np.pi, int(counts[zone]) + 1)

        def pressure(angle: Array) -> Array:
            return density.at(zone, 2 * np.cos(angle / 2) ** 2, 2 * np.sin(angle / 2) ** 2)

        return maximum(pressure, theta, levels=7, peaks=1)[1] * contact.problem.units.pressure

    @property
    def approach(self) -> float | None:
        """Approach [m]; None for an isolated punch without a datum."""
        return self.fields.approach

    @property
    def contact_fraction(self) -> float | None:
        """Width in contact over the period; None without a period."""
        if self.scene.period is None:
            return None
        return 1.0 if self._contact is None else float(self.zone_widths.sum() / self.scene.period)

    @cached_property
    def stiffness(self) -> float | None:
        """d load / d approach [N/m^2]; inf in full contact, None where there is no approach."""
        contact = self._contact
        if contact is None:
            return np.inf
        if contact.approach is None:
            return None
        return contact.stiffness

    @cached_property
    def mean_gap(self) -> float | None:
        """Mean of the gap over a period [m]; None without one."""
        if self.scene.period is None:
            return None
        return 0.0 if self._contact is None else self._contact.mean_gap

    def to_dict(self) -> dict[str, Any]:
        """All of it in plain types; None for what is infinite or undefined."""
        return export.to_dict(self)
