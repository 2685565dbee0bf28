"""Why a way to the zones has led to none that pass: a value, for the next way to be tried."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import sie
from contact.errors import NotConverged, OutOfRange
from sie import Array, record

# Said with every refusal of a strip.
EXACT = "interaction = Periodic() needs no strip"


class WrongTopology(Exception):
    """Corrections do not lead to zones that pass; free: the last Newton result. Within a search
    only: it hands out a Failure.
    """

    def __init__(self, message: str, free: sie.Free | None, at_border: bool = False) -> None:
        super().__init__(message)
        self.failure = Failure(message, free, at_border)


@record
class Failure:
    """reason: in words. free: the last Newton result. at_border: a zone reached the border of what is
    known of the profile. refusal: what is raised if no other way leads on.
    """

    reason: str
    free: sie.Free | None = None
    at_border: bool = False
    refusal: OutOfRange | NotConverged | None = None

    def same(self, other: Failure) -> bool:
        """Whether two searches ended in the same way with the same zones."""
        if self.reason != other.reason or self.free is None or other.free is None:
            return False
        return same(self.free.density.zones.table, other.free.density.zones.table)

    @property
    def unresolved(self) -> bool:
        """Whether the modes of its zones do not show the equation."""
        return self.free is not None and self.free.unresolved


NOT_APPLICABLE = Failure("not a scene for this way")


def attempted(way: Callable[[], Any]) -> Any:
    """What a way leads to where others are left: its outcome, or a Failure, where it refuses too."""
    try:
        return way()
    except (OutOfRange, NotConverged) as refusal:
        return Failure(str(refusal), refusal=refusal)


def same(table: Array, other: Array) -> bool:
    """Whether these are the same zones, to a millionth of their widths."""
    return table.shape == other.shape and bool(
        np.all(np.abs(table - other) <= 1e-6 * (table[:, 1:] - table[:, :1]))
    )
