"""Random scenes under a limit of the pressure or in full sliding, and the outcome of each.

    python -m contact.studies.random_laws FIRST COUNT [--tol 1e-8] [--limit 60] [--out FILE.csv]

Profiles, controls and kinds of outcomes are those of `random_scenes`; bodies are isolated or
periodic half-planes. Each solution is compared with the solution of the mirror image, in which body
2 slides in the other direction. Under a limit H of the pressure, a periodic contact is also
compared with the contact of the profile -f. The pressures of the two contacts add up to H. A
difference above the sum of both stated errors is a fault.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

import contact
from contact.studies import random_scenes
from contact.studies.random_scenes import Drawn, unsound
from contact.studies.reflected import Reflected
from sie import nearest_image

Array = NDArray[np.float64]
Index = NDArray[np.intp]
WithLaw = Callable[[np.random.Generator, contact.Scene], contact.Scene]

# Normalised positions in an elastic interval at which pressures are compared; its ends are -1, 1.
PLACES = np.cos(np.linspace(0.1, np.pi - 0.1, 60))


def plastic(rng: np.random.Generator, scene: contact.Scene) -> contact.Scene:
    """The scene with a random hardness, 0.003 to 3 times E* times the rms slope of the profile.
    A load that is too large for this hardness is replaced by a smaller one.
    """
    lo, hi = scene.profile.support or scene.profile.known or (-1.0, 1.0)
    with np.errstate(all="ignore"):
        slopes = np.asarray(scene.profile.slope(lo + (hi - lo) * (np.arange(2048) + 0.37) / 2048))
    size = float(np.sqrt(np.mean(slopes[np.isfinite(slopes)] ** 2))) or 1e-2
    hardness = scene.E_star * size * 10 ** rng.uniform(-2.5, 0.5)
    width = scene.period if scene.profile.support is None else hi - lo
    load = scene.given_load
    if load is not None and width is not None and load >= hardness * width:
        part = rng.choice(
            [rng.uniform(0.01, 1), 10 ** rng.uniform(-6, 0), 1 - 10 ** rng.uniform(-5, -1)]
        )
        scene = scene.under("load", float(part) * hardness * width)
    return replace(scene, law=contact.Plastic(float(hardness)))


def sliding(rng: np.random.Generator, scene: contact.Scene) -> contact.Scene:
    """The scene in full sliding, with random friction up to 10 and a random Dundurs' constant."""
    friction = float(rng.choice([rng.uniform(0, 2), 10 ** rng.uniform(-6, 1)]))
    beta, direction = float(rng.uniform(-0.5, 0.5)), int(rng.choice([-1, 1]))
    return replace(scene, law=contact.Sliding(friction, beta, direction))


LAWS: dict[str, WithLaw] = {made.__name__: made for made in (plastic, sliding)}


@dataclass(frozen=True)
class DrawnLaw(Drawn):
    """A random scene with one of `LAWS`."""

    @property
    def model(self) -> str:
        return f"{super().model}, {self.scene.law.name}"

    def fault(self, solution: contact.Solution, tol: float) -> str:
        found = unsound(self.scene, solution, tol)
        return found or against_images(solution, tol)


def draw(seed: int) -> DrawnLaw | contact.ContactError:
    """Return the random scene of a seed, or the error if its random parts are incompatible."""
    drawn = random_scenes.draw(seed)
    if isinstance(drawn, contact.ContactError):
        return drawn
    rng, scene = np.random.default_rng([seed, 3]), drawn.scene
    with_law = LAWS[str(rng.choice(list(LAWS)))]
    try:
        if not isinstance(scene.interaction, contact.Periodic | contact.Isolated):
            lone = scene.period is None
            scene = replace(scene, interaction=contact.Isolated() if lone else contact.Periodic())
        return DrawnLaw(drawn.seed, drawn.family, with_law(rng, scene))
    except contact.ContactError as error:
        return error


def against_images(solution: contact.Solution, tol: float) -> str:
    """Return a message if a solution contradicts the one of its mirror image or of -f; else ''."""
    scene, law = solution.scene.under("load", solution.load), solution.scene.law
    if isinstance(law, contact.Sliding):
        law = replace(law, direction=-law.direction)
    image = replace(scene, profile=Reflected(scene.profile), law=law)
    ratio, of = difference(solution, contact.solve(image, tol), -1.0), "mirror image"
    if len(solution.plateaus) and scene.profile.support is None and scene.period is not None:
        if scene.interaction.needs_period and not len(scene.profile.algebraic_points):
            most = law.pressure_range.highest
            image = replace(scene, profile=Reflected(scene.profile, True))
            image = image.under("load", most * scene.period - solution.load)
            other = difference(solution, contact.solve(image, tol), 1.0, most)
            ratio, of = max((ratio, of), (other, "contact of -f"))
    return f"differs from its {of} by {ratio:.3g} times the stated errors" if ratio > 1 else ""


