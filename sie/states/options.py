"""Options of the estimates of errors, and of inexact solutions."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class ErrorOptions:
    """Options of the error estimates of solutions."""

    # Ratio of the largest to the root mean square of some hundred rounding errors.
    safety: float = 4.0
    # An error below this fraction of another error is negligible.
    negligible: float = 1e-2
    # Number of samples of random errors. With four samples, the estimate is below a quarter of the
    # true error in one of a hundred cases.
    samples: int = 4
    # At points closer to an end than this distance (in half widths), error estimates take the
    # factor 1 / sqrt(1 - t^2) of the density at this distance.
    end_distance: float = 0.03
    # Neglected coefficients are assumed to decay at this fraction of the observed decay rate.
    slower_fall: float = 0.9


OPTIONS = ErrorOptions()

# Number of points of each zone at which the residual is evaluated, and their angles. None of these
# points is a node.
CHECK_POINTS = 15
CHECK_ANGLES = (np.arange(CHECK_POINTS) + 0.4142) * np.pi / CHECK_POINTS
