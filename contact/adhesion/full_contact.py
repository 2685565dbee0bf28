"""Early test whether an adhesive contact snaps into full contact by itself as it advances.

Soft and rough surfaces close altogether under no load at all. On their way there, thousands of
zones begin and merge, and following each of them takes minutes. The same growth on a coarse grid
takes a tenth of a second. Three conditions are tested, the cheap ones first:

1. Full contact is an equilibrium: its least pressure is above the limit of the law.
2. The energy of full contact is below the energy at first touch. A contact that grows only lowers
    its energy, so otherwise it cannot reach full contact.
3. The contact on the grid, grown from first touch, ends in full contact. A strong attraction acts
    on a strip next to each zone, and this strip is too narrow for the grid. So a weaker attraction
    with the same work and a longer reach replaces it. Its strips are a few cells wide. As long as
    the strips are much narrower than the zones, only the work matters.

The map from the intervals on which the attraction acts to {gap < reach} is monotone under a fixed
load. So a contact that closes under a load also closes under every larger load.
"""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from contact.adhesion.curve import ACCURACY, Closed, Curve
from contact.adhesion.grid_guide import GRID, shares_below
from contact.adhesion.options import LIMITS, MOVES
from contact.errors import ContactError, NotConverged
from contact.formulation.full_contact import FullLimit
from contact.search.context import SolveContext
from contact.search.grid.conjugate_gradient import solve_grid
from contact.search.grid.nested_grids import grid_height
from contact.search.grid.proposals import whole_response

# Errors that numpy and the engine `sie` raise if an intermediate state cannot be solved.
NUMERICAL_ERRORS = (ValueError, ArithmeticError, np.linalg.LinAlgError, IndexError)


@dataclass(frozen=True)
class SnapOptions:
    """Options of the test, on a grid, whether a contact would end in full contact."""

    # Factor on the work of adhesion in the grid test for full contact, if the test is made before
    # the contact is followed step by step. A test after a failure uses the whole work.
    work_share: float = 0.9
    # Width, in cells of the grid, of the strip around a zone on which the adhesion acts. With only
    # 3 cells, the ends of the zones would stick to the cells.
    strip_cells: float = 6.0


_OPTIONS = SnapOptions()
_SEEN_ON_GRID = (
    "on a coarse grid the contact grows to full contact; not all zones on the way were computed"
)


def _note(context: SolveContext) -> None:
    """Add to the plan that the contact on a coarse grid ends in full contact."""
    part = context.plan["branch"]
    part.detail = "; ".join(filter(None, (part.detail, _SEEN_ON_GRID)))


@contextmanager
def closing_foreseen(context: SolveContext, curve: Curve, value: float) -> Iterator[None]:
    """Raise `Closed` if the contact, advancing at this control, would end in full contact.

    If following the contact would take long, the test is made first. It is also made after
    following the contact has failed.
    """
    if _is_followed_slowly(context) and _closes(context, curve, value, _OPTIONS.work_share):
        _note(context)
        raise Closed
    try:
        yield
    except (ContactError, *NUMERICAL_ERRORS) as failure:
        if _closes(context, curve, value, 1.0):
            _note(context)
            raise Closed from failure
        raise


@contextmanager
def as_not_converged() -> Iterator[None]:
    """Convert errors of numpy and of the engine `sie` into NotConverged."""
    try:
        yield
    except ContactError:
        raise
    except NUMERICAL_ERRORS as failure:
        raise NotConverged(
            f"a contact on the way to the given control could not be solved ({failure}): there "
            "may be too many zones or, under Dugdale's law, too narrow strips of tension beside "
            "them. Use a smoother profile, or JKR instead of Dugdale's law"
        ) from failure


def _is_followed_slowly(context: SolveContext) -> bool:
    """Whether following the ends of the zones is expected to take longer than the grid test."""
    profile = context.scene.profile
    return (
        profile.period is not None
        and profile.feature is not None
        and (context.scene.law.tension > 0.0 or profile.period > MOVES.few_zones * profile.feature)
    )


def _closes(context: SolveContext, curve: Curve, value: float, work_share: float) -> bool:
    """Whether a contact that grows from first touch under a fixed load ends in full contact."""
    scene, period = context.scene, context.scene.profile.period
    if period is None or curve.control.load is None or scene.profile.support is not None:
        return False
    law, operator = scene.law, context.operator
    assert law.bare is not None
    if not operator.has_inverse:
        return False
    mean_pressure = value * curve.problem.units.load / period
    limit = FullLimit(scene.profile, scene.E_star, operator, law.bare).pressure
    if not math.isfinite(limit) or (law.tension and mean_pressure + law.tension < limit):
        return False
    work = work_share * law.work_of_adhesion(scene.E_star)
    feature = scene.profile.feature or period
    # The grid has at least `GRID.cells` cells for each feature, and at least `GRID.cells` *
    # `few_zones` cells in a period. So the period is much wider than `strip_cells` cells.
    points = 2 ** math.ceil(math.log2(GRID.cells * max(period / feature, MOVES.few_zones)))
    if points > GRID.max_points:
        return False
    cell = period / points
    x = scene.profile.x0 + cell * (np.arange(points) + 0.5)
    height = grid_height(scene.profile, x)
    height = height - height.min()
    influence = whole_response(curve.problem).on(points, cell)
    waves = np.fft.rfft(height)[1:] / points
    stored = float(np.sum(influence.stiffness[1:] * np.abs(waves) ** 2))
    if stored >= work + mean_pressure * float(height.mean()):
        return False
    # A strip of attraction next to a wide zone has the width (pi/4) E* reach/stress, with the
    # contact modulus E*.
    stress = math.sqrt(0.25 * math.pi * scene.E_star * work / (_OPTIONS.strip_cells * cell))
    stress = min(stress, law.tension or math.inf)
    reach = work / stress
    share, pressure = shares_below(height - reach), None
    for _ in range(LIMITS.max_steps):
        state = solve_grid(
            height - influence.apply(stress * share),
            influence,
            load=mean_pressure * period + stress * float(share.sum()) * cell,
            start=pressure,
            tol=ACCURACY.coarse,
        )
        if np.all(state.gap < reach):
            return True
        grown = np.maximum(share, shares_below(state.gap - reach))
        change = float((grown - share).max())
        share, pressure = grown, state.pressure
        if change < MOVES.short_move:
            break
    return False
