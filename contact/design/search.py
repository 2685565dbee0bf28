"""Searches for the best design.

The largest pressure is the largest of several local maxima p_k. In a design that makes it small,
several p_k are equal. There the largest pressure has no derivative, but each p_k has one. So the
search minimizes a number t (a level) under the conditions p_k <= t, and a condition on the largest
pressure becomes a condition on each p_k. The largest stress in the body, and the inverse of the
load of first yield, are minimized in the same way.

The searches are those of scipy.optimize: SLSQP (D. Kraft, DFVLR-FB 88-28, 1988) under conditions,
L-BFGS-B (R. H. Byrd, P. Lu, J. Nocedal and C. Zhu, SIAM J. Sci. Comput. 16, 1995, 1190) without
conditions, and least squares for measured values. They find a local optimum. `Design.optimality`
says how closely the conditions for an optimum are met.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from contact.design.problem import Problem
from contact.design.result import Design
from contact.errors import NotConverged
from contact.extras import require
from contact.formulation.tolerances import TOLERANCES
from sie import Array


def minimum(problem: Problem) -> Design:
    """The design with the smallest objective, by SLSQP under conditions, else by L-BFGS-B."""
    if problem.minimizes_levels:
        return _lowest_levels(problem)
    start = problem.variables.start
    first = problem.gradient(start)
    # The objective is divided by the size of the first gradient, so that steps and tolerances are
    # of order 1.
    unit = float(np.abs(first).max()) or 1.0
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
    best = problem.best(_within(found.x))
    left = _unbalanced(problem, best)
    return _design(problem, best, left / float(np.linalg.norm(first) or 1.0), str(found.message))


def _lowest_levels(problem: Problem) -> Design:
    """The design with the smallest mean of the levels t, one level for each contact.

    A level t is at least as large as each value of its contact at the places that compete for the
    objective, such as local maxima of the pressure (`Problem.competing`). The unknowns of the
    search are the vector of data, and the levels t divided by the size of the first derivatives.
    """
    start = problem.variables.start
    values, slopes = problem.competing(start), problem.competing_slopes(start)
    n, many = len(start), len(values)
    unit = float(np.abs(slopes[np.arange(many), np.argmax(values, axis=1)]).max()) or 1.0
    mean = np.concatenate((np.zeros(n), np.full(many, 1 / many)))

    def rooms(both: Array) -> Array:
        vector = _within(both[:n])
        below = both[n:, None] - problem.competing(vector) / unit
        return np.concatenate((below.ravel(), problem.rooms(vector)))

    def slopes_of(both: Array) -> Array:
        return _level_slopes(problem, _within(both[:n]), unit)

    found = require("scipy.optimize").minimize(
        lambda both: float(mean @ both),
        np.concatenate((start, values.max(axis=1) / unit)),
        jac=lambda both: mean,
        bounds=[(0.0, 1.0)] * n + [(0.0, None)] * many,
        method="SLSQP",
        constraints=[{"type": "ineq", "fun": rooms, "jac": slopes_of}],
        options={"ftol": problem.tol, "maxiter": max(100, 10 * n)},  # since peaks become equal
    )
    best = problem.best(_within(found.x[:n]))
    values = problem.competing(best)
    below = 1 - values / values.max(axis=1)[:, None]
    active = np.concatenate((below.ravel(), problem.rooms(best))) <= problem.tol**0.5
    rows = list(_level_slopes(problem, best, unit)[active]) + _at_bounds(problem, best, n + many)
    return _design(problem, best, _residual_norm(mean, rows) * np.sqrt(many), str(found.message))


def _level_slopes(problem: Problem, vector: Array, unit: float) -> Array:
    """Derivatives of the constraints of `_lowest_levels`; a row for each constraint.

    The columns belong to the entries of the vector of data, then to the unknowns t / `unit`, with
    the upper bounds t (called levels). The first constraints are (t - value) / `unit` >= 0 for each
    value of `Problem.competing`. The others are `Problem.rooms`.
    """
    slopes = problem.competing_slopes(vector)
    many, n = len(slopes), len(vector)
    rows = np.zeros((*slopes.shape[:2], n + many))
    rows[:, :, :n] = -slopes / unit
    for level in range(many):
        rows[level, :, n + level] = 1.0
    rest = problem.room_slopes(vector)
    rest = np.concatenate((rest, np.zeros((len(rest), many))), axis=1)
    return np.concatenate((rows.reshape(-1, n + many), rest))


def least_squares(problem: Problem) -> Design:
    """The design that fits measured values best, with the covariance of its data."""
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


def _unbalanced(problem: Problem, vector: Array) -> float:
    """Norm of the part of the gradient that active bounds and conditions do not balance."""
    rows = _at_bounds(problem, vector, len(vector))
    active = problem.rooms(vector) <= problem.tol**0.5
    return _residual_norm(
        problem.gradient(vector), rows + list(problem.room_slopes(vector)[active])
    )


def _at_bounds(problem: Problem, vector: Array, count: int) -> list[Array]:
    """Inward unit vectors, with `count` entries, at the bounds on which a vector of data lies."""
    close, unit = problem.tol**0.5, np.eye(count)
    low = [unit[k] for k in np.flatnonzero(vector <= close)]
    return low + [-unit[k] for k in np.flatnonzero(vector >= 1 - close)]


def _residual_norm(gradient: Array, rows: list[Array]) -> float:
    """Distance of a gradient from the nearest sum of `rows` with multipliers >= 0.

    It is 0 where the conditions of Karush, Kuhn & Tucker hold. The multipliers are found by least
    squares.
    """
    unit = float(np.linalg.norm(gradient)) or 1.0
    if not rows:
        return float(np.linalg.norm(gradient))
    left: Callable[..., Any] = require("scipy.optimize").nnls
    return float(left(np.array(rows).T, gradient / unit)[1]) * unit


def _design(problem: Problem, vector: Array, optimality: float, message: str) -> Design:
    found = problem.contact(vector)
    design = Design(
        found.solutions[0].scene,
        problem.variables.values(vector),
        found.solutions,
        problem.value(vector),
        optimality,
        tuple(problem.history),
        message=message,
    )
    violation = problem.violation(vector)
    if violation > TOLERANCES.margin * problem.tol:
        raise NotConverged(
            "no evaluated design satisfies the conditions `subject_to`: the best one violates a "
            f"bound by {violation:.2g} of the bound's size (the search ended with: {message})",
            problem.history,
            design,
        )
    return design
