"""The singular integral equation, as data.

    (1/pi) PV int_zones phi(xi) K(x, xi) dxi = g(x) + sum_k lambda_k C_k(x)    on the zones,

with side conditions on phi and on the unknown amplitudes lambda_k. Unknowns are counted against
conditions before any arithmetic: per zone the index, one for each free end, one for each unknown
amplitude.
"""

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from sie.basis import inputs
from sie.basis.data import Array, Index, Kept
from sie.basis.kernels import MAKERS, Kernel, Smooth
from sie.basis.zones import Zones
from sie.equation.conditions import Condition, EndCondition
from sie.jumps.density import DensityJumps
from sie.jumps.forcing import ForcingJumps
from sie.jumps.formulas import HIGHEST
from sie.jumps.poles import AlgebraicPoints, Poles

Function = Callable[[Array], Array]


class CountError(ValueError):
    """The side conditions do not match the index of the problem; the message says what is missing
    or too much.

    Examples
    --------
    >>> import sie
    >>> crack = sie.Equation(sie.cauchy(), sie.Forcing(lambda x: 1 + 0 * x), ())
    >>> try:
    ...     sie.solve(crack, sie.Zones.of([[-1.0, 1.0]], sie.SINGULAR, sie.SINGULAR))
    ... except sie.CountError as error:
    ...     print(str(error)[:31])
    1 side conditions are needed (i
    """


