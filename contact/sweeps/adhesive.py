"""Loading paths of surfaces that adhere: a control rises and falls through a list of values.

Each jump of the contact is recorded, with the energy that it loses. Between two values the
equilibrium is followed step by step (contact.adhesion.loading_path). At each value the contact is
solved, with its stated error and certificate.
"""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from contact.adhesion.cohesive_state import CohesiveState
from contact.adhesion.curve import State
from contact.adhesion.edge_branch import full_by_jkr
from contact.adhesion.events import Jump, PathState
from contact.adhesion.full_contact import as_not_converged
from contact.adhesion.loading_path import LoadingPath
from contact.adhesion.path_start import route_of
from contact.adhesion.separated_fields import SeparatedFields
from contact.adhesion.separated_solution import separated_solution
from contact.errors import OutOfRange, unwarned, warn
from contact.formulation.energy import elastic_energy
from contact.formulation.full_contact import FullFields
from contact.model.checks import finite_array, positive
from contact.model.scene import Scene
from contact.model.units import quantity
from contact.runtime import one_blas_thread
from contact.search.context import SolveContext
from contact.search.grid.tilt import known_part
from contact.search.topology.loop import Progress
from contact.solution import assemble
from contact.solution.drawing import panels
from contact.solution.model_warnings import curve_warnings
from contact.solution.plan import plan
from contact.solution.quantities import Energy
from contact.solution.sampling import surfaces
from contact.solution.solution import Solution
from contact.solver import context_of, solved_at
from contact.sweeps.path_plot import draw_curve, draw_surfaces
from contact.sweeps.path_table import Event
from contact.sweeps.paths import Path
from sie import Array

# The controls that a path may have, each with the name of its values in the plural.
VALUES = {"load": "loads", "mean_pressure": "mean pressures", "approach": "approaches"}


@dataclass(frozen=True, eq=False)
class AdhesiveEvent(Event):
    """An event on the path of surfaces that adhere: a jump, or a smooth change of the zones.

    Parameters
    ----------
    kind : str
        jump-in (separate surfaces jump into contact), birth (a zone begins by touch), merge (a gap
        snaps shut), jump (only ends move), full (the last gap closes), death (a zone separates),
        pull-off (the last zone separates), held or freed (an end reaches or leaves a sharp corner,
        without a jump). Under a tension of finite range there are also split (a zone splits), open
        (full contact opens), and births, merges, splits and deaths that lose no energy.
    load : float
        The load just before the event [N/m].
    position : float
        A place on the profile [m]: the point of touch, the middle of the zone that separates or of
        the gap that closes, or else the end that moves first. If several zones separate together,
        or several gaps close together, it lies in one of them.
    before, after : ndarray
        The zones [m], (n, 2), just before and just after the event; (0, 2) for separate surfaces
        and in full contact.
    value : float
        The value of the control at the event, with a relative error of about 1e-12.
    load_after : float
        The load after the event [N/m]; 0 for separate surfaces.
    approach, approach_after : float or None
        The approach before and after the event [m]; None if it is undefined.
    lost : float or None
        The energy that the event dissipates [J/m]: elastic and surface energy before the event,
        minus elastic and surface energy after it, plus the work of the load during the event. None
        if an approach is undefined, or unknown after a pull-off under a prescribed load.
    surfaces : ndarray or None
        The surfaces just before a pull-off [m], (3, n): positions, the deformed surface, and the
        body above it. None for other events.
    error : None
        The error of the load is not stated for these events.

    Examples
    --------
    A cylinder is pulled off at -3 (pi E* w^2 R/16)^(1/3), and its stored energy is lost.

    >>> import contact
    >>> scene = contact.Scene(
    ...     contact.Parabola(1e-3),
    ...     1e9,
    ...     contact.Isolated(datum=1e-2),
    ...     law=contact.JKR(0.05),
    ...     load=0.0,
    ... )
    >>> (event,) = contact.path(scene, [0.0, -30.0]).events
    >>> event.kind, round(event.load, 6), event.lost > 0
    ('pull-off', -23.665257, True)
    """

    value: float
    load_after: float
    approach: float | None
    approach_after: float | None
    lost: float | None
    surfaces: Array | None = field(default=None, repr=False)

    def change(self) -> str:
        ends = "apart", "full contact"
        before = len(self.before) or ends[self.kind == "open"]
        return f"{before} to {len(self.after) or ends[self.kind == 'full']}"

    def __str__(self) -> str:
        return f"{super().__str__()}, energy lost: {quantity(self.lost, 'J/m', none='not known')}"


