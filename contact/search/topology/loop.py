"""Which intervals there are: a first proposal, Newton on their ends, a look over the whole line,
corrections, and again.

The intervals are the zones, with the pressure as the unknown, or the gaps between them, with the
slope of the gap: a formulation says which, and what belongs to it. The frictionless problem is
convex, so zones whose pressure is positive inside and whose gap is positive outside are the
solution. Where a sign fails, the number of intervals was wrong: parts of the wrong sign are cut out
of an interval, and where the other sign fails outside, a new one begins; intervals that shrink away
are dropped and those that meet are merged.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from typing import Any, Protocol, TypeVar

import numpy as np

import sie
from contact.errors import ContactError, SceneError
from contact.formulation import height_rounding
from contact.formulation.controls import Control
from contact.formulation.problem import Problem
from contact.search.topology.failure import Failure, WrongTopology, same
from contact.search.topology.intervals import merged
from contact.verify.certificate import NOT_CHECKED, Certificate, Solved
from sie import Array, Mask, record

Progress = Callable[[str, int, int | None], None]
Timed = Callable[[str], AbstractContextManager[object]]
Kind = TypeVar("Kind", bound=Solved, covariant=True)

ROUNDS = 12
# Where a dip of the pressure may be a gap, intervals are found to this.
TIGHT = 1e-15
# Where only the error of the ends makes signs fail, the next tolerance is this part of the last.
CLOSER = 1e-3
# Of so many intervals hardly any first guess has the right ones: these are looked at first with
# ends that are known to a part of their widths, but for a few, until no more than another part of
# them is put right at once.
MANY = 1000
LOOSELY = 1e-3
UNKNOWN = 0.005
FEW = 0.05
# Where more than so many are put right, that is done again, for as long as it is no more than this
# part of the last; of fewer at first hardly ever one is left. Where some are put right after that,
# the next look is one with all ends known to this part: one that is missing costs several tight
# solutions.
SURE = 64
FEWER = 0.5
CLOSELY = 1e-6
# Steps after which the few are no longer waited for; how often intervals that are lost on the way
# are left out.
PATIENT = 2
LEFT_OUT = 24
# Over the ends' stated errors.
MARGIN = 10.0
# Ends on either side of where signs fail that may have made them.
_BESIDE = 2


class Formulation(Protocol[Kind]):
    """What is unknown, and on which intervals: the pressure on zones
    (contact.search.topology.pressure_form), or the slope of the gap on gaps
    (contact.search.topology.gap_form). what: "zone" or "gap".
    """

    @property
    def problem(self) -> Problem: ...

    @property
    def what(self) -> str: ...

    def intervals(self, control: Control, table: Array) -> sie.Zones:
        """The proposed intervals with the kinds of their ends; WrongTopology where they cannot be
        those of a contact.
        """

    def moved(self, control: Control, zones: sie.Zones, how: NewtonSettings) -> sie.Free:
        """Newton on their ends."""

    def refuse(self, table: Array, free: sie.Free) -> None:
        """WrongTopology where what Newton came to from the table leads to no solution."""

    def fields(self, control: Control, free: sie.Free, tolerance: float) -> Any:
        """The same intervals under the load that they have: fields, levels and stiffness are read
        from this state.
        """

    def certificate(self, fields: Any, control: Control, few: float = 0.0) -> Certificate:
        """Signs on the whole line, with the intervals where they fail. few: part of all ends that
        is not known.
        """

    def corrected(self, zones: sie.Zones, certificate: Certificate) -> Array:
        """New intervals, by where the signs fail."""

    def solved(
        self,
        free: sie.Free,
        fields: Any,
        certificate: Certificate,
        rounds: int,
        control: Control,
        tolerance: float,
    ) -> Kind:
        """What passed."""

    def is_slight(self, found: Solved) -> bool:
        """Whether what tells the number of intervals is so slight that the error of the solution
        may have made it.
        """


@record
class NewtonSettings:
    """How Newton's method finds the ends of the intervals.

    tolerance: of the ends. load_guess: the load, or the mean pressure, where the control does not
    give it. max_steps: 0 leaves it to the formulation. abandon_if_far: give up as soon as the
    intervals turn out to be far from the solution, or not as many. initial_error: of the ends, over
    the widths of their intervals, as far as it is known. modes_like: a solution on about the same
    intervals, whose numbers of modes are the first ones. unresolved_fraction: the part of all ends
    that may stay unknown, after `patience` steps. allow_loss: intervals may vanish or merge.
    decay: wanted of the coefficients, over the largest; None: what goes with the tolerance.
    """

    tolerance: float
    load_guess: float = 0.0
    max_steps: int = 0
    abandon_if_far: bool = False
    initial_error: float = 1.0
    modes_like: Any = None
    unresolved_fraction: float = 0.0
    patience: int = 0
    allow_loss: bool = False
    decay: float | None = None

    def ends(
        self, equation: sie.Equation, zones: sie.Zones, most_steps: int, **own: Any
    ) -> sie.Free:
        """Those of the intervals of an equation. own: what else a formulation tells
        `sie.find_ends`.
        """
        return sie.find_ends(
            equation,
            zones,
            self.tolerance,
            self.max_steps or most_steps,
            value=self.load_guess,
            near=self.abandon_if_far,
            off=self.initial_error,
            few=self.unresolved_fraction,
            patient=self.patience,
            drops=self.allow_loss,
            **own,
        )


def refine_topology(
    form: Formulation[Kind],
    control: Control,
    table: Array,
    newton: NewtonSettings,
    progress: Progress | None = None,
    formal: bool = False,
    timed: Timed = nullcontext,
    rounds: int = ROUNDS,
) -> Kind | Failure:
    """From proposed intervals (n, 2) to intervals that pass the certificate, or why they do not
    lead to any.

    formal: they are taken as they are, whatever the signs (a reference solution, not a contact).
    timed: of a part's name, what its time is taken with. rounds: at the most.
    """
    slight: Kind | None = None
    try:
        for found in _rounds(form, control, table, newton, progress, formal, timed, rounds):
            if formal or found.tolerance <= TIGHT or not form.is_slight(found):
                return found
            # Whether so slight a dip is a gap, or so narrow a gap open, a solution to the tolerance
            # does not tell: on to a tighter one.
            slight = slight or found
    except WrongTopology as wrong:
        if slight is None:
            return wrong.failure
    assert slight is not None
    # Rounding does not let it be told either.
    return replace(slight, certificate=replace(slight.certificate, undecided=True))


def _rounds(
    form: Formulation[Kind],
    control: Control,
    table: Array,
    newton: NewtonSettings,
    progress: Progress | None,
    formal: bool,
    timed: Timed,
    rounds: int,
) -> Iterator[Kind]:
    """Intervals that pass, to the tolerance and, where more of them are asked for, to one as tight
    as there is.
    """
    free: sie.Free | None = None
    tried: list[tuple[float, Array]] = []
    wanted = newton.tolerance
    if (
        len(table) >= MANY
        and newton.initial_error >= 1.0
        and not (formal or newton.abandon_if_far or newton.max_steps)
    ):
        newton = replace(
            newton,
            tolerance=max(wanted, LOOSELY),
            unresolved_fraction=UNKNOWN,
            patience=PATIENT,
            allow_loss=True,
        )
    done, left_out, failed = 0, 0, np.inf
    while done < rounds:
        done += 1
        if progress is not None:
            progress(f"{form.what}s", done, None)
        # Of many intervals the sums of the last round take as much memory as those of this one.
        before = None if free is None or free.state.iterated else free
        free = None
        free = _ended(form, control, table, newton, before)
        left = free.state.sizes if free.state.iterated else newton.modes_like
        newton = replace(
            newton,
            load_guess=newton.load_guess if free.value is None else free.value,
            initial_error=1.0,
            modes_like=left,
        )
        ended = free.density.zones.table
        if len(free.lost) or len(free.met):
            table = (
                np.delete(ended, free.lost, axis=0)
                if len(free.lost)
                else merged(ended, free.met, form.problem.period)
            )
            if newton.unresolved_fraction and left_out < LEFT_OUT:
                # Of very many some are always about to be lost: no round of its own.
                done, left_out, newton = (
                    done - 1,
                    left_out + 1,
                    replace(newton, patience=max(newton.patience - len(free.trace), 0)),
                )
            continue
        if not free.converged and not newton.allow_loss:
            told = f"the {form.what} ends did not settle"
            raise WrongTopology(f"{told}: {free.reason}" if free.unresolved else told, free)
        fields = form.fields(control, free, newton.tolerance)
        if formal:
            yield form.solved(free, fields, NOT_CHECKED, done, control, newton.tolerance)
            return
        with timed("certificate"):
            loosely = newton.tolerance > wanted and not (
                free.converged and newton.unresolved_fraction == 0.0
            )
            certificate = form.certificate(fields, control, UNKNOWN if loosely else 0.0)
        if newton.tolerance > wanted:
            table, newton, failed = _loosely(
                form, free, fields.state, certificate, newton, wanted, failed
            )
        elif not free.converged:
            # Where signs fail tells which ones are missing.
            missing = not certificate.holds
            table = form.corrected(free.density.zones, certificate) if missing else ended
            newton = replace(newton, allow_loss=missing)
        elif certificate.holds:
            yield form.solved(free, fields, certificate, done, control, newton.tolerance)
            table, newton = ended, replace(newton, tolerance=TIGHT, abandon_if_far=False)
        else:
            # What bears so little that signs tell it at last would be lost in rougher solutions.
            known = newton.tolerance if free.state.iterated else 1.0
            table, newton = _again(
                form,
                control,
                free,
                fields.state,
                certificate,
                replace(newton, initial_error=known),
                tried,
            )
        del fields, certificate
    raise WrongTopology(f"the number of {form.what}s did not settle", free)


def _loosely(
    form: Formulation[Kind],
    free: sie.Free,
    state: sie.AnyState,
    certificate: Certificate,
    newton: NewtonSettings,
    wanted: float,
    failed: float,
) -> tuple[Array, NewtonSettings, float]:
    """Where to go on from ends that are known to a part of their widths, and how many signs have
    failed: loosely where many intervals are put right, or else to the wanted tolerance, once more
    closely where others were before. What may be their error is left as it is. failed: signs that
    did so before.
    """
    near = [
        _end_distances(free, state, bad) for bad in (certificate.negative, certificate.overlaps)
    ]
    certificate = replace(
        certificate,
        negative=certificate.negative[~near[0]],
        overlaps=certificate.overlaps[~near[1]],
    )
    put_right = len(certificate.negative) + len(certificate.overlaps)
    zones = free.next_zones
    if newton.unresolved_fraction and (
        SURE < put_right <= FEWER * failed or put_right > FEW * len(zones)
    ):
        newton = replace(newton, patience=PATIENT)
    else:
        closely = newton.unresolved_fraction and put_right > 0 and np.isfinite(failed)
        known = 1.0 if newton.unresolved_fraction or not free.converged else newton.tolerance
        newton = replace(
            newton,
            tolerance=max(CLOSELY, wanted) if closely else wanted,
            unresolved_fraction=0.0,
            initial_error=known,
        )
    return form.corrected(zones, certificate) if put_right else zones.table, newton, put_right


def _ended(
    form: Formulation[Kind],
    control: Control,
    table: Array,
    newton: NewtonSettings,
    before: sie.Free | None,
) -> sie.Free:
    """Newton from a table; WrongTopology where that leads nowhere. before: the last Newton result."""
    if len(table) and not (np.all(np.isfinite(table)) and np.all(np.diff(table.ravel()) > 0)):
        raise WrongTopology(f"the {form.what}s are too narrow to tell their ends apart", before)
    try:
        free = form.moved(control, form.intervals(control, table), newton)
    except sie.SingularSystem as failure:
        raise WrongTopology(
            f"the equation has no solution on such {form.what}s ({failure})", before
        ) from failure
    except ValueError as fault:
        if isinstance(fault, ContactError):
            raise
        reason = (
            height_rounding.told(form.problem, table)
            or f"what the scene gives the equation does not go together: {fault}"
        )
        raise SceneError(reason) from fault
    form.refuse(table, free)
    if newton.abandon_if_far and not free.converged:
        raise WrongTopology(f"the {form.what}s are not near those of the solution", free)
    return free


def _again(
    form: Formulation[Kind],
    control: Control,
    free: sie.Free,
    state: sie.AnyState,
    certificate: Certificate,
    newton: NewtonSettings,
    tried: list[tuple[float, Array]],
) -> tuple[Array, NewtonSettings]:
    """Where to begin once more, and how, after signs have failed. state: see `off`; tried:
    tolerances and intervals at which they did so before.
    """
    ended, tighter = (
        free.density.zones.table,
        replace(newton, tolerance=max(TIGHT, CLOSER * newton.tolerance)),
    )
    if control.half_width is not None:
        raise WrongTopology("pressure or gap change sign", free)
    if newton.tolerance > TIGHT and _is_error(free, state, certificate):
        return ended, tighter
    if newton.abandon_if_far:
        raise WrongTopology(certificate.note or f"there are other {form.what}s than these", free)
    table = form.corrected(free.density.zones, certificate)
    if any(same(ended, before) for at, before in tried if at == newton.tolerance):
        # To and fro between two numbers of intervals: the error of one of them, or rounding, makes
        # its signs fail.
        if newton.tolerance <= TIGHT:
            raise WrongTopology(f"the number of {form.what}s did not settle", free)
        table, newton = ended, tighter
    tried.append((newton.tolerance, ended))
    return table, newton


def off(free: sie.Free, state: sie.AnyState) -> Array:
    """How far the ends may be off (Z, 2), with a margin: signs so close to them tell nothing.
    state: on the same zones, under the load that they have, of which the certificate has asked the
    most already.
    """
    zones = free.density.zones
    return np.asarray(
        MARGIN * (free.end_error + state.end_truncation) * (zones.b - zones.a)[:, None]
    )


def _is_error(free: sie.Free, state: sie.AnyState, certificate: Certificate) -> bool:
    """Whether all that fails lies so close to ends that their error may have made it."""
    bad = np.concatenate((certificate.negative, certificate.overlaps))
    return len(bad) > 0 and bool(_end_distances(free, state, bad).all())


def _end_distances(free: sie.Free, state: sie.AnyState, bad: Array) -> Mask:
    """Which of these intervals (n, 2) lie so close to ends that their error may have made them."""
    if len(bad) == 0:
        return np.zeros(0, dtype=bool)
    ends, reach = free.density.zones.table.ravel(), off(free, state).ravel()
    beside = np.searchsorted(ends, bad.mean(axis=1))[:, None] + np.arange(-_BESIDE, _BESIDE)
    beside = np.clip(beside, 0, len(ends) - 1)
    near = (np.abs(bad[:, :1] - ends[beside]) <= reach[beside]) & (
        np.abs(bad[:, 1:] - ends[beside]) <= reach[beside]
    )
    return np.asarray(near.any(axis=1))
