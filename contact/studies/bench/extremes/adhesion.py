"""Adhesion close to pull-off and to the jump into full contact, and weak to strong adhesion."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from math import pi

import numpy as np

from contact.model.interactions import Isolated, Periodic
from contact.model.laws import JKR, Dugdale
from contact.model.profiles import Parabola, Sinusoid
from contact.model.scene import Scene
from contact.reference.exact import DugdaleCylinder, DugdaleWave, JKRCylinder, JKRWave
from contact.studies.bench import truth
from contact.studies.bench.extremes.base import Extreme
from contact.studies.bench.truth import Exact

Curve = JKRWave | JKRCylinder | DugdaleWave | DugdaleCylinder

_WHY = "of the closed form, by a difference"


def jkr() -> Iterator[Extreme]:
    """Extreme scenes of Johnson's wave and Barquins's cylinder under JKR adhesion.

    Near a turning point the ends move as the square root of the difference between the load and the
    load of the turning point, so that the condition number is large.
    """
    group = "JKR"
    for part in (1e-2, 1e-4, 1e-6):
        for name, curve in (("wave", _wave()), ("cylinder", JKRCylinder(1.0, 1.0, 1e-6))):
            load = (1 - part) * curve.pull_off().load
            yield Extreme(
                group,
                f"{name}, {part:g} from pull-off",
                partial(_scene, curve, load),
                _condition(curve, load, part),
                _WHY,
            )
        jump = (1 - part) * _wave().jump_into_full_contact.load
        yield Extreme(
            group,
            f"wave, {part:g} from the jump into full contact",
            partial(_scene, _wave(), jump),
            _condition(_wave(), jump, part),
            _WHY,
        )
    for work in (1e-16, 1e-12, 1e-8, 1e-4):
        curve, load = _wave(work), 1e-3
        yield Extreme(
            group,
            f"wave, work {work:g} E* L",
            partial(_scene, curve, load),
            _condition(curve, load, 1.0),
            _WHY,
        )


def dugdale() -> Iterator[Extreme]:
    """Extreme scenes under Dugdale's law, with tensions of long and of short range."""
    group = "Dugdale"
    for ratio in (1e-2, 1e-1, 1.0, 10.0, 100.0):
        # The tension is `ratio` times (w E*^2/(pi R))^(1/3), with the work of adhesion w and the
        # radius R. At a ratio of 1 Maugis's parameter is of order 1.
        cylinder = DugdaleCylinder(1.0, 1.0, 1e-6, ratio * (1e-6 / pi) ** (1 / 3))
        plain = _wave()
        stress = ratio * (plain.work * plain.amplitude / pi) ** (1 / 3)
        wave = DugdaleWave(plain.amplitude, 1.0, 1.0, plain.work, stress)
        for name, curve, load in (("cylinder", cylinder, 1e-5), ("wave", wave, 1e-3)):
            yield _under_tension(group, f"{name}, tension {ratio:g}", curve, load, 1.0)
            for part in (1e-2, 1e-4, 1e-6) if ratio == 1.0 else (1e-6,):
                near = (1 - part) * curve.pull_off().load
                yield _under_tension(
                    group, f"{name}, tension {ratio:g}, {part:g} from pull-off", curve, near, part
                )


def _under_tension(
    group: str, name: str, curve: DugdaleCylinder | DugdaleWave, load: float, part: float
) -> Extreme:
    here, by_load = curve.at_load(load), _condition(curve, load, part)
    # `narrow` is the condition number of the ends of the narrow interval (a, c) of tension. The
    # ends are rounded relative to the half width a: this gives the factor a/(c - a). The other
    # factor is the condition number with respect to the work, since c depends on the rounded work /
    # stress.
    narrow = (
        here.half_width
        / (here.cohesive_end - here.half_width)
        * max(1.0, _condition(curve, load, part, "work"))
    )
    known = ""
    if narrow > 1e5:
        known = "the stated error takes rounding at both ends at its worst"
    elif narrow > 1e3:
        known = "the closed form's own ends are rounded to as much"
    why = "a/(c - a), and by the reach" if narrow > by_load else _WHY
    return Extreme(
        group, name, partial(_scene, curve, load), max(narrow, by_load), why, known=known
    )


def _wave(work: float = 1e-5, amplitude: float = 0.01) -> JKRWave:
    """The JKR equilibria of Johnson's wave with period 1 and E* = 1."""
    return JKRWave(amplitude, 1.0, 1.0, work)


def _scene(curve: Curve, load: float) -> tuple[Scene, Exact]:
    law = (
        Dugdale(curve.work, curve.stress)
        if isinstance(curve, DugdaleWave | DugdaleCylinder)
        else JKR(curve.work)
    )
    if isinstance(curve, JKRWave | DugdaleWave):
        scene = Scene(Sinusoid(curve.amplitude, 1.0), 1.0, Periodic(), law=law, load=load)
    else:
        scene = Scene(Parabola(1.0), 1.0, Isolated(), law=law, load=load)
    return scene, curve.at_load(load)


def _condition(curve: Curve, load: float, part: float, by: str = "load") -> float:
    """Condition number of ends and pressures with respect to the load or the attribute `by`.
    The load or attribute is changed by 1e-3 `part`, relative to its value. The result is the
    relative change of the ends or pressures, whichever is larger, divided by the relative change of
    the load or attribute. `part` is the relative distance of the load from a turning point.
    """
    change = 1e-3 * part
    other = curve if by == "load" else replace(curve, **{by: getattr(curve, by) * (1 + change)})
    here, there = curve.at_load(load), other.at_load(load * (1 - change) if by == "load" else load)
    zones = np.asarray(here.zones)
    ends = np.abs(there.zones - zones) / np.diff(zones, axis=1)
    pressure = np.abs(
        there.pressure_at(truth.positions()) - here.pressure_at(truth.positions())
    ).max() / truth.scale(here)
    return float(max(ends.max(), pressure)) / change
