"""The scenes of the suite, each with a solution to judge by: closed form, inverse design, or another formulation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact.bench.truth import Exact
from contact.errors import NotConverged
from contact.exact import PeriodicBiquadratic, PeriodicParabola, PeriodicWedge, Westergaard
from contact.gapped import solve_gaps
from contact.interactions import Periodic
from contact.inverse import random_problem
from contact.problem import Control, Problem, Units
from contact.profiles import Biquadratic, Fourier, Parabola, Profile, Sinusoid, Wedge
from contact.scene import Scene
from contact.solution import Solution
from contact.solver import solve
from contact.topology import settle

Array = NDArray[np.float64]

E_STAR = 1.1e11
PERIOD = 1e-4


@dataclass(frozen=True, eq=False)
class Case:
    """A scene under periodic contact and how its truth is known; `exact` is made when first asked for."""

    name: str
    profile: Profile
    E_star: float
    mean_pressure: float
    make_exact: Callable[[Scene], Exact] = field(repr=False)
    judged_by: str

    @property
    def scene(self) -> Scene:
        return Scene(self.profile, self.E_star, Periodic(), mean_pressure=self.mean_pressure)

    @cached_property
    def exact(self) -> Exact:
        return self.make_exact(self.scene)


def closed(name: str, profile: Profile, exact: Any) -> Case:
    """A case whose solution is known in closed form."""
    return Case(name, profile, exact.E_star, exact.mean_pressure, lambda scene: exact, "closed form")


def wave(fraction: float = 0.4) -> Case:
    exact = Westergaard.from_contact_fraction(fraction, amplitude=1e-6, period=PERIOD, E_star=E_STAR)
    return closed(f"wave 2a/L={fraction:g}", Sinusoid(1e-6, PERIOD), exact)


def wedge() -> Case:
    exact = PeriodicWedge.from_contact_fraction(0.4, wedge_slope=0.05, period=PERIOD, E_star=E_STAR)
    return closed("wedge", Wedge(0.05, PERIOD), exact)


def parabola() -> Case:
    exact = PeriodicParabola.from_contact_fraction(0.4, radius=1e-3, period=PERIOD, E_star=E_STAR)
    return closed("parabola", Parabola(1e-3, PERIOD), exact)


def biquadratic() -> Case:
    """The paper's own: R = 1, c = 0.05, L = 2.4 c, at a mean pressure of 0.00109 E*."""
    exact = PeriodicBiquadratic(radius=1.0, spacing=0.1, period=0.12, E_star=1.0, mean_pressure=0.00109)
    return closed("biquadratic, 2 zones", Biquadratic(1.0, 0.1, 0.12), exact)


def designed(zones: int = 8, seed: int = 8, spread: float = 10.0) -> Case:
    problem = random_problem(np.random.default_rng(seed), zones=zones, period=1.0, fraction=0.4, spread=spread)
    assert problem.mean_pressure is not None
    return Case(
        f"designed, {zones} zones", problem.profile, problem.E_star, problem.mean_pressure, lambda scene: problem,
        "inverse design",
    )


def rough_profile(harmonics: int, seed: int = 3) -> Fourier:
    """Self-affine with Hurst exponent 0.8 beyond the fourth harmonic, random phases, period 1."""
    rng = np.random.default_rng(seed)
    k = np.arange(1, harmonics + 1)
    amplitude = 1e-3 * np.maximum(k, 4) ** (-1.3)
    phase = rng.uniform(0.0, 2 * np.pi, harmonics)
    return Fourier(1.0, amplitude * np.cos(phase), amplitude * np.sin(phase))


def rough(harmonics: int, mean_pressure: float, zones: int) -> Case:
    """Against the same formulation run to 1e-11: there is no other one where contact is far from full."""
    return Case(
        f"rough, {zones} zones", rough_profile(harmonics), 1.0, mean_pressure, lambda scene: best(scene, 1e-11),
        "tol = 1e-11",
    )


def rough_nearly_full() -> Case:
    """Where both formulations apply, `solve` takes the gaps; it is judged by the zones."""
    return Case("rough, nearly full", rough_profile(64), 1.0, 0.012, by_zones, "the zones' formulation")


def best(scene: Scene, tol: float) -> Solution:
    """The solution to a tolerance, or the best there is."""
    try:
        return solve(scene, tol)
    except NotConverged as error:
        if error.best is None:
            raise
        found: Solution = error.best
        return found


@dataclass(frozen=True, eq=False)
class ByZones:
    """A nearly full contact with pressures as unknowns, in SI units, to judge the one by gaps."""

    found: Any
    zones: Array
    load: float
    max_pressure: float

    def _place(self, zone: int) -> int:
        return int(np.argmin(np.abs(self._middles - np.mean(self.zones[zone]))))

    @cached_property
    def _middles(self) -> Array:
        fields = self.found.fields
        middles = fields.problem.units.x(fields.density.zones.middle)
        period = fields.problem.profile.period
        nearest = np.round((middles[:, None] - np.mean(self.zones, axis=1)) / period)
        return np.asarray(middles - period * nearest[np.arange(len(middles)), np.argmin(np.abs(nearest), axis=1)])

    def pressure_at(self, t: ArrayLike, zone: int = 0) -> Array:
        return np.asarray(self.found.fields.pressure_at(self._place(zone), t))

    def pressure(self, x: ArrayLike) -> Array:
        return np.asarray(self.found.fields.pressure(x))


def by_zones(scene: Scene) -> ByZones:
    """The zones' formulation started from the zones that the gaps' formulation finds."""
    start = solve(scene, 1e-6)
    problem = scaled(scene)
    units = problem.units
    assert scene.period is not None and scene.mean_pressure is not None
    load = scene.mean_pressure * scene.period
    table = units.scaled(start.zones)
    if len(table) > 1 and table[-1, 1] - table[0, 0] >= problem.cell:
        raise ValueError("zones across the border of the cell cannot start the zones' formulation")
    found = settle(problem, Control("load", load / units.load), table, 1e-14)
    zones = np.asarray(units.x(found.free.density.zones.table))
    turns = np.floor((zones[:, 0] - scene.profile.x0) / scene.period)
    zones = zones - turns[:, None] * scene.period
    return ByZones(found, zones[np.argsort(zones[:, 0])], load, found.fields.max_pressure)


def by_gaps(scene: Scene, tolerance: float = 1e-13) -> Any:
    """Fields of the gaps' formulation, whichever `solve` would take."""
    problem = scaled(scene)
    units = problem.units
    assert scene.mean_pressure is not None

    def conjugate(x: Array) -> Array:
        value = scene.profile.slope_conjugate(units.x(x))
        assert value is not None
        return value / units.slope

    return solve_gaps(problem, scene.mean_pressure / units.pressure, conjugate, tolerance).fields


def scaled(scene: Scene) -> Problem:
    """The scaled problem of a periodic scene."""
    profile = scene.profile
    assert profile.period is not None
    x = profile.x0 + profile.period * np.arange(1024) / 1024
    units = Units(profile.x0 + 0.5 * profile.period, profile.period, float(np.abs(profile.slope(x)).max()), scene.E_star)
    return Problem(profile, scene.interaction, units, float(np.min(profile.height(x))))


def suite(quick: bool) -> list[Case]:
    """The scenes of the work-precision part."""
    cases = [wave(0.4), wave(0.9), wedge(), parabola(), biquadratic(), designed(), rough(64, 0.002, 16)]
    if not quick:
        cases += [rough_nearly_full(), rough(512, 0.005, 135)]
    return cases
