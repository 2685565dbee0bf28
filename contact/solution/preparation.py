"""Warnings about load in unmeasured intervals of a trace (contact.model.traces.unmeasured).

The warnings are computed from the zones of a solution, their loads and the pressure.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from contact.model.units import quantity
from contact.solution.solution import Solution
from sie import Array


class Borne(NamedTuple):
    """Share of the load that one body's unmeasured intervals of one kind carry.

    highest: whether one of these intervals contains the largest pressure. where: the intervals of
    this kind that carry load.
    """

    place: str
    kind: Any
    share: float
    highest: bool
    where: list[Any]


def preparation_warnings(
    solution: Solution, min_share: float = 0.01, listed: int = 3
) -> tuple[str, ...]:
    """One sentence for each kind of unmeasured interval that bears load or the largest pressure.

    min_share: smallest fraction of the load that is reported; a short taper carries less at high
    load. listed: number of intervals named in one sentence; the others are counted.
    """
    return tuple(
        _sentence(borne, listed)
        for borne in shares(solution)
        if borne.share > min_share or borne.highest
    )


def shares(solution: Solution, samples: int = 4096) -> list[Borne]:
    """Shares of the load that unmeasured intervals carry.
    There is one share for each kind of interval and each body that has such intervals.

    samples: number of samples on all zones together, equally many on each zone. 4096 samples give
    three digits of the shares.
    """
    profile = solution.scene.profile
    bodies = {place: body.unmeasured for place, body in profile.bodies.items() if body.unmeasured}
    if not bodies:
        return []
    at, load, pressure = _places_in_contact(solution, samples)
    if not load.sum() > 0.0:
        return []
    peak, found = int(np.argmax(pressure)), []
    for place, intervals in bodies.items():
        # Each body has its own period and its own coordinate x. The places are converted to the
        # coordinate of this body, within one of its periods.
        own = np.asarray(profile.bodies[place].wrap(profile.facing(at)[place]))
        for kind in dict.fromkeys(interval.kind for interval in intervals):
            of_kind = [interval for interval in intervals if interval.kind is kind]
            inside = [(own >= left) & (own <= right) for left, right, _ in of_kind]
            borne = [float(load[here].sum() / load.sum()) for here in inside]
            where = [
                interval for interval, share in zip(of_kind, borne, strict=True) if share > 0.0
            ]
            found.append(
                Borne(place, kind, sum(borne), any(bool(here[peak]) for here in inside), where)
            )
    return found


def _sentence(borne: Borne, listed: int) -> str:
    what, cure = borne.kind.value
    percent = 100 * borne.share
    share = f"{percent:.{0 if percent >= 10 else 1}f} % of the load"
    of = "" if borne.place == "profile" else f" of the {borne.place}"
    places = [f"{quantity(left, 'm')} to {quantity(right, 'm')}" for left, right, _ in borne.where]
    more = f" and {len(places) - listed} more" if len(places) > listed else ""
    where = f"x = {', '.join(places[:listed])}{more}"
    lies = " and the largest pressure lie" if borne.highest else " lies"
    return f"{share}{lies} in {what}{of} ({where}): {cure}"


def _places_in_contact(solution: Solution, samples: int) -> tuple[Array, Array, Array]:
    """Sample places in contact, a weight for each place, and the pressure there.
    The weight is proportional to the absolute load that the sample stands for.
    """
    profile, zones = solution.scene.profile, np.asarray(solution.zones)
    if not len(zones):
        if profile.period is None or not solution.load > 0.0:  # the surfaces are apart
            return np.zeros(0), np.zeros(0), np.zeros(0)
        at = profile.x0 + profile.period * (np.arange(samples) + 0.5) / samples
        pressure = np.asarray(solution.pressure(at))
        return at, np.abs(pressure), pressure
    widths = np.asarray(solution.zone_widths)
    count = -(-samples // len(zones))
    zone = np.repeat(np.arange(len(zones)), count)
    angle = np.tile(np.pi * (np.arange(count) + 0.5) / count, len(zones))
    at = zones[zone, 0] + widths[zone] * np.sin(0.5 * angle) ** 2
    pressure = np.nan_to_num(np.asarray(solution.pressure(at)), posinf=0.0, neginf=0.0)
    # The weights are those of Gauss-Chebyshev quadrature.
    return at, np.abs(pressure) * widths[zone] * np.sin(angle), pressure
