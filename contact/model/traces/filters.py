"""Gaussian profile filters (ISO 16610-21): waves longer than a cut-off kept, and by their
difference the shorter ones.

The weight is s(t) = exp(-pi (t/(alpha lambda))^2)/(alpha lambda) with alpha = sqrt(ln 2/pi) =
0.4697, which lets a wave of length lambda through by half: one of the length l by exp(-pi (alpha
lambda/l)^2). Near the ends, where a part of the weights would fall beyond the trace, the height is
that of the straight line fitted with the weights that are left (ISO 16610-28): lines stay lines up
to the ends.
"""

from math import ceil, log, pi, sqrt
from typing import Any

import numpy as np

from contact.errors import SceneError
from contact.model.checks import positive_or_none
from contact.model.units import quantity
from sie import Array

ALPHA = sqrt(log(2) / pi)
# In cut-offs: so far away a weight is below 1e-17 of the largest.
_REACH = 1.7
# In pitches: a shorter cut-off leaves the points as they are.
_SHORTEST = 2.0
# In pitches: positions this near an even pitch are even, for a weight that is much wider.
_EVEN = 1e-3


def refuse_cut_offs(lambda_s: Any, lambda_c: Any) -> None:
    """SceneError where they are no lengths [m], or not in order; None: no filter."""
    short, long = positive_or_none("lambda_s", lambda_s), positive_or_none("lambda_c", lambda_c)
    if short is not None and long is not None and not short < long:
        raise SceneError.of("lambda_s", lambda_s, f"below lambda_c = {long!r}")


def low_pass(x: Array, height: Array, cut_off: float, name: str) -> Array:
    """What a Gaussian filter lets through of heights at even positions. name: what the cut-off is
    called where it is refused.
    """
    length = float(x[-1] - x[0])
    pitch = length / (x.size - 1)
    if float(np.max(np.abs(x - np.linspace(x[0], x[-1], x.size)))) > _EVEN * pitch:
        raise SceneError.of(
            name, cut_off, "left out where positions are not even: regrid = true makes them so"
        )
    if not _SHORTEST * pitch <= cut_off <= length:
        allowed = f"two pitches at least and the length of the trace at most, {quantity(_SHORTEST * pitch, 'm')} to {quantity(length, 'm')}"
        raise SceneError.of(name, cut_off, f"{allowed} (it is in metres)")
    reach = min(x.size - 1, ceil(_REACH * cut_off / pitch))
    t = np.arange(-reach, reach + 1) * pitch / cut_off
    weight = np.exp(-pi * (t / ALPHA) ** 2)
    level = float(np.mean(height))
    ones = np.ones_like(height)
    # The line through the heights at t = x_j - x_i: sums of weights, of weights times t, and of
    # t^2; kernels turned round.
    s0, s2 = _convolved(ones, weight), _convolved(ones, weight * t**2)
    s1, h0, h1 = (
        -_convolved(ones, weight * t),
        _convolved(height - level, weight),
        -_convolved(height - level, weight * t),
    )
    return np.asarray(level + (s2 * h0 - s1 * h1) / (s2 * s0 - s1**2))


def _convolved(values: Array, kernel: Array) -> Array:
    """The middle of a convolution, as long as the values."""
    size = values.size + kernel.size - 1
    whole = np.fft.irfft(np.fft.rfft(values, size) * np.fft.rfft(kernel, size), size)
    first = kernel.size // 2
    return np.asarray(whole[first : first + values.size])
