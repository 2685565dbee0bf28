"""Events of a load path under a limit of the pressure, in addition to those of elastic contact.

Where the pressure reaches the limit, there are plateaus. Contacts, plateaus and the pressure at
every place grow with the load. So the contact under a load does not depend on earlier loads. Each
kind of event is located by a condition. The condition is computed with fixed numbers of contacts
and plateaus, and signs of pressure and gap are not checked:

    birth   the least gap at the place of the new contact is zero, without that contact,
    merge   the least pressure between two contacts is zero, computed as if they were one,
    full    the same for the last gap of the period,
    onset   the largest pressure at the place of the new plateau is the limit, without that plateau,
    join    the least overlap between two plateaus is zero, computed as if they were one.

A contact that begins at a convex kink has a plateau from the beginning: two events at one load.
"""

from __future__ import annotations

import numpy as np

import sie
from contact.errors import ContactError, NotConverged
from contact.formulation.controls import Load
from contact.formulation.roots import maximum, smooth_root
from contact.formulation.tables import centred_on, gaps_between
from contact.formulation.tolerances import TOLERANCES
from contact.model.laws.plastic import bearing_width
from contact.model.scene import Scene
from contact.plastic.fields import PlasticFields
from contact.plastic.loop import PlasticLoop
from contact.plastic.search import spots_of
from contact.plastic.spots import Spots
from contact.search.options import SEARCH
from contact.search.topology.changes import MARGIN, changes
from contact.search.topology.failure import WrongTopology
from contact.solution.solution import Solution
from contact.sweeps.hidden_events import Ends, may_hide, unexplained
from contact.sweeps.path_table import Event
from contact.sweeps.paths import OPTIONS, PathSearch
from sie import Array, nearest_image, record


@record
class Change:
    """A change of the number of contacts or plateaus between two loads.

    where: the new interval, or the interval between two that join [m]. of_contacts: true if the
    contacts change, false if the plateaus do. begins: true if an interval begins, false if two
    intervals join.
    """

    kind: str
    where: tuple[float, float]
    of_contacts: bool
    begins: bool


class PlasticPath(PathSearch):
    """The search for events along one path under a limit of the pressure."""

    def _events(self, low: Solution, high: Solution) -> list[Event]:
        if not len(high.plateaus):
            return super()._events(low, high)
        found = _changes(low, high)
        step = (high.load - low.load) / high.load
        # Close to the largest load (`bearing`), plateaus depend on the distance from this load.
        left, last = (bearing(low.scene) - one.load for one in (low, high))
        far = max(high.load / low.load, left / last if np.isfinite(left) else 1.0)
        hides = far > OPTIONS.max_load_ratio or (step > OPTIONS.negligible and _may_hide(low, high))
        if step <= 0.0 or not found and not hides:
            return []
        if hides:
            if high.load / low.load >= far:
                return self._divided(low, high, (low.load, high.load))
            load = bearing(low.scene) - float(np.sqrt(left * last))
            return self._divided(low, high, (load, load))
        found, at_tips = _without_tips(found, low)
        events = [_located(change, low, high) for change in found]
        known = [event for event in events if event is not None]
        loads = sorted(event.load for event in known)
        if len(known) == len(found):
            rest = np.diff(np.log(loads))
            if len(loads) <= 1 or rest.max() <= OPTIONS.same:
                self._counted(len(known))
                return [*known, *_at_births(at_tips, known, low, high)]
            k = int(rest.argmax())
            return self._divided(low, high, (loads[k], loads[k + 1]))
        if step <= OPTIONS.same:
            kinds = ", ".join(change.kind for change in found)
            raise NotConverged(
                f"events between the loads {low.load:.17g} and {high.load:.17g} N/m were not "
                f"located: {kinds}"
            )
        return self._divided(low, high, (low.load, high.load))

    def _divided(self, low: Solution, high: Solution, between: tuple[float, float]) -> list[Event]:
        """The events between two solutions, found by means of one more solution at a load between.

        Close to an event a solution may not converge. Then another load is tried.
        """
        first, last = (min(max(load, low.load), high.load) for load in between)
        failure: NotConverged | None = None
        for part in (0.5, 0.3, 0.7, 0.1, 0.9):
            load = float(first ** (1 - part) * last**part)
            try:
                middle = self.intermediate(load, low)
            except NotConverged as error:
                failure = error
                continue
            return self._events(low, middle) + self._events(middle, high)
        if first == last:
            return self._divided(low, high, (low.load, high.load))
        assert failure is not None
        raise failure

    def _counted(self, number: int) -> None:
        self.events_found += number
        if self.progress is not None:
            self.progress("events", self.events_found, None)


