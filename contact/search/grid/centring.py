"""Where a strip stays: its centre follows the middle of the outermost ends of its zones, on grids.

The miss, that middle less the centre, tells which way: the centre goes there until the miss changes its sign, and a bracket holds the place
between. Two things keep it from coming to rest, and the bracket shows either: a zone reaches the border of the strip on the way, or the
miss jumps over zero, where a zone beside the border comes or goes as the strip is moved.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from enum import Enum

from contact.search.grid.strip import StripContact
from sie import record

# Miss over the room beside the border, and over a cell, that does not matter; cells that a bracket without a rest is narrowed to.
_CENTRED, _CELL, _NARROW = 0.02, 0.25, 0.5
# Looks at the most, those that may clear the border, how much longer than the miss a step may be, and the flattest fall of the miss.
_LOOKS, _CLEARED, _LONGER, _FLATTEST = 40, 4, 8.0, -0.1


class Unrest(Enum):
    """Why no centre stays."""

    BORDER = "a contact zone reaches the border of the strip, which is cut at the widest gap of the period"
    JUMP = "no strip is centred on its zones, since one beside its border comes or goes as it is moved there"


@record
class Strip:
    """The contact of a strip about a centre. middle: of its outermost ends; room: from these to the borders, together; cell: of its grid,
    all in one unit; unrest: why the centre does not stay, None where it does, or where that was not asked."""

    centre: float
    contact: StripContact
    middle: float
    room: float
    cell: float
    unrest: Unrest | None = None

    @property
    def miss(self) -> float:
        return self.middle - self.centre

    @property
    def touches(self) -> bool:
        return self.contact.touches_border

    @property
    def side(self) -> float:
        """Negative where a zone reaches the left border alone, positive where one reaches the right one."""
        left, right = self.contact.reaches
        return float(right) - float(left)

    @property
    def rests(self) -> bool:
        return not self.touches and abs(self.miss) <= max(_CENTRED * self.room, _CELL * self.cell)


def settled(look: Callable[[float, Strip], Strip], here: Strip) -> Strip:
    """The strip where its centre stays, from one near by; where there is no such place, the last one on the way there, with its unrest."""
    for _ in range(_CLEARED):
        if here.touches:
            here = look(here.middle, here)
    if here.touches:
        return replace(here, unrest=Unrest.BORDER)
    behind: Strip | None = None
    ahead: Strip | None = None
    for looks in range(_LOOKS):
        if here.rests:
            return here
        if ahead is not None and abs(ahead.centre - here.centre) < _NARROW * here.cell:
            break
        there = look(_towards(here, behind, ahead, halved=looks % 2 == 1), here)
        if there.rests:
            return there
        if there.touches or there.miss * here.miss < 0.0:
            ahead = there
        else:
            behind, here = here, there
    return replace(here, unrest=Unrest.BORDER if ahead is not None and ahead.touches else Unrest.JUMP)


def _towards(here: Strip, behind: Strip | None, ahead: Strip | None, halved: bool) -> float:
    """The next centre: by a secant, within the bracket, or in its middle."""
    if ahead is not None and halved:
        return 0.5 * (here.centre + ahead.centre)
    if ahead is not None and not ahead.touches:
        return here.centre + (ahead.centre - here.centre) * here.miss / (here.miss - ahead.miss)
    rate = -1.0
    if behind is not None:
        rate = min((here.miss - behind.miss) / (here.centre - behind.centre), _FLATTEST)
    longest = _LONGER * abs(here.miss) if ahead is None else 0.5 * abs(ahead.centre - here.centre)
    return here.centre + math.copysign(min(-abs(here.miss) / rate, longest), here.miss)
