"""Singular integral equations with Cauchy and Hilbert kernels, on zones with unknown ends."""

from typing import TYPE_CHECKING, Any

from sie.basis import lazy

if TYPE_CHECKING:
    from sie.basis.compiled import in_threads
    from sie.basis.data import Array, Complex, Index, Kept, Mask, nearest_image, record, wrapped
    from sie.basis.kernels import Kernel, Smooth, cauchy, hilbert, images
    from sie.basis.lazy import uncollected
    from sie.basis.zones import (
        BOUNDED,
        FREE,
        SINGULAR,
        End,
        Zones,
        bounded_with_value,
        free_with_intensity,
        free_with_value,
    )
    from sie.density.density import Density
    from sie.ends.motions import EndRates, end_motions, end_rates
    from sie.ends.newton import Free, find_ends
    from sie.ends.options import NewtonOptions, WarmStart
    from sie.ends.sources import Answers, answers
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
    from sie.equation.equation import CountError, Equation
    from sie.equation.forcing import Forcing, Jumps, Resolution
    from sie.graded.density import GradedDensity
    from sie.jumps.poles import AlgebraicPoints
    from sie.results.derivative import Derivative
    from sie.results.gradient import Gradient
    from sie.results.moved_density import MovedDensity
    from sie.results.report import Report
    from sie.second_kind.density import SecondKindDensity
    from sie.second_kind.state import SecondKindState
    from sie.slits.density import SlitDensity
    from sie.slits.system import AnyDensity, AnyState, solve_zones
    from sie.solver import NotConverged, Solution, solve
    from sie.states.solve import SingularSystem, solve_fixed
    from sie.states.state import State
    from sie.trees.piecewise import PiecewiseTransform

__all__ = [
    "AlgebraicPoints",
    "Amplitude",
    "Answers",
    "AnyDensity",
    "AnyState",
    "Array",
    "BOUNDED",
    "Complex",
    "Condition",
    "CountError",
    "Density",
    "Derivative",
    "End",
    "EndRates",
    "EqualPotential",
    "Equation",
    "FREE",
    "Forcing",
    "Free",
    "GradedDensity",
    "Gradient",
    "Index",
    "Jumps",
    "Kept",
    "Kernel",
    "Level",
    "Mask",
    "MovedDensity",
    "NewtonOptions",
    "NotConverged",
    "PiecewiseTransform",
    "Report",
    "Resolution",
    "Rows",
    "SINGULAR",
    "SecondKindDensity",
    "SecondKindState",
    "SingularSystem",
    "SlitDensity",
    "Smooth",
    "Solution",
    "State",
    "Total",
    "TotalWidth",
    "WarmStart",
    "Weighted",
    "ZoneMoments",
    "ZoneTotals",
    "Zones",
    "answers",
    "cauchy",
    "end_motions",
    "end_rates",
    "find_ends",
    "bounded_with_value",
    "free_with_intensity",
    "free_with_value",
    "hilbert",
    "images",
    "in_threads",
    "moment",
    "nearest_image",
    "record",
    "solve",
    "solve_fixed",
    "solve_zones",
    "uncollected",
    "wrapped",
]

# A module is loaded when one of its names is first used. So a program that needs only `Zones` does
# not load the search for ends. The imports above list the same names for readers and type checkers.
_HOMES = {
    "sie.basis.compiled": "in_threads",
    "sie.basis.data": "Array Complex Index Kept Mask nearest_image record wrapped",
    "sie.basis.kernels": "Kernel Smooth cauchy hilbert images",
    "sie.basis.zones": "BOUNDED FREE SINGULAR End Zones bounded_with_value free_with_intensity "
    "free_with_value",
    "sie.states.solve": "SingularSystem solve_fixed",
    "sie.states.state": "State",
    "sie.density.density": "Density",
    "sie.equation.conditions": "Amplitude Condition EqualPotential Level Rows Total TotalWidth "
    "Weighted ZoneMoments ZoneTotals moment",
    "sie.equation.equation": "CountError Equation",
    "sie.equation.forcing": "Forcing Jumps Resolution",
    "sie.graded.density": "GradedDensity",
    "sie.basis.lazy": "uncollected",
    "sie.trees.piecewise": "PiecewiseTransform",
    "sie.ends.motions": "EndRates end_motions end_rates",
    "sie.ends.newton": "Free find_ends",
    "sie.ends.options": "NewtonOptions WarmStart",
    "sie.ends.sources": "Answers answers",
    "sie.jumps.poles": "AlgebraicPoints",
    "sie.results.derivative": "Derivative",
    "sie.results.gradient": "Gradient",
    "sie.results.moved_density": "MovedDensity",
    "sie.results.report": "Report",
    "sie.second_kind.density": "SecondKindDensity",
    "sie.second_kind.state": "SecondKindState",
    "sie.slits.density": "SlitDensity",
    "sie.slits.system": "AnyDensity AnyState solve_zones",
    "sie.solver": "NotConverged Solution solve",
}
_HOME = {name: module for module, names in _HOMES.items() for name in names.split()}


if not TYPE_CHECKING:  # a type checker must report unknown names

    def __getattr__(name: str) -> Any:
        if name not in _HOME:
            raise AttributeError(f"module 'sie' has no attribute {name!r}")
        found = globals()[name] = getattr(lazy.module(_HOME[name]), name)
        return found


def __dir__() -> list[str]:
    return sorted(__all__)
