"""The figures of the paper, each from scenes, with its numbers, and with what the paper lacked: the
exact solutions.

One function a figure; `contact figures` writes them. docs/paper says what they show.
"""

import warnings
from collections.abc import Callable, Iterable
from pathlib import Path

from contact.errors import ModelWarning, SceneError
from contact.paper.figures.asperities import (
    figure_7,
    figure_8,
    figure_9,
    figure_10,
    figure_11,
    figure_12,
)
from contact.paper.figures.base import Figure
from contact.paper.figures.spots import figure_2a, figure_2b
from contact.paper.figures.two_zones import figure_13

__all__ = ["FIGURES", "Figure", "chosen", "write"]

_DRAWN = (
    figure_2a,
    figure_2b,
    figure_7,
    figure_8,
    figure_9,
    figure_10,
    figure_11,
    figure_12,
    figure_13,
)
FIGURES: dict[str, Callable[[], Figure]] = {
    figure.__name__.removeprefix("figure_").upper(): figure for figure in _DRAWN
}


def chosen(numbers: Iterable[str]) -> list[str]:
    """The figures asked for, in the paper's order; all if none is."""
    wanted = {str(number).upper() for number in numbers}
    for number in sorted(wanted - set(FIGURES)):
        raise SceneError.unknown("figure", number, FIGURES)
    return [number for number in FIGURES if not wanted or number in wanted]


def write(number: str, folder: Path) -> list[Path]:
    """Draw one figure and write its numbers."""
    with warnings.catch_warnings():
        # Of scenes in units of the paper's, E* and the period one, slopes and pressures are no
        # surface's.
        warnings.simplefilter("ignore", ModelWarning)
        return FIGURES[number]().write(folder)
