"""Predicted residuals of moving ends: their accuracy, and equilibria with and without them."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest

import contact
from contact.adhesion import gradient_flow
from contact.adhesion.curve import Curve
from contact.adhesion.predictor import Predictor
from contact.studies.trace_kinds import self_affine_heights
from tests.tiers import quick

E = 2.3e11
STYLUS = Path(__file__).parents[2] / "examples" / "stylus.toml"


def rough(seed, hurst=0.7, points=400, **more):
    """The scene of a random trace with adhesion, and its solution without adhesion.

    There are a dozen zones of contact or more.
    """
    heights = 2e-8 * self_affine_heights(np.random.default_rng(seed), points, hurst, longest=20)
    profile = contact.Sampled(np.linspace(0.0, 1e-4, points, endpoint=False), heights, period=1e-4)
    bare = contact.solve(
        contact.Scene(profile, E, contact.Periodic(), contact_fraction=0.15, **more)
    )
    work = 0.03 * bare.energy.elastic / np.diff(bare.zones).sum()
    return replace(
        bare.scene, law=contact.JKR(work), contact_fraction=None, mean_pressure=bare.mean_pressure
    ), bare


def state(scene):
    solution = contact.solve(scene)
    return Curve(
        solution.fields.problem, solution.find_pull_off.control
    ), solution.fields.density.zones.table


# The ends move outward (sign 1) or inward (sign -1), on a half-plane or on a layer.
@pytest.mark.parametrize(
    ("points", "sign", "layer"),
    [
        (100, 1.0, False),
        (100, -1.0, True),
        *quick([(400, 1.0, False), (400, 1.0, True), (400, -1.0, False), (400, -1.0, True)], []),
    ],
)
def test_the_predicted_residual_of_an_end_is_more_accurate_for_shorter_motions(points, sign, layer):
    substrate = {"substrate": contact.Layer(1e-5, 0.3)} if layer else {}
    scene, _ = rough(1, points=points, **substrate)
    curve, table = state(scene)
    here = curve.at(table, curve.control.value)
    told = Predictor.of(curve, here, curve.fields(here), sign)
    ends = np.argsort(-np.tile(np.diff(table, axis=1)[:, 0], 2))[:6]
    missed = []
    for place in (32, 16, 8):
        # Each distance is a quarter of the one before.
        distance = told.farthest * (place / 64) ** 2
        off = []
        for end in ends:
            ahead = curve.at(
                here.moved(sign * np.where(np.arange(len(distance)) == end, distance, 0.0)),
                here.value,
            )
            alone = told.driven[end, place] - told.driven[end, 0]
            off.append(abs(sign * (ahead.residual - here.residual)[end] - alone))
        missed.append(max(off))
    assert missed[0] < 0.1 and missed[2] < 0.5 * missed[0], missed


@pytest.mark.parametrize(
    ("points", "seed", "hurst", "control"),
    [
        (100, 1, 0.9, "approach"),
        *quick(product([400], range(4), [0.3, 0.9], ["mean_pressure", "approach"]), []),
    ],
)
def test_ends_reach_the_same_equilibrium_with_and_without_the_predictor(
    points, seed, hurst, control, monkeypatch
):
    scene, bare = rough(seed, hurst, points)
    scene = scene.under(control, getattr(bare, control))
    counted = []
    real = gradient_flow._predicted_step
    monkeypatch.setattr(
        gradient_flow, "_predicted_step", lambda *given: counted.append(1) or real(*given)
    )
    with_it = contact.solve(scene)
    assert counted
    last = with_it.pull_off
    monkeypatch.setattr(gradient_flow, "MOVES", replace(gradient_flow.MOVES, few_zones=10**9))
    counted.clear()
    without = contact.solve(scene)
    assert not counted
    assert with_it.zones == pytest.approx(without.zones, rel=1e-9, abs=1e-9 * scene.profile.period)
    assert last.load == pytest.approx(without.pull_off.load, rel=1e-9)


def test_an_inward_flow_also_moves_ends_that_are_all_driven_outward():
    scene, _ = rough(0, 0.3)
    curve, table = state(scene)
    value = 1.3 * curve.control.value
    assert curve.at(table, value).residual.min() > 0.1
    rest = gradient_flow.receded(curve, table, value)
    assert np.abs(rest.residual).max() < 1e-4 and rest.growth < 0.0


@pytest.mark.slow
def test_an_end_that_moves_over_many_samples_needs_few_states(monkeypatch):
    base = contact.load_scene(STYLUS)
    # On the long tapers, ends move far.
    profile = base.profile.varied({"profile": {"taper": 0.05}})
    scene = replace(base, profile=profile, mean_pressure=7 * 6.473e6, law=contact.JKR(1e-3))
    states = []
    real = gradient_flow._flow
    at = Curve.at
    monkeypatch.setattr(
        Curve, "at", lambda *given, **more: states.append(given[1]) or at(*given, **more)
    )
    flows = []

    def flowed(curve, table, *given):
        before = len(states)
        found = real(curve, table, *given)
        ends = found.table.ravel()
        # The farthest motion in samples: the distance of an old end from the nearest new end.
        ran = (
            max(np.abs(ends - one).min() for one in table.ravel())
            * curve.problem.units.length
            / scene.profile.resolution
        )
        flows.append((ran, len(states) - before))
        return found

    monkeypatch.setattr(gradient_flow, "_flow", flowed)
    assert contact.solve(scene).certificate.holds
    ran, count = max(flows)
    assert ran > 20 and count < 30
