"""Dugdale's law for bodies with sharp corners.
The solutions are checked against closed forms of punches, the potential of the pressure, and
the balance of energy.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
import pytest
from scipy.optimize import brentq

import contact
from contact.adhesion.spread_end import SpreadEnd
from contact.formulation.conjugate import clausen2
from tests.tiers import quick

E, WORK, STRESS = 1.0, 1e-7, 1e-3
LAW = contact.Dugdale(WORK, STRESS)
INSIDE = np.array([-0.97, -0.6, 0.0, 0.3, 0.9])


def solve(profile, branch="advancing", law=LAW, substrate=None, **control):
    model = contact.Isolated(datum=10.0) if profile.period is None else contact.Periodic()
    return contact.solve(contact.Scene(profile, E, model, law=law, **control), branch=branch)


def turned(a=1.0, slope=2e-4, bend=0.0, period=None):
    """A punch with sharp corners at -a and a, tilted by `slope` and curved by `bend`."""
    beyond = (
        contact.Polynomial([0.0, slope, bend])
        if period is None
        else contact.Fourier(period, [0.0], [slope * period / (2 * pi)])
    )
    return contact.Combined(contact.Flat(2 * a, period), beyond)


def opened(b, stress):
    """The gap at the corner x = 1 of a flat punch with contact on |x| < b.
    The tension acts from |x| = b to 1 (Baney & Hui 1997, with no curvature of the cylinder).
    """
    m = 1 / b
    root = sqrt(m * m - 1)
    return 4 * stress * b / (pi * E) * (root * np.log(m + root) - m * np.log(m))


def let_go(work, stress):
    """The pull-off load of a flat punch on |x| < 1.
    At pull-off the gap at the corners is the reach, or else contact has shrunk to a point and
    the tension acts on the whole punch.
    """
    if opened(1e-9, stress) < work / stress:
        return -2 * stress
    b = brentq(lambda b: opened(b, stress) - work / stress, 1e-9, 1 - 1e-12, xtol=1e-15)
    return -2 * stress * sqrt(1 - b * b)


@pytest.mark.parametrize("branch", ["advancing", "receding"])
@pytest.mark.parametrize("part", [0.5, 0.0, -0.5])
def test_a_flat_punch_bears_as_one_and_opens_from_its_corners_once_it_is_pulled(part, branch):
    """Under compression the punch has the pressure without adhesion.
    Under a pull, strips of tension open from the corners.
    """
    load = part * 2 * STRESS * 0.6
    solution = solve(contact.Flat(2.0), branch, load=load)
    b = sqrt(1 - (load / (2 * STRESS)) ** 2) if part < 0 else 1.0
    assert solution.zones == pytest.approx(np.array([[-b, b]]), abs=1e-12)
    assert solution.cohesive == pytest.approx(np.array([[-1.0, 1.0]]))
    x = b * INSIDE
    plain = (
        load / (pi * np.sqrt(1 - x * x))
        if part >= 0
        else -2 * STRESS / pi * np.arctan(np.sqrt((1 - b * b) / (b * b - x * x)))
    )
    assert solution.pressure(x) == pytest.approx(plain, abs=1e-11 * STRESS)
    assert solution.gap(np.array([1.0])) == pytest.approx(
        opened(b, STRESS) if part < 0 else 0.0, abs=1e-12 * LAW.reach
    )
    assert solution.load == pytest.approx(load, abs=1e-15) and solution.certificate.holds
    assert solution.certificate.stability == np.inf and solution.error < 1e-11


def test_a_row_of_punches_has_the_wave_s_closed_form_without_the_wave():
    corner, load = 0.3 * pi, -2e-4
    solution = solve(contact.Flat(0.6, 1.0), load=load)
    a = np.arccos(np.cos(corner) / np.cos(-load * pi / (2 * STRESS)))
    assert solution.zones[0] * pi == pytest.approx([-a, a], abs=1e-12)
    u = a * INSIDE
    depth = np.sqrt((np.sin(corner) ** 2 - np.sin(a) ** 2) / (np.sin(a) ** 2 - np.sin(u) ** 2))
    assert solution.pressure(u / pi) == pytest.approx(
        -2 * STRESS / pi * np.arctan(np.cos(u) / np.cos(corner) * depth), rel=1e-11
    )


@pytest.mark.parametrize("work", [1e-7, 1e-5])
def test_a_punch_comes_off_where_its_corners_let_go_or_where_all_of_it_is_pulled(work):
    law, last = contact.Dugdale(work, STRESS), let_go(work, STRESS)
    assert solve(contact.Flat(2.0), law=law, load=1e-4).pull_off.load == pytest.approx(
        last, rel=1e-11
    )
    with pytest.raises(contact.OutOfRange, match="past pull-off"):
        solve(contact.Flat(2.0), law=law, load=last * (1 + 1e-6))


@pytest.mark.slow
def test_large_stresses_come_to_adhesion_without_range_as_their_strips():
    off = [
        solve(contact.Flat(2.0), law=contact.Dugdale(1e-7, s), load=1e-4).pull_off.load
        / -sqrt(2 * pi * 1e-7)
        - 1
        for s in (2e-3, 4e-3)
    ]
    assert off[0] / off[1] == pytest.approx(4.0, rel=0.02)
    held = [
        solve(turned(), law=law, load=-1e-4)
        for law in (contact.Dugdale(1e-7, 1e-2), contact.JKR(1e-7))
    ]
    assert (
        held[0].approach == pytest.approx(held[1].approach, rel=2e-3)
        and held[0].zones[0, 0] == held[1].zones[0, 0] == -1.0
    )


def residual(solution):
    """The largest |u + f - approach - gap| over the reach, at points of zones, strips and gaps.
    The displacement u is computed from the pressure, by Gauss's rule in the angle.
    """
    profile, period = solution.scene.profile, solution.scene.profile.period
    lo, hi = profile.support
    ends = np.unique(np.concatenate((solution.cohesive.ravel(), solution.zones.ravel(), [lo, hi])))
    x = np.unique(
        np.concatenate(
            (
                0.5 * (ends[1:] + ends[:-1])[np.diff(ends) > 1e-9],
                lo + (hi - lo) * np.array([0.03, 0.77]),
            )
        )
    )
    t, weight = np.polynomial.legendre.leggauss(400)
    u = np.zeros(len(x))
    for i, at in enumerate(x):
        for a, b in solution.cohesive:
            cuts = np.unique(
                [
                    a,
                    *(z for z in solution.zones.ravel() if a < z < b),
                    b,
                    *([at] if a < at < b else []),
                ]
            )
            for start, end in zip(cuts[:-1], cuts[1:], strict=True):
                half = 0.5 * (end - start)
                xi = start + half * (1 + np.cos(0.5 * pi * (1 + t)))
                size = (
                    np.abs(at - xi) / 10.0
                    if period is None
                    else np.abs(2 * np.sin(pi * (at - xi) / period))
                )
                u[i] -= (
                    2
                    / (pi * E)
                    * (
                        np.log(size)
                        * solution.pressure(xi)
                        * half
                        * np.sin(0.5 * pi * (1 + t))
                        * 0.5
                        * pi
                    )
                    @ weight
                )
    least = profile.height(np.linspace(lo, hi, 4001)).min()
    return (
        np.abs(u + profile.height(x) - least - solution.approach - solution.gap(x)).max()
        / solution.scene.law.reach
    )


@pytest.mark.parametrize(
    ("body", "load"),
    quick(
        [
            ((1.0, 2e-4), 4e-5),
            ((1.0, 2e-4), -2e-4),
            ((0.7, 3e-4, 1e-3), 3e-4),
            ((0.3, 3e-4, 0.0, 1.0), -1e-4),
            ((0.5, 0.0, -4e-4), -1e-4),
        ],
        always=[((1.0, 2e-4), 4e-5), ((0.3, 3e-4, 0.0, 1.0), -1e-4)],
    ),
)
def test_zones_held_at_one_corner_and_free_at_the_other_obey_their_equation_by_quadrature_of_the_pressure(
    body, load
):
    solution = solve(turned(*body), load=load)
    assert solution.certificate.holds and solution.error < 1e-9
    assert residual(solution) < 1e-6


def test_another_stress_does_not_obey_that_equation():
    solution = solve(turned(), load=-2e-4)
    solution.__dict__["pressure"] = lambda x, p=solution.pressure: (
        p(x) * np.where(p(x) == -STRESS, 1.001, 1.0)
    )
    assert residual(solution) > 1e-5


@pytest.mark.parametrize(("body", "load"), [((1.0, 2e-4), -2e-4), ((0.7, 3e-4, 1e-3), -1e-4)])
def test_the_energies_change_by_the_work_of_the_load(body, load):
    step = 2e-6
    low, here, high = (solve(turned(*body), load=load + k * step) for k in (-1, 0, 1))
    # The work, the integral of P d(approach), by parts; the integral over the load is by
    # Simpson's rule.
    work = (
        high.load * high.approach
        - low.load * low.approach
        - step / 3 * (low.approach + 4 * here.approach + high.approach)
    )
    assert high.energy.total - low.energy.total == pytest.approx(work, rel=1e-7)


def test_a_loop_of_a_punch_loses_what_closing_gives_and_what_opening_takes():
    """The jump into contact loses the work of adhesion on the whole width 2.
    The work of the load over the loop is the dissipated energy.
    """
    scene = contact.Scene(contact.Flat(2.0), E, contact.Isolated(datum=10.0), law=LAW, load=-1e-3)
    loop = contact.path(scene, [-1e-3, 1e-3, -1e-3])
    first, last = loop.events
    assert (first.kind, last.kind) == ("jump-in", "pull-off")
    assert first.lost == pytest.approx(2 * WORK, rel=1e-9)
    assert last.value == pytest.approx(let_go(WORK, STRESS), rel=1e-10)
    assert loop.work == pytest.approx(loop.dissipated, rel=1e-9)


@pytest.mark.slow
def test_ends_of_the_tension_reach_corners_and_leave_them_along_a_path():
    scene = contact.Scene(
        turned(0.7, 3e-4, 1e-3), E, contact.Isolated(datum=10.0), law=LAW, load=0.0
    )
    kinds = [event.kind for event in contact.path(scene, [0.0, 2e-3, -1e-3]).events]
    assert kinds[-1] == "pull-off" and "held" in kinds and "freed" in kinds


def test_an_end_spread_over_a_zone_has_the_means_of_potentials():
    """`SpreadEnd` returns means of ln|x - xi| and its antiderivatives over the zone.
    The points xi are spread with the equilibrium measure of the zone.
    """
    zone, period = SpreadEnd(0.1, 0.7), 1.3
    xi = zone.middle + zone.half * np.cos((np.arange(4000) + 0.5) * pi / 4000)

    def whole(y):
        return -period / (2 * pi) * clausen2(y / period - np.round(y / period))

    for x in np.array([[-0.5], [0.05], [0.9], [1.2]]):
        lag = x - xi
        assert zone.potential(x) == pytest.approx(np.log(np.abs(lag)).mean(), abs=1e-13)
        assert zone.primitive(x) == pytest.approx(
            (lag * (np.log(np.abs(lag)) - 1)).mean(), abs=1e-13
        )
        assert zone.periodic_potential(x, period) == pytest.approx(
            np.log(np.abs(2 * np.sin(pi * lag / period))).mean(), abs=1e-13
        )
        assert zone.periodic_primitive(x, period, whole) == pytest.approx(
            whole(lag).mean(), abs=1e-13
        )


@dataclass(frozen=True)
class Rough(contact.Profile):
    """A periodic row of rough bodies with sharp corners."""

    def height(self, x):
        x = np.asarray(x, dtype=float) - np.round(x)
        waves = 1e-5 * np.cos(6 * pi * x + 1.0) + 2e-5 * np.cos(10 * pi * x + 4.0) + 5e-5 * x * x
        return np.where((x >= -0.375 - 1e-15) & (x <= 0.3125 + 1e-15), waves, np.inf)

    def slope(self, x):
        x = np.asarray(x, dtype=float) - np.round(x)
        return (
            -6e-5 * pi * np.sin(6 * pi * x + 1.0) - 2e-4 * pi * np.sin(10 * pi * x + 4.0) + 1e-4 * x
        )

    period = 1.0
    support = (-0.375, 0.3125)
    resolution = 0.03


@pytest.mark.slow
def test_strips_beside_corners_may_be_very_narrow():
    solution = solve(Rough(), law=contact.Dugdale(6.8e-9, 4.2e-3), load=0.0)
    assert solution.certificate.holds and solution.error < 1e-8
