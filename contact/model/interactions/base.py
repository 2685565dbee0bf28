"""Base class of the interaction models: the action of the rest of the surface on the solved zones.

The substrate gives the effect of a line load. A model says which other loads act with a line load:
none, its copies in all periods, or its images in copies of a strip. A model may also add terms of
unknown amplitude to the right side, with conditions that determine the amplitudes. Models work in
scaled lengths: their methods get the scaled `period`, and `unit`, the metres in a scaled length 1.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, ClassVar

import sie
from contact.model.controls.base import CONTROLS
from contact.model.registry import Named
from sie import Array

Scaled = Callable[[Array], Array]


class Interaction(Named):
    """Base of the interaction models. A model is a frozen dataclass in a file of its own.

    All methods work in scaled lengths, whose origin the solver chooses. `columns` and
    `side_conditions` may depend on loads, widths and slopes. Terms and conditions that depend on a
    place of the profile belong in `placed_columns` and `placed_conditions`: these methods get a
    function that converts the place to scaled lengths.

    Attributes
    ----------
    needs_period : bool
        Whether the model needs a periodic profile. If so, all periods act, unless the model has a
        `strip`.
    allows : tuple of str
        The controls that the model accepts.
    exact : bool
        Whether the model makes no approximation.
    datum : float or None
        For a contact without a period: the distance [m] from a line load at which the load causes
        no displacement. If it is None, the approach is defined only on a substrate with a base.
    strip : bool
        Whether only the zones of one period, the strip, are solved. The strip is cut from the
        profile at the widest gap and centred on its zones.
    neighbours : int
        Number of copies of the strip, on each side, that are included in the kernel.
    turns : bool
        Whether the body may be tilted, by a given angle or a given moment.
    follows_isolated : bool
        Whether the amplitude of the first term in `columns` is the mean pressure of the isolated
        contact of the same total width.

    Examples
    --------
    A strip outside which no pressure acts.

    >>> import contact
    >>> import sie
    >>> from dataclasses import dataclass
    >>> @dataclass(frozen=True)
    ... class Bare(contact.Interaction):
    ...     name = "bare"
    ...     needs_period, strip = True, True
    ...     def side_conditions(self, period):
    ...         return (sie.Amplitude(0, 0.0),)
    >>> wave = contact.Sinusoid(1e-6, 1e-4)
    >>> models = Bare(), contact.Isolated()
    >>> scenes = [contact.Scene(wave, 1e9, model, load=1e3) for model in models]
    >>> bare, lone = (contact.solve(scene) for scene in scenes)
    >>> bool(abs(bare.zones - lone.zones).max() < 1e-12)
    True
    """

    units: ClassVar[Mapping[str, str]] = {}
    needs_period: ClassVar[bool] = False
    allows: ClassVar[tuple[str, ...]] = CONTROLS
    exact: ClassVar[bool] = True
    strip: ClassVar[bool] = False
    turns: ClassVar[bool] = False
    datum: Any = None
    neighbours: Any = 0

    @property
    def follows_isolated(self) -> bool:
        return False

    def kernel(self, period: float | None, unit: float) -> sie.Kernel:
        """The interaction's own kernel, a function of x - xi in scaled lengths. A model without
        this method uses the substrate's kernel.
        """
        raise NotImplementedError(
            f"{type(self).__name__} has no kernel of its own: it uses that of the substrate"
        )

    def symbol(self, q: Array) -> Array:
        """The symbol L(q), q in 1/m, of the interaction's own kernel. With a symbol, the operator
        can be inverted. A periodic model may give a symbol instead of a kernel.
        """
        raise NotImplementedError(
            f"{type(self).__name__} has no symbol of its own: it uses that of the substrate"
        )

    def columns(self, period: float | None, centre: float) -> tuple[sie.Forcing, ...]:
        """Terms of unknown amplitude on the right side of the equation, as functions of scaled x.

        centre: scaled position of the middle of the strip, the one period that is solved exactly.
        A model with a `strip` that does not define this method has one term, that of the nominal
        pressure outside the strip and its copies.
        """
        return ()

    def side_conditions(self, period: float | None) -> tuple[sie.Condition, ...]:
        """Conditions that determine the amplitudes of the terms in `columns`: one for each term."""
        return ()

    def placed_columns(
        self, period: float | None, centre: float, scaled: Scaled
    ) -> tuple[sie.Forcing, ...]:
        """The terms `columns`, for a model whose terms depend on positions x [m] in the profile.

        The function `scaled` converts such a position to scaled lengths. A model without this
        method uses `columns`.
        """
        return self.columns(period, centre)

    def placed_conditions(self, period: float | None, scaled: Scaled) -> tuple[sie.Condition, ...]:
        """The `side_conditions` of a model in which they depend on positions x [m] in the profile.

        The function `scaled` converts such a position to scaled lengths. A model without this
        method uses `side_conditions`.
        """
        return self.side_conditions(period)
