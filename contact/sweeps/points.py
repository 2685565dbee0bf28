"""The main numbers of a solution, by name and in SI units, as one row of a table."""

from math import nan

from contact.solution.report import total_width
from contact.solution.solution import Solution

# Unit and description of each number, by the name of the number.
NUMBERS = {
    "load": ("N/m", "load, per period if there is a period"),
    "mean_pressure": ("Pa", "load divided by the period"),
    "max_pressure": ("Pa", "largest pressure"),
    "approach": ("m", "approach of the bodies"),
    "contact_fraction": ("1", "width in contact divided by the period"),
    "total_width": ("m", "width in contact"),
    "stiffness": ("N/m^2", "d load / d approach"),
    "mean_gap": ("m", "mean of the gap over the period"),
    "zone_count": ("1", "number of contact zones; 0 in full contact or if the surfaces are apart"),
    "error": ("1", "stated bound of the relative error"),
}


def numbers(solution: Solution) -> dict[str, float]:
    """Value of each number in `NUMBERS`: nan if undefined, inf for an infinite value."""
    own = {"total_width": total_width(solution), "zone_count": len(solution.zones)}
    values = {name: own[name] if name in own else getattr(solution, name) for name in NUMBERS}
    return {
        name: nan if value is None else value if isinstance(value, int) else float(value)
        for name, value in values.items()
    }
