"""First guesses of the zones, in the order in which they are tried: each leads to zones that pass,
or says why it is left.

a given half width     the one zone it names
zones near by          those of a solution at hand, by their gaps where they are wide
one zone               of a symmetric asperity: its half width in closed form
a grid                 a coarse contact on ever finer grids
"""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from contact.closed.half_width import guess_half_width, single_branch, widest
from contact.errors import ContactError, OutOfRange
from contact.formulation.controls import Control
from contact.formulation.problem import Problem
from contact.search.context import SolveContext
from contact.search.grid.centring import Unrest
from contact.search.grid.nested_grids import MOST_POINTS, Proposal
from contact.search.grid.proposals import about, placed, proposed
from contact.search.grid.scaling import ScaledScene
from contact.search.grid.tilt import known_part
from contact.search.strategies.full_contact import (
    Full,
    full_under,
    no_inverse,
    refuse_full_approach,
)
from contact.search.strategies.gaps import by_gaps, worth_gaps
from contact.search.strategies.load_controls import by_fraction
from contact.search.topology.failure import EXACT, NOT_APPLICABLE, Failure
from contact.verify.error import SolvedGaps, SolvedZones
from sie import Array

Outcome: TypeAlias = SolvedZones | SolvedGaps | Full
Guess = Callable[[SolveContext, ScaledScene, Array | None], Outcome | Failure]

# Finest coarse grid; a scene whose zones are narrower needs more than a grid to find them.
_MOST_POINTS = 2**17
# How often a window is made twice as wide.
_WIDENINGS = 4
# Contact of a body that is no half-plane, where that is why its zones are not found.
_ALMOST_FULL = 0.99
# Of the half width that nothing exceeds: a first guess there is none.
_WIDEST = 0.999
# Gap beside the border of a strip over that beside the widest zone of a branch: modes tell none
# much narrower.
_NARROWER = 0.1

INSTEAD = "Localized('self-consistent', neighbours=4) and Periodic() are nearer to the exact contact and reach farther"
_AT_BORDER = "a contact zone reaches the border of the part of the profile that is known"
_AT_STRIP = (
    f"a contact zone reaches the border of the strip that the localized model solves; {EXACT}"
)


def search(context: SolveContext, scaled: ScaledScene, start: Array | None = None) -> Outcome:
    """The contact from the first guess that leads on. start: scaled zones of a solution near by."""
    if scaled.control.approach is not None and (full := full_under(context, scaled.control)):
        return full
    refuse_full_approach(context, scaled.problem, scaled.control)
    # A width that a closure looks at on its way is none of the scene's.
    if context.scene.given_fraction is not None and not context.single:
        return by_fraction(context, scaled)
    for name, guess in GUESSES:
        outcome = guess(context, scaled, start)
        if not isinstance(outcome, Failure):
            return outcome
        if outcome is not NOT_APPLICABLE:
            context.record_failure(name, outcome)
    if scaled.control.width is None:
        return from_grid(context, scaled)
    if context.scene.given_fraction is None:
        raise context.error(
            Failure("zones of the total width that the closure asks for were not found"),
            scaled.problem,
        )
    return by_fraction(context, scaled)


def _near_by(context: SolveContext, scaled: ScaledScene, start: Array | None) -> Outcome | Failure:
    """Zones of a solution, given up as soon as they turn out to be far off: from there the way may
    be longer than from scratch.
    """
    if start is None:
        return NOT_APPLICABLE
    problem, control = scaled.problem, scaled.control
    width = float((start[:, 1] - start[:, 0]).sum())
    if worth_gaps(context, problem, width):
        return by_gaps(context, problem, control, width, start, abandon_if_far=True)
    found = context.refine_topology(problem, control, start, abandon_if_far=True)
    if isinstance(found, Failure) and found.at_border:
        raise context.error(found, problem)
    return found


def _given(context: SolveContext, scaled: ScaledScene, start: Array | None) -> Outcome | Failure:
    """The one zone of a given half width."""
    a = scaled.control.half_width
    if a is None:
        return NOT_APPLICABLE
    found = context.refine_topology(scaled.problem, scaled.control, np.array([[-a, a]]))
    if isinstance(found, Failure):
        if found.at_border:
            raise context.error(found, scaled.problem)
        raise OutOfRange(
            f"one zone of this half width carries no pressure that is positive everywhere: {found.reason}"
        )
    return found


