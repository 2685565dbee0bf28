"""Zones that are far off, brought near on their own, in the field that the others make.

Newton moves all ends together at the price of a whole system, and would have every zone wait for the few that start far off: where
the first guess was a cell of a grid, or where a zone is being born. What the others do at such a zone is smooth there,

    E(x) = sum E_k U_{k-1}(t),    E_k = c_k + g_k,

known from the last solution, so that the zone can be moved alone, with h = g - E on the places it comes to:

    c_k = -h_k,    w c_0 log(w / 2d) = level + mean of the primitive of h    (a level, or else a total, that stays),

by the same step 2 K / A. Its neighbours hold their levels whatever it does: so d is the conformal radius between them
(`neighbours`). Then all are solved together again.
"""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from sie.basis import chebyshev
from sie.basis.data import Array, Index, Mask, widened
from sie.basis.interval import mean_potential
from sie.basis.zones import Zones
from sie.collocation import modes
from sie.collocation.modes import conformal_radius
from sie.density.density import Density
from sie.jumps.forcing import ForcingJumps
from sie.slits.system import AnyState

Step = Callable[[Density, Array], Array]
"""Outward steps (2, n) of the ends of a density's zones, given their coefficients' size, cut to their widths."""
Added: TypeAlias = tuple[Density, float]
"""A density without slits, and how many times it is added."""

# A zone is far off if an end wants to move by more than this part of its width; alone, it is moved until it does not.
FAR_OFF, _CLOSE = 0.05, 1e-3
# If more than this part of all zones is far off, the field is not known either.
_FEW = 0.5
# Nodes on a zone; coefficients of the field, to which no other zone is nearer than the width of this one.
_NODES, _FIELD = 48, 3
# How far from where it stood a zone is looked for: in half widths, or as a part of the length over which the right side varies;
# and how far into a gap.
_HALVES, _WAVE, _INTO_GAP = 4.0, 0.125, 0.4
_MOST_STEPS = 16
# Of a density's size on a zone: a total that is none.
_NO_TOTAL = 1e-3
# Half widths are no less than so many units in the last digit of their places: zones as narrow as that have vanished.
_LEAST = 2
_ORDER = np.arange(1.0, _NODES + 1)


def far_off(state: AnyState, moves: Mask, delta: Array) -> Index:
    """Zones that want to move far and can be moved alone, to where nothing is singular at their ends; none if they are many."""
    zones, kernel = state.density.zones, state.equation.kernel
    if zones.follow_ends:
        return np.zeros(0, dtype=np.intp)
    width = zones.b - zones.a
    off = (np.abs(delta) > FAR_OFF * width).any(axis=0)
    if not off.any() or np.count_nonzero(off) > _FEW * len(zones):
        return np.zeros(0, dtype=np.intp)
    whole, place = state.wide_of(np.arange(len(zones)))
    alone = (np.minimum(*modes.gaps(zones, kernel)) > width) & (width < 0.5 * kernel.datum)
    alone &= np.bincount(place)[place] == 1
    smooth = whole.sizes.own <= _NODES
    smooth[list(whole.density.jumps.kinked)] = False
    smooth[list(whole.density.jumps.poles.by_zone)] = False
    return np.flatnonzero(off & alone & smooth[place] & moves.all(axis=0))


def _first(table: Array) -> Array:
    """Coefficients 1 ... _FIELD."""
    return widened(table[:, 1 : _FIELD + 1], _FIELD)


