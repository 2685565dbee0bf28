r"""What motions of free ends do to edge intensities and levels: the singular densities that stand for them.

See `end_rates` for the formulas. A motion d of the right end of a zone of half width w leaves s S, s = -K d / (sqrt(2) w^(3/2)): the
coefficients -2 l s to all but the zone itself, the level -w s and a part of both K there.

Of very many ends with prescribed intensities there is no matrix of these rates: the unknowns of the response and the motions d of all
ends are found together,

    rows (y + singular densities of d) = 0,      K(y) + own K of d = change,

by GMRES: one fast sum a step, as for the equation itself. The preconditioner is that of the equation for y, and for d what a motion does
to its own zone alone, so that the number of steps does not grow with that of the zones.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from sie.basis.data import Array, record
from sie.basis.interval import edge_scale
from sie.collocation.fixed import State
from sie.collocation.iterative import Applied, Iterative, IterativeSystem
from sie.collocation.system import condition_rows
from sie.equation.conditions import Linear
from sie.fast.krylov import gmres


@record
class Moved:
    """coefficients: of the singular densities, as the rest sees them (unknowns, ...); own_level: what they do to their zones' own levels
    (Z, ...); own: and to the intensities at both ends of these (2, Z, ...)."""

    coefficients: Array
    own_level: Array
    own: Array

    @classmethod
    def of(cls, state: State, d: Array) -> Moved:
        """By outward motions d (2, Z, ...) of the left and right ends."""
        zones, layout = state.density.zones, state.system.layout
        more = (1,) * (d.ndim - 2)
        w = zones.half.reshape(-1, *more)
        k, slope = (np.array(part).reshape(2, -1, *more) for part in (state.density.intensities, state.density.edge_slopes))
        strength = -k * d / (np.sqrt(2.0) * w**1.5)
        zone = np.repeat(np.arange(len(zones)), layout.m + 1)
        order = (np.arange(layout.coefficients) - layout.offset[zone]).reshape(-1, *more)
        turned = 1.0 - 2.0 * (order % 2)
        coefficients = np.zeros((layout.size, *d.shape[2:]))
        coefficients[: layout.coefficients] = -2.0 * order * (strength[1][zone] + turned * strength[0][zone])
        root = strength * edge_scale(w)
        return cls(coefficients, -w * strength.sum(axis=0), 0.25 * root + 0.5 * root[::-1] - 0.5 * slope * d)


def free_ends(state: State) -> list[tuple[int, int]]:
    """(side, zone) of the ends that move, of mirrored pairs the right one."""
    zones = state.density.zones
    mirrored = int(zones.solved[0]) if zones.central else -1
    kinds = (zones.left, zones.right)
    return [
        (side, int(i)) for side in (0, 1) for i in zones.solved if kinds[side][i].moves and (side, i) != (0, mirrored)
    ]


def spread(state: State, ends: list[tuple[int, int]], values: Array) -> Array:
    """Values of ends (E, ...) as (2, Z, ...), mirrored ones filled in."""
    zones = state.density.zones
    out = np.zeros((2, len(zones), *values.shape[1:]))
    if not ends:
        return out
    side, zone = np.array(ends).T
    out[side, zone] = values
    if zones.symmetric:
        out[1 - side, len(zones) - 1 - zone] = values
    return out


# Steps of Arnoldi's method for the growth of a push, between two looks and at the most; it is known when it changes by less than a part.
_LOOK, _MOST, _KNOWN = 8, 64, 0.02
# To what motions are found, relative: what that leaves of a Newton step is for the next one. And to what responses are, for the growth.
STEP, _RESPONSE = 1e-6, 1e-4
# A residual that stays above this part: some motion leaves the intensities as they are.
_LOST = 1e-3


@record
class MovedView(Applied):
    """What conditions ask for, of a response and of singular densities."""

    moved: Moved
    response: Array

    def intensities(self) -> tuple[Linear, Linear]:
        left, right = self.edges
        nothing = np.zeros(len(left))
        return (left[:, None], nothing), (right[:, None], nothing)

    @cached_property
    def edges(self) -> Array:
        """K at both ends of the solved zones (2, n)."""
        layout = self.system.layout
        return np.array(self.system.intensities_of(layout.padded(self.response))) + self.moved.own[:, self.zones.solved]


class IteratedMotions:
    """At a state that was found by iteration."""

    def __init__(self, state: State, solver: Iterative) -> None:
        self.state, self.solver, self.system = state, solver, solver.system
        self.zones = state.density.zones
        self.ends = free_ends(state)
        place = {int(i): p for p, i in enumerate(self.zones.solved)}
        self.side = np.array([side for side, _ in self.ends], dtype=np.intp)
        self.zone = np.array([zone for _, zone in self.ends], dtype=np.intp)
        self.at = np.array([place[int(i)] for i in self.zone], dtype=np.intp)
        self.scale = solver.scale_of(state.folded_unknowns)
        self.width = self.zones.half[self.zone]

    def _applied(self, folded: Array, d: Array) -> tuple[Array, Array]:
        """(rows of the equation and of its conditions, K at the ends) by a response and by motions of the ends."""
        system: IterativeSystem = self.system
        moved = Moved.of(self.state, spread(self.state, self.ends, d))
        y = system.symmetry.unfold(folded)
        rows, plain = system.applied(y + moved.coefficients)
        # The rows hold what coefficients do to their own zone, which singular densities do not.
        rows = rows + moved.coefficients[system.own][system.kept]
        view = MovedView(system, plain.y, plain.middle, plain.rest + moved.own_level[self.zones.solved], moved, y)
        asked = condition_rows(system.equation, view, 1)[0][:, 0]
        return np.concatenate((rows, asked)), view.edges[self.side, self.at]

    @cached_property
    def _local(self) -> Array:
        """Inverse of what motions do to K at both ends of their own zone, by zone (Z, 2, 2)."""
        out = np.zeros((len(self.zones), 2, 2))
        for side in (0, 1):
            d = np.zeros((2, len(self.zones)))
            d[side] = 1.0
            out[:, :, side] = Moved.of(self.state, d).own.T
        moves = spread(self.state, self.ends, np.ones(len(self.ends))) > 0
        for side in (0, 1):
            held = ~moves[side]
            out[held, side], out[held, :, side] = 0.0, 0.0
            out[held, side, side] = 1.0
        central = int(self.zones.solved[0]) if self.zones.central else -1
        if central >= 0:
            # Both ends of the zone about the centre are one.
            out[central] = np.diag([1.0, out[central, 1].sum()])
        size = np.abs(out).max(axis=(1, 2), keepdims=True)
        weak = np.abs(np.linalg.det(out / size)) < 1e-3
        # A zone alone may turn or grow without a change of K: then it is the larger of both that counts.
        out[weak] = np.eye(2) * size[weak]
        return np.asarray(np.linalg.inv(out))

    def _by_zone(self, k: Array) -> Array:
        """Motions of the ends by which each zone alone changes K like this."""
        both = np.einsum("zab,bz->az", self._local, spread(self.state, self.ends, k))
        return np.asarray(both[self.side, self.zone])

    def local(self, k: Array) -> Array:
        """The same by the sizes of both (2, Z): how far K known to this leaves the ends uncertain."""
        return np.asarray(np.einsum("zab,bz->az", np.abs(self._local), k))

    def rates(self, d: Array, tolerance: float = 0.0) -> tuple[Array, Array]:
        """(K at `ends`, levels of the solved zones) by motions of the ends, the values of the side conditions held."""
        rows, own = self._applied(np.zeros(self.solver.size), d)
        folded = self.solver(-rows, None, tolerance)
        _, at_ends = self._applied(folded, d)
        levels = np.zeros(0)
        if self.system.wants_levels:
            moved = Moved.of(self.state, spread(self.state, self.ends, d))
            y = self.system.symmetry.unfold(folded)
            levels = self.system.level_changes(y + moved.coefficients) + moved.own_level[self.zones.solved]
        return at_ends, levels

    def meeting(self, change: Array, tolerance: float = STEP) -> Array:
        """Motions of the ends (E,) that change K there like this; not a number where none are found."""
        count = self.solver.size

        def precondition(rows: Array, k: Array) -> Array:
            folded = self.solver.preconditioner(rows)
            beside = np.array(self.system.intensities_of(self.system.layout.padded(self.system.symmetry.unfold(folded))))
            return np.concatenate((folded / self.scale, self._by_zone(k - beside[self.side, self.at]) / self.width))

        def apply(v: Array) -> Array:
            return precondition(*self._applied(v[:count] * self.scale, v[count:] * self.width))

        right = precondition(np.zeros(count), change)
        found = gmres(apply, right, tolerance * float(np.linalg.norm(right)))
        self.solver.iterations += found.steps
        if not found.residual <= max(_LOST, tolerance) * float(np.linalg.norm(right)):
            return np.full(len(self.ends), np.nan)
        return np.asarray(found.x[count:] * self.width)

    def amplification(self) -> float:
        """By how much motions of all ends together are larger than of each zone by itself, for changes of K at random: without bound where
        some motion leaves K as it is."""
        size = np.abs(np.linalg.inv(self._local)).max(axis=(1, 2))[self.zone] * self.width
        found = self.meeting(size * np.random.default_rng(1).standard_normal(len(self.ends)), _RESPONSE) / self.width
        return float(np.abs(found).max()) if np.all(np.isfinite(found)) else np.inf

    def growth(self, signs: Array, normal: Array | None = None, by_value: Array | None = None) -> float:
        """Largest real part of the eigenvalues of what drives the ends by their motions; see `newton`. By Arnoldi's method (W. E. Arnoldi,
        Quart. Appl. Math. 9 (1951) 17-29)."""
        driving = signs[self.side]

        def driven(d: Array) -> Array:
            out = driving * self.rates(d, _RESPONSE)[0]
            if normal is None or by_value is None:
                return np.asarray(out)
            return np.asarray(out - by_value * (normal @ out) / (normal @ by_value))

        def along(d: Array) -> Array:
            """The part that meets the condition on the ends."""
            return d if normal is None else np.asarray(d - normal * (normal @ d) / (normal @ normal))

        count = len(self.ends)
        v = along(np.random.default_rng(0).standard_normal(count))
        most = min(_MOST, count - (normal is not None))
        basis, h, last = [v / np.linalg.norm(v)], np.zeros((most + 1, most)), np.inf
        for k in range(most):
            w = driven(basis[k])
            size = float(np.linalg.norm(w))
            for _ in range(2):
                part = np.array([b @ w for b in basis])
                h[: k + 1, k] += part
                w = along(w - part @ np.array(basis))
            h[k + 1, k] = np.linalg.norm(w)
            # What is left is rounding of the responses: the space of the start is closed.
            whole = k + 1 == most or h[k + 1, k] <= 10 * _RESPONSE * size
            if whole or (k + 1) % _LOOK == 0:
                found = float(np.linalg.eigvals(h[: k + 1, : k + 1]).real.max())
                if whole or abs(found - last) <= _KNOWN * abs(found):
                    return found
                last = found
            basis.append(w / h[k + 1, k])
        return last
