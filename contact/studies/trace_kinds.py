"""Random periodic traces of many kinds of surfaces, as instruments record them.

`drawn(rng, kind, points)` returns one trace, a `contact.Sampled` of one period; `KINDS` names the
kinds. Lengths are those of stylus traces: a pitch of 0.1 to 1 um, heights of 0.01 to 10 um.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import contact

Array = NDArray[np.float64]
Rng = np.random.Generator


def self_affine_heights(
    rng: Rng, n: int, hurst: float, longest: int = 1, shortest: float = 0.25
) -> Array:
    """Heights of rms 1. The amplitude of the k-th harmonic is proportional to k^-(1/2 + hurst).

    The phases are random. The harmonics go from `longest` to the fraction `shortest` of the number
    of points.
    """
    k = np.arange(n // 2 + 1)
    size = np.where(
        (k >= longest) & (k <= max(shortest * n, longest + 1)),
        np.maximum(k, 1.0) ** (-0.5 - hurst),
        0.0,
    )
    height = np.fft.irfft(size * np.exp(2j * np.pi * rng.random(len(k))), n)
    return np.asarray(height / height.std())


def rough(rng: Rng, n: int) -> Array:
    """A self-affine surface of random Hurst exponent, often with a roll-off."""
    return self_affine_heights(
        rng, n, rng.uniform(0.2, 1.0), int(rng.choice([1, 3, 10])), rng.choice([0.02, 0.1, 0.5])
    )


def ground(rng: Rng, n: int) -> Array:
    """Many scratches of all depths on a rough base, each scratch with ridges at its sides."""
    x, out = np.arange(n) / n, 0.1 * rough(rng, n)
    for at, depth, width in zip(
        rng.random(60), rng.exponential(1.0, 60), rng.uniform(2, 30, 60) / n, strict=True
    ):
        t = ((x - at + 0.5) % 1 - 0.5) / width
        out += depth * (t**2 - 1) * np.exp(-(t**2))
    return out


def honed(rng: Rng, n: int) -> Array:
    """A plateau of fine roughness cut by a few deep grooves."""
    x, out = np.arange(n) / n, 0.05 * rough(rng, n)
    for at, depth in zip(rng.random(8), rng.uniform(1, 5, 8), strict=True):
        t = np.abs((x - at + 0.5) % 1 - 0.5) * n / rng.uniform(5, 40)
        out -= depth * np.maximum(1 - t, 0.0)
    return out


def plateaus(rng: Rng, n: int) -> Array:
    """A rough surface worn down to one height, with fine roughness on the plateaus."""
    base = rough(rng, n)
    return np.asarray(
        np.minimum(base, np.quantile(base, rng.uniform(0.3, 0.9)))
        + 10 ** rng.uniform(-4, -2) * rough(rng, n)
    )


def wear_flats(rng: Rng, n: int) -> Array:
    """A rough surface cut off at one height, so that its plateaus are exactly flat."""
    base = self_affine_heights(rng, n, rng.uniform(0.5, 1.0))
    return np.asarray(np.minimum(base, np.quantile(base, rng.uniform(0.5, 0.95))))


def quantized(rng: Rng, n: int) -> Array:
    """Rough heights quantized in steps of 1e-5 to 1e-2 of the range of the heights."""
    base = rough(rng, n)
    step = np.ptp(base) * 10 ** rng.uniform(-5, -2)
    return np.asarray(np.round(base / step) * step)


def spikes(rng: Rng, n: int) -> Array:
    """Smooth waves with a few outliers as high as the waves."""
    out = self_affine_heights(rng, n, 1.0, 2, 0.01)
    at = rng.choice(n, 12, replace=False)
    out[at] += rng.uniform(-3, 3, 12)
    return out


def steps(rng: Rng, n: int) -> Array:
    """Terraces at random heights, with noise."""
    borders = np.sort(rng.choice(n, 9, replace=False))
    return np.asarray(
        rng.normal(size=10)[np.searchsorted(borders, np.arange(n)) % 9]
        + 10 ** rng.uniform(-4, -1) * rng.normal(size=n)
    )


def white_noise(rng: Rng, n: int) -> Array:
    """White noise: independent normally distributed heights."""
    return np.asarray(rng.normal(size=n))


def turned(rng: Rng, n: int) -> Array:
    """The parabolic arcs that a turning tool leaves, with noise."""
    t = (np.arange(n) * int(rng.integers(3, 30)) / n) % 1
    return np.asarray(4 * (t - 0.5) ** 2 + 10 ** rng.uniform(-5, -1) * rng.normal(size=n))


def waviness(rng: Rng, n: int) -> Array:
    """Long waves with roughness a thousand times lower."""
    return np.asarray(self_affine_heights(rng, n, 1.0, 1, 8 / n) + 1e-3 * rough(rng, n))


def texture(rng: Rng, n: int) -> Array:
    """A sinusoidal texture with a little noise."""
    phase = 2 * np.pi * int(rng.integers(1, 20)) * np.arange(n) / n
    return np.asarray(np.sin(phase) + 10 ** rng.uniform(-9, -2) * rng.normal(size=n))


def staircase(rng: Rng, n: int) -> Array:
    """Waves whose heights are quantized to a few dozen steps, each step flat over many points."""
    return np.asarray(np.round(self_affine_heights(rng, n, 1.0, 1, 12 / n) * rng.uniform(3, 12)))


KINDS: dict[str, Callable[[Rng, int], Array]] = {
    made.__name__: made
    for made in (
        rough,
        ground,
        honed,
        plateaus,
        wear_flats,
        quantized,
        spikes,
        steps,
        white_noise,
        turned,
        waviness,
        texture,
        staircase,
    )
}
# Spacings of the sample positions of a trace, explained in the docstring of `drawn`.
POSITIONS = ("even", "rounded", "uneven")


def drawn(rng: Rng, kind: str, points: int, positions: str = "even") -> contact.Sampled:
    """Return one random trace of a kind of surface.

    Its positions are "even", "rounded" to a hundredth of the pitch, or "uneven" by up to 0.4 times
    the pitch.
    """
    pitch, height = 10.0 ** rng.uniform(-7, -6), 10.0 ** rng.uniform(-8, -5)
    at = np.arange(points, dtype=float)
    if positions == "rounded":
        at = np.round(at * 1.00037, 2)
    elif positions == "uneven":
        at = at + rng.uniform(-0.4, 0.4, points)
    values = KINDS[kind](rng, points)
    # The heights are reduced so that no slope is above 1, as on real surfaces.
    steepest = float(np.abs(np.diff(values)).max()) / pitch
    return contact.Sampled(
        at * pitch,
        min(height / values.std(), 1.0 / steepest) * values,
        period=1.00037 * points * pitch,
    )
