"""A smooth kernel between panels of equal length, as a short Chebyshev series on each pair.

A user's kernel k(x, xi) is known to be smooth. The length over which it varies is found by
sampling. The line is divided into panels. They are halved until, for x and xi on any pair of
panels, the coefficients of the following series have decayed (t, tau: positions from -1 to 1):

    k(x, xi) = sum_kl K^(d)_kl T_k(t) T_l(tau),

where d is the number of panels by which x lies to the right of xi. The coefficients are one matrix
K^(d) for each lag d. The moments of a panel are sum_q w_q T_l(tau_q) over the sources on it: nodes
tau_q of the zones, where the density times the quadrature weight is w_q. The field at points
follows from the moments by series on the panels, in time linear in zones and points. A kernel that
does not depend on x - xi alone is treated by a skeleton instead (`sie.trees.skeleton`). The kernel
is then called for positions on zones only.
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
from sie.basis.data import HALF_DIGITS, SUM_ROUNDING, Array, Complex, Index, Kept, by_rows, record
from sie.basis.kernels import Kernel
from sie.basis.sums import OPTIONS as SUMS
from sie.basis.zones import Zones
from sie.trees.skeleton import MAX_STORED, SKELETON, Skeleton, skeleton_of
from sie.trees.tree import TERMS

Function = Callable[[Array, Array], Array]


@dataclass(frozen=True)
class PanelOptions:
    """Options of panels: equal parts of the line, for fast sums of a smooth kernel."""

    # Largest number of panels, divided by the number of zones. If the kernel needs more panels, its
    # sums are computed directly, unless the table of matrices between panels is small.
    panels_per_zone: int = 8
    # Least number of zones for a skeleton, that is, interpolation of the kernel from a few source
    # points. It replaces panels if the kernel does not depend on x - xi alone.
    min_zones_of_skeleton: int = 32


OPTIONS = PanelOptions()


def panels_over(kernel: Kernel, zones: Zones) -> Panels | Skeleton | None:
    """Panels or a skeleton for fast sums of the kernel's regular part; None if neither applies."""
    if (
        kernel.regular is None
        or kernel.sure
        or not (kernel.of_lag or len(zones) >= OPTIONS.min_zones_of_skeleton)
    ):
        return None
    if not kernel.of_lag:
        return skeleton_of(kernel, zones)
    return panels_of(
        kernel, float(zones.a[0]), float(zones.b[-1]), OPTIONS.panels_per_zone * len(zones)
    )


