"""Load paths: solutions at a list of loads, and the events between them.

An event is a change of the number of zones. Frictionless contact grows with the load: every zone at
a load lies inside a zone at any higher load. So a zone of the higher load that contains no zone of
the lower load was born in between. A zone that contains several zones of the lower load was merged
from them. Each kind of event has a condition that is zero at the load of the event. The condition
is computed with a fixed number of zones, and signs of pressure and gap are not checked:

    birth (death)   the least gap at the place of the new zone, computed without that zone,
    merge (split)   the least pressure between the two zones, computed as if they were one zone,
    full            the least pressure of full contact (contact.formulation.full_contact).

The names hold for a rising load; for a falling load the same event is a death or a split. Under a
rising load, deaths and splits are looked for in two cases. If a moment is given, the body turns as
the load grows and may lift off on one side. On bodies other than the half-plane, it is not known
whether contact grows with the load.
"""

import json
from dataclasses import dataclass
from os import PathLike
from typing import Any

import numpy as np

from contact.errors import NotConverged, OutOfRange, unwarned, warn
from contact.extras import require
from contact.formulation.gaps import GapFields
from contact.formulation.roots import maximum, smooth_root
from contact.formulation.tables import centred_on, gaps_between
from contact.model.scene import Scene
from contact.search.topology.changes import Change, changes
from contact.search.topology.extrapolation import CurvePoint
from contact.search.topology.failure import WrongTopology
from contact.search.topology.gap_form import GapForm
from contact.search.topology.loop import Progress
from contact.search.topology.pressure_form import PressureForm
from contact.solution.export import new_file
from contact.solution.model_warnings import curve_warnings
from contact.solution.solution import Solution
from contact.sweeps import path_table
from contact.sweeps.curve import Curve, FailureCollector
from contact.sweeps.event_search import EventSearch, follows
from contact.sweeps.hidden_events import OPTIONS as HIDDEN
from contact.sweeps.hidden_events import ends_and_rates, may_hide
from contact.sweeps.path_plot import plot_path
from contact.sweeps.path_table import Event
from sie import Array, nearest_image


@dataclass(frozen=True)
class PathOptions:
    """Tolerances of the search for events between two loads; differences of loads are relative."""

    # Loads whose relative difference is below this count as equal. While an event is located, this
    # is also the tolerance of ends, relative to the width of their zone.
    same: float = 1e-7
    # A fraction with three uses. Zones at two loads count as the same zone if they overlap by this
    # fraction of the narrower width. It is assumed that no zone is born and merges within a
    # relative load step shorter than this fraction. An unconverged solution is used for its number
    # of zones if its error is below this fraction.
    negligible: float = 1e-3
    # If the ratio of two loads exceeds this, the motion of ends between the loads cannot be
    # predicted from the ends' rates (derivatives by ln(load)) at the two loads.
    max_load_ratio: float = 1.3

    @property
    def retries_beyond(self) -> tuple[float, ...]:
        """Relative distances beyond two nearly equal loads at which an event is sought, too.

        The two loads differ by less than `same`. Round-off can give a certified sign the wrong
        value, so that the event between the loads seems to lie beyond them.
        """
        return tuple(np.geomspace(self.same, self.negligible, 5))

    @property
    def rate_step(self) -> float:
        """Relative load step over which the ends of zones are extrapolated by their rates.

        The relative error of the extrapolated ends is about the square of the load step.
        """
        return float(np.sqrt(self.same))


OPTIONS = PathOptions()
# Name of an event under a falling load, for each name under a rising load.
_REVERSED = {"birth": "death", "merge": "split", "full": "full", "death": "birth", "split": "merge"}


# The module that writes a path as text. It is imported when it is first needed.
_REPORT = "contact.sweeps.path_report"


