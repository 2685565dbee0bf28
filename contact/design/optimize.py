"""`optimize`: the best data of a scene within bounds, by scipy with the derivatives of the contact.

The largest pressure is that of several local maxima p_k, and designs that make it small have
several of them equal: it has no derivative there, but each p_k has. So the search is for the least
t that no p_k exceeds, and a largest pressure that is allowed bounds each p_k.

The search is that of scipy.optimize: SLSQP (D. Kraft, DFVLR-FB 88-28, 1988) under conditions,
L-BFGS-B (R. H. Byrd, P. Lu, J. Nocedal and C. Zhu, SIAM J. Sci. Comput. 16, 1995, 1190) without,
and least squares for measured values. What it finds is a local optimum: `Design.optimality` says
how nearly.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from contact.derivatives.places import tops as highest_places
from contact.derivatives.response import NUMBERS, TABLES
from contact.derivatives.result import Sensitivity
from contact.design.objective import PEAK, Measured, Objective, objective_of
from contact.design.variables import Variables
from contact.errors import NotConverged, SceneError, unwarned
from contact.extras import require
from contact.formulation.tolerances import TOLERANCES
from contact.model.checks import one_of
from contact.model.scene import Scene
from contact.solution.solution import Solution
from contact.solver import solve, tolerance
from sie import Array


class Step(NamedTuple):
    """One evaluation of a design: its data by name, the objective, and the conditions' numbers."""

    data: dict[str, Any]
    objective: float
    conditions: Array


class Condition(NamedTuple):
    """A number of the contact and its bounds, which hold at every value of the control."""

    number: str
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Design:
    """The best design found; `contact.optimize` makes it.

    Parameters
    ----------
    scene : Scene
        The scene with the best data.
    data : dict
        The best data by name.
    solutions : tuple of Solution
        The contact at each value of the control.
    objective : float
        Value of the objective for a vector of data.
    optimality : float
        Norm of the part of the gradient that no active bound or condition balances, over the norm
        of the gradient at the start. For measured values: of the gradient of half the sum of
        squares. It is 0 at an optimum.
    history : tuple of Step
        Every evaluation in order: `data`, `objective` and `conditions`.
    covariance : ndarray or None
        For measured values: covariance of the entries of the data, in the order of `data`, if the
        model holds and the deviations are right; else None.
    message : str
        Why the search stopped.

    Examples
    --------
    >>> import contact
    >>> wave = contact.Scene(
    ...     contact.Sinusoid(1e-6, 1e-4), 1e9, contact.Periodic(), mean_pressure=1e7
    ... )
    >>> best = contact.optimize(wave, "max_pressure", over={"profile.amplitude": (5e-7, 2e-6)})
    >>> round(best.data["profile.amplitude"], 12), len(best.solutions)
    (5e-07, 1)
    """

    scene: Scene
    data: dict[str, Any]
    solutions: tuple[Solution, ...] = field(repr=False)
    objective: float
    optimality: float
    history: tuple[Step, ...] = field(repr=False)
    covariance: Array | None = field(default=None, repr=False)
    message: str = ""

    @property
    def solution(self) -> Solution:
        """The contact at the first value of the control."""
        return self.solutions[0]


class _Contact(NamedTuple):
    """The contacts of one design, one for each value of the control, and their derivatives."""

    solutions: tuple[Solution, ...]
    by: tuple[Sensitivity, ...]
    tops: tuple[Sensitivity, ...]


