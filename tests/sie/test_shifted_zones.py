"""Systems of equations for two densities, solved as one equation on shifted zones.

The zones of the second density are shifted along the line. Between zones of different densities,
the pole of the kernel has no meaning. So the smooth part of the kernel subtracts the pole, and
adds the coupling of the densities (docs/engine.md, "Several densities").
"""

import numpy as np
import pytest

import sie

SHIFT = 8.0


def coupled(own, other):
    """The smooth part of a kernel: `own` between zones of the same density, and `other` between
    zones of different densities, where the pole is subtracted.
    """

    def value(x, xi):
        lag = x - xi
        apart = np.abs(lag) > SHIFT / 2
        between = other(lag - SHIFT * np.sign(lag)) - 1 / np.where(apart, lag, 1.0)
        return np.where(apart, between, own(lag))

    return sie.Smooth(value, of_lag=True)


def lifts(height, own=np.zeros_like):
    """Circulations of two plates of chord one, at a unit incidence, one above the other."""
    kernel = sie.cauchy() + coupled(own, lambda lag: lag / (lag**2 + height**2))
    plates = sie.Zones.of([[-0.5, 0.5], [SHIFT - 0.5, SHIFT + 0.5]], sie.SINGULAR, sie.BOUNDED)
    found = sie.solve(sie.Equation(kernel, np.ones_like), plates)
    assert found.error < 1e-10
    return found.density.totals


@pytest.mark.parametrize("height", [0.3, 1.0, 20.0])
def test_a_biplane_lifts_what_discrete_vortices_say(height):
    """The circulations agree with those of discrete vortices, extrapolated to infinitely many
    panels.

    The vortices are at the quarter points of panels, and no flow passes the three-quarter points
    (R. M. James, Comput. Methods Appl. Mech. Eng. 1, 1972, 59). The error is of the second order
    in the length of the panels.
    """

    def by_vortices(count):
        lag = (np.arange(count)[:, None] - np.arange(count) + 0.5) / count
        velocities = (1 / lag + lag / (lag**2 + height**2)) / np.pi
        return np.linalg.solve(velocities, np.ones(count)).sum()

    few, some, many = (by_vortices(count) for count in (80, 160, 320))
    better = (4 * some - few) / 3, (4 * many - some) / 3
    exact = (16 * better[1] - better[0]) / 15
    assert lifts(height) == pytest.approx([exact, exact], rel=1e-9)


def test_far_apart_each_plate_lifts_as_if_alone():
    assert lifts(1e6) == pytest.approx([np.pi / 2, np.pi / 2], rel=1e-11)
    assert np.all(np.abs(lifts(5.0) / (np.pi / 2) - 1) > 1e-3)


def test_two_densities_on_one_place_are_the_sum_and_the_difference_of_two_alone():
    """The system T phi_1 + c G phi_2 = 1, T phi_2 + c G phi_1 = 0, where G has the kernel
    sin(x - xi). So phi_1 +- phi_2 solves (T +- c G) phi = 1.
    """
    part = 0.4
    kernel = sie.cauchy() + coupled(np.zeros_like, lambda lag: part * np.sin(lag))
    ends = [[-1.0, 0.5], [SHIFT - 1.0, SHIFT + 0.5]]
    both = sie.Equation(kernel, lambda x: 1.0 * (x < SHIFT / 2), sie.ZoneTotals(0.0))
    density = sie.solve(both, sie.Zones.of(ends, sie.SINGULAR, sie.SINGULAR)).density
    x = np.array([-0.9, 0.1, 0.45])
    for sign in (1.0, -1.0):
        smooth = sie.Smooth(lambda x, xi, sign=sign: sign * part * np.sin(x - xi), of_lag=True)
        alone = sie.Equation(sie.cauchy() + smooth, np.ones_like, sie.Total(0.0))
        one = sie.solve(alone, sie.Zones.of(ends[:1], sie.SINGULAR, sie.SINGULAR)).density
        assert density(x) + sign * density(SHIFT + x) == pytest.approx(one(x), rel=1e-10, abs=1e-12)
