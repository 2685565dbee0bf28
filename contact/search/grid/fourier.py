"""Multiplication by real factors in Fourier space, with short transforms instead of a long one.

Let N be even. N real values x are taken as N/2 complex values z_m = x_2m + i x_(2m+1). These are
written into a table with n1 rows and n2 columns, n1 n2 = N/2. The columns are transformed, the
table is multiplied by unit complex factors ("turns"), and the rows are transformed. The result is
the transform Z of z, whose wave k1 + n1 k2 stands in row k1 and column k2 (D. H. Bailey, J.
Supercomputing 4, 1990, 23-35). Short transforms of many rows at once make use of vector operations
and caches, and several processors can share them. So they take less than half of the time of one
long transform.

Let f_k be the real factors, k = 0 ... N/2. Let s_k and d_k be the half sum and the half difference
of f_k and f_(N/2-k), and theta_k = 2 pi k / N. The product consists of N real values, too. Taken
as complex values in the same way, they have the transform

    Z'_k = (s_k - d_k sin theta_k) Z_k + i d_k cos theta_k conj(Z_(N/2-k)).
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import scipy.fft
from numpy.typing import NDArray

import sie
from sie import Array

# From this number of values on, a table of short rows saves time in both precisions.
MIN_SIZE = 1 << 17
# Number of values in the rows or columns that are transformed at once, so that they stay in the
# processor's cache. Insensitive to a factor of four.
BLOCK = 1 << 16
# Time of a transform divided by its number of values. The unit is the time of one term of a sum, by
# which `sie.in_threads` counts the work.
TERMS_PER_VALUE = 4


class FourierTable:
    """Table for the transforms of `size` real values of the type `precision`.

    The table is multiplied by `turns` between the transforms of columns and those of rows. If
    `rows` is 1, there is no table, and `FourierMultiplier` uses an ordinary real transform.
    """

    def __init__(self, size: int, precision: type[np.floating[Any]] = np.float64) -> None:
        self.size, self.precision = size, np.dtype(precision)
        self.complex = np.result_type(precision, np.complex64)
        half, odd = divmod(size, 2)
        # The number of rows is a power of two that divides the number N/2 of complex values. It is
        # at most about the square root of this number.
        is_long = size >= MIN_SIZE and not odd
        self.rows = min(half & -half, 2 ** (half.bit_length() // 2)) if is_long else 1
        self.columns = half // self.rows
        if self.rows > 1:
            wave = np.outer(np.arange(self.rows), np.arange(self.columns))
            self.turns = np.exp(-2j * np.pi / half * wave).astype(self.complex)
            self.inverse_turns = self.turns.conj()

    def in_parts(self, count: int, step: Callable[..., None], *tables: NDArray[Any]) -> None:
        """Call step(part, *tables) for slices of `count` rows or columns of the tables.
        A slice fits into the processor's cache. Several threads share the work.
        """
        block = max(1, BLOCK * count // self.size)

        def run(begin: int, end: int) -> None:
            for first in range(begin, end, block):
                step(slice(first, min(first + block, end)), *tables)

        sie.in_threads(run, np.arange(count + 1) * (self.size // count * TERMS_PER_VALUE))

    def of_columns(self, part: slice, pairs: NDArray[Any], z: NDArray[Any]) -> None:
        """Set some columns of z to the transforms of these columns of `pairs`, times `turns`."""
        of_part = scipy.fft.fft(pairs[:, part], axis=0)
        np.multiply(of_part, self.turns[:, part], out=z[:, part])

    def of_rows(self, part: slice, z: NDArray[Any]) -> None:
        """Replace some rows of the table z by their transforms."""
        z[part] = scipy.fft.fft(z[part], axis=1, overwrite_x=True)

    def back_to_columns(self, part: slice, z: NDArray[Any]) -> None:
        """Replace some columns of the table z by their inverse transforms."""
        z[:, part] = scipy.fft.ifft(z[:, part], axis=0)


class FourierMultiplier:
    """Multiplication of the waves 0 ... N/2 of N real values by one real factor each.

    A call returns the N real values of the product, for at most N given values. Zeros are appended
    to fewer values. N may be odd.
    """

    def __init__(self, table: FourierTable, factors: Array) -> None:
        self.table = table
        if table.rows == 1:
            self.factors = factors.astype(table.precision)
            return
        mirrored = factors[:0:-1]  # f_(N/2-k) for k = 0 ... N/2 - 1
        theta = 2 * np.pi / table.size * np.arange(len(mirrored))
        mean, difference = 0.5 * (factors[:-1] + mirrored), 0.5 * (factors[:-1] - mirrored)
        self.by_wave = self._table(mean - difference * np.sin(theta))
        self.by_mirrored_wave = self._table(difference * np.cos(theta))

    def _table(self, of_waves: Array) -> NDArray[Any]:
        """The numbers `of_waves` in the order of the table, each one twice.
        They multiply the real and the imaginary part of Z at each wave.
        """
        ordered = of_waves.reshape(-1, self.table.rows).T.astype(self.table.precision)
        return np.repeat(ordered, 2, axis=1)

    def __call__(self, values: NDArray[Any]) -> NDArray[Any]:
        table = self.table
        if table.rows == 1:
            waves = scipy.fft.rfft(values, table.size)
            waves *= self.factors
            return np.asarray(scipy.fft.irfft(waves, table.size, overwrite_x=True))
        if len(values) < table.size:
            values = np.concatenate((values, np.zeros(table.size - len(values), values.dtype)))
        pairs = np.ascontiguousarray(values, dtype=table.precision).view(table.complex)
        pairs = pairs.reshape(table.rows, table.columns)
        z, out = np.empty_like(pairs), np.empty_like(pairs)
        table.in_parts(table.columns, table.of_columns, pairs, z)
        table.in_parts(table.rows, table.of_rows, z)
        table.in_parts(table.rows, self._back_to_rows, z.view(table.precision), out)
        table.in_parts(table.columns, table.back_to_columns, out)
        return np.asarray(out.view(table.precision).ravel())

    def _back_to_rows(self, rows: slice, parts: NDArray[Any], out: NDArray[Any]) -> None:
        """Set some rows of `out` to the inverse transforms of these rows of Z', divided by `turns`.

        parts: real and imaginary parts of Z, alternately. In reverse order they are the real and
        imaginary parts of i conj(Z_(N/2-k)). In row 0, wave 0 is its own mirror image and stays
        first.
        """
        table = self.table
        mirrored = parts[-np.arange(rows.start, rows.stop) % table.rows, ::-1]
        if rows.start == 0:
            mirrored[0] = np.roll(mirrored[0], 2)
        mirrored *= self.by_mirrored_wave[rows]
        mirrored += self.by_wave[rows] * parts[rows]
        waves = scipy.fft.ifft(mirrored.view(table.complex), axis=1, overwrite_x=True)
        np.multiply(waves, table.inverse_turns[rows], out=out[rows])
