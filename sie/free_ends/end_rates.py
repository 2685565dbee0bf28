r"""How edge intensities and levels follow the motions of zone ends, in closed form.

Where the end of a zone moves outward by s, the density K / sqrt(d) + A sqrt(d) beside it changes at fixed places by

    d phi/ds = -(K/2) d^(-3/2) + (dK/ds + A/2) d^(-1/2) + ...,

and what changes solves the equation with no right side. On a zone of half width w, t -> 1 the end,

    S(t) = 1 / ((1 - t) sqrt(1 - t^2)) ~ (1/sqrt 2) (d/w)^(-3/2) + (1/(4 sqrt 2)) (d/w)^(-1/2)

has no transform on the zone, no total, the potential -w there, and outside the transform and the potential of the coefficients
c_l = -2 l (finite parts: (1/pi) int T_l S dt = -l, from rho^l / sqrt(z^2 - 1) at z -> 1).
So the rows at hand, applied to these, tell what S does to the other zones, and one solution with the factors at hand what answers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sie.collocation.fixed import State, rows_of
from sie.equation.conditions import of_levels, speaks_of_levels

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class EndRates:
    """Derivatives by the outward motions of the free ends, (side, zone) each, side 0 left and 1 right; of a mirrored pair the one on
    the right stands for both. The values of the side conditions are held.

    Attributes
    ----------
    ends : list of (int, int)
        Which ends these are.
    intensities : (E, E) array
        Of K at each by the motion of each.
    levels : (Z, E) array
        Of the levels of the solved zones; none where no condition speaks of levels.

    Examples
    --------
    A punch under a held total, K = P/(pi sqrt(2 w)), is half as much wider as one end moves.

    >>> import numpy as np
    >>> import sie
    >>> end = sie.free_with_intensity(-0.1)
    >>> flat = sie.Forcing(np.zeros_like, np.zeros_like)
    >>> equation = sie.Equation(sie.cauchy(), flat, (sie.Total(1.0),))
    >>> rates = sie.end_rates(sie.solve_fixed(equation, sie.Zones.of([[-2.0, 2.0]], end, end)))
    >>> bool(np.allclose(rates.intensities, -1 / (16 * np.pi)))
    True
    """

    ends: list[tuple[int, int]]
    intensities: Array
    levels: Array


def end_rates(state: State) -> EndRates:
    """The rates at a state with singular ends allowed where they are free.

    Parameters
    ----------
    state : State
        A solution on zones with free ends.

    Returns
    -------
    EndRates

    Examples
    --------
    A crack that is opened evenly, K = sqrt(w/2), takes up half as much as one end moves.

    >>> import numpy as np
    >>> import sie
    >>> end = sie.free_with_intensity(1.0)
    >>> equation = sie.Equation(sie.cauchy(), sie.Forcing(lambda x: -np.ones_like(x)), (sie.ZoneTotals(),))
    >>> state = sie.solve_fixed(equation, sie.Zones.of([[-2.0, 2.0]], end, end))
    >>> bool(np.allclose(np.abs(sie.end_rates(state).intensities).sum(axis=1), 0.25))
    True
    """
    system, zones, layout = state.system, state.density.zones, state.system.layout
    solved, count = zones.solved, len(zones)
    ends = free_ends(state)
    k, slope = np.array(state.density.intensities), np.array(state.density.edge_slopes)
    singular = np.zeros((layout.size, len(ends)))
    own_level, own = np.zeros((count, len(ends))), np.zeros((2, count, len(ends)))
    for j, (side, i) in enumerate(ends):
        moved = {(side, i), (1 - side, count - 1 - i)} if zones.symmetric else {(side, i)}
        for s, z in moved:
            w, order = float(zones.half[z]), np.arange(layout.m[z] + 1)
            strength = -k[s, z] / (np.sqrt(2.0) * w**1.5)
            turned = 1.0 if s == 1 else 1.0 - 2.0 * (order % 2)
            singular[layout.offset[z] + order, j] += strength * -2.0 * order * turned
            own_level[z, j] -= w * strength
            root = strength * np.sqrt(w / 2)
            own[s, z, j] += 0.25 * root - 0.5 * slope[s, z]
            own[1 - s, z, j] += 0.5 * root
    right = np.empty((state.solver.size, len(ends)))
    matrix = rows_of(state)
    folded = singular if state.symmetry.keep is None else singular[state.symmetry.keep]
    right[:] = matrix @ folded
    # The rows hold what coefficients do to their own zone, which S does not.
    right[: state.conditions_from] += singular[system.diagonal]
    at = state.conditions_from
    for condition in state.equation.conditions:
        rows = condition.count(zones)
        if rows and speaks_of_levels(condition, zones):
            here = slice(at, at + rows)
            scale = state.condition_scale[at - state.conditions_from : at - state.conditions_from + rows, None]
            right[here] += of_levels(condition, zones) @ own_level[solved] / scale
        at += rows
    for side, places in enumerate(zones.held):
        for p in places:
            right[at] = own[side, solved[p]] / state.condition_scale[at - state.conditions_from]
            at += 1
    answer = np.asarray(state.solver(-right))
    unknowns = np.column_stack([state.symmetry.unfold(column) for column in answer.T]) if len(ends) else np.zeros((layout.size, 0))
    linear = np.array([part @ unknowns for part, _ in system.intensities()])
    rates = linear + own[:, solved]
    place = {int(i): p for p, i in enumerate(solved)}
    intensities = np.array([rates[side, place[i]] for side, i in ends]).reshape(len(ends), len(ends))
    levels = np.zeros((len(solved), 0))
    if any(speaks_of_levels(condition, zones) for condition in state.equation.conditions):
        levels = system.levels()[0] @ (unknowns + singular) + own_level[solved]
    return EndRates(ends, intensities, levels)


def free_ends(state: State) -> list[tuple[int, int]]:
    """(side, zone) of the ends that move, of mirrored pairs the right one."""
    zones = state.density.zones
    mirrored = int(zones.solved[0]) if zones.central else -1
    kinds = (zones.left, zones.right)
    return [
        (side, int(i)) for side in (0, 1) for i in zones.solved if kinds[side][i].moves and (side, i) != (0, mirrored)
    ]
