"""The strategies of a search, in the order in which they are tried.

    full contact          a contact fraction of 1 needs no search
    previous zones        Newton from zones extrapolated along a curve of values of the control
    zones at known tilt   Newton from the zones of a similar solution of a tilted body
    the control itself    first guesses of the zones (contact.search.strategies.guesses)
    loads                 the load with the wanted approach is bracketed

A strategy returns a contact, `NOT_APPLICABLE`, or a `Failure`, which is noted in the plan. If all
fail, the error of the first failure is raised, or that of a later failure which states that no
contact exists.
"""

from contact.errors import NotConverged, OutOfRange
from contact.extras import require
from contact.model.controls import Quantity
from contact.search.context import SolveContext
from contact.search.feasibility import refuse_below_plateau, refuse_beyond_corners, refuse_unbounded
from contact.search.grid.conjugate_gradient import LevelOfFullGrid
from contact.search.grid.proposals import placed
from contact.search.grid.scaling import ScaledScene, scaled_scene, scaled_scene_about
from contact.search.options import SEARCH
from contact.search.strategies.continuation import from_previous
from contact.search.strategies.full_contact import smallest_full
from contact.search.strategies.guesses import Outcome, search
from contact.search.strategies.load_controls import at_approach, at_level
from contact.search.topology.failure import NOT_APPLICABLE, Failure, attempted

# Modules that are imported only for the scenes that need them.
_STRIPS = "contact.localized.strips"
_CLOSURE = "contact.localized.closure"


def found(context: SolveContext) -> Outcome:
    """The contact of the context's scene, from the first strategy that finds a contact.

    Raises OutOfRange where no contact exists, NotConverged where no strategy found it.
    """
    scene = context.scene
    if context.operator.is_plain and scene.law.equilibria.unique and scene.given_fraction != 1.0:
        refuse_below_plateau(scene)
    refuse_beyond_corners(scene)
    refuse_unbounded(scene)
    refused: Failure | None = None
    for name, strategy in STRATEGIES:
        outcome = strategy(context, refused)
        if not isinstance(outcome, Failure):
            return outcome
        if outcome is NOT_APPLICABLE:
            continue
        context.record_failure(name, outcome)
        if outcome.refusal is not None and (
            refused is None or _says_more(outcome.refusal, refused.refusal)
        ):
            refused = outcome
        if strategy is _from_previous_zones:
            # Newton's method failed from the zones extrapolated from the last solutions. It would
            # also fail from the last solution's own zones, so the warm start is dropped.
            context = context.with_warm_start(None)
    assert refused is not None and refused.refusal is not None
    raise refused.refusal


def _says_more(later: Exception, first: Exception | None) -> bool:
    """Whether the error `later` replaces `first`: only if it states that no contact exists.

    It never replaces `LevelOfFullGrid`, which says that the given approach is that of full contact.
    """
    return isinstance(later, OutOfRange) and not isinstance(first, LevelOfFullGrid)


def _full_contact(context: SolveContext, refused: Failure | None) -> Outcome | Failure:
    """Full contact under the smallest mean pressure, if the given contact fraction is 1."""
    if context.scene.given_fraction != 1.0:
        return NOT_APPLICABLE
    context.plan.decide("full contact", "full contact", "the contact fraction is 1")
    return smallest_full(context)


def _from_previous_zones(context: SolveContext, refused: Failure | None) -> Outcome | Failure:
    """The contact from zones extrapolated from solutions at other loads or widths."""
    return NOT_APPLICABLE if _tilt_and_load_unknown(context) else from_previous(context)


def _at_known_tilt(context: SolveContext, refused: Failure | None) -> Outcome | Failure:
    """The contact by Newton's method, from the zones and the tilt of a similar solution."""
    start, scene = context.warm_start, context.scene
    if (
        start is None
        or len(start.zones) == 0
        or scene.moment is None
        or not scene.turned
        or scene.held(Quantity.APPROACH) is not None
    ):
        return NOT_APPLICABLE
    context.plan.decide("first guess", "the warm start", "a similar solution gives the tilt")
    scaled = scaled_scene_about(scene, start.tilt or 0.0, start.zones)
    table = placed(scaled.problem, start.zones)
    return context.refine_topology(scaled.problem, scaled.control, table)


