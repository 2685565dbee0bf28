"""The predictor of the residuals of the ends of many zones as they move on from one state.

If an end advances by s while the others stay, the gap that was open there closes. If the end
recedes, the pressure that was there is released. Near the end, the closed gap or the released
pressure acts like a load on the faces of a crack, and the edge intensity K is an Abel integral
(J. R. Rice, Int. J. Solids Struct. 8, 1972, 751, doi 10.1016/0020-7683(72)90040-6),

    K(s) = (1/pi) int_0^s h(y)/sqrt(y (s - y)) dy = (2/pi) int_0^(pi/2) h(s sin^2 theta) d theta.

Here h(y)/sqrt(y) is the slope of the gap, or the pressure, at the distance y from the first
position of the end. The contribution of the other ends is approximated as linear in their motion.
Both approximations require that s is small compared with the zone or the gap. The state at the end
of a step shows the error of the prediction.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from scipy.interpolate import CubicSpline

from contact.adhesion.curve import Curve, State
from contact.adhesion.options import MOVES
from contact.formulation.fields import ZoneFields
from sie import Array, Kept, Mask, record


@dataclass(frozen=True)
class PredictorOptions:
    """Options of the prediction of the residuals of moving ends."""

    # Number of points on the predicted path of an end. They are evenly spaced in the square root of
    # the distance from the start of the path.
    places: int = 64
    # Least number of points of an end's path in each feature of the profile. It limits the length
    # of the path.
    places_per_feature: int = 4


_OPTIONS = PredictorOptions()


def _parts() -> Array:
    """Positions (`_OPTIONS.places` + 1,) along an end's path, as fractions of the path length."""
    return (np.arange(_OPTIONS.places + 1) / _OPTIONS.places) ** 2


@record
class Predictor(Kept):
    """Residuals of all ends as functions of the distance that each end itself moves.

    A drive is the residual of an end in the direction of its motion.

    farthest: largest distance that each end may move (2n,). driven: drive of each end at the start
    and at the places on its path (2n, 1 + places). by_others: change of the drive of each end by a
    unit motion of each other end (2n, 2n). creep: largest distance that an end moves if its drive
    is small (2n,).
    """

    farthest: Array
    driven: Array
    by_others: Array
    creep: Array

    @classmethod
    def of(cls, curve: Curve, here: State, fields: ZoneFields, sign: float) -> Predictor:
        """The predictor at the state `here`, for outward (sign 1) or inward (-1) motions of ends.

        `farthest` is so small that the places on a path resolve the features of the profile.
        """
        wanted = curve.problem.end.intensity
        assert wanted is not None
        gaps = curve.gaps(here.table)
        farthest = MOVES.max_move * here.widths
        if sign > 0:
            lo, hi = curve.problem.borders
            room = MOVES.max_move * np.concatenate((np.roll(gaps, 1), gaps))
            room[0], room[-1] = (
                min(room[0], here.table[0, 0] - lo),
                min(room[-1], hi - here.table[-1, 1]),
            )
            farthest = np.minimum(farthest, room)
        farthest = np.minimum(
            farthest, _OPTIONS.places / (2 * _OPTIONS.places_per_feature) * curve.problem.detail
        )
        first = sign * here.residual
        driven = sign * (1.0 - _minus_intensity(fields, here, sign, farthest) / abs(wanted))
        linear = first[:, None] + (np.diag(here.rates) * farthest)[:, None] * _parts()[1:]
        deviation = driven[:, :1] - linear[:, :1]
        driven = np.where(np.abs(deviation) < MOVES.small_drive, driven - deviation, linear)
        return cls(
            farthest,
            np.column_stack((first, driven)),
            here.rates - np.diag(np.diag(here.rates)),
            MOVES.short_move * here.widths,
        )

    @property
    def first(self) -> Array:
        """Residual (2n,) of each end at the start of its path; positive if it drives the motion."""
        return self.driven[:, 0]

    @cached_property
    def held_back(self) -> Array:
        """Change (2n,) of each end's drive by those other ends that reduce it; at most 0.

        Every other end is moved as far as it would go alone.
        """
        return np.asarray(
            np.minimum(self.by_others, 0.0) @ self._distances_to_zero(np.zeros(len(self.first)))
        )

    @property
    def size(self) -> Array:
        """Scale (2n,) of each residual's tolerance: the residual at the start, at least 1."""
        return np.maximum(1.0, self.first)

    def step(self, limit: Array) -> Array:
        """Distance (2n,) that each end moves in the predicted step.

        The end stops where its predicted residual is small, or at its limit.
        """
        soft = self.first < MOVES.small_drive
        left = np.where(soft, 0.5 * np.maximum(self.first, 0.0), MOVES.small_drive * self.size)
        return np.minimum(
            self._distances_to_zero(self.held_back - left),
            np.where(soft, np.minimum(limit, self.creep), limit),
        )

    def _distances_to_zero(self, more: Array) -> Array:
        """Distance (2n,) that each end moves until its residual plus `more` (2n,) is first zero.

        It is `farthest` if this sum stays positive.
        """
        left = self.driven + more[:, None]
        rests, row = left <= 0.0, np.arange(len(left))
        k = np.where(rests.any(axis=1), np.argmax(rests, axis=1), _OPTIONS.places)
        high, low = left[row, np.maximum(k - 1, 0)], left[row, k]
        # Linear interpolation puts the zero just before the first place where the residual is not
        # positive. If this place is the start, the zero is the start.
        part = np.where(
            low > 0.0,
            1.0,
            np.divide(high, high - low, out=np.zeros(len(k)), where=high > np.maximum(low, 0.0)),
        )
        before = _parts()[np.maximum(k - 1, 0)]
        return np.asarray(self.farthest * (before + part * (_parts()[k] - before)))

    def astray(self, step: Array, driven: Array) -> Mask:
        """Mask (2n,) of the ends whose residual after a step was predicted wrongly."""
        alone = [
            np.interp(part, _parts(), own)
            for part, own in zip(step / self.farthest, self.driven, strict=True)
        ]
        least = np.array(alone) + self.held_back
        most = least + np.maximum(self.by_others, 0.0) @ step
        past = driven < 1.1 * np.minimum(self.first, 0.0) - MOVES.short_move * MOVES.small_drive
        return np.asarray(
            past
            | (driven < least - MOVES.small_drive * self.size)
            | (driven > most + MOVES.hard_drive * self.size)
        )

    def closes(self, gap: Array, adjacent: Array) -> Mask:
        """Mask (n,) of the zones whose gap on the right will close.

        adjacent: width of the narrower one of the two zones next to each gap.
        """
        left, right = np.split(self.driven.min(axis=1) + self.held_back > MOVES.hard_drive, 2)
        far_left, far_right = np.split(self.farthest, 2)
        known = (far_right >= 0.5 * gap) & (np.roll(far_left, -1) >= 0.5 * gap)
        return np.asarray((gap < MOVES.max_move * adjacent) & known & right & np.roll(left, -1))


