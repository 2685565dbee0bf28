"""Laws that every profile obeys, and reference values of each kind of profile."""

from __future__ import annotations

import pickle
from dataclasses import dataclass

import numpy as np
import pytest

import contact
from contact import (
    Biquadratic,
    Combined,
    Flat,
    Fourier,
    Parabola,
    Polynomial,
    Power,
    Profile,
    Sampled,
    SceneError,
    Sinusoid,
    Wedge,
)
from contact.testing import check_profile

L = 2.5e-4
_random = np.random.default_rng(7)
_heights = _random.standard_normal(40) * 1e-7
_uneven = np.sort(_random.uniform(0, 1e-4, 40))
_decay = np.arange(1.0, 31.0) ** -1.8

PROFILES: list[Profile] = [
    Sinusoid(1e-6, L),
    Wedge(0.1),
    Wedge(0.1, L),
    Parabola(1e-2),
    Parabola(1e-2, L),
    Power(0.1, 1.5),
    Power(0.1, 1.5, L),
    Power(20.0, 2.7, L),
    Biquadratic(1e-2, 1e-4),
    Biquadratic(1e-2, 1e-4, L),
    Flat(1e-4),
    Flat(1e-4, L),
    Polynomial([0, 0, 3.0, 0.5, 8.0]),
    Polynomial([1, 0, 3.0, 0, 8.0], 2.0),
    Polynomial([0, -1.0, 1.0, 1.0], 2.0),
    Fourier(L, [1e-6, 2e-7], [1e-7]),
    Fourier(
        L, 1e-6 * _decay * _random.standard_normal(30), 1e-6 * _decay * _random.standard_normal(30)
    ),
    Sampled(_uneven, _heights),
    Sampled(_uneven, _heights, 1.02e-4),
    Sampled(1e-3 + 2.5e-6 * np.arange(40), _heights, 1e-4),
    Combined(Sinusoid(1e-6, L), Fourier(L / 3, [1e-7], [2e-7]), 3e-5),
    Combined(Wedge(0.1, L), Biquadratic(1e-2, 1e-4, 1.5 * L), 3e-5, mirrored=True),
    Combined(Sampled(_uneven, _heights, 1.02e-4), Wedge(0.01, 0.51e-4), 1e-5),
    Combined(
        Sampled(_uneven, _heights), Sampled(_uneven, _heights[::-1], 1.02e-4), 1e-5, mirrored=True
    ),
    Combined(Wedge(0.1), Parabola(1e-2)),
    Combined(Power(0.1, 1.5, L), Power(0.02, 2.5, L / 2), 3e-5, mirrored=True),
    Combined(Flat(1e-4), Wedge(0.02, L / 7), 1e-5),
    Combined(Sinusoid(1e-7, L / 2), Flat(1e-4, L), 1e-5),
]
PERIODIC = [p for p in PROFILES if p.period is not None]
CONJUGATE = [p for p in PERIODIC if p.slope_conjugate(np.array([0.1 * L])) is not None]


def name_of(profile: Profile) -> str:
    return f"{profile.name}{'-periodic' if profile.period else ''}"


@pytest.mark.parametrize("profile", PROFILES, ids=name_of)
def test_every_profile_passes_check_profile(profile: Profile) -> None:
    assert check_profile(profile).ok


@pytest.mark.parametrize("profile", PERIODIC, ids=name_of)
def test_wrap_moves_into_the_cell_and_leaves_the_cell_alone(profile: Profile) -> None:
    assert profile.period is not None
    lo, hi = profile.x0, profile.x0 + profile.period
    inside = np.random.default_rng(0).uniform(lo, hi, 200)
    edges = np.array(
        [
            lo,
            np.nextafter(lo, -np.inf),
            np.nextafter(hi, lo),
            hi,
            lo + 1e3 * profile.period,
            -1e-300,
        ]
    )
    wrapped = profile.wrap(edges)
    assert np.array_equal(profile.wrap(inside), inside)
    assert np.all((wrapped >= lo) & (wrapped < hi))


