"""The base class of substrates: an elastic body, given by its symbol alone.

A pressure p_q exp(iqx) displaces the surface by u_q = 2 L(q) p_q / (E* q). The symbol L is the
compliance of the surface divided by that of a half-plane, and tends to 1 for short waves. From the
symbol follow the kernel, the displacements on a grid, the pressure in full contact, and whether a
uniform pressure causes a finite displacement (contact.model.operator).
"""

from collections.abc import Mapping
from functools import cached_property
from typing import ClassVar

import sie
from contact.model.line_load import SmoothPart
from contact.model.registry import Named
from sie import Array


class Substrate(Named, sie.Kept):
    """The base class of substrates; a substrate is a frozen dataclass with one method, `symbol`.

    Attributes
    ----------
    compression : float or None
        The limit [m] of L(q)/q for long waves. A uniform pressure p displaces the surface by
        2 p compression / E*. A body on a rigid base has a compression, and displacements and the
        approach count from the base. It is None for a body without a base, whose symbol tends to a
        number above 0 for long waves. The displacement of such a body is defined up to a
        constant: in a periodic contact its mean is set to 0, in other contacts a datum fixes it.

    Examples
    --------
    Full contact of a wave begins at pi E* amplitude / (period L(q)).

    >>> import contact
    >>> import numpy as np
    >>> from dataclasses import dataclass
    >>> @dataclass(frozen=True)
    ... class Soft(contact.Substrate):
    ...     depth: float
    ...     name = "soft"
    ...     def symbol(self, q):
    ...         return 1 + 0.5 * np.exp(-q * self.depth)
    >>> profile, model = contact.Sinusoid(1e-6, 1e-4), contact.Periodic()
    >>> wave = contact.Scene(profile, 1e9, model, substrate=Soft(1e-5), contact_fraction=1.0)
    >>> full = np.pi * 1e9 * 1e-2 / Soft(1e-5).symbol(2 * np.pi / 1e-4)
    >>> bool(np.isclose(contact.solve(wave).mean_pressure, full, rtol=1e-12))
    True
    """

    units: ClassVar[Mapping[str, str]] = {}
    compression: float | None = None

    def symbol(self, q: Array) -> Array:
        """The symbol L(q), for wavenumbers q > 0 [1/m] in an array of any shape. L > 0, and L is 1
        to the last digit for large q.
        """
        raise NotImplementedError(f"{type(self).__name__} must define symbol(q)")

    @cached_property
    def smooth_part(self) -> SmoothPart:
        """The kernel of a line load minus the half-plane's kernel 1/r, with the primitives of this
        difference.
        """
        return SmoothPart.of(self.symbol, grounded=self.compression is not None)
