"""Reference solutions by another formulation, where no closed form is known.

A periodic contact can be solved for the pressure p on its zones or for the slope s of the gap on
its gaps. With the kernel K, the mean pressure pbar, and R as in contact.formulation.gaps, the
equations are

    (1/pi) PV int_zones p K = (E*/2) f'        on the zones,
    (1/pi) PV int_gaps s K = R - 2 pbar/E*     on the gaps, int_gap s = 0.

The two formulations have different unknowns, right sides, intervals and side conditions. Each
starts from the zones of `solve` with every end moved by a thousandth of an interval, so that it
must find the ends again.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact.errors import NotConverged
from contact.formulation.controls import Load
from contact.formulation.fields import ZoneFields
from contact.formulation.gaps import GapFields
from contact.formulation.problem import Problem
from contact.formulation.relief import Relief, ScaledRelief
from contact.formulation.tables import begun_from, gaps_between
from contact.formulation.units import Units
from contact.model.scene import Scene
from contact.search.topology import gap_form, pressure_form
from contact.search.topology.failure import Failure
from contact.search.topology.loop import NewtonSettings, refine_topology
from contact.solver import solve
from contact.verify.error import SolvedZones

Array = NDArray[np.float64]


def scaled(scene: Scene) -> Problem:
    """The problem of a periodic scene in scaled units."""
    profile = scene.profile
    assert profile.period is not None
    x = profile.x0 + profile.period * np.arange(1024) / 1024
    units = Units(
        profile.x0 + 0.5 * profile.period,
        profile.period,
        float(np.abs(profile.slope(x)).max()),
        scene.E_star,
    )
    return Problem(
        profile,
        scene.interaction,
        scene.substrate,
        scene.law,
        units,
        float(np.min(profile.height(x))),
    )


def _mean_pressure(scene: Scene) -> float:
    """Mean pressure [Pa] of a scene that prescribes the mean pressure or the load."""
    assert scene.period is not None
    if scene.mean_pressure is not None:
        return scene.mean_pressure
    assert scene.load is not None
    return scene.load / scene.period


def _in_cell(table: Array, scene: Scene) -> tuple[Array, NDArray[np.intp]]:
    """(intervals shifted into the cell of the profile and sorted, their indices before sorting).

    The left ends lie in [x0, x0 + L), where x0 is the start of the cell and L the period.
    """
    assert scene.period is not None
    table = begun_from(table, scene.profile.x0, scene.period)
    order = np.argsort(table[:, 0])
    return table[order], order


@dataclass(frozen=True, eq=False)
class Formulated:
    """A solved periodic contact in SI units; its zones lie in the cell of the profile.

    `order` gives for every zone its number in `fields`.
    """

    fields: GapFields | ZoneFields
    zones: Array
    order: NDArray[np.intp]
    error: float

    @property
    def load(self) -> float:
        return self.fields.load

    @property
    def max_pressure(self) -> float:
        return self.fields.max_pressure

    def pressure_at(self, t: ArrayLike, zone: int = 0) -> Array:
        return np.asarray(self.fields.pressure_at(int(self.order[zone]), t))

    def pressure(self, x: ArrayLike) -> Array:
        return np.asarray(self.fields.pressure(x))


def solved_by_gaps(scene: Scene, moved: float = 1e-3, tol: float = 2e-15) -> Formulated:
    """Solve a scene with the slope of the gap as the unknown.
    Raises NotConverged if the iteration fails.
    """
    problem = scaled(scene)
    units = problem.units
    assert problem.period is not None
    start = units.scaled(solve(scene, 1e-6).zones)
    gaps = gaps_between(start, problem.period)
    gaps += moved * np.minimum(np.diff(gaps, axis=1), np.diff(start, axis=1).min()) * [[-1.0, 1.0]]

    relief = ScaledRelief.of(Relief(scene.profile, scene.operator), problem)
    mean = _mean_pressure(scene) / units.pressure
    form = gap_form.GapForm(problem, relief)
    found = refine_topology(
        form, Load(mean * problem.period), gaps, NewtonSettings(tol), formal=True
    )
    if isinstance(found, Failure):
        raise NotConverged("the gaps' formulation does not converge from these zones")
    fields = found.fields
    zones, order = _in_cell(np.asarray(units.x(fields.zones)), scene)
    return Formulated(fields, zones, order, found.error)


def solved_by_zones(scene: Scene, moved: float = 1e-3, tol: float = 2e-15) -> Formulated:
    """Solve a scene with the pressure on the contact zones as the unknown."""
    problem = scaled(scene)
    units = problem.units
    assert problem.period is not None
    start = units.scaled(solve(scene, 1e-6).zones)
    gaps = np.diff(gaps_between(start, problem.period))[:, 0]
    start = start + moved * np.column_stack((np.roll(gaps, 1), -gaps))
    # All zones must lie in one cell of the period. Therefore the border of the cell is put into the
    # widest gap.
    turn = (
        int(
            np.argmax(
                np.diff(np.append(start[:, 0], start[0, 0] + problem.period))
                - np.diff(start, axis=1)[:, 0]
            )
        )
        + 1
    )
    start = np.roll(start, -turn, axis=0)
    start = start + np.where(start[:, :1] < start[0, 0], problem.period, 0.0)
    load = _mean_pressure(scene) * problem.period * units.length / units.load
    found = refine_topology(
        pressure_form.PressureForm(problem), Load(load), start, NewtonSettings(tol)
    )
    assert isinstance(found, SolvedZones)
    zones, order = _in_cell(np.asarray(units.x(found.free.density.zones.table)), scene)
    return Formulated(found.fields, zones, order, found.error)
