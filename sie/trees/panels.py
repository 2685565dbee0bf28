"""A smooth kernel between even panels of the line, as a short Chebyshev series on each pair.

Nothing is known of a user's kernel but that it is smooth; its length is found by sampling. The
panels over all zones are halved until the coefficients have decayed between any two of them,

    k(x, xi) = sum_kl K^(d)_kl T_k(t) T_l(tau),

where d is the number of panels by which x lies to the right of xi. This is one matrix for each lag
d. The field of zones at points follows from moments of the panels, sum_q w_q T_l(tau_q) over the
quadrature nodes of the zones, and from series on the panels, in time linear in zones and points. A
kernel of both places has a skeleton instead, so that it is called on zones only.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy import fft

from sie.basis import chebyshev
from sie.basis.data import Array, Complex, Index, Kept, by_rows, record
from sie.basis.kernels import Kernel
from sie.basis.zones import Zones
from sie.trees.skeleton import SKELETON, Skeleton, skeleton_of
from sie.trees.tree import CACHED, TERMS

Function = Callable[[Array, Array], Array]


@dataclass(frozen=True)
class PanelOptions:
    """Options of the panels of a smooth kernel."""

    # Panels over the zones, or over half a period, at most: a kernel that varies faster is summed
    # directly. Very many zones may have `panels_per_zone` panels each. From `min_zones_of_skeleton`
    # zones on, a kernel that does not depend on the lag alone has a skeleton.
    max_panels: int = 512
    panels_per_zone: int = 8
    min_zones_of_skeleton: int = 32
    # Decayed coefficients, relative to the largest. Coefficients below `SKELETON.max_error` that
    # halving a panel does not reduce to `noise_fall` are the kernel's own rounding.
    noise_fall: float = 0.3
    # Rounding of a place, relative to a panel.
    place_rounding: float = 1e-9


OPTIONS = PanelOptions()

# A series that falls by SKELETON.decayed in TERMS terms has no singularity closer to the line than
# this many widths of a panel.
_REACH = 0.5 * math.sinh(-math.log(SKELETON.decayed) / TERMS)


def panels_over(kernel: Kernel, zones: Zones) -> Panels | Skeleton | None:
    """Fast sums of a kernel's regular part over all zones; None if they do not serve it."""
    if (
        kernel.regular is None
        or kernel.sure
        or not (kernel.of_lag or len(zones) >= OPTIONS.min_zones_of_skeleton)
    ):
        return None
    if not kernel.of_lag:
        return skeleton_of(kernel, zones)
    return panels_of(
        kernel,
        float(zones.a[0]),
        float(zones.b[-1]),
        max(OPTIONS.max_panels, OPTIONS.panels_per_zone * len(zones)),
    )


def panels_of(
    kernel: Kernel, lo: float, hi: float, most: int = OPTIONS.max_panels
) -> Panels | None:
    """At most `most` panels of the regular part over [lo, hi]; None if these are too few."""
    if kernel.regular is None or kernel.sure or not hi > lo:
        return None
    # Without a period the panels end where the zones do, since the kernel need not hold beyond.
    # With one they also serve other zones.
    whole, origin = (
        (hi - lo, lo)
        if kernel.period is None
        else (2.0 ** math.ceil(math.log2(max(hi - lo, kernel.period))), 0.0)
    )
    step, before = whole, math.inf
    while True:
        first = 0 if kernel.period is None else math.floor(lo / step)
        count = round(whole / step) if kernel.period is None else math.floor(hi / step) - first + 1
        # With a period, all lags up to half of it from the middle of the zones are needed.
        away = 0.0 if kernel.period is None else 0.5 * (kernel.period + hi - lo)
        farthest = max(count - 1, math.ceil(away / step))
        if farthest >= most:
            return None
        key = step, origin, first, count
        if key not in kernel.kept_panels:
            if (
                len(kernel.kept_panels) >= SKELETON.kept_with_kernel
            ):  # those of zones that have moved since
                kernel.kept_panels.clear()
            kernel.kept_panels[key] = Panels(kernel, step, origin, first, count, farthest)
        found: Panels = kernel.kept_panels[key]
        tail = found.tail
        if tail <= SKELETON.decayed or (
            tail <= SKELETON.max_error and tail > OPTIONS.noise_fall * before
        ):
            return found
        step, before = 0.5 * step, tail


