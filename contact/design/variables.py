"""Data of a scene that a design may change, in one vector whose entries lie between 0 and 1."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from contact.derivatives.result import Sensitivity
from contact.errors import SceneError
from contact.model.checks import one_of
from contact.model.scene import Scene
from contact.sweeps.sweep.keys import numbers_of, varied
from sie import Array


@dataclass(frozen=True)
class Variables:
    """The data of a scene that a design may change.

    own: the scene's own values by name. counts: numbers of entries of the data. low, high: bounds
    of all entries.
    """

    scene: Scene
    own: dict[str, Any]
    counts: tuple[int, ...]
    low: Array
    high: Array

    @classmethod
    def of(cls, scene: Scene, over: Any) -> Variables:
        """Variables from the user's mapping of names to bounds.
        Raises SceneError for an unknown name or invalid bounds.
        """
        if not isinstance(over, Mapping) or not over:
            raise SceneError.of(
                "over",
                over,
                "a dictionary of names and bounds, such as {'profile.amplitude': (1e-7, 1e-6)}",
            )
        known = numbers_of(scene)
        own = {one_of("over", name, known): known[name] for name in over}
        counts, low, high = [], [], []
        for name, bounds in over.items():
            value = np.asarray(own[name], dtype=float)
            try:
                # A profile leaves out zeros at the end of its list of coefficients, so the bounds
                # may have more entries than the list.
                count = max(value.size, *(np.size(bound) for bound in bounds)) if value.ndim else 1
                lo, hi = (np.broadcast_to(np.asarray(b, dtype=float), (count,)) for b in bounds)
            except (TypeError, ValueError):
                raise SceneError.of(
                    name, bounds, "(lowest, highest), each a number or an array of matching length"
                ) from None
            if not (np.isfinite(lo).all() and np.isfinite(hi).all() and np.all(lo < hi)):
                raise SceneError.of(name, bounds, "finite bounds, the lowest below the highest")
            first = _padded(value, count)
            if np.any((first < lo) | (first > hi)):
                raise SceneError.of(
                    name, bounds, f"bounds that contain the scene's own value, {value}"
                )
            counts.append(count)
            low.append(lo)
            high.append(hi)
        return cls(scene, own, tuple(counts), np.concatenate(low), np.concatenate(high))

    @property
    def start(self) -> Array:
        """The scaled vector that gives the scene's own data; its entries lie between 0 and 1."""
        values = [
            _padded(value, count)
            for value, count in zip(self.own.values(), self.counts, strict=True)
        ]
        return np.asarray((np.concatenate(values) - self.low) / (self.high - self.low))

    def values(self, vector: Array) -> dict[str, Any]:
        """The data by name, from the scaled vector, whose entries 0 and 1 are the bounds."""
        entries = self.low + vector * (self.high - self.low)
        # A zero at the end of a list of coefficients would be left out by the profile, and with it
        # the derivative by this coefficient. So zeros are replaced by the smallest positive number.
        entries = np.where(entries == 0.0, np.finfo(float).tiny, entries)
        parts = np.split(entries, np.cumsum(self.counts)[:-1])
        return {
            name: part if np.ndim(value) else float(part[0])
            for (name, value), part in zip(self.own.items(), parts, strict=True)
        }

    def scene_of(self, vector: Array) -> Scene:
        """The scene with the data that this scaled vector (entries from 0 to 1) stands for."""
        single: dict[str, Any] = {}
        bodies: dict[str, dict[str, Any]] = {}
        for name, value in self.values(vector).items():
            table, _, key = name.partition(".")
            if table in self.scene.profile.bodies:
                bodies.setdefault(table, {})[key] = value
            else:
                single[name] = value
        profile = self.scene.profile.varied(bodies) if bodies else self.scene.profile
        return varied(replace(self.scene, profile=profile), single)

    def gradient(self, by: Sensitivity, number: str) -> Array:
        """Derivatives of a result by the scaled vector.
        Their shape is (entries of the vector, *shape of the result).
        """
        parts = []
        for name, own in self.own.items():
            value = np.asarray(by.of(number, to=name).value)
            parts.append(value if np.ndim(own) else value[None])
        table = np.concatenate(parts)
        return np.asarray(table * (self.high - self.low).reshape((-1,) + (1,) * (table.ndim - 1)))

    def top_slopes(self, by: Sensitivity, number: str) -> Array:
        """Derivatives (entries, k) of pressure or stress at k local maxima, by the scaled data.
        number: "max_pressure" for the pressure, "max_stress" for the stress.
        """
        table = np.concatenate([by.of_tops(name, number) for name in self.own])
        return np.asarray(table * (self.high - self.low)[:, None])


def _padded(value: Any, count: int) -> Array:
    entries = np.ravel(np.asarray(value, dtype=float))
    return np.append(entries, np.zeros(count - entries.size))
