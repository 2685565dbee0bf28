"""The right side g as data: its function, its jumps, and how finely it must be resolved."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from sie.basis import inputs
from sie.basis.data import Array, Index, Kept
from sie.basis.kernels import Kernel
from sie.basis.weight import needs_half
from sie.basis.zones import Zones
from sie.jumps.density import DensityJumps
from sie.jumps.formulas import HIGHEST
from sie.jumps.logarithms import Logarithms
from sie.jumps.poles import AlgebraicPoints, Poles
from sie.jumps.right_side import ForcingJumps

Function = Callable[[Array], Array]


def _for_each(name: str, count: int, values: Any) -> Array:
    """Checked numbers (count,), one for each jump; a single number stands for all jumps."""
    table = inputs.numbers(name, values)
    if len(table) == 1 and count > 1 and np.ndim(values) == 0:
        return np.full(count, table[0])
    if len(table) != count:
        raise ValueError(
            f"{name} must be one number for each position, or one number for all positions, got "
            f"{len(table)} numbers for {count} positions"
        )
    return table


def _orders(name: str, count: int, values: Any) -> Index:
    """Checked orders of jumps (count,); a single order stands for all jumps."""
    if np.ndim(values) == 0 and values == 0:
        return np.zeros(count, dtype=np.intp)
    if (
        isinstance(values, np.ndarray)
        and values.dtype == np.intp
        and values.shape == (count,)
        and (values <= HIGHEST).all()
    ):
        return values
    table = _for_each(name, count, values)
    if not np.isin(table, np.arange(HIGHEST + 1)).all():
        raise ValueError(
            f"{name} must be 0, 1 or 2 (the order of the derivative that jumps), got "
            f"{inputs.shown(values)}; leave out jumps of higher derivatives"
        )
    return table.astype(np.intp)


def _interval(name: str, values: Any) -> tuple[float, float]:
    """The argument as a checked interval (lo, hi) with lo < hi; both ends may be infinite."""
    table = inputs.table_of(name, values)
    if table.shape != (2,) or not table[0] < table[1]:
        raise ValueError(
            f"{name} must be two numbers (lo, hi) with lo < hi, infinite where there is no limit, "
            f"got {inputs.shown(values)}"
        )
    return float(table[0]), float(table[1])


@dataclass(frozen=True, eq=False)
class Jumps(Kept):
    """Points at which the right side g, or the wanted density, is not smooth.

    If the kernel has a period, all positions repeat with it.

    Parameters
    ----------
    at : array_like
        Positions s of jumps (k,).
    heights : array_like
        Heights g^(q)(s+) - g^(q)(s-), or those of the density's derivatives: (k,), or one for all.
    orders : array_like
        Orders q (0, 1 or 2) of the derivatives that jump: (k,), or one for all.
    of_density : bool
        Whether the wanted density jumps, and not g. A jump J of the density gives g a term
        (J/pi) (x - s)^q ln|x - s| / q!. For q = 0 this term is (J/pi) Lambda(x, s), where Lambda is
        the kernel's potential, and `Forcing.value` must not contain it. The flag holds for
        `algebraic` too: then g contains the transform of the powers.
    spline : callable or None
        A quadratic spline with the jumps of order 2, if it is known and g has other terms, too.
        With hundreds of jumps, the values of the spline keep digits that a sum over the jumps
        loses.
    algebraic : AlgebraicPoints or None
        Points near which g, or the wanted density, is a power of the distance.
    singular_at : array_like
        Singular points of g between the zones (k,). The first number of nodes on a zone follows
        from its distance to these points. Narrow gaps are then not treated as slits.

    Raises
    ------
    ValueError
        If positions, heights or orders are not numbers, if their numbers differ, or if an order is
        not 0, 1 or 2.

    Examples
    --------
    >>> import sie
    >>> sie.Jumps([0.0, 1.0], heights=2.0, orders=1).heights.tolist()
    [2.0, 2.0]
    """

    at: Array = field(default_factory=lambda: np.zeros(0))
    heights: Array = field(default_factory=lambda: np.zeros(0))
    orders: Index | int = 0
    of_density: bool = False
    spline: Function | None = None
    algebraic: AlgebraicPoints | None = None
    singular_at: Array = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        keep = partial(object.__setattr__, self)
        places = inputs.numbers("jumps: at", self.at)
        keep("at", places)
        keep("heights", _for_each("jumps: heights", len(places), self.heights))
        keep("orders", _orders("jumps: orders", len(places), self.orders))
        keep("singular_at", inputs.numbers("jumps: singular_at", self.singular_at))

    def __len__(self) -> int:
        return len(self.at)

    @cached_property
    def of_order_zero(self) -> tuple[Array, Array]:
        """(positions, heights) of the jumps of order 0: those of the function itself."""
        which = np.asarray(self.orders) == 0
        return self.at[which], self.heights[which]

    @cached_property
    def broken_at(self) -> Array:
        """Positions of the jumps (`at`) and of the points s of algebraic terms |x - s|^p."""
        points = () if self.algebraic is None else np.asarray(self.algebraic.at)
        return np.concatenate((self.at, points))


NO_JUMPS = Jumps()


@dataclass(frozen=True)
class Resolution:
    """Resolution that a function on the right side needs, and accuracy of its values.

    Parameters
    ----------
    modes : int or None
        Number of modes of a column (1: a constant). None: the number grows until the column is
        resolved.
    length : float or None
        Smallest length over which a smooth g varies. If it is given and there are many zones,
        differences of the primitive between zones are computed as integrals of g. They keep digits
        that the primitive loses.
    rounding : float
        Standard deviation of the noise of `Forcing.value`, in the unit of g. Coefficients of g need
        not fall below this noise.
    rounded_place : callable or None
        Function from x to the place at which `Forcing.value` really evaluates g, after its own
        round-off; None: x itself. Narrow zones far from the origin need this function.
    exact_places : bool
        Whether `Forcing.value` uses every digit of x. Then ends of zones keep more digits than a
        floating-point position has.
    smooth_between : bool
        Whether a column is as smooth between the zones as on them. Only then may narrow gaps be
        treated as slits.

    Raises
    ------
    ValueError
        If `modes` is no positive whole number, or `length` no positive number.

    Examples
    --------
    >>> import numpy as np, sie
    >>> sie.Forcing(np.ones_like, resolution=sie.Resolution(modes=1)).resolution.modes
    1
    """

    modes: int | None = None
    length: float | None = None
    rounding: float = 0.0
    rounded_place: Function | None = None
    exact_places: bool = False
    smooth_between: bool = False

    def __post_init__(self) -> None:
        if self.modes is not None:
            inputs.whole("modes", self.modes, 1)
        if self.length is not None:
            inputs.positive("resolution: length", self.length)


UNRESOLVED = Resolution()


@dataclass(frozen=True, eq=False)
class Forcing(Kept):
    """The right side g of the equation, or another known function on the right side.

    Parameters
    ----------
    value : callable
        g(x), x of any shape; smooth on each zone except at the declared jumps.
    primitive : callable or None
        An antiderivative of g, continuous over all zones. Only conditions on potentials need it.
    jumps : Jumps
        Places where g, or the wanted density, is not smooth.
    resolution : Resolution
        Number of modes, noise and rounding of the values, where known.
    within : (float, float)
        The open interval on which g is defined. g is never called outside it, and free ends stay
        inside it.

    Raises
    ------
    ValueError
        If a part has the wrong type, or `within` is no interval.

    Examples
    --------
    A wedge: g jumps by 2 at the origin, which is declared, and the load 2 gives a half width of
    one.

    >>> import numpy as np, sie
    >>> wedge = sie.Forcing(np.sign, np.abs, sie.Jumps(at=[0.0], heights=[2.0]))
    >>> wedged = sie.Equation(sie.cauchy(), wedge, (sie.Total(2.0),))
    >>> sie.solve(wedged, sie.Zones.of([[-0.5, 2.0]])).zones.table.round(9).tolist()
    [[-1.0, 1.0]]
    """

    value: Function
    primitive: Function | None = None
    jumps: Jumps = NO_JUMPS
    resolution: Resolution = UNRESOLVED
    within: tuple[float, float] = (-math.inf, math.inf)
    _is_trusted: bool = field(default=False, init=False, repr=False)

    def __post_init__(self) -> None:
        for name, kind in (("jumps", Jumps), ("resolution", Resolution)):
            if not isinstance(getattr(self, name), kind):
                raise ValueError(
                    f"{name} must be a sie.{kind.__name__}, got {inputs.shown(getattr(self, name))}"
                )
        object.__setattr__(self, "within", _interval("within", self.within))

    def trusted(self) -> "Forcing":
        """A copy of this function whose values and primitive `sie` does not check.

        Returns
        -------
        Forcing
        """
        found = replace(self)
        object.__setattr__(found, "_is_trusted", True)
        return found

    def sampled(self, start: Array, away: Array, slope: Function) -> Array:
        """Values of g at start + away, accurate even where the sum start + away is rounded.

        g is evaluated at the rounded sum; slope(values), the derivative of g there, corrects for
        the rounding of the place.
        """
        x = start + away
        values = np.array(self.value(x.ravel()), dtype=float).reshape(x.shape)
        placed = self.resolution.rounded_place
        at = x if placed is None else placed(x)
        return np.asarray(values + slope(values) * (away - (at - start)))

    @property
    def kinks(self) -> tuple[Array, Array]:
        """(positions, heights) of the jumps of the right side g itself, not of its derivatives."""
        return NO_JUMPS.of_order_zero if self.jumps.of_density else self.jumps.of_order_zero

    @property
    def logarithms(self) -> tuple[Array, Array]:
        """(positions, heights) of jumps of the wanted density itself, not of its derivatives.

        The right side is logarithmic there.
        """
        return self.jumps.of_order_zero if self.jumps.of_density else NO_JUMPS.of_order_zero

    @property
    def value_jumps(self) -> bool:
        """Whether the right side g or a derivative of g has jumps."""
        return len(self.jumps) > 0 and not self.jumps.of_density

    @property
    def density_jumps(self) -> bool:
        """Whether the wanted density or a derivative of this density has jumps."""
        return len(self.jumps) > 0 and self.jumps.of_density

    @property
    def cornered(self) -> bool:
        """Whether there are jumps of order 0, in values of the right side g or the wanted density.

        Then the distances of ends from the jumps matter.
        """
        return len(self.jumps.of_order_zero[0]) > 0

    def jumps_within(self, zones: Zones, kernel: Kernel) -> ForcingJumps:
        """The jumps inside zones, and the poles whose sums approximate powers |x - s|^p.

        If ends have prescribed values, the result also contains the plateaus beside the zones
        (intervals of constant density). They cause logarithms in the right side at the ends.
        """
        jumps = self.jumps
        if len(jumps) or jumps.algebraic is not None:
            needs_half(zones.weight, "jumps in closed form")
        places = zones, jumps.at, jumps.heights, np.asarray(jumps.orders)
        found: ForcingJumps = (
            DensityJumps.inside(*places, kernel, jumps.spline)
            if self.density_jumps
            else ForcingJumps.within(*places, kernel.period, jumps.spline or self.value)
        )
        if zones.have_values:
            if found.logarithms is not None:
                raise ValueError(
                    "jumps of the density cannot be combined with given values at ends: declare "
                    "only one of the two"
                )
            found = replace(found, logarithms=Logarithms.of_plateaus(zones, kernel))
        poles = Poles.of(zones, jumps.algebraic, kernel.period, jumps.of_density)
        return replace(found, poles=poles) if len(poles) else found
