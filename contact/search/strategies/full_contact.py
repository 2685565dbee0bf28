"""Full contact: the pressure at which it begins, and checks whether a control leads to it."""

import math

from contact.errors import OutOfRange
from contact.formulation.controls import Control
from contact.formulation.fields import mean_shape
from contact.formulation.problem import Problem
from contact.model.controls import Quantity
from contact.model.profiles.noise import EPS
from contact.search.context import SolveContext
from contact.solution.assemble import mean_height
from sie import record


@record
class Full:
    """Full contact under a mean pressure [Pa]."""

    mean_pressure: float


def smallest_full(context: SolveContext) -> Full:
    """Full contact under the smallest mean pressure; raises OutOfRange if there is none."""
    pressure = context.full.pressure
    if math.isfinite(pressure):
        return Full(pressure)
    if context.full.approached and not context.operator.has_inverse:
        raise OutOfRange(no_inverse(context, "the load of full contact is unknown"))
    raise OutOfRange(
        "no load brings this scene into full contact: its profile has kinks in valleys or sharp "
        "corners, or its interaction or law has no full contact"
    )


def no_inverse(context: SolveContext, what: str) -> str:
    """The error message for an interaction with a kernel but no symbol (Fourier representation)."""
    name = context.scene.interaction.name
    return (
        f"{what}: the interaction {name!r} gives a kernel and no symbol, "
        "so that the pressure that flattens the surface cannot be computed. "
        "Define its `symbol`, or give a control with less contact"
    )


def full_under(context: SolveContext, control: Control, but_for_kinks: bool = False) -> Full | None:
    """Full contact if the given load or approach is large enough for full contact, else None.

    With closed surfaces, the load or approach would cause a certain mean pressure. Contact is full
    if this pressure is at least the one at which full contact begins. but_for_kinks: gaps over
    kinks of valleys count as closed if they are too narrow for double precision.
    """
    limit = context.full
    if not (limit.is_known if but_for_kinks else limit.possible):
        return None
    controlled = control.approach if context.scene.given_load is None else control.load
    mean_pressure = None if controlled is None else full_contact_pressure(context)
    if mean_pressure is None:
        return None
    is_full = mean_pressure >= limit.onset_pressure
    context.plan.decide(
        "full contact",
        "full contact" if is_full else "part contact",
        "the mean pressure with all gaps closed would be {} Pa",
        mean_pressure,
        limit.onset_pressure,
    )
    return Full(mean_pressure) if is_full else None


def full_contact_pressure(context: SolveContext) -> float | None:
    """Mean pressure [Pa] if the surfaces touch on the whole period, from the load or approach.

    None if the control does not determine this pressure. An approach determines it if the substrate
    has a base or a spring is in series.
    """
    scene = context.scene
    period, approach = scene.profile.period, scene.held(Quantity.APPROACH)
    if period is None:
        return None
    if scene.given_load is not None:
        return scene.given_load / period if scene.mean_pressure is None else scene.mean_pressure
    # In full contact, the substrate on its base and the spring are compressed together. The
    # compression is the approach minus the profile's mean height.
    base = 2 * (context.operator.compression or 0.0) / scene.E_star
    compliance = base + (context.spring_compliance or 0.0) * period
    if approach is None or compliance == 0.0:
        return None
    return (approach - mean_height(scene)) / compliance


def full_by_adhesion(context: SolveContext) -> Full:
    """Full contact by adhesion; raises OutOfRange if the mean pressure is not determined."""
    mean_pressure = full_contact_pressure(context)
    if mean_pressure is None:
        raise OutOfRange(
            "adhesion closes all gaps, and in full contact the approach does not determine the "
            "load: give a load"
        )
    return Full(mean_pressure)


def refuse_full_approach(context: SolveContext, problem: Problem, control: Control) -> None:
    """Raise OutOfRange for an approach that no load can reach, or at which contact is full."""
    if control.approach is None:
        return
    units, limit = problem.units, context.full
    _refuse_wide_punch(context, control.approach * units.height)
    if not limit.approached or context.operator.compression:
        return
    # If the substrate has no base, the mean displacement is zero. So the mean gap is `highest`
    # minus the approach. `highest` is the profile's mean height above its lowest point, and
    # `rounding` its round-off.
    highest = mean_shape(problem)
    rounding = 8 * EPS * (highest + abs(problem.lowest) / units.height)
    if control.approach >= highest - rounding:
        there = (
            "no load gives this approach, as the gaps over kinks in valleys never close"
            if context.operator.has_inverse and not limit.possible
            else "this mean is the approach of full contact at every load, and no load gives a "
            "larger approach; give a load"
        )
        raise OutOfRange(
            f"approach {control.approach * units.height:.15g} m is not below "
            f"{highest * units.height:.15g} m, the mean of the profile above its lowest point, "
            f"within rounding: {there}"
        )


def _refuse_wide_punch(context: SolveContext, approach: float) -> None:
    """Raise OutOfRange for the approach of a flat punch that is too wide for the datum.

    A punch 4 datums wide has the approach zero under any load: its logarithmic capacity, a quarter
    of the width, equals the datum.
    """
    scene, datum = context.scene, context.operator.datum
    support = scene.profile.support
    upright = scene.is_flat and not scene.turned
    if datum is None or support is None or not (context.operator.is_plain and upright):
        return
    width = support[1] - support[0]
    if width >= 4 * datum:
        raise OutOfRange(
            f"approach {approach:.6g} m is out of range: a flat punch of width {width:.6g} m has "
            f"no approach above zero with a datum of {datum:.6g} m; give a datum above a quarter "
            "of the width"
        )
