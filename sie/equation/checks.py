"""Checks of a user's functions at a few points, made once before an equation is solved.

Values must be real and of the right shape. A primitive must rise by the integral of its function,
and so must the potential of a kernel's regular part. On symmetric zones the right side must be odd.
Three declarations are also tested: that a regular kernel depends on x - xi only, that a weight is a
polynomial of a given degree, and that a column has a given number of modes.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from sie.basis import chebyshev
from sie.basis.data import HALF_DIGITS, SUM_ROUNDING, Array
from sie.basis.kernels import Kernel
from sie.basis.zones import MAX_ASYMMETRY, Zones
from sie.equation.conditions import Weighted, speaks_of_levels
from sie.equation.equation import Equation
from sie.equation.forcing import Forcing


@dataclass(frozen=True)
class CheckOptions:
    """Positions at which a user's functions are checked, and tolerances of these checks.

    A declared degree, number of modes or dependence on x - xi must hold to half of all digits.
    """

    # Positions of the check points on each of at most three zones, from -1 to 1 on a zone.
    places: tuple[float, ...] = (-0.7, 0.1, 0.6)
    # Half lengths of two intervals, relative to the zone's half width. A primitive must rise over
    # an interval by the integral of its function. The second, shorter interval is for functions
    # that vary too fast for five values on the first interval.
    steps: tuple[float, ...] = (1e-3, 2e-5)
    # Largest difference between the slope of a primitive and its function, relative to the
    # function's largest value. This tolerance is above the round-off for both lengths of intervals.
    max_slope_error: float = 1e-4
    # Number of Chebyshev coefficients beyond the declared degree or number of modes that are
    # checked to be zero.
    extra_coefficients: int = 8


OPTIONS = CheckOptions()
_T = np.array(OPTIONS.places)


def check_functions(equation: Equation, zones: Zones) -> None:
    """Raise ValueError if a function of the equation contradicts what is declared about it."""
    how = (
        any(
            condition.count(zones) > 0 and speaks_of_levels(condition, zones)
            for condition in equation.conditions
        ),
        zones.symmetric,
        zones.weight.is_complex,
    )
    low, high = equation.within
    if not (low < zones.a[0] and zones.b[-1] < high):
        raise ValueError(
            f"the zones [{zones.a[0]:.6g}, {zones.b[-1]:.6g}] do not lie inside the interval "
            "`within`, "
            f"({low:.6g}, {high:.6g})"
        )
    for condition in equation.conditions:
        if isinstance(condition, Weighted) and condition.degree is not None:
            _check_degree(
                f"{type(condition).__name__}: its weight", condition.weight, condition.degree, zones
            )
    parts = [
        ("the right side", equation.forcing),
        *((f"column {k}", column) for k, column in enumerate(equation.columns)),
    ]
    for name, forcing in parts:
        if not forcing._is_trusted and how not in _seen(forcing):
            _check_forcing(name, forcing, _places(zones), *how)
            _check_modes(name, forcing, zones)
            _seen(forcing).add(how)
    # Kernels with a regular part made by `sie` itself are not checked: their `grows` is false.
    if equation.kernel.grows and how not in _seen(equation.kernel):
        _check_kernel(equation.kernel, *_places(zones), *how[:2])
        _check_lag(equation.kernel, *_places(zones))
        _seen(equation.kernel).add(how)


def _seen(part: Forcing | Kernel) -> set[tuple[bool, bool, bool]]:
    """Cases in which the functions of `part` have been checked.

    A case is (whether potentials are needed, whether zones are symmetric, whether values may be
    complex).
    """
    found: set[tuple[bool, bool, bool]] = part.__dict__.setdefault("_checked", set())
    return found


def _places(zones: Zones) -> tuple[Array, Array]:
    """(points at which functions are checked, half width of the zone of each point)."""
    some = _three_zones(zones)
    x = zones.middle[some, None] + zones.half[some, None] * _T
    return x.ravel(), np.repeat(zones.half[some], len(_T))


def _three_zones(zones: Zones) -> list[int]:
    """Indices of three solved zones: the first, one in the middle, and the last."""
    return sorted(
        {int(zones.solved[0]), int(zones.solved[len(zones.solved) // 2]), int(zones.solved[-1])}
    )


def _called(name: str, function: Callable[..., Any], *places: Array) -> Any:
    """The result of a user's function; ValueError with `name` if the function raises."""
    try:
        with np.errstate(all="ignore"):
            return function(*places)
    except Exception as error:
        shapes = " and ".join(str(place.shape) for place in places)
        raise ValueError(
            f"{name} fails for arrays of shape {shapes}: {type(error).__name__}: {error}"
        ) from error


