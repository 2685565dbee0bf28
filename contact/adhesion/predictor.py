"""What ends of many zones are driven by as they move on, foretold by the state that they start
from.

If an end comes farther by s while the others stay, the gap that was open there is closed; if it
goes back, the pressure that was there is let go. Near the end either is a load on the faces of a
crack in a half-plane, whose intensity is an Abel integral (J. R. Rice, Int. J. Solids Struct. 8,
1972, 751, doi 10.1016/0020-7683(72)90040-6),

    K(s) = (1/pi) int_0^s h(y)/sqrt(y (s - y)) dy = (2/pi) int_0^(pi/2) h(s sin^2 theta) d theta,

h/sqrt(y) being the slope of the gap, or the pressure, at a distance y. What the others add by
moving is taken to be as here. Neither is exact where s is not small beside the zone or the gap: the
state that is come to says how much it was off.
"""

from __future__ import annotations

from functools import cache, cached_property

import numpy as np
from scipy.interpolate import CubicSpline

from contact.adhesion.curve import Equilibria, Point
from contact.formulation.fields import ZoneFields
from sie import Array, Kept, Mask, record

# Places along the way of an end, even in the root of the distance, and how many of them there are
# at the least to a detail of the profile.
_PLACES = 64
_TO_A_DETAIL = 4
# What ends are told to be driven by may be off by so much where they start, and by so much less or
# more where they come to, as others that come nearer drive them on; so much is left to drive them
# there, and those that are not driven by more go no farther than a part of their zones.
_OFF = 0.05
_LESS = 0.04
_MORE = 0.3
_LEFT = 0.05
_CREEP = 0.02
_PAST = 1e-3
# Of the zone and of the gap beside it, how far an end is told of. A gap closes that is narrower
# than its zones by this factor and both of whose ends are told to be driven by so much up to its
# middle.
_OF_ZONE = 0.5
_OF_GAP = 0.5
_NARROW = 0.5
_DRIVEN = 0.3
# Of Gauss's rule for an Abel integral.
_NODES = 40

# Of the farthest distance, where ends start and where they are told of.
_PARTS: Array = (np.arange(_PLACES + 1) / _PLACES) ** 2