def panels_of(kernel: Kernel, lo: float, hi: float, most: int = 0) -> Panels | None:
    """Panels that resolve the kernel's regular part on [lo, hi]; None if `most` do not suffice.

    More panels are allowed if the table of their matrices has at most `memory_pairs` numbers.
    """
    most = max(most, SUMS.memory_pairs // TERMS**2)
    if kernel.regular is None or kernel.sure or not hi > lo:
        return None
    # Without a period the panels end where the zones end, since the kernel need not be defined
    # outside the zones. With a period the panels have fixed positions, so that they can be reused
    # for other zones.
    whole, origin = (
        (hi - lo, lo)
        if kernel.period is None
        else (2.0 ** math.ceil(math.log2(max(hi - lo, kernel.period))), 0.0)
    )
    step, before = whole, math.inf
    while True:
        first = 0 if kernel.period is None else math.floor(lo / step)
        count = round(whole / step) if kernel.period is None else math.floor(hi / step) - first + 1
        # With a period, the field is needed at points up to half a period from the middle of the
        # zones. `away` is the largest distance between one of these points and a point of the
        # zones.
        away = 0.0 if kernel.period is None else 0.5 * (kernel.period + hi - lo)
        farthest = max(count - 1, math.ceil(away / step))
        if farthest >= most:
            return None
        key = step, origin, first, count
        if key not in kernel.kept_panels:
            if (
                len(kernel.kept_panels) >= MAX_STORED
            ):  # the stored panels may be those of zones that have moved since
                kernel.kept_panels.clear()
            kernel.kept_panels[key] = Panels(kernel, step, origin, first, count, farthest)
        found: Panels = kernel.kept_panels[key]
        tail = found.tail
        # If the last coefficients are small but shorter panels do not halve them, they are the
        # kernel's own round-off.
        if tail <= SUM_ROUNDING or (tail <= SKELETON.max_error and tail > 0.5 * before):
            return found
        step, before = 0.5 * step, tail


@record
class Panels(Kept):
    """Panels of equal length that cover all sources, for fast sums of a smooth kernel.

    Panel p is the interval from origin + p step to origin + (p + 1) step, for p = first ... first +
    count - 1. farthest: largest lag between panels for which the kernel is tabulated.
    """

    kernel: Kernel
    step: float
    origin: float
    first: int
    count: int
    farthest: int

    def modes(self, half: Array) -> Index:
        """Number of Chebyshev modes that resolve the kernel on zones of the half widths `half`.

        The number suffices both for the field on a zone and for the effect of a zone's density.
        """
        # The kernel's Chebyshev series on a panel decays to round-off within TERMS terms. So the
        # kernel has no singularity closer to the real line than `reach`.
        reach = 0.5 * self.step * math.sinh(-math.log(SUM_ROUNDING) / TERMS)
        fall = np.arcsinh(reach / half)
        return np.asarray(np.ceil(-math.log(SUM_ROUNDING) / fall), dtype=np.intp) + 2

    @cached_property
    def tail(self) -> float:
        """Largest last coefficient of the kernel's series on panels, relative to the largest one.
        The series are Chebyshev series in x and xi.

        Neighbouring panels are sampled first, and all others only if these coefficients have
        decayed.
        """
        largest = _tail(self._neighbour_coefficients())
        return (
            _tail(self._table(False).reshape(-1, TERMS, TERMS))
            if largest <= SKELETON.max_error
            else largest
        )

    def _neighbour_coefficients(self) -> Array:
        """Chebyshev coefficients K^(d) of the kernel between neighbouring panels (d = -1, 0, 1).
        d is the distance of the two panels, counted in panels.
        """
        return self._made(False, -min(1, self.farthest), min(1, self.farthest) + 1)

    def _made(self, potential: bool, low: int, high: int) -> Array:
        """Chebyshev coefficients K^(d) of the kernel between panels at distances low <= d < high.
        Distances are counted in panels.
        """
        nodes = 0.5 * self.step * chebyshev.gauss(TERMS)
        out = np.empty((high - low, TERMS, TERMS))
        with np.errstate(all="ignore"):  # values may overflow while panels are too long
            for start in range(low, high, SUMS.cache_pairs // TERMS):
                lags = np.arange(start, min(start + SUMS.cache_pairs // TERMS, high))
                # The source is on panel 0 if the distance d >= 0, and the target is on panel 0 if d
                # < 0. So both panel numbers lie between 0 and |d|. Without a period, |d| is below
                # the number of panels. So the kernel is not called outside the panels, where it
                # may be undefined.
                target, source = np.maximum(lags, 0)[:, None], np.maximum(-lags, 0)[:, None]
                out[lags - low] = self._coefficients(
                    potential, self.place(target) + nodes, self.place(source) + nodes
                )
        return out

    def place(self, panel: Index) -> Array:
        """Positions x of the middles of panels with the given numbers; panel 0 is the first one."""
        return np.asarray(self.origin + (self.first + panel + 0.5) * self.step)

    def _coefficients(self, potential: bool, x: Array, xi: Array) -> Array:
        """Matrices K^(d) of pairs of panels: the kernel's Chebyshev coefficients in x and xi.

        d: distance between the two panels, counted in panels. x: nodes (n, TERMS) of n target
        panels; xi: those of n source panels, or of one.
        """
        function, to_series = (
            self.kernel.regular_potential if potential else self.kernel.regular,
            chebyshev.to_series(TERMS),
        )
        if function is None:
            raise ValueError(
                "a condition on potentials needs the potential of the regular kernel: "
                "sie.Smooth(value, potential)"
            )
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
        """Chebyshev coefficients K^(d) of the kernel between panels, for all tabulated distances d.
        Distances are counted in panels.
        """
        return self._made(potential, -self.farthest, self.farthest + 1)

    def _series(self, moments: Array, low: int, high: int, potential: bool) -> Array:
        """Chebyshev series of the field on panels `low` to `high`, from moments of the sources.
        The shape is (panels, TERMS, n).

        The series are a convolution of the matrices K^(d) and the moments, computed by FFT.
        """
        kernel, length = self._waves(potential, low, high)
        moments = moments.reshape(self.count, TERMS, -1)
        waves = np.matmul(kernel, fft.rfft(moments, length, axis=0))
        return np.asarray(fft.irfft(waves, length, axis=0)[: high - low + 1])

    def _waves(self, potential: bool, low: int, high: int) -> tuple[Complex, int]:
        """(Fourier transform of K^(d) over the distance d of panels, length of this transform).
        K^(d) is the matrix of Chebyshev coefficients of the kernel between two panels.

        The lags are those from the sources to the panels low ... high.
        """
        key = potential, low, high
        if key not in self._transforms:
            wanted = high - low + 1
            length = int(fft.next_fast_len(wanted + self.count - 1, real=True))
            lag = np.arange(1 - self.count, wanted)
            kernel = np.zeros((length, TERMS, TERMS))
            kernel[lag % length] = self._table(potential)[lag + low - self.first + self.farthest]
            # Only the last Fourier transform of the kernel is stored, and the last one of its
            # potential. That is enough for repeated sums over the same zones.
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
        """Number of moments of all panels together: `TERMS` moments for each panel."""
        return self.count * TERMS

    def spread(self, x: Array) -> Spread:
        """The points x, each with the number of the panel that contains the point."""
        return Spread.of(self, x)

    def moments(self, spread: Any, weights: Array) -> Array:
        """The moments of sources at n points, for all panels: shape (count * TERMS, ...).

        weights: strengths of the sources (n, ...).
        """
        shape = weights.shape[1:]
        out = np.zeros((self.count, TERMS, *shape))
        for panel, here in spread.groups:
            out[panel - self.first] = np.tensordot(spread.table[here], weights[here], axes=(0, 0))
        return out.reshape(self.count * TERMS, *shape)

    def at(self, spread: Any, moments: Array, potential: bool) -> Array:
        """Transform or potential at n points, from the moments of sources on all panels.
        The moments have the shape (count * TERMS, ...), the result has the shape (n, ...).
        """
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
        """Transform or potential at points too far from the panels for the table of the kernel.
        The kernel is called directly.
        """
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
                max_rows=max(1, SUMS.cache_pairs * TERMS // len(nodes)),
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
    """Points on panels, with the values of the panel's Chebyshev polynomials at each point.

    x: the points (n,); table: T_k at each of them (n, TERMS); groups: (panel, indices of its
    points) of each panel with points.
    """

    x: Array
    table: Array
    groups: list[tuple[int, Index]]

    @classmethod
    def of(cls, panels: Panels, x: Array) -> Spread:
        place = (x - panels.origin) / panels.step
        panel = np.floor(place)
        # The right end of the last panel belongs to this panel. `floor` counts it to a next panel,
        # which does not exist.
        last = panels.first + panels.count - 1
        panel = np.where((panel == last + 1) & (place - panel < HALF_DIGITS), last, panel)
        theta = np.arccos(np.clip(2 * (place - panel) - 1, -1.0, 1.0))
        table = np.cos(theta[:, None] * np.arange(TERMS))
        order = np.argsort(panel, kind="stable")
        starts = np.flatnonzero(np.diff(panel[order], prepend=np.nan) != 0)
        parts = np.split(order, starts[1:]) if len(x) else []
        return cls(x, table, [(int(panel[part[0]]), part) for part in parts])