def _real(
    name: str, returned: Any, shape: tuple[int, ...], given: str, or_complex: bool = False
) -> Any:
    """The values that a user's function returned; ValueError if not real or of a wrong shape.

    or_complex: whether they may be complex.
    """
    values = np.asarray(returned)
    if values.dtype.kind == "c" and not or_complex:
        raise ValueError(
            f"{name} must return real numbers, got complex ones: if this is a right side, "
            "solve one equation for its real part and one for its imaginary part"
        )
    if values.dtype.kind not in ("fiubc" if or_complex else "fiub"):
        raise ValueError(f"{name} must return numbers, got {type(returned).__name__} for {given}")
    if values.shape == shape and not isinstance(returned, np.ndarray):
        raise ValueError(
            f"{name} must return an array of shape {shape} for {given}, got "
            f"{type(returned).__name__}"
        )
    if values.shape != shape:
        raise ValueError(
            f"{name} must return an array of shape {shape} for {given}, got shape {values.shape}"
        )
    return np.asarray(values, dtype=complex if or_complex else float)


def _check_forcing(
    name: str,
    forcing: Forcing,
    places: tuple[Array, Array],
    levels: bool,
    symmetric: bool,
    or_complex: bool,
) -> None:
    """Raise ValueError for a wrong value or primitive of a function on the right side."""
    x, half = places
    for part, function in (("value", forcing.value), ("primitive", forcing.primitive)):
        if not (callable(function) or (part == "primitive" and function is None)):
            raise ValueError(
                f"{name}: {part} must be a function of x, got {type(function).__name__}"
            )

    def of(part: str, function: Callable[[Array], Array], places: Array) -> Any:
        returned, shape = _called(f"{name}: {part}", function, places.ravel()), (places.size,)
        given = f"x of shape ({places.size},)"
        return _real(f"{name}: {part}", returned, shape, given, or_complex).reshape(places.shape)

    value = partial(of, "value", forcing.value)
    g = value(x)
    if symmetric:
        _check_symmetry(f"{name}: value", g, value(-x), x)
    if forcing.primitive is not None and levels and not forcing.density_jumps:
        primitive = partial(of, "primitive", forcing.primitive)
        for turn in (1.0, -1j) if or_complex else (1.0,):
            both = partial(_turned, value, turn), partial(_turned, primitive, turn)
            _check_rise(f"{name}: primitive", "value", *both, x, half)


def _turned(function: Callable[[Array], Any], factor: complex, x: Array) -> Array:
    """Real parts of a function's values times a factor."""
    return np.asarray(np.real(function(x) * factor))


