r"""Tests of the engine `sie` on equations of known solution: true errors against stated ones.

    python -m contact.studies.engine_problems FIRST COUNT [--tol 1e-10] [--second-kind]

Widths and gaps of the zones vary over up to ten decades. Ends are singular, bounded, free or have a
prescribed intensity. Side conditions prescribe the total, totals of single zones, or differences of
levels; the level of a zone is its constant potential. The kernel is Cauchy's, Cauchy's with a
smooth part, or Hilbert's. The density phi is designed first, from the ends e of the zones, chosen
roots r, and the function y(x) = x, or y(x) = sin(pi x/L) with a period L:

    phi = +-P |Y|,     Y = prod y(x - e)^(+-1/2)  (-: singular),     P = prod y(x - r).

The right side g of the equation then follows from the polynomial part of P Y far away and from the
smooth part of the kernel. The number of roots makes this polynomial constant or linear.
`--second-kind` adds kappa phi to the equation. Then the exponent at a right end is alpha or
alpha - 1, and at a left end 1 - alpha or -alpha, with cot(pi alpha) = kappa, and phi has the factor
sin(pi times the exponent at the right end). P may have poles, so that g has them, too. Totals and
levels are integrals from an end a to an end b, by the trapezoidal rule in
s = log((x - a)/(b - x)). The gaps do not slow down the convergence of this rule (M. Mori, Publ.
RIMS 41, 2005, 897-935).

Each fault is printed: `dishonest`, `exception` or `slow`. A solution is dishonest if the true error
of all zones together, or of a single zone, is above the stated one. The last lines have the counts
and the largest ratio of true to stated error.
"""

from __future__ import annotations

import argparse
import time
import traceback
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import sie

Array = NDArray[Any]


@dataclass(frozen=True)
class JudgingLimits:
    """Limits by which a computed solution is judged."""

    # Errors of ends are relative to the width of the zone. If one is larger than this, the solver
    # has found another solution of the equation, which is not judged.
    other_root: float = 1e-3


LIMITS = JudgingLimits()


class Parts(sie.Condition):
    """Condition that prescribes the integral of the density on each of the given zones."""

    def __init__(self, zones: list[int], values: Array) -> None:
        self.zones, self.values = zones, values

    def count(self, zones: sie.Zones) -> int:
        return len(self.zones)

    def rows(self, system: sie.Rows) -> tuple[Array, Array, Array]:
        matrix, constants = system.totals()
        return matrix[self.zones], constants[self.zones], self.values


class Steps(Parts):
    """Condition that prescribes steps of the constant potential (level) from a zone to the next."""

    levels = True

    def rows(self, system: sie.Rows) -> tuple[Array, Array, Array]:
        matrix, constants = system.level_steps()
        return matrix[self.zones], constants[self.zones], self.values


def angles(count: int = 9) -> Array:
    """Angles theta at which densities are compared, at positions cos(theta) of each zone."""
    return (np.arange(count) + 0.5) * np.pi / count


