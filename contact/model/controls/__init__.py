"""The controls; importing this package registers them."""

from contact.model.controls.base import (
    CONTROLS,
    TURNING,
    Control,
    Held,
    Quantity,
    fields_under,
    known_controls,
)
from contact.model.controls.fields import Approach, ContactFraction, HalfWidth, Load, MeanPressure
