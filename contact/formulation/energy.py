r"""The elastic energy of a contact, U = (1/2) int p u dx = (1/2) (P approach - int p f dx).

In contact u = approach - f. The integral over a zone is taken in the angle theta of x = middle +
half cos(theta). In this variable the square roots of p at the ends are smooth, and evenly spaced
angles are as exact as the series of p. If f or one of its derivatives jumps in the zone, Gauss
panels between the jumps are used instead. Their nodes crowd at the ends of panels, so that
logarithmic terms of p there cost no digits. The number of nodes is doubled until the integral no
longer changes.
"""

from collections.abc import Callable

import numpy as np

from contact.formulation.fields import ZoneFields
from contact.formulation.full_contact import ApartFields, FullFields
from contact.formulation.gaps import GapFields
from contact.formulation.protocol import Fields
from contact.formulation.quadrature import IN_PANEL, panels, sides
from contact.model.profiles.noise import EPS
from sie import Array, wrapped


def elastic_energy(fields: Fields) -> float | None:
    """Elastic energy [J/m]: half of int pressure * displacement dx.
    It is None if the approach is undefined.

    The energy is taken per period if there is one. The result is also None for the strip of a
    localized model, which is only a part of the body.
    """
    if isinstance(fields, ApartFields):
        return 0.0
    units, approach = fields.problem.units, fields.approach
    if approach is None or fields.problem.interaction.strip:
        return None
    pressed = fields.borne_beside * units.load * units.height + shape_moment(fields)
    return float(0.5 * (fields.load * approach - pressed))


def shape_moment(fields: Fields) -> float:
    """Integral of the pressure times the height of the profile above its lowest place [N].

    The integral is taken over the contact. The profile is turned as the body is.
    """
    if isinstance(fields, FullFields):
        moment = _shape_moment_of_period(fields)
    elif isinstance(fields, ZoneFields | GapFields):
        moment = _shape_moment_of_zones(fields)
    else:
        return 0.0
    units = fields.problem.units
    return moment * units.load * units.height


def _shape_moment_of_zones(fields: ZoneFields | GapFields) -> float:
    """Integral of pressure times scaled profile F over the zones, in scaled variables."""
    problem = fields.problem
    breaks, total = np.sort(problem.forcing.jumps.broken_at), 0.0
    shape = fields.standing_shape if isinstance(fields, ZoneFields) else problem.shape
    pressure = fields.density.at if isinstance(fields, ZoneFields) else fields.pressure_in
    for zone, (a, b) in enumerate(fields.zones):
        half = 0.5 * (b - a)

        def integrand(
            angle: Array, zone: int = zone, a: float = a, b: float = b, half: float = half
        ) -> Array:
            left, right = sides(angle)
            x = np.where(left <= right, a + half * left, b - half * right)
            return _bounded(pressure(zone, left, right)) * shape(x) * np.sqrt(left * right)

        images = wrapped(breaks, a, problem.period)
        inside = np.sort(images[(images > a) & (images < b)])
        angles = np.arccos(np.clip((inside - 0.5 * (a + b)) / half, -1.0, 1.0))[::-1]
        cuts = np.concatenate(([0.0], angles, [np.pi]))
        total += half * _integral(integrand, cuts, smooth=len(angles) == 0)
    return total


def _shape_moment_of_period(fields: FullFields) -> float:
    """Integral of scaled pressure times scaled profile over one period of full contact."""
    problem = fields.problem
    units, period = problem.units, problem.repeat_length
    start = float(units.scaled(np.array(problem.profile.x0)))
    breaks = start + np.unique(np.mod(problem.forcing.jumps.broken_at - start, period))

    def integrand(x: Array) -> Array:
        return _bounded(fields.pressure(units.x(x))) / units.pressure * problem.shape(x)

    first = breaks[0] if len(breaks) else start
    cuts = np.append(breaks if len(breaks) else start, first + period)
    return _integral(integrand, cuts, smooth=len(breaks) == 0)


def _bounded(pressure: Array) -> Array:
    """The pressure at nodes of a quadrature, with 0 in place of infinite values.

    At a tip the pressure tends to infinity like a logarithm. A node that rounds to the tip has a
    weight of the size of round-off, so its value does not count.
    """
    return np.asarray(np.where(np.isfinite(pressure), pressure, 0.0))


def _integral(
    function: Callable[[Array], Array], cuts: Array, smooth: bool, max_nodes: int = 2**17
) -> float:
    """Integral of `function` from the first to the last cut.
    The number of nodes doubles until the integral converges.

    smooth: the function is smooth and periodic, so that evenly spaced nodes are best.
    """

    def sums(count: int) -> tuple[float, float]:
        if smooth:
            length = cuts[-1] - cuts[0]
            x = cuts[0] + (np.arange(count) + 0.5) * length / count
            weight = np.full(count, length / count)
        else:
            x, weight = panels(cuts, count)
        value = weight * function(x)
        return float(value.sum()), float(np.abs(value).sum())

    count, (last, _) = IN_PANEL, sums(IN_PANEL)
    while count < max_nodes:
        count *= 2
        here, size = sums(count)
        if abs(here - last) <= 64 * EPS * size:
            return here
        last = here
    return last
