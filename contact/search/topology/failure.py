"""`Failure`: the reason why a strategy found no contact, returned and not raised."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import sie
from contact.errors import NotConverged, OutOfRange
from sie import Array, record

# Advice in every error message about the strip of a localized model. The strip is the part of the
# surface that such a model solves exactly.
EXACT = "use interaction = Periodic(), which has no strip"


class WrongTopology(Exception):
    """Raised if corrections of the zones or gaps lead to none that pass the check of signs.

    It is raised within a search only, which returns its `failure`. free: the last Newton result.
    """

    def __init__(self, message: str, free: sie.Free | None, at_border: bool = False) -> None:
        super().__init__(message)
        self.failure = Failure(message, free, at_border)


@record
class Failure:
    """The reason why a strategy led to no contact.

    reason: in words. free: the last Newton result. at_border: a zone reached the border of the
    known part of the profile. refusal: the error to raise if no other strategy leads to a contact.
    """

    reason: str
    free: sie.Free | None = None
    at_border: bool = False
    refusal: OutOfRange | NotConverged | None = None

    def same(self, other: Failure) -> bool:
        """Whether two searches ended for the same reason with the same zones."""
        if self.reason != other.reason or self.free is None or other.free is None:
            return False
        return same(self.free.density.zones.table, other.free.density.zones.table)

    @property
    def unresolved(self) -> bool:
        """Whether the last Newton result had too few modes to resolve the equation."""
        return self.free is not None and self.free.unresolved


NOT_APPLICABLE = Failure("this strategy does not apply to the scene")


def attempted(strategy: Callable[[], Any]) -> Any:
    """The outcome of a strategy; if the strategy raises an error, a Failure with this error."""
    try:
        return strategy()
    except (OutOfRange, NotConverged) as refusal:
        return Failure(str(refusal), refusal=refusal)


def same(table: Array, other: Array) -> bool:
    """Whether two tables contain the same intervals, to a millionth of the intervals' widths."""
    return table.shape == other.shape and bool(
        np.all(np.abs(table - other) <= 1e-6 * (table[:, 1:] - table[:, :1]))
    )
