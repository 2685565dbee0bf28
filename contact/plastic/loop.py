"""Search loop: Newton's method for ends, check of signs, correction of contacts and plateaus.

The contact minimizes a strictly convex energy. So only one set of contacts and plateaus has the
right state (gap, elastic or plateau) everywhere.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import sie
from contact.errors import ContactError, SceneError
from contact.formulation import tables
from contact.formulation.controls import Control, Load
from contact.formulation.problem import Problem
from contact.model.profiles.noise import EPS
from contact.plastic.check import Checked, checked
from contact.plastic.fields import PlasticFields
from contact.plastic.spots import Spots, changed, joined, tidied
from contact.search.options import LEAST, SEARCH
from contact.search.topology.failure import Failure, same
from contact.search.topology.intervals import NEW_ZONE
from contact.verify.error import SolvedZones
from sie import Array, nearest_image, record


@dataclass(frozen=True)
class LoopOptions:
    """Options of `PlasticLoop`."""

    # Largest number of rounds of Newton's method, check and correction. Newton's method stops as
    # soon as a zone vanishes, so that a round may remove one zone only.
    max_rounds: int = 40
    # Width of a new plateau, divided by that of the interval in which the pressure is too high. A
    # plateau that is too narrow grows faster than one that is too wide shrinks.
    new_plateau: float = 0.7


OPTIONS = LoopOptions()

AT_BORDER = "a contact zone reaches the border of the part of the profile that is known"
# The width of the elastic rim between a plateau and the end of the contact is proportional to
# exp(-pi E* s/(2 H)). Here s is the profile's slope at this end, and H is the hardness.
NARROW_RIM = (
    "between a plateau and a gap, the distance over which the pressure falls from its limit to "
    "zero is below the rounding of numbers: the profile is too steep there for this hardness, or a "
    "contact nearby is about to open or to merge with another one; use a larger hardness or "
    "another load"
)


@record
class PlasticLoop:
    """Search for the contact of a scaled problem whose pressure is at most `limit`."""

    problem: Problem
    control: Control
    limit: float
    tolerance: float

    @property
    def decay(self) -> float:
        """Tolerance at which the series of the pressure on an elastic zone is truncated.
        It is relative to the largest coefficient of the series.

        Beside narrow plateaus and gaps the error of the truncation is magnified. The error of an
        iterative solution is magnified as well, so such a solution has the same tolerance.
        """
        return max(SEARCH.tight_factor**2 * self.tolerance, LEAST)

    def solved(self, spots: Spots) -> SolvedZones | Failure:
        """The contact found from a first guess `spots` of contacts and plateaus, or a Failure."""
        free: sie.Free | None = None
        tried: list[tuple[Array, Array]] = []
        start = sie.WarmStart()
        for number in range(1, OPTIONS.max_rounds + 1):
            if len(spots.contacts) == 0:
                return Failure("all zones vanished", free)
            if spots.full and len(spots.plateaus) == 0:
                return Failure("full contact without plateaus", free)
            try:
                free = self.moved(spots.zones(self.problem, self.limit), start)
            except sie.SingularSystem as failure:
                return Failure(f"the equation has no solution on these zones ({failure})", free)
            spots = Spots.of(free.density.zones, free.density.plateaus, self.problem.period)
            start = sie.WarmStart(modes_like=free.state.sizes if free.state.iterated else None)
            if len(free.lost) or len(free.met):
                left = self._without_lost(free, spots)
                if isinstance(left, Failure):
                    return left
                spots = left
                continue
            if not free.converged:
                return Failure(f"the zone ends did not settle: {free.reason}", free)
            lo, hi = self.problem.borders
            if spots.contacts[0, 0] <= lo or spots.contacts[-1, 1] >= hi:
                return Failure(AT_BORDER, free, at_border=True)
            fields, found = self._checked(free)
            if found.certificate.holds:
                return self._result(free, fields, found, number)
            table = spots.contacts, spots.plateaus
            if any(all(map(same, table, before)) for before in tried):
                return Failure(
                    found.certificate.note or "the contacts and plateaus did not settle", free
                )
            tried.append(table)
            following = self._corrected(spots, found)
            if following is None:
                return Failure(
                    found.certificate.note
                    or "the load or moment is not balanced, or the sign of a pressure is unclear",
                    free,
                )
            spots = following
        return Failure("the number of zones and plateaus did not settle", free)

    def tightened(self, found: SolvedZones) -> SolvedZones | Failure:
        """The contact `found`, solved from its own zones to the tolerance of this loop."""
        state = found.free.state
        start = sie.WarmStart(
            initial_error=found.error, modes_like=state.sizes if state.iterated else state
        )
        try:
            free = self.moved(found.free.density.zones, start)
        except sie.SingularSystem as failure:
            return Failure(f"the equation has no solution on these zones ({failure})", found.free)
        if not free.converged:
            return Failure(f"the zone ends did not settle: {free.reason}", free)
        fields, check = self._checked(free)
        if not check.certificate.holds:
            return Failure(
                check.certificate.note or "the contacts and plateaus did not settle", free
            )
        return self._result(free, fields, check, found.rounds)

    def _checked(self, free: sie.Free) -> tuple[PlasticFields, Checked]:
        state = free.state
        if self.control.load is None:
            # The stiffness and the rates of the ends are responses to a change of the load. So the
            # equation is solved again, under the load that was found.
            equation = self.problem.equation(Load(free.density.total))
            zones = free.density.zones
            state = sie.solve_zones(equation, zones, self.decay, state.sizes).with_bounded_ends()
        fields = PlasticFields(self.problem, state, limit=self.limit)
        return fields, checked(fields, self.control.load)

    def _result(
        self, free: sie.Free, fields: PlasticFields, found: Checked, rounds: int
    ) -> SolvedZones:
        return SolvedZones(free, fields, found.certificate, rounds, self.control, self.tolerance)

    def moved(self, zones: sie.Zones, start: sie.WarmStart) -> sie.Free:
        """The elastic zones with ends found by Newton's method; signs are not checked."""
        problem = self.problem
        try:
            options = sie.NewtonOptions(
                limits=problem.corners,
                released_end=problem.end,
                decay=self.decay,
                forcing=SEARCH.tight_factor**2,
            )
            return sie.find_ends(
                problem.equation(self.control), zones, self.tolerance, options, start
            )
        except ValueError as fault:
            if isinstance(fault, ContactError):
                raise
            raise SceneError(
                f"the equation cannot be solved with the values from the scene: {fault}"
            ) from fault

    def _without_lost(self, free: sie.Free, spots: Spots) -> Spots | Failure:
        """The contacts and plateaus (`spots`) without the intervals that have vanished.

        The two contacts beside a closed gap become one, and so do two plateaus.
        """
        zones, problem = free.density.zones, self.problem
        table, values = zones.table, zones.values
        contacts, plateaus = spots.contacts, spots.plateaus
        for i in np.asarray(free.met).tolist():
            if values[1, i] == 0.0:  # a gap has closed
                if i + 1 < len(table):
                    bridge = [[table[i, 0], table[i + 1, 1]]]
                    contacts = tables.united(np.concatenate((contacts, bridge)))
                else:
                    contacts = _joined_across(contacts, problem.repeat_length)
            else:  # a plateau has vanished
                lag = nearest_image(plateaus[:, 0] - table[i, 1], 0.0, problem.period)
                plateaus = plateaus[np.abs(lag) > 8 * EPS * max(1.0, abs(table[i, 1]))]
        for i in np.asarray(free.lost).tolist():
            if (values[:, i] == 0.0).all():
                contacts = contacts[contacts[:, 0] != table[i, 0]]
            elif (values[:, i] != 0.0).all():
                around = problem.period if spots.full else None
                plateaus = joined(plateaus, table[[i]], around)
            else:
                return Failure(NARROW_RIM, free)
        period = problem.period
        closed = period is not None and bool(np.diff(contacts, axis=1).max(initial=0.0) >= period)
        full = spots.full or closed
        return tidied(Spots(contacts, plateaus, full), problem, rims=False)

    def _corrected(self, spots: Spots, found: Checked) -> Spots | None:
        """Contacts and plateaus after corrections of all wrong signs; None if no sign is wrong."""
        certificate = found.certificate
        parts = certificate.negative, found.above, found.opened, certificate.overlaps
        if not any(len(part) for part in parts):
            return None
        negative, above, opened, overlaps = parts
        return changed(
            spots,
            self.problem,
            negative,
            _shrunk(above, OPTIONS.new_plateau, spots.contacts, self.problem.corners),
            opened,
            _shrunk(overlaps, NEW_ZONE, np.zeros((0, 2)), self.problem.corners),
        )


def _joined_across(contacts: Array, period: float) -> Array:
    """The contacts, with the last one joined to the first one of the next period."""
    across = [[contacts[-1, 0], contacts[0, 1] + period]]
    return np.concatenate((contacts[1:-1], across))


def _shrunk(table: Array, part: float, contacts: Array, corners: tuple[float, float]) -> Array:
    """The intervals of `table`, shrunk about their middles by the factor `part`.
    Ends at sharp corners are not moved.
    """
    if len(table) == 0:
        return table
    middle, half = table.mean(axis=1), 0.5 * part * np.diff(table, axis=1)[:, 0]
    out = np.column_stack((middle - half, middle + half))
    return np.where(np.isin(table, corners), table, out)
