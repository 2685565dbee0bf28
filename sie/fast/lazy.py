"""The one place where the engine imports on demand what only many zones need."""

from __future__ import annotations

import importlib
from types import ModuleType


def scipy_sparse() -> ModuleType:
    """Sparse matrices."""
    return importlib.import_module("scipy.sparse")
