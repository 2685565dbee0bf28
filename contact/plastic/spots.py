"""`Spots`: the contacts of a surface and the plateaus in them, as tables of intervals.

On a plateau the pressure is the limit H. The rest of a contact is elastic: these intervals are the
zones of the integral equation, with the value H at the ends beside plateaus.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import sie
from contact.formulation import tables
from contact.formulation.problem import Problem
from contact.model.profiles.noise import EPS
from contact.search.topology.intervals import without
from sie import Array, Index, record


@record
class Spots:
    """The contacts (k, 2) and the plateaus (m, 2) of a state, scaled and in ascending order.
    Plateaus (intervals at the limit of pressure) lie within contacts.

    full: whether all of the period is in contact; then `contacts` has one row of that width.
    """

    contacts: Array
    plateaus: Array
    full: bool = False

    @classmethod
    def of(cls, zones: sie.Zones, plateaus: Array, period: float | None) -> Spots:
        """Contacts and plateaus from elastic zones and plateaus.
        Zones and plateaus that touch or overlap form one contact.
        """
        every = np.concatenate((zones.table, plateaus))
        every = every[np.argsort(every[:, 0])]
        meets = every[1:, 0] <= every[:-1, 1]
        contacts = tables.joined_where(every, meets)
        if period is None or len(contacts) > 1 or contacts[0, 1] < contacts[0, 0] + period:
            return cls(contacts, plateaus)
        return _about_plateaus(plateaus, period) if len(plateaus) else cls(contacts, plateaus, True)

    def zones(self, problem: Problem, limit: float) -> sie.Zones:
        """The elastic parts of the contacts, as zones for the solver.
        At the ends next to plateaus the pressure of a part is `limit`, in scaled units.
        """
        lo, hi = problem.corners
        free, value = problem.end, sie.free_with_value(limit)
        rows: list[tuple[float, float]] = []
        left: list[sie.End] = []
        right: list[sie.End] = []
        for (a, b), inside in zip(self.contacts.tolist(), self._by_contact(), strict=True):
            begin, kind = a, sie.SINGULAR if a == lo else free
            for first, last in inside:
                if first > begin:
                    rows.append((begin, first))
                    left.append(kind)
                    right.append(value)
                begin = last
                kind = value if first > a else sie.free_with_value(limit, until=a)
            if begin < b:
                rows.append((begin, b))
                left.append(kind)
                right.append(sie.SINGULAR if b == hi else free)
            else:
                right[-1] = sie.free_with_value(limit, until=b)
        if self.full:
            rows, left, right = self._around(problem.repeat_length, rows, left, right)
        return sie.Zones.of(np.array(rows), left, right)

    def _by_contact(self) -> list[list[list[float]]]:
        """For each contact, the list of its plateaus (intervals at the limit of pressure)."""
        which = np.searchsorted(self.contacts[:, 0], self.plateaus[:, 0], side="right") - 1
        return [self.plateaus[which == k].tolist() for k in range(len(self.contacts))]

    @staticmethod
    def _around(
        period: float, rows: list[tuple[float, float]], left: list[sie.End], right: list[sie.End]
    ) -> tuple[list[tuple[float, float]], list[sie.End], list[sie.End]]:
        """Intervals and their end kinds, with the last and first interval joined into one.
        The two are parts of one interval across the border of the period.
        """
        (_, b), (a, _) = rows[0], rows[-1]
        return [*rows[1:-1], (a, b + period)], [*left[1:-1], left[-1]], [*right[1:-1], right[0]]


def _about_plateaus(plateaus: Array, period: float) -> Spots:
    """Full contact with these plateaus (intervals at the limit of pressure).
    The period begins in the widest elastic interval.
    """
    between = tables.gaps_between(plateaus, period)
    begin = float(between[np.argmax(np.diff(between, axis=1)[:, 0])].mean())
    table = tables.in_cell(plateaus, begin, period)
    return Spots(np.array([[begin, begin + period]]), table, True)


def changed(
    spots: Spots, problem: Problem, negative: Array, above: Array, opened: Array, overlaps: Array
) -> Spots:
    """The contacts and plateaus after four kinds of corrections.
    Each kind is a table of scaled intervals.

    negative: no contact there; above: new plateaus; opened: elastic instead of plateau; overlaps:
    new contacts.
    """
    period = problem.period
    contacts = spots.contacts
    if len(negative):
        contacts = _cut(contacts, negative, period, spots.full)
    if len(overlaps):
        contacts = tables.united(np.concatenate((contacts, overlaps)))
    plateaus = spots.plateaus
    if spots.full and period is not None:
        # In full contact the plateaus lie in the period that the row of `contacts` covers. The
        # intervals `opened` may lie in another period, so they are moved.
        opened = tables.in_cell(opened, contacts[0, 0], period)
    if len(opened):
        plateaus = without(plateaus, opened)
    if len(above):
        plateaus = joined(plateaus, above, period if spots.full else None)
    full = spots.full and not len(negative)
    return tidied(Spots(contacts, plateaus, full), problem)


def _cut(contacts: Array, negative: Array, period: float | None, full: bool) -> Array:
    if full and period is not None:
        # In full contact `contacts` has one row, as long as the period. An interval of `negative`
        # may extend beyond the end of this row. Its copy one period to the left then covers the
        # same part of the surface at the beginning of the row.
        negative = tables.in_cell(negative, contacts[0, 0], period)
        negative = tables.ascending(np.concatenate((negative - period, negative)))
    out = without(contacts, negative)
    if full and period is not None and len(out) > 1:
        (first, last), begin = out[[0, -1]], contacts[0, 0]
        if first[0] == begin and last[1] == begin + period:
            out = np.concatenate((out[1:-1], [[last[0], first[1] + period]]))
    return out


def tidied(spots: Spots, problem: Problem, rims: bool = True) -> Spots:
    """The contacts and plateaus, with plateaus clipped so that elastic rims next to gaps remain.

    rims: whether each rim becomes at least `RIM` times as wide as the plateau next to it.
    """
    period = problem.period
    if spots.full:
        return _about_plateaus(spots.plateaus, period) if period and len(spots.plateaus) else spots
    contacts, (lo, hi) = spots.contacts, problem.corners
    contacts = np.clip(contacts, lo, hi)
    contacts = contacts[contacts[:, 1] > contacts[:, 0]]
    plateaus = spots.plateaus
    if period is not None and len(contacts):
        contacts = _within_period(contacts, period)
        if contacts[0, 1] - contacts[0, 0] >= period:
            return tidied(Spots(contacts, plateaus, True), problem)
        contacts = tables.parted_at_wide(contacts, period)
        # The cell begins in the middle of a gap. So rounding does not move a plateau at the end of
        # a contact to the other side of the cell.
        gap = contacts[0, 0] + period - contacts[-1, 1]
        plateaus = tables.in_cell(plateaus, contacts[0, 0] - 0.5 * gap, period)
    out: list[tuple[float, float]] = []
    for a, b in contacts.tolist():
        inside = plateaus[(plateaus[:, 1] > a) & (plateaus[:, 0] < b)]
        rim = (RIM if rims else 0.0) * np.diff(np.clip(inside, a, b), axis=1)[:, 0]
        begin = np.full(len(inside), a) if a == lo else a + rim
        end = np.full(len(inside), b) if b == hi else b - rim
        part = np.clip(inside, begin[:, None], end[:, None])
        kept = part[part[:, 1] > part[:, 0]].tolist()
        out += [(p, q) for p, q in kept if not (p == a and q == b)]
    return replace(spots, contacts=contacts, plateaus=np.array(out).reshape(-1, 2))


def joined(plateaus: Array, more: Array, period: float | None) -> Array:
    """The union of two tables of plateaus; empty if the plateaus cover the period.
    period: None if plateaus do not meet across the border of the period.
    """
    # Plateaus whose ends differ by round-off only are joined.
    more = more + 8 * EPS * np.maximum(1.0, np.abs(more)) * [-1.0, 1.0]
    table = np.concatenate((plateaus, more))
    if period is None:
        return tables.united(table)
    table = tables.in_cell(table, float(table[0, 0]), period)
    united = tables.united(np.concatenate((table, table + period, table + 2 * period)))
    begin = united[0, 1]
    return np.asarray(united[(united[:, 0] >= begin) & (united[:, 0] < begin + period)])


def _within_period(contacts: Array, period: float) -> Array:
    """The contacts; those that overlap across the border of the period are joined."""
    while len(contacts) > 1 and contacts[-1, 1] >= contacts[0, 0] + period:
        begin, end = contacts[-1, 0] - period, max(contacts[0, 1], contacts[-1, 1] - period)
        contacts = tables.united(np.concatenate(([[begin, end]], contacts[1:-1])))
    return contacts


# Least width of the elastic rim between a plateau and a gap in a first guess, divided by the width
# of the plateau. Newton's method finds the true width, which may be far smaller.
RIM = 1e-4


def index_of(table: Array, x: Array) -> Index:
    """Index of the last interval in `table` that begins at or before each x; 0 if none does."""
    return np.maximum(np.searchsorted(table[:, 0], x, side="right") - 1, 0)
