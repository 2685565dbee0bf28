"""What an interaction model is: how the rest of the surface acts on the zones that are solved.

A model names its kernel, the right-hand-side terms of unknown amplitude and the conditions that close them. It works in
scaled lengths: `period` and `unit` (metres per scaled length) are given to it.
"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

import sie
from contact.model.spectrum import excess, kernel_of

Array = NDArray[np.float64]

CONTROLS = ("load", "mean_pressure", "approach", "half_width", "contact_fraction")
TURNING = ("tilt", "moment")


class Interaction:
    """Base of the interaction models. A model is a frozen dataclass in a file of its own.

    needs_period: the model means nothing without one: its kernel is that of all periods, unless it has a `strip`. allows: the controls it
    accepts. exact: nothing is approximated. datum, where nothing repeats: the length [m] in the logarithm of the displacement;
    without it there is no approach.
    strip: the zones are those of one strip, cut from the period at its widest gap and centred on them; neighbours: how many copies of it
    on each side are in its kernel.
    turns: one body alone, which may be given a tilt or a moment.
    follows_isolated: the amplitude of the first column is the mean isolated load of the same total width.
    """

    name: ClassVar[str]
    needs_period: ClassVar[bool] = False
    allows: ClassVar[tuple[str, ...]] = CONTROLS
    exact: ClassVar[bool] = True
    strip: ClassVar[bool] = False
    turns: ClassVar[bool] = False
    datum: Any = None
    neighbours: Any = 0

    @property
    def has_approach(self) -> bool:
        return self.needs_period or self.datum is not None

    @property
    def follows_isolated(self) -> bool:
        return False

    def symbol(self, q: Array) -> Array | None:
        """L(q), q [1/m]: a pressure wave displaces the surface by u_q = 2 L p_q / (E* q); L -> 1 for large q. None: not declared.

        It is what the operator is inverted by: without it there is no full contact. A model gives its symbol, its kernel, or both.
        """
        return None

    def kernel(self, period: float | None, unit: float) -> sie.Kernel:
        """The kernel in scaled lengths, of x - xi alone; left out, that of the symbol over a period."""
        found = None if period is None else excess(self.symbol, period * unit)
        if period is None or found is None:
            needed = "a kernel, or, for all periods, a symbol" if self.needs_period else "a kernel"
            raise NotImplementedError(f"{type(self).__name__} must give {needed}")
        return kernel_of(found, period)

    def columns(self, period: float | None, centre: float) -> tuple[sie.Forcing, ...]:
        """Terms of the right side with an unknown amplitude, about the centre of the strip."""
        return ()

    def side_conditions(self, period: float | None) -> tuple[sie.Condition, ...]:
        """One condition for each column."""
        return ()