class _Problem:
    """Objective and conditions as functions of the vector of data; it records all evaluations."""

    def __init__(
        self,
        variables: Variables,
        objective: Objective | Measured,
        conditions: tuple[Condition, ...],
        at: tuple[float, ...],
        tol: float,
    ) -> None:
        self.variables, self.objective, self.conditions = variables, objective, conditions
        self.at, self.tol = at, tol
        # Whether the least t is sought that no local maximum of the pressure exceeds.
        self.levels = isinstance(objective, Objective) and objective.name == PEAK
        self.needs_tops = self.levels or any(
            one.number == PEAK and np.isfinite(one.high) for one in conditions
        )
        self.history: list[Step] = []
        self._known: dict[bytes, _Contact] = {}
        self._gradients: dict[tuple[bytes, str], list[Array]] = {}

    def contact(self, vector: Array) -> _Contact:
        """The contacts of a design, one for each value of the control; each is solved once."""
        key = np.asarray(vector, dtype=float).tobytes()
        if key not in self._known:
            scene = self.variables.scene_of(vector)
            name = scene.control[0]
            with unwarned():
                found = tuple(self._solved(scene.under(name, value)) for value in self.at)
            by = tuple(Sensitivity(one, stated=False) for one in found)
            tops: tuple[Sensitivity, ...] = ()
            if self.needs_tops:
                places = [highest_places(one, len(vector) + 1) for one in found]
                tops = tuple(
                    Sensitivity(one, stated=False, tops=at)
                    for one, at in zip(found, places, strict=True)
                )
            self._known[key] = _Contact(found, by, tops)
            self.history.append(
                Step(self.variables.values(vector), self.value(vector), self.numbers(vector))
            )
        return self._known[key]

    def _solved(self, scene: Scene) -> Solution:
        """Contact of a scene; if the tolerance is missed, one with half of the digits right."""
        try:
            return solve(scene, self.tol)
        except NotConverged as missed:
            best = missed.best
            if isinstance(best, Solution) and best.error <= self.tol**0.5:
                if best.certificate.holds:
                    return best
            raise

    def table(self, vector: Array, number: str) -> list[Array]:
        """Values of a number of the contact, one for each value of the control."""
        out = []
        for one in self.contact(vector).solutions:
            value = getattr(one, number)
            if value is None or not np.all(np.isfinite(value)):
                raise SceneError(f"{number} is infinite, or the scene does not define it", number)
            out.append(np.asarray(value, dtype=float))
        return out

    def derivatives(self, vector: Array, number: str) -> list[Array]:
        """Derivatives of a number by the entries of the vector of data, at each control value."""
        key = np.asarray(vector, dtype=float).tobytes(), number
        if key not in self._gradients:
            self._gradients[key] = [
                self.variables.gradient(one, number) for one in self.contact(vector).by
            ]
        return self._gradients[key]

    def residuals(self, vector: Array) -> Array:
        """Computed minus measured values, divided by their standard deviations (m,)."""
        wanted = self.objective
        assert isinstance(wanted, Measured)
        values = np.array(self.table(vector, wanted.number))
        return np.asarray((values - wanted.values) / wanted.deviation)

    def residual_slopes(self, vector: Array) -> Array:
        """Derivatives (m, n) of the m `residuals` by the n entries of the vector of data."""
        wanted = self.objective
        assert isinstance(wanted, Measured)
        return np.array(self.derivatives(vector, wanted.number)) / wanted.deviation[:, None]

    def value(self, vector: Array) -> float:
        """Value of the objective for a vector of data."""
        if isinstance(self.objective, Measured):
            return float(np.sum(self.residuals(vector) ** 2))
        return float(self.objective.of(self.table(vector, self.objective.number))[0])

    def gradient(self, vector: Array) -> Array:
        """Derivatives of the objective by the n entries of the vector of data (n,)."""
        if isinstance(self.objective, Measured):
            return 2 * self.residuals(vector) @ self.residual_slopes(vector)
        table = self.table(vector, self.objective.number)
        of = self.objective.of(table)[1]
        out = np.zeros(len(vector))
        for slopes, weight in zip(self.derivatives(vector, self.objective.number), of, strict=True):
            part = np.asarray(weight, dtype=float)
            out += slopes.reshape(len(vector), -1) @ np.ravel(part)
        return out

    def numbers(self, vector: Array) -> Array:
        """Numbers that have conditions, at all values of the control, as one array."""
        return np.array([v for one in self.conditions for v in self.table(vector, one.number)])

    def tops(self, vector: Array) -> Array:
        """Local maxima of the pressure (values of the control, k), the highest n + 1 of them.

        More than n + 1 do not determine a design of n data. Missing ones are 0.
        """
        out = np.zeros((len(self.at), len(vector) + 1))
        for row, one in zip(out, self.contact(vector).tops, strict=True):
            row[: len(one.linearized.peaks)] = one.linearized.values.max_pressure
        return out

    def top_slopes(self, vector: Array) -> Array:
        """Derivatives of `tops` by the vector (values of the control, k, n)."""
        key = np.asarray(vector, dtype=float).tobytes(), "tops"
        if key not in self._gradients:
            table = []
            for one in self.contact(vector).tops:
                slopes = np.zeros((len(vector) + 1, len(vector)))
                slopes[: len(one.linearized.peaks)] = self.variables.top_slopes(one).T
                table.append(slopes)
            self._gradients[key] = table
        return np.array(self._gradients[key])

    def rooms(self, vector: Array) -> Array:
        """Distances of all conditions from their bounds, divided by the bounds' size.
        A design that meets all conditions has none below 0.
        """
        return self._bounded(vector, counted=True)

    def room_slopes(self, vector: Array) -> Array:
        """Derivatives (m, n) of the m `rooms` by the n entries of the vector of data."""
        return self._bounded(vector, counted=False)

    def _bounded(self, vector: Array, counted: bool) -> Array:
        """`rooms` (m,) if they are counted, else their derivatives (m, n)."""
        out, n = [], len(vector)
        for one in self.conditions:
            for bound, sign in ((one.low, 1.0), (one.high, -1.0)):
                if not np.isfinite(bound):
                    continue
                if one.number == PEAK and sign < 0:
                    some = self.tops(vector) if counted else self.top_slopes(vector)
                elif counted:
                    some = np.array(self.table(vector, one.number))
                else:
                    some = np.array(self.derivatives(vector, one.number))
                rows = some.reshape(-1) if counted else some.reshape(-1, n)
                out.append(sign * (rows - (bound if counted else 0.0)) / (abs(bound) or 1.0))
        return np.concatenate(out) if out else np.zeros(0 if counted else (0, n))


