"""Kernels K(x, xi) of singular integral equations: poles plus a regular part.

A density phi has the fields (PV is the principal value)

    transform  (1/pi) PV int phi(xi) K(x, xi) dxi,
    potential  (1/pi) int phi(xi) Lambda(x, xi) dxi,   dLambda/dx = K.

A kernel is a sum of poles 1 / (x - xi - s) over its `poles` s, and a regular part. The poles are
integrated in closed form, and the regular part by Gauss-Chebyshev quadrature.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.special import gammaln, loggamma, psi

from sie.basis import inputs
from sie.basis.data import DIGITS, Array, Kept
from sie.basis.interval import What, decay_rate

Regular = Callable[[Array, Array], Array]


@dataclass(frozen=True)
class Kernel(Kept):
    """A kernel K(x, xi), which is a sum of poles 1 / (x - xi - s) and a smooth regular part.

    `cauchy`, `hilbert` and `images` make kernels; adding a `Smooth` makes another one.

    Parameters
    ----------
    poles : tuple of float
        Positions s; the first is 0.
    period : float or None
        Period of the kernel, None if it has none.
    regular, regular_potential : callable or None
        Functions of arrays (x, xi) that broadcast: the regular part of K, and of Lambda, the
        antiderivative of K by x.
    reach : float
        Distance from a source point xi to the nearest x at which the regular part is singular.
    datum : float
        Length that divides distances in Lambda, which is log|(x - xi - s) / datum| for each pole.
    sure : bool
        Whether the reach alone determines how many nodes and modes the regular part needs. This
        holds if the regular part is no larger off the zones than on them. Otherwise, as for a
        user's kernel, the number of modes is raised until they resolve the regular part.
    regular_slope : callable or None
        Derivative of the regular part by x, needed only by derivatives at complex points.
    of_lag : bool
        Whether the regular part depends on x - xi alone. Then it is summed fast for many zones.
    length : float
        Distance of the singularities of the regular part from the real axis; inf if it is unknown.
        On a zone of half width w, the number of modes starts from the ratio of w to this length,
        and may become larger than for other regular kernels.

    Raises
    ------
    ValueError
        If the poles are not different finite numbers beginning with 0, a length is not positive, or
        a potential has no regular part.

    Examples
    --------
    >>> import sie
    >>> sie.hilbert(2.0).poles, sie.cauchy().period
    ((0.0, -2.0, 2.0), None)
    """

    poles: tuple[float, ...] = (0.0,)
    period: float | None = None
    regular: Regular | None = None
    regular_potential: Regular | None = None
    reach: float = math.inf
    datum: float = 1.0
    sure: bool = False
    regular_slope: Regular | None = None
    of_lag: bool = False
    length: float = math.inf

    def __post_init__(self) -> None:
        poles = inputs.numbers("the poles of a kernel", self.poles)
        if len(poles) == 0 or poles[0] != 0.0 or len(np.unique(poles)) < len(poles):
            raise ValueError(
                "the poles of a kernel must be different finite numbers, the first of them 0, "
                f"got {self.poles!r}"
            )
        for name, value in (("period", self.period), ("datum", self.datum)):
            if value is not None:
                inputs.positive(f"the {name} of a kernel", value)
        _check_parts(
            "a kernel", self.regular, self.regular_potential, self.regular_slope, self.length
        )
        if self.regular is None and self.regular_potential is not None:
            raise ValueError("a kernel has regular_potential but not regular: give both")

    __array_ufunc__ = None  # makes NumPy arrays call the operators of the kernel

    @property
    def grows(self) -> bool:
        """Whether modes must be added to zones until they resolve the kernel's regular part."""
        return self.regular is not None and not self.sure

    @cached_property
    def kept_panels(self) -> dict[Any, Any]:
        """Cache of data for fast sums of the regular part: panels and skeletons (`sie.trees`)."""
        return {}

    @cached_property
    def kept_tables(self) -> dict[tuple[bool, int], Any]:
        """Cache of tables of the regular part as a function of x - xi (`sie.basis.lag_table`)."""
        return {}

    def regular_of(self, what: What) -> Regular | None:
        """Function of (x, xi) whose integral with a density is the regular part of a field.
        `what` names the field: the transform of the density, its derivative or the potential.

        None if the kernel has no regular part. Raises ValueError if it has one, but not for `what`.
        """
        if self.regular is None:
            return None
        parts = {
            "transform": self.regular,
            "derivative": self.regular_slope,
            "potential": self.regular_potential,
        }
        if (regular := parts[what]) is None:
            raise ValueError(
                f"the regular kernel has no {'slope' if what == 'derivative' else what}: "
                "give this function to the kernel"
            )
        return regular

    def __add__(self, other: "Smooth | Regular") -> "Kernel":
        """The sum of this kernel and a smooth kernel."""
        smooth = _smooth(other)
        regular = smooth if self.regular is None else self._rest + smooth
        return Kernel(
            self.poles,
            self.period,
            regular.value,
            regular.potential,
            0.0,
            self.datum,
            regular_slope=regular.slope,
            of_lag=regular.of_lag,
            length=regular.length,
        )

    __radd__ = __add__

    def __sub__(self, other: "Smooth | Regular") -> "Kernel":
        """This kernel minus a smooth kernel."""
        return self + -_smooth(other)

    def _refuse_multiple(self, *_: Any) -> "Kernel":
        """Raise ValueError for a multiple of a kernel, whose poles always have the weight 1."""
        raise ValueError(
            "the pole 1 / (x - xi) of a kernel always has the weight 1, so that kernels with poles "
            "cannot be multiplied by a number, or added to or subtracted from each other: divide "
            "the equation by the factor (the right side, the columns and the Smooth parts)"
        )

    __mul__ = __rmul__ = __truediv__ = __neg__ = __rsub__ = _refuse_multiple

    @property
    def _rest(self) -> "Smooth":
        """The regular part of this kernel, as a `Smooth` kernel."""
        assert self.regular is not None
        return Smooth(
            self.regular, self.regular_potential, self.regular_slope, self.of_lag, self.length
        )