@pytest.mark.parametrize("profile", PERIODIC, ids=name_of)
def test_the_slope_integrates_to_zero_over_a_period(profile: Profile) -> None:
    assert profile.period is not None
    # The panels of Gauss's rule halve in length towards algebraic points.
    beside = profile.period * np.outer([1.0, -1.0], 0.5 ** np.arange(1, 50)).ravel()
    beside = profile.wrap((profile.algebraic_points[:, :1] + beside).ravel())
    cuts = np.unique(
        np.concatenate((profile.breakpoints, [profile.x0, profile.x0 + profile.period], beside))
    )
    t, w = np.polynomial.legendre.leggauss(96)
    half = np.diff(cuts)[:, None] / 2
    values = profile.slope(cuts[:-1, None] + half * (1 + t)) * w * half
    assert abs(values.sum()) <= 1e-13 * np.abs(values).sum() + 1e-300


@pytest.mark.parametrize("profile", CONJUGATE, ids=name_of)
def test_the_conjugate_rotates_the_fourier_coefficients_of_the_slope(profile: Profile) -> None:
    # Only low wave numbers are compared, with a coarse tolerance: at kinks the conjugate has
    # logarithmic poles.
    assert profile.period is not None
    n = 1 << 15
    x = profile.x0 + profile.period * (np.arange(n) + 0.37) / n
    transform = np.fft.rfft(profile.slope_conjugate(x))
    slope = np.fft.rfft(profile.slope(x))
    k = slice(1, 40)
    # The conjugate of cos is sin: a factor -i for positive wave numbers.
    assert np.max(np.abs(transform[k] + 1j * slope[k])) <= 1e-3 * np.max(np.abs(slope))


@pytest.mark.parametrize("profile", PROFILES, ids=name_of)
def test_profiles_are_values_equal_hashable_and_picklable(profile: Profile) -> None:
    again = type(profile)(**profile.parameters())
    assert again == profile and hash(again) == hash(profile)
    assert pickle.loads(pickle.dumps(profile)) == profile
    for worked_out in (profile.height, profile.slope, profile.slope_conjugate):
        worked_out(np.zeros(1))
    assert len(pickle.dumps(profile)) == len(pickle.dumps(again))  # cached values are not pickled
    assert profile != Sinusoid(2.0, 3.0)
    with pytest.raises(AttributeError):
        profile.period = 1.0  # type: ignore[misc]


@pytest.mark.parametrize("profile", PROFILES, ids=name_of)
def test_the_name_in_the_registry_makes_the_same_profile(profile: Profile) -> None:
    for body in profile.bodies.values():
        assert contact.profile(body.name, **body.parameters()) == body


def test_sinusoid_has_amplitude_above_and_below_its_mean() -> None:
    s = Sinusoid(1e-6, L)
    assert np.allclose(s.height([0, L / 4, L / 2]), [0, 1e-6, 2e-6], rtol=1e-15)
    assert s.slope(L / 4) == pytest.approx(2 * np.pi * 1e-6 / L, rel=1e-15)
    assert s.slope_conjugate(0.0) == pytest.approx(-2 * np.pi * 1e-6 / L, rel=1e-15)


def test_sinusoid_keeps_its_digits_near_the_tip() -> None:
    x = 1e-9 * L
    assert Sinusoid(1e-6, L).height(x) == pytest.approx(2e-6 * (np.pi * 1e-9) ** 2, rel=1e-14)


def test_biquadratic_is_the_printed_polynomial_with_unit_curvature_at_its_tips() -> None:
    b = Biquadratic(radius=2.0, spacing=0.6)
    c, x = 0.3, np.linspace(-1, 1, 9)
    assert np.allclose(b.height(x), x**4 / (16 * c**2) - x**2 / 8 + c**2 / 16, rtol=0, atol=1e-16)
    h = 1e-4
    assert (b.slope(c + h) - b.slope(c - h)) / (2 * h) == pytest.approx(1 / 2.0, rel=1e-6)
    assert np.array_equal(b.slope(b.summits), [0, 0])


def test_wedge_and_parabola_declare_the_kink_of_tip_and_valley() -> None:
    assert np.array_equal(Wedge(0.1).kinks, [[0, 0.2]])
    assert np.array_equal(Wedge(0.1, 4.0).kinks, [[-2, -0.2], [0, 0.2]])
    assert np.array_equal(Parabola(2.0, 4.0).kinks, [[-2, -2]])
    assert Parabola(2.0).kinks.shape == (0, 2)


