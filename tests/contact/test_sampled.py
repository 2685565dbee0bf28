"""Profiles of sampled points: the spline, its period, and the exact conjugate of its slope."""

from __future__ import annotations

import subprocess
import sys

import mpmath
import numpy as np
import pytest

from contact import Sampled, SceneError
from contact.testing import check_profile


def cosine(n: int, period: float = 2.0, start: float = 0.3) -> Sampled:
    x = start + period * np.arange(n) / n
    return Sampled(x, np.cos(2 * np.pi * x / period), period)


def exact_series(s: Sampled, terms: int, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Slope and conjugate at x, from the Fourier series of the periodic cubic spline (Schoenberg).

    The coefficients are those of the discrete transform times
    sinc^4(k/n) 3/(2 + cos(2 pi k/n)).
    """
    n, k = s.x.size, np.arange(1, terms + 1)
    amplitude = (
        (np.fft.fft(-s.heights) / n)[k % n]
        * np.sinc(k / n) ** 4
        * 3
        / (2 + np.cos(2 * np.pi * k / n))
    )
    wave = 2 * np.pi * k / s.period
    phase = np.exp(1j * np.outer(x - s.x0, wave))
    return 2 * np.real(phase @ (1j * wave * amplitude)), 2 * np.real(phase @ (wave * amplitude))


def test_the_spline_goes_through_every_point_upside_down() -> None:
    s = Sampled([0, 1, 3, 4, 7], [1.0, 5, 2, 2.5, 0])
    assert np.allclose(s.height(s.x), [4, 0, 3, 2.5, 5], rtol=0, atol=1e-15)


def test_a_cubic_is_reproduced_exactly_without_a_period() -> None:
    x = np.array([-1, -0.2, 0.3, 1.1, 2.0])
    s = Sampled(x, 1 - x**2 + 0.3 * x**3)
    t = np.linspace(-1, 2, 31)
    assert np.allclose(s.slope(t), 2 * t - 0.9 * t**2, rtol=0, atol=1e-13)


def test_the_spline_of_a_cosine_converges_at_fourth_order() -> None:
    t = np.linspace(0, 2, 501)
    errors = [
        np.max(
            np.abs(1 - cosine(n).height(t) - np.cos(np.pi * t) - (1 - np.max(cosine(n).heights)))
        )
        for n in (20, 40, 80)
    ]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4, abs=0.15)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(4, abs=0.15)


def test_a_repeated_end_point_is_dropped_and_changes_nothing() -> None:
    x, h = np.arange(6.0), np.array([0, 2, 1, 3, 1, 0.0])
    closed, opened = Sampled(x, h, 5.0), Sampled(x[:-1], h[:-1], 5.0)
    assert closed == opened and closed.x.size == 5


def test_a_repeated_end_point_with_another_height_is_refused() -> None:
    with pytest.raises(SceneError, match="height"):
        Sampled(np.arange(6.0), [0, 2, 1, 3, 1, 0.001], 5.0)


def test_a_periodic_spline_is_twice_continuously_differentiable_across_the_border() -> None:
    rng = np.random.default_rng(0)
    s = Sampled(np.sort(rng.uniform(0, 1, 12)), rng.standard_normal(12), 1.1)
    h = 1e-6
    left = (s.slope(s.x0) - s.slope(s.x0 - h)) / h
    right = (s.slope(s.x0 + h) - s.slope(s.x0)) / h
    assert s.height(s.x0 - 1e-13) == pytest.approx(float(s.height(s.x0)), abs=1e-10)
    # Only the third derivative jumps: one-sided second derivatives agree up to h f'''.
    assert abs(left - right) <= h * np.max(np.abs(6 * s._spline.c[0])) * 1.01 + 1e-7


def test_without_a_period_a_trace_is_undefined_outside_its_points() -> None:
    s = Sampled([0.1, 0.2, 0.3, 0.4], [0, 1, 0, 1])
    assert s.extent == (0.1, 0.4) and s.support is None and s.period is None
    assert np.array_equal(
        np.isnan(s.height([0.09, 0.1, 0.1 - 1e-17, 0.4, 0.41])), [True, False, False, False, True]
    )
    assert cosine(8).extent is None


@pytest.mark.parametrize("n", [4, 5, 7, 16, 24, 41])
def test_the_conjugate_is_that_of_the_splines_own_fourier_series(n: int) -> None:
    rng = np.random.default_rng(n)
    s = Sampled(0.3 + 2.5 * np.arange(n) / n, rng.standard_normal(n), 2.5)
    x = rng.uniform(-4, 4, 20)
    terms = 20_000
    slope, conjugate = exact_series(s, terms, x)
    # The terms of f' fall as k^-3, so the truncation error is about (n/terms)^2 of the largest
    # slope. No other difference is allowed.
    tail = 0.2 * (n / terms) ** 2 * np.max(np.abs(slope)) + 1e-12
    assert np.max(np.abs(s.slope(x) - slope)) < tail
    assert np.max(np.abs(s.slope_conjugate(x) - conjugate)) < tail
    assert np.max(np.abs(1.0001 * s.slope_conjugate(x) - conjugate)) > tail


def test_the_conjugate_equals_the_sum_of_trilogarithms_of_its_knots() -> None:
    # At its knots x_j, f''' jumps by J_j, so f'''' is the sum of J_j delta(x - x_j). Therefore
    # H f' = sum_j J_j (2/(L w^3)) sum_k cos(k w (x - x_j))/k^3, with w = 2 pi/L.
    n, period = 9, 0.7
    w = 2 * np.pi / period
    s = Sampled(period * np.arange(n) / n, np.random.default_rng(4).standard_normal(n), period)
    at, _, jumps = s.jumps.T
    for x in (0.0, 0.0131, 0.35, 0.69):
        terms = [mpmath.polylog(3, mpmath.expj(w * (x - xj))).real for xj in at]
        exact = 2 / (period * w**3) * float(mpmath.fdot(jumps, terms))
        # The round-off of the jumps is amplified, because terms of the reference solution
        # cancel.
        assert s.slope_conjugate(x) == pytest.approx(
            exact, rel=0, abs=1e-14 * np.sum(np.abs(jumps)) / w**2
        )


def test_the_conjugate_of_ten_thousand_points_is_good_to_eleven_digits() -> None:
    n = 10_000
    x = np.arange(n) / n
    s = Sampled(x, np.cos(2 * np.pi * x), 1.0)
    t = np.random.default_rng(1).uniform(0, 1, 500)
    # Between the knots, the slope of the spline itself has a relative error of about
    # (2 pi/n)^3 / 100 = 2e-12.
    assert np.max(np.abs(s.slope_conjugate(t) / (2 * np.pi) + np.cos(2 * np.pi * t))) < 1e-11


@pytest.mark.parametrize("positions", ["off", "rounded", "in heaps"])
def test_the_conjugate_of_uneven_points_equals_the_sum_of_clausen_functions_of_its_knots(
    positions: str,
) -> None:
    rng, n, period = np.random.default_rng(8), 12, 12.5
    x = {
        "off": np.arange(n) + rng.uniform(-0.4, 0.4, n),
        "rounded": np.round(1.0004 * np.arange(n), 2),
        "in heaps": np.sort(
            np.concatenate((rng.uniform(0, 12, n // 2), 7 + 10 ** rng.uniform(-3, 0, n // 2)))
        ),
    }[positions]
    s = Sampled(x, rng.standard_normal(n), period)
    at = np.concatenate((rng.uniform(x[0], x[0] + period, 4), s.x[3:5]))
    assert np.max(np.abs(s.slope_conjugate(at) - of_knots(s, at))) < 1e-12 * np.max(
        np.abs(s.slope(x))
    )


def of_knots(s: Sampled, x: np.ndarray) -> np.ndarray:
    """The conjugate H f' from the jumps of the derivatives at the knots, in 25 digits.

    The first two derivatives jump only because the coefficients of the spline are rounded.
    """
    with mpmath.workdps(25):
        knots, third, second, first = (
            [mpmath.mpf(value) for value in row] for row in (s._knots, *s._spline.c[:3])
        )
        length, total = mpmath.mpf(s.period), [mpmath.mpf(0)] * len(x)
        for j in range(len(s.x)):
            step = knots[j] - knots[j - 1] if j else knots[-1] - knots[-2]
            turn = first[j - 1] - first[j] + step * (2 * second[j - 1] + 3 * step * third[j - 1])
            bend = 2 * (second[j - 1] - second[j]) + 6 * third[j - 1] * step
            for i, place in enumerate(x):
                angle = 2 * mpmath.pi * (mpmath.mpf(place) - knots[j]) / length
                total[i] += (
                    6
                    * (third[j - 1] - third[j])
                    * length**2
                    / (4 * mpmath.pi**3)
                    * mpmath.clcos(3, angle)
                )
                total[i] -= bend * length / (2 * mpmath.pi**2) * mpmath.clsin(2, angle)
                total[i] += (
                    turn / mpmath.pi * mpmath.log(abs(2 * mpmath.sin(angle / 2))) if angle else 0
                )
        return np.array([float(value) for value in total])


def test_the_conjugate_is_known_with_a_period_only() -> None:
    x = np.arange(8.0)
    assert Sampled(x, np.cos(x)).slope_conjugate([0.5]) is None


def test_declared_jumps_of_the_third_derivative_are_those_of_the_height() -> None:
    rng = np.random.default_rng(2)
    for period in (None, 1.05):
        assert (
            "jumps"
            in check_profile(
                Sampled(np.linspace(0, 1, 15), rng.standard_normal(15), period)
            ).checked
        )


@pytest.mark.parametrize(
    ("x", "height", "period", "field"),
    [
        ([], [], None, "x"),
        ([0, 1, 2], [0, 1, 0], None, "x"),
        ([0, 1, 1, 2], [0, 1, 0, 1], None, "x"),
        ([0, 2, 1, 3], [0, 1, 0, 1], None, "x"),
        ([0, 1, np.nan, 3], [0, 1, 0, 1], None, "x"),
        ([[0, 1, 2, 3]], [0, 1, 0, 1], None, "x"),
        (["a", "b", "c", "d"], [0, 1, 0, 1], None, "x"),
        (None, [0, 1, 0, 1], None, "x"),
        ([0, 1, 2, 3], [0, 1, 0], None, "height"),
        ([0, 1, 2, 3], [0, 1, 0, 1, 1], None, "height"),
        ([0, 1, 2, 3], [0, 1, np.inf, 1], None, "height"),
        ([0, 1, 2, 3], [0, 1, 1j, 1], None, "height"),
        ([0, 1, 2, 3], [True, False, True, False], None, "height"),
        ([0, 1, 2, 3], np.ma.array([0, 1, 2, 3], mask=[0, 1, 0, 0]), None, "height"),
        ([0, 1, 2, 3], [0, 1, np.ma.masked, 3], None, "height"),
        ([0, 1, 2, 3], [2, 2, 2, 2], None, "height"),
        ([0, 1, 2, 3], [0, 1, 0, 1], 2.9, "period"),
        ([0, 1, 2, 3], [0, 1, 2, 0], 3.0, "x"),
    ],
)
def test_bad_points_are_refused_by_name(x, height, period, field) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(SceneError) as caught:
        Sampled(x, height, period)
    assert caught.value.field == field


def test_the_points_are_copied_and_cannot_be_changed() -> None:
    x, h = np.arange(5.0), np.array([0, 1, 0, 2, 0.0])
    s = Sampled(x, h)
    h[1] = 9
    assert s.heights[1] == 1
    with pytest.raises(ValueError, match="read-only"):
        s.heights[0] = 1


def test_interpolation_is_loaded_by_the_first_spline_only() -> None:
    code = (
        "import sys; from contact import Sampled, Sinusoid\n"
        "s = Sampled([0, 1, 2, 3], [0, 1, 0, 1]); Sinusoid(1.0, 1.0).height(0.3)\n"
        "assert 'scipy.interpolate' not in sys.modules\n"
        "s.height(0.5); assert 'scipy.interpolate' in sys.modules\n"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True).returncode == 0
