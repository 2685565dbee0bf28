"""What an interaction model is: how the rest of the surface acts on the zones that are solved.

A model names its kernel, the right-hand-side terms of unknown amplitude and the conditions that close them. It works in
scaled lengths: `period` and `unit` (metres per scaled length) are given to it.
"""

from __future__ import annotations

from typing import ClassVar

import sie

CONTROLS = ("load", "mean_pressure", "approach", "half_width", "contact_fraction")
TURNING = ("tilt", "moment")


class Interaction:
    """Base of the interaction models. A model is a frozen dataclass in a file of its own.

    needs_period: the model means nothing without one. allows: the controls it accepts. exact: nothing is approximated.
    images: copies of the cell on each side that are kept explicitly, None for all of them (a periodic kernel).
    strip: the zones are those of one strip, cut from the period at its widest gap and centred on them.
    turns: one body alone, which may be given a tilt or a moment.
    follows_isolated: the amplitude of the first column is the mean isolated load of the same total width.
    """

    name: ClassVar[str]
    needs_period: ClassVar[bool] = False
    allows: ClassVar[tuple[str, ...]] = CONTROLS
    exact: ClassVar[bool] = True
    strip: ClassVar[bool] = False
    turns: ClassVar[bool] = False

    @property
    def images(self) -> int | None:
        return 0

    @property
    def follows_isolated(self) -> bool:
        return False

    def kernel(self, period: float | None, unit: float) -> sie.Kernel:
        """The kernel in scaled lengths."""
        raise NotImplementedError

    def columns(self, period: float | None, centre: float) -> tuple[sie.Forcing, ...]:
        """Terms of the right side with an unknown amplitude, about the centre of the strip."""
        return ()

    def side_conditions(self, period: float | None) -> tuple[sie.Condition, ...]:
        """One condition for each column."""
        return ()
