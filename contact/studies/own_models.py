"""Interaction models of one's own, as a reader of docs/own-profile.md would write them, for random
scenes and tests; and their judge.

Each is a kernel that is not the half-plane's, with or without its symbol, and says by `multiplier`
or `rest`, in closed forms of its own, what a grid is to take: wrong zones, wrong full contact and
wrong refusals are then seen (contact.studies.grid_judge).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import contact
import sie
from contact.studies.grid_judge import Judged, judge_line, judge_period

Array = NDArray[np.float64]

# Ends of zones, in cells, by which two ways of solving may differ, and the part of random scenes
# that get a model of their own.
_CELLS = 4
_SHARE = 0.15
_POINTS = 4096
# Places at which the highest summit is looked for.
_LOOKS = 2**18


@dataclass(frozen=True)
class Waves(contact.Interaction):
    """L_n = 1 + excess[n - 1] for the longest waves of the period, 1 for all others."""

    excess: tuple[float, ...]
    name = "waves"
    needs_period = True

    def kernel(self, period: float | None, unit: float) -> sie.Kernel:
        assert period is not None
        base = 2 * np.pi / period

        def value(x: Array, xi: Array) -> Array:
            return np.asarray(
                sum(e * base * np.sin(n * base * (x - xi)) for n, e in enumerate(self.excess, 1))
            )

        def potential(x: Array, xi: Array) -> Array:
            return np.asarray(
                sum(-e / n * np.cos(n * base * (x - xi)) for n, e in enumerate(self.excess, 1))
            )

        return sie.hilbert(period) + sie.Smooth(value, potential)

    def multiplier(self, q: Array, period: float) -> Array:
        n = np.rint(q * period / (2 * np.pi)).astype(int)
        table = np.concatenate((np.zeros(1), self.excess))
        return np.asarray(1 + np.where(n < len(table), table[np.minimum(n, len(table) - 1)], 0.0))


@dataclass(frozen=True)
class Bed(contact.Interaction):
    """L(q) = 1 + eps exp(-q depth), a kernel alone: the geometric series r^n sin n theta and r^n
    cos(n theta)/n in closed form.
    """

    eps: float
    depth: float
    name = "bed"
    needs_period = True

    def kernel(self, period: float | None, unit: float) -> sie.Kernel:
        assert period is not None
        base, eps = 2 * np.pi / period, self.eps
        r = np.exp(-base * self.depth / unit)

        def value(x: Array, xi: Array) -> Array:
            theta = base * (x - xi)
            return np.asarray(base * eps * r * np.sin(theta) / (1 - 2 * r * np.cos(theta) + r * r))

        def potential(x: Array, xi: Array) -> Array:
            return np.asarray(0.5 * eps * np.log(1 - 2 * r * np.cos(base * (x - xi)) + r * r))

        return sie.hilbert(period) + sie.Smooth(value, potential)

    def multiplier(self, q: Array, period: float) -> Array:
        return np.asarray(1 + self.eps * np.exp(-q * self.depth))


@dataclass(frozen=True)
class Coated(Bed):
    """The same body with its symbol declared, and the kernel left to that."""

    name = "coated"
    kernel = contact.Interaction.kernel

    def symbol(self, q: Array) -> Array:
        return np.asarray(1 + self.eps * np.exp(-q * self.depth))


@dataclass(frozen=True)
class Buried(contact.Interaction):
    """A lone body: K = 1/r + eps r/(r^2 + depth^2), of symbol 1 + eps exp(-q depth)."""

    eps: float
    depth: float
    name = "buried"
    allows = ("load", "mean_pressure", "half_width")

    def kernel(self, period: float | None, unit: float) -> sie.Kernel:
        eps, depth = self.eps, self.depth / unit
        return sie.cauchy() + sie.Smooth(
            lambda x, xi: eps * (x - xi) / ((x - xi) ** 2 + depth**2),
            lambda x, xi: 0.5 * eps * np.log((x - xi) ** 2 + depth**2),
        )

    def rest(self, lag: Array) -> Array:
        return np.asarray(0.5 * self.eps * np.log(lag**2 + self.depth**2))


OWN = (Waves, Bed, Coated, Buried)


def instead(seed: int, interaction: contact.Interaction, length: float) -> contact.Interaction:
    """For a part of the seeds, a model of one's own in place of the one that was drawn; drawn
    apart, so that the other seeds stay.
    """
    rng = np.random.default_rng([seed, 1])
    if rng.random() >= _SHARE or interaction.strip:
        return interaction
    eps, depth = float(rng.uniform(-0.7, 1.5)), length * float(10 ** rng.uniform(-1.5, 0.5))
    if not interaction.needs_period:
        return Buried(eps, depth)
    kind = rng.integers(4)
    if kind == 0:
        return Waves((eps,))
    if kind == 1:
        return Waves(tuple(float(e) for e in rng.uniform(-0.6, 1.0, int(rng.integers(2, 8)))))
    return Bed(eps, depth) if kind == 2 else Coated(eps, depth)


def judge(
    scene: contact.Scene, load: float, window: tuple[float, float] | None = None, n: int = _POINTS
) -> Judged:
    """The contact of a scene of these models on an independent grid, under a load [N/m]."""
    profile, model, period = scene.profile, scene.interaction, scene.period
    if period is None:
        assert isinstance(model, Buried) and window is not None
        return judge_line(profile.height, window, scene.E_star, model.rest, load, n)
    assert isinstance(model, (Waves, Bed))
    cell = profile.x0, profile.x0 + period
    return judge_period(
        profile.height, cell, scene.E_star, lambda q: model.multiplier(q, period), load, n
    )


def fault(scene: contact.Scene, solution: contact.Solution) -> str:
    """What of a solution an independent grid does not have; empty if it agrees as far as its cells
    tell, or tells nothing.
    """
    window = None
    if scene.period is None:
        lo, hi = float(solution.zones[0, 0]), float(solution.zones[-1, 1])
        window = lo - 0.6 * (hi - lo), hi + 0.6 * (hi - lo)
        if scene.profile.period is not None:
            window = scene.profile.x0, scene.profile.x0 + scene.profile.period
    found = judge(scene, solution.load, window)
    if not found.settled:
        return ""
    pressed = solution.pressure(found.x) > 0
    ends = max(len(solution.zones), int(np.count_nonzero(np.diff(found.contact))) // 2) + 1
    off = int(np.count_nonzero(pressed != found.contact))
    if off > 2 * _CELLS * ends:
        return f"{off} of {len(found.x)} cells differ from an independent grid, contact {np.mean(pressed):.4f} against {found.fraction:.4f}"
    if scene.period is not None and solution.approach is not None:
        # Approaches count from the highest summit, which may lie between the cells of the grid.
        heights = np.asarray(
            scene.profile.height(scene.profile.x0 + scene.period * np.arange(_LOOKS) / _LOOKS)
        )
        level, range_ = (
            found.level - float(heights.min()),
            float(np.ptp(heights[np.isfinite(heights)])),
        )
        if abs(level - solution.approach) > 0.02 * max(range_, solution.approach):
            return f"approach {solution.approach:.6g}, on an independent grid {level:.6g}"
    return ""


def wrongly_refused(scene: contact.Scene, error: contact.ContactError) -> str:
    """Whether a scene was refused as full contact without being near it; empty if not."""
    load = scene.given_load
    if load is None or scene.period is None or "gives a kernel and no symbol" not in str(error):
        return ""
    found = judge(scene, load)
    if not found.settled or found.fraction > 1 - 2 * _CELLS / len(found.x):
        return ""
    return f"refused as full contact, of which an independent grid has {found.fraction:.4f}"
