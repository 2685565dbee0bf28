"""The search for all events between two loads of a contact that grows with the load.

An event is the birth of a zone or the merger of two zones. The search follows the contact from the
lower load, from event to event. The motion of zones and gap, as derivatives by s = ln(load),
predicts the next event. An event is located as the zero of a condition: a least gap or a least
pressure. The condition is computed with the zones that exist on one side of the event, so that it
is a smooth function of s. Its values and derivatives at a few loads give its zero by inverse
Hermite interpolation. Each value takes one solution with a fixed number of zones; mostly two
solutions suffice. The last solution is the contact at the event, and the search goes on from it. If
bodies overlap in it, a zone was born at a smaller load, and the first such birth is located
instead.

Each kind of event is a class (`Birth`, `Merger`) with a name, the condition, the zones that are
used for the condition, and the zones after the event.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

import sie
from contact.formulation.fields import ZoneFields
from contact.formulation.gaps import GapFields
from contact.formulation.roots import reaches
from contact.formulation.tables import ascending, gaps_between, in_cell
from contact.search.options import SEARCH
from contact.search.topology.changes import changes
from contact.search.topology.extrapolation import Motion, hermite_weights
from contact.search.topology.failure import WrongTopology
from contact.search.topology.gap_form import GapForm
from contact.search.topology.intervals import NEW_ZONE, merged, without
from contact.search.topology.pressure_form import PressureForm
from contact.solution.solution import Solution
from contact.sweeps.hidden_events import Ends, jumped, unexplained
from contact.sweeps.path_table import Event
from sie import Array, Index, Mask, record


@dataclass(frozen=True)
class EventOptions:
    """Options of the search for events (births and mergers of zones) between two loads."""

    # Tolerance of the ends of zones, relative to the width of their zone, while an event is
    # predicted. While an event is located, the tolerance is smaller by the factor
    # `SearchOptions.tight_factor`. Each event is the zero of a condition (a least gap or pressure).
    # The error of a condition is of second order in the error of the ends, but the error of its
    # derivative is of first order.
    ends: float = 1e-7
    # Predictions of events are linear in ln(load). An event that is predicted beyond the last load,
    # by up to half of the distance to that load, may still come before the last load.
    reach: float = 1.5
    # Largest difference of ln(load) over which events are predicted. Over a larger one, the gap may
    # get new minima.
    max_step: float = 0.3
    # Number of samples of the gap per smallest length over which the profile varies. An interval
    # has at least as many samples as four such lengths.
    samples: float = 4.0


_OPTIONS = EventOptions()
Fields = ZoneFields | GapFields
NOWHERE = np.zeros(0)


@record
class Value:
    """Value and derivative, at one ln(load), of the condition of an event.
    The condition is a least gap or pressure that is zero at the event.
    """

    at: float
    value: float
    rate: float


@record
class Birth:
    """The birth of a zone: a minimum of the gap, computed without the new zone, falls to zero.

    place: scaled place of the minimum. reach: distance from this place within which the minimum is
    sought. at: predicted ln(load). known: computed values of the condition.
    """

    place: float
    reach: float
    at: float
    known: tuple[Value, ...] = ()
    kind = "birth"
    rises = -1.0  # sign of the condition's derivative by ln(load)

    @property
    def joined(self) -> Array:
        """Places of gaps that count as closed in the computation of the condition; here none."""
        return NOWHERE

    def condition(self, point: PathPoint) -> Minimum:
        """The minimum of the gap near the place of the birth.
        Its value is infinite if there is none.
        """
        low, high = gap_around(point.zones, self.place, point.period)
        first, last = max(low, self.place - self.reach), min(high, self.place + self.reach)
        tips = _tips(point.fields, self.place)
        return local_minimum(point.fields.formal_gap, first, last, self.place, tips)

    def rate(self, fields: Fields, place: float) -> float:
        """Derivative of the condition (the least gap at `place`) by ln(load)."""
        return float(fields.rates(np.array([place]), _OPTIONS.ends)[1][0])

    def tables(self, zones: Array, place: float, period: float | None) -> tuple[Array, Array]:
        """The zones before and after the birth. `zones` are the zones without the new one."""
        return zones, with_born(zones, np.array([place]), period)


@record
class Merger:
    """The merger of two zones, at the load at which the least pressure between them is zero.
    This pressure is computed as if the two zones were one zone.

    place: scaled middle of the gap. reach: half the width of the gap with a margin. at: predicted
    ln(load). known: computed values of the condition.
    """

    place: float
    reach: float
    at: float
    known: tuple[Value, ...] = ()
    kind = "merge"
    rises = 1.0

    @property
    def joined(self) -> Array:
        return np.array([self.place])

    def condition(self, point: PathPoint) -> Minimum:
        """The least pressure between the two zones, computed as if they were one zone."""
        first, last = self.place - self.reach, self.place + self.reach
        return local_minimum(point.fields.formal_pressure, first, last, self.place, NOWHERE)

    def rate(self, fields: Fields, place: float) -> float:
        """Derivative of the condition (the least pressure at `place`) by ln(load)."""
        return float(fields.pressure_rates(np.array([place]), _OPTIONS.ends)[0])

    def tables(self, zones: Array, place: float, period: float | None) -> tuple[Array, Array]:
        """The zones before and after the merger.
        `zones`: the zones after the merger, in which the two zones are one.
        """
        place = float(sie.wrapped(np.array(place), float(zones[0, 0]), period))
        k = int(np.searchsorted(zones[:, 0], place, side="right")) - 1
        parts = np.array([[zones[k, 0], place], [place, zones[k, 1]]])
        return np.concatenate((zones[:k], parts, zones[k + 1 :])), zones


@record
class Renewal:
    """A load without event at which the contact is solved, so that predictions become better."""

    at: float
    kind = ""

    @property
    def joined(self) -> Array:
        return NOWHERE


Awaited = Birth | Merger
"""The kinds of events that are awaited while contact grows."""


@record
class PathPoint(sie.Kept):
    """A contact on the path of growing loads, given by its pressure and gap.

    at: ln(scaled load). born: zones that begin at this load and have no width yet, one row each
    (k, 3). A row has the scaled place, minus the derivative of the least gap by ln(load), and half
    the second derivative of the gap by place. pieces: intervals (m, 2) that are open here and in
    contact at the higher load.
    """

    fields: Fields
    at: float
    pieces: Array = field(repr=False)
    born: Array = field(default_factory=lambda: np.zeros((0, 3)))

    @property
    def period(self) -> float | None:
        return self.fields.problem.period

    @cached_property
    def samples(self) -> tuple[Array, Index, Array]:
        """(places, index of the interval, gap) of samples in the intervals `pieces`.
        Samples at which the gap is round-off are left out.
        """
        found, rows = [NOWHERE], []
        for a, b in self.pieces:
            n = int(_OPTIONS.samples * max((b - a) / self.fields.spacing, 4.0))
            found.append(a + (b - a) * np.sin(0.5 * np.pi * (np.arange(n) + 0.5) / n) ** 2)
            rows.append(n)
        x, row = np.concatenate(found), np.repeat(np.arange(len(rows)), rows)
        gap = self.fields.formal_gap(x)
        some = np.abs(gap) > self.fields.gap_rounding
        return x[some], row[some], gap[some]

    def _minima(self, values: Array) -> Mask:
        """Mask of the samples at which the given values have a local minimum."""
        row, out = self.samples[1], np.zeros(len(values), dtype=bool)
        if len(values) > 2:
            inner = (row[2:] == row[:-2]) & (values[1:-1] < values[:-2])
            out[1:-1] = inner & (values[1:-1] <= values[2:])
        return out

    @property
    def overlaps(self) -> Array:
        """Places of the local minima of the sampled gap near which the gap may be negative.
        It may be negative at the sample itself, or between this sample and its neighbours.
        """
        x, _, gap = self.samples
        return x[self._minima(gap) & (reaches(-gap) > 0.0)]

    @property
    def touches(self) -> tuple[Array, Array]:
        """Places that come into contact before the places around them, and the ln(load) of contact.
        This ln(load) is predicted with the present derivative of the gap by ln(load).
        """
        x, _, gap = self.samples
        with np.errstate(divide="ignore"):
            left = np.where(self.rates[1] < 0.0, -gap / self.rates[1], np.inf)
        some = self._minima(left) & (gap > 0.0)
        return x[some], self.at + left[some]

    @cached_property
    def rates(self) -> tuple[Array, Array]:
        """Derivatives by ln(load): of the ends, outward (n, 2), and of the gap at `samples`."""
        return self.fields.rates(self.samples[0])

    @property
    def ends(self) -> Ends:
        """Scaled zones and the rates of their ends (derivatives by ln(load)).
        The rates of zones of no width are nan.
        """
        table, rates = self.fields.zones, self.rates[0]
        if len(self.born):
            new = sie.wrapped(self.born[:, 0], float(table[0, 0]), self.period)
            table = np.concatenate((table, np.column_stack((new, new))))
            rates = np.concatenate((rates, np.full((len(new), 2), np.nan)))
        order = np.argsort(table[:, 0])
        return Ends(table[order], rates[order], _OPTIONS.ends)

    @property
    def zones(self) -> Array:
        """Scaled zones (n, 2), including the newly born zones, which have no width yet."""
        return with_born(self.fields.zones, self.born[:, 0], self.period)

    @cached_property
    def motions(self) -> tuple[Motion, Motion]:
        """Positions and rates of the zones, and of the gaps to their right.
        Rates are derivatives by ln(load).
        """
        table, (left, right) = self.fields.zones, self.rates[0].T
        gaps = gaps_between(table, self.period)
        return Motion.of(table, -left, right), Motion.of(gaps, right, -np.roll(left, -1))

    def table(self, at: float, joined: Array) -> Array:
        """First guess of the scaled zones at another ln(load).

        Middles and squared half widths of zones and gaps are linear in ln(load). An end is taken
        from the zone or the gap that it bounds, whichever is narrower. joined: scaled places in
        gaps that are closed at the other load. Zones in `born` get a width.
        """
        (middle, half), (place, room) = (self._moved(motion, at) for motion in self.motions)
        width, gap = (motion.values[1] for motion in self.motions)
        with np.errstate(invalid="ignore"):  # an infinite gap gives nan
            left, right = np.roll(place + room, 1), place - room
            if self.period is not None:
                left[0] -= self.period
            left = np.where(width <= np.roll(gap, 1), middle - half, left)
            right = np.where(width <= gap, middle + half, right)
        table = np.column_stack((left, right))
        if len(self.born):
            table = ascending(np.concatenate((table, self._grown(at, table))))
        if len(joined):
            where = sie.wrapped(joined, float(table[0, 0]), self.period)
            closed = np.searchsorted(table[:, 0], where, side="right") - 1
            table = merged(table, closed, self.period)
        return table

    def _moved(self, motion: Motion, at: float) -> tuple[Array, Array]:
        """Extrapolated middles and half widths of zones or gaps at another ln(load).
        The half widths have a lower limit, so that no interval gets the width zero.
        """
        middle, square = motion.values + (at - self.at) * motion.rates
        return middle, np.sqrt(np.maximum(square, SEARCH.doubtful_part**2 * motion.values[1]))

    def _grown(self, at: float, table: Array) -> Array:
        """First guesses, at another ln(load), of the zones that are born at this contact."""
        rows = []
        for place, rate, bend in self.born:
            x = float(sie.wrapped(np.array(place), float(table[0, 0]), self.period))
            low, high = gap_around(table, x, self.period)
            half = NEW_ZONE * np.sqrt(max(at - self.at, 0.0) * rate / bend)
            half = min(half, 0.5 * (x - low), 0.5 * (high - x))
            rows.append((x - half, x + half))
        return np.array(rows)


def with_born(zones: Array, places: Array, period: float | None) -> Array:
    """The zones and, at the given places, new zones of no width; all in ascending order."""
    if len(places) == 0:
        return zones
    new = sie.wrapped(places, float(zones[0, 0]), period)
    return ascending(np.concatenate((zones, np.column_stack((new, new)))))


def gap_around(zones: Array, place: float, period: float | None) -> tuple[float, float]:
    """Ends of the gap that contains a scaled place, moved to the period in which the place lies."""
    x = float(sie.wrapped(np.array(place), float(zones[0, 0]), period))
    k = int(np.searchsorted(zones[:, 0], x, side="right")) - 1
    low, high = gaps_between(zones, period)[k] if k >= 0 else (-np.inf, float(zones[0, 0]))
    return low + place - x, high + place - x


def _tips(fields: Fields, near: float) -> Array:
    """Scaled places of convex kinks of the profile, moved to the period around a place."""
    kinks, heights = fields.problem.forcing.kinks
    return sie.nearest_image(kinks[heights > 0], near, fields.problem.period)


@record
class Minimum:
    """Place and value of a function's minimum, and half of its second derivative there."""

    place: float
    value: float
    bend: float


