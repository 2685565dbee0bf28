"""Adhesion: loads next to pull-off and to the jump into full contact, works from next to nothing to what closes a wave."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from contact.model.interactions import Isolated, Periodic
from contact.model.laws import JKR
from contact.model.profiles import Parabola, Sinusoid
from contact.model.scene import Scene
from contact.reference.exact import JKRCylinder, JKRWave
from contact.studies.bench import truth
from contact.studies.bench.extremes.base import Extreme
from contact.studies.bench.truth import Exact

_WHY = "of the closed form, by a difference"
_AMPLITUDE, _WORK = 0.01, 1e-5
# Loads from which a condition is found lie so much closer than the next turning point of the load.
_NEARER = 1e-3


def jkr() -> Iterator[Extreme]:
    """Johnson's wave and Barquins's cylinder, under a load. At a turning point of the load ends move as its square root."""
    group = "JKR"
    for part in (1e-2, 1e-4, 1e-6):
        for name, curve in (("wave", _wave(_WORK)), ("cylinder", JKRCylinder(1.0, 1.0, 1e-6))):
            load = (1 - part) * curve.pull_off().load
            yield Extreme(group, f"{name}, {part:g} from pull-off", partial(_scene, curve, load), _condition(curve, load, part), _WHY)
        jump = (1 - part) * _wave(_WORK).jump_into_full_contact.load
        yield Extreme(
            group, f"wave, {part:g} from the jump into full contact", partial(_scene, _wave(_WORK), jump),
            _condition(_wave(_WORK), jump, part), _WHY,
        )
    for work in (1e-16, 1e-12, 1e-8, 1e-4):
        curve, load = _wave(work), 1e-3
        yield Extreme(group, f"wave, work {work:g} E* L", partial(_scene, curve, load), _condition(curve, load, 1.0), _WHY)


def _wave(work: float) -> JKRWave:
    return JKRWave(_AMPLITUDE, 1.0, 1.0, work)


def _scene(curve: JKRWave | JKRCylinder, load: float) -> tuple[Scene, Exact]:
    law = JKR(curve.work)
    if isinstance(curve, JKRWave):
        return Scene(Sinusoid(_AMPLITUDE, 1.0), 1.0, Periodic(), law=law, load=load), curve.at_load(load)
    return Scene(Parabola(1.0), 1.0, Isolated(), law=law, load=load), curve.at_load(load)


def _condition(curve: JKRWave | JKRCylinder, load: float, part: float) -> float:
    """By how much the stated measure changes for a relative change of the load."""
    change = _NEARER * part
    here, there = curve.at_load(load), curve.at_load(load * (1 - change))
    zones = np.asarray(here.zones)
    ends = np.abs(there.zones - zones) / np.diff(zones, axis=1)
    pressure = np.abs(there.pressure_at(truth.POSITIONS) - here.pressure_at(truth.POSITIONS)).max() / truth.scale(here)
    return float(max(ends.max(), pressure)) / change
