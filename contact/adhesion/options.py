"""Options that all modules of contact.adhesion share.

A change of any option by a factor of two changes the number of steps, but no result.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class SearchLimits:
    """Limits of loops that usually end much earlier; larger limits only delay a failure."""

    # Largest number of Newton steps, and of halvings or doublings of a number. More halvings would
    # change nothing, as 2^-80 is far below round-off.
    max_iterations: int = 80
    # Largest number of steps in one loop: of a gradient flow, along a curve of equilibria, or while
    # intervals grow on a grid. It is also the largest number of events of one loading path.
    max_steps: int = 3000
    # Number of attempts of a fast method before a slower and more reliable method is used. It also
    # serves as a small count in tests, such as the number of doublings in `driven_inward`.
    patience: int = 4


@dataclass(frozen=True)
class MoveOptions:
    """Options for the steps of ends, and for the widths at which zones begin and vanish.

    Lengths are relative to the interval or gap next to an end. A drive is the residual of an end
    in the direction of the flow.
    """

    # Longest step of an end, divided by the width of the interval or gap next to it. If both ends
    # of a gap move by this length, a fifth of the gap is left.
    max_move: float = 0.4
    # Length of a short step of an end, divided by the width of the interval or gap next to it. Ends
    # with a small residual make short steps against the direction of the flow. A short step also
    # leads away from an unstable equilibrium.
    short_move: float = 0.02
    # Factor by which a failed step is shortened. From one step to the next, a step length grows at
    # most by 1 / `least_part`, and the unit of the control falls at most by `least_part`.
    least_part: float = 0.3
    # A length, a growth rate or a residual of the wrong sign counts as small below this fraction of
    # the value with which it is compared.
    small_part: float = 0.1
    # Largest accepted error of a predicted residual. A larger residual of the wrong sign shows that
    # an end has passed an equilibrium, even after a short step.
    small_drive: float = 0.05
    # If both ends of a gap (or zone) tend to close it with residuals that exceed this number in
    # size, the gap (or zone) vanishes before its ends reach equilibrium.
    hard_drive: float = 0.5
    # A gap has closed if it is narrower than this fraction of the narrower zone next to it. A zone
    # is lost if it is narrower than this fraction of its former width. In the gradient flow, the
    # residuals of both ends must also exceed `hard_drive`.
    vanished: float = 0.01
    # Width of a new zone, divided by the width of the overlap, interval or period in which the zone
    # begins.
    new_width: float = 0.05
    # Factor by which an interval is widened, repeatedly, until its ends tend to recede.
    widening: float = 1.25
    # With more zones than this, the prediction of the residuals takes less time than the steps that
    # it replaces.
    few_zones: int = 8
    # Relative changes of the adhesion or of the control, tried in ascending order. At an
    # approximate equilibrium, some ends tend to advance and others to recede. After a change larger
    # than the error of the equilibrium, all ends tend to move the same way, as the search needs.
    margins: tuple[float, ...] = (0.02, 0.06, 0.2)


@dataclass(frozen=True)
class SampleOptions:
    """Numbers of sample points; extremes between sample points are refined."""

    # Least number of sample points of the gap between two ends. All other searches for an extreme
    # take this number of sample points.
    samples: int = 32
    # Least number of sample points of a profile. It is used if a profile states no resolution.
    profile_samples: int = 2049
    # Least number of points at which the sign of the pressure on a zone is tested.
    sign_samples: int = 128
    # Largest number of sample points of the profile on a period. It bounds the memory.
    max_samples: int = 2**18
    # Largest number of sample points of the gap between two ends. It bounds the memory.
    max_gap_samples: int = 20000


LIMITS = SearchLimits()
MOVES = MoveOptions()
SAMPLES = SampleOptions()
