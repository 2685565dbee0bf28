"""Smooth periodic shape f(x) = sum_k cosine[k-1] cos(2 pi k x/L) + sine[k-1] sin(2 pi k x/L)."""

from dataclasses import dataclass
from functools import cached_property
from math import ceil, pi, sqrt

import numpy as np
from numpy.typing import ArrayLike

from contact.errors import SceneError
from contact.model.checks import finite_array, keep, positive
from contact.model.profiles.base import Array, Profile
from contact.model.profiles.trigonometric import BLOCK, WIDTH, Sum, in_turns
from contact.model.registry import register_profile
from sie import Complex, record


@register_profile("fourier")
@dataclass(frozen=True, eq=False, repr=False)
class Fourier(Profile):
    """A sum of harmonics 1, 2, ... of the period, from lists of cosine and sine amplitudes.
    Zeros are appended to the shorter list.

    f(x) = sum_k cosine[k-1] cos(2 pi k x/L) + sine[k-1] sin(2 pi k x/L).

    Parameters
    ----------
    period : float
        L [m].
    cosine, sine : array_like
        Amplitudes [m] of the harmonics, (n,) and (m,), at least one of them not zero.

    Raises
    ------
    SceneError
        If the period is not a finite positive number, or all amplitudes are zero or one is not
        finite.

    Examples
    --------
    >>> import contact
    >>> waves = contact.Fourier(period=1.0, cosine=[-0.01, 0.002], sine=[0.001])
    >>> waves.height([0.0, 0.25, 0.5]).round(12).tolist()
    [-0.008, -0.001, 0.012]
    """

    period: float
    cosine: ArrayLike
    sine: ArrayLike = ()
    units = {"period": "m"}

    def __post_init__(self) -> None:
        keep(self, positive, "period")
        given = [finite_array(field, getattr(self, field), least=0) for field in ("cosine", "sine")]
        both = np.zeros((2, max(values.size for values in given)))
        for row, values in zip(both, given, strict=True):
            row[: values.size] = values
        used = np.flatnonzero(both.any(axis=0))
        if used.size == 0:
            raise SceneError.of(
                "cosine, sine",
                (self.cosine, self.sine),
                "amplitudes, at least one of them not zero",
            )
        both.setflags(write=False)
        for field, row in zip(("cosine", "sine"), both, strict=True):
            object.__setattr__(self, field, row[: used[-1] + 1])

    def __repr__(self) -> str:
        return f"Fourier(period={self.period!r}, {np.size(self.cosine)} harmonics)"

    def unit_of(self, name: str, index: int) -> Profile | None:
        if name not in ("cosine", "sine"):
            return None
        wave = np.append(np.zeros(index), 1.0)
        return Fourier(self.period, *((wave, [0.0]) if name == "cosine" else ([0.0], wave)))

    def unit_sums(self, name: str, x: Array, heights: Array, slopes: Array) -> Array | None:
        if name not in ("cosine", "sine"):
            return None
        count = np.size(self.cosine)
        turns = 2j * pi * (np.asarray(self.wrap(x), dtype=float)[:, None] / self.period)
        # The number of a harmonic is split, k = r + s q. So one matrix product gives the sums over
        # x for all k.
        s = ceil(sqrt(count))
        low, high = np.exp(turns * np.arange(1, s + 1)), np.exp(turns * s * np.arange(s))
        of_height, of_slope = (
            ((high * weights[:, None]).T @ low).ravel()[:count] for weights in (heights, slopes)
        )
        rate = 2 * pi / self.period * np.arange(1, count + 1)
        if name == "cosine":
            return np.asarray(of_height.real - rate * of_slope.imag)
        return np.asarray(of_height.imag + rate * of_slope.real)

    def height(self, x: ArrayLike) -> Array:
        return self._waves[0](self.wrap(np.asarray(x, dtype=np.float64)))

    def slope(self, x: ArrayLike) -> Array:
        return self._waves[1](self.wrap(np.asarray(x, dtype=np.float64)))

    def slope_conjugate(self, x: ArrayLike) -> Array:
        """The Hilbert transform of f'. It maps cos to sin and sin to -cos, which is a factor -i for
        each harmonic k > 0.
        """
        return self._waves[2](self.wrap(np.asarray(x, dtype=np.float64)))

    @property
    def symmetric(self) -> bool:
        return not np.any(self.sine)

    @property
    def resolution(self) -> float:
        return self.period / np.size(self.cosine)

    @property
    def exact_places(self) -> bool:
        """Whether the sums correct the round-off of x/period, so that no digit of x is lost."""
        return _is_long(np.size(self.cosine))

    @cached_property
    def _waves(self) -> "tuple[_Waves, ...]":
        """Sums for the height f, the slope f', and the slope's Hilbert transform H f'."""
        c = np.asarray(self.cosine) - 1j * np.asarray(self.sine)
        rate = 2 * pi / self.period * np.arange(1, c.size + 1) * c
        return tuple(_Waves(amplitudes, self.period) for amplitudes in (c, 1j * rate, rate))


def _is_long(harmonics: int) -> bool:
    """Whether a sum of `harmonics` terms has so many terms that a grid is faster.
    The sum is then computed on the grid and interpolated.

    At each point, the grid takes `WIDTH` exponentials. A direct sum takes about as many as the
    square root of the number of harmonics.
    """
    return harmonics >= WIDTH * WIDTH


@record
class _Waves:
    """The sum Re sum_k c_k exp(2 pi i k x/L) with amplitudes c_k, at x [m], with period L [m]."""

    amplitudes: Complex
    period: float

    @cached_property
    def _sum(self) -> Sum:
        return Sum.of(self.amplitudes)

    def __call__(self, x: Array) -> Array:
        """The sum at x; it is computed on a grid if it has many terms.
        A sum of few terms (N) is split: the numbers of its harmonics are k = r + s q, with r from 1
        to s and s about sqrt(N). A matrix product sums over r, and about sqrt(N) terms remain to be
        summed over q.

        Each power is an exponential of its own, so no round-off accumulates as in a recurrence.
        """
        c = self.amplitudes
        if _is_long(c.size):
            return self._sum(*in_turns(x.ravel(), self.period)).reshape(x.shape)
        flat = x.ravel() / self.period
        s = max(1, ceil(sqrt(c.size)))
        table = np.zeros(s * ceil(c.size / s), dtype=np.complex128)
        table[: c.size] = c
        by_rows = table.reshape(-1, s)
        low, high = np.arange(1, s + 1), s * np.arange(by_rows.shape[0])
        out = np.empty(flat.size)
        step = BLOCK
        for i in range(0, flat.size, step):
            part = flat[i : i + step, None]
            inner = np.exp(2j * pi * (part * low)) @ by_rows.T
            out[i : i + step] = np.einsum("pq,pq->p", inner, np.exp(2j * pi * (part * high))).real
        return out.reshape(x.shape)
