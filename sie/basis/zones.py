"""Zones: disjoint ascending intervals [a, b], each with the kinds of its two ends.

At a distance d from an end the density is K / sqrt(d) + A sqrt(d). A *singular* end leaves K
unknown. A *bounded* end has K = 0 (or a prescribed K) at a given place. A *free* end has a given K
(zero, or a prescribed intensity) at an unknown place. At an end with a *value* v, the density is
K / sqrt(d) + v + A sqrt(d). A zone with two singular ends has index 1 and needs one side condition.
Each end that is not singular, but bounded or free, lowers this index by one. A free end also adds
one unknown, its position (Muskhelishvili, Singular Integral Equations, 1953, ch. 5).
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from sie.basis import inputs
from sie.basis.data import EPS, TINY, Array, Index, Kept, Mask, sum_error
from sie.basis.weight import HALF, Weight


@dataclass(frozen=True)
class End:
    """One end of a zone: whether it moves, and how the density behaves there.

    Parameters
    ----------
    moves : bool
        Whether the position is unknown.
    intensity : float or None
        The prescribed coefficient K at the end; None if K is unknown (a singular end).
    value : float
        The term v of the density K / sqrt(d) + v + A sqrt(d) at the distance d from the end.
    until : float or None
        For an end with a value: the position up to which the density keeps this value beyond the
        end (on a plateau); None: up to the next zone.

    Raises
    ------
    ValueError
        If the end moves and has no intensity, or a number is not finite.

    Examples
    --------
    >>> import sie
    >>> sie.BOUNDED, sie.FREE.moves
    (End(moves=False, intensity=0.0, value=0.0, until=None), True)
    """

    moves: bool
    intensity: float | None = 0.0
    value: float = 0.0
    until: float | None = None

    def __post_init__(self) -> None:
        inputs.number("the value at an end", self.value)
        if self.until is not None:
            inputs.number("until", self.until)
        if self.intensity is not None:
            inputs.number("the intensity of an end", self.intensity)
        if self.moves and self.intensity is None:
            raise ValueError(
                "an end of unknown position needs a prescribed intensity (0.0 for a free end)"
            )

    @property
    def surplus(self) -> int:
        """Number of unknowns minus number of equations that this end adds.
        It is 0 for a fixed bounded end.
        """
        return 1 if self.moves or self.intensity is None else 0


FREE = End(moves=True)
BOUNDED = End(moves=False)
SINGULAR = End(moves=False, intensity=None)


def free_with_intensity(intensity: float) -> End:
    """A free end with the density `intensity / sqrt(d)` at a small distance d.

    Examples are the edge of an adhesive contact and a crack tip at the limit of its toughness.

    Parameters
    ----------
    intensity : float
        K; zero is `FREE`.

    Returns
    -------
    End

    Examples
    --------
    A line contact that adheres, K = -0.1, a = 1: load = pi a^2 / 2 + pi K sqrt(2 a) (M. Barquins,
    J. Adhesion 26, 1988, 1-12).

    >>> import numpy as np, sie
    >>> load = np.pi * (0.5 - 0.1 * np.sqrt(2))
    >>> adhering = sie.Equation(sie.cauchy(), sie.Forcing(lambda x: x), (sie.Total(load),))
    >>> end = sie.free_with_intensity(-0.1)
    >>> sie.solve(adhering, sie.Zones.of([[-0.9, 1.05]], end, end)).zones.table.round(9).tolist()
    [[-1.0, 1.0]]
    """
    return End(moves=True, intensity=inputs.number("the intensity of an end", intensity))


def free_with_value(value: float, until: float | None = None) -> End:
    """A free end near which the density is `value` plus a multiple of sqrt(d), d the distance.

    Beyond the end the density keeps this value: on a *plateau*, which ends at the next zone (whose
    end must have the same value) or at a given place. Examples are the edge of a yielded part of a
    contact, where the pressure has reached its limit, and the edge of a saturated band. The plateau
    is a part of the density: it counts in values, transforms, total and moments.

    Parameters
    ----------
    value : float
        v; in the zone, the density near the end is nearer to zero than v.
    until : float or None
        Where the plateau ends; None: at the next zone.

    Returns
    -------
    End

    Examples
    --------
    A flat punch of half width 2 whose pressure is limited to 1 is elastic on |x| < c, and the load
    is 2 sqrt(4 - c^2).

    >>> import numpy as np, sie
    >>> punch = sie.Equation(sie.cauchy(), np.zeros_like, sie.Total(2 * np.sqrt(3)))
    >>> ends = sie.free_with_value(1.0, until=-2.0), sie.free_with_value(1.0, until=2.0)
    >>> found = sie.solve(punch, sie.Zones.of([[-0.5, 1.5]], *ends))
    >>> found.zones.table.round(9).tolist(), found.density(1.5)
    ([[-1.0, 1.0]], array(1.))
    """
    return End(True, 0.0, inputs.number("the value at an end", value), until)


def bounded_with_value(value: float, until: float | None = None) -> End:
    """An end at a given place at which the density has a given value, see `free_with_value`.

    Parameters
    ----------
    value : float
        v.
    until : float or None
        Where the plateau beyond the end ends; None: at the next zone.

    Returns
    -------
    End

    Examples
    --------
    >>> import sie
    >>> sie.bounded_with_value(2.0).moves
    False
    """
    return End(False, 0.0, inputs.number("the value at an end", value), until)


# Largest accepted relative difference between symmetric data and their mirror images. It is well
# above round-off.
MAX_ASYMMETRY = 1e-6


def _kinds(ends: End | Sequence[End], count: int, side: str) -> tuple[End, ...]:
    """The checked kinds of `count` ends, from one kind for all ends or one for each end."""
    kinds = (ends,) * count if isinstance(ends, End) else inputs.several(ends)
    if not all(isinstance(kind, End) for kind in kinds):
        known = (
            "sie.FREE, sie.SINGULAR, sie.BOUNDED, sie.free_with_intensity(K) or "
            "sie.free_with_value(v)"
        )
        raise ValueError(f"{side}: kinds of ends must be {known}, got {inputs.shown(ends)}")
    if len(kinds) != count:
        raise ValueError(f"{side}: got {len(kinds)} kinds of ends for {count} zones")
    return kinds


@dataclass(frozen=True, eq=False)
class Zones(Kept):
    """`n` zones with ends a (n,) and b (n,), a < b < next a; `Zones.of` makes and checks them.

    Parameters
    ----------
    a, b : ndarray
        Left and right ends (n,).
    left, right : sequence of End
        Kinds of the ends, one for each zone.
    symmetric : bool
        Whether the zones and the data are mirror images about x = 0; then only half is solved.
    rest : ndarray
        Round-off of the ends (2, n): the exact ends are a + rest[0] and b + rest[1]. An end may be
        nearer to a corner of the right side than the digits of its position show.
    weight : Weight
        The exponents of a density at the ends of the zones. `solve` sets them from the equation.
    depth : ndarray
        Logarithm (n,) of the true width of a rim divided by b - a, see `sie.ends.rims`; 0 for other
        zones. A rim is a zone whose density has two different given values at its ends.

    Examples
    --------
    >>> import sie
    >>> zones = sie.Zones.of([[0.0, 1.0], [1.5, 2.0]], left=sie.SINGULAR, right=sie.BOUNDED)
    >>> len(zones), zones.middle.tolist(), zones.half.tolist()
    (2, [0.5, 1.75], [0.5, 0.25])
    """

    a: Array
    b: Array
    left: Sequence[End] = field(default=())
    right: Sequence[End] = field(default=())
    symmetric: bool = False
    rest: Array = field(default_factory=lambda: np.zeros((2, 0)))
    weight: Weight = field(default=HALF, repr=False)
    depth: Array = field(default_factory=lambda: np.zeros(0), repr=False)

    def __post_init__(self) -> None:
        if self.rest.shape[1] != len(self.a):
            object.__setattr__(self, "rest", np.zeros((2, len(self.a))))
        if len(self.depth) != len(self.a):
            object.__setattr__(self, "depth", np.zeros(len(self.a)))

    @classmethod
    def of(
        cls,
        ends: ArrayLike,
        left: End | Sequence[End] = FREE,
        right: End | Sequence[End] = FREE,
        symmetric: bool = False,
    ) -> "Zones":
        """Checked zones from an (n, 2) array of ends.

        left, right: one kind of end for all zones, or one for each.

        Raises
        ------
        ValueError
            If ends are not finite and strictly ascending, or symmetric zones not mirror images.
        """
        table = inputs.table_of("zones", ends)
        if table.ndim != 2 or table.shape[1] != 2 or table.shape[0] == 0:
            raise ValueError(f"zones must have shape (n, 2) with n >= 1, got {table.shape}")
        flat = table.ravel()
        if not np.all(np.isfinite(flat)) or np.any(flat[1:] <= flat[:-1]):
            raise ValueError(
                "zone ends must be finite and strictly ascending: a0 < b0 < a1 < b1 < ..."
            )
        with np.errstate(over="ignore"):
            if not np.isfinite(flat[-1] - flat[0]) or np.any(table[:, 1] - table[:, 0] < TINY):
                raise ValueError(
                    f"zones must be wider than {TINY:g}, and the distance between the first and "
                    "the last end must be finite: choose another unit of length"
                )
        count = table.shape[0]
        lefts, rights = _kinds(left, count, "left"), _kinds(right, count, "right")
        if symmetric:
            mirrored = -table[::-1, ::-1]
            if np.any(np.abs(table - mirrored) > MAX_ASYMMETRY * (table[:, 1:] - table[:, :1])):
                raise ValueError("symmetric zones must be mirror images of each other about x = 0")
            if lefts != rights[::-1]:
                raise ValueError("symmetric zones need the same kind of end on both sides")
            table = 0.5 * (table + mirrored)
        return cls(table[:, 0], table[:, 1], lefts, rights, symmetric)

    def moved(self, outward: Array, exactly: bool = True) -> "Zones":
        """The zones after each end has moved outward by its entry of `outward` (2, n).

        exactly: whether the round-off of the new ends is kept in `rest`.
        """
        if self.symmetric:
            outward = 0.5 * (outward + outward[::-1, ::-1])
        ends, by = np.array([self.a, self.b]), np.array([-outward[0], outward[1]]) + self.rest
        a, b = ends + by
        return replace(self, a=a, b=b, rest=sum_error(ends, by) if exactly else np.zeros_like(by))

    def changed(self, lost: Index, met: Index, period: float | None) -> "tuple[Zones, Index]":
        """(zones that remain after some have vanished or merged, former indices of these zones).

        lost: indices of the zones that have vanished; met: indices of zones that have merged with
        the next one. A merged zone keeps the index of its first part.
        """
        count = len(self)
        kept = np.setdiff1d(np.arange(count), np.union1d(lost, (np.asarray(met) + 1) % count))
        last, meets = kept.copy(), np.isin(np.arange(count), met)
        while np.any(meets[last % count]):
            last = last + meets[last % count]
        turns, last = last // count, last % count
        b = self.b[last] + (0.0 if period is None else turns * period)
        left, right = [self.left[i] for i in kept], [self.right[i] for i in last]
        rest = np.array([self.rest[0, kept], self.rest[1, last]])
        weight = self.weight.of(kept)
        return replace(
            self,
            a=self.a[kept],
            b=b,
            left=left,
            right=right,
            rest=rest,
            weight=weight,
            depth=self.depth[kept],
        ), kept

    def beyond_a(self, x: Array, zone: Index) -> Array:
        """Distances x - a of points x from the left ends a of zones; negative to the left of a."""
        return np.asarray((x - self.a[zone]) - self.rest[0][zone])

    def before_b(self, x: Array, zone: Index) -> Array:
        """Distances b - x of points x from right ends b of zones; negative to the right of b."""
        return np.asarray((self.b[zone] - x) + self.rest[1][zone])

    def __len__(self) -> int:
        return len(self.a)

    @property
    def table(self) -> Array:
        """Ends of the zones, as an array (n, 2)."""
        return np.column_stack((self.a, self.b))

    @cached_property
    def half(self) -> Array:
        """Half widths w of the zones (n,)."""
        return np.asarray(0.5 * ((self.b - self.a) + (self.rest[1] - self.rest[0])))

    @cached_property
    def true_half(self) -> Array:
        """Half widths of the zones (n,), the true ones also for rims.
        A rim is a zone whose density has two different given values at its ends. Rims are computed
        with a larger width than the true one (see `depth`).
        """
        return np.asarray(self.half * np.exp(np.maximum(self.depth, np.log(EPS))))

    @property
    def edge_scale(self) -> Array:
        """Intensity K of the density 1 / sqrt(1 - t^2) at the ends of each zone (n,).
        K is the coefficient of 1 / sqrt(d), with the distance d from the end.

        For an equation with kappa it is given for each left and right end (2, n), see `Weight`.
        """
        return np.asarray(self.weight.edge_scale(self.half))

    @property
    def slope_scale(self) -> Array:
        """The edge slope A of sqrt(1 - t^2) on each zone (n,) or end (2, n).
        A is the coefficient of sqrt(d), with the distance d from the end. With kappa, see `Weight`.
        """
        return np.asarray(self.weight.slope_scale(self.half))

    @cached_property
    def middle(self) -> Array:
        """Middles of the zones (n,)."""
        return 0.5 * (self.a + self.b)

    @cached_property
    def solved(self) -> Index:
        """Indices of the zones whose equations are solved.
        These are all zones or, of symmetric zones, the right half.
        """
        return np.arange(len(self) // 2, len(self)) if self.symmetric else np.arange(len(self))

    @cached_property
    def fixed_bounded(self) -> tuple[list[int], list[int]]:
        """Positions in `solved` of zones with a fixed bounded end, as two lists.
        The first list is for left ends, the second for right ends.
        """
        left, right = (
            [
                p
                for p, i in enumerate(self.solved)
                if not ends[i].moves and ends[i].intensity is not None
            ]
            for ends in (self.left, self.right)
        )
        # The left end of the zone that contains x = 0 is the mirror image of the right end of this
        # zone. This left end is therefore not counted.
        return [p for p in left if not (self.central and p == 0)], right

    @cached_property
    def moves(self) -> Mask:
        """Whether each left and each right end moves (2, n)."""
        return np.array([[end.moves for end in ends] for ends in (self.left, self.right)])

    @cached_property
    def intensities(self) -> Array:
        """Prescribed intensities K at left and right ends (2, n); NaN where none is prescribed.
        K is the coefficient of 1 / sqrt(distance from the end).
        """
        return np.array(
            [
                [np.nan if end.intensity is None else end.intensity for end in ends]
                for ends in (self.left, self.right)
            ]
        )

    @cached_property
    def values(self) -> Array:
        """Prescribed values of the density at left and right ends (2, n); zero if there is none."""
        return np.array([[end.value for end in ends] for ends in (self.left, self.right)])

    @cached_property
    def have_values(self) -> bool:
        """Whether a value of the density other than zero is prescribed at any end."""
        return any(
            end.value != 0.0 for end in {id(e): e for e in (*self.left, *self.right)}.values()
        )

    @cached_property
    def rims(self) -> Mask:
        """Whether each zone has two free ends with different values (n,), as beside a plateau.

        Such a zone never vanishes: the density passes from one value to the other.
        """
        values = self.values
        return np.asarray((values[0] != values[1]) & self.moves.all(axis=0))

    @property
    def bounded(self) -> Mask:
        """Whether the density is bounded at each left and right end (2, n).
        There the prescribed coefficient K of 1 / sqrt(distance) is zero.
        """
        return np.asarray(self.intensities == 0.0)

    @property
    def follow_ends(self) -> bool:
        """Whether any moving end has a prescribed intensity K other than zero.
        K is the coefficient of 1 / sqrt(distance from the end).

        Then a motion of the end changes the density at first order.
        """
        return any(end.moves and end.intensity != 0.0 for end in (*self.left, *self.right))

    @property
    def central(self) -> bool:
        """Whether the zones are symmetric and one of these zones contains the centre x = 0."""
        return self.symmetric and len(self) % 2 == 1
