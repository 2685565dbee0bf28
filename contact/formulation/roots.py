"""A root in a bracket whose ends are known: a function that is costly, or starts from where it was last, is not asked there again."""

from __future__ import annotations

import math
from collections.abc import Callable

from contact.extras import require

# Values at the most, points of an inverse polynomial, and a step below which rounding may keep the next from falling, over the place.
_MOST, _INVERSE, _ROUNDED = 100, 4, 1e-12


def bracketed(
    function: Callable[[float], float], known: dict[float, float], xtol: float, rtol: float = 4e-15, most: int = 100, strict: bool = False
) -> float:
    """The root by Brent's method (R. P. Brent, Algorithms for Minimization without Derivatives, 1973). known: the two ends and the values
    there, of opposite signs. strict: RuntimeError where the bracket does not close in `most` steps, else its last point."""
    root: float = require("scipy.optimize").brentq(
        lambda x: known[x] if x in known else function(x), *known, xtol=xtol, rtol=rtol, maxiter=most, disp=strict
    )
    return float(root)


def smooth_root(function: Callable[[float], float], known: dict[float, float], rtol: float = 1e-14) -> float:
    """The root of a smooth function by the inverse polynomial through its last values: where each asks for a solution these are fewer than
    Brent's, and none is spent on closing the bracket. known: as for `bracketed`; rtol: of the last step, from which on it is not taken to
    be worth one more value, as it is not where rounding keeps the steps from falling."""
    points = dict(known)
    low, high = sorted(points)
    rises, steps = points[low] < points[high], [math.inf, math.inf]
    for _ in range(_MOST):
        here = min(points, key=lambda x: abs(points[x]))
        if points[here] == 0.0:
            return here
        guess = _inverse(points)
        step = abs(guess - here)
        # What the step leaves is less of it than it is of the last one.
        closes = math.isfinite(steps[-1]) and step * step <= rtol * abs(guess) * steps[-1]
        if step <= rtol * abs(guess) or closes or (step > 0.5 * steps[-1] and step < _ROUNDED * abs(guess)):
            return guess
        if not low < guess < high or step > 0.5 * steps[-2]:
            guess = 0.5 * (low + high)
            step = high - low
        steps.append(step)
        points[guess] = function(guess)
        low, high = (guess, high) if (points[guess] < 0.0) == rises else (low, guess)
    raise RuntimeError(f"no root was closed in on between {low!r} and {high!r}")


def _inverse(points: dict[float, float]) -> float:
    """Where the polynomial in the value, through the points of the smallest values, is at zero (Neville's scheme)."""
    chosen = sorted(points, key=lambda x: abs(points[x]))[:_INVERSE]
    at, values = list(chosen), [points[x] for x in chosen]
    if len(set(values)) < len(values):
        return math.nan
    for level in range(1, len(at)):
        for i in range(len(at) - level):
            at[i] = (values[i + level] * at[i] - values[i] * at[i + 1]) / (values[i + level] - values[i])
    return at[0]
