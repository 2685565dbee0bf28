"""The table [tangential] of a scene file: friction, and a tangential load or a creepage."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, Self

from contact.errors import SceneError
from contact.model.checks import finite, finite_or_none, keep, one_of, positive
from contact.model.laws.sliding import dundurs_beta

MODELS = ("partial slip", "rolling")
# A Dundurs constant below this counts as zero (equal bodies): it changes the shear by less than any
# stated error. Rounded moduli give about 1e-16.
_EQUAL_BODIES = 1e-9


@dataclass(frozen=True)
class Tangential:
    """A tangential load or a creepage of a contact with friction, as a scene file gives it.

    Parameters
    ----------
    friction : float
        Coefficient of friction [1], above 0.
    load : float or None
        Tangential load [N/m].
    creepage : float or None
        Creepage [1], for rolling; exactly one of load and creepage is given.
    model : str
        "partial slip" or "rolling".
    bulk_stress : float
        Bulk stress [Pa], for partial slip.
    leading : str
        "right" or "left", for rolling: the side to which the contact moves.
    """

    friction: float
    load: float | None = None
    creepage: float | None = None
    model: str = "partial slip"
    bulk_stress: float = 0.0
    leading: str = "right"

    def __post_init__(self) -> None:
        keep(self, positive, "friction")
        keep(self, finite_or_none, "load", "creepage")
        keep(self, finite, "bulk_stress")
        one_of("model", self.model, MODELS)
        one_of("leading", self.leading, ("right", "left"))
        if (self.load is None) == (self.creepage is None):
            raise SceneError("load or creepage: give exactly one of them", "load")
        rolls = self.model == "rolling"
        if not rolls and (self.creepage is not None or self.leading != "right"):
            raise SceneError("creepage and leading need model = 'rolling'", "model")
        if rolls and self.bulk_stress:
            raise SceneError.of("bulk_stress", self.bulk_stress, "left out with model = 'rolling'")

    @classmethod
    def from_table(cls, table: Any, material: Any) -> Self:
        """The `Tangential` of a table; SceneError for unknown keys and moduli of unlike bodies."""
        if not isinstance(table, Mapping):
            raise SceneError.of("tangential", table, "a table, written [tangential]")
        names = [field.name for field in fields(cls)]
        for name in table:
            one_of("key", name, names)
        if "friction" not in table:
            raise SceneError("friction is missing: give the coefficient of friction", "friction")
        if isinstance(material, Mapping) and "E1" in material and "nu1" in material:
            beta = dundurs_beta(**material)
            if abs(beta) > _EQUAL_BODIES:
                raise SceneError(
                    f"the bodies of [material] differ (Dundurs' beta = {beta:.4g}), so that shear "
                    "changes the pressure. This is solved only for full sliding ([law] model = "
                    "'sliding'). Give E2 and nu2 equal to E1 and nu1, or give E_star to neglect "
                    "this effect",
                    "material",
                )
        return cls(**table)
