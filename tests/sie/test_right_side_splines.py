"""Hundreds of jumps of the right side's second derivative, replaced by one spline.

The density of the spline agrees with those of the single jumps, and has a smaller round-off.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import BSpline

import sie
import sie.jumps.spline as spline_module
from sie.basis.interval import OnLine, by_angle
from sie.jumps.right_side import ForcingJumps
from sie.jumps.spline import OPTIONS


def both(after: int = 10, seed: int = 5) -> tuple[ForcingJumps, ForcingJumps, sie.Zones]:
    """The jumps of a quadratic spline one by one, the same jumps replaced by a spline, and the
    zone. About `after` knots lie to the right of the zone.
    """
    rng, n = np.random.default_rng(seed), OPTIONS.min_jumps + 40 + after
    at = np.arange(n) + rng.uniform(-0.4, 0.4, n)
    spline = BSpline(at, rng.normal(size=n - 3), 2)
    bends = spline.derivative(2)(0.5 * (at[1:] + at[:-1]))
    at, jumps, orders = at[3:-3], np.diff(bends)[2:-2], np.full(n - 6, 2)
    zones = sie.Zones.of([[at[10] - 0.3, at[-after] + 0.2]])
    return (
        ForcingJumps.within(zones, at, jumps, orders, None),
        ForcingJumps.within(zones, at, jumps, orders, None, spline),
        zones,
    )


def test_a_spline_replaces_second_derivative_jumps_of_any_right_side() -> None:
    """The right side need not be a spline: it may have other jumps, or be a wave. A spline with
    the same second-derivative jumps then replaces them.

    The densities with and without the spline differ by a sin(theta) + b sin(2 theta), because
    the smooth right sides that they leave differ by a quadratic.
    """
    rng = np.random.default_rng(2)
    at, zones = np.sort(rng.uniform(-1, 1, OPTIONS.min_jumps + 9)), sie.Zones.of([[-1.0, 1.0]])
    jumps, orders = rng.standard_normal(len(at)) * len(at) ** 2, np.full(len(at), 2)
    orders[::200] = 0
    jumps[::200] = 1.0
    one, other = (ForcingJumps.within(zones, at, jumps, orders, None, g) for g in (None, np.sin))
    assert not one.splines and len(other.zone) == np.count_nonzero(orders == 0) + 1
    theta = rng.uniform(0, np.pi, 60)
    left, right = 2 * np.cos(theta / 2) ** 2, 2 * np.sin(theta / 2) ** 2
    differ = one.density(0, left, right) - other.density(0, left, right)
    waves = np.column_stack((np.sin(theta), np.sin(2 * theta)))
    rest = differ - waves @ np.linalg.lstsq(waves, differ, rcond=None)[0]
    assert np.abs(rest).max() < 1e-11 * np.abs(one.height).sum()


@pytest.mark.parametrize("after", [2, 300])
def test_a_spline_leaves_one_jump_and_a_parabola(after: int) -> None:
    """The densities with and without the spline differ by a sin(theta) + b sin(2 theta), because
    the smooth right sides that they leave differ by a quadratic.

    So transforms, coefficients, edge slopes and mean offsets differ by the closed forms of these
    two terms.
    """
    one, other, zones = both(after)
    assert len(one.zone) > OPTIONS.min_jumps and len(other.zone) == 1
    assert one.count[0] + 1 == other.count[0]  # one more: the jump that the spline adds
    theta = np.concatenate(
        (np.random.default_rng(1).uniform(0, np.pi, 60), [1e-9, 1e-4, np.pi - 1e-4])
    )
    left, right = 2 * np.cos(theta / 2) ** 2, 2 * np.sin(theta / 2) ** 2
    differ = one.density(0, left, right) - other.density(0, left, right)
    slope = by_angle(
        lambda near, far: one.density(0, near, far) - other.density(0, near, far), theta
    )[1]
    a, b = np.linalg.lstsq(np.column_stack((np.sin(theta), np.sin(2 * theta))), differ, rcond=None)[
        0
    ]
    z = np.array([1.00001, 1.02, 1.5, 4.0, 40.0, -1.00001, -1.003, -2.0, -9.0])
    rho = z - np.sign(z) * np.sqrt(z**2 - 1)
    zone, seen, off = (
        np.zeros(len(left), dtype=int),
        OnLine.of(1 + z, 1 - z),
        np.zeros(len(z), dtype=int),
    )
    count = 600
    known = np.zeros(count)
    known[:4] = 0.5 * np.array([a, b, -a, -b])
    pairs = [
        (differ, a * np.sin(theta) + b * np.sin(2 * theta)),
        (
            one.own_transform(zone, left) - other.own_transform(zone, left),
            a * np.cos(theta) + b * np.cos(2 * theta),
        ),
        (one.transform(off, seen) - other.transform(off, seen), a * rho + b * rho**2),
        ((one.t_coefficients(zones, count) - other.t_coefficients(zones, count))[0], known),
        (
            np.ravel(one.edge_slopes(zones)) - np.ravel(other.edge_slopes(zones)),
            np.array([a - 2 * b, a + 2 * b]),
        ),
        (one.mean_offsets(zones) - other.mean_offsets(zones), np.array([-a / 4])),
        (slope, a * np.cos(theta) + 2 * b * np.cos(2 * theta)),
    ]
    for number, (first, second) in enumerate(pairs):
        # The slope (pair number 6) is a difference quotient. It is inaccurate next to jumps of
        # the second derivative.
        assert first == pytest.approx(
            second, abs=(1e-3 if number == 6 else 1e-10) * float(np.abs(one.height).max()) / 100
        )
    assert other.rounding(1)[0] < 0.1 * one.rounding(1)[0]


def test_off_the_zone_a_series_replaces_the_nodes(monkeypatch) -> None:
    """Far from the zone, a series replaces the sum over nodes without loss of digits. The
    distances from the zone are 1e-8 to 1e4 half widths, on both sides.
    """
    spline, rng = both()[1].splines[0], np.random.default_rng(3)
    away, side = 10.0 ** rng.uniform(-8, 4, 200), rng.choice([-1.0, 1.0], 200)
    z, rho = side * (1 + away), side / (1 + away + np.sqrt(away * (away + 2)))
    found = spline.transform_off(z, rho), spline.potential(1 + z, 1 - z, rho)
    monkeypatch.setattr(spline_module, "FAR", replace(spline_module.FAR, far_rho=(0.0, 0.0, 0.0)))
    wanted = spline.transform_off(z, rho), spline.potential(1 + z, 1 - z, rho)
    assert found[0] == pytest.approx(wanted[0], rel=1e-11)
    assert found[1] == pytest.approx(wanted[1], rel=1e-13)


def test_potential_of_the_spline_is_the_primitive_of_its_transform() -> None:
    _, jumps, _ = both()
    spline = jumps.splines[0]
    t, places = np.polynomial.legendre.leggauss(20)[0], np.array([1.05, 3.0, -1.2, -7.0])
    weights = np.polynomial.legendre.leggauss(20)[1]
    rho = places - np.sign(places) * np.sqrt(places**2 - 1)
    ends = 1.1 * places
    z = 0.5 * (places + ends)[:, None] + 0.5 * (ends - places)[:, None] * t
    slopes = spline.transform_off(z.ravel(), (z - np.sign(z) * np.sqrt(z**2 - 1)).ravel()).reshape(
        z.shape
    )
    rise = 0.5 * (ends - places) * (slopes @ weights)
    rho_ends = ends - np.sign(ends) * np.sqrt(ends**2 - 1)
    found = spline.potential(1 + ends, 1 - ends, rho_ends) - spline.potential(
        1 + places, 1 - places, rho
    )
    assert found == pytest.approx(rise, rel=1e-8)
    # The potential is continuous at both ends of the zone. On the zone its derivative is the
    # transform, that is g minus its mean.
    beside = np.array([-1e-12, 1e-12, 2 - 1e-12, 2 + 1e-12])
    on = spline.potential(beside, 2 - beside, np.array([-1.0, -1.0, 1.0, 1.0]))
    assert on[::3] == pytest.approx(on[1:3], abs=1e-4 * spline.size)
    x = np.linspace(0.3, 0.3002, 5)
    value = spline.potential(x, 2 - x, x)
    middle = spline.own_transform(0.5 * (x[1:] + x[:-1]))
    assert np.diff(value) / np.diff(x) == pytest.approx(middle, abs=1e-3 * spline.size)
