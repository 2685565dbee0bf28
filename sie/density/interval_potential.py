"""The potential on a stretch without zones, at many points: near zones one by one, far ones by interpolation.

What a zone does is analytic away from it. On [lo, hi], zones at a distance of at least half the stretch are seen
through Chebyshev interpolation at a fixed number of nodes: with z = 2, rho = 2 - sqrt(3) = 0.268, and 26 nodes leave
1e-15. A regular kernel goes with them where it is known to be as smooth as that; else it is taken at the points themselves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sie.basis import chebyshev
from sie.basis.kernels import Regular
from sie.density.field import Sources, potential_at, potential_from, regular_at
from sie.density.series import Evaluated

Array = NDArray[np.float64]

_NODES = 26


@dataclass(frozen=True, eq=False)
class IntervalPotential:
    """The potential of a density on [lo, hi], an interval without zones in it, made by `IntervalPotential.on(density, lo, hi)`.

    Attributes
    ----------
    density : Density
        Whose potential it is.
    lo, hi : float
        The interval.
    far : ndarray
        What sources far away make, as a series.
    near : Sources
        Those near by.
    rough : callable or None
        The kernel's regular potential, where it is not smooth over the interval.

    Examples
    --------
    >>> import numpy as np, sie
    >>> punch = sie.Equation(sie.cauchy(), sie.Forcing(np.zeros_like), (sie.Total(1.0),))
    >>> density = sie.solve(punch, sie.Zones.of([[-1.0, 1.0]], sie.SINGULAR, sie.SINGULAR)).density
    >>> x = np.linspace(3, 4, 5)
    >>> bool(np.allclose(sie.IntervalPotential.on(density, 3.0, 4.0)(x), density.potential(x), rtol=1e-13))
    True
    """

    density: Evaluated
    lo: float
    hi: float
    far: Array
    near: Sources
    rough: Regular | None = None

    @classmethod
    def on(cls, density: Evaluated, lo: float, hi: float) -> IntervalPotential:
        """Choose the near sources of [lo, hi] and interpolate all others."""
        sources = Sources.of(density.zones, density.kernel)
        distance = np.maximum(sources.a - hi, lo - sources.b)
        near = sources.chosen(distance < 0.5 * (hi - lo))
        t = chebyshev.gauss(_NODES)
        x = 0.5 * (lo + hi) + 0.5 * (hi - lo) * t
        values = potential_at(density, x, sources) - potential_from(density, x, near)
        regular = density.kernel.regular_potential
        rough = regular if density.kernel.reach < hi - lo else None
        if rough is not None:
            values = values - regular_at(density, x, rough)
        far = values @ (chebyshev.t_matrix(_NODES, _NODES) * (2 / _NODES))
        far[0] *= 0.5
        return cls(density, lo, hi, far, near, rough)

    def __call__(self, x: Array) -> Array:
        """Potential at points x (n,) of [lo, hi]."""
        t = (2 * x - (self.lo + self.hi)) / (self.hi - self.lo)
        smooth = np.polynomial.chebyshev.chebval(t, self.far)
        value = smooth + potential_from(self.density, x, self.near)
        return np.asarray(value if self.rough is None else value + regular_at(self.density, x, self.rough))
