"""The loop that finds the number of intervals: Newton on the ends, check of signs, correction.

The intervals are the zones, with the pressure as the unknown, or the gaps, with the slope of the
gap; a `Formulation` holds what differs between the two. The frictionless problem is convex: if
pressure and gap have the right sign on the whole line, the intervals are the solution. Otherwise
their number is wrong. Parts of an interval on which the sign is wrong are cut out. Outside the
intervals, a new interval begins where the sign is wrong. Intervals that vanish are dropped, and
those that meet are merged.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from typing import Any, Generic, Protocol, TypeVar

import numpy as np

import sie
from contact.errors import ContactError, SceneError
from contact.formulation import input_checks
from contact.formulation.controls import Control
from contact.formulation.problem import Problem
from contact.formulation.tolerances import TOLERANCES
from contact.search.options import LEAST, SEARCH
from contact.search.topology.failure import Failure, WrongTopology, same
from contact.search.topology.intervals import merged
from contact.verify.certificate import NOT_CHECKED, Certificate, Solved
from sie import Array, Mask, record

Progress = Callable[[str, int, int | None], None]
Timed = Callable[[str], AbstractContextManager[object]]
Kind = TypeVar("Kind", bound=Solved)


@dataclass(frozen=True)
class RoughRoundOptions:
    """Options of the first rounds for many zones or gaps, at a loose tolerance of their ends.
    A round is Newton's method for the ends, and a check of the signs of pressure and gap.

    The first guess of so many intervals rarely has the right number of them. Rough rounds correct
    most of the wrong intervals at a fraction of the cost. Their tolerance is `SearchOptions.rough`.
    """

    # A rough round costs little even if the number of intervals is right, as the next round begins
    # from its ends. If the number is wrong, a precise round is saved (a trace of 897 zones: 17 s in
    # place of 28 s).
    min_intervals: int = 100
    unresolved_fraction: float = 0.005  # fraction of the ends that may stay unconverged
    patience: int = 2  # Newton steps granted to the last unconverged ends


ROUGH = RoughRoundOptions()
MAX_ROUNDS = 12


class Formulation(Protocol[Kind]):
    """The unknown function and its intervals, which are contact zones or gaps.

    Either the pressure on zones (`pressure_form`), or the slope of the gap on gaps (`gap_form`).
    what: "zone" or "gap".
    """

    @property
    def problem(self) -> Problem: ...

    @property
    def what(self) -> str: ...

    def intervals(self, control: Control, table: Array) -> sie.Zones:
        """The proposed intervals `table`, with the kind of each end (such as free or fixed).

        Raises WrongTopology if they cannot be those of a contact.
        """

    def moved(self, control: Control, zones: sie.Zones, newton: NewtonSettings) -> sie.Free:
        """The intervals, with their ends found by Newton's method."""

    def refuse(self, table: Array, free: sie.Free) -> None:
        """Raise WrongTopology if Newton's method lost a gap between the zones `table`."""

    def fields(self, control: Control, free: sie.Free, tolerance: float) -> Any:
        """Pressure and gap for the intervals `free`, under the load that was found with them."""

    def certificate(self, fields: Any, control: Control, few: float = 0.0) -> Certificate:
        """The check of the signs of pressure and gap. few: fraction of the ends not converged."""

    def corrected(self, zones: sie.Zones, certificate: Certificate) -> Array:
        """New intervals (n, 2), changed where pressure or gap has the wrong sign."""

    def solved(self, round: Round) -> Kind:
        """The solution made from the last round of Newton's method and of the check of signs."""

    def is_slight(self, found: Kind) -> bool:
        """Whether the number of intervals depends on a pressure or gap as small as its error."""


