r"""How edge intensities and levels follow the motions of zone ends, in closed form.

Where the end of a zone moves outward by s, the density K / sqrt(d) + A sqrt(d) beside it changes at fixed places by

    d phi/ds = -(K/2) d^(-3/2) + (dK/ds + A/2) d^(-1/2) + ...,

and what changes solves the equation with no right side. On a zone of half width w, t -> 1 the end,

    S(t) = 1 / ((1 - t) sqrt(1 - t^2)) ~ (1/sqrt 2) (d/w)^(-3/2) + (1/(4 sqrt 2)) (d/w)^(-1/2)

has no transform on the zone, no total, the potential -w there, and outside the transform and the potential of the coefficients
c_l = -2 l (finite parts: (1/pi) int T_l S dt = -l, from rho^l / sqrt(z^2 - 1) at z -> 1).
So the rows at hand, applied to these, tell what S does to the other zones, and one solution with the factors at hand what answers.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lu_factor

from sie.basis.data import Array
from sie.collocation.fixed import SingularSystem, State, rows_of
from sie.collocation.solved import Factored
from sie.free_ends.motions import IteratedMotions, Moved, free_ends, spread

# Condition of the rates of K from which on they are rounding.
_NEUTRAL_FROM = 1e14
# Beyond this number of unknowns a matrix costs more than as many solutions by iteration as there are ends.
_MANY = 8000


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
    solved, ends, iteration = zones.solved, free_ends(state), state.iteration
    if iteration is not None and layout.size > _MANY:
        motions = IteratedMotions(state, iteration)
        columns = [motions.rates(one) for one in np.eye(len(ends))]
        told = iteration.system.wants_levels and len(ends) > 0
        levels = np.column_stack([levels for _, levels in columns]) if told else np.zeros((len(solved), 0))
        return EndRates(ends, np.array([k for k, _ in columns]).reshape(len(ends), len(ends)).T, levels)
    moved = Moved.of(state, spread(state, ends, np.eye(len(ends))))
    singular, own_level, own = moved.coefficients, moved.own_level, moved.own
    matrix = rows_of(state)
    folded = singular if state.symmetry.keep is None else singular[state.symmetry.keep]
    right = matrix @ folded
    # The rows hold what coefficients do to their own zone, which S does not.
    right[: state.conditions_from] += singular[system.diagonal]
    right[state.conditions_from :] += state.level_rows @ own_level[solved]
    held = [own[side, solved[p]] for side, places in enumerate(zones.held) for p in places]
    if held:
        right[-len(held) :] = np.array(held) / state.condition_scale[-len(held) :, None]
    factors = state.direct or Factored(*lu_factor(matrix, check_finite=False))
    answer = np.asarray(factors(-right))
    unknowns = np.column_stack([state.symmetry.unfold(column) for column in answer.T]) if len(ends) else np.zeros((layout.size, 0))
    linear = np.array([part @ unknowns for part, _ in system.intensities()])
    rates = linear + own[:, solved]
    place = {int(i): p for p, i in enumerate(solved)}
    intensities = np.array([rates[side, place[i]] for side, i in ends]).reshape(len(ends), len(ends))
    levels = np.zeros((len(solved), 0))
    if system.wants_levels:
        levels = system.levels()[0] @ (unknowns + singular) + own_level[solved]
    return EndRates(ends, intensities, levels)


def end_motions(state: State, change: Array) -> tuple[Array, Array]:
    """The motions of the free ends by which the intensities change as wanted, the values of the side conditions held.

    Of very many ends, where the rates of each by each would be too many, they are found by iteration.

    Parameters
    ----------
    state : State
        A solution on zones with free ends.
    change : (2, Z) array
        Wanted of K at the left and right ends; only that at free ends counts.

    Returns
    -------
    motions : (2, Z) array
        Outward.
    levels : (Z,) array
        What they do to the levels of the solved zones; none where no condition speaks of levels.

    Raises
    ------
    SingularSystem
        If some motion leaves all intensities as they are.

    Examples
    --------
    An adhering contact under a held load, whose K at both ends is to change by 0.01: as the rates have it.

    >>> import numpy as np
    >>> import sie
    >>> end = sie.free_with_intensity(-0.1)
    >>> equation = sie.Equation(sie.cauchy(), sie.Forcing(lambda x: x), (sie.Total(1.0),))
    >>> state = sie.solve_fixed(equation, sie.Zones.of([[-1.0, 1.2]], end, end))
    >>> motions, _ = sie.end_motions(state, np.full((2, 1), 0.01))
    >>> (sie.end_rates(state).intensities @ motions[:, 0]).round(12).tolist()
    [0.01, 0.01]
    """
    motions = motions_of(state)
    found = motions.meeting(change[motions.side, motions.zone], 0.0)
    if not np.isfinite(found).all():
        raise SingularSystem("some motion of the ends leaves the intensities as they are")
    return spread(state, motions.ends, found), motions.rates(found)[1]


class DirectMotions:
    """What `IteratedMotions` tells, by the matrix of the rates."""

    def __init__(self, state: State) -> None:
        self.state, self._rates = state, end_rates(state)
        self.ends = self._rates.ends
        self.side, self.zone = np.array(self.ends, dtype=np.intp).reshape(-1, 2).T
        # Rounding alone keeps the rates of a motion that changes nothing from being zero.
        neutral = len(self.ends) > 0 and not np.linalg.cond(self._rates.intensities) < _NEUTRAL_FROM
        self._inverse = np.full_like(self._rates.intensities, np.nan) if neutral else np.linalg.inv(self._rates.intensities)

    def meeting(self, change: Array, tolerance: float = 0.0) -> Array:
        return np.asarray(self._inverse @ change)

    def local(self, k: Array) -> Array:
        return spread(self.state, self.ends, np.abs(self._inverse) @ k[self.side, self.zone])

    def rates(self, d: Array, tolerance: float = 0.0) -> tuple[Array, Array]:
        levels = self._rates.levels
        return self._rates.intensities @ d, levels @ d if levels.size else np.zeros(0)

    def growth(self, signs: Array, normal: Array | None = None, by_value: Array | None = None) -> float:
        return growth(signs[self.side][:, None] * self._rates.intensities, normal, by_value)


def growth(driven: Array, normal: Array | None = None, by_value: Array | None = None) -> float:
    """Largest real part of the eigenvalues of what drives the ends by their motions; with a condition on the ends, which the unknown value
    keeps: of motions along it."""
    if normal is not None and by_value is not None:
        driven = driven - np.outer(by_value, normal @ driven) / (normal @ by_value)
        along = np.linalg.svd(normal[None])[2][1:]
        driven = along @ driven @ along.T
    return float(np.linalg.eigvals(driven).real.max(initial=-np.inf))


def motions_of(state: State) -> DirectMotions | IteratedMotions:
    """By the matrix of the rates, or by iteration where the state was found so."""
    return DirectMotions(state) if state.iteration is None else IteratedMotions(state, state.iteration)
