"""Shapes of one's own that do not say over which length they vary: they are looked at as closely as
their heights ask for.
"""

import numpy as np
import pytest

import contact
from contact.model.profiles.derive import detail_of
from tests.tiers import diagonal, quick

PERIODIC = contact.Periodic()


class Rippled(contact.Profile):
    """A wave with ripples, and nothing said of them."""

    period, x0 = 1.0, -0.5

    def __init__(self, count, height):
        self.count, self.ripple = count, height

    def height(self, x):
        turn = 2 * np.pi * np.asarray(x)
        return -1e-3 * np.cos(turn) - self.ripple * np.cos(self.count * turn + 0.7)

    @property
    def told(self):
        """The same, which says all."""
        waves = np.zeros(self.count, dtype=complex)
        waves[0], waves[-1] = -1e-3, waves[-1] - self.ripple * np.exp(-0.7j)
        return contact.Fourier(1.0, waves.real, waves.imag)


class Bowl(contact.Profile):
    """A parabola alone with ripples, its lowest point far from x = 0."""

    def height(self, x):
        x = np.asarray(x)
        return 2e-3 * (x + 0.1) ** 2 + 5e-4 * np.cos(60 * x)


@pytest.mark.parametrize(
    ("ripples", "control"),
    diagonal(
        [(128, 8e-6), (300, 6e-6)],
        [{"mean_pressure": 1e-3}, {"mean_pressure": 5e-3}, {"contact_fraction": 1.0}],
    ),
)
def test_ripples_are_found_as_of_a_shape_that_names_them(ripples, control):
    own, told = Rippled(*ripples), Rippled(*ripples).told
    found, known = (
        contact.solve(contact.Scene(profile, 1.0, PERIODIC, **control), tol=1e-8)
        for profile in (own, told)
    )
    assert len(found.zones) == len(known.zones)
    assert found.load == pytest.approx(known.load, rel=1e-9) and found.approach == pytest.approx(
        known.approach, rel=1e-9
    )


@pytest.mark.parametrize("load", quick([0.01, 0.9], [0.01]))
def test_an_approach_counts_from_the_lowest_ripple(load):
    loaded = contact.solve(
        contact.Scene(Bowl(), 1.0, contact.Isolated(datum=11.0), load=load), tol=1e-8
    )
    x = np.linspace(-0.2, 0.05, 1_000_001)
    middle = float(loaded.zones.mean(axis=1)[0])
    level = float(loaded.displacement(middle) + Bowl().height(middle))
    assert loaded.approach == pytest.approx(level - Bowl().height(x).min(), abs=1e-12)
    again = contact.solve(
        contact.Scene(Bowl(), 1.0, contact.Isolated(datum=11.0), approach=loaded.approach), tol=1e-8
    )
    assert again.load == pytest.approx(load, rel=1e-8)


def test_the_length_is_that_of_the_shortest_wave_that_counts():
    for count in (20, 100, 1000):
        assert detail_of(Rippled(count, 1e-3 / count).height, -0.5, 0.5) * count == pytest.approx(
            1.0, rel=0.3
        )
    # Of corners that nobody has declared a few times their distance.
    rng = np.random.default_rng(1)
    at, heights = np.linspace(-0.5, 0.5, 51), rng.normal(size=51)
    assert 1 / 500 < detail_of(lambda x: np.interp(x, at, heights), -0.5, 0.5) < 1 / 50


def test_ripples_of_less_than_a_hundred_thousandth_of_the_slope_are_left_out():
    assert detail_of(Rippled(1000, 1e-12).height, -0.5, 0.5) == 1 / 16


class Tilting(contact.Profile):
    """Two waves, of real places only: the slope is told by differences, and they are noisy."""

    period, x0 = 1.0, -0.5

    def __init__(self):
        self.asked = 0

    def height(self, x):
        turn = 2 * np.pi * np.asarray(x, dtype=float)
        self.asked += turn.size
        return 1e-3 * np.sin(turn / 2) ** 2 * (1 + 0.65 * np.cos(3 * turn + 3.0))


@pytest.mark.parametrize("fraction", [0.9, 0.99])
def test_noise_of_differences_is_not_taken_for_waves(fraction):
    own, turned = Tilting(), 0.65e-3 * np.exp(-3.0j)
    waves = np.array([-0.5e-3, 0, 0, 0], dtype=complex)
    waves[2] += turned / 2
    waves[1] -= turned / 4
    waves[3] -= turned / 4
    told = contact.Fourier(1.0, waves.real, waves.imag)
    found, known = (
        contact.solve(contact.Scene(p, 1.0, PERIODIC, contact_fraction=fraction), tol=1e-8)
        for p in (own, told)
    )
    assert found.load == pytest.approx(known.load, rel=1e-9) and found.zones == pytest.approx(
        known.zones, abs=1e-8
    )
    # Some hundred heights a place of a thousand: as many again for each load on the way, or for
    # waves of no body, are many millions.
    assert own.asked < 1_000_000


class Bumps(contact.Profile):
    """Five equal bumps on a level plane that has no end."""

    tips = 1e-3 * np.arange(-2, 3)

    def height(self, x):
        return -1e-6 * np.exp(-0.5 * self._from_tips(x) ** 2).sum(axis=-1)

    def slope(self, x):
        u = self._from_tips(x)
        return 1e-2 * (u * np.exp(-0.5 * u**2)).sum(axis=-1)

    def _from_tips(self, x):
        return (np.asarray(x)[..., None] - self.tips) / 1e-4


class BumpsWithAnEnd(Bumps):
    extent = (-1e-2, 1e-2)


def test_a_level_body_names_where_it_would_meet_the_other_again():
    """The displacement of a half-plane grows without limit, so a level body meets the other."""
    light = contact.solve(contact.Scene(Bumps(), 1e11, contact.Isolated(), load=100.0))
    assert len(light.zones) == 5
    heavy = contact.Scene(Bumps(), 1e11, contact.Isolated(), load=2e4)
    with pytest.raises(contact.OutOfRange, match=r"levels off.*extent"):
        contact.solve(heavy)
    solved = contact.solve(contact.Scene(BumpsWithAnEnd(), 1e11, contact.Isolated(), load=2e4))
    assert len(solved.zones) == 5 and solved.certificate.holds
