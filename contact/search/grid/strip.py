r"""The contact of one strip on grids, a half-plane's as that of an even profile of a period.

With x = c - h cos(theta) on the strip |x - c| < h and P(theta) = p(x) h sin(theta), of ln|cos theta
- cos phi| = -ln 2
- sum_n (2/n) cos(n theta) cos(n phi) what is called up by the pressure of the strip alone,

    u = -(2/pi E) int p(xi) ln|x - xi| dxi = sum_n (2 P_n / E n) cos(n theta) + const,     P = P_0 + sum_n P_n cos(n theta),

is what a half-plane of period 2 pi in theta does under P, and the load of a turn is twice that of
the strip. So the grids of a period serve: of the same number of points they tell gaps beside the
border by the square of a cell, full contact is closed there, and a few iterations are enough where
it is nearly full. Where p is singular at the border, P is not: a strip that reaches its border is
in contact at theta = 0 or pi.

On other substrates, whose kernel has more than the logarithm, and of profiles with corners, the
grid is even in x.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from contact.search.grid.conjugate_gradient import GridState, Response
from contact.search.grid.nested_grids import propose
from sie import Array, record


@record
class StripContact:
    """Zones (n, 2) [m] of a strip about a middle [m]; points: of its grid; cell: the width of one
    in the middle [m]; state: on the grid; reaches: whether zones reach its left and its right
    border; beside: what room is left there [m], negative where a zone reaches a border: about as
    much as a pressure lower by that at the border would leave.
    """

    middle: float
    zones: Array
    points: int
    cell: float
    state: GridState = field(repr=False)
    reaches: tuple[bool, bool]
    beside: tuple[float, float]

    @property
    def width(self) -> float:
        """Total, of all zones [m]."""
        return float((self.zones[:, 1] - self.zones[:, 0]).sum())

    @property
    def touches_border(self) -> bool:
        return any(self.reaches)


@dataclass(frozen=True)
class StripGrid:
    """Strips of a length [m] on a body whose response is that of one alone. turns: whether grids
    are even in the angle.
    """

    response: Response
    length: float
    resolution: float | None
    turns: bool

    def contact(
        self,
        height: Callable[[Array], Array],
        middle: float,
        load: float,
        points: int,
        tol: float,
        near: StripContact | None,
    ) -> StripContact:
        """Of a shape [m] about a middle [m] under a load [N/m]; near: another strip to begin with."""
        half, state = 0.5 * self.length, None if near is None else self._moved(near, middle)
        if not self.turns:
            cell = (middle - half, middle + half)
            found = propose(
                height,
                cell,
                self.response,
                resolution=self.resolution,
                points=points,
                load=load,
                tol=tol,
                start=state,
            )
            pressures, h = found.state.pressure[[0, -1]], self.length / points
            reaches = bool(pressures[0] > 0), bool(pressures[1] > 0)
            room = (
                (float(found.zones[0, 0]) - cell[0], cell[1] - float(found.zones[-1, 1]))
                if len(found.zones)
                else (0.0, 0.0)
            )
            excess = h * self.length * pressures / load
            left, right = np.where(reaches, -excess, room)
            return StripContact(
                middle, found.zones, points, h, found.state, reaches, (float(left), float(right))
            )

        def turned(theta: Array) -> Array:
            there = np.asarray(height(_placed(theta[: len(theta) // 2], middle, half)))
            return np.concatenate((there, there[::-1]))

        whole = Response(self.response.E, mirrored=True)
        found = propose(
            turned, (0.0, 2 * np.pi), whole, points=2 * points, load=2 * load, tol=tol, start=state
        )
        inside = found.state.contact
        reaches = bool(inside[0]), bool(inside[points - 1])
        zones = found.zones if len(found.zones) else np.array([[0.0, np.pi]])
        # Each of half a turn; the other half is its mirror image.
        crossing = (
            np.array([[0.0, float(zones[-1, 1]) - 2 * np.pi]])
            if reaches[0] and len(found.zones)
            else np.zeros((0, 2))
        )
        zones = zones[zones[:, 0] < np.pi]
        zones = np.concatenate(
            (crossing, np.column_stack((zones[:, 0], np.minimum(zones[:, 1], np.pi))))
        )
        # Of a gap about the border, above which the relief falls as |theta|, the angle goes
        # straight with the mean pressure.
        excess = -np.pi * found.state.pressure[[0, points - 1]] / load
        left, right = np.where(reaches, excess, (zones[0, 0], np.pi - zones[-1, 1]))
        beside = (
            float(np.copysign(half * (1 - np.cos(left)), left)),
            float(np.copysign(half * (1 - np.cos(right)), right)),
        )
        return StripContact(
            middle,
            _placed(zones, middle, half),
            points,
            half * np.pi / points,
            found.state,
            reaches,
            beside,
        )

    def _moved(self, near: StripContact, middle: float) -> GridState:
        """The state of another strip, its pressure taken along to the same places of one about a
        middle: zones stay where they are, so that a grid begun from it has few points to change.
        """
        if middle == near.middle:
            return near.state
        n, half = near.points, 0.5 * self.length
        if not self.turns:
            x = self.length * (np.arange(n) + 0.5) / n
            return replace(
                near.state,
                pressure=np.interp(
                    x + middle - near.middle, x, near.state.pressure, left=0.0, right=0.0
                ),
            )
        angle = np.pi * (np.arange(n) + 0.5) / n
        there = np.arccos(np.clip((near.middle - _placed(angle, middle, half)) / half, -1.0, 1.0))
        pressure = np.interp(there, angle, near.state.pressure[:n])
        return replace(near.state, pressure=np.concatenate((pressure, pressure[::-1])))


def _placed(theta: Array, middle: float, half: float) -> Array:
    """c - h cos(theta)."""
    return np.asarray(middle - half * np.cos(theta))
