"""Random profiles and interaction models for `random_scenes`.

A family is a function of a random generator and the length of a cell. It returns a profile,
periodic or not, whose slopes are about 1e-3 to 1e-1. The interaction models are written as a reader
of docs/own-profile.md would write them. Each model defines its kernel in closed form. The method
`multiplier` or `rest` of a model serves the independent grid of contact.studies.grid_judge.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

import contact
import sie
from contact.reference.inverse import random_problem
from contact.studies.trace_kinds import KINDS, POSITIONS, drawn

Array = NDArray[np.float64]
Family = Callable[[np.random.Generator, float], contact.Profile]


@dataclass(frozen=True, eq=False)
class PiecewiseLinear(contact.Profile):
    """A piecewise linear profile with corners at the ascending positions `at`.

    Without a period the first and the last straight piece continue to infinity.
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
    """A sum of profiles that all have the same period, or all have no period."""

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
    """A sinusoid of random amplitude, with the wavelength `length`."""
    return contact.Sinusoid(length * 10 ** rng.uniform(-3, -1) / (2 * np.pi), length)


def fourier(rng: np.random.Generator, length: float) -> contact.Profile:
    """A Fourier series of up to 40 harmonics; amplitudes fall as k^-m with a random m up to 2.5."""
    n = int(rng.integers(1, 41))
    k = np.arange(1, n + 1)
    size = k ** -rng.uniform(0, 2.5) * (rng.random(n) < rng.uniform(0.3, 1))
    size[rng.integers(n)] = 1.0
    phase = rng.uniform(0, 2 * np.pi, n)
    scale = length * 10 ** rng.uniform(-3, -1) / (2 * np.pi * np.sqrt(np.sum((k * size) ** 2)))
    return contact.Fourier(length, scale * size * np.cos(phase), scale * size * np.sin(phase))


def polynomial(rng: np.random.Generator, length: float) -> contact.Profile:
    """A random polynomial of degree 2, 4, 6 or 8, which grows on both sides."""
    degree = 2 * int(rng.integers(1, 5))
    c = rng.normal(size=degree + 1)
    c[-1] = abs(c[-1]) + 0.1
    c *= 10 ** rng.uniform(-3, -1) * length / np.abs(c[1:] * np.arange(1, degree + 1)).sum()
    return contact.Polynomial(tuple(c / length ** np.arange(degree + 1.0)))


