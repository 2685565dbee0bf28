"""The slope of a profile whose author gave only its height.

Complex step: f'(x) = Im f(x + ih)/h, exact to round-off for analytic f (W. Squire & G. Trapp 1998,
doi 10.1137/S003614459631241X). It is wrong for a height that takes |x| or drops the imaginary part.
So it is used only if the rise of the height does not contradict the integral of this slope
(`verdicts`).

Otherwise central differences are extrapolated (L. F. Richardson 1911, doi 10.1098/rsta.1911.0009).
Each place has its own step: the best of the steps whose results agree with the results of all
shorter steps to within round-off (O. V. Lepski 1991, doi 10.1137/1135065). So the slope at a place
does not depend on values far from it.
"""

import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from contact.model.profiles.noise import EPS
from contact.model.profiles.trigonometric import BLOCK
from sie import Array, record

# Step of the complex-step derivative. Its square is negligible against any length, so there is no
# truncation error.
_TINY = 1e-100

Function = Callable[[Any], Any]


@dataclass(frozen=True)
class VerdictOptions:
    """Options for comparing differences of heights with integrals of the slope.

    nodes: number of Chebyshev points of an interval. 7 to 13 nodes give the same verdicts.
    ratio: length of an interval, relative to the next smaller one. A check of an interval also
        holds for a part of it, unless the part is shorter by more than this factor.
    differs: smallest discrepancy that is a contradiction, relative to the truncation and round-off
        errors of heights and slopes.
    counts: smallest discrepancy that is a contradiction, relative to the rise of the height.
        Heights are used if their truncation and round-off errors, relative to their rise, are below
        the square root of `counts`.
    """

    nodes: int = 9
    ratio: float = 8.0
    differs: float = 100.0
    counts: float = 1e-6


@dataclass(frozen=True)
class DifferenceOptions:
    """Options for central differences with several steps, each twice as long as the one before.

    wider: number of steps longer than the length scale of a place. Heights with a large constant
        need wide steps.
    sure: number of successive steps whose quotients must agree. Over 8 steps round-off falls to
        2^-8. The round-off of heights is measured over the same number of steps.
    margin: largest round-off, relative to the median round-off. Also the round-off of an
        extrapolated quotient, relative to that of a height divided by the smallest step.
    together: number of neighbouring places with one estimate of round-off. Numbers from 16 to 64
        are equally good.
    """

    wider: int = 24
    sure: int = 8
    margin: float = 4.0
    together: int = 32


VERDICTS = VerdictOptions()
DIFFERENCES = DifferenceOptions()
# Number of steps shorter than the length scale of a place. With the shortest of these steps a
# difference quotient still has some digits. With still shorter steps the height might not change:
# quotients that are all zero would agree and be taken for the slope.
_FINER = int(-np.log2(EPS)) - 2 * DIFFERENCES.sure


class DerivedSlope:
    """The slope f' computed from the height f alone.

    length: the length over which f varies, if known.
    ends: the interval in which f is defined, if it is limited.
    period: the period of f, if it has one.
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
            # The two places of a difference are at most half a period apart. Differences over whole
            # periods are all zero: they would agree and be taken for the slope.
            wider = int(np.floor(np.log2(0.25 * period / length)))
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
        failed = ~np.isfinite(by_step)
        if failed.any():
            by_step[failed] = self._differences(x[failed])
        return by_step

    def rounding(self, x: Array) -> float:
        """Median round-off error of the slope f' at the places x; 0 if it is a complex-step
        derivative.
        """
        if self._by_step(x) is not None:
            return 0.0
        scale = scale_of(x, self._length)
        return float(np.median(differences(self._height, x, scale, self._ends, self._options)[1]))

    def _differences(self, x: Array) -> Array:
        scale = scale_of(x, self._length)
        return differences(self._height, x, scale, self._ends, self._options)[0]

    def _by_step(self, x: Array) -> Array | None:
        """Complex-step derivatives at x. They are None if the height does not accept complex
        numbers, or if the heights contradict the derivatives.
        """
        by_step = complex_step(self._height, x) if self._complex else None
        if by_step is None:
            return None
        lo, hi = float(x.min()), float(x.max())
        known = self._checked[0] <= lo and hi <= self._checked[1]
        if not (known and self._checked[1] - self._checked[0] <= VERDICTS.ratio * (hi - lo)):
            few = np.sort(x)[
                np.linspace(0, x.size - 1, min(x.size, DIFFERENCES.together)).astype(np.intp)
            ]
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
    """For each place, a typical length over which the shape varies there.
    The steps of the differences that are tried lie around this length.

    It is the known length, else the distance of the place from 0 or from the next place, whichever
    is larger. If `ends` are given, no interval of `verdicts` reaches outside the ends.
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
        room = np.minimum(x - ends[0], ends[1] - x)
        scale = np.where(room > 0, np.minimum(scale, room), scale)
    return scale