@dataclass(frozen=True)
class Design:
    """A designed density phi = +-h P |Y| on given zones; the head of this module defines P and Y.
    h is the factor `heights`.

    `ends` and `signs` are (n, 2); the signs are -1 for singular and 1 for bounded ends. `roots`,
    `pole` (and its conjugate) and `factor` are those of P. Without a period the zones lie on a
    line. `kappa` (n,) is the factor of the density in the equation.
    """

    ends: Array
    signs: Array
    roots: Array
    factor: float
    period: float | None
    kappa: Array
    pole: complex | None = None

    @property
    def powers(self) -> Array:
        """Exponents of the density's power laws at the ends of the zones, as an array (n, 2)."""
        alpha, rest = np.arctan2(1.0, [self.kappa, -self.kappa]) / np.pi
        return np.column_stack((rest, alpha)) - (self.signs < 0)

    @property
    def heights(self) -> Array:
        """The factor h of the density phi = +-h P |Y| on each zone (n,); 1 or -1 for kappa = 0.

        h is -sin(pi times the exponent at the right end). `orientation` gives the sign +-.
        """
        return np.asarray(-np.sin(np.pi * self.powers[:, 1]))

    def y(self, distance: Array) -> Array:
        """The function y(x) of distances x: x itself, or sin(pi x/L) with a period L.
        It is computed in extended precision.
        """
        scaled = np.asarray(distance, dtype=np.longdouble)
        return (
            scaled if self.period is None else np.sin(np.longdouble(np.pi) / self.period * scaled)
        )

    def product(self, start: Array, away: Array, skipped: int = -1) -> Array:
        """The product P |Y| (head of this module) at start + away, accurate for small `away`.

        The factor of the end number `skipped` is left out.
        """
        start, away = np.asarray(start, dtype=np.longdouble), np.asarray(away, dtype=np.longdouble)
        out = np.full(np.broadcast(start, away).shape, np.longdouble(self.factor))
        for root in self.roots:
            out = out * self.y((start - np.longdouble(root)) + away)
        if self.pole is not None:
            out = out / np.abs(start + away - np.clongdouble(self.pole)) ** 2
        for number, (e, power) in enumerate(
            zip(self.ends.ravel(), self.powers.ravel(), strict=True)
        ):
            if number != skipped:
                out = out * np.abs(self.y((start - np.longdouble(e)) + away)) ** power
        return out

    def orientation(self, zone: int) -> int:
        """Sign of the product Y (head of this module) in the gap right of a zone.

        Each zone further right whose two ends are of one kind changes the sign.
        """
        return int(np.prod(np.where(self.signs[zone + 1 :, 0] == self.signs[zone + 1 :, 1], -1, 1)))

    def density(self, zone: int, angle: Array) -> Array:
        """Density phi at positions t = cos(angle) in [-1, 1] of a zone."""
        a, b = self.ends[zone]
        left, right = (b - a) * np.cos(angle / 2) ** 2, (b - a) * np.sin(angle / 2) ** 2
        start, away = np.where(left < right, a, b), np.where(left < right, left, -right)
        return np.asarray(
            self.orientation(zone) * self.heights[zone] * self.product(start, away), dtype=float
        )

    def integral(
        self, a: float, b: float, weight: Callable[[Array], Array] = np.ones_like
    ) -> float:
        """Integral of a weight times the product P |Y| (module head), from the end a to the end b.

        The step of the trapezoidal rule in s causes an error of about exp(-2 pi h/step). Here h is
        pi or, if P has a pole, the imaginary part of s at this pole. The sum is cut off where the
        exponent with the slowest decay leaves an error of about exp(-46).
        """
        step = 0.4
        if self.pole is not None:
            height = abs(np.angle((self.pole - a) / (b - self.pole)))
            step = min(step, 2 * np.pi * height / 46)
        nodes = int(np.ceil(46 / step / min(0.5, 1 + float(self.powers.min()))))
        s = step * np.arange(-nodes, nodes + 1, dtype=np.longdouble)
        width = np.longdouble(b) - np.longdouble(a)
        left, right = width / (1 + np.exp(-s)), width / (1 + np.exp(s))
        start, away = (
            np.where(s < 0, np.longdouble(a), np.longdouble(b)),
            np.where(s < 0, left, -right),
        )
        values = self.product(start, away) * weight(start + away) * left * right / width
        return float(step * values.sum())

    def total(self, zone: int, weight: Callable[[Array], Array] = np.ones_like) -> float:
        """Integral of the density times a weight over a zone."""
        a, b = self.ends[zone].tolist()
        return self.orientation(zone) * float(self.heights[zone]) * self.integral(a, b, weight)

    def step(self, zone: int) -> float:
        """Constant potential (level) of the next zone minus that of this zone."""
        return self.orientation(zone) * self.integral(self.ends[zone, 1], self.ends[zone + 1, 0])

    def intensity(self, zone: int, side: int) -> float:
        """Intensity K of the density at an end; 0 if the density is bounded at this end."""
        if self.signs[zone, side] > 0:
            return 0.0
        scale = 1.0 if self.period is None else (np.pi / self.period) ** self.powers[zone, side]
        size = float(self.product(self.ends[zone, side], np.zeros(()), 2 * zone + side))
        return float(self.orientation(zone) * self.heights[zone] * scale * size)

    def polynomial(self) -> list[float]:
        """Coefficients of the polynomial part of the right side, lowest power first.
        They hold for a kernel without a smooth part.

        This part is minus the polynomial part of P Y (head of this module) far away.
        """
        shift = float(self.roots.sum() + (self.powers * self.ends).sum())
        if self.period is not None:
            return [float(-self.factor * np.cos(np.pi / self.period * shift))]
        degree = len(self.roots) + round(self.powers.sum())
        if self.pole is not None:
            degree, shift = degree - 2, shift - 2 * self.pole.real
        if degree < 0:
            return [0.0]
        return [-self.factor] if degree == 0 else [self.factor * shift, -self.factor]

    @property
    def residue(self) -> complex:
        """The residue of the product P Y (head of this module) at its pole above the real line."""
        assert self.pole is not None
        out = np.clongdouble(self.factor / (2j * self.pole.imag))
        for root in self.roots:
            out = out * (self.pole - root)
        for e, power in zip(self.ends.ravel(), self.powers.ravel(), strict=True):
            out = out * np.clongdouble(self.pole - e) ** np.longdouble(power)
        return complex(out)

    def poles(self, x: Array) -> Array:
        """The part of the right side due to the complex pole of P and its conjugate."""
        if self.pole is None:
            return np.zeros(np.shape(x))
        return np.asarray(-2 * (self.residue / (x - self.pole)).real)

    def poles_rise(self, x: Array) -> Array:
        """An antiderivative of `poles`, the part of the right side due to complex poles."""
        if self.pole is None:
            return np.zeros(np.shape(x))
        return np.asarray(-2 * (self.residue * np.log(x - self.pole)).real)


