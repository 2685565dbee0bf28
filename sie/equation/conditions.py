"""Side conditions: linear equations for the density, one class each.

A condition returns rows, that is linear equations for the unknown coefficients. It builds them from
the quantities that a `Rows` object, the assembled system, provides: total, potential, weighted
integral and intensities at the ends of each zone. A new condition is one class with `count` and
`rows`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Protocol

import numpy as np

from sie.basis import chebyshev, inputs
from sie.basis.data import Array, record
from sie.basis.sums import OPTIONS as SUMS
from sie.basis.zones import Zones

Linear = tuple[Array, Array]
"""(matrix, constants): the quantities are matrix @ unknowns + constants."""


class Rows(Protocol):
    """Quantities of the assembled system that a side condition may use, for each solved zone.

    Each method returns (matrix, constants): the quantities are matrix @ unknowns + constants.

    Examples
    --------
    A condition that makes the first zone hold a given part of the total.

    >>> import numpy as np, sie
    >>> class Part(sie.Condition):
    ...     def __init__(self, part):
    ...         self.part = part
    ...     def count(self, zones):
    ...         return 1
    ...     def rows(self, system: sie.Rows):
    ...         matrix, constants = system.totals()
    ...         weight = (np.arange(len(constants)) == 0) - self.part
    ...         return weight[None] @ matrix, np.array([weight @ constants]), np.zeros(1)
    >>> charge = sie.Equation(sie.cauchy(), np.zeros_like, (sie.Total(1.0), Part(0.25)))
    >>> found = sie.solve(charge, sie.Zones.of([[-2, -1], [1, 2]], sie.SINGULAR, sie.SINGULAR))
    >>> found.density.totals.round(12).tolist()
    [0.25, 0.75]
    """

    zones: Zones
    """The zones of the system."""

    def totals(self) -> Linear:
        """Integral of the density over each solved zone."""

    def levels(self) -> Linear:
        """Level of each solved zone: mean of (potential minus primitive of the right side).

        The weight of the mean is 1 / sqrt(1 - t^2), with t from -1 to 1 on the zone.
        """

    def level_steps(self) -> Linear:
        """Level of each zone (see `levels`) minus the level of its left neighbour."""
        matrix, constants = self.levels()
        return np.diff(matrix, axis=0), np.diff(constants)

    def integrals(self, weight: Callable[[Array], Array], degree: int | None = None) -> Linear:
        """Integral of `weight` times the density over each solved zone.

        degree: degree of the weight if it is a polynomial on each zone, else None.
        """

    def intensities(self) -> tuple[Linear, Linear]:
        """Intensities K at the left end and at the right end of each solved zone."""

    def amplitude(self, k: int) -> Linear:
        """The amplitude of the equation's term `columns[k]`."""

    def on_plateaus(self, weight: Callable[[Array], Array] | None = None) -> float:
        """Integral of `weight` (None: 1) times the density over the plateaus.

        A plateau is an interval next to a zone on which the density has a given constant value.
        """
        return 0.0

    def multiplicity(self) -> Array:
        """Number of zones that each solved zone represents, 2 with a mirror image and 1 without."""
        weight = np.ones(len(self.zones.solved))
        if self.zones.symmetric:
            weight[1 if self.zones.central else 0 :] = 2.0
        return weight


