"""Ends of zones go down the slope of the energy, each as far as it is driven: what a contact comes
to that has lost its equilibrium.

Under a held load ends only gain by what others do, and `flow` takes them one way, without turning
back. Under a held approach they do not: the tension that is lost where a zone recedes raises the
surface of a period elsewhere, where others advance, or begin. There the steps are those of the
implicit Euler method for D ds/dt = r, r the slope of the energy and D what is given way to: as long
as the limits let them, ever nearer to Newton's. So the energy falls, and where the ends come to
rest they are stable.
"""

import numpy as np

from contact.adhesion import gradient_flow
from contact.adhesion.curve import Equilibria, Point
from contact.adhesion.nucleation import with_new
from contact.errors import NotConverged
from contact.verify.certificate import openings
from sie import Array

# A zone narrower than this part of what it was has come apart.
_GONE = 0.02
# What steps are damped by at first, over what drives the ends.
_DAMPED = 1e-3
# How far past the least energy a step may go, in the slope there over that at its start.
_PAST = 0.1


def relaxed(curve: Equilibria, table: Array, value: float) -> Point | None:
    """The stable equilibrium that ends come to from these zones under a value of the control; None:
    all have come apart. `Closed` if the surfaces close altogether.
    """
    here = curve.at(table, value, gradient_flow.ROUGH)
    widest = np.diff(here.table, axis=1)[:, 0]
    for _ in range(gradient_flow.MOST_STEPS):
        changed = _changed(curve, here, widest)
        if changed is None:
            here, step = _step(curve, here)
            widest = np.maximum(widest, np.diff(here.table, axis=1)[:, 0])
            if (
                float(np.abs(step / here.widths).max()) > gradient_flow.REST
                or float(np.abs(here.residual).max()) > gradient_flow.SLIGHT
            ):
                continue
            # Looked for here alone: what overlaps on the way costs as much as many steps to see,
            # and may part again.
            overlaps = curve.within(openings(curve.fields(here, gradient_flow.ROUGH)).overlaps)
            if len(overlaps) == 0:
                if here.growth < 0.0:
                    return here
                break
            changed = with_new(here.table, overlaps)
        if len(changed) == 0:
            return None
        widest = _carried(here.table, widest, changed)
        here = curve.at(changed, value, gradient_flow.ROUGH)
    raise NotConverged("the ends of zones did not come to rest under a held control")


def _changed(curve: Equilibria, here: Point, widest: Array) -> Array | None:
    """The zones without gaps that have closed, or without those that have come apart; None if
    nothing of that has happened.
    """
    merged = gradient_flow.closing(curve, here)
    if merged is not None:
        return merged
    apart = np.logical_and(*np.split(here.residual < -gradient_flow.DRIVEN, 2)) & (
        np.diff(here.table, axis=1)[:, 0] < _GONE * widest
    )
    return np.asarray(here.table[~apart]) if apart.any() else None


def _carried(before: Array, widest: Array, table: Array) -> Array:
    """The largest widths of zones after some have met, come apart or begun."""
    width = np.diff(table, axis=1)[:, 0]
    own = [
        float(widest[(before[:, 0] < b) & (before[:, 1] > a)].max(initial=0.0)) for a, b in table
    ]
    return np.maximum(width, own)


def _step(curve: Equilibria, here: Point) -> tuple[Point, Array]:
    """(next state, step)."""
    inward, outward = gradient_flow.inward_and_outward(curve, here)
    damped = np.full(len(here.residual), _DAMPED)
    for _ in range(gradient_flow.MOST_TRIES):
        step = here.damped_step(damped)
        # Those that would go too far alone: a zone that comes apart need not keep back all others.
        far = np.abs(step) > np.where(step > 0.0, outward, inward)
        if far.any():
            damped[far] *= 2.0
            continue
        ahead = curve.at(here.moved(step), here.value, gradient_flow.ROUGH)
        if ahead.residual @ step >= -_PAST * (here.residual @ step):
            return ahead, step
        damped *= 4.0
    raise NotConverged("no step of the ends goes down the slope of the energy")
