"""Compiled sums of power series by Horner's rule (see `sie.basis.sums`)."""

from typing import Any

from numba import njit


@njit(cache=True, nogil=True, fastmath={"contract"}, error_model="numpy")
def power_series(
    begin: int, end: int, table: Any, rho: Any, row: Any, terms: Any, values: Any
) -> None:
    """Set values[i] = sum_k table[row[i], k] rho[i]^k, k < terms[i], for i = begin ... end - 1."""
    for i in range(begin, end):
        r, coefficients = rho[i], table[row[i]]
        value = 0.0 * r
        for k in range(terms[i] - 1, -1, -1):
            value = value * r + coefficients[k]
        values[i] = value
