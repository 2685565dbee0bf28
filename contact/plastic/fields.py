"""Fields of a contact with plateaus, in SI units: the density of `sie` contains the plateaus."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from contact.formulation.fields import ZoneFields, moved_ends
from contact.formulation.quadrature import cuts_between, panels
from contact.model.profiles.derive import DETAIL
from contact.model.profiles.noise import EPS
from contact.plastic.spots import Spots, index_of
from sie import Array, Mask, nearest_image, record, wrapped


@record
class PlasticFields(ZoneFields):
    """The fields of a contact with plateaus: intervals on which the pressure is its limit H.

    A zone is a contact with the plateaus in it. The unknown is the pressure on its elastic parts
    (`solved_zones`). limit: H, scaled.
    """

    limit: float = np.inf

    @cached_property
    def spots(self) -> Spots:
        """The scaled intervals of contact, and the plateaus (pressure at its limit)."""
        density = self.density
        return Spots.of(density.zones, density.plateaus, self.problem.period)

    @cached_property
    def true_spots(self) -> Spots:
        """Contacts and plateaus with their true ends.
        Very narrow elastic rims between plateaus and gaps are stored as wider zones. Here they have
        their true widths.
        """
        zones, spots = self.density.zones, self.spots
        if not zones.depth.any():
            return spots
        ends, true = (
            np.array((zones.middle - half, zones.middle + half))
            for half in (zones.half, zones.true_half)
        )
        shifts = np.where(zones.depth < 0.0, true - ends, 0.0)
        contacts = spots.contacts + (0.0 if spots.full else self._at_ends(shifts, spots.contacts))
        plateaus = spots.plateaus + self._at_ends(shifts, spots.plateaus)
        return Spots(contacts, plateaus, spots.full)

    def _at_ends(self, values: Array, places: Array) -> Array:
        """Values at `places`, looked up in `values`, (2, Z), at the ends of Z elastic intervals.
        The value is 0 at a place that is no such end.
        """
        zones, period = self.density.zones, self.problem.period
        ends = np.concatenate((zones.a, zones.b))
        order = np.argsort(ends)
        near = np.searchsorted(ends[order], wrapped(places, float(ends[order[0]]), period))
        beside = order[np.array((near - 1, near % len(ends)))]
        away = np.abs(nearest_image(ends[beside] - places, 0.0, period))
        nearer = np.where(away[0] < away[1], beside[0], beside[1])
        same = away.min(axis=0) <= 8 * EPS * np.maximum(1.0, np.abs(places))
        return np.asarray(np.where(same, values.ravel()[nearer], 0.0))

    @property
    def zones(self) -> Array:
        return self.true_spots.contacts if not self.spots.full else np.zeros((0, 2))

    @property
    def zone_table(self) -> Array:
        return np.asarray(self.problem.units.x(self.zones))

    @property
    def plateaus(self) -> Array:  # type: ignore[override]
        """Intervals [m] (m, 2) in which the pressure has reached its limit."""
        return np.asarray(self.problem.units.x(self.true_spots.plateaus))

    def pressure(self, x: ArrayLike) -> Array:
        """Contact pressure p(x) [Pa] at x [m], including the plateaus.

        A very narrow rim is stored as a wider zone. There the pressure follows from the rim's true
        width.
        """
        scaled, zones = self._scaled(x), self.density.zones
        value = np.asarray(self.density(scaled))
        if zones.depth.any():
            i = np.minimum(
                np.searchsorted(zones.b, wrapped(scaled, float(zones.a[0]), self.problem.period)),
                len(zones) - 1,
            )
            place = wrapped(scaled, float(zones.a[0]), self.problem.period)
            t = np.clip((place - zones.middle[i]) / zones.true_half[i], -1, 1)
            left, right = zones.values
            passage = right[i] + (left - right)[i] * np.arccos(t) / np.pi
            value = np.where((place >= zones.a[i]) & (zones.depth[i] < 0.0), passage, value)
        # A plateau at a sharp corner may be narrower than round-off. The table of plateaus leaves
        # it out, and the elastic pressure there exceeds the limit.
        return np.minimum(value, self.limit) * self.problem.units.pressure

    def overlap(self, x: ArrayLike) -> Array:
        """Height [m] at x [m] that the body lost by yielding; 0 outside the plateaus.
        Without this loss of height, the surfaces would overlap.
        """
        scaled = self._scaled(x)
        on = self.on_plateaus(scaled)
        out = np.zeros(scaled.shape)
        out[on] = -self.formal_gap(scaled[on]) * self.problem.units.height
        return out

    def on_plateaus(self, x: Array) -> Mask:
        """Whether scaled places lie on plateaus."""
        return _within(self.density.plateaus, x, self.problem.period)

    def inside(self, x: Array) -> Mask:
        if self.spots.full:
            return np.ones(np.shape(x), dtype=bool)
        return _within(self.spots.contacts, x, self.problem.period)

    @cached_property
    def loads(self) -> Array:
        density = self.density
        parts = np.concatenate((density.zones.table, density.plateaus))
        on_plateaus = self.limit * np.diff(density.plateaus, axis=1)[:, 0]
        load = np.concatenate((density.totals, on_plateaus))
        if self.spots.full:
            return np.zeros(0)
        contacts = self.spots.contacts
        which = index_of(contacts, parts.mean(axis=1))
        summed = np.bincount(which, load, minlength=len(contacts))
        return np.asarray(summed * self.problem.units.load, dtype=float)

    def pressure_at(self, zone: int, t: ArrayLike) -> Array:
        a, b = self.spots.contacts[zone]
        t = np.asarray(t, dtype=float)
        x = np.where(t < 0, a + 0.5 * (b - a) * (1 + t), b - 0.5 * (b - a) * (1 - t))
        return np.asarray(self.density(x) * self.problem.units.pressure)

    @property
    def max_pressure(self) -> float:  # type: ignore[override]
        return self.limit * self.problem.units.pressure

    @property
    def pressure_bound(self) -> float:
        return self.max_pressure

    @property
    def contact_fraction(self) -> float:
        if self.spots.full:
            return 1.0
        return float(np.diff(self.zones, axis=1).sum()) / self.problem.repeat_length

    @cached_property
    def moves(self) -> Array:
        """Derivatives (2, Z) of the ends of Z elastic intervals by the load, outward positive.
        They are in scaled units.
        """
        return moved_ends(self.state)

    @cached_property
    def widening_rate(self) -> float:
        moves = np.where(self.density.zones.values == 0.0, self.moves, 0.0)
        return float(moves.sum()) / self.problem.repeat_length / self.problem.units.load

    @cached_property
    def spreading(self) -> Array:
        return self._spreading(self.spots.contacts, 1.0)

    @cached_property
    def plateau_spreading(self) -> Array:
        """Derivatives (m, 2) [m] of the ends of the plateaus by ln(load), outward positive."""
        return self._spreading(self.spots.plateaus, -1.0)

    def _spreading(self, table: Array, outward: float) -> Array:
        """Derivatives [m] by ln(load) of the ends of contacts or plateaus.
        `outward` is 1 for contacts and -1 for plateaus.
        """
        moves = self._at_ends(outward * self.moves, table)
        return moves * self.problem.units.length * self.density.total

    @cached_property
    def mean_gap(self) -> float:
        # `super().mean_gap` is the mean of displacement plus profile minus approach. On plateaus
        # this is minus the overlap, but the true gap is zero. So the overlap is added.
        units, problem = self.problem.units, self.problem
        return super().mean_gap + self.overlap_integral * problem.repeat_length**-1 * units.height

    @cached_property
    def overlap_integral(self) -> float:
        """Integral of the overlap of the surfaces over all plateaus, in scaled units."""
        total, breaks = 0.0, self.problem.forcing.jumps.broken_at
        for lo, hi in self.density.plateaus.tolist():
            x, weights = panels(
                cuts_between(lo, hi, max(0.5 * self.spacing, (hi - lo) / DETAIL.samples), breaks)
            )
            total -= float(self.formal_gap(x) @ weights)
        return total

    def open_intervals(self) -> Iterator[tuple[float, float, bool, bool]]:
        if self.spots.full:
            return
        contacts, own = self.spots.contacts, tuple(super().open_intervals())
        between = {
            (float(b), float(a)) for b, a in zip(contacts[:-1, 1], contacts[1:, 0], strict=True)
        }
        ends = float(contacts[0, 0]), float(contacts[-1, 1])
        for lo, hi, left, right in own:
            if left and right:
                if (lo, hi) in between or lo == ends[1]:
                    yield lo, hi, left, right
            elif left and lo == ends[1] or right and hi == ends[0]:
                yield lo, hi, left, right


def _within(table: Array, x: Array, period: float | None) -> Mask:
    if len(table) == 0:
        return np.zeros(np.shape(x), dtype=bool)
    place = wrapped(x, float(table[0, 0]), period)
    i = index_of(table, place)
    return np.asarray((place >= table[i, 0]) & (place <= table[i, 1]))
