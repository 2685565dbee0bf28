"""The energy descent: where ends may drive each other back, they go down the slope of the energy.

Under a held load an end that moves only helps the others, and the gradient flow
(contact.adhesion.gradient_flow) moves all ends one way. Under a held approach it does not:
tension that is lost where a zone recedes raises the surface of a period elsewhere, where others
advance, or begin. There the steps are those of the implicit Euler method for D ds/dt = r, r the
slope of the energy and D a diagonal damping. They are as long as the limits allow and approach
Newton's. The energy falls, and where the ends come to rest they are stable.
"""

import numpy as np

from contact.adhesion import gradient_flow
from contact.adhesion.curve import TOLERANCES, Curve, State
from contact.adhesion.gradient_flow import FLOW
from contact.adhesion.limits import LIMITS
from contact.adhesion.nucleation import with_new
from contact.errors import NotConverged
from contact.verify.certificate import openings
from sie import Array


def relaxed(curve: Curve, table: Array, value: float) -> State | None:
    """The stable equilibrium that ends reach from these zones under a value of the control.

    None if all have come apart. Raises `Closed` if the surfaces close altogether.
    """
    here = curve.at(table, value, TOLERANCES.rough)
    widest = np.diff(here.table, axis=1)[:, 0]
    for _ in range(LIMITS.max_steps):
        changed = _changed(curve, here, widest)
        if changed is None:
            here, step = _step(curve, here)
            widest = np.maximum(widest, np.diff(here.table, axis=1)[:, 0])
            if (
                float(np.abs(step / here.widths).max()) > TOLERANCES.resting_step
                or float(np.abs(here.residual).max()) > FLOW.resting_drive
            ):
                continue
            # Overlaps are searched for at rest only: on the way that costs as much as many steps,
            # and they may vanish again.
            overlaps = curve.within(openings(curve.fields(here, TOLERANCES.rough)).overlaps)
            if len(overlaps) == 0:
                if here.growth < 0.0:
                    return here
                break
            changed = with_new(here.table, overlaps)
        if len(changed) == 0:
            return None
        widest = _carried(here.table, widest, changed)
        here = curve.at(changed, value, TOLERANCES.rough)
    raise NotConverged("the ends of zones did not come to rest under a held control")


def _changed(curve: Curve, here: State, widest: Array) -> Array | None:
    """The zones with closed gaps joined, or without lost zones; None if neither happened."""
    merged = gradient_flow.closing(curve, here)
    if merged is not None:
        return merged
    apart = np.logical_and(*np.split(here.residual < -FLOW.hard_drive, 2)) & (
        np.diff(here.table, axis=1)[:, 0] < FLOW.lost_zone * widest
    )
    return np.asarray(here.table[~apart]) if apart.any() else None


def _carried(before: Array, widest: Array, table: Array) -> Array:
    """Largest width so far of each zone, after some have merged, vanished or begun."""
    width = np.diff(table, axis=1)[:, 0]
    own = [
        float(widest[(before[:, 0] < b) & (before[:, 1] > a)].max(initial=0.0)) for a, b in table
    ]
    return np.maximum(width, own)


def _step(curve: Curve, here: State) -> tuple[State, Array]:
    """(next state, step of the ends)."""
    inward, outward = gradient_flow.inward_and_outward(curve, here)
    damped = np.full(len(here.residual), FLOW.runaway_overshoot)
    for _ in range(LIMITS.max_bisections):
        step = here.damped_step(damped)
        # Only the ends that would go too far are damped more: a zone that comes apart need not
        # hold back the others.
        far = np.abs(step) > np.where(step > 0.0, outward, inward)
        if far.any():
            damped[far] *= 2.0
            continue
        ahead = curve.at(here.moved(step), here.value, TOLERANCES.rough)
        if ahead.residual @ step >= -FLOW.overshoot * (here.residual @ step):
            return ahead, step
        damped *= 4.0
    raise NotConverged("no step of the ends goes down the slope of the energy")
