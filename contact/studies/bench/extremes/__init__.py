"""Stiff and extreme scenes, each with its exact solution and its allowed error."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from contact.studies.bench.extremes.adhesion import dugdale, jkr
from contact.studies.bench.extremes.base import Extreme
from contact.studies.bench.extremes.large import equal_zones, noisy
from contact.studies.bench.extremes.layers import layers
from contact.studies.bench.extremes.loads import fractions, loads_near_full, merges
from contact.studies.bench.extremes.neighbours import gaps, scales
from contact.studies.bench.extremes.shapes import slopes, units

__all__ = ["Extreme", "matrix"]

GROUPS: tuple[Callable[[], Iterator[Extreme]], ...] = (
    fractions,
    loads_near_full,
    gaps,
    merges,
    scales,
    units,
    slopes,
    layers,
    jkr,
    dugdale,
    equal_zones,
    noisy,
)


def matrix(quick: bool) -> list[Extreme]:
    """Return all extreme scenes; if `quick`, only those that take no more than about a second."""
    return [case for group in GROUPS for case in group() if not (quick and case.heavy)]
