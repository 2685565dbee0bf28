"""`optimize`: the best data of a scene within bounds, by searches of scipy with derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from contact.derivatives.response import NUMBERS, TABLES
from contact.design.objective import Measured, Objective, StressObjective, objective_of
from contact.design.problem import Problem
from contact.design.result import Condition, Design
from contact.design.search import least_squares, minimum
from contact.design.variables import Variables
from contact.errors import SceneError
from contact.model.checks import one_of
from contact.model.scene import Scene
from contact.solver import tolerance


def optimize(
    scene: Scene,
    objective: str | Objective | Measured | StressObjective,
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
    objective : str, Objective, Measured or StressObjective
        The quantity to be minimized: the name of a number of the contact, with a minus sign to
        maximize it (its mean over the values of the control); any function of a number; the
        distance from measured values; the largest stress; or the load of first yield.
    over : mapping
        Names of data, as in scene files, with their bounds (lowest, highest): numbers, or arrays
        for an array such as "profile.cosine".
    subject_to : sequence of (str, float or None, float or None)
        Numbers of the contact with their lowest and highest value, at every value of the control.
    at : sequence of float or None
        Values of the scene's control; None: the value that the scene has.
    tol : float
        Tolerance of the contacts.

    Returns
    -------
    Design
        `scene`, `solutions`, `data`, `objective`, `optimality`, `history`, `covariance`.

    Raises
    ------
    SceneError
        If an argument is not valid, or a derivative is not known.
    NotConverged, OutOfRange
        If a design cannot be solved during the search: narrow the bounds. If no evaluated design
        satisfies `subject_to`: the nearest one is the attribute `best` of the error.

    Examples
    --------
    A wave with the smallest contact under a load, and a pressure of at most three times the mean.
    On a wave the largest pressure is 2 sqrt(mean pressure pi E* amplitude / period).

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
        raise SceneError.of(
            "values", wanted.values, f"{len(values)} numbers, one for each value of the control"
        )
    problem = Problem(variables, wanted, _conditions(subject_to), values, tolerance(tol))
    if not isinstance(wanted, Measured):
        return minimum(problem)
    if problem.conditions:
        raise SceneError.of(
            "subject_to", subject_to, "left out if the objective is a contact.Measured"
        )
    return least_squares(problem)


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
            raise SceneError.of(
                "subject_to", one, "(number, lowest, highest), the lowest value below the highest"
            )
        out.append(Condition(number, float(lo), float(hi)))
    return tuple(out)
