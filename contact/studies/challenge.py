"""A contact challenge: rough line contacts with answers that are certified, for any code to be
judged by.

    python -m contact.studies.challenge make                 # docs/challenge/NAME.json, anew
    python -m contact.studies.challenge judge ANSWER.json    # an answer of another code
    python -m contact.studies.challenge peers [--out FOLDER] # tamaas and ContactMechanics (extra `peers`)

Each problem is a self-affine profile of one period, E* = 1 Pa and period 1 m, given by its
harmonics: nothing has to be drawn at random again. Its file has, for some mean pressures, contact
fraction, mean gap and peak; and for one of them the ends of all zones and the pressure at stated
places, all with stated errors.

An answer is JSON: {"problem": NAME, "mean_pressure": p, "contact_fraction": A, "mean_gap": g,
"max_pressure": P, "x": [...], "pressure": [...]}, x ascending in [-1/2, 1/2), and any of it may be
left out but the first two.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import contact
from contact.extras import require
from contact.studies.bench import machine
from contact.studies.bench.cases import Case
from contact.studies.bench.peers import PEERS, require_both
from contact.studies.gallery import save

Array = NDArray[np.float64]

FOLDER = Path(__file__).parents[2] / "docs" / "challenge"
SLOPE = 0.01  # rms
TOL = 1e-10
# Mean pressures over E* times the rms slope; of one of them everything is told.
LOADS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.4)
DETAIL = 0.05
# Places of pressures on each zone, from -1 to 1.
PLACES = (-0.9, -0.5, 0.0, 0.5, 0.9)
GRIDS = tuple(2**k for k in range(9, 16))
_PEER_TOL = 1e-8


@dataclass(frozen=True)
class Problem:
    """Hurst exponent, first and last harmonic, seed of numpy's default generator."""

    name: str
    hurst: float
    first: int
    last: int
    seed: int

    @property
    def profile(self) -> contact.Fourier:
        return contact.self_affine(
            hurst=self.hurst,
            period=1.0,
            shortest=1 / self.last,
            longest=1 / self.first,
            rms_slope=SLOPE,
            seed=self.seed,
        )


PROBLEMS = (
    Problem("few", 0.8, 2, 32, 1),
    Problem("some", 0.8, 4, 256, 2),
    Problem("many", 0.8, 4, 1024, 3),
    Problem("jagged", 0.3, 4, 256, 4),
)
NAMED = tuple(one.name for one in PROBLEMS)


def made(problem: Problem) -> dict[str, Any]:
    """The file of a problem."""
    profile = problem.profile
    scene = contact.Scene(profile, 1.0, contact.Periodic(), mean_pressure=DETAIL * SLOPE)
    solutions = contact.solve_many(scene, np.array(LOADS) * SLOPE, tol=TOL)
    assert all(solution.certificate.holds for solution in solutions)
    detail = solutions[LOADS.index(DETAIL)]
    return {
        "name": problem.name, "hurst": problem.hurst, "seed": problem.seed, "rms_slope": SLOPE, "E_star": 1.0, "period": 1.0,
        "gap_at_zero_load": "f(x) = sum over k = 1, 2, ... of cosine[k-1] cos(2 pi k x) + sine[k-1] sin(2 pi k x), heights are -f",
        "cosine": [float(value) for value in np.asarray(profile.cosine)], "sine": [float(value) for value in np.asarray(profile.sine)],
        "curve": [_numbers(solution) for solution in solutions],
        "detail": {**_numbers(detail), "zones": detail.zones.tolist(), **_pressures(detail)},
    }  # fmt: skip


def _numbers(solution: contact.Solution) -> dict[str, float]:
    assert (
        solution.mean_pressure is not None
        and solution.contact_fraction is not None
        and solution.mean_gap is not None
    )
    return {
        "mean_pressure": solution.mean_pressure, "contact_fraction": solution.contact_fraction, "mean_gap": float(solution.mean_gap),
        "max_pressure": solution.max_pressure, "zones": len(solution.zones), "error": solution.error,
    }  # fmt: skip


def _pressures(solution: contact.Solution) -> dict[str, Any]:
    """Places, pressures there, and by how much these may be off: at the same x, where moved ends
    shift the place within its zone.
    """
    half = 0.5 * solution.zone_widths[:, None]
    x = (solution.zones.mean(axis=1)[:, None] + half * np.array(PLACES)).ravel()
    step = np.repeat(1e-4 * half, len(PLACES))
    pressure = solution.pressure(x)
    steepness = np.abs(solution.pressure(x + step) - solution.pressure(x - step)) / (2 * step)
    off = solution.error * (solution.max_pressure + 2 * np.repeat(half, len(PLACES)) * steepness)
    return {"x": x.tolist(), "pressure": pressure.tolist(), "pressure_error": float(off.max())}


