"""Solves the stiff and extreme scenes and compares their errors with the allowed errors.

The condition number of a scene gives its allowed error (`contact.studies.bench.extremes`).
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from contact.errors import ContactError, ModelWarning, NotConverged
from contact.model.scene import Scene
from contact.solution.solution import Solution
from contact.solver import solve
from contact.studies.bench import clock, truth
from contact.studies.bench.extremes import Extreme, matrix
from contact.studies.bench.truth import Exact


@dataclass(frozen=True)
class Verdict:
    """The verdict on one extreme scene: its allowed, true and stated errors, and the outcome.

    `error` and `stated` are the true and the stated error. `outcome` is one of
    - "pass";
    - "undecided": two topologies are the same answer within the allowed error, and the certificate
      says so;
    - "not judged": the reference solution is not accurate enough or takes too long;
    - "known": a failure whose reason is known;
    - "FAIL".
    """

    group: str
    name: str
    condition: float
    why: str
    allowed: float
    error: float
    stated: float
    seconds: float
    outcome: str
    note: str


def attempt(scene: Scene, allowed: float, patience: float) -> tuple[Solution | None, str, float]:
    """Solve a scene; return (best solution, error message, processor time of the last solve).

    The first tolerance is a tenth of the allowed error, so that the tolerance does not limit the
    error. If this tolerance is not reached, the second tolerance is the allowed error.
    """
    best: Solution | None = None
    note = ""
    start = time.process_time()
    for tol in (float(np.clip(0.1 * allowed, 1e-13, 1e-2)), min(allowed, 1e-2)):
        start = time.process_time()
        try:
            return (
                clock.limited(partial(solve, scene, tol), patience),
                "",
                time.process_time() - start,
            )
        except NotConverged as failure:
            note = _short(failure)
            if failure.best is not None and (best is None or failure.best.error < best.error):
                best = failure.best
            if best is None or not np.isfinite(best.error):
                break  # a larger tolerance would not help
        except (ContactError, clock.TooLong) as failure:
            note = _short(failure)
            break
    return best, note, time.process_time() - start


def run(case: Extreme, patience: float = 60.0) -> Verdict:
    """Solve an extreme scene and judge the solution.

    The scene passes if the true error is at most the allowed error and at most the stated error. A
    solve that takes longer than `patience` [s] is given up.
    """
    try:
        scene, exact = clock.limited(case.make, patience)
    except (ContactError, clock.TooLong) as failure:
        note = f"its truth: {_short(failure)}"
        return _verdict(case, np.inf, np.inf, np.nan, "not judged", note)
    found, note, seconds = attempt(scene, case.allowed, patience)
    error = stated = np.inf
    outcome = "FAIL"
    if found is not None:
        error, stated = truth.stated_measure(found, exact), found.error
        # `known_to` is the error of the reference solution `exact`. It is 0 for a closed form.
        known_to = getattr(exact, "error", 0.0)
        if error <= case.allowed and error <= stated + known_to < np.inf:
            outcome = "pass"
        elif len(found.zones) != len(exact.zones):
            apart, text = _other_topology(found, exact)
            note = note or text
            if found.certificate.undecided and apart <= case.allowed and not case.decidable:
                outcome = "undecided"
        elif error <= stated + known_to < np.inf and known_to > case.allowed:
            outcome, note = "not judged", f"its truth is known to {known_to:.0e}"
        elif error > stated + known_to:
            note = (note + "; " if note else "") + "the true error is above the stated one"
    return _verdict(case, error, stated, seconds, outcome, note)


def _verdict(
    case: Extreme, error: float, stated: float, seconds: float, outcome: str, note: str
) -> Verdict:
    if outcome == "FAIL" and case.known:
        outcome, note = "known", "; ".join(part for part in (note, case.known) if part)
    return Verdict(
        case.group,
        case.name,
        case.condition,
        case.why,
        case.allowed,
        error,
        stated,
        seconds,
        outcome,
        "" if outcome == "pass" else note,
    )


def _other_topology(found: Solution, exact: Exact) -> tuple[float, str]:
    """Result for a solution with a wrong number of zones: (difference of pressures, message).
    The difference is the largest one between found and exact pressure, relative to the peak.
    """
    x = truth.comb(exact)
    apart = truth.at_places(x, found.pressure(x), exact)[0]
    word = ", undecided" if found.certificate.undecided else ""
    zones = f"{len(found.zones)} of {len(exact.zones)} zones{word}"
    return apart, f"{zones}; pressures at equal places differ by {apart:.1e}"


def _short(error: Exception) -> str:
    return " ".join(str(error).split())


def run_matrix(
    quick: bool, progress: Callable[[str, int, int | None], None] | None = None
) -> list[Verdict]:
    """Solve and judge every extreme scene; return the verdicts."""
    cases = matrix(quick)
    out = []
    for k, case in enumerate(cases):
        if progress is not None:
            progress("scenes", k, len(cases))
        with warnings.catch_warnings():
            # The model warns about steep slopes. This warning is ignored, since scenes with E* = 1
            # and length 1 may have steeper slopes than real surfaces.
            warnings.simplefilter("ignore", ModelWarning)
            out.append(run(case))
    return out