@dataclass(frozen=True)
class Problem:
    """A designed density, its equation, and the zones from which the solution starts."""

    design: Design
    equation: sie.Equation
    start: sie.Zones


def problem(seed: int, second_kind: bool = False) -> Problem:
    """Return the random problem of a seed, with random zones, kinds of ends, kernel, conditions."""
    rng = np.random.default_rng([41, seed])
    moving = rng.random() < 0.4
    count = int(rng.choice([1, 2, 3, 5, 8, 30], p=[0.15, 0.25, 0.2, 0.2, 0.15, 0.05]))
    period = 1.0 if rng.random() < 0.25 else None
    decades = (
        rng.choice([0.5, 1, 2]) if moving else rng.choice([1, 3, 6, 10]) / (1 if count < 8 else 3)
    )
    widths, gaps = 10.0 ** rng.uniform(-decades, 0, (2, count))
    gaps = np.maximum(gaps, 1e-8)
    unit = 0.9 / (widths.sum() + gaps.sum()) if period else 1.0
    first = -0.45 if period else float(rng.normal())
    places = first + unit * np.cumsum(np.column_stack((np.append(0.0, gaps[:-1]), widths)).ravel())
    ends = places.reshape(-1, 2)
    signs = rng.choice([-1, 1], (count, 2), p=[0.75, 0.25])
    while signs.sum() > 0:
        signs[rng.integers(count)] = -1
    index = -int(signs.sum()) // 2
    degree = index + (max(int(rng.integers(-1, 2)), -index) if period is None else 0)
    roots = rng.choice(ends.mean(axis=1), degree) + rng.normal(size=degree) * rng.choice(
        widths, degree
    )
    factor, kappa, pole = float(rng.normal() * 10.0 ** rng.uniform(-3, 3)), np.zeros(count), None
    moves = (rng.random(ends.shape) < 0.7) & moving
    if second_kind:
        kappa = rng.choice([-1.0, 1.0], count) * 10.0 ** rng.uniform(-3, np.log10(25.0), count)
        if rng.random() < 0.5:
            kappa = np.full(count, kappa[0])
        if period is None and rng.random() < 0.5:
            zone = int(rng.integers(count))
            away = complex(rng.uniform(-1, 1), 10.0 ** rng.uniform(-1.5, 1))
            pole = complex(ends[zone].mean() + widths[zone] * away)
    design = Design(ends, signs, roots, factor, period, kappa, pole)
    equation = _equation(rng, design, index + int((moves & (signs > 0)).sum()))
    left, right = (
        [_end(design, i, side, bool(moves[i, side])) for i in range(count)] for side in (0, 1)
    )
    between = np.diff(ends.ravel(), prepend=-np.inf, append=np.inf)
    limit = np.minimum(between[:-1], between[1:]).reshape(-1, 2)
    error = 10.0 ** rng.uniform(-4, -1.5) * limit * np.clip(rng.normal(size=ends.shape), -2, 2)
    return Problem(design, equation, sie.Zones.of(ends + np.where(moves, error, 0.0), left, right))


def _end(design: Design, zone: int, side: int, moves: bool) -> sie.End:
    if moves:
        return sie.free_with_intensity(design.intensity(zone, side))
    return sie.BOUNDED if design.signs[zone, side] > 0 else sie.SINGULAR


def _equation(rng: np.random.Generator, design: Design, index: int) -> sie.Equation:
    """Return the equation that a designed density solves, with `index` side conditions."""
    g = np.polynomial.Polynomial(design.polynomial())
    rise, zones = g.integ(), range(len(design.ends))
    kernel = sie.cauchy() if design.period is None else sie.hilbert(design.period)
    cosine = sine = 0.0
    if design.period is None and rng.random() < 0.3:
        kernel = kernel + sie.Smooth(
            lambda x, xi: np.cos(x - xi), lambda x, xi: np.sin(x - xi), length=1.0, of_lag=True
        )
        cosine, sine = (
            sum(design.total(i, weight) for i in zones) / np.pi for weight in (np.cos, np.sin)
        )
    totals = np.array([design.total(i) for i in zones])
    some = sorted(rng.choice(len(totals), index, replace=False).tolist())
    conditions: tuple[sie.Condition, ...] = (Parts(some, totals[some]),)
    if index == len(totals) > 1 and rng.random() < 0.5:
        gaps = list(zones)[:-1]
        conditions = (
            sie.Total(float(totals.sum())),
            Steps(gaps, np.array([design.step(i) for i in gaps])),
        )
    forcing = sie.Forcing(
        lambda x: g(x) + cosine * np.cos(x) + sine * np.sin(x) + design.poles(x),
        lambda x: rise(x) + cosine * np.sin(x) - sine * np.cos(x) + design.poles_rise(x),
    )
    return sie.Equation(kernel, forcing, conditions if index else (), kappa=design.kappa)


