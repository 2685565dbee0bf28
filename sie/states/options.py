"""Options of the estimates of errors, and of inexact solutions."""

from dataclasses import dataclass


@dataclass(frozen=True)
class ErrorOptions:
    """Options of the estimates of errors, and of inexact solutions."""

    # The largest of some hundred rounding errors is about four times their root mean square.
    safety: float = 4.0
    # Errors below this fraction of another one are negligible beside it. Iterations are solved to
    # this relative tolerance for random errors of the rows, and relative to the truncation.
    negligible: float = 1e-2
    # Number of samples of random errors. With four, the estimate is below a quarter of the true
    # size in one of a hundred cases.
    samples: int = 4
    # Singular parts are not evaluated closer to an end than this distance, in half widths.
    end_distance: float = 0.03
    # Neglected coefficients are assumed to decay at this fraction of the observed rate.
    slower_fall: float = 0.9


OPTIONS = ErrorOptions()
