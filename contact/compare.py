"""One scene under each interaction model, at the same control.

The models are the paper's isolated contact and its localization principle with both closures, the scene's own where it
is another, and the exact periodic contact, in that order. One that has no solution says why and does not stop the rest.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from contact.answer import Answer
from contact.errors import ContactError
from contact.interactions.base import Interaction
from contact.registry import interaction
from contact.scene import Scene
from contact.solver import solve

Report = Callable[[str, int, int | None], None]


@dataclass(frozen=True)
class Attempt:
    """What one model made of the scene: a solution, or the error that says why there is none."""

    name: str
    solution: Answer | None
    refusal: ContactError | None
    seconds: float


def compare(scene: Scene, tol: float = 1e-8, progress: Report | None = None) -> list[Attempt]:
    """Solve the scene under every model; the exact one comes last."""
    models = _models(scene.interaction)
    attempts = []
    for done, (name, model) in enumerate(models.items()):
        if progress is not None:
            progress(name, done, len(models))
        attempts.append(_attempt(name, scene, model, tol))
    return attempts


def difference(attempt: Attempt, exact: Attempt, quantity: str) -> float | None:
    """How far a positive quantity is from the exact model's, relative to it; None where there is no such number."""
    if attempt.solution is None or exact.solution is None:
        return None
    value, reference = _value(attempt.solution, quantity), _value(exact.solution, quantity)
    if value is None or reference is None or not np.isfinite([value, reference]).all() or reference == 0.0:
        return None
    return value / reference - 1.0


def total_width(solution: Answer) -> float:
    """Length in contact: of all zones, or the period at full contact."""
    if len(solution.zones) == 0 and solution.scene.period is not None:
        return solution.scene.period
    return float(np.sum(solution.zone_widths))


def _value(solution: Answer, quantity: str) -> float | None:
    if quantity == "total_width":
        return total_width(solution)
    value: float | None = getattr(solution, quantity)
    return value


def _models(own: Interaction) -> dict[str, Interaction]:
    """The models by the name they have in the table."""
    models = {
        "isolated": own if own.name == "isolated" else interaction("isolated"),
        "localized, first-order": interaction("localized", closure="first-order"),
        "localized, self-consistent": interaction("localized", closure="self-consistent"),
    }
    exact = interaction("periodic")
    if own not in (*models.values(), exact):
        models[f"{own.name}, as given"] = own
    return {**models, "exact": exact}


def _attempt(name: str, scene: Scene, model: Interaction, tol: float) -> Attempt:
    start = time.perf_counter()
    solution, refusal = None, None
    try:
        solution = solve(_under(scene, model), tol=tol)
    except ContactError as error:
        refusal = error
    return Attempt(name, solution, refusal, time.perf_counter() - start)


def _under(scene: Scene, model: Interaction) -> Scene:
    """The scene under another model; a mean pressure it does not take as control is given as the load it means."""
    if scene.mean_pressure is None or "mean_pressure" in model.allows or scene.profile.period is None:
        return replace(scene, interaction=model)
    load = scene.mean_pressure * scene.profile.period
    return replace(scene, interaction=model, mean_pressure=None, load=load)