@dataclass(frozen=True)
class Smooth:
    """A regular kernel value(x, xi), smooth on all zones, to be added to a kernel with poles.

    Smooth kernels can be added, subtracted and multiplied by numbers, and added to or subtracted
    from a kernel with poles. A plain function of (x, xi) may take the place of a `Smooth` there.

    Parameters
    ----------
    value : callable
        The kernel as a function of arrays (x, xi) that broadcast.
    potential : callable or None
        Antiderivative of the kernel by x, needed only by side conditions on potentials.
    slope : callable or None
        Derivative of the kernel by x, needed only by derivatives at complex points.
    of_lag : bool
        Whether the kernel depends on x - xi alone.
    length : float
        Distance of the kernel's singularities from the real axis; inf if it is unknown.

    Raises
    ------
    ValueError
        If a part is no function, or the length is not positive.

    Examples
    --------
    >>> import numpy as np, sie
    >>> wave = sie.Smooth(lambda x, xi: np.sin(x - xi), lambda x, xi: -np.cos(x - xi), of_lag=True)
    >>> equation = sie.Equation(sie.cauchy() + wave, lambda x: x, sie.Total(1.0))
    >>> sie.solve(equation, sie.Zones.of([[-1.0, 1.0]])).error < 1e-10
    True
    """

    value: Regular
    potential: Regular | None = None
    slope: Regular | None = None
    of_lag: bool = False
    length: float = math.inf

    __array_ufunc__ = None

    def __post_init__(self) -> None:
        inputs.function("the value of a Smooth kernel", self.value)
        _check_parts("a Smooth kernel", self.value, self.potential, self.slope, self.length)

    def __add__(self, other: "Smooth | Regular | Kernel") -> Any:
        """The sum of two kernels, with a potential and a slope if both kernels have them."""
        return other + self if isinstance(other, Kernel) else self._combined(_smooth(other), 1.0)

    __radd__ = __add__

    def __sub__(self, other: "Smooth | Regular") -> "Smooth":
        return self._combined(_smooth(other), -1.0)

    def __rsub__(self, other: Regular) -> "Smooth":
        return -self + other

    def __neg__(self) -> "Smooth":
        return -1.0 * self

    def __mul__(self, factor: float) -> "Smooth":
        """The product of this kernel and a number."""
        weight = inputs.number("the factor of a Smooth kernel", factor)
        value, potential, slope = (part and _Sum(part, None, weight) for part in self._parts)
        assert value is not None
        return Smooth(value, potential, slope, self.of_lag, self.length)

    __rmul__ = __mul__

    def __truediv__(self, divisor: float) -> "Smooth":
        return self * (1.0 / inputs.number("the divisor of a Smooth kernel", divisor))

    @property
    def _parts(self) -> "tuple[Regular | None, Regular | None, Regular | None]":
        """The functions (value, potential, slope) of this kernel, or None for those not given."""
        return self.value, self.potential, self.slope

    def _combined(self, other: "Smooth", weight: float) -> "Smooth":
        """The sum of this kernel and `weight` times another kernel."""
        both = zip(self._parts, other._parts, strict=True)
        value, potential, slope = (
            None if one is None or two is None else _Sum(one, two, weight) for one, two in both
        )
        assert value is not None
        return Smooth(
            value, potential, slope, self.of_lag and other.of_lag, min(self.length, other.length)
        )


