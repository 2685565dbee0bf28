"""Jumps of many zones with few of them each, pair by pair."""

import numpy as np
import pytest

import sie
from sie.jumps.density import DensityJumps
from sie.jumps.forcing import ForcingJumps
from sie.jumps.formulas import MOST


def drawn(orders, of_density=False):
    """Jumps of these orders in 200 zones, some of them with none, some with more than are taken together."""
    rng = np.random.default_rng(3)
    edges = np.sort(rng.random(400)).reshape(-1, 2)
    at = np.sort(np.concatenate((rng.random(900), rng.uniform(edges[7, 0], edges[7, 1], 3 * MOST))))
    zones = sie.Zones.of(edges)
    height, order = rng.normal(size=len(at)), rng.choice(orders, len(at))
    if of_density:
        return rng, zones, DensityJumps.inside(zones, at, height, order, sie.cauchy())
    return rng, zones, ForcingJumps.within(zones, at, height, order, None)


def points(rng, jumps, on):
    """(zone, distances from its ends over its half width, rho) of points on zones or off them."""
    zone = rng.choice(np.flatnonzero(jumps.few.holds(np.arange(200))), 500)
    left = rng.uniform(0, 2, 500) if on else np.where(rng.random(500) < 0.5, -1, 1) * 10.0 ** rng.uniform(-6, 3, 500)
    left = left if on else np.where(left > 0, 2 + left, left)
    right = 2 - left
    rho = np.sign(left) / (0.5 * np.abs(left - right) + np.sqrt(np.abs(left * right)))
    return zone, left, right, np.where((left >= 0) & (right >= 0), 0.5, rho)


@pytest.mark.parametrize("orders", [(2,), (0, 1, 2)])
class TestFewJumps:
    def test_of_a_zone_with_many_are_not_among_them(self, orders):
        _, _, jumps = drawn(orders)
        held = jumps.few.holds(np.arange(200))
        assert held.sum() > 100 and not held[7] and not np.any(held[jumps.count == 0])

    def test_are_the_density_that_those_of_each_zone_are(self, orders):
        rng, _, jumps = drawn(orders)
        zone, left, right, _ = points(rng, jumps, on=True)
        wanted = [jumps.density(i, left[[n]], right[[n]])[0] for n, i in enumerate(zone.tolist())]
        np.testing.assert_allclose(jumps.few.density(zone, left, right), wanted, rtol=1e-12, atol=1e-14 * np.abs(wanted).max())

    def test_add_to_the_right_side_what_those_of_each_zone_do(self, orders):
        rng, _, jumps = drawn(orders)
        zone, left, _, _ = points(rng, jumps, on=True)
        wanted = [jumps.smooth_part(i, np.array([x]))[0] for i, x in zip(zone.tolist(), left, strict=True)]
        np.testing.assert_allclose(jumps.few.smooth_part(zone, left), wanted, rtol=1e-12, atol=1e-14 * np.abs(wanted).max())

    def test_are_seen_from_afar_as_those_of_each_zone_are(self, orders):
        rng, _, jumps = drawn(orders)
        zone, left, right, rho = points(rng, jumps, on=False)
        z = 0.5 * (left - right)
        wanted = [jumps.transform(i, z[[n]], rho[[n]])[0] for n, i in enumerate(zone.tolist())]
        np.testing.assert_allclose(jumps.few.transform(zone, z, rho), wanted, rtol=1e-10, atol=1e-14 * np.abs(wanted).max())

    @pytest.mark.parametrize("on", [True, False])
    def test_have_the_potentials_that_those_of_each_zone_have(self, orders, on):
        rng, _, jumps = drawn(orders)
        zone, left, right, rho = points(rng, jumps, on)
        wanted = [jumps.sharp_potential(i, left[[n]], right[[n]], rho[[n]])[0] for n, i in enumerate(zone.tolist())]
        np.testing.assert_allclose(jumps.few.potential(zone, left, right, rho), wanted, rtol=1e-10, atol=1e-14 * np.abs(wanted).max())


class TestFewJumpsOfTheDensity:
    def test_are_what_those_of_each_zone_are_on_it_and_off_it(self):
        rng, _, jumps = drawn((1, 2), of_density=True)
        zone, left, right, rho = points(rng, jumps, on=True)
        off, beyond, before, seen = points(rng, jumps, on=False)
        z = 0.5 * (beyond - before)
        each, there = list(enumerate(zone.tolist())), list(enumerate(off.tolist()))
        for found, wanted in (
            (jumps.few.density(zone, left, right), [jumps.density(i, left[[n]], right[[n]])[0] for n, i in each]),
            (jumps.few.smooth_part(zone, left), [jumps.smooth_part(i, left[[n]])[0] for n, i in each]),
            (jumps.few.transform(off, z, seen), [jumps.transform(i, z[[n]], seen[[n]])[0] for n, i in there]),
        ):
            np.testing.assert_allclose(found, wanted, rtol=1e-10, atol=1e-13 * np.abs(wanted).max())

    def test_are_none_where_the_density_itself_jumps(self):
        jumps = drawn((0, 2), of_density=True)[2]
        assert not jumps.few.holds(np.arange(200)).any()
