"""The figures that are required of the solver, compared with the measured ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from contact.model.units import quantity
from contact.studies.bench.cases import Case
from contact.studies.bench.peers import time_to
from contact.studies.bench.precision import Row
from contact.studies.bench.report import OURS, SingleZoneLimits, Table, of, within
from contact.studies.bench.scaling import Scaled

_PYTHON = "the time is that of calls from Python, not arithmetic: see the floor"


@dataclass(frozen=True)
class Figure:
    """A requirement, the measured figure, whether the requirement is `met`, and `why` it is not."""

    asked: str
    measured: str
    met: bool
    why: str


def table(
    rows: list[Row],
    cases: Sequence[Case],
    floors: list[Scaled],
    solves: float,
    peers: Sequence[str],
) -> Table:
    """The table of all requirements. Those on other codes are included only if `peers` ran."""
    single = [case.name for case in cases if case.single]
    figures = [_millisecond(rows, single), _floor(floors, solves), *_estimates(rows)]
    if peers:
        figures = [_hundredfold(rows, single, peers), *_rough(rows, peers), *figures]
    out: list[tuple[str, ...]] = [
        (figure.asked, figure.measured, "met" if figure.met else f"missed: {figure.why}")
        for figure in figures
    ]
    return Table("required", "what was asked", ("figure", "measured", ""), out)


def _hundredfold(rows: list[Row], single: Sequence[str], peers: Sequence[str]) -> Figure:
    """Return the `Figure` for speed: the fastest peer's time over our time, at an error of 1e-4.

    If no peer (other code) reaches this error, the figure is a lower bound. It takes the longest
    run of each peer, and the shortest of these times.
    """
    found: list[tuple[float, str]] = []
    for scene in single:
        ours = time_to(of(rows, scene, OURS), 1e-4)
        if ours is None:
            return Figure(_HUNDRED, f"{scene}: not reached", False, "the solver does not reach it")
        theirs = [
            (
                time_to(of(rows, scene, p), 1e-4),
                max((r.seconds for r in of(rows, scene, p)), default=0.0),
            )
            for p in peers
        ]
        reached = [t for t, _ in theirs if t is not None]
        ratio, sign = (
            (min(reached) / ours, "")
            if reached
            else (min(longest for _, longest in theirs) / ours, "> ")
        )
        found.append((ratio, f"{scene}: {sign}{ratio:.3g}"))
    return Figure(_HUNDRED, "; ".join(text for _, text in found), min(found)[0] >= 100, _PYTHON)


_HUNDRED = (
    "at an error of p(x) of 1e-4, 100 times faster than the faster peer on every single-zone scene"
)


def _millisecond(rows: list[Row], single: Sequence[str]) -> Figure:
    times = {scene: time_to(of(rows, scene, OURS), 1e-3) for scene in single}
    measured = "; ".join(
        f"{scene}: {'not reached' if t is None else quantity(t, 's', 3)}"
        for scene, t in times.items()
    )
    met = all(t is not None and t <= 1e-3 for t in times.values())
    return Figure(
        "at an error of p(x) of 1e-3, never slower than a millisecond on a single zone",
        measured,
        met,
        _PYTHON,
    )


def _rough(rows: list[Row], peers: Sequence[str]) -> list[Figure]:
    scenes = [
        scene
        for scene in dict.fromkeys(row.scene for row in rows)
        if scene.startswith("rough") and "zones" in scene
    ]
    out = []
    for scene in scenes:
        ours = time_to(of(rows, scene, OURS), 1e-8, "error")
        theirs = [t for t in (time_to(of(rows, scene, p), 1e-3) for p in peers) if t is not None]
        longest = min(max((r.seconds for r in of(rows, scene, p)), default=0.0) for p in peers)
        measured = f"{'not reached' if ours is None else quantity(ours, 's', 3)} against "
        measured += (
            quantity(min(theirs), "s", 3) if theirs else f"more than {quantity(longest, 's', 3)}"
        )
        met = ours is not None and ours < (min(theirs) if theirs else longest)
        out.append(
            Figure(
                f"{scene}: 1e-8 in less than the faster peer's time to 1e-3",
                measured,
                met,
                "too many unknowns",
            )
        )
    return out


def _floor(floors: list[Scaled], solves: float) -> Figure:
    measured = "; ".join(
        f"{row.series}: {quantity(row.seconds, 's', 3)}, "
        f"{row.seconds / row.floor:.3g} floors, {row.seconds / solves:.2g}"
        for row in floors
    )
    limits = SingleZoneLimits()
    asked = (
        f"single scenes to 1e-12 within half a millisecond, {limits.floors:g} floors and "
        f"{limits.dense_solves:g} of 100 dense solves of 33 unknowns, of two zones within twice "
        "the first and the last"
    )
    return Figure(asked, measured, all(within(row, solves) for row in floors), _PYTHON)


def _estimates(rows: list[Row]) -> list[Figure]:
    """Return two `Figure`s: how often the stated error is a bound, and how often it is sharp.

    It is sharp if it is at most 100 max(true error, 1e-13).
    """
    mine = [
        (row.error, row.stated)
        for row in rows
        if row.method == OURS and row.error is not None and row.stated is not None
    ]
    below = sum(error <= stated for error, stated in mine)
    sharp = sum(stated <= 100 * max(error, 1e-13) for error, stated in mine)

    def count_of(count: int) -> str:
        return f"{count} of {len(mine)} runs"

    return [
        Figure(
            "the true error is at most the stated one",
            count_of(below),
            below == len(mine),
            "an estimate, not a bound",
        ),
        Figure(
            "the stated error is at most 100 times the true one (or 1e-13) in nine of ten",
            count_of(sharp),
            sharp >= 0.9 * len(mine),
            "the estimate errs on the safe side",
        ),
    ]