def _smooth(other: Any) -> Smooth:
    """The given `Smooth` itself, or the given function of (x, xi) as a `Smooth`."""
    if isinstance(other, Kernel):
        other._refuse_multiple()
    if isinstance(other, Smooth):
        return other
    if callable(other):
        return Smooth(other)
    raise ValueError(
        "only a sie.Smooth or a function of (x, xi) can be added to a kernel or subtracted from "
        f"it, got {inputs.shown(other)}"
    )


def _check_parts(name: str, value: Any, potential: Any, slope: Any, length: Any) -> None:
    """Raise ValueError if a part of a kernel is no function or the length is not positive."""
    for part, given in (("value", value), ("potential", potential), ("slope", slope)):
        inputs.function(f"the {part} of {name}", given, optional=True)
    if not (inputs.is_number(length) and length > 0):
        raise ValueError(
            f"the length of {name} must be a positive number, or inf if it is not known, "
            f"got {inputs.shown(length)}"
        )


@dataclass(frozen=True)
class _Sum:
    """The function first + weight * second, or weight * first if there is no second."""

    first: Regular
    second: Regular | None
    weight: float

    def __call__(self, x: Array, xi: Array) -> Array:
        if self.second is None:
            return self.weight * np.asarray(self.first(x, xi))
        return np.asarray(self.first(x, xi) + self.weight * np.asarray(self.second(x, xi)))


@dataclass(frozen=True)
class _OfPeriod:
    """Base class of parts of the Hilbert kernel; all of them depend on the period L only."""

    period: float


class _HilbertRest(_OfPeriod):
    """Hilbert's kernel (pi/L) cot(pi (x - xi)/L) without its poles at x - xi = 0 and +-L."""

    def __call__(self, x: Array, xi: Array) -> Array:
        d = (x - xi) / self.period
        return np.asarray((psi(2 - d) - psi(2 + d)) / self.period)


class _HilbertSlopeRest(_OfPeriod):
    """Derivative by x of `_HilbertRest` (Hilbert's kernel without its three nearest poles)."""

    def __call__(self, x: Array, xi: Array) -> Array:
        d = (x - xi) / self.period
        return np.asarray(-(_trigamma(2 - d) + _trigamma(2 + d)) / self.period**2)


def _trigamma(z: Array) -> Array:
    """The trigamma function psi' at real or complex z, Re z >= 1.

    It is the asymptotic series with Bernoulli's numbers B_2, B_4, ... (DLMF 5.15.8), which has all
    digits at z + 10.
    """
    up = 10
    far = 1 / (z + up)
    total = np.zeros_like(far)
    for number in (7 / 6, -691 / 2730, 5 / 66, -1 / 30, 1 / 42, -1 / 30, 1 / 6):
        total = (total + number) * far * far
    out = far * (1 + 0.5 * far + total)
    for k in range(up):
        out = out + 1 / (z + k) ** 2
    return np.asarray(out)


class _HilbertPotentialRest(_OfPeriod):
    """log|2 sin(pi (x - xi)/L)| without the logarithms of the poles at x - xi = 0 and +-L."""

    def __call__(self, x: Array, xi: Array) -> Array:
        d = (x - xi) / self.period
        log = loggamma if np.iscomplexobj(d) else gammaln
        return np.asarray(math.log(2 * math.pi) - log(2 - d) - log(2 + d))


