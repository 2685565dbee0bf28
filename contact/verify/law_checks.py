"""The checks of a law of contact. Every solution passes through `held_to_law`.

Signs of pressure and gap are checked elsewhere, because each formulation samples them in its own
way. The checks in this file need only the fields of a solution.
"""

from dataclasses import replace

from contact.formulation.protocol import Fields
from contact.formulation.tolerances import TOLERANCES
from contact.model.laws import Law
from contact.model.plugin_checks.forms import AuthorMethod
from contact.model.units import quantity
from contact.verify.certificate import Certificate


def held_to_law(
    certificate: Certificate, law: Law, fields: Fields, given_load: float | None
) -> Certificate:
    """The certificate, or a failed certificate with the reason if the fields violate the law.

    given_load: the load [N/m] that the scene gives, or None.
    """
    fault = _fault(law, fields, given_load)
    return replace(certificate, holds=False, note=fault) if fault else certificate


def has_checks(law: Law) -> bool:
    """Whether a law prescribes more than the signs of pressure and gap."""
    return law.pressure_range.has_limit or type(law).fault is not Law.fault


def _fault(law: Law, fields: Fields, given_load: float | None) -> str:
    """Message about a violation of the law, such as too high a pressure; "" if there is none."""
    if not has_checks(law):
        return ""
    highest = law.pressure_range.highest
    if law.pressure_range.has_limit and fields.max_pressure > highest * (1.0 + TOLERANCES.balance):
        reached, most = (quantity(value, "Pa", 6) for value in (fields.max_pressure, highest))
        return f"{law.name}: the pressure reaches {reached}, above its limit {most}"
    load = None if given_load is None else given_load / fields.problem.units.load
    fault = AuthorMethod("law.fault(fields, load)", "law").text(law.fault, fields, load)
    return f"{law.name}: {fault}" if fault else ""
