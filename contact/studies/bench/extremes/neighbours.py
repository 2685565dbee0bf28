"""Narrow gaps between zones, and zones and heights of very different scale."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from contact.model.interactions import Isolated, Periodic
from contact.model.profiles import Fourier
from contact.model.scene import Scene
from contact.reference.inverse import DesignedContact, design
from contact.studies.bench.extremes.base import Extreme
from contact.studies.bench.harmonics import HarmonicZone
from contact.studies.bench.truth import Exact


def designed(
    zones: list[list[float]], period: float | None, load: float = 0.05
) -> tuple[Scene, DesignedContact]:
    """(scene, exact contact) with given zones; the profile is computed from the zones."""
    exact = design(zones, 1.0, load, period)
    return Scene(exact.profile, 1.0, Isolated() if period is None else Periodic(), load=load), exact


def gaps() -> Iterator[Extreme]:
    """Extreme scenes with narrow gaps between zones.

    A gap of width g between zones of width w lowers the pressure by about (g/w)^2 of the peak. An
    error eps of the slopes changes the pressure by eps, so that (g/w)^2 changes by eps. An end then
    moves by eps w/g of the width. Below g/w = sqrt(eps), one zone and two zones are the same
    answer.
    """
    group, why = "gap between zones", "w/g"
    for gap in (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7):
        for period in (None, 4.0):
            yield Extreme(
                group,
                f"{gap:g} of the width, {'isolated' if period is None else 'periodic'}",
                partial(designed, [[-1 - gap / 2, -gap / 2], [gap / 2, 1 + gap / 2]], period),
                1 / gap,
                why,
                hair=gap,
            )
    # A zone of width r lies between two gaps of width g. If the gaps were closed, the pressure in
    # the zone would have a slope of about g r^2 at the distance g from an end. So an error eps of
    # the pressure moves the end by eps/(g r^2). Relative to the width r, this is eps/(g r^3).
    for gap in (1e-3, 1e-5):
        yield Extreme(
            group,
            f"{gap:g}, three zones 1 : 0.05 : 0.3, periodic",
            partial(designed, [[-1, 0], [gap, gap + 0.05], [0.05 + 2 * gap, 0.35 + 2 * gap]], 4.0),
            1 / (gap * 0.05**3),
            "1/(g r^3), r the narrow zone's width",
            hair=gap,
        )


def scales() -> Iterator[Extreme]:
    """Extreme scenes with zones and heights of very different scale.

    A zone of width r next to one of width 1 is a cap of height about r^2. An error eps of the
    slopes over a distance of order 1 changes the level of the cap by eps. So the relative change of
    its width is eps/r^2. The pressure of the narrow zone is about sqrt(r) of the peak. If the
    allowed error is larger than sqrt(r), a contact without the narrow zone is the same answer.
    """
    group = "zones of very different width"
    for ratio in (1e-2, 1e-4, 1e-6):
        for period in (None, 4.0):
            yield Extreme(
                group,
                f"1 : {ratio:g}, {'isolated' if period is None else 'periodic'}",
                partial(designed, [[-1.0, 0.0], [0.5, 0.5 + ratio]], period),
                1 / ratio**2,
                "ratio^-2",
                heavy=ratio < 1e-5,
                hair=float(np.sqrt(ratio)),
            )
    for order, ratio in ((40, 1e-3), (40, 1e-6), (1000, 1e-6)):
        yield Extreme(
            "heights of very different scale",
            f"a wave and one {order} times shorter, 1 : {ratio:g}",
            partial(_waves, order, ratio),
            4.0 + order * order * ratio,
            "tan(A)/2A, and the curvatures' ratio",
        )


def _waves(order: int, ratio: float) -> tuple[Scene, Exact]:
    amplitudes = np.zeros(order)
    amplitudes[0], amplitudes[-1] = 1e-2, 1e-2 * ratio
    exact = HarmonicZone(tuple(amplitudes), 1.0, 0.4)
    return Scene(Fourier(1.0, -amplitudes), 1.0, Periodic(), mean_pressure=exact.load), exact