def optimize(
    scene: Scene,
    objective: str | Objective | Measured,
    over: Any,
    subject_to: Sequence[tuple[str, float | None, float | None]] = (),
    *,
    at: Sequence[float] | None = None,
    tol: float = 1e-9,
) -> Design:
    """The best data of a scene within bounds, at one or several values of its control.

    Parameters
    ----------
    scene : Scene
        The first design.
    objective : str, Objective or Measured
        What is made as small as possible: the name of a number of the contact, with a minus sign to
        make it large (its mean over the values of the control); any function of a number; or the
        distance from measured values.
    over : mapping
        Names of data, as in scene files, with their bounds (lowest, highest): numbers, or arrays
        for an array such as "profile.cosine".
    subject_to : sequence of (str, float or None, float or None)
        Numbers of the contact with their lowest and highest value, at every value of the control.
    at : sequence of float or None
        Values of the scene's control; None: its own.
    tol : float
        Tolerance of the contacts.

    Returns
    -------
    Design
        `scene`, `solutions`, `data`, `objective`, `optimality`, `history`, `covariance`.

    Raises
    ------
    SceneError
        If something given is not what it must be, or a derivative is not known.
    NotConverged, OutOfRange
        If a design on the way cannot be solved: narrow the bounds.

    Examples
    --------
    A wave that is stiff under a load, with at most three times the mean pressure anywhere: on a
    wave p = 2 sqrt(mean pressure pi E* amplitude / period).

    >>> import contact
    >>> import numpy as np
    >>> wave = contact.Scene(
    ...     contact.Sinusoid(1e-6, 1e-4), 1e9, contact.Periodic(), mean_pressure=2e7
    ... )
    >>> best = contact.optimize(
    ...     wave, "contact_fraction", over={"profile.amplitude": (8e-7, 5e-6)},
    ...     subject_to=[("max_pressure", None, 6e7)],
    ... )
    >>> bool(np.isclose(best.data["profile.amplitude"], 9 / 4 * 2e7 / np.pi / 1e9 * 1e-4))
    True
    >>> best.optimality < 1e-6, best.history[0].objective > best.objective
    (True, True)
    """
    if not isinstance(scene, Scene):
        raise SceneError.of("scene", scene, "a contact.Scene")
    variables, wanted = Variables.of(scene, over), objective_of(objective)
    values = tuple(float(value) for value in (scene.control[1:] if at is None else at))
    if not values:
        raise SceneError.of("at", at, "one or more values of the control")
    if isinstance(wanted, Measured) and len(wanted.values) != len(values):
        raise SceneError.of("values", wanted.values, f"{len(values)} of them, one for each of `at`")
    problem = _Problem(variables, wanted, _conditions(subject_to), values, tolerance(tol))
    search = _least_squares if isinstance(wanted, Measured) else _minimum
    if isinstance(wanted, Measured) and problem.conditions:
        raise SceneError.of("subject_to", subject_to, "left out for measured values")
    return search(problem)


