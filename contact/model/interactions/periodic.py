"""All periods, exactly: equation (5) of Goryacheva & Tsukanov (2020), with the Hilbert kernel."""

from dataclasses import dataclass

from contact.model.interactions.base import Interaction
from contact.model.registry import register_interaction


@register_interaction("periodic")
@dataclass(frozen=True)
class Periodic(Interaction):
    """A periodic contact: the kernel sums the line loads of all periods. On a half-plane it is
    (pi/L) cot(pi (x - xi)/L), with L the period (Shtaerman 1949).

    The approach is zero at first touch, and the displacements have zero mean. On a substrate with a
    base, displacements count from the base.

    Examples
    --------
    >>> import contact
    >>> wave = contact.Sinusoid(1e-6, 1e-4)
    >>> scene = contact.Scene(wave, 1e9, contact.Periodic(), contact_fraction=0.5)
    >>> contact.solve(scene).zones.round(12).tolist()
    [[-2.5e-05, 2.5e-05]]
    """

    needs_period = True
