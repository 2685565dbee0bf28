"""Rough traces with many zones, wide and narrow: splines with many knots in contact."""

from pathlib import Path

import numpy as np
import pytest

import contact
from contact.formulation.tables import parted_at_wide
from contact.search.strategies.gaps import GapOptions

STYLUS = Path(__file__).parents[2] / "examples" / "data" / "stylus-profile.csv"
T = np.cos(np.pi * (np.arange(8) + 0.5) / 8)


def trace(points=400, seed=7):
    """A periodic self-affine trace with about three points per shortest wavelength."""
    k = np.arange(2, points // 3)
    rng = np.random.default_rng(seed)
    phase, x = rng.uniform(0, 2 * np.pi, len(k)), np.arange(points + 1) / points
    return contact.Sampled(
        x, np.sin(2 * np.pi * x[:, None] * k + phase) @ (0.01 * k**-1.3), period=1.0
    )


def smallest_full(profile):
    """The smallest mean pressure of full contact, for E* = 1."""
    return contact.solve(
        contact.Scene(profile, 1.0, contact.Periodic(), contact_fraction=1.0)
    ).mean_pressure


def differences(one, other):
    """(Largest difference of ends over the zone's width, of pressures over the peak pressure).

    The pressures are compared at equal scaled positions in the zones.
    """
    ends = np.abs((one.zones - other.zones) / np.diff(other.zones, axis=1)).max()
    pressures = max(
        np.abs(one.pressure_at(T, i) - other.pressure_at(T, i)).max() for i in range(len(one.zones))
    )
    return ends, pressures / other.max_pressure


def test_zones_and_gaps_of_a_trace_are_the_same_contact(monkeypatch):
    """Two formulations have only the spline in common, and must give the same contact.

    One solves for the pressure on the zones, the other for the slope of the gap between them.
    """
    profile = trace()
    load = 0.25 * smallest_full(profile)
    scene = contact.Scene(profile, 1.0, contact.Periodic(), mean_pressure=load)
    found = []
    for nearly_full in (0.999, 0.01):
        monkeypatch.setattr(
            "contact.search.strategies.gaps.OPTIONS", GapOptions(wide_contact=nearly_full)
        )
        found.append(contact.solve(scene))
    zones, gaps = found
    assert (
        "gaps are the unknowns" in gaps.plan["zone ends"].reason
        and "gaps" not in zones.plan["zone ends"].reason
    )
    assert (
        len(zones.zones) == len(gaps.zones) and zones.certificate.holds and gaps.certificate.holds
    )
    assert np.diff(zones.zones, axis=1).max() > 40 * profile.resolution  # a zone with many knots
    bound = zones.error + gaps.error
    assert bound < 2e-8 and max(differences(zones, gaps)) <= bound


@pytest.mark.slow
def test_hundreds_of_zones_many_narrower_than_a_step_and_one_wider_than_three_hundred_steps():
    """The stylus trace at a hundredth of the load of full contact.

    The narrow zone next to the widest one needs its level with all digits.
    """
    profile = contact.Sampled.from_file(
        STYLUS, units="um", detrend="quadratic", regrid=True, taper=0.05, period=True
    )
    load = 0.01 * smallest_full(profile)
    solution = contact.solve(
        contact.Scene(profile, 1.0, contact.Periodic(), mean_pressure=load), tol=1e-8
    )
    widths = np.diff(solution.zones, axis=1)[:, 0] / profile.resolution
    assert len(widths) > 600 and (widths < 1).sum() > 90 and widths.max() > 300
    assert solution.certificate.holds and solution.error <= 1e-8
    assert len(solution.trace) <= 8  # in further steps only round-off would move the ends


@pytest.mark.parametrize("first", range(5))
def test_the_border_of_the_period_lies_in_a_wide_gap(first):
    """The levels of neighbouring zones are equated one pair after the other, from border to border.

    The round-off of all pairs adds up between the last zone and the first one. So these two must
    not be close to each other.
    """
    rows = np.array([[-0.4, -0.39], [-0.38, -0.2], [-0.19, -0.1], [0.25, 0.3], [0.35, 0.4]])
    table = np.concatenate((rows[first:], rows[:first] + 1.0))
    begun = parted_at_wide(table, 1.0)
    gaps = np.append(begun[1:, 0], begun[0, 0] + 1.0) - begun[:, 1]
    assert (
        gaps[-1] >= 0.1 * gaps.max()
        and np.all(np.diff(begun.ravel()) > 0)
        and np.abs(begun).max() <= 1.4
    )
    assert np.sort(np.mod(begun.ravel(), 1.0)) == pytest.approx(
        np.sort(np.mod(rows.ravel(), 1.0)), abs=1e-15
    )


@pytest.mark.slow
def test_a_load_at_which_a_narrow_zone_stands_at_the_border_of_the_period_is_solved_like_any_other():
    profile = contact.Sampled.from_file(
        STYLUS, units="um", detrend="quadratic", regrid=True, taper=0.05, period=True
    )
    load = 1e-6 * (0.5e6) ** (130 / 199) * smallest_full(profile)
    solution = contact.solve(
        contact.Scene(profile, 1.0, contact.Periodic(), mean_pressure=load), tol=1e-8
    )
    assert solution.certificate.holds and solution.error <= 1e-8 and len(solution.zones) == 334