class Condition:
    """Base class of side conditions: linear equations for the density and the amplitudes.

    A user's condition has a method `rows(system)`. It returns (matrix, constants, values) of the
    shapes (count, unknowns), (count,), (count,), which stand for matrix @ unknowns + constants =
    values. A condition with another number of rows than one also has a method `count(zones)`.
    `Rows` lists the methods of `system`.

    Attributes
    ----------
    open : bool
        Whether the condition's value is unknown, and is determined by a condition on the ends.
    levels : bool
        Whether the condition contains potentials.

    Examples
    --------
    >>> import numpy as np, sie
    >>> class Left(sie.Condition):
    ...     "The intensity K at the left end of the first zone."
    ...     def __init__(self, value):
    ...         self.value = value
    ...     def count(self, zones):
    ...         return 1
    ...     def rows(self, system):
    ...         (matrix, constants), _ = system.intensities()
    ...         return matrix[:1], constants[:1], np.array([self.value])
    >>> equation = sie.Equation(sie.cauchy(), sie.Forcing(np.zeros_like), (Left(2.0),))
    >>> found = sie.solve(equation, sie.Zones.of([[-1.0, 1.0]], sie.SINGULAR, sie.SINGULAR))
    >>> found.density.intensities[1].round(12).tolist()
    [2.0]
    """

    open: bool = False
    levels: bool = False
    """Whether the condition contains potentials."""

    def count(self, zones: Zones) -> int:
        """Number of rows (scalar equations) of the condition."""
        return 1

    def rows(self, system: Rows) -> tuple[Array, Array, Array]:
        """(matrix, constants, values) of the condition matrix @ unknowns + constants = values."""
        raise NotImplementedError


def asked(condition: Condition, system: Rows, size: int) -> tuple[Array, Array, Array]:
    """(matrix, constants, values) of a condition for `size` unknowns, with checked shapes."""
    given, numbers = condition.rows(system), system.zones.weight.numbers
    if not isinstance(given, tuple) or len(given) != 3:
        raise ValueError(
            f"{condition}: `rows` must return a tuple of three, (matrix, constants, values)"
        )
    for name, part in zip(("matrix", "constants", "values"), given, strict=True):
        if np.iscomplexobj(part) and numbers is float:
            raise ValueError(
                f"{condition}: the {name} that its `rows` returns must be real, unless the "
                "equation has a complex kappa"
            )
    matrix, constants, values = (np.asarray(part, dtype=numbers) for part in given)
    count = condition.count(system.zones)
    if matrix.shape != (count, size) or constants.shape != (count,) or values.shape != (count,):
        raise ValueError(
            f"{condition}: its `count` is {count}, so its `rows` must return arrays of the shapes "
            f"({count}, {size}), ({count},) and ({count},), "
            f"got {matrix.shape}, {constants.shape} and {values.shape}"
        )
    return matrix, constants, values


def of_levels(condition: Condition, zones: Zones) -> Array:
    """Coefficients of the zones' constant potentials (`Rows.levels`) in the rows of a condition."""
    count = len(zones.solved)
    return asked(condition, Trial(zones, np.zeros((count, count)), np.eye(count)), count)[0]


def speaks_of_levels(condition: Condition, zones: Zones) -> bool:
    """Whether a condition contains potentials.

    Its attribute `levels` says so, or a test with trial potentials shows it.
    """
    if condition.levels or type(condition).rows in _SILENT:
        return condition.levels
    level = np.random.default_rng(0).uniform(0.5, 1.5, (len(zones.solved), 1))
    tried = Trial(zones, np.zeros_like(level), level)
    return bool(asked(condition, tried, 1)[0].any())


@record
class ByZone:
    """Coefficients of a condition with one equation for each zone or each pair of neighbours.

    `by_zone` finds the coefficients. A level is the constant of the potential on a zone
    (`Rows.levels`), and c_0 / sqrt(1 - t^2) is the first term of a zone's density. Row i of the
    condition is

        levels_i level_i + first_i c_0i = value_i,
        or, if `differences`, levels_i (level_(i+1) - level_i) = value_i.
    """

    levels: Array
    first: Array
    differences: bool

    @property
    def of_levels(self) -> bool:
        """True if all rows of the condition contain potentials (`Rows.levels`), False if none."""
        return bool(np.all(self.levels != 0.0))


