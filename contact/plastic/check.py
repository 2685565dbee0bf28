"""The certificate of a contact with plateaus: signs of pressure, overlap and gap everywhere.

    elastic   0 < p < H
    plateau   overlap >= 0
    gap       gap >= 0

0 < p, gap >= 0 and the load are checked by `contact.verify.certificate`, as without plateaus.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from contact.formulation.tolerances import TOLERANCES
from contact.plastic.fields import PlasticFields
from contact.verify.certificate import Certificate, certify, openings, pressure_signs
from contact.verify.minima import SAMPLING
from sie import Array, record


@record
class Checked:
    """The certificate of a state, and the scaled intervals (n, 2) where the state is wrong.
    There, elastic contact must become a plateau or the reverse.

    above: the pressure is above the limit; opened: the surfaces would part on a plateau. Negative
    pressures and overlaps in gaps are in the certificate.
    """

    certificate: Certificate
    above: Array
    opened: Array


@record
class _Plateaus(PlasticFields):
    """Fields whose open intervals are the plateaus, with the overlap there in place of the gap.
    The check that gaps are not negative then checks that the overlap is not negative.
    """

    def open_intervals(self) -> Iterator[tuple[float, float, bool, bool]]:
        zones = self.density.zones
        ends = {*zones.a.tolist(), *zones.b.tolist()}
        period = self.problem.period
        if period is not None:
            ends.add(float(zones.a[0]) + period)
        for lo, hi in self.density.plateaus.tolist():
            yield lo, hi, lo in ends, hi in ends

    def far_stretches(self) -> Iterator[Array]:
        return iter(())

    def formal_gap(self, x: Array) -> Array:
        return -super().formal_gap(x)


def checked(fields: PlasticFields, load: float | None) -> Checked:
    """Check all signs and the load, and that the approach is the same on all elastic intervals."""
    samples: dict[int, Array] = {}
    below = pressure_signs(fields, fields.limit, samples)
    certificate = certify(fields, load, signs=pressure_signs(fields, samples=samples))
    above = np.array([*below.negative, *_tips(fields), *_corners(fields)]).reshape(-1, 2)
    above = above[np.argsort(above[:, 0])]
    opened, least, rounding, points = np.zeros((0, 2)), np.inf, 0.0, 0
    if len(fields.density.plateaus):
        part = openings(_Plateaus(fields.problem, fields.state, limit=fields.limit))
        opened, rounding, points = part.overlaps, part.rounding, part.points
        least = np.inf if part.least is None else part.least
    holds = certificate.holds and below.least > 0.0 and len(above) == len(opened) == 0
    undecided = -rounding <= least <= 0.0
    height = fields.problem.units.height
    note = certificate.note
    if holds and not note:
        note = (
            "the only contact: pressures from 0 to the limit, overlap on plateaus, no overlap in "
            "gaps"
        )
    return Checked(
        replace(
            certificate,
            holds=bool(holds),
            undecided=bool(certificate.undecided or undecided),
            points=certificate.points + below.points + points,
            note=note,
            smallest_overlap=None if np.isinf(least) else least * height,
        ),
        above,
        opened,
    )


def _corners(fields: PlasticFields) -> list[tuple[float, float]]:
    """Intervals beside sharp corners of the profile in which the pressure exceeds the limit H.

    At the distance d from a corner the elastic pressure is p ~ K / sqrt(d), which exceeds H for
    d < (K/H)^2. Intervals that are no wider than round-off are left out.
    """
    density, corners, found = fields.density, fields.problem.corners, []
    reach = (np.array(density.intensities) / fields.limit) ** 2
    zones = density.zones
    for i, (a, b) in enumerate(zones.table.tolist()):
        narrow = TOLERANCES.narrowest_gap * (b - a)
        if a == corners[0] and narrow < reach[0, i] < np.inf:
            found.append((a, a + min(float(reach[0, i]), 0.5 * (b - a))))
        if b == corners[1] and narrow < reach[1, i] < np.inf:
            found.append((b - min(float(reach[1, i]), 0.5 * (b - a)), b))
    return found


def _tips(fields: PlasticFields) -> list[tuple[float, float]]:
    """Intervals around convex kinks of the profile in which the pressure exceeds the limit.
    Only kinks in elastic parts of the contact are taken.

    Towards such a kink the pressure grows without bound, like the logarithm of the distance.
    """
    density, (kinks, heights) = fields.density, fields.problem.forcing.kinks
    at, zone, inside = density.locate(kinks[heights > 0])
    distances = np.geomspace(TOLERANCES.narrowest_gap, 1.0, SAMPLING.min_points)
    found = []
    for x, i in zip(at[inside].tolist(), zone[inside].tolist(), strict=True):
        half = float(density.zones.half[i])
        left, right = (x - density.zones.a[i]) / half, (density.zones.b[i] - x) / half
        room = distances[distances < min(left, right)]
        # `reach` lists the distances from the kink at which the pressure exceeds the limit, divided
        # by the half width of the zone.
        pressure = np.minimum(
            *(density.at(np.full(len(room), i), left + s * room, right - s * room) for s in (-1, 1))
        )
        reach = room[pressure > fields.limit]
        width = half * (float(reach.max()) if len(reach) else TOLERANCES.narrowest_gap)
        found.append((x - width, x + width))
    return found
