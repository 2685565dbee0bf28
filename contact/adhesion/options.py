"""Options that all modules of contact.adhesion share.

All of them are insensitive: a factor of two either way changes the number of steps, but no answer.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class SearchLimits:
    """Limits of loops that usually end long before: larger limits only delay a failure."""

    # Newton steps; halvings and doublings, which are more than a double has bits.
    max_iterations: int = 80
    # Steps of a flow, of a curve and of growth on a grid, and events in a row.
    max_steps: int = 3000
    # Tries of a fast way before a slower one is taken that is more certain.
    patience: int = 4


@dataclass(frozen=True)
class MoveOptions:
    """Moves of ends, and the widths at which zones begin and vanish.

    Lengths are relative to the interval or gap next to an end. A drive is the residual of an end
    in the direction of the flow.
    """

    # Longest step: if both ends of a gap move by it, a fifth of the gap is left.
    max_move: float = 0.4
    # A short step: of ends against the flow, of ends that are hardly driven, and away from an
    # unstable equilibrium.
    short_move: float = 0.02
    # A failed step is shortened to this part, and a safeguarded length or residual keeps it.
    least_part: float = 0.3
    # Below this part of another length or growth rate, one is small.
    small_part: float = 0.1
    # Largest error of a drive: past an equilibrium, and of a prediction.
    small_drive: float = 0.05
    # Ends that are driven by more than this do not come to rest in the gap or zone they shrink.
    hard_drive: float = 0.5
    # A gap below this part of its zones has closed, and a zone below this part of its former width
    # is lost, if its ends are driven by more than `hard_drive`.
    vanished: float = 0.01
    # Width of a new zone relative to the overlap, the interval or the period it begins in.
    new_width: float = 0.05
    # Factor of intervals that are widened until their ends are driven inward.
    widening: float = 1.25
    # With more zones than this, a prediction takes less time than the steps it replaces.
    few_zones: int = 8
    # Relative changes of an adhesion or a control that lead to one side of an equilibrium. The
    # least that exceeds the error of a guide is used.
    margins: tuple[float, ...] = (0.02, 0.06, 0.2)


@dataclass(frozen=True)
class SampleOptions:
    """Numbers of samples; extremes between samples are refined."""

    # Least number of samples between two ends.
    samples: int = 32
    # Number of samples of a profile without a resolution, and of the sign of the pressure on a
    # zone.
    profile_samples: int = 2049
    sign_samples: int = 128
    # Largest number of samples of the profile on a period, and of the gap between two ends; bounds
    # the memory.
    max_samples: int = 2**18
    max_gap_samples: int = 20000


LIMITS = SearchLimits()
MOVES = MoveOptions()
SAMPLES = SampleOptions()