@record
class Trial(Rows):
    """Quantities of a trial density c_0 / sqrt(1 - t^2), for which a condition is evaluated.
    The result shows which unknowns the condition contains, and with which coefficients.

    The trial levels (constants of the potential) are given separately and do not depend on this
    density. first, level: matrices (solved zones, unknowns) from the unknowns to c_0 and to the
    levels.
    """

    zones: Zones
    first: Array
    level: Array

    @property
    def _scaled(self) -> Array:
        """Matrix from the unknowns to integrals over zones: pi times half width times `first`."""
        return np.asarray(np.pi * self.zones.half[self.zones.solved][:, None] * self.first)

    def totals(self) -> Linear:
        return self._scaled, np.zeros(len(self.first))

    def levels(self) -> Linear:
        return self.level, np.zeros(len(self.level))

    def integrals(self, weight: Callable[[Array], Array], degree: int | None = None) -> Linear:
        solved = self.zones.solved
        x = self.zones.middle[solved][:, None] + self.zones.half[solved][:, None] * chebyshev.gauss(
            SUMS.max_direct_terms
        )
        values = np.broadcast_to(np.asarray(weight(x.ravel()), dtype=float), (x.size,)).reshape(
            x.shape
        )
        return self._scaled * values.mean(axis=1, keepdims=True), np.zeros(len(solved))

    def intensities(self) -> tuple[Linear, Linear]:
        k = (
            self.zones.edge_scale[self.zones.solved][:, None] * self.first,
            np.zeros(len(self.first)),
        )
        return k, k

    def amplitude(self, k: int) -> Linear:
        return np.zeros((1, self.first.shape[1])), np.zeros(1)


def by_zone(condition: Condition, zones: Zones) -> ByZone | None:
    """The `ByZone` of a condition with one row for each zone or pair of neighbours; else None.

    The response of the condition's rows to trial densities and levels that are equal on all zones,
    or rise evenly, gives the coefficients. The response to random densities and levels shows
    whether the condition contains anything else.
    """
    solved, count = zones.solved, condition.count(zones)
    n = len(solved)
    # Whether each row is a difference between the constant potentials (`Rows.levels`) of two
    # neighbouring zones. With two zones, a user's condition with one row may be anything else, so
    # only built-in conditions count.
    differences = count == n - 1 and (
        n > 2 or (condition.levels and type(condition).rows in BUILT_IN)
    )
    if n < 2 or not (count == n or differences):
        return None
    none, chance = np.zeros(n), np.random.default_rng(0).uniform(0.5, 1.5, (2, n))

    def made(first: Array, level: Array) -> Array:
        return asked(condition, Trial(zones, first[:, None], level[:, None]), 1)[0][:, 0]

    of_first, same, rising = (
        made(np.ones(n), none),
        made(none, np.ones(n)),
        made(none, np.arange(n, dtype=float)),
    )
    found = ByZone(
        rising if differences else same, np.zeros(n) if differences else of_first, differences
    )
    of_level = found.levels * (np.diff(chance[1]) if differences else chance[1])
    expected = of_level if differences else of_level + found.first * chance[0]
    size = np.abs(expected).max(initial=0.0)
    some, every = np.any(found.levels != 0.0), np.all(found.levels != 0.0)
    if size == 0.0 or np.abs(made(*chance) - expected).max() > 1e-12 * size or (some and not every):
        return None
    if differences and not (every and np.abs(of_first).max() == 0.0 == np.abs(same).max()):
        return None
    return found if every or np.all(found.first != 0.0) else None


def summed(system: Rows, of_zones: Linear, value: complex) -> tuple[Array, Array, Array]:
    """(matrix, constants, values) of one row: the sum of a quantity over all zones is `value`."""
    weight = system.multiplicity()
    return (weight @ of_zones[0])[None], np.array([weight @ of_zones[1]]), np.array([value])


