r"""Frictionless contact of an elastic half-plane on a uniform grid: it says how many zones there
are.

On n points with spacing h (one period, or a window of an isolated contact) find the pressure with

    p >= 0,   gap = S p + f - level >= 0,   p * gap = 0,   and   sum p h = load   (or the level given),

where S is the influence of the pressure on the displacement u,

    periodic:  u_k = 2 p_k / (E |k|), k = 2 pi j / (n h), u_0 = 0,
    isolated:  u(x) = -(2 / (pi E)) int p(xi) ln(|x - xi| / d) dxi, p constant on a cell, integral closed,

and on other bodies u_k times their symbol, and u_0 = 2 p_0 c / E, c their compression; or,
isolated, with what their potential has beyond the logarithm, a smooth `rest` of the lag x - xi and
the width of a cell.

This is the problem of Polonsky & Keer (1999), Wear 231, 206-219, doi 10.1016/S0043-1648(99)00113-1,
and like theirs the method is a conjugate gradient under FFTs. Two things differ, because here the
iterations must not grow with n:

* The contact set is changed between linear solves, not within them: drop points in tension, add
  points in
  penetration. The inverse of S is an M-matrix (Fourier symbol E|k|/2: off-diagonals (cos(pi m) -
  1)/m^2 <= 0), for which this active-set (semismooth Newton) iteration settles from any start:
  Hintermueller, Ito & Kunisch (2002), SIAM J. Optim. 13, 865-888, doi 10.1137/S1052623401383558. A
  wrong end moves by a fixed fraction of its error, so ~log2(n) steps at most.
* On a contact set the gradient is preconditioned by B' D B, D = E|k|/2, B = linear interpolation of
  the
  displacement across the gaps. The exact inverse is the same with the energy-minimal extension in
  place of B, so the quotient is bounded up to logarithms for any number of zones. B keeps
  constants, hence B' D B keeps the load: the constraint costs nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import field, replace

import numpy as np
import scipy.fft
from numpy.typing import ArrayLike

from contact.errors import OutOfRange
from sie import Array, Index, Mask, record

Rest = Callable[[Array, float], Array]
Symbol = Callable[[Array], Array]

# Iterations at the most.
_MOST = 10_000


class LevelOfFullGrid(OutOfRange):
    """The level is that of full contact as far as a grid tells: the mean of its heights is not that
    of the profile.
    """


_AS_GOOD_AS_FULL = (
    "the approach is the mean of the profile, as nearly as a grid can tell: contact is full or as good as full; give a load, a mean "
    "pressure or a contact fraction"
)


@record
class Influence:
    """The operator S of one grid, made by `periodic` or `isolated`: `apply(p)` is the displacement."""

    n: int
    h: float
    E: float
    is_periodic: bool
    images: int
    _compliance: Array = field(repr=False, compare=False)  # S in Fourier space on the padded grid
    stiffness: Array = field(repr=False, compare=False)  # D = E|k|/2 on the padded grid
    _offset: float = (
        0.0  # u = ... + _offset * sum p h: the part of the datum, kept apart from the shape of u
    )
    is_even: bool = False  # what is on the grid goes on in its mirror image beyond either border
    half: Influence | None = None  # that of half a period, where the other half is its mirror image

    @classmethod
    def even(cls, n: int, h: float, E: float) -> Influence:
        """Half-plane on a period of 2 n points of which the others are the mirror image of these."""
        stiffness = _wave_stiffness(2 * n, h, E)[:n]
        return cls(n, h, E, True, 0, _inverse(stiffness), stiffness, is_even=True)

    @classmethod
    def periodic(
        cls, n: int, h: float, E: float, symbol: Symbol | None = None, compression: float = 0.0
    ) -> Influence:
        stiffness = _wave_stiffness(n, h, E)
        if symbol is not None:
            stiffness[1:] /= symbol(
                np.asarray(2.0 * np.pi / (n * h) * np.arange(1, n // 2 + 1), dtype=np.float64)
            )
        return cls(n, h, E, True, 0, _inverse(stiffness, 2.0 * compression / E), stiffness)

    @property
    def yields(self) -> float:
        """Displacement of a unit of uniform pressure on a period."""
        return float(self._compliance[0]) if self.is_periodic else 0.0

    @classmethod
    def isolated(
        cls,
        n: int,
        h: float,
        E: float,
        images: int = 0,
        datum: float = 1.0,
        rest: Rest | None = None,
    ) -> Influence:
        """Half-plane without periodicity; `images` shifted copies each side, n h apart."""
        lag = np.arange(n + 1.0)
        kernel = sum((_log_cell(lag + j * n) for j in range(-images, images + 1)), np.zeros(n + 1))
        if rest is not None:
            kernel = kernel + rest(np.asarray(h * lag), h)
        circulant = np.concatenate((kernel, kernel[n - 1 : 0 : -1]))
        scale = -2.0 / (np.pi * E)
        compliance = scale * h * scipy.fft.rfft(circulant).real
        # With images the neighbours carry load up to the border: there the periodic D is the better
        # model.
        stiffness = _wave_stiffness(n if images else 2 * n, h, E)
        offset = scale * (2 * images + 1) * np.log(h / datum)
        return cls(n, h, E, False, images, compliance, stiffness, float(offset))

    def apply(self, p: ArrayLike) -> Array:
        """Displacement u = S p at the grid points."""
        pressure = np.asarray(p, dtype=np.float64)
        size = self.n if self.is_periodic else 2 * self.n
        u = _multiplied(pressure, self._compliance, size, self.is_even)[: self.n]
        return u + self._offset * (float(pressure.sum()) * self.h) if self._offset else u

    @property
    def _stiffness_size(self) -> int:
        return self.n if self.is_periodic or self.images else 2 * self.n


@record
class Response:
    """What pressure does to the surface, on any grid. periodic: on a period, by the body's `symbol`
    and `compression`, or, mirrored, of a half-plane on one whose second half is the mirror image of
    the first; else alone on the line, with `images` copies of the cell each side, heights counted
    with the length `datum` in the logarithm, and `rest`: what the kernel has beyond the
    half-plane's.
    """

    E: float
    periodic: bool = True
    images: int = 0
    datum: float = 1.0
    rest: Rest | None = None
    symbol: Symbol | None = None
    compression: float = 0.0
    mirrored: bool = False

    def on(self, n: int, h: float) -> Influence:
        """Its operator on n cells of width h."""
        if self.periodic:
            whole = Influence.periodic(n, h, self.E, self.symbol, self.compression)
            return (
                replace(whole, half=Influence.even(n // 2, h, self.E)) if self.mirrored else whole
            )
        return Influence.isolated(
            n, h, self.E, images=self.images, datum=self.datum, rest=self.rest
        )


def _dot(a: Array, b: Array) -> float:
    """Sum of products, by one thread: where another program takes the cores, threads of BLAS wait a
    thousand times as long for each other as such a sum takes.
    """
    return float(np.einsum("i,i", a, b))


def _multiplied(values: Array, factors: Array, size: int, even: bool) -> Array:
    """Values on a grid, continued by zeros to a size, times factors in Fourier space."""
    if even:
        return np.asarray(scipy.fft.idct(scipy.fft.dct(values) * factors, overwrite_x=True))
    seen = scipy.fft.rfft(values, size)
    seen *= factors
    return np.asarray(scipy.fft.irfft(seen, size, overwrite_x=True))


def _wave_stiffness(n: int, h: float, E: float) -> Array:
    return np.asarray(0.5 * E * (2.0 * np.pi / (n * h)) * np.arange(n // 2 + 1), dtype=np.float64)


def _inverse(stiffness: Array, mean: float = 0.0) -> Array:
    """Of all but the mean."""
    return np.concatenate(([mean], 1.0 / stiffness[1:]))


def _log_cell(m: Array) -> Array:
    """int_{-1/2}^{1/2} ln|m - t| dt without the cancellation of the difference of t ln t at large
    m.
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


