"""Points of a curve of equilibria, with the tangent of the curve there.

Motions of ends are in units of the widths of the zones. The unit of the control is the change that
moves the fastest end by the width of its zone. In these units, one unit vector, the tangent, has
the motions of the ends and of the control. At a turning point the control has a maximum or minimum
along the curve.
"""

from dataclasses import dataclass, replace

import numpy as np

from contact.adhesion.curve import ACCURACY, Curve, State
from contact.adhesion.options import MOVES
from contact.formulation.tables import outward
from sie import Array, record


@dataclass(frozen=True)
class ArcOptions:
    """Options of the steps along a curve of equilibria; arc lengths are in units of zone widths."""

    # Upper bound of three quantities of a step: its length in zone widths, the angle [rad] between
    # the curve's tangents at both ends of the step, and the deviation of the predictor from the
    # tangent, divided by the length.
    longest_step: float = 0.5
    # Largest number of known equilibria from which `Step._about` interpolates. It is also the
    # largest number of times that `Step.at`, after failed solves, halves the distance to a known
    # equilibrium.
    interpolation_nodes: int = 3


ARC_OPTIONS = ArcOptions()


@record
class CurvePoint:
    """An equilibrium on a curve of equilibria, with the tangent of the curve there.

    scales: units of the motions of the ends and of the control (2n + 1,). tangent: unit vector
    (2n + 1,). curvature: coefficients of the square and the cube of the length in the
    deviation of the curve from the tangent (2, 2n + 1).
    """

    at: State
    scales: Array
    tangent: Array
    curvature: Array

    def ahead(self, length: float) -> Array:
        """Predicted changes of the 2n ends and the control (2n + 1,), at the arc length `length`.
        The changes are divided by `scales`, the units of ends and control.
        """
        deviation = length**2 * self.curvature[0] + length**3 * self.curvature[1]
        return np.asarray(
            length * self.tangent
            + (
                deviation
                if np.abs(deviation).max() <= ARC_OPTIONS.longest_step * abs(length)
                else 0.0
            )
        )

    @property
    def rises(self) -> float:
        """Derivative of the scaled control by the arc length; positive if the control rises."""
        return float(self.tangent[-1])

    def vanishes(self, curve: Curve) -> float:
        """Length along the tangent at which a zone of contact vanishes, see `Curve.vanishes`."""
        return curve.vanishes(self.at, self.tangent * self.scales)

    def moved(self, to: State) -> Array:
        """Changes of ends and control (2n + 1,) from this equilibrium to the state `to`.
        They are divided by `scales`, the units of ends and control.
        """
        return np.append(outward(self.at.table, to.table), to.value - self.at.value) / self.scales

    def length(self, to: State) -> float:
        """Distance of the equilibrium `to` from this curve point, along the tangent."""
        return float(self.tangent @ self.moved(to))


def begun(curve: Curve, here: State, sense: float) -> CurvePoint:
    """The equilibrium `here` with the curve's tangent; for sense 1 the control rises along it.

    The control falls for sense -1.
    """
    scales = np.append(here.widths, _unit(curve, here))
    tangent = tangent_at(here, scales)
    return CurvePoint(
        here,
        scales,
        tangent if tangent[-1] * sense >= 0.0 else -tangent,
        np.zeros((2, len(tangent))),
    )


def onward(curve: Curve, before: CurvePoint, ahead: State) -> CurvePoint:
    """The equilibrium `ahead` with the curve's tangent, which leads away from `before`."""
    # Near a turning point, a small change of the control moves the ends far, so that `_unit`, the
    # unit of the control, tends to 0. From one point of the curve to the next, this unit falls at
    # most by the factor `MOVES.least_part`. Otherwise the tangent would turn too sharply.
    scales = np.append(ahead.widths, max(_unit(curve, ahead), MOVES.least_part * before.scales[-1]))
    tangent, carried = tangent_at(ahead, scales), scales / before.scales
    tangent = tangent if before.tangent @ (tangent * carried) >= 0.0 else -tangent
    here = CurvePoint(ahead, scales, tangent, np.zeros((2, len(tangent))))
    moved = here.moved(before.at)
    # `curvature` holds coefficients of the cubic through the points `here` and `before`, which has
    # the curve's tangents at both points.
    return (
        replace(here, curvature=leaving(tangent, moved, before.tangent / carried))
        if moved.any()
        else here
    )


def leaving(tangent: Array, moved: Array, there: Array) -> Array:
    """Coefficients (2, 2n + 1) of the square and the cube in a cubic for ends and control.
    The cubic is a function of the length along the tangent of the curve.

    The length is measured from the present point along the unit vector `tangent`. The cubic starts
    there with this tangent. It passes through a second point, displaced by `moved`, with the
    tangent `there`.
    """
    length = float(tangent @ moved)
    if abs(length) < ACCURACY.rough:
        return np.zeros((2, len(tangent)))
    deviation, turned = (
        (moved - length * tangent) / length**2,
        (there / float(tangent @ there) - tangent) / length,
    )
    return np.array((3 * deviation - turned, (turned - 2 * deviation) / length))


def alike(before: CurvePoint, ahead: CurvePoint) -> float:
    """Cosine of the angle between the tangents at two points of the curve."""
    carried = ahead.tangent * (ahead.scales / before.scales)
    return float(before.tangent @ carried) / float(np.linalg.norm(carried))


def _unit(curve: Curve, at: State) -> float:
    """Unit of the control: the change that moves the fastest end by the width of its zone.

    It is at least the change of the control that changes some residual by 1 (`Curve.unit`).
    """
    whole, least = at.whole, curve.unit(at)
    moves, _, rank, _ = np.linalg.lstsq(at.rates, at.by_value, rcond=None)
    if (
        rank < len(moves)
        and np.abs(at.rates @ moves - at.by_value).max() * least > ACCURACY.resting_step
    ):
        # At a turning point, the ends move while the control does not change. So the unit is set to
        # its lower bound `least`.
        return least
    # The unit of the control is chosen so that one unit changes the residual r of a pinned end by
    # at most max(1, |r|), unless `least` is larger than this unit.
    driven = np.where(
        whole.pinned,
        (whole.by_value - whole.rates @ moves) / np.maximum(1.0, np.abs(whole.residual)),
        0.0,
    )
    most = float(np.maximum(np.abs(moves / at.widths), np.abs(driven)).max())
    return max(least, 1.0 / most) if most > 0.0 else least


def tangent_at(at: State, scales: Array) -> Array:
    """Unit tangent (2n + 1,) of the curve of equilibria, with a component for each end.
    The last component belongs to the control. All components are in units of `scales`.
    """
    return np.asarray(np.linalg.svd(np.column_stack((at.rates, at.by_value)) * scales)[2][-1])