def sampled(rng: np.random.Generator, length: float) -> contact.Profile:
    """A self-affine trace of 32 to 512 points with noise, periodic or not."""
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
    """A trace of any kind of `trace_kinds` with 100 to 5,000 points.

    One trace in five is isolated. It is tilted and bent so that the body recedes on both sides.
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
    """Two parabolic tips, periodic or isolated."""
    period = length if rng.random() < 0.6 else None
    return contact.Biquadratic(
        length * 10 ** rng.uniform(0, 2), length * rng.uniform(0.1, 0.9), period
    )


def wedge(rng: np.random.Generator, length: float) -> contact.Profile:
    """A wedge, periodic or isolated."""
    return contact.Wedge(10 ** rng.uniform(-3, -1), length if rng.random() < 0.6 else None)


def parabola(rng: np.random.Generator, length: float) -> contact.Profile:
    """A parabola, periodic or isolated."""
    return contact.Parabola(
        length * 10 ** rng.uniform(0, 2), length if rng.random() < 0.6 else None
    )


def flat(rng: np.random.Generator, length: float) -> contact.Profile:
    """A flat punch, periodic or isolated."""
    return contact.Flat(length * rng.uniform(0.05, 0.99), length if rng.random() < 0.6 else None)


def piecewise(rng: np.random.Generator, length: float) -> contact.Profile:
    """A piecewise linear profile of 3 to 24 corners, or a sawtooth or trapezoid."""
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
    """The sum of a Fourier series and a simpler profile, e.g. a wedge, a parabola or a trace."""
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
    """A profile computed from its contact, which has 1 to 12 given zones."""
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


def with_counter_body(
    seed: int, family: str, profile: contact.Profile, length: float, share: float = 0.12
) -> tuple[str, contact.Profile]:
    """Return (family, profile); for some seeds the profile of a second body is added.

    The fraction of these seeds is `share`. The counter body comes from any family, at any shift,
    mirrored or not. Its cell has the length of the profile's cell, or a half, a third, two thirds
    or twice that length. A separate random generator draws the counter body, so that scenes without
    a counter body do not depend on it.
    """
    rng = np.random.default_rng([seed, 2])
    if rng.random() >= share:
        return family, profile
    other = str(rng.choice(list(FAMILIES)))
    counter = FAMILIES[other](rng, length * float(rng.choice([1.0, 1.0, 0.5, 1 / 3, 2 / 3, 2.0])))
    shift, mirrored = length * float(rng.uniform(-1, 1)), bool(rng.random() < 0.5)
    pair = contact.Combined(profile, counter, shift=shift, mirrored=mirrored)
    return f"{family} on {other}", pair


@dataclass(frozen=True)
class Waves(contact.Interaction):
    """A substrate with the symbol 1 + excess[n - 1] for n waves in the period, 1 for large n.
    The symbol is the Fourier multiplier of the kernel, divided by that of a half-plane.
    """

    excess: tuple[float, ...]
    name = "waves"
    needs_period = True

    def kernel(self, period: float | None, unit: float) -> sie.Kernel:
        assert period is not None
        q = 2 * np.pi / period

        def value(x: Array, xi: Array) -> Array:
            terms = (e * q * np.sin(n * q * (x - xi)) for n, e in enumerate(self.excess, 1))
            return np.asarray(sum(terms))

        def potential(x: Array, xi: Array) -> Array:
            terms = (-e / n * np.cos(n * q * (x - xi)) for n, e in enumerate(self.excess, 1))
            return np.asarray(sum(terms))

        return sie.hilbert(period) + sie.Smooth(value, potential)

    def multiplier(self, q: Array, period: float) -> Array:
        """The symbol L(q) of the substrate at wave numbers q (1 for a half-plane)."""
        n = np.rint(q * period / (2 * np.pi)).astype(int)
        table = np.concatenate((np.zeros(1), self.excess))
        return np.asarray(1 + np.where(n < len(table), table[np.minimum(n, len(table) - 1)], 0.0))


@dataclass(frozen=True)
class Bed(contact.Interaction):
    """A substrate with the symbol 1 + eps exp(-q depth) at wave number q, given by its kernel.
    The symbol is the Fourier multiplier of the kernel, divided by that of a half-plane.

    With r = exp(-2 pi depth/period), the kernel and its potential are series of r^n sin(n theta)
    and r^n cos(n theta)/n, which have closed forms.
    """

    eps: float
    depth: float
    name = "bed"
    needs_period = True

    def kernel(self, period: float | None, unit: float) -> sie.Kernel:
        assert period is not None
        q, eps = 2 * np.pi / period, self.eps
        r = np.exp(-q * self.depth / unit)

        def value(x: Array, xi: Array) -> Array:
            theta = q * (x - xi)
            return np.asarray(q * eps * r * np.sin(theta) / (1 - 2 * r * np.cos(theta) + r * r))

        def potential(x: Array, xi: Array) -> Array:
            return np.asarray(0.5 * eps * np.log(1 - 2 * r * np.cos(q * (x - xi)) + r * r))

        return sie.hilbert(period) + sie.Smooth(value, potential)

    def multiplier(self, q: Array, period: float) -> Array:
        """The symbol L(q) of the substrate at wave numbers q (1 for a half-plane)."""
        return np.asarray(1 + self.eps * np.exp(-q * self.depth))


@dataclass(frozen=True)
class Coated(Bed):
    """The same substrate as `Bed`, given by its symbol instead of its kernel."""

    name = "coated"
    kernel = contact.Interaction.kernel

    def symbol(self, q: Array) -> Array:
        return np.asarray(1 + self.eps * np.exp(-q * self.depth))


@dataclass(frozen=True)
class Buried(contact.Interaction):
    """A substrate of an isolated body, with the kernel 1/r + eps r/(r^2 + depth^2).
    Here r is the lag x - xi, with its sign.
    """

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
        """The kernel's antiderivative minus ln|r| (the part of a half-plane), at r = x - xi."""
        return np.asarray(0.5 * self.eps * np.log(lag**2 + self.depth**2))


OWN_MODELS = (Waves, Bed, Coated, Buried)


def with_own_model(
    seed: int, interaction: contact.Interaction, length: float, share: float = 0.15
) -> contact.Interaction:
    """Return the interaction; for some seeds one of `OWN_MODELS` is returned instead.

    The fraction of these seeds is `share`. A separate random generator draws the model, so that
    other scenes do not depend on it.
    """
    rng = np.random.default_rng([seed, 1])
    if rng.random() >= share or interaction.strip:
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
