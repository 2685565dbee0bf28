"""Whether what profiles, interactions and substrates of someone's own return and declare is what
the rest of the package counts on.

Looked at once, when a scene is made. Of a profile its form: a wrong shape is then named, and does
not come up as an error of numpy's in the middle of a solution. Whether the values agree with each
other is for `contact.testing.check_profile`.

An interaction gives an elastic operator, and all of it the same one: the kernel must be one of x -
xi alone, odd (what a load at one place does at another it does from there as well), scaled with the
unit of length, the derivative of its own potential, and repeat with the period or not at all; a
symbol must be that of the kernel. Each is held at a few places, and what is wrong is named.

A substrate gives the symbol of an elastic body: it must be real, finite and of the shape of q from
waves of the length of a planet to those of an atom, above zero, 1 for short waves, and for long
ones as the `compression` says. What is wrong is named.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

import sie
from contact.errors import SceneError, shown
from contact.model.checks import as_array, of_author, positive_or_none, such
from contact.model.operator import Operator, smooth_potential
from contact.model.profiles.base import Profile
from contact.model.substrates.base import Substrate
from contact.model.symbols import WAVES, checked
from sie import Array

# Shapes of what arrays with one row a place must have beyond the first axis.
_TABLES = {
    "kinks": (2, "position and jump of the slope"),
    "jumps": (3, "position, order, and jump of that derivative"),
    "algebraic_points": (
        4,
        "position, exponent, and the coefficients of that power of the distance on the left and on the right",
    ),
}
# Places of a cell, or of a part that is known, at which heights must be numbers.
_LOOKED_AT = 4097
# A variation of heights [m] whose square, times that of a length, is a number.
_LARGEST = 1e120
_SPREAD = np.array([[-0.43, -0.21, -0.057], [0.11, 0.29, 0.47]])
_DECADES = np.array([[-0.43, -1.1e-3, -1.3e-9], [1.7e-6, 1.9e-4, 0.29]])


def require_declared(profile: Profile) -> None:
    """SceneError that names the first attribute or method of the profile that has not the form it
    must have.
    """
    require_declarations(profile)
    x = _places(profile)
    _require_by_elements(profile, "height", x)
    _require_heights(profile, x)
    _require_by_elements(profile, "slope", x)


def _require_heights(profile: Profile, x: Array) -> None:
    """SceneError where heights are no numbers, or larger than can be squared.

    x: where to look at a profile without ends.
    """
    ends = profile.known or profile.support
    x = np.linspace(*ends, _LOOKED_AT) if ends is not None else x
    with of_author("profile.height(x)", "height"):
        heights = np.asarray(profile.height(x.copy()), dtype=np.float64)
    # Without ends, far places need not matter: where it is looked for the contact, they do.
    if ends is not None:
        require_numbers(x, heights)
    near = heights if ends is not None else heights[np.abs(x) <= np.median(np.abs(x))]
    with np.errstate(over="ignore"):
        size = float(np.ptp(near[np.isfinite(near)])) if np.isfinite(near).any() else 0.0
    if not size < _LARGEST:
        told = (
            f"profile.height(x) varies by {size:.3g} m about x = {np.median(x):.3g} m: more than "
            f"{_LARGEST:.0e} m cannot be squared as a number; is the unit of length the metre?"
        )
        raise SceneError(told, "height", size)


def require_numbers(x: Array, heights: Array) -> None:
    """SceneError that names the first place at which a height is nan, or below all numbers."""
    lost = np.isnan(heights) | np.isneginf(heights)
    if lost.any():
        x, heights = x[lost], heights[lost]
        k = int(np.argmin(x))
        told = (
            f"profile.height(x) is {heights.ravel()[k]} at x = {x.ravel()[k]:.9g} m: "
            "it must be a number, or +inf where there is no body"
        )
        raise SceneError(told, "height", float(heights.ravel()[k]))


def require_declarations(profile: Profile) -> None:
    """The same of its attributes alone."""
    positive_or_none("profile.period", _read(profile, "period"))
    for name in ("support", "extent"):
        ends = _read(profile, name)
        if ends is not None and not (
            _is_real(ends, 1) and np.shape(ends) == (2,) and ends[0] < ends[1]
        ):
            raise SceneError.of(
                f"profile.{name}", ends, "None, or a left and a larger right end [m]"
            )
    positive_or_none("profile.resolution", _read(profile, "resolution"))
    for name, (columns, meaning) in _TABLES.items():
        table = _read(profile, name)
        if not (isinstance(table, np.ndarray) and _is_real(table, 2) and table.shape[1] == columns):
            allowed = (
                f"a numpy array of finite rows of {columns}: {meaning} (a property, not a method)"
            )
            raise SceneError.of(f"profile.{name}", table, allowed)
    low = profile.algebraic_points[profile.algebraic_points[:, 1] <= 1.0]
    if len(low):
        allowed = "rows whose exponent is above 1 (1 is a kink: declare it in kinks; below 1 is a cusp, infinitely steep)"
        raise SceneError.of("profile.algebraic_points", low[0].tolist(), allowed)
    tips = _read(profile, "summits")
    if tips is not None and not (_is_real(tips, 1) and np.size(tips)):
        raise SceneError.of(
            "profile.summits", tips, "None, or a one-dimensional array of positions [m]"
        )
    if not isinstance(symmetric := _read(profile, "symmetric"), (bool, np.bool_)):
        raise SceneError.of(
            "profile.symmetric", symmetric, "True or False (a property, not a method)"
        )


def _read(profile: Profile, name: str) -> Any:
    with of_author(f"profile.{name}", f"profile.{name}"):
        value = getattr(profile, name)
    return value


def _is_real(value: Any, axes: int) -> bool:
    array = as_array(value)
    return array.dtype.kind in "iuf" and array.ndim == axes and bool(np.isfinite(array).all())


def _places(profile: Profile) -> Array:
    """A few places (2, 3) at which there should be a profile."""
    ends = profile.known if profile.period is not None else profile.support or profile.extent
    if ends is not None:
        return 0.5 * (ends[0] + ends[1]) + (ends[1] - ends[0]) * _SPREAD
    return (profile.resolution or 1.0) * _DECADES


def _require_by_elements(profile: Profile, name: str, x: Array) -> None:
    for given in (x, x.ravel()):
        hint = "; it must work on arrays, element by element (numpy's functions, not math's)"
        with (
            of_author(f"profile.{name}(x)", name, f" for an array of shape {given.shape}", hint),
            warnings.catch_warnings(),
        ):
            warnings.simplefilter("ignore")
            value = np.asarray(getattr(profile, name)(given.copy()))
        if value.dtype.kind not in "iuf" or value.shape != given.shape:
            got = f"for x of shape {given.shape} gives {shown(value)}, of type {value.dtype} and shape {value.shape}"
            raise SceneError(
                f"profile.{name}(x) {got}: it must be real and of the shape of x", name, value
            )
        if not (np.isfinite(value) | (np.isposinf(value) & (name == "height"))).any():
            raise SceneError(
                f"profile.{name}(x) is nowhere a finite number: not at x = {x.ravel().tolist()}",
                name,
                value,
            )


# Lags over the length that sets the scale, the width of the steps of the potential over it, and how
# far values that agree may be off.
_LAGS = np.array([0.0137, 0.113, 0.239, 0.318, 0.461])
_STEP = 1e-3
_NEAR = 1e-7
_ROUNDING = 1e-12
_SHIFT = 0.271
_HARMONICS = 64
_PLACES = 4096


def require_elastic(operator: Operator, scale: float) -> None:
    """SceneError that names the first claim that does not hold of an interaction with a kernel or a
    symbol of its own. scale [m]: of a length over which the contact varies.
    """
    interaction, period = operator.interaction, operator.period
    unit = period or scale
    kernel = _kernel(operator, unit)
    if kernel.regular is not None:
        _require_regular(kernel)
    if interaction.strip:
        return
    repeats = None if period is None else period / unit
    if kernel.period != repeats:
        wanted = (
            "that of the profile, since the model needs one"
            if repeats
            else "None, since the model needs none"
        )
        raise SceneError.of("interaction.kernel.period", kernel.period, f"{wanted}: {repeats}")
    if repeats is not None:
        here, there = _value(kernel, _LAGS), _value(kernel, _LAGS - repeats)
        _require_same(here, there, "kernel", "does not repeat with the period")
    other = _kernel(operator, 2 * unit)
    what = (
        "does not scale with the unit of length: lengths in it are those of the scene over `unit`"
    )
    _require_same(0.5 * _value(other, 0.5 * _LAGS), _value(kernel, _LAGS), "kernel", what)
    datum = getattr(interaction, "datum", None)
    if period is None and datum is not None and abs(kernel.datum * unit / datum - 1) > 1e-9:
        raise SceneError.of(
            "interaction.datum",
            datum,
            f"the length in the kernel's logarithm, {kernel.datum * unit:.6g} m",
        )
    if repeats is not None:
        _require_symbol(operator, kernel)


def _kernel(operator: Operator, unit: float) -> sie.Kernel:
    with of_author("interaction.kernel(period, unit)", "interaction"):
        kernel = operator.kernel(unit)
    return kernel


def _require_regular(kernel: sie.Kernel) -> None:
    """The smooth part, in units in which the scale is 1."""
    regular, potential = kernel.regular, kernel.regular_potential
    assert regular is not None
    if potential is None:
        what = "the smooth part of interaction.kernel has no potential, by which the gap is known: give sie.Smooth both"
        raise SceneError(what, "interaction")
    zero = np.zeros(1)
    for name, function in (("value", regular), ("potential", potential)):
        x, xi = _LAGS[:, None], np.array([0.0, 0.05])
        with of_author(
            f"the {name} of the smooth part of interaction.kernel", "interaction", " for arrays"
        ):
            table = np.asarray(function(x, xi))
        if (
            table.dtype.kind not in "iuf"
            or table.shape != (len(_LAGS), 2)
            or not np.all(np.isfinite(table))
        ):
            got = f"the {name} of the smooth part of interaction.kernel for x (5, 1) and xi (2,) gives {shown(table)}"
            raise SceneError(
                f"{got}: it must be real, finite and of the shape of x - xi", "interaction"
            )
        # Compared with what it comes to anywhere: a sum of large parts may vanish at one place.
        _require_same(
            function(x + _SHIFT, xi + _SHIFT),
            table,
            f"smooth part's {name}",
            "is not one of x - xi alone",
        )
    value, minus = regular(_LAGS, zero), regular(-_LAGS, zero)
    _require_same(
        -minus,
        value,
        "smooth part",
        "is not odd in x - xi: what a load does elsewhere, one elsewhere does here",
    )
    nodes, weights = np.polynomial.legendre.leggauss(5)
    rise = potential(_LAGS + 0.5 * _STEP, zero) - potential(_LAGS - 0.5 * _STEP, zero)
    within = (
        0.5 * _STEP * np.asarray(regular((_LAGS[:, None] + 0.5 * _STEP * nodes), zero)) @ weights
    )
    size = _ROUNDING * float(np.abs(potential(_LAGS, zero)).max())
    _require_same(rise, within, "smooth part", "is not the derivative in x of its potential", size)


def _require_symbol(operator: Operator, kernel: sie.Kernel) -> None:
    """The kernel's own symbol, L_n = 1 - 2 n int rest cos(2 pi n u) du: above zero, and what is
    declared.
    """
    turns = np.arange(_PLACES) / _PLACES
    lag = turns - np.round(turns)
    plain = sie.hilbert(1.0)
    rest = smooth_potential(kernel, lag) - smooth_potential(plain, lag)
    n = np.arange(1, _HARMONICS + 1)
    found = 1 - 2 * n * np.fft.rfft(rest).real[1 : _HARMONICS + 1] / _PLACES
    if not np.all(found > 0):
        k = int(np.argmin(found))
        allowed = "one of an elastic body, of a symbol above 0: else pressure lifts the surface, and no contact is the only one"
        raise SceneError.of(
            "interaction.kernel", f"of symbol {found[k]:.6g} at wave {k + 1} of the period", allowed
        )
    excess = operator.excess
    if excess is not None:
        declared = 1 + np.concatenate((excess, np.zeros(_HARMONICS)))[:_HARMONICS]
        if not np.allclose(declared, found, rtol=0, atol=1e-9 * np.arange(1, _HARMONICS + 1)):
            k = int(np.argmax(np.abs(declared - found)))
            wanted = f"that of the kernel at wave {k + 1} of the period, {found[k]:.9g}"
            raise SceneError.of("interaction.symbol", float(declared[k]), wanted)


def _value(kernel: sie.Kernel, lag: Array) -> Array:
    out = sum((1 / (lag - pole) for pole in kernel.poles), np.zeros(len(lag)))
    return out if kernel.regular is None else out + np.asarray(kernel.regular(lag, np.zeros(1)))


def _require_same(one: Array, other: Array, what: str, fault: str, rounding: float = 0.0) -> None:
    off, size = np.abs(np.asarray(one) - other), np.abs(np.asarray(other))
    if not np.all(off <= _NEAR * size.max() + rounding):
        k = int(np.argmax(off))
        told = f"{np.ravel(one)[k]:.9g} against {np.ravel(other)[k]:.9g}"
        raise SceneError(f"the {what} of interaction.kernel {fault}: {told}", "interaction")


# How near 1 the symbol comes for the shortest waves; how near its limit for the longest; and what
# is no limit above zero.
_SHORT = 1e-13
_LONG = 1e-6
_VANISHES = 1e-6
# Where L - 1 is still known to some digits; no power of the wave falls faster there than
# exponentials do.
_SEEN = 1e-11
_SLOWEST = -8.0


def require_body(substrate: Substrate) -> None:
    """SceneError that names the first claim of the substrate that does not hold."""
    values = checked(substrate.symbol, WAVES, "substrate")
    checked(substrate.symbol, WAVES[: 2 * (len(WAVES) // 2)].reshape(2, -1), "substrate")
    again = checked(substrate.symbol, WAVES[::-1], "substrate")[::-1]
    if not np.allclose(again, values, rtol=1e-12, atol=0):
        raise SceneError(
            "substrate.symbol(q) depends on the other waves of q: it must be taken element by element",
            "substrate",
        )
    _require_fast(values)
    if not abs(values[-1] - 1) < _SHORT:
        raise SceneError.of(
            "substrate.symbol(q)",
            float(values[-1]),
            f"1 for short waves, as it is not at q = {WAVES[-1]:.0e} 1/m: what is solved is the "
            "body's compliance over that of a half-plane of its own surface's modulus E_star",
        )
    with of_author("substrate.compression", "substrate.compression"):
        compression: Any = substrate.compression
    if compression is not None:
        allowed = "None, or a length of at least 0 [m] (a property, not a method)"
        compression = such(
            "substrate.compression", compression, allowed, lambda length: length >= 0
        )
    long, wave = float(values[0]), float(WAVES[0])
    if compression is None:
        if long < _VANISHES:
            raise SceneError.of(
                "substrate.compression",
                None,
                f"given, since the symbol vanishes for long waves (L = {long:.3g} at q = {wave:.0e} 1/m): "
                "the body has a base, and the limit of L(q)/q is by how much a uniform pressure compresses it",
            )
        return
    # About the height of the body [m] is the inverse of the wave at which L goes over to 1.
    found, height = long / wave, float(1 / WAVES[np.argmax(values > 0.5)])
    if not abs(found - compression) <= _LONG * max(abs(compression), 1e-3 * height):
        raise SceneError.of(
            "substrate.compression",
            compression,
            f"the limit of L(q)/q for long waves, about {found:.6g} m",
        )


def _require_fast(values: Array) -> None:
    """L comes to 1 as an exponential does, not as a power of q."""
    off = np.abs(values - 1)
    seen = np.flatnonzero(off > _SEEN)
    k = int(seen[-1]) if len(seen) else 0
    if k == 0 or off[-1] >= 0.9 * off[k // 2]:  # another limit is another fault
        return
    with np.errstate(divide="ignore"):
        power = (
            float(np.log(off[k] / off[k - 1]) / np.log(WAVES[k] / WAVES[k - 1]))
            if off[k - 1] > 0
            else -np.inf
        )
    if power > _SLOWEST:
        raise SceneError.of(
            "substrate.symbol(q)",
            float(values[k]),
            f"1 for short waves as by exp(-q h), and not as q^{power:.2g}, as about q = "
            f"{WAVES[k]:.3g} 1/m: a modulus that varies from the very surface on has no smooth kernel; give it a uniform surface layer",
        )
