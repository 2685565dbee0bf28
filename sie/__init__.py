"""Singular integral equations with Cauchy and Hilbert kernels on any number of zones, fixed or with unknown ends."""

from sie.conditions import (
    Amplitude,
    Condition,
    EqualPotential,
    Level,
    Total,
    TotalWidth,
    Weighted,
    ZoneMoments,
    ZoneTotals,
    moment,
)
from sie.density import Density
from sie.ends import BOUNDED, FREE, SINGULAR, End, free_with_intensity
from sie.equation import CountError, Equation, Forcing
from sie.free_boundary import Free, find_ends
from sie.kept import Kept
from sie.kernels import Kernel, Smooth, cauchy, hilbert, images
from sie.local import LocalPotential
from sie.piecewise import PiecewiseTransform
from sie.pierced import Pierced
from sie.released import AnyDensity, AnyState, solve_zones
from sie.solve import SingularSystem, State, solve_fixed
from sie.solver import NotConverged, Solution, solve
from sie.zones import Zones

__all__ = [
    "AnyDensity", "AnyState", "BOUNDED", "FREE", "SINGULAR", "Amplitude", "Condition", "CountError", "Density", "End", "EqualPotential",
    "Equation", "Forcing", "Free", "Kept", "Kernel", "Level", "LocalPotential", "NotConverged", "PiecewiseTransform",
    "Pierced", "SingularSystem", "Smooth", "Solution", "State", "Total",
    "TotalWidth", "Weighted", "ZoneMoments", "ZoneTotals", "Zones", "cauchy", "find_ends", "free_with_intensity", "hilbert",
    "images", "moment", "solve", "solve_fixed", "solve_zones",
]
