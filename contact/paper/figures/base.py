"""The class of a figure: numbers in columns, notes on them, and a function that draws them."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from contact.errors import OutOfRange
from contact.model.interactions import Interaction, Isolated, Localized, Periodic
from contact.model.profiles import Profile
from contact.model.scene import Scene
from contact.solution.drawing import finish, new_figure
from contact.solution.sampling import positions
from contact.solution.solution import Solution
from contact.solver import solve
from sie import Array

# Tolerance of the solutions, far below what a figure can show. The solutions differ from the closed
# forms by about this much.
TOL = 1e-9

EXACT = "exact"
FIRST = "first-order"
SELF = "self-consistent"
ONE = "m = 1"
ALONE = "isolated"
MODELS: dict[str, Interaction] = {
    EXACT: Periodic(),
    FIRST: Localized(),
    SELF: Localized(closure="self-consistent"),
    ONE: Localized(closure="self-consistent", neighbours=1),
    ALONE: Isolated(),
}
STYLE: dict[str, dict[str, Any]] = {
    EXACT: {"color": "black", "linewidth": 1.8},
    FIRST: {"color": "#b3261e", "linestyle": "--"},
    SELF: {"color": "#d98e04", "linestyle": "-."},
    ONE: {"color": "#2f7fb5", "linestyle": ":", "linewidth": 1.8},
    ALONE: {"color": "#7a7a7a", "linestyle": (0, (1, 1))},
}


@dataclass(frozen=True)
class Figure:
    """One figure of the paper.

    number, title: as in the paper; notes: parameters, choices and measured differences; columns:
    numbers by name, nan for missing ones; draw: draws on a matplotlib figure; size: in inches.
    """

    number: str
    title: str
    notes: tuple[str, ...]
    columns: dict[str, Array]
    draw: Callable[[Any], None]
    size: tuple[float, float] = (8.4, 4.2)

    def write(self, folder: Path) -> list[Path]:
        """Write the figure as PNG and its columns as CSV; return the paths of the files.

        The folder is created if it does not exist.
        """
        folder.mkdir(parents=True, exist_ok=True)
        picture, numbers = (
            folder / f"figure-{self.number}.png",
            folder / f"figure-{self.number}.csv",
        )
        figure = new_figure(*self.size)
        self.draw(figure)
        figure.suptitle(f"Figure {self.number}. {self.title}", fontsize=10)
        figure.savefig(picture, dpi=160)
        head = [
            f"# Figure {self.number}. {self.title}",
            *(f"# {note}" for note in self.notes),
            ",".join(self.columns),
        ]
        rows = np.column_stack(list(self.columns.values()))
        lines = [",".join("" if np.isnan(v) else f"{v:.12g}" for v in row) for row in rows]
        numbers.write_text("\n".join([*head, *lines]) + "\n", encoding="utf-8")
        return [picture, numbers]


def solved(profile: Profile, model: str, **control: Any) -> Solution | None:
    """The solution with one of the `MODELS` and E* = 1; None if this model has no such contact."""
    try:
        return solve(Scene(profile, 1.0, MODELS[model], **control), tol=TOL)
    except OutOfRange:
        return None


def on_cell(solutions: Iterable[Solution | None], half: float) -> Array:
    """Positions in [-half, half] that are dense enough to draw the curves of all solutions."""
    each = [positions(solution, -half, half) for solution in solutions if solution is not None]
    return np.unique(np.round(np.concatenate(each), 14))


def pressures(solution: Solution | None, x: Array) -> Array:
    """Pressures of a solution at x; nan where they are infinite, or if there is no solution."""
    if solution is None:
        return np.full(x.shape, np.nan)
    p = solution.pressure(x)
    return np.asarray(np.where(np.isfinite(p), p, np.nan))


def curve(axes: Any, x: Array, y: Array, model: str, label: str | None = None) -> None:
    """Draw y against x in the line style of a model."""
    axes.plot(x, y, label=label, **STYLE[model])


def label_panel(
    axes: Any, x: str, y: str, legend: bool = True, **limits: tuple[float | None, float | None]
) -> None:
    """Set the labels of the axes, their limits (xlim, ylim), and a legend."""
    axes.set(**limits)
    finish(axes, x, y, legend)


def worst(a: Array, b: Array) -> float:
    """Largest |a - b| divided by the largest |b|; entries that are not finite are left out."""
    both = np.isfinite(a) & np.isfinite(b)
    return float(np.max(np.abs(a - b)[both]) / np.max(np.abs(b[both])))
