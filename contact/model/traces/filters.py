"""Gaussian profile filters (ISO 16610-21): a low-pass filter, and a high-pass by the difference.

The weight is s(t) = exp(-pi (t/(alpha lambda))^2)/(alpha lambda) with alpha = sqrt(ln 2/pi) =
0.4697. A wave of length l is multiplied by exp(-pi (alpha lambda/l)^2), which is 1/2 at the cut-off
lambda. Around each point a straight line is fitted with these weights (ISO 16610-28), so that the
filter does not change straight lines. Near the ends of the trace, only the weights of measured
points count.
"""

from math import ceil, log, pi, sqrt
from typing import Any

import numpy as np

from contact.errors import SceneError
from contact.model.checks import positive_or_none
from contact.model.profiles.noise import EPS
from contact.model.units import quantity
from sie import Array

ALPHA = sqrt(log(2) / pi)
# Distance up to which the Gaussian weights are used, in cut-off wavelengths. Weights at larger
# distances are below the round-off of the largest weight.
_REACH = ALPHA * sqrt(-log(EPS) / pi)
# Largest deviation from equal spacing, relative to the pitch, that is neglected.
MAX_UNEVENNESS = 1e-3


def refuse_cut_offs(lambda_s: Any, lambda_c: Any) -> None:
    """Raise SceneError if the cut-offs are not lengths [m] in the right order."""
    short, long = positive_or_none("lambda_s", lambda_s), positive_or_none("lambda_c", lambda_c)
    if short is not None and long is not None and not short < long:
        raise SceneError.of("lambda_s", lambda_s, f"below lambda_c = {long!r}")


def low_pass(x: Array, height: Array, cut_off: float, name: str) -> Array:
    """Low-pass filtered heights at evenly spaced positions; `name` is the cut-off's name in
    error messages.
    """
    length = float(x[-1] - x[0])
    pitch = length / (x.size - 1)
    uneven = float(np.max(np.abs(x - np.linspace(x[0], x[-1], x.size))))
    if uneven > MAX_UNEVENNESS * pitch:
        raise SceneError.of(
            name,
            cut_off,
            "left out if the positions are not evenly spaced; regrid = true makes them so",
        )
    # Points at a constant distance (the pitch) represent no wavelengths shorter than two pitches.
    shortest = 2 * pitch
    if not shortest <= cut_off <= length:
        allowed = "in metres, from two pitches to the length of the trace"
        limits = f"{quantity(shortest, 'm')} to {quantity(length, 'm')}"
        raise SceneError.of(name, cut_off, f"{allowed} ({limits})")
    reach = min(x.size - 1, ceil(_REACH * cut_off / pitch))
    t = np.arange(-reach, reach + 1) * pitch / cut_off
    weight = np.exp(-pi * (t / ALPHA) ** 2)
    level = float(np.mean(height))
    ones = np.ones_like(height)
    # A straight line is fitted around each point. `s0`, `s1`, `s2` are the sums of the weight times
    # 1, t, t^2, and `h0`, `h1` those of the weighted heights times 1, t. The minus signs of odd
    # powers are needed because a convolution reverses its kernel.
    s0, s2 = _convolved(ones, weight), _convolved(ones, weight * t**2)
    s1, h0, h1 = (
        -_convolved(ones, weight * t),
        _convolved(height - level, weight),
        -_convolved(height - level, weight * t),
    )
    return np.asarray(level + (s2 * h0 - s1 * h1) / (s2 * s0 - s1**2))


def _convolved(values: Array, kernel: Array) -> Array:
    """The central part of a convolution, of the same length as `values`."""
    size = values.size + kernel.size - 1
    whole = np.fft.irfft(np.fft.rfft(values, size) * np.fft.rfft(kernel, size), size)
    first = kernel.size // 2
    return np.asarray(whole[first : first + values.size])
