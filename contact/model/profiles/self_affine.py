"""Random rough profiles with a self-affine spectrum and random phases, reproducible by a seed."""

from math import floor, pi, sqrt
from typing import Any

import numpy as np

from contact.errors import SceneError
from contact.model.checks import checked_number, integer, positive
from contact.model.profiles.fourier import Fourier
from contact.model.profiles.noise import ROUND_OFF

_MAX_HARMONICS = 1 << 22  # bounds the memory


def self_affine(
    *,
    hurst: float,
    period: float,
    shortest: float,
    rms_slope: float,
    seed: int,
    rolloff: float | None = None,
    longest: float | None = None,
) -> Fourier:
    """A random rough profile of harmonics k with amplitudes k^-(H + 1/2), where H is the Hurst
    exponent. Up to the roll-off the amplitudes are constant.

    Phases are uniform and the amplitudes are scaled to an rms slope. The power spectrum of the line
    falls as q^-(1 + 2H). Only phases are random: every seed has the same spectrum, rms height and
    rms slope. A shorter `shortest` with the same seed adds waves and leaves the phases of the
    others unchanged.

    Parameters
    ----------
    hurst : float
        Hurst exponent H, above 0 and up to 1.
    period : float
        Length of the period [m].
    shortest : float
        Shortest wavelength [m], at most the period.
    rms_slope : float
        Root mean square of the slope.
    seed : int
        Number of the realization, from 0.
    rolloff : float or None
        Wavelength [m] beyond which the spectrum is level; None: it falls from the longest wave on.
    longest : float or None
        Longest wavelength [m]; None: the period.

    Returns
    -------
    Fourier

    Raises
    ------
    SceneError
        If a value is out of range, or no wave fits between shortest and longest.

    Examples
    --------
    >>> import contact
    >>> import numpy as np
    >>> rough = contact.self_affine(
    ...     hurst=0.8, period=1e-3, shortest=1e-5, rolloff=2e-4, rms_slope=0.1, seed=3
    ... )
    >>> slope = rough.slope(np.arange(1000) * 1e-6)
    >>> float(np.sqrt(np.mean(slope**2)).round(12)), rough.period
    (0.1, 0.001)
    """
    exponent = checked_number(
        "hurst", hurst, "a number above 0 and at most 1", lambda exponent: 0 < exponent <= 1
    )
    length, steepness = positive("period", period), positive("rms_slope", rms_slope)
    least = _wavelength("shortest", shortest, 0.0, length)
    most = length if longest is None else _wavelength("longest", longest, least, length)
    knee = length if rolloff is None else _wavelength("rolloff", rolloff, least, length)
    number = integer("seed", seed)
    # A wavelength equal to a cut-off is kept in spite of round-off. In floats, 1/(1/49) is not 49.
    last, first = (
        floor(length / least * (1 + ROUND_OFF)),
        max(1, floor(length / most * (1 - ROUND_OFF)) + (most < length)),
    )
    if last > _MAX_HARMONICS:
        raise SceneError.of(
            "shortest",
            shortest,
            f"at least {length / _MAX_HARMONICS:.6g}, since a period may have at most "
            f"{_MAX_HARMONICS} waves",
        )
    if last < first:
        raise SceneError.of(
            "shortest",
            shortest,
            f"such that period/n, for a whole number n, lies between it and longest = {most!r}",
        )
    k = np.arange(first, last + 1)
    phase = np.random.default_rng(number).uniform(0, 2 * pi, k.size)
    amplitude = np.maximum(k, length / knee) ** -(exponent + 0.5)
    amplitude *= steepness / sqrt(0.5 * float(np.sum((2 * pi / length * k * amplitude) ** 2)))
    cosine, sine = np.zeros(last), np.zeros(last)
    cosine[first - 1 :], sine[first - 1 :] = amplitude * np.cos(phase), amplitude * np.sin(phase)
    return Fourier(length, cosine, sine)


def _wavelength(field: str, value: Any, least: float, period: float) -> float:
    """Check a wavelength, which must lie between the shortest one and the period."""
    wave = positive(field, value)
    if not least <= wave <= period * (1 + ROUND_OFF):
        raise SceneError.of(
            field,
            value,
            f"a length {f'of at least shortest = {least!r}' if least else 'above 0'} and at most "
            f"the period, {period!r}",
        )
    return wave
