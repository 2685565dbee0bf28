"""Response of a solution to unit sources outside its zones, accurate also close to zones.

A unit source at c adds K(x, c)/pi to the right side, with the kernel K(x, c). Let rho belong to the
position c relative to a zone of half width w (`sie.basis.interval`). Then

    1/(x - c) = -(2/w) sum_{k >= 1} rho^k U_{k-1}(t),

so the coefficients of the modes l that are not unknowns are (2/w) rho^l / pi. They contribute
geometric series to the intensities, and logarithms to the potential at other positions. Both sums
have closed forms, which are valid however close to the zone a source is.
"""

from dataclasses import dataclass

import numpy as np

from sie.basis.data import DIGITS, Array, Index, numbered
from sie.dense.system import Places, fields, outside
from sie.states.state import State


@dataclass(frozen=True, eq=False)
class Answers:
    """Changes of a solution, caused by point sources and changed side conditions, in J cases.

    Attributes
    ----------
    intensities : (2, Z, J) array
        Changes of the intensity K at the left and the right ends.
    levels : (Z, J) array
        Changes of the levels of the zones, the constants of the potential on them; empty if no
        condition involves levels.
    potentials : (P, J) array
        Changes of the density's potential at the given positions.

    Examples
    --------
    One more unit of load on a zone adds the density 1/(pi sqrt(1 - x^2)), with K = 1/(sqrt(2) pi)
    at both ends.

    >>> import numpy as np
    >>> import sie
    >>> still = sie.Equation(sie.cauchy(), sie.Forcing(np.zeros_like), (sie.Total(0.0),))
    >>> state = sie.solve_fixed(still, sie.Zones.of([[-1.0, 1.0]], sie.SINGULAR, sie.SINGULAR))
    >>> more = sie.answers(state, np.array([5.0]), np.zeros((1, 1)), np.ones((1, 1)), np.zeros(0))
    >>> type(more).__name__, bool(np.allclose(more.intensities[:, 0, 0], 1 / (np.sqrt(2) * np.pi)))
    ('Answers', True)
    """

    intensities: Array
    levels: Array
    potentials: Array


