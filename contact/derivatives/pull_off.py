"""Derivatives of the pull-off load under edge intensities that a law prescribes.

Let the matrix M hold the derivatives of the edge intensities by motions of the ends. At pull-off
the load P is least along the branch. So some motion x of the ends leaves the intensities as they
are: M x = 0. Let y be the left null vector, y M = 0. On the present zones, a change of the profile
changes the intensities by k_f, and a change dP of the load by k_P dP. Motions of the ends can
restore the intensities only if y (k_f + k_P dP) = 0. This gives the change dP of the pull-off load.
"""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np

import sie
from contact.derivatives.rates import changed, held
from contact.errors import SceneError
from contact.formulation.controls import Load
from contact.formulation.fields import ZoneFields
from contact.formulation.tolerances import TOLERANCES
from contact.model.controls import Quantity
from contact.model.profiles.base import Profile
from contact.model.profiles.noise import EPS
from contact.solution.solution import Solution
from sie import Array


class Fold(NamedTuple):
    """Null vectors of a matrix M at or near pull-off, and numbers computed from them.
    M holds the derivatives of the edge intensities by motions of the ends. left: y with y M = 0.
    right: x with M x = 0. rest: y M x. by_load: derivatives of the intensities by the load.
    """

    zones: sie.Zones
    left: Array
    right: Array
    rest: float
    by_load: Array


class PullOffRates(sie.Kept):
    """The derivatives of the pull-off load of one solution."""

    def __init__(self, solution: Solution) -> None:
        scene, fields = solution.scene, solution.fields
        held_quantity = scene.control_object.held(scene)
        if held_quantity is None or held_quantity.quantity is not Quantity.LOAD:
            raise SceneError(
                "derivatives of the pull-off load are available only if the scene gives the load "
                "or the mean pressure",
                "number",
                "pull_off",
            )
        last = solution.pull_off
        if last is None or not isinstance(fields, ZoneFields):
            raise SceneError("this contact has no pull-off load", "number", "pull_off")
        self.problem, self.load = fields.problem, last.load
        if self.problem.corners != (-np.inf, np.inf):
            raise SceneError(
                "derivatives of the pull-off load are not available for a profile with sharp "
                "corners at its ends",
                "number",
                "pull_off",
            )
        self._table = np.asarray(self.problem.units.scaled(last.zones))
        self.relative = solution.error

    def _fold(self, moved: Array) -> Fold:
        """The `Fold` on the zones of pull-off, with ends moved outward by `moved` (2, n)."""
        problem = self.problem
        zones = sie.Zones.of(self._table, problem.end, problem.end).moved(moved)
        load = Load(self.load / problem.units.load)
        state = sie.solve_zones(problem.equation(load), zones, TOLERANCES.rounding).whole
        matrix = sie.end_rates(state).intensities
        left, _, right = np.linalg.svd(matrix)
        y, x = left[:, -1], right[-1]
        by_load = np.concatenate(state.response(state.values()).intensities)
        return Fold(zones, y, x, float(y @ matrix @ x), by_load)

    @cached_property
    def _folds(self) -> tuple[Fold, Fold, float]:
        """(fold at pull-off, a second fold beside it, relative position error of the first fold).
        The error is the distance of the first fold from exact pull-off, divided by the distance
        between the two folds.
        """
        here = self._fold(np.zeros((2, len(self._table))))
        motion = here.right.reshape(2, -1)
        # With this step, the round-off and the truncation error of the difference are much smaller
        # than the difference.
        step = EPS ** (1 / 4) * float(here.zones.half.min()) / float(np.abs(motion).max())
        beside = self._fold(step * motion)
        # The signs of null vectors are arbitrary. `sign` makes those of the two folds agree.
        sign = float(np.sign(here.left @ beside.left) * np.sign(here.right @ beside.right))
        away = sign * beside.rest - here.rest
        return here, beside, abs(here.rest / away) if away else np.inf

    def along(self, direction: Profile) -> tuple[float, float]:
        """(derivative, error) of the pull-off load [N/m] along a change of the profile."""
        here, beside, part = self._folds
        value, other = self._at(here, direction), self._at(beside, direction)
        error = TOLERANCES.margin * part * abs(other - value) + 2 * self.relative * abs(value)
        return value, error + TOLERANCES.closed_form_rounding * abs(self.load)

    def _at(self, fold: Fold, direction: Profile) -> float:
        problem = changed(self.problem, direction, 0.0)
        zones = held(fold.zones)
        state = sie.solve_zones(problem.equation(Load(0.0)), zones, TOLERANCES.rounding)
        by_shape = np.concatenate(state.density.intensities)
        rate = -float(fold.left @ by_shape) / float(fold.left @ fold.by_load)
        return rate * problem.units.load
