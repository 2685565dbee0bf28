"""What a law is: what happens at the interface of the two bodies.

A law declares how the pressure ends, p ~ K / sqrt(d) at distance d from the end of a zone, what a solution has to be checked for, and
which controls and ways of solving hold under it. Nothing else of the package knows a law by its name.
"""

from __future__ import annotations

from typing import Any, ClassVar

import sie

CONTROLS = ("load", "mean_pressure", "approach", "half_width", "contact_fraction")


class Law(sie.Kept):
    """Base of the laws. A law is a frozen dataclass in a file of its own; what it leaves out is not taken for granted.

    allows: the controls that it admits. turns: whether a body under it may be given a tilt or a moment.
    pulls: whether the pressure may be negative; where not, its sign is checked in every zone.
    convex: whether right signs make a contact the only one, so that it grows with the load whatever way it was come by: without it there
    are no first guesses from a grid's pressure alone, and no load path.
    by_gaps: whether there is nothing between the bodies where they do not touch, so that contact nearly full may be solved by its gaps.
    full_contact: whether full contact is that of the least pressure zero.
    bare: a convex law of which every contact lies within one that is reached by growing under this one, where there are several: their
    branch is followed from there (contact.search.branches).
    """

    name: ClassVar[str]
    allows: ClassVar[tuple[str, ...]] = CONTROLS
    turns: ClassVar[bool] = False
    pulls: ClassVar[bool] = False
    convex: ClassVar[bool] = False
    by_gaps: ClassVar[bool] = False
    full_contact: ClassVar[bool] = False
    bare: ClassVar[Law | None] = None

    def intensity(self, E_star: float) -> float:
        """K [Pa m^(1/2)] at the ends of zones that are free to move, or held where a half width is given; negative where it pulls."""
        return 0.0

    def refuses(self, scene: Any) -> str | None:
        """Why the law does not go with a scene (`contact.Scene`) of admitted controls, in words that end a sentence; None if it does."""
        return None

    def fault(self, fields: Any, load: float | None) -> str:
        """What is wrong with a solution (`contact.fields.ZoneFields`) beyond signs, balance and overlaps; empty if nothing is."""
        return ""
