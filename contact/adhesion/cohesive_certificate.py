"""What is checked of a contact with a tension beside it, beyond what its frictionless part is: the
reach, and stability.

p >= -s inside the zones is q = p + s >= 0, which that part's certificate looks at, with overlaps
and the balance of the whole load.
"""

from dataclasses import replace
from functools import cached_property

import numpy as np

from contact.adhesion.cohesive_fields import PulledFields, scaled_second_variation
from contact.adhesion.cohesive_zone import Cohesive, CohesivePoint
from contact.adhesion.inner_contact import look_at
from contact.formulation.fields import ZoneFields
from contact.formulation.tables import gaps_between, located
from contact.verify.certificate import Certificate, least_eigenvalue
from contact.verify.error import SolvedZones, reference
from sie import AnyDensity, Array, record, wrapped

# A miss of the reach, over it, and what rounding of heights may make of it.
_REACH = 1e-7
# Beside the ends of the tension, over the width of its interval, gaps are not told apart from the
# reach.
_BESIDE = 1e-9


# Over what the ends of the tension are off by, what the pressure is off by at equal normalised
# position: zones and strips move together.
_MOVED = 16.0
# Places of a zone at which its slope is looked at, and no nearer in the angle to its ends.
_LOOKS = 2048
_AWAY = 0.3


@record
class FoundBeside(SolvedZones):
    """Zones with a tension beside them. beside: what it adds to the error."""

    beside: float = 0.0

    @cached_property
    def error(self) -> float:
        return super().error + self.beside

    @property
    def main_cause(self) -> str:
        if self.beside < 0.5 * self.error:
            return ""
        return (
            f"the gap at the ends of the tension, known no closer to its reach than heights are rounded, adds {self.beside:.1e}; "
            "allow a larger tol, or give a law of less stress and longer reach"
        )


def certified(
    plain: Certificate,
    curve: Cohesive,
    here: CohesivePoint | None,
    fields: PulledFields | None = None,
) -> Certificate:
    """The certificate of the frictionless part, with what the tension adds; here: None where it
    acts everywhere, on these fields.
    """
    stress = curve.stress * curve.problem.units.pressure
    least = plain.smallest_pressure - stress
    held, name = plain.holds, curve.held.name
    if here is None:
        assert fields is not None
        _, gap = look_at(fields)
        inside = bool(np.all(gap < curve.reach * (1 + _REACH)))
        note = "the gap is below the reach of the tension everywhere: the frictionless contact, less the tension, and as stable"
        return replace(
            plain,
            smallest_pressure=least,
            holds=held and inside,
            note=note if inside else "the gap is above the reach",
        )
    (x, gap), table, period = here.look, here.table, curve.problem.round
    place = wrapped(x, table[0, 0], period)
    i, within = located(table, place)
    next_one = gaps_between(table, period)[:, 1]
    away = np.minimum(
        np.minimum(np.abs(place - table[i, 0]), np.abs(place - table[i, 1])),
        np.abs(next_one[i] - place),
    )
    told = away > _BESIDE * (table[i, 1] - table[i, 0])
    assert here.q is not None
    rounding = here.q.gap_rounding
    wrong = told & np.where(within, gap > curve.reach + rounding, gap < curve.reach - rounding)
    missed = max(float(np.abs(here.residual).max()), float(-here.whole.residual.min()))
    stability = least_eigenvalue(scaled_second_variation(here))
    if not held:
        note = plain.note or "a sign or the balance fails"
    elif missed > _REACH + 4 * rounding / curve.reach:
        held, note = False, f"at an end of the tension the gap misses its reach by {missed:.1e}"
    elif wrong.any():
        at = float(curve.problem.units.x(place[wrong])[0])
        held, note = (
            False,
            f"the gap is on the wrong side of the reach of the tension at x = {at:.6g} m",
        )
    elif not stability > 0.0:
        held, note = (
            False,
            f"not stable under a held {name}: the second variation of the energy is not positive",
        )
    else:
        note = (
            "one of several equilibria: pressure above minus the tension in contact, no overlap, balance, the gap below the reach where "
            f"the tension acts, above it elsewhere and equal to it at its ends, locally stable under a held {name}"
        )
    return replace(
        plain,
        smallest_pressure=least,
        holds=bool(held),
        note=note,
        intensity=missed,
        stability=stability,
    )


def uncertain(curve: Cohesive, here: CohesivePoint, fields: ZoneFields) -> float:
    """What the ends of the tension may be off by, and the zones by it, over the width of either;
    and what the pressure of these fields is by that.
    """
    assert here.q is not None
    rounding = here.q.gap_rounding / 16 / curve.reach
    ends = np.abs(np.linalg.solve(here.rates, here.residual)) + np.abs(
        np.linalg.inv(here.rates)
    ) @ np.full(len(here.residual), rounding)
    # The load of q is the difference of the tension's and the given one.
    load = (
        4.0 * np.finfo(np.float64).eps * (abs(here.load) + curve.stress * float(here.widths.sum()))
    )
    follow = np.abs(here.by_ends[:, :-1]) @ ends + np.abs(here.by_ends[:, -1]) * curve.yields * load
    followed = follow.reshape(2, -1).T / np.diff(here.zones, axis=1)
    density, problem = fields.density, fields.problem
    largest = max(
        reference(density, problem.end, problem.borne(density)), np.finfo(np.float64).tiny
    )
    steep = np.maximum(_MOVED, _steepness(density) / largest)
    return max(
        _MOVED * float((ends / here.widths).max()), float((steep * followed.max(axis=1)).max())
    )


def _steepness(density: AnyDensity) -> Array:
    """The steepest slope of the pressure of each zone a width, away from its ends (Z,)."""
    out = np.zeros(len(density.zones))
    for zone, count in enumerate(np.minimum(density.sampling, _LOOKS).tolist()):
        theta = np.linspace(_AWAY, np.pi - _AWAY, count)
        out[zone] = 2 * float((np.abs(density.by_angle(zone, theta)[1]) / np.sin(theta)).max())
    return out


def rounded_load(fields: PulledFields) -> float:
    """What rounding may make of zones under tension in all of a period: the load of q is that of
    the tension and the given one, which may nearly cancel.
    """
    total, pull = fields.density.total, fields.tension.total
    rounding = 2 * np.finfo(np.float64).eps * (abs(total - pull) + pull) / total
    widening = np.abs(fields.spreading) / np.diff(fields.zone_table, axis=1)
    return float(rounding * max(1.0, widening.max()))