@dataclass(frozen=True, eq=False, repr=False)
class AdhesivePath(Path):
    """The path of surfaces that adhere, while a control rises and falls.

    Parameters
    ----------
    solutions : tuple of Solution
        One for each value; for separate surfaces it has no load and no zones.
    passed : tuple of tuple of AdhesiveEvent
        For each value the events since the previous value, in order.
    values : ndarray
        The values of the control, (n,).
    control : str
        "load", "mean_pressure" or "approach".
    stiffness : float or None
        The stiffness of a spring between body and machine [N/m^2]; the approaches are then those of
        the spring's far end.
    followed : ndarray
        The equilibria along the path, (m, 4): load [N/m], approach [m], width in contact [m], and 1
        where the control rose, else 0. A row of nan marks a jump.

    Examples
    --------
    A wave under a load that rises and falls: it jumps into contact and is pulled off. The energy
    lost is the work of the load.

    >>> import contact
    >>> profile, law = contact.Sinusoid(0.01, 1.0), contact.JKR(1e-5)
    >>> wave = contact.Scene(profile, 1.0, contact.Periodic(), law=law, load=0.0)
    >>> loop = contact.path(wave, [-2e-3, 4e-3, -2e-3])
    >>> [event.kind for event in loop.events], abs(loop.work - loop.dissipated) < 1e-9 * loop.work
    (['jump-in', 'pull-off'], True)
    """

    values: Array
    control: str
    stiffness: float | None
    followed: Array = field(repr=False)

    @property
    def approaches(self) -> Array:
        """Approach of each solution [m]; nan for a solution that has no approach."""
        return np.array(
            [np.nan if s.approach is None else s.approach for s in self.solutions], dtype=float
        )

    @property
    def dissipated(self) -> float | None:
        """Energy lost in all jumps [J/m], per period if there is one; None if a loss is unknown."""
        lost = [event.lost for event in self.events if isinstance(event, AdhesiveEvent)]
        return (
            None
            if any(part is None for part in lost) or self._ends is None
            else float(sum(part for part in lost if part is not None))
        )

    @property
    def work(self) -> float | None:
        """Work of the load [J/m] from the first value of the control to the last.

        It is the total energy at the last value minus that at the first, plus the dissipated
        energy. On a closed loop it equals the dissipated energy.
        """
        dissipated = self.dissipated
        return (
            None
            if dissipated is None or self._ends is None
            else self._ends[1].total - self._ends[0].total + dissipated
        )

    def plot(self, ax: Any = None) -> Any:
        """A matplotlib figure: load against approach with its jumps; surfaces before pull-off.

        Parameters
        ----------
        ax : matplotlib Axes, or two of them, or None
            Axes for the load, and for the surfaces; None: a new figure.

        Returns
        -------
        matplotlib.figure.Figure

        Raises
        ------
        MissingExtra
            Without matplotlib.
        SceneError
            If `ax` is not an axes object.
        """
        load, approach, width, rises = self.followed.T
        by_approach = (
            all(
                isinstance(event, AdhesiveEvent) and event.approach is not None
                for event in self.events
            )
            and np.isfinite(
                self.approaches[np.array([len(s.zones) > 0 for s in self.solutions])]
            ).all()
        )
        jumps = []
        for event in self.events:
            assert isinstance(event, AdhesiveEvent)
            both = (
                (event.approach, event.approach_after)
                if by_approach
                else (_width(event.before), _width(event.after))
            )
            if None not in both:
                jumps.append(
                    (
                        event.kind,
                        float(both[0] or 0.0),
                        event.load,
                        float(both[1] or 0.0),
                        event.load_after,
                    )
                )
        across, label = (approach, "approach") if by_approach else (width, "width in contact")
        figure, given = panels(ax, 2)
        draw_curve(given[0], across, load, rises > 0.5, jumps, label)
        if len(given) > 1:
            draw_surfaces(given[1], *self._surfaces())
        return figure

    def _surfaces(self) -> tuple[str, Array, Array, Array, Array]:
        """Title, positions x, deformed surface, profile and zones for a picture of the surfaces.
        All but the title are in metres.
        """
        parted = [
            event
            for event in self.events
            if isinstance(event, AdhesiveEvent) and event.surfaces is not None
        ]
        if parted:
            event = parted[-1]
            assert event.surfaces is not None
            return (
                "just before pull-off",
                *event.surfaces,
                _with_images(event.before, self.solutions[0].scene.period),
            )
        touching = [s for s in self.solutions if np.isfinite(s.gap(0.0)).all()] or list(
            self.solutions
        )
        last = touching[-1]
        x = _places(last.scene, last.zones)
        surface, body = surfaces(last, x)
        closed = len(last.zones) == 0 and last.load != 0.0
        zones = np.array([[x[0], x[-1]]]) if closed else _with_images(last.zones, last.scene.period)
        return f"at load {quantity(last.load, 'N/m')}", x, surface, body, zones

    def to_dict(self) -> dict[str, Any]:
        """A dictionary of the path, its control, the dissipated energy and the work of the load."""
        units = {
            "lost": "J/m",
            "dissipated": "J/m",
            "work": "J/m",
            "load_after": "N/m",
            "approach_after": "m",
        }
        described = super().to_dict()
        described["units"] |= units
        return described | {
            "control": self.control,
            "values": self.values.tolist(),
            "dissipated": self.dissipated,
            "work": self.work,
        }

    @cached_property
    def _ends(self) -> tuple[Energy, Energy] | None:
        first, last = self.solutions[0].energy, self.solutions[-1].energy
        return None if first is None or last is None else (first, last)


