"""Where a strip stays: its centre is the middle of the outermost ends of its zones, on grids.

Its balance, what the gap beside its left border is more than that beside its right one, changes its
sign there. Under a light load the middle of the zones falls behind a centre that is moved; near
full contact the zone that the border is moved towards comes on faster than the border. So places on
either side of the first one are looked at, those nearest to it first, until a bracket holds a
change of sign. Two things keep a strip from a rest in it, and the bracket shows either: a zone
reaches a border there, or the balance jumps over zero, where a zone beside a border comes or goes
as the strip is moved.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from itertools import pairwise
from typing import Protocol, TypeVar

# Miss over the room beside the borders, and over a cell, that does not matter; cells that a bracket
# without a rest is narrowed to.
_CENTRED = 3e-3
_CELL = 0.1
_NARROW = 0.25
# The same beside a jump that may be one of the grid alone, and where its sign is the same all the
# way.
_NEARLY = 0.03
_ALMOST = 0.1
# Looks at the most; how much farther than a secant, and than the last step, one goes; and cells of
# a step at the least.
_LOOKS = 24
_BEYOND = 1.25
_LONGER = 4.0
_SHORTEST = 0.1


class Unrest(Enum):
    """Why no centre stays."""

    BORDER = "a contact zone reaches the border of the strip, which is cut at the widest gap of the period"
    JUMP = "no strip is centred on its zones, since one beside its border comes or goes as it is moved there"
    ASIDE = "no strip that is cut about the widest gap of the period is centred on its zones"
    LOST = (
        "no strip is centred on its zones where grids have one, since zones come and go beside it"
    )


class Strip(Protocol):
    """A strip about a centre. balance: see above; miss: the middle of its outermost ends less the
    centre; room: from these to the borders, together; cell: of its grid, all in one unit.
    """

    @property
    def centre(self) -> float: ...
    @property
    def balance(self) -> float: ...
    @property
    def miss(self) -> float: ...
    @property
    def room(self) -> float: ...
    @property
    def cell(self) -> float: ...
    @property
    def touches(self) -> bool: ...


Kind = TypeVar("Kind", bound=Strip)


def settled(
    look: Callable[[float, Kind], Kind], here: Kind, reach: float
) -> tuple[Kind, Unrest | None]:
    """(the strip where its centre stays, from one near by, None); where there is none no farther
    than a reach, the last one looked at, and why. look: at a centre, from another strip.
    """
    passed, first = [here], here.centre
    for looks in range(_LOOKS):
        if rests(here):
            return here, Unrest.BORDER if here.touches else None
        jumps = [pair for pair in pairwise(passed) if pair[0].balance * pair[1].balance <= 0.0]
        held = [
            (left, right)
            for left, right in jumps
            if right.centre - left.centre > _NARROW * here.cell
        ]
        # What jumps on a grid need not jump: that a strip beside it is nearly at rest the gaps may
        # put right.
        nearly = [
            strip
            for pair in jumps
            if pair not in held
            for strip in pair
            if _nearly(strip) and not strip.touches
        ]
        if nearly:
            return nearly[0], None
        if held:
            left, right = held[0]
            share = (
                0.5
                if looks % 2
                else min(max(left.balance / (left.balance - right.balance), 0.1), 0.9)
            )
            centre, near = (
                left.centre + share * (right.centre - left.centre),
                left if share < 0.5 else right,
            )
        else:
            centre, near = min(_outward(passed, first), key=lambda there: abs(there[0] - first))
            if abs(centre - first) > reach:
                break
        here = look(centre, near)
        passed = sorted([*passed, here], key=lambda strip: strip.centre)
    if all(strip.touches for strip in passed):
        return here, Unrest.BORDER
    if any(left.balance * right.balance <= 0.0 for left, right in pairwise(passed)):
        return here, Unrest.JUMP
    nearest = min(
        (strip for strip in passed if not strip.touches),
        key=lambda strip: abs(strip.miss) / strip.room,
    )
    return (nearest, None) if _balanced(nearest, _ALMOST) else (here, Unrest.ASIDE)


def rests(here: Strip) -> bool:
    """Whether a strip is centred, as far as its grid tells."""
    return _balanced(here, _CENTRED, _CELL * here.cell)


def _nearly(here: Strip) -> bool:
    """Whether a strip beside a jump may be at rest: ends are known to parts of a cell."""
    return _balanced(here, _NEARLY) and abs(here.miss) <= here.cell


def _balanced(here: Strip, part: float, least: float = 0.0) -> bool:
    return abs(here.miss) <= max(part * here.room, least)


def _outward(passed: list[Kind], first: float) -> list[tuple[float, Kind]]:
    """The next centres on the left and on the right, and from which strips."""
    out = []
    for sign, (last, before) in (
        (-1.0, (passed[0], passed[min(1, len(passed) - 1)])),
        (1.0, (passed[-1], passed[max(-2, -len(passed))])),
    ):
        if last is before:
            # Under light loads zones stay where they are.
            way = abs(last.miss) * (1.0 if sign * last.miss > 0.0 else 2.0) * _BEYOND
        else:
            done = abs(last.centre - before.centre)
            falls = (abs(before.balance) - abs(last.balance)) / done
            longest = _LONGER * max(done, abs(last.centre - first))
            way = min(_BEYOND * abs(last.balance) / falls, longest) if falls > 0.0 else longest
        out.append((last.centre + sign * max(way, _SHORTEST * last.cell), last))
    return out
