"""Effect of motions of free ends on the intensities at ends and on the levels of zones.

The level of a zone is the constant of the potential on it. At distance d from an end the density is
K / sqrt(d) + A sqrt(d), with the intensity K and the edge slope A. If the end moves outward by s,
the density phi at fixed positions changes by

    d phi/ds = -(K/2) d^(-3/2) + (dK/ds + A/2) d^(-1/2) + ...,

and this change solves the equation with right side zero. On a zone of half width w, with t -> 1 the
end,

    S(t) = 1 / ((1 - t) sqrt(1 - t^2)) ~ (1/sqrt 2) (d/w)^(-3/2) + (1/(4 sqrt 2)) (d/w)^(-1/2)

has no transform on the zone, no total, and the potential -w there. Outside it has the transform and
the potential of a density with the Chebyshev coefficients c_l = -2 l (finite parts:
(1/pi) int T_l S dt = -l, from rho^l / sqrt(z^2 - 1) at z -> 1). So the rows, applied to these
coefficients, give the effect of S on the other zones, and one solve with the LU factors gives the
response.

A motion d of the right end of a zone of half width w adds q S with the strength
q = -K d / (sqrt(2) w^(3/2)). The term q S acts on all other zones like the coefficients -2 l q. It
changes the level of its own zone by -w q, and contributes to the intensities at both ends of this
zone.

For very many ends with prescribed intensities the matrix of the derivatives dK/ds would be too
large. The unknowns y of the response and the motions d of all ends are found together, from

    rows (y + singular densities of d) = 0,      K(y) + own K of d = change,

by GMRES with one fast sum in each step. The preconditioner of y is that of the equation. The
preconditioner of d inverts the effect of a motion on its own zone. So the number of steps does not
grow with the number of zones.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from scipy.linalg import norm

from sie.basis.data import EPS, SUM_ROUNDING, Array, record
from sie.basis.weight import needs_half
from sie.basis.zones import Zones
from sie.dense.lu import Factored
from sie.dense.modes import OPTIONS as MODES
from sie.dense.system import System, condition_rows
from sie.equation.conditions import Linear, Rows
from sie.fast.iteration import OPTIONS as ITERATION
from sie.fast.iteration import Iterative
from sie.fast.system import Applied, IterativeSystem
from sie.second_kind.solve import solve_moved
from sie.second_kind.state import SecondKindState
from sie.states.options import OPTIONS as ERRORS
from sie.states.solve import SingularSystem, rows_of
from sie.states.state import State
from sie.trees.krylov import gmres


@record
class Moved:
    """Direct effect of motions of ends on the density, while the unknowns do not change.

    A motion of an end adds a singular density to its zone (see the head of this file).
    coefficients: those of a density that acts on other zones as the singular densities do
    (unknowns, ...); own_level: change of the level of the end's own zone (Z, ...); own: change of
    the intensities at both ends of this zone (2, Z, ...); strength: factors of the singular
    densities of the left and the right ends (2, Z, ...).
    """

    coefficients: Array
    own_level: Array
    own: Array
    strength: Array

    @classmethod
    def of(cls, state: State, d: Array) -> "Moved":
        """The direct effect of outward motions d (2, Z, ...) of the ends, at fixed unknowns."""
        zones, layout = state.density.zones, state.system.layout
        needs_half(zones.weight, "motions of ends with prescribed intensities")
        more = (1,) * (d.ndim - 2)
        w = zones.half.reshape(-1, *more)
        k, slope = (
            np.array(part).reshape(2, -1, *more)
            for part in (state.density.intensities, state.density.edge_slopes)
        )
        strength = -k * d / (np.sqrt(2.0) * w**1.5)
        zone = np.repeat(np.arange(len(zones)), layout.m + 1)
        order = (np.arange(layout.coefficients) - layout.offset[zone]).reshape(-1, *more)
        turned = 1.0 - 2.0 * (order % 2)
        coefficients = np.zeros((layout.size, *d.shape[2:]))
        coefficients[: layout.coefficients] = (
            -2.0 * order * (strength[1][zone] + turned * strength[0][zone])
        )
        root = strength * zones.edge_scale.reshape(w.shape)
        return cls(
            coefficients,
            -w * strength.sum(axis=0),
            0.25 * root + 0.5 * root[::-1] - 0.5 * slope * d,
            strength,
        )


@record
class SingularDensities(Rows):
    """Direct effect of J motions of ends on the quantities that the side conditions use.
    At fixed unknowns, a motion changes the density by a function that is singular at the end.

    Each matrix has J columns, one for each motion. Integrals with a weight include all modes of the
    weight, also those above the modes of the zone. kept: cache of these modes, by weight and zone.
    """

    system: System
    moved: Moved
    kept: dict[tuple[Callable[[Array], Array], int], Array] = field(default_factory=dict)

    @property
    def zones(self) -> Zones:  # type: ignore[override]
        return self.system.zones

    def _of_zones(self, values: Array) -> Linear:
        return values[self.zones.solved], np.zeros(len(self.zones.solved))

    def totals(self) -> Linear:
        return self._of_zones(np.zeros_like(self.moved.own_level))

    def levels(self) -> Linear:
        matrix, constants = self._of_zones(self.moved.own_level)
        return matrix + self.system.levels()[0] @ self.moved.coefficients, constants

    def integrals(self, weight: Callable[[Array], Array], degree: int | None = None) -> Linear:
        zones, out = self.zones, np.zeros_like(self.moved.own_level)
        for i in zones.solved:
            moments = self.kept.get((weight, int(i)))
            if moments is None:
                moments = self.system.moments(weight, i, 2 * MODES.first_nodes, degree)
                self.kept[weight, int(i)] = moments
            order = np.arange(len(moments))
            both = np.array([moments @ (order * (1.0 - 2.0 * (order % 2))), moments @ order])
            out[i] = -2.0 * np.pi * zones.half[i] * np.tensordot(both, self.moved.strength[:, i], 1)
        return self._of_zones(out)

    def intensities(self) -> tuple[Linear, Linear]:
        return self._of_zones(self.moved.own[0]), self._of_zones(self.moved.own[1])

    def amplitude(self, k: int) -> Linear:
        return np.zeros((1, self.moved.own_level.shape[1])), np.zeros(1)


class AppliedMotions(Applied):
    """Values of the quantities in side conditions, for changed unknowns and moved ends together.
    A motion of an end changes the density by a singular function, `singular`.
    """

    singular: SingularDensities

    def integrals(self, weight: Callable[[Array], Array], degree: int | None = None) -> Linear:
        rows, constants = super().integrals(weight, degree)
        return rows + self.singular.integrals(weight, degree)[0][:, None], constants


class FreeEnds:
    """The free ends of a solution as pairs (side, zone).
    Of symmetric zones, only those in the right half are listed.
    """

    def __init__(self, state: State | SecondKindState) -> None:
        zones = state.density.zones
        mirrored = int(zones.solved[0]) if zones.central else -1
        self.state: Any = state
        self.zones = zones
        self.ends = [
            (side, int(i))
            for side in (0, 1)
            for i in zones.solved
            if zones.moves[side, i] and (side, i) != (0, mirrored)
        ]
        self.side, self.zone = np.array(self.ends, dtype=np.intp).reshape(-1, 2).T
        self.at = np.searchsorted(zones.solved, self.zone)

    def of(self, values: Array) -> Array:
        """Values (E, ...) at the free ends `self.ends`, from values (2, Z, ...) at all ends."""
        return np.asarray(values[self.side, self.zone])

    def spread(self, values: Array) -> Array:
        """Values at all ends (2, Z, ...), including mirrored ones, from values at the free ends."""
        out = np.zeros((2, len(self.zones), *values.shape[1:]))
        out[self.side, self.zone] = values
        if self.zones.symmetric:
            out[1 - self.side, len(self.zones) - 1 - self.zone] = values
        return out


@dataclass(frozen=True)
class MotionOptions:
    """Options for the derivatives of intensities by motions of ends, and for growth rates."""

    # Largest number of steps of Arnoldi's method for the growth rate of displacements of the ends.
    max_arnoldi: int = 64
    # Relative tolerance of the equation's responses to motions, for the growth rate. If the
    # relative residual of GMRES stays above this tolerance, some motion leaves the intensities
    # unchanged.
    response: float = 1e-4


OPTIONS = MotionOptions()


class IteratedMotions(FreeEnds):
    """Relations between motions of ends and changes of intensities K, computed by iteration.
    They are for solutions without a stored matrix.
    """

    def __init__(self, state: State, solver: Iterative) -> None:
        super().__init__(state)
        self.solver, self.system = solver, solver.system
        self.scale = solver.scale_of(state.folded_unknowns)
        self.width = self.zones.half[self.zone]
        self.kept: dict[tuple[Callable[[Array], Array], int], Array] = {}

    def _applied(self, folded: Array, d: Array) -> tuple[Array, Array]:
        """Left sides of the equation and the conditions, and intensities K of the free ends.
        They are caused by the motions d of the free ends and by a response, that is, by changes
        `folded` of the unknowns.
        """
        rows, edges = self.applied(folded, Moved.of(self.state, self.spread(d)))
        return rows, edges[self.side, self.at]

    def applied(self, folded: Array, moved: Moved) -> tuple[Array, Array]:
        """Left sides of the equation and the conditions, and intensities K of all ends (2, solved).
        They are caused by motions of any ends, free or fixed, and by a response, that is, by
        changes `folded` of the unknowns.
        """
        system: IterativeSystem = self.system
        y = system.symmetry.unfold(folded)
        rows, plain = system.applied(y + moved.coefficients)
        # Each row contains -1 times the coefficient of the row's mode, for the transform of this
        # mode on its zone. A singular density has no transform on its zone: the term is removed.
        rows = rows + moved.coefficients[system.diagonal]
        edges = (
            np.array(system.intensities_of(system.layout.padded(y)))
            + moved.own[:, self.zones.solved]
        )
        rest = plain.rest + moved.own_level[self.zones.solved]
        view = AppliedMotions(system, y, plain.middle, rest, edges)
        view.singular = SingularDensities(system, moved, self.kept)
        asked = condition_rows(system.equation, view, 1)[0][:, 0]
        return np.concatenate((rows, asked)), edges

    @cached_property
    def _local(self) -> Array:
        """For each zone, the inverse (Z, 2, 2) of a matrix from motions of its ends to intensities.
        The matrix gives the changes of the zone's two intensities K that these motions cause.
        """
        out = np.zeros((len(self.zones), 2, 2))
        for side in (0, 1):
            d = np.zeros((2, len(self.zones)))
            d[side] = 1.0
            out[:, :, side] = Moved.of(self.state, d).own.T
        moves = self.spread(np.ones(len(self.ends))) > 0
        for side in (0, 1):
            held = ~moves[side]
            out[held, side], out[held, :, side] = 0.0, 0.0
            out[held, side, side] = 1.0
        central = int(self.zones.solved[0]) if self.zones.central else -1
        if central >= 0:
            # The two ends of the zone at the centre of symmetry move by the same amount, so they
            # are one unknown.
            out[central] = np.diag([1.0, out[central, 1].sum()])
        size = np.abs(out).max(axis=(1, 2), keepdims=True)
        weak = np.abs(np.linalg.det(out / size)) < 1e-3
        # A single zone may shift or grow without a change of its intensities K. Then the zone's
        # matrix is nearly singular and is replaced by its largest entry times the identity.
        out[weak] = np.eye(2) * size[weak]
        return np.asarray(np.linalg.inv(out))

    def _by_zone(self, k: Array) -> Array:
        """Motions of free ends that would change the intensities by k if zones did not interact."""
        return self.of(np.einsum("zab,bz->az", self._local, self.spread(k)))

    def local(self, k: Array) -> Array:
        """Bounds of the errors of the ends (2, Z) caused by errors k (2, Z) of the intensities.

        The interaction of zones is neglected.
        """
        return np.asarray(np.einsum("zab,bz->az", np.abs(self._local), k))

    def rates(self, d: Array, tolerance: float = 0.0) -> tuple[Array, Array]:
        """(changes of the free ends' intensities, changes of the levels) that motions d cause.

        The level of a zone is the constant of the potential on it. The values of the side
        conditions do not change.
        """
        rows, own = self._applied(np.zeros(self.solver.size), d)
        folded = self.solver(-rows, None, tolerance)
        _, at_ends = self._applied(folded, d)
        levels = np.zeros(0)
        if self.system.wants_levels:
            moved = Moved.of(self.state, self.spread(d))
            y = self.system.symmetry.unfold(folded)
            levels = (
                self.system.level_changes(y + moved.coefficients)
                + moved.own_level[self.zones.solved]
            )
        return at_ends, levels

    def responses(self, d: Array) -> list[Array]:
        """Changes of the unknowns that each of several motions of the free ends causes."""
        none = np.zeros(self.solver.size)
        folded = [self.solver(-self._applied(none, one)[0], None, OPTIONS.response) for one in d.T]
        return [self.system.symmetry.unfold(one) for one in folded]

    def meeting(self, change: Array, tolerance: float = ITERATION.correction) -> Array:
        """Motions of free ends (E,) that change the intensities by `change`; nan if not found."""
        count = self.solver.size

        def precondition(rows: Array, k: Array) -> Array:
            folded = self.solver.preconditioner(rows)
            beside = np.array(
                self.system.intensities_of(
                    self.system.layout.padded(self.system.symmetry.unfold(folded))
                )
            )
            return np.concatenate(
                (folded / self.scale, self._by_zone(k - beside[self.side, self.at]) / self.width)
            )

        def apply(v: Array) -> Array:
            return precondition(*self._applied(v[:count] * self.scale, v[count:] * self.width))

        right = precondition(np.zeros(count), change)
        found = gmres(apply, right, tolerance * float(norm(right)))
        self.solver.iterations += found.steps
        if not found.residual <= max(OPTIONS.response, tolerance) * float(norm(right)):
            return np.full(len(self.ends), np.nan)
        return np.asarray(found.x[count:] * self.width)

    def amplification(self) -> float:
        """Factor by which the interaction of zones enlarges motions of ends, from a random sample.
        The motions cause a given change of the intensities K.

        It is infinite if some motion leaves the intensities K unchanged.
        """
        size = np.abs(np.linalg.inv(self._local)).max(axis=(1, 2))[self.zone] * self.width
        found = (
            self.meeting(
                size * np.random.default_rng(1).standard_normal(len(self.ends)), OPTIONS.response
            )
            / self.width
        )
        return float(np.abs(found).max()) if np.all(np.isfinite(found)) else np.inf

    def growth(
        self, signs: Array, normal: Array | None = None, by_value: Array | None = None
    ) -> float:
        """Growth rate of motions of the free ends, if each end moves with the speed sign * K.
        It is the largest real part of the eigenvalues of d(sign * K)/d(motion), with the
        intensities K.

        It is found by Arnoldi's method (W. E. Arnoldi, Quart. Appl. Math. 9, 1951, 17-29). With a
        condition on the ends, normal is the condition's derivative by the motions, and by_value the
        derivative of sign * K by the unknown value of a side condition.
        """
        driving = signs[self.side]

        def driven(d: Array) -> Array:
            out = driving * self.rates(d, OPTIONS.response)[0]
            if normal is None or by_value is None:
                return np.asarray(out)
            return np.asarray(out - by_value * (normal @ out) / (normal @ by_value))

        def along(d: Array) -> Array:
            """The part of a motion d of the ends that fulfils the condition normal @ d = 0.
            Without a condition it is d itself.
            """
            return (
                d if normal is None else np.asarray(d - normal * (normal @ d) / (normal @ normal))
            )

        count = len(self.ends)
        v = along(np.random.default_rng(0).standard_normal(count))
        most = min(OPTIONS.max_arnoldi, count - (normal is not None))
        basis, h, last = [v / norm(v)], np.zeros((most + 1, most)), np.inf
        for k in range(most):
            w = driven(basis[k])
            size = float(norm(w))
            for _ in range(2):
                part = np.array([b @ w for b in basis])
                h[: k + 1, k] += part
                w = along(w - part @ np.array(basis))
            h[k + 1, k] = norm(w)
            # If the new vector of the Krylov space is as small as the error of its computation, the
            # space is complete: another vector would add only noise.
            whole = k + 1 == most or h[k + 1, k] <= 10 * OPTIONS.response * size
            # The eigenvalues are computed if the number of steps k + 1 is a power of two that is at
            # least an eighth of `max_arnoldi`, and at the end.
            if whole or (k & (k + 1) == 0 and 8 * (k + 1) >= OPTIONS.max_arnoldi):
                found = float(np.linalg.eigvals(h[: k + 1, : k + 1]).real.max())
                if whole or abs(found - last) <= ERRORS.negligible * abs(found):
                    return found
                last = found
            basis.append(w / h[k + 1, k])
        return last


@dataclass(frozen=True, eq=False)
class EndRates:
    """Derivatives of intensities K and of zones' levels by motions of the free ends.
    The level of a zone is the constant of the potential on it.

    The values of the side conditions do not change. The right end of a mirrored pair stands for
    both ends.

    Attributes
    ----------
    ends : list of (int, int)
        The free ends, (side, zone) each, with side 0 for left and 1 for right.
    intensities : (E, E) array
        Derivative of the intensity K at each end (rows) by the motion of each end (columns).
    levels : (Z, E) array
        Derivatives of the levels of the solved zones; empty if no condition involves levels.

    Examples
    --------
    A punch with a given total P has K = P/(pi sqrt(2 w)). If one end moves, its half width w grows
    by half of the motion.

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
    """The derivatives, by motions of free ends, of intensities K and levels of a solution.
    The level of a zone is the constant of the potential on it.

    Parameters
    ----------
    state : State
        A solution on zones with free ends.

    Returns
    -------
    EndRates

    Examples
    --------
    A crack under uniform traction has K = sqrt(w/2). If one end moves, w grows by half of the
    motion.

    >>> import numpy as np
    >>> import sie
    >>> end = sie.free_with_intensity(1.0)
    >>> even = sie.Forcing(lambda x: -np.ones_like(x))
    >>> equation = sie.Equation(sie.cauchy(), even, (sie.ZoneTotals(),))
    >>> state = sie.solve_fixed(equation, sie.Zones.of([[-2.0, 2.0]], end, end))
    >>> bool(np.allclose(np.abs(sie.end_rates(state).intensities).sum(axis=1), 0.25))
    True
    """
    return _rates_and_responses(state)[0]


def _rates_and_responses(state: State) -> tuple[EndRates, Array]:
    """(derivatives `EndRates`, changes (unknowns, E) of the unknowns by unit motions of E ends).

    The table of responses is empty if the rates are found by iteration.
    """
    if isinstance(state, SecondKindState):
        return _rates_by_differences(state)
    system, zones, layout = state.system, state.density.zones, state.system.layout
    free, solved, levels = FreeEnds(state), zones.solved, np.zeros((len(zones.solved), 0))
    each = np.eye(len(free.ends))
    if state.iteration is not None and layout.size**2 > MODES.max_matrix_numbers:
        motions = IteratedMotions(state, state.iteration)
        columns = [motions.rates(one) for one in each]
        if system.wants_levels and len(columns):
            levels = np.column_stack([levels for _, levels in columns])
        return EndRates(
            free.ends, np.array([k for k, _ in columns]).reshape(each.shape).T, levels
        ), np.zeros((layout.size, 0))
    moved = Moved.of(state, free.spread(each))
    singular, own_level, own = moved.coefficients, moved.own_level, moved.own
    matrix = rows_of(state)
    factors = state.direct or Factored.of(matrix)
    answer = np.asarray(factors(-rows_of_motions(state, matrix, moved)))
    unknowns = (
        np.column_stack([state.symmetry.unfold(column) for column in answer.T])
        if len(each)
        else np.zeros((layout.size, 0))
    )
    intensities = (
        np.array([part @ unknowns for part, _ in system.intensities()]) + own[:, solved]
    )[free.side, free.at]
    if system.wants_levels:
        levels = system.levels()[0] @ (unknowns + singular) + own_level[solved]
    return EndRates(free.ends, intensities, levels), unknowns


def _rates_by_differences(state: SecondKindState) -> tuple[EndRates, Array]:
    """The result of `_rates_and_responses` for an equation with kappa, by finite differences.
    They are differences between solutions on zones with one end displaced.
    """
    free, step = FreeEnds(state), np.cbrt(EPS)
    asks_levels = any(condition.levels for condition in state.equation.conditions)
    intensities, levels, unknowns = [], [], []
    for number, (_, zone) in enumerate(free.ends):
        width = 2 * float(state.density.zones.half[zone])
        outward = free.spread(step * width * np.eye(len(free.ends))[number])
        ahead, back = solve_moved(state, outward), solve_moved(state, -outward)
        twice = 2 * step * width
        change = np.array(ahead.density.intensities) - np.array(back.density.intensities)
        intensities.append(free.of(change) / twice)
        unknowns.append((ahead.unknowns - back.unknowns) / twice)
        if asks_levels:
            levels.append((ahead.levels - back.levels) / twice)
    count = len(free.ends)
    rates = EndRates(
        free.ends,
        np.array(intensities).reshape(count, count).T,
        np.array(levels).T if levels else np.zeros((len(free.zones), 0)),
    )
    return rates, np.array(unknowns).reshape(count, -1).T


def rows_of_motions(state: State, matrix: Array, moved: Moved) -> Array:
    """Changes (rows, J) of the left sides of equation and conditions that J motions of ends cause.

    The unknowns are fixed: a motion changes the density by a function that is singular at the end.

    matrix: the matrix of the state; moved: the motions of any ends, free or fixed (2, Z, J).
    """
    singular = moved.coefficients
    rows = matrix @ singular[state.symmetry.keep]
    # Row n of a zone contains -1 times coefficient n: the transform of mode n on its own zone. A
    # singular density adds no such term on its own zone, so the term is cancelled.
    rows[: state.conditions_from] += singular[state.system.diagonal]
    view = SingularDensities(state.system, moved)
    asked = condition_rows(state.equation, view, singular.shape[1])[0]
    rows[state.conditions_from :] = asked / state.condition_scale[:, None]
    return np.asarray(rows)


def end_motions(state: State, change: Array) -> tuple[Array, Array]:
    """Motions of the free ends that cause given changes of the intensities, and changes of levels.

    The level of a zone is the constant of the potential on it.
    The values of the side conditions do not change. For very many ends the motions are found by
    iteration, since the matrix of all rates would be too large.

    Parameters
    ----------
    state : State
        A solution on zones with free ends.
    change : (2, Z) array
        Wanted change of the intensity K at the left and right ends. Only free ends count.

    Returns
    -------
    motions : (2, Z) array
        Outward motions of the left and right ends.
    levels : (Z,) array
        The resulting changes of the levels of the solved zones; empty if no condition involves
        levels.

    Raises
    ------
    SingularSystem
        If some motion leaves all intensities unchanged.

    Examples
    --------
    An adhering contact under a given load, whose K at both ends is to change by 0.01. The rates
    confirm the motions.

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
    found = motions.meeting(motions.of(change), 0.0)
    if not np.isfinite(found).all():
        raise SingularSystem(
            "some motion of the ends does not change the intensities, so they do not determine the "
            "ends"
        )
    return motions.spread(found), motions.rates(found)[1]


class DirectMotions(FreeEnds):
    """Relations between motions of ends and changes of intensities K, by a stored matrix.
    The matrix contains the derivatives of K by motions.
    """

    def __init__(self, state: State) -> None:
        super().__init__(state)
        self._rates, self._responses = _rates_and_responses(state)
        # If some motion leaves all intensities unchanged, the matrix of derivatives is singular.
        # Because of round-off it is not exactly singular, so its condition number is tested.
        neutral = (
            len(self.ends) > 0 and not SUM_ROUNDING * np.linalg.cond(self._rates.intensities) < 1.0
        )
        self._inverse = (
            np.full_like(self._rates.intensities, np.nan)
            if neutral
            else np.linalg.inv(self._rates.intensities)
        )

    def meeting(self, change: Array, tolerance: float = 0.0) -> Array:
        return np.asarray(self._inverse @ change)

    def local(self, k: Array) -> Array:
        return self.spread(np.abs(self._inverse) @ self.of(k))

    def rates(self, d: Array, tolerance: float = 0.0) -> tuple[Array, Array]:
        levels = self._rates.levels
        return self._rates.intensities @ d, levels @ d if levels.size else np.zeros(0)

    def responses(self, d: Array) -> list[Array]:
        """Changes of the unknowns that each of n motions (E, n) of the free ends causes.

        The response is the change of the density at fixed positions without its singular part.
        """
        return list((self._responses @ d).T)

    def growth(
        self, signs: Array, normal: Array | None = None, by_value: Array | None = None
    ) -> float:
        """Growth rate of motions of the free ends, if each end moves with the speed sign * K.
        It is the largest real part of the eigenvalues of d(sign * K)/d(motion), with the
        intensities K.

        With a condition on the ends, only motions that keep the condition count, and the unknown
        value of a side condition follows these motions. Then normal is the condition's derivative
        by the motions, and by_value the derivative of sign * K by the unknown value.
        """
        driven = signs[self.side][:, None] * self._rates.intensities
        if normal is not None and by_value is not None:
            driven = driven - np.outer(by_value, normal @ driven) / (normal @ by_value)
            along = np.linalg.svd(normal[None])[2][1:]
            driven = along @ driven @ along.T
        return float(np.linalg.eigvals(driven).real.max(initial=-np.inf))


def motions_of(state: State) -> DirectMotions | IteratedMotions:
    """Relations between motions of ends and changes of K, by a matrix or by iteration.

    They use iteration if the state was found by iteration.
    """
    return (
        DirectMotions(state) if state.iteration is None else IteratedMotions(state, state.iteration)
    )
