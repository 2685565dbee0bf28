"""What a figure is here: numbers in columns, the words that say what they are, and a drawing of
them.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from contact.errors import OutOfRange
from contact.model.interactions import Interaction, Isolated, Localized, Periodic
from contact.model.profiles import Profile
from contact.model.scene import Scene
from contact.solution.plotting import finish, new_figure
from contact.solution.sampling import positions
from contact.solution.solution import Solution
from contact.solver import solve
from sie import Array

# Exact to the eye many times over; the closed forms are compared at the same tolerance.
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
    """number and title as in the paper; notes: parameters, choices, what was measured; columns:
    name to numbers, of one length, nan where a model has none; draw: puts it onto a matplotlib
    figure.
    """

    number: str
    title: str
    notes: tuple[str, ...]
    columns: dict[str, Array]
    draw: Callable[[Any], None]
    size: tuple[float, float] = (8.4, 4.2)

    def write(self, folder: Path) -> list[Path]:
        """figure-N.png and figure-N.csv in the folder, which is made."""
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
    """The scene under one of MODELS with E* = 1; None where the model has no contact at this
    control.
    """
    try:
        return solve(Scene(profile, 1.0, MODELS[model], **control), tol=TOL)
    except OutOfRange:
        return None


def on_cell(solutions: Iterable[Solution | None], half: float) -> Array:
    """Positions in [-half, half] that show every solution."""
    each = [positions(solution, -half, half) for solution in solutions if solution is not None]
    return np.unique(np.round(np.concatenate(each), 14))


def pressures(solution: Solution | None, x: Array) -> Array:
    """p(x); nan where there is no solution or p is infinite."""
    if solution is None:
        return np.full(x.shape, np.nan)
    p = solution.pressure(x)
    return np.asarray(np.where(np.isfinite(p), p, np.nan))


def curve(axes: Any, x: Array, y: Array, model: str, label: str | None = None) -> None:
    """One line in its model's style."""
    axes.plot(x, y, label=label, **STYLE[model])


def label_panel(
    axes: Any, x: str, y: str, legend: bool = True, **limits: tuple[float | None, float | None]
) -> None:
    """Names of the axes, their limits (xlim, ylim), ticks inside, a legend without a frame."""
    axes.set(**limits)
    finish(axes, x, y, legend)


def worst(a: Array, b: Array) -> float:
    """Largest |a - b| over the largest |b|, where both are numbers."""
    both = np.isfinite(a) & np.isfinite(b)
    return float(np.max(np.abs(a - b)[both]) / np.max(np.abs(b[both])))
