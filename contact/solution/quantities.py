"""Quantities of a solution: energies, the pull-off point and the peaks of zones."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contact.formulation.roots import maximum
from contact.model.scene import Scene
from contact.model.units import quantity
from contact.verify.minima import SAMPLING
from sie import Array, record


@record
class PullOff:
    """The last equilibrium before the surfaces separate completely as the control falls.

    load: [N/m], per period where there is one. approach: [m], or None if it is undefined. zones:
    [m].
    """

    load: float
    approach: float | None
    zones: Array

    def __repr__(self) -> str:
        load, approach = quantity(self.load, "N/m"), quantity(self.approach, "m")
        return f"<PullOff: load {load}, approach {approach}, zones: {len(self.zones)}>"


@dataclass(frozen=True)
class Energy:
    """Elastic and surface energy; the change of their sum is the work done by the load.

    Parameters
    ----------
    elastic : float
        (1/2) int p u dx [J/m], per period where there is one; u is the displacement approach - f +
        gap with the approach `Solution.approach`.
    surface : float
        Energy of the interface under the law [J/m]; 0 without adhesion. Under JKR's law it is -w
        times the width in contact, with w the work of adhesion.

    Examples
    --------
    A wave in full contact: pi E* amplitude^2/4 - w period (K. L. Johnson, Int. J. Solids Struct.
    32, 1995, 423).

    >>> import contact
    >>> import numpy as np
    >>> wave = contact.Scene(
    ...     contact.Sinusoid(1e-2, 1.0), 1.0, contact.Periodic(), law=contact.JKR(1e-5), load=1.0
    ... )
    >>> energy = contact.solve(wave).energy
    >>> bool(np.isclose(energy.elastic, np.pi * 1e-4 / 4)), energy.surface
    (True, -1e-05)
    >>> bool(energy.total == energy.elastic - 1e-5)
    True
    """

    elastic: float
    surface: float

    @property
    def total(self) -> float:
        return self.elastic + self.surface


@dataclass(frozen=True)
class PeakOptions:
    """Number of samples in the search for the largest pressure of each zone."""

    # Number of samples for each shortest length of the profile in a zone; they are added to the
    # samples of a smooth zone. Larger numbers give the same peaks.
    samples_per_length: int = 12


PEAKS = PeakOptions()


def peaks(scene: Scene, zones: Array, pressure_at: Callable[[Array, int], Array]) -> Array:
    """The largest pressure of each zone [Pa]; inf for a zone with a convex kink of the profile.

    zones: (n, 2) [m]. pressure_at: pressure [Pa] at normalised positions t of one zone.
    """
    found = np.empty(len(zones))
    tips = _convex_kinks(scene)
    resolution = scene.profile.resolution or np.inf
    for zone, (left, right) in enumerate(zones):
        if np.any((left < tips) & (tips < right)):
            found[zone] = np.inf
            continue
        more = PEAKS.samples_per_length * (right - left) / resolution
        count = int(min(SAMPLING.min_points + more, SAMPLING.max_points))

        def over_angle(angle: Array, zone: int = zone) -> Array:
            return pressure_at(np.clip(np.cos(angle), -1.0, 1.0), zone)

        # As a function of the angle arccos t, with t from -1 to 1 on the zone, the pressure is
        # smooth.
        found[zone] = maximum(over_angle, np.linspace(0.0, np.pi, count + 1), levels=7)[1]
    return found


def _convex_kinks(scene: Scene) -> Array:
    """Places [m] where the slope of the profile jumps up, with their images one period away.

    Zones begin in the cell of the period and may end in the next one.
    """
    kinks = np.reshape(scene.profile.kinks, (-1, 2))
    places = kinks[kinks[:, 1] > 0, 0]
    if scene.period is None:
        return places
    return np.concatenate([places + turn * scene.period for turn in (-1, 0, 1)])
