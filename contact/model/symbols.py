r"""The symbol L(q) of an elastic body: a check, its values for a period, and its kernel.

A pressure p_q exp(iqx) displaces the surface by u_q = 2 L(q) p_q / (E* q). L is the compliance of
the surface divided by that of a half-plane, and tends to 1 for short waves. With
L_n = L(2 pi n / l), the kernel for a period l is Hilbert's kernel plus a smooth part K, and its
potential is Hilbert's potential plus a smooth part Lambda,

    K = (2 pi / l) sum_n (L_n - 1) sin(2 pi n d / l),
    Lambda = -sum_n (L_n - 1) cos(2 pi n d / l) / n,      d = x - xi,

since (1/pi) int cos(k xi) ln|2 sin(pi d / l)| dxi = -cos(kx) / k.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

import sie
from contact.errors import SceneError
from contact.model.checks import as_array, of_author
from contact.model.profiles.noise import EPS
from contact.model.profiles.trigonometric import Sum
from sie import Array

Symbol = Callable[[Array], Array]

# Wavenumbers [1/m] at which a symbol is sampled. Their reciprocals range from less than the size of
# an atom to more than that of a planet.
WAVES = 10.0 ** np.arange(-9, 12.01, 0.125)


@dataclass(frozen=True)
class SymbolOptions:
    """Numbers of harmonics of a period at which a symbol is evaluated: the first number, and the
    largest.
    """

    harmonics: int = 2**12
    max_harmonics: int = 2**16


OPTIONS = SymbolOptions()


def checked(symbol: Callable[[Array], Array], q: Array, of: str) -> Array:
    """Values of the symbol L(q); raises SceneError if they cannot be the symbol of an elastic
    body.

    of: the part of the scene that the symbol belongs to, for messages.
    """
    name = f"{of}.symbol(q)"
    with of_author(name, of, f" for an array of shape {q.shape}"):
        value = symbol(q.copy())
    found = as_array(value)
    if found.dtype.kind not in "iuf" or found.shape != q.shape or not np.all(np.isfinite(found)):
        at = ""
        if found.dtype.kind in "iuf" and found.shape == q.shape:
            at = (
                f" (not finite at q = {q[~np.isfinite(found)].ravel()[0]:.6g} 1/m: if growing "
                "exponentials overflow there, write the formula with decaying ones)"
            )
        raise SceneError.of(name, value, f"real, finite, and of the shape of q{at}")
    if not np.all(found > 0):
        lowest = q.ravel()[np.argmin(found)]
        raise SceneError.of(
            name,
            float(found.min()),
            f"above 0: at q = {lowest:.6g} 1/m pressure would not press the surface down",
        )
    return np.asarray(found, dtype=np.float64)


def excess(symbol: Callable[[Array], Array], period: float, of: str) -> Array:
    """Symbol minus 1, L_n - 1, at the harmonics n = 1, 2, ... of a period.
    Values after the last one above round-off are left out.

    L_n is the symbol at the wavenumber 2 pi n / period.
    Raises SceneError if the symbol is not that of a body.
    """
    count = OPTIONS.harmonics
    while True:
        q = np.asarray(2 * np.pi / period * np.arange(1, count + 1), dtype=np.float64)
        found = checked(symbol, q, of)
        deviation = np.asarray(found - 1.0, dtype=np.float64)
        # A deviation of the symbol from 1 below 4 EPS is a rounding error.
        seen = np.flatnonzero(np.abs(deviation) > 4 * EPS)
        if len(seen) == 0 or seen[-1] < 0.9 * count:
            return deviation[: seen[-1] + 1] if len(seen) else np.zeros(0)
        if count >= OPTIONS.max_harmonics:
            allowed = (
                f"1 for short waves, within {4 * EPS:.0e} at the latest from harmonic "
                f"{OPTIONS.max_harmonics} of the period on"
            )
            raise SceneError.of(f"{of}.symbol(q)", float(found[-1]), allowed)
        count *= 4


def _waves(sums: Sum, period: float, x: Array, xi: Array) -> Array:
    """Values of the trigonometric sum `sums` at x - xi; its argument is (x - xi) / `period`."""
    turns = np.asarray((x - xi) / period)
    return sums(turns.ravel()).reshape(turns.shape)


def kernel_of(excess: Array, period: float) -> sie.Kernel:
    """The kernel for a scaled period; `excess` is the symbol minus 1 at the harmonics of the
    period.
    """
    plain = sie.hilbert(period)
    if len(excess) == 0:
        return plain
    n = np.arange(1, len(excess) + 1)
    value, potential = (
        Sum.of(np.asarray(c, dtype=np.complex128))
        for c in (-2j * np.pi / period * excess, -excess / n)
    )
    # The coefficients of the kernel's smooth part decrease about as exp(-2 pi n length / period)
    # with the harmonic n.
    length = -np.log(EPS) * period / (2 * np.pi * len(excess))
    return plain + sie.Smooth(
        partial(_waves, value, period),
        partial(_waves, potential, period),
        of_lag=True,
        length=float(length),
    )
