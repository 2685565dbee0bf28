"""The gradient of one functional of a solution by all data of its problem, from one adjoint solve.

The functional is J = int w phi dx + sum c K + sum e x, with a weight w, factors c and e,
intensities K at singular ends and positions x of ends. Its derivative is a chain of linear maps of
`sie.results.derivative`:

    y0 = A^(-1) (r - P d),   lack = k - (kappa y0 + O d),   m = M lack,   y = y0 - A^(-1) P m,

with the right sides r of the changed data, motions d of fixed ends, changes k of prescribed
intensities and motions m of free ends. A is the matrix of the system. P and O are the direct
effects of motions on its rows and on the intensities at free ends. kappa maps unknowns to these
intensities, and M maps missing intensities to motions of free ends. If all prescribed intensities
of free ends are zero, y = y0. The adjoint applies the transposed maps in reverse order, so that two
solves with the transposed factors give the derivatives by all data at once.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from sie.basis import inputs
from sie.basis.data import Array
from sie.basis.kernels import Regular, Smooth
from sie.ends.motions import FreeEnds, Moved, SingularDensities, motions_of, rows_of_motions
from sie.equation.forcing import Forcing, Function
from sie.results.derivative import Change, Linearized, table_of
from sie.states.solve import SingularSystem, rows_of
from sie.states.state import State


@dataclass(frozen=True, eq=False)
class Functional:
    """A linear functional J = int weight(x) phi dx + sum intensities * K + sum ends * positions.
    It depends on the density phi, on its intensities K, and on the positions of the ends.

    phi: density; K: intensities of phi at singular ends.
    """

    weight: Callable[[Array], Array] | None
    intensities: Array
    ends: Array

    @classmethod
    def of(
        cls,
        state: State,
        weight: Callable[[Array], Array] | None,
        intensities: ArrayLike | None,
        ends: ArrayLike | None,
    ) -> "Functional":
        inputs.function("the weight", weight, optional=True)
        zones = state.density.zones
        if zones.symmetric:
            raise ValueError("a gradient needs zones that are all solved: use symmetric=False")
        of_k = table_of("intensities", intensities, (2, len(zones)))
        if np.any(of_k[~np.isnan(zones.intensities)]):
            raise ValueError(
                "intensities must be zero except at singular ends: at other ends the intensity is "
                "given"
            )
        return cls(weight, of_k, table_of("ends", ends, (len(zones), 2)))

    def of_density(self, linearized: Linearized) -> float:
        """Part of the functional, or of its derivative, due to high coefficients of the density.
        These follow from the right side alone and are no unknowns of the linear system.
        """
        system = linearized.system if linearized.changed is None else linearized.changed
        out = float((self.intensities * np.array(system.intensities_of(system.beyond))).sum())
        return out if self.weight is None else out + float(system.integrals(self.weight)[1].sum())


@dataclass(frozen=True, eq=False)
class _Adjoint:
    """Derivatives of a linear functional by the data of the linearised problem.

    rows: by the right side of each row of the system; outward: by outward motions of the ends (2,
    Z); lack: by the missing intensity of each free end.
    """

    rows: Array
    outward: Array
    lack: Array


@dataclass(frozen=True, eq=False)
class Gradient:
    """The derivatives of a functional of the solution by all data of a problem.
    `Solution.gradient` makes it.

    Calling it with a change of the right side, or of the kernel as second argument, returns the
    derivative of the functional by this change.

    Attributes
    ----------
    values : tuple of ndarray
        Derivatives by the values of each condition's rows; conditions on the ends come last. For
        the condition whose value is unknown they are not defined, and set to zero.
    ends : (n, 2) array
        Derivatives by the positions of the fixed ends; zero for free ends.
    intensities : (2, n) array
        Derivatives by the prescribed intensities; zero for singular ends.

    Examples
    --------
    A crack [-a, a] has the intensity K = -sqrt(a / 2) at its left end. This K is differentiated by
    the positions of both ends.

    >>> import numpy as np, sie
    >>> crack = sie.Equation(sie.cauchy(), np.ones_like, sie.ZoneTotals(0.0))
    >>> found = sie.solve(crack, sie.Zones.of([[-2.0, 2.0]], sie.SINGULAR, sie.SINGULAR))
    >>> by_data = found.gradient(intensities=[[1.0], [0.0]])
    >>> np.abs(by_data.ends).round(12).tolist(), float(round(by_data(np.ones_like), 12))
    ([[0.125, 0.125]], 1.0)
    """

    values: tuple[Array, ...]
    ends: Array
    intensities: Array
    _state: State = field(repr=False)
    _functional: Functional = field(repr=False)
    _adjoint: _Adjoint = field(repr=False)

    def __call__(
        self, dg: Forcing | Function | None = None, dkernel: Smooth | Regular | None = None
    ) -> float:
        """Derivative of the functional for changes dg of the right side, dkernel of the kernel."""
        state, adjoint = self._state, self._adjoint
        with np.errstate(all="ignore"):
            changed = Linearized(state, Change.of(state, dg, dkernel=dkernel))
        system = changed.changed
        if system is None:
            return 0.0
        known = np.array(system.intensities_of(system.beyond))
        free = FreeEnds(state)
        out = adjoint.rows @ changed.right - adjoint.lack @ free.of(known)
        return float(out + self._functional.of_density(changed))


class Adjoint:
    """The transposes of the linear maps that give the derivative of one solution.
    With them one solve gives the derivatives of a functional by all data.
    """

    def __init__(self, state: State) -> None:
        self.state, self.zones, self.free = state, state.density.zones, FreeEnds(state)
        count = len(self.zones)
        each = np.eye(2 * count).reshape(2, count, -1)
        self.moved = Moved.of(state, each)
        self.own = self.moved.own.reshape(2 * count, -1)
        self.of_motions = rows_of_motions(state, rows_of(state), self.moved)
        (left, _), (right, _) = state.system.intensities()
        self.intensities = np.array([left, right])
        free = self.free
        slopes = free.of(np.array(state.density.edge_slopes))
        if self.zones.follow_ends:
            self.motions = motions_of(state).meeting(np.eye(len(free.ends)))
        else:
            self.motions = np.diag(self.zones.weight.end_step(-1.0, slopes))
        if not np.isfinite(self.motions).all():
            raise SingularSystem("the intensities do not determine the ends")

    def back(self, q: Array, s: Array, e: Array) -> _Adjoint:
        """Derivatives of q y + s d + e m, a linear function of the solution, by the data.
        s and e have the shape (2, Z).

        y are the unknowns. d are the motions of the ends that cause singular densities. m are the
        motions of all ends.
        """
        state, zones, free = self.state, self.zones, self.free
        factors = state.direct
        assert factors is not None
        at_free = free.side * len(zones) + free.zone
        by_motion = free.of(e)
        if zones.follow_ends:
            through_rows = factors.transposed(q) @ self.of_motions
            by_motion = by_motion + free.of(s) - through_rows[at_free]
        lack = self.motions.T @ by_motion
        rows = factors.transposed(q - lack @ self.intensities[free.side, free.zone])
        outward = (s + e).ravel() - rows @ self.of_motions - lack @ self.own[at_free]
        return _Adjoint(rows, outward.reshape(s.shape), lack)

    def of(self, functional: Functional) -> tuple[_Adjoint, float]:
        """Derivatives of a functional by the data of the problem, and by the value of the condition
        on the ends.
        """
        state, zones = self.state, self.zones
        q = np.einsum("ab,abn->n", functional.intensities, self.intensities)
        s = functional.intensities.ravel() @ self.own
        if functional.weight is not None:
            q = q + state.system.integrals(functional.weight)[0].sum(axis=0)
            singular = SingularDensities(state.system, self.moved)
            s = s + singular.integrals(functional.weight)[0].sum(axis=0)
        outward = functional.ends.T * [[-1.0], [1.0]]
        found = self.back(q, s.reshape(outward.shape), outward)
        opened = state.equation.open_condition
        if opened is None:
            return found, 0.0
        unit = state.right_of(state.values(opened))
        normal = np.array(state.equation.end_conditions[0].residual(zones)[1:])
        of_ends = self.back(np.zeros_like(q), np.zeros_like(normal), normal)
        factor = float(found.rows @ unit) / float(of_ends.rows @ unit)
        if not np.isfinite(factor):
            raise SingularSystem(
                "the unknown value of the side condition has no effect on the condition on the ends"
            )
        return (
            _Adjoint(
                found.rows - factor * of_ends.rows,
                found.outward - factor * of_ends.outward,
                found.lack - factor * of_ends.lack,
            ),
            factor,
        )

    def gradient(self, functional: Functional) -> Gradient:
        state, zones, free = self.state, self.zones, self.free
        found, of_ends = self.of(functional)
        by_rows = found.rows[state.conditions_from :] / state.condition_scale
        values, first = [], 0
        for condition in state.equation.conditions:
            rows = by_rows[first : first + condition.count(zones)]
            values.append(np.zeros_like(rows) if condition.open else rows)
            first += len(rows)
        values += [np.array([of_ends]) for _ in state.equation.end_conditions]
        k = np.zeros((2, len(zones)))
        k[free.side, free.zone] = found.lack
        for side, places in enumerate(zones.fixed_bounded):
            for p in places:
                k[side, zones.solved[p]] = by_rows[first]
                first += 1
        ends = np.where(zones.moves, 0.0, found.outward * [[-1.0], [1.0]]).T
        return Gradient(tuple(values), ends, k, state, functional, found)
