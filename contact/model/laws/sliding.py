"""Full sliding with Coulomb friction between bodies that may differ elastically.

Where the bodies touch, the shear traction on body 1, which lies below, is q = direction friction p.
If the bodies differ, the shear displaces the surface normally too, and the pressure p obeys

    T p + kappa p = (E*/2) f',    kappa = -direction friction beta,

with T the integral operator of the kernel and Dundurs' constant beta. On a periodic surface the
second term is kappa (p - mean p), as a uniform shear causes no slope. K. L. Johnson, Contact
Mechanics, 1985, sects. 2.4 and 7.1, doi 10.1017/CBO9781139171731; J. Dundurs, J. Appl. Mech. 36
(1969) 650-652.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from contact.model.checks import (
    both_or_neither,
    checked_number,
    finite,
    keep,
    non_negative,
    poisson_ratio,
    positive,
)
from contact.model.controls.base import Quantity
from contact.model.laws.base import Law, Routes
from contact.model.registry import register_law
from contact.model.substrates.half_plane import HalfPlane


def dundurs_beta(E1: float, nu1: float, E2: float | None = None, nu2: float | None = None) -> float:
    """Dundurs' constant beta of two bodies in plane strain; without E2 and nu2 body 2 is rigid.

    With the shear moduli G = E / (2 + 2 nu) it is

        2 beta = [(1 - 2 nu1)/G1 - (1 - 2 nu2)/G2] / [(1 - nu1)/G1 + (1 - nu2)/G2].

    Parameters
    ----------
    E1, E2 : float
        Young's moduli [Pa] of body 1, which lies below, and of body 2, which slides over it.
    nu1, nu2 : float
        Poisson's ratios [1], above -1 and at most 0.5; nu2 is given with E2.

    Returns
    -------
    float
        beta [1], from -1/2 to 1/2 for ratios from 0 to 1/2. It is 0 for equal bodies, and for
        incompressible ones.

    Raises
    ------
    SceneError
        If a modulus is not positive, a ratio out of range, or one of E2, nu2 is given without the
        other.

    Examples
    --------
    Rubber against a rigid body, and steel on aluminium.

    >>> import contact
    >>> contact.dundurs_beta(1e6, 0.5), round(contact.dundurs_beta(210e9, 0.3, 70e9, 0.33), 4)
    (0.0, -0.1167)
    """
    one = _compliances("1", E1, nu1)
    both_or_neither(E2, nu2)
    other_body = (0.0, 0.0) if E2 is None or nu2 is None else _compliances("2", E2, nu2)
    return 0.5 * (one[0] - other_body[0]) / (one[1] + other_body[1])


def _compliances(body: str, E: float, nu: float) -> tuple[float, float]:
    """The numbers (1 - 2 nu)/G and (1 - nu)/G of one body, with its shear modulus G."""
    E, nu = positive(f"E{body}", E), poisson_ratio(f"nu{body}", nu)
    compliance = 2 * (1 + nu) / E
    return (1 - 2 * nu) * compliance, (1 - nu) * compliance


def _beta(field: str, value: Any) -> float:
    return checked_number(
        field,
        value,
        "a number from -0.5 to 0.5, the range of Dundurs' constant",
        lambda b: abs(b) <= 0.5,
    )


def _direction(field: str, value: Any) -> int:
    return int(checked_number(field, value, "1 or -1", lambda number: number in (1.0, -1.0)))


@register_law("sliding")
@dataclass(frozen=True)
class Sliding(Law):
    """Full sliding with friction: shear = direction * friction * pressure where the bodies touch.

    With beta = 0 (equal bodies, or incompressible ones) the pressure is that without friction. A
    scene file that gives E1, nu1 and not beta takes beta from them and from E2, nu2
    (docs/sliding.md).

    Parameters
    ----------
    friction : float
        Coefficient of friction, >= 0 [1].
    beta : float
        Dundurs' constant of the two bodies, from -1/2 to 1/2 [1]; see `contact.dundurs_beta`.
    direction : int
        1 if body 2 is dragged towards +x over body 1, -1 if towards -x.

    Examples
    --------
    A rigid cylinder of radius R on an elastic body with nu = 0.3: the zone moves backwards. The
    load for a zone of half width l is pi alpha (1 - alpha) E* l^2 / R, with
    alpha = 1/2 - arctan(kappa) / pi.

    >>> import contact
    >>> import numpy as np
    >>> law = contact.Sliding(friction=0.5, beta=contact.dundurs_beta(1e9, 0.3))
    >>> scene = contact.Scene(contact.Parabola(1.0), 1e9, contact.Isolated(), law=law, load=1e4)
    >>> solution = contact.solve(scene)
    >>> l, alpha = solution.zone_widths[0] / 2, 0.5 - np.arctan(law.kappa) / np.pi
    >>> bool(np.isclose(np.pi * alpha * (1 - alpha) * 1e9 * l**2, 1e4, rtol=1e-10))
    True
    >>> bool(np.isclose(solution.shear(0.0), 0.5 * solution.pressure(0.0)))
    True
    """

    friction: float
    beta: float = 0.0
    direction: int = 1
    units = {"friction": "1", "beta": "1"}

    turns = True
    convex = True
    by_gaps = True
    full_contact = True

    def __post_init__(self) -> None:
        keep(self, finite, "friction", "beta", "direction")
        keep(self, non_negative, "friction")
        keep(self, _beta, "beta")
        keep(self, _direction, "direction")

    @property
    def kappa(self) -> float:
        return -self.shear_ratio * self.beta + 0.0

    @property
    def shear_ratio(self) -> float:
        return self.direction * self.friction

    @cached_property
    def routes(self) -> Routes:
        """The formulations that are valid under this law.
        Without elastic mismatch (kappa = 0) they are those without friction.
        """
        return Routes(True, True, "contact.tangential.sliding" if self.kappa else None)

    @classmethod
    def completed(
        cls, parameters: Mapping[str, Any], moduli: Mapping[str, float]
    ) -> Mapping[str, Any]:
        """The parameters of the law; a missing beta follows from the moduli of two bodies."""
        if "beta" in parameters or "E1" not in moduli:
            return parameters
        return {**parameters, "beta": dundurs_beta(**moduli)}

    def refuses(self, scene: Any) -> str | None:
        if not isinstance(scene.substrate, HalfPlane) or scene.operator.is_own:
            return "is solved only for half-planes, without a kernel or symbol of your own"
        if not self.kappa:
            return None
        if scene.held(Quantity.HALF_WIDTH) is not None:
            return "with elastic mismatch has no symmetric zones: leave out half_width, give a load"
        if scene.interaction.strip:
            return (
                f"with elastic mismatch is not solved with the {scene.interaction.name} "
                "interaction: use contact.Isolated() or contact.Periodic()"
            )
        _, exponents, left, right = np.reshape(scene.profile.algebraic_points, (-1, 4)).T
        if np.any((exponents % 2 != 0) | (left != right)):
            return (
                f"with elastic mismatch is not solved for the {scene.profile.name} profile, whose "
                "slope contains a power of the distance from a point"
            )
        return None
