"""Frictionless unilateral contact: p >= 0, gap >= 0, p gap = 0 (Signorini 1933)."""

from dataclasses import dataclass

from contact.model.laws.base import Law
from contact.model.registry import register_law


@register_law("frictionless")
@dataclass(frozen=True)
class Frictionless(Law):
    """Contact without friction or adhesion: p >= 0 where the bodies touch.

    Near the end of a zone, the pressure falls to 0 as the square root of the distance from the end:
    the edge intensity K is 0.

    Examples
    --------
    >>> import contact
    >>> scene = contact.Scene(contact.Parabola(1.0), 1e9, contact.Isolated(), load=1e4)
    >>> scene.law == contact.Frictionless(), contact.Frictionless().intensity(1e9)
    (True, 0.0)
    """

    turns = True
    convex = True
    by_gaps = True
    full_contact = True