@dataclass(frozen=True, eq=False)
class Forcing(Kept):
    """A known function of the right side.

    Parameters
    ----------
    value : callable
        g(x), x of any shape; smooth on each zone but for the declared jumps.
    primitive : callable or None
        An antiderivative of g, continuous over all zones; only needed by conditions on potentials.
    jumps_at, jumps, orders : array_like
        Positions, heights g^(q)(s+) - g^(q)(s-) and orders q (0, 1 or 2) of jumps of g or of its
        derivatives, (k,), or one height or order for all; for a kernel with a period they repeat.
        orders None: all 0, jumps of g itself.
    density_jumps_at, density_jumps, density_orders : array_like
        The same of jumps of the wanted density, where g has (J/pi) (x - s)^q ln|x - s| / q!; for q
        = 0 this is (J/pi) Lambda(x, s), Lambda the kernel's potential, and is left out of `value`.
        Either jumps or density_jumps.
    algebraic : AlgebraicPoints or None
        Points beside which g, or the wanted density, is algebraic; of the density's, g has the
        transform in its values.
    spline : callable or None
        A quadratic spline with the jumps or density_jumps of order 2, where it is known and is not
        all of g: of very many it keeps the digits.
    modes : int or None
        Of a column, how many modes it has where that is known (1: a constant); else the engine
        finds out.
    between : bool
        Of a column, whether it is as smooth between the intervals as on them: then narrow gaps are
        taken as slits beside it too.
    singular_at : array_like
        Places between the intervals at which g is singular, (k,): narrow gaps are not taken as
        slits then, and as many nodes are begun with as the distances from there ask for. For a
        kernel with a period they repeat.
    resolution : float or None
        Smallest length over which a smooth g varies. Then differences of the primitive are taken
        from g, where zones are many: they keep digits that the primitive has lost.
    placed : callable or None
        Where x comes to stand when `value` rounds it; None: x itself. Narrow zones far from the
        origin see it.
    exact : bool
        Whether `value` loses nothing of the places that it is given: then ends of zones are kept to
        more digits than their positions have.
    looked_at : bool
        Whether it is known to be in order, and its primitive to rise as its value says: then that
        is not looked at again.
    rounding : float
        Standard deviation of the noise of `value`, in its unit; coefficients are not asked to fall
        below it.
    within : (float, float)
        The open interval on which the function is defined: it is not called outside, and free ends
        stay inside.

    Raises
    ------
    ValueError
        If both jumps and density_jumps are given, if these are no numbers or not as many as their
        positions, or an order is above 2.

    Examples
    --------
    A wedge: g jumps by 2 at the origin, which is declared, and the load 2 gives a half width of
    one.

    >>> import numpy as np, sie
    >>> wedge = sie.Forcing(np.sign, np.abs, jumps_at=[0.0], jumps=[2.0])
    >>> sie.solve(sie.Equation(sie.cauchy(), wedge, (sie.Total(2.0),)), sie.Zones.of([[-0.5, 2.0]])).zones.table.round(9).tolist()
    [[-1.0, 1.0]]
    """

    value: Function
    primitive: Function | None = None
    jumps_at: Array = field(default_factory=lambda: np.zeros(0))
    jumps: Array = field(default_factory=lambda: np.zeros(0))
    orders: Index | None = None
    density_jumps_at: Array = field(default_factory=lambda: np.zeros(0))
    density_jumps: Array = field(default_factory=lambda: np.zeros(0))
    density_orders: Index | None = None
    algebraic: AlgebraicPoints | None = None
    spline: Function | None = None
    modes: int | None = None
    between: bool = False
    singular_at: Array = field(default_factory=lambda: np.zeros(0))
    resolution: float | None = None
    placed: Function | None = None
    exact: bool = False
    looked_at: bool = False
    rounding: float = 0.0
    within: tuple[float, float] = (-math.inf, math.inf)

    def sampled(self, start: Array, away: Array, slope: Function) -> Array:
        """g at start + away, more exactly than such places can be told apart: taken where they are
        rounded to, and what that is off by put right with slope(values), the derivative of g there.
        """
        x = start + away
        values = np.array(self.value(x.ravel()), dtype=float).reshape(x.shape)
        at = x if self.placed is None else self.placed(x)
        return np.asarray(values + slope(values) * (away - (at - start)))

    def __post_init__(self) -> None:
        keep = partial(object.__setattr__, self)
        for at, heights, orders in (
            ("jumps_at", "jumps", "orders"),
            ("density_jumps_at", "density_jumps", "density_orders"),
        ):
            places = inputs.numbers(at, getattr(self, at))
            keep(at, places)
            keep(heights, _for_each(at, heights, len(places), getattr(self, heights)))
            if getattr(self, orders) is not None:
                keep(orders, _orders(at, orders, len(places), getattr(self, orders)))
        if len(self.jumps_at) and len(self.density_jumps_at):
            raise ValueError(
                "either the right side jumps or the density does: give jumps or density_jumps, not both"
            )
        keep("singular_at", inputs.numbers("singular_at", self.singular_at))
        if self.modes is not None:
            inputs.whole("modes", self.modes, 1)
        if self.resolution is not None:
            inputs.positive("resolution", self.resolution)
        keep("within", _interval("within", self.within))

    @cached_property
    def kinks(self) -> tuple[Array, Array]:
        """Positions and heights of the jumps of g itself."""
        return _of_order_zero(self.jumps_at, self.jumps, self.orders)

    @cached_property
    def logarithms(self) -> tuple[Array, Array]:
        """Positions and heights of the jumps of the wanted density itself."""
        return _of_order_zero(self.density_jumps_at, self.density_jumps, self.density_orders)

    @cached_property
    def broken_at(self) -> Array:
        """Positions at which g, or the wanted density, is not smooth."""
        points = np.zeros(0) if self.algebraic is None else np.asarray(self.algebraic.at)
        return np.concatenate(
            (np.asarray(self.jumps_at), np.asarray(self.density_jumps_at), points)
        )

    @property
    def cornered(self) -> bool:
        """Whether g or the wanted density jumps anywhere: then the distances of ends from there
        count.
        """
        return len(self.kinks[0]) + len(self.logarithms[0]) > 0

    def jumps_within(self, zones: Zones, kernel: Kernel) -> ForcingJumps:
        """The jumps that lie inside zones, and the poles of algebraic points."""
        found = self._jumps_within(zones, kernel)
        poles = Poles.of(zones, self.algebraic, kernel.period)
        return replace(found, poles=poles) if len(poles) else found

    def _jumps_within(self, zones: Zones, kernel: Kernel) -> ForcingJumps:
        if len(self.density_jumps_at):
            orders = (
                np.zeros(len(self.density_jumps_at), dtype=np.intp)
                if self.density_orders is None
                else self.density_orders
            )
            return DensityJumps.inside(
                zones, self.density_jumps_at, self.density_jumps, orders, kernel, self.spline
            )
        orders = np.zeros(len(self.jumps_at), dtype=np.intp) if self.orders is None else self.orders
        return ForcingJumps.within(
            zones, self.jumps_at, self.jumps, orders, kernel.period, self.spline or self.value
        )