class _Extension:
    """B: displacement on the contact set -> on the (padded, periodic) grid, linear across the gaps.

    Points are counted from the first one in contact, so that each is that far along from a point in
    contact to the next. On an even grid they are counted as they are: across the borders nothing
    varies.
    """

    def __init__(self, influence: Influence, inside: Index) -> None:
        self.size, self.even = influence._stiffness_size, influence.is_even
        self.stiffness = influence.stiffness
        first = inside - (0 if self.even else inside[0])
        reach = np.diff(first, append=np.inf if self.even else self.size)
        self.starts = np.append(0, first[1:])
        self.lengths = np.diff(self.starts, append=self.size)
        self.along = np.maximum(
            np.arange(self.size) - np.repeat(first, self.lengths), 0
        ) / np.repeat(reach, self.lengths)

    def precondition(self, residual: Array) -> Array:
        """B' D B applied to values on the contact set; the result sums to zero."""
        v = np.repeat(np.roll(residual, -1) - residual, self.lengths)
        v *= self.along
        v += np.repeat(residual, self.lengths)
        q = _multiplied(v, self.stiffness, self.size, self.even)
        z = np.add.reduceat(q, self.starts)
        q *= self.along
        to_next = np.add.reduceat(q, self.starts)
        z += np.roll(to_next, 1) - to_next
        return np.asarray(z - z.mean())


