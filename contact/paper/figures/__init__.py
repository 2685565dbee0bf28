"""The figures of the paper, computed from scenes, with the exact solutions added.

Each figure is one function; `contact figures` writes them. docs/paper.md explains them.
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
    """Names of the requested figures, in the paper's order; all names if none is requested."""
    wanted = {str(number).upper() for number in numbers}
    for number in sorted(wanted - set(FIGURES)):
        raise SceneError.unknown("figure", number, FIGURES)
    return [number for number in FIGURES if not wanted or number in wanted]


def write(number: str, folder: Path) -> list[Path]:
    """Draw the figure of this number and write its data; return the paths of the files."""
    with warnings.catch_warnings():
        # The scenes are in units with E* = 1 and period 1, so that warnings about large slopes and
        # pressures do not apply.
        warnings.simplefilter("ignore", ModelWarning)
        return FIGURES[number]().write(folder)
