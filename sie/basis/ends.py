"""Kinds of zone ends and what each does to the index of the singular integral equation.

Near an end at distance d the density behaves as K / sqrt(d) + A sqrt(d). A *singular* end lets K be what it
comes to; a *bounded* end asks K = 0 (or a prescribed K) at a given place; a *free* end asks for a given K (zero, or a prescribed
intensity) at a place that is itself unknown. Each zone with two singular ends has index 1 and needs one side
condition; each bounded end takes one away; a free end takes one away and brings one unknown, its position
(Muskhelishvili, Singular Integral Equations, 1953, ch. 5).
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class End:
    """One end of a zone.

    Parameters
    ----------
    moves : bool
        Whether the position is unknown.
    intensity : float or None
        The prescribed K at the end; None if K is left free (a singular end).

    Raises
    ------
    ValueError
        If the end moves and has no intensity.

    Examples
    --------
    >>> import sie
    >>> sie.BOUNDED, sie.FREE.moves
    (End(moves=False, intensity=0.0), True)
    """

    moves: bool
    intensity: float | None

    def __post_init__(self) -> None:
        if self.moves and self.intensity is None:
            raise ValueError("an end of unknown position needs a prescribed intensity (zero for a free end)")

    @property
    def surplus(self) -> int:
        """Unknowns less equations that this end adds to its zone, counted from a zone with two bounded ends."""
        return 1 if self.moves or self.intensity is None else 0


FREE = End(moves=True, intensity=0.0)
BOUNDED = End(moves=False, intensity=0.0)
SINGULAR = End(moves=False, intensity=None)


def free_with_intensity(intensity: float) -> End:
    """An end of unknown position at which the density is `intensity / sqrt(d)` (adhesion, a crack at its limit).

    Parameters
    ----------
    intensity : float
        K; zero is `FREE`.

    Returns
    -------
    End

    Examples
    --------
    A line contact that adheres, K = -0.1, a = 1: load = pi a^2 / 2 + pi K sqrt(2 a) (M. Barquins, J. Adhesion 26, 1988, 1-12).

    >>> import numpy as np, sie
    >>> load = np.pi * (0.5 - 0.1 * np.sqrt(2))
    >>> adhering = sie.Equation(sie.cauchy(), sie.Forcing(lambda x: x), (sie.Total(load),))
    >>> end = sie.free_with_intensity(-0.1)
    >>> sie.solve(adhering, sie.Zones.of([[-0.9, 1.05]], end, end)).zones.table.round(9).tolist()
    [[-1.0, 1.0]]
    """
    return End(moves=True, intensity=float(intensity))
