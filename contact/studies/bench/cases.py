"""Scenes for errors against time, each with a closed form or a solution by another formulation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact.errors import NotConverged
from contact.model.interactions import Periodic
from contact.model.laws import JKR, Dugdale, Frictionless, Law, Plastic
from contact.model.profiles import Biquadratic, Flat, Fourier, Parabola, Profile, Sinusoid, Wedge
from contact.model.scene import Scene
from contact.reference.exact import (
    DugdaleWave,
    JKRWave,
    PeriodicBiquadratic,
    PeriodicParabola,
    PeriodicWedge,
    Westergaard,
)
from contact.reference.inverse import random_problem
from contact.solution.solution import Solution
from contact.solver import solve
from contact.studies.bench.formulations import solved_by_gaps, solved_by_zones
from contact.studies.bench.truth import Exact
from contact.studies.bench.yielding import YieldingPunches

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Case:
    """A periodic scene and its reference solution, which is computed on first use.

    `single` says that the scene has one zone in the period, and `localized` that the localized
    models run on this scene too. `judged_by` names the source of the reference solution. Other
    codes (peers) run on a scene only if its law is frictionless.
    """

    name: str
    profile: Profile
    E_star: float
    mean_pressure: float
    make_exact: Callable[[Scene], Exact] = field(repr=False)
    judged_by: str
    single: bool = False
    localized: bool = True
    law: Law = Frictionless()

    @property
    def scene(self) -> Scene:
        return Scene(
            self.profile, self.E_star, Periodic(), law=self.law, mean_pressure=self.mean_pressure
        )

    @cached_property
    def exact(self) -> Exact:
        return self.make_exact(self.scene)


def closed_form_case(name: str, profile: Profile, exact: Any) -> Case:
    """A case whose exact solution is known in closed form."""
    single = len(exact.zones) == 1
    return Case(
        name, profile, exact.E_star, exact.mean_pressure, lambda scene: exact, "closed form", single
    )


def wave(fraction: float = 0.4, E_star: float = 1.1e11, period: float = 1e-4) -> Case:
    """A case of Westergaard's wave at a given contact fraction."""
    exact = Westergaard.from_contact_fraction(
        fraction, amplitude=1e-6, period=period, E_star=E_star
    )
    return closed_form_case(f"wave 2a/L={fraction:g}", Sinusoid(1e-6, period), exact)


def wedge(E_star: float = 1.1e11, period: float = 1e-4) -> Case:
    """A case of a periodic wedge at a contact fraction of 0.4."""
    exact = PeriodicWedge.from_contact_fraction(0.4, wedge_slope=0.05, period=period, E_star=E_star)
    return closed_form_case("wedge", Wedge(0.05, period), exact)


def parabola(E_star: float = 1.1e11, period: float = 1e-4) -> Case:
    """A case of a periodic parabola at a contact fraction of 0.4."""
    exact = PeriodicParabola.from_contact_fraction(0.4, radius=1e-3, period=period, E_star=E_star)
    return closed_form_case("parabola", Parabola(1e-3, period), exact)


def biquadratic() -> Case:
    """A case of a profile with two tips in a period, at a mean pressure of 0.00109 E*.

    The radius is R = 1, the spacing 2c = 0.1 and the period L = 2.4 c. The ratio of L to c is that
    of Goryacheva & Tsukanov (2020), doi 10.3389/fmech.2020.00045, who leave the load and c/R open.
    """
    exact = PeriodicBiquadratic(
        radius=1.0, spacing=0.1, period=0.12, E_star=1.0, mean_pressure=0.00109
    )
    return closed_form_case("biquadratic, 2 zones", Biquadratic(1.0, 0.1, 0.12), exact)


def designed(zones: int = 8, seed: int = 8, spread: float = 10.0) -> Case:
    """A case with random zones, for which a profile with this exact contact is computed."""
    problem = random_problem(
        np.random.default_rng(seed), zones=zones, period=1.0, fraction=0.4, spread=spread
    )
    assert problem.mean_pressure is not None
    return Case(
        f"designed, {zones} zones",
        problem.profile,
        problem.E_star,
        problem.mean_pressure,
        lambda scene: problem,
        "inverse design",
    )


def rough_profile(harmonics: int, seed: int = 3) -> Fourier:
    """A profile of period 1, self-affine from its 4th harmonic on with Hurst exponent 0.8."""
    rng = np.random.default_rng(seed)
    k = np.arange(1, harmonics + 1)
    amplitude = 1e-3 * np.maximum(k, 4) ** (-1.3)
    phase = rng.uniform(0.0, 2 * np.pi, harmonics)
    return Fourier(1.0, amplitude * np.cos(phase), amplitude * np.sin(phase))


def rough(harmonics: int, mean_pressure: float, zones: int) -> Case:
    """A case of a rough profile.
    The reference solution is found with the slope of the gap as the unknown.

    The solver itself solves for the pressure.
    """
    return Case(
        f"rough, {zones} zones",
        rough_profile(harmonics),
        1.0,
        mean_pressure,
        solved_by_gaps,
        "the gaps' formulation",
        localized=False,
    )


def adhesive(law: JKR | Dugdale) -> Case:
    """A case of an adhesive wave in tension, at half of the pull-off load."""
    amplitude, E_star = 0.01, 1.0
    curve = (
        JKRWave(amplitude, 1.0, E_star, law.work)
        if isinstance(law, JKR)
        else DugdaleWave(amplitude, 1.0, E_star, law.work, law.stress)
    )
    exact = curve.at_load(0.5 * curve.pull_off().load)
    assert exact.mean_pressure is not None
    return Case(
        f"adhesive wave, {law.name}",
        Sinusoid(amplitude, 1.0),
        E_star,
        exact.mean_pressure,
        lambda scene: exact,
        "closed form",
        localized=False,
        law=law,
    )


def yielding() -> Case:
    """A case of flat punches that yield on a tenth of their width, beside the corners."""
    exact = YieldingPunches(half_width=0.3, elastic=0.27, period=1.0, hardness=0.1)
    return Case(
        "flat punches, plastic",
        Flat(0.6, 1.0),
        1.0,
        exact.mean_pressure,
        lambda scene: exact,
        "closed form",
        localized=False,
        law=Plastic(exact.hardness),
    )


def rough_nearly_full() -> Case:
    """A case of a rough profile in nearly full contact.

    The solver solves for the slope of the gap, and the reference solution for the pressure.
    """
    return Case(
        "rough, nearly full",
        rough_profile(64),
        1.0,
        0.012,
        solved_by_zones,
        "the zones' formulation",
        localized=False,
    )


def best(scene: Scene, tol: float) -> Solution:
    """Return the solution at a tolerance, or the best solution if the tolerance is not reached."""
    try:
        return solve(scene, tol)
    except NotConverged as error:
        if error.best is None:
            raise
        found: Solution = error.best
        return found


def suite(quick: bool) -> list[Case]:
    """Return the cases of the study of error against time."""
    cases = [
        wave(0.4),
        wave(0.9),
        wedge(),
        parabola(),
        biquadratic(),
        designed(),
        rough(64, 0.002, 16),
        adhesive(JKR(1e-5)),
        adhesive(Dugdale(1e-5, 1e-2)),
        yielding(),
    ]
    if not quick:
        cases += [rough_nearly_full(), rough(512, 0.005, 135)]
    return cases
