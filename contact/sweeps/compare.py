"""One scene solved under each interaction model, at the same value of its control.

The models, in order: isolated contact; the localization principle with its first-order and its
self-consistent closure; the localization principle with m neighbours on each side that are solved
exactly; the scene's own model, if it is none of these; and the exact periodic contact. If a model
has no solution, the reason is reported and the other models are still solved.
"""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from operator import attrgetter

import numpy as np

from contact.errors import ContactError, SceneError, unwarned, warn
from contact.formulation.quadrature import chebyshev_nodes
from contact.model.interactions.base import Interaction
from contact.model.profiles.noise import ROUND_OFF
from contact.model.registry import interaction, profile
from contact.model.scene import Scene
from contact.model.units import headed
from contact.solution.model_warnings import scene_and_solution_warnings
from contact.solution.report import heading, total_width
from contact.solution.solution import Solution
from contact.solver import solve

Report = Callable[[str, int, int | None], None]
Column = tuple[str, list[str]]

NEIGHBOURS = (1, 2, 4, 8)

# The quantities for which the table shows the deviation from the exact model.
_NUMBERS = ("load", "max_pressure", "total_width")


@dataclass(frozen=True)
class TableLimits:
    """Limit on the number of columns of a table, for a terminal 80 characters wide."""

    # Largest number of zones whose ends are printed. It is also the largest number of columns of
    # ends in one table.
    zone_ends: int = 4


_LIMITS = TableLimits()


@dataclass(frozen=True)
class Attempt:
    """The result of one model: a solution, or the error that says why there is none."""

    name: str
    solution: Solution | None
    refusal: ContactError | None
    seconds: float


def compare(scene: Scene, tol: float = 1e-8, progress: Report | None = None) -> list[Attempt]:
    """The results of all models for one scene; the exact periodic model comes last."""
    if not isinstance(scene, Scene):
        raise SceneError.of("scene", scene, "a contact.Scene")
    models = _models(scene.interaction)
    attempts = []
    with unwarned():
        _warm_up(scene, models, tol)
    for done, (name, model) in enumerate(models.items()):
        if progress is not None:
            progress(name, done, len(models))
        with unwarned():
            attempts.append(_attempt(name, scene, model, tol))
    solved = [attempt.solution for attempt in attempts if attempt.solution is not None]
    if solved:
        warn(scene_and_solution_warnings(solved[-1]))
    return attempts


def difference(attempt: Attempt, exact: Attempt, quantity: str) -> float | None:
    """Deviation of a quantity relative to its value in the exact model; None if undefined."""
    if attempt.solution is None or exact.solution is None:
        return None
    measure = total_width if quantity == "total_width" else attrgetter(quantity)
    value, reference = measure(attempt.solution), measure(exact.solution)
    if (
        value is None
        or reference is None
        or not np.isfinite([value, reference]).all()
        or reference == 0.0
    ):
        return None
    return float(value / reference - 1.0)


def ends_apart(attempt: Attempt, exact: Attempt) -> float | None:
    """Largest distance of a zone end from its place in `exact`, relative to the zone's width.

    The zone width is that of `exact`. None if the numbers of zones differ.
    """
    if attempt.solution is None or exact.solution is None:
        return None
    ours, zones = attempt.solution.zones, exact.solution.zones
    if len(ours) != len(zones) or len(zones) == 0:
        return None
    return float(np.max(np.abs(ours - zones) / exact.solution.zone_widths[:, None]))


def pressure_apart(attempt: Attempt, exact: Attempt, samples: int = 41) -> float | None:
    """Largest difference of a model's pressure from the exact one, relative to the exact peak.
    The pressures are compared at equal normalised positions in the zones.

    If the peak is infinite, the difference is relative to the mean pressure on the zones. None if
    the numbers of zones differ. samples: number of Chebyshev points of a zone.
    """
    if ends_apart(attempt, exact) is None:
        return None
    assert attempt.solution is not None and exact.solution is not None
    reference = exact.solution
    scale = reference.max_pressure
    if not np.isfinite(scale):
        scale = reference.load / total_width(reference)
    ours, theirs = (
        s.pressure(
            s.zones.mean(axis=1)[:, None] + 0.5 * np.diff(s.zones) * chebyshev_nodes(samples)
        )
        for s in (attempt.solution, reference)
    )
    return float(np.max(np.abs(ours - theirs)) / scale)


