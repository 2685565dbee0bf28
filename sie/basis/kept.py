"""What is kept of an object in pickles and copies: its fields, not what has been worked out from them."""

from functools import cached_property
from typing import Any


class Kept:
    """Base of classes whose cached properties follow from their fields, bit for bit, whenever they are asked for again.

    Examples
    --------
    >>> import pickle, sie
    >>> zones = sie.Zones.of([[0.0, 1.0]])
    >>> zones.half.tolist(), "half" in pickle.loads(pickle.dumps(zones)).__dict__
    ([0.5], False)
    """

    def __getstate__(self) -> Any:
        state: Any = super().__getstate__()
        if isinstance(state, tuple):  # of a class with slots
            return self._fields_of(state[0] or {}), state[1]
        return state and self._fields_of(state)

    def _fields_of(self, values: dict[str, Any]) -> dict[str, Any]:
        cls = type(self)
        return {name: value for name, value in values.items() if not isinstance(getattr(cls, name, None), cached_property)}
