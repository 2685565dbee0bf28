"""`SearchOptions`: the numbers that several files of the search share."""

from dataclasses import dataclass


@dataclass(frozen=True)
class SearchOptions:
    """Tolerances of solutions on the way, small parts, and limits of iterations."""

    # Relative error of rough solutions: of coarse grids, of loads from which zones are guessed, and
    # of the first rounds of very many zones. What is narrower than this part of its neighbours is
    # lost in them.
    rough: float = 1e-3
    # relative error of the last grid, and of solutions under loads on the way to another control
    intermediate: float = 1e-6
    # factor on a tolerance whose error is magnified: gaps beside wide zones, and differences
    tight_factor: float = 1e-2
    # error of a contact width, or of the centre of a load, from grids that just resolve it
    grid_error: float = 0.02
    # error of a contact width on the last grid, in units of the mean zone width
    missing_zones: float = 0.3
    least_error: float = 1e-13  # the smallest stated error that may be asked for
    # Width of an interval that may be absent, divided by that of the one it comes from. Newton's
    # method decides whether it stays.
    doubtful_part: float = 0.1
    # a load, divided by E* and a length, whose contact is far narrower than that length
    light_load: float = 1e-3
    # Limit of iterations that end by themselves: halving a bracket alone takes some 60, and
    # shrinking a window from metres to atoms some 100.
    max_steps: int = 300
    max_attempts: int = 4  # limit of attempts of which the first or second usually succeeds


SEARCH = SearchOptions()

# Smallest tolerance asked of the engine: ten times the round-off of one operation.
LEAST = 2e-15
