"""Which formulation fields come from."""

from __future__ import annotations

from contact.formulation.fields import ZoneFields
from contact.formulation.gaps import GapFields
from contact.search.topology.by_gaps import ByGaps
from contact.search.topology.by_pressure import ByPressure


def formulation_of(fields: ZoneFields | GapFields) -> ByPressure | ByGaps:
    """The formulation that leads to such fields at another load."""
    return ByGaps(fields.problem, fields.relief) if isinstance(fields, GapFields) else ByPressure(fields.problem)
