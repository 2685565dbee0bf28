"""Progress of a search for ends: whether the ends have converged, with which errors, or failed."""

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from sie.basis.data import Array, Index, Mask, record
from sie.basis.zones import Zones
from sie.ends.options import NewtonOptions
from sie.ends.steps import Branch, NewtonStep
from sie.slits.slits import OPTIONS as SLITS


@record
class Step:
    """Record of one Newton step in the search for the ends of the zones.

    zones: table of the ends before the step. move: largest move of an end, relative to the width of
    the end's zone. value: value of the open condition, if the equation has one. median_move: median
    over the zones of the larger relative move of a zone's two ends.
    """

    zones: Array
    move: float
    value: float | None
    median_move: float = 0.0


@record
class Convergence:
    """Whether the ends have converged according to the last step, and the errors of the ends.

    reached: whether they have converged; error: error of each end relative to its zone's width
    (Z, 2); rounding: the round-off in this error.
    """

    reached: bool
    error: Array
    rounding: Array


@dataclass(eq=False)
class Progress:
    """Record of the steps that one search for the ends has taken so far.

    first_width, first_gap: widths of the zones and of the gaps right of them at the start;
    initial_error: see `WarmStart`; trace: the steps; branches: residual and growth rate at each
    step, if intensities are prescribed; most: largest move of the last step, without the unresolved
    fraction of the zones; best: smallest move of all steps so far; stalled: number of steps in a
    row that have not halved `best`; closing, leaving: for each gap (`closing`) and each zone
    (`leaving`), the number of steps in a row that would have removed it without damping.
    """

    options: NewtonOptions
    tolerance: float
    first_width: Array
    first_gap: Array
    initial_error: float = 1.0
    trace: list[Step] = field(default_factory=list)
    branches: list[Branch] = field(default_factory=list)
    most: float = 1.0
    best: float = np.inf
    stalled: int = 0
    closing: Index = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    leaving: Index = field(default_factory=lambda: np.zeros(0, dtype=np.intp))

    def continue_with(self, zones: Zones, gaps: Array, kept: Index) -> None:
        """Continue the record with the zones and gaps that remain after others have vanished.
        kept: the old indices of these zones.
        """
        self.first_width = np.maximum(self.first_width[kept], zones.b - zones.a)
        self.first_gap = np.maximum(self.first_gap[kept], gaps)
        self.closing, self.leaving = self.closing[kept], self.leaving[kept]
        self.stalled, self.best = 0, np.inf

    @property
    def linear(self) -> float:
        """Tolerance of the next iterative solution of the linear system for a Newton step.

        The next step is about the square of the last one, and the step after it the fourth power.
        The error of the solution should be smaller than both, since a few more digits cost less
        than another solution.
        """
        return min(self.options.first_solution, max(self.left_to_solve, self.tightest))

    @property
    def left_to_solve(self) -> float:
        """Tolerance of the next linear solution: `forcing` times the cube of the last move of ends.
        The move is the largest one of all ends, relative to the width of the end's zone.
        """
        last = self.trace[-1].move if self.trace else 1.0
        # `most` is the largest relative move of an end. The zones whose ends move most, a fraction
        # `unresolved_fraction` of all zones, are left out, because they may vanish.
        last = self.most if self.options.unresolved_fraction else min(last, self.initial_error)
        return self.options.forcing * last**3

    @property
    def tightest(self) -> float:
        """Tolerance of the last iterative solution of the linear system in a search for ends.
        Earlier solutions have this tolerance or a larger one.
        """
        return self.options.forcing * self.tolerance

    def after(
        self,
        zones: Zones,
        motion: NewtonStep,
        corners: Array,
        value: float,
        opened: bool,
        scales: Array,
    ) -> Convergence:
        """Record a Newton step, and decide whether the ends have converged.

        corners: distance of each end from the nearest kink (2, Z); value: value of the open
        condition (whose value is an unknown); opened: whether there is one; scales: length to which
        errors of each zone's ends are relative (Z,).
        """
        width, delta, options = scales, np.abs(motion.delta), self.options
        relative = delta / width
        move = float(relative.max(initial=0.0))
        median = float(np.median(relative.max(axis=0))) if relative.size else 0.0
        self.trace.append(Step(zones.table, move, value if opened else None, median))
        fraction = options.unresolved_fraction
        if fraction:
            self.most = min(float(np.quantile(relative.max(axis=0), 1.0 - fraction)), 1.0)
        # `motion.noise` is the root mean square of the round-off in the move of each end. The
        # largest of n normally distributed errors is about sqrt(2 log n) times their root mean
        # square.
        largest_noise = np.sqrt(2 * np.log(2 + delta.size)) * motion.noise
        at_rest = delta <= np.maximum(self.tolerance * np.minimum(width, corners), largest_noise)
        if zones.have_values:
            # A rim is a zone whose density has different given values at its two ends. Its width
            # may be far below the length in `scales`, so the change of the width must also be small
            # relative to the width itself.
            wider, own = np.abs(motion.delta.sum(axis=0)), self.tolerance * 4 * zones.half
            at_rest &= ~zones.rims | (wider <= np.maximum(own, largest_noise.sum(axis=0)))
        few_move = bool(np.mean(at_rest) >= 1.0 - fraction)
        rests = bool(np.all(at_rest)) or (len(self.trace) > options.patience and few_move)
        self.stalled = self.stalled + 1 if move > 0.5 * self.best else 0
        self.best = min(self.best, move)
        growth = self._moves_by_rounding(delta, width, motion.noise)
        # If round-off keeps the ends moving, the value of the open condition (the side condition
        # whose value is an unknown) keeps changing too.
        least = max(self.tolerance, 1e-14, growth * move if growth else 0.0)
        known = abs(motion.change) <= least * abs(value + motion.change)
        rounding = (motion.noise / width).T
        certain = motion.certain or fraction > 0.0
        error = rounding + options.step_margin * max(growth, self._scatter(), 1.0) * relative.T
        return Convergence(certain and (rests or growth > 0) and known, error, rounding)

    def _moves_by_rounding(self, delta: Array, width: Array, noise: Array) -> float:
        """Ratio of the ends' largest recent move to the last one if both are round-off, else 0."""
        move, rounding_step = self.trace[-1].move, self.options.rounding_step
        quiet = delta < np.clip(100 * noise, rounding_step * width, 1e-2 * width)
        by_rounding = (self.stalled >= 2 and move < 1e-3 * rounding_step) or (
            self.stalled >= self.options.stalled_steps and bool(np.all(quiet))
        )
        if not by_rounding:
            return 0.0
        recent = self.trace[-min(self.stalled + 1, 4) :]
        return max(step.move for step in recent) / max(move, 1e-300)

    def _scatter(self) -> float:
        """Second last move of the ends over the last one, if the second last is round-off; else 0.

        Near the solution a move is at most about a constant times the square of the move before. A
        small move above this bound is due to round-off of the data. The last move may be smaller
        than this round-off by chance, but hardly by a factor of a hundred.
        """
        moves = [step.move for step in self.trace]
        if len(moves) < 4 or moves[-2] > self.options.rounding_step:
            return 0.0
        earlier = max(move / max(before, 1e-150) ** 2 for before, move in pairwise(moves[:-2]))
        if moves[-2] <= 3 * earlier * moves[-3] ** 2:
            return 0.0
        ratio = moves[-2] / max(moves[-1], 1e-300)
        return ratio if ratio < 100 else 0.0

    def is_hopeless(self, certain: bool) -> bool:
        """Whether the search will not converge on these zones, so that other zones are needed.

        certain: whether the density has the right sign next to all ends. If it has not, the search
        is hopeless once the ends have settled or stalled. If it has, the search is hopeless once
        small moves have not decreased for many steps.
        """
        options, move = self.options, self.trace[-1].move
        stays = self.stalled >= 3 * options.stalled_steps and self._stays()
        if certain:
            return stays and move < options.close_step
        settled = len(self.trace) >= options.stalled_steps and move < options.close_step
        if options.allow_loss and settled:
            return True
        stalled = self.stalled >= options.stalled_steps
        return stays or (stalled and move < options.rounding_step)

    def _stays(self) -> bool:
        """Whether the moves of the ends no longer decrease while all widths stay similar.
        A width is similar if it has changed by less than a factor of 3 over the last ten steps.
        """
        now, before = (np.diff(step.zones, axis=1) for step in (self.trace[-1], self.trace[-10]))
        if len(now) != len(before):
            return False
        same = bool(np.all((before / 3 < now) & (now < 3 * before)))
        return same and self.trace[-1].move > 0.7 * self.trace[-5].move

    def is_close(self) -> bool:
        """Whether the last step is so small that the zones are close to a solution.

        The median over the zones counts: a few new or narrow zones take many steps from any guess.
        A step below the tolerance of the first linear solution also counts: it may only correct the
        error of that solution.
        """
        before = 1.0 if len(self.trace) == 1 else self.trace[-2].median_move
        return self.trace[-1].median_move <= max(
            self.options.close_step * before, self.options.first_solution
        )

    def vanished(
        self, zones: Zones, gaps: Array, vanishes: Mask, closes: Mask
    ) -> tuple[Index, Index]:
        """(indices of the zones that have vanished, indices of the gaps that have closed).

        A gap has the index of the zone on its left. vanishes, closes: masks of the zones and gaps
        that the last undamped step would remove.
        """
        options, width = self.options, zones.b - zones.a
        self.closing = np.where(closes, (self.closing if len(self.closing) else 0) + 1, 0)
        self.leaving = np.where(vanishes, (self.leaving if len(self.leaving) else 0) + 1, 0)
        part = options.vanished_part
        if len(zones) == 1:
            # A single zone carries the whole prescribed integral of the density, however narrow the
            # zone is. So the width at which it has vanished is far smaller: the factor `part` is
            # raised to the fourth power.
            part **= 4
        least = np.where(zones.rims, 0.0, part * self.first_width)
        gone = width < np.maximum(least, 8 * np.spacing(np.abs(zones.a)))
        # A damped Newton step removes only a part of a zone. So a zone also counts as vanished if
        # several undamped Newton steps in a row would have removed it.
        insists = np.zeros(len(gone), dtype=bool)
        if len(zones) > 1 and (~zones.rims & (self.leaving >= options.insistent_steps)).any():
            # If one zone counts as vanished, so do all zones that each of the last two undamped
            # steps would have removed. Only rims (zones with two different given values at their
            # ends) never vanish.
            insists = (self.leaving >= 2) & ~zones.rims
        # A rim (a zone with two different given values at its ends) may be very narrow. So the gap
        # or plateau beside a rim is not compared with the width of the rim.
        narrowest = np.where(zones.rims, np.inf, np.minimum(width, self.first_width))
        closed = self.closing >= 2
        if not options.allow_loss:
            # Without `allow_loss`, a closed gap ends the search. So a gap that repeated steps would
            # close counts as closed only if it is narrow enough to be a slit (a narrow gap that is
            # treated as part of a wide zone).
            narrow = gaps < SLITS.max_gap * narrowest
            closed = (self.closing >= options.insistent_steps) & narrow
        closed |= gaps < options.vanished_part * np.minimum(self.first_gap, narrowest)
        return np.flatnonzero(gone | insists), np.flatnonzero(closed)

    @property
    def past_fold(self) -> str:
        """Message that the search alternated between stable and unstable ends; '' if it did not."""
        growth = np.array([branch.growth for branch in self.branches])
        if not ((growth < 0.0).any() and (growth >= 0.0).any()):
            return ""
        residual = min(branch.residual for branch in self.branches)
        return (
            "the prescribed intensities may lie past a fold, at which ends turn from stable to "
            "unstable: on both sides of the fold, an intensity still differed from the prescribed "
            f"one by at least {residual:.3g}"
        )
