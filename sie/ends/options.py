"""Options of the search for the ends, and what it starts from."""

from dataclasses import dataclass

import numpy as np

from sie.basis.zones import FREE, End
from sie.slits.system import AnyState
from sie.states.sizes import Sizes


@dataclass(frozen=True)
class NewtonOptions:
    """Options of Newton's method on the ends. Lengths are relative to the width of a zone.

    Parameters
    ----------
    max_steps : int
        The search gives up after this many Newton steps.
    signs : (float, float)
        Sign of the wanted density beside free left and free right ends. The slope of a gap, for
        example, is positive at left ends and negative at right ends.
    limits : (float, float)
        Interval that free ends do not leave. An end that reaches a limit is pinned there as a
        singular end. It is released when its intensity falls below that of `released_end`.
    released_end : End
        Kind of an end after its release from a limit.
    decay : float or None
        Truncation tolerance of the coefficients, relative to the largest; None: a tenth of the
        tolerance of the ends.
    bounded_ends : bool
        Whether the remaining 1/sqrt(d) parts are removed from the last density. It is then
        accurate at equal normalised position to first order in the errors of the ends.
    allow_loss : bool
        Whether the search continues without zones that vanish, and with zones that merge. If
        False, it stops there.
    unresolved_fraction : float
        Fraction of all ends that may be left unconverged, after `patience` steps. This gives a
        cheap first look at very many zones.
    patience : int
        Newton steps granted to these ends.
    max_shrink, max_growth, max_closing : float
        Damping: largest part of its zone, or of the gap next to it, by which an end moves in a
        step. Two ends that face each other across a gap must not meet, so the parts are below 1/2.
    border_distance : float
        An end this close to the border of the domain of g, over its zone's width, has no root
        before it. Nearer ends would take more nodes than a zone may have.
    max_response_move : float
        The response to the value of the open condition is kept while all ends together move by less
        than this part of all widths. It then changes a step by the same relative amount.
    forcing, first_solution, last_solution : float
        Inexact Newton (S. C. Eisenstat and H. F. Walker, SIAM J. Sci. Comput. 17, 1996, 16-32): the
        linear system is solved to `forcing` * step^3, so that its error stays below that of two
        more Newton steps; to `first_solution` at first, and at last to `last_solution` * tolerance.
    rough_solution : float
        Rough sums, accurate to this, serve solutions that are looser.
    step_margin : float
        The remaining error of an end is its next step, with this factor for the terms of second
        order.
    rounding_step : float
        Steps below this are rounding where they no longer become smaller.
    stalled_steps : int
        After so many steps without progress, rounding may be the reason. With `allow_loss`, zones
        with the wrong sign of the density are given up after as many steps, once these are small.
    wandering_steps : int
        Steps after which ends that still move by half of their zones are given up.
    close_step : float
        Small steps are below this. A guess is a close one if its first step is, and each further
        step is below this part of the step before.
    vanished_part : float
        A zone or a gap that has shrunk to this part of its first size has vanished.
    last_zone_vanished : float
        The last zone of all keeps the given total however narrow it is: it vanishes later.
    insistent_steps : int
        A zone or a narrow gap has vanished if so many steps in a row ask for nothing to be left.
    closing_gap : float
        Such a gap is below this part of the zones next to it.
    slight_zone : float
        A zone below this part of the zone next to it is hardly felt by the others.

    Examples
    --------
    >>> import sie
    >>> sie.NewtonOptions(signs=(1.0, -1.0)).max_steps
    40
    """

    max_steps: int = 40
    signs: tuple[float, float] = (1.0, 1.0)
    limits: tuple[float, float] = (-np.inf, np.inf)
    released_end: End = FREE
    decay: float | None = None
    bounded_ends: bool = True
    allow_loss: bool = False
    unresolved_fraction: float = 0.0
    patience: int = 0

    max_shrink: float = 0.3
    max_growth: float = 0.5
    max_closing: float = 0.4
    border_distance: float = 1e-6
    max_response_move: float = 0.01
    forcing: float = 1e-3
    first_solution: float = 1e-5
    last_solution: float = 1e-3
    rough_solution: float = 1e-7
    step_margin: float = 1.5
    rounding_step: float = 1e-6
    stalled_steps: int = 5
    wandering_steps: int = 20
    close_step: float = 0.3
    vanished_part: float = 1e-3
    last_zone_vanished: float = 1e-12
    insistent_steps: int = 3
    closing_gap: float = 0.05
    slight_zone: float = 0.01


@dataclass(frozen=True, eq=False)
class WarmStart:
    """What is known when a search for the ends starts.

    Parameters
    ----------
    value : float
        First guess for the value of an open condition.
    initial_error : float
        Error of the first ends over their zones' widths, as far as it is known. The better the
        ends are, the tighter is the first iterative solution.
    modes_like : State, SlitState, Sizes or None
        A solution on about the same zones. The search starts with as many modes, and from its
        unknowns if it is the last solution that used these sizes.
    abandon_if_far : bool
        Whether the search stops, unconverged, as soon as a step shows that the zones are not close
        to a solution.

    Examples
    --------
    >>> import sie
    >>> sie.WarmStart(value=0.1).initial_error
    1.0
    """

    value: float = 0.0
    initial_error: float = 1.0
    modes_like: AnyState | Sizes | None = None
    abandon_if_far: bool = False