@dataclass(frozen=True)
class Total(Condition):
    """The side condition that the integral of the density over all zones has a given value.

    The integral includes the plateaus beside the zones.

    Parameters
    ----------
    value : float, complex or None
        The prescribed integral; None: unknown, determined by a condition on the ends.

    Examples
    --------
    >>> import numpy as np, sie
    >>> hertz = sie.Equation(sie.cauchy(), sie.Forcing(lambda x: x), (sie.Total(2 * np.pi),))
    >>> sie.solve(hertz, sie.Zones.of([[-1.0, 1.0]])).zones.table.round(9).tolist()
    [[-2.0, 2.0]]
    """

    value: complex | None

    def __post_init__(self) -> None:
        if self.value is not None:
            inputs.scalar("Total: its value", self.value)

    @property
    def open(self) -> bool:  # type: ignore[override]
        return self.value is None

    def rows(self, system: Rows) -> tuple[Array, Array, Array]:
        matrix, constants, value = summed(system, system.totals(), self.value or 0.0)
        return matrix, constants + system.on_plateaus(), value


@dataclass(frozen=True)
class Weighted(Condition):
    """The side condition that the integral of weight(x) times the density has a given value.

    It can be a moment, a mean, or any other linear functional with a smooth weight. On symmetric
    zones only the even part of the weight counts.

    Parameters
    ----------
    weight : callable
        weight(x), x (n,), smooth on each zone.
    value : float or complex
        The prescribed integral.
    degree : int or None
        The degree of the weight if it is a polynomial: then few coefficients are needed.

    Examples
    --------
    >>> import numpy as np, sie
    >>> second = sie.Weighted(lambda x: x**2, 1.0, degree=2)
    >>> zone = sie.Zones.of([[-1.0, 1.0]], sie.SINGULAR, sie.SINGULAR)
    >>> found = sie.solve(sie.Equation(sie.cauchy(), np.zeros_like, second), zone)
    >>> float(round(found.density.total, 12))
    2.0
    """

    weight: Callable[[Array], Array]
    value: complex
    degree: int | None = None

    def __post_init__(self) -> None:
        inputs.function("Weighted: its weight", self.weight)
        inputs.scalar("Weighted: its value", self.value)
        if self.degree is not None:
            inputs.whole("Weighted: its degree", self.degree, 0)

    def rows(self, system: Rows) -> tuple[Array, Array, Array]:
        weight = self._even if system.zones.symmetric else self.weight
        of_zones = system.integrals(weight, self.degree)
        matrix, constants, value = summed(system, of_zones, self.value)
        return matrix, constants + system.on_plateaus(weight), value

    def _even(self, x: Array) -> Array:
        """The even part of the function `weight`."""
        return np.asarray(0.5 * (self.weight(x) + self.weight(-x)))


def moment(value: complex, about: float = 0.0) -> Weighted:
    """The side condition that the integral of (x - about) times the density has a given value.

    Parameters
    ----------
    value : float or complex
        The prescribed moment.
    about : float
        The reference point.

    Returns
    -------
    Weighted

    Examples
    --------
    >>> import numpy as np, sie
    >>> still, column = sie.Forcing(np.zeros_like), sie.Forcing(np.ones_like)
    >>> conditions = sie.Total(0.0), sie.moment(np.pi / 2)
    >>> tilted = sie.Equation(sie.cauchy(), still, conditions, (column,))
    >>> found = sie.solve(tilted, sie.Zones.of([[-1.0, 1.0]], sie.SINGULAR, sie.SINGULAR))
    >>> float(round(found.amplitudes[0], 12))
    -1.0
    """
    return Weighted(
        partial(np.add, -inputs.number("moment: about", about)),
        inputs.scalar("moment: value", value),
        degree=1,
    )