@record
class GridState:
    """A contact on the grid. `iterations` counts applications of S within the conjugate gradients."""

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
        return np.asarray(self.pressure > 0.0)

    @property
    def full(self) -> bool:
        """Every point of a period in contact; false for a window, which has an outside."""
        return self.influence.is_periodic and bool(np.all(self.pressure > 0.0))

    @property
    def touches_border(self) -> bool:
        """Contact in an end cell of a window: what lies beyond was not asked."""
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
    """Solve the grid contact for a given load or level; `start` is a pressure to begin from (its
    scale does not matter, except that under level control its sum is the first guess of the load).
    f = inf marks points that never touch.
    """
    shape = np.asarray(f, dtype=np.float64)
    if shape.shape != (influence.n,):
        raise ValueError(f"f has shape {shape.shape}, the grid has {influence.n} points")
    allowed = np.isfinite(shape)
    if np.any(np.isnan(shape)) or np.any(shape == -np.inf) or not np.any(allowed):
        raise ValueError("f must be finite or +inf, and finite somewhere")
    if (load is None) == (level is None):
        raise ValueError("exactly one of load and level")
    if influence.half is not None:
        n = influence.half.n
        side = solve_grid(
            shape[:n],
            influence.half,
            load=None if load is None else 0.5 * load,
            level=level,
            tol=tol,
            start=None if start is None else np.asarray(start)[:n],
        )
        pressure, gap = (np.concatenate((part, part[::-1])) for part in (side.pressure, side.gap))
        return replace(
            side, pressure=pressure, gap=gap, load=2.0 * side.load, f=shape, influence=influence
        )
    guess: Array | None = None
    if start is not None:
        positive = np.maximum(np.asarray(start, dtype=np.float64), 0.0)
        guess = np.where(allowed, positive, 0.0) if np.any(positive[allowed] > 0.0) else None
    run = _Run(shape, influence, tol, _MOST)
    if load is not None:
        if not load > 0.0:
            raise ValueError(f"load must be positive, not {load}")
        return run.at_load(load, guess)
    assert level is not None
    return run.at_level(level, guess)


def turning_rate(state: GridState, x: Array) -> float:
    """d moment / d tilt of a contact on points x, the load and (its pressure being zero at the
    ends) the contact held: the moment of the pressure that the shape -x calls up.
    """
    run = _Run(np.zeros(len(x)), state.influence, 1e-3, 500)
    pressure = run.conjugate_gradient(
        0.0, state.contact, None, 1e-3, -(x - x[state.contact].mean())
    )[0]
    return float(pressure @ x) * state.influence.h


