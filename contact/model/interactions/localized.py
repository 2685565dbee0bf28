"""The localization principle of Goryacheva & Tsukanov (2020, doi 10.3389/fmech.2020.00045),
equation (13).

The zones of one strip, of the width of the period L, are solved exactly. The kernel includes m
copies of the strip on each side. Outside the width W = (2m + 1) L of the strip and its copies, only
the nominal pressure pbar acts. On a half-plane it adds

    (2 pbar / pi) artanh(2 (x - centre) / W)

to the right side; contact.model.operator has the term for other substrates. The displacement
contains the effect of a uniform pressure pbar outside the width W.
"""

from __future__ import annotations

from dataclasses import dataclass

import sie
from contact.errors import SceneError
from contact.model.checks import integer, one_of
from contact.model.interactions.base import Interaction
from contact.model.registry import register_interaction

CLOSURES = ("first-order", "self-consistent")


@register_interaction("localized")
@dataclass(frozen=True)
class Localized(Interaction):
    """One period of the profile (the strip) is solved exactly; outside it a nominal pressure
    acts. The nominal pressure is a load divided by the period: the strip's own load
    (self-consistent), or the load of an isolated contact with the same width (first order).

    (I. G. Goryacheva & I. Y. Tsukanov, Front. Mech. Eng. 6:45, 2020, doi 10.3389/fmech.2020.00045,
    eq. (13).)

    Parameters
    ----------
    closure : str
        Which load is divided by the period to give the nominal pressure. "first-order": the load of
        an isolated contact of the same total width, as in the paper's worked examples;
        "self-consistent": the load of the strip itself.
    neighbours : int
        Number of copies of the strip on each side that are also solved exactly. It is 0 with
        "first-order".

    Raises
    ------
    SceneError
        If the closure has another name, or neighbours > 0 are given with "first-order".

    Examples
    --------
    >>> import contact
    >>> wave = contact.Sinusoid(1e-6, 1e-4)
    >>> models = [contact.Localized("self-consistent", neighbours=m) for m in (0, 2)]
    >>> models.append(contact.Periodic())
    >>> scenes = [contact.Scene(wave, 1e9, model, load=1e3) for model in models]
    >>> rough, finer, exact = (contact.solve(scene).zones[0, 1] for scene in scenes)
    >>> bool(abs(finer - exact) < 0.1 * abs(rough - exact))
    True
    """

    closure: str = "first-order"
    neighbours: int = 0
    units = {"neighbours": "1"}
    needs_period = True
    allows = ("load", "mean_pressure", "approach", "half_width")
    exact = False
    strip = True

    def __post_init__(self) -> None:
        one_of("closure", self.closure, CLOSURES)
        integer("neighbours", self.neighbours)
        if self.neighbours and self.follows_isolated:
            raise SceneError.of(
                "neighbours",
                self.neighbours,
                "0 with closure = 'first-order'; use 'self-consistent' for more neighbours",
            )

    @property
    def follows_isolated(self) -> bool:
        return self.closure == "first-order"

    def side_conditions(self, period: float | None) -> tuple[sie.Condition, ...]:
        assert period is not None
        return (sie.Amplitude(0, per_total=1 / period),)
