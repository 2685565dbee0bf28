"""Rims: zones between two values of the density, much narrower than the plateau and gap beside.

On a rim the density passes from one value to the other, like arccos(t) / pi of their difference v.
The transform of this passage and of the plateau is nearly constant there, and contains
-(v / pi) log(width): so the width falls exponentially with the right side, and may be far below
round-off. At distances of many widths the field is that of a jump at the rim's middle, with a
relative error of (width / distance)^2. So a rim keeps a least width, and its *depth*, the logarithm
of the true width over this one, says how much narrower it is. Newton's method finds the middle of
such a rim from its level, and the logarithm of the width from the transform:

* A charge q on the rim, of density q / (pi w sqrt(1 - t^2)), moves its middle by q / v.
* A constant c of the transform, of density -c t / sqrt(1 - t^2), changes log(width) by pi c / v.

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


OPTIONS = NewtonOptions()


def room_beside(zones: Zones, equation: Equation) -> Array:
    """Width of the narrower of the two gaps or plateaus beside each zone (Z,)."""
    gaps = np.array(modes.gaps(zones, equation.kernel))
    return np.asarray(np.minimum(gaps, border_distances(zones, equation)).min(axis=0))


def are_narrow(zones: Zones, equation: Equation) -> Mask:
    """Mask of the rims that are much narrower than the gaps or plateaus beside them (Z,)."""
    if not zones.have_values:
        return np.zeros(len(zones), dtype=bool)
    part = OPTIONS.max_shrink
    return np.asarray(zones.rims & (2 * zones.half < part * room_beside(zones, equation)))


def end_scales(zones: Zones, equation: Equation) -> Array:
    """Length to which errors of the ends of each zone are relative (Z,).

    It is the width of the zone or, for a narrow rim, that of the narrower gap or plateau beside it.
    """
    width = 2 * zones.half
    if not zones.have_values:
        return width
    return np.where(zones.rims, np.maximum(width, room_beside(zones, equation)), width)


def least_part(tolerance: float) -> float:
    """Least width of a rim over the narrower gap or plateau beside it.

    The error that it causes is the square of this, here a hundredth of the tolerance.
    """
    return max(0.1 * float(np.sqrt(tolerance)), HALF_DIGITS)


def with_rim_steps(
    motion: NewtonStep,
    zones: Zones,
    equation: Equation,
    noise: Array,
    options: NewtonOptions,
    tolerance: float,
    last: LastMoves | None,
) -> NewtonStep:
    """The Newton step, with those of narrow rims by their middle and the logarithm of the width.

    noise: round-off of the intensities (2, Z). last: the last step, if it has left the same zones.
    """
    narrow = are_narrow(zones, equation)
    if not narrow.any() or motion.residual is None:
        return motion
    values, width, room = zones.values, 2 * zones.half, room_beside(zones, equation)
    slope = np.abs(values[1] - values[0]) * np.sqrt(2 / zones.half) / np.pi
    with np.errstate(divide="ignore", invalid="ignore"):
        plain = 2 * motion.residual / (wanted_signs(zones, options.signs) * slope)
        rounding = 2 * noise / slope
        least = np.minimum(least_part(tolerance) * room, width)
        # Near the root, the edge slopes of the density know how the right side varies on the rim.
        # Farther away, c changes them.
        change = plain.sum(axis=0) / width
        near = (np.abs(change) < options.max_growth) & (np.log(width) + change > np.log(least))
        near &= ~motion.weak
        plain = np.where(near, motion.delta, plain)
        rounding = np.where(near, motion.noise, rounding)
        wanted = np.log(width) + plain.sum(axis=0) / width
        most = np.maximum(options.max_shrink * room, width)
        change = wanted - np.log(width)
        if last is not None:
            change = _less(change, -np.log1p(-np.minimum(last.moves.sum(axis=0) / width, 0.9)))
        following = np.exp(np.clip(np.log(width) + change, np.log(least), np.log(most)))
        # The level of the rim depends on the logarithm of the width that was assumed in it.
        assumed, true = (
            np.maximum(np.log(room / width) - part, 1.0)
            for part in (zones.depth, wanted - np.log(width))
        )
    shift = 0.5 * (plain[1] - plain[0]) * assumed / true
    if last is not None:
        shift = _less(shift, 0.5 * (last.moves[1] - last.moves[0]))
    wider = 0.5 * (following - width)
    return replace(
        motion,
        delta=np.where(narrow, [wider - shift, wider + shift], motion.delta),
        noise=np.where(narrow, rounding, motion.noise),
        weak=motion.weak & ~narrow,
        depth=np.where(narrow, np.minimum(wanted - np.log(following), 0.0), 0.0),
    )


def _less(step: Array, last: Array) -> Array:
    """The steps; one that turns back is at most half as long as the last one.

    The right side on a rim may vary within the length of a step, so that steps would alternate.
    """
    turns = (step * last < 0.0) & (np.abs(step) > 0.5 * np.abs(last))
    return np.where(turns, -0.5 * last, step)