@record
class Foretold(Kept):
    """farthest: how far it is told of ends (2n,); driven: what these are driven by onward where
    they start, and at even parts of the root of the distance, by themselves (2n, 1 + places);
    by_others: more by a motion of others (2n, 2n); creep: how far those go that are hardly driven
    (2n,).
    """

    farthest: Array
    driven: Array
    by_others: Array
    creep: Array

    @classmethod
    def of(cls, curve: Equilibria, here: Point, fields: ZoneFields, sign: float) -> Foretold:
        """As ends move outward, or inward where the sign is negative; no farther than the places
        tell all the detail of the profile.
        """
        wanted = curve.problem.end.intensity
        assert wanted is not None
        gaps = curve.gaps(here.table)
        farthest = _OF_ZONE * here.widths
        if sign > 0:
            lo, hi = curve.problem.borders
            room = _OF_GAP * np.concatenate((np.roll(gaps, 1), gaps))
            room[0], room[-1] = (
                min(room[0], here.table[0, 0] - lo),
                min(room[-1], hi - here.table[-1, 1]),
            )
            farthest = np.minimum(farthest, room)
        farthest = np.minimum(farthest, _PLACES / (2 * _TO_A_DETAIL) * curve.problem.detail)
        first = sign * here.residual
        driven = sign * (1.0 - _intensity(fields, here, sign, farthest) / abs(wanted))
        linear = first[:, None] + (np.diag(here.rates) * farthest)[:, None] * _PARTS[1:]
        off = driven[:, :1] - linear[:, :1]
        driven = np.where(np.abs(off) < _OFF, driven - off, linear)
        return cls(
            farthest,
            np.column_stack((first, driven)),
            here.rates - np.diag(np.diag(here.rates)),
            _CREEP * here.widths,
        )

    @property
    def first(self) -> Array:
        """What ends are driven by where they start (2n,)."""
        return self.driven[:, 0]

    @cached_property
    def held_back(self) -> Array:
        """What drives ends less, the others going as far as they do by themselves (2n,); not that
        these drive them on as well.
        """
        return np.asarray(np.minimum(self.by_others, 0.0) @ self._rests(np.zeros(len(self.first))))

    @property
    def size(self) -> Array:
        """What it is off by is counted in (2n,): what ends are driven by where they start, or by K*
        alone.
        """
        return np.maximum(1.0, self.first)

    def step(self, limit: Array) -> Array:
        """How far ends go on (2n,), within limits, with little left to drive them."""
        soft = self.first < _LEFT
        left = np.where(soft, 0.5 * np.maximum(self.first, 0.0), _LEFT * self.size)
        return np.minimum(
            self._rests(self.held_back - left), np.where(soft, np.minimum(limit, self.creep), limit)
        )

    def _rests(self, more: Array) -> Array:
        """How far ends go to where what drives them and more (2n,) is zero first."""
        left = self.driven + more[:, None]
        rests, row = left <= 0.0, np.arange(len(left))
        k = np.where(rests.any(axis=1), np.argmax(rests, axis=1), _PLACES)
        high, low = left[row, np.maximum(k - 1, 0)], left[row, k]
        # On a straight line to the first place where they are not driven any more, if there is one,
        # and they are driven at all.
        part = np.where(
            low > 0.0,
            1.0,
            np.divide(high, high - low, out=np.zeros(len(k)), where=high > np.maximum(low, 0.0)),
        )
        before = _PARTS[np.maximum(k - 1, 0)]
        return np.asarray(self.farthest * (before + part * (_PARTS[k] - before)))

    def astray(self, step: Array, driven: Array) -> Mask:
        """Which ends are driven otherwise than was foretold where they have come to by a step
        (2n,).
        """
        alone = [
            np.interp(part, _PARTS, own)
            for part, own in zip(step / self.farthest, self.driven, strict=True)
        ]
        least = np.array(alone) + self.held_back
        most = least + np.maximum(self.by_others, 0.0) @ step
        past = driven < 1.1 * np.minimum(self.first, 0.0) - _PAST
        return np.asarray(
            past | (driven < least - _LESS * self.size) | (driven > most + _MORE * self.size)
        )

    def closes(self, gap: Array, beside: Array) -> Mask:
        """Which gaps, right of each zone, of which the narrower of the zones beside them is so
        wide, will close.
        """
        left, right = np.split(self.driven.min(axis=1) + self.held_back > _DRIVEN, 2)
        far_left, far_right = np.split(self.farthest, 2)
        told = (far_right >= 0.5 * gap) & (np.roll(far_left, -1) >= 0.5 * gap)
        return np.asarray((gap < _NARROW * beside) & told & right & np.roll(left, -1))


def _intensity(fields: ZoneFields, here: Point, sign: float, farthest: Array) -> Array:
    """-K of ends at even parts of the root of the distance, outward or inward (2n, places)."""
    at, outward = here.table.T.ravel()[:, None], np.repeat((-1.0, 1.0), len(here.table))[:, None]
    root = np.sqrt(farthest[:, None] * _PARTS)
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
    """What makes K, at even parts of the root of the farthest distance, of the gap at these over
    that root, and of h there.
    """
    part = np.sqrt(_PARTS)
    node, weight = np.polynomial.legendre.leggauss(_NODES)
    at = part[1:, None] * np.sin(0.25 * np.pi * (1 + node))
    unit = CubicSpline(part, np.eye(len(part)))
    # h is half of the derivative of the gap by the root of the distance.
    mean = [
        np.einsum("jmk,m->jk", values, 0.5 * weight) for values in (0.5 * unit(at, 1), unit(at))
    ]
    return mean[0], mean[1]
