"""Random scenes of every family, model and control, and the outcome of each.

    python -m contact.studies.random_scenes FIRST COUNT [--tol 1e-8] [--limit 60] [--out FILE.csv]

Loads reach from first touch to beyond full contact. Every scene must give a certified solution or
raise an error of the package `contact`. Anything else is a fault: another exception, a warning of
numpy or Python, a stated error above the tolerance, or wrong zones. Zones are compared with a
solution at a thousandth of the tolerance, and with an independent grid where it is fine enough. A
scene that takes longer than the limit, in seconds of processor time, is stopped; judging its
solution may take the same time again. The file gets one line of CSV per scene, and all outcomes are
counted at the end.
"""

from __future__ import annotations

import argparse
import csv
import signal
import sys
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import contact
from contact.search.grid.conjugate_gradient import Response
from contact.search.grid.nested_grids import grid_height, propose
from contact.studies import grid_judge
from contact.studies.scene_families import FAMILIES, OWN_MODELS, with_counter_body, with_own_model

Array = NDArray[np.float64]

COLUMNS = (
    "seed",
    "family",
    "model",
    "control",
    "value",
    "outcome",
    "reason",
    "zones",
    "error",
    "seconds",
    "detail",
)


@dataclass(frozen=True)
class Drawn:
    """A random scene with its seed and family."""

    seed: int
    family: str
    scene: contact.Scene

    @property
    def model(self) -> str:
        """Name of the interaction model, with the name of its closure if it has one."""
        name = self.scene.interaction.name
        closure = getattr(self.scene.interaction, "closure", None)
        return name if closure is None else f"{name}, {closure}"

    def fault(self, solution: contact.Solution, tol: float) -> str:
        """Return a message that says what is wrong with a solution; empty if nothing is wrong."""
        return unsound(self.scene, solution, tol) or (
            ""
            if solution.certificate.undecided
            else _against_tighter(self.scene, solution, tol) or _against_grid(self.scene, solution)
        )


def draw(seed: int) -> Drawn | contact.ContactError:
    """Return the random scene of a seed, or the error if its random parts are incompatible."""
    rng = np.random.default_rng(seed)
    length, modulus = 10.0 ** rng.uniform(-6, 1), 10.0 ** rng.uniform(5, 12)
    family = str(rng.choice(list(FAMILIES)))
    try:
        family, profile = with_counter_body(seed, family, FAMILIES[family](rng, length), length)
        interaction = with_own_model(seed, _interaction(rng, profile, length), length)
        kind = str(
            rng.choice([k for k in interaction.allows if k != "half_width" or profile.symmetric])
        )
        if kind in ("mean_pressure", "contact_fraction") and profile.period is None:
            kind = "load"
        if kind == "approach" and not (interaction.needs_period or interaction.datum is not None):
            interaction = contact.Isolated(datum=length * 10 ** rng.uniform(-1, 2))
        control: dict[str, Any] = {kind: _value(rng, profile, modulus, length, kind)}
        return Drawn(seed, family, contact.Scene(profile, modulus, interaction, **control))
    except contact.ContactError as error:
        return error


def _interaction(
    rng: np.random.Generator, profile: contact.Profile, length: float
) -> contact.Interaction:
    if profile.period is None:
        return contact.Isolated()
    which = rng.random()
    if which < 0.65:
        return contact.Periodic()
    if which < 0.75:
        return contact.Isolated()
    if which < 0.9:
        return contact.Localized("self-consistent", int(rng.integers(0, 4)))
    return contact.Localized()


def _value(
    rng: np.random.Generator, profile: contact.Profile, modulus: float, length: float, kind: str
) -> float:
    """A random value of a control, from far below full contact to about full contact or above.
    Loads and mean pressures begin eight decades below full contact.
    """
    if kind == "contact_fraction":
        return float(rng.choice([10 ** rng.uniform(-4, 0), 1 - 10 ** rng.uniform(-4, 0), 1.0]))
    if kind == "half_width":
        return length * 0.5 * 10 ** rng.uniform(-4, 0.02)
    x = profile.x0 + length * (np.arange(2048) + 0.37) / 2048
    with np.errstate(all="ignore"):
        heights, slopes = np.asarray(profile.height(x)), np.asarray(profile.slope(x))
    slopes, heights = slopes[np.isfinite(slopes)], heights[np.isfinite(heights)]
    slope = float(np.sqrt(np.sum(slopes**2) / max(len(slopes), 1))) or 1e-2
    if kind == "approach":
        span = float(np.max(heights, initial=0.0) - np.min(heights, initial=0.0)) or slope * length
        return span * 10 ** rng.uniform(-6, 0.2)
    full = (
        0.5 * modulus * slope * float(rng.choice([10 ** rng.uniform(-8, 0), rng.uniform(0.1, 3)]))
    )
    return full if kind == "mean_pressure" else full * length


