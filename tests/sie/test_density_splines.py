"""A density with very many jumps. A spline replaces the sum over single jumps: the density is the
same, but few jumps remain, and its round-off is smaller.
"""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.interpolate import BSpline

import sie
from sie.basis.interval import OnLine
from sie.jumps.density import DensityJumps
from sie.jumps.spline import OPTIONS

Array = NDArray[np.float64]
KERNEL = sie.cauchy()


def both(
    seed: int = 5, more: float = 0.0, bent: int = 0
) -> tuple[DensityJumps, DensityJumps, sie.Zones]:
    """(single jumps of a quadratic spline, the same with a spline in their place, the zone).

    more: amplitude of a wave added to the spline; bent: number of further jumps, of orders from 0.
    """
    rng, n = np.random.default_rng(seed), OPTIONS.min_density_jumps + 40
    at = np.arange(n) + rng.uniform(-0.4, 0.4, n)
    spline = BSpline(at, rng.normal(size=n - 3), 2)
    bends = spline.derivative(2)(0.5 * (at[1:] + at[:-1]))
    at, jumps, orders = at[3:-3], np.diff(bends)[2:-2], np.full(n - 6, 2)
    zones = sie.Zones.of([[at[10] - 0.3, at[-10] + 0.2]])
    at, jumps = (
        np.append(at, zones.middle + rng.uniform(-9, 9, bent)),
        np.append(jumps, np.ones(bent)),
    )
    orders = np.append(orders, np.arange(bent))

    def slope(x: Array) -> Array:
        return np.asarray(spline(x) + more * np.sin(0.05 * x))

    return (
        DensityJumps.inside(zones, at, jumps, orders, KERNEL),
        DensityJumps.inside(zones, at, jumps, orders, KERNEL, slope),
        zones,
    )


@pytest.mark.parametrize(("more", "bent"), [(0.0, 0), (3.0, 0), (0.0, 2), (3.0, 1)])
def test_a_spline_in_place_of_many_jumps_leaves_six_and_is_the_same_density(
    more: float, bent: int
) -> None:
    one, other, zones = both(more=more, bent=bent)
    assert len(one.zone) > OPTIONS.min_density_jumps and len(other.zone) <= 6 + bent
    assert sorted(other.places(0)[1].tolist()) == sorted(one.order.tolist())
    assert one.count.tolist() == other.count.tolist()
    left = np.sort(np.random.default_rng(1).uniform(0, 2, 60))
    right, outside = 2 - left, np.array([1.0001, 1.02, 1.5, 4.0, 40.0, -1.003, -2.0, -9.0])
    zone, seen, off = (
        np.zeros(60, dtype=int),
        OnLine.of(1 + outside, 1 - outside),
        np.zeros(8, dtype=int),
    )
    pairs = [
        (one.density(0, left, right), other.density(0, left, right)),
        (one.own_transform(zone, left), other.own_transform(zone, left)),
        (one.transform(off, seen), other.transform(off, seen)),
        (one.integral(zone, left, right), other.integral(zone, left, right)),
        (one.t_coefficients(zones, 40), other.t_coefficients(zones, 40)),
        (np.array(one.edge_slopes(zones)), np.array(other.edge_slopes(zones))),
    ]
    for first, second in pairs:
        assert first == pytest.approx(second, rel=1e-9, abs=1e-9 * float(np.abs(first).max()))
    assert other.rounding(1)[0] < 0.1 * one.rounding(1)[0]


def test_a_spline_in_the_density_has_no_potential() -> None:
    spline = both()[1].splines[0]
    theta = np.linspace(0.3, 2.8, 50)
    with pytest.raises(ValueError, match="potentials"):
        spline.mean_offset  # noqa: B018
    with pytest.raises(ValueError, match="no closed form"):
        spline.potential(theta, theta, theta)