def adhesive_path(
    scene: Scene,
    values: ArrayLike,
    tol: float,
    progress: Progress | None,
    control: str,
    stiffness: float | None,
) -> AdhesivePath:
    """The path of surfaces that adhere; for the parameters see `contact.path`."""
    given = finite_array("values", values)
    spring_compliance = None if stiffness is None else 1.0 / positive("stiffness", stiffness)
    run = _PathRun(scene.under(control, 0.0), control, tol, spring_compliance)
    run.refuse(given)
    solutions: list[Solution] = []
    passed: list[tuple[Event, ...]] = []
    with unwarned(), one_blas_thread(), as_not_converged():
        here = run.first(float(given[0]))
        for k, value in enumerate(given):
            if progress is not None:
                progress(control, k, len(given))
            before = here.value
            events: list[Event] = []
            if value / run.unit != before:
                run.rises = float(value / run.unit > before)
            for found in run.loading_path.to(here, float(value) / run.unit):
                if isinstance(found, Jump):
                    run.record_jump(found)
                    events.append(run.event(found))
                else:
                    here = found
            run.record(here)
            solutions.append(run.solved(here, float(value), before if k else 0.0))
            passed.append(tuple(events))
    warn(curve_warnings(solutions), stacklevel=4)
    return AdhesivePath(
        tuple(solutions),
        tuple(passed),
        given,
        control,
        stiffness,
        np.array(run.followed).reshape(-1, 4),
    )


def _width(zones: Array) -> float:
    return float(np.sum(zones[:, 1] - zones[:, 0]))


def _with_images(zones: Array, period: float | None) -> Array:
    """The zones and, on a periodic profile, their images in the two adjacent periods."""
    return zones if period is None else np.concatenate((zones - period, zones, zones + period))


def _places(scene: Scene, zones: Array, count: int = 601) -> Array:
    """Positions at which surfaces are drawn: the interval of all zones and a margin on each side.

    They lie where the profile is known, and cover at most a period. count: number of evenly spaced
    positions; further positions lie densely near the ends of zones.
    """
    lo, hi = scene.profile.x0, scene.profile.x0 + (scene.period or 1.0)
    if len(zones):
        first, last = float(zones[0, 0]), float(zones[-1, 1])
        known = known_part(scene.profile) or (-np.inf, np.inf)
        around = (max(known[0], first - (last - first)), min(known[1], last + (last - first)))
        lo, hi = (
            around if scene.period is None or around[1] - around[0] < scene.period else (lo, hi)
        )
    even, angles = np.linspace(lo, hi, count), np.linspace(0.0, np.pi, 33)
    beside = [a + (b - a) * np.sin(0.5 * angles) ** 2 for a, b in _with_images(zones, scene.period)]
    x = np.unique(np.concatenate([even, *beside]))
    return np.asarray(x[(x >= lo) & (x <= hi)])


