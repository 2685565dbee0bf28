"""The energy descent: steps of the ends of zones along which the energy falls.

Under a fixed load, an end that moves drives all other ends the same way. The gradient flow
(contact.adhesion.gradient_flow) then moves all ends in one direction. Under a fixed approach in
periodic contact, a zone that recedes lets the surfaces come closer elsewhere. Other zones advance
or begin there. The steps are then those of the implicit Euler method for D ds/dt = r. Here s are
the positions of the ends, D is a diagonal damping, and the residual r is a descent direction of the
energy. The steps are as long as the limits allow and approach Newton steps. The energy falls, so
that the equilibrium at the end is stable.
"""

import numpy as np

from contact.adhesion import gradient_flow
from contact.adhesion.curve import ACCURACY, Curve, State
from contact.adhesion.nucleation import with_new
from contact.adhesion.options import LIMITS, MOVES
from contact.errors import NotConverged
from contact.verify.certificate import openings
from sie import Array


def relaxed(curve: Curve, table: Array, value: float) -> State | None:
    """The stable equilibrium that is reached from given zones under a value of the control.

    None if all zones are lost. Raises `Closed` if the surfaces close altogether.
    """
    here = curve.at(table, value, ACCURACY.rough)
    widest = np.diff(here.table, axis=1)[:, 0]
    for _ in range(LIMITS.max_steps):
        changed = _changed(curve, here, widest)
        if changed is None:
            here, step = _step(curve, here)
            widest = np.maximum(widest, np.diff(here.table, axis=1)[:, 0])
            if (
                float(np.abs(step / here.widths).max()) > ACCURACY.resting_step
                or float(np.abs(here.residual).max()) > ACCURACY.coarse
            ):
                continue
            # Overlaps are searched for only after the ends have converged. A search costs as much
            # as many steps, and overlaps of moving surfaces may vanish again.
            overlaps = curve.within(openings(curve.fields(here, ACCURACY.rough)).overlaps)
            if len(overlaps) == 0:
                if here.growth < 0.0:
                    return here
                break
            changed = with_new(here.table, overlaps)
        if len(changed) == 0:
            return None
        widest = _largest_widths(here.table, widest, changed)
        here = curve.at(changed, value, ACCURACY.rough)
    raise NotConverged(
        "the ends of the zones did not reach a stable equilibrium at a fixed value of the control"
    )


def _changed(curve: Curve, here: State, widest: Array) -> Array | None:
    """The zones, joined across closed gaps or without lost zones; None if nothing changed."""
    merged = gradient_flow.closing(curve, here)
    if merged is not None:
        return merged
    apart = np.logical_and(*np.split(here.residual < -MOVES.hard_drive, 2)) & (
        np.diff(here.table, axis=1)[:, 0] < MOVES.vanished * widest
    )
    return np.asarray(here.table[~apart]) if apart.any() else None


def _largest_widths(before: Array, widest: Array, table: Array) -> Array:
    """Largest width so far of each zone, after some zones have merged, vanished or begun."""
    width = np.diff(table, axis=1)[:, 0]
    own = [
        float(widest[(before[:, 0] < b) & (before[:, 1] > a)].max(initial=0.0)) for a, b in table
    ]
    return np.maximum(width, own)


def _step(curve: Curve, here: State) -> tuple[State, Array]:
    """(state after the next step down the slope of the energy, step of the ends)."""
    inward, outward = gradient_flow.inward_and_outward(curve, here)
    damped = np.full(len(here.residual), ACCURACY.coarse)
    for _ in range(LIMITS.max_iterations):
        step = here.damped_step(damped)
        # Damping is increased only for ends that would move too far. So a zone that separates does
        # not slow down the other zones.
        far = np.abs(step) > np.where(step > 0.0, outward, inward)
        if far.any():
            damped[far] *= 2.0
            continue
        ahead = curve.at(here.moved(step), here.value, ACCURACY.rough)
        if ahead.residual @ step >= -MOVES.small_drive * (here.residual @ step):
            return ahead, step
        damped *= 4.0
    raise NotConverged("no step of the zone ends was found that lowers the energy")