def _check_kernel(kernel: Kernel, x: Array, half: Array, levels: bool, symmetric: bool) -> None:
    """Raise ValueError for a wrong value or potential of the kernel's regular part."""
    regular, potential = kernel.regular, kernel.regular_potential
    assert regular is not None
    xi = x[::-1]

    def of(name: str, function: Callable[[Array, Array], Array], at: Array, source: Array) -> Array:
        shape = np.broadcast_shapes(at.shape, source.shape)
        given = f"x of shape {at.shape} and xi of shape {source.shape}"
        return _real(
            f"the kernel's {name}",
            _called(f"the kernel's {name}", function, at, source),
            shape,
            given,
        )

    values = of("regular part", regular, x[:, None, None], np.array([xi, xi]))
    if symmetric:
        _check_symmetry(
            "the kernel's regular part",
            values,
            of("regular part", regular, -x[:, None, None], -np.array([xi, xi])),
            x,
        )
    if potential is not None and levels:
        of("regular potential", potential, x[:, None, None], np.array([xi, xi]))
        _check_rise(
            "the kernel's regular potential",
            "regular part",
            lambda at: of("regular part", regular, at, xi[:, None]),
            lambda at: of("regular potential", potential, at, xi[:, None]),
            x,
            half,
        )


def _check_degree(name: str, weight: Callable[[Array], Array], degree: int, zones: Zones) -> None:
    """Raise ValueError for a weight that is not a polynomial of the declared degree."""
    for zone in _three_zones(zones):
        x = zones.middle[zone] + zones.half[zone] * chebyshev.gauss(
            degree + 1 + OPTIONS.extra_coefficients
        )
        returned = np.asarray(_called(name, weight, x))
        values = _real(
            name,
            returned if returned.ndim else np.broadcast_to(returned, x.shape),
            x.shape,
            f"x of shape {x.shape}",
        )
        size = np.abs(chebyshev.t_means(values))
        beyond = size[degree + 1 :].max()
        if beyond > HALF_DIGITS * size.max() + _of_places(x, zones.half[zone], values):
            raise ValueError(
                f"{name} is not a polynomial of degree {degree}: on zone {zone} (counted from 0) "
                f"it has terms of higher degree, {beyond / size.max():.1e} of the largest term; "
                "give its true degree, or leave the degree out"
            )


def _check_modes(name: str, forcing: Forcing, zones: Zones) -> None:
    """Raise ValueError for a term of unknown amplitude that has more modes than declared."""
    modes = forcing.resolution.modes
    if modes is None:
        return
    count = modes + OPTIONS.extra_coefficients
    t = chebyshev.lobatto(count)[0][1:-1]
    for zone in _three_zones(zones):
        x = zones.middle[zone] + zones.half[zone] * t
        returned = _called(name, forcing.value, x)
        values = _real(name, returned, x.shape, f"x of shape {x.shape}", zones.weight.is_complex)
        size = np.abs(chebyshev.u_coefficients(values[None])[0])
        beyond = size[modes:].max()
        if beyond > HALF_DIGITS * size.max() + _of_places(x, zones.half[zone], values):
            raise ValueError(
                f"{name} has more than modes={modes} modes: on zone {zone} (counted from 0) "
                f"further modes reach {beyond / size.max():.1e} of the largest mode; give more "
                "modes, or leave `modes` out"
            )


def _of_places(x: Array, length: float, values: Array) -> float:
    """Change of `values` due to round-off of the places x; `length`: over which the values vary."""
    return float(8 * np.spacing(np.abs(x).max()) / max(length, 1e-300) * np.ptp(values))


def _check_lag(kernel: Kernel, x: Array, half: Array) -> None:
    """Raise ValueError if a regular part declared to depend only on x - xi depends on more."""
    if not kernel.of_lag or kernel.regular is None:
        return
    # Both x and xi are shifted by the same distance, which is so short that both stay within their
    # zones.
    places = x.reshape(-1, len(_T))[:, :2].ravel()
    target, source = np.repeat(places, len(places)), np.tile(places, len(places))
    shift = (_T[2] - _T[1]) * half.min()
    lag, values = target - source, []
    for moved in (0.0, shift):
        at = source + moved
        values.append(
            _real(
                "the kernel's regular part",
                kernel.regular(at + lag, at),
                at.shape,
                f"x of shape {at.shape}",
            )
        )
    size = np.abs(values[0]).max(initial=0.0)
    rounding = _of_places(x, shift, values[0])
    difference = np.abs(values[1] - values[0])
    worst = int(np.argmax(difference))
    if difference[worst] > HALF_DIGITS * size + rounding:
        raise ValueError(
            "the kernel's regular part is declared to depend on x - xi alone (of_lag=True), but "
            f"for x - xi = {lag[worst]:.6g} it is "
            f"{values[0][worst]:.6g} at xi = {source[worst]:.6g} and {values[1][worst]:.6g} at xi "
            f"= {source[worst] + shift:.6g}"
        )


