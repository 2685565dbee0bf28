"""Rates of a state under a cohesive law: derivatives by the ends of the intervals of tension.

If an interval of tension ends at x = c, this end has the residual r = 1 - gap(c)/h, with the reach
h of the tension. The derivatives of r include the motion of the zones. A motion of the end adds a
point source at c. To first order, the contact pressure changes by the density that this source
causes on fixed zones with singular ends. At the distance d from the end of a zone, this density is
K/sqrt(d), and the contact pressure is A sqrt(d). So the end of the zone moves by 2 K/A.
"""

from typing import NamedTuple

import numpy as np

import sie
from contact.adhesion.deformed_profile import TractionLoaded
from contact.adhesion.inner_contact import edge_slopes
from contact.formulation.controls import Control
from sie import Array, Mask


class EndRates(NamedTuple):
    """Derivatives of a state by the 2n ends of its n intervals of tension and by the control.

    residual (2n, 2n): derivatives of the ends' residuals with respect to the ends. by_value (2n,):
    derivatives of the residuals with respect to the value of the control. zones (2Z, 2n + 1):
    derivatives of the ends of the Z zones. level (2n + 1,): derivatives of the level (minus the
    approach). In `zones` and `level`, the last column belongs to the control's value, the other
    columns to the ends of the intervals.
    """

    residual: Array
    by_value: Array
    zones: Array
    level: Array


def value_per_load(control: Control) -> float:
    """Change of the control's value per unit of load: 1, or the compliance of a spring, or 0.
    It is 1 if the load is the control, and 0 if the approach is.
    """
    return 1.0 if control.load is not None else float(control.compliance or 0.0)


def contact_rates(
    pulled: TractionLoaded, state: sie.State, control: Control, reach: float, is_open: Mask
) -> EndRates:
    """The rates of a state with contact; `state` solves the equation of the contact pressure.

    is_open: mask (2n,) of the ends of intervals of tension at which no zone ends. All other ends
    are pinned at sharp corners, together with the end of a zone.
    """
    at, density = pulled.pulling.table.T.ravel(), state.density
    free, ends, zones = at[is_open], np.flatnonzero(is_open), density.zones
    count, by_all = len(at), np.append(ends, len(at))
    answers = _answers(pulled, state, control, free)
    level = (
        np.append(np.zeros(len(free)), -1.0)
        if control.approach is not None
        else answers.levels.mean(axis=0)
    )
    change = level - answers.potentials
    transform, by_value = np.zeros(count), np.zeros(count)
    transform[is_open] = density.transform(free)
    by_ends = own_gap_rates(pulled, at, transform)
    by_ends[np.ix_(ends, ends)] += change[:, :-1]
    by_value[is_open] = change[:, -1]
    by_ends[~is_open], by_ends[:, ~is_open] = 0.0, 0.0
    of_level, of_zones = np.zeros(count + 1), np.zeros((2 * len(zones), count + 1))
    of_level[by_all] = level
    with np.errstate(divide="ignore"):
        moves = 2 * answers.intensities / edge_slopes(pulled, state)[:, :, None]
    moves[(zones.table == np.array(pulled.corners)).T] = 0.0
    of_zones[:, by_all] = moves.reshape(-1, len(by_all))
    return EndRates(-by_ends / reach, -by_value / reach, of_zones, of_level)


def _answers(
    pulled: TractionLoaded, state: sie.State, control: Control, free: Array
) -> sie.Answers:
    """Responses of the contact pressure to motions of ends of intervals of tension.
    The last response is that to the control.

    free: positions of the ends that move.
    """
    stress = pulled.pulling.stress
    strengths = np.hstack((stress * np.eye(len(free)), np.zeros((len(free), 1))))
    values = np.zeros((len(state.condition_scale), len(free) + 1))
    first = state.condition_index[0]
    if control.load is not None:
        values[first, :-1], values[first, -1] = stress, 1.0
    else:
        # Under a fixed approach, each zone has a side condition with the right side
        # -(value of the control + `value_per_load` * force of the tension). `values` holds the
        # derivatives of this right side with respect to the free ends and to the value.
        values[first : first + len(state.density.zones)] = np.append(
            np.full(len(free), -value_per_load(control) * stress), -1.0
        )
    return sie.answers(state, free, strengths, values, free)


def own_gap_rates(pulled: TractionLoaded, at: Array, transform: Array) -> Array:
    """Derivatives (2n, 2n) of the gap at the ends of the intervals of tension.
    They are with respect to outward displacements of these ends, for fixed contact pressure q.

    at: positions of the ends. transform: the kernel's transform of q at the ends.
    """
    tension, stress, count = pulled.pulling, pulled.pulling.stress, len(at) // 2
    lag = at[:, None] - at
    np.fill_diagonal(lag, 1.0)
    between = stress / np.pi * tension.log(lag)
    # `slopes` is the tension's part of the gap's slope at each end. Only the other ends contribute
    # to it. The singular contributions of the end itself and of its motion cancel.
    slopes = stress / np.pi * tension.logs(at) * np.concatenate((np.ones(count), -np.ones(count)))
    np.fill_diagonal(slopes, 0.0)
    away = np.concatenate((-np.ones(count), np.ones(count)))
    np.fill_diagonal(between, away * (pulled.own_slope(at) - transform + slopes.sum(axis=1)))
    return between
