"""The slope of a profile whose author gave only its height.

Complex step: f'(x) = Im f(x + ih)/h for analytic f, exact to rounding (Squire & Trapp 1998, doi
10.1137/S003614459631241X).
It is believed only where central differences agree; else sixth-order central differences at a ladder of
steps, the step of each point chosen where two neighbouring steps agree best.
"""

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sie import Array, Mask

_TINY = 1e-100  # its square vanishes beside any length met, so the step has no truncation error
_APART = (1e2, 1e4, 1e6)  # how many times farther apart to look again
_SIXTH = ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60))  # f' = sum c_k (f(x + kh) - f(x - kh)) / h + O(h^6)
# Heights that tell how finely a shape varies, at first and at the most; terms of its slope that count, over the largest, and of one whose
# series has not come to its end, as of sharp corners; parts of a length that are looked at of any shape.
_FIRST, _LAST, _COUNTS, _OF_SHARP, _COARSEST = 256, 2**14, 1e-5, 0.1, 16
# By how much, over the largest slope, wide steps may differ from complex ones.
_WIDE = 1e-3
# Values that are the same but for their own rounding, over that.
_SAME = 16
# Rounding over a sixth difference that is nothing else; and over that which the size of f tells, where it is far more.
_OF_SIXTH, _FAR_MORE = 0.1, 4.0
# The doubt of a step that does not resolve f.
_LEAST_BELIEVED = 1e300