def _for_each(places: str, name: str, count: int, values: Any) -> Array:
    """Numbers (count,), one for each of the places: as many as these, or one for all."""
    table = inputs.numbers(name, values)
    if len(table) == 1 and count > 1 and np.ndim(values) == 0:
        return np.full(count, table[0])
    if len(table) != count:
        raise ValueError(
            f"{name}: one for each of {places} is needed, or one for all; got {len(table)} for {count} places"
        )
    return table


def _orders(places: str, name: str, count: int, values: Any) -> Index:
    """Orders of jumps (count,)."""
    if (
        isinstance(values, np.ndarray)
        and values.dtype == np.intp
        and values.shape == (count,)
        and (values <= HIGHEST).all()
    ):
        return values
    table = _for_each(places, name, count, values)
    if not np.isin(table, np.arange(HIGHEST + 1)).all():
        raise ValueError(
            f"{name} must be 0, 1 or 2, which derivative jumps; leave jumps of higher ones out, got {inputs.shown(values)}"
        )
    return table.astype(np.intp)


def _interval(name: str, values: Any) -> tuple[float, float]:
    """(lo, hi) with lo < hi; both may be infinite."""
    table = inputs.table_of(name, values)
    if table.shape != (2,) or not table[0] < table[1]:
        raise ValueError(
            f"{name} must be two numbers (lo, hi) with lo < hi, infinite where there is no limit, got {inputs.shown(values)}"
        )
    return float(table[0]), float(table[1])


def _forcing(name: str, given: Any) -> Forcing:
    """A `Forcing`, or a function of x, as one."""
    if isinstance(given, Forcing):
        return given
    if callable(given) and given is not Forcing:
        return Forcing(given)
    raise ValueError(f"{name} must be a sie.Forcing or a function of x, got {inputs.shown(given)}")


def _look_at_kernel(kernel: Any) -> None:
    """ValueError for what is no kernel with a pole."""
    if isinstance(kernel, Kernel):
        return
    if kernel in MAKERS:
        raise ValueError(f"the kernel is what sie.{kernel.__name__}(...) returns: call it")
    if isinstance(kernel, Smooth) or callable(kernel):
        raise ValueError(
            "a smooth kernel alone makes no singular integral equation, and one that is ill-posed: add it to sie.cauchy()"
        )
    raise ValueError(
        f"the kernel must be a sie.Kernel, such as sie.cauchy(), got {inputs.shown(kernel)}"
    )


def _of_order_zero(at: Array, heights: Array, orders: Index | None) -> tuple[Array, Array]:
    which = np.ones(len(at), dtype=bool) if orders is None else np.asarray(orders) == 0
    return np.asarray(at)[which], np.asarray(heights)[which]


