"""Power sums at many points, against a geometric series and sums in higher precision."""

import numpy as np
import pytest

from contact.formulation.power_sums import power_sums

EPS = np.finfo(float).eps


def points(rng, count):
    """Logarithms of points w in the unit disc, at random angles.

    The depth is -Re log w. There are rows of points at four depths, of which 0 is the edge of
    the disc. Other points have random depths over several decades.
    """
    depth = (
        2
        * np.pi
        * np.concatenate(
            (np.repeat([0.0, 3e-4, 0.02, 0.9], count), 10 ** rng.uniform(-5, 0, 2 * count))
        )
    )
    return -depth + 1j * rng.uniform(-np.pi, np.pi, len(depth))


@pytest.mark.parametrize("terms", [1, 7, 150, 3000])
@pytest.mark.parametrize("count", [3, 400])
def test_a_geometric_series_has_its_sum(terms, count):
    exponent, k = points(np.random.default_rng(1), count), np.arange(1, terms + 1)
    ratio = 0.98 * np.exp(0.3j)
    value, slope = power_sums(ratio**k, exponent)
    q = ratio * np.exp(exponent)
    top, n = q**terms, terms
    assert np.allclose(value, q * (1 - top) / (1 - q), rtol=0, atol=400 * EPS * 50)
    exact = q * (1 - (n + 1) * top + n * top * q) / (1 - q) ** 2
    assert np.allclose(slope, exact, rtol=0, atol=400 * EPS * 2500)


@pytest.mark.skipif(np.finfo(np.longdouble).eps > 1e-18, reason="no more digits than a double")
def test_no_digits_are_lost_in_layers_of_many_points():
    rng, terms = np.random.default_rng(2), 2000
    k = np.arange(1, terms + 1).astype(np.longdouble)
    c = (rng.normal(size=terms) + 1j * rng.normal(size=terms)) / np.arange(1, terms + 1)
    exponent = points(rng, 500)
    value, slope = power_sums(c, exponent)
    some = rng.permutation(4 * 500)[:60]  # from the rows of equal depth
    angle = k * exponent.imag[some, None].astype(np.longdouble)
    size = np.exp(k * exponent.real[some, None].astype(np.longdouble))
    each = c * size * (np.cos(angle) + 1j * np.sin(angle))
    # The size of a sum for comparison is its root mean square over all angles at the point's
    # depth.
    local = np.sqrt((np.abs(each) ** 2).sum(axis=1))
    steep = np.sqrt((np.abs(k * each) ** 2).sum(axis=1))
    assert np.max(np.abs(value[some] - each.sum(axis=1)) / local) < 30 * EPS
    assert np.max(np.abs(slope[some] - (k * each).sum(axis=1)) / steep) < 30 * EPS
