"""Kernels: the regular part that remains without the poles, and the limit of many images."""

import mpmath
import numpy as np
import pytest
from scipy.integrate import quad

import sie

DISTANCES = [-0.99, -0.5, -0.123, -1e-9, 0.0, 1e-9, 0.3, 0.75, 0.99]


def regular_in_30_digits(d, period):
    """(pi/L) cot(pi d/L) without its poles at 0 and +-L, to 30 digits."""
    with mpmath.workdps(50):
        d, length = mpmath.mpf(d), mpmath.mpf(period)
        d = d + mpmath.mpf(10) ** -30
        whole = mpmath.pi / length * mpmath.cot(mpmath.pi * d / length)
        return float(whole - 1 / d - 1 / (d - length) - 1 / (d + length))


@pytest.mark.parametrize("period", [1.0, 1e-6, 250.0])
def test_the_regular_part_is_the_cotangent_less_its_poles(period):
    kernel = sie.hilbert(period)
    for share in DISTANCES:
        found = float(kernel.regular(np.array(share * period), np.array(0.0)))
        assert found * period == pytest.approx(
            regular_in_30_digits(share, 1.0), rel=1e-14, abs=1e-15
        )


@pytest.mark.parametrize("period", [1.0, 1e-6, 250.0])
def test_the_whole_potential_is_the_logarithm_of_twice_the_sine(period):
    kernel = sie.hilbert(period)
    for share in (-0.9, -0.31, 1e-8, 0.5, 0.77):
        d = np.array(share * period)
        poles = sum(np.log(np.abs(d - s) / kernel.datum) for s in kernel.poles)
        found = float(poles + kernel.regular_potential(d, np.array(0.0)))
        assert found == pytest.approx(np.log(abs(2 * np.sin(np.pi * share))), abs=5e-15)


@pytest.mark.parametrize("share", [-0.7, -0.2, 0.05, 0.6])
def test_the_regular_potential_has_the_regular_kernel_for_derivative(share):
    kernel, h = sie.hilbert(2.0), 2e-3
    x = 2.0 * share + np.array([-2, -1, 1, 2]) * h
    slope = np.dot(kernel.regular_potential(x, np.zeros(4)), [1 / 12, -2 / 3, 2 / 3, -1 / 12]) / h
    # The fourth-order difference has an error of h^4 f^(5) / 30 and a round-off of 1e-16 / h.
    assert slope == pytest.approx(
        float(kernel.regular(np.array(2.0 * share), np.array(0.0))), abs=1e-11
    )


def test_the_mean_of_the_periodic_potential_is_zero():
    mean = quad(lambda d: np.log(2 * np.sin(np.pi * d)), 0, 0.5)[0]
    assert mean == pytest.approx(0.0, abs=1e-12)


def test_with_m_images_the_kernel_differs_from_the_periodic_one_by_about_one_over_m():
    d, counts = 0.3, np.array([4, 8, 16, 32, 64])
    exact = np.pi / np.tan(np.pi * d)
    errors = []
    for m in counts:
        kernel = sie.images(1.0, int(m))
        assert len(kernel.poles) == 2 * m + 1
        assert kernel.poles[0] == 0.0
        errors.append(sum(1 / (d - s) for s in kernel.poles) - exact)
    # The sum over k > m of 2 d/(k^2 - d^2) is 2 d/(m + 1/2), to second order in 1/m.
    order = -np.polyfit(np.log(counts + 0.5), np.log(np.abs(errors)), 1)[0]
    assert order == pytest.approx(1.0, abs=0.01)
    assert errors[-1] == pytest.approx(2 * d / 64.5, rel=1e-3)


def test_the_total_with_images_tends_to_that_with_a_period():
    half, length = 0.2, 1.0
    forcing = sie.Forcing(lambda x: np.sin(2 * np.pi * x))
    ends = sie.Zones.of([[-half, half]], sie.BOUNDED, sie.BOUNDED, symmetric=True)
    periodic = sie.solve_fixed(sie.Equation(sie.hilbert(length), forcing, ()), ends).density.total
    counts = np.array([8, 16, 32, 64])
    equations = [sie.Equation(sie.images(length, int(m)), forcing, ()) for m in counts]
    totals = [sie.solve_fixed(equation, ends).density.total for equation in equations]
    # The kernel lacks about 2 d / (m + 1/2) at the distance d. So the error of the total falls as
    # 1 / (m + 1/2).
    order = -np.polyfit(np.log(counts + 0.5), np.log(np.abs(np.array(totals) - periodic)), 1)[0]
    assert order == pytest.approx(1.0, abs=0.03)


def test_regular_kernels_add_and_their_reach_is_unknown():
    one = sie.Smooth(lambda x, xi: np.exp(-((x - xi) ** 2)))
    both = sie.hilbert(1.0) + one + one
    d = np.array(0.3)
    expected = sie.hilbert(1.0).regular(d, np.array(0.0)) + 2 * np.exp(-0.09)
    assert both.regular(d, np.array(0.0)) == pytest.approx(expected, rel=1e-15)
    assert both.reach == 0.0
    assert both.regular_potential is None


def test_only_regular_kernels_can_be_added():
    with pytest.raises(ValueError, match="a sie.Smooth or a function"):
        sie.cauchy() + 3


@pytest.mark.parametrize("period", [0.0, -1.0, np.nan, np.inf])
def test_a_period_must_be_a_positive_number(period):
    with pytest.raises(ValueError, match="period must be"):
        sie.hilbert(period)
