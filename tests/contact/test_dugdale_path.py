"""Paths under Dugdale's law: jumps against closed forms, and the balance of energy."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from scipy.optimize import brentq

import contact
from contact import exact
from tests.tiers import quick

E, DELTA, W_WAVE, W_CYLINDER = 1.0, 0.01, 1e-5, 1e-6
INF = float("inf")
STIFF = {"wave": 0.2, "cylinder": 0.05}
VALUES = {
    "wave": {
        "load": [-2e-3, 4e-3, -2e-3],
        "approach": [-4e-2, 6e-3, -4e-2],
        "spring": [-0.07, 0.02, -0.07],
    },
    "cylinder": {
        "load": [-1e-3, 1e-3, -1e-3],
        "approach": [-0.1, 1e-3, -0.1],
        "spring": [-0.2, 1e-3, -0.2],
    },
}


def stress_of(tabor):
    return tabor / 4 * (np.pi**2 * W_CYLINDER) ** (1 / 3)


def body(name, size):
    """(scene, closed form): size is the stress of the wave, and Tabor's parameter of the cylinder."""
    if name == "wave":
        scene = contact.Scene(
            contact.Sinusoid(DELTA, 1.0),
            E,
            contact.Periodic(),
            law=contact.Dugdale(W_WAVE, size),
            load=0.0,
        )
        return scene, exact.DugdaleWave(DELTA, 1.0, E, W_WAVE, size)
    law = contact.Dugdale(W_CYLINDER, stress_of(size))
    scene = contact.Scene(contact.Parabola(1.0), E, contact.Isolated(datum=1.0), law=law, load=0.0)
    return scene, exact.DugdaleCylinder(1.0, E, W_CYLINDER, law.stress, datum=1.0)


@lru_cache
def loop(name, size, held):
    """The closed path of a body under a control: load, approach or a spring."""
    scene = body(name, size)[0]
    kwargs = {"stiffness": STIFF[name]} if held == "spring" else {"control": held}
    return contact.path(scene, VALUES[name][held], **kwargs)


def value(state, held, name):
    """The value of the control in a state: load, approach, or position of the spring."""
    return {
        "load": state.load,
        "approach": state.approach,
        "spring": state.approach + state.load / STIFF[name],
    }[held]


def work(curve, first, last):
    """The work int P d(approach) between two ends c of the tension, from the closed forms.
    The integral is by parts: Gauss's rule in c for approach(c) dP/dc.
    """
    t, weights = np.polynomial.legendre.leggauss(40)
    c = 0.5 * (first + last) + 0.5 * (last - first) * t
    states, (start, end) = [curve.at(x) for x in c], (curve.at(first), curve.at(last))
    slopes = [curve._rates(x)[0] for x in c]
    by_parts = (
        0.5
        * (last - first)
        * sum(w * s * r.approach for w, s, r in zip(weights, slopes, states, strict=True))
    )
    return end.load * end.approach - start.load * start.approach - by_parts


