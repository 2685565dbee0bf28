"""Measured traces pressed until hundreds of their zones, wide and narrow, touch: splines with many
knots in contact.
"""

from pathlib import Path

import numpy as np
import pytest

import contact
from contact.formulation.tables import parted_at_wide
from contact.search.strategies.gaps import GapOptions

STYLUS = Path(__file__).parents[2] / "examples" / "data" / "stylus-profile.csv"
T = np.cos(np.pi * (np.arange(8) + 0.5) / 8)


def trace(points=400, seed=7):
    """A self-affine trace of a period, sampled at about three points to its shortest wave."""
    k = np.arange(2, points // 3)
    rng = np.random.default_rng(seed)
    phase, x = rng.uniform(0, 2 * np.pi, len(k)), np.arange(points + 1) / points
    return contact.Sampled(
        x, np.sin(2 * np.pi * x[:, None] * k + phase) @ (0.01 * k**-1.3), period=1.0
    )


def smallest_full(profile):
    """The smallest mean pressure of full contact, E* = 1."""
    return contact.solve(
        contact.Scene(profile, 1.0, contact.Periodic(), contact_fraction=1.0)
    ).mean_pressure


def differences(one, other):
    """(of ends over their zone's width, of pressures at equal places over the peak)."""
    ends = np.abs((one.zones - other.zones) / np.diff(other.zones, axis=1)).max()
    pressures = max(
        np.abs(one.pressure_at(T, i) - other.pressure_at(T, i)).max() for i in range(len(one.zones))
    )
    return ends, pressures / other.max_pressure


def test_zones_and_gaps_of_a_trace_are_the_same_contact(monkeypatch):
    """Two formulations with nothing in common but the spline: pressure on the zones, slope of the
    gap between them.
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
        "gaps are solved for" in gaps.plan["zone ends"].reason
        and "gaps" not in zones.plan["zone ends"].reason
    )
    assert (
        len(zones.zones) == len(gaps.zones) and zones.certificate.holds and gaps.certificate.holds
    )
    assert np.diff(zones.zones, axis=1).max() > 40 * profile.resolution  # many knots in one zone
    bound = zones.error + gaps.error
    assert bound < 2e-8 and max(differences(zones, gaps)) <= bound


@pytest.mark.slow
def test_hundreds_of_zones_narrower_than_a_step_beside_one_three_hundred_steps_wide():
    """The stylus trace at a hundredth of its full load: the narrow zone beside the wide one asks
    for every digit of its level.
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
    assert len(solution.trace) <= 8  # nothing but rounding would keep the ends moving


@pytest.mark.parametrize("first", range(5))
def test_the_border_of_the_period_lies_in_a_wide_gap(first):
    """Levels are tied from neighbour to neighbour: a border between zones close to each other would
    sum the rounding of all steps.
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
