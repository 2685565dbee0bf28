"""What a law is: what happens at the interface of the two bodies.

A law declares how the pressure ends, p ~ K / sqrt(d) at distance d from the end of a zone, what a
solution has to be checked for, and which controls and ways of solving hold under it. Nothing else
of the package knows a law by its name.
"""

from collections.abc import Mapping
from math import pi
from typing import Any, ClassVar

import sie
from contact.model.controls.base import CONTROLS
from contact.model.registry import Named


class Law(Named, sie.Kept):
    """Base of the laws. A law is a frozen dataclass in a file of its own; what it leaves out is not
    taken for granted.

    Attributes
    ----------
    allows : tuple of str
        The controls that it admits.
    turns : bool
        Whether a body under it may be given a tilt or a moment.
    pulls : bool
        Whether the pressure may be negative; where not, its sign is checked in every zone.
    convex : bool
        Whether right signs make a contact the only one, so that it grows with the load whatever way
        it was come by: without it there are no first guesses from a grid's pressure alone, and no
        load path.
    by_gaps : bool
        Whether there is nothing between the bodies where they do not touch, so that contact nearly
        full may be solved by its gaps.
    full_contact : bool
        Whether full contact is that of the least pressure zero.
    bare : Law or None
        A convex law of which every contact lies within one that is reached by growing under this
        one, where there are several: their branch is followed from there
        (contact.adhesion.edge_branch).

    Examples
    --------
    A parabola that adheres, p ~ K/sqrt(d) at its ends: P = pi E* a^2/(4 R) + pi K sqrt(2 a) (M.
    Barquins, J. Adhesion 26, 1988, 1, doi 10.1080/00218468808071271).

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
    >>> scene = contact.Scene(contact.Parabola(1.0), 1e9, contact.Isolated(), law=Sticky(1e5), half_width=1e-3)
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

    def intensity(self, E_star: float) -> float:
        """K [Pa m^(1/2)] at the ends of zones that are free to move, or held where a half width is
        given; negative where it pulls.
        """
        return 0.0

    @property
    def tension(self) -> float:
        """Stress [Pa] with which the surfaces pull where the gap is above zero and below `reach`; 0
        where nothing acts there.
        """
        return 0.0

    @property
    def reach(self) -> float:
        """Gap [m] from which on nothing acts; 0 where nothing acts beside the contact."""
        return 0.0

    def without_range(self, share: float) -> "Law | None":
        """A law of this share of the work of adhesion whose attraction has no range, which contacts
        under this one come near to where what acts beside them is narrow; None if there is none.
        """
        return None

    def surface_energy(self, fields: Any, width: float) -> float:
        """Energy of the interface [J/m] of fields (`contact.formulation.energy.Fields`) that touch
        over a width [m]: less what closing it has released, (pi/E*) K^2 for each width.
        """
        E_star = fields.problem.units.E_star
        return -pi / E_star * self.intensity(E_star) ** 2 * width

    def refuses(self, scene: Any) -> str | None:
        """Why the law does not go with a scene (`contact.Scene`) of admitted controls, in words
        that end a sentence; None if it does.
        """
        return None

    def fault(self, fields: Any, load: float | None) -> str:
        """What is wrong with a solution (`contact.fields.ZoneFields`) beyond signs, balance and
        overlaps; empty if nothing is.
        """
        return ""
