r"""Frictionless contact of an elastic body on a uniform grid, to find the number of zones.

On n points with spacing h (one period, or a window of an isolated contact) find the pressure with

    p >= 0,   gap = S p + f - level >= 0,   p * gap = 0,   sum p h = load  (or a given level),

where f are the heights. The operator S gives the displacement u = S p. With the reduced modulus E
and the Fourier coefficients u_k and p_k,

    periodic:  u_k = 2 p_k / (E |k|), k = 2 pi j / (n h), u_0 = 0,
    isolated:  u(x) = -(2 / (pi E)) int p(xi) ln(|x - xi| / d) dxi, p constant on a cell.

These formulas are for half-planes. For other bodies u_k is multiplied by their symbol, and
u_0 = 2 p_0 c / E with their compression c. Other isolated bodies add to the kernel a smooth
function `rest` of the lag x - xi and the width of a cell.

The problem is that of Polonsky & Keer (1999), Wear 231, 206-219, doi 10.1016/S0043-1648(99)00113-1,
and the method here, like that of the paper, is a conjugate gradient with FFTs. Two things differ,
so that the number of iterations does not grow with n:

* The contact set changes between linear solves, not within them: points in tension are dropped,
  points that interpenetrate are added. The inverse of S is an M-matrix (its off-diagonals are
  (cos(pi m) - 1) / m^2 <= 0), for which this semismooth Newton iteration converges from any start:
  Hintermueller, Ito & Kunisch (2002), SIAM J. Optim. 13, 865-888, doi 10.1137/S1052623401383558. A
  wrong end of the contact moves in each solve by a fixed fraction of its error, so that about
  log2(n) solves suffice.
* On a contact set the gradient is preconditioned by B' D B. D = E|k|/2, B interpolates the
  displacement linearly across the gaps, and B' is the transpose of B. The exact inverse of S has
  the same form, with the extension of least energy in place of B. Therefore the condition number is
  bounded, up to logarithms, for any number of zones. B maps constants to constants, so that B' D B
  does not change the load.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import scipy.fft
from numpy.typing import ArrayLike, NDArray

from contact.errors import OutOfRange
from contact.formulation.tolerances import TOLERANCES
from contact.model.profiles.noise import EPS
from contact.search.grid.fourier import FourierMultiplier, FourierTable
from sie import Array, Index, Mask, record

Rest = Callable[[Array, float], Array]
Symbol = Callable[[Array], Array]


@dataclass(frozen=True)
class GridOptions:
    """Tolerances and limits of the linear solves; after each solve the contact set is corrected."""

    # A linear solve ends after this many iterations in which the error has not decreased by a
    # tenth. The error has then reached the rounding of the heights f.
    max_stalled: int = 60
    # Tolerance of the first linear solve. Each more precise solve has this number times the
    # previous tolerance, but not less than the wanted tolerance. While many points still join or
    # leave the contact, a precise pressure would be wasted.
    first_tolerance: float = 1e-2
    # If the pressure has a largest value (the cap), the iteration ends after more than this many
    # successive solves in which the number of changed points reaches no new minimum. The ends of
    # the contacts, and of the intervals at the cap, are then known to one cell. A first guess needs
    # no more.
    max_repeats: int = 8

    @property
    def fine_tolerance(self) -> float:
        """Tolerance of the finest grid of a first guess, and of rates by load and by tilt.

        The rates are d level / d load, where the level is displacement plus height in contact, and
        d moment / d tilt. From a first guess with a smaller tolerance, Newton's method would need
        as many steps.
        """
        return self.first_tolerance**2


OPTIONS = GridOptions()


class LevelOfFullGrid(OutOfRange):
    """Raised if the given level (displacement plus height in contact) is that of full contact.

    The profile itself may still have a gap, as the mean height of a grid is not that of the
    profile.
    """


_AS_GOOD_AS_FULL = (
    "the approach equals the mean of the profile within the accuracy of a grid: contact is full or "
    "almost full; give a load, a mean pressure or a contact fraction"
)


@record
class Influence:
    """The elastic operator S on one grid: `apply(p)` is the displacement under the pressure p.

    The class methods `periodic` and `isolated` construct it.
    """

    n: int
    h: float
    E: float
    is_periodic: bool
    _compliance: Array = field(repr=False, compare=False)  # S in Fourier space on the padded grid
    stiffness: Array = field(repr=False, compare=False)  # D = E|k|/2 on the padded grid
    # Constant displacement per unit of load, from the term ln(h / datum) of the kernel. It is added
    # after the FFT, so that the displacement keeps its digits.
    _offset: float = 0.0
    cap: float = math.inf  # largest pressure that the surface bears

    @classmethod
    def periodic(
        cls, n: int, h: float, E: float, symbol: Symbol | None = None, compression: float = 0.0
    ) -> Influence:
        """The operator S of a body on one period of n points with spacing h."""
        stiffness = _wave_stiffness(n, h, E)
        if symbol is not None:
            stiffness[1:] /= symbol(
                np.asarray(2.0 * np.pi / (n * h) * np.arange(1, n // 2 + 1), dtype=np.float64)
            )
        return cls(n, h, E, True, _inverse(stiffness, 2.0 * compression / E), stiffness)

    @property
    def uniform_compliance(self) -> float:
        """Displacement caused by a uniform pressure of 1 on the period; 0 without a period."""
        return float(self._compliance[0]) if self.is_periodic else 0.0

    @classmethod
    def isolated(
        cls, n: int, h: float, E: float, datum: float = 1.0, rest: Rest | None = None
    ) -> Influence:
        """The operator S of a single body on a search interval (window) of n points, spacing h."""
        lag = np.arange(n + 1.0)
        kernel = _log_cell(lag)
        if rest is not None:
            kernel = kernel + rest(np.asarray(h * lag), h)
        circulant = np.concatenate((kernel, kernel[n - 1 : 0 : -1]))
        scale = -2.0 / (np.pi * E)
        compliance = scale * h * scipy.fft.rfft(circulant).real
        offset = scale * np.log(h / datum)
        return cls(n, h, E, False, compliance, _wave_stiffness(2 * n, h, E), float(offset))

    @cached_property
    def table(self) -> FourierTable:
        """Table for the transforms of all padded points, in double precision."""
        return FourierTable(self.size)

    @cached_property
    def _in_double_precision(self) -> FourierMultiplier:
        return FourierMultiplier(self.table, self._compliance)

    @cached_property
    def _single_table(self) -> FourierTable:
        return FourierTable(self.size, np.float32)

    @cached_property
    def single_compliance(self) -> _SinglePrecision:
        """The operator S up to a constant, in single precision, on all padded points.
        The error of the displacement is 1e-6 of its largest value.
        """
        return _SinglePrecision(self._single_table, self._compliance)

    @cached_property
    def single_stiffness(self) -> _SinglePrecision:
        """The operator D (displacement to pressure) in single precision, on all padded points."""
        return _SinglePrecision(self._single_table, self.stiffness)

    @property
    def size(self) -> int:
        """Length of the FFT: n on a period; 2 n for a single body, padded with zeros."""
        return self.n if self.is_periodic else 2 * self.n

    def response(self, inside: Index, p: Array) -> Array:
        """Displacement at the points `inside`, under the pressure p on these points."""
        full = np.zeros(self.n)
        full[inside] = p
        return self.apply(full)[inside]

    def apply(self, p: ArrayLike) -> Array:
        """Displacement at the grid points under the pressure p on them."""
        pressure = np.asarray(p, dtype=np.float64)
        u = self._in_double_precision(pressure)[: self.n]
        return u + self._offset * (float(pressure.sum()) * self.h) if self._offset else u


@record
class Response:
    """The response of the surface to pressure, from which the operator of any grid is made.

    periodic: the response is given by the `symbol` and the `compression` of the body. If not
    periodic, the body is alone on the line, and its kernel is -2 (ln(|x|/datum) + rest)/(pi E).
    rest: None for a half-plane. cap: largest pressure that the surface bears.
    """

    E: float
    periodic: bool = True
    datum: float = 1.0
    rest: Rest | None = None
    symbol: Symbol | None = None
    compression: float = 0.0
    cap: float = math.inf

    def on(self, n: int, h: float) -> Influence:
        """The operator from pressure to displacement on a grid of n cells of width h."""
        if self.periodic:
            made = Influence.periodic(n, h, self.E, self.symbol, self.compression)
        else:
            made = Influence.isolated(n, h, self.E, self.datum, self.rest)
        return made if self.cap == math.inf else replace(made, cap=self.cap)


def _dot(a: Array, b: Array) -> float:
    """The dot product of a and b, computed by one thread.

    The threads of BLAS may wait for each other a thousand times as long as the sum takes.
    """
    return float(np.einsum("i,i", a, b))


class _SinglePrecision:
    """Multiplication by `factors` in Fourier space, in single precision: it saves half of the time.

    Factors and values are divided by their largest numbers, so that single precision holds them in
    any units.
    """

    def __init__(self, table: FourierTable, factors: Array) -> None:
        self.size, self.largest = table.size, float(np.abs(factors).max())
        self.factors = FourierMultiplier(table, factors / self.largest)

    def scaled(self, values: Array) -> tuple[NDArray[np.float32], float]:
        """(values divided by their largest absolute value, scale).
        The products of the values are those of the divided values, times the scale.
        """
        unit = float(np.abs(values).max()) or 1.0
        return (values / unit).astype(np.float32), unit * self.largest

    def response(self, inside: Index, values: Array) -> Array:
        """The products at the points `inside`, if the values are given there and zero elsewhere."""
        scaled, scale = self.scaled(values)
        full = np.zeros(self.size, dtype=np.float32)
        full[inside] = scaled
        return np.asarray(self.factors(full)[inside] * np.float64(scale))


def _wave_stiffness(n: int, h: float, E: float) -> Array:
    """Stiffness E |k| / 2 of each wave with wave number k in a period of n cells."""
    return np.asarray(0.5 * E * (2.0 * np.pi / (n * h)) * np.arange(n // 2 + 1), dtype=np.float64)


def _inverse(stiffness: Array, mean: float = 0.0) -> Array:
    """Compliance of each wave: 1 / stiffness. mean: compliance under a uniform pressure."""
    return np.concatenate(([mean], 1.0 / stiffness[1:]))


def _log_cell(m: Array) -> Array:
    """The integral of ln|m - t| over t from -1/2 to 1/2, for integers m.

    For large m the antiderivative would cancel, so that log1p is used.
    """
    a = np.abs(m)
    far = np.maximum(a, 1.0)
    r = 0.5 / far
    value = np.log(far) - 1.0 + (far + 0.5) * np.log1p(r) - (far - 0.5) * np.log1p(-r)
    near = a < 1.0
    if np.any(near):
        s = np.stack((0.5 + a[near], 0.5 - a[near]))
        value[near] = np.sum(s * np.log(np.maximum(np.abs(s), 1e-300)), axis=0) - 1.0
    return np.asarray(value, dtype=np.float64)


def own_displacement(lag: Array, h: float, E: float) -> Array:
    """Displacement, `lag` cells from a cell of width h, by a pressure of 1 on this cell alone.

    It is that of a half-plane, up to a constant.
    """
    return np.asarray(-2.0 * h / (np.pi * E) * _log_cell(lag))


class _Extension:
    """The map B that extends displacements on the contact set to the grid, linearly across gaps.

    Points are counted from the first one in contact. `along` is the position of a point between two
    successive points in contact, from 0 to 1.
    """

    def __init__(self, influence: Influence, inside: Index) -> None:
        self.size = influence.size
        self.stiffness = influence.single_stiffness
        self.starts = inside - inside[0]
        self.lengths = np.diff(self.starts, append=self.size)
        # Indices of the next and of the previous point in contact. Every iteration needs them, and
        # `np.roll` takes several times as long as indexing.
        count = len(inside)
        self.next, self.last = (np.arange(1, count + 1) % count, np.arange(-1, count - 1) % count)
        along = np.arange(self.size) - np.repeat(self.starts, self.lengths)
        self.along = np.divide(along, np.repeat(self.lengths, self.lengths), dtype=np.float32)

    def precondition(self, residual: Array) -> Array:
        """An approximate inverse of the operator S, applied to a residual on the contact set.

        It is B' D B (head of this module). The mean of the result is subtracted.
        """
        scaled, scale = self.stiffness.scaled(residual)
        v = np.repeat(scaled[self.next] - scaled, self.lengths)
        v *= self.along
        v += np.repeat(scaled, self.lengths)
        q = self.stiffness.factors(v).astype(np.float64)
        z = np.add.reduceat(q, self.starts)
        q *= self.along
        to_next = np.add.reduceat(q, self.starts)
        z += to_next[self.last] - to_next
        z *= scale
        return np.asarray(z - z.mean())


@record
class GridState:
    """A contact on the grid. iterations: number of conjugate gradient iterations that it took."""

    pressure: Array
    gap: Array
    level: float
    load: float
    iterations: int
    converged: bool
    f: Array = field(repr=False)
    influence: Influence = field(repr=False)
    compliance: float | None = None  # d level / d load, known under level control

    @property
    def contact(self) -> Mask:
        """Mask of the grid points in contact."""
        return np.asarray(self.pressure > 0.0)

    @property
    def capped(self) -> Mask:
        """Mask of the grid points at the largest pressure that the surface bears."""
        return np.asarray(self.pressure >= self.influence.cap)

    @property
    def full(self) -> bool:
        """Whether every point of a period is in contact; false for a single body on a window."""
        return self.influence.is_periodic and bool(np.all(self.pressure > 0.0))

    @property
    def touches_border(self) -> bool:
        """Whether a cell at the border of a lone body's search interval (window) is in contact."""
        return not self.influence.is_periodic and bool(
            self.pressure[0] > 0.0 or self.pressure[-1] > 0.0
        )


