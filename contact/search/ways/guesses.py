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
from contact.search.grid.centring import Unrest
from contact.search.grid.coarse import MOST_POINTS, Proposal
from contact.search.grid.proposals import about, placed, proposed
from contact.search.grid.scaling import ScaledScene
from contact.search.grid.tilt import known_part
from contact.search.task import Task
from contact.search.topology.missed import EXACT, NOT_MINE, Missed
from contact.search.ways.full_contact import Full, full_under, no_inverse, refuse_full_approach
from contact.search.ways.gaps import by_gaps, worth_gaps
from contact.search.ways.loads import by_fraction
from contact.verify.error import SolvedGaps, SolvedZones
from sie import Array

Outcome: TypeAlias = SolvedZones | SolvedGaps | Full
Guess = Callable[[Task, ScaledScene, Array | None], Outcome | Missed]

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


def search(task: Task, scaled: ScaledScene, start: Array | None = None) -> Outcome:
    """The contact from the first guess that leads on. start: scaled zones of a solution near by."""
    if scaled.control.approach is not None and (full := full_under(task, scaled.control)):
        return full
    refuse_full_approach(task, scaled.problem, scaled.control)
    # A width that a closure looks at on its way is none of the scene's.
    if task.scene.given_fraction is not None and not task.single:
        return by_fraction(task, scaled)
    for name, guess in GUESSES:
        outcome = guess(task, scaled, start)
        if not isinstance(outcome, Missed):
            return outcome
        if outcome is not NOT_MINE:
            task.left(name, outcome)
    if scaled.control.width is None:
        return from_grid(task, scaled)
    if task.scene.given_fraction is None:
        raise task.error(
            Missed("zones of the total width that the closure asks for were not found"),
            scaled.problem,
        )
    return by_fraction(task, scaled)


def _near_by(task: Task, scaled: ScaledScene, start: Array | None) -> Outcome | Missed:
    """Zones of a solution, given up as soon as they turn out to be far off: from there the way may
    be longer than from scratch.
    """
    if start is None:
        return NOT_MINE
    problem, control = scaled.problem, scaled.control
    width = float((start[:, 1] - start[:, 0]).sum())
    if worth_gaps(task, problem, width):
        return by_gaps(task, problem, control, width, start, near=True)
    found = task.refine_topology(problem, control, start, near=True)
    if isinstance(found, Missed) and found.beyond:
        raise task.error(found, problem)
    return found


def _given(task: Task, scaled: ScaledScene, start: Array | None) -> Outcome | Missed:
    """The one zone of a given half width."""
    a = scaled.control.half_width
    if a is None:
        return NOT_MINE
    found = task.refine_topology(scaled.problem, scaled.control, np.array([[-a, a]]))
    if isinstance(found, Missed):
        if found.beyond:
            raise task.error(found, scaled.problem)
        raise OutOfRange(
            f"one zone of this half width carries no pressure that is positive everywhere: {found.reason}"
        )
    return found


def _one_zone(task: Task, scaled: ScaledScene, start: Array | None) -> Outcome | Missed:
    """One zone about the tip of a symmetric asperity; full contact, or its gaps, where that would
    be wide.
    """
    problem, control = scaled.problem, scaled.control
    if not task.single or problem.amplitude is not None:
        return NOT_MINE
    with task.plan.timed("zone ends"):
        guess = guess_half_width(problem, control)
    # Only wide zones can be near full contact, and only then is it worth finding out where it
    # begins.
    if (
        problem.period is not None
        and guess > 0.25 * problem.period
        and (full := full_under(task, control))
    ):
        return full
    if worth_gaps(task, problem, 2 * guess):
        found_by_gaps = by_gaps(task, problem, control, 2 * guess)
        if isinstance(found_by_gaps, SolvedGaps):
            return found_by_gaps
        task.left("gaps of one zone", found_by_gaps)
        if full := full_under(task, control, but_for_kinks=True):
            return full
    by_branch = control.load is not None or control.approach is not None
    told = by_branch and problem.interaction.neighbours and guess > _WIDEST * widest(problem)
    if told:
        # A first guess knows of full contact, which such a strip never comes to: the branch tells
        # the width, or that there is none.
        guess = _on_branch(task, problem, control)
    found = task.refine_topology(problem, control, np.array([[-guess, guess]]))
    if isinstance(found, SolvedZones) or not by_branch:
        return found
    if found.beyond:
        raise task.error(found, problem)
    if task.scene.interaction.exact and (task.operator.is_periodic or not task.operator.is_plain):
        return found
    if not told:
        _on_branch(task, problem, control)
    return found


def _on_branch(task: Task, problem: Problem, control: Control) -> float:
    """About the half width of one zone under a control, along the branch from zero load: there the
    controlled quantity grows with the width up to its maximum, or in a strip with neighbours to its
    border, as the logarithm of the gap there. Raises OutOfRange beyond.
    """
    with task.plan.timed("zone ends"):
        half_widths, values = single_branch(problem, control)
    highest, units = float(values[-1]), problem.units
    if control.value <= highest:
        return float(np.interp(control.value, values, half_widths))
    told, at_most = (
        control.told(units),
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
        f"{told} is beyond the largest that {task.scene.interaction.name} carries on the branch from zero load, {at_most}"
    )