class OutOfTime(BaseException):
    """Raised when a scene has used up its processor time.

    It is derived from BaseException, so that no handler of Exception catches it in the solver.
    """


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Raise OutOfTime in the `with` block after `seconds` of processor time."""
    if seconds == np.inf:
        yield
        return

    def stop(*_: object) -> None:
        raise OutOfTime

    before = signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, before)


def judged(drawn: Drawn, tol: float, limit: float = np.inf) -> dict[str, Any]:
    """Solve and judge a scene; return the scene's row of the CSV file."""
    kind, value = drawn.scene.control
    row: dict[str, Any] = dict(
        seed=drawn.seed,
        family=drawn.family,
        model=drawn.model,
        control=kind,
        value=value,
        outcome="",
        reason="",
        zones="",
        error="",
        detail="",
    )
    began = time.process_time()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", contact.ModelWarning)
        try:
            with limited(limit):
                solution = contact.solve(drawn.scene, tol=tol)
            row["seconds"] = round(time.process_time() - began, 3)
            row["outcome"], row["reason"] = (
                "solved",
                "undecided" if solution.certificate.undecided else "",
            )
            row["zones"], row["error"] = len(solution.zones), solution.error
            with limited(limit):
                row["detail"] = drawn.fault(solution, tol)
            if row["detail"]:
                row["outcome"] = "FAULT"
        except OutOfTime:
            row["outcome"], row["reason"] = (
                ("solved", "no time to judge it") if row["outcome"] else ("stopped", "")
            )
        except contact.ContactError as error:
            row["outcome"], row["reason"], row["detail"] = (
                type(error).__name__,
                _reason(error),
                str(error),
            )
            row["error"] = getattr(getattr(error, "best", None), "error", "")
            if wrong := grid_judge.wrongly_refused(drawn.scene, error):
                row["outcome"], row["detail"] = "FAULT", wrong
        except Exception as error:  # noqa: BLE001  (whatever it is, it is a fault to be listed)
            row["outcome"], row["reason"], row["detail"] = (
                "FAULT",
                type(error).__name__,
                repr(error),
            )
    row.setdefault("seconds", round(time.process_time() - began, 3))
    return row


def _reason(error: contact.ContactError) -> str:
    """Return a phrase that names the kind of an error, without the numbers of its message."""
    text = str(error)
    known = (
        "no symbol",
        "rounding of heights",
        "beside a corner",
        "kink of a valley",
        "the stated error",
        "did not settle",
        "border",
        "full contact",
        "beyond the largest",
        "half width",
        "branch",
        "too narrow",
        "positive everywhere",
        "datum",
        "isolated reference",
        "too many places",
        "fill the period",
        "vanished",
        "has no solution",
        "is not below",
        "finest grid",
    )
    return next((one for one in known if one in text), text[:60])


def unsound(scene: contact.Scene, solution: contact.Solution, tol: float) -> str:
    """Return a message if a solution is not certified or its error exceeds `tol`; else ''."""
    if not solution.certificate.holds and scene.interaction.exact:
        return f"not certified: {solution.certificate.note}"
    return "" if solution.error <= tol else f"stated error {solution.error:.2g}"


def _against_tighter(scene: contact.Scene, solution: contact.Solution, tol: float) -> str:
    """Return a message if a solution contradicts the one for a smaller tolerance; else ''."""
    try:
        tight = contact.solve(scene, tol=max(1e-3 * tol, 1e-13))
    except contact.NotConverged as error:
        tight = error.best
        if tight is None or not np.isfinite(tight.error):
            return ""
    if tight.certificate.undecided:
        return ""
    if len(tight.zones) != len(solution.zones):
        return (
            f"{len(solution.zones)} zones, but {len(tight.zones)} when solved to {1e-3 * tol:.0e}"
        )
    if len(tight.zones) == 0:
        return ""
    width = (tight.zones[:, 1] - tight.zones[:, 0])[:, None]
    ends = float((np.abs(tight.zones - solution.zones) / width).max())
    if ends > 0.9 * (scene.period or np.inf) / float(width.min()):
        return ""  # an end at the border of the cell was rounded to the other side
    allowed = solution.error + tight.error
    return f"ends off by {ends:.1e}, stated {allowed:.1e}" if ends > allowed else ""


