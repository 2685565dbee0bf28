"""The one place where the engine imports on demand: its own rooms as they are asked for, and what only many zones need."""

from __future__ import annotations

import gc
import importlib
from types import ModuleType


def scipy_sparse() -> ModuleType:
    """Sparse matrices."""
    return importlib.import_module("scipy.sparse")


def module(name: str) -> ModuleType:
    """A file of the engine. What is imported stays: to look through it for garbage meanwhile takes as long as to import it."""
    collects = gc.isenabled()
    gc.disable()
    try:
        return importlib.import_module(name)
    finally:
        if collects:
            gc.enable()