def _as_given(context: SolveContext, refused: Failure | None) -> Outcome | Failure:
    """The contact solved under the given load or approach itself, not under trial loads.
    Newton's method starts from a first guess of the zones.

    For an upright body under an approach an error becomes a `Failure`, as the strategy of loads may
    still find the contact.
    """
    if _tilt_and_load_unknown(context):
        return NOT_APPLICABLE
    tilt = None if context.warm_start is None else context.warm_start.tilt

    def given() -> Outcome:
        return _of_scaled(context, scaled_scene(context.scene, context.single, tilt or 0.0))

    if context.scene.turned or context.scene.held(Quantity.APPROACH) is None:
        return given()
    outcome: Outcome | Failure = attempted(given)
    refusal = outcome.refusal if isinstance(outcome, Failure) else None
    if refusal is None or isinstance(refusal, LevelOfFullGrid) or _loads_may_help(context, refusal):
        return outcome
    raise refusal


def _by_loads(context: SolveContext, refused: Failure | None) -> Outcome | Failure:
    """The contact under a given approach, started from a contact under a given load.
    The load is chosen so that its approach is nearly the given one.
    """
    if _tilt_and_load_unknown(context):
        context.plan.decide("control", "loads", "neither tilt nor load is known")
        return _under_loads(context)
    if refused is None:
        return NOT_APPLICABLE
    context.plan.decide("control", "loads", "no contact was found under the approach itself")
    return attempted(lambda: _under_loads(context))


STRATEGIES = (
    ("full contact", _full_contact),
    ("zones extrapolated from the last ones", _from_previous_zones),
    ("zones and tilt of a similar solution", _at_known_tilt),
    ("the given control itself", _as_given),
    ("loads", _by_loads),
)


def _tilt_and_load_unknown(context: SolveContext) -> bool:
    """Whether the scene gives a moment and an approach, so that tilt and load are unknown."""
    scene = context.scene
    return scene.turned and scene.moment is not None and scene.held(Quantity.APPROACH) is not None


def _loads_may_help(context: SolveContext, refusal: OutOfRange | NotConverged) -> bool:
    """Whether trial loads are used if the grid finds no contact at the given approach.

    On a lone body, the lowest point of a coarse grid may lie above the profile's lowest point by
    more than the approach. On a period the grid does find the lowest point, but may miss narrow
    gaps.
    """
    model = context.scene.interaction
    if not model.exact:
        return False
    if model.needs_period:
        return not isinstance(refusal, OutOfRange)
    return context.warm_start is None


def _of_scaled(context: SolveContext, scaled: ScaledScene) -> Outcome:
    """The contact of a scaled scene, by the method that its interaction model needs."""
    model, warm_start, table = context.scene.interaction, context.warm_start, None
    if model.follows_isolated:
        return require(_CLOSURE).first_order(context, scaled)
    # A scene with a single zone does not use `warm_start`, as the closed form is a better first
    # guess.
    if warm_start is not None and len(warm_start.zones) and not context.single:
        table = placed(scaled.problem, warm_start.zones)
    if not model.strip:
        return search(context, scaled, table)
    return require(_STRIPS).centred(context, scaled, table)


def _under_loads(context: SolveContext) -> Outcome:
    """The contact under the scene's approach, from contacts under given loads."""
    if not context.scene.interaction.needs_period:
        return at_level(context)
    # A periodic scene is solved under trial loads. The solution that has nearly the wanted approach
    # is the warm start for the approach itself.
    scaled = scaled_scene(context.scene, context.single)
    context = context.with_warm_start(at_approach(context, SEARCH.rough))
    outcome = attempted(lambda: _of_scaled(context, scaled))
    if not isinstance(outcome, Failure):
        return outcome
    context.record_failure("zones under a load with about this approach", outcome)
    context = context.with_warm_start(at_approach(context, SEARCH.intermediate))
    return _of_scaled(context, scaled)