def test_wedge_conjugate_is_the_log_tangent() -> None:
    w = Wedge(0.1, 4.0)
    assert w.slope_conjugate(1.0) == pytest.approx(0, abs=1e-16)
    assert w.slope_conjugate(0.5) == pytest.approx(
        0.2 / np.pi * np.log(np.tan(np.pi / 8)), rel=1e-14
    )
    assert w.slope_conjugate(0.0) == -np.inf


def test_flat_ends_at_its_corners() -> None:
    f = Flat(2.0, 5.0)
    assert np.array_equal(f.height([0, 1, 1.001, -1, 4, 5, 3.99]), [0, 0, np.inf, 0, 0, 0, np.inf])
    assert f.support == (-1, 1)


def test_a_polynomial_cell_may_have_a_kink_but_no_step_at_its_border() -> None:
    p = Polynomial([0, -1.0, 1.0, 1.0], 2.0)  # f(1) = f(-1) = 1, f'(1) = 4, f'(-1) = 0
    assert np.allclose(p.kinks, [[-1, -4]], rtol=1e-15)
    with pytest.raises(SceneError, match="heights at both ends of the period agree"):
        Polynomial([0, 1.0, 1.0], 2.0)


def test_fourier_of_many_harmonics_equals_the_sum_written_out() -> None:
    rng = np.random.default_rng(3)
    a, b = rng.standard_normal(2000), rng.standard_normal(1700)
    x = rng.uniform(-1, 2, 37)
    f = Fourier(1.5, a, b)
    phase = 2 * np.pi * np.outer(x / 1.5, np.arange(1, 2001))
    b = np.append(b, np.zeros(300))
    k = 2 * np.pi / 1.5 * np.arange(1, 2001)
    # The phase of k turns has a round-off of about k eps. The sum is at worst wrong by 2000 eps
    # sum|a|; errors of random signs add up to about 2000 eps sqrt(2000).
    tolerance = 2000 * np.finfo(float).eps * np.sqrt(2000) * 10
    assert np.max(np.abs(f.height(x) - np.cos(phase) @ a - np.sin(phase) @ b)) < tolerance
    expected = np.cos(phase) @ (a * k) + np.sin(phase) @ (b * k)
    assert np.max(np.abs(f.slope_conjugate(x) - expected)) < tolerance * k[-1]


def test_fourier_of_one_cosine_is_the_sinusoid_and_another_amplitude_is_not() -> None:
    x = np.linspace(0, L, 50)
    s, f = Sinusoid(1e-6, L), Fourier(L, [-1e-6])
    assert np.allclose(f.height(x) + 1e-6, s.height(x), rtol=0, atol=1e-20)
    assert not np.allclose(
        Fourier(L, [-1.0000001e-6]).height(x) + 1e-6, s.height(x), rtol=0, atol=1e-20
    )


def test_fourier_works_in_blocks_of_bounded_memory_without_changing_values() -> None:
    f = Fourier(1.0, _decay, _decay)
    x = np.random.default_rng(5).uniform(-1, 1, 400_000)
    assert np.allclose(f.height(x)[::9973], f.height(x[::9973]), rtol=0, atol=1e-14)


@pytest.mark.parametrize(
    "bad", [True, "1", None, 1j, [1.0], np.array([1.0]), np.nan, np.inf, -np.inf, 0, -1, 10**400]
)
@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda v: Sinusoid(v, 1.0), "amplitude"),
        (lambda v: Sinusoid(1.0, v), "period"),
        (lambda v: Wedge(v), "slope"),
        (lambda v: Wedge(1.0, v), "period"),
        (lambda v: Power(v, 1.5), "coefficient"),
        (lambda v: Power(1.0, v), "exponent"),
        (lambda v: Power(1.0, 1.5, v), "period"),
        (lambda v: Parabola(v), "radius"),
        (lambda v: Parabola(1.0, v), "period"),
        (lambda v: Biquadratic(v, 1.0), "radius"),
        (lambda v: Biquadratic(1.0, v), "spacing"),
        (lambda v: Flat(v), "width"),
        (lambda v: Fourier(v, [1.0]), "period"),
        (lambda v: Polynomial([0, 0, 1.0], v), "period"),
        (lambda v: Sampled([0, 1, 2, 3], [0, 1, 0, 1], v), "period"),
    ],
)
def test_bad_numbers_are_refused_by_name(make, field, bad) -> None:  # type: ignore[no-untyped-def]
    optional = field == "period" and not isinstance(make(9.0), Sinusoid | Fourier)
    if bad is None and optional:
        assert make(None).period is None
        return
    with pytest.raises(SceneError) as caught:
        make(bad)
    assert caught.value.field == field and field in str(caught.value)