def local_minimum(
    function: Callable[[Array], Array], first: float, last: float, place: float, tips: Array
) -> Minimum:
    """The local minimum of a function in an interval; if there are several, the nearest to `place`.

    The value is infinite if there is no minimum. tips: places at which the function may have a
    kink.
    """
    if not first < last:
        return Minimum(place, np.inf, 1.0)
    # Four refinements reduce the spacing of the samples to 1e-5 of the interval. The error of the
    # final parabola is of the fourth power in the spacing.
    for _ in range(4):
        x = np.linspace(first, last, 33)
        value = np.asarray(function(x))
        inner = np.flatnonzero((value[1:-1] <= value[:-2]) & (value[1:-1] < value[2:])) + 1
        if len(inner) == 0:
            return Minimum(place, np.inf, 1.0)
        k = int(inner[np.argmin(np.abs(x[inner] - place))])
        first, last = x[k - 1], x[k + 1]
    step = x[k] - first
    before, here, after = value[k - 1 : k + 2]
    bend = 0.5 * (before - 2 * here + after) / step**2
    slope = 0.5 * (after - before) / step
    found = Minimum(x[k] - 0.5 * slope / bend, here - 0.25 * slope**2 / bend, bend)
    inside = tips[(tips > first) & (tips < last)]
    if len(inside):
        at = np.asarray(function(inside))
        if at.min() <= found.value + 0.5 * (here - found.value):
            return Minimum(float(inside[np.argmin(at)]), float(at.min()), bend)
    return found


