r"""The elastic energy of a contact, U = (1/2) int p u dx = (1/2) (P approach - int p f dx): where
the body bears, u = approach - f.

The integral over a zone goes by its angle, x = middle + half cos(theta): what p has of roots at the
ends is smooth there, and even angles are as exact as the series of p is. Between places where f or
one of its derivatives jumps it goes by Gauss's rule on panels whose nodes crowd at their ends, so
that logarithms there cost no digits. The nodes are doubled until nothing changes any more.
"""

from collections.abc import Callable

import numpy as np

from contact.formulation.fields import ZoneFields
from contact.formulation.full_contact import ApartFields, FullFields
from contact.formulation.gaps import GapFields
from contact.formulation.protocol import Fields
from contact.formulation.quadrature import panels, sides
from sie import Array, wrapped

# Nodes of a zone to begin with; changes that are none, over the sum of all moduli; how many nodes
# at most.
_NODES = 32
_CHANGE = 1e-14
_MOST = 2**17


def elastic_energy(fields: Fields) -> float | None:
    """(1/2) int p u dx [J/m], per period where there is one; None without an approach, or where a
    strip stands for a period.
    """
    if isinstance(fields, ApartFields):
        return 0.0
    problem, units = fields.problem, fields.problem.units
    approach = fields.approach
    if approach is None or problem.interaction.strip:
        return None
    if isinstance(fields, FullFields):
        pressed = _of_period(fields)
    else:
        pressed = fields.borne_beside + (
            _of_zones(fields) if isinstance(fields, (ZoneFields, GapFields)) else 0.0
        )
    return float(0.5 * (fields.load * approach - pressed * units.load * units.height))


def _of_zones(fields: ZoneFields | GapFields) -> float:
    """int p F dx, scaled."""
    problem = fields.problem
    breaks, total = np.sort(problem.forcing.jumps.broken_at), 0.0
    shape = fields.standing_shape if isinstance(fields, ZoneFields) else problem.shape
    pressure = fields.density.at if isinstance(fields, ZoneFields) else fields.pressure_in
    for zone, (a, b) in enumerate(fields.zones):
        half = 0.5 * (b - a)

        def bears(
            angle: Array, zone: int = zone, a: float = a, b: float = b, half: float = half
        ) -> Array:
            left, right = sides(angle)
            x = np.where(left <= right, a + half * left, b - half * right)
            return np.asarray(pressure(zone, left, right) * shape(x) * np.sqrt(left * right))

        turned = wrapped(breaks, a, problem.period)
        inside = np.sort(turned[(turned > a) & (turned < b)])
        inner = np.arccos(np.clip((inside - 0.5 * (a + b)) / half, -1.0, 1.0))[::-1]
        total += half * _integral(
            bears, np.concatenate(([0.0], inner, [np.pi])), smooth=len(inner) == 0
        )
    return total


def _of_period(fields: FullFields) -> float:
    """int p F dx over the period, scaled, in full contact."""
    problem = fields.problem
    units, period = problem.units, problem.repeat_length
    start = float(units.scaled(np.array(problem.profile.x0)))
    breaks = start + np.unique(np.mod(problem.forcing.jumps.broken_at - start, period))

    def bears(x: Array) -> Array:
        return np.asarray(fields.pressure(units.x(x)) / units.pressure * problem.shape(x))

    first = breaks[0] if len(breaks) else start
    return _integral(
        bears, np.append(breaks if len(breaks) else start, first + period), smooth=len(breaks) == 0
    )


def _integral(function: Callable[[Array], Array], cuts: Array, smooth: bool) -> float:
    """From the first of ascending cuts to the last, by ever more nodes until nothing changes; even
    ones where it is smooth and repeats.
    """

    def sums(count: int) -> tuple[float, float]:
        if smooth:
            length = cuts[-1] - cuts[0]
            x, weight = (
                cuts[0] + (np.arange(count) + 0.5) * length / count,
                np.full(count, length / count),
            )
        else:
            x, weight = panels(cuts, count)
        value = weight * function(x)
        return float(value.sum()), float(np.abs(value).sum())

    count, (last, _) = _NODES, sums(_NODES)
    while count < _MOST:
        count *= 2
        here, size = sums(count)
        if abs(here - last) <= _CHANGE * size:
            return here
        last = here
    return last