@pytest.mark.parametrize(
    "bad",
    [
        [],
        None,
        "abc",
        [np.nan],
        [1, np.inf],
        [[1.0, 2.0]],
        [1, "a"],
        [1j, 2],
        [True, False],
        3.0,
        [[1], [1, 2]],
        [0.0, 0.0],
    ],
)
def test_bad_coefficients_are_refused_by_name(bad) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(SceneError, match="coefficients"):
        Polynomial(bad)
    with pytest.raises(SceneError, match="cosine"):
        Fourier(1.0, bad)


def test_cells_too_small_for_their_shape_are_refused() -> None:
    with pytest.raises(SceneError, match="period"):
        Flat(1.0, 1.0)
    with pytest.raises(SceneError, match="period"):
        Biquadratic(1.0, 1.0, 0.9)


@dataclass(frozen=True)
class Cosh(Profile):
    """f = scale (cosh(x/scale) - 1): an analytic height, without a method for the slope."""

    scale: float

    def height(self, x):  # type: ignore[no-untyped-def]
        return self.scale * (np.cosh(np.asarray(x) / self.scale) - 1)


@dataclass(frozen=True)
class Cubed(Profile):
    """f = factor |x|^3: because of the modulus, the complex step fails."""

    period: float
    factor: float

    def height(self, x):  # type: ignore[no-untyped-def]
        return self.factor * np.abs(self.wrap(x)) ** 3


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e3])
def test_a_derived_slope_is_exact_where_the_height_is_analytic(scale: float) -> None:
    p = Cosh(scale)
    x = scale * np.linspace(-2, 2, 41)
    assert p.slope_is_derived and not Sinusoid(1.0, 1.0).slope_is_derived
    # The only error is the round-off of cosh: the complex step itself has no error.
    assert np.allclose(p.slope(x), np.sinh(x / scale), rtol=1e-14, atol=1e-15)


@dataclass(frozen=True)
class Hyperbola(Profile):
    """f = sqrt(1 + x^2) - 1, which is defined for real x only."""

    def height(self, x):  # type: ignore[no-untyped-def]
        return np.sqrt(1 + np.asarray(x, dtype=float) ** 2) - 1


@pytest.mark.parametrize("window", [1.0, 1e-2, 1e-4, 1e-6])
def test_a_derived_slope_is_right_in_a_small_window_although_the_height_hides_its_round_off(
    window: float,
) -> None:
    # Near x = 0 the round-off of sqrt(1 + x^2) - 1 is far larger than the small height
    # suggests. Steps chosen by the size of the height would be too short.
    x = window * (1e-3 + np.cos(np.pi * (np.arange(1024) + 0.5) / 1024))
    derived = Hyperbola().slope(x)
    assert np.abs(derived - x / np.sqrt(1 + x**2)).max() < 1e-12


def test_a_derived_slope_uses_differences_where_the_complex_step_fails() -> None:
    p = Cubed(2e-4, 1e3)
    x = np.linspace(-0.9e-4, 0.9e-4, 40)
    expected = 3e3 * x * np.abs(x)
    # The error of sixth-order differences is the round-off of f over the step: about
    # 1e-16/0.05, and more near the tip.
    assert np.allclose(p.slope(x), expected, rtol=0, atol=1e-10 * np.max(expected))


def test_a_required_period_field_stays_required() -> None:
    with pytest.raises(TypeError):
        Cubed(factor=1.0)  # type: ignore[call-arg]
