"""Places on a line that repeats, and among things that are counted one after the other."""

import numpy as np

from sie.basis.data import Array, Index


def wrapped(x: Array, start: float | Array, period: float | None) -> Array:
    """Places moved by periods into [start, start + period).

    Parameters
    ----------
    x : ndarray
        Places.
    start : float or ndarray
        Where the period begins.
    period : float or None
        Its length; None: nothing repeats, and the places are left alone.

    Returns
    -------
    ndarray
        Of the shape of `x`.

    Examples
    --------
    >>> import numpy as np, sie
    >>> sie.wrapped(np.array([-1.0, 7.0]), 0.0, 3.0)
    array([2., 1.])
    """
    return x if period is None else np.asarray(x - np.floor((x - start) / period) * period)


def nearest_image(x: Array, centre: float | Array, period: float | None) -> Array:
    """Places moved by periods to within half of one of a centre.

    Parameters
    ----------
    x : ndarray
        Places.
    centre : float or ndarray
        What they are to be near to.
    period : float or None
        As for `sie.wrapped`.

    Returns
    -------
    ndarray
        Of the shape of `x`.

    Examples
    --------
    >>> import numpy as np, sie
    >>> sie.nearest_image(np.array([-1.0, 8.0]), 0.0, 3.0)
    array([-1., -1.])
    """
    return x if period is None else np.asarray(x - np.round((x - centre) / period) * period)


def numbered(counts: Index) -> Index:
    """0, 1, ... counts[0] - 1, 0, 1, ... counts[1] - 1, and so on."""
    return np.arange(int(counts.sum())) - np.repeat(np.cumsum(counts) - counts, counts)


def divided(ends: Array, parts: Index) -> tuple[Array, Array]:
    """(starts, lengths) of so many equal parts of every interval between neighbouring ends, one interval after the other."""
    length = np.repeat(np.diff(ends) / parts, parts)
    return np.repeat(ends[:-1], parts) + numbered(parts) * length, length
