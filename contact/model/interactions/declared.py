"""Whether what an interaction of someone's own gives is an elastic operator, and all of it the same one.

Looked at once, when a scene is made: the kernel must be one of x - xi alone, odd (what a load at one place does at another it does
from there as well), scaled with the unit of length, the derivative of its own potential, and repeat with the period or not at all;
a symbol must be that of the kernel. Each is held at a few places, and what is wrong is named.
"""

from __future__ import annotations

import numpy as np

import sie
from contact.errors import SceneError, shown
from contact.model.checks import of_author
from contact.model.operator import Operator, smooth_potential
from sie import Array

# Lags over the length that sets the scale, the width of the steps of the potential over it, and how far values that agree may be off.
_LAGS = np.array([0.0137, 0.113, 0.239, 0.318, 0.461])
_STEP = 1e-3
_NEAR, _ROUNDING = 1e-7, 1e-12
_SHIFT = 0.271
_HARMONICS = 64
_PLACES = 4096


def require_elastic(operator: Operator, scale: float) -> None:
    """SceneError that names the first claim that does not hold of an interaction with a kernel or a symbol of its own. scale [m]: of a
    length over which the contact varies."""
    interaction, period = operator.interaction, operator.period
    unit = period or scale
    kernel = _kernel(operator, unit)
    if kernel.regular is not None:
        _require_regular(kernel)
    if interaction.strip:
        return
    repeats = None if period is None else period / unit
    if kernel.period != repeats:
        wanted = "that of the profile, since the model needs one" if repeats else "None, since the model needs none"
        raise SceneError.of("interaction.kernel.period", kernel.period, f"{wanted}: {repeats}")
    if repeats is not None:
        here, there = _value(kernel, _LAGS), _value(kernel, _LAGS - repeats)
        _require_same(here, there, "kernel", "does not repeat with the period")
    _require_scaled(operator, kernel, unit)
    datum = getattr(interaction, "datum", None)
    if period is None and datum is not None and abs(kernel.datum * unit / datum - 1) > 1e-9:
        raise SceneError.of("interaction.datum", datum, f"the length in the kernel's logarithm, {kernel.datum * unit:.6g} m")
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
        with of_author(f"the {name} of the smooth part of interaction.kernel", "interaction", " for arrays"):
            table = np.asarray(function(x, xi))
        if table.dtype.kind not in "iuf" or table.shape != (len(_LAGS), 2) or not np.all(np.isfinite(table)):
            raise SceneError(
                f"the {name} of the smooth part of interaction.kernel for x (5, 1) and xi (2,) gives {shown(table)}: it must be real, "
                "finite and of the shape of x - xi", "interaction"
            )
        # Compared with what it comes to anywhere: a sum of large parts may vanish at one place.
        _require_same(function(x + _SHIFT, xi + _SHIFT), table, f"smooth part's {name}", "is not one of x - xi alone")
    value, minus = regular(_LAGS, zero), regular(-_LAGS, zero)
    _require_same(-minus, value, "smooth part", "is not odd in x - xi: what a load does elsewhere, one elsewhere does here")
    nodes, weights = np.polynomial.legendre.leggauss(5)
    rise = potential(_LAGS + 0.5 * _STEP, zero) - potential(_LAGS - 0.5 * _STEP, zero)
    within = 0.5 * _STEP * np.asarray(regular((_LAGS[:, None] + 0.5 * _STEP * nodes), zero)) @ weights
    size = _ROUNDING * float(np.abs(potential(_LAGS, zero)).max())
    _require_same(rise, within, "smooth part", "is not the derivative in x of its potential", size)


def _require_scaled(operator: Operator, kernel: sie.Kernel, unit: float) -> None:
    other = _kernel(operator, 2 * unit)
    what = "does not scale with the unit of length: lengths in it are those of the scene over `unit`"
    _require_same(0.5 * _value(other, 0.5 * _LAGS), _value(kernel, _LAGS), "kernel", what)


def _require_symbol(operator: Operator, kernel: sie.Kernel) -> None:
    """The kernel's own symbol, L_n = 1 - 2 n int rest cos(2 pi n u) du: above zero, and what is declared."""
    turns = np.arange(_PLACES) / _PLACES
    lag = turns - np.round(turns)
    plain = sie.hilbert(1.0)
    rest = smooth_potential(kernel, lag) - smooth_potential(plain, lag)
    n = np.arange(1, _HARMONICS + 1)
    found = 1 - 2 * n * np.fft.rfft(rest).real[1 : _HARMONICS + 1] / _PLACES
    if not np.all(found > 0):
        k = int(np.argmin(found))
        raise SceneError.of(
            "interaction.kernel", f"of symbol {found[k]:.6g} at wave {k + 1} of the period",
            "one of an elastic body, of a symbol above 0: else pressure lifts the surface, and no contact is the only one",
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
        raise SceneError(
            f"the {what} of interaction.kernel {fault}: {np.ravel(one)[k]:.9g} against {np.ravel(other)[k]:.9g}", "interaction"
        )
