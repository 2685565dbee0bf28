"""Soft and rough surfaces snap into full contact by themselves. An early test on a grid foresees
it.
"""

import numpy as np
import pytest

import contact
from contact.adhesion import full_contact
from tests.tiers import diagonal, quick

E, WORK = 2.67e6, 0.05
LAWS = [contact.JKR(WORK), contact.Dugdale(WORK, 5e6), contact.Dugdale(WORK, 1e6)]
LOADS = [-1e4, 0.0, 1e4, 2e4, 1e5]


def rough(slope, shortest=1e-6, seed=1):
    return contact.self_affine(
        hurst=0.8, period=8e-5, shortest=shortest, rolloff=2e-5, rms_slope=slope, seed=seed
    )


def ten_waves(amplitude, seed=0):
    draw = np.random.default_rng(seed)
    order = np.arange(1, 11)
    size, phase = amplitude * order**-1.3, draw.uniform(0.0, 2 * np.pi, 10)
    return contact.Fourier(1e-4, list(size * np.cos(phase)), list(size * np.sin(phase)))


SURFACES = {
    "smooth": rough(0.05),
    "fine": rough(0.05, 2e-7),
    "steep": rough(0.2),
    "low waves": ten_waves(1e-7),
    "high waves": ten_waves(1e-6, 2),
}


def solved(profile, law, mean_pressure, **how):
    return contact.solve(
        contact.Scene(profile, E, contact.Periodic(), law=law, mean_pressure=mean_pressure), **how
    )


@pytest.mark.parametrize(
    ("name", "law"), diagonal(["smooth", "low waves", "high waves"], LAWS), ids=str
)
def test_raising_the_load_never_loses_contact(name, law):
    fractions = []
    for load in LOADS:
        try:
            fractions.append(solved(SURFACES[name], law, load).contact_fraction)
        except contact.OutOfRange as refusal:
            assert "past pull-off" in str(refusal)
            fractions.append(0.0)
    assert np.all(np.diff(fractions) >= 0.0)


@pytest.mark.parametrize(("name", "law"), diagonal(["smooth", "fine", "low waves"], LAWS), ids=str)
def test_smooth_soft_surfaces_close_altogether_under_no_load(name, law):
    solution = solved(SURFACES[name], law, 0.0)
    assert solution.contact_fraction == 1.0 and len(solution.zones) == 0
    assert solution.pressure(0.0) > -5e6


@pytest.mark.parametrize("law", quick(LAWS[:2], LAWS[:1]), ids=str)
def test_the_early_test_gives_what_following_the_contact_gives(law, monkeypatch):
    profile = ten_waves(1e-7, 1)
    foreseen = solved(profile, law, 1e4)
    monkeypatch.setattr(full_contact, "_is_followed_slowly", lambda context: False)
    assert solved(profile, law, 1e4).contact_fraction == foreseen.contact_fraction == 1.0


def test_if_following_fails_the_grid_test_gives_full_contact_or_the_failure_is_raised(monkeypatch):
    def fails(*_):
        raise np.linalg.LinAlgError("Singular matrix")

    monkeypatch.setattr("contact.adhesion.edge_branch.grown", fails)
    law = contact.JKR(WORK)
    assert solved(SURFACES["low waves"], law, 0.0).contact_fraction == 1.0
    with pytest.raises(contact.NotConverged, match="could not be solved .Singular matrix."):
        solved(SURFACES["steep"], law, 0.0)
