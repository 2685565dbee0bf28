"""The equilibrium of a scene on the branch that its task asks for."""

from contact.adhesion import cohesive_branch, edge_branch
from contact.runtime import one_blas_thread
from contact.search.feasibility import refuse_unbounded
from contact.search.task import Task
from contact.search.ways.guesses import Outcome


def found(task: Task) -> Outcome:
    """The contact of the task's scene; OutOfRange past pull-off."""
    refuse_unbounded(task.scene)
    with one_blas_thread():
        if task.scene.law.tension:
            return cohesive_branch.followed_under_tension(task)
        return edge_branch.followed(task)