def _minus_intensity(fields: ZoneFields, here: State, sign: float, farthest: Array) -> Array:
    """Minus the edge intensity K (2n, points) that each end would have at points of its path.

    The path leads outward for `sign` > 0, else inward.
    """
    at, outward = here.table.T.ravel()[:, None], np.repeat((-1.0, 1.0), len(here.table))[:, None]
    root = np.sqrt(farthest[:, None] * _parts())
    places = at + sign * outward * root**2
    of_gap, of_pressure = _abel()
    if sign > 0:
        gap = fields.formal_gap(places.ravel()).reshape(root.shape)
        gap[:, 0] = 0.0
        return np.asarray(gap @ of_gap.T / root[:, -1:])
    singular = np.empty(root.shape)
    singular[:, 1:] = -root[:, 1:] * fields.formal_pressure(places[:, 1:].ravel()).reshape(
        len(root), -1
    )
    singular[:, 0] = -np.concatenate(fields.density.intensities)
    return np.asarray(singular @ of_pressure.T)


@cache
def _abel() -> tuple[Array, Array]:
    """Two matrices that give the edge intensity K: one from the gap, one from the pressure.
    The pressure is multiplied by the square root of the distance from the end.

    The gap or pressure is given at the places on the path. The first matrix still has to be divided
    by the square root of the farthest distance.
    """
    part = np.sqrt(_parts())
    node, weight = np.polynomial.legendre.leggauss(_OPTIONS.places)
    at = part[1:, None] * np.sin(0.25 * np.pi * (1 + node))
    unit = CubicSpline(part, np.eye(len(part)))
    # The slope of the gap is written h/sqrt(y), with the distance y from the end. So h is half of
    # d gap / d sqrt(y).
    mean = [
        np.einsum("jmk,m->jk", values, 0.5 * weight) for values in (0.5 * unit(at, 1), unit(at))
    ]
    return mean[0], mean[1]
