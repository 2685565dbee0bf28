"""The reason why a solution is not more accurate: the largest part of its stated error."""

from __future__ import annotations

from sie.ends.newton import Free
from sie.slits.system import AnyState


def of_search(search: Free) -> str:
    """A message with the reason why a search for the zone ends stopped without convergence."""
    which = [f"zone {i}" for i in search.lost] + [f"the gap after zone {i}" for i in search.met]
    more = f" and {len(which) - 4} more" if len(which) > 4 else ""
    return search.reason + (f" ({', '.join(which[:4])}{more}, counted from 0)" if which else "")


def of_error(state: AnyState, search: Free | None, tol: float) -> str:
    """A message with the reason for the largest part of a solution's stated error."""
    if search is not None:
        zone = int(search.rounding.max(axis=1).argmax())
        open_ = float(search.rounding[zone].max())
        if open_ > 0.1 * tol:
            return (
                f"rounding leaves the ends of zone {zone} (counted from 0) uncertain by "
                f"{open_:.1e} of its width"
            )
    return state.reason(tol)