@record
class NewtonSettings:
    """Settings of Newton's method for the ends of the intervals.

    tolerance: of the ends. load_guess: the load, or the mean pressure, where the control does not
    give it. max_steps: limit of Newton steps; 0 leaves it to the formulation. max_rounds: limit of
    rounds of the loop. abandon_if_far: give up as soon as the intervals turn out to be far from the
    solution. Unless `allow_loss` is set, also give up if the number of intervals is wrong.
    initial_error: error of the given ends, divided by the widths of their intervals; 1 if unknown.
    modes_like: a solution on about the same intervals, whose numbers of modes are tried first.
    unresolved_fraction: the fraction of all ends that may stay unconverged, after `patience` steps.
    allow_loss: intervals may vanish or merge. decay: the last coefficients of the series must be
    this small relative to the largest; None: chosen from the tolerance.
    """

    tolerance: float
    load_guess: float = 0.0
    max_steps: int = 0
    max_rounds: int = MAX_ROUNDS
    abandon_if_far: bool = False
    initial_error: float = 1.0
    modes_like: Any = None
    unresolved_fraction: float = 0.0
    patience: int = 0
    allow_loss: bool = False
    decay: float | None = None

    def ends(
        self, equation: sie.Equation, zones: sie.Zones, max_steps: int, **options: Any
    ) -> sie.Free:
        """The ends of intervals, by `sie.find_ends`. options: fields of `sie.NewtonOptions`."""
        return sie.find_ends(
            equation,
            zones,
            self.tolerance,
            sie.NewtonOptions(
                max_steps=self.max_steps or max_steps,
                unresolved_fraction=self.unresolved_fraction,
                patience=self.patience,
                allow_loss=self.allow_loss,
                **options,
            ),
            sie.WarmStart(
                value=self.load_guess,
                initial_error=self.initial_error,
                modes_like=self.modes_like,
                abandon_if_far=self.abandon_if_far,
            ),
        )


@record
class Observer:
    """Receiver of a search's reports: progress goes to the caller, times go to the plan."""

    progress: Progress | None = None
    timed: Timed = nullcontext


SILENT = Observer()


@record
class Round(Generic[Kind]):
    """One round: Newton's result, its pressure and gap (fields), and the check of their signs."""

    free: sie.Free
    fields: Any
    certificate: Certificate
    number: int
    control: Control
    tolerance: float


def refine_topology(
    form: Formulation[Kind],
    control: Control,
    table: Array,
    newton: NewtonSettings,
    observer: Observer = SILENT,
    formal: bool = False,
) -> Kind | Failure:
    """Zones or gaps that pass the check of signs, from proposed ones (n, 2); or a Failure.

    formal: the proposed intervals are kept, whatever the signs, as for a reference solution.
    """
    slight: Kind | None = None
    try:
        for found in _Loop(form, control, newton, observer, formal).rounds(table):
            if formal or found.tolerance <= LEAST or not form.is_slight(found):
                return found
            # A minimum of the pressure as small as its error may hide a gap. To find out, the loop
            # continues with the smallest tolerance.
            slight = slight or found
    except WrongTopology as wrong:
        if slight is None:
            return wrong.failure
    assert slight is not None
    # Even at the smallest tolerance, round-off is larger than the small pressure or gap. The result
    # is returned and marked as undecided.
    return replace(slight, certificate=replace(slight.certificate, undecided=True))