def from_grid(
    task: Task,
    scaled: ScaledScene,
    held: bool = False,
    points: int | None = None,
    drops: bool = False,
) -> Outcome:
    """Zones from a coarse grid, refined until Newton and the certificate agree with it. held: a
    strip stays where it is; points: of the first grid, if not as many as the profile asks for;
    drops: see `Newton`.
    """
    problem, control, plan = scaled.problem, scaled.control, task.plan
    part = plan["coarse search"]
    part.used, part.reason = (
        True,
        part.reason if part.used else "one zone did not pass the certificate",
    )
    if control.load is not None and not control.load > 0.0:
        # A grid is pressed together without tension.
        raise OutOfRange(
            f"{control.told(problem.units)}: the law {task.scene.law.name} has no `bare` law to begin from, "
            "and without one zones are looked for under loads above 0 only: give a half width"
        )
    failure: Missed | None = None
    most, touched, widened, full, width = _MOST_POINTS, False, 0, False, 0.0
    while points is None or points <= most:
        if task.progress is not None:
            task.progress("coarse grid", 0, None)
        with plan.timed("coarse search"):
            # Its pressures and gaps, of very many points, have told what they tell.
            proposal = replace(proposed(scaled, problem, control, points, held=held), grid=None)
        if points is None:
            most = max(most, min(4 * proposal.points, MOST_POINTS))
        points, full = proposal.points, proposal.full
        part.detail = f"{points} points, {len(proposal.zones)} zones proposed"
        if proposal.unrest is not None:
            raise no_rest(problem, control, proposal.unrest)
        if proposal.touches_border and task.scene.profile.support is None:
            if touched or 4 * points > most:
                wider = None if widened == _WIDENINGS else _wider(task, scaled)
                if wider is None:
                    raise OutOfRange(_AT_STRIP if problem.interaction.strip else _AT_BORDER)
                scaled, touched, widened, points = wider, False, widened + 1, None
                continue
            # A coarse grid may touch it by its own error.
            touched, points = True, 4 * points
            continue
        width = proposal.width / problem.units.length
        found = _from_proposal(task, problem, control, proposal, held, drops)
        if not isinstance(found, Missed):
            return found
        if found is not NOT_MINE:
            task.left(f"zones of a grid of {points} points", found)
            again = failure is not None and found.same(failure)
            failure = found
            # Where modes do not show what a grid as fine as this one leads to, they do not show
            # what one beside it does.
            if again or found.unresolved and points >= _MOST_POINTS:
                break
        points *= 4
    raise _not_found(task, problem, failure, width, points, full)


def no_rest(problem: Problem, control: Control, why: Unrest) -> OutOfRange:
    """What to say where no centre of a strip stays."""
    closure, instead = (
        ("first-order", INSTEAD)
        if problem.interaction.follows_isolated
        else ("self-consistent", EXACT)
    )
    return OutOfRange(
        f"{control.told(problem.units)}: under the {closure} closure {why.value}; {instead}"
    )


def _wider(task: Task, scaled: ScaledScene) -> ScaledScene | None:
    """A wider window: few points of the first one may have missed zones beside it. None where the
    window is all that is known, or all that there is.
    """
    (lo, hi), known = scaled.cell, known_part(task.scene.profile) or (-math.inf, math.inf)
    cell = max(known[0], lo - 0.5 * (hi - lo)), min(known[1], hi + 0.5 * (hi - lo))
    return None if cell == scaled.cell else replace(scaled, cell=cell)


def _not_found(
    task: Task,
    problem: Problem,
    failure: Missed | None,
    width: float,
    points: int | None,
    full: bool,
) -> ContactError:
    """What to say where no grid leads to the contact. width, points, full: of the finest grid."""
    if full and task.operator.is_periodic and not task.operator.has_inverse:
        return OutOfRange(
            no_inverse(
                task, f"in full contact, or nearer to it than a grid of {points} points tells"
            )
        )
    narrow = "the gaps are narrower than the finest grid tells from full contact"
    if not (full or width):
        return task.error(
            failure or Missed("the contact is narrower than the finest grid tells; give a load"),
            problem,
        )
    if task.operator.is_periodic and not task.operator.has_inverse:
        narrow += "; the gaps themselves are solved for where the model declares its symbol"
        if failure is not None and width > _ALMOST_FULL * (problem.period or math.inf):
            failure = Missed(f"{failure.reason}, and {narrow}", failure.free)
    return task.error(failure or Missed(narrow), problem)


def _from_proposal(
    task: Task, problem: Problem, control: Control, proposal: Proposal, held: bool, drops: bool
) -> Outcome | Missed:
    """The contact from the zones that a grid proposes: full, by its gaps, or by its zones."""
    width = proposal.width / problem.units.length
    if (
        problem.period is not None
        and width > 0.4 * problem.period
        and (known := full_under(task, control))
    ):
        return known
    # A symmetric strip stays about the origin, or half a period from it.
    stays = proposal.in_strip and not problem.profile.symmetric
    table = problem.units.scaled(proposal.zones) if stays else placed(problem, proposal.zones)
    found_by_gaps = by_gaps(task, problem, control, width, table, drops=drops)
    if isinstance(found_by_gaps, SolvedGaps):
        return found_by_gaps
    if proposal.full or not len(proposal.zones):
        return full_under(task, control, but_for_kinks=True) or NOT_MINE
    found = task.refine_topology(
        problem if held else about(problem, table), control, table, drops=drops
    )
    if isinstance(found, Missed) and found.beyond:
        raise task.error(found, problem)
    return found


GUESSES: tuple[tuple[str, Guess], ...] = (
    ("zones near by", _near_by),
    ("the given zone", _given),
    ("one zone", _one_zone),
)
