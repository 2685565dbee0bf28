"""Roughness of a trace: parameters of ISO 21920-2, distribution of heights, and power spectrum.

With the heights z above their mean, and <.> the mean over the length of the trace:

    Ra = <|z|>,  Rq = <z^2>^(1/2),  Rsk = <z^3>/Rq^3,  Rku = <z^4>/Rq^4,
    Rdq = <z'^2>^(1/2), the rms slope.

All are integrals over the spline of the trace, by a Gauss rule on each piece: exact to round-off,
except for Ra, whose integrand has kinks. The filters of the trace decide whether the parameters are
P-, W- or R-parameters.
Unlike in the standard, the trace is not divided into sections, and Rdq uses the slope of the spline
instead of a seven-point formula.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contact.model.traces.filters import MAX_UNEVENNESS
from sie import Array

if TYPE_CHECKING:
    from contact.model.profiles.sampled import Sampled


@dataclass(frozen=True)
class Roughness:
    """Roughness parameters of a trace; lengths and heights are in m.

    pitch: mean distance of neighbouring points. even: whether these distances are nearly equal.
    depth: the highest minus the lowest height. rms_slope: Rdq. Formulas: head of this module.
    """

    points: int
    length: float
    pitch: float
    even: bool
    depth: float
    Ra: float
    Rq: float
    Rsk: float
    Rku: float
    rms_slope: float


def roughness(trace: "Sampled") -> Roughness:
    """The roughness parameters of a trace."""
    knots = trace.x if trace.period is None else np.append(trace.x, trace.x[0] + trace.period)
    steps = np.diff(knots)
    length = float(knots[-1] - knots[0])
    # Seven Gauss nodes integrate polynomials exactly up to degree 13. The fourth power of a cubic
    # has degree 12.
    nodes, weights = np.polynomial.legendre.leggauss(7)
    at = (knots[:-1, None] + 0.5 * steps[:, None] * (1 + nodes)).ravel()
    part = (0.5 * steps[:, None] * weights).ravel() / length
    z = -trace.height(at)
    z = z - float(part @ z)
    rms = float(np.sqrt(part @ z**2))
    return Roughness(
        points=trace.x.size,
        length=length,
        pitch=float(np.mean(np.diff(trace.x))),
        even=bool(np.ptp(np.diff(trace.x)) <= MAX_UNEVENNESS * np.mean(np.diff(trace.x))),
        depth=float(np.ptp(trace.heights)),
        Ra=float(part @ np.abs(z)),
        Rq=rms,
        Rsk=float(part @ z**3) / rms**3,
        Rku=float(part @ z**4) / rms**4,
        rms_slope=float(np.sqrt(part @ trace.slope(at) ** 2)),
    )


def power_spectrum(trace: "Sampled") -> tuple[Array, Array]:
    """Wavenumbers q = 2 pi/wavelength [1/m] and the one-sided power spectral density C(q) [m^3].

    The integral of C over q is Rq^2. The spline is sampled at evenly spaced points, as many as the
    trace has. For a trace without period, a straight line is subtracted from the heights, and they
    are weighted by a normalized Hann window.
    """
    n = trace.x.size
    if trace.period is not None:
        length = trace.period
        z = -trace.height(trace.x[0] + length * np.arange(n) / n)
        window = np.ones(n)
    else:
        x = np.linspace(trace.x[0], trace.x[-1], n)
        length = float(x[-1] - x[0]) * n / (n - 1)
        z = -trace.height(x)
        z = z - np.polyval(np.polyfit(x - x.mean(), z, 1), x - x.mean())
        window = np.sin(np.pi * (np.arange(n) + 0.5) / n) ** 2
    z = (z - z.mean()) * window / np.sqrt(np.mean(window**2))
    waves = np.abs(np.fft.rfft(z)) ** 2 / n**2
    waves[1:] *= 2
    if n % 2 == 0:
        waves[-1] /= 2
    step = 2 * np.pi / length
    return np.asarray(step * np.arange(1, waves.size)), np.asarray(waves[1:] / step)


def height_distribution(trace: "Sampled", max_bins: int = 64) -> tuple[Array, Array]:
    """Edges of equal bins [m], measured from the mean height, and the probability density of
    heights [1/m].

    The number of bins is the square root of the number of points, but from 8 to `max_bins`.
    """
    n = trace.x.size
    count = int(np.clip(np.sqrt(n), 8, max_bins))
    if trace.period is not None:
        at = trace.x[0] + trace.period * np.arange(4 * n) / (4 * n)
    else:
        at = np.linspace(trace.x[0], trace.x[-1], 4 * n)
    z = -trace.height(at)
    density, edges = np.histogram(z - z.mean(), bins=count, density=True)
    return edges, density
