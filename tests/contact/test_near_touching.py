"""Zones that almost touch: right ends and pressure, at a cost that does not depend on the gap."""

import numpy as np
import pytest

import contact
from contact.reference.inverse import design
from tests.tiers import quick

T = np.array([-0.9999, -0.99, -0.9, -0.5, 0.1, 0.77, 0.99, 0.9999])
GAPS = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)


def errors(solution, designed):
    """(Error of the pressure over its peak, largest error of the ends over the zone's width)."""
    width = np.diff(designed.zones, axis=1)
    pressure = (
        max(
            np.abs(solution.pressure_at(T, k) - designed.pressure_at(T, k)).max()
            for k in range(len(width))
        )
        / designed.max_pressure
    )
    return pressure, float((np.abs(solution.zones - designed.zones) / width).max())


def solve(designed, period, **options):
    interaction = contact.Isolated() if period is None else contact.Periodic()
    return contact.solve(
        contact.Scene(designed.profile, 1.0, interaction, load=designed.load), **options
    )


@pytest.mark.parametrize("period", [None, 1.0], ids=["isolated", "periodic"])
@pytest.mark.parametrize("gap", quick(GAPS, [1e-2, 1e-4, 1e-6]))
class TestTwoZones:
    def test_are_found_within_the_stated_error(self, gap, period):
        designed = design([[-0.2, -0.03], [-0.03 + 0.17 * gap, 0.15]], 1.0, 0.01, period)
        solution = solve(designed, period, tol=1e-8)
        assert len(solution.zones) == 2 and solution.certificate.holds
        pressure, ends = errors(solution, designed)
        assert max(pressure, ends) <= solution.error <= 1e-8

    def test_symmetric_zones_are_found_within_the_stated_error(self, gap, period):
        designed = design([[-0.2, -0.1 * gap], [0.1 * gap, 0.2]], 1.0, 0.01, period)
        solution = solve(designed, period, tol=1e-8)
        pressure, ends = errors(solution, designed)
        assert max(pressure, ends) <= solution.error <= 1e-8

    def test_the_gap_between_them_is_that_of_the_design(self, gap, period):
        designed = design([[-0.2, -0.03], [-0.03 + 0.17 * gap, 0.15]], 1.0, 0.01, period)
        solution = solve(designed, period, tol=1e-8)
        a, b = solution.zones[0, 1], solution.zones[1, 0]
        x = a + (b - a) * np.array([0.2, 0.5, 0.8])
        # At worst the ends have an error of 1e-16/gap of a zone's width. Relative to the gap
        # between the zones this error is 1e-16/gap^2.
        relative = max(1e-6, 1e-14 / gap**2)
        assert solution.gap(x) == pytest.approx(designed.gap(x), rel=relative)


@pytest.mark.parametrize("period", [None, 1.0], ids=["isolated", "periodic"])
def test_cost_is_that_of_wide_gaps(period):
    counts = []
    for gap in GAPS:
        designed = design([[-0.2, -0.03], [-0.03 + 0.17 * gap, 0.15]], 1.0, 0.01, period)
        counts.append(solve(designed, period, tol=1e-8).plan.counts["coupled_unknowns"])
    assert max(counts) < 64


def test_several_narrow_gaps_beside_wide_ones():
    table = [[-0.4, -0.25], [-0.2, -0.1], [-0.0999, 0.02], [0.0201, 0.1], [0.10005, 0.25]]
    designed = design(table, 1.0, 0.01, 1.0)
    solution = solve(designed, 1.0, tol=1e-6)
    assert len(solution.zones) == 5
    pressure, ends = errors(solution, designed)
    assert pressure < 1e-8 and max(pressure, ends) <= solution.error


def test_an_island_between_two_narrow_gaps():
    table = [[-0.3, -0.02], [-0.019, 0.001], [0.002, 0.25]]
    designed = design(table, 1.0, 0.01, 1.0)
    solution = solve(designed, 1.0, tol=1e-6)
    assert len(solution.zones) == 3
    pressure, ends = errors(solution, designed)
    assert pressure < 1e-9 and max(pressure, ends) <= solution.error


def test_the_stiffness_is_continuous_where_two_zones_merge():
    """The stiffness is continuous at the load at which two zones merge.

    Just below and above this load, it also equals the difference quotient of load and approach.
    """
    texture = contact.Biquadratic(radius=1e-3, spacing=4e-5, period=1e-4)
    merging = [
        e
        for e in contact.path(
            contact.Scene(texture, 1e11, contact.Periodic(), load=1.0), [1e2, 1e5]
        ).events
    ]
    load = next(event.load for event in merging if event.kind == "merge")
    below = contact.solve(
        contact.Scene(texture, 1e11, contact.Periodic(), load=load * (1 - 1e-7)), tol=1e-9
    )
    above = contact.solve(
        contact.Scene(texture, 1e11, contact.Periodic(), load=load * (1 + 1e-7)), tol=1e-9
    )
    assert len(below.zones) == 2 and len(above.zones) == 1
    rate = (above.load - below.load) / (above.approach - below.approach)
    assert rate == pytest.approx(below.stiffness, rel=1e-6)
    assert above.stiffness == pytest.approx(below.stiffness, rel=1e-6)


def test_a_gap_below_round_off_is_found_or_undecided():
    """A gap of 3e-8 of a zone's width is below the resolution of round-off.

    If it were closed, the pressure there would be negative by only 1e-16 of the peak.
    """
    designed = design([[-0.2, -0.03], [-0.03 + 0.17 * 3e-8, 0.15]], 1.0, 0.01, 1.0)
    solution = solve(designed, 1.0, tol=1e-8)
    assert len(solution.zones) == 2 or solution.certificate.undecided
    x = np.linspace(-0.19, 0.14, 30)
    assert np.abs(solution.pressure(x) - designed.pressure(x)).max() < 1e-8 * designed.max_pressure


def test_the_plan_tells_of_slits():
    near = design([[-0.2, -0.03], [-0.0299, 0.15]], 1.0, 0.01, 1.0)
    apart = design([[-0.2, -0.03], [0.03, 0.15]], 1.0, 0.01, 1.0)
    with_slits, without = (solve(one, 1.0, tol=1e-8).plan["slits"] for one in (near, apart))
    assert with_slits.used and with_slits.detail == "1 slit, 1 wide zone"
    assert not without.used
