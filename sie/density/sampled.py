"""The series of a density that is given as a function of x, sampled on its zones.

On a zone, t runs from -1 to 1. At a distance d from an end, the density is
K / sqrt(d) + A sqrt(d) + ... So the density times X = sqrt(1 - t^2) is a smooth function of t, and
its series in Chebyshev polynomials T_j converges fast. Its coefficients are those of `sie.Density`.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sie.basis import chebyshev, inputs
from sie.basis.data import Array, widened
from sie.basis.interval import root_weight
from sie.basis.weight import needs_half
from sie.basis.zones import Zones


@dataclass(frozen=True)
class SamplingOptions:
    """Numbers of nodes of a given function on a zone, and limits of the checks of its series."""

    # First number of sampling nodes on a zone. Right sides are first sampled at as many nodes
    # (`sie.dense.modes`).
    first_nodes: int = 16
    # Largest number of sampling nodes on a zone. Right sides have the same limit.
    max_nodes: int = 8192
    # Number of points of a zone, none of them a node, at which the series is compared with the
    # function. The residual of an equation is sampled at as many points (`sie.states.state`).
    check_points: int = 15
    # Largest accepted deviation of the series from the given function, in units of the tolerance.
    # It is tested at the check points and at ends of prescribed intensity. A deviation sums some
    # hundred coefficients, each with an error within the tolerance.
    margin: float = 100.0
    # Distance from an end, in half widths, at which the exponent of the function is measured. The
    # next term of the expansion at the end changes the exponent by about this distance.
    end_distance: float = 1e-4
    # The exponent measured at an end may deviate by this much from -1/2, 1/2, 3/2, ... A larger
    # deviation is reported. The limit is 200 times the effect of the next term of the expansion at
    # the end (see `end_distance`).
    exponent_deviation: float = 0.02


OPTIONS = SamplingOptions()
# Angles of the points at which the series is compared with the function. None of these points is a
# node.
_THETA = (np.arange(OPTIONS.check_points) + 0.4142) * np.pi / OPTIONS.check_points


@dataclass(frozen=True)
class _Sampled:
    """A density that is given as a function f, on one of the zones."""

    f: Callable[[Array], Array]
    zones: Zones
    zone: int

    def place(self, left: Array, right: Array) -> Array:
        """Positions x of points given by their distances from both zone ends, in half widths."""
        w = self.zones.half[self.zone]
        return np.where(
            left < right, self.zones.a[self.zone] + w * left, self.zones.b[self.zone] - w * right
        )

    def at(self, x: Array) -> Array:
        """Values of f at points x (n,) inside the zone.
        Raises ValueError if they are not finite real numbers, one for each point.
        """
        with np.errstate(all="ignore"):
            given = np.asarray(self.f(x))
        if given.dtype.kind not in "fiub":
            raise ValueError(
                f"the density must be a function with real values, got {given.dtype} for an array"
            )
        if given.shape != x.shape:
            raise ValueError(
                f"the density must return an array of shape {x.shape} for x of shape {x.shape}, "
                f"got shape {given.shape}"
            )
        values = np.asarray(given, dtype=float)
        if not np.isfinite(values).all():
            raise ValueError(
                f"the density is not finite at x = {x[~np.isfinite(values)][0]:.6g}, inside zone "
                f"{self.zone} (counted from 0)"
            )
        return values

    def weighted(self, left: Array, right: Array) -> Array:
        """Values of X f with X = sqrt(1 - t^2), at distances from both ends in half widths.

        X is computed from the distances of the rounded x. So the round-off of x near a singular end
        leaves X f nearly unchanged.
        """
        x, zone = self.place(left, right), np.full(len(left), self.zone)
        w = self.zones.half[self.zone]
        return self.at(x) * root_weight(
            self.zones.beyond_a(x, zone) / w, self.zones.before_b(x, zone) / w
        )

    def series(self, tol: float) -> Array:
        """Chebyshev coefficients of sqrt(1 - t^2) f, to the relative tolerance `tol`.

        Raises ValueError if they do not decay to it.
        """
        n = OPTIONS.first_nodes
        check = 2 * np.cos(_THETA / 2) ** 2, 2 * np.sin(_THETA / 2) ** 2
        between = self.weighted(*check)
        while True:
            c = 2 * chebyshev.t_means(self.weighted(*chebyshev.gauss_sides(n)))
            c[0] *= 0.5
            size = float(np.abs(c).max())
            missing = float(np.abs(c[-max(4, n // 8) :]).max())
            deviation = np.abs(np.cos(_THETA[:, None] * np.arange(n)) @ c - between).max()
            size = max(size, float(np.abs(between).max()))
            if missing <= tol * size and deviation <= OPTIONS.margin * tol * size:
                return np.asarray(c)
            if n >= OPTIONS.max_nodes:
                raise ValueError(self._reason(n, missing / size, tol))
            n *= 2

    def _reason(self, n: int, reached: float, tol: float) -> str:
        """Message that says why the Chebyshev series of f does not decay to the tolerance."""
        found = (
            f"the density is not resolved on zone {self.zone} (counted from 0): with {n} nodes its "
            f"last coefficients are {reached:.1e} of the largest, above the tol {tol:.1e}"
        )
        for side in ("left", "right"):
            exponent = self._exponent(side)
            if abs(exponent % 1.0 - 0.5) > OPTIONS.exponent_deviation:
                return (
                    f"{found}; near the {side} end it varies as d^{exponent:.2f} with the distance "
                    "d, but must vary as d^(-1/2) or d^(1/2)"
                )
        return (
            f"{found}; it has a jump, a kink or a singularity on or close to the zone, or noise: "
            "end the zone at this point, or use a larger tol"
        )

    def _exponent(self, side: str) -> float:
        """Exponent with which f varies between two points near an end; 1/2 if f is 0 at a point."""
        d = OPTIONS.end_distance * np.array([1.0, 4.0])
        near, far = np.abs(self.at(self.place(*((d, 2 - d) if side == "left" else (2 - d, d)))))
        return math.log(far / near, 4.0) if min(near, far) > 0.0 else 0.5


def series_of(
    f: Callable[[Array], Array], zones: Zones, tol: float
) -> tuple[Array, tuple[Array, Array]]:
    """Chebyshev series of the density f on each zone, and its unbounded part.
    The result is (coefficients (Z, n) of T_j / X, (alpha, beta)), with Chebyshev polynomials T_j.

    X is sqrt(1 - t^2). The unbounded part is (alpha + beta t) / X, see `Series.singular`. It has
    the intensities that the kinds of ends prescribe.
    """
    inputs.function("the density", f)
    if not isinstance(zones, Zones):
        raise ValueError(f"the zones must be sie.Zones, got {type(zones).__name__}")
    if not (inputs.is_number(tol) and 0 < tol < 1):
        raise ValueError(f"tol must be a number between 0 and 1, got {inputs.shown(tol)}")
    needs_half(zones.weight, "densities given as functions")
    rows = [_Sampled(f, zones, i).series(tol) for i in range(len(zones))]
    width = max(len(row) for row in rows)
    table = np.concatenate([widened(row[None], width) for row in rows])
    alpha, beta = chebyshev.edge_part(table)
    edges = np.array([alpha - beta, alpha + beta])
    asked = zones.intensities / zones.edge_scale
    size = np.abs(table).max(axis=1)
    wrong = np.abs(edges - asked) > OPTIONS.margin * tol * size
    if wrong.any():
        side, zone = np.argwhere(wrong)[0]
        k = zones.edge_scale[zone] * edges[side, zone]
        raise ValueError(
            f"zone {zone} (counted from 0): its {('left', 'right')[side]} end has the prescribed "
            f"intensity {zones.intensities[side, zone]:.6g}, but near it the density is {k:.6g} / "
            "sqrt(d) with the distance d; declare this end sie.SINGULAR"
        )
    edges = np.where(np.isnan(asked), edges, asked)
    return table, (0.5 * (edges[0] + edges[1]), 0.5 * (edges[1] - edges[0]))
