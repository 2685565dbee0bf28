"""Rims: zones whose density has two different given values at their ends, as beside a plateau.

This file treats rims that are much narrower than the plateau and the gap beside them. On a rim the
density passes from one value to the other, like arccos(t) / pi times the difference v of the
values. On the rim, the transform of this passage and of the plateau is nearly constant, and
contains -(v / pi) log(width): so the width falls exponentially with the right side, and may be far
below round-off. At distances of many widths the field is that of a jump at the rim's middle, with a
relative error of (width / distance)^2. So a rim is computed with a least width. Its *depth* is the
logarithm of the ratio of the true width to the width used. Newton's method finds the middle of such
a rim from its level (the constant of the potential), and the logarithm of the width from the
transform:

* A charge q on the rim, with the density q / (pi w sqrt(1 - t^2)), moves the middle by q / v.
* A constant c in the transform, with the density -c t / sqrt(1 - t^2), changes log(width) by
  pi c / v.

Both follow from the intensities K by delta = 2 K / A, with the edge slope A = v sqrt(2 / w) / pi of
the passage.
"""

from dataclasses import replace

import numpy as np

from sie.basis.data import HALF_DIGITS, Array, Mask
from sie.basis.zones import Zones
from sie.dense import modes
from sie.ends.limits import border_distances
from sie.ends.options import NewtonOptions
from sie.ends.steps import LastMoves, NewtonStep, wanted_signs
from sie.equation.equation import Equation
from sie.slits.system import AnyState

OPTIONS = NewtonOptions()


def room_beside(zones: Zones, equation: Equation) -> Array:
    """Width of the narrower of the two gaps or plateaus beside each zone (Z,)."""
    gaps = np.array(modes.gaps(zones, equation.kernel))
    return np.asarray(np.minimum(gaps, border_distances(zones, equation)).min(axis=0))


def are_narrow(zones: Zones, equation: Equation) -> Mask:
    """Mask (Z,) of narrow rims, much narrower than the gap and the plateau next to them.
    A rim is a zone with two different given values of the density at its ends. It may also lie
    between two plateaus.
    """
    if not zones.have_values or not zones.weight.is_half:
        return np.zeros(len(zones), dtype=bool)
    part = OPTIONS.max_shrink
    return np.asarray(zones.rims & (2 * zones.half < part * room_beside(zones, equation)))


def end_scales(zones: Zones, equation: Equation) -> Array:
    """Reference length of each zone (Z,), by which errors of its ends are divided.

    It is the width of the zone or, for a narrow rim, that of the narrower gap or plateau beside it.
    """
    width = 2 * zones.half
    if not zones.have_values or not zones.weight.is_half:
        return width
    return np.where(zones.rims, np.maximum(width, room_beside(zones, equation)), width)


def least_part(tolerance: float) -> float:
    """Least width of a rim, divided by the width of the narrower gap or plateau beside it.
    A rim is a zone with two different given values of the density at its ends.

    This width causes an error of the square of the ratio, times a condition number. The square is
    1e-4 of the tolerance.
    """
    return max(0.01 * float(np.sqrt(tolerance)), HALF_DIGITS)


def with_rim_steps(
    motion: NewtonStep, state: AnyState, options: NewtonOptions, tolerance: float
) -> NewtonStep:
    """The Newton step of the ends; the steps of narrow rims are computed in other variables.

    A rim is a zone with two different given values at its ends. Its variables are its middle and
    the logarithm of its width. tolerance: tolerance of the positions of the ends.
    """
    zones, equation = state.density.zones, state.equation
    narrow = np.flatnonzero(are_narrow(zones, equation))
    if len(narrow) == 0 or motion.residual is None:
        return motion
    values, half = zones.values[:, narrow], zones.half[narrow]
    width, room = 2 * half, room_beside(zones, equation)[narrow]
    delta, noise, weak = motion.delta.copy(), motion.noise.copy(), motion.weak.copy()
    slope = np.abs(values[1] - values[0]) * np.sqrt(2 / half) / np.pi
    side = wanted_signs(zones, options.signs)[:, narrow]
    plain = 2 * motion.residual[:, narrow] / (side * slope)
    rounding = 2 * state.intensity_noise[:, narrow] / slope
    least = np.log(np.minimum(least_part(tolerance) * room, width))
    most = np.log(np.maximum(options.max_shrink * room, width))
    # Near the solution, the plain Newton step `delta` is used, since the edge slopes contain the
    # variation of the right side on the rim. Farther away, the constant part of the residual
    # changes the edge slopes, so that the step uses `slope` instead.
    change = plain.sum(axis=0) / width
    near = (np.abs(change) < options.max_growth) & (np.log(width) + change > least) & ~weak[narrow]
    plain = np.where(near, delta[:, narrow], plain)
    noise[:, narrow] = np.where(near, noise[:, narrow], rounding)
    change = plain.sum(axis=0) / width
    # The mean potential on a rim contains the logarithm of the width assumed for the rim. So a
    # shift found with the assumed width is multiplied by the ratio of the two logarithms.
    assumed, true = (
        np.maximum(np.log(room / width) - part, 1.0) for part in (zones.depth[narrow], change)
    )
    # The shift of a rim follows from the unknown total of its density (`charge`). It could also
    # follow from the intensities K, but curvature of the right side changes these.
    charge = np.asarray(state.density.totals)[narrow] - half * values.sum(axis=0)
    by_charge = charge / (values[0] - values[1])
    shift = np.where(near, 0.5 * (plain[1] - plain[0]), by_charge) * assumed / true
    wanted = np.log(width) + change
    following = np.clip(wanted, least, most)
    wider = 0.5 * (np.exp(following) - width)
    depth = np.zeros(len(zones))
    delta[:, narrow], weak[narrow] = [wider - shift, wider + shift], False
    depth[narrow] = np.minimum(wanted - following, 0.0)
    return replace(motion, delta=delta, noise=noise, weak=weak, depth=depth)


def without_alternation(
    motion: NewtonStep, zones: Zones, narrow: Mask, last: LastMoves
) -> NewtonStep:
    """The Newton step, shortened on narrow rims for which it reverses the last step.
    It is then at most half as long as the last step. A rim is a zone with two different given
    values of the density at its ends.

    The right side on a rim may vary within the length of a step, so that steps would alternate.
    last: the last step, which led to the present zones.
    """
    assert motion.depth is not None
    width, (left, right) = 2 * zones.half, motion.delta
    least = OPTIONS.max_shrink**2
    with np.errstate(divide="ignore", invalid="ignore"):
        change = np.log(np.maximum(1 + (left + right) / width, 0.0))
        before = -np.log(np.maximum(1 - last.moves.sum(axis=0) / width, least))
        limited = _without_reversal(change, before)
        deeper = np.minimum(motion.depth + change - limited, 0.0)
    shift = _without_reversal(0.5 * (right - left), 0.5 * (last.moves[1] - last.moves[0]))
    wider = 0.5 * width * np.expm1(limited)
    return replace(
        motion,
        delta=np.where(narrow, [wider - shift, wider + shift], motion.delta),
        depth=np.where(narrow, deeper, 0.0),
    )


def _without_reversal(step: Array, last: Array) -> Array:
    turns = (step * last < 0.0) & (np.abs(step) > 0.5 * np.abs(last))
    return np.where(turns, -0.5 * last, step)
