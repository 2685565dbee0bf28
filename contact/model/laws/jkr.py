"""JKR adhesion: a work of adhesion w holds the contact together, without range.

At the distance d from the end of a zone p ~ -sqrt(E* w/pi) / sqrt(d).

K. L. Johnson, K. Kendall & A. D. Roberts, Proc. R. Soc. Lond. A 324 (1971) 301-313; in the plane M.
Barquins, J. Adhesion 26 (1988) 1-12; of a wavy surface K. L.
Johnson, Int. J. Solids Struct. 32 (1995) 423-430, doi 10.1016/0020-7683(94)00111-9. Attraction has
no range: where the surfaces do not touch, nothing acts between them.
"""

from dataclasses import dataclass
from math import pi, sqrt
from typing import Any

from contact.model.checks import keep, positive
from contact.model.laws.base import Law
from contact.model.laws.frictionless import Frictionless
from contact.model.registry import register_law


@register_law("jkr")
@dataclass(frozen=True)
class JKR(Law):
    """Adhesion without range (Johnson, Kendall & Roberts), given by the work of adhesion.

    The contact has several equilibria; `contact.solve(scene, branch="advancing" | "receding")` says
    which one is meant (docs/adhesion.md).

    Parameters
    ----------
    work : float
        Work of adhesion, > 0 [J/m^2].

    Examples
    --------
    A cylinder of radius R under no load, and the load at which it comes off:
    -3 (pi E* w^2 R/16)^(1/3), with w the work of adhesion.

    >>> import contact
    >>> import numpy as np
    >>> law = contact.JKR(0.05)
    >>> scene = contact.Scene(contact.Parabola(1e-3), 1e9, contact.Isolated(), law=law, load=0.0)
    >>> solution = contact.solve(scene)
    >>> pull_off = -3 * (np.pi * 1e9 * 0.05**2 * 1e-3 / 16) ** (1 / 3)
    >>> bool(np.isclose(solution.pull_off.load, pull_off, rtol=1e-9))
    True
    >>> solution.certificate.stability > 0
    True
    """

    work: float
    units = {"work": "J/m^2"}

    allows = ("load", "mean_pressure", "approach", "half_width")
    pulls = True
    bare = Frictionless()

    def __post_init__(self) -> None:
        keep(self, positive, "work")

    def intensity(self, E_star: float) -> float:
        """The edge intensity K = -sqrt(E* w/pi) [Pa m^(1/2)], with w the work of adhesion. For this
        K, the elastic energy released by opening a unit of width, (pi/E*) K^2, equals w.
        """
        return -sqrt(E_star * self.work / pi)

    def refuses(self, scene: Any) -> str | None:
        if scene.interaction.strip:
            return (
                f"is not solved with the {scene.interaction.name} interaction, whose strip is only "
                "a part of the body: use contact.Isolated() or contact.Periodic()"
            )
        return None
