"""The largest value of a sampled function, followed below the sampling."""

from collections.abc import Callable

import numpy as np

from sie import Array


def reaches(value: Array) -> Array:
    """How high a function may rise about each of its samples, along the last axis: twice as far above a peak as a parabola through it
    and its neighbours; -inf at samples that are none."""
    beside = np.concatenate((value[..., :1], value, value[..., -1:]), axis=-1)
    before, after = beside[..., :-2], beside[..., 2:]
    with np.errstate(invalid="ignore"):
        rise = 0.25 * (2 * value - before - after)
    rise = np.where(np.isfinite(rise), rise, 0.0)
    return np.asarray(np.where((value >= before) & (value >= after), value + rise, -np.inf))


def maximum(
    function: Callable[[Array], Array], x: Array, levels: int = 9, peaks: int = 64, value: Array | None = None
) -> tuple[float, float]:
    """(position, value) of the maximum of `function` about the ascending samples x; every peak that may be the highest is zoomed into,
    at most so many `peaks`. value: that at the samples, where it is known.

    Each of `levels` zooms narrows the bracket fourfold, and a parabola through the last samples rises to the top: at a smooth
    maximum the value is then exact to rounding.
    """
    value = np.asarray(function(x)) if value is None else value
    value = np.where(np.isnan(value), -np.inf, value)
    reach = reaches(value)
    top = np.argsort(reach)[-peaks:]
    top = top[reach[top] >= value.max()]
    top = top[np.argsort(value[top], kind="stable")]
    if not np.isfinite(value[top[-1]]):
        return float(x[top[-1]]), float(value[top[-1]])
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
    if here.shape[1] > 1 and 0 < column < here.shape[1] - 1 and np.all(np.isfinite(here[row, column - 1 : column + 2])):
        before, after = here[row, [column - 1, column + 1]]
        bend = 2 * highest - before - after
        # A parabola with its top between the neighbours rises above the middle sample by an eighth of the bend at most.
        highest += min((after - before) ** 2 / (8 * bend), 0.125 * bend) if bend > 0 else 0.0
    if value[top[-1]] > highest:
        return float(x[top[-1]]), float(value[top[-1]])
    return found, highest