@pytest.mark.parametrize("held", quick(["load", "approach", "spring"], ["load", "spring"]))
@pytest.mark.parametrize(
    ("name", "size"),
    quick([("wave", 2e-2), ("cylinder", 3.0), ("cylinder", 20.0)], always=[("wave", 2e-2)]),
)
def test_a_loop_loses_the_work_of_its_load_by_the_closed_forms(name, size, held):
    scene, curve = body(name, size)
    found = loop(name, size, held)
    machine = {"load": INF, "approach": 0.0, "spring": 1.0 / STIFF[name]}[held]
    reach, top_value = scene.law.reach, VALUES[name][held][1]
    off = curve.pull_off(machine)
    first = 0.0 if held == "load" else -reach
    widest = 0.499 if name == "wave" else 0.5
    of = {
        v: brentq(
            lambda c, v=v: value(curve.at(c), held, name) - v, off.cohesive_end, widest, xtol=1e-16
        )
        for v in (first, top_value)
    }
    jump_in, pull_off = found.events
    assert (jump_in.kind, pull_off.kind) == ("jump-in", "pull-off")
    assert jump_in.value == pytest.approx(first, rel=1e-12) and pull_off.value == pytest.approx(
        value(off, held, name), rel=1e-10
    )
    assert jump_in.after[0, 1] == pytest.approx(curve.at(of[first]).half_width, rel=1e-9)
    on = curve.at(of[first])
    # The work on the curve in closed form, and on the straight lines of the jumps. Under a
    # given load the work continues from its pull-off to the pull-off under a given approach.
    done = work(curve, of[first], of[top_value]) + work(curve, of[top_value], off.cohesive_end)
    if held == "load":
        done += off.load * (curve.pull_off(0.0).approach - off.approach)
    else:
        done += 0.5 * on.load * (on.approach + reach)
        if held == "spring":
            done += 0.5 * off.load * off.load / STIFF[name]
    assert found.dissipated == pytest.approx(done, rel=1e-8)
    assert found.work == pytest.approx(done, rel=1e-8)
    assert jump_in.lost > 0.0 < pull_off.lost


def test_surfaces_under_tension_without_contact_are_followed_under_a_given_approach():
    """A cylinder with a small Tabor parameter, under a given approach.
    Tension begins where the gap is the reach, contact begins without a jump, and tension ends
    at a fold. All values have closed forms of the states without contact.
    """
    scene, _ = body("cylinder", 0.01)
    found = contact.path(scene, [-0.1, 1e-3, -0.01, -0.1], control="approach")
    s, h, unit = scene.law.stress, scene.law.reach, 4 * scene.law.stress / (np.pi * E)

    def approach(c):
        return 0.5 * c**2 - h - unit * c * (np.log(1 / (2 * c)) + 1)

    fold = brentq(lambda c: c - unit * np.log(1 / (2 * c)), 1e-6, 0.1, xtol=1e-18)
    begun = brentq(lambda c: approach(c) + h, fold, 0.4, xtol=1e-18)
    touch = brentq(lambda c: approach(c) + unit * c * (np.log(1 / c) + 1), begun, 0.5, xtol=1e-18)
    assert [event.kind for event in found.events] == ["jump-in", "birth", "death", "pull-off"]
    jump_in, birth, death, pull_off = found.events
    assert jump_in.value == pytest.approx(-h, rel=1e-12) and jump_in.load_after == pytest.approx(
        -2 * s * begun, rel=1e-8
    )
    assert birth.value == pytest.approx(approach(touch), rel=1e-10) == death.value
    assert birth.load == pytest.approx(-2 * s * touch, rel=1e-10)
    assert pull_off.value == pytest.approx(approach(fold), rel=1e-12)
    t, weights = np.polynomial.legendre.leggauss(20)
    c = 0.5 * (begun + fold) + 0.5 * (fold - begun) * t
    done = 0.5 * (fold - begun) * float(weights @ (-2 * s * c * (c - unit * np.log(1 / (2 * c)))))
    assert found.work == pytest.approx(done, rel=1e-8)
    assert birth.lost == death.lost == 0.0 < jump_in.lost
    loose = found.solutions[2]
    c = brentq(lambda c: approach(c) + 0.01, fold, touch, xtol=1e-18)
    assert len(loose.zones) == 0 and loose.cohesive == pytest.approx(np.array([[-c, c]]), rel=1e-10)
    assert loose.load == pytest.approx(-2 * s * c, rel=1e-10) and loose.approach == pytest.approx(
        -0.01, rel=1e-12
    )
    assert (
        loose.certificate.holds
        and loose.certificate.stability > 0.0
        and loose.gap(c) == pytest.approx(h, rel=1e-10)
    )
    assert loose.pressure([0.0, 2 * c]).tolist() == [-s, 0.0]


