"""The contact of a scene: ways to it in order, each with the scenes it is for.

    a given part of the period in full contact    no search
    the last ones on a curve of its values        Newton from their zones, carried on to here
    a solution near by that knows the tilt        Newton from its zones
    the scene's own control                       first guesses (contact.search.strategies.guesses), in a strip or not
    loads                                         an approach where load and tilt are unknown, or that the grid did not find

A way leads to the contact, or is left with the reason; the first refusal is raised where none leads
on, or a later one that tells why there is no contact at all.
"""

from contact.errors import NotConverged, OutOfRange
from contact.extras import require
from contact.model.controls import Quantity
from contact.search.context import SolveContext
from contact.search.feasibility import refuse_below_plateau, refuse_unbounded
from contact.search.grid.conjugate_gradient import LevelOfFullGrid
from contact.search.grid.proposals import placed
from contact.search.grid.scaling import ScaledScene, scaled_scene, scaled_scene_about
from contact.search.strategies.continuation import from_last
from contact.search.strategies.full_contact import smallest_full
from contact.search.strategies.guesses import Outcome, search
from contact.search.strategies.load_controls import NEAR_LOAD, NEARER_LOAD, at_approach, at_level
from contact.search.topology.failure import NOT_APPLICABLE, Failure, attempted

# Loaded by the scenes that they are for.
_STRIPS = "contact.localized.strips"


def found(context: SolveContext) -> Outcome:
    """The contact of the context's scene; raises OutOfRange where there is none, NotConverged where no
    way led to it.
    """
    scene = context.scene
    if context.operator.is_plain and scene.law.equilibria.unique and scene.given_fraction != 1.0:
        refuse_below_plateau(scene)
    refuse_unbounded(scene)
    refused: Failure | None = None
    for name, way in STRATEGIES:
        outcome = way(context, refused)
        if not isinstance(outcome, Failure):
            return outcome
        if outcome is NOT_APPLICABLE:
            continue
        context.record_failure(name, outcome)
        if outcome.refusal is not None and (
            refused is None or _tells_more(outcome.refusal, refused.refusal)
        ):
            refused = outcome
        if way is _along:
            # From the same zones once more it would be no shorter.
            context = context.with_warm_start(None)
    assert refused is not None and refused.refusal is not None
    raise refused.refusal


def _tells_more(later: Exception, first: Exception | None) -> bool:
    """Whether a later refusal says why there is no contact, where the first one said less."""
    return isinstance(later, OutOfRange) and not isinstance(first, LevelOfFullGrid)


def _full(context: SolveContext, refused: Failure | None) -> Outcome | Failure:
    """All of the period."""
    return smallest_full(context) if context.scene.given_fraction == 1.0 else NOT_APPLICABLE


def _along(context: SolveContext, refused: Failure | None) -> Outcome | Failure:
    """From the last ones on a curve."""
    return NOT_APPLICABLE if _of_unknown_tilt(context) else from_last(context)


def _at_known_tilt(context: SolveContext, refused: Failure | None) -> Outcome | Failure:
    """A body of unknown tilt, from a solution at hand: its tilt need not be searched for."""
    near, scene = context.warm_start, context.scene
    if (
        near is None
        or len(near.zones) == 0
        or scene.moment is None
        or not scene.turned
        or scene.held(Quantity.APPROACH) is not None
    ):
        return NOT_APPLICABLE
    scaled = scaled_scene_about(scene, near.tilt or 0.0, near.zones)
    return context.refine_topology(
        scaled.problem, scaled.control, placed(scaled.problem, near.zones)
    )


def _as_given(context: SolveContext, refused: Failure | None) -> Outcome | Failure:
    """Under the scene's own control; what it refuses is a value where loads may tell more."""
    if _of_unknown_tilt(context):
        return NOT_APPLICABLE
    tilt = None if context.warm_start is None else context.warm_start.tilt

    def given() -> Outcome:
        return _of_scaled(context, scaled_scene(context.scene, context.single, tilt or 0.0))

    if context.scene.turned or context.scene.held(Quantity.APPROACH) is None:
        return given()
    outcome: Outcome | Failure = attempted(given)
    refusal = outcome.refusal if isinstance(outcome, Failure) else None
    if refusal is None or isinstance(refusal, LevelOfFullGrid) or _loads_may_tell(context, refusal):
        return outcome
    raise refusal


def _by_loads(context: SolveContext, refused: Failure | None) -> Outcome | Failure:
    """An approach from a solution under about the load that has it."""
    if _of_unknown_tilt(context):
        return _under_loads(context)
    if refused is None:
        return NOT_APPLICABLE
    return attempted(lambda: _under_loads(context))


STRATEGIES = (
    ("full contact", _full),
    ("the last zones, carried on", _along),
    ("zones near by, at their tilt", _at_known_tilt),
    ("the control itself", _as_given),
    ("loads", _by_loads),
)


def _of_unknown_tilt(context: SolveContext) -> bool:
    """Whether neither tilt nor load is known."""
    scene = context.scene
    return scene.turned and scene.moment is not None and scene.held(Quantity.APPROACH) is not None


def _loads_may_tell(context: SolveContext, refusal: OutOfRange | NotConverged) -> bool:
    """Whether loads may lead to an approach that the grid does not find: its lowest point may lie
    above the profile's by more than the approach of a lone body, and narrow gaps between its
    points. A period has one lowest place, which the grid has found.
    """
    model = context.scene.interaction
    if not model.exact:
        return False
    return not isinstance(refusal, OutOfRange) if model.needs_period else context.warm_start is None


def _of_scaled(context: SolveContext, scaled: ScaledScene) -> Outcome:
    model, near, start = context.scene.interaction, context.warm_start, None
    if model.follows_isolated:
        return require(_STRIPS).first_order(context, scaled)
    # Where one zone is to be found, that is known better in closed form.
    if near is not None and len(near.zones) and not context.single:
        start = placed(scaled.problem, near.zones)
    if not model.strip:
        return search(context, scaled, start)
    return require(_STRIPS).centred(context, scaled, start)


def _under_loads(context: SolveContext) -> Outcome:
    if not context.scene.interaction.needs_period:
        return at_level(context)
    # Grids are searched by load: the zones are about those of the load that has the approach.
    context = context.with_warm_start(at_approach(context, NEAR_LOAD))
    outcome = attempted(lambda: _of_scaled(context, scaled_scene(context.scene, context.single)))
    if not isinstance(outcome, Failure):
        return outcome
    context.record_failure("zones under a load of about this approach", outcome)
    return _of_scaled(
        context.with_warm_start(at_approach(context, NEARER_LOAD)),
        scaled_scene(context.scene, context.single),
    )
