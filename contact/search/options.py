"""`SearchOptions`: the numbers that several files of the search share."""

from dataclasses import dataclass


@dataclass(frozen=True)
class SearchOptions:
    """Tolerances of intermediate solutions, fractions that count as small, iteration limits."""

    # Relative error of rough solutions: on coarse grids, under trial loads that give a guess of the
    # zones, and in the first corrections of a guess with very many zones. Zones or gaps narrower
    # than this fraction of their neighbours are lost in rough solutions.
    rough: float = 1e-3
    # Relative error of solutions under trial loads. These solutions serve to find the load that
    # gives a wanted approach or contact fraction.
    intermediate: float = 1e-6
    # Factor of a tolerance where errors grow on the way to the result: for gaps next to wide zones,
    # and in differences of two solutions.
    tight_factor: float = 1e-2
    # Allowed error on grids that just resolve the contact. An error of the contact width is
    # relative to the smaller of contact width and gap width. An error of the load's centre is
    # relative to the extent of the contact.
    grid_error: float = 0.02
    # Allowed error of the contact width on a fine grid, in units of the mean zone width.
    missing_zones: float = 0.3
    least_error: float = 1e-13  # the smallest stated error that may be asked for
    # First guess for the width of a zone or gap that may be absent from the solution. It is
    # relative to the former width of this interval or, for a new zone, to the width of the overlap
    # of the bodies. Newton's method decides whether the interval stays.
    doubtful_part: float = 0.1
    # A load, divided by E* and a length of the scene, at which the contact is far narrower than
    # that length.
    light_load: float = 1e-3
    # Largest number of steps of iterations that normally end earlier. Halving a bracket takes some
    # 60 steps, and shrinking a window from metres to atoms some 100.
    max_steps: int = 300
    # Largest number of loads tried for a given approach, contact fraction or other quantity.
    # Halving the bracket until round-off stops it takes about 60 loads.
    max_loads: int = 80
    max_attempts: int = 4  # limit; usually the first or second attempt succeeds


SEARCH = SearchOptions()

# Smallest tolerance that is passed to the solver `sie`: ten times the round-off of one operation.
LEAST = 2e-15