@pytest.mark.slow
def test_full_contact_has_no_loss_and_strips_jump_apart_where_the_gap_of_the_valley_is_the_reach():
    scene, curve = body("wave", 5e-3)
    found = contact.path(scene, [0.0, 0.04, 0.0])
    assert [event.kind for event in found.events] == ["jump", "full", "open", "jump"]
    snap, full, opening, split = found.events
    assert (
        full.value == pytest.approx(curve.opening_mean_pressure, rel=1e-12)
        and opening.value == full.value
    )
    assert full.lost == opening.lost == 0.0 and snap.lost > 0.0 < split.lost
    last = curve.at(max(c for c in curve.turning_points() if c < 0.5))
    assert snap.value == pytest.approx(last.load, rel=1e-10) and snap.before[0, 1] == pytest.approx(
        last.half_width, rel=1e-5
    )
    met = curve.at(0.5)
    assert split.value == pytest.approx(met.load, rel=1e-10)
    lost = (
        met.energy
        - curve.receding(met.load).energy
        + met.load * (curve.receding(met.load).approach - met.approach)
    )
    assert split.lost == pytest.approx(lost, rel=1e-7)
    assert opening.change() == "full contact to 1" and full.change() == "1 to full contact"


def test_zones_within_one_interval_of_tension_meet_and_part_at_one_load_without_a_loss():
    pair = contact.Scene(
        contact.Biquadratic(1.0, 0.2),
        E,
        contact.Isolated(datum=1.0),
        law=contact.Dugdale(1e-6, 5e-3),
        load=0.0,
    )
    found = contact.path(pair, [1.5e-3, 3e-3, 1.5e-3])
    merge, split = found.events
    assert (merge.kind, split.kind) == ("merge", "split") and merge.value == pytest.approx(
        split.value, rel=1e-12
    )
    assert merge.lost == split.lost == 0.0 and found.work == pytest.approx(0.0, abs=1e-14)
    assert len(merge.before) == 2 and merge.position == 0.0
    assert merge.before[0, 1] == merge.before[1, 0] == pytest.approx(0.0, abs=1e-9)
    # The merged zone touches in its middle without contact pressure: the pressure there is that
    # of the tension.
    touching = contact.solve(replace(pair, load=merge.value * (1 + 1e-9)), branch="receding")
    assert touching.pressure(0.0) == pytest.approx(-5e-3, rel=1e-5)


@pytest.mark.slow
def test_a_large_stress_has_the_jumps_of_adhesion_without_range():
    scene, _ = body("cylinder", 20.0)
    found, jkr = (
        loop("cylinder", 20.0, "load"),
        contact.path(replace(scene, law=contact.JKR(W_CYLINDER)), VALUES["cylinder"]["load"]),
    )
    assert [event.value for event in found.events] == pytest.approx(
        [event.value for event in jkr.events], rel=1e-4
    )
    assert found.dissipated == pytest.approx(jkr.dissipated, rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("stress", [1e5, 1e6, 1e7])
def test_a_rough_loop_is_closed_in_energy_and_its_smooth_pieces_agree_with_quadrature(stress):
    rng = np.random.default_rng(0)
    k, phase = np.arange(1, 7), rng.uniform(0, 2 * np.pi, 6)
    profile = contact.Fourier(1e-4, 1e-7 / k * np.cos(phase), 1e-7 / k * np.sin(phase))
    scene = contact.Scene(
        profile, 1e9, contact.Periodic(), law=contact.Dugdale(1e-3, stress), load=0.0
    )
    found = contact.path(scene, [-500.0, 40.0, -500.0])
    assert found.work == found.dissipated and all(event.lost >= 0.0 for event in found.events)
    t, weights = np.polynomial.legendre.leggauss(6)
    loads = 39.0 + t
    piece = contact.path(scene, np.concatenate(([38.0], loads, [40.0])))
    one, *inner, two = piece.solutions
    assert len(piece.events) == 0
    done = (
        two.load * two.approach
        - one.load * one.approach
        - float(weights @ [s.approach for s in inner])
    )
    assert two.energy.total - one.energy.total == pytest.approx(done, rel=1e-8)