def _one_zone(context: SolveContext, scaled: ScaledScene, start: Array | None) -> Outcome | Failure:
    """One zone about the tip of a symmetric asperity; full contact, or its gaps, where that would
    be wide.
    """
    problem, control = scaled.problem, scaled.control
    if not context.single or problem.amplitude is not None:
        return NOT_APPLICABLE
    with context.plan.timed("zone ends"):
        guess = guess_half_width(problem, control)
    # Only wide zones can be near full contact, and only then is it worth finding out where it
    # begins.
    if (
        problem.period is not None
        and guess > 0.25 * problem.period
        and (full := full_under(context, control))
    ):
        return full
    if worth_gaps(context, problem, 2 * guess):
        found_by_gaps = by_gaps(context, problem, control, 2 * guess)
        if isinstance(found_by_gaps, SolvedGaps):
            return found_by_gaps
        context.record_failure("gaps of one zone", found_by_gaps)
        if full := full_under(context, control, but_for_kinks=True):
            return full
    by_branch = control.load is not None or control.approach is not None
    told = by_branch and problem.interaction.neighbours and guess > _WIDEST * widest(problem)
    if told:
        # A first guess knows of full contact, which such a strip never comes to: the branch tells
        # the width, or that there is none.
        guess = _on_branch(context, problem, control)
    found = context.refine_topology(problem, control, np.array([[-guess, guess]]))
    if isinstance(found, SolvedZones) or not by_branch:
        return found
    if found.at_border:
        raise context.error(found, problem)
    if context.scene.interaction.exact and (
        context.operator.is_periodic or not context.operator.is_plain
    ):
        return found
    if not told:
        _on_branch(context, problem, control)
    return found


def _on_branch(context: SolveContext, problem: Problem, control: Control) -> float:
    """About the half width of one zone under a control, along the branch from zero load: there the
    controlled quantity grows with the width up to its maximum, or in a strip with neighbours to its
    border, as the logarithm of the gap there. Raises OutOfRange beyond.
    """
    with context.plan.timed("zone ends"):
        half_widths, values = single_branch(problem, control)
    highest, units = float(values[-1]), problem.units
    if control.value <= highest:
        return float(np.interp(control.value, values, half_widths))
    told, at_most = (
        control.described(units),
        f"{highest * control.unit(units):.6g} at half width {half_widths[-1] * units.length:.6g} m",
    )
    if problem.interaction.neighbours and half_widths[-1] == widest(problem):
        border = 0.5 * problem.repeat_length
        before, last = border - half_widths[-2:]
        gap = last * np.exp(
            (highest - control.value) / (highest - values[-2]) * np.log(before / last)
        )
        if gap > _NARROWER * last:
            return float(border - gap)
        raise OutOfRange(
            f"{told} is more than one zone carries in its strip, whose border it nears: {at_most}; {EXACT}"
        )
    raise OutOfRange(
        f"{told} is beyond the largest that {context.scene.interaction.name} carries on the branch from zero load, {at_most}"
    )


def from_grid(
    context: SolveContext,
    scaled: ScaledScene,
    held: bool = False,
    points: int | None = None,
    allow_loss: bool = False,
) -> Outcome:
    """Zones from a coarse grid, refined until Newton and the certificate agree with it. held: a
    strip stays where it is; points: of the first grid, if not as many as the profile asks for;
    allow_loss: see `NewtonSettings`.
    """
    problem, control, plan = scaled.problem, scaled.control, context.plan
    part = plan["coarse search"]
    part.used, part.reason = (
        True,
        part.reason if part.used else "one zone did not pass the certificate",
    )
    if control.load is not None and not control.load > 0.0:
        # A grid is pressed together without tension.
        raise OutOfRange(
            f"{control.described(problem.units)}: the law {context.scene.law.name} has no `bare` law to begin from, "
            "and without one zones are looked for under loads above 0 only: give a half width"
        )
    failure: Failure | None = None
    most, touched, widened, full, width = _MOST_POINTS, False, 0, False, 0.0
    while points is None or points <= most:
        if context.progress is not None:
            context.progress("coarse grid", 0, None)
        with plan.timed("coarse search"):
            # Its pressures and gaps, of very many points, have told what they tell.
            proposal = replace(proposed(scaled, problem, control, points, held=held), grid=None)
        if points is None:
            most = max(most, min(4 * proposal.points, MOST_POINTS))
        points, full = proposal.points, proposal.full
        part.detail = f"{points} points, {len(proposal.zones)} zones proposed"
        if proposal.unrest is not None:
            raise no_rest(problem, control, proposal.unrest)
        if proposal.touches_border and context.scene.profile.support is None:
            if touched or 4 * points > most:
                wider = None if widened == _WIDENINGS else _wider(context, scaled)
                if wider is None:
                    raise OutOfRange(_AT_STRIP if problem.interaction.strip else _AT_BORDER)
                scaled, touched, widened, points = wider, False, widened + 1, None
                continue
            # A coarse grid may touch it by its own error.
            touched, points = True, 4 * points
            continue
        width = proposal.width / problem.units.length
        found = _from_proposal(context, problem, control, proposal, held, allow_loss)
        if not isinstance(found, Failure):
            return found
        if found is not NOT_APPLICABLE:
            context.record_failure(f"zones of a grid of {points} points", found)
            again = failure is not None and found.same(failure)
            failure = found
            # Where modes do not show what a grid as fine as this one leads to, they do not show
            # what one beside it does.
            if again or found.unresolved and points >= _MOST_POINTS:
                break
        points *= 4
    raise _not_found(context, problem, failure, width, points, full)