@record
class Panels(Kept):
    """Panels origin + [p step, (p + 1) step], p = first ... first + count - 1, of the sources.

    farthest: the largest lag between panels for which the kernel is tabulated.
    """

    kernel: Kernel
    step: float
    origin: float
    first: int
    count: int
    farthest: int

    def modes(self, half: Array) -> Index:
        """Number of modes by which the kernel acts on zones of given half widths, or sees them."""
        fall = np.arcsinh(_REACH * self.step / half)
        return np.asarray(np.ceil(-math.log(SKELETON.decayed) / fall), dtype=np.intp) + 2

    @cached_property
    def tail(self) -> float:
        """The last coefficients in either variable, over the largest.

        Only neighbouring panels are sampled at first, and all if these have decayed.
        """
        few = _tail(self._few())
        return (
            _tail(self._table(False).reshape(-1, TERMS, TERMS))
            if few <= SKELETON.max_error
            else few
        )

    def _few(self) -> Array:
        """K between neighbouring panels."""
        return self._made(False, -min(1, self.farthest), min(1, self.farthest) + 1)

    def _made(self, potential: bool, low: int, high: int) -> Array:
        """K^(d) for low <= d < high, (d, TERMS, TERMS)."""
        nodes = 0.5 * self.step * chebyshev.gauss(TERMS)
        out = np.empty((high - low, TERMS, TERMS))
        with np.errstate(all="ignore"):  # too far off, until panels are short enough
            for start in range(low, high, CACHED // TERMS):
                lags = np.arange(start, min(start + CACHED // TERMS, high))
                # Panels are counted from the first one, where the kernel holds.
                target, source = np.maximum(lags, 0)[:, None], np.maximum(-lags, 0)[:, None]
                out[lags - low] = self._coefficients(
                    potential, self.place(target) + nodes, self.place(source) + nodes
                )
        return out

    def place(self, panel: Index) -> Array:
        """Middles of panels, counted from the first one."""
        return np.asarray(self.origin + (self.first + panel + 0.5) * self.step)

    def _coefficients(self, potential: bool, x: Array, xi: Array) -> Array:
        """K by its values at nodes: x (n, TERMS) of several panels, xi of as many or of one."""
        function, to_series = (
            self.kernel.regular_potential if potential else self.kernel.regular,
            chebyshev.to_series(TERMS),
        )
        if function is None:
            raise ValueError("a condition on potentials needs the regular kernel's potential")
        values = np.asarray(
            function(x[:, :, None], np.broadcast_to(xi.reshape(-1, 1, TERMS), (len(x), 1, TERMS)))
        )
        return np.asarray(to_series.T @ values @ to_series)

    @cached_property
    def _tables(self) -> dict[bool, Array]:
        return {}

    def _table(self, potential: bool) -> Array:
        if potential not in self._tables:
            self._tables[potential] = self._all(potential)
        return self._tables[potential]

    def _all(self, potential: bool) -> Array:
        """K^(d) for all tabulated lags, (2 farthest + 1, TERMS, TERMS)."""
        return self._made(potential, -self.farthest, self.farthest + 1)

    def _series(self, moments: Array, low: int, high: int, potential: bool) -> Array:
        """Series on the panels low ... high, (panels, TERMS, n), by a convolution of moments over
        the panels.
        """
        kernel, length = self._waves(potential, low, high)
        moments = moments.reshape(self.count, TERMS, -1)
        waves = np.matmul(kernel, fft.rfft(moments, length, axis=0))
        return np.asarray(fft.irfft(waves, length, axis=0)[: high - low + 1])

    def _waves(self, potential: bool, low: int, high: int) -> tuple[Complex, int]:
        """(Fourier transform of K^(d) over all lags to the panels low ... high, its length)."""
        key = potential, low, high
        if key not in self._transforms:
            wanted = high - low + 1
            length = int(fft.next_fast_len(wanted + self.count - 1, real=True))
            lag = np.arange(1 - self.count, wanted)
            kernel = np.zeros((length, TERMS, TERMS))
            kernel[lag % length] = self._table(potential)[lag + low - self.first + self.farthest]
            # Only the last transform is kept: zones ask for the same one again and again.
            self._transforms.pop(
                next((k for k in self._transforms if k[0] == potential), key), None
            )
            self._transforms[key] = np.asarray(fft.rfft(kernel, axis=0)), length
        return self._transforms[key]

    @cached_property
    def _transforms(self) -> dict[tuple[bool, int, int], tuple[Complex, int]]:
        return {}

    @property
    def size(self) -> int:
        """Number of moments."""
        return self.count * TERMS

    def spread(self, x: Array) -> Spread:
        """Points with their panels."""
        return Spread.of(self, x)

    def moments(self, spread: Any, weights: Array) -> Array:
        """Moments (count TERMS, ...) of weights (n, ...) at points."""
        shape = weights.shape[1:]
        out = np.zeros((self.count, TERMS, *shape))
        for panel, here in spread.groups:
            out[panel - self.first] = np.tensordot(spread.table[here], weights[here], axes=(0, 0))
        return out.reshape(self.count * TERMS, *shape)

    def at(self, spread: Any, moments: Array, potential: bool) -> Array:
        """Transform or potential at points (n, ...), from moments (count TERMS, ...)."""
        out = np.empty((len(spread.x), *moments.shape[1:]))
        looked_at = self.first + self.count - 1 - self.farthest, self.first + self.farthest
        near = [
            (panel, here) for panel, here in spread.groups if looked_at[0] <= panel <= looked_at[1]
        ]
        if near:
            low = min(panel for panel, _ in near)
            series = self._series(moments, low, max(panel for panel, _ in near), potential).reshape(
                -1, TERMS, *moments.shape[1:]
            )
            for panel, here in near:
                out[here] = spread.table[here] @ series[panel - low]
        far = [here for panel, here in spread.groups if not looked_at[0] <= panel <= looked_at[1]]
        if far:
            off = np.concatenate(far)
            out[off] = self._far_off(spread.x[off], moments, potential)
        return out

    def _far_off(self, x: Array, moments: Array, potential: bool) -> Array:
        """Transform or potential at points beyond the tabulated lags, by calls of the kernel."""
        function = self.kernel.regular_potential if potential else self.kernel.regular
        assert function is not None
        middles = self.place(np.arange(self.count))
        nodes = (middles[:, None] + 0.5 * self.step * chebyshev.gauss(TERMS)).ravel()
        weights = np.einsum(
            "jl,pl...->pj...",
            chebyshev.to_series(TERMS),
            moments.reshape(self.count, TERMS, *moments.shape[1:]),
        )
        weights = weights.reshape(self.count * TERMS, *moments.shape[1:])
        return np.asarray(
            by_rows(
                lambda some: function(some[:, None], nodes) @ weights,
                x,
                max_rows=max(1, CACHED * TERMS // len(nodes)),
            )
        )


def _tail(blocks: Array) -> float:
    largest = float(np.abs(blocks).max())
    return (
        0.0
        if largest == 0.0
        else float(max(np.abs(blocks[:, -2:]).max(), np.abs(blocks[:, :, -2:]).max())) / largest
    )


@record
class Spread(Kept):
    """Points (n,) on the panels: T_k at each, (n, TERMS), and the points of each panel."""

    x: Array
    table: Array
    groups: list[tuple[int, Index]]

    @classmethod
    def of(cls, panels: Panels, x: Array) -> Spread:
        place = (x - panels.origin) / panels.step
        panel = np.floor(place)
        # The right end of the last panel belongs to it.
        last = panels.first + panels.count - 1
        panel = np.where(
            (panel == last + 1) & (place - panel < OPTIONS.place_rounding), last, panel
        )
        theta = np.arccos(np.clip(2 * (place - panel) - 1, -1.0, 1.0))
        table = np.cos(theta[:, None] * np.arange(TERMS))
        order = np.argsort(panel, kind="stable")
        starts = np.flatnonzero(np.diff(panel[order], prepend=np.nan) != 0)
        parts = np.split(order, starts[1:]) if len(x) else []
        return cls(x, table, [(int(panel[part[0]]), part) for part in parts])