def complex_step(height: Function, x: Array) -> Array | None:
    """The complex-step derivative Im f(x + ih)/h, not finite where f is not finite. It is None
    if the height does not accept complex numbers.
    """
    value = complex_value(height, x + 1j * _TINY)
    return None if value is None else value.imag / _TINY


def complex_value(function: Function, z: NDArray[Any]) -> NDArray[Any] | None:
    """Value of an author's function at complex numbers; None if the function does not accept
    complex numbers.
    """
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        # Numpy warns if a cast discards the imaginary part. Here the warning becomes an exception.
        warnings.simplefilter("error")
        try:
            value = np.asarray(function(z))
        except Exception:  # the author's code may raise anything
            return None
    return value if value.dtype.kind == "c" and value.shape == z.shape else None


@record
class Verdicts:
    """Result at each place: whether the heights contradict a slope, and whether they confirm it.

    discrepancy: the difference between the heights and the integral of the slope, divided by the
    rise of the height, on the interval where it is largest; 0 without a contradiction.
    claimed, seen: the mean slope on this interval, from the slope and from the height.
    """

    contradicted: NDArray[np.bool_]
    confirmed: NDArray[np.bool_]
    discrepancy: Array
    claimed: Array
    seen: Array


def verdicts(
    height: Function, slope: Function, x: Array, scale: Array, options: VerdictOptions = VERDICTS
) -> Verdicts:
    """Compare differences of the height with integrals of the slope on intervals about the
    places x.

    An interval counts only if a polynomial through its nodes resolves the height and the slope, and
    if round-off leaves digits of the heights.
    """
    contradicted, confirmed = np.zeros(x.shape, dtype=bool), np.zeros(x.shape, dtype=bool)
    claimed, seen, worst = np.zeros(x.shape), np.zeros(x.shape), np.zeros(x.shape)
    t = np.cos(np.pi * (np.arange(options.nodes) + 0.5) / options.nodes)
    for power in range(int(_FINER / np.log2(options.ratio)) + 1):
        h = scale / options.ratio**power
        at = x[:, None] + h[:, None] * t
        with np.errstate(all="ignore"):
            heights = np.asarray(height(at), dtype=np.float64)
            slopes = np.asarray(slope(at), dtype=np.float64)
            discrepancy, agrees, integral = _compared(heights, slopes, h, x, options)
            j, k = np.argmax(heights, axis=1)[:, None], np.argmin(heights, axis=1)[:, None]
            apart, by_slope, by_height = (
                (np.take_along_axis(part, j, 1) - np.take_along_axis(part, k, 1))[:, 0]
                for part in (at, integral, heights)
            )
            better = discrepancy > worst
            claimed = np.where(better, by_slope / apart, claimed)
            seen = np.where(better, by_height / apart, seen)
        contradicted |= discrepancy > 0
        confirmed |= agrees
        worst = np.maximum(worst, discrepancy)
    return Verdicts(contradicted, confirmed, worst, claimed, seen)


