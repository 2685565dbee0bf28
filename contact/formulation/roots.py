"""A root in a bracket whose ends are known: a function that is costly, or starts from where it was
last, is not asked there again. And the largest value of a sampled function, followed below the
sampling.
"""

import math
from collections.abc import Callable

import numpy as np

from sie import Array

# Values at the most, points of an inverse polynomial, and a step below which rounding may keep the
# next from falling, over the place. A bracket so narrow over the first one is closed, wherever the
# root.
_MOST = 100
_INVERSE = 4
_ROUNDED = 1e-12
_OF_SPAN = 1e-16


def smooth_root(
    function: Callable[[float], float], known: dict[float, float], rtol: float = 1e-14
) -> float:
    """The root of a smooth function by the inverse polynomial through its last values: where each
    asks for a solution these are fewer than Brent's, and none is spent on closing the bracket.
    known: places and the values there, somewhere of opposite signs; rtol: of the last step, from
    which on it is not taken to be worth one more value, as it is not where rounding keeps the steps
    from falling.
    """
    points, places = dict(known), sorted(known)
    low, high = next(
        (a, b)
        for a, b in zip(places[:-1], places[1:], strict=True)
        if points[a] == 0.0 or points[a] * points[b] <= 0.0
    )
    rises, steps, span = points[low] < points[high], [math.inf, math.inf], high - low
    for _ in range(_MOST):
        here = min(points, key=lambda x: abs(points[x]))
        if points[here] == 0.0 or high - low <= max(rtol * abs(here), _OF_SPAN * span):
            return here
        guess = _inverse(points)
        step = abs(guess - here)
        # What the step leaves is less of it than it is of the last one.
        closes = math.isfinite(steps[-1]) and step * step <= rtol * abs(guess) * steps[-1]
        if (
            step <= rtol * abs(guess)
            or closes
            or (step > 0.5 * steps[-1] and step < _ROUNDED * abs(guess))
        ):
            return guess
        if not low < guess < high or step > 0.5 * steps[-2]:
            guess = 0.5 * (low + high)
            step = high - low
        steps.append(step)
        points[guess] = function(guess)
        low, high = (guess, high) if (points[guess] < 0.0) == rises else (low, guess)
    raise RuntimeError(f"no root was closed in on between {low!r} and {high!r}")


def _inverse(points: dict[float, float]) -> float:
    """Where the polynomial in the value, through the points of the smallest values, is at zero
    (Neville's scheme).
    """
    chosen = sorted(points, key=lambda x: abs(points[x]))[:_INVERSE]
    at, values = list(chosen), [points[x] for x in chosen]
    if len(set(values)) < len(values):
        return math.nan
    for level in range(1, len(at)):
        for i in range(len(at) - level):
            at[i] = (values[i + level] * at[i] - values[i] * at[i + 1]) / (
                values[i + level] - values[i]
            )
    return at[0]


def reaches(value: Array) -> Array:
    """How high a function may rise about each of its samples, along the last axis: twice as far
    above a peak as a parabola through it and its neighbours; -inf at samples that are none.
    """
    beside = np.concatenate((value[..., :1], value, value[..., -1:]), axis=-1)
    before, after = beside[..., :-2], beside[..., 2:]
    with np.errstate(invalid="ignore"):
        rise = 0.25 * (2 * value - before - after)
    rise = np.where(np.isfinite(rise), rise, 0.0)
    return np.asarray(np.where((value >= before) & (value >= after), value + rise, -np.inf))


def maximum(
    function: Callable[[Array], Array],
    x: Array,
    levels: int = 9,
    peaks: int = 64,
    value: Array | None = None,
) -> tuple[float, float]:
    """(position, value) of the maximum of `function` about the ascending samples x; every peak that
    may be the highest is zoomed into, at most so many `peaks`. value: that at the samples, where it
    is known.

    Each of `levels` zooms narrows the bracket fourfold, and a parabola through the last samples
    rises to the top: at a smooth maximum the value is then exact to rounding.
    """
    value = np.asarray(function(x)) if value is None else value
    value = np.where(np.isnan(value), -np.inf, value)
    reach = reaches(value)
    top = np.flatnonzero(reach >= value.max())
    top = top[np.argsort(reach[top], kind="stable")][-peaks:]
    top = top[np.argsort(value[top], kind="stable")]
    sampled = float(x[top[-1]]), float(value[top[-1]])
    if not np.isfinite(sampled[1]):
        return sampled
    lo, hi = x[np.maximum(top - 1, 0)], x[np.minimum(top + 1, len(x) - 1)]
    fine, here = x[top][:, None], value[top][:, None]
    for _ in range(levels):
        fine = lo[:, None] + (hi - lo)[:, None] * np.linspace(0, 1, 9)
        here = np.asarray(function(fine.ravel())).reshape(fine.shape)
        here = np.where(np.isnan(here), -np.inf, here)
        # Only those that may still be the highest.
        may = reaches(here).max(axis=1) >= here.max()
        lo, hi, fine, here = lo[may], hi[may], fine[may], here[may]
        best, rows = np.argmax(here, axis=1), np.arange(len(here))
        lo, hi = fine[rows, np.maximum(best - 1, 0)], fine[rows, np.minimum(best + 1, 8)]
    k = int(np.argmax(here))
    found, highest = float(fine.ravel()[k]), float(here.ravel()[k])
    row, column = divmod(k, here.shape[1])
    if (
        here.shape[1] > 1
        and 0 < column < here.shape[1] - 1
        and np.all(np.isfinite(here[row, column - 1 : column + 2]))
    ):
        before, after = here[row, [column - 1, column + 1]]
        bend = 2 * highest - before - after
        # A parabola with its top between the neighbours rises above the middle sample by an eighth
        # of the bend at most.
        highest += min((after - before) ** 2 / (8 * bend), 0.125 * bend) if bend > 0 else 0.0
    return sampled if sampled[1] > highest else (found, highest)


def minimum(function: Callable[[Array], Array], x: Array) -> tuple[float, float]:
    """(position, value) of the minimum, likewise."""
    place, value = maximum(lambda at: -np.asarray(function(at)), x)
    return place, -value
