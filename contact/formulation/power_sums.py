r"""`power_sums`: the sums of c_k w^k and of k c_k w^k at many points |w| <= 1.

With w = exp(s), s = -d + i a, the depth d >= 0 of a point decides how many terms the point needs:
terms with k d above about 41 are below round-off. Points of nearly the same depth form a layer. If
a layer has many points, the sums come from Taylor series about equidistant angles a_j at the middle
depth d_0 of the layer,

    sum_k c_k e^(k s) = sum_m (s - s_j)^m / m! sum_k k^m c_k e^(k s_j),    s_j = -d_0 + i a_j,

whose inner sums are fast Fourier transforms. With K needed terms, layers are 2 pi/K thick, and
there are 1.5 K angles. Then |k (s - s_j)| is at most 3.8, and about 36 powers suffice. Since
3.8^m/m! is below 10, at most one digit of the round-off of a sum is lost. In layers with few
points, Horner's rule is quicker.
"""

from math import pi

import numpy as np
from scipy import fft

from contact.model.profiles.noise import EPS
from sie import Array, Complex, Index

# A layer (points w of nearly equal |w|) with fewer points than this is summed by Horner's rule. The
# about 36 Fourier transforms of the layer's Taylor series take as long as Horner's rule at about
# this many points. Any number between 50 and 200 changes the time for random points by less than a
# tenth.
_MIN_POINTS = 100


def power_sums(terms: Complex, exponent: Complex) -> tuple[Complex, Complex]:
    """The sums of c_k w^k and of k c_k w^k, k = 1, 2, ..., at w = exp(exponent), |w| <= 1.

    Deep points need few terms: those below round-off are left out.

    Parameters
    ----------
    terms : ndarray
        The coefficients c_1, c_2, ...
    exponent : ndarray
        The logarithms s of w (n,), with real parts of at most 0.

    Returns
    -------
    tuple of ndarray
        Both sums at each point.

    Examples
    --------
    >>> import numpy as np
    >>> value, slope = power_sums(np.ones(400, dtype=complex), np.log([0.5 + 0j]))
    >>> round(value[0].real, 12), round(slope[0].real, 12)
    (1.0, 2.0)
    """
    value, slope = np.zeros(len(exponent), dtype=complex), np.zeros(len(exponent), dtype=complex)
    if len(terms) == 0 or len(exponent) == 0:
        return value, slope
    order = np.argsort(-exponent.real)
    depth = -exponent.real[order]
    needed = _needed(depth, len(terms))
    few, start = [], 0
    while start < len(order):
        count = int(needed[start])
        end = int(np.searchsorted(depth, depth[start] + 2 * pi / count, side="right"))
        here = order[start:end]
        if end - start < _MIN_POINTS or count < _MIN_POINTS:
            few.append(here)
        else:
            middle = 0.5 * (depth[start] + depth[end - 1])
            value[here], slope[here] = _by_taylor(terms[:count], exponent[here], middle)
        start = end
    if few:
        rest = np.concatenate(few)
        for first in range(0, len(rest), _BLOCK):
            here = rest[first : first + _BLOCK]
            count = int(_needed(-exponent.real[here[:1]], len(terms))[0])
            value[here], slope[here] = _by_horner(terms[:count], np.exp(exponent[here]))
    return value, slope


# Points that Horner's rule treats at once, so that they stay in the processor's cache.
_BLOCK = 1 << 12


def _needed(depth: Array, count: int) -> Index:
    """Number of terms of the power sum above round-off at depth d = -ln|w|, at most `count`."""
    return np.minimum(-np.log(0.01 * EPS) / np.maximum(depth, 1e-300) + 1, count).astype(np.intp)


def _by_horner(terms: Complex, w: Complex) -> tuple[Complex, Complex]:
    """The sums of c_k w^k and of k c_k w^k, by Horner's rule."""
    total, rate = np.zeros(len(w), dtype=complex), np.zeros(len(w), dtype=complex)
    for term in terms[::-1].tolist():
        rate *= w
        rate += total
        total *= w
        total += term
    return w * total, w * (total + w * rate)


def _by_taylor(terms: Complex, exponent: Complex, middle: float) -> tuple[Complex, Complex]:
    """The sums of c_k w^k and of k c_k w^k at points w whose -ln|w| is close to `middle`."""
    count = len(terms)
    angles = fft.next_fast_len(count + count // 2 + 1)
    k = np.arange(1, count + 1)
    scaled = np.zeros(angles, dtype=complex)
    scaled[1 : count + 1] = angles * terms * np.exp(-middle * k)
    cell = np.round(exponent.imag * (angles / (2 * pi)))
    # The step 2 pi / angles of the grid of angles is split into two numbers, so that the first one
    # times a grid index (`cell`) is exact. The rounding error of 2 pi is added to the second
    # number.
    first = float(np.float32(2 * pi / angles))
    second = ((2 * pi - first * angles) + 2.4492935982947064e-16) / angles
    step = exponent + middle - 1j * (cell * first) - 1j * (cell * second)
    step, cell = count * step, cell.astype(np.intp) % angles
    power, total = np.ones(len(step), dtype=complex), fft.ifft(scaled)[cell]
    rate, order = np.zeros(len(step), dtype=complex), 1
    while np.abs(power).max() > 0.01 * EPS:
        # `scaled` holds c_k e^(-k middle) (k / count)^order, times the length of the transform.
        # `power` holds step^(order - 1) / (order - 1)!.
        scaled[1 : count + 1] *= k / count
        local = fft.ifft(scaled)[cell]
        rate += power * local
        power *= step / order
        total += power * local
        order += 1
    return total, count * rate
