"""What the steps of a search for ends tell: whether the ends have come to rest and to what they are
known, or why they will not.
"""

from dataclasses import dataclass, field

import numpy as np

from sie.basis.data import Array, Index, Mask, record
from sie.basis.zones import Zones

# A zone alone that has shrunk to this part of its first width has vanished; one of several is then
# reported as lost, or a gap as closed, at this part of its first size.
_VANISHED = 1e-12
_COLLAPSED = 1e-3
# A gap below this part of the zones beside it, which has asked so many steps on end to be closed
# altogether, has closed. So many steps on end have asked for nothing to be left of a zone that is
# lost.
_CLOSING = 0.05
_INSISTS = 3
# Steps, and moves over the widths, from which on a search that may drop zones is not in doubt about
# those that do not push outward.
_DOUBTED = 4
_SLOW = 0.1
# While it is in doubt, no solution is tighter and no series are longer than such a move asks for:
# it will be solved anew with other zones.
_DOUBT = 0.05
# Steps after which ends that still want to move by more than half of their zones may be given up.
_WANDERING = 20
# Of zones said to be near: the first move over the width, and what is left of a move in the next
# one. Moves below the last are about rounding, which need not fall.
_NEAR = 0.3
_FALLING = 0.25
_AT_REST = 1e-6
# Tolerances of solutions by iteration: at first, and at last over that of the ends.
_LOOSE = 1e-6
_TIGHT = 1e-3
# Of more zones than these the last is tighter as they are more.
_VERY_MANY = 6000
# Rounding of ends is told as a root mean square; of more zones than these the largest is so many
# times as large, and moves below the last that do not fall by half from one step to the next are
# its: Newton's own would fall to their square.
_HUNDREDS = 600
_LARGEST = 4.0
_ROUNDED = 1e-8
# The first of these where it is open which zones there are, and where a few of the ends need not
# come to rest.
_LOOSER = 1e-5
_LOOSEST = 1e-4
# What a solution leaves, over the cube of the move before; moves over the widths down to which
# loose ones tell the next, while they fall to less than this part of themselves; what the next
# solution leaves at the least, over what the last one did.
_OF_CUBE = 1e-3
_TOLD_LOOSELY = 1e-2
_FALLS = 0.5
_CLOSER = 2e-5
# The remaining motion of an end is the next step but for its square.
MARGIN = 1.5


@record
class Step:
    """One Newton step: ends before it, largest move over zone width, unknown value if any."""

    zones: Array
    move: float
    value: float | None


@record
class Turn:
    """missed: largest difference from the intensities prescribed; growth: largest real part of the
    eigenvalues that tell stable ends.
    """

    missed: float
    growth: float


@record
class Motion:
    """What a Newton step asks for. delta: outward moves (2, Z), of the ends that move; noise: their
    roundoff; change: of the open condition's value; weak: zones with an end beside which the
    density does not push outward; turn: what is seen of other roots where intensities are
    prescribed.
    """

    moves: Mask
    delta: Array
    noise: Array
    change: float
    weak: Mask
    turn: Turn | None = None

    @property
    def certain(self) -> bool:
        """Whether it can be trusted."""
        return not self.weak.any()


@record
class Rest:
    """reached: whether the ends rest as far as the step tells; error: what they are known to over
    their zones' widths (Z, 2); rounding: that part of it alone.
    """

    reached: bool
    error: Array
    rounding: Array