class _Loop(Generic[Kind]):
    """The rounds of one search for zones or gaps, with the data kept for the next round."""

    def __init__(
        self,
        form: Formulation[Kind],
        control: Control,
        newton: NewtonSettings,
        observer: Observer,
        formal: bool,
    ) -> None:
        self.form, self.control, self.observer, self.formal = form, control, observer, formal
        self.newton = newton
        self.wanted = newton.tolerance
        self.tried: list[tuple[float, Array]] = []  # tolerances and intervals whose signs failed
        self.removals = 0

    def rounds(self, table: Array) -> Iterator[Kind]:
        """Yield results with correct signs: at the wanted tolerance, then at the smallest one."""
        self._begin_roughly(len(table))
        free: sie.Free | None = None
        done = 0
        while done < self.newton.max_rounds:
            done += 1
            if self.observer.progress is not None:
                self.observer.progress(f"{self.form.what}s", done, None)
            # The result of the previous round may take much memory if there are many intervals. Its
            # memory is freed before the next solve.
            before = None if free is None or free.state.iterated else free
            free = None
            free = self._ends_from(table, before)
            self._keep_for_next(free)
            if len(free.lost) or len(free.met):
                table, is_free_of_charge = self._without_lost(free)
                done -= is_free_of_charge
                continue
            if not free.converged and not self.newton.allow_loss:
                reason = f"the {self.form.what} ends did not settle"
                raise WrongTopology(f"{reason}: {free.reason}" if free.unresolved else reason, free)
            here = self._checked(free, done)
            if self.formal:
                yield self.form.solved(here)
                return
            passed = self._next(here)
            if isinstance(passed, Round):
                yield self.form.solved(passed)
                table = free.density.zones.table
                self.newton = replace(self.newton, tolerance=LEAST, abandon_if_far=False)
            else:
                table = passed
            del here, passed
        raise WrongTopology(f"the number of {self.form.what}s did not settle", free)

    def _begin_roughly(self, count: int) -> None:
        """Use a loose tolerance in the first rounds if there are many intervals."""
        newton = self.newton
        known = newton.initial_error < 1.0 or newton.abandon_if_far or newton.max_steps
        if count >= ROUGH.min_intervals and not (self.formal or known):
            self.newton = replace(
                newton,
                tolerance=max(self.wanted, SEARCH.rough),
                unresolved_fraction=ROUGH.unresolved_fraction,
                patience=ROUGH.patience,
                allow_loss=True,
            )

    def _ends_from(self, table: Array, before: sie.Free | None) -> sie.Free:
        """Newton's result from a table of intervals; raises WrongTopology if there is none."""
        form, what = self.form, self.form.what
        if len(table) and not (np.all(np.isfinite(table)) and np.all(np.diff(table.ravel()) > 0)):
            raise WrongTopology(f"the {what}s are too narrow to distinguish their ends", before)
        try:
            free = form.moved(self.control, form.intervals(self.control, table), self.newton)
        except sie.SingularSystem as failure:
            raise WrongTopology(
                f"the integral equation has no solution on these {what}s ({failure})", before
            ) from failure
        except ValueError as fault:
            if isinstance(fault, ContactError):
                raise
            reason = (
                input_checks.height_rounding(form.problem, table)
                or f"the parts of the scene give an inconsistent integral equation: {fault}"
            )
            raise SceneError(reason) from fault
        form.refuse(table, free)
        may_lose = self.newton.allow_loss and (len(free.lost) or len(free.met))
        if self.newton.abandon_if_far and not (free.converged or may_lose):
            raise WrongTopology(f"the guessed {what}s are too far from those of the solution", free)
        return free

    def _keep_for_next(self, free: sie.Free) -> None:
        """Keep the load and the numbers of modes as the next round's first guess."""
        self.newton = replace(
            self.newton,
            load_guess=self.newton.load_guess if free.value is None else free.value,
            initial_error=1.0,
            modes_like=free.state.sizes if free.state.iterated else self.newton.modes_like,
        )

    def _without_lost(self, free: sie.Free) -> tuple[Array, bool]:
        """The intervals that did not vanish, and whether the solve does not count for `max_rounds`.

        Intervals that vanished are dropped, those that met are merged. Among very many intervals
        some vanish in almost every rough solve, so that such a solve does not count.
        """
        table = free.density.zones.table
        if len(free.lost):
            table = np.delete(table, free.lost, axis=0)
        else:
            table = merged(table, free.met, self.form.problem.period)
        if not self.newton.unresolved_fraction or self.removals >= 2 * MAX_ROUNDS:
            return table, False
        self.removals += 1
        patience = max(self.newton.patience - len(free.trace), 0)
        self.newton = replace(self.newton, patience=patience)
        return table, True

    def _checked(self, free: sie.Free, number: int) -> Round[Kind]:
        """The `Round` with a Newton result, its pressure and gap, and the check of their signs."""
        newton = self.newton
        fields = self.form.fields(self.control, free, newton.tolerance)
        if self.formal:
            certificate = NOT_CHECKED
        else:
            with self.observer.timed("certificate"):
                certificate = self.form.certificate(
                    fields, self.control, newton.unresolved_fraction
                )
        return Round(free, fields, certificate, number, self.control, newton.tolerance)

    def _next(self, here: Round[Kind]) -> Round[Kind] | Array:
        """The round if its signs pass the check, else the intervals of the next round."""
        if self.newton.tolerance > self.wanted:
            return self._after_rough(here)
        if not here.free.converged:
            # If pressure or gap has a wrong sign, an interval is missing at this place.
            is_missing = not here.certificate.holds
            self.newton = replace(self.newton, allow_loss=is_missing)
            zones = here.free.density.zones
            return self.form.corrected(zones, here.certificate) if is_missing else zones.table
        if here.certificate.holds:
            return here
        # After an iterative solve, the ends are known to the present tolerance. With
        # `initial_error` = 1 the next iterative solve would begin with a loose tolerance, and lose
        # intervals whose pressure is small.
        known = self.newton.tolerance if here.free.state.iterated else 1.0
        self.newton = replace(self.newton, initial_error=known)
        return self._after_failed_signs(here)

    def _after_rough(self, here: Round[Kind]) -> Array:
        """The next intervals after a round with a loose tolerance, corrected where signs are wrong.

        Wrong signs that the error of an end may explain are not corrected. The next round has the
        wanted tolerance.
        """
        free, newton = here.free, self.newton
        failures = (here.certificate.negative, here.certificate.overlaps)
        # The loose tolerance stands for the truncation error of the series, which would take a
        # solve.
        negative, overlaps = (
            bad[~_are_next_to_ends(free, newton.tolerance, bad)] for bad in failures
        )
        corrections = len(negative) + len(overlaps)
        zones = free.next_zones
        self.newton = replace(newton, tolerance=self.wanted, unresolved_fraction=0.0)
        if not corrections:
            # The precision of the linear systems in the next Newton steps follows from the last
            # move of the ends. Less precise solutions would move the ends away again.
            last = min(free.trace[-1].move, 1.0) if free.trace else 1.0
            self.newton = replace(self.newton, initial_error=last)
            return zones.table
        certificate = replace(here.certificate, negative=negative, overlaps=overlaps)
        return self.form.corrected(zones, certificate)

    def _after_failed_signs(self, here: Round[Kind]) -> Array:
        """The next intervals after a converged round with wrong signs.

        The intervals are corrected, or solved again with the smallest tolerance.
        """
        form, newton, free = self.form, self.newton, here.free
        table = free.density.zones.table
        tighter, is_tight = replace(newton, tolerance=LEAST), newton.tolerance <= LEAST
        if self.control.half_width is not None:
            raise WrongTopology("pressure or gap has the wrong sign in places", free)
        if not is_tight and _is_error(here):
            self.newton = tighter
            return table
        if newton.abandon_if_far and not newton.allow_loss:
            reason = (
                here.certificate.note or f"the contact has other {form.what}s than the guessed ones"
            )
            raise WrongTopology(reason, free)
        self.newton = replace(newton, abandon_if_far=False)
        corrected = form.corrected(free.density.zones, here.certificate)
        repeats = any(same(table, before) for at, before in self.tried if at == newton.tolerance)
        self.tried.append((newton.tolerance, table))
        if not repeats:
            return corrected
        # The same intervals were tried before, so the number of intervals alternates between two
        # values. The wrong sign that changes the number may come from errors of the ends. So the
        # same intervals are solved with the smallest tolerance.
        if is_tight:
            raise WrongTopology(f"the number of {form.what}s did not settle", free)
        self.tried[-1] = (tighter.tolerance, table)
        self.newton = tighter
        return table


