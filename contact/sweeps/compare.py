"""One scene under each interaction model, at the same control.

The models are the paper's isolated contact and its localization principle with both closures, the
same principle with m neighbours on each side kept explicitly, the scene's own where it is another,
and the exact periodic contact, in that order. One that has no solution says why and does not stop
the rest.
"""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from operator import attrgetter

import numpy as np

from contact.errors import ContactError, SceneError, unwarned, warn
from contact.model.interactions.base import Interaction
from contact.model.registry import interaction
from contact.model.scene import Scene
from contact.model.units import headed
from contact.solution.model_warnings import scene_and_solution_warnings
from contact.solution.solution import Solution
from contact.solver import solve
from contact.sweeps.points import total_width

Report = Callable[[str, int, int | None], None]
Column = tuple[str, list[str]]

NEIGHBOURS = (1, 2, 4, 8)

# A table of more zones than this is for a file.
_ZONES_SHOWN = 4
# So many zones' ends stand side by side on 80 columns.
_ZONES_ABREAST = 2

# Of which it is told how far they are from the exact ones.
_NUMBERS = ("load", "max_pressure", "total_width")
# A relative difference of rounding.
_NOTHING = 1e-13

# Normalised positions in a zone at which pressures are compared: inside, closer at the ends.
_T = np.cos((np.arange(41) + 0.5) * np.pi / 41)


@dataclass(frozen=True)
class Attempt:
    """What one model made of the scene: a solution, or the error that says why there is none."""

    name: str
    solution: Solution | None
    refusal: ContactError | None
    seconds: float


def compare(scene: Scene, tol: float = 1e-8, progress: Report | None = None) -> list[Attempt]:
    """Solve the scene under every model; the exact one comes last."""
    if not isinstance(scene, Scene):
        raise SceneError.of("scene", scene, "a contact.Scene")
    models = _models(scene.interaction)
    attempts = []
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
    """How far a positive quantity is from the exact model's, relative to it; None where there is no
    such number.
    """
    if attempt.solution is None or exact.solution is None:
        return None
    tell = total_width if quantity == "total_width" else attrgetter(quantity)
    value, reference = tell(attempt.solution), tell(exact.solution)
    if (
        value is None
        or reference is None
        or not np.isfinite([value, reference]).all()
        or reference == 0.0
    ):
        return None
    return float(value / reference - 1.0)


def ends_apart(attempt: Attempt, exact: Attempt) -> float | None:
    """The largest distance of a zone's end from the exact model's, over that zone's width; None if
    the zones are others.
    """
    if attempt.solution is None or exact.solution is None:
        return None
    ours, zones = attempt.solution.zones, exact.solution.zones
    if len(ours) != len(zones) or len(zones) == 0:
        return None
    return float(np.max(np.abs(ours - zones) / exact.solution.zone_widths[:, None]))


def pressure_apart(attempt: Attempt, exact: Attempt) -> float | None:
    """The largest difference of pressure at equal normalised positions in corresponding zones, over
    the exact peak (over the mean on the zones where the peak is infinite).
    """
    if ends_apart(attempt, exact) is None:
        return None
    assert attempt.solution is not None and exact.solution is not None
    reference = exact.solution
    scale = reference.max_pressure
    if not np.isfinite(scale):
        scale = reference.load / total_width(reference)
    ours, theirs = (
        s.pressure(s.zones.mean(axis=1)[:, None] + 0.5 * np.diff(s.zones) * _T)
        for s in (attempt.solution, reference)
    )
    return float(np.max(np.abs(ours - theirs)) / scale)


def tables(attempts: list[Attempt]) -> Iterator[tuple[str, list[Column]]]:
    """(title, columns) of what the models give, how far that is from the exact one, and the ends of
    the first zones; a line for each model, none wider than 80 columns.
    """
    exact, models = attempts[-1], ("model", [a.name for a in attempts])

    def column(name: str, unit: str, tell: Callable[[Solution], float | None]) -> Column:
        return headed(
            name, [None if a.solution is None else tell(a.solution) for a in attempts], unit
        )

    zones = [None if a.solution is None else len(a.solution.zones) for a in attempts]
    yield (
        "models",
        [
            models,
            column("load", "N/m", attrgetter("load")),
            column("mean\npressure", "Pa", attrgetter("mean_pressure")),
            column("max\npressure", "Pa", attrgetter("max_pressure")),
            column("contact\nfraction", "", attrgetter("contact_fraction")),
            column("total\nwidth", "m", total_width),
            ("zones", ["-" if count is None else str(count or "full") for count in zones]),
        ],
    )
    yield (
        "from the exact one, in %, and time",
        [
            models,
            *(
                (
                    name.replace("_", "\n"),
                    [_percent(difference(a, exact, name), "+.3g") for a in attempts],
                )
                for name in _NUMBERS
            ),
            ("zone\nends", [_percent(ends_apart(a, exact)) for a in attempts]),
            ("pressure", [_percent(pressure_apart(a, exact)) for a in attempts]),
            ("time\n[ms]", [f"{1e3 * a.seconds:.1f}" for a in attempts]),
        ],
    )
    ends = [
        column(f"zone {zone + 1}\n{side}", "m", _end(zone, place))
        for zone in range(min(max(count or 0 for count in zones), _ZONES_SHOWN)) for place, side in enumerate(("left", "right"))
    ]  # fmt: skip
    for first in range(0, len(ends), 2 * _ZONES_ABREAST):
        yield "zone ends", [models, *ends[first : first + 2 * _ZONES_ABREAST]]


def refusals(attempts: list[Attempt]) -> list[str]:
    """A line for each reason why models have no solution, with the names of those it holds for."""
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
    return "0" if abs(value) < _NOTHING else f"{100.0 * value:{form}}"


def _models(own: Interaction) -> dict[str, Interaction]:
    """The models by the name they have in the table."""
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


def _attempt(name: str, scene: Scene, model: Interaction, tol: float) -> Attempt:
    start = time.perf_counter()
    solution, refusal = None, None
    try:
        solution = solve(_under(scene, model), tol=tol)
    except ContactError as error:
        refusal = error
    return Attempt(name, solution, refusal, time.perf_counter() - start)


def _under(scene: Scene, model: Interaction) -> Scene:
    """The scene under another model; a mean pressure it does not take as control is given as the
    load it means.
    """
    if (
        scene.mean_pressure is None
        or "mean_pressure" in model.allows
        or scene.profile.period is None
    ):
        return replace(scene, interaction=model)
    load = scene.mean_pressure * scene.profile.period
    return replace(scene, interaction=model, mean_pressure=None, load=load)
