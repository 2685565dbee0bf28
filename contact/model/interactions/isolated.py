"""A contact alone: equation (6) of Goryacheva & Tsukanov (2020), or (34) for several zones."""

from dataclasses import dataclass

from contact.model.checks import keep, positive_or_none
from contact.model.interactions.base import Interaction
from contact.model.registry import register_interaction


@register_interaction("isolated")
@dataclass(frozen=True)
class Isolated(Interaction):
    """A contact without periodic images. Its kernel is that of one line load: 1/(x - xi) on a
    half-plane (Muskhelishvili 1953). Of a periodic profile only one cell is used.

    Parameters
    ----------
    datum : float or None
        The distance d [m] from a line load at which the load causes no displacement; on a
        half-plane u(x) = -(2/(pi E*)) int p ln|(x - xi)/d| dxi. If it is None, the approach is
        defined only on a substrate with a base.

    Raises
    ------
    SceneError
        If the datum is not a finite positive number.

    Examples
    --------
    >>> import contact
    >>> punch = contact.Scene(contact.Flat(width=2.0), 1e9, contact.Isolated(datum=10.0), load=1e3)
    >>> round(contact.solve(punch).approach * 1e6, 9)  # 2 P ln(2 d / a) / (pi E*)
    1.907142398
    """

    datum: float | None = None
    units = {"datum": "m"}
    allows = ("load", "mean_pressure", "approach", "half_width")
    turns = True

    def __post_init__(self) -> None:
        keep(self, positive_or_none, "datum")
