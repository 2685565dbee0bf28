"""The slope of a profile whose author gave only its height.

Complex step: f'(x) = Im f(x + ih)/h, exact to rounding for analytic f (Squire & Trapp 1998, doi
10.1137/S003614459631241X). A height that takes |x| or drops the imaginary part makes it wrong. So
it is used only where the rise of the height does not contradict its integral (`verdicts`).

Else central differences, extrapolated (Richardson 1911, doi 10.1098/rsta.1911.0009). The step of
each place is the best one of those that agree with all shorter steps to within rounding (Lepski
1991, doi 10.1137/1135065). No place is judged by the values far from it.
"""

import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from sie import Array, record

# The complex step: its square vanishes beside any length, so there is no truncation error.
_TINY = 1e-100
_EPS = float(np.finfo(np.float64).eps)

Function = Callable[[Any], Any]


@dataclass(frozen=True)
class VerdictOptions:
    """How rises of a height are compared with integrals of its slope."""

    # Chebyshev points of an interval: insensitive, 7 to 13 decide the same.
    nodes: int = 9
    # An interval over the next smaller one; intervals below and above the scale of a place.
    ratio: float = 8.0
    finer: int = 12
    wider: int = 4
    # Discrepancy over truncation and rounding of both sides: more is neither.
    differs: float = 100.0
    # Discrepancy over the rise: less does not count.
    counts: float = 1e-6
    # Last coefficients that show the truncation: two of them may vanish by chance.
    last: int = 4
    # Truncated part of the heights, over their variation, up to which they have digits.
    digits: float = 1e-3


@dataclass(frozen=True)
class DifferenceOptions:
    """Steps of the central differences, each twice the one before, and the rounding of heights."""

    # Steps below the scale of a place: down to 1e-11 of it.
    finer: int = 36
    # Steps above it: heights with a large constant or with hidden rounding need wide ones.
    wider: int = 24
    # The widest step over the period of a height that repeats.
    of_period: float = 0.25
    # Steps that agree before a run is sure: the rounding of the last one is 2^8 times smaller.
    sure: int = 8
    # Rounding of an extrapolated quotient, over that of a height over the least step: below 2.
    margin: float = 3.0
    # Places that are worked on together, which bounds the memory.
    at_once: int = 2**12
    # Places side by side that share their rounding: insensitive, 16 to 64 give the same.
    together: int = 32
    # Steps whose median roughness is compared with that of as many wider ones.
    half_window: int = 3
    # Growth of that roughness up to which it is rounding: at a kink it grows by eight.
    level: float = 2.0
    # Rounding over what the first height that changes by it shows: the weights' ratio.
    begins: float = 128.0
    # A largest rounding over the median one.
    spread: float = 4.0
    # Hidden rounding over that of the highest heights met: places may be counted from far away.
    hides: float = 1e7


@dataclass(frozen=True)
class CheckOptions:
    """Where complex steps are checked."""

    # Places of a set: errors of a formula are as wide as its terms.
    places: int = 32
    # Width of the interval checked before, over that of a set, up to which it covers the set.
    covers: float = 16.0


VERDICTS = VerdictOptions()
DIFFERENCES = DifferenceOptions()
CHECKS = CheckOptions()


class DerivedSlope:
    """f' from f alone.

    length: one over which f varies, if known; ends: beyond which there is no f; period: with which
    f repeats, if it does.
    """

    def __init__(
        self,
        height: Function,
        length: float | None,
        ends: tuple[float, float] | None,
        period: float | None = None,
    ) -> None:
        self._options = DIFFERENCES
        if period is not None and length is not None:
            # Steps of whole periods see no slope, and all agree.
            wider = int(np.floor(np.log2(DIFFERENCES.of_period * period / length)))
            self._options = replace(DIFFERENCES, wider=min(DIFFERENCES.wider, wider))
        self._height, self._length, self._ends = height, length, ends
        self._complex = True
        self._checked = (np.inf, -np.inf)

    def __call__(self, x: Array) -> Array:
        return self._of(x.ravel()).reshape(x.shape) if x.size else np.zeros(x.shape)

    def _of(self, x: Array) -> Array:
        by_step = self._by_step(x)
        if by_step is None:
            return self._differences(x)
        lost = ~np.isfinite(by_step)
        if lost.any():
            by_step[lost] = self._differences(x[lost])
        return by_step

    def rounding(self, x: Array) -> float:
        """Median rounding of f' at some places; 0 where complex steps are taken."""
        if self._by_step(x) is not None:
            return 0.0
        scale = scale_of(x, self._length)
        return float(np.median(differences(self._height, x, scale, self._ends, self._options)[1]))

    def _differences(self, x: Array) -> Array:
        scale = scale_of(x, self._length)
        return differences(self._height, x, scale, self._ends, self._options)[0]

    def _by_step(self, x: Array) -> Array | None:
        """Complex steps; None where they cannot be taken or once they have been contradicted."""
        by_step = complex_step(self._height, x) if self._complex else None
        if by_step is None:
            return None
        lo, hi = float(x.min()), float(x.max())
        known = self._checked[0] <= lo and hi <= self._checked[1]
        if not (known and self._checked[1] - self._checked[0] <= CHECKS.covers * (hi - lo)):
            few = np.sort(x)[np.linspace(0, x.size - 1, min(x.size, CHECKS.places)).astype(np.intp)]
            judged = verdicts(
                self._height, self._step, few, scale_of(few, self._length, self._ends)
            )
            self._complex, self._checked = not judged.contradicted.any(), (lo, hi)
        return by_step if self._complex else None

    def _step(self, x: Array) -> Array:
        by_step = complex_step(self._height, x)
        return np.full(x.shape, np.nan) if by_step is None else by_step


