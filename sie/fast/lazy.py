"""The one place where the engine imports on demand: its own rooms as they are asked for, and what only many zones need."""

from __future__ import annotations

import importlib
from types import ModuleType


def scipy_sparse() -> ModuleType:
    """Sparse matrices."""
    return importlib.import_module("scipy.sparse")


def module(name: str) -> ModuleType:
    """A file of the engine."""
    return importlib.import_module(name)