@dataclass(frozen=True)
class ZoneMoments(Condition):
    """The condition that the density's moments, each about its zone's middle, have a given sum.

    If the total of every zone is zero, the sum is minus the integral of the opening, which is the
    primitive of the density.

    Parameters
    ----------
    value : float
        The prescribed sum.

    Examples
    --------
    A crack opened so far that its area is one.

    >>> import numpy as np, sie
    >>> opened = sie.Equation(
    ...     sie.cauchy(), np.zeros_like, (sie.ZoneTotals(), sie.ZoneMoments(-1.0)), np.ones_like
    ... )
    >>> found = sie.solve(opened, sie.Zones.of([[-1.0, 1.0]], sie.SINGULAR, sie.SINGULAR))
    >>> float(round(found.amplitudes[0], 12)) == round(2 / np.pi, 12)
    True
    """

    value: float

    def __post_init__(self) -> None:
        inputs.number("ZoneMoments: its value", self.value)

    def rows(self, system: Rows) -> tuple[Array, Array, Array]:
        zones = system.zones

        def about_middle(x: Array) -> Array:
            return np.asarray(x - zones.middle[np.searchsorted(zones.a, x, side="right") - 1])

        return summed(system, system.integrals(about_middle, degree=1), self.value)


@dataclass(frozen=True)
class ZoneTotals(Condition):
    """The side condition that the integral of the density over each zone has a given value.

    Parameters
    ----------
    values : float, complex or tuple of these
        One value for all, or one for each solved zone (0 for cracks).

    Examples
    --------
    >>> import numpy as np, sie
    >>> cracks = sie.Equation(sie.cauchy(), sie.Forcing(np.ones_like), (sie.ZoneTotals(0.0),))
    >>> found = sie.solve(cracks, sie.Zones.of([[-1, 0], [1, 2]], sie.SINGULAR, sie.SINGULAR))
    >>> bool(np.abs(found.density.totals).max() < 1e-14)
    True
    """

    values: tuple[complex, ...] | complex = 0.0

    def __post_init__(self) -> None:
        inputs.scalars("ZoneTotals: its values", self.values)

    def count(self, zones: Zones) -> int:
        return len(zones.solved)

    def rows(self, system: Rows) -> tuple[Array, Array, Array]:
        matrix, constants = system.totals()
        values = np.asarray(self.values)
        if values.shape not in ((), constants.shape):
            half = " (the right half of a symmetric set)" if system.zones.symmetric else ""
            raise ValueError(
                f"ZoneTotals: {len(constants)} zones are solved{half}, "
                f"so give one value or {len(constants)} values, got values of the shape "
                f"{values.shape}"
            )
        return matrix, constants, np.broadcast_to(values, constants.shape)


@dataclass(frozen=True)
class EqualPotential(Condition):
    """The condition that the potential minus the right side's primitive is equal on all zones.

    The common value is unknown, so that these are n - 1 conditions for n zones. The right side must
    have a `Forcing.primitive`.

    Examples
    --------
    Two equal plates at one potential share a charge.

    >>> import numpy as np, sie
    >>> still = sie.Forcing(np.zeros_like, np.zeros_like)
    >>> charge = sie.Equation(sie.cauchy(), still, (sie.Total(1.0), sie.EqualPotential()))
    >>> found = sie.solve(charge, sie.Zones.of([[-2, -1], [1, 2]], sie.SINGULAR, sie.SINGULAR))
    >>> found.density.totals.round(12).tolist()
    [0.5, 0.5]
    """

    levels = True

    def count(self, zones: Zones) -> int:
        return len(zones.solved) - 1

    def rows(self, system: Rows) -> tuple[Array, Array, Array]:
        if len(system.zones.solved) == 1:
            size = system.totals()[0].shape[1]
            return np.zeros((0, size)), np.zeros(0), np.zeros(0)
        matrix, constants = system.level_steps()
        return matrix, constants, np.zeros(len(constants))


