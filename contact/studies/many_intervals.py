"""The engine on very many intervals: python -m contact.studies.many_intervals [--out FILE] [COUNT
...].

Rows of 500 and 2,000 intervals of unlike widths and gaps, on one thread and each in a process of
its own, for its time and peak memory: trailing edges, conditions and kernels of one's own, columns
whose modes are not declared, prescribed intensities. Prints a table and the exponent of each row's
time over the number of intervals; FILE, for instance OUT/many-intervals.md, takes it as Markdown,
and `python -m contact.studies.pages OUT` sets it in docs/engine.md.
"""

from __future__ import annotations

import json
import resource
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import sie
from contact.studies.alone import measured, tell
from contact.studies.bench.report import Table

Array = NDArray[np.float64]

SIZES = (500, 2_000)
NAMES = (
    "intervals",
    "number",
    "unknowns",
    "solutions, GMRES steps",
    "closed forms in a sum",
    "processor time [s]",
    "peak memory [GB]",
    "stated error",
)
TOLERANCE = 1e-8
WAVE = sie.Forcing(np.sin, lambda x: -np.cos(x))
BUMPS = sie.Forcing(
    lambda x: np.sin(2 * np.pi * x) / (2 * np.pi),
    lambda x: -np.cos(2 * np.pi * x) / (2 * np.pi) ** 2,
)


class Sprung(sie.Condition):
    """Every zone on a spring of its own: what it bears lowers its level by as much as the spring is
    soft.
    """

    def count(self, zones: sie.Zones) -> int:
        return len(zones.solved)

    def rows(self, system: sie.Rows) -> tuple[Array, Array, Array]:
        (levels, at), (totals, known) = system.levels(), system.totals()
        soft = 1 + 0.5 * np.cos(np.arange(len(at)))
        return levels - soft[:, None] * totals, at - soft * known, np.full(len(at), 0.1)


class Totals(sie.Condition):
    """What `sie.ZoneTotals` says, in one's own words."""

    def count(self, zones: sie.Zones) -> int:
        return len(zones.solved)

    def rows(self, system: sie.Rows) -> tuple[Array, Array, Array]:
        totals, known = system.totals()
        return totals, known, np.full(len(known), 0.1)


def row(count: int, right: sie.End = sie.SINGULAR) -> sie.Zones:
    """Widths of 0.6 to 0.8, about one apart."""
    chance = np.random.default_rng(0)
    left = np.arange(count) + 0.1 * chance.random(count)
    return sie.Zones.of(
        np.column_stack((left, left + 0.6 + 0.2 * chance.random(count))), sie.SINGULAR, right
    )


def adhering(count: int) -> sie.Zones:
    """A first guess of contacts on bumps, one to each unit."""
    end, half = (
        sie.free_with_intensity(-0.01),
        0.12 * (1 + 0.05 * np.random.default_rng(0).standard_normal(count)),
    )
    at = np.arange(count)
    return sie.Zones.of(np.column_stack((at - half, at + half)), end, end)


def plain(
    *conditions: sie.Condition,
    kernel: sie.Kernel | None = None,
    columns: tuple[sie.Forcing, ...] = (),
) -> sie.Equation:
    return sie.Equation(sie.cauchy() if kernel is None else kernel, WAVE, conditions, columns)


def of_lag() -> sie.Kernel:
    return sie.cauchy() + sie.Smooth(lambda x, xi: (x - xi) * np.exp(-((x - xi) ** 2)), of_lag=True)


def of_both(length: float) -> sie.Kernel:
    return sie.cauchy() + sie.Smooth(
        lambda x, xi: np.cos(x / length) * np.sin(xi / length) / length
    )


CASES: dict[str, Callable[[int], tuple[sie.Equation, sie.Zones]]] = {
    "aerofoils in tandem": lambda n: (plain(), row(n, sie.BOUNDED)),
    "totals, a condition of one's own": lambda n: (plain(Totals()), row(n)),
    "on springs, a condition of one's own": lambda n: (plain(Sprung()), row(n)),
    "a column of undeclared modes": lambda n: (
        plain(sie.ZoneTotals(0.1), sie.Amplitude(0, 0.3), columns=(sie.Forcing(np.cos, np.sin),)),
        row(n),
    ),
    "a smooth kernel of the lag": lambda n: (plain(sie.ZoneTotals(0.1), kernel=of_lag()), row(n)),
    "a smooth kernel of both places": lambda n: (
        plain(sie.ZoneTotals(0.1), kernel=of_both(1.0 * n)),
        row(n),
    ),
    "adhering, each under a load": lambda n: (
        sie.Equation(sie.cauchy(), BUMPS, (sie.ZoneTotals(0.01),)),
        adhering(n),
    ),
    "adhering, at one level": lambda n: (
        sie.Equation(sie.hilbert(1.0 * n), BUMPS, (sie.Total(0.01 * n), sie.EqualPotential())),
        adhering(n),
    ),
}


def measure(name: str, count: int) -> dict[str, float | int | str]:
    equation, zones = CASES[name](count)
    start = time.process_time()
    found = sie.solve(equation, zones, tol=TOLERANCE)
    sizes = found.state.sizes
    forms = (
        sizes.kernel_evaluations / sizes.iterations
        if sizes.iterations
        else sizes.kernel_evaluations
    )
    return {
        "name": name,
        "count": count,
        "unknowns": found.state.coupled,
        "steps": f"{sizes.solves}, {sizes.iterations}",
        "forms": forms,
        "seconds": time.process_time() - start,
        "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20,
        "error": found.error,
    }


def main(sizes: tuple[int, ...], out: Path | None) -> None:
    rows, growths = [], []
    for name in CASES:
        found = [measured(__file__, "--one", name, str(count)) for count in sizes]
        rows += [
            (
                name,
                f"{r['count']:,}",
                f"{r['unknowns']:,}",
                str(r["steps"]),
                f"{r['forms']:.1e}",
                f"{r['seconds']:.2f}",
                f"{r['memory']:.2f}",
                f"{r['error']:.1e}",
            )
            for r in found
        ]
        if len(sizes) > 1:
            growths.append(
                float(np.polyfit(np.log(sizes), np.log([r["seconds"] for r in found]), 1)[0])
            )
    remarks = (
        [
            f"Processor time grows as a power of the number from {min(growths):.2f} to {max(growths):.2f}."
        ]
        if growths
        else []
    )
    tell(Table("many-intervals", "very many intervals", NAMES, rows), remarks, out)


if __name__ == "__main__":
    given = sys.argv[1:]
    if given[:1] == ["--one"]:
        print(json.dumps(measure(given[1], int(given[2]))))
    else:
        file = Path(given[1]) if given[:1] == ["--out"] else None
        main(tuple(map(int, given[2 if file else 0 :])) or SIZES, file)