def difference(
    one: contact.Solution, other: contact.Solution, turn: float, most: float | None = None
) -> float:
    """The largest difference of two solutions, divided by the sum of their stated errors.

    It is infinite if the numbers of elastic intervals differ. turn: 1, or -1 if the second solution
    is mirrored; most: the constant sum of both pressures, or None if the pressures are equal.
    Pressures are compared on intervals whose width is known to ten digits.
    """
    period = one.scene.period if one.scene.interaction.needs_period else None
    (first, lengths), (second, _) = elastic_intervals(one), elastic_intervals(other)
    second = np.sort(turn * second, axis=1)
    if len(first) != len(second):
        return np.inf
    if len(first) == 0:
        return 0.0
    away = nearest_image(first.mean(axis=1)[:, None] - second.mean(axis=1), 0.0, period)
    partner = np.abs(away).argmin(axis=1)
    ends = np.abs(nearest_image(first - second[partner], 0.0, period)) / lengths[:, None]
    # Round-off of the ends of each interval, divided by the width of the interval.
    rounding = np.spacing(np.abs(first).max(axis=1)) / np.maximum(np.diff(first)[:, 0], 1e-300)
    wide = np.flatnonzero(rounding < 1e-10)
    p, q = pressures(one, wide, PLACES), pressures(other, partner[wide], turn * PLACES)
    apart = np.abs(p - (q if most is None else most - q)).max(initial=0.0)
    size = one.max_pressure if np.isfinite(one.max_pressure) else one.load / one.zone_widths.sum()
    allowed = one.error + other.error + 16 * float(rounding[wide].max(initial=0.0))
    return float(max(ends.max(), apart / size)) / allowed


def pressures(solution: contact.Solution, which: Index, t: Array) -> Array:
    """Pressures at normalised positions t (m,) in some of the elastic intervals: (n, m)."""
    if len(solution.zones) and not len(solution.plateaus):
        rows = [solution.pressure_at(t, int(k)) for k in which]
        return np.array(rows).reshape(len(which), len(t))
    table = elastic_intervals(solution)[0][which]
    return solution.pressure(table.mean(axis=1, keepdims=True) + 0.5 * np.diff(table, axis=1) * t)


def elastic_intervals(solution: contact.Solution) -> tuple[Array, Array]:
    """Intervals [m] of elastic contact (n, 2), and lengths (n,) that scale errors of their ends.

    The length is the width of the interval. For a rim, an interval between a plateau and a gap, it
    is at least the width of the plateau or gap, whichever is narrower.
    """
    period = solution.scene.period if solution.scene.interaction.needs_period else None
    zones, plateaus = solution.zones, solution.plateaus
    if len(zones) == 0 and len(plateaus):
        after = np.roll(plateaus[:, 0], -1)
        after[-1] += period or 0.0
        table = np.column_stack((plateaus[:, 1], after))
        return table, table[:, 1] - table[:, 0]
    rows, lengths = [], []
    before, after = np.roll(zones[:, 1], 1), np.roll(zones[:, 0], -1)
    if len(zones):
        before[0] -= period or np.inf
        after[-1] += period or np.inf
    for (a, b), left, right in zip(zones.tolist(), before, after, strict=True):
        middles = nearest_image(plateaus.mean(axis=1), 0.5 * (a + b), period)
        own = plateaus + (middles - plateaus.mean(axis=1))[:, None]
        own = own[(middles > a) & (middles < b)]
        edges = np.array([left, a, *np.sort(own.ravel()), b, right])
        widths = np.diff(edges)
        support = solution.scene.profile.support or (np.nan, np.nan)
        apart = np.abs(nearest_image(edges[:, None] - np.array(support), 0.0, period))
        cornered = (apart <= 8 * np.spacing(np.abs(edges[1:-1]).max())).any(axis=1)
        for i in range(1, len(widths), 2):
            rim = (i == 1) != (i == len(widths) - 2)
            if not (cornered[i] and cornered[i + 1]):
                rows.append(edges[i : i + 2])
                beside = min(widths[i - 1], widths[i + 1]) if rim else 0.0
                lengths.append(max(widths[i], beside))
    return np.array(rows).reshape(-1, 2), np.array(lengths)


if __name__ == "__main__":
    sys.exit(random_scenes.main(draw=draw, description=__doc__))
