"""Newton's method onto a curve of equilibria, in a plane normal to a predicted motion."""

import numpy as np

from contact.adhesion.curve import ACCURACY, Curve, NoState, State
from contact.adhesion.curve_point import CurvePoint
from contact.adhesion.options import MOVES
from contact.errors import NotConverged
from contact.formulation.tables import outward
from sie import Array


def along(curve: Curve, here: CurvePoint, length: float, tight: bool = True) -> State | None:
    """The equilibrium at which the curve crosses a plane at the distance `length` from `here`.
    The plane is normal to the tangent at `here`.

    None if Newton's method does not reach it.
    """
    return corrected(curve, here, here.ahead(length), here.tangent, tight)


def corrected(
    curve: Curve, here: CurvePoint, start: Array, normal: Array, tight: bool
) -> State | None:
    """The equilibrium at which the curve crosses the plane through `start` with this normal.

    None if Newton's method does not reach it.
    """
    if curve.formally is curve:
        return _newton(curve, here, start, normal, tight)[0]
    # Newton's method runs on `curve.formally`, which keeps the number of zones of contact and does
    # not test the signs of pressure and gap. These signs are tested once, at the equilibrium
    # `found`.
    found, reached = _newton(curve.formally, here, start, normal, tight, True)
    if found is not None and curve.has_right_zones(found):
        return found
    return None if reached is None else _newton(curve, here, reached, normal, tight)[0]


def _newton(
    curve: Curve, here: CurvePoint, start: Array, normal: Array, tight: bool, formal: bool = False
) -> tuple[State | None, Array | None]:
    """(equilibrium or None if not found, last iterate or None if no retry can succeed).
    The equilibrium is sought by Newton's method in the plane through `start` with the given normal.

    formal: the zones of contact inside the intervals keep their number.
    """
    at_start, widths, unit = here.at, here.scales[:-1], float(here.scales[-1])
    pinned = None if at_start.corners is None else at_start.pinned
    tolerance = ACCURACY.density if tight else ACCURACY.rough
    # The search is given up if a Newton step is too long, compared with the step along the curve.
    # The limit has a lower bound, because the first iterate may have a low accuracy.
    longest, before = max(float(np.linalg.norm(start)), 10 * ACCURACY.resting_step), np.inf
    for k in range(ACCURACY.max_newton_steps):
        table = at_start.moved(start[:-1] * widths)
        if at_start.corners is not None:
            table, start = curve.within(table), start.copy()
            start[:-1] = outward(at_start.table, table) / widths
        if np.any(np.diff(table.ravel()) <= 0) or curve.gaps(table)[-1] <= 0.0:
            return None, None
        try:
            at = curve.at(table, at_start.value + start[-1] * unit, tolerance, pinned)
        except (NoState, NotConverged):
            return None, start
        if formal and len(at.contact) != len(at_start.contact):
            return None, start
        matrix = np.vstack((np.column_stack((at.rates, at.by_value)) * here.scales, normal))
        try:
            step = np.linalg.solve(matrix, np.append(-at.residual, 0.0))
        except np.linalg.LinAlgError:
            # The matrix is singular if a zone can move freely along a level stretch of the profile.
            return None, None
        size = float(np.abs(step).max())
        if size > (1.0 if k else MOVES.least_part) * longest:
            return None, None
        rounded = 0.5 * before < size < ACCURACY.resting_step
        if size < (ACCURACY.neutral if tight else ACCURACY.rough) or (rounded and not tight):
            return at, start
        start = start + step
        # The iteration ends if the next Newton step is predicted to be shorter than
        # `ACCURACY.neutral`. For this prediction, steps shrink by the factor `size / before`. The
        # iteration also ends if a short step is more than half of the step before (`rounded`),
        # because such a step is round-off.
        if size * min(size / before if k else 1.0, 1.0) < ACCURACY.neutral or rounded:
            table = at_start.moved(start[:-1] * widths)
            return curve.at(table, at_start.value + start[-1] * unit, pinned=pinned), start
        before = size
    return None, start
