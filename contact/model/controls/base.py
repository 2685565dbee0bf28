"""The base class of controls: a control is the one given quantity of a scene.

Most controls give one of the four quantities that the solver can prescribe (`Quantity`). Any other
controlled quantity must grow or fall with the load: the solver searches for the load at which the
quantity has the given value. A control is a frozen dataclass in a file of its own.
"""

from dataclasses import dataclass
from enum import Enum
from typing import Any, ClassVar, NamedTuple

from contact.model.registry import CONTROLS as REGISTERED
from contact.model.registry import Named, construct, remade

# Names of the controls that are fields of a scene.
CONTROLS = ("load", "mean_pressure", "approach", "half_width", "contact_fraction")
# Scene fields that tilt a body, with their units.
TURNING = {"tilt": "rad", "moment": "N"}


class Quantity(Enum):
    """Quantities that the solver can prescribe.

    They are the load [N/m] (in a periodic contact, on one period), the approach [m], the half
    width [m] of a single zone about the origin, and the total width of all zones [m].
    """

    LOAD, APPROACH, HALF_WIDTH, WIDTH = range(4)


class Held(NamedTuple):
    """A prescribed quantity and its value in SI units."""

    quantity: Quantity
    value: float


@dataclass(frozen=True)
class Control(Named):
    """Base class of the controls. A control is the quantity whose value a scene prescribes.

    Parameters
    ----------
    value : float
        The prescribed value, in the unit `unit`.

    Attributes
    ----------
    unit : str
        Unit of the value, such as "N/m"; "1" for a number without unit.
    quantity : Quantity or None
        The quantity that the solver prescribes directly. If it is None, the solver searches for
        the load at which the controlled quantity has the value.
    falls : bool
        Whether the controlled quantity falls as the load grows; used in the search for the load.

    Examples
    --------
    The mean of the gap over a period.

    >>> import contact
    >>> from dataclasses import dataclass
    >>> @contact.register_control("doc-mean-gap")
    ... @dataclass(frozen=True)
    ... class MeanGap(contact.Control):
    ...     unit = "m"
    ...     falls = True
    ...     def of(self, solution):
    ...         return solution.mean_gap
    >>> wave = contact.Sinusoid(1e-6, 1e-4)
    >>> scene = contact.Scene(wave, 1e9, contact.Periodic(), given=MeanGap(2e-7))
    >>> round(contact.solve(scene).mean_gap * 1e7, 7), scene.control
    (2.0, ('doc-mean-gap', 2e-07))
    >>> contact.model.registry.CONTROLS.forget("doc-mean-gap")
    """

    value: float
    unit: ClassVar[str] = "1"
    quantity: ClassVar[Quantity | None] = None
    falls: ClassVar[bool] = False

    def signed(self, scene: Any) -> bool:
        """Whether the control's value may be zero or negative in a scene (`contact.Scene`)."""
        return False

    def check(self, scene: Any) -> None:
        """Raise SceneError if the control and the rest of the scene do not go together."""

    def held(self, scene: Any) -> Held | None:
        """The quantity that the solver prescribes directly, and its value. If None is returned, the
        solver searches for a load at which the method `of` gives the prescribed value.
        """
        return None if self.quantity is None else Held(self.quantity, self.value)

    def of(self, solution: Any) -> float:
        """The value of the controlled quantity in a solution (`contact.Solution`), accurate to
        about the error that the solution states.
        """
        raise NotImplementedError


def known_controls(given: Control | None) -> dict[str, type[Control]]:
    """All controls by name: the registered ones and the control `given` of a scene."""
    return REGISTERED.all() if given is None else {**REGISTERED.all(), given.name: type(given)}


def fields_under(name: str, value: float, given: Control | None = None) -> dict[str, Any]:
    """Values of the control fields of a scene with the control `name`; other fields are None.

    given: the control that the scene has in its field `given` now, or None.
    """
    if name in CONTROLS:
        own: dict[str, Any] = {name: value}
    elif given is not None and name == given.name:
        own = {"given": remade(given, {"value": value})}
    else:
        own = {
            "given": construct(
                REGISTERED.find(name, "control"), f"control {name!r}", {"value": value}
            )
        }
    return {**dict.fromkeys(CONTROLS), "given": None, **own}
