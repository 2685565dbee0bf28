"""Paths under a tension of finite range: jumps where the closed forms have them, and all energy accounted for."""

from __future__ import annotations

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
    "wave": {"load": [-2e-3, 4e-3, -2e-3], "approach": [-4e-2, 6e-3, -4e-2], "spring": [-0.07, 0.02, -0.07]},
    "cylinder": {"load": [-1e-3, 1e-3, -1e-3], "approach": [-0.1, 1e-3, -0.1], "spring": [-0.2, 1e-3, -0.2]},
}


def stress_of(tabor):
    return tabor / 4 * (np.pi**2 * W_CYLINDER) ** (1 / 3)


def body(name, size):
    """(scene, closed form): size is the stress of the wave, and Tabor's parameter of the cylinder."""
    if name == "wave":
        scene = contact.Scene(contact.Sinusoid(DELTA, 1.0), E, contact.Periodic(), law=contact.Dugdale(W_WAVE, size), load=0.0)
        return scene, exact.DugdaleWave(DELTA, 1.0, E, W_WAVE, size)
    law = contact.Dugdale(W_CYLINDER, stress_of(size))
    scene = contact.Scene(contact.Parabola(1.0), E, contact.Isolated(datum=1.0), law=law, load=0.0)
    return scene, exact.DugdaleCylinder(1.0, E, W_CYLINDER, law.stress, datum=1.0)


@lru_cache
def loop(name, size, held):
    scene = body(name, size)[0]
    kwargs = {"stiffness": STIFF[name]} if held == "spring" else {"control": held}
    return contact.path(scene, VALUES[name][held], **kwargs)


def value(state, held, name):
    return {"load": state.load, "approach": state.approach, "spring": state.approach + state.load / STIFF[name]}[held]


def work(curve, first, last):
    """int P d(approach) between two ends c of the tension, by Gauss's rule on P(c) and approach(c) alone."""
    t, weights = np.polynomial.legendre.leggauss(40)
    c = 0.5 * (first + last) + 0.5 * (last - first) * t
    states, (start, end) = [curve.at(x) for x in c], (curve.at(first), curve.at(last))
    slopes = [curve._rates(x)[0] for x in c]
    by_parts = 0.5 * (last - first) * sum(w * s * r.approach for w, s, r in zip(weights, slopes, states, strict=True))
    return end.load * end.approach - start.load * start.approach - by_parts


@pytest.mark.parametrize("held", ["load", "approach", "spring"])
@pytest.mark.parametrize(("name", "size"), quick([("wave", 2e-2), ("cylinder", 3.0), ("cylinder", 20.0)], always=[("wave", 2e-2)]))
def test_a_loop_loses_the_work_of_its_load_by_the_closed_forms(name, size, held):
    scene, curve = body(name, size)
    found = loop(name, size, held)
    machine = {"load": INF, "approach": 0.0, "spring": 1.0 / STIFF[name]}[held]
    reach, top_value = scene.law.reach, VALUES[name][held][1]
    off = curve.pull_off(machine)
    first = 0.0 if held == "load" else -reach
    widest = 0.499 if name == "wave" else 0.5
    of = {v: brentq(lambda c, v=v: value(curve.at(c), held, name) - v, off.cohesive_end, widest, xtol=1e-16) for v in (first, top_value)}
    jump_in, pull_off = found.events
    assert (jump_in.kind, pull_off.kind) == ("jump-in", "pull-off")
    assert jump_in.value == pytest.approx(first, rel=1e-12) and pull_off.value == pytest.approx(value(off, held, name), rel=1e-10)
    assert jump_in.after[0, 1] == pytest.approx(curve.at(of[first]).half_width, rel=1e-9)
    on = curve.at(of[first])
    # On the curve, on the jumps' straight lines, and of a dead load until no approach holds any more.
    done = work(curve, of[first], of[top_value]) + work(curve, of[top_value], off.cohesive_end)
    if held == "load":
        done += off.load * (curve.pull_off(0.0).approach - off.approach)
    else:
        start = 0.0 if held == "load" else -reach
        done += 0.5 * on.load * (on.approach - start)
        if held == "spring":
            done += 0.5 * off.load * off.load / STIFF[name]
    assert found.dissipated == pytest.approx(done, rel=1e-8)
    assert found.work == pytest.approx(done, rel=1e-8)
    assert jump_in.lost > 0.0 < pull_off.lost