def slope_of(height: Callable[[Any], Any], x: Array, length: float | None = None, believed: bool = False) -> Array:
    """f'(x) from f alone; `length` is one over which f varies, if known; believed: complex steps have been checked."""
    if x.size == 0:
        return np.zeros(x.shape)
    if believed and (by_step := _complex_step(height, x)) is not None:
        return by_step
    by_differences, doubt = by_ladder(height, x, length)
    by_step = _complex_step(height, x)
    if by_step is None:
        return by_differences
    agrees = borne_out(height, x, length, by_step, by_differences, doubt)
    if agrees is not None:
        return by_step if agrees else by_differences
    # Points may be too close together for differences to tell f' from rounding: farther apart they can, of the same function.
    few = x.ravel()[:: max(1, x.size // 16)]
    middle, reach = few.mean(), np.ptp(few) or float(np.max(np.abs(few))) or 1.0
    for factor in _APART:
        spread = middle + factor * reach * np.linspace(-0.43, 0.5, 16)
        step = _complex_step(height, spread)
        if step is None:
            break
        if agree(step, *by_ladder(height, spread, length)):
            return by_step
    return by_differences


def right_by_step(height: Callable[[Any], Any], x: Array, length: float | None) -> bool:
    """Whether complex steps are right at all of these places at which differences are sure."""
    by_step = _complex_step(height, x)
    return by_step is not None and bool(agree(by_step, *by_ladder(height, x, length)))


def borne_out(
    height: Callable[[Any], Any], x: Array, length: float | None, by_step: Array, by_differences: Array, doubt: Array
) -> bool | None:
    """Whether differences bear complex steps out; None where they do not tell. They may be sure of what rounding makes of f, where a height
    like cosh(x) - 1 hides that: wider steps are not."""
    return agree(by_step, by_differences, doubt) or agree(by_step, *by_ladder(height, x, length, wide=True), _WIDE)


def agree(by_step: Array, by_differences: Array, doubt: Array, off: float = 1e-6) -> bool | None:
    """Whether complex steps are right (off: about) where differences are sure; None where they are so at half of the points or fewer.

    A height that takes |x| or drops the imaginary part gives a wrong answer of the size of f' itself.
    """
    scale = np.max(np.abs(by_differences), initial=0.0)
    sure = doubt <= 0.1 * off * scale
    tells = scale > 0.0 and 2 * np.sum(sure) > sure.size
    return bool(np.all(np.abs(by_step - by_differences)[sure] <= off * scale)) if tells else None


def imaginary(function: Callable[[Any], Any], z: NDArray[Any]) -> Array | None:
    """Imaginary part of an author's function of complex numbers; None where it takes none, or is not finite."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("error")  # a cast that discards the imaginary part is a warning of numpy
        try:
            value = np.asarray(function(z))
        except Exception:  # it may refuse them in any way it likes
            return None
    if value.dtype.kind != "c" or value.shape != z.shape:
        return None
    return np.asarray(value.imag, dtype=np.float64) if np.isfinite(value.imag).all() else None


def _complex_step(height: Callable[[Any], Any], x: Array) -> Array | None:
    value = imaginary(height, x + 1j * _TINY)
    return None if value is None else value / _TINY


def by_ladder(
    height: Callable[[Any], Any], x: Array, length: float | None, wide: bool = False, doubted: bool = False
) -> tuple[Array, Array]:
    """Central differences at the best step of each point, and how far they may be off.

    The doubt is the change from the step before plus what rounding of f makes of it: at tiny steps two
    quotients can agree exactly and be wrong together. At wide ones too, where f is level beside a narrow dip: steps that do not
    resolve f are believed least. wide: by the widest steps that come to something. Heights may be rounded by more than their size tells,
    as those of cosh(x) - 1 are: it is looked for in each step where wide or doubted, else in the sixth differences of all of them.
    """
    if length is not None:
        steps = length * 0.1 * 2.0 ** -np.arange(14)
    else:
        # No length is known: from the widest argument down by powers of four, to below any plausible feature.
        widest = max(float(np.max(np.abs(x))), 1.0)
        steps = widest * 4.0 ** -np.arange(24 + np.ceil(0.5 * np.log2(widest)))
    enough = 0.1 * _WIDE if wide else 0.0
    best, doubt = np.full(x.shape, np.nan), np.full(x.shape, np.inf)
    with np.errstate(all="ignore"):
        here = np.asarray(height(x), dtype=np.float64)
        rungs = [_difference(height, x, h, here) for h in steps]
        hidden = 0.0 if wide or doubted else _hidden(here, [sixth for *_, sixth in rungs])
        last = rungs[0][0]
        for h, (new, size, resolved, seen, _) in zip(steps[1:], rungs[1:], strict=True):
            if wide or doubted:
                hidden = seen or hidden
            noise = np.maximum(np.finfo(np.float64).eps * size, hidden)
            off = np.where(resolved, np.abs(new - last) + noise / h, _LEAST_BELIEVED)
            ended = doubt <= enough * np.max(np.abs(best), initial=0.0, where=np.isfinite(best))
            better = (off < doubt) & ~ended
            best = np.where(better, new, best)
            doubt = np.where(better, off, doubt)
            last = new
    return best, doubt


def _hidden(heights: Array, sixths: list[float]) -> float:
    """What heights are rounded by where that is far more than their size tells, else 0. sixths: medians of sixth differences, one for
    each step: of short ones they are rounding alone."""
    rounded = _OF_SIXTH * min((sixth for sixth in sixths if 0.0 < sixth < np.inf), default=0.0)
    return rounded if rounded > _FAR_MORE * np.finfo(np.float64).eps * float(np.median(np.abs(heights))) else 0.0


def _difference(height: Callable[[Any], Any], x: Array, h: float, here: Array) -> tuple[Array, Array, Mask, float, float]:
    """(the quotient, the size of f, whether its sixth difference is small beside its changes, what f may be rounded to, the median of the
    sixth difference); here: f(x)."""
    total, size, sixth = np.zeros(x.shape), np.abs(here), -20.0 * here
    low = high = here
    values = [here]
    for (k, weight), binomial in zip(_SIXTH, (15.0, -6.0, 1.0), strict=True):
        # The step actually taken in floating point, not the one asked for.
        ahead, behind = x + k * h, x - k * h
        right, left = np.asarray(height(ahead)), np.asarray(height(behind))
        total = total + 2 * k * weight * (right - left) / (ahead - behind)
        values += [left, right]
        low, high = np.minimum(low, np.minimum(left, right)), np.maximum(high, np.maximum(left, right))
        size = np.maximum(size, np.maximum(np.abs(right), np.abs(left)))
        sixth = sixth + binomial * (right + left)
    # Values are no closer than they are rounded to, and a sixth difference is at least that, but where steps change nothing.
    apart, least = np.diff(np.unique(values)), _SAME * np.finfo(np.float64).eps * np.max(np.abs(here), initial=0.0)
    quantum = float(np.min(apart[apart > least])) if np.any(apart > least) else 0.0
    largest = float(np.max(np.abs(sixth), initial=0.0))
    hidden = min(quantum, _OF_SIXTH * largest) if largest > least else quantum
    resolved = np.abs(sixth) <= high - low + 64 * np.finfo(np.float64).eps * size
    return total, size, resolved, hidden, float(np.median(np.abs(sixth)))


def detail_of(height: Callable[[Array], Any], lo: float, hi: float) -> float:
    """Smallest length over which heights vary between two places, from their Chebyshev series: that of the last term of the slope which
    counts."""
    length, n = hi - lo, _FIRST
    while True:
        with np.errstate(all="ignore"):
            # The ends themselves may be corners, beyond which there is no body.
            heights = np.asarray(height(lo + length * np.sin(0.25 * np.pi * (2 * np.arange(n) + 1) / n) ** 2), dtype=np.float64)
            slopes = np.arange(n) * np.abs(np.fft.rfft(np.concatenate((heights, heights[::-1])))[:n])
        most = float(slopes.max())
        if not 0.0 < most < np.inf:
            return length / _COARSEST
        ended = bool(slopes[-n // 8 :].max() <= _COUNTS * most)
        if ended or n >= _LAST:
            break
        n *= 4
    last = int(np.flatnonzero(slopes > (_COUNTS if ended else _OF_SHARP) * most)[-1])
    return min(np.pi / last, 1 / _COARSEST) * length