def _against_grid(scene: contact.Scene, solution: contact.Solution) -> str:
    """Return a message about a zone or gap of a solution that a grid contradicts; else ''.

    A contradiction on a coarse grid must be confirmed by a fine grid, because the coarse grid may
    have fewer points than a measured trace.
    """
    if isinstance(scene.interaction, OWN_MODELS):
        return grid_judge.fault(scene, solution)
    exact_model = isinstance(scene.interaction, contact.Periodic)
    if (
        not exact_model
        or scene.period is None
        or len(solution.zones) == 0
        or not np.isfinite(solution.max_pressure)
    ):
        return ""
    return _against_cells(scene, solution, 2**13) and _against_cells(scene, solution, 2**17)


def _against_cells(
    scene: contact.Scene, solution: contact.Solution, points: int, least_cells: int = 8
) -> str:
    """Return a message about a zone or gap that a grid of `points` cells contradicts; else ''.

    Zones and gaps of fewer than `least_cells` cells are not compared.
    """
    period = scene.period
    assert period is not None
    cell = (scene.profile.x0, scene.profile.x0 + period)
    found = propose(
        lambda x: grid_height(scene.profile, x),
        cell,
        Response(scene.E_star),
        resolution=scene.profile.resolution,
        points=points,
        load=solution.load,
    )
    h = period / found.points
    x = scene.profile.x0 + h * (np.arange(found.points) + 0.5)
    touching, pressed = np.asarray(found.state.contact), solution.pressure(x) > 0
    for what, mask, other in (
        ("a zone", pressed, touching),
        ("a gap", ~pressed, ~touching),
        ("a contact of the grid", touching, pressed),
        ("a gap of the grid", ~touching, ~pressed),
    ):
        for start, stop in _runs(mask):
            if stop - start >= least_cells and not other[start:stop].any():
                where = f"{stop - start} cells at {x[start]:.6g}"
                return f"{what} of {where} is not there on a grid of {found.points}"
    return ""


def _runs(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Index pairs (start, stop), one for every run of true entries of a mask."""
    change = np.flatnonzero(np.diff(np.concatenate(([False], mask, [False])).astype(np.int8)))
    return list(zip(change[::2].tolist(), change[1::2].tolist(), strict=True))


def table(rows: list[dict[str, Any]]) -> list[str]:
    """Return lines of text with the number of scenes for each outcome and reason."""
    counts = Counter((row["outcome"], row["reason"]) for row in rows)
    return [
        f"{count:6d}  {outcome:14s} {reason}" for (outcome, reason), count in counts.most_common()
    ]


def _row(
    drawn: Drawn | contact.ContactError, seed: int, tol: float, limit: float
) -> dict[str, Any]:
    if isinstance(drawn, contact.ContactError):
        return dict.fromkeys(COLUMNS, "") | dict(
            seed=seed, outcome=type(drawn).__name__, reason="the scene itself", detail=drawn
        )
    return judged(drawn, tol, limit)


def main(
    arguments: list[str] | None = None,
    draw: Callable[[int], Drawn | contact.ContactError] = draw,
    description: str | None = __doc__,
) -> int:
    """Judge the scenes of some seeds and print the outcomes; return 3 if there is a fault."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("first", type=int)
    parser.add_argument("count", type=int)
    parser.add_argument("--tol", type=float, default=1e-8)
    parser.add_argument("--limit", type=float, default=60.0)
    parser.add_argument("--out", type=Path)
    options = parser.parse_args(arguments)
    rows: list[dict[str, Any]] = []
    with nullcontext() if options.out is None else options.out.open("w", newline="") as stream:
        writer = None if stream is None else csv.DictWriter(stream, COLUMNS)
        if writer is not None:
            writer.writeheader()
        for seed in range(options.first, options.first + options.count):
            rows.append(_row(draw(seed), seed, options.tol, options.limit))
            if rows[-1]["outcome"] == "FAULT":
                print({key: rows[-1][key] for key in COLUMNS if rows[-1][key] != ""}, flush=True)
            if writer is not None and stream is not None:
                writer.writerow(rows[-1])
                stream.flush()
    print("\n".join(table(rows)))
    return 3 if any(row["outcome"] == "FAULT" for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
