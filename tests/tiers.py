"""Parameters of tests: which of them always run, and which run with the slow tests only."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from itertools import product
from typing import Any

import pytest


def _slow(value: Any) -> Any:
    return pytest.param(*(value if isinstance(value, tuple) else (value,)), marks=pytest.mark.slow)


def quick(values: Iterable[Any], always: Collection[Any]) -> list[Any]:
    """The values for `parametrize`: those in `always` run always, the others are slow."""
    return [value if value in always else _slow(value) for value in values]


def diagonal(*axes: Collection[Any]) -> list[Any]:
    """All combinations of the values of several axes, for `parametrize`.

    As many of them as the longest axis has values run always. Every value of every axis is in
    one of these combinations. The others are slow.
    """
    longest = max(map(len, axes))
    always = {tuple(k % len(axis) for axis in axes) for k in range(longest)}
    return [
        values if numbers in always else _slow(values)
        for values, numbers in zip(
            product(*axes), product(*(range(len(axis)) for axis in axes)), strict=True
        )
    ]
