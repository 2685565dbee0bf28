"""Partial slip: a tangential load on a contact that was loaded before."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from contact.errors import NotConverged, SceneError, unwarned
from contact.model.scene import Scene
from contact.slip.checks import (
    bulk_stress_of,
    friction_of,
    nested_or_refused,
    require_similar,
    tangential_load_of,
)
from contact.slip.memory import Memory, Segment
from contact.slip.result import Slip, Term, shear_error, stated_error
from contact.slip.work import approach_of, first_approach
from contact.slip.zones import contact_zones, parted
from contact.solution.solution import Solution
from contact.solver import solve, tolerance


def partial_slip(
    solution: Solution,
    friction: float,
    tangential_load: float,
    bulk_stress: float = 0.0,
    tol: float = 1e-8,
) -> Slip:
    """Shear and slip of a contact under a tangential load, applied after the normal load.

    The shear is friction times a difference: the pressure of the contact minus the pressure under
    the smaller load P - |Q| / friction, whose zones stick (J. Jaeger, J. Appl. Mech. 65, 1998,
    255-263; M. Ciavarella, Int. J. Solids Struct. 35, 1998, 2349-2362). Any number of zones may
    touch. The zones share one tangential displacement.

    Parameters
    ----------
    solution : Solution
        A contact without friction.
    friction : float
        Coefficient of friction [1], above 0.
    tangential_load : float
        Q [N/m], per period if the scene is periodic; the traction on body 1 along +x. At most
        friction times the load in size.
    bulk_stress : float
        Tension along x in body 1 [Pa], applied together with Q. Both bodies are of one material,
        so that the strain of body 1 relative to body 2 is bulk_stress / (2 E*).
    tol : float
        Largest stated error of the contact under the smaller load. The shear is a sum of two
        pressures, so `Slip.error` may be a few times larger.

    Returns
    -------
    Slip

    Raises
    ------
    SceneError
        If a value is bad, or the shear does not follow from pressures: under adhesion, on layers,
        in localized contact, under a given moment, for a bulk stress in periodic contact or one so
        large that the ends slip in opposite directions.
    OutOfRange, NotConverged
        As `contact.solve`.

    Examples
    --------
    A wave sticks in the middle of each contact.

    >>> import contact
    >>> wave = contact.Sinusoid(amplitude=1e-6, period=1e-4)
    >>> scene = contact.Scene(wave, 1e9, contact.Periodic(), contact_fraction=0.5)
    >>> slip = contact.partial_slip(contact.solve(scene), friction=0.3, tangential_load=100.0)
    >>> (slip.stick_zones / 1e-4).round(6).tolist()
    [[-0.215968, 0.215968]]
    """
    if not isinstance(solution, Solution):
        raise SceneError.of("solution", solution, "a contact.Solution")
    require_similar(solution.scene)
    mu, load = friction_of(friction), solution.load
    shear = tangential_load_of(tangential_load, mu, load)
    bulk = bulk_stress_of(bulk_stress, solution.scene, shear)
    tol = tolerance(tol)
    memory = Memory(mu)
    memory.go_to(load, 0.0)
    segment = memory.go_to(load, shear)
    contacts = {load: solution}
    if 0.0 < segment.stick < load:
        scene = solution.scene.under("load", segment.stick)
        if bulk:
            turn = bulk / (2.0 * mu * scene.E_star)
            scene = replace(scene, tilt=(scene.tilt or 0.0) + (turn if shear > 0 else -turn))
        near = solution if scene.tilt == solution.scene.tilt else None
        contacts[segment.stick] = solved_or_best(scene, tol, near)
    return slip_of(contacts, State(mu, shear, segment, bulk), tol)


def solved_or_best(scene: Scene, tol: float, near: Solution | None = None) -> Solution:
    """The solution of a scene; if the tolerance is missed, the best one, if it is certified.

    Very small loads have zones whose ends cannot be found to many digits of their widths. Relative
    to the whole contact these errors may be small: `slip_of` checks them.
    """
    try:
        with unwarned():
            return solve(scene, tol, near=near)
    except NotConverged as error:
        best = error.best
        if isinstance(best, Solution) and best.certificate.holds and math.isfinite(best.error):
            return best
        raise


@dataclass(frozen=True)
class State:
    """The values that determine the slip at the end of a segment of a history.

    Parameters
    ----------
    friction, tangential_load : float
        As in `Slip`.
    segment : Segment
        The function h of the load, the load whose zones stick, and the steps of slip.
    bulk_stress : float
        As in `Slip`.
    """

    friction: float
    tangential_load: float
    segment: Segment
    bulk_stress: float = 0.0


def slip_of(contacts: Mapping[float, Solution], state: State, tol: float) -> Slip:
    """The `Slip` of a state; NotConverged if a contact at a smaller load is too inaccurate.

    contacts: the solutions under all loads of the segment. tol: largest error of the shear that the
    contact under a smaller load may cause.
    """
    segment = state.segment
    solution = contacts[segment.layers[-1].top]
    h = np.array([layer.h for layer in segment.layers] + [0.0])
    weights = h[:-1] - h[1:]
    found = [contacts[layer.top] for layer in segment.layers]
    terms = tuple(
        Term(float(weight), one.fields, one.error)
        for weight, one in zip(weights, found, strict=True)
        if weight
    )
    stick = contacts.get(segment.stick)
    table = np.zeros((0, 2)) if stick is None else contact_zones(stick)
    parts = parted(solution, table, 0.0 if stick is None else stick.error)
    ends = 0.0 if stick is None else stick.error * parts.largest
    error = stated_error(solution, terms, state.friction, ends)
    smaller = tuple(term for term in terms if term.fields is not solution.fields)
    own = max(shear_error(solution, smaller, state.friction), ends)
    if own > tol and any(term.error > tol for term in smaller):
        raise NotConverged(
            f"the stated error {own:.2g} from contacts under smaller loads is above the tolerance "
            f"{tol:.2g}",
            (),
            solution,
        )
    nested_or_refused(parts.is_nested or not state.bulk_stress, state.bulk_stress)
    needed = {load for step in segment.steps for load in (*step.stick, *step.load)}
    needed |= {layer.top for layer in segment.layers}
    return Slip(
        solution=solution,
        friction=state.friction,
        tangential_load=state.tangential_load,
        stick_zones=parts.stick,
        slip_zones=parts.slip,
        shift=_shift(solution, found, weights, float(h[0])),
        error=error,
        terms=terms,
        bulk_stress=state.bulk_stress,
        steps=segment.steps,
        contacts={load: contacts[load] for load in needed if load in contacts},
    )


def _shift(
    solution: Solution, found: list[Solution], weights: np.ndarray, lowest_h: float
) -> float | None:
    """Tangential displacement int h C dP' [m], with the compliance C at the load P'.
    h is the factor of the pressure that the load from P' to P' + dP' adds. The result is None if
    the scene defines no approach.
    """
    if solution.approach is None:
        return None
    total = sum(weight * approach_of(one) for weight, one in zip(weights, found, strict=True))
    return float(total - lowest_h * first_approach(solution))