@dataclass(frozen=True, eq=False, repr=False)
class Path:
    """Solutions at the given loads and the events between them, in the order of the path.

    Parameters
    ----------
    solutions : tuple of Solution
        One for each load.
    passed : tuple of tuple of Event
        For each load, the events since the previous load, in order.

    Examples
    --------
    >>> import contact
    >>> scene = contact.Scene(contact.Parabola(1.0), 1e9, contact.Isolated(), load=1.0)
    >>> found = contact.path(scene, [1e3, 4e3])
    >>> found.loads.round(6).tolist(), found.events
    ([1000.0, 4000.0], ())
    """

    solutions: tuple[Solution, ...]
    passed: tuple[tuple[Event, ...], ...]

    @property
    def events(self) -> tuple[Event, ...]:
        """All events, in the order of the path."""
        return tuple(event for events in self.passed for event in events)

    @property
    def loads(self) -> Array:
        """Loads of the solutions (n,) [N/m]."""
        return np.array([solution.load for solution in self.solutions])

    def __str__(self) -> str:
        """The numbers at each load and the events, as tables with units."""
        text: str = require(_REPORT).report(self)
        return text

    def __repr__(self) -> str:
        text: str = require(_REPORT).summary(self)
        return text

    def plot(self, ax: Any = None) -> Any:
        """Draw contact and approach against the load, with the events marked.

        Parameters
        ----------
        ax : matplotlib Axes, or two of them, or None
            Axes for contact, and for the approach; None: a new figure.

        Returns
        -------
        matplotlib.figure.Figure

        Raises
        ------
        MissingExtra
            Without matplotlib.
        SceneError
            If `ax` is not an axes object, or two are given and the scene has no approach.
        """
        return plot_path(self.solutions, self.passed, ax)

    def to_dict(self) -> dict[str, Any]:
        """The path as a dictionary in plain types; None for infinite or undefined values."""
        return path_table.to_dict(self.solutions, self.passed)

    def save(self, path: str | PathLike[str], overwrite: bool = False) -> None:
        """Write one row for each load to a .csv file, or `to_dict` to a .json file.

        Raises
        ------
        SceneError
            For another ending, or if the file exists and `overwrite` is not given.
        """
        file = new_file(path, overwrite, (".csv", ".json"))
        csv = file.suffix.lower() == ".csv"
        text = (
            path_table.to_csv(self.solutions, self.passed)
            if csv
            else json.dumps(self.to_dict(), allow_nan=False) + "\n"
        )
        file.write_text(text, encoding="utf-8")


def growing_path(scene: Scene, values: Array, tol: float, progress: Progress | None) -> Path:
    """The path along loads [N/m], under a law whose contact grows with the load.
    See `contact.path`.
    """
    plastic = scene.law.routes.first is not None
    search = require("contact.sweeps.plastic_path").PlasticPath if plastic else PathSearch
    run: PathSearch = search(scene, tol, progress)
    run.curve.solve_in_closed_form(values)
    solutions: list[Solution] = []
    passed: list[tuple[Event, ...]] = []
    failures = FailureCollector("load")
    with unwarned():
        for k, load in enumerate(values):
            if progress is not None:
                progress("load", k, len(values))
            try:
                here = run.curve.at(float(load))
            except OutOfRange as error:
                raise OutOfRange(f"at the load {load:.6g} N/m: {error}") from error
            except NotConverged as failure:
                failures.add(load, failure)
                continue
            passed.append(tuple(run.between(solutions[-1], here)) if solutions else ())
            solutions.append(here)
    found = Path(tuple(solutions), tuple(passed))
    failures.refuse(len(solutions), found)
    # Warnings are given once, for the highest load, at which slopes and pressures are largest. They
    # point to the caller of `contact.path`.
    warn(curve_warnings(solutions), stacklevel=4)
    return found


