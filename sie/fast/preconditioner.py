"""Two-level preconditioner: the diagonal part of each zone's rows, and a coarse problem."""

import numpy as np

from sie.basis.data import Array
from sie.equation.conditions import by_zone, speaks_of_levels
from sie.fast.coarse import CoarseOperator
from sie.fast.system import Applied, IterativeSystem


class TwoLevelPreconditioner:
    """Approximate inverse of the system of equations, for an iterative solution.
    It neglects how the field of one zone varies over another zone.

    The coefficients c_k with k > 0 follow from the rows of the equation. The coefficients c_0 and
    the amplitudes of the columns follow from the side conditions. The levels of the zones (the
    constant parts of the potential) are C c_0 plus an unknown constant, minus the means of the
    columns' primitives. Here C is the matrix of `CoarseOperator`. Its inverse gives c_0 from the
    levels, up to the few unknowns: the constant and the amplitudes. They follow from the conditions
    that do not belong to single zones. If every zone has a fixed end with a prescribed intensity K,
    c_0 follows from K.
    """

    def __init__(self, system: IterativeSystem, coarse: CoarseOperator | None) -> None:
        self.system, self.coarse = system, coarse
        zones, conditions = system.zones, system.equation.conditions
        counts = [c.count(zones) for c in conditions]
        starts = np.concatenate(([0], np.cumsum(counts)))
        kinds = [by_zone(c, zones) for c in conditions]
        self.others = [k for k, kind in enumerate(kinds) if kind is None]
        self.other_rows = np.concatenate(
            [np.arange(starts[k], starts[k + 1]) for k in self.others]
            or [np.zeros(0, dtype=np.intp)]
        )
        self.held = np.array(sum(zones.fixed_bounded, []), dtype=np.intp)
        at = next((k for k, kind in enumerate(kinds) if kind is not None), None)
        self.own, self.levels = system.of_zones, system.levelled
        # `rows` are the rows of the side condition that has one row for each zone (`ByZone`).
        # Without such a condition, they are the rows of the intensities prescribed at fixed ends,
        # which come last.
        self.rows = (
            slice(int(starts[-1]), None)
            if at is None
            else slice(int(starts[at]), int(starts[at + 1]))
        )
        self.absolute = self.own is not None and not self.own.differences
        # `closed` is the side condition that has one row for each zone; None if there is no such
        # condition, or if it is a condition on potentials.
        self.closed = None if at is None or self.levels else conditions[at]
        self.seen = any(speaks_of_levels(conditions[k], zones) for k in self.others)
        layout, symmetry = system.layout, system.symmetry
        self.first = symmetry.position(layout.offset[zones.solved])
        self.rest = symmetry.position(system.diagonal)
        self.amplitudes = symmetry.position(layout.coefficients + np.arange(layout.columns))
        self._basis = self._responses()
        self._small = np.zeros((self._basis.shape[1],) * 2)
        for k, column in enumerate(self._basis.T):
            self._small[:, k] = self._scalars(column)

    def _responses(self) -> Array:
        """Changes of the unknowns for a unit of the levels' common constant and of each amplitude.
        A level is the constant part of the potential on a zone. An amplitude is the unknown factor
        of one of the equation's additional functions (columns).

        There is one column for each amplitude. If the levels share an unknown constant, the column
        for this constant comes first.
        """
        system, with_constant = self.system, int(self.levels)
        out = np.zeros((system.symmetry.size, system.layout.columns + with_constant))
        if with_constant:
            self._close(out[:, 0], np.ones(len(self.first)))
        for k, column in enumerate(out.T[with_constant:]):
            column[self.amplitudes[k]] = 1.0
            column[self.rest] = -system.column_rows[k][system.kept]
            self._close(
                column, system.column_means[k] if self.levels else np.zeros(len(self.first))
            )
        return out

    def _close(self, folded: Array, wanted: Array) -> None:
        """Set, in `folded`, each zone's coefficient c_0 of the density so that it gives `wanted`.
        `wanted` has the values of the side condition with one row for each zone, or the levels of
        the zones (the constant parts of the potential), or the intensities at fixed ends.
        """
        system = self.system
        if self.levels:
            assert self.coarse is not None
            folded[self.first] = self.coarse.inverse(wanted)
            return
        view = Applied(system, system.symmetry.unfold(folded), np.zeros(0), np.zeros(0))
        if self.own is not None and self.closed is not None:
            folded[self.first] = (wanted - self.closed.rows(view)[0][:, 0]) / self.own.first
            return
        scale = system.zones.edge_scale[system.zones.solved[self.held]]
        folded[self.first[self.held]] = (wanted - view.held()[0][:, 0]) / scale

    def _scalars(self, folded: Array) -> Array:
        """Left sides of the side conditions that act on several zones, for given unknowns.
        If levels share an unknown constant, the left side of the equation for this constant comes
        last. A level is the constant part of the potential on a zone.
        """
        system = self.system
        y = system.symmetry.unfold(folded)
        view = system.applied(y)[1] if self.seen else Applied(system, y, np.zeros(0), np.zeros(0))
        out = [
            float(row)
            for k in self.others
            for row in system.equation.conditions[k].rows(view)[0][:, 0]
        ]
        if self.levels and self.absolute:
            assert self.coarse is not None
            solved = system.zones.solved
            total = float((system.multiplicity() * system.zones.half[solved]) @ folded[self.first])
            # The levels (constant parts of the potential on the zones) share an unknown constant.
            # In the equation for this constant, the constant itself has the coefficient 1. This 1
            # is not part of the result: `__call__` adds it to a copy of `_small`.
            out.append(self.coarse.lowered * total)
        return np.array(out)

    def __call__(self, right: Array) -> Array:
        system = self.system
        equations = len(self.rest)
        conditions = right[equations:]
        here = conditions[self.rows]
        out = np.zeros(system.symmetry.size)
        out[self.rest] = -right[:equations]
        if self.own is not None and self.levels:
            here = (
                here / self.own.levels
                if self.absolute
                else np.concatenate(([0.0], np.cumsum(here / self.own.levels)))
            )
        self._close(out, here)
        if self._basis.shape[1]:
            small, wanted = self._small.copy(), conditions[self.other_rows]
            missing = self._scalars(out)
            if self.levels and self.absolute:
                wanted = np.append(wanted, 0.0)
                small[-1, 0] += 1.0
            out += self._basis @ np.linalg.solve(small, wanted - missing)
        return out
