"""`Law`, the base of the laws of the interface, and the three objects by which a law is used.

A law declares the edge intensity K: the pressure is p ~ K / sqrt(d) at the distance d from the end
of a zone. A law also answers one question each for the certificate, the search and the solver:

    pressure_range   bounds of the pressure in a zone: which signs the certificate checks
    equilibria       one contact for a load, or several, and the law whose contact starts a branch
    routes           which formulations hold, or the module that solves scenes under this law

The certificate, the search and the solver know no law by its name.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import inf, isfinite, pi
from typing import Any, ClassVar

import sie
from contact.model.controls.base import CONTROLS
from contact.model.registry import Named


@dataclass(frozen=True)
class PressureRange:
    """Bounds [Pa] of the pressure in a zone.

    lowest: 0 if the surfaces can only push each other, -inf if they can also pull. highest: inf, or
    a pressure that no contact may exceed, such as the pressure at which a surface yields.
    """

    lowest: float = 0.0
    highest: float = inf

    @property
    def has_tension(self) -> bool:
        """Whether the surfaces may attract each other."""
        return self.lowest < 0.0

    @property
    def has_limit(self) -> bool:
        """Whether the pressure has a limit, so that it may be constant on plateaus."""
        return isfinite(self.highest)


@dataclass(frozen=True)
class Equilibria:
    """Whether there is one equilibrium contact at each value of the control (e.g. of the load).
    If there are several at one value, a branch of equilibria starts from the contact under another
    law (`start`).

    unique: whether a contact with right signs of pressure and gap is the only one. start: another
    law, if there are several equilibria. Its zones lie within those of the growing contact.
    """

    unique: bool
    start: "Law | None" = None

    @property
    def several(self) -> bool:
        """Whether there are several equilibria at one value of the control."""
        return self.start is not None


@dataclass(frozen=True)
class Routes:
    """The formulations that are valid under a law, and the module that solves scenes under this
    law.

    gaps: whether nothing acts where the bodies do not touch, so that the gaps may be the unknowns.
    full_contact: whether full contact begins when its lowest pressure is zero. module: dotted name
    of a module whose function `found(context)` solves every scene under this law; None for the
    general search. first: another law. The contact under this other law is solved for first, on the
    routes of the other law. If its pressure lies within `pressure_range`, this contact is the
    answer; else it is the module's warm start.

    `found` takes a `contact.search.context.SolveContext` and returns an outcome, such as a
    `contact.verify.error.SolvedZones`. Its outcome is final: the solver does not refine it, as the
    general search knows nothing of the law's equations. If its error is above the tolerance,
    NotConverged is raised. A module may call `contact.search.refine.refined` itself.
    """

    gaps: bool
    full_contact: bool
    module: str | None = None
    first: "Law | None" = None


class Law(Named, sie.Kept):
    """Base of the laws of the interface. A law is a frozen dataclass in a file of its own.

    Most laws declare only the attributes below. The solver uses `pressure_range`, `equilibria` and
    `routes`, which follow from these attributes, and which a law may override. The default value of
    each attribute is the cautious choice.

    Attributes
    ----------
    allows : tuple of str
        Names of the controls that the law admits.
    turns : bool
        Whether the body may be given a tilt or a moment.
    pulls : bool
        Whether the pressure may be negative; if not, the certificate checks its sign in every zone.
    convex : bool
        Whether a contact with right signs of pressure and gap is the only one, so that the zones
        grow with the load on every path. Otherwise the solver follows no load path and takes no
        first guess from the pressure on a grid.
    by_gaps : bool
        Whether nothing acts between the bodies where they do not touch, so that nearly full contact
        may be solved by its gaps.
    full_contact : bool
        Whether full contact begins when its lowest pressure is zero.
    bare : Law or None
        If a load has several equilibria: a convex law whose zones lie within those that the growing
        contact has under the present law. The branch of this contact is followed from the contact
        under the convex law (contact.adhesion.edge_branch).

    Examples
    --------
    A parabola that adheres, p ~ K/sqrt(d) at its ends: P = pi E* a^2/(4 R) + pi K sqrt(2 a) (M.
    Barquins, J. Adhesion 26, 1988, 1).

    >>> import contact
    >>> import numpy as np
    >>> from dataclasses import dataclass
    >>> @dataclass(frozen=True)
    ... class Sticky(contact.Law):
    ...     K: float
    ...     name = "sticky"
    ...     pulls = True
    ...     def intensity(self, E_star):
    ...         return -self.K
    >>> scene = contact.Scene(
    ...     contact.Parabola(1.0), 1e9, contact.Isolated(), law=Sticky(1e5), half_width=1e-3
    ... )
    >>> load = np.pi * 1e9 * 1e-6 / 4 - np.pi * 1e5 * np.sqrt(2e-3)
    >>> bool(np.isclose(contact.solve(scene).load, load, rtol=1e-9))
    True
    """

    units: ClassVar[Mapping[str, str]] = {}
    allows: ClassVar[tuple[str, ...]] = CONTROLS
    turns: ClassVar[bool] = False
    pulls: ClassVar[bool] = False
    convex: ClassVar[bool] = False
    by_gaps: ClassVar[bool] = False
    full_contact: ClassVar[bool] = False
    bare: "ClassVar[Law | None]" = None

    @cached_property
    def pressure_range(self) -> PressureRange:
        """Bounds of the pressure in a zone. The certificate checks that the pressure lies within
        them.
        """
        return PressureRange(-inf if self.pulls else 0.0)

    @cached_property
    def equilibria(self) -> Equilibria:
        """Whether the equilibrium is unique (`convex`), and the law `bare` that starts a branch.
        A branch is a sequence of equilibria; its first contact is the one under the law `bare`.
        """
        return Equilibria(bool(self.convex), self.bare)

    @cached_property
    def routes(self) -> Routes:
        """The formulations that are valid under this law."""
        return Routes(bool(self.by_gaps), bool(self.full_contact))

    def intensity(self, E_star: float) -> float:
        """The edge intensity K [Pa m^(1/2)]: the pressure is K / sqrt(distance) near an end of a
        zone. The law sets K at free ends, and at ends fixed by a given half width.

        K is negative if the surfaces pull each other at the ends of zones.
        """
        return 0.0

    @property
    def tension(self) -> float:
        """Stress [Pa] that pulls the surfaces together where the gap is between 0 and `reach`.

        0 where nothing acts outside the contact.
        """
        return 0.0

    @property
    def reach(self) -> float:
        """Gap [m] above which the surfaces do not attract each other; 0 if they attract each other
        only in contact.
        """
        return 0.0

    @property
    def shear_ratio(self) -> float:
        """Shear traction on body 1 along +x, divided by the pressure; 0 without friction."""
        return 0.0

    @property
    def kappa(self) -> float:
        """Factor kappa in T p + kappa p = (E*/2) f'; 0 without elastic mismatch.
        T is the integral operator of the kernel, p the pressure and f' the slope of the profile.

        With a period, the left side is T p + kappa (p - mean p).
        """
        return 0.0

    @classmethod
    def completed(
        cls, parameters: Mapping[str, Any], moduli: Mapping[str, float]
    ) -> Mapping[str, Any]:
        """The law's parameters from a scene file, and further ones that follow from the moduli.
        This base class adds none.

        moduli: E1, nu1 and perhaps E2, nu2 of the scene file, or E_star alone.
        """
        return parameters

    def without_range(self, share: float) -> "Law | None":
        """A law of zero range with `share` times this law's work of adhesion; None if undefined.

        The narrower the intervals of tension are, the closer are contacts under this law to those
        under the returned law.
        """
        return None

    def work_of_adhesion(self, E_star: float) -> float:
        """Work of adhesion [J/m^2]: (pi/E*) K^2 plus tension times reach.
        K is the edge intensity, `reach` the largest gap at which the tension acts.
        """
        return pi / E_star * self.intensity(E_star) ** 2 + self.tension * self.reach

    def surface_energy(self, fields: Any, width: float) -> float:
        """Energy of the interface [J/m] of a contact whose zones have the total width `width` [m].

        It is minus the energy that closing the surfaces has released: (pi/E*) K^2 times `width`.
        fields: `contact.formulation.protocol.Fields`.
        """
        E_star = fields.problem.units.E_star
        return -pi / E_star * self.intensity(E_star) ** 2 * width

    def refuses(self, scene: Any) -> str | None:
        """Reason why the law cannot be used with a scene; None if it can be used.

        The reason is the end of a sentence. The scene (`contact.Scene`) has a control that the law
        allows.
        """
        return None

    def fault(self, fields: Any, load: float | None) -> str:
        """Reason why a solution violates the law although the signs of pressure and gap and the
        load balance are right; empty if there is no such reason.

        fields: `contact.formulation.protocol.Fields`. load: the given load in the units of
        `fields.problem.units`; None if the scene gives another control.
        """
        return ""