class PathSearch:
    """The search for events along one path."""

    def __init__(self, scene: Scene, tol: float, progress: Progress | None = None) -> None:
        self.scene = scene
        self.curve = Curve(scene, "load", tol)
        self.progress = progress
        self.events_found = 0

    def intermediate(self, load: float, start: Solution) -> Solution:
        """The solution at a load between two others, accurate enough to count its zones.
        It is started from the solution `start`.

        Close to an event, a zone or gap may be too narrow for the tolerance. The best state is then
        used if the signs of its pressure and gap are right.
        """
        try:
            return self.curve.from_previous(load, (CurvePoint(start),), OPTIONS.same)
        except NotConverged as failure:
            if (
                isinstance(failure.best, Solution)
                and failure.best.certificate.holds
                and failure.best.error < OPTIONS.negligible
            ):
                return failure.best
            raise

    def between(self, first: Solution, last: Solution) -> list[Event]:
        """The events between two solutions, in the order of the path."""
        rising = last.load >= first.load
        low, high = (first, last) if rising else (last, first)
        events = sorted(self._events(low, high), key=lambda event: event.load)
        if rising:
            return events
        return [
            Event(_REVERSED[e.kind], e.load, e.position, e.after, e.before)
            for e in reversed(events)
        ]

    def _events(self, low: Solution, high: Solution) -> list[Event]:
        if len(high.zones) == 0:
            return self._to_full(low, high) if len(low.zones) else []
        if low.load < high.load and follows(low):
            events = EventSearch(low, high, self.intermediate).events()
            if events is not None:
                return events
        turns = low.scene.turned and low.scene.moment is not None
        found = changes(
            low.zones,
            high.zones,
            low.scene.period,
            low.scene.operator.is_plain and not turns,
            OPTIONS.negligible,
        )
        step = (high.load - low.load) / high.load
        apart = step > OPTIONS.same
        hides = high.load > OPTIONS.max_load_ratio * low.load or (
            step > OPTIONS.negligible and may_hide(low, high)
        )
        if not found and not hides:
            return []
        if apart and (hides or len(found) > 1):
            middle = self.intermediate(float(np.sqrt(low.load * high.load)), low)
            return self._events(low, middle) + self._events(middle, high)
        events = []
        for change in found:
            event = self._event(change, low, high, beyond=() if apart else OPTIONS.retries_beyond)
            if event is None and apart:
                middle = self.intermediate(0.5 * (low.load + high.load), low)
                return self._events(low, middle) + self._events(middle, high)
            if event is None:
                raise NotConverged(
                    f"the event {change.kind!r} between the loads {low.load:.17g} and "
                    f"{high.load:.17g} N/m was not located"
                )
            events.append(event)
            self.events_found += 1
            if self.progress is not None:
                self.progress("events", self.events_found, None)
        return events

    def _to_full(self, low: Solution, full: Solution) -> list[Event]:
        """The events between a solution and full contact; the last event closes the last gap."""
        assert low.scene.period is not None
        load = self.curve.cache.full.onset_pressure * low.scene.period
        # `last` is the solution just below the load of full contact, where one gap is still open.
        last = self.intermediate(max(low.load, load * (1 - OPTIONS.same)), low)
        return [*self._events(low, last), *_full_event(load, full, last)]

    def _event(
        self, change: Change, low: Solution, high: Solution, beyond: tuple[float, ...] = ()
    ) -> Event | None:
        """The event at which the zones change, e.g. a merger: the zero of a condition on the load.
        The condition is the least gap or the least pressure near the place of the event.

        None if the condition does not change sign. The condition is evaluated at both loads, and
        beyond them by the relative distances `beyond`: near an event the certificate accepts signs
        that are wrong by round-off.
        """
        side, other = (low, high) if change.ahead else (high, low)
        condition = _Condition(side.fields, change)
        load = condition.problem.units.load
        try:
            # `condition` stores the zones of every evaluation, and starts each new one from stored
            # zones.
            known = {side.fields.load / load: condition.of(side.fields)}
            tried: list[tuple[float, ...]] = [
                (low.load * (1 - part), high.load * (1 + part)) for part in (0.0, *beyond)
            ]
            if not beyond and (about := _just_beyond(change, side, other)):
                tried.insert(0, (about,))
            for ends in tried:
                known |= {
                    end / load: condition(end / load) for end in ends if end / load not in known
                }
                if min(known.values()) < 0.0 < max(known.values()):
                    root = smooth_root(condition, known)
                    return Event(
                        change.kind, float(root * load), condition.position, low.zones, high.zones
                    )
        except WrongTopology:
            pass
        return None


def _just_beyond(change: Change, side: Solution, other: Solution) -> float | None:
    """A load slightly farther from `side` than the event; None if it is not between both solutions.

    The event is predicted from the motion of ends in the solution `other`. Near a birth (a merger),
    the square of the width of the new zone (the gap) is linear in ln(load). The rate of this square
    gives the load of the event, at which the width is zero.
    """
    found, period = ends_and_rates(other), other.scene.period
    if found is None:
        return None
    table, outward = found
    grows = outward.sum(axis=1)
    if not change.of_gap:
        table, grows = gaps_between(table, period), -outward[:, 1] - np.roll(outward[:, 0], -1)
    k = int(
        np.argmin(np.abs(nearest_image(table.mean(axis=1) - np.mean(change.where), 0.0, period)))
    )
    (a, b), grows = table[k], grows[k]
    if grows == 0.0:
        return None
    load = other.load * float(np.exp((HIDDEN.rate_error - 1.0) * (b - a) / (2 * grows)))
    return load if min(side.load, other.load) < load < max(side.load, other.load) else None