def is_hilbert(kernel: Kernel) -> bool:
    """Whether a kernel is Hilbert's kernel without a regular part that the user has added."""
    return isinstance(kernel.regular, _HilbertRest)


def cauchy(datum: float = 1.0) -> Kernel:
    """The Cauchy kernel K = 1 / (x - xi), with the potential log|(x - xi) / datum|.

    Parameters
    ----------
    datum : float
        The distance at which the potential of a source is zero.

    Returns
    -------
    Kernel

    Raises
    ------
    ValueError
        If the datum is no finite positive number.

    Examples
    --------
    >>> import sie
    >>> sie.cauchy().poles
    (0.0,)
    """
    return Kernel(datum=inputs.positive("datum", datum))


def hilbert(period: float) -> Kernel:
    """The Hilbert kernel K = (pi/L) cot(pi (x - xi) / L).

    Its potential log|2 sin(pi (x - xi) / L)| has the mean zero over a period. With d = x - xi and
    the digamma function psi, the regular part of the kernel, without the poles at 0 and +-L, is
    (psi(2 - d/L) - psi(2 + d/L)) / L. The potential without the logarithms of these poles is
    log(2 pi) - log(Gamma(2 - d/L) Gamma(2 + d/L)). Both follow from the reflection formula (DLMF
    5.5.3).

    Parameters
    ----------
    period : float
        The period L.

    Returns
    -------
    Kernel

    Raises
    ------
    ValueError
        If the period is no finite positive number.

    Examples
    --------
    >>> import numpy as np, sie
    >>> sine = sie.Forcing(lambda x: np.sin(2 * np.pi * x))
    >>> wave = sie.Equation(sie.hilbert(1.0), sine, (sie.Total(0.5),))
    >>> sie.solve(wave, sie.Zones.of([[-0.2, 0.3]])).zones.table.round(9).tolist()
    [[-0.25, 0.25]]
    """
    length = inputs.positive("period", period)
    parts, slope = (_HilbertRest(length), _HilbertPotentialRest(length)), _HilbertSlopeRest(length)
    return Kernel(
        (0.0, -length, length),
        length,
        *parts,
        length,
        datum=length,
        sure=True,
        regular_slope=slope,
        of_lag=True,
    )


def images(period: float, neighbours: int, datum: float = 1.0) -> Kernel:
    """The kernel sum_k 1 / (x - xi - k L), |k| <= m: a pole with m periodic images on each side.

    Parameters
    ----------
    period : float
        L, the distance of neighbouring images.
    neighbours : int
        The number m of images on each side.
    datum : float
        Length that divides all distances in the potential.

    Returns
    -------
    Kernel

    Raises
    ------
    ValueError
        If the period or the datum is no finite positive number, or neighbours no whole one.

    Examples
    --------
    >>> import sie
    >>> sie.images(1.0, 2).poles
    (0.0, -1.0, 1.0, -2.0, 2.0)
    """
    length = inputs.positive("period", period)
    shifts = (
        sign * k * length
        for k in range(1, inputs.whole("neighbours", neighbours, 0) + 1)
        for sign in (-1, 1)
    )
    return Kernel((0.0, *shifts), None, datum=inputs.positive("datum", datum))


MAKERS = (cauchy, hilbert, images)
"""The functions that make kernels with poles."""


def regular_size(kernel: Kernel, half_width: float, m: int) -> int:
    """Number of quadrature nodes on a zone that resolve a kernel's regular part to round-off.

    m: highest order of the density's series on the zone.
    """
    if not kernel.sure:
        if math.isinf(kernel.length):
            return m + 2
        # With q nodes, Gauss's rule gives the kernel's Chebyshev coefficient of order k <= m plus
        # the coefficient of order 2q - k (aliasing). The added coefficient must be round-off.
        decayed = DIGITS / math.asinh(kernel.length / half_width)
        return max(m + 2, math.ceil(0.5 * (m + decayed)))
    return max(4, math.ceil(DIGITS / float(decay_rate(max(kernel.reach / half_width - 1, 0.05)))))
