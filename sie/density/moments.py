"""A density's weights for the regular part of the kernel: at nodes of a quadrature, and on the kernel's panels."""

import numpy as np

from sie.basis import chebyshev
from sie.basis.data import Array, widened
from sie.basis.kernels import Kernel, regular_size
from sie.basis.zones import Zones
from sie.fast.panels import Panels, Spread, panels_over
from sie.jumps.forcing import ForcingJumps


def moments_of(panels: Panels, zones: Zones, kernel: Kernel, table: Array, jumps: ForcingJumps) -> Array:
    """Moments of the panels of a density, see `quadrature`."""
    nodes, weights = (np.concatenate(parts) for parts in zip(*quadrature(zones, kernel, table, jumps), strict=True))
    return panels.moments(Spread.of(panels, nodes), weights)


def quadrature(zones: Zones, kernel: Kernel, table: Array, jumps: ForcingJumps) -> list[tuple[Array, Array]]:
    """(nodes, weights times density) for the regular part, of T coefficients (zones, n + 1) and jumps; zones of equal size together."""
    m, panels = table.shape[1] - 1, panels_over(kernel, zones)
    sizes = np.array([regular_size(kernel, w, m) for w in zones.half]) if panels is None else panels.modes(zones.half) + 2
    found = []
    for q in np.unique(sizes):
        group = np.flatnonzero(sizes == q)
        count = min(int(q), m + 1)
        xi = zones.middle[group][:, None] + zones.half[group][:, None] * chebyshev.gauss(int(q))
        c = table[group, :count]
        if len(jumps):
            count = int(q)
            c = widened(c, count) + jumps.t_coefficients(zones, count)[group]
        weights = chebyshev.t_values(c, int(q)) * (zones.half[group] / q)[:, None]
        found.append((xi.ravel(), weights.ravel()))
    return found
