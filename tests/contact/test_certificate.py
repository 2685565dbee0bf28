"""The certificate fails if a zone is missing, or if one zone is given in place of two."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import contact
from contact.formulation import claims, tolerances
from contact.formulation.controls import Load
from contact.formulation.fields import ZoneFields
from contact.reference.inverse import design
from contact.search.topology.loop import NewtonSettings, refine_topology
from contact.search.topology.pressure_form import PressureForm
from contact.studies.bench.formulations import scaled
from contact.verify import minima
from contact.verify.certificate import certify

ZONES = [[-0.4, -0.15], [-0.05, 0.0], [0.1, 0.4]]
EXACT = design(ZONES, 1.0, 1e-3, 1.0)


def certificate_of(zones):
    """The certificate of these zones, and the units, after the search for the zone ends.

    At these ends the pressure is bounded. The search does not test signs of pressure and gap.
    """
    problem = scaled(contact.Scene(EXACT.profile, 1.0, contact.Periodic(), load=1e-3))
    load = 1e-3 / problem.units.load
    found = refine_topology(
        PressureForm(problem),
        Load(load),
        problem.units.scaled(np.array(zones)),
        NewtonSettings(1e-12),
        formal=True,
    )
    return certify(found.fields, load), problem.units


def test_the_right_zones_are_certified():
    certificate, _ = certificate_of(ZONES)
    assert certificate.holds and certificate.smallest_pressure > 0
    assert certificate.smallest_gap == 0  # each gap has a maximum, but no minimum between its ends
    assert len(certificate.overlaps) == 0 and len(certificate.negative) == 0


@pytest.mark.parametrize("pressure", [1e6, 3e6, 9e6])
@pytest.mark.parametrize("shape", [(1e-6, 0, 6e-7), (1e-6, 2e-7, 5e-7), (1e-6,), (1e-6, 0, 3e-7)])
@pytest.mark.parametrize("turn", [0.0, 0.13])
def test_the_smallest_gap_is_the_least_minimum_between_zones(shape, pressure, turn):
    angle = 2 * np.pi * turn * np.arange(1, len(shape) + 1)
    wave = contact.Fourier(1e-4, shape * np.cos(angle), shape * np.sin(angle))
    solution = contact.solve(contact.Scene(wave, 1e9, contact.Periodic(), mean_pressure=pressure))
    gap = solution.gap(np.linspace(0.0, 1e-4, 20001))
    low = (gap[1:-1] < gap[:-2]) & (gap[1:-1] < gap[2:]) & (gap[1:-1] > 0.0)
    least = gap[1:-1][low].min() if low.any() else 0.0
    # The parabolas through the samples of the certificate are accurate to some per cent.
    assert solution.certificate.smallest_gap == pytest.approx(least, rel=0.05)


def test_where_a_zone_is_missing_the_bodies_overlap():
    certificate, units = certificate_of([ZONES[0], ZONES[2]])
    assert (
        not certificate.holds and certificate.smallest_gap < 0 and certificate.smallest_pressure > 0
    )
    assert [lo < -0.025 < hi for lo, hi in units.x(certificate.overlaps)] == [True]


def test_the_pressure_is_negative_between_two_zones_that_are_taken_for_one():
    certificate, units = certificate_of([[-0.4, 0.0], [0.1, 0.4]])
    assert not certificate.holds and certificate.smallest_pressure < 0
    assert any(lo < -0.1 < hi for lo, hi in units.x(certificate.negative))


def test_a_contact_whose_gap_is_not_zero_on_its_zones_is_not_certified(monkeypatch):
    """The check of the profile finds the false slope; without it, the check of the gap finds it."""

    # The slope is not the derivative of the height. The pressure is positive everywhere, but it
    # is that of another body.
    class Bent(contact.Polynomial):
        def slope(self, x):
            return 1.001 * super().slope(x)

    scene = contact.Scene(Bent([0.0, 0.0, 1.0]), 1.0, contact.Isolated(), load=1e-3)
    with pytest.raises(contact.SceneError, match="slope disagrees with the height"):
        contact.solve(scene)
    monkeypatch.setattr(claims, "of", lambda *_: claims.Claims())
    with pytest.raises(
        contact.NotConverged, match="the height and the slope of the profile do not match"
    ):
        contact.solve(scene)


def test_each_of_many_gaps_is_sampled_near_its_ends_as_closely_as_one_of_few(monkeypatch):
    looked: list[np.ndarray] = []
    real = ZoneFields.formal_gap

    def recorded(self, x):
        looked.append(x)
        return real(self, x)

    waves = 40
    profile = contact.Fourier(1.0, [*np.zeros(waves - 1), -0.01 / waves])
    found = contact.solve(contact.Scene(profile, 1.0, contact.Periodic(), contact_fraction=0.5))
    fields = found.fields
    monkeypatch.setattr(ZoneFields, "formal_gap", recorded)
    certify(fields, fields.density.total)
    gaps, looks = fields.density.zones.b[:-1], np.sort(np.concatenate(looked))
    width = fields.density.zones.a[1:] - gaps
    assert len(gaps) == waves - 1
    # A second touch may begin within a hundredth of the gap's width from the end of the gap.
    within = np.searchsorted(looks, gaps + 0.01 * width) - np.searchsorted(
        looks, gaps, side="right"
    )
    assert within.min() >= 3


@pytest.mark.parametrize("depth", [0.0, 0.9, 1.0])
def test_the_zooms_at_a_kink_that_touches_zero_end(depth):
    """The second difference of samples around a kink is proportional to their spacing.

    So the zooms end at the latest when this difference is below the round-off.
    """
    rounding = np.array([1e-14])
    dips = minima.follow(
        lambda zone, angle: np.abs(angle - 1 / 3) - depth * 1e-14,
        np.zeros(1, dtype=int),
        np.array([0.0]),
        np.array([1.0]),
        np.ones(1),
        rounding,
    )
    assert dips.negative == []


@pytest.mark.parametrize(
    ("profile", "control"),
    [
        (contact.Sinusoid(1e-3, 1.0), {"half_width": 0.2}),  # closed form
        (EXACT.profile, {"load": 1e-3}),  # zones
        (EXACT.profile, {"contact_fraction": 0.99}),  # gaps
    ],
)
def test_one_function_gives_the_allowed_overlap_on_every_route(monkeypatch, profile, control):
    scene = contact.Scene(profile, 1.0, contact.Periodic(), **control)
    before = contact.solve(scene).certificate.gap_rounding
    known = tolerances.TOLERANCES
    wider = replace(known, height_rounding=1e-9)
    if "contact_fraction" in control:
        wider = replace(known, rounding=1e-9)
    monkeypatch.setattr(tolerances, "TOLERANCES", wider)
    assert contact.solve(scene).certificate.gap_rounding > 1e3 * before > 0