def no_rest(problem: Problem, control: Control, why: Unrest) -> OutOfRange:
    """What to say where no centre of a strip stays."""
    closure, instead = (
        ("first-order", INSTEAD)
        if problem.interaction.follows_isolated
        else ("self-consistent", EXACT)
    )
    return OutOfRange(
        f"{control.described(problem.units)}: under the {closure} closure {why.value}; {instead}"
    )


def _wider(context: SolveContext, scaled: ScaledScene) -> ScaledScene | None:
    """A wider window: few points of the first one may have missed zones beside it. None where the
    window is all that is known, or all that there is.
    """
    (lo, hi), known = scaled.cell, known_part(context.scene.profile) or (-math.inf, math.inf)
    cell = max(known[0], lo - 0.5 * (hi - lo)), min(known[1], hi + 0.5 * (hi - lo))
    return None if cell == scaled.cell else replace(scaled, cell=cell)


def _not_found(
    context: SolveContext,
    problem: Problem,
    failure: Failure | None,
    width: float,
    points: int | None,
    full: bool,
) -> ContactError:
    """What to say where no grid leads to the contact. width, points, full: of the finest grid."""
    if full and context.operator.is_periodic and not context.operator.has_inverse:
        return OutOfRange(
            no_inverse(
                context, f"in full contact, or nearer to it than a grid of {points} points tells"
            )
        )
    narrow = "the gaps are narrower than the finest grid tells from full contact"
    if not (full or width):
        return context.error(
            failure or Failure("the contact is narrower than the finest grid tells; give a load"),
            problem,
        )
    if context.operator.is_periodic and not context.operator.has_inverse:
        narrow += "; the gaps themselves are solved for where the model declares its symbol"
        if failure is not None and width > _ALMOST_FULL * (problem.period or math.inf):
            failure = Failure(f"{failure.reason}, and {narrow}", failure.free)
    return context.error(failure or Failure(narrow), problem)


def _from_proposal(
    context: SolveContext,
    problem: Problem,
    control: Control,
    proposal: Proposal,
    held: bool,
    allow_loss: bool,
) -> Outcome | Failure:
    """The contact from the zones that a grid proposes: full, by its gaps, or by its zones."""
    width = proposal.width / problem.units.length
    if (
        problem.period is not None
        and width > 0.4 * problem.period
        and (known := full_under(context, control))
    ):
        return known
    # A symmetric strip stays about the origin, or half a period from it.
    stays = proposal.in_strip and not problem.profile.symmetric
    table = problem.units.scaled(proposal.zones) if stays else placed(problem, proposal.zones)
    found_by_gaps = by_gaps(context, problem, control, width, table, allow_loss=allow_loss)
    if isinstance(found_by_gaps, SolvedGaps):
        return found_by_gaps
    if proposal.full or not len(proposal.zones):
        return full_under(context, control, but_for_kinks=True) or NOT_APPLICABLE
    found = context.refine_topology(
        problem if held else about(problem, table), control, table, allow_loss=allow_loss
    )
    if isinstance(found, Failure) and found.at_border:
        raise context.error(found, problem)
    return found


GUESSES: tuple[tuple[str, Guess], ...] = (
    ("zones near by", _near_by),
    ("the given zone", _given),
    ("one zone", _one_zone),
)