@dataclass(frozen=True, eq=False)
class Equation(Kept):
    """Kernel, right side, columns of unknown amplitude, side conditions, and conditions on the ends
    alone.

    Parameters
    ----------
    kernel : Kernel
        `cauchy()`, `hilbert(period)`, `images(period, neighbours)`, or one of these plus a
        `Smooth`.
    forcing : Forcing or callable
        The right side g; a function of x stands for `Forcing` of it.
    conditions : tuple of Condition
        Side conditions: one for each zone with two singular or two free ends, one less for each
        fixed bounded end, one more for each column. One that is no tuple will do.
    columns : tuple of Forcing or callable
        Functions of the right side whose amplitudes are unknown.
    end_conditions : tuple
        Conditions on the ends alone, as many as conditions of unknown value.

    Raises
    ------
    ValueError
        For a kernel without a pole, for columns with jumps, for potentials asked of right sides
        with logarithms, and for parts of a wrong type.

    Examples
    --------
    >>> import numpy as np, sie
    >>> hertz = sie.Equation(sie.cauchy(), sie.Forcing(lambda x: x), (sie.Total(np.pi / 2),))
    >>> sie.solve(hertz, sie.Zones.of([[-0.5, 2.0]])).zones.table.round(9).tolist()
    [[-1.0, 1.0]]
    """

    kernel: Kernel
    forcing: Forcing
    conditions: tuple[Condition, ...] = ()
    columns: tuple[Forcing, ...] = ()
    end_conditions: tuple[EndCondition, ...] = ()

    def __post_init__(self) -> None:
        _look_at_kernel(self.kernel)
        keep = partial(object.__setattr__, self)
        keep("forcing", _forcing("the right side", self.forcing))
        keep(
            "columns",
            tuple(
                _forcing(f"column {k}", column)
                for k, column in enumerate(inputs.several(self.columns))
            ),
        )
        keep("conditions", inputs.several(self.conditions))
        keep("end_conditions", inputs.several(self.end_conditions))
        for condition in self.conditions:
            if not isinstance(condition, Condition):
                raise ValueError(
                    f"a side condition must be a sie.Condition, such as sie.Total(1.0), got {inputs.shown(condition)}"
                )
        for end_condition in self.end_conditions:
            if not callable(getattr(end_condition, "residual", None)) or isinstance(
                end_condition, type
            ):
                raise ValueError(
                    f"a condition on the ends is one such as sie.TotalWidth(1.0), got {inputs.shown(end_condition)}"
                )
        if any(len(column.jumps_at) + len(column.density_jumps_at) for column in self.columns):
            raise ValueError(
                "a column of unknown amplitude must be smooth: jumps belong to the right side"
            )
        if len(self.forcing.density_jumps_at) and any(
            condition.levels for condition in self.conditions
        ):
            raise ValueError("a condition on potentials is for right sides without logarithms")

    @cached_property
    def within(self) -> tuple[float, float]:
        """The open interval on which the right side and all columns are defined."""
        low, high = zip(*(part.within for part in (self.forcing, *self.columns)), strict=True)
        return max(low), min(high)

    @property
    def grows(self) -> bool:
        """Whether the coupled modes must be grown until they show all of the columns and of a
        user's regular kernel.
        """
        return any(column.modes is None for column in self.columns) or self.kernel.grows

    @property
    def open_condition(self) -> int | None:
        """Index of the condition whose value is unknown and is found from a condition on the ends;
        None if none is.
        """
        return next((k for k, condition in enumerate(self.conditions) if condition.open), None)

    def check_count(self, zones: Zones) -> None:
        """Raise CountError unless unknowns and conditions balance, for given ends and for moving
        ones; ValueError if the zones do not fit between a periodic kernel's images.
        """
        images = [shift for shift in self.kernel.poles if shift > 0]
        if images and not zones.b[-1] - zones.a[0] < min(images):
            raise ValueError(
                f"the zones reach over {zones.b[-1] - zones.a[0]:.6g}, the period is {min(images):.6g}"
            )
        first = int(zones.solved[0])
        ends = [*zones.left[first:], *zones.right[first:]]
        # Of very many there are few kinds.
        kinds = {id(end): end for end in ends}
        surplus = sum(
            count * kinds[one].surplus for one, count in Counter(map(id, ends)).items()
        ) - len(zones.solved)
        if zones.central:
            surplus += 1 - zones.left[first].surplus  # odd modes are absent: half of a zone's count
        opened = sum(condition.open for condition in self.conditions)
        unknowns = surplus + len(self.columns) + opened
        given = sum(condition.count(zones) for condition in self.conditions) + len(
            self.end_conditions
        )
        names = ", ".join(str(c) for c in (*self.conditions, *self.end_conditions)) or "none"
        if opened > 1 or opened != len(self.end_conditions):
            raise CountError(
                f"{opened} conditions of unknown value need as many conditions on the ends (at most one), "
                f"got {len(self.end_conditions)}"
            )
        if given != unknowns:
            what = (
                f"{unknowns - given} more needed"
                if given < unknowns
                else f"{given - unknowns} too many"
            )
            raise CountError(
                f"{unknowns} side conditions are needed (index {surplus}, {len(self.columns)} unknown amplitudes, "
                f"{opened} unknown values) but {given} are given ({names}): {what}"
                + (
                    "; bounded ends ask for as many columns of unknown amplitude, or for other ends"
                    if unknowns < 0
                    else ""
                )
            )