def solve_grid(
    f: ArrayLike,
    influence: Influence,
    *,
    load: float | None = None,
    level: float | None = None,
    start: ArrayLike | None = None,
    tol: float = 1e-6,
) -> GridState:
    """The contact of heights f under a given load or level (displacement plus f in contact).

    f: heights, inf at points that never touch. start: a pressure to begin with. Its sum matters
    only under a given level, as the first guess of the load.
    """
    shape = np.asarray(f, dtype=np.float64)
    if shape.shape != (influence.n,):
        raise ValueError(f"f has shape {shape.shape}, the grid has {influence.n} points")
    allowed = np.isfinite(shape)
    if np.any(np.isnan(shape)) or np.any(shape == -np.inf) or not np.any(allowed):
        raise ValueError("f must be finite or +inf, and finite somewhere")
    if (load is None) == (level is None):
        raise ValueError("give exactly one of load and level")
    guess: Array | None = None
    if start is not None:
        positive = np.maximum(np.asarray(start, dtype=np.float64), 0.0)
        guess = np.where(allowed, positive, 0.0) if np.any(positive[allowed] > 0.0) else None
    run = _Run(shape, influence, tol)
    if load is not None:
        if not load > 0.0:
            raise ValueError(f"load must be positive, not {load}")
        return run.at_load(load, guess)
    assert level is not None
    return run.at_level(level, guess)