def _conditions(given: Any) -> tuple[Condition, ...]:
    out = []
    for one in given:
        try:
            number, low, high = one
        except (TypeError, ValueError):
            raise SceneError.of("subject_to", one, "(number, lowest, highest)") from None
        one_of("subject_to", number, [name for name in NUMBERS if name not in TABLES])
        lo, hi = -np.inf if low is None else low, np.inf if high is None else high
        if not lo < hi:
            raise SceneError.of("subject_to", one, "bounds, the lowest below the highest")
        out.append(Condition(number, float(lo), float(hi)))
    return tuple(out)


def _minimum(problem: _Problem) -> Design:
    start = problem.variables.start
    first = problem.gradient(start)
    # The search counts in units of the first gradient: then steps and tolerances are of order 1.
    unit = float(np.abs(first).max()) or 1.0
    if problem.levels:
        return _lowest_levels(problem, unit)
    arguments: dict[str, Any] = {
        "method": "L-BFGS-B",
        "options": {"ftol": TOLERANCES.rounding, "gtol": problem.tol},
    }
    if problem.conditions:
        condition = {"type": "ineq", "fun": problem.rooms, "jac": problem.room_slopes}
        arguments = {
            "method": "SLSQP",
            "constraints": [condition],
            "options": {"ftol": problem.tol},
        }
    found = require("scipy.optimize").minimize(
        lambda v: problem.value(_within(v)) / unit,
        start,
        jac=lambda v: problem.gradient(_within(v)) / unit,
        bounds=[(0.0, 1.0)] * len(start),
        **arguments,
    )
    best = _within(found.x)
    left = _unbalanced(problem, best)
    return _design(problem, best, left / float(np.linalg.norm(first) or 1.0), str(found.message))


def _lowest_levels(problem: _Problem, unit: float) -> Design:
    """The least mean of levels t, one for each value of the control, that no maximum exceeds.

    The vector of the search is that of the data, and t over `unit`.
    """
    start, many = problem.variables.start, len(problem.at)
    n, mean = len(start), np.concatenate((np.zeros(len(start)), np.full(many, 1 / many)))

    def rooms(both: Array) -> Array:
        vector = _within(both[:n])
        below = both[n:, None] - problem.tops(vector) / unit
        return np.concatenate((below.ravel(), problem.rooms(vector)))

    def slopes(both: Array) -> Array:
        return _level_slopes(problem, _within(both[:n]), unit)

    levels = problem.tops(start).max(axis=1) / unit
    found = require("scipy.optimize").minimize(
        lambda both: float(mean @ both),
        np.concatenate((start, levels)),
        jac=lambda both: mean,
        bounds=[(0.0, 1.0)] * n + [(0.0, None)] * many,
        method="SLSQP",
        constraints=[{"type": "ineq", "fun": rooms, "jac": slopes}],
        options={"ftol": problem.tol, "maxiter": max(100, 10 * n)},  # as many peaks become equal
    )
    best = _within(found.x[:n])
    tops = problem.tops(best)
    below = 1 - tops / tops.max(axis=1)[:, None]
    active = np.concatenate((below.ravel(), problem.rooms(best))) <= problem.tol**0.5
    rows = list(_level_slopes(problem, best, unit)[active]) + _at_bounds(problem, best, n + many)
    return _design(problem, best, _left(mean, rows) * np.sqrt(many), str(found.message))


