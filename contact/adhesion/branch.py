"""The equilibrium of a scene on the branch, advancing or receding, that its context names."""

from contact.adhesion import cohesive_branch, edge_branch
from contact.adhesion.full_contact import as_not_converged
from contact.runtime import one_blas_thread
from contact.search.context import SolveContext
from contact.search.feasibility import refuse_unbounded
from contact.search.refine import refined
from contact.search.strategies.guesses import Outcome


def found(context: SolveContext) -> Outcome:
    """The adhesive contact of the context's scene. Raises OutOfRange past pull-off."""
    refuse_unbounded(context.scene)
    with one_blas_thread(), as_not_converged():
        if context.scene.law.tension:
            # Under a cohesive law the search itself solves as precisely as possible, so that
            # `refined` is not needed.
            return cohesive_branch.followed_under_tension(context)
        return refined(context, edge_branch.followed(context), edge_branch.followed)
