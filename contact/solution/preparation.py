"""Load that is borne where the heights of a trace are not the measured ones (contact.model.traces.unmeasured): how much, and where.

Every route to a solution is asked the same: its zones, their loads, and the pressure at places.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from contact.model.units import quantity
from contact.solution.answer import Answer
from sie import Array


@dataclass(frozen=True)
class ShareOptions:
    """How closely the load of an interval is integrated, and which share of it is told."""

    told_from: float = 0.01  # part of the load; what lies below is within what a preparation does to any trace
    places: int = 4096  # in contact altogether, as many in every zone: of one zone 1/4096 is a cell, and 1e-3 is well told
    intervals_told: int = 3  # in one message; the others are counted


class Borne(NamedTuple):
    """Load in the unmeasured intervals of one kind of a body: its share of all load, whether the highest pressure is there, and where."""

    place: str
    kind: Any
    share: float
    highest: bool
    where: list[Any]


def of_preparation(solution: Answer, options: ShareOptions = ShareOptions()) -> tuple[str, ...]:
    """What is said of load, or of the highest pressure, in unmeasured intervals: a sentence for each kind of them."""
    told = (borne for borne in shares(solution, options) if borne.share > options.told_from or borne.highest)
    return tuple(_sentence(borne, options) for borne in told)


def shares(solution: Answer, options: ShareOptions = ShareOptions()) -> list[Borne]:
    """What each kind of unmeasured interval bears, of every body that has some."""
    profile = solution.scene.profile
    bodies = {place: body.unmeasured for place, body in profile.bodies.items() if body.unmeasured}
    if not bodies:
        return []
    at, load, pressure = _places_in_contact(solution, options)
    if not load.sum() > 0.0:
        return []
    peak, found = int(np.argmax(pressure)), []
    for place, intervals in bodies.items():
        # Each body counts its own positions, in its own cell.
        own = np.asarray(profile.bodies[place].wrap(profile.facing(at)[place]))
        for kind in dict.fromkeys(interval.kind for interval in intervals):
            of_kind = [interval for interval in intervals if interval.kind is kind]
            inside = [(own >= left) & (own <= right) for left, right, _ in of_kind]
            borne = [float(load[here].sum() / load.sum()) for here in inside]
            where = [interval for interval, share in zip(of_kind, borne, strict=True) if share > 0.0]
            found.append(Borne(place, kind, sum(borne), any(bool(here[peak]) for here in inside), where))
    return found


def _sentence(borne: Borne, options: ShareOptions) -> str:
    what, cure = borne.kind.value
    percent = 100 * borne.share
    share = f"{percent:.{0 if percent >= 10 else 1}f} % of the load"
    of = "" if borne.place == "profile" else f" of the {borne.place}"
    places = [f"{quantity(left, 'm')} to {quantity(right, 'm')}" for left, right, _ in borne.where]
    more = f" and {len(places) - options.intervals_told} more" if len(places) > options.intervals_told else ""
    where = f"x = {', '.join(places[: options.intervals_told])}{more}"
    return f"{share}{' and the highest pressure lie' if borne.highest else ' lies'} in {what}{of} ({where}): {cure}"


def _places_in_contact(solution: Answer, options: ShareOptions) -> tuple[Array, Array, Array]:
    """Places in contact, the load about each, and the pressure there. Loads count without their signs, as adhesion has both."""
    profile, zones = solution.scene.profile, np.asarray(solution.zones)
    if not len(zones):
        if profile.period is None or not solution.load > 0.0:  # surfaces apart
            return np.zeros(0), np.zeros(0), np.zeros(0)
        at = profile.x0 + profile.period * (np.arange(options.places) + 0.5) / options.places
        pressure = np.asarray(solution.pressure(at))
        return at, np.abs(pressure), pressure
    widths = np.asarray(solution.zone_widths)
    count = -(-options.places // len(zones))
    zone = np.repeat(np.arange(len(zones)), count)
    angle = np.tile(np.pi * (np.arange(count) + 0.5) / count, len(zones))
    at = zones[zone, 0] + widths[zone] * np.sin(0.5 * angle) ** 2
    pressure = np.nan_to_num(np.asarray(solution.pressure(at)), posinf=0.0, neginf=0.0)
    # Gauss-Chebyshev weights, scaled to the load of each zone.
    weight = np.abs(pressure) * np.sin(angle)
    sums = np.bincount(zone, weight, len(zones))
    scale = np.abs(np.asarray(solution.zone_loads)) / np.where(sums > 0.0, sums, 1.0)
    return at, weight * scale[zone], pressure