def _compared(
    heights: Array, slopes: Array, h: Array, x: Array, options: VerdictOptions
) -> tuple[Array, NDArray[np.bool_], Array]:
    """Compare heights with integrals of slopes on intervals of half width h about the places x.
    Each row of the arrays is one interval.

    Returns three arrays: the discrepancy relative to the rise if it is a contradiction, else 0;
    whether heights and slopes agree; and the integral of the slope at the nodes.
    """
    n = options.nodes
    t = np.cos(np.pi * (np.arange(n) + 0.5) / n)
    fit = np.linalg.inv(chebyshev.chebvander(t, n - 1))
    rise = chebyshev.chebvander(t, n) @ chebyshev.chebint(fit)
    integral = h[:, None] * (slopes @ rise.T)
    discrepancy = np.ptp(heights - integral, axis=1)
    total, steepest = np.ptp(heights, axis=1), np.abs(slopes).max(axis=1)
    size = np.maximum(total, h * steepest)
    last = fit[-options.nodes // 2 :].T
    of_heights, of_slopes = (np.abs(part @ last).max(axis=1) for part in (heights, slopes))
    rounded = EPS * (np.abs(heights).max(axis=1) + np.abs(x) * steepest)
    # If the heights of an interval are all equal, they are not compared with the slopes: round-off
    # may hide a change of the height.
    digits = np.sqrt(options.counts)
    is_accurate = (total > 0) & (of_heights <= digits * total) & np.isfinite(discrepancy)
    is_accurate &= rounded <= digits * size
    unexplained = discrepancy - options.differs * (of_heights + h * of_slopes + rounded)
    differs = is_accurate & (unexplained > options.counts * size)
    return (
        np.where(differs, discrepancy / size, 0.0),
        is_accurate & (discrepancy <= options.counts * size),
        integral,
    )


def differences(
    height: Function,
    x: Array,
    scale: Array,
    ends: tuple[float, float] | None = None,
    options: DifferenceOptions = DIFFERENCES,
) -> tuple[Array, Array]:
    """The slope f' at places (n,) by central differences, each with its best step, and the
    round-off error of f'.

    Neighbouring places share one estimate of round-off: a height near 0, as at a tip, does not show
    the round-off of the terms from which it is computed.
    """
    order = np.argsort(x)
    best, doubt = np.empty(x.shape), np.empty(x.shape)
    with np.errstate(all="ignore"):
        for some in np.array_split(order, max(1, -(-len(x) // BLOCK))):
            # The last block of places is as long as the other blocks: it repeats its last place.
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
    """Extrapolated difference quotients and their round-off. Rows are steps, columns are places."""
    steps = scale * 2.0 ** np.arange(-_FINER, options.wider + 1)[:, None]
    if ends is not None:
        steps = np.where((x - steps >= ends[0]) & (x + steps <= ends[1]), steps, 0.0)
    here = np.asarray(height(x), dtype=np.float64)
    right, left = (np.asarray(height(at), dtype=np.float64) for at in (x + steps, x - steps))
    quotients = (right - left) / ((x + steps) - (x - steps))  # the rounded steps
    blocks = min(options.together, len(x))
    finite = np.where(np.isfinite(here), np.abs(here), 0.0)
    highest = np.repeat(finite.reshape(-1, blocks).max(axis=1), blocks)
    rounding = EPS * (
        np.maximum(np.maximum(np.abs(right), np.abs(left)), highest) + np.abs(x * quotients)
    )
    hidden = np.repeat(_block_round_off(right - 2 * here + left, rounding, blocks, options), blocks)
    # This combination of the quotients with the steps h, 2h, 4h and 8h has no error terms in h^2,
    # h^4 and h^6.
    values = (
        4096 * quotients[:-3] - 1344 * quotients[1:-2] + 84 * quotients[2:-1] - quotients[3:]
    ) / 2835
    return values, options.margin * (np.maximum(rounding[:-3], rounding[3:]) + hidden) / steps[:-3]


def _first_run(values: Array, noise: Array, options: DifferenceOptions) -> tuple[Array, Array]:
    """For each place (column), the best value of a run of steps, and the noise of this value.
    A run is a sequence of successive steps (rows) whose values agree to within noise.

    The run is the first one that is long enough, else the longest one: if values agree only for
    wide steps, they may be wrong (aliasing). The best value is the last but one before noise grows
    or the run ends, as the last value may be wrong by as much as its noise.
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
    for new, error in zip(values, noise, strict=True):
        counts = np.isfinite(new) & np.isfinite(error) & ~done
        goes_on = counts & (length > 0) & (new >= lo - error) & (new <= hi + error)
        done |= counts & ~goes_on & (length >= options.sure)
        begins = counts & ~goes_on & ~done
        lo = np.where(begins, new - error, np.where(goes_on, np.maximum(lo, new - error), lo))
        hi = np.where(begins, new + error, np.where(goes_on, np.minimum(hi, new + error), hi))
        last, last_noise = np.where(begins, new, last), np.where(begins, error, last_noise)
        better = begins | (goes_on & (error < least))
        value, value_noise = (
            np.where(better, last, value),
            np.where(better, last_noise, value_noise),
        )
        last, last_noise, least = (
            np.where(counts, new, last),
            np.where(counts, error, last_noise),
            np.where(better, error, least),
        )
        length = np.where(begins, 1, length + goes_on)
        leads = (begins | goes_on) & (length > longest)
        best, doubt = np.where(leads, value, best), np.where(leads, value_noise, doubt)
        longest = np.maximum(longest, length)
    return best, doubt


def _block_round_off(
    evens: Array, rounding: Array, blocks: int, options: DifferenceOptions
) -> Array:
    """Round-off of heights in each block of places, found from differences; 0 if not found.

    The result may exceed `rounding`: near x = 0, the round-off of cosh(x) - 1 is that of cosh(x).

    evens: second differences, one row for each step, with growing steps. rounding: the round-off
    that follows from the size of the heights. A combination of sixth order of these differences
    grows with the step, unless it is round-off.
    """
    part = 128
    rough = np.abs(evens[2:] - 20 * evens[1:-1] + 64 * evens[:-2]) / part
    rough = np.where(np.isfinite(rough), rough, np.inf).reshape(len(rough), -1, blocks)
    windows = np.lib.stride_tricks.sliding_window_view(
        np.median(rough, axis=2), options.sure, axis=0
    )
    before, after = (np.median(half, axis=2) for half in np.split(windows, 2, axis=2))
    # A window of successive steps is level if its differences do not grow with the step, as is true
    # of round-off. The test compares the median of its second half (`after`) with that of its first
    # half (`before`). A median of 0 is excluded: such steps were too short to change a height.
    level = (before > 0.0) & np.isfinite(before) & (after <= 2 * before)
    found = np.where(level, np.max(windows, axis=2), np.inf)
    # The differences in a level window show the round-off. At the shortest steps they may be as
    # small as 1/`part` of the round-off. Each level window has its largest difference in `found`. A
    # window is left out if its largest difference exceeds `part` times the smallest entry of
    # `found`.
    found = np.where(found <= part * np.min(found, axis=0), found, 0.0)
    largest = np.max(np.where(np.isfinite(found), found, 0.0), axis=0)
    sizes = np.where(np.isfinite(rounding), rounding, 0.0).reshape(len(rounding), -1, blocks)
    # A steep rise of the height can look like large round-off. So the result is at most
    # 1/sqrt(EPS) times `rounding`, which follows from the size of the heights.
    most = np.max(sizes, axis=(0, 2)) / np.sqrt(EPS)
    return np.asarray(np.minimum(options.margin * largest, most))


@dataclass(frozen=True)
class DetailOptions:
    """Options for the search for a shape's smallest length, by a Chebyshev series of samples.

    samples: number of places at which slopes are sampled for their largest value and mean square.
        Claims of users' profiles are checked at as many places. A factor of two changes no answer.
    max_samples: largest number of heights in a search.
    counts: terms of the slope's series below this fraction of the largest one are neglected.
    counts_of_sharp: replaces `counts` if the series has not converged, as for shapes with corners.
    samples_per_length: number of samples in the smallest length of a shape. The smallest length is
        at most the interval divided by this number.
    """

    samples: int = 2**10
    max_samples: int = 2**15
    counts: float = 1e-5
    counts_of_sharp: float = 0.1
    samples_per_length: int = 16

    @property
    def min_samples(self) -> int:
        """Number of samples with which the search for the smallest length begins."""
        return self.samples_per_length**2


DETAIL = DetailOptions()


def detail_of(
    height: Callable[[Array], Any], lo: float, hi: float, options: DetailOptions = DETAIL
) -> float:
    """Smallest length over which the height varies between the places lo and hi.

    The slope is a Chebyshev series: the result is the length over which its last term that is not
    neglected varies.
    """
    length, n, counts = hi - lo, options.min_samples, options.counts
    while True:
        # The samples leave out the ends of the interval. An end may be a corner, outside which
        # there is no body.
        x = lo + length * np.sin(0.25 * np.pi * (2 * np.arange(n) + 1) / n) ** 2
        with np.errstate(all="ignore"):
            heights = np.asarray(height(x), dtype=np.float64)
            both_ways = np.concatenate((heights, heights[::-1]))
            slopes = np.arange(n) * np.abs(np.fft.rfft(both_ways)[:n])
        largest = float(slopes.max())
        if not 0.0 < largest < np.inf:
            return length / options.samples_per_length
        ended = bool(slopes[-n // 8 :].max() <= counts * largest)
        if ended or 4 * n > options.max_samples:
            break
        n *= 4
    least = counts if ended else options.counts_of_sharp
    last = int(np.flatnonzero(slopes > least * largest)[-1])
    return min(np.pi / last, 1 / options.samples_per_length) * length
