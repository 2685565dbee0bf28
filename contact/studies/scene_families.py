"""Random profiles of every family, for `random_scenes`: each a function of a random generator and
the length of a cell.

A family returns a profile of about unit slope times 1e-3 ... 1e-1, whose cell is `length`; periodic
or not as drawn.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

import contact
from contact.reference.inverse import random_problem
from contact.studies.trace_kinds import KINDS, POSITIONS, drawn

Array = NDArray[np.float64]
Family = Callable[[np.random.Generator, float], contact.Profile]


@dataclass(frozen=True, eq=False)
class PiecewiseLinear(contact.Profile):
    """Straight lines between corners, ascending; periodic, or going on as they end. Trapezoids,
    sawteeth, rough polygons.
    """

    at: Array
    heights: Array
    period: float | None = None

    @property
    def x0(self) -> float:
        return float(self.at[0])

    def _corners(self) -> tuple[Array, Array]:
        if self.period is None:
            return self.at, self.heights
        return np.append(self.at, self.at[0] + self.period), np.append(
            self.heights, self.heights[0]
        )

    def _piece(self, x: ArrayLike) -> tuple[Array, Array, Array]:
        at, heights = self._corners()
        x = np.asarray(self.wrap(x), dtype=float)
        k = np.clip(np.searchsorted(at, x, side="right") - 1, 0, len(at) - 2)
        return x - at[k], heights[k], (np.diff(heights) / np.diff(at))[k]

    def height(self, x: ArrayLike) -> Array:
        away, start, slope = self._piece(x)
        return np.asarray(start + slope * away)

    def slope(self, x: ArrayLike) -> Array:
        return np.asarray(self._piece(x)[2])

    @property
    def kinks(self) -> Array:
        at, heights = self._corners()
        slopes = np.diff(heights) / np.diff(at)
        jumps = np.diff(slopes) if self.period is None else slopes - np.roll(slopes, 1)
        return np.column_stack((self.at[1:-1] if self.period is None else self.at, jumps))

    @property
    def resolution(self) -> float:
        return float(np.diff(self._corners()[0]).min())


@dataclass(frozen=True, eq=False)
class Mixed(contact.Profile):
    """The sum of profiles, which have one period or none."""

    parts: tuple[contact.Profile, ...]
    period: float | None = None

    @property
    def x0(self) -> float:
        return self.parts[0].x0

    def height(self, x: ArrayLike) -> Array:
        return np.asarray(sum(part.height(x) for part in self.parts))

    def slope(self, x: ArrayLike) -> Array:
        return np.asarray(sum(part.slope(x) for part in self.parts))

    @property
    def kinks(self) -> Array:
        return np.concatenate([part.kinks for part in self.parts])

    @property
    def jumps(self) -> Array:
        return np.concatenate([part.jumps for part in self.parts])

    @property
    def resolution(self) -> float | None:
        known = [part.resolution for part in self.parts if part.resolution is not None]
        return min(known) if known else None


def sinusoid(rng: np.random.Generator, length: float) -> contact.Profile:
    return contact.Sinusoid(length * 10 ** rng.uniform(-3, -1) / (2 * np.pi), length)


def fourier(rng: np.random.Generator, length: float) -> contact.Profile:
    """Up to 40 harmonics, falling as k^0 ... k^-2.5, some of them absent."""
    n = int(rng.integers(1, 41))
    k = np.arange(1, n + 1)
    size = k ** -rng.uniform(0, 2.5) * (rng.random(n) < rng.uniform(0.3, 1))
    size[rng.integers(n)] = 1.0
    phase = rng.uniform(0, 2 * np.pi, n)
    scale = length * 10 ** rng.uniform(-3, -1) / (2 * np.pi * np.sqrt(np.sum((k * size) ** 2)))
    return contact.Fourier(length, scale * size * np.cos(phase), scale * size * np.sin(phase))


def polynomial(rng: np.random.Generator, length: float) -> contact.Profile:
    """Of even degree 2 ... 8, growing on both sides, with bumps."""
    degree = 2 * int(rng.integers(1, 5))
    c = rng.normal(size=degree + 1)
    c[-1] = abs(c[-1]) + 0.1
    c *= 10 ** rng.uniform(-3, -1) * length / np.abs(c[1:] * np.arange(1, degree + 1)).sum()
    return contact.Polynomial(tuple(c / length ** np.arange(degree + 1.0)))


def sampled(rng: np.random.Generator, length: float) -> contact.Profile:
    """A self-affine trace of 32 ... 512 points with noise, periodic or not."""
    n = int(2 ** rng.integers(5, 10))
    k = np.arange(1, n // 2)
    spectrum = np.zeros(n // 2 + 1, dtype=complex)
    spectrum[1 : n // 2] = k ** -rng.uniform(1, 2.5) * np.exp(2j * np.pi * rng.random(len(k)))
    heights = np.fft.irfft(spectrum, n)
    heights += rng.choice([0, 1e-4, 1e-2]) * heights.std() * rng.normal(size=n)
    x = length * np.arange(n) / n
    heights *= 10 ** rng.uniform(-3, -1) / np.std(np.diff(heights) * n / length)
    return contact.Sampled(x, heights, period=length if rng.random() < 0.6 else None)


def trace(rng: np.random.Generator, length: float) -> contact.Profile:
    """A trace of any kind, 100 ... 5,000 points, even or uneven; one in five of a lone body,
    tilted, between shoulders that rise.
    """
    points, kind, positions = (
        int(10 ** rng.uniform(2, 3.7)),
        str(rng.choice(list(KINDS))),
        str(rng.choice(POSITIONS)),
    )
    made = drawn(rng, kind, points, positions)
    assert made.period is not None
    x, heights = made.x * (length / made.period), made.heights * (length / made.period)
    if rng.random() < 0.8:
        return contact.Sampled(x, heights, period=length)
    u = (x - x[0]) / (x[-1] - x[0]) - 0.5
    return contact.Sampled(x, heights + np.ptp(heights) * (rng.uniform(-1, 1) * u - 8 * u**4))


def biquadratic(rng: np.random.Generator, length: float) -> contact.Profile:
    period = length if rng.random() < 0.6 else None
    return contact.Biquadratic(
        length * 10 ** rng.uniform(0, 2), length * rng.uniform(0.1, 0.9), period
    )


def wedge(rng: np.random.Generator, length: float) -> contact.Profile:
    return contact.Wedge(10 ** rng.uniform(-3, -1), length if rng.random() < 0.6 else None)


def parabola(rng: np.random.Generator, length: float) -> contact.Profile:
    return contact.Parabola(
        length * 10 ** rng.uniform(0, 2), length if rng.random() < 0.6 else None
    )


def flat(rng: np.random.Generator, length: float) -> contact.Profile:
    return contact.Flat(length * rng.uniform(0.05, 0.99), length if rng.random() < 0.6 else None)


def piecewise(rng: np.random.Generator, length: float) -> contact.Profile:
    """3 ... 24 corners at random places, or a sawtooth or trapezoid."""
    n = int(rng.integers(3, 25))
    gaps = rng.dirichlet(np.full(n, rng.choice([0.7, 3.0, 30.0])))
    at = length * (
        np.concatenate(([0.0], np.cumsum(np.maximum(gaps, 1e-3))[:-1]))
        / np.maximum(gaps, 1e-3).sum()
        - 0.5
    )
    heights = rng.normal(size=n)
    if rng.random() < 0.3:
        heights = np.repeat([0.0, 1.0], (n + 1) // 2)[:n]
    period = length if rng.random() < 0.6 else None
    if period is None:
        heights[[0, -1]] = heights.max() + rng.uniform(0.5, 3, 2)
    heights *= 10 ** rng.uniform(-3, -1) / np.std(np.diff(heights) / np.diff(at))
    return PiecewiseLinear(at, heights, period)


def mixed(rng: np.random.Generator, length: float) -> contact.Profile:
    """A wave on a wedge, on a parabola or on corners; a noisy trace on a wave."""
    period = length if rng.random() < 0.6 else None
    if period is None:
        carrier = [wedge, parabola, polynomial][rng.integers(3)]
        below = carrier(rng, length)
        while below.period is not None:
            below = carrier(rng, length)
        return Mixed((below, fourier(rng, length * rng.uniform(0.1, 1))))
    carrier = [wedge, parabola, piecewise, sampled][rng.integers(4)]
    below = carrier(rng, length)
    while below.period is None:
        below = carrier(rng, length)
    k, size = int(rng.integers(1, 20)), length * 10 ** rng.uniform(-5, -2)
    wave = contact.Fourier(length, np.eye(k)[k - 1] * size, np.eye(k)[k - 1] * size * rng.normal())
    return Mixed((below, wave), period)


def designed(rng: np.random.Generator, length: float) -> contact.Profile:
    period = length if rng.random() < 0.7 else None
    zones = int(rng.integers(1, 13 if period else 7))
    problem = random_problem(
        rng,
        zones,
        period,
        E_star=1.0,
        strain=10 ** rng.uniform(-3, -1),
        spread=float(rng.choice([3, 10, 30])),
        length=length,
    )
    return problem.profile


FAMILIES: dict[str, Family] = {
    f.__name__: f
    for f in (
        sinusoid,
        fourier,
        polynomial,
        sampled,
        trace,
        biquadratic,
        wedge,
        parabola,
        flat,
        piecewise,
        mixed,
        designed,
    )
}
# The part of random scenes that get a rough counter body.
_PAIRS = 0.12


def faced(
    seed: int, family: str, profile: contact.Profile, length: float
) -> tuple[str, contact.Profile]:
    """For a part of the seeds, the profile with that of a counter body; drawn apart, so that the
    other seeds stay.

    The counter body comes from any family, stands anywhere and either way round; where it repeats,
    in the same cells, in two or in three of its own to one, or to two, of the profile's.
    """
    rng = np.random.default_rng([seed, 2])
    if rng.random() >= _PAIRS:
        return family, profile
    other = str(rng.choice(list(FAMILIES)))
    counter = FAMILIES[other](rng, length * float(rng.choice([1.0, 1.0, 0.5, 1 / 3, 2 / 3, 2.0])))
    pair = contact.Combined(
        profile,
        counter,
        shift=length * float(rng.uniform(-1, 1)),
        mirrored=bool(rng.random() < 0.5),
    )
    return f"{family} on {other}", pair