def tables(attempts: list[Attempt]) -> Iterator[tuple[str, list[Column]]]:
    """Tables (title, columns): results, their deviations from the exact model, ends of zones.

    Each table has one line per model, of at most 80 characters.
    """
    exact, models = attempts[-1], ("model", [a.name for a in attempts])

    def column(name: str, unit: str, measure: Callable[[Solution], float | None]) -> Column:
        return headed(
            name, [None if a.solution is None else measure(a.solution) for a in attempts], unit
        )

    zones = [None if a.solution is None else len(a.solution.zones) for a in attempts]
    yield (
        "models",
        [
            models,
            column("load", "N/m", attrgetter("load")),
            column(heading("mean_pressure"), "Pa", attrgetter("mean_pressure")),
            column(heading("max_pressure"), "Pa", attrgetter("max_pressure")),
            column(heading("contact_fraction"), "", attrgetter("contact_fraction")),
            column(heading("total_width"), "m", total_width),
            ("zones", ["-" if count is None else str(count or "full") for count in zones]),
        ],
    )
    yield (
        "difference from the exact model in %, and computing time",
        [
            models,
            *(
                (heading(name), [_percent(difference(a, exact, name), "+.3g") for a in attempts])
                for name in _NUMBERS
            ),
            ("zone\nends", [_percent(ends_apart(a, exact)) for a in attempts]),
            ("pressure", [_percent(pressure_apart(a, exact)) for a in attempts]),
            ("time\n[ms]", [f"{1e3 * a.seconds:.1f}" for a in attempts]),
        ],
    )
    ends = [
        column(f"zone {zone + 1}\n{side}", "m", _end(zone, place))
        for zone in range(min(max(count or 0 for count in zones), _LIMITS.zone_ends))
        for place, side in enumerate(("left", "right"))
    ]
    for first in range(0, len(ends), _LIMITS.zone_ends):
        yield "zone ends", [models, *ends[first : first + _LIMITS.zone_ends]]


def refusals(attempts: list[Attempt]) -> list[str]:
    """One line for each reason why a solution is missing, with the names of the models."""
    reasons: dict[str, list[str]] = {}
    for attempt in attempts:
        if attempt.refusal is not None:
            reasons.setdefault(" ".join(str(attempt.refusal).split()), []).append(attempt.name)
    return [f"{', '.join(names)}: no solution: {reason}" for reason, names in reasons.items()]


def _end(zone: int, place: int) -> Callable[[Solution], float | None]:
    return lambda s: float(s.zones[zone, place]) if zone < len(s.zones) else None


def _percent(value: float | None, form: str = ".3g") -> str:
    if value is None:
        return "-"
    return "0" if abs(value) < ROUND_OFF else f"{100.0 * value:{form}}"


def _models(own: Interaction) -> dict[str, Interaction]:
    """The interaction models to compare, by the names that the tables show."""
    models = {
        "isolated": own if own.name == "isolated" else interaction("isolated"),
        "first-order": interaction("localized", closure="first-order"),
        "self-consistent": interaction("localized", closure="self-consistent"),
    }
    for m in NEIGHBOURS:
        models[f"m = {m}"] = interaction("localized", closure="self-consistent", neighbours=m)
    exact = interaction("periodic")
    if own not in (*models.values(), exact):
        models[f"{own.name}, as given"] = own
    return {**models, "exact": exact}


def _warm_up(scene: Scene, models: dict[str, Interaction], tol: float) -> None:
    """Solve a sinusoidal profile with each model, and the scene with the first model, untimed.

    Without this, the times of the first attempts would include imports and the preparation of the
    profile.
    """
    wave = profile("sinusoid", amplitude=0.01, period=1.0)
    small = Scene(wave, 1.0, interaction("periodic"), mean_pressure=1e-3)
    for name, model in models.items():
        _attempt(name, small, model, tol)
    first = next(iter(models))
    _attempt(first, scene, models[first], tol)


def _attempt(name: str, scene: Scene, model: Interaction, tol: float) -> Attempt:
    start = time.perf_counter()
    solution, refusal = None, None
    try:
        solution = solve(_under(scene, model), tol=tol)
    except ContactError as error:
        refusal = error
    return Attempt(name, solution, refusal, time.perf_counter() - start)


def _under(scene: Scene, model: Interaction) -> Scene:
    """The same scene with another interaction model.

    A model that does not accept a mean pressure gets the load per period (mean pressure times
    period).
    """
    if (
        scene.mean_pressure is None
        or "mean_pressure" in model.allows
        or scene.profile.period is None
    ):
        return replace(scene, interaction=model)
    load = scene.mean_pressure * scene.profile.period
    return replace(scene, interaction=model, mean_pressure=None, load=load)
