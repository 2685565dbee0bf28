"""Closed loops of rough surfaces with adhesion: the work of the load is the energy lost.
The work is computed by Gauss's rule from solutions between the events.
"""

import numpy as np
import pytest

import contact
from contact.studies.trace_kinds import drawn

POINTS, STIFFNESS = 20, 1e9
# At a turning point of the curve the integrand has a square root of the distance in the
# control. With the share sin^2(angle) of the way from one end of a piece to the other, the
# integrand is smooth in the angle.
NODES, WEIGHTS = np.polynomial.legendre.leggauss(POINTS)
ANGLE = 0.25 * np.pi * (NODES + 1)
SHARE, WEIGHT = np.sin(ANGLE) ** 2, 0.25 * np.pi * WEIGHTS * np.sin(2 * ANGLE)

LAWS = {"jkr": contact.JKR(1e-3), "dugdale": contact.Dugdale(1e-3, 3e6)}
HELD = {
    "load": ([-500.0, 40.0, -500.0], {"control": "load"}),
    "approach": ([-2e-7, 3e-8, -2e-7], {"control": "approach"}),
    "spring": ([-3e-7, 1e-7, -3e-7], {"control": "approach", "stiffness": STIFFNESS}),
}


def pieces(loop, held):
    """The smooth pieces between events, and the work of the load in the jumps.
    A piece is given by (value, load, approach) at both of its ends.
    """
    found, jumps = [], 0.0
    for k in range(1, len(loop.values)):
        first, last = loop.solutions[k - 1], loop.solutions[k]
        at = loop.values[k - 1], first.load, first.approach
        for event in loop.passed[k]:
            found.append((at, (event.value, event.load, event.approach)))
            pulls = event.load if held == "load" else 0.5 * (event.load + event.load_after)
            jumps += pulls * (event.approach_after - event.approach)
            at = event.value, event.load_after, event.approach_after
        found.append((at, (loop.values[k], last.load, last.approach)))
    return found, jumps


def work(held, at, to, inner):
    """The work int P d(approach) on a piece; it is zero if the surfaces are apart."""
    if not any(solution.load for solution in inner):
        return 0.0
    moved, load = (to[0] - at[0]) * WEIGHT, np.array([solution.load for solution in inner])
    if held == "load":
        return (
            to[1] * to[2]
            - at[1] * at[2]
            - moved @ np.array([solution.approach for solution in inner])
        )
    return moved @ load - (0.5 * (to[1] ** 2 - at[1] ** 2) / STIFFNESS if held == "spring" else 0.0)


@pytest.mark.slow
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("held", HELD)
def test_the_work_of_the_load_over_a_loop_by_quadrature_is_what_its_jumps_lose(law, held):
    k, phase = np.arange(1, 5), np.random.default_rng(0).uniform(0, 2 * np.pi, 4)
    profile = contact.Fourier(1e-4, 1e-7 / k * np.cos(phase), 1e-7 / k * np.sin(phase))
    scene = contact.Scene(profile, 1e9, contact.Periodic(), law=LAWS[law], load=0.0)
    values, how = HELD[held]
    loop = contact.path(scene, values, **how)
    found, total = pieces(loop, held)
    assert len(loop.events) >= 3 and all(event.lost > 0.0 for event in loop.events)
    between = contact.path(
        scene,
        np.concatenate(
            [values[:1], *(at[0] + (to[0] - at[0]) * SHARE for at, to in found), values[-1:]]
        ),
        **how,
    )
    for k, (at, to) in enumerate(found):
        total += work(held, at, to, between.solutions[1 + POINTS * k : 1 + POINTS * (k + 1)])
    # The error of the Gauss rule for the work between two events is 1e-11 with 20 points, and 1e-6
    # with 10 points.
    assert total == pytest.approx(loop.dissipated, rel=1e-9) and loop.work == pytest.approx(
        loop.dissipated, rel=1e-12
    )


@pytest.mark.slow
def test_a_step_over_two_turning_points_is_not_taken_for_a_step_over_one():
    # After pull-off the surfaces are drawn apart by the approach. Two turning points of that
    # curve are close to each other.
    profile = drawn(np.random.default_rng(4), "turned", 300)
    law, pressure = contact.Dugdale(0.08145729947206055, 1823005540.8403118), 1001345.1073676093
    scene = contact.Scene(profile, 2.3e11, contact.Periodic(), law=law, mean_pressure=0.0)
    loop = contact.path(
        scene, [-0.02 * pressure, pressure, -0.3 * pressure], control="mean_pressure"
    )
    assert loop.events[-1].kind == "pull-off" and loop.events[-1].lost > 0.0