def scale_of(
    x: Array, length: float | None = None, ends: tuple[float, float] | None = None
) -> Array:
    """For each place, a length about which steps are tried.

    It is the one that is known, else the distance of the place from 0 or from the next place. With
    ends, no interval of `verdicts` reaches beyond them.
    """
    if length is None:
        places, which = np.unique(x, return_inverse=True)
        apart = np.diff(places, prepend=-np.inf, append=np.inf)
        next_one = np.minimum(apart[:-1], apart[1:])[which].reshape(x.shape)
        scale = np.maximum(np.abs(x), np.where(np.isfinite(next_one), next_one, 0.0))
        scale = np.where(scale > 0, scale, 1.0)
    else:
        scale = np.full(x.shape, length)
    if ends is not None:
        room = np.minimum(x - ends[0], ends[1] - x) / VERDICTS.ratio**VERDICTS.wider
        scale = np.where(room > 0, np.minimum(scale, room), scale)
    return scale


def complex_step(height: Function, x: Array) -> Array | None:
    """Im f(x + ih)/h, not finite where f is not; None where the height takes no complex numbers."""
    value = complex_value(height, x + 1j * _TINY)
    return None if value is None else value.imag / _TINY


def complex_value(function: Function, z: NDArray[Any]) -> NDArray[Any] | None:
    """An author's function of complex numbers; None where it takes none."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        # A cast that discards the imaginary part is a warning of numpy.
        warnings.simplefilter("error")
        try:
            value = np.asarray(function(z))
        except Exception:  # it may refuse them in any way it likes
            return None
    return value if value.dtype.kind == "c" and value.shape == z.shape else None


@record
class Verdicts:
    """Whether the height contradicts or confirms a slope, for each place.

    off: by what part of the slope, on the interval that shows a contradiction best; claimed, seen:
    the mean slope there by the slope and by the height.
    """

    contradicted: NDArray[np.bool_]
    confirmed: NDArray[np.bool_]
    off: Array
    claimed: Array
    seen: Array


def verdicts(
    height: Function, slope: Function, x: Array, scale: Array, options: VerdictOptions = VERDICTS
) -> Verdicts:
    """Compare rises of the height with integrals of its slope on intervals about the places x.

    An interval tells only where both are resolved by a polynomial through its nodes, and heights
    have digits left.
    """
    contradicted, confirmed = np.zeros(x.shape, dtype=bool), np.zeros(x.shape, dtype=bool)
    claimed, seen, worst = np.zeros(x.shape), np.zeros(x.shape), np.zeros(x.shape)
    t = np.cos(np.pi * (np.arange(options.nodes) + 0.5) / options.nodes)
    for power in range(-options.finer, options.wider + 1):
        h = scale * options.ratio**power
        at = x[:, None] + h[:, None] * t
        with np.errstate(all="ignore"):
            heights = np.asarray(height(at), dtype=np.float64)
            slopes = np.asarray(slope(at), dtype=np.float64)
            off, agrees, integral = _compared(heights, slopes, h, x, options)
            j, k = np.argmax(heights, axis=1)[:, None], np.argmin(heights, axis=1)[:, None]
            apart, by_slope, by_height = (
                (np.take_along_axis(part, j, 1) - np.take_along_axis(part, k, 1))[:, 0]
                for part in (at, integral, heights)
            )
            better = off > worst
            claimed = np.where(better, by_slope / apart, claimed)
            seen = np.where(better, by_height / apart, seen)
        contradicted |= off > 0
        confirmed |= agrees
        worst = np.maximum(worst, off)
    return Verdicts(contradicted, confirmed, worst, claimed, seen)


def _compared(
    heights: Array, slopes: Array, h: Array, x: Array, options: VerdictOptions
) -> tuple[Array, NDArray[np.bool_], Array]:
    """For intervals of half width h about x, by rows: their discrepancy over the rise where it is a
    contradiction, else 0; whether they agree; the integral of the slope at the nodes."""
    n = options.nodes
    t = np.cos(np.pi * (np.arange(n) + 0.5) / n)
    fit = np.linalg.inv(chebyshev.chebvander(t, n - 1))
    rise = chebyshev.chebvander(t, n) @ chebyshev.chebint(fit)
    integral = h[:, None] * (slopes @ rise.T)
    off = np.ptp(heights - integral, axis=1)
    total, steepest = np.ptp(heights, axis=1), np.abs(slopes).max(axis=1)
    size = np.maximum(total, h * steepest)
    last = fit[-options.last :].T
    of_heights, of_slopes = (np.abs(part @ last).max(axis=1) for part in (heights, slopes))
    rounded = _EPS * (np.abs(heights).max(axis=1) + np.abs(x) * steepest)
    # Heights that do not change may hide a change below their rounding.
    tells = (total > 0) & (of_heights <= options.digits * total) & np.isfinite(off)
    tells &= rounded <= options.digits * size
    unexplained = off - options.differs * (of_heights + h * of_slopes + rounded)
    differs = tells & (unexplained > options.counts * size)
    return np.where(differs, off / size, 0.0), tells & (off <= options.counts * size), integral


def differences(
    height: Function,
    x: Array,
    scale: Array,
    ends: tuple[float, float] | None = None,
    options: DifferenceOptions = DIFFERENCES,
) -> tuple[Array, Array]:
    """f' at places (n,) by central differences at the best step of each, and its rounding.

    Places side by side share what is known of the rounding: a height near its tip does not show it.
    """
    order = np.argsort(x)
    best, doubt = np.empty(x.shape), np.empty(x.shape)
    with np.errstate(all="ignore"):
        for some in np.array_split(order, max(1, -(-len(x) // options.at_once))):
            # Whole blocks, the last one filled up with its last place.
            whole = np.append(
                some, np.full(-len(some) % min(options.together, len(some)), some[-1])
            )
            found = _first_run(*_quotients(height, x[whole], scale[whole], ends, options), options)
            best[some], doubt[some] = (part[: len(some)] for part in found)
    return best, doubt


def _quotients(
    height: Function,
    x: Array,
    scale: Array,
    ends: tuple[float, float] | None,
    options: DifferenceOptions,
) -> tuple[Array, Array]:
    """Extrapolated quotients of ascending places, steps growing by rows, and their rounding."""
    steps = scale * 2.0 ** np.arange(-options.finer, options.wider + 1)[:, None]
    if ends is not None:
        steps = np.where((x - steps >= ends[0]) & (x + steps <= ends[1]), steps, 0.0)
    here = np.asarray(height(x), dtype=np.float64)
    right, left = (np.asarray(height(at), dtype=np.float64) for at in (x + steps, x - steps))
    quotients = (right - left) / ((x + steps) - (x - steps))  # the steps taken, not those asked for
    blocks = min(options.together, len(x))
    finite = np.where(np.isfinite(here), np.abs(here), 0.0)
    highest = np.repeat(finite.reshape(-1, blocks).max(axis=1), blocks)
    rounding = _EPS * (
        np.maximum(np.maximum(np.abs(right), np.abs(left)), highest) + np.abs(x * quotients)
    )
    hidden = np.repeat(_hidden(right - 2 * here + left, rounding, blocks, options), blocks)
    # Combined so that no terms of h^2, h^4 and h^6 are left.
    values = (
        4096 * quotients[:-3] - 1344 * quotients[1:-2] + 84 * quotients[2:-1] - quotients[3:]
    ) / 2835
    return values, options.margin * (np.maximum(rounding[:-3], rounding[3:]) + hidden) / steps[:-3]


def _first_run(values: Array, noise: Array, options: DifferenceOptions) -> tuple[Array, Array]:
    """For each column the best value of a run of rows that agree to within noise, and its noise.

    It is the first run that is sure, else the longest: what agrees at wide steps only is an alias.
    The best value is the last but one before noise grows or the run ends: the last one may be off
    by as much as its noise lets pass.
    """
    n = values.shape[1]
    best, doubt = np.full(n, np.nan), np.full(n, np.inf)
    lo, hi, least = np.full(n, -np.inf), np.full(n, np.inf), np.full(n, np.inf)
    value, last, value_noise, last_noise = (np.full(n, np.nan) for _ in range(4))
    length, longest, done = (
        np.zeros(n, dtype=np.intp),
        np.zeros(n, dtype=np.intp),
        np.zeros(n, dtype=bool),
    )
    for new, off in zip(values, noise, strict=True):
        counts = np.isfinite(new) & np.isfinite(off) & ~done
        goes_on = counts & (length > 0) & (new >= lo - off) & (new <= hi + off)
        done |= counts & ~goes_on & (length >= options.sure)
        begins = counts & ~goes_on & ~done
        lo = np.where(begins, new - off, np.where(goes_on, np.maximum(lo, new - off), lo))
        hi = np.where(begins, new + off, np.where(goes_on, np.minimum(hi, new + off), hi))
        last, last_noise = np.where(begins, new, last), np.where(begins, off, last_noise)
        better = begins | (goes_on & (off < least))
        value, value_noise = (
            np.where(better, last, value),
            np.where(better, last_noise, value_noise),
        )
        last, last_noise, least = (
            np.where(counts, new, last),
            np.where(counts, off, last_noise),
            np.where(better, off, least),
        )
        length = np.where(begins, 1, length + goes_on)
        leads = (begins | goes_on) & (length > longest)
        best, doubt = np.where(leads, value, best), np.where(leads, value_noise, doubt)
        longest = np.maximum(longest, length)
    return best, doubt


def _hidden(evens: Array, rounding: Array, blocks: int, options: DifferenceOptions) -> Array:
    """Rounding of heights in each block that their size hides, as of cosh(x) - 1; else 0.

    evens: second differences. A combination of them of sixth order is level while it is rounding,
    and grows with the step where it is not.
    """
    rough = np.abs(evens[2:] - 20 * evens[1:-1] + 64 * evens[:-2]) / 128
    rough = np.median(
        np.where(np.isfinite(rough), rough, np.inf).reshape(len(rough), -1, blocks), axis=2
    )
    windows = np.lib.stride_tricks.sliding_window_view(rough, 2 * options.half_window, axis=0)
    before, after = (np.median(half, axis=2) for half in np.split(windows, 2, axis=2))
    level = (before > 0.0) & np.isfinite(before) & (after <= options.level * before)
    found = np.where(level, np.max(windows, axis=2), np.inf)
    found = np.where(found <= options.begins * np.min(found, axis=0), found, 0.0)
    found = np.max(np.where(np.isfinite(found), found, 0.0), axis=0)
    sizes = np.where(np.isfinite(rounding), rounding, 0.0).reshape(len(rounding), -1, blocks)
    return np.asarray(
        np.minimum(options.spread * found, options.hides * np.max(sizes, axis=(0, 2)))
    )


@dataclass(frozen=True)
class DetailOptions:
    """How the smallest length of a shape is found from its Chebyshev series."""

    # Heights at first and at the most.
    first: int = 256
    most: int = 2**14
    # Terms of the slope that count, over the largest; and of a series that has not ended.
    counts: float = 1e-5
    counts_of_sharp: float = 0.1
    # Parts of the interval that are looked at whatever the shape is.
    coarsest: int = 16


DETAIL = DetailOptions()


def detail_of(
    height: Callable[[Array], Any], lo: float, hi: float, options: DetailOptions = DETAIL
) -> float:
    """Smallest length over which heights vary between two places.

    It is that of the last term of the slope's Chebyshev series which counts.
    """
    length, n = hi - lo, options.first
    while True:
        # The ends themselves may be corners, beyond which there is no body.
        x = lo + length * np.sin(0.25 * np.pi * (2 * np.arange(n) + 1) / n) ** 2
        with np.errstate(all="ignore"):
            heights = np.asarray(height(x), dtype=np.float64)
            both_ways = np.concatenate((heights, heights[::-1]))
            slopes = np.arange(n) * np.abs(np.fft.rfft(both_ways)[:n])
        largest = float(slopes.max())
        if not 0.0 < largest < np.inf:
            return length / options.coarsest
        ended = bool(slopes[-n // 8 :].max() <= options.counts * largest)
        if ended or n >= options.most:
            break
        n *= 4
    least = options.counts if ended else options.counts_of_sharp
    last = int(np.flatnonzero(slopes > least * largest)[-1])
    return min(np.pi / last, 1 / options.coarsest) * length
