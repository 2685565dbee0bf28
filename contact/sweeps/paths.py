"""Load paths: solutions at a list of loads, and the events between them at which the number of
zones changes.

Frictionless contact grows with the load: every zone at a load lies inside one at a higher load. So
between two loads a zone is born where the higher one has none below it, and zones merge where it
has several. Each event is found on its own condition, with the topology held fixed and the signs
free:

    birth (death)   the least gap at the place of the new zone is zero, without that zone,
    merge (split)   the least pressure between the two zones is zero, with the two already one,
    full            the least pressure of full contact is zero (contact.formulation.full_contact).

Names are given for a growing load; for a falling one the same event is a death or a split. At a
given moment the body turns as the load grows, and may lift off again on one side: there deaths and
splits are looked for as well, and so they are where the body is not a half-plane, on which alone
contact is known to grow with the load.
"""

import json
from dataclasses import dataclass
from os import PathLike
from typing import Any

import numpy as np

from contact.errors import NotConverged, OutOfRange, unwarned, warn
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
from contact.sweeps.curve import Curve
from contact.sweeps.hidden import ends_and_rates, may_hide
from contact.sweeps.path_plot import plot_path
from contact.sweeps.path_table import Event
from sie import Array, nearest_image

# Loads closer than this part of themselves are one: events within it are reported at their own
# loads but not separated.
_CLOSE = 1e-7
# Between loads closer than this part of themselves nothing is looked for that both leave unseen.
_SEEN = 1e-3
# Loads over one another from which on the rates of the ends at both tell nothing.
_FAR = 1.3
# Parts of its loads by which an event may lie beyond two that are as good as one.
_BEYOND = (1e-6, 1e-5, 1e-4)
# Of ends and of coefficients on the way to an event: pressure and gap away from an end that is off
# change by the square of that.
_ENDS = 1e-7
_DECAY = 1e-14
# Of a load, how far beside it the rates of the ends are as good as a second state.
_RIGHT_BESIDE = 1e-4
# Of a state from which others start: these of the nearest loads.
_THROUGH = 4
# Zooms to a least gap or pressure, the place of which is about known.
_ZOOMS = 5
# Tolerance of states between two loads; an error with which they still tell which zones there are.
_ON_THE_WAY = 1e-6
_USEFUL = 1e-3
# Where the last gap but one has closed, as a rule: this far below the load of full contact.
_BEFORE_FULL = 1e-7
# Of the way from an event to the solution that tells where it is: how much farther one looks to
# have it behind.
_MARGIN = 0.1
# Of the narrower of two zones, what they share where one becomes the other: ends beside narrow gaps
# may overlap by rounding.
_SHARED = 1e-3
_REVERSED = {"birth": "death", "merge": "split", "full": "full", "death": "birth", "split": "merge"}


@dataclass(frozen=True, eq=False)
class Path:
    """Solutions at the given loads and the events between them, in the order of the path.

    Parameters
    ----------
    solutions : tuple of Solution
        One for each load.
    passed : tuple of tuple of Event
        For each load the changes of the number of zones since the load before, in order.

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
        """All events, in order."""
        return tuple(event for events in self.passed for event in events)

    @property
    def loads(self) -> Array:
        """Loads of the solutions (n,) [N/m]."""
        return np.array([solution.load for solution in self.solutions])

    def plot(self, ax: Any = None) -> Any:
        """Contact and approach over the load, with the events marked: a matplotlib figure of its
        own, or of the axes given.

        Parameters
        ----------
        ax : matplotlib Axes, or two of them, or None
            Where contact over the load is drawn, and approach over the load; None: in a new figure.

        Returns
        -------
        matplotlib.figure.Figure

        Raises
        ------
        MissingExtra
            Without matplotlib.
        SceneError
            If `ax` is no axes, or two of them where the scene has no approach.
        """
        return plot_path(self.solutions, self.passed, ax)

    def to_dict(self) -> dict[str, Any]:
        """Numbers of each load, events, scene and units in plain types; None for what is infinite
        or undefined.
        """
        return path_table.to_dict(self.solutions, self.passed)

    def save(self, path: str | PathLike[str], overwrite: bool = False) -> None:
        """Write a row for each load as CSV, or all of `to_dict` as JSON: .csv or .json says which.

        Raises
        ------
        SceneError
            If the name ends otherwise, or the file is there and `overwrite` is not given.
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
    """Along loads [N/m], under a law by which contact only grows with the load; see `contact.path`."""
    run = _Path(scene, tol, progress)
    run.curve.look_at(values)
    solutions: list[Solution] = []
    passed: list[tuple[Event, ...]] = []
    with unwarned():
        for k, load in enumerate(values):
            if progress is not None:
                progress("load", k, len(values))
            try:
                here = run.curve.at(float(load))
            except OutOfRange as error:
                raise OutOfRange(f"at the load {load:.6g} N/m: {error}") from error
            passed.append(tuple(run.between(solutions[-1], here)) if solutions else ())
            solutions.append(here)
    # Of the highest load, where slopes and pressures are; of the line that called `contact.path`.
    warn(curve_warnings(solutions), stacklevel=4)
    return Path(tuple(solutions), tuple(passed))