def bearing(scene: Scene) -> float:
    """The load [N/m] at which all of the surface is one plateau; inf for an endless surface."""
    return scene.law.pressure_range.highest * bearing_width(scene)


def _changes(low: Solution, high: Solution) -> list[Change]:
    """All changes of contacts and plateaus from a load to a higher one."""
    period, found = low.scene.period, []
    if len(low.zones) and not len(high.zones):
        gaps = gaps_between(low.zones, period).tolist()
        found += [Change("merge", (a, b), True, False) for a, b in gaps[:-1]]
        found.append(Change("full", (gaps[-1][0], gaps[-1][1]), True, False))
    for of_contacts, before, after in (
        (True, low.zones, high.zones),
        (False, low.plateaus, high.plateaus),
    ):
        names = ("birth", "merge") if of_contacts else ("onset", "join")
        for one in changes(before, after, period, True, OPTIONS.negligible):
            # If two intervals join, `changes` widens the interval between them by a margin, which
            # is removed here.
            (a, b), wide = one.where, 0.0 if one.of_gap else MARGIN / (1 + 2 * MARGIN)
            where = a + wide * (b - a), b - wide * (b - a)
            name = names[0] if one.of_gap else names[1]
            found.append(Change(name, where, of_contacts, one.of_gap))
    return found


def _may_hide(low: Solution, high: Solution) -> bool:
    """Whether an end of a contact or plateau moved in another way than its rates predict.
    A rate is a derivative by ln(load).
    """
    if len(low.zones) and len(high.zones) and may_hide(low, high):
        return True
    before, after = low.fields, high.fields
    if not isinstance(before, PlasticFields) or not isinstance(after, PlasticFields):
        return False
    first, last = (
        Ends(fields.plateaus, fields.plateau_spreading, solution.error)
        for fields, solution in ((before, low), (after, high))
    )
    return unexplained(first, last, float(np.log(high.load / low.load)), low.scene.period)


def _without_tips(found: list[Change], low: Solution) -> tuple[list[Change], list[Change]]:
    """Split `found` into (all other changes, onsets of plateaus at tips).
    A tip is a convex kink at which a contact begins; it has a plateau from the beginning.
    """
    kinks = low.scene.profile.kinks
    tips, period = kinks[kinks[:, 1] > 0, 0], low.scene.period
    born = [change for change in found if change.kind == "birth"]

    def at_tip(change: Change) -> bool:
        if change.kind != "onset":
            return False
        middle = 0.5 * sum(change.where)
        inside = any(_within(middle, birth.where, period) for birth in born)
        return inside and any(_within(float(tip), change.where, period) for tip in tips)

    at_tips = [change for change in found if at_tip(change)]
    return [change for change in found if change not in at_tips], at_tips


def _within(x: float, where: tuple[float, float], period: float | None) -> bool:
    middle, half = 0.5 * (where[0] + where[1]), 0.5 * (where[1] - where[0])
    return abs(float(nearest_image(np.array(x - middle), 0.0, period))) < half


def _at_births(
    at_tips: list[Change], events: list[Event], low: Solution, high: Solution
) -> list[Event]:
    """The onset events of plateaus at tips, at the loads at which contacts are born there."""
    return [
        Event("onset", one.load, one.position, low.plateaus, high.plateaus, error=one.error)
        for change in at_tips
        for one in events
        if one.kind == "birth" and _within(one.position, change.where, low.scene.period)
    ]


def _located(change: Change, low: Solution, high: Solution) -> Event | None:
    """The event of a change; None if its condition has no zero between the two loads."""
    side = low if change.begins else high
    tables = (low.zones, high.zones) if change.of_contacts else (low.plateaus, high.plateaus)
    if change.kind == "onset" and not len(low.zones) and not len(low.plateaus):
        return _onset_in_full_contact(low, high)
    assert isinstance(high.fields, PlasticFields)
    condition = _Condition(change, high.fields, side)
    try:
        known = {load: condition(load) for load in (side.load, low.load, high.load)}
        if not min(known.values()) < 0.0 < max(known.values()):
            return None
        root = smooth_root(condition, known)
    except (WrongTopology, RuntimeError):
        return None
    error = float(condition.error_at(root))
    return Event(change.kind, float(root), condition.position, *tables, error=error)


