r"""Antiderivative of a kernel's potential by the lag y = x - xi, for kernels made by `sie`.

Such a kernel has no regular part that the user has added. The antiderivative is the potential of a
uniform density that ends at xi. For a pole it is y (ln|y / datum| - 1). For Hilbert's kernel of
period L it is -(L / 2 pi) Cl_2(2 pi y / L), with Clausen's integral (DLMF 25.12.9)

    Cl_2(2 pi u) = 2 pi u (1 - ln|2 pi u| + sum_k zeta(2k) u^(2k) / (k (2k + 1))),   |u| <= 1/2.
"""

from functools import lru_cache

import numpy as np
from numpy.polynomial.polynomial import polyval
from scipy.special import zeta

from sie.basis.data import Array
from sie.basis.kernels import Kernel, is_hilbert

# Number of terms of the series for Clausen's integral. At |u| = 1/2 the terms fall as 4^(-k), so
# that they are below round-off from the 26th term on.
_TERMS = 26


@lru_cache(maxsize=1)
def _series() -> Array:
    k = np.arange(1.0, _TERMS + 1)
    return np.concatenate(([0.0], zeta(2 * k) / (k * (2 * k + 1))))


def potential_primitive(kernel: Kernel, lag: Array) -> Array:
    """Antiderivative of a kernel's potential by the lag x - xi, at an array of lags of any shape.

    Raises ValueError for a kernel with a regular part that the user has added.
    """
    if is_hilbert(kernel):
        assert kernel.period is not None
        u = lag / kernel.period
        u = u - np.round(u)
        with np.errstate(divide="ignore", invalid="ignore"):
            log = np.where(u == 0.0, 0.0, np.log(np.abs(2 * np.pi * u)))
        return np.asarray(kernel.period * u * (log - 1 - polyval(u * u, _series())))
    if kernel.regular is not None:
        raise ValueError(
            "a condition on potentials and ends with a value cannot be combined if the kernel has "
            "a Smooth part"
        )
    out = np.zeros(np.shape(lag))
    for pole in kernel.poles:
        away = np.asarray(lag - pole, dtype=float)
        out += away * (np.log(np.maximum(np.abs(away), 1e-300) / kernel.datum) - 1.0)
    return out
