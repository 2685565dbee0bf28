"""Multiplication by real factors in Fourier space, by transforms whose short rows are fast.

Real values x of even number N are taken as N/2 complex values z_m = x_2m + i x_(2m+1). They are
written into a table with n1 rows and n2 columns, n1 n2 = N/2. Transforms of the columns, factors
("turns") and transforms of the rows give the transform Z of z, whose wave k1 + n1 k2 stands at row
k1 and column k2 (D. H. Bailey, J. Supercomputing 4, 1990, 23-35). Short transforms of many rows at
once use the vector operations and the caches of the processor, and several processors. So they
take less than half of the time of one long transform.

Let f_k be the factors, k = 0 ... N/2, s_k and d_k the half sum and half difference of f_k and
f_(N/2-k), and theta_k = 2 pi k / N. The transform of the product is, with the even and odd parts of
x expressed by Z,

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
# Time of the transform of one value, as a number of terms of `sie.in_threads`.
TERMS_PER_VALUE = 4


class Transform:
    """Table for the transforms of `size` real values of one type.

    `turns` are the factors between the transforms of columns and of rows. A table of one row is not
    used: then numpy's order of a real transform is used instead.
    """

    def __init__(self, size: int, kind: type[np.floating[Any]] = np.float64) -> None:
        self.size, self.kind = size, np.dtype(kind)
        self.complex = np.result_type(kind, np.complex64)
        half, odd = divmod(size, 2)
        # The number of rows is a power of two, near the square root of the number of values.
        is_long = size >= MIN_SIZE and not odd
        self.rows = min(half & -half, 2 ** (half.bit_length() // 2)) if is_long else 1
        self.columns = half // self.rows
        if self.rows > 1:
            wave = np.outer(np.arange(self.rows), np.arange(self.columns))
            self.turns = np.exp(-2j * np.pi / half * wave).astype(self.complex)
            self.back = self.turns.conj()

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
        """Set some columns of z to the transforms of these columns, times the `turns`."""
        of_part = scipy.fft.fft(pairs[:, part], axis=0)
        np.multiply(of_part, self.turns[:, part], out=z[:, part])

    def of_rows(self, part: slice, z: NDArray[Any]) -> None:
        """Replace some rows of the table z by their transforms."""
        z[part] = scipy.fft.fft(z[part], axis=1, overwrite_x=True)

    def back_to_columns(self, part: slice, z: NDArray[Any]) -> None:
        """Replace some columns of the table z by their inverse transforms."""
        z[:, part] = scipy.fft.ifft(z[:, part], axis=0)


class Factors:
    """Multiplication by real factors in Fourier space, of the waves 0 ... N/2 of N real values.

    A call returns the N real values of the product, for at most N given values. Zeros are appended
    to fewer values. N may be odd.
    """

    def __init__(self, transform: Transform, factors: Array) -> None:
        self.transform = transform
        if transform.rows == 1:
            self.factors = factors.astype(transform.kind)
            return
        mirrored = factors[:0:-1]  # f_(N/2-k) for k = 0 ... N/2 - 1
        theta = 2 * np.pi / transform.size * np.arange(len(mirrored))
        mean, difference = 0.5 * (factors[:-1] + mirrored), 0.5 * (factors[:-1] - mirrored)
        self.own = self._table(mean - difference * np.sin(theta))
        self.other = self._table(difference * np.cos(theta))

    def _table(self, of_waves: Array) -> NDArray[Any]:
        """Numbers for all waves k, in the order of the table, repeated for both parts of Z."""
        table = of_waves.reshape(-1, self.transform.rows).T.astype(self.transform.kind)
        return np.repeat(table, 2, axis=1)

    def __call__(self, values: NDArray[Any]) -> NDArray[Any]:
        transform = self.transform
        if transform.rows == 1:
            waves = scipy.fft.rfft(values, transform.size)
            waves *= self.factors
            return np.asarray(scipy.fft.irfft(waves, transform.size, overwrite_x=True))
        if len(values) < transform.size:
            values = np.concatenate((values, np.zeros(transform.size - len(values), values.dtype)))
        pairs = np.ascontiguousarray(values, dtype=transform.kind).view(transform.complex)
        pairs = pairs.reshape(transform.rows, transform.columns)
        z, out = np.empty_like(pairs), np.empty_like(pairs)
        transform.in_parts(transform.columns, transform.of_columns, pairs, z)
        transform.in_parts(transform.rows, transform.of_rows, z)
        transform.in_parts(transform.rows, self._back_to_rows, z.view(transform.kind), out)
        transform.in_parts(transform.columns, transform.back_to_columns, out)
        return np.asarray(out.view(transform.kind).ravel())

    def _back_to_rows(self, rows: slice, parts: NDArray[Any], out: NDArray[Any]) -> None:
        """Set some rows of `out` to the inverse transforms of these rows of Z', over the `turns`.

        parts: real and imaginary parts of Z. In reverse order they are those of
        i conj(Z_(N/2-k)). In row 0, wave 0 is its own mirror image and stays first.
        """
        transform = self.transform
        mirrored = parts[-np.arange(rows.start, rows.stop) % transform.rows, ::-1]
        if rows.start == 0:
            mirrored[0] = np.roll(mirrored[0], 2)
        mirrored *= self.other[rows]
        mirrored += self.own[rows] * parts[rows]
        waves = scipy.fft.ifft(mirrored.view(transform.complex), axis=1, overwrite_x=True)
        np.multiply(waves, transform.back[rows], out=out[rows])
