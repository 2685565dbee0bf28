"""Jumps in many zones, evaluated at points of all zones at once, give the same as zone by zone."""

import numpy as np
import pytest

import sie
from sie.basis.interval import OnLine
from sie.jumps.density import DensityJumps
from sie.jumps.right_side import ForcingJumps


def drawn(orders, of_density=False):
    """(random generator, zones, jumps): random jumps of the given orders in 200 zones. Some zones
    have no jump; zones 7 and 60 have so many that their series are longer.
    """
    rng = np.random.default_rng(3)
    edges = np.sort(rng.random(400)).reshape(-1, 2)
    at = np.concatenate(
        [
            rng.random(900),
            *(rng.uniform(*edges[zone], count) for zone, count in ((7, 27), (60, 50))),
        ]
    )
    zones = sie.Zones.of(edges)
    height, order = rng.normal(size=len(at)), rng.choice(orders, len(at))
    if of_density:
        return rng, zones, DensityJumps.inside(zones, at, height, order, sie.cauchy())
    return rng, zones, ForcingJumps.within(zones, at, height, order, None)


def alone(jumps, zone):
    """The jumps of one zone."""
    return jumps.chosen(jumps.zone == zone)


def points(rng, on):
    """(zones, points relative to them), on the zones if `on`, else off them. Some zones have no
    jumps.
    """
    zone = np.concatenate((rng.integers(0, 200, 500), np.repeat([7, 60], 100)))
    left = (
        rng.uniform(0, 2, 700)
        if on
        else np.where(rng.random(700) < 0.5, -1, 1) * 10.0 ** rng.uniform(-6, 3, 700)
    )
    left = left if on else np.where(left > 0, 2 + left, left)
    return zone, OnLine.of(left, 2 - left)


def one_by_one(zone, of):
    out = np.empty(len(zone))
    for i in np.unique(zone):
        here = np.flatnonzero(zone == i)
        out[here] = of(int(i), here)
    return out


@pytest.mark.parametrize("orders", [(2,), (0, 1, 2)])
class TestJumpsOfTheRightSide:
    def test_density_and_smooth_part_are_those_of_each_zone_alone(self, orders):
        rng, _, jumps = drawn(orders)
        zone, seen = points(rng, on=True)
        wanted = one_by_one(
            zone,
            lambda i, here: alone(jumps, i).density(zone[here], seen.left[here], seen.right[here]),
        )
        np.testing.assert_allclose(
            jumps.density(zone, seen.left, seen.right),
            wanted,
            rtol=1e-12,
            atol=1e-14 * np.abs(wanted).max(),
        )
        wanted = one_by_one(
            zone, lambda i, here: alone(jumps, i).smooth_part(zone[here], seen.left[here])
        )
        np.testing.assert_allclose(
            jumps.smooth_part(zone, seen.left),
            wanted,
            rtol=1e-12,
            atol=1e-14 * np.abs(wanted).max(),
        )

    @pytest.mark.parametrize("on", [True, False])
    def test_transform_and_potential_are_those_of_each_zone_alone(self, orders, on):
        rng, _, jumps = drawn(orders)
        zone, seen = points(rng, on)
        for of in ("transform", "sharp_potential"):
            wanted = one_by_one(
                zone, lambda i, here, of=of: getattr(alone(jumps, i), of)(zone[here], seen[here])
            )
            np.testing.assert_allclose(
                getattr(jumps, of)(zone, seen),
                wanted,
                rtol=1e-10,
                atol=1e-14 * np.abs(wanted).max(),
            )

    def test_series_off_the_zone_agree_with_closed_forms(self, orders):
        _, _, jumps = drawn(orders)
        for zone, reach in ((7, 0.6), (60, 0.87)):
            rho = np.array([-1.0, 1.0]) * (reach - 1e-9)
            z = 0.5 * (rho + 1 / rho)
            k = jumps.by_zone[zone]
            for of in ("transform", "sharp_potential"):
                by_series = getattr(jumps, of)(np.full(2, zone), OnLine.of(1 + z, 1 - z))
                if of == "transform":
                    closed = jumps.off_zone(k, z[:, None], rho[:, None]) @ (jumps.height[k] / np.pi)
                else:
                    closed = jumps.potential_off(
                        k, 1 + z[:, None], 1 - z[:, None], rho[:, None]
                    ) @ (jumps.height[k] / np.pi)
                np.testing.assert_allclose(
                    by_series, closed, rtol=0, atol=1e-12 * np.abs(jumps.height[k]).sum()
                )


@pytest.mark.parametrize("orders", [(1, 2), (0, 2)])
@pytest.mark.parametrize("on", [True, False])
def test_jumps_of_the_density_give_the_same_as_zone_by_zone(orders, on):
    rng, zones, jumps = drawn(orders, of_density=True)
    # The logarithms that jumps cause in neighbouring zones are left out here.
    jumps = DensityJumps(jumps.zone, jumps.left, jumps.right, jumps.height, jumps.order)
    zone, seen = points(rng, on)
    wanted = one_by_one(zone, lambda i, here: alone(jumps, i).transform(zone[here], seen[here]))
    np.testing.assert_allclose(
        jumps.transform(zone, seen), wanted, rtol=1e-10, atol=1e-13 * np.abs(wanted).max()
    )
    wanted = one_by_one(
        zone, lambda i, here: alone(jumps, i).sharp_potential(zone[here], seen[here])
    )
    np.testing.assert_allclose(
        jumps.sharp_potential(zone, seen), wanted, rtol=1e-10, atol=1e-13 * np.abs(wanted).max()
    )
    if on:
        wanted = one_by_one(
            zone,
            lambda i, here: alone(jumps, i).density(zone[here], seen.left[here], seen.right[here]),
        )
        np.testing.assert_allclose(
            jumps.density(zone, seen.left, seen.right),
            wanted,
            rtol=1e-10,
            atol=1e-13 * np.abs(wanted).max(),
        )
