"""Imports on demand: parts of the package and large libraries, when they are first used."""

import gc
import importlib
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType


def module(name: str) -> ModuleType:
    """Import a module of this package, or of a library, by name and return it."""
    with uncollected():
        return importlib.import_module(name)


@contextmanager
def uncollected() -> Iterator[None]:
    """Suspend the garbage collector while modules are imported.

    The objects that an import makes are never garbage, and searching them takes as long as the
    import.

    Returns
    -------
    context manager
        Within it Python's cyclic garbage collector is disabled; afterwards it is as before.

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
                # `freeze` and `unfreeze` move all objects to the oldest generation, which is rarely
                # searched for garbage.
                gc.freeze()
                gc.unfreeze()
            gc.enable()
