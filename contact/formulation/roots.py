"""Roots and maxima of functions of one variable.

`smooth_root` needs few values of a costly function in a bracket. `maximum` follows a sampled
function between its samples.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contact.model.profiles.noise import EPS, ROUND_OFF
from sie import Array


@dataclass(frozen=True)
class RootOptions:
    """Limits of the search for a root of a smooth function in a bracket."""

    max_values: int = 100
    points: int = 4  # number of values in the inverse interpolation


_OPTIONS = RootOptions()


def smooth_root(
    function: Callable[[float], float], known: dict[float, float], rtol: float = 1e-14
) -> float:
    """The root of a smooth function in a bracket, by inverse interpolation of known values.

    It needs fewer values than Brent's method, as it does not close the bracket. known: places and
    values, two of them with opposite signs. rtol: the search stops at a step this small, or where
    rounding keeps the steps from falling.
    """
    points, places = dict(known), sorted(known)
    low, high = next(
        (a, b)
        for a, b in zip(places[:-1], places[1:], strict=True)
        if points[a] == 0.0 or points[a] * points[b] <= 0.0
    )
    rises, steps, span = points[low] < points[high], [math.inf, math.inf], high - low
    for _ in range(_OPTIONS.max_values):
        here = min(points, key=lambda x: abs(points[x]))
        if points[here] == 0.0 or high - low <= max(rtol * abs(here), EPS * span):
            return here
        guess = _inverse(points)
        step = abs(guess - here)
        # Convergence is superlinear: the next step would be at most about step^2 divided by the
        # step before. If this is below the tolerance, `guess` is the root.
        closes = math.isfinite(steps[-1]) and step * step <= rtol * abs(guess) * steps[-1]
        if (
            step <= rtol * abs(guess)
            or closes
            or (step > 0.5 * steps[-1] and step < ROUND_OFF * abs(guess))
        ):
            return guess
        if not low < guess < high or step > 0.5 * steps[-2]:
            guess = 0.5 * (low + high)
            step = high - low
        steps.append(step)
        points[guess] = function(guess)
        low, high = (guess, high) if (points[guess] < 0.0) == rises else (low, guess)
    raise RuntimeError(f"the search for a root between {low!r} and {high!r} did not converge")


def _inverse(points: dict[float, float]) -> float:
    """Estimate of the root by inverse interpolation of the values closest to 0 (Neville)."""
    chosen = sorted(points, key=lambda x: abs(points[x]))[: _OPTIONS.points]
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
    """Upper bound of a function near samples that are local maxima; -inf at all other samples.

    Samples are along the last axis. The bound exceeds the sample by a quarter of the second
    difference. This is twice the most that the parabola through the sample and its neighbours can
    reach.
    """
    padded = np.concatenate((value[..., :1], value, value[..., -1:]), axis=-1)
    before, after = padded[..., :-2], padded[..., 2:]
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
    """Position and value of the maximum of a function, searched around ascending samples x.

    At most `peaks` samples are zoomed into, namely those whose bound reaches the highest sample.
    Each of `levels` zooms narrows the bracket to a quarter. A parabola through the last samples
    then gives a smooth maximum to rounding. value: the function at the samples, if known.
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
        # Keep only the brackets that may contain the highest value of the function.
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
        # The parabola through three samples, the middle one the highest, exceeds the middle sample
        # by at most an eighth of the second difference. Round-off must not exceed this bound.
        highest += min((after - before) ** 2 / (8 * bend), 0.125 * bend) if bend > 0 else 0.0
    return sampled if sampled[1] > highest else (found, highest)


def minimum(function: Callable[[Array], Array], x: Array) -> tuple[float, float]:
    """Position and value of the minimum of a function, found as in `maximum`."""
    place, value = maximum(lambda at: -np.asarray(function(at)), x)
    return place, -value
