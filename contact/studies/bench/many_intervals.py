"""The engine on hundreds and thousands of intervals: time, memory and stated error.

    python -m contact.studies.bench.many_intervals [--out FILE] [COUNT ...]

The cases are rows of 500 and 2,000 intervals of different widths and gaps. A case has one of the
following: bounded right ends (as at the trailing edges of aerofoils), user-defined side conditions
or kernels, terms of unknown amplitude (columns) without a declared number of modes, or prescribed
intensities at the ends. Each case runs in a process of its own, on one thread. A remark gives the
exponents of time as a power of the number of intervals. `python -m contact.studies.pages DIR` sets
DIR/many-intervals.md in docs/measured-engine.md.
"""

from __future__ import annotations

import argparse
import json
import resource
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import sie
from contact.studies.bench.alone import measured, publish
from contact.studies.bench.report import Table

Array = NDArray[np.float64]

COLUMNS = (
    "intervals",
    "number",
    "unknowns",
    "solutions, GMRES steps",
    "closed forms in a sum",
    "processor time [s]",
    "peak memory [GB]",
    "stated error",
)


class OnSprings(sie.Condition):
    """Side condition: every zone rests on a spring, which the load of the zone compresses."""

    def count(self, zones: sie.Zones) -> int:
        return len(zones.solved)

    def rows(self, system: sie.Rows) -> tuple[Array, Array, Array]:
        (levels, at), (totals, known) = system.levels(), system.totals()
        softness = 1 + 0.5 * np.cos(np.arange(len(at)))
        return levels - softness[:, None] * totals, at - softness * known, np.full(len(at), 0.1)


class Totals(sie.Condition):
    """The condition of `sie.ZoneTotals`, written as a user would write it."""

    def count(self, zones: sie.Zones) -> int:
        return len(zones.solved)

    def rows(self, system: sie.Rows) -> tuple[Array, Array, Array]:
        totals, known = system.totals()
        return totals, known, np.full(len(known), 0.1)


def row_of_zones(count: int, right: sie.End = sie.SINGULAR) -> sie.Zones:
    """A row of zones of widths from 0.6 to 0.8, one zone in each unit of length."""
    rng = np.random.default_rng(0)
    left = np.arange(count) + 0.1 * rng.random(count)
    width = 0.6 + 0.2 * rng.random(count)
    return sie.Zones.of(np.column_stack((left, left + width)), sie.SINGULAR, right)


def adhering(count: int) -> sie.Zones:
    """First guess of the zones of an adhesive contact on bumps.
    There is one zone in each unit of length.
    """
    end = sie.free_with_intensity(-0.01)
    half = 0.12 * (1 + 0.05 * np.random.default_rng(0).standard_normal(count))
    at = np.arange(count)
    return sie.Zones.of(np.column_stack((at - half, at + half)), end, end)


def wave_equation(
    *conditions: sie.Condition,
    kernel: sie.Kernel | None = None,
    columns: tuple[sie.Forcing, ...] = (),
) -> sie.Equation:
    """An equation with right side sin x; `columns` are terms of unknown amplitude."""
    wave = sie.Forcing(np.sin, lambda x: -np.cos(x))
    return sie.Equation(sie.cauchy() if kernel is None else kernel, wave, conditions, columns)


def bump_equation(kernel: sie.Kernel, *conditions: sie.Condition) -> sie.Equation:
    """An equation whose right side is the slope of bumps.
    There is one bump in each unit of length.
    """
    q = 2 * np.pi
    bumps = sie.Forcing(lambda x: np.sin(q * x) / q, lambda x: -np.cos(q * x) / q**2)
    return sie.Equation(kernel, bumps, conditions)


def kernel_of_lag() -> sie.Kernel:
    """The Cauchy kernel plus a smooth kernel that depends on x - xi only."""
    return sie.cauchy() + sie.Smooth(lambda x, xi: (x - xi) * np.exp(-((x - xi) ** 2)), of_lag=True)


def kernel_of_both(length: float) -> sie.Kernel:
    """The Cauchy kernel plus a smooth kernel that depends on x and xi separately."""
    return sie.cauchy() + sie.Smooth(
        lambda x, xi: np.cos(x / length) * np.sin(xi / length) / length
    )


CASES: dict[str, Callable[[int], tuple[sie.Equation, sie.Zones]]] = {
    "aerofoils in tandem": lambda n: (wave_equation(), row_of_zones(n, sie.BOUNDED)),
    "totals, a condition of your own": lambda n: (wave_equation(Totals()), row_of_zones(n)),
    "on springs, a condition of your own": lambda n: (wave_equation(OnSprings()), row_of_zones(n)),
    "a column of undeclared modes": lambda n: (
        wave_equation(
            sie.ZoneTotals(0.1), sie.Amplitude(0, 0.3), columns=(sie.Forcing(np.cos, np.sin),)
        ),
        row_of_zones(n),
    ),
    "a smooth kernel of the lag": lambda n: (
        wave_equation(sie.ZoneTotals(0.1), kernel=kernel_of_lag()),
        row_of_zones(n),
    ),
    "a smooth kernel of both places": lambda n: (
        wave_equation(sie.ZoneTotals(0.1), kernel=kernel_of_both(1.0 * n)),
        row_of_zones(n),
    ),
    "adhering, each under a load": lambda n: (
        bump_equation(sie.cauchy(), sie.ZoneTotals(0.01)),
        adhering(n),
    ),
    "adhering, at one level": lambda n: (
        bump_equation(sie.hilbert(1.0 * n), sie.Total(0.01 * n), sie.EqualPotential()),
        adhering(n),
    ),
}


def measure(name: str, count: int, tol: float = 1e-8) -> dict[str, float | int | str]:
    """Solve a case with `count` intervals and return its row of the table."""
    equation, zones = CASES[name](count)
    start = time.process_time()
    found = sie.solve(equation, zones, tol=tol)
    seconds, sizes = time.process_time() - start, found.state.sizes
    return {
        "name": name,
        "count": count,
        "unknowns": found.state.coupled,
        "steps": f"{sizes.solves}, {sizes.iterations}",
        "forms": sizes.kernel_evaluations / max(sizes.iterations, 1),
        "seconds": seconds,
        "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20,
        "error": found.error,
    }


def main(sizes: list[int], out: Path | None) -> None:
    """Measure every case at every size and publish the table."""
    rows, growths = [], []
    for name in CASES:
        found = [
            measured("contact.studies.bench.many_intervals", "--one", name, str(count))
            for count in sizes
        ]
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
            times = [r["seconds"] for r in found]
            growths.append(float(np.polyfit(np.log(sizes), np.log(times), 1)[0]))
    span = f"N^{min(growths):.2f} to N^{max(growths):.2f}" if growths else ""
    remarks = [f"Processor time grows as {span} with the number N of intervals."] if growths else []
    publish(Table("many-intervals", "very many intervals", COLUMNS, rows), remarks, out)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("sizes", nargs="*", type=int, default=[500, 2_000])
    parser.add_argument("--one", nargs=2, help="measure one case at one size, print its figures")
    parser.add_argument("--out", type=Path)
    given = parser.parse_args()
    if given.one:
        print(json.dumps(measure(given.one[0], int(given.one[1]))))
    else:
        main(given.sizes, given.out)
