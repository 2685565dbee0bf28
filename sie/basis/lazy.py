"""Imports on demand: parts of `sie` and large libraries are imported when they are first used."""

import gc
import importlib
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType


def module(name: str) -> ModuleType:
    """Import the module `name`, of `sie` or of a library, and return it."""
    with uncollected():
        return importlib.import_module(name)


@contextmanager
def uncollected() -> Iterator[None]:
    """Suspend the garbage collector while modules are imported.

    The objects that an import makes are never garbage. Searching them for garbage would take as
    long as the import itself.

    Returns
    -------
    context manager
        In the `with` block Python's cyclic garbage collector is disabled.

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