def turning_rate(state: GridState, x: Array) -> float:
    """Derivative of the moment with respect to the tilt, at fixed load and fixed contact set.

    It is the moment of the pressure under the shape -x. Motions of the ends have no effect at first
    order, as the pressure is zero there.
    """
    run = _Run(np.zeros(len(x)), state.influence, OPTIONS.fine_tolerance)
    pressure = run.conjugate_gradient(
        0.0, state.contact, None, run.tol, -(x - x[state.contact].mean())
    )[0]
    return float(pressure @ x) * state.influence.h


class _Run:
    """One solve with given heights f on a grid, with its tolerance and count of iterations."""

    def __init__(self, f: Array, influence: Influence, tol: float) -> None:
        self.f, self.influence, self.tol = f, influence, tol
        self.allowed: Mask = np.isfinite(f)
        self.lowest = float(np.min(f[self.allowed]))
        # A constant in the heights f only shifts the level (displacement plus height in contact).
        # So the smallest height is subtracted first, and no digits are lost later.
        self.shape = np.where(self.allowed, f - self.lowest, 0.0)
        self.iterations = 0

    def conjugate_gradient(
        self, load: float, mask: Mask, guess: Array | None, tol: float, shape: Array | None = None
    ) -> tuple[Array, Array, float, float, bool]:
        """The pressure p on the points `mask` for which S p + `shape` is constant, at a given load.

        Returns the pressure p, the displacement S p, the constant, the largest error of p as
        estimated by the preconditioner, and whether the tolerance was met.
        """
        shape = self.shape if shape is None else shape
        h = self.influence.h
        if self.influence.is_periodic and np.all(mask):
            return self.full_contact(load, shape)
        inside = np.flatnonzero(mask)
        p = guess[inside] if guess is not None else np.zeros(len(inside))
        total = p.sum() * h
        p = p * (load / total) if total > 0.0 else np.full(len(inside), load / (h * len(inside)))
        full = np.zeros(len(mask))

        full[inside] = p
        u = self.influence.apply(full)
        extension = _Extension(self.influence, inside)
        r = -u[inside] - shape[inside]
        r -= r.mean()
        z = extension.precondition(r)
        direction, rz = z.copy(), _dot(r, z)
        # A rough solution needs few digits, so the response is computed in single precision.
        is_rough = tol >= OPTIONS.fine_tolerance
        apply = self.influence.single_compliance.response if is_rough else self.influence.response
        converged, steps = False, 0
        best, since = np.inf, 0
        while True:
            # The preconditioner B' D B approximates the inverse of the operator S. The
            # preconditioned residual z therefore approximates the error of the pressure.
            size = math.sqrt(_dot(z, z))
            converged = size <= tol * math.sqrt(_dot(p, p)) or rz <= 0.0
            best, since = (size, 0) if size < 0.9 * best else (best, since + 1)
            if converged or since > OPTIONS.max_stalled:
                break
            self.iterations += 1
            steps += 1
            response = apply(inside, direction)
            curvature = _dot(direction, response)
            if not curvature > 0.0:
                break
            alpha = rz / curvature
            p = p + alpha * direction
            r = r - alpha * response
            r -= r.mean()
            z = extension.precondition(r)
            rz, previous = _dot(r, z), rz
            direction = z + (rz / previous) * direction
        if steps:
            full[inside] = p
            u = self.influence.apply(full)
        return (
            full,
            u,
            float(np.mean(u[inside] + shape[inside])),
            float(np.max(np.abs(z))),
            converged,
        )

    def full_contact(self, load: float, shape: Array) -> tuple[Array, Array, float, float, bool]:
        """Full contact on a period in closed form, with the pressure that flattens `shape`.

        With the length L of the period, p = load / L - D shape and u = level - shape.

        The sign of the smallest pressure decides whether there is a gap. An iteration would not
        give this pressure to all digits. Returns the same as `conjugate_gradient`.
        """
        n, h = self.influence.n, self.influence.h
        self.iterations += 1
        mean = float(shape.mean())
        level = mean + self.influence.uniform_compliance * load / (n * h)
        p = load / (n * h) - FourierMultiplier(self.influence.table, self.influence.stiffness)(
            shape - mean
        )
        roundoff = EPS * (
            self.influence.E / h * float(np.max(np.abs(shape - mean))) + load / (n * h)
        )
        return p, level - shape, level, roundoff, True

    def at_load(self, load: float, guess: Array | None) -> GridState:
        """The contact under a given load. guess: a pressure to begin with."""
        # Without a guess, the first contact set is all points that may touch. With a guess, it is
        # the points where the pressure of the guess is positive.
        mask = self.allowed.copy() if guess is None else guess > 0.0
        p, tol = guess, max(self.tol, OPTIONS.first_tolerance)
        converged, cap = False, self.influence.cap
        capped = np.zeros(len(mask), dtype=bool)
        if guess is not None and np.isfinite(cap):
            capped = guess >= cap
            mask &= ~capped
        fewest, repeats = self.influence.n, 0
        # Each solve reduces the error of a zone end by a fixed factor. For n points, about log2(n)
        # solves therefore suffice.
        for _ in range(OPTIONS.max_stalled + int(4 * np.log2(self.influence.n))):
            before = self.iterations
            if not mask.any():
                mask = self._next_to_change(load, capped)
                capped &= ~mask
            p, u, level, error, solved = self._on_sets(load, mask, capped, p, tol)
            finer = max(self.tol, OPTIONS.first_tolerance * tol)
            if self.iterations == before and tol > self.tol:
                # The guess already meets `tol`, but it comes from another grid. So the signs of the
                # gap are used only after the next, more precise solve.
                tol = finer
                continue
            gap = u + self.shape - level
            # All points with negative pressure leave the contact, even if the pressure is closer to
            # zero than `error`, the largest error of the pressure on the grid. This error is set by
            # the steepest peaks. If -`error` were the limit, a zone end in a flat region would move
            # by only one cell per solve.
            drop = mask & (p < 0.0)
            error_of_gap = error * self.influence.h / self.influence.E
            add = self.allowed & ~mask & ~capped & (gap < -error_of_gap)
            changes = int(np.count_nonzero(drop) + np.count_nonzero(add))
            if np.isfinite(cap):
                # Points with a pressure above the cap join the set `capped`. Points at which the
                # gap opens leave this set.
                above, freed = mask & (p > cap), capped & (gap > error_of_gap)
                rest = load - cap * self.influence.h * np.count_nonzero((capped | above) & ~freed)
                above &= rest > 0.0
                changes += int(np.count_nonzero(above) + np.count_nonzero(freed))
                capped = (capped | above) & ~freed
                add, drop = add | freed, drop | above
            # The contact set is right if no pressure or gap has the wrong sign by more than its
            # error.
            within = np.all(p >= -error) and np.all(p <= cap + error)
            if tol == self.tol and not np.any(add) and within:
                converged = solved
                break
            # The tolerance is reduced in two cases. First: few points come into or leave contact,
            # so the contact set is almost right. Second: the number `changes` of these points
            # hardly falls, so errors of the linear solve cause the changes.
            if changes <= 2 or changes > 0.7 * fewest:
                tol = finer
            # If the pressure has a cap, a few points may reach the cap and leave it in turns,
            # without end.
            repeats = repeats + 1 if changes >= fewest and np.isfinite(cap) else 0
            if repeats > OPTIONS.max_repeats:
                break
            fewest = min(fewest, changes)
            mask = (mask & ~drop) | add
            p = np.clip(p, 0.0, cap)
        assert p is not None
        p = np.clip(p, 0.0, cap)
        gap = np.where(self.allowed, gap, np.inf)
        return GridState(
            p, gap, level + self.lowest, load, self.iterations, converged, self.f, self.influence
        )

    def _next_to_change(self, load: float, capped: Mask) -> Mask:
        """Mask of the points to close or to open if the points at the cap do not bear the load.
        If they bear too little, the points with the smallest gaps close. If they bear too much,
        those with the largest gaps open.
        """
        borne = self.influence.cap * self.influence.h
        number = load / borne - np.count_nonzero(capped)
        gap = self.influence.apply(np.where(capped, self.influence.cap, 0.0)) + self.shape
        free = self.allowed & ~capped
        closes = number > 0.0 and bool(free.any())
        some = np.flatnonzero(free if closes else capped)
        order = np.argsort(gap[some] if closes else -gap[some])
        out = np.zeros(len(capped), dtype=bool)
        out[some[order[: max(1, math.ceil(abs(number)))]]] = True
        return out

    def _on_sets(
        self, load: float, mask: Mask, capped: Mask, guess: Array | None, tol: float
    ) -> tuple[Array, Array, float, float, bool]:
        """The result of `conjugate_gradient`, with the cap as the pressure on points `capped`."""
        if not capped.any():
            return self.conjugate_gradient(load, mask, guess, tol)
        fixed = np.where(capped, self.influence.cap, 0.0)
        moved = self.influence.apply(fixed)
        rest = load - float(fixed.sum()) * self.influence.h
        guess = None if guess is None else np.where(mask, guess, 0.0)
        p, u, level, error, solved = self.conjugate_gradient(
            rest, mask, guess, tol, self.shape + moved
        )
        return p + fixed, u + moved, level, error, solved

    def compliance(self, state: GridState) -> float:
        """The rate d level / d load; the level is displacement plus height at points in contact.

        The motion of the ends has no effect at first order, as the pressure is zero there.
        """
        mask = state.contact & ~state.capped
        if not mask.any():
            # All points in contact are at the cap. The compliance without the cap is a lower bound.
            mask = state.contact
        if state.full and mask.all():
            return self.influence.uniform_compliance / (self.influence.n * self.influence.h)
        _, _, level, _, _ = self.conjugate_gradient(
            1.0,
            mask,
            np.where(mask, state.pressure, 0.0),
            OPTIONS.fine_tolerance,
            np.zeros(len(mask)),
        )
        return level

    def at_level(self, level: float, guess: Array | None) -> GridState:
        """The contact at a given level (displacement plus height), by Newton's method on the load.

        The level is a concave function of the load, as contact grows with the load. So a step from
        too small a load never overshoots. A step that leaves the bracket is replaced by the
        geometric mean of its ends.
        """
        inf, E, h = self.influence, self.influence.E, self.influence.h
        depth = level - self.lowest
        if depth <= 0.0:
            gap = np.where(self.allowed, self.f - level, np.inf)
            return GridState(np.zeros(inf.n), gap, level, 0.0, 0, True, self.f, inf)
        if (
            inf.is_periodic
            and not inf.uniform_compliance
            and not np.isfinite(inf.cap)
            and np.all(self.allowed)
            and depth >= float(np.mean(self.shape))
        ):
            raise LevelOfFullGrid(_AS_GOOD_AS_FULL)
        load = 0.5 * E * depth if guess is None else float(guess.sum()) * h
        low, high = 0.0, inf.cap * h * float(np.count_nonzero(self.allowed))
        load = load if load < high else 0.5 * high
        while True:
            state = self.at_load(load, guess)
            slope = self.compliance(state)
            state = replace(state, compliance=slope)
            step = (level - state.level) / slope if slope > 0.0 else np.nan
            if abs(step) <= self.tol * load:
                return state
            if slope > 0.0 and step > 0.0:
                low = load
            # Either the load is too large for the level, or it is beyond the load at which the
            # level is largest. The second case occurs in isolated contacts only.
            else:
                high = load
            if high < np.inf and high - low <= TOLERANCES.balance * high:
                limited = np.isfinite(inf.cap)
                if inf.is_periodic and not limited:
                    raise LevelOfFullGrid(_AS_GOOD_AS_FULL)
                if limited or slope * load > OPTIONS.first_tolerance * depth:
                    # The bracket has closed although the level (displacement plus height in
                    # contact) still rises with the load. So the solutions are too inexact for the
                    # bracket, as happens for a nearly incompressible layer. Under a cap, the level
                    # jumps if no point in contact is below the cap.
                    return replace(state, converged=False)
                raise OutOfRange(
                    f"level {level} (approach plus lowest height) is above the largest level under "
                    f"any load, {state.level}"
                )
            guess = state.pressure
            load += step
            if not low < load < high:
                load = float(np.sqrt(low * high)) if low > 0.0 else 0.1 * high