def drawn(folder: Path = FOLDER) -> Any:
    """Area and gap over the load of all problems, as a matplotlib Figure."""
    figure = require("matplotlib.figure").Figure(figsize=(7.2, 3.2), layout="constrained")
    area, gap = figure.subplots(1, 2)
    for problem in PROBLEMS:
        truth = read(problem.name, folder)
        load = np.array([row["mean_pressure"] for row in truth["curve"]]) / (
            truth["E_star"] * truth["rms_slope"]
        )
        for axes, what, scale in (
            (area, "contact_fraction", 1.0),
            (gap, "mean_gap", 1.0 / truth["curve"][0]["mean_gap"]),
        ):
            axes.plot(
                load,
                [scale * row[what] for row in truth["curve"]],
                "o-",
                ms=3,
                lw=1.0,
                label=problem.name,
            )
    area.set(xscale="log", yscale="log", ylabel="contact fraction")
    gap.set(xscale="log", ylabel="mean gap / that at the lightest load")
    for axes in (area, gap):
        axes.set_xlabel("mean pressure / (E* rms slope)")
        axes.legend(fontsize=7, frameon=False)
    return figure


def read(name: str, folder: Path = FOLDER) -> dict[str, Any]:
    """The file of a problem, by its name."""
    file = folder / f"{name}.json"
    if not file.is_file():
        raise contact.SceneError.unknown(
            "problem", name, [one.stem for one in folder.glob("*.json")]
        )
    return dict(json.loads(file.read_text(encoding="utf-8")))


def judged(answer: Mapping[str, Any], folder: Path = FOLDER) -> dict[str, float]:
    """How far an answer is off: numbers relative to the true ones, pressures over the true peak,
    the largest and the mean of all places.

    Pressures are read between the answer's places by straight lines.
    """
    truth = read(str(answer.get("problem")), folder)
    told = next(
        (
            row
            for row in truth["curve"]
            if np.isclose(row["mean_pressure"], answer.get("mean_pressure", np.nan), rtol=1e-9)
        ),
        None,
    )
    if told is None:
        known = ", ".join(f"{row['mean_pressure']:g}" for row in truth["curve"])
        raise contact.SceneError.of("mean_pressure", answer.get("mean_pressure"), f"one of {known}")
    off = {
        name: abs(float(answer[name]) / told[name] - 1)
        for name in ("contact_fraction", "mean_gap", "max_pressure")
        if answer.get(name) is not None
    }
    detail = truth["detail"]
    if answer.get("pressure") is not None and told["mean_pressure"] == detail["mean_pressure"]:
        x, pressure = (
            np.asarray(answer["x"], dtype=float),
            np.asarray(answer["pressure"], dtype=float),
        )
        around = np.interp(detail["x"], np.concatenate((x - 1, x, x + 1)), np.tile(pressure, 3))
        far = np.abs(around - detail["pressure"]) / detail["max_pressure"]
        off |= {"pressure, largest": float(far.max()), "pressure, mean": float(far.mean())}
    return off


def answered(
    name: str, mean_pressure: float, solve: Callable[[Array], Array | None], grid: int
) -> dict[str, Any] | None:
    """The answer of a code with an even periodic grid, whose `solve` takes heights and gives
    pressures; None where it gives none.
    """
    truth = read(name)
    profile = contact.Fourier(1.0, truth["cosine"], truth["sine"])
    x = profile.x0 + np.arange(grid) / grid
    shape = np.asarray(profile.height(x))
    pressure = solve(-shape - np.max(-shape))
    if pressure is None:
        return None
    q = 2 * np.pi * np.fft.rfftfreq(grid, 1 / grid)
    q[0] = np.inf
    gap = shape + np.fft.irfft(np.fft.rfft(pressure) * 2 / q, grid)
    touching = pressure > 0
    return {
        "problem": name, "mean_pressure": mean_pressure, "contact_fraction": float(touching.mean()), "max_pressure": float(pressure.max()),
        # Where it touches, the gap is zero as far as the code has solved for that.
        "mean_gap": float(np.mean(gap - gap[touching].mean())), "x": x, "pressure": pressure,
    }  # fmt: skip


def _by_peer(
    prepare: Callable[..., Any], profile: contact.Fourier, mean_pressure: float
) -> Callable[[Array], Array | None]:
    case = Case("challenge", profile, 1.0, mean_pressure, contact.solve, "the challenge")  # type: ignore[arg-type]

    def solve(heights: Array) -> Array | None:
        run, answer = prepare(heights, case, _PEER_TOL)
        run()
        found: Array | None = answer()
        return found

    return solve


