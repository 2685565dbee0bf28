"""Full contact, and what is refused because of where it begins."""

import math

import numpy as np

from contact.errors import OutOfRange
from contact.formulation.controls import Control
from contact.formulation.fields import mean_shape
from contact.formulation.problem import Problem
from contact.model.controls import Quantity
from contact.search.context import SolveContext
from contact.solution.assemble import mean_height
from sie import record


@record
class Full:
    """Full contact under a mean pressure [Pa]."""

    mean_pressure: float


def smallest_full(context: SolveContext) -> Full:
    """Under the smallest mean pressure; OutOfRange where there is none, or none that could be told."""
    pressure = context.full.pressure
    if math.isfinite(pressure):
        return Full(pressure)
    if context.full.approached and not context.operator.has_inverse:
        raise OutOfRange(no_inverse(context, "full contact is not known"))
    raise OutOfRange(
        "no load brings this scene into full contact: its valleys have kinks, or the model has none"
    )


def no_inverse(context: SolveContext, what: str) -> str:
    name = context.scene.interaction.name
    return (
        f"{what}: the interaction {name!r} gives a kernel and no symbol, so the pressure that flattens the surface cannot be told. "
        "Give it a `symbol`, or ask for less contact"
    )


def full_under(context: SolveContext, control: Control, but_for_kinks: bool = False) -> Full | None:
    """Full contact, if the load, or the approach of a body with a base, is that of it or above.
    but_for_kinks: or where nothing is left of it but gaps over kinks of valleys, narrower than
    digits tell.
    """
    scene = context.scene
    if not (context.full.is_known if but_for_kinks else context.full.possible):
        return None
    held = control.approach if scene.given_load is None else control.load
    mean_pressure = None if held is None else closed_pressure(context)
    return (
        None
        if mean_pressure is None or mean_pressure < context.full.onset_pressure
        else Full(mean_pressure)
    )


def closed_pressure(context: SolveContext) -> float | None:
    """Mean pressure [Pa] of surfaces that are closed over the whole period, under the scene's
    control; None where that does not tell it: an approach does where the substrate has a base, or a
    spring is between.
    """
    scene, period, approach = (
        context.scene,
        context.scene.profile.period,
        context.scene.held(Quantity.APPROACH),
    )
    if period is None:
        return None
    if scene.given_load is not None:
        return scene.given_load / period if scene.mean_pressure is None else scene.mean_pressure
    # Beyond the mean of the profile the base gives way to a uniform pressure, and the spring to the
    # load.
    give = (
        2 * (context.operator.compression or 0.0) / scene.E_star
        + (context.spring_compliance or 0.0) * period
    )
    return None if approach is None or give == 0.0 else (approach - mean_height(scene)) / give


def closed(context: SolveContext) -> Full:
    """Surfaces that adhesion has closed over the whole period; OutOfRange where the control does
    not tell their pressure.
    """
    mean_pressure = closed_pressure(context)
    if mean_pressure is None:
        raise OutOfRange(
            "the surfaces close altogether, and in full contact the approach does not tell the load: give a load"
        )
    return Full(mean_pressure)


def refuse_full_approach(context: SolveContext, problem: Problem, control: Control) -> None:
    """OutOfRange for an approach that is that of full contact or above it, or that no load has."""
    if control.approach is None:
        return
    scene, units = context.scene, problem.units
    datum, support = context.operator.datum, scene.profile.support
    upright = scene.is_flat and not scene.turned
    # A punch as wide as four times the datum has that of a line load there: no load lowers it.
    if (
        datum is not None
        and context.operator.is_plain
        and support is not None
        and upright
        and support[1] - support[0] >= 4 * datum
    ):
        raise OutOfRange(
            f"approach {control.approach * units.height:.6g} m: a flat punch of width {support[1] - support[0]:.6g} m has none above zero "
            f"with a datum of {datum:.6g} m"
        )
    if (
        not context.full.approached
        or (context.operator.has_inverse and not context.full.possible)
        or context.operator.compression
    ):
        return
    # Without a base u has no mean: the mean gap is that of the profile less the approach.
    highest = mean_shape(problem)
    # Both are differences from the lowest point, rounded as heights are.
    rounding = (
        8.0 * float(np.finfo(np.float64).eps) * (highest + abs(problem.lowest) / units.height)
    )
    if control.approach >= highest - rounding:
        raise OutOfRange(
            f"approach {control.approach * units.height:.15g} m is not below {highest * units.height:.15g} m, the mean of "
            "the profile: there it is in full contact, at any load above the smallest, or as near to it as digits of the approach tell"
        )