def _check_symmetry(name: str, here: Array, there: Array, x: Array) -> None:
    """Raise ValueError unless the values `there` at -x are minus the values `here` at x."""
    size = np.abs(here).max(initial=0.0)
    difference = np.abs(here + there).reshape(len(x), -1).max(axis=1)
    worst = int(np.argmax(difference))
    if np.isfinite(difference).all() and difference[worst] > MAX_ASYMMETRY * size:
        raise ValueError(
            f"zones with symmetric=True need odd functions, but {name} is not odd: its values at "
            f"x = {x[worst]:.6g} and at x = {-x[worst]:.6g} should add up to 0, but the size of "
            f"their sum is {difference[worst]:.3g}; use symmetric=False"
        )


# Points of the interval from -1 to 1 that divide it into parts of unequal lengths.
_UNEVEN = np.array([-1.0, -0.63, 0.09, 0.48, 1.0])


def _check_rise(
    name: str,
    of: str,
    value: Callable[[Array], Array],
    primitive: Callable[[Array], Array],
    x: Array,
    half: Array,
) -> None:
    """Raise ValueError for a primitive whose slope is not the given function.

    By the mean value theorem, the primitive rises over a short interval by the interval's length
    times a value of the function there. If the discrepancy of the rise does not become smaller on a
    shorter interval, it is round-off and no error. The interval is also divided into parts of
    unequal lengths. If the discrepancy differs between the parts by more than its least size, it
    is round-off, too.
    """
    wrong, longer, missing = np.ones(len(x), dtype=bool), np.zeros(len(x)), np.zeros(len(x))
    for step in OPTIONS.steps:
        h = np.maximum(step * half, 1e7 * np.spacing(np.abs(x)))
        places = x[:, None] + h[:, None] * _UNEVEN
        g = value(places)
        with np.errstate(invalid="ignore"):
            ends = primitive(places)
            rises = np.diff(ends) / (h[:, None] * np.diff(_UNEVEN))
            low, high, size = g.min(axis=1), g.max(axis=1), np.abs(g).max(initial=0.0)
            # `slack` is the accepted discrepancy. If the primitive has large values, its rise over
            # a short interval may be only round-off.
            slack = (
                (high - low)
                + np.ptp(rises, axis=1)
                + OPTIONS.max_slope_error * size
                + SUM_ROUNDING * np.abs(ends).max(axis=1) / h
            )
            # The half length `h` has a lower limit, because positions are rounded. Points are
            # skipped if `h` is too large for their zone, or if values of `g` are not finite.
            below, above = low - rises.max(axis=1), rises.min(axis=1) - high
            missed = 2 * h * (np.maximum(below, above) - slack)
            wrong &= (missed > 0.0) & (missing >= 0.5 * np.sqrt(longer / h) * missed)
            wrong &= (h < 0.1 * half) & np.isfinite(g).all(axis=1)
        if not wrong.any():
            return
        longer, missing = h, missed
    worst = int(np.flatnonzero(wrong)[0])
    middle = 0.5 * (low[worst] + high[worst])
    raise ValueError(
        f"{name} is not an antiderivative of its {of}: at x = {x[worst]:.6g} its slope is "
        f"{rises[worst].mean():.6g}, not {middle:.6g}"
    )