class _Path:
    def __init__(self, scene: Scene, tol: float, progress: Progress | None = None) -> None:
        self.scene, self.curve, self.progress, self.found = (
            scene,
            Curve(scene, "load", tol),
            progress,
            0,
        )

    def on_the_way(self, load: float, near: Solution) -> Solution:
        """A state between two loads: close to an event a zone or gap may be too narrow for the
        tolerance, and still serve.
        """
        try:
            return self.curve.beside(load, (CurvePoint(near),), _ON_THE_WAY)
        except NotConverged as failure:
            if (
                isinstance(failure.best, Solution)
                and failure.best.certificate.holds
                and failure.best.error < _USEFUL
            ):
                return failure.best
            raise

    def between(self, first: Solution, last: Solution) -> list[Event]:
        """The events on the way from one solution to the next."""
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
        turns = low.scene.turned and low.scene.moment is not None
        found = changes(
            low.zones,
            high.zones,
            low.scene.period,
            low.scene.operator.is_plain and not turns,
            _SHARED,
        )
        apart = high.load - low.load > _CLOSE * high.load
        hides = high.load > _FAR * low.load or (
            high.load - low.load > _SEEN * high.load and may_hide(low, high)
        )
        if not found and not hides:
            return []
        if apart and (hides or len(found) > 1):
            middle = self.on_the_way(float(np.sqrt(low.load * high.load)), low)
            return self._events(low, middle) + self._events(middle, high)
        events = []
        for change in found:
            event = self._event(change, low, high, beyond=() if apart else _BEYOND)
            if event is None and apart:
                middle = self.on_the_way(0.5 * (low.load + high.load), low)
                return self._events(low, middle) + self._events(middle, high)
            if event is None:
                raise NotConverged(
                    f"the {change.kind} between loads {low.load:.17g} and {high.load:.17g} was not located"
                )
            events.append(event)
            self.found += 1
            if self.progress is not None:
                self.progress("events", self.found, None)
        return events

    def _to_full(self, low: Solution, full: Solution) -> list[Event]:
        """The events up to full contact."""
        assert low.scene.period is not None
        load = self.curve.cache.full.relieved * low.scene.period
        # Other gaps close before the last one does.
        last = self.on_the_way(max(low.load, load * (1 - _BEFORE_FULL)), low)
        return [*self._events(low, last), *_full_event(load, full, last)]

    def _event(
        self, change: Change, low: Solution, high: Solution, beyond: tuple[float, ...] = ()
    ) -> Event | None:
        """The event of one change; None if its condition does not change sign between the two
        loads, nor where it is looked for beyond them, by these parts of the loads: signs within
        their rounding pass a certificate on either side of the event.
        """
        side, other = (low, high) if change.ahead else (high, low)
        condition = _Condition(side.fields, change)
        load = condition.problem.units.load
        try:
            # Each state starts from the zones of the last: close to a zero its sign may depend on
            # the way there.
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
                        change.kind, root * load, condition.position, low.zones, high.zones
                    )
        except WrongTopology:
            pass
        return None


def _just_beyond(change: Change, side: Solution, other: Solution) -> float | None:
    """A load a little beyond the event, seen from the solution that the condition begins with; None
    where the other one does not tell.

    It tells when nothing is left of its zone that is born, or of its gap that closes: squared
    widths go evenly with the logarithm of the load.
    """
    told, period = ends_and_rates(other), other.scene.period
    if told is None:
        return None
    table, outward = told
    grows = outward.sum(axis=1)
    if not change.of_gap:
        table, grows = gaps_between(table, period), -outward[:, 1] - np.roll(outward[:, 0], -1)
    k = int(
        np.argmin(np.abs(nearest_image(table.mean(axis=1) - np.mean(change.where), 0.0, period)))
    )
    (a, b), grows = table[k], grows[k]
    if grows == 0.0:
        return None
    load = other.load * float(np.exp((_MARGIN - 1.0) * (b - a) / (2 * grows)))
    return load if min(side.load, other.load) < load < max(side.load, other.load) else None


