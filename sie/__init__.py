"""Singular integral equations with Cauchy and Hilbert kernels on any number of zones, fixed or with unknown ends."""

from sie.basis.ends import BOUNDED, FREE, SINGULAR, End, free_with_intensity
from sie.basis.kept import Kept
from sie.basis.kernels import Kernel, Smooth, cauchy, hilbert, images
from sie.basis.zones import Zones
from sie.collocation.fixed import SingularSystem, State, solve_fixed
from sie.density.density import Density
from sie.density.interval_potential import LocalPotential
from sie.equation.conditions import (
    Amplitude,
    Condition,
    EqualPotential,
    Level,
    Rows,
    Total,
    TotalWidth,
    Weighted,
    ZoneMoments,
    ZoneTotals,
    moment,
)
from sie.equation.equation import CountError, Equation, Forcing
from sie.fast.piecewise import PiecewiseTransform
from sie.free_ends.end_rates import EndRates, end_rates
from sie.free_ends.newton import Free, find_ends
from sie.free_ends.sources import Answers, answers
from sie.slits.density import Pierced
from sie.slits.system import AnyDensity, AnyState, solve_zones
from sie.solver import NotConverged, Solution, solve

__all__ = [
    "Answers", "AnyDensity", "AnyState", "BOUNDED", "FREE", "SINGULAR", "Amplitude", "Condition", "CountError", "Density", "End",
    "EndRates", "EqualPotential", "Equation", "Forcing", "Free", "Kept", "Kernel", "Level", "LocalPotential", "NotConverged",
    "PiecewiseTransform", "Pierced", "Rows", "SingularSystem", "Smooth", "Solution", "State", "Total", "TotalWidth", "Weighted",
    "ZoneMoments", "ZoneTotals", "Zones", "answers", "cauchy", "end_rates", "find_ends", "free_with_intensity", "hilbert", "images",
    "moment", "solve", "solve_fixed", "solve_zones",
]
