"""The one place where the engine imports on demand: its own rooms as they are asked for, and what
only many zones need.
"""

import gc
import importlib
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType


def module(name: str) -> ModuleType:
    """A file of the engine, or what it stands on."""
    with uncollected():
        return importlib.import_module(name)


@contextmanager
def uncollected() -> Iterator[None]:
    """While modules are imported: what they make stays, and to look through it for garbage takes as
    long as to import it.

    Returns
    -------
    context manager
        Within it Python's cyclic garbage collector rests, if it ran before.

    Examples
    --------
    >>> import gc, sie
    >>> with sie.uncollected():
    ...     import fractions
    >>> gc.isenabled()
    True
    """
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            if not gc.get_freeze_count():
                # All that is there is put with the oldest objects at once, which are looked through
                # seldom.
                gc.freeze()
                gc.unfreeze()
            gc.enable()