def _onset_in_full_contact(low: Solution, high: Solution) -> Event:
    """The onset of the first plateau in full contact, where all pressures rise by equal amounts."""
    assert low.scene.period is not None
    rise = low.scene.law.pressure_range.highest - low.max_pressure
    load = float(low.load + rise * low.scene.period)
    x = np.linspace(high.plateaus[0, 0], high.plateaus[0, 1], 33)
    place, _ = maximum(lambda points: np.asarray(low.pressure(points)), x, peaks=1)
    error = float(low.error * low.max_pressure * low.scene.period / load)
    problem = low.fields.problem
    position = problem.position(float(problem.units.scaled(np.array(place))))
    return Event("onset", load, position, low.plateaus, high.plateaus, error=error)


class _Condition:
    """The condition of an event, a function of the load that is zero at the event.

    `position` [m] is the place of the event found at the last evaluation.
    """

    def __init__(self, change: Change, fields: PlasticFields, side: Solution) -> None:
        self.change, self.problem, self.limit = change, fields.problem, fields.limit
        # Contacts and plateaus at all loads [N/m] that were solved; they start further solutions.
        self.spots: dict[float, Spots] = {side.load: spots_of(fields.problem, side)}
        self.values: dict[float, tuple[float, float]] = {}
        self.position = 0.0
        centre = float(self.spots[side.load].contacts.mean())
        where = np.array([self.problem.units.scaled(np.array(change.where))])
        first, last = centred_on(where, centre, self.problem.period)[0].tolist()
        self.places: Array = np.linspace(first, last, 33)

    def __call__(self, load: float) -> float:
        if load not in self.values:
            fields = self._formal(load)
            self._check_states(fields)
            place, value = maximum(lambda x: -self._at(fields, x), self.places, peaks=1)
            self.position = self.problem.position(place)
            self.values[load] = -value, self._error_of(fields)
        return self.values[load][0]

    def _check_states(self, fields: PlasticFields) -> None:
        """Raise WrongTopology unless the place of the event is in the state that the event needs.

        The states are gap, elastic contact and plateau. At a load far from the event, Newton's
        method may move another gap or elastic interval to this place.
        """
        x = self.places[1:-1]
        touches, yields = fields.inside(x), fields.on_plateaus(x)
        of_contacts, begins = self.change.of_contacts, self.change.begins
        if of_contacts == begins:
            right = ~touches if begins else yields
        else:
            right = touches & ~yields
        if not right.all():
            raise WrongTopology(
                "the place of the event is not in the state of this event (gap, contact, plateau)",
                None,
            )

    def _at(self, fields: PlasticFields, x: Array) -> Array:
        """The function whose least value is the condition of the event.
        Depending on the event, it is the gap, the pressure, limit - pressure, or the overlap.
        """
        if self.change.of_contacts == self.change.begins:
            gap = fields.formal_gap(x)
            return gap if self.change.begins else -gap
        pressure = fields.formal_pressure(x)
        return self.limit - pressure if self.change.begins else pressure

    def _error_of(self, fields: PlasticFields) -> float:
        """Bound of the error of the condition at a load."""
        state = fields.state
        pressure = state.density_error * state.size + TOLERANCES.rounding * self.limit
        if self.change.of_contacts != self.change.begins:
            return float(pressure)
        width = float(fields.density.zones.b.max() - fields.density.zones.a.min())
        return float(pressure * width + fields.gap_rounding)

    def error_at(self, root: float) -> float:
        """Bound of the relative error of the load `root` of the event.
        It is the error of the condition divided by the condition's derivative by the load.
        """
        near, other = sorted(self.values, key=lambda load: abs(load - root))[:2]
        (value, error), (beyond, _) = self.values[near], self.values[other]
        rate = abs((value - beyond) / (near - other))
        return TOLERANCES.margin * error / (rate * root) + TOLERANCES.rounding

    def _formal(self, load: float) -> PlasticFields:
        """Pressure and gap at a load [N/m], with fixed numbers of contacts and plateaus.

        Pressure or gap may have the wrong sign.
        """
        nearest = min(self.spots, key=lambda known: abs(known - load))
        scaled = Load(load / self.problem.units.load)
        # The error of the condition is of second order in the error of the ends.
        loop = PlasticLoop(self.problem, scaled, self.limit, SEARCH.intermediate**2)
        try:
            zones = self.spots[nearest].zones(loop.problem, loop.limit)
            free = loop.moved(zones, sie.WarmStart())
        except (sie.SingularSystem, ContactError) as failure:
            raise WrongTopology(str(failure), None) from failure
        if len(free.lost) or len(free.met) or not free.converged:
            raise WrongTopology("zones vanish or meet, or do not converge, at this load", free)
        fields = PlasticFields(self.problem, free.state, limit=self.limit)
        self.spots[load] = fields.spots
        return fields
