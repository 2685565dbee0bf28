"""Where a contact comes apart as its control falls."""

from dataclasses import field

from sie import Array, record


@record
class PullOff:
    """The last equilibrium before the surfaces come apart altogether, as the control falls: load [N/m] (per period where there is one),
    approach [m] (None without), zones [m] there."""

    load: float
    approach: float | None
    zones: Array = field(repr=False)
