"""Which parameters of a test are run always, and which only with the slow tests."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import Any

import pytest


def quick(values: Iterable[Any], always: Collection[Any]) -> list[Any]:
    """The values for `parametrize`: those in `always` are run always, the others are slow."""

    def slow(value: Any) -> Any:
        return pytest.param(
            *(value if isinstance(value, tuple) else (value,)), marks=pytest.mark.slow
        )

    return [value if value in always else slow(value) for value in values]
