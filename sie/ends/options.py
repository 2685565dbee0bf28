"""Options of the search for the ends, and data for a warm start."""

from dataclasses import dataclass

import numpy as np

from sie.basis.zones import FREE, End
from sie.slits.system import AnyState
from sie.states.sizes import Sizes


@dataclass(frozen=True)
class NewtonOptions:
    """Options of Newton's method for the ends of the zones.
    Lengths are relative to the width of the zone.

    Parameters
    ----------
    max_steps : int
        The search gives up after this many Newton steps.
    signs : (float, float)
        Sign of the wanted density close to free left and free right ends. The slope of a gap, for
        example, is positive at left ends and negative at right ends.
    limits : (float, float)
        Interval that free ends must not leave. An end that reaches a limit is pinned there as a
        singular end. It is released when its intensity falls below that of `released_end`.
    released_end : End
        Kind of an end after its release from a limit.
    decay : float or None
        Truncation tolerance of the density's coefficients, relative to the largest coefficient;
        None: a tenth of the tolerance of the ends.
    bounded_ends : bool
        Whether the terms 1/sqrt(d) that remain at free ends are removed from the last density. At
        equal positions relative to the zone, its relative error is then about that of the ends.
    allow_loss : bool
        Whether the search continues without zones that vanish, and with zones that merge. If
        False, it stops there.
    unresolved_fraction : float
        Fraction of all ends that may be left unconverged, after `patience` steps. This gives a
        cheap first approximation of very many zones.
    patience : int
        Number of Newton steps after which the fraction `unresolved_fraction` may be left.
    max_shrink, max_growth : float
        Damping: largest fraction of its zone's width by which an end moves inward (`max_shrink`) or
        outward (`max_growth`) in a step. An end moves outward by at most the fraction `max_shrink`
        of the gap next to it. If the density has given values at ends, an end moves inward by at
        most the fraction `max_growth` of this gap. Two ends that face each other must not meet, so
        `max_shrink` is below 1/2. It is also below `max_growth`, so that zones far from the
        solution rather become wider on their way.
    forcing, first_solution : float
        Inexact Newton (S. C. Eisenstat and H. F. Walker, SIAM J. Sci. Comput. 17, 1996, 16-32): the
        linear system is solved to `forcing` * step^3, so that its error stays below that of two
        more Newton steps. The tolerance is at most `first_solution`, and at least
        `forcing` * tolerance.
    step_margin : float
        The error of an end is estimated by its next step times this factor, which allows for terms
        of second order.
    rounding_step : float
        Steps of the ends below this length that no longer decrease are round-off.
    stalled_steps : int
        After this number of steps without progress, round-off may be the reason. With `allow_loss`,
        zones with the wrong sign of the density are given up after this number of steps, once the
        steps are below `close_step`.
    close_step : float
        A guess is close to a solution if its first step is below this number, and if each further
        step is below this fraction of the previous step.
    vanished_part : float
        A zone or a gap that has shrunk to this fraction of its first size has vanished. A single
        zone keeps the given total however narrow it is. So it has vanished only at the fourth
        power of this fraction.
    insistent_steps : int
        A zone, or a gap as narrow as a slit, has vanished if the undamped steps would remove it
        this number of times in a row.

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
    forcing: float = 1e-3
    first_solution: float = 1e-5
    step_margin: float = 2.0
    rounding_step: float = 1e-6
    stalled_steps: int = 5
    close_step: float = 0.3
    vanished_part: float = 1e-3
    insistent_steps: int = 3


@dataclass(frozen=True, eq=False)
class WarmStart:
    """Data known before a search for the ends of the zones, usually from a similar solution.
    They are the value of the open condition (the side condition without a given value), the error
    of the ends, and the numbers of modes.

    Parameters
    ----------
    value : float
        First guess for the value of the open condition (the side condition without a given value).
    initial_error : float
        Estimated error of the first ends, relative to their zones' widths. The smaller it is, the
        smaller is the tolerance of the first iterative solution.
    modes_like : State, SlitState, Sizes or None
        A solution on about the same zones, or its `Sizes`. The search starts with the same numbers
        of modes. `Sizes` also contain the unknowns of the last solution, as a first guess.
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