class Watched:
    """An event that is being located, with the known values of its condition.
    The condition is a least gap or pressure that is zero at the event.

    zero: estimate of the event's ln(load); inf if there is none.
    """

    def __init__(self, event: Awaited) -> None:
        self.event, self.values = event, list(event.known)
        self.zero, self.found = event.at, Minimum(event.place, np.inf, 1.0)

    def evaluate(self, point: PathPoint) -> None:
        """Compute the event's condition for a solved contact, and add it to the known values."""
        self.found = self.event.condition(point)
        if not np.isfinite(self.found.value):
            self.zero = np.inf
            return
        rate = self.event.rate(point.fields, self.found.place)
        self.values.append(Value(point.at, self.found.value, rate))
        self.zero = self._estimate()

    def _estimate(self) -> float:
        """Zero of the condition by inverse Hermite interpolation, or by Newton's method.
        Newton's zero is taken if the interpolated one is farther from it than the length of
        Newton's step.
        """
        last, rises = self.values[-1], self.event.rises
        if not last.rate * rises > 0.0:
            return np.inf
        newton = last.at - last.value / last.rate
        some = [one for one in self.values[-3:] if one.rate * rises > 0.0]
        values = np.array([one.value for one in some])
        if len(np.unique(values)) < len(values):
            return newton
        by_value, by_rate = hermite_weights(values)
        at = float(
            by_value @ np.array([one.at for one in some])
            + by_rate @ np.array([1.0 / one.rate for one in some])
        )
        return at if abs(at - newton) <= abs(newton - last.at) else newton


