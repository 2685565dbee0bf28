"""Check that a user's interaction or substrate describes an elastic body.

An interaction gives an elastic operator in several forms that must agree. The kernel must be an odd
function of x - xi alone: a load at xi displaces x as much as a load at x displaces xi. The kernel
must scale with the unit of length, be the derivative of its own potential, and repeat with the
period or not at all. A declared symbol must be that of the kernel. Each claim is tested at a few
places.

A substrate gives the symbol of an elastic body. The symbol must be real, finite and of the shape of
q, for wavelengths from the size of an atom to that of a planet. It must be above zero, 1 for short
waves, and for long waves it must agree with the `compression`.
"""

from __future__ import annotations

from math import isqrt
from typing import Any

import numpy as np

import sie
from contact.errors import SceneError, shown
from contact.model.checks import checked_number, of_author
from contact.model.operator import Operator, smooth_potential
from contact.model.plugin_checks.jumps import CHECKS
from contact.model.profiles.noise import EPS, ROUND_OFF
from contact.model.substrates.base import Substrate
from contact.model.symbols import OPTIONS as SYMBOLS
from contact.model.symbols import WAVES, checked
from sie import Array

# Distances x - xi at which values of the kernel are compared, in units of the period. Without a
# period, the unit is the parameter `scale`. All distances are below one half of the unit.
_LAGS = np.random.default_rng(0).uniform(0.0, 0.5, 5)