@dataclass(frozen=True)
class Level(Condition):
    """The condition that the potential minus the right side's primitive is `value` on every zone.

    The right side must have a `Forcing.primitive`.

    Parameters
    ----------
    value : float or complex
        The prescribed value.

    Examples
    --------
    A plate of half width 2 has the capacity 1, and any charge gives it the potential zero. On a
    plate twice as wide, the charge 1 has the potential log(2) / pi.

    >>> import numpy as np, sie
    >>> level, still = sie.Level(np.log(2) / np.pi), sie.Forcing(np.zeros_like, np.zeros_like)
    >>> plate = sie.Zones.of([[-4, 4]], sie.SINGULAR, sie.SINGULAR)
    >>> found = sie.solve(sie.Equation(sie.cauchy(), still, level), plate)
    >>> float(round(found.density.total, 12))
    1.0
    """

    value: complex
    levels = True

    def __post_init__(self) -> None:
        inputs.scalar("Level: its value", self.value)

    def count(self, zones: Zones) -> int:
        return len(zones.solved)

    def rows(self, system: Rows) -> tuple[Array, Array, Array]:
        matrix, constants = system.levels()
        return matrix, constants, np.full(len(constants), self.value)


@dataclass(frozen=True)
class Amplitude(Condition):
    """The condition that `columns[k]` has the amplitude `value` + `per_total` * (density's total).

    Parameters
    ----------
    k : int
        Number of the column in the equation.
    value : float or None
        The prescribed amplitude; None: unknown, determined by a condition on the ends.
    per_total : float
        Coefficient of the total.

    Examples
    --------
    The column x has the prescribed amplitude -1/2. Then a load pi / 4 makes a zone of half width 1.

    >>> import numpy as np, sie
    >>> conditions = sie.Total(np.pi / 4), sie.Amplitude(0, -0.5)
    >>> equation = sie.Equation(sie.cauchy(), lambda x: x, conditions, lambda x: x)
    >>> sie.solve(equation, sie.Zones.of([[-0.8, 1.1]])).zones.table.round(9).tolist()
    [[-1.0, 1.0]]
    """

    k: int
    value: float | None = 0.0
    per_total: float = 0.0

    def __post_init__(self) -> None:
        inputs.whole("Amplitude: its column", self.k, 0)
        inputs.number("Amplitude: per_total", self.per_total)
        if self.value is not None:
            inputs.number("Amplitude: its value", self.value)

    @property
    def open(self) -> bool:  # type: ignore[override]
        return self.value is None

    def rows(self, system: Rows) -> tuple[Array, Array, Array]:
        matrix, constants = system.amplitude(self.k)
        if self.per_total:
            totals, known, _ = summed(system, system.totals(), 0.0)
            matrix, constants = matrix - self.per_total * totals, constants - self.per_total * known
        return matrix, constants, np.array([self.value or 0.0])


_SILENT = (Total.rows, Weighted.rows, ZoneMoments.rows, ZoneTotals.rows, Amplitude.rows)
BUILT_IN = (*_SILENT, EqualPotential.rows, Level.rows)
"""`rows` of conditions that remain valid when zones merge or vanish.

A user's `rows` may rely on the given zones.
"""


class EndCondition(Protocol):
    """A condition that contains only the ends of the zones, not the density."""

    def residual(self, zones: Zones) -> tuple[float, Array, Array]:
        """(residual, its derivatives by outward motions of left ends and of right ends (n,))."""


@dataclass(frozen=True)
class TotalWidth:
    """The condition that the sum of the widths of all zones has a given value.

    An equation with it needs one side condition of unknown value, such as `Total(None)`.

    Parameters
    ----------
    value : float
        The prescribed sum.

    Examples
    --------
    >>> import numpy as np, sie
    >>> total, width = sie.Total(None), sie.TotalWidth(2.0)
    >>> equation = sie.Equation(sie.cauchy(), lambda x: x, total, end_conditions=width)
    >>> found = sie.solve(equation, sie.Zones.of([[-0.5, 1.0]]), value=1.0)
    >>> float(round(found.value, 9))
    1.570796327
    """

    value: float

    def __post_init__(self) -> None:
        inputs.positive("TotalWidth: its value", self.value)

    def residual(self, zones: Zones) -> tuple[float, Array, Array]:
        one = np.ones(len(zones))
        return (
            float(np.sum(zones.b - zones.a) + np.sum(zones.rest[1] - zones.rest[0])) - self.value,
            one,
            one,
        )
