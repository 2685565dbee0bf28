"""The contact of a scene: ways to it in order, each with the scenes it is for.

    a given part of the period in full contact    no search
    the last ones on a curve of its values        Newton from their zones, carried on to here
    a solution near by that knows the tilt        Newton from its zones
    the scene's own control                       first guesses (contact.search.ways.guesses), in a strip or not
    loads                                         an approach where load and tilt are unknown, or that the grid did not find

A way leads to the contact, or is left with the reason; the first refusal is raised where none leads
on, or a later one that tells why there is no contact at all.
"""

from contact.errors import NotConverged, OutOfRange
from contact.extras import require
from contact.model.controls import Quantity
from contact.search.feasibility import refuse_below_plateau, refuse_unbounded
from contact.search.grid.conjugate_gradient import LevelOfFullGrid
from contact.search.grid.proposals import placed
from contact.search.grid.scaling import ScaledScene, scaled_scene, scaled_scene_about
from contact.search.task import Task
from contact.search.topology.missed import NOT_MINE, Missed, attempted
from contact.search.ways.along import from_last
from contact.search.ways.full_contact import smallest_full
from contact.search.ways.guesses import Outcome, search
from contact.search.ways.loads import NEAR_LOAD, NEARER_LOAD, at_approach, at_level

# Loaded by the scenes that they are for.
_STRIPS = "contact.localized.strips"


def found(task: Task) -> Outcome:
    """The contact of the task's scene; raises OutOfRange where there is none, NotConverged where no
    way led to it.
    """
    scene = task.scene
    if task.operator.is_plain and scene.law.convex and scene.given_fraction != 1.0:
        refuse_below_plateau(scene)
    refuse_unbounded(scene)
    refused: Missed | None = None
    for name, way in WAYS:
        outcome = way(task, refused)
        if not isinstance(outcome, Missed):
            return outcome
        if outcome is NOT_MINE:
            continue
        task.left(name, outcome)
        if outcome.refusal is not None and (
            refused is None or _tells_more(outcome.refusal, refused.refusal)
        ):
            refused = outcome
        if way is _along:
            # From the same zones once more it would be no shorter.
            task = task.beside(None)
    assert refused is not None and refused.refusal is not None
    raise refused.refusal


def _tells_more(later: Exception, first: Exception | None) -> bool:
    """Whether a later refusal says why there is no contact, where the first one said less."""
    return isinstance(later, OutOfRange) and not isinstance(first, LevelOfFullGrid)


def _full(task: Task, refused: Missed | None) -> Outcome | Missed:
    """All of the period."""
    return smallest_full(task) if task.scene.given_fraction == 1.0 else NOT_MINE


def _along(task: Task, refused: Missed | None) -> Outcome | Missed:
    """From the last ones on a curve."""
    return NOT_MINE if _of_unknown_tilt(task) else from_last(task)


def _at_known_tilt(task: Task, refused: Missed | None) -> Outcome | Missed:
    """A body of unknown tilt, from a solution at hand: its tilt need not be searched for."""
    near, scene = task.near, task.scene
    if (
        near is None
        or len(near.zones) == 0
        or scene.moment is None
        or not scene.turned
        or scene.held(Quantity.APPROACH) is not None
    ):
        return NOT_MINE
    scaled = scaled_scene_about(scene, near.tilt or 0.0, near.zones)
    return task.refine_topology(scaled.problem, scaled.control, placed(scaled.problem, near.zones))


def _as_given(task: Task, refused: Missed | None) -> Outcome | Missed:
    """Under the scene's own control; what it refuses is a value where loads may tell more."""
    if _of_unknown_tilt(task):
        return NOT_MINE
    tilt = None if task.near is None else task.near.tilt

    def given() -> Outcome:
        return _of_scaled(task, scaled_scene(task.scene, task.single, tilt or 0.0))

    if task.scene.turned or task.scene.held(Quantity.APPROACH) is None:
        return given()
    outcome: Outcome | Missed = attempted(given)
    refusal = outcome.refusal if isinstance(outcome, Missed) else None
    if refusal is None or isinstance(refusal, LevelOfFullGrid) or _loads_may_tell(task, refusal):
        return outcome
    raise refusal


def _by_loads(task: Task, refused: Missed | None) -> Outcome | Missed:
    """An approach from a solution under about the load that has it."""
    if _of_unknown_tilt(task):
        return _under_loads(task)
    if refused is None:
        return NOT_MINE
    return attempted(lambda: _under_loads(task))


WAYS = (
    ("full contact", _full),
    ("the last zones, carried on", _along),
    ("zones near by, at their tilt", _at_known_tilt),
    ("the control itself", _as_given),
    ("loads", _by_loads),
)


def _of_unknown_tilt(task: Task) -> bool:
    """Whether neither tilt nor load is known."""
    scene = task.scene
    return scene.turned and scene.moment is not None and scene.held(Quantity.APPROACH) is not None


def _loads_may_tell(task: Task, refusal: OutOfRange | NotConverged) -> bool:
    """Whether loads may lead to an approach that the grid does not find: its lowest point may lie
    above the profile's by more than the approach of a lone body, and narrow gaps between its
    points. A period has one lowest place, which the grid has found.
    """
    model = task.scene.interaction
    if not model.exact:
        return False
    return not isinstance(refusal, OutOfRange) if model.needs_period else task.near is None


def _of_scaled(task: Task, scaled: ScaledScene) -> Outcome:
    model, near, start = task.scene.interaction, task.near, None
    if model.follows_isolated:
        return require(_STRIPS).first_order(task, scaled)
    # Where one zone is to be found, that is known better in closed form.
    if near is not None and len(near.zones) and not task.single:
        start = placed(scaled.problem, near.zones)
    if not model.strip:
        return search(task, scaled, start)
    return require(_STRIPS).centred(task, scaled, start)


def _under_loads(task: Task) -> Outcome:
    if not task.scene.interaction.needs_period:
        return at_level(task)
    # Grids are searched by load: the zones are about those of the load that has the approach.
    task = task.beside(at_approach(task, NEAR_LOAD))
    outcome = attempted(lambda: _of_scaled(task, scaled_scene(task.scene, task.single)))
    if not isinstance(outcome, Missed):
        return outcome
    task.left("zones under a load of about this approach", outcome)
    return _of_scaled(
        task.beside(at_approach(task, NEARER_LOAD)), scaled_scene(task.scene, task.single)
    )