def end_errors(free: sie.Free, truncation: Array | float) -> Array:
    """Bounds (n, 2) of the errors of the ends of n intervals, enlarged by a safety factor.

    Signs are not checked at places closer to an end than its bound. truncation: error of each end
    (n, 2) that truncated series cause, relative to the width of its interval.
    """
    zones = free.density.zones
    relative = free.end_error + truncation
    return np.asarray(TOLERANCES.margin * relative * (zones.b - zones.a)[:, None])


def _is_error(here: Round[Any]) -> bool:
    """Whether each wrong sign of pressure or gap may come from the error of a nearby end."""
    bad = np.concatenate((here.certificate.negative, here.certificate.overlaps))
    if len(bad) == 0:
        return False
    truncation = here.fields.state.end_truncation
    return bool(_are_next_to_ends(here.free, truncation, bad).all())


def _are_next_to_ends(free: sie.Free, truncation: Array | float, bad: Array) -> Mask:
    """Mask of the intervals `bad` (n, 2) whose wrong sign may come from the error of an end.

    truncation: see `end_errors`.
    """
    if len(bad) == 0:
        return np.zeros(0, dtype=bool)
    ends, reach = free.density.zones.table.ravel(), end_errors(free, truncation).ravel()
    # Each interval of `bad` is compared with the two nearest ends of zones or gaps on its left, and
    # with the two on its right.
    nearest = np.searchsorted(ends, bad.mean(axis=1))[:, None] + np.arange(-2, 2)
    nearest = np.clip(nearest, 0, len(ends) - 1)
    left = np.abs(bad[:, :1] - ends[nearest]) <= reach[nearest]
    right = np.abs(bad[:, 1:] - ends[nearest]) <= reach[nearest]
    return np.asarray((left & right).any(axis=1))
