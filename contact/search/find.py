"""The contact of a scene: ways to it in order, each with the scenes it is for.

    a given part of the period in full contact    no search
    several equilibria                            the branch asked for is followed (contact.search.ways.branches)
    the last ones on a curve of its values        Newton from their zones, carried on to here
    a solution near by that knows the tilt        Newton from its zones
    the scene's own control                       first guesses (contact.search.ways.guesses), in a strip or not
    an approach by loads                          where both load and tilt are unknown, or the grid did not find it
"""

from __future__ import annotations

from contact.errors import NotConverged, OutOfRange
from contact.search.feasibility import refuse_below_plateau, refuse_unbounded
from contact.search.grid.proposals import placed
from contact.search.grid.scaling import ScaledScene, scaled_scene, scaled_scene_about
from contact.search.task import Task
from contact.search.topology.missed import Missed
from contact.search.ways.along import NOT_ALONG, from_last
from contact.search.ways.branches import followed
from contact.search.ways.cohesive import followed_under_tension
from contact.search.ways.full_contact import smallest_full
from contact.search.ways.guesses import Outcome, search
from contact.search.ways.loads import NEAR_LOAD, at_approach, at_level
from contact.search.ways.strips import centred, first_order
from contact.verify.accuracy import Found


def found(task: Task) -> Outcome:
    """The contact of the task's scene; raises OutOfRange where there is none, NotConverged where no way led to it."""
    scene = task.scene
    if scene.contact_fraction == 1.0:
        return smallest_full(task)
    if task.operator.is_plain and scene.law.convex:
        refuse_below_plateau(scene)
    refuse_unbounded(scene)
    if scene.law.bare is not None and scene.half_width is None:
        return (followed_under_tension if scene.law.tension else followed)(task)
    if scene.turned and scene.moment is not None and scene.approach is not None:
        return _by_loads(task)
    carried = from_last(task)
    if not isinstance(carried, Missed):
        return carried
    if carried is not NOT_ALONG:
        task.left("the last zones, carried on", carried)
        # From the same zones once more it would be no shorter.
        task = task.beside(None)
    beside = _at_known_tilt(task)
    if isinstance(beside, Found):
        return beside
    try:
        return _as_given(task)
    except (OutOfRange, NotConverged) as failure:
        if not _loads_may_tell(task, failure):
            raise
        task.left("the approach itself", Missed(str(failure)))
        try:
            return _by_loads(task)
        except NotConverged:
            raise failure from None


def _at_known_tilt(task: Task) -> Found | Missed:
    """A body of unknown tilt, from a solution at hand: its tilt need not be searched for."""
    near, scene = task.near, task.scene
    if near is None or len(near.zones) == 0 or scene.moment is None or not scene.turned:
        return Missed("no solution that knows the tilt")
    scaled = scaled_scene_about(scene, near.tilt or 0.0, near.zones)
    return task.refine_topology(scaled.problem, scaled.control, placed(scaled.problem, near.zones))


def _as_given(task: Task) -> Outcome:
    """Under the scene's own control."""
    tilt = None if task.near is None else task.near.tilt
    return _of_scaled(task, scaled_scene(task.scene, task.single, tilt or 0.0))


def _of_scaled(task: Task, scaled: ScaledScene) -> Outcome:
    model, near, start = task.scene.interaction, task.near, None
    if model.follows_isolated:
        return first_order(task, scaled)
    # Where one zone is to be found, that is known better in closed form.
    if near is not None and len(near.zones) and not task.single:
        start = placed(scaled.problem, near.zones)
    return centred(task, scaled, start) if model.strip else search(task, scaled, start)


def _loads_may_tell(task: Task, failure: OutOfRange | NotConverged) -> bool:
    """Whether loads may lead to an approach that the grid did not find: its lowest point may lie above the profile's by more than the
    approach of a lone body, and narrow gaps between its points."""
    scene = task.scene
    if task.near is not None or scene.turned or scene.approach is None or not scene.interaction.exact:
        return False
    return not (scene.interaction.needs_period and isinstance(failure, OutOfRange))


def _by_loads(task: Task) -> Outcome:
    """An approach from a solution under about the load that has it."""
    if not task.scene.interaction.needs_period:
        return at_level(task)
    # Grids are searched by load: the zones are about those of the load that has the approach.
    return _of_scaled(task.beside(at_approach(task, NEAR_LOAD)), scaled_scene(task.scene, task.single))
