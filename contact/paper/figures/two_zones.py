"""Figure 13: pairs of asperities with two zones per period."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from contact.model.profiles import Biquadratic
from contact.paper import CubicPair, LocalizedPair, PrintedCubicPair
from contact.paper.figures.base import SELF, Figure, label_panel, on_cell, solved


@dataclass(frozen=True)
class PairOfAsperities:
    """The scene of figure 13, with E* = 1; the paper gives only period / half spacing = 2.4."""

    radius: float = 1.0
    half_spacing: float = 0.05
    period: float = 2.4 * 0.05
    mean_pressure: float = 0.00109


_SCENE = PairOfAsperities()

_STYLES: dict[str, dict[str, Any]] = {
    "exact": {"color": "black", "linewidth": 1.8},
    "printed (38)": {"color": "#b3261e", "linestyle": "--"},
    "corrected cubic": {"color": "#d98e04", "linestyle": "-."},
    "full artanh": {"color": "#2f7fb5", "linestyle": (0, (4, 1))},
    "cut at the widest gap": {"color": "#3d7a4a", "linestyle": ":", "linewidth": 1.8},
    "pair alone (32)": {"color": "#7a7a7a", "linestyle": (0, (1, 1))},
}


def figure_13() -> Figure:
    """Figure 13: pressure on the asperities of a pair, by several solutions.

    Among the solutions are the relation printed in the paper, the relation that follows from the
    paper's equations, and the exact solution.
    """
    shape: dict[str, Any] = {
        "radius": _SCENE.radius,
        "spacing": 2.0 * _SCENE.half_spacing,
        "period": _SCENE.period,
        "E_star": 1.0,
        "mean_pressure": _SCENE.mean_pressure,
    }
    profile = Biquadratic(_SCENE.radius, 2.0 * _SCENE.half_spacing, _SCENE.period)
    printed, cubic, full = PrintedCubicPair(**shape), CubicPair(**shape), LocalizedPair(**shape)
    exact, cut, alone = (
        solved(profile, m, mean_pressure=_SCENE.mean_pressure) for m in ("exact", SELF, "isolated")
    )
    assert exact is not None and cut is not None and alone is not None
    x = on_cell([exact, cut, alone], 0.5 * _SCENE.period)
    made: dict[str, Any] = {
        "exact": exact,
        "printed (38)": printed,
        "corrected cubic": cubic,
        "full artanh": full,
        "cut at the widest gap": cut,
        "pair alone (32)": alone,
    }
    values = {name: one.pressure(x) for name, one in made.items()}
    ends = {name: one.zones[1] for name, one in made.items()}
    closed = {
        "exact": full.exact.zones[1],
        "cut at the widest gap": LocalizedPair(**shape, centre="valley").zones[1],
        "pair alone (32)": full.isolated.zones[1],
    }
    error = max(float(np.max(np.abs(ends[name] - e)) / (e[1] - e[0])) for name, e in closed.items())
    c = _SCENE.half_spacing
    lines = [
        f"{name}: a/c = {e[0] / c:.5f}, b/c = {e[1] / c:.5f}, (b - a)/c = {(e[1] - e[0]) / c:.5f}, "
        f"(a^2 + b^2)/2c^2 = {0.5 * np.sum(e**2) / c**2:.4f}, "
        f"peak = {made[name].max_pressure:.7f} E*"
        for name, e in ends.items()
    ]
    columns = {"x/c": x / _SCENE.half_spacing, **{f"p/E* {name}": p for name, p in values.items()}}

    def draw(figure: Any) -> None:
        left, right = figure.subplots(1, 2, width_ratios=[1.0, 1.25])
        for axes in (left, right):
            for name, p in values.items():
                axes.plot(x / _SCENE.half_spacing, 1e3 * p, label=name, **_STYLES[name])
        label_panel(left, "x/c", "1000 p/E*", legend=False, xlim=(-1.2, 1.2), ylim=(0.0, 4.9))
        label_panel(right, "x/c", "1000 p/E*", xlim=(0.7, 1.2), ylim=(0.0, 4.9))

    notes = (
        "L = 2.4c as in the paper. The paper does not state the load and c/R; here the mean "
        "pressure is 0.00109 E*, and c = 0.05 R.",
        "printed (38): a^2 + b^2 = 2c^2. corrected cubic: the relation that follows from (37). "
        "full artanh: solution of (35) without approximation of artanh.",
        "cut at the widest gap: equation (35) for a strip around the two nearest asperities, which "
        "here belong to different pairs.",
        "exact, cut at the widest gap and pair alone (32) are computed by the solver. Their zone "
        f"ends differ from those of the closed forms by at most {error:.1e} of the zone width.",
        *lines,
    )
    return Figure(
        "13",
        "Pressure on a pair of asperities, two zones a period",
        notes,
        columns,
        draw,
        (9.6, 4.4),
    )
