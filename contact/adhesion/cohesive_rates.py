"""Rates of a state under a cohesive law: derivatives by the ends of the intervals of tension.

The residual of an end c is r = 1 - gap(c)/h. Its derivatives include the motion of the zones.
Moving an end of the tension adds a point source at c. To first order the response is the density of
fixed zones with singular ends. Its intensities K move the ends of the zones by 2 K/A, with the edge
slope A of the pressure.
"""

from typing import NamedTuple

import numpy as np

import sie
from contact.adhesion.deformed_profile import TractionLoaded
from contact.adhesion.inner_contact import edge_slopes
from contact.formulation.controls import Control
from sie import Array, Mask


class EndRates(NamedTuple):
    """Derivatives by the 2n ends of the tension and by the value of the control.

    residual (2n, 2n), by_value (2n,): of the residuals, by the ends and by the value. zones
    (2Z, 2n + 1), level (2n + 1,): of the ends of the Z zones and of the level, by both.
    """

    residual: Array
    by_value: Array
    zones: Array
    level: Array


def yields_of(control: Control) -> float:
    """Change of the control's value per unit of load: 1, or the compliance of a spring, or 0.
    It is 1 if the load is the control, and 0 if the approach is.
    """
    return 1.0 if control.load is not None else float(control.yields or 0.0)


def contact_rates(
    pulled: TractionLoaded, state: sie.State, control: Control, reach: float, is_open: Mask
) -> EndRates:
    """The rates of a state with contact; `state` solves the equation of the contact pressure.

    is_open: mask (2n,) of the ends of the tension with a gap, which are not at sharp corners.
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
    """Responses of the contact pressure to motions of the ends `free` and to the control."""
    stress = pulled.pulling.stress
    strengths = np.hstack((stress * np.eye(len(free)), np.zeros((len(free), 1))))
    values = np.zeros((len(state.condition_scale), len(free) + 1))
    first = state.condition_index[0]
    if control.load is not None:
        values[first, :-1], values[first, -1] = stress, 1.0
    else:
        # Under a fixed approach, the right side of each zone's side condition is minus the value of
        # the control for the contact pressure. `values` holds the derivatives of this right side
        # by the free ends and by the value of the control.
        values[first : first + len(state.density.zones)] = np.append(
            np.full(len(free), -yields_of(control) * stress), -1.0
        )
    return sie.answers(state, free, strengths, values, free)


def own_gap_rates(pulled: TractionLoaded, at: Array, transform: Array) -> Array:
    """Derivatives of the gap at the tension's ends by outward displacements of these ends.
    The contact pressure q is held fixed.

    transform: the kernel's transform of the contact pressure q at the ends.
    """
    tension, stress, count = pulled.pulling, pulled.pulling.stress, len(at) // 2
    lag = at[:, None] - at
    np.fill_diagonal(lag, 1.0)
    between = stress / np.pi * tension.log(lag)
    # Only the other ends contribute to the slope of the gap at an end. The singular
    # contributions of the end itself and of its motion cancel.
    slopes = stress / np.pi * tension.logs(at) * np.concatenate((np.ones(count), -np.ones(count)))
    np.fill_diagonal(slopes, 0.0)
    away = np.concatenate((-np.ones(count), np.ones(count)))
    np.fill_diagonal(between, away * (pulled.own_slope(at) - transform + slopes.sum(axis=1)))
    return between
