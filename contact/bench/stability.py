"""Runs the matrix of stiff and extreme scenes: the error reached against what the condition allows."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contact.bench import truth
from contact.bench.extremes import Extreme, matrix
from contact.errors import ContactError, NotConverged
from contact.solution import Solution
from contact.solver import solve


@dataclass(frozen=True)
class Verdict:
    """One case. error, stated: of the stated measure; outcome: "pass", "known" (fails, and why is known) or "FAIL"."""

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


def run(case: Extreme) -> Verdict:
    """Solve to what is allowed, and compare: the true error at most the allowed one and at most the stated one."""
    start = time.process_time()
    note = ""
    found: Solution | None = None
    error, stated = np.inf, np.inf
    try:
        scene, exact = case.make()
        # From a tenth of what is allowed, so that the tolerance is not what limits the error, to just that.
        for tol in (min(max(0.1 * case.allowed, FINEST), COARSEST), min(case.allowed, 1e-2)):
            start = time.process_time()
            try:
                found, note = solve(scene, tol), ""
                break
            except NotConverged as failure:
                note = _short(failure)
                if failure.best is not None and (found is None or failure.best.error < found.error):
                    found = failure.best
    except ContactError as failure:
        note = _short(failure)
    seconds = time.process_time() - start
    if found is not None:
        error, stated = truth.stated_measure(found, exact), found.error
        if len(found.zones) != len(exact.zones) and not note:
            note = f"{len(found.zones)} zones found, {len(exact.zones)} exist"
            if found.certificate.undecided:
                note += "; the certificate says undecided"
            x = truth.comb(exact)
            note += f"; pressures at equal places differ by {truth.at_places(x, found.pressure(x), exact)[0]:.1e}"
    ok = error <= case.allowed and error <= stated < np.inf
    if not ok and np.isfinite(error) and error > stated:
        note = (note + "; " if note else "") + "the true error is above the stated one"
    outcome = "pass" if ok else "known" if case.known else "FAIL"
    return Verdict(
        case.group, case.name, case.condition, case.why, case.allowed, error, stated, seconds, outcome,
        "" if ok else "; ".join(part for part in (note, case.known) if part),
    )


FINEST, COARSEST = 1e-13, 1e-8


def _short(error: Exception) -> str:
    return " ".join(str(error).split())


def run_matrix(quick: bool, progress: Callable[[str, int, int | None], None] | None = None) -> list[Verdict]:
    """Every case of the matrix."""
    cases = matrix(quick)
    out = []
    for k, case in enumerate(cases):
        if progress is not None:
            progress("scenes", k, len(cases))
        out.append(run(case))
    return out
