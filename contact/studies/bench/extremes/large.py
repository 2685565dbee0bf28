"""Many equal zones, and measured profiles of many samples with noise."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from math import pi

import numpy as np

from contact.model.interactions import Isolated, Periodic
from contact.model.profiles import Fourier, Sampled
from contact.model.scene import Scene
from contact.reference.exact import Westergaard
from contact.studies.bench.extremes.base import Extreme
from contact.studies.bench.formulations import solved_by_gaps
from contact.studies.bench.one_zone import ByPieces
from contact.studies.bench.power import Repeated
from contact.studies.bench.truth import Exact


def equal_zones() -> Iterator[Extreme]:
    """Extreme scenes of many equal waves in a period; 2 % of the period is in contact.

    A shift of the waves removes the mirror symmetry.
    """
    why = "positions are rounded to eps L, zones are L/50n wide"
    for count, shift in ((101, 0.0), (1001, 0.0), (1000, 0.3)):
        yield Extreme(
            "many equal zones",
            f"{count}, shifted" if shift else f"{count}",
            partial(_equal, count, shift),
            50.0 * count,
            why,
            heavy=count > 500,
        )


def _equal(zones: int, shift: float) -> tuple[Scene, Exact]:
    amplitude = 1e-3 / zones
    one = Westergaard.from_contact_fraction(0.02, amplitude=amplitude, period=1 / zones, E_star=1.0)
    zeros = [0.0] * (zones - 1)
    angle = 2 * pi * shift
    profile = Fourier(
        1.0,
        [*zeros, -amplitude * np.cos(angle)],
        [*zeros, -amplitude * np.sin(angle)] if shift else [],
    )
    scene = Scene(profile, 1.0, Periodic(), mean_pressure=one.mean_pressure)
    return scene, Repeated(one, zones, shift)


def noisy() -> Iterator[Extreme]:
    """Extreme scenes of a parabola and of a rough profile, given by samples with noise."""
    group = "measured with noise"
    for samples, noise in ((2_001, 1e-8), (10_001, 1e-9), (100_001, 1e-9)):
        yield Extreme(
            group,
            f"{samples - 1:.0e} samples of a parabola, noise {noise:g} of its radius",
            partial(_parabola, samples, noise),
            0.5 * samples,
            "heights known to eps: slopes to eps of height/pitch",
            heavy=samples > 5_000,
        )
    for samples, noise in ((10_000, 1e-9), (100_000, 1e-9), (100_000, 1e-8)):
        yield Extreme(
            group,
            f"{samples:.0e} samples of a rough profile, noise {noise:g} of its period",
            partial(_rough, samples, noise),
            1e3 * 0.1 * samples,
            "height/pitch/slope, and (widest over narrowest zone)^2",
            heavy=True,
        )


def _parabola(samples: int, noise: float) -> tuple[Scene, Exact]:
    """A sampled parabola f = x^2/2 with symmetric white noise, in contact for |x| < 0.4."""
    rng = np.random.default_rng(5)
    x = np.linspace(-1.0, 1.0, samples)
    x = 0.5 * (x - x[::-1])
    half = noise * rng.normal(size=samples // 2)
    height = np.concatenate((half, [0.0], half[::-1])) - 0.5 * x * x
    profile = Sampled(x, height)
    exact = ByPieces(profile, x, 1.0, 0.4)
    return Scene(profile, 1.0, Isolated(), load=exact.load), exact


def _rough(samples: int, noise: float) -> tuple[Scene, Exact]:
    """A rough profile of 64 harmonics with white noise, at a mean pressure of 1e-3 E*."""
    rng = np.random.default_rng(5)
    k = np.arange(1, 65)
    x = np.arange(samples) / samples
    smooth = np.cos(2 * pi * np.outer(x, k) + rng.uniform(0, 2 * pi, 64)) @ (
        1e-3 * np.maximum(k, 4) ** -1.3
    )
    profile = Sampled(x, smooth + noise * rng.normal(size=samples), period=1.0)
    scene = Scene(profile, 1.0, Periodic(), mean_pressure=1e-3)
    return scene, solved_by_gaps(scene)
