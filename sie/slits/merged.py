"""Zones beside narrow gaps, seen as one wide zone with slits in it.

A density on one of two zones a gap g apart has a singularity of its own one g beyond its end, and
takes n ~ sqrt(width / g) modes. On the zone that spans both, g a *slit*, everything but the slit's
own share is as smooth as the right side.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from sie.basis.data import Array, Index, Kept, Mask, lost, record, wrapped
from sie.basis.zones import Zones
from sie.dense.modes import gaps
from sie.equation.conditions import BUILT_IN, Condition, ZoneTotals
from sie.equation.equation import Equation

# Gaps narrower than this part of the wider zone beside them may be slits.
NARROW = 0.02
# From one set of zones to the next a gap that was one stays one, and another one none, up to so
# many times that width or part of it.
_STAYS = 1.5
# Gaps with jumps of higher derivatives of the right side than the first in them, of which there may
# be hundreds, must be narrower than this part of both zones.
SMALL = 0.003


@record
class Merged(Kept):
    """pieces: the zones as given. wide: zones that span narrow gaps; slits: those gaps, slit_zone
    the wide zone of each. piece_zone: wide zone of each piece; shift: what to add to a piece to
    find it in its wide zone (periods); cut_off: what rounding has cut off the ends of the pieces
    there (2, n).
    """

    pieces: Zones
    wide: Zones
    slits: Zones
    slit_zone: Index
    piece_zone: Index
    shift: Array
    cut_off: Array

    @cached_property
    def start(self) -> Array:
        """Distance of each piece's left end from the left end of its wide zone."""
        return self.wide.beyond_a(self.pieces.a + self.shift, self.piece_zone) + self.cut_off[0]

    @cached_property
    def stop(self) -> Array:
        """Distance of each piece's right end from the left end of its wide zone."""
        return self.wide.beyond_a(self.pieces.b + self.shift, self.piece_zone) + self.cut_off[1]

    @cached_property
    def rest(self) -> Array:
        """Distance of each piece's right end from the right end of its wide zone."""
        return self.wide.before_b(self.pieces.b + self.shift, self.piece_zone) - self.cut_off[1]

    @cached_property
    def slit_before(self) -> Index:
        """The slit that ends where a piece begins, -1 without."""
        return self._beside(self.slits.b, self.pieces.a + self.shift)

    @cached_property
    def slit_after(self) -> Index:
        """The slit that begins where a piece ends, -1 without."""
        return self._beside(self.slits.a, self.pieces.b + self.shift)

    @cached_property
    def beside_slits(self) -> Mask:
        """Which pieces have slits beside them."""
        return (self.slit_before >= 0) | (self.slit_after >= 0)

    def _beside(self, ends: Array, at: Array) -> Index:
        place = np.minimum(np.searchsorted(ends, at), len(ends) - 1)
        return np.where(ends[place] == at, place, -1)


def merge(equation: Equation, pieces: Zones, before: Mask | None = None) -> Merged | None:
    """The zones with their narrow gaps as slits, None if there are none or the equation does not
    allow it. before: after which pieces there were slits on about the same zones; it stays so as
    long as gaps are about as narrow.
    """
    kernel = equation.kernel
    # A column that may be singular between zones is none of a wide one.
    general = len(equation.forcing.jumps.singular_at) > 0 or any(
        column.resolution.modes is None and not column.resolution.smooth_between
        for column in equation.columns
    )
    if len(pieces) < 2 or general or not _one_level(equation.conditions) or not _plain(pieces):
        return None
    after = gaps(pieces, kernel)[1]
    width = pieces.b - pieces.a
    following = np.roll(width, -1)
    # A slit has its neighbours' far ends as its singularities, as these have the slit's: whichever
    # asks for less.
    most = NARROW * (
        1.0
        if before is None or len(before) != len(pieces)
        else np.where(before, _STAYS, 1 / _STAYS)
    )
    narrow = (after < most * np.maximum(width, following)) & (after**2 < width * following)
    narrow &= pieces.moves[1] & np.roll(pieces.moves[0], -1)
    if kernel.period is None or pieces.symmetric:
        narrow[-1] = False
    narrow &= ~_bent(equation, pieces, after) | (after < SMALL * np.minimum(width, following))
    if not narrow.any():
        return None
    count = len(pieces)
    first = 0
    if narrow[-1]:
        # The border of the period lies in the widest gap.
        first = (int(np.argmax(np.where(narrow, -np.inf, after))) + 1) % count
        if narrow.all():
            narrow[first - 1] = False
    order = (first + np.arange(count)) % count
    shift = np.where(np.arange(count) < first, kernel.period or 0.0, 0.0)
    a, b, joined = (pieces.a + shift)[order], (pieces.b + shift)[order], narrow[order[:-1]]
    starts = np.concatenate(([0], np.flatnonzero(~joined) + 1))
    stops = np.concatenate((starts[1:], [count])) - 1
    zone = np.empty(count, dtype=np.intp)
    zone[order] = np.repeat(np.arange(len(starts)), stops - starts + 1)
    left = [pieces.left[order[s]] for s in starts]
    right = [pieces.right[order[s]] for s in stops]
    cut_off = pieces.rest + np.array([lost(ends, shift) for ends in (pieces.a, pieces.b)])
    rest = np.array([cut_off[0][order[starts]], cut_off[1][order[stops]]])
    wide = Zones(a[starts], b[stops], left, right, pieces.symmetric, rest)
    at = np.flatnonzero(joined)
    slits = replace(
        Zones.of(np.column_stack((b[at], a[at + 1]))),
        rest=np.array([cut_off[1][order[at]], cut_off[0][order[at + 1]]]),
    )
    return Merged(pieces, wide, slits, zone[order[at]], zone, shift, cut_off)


def _one_level(conditions: Sequence[Condition]) -> bool:
    """Whether all zones are held at one level, so that the gap between neighbours integrates to
    zero, and no condition speaks of zones one by one, which become fewer: those of a user's own
    may.
    """
    rows = [type(condition).rows for condition in conditions]
    one_by_one = ZoneTotals.rows in rows or any(one not in BUILT_IN for one in rows)
    return not one_by_one and any(condition.levels for condition in conditions)


def _plain(pieces: Zones) -> bool:
    """Whether no intensity is prescribed but zero at ends that move."""
    return all(
        end.intensity is None or (end.moves and end.intensity == 0.0)
        for end in (*pieces.left, *pieces.right)
    )


def _bent(equation: Equation, pieces: Zones, after: Array) -> Mask:
    """Gaps with a jump of a higher derivative of the right side in them than the first, or with an
    algebraic point.
    """
    jumps = equation.forcing.jumps
    at = jumps.at[np.asarray(jumps.orders) > 1] if not jumps.of_density else np.zeros(0)
    if jumps.algebraic is not None:
        at = np.concatenate((at, np.asarray(jumps.algebraic.at)))
    at = wrapped(at, pieces.a[0], equation.kernel.period)
    i = np.searchsorted(pieces.a, at, side="right") - 1
    within = (i >= 0) & (at >= pieces.b[i]) & (at <= pieces.b[i] + after[i])
    found = np.zeros(len(pieces), dtype=bool)
    found[i[within]] = True
    return found
