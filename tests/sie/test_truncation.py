"""Truncation and round-off of series. The stated error includes both, up to the ends of zones,
where high coefficients matter most.
"""

import numpy as np
import pytest

import sie
from sie.slits.system import solve_zones

BESIDE = np.geomspace(1e-4, 0.01, 60)
THETA = np.concatenate((BESIDE, np.linspace(0.0101, np.pi - 0.0101, 600), np.pi - BESIDE[::-1]))


def off(state, exact):
    """The largest difference of two densities, without its parts that are singular at the ends.
    These parts are errors of the ends.
    """
    left, right = 2 * np.cos(THETA / 2) ** 2, 2 * np.sin(THETA / 2) ** 2
    pieces = range(len(state.density.zones))
    rest = np.array(
        [
            (state.density.at(k, left, right) - exact.density.at(k, left, right)) * np.sin(THETA)
            for k in pieces
        ]
    )
    rest -= 0.5 * ((rest[:, :1] + rest[:, -1:]) + (rest[:, :1] - rest[:, -1:]) * np.cos(THETA))
    return np.abs(rest / np.sin(THETA)).max()


@pytest.mark.parametrize("gap", [1e-3, 0.1])
@pytest.mark.parametrize("pole", [0.17, -0.1 + 0.01j, 0.06 + 0.004j, -0.05 + 0.03j])
def test_the_truncation_of_short_series_is_stated(gap, pole):
    """If the right side is sampled at few nodes, truncated coefficients are added to those that
    are kept (aliasing). Between the zones is a slit (gap 1e-3) or a wide gap (0.1).
    """
    forcing = sie.Forcing(lambda x: (1 / (x - pole)).real, lambda x: np.log(np.abs(x - pole)))
    problem = sie.Equation(sie.cauchy(), forcing, (sie.Total(1.0), sie.EqualPotential()))
    zones = sie.Zones.of([[-0.2, -0.03], [-0.03 + 0.17 * gap, 0.15]])
    exact = solve_zones(problem, zones)
    for tolerance in (1e-4, 1e-6, 1e-8):
        state = solve_zones(problem, zones, tolerance)
        assert off(state, exact) < state.density_error * state.size


@pytest.mark.parametrize("wave", [1.0, 30.0, 200.0])
@pytest.mark.parametrize("noise", [1e-6, 1e-9, 1e-12])
def test_noise_of_the_right_side_is_stated_and_hardly_magnified(noise, wave):
    """If all n coefficients were noise, 1/sqrt(1 - t^2) would magnify the noise by n^1.5 near an
    end. But coefficients beyond those of the wave are left out. The median of the errors for
    several noises is at most eight times the noise.
    """
    zones, total = sie.Zones.of([[-1.0, 1.0]]), (sie.Total(1.0),)

    def solved(noise, turns=1e9):
        forcing = sie.Forcing(
            lambda x: np.cos(wave * x) + noise * np.sin(turns * x * (1 + x)),
            lambda x: np.sin(wave * x) / wave,
        )
        return solve_zones(sie.Equation(sie.cauchy(), forcing, total), zones)

    exact, found = solved(0.0), []
    for turns in 1e9 + 12345.6 * np.arange(7):
        state = solved(noise, turns)
        found.append(off(state, exact))
        assert found[-1] < state.density_error * state.size
    assert np.median(found) < noise * 8


@pytest.mark.parametrize("start", [0.0315, -0.029237])
@pytest.mark.parametrize(
    "pole", [-0.2 + 6e-5j, -0.03 + 6e-5j, -0.2 + 2e-4j, -0.03 + 2e-4j, -0.2 + 8.3e-5j]
)
def test_truncation_near_an_end_is_stated_though_points_away_from_it_hardly_show_it(pole, start):
    """A pole of the right side is very close to an end of the first zone. So the coefficients
    fall slowly, and the truncated ones add up near the pole and nowhere else. Between the zones
    is a wide gap or a slit.
    """
    forcing = sie.Forcing(lambda x: (1 / (x - pole)).real, lambda x: np.log(np.abs(x - pole)))
    problem = sie.Equation(sie.cauchy(), forcing, (sie.Total(1.0), sie.EqualPotential()))
    zones = sie.Zones.of([[-0.2, -0.03], [start, 0.25]])
    exact = solve_zones(problem, zones)
    for tolerance in (1e-7, 1e-8):
        state = solve_zones(problem, zones, tolerance)
        assert off(state, exact) < state.density_error * state.size