@dataclass(frozen=True)
class Judged:
    """The outcome of solving a problem, with the ratios of true to stated error.

    `ratio` is the ratio for all zones together, `zone_ratio` the largest ratio of a single zone.
    """

    what: str
    seconds: float
    ratio: float = 0.0
    zone_ratio: float = 0.0
    message: str = ""

    def fault(self, slow_seconds: float = 20.0) -> str:
        """The kind of fault of a solved problem; empty if there is no fault.

        A problem must take at most `slow_seconds`.
        """
        if self.what == "exception":
            return self.what
        if max(self.ratio, self.zone_ratio) > 1.0:
            return "dishonest"
        return "slow" if self.seconds > slow_seconds else ""


def judged(seed: int, tol: float = 1e-10, second_kind: bool = False) -> Judged:
    """Solve the problem of a seed and compare the true errors with the stated errors."""
    posed = problem(seed, second_kind)
    what, message, began = "solved", "", time.process_time()
    try:
        found = sie.solve(posed.equation, posed.start, tol)
    except sie.NotConverged as stopped:
        if stopped.best is None:
            return Judged("refused", time.process_time() - began, message=stopped.reason)
        what, message, found = "refused", stopped.reason, stopped.best
    except Exception as error:
        seconds = time.process_time() - began
        if isinstance(error.__cause__, sie.SingularSystem):  # the conditions are nearly dependent
            return Judged("refused", seconds, message=str(error))
        return Judged("exception", seconds, message=traceback.format_exc(limit=-2))
    seconds, design, zones = time.process_time() - began, posed.design, found.zones
    width = np.diff(design.ends, axis=1)
    ends = np.abs((zones.table - design.ends) + zones.rest.T) / width
    if not np.isfinite(found.error) or ends.max() > LIMITS.other_root:
        return Judged(what if what == "refused" else "other root", seconds, message=message)
    theta, each = angles(), np.arange(len(width))
    sides = 2 * np.cos(theta / 2) ** 2, 2 * np.sin(theta / 2) ** 2
    exact = np.array([design.density(zone, theta) for zone in range(len(width))])
    density_errors = (np.abs(found.density.at(each[:, None], *sides) - exact) * np.sin(theta)).max(
        axis=1
    )
    largest = max(ends.max(), density_errors.max() / found.state.size)
    # The round-off of the designed density and its conditions is added to the stated error.
    round_off = 16 * np.finfo(np.float64).eps
    ratio = largest / (found.error + round_off)
    sizes = np.maximum(found.state.zone_sizes, 1e-300)
    errors = np.maximum(ends.max(axis=1), density_errors / sizes)
    zone_ratio = (errors / (found.errors + round_off)).max()
    return Judged(what, seconds, float(ratio), float(zone_ratio), message)


def main() -> None:
    """Judge the problems of the seeds given on the command line and print the faults."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("first", type=int)
    parser.add_argument("count", type=int)
    parser.add_argument("--tol", type=float, default=1e-10)
    parser.add_argument("--second-kind", action="store_true")
    given = parser.parse_args()
    counts: Counter[str] = Counter()
    ratios, zone_ratios = [0.0], [0.0]
    for seed in range(given.first, given.first + given.count):
        one = judged(seed, given.tol, given.second_kind)
        fault = one.fault()
        counts.update([one.what, fault] if fault else [one.what])
        ratios, zone_ratios = [*ratios, one.ratio], [*zone_ratios, one.zone_ratio]
        if fault:
            figures = f"true over stated {one.ratio:.2g}, of one zone {one.zone_ratio:.2g}"
            figures += f", {one.seconds:.1f} s"
            print(f"{seed} {fault} ({one.what}): {figures} {one.message}", flush=True)
    largest = f"{max(ratios):.2g}, of one zone {max(zone_ratios):.2g}"
    print(dict(counts), f"largest true over stated error {largest}")


if __name__ == "__main__":
    main()