class _PathRun:
    """A loading path in progress: its scene, the path already followed, and recorded equilibria.

    scene: the scene at the value 0 of the control. spring_compliance: in m per N/m.
    """

    def __init__(
        self, scene: Scene, control: str, tol: float, spring_compliance: float | None
    ) -> None:
        self.scene, self.control, self.tol = scene, control, tol
        self.context = replace(context_of(scene, tol), spring_compliance=spring_compliance)
        self.route = route_of(self.context)
        self.curve = self.route.events.curve
        self.problem = self.curve.problem
        self.loading_path = LoadingPath(self.route.events, self.note)
        self.followed: list[tuple[float, float, float, float]] = []
        self.rises = 1.0

    def note(self, point: State | None, value: float = 0.0) -> None:
        """Record an equilibrium of the path; if `point` is None, record surfaces that are apart.
        `value` is the value of the control at which they are apart.
        """
        units = self.problem.units
        if point is not None:
            approach = (
                0.0 - point.level * units.height if self.problem.operator.has_approach else np.nan
            )
            width = float(np.diff(point.contact).sum()) * units.length
            self.followed.append((point.load * units.load, approach, width, self.rises))
        elif self.curve.control.compliance is not None:
            self.followed.append((0.0, value * units.height, 0.0, self.rises))

    def record_jump(self, jump: Jump) -> None:
        self.record(jump.before)
        self.followed.append((np.nan,) * 3 + (self.rises,))
        self.record(jump.after)

    def record(self, standing: PathState) -> None:
        if not standing.closed:
            self.note(standing.point, standing.value)

    @property
    def unit(self) -> float:
        """Factor that converts a scaled value of the control to the value that the user gives."""
        unit = self.curve.control.unit(self.problem.units)
        return (
            unit / self.scene.profile.period
            if self.control == "mean_pressure" and self.scene.profile.period
            else unit
        )

    def refuse(self, values: Array) -> None:
        """Raise OutOfRange if one of the prescribed approaches has no equilibrium."""
        if (
            self.control != "approach"
            or self.context.spring_compliance is not None
            or self.scene.period is None
            or self.context.operator.compression
        ):
            return
        highest = assemble.mean_height(self.scene)
        if values.max() >= highest:
            raise OutOfRange(
                f"approach {values.max():.6g} m is not below {highest:.6g} m, the mean height of "
                "the profile above its lowest point: in full contact the approach equals this mean "
                "height at any load. Give smaller approaches"
            )

    def first(self, value: float) -> PathState:
        """The state of the path at the first value of the control.

        The surfaces touch first at the control value `events.first`; below it they are apart.
        """
        scaled, first = value / self.unit, self.route.events.first
        if scaled < min(first, 0.0) or value < 0.0 == first:
            return PathState(scaled)
        if self.context.spring_compliance is not None or value < 0.0:
            # At the same position of the spring's far end, the contact without adhesion may be
            # wider than the adhesive contact. So the path does not start from the contact without
            # adhesion, but from separate surfaces.
            *_, found = self.loading_path.to(PathState(min(-1.0, 2.0 * first)), scaled)
            assert isinstance(found, PathState)
            return found
        return self.route.started(self.scene.under(self.control, value), scaled)

    def solved(self, here: PathState, value: float, before: float) -> Solution:
        """The solution for the state `here` of the path, at a value of the control.

        before: the previous scaled value of the control.
        """
        scene = self.scene.under(self.control, value)
        way = "advancing" if self.rises else "receding"
        described = (
            f"{way}, {'raised' if self.rises else 'lowered'} from {self.control} "
            f"{before * self.unit:.6g}"
        )
        context = replace(self.context, scene=scene, plan=plan(scene), branch=way)
        if here.point is None:
            return self._without_zones(context, here)
        fields = self.route.fields(here.point)
        if isinstance(fields, SeparatedFields):
            assert isinstance(here.point, CohesiveState)
            return separated_solution(context.scene, fields, here.point, context.plan, way)
        solution = solved_at(context, self.route.outcome(context, here.point), described)
        return (
            solution
            if context.spring_compliance is None
            else replace(solution, scene=self.scene.under("load", solution.load))
        )

    def _without_zones(self, context: SolveContext, here: PathState) -> Solution:
        held, units = self.curve.control, self.problem.units
        if here.closed:
            mean_pressure = full_by_jkr(context).mean_pressure
            scene = (
                context.scene
                if context.spring_compliance is None
                else self.scene.under("load", self._closed_load(here.value))
            )
            return assemble.full_contact_solution(
                scene, context.full, mean_pressure, context.plan, context.tol, context.branch
            )
        return assemble.apart_solution(
            context.scene,
            self.problem,
            None if held.compliance is None else here.value * units.height,
            context.plan,
        )

    def _closed_load(self, value: float) -> float:
        """Load of surfaces that are closed over the whole period [N/m]."""
        assert self.scene.period is not None
        scene = self.scene.under(self.control, value * self.unit)
        return full_by_jkr(replace(self.context, scene=scene)).mean_pressure * self.scene.period

    def event(self, jump: Jump) -> AdhesiveEvent:
        units = self.problem.units
        load, approach, energy, zones = self._state(jump.before)
        load_after, approach_after, energy_after, zones_after = self._state(jump.after)
        by_load = self.curve.control.load is not None
        if jump.kind == "pull-off" and by_load and approach is not None:
            # If the load is prescribed, it does not determine the approach after pull-off.
            # `approach_after` is then the approach at which the same surfaces would separate if the
            # approach were prescribed.
            assert jump.before.point is not None
            last = self.route.separation(jump.before.point)
            approach_after = None if last is None else float(-last.level * units.height)
        lost = None
        if (
            energy is not None
            and energy_after is not None
            and approach is not None
            and approach_after is not None
        ):
            done = (load if by_load else 0.5 * (load + load_after)) * (approach_after - approach)
            lost = 0.0 if jump.smooth else float(energy - energy_after + done)
        drawn = None
        if jump.kind == "pull-off" and jump.before.point is not None:
            fields = self.route.fields(jump.before.point)
            # Contact may end in points. The picture then shows the intervals of tension.
            x = _places(self.scene, zones if _width(zones) > 0.0 else fields.cohesive)
            surface = self.scene.profile.counter_height(x) - fields.displacement(x)
            drawn = np.array([x, surface, surface + fields.gap(x)])
        value = float(jump.before.value * self.unit)
        place = self.problem.position(jump.place)
        return AdhesiveEvent(
            jump.kind,
            load,
            place,
            zones,
            zones_after,
            value,
            load_after,
            approach,
            approach_after,
            lost,
            drawn,
        )

    def _state(self, standing: PathState) -> tuple[float, float | None, float | None, Array]:
        """Load [N/m], approach [m], energy [J/m] and zones [m] of a state of the path."""
        units, none = self.problem.units, np.zeros((0, 2))
        if (point := standing.point) is not None:
            fields = self.route.fields(point)
            energy = self._energy(fields, float(np.diff(point.contact).sum()) * units.length)
            return (
                point.load * units.load,
                fields.approach,
                energy,
                assemble.in_cell(self.scene, np.asarray(units.x(point.contact))),
            )
        if standing.closed:
            assert self.scene.period is not None
            load = self._closed_load(standing.value)
            full = FullFields(
                assemble.period_problem(self.scene),
                load / self.scene.period,
                self.context.full.relief,
                assemble.mean_height(self.scene),
            )
            return load, full.approach, self._energy(full, self.scene.period), none
        held = self.curve.control
        approach: float | None = 0.0 if held.compliance is None else standing.value * units.height
        return 0.0, approach if self.problem.operator.has_approach else None, 0.0, none

    def _energy(self, fields: Any, width: float) -> float | None:
        """Elastic energy plus surface energy of a contact of this width [J/m]."""
        elastic = elastic_energy(fields)
        return None if elastic is None else elastic + self.scene.law.surface_energy(fields, width)