def _level_slopes(problem: _Problem, vector: Array, unit: float) -> Array:
    """Derivatives of levels minus local maxima, and of the conditions' rooms."""
    many, n = len(problem.at), len(vector)
    tops = problem.top_slopes(vector)
    rows = np.zeros((*tops.shape[:2], n + many))
    rows[:, :, :n] = -tops / unit
    for level in range(many):
        rows[level, :, n + level] = 1.0
    rest = problem.room_slopes(vector)
    rest = np.concatenate((rest, np.zeros((len(rest), many))), axis=1)
    return np.concatenate((rows.reshape(-1, n + many), rest))


def _least_squares(problem: _Problem) -> Design:
    start = problem.variables.start
    first = float(np.linalg.norm(problem.gradient(start))) or 1.0
    found = require("scipy.optimize").least_squares(
        lambda v: problem.residuals(_within(v)),
        np.clip(start, problem.tol, 1 - problem.tol),
        jac=lambda v: problem.residual_slopes(_within(v)),
        bounds=(0.0, 1.0),
        xtol=problem.tol,
        ftol=problem.tol,
        gtol=problem.tol,
    )
    best = _within(found.x)
    slopes = problem.residual_slopes(best)
    scale = problem.variables.high - problem.variables.low
    covariance = np.linalg.pinv(slopes.T @ slopes) * np.outer(scale, scale)
    design = _design(problem, best, _unbalanced(problem, best) / first, str(found.message))
    return replace(design, covariance=covariance)


def _within(vector: Array) -> Array:
    return np.clip(np.asarray(vector, dtype=float), 0.0, 1.0)


def _unbalanced(problem: _Problem, vector: Array) -> float:
    """Norm of the part of the gradient that active bounds and conditions do not balance."""
    rows = _at_bounds(problem, vector, len(vector))
    active = problem.rooms(vector) <= problem.tol**0.5
    return _left(problem.gradient(vector), rows + list(problem.room_slopes(vector)[active]))


def _at_bounds(problem: _Problem, vector: Array, count: int) -> list[Array]:
    """Inward directions, with `count` entries, of the bounds that hold a vector."""
    close, unit = problem.tol**0.5, np.eye(count)
    low = [unit[k] for k in np.flatnonzero(vector <= close)]
    return low + [-unit[k] for k in np.flatnonzero(vector >= 1 - close)]


def _left(gradient: Array, rows: list[Array]) -> float:
    """Norm of the part of a gradient that is no sum of rows with multipliers of the right sign.

    The multipliers are those of least squares (Karush, Kuhn & Tucker).
    """
    unit = float(np.linalg.norm(gradient)) or 1.0
    if not rows:
        return float(np.linalg.norm(gradient))
    left: Callable[..., Any] = require("scipy.optimize").nnls
    return float(left(np.array(rows).T, gradient / unit)[1]) * unit


def _design(problem: _Problem, vector: Array, optimality: float, message: str) -> Design:
    found = problem.contact(vector)
    return Design(
        found.solutions[0].scene,
        problem.variables.values(vector),
        found.solutions,
        problem.value(vector),
        optimality,
        tuple(problem.history),
        message=message,
    )
