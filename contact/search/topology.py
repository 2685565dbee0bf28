"""Which zones there are: a first proposal, Newton on their ends, a look over the whole line, corrections, and again.

The problem is convex, so zones whose pressure is positive inside and whose gap is positive outside are the solution.
Where a sign fails, the number of zones was wrong: pressure that pulls inside a zone splits it, an overlap outside brings a
new zone, zones that shrink away are dropped and zones that meet are merged.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

import sie
from contact.formulation.controls import Control, Load
from contact.formulation.fields import ZoneFields
from contact.formulation.problem import Problem
from contact.search.missed import Missed, WrongTopology, same
from contact.verify.accuracy import Found
from contact.verify.certificate import NOT_CHECKED, Certificate, certify

Array = NDArray[np.float64]
Progress = Callable[[str, int, int | None], None]
Timed = Callable[[str], AbstractContextManager[object]]

ROUNDS = 12
# Where a dip of the pressure may be a gap, zones are found to this.
TIGHT = 1e-15
# Where only the error of the ends makes signs fail, the next tolerance is this part of the last.
CLOSER = 1e-3
# Gaps over kinks below this part of the zones beside them are not taken to close.
_NARROW = 1e-3
# Over the ends' stated errors.
MARGIN = 10.0


def settle(
    problem: Problem, control: Control, table: Array, tolerance: float, progress: Progress | None = None,
    formal: bool = False, timed: Timed = nullcontext, near: bool = False, value: float = 0.0, steps: int = 40,
    rounds: int = ROUNDS,
) -> Found | Missed:
    """From proposed zones (n, 2) to zones that pass the certificate, or why they do not lead to any.

    formal: the zones are taken as they are, whatever the signs (a reference solution, not a contact). timed: of a part's name, what
    its time is taken with. near: the zones are given up as soon as they turn out to be far from the solution, or not as many. value: a
    first guess of the load that a width is given instead of. steps, rounds: of Newton's in a round, and of
    these, at the most.
    """
    slight: Found | None = None
    try:
        for found in _rounds(problem, control, table, tolerance, progress, formal, timed, near, value, steps, rounds):
            if formal or found.tolerance <= TIGHT or not _is_slight(found):
                return found
            # Whether so slight a dip is a gap, or so narrow a gap open, a solution to the tolerance does not tell: on to a
            # tighter one.
            slight = slight or found
    except WrongTopology as wrong:
        if slight is None:
            return wrong.missed
    assert slight is not None
    # Rounding does not let it be told either.
    return replace(slight, certificate=replace(slight.certificate, undecided=True))


def _rounds(
    problem: Problem, control: Control, table: Array, tolerance: float, progress: Progress | None, formal: bool,
    timed: Timed, near: bool, value: float, steps: int, rounds: int,
) -> Iterator[Found]:
    """Zones that pass, to the tolerance and, where more of them are asked for, to one as tight as there is."""
    free: sie.Free | None = None
    tried: list[tuple[float, Array]] = []
    for done in range(1, rounds + 1):
        if len(table) == 0:
            raise WrongTopology("all zones vanished", free)
        if not (np.all(np.isfinite(table)) and np.all(np.diff(table.ravel()) > 0)):
            raise WrongTopology("the zones are too narrow to tell their ends apart", free)
        if progress is not None:
            progress("zones", done, None)
        zones = kinds(problem, control, table)
        try:
            free = sie.find_ends(problem.equation(control), zones, tolerance, steps, value=value, walls=problem.walls, near=near)
        except sie.SingularSystem as failure:
            raise WrongTopology(f"the equation has no solution on such zones ({failure})", free) from failure
        if free.value is not None:
            value = free.value
        valley = _narrow_valley(problem, table, free)
        if valley is not None:
            length = valley * problem.units.length
            raise WrongTopology(f"a gap of about {length:.1e} m over the kink of a valley is too narrow to be found", free)
        if near and not free.converged:
            raise WrongTopology("the zones are not near those of the solution", free)
        if len(free.lost) or len(free.met):
            table = _dropped_or_merged(free, problem)
            continue
        if not free.converged:
            raise WrongTopology("the zone ends did not settle", free)
        _within_borders(problem, free.density.zones)
        fields = load_controlled(problem, control, free, tolerance)
        if formal:
            yield Found(free, fields, NOT_CHECKED, done, control, tolerance)
            return
        with timed("certificate"):
            certificate = certify(fields, control.load, control.name)
        if certificate.holds:
            yield Found(free, fields, certificate, done, control, tolerance)
            table, tolerance, near = free.density.zones.table, TIGHT, False
            continue
        if control.half_width is not None:
            raise WrongTopology("pressure or gap change sign", free)
        if tolerance > TIGHT and _is_error(free, certificate):
            table, tolerance = free.density.zones.table, max(TIGHT, CLOSER * tolerance)
            continue
        if near:
            raise WrongTopology(certificate.note or "there are other zones than these", free)
        ended = free.density.zones.table
        table = _corrected(free.density.zones, certificate, problem)
        if any(same(ended, before) for at, before in tried if at == tolerance):
            # To and fro between two numbers of zones: the error of one of them, or rounding, makes its signs fail.
            if tolerance <= TIGHT:
                raise WrongTopology("the number of zones did not settle", free)
            table, tolerance = ended, max(TIGHT, CLOSER * tolerance)
        tried.append((tolerance, ended))
    raise WrongTopology("the number of zones did not settle", free)


def _narrow_valley(problem: Problem, table: Array, free: sie.Free) -> float | None:
    """Width of a gap over the kink of a valley that the search has closed or taken off its kink: too narrow for it. Such gaps
    do not close, but narrow as exp(-pressure); None if there is none."""
    kinks, heights = problem.forcing.kinks
    at = kinks[heights < 0]
    if len(at) == 0 or len(table) < 2:
        return None
    if problem.period is not None:
        at = at - np.floor((at - table[0, 0]) / problem.period) * problem.period
    i = np.searchsorted(table[:, 0], at, side="right") - 1
    inner = (i >= 0) & (i < len(table) - 1)
    at, i = at[inner], i[inner]
    lo, hi = table[i, 1], table[i + 1, 0]
    width = np.diff(table)[:, 0]
    narrow = (at > lo) & (at < hi) & (hi - lo < _NARROW * np.minimum(width[i], width[i + 1]))
    now = free.density.zones
    lost = narrow & (np.isin(i, free.met) | (now.b[i] >= at) | (now.a[i + 1] <= at))
    return float((hi - lo)[lost].min()) if lost.any() else None


def _off(free: sie.Free) -> Array:
    """How far the ends may be off (Z, 2), with a margin: signs so close to them tell nothing."""
    zones = free.density.zones
    return np.asarray(MARGIN * (free.end_error + free.state.end_truncation) * (zones.b - zones.a)[:, None])


def _is_slight(found: Found) -> bool:
    """Whether a dip of the pressure, or a gap between zones, is so slight that the error of the solution may have made it."""
    zones, off = found.free.density.zones, _off(found.free)
    return found.certificate.dip <= 10 * found.tolerance or bool(np.any(zones.a[1:] - zones.b[:-1] <= off[1:, 0] + off[:-1, 1]))


def _is_error(free: sie.Free, certificate: Certificate) -> bool:
    """Whether all that fails lies so close to ends that their error may have made it."""
    zones, off = free.density.zones, _off(free)
    bad = np.concatenate((certificate.negative, certificate.overlaps))
    if len(bad) == 0:
        return False
    ends, reach = np.concatenate((zones.a, zones.b)), np.concatenate((off[:, 0], off[:, 1]))
    near = (np.abs(bad[:, :1] - ends) <= reach) & (np.abs(bad[:, 1:] - ends) <= reach)
    return bool(near.any(axis=1).all())


def kinds(problem: Problem, control: Control, table: Array) -> sie.Zones:
    """Zones with the kinds of their ends: held at sharp corners and where the half width is given, else as the law says."""
    count = len(table)
    end = problem.end if control.half_width is None else problem.held_end
    left, right = [end] * count, [end] * count
    lo, hi = problem.walls
    table = np.clip(table, lo, hi)
    symmetric = is_symmetric(problem, table)
    if symmetric:
        table = 0.5 * (table - table[::-1, ::-1])
    if table[0, 0] == lo:
        left[0] = sie.SINGULAR
    if table[-1, 1] == hi:
        right[-1] = sie.SINGULAR
    return sie.Zones.of(table, left, right, symmetric=symmetric)


def is_symmetric(problem: Problem, table: Array) -> bool:
    """Whether half of the zones need solving: profile and zones mirror each other about the origin."""
    if not problem.profile.symmetric or problem.units.origin != 0.0 or problem.centre != 0.0:
        return False
    if problem.cell is not None and max(-table[0, 0], table[-1, 1]) >= 0.5 * problem.cell:
        return False
    width = table[:, 1] - table[:, 0]
    return bool(np.all(np.abs(table + table[::-1, ::-1]) <= 0.25 * np.minimum(width, width[::-1])[:, None]))


def load_controlled(problem: Problem, control: Control, free: sie.Free, tolerance: float) -> ZoneFields:
    """The same zones under their load: fields, levels and stiffness are read from this state."""
    if control.load is not None:
        return ZoneFields(problem, free.state)
    zones = free.density.zones
    total = free.density.total if free.value is None else free.value
    left = [problem.end if end == problem.held_end else end for end in zones.left]
    right = [problem.end if end == problem.held_end else end for end in zones.right]
    ends = replace(zones, left=left, right=right)
    equation = problem.equation(Load(total))
    state = sie.solve_zones(equation, ends, max(0.1 * tolerance, 3e-16))
    return ZoneFields(problem, state.settled())


def _within_borders(problem: Problem, zones: sie.Zones) -> None:
    lo, hi = problem.borders
    if zones.a[0] <= lo or zones.b[-1] >= hi:
        raise WrongTopology("a contact zone reaches the border of the part of the profile that is known", None, beyond=True)
    if problem.period is not None and zones.b[-1] - zones.a[0] >= problem.period:
        raise WrongTopology("the zones fill the period", None)


def _dropped_or_merged(free: sie.Free, problem: Problem) -> Array:
    table = free.density.zones.table
    if len(free.met) and not len(free.lost):
        rows = [list(row) for row in table]
        for i in sorted(free.met, reverse=True):
            if i + 1 < len(rows):
                rows[i][1] = rows[i + 1][1]
                del rows[i + 1]
            elif len(rows) > 1 and problem.period is not None:
                rows[i][1] = rows[0][1] + problem.period
                del rows[0]
        return np.array(rows)
    return np.delete(table, free.lost, axis=0)


def _corrected(zones: sie.Zones, certificate: Certificate, problem: Problem) -> Array:
    """New zones: those with pulling parts cut out, and one in every overlap."""
    if len(certificate.negative) == 0 and len(certificate.overlaps) == 0:
        raise WrongTopology(certificate.note or "the balance of load fails", None)
    rows = []
    for a, b in zones.table:
        cuts = [(lo, hi) for lo, hi in certificate.negative if lo < b and hi > a]
        left = a
        for lo, hi in cuts:
            if lo > left:
                rows.append([left, lo])
            left = max(left, hi)
        if left < b:
            rows.append([left, b])
    for lo, hi in certificate.overlaps:
        middle, half = 0.5 * (lo + hi), 0.35 * (hi - lo)
        rows.append([middle - half, middle + half])
    rows.sort()
    table = np.array(rows)
    keep = [0]
    for k in range(1, len(table)):
        if table[k, 0] > table[keep[-1], 1]:
            keep.append(k)
        else:
            table[keep[-1], 1] = max(table[keep[-1], 1], table[k, 1])
    table = table[keep]
    if len(table) > 4 * len(zones) + 64:
        raise WrongTopology("the signs of pressure and gap change ever more often", None)
    if problem.period is not None and table[-1, 1] - table[0, 0] >= problem.period:
        raise WrongTopology("the zones fill the period", None)
    return np.asarray(table)
