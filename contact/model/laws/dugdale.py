"""Maugis-Dugdale adhesion: a constant tension where the gap is below a reach.

The work of adhesion is stress times reach.

D. Maugis, J. Colloid Interface Sci. 150 (1992) 243-269, doi 10.1016/0021-9797(92)90285-T; in the
plane J. M. Baney & C.-Y. Hui, J. Adhes. Sci. Technol. 11 (1997) 393-406, doi
10.1163/156856197X00778. The constant tension is due to D. S. Dugdale, J. Mech. Phys. Solids 8
(1960) 100-104, doi 10.1016/0022-5096(60)90013-2.
"""

from dataclasses import dataclass
from typing import Any

from contact.model.checks import keep, positive
from contact.model.laws.base import Law
from contact.model.laws.frictionless import Frictionless
from contact.model.laws.jkr import JKR
from contact.model.registry import register_law


@register_law("dugdale")
@dataclass(frozen=True)
class Dugdale(Law):
    """Adhesion of finite range: the tension `stress` acts where the gap is below work/stress.

    For large `stress` the contact tends to that under JKR's law, for small `stress` to that of a
    rigid body. The contact may have several equilibria;
    `contact.solve(scene, branch="advancing" | "receding")` says which one is meant
    (docs/adhesion.md).

    Parameters
    ----------
    work : float
        Work of adhesion, > 0 [J/m^2].
    stress : float
        Tension next to the contact, > 0 [Pa].

    Examples
    --------
    A cylinder of radius R under no load: pi E* a^2/(4 R) = 2 s sqrt(c^2 - a^2), with a the half
    width of the zone, c the distance from the axis at which the tension ends, and s the stress.

    >>> import contact
    >>> import numpy as np
    >>> law = contact.Dugdale(work=0.05, stress=2e6)
    >>> scene = contact.Scene(contact.Parabola(1e-3), 1e9, contact.Isolated(), law=law, load=0.0)
    >>> solution = contact.solve(scene)
    >>> a, c = solution.zones[0, 1], solution.cohesive[0, 1]
    >>> bool(np.isclose(np.pi * 1e9 * a**2 / 4e-3, 2 * 2e6 * np.sqrt(c**2 - a**2), rtol=1e-8))
    True
    >>> round(float(solution.pressure(0.5 * (a + c))), 3)
    -2000000.0
    >>> bool(np.isclose(solution.gap(c), 0.05 / 2e6))
    True
    """

    work: float
    stress: float
    units = {"work": "J/m^2", "stress": "Pa"}

    allows = ("load", "mean_pressure", "approach")
    pulls = True
    bare = Frictionless()

    def __post_init__(self) -> None:
        keep(self, positive, "work", "stress")

    @property
    def tension(self) -> float:
        return self.stress

    @property
    def reach(self) -> float:
        return self.work / self.stress

    def without_range(self, share: float) -> Law:
        return JKR(share * self.work)

    def surface_energy(self, fields: Any, width: float) -> float:
        """The surface energy [J/m]. It is minus the work of adhesion times the width in which the
        tension acts or the surfaces touch, plus the work that opens the gap against the tension.
        """
        cohesive = fields.cohesive
        if len(cohesive) == 0:  # full contact, or surfaces apart
            return -self.work * width
        return -self.work * float((cohesive[:, 1] - cohesive[:, 0]).sum()) + self.stress * float(
            fields.opened
        )

    def refuses(self, scene: Any) -> str | None:
        if scene.interaction.strip:
            return (
                f"is not solved with the {scene.interaction.name} interaction: use "
                "contact.Isolated() or contact.Periodic()"
            )
        return None
