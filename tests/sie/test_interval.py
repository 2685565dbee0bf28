"""Basis functions of one interval. Their closed forms off the interval keep all digits beside an
end and far away, in each way in which points are given.
"""

import mpmath
import numpy as np
import pytest

from sie.basis.interval import (
    InPlane,
    OnLine,
    Outside,
    decay_rate,
    mean_potential,
    of_t,
    own_potential,
    theta,
    transform_of,
    values_on,
)

EXCESS = 10.0 ** np.arange(-30, 31, 3)
SIGN = np.where(np.arange(len(EXCESS)) % 2, -1.0, 1.0)


def exact(what):
    def at(sign, excess):
        with mpmath.workdps(80):
            z = mpmath.mpf(sign) * (1 + mpmath.mpf(excess))
            root = sign * mpmath.sqrt(z * z - 1)
            return float({"root": root, "rho": z - root, "log": -mpmath.log(abs(z - root))}[what])

    return np.array([at(sign, e) for sign, e in zip(SIGN, EXCESS, strict=True)])


def test_rho_its_root_and_its_logarithm_are_right_to_rounding_at_any_distance_from_an_end():
    seen = Outside(SIGN, EXCESS)
    for what in ("root", "rho", "log"):
        assert getattr(seen, what) == pytest.approx(exact(what), rel=1e-15, abs=0)
    assert decay_rate(EXCESS) == pytest.approx(exact("log"), rel=1e-15, abs=0)


def test_points_on_the_line_are_the_same_by_both_ends_and_as_complex_numbers():
    near, far = -EXCESS, 2 + EXCESS
    left, right = np.where(SIGN > 0, far, near), np.where(SIGN > 0, near, far)
    outside, line = Outside(SIGN, EXCESS), OnLine.of(left, right)
    plane = InPlane.of(left, -right, np.zeros(len(left)))
    assert not line.any_on
    for seen in (line, plane):
        assert np.abs(seen.rho / outside.rho - 1).max() < 4e-15
        assert np.abs(seen.root / outside.root - 1).max() < 4e-15
        assert np.abs(seen.first(3.0).real - outside.first(3.0)).max() < 1e-13


def test_powers_together_one_by_one_and_summed_are_the_same():
    seen, w = Outside(SIGN, EXCESS + 1e-3), np.linspace(1, 2, len(SIGN))
    c, row = np.random.default_rng(1).standard_normal((1, 7)), np.zeros(len(SIGN), dtype=int)
    for potential, table in ((False, seen.transforms(7)), (True, seen.potentials(7, w / 5))):
        terms = np.array(
            [term for _, term in zip(range(7), seen.one_by_one(potential, w / 5), strict=False)]
        )
        assert terms.T == pytest.approx(table, rel=1e-13, abs=1e-300)
        summed = of_t(c, seen, w, 5.0, row, "potential" if potential else "transform")
        assert summed == pytest.approx((table @ c[0]) * (w if potential else 1.0), rel=1e-12)


def test_the_potential_is_continuous_at_the_ends_and_has_its_mean():
    divided = np.array([[0.7, -0.3, 0.2]])
    t = np.cos((np.arange(64) + 0.5) * np.pi / 64)
    on = own_potential(divided, np.zeros(64, dtype=int), 1 + t, 1 - t, np.full(64, 2 / 3))
    assert 2 * on.mean() == pytest.approx(0.7 * mean_potential(2.0, 3.0), rel=1e-13)
    ends = own_potential(
        divided,
        np.zeros(2, dtype=int),
        np.array([0.0, 2.0]),
        np.array([2.0, 0.0]),
        np.full(2, 2 / 3),
    )
    beside = Outside(np.array([-1.0, 1.0]), np.full(2, 1e-30))
    off = of_t(
        divided * [1, 1, 2], beside, np.full(2, 2.0), 3.0, np.zeros(2, dtype=int), "potential"
    )
    assert off == pytest.approx(2 * ends, rel=1e-14)
    assert theta(np.array([2.0]), np.array([0.0]))[0] == 0.0


def test_a_density_that_vanishes_at_an_end_has_no_singular_field_beside_it():
    seen, row = Outside(1.0, np.array([1e-30])), np.zeros(1, dtype=int)
    u = np.array([[0.5, -0.25]])
    assert transform_of(np.zeros(1), np.zeros(1), u, seen, row) == pytest.approx([0.25])
    assert transform_of(np.ones(1), -np.ones(1), u, seen, row) == pytest.approx(
        [1.25], rel=1e-14
    )  # (1 - rho) / R is 1 there
    assert transform_of(np.ones(1), np.zeros(1), u, seen, row)[0] > 1e14
    plane = InPlane.of(np.full(1, 2.0), np.full(1, 1e-30), np.zeros(1))
    assert transform_of(np.ones(1), -np.ones(1), u, plane, row) == pytest.approx([1.25], rel=1e-14)
    nowhere = np.zeros(1, dtype=bool), np.zeros(1, dtype=bool)
    beside = np.array([2.0]), np.array([1e-30])
    assert values_on((np.ones(1), -np.ones(1), 0 * u), row, *beside, nowhere) == pytest.approx(
        [np.sqrt(0.5e-30)], rel=1e-14
    )
