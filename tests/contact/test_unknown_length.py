"""Users' profiles that declare no smallest length. The package finds from their heights how
finely to sample them.
"""

import numpy as np
import pytest

import contact
from contact.model.profiles.derive import detail_of
from tests.tiers import diagonal, quick

PERIODIC = contact.Periodic()


class Rippled(contact.Profile):
    """A wave with ripples. It declares no smallest length."""

    period, x0 = 1.0, -0.5

    def __init__(self, count, height):
        self.count, self.ripple = count, height

    def height(self, x):
        turn = 2 * np.pi * np.asarray(x)
        return -1e-3 * np.cos(turn) - self.ripple * np.cos(self.count * turn + 0.7)

    @property
    def told(self):
        """The same shape as a Fourier series, whose waves are declared."""
        waves = np.zeros(self.count, dtype=complex)
        waves[0], waves[-1] = -1e-3, waves[-1] - self.ripple * np.exp(-0.7j)
        return contact.Fourier(1.0, waves.real, waves.imag)


class Bowl(contact.Profile):
    """A parabola with ripples, for isolated contact. Its lowest point is far from x = 0."""

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
def test_undeclared_ripples_give_the_solution_of_the_fourier_series(ripples, control):
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
def test_the_approach_is_measured_from_the_lowest_ripple(load):
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


def test_the_detected_length_is_that_of_the_shortest_wave_not_neglected():
    for count in (20, 100, 1000):
        assert detail_of(Rippled(count, 1e-3 / count).height, -0.5, 0.5) * count == pytest.approx(
            1.0, rel=0.3
        )
    # If corners are not declared, the length is a fraction, at least 1/10, of their distance
    # 1/50.
    rng = np.random.default_rng(1)
    at, heights = np.linspace(-0.5, 0.5, 51), rng.normal(size=51)
    assert 1 / 500 < detail_of(lambda x: np.interp(x, at, heights), -0.5, 0.5) < 1 / 50


def test_ripples_of_less_than_a_hundred_thousandth_of_the_slope_are_left_out():
    assert detail_of(Rippled(1000, 1e-12).height, -0.5, 0.5) == 1 / 16


class Tilting(contact.Profile):
    """Waves whose height accepts real positions only. So the slope comes from differences of
    heights, which contain round-off.
    """

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
    # About a thousand positions with some hundred heights each are enough. If they were needed
    # again for each load on the way, or for waves that are only noise, they would be many
    # millions.
    assert own.asked < 1_000_000


class Bumps(contact.Profile):
    """Five equal bumps on a level plane without end."""

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


def test_an_endless_level_body_is_refused_under_loads_at_which_it_would_touch_far_away():
    """Far from the load, the displacement of a half-plane grows without limit. So an endless
    level body touches it there.
    """
    light = contact.solve(contact.Scene(Bumps(), 1e11, contact.Isolated(), load=100.0))
    assert len(light.zones) == 5
    heavy = contact.Scene(Bumps(), 1e11, contact.Isolated(), load=2e4)
    with pytest.raises(contact.OutOfRange, match=r"levels off.*extent"):
        contact.solve(heavy)
    solved = contact.solve(contact.Scene(BumpsWithAnEnd(), 1e11, contact.Isolated(), load=2e4))
    assert len(solved.zones) == 5 and solved.certificate.holds