NAMES = ("contact_fraction", "mean_gap", "max_pressure", "pressure, largest", "pressure, mean")


def peers(names: Iterable[str] = NAMED, grids: Iterable[int] = GRIDS) -> list[tuple[str, ...]]:
    """A row for each problem, code and grid: how far it is off, and its processor time."""
    require_both()
    rows = []
    for name in names:
        truth = read(name)
        profile = contact.Fourier(1.0, truth["cosine"], truth["sine"])
        for peer in PEERS:
            for grid in (n for n in grids if n > 4 * len(truth["cosine"])):
                solve = _by_peer(peer.prepare, profile, DETAIL * SLOPE)
                start = time.process_time()
                answer = answered(name, DETAIL * SLOPE, solve, grid)
                seconds = time.process_time() - start
                told = (
                    ["not converged"] * len(NAMES)
                    if answer is None
                    else [f"{judged(answer)[what]:.1e}" for what in NAMES]
                )
                rows.append((name, peer.name, f"{grid:,}", *told, f"{seconds:.2f}"))
                print(" | ".join(rows[-1]), file=sys.stderr, flush=True)
    return rows


def along(names: Iterable[str] = NAMED, grid: int = GRIDS[-1]) -> list[tuple[str, ...]]:
    """A row for each problem and code: how far it is off at the worst of all loads, on the finest
    grid.
    """
    rows = []
    for name in names:
        truth = read(name)
        profile = contact.Fourier(1.0, truth["cosine"], truth["sine"])
        for peer in PEERS:
            found = [
                (load, answered(name, load, _by_peer(peer.prepare, profile, load), grid))
                for load in np.array(LOADS) * SLOPE
            ]
            off = [judged(answer) for _, answer in found if answer is not None]
            worst = [f"{max(one[what] for one in off):.1e}" for what in NAMES[:3]]
            rows.append((name, peer.name, f"{grid:,}", *worst, f"{len(off)} of {len(found)}"))
    return rows


def own() -> list[tuple[str, ...]]:
    """What this package says of each problem: zones and stated error, and what it takes at three
    tolerances.
    """
    rows = []
    for problem in PROBLEMS:
        scene = contact.Scene(
            problem.profile, 1.0, contact.Periodic(), mean_pressure=DETAIL * SLOPE
        )
        for tol in (1e-3, 1e-6):
            start = time.process_time()
            solution = contact.solve(scene, tol=tol)
            seconds = time.process_time() - start
            answer = {"problem": problem.name, **_numbers(solution), **_pressures(solution)}
            told = (f"{off[what]:.1e}" for off in (judged(answer),) for what in NAMES)
            rows.append((problem.name, "contact", f"tol {tol:.0e}", *told, f"{seconds:.2f}"))
    return rows


HEAD = ("problem", "code", "grid", "contact fraction", "mean gap", "peak")


def markdown(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    """A table for docs/challenge.md."""
    told = ", ".join(" ".join(row) for row in machine.table(("tamaas", "ContactMechanics")).rows)
    lines = "\n".join(f"| {' | '.join(line)} |" for line in (head, ("---",) * len(head), *rows))
    return f"{lines}\n\nMeasured with {told}.\n"


def main(arguments: list[str]) -> None:
    if arguments[:1] == ["make"]:
        FOLDER.mkdir(exist_ok=True)
        for problem in PROBLEMS:
            text = json.dumps(made(problem), indent=None, separators=(",", ":"))
            (FOLDER / f"{problem.name}.json").write_text(text + "\n", encoding="utf-8")
            print(f"written: {FOLDER / problem.name}.json")
        save(drawn(), FOLDER.parent / "images" / "challenge.png")
    elif arguments[:1] == ["judge"] and len(arguments) == 2:
        for what, off in judged(json.loads(Path(arguments[1]).read_text(encoding="utf-8"))).items():
            print(f"{what:20} {off:.2e}")
    elif arguments[:1] == ["peers"]:
        tables = {
            "challenge": markdown(
                (*HEAD, "p(x), largest", "p(x), mean", "processor time [s]"), own() + peers()
            ),
            "challenge-curves": markdown((*HEAD, "loads solved"), along()),
        }
        for name, table in tables.items():
            print(table)
            if arguments[1:2] == ["--out"]:
                (Path(arguments[2]) / f"{name}.md").write_text(table, encoding="utf-8")
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main(sys.argv[1:])
