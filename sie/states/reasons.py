"""The reason why a solution on given zones is not more accurate, in words.

The reason is the largest part of the stated error. A state is a `State` or a `SlitState`; it has
the type `Any` here, because `sie.states.base` imports this file.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from sie.basis.data import EPS, SUM_ROUNDING, record
from sie.dense import modes
from sie.states.options import CHECK_ANGLES, CHECK_POINTS
from sie.states.options import OPTIONS as ERRORS


@dataclass(frozen=True)
class ReasonOptions:
    """Limit that decides which cause is named as the reason for an error."""

    # The residuals of the equations change the density. If this change, divided by the residuals,
    # is above this ratio, the side conditions nearly depend on each other. A residual counts as
    # round-off if it is at most this number times the round-off of its terms.
    max_ratio: float = 1e4


OPTIONS = ReasonOptions()


def reason_of(state: Any, tol: float) -> str:
    """The reason, as a message, for the largest part of the stated error of a state."""
    iteration, conditions, resolution = _parts(state)
    # `iteration` and `resolution` are errors of the density. `resolution` contains the error of the
    # iteration times the number of modes, so `iteration` is compared with a small fraction of it.
    if iteration > max(0.1 * tol, ERRORS.negligible * resolution):
        return (
            "the iteration that solves many zones does not converge: the density has a relative "
            f"error of {iteration:.1e}, perhaps because side conditions nearly contradict each "
            "other"
        )
    worst = _Worst.of(state)
    largest = max(_causes(worst).values())
    rows = max(largest, EPS * worst.terms / max(state.size, 1e-300))
    if largest < ERRORS.negligible and conditions > max(resolution, OPTIONS.max_ratio * rows):
        return (
            f"errors of the linear system change the density by {conditions:.1e}, which is "
            f"{conditions / rows:.0e} times as much as these errors: the side conditions nearly "
            "depend on each other"
        )
    return _of_resolution(worst, tol)


def _parts(state: Any) -> tuple[float, float, float]:
    """Relative errors of the density due to (iteration, errors of the rows, other causes).
    The rows are those of the linear system.
    """
    size = max(state.size, 1e-300)
    iteration = float(state.linear_error.max(initial=0.0)) / size + state.rest
    conditions = float(state.whole.density_rounding.max(initial=0.0)) / size
    return iteration, conditions, state.density_error - iteration - conditions


@record
class _Worst:
    """The zone with the largest residual or neglected coefficients, and quantities on this zone.

    state: state of the zones without slits, or of the wide zones; zone: index of the zone in
    `state`; where: name of the zone in messages; residual: the largest residual, times
    sqrt(1 - t^2); place: x of this residual; terms: size of the terms whose sum is the residual.
    """

    state: Any
    zone: int
    where: str
    residual: float
    place: float
    terms: float

    @classmethod
    def of(cls, state: Any) -> _Worst:
        whole, zones = state.whole, state.density.zones
        solved = state.checked_zones
        residuals, missing = np.abs(state._residuals), np.asarray(state.left_out)[solved]
        row = int(np.argmax(np.maximum(residuals.max(axis=1), missing)))
        column = int(residuals[row].argmax())
        piece = int(solved[row])
        place = float(
            zones.middle[piece] + zones.half[piece] * math.cos(CHECK_ANGLES[column % CHECK_POINTS])
        )
        zone = int(whole_zone(state, piece))
        values = float(np.abs(state.right_side(np.array([place])))[0])
        terms = values + float(
            np.abs(whole.density.coefficients[zone]).sum() + np.abs(whole.system.known[zone]).sum()
        )
        sizes = whole.system.field_sizes
        if sizes is not None:
            # In sums over quadrature nodes, terms may cancel. The product below bounds the size of
            # the terms.
            terms += float(sizes.max() * np.abs(whole.unknowns).sum())
        return cls(
            whole,
            zone,
            f"zone {piece} (counted from 0)",
            float(residuals[row, column]),
            place,
            terms,
        )


def whole_zone(state: Any, piece: int) -> int:
    """Index of the wide zone (zones joined across slits) that contains the zone `piece`."""
    return int(state.wide_of(np.array([piece]))[1][0])


def _causes(worst: _Worst) -> dict[str, float]:
    """Relative errors measured on the zone with the largest residual, by their cause."""
    state, zone = worst.state, worst.zone
    zones, equation, m = state.density.zones, state.equation, int(state.system.layout.m[zone])
    fall = float(modes.decay(zones, equation.kernel)[zone])
    # Round-off of positions on the zone, divided by the zone's half width. All zones have at least
    # 4 `EPS`, which is subtracted.
    rounded = max(float(modes.place_rounding(zones, np.array([zone]))[0]) - 4 * EPS, 0.0)
    # The right side counts as a cause only if its coefficients no longer decay, or if their number
    # is at its limit. The cause "fields" (the field on the zone varies too fast for its modes)
    # counts only if the number of modes is at its limit, or if more modes do not help.
    unfallen = bool(state._stopped[zone]) or int(state.sizes.own[zone]) >= modes.OPTIONS.max_nodes
    grown = m >= modes.most(equation.kernel) or _is_noisy(worst)
    return {
        "right side": float(state.truncation[zone]) if unfallen else 0.0,
        "neighbour": math.exp(-fall * m) if math.isfinite(fall) else 0.0,
        "places": rounded,
        "fields": float(state.tails[zone]) if equation.grows and grown else 0.0,
    }


def _is_noisy(worst: _Worst) -> bool:
    """Whether more modes no longer reduce the last coefficients of the field on the zone."""
    growth = worst.state.sizes.growth
    return growth is not None and bool(growth.floor[worst.zone] > 0.0)


def _of_resolution(worst: _Worst, tol: float) -> str:
    """Message that names the largest cause of error on the zone with the largest residual.

    If none is large, the message names round-off or the residual.
    """
    state, m, causes = worst.state, int(worst.state.system.layout.m[worst.zone]), _causes(worst)
    neighbour, rounded, noisy = causes["neighbour"], causes["places"], _is_noisy(worst)
    cause = max(causes, key=lambda name: causes[name])
    if causes[cause] < max(ERRORS.negligible * tol, SUM_ROUNDING):
        cause = "none"
    if cause == "neighbour":
        return (
            f"{worst.where} lies so close to another zone, or to the image of a zone, that {m} "
            f"modes do not resolve the density: their truncation error is about {neighbour:.1e}"
        )
    if cause == "places":
        return (
            f"positions on {worst.where} are rounded to {rounded:.1e} of its half width: move the "
            "origin x = 0 close to this zone"
        )
    if cause == "fields":
        why = (
            "more modes do not help, so the function is noisy or rounded"
            if noisy
            else "the function varies too fast"
        )
        return (
            f"on {worst.where} the last of {m} modes of {_of_user(state)} is {causes[cause]:.1e} "
            f"of the largest: {why}"
        )
    if cause == "right side":
        return _of_right_side(worst)
    rounding = EPS * worst.terms
    if worst.residual <= OPTIONS.max_ratio * rounding:
        return (
            f"rounding limits the accuracy: terms of the size {worst.terms:.1e} add up to a "
            f"density of the size {state.size:.1e}"
        )
    return (
        f"at x = {worst.place:.6g} on {worst.where}, between the points at which the equation is "
        f"solved, the residual of the equation is {worst.residual:.1e}, for a density of the size "
        f"{state.size:.1e}"
    )


def _of_user(state: Any) -> str:
    """The user's functions for which the number of modes grows, as words of a message."""
    of_columns = any(column.resolution.modes is None for column in state.equation.columns)
    if not state.equation.kernel.grows:
        return "a column"
    return "a column or of the kernel's regular part" if of_columns else "the kernel's regular part"


def _of_right_side(worst: _Worst) -> str:
    """Message about the decay of the right side's coefficients on a zone, with a likely reason."""
    state, zone = worst.state, worst.zone
    n, last = int(state.kept[zone]), float(state.truncation[zone])
    falls = "no longer decay" if bool(state._stopped[zone]) else "decay too slowly"
    return (
        f"on {worst.where} the last of {n} coefficients of the right side"
        f"{_less_jumps(state, zone)} is {last:.1e} of the largest, and they {falls}: the right "
        "side is rounded or noisy there, varies too fast, is singular, or it or a derivative "
        "jumps: declare such jumps by sie.Jumps"
    )


def _less_jumps(state: Any, zone: int) -> str:
    """Words of a message on the number of declared jumps on a zone; '' if there are none."""
    count = int(np.count_nonzero(state.system.jumps.zone == zone))
    return f" without its {count} declared jumps" if count else ""
