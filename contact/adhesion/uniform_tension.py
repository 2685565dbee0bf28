r"""A uniform tension on given intervals, and the deformation of the profile by it.

The tension s changes the profile's slope by s T and its height by s V, with V' = T and

    T = (1/pi) sum [Lambda(x - l) - Lambda(x - r)] over the intervals (l, r) of tension,

where Lambda is the potential of the kernel K: the displacement due to a line load.

V follows from the second antiderivative of the kernel K: y (ln|y| - 1) for a pole, and Clausen's
integral -(L/2 pi) Cl_2(2 pi y/L) with a period (DLMF 25.12.9).
"""

from collections.abc import Callable
from functools import cached_property

import numpy as np

import sie
from contact.adhesion.end_sums import Cells, EndSum
from contact.adhesion.spread_end import PANEL_NODES, SpreadEnd, line_load
from contact.formulation.conjugate import clausen2
from contact.formulation.quadrature import gauss
from contact.formulation.tables import located
from sie import Array, Complex, Index, Mask, nearest_image, record, wrapped

# Number of quadrature panels on the length over which the kernel's regular part varies. This
# length is at most `kernel.length`.
_PANELS_PER_LENGTH = 4.0


@record
class UniformTension(sie.Kept):
    """A uniform tension on intervals; all quantities are scaled.

    table: the intervals (m, 2), ascending; everywhere: whether the tension acts on the whole
    period; plain: whether the kernel has no regular part; compression: minus the change of the
    height by a unit tension on the whole period; spread: the zones pinned at the left and at the
    right corner, over which the first and the last end of all intervals are spread.
    """

    stress: float
    table: Array
    kernel: sie.Kernel
    plain: bool
    everywhere: bool = False
    compression: float = 0.0
    spread: tuple[SpreadEnd | None, SpreadEnd | None] = (None, None)

    @property
    def period(self) -> float | None:
        return self.kernel.period

    @property
    def spreads(self) -> list[tuple[int, SpreadEnd]]:
        """For each gradual end of the tension: (0 for the first end, -1 for the last; `SpreadEnd`).
        At a gradual end the tension fades out over a zone that is pinned at a sharp corner.
        """
        return [
            (end, zone) for end, zone in zip((0, -1), self.spread, strict=True) if zone is not None
        ]

    @property
    def width(self) -> float:
        """Total width of the intervals of tension."""
        if self.everywhere:
            assert self.period is not None
            return self.period
        return float(np.diff(self.table, axis=1).sum())

    @property
    def total(self) -> float:
        """Total force of the tension: the integral of q - p (contact minus true pressure)."""
        return self.stress * (self.width - sum(zone.half for _, zone in self.spreads))

    def lacks(self, zone: Index | int, last: int, left: Array, right: Array) -> Array:
        """1 minus the local fraction eta of the tension, at points of the zones.

        left, right: distances from the ends of the zone, divided by the zone's half width. last:
        index of the last zone.
        """
        out = np.zeros(np.broadcast_shapes(np.shape(zone), np.shape(left)))
        for end, _ in self.spreads:
            at, far, near = (last, right, left) if end else (0, left, right)
            angle = (
                2
                / np.pi
                * np.arctan2(np.sqrt(np.maximum(near, 0.0)), np.sqrt(np.maximum(far, 0.0)))
            )
            out = out + np.where(np.asarray(zone) == at, angle, 0.0)
        return out

    def share(self, x: Array) -> Array:
        """Local fraction eta of the tension at points x: 1 in intervals of tension, 0 outside.
        Over zones that are pinned at sharp corners, eta falls gradually from 1 to 0.
        """
        out = self.holds(x).astype(float)
        for end, zone in self.spreads:
            t = nearest_image(x - zone.middle, 0.0, self.period) / zone.half
            angle = np.arccos(np.clip(-t if end else t, -1.0, 1.0)) / np.pi
            out -= np.where(np.abs(t) <= 1.0, angle, 0.0)
        return out

    def holds(self, x: Array) -> Mask:
        """Whether points lie in an interval of tension."""
        if self.everywhere:
            return np.ones(np.shape(x), dtype=bool)
        if len(self.table) == 0:
            return np.zeros(np.shape(x), dtype=bool)
        x = wrapped(np.asarray(x, dtype=float), float(self.table[0, 0]), self.period)
        i = located(self.table, x)[0]
        return np.asarray((x >= self.table[i, 0]) & (x <= self.table[i, 1]))

    def slope(self, x: Array) -> Array:
        """Change of the profile's slope by the tension, at points x."""
        if self.everywhere:
            return np.zeros(np.shape(x))
        return self.stress / np.pi * self._sum_over_intervals(self._log_sum, self._spread_log, x)

    def height(self, x: Array) -> Array:
        """Change of the profile's height by the tension, at points x."""
        if self.everywhere:
            return np.full(np.shape(x), -self.stress * self.compression)
        out = self._sum_over_intervals(self._primitive_sum, self._spread_primitive, x)
        if not self.plain and len(self.table):
            out += self._regular(np.asarray(x, dtype=float))
        return self.stress / np.pi * out

    def in_plane(self, z: Complex) -> tuple[Complex, Complex]:
        """(transform of the tension, derivative of the transform) at scaled points z, Im z >= 0."""
        flat = np.ravel(z)
        value: Complex = np.zeros(len(flat), dtype=complex)
        slope: Complex = np.zeros(len(flat), dtype=complex)
        if self.everywhere:
            value -= 1j * np.pi
        block = max(1, 2**18 // max(1, self.table.size))
        for start in range(0, 0 if self.everywhere else len(flat), block):
            here = slice(start, start + block)
            logs, rates = line_load(flat[here, None] - self.table.ravel(), self.period)
            value[here], slope[here] = logs @ self._signs, rates @ self._signs
        for end, zone in self.spreads:
            log, rate = zone.in_plane(flat, self.period)
            value, slope = (value - log, slope - rate) if end else (value + log, slope + rate)
        factor = self.stress / np.pi
        return factor * value.reshape(np.shape(z)), factor * slope.reshape(np.shape(z))

    def logs(self, x: Array) -> Array:
        """Potentials Lambda (P, 2 m) at points x (P,) of a unit line load at each interval end."""
        values = self.log(x[:, None] - self.table.ravel())
        for end, zone in self.spreads:
            values[:, end] = self._spread_log(x, zone)
        return np.hstack((values[:, ::2], values[:, 1::2]))

    @cached_property
    def _log_sum(self) -> EndSum:
        return EndSum(self._cells, self._signs, self.log)

    @cached_property
    def _primitive_sum(self) -> EndSum:
        return EndSum(self._cells, self._signs, self._primitive)

    @cached_property
    def _cells(self) -> Cells:
        return Cells(
            self.table.ravel(),
            self.period,
            np.inf if self.plain else self.kernel.length / _PANELS_PER_LENGTH,
        )

    @cached_property
    def _signs(self) -> Array:
        """Sign of each end in sums: 1 for left and -1 for right ends, 0 for gradual ends.
        Gradual ends (`spreads`) are added separately.
        """
        signs = np.tile((1.0, -1.0), len(self.table))
        signs[[end for end, _ in self.spreads]] = 0.0
        return signs

    def _sum_over_intervals(
        self, of_ends: EndSum, spread: Callable[[Array, SpreadEnd], Array], x: Array
    ) -> Array:
        """Sum over all intervals: a function of the left end minus this function of the right end.

        of_ends: this sum over abrupt ends. spread: the function for a gradual end.
        """
        x = np.asarray(x, dtype=float)
        out = of_ends(x) if len(self.table) else np.zeros(x.shape)
        for end, zone in self.spreads:
            one = spread(x.ravel(), zone).reshape(x.shape)
            out = out - one if end else out + one
        return out

    def _spread_log(self, x: Array, zone: SpreadEnd) -> Array:
        if self.period is not None:
            out = zone.periodic_potential(x, self.period)
        else:
            out = sum(
                (
                    zone.potential(x - pole) - np.log(self.kernel.datum)
                    for pole in self.kernel.poles
                ),
                np.zeros(x.shape),
            )
        return (
            out
            if self.plain
            else out + zone.mean(self._regular_log, nearest_image(x, zone.middle, self.period))
        )

    def _spread_primitive(self, x: Array, zone: SpreadEnd) -> Array:
        if self.period is not None:
            return zone.periodic_primitive(x, self.period, self._primitive)
        scale = np.log(self.kernel.datum)
        return sum(
            (
                zone.primitive(x - pole) - scale * (x - pole - zone.middle)
                for pole in self.kernel.poles
            ),
            np.zeros(x.shape),
        )

    def log(self, lag: Array) -> Array:
        """The kernel's potential Lambda as a function of the distance from a line load."""
        kernel, period = self.kernel, self.period
        lag = nearest_image(np.asarray(lag, dtype=float), 0.0, period)
        with np.errstate(divide="ignore"):
            if period is not None:
                out = np.log(np.abs(2 * np.sin(np.pi * lag / period)))
            else:
                out = sum(
                    (np.log(np.abs(lag - pole) / kernel.datum) for pole in kernel.poles),
                    np.zeros(np.shape(lag)),
                )
        return np.asarray(out if self.plain else out + self._regular_log(lag))

    def _regular_log(self, lag: Array) -> Array:
        """The potential Lambda without its singular part (poles, or the Hilbert kernel)."""
        whole = self.kernel.regular_potential
        assert whole is not None
        rest = whole(lag, np.zeros(1))
        if (
            self.period is not None
            and (hilbert := sie.hilbert(self.period).regular_potential) is not None
        ):
            rest = rest - hilbert(lag, np.zeros(1))
        return np.asarray(rest)

    def _primitive(self, lag: Array) -> Array:
        """Antiderivative of the singular part (poles, or Hilbert kernel) of Lambda."""
        if self.period is not None:
            turns = np.asarray(lag) / self.period
            return -self.period / (2 * np.pi) * clausen2(turns - np.round(turns))
        out = np.zeros(np.shape(lag))
        for pole in self.kernel.poles:
            away = np.asarray(lag - pole, dtype=float)
            out += away * (np.log(np.maximum(np.abs(away), 1e-300) / self.kernel.datum) - 1.0)
        return out

    def _regular(self, x: Array) -> Array:
        """Integral, over the intervals of tension, of the regular part of the potential Lambda.
        It is computed by Gauss quadrature.
        """
        at, weights = self._panels
        flat, out = x.ravel(), np.zeros(x.size)
        block = max(1, 2**20 // len(at))
        for start in range(0, len(flat), block):
            lag = nearest_image(flat[start : start + block, None] - at, 0.0, self.period)
            out[start : start + block] = self._regular_log(lag) @ weights
        return out.reshape(x.shape)

    @cached_property
    def _panels(self) -> tuple[Array, Array]:
        length = min(self.kernel.length, 1.0 if self.period is None else 0.25 * self.period)
        per_unit = _PANELS_PER_LENGTH / length
        rules = [
            gauss(np.linspace(a, b, int(np.ceil(per_unit * (b - a))) + 1), PANEL_NODES)
            for a, b in self.table
        ]
        for end, zone in self.spreads:
            places, lacking = zone.lacking(end, int(np.ceil(per_unit * 2 * zone.half)), np.zeros(0))
            rules.append((places, -lacking))
        at, weights = zip(*rules, strict=True)
        return np.concatenate(at), np.concatenate(weights)