class _Condition:
    """A function of the scaled load that is zero at the event; `position` [m] is where it was last
    evaluated.
    """

    position = 0.0

    def __call__(self, load: float) -> float:
        return self.of(self.formal(load))

    def of(self, fields: Any) -> float:
        """Of a state with the zones that the condition is about: the least gap about the place
        where the higher load has a zone of its own, or the least pressure between two zones that
        have become one.
        """
        function = fields.formal_gap if self.of_gap else fields.formal_pressure
        place, value = maximum(
            lambda x: -function(x), np.linspace(*self.where, 33), levels=_ZOOMS, peaks=1
        )
        self.position = float(self.problem.profile.wrap(self.problem.units.x(np.array(place))))
        return -value

    def __init__(self, fields: Any, change: Change) -> None:
        self.problem, self.of_gap = fields.problem, change.of_gap
        self.form = (
            PressureForm(self.problem)
            if fields.relief is None
            else GapForm(self.problem, fields.relief)
        )
        # Of the loads at which it was evaluated, and of one right beside the first: the zones (or
        # gaps) found there.
        load, table = fields.load / fields.problem.units.load, fields.density.zones.table
        self.tables: dict[float, Array] = {
            load: table,
            load * (1 + _RIGHT_BESIDE): table + _RIGHT_BESIDE * _moving(fields),
        }
        self.where = _scaled(fields, change.where)

    def start(self, load: float) -> Array:
        """Zones to begin with: by the polynomial through those of the nearest loads, where that
        keeps them and their gaps about as wide.
        """
        nearest = sorted(self.tables, key=lambda known: abs(known - load))[:_THROUGH]
        first = self.tables[nearest[0]]
        others = [
            [(load - other) / (at - other) for other in nearest if other != at] for at in nearest
        ]
        table = np.tensordot(
            np.prod(np.array(others).reshape(len(nearest), -1), axis=1),
            np.array([self.tables[at] for at in nearest]),
            1,
        )
        grown = np.diff(table.ravel()) / np.diff(first.ravel())
        return np.asarray(table) if np.all((grown > 0.5) & (grown < 2.0)) else first

    def formal(self, load: float) -> Any:
        """Fields with this number of zones, or of gaps, at a load, whatever the signs; later calls
        start from these.
        """
        fields = self.form.formal(load, self.start(load), _ENDS, _DECAY)
        self.tables[load] = fields.density.zones.table
        return fields


def _moving(fields: Any) -> Array:
    """How far the ends of a state's zones, or gaps, move with the logarithm of the load (n, 2)."""
    outward = fields.spreading / fields.problem.units.length
    if fields.relief is None:
        return np.asarray(outward * (-1, 1))
    return np.column_stack((np.roll(outward[:, 1], 1), -outward[:, 0]))


def _scaled(fields: Any, places: tuple[float, float]) -> tuple[float, float]:
    """Two places in the scaled period in which the fields' own zones stand."""
    zones, problem = fields.density.zones, fields.problem
    middle = 0.5 * float(zones.a[0] + zones.b[-1])
    a, b = centred_on(np.array([problem.units.scaled(np.array(places))]), middle, problem.period)[
        0
    ].tolist()
    return a, b


def _full_event(load: float, full: Solution, low: Solution) -> list[Event]:
    """The closing of the last gap, but that of one over a kink, which never does."""
    gaps = gaps_between(low.zones, low.scene.period)
    first, last = gaps[np.argmax(np.diff(gaps)[:, 0])].tolist()
    kinks = low.scene.profile.kinks
    over = centred_on(kinks[kinks[:, 1] < 0, :1], 0.5 * (first + last), low.scene.period)
    if np.any((over > first) & (over < last)):
        return []
    place, _ = maximum(lambda points: -full.pressure(points), np.linspace(first, last, 65))
    return [Event("full", load, float(low.scene.profile.wrap(place)), low.zones, np.zeros((0, 2)))]