def require_elastic(operator: Operator, scale: float) -> None:
    """Raise a SceneError that names the first false declaration of a user's interaction.

    scale: a length [m] over which the contact varies.
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
            "the profile's period divided by `unit`, since the model needs a period"
            if repeats
            else "since the model needs no period"
        )
        raise SceneError.of("interaction.kernel.period", kernel.period, f"{repeats}, {wanted}")
    if repeats is not None:
        here, there = _value(kernel, _LAGS), _value(kernel, _LAGS - repeats)
        _require_same(here, there, "value", "does not repeat with the period")
    other = _kernel(operator, 2 * unit)
    what = "does not scale with the unit of length (divide every length in the kernel by `unit`)"
    _require_same(0.5 * _value(other, 0.5 * _LAGS), _value(kernel, _LAGS), "value", what)
    datum = getattr(interaction, "datum", None)
    if period is None and datum is not None and abs(kernel.datum * unit / datum - 1) > 1e-9:
        raise SceneError.of(
            "interaction.datum",
            datum,
            f"the datum of the kernel times `unit`, {kernel.datum * unit:.6g} m",
        )
    if repeats is not None:
        _require_symbol(operator, kernel)


def _kernel(operator: Operator, unit: float) -> sie.Kernel:
    with of_author("interaction.kernel(period, unit)", "interaction"):
        kernel = operator.kernel(unit)
    return kernel


def _require_regular(kernel: sie.Kernel) -> None:
    """Raise a SceneError that names the first fault of the kernel's smooth part.

    Lengths are scaled so that the kernel varies over a length of 1.
    """
    regular, potential = kernel.regular, kernel.regular_potential
    assert regular is not None
    if potential is None:
        what = (
            "the smooth part of interaction.kernel has no potential, from which the gap is "
            "computed: give sie.Smooth both the value and the potential"
        )
        raise SceneError(what, "interaction")
    zero = np.zeros(1)
    for name, function in (("value", regular), ("potential", potential)):
        x, xi = _LAGS[:, None], _LAGS[:2]
        with of_author(
            f"the {name} of the smooth part of interaction.kernel", "interaction", " for arrays"
        ):
            table = np.asarray(function(x, xi))
        if (
            table.dtype.kind not in "iuf"
            or table.shape != (len(_LAGS), 2)
            or not np.all(np.isfinite(table))
        ):
            got = (
                f"for x of shape (5, 1) and xi of shape (2,), the {name} of the smooth part of "
                f"interaction.kernel is {shown(table)}"
            )
            raise SceneError(
                f"{got}: it must be real, finite and of the shape of x - xi", "interaction"
            )
        # The function should depend on x - xi only. So adding the same length to x and xi must not
        # change its value.
        _require_same(
            function(x + _LAGS[1], xi + _LAGS[1]),
            table,
            f"smooth part's {name}",
            "does not depend on x - xi alone",
        )
    value, minus = regular(_LAGS, zero), regular(-_LAGS, zero)
    _require_same(
        -minus,
        value,
        "smooth part",
        "is not odd in x - xi, as an elastic body requires (reciprocal theorem)",
    )
    nodes, weights = np.polynomial.legendre.leggauss(5)
    # The rise of the potential over the distance 2 `half` is compared with the integral of the
    # smooth part over the same distance. Over a longer distance the quadrature would be less
    # accurate. Over a shorter one the difference of the potentials would lose digits.
    half = 0.5 * np.sqrt(CHECKS.same)
    rise = potential(_LAGS + half, zero) - potential(_LAGS - half, zero)
    within = half * np.asarray(regular(_LAGS[:, None] + half * nodes, zero)) @ weights
    # `rise` is a difference of two potentials, so its round-off is relative to the size of the
    # potentials.
    size = ROUND_OFF * float(np.abs(potential(_LAGS, zero)).max())
    _require_same(
        rise,
        within,
        "smooth part",
        "is not the derivative of its potential with respect to x",
        size,
    )


def _require_symbol(operator: Operator, kernel: sie.Kernel) -> None:
    """Raise SceneError if the symbol of the kernel is not positive, or differs from the declared
    one.

    Lengths are in units of the period. With u = x - xi, the symbol at harmonic n is
    L_n = 1 - 2 n int rest(u) cos(2 pi n u) du. Here `rest` is the potential of the kernel minus the
    potential of line loads on a half-plane.
    """
    places = SYMBOLS.harmonics
    harmonics = isqrt(places)
    turns = np.arange(places) / places
    lag = turns - np.round(turns)
    plain = sie.hilbert(1.0)
    rest = smooth_potential(kernel, lag) - smooth_potential(plain, lag)
    n = np.arange(1, harmonics + 1)
    found = 1 - 2 * n * np.fft.rfft(rest).real[1 : harmonics + 1] / places
    if not np.all(found > 0):
        k = int(np.argmin(found))
        allowed = (
            "a kernel whose symbol is above 0: otherwise pressure would not press the surface "
            "down, and a load could have several contacts"
        )
        raise SceneError.of(
            "interaction.kernel",
            f"kernel with symbol {found[k]:.6g} at harmonic {k + 1} of the period",
            allowed,
        )
    excess = operator.excess
    if excess is not None:
        declared = 1 + np.concatenate((excess, np.zeros(harmonics)))[:harmonics]
        if not np.allclose(declared, found, rtol=0, atol=1e-9 * np.arange(1, harmonics + 1)):
            k = int(np.argmax(np.abs(declared - found)))
            wanted = f"the kernel's symbol at harmonic {k + 1} of the period, {found[k]:.9g}"
            raise SceneError.of("interaction.symbol", float(declared[k]), wanted)


def _value(kernel: sie.Kernel, lag: Array) -> Array:
    out = sum((1 / (lag - pole) for pole in kernel.poles), np.zeros(len(lag)))
    return out if kernel.regular is None else out + np.asarray(kernel.regular(lag, np.zeros(1)))


def _require_same(one: Array, other: Array, what: str, fault: str, rounding: float = 0.0) -> None:
    """Raise a SceneError that names the fault if two arrays differ by more than round-off."""
    # A sum of large terms may vanish at one place. The difference is therefore compared with the
    # largest value at all places.
    difference, size = np.abs(np.asarray(one) - other), np.abs(np.asarray(other))
    if not np.all(difference <= CHECKS.same * size.max() + rounding):
        k = int(np.argmax(difference))
        values = f"{np.ravel(one)[k]:.9g} and {np.ravel(other)[k]:.9g} should be equal"
        raise SceneError(f"the {what} of interaction.kernel {fault}: {values}", "interaction")


def require_body(substrate: Substrate) -> None:
    """Raise a SceneError that names the first false declaration of a substrate."""
    values = checked(substrate.symbol, WAVES, "substrate")
    checked(substrate.symbol, WAVES[: 2 * (len(WAVES) // 2)].reshape(2, -1), "substrate")
    again = checked(substrate.symbol, WAVES[::-1], "substrate")[::-1]
    if not np.allclose(again, values, rtol=1e-12, atol=0):
        raise SceneError(
            "substrate.symbol(q) at one wavenumber depends on the other elements of q: compute it "
            "element by element",
            "substrate",
        )
    _require_fast(values)
    if not abs(values[-1] - 1) < 512 * EPS:
        raise SceneError.of(
            "substrate.symbol(q)",
            float(values[-1]),
            f"1 for short waves, here at q = {WAVES[-1]:.0e} 1/m: the symbol is the body's "
            "compliance divided by that of a half-plane with the modulus E_star of the body's "
            "surface",
        )
    with of_author("substrate.compression", "substrate.compression"):
        compression: Any = substrate.compression
    if compression is not None:
        allowed = "None, or a length of at least 0 [m] (a property, not a method)"
        compression = checked_number(
            "substrate.compression", compression, allowed, lambda length: length >= 0
        )
    long, wave = float(values[0]), float(WAVES[0])
    if compression is None:
        if long < CHECKS.same:
            raise SceneError.of(
                "substrate.compression",
                None,
                f"given [m], since the symbol vanishes for long waves (L = {long:.3g} at q = "
                f"{wave:.0e} 1/m), as for a body on a rigid base: give the limit of L(q)/q for "
                "q to 0",
            )
        return
    # The body's `height` [m] from the base to the surface is about 1/q. Here q is the lowest tested
    # wavenumber at which the symbol L exceeds 1/2.
    found, height = long / wave, float(1 / WAVES[np.argmax(values > 0.5)])
    if not abs(found - compression) <= CHECKS.same * max(abs(compression), 1e-3 * height):
        raise SceneError.of(
            "substrate.compression",
            compression,
            f"the limit of L(q)/q for long waves, about {found:.6g} m",
        )


def _require_fast(values: Array) -> None:
    """Raise SceneError unless the symbol L tends to 1 exponentially with q, not as a power of q."""
    rest = np.abs(values - 1)
    # `k` is the index of the largest wavenumber at which L - 1 is well above round-off.
    digits = np.flatnonzero(rest > 2**16 * EPS)
    k = int(digits[-1]) if len(digits) else 0
    # If L does not tend to 1 at all, `require_body` reports this as another fault.
    if k == 0 or rest[-1] >= 0.9 * rest[k // 2]:
        return
    power = -np.inf
    if rest[k - 1] > 0:
        power = float(np.log(rest[k] / rest[k - 1]) / np.log(WAVES[k] / WAVES[k - 1]))
    if power > CHECKS.slowest_fall:
        raise SceneError.of(
            "substrate.symbol(q)",
            float(values[k]),
            "1 for short waves, with a difference that falls like exp(-q h), not like "
            f"q^{power:.2g} as near q = {WAVES[k]:.3g} 1/m: a modulus that varies right from the "
            "surface has no smooth kernel; give the body a uniform surface layer",
        )
