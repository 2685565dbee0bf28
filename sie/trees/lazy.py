"""Imports on demand: rooms of the engine when they are first used, and large libraries."""

import gc
import importlib
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType


def module(name: str) -> ModuleType:
    """Import a module of the engine, or of a library, by name."""
    with uncollected():
        return importlib.import_module(name)


@contextmanager
def uncollected() -> Iterator[None]:
    """Suspend the garbage collector while modules are imported.

    What an import makes stays, and searching it for garbage takes as long as the import.

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
                # All objects are put with the oldest generation at once, which is rarely searched
                # for garbage.
                gc.freeze()
                gc.unfreeze()
            gc.enable()