def answers(state: State, at: Array, strengths: Array, values: Array, places: Array) -> Answers:
    """Changes of a solution, caused by point sources and by changed values of side conditions.

    Parameters
    ----------
    state : State
        A solution on zones that are not solved as mirror images.
    at : (S,) array
        Positions of the sources, outside all zones.
    strengths : (S, J) array
        Strengths of the sources in each case.
    values : (C, J) array
        Changes of the values of the side conditions, in the order of their rows.
    places : (P,) array
        Positions outside all zones at which the potential is computed.

    Returns
    -------
    Answers

    Raises
    ------
    ValueError
        If the zones are symmetric, so that only half of them is solved for.

    Examples
    --------
    A unit source at c, far to the right of a zone, adds the constant -1/(pi c) to the right side on
    the zone. This makes |K| = w^(1/2)/(sqrt(2) pi c) at both ends.

    >>> import numpy as np
    >>> import sie
    >>> still = sie.Equation(sie.cauchy(), sie.Forcing(np.zeros_like), (sie.Total(0.0),))
    >>> state = sie.solve_fixed(still, sie.Zones.of([[-1.0, 1.0]], sie.SINGULAR, sie.SINGULAR))
    >>> found = sie.answers(state, np.array([1e9]), np.ones((1, 1)), np.zeros((1, 1)), np.zeros(0))
    >>> (found.intensities[:, 0, 0] * np.pi * 1e9 * np.sqrt(2)).round(6).tolist()
    [-1.0, 1.0]
    """
    density, layout, system = state.density, state.system.layout, state.system
    zones, kernel = density.zones, density.kernel
    if zones.symmetric:
        raise ValueError("sources need zones that are all solved: use symmetric=False")
    at, cases = np.asarray(at, dtype=float), strengths.shape[1]
    poles, a, b = np.array(kernel.poles), zones.a[:, None, None], zones.b[:, None, None]
    seen = outside(a, b, at[:, None] + poles)  # (Z, S, poles)
    up = seen.rho
    g = np.zeros((len(zones), int(layout.m.max()) + 1, len(at)))
    for m in np.unique(layout.m):
        some = np.flatnonzero(layout.m == m)
        power = np.ones_like(up[some])
        for k in range(1, int(m) + 1):
            power = power * up[some]
            g[some, k] = power.sum(axis=2)
    g *= -2 / (np.pi * zones.half[:, None, None])
    mean = seen.first(zones.half[:, None, None] / kernel.datum).sum(axis=2) / np.pi
    rows = g[np.repeat(np.arange(len(zones)), layout.m), numbered(layout.m) + 1]
    if kernel.regular is not None and len(at):
        # The kernel's regular part has no closed form, so its values and its potential are sampled
        # at the nodes of the zones.
        x = system.targets.x[:, None]
        rows += system.projected(kernel.regular(x, at) / np.pi)
        mean += (
            0.0
            if kernel.regular_potential is None
            else system.means(kernel.regular_potential(x, at) / np.pi)
        )
    right = np.zeros((state.solver.size, cases))
    right[: len(rows)] = rows @ strengths
    own_level = -(mean @ strengths)
    right[state.conditions_from :] = values / state.condition_scale[:, None]
    right[state.conditions_from :] -= state.level_rows @ own_level
    unknowns = _solved(state, right)
    table = np.array([layout.padded(column) for column in unknowns.T]).reshape(
        cases, len(zones), -1
    )
    beyond = (2 / np.pi) / zones.half[:, None, None] * up ** (layout.m[:, None, None] + 1)
    turned = np.where(layout.m % 2 == 0, -1.0, 1.0)[:, None, None]
    root = zones.edge_scale[:, None]
    order = np.arange(table.shape[2])
    intensities = root * np.array(
        [
            (table * (1.0 - 2.0 * (order % 2))).sum(axis=2).T
            + (turned * beyond / (1 + up)).sum(axis=2) @ strengths,
            table.sum(axis=2).T + (beyond / (1 - up)).sum(axis=2) @ strengths,
        ]
    )
    levels = np.zeros((0, cases))
    if system.wants_levels:
        levels = system.levels()[0] @ unknowns + own_level
    places = density.into_period(np.asarray(places, dtype=float))
    potentials = (
        _beyond_potential(outside(a, b, places[:, None] - poles).rho, up, layout.m) @ strengths
    )
    unknowns[: layout.coefficients] *= np.repeat(zones.half, layout.m + 1)[:, None]
    potentials += fields(zones, kernel, Places(places), layout, potential=True) @ unknowns
    return Answers(intensities, levels, potentials)


def _solved(state: State, right: Array) -> Array:
    iteration = state.iteration
    if iteration is None:
        return np.asarray(state.solver(right))
    return np.column_stack([iteration(column, None, 0.0) for column in right.T])


def _beyond_potential(seen: Array, up: Array, m: Index) -> Array:
    """Potential (P, S) at P positions due to the modes l > m of the zones, for S unit sources.

    m: highest mode of each zone that is an unknown of the linear system (Z,); up: rho of the
    sources (Z, S, poles); seen: rho' of the positions (Z, P, poles). The potential is the sum over
    zones and poles of -(2/pi) sum_{l > m} (rho rho')^l / l.
    """
    out = np.zeros((seen.shape[1], up.shape[1]))
    for i in range(len(m)):
        # Bound of |rho rho'|. The powers rho^l and rho'^l are the decay of mode l of the zone
        # towards a source and towards a position. Below the bound, all (rho rho')^l with l > m are
        # below round-off.
        least = np.exp(-DIGITS / (int(m[i]) + 1))
        for q in range(seen.shape[2]):
            # Pairs of a source and a position that contribute less than round-off are left out.
            sources = np.flatnonzero(
                np.abs(up[i]).max(axis=1) * np.abs(seen[i, :, q]).max(initial=0.0) >= least
            )
            if len(sources) == 0:
                continue
            places = np.flatnonzero(np.abs(seen[i, :, q]) * np.abs(up[i, sources]).max() >= least)
            both = seen[i, places, None, q, None] * up[i, sources]
            place, source, pole = np.nonzero(np.abs(both) >= least)
            both, place, source = both[place, source, pole], places[place], sources[source]
            # The sum of (rho rho')^l / l over l >= 1 is -log(1 - rho rho'), with rho rho' in
            # `both`. So `total` becomes minus the sum over l > m.
            total = np.log1p(-both)
            power = np.ones_like(both)
            for order in range(1, int(m[i]) + 1):
                power = power * both
                total += power / order
            np.add.at(out, (place, source), (2 / np.pi) * total)
    return out