@dataclass(eq=False)
class Progress:
    """The steps so far of a search for ends from zones of these widths and gaps. off: what they are
    off by at first over these widths, but for some; few: part of all ends that need not come to
    rest, after so many `patient` steps; drops: see `find_ends`; most: the largest move of the last
    step but for the few, over the width; doubted: whether some zones did not push outward, and may
    be dropped; solved: tolerance of the last solution by iteration.
    """

    tolerance: float
    first_width: Array
    first_gap: Array
    off: float = 1.0
    few: float = 0.0
    patient: int = 0
    drops: bool = False
    trace: list[Step] = field(default_factory=list)
    turns: list[Turn] = field(default_factory=list)
    most: float = 1.0
    doubted: bool = False
    solved: float = 0.0
    best: float = np.inf
    stalled: int = 0
    closing: Index = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    leaving: Index = field(default_factory=lambda: np.zeros(0, dtype=np.intp))

    def goes_on(self, zones: Zones, gap: Array, kept: Index) -> None:
        """Other zones, with these gaps right of them, of which some were there before."""
        width = zones.b - zones.a
        self.first_width, self.first_gap = (
            np.maximum(self.first_width[kept], width),
            np.maximum(self.first_gap[kept], gap),
        )
        self.closing, self.leaving = self.closing[kept], self.leaving[kept]
        self.stalled, self.best = 0, np.inf

    @property
    def last(self) -> float:
        """The largest move of the last step over its zone's width; in doubt about a zone no less
        than some. At most what the ends were said to be off by: where nearly all are known so well,
        the others may be those of zones that bear no more.
        """
        return min(
            max(self.trace[-1].move, _DOUBT if self.doubted else 0.0) if self.trace else 1.0,
            self.off,
        )

    @property
    def linear(self) -> float:
        """Tolerance of a solution by iteration: the next move is about the square of the last one
        and the one after it about the fourth power, which what this solution leaves must not
        outweigh: another solution takes longer than a few digits more of this one.
        """
        cube, first = (
            (_OF_CUBE * self.most**3, _LOOSEST)
            if self.few
            else (self.left_to_solve, _LOOSER if self.drops else _LOOSE)
        )
        return min(first, max(cube, self.tightest))

    @property
    def left_to_solve(self) -> float:
        """What the next solution may leave, for all but the square of the next move; where zones
        may be dropped, of very many, solutions stay loose for as long as they tell the moves, and
        then are tighter by no more than what the next ones tell of them.
        """
        cube = _OF_CUBE * self.last**3
        if not self.drops or len(self.trace) < 2:
            return cube
        falls = self.last > _TOLD_LOOSELY and self.trace[-1].move < _FALLS * self.trace[-2].move
        return 1.0 if falls else max(cube, _CLOSER * self.solved)

    @property
    def tightest(self) -> float:
        # The more zones there are, the less the lightest bear beside the next ones, of which they
        # feel what is left.
        return (
            _TIGHT
            * self.tolerance
            / (1.0 if self.few else max(len(self.first_width) / _VERY_MANY, 1.0))
        )

    def after(
        self, zones: Zones, motion: Motion, corners: Array, value: float, opened: bool
    ) -> Rest:
        """Enters a step. corners: distance of a corner from each end (2, Z), over which the density
        changes; value: of the open condition, if one is opened.
        """
        width, delta, self.solved = zones.b - zones.a, np.abs(motion.delta), self.linear
        move = float((delta / width).max(initial=0.0))
        self.trace.append(Step(zones.table, move, value if opened else None))
        self.doubted = self.drops and not motion.certain
        if self.few:
            self.most = min(float(np.quantile((delta / width).max(axis=0), 1.0 - self.few)), 1.0)
        hundreds = len(width) > _HUNDREDS
        largest_noise = (_LARGEST if hundreds else 1.0) * motion.noise
        at_rest = delta <= np.maximum(self.tolerance * np.minimum(width, corners), largest_noise)
        rests = bool(np.all(at_rest)) or (
            len(self.trace) > self.patient and bool(np.mean(at_rest) >= 1.0 - self.few)
        )
        self.stalled = self.stalled + 1 if move > 0.5 * self.best else 0
        self.best = min(self.best, move)
        quiet = bool(np.all(delta < np.clip(100 * motion.noise, 1e-6 * width, 1e-2 * width)))
        stuck = (self.stalled >= 2 and move < 1e-9) or (self.stalled >= 5 and quiet)
        stuck = stuck or (self.stalled > 0 and hundreds and move < _ROUNDED)
        # Where rounding keeps the ends moving, the largest of the moves since the least one is what
        # they are known to.
        largest = (
            max(step.move for step in self.trace[-min(self.stalled + 1, 4) :]) / max(move, 1e-300)
            if stuck
            else 1.0
        )
        # The value cannot be at rest where rounding keeps the ends moving.
        least = max(self.tolerance, 1e-14, largest * move if stuck else 0.0)
        known = abs(motion.change) <= least * abs(value + motion.change)
        rounding = (motion.noise / width).T
        certain = motion.certain or self.few > 0.0
        return Rest(
            certain and (rests or stuck) and known,
            rounding + MARGIN * largest * (delta / width).T,
            rounding,
        )

    def is_hopeless(self, certain: bool) -> bool:
        """At rest, or about, where the density does not push outward; or far from rest for long: it
        takes other zones.
        """
        if (
            self.drops
            and not certain
            and len(self.trace) > _DOUBTED
            and self.trace[-1].move < _SLOW
        ):
            return True
        if (
            self.stalled >= 5
            and not certain
            and (self.trace[-1].move < 1e-6 or (self.stalled >= 15 and self._stays()))
        ):
            return True
        return (
            len(self.trace) > _WANDERING
            and min(step.move for step in self.trace[-10:]) > 0.5
            and self._stays()
        )

    def is_near(self) -> bool:
        """Whether the last step is one of Newton's method beside a solution."""
        largest = _NEAR if len(self.trace) == 1 else max(_FALLING * self.trace[-2].move, _AT_REST)
        return self.trace[-1].move <= largest

    def _stays(self) -> bool:
        """Whether the zones have neither grown nor shrunk in the last steps, nor their ends come to
        rest.
        """
        now, before = (np.diff(step.zones, axis=1) for step in (self.trace[-1], self.trace[-10]))
        if len(now) != len(before):
            return False
        return (
            bool(np.all((before / 3 < now) & (now < 3 * before)))
            and self.trace[-1].move > 0.7 * self.trace[-5].move
        )

    def vanished(
        self, zones: Zones, gap: Array, vanishes: Mask, closes: Mask
    ) -> tuple[Index, Index]:
        """Zones that have shrunk away, and gaps, by the zone left of them, that have closed.
        vanishes, closes: whether the last step asked for nothing to be left of them.
        """
        self.closing = np.where(closes, (self.closing if len(self.closing) else 0) + 1, 0)
        self.leaving = np.where(vanishes, (self.leaving if len(self.leaving) else 0) + 1, 0)
        # The last zone keeps what total is given, however narrow it becomes; without one it may
        # vanish.
        least = (_COLLAPSED if len(zones) > 1 else _VANISHED) * self.first_width
        gone = zones.b - zones.a < np.maximum(least, 8 * np.spacing(np.abs(zones.a)))
        # A step leaves of a zone that is too wide at least half: one that asks for nothing, again
        # and again, would be a sum of such steps.
        insists = self.leaving >= _INSISTS
        # Since the search begins anew without them, those that have asked for it more than once go
        # with them.
        insists = (
            self.leaving >= 2
            if insists.any() and len(zones) > 1
            else np.zeros(len(gone), dtype=bool)
        )
        lost = np.flatnonzero(gone | insists)
        narrowest = np.minimum(zones.b - zones.a, self.first_width)
        closed = (
            self.closing >= 2
            if self.drops
            else (self.closing >= _INSISTS) & (gap < _CLOSING * narrowest)
        )
        return lost, np.flatnonzero(
            (gap < _COLLAPSED * np.minimum(self.first_gap, narrowest)) | closed
        )

    @property
    def past_fold(self) -> str:
        """That the search has gone to and fro between stable and unstable ends, in words; empty
        where it has not.
        """
        if not (
            any(turn.growth < 0.0 for turn in self.turns)
            and any(turn.growth >= 0.0 for turn in self.turns)
        ):
            return ""
        missed = min(turn.missed for turn in self.turns)
        return (
            f"the intensities asked for may lie past a fold: nearer to them than {missed:.3g} the search did not come, on both sides of "
            f"where ends turn from stable to unstable"
        )
