"""The logarithmic capacity of zones, from a density whose potential is the same on all of them.

Let a density phi of the total P have the potential (1/pi) int phi log|x - xi| = V, the same on all
zones. Then pi V / P = log(capacity): the equilibrium problem (T. Ransford, Potential Theory in the
Complex Plane, Cambridge 1995, chapter 5). Hilbert's kernel has the potential
log|2 sin(pi (x - xi) / L)|. If the line is rolled onto a circle of circumference L, the distance of
the points x and xi is L / (2 pi) times the argument of this logarithm. So the capacity of the arcs
is L / (2 pi) exp(pi V / P).
"""

import math
from dataclasses import dataclass

import numpy as np

from sie.basis.kernels import Kernel, cauchy, hilbert
from sie.slits.system import AnyState


@dataclass(frozen=True)
class CapacityOptions:
    """Options of the check that the potential is the same on all zones."""

    # Positions on each zone, from -1 to 1, at which the potential must be the same.
    places: tuple[float, ...] = (-0.9, 0.0, 0.7)
    # Largest allowed difference of the potentials at `places`, as a multiple of the density's
    # stated error. It is above 1, because a potential adds up the errors of several coefficients of
    # the density.
    margin: float = 100.0


OPTIONS = CapacityOptions()


def unit_length(kernel: Kernel) -> float:
    """The capacity that zones have if their potential is zero.
    Raises ValueError for a kernel without a capacity.
    """
    if kernel == cauchy(kernel.datum):
        return kernel.datum
    if kernel.period is not None and kernel == hilbert(kernel.period):
        return kernel.period / (2 * math.pi)
    raise ValueError(
        "a capacity needs the kernel sie.cauchy(), or sie.hilbert(L) for the capacity of arcs of a "
        "circle with the circumference L"
    )


def capacity_of(state: AnyState, error: float) -> float:
    """The logarithmic capacity of all zones together.
    `error` is the relative error of the solution.
    """
    if state.equation.second_kind:
        raise ValueError("a capacity needs an equation with kappa = 0")
    density = state.density
    unit = unit_length(density.kernel)
    zones = density.zones
    x = (zones.middle[:, None] + zones.half[:, None] * np.array(OPTIONS.places)).ravel()
    if np.any(state.right_side(x) != 0.0):
        raise ValueError(
            "a capacity needs the right side zero, so that the potential is constant on each zone; "
            "this right side is not zero"
        )
    potential, total = density.potential(x), density.total
    size = max(float(np.pi * zones.half @ np.abs(state.zone_sizes)), abs(total))
    slack = OPTIONS.margin * error
    if not abs(total) > slack * size:
        raise ValueError("a capacity needs a density whose total is not zero: use sie.Total(1.0)")
    level = np.pi * potential / total
    if not np.ptp(level) <= slack * max(1.0, np.abs(level).max()) * size / abs(total):
        raise ValueError(
            "a capacity needs one potential on all zones: use ends sie.SINGULAR and the conditions "
            "sie.Total(1.0) and sie.EqualPotential(); here pi * potential / total varies by "
            f"{np.ptp(level):.3g}"
        )
    return float(unit * math.exp(level.mean()))
