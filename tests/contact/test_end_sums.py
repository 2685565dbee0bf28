"""Fast sums over the ends of many intervals agree with direct sums."""

import mpmath
import numpy as np
import pytest

import sie
from contact.adhesion.end_sums import Cells, EndSum
from tests.tiers import diagonal

PERIOD = 7.0


def ends_of(kind, rng):
    """Ascending ends of intervals: equidistant, partly clustered, or random."""
    if kind == "even":
        return np.linspace(0.0, 6.5, 60)
    if kind == "clustered":
        return np.sort(
            np.concatenate((1.0 + 1e-9 * rng.uniform(size=20), rng.uniform(1.1, 6.5, 40)))
        )
    return np.sort(rng.uniform(0.0, 6.5, 160))


def places_of(ends, rng):
    """Random points; half of them are next to ends."""
    beside = rng.choice(ends, 60) + 10.0 ** rng.uniform(-12, -1, 60) * rng.choice((-1.0, 1.0), 60)
    return np.concatenate((beside, rng.uniform(-0.4, 6.9, 60)))


def exactly(x, ends, period):
    """Sum of the signed logarithms, to 30 digits."""

    def log(lag):
        return mpmath.log(abs(lag if period is None else 2 * mpmath.sin(mpmath.pi * lag / period)))

    with mpmath.workdps(30):
        lags = [mpmath.mpf(float(x)) - mpmath.mpf(float(end)) for end in ends]
        return float(mpmath.fsum((-1) ** k * log(lag) for k, lag in enumerate(lags)))


@pytest.mark.parametrize(
    ("kind", "period", "longest"),
    diagonal(["even", "clustered", "random"], [PERIOD, None], [np.inf, 0.3]),
)
def test_fast_sums_agree_with_direct_sums(kind, period, longest):
    rng = np.random.default_rng(3)
    ends = ends_of(kind, rng)

    def log(lag):
        lag = sie.nearest_image(lag, 0.0, period)
        return np.log(np.abs(lag if period is None else 2 * np.sin(np.pi * lag / period)))

    x = places_of(ends, rng)
    found = EndSum(Cells(ends, period, longest), np.tile((1.0, -1.0), len(ends) // 2), log)(x)
    wanted = np.array([exactly(place, ends, period) for place in x])
    # The term of an end is the logarithm of the distance from x to this end. Round-off of x changes
    # the term by eps * PERIOD, divided by this distance.
    near = np.abs(sie.nearest_image(x[:, None] - ends, 0.0, period))
    assert np.all(
        np.abs(found - wanted) <= 1e-13 + 8 * np.finfo(float).eps * PERIOD / near.min(axis=1)
    )


def test_distant_ends_are_not_summed_for_each_point():
    rng = np.random.default_rng(5)
    ends, lags = np.sort(rng.uniform(0.0, 6.5, 400)), []

    def log(lag):
        lags.append(lag.size)
        return np.log(np.abs(lag))

    total = EndSum(Cells(ends, None, np.inf), np.tile((1.0, -1.0), 200), log)
    x = rng.uniform(ends[0], ends[-1], 100_000)
    total(x)
    # The first evaluation, above, computed the series of the cells. The second one is counted.
    del lags[:]
    total(x)
    assert sum(lags) < 8 * len(x)
