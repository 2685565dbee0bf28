"""What series leave out, and what rounding has in them, stated up to the ends, where high
coefficients count the most.
"""

import numpy as np
import pytest

import sie
from sie.slits.system import solve_zones

BESIDE = np.geomspace(1e-4, 0.01, 60)
THETA = np.concatenate((BESIDE, np.linspace(0.0101, np.pi - 0.0101, 600), np.pi - BESIDE[::-1]))


def off(state, exact):
    """Largest difference of two densities but for what is singular at an end, and moves it."""
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
def test_what_short_series_leave_out_is_stated(gap, pole):
    """Nodes fold it back onto the coefficients that are kept; with a slit between the zones, and
    without.
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
def test_noise_of_the_right_side_is_stated_and_is_no_more_than_the_waves_let_in(noise, wave):
    """If all n coefficients were noise, 1/sqrt(1 - t^2) would magnify it by n^1.5 near an end. But
    the coefficients beyond the waves are left out. The bound is tested for the median of several
    noises.
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
def test_what_is_left_out_beside_an_end_is_stated_though_points_far_from_it_hardly_show_it(
    pole, start
):
    """Coefficients that fall slowly add up where the pole is, and nowhere else; with a slit between
    the zones, and without.
    """
    forcing = sie.Forcing(lambda x: (1 / (x - pole)).real, lambda x: np.log(np.abs(x - pole)))
    problem = sie.Equation(sie.cauchy(), forcing, (sie.Total(1.0), sie.EqualPotential()))
    zones = sie.Zones.of([[-0.2, -0.03], [start, 0.25]])
    exact = solve_zones(problem, zones)
    for tolerance in (1e-7, 1e-8):
        state = solve_zones(problem, zones, tolerance)
        assert off(state, exact) < state.density_error * state.size