class _Condition:
    """The condition of an event: a function of the scaled load that is zero at the event.

    `position` [m] is the place of the least gap or pressure of the last evaluation.
    """

    position = 0.0

    def __call__(self, load: float) -> float:
        return self.of(self.formal(load))

    def of(self, fields: Any) -> float:
        """Value of the condition: the least gap or the least pressure near the place of the event.

        It is the least gap around a zone to be born, or the least pressure between two zones that
        have merged. fields: pressure and gap, computed with a fixed number of zones.
        """
        function = fields.formal_gap if self.of_gap else fields.formal_pressure
        place, value = maximum(lambda x: -function(x), np.linspace(*self.where, 33), peaks=1)
        self.position = self.problem.position(place)
        return -value

    def __init__(self, fields: Any, change: Change) -> None:
        self.problem, self.of_gap = fields.problem, change.of_gap
        self.form = (
            PressureForm(self.problem)
            if not isinstance(fields, GapFields)
            else GapForm(self.problem, fields.relief)
        )
        # The keys of this table are scaled loads, the values are the zones (or gaps) at these
        # loads. The second load is close to the first load. Its zones are extrapolated with the
        # rates of the ends (derivatives by ln(load)).
        load, table = fields.load / fields.problem.units.load, fields.solved_zones.table
        self.tables: dict[float, Array] = {
            load: table,
            load * (1 + OPTIONS.rate_step): table + OPTIONS.rate_step * _moving(fields),
        }
        self.where = _scaled(fields, change.where)

    def start(self, load: float) -> Array:
        """Initial zones (or gaps) at a load, extrapolated from the two nearest stored loads.

        If the extrapolation changes the width of some zone or gap by more than a factor of two, the
        zones (or gaps) of the nearest stored load are used.
        """
        near, far = sorted(self.tables, key=lambda known: abs(known - load))[:2]
        first = self.tables[near]
        table = first + (load - near) / (far - near) * (self.tables[far] - first)
        grown = np.diff(table.ravel()) / np.diff(first.ravel())
        return np.asarray(table) if np.all((grown > 0.5) & (grown < 2.0)) else first

    def formal(self, load: float) -> Any:
        """Pressure and gap at a load for a fixed number of zones (or gaps); both may be negative.

        Later calls start from the zones found here.
        """
        fields = self.form.formal(load, self.start(load), OPTIONS.same, OPTIONS.same**2)
        self.tables[load] = fields.solved_zones.table
        return fields


def _moving(fields: Any) -> Array:
    """Derivatives of the scaled ends of zones (or gaps), (n, 2), by the logarithm of the load."""
    outward = fields.spreading / fields.problem.units.length
    if not isinstance(fields, GapFields):
        return np.asarray(outward * (-1, 1))
    return np.column_stack((np.roll(outward[:, 1], 1), -outward[:, 0]))


def _scaled(fields: Any, places: tuple[float, float]) -> tuple[float, float]:
    """Two places in scaled coordinates, moved to the period in which the zones of `fields` lie."""
    zones, problem = fields.solved_zones, fields.problem
    middle = 0.5 * float(zones.a[0] + zones.b[-1])
    a, b = centred_on(np.array([problem.units.scaled(np.array(places))]), middle, problem.period)[
        0
    ].tolist()
    return a, b


def _full_event(load: float, full: Solution, low: Solution) -> list[Event]:
    """The event that closes the last gap, in a list; empty if a concave kink lies in that gap.

    The pressure at such a kink is minus infinity in full contact, so the gap never closes.
    """
    gaps = gaps_between(low.zones, low.scene.period)
    first, last = gaps[np.argmax(np.diff(gaps)[:, 0])].tolist()
    kinks = low.scene.profile.kinks
    over = centred_on(kinks[kinks[:, 1] < 0, :1], 0.5 * (first + last), low.scene.period)
    if np.any((over > first) & (over < last)):
        return []
    place, _ = maximum(lambda points: -full.pressure(points), np.linspace(first, last, 65))
    problem = low.fields.problem
    position = problem.position(float(problem.units.scaled(np.array(place))))
    return [Event("full", load, position, low.zones, np.zeros((0, 2)))]
