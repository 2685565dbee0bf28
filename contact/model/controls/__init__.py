"""The controls, the quantities of a scene that can be given; importing this package registers them."""

from contact.model.controls.approach import Approach
from contact.model.controls.base import CONTROLS, TURNING, Control, Held, Quantity, fields_under
from contact.model.controls.contact_fraction import ContactFraction
from contact.model.controls.half_width import HalfWidth
from contact.model.controls.load import Load, MeanPressure

__all__ = [
    "CONTROLS", "TURNING", "Approach", "ContactFraction", "Control", "HalfWidth", "Held", "Load", "MeanPressure", "Quantity",
    "fields_under",
]