def follows(low: Solution) -> bool:
    """Whether this search for events applies to a solution.
    It needs contact that grows with the load, and closed forms of the ends' rates that hold for any
    load.
    """
    scene, fields = low.scene, low.fields
    return (
        isinstance(fields, ZoneFields | GapFields)
        and scene.operator.is_plain
        and not scene.turned
        and not scene.interaction.strip
        and not fields.problem.kappa
    )


class EventSearch:
    """The search for all events between two solutions of contact that grows."""

    def __init__(
        self,
        low: Solution,
        high: Solution,
        solve: Callable[[float, Solution], Solution],
        start: PathPoint | None = None,
    ) -> None:
        fields = low.fields
        assert isinstance(fields, ZoneFields | GapFields)
        self.problem, self.low, self.high, self.solve = fields.problem, low, high, solve
        self.form = (
            GapForm(fields.problem, fields.relief)
            if isinstance(fields, GapFields)
            else PressureForm(fields.problem)
        )
        self.end = self._log(high.load)
        self.last = np.asarray(self.problem.units.scaled(high.zones))
        after, units = Ends.of(high), self.problem.units
        assert after is not None
        self.after = Ends(units.scaled(after.zones), after.rates / units.length, high.error)
        self.reach = fields.spacing
        self.start = self._point(fields, self._log(low.load)) if start is None else start

    def _log(self, load: float) -> float:
        """The logarithm of the scaled load, for a load in N/m."""
        return float(np.log(load / self.problem.units.load))

    def events(self) -> list[Event] | None:
        """All events in order; None if the search is not certain of them."""
        here, found = self.start, list[Event]()
        for _ in range(SEARCH.max_steps):
            awaited = self._next(here)
            if awaited is None:
                return None if self._changes(here) else found
            try:
                passed, here = self._passed(here, awaited)
            except WrongTopology:
                rest = self._divided(here)
                return None if rest is None else found + rest
            found += passed
        return None

    def _divided(self, here: PathPoint) -> list[Event] | None:
        """The events after a contact, found in two halves of the remaining loads.
        The contact is solved at a load in the middle, and the search is done on each side of it.
        """
        if self.end - here.at < SEARCH.rough:
            return None
        load = float(np.exp(0.5 * (here.at + self.end))) * self.problem.units.load
        middle = self.solve(load, self.low)
        first = EventSearch(self.low, middle, self.solve, here).events()
        second = None if first is None else EventSearch(middle, self.high, self.solve).events()
        return None if first is None or second is None else first + second

    def _changes(self, here: PathPoint) -> bool:
        """Whether the zones of the higher load differ from the present ones in number or place."""
        return bool(changes(here.zones, self.last, here.period, True))

    def _next(self, here: PathPoint) -> Awaited | Renewal | None:
        """The event that is predicted next; None if no further event is expected.

        If no event is predicted within `EventOptions.max_step`, the contact is solved there first.
        """
        left, due = self.end - here.at, self._changes(here)
        if left <= 0.0:
            return None
        awaited: list[Awaited | Renewal] = [*self._births(here), *self._mergers(here)]
        if not due:
            awaited = [one for one in awaited if one.at < here.at + _OPTIONS.reach * left]
        if left > _OPTIONS.max_step:
            awaited.append(Renewal(here.at + _OPTIONS.max_step))
        while awaited:
            first = min(awaited, key=lambda one: one.at)
            if first.at > self.end:
                return Renewal(self.end if due else here.at + 0.5 * left)
            if not isinstance(first, Birth) or first.known:
                return first
            awaited.remove(first)
            exact = self._evaluated(here, first)
            if exact is not None and len(here.born):
                return exact
            awaited.append(exact or Renewal(first.at))
        if due:
            return Renewal(self.end)
        return Renewal(here.at + 0.5 * left) if self._hides(here, left) else None

    def _hides(self, here: PathPoint, left: float) -> bool:
        """Whether a zone may be born, and merge with another zone, without being predicted.

        left: difference of ln(load) up to the higher load.
        """
        return left > SEARCH.rough and unexplained(here.ends, self.after, left, here.period)

    def _births(self, here: PathPoint) -> list[Birth]:
        """Predicted births, at the places `touches` that touch before the places around them.
        All these places are in contact at the higher load.
        """
        return [Birth(x, self.reach, at) for x, at in zip(*here.touches, strict=True)]

    def _mergers(self, here: PathPoint) -> list[Merger | Renewal]:
        """Predicted mergers, in gaps that are in contact at the higher load and become narrower.
        Also `Renewal`s at loads at which newly born zones have become wide.

        The motion of a gap beside a newly born zone is unknown. Before the zone is half as wide as
        the gap, the contact is therefore solved again.
        """
        gaps = gaps_between(here.zones, here.period)
        closes = gaps[self._zone_over(gaps.mean(axis=1)) >= 0]
        first = sie.wrapped(self.last[:, 0], closes[:, :1], here.period)
        closes = closes[~((first > closes[:, :1]) & (first < closes[:, 1:])).any(axis=1)]
        (middles, squares), (moves, falls) = here.motions[1].values, here.motions[1].rates
        known = here.motions[1].table
        out: list[Merger | Renewal] = []
        for a, b in closes:
            k = np.flatnonzero((known[:, 0] == a) & (known[:, 1] == b))
            if len(k) and falls[k[0]] < 0.0:
                at = -squares[k[0]] / falls[k[0]]
                place = middles[k[0]] + moves[k[0]] * at
                out.append(Merger(float(place), 0.625 * (b - a), here.at + float(at)))
            for place, rate, bend in here.born if len(k) == 0 else ():
                if place in (a, b):
                    wide = (0.5 * (b - a) / NEW_ZONE) ** 2 * bend / rate
                    out.append(Renewal(here.at + float(wide)))
        return out

    def _zone_over(self, x: Array) -> Array:
        """Index of the zone, at the higher load, that contains each scaled place x.
        The index is -1 if no zone contains the place.
        """
        zones, period = self.last, self.problem.period
        x = sie.wrapped(x, float(zones[0, 0]), period)
        k = np.searchsorted(zones[:, 0], x, side="right") - 1
        inside = (k >= 0) & (x <= zones[k, 1])
        over = (period is not None) & (x + (period or 0.0) <= zones[-1, 1])
        return np.where(inside, k, np.where(over, len(zones) - 1, -1))

    def _passed(self, here: PathPoint, awaited: Awaited | Renewal) -> tuple[list[Event], PathPoint]:
        """The events located next, and the contact from which the search goes on.

        If the contact cannot be solved at the predicted load, or if an end passed over a zone, half
        of the step is tried.
        """
        for _ in range(SEARCH.max_attempts):
            try:
                events, there = self._located(here, awaited)
            except WrongTopology:
                awaited = Renewal(0.5 * (here.at + min(awaited.at, self.end)))
                continue
            if not jumped(here.ends, there.ends, there.at - here.at, here.period):
                return events, there
            awaited = Renewal(0.5 * (here.at + there.at))
            if awaited.at - here.at < SEARCH.rough * SEARCH.doubtful_part:
                # Without this lower limit, the search would make shorter and shorter load steps,
                # and would never pass a load at which an end of a zone jumps.
                break
        raise WrongTopology("the ends of zones move too fast with the load", None)

    def _located(
        self, here: PathPoint, awaited: Awaited | Renewal
    ) -> tuple[list[Event], PathPoint]:
        """The next events, and the contact after them.
        The contact is solved with the zones that are used for the condition of `awaited`.

        The list is empty if no event is found up to the load at which the contact is solved.
        """
        at, base, joined = min(awaited.at, self.end), here, awaited.joined
        watched = [] if isinstance(awaited, Renewal) else [Watched(awaited)]
        error, ends = np.inf, _OPTIONS.ends
        for _ in range(2 * SEARCH.max_attempts):
            point = self._solved(base, at, joined, ends)
            ends = _OPTIONS.ends * SEARCH.tight_factor
            if not isinstance(awaited, Merger):
                watched += self._overlapping(here, point, watched)
            for one in watched:
                one.evaluate(point)
            zero = min((one.zero for one in watched), default=np.inf)
            if zero > self.end:
                if any(one.found.value < 0.0 for one in watched):
                    raise WrongTopology("zones are born at unknown loads", None)
                return [], point
            before, error = error, abs(zero - at)
            # `left` is an estimate of the error of `zero`. Inverse Hermite interpolation converges
            # with an order of nearly three.
            left = error * min(error / before, 1.0) ** 3 if np.isfinite(before) else error
            if left <= SEARCH.least_error:
                return self._events_at(here, point, watched, zero)
            at, base, joined = max(zero, here.at), point, NOWHERE
        raise WrongTopology("an event was not located", None)

    def _events_at(
        self, here: PathPoint, point: PathPoint, watched: list[Watched], zero: float
    ) -> tuple[list[Event], PathPoint]:
        """The events at the load `zero`, and the contact after them.
        If another event comes before a merger, that event is returned instead.
        """
        if zero < here.at - _OPTIONS.ends:
            raise WrongTopology("an event lies before the contact where its search began", None)
        if isinstance(watched[0].event, Merger):
            others = self._overlapping(here, point, [])
            for one in others:
                one.evaluate(point)
            first = min(others, key=lambda one: one.zero, default=None)
            if first is not None and first.zero < zero - _OPTIONS.ends:
                return self._located(here, replace(first.event, at=first.zero))
        table, born, events = point.table(zero, NOWHERE), [], []
        for one in watched:
            if one.zero - zero > _OPTIONS.ends:
                continue
            before, table = one.event.tables(table, one.found.place, point.period)
            events.append(
                Event(
                    one.event.kind,
                    float(np.exp(one.zero)) * self.problem.units.load,
                    self.problem.position(one.found.place),
                    self._in_metres(before),
                    self._in_metres(table),
                )
            )
            if isinstance(one.event, Birth):
                born.append((one.found.place, -one.values[-1].rate, one.found.bend))
        return events, self._point(point.fields, point.at, np.array(born).reshape(-1, 3))

    def _evaluated(self, here: PathPoint, birth: Birth) -> Birth | None:
        """The birth, with its condition (the least gap) at the contact `here`.
        None if the gap has no minimum there.

        If zones have just been born at `here`, the rates (derivatives by ln(load)) at `here` are
        about to change. The condition then serves for the prediction only, and is not kept as a
        known value.
        """
        one = Watched(birth)
        one.evaluate(here)
        if not np.isfinite(one.found.value):
            return None
        known = () if len(here.born) else tuple(one.values)
        return Birth(one.found.place, birth.reach, one.zero, known)

    def _overlapping(
        self, here: PathPoint, point: PathPoint, watched: list[Watched]
    ) -> list[Watched]:
        """Births of zones at places where the bodies overlap.
        Places of births that are already in `watched` are left out.
        """
        places = np.array([one.event.place for one in watched])
        found = []
        for place in point.overlaps:
            away = sie.nearest_image(places - place, 0.0, here.period)
            if np.all(np.abs(away) > self.reach):
                event = Birth(place, self.reach, point.at)
                found.append(Watched(self._evaluated(here, event) or event))
        return found

    def _solved(self, base: PathPoint, at: float, joined: Array, ends: float) -> PathPoint:
        """The contact at a given ln(load), computed from the zones of `base` as a first guess.
        The number of zones is fixed, so the pressure or the gap may be negative.
        """
        table = base.table(at, joined)
        if isinstance(self.form, GapForm):
            before = np.append(table[-1, 1] - self.problem.repeat_length, table[:-1, 1])
            table = np.column_stack((before, table[:, 0]))
        if not np.all(np.diff(table.ravel()) > 0.0):
            raise WrongTopology("zones or gaps have no width", None)
        decay = _OPTIONS.ends**2
        return self._point(self.form.formal(float(np.exp(at)), table, ends, decay), at)

    def _point(self, fields: Fields, at: float, born: Array | None = None) -> PathPoint:
        born = np.zeros((0, 3)) if born is None else born
        zones, last, period = (
            with_born(fields.zones, born[:, 0], fields.problem.period),
            self.last,
            fields.problem.period,
        )
        if period is not None:
            # The border of the period is placed in a gap that is open at the higher load.
            zones = in_cell(
                zones, float(last[0, 0] - 0.5 * (last[0, 0] + period - last[-1, 1])), period
            )
        return PathPoint(fields, at, without(last, zones), born)

    def _in_metres(self, table: Array) -> Array:
        return in_cell(
            self.problem.units.x(table), self.low.scene.profile.x0, self.low.scene.period
        )