class _Run:
    """One problem (shape and influence) with its tolerances and its count of iterations."""

    def __init__(self, f: Array, influence: Influence, tol: float, max_iterations: int) -> None:
        self.f, self.influence, self.tol, self.max_iterations = f, influence, tol, max_iterations
        self.allowed: Mask = np.isfinite(f)
        self.lowest = float(np.min(f[self.allowed]))
        # Differences of f matter and its constant does not: taking it out here keeps the digits.
        self.shape = np.where(self.allowed, f - self.lowest, 0.0)
        self.iterations = 0

    def conjugate_gradient(
        self, load: float, mask: Mask, guess: Array | None, tol: float, shape: Array | None = None
    ) -> tuple[Array, Array, float, float, bool]:
        """Pressure on `mask` with S p + shape = constant there and the given load.

        Returns p, S p, the constant, the largest error of p as the preconditioner sees it, and
        whether tol was met.
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
        converged, steps = False, 0
        best, since = np.inf, 0
        while self.iterations < self.max_iterations:
            # B' D B is close to the inverse of S: z is close to the error of the pressure.
            size = math.sqrt(_dot(z, z))
            converged = size <= tol * math.sqrt(_dot(p, p)) or rz <= 0.0
            best, since = (size, 0) if size < 0.9 * best else (best, since + 1)
            if (
                converged or since > 60
            ):  # 60 iterations without progress: the roundoff of f is reached
                break
            self.iterations += 1
            steps += 1
            full[inside] = direction
            response = self.influence.apply(full)[inside]
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
        """Contact everywhere on a period, closed: p = load / L - D shape, u = level - shape. Its
        smallest pressure decides whether there is a gap at all, so no iteration may blur it.
        """
        n, h = self.influence.n, self.influence.h
        self.iterations += 1
        mean = float(shape.mean())
        level = mean + self.influence.yields * load / (n * h)
        p = load / (n * h) - _multiplied(
            shape - mean, self.influence.stiffness, n, self.influence.is_even
        )
        roundoff = np.finfo(float).eps * (
            self.influence.E / h * float(np.max(np.abs(shape - mean))) + load / (n * h)
        )
        return p, level - shape, level, roundoff, True

    def at_load(self, load: float, guess: Array | None) -> GridState:
        # From the whole grid the set only shrinks; from a guess it may also grow once.
        mask = self.allowed.copy() if guess is None else guess > 0.0
        p, tol = guess, max(self.tol, 1e-2)
        converged = False
        steps, fewest = 0, self.influence.n
        limit = 60 + int(4 * np.log2(self.influence.n))
        while self.iterations < self.max_iterations and steps < limit:
            steps, before = steps + 1, self.iterations
            p, u, level, error, solved = self.conjugate_gradient(load, mask, p, tol)
            if self.iterations == before and tol > self.tol:
                # A guess as good as that has gaps of the grid it comes from: their signs on this
                # one mean nothing.
                tol = max(self.tol, 1e-1 * tol)
                continue
            gap = u + self.shape - level
            # `error` is the largest on the grid, that of the steepest peaks. A flat beside them is
            # in tension by less: if only points below -error were dropped, its end would move by
            # one cell per linear solve.
            drop = mask & (p < 0.0)
            add = self.allowed & ~mask & (gap < -error * self.influence.h / self.influence.E)
            changes = int(np.count_nonzero(drop) + np.count_nonzero(add))
            # The set has settled when no sign is wrong by more than the error, in p or in u on one
            # cell.
            if tol == self.tol and not np.any(add) and np.all(p >= -error):
                converged = solved
                break
            if (
                changes <= 2
            ):  # a few digits at a time: most of the points that still change do so early
                tol = max(self.tol, 1e-2 * tol)
            elif (
                changes > 0.7 * fewest
            ):  # a set that no longer settles is one blurred by the linear solve
                tol = max(self.tol, 0.03 * tol)
            fewest = min(fewest, changes)
            mask = (mask & ~drop) | add
            p = np.maximum(p, 0.0)
        assert p is not None
        p = np.maximum(p, 0.0)
        gap = np.where(self.allowed, gap, np.inf)
        return GridState(
            p, gap, level + self.lowest, load, self.iterations, converged, self.f, self.influence
        )

    def compliance(self, state: GridState) -> float:
        """d level / d load: the contact set does not move to first order (p vanishes at its ends)."""
        mask = state.contact
        if state.full:
            return self.influence.yields / (self.influence.n * self.influence.h)
        _, _, level, _, _ = self.conjugate_gradient(
            1.0, mask, state.pressure, 1e-4, np.zeros(len(mask))
        )
        return level

    def at_level(self, level: float, guess: Array | None) -> GridState:
        """Newton for the load. level(load) is concave (the contact grows with the load, the
        compliance falls), so from below it climbs without overshoot; a step that leaves the bracket
        is replaced by a geometric one.
        """
        inf, E, h = self.influence, self.influence.E, self.influence.h
        depth = level - self.lowest
        if depth <= 0.0:
            gap = np.where(self.allowed, self.f - level, np.inf)
            return GridState(np.zeros(inf.n), gap, level, 0.0, 0, True, self.f, inf)
        if (
            inf.is_periodic
            and not inf.yields
            and np.all(self.allowed)
            and depth >= float(np.mean(self.shape))
        ):
            raise LevelOfFullGrid(_AS_GOOD_AS_FULL)
        load = 0.5 * E * depth if guess is None else float(guess.sum()) * h
        low, high = 0.0, np.inf
        while True:
            state = self.at_load(load, guess)
            slope = self.compliance(state)
            state = replace(state, compliance=slope)
            step = (level - state.level) / slope if slope > 0.0 else np.nan
            if abs(step) <= self.tol * load or self.iterations >= self.max_iterations:
                return replace(state, converged=state.converged and abs(step) <= self.tol * load)
            if slope > 0.0 and step > 0.0:
                low = load
            else:  # above the level, or past the maximum of the approach of an isolated contact
                high = load
            if high < np.inf and high - low <= 1e-9 * high:
                if inf.is_periodic:
                    raise LevelOfFullGrid(_AS_GOOD_AS_FULL)
                raise OutOfRange(f"level {level} is above the largest approach, {state.level}")
            guess = state.pressure
            load += step
            if not low < load < high:
                load = float(np.sqrt(low * high)) if low > 0.0 else 0.1 * high