class Moving:
    """Chosen zones on their way, each in the others' field as it is."""

    def __init__(self, state: AnyState, chosen: Index, added: Added | None = None) -> None:
        self.equation, density = state.equation, state.density
        self.zones, self.chosen = density.zones, chosen
        zones = self.zones
        self.first = middle, half = zones.middle[chosen], zones.half[chosen]
        left_gap, right_gap = (gap[chosen] for gap in modes.gaps(zones, self.equation.kernel))
        self.datum = np.minimum(self.equation.kernel.datum, conformal_radius(left_gap + half, right_gap + half))
        reach = np.maximum(_HALVES * half, _WAVE * (self.equation.forcing.resolution or 0.0))
        self.lowest = np.maximum(zones.a[chosen] - _INTO_GAP * left_gap, middle - reach)
        self.highest = np.minimum(zones.b[chosen] + _INTO_GAP * right_gap, middle + reach)
        # Nor does it go beyond where the right side is defined.
        low, high = self.equation.within
        self.lowest = np.maximum(self.lowest, 0.5 * (low + zones.a[chosen])) if np.isfinite(low) else self.lowest
        self.highest = np.minimum(self.highest, 0.5 * (high + zones.b[chosen])) if np.isfinite(high) else self.highest
        whole, place = state.wide_of(chosen)
        # E_k, and what the zones hold.
        self.by_others = _first(whole.density.coefficients[place]) + _first(whole.system.g[place])
        self.total = whole.density.totals[place] / np.pi
        if added is not None:
            self.by_others = self.by_others + added[1] * _first(added[0].coefficients[place])
            self.total = self.total + added[1] * added[0].totals[place] / np.pi
        # Level plus the mean of the primitive of h, and the zones and coefficients to which it belongs.
        self.level = self.total * self._log(half)
        self.middle, self.half, self.h = middle, half, chebyshev.u_coefficients(self._left(middle, half))

    def _log(self, w: Array) -> Array:
        return np.asarray(mean_potential(w, self.datum) / w)

    def _left(self, middle: Array, half: Array) -> Array:
        """h at the nodes of intervals (n, _NODES)."""
        x = middle[:, None] + half[:, None] * chebyshev.lobatto(_NODES)[0][1:-1]
        return np.asarray(self.equation.forcing.value(x.ravel())).reshape(x.shape) - self.field(x)

    def field(self, x: Array) -> Array:
        """E at x (n, m)."""
        middle, half = self.first
        return chebyshev.u_values(self.by_others, (x - middle[:, None]) / half[:, None])

    def to(self, middle: Array, half: Array) -> None:
        """Go to other intervals: the primitive of U_{k-1} is T_k / k. What lies between the middles is read off the wider one."""
        half = np.maximum(half, _LEAST * np.spacing(np.abs(middle)))
        h, k = chebyshev.u_coefficients(self._left(middle, half)), _ORDER
        wider = half > self.half
        w, series = np.where(wider, half, self.half), np.where(wider[:, None], h, self.h)
        between = np.where(wider, self.middle - middle, middle - self.middle) / w
        rise = w * (np.cos(k * np.arccos(np.clip(between, -1.0, 1.0))[:, None]) / k * series).sum(axis=1)
        w, series = np.where(wider, self.half, half), np.where(wider[:, None], self.h, h)
        rise = rise - w * (series @ (np.cos(0.5 * np.pi * k) / k))
        self.level = self.level + np.where(wider, -rise, rise)
        self.middle, self.half, self.h = middle, half, h

    def to_tips(self) -> Mask:
        """Go to the lone interval about the place where the right side's primitive is least: with h = kappa (x - x_0) and level L there,
        (kappa a^2 / 2) (log(a / 2d) - 1/2) = L. Hands out which zones have none: where L is not negative."""
        middle, half, k = self.middle, self.half, _ORDER
        self.to(0.5 * (self.lowest + self.highest), 0.5 * (self.highest - self.lowest))
        t = chebyshev.lobatto(_NODES)[0][1:-1]
        primitive = self.half[:, None] * (self.h @ (np.cos(np.arccos(t) * k[:, None]) / k[:, None]))
        each, deepest = np.arange(len(middle)), np.argmin(primitive, axis=1)
        depth = self.level + primitive[each, deepest]
        inner = np.clip(deepest, 1, _NODES - 2)
        slope = self.h @ (np.sin(np.arccos(t) * k[:, None]) / np.sin(np.arccos(t)))
        kappa = (slope[each, inner - 1] - slope[each, inner + 1]) / (self.half * (t[inner - 1] - t[inner + 1]))
        between = (kappa > 0) & (deepest == inner)
        with np.errstate(divide="ignore", invalid="ignore"):
            # Nodes may be farther from each other than the interval is wide: the tip is where h vanishes.
            aside = np.where(between, -slope[each, deepest] / kappa, 0.0)
        depth = depth - 0.5 * np.where(between, kappa * aside**2, 0.0)
        holds = (depth < 0) & between
        a = half.copy()
        for _ in range(8):
            with np.errstate(divide="ignore", invalid="ignore"):
                a = np.where(holds, np.sqrt(2 * depth / (kappa * (self._log(a) - 0.5))), half)
        tip = np.where(holds, self.middle + self.half * t[deepest] + aside, middle)
        left, right = np.maximum(tip - a, self.lowest), np.minimum(tip + a, self.highest)
        self.to(0.5 * (left + right), 0.5 * (right - left))
        return np.asarray(depth >= 0)

    def shut(self, sign: float) -> Mask:
        """Which zones of no total have nothing to open them: h of the density's sign nowhere about them."""
        half = 0.5 * (self.highest - self.lowest)
        h = self._left(0.5 * (self.lowest + self.highest), half)
        return np.asarray((np.abs(self.total) <= _NO_TOTAL * half * np.abs(h).max(axis=1)) & ((sign * h).max(axis=1) <= 0))

    def density(self) -> Density:
        """The densities of the zones where they are."""
        levels = any(c.levels for c in self.equation.conditions)
        first = self.level / (self.half * self._log(self.half)) if levels else self.total / self.half
        left, right = ([kinds[i] for i in self.chosen] for kinds in (self.zones.left, self.zones.right))
        a, b = self.middle - self.half, self.middle + self.half
        # A zone may be narrower than the rounding of its places.
        here = Zones(a, b, left, right, rest=np.array([(self.middle - a) - self.half, (self.middle - b) + self.half]))
        return Density(here, self.equation.kernel, np.column_stack((first, -self.h)), ForcingJumps.none(), np.zeros(0))


def moved_singly(
    state: AnyState, chosen: Index, step: Step, signs: tuple[float, float], added: Added | None = None
) -> tuple[Array, Array, Mask, Mask]:
    """(new ends a, b, whether they came to rest, whether nothing is left of them) of the chosen zones, after what is added to the density,
    if anything is. signs: see `find_ends`."""
    moving, gone = Moving(state, chosen, added), np.zeros(len(chosen), dtype=bool)
    if any(c.levels for c in state.equation.conditions):
        gone = moving.to_tips() & (signs == (1.0, 1.0))
    elif signs[0] != signs[1]:
        gone = moving.shut(signs[0])
    for _ in range(_MOST_STEPS):
        density = moving.density()
        delta = step(density, np.abs(moving.h).max(axis=1))
        a = np.maximum(density.zones.a - delta[0], moving.lowest)
        b = np.minimum(density.zones.b + delta[1], moving.highest)
        rest = np.abs(delta).max(axis=0) <= _CLOSE * (b - a)
        if np.all(rest | gone):
            break
        moving.to(0.5 * (a + b), 0.5 * (b - a))
    return a, b, rest & ~gone, gone
