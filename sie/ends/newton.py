"""Zone ends found by Newton on the edge intensities.

For given zones the density is solved with singular ends allowed: near an end, K / sqrt(d) + A
sqrt(d). At the solution K is the prescribed one. Moving ends outward by delta changes K_i by -(A_i
/ 2) delta_i only, where the prescribed intensities are zero: the first-order change of a bounded
density with the ends has no singular homogeneous part. So delta = 2 K / A is a Newton step with one
linear solve. A condition on the ends alone (their total width) borders this diagonal by the
response of K to the unknown value it fixes. Where an intensity is prescribed, the density's own
change with the end is d^(-3/2)-singular and couples all ends (`motions`).
"""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from sie.basis.data import Array, Index, Mask, record
from sie.basis.zones import FREE, SINGULAR, End, Zones
from sie.dense import modes
from sie.ends.motions import STEP, DirectMotions, IteratedMotions, motions_of
from sie.ends.near_steps import bent_steps, corner_distances, gap_steps, tips_between
from sie.ends.progress import Motion, Progress, Rest, Step, Turn
from sie.equation.equation import Equation
from sie.fast.iteration import Iterative
from sie.slits.system import AnyDensity, AnyState, solve_zones
from sie.states.rounding import density_changes
from sie.states.sizes import Sizes, first_sizes, sizes_like
from sie.states.solve import SingularSystem
from sie.states.state import State

# A step moves an end by at most these parts of its zone's width and of the gap beside it.
INWARD = 0.3
OUTWARD = 0.5
INTO_GAP = 0.4
# A step goes at most this part of the distance to where the right side is no longer defined: so an
# end comes as near to that place as the root asks for, and no step leaves the domain.
INTO_LIMIT = 0.7
# An end so near to that place, over its zone's width, that would still go beyond it is held to have
# no root before it. The right side is singular there as a rule, and a nearer end would take more
# nodes than a zone may have.
_AT_LIMIT = 1e-6
# So many zones on either side are felt in a gap that is about to close.
_FELT = 15
# Over what the mean slope of the right side's smooth part makes of A.
_SMOOTH = 4.0
# A slight zone, over the wider one beside it.
_SLIGHT = 0.01
# How often it is looked which ends move as far as they may.
_BORDERINGS = 12
# While all ends together have moved by no more than this part of all widths, the response to the
# open condition's value is about as it was: what that leaves of a step is this part of it.
_SAME_RESPONSE = 0.01

# Of a solution by iteration that is wanted no better than this, sums are rough; the last one, if no
# better than that.
_ROUGHLY = 1e-7
_ROUGH_ENOUGH = 5e-7
# From this number of zones on: what series fall to at least before the last step.
_MANY = 60
_LONGEST_FALL = 1e-4
# What zones said to be near are expected to move by, over their widths: what a rougher solution
# would add does not fall as steps do.
_STEP_NEAR = 1e-4

# Samples of what random errors of all ends do to the density; its size varies little from one to
# the next.
_SAMPLES = 4
# The same, found by iteration: motions over what they are of each zone by itself.
_AMPLIFIED = 1e10
_FOUND = "the ends are at rest"
_UNSTABLE = (
    "the ends are at rest, but unstably: pushed off they go on, and another root may be near"
)
_UNRESOLVED = "a column or the kernel's regular part varies more than the modes of a zone show"
_NEUTRAL = (
    "some motion of the ends, as of all of them together, leaves the intensities as they are, or changes them by less than 1e-10 of what "
    "each end does by itself: these do not tell the ends"
)


@dataclass(frozen=True, eq=False)
class Free:
    """Result of the search for the ends.

    An end is driven outward while s (K - K*) > 0, s the sign of the density beside it (`signs`) and
    K* the intensity prescribed: adhesive contact grows while K is above K*, a crack while it is
    above in size. There may be several roots, and the search finds one near its start. A root is
    stable if ends that are pushed off it come back: all eigenvalues of s dK/d(outward motions) have
    negative real parts, for motions that meet the condition on the ends, if any, and are symmetric,
    if the zones are. Where the intensities wanted are zero, s dK/d(end) = -s A / 2, and what is
    found is stable.

    Attributes
    ----------
    state : State
        The equation solved on the last zones; `density` is its density.
    converged : bool
        Whether the ends have come to rest.
    end_error : ndarray
        Each end's remaining move over its zone's width (Z, 2), with roundoff but without
        `end_truncation`.
    rounding : ndarray
        That part of it alone (Z, 2).
    trace : tuple of Step
        The steps.
    value, value_error : float
        Value of the open condition, None without one, and how far it moved last.
    lost : ndarray
        Zones that shrank away.
    met : ndarray
        Gaps, by the zone left of them, that closed.
    stable : bool or None
        See above; None: nothing was found.
    reason : str
        Why the search stopped.
    left : ndarray
        The remaining outward moves (2, Z) where the ends have come to rest.

    Examples
    --------
    >>> import numpy as np, sie
    >>> hertz = sie.Equation(sie.cauchy(), sie.Forcing(lambda x: x), (sie.Total(np.pi / 2),))
    >>> free = sie.find_ends(hertz, sie.Zones.of([[-0.5, 2.0]]))
    >>> free.converged, free.stable, free.reason
    (True, True, 'the ends are at rest')
    """

    state: AnyState
    converged: bool
    end_error: Array
    rounding: Array
    trace: tuple[Step, ...]
    value: float | None
    value_error: float = 0.0
    lost: Index = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    met: Index = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    stable: bool | None = None
    reason: str = ""
    left: Array = field(default_factory=lambda: np.zeros((2, 0)))

    @property
    def next_zones(self) -> Zones:
        """The zones after the remaining moves too."""
        zones = self.density.zones
        return zones.moved(self.left) if self.left.shape[1] else zones

    @property
    def density(self) -> AnyDensity:
        return self.state.density

    @cached_property
    def end_truncation(self) -> Array:
        """Shift of each end by truncated coefficients, over its zone's width (Z, 2)."""
        if not self.density.zones.follow_ends:
            return self.state.end_truncation
        return np.asarray(
            (self._motions.local(self.state.whole.intensity_truncation) / self._width).T
        )

    @cached_property
    def followed(self) -> Array:
        """Error of the density on each zone (Z,) by what the ends of all zones are off, at places
        that stay.

        Where intensities are prescribed, the motion of an end changes the density of all zones;
        else it changes none.
        """
        if not self.density.zones.follow_ends:
            return np.zeros(len(self.density.zones))
        off = self._motions.of((self.end_error + self.end_truncation).T * self._width)
        signs = np.random.default_rng(0).choice([-1.0, 1.0], (len(off), _SAMPLES))
        return density_changes(self.state.whole, self._motions.responses(off[:, None] * signs))

    @cached_property
    def _motions(self) -> DirectMotions | IteratedMotions:
        return motions_of(self.state.whole)

    @property
    def _width(self) -> Array:
        return np.asarray(self.density.zones.b - self.density.zones.a)

    @property
    def unresolved(self) -> bool:
        """Whether the search was given up since a zone's modes do not show the equation: other
        zones near these fare no better.
        """
        return not self.converged and self.reason == _UNRESOLVED


def find_ends(
    equation: Equation,
    zones: Zones,
    tolerance: float = 1e-12,
    max_steps: int = 40,
    value: float = 0.0,
    limits: tuple[float, float] = (-np.inf, np.inf),
    signs: tuple[float, float] = (1.0, 1.0),
    near: bool = False,
    decay: float | None = None,
    bounded_ends: bool = True,
    off: float = 1.0,
    like: AnyState | Sizes | None = None,
    limited: End = FREE,
    few: float = 0.0,
    patient: int = 0,
    drops: bool = False,
) -> Free:
    """Move the free ends of `zones` until every one has its prescribed intensity.

    Parameters
    ----------
    equation : Equation
        Kernel, right side, side conditions.
    zones : Zones
        A first guess of the ends, with their kinds.
    tolerance : float
        Largest remaining end error over its zone's width.
    max_steps : int
        Newton steps after which the search is given up.
    value : float
        First guess for the value of an open condition.
    limits : (float, float)
        Free ends do not pass these; one that reaches one stays there as a singular end, until its
        intensity falls below that of `limited`.
    signs : (float, float)
        Of the wanted density next to left and to right ends (the slope of a gap falls at its right
        end).
    near : bool
        The zones are a guess worth no more than the few steps in which Newton's method ends beside
        a solution: as soon as a step shows that they are not so near, the search is given up,
        unconverged.
    decay : float or None
        Asked of the coefficients over the largest of them; None: a tenth of the tolerance.
    bounded_ends : bool
        Whether 1/sqrt(d) is taken out of the last density: the rest is right at equal normalised
        position to first order in what the ends are off, and the whole of it, farther from them, at
        equal places to second order.
    off : float
        What the ends are off by over their zones' widths, as far as that is known: the better they
        are, the tighter is the first solution by iteration.
    like : State, Sizes or None
        A solution on about the same zones, with as many modes to begin with; or what it has left to
        the next one, its unknowns too.
    limited : End
        The kind of an end that leaves a limit.
    few, patient : float, int
        Part of all ends that need not have come to rest after so many steps: of very many, a first
        look at what they are the ends of.
    drops : bool
        Zones that shrink away are left out, those that meet are joined, and the search goes on;
        else that is where it ends.

    Returns
    -------
    Free
        Whether the ends were found, where, and how well they are known.

    Raises
    ------
    ValueError, SingularSystem
        As `solve_fixed`.

    Examples
    --------
    >>> import numpy as np, sie
    >>> hertz = sie.Equation(sie.cauchy(), sie.Forcing(lambda x: x), (sie.Total(np.pi / 2),))
    >>> sie.find_ends(hertz, sie.Zones.of([[-0.5, 2.0]])).density.zones.table.round(12).tolist()
    [[-1.0, 1.0]]
    """
    decay = max(0.1 * tolerance, 3e-16) if decay is None else decay
    opened = equation.open_condition
    keeps = equation.forcing.cornered or equation.forcing.resolution.exact_places
    off = min(off, _STEP_NEAR) if near else off
    progress = Progress(
        tolerance,
        zones.b - zones.a,
        modes.gaps(zones, equation.kernel)[1],
        off,
        few,
        patient,
        drops,
    )
    left, unit = like if like is None or isinstance(like, Sizes) else like.sizes, None
    sizes = (
        first_sizes(equation, zones)
        if left is None
        else sizes_like(left, equation, zones, left is like)
    )
    while True:
        # Where that saves a solution of its own, the value at hand is in the right side.
        sizes.linear, sizes.value = progress.linear, value
        sizes.rough = sizes.linear > max(_ROUGHLY, min(progress.tightest, _ROUGH_ENOUGH))
        # Series of many zones are no longer than the next move asks for.
        fall = (
            max(decay, min(_LONGEST_FALL, progress.left_to_solve)) if len(zones) >= _MANY else decay
        )
        state = _state(equation, zones, fall, sizes, value)
        loose = fall > decay or (state.iterated and sizes.linear > progress.tightest)
        zones, let_go = _let_go(zones, limits, state.density, limited)
        if let_go and zones.follow_ends:
            # The rates are those of the ends that move now.
            state = _state(equation, zones, fall, sizes, value)
        if opened is not None and (unit is None or _moved(state, unit) > _SAME_RESPONSE):
            # An error of it is one of a step: as good as the square of the next is enough.
            unit = state.response(state.values(opened), np.sqrt(sizes.linear))
        motion = _newton(state, zones, signs, unit)
        progress.turns += [motion.turn] if motion.turn is not None else []
        if not np.isfinite(motion.delta).all():
            if motion.turn is None:
                raise SingularSystem("no motion of the ends meets the condition on them")
            return _neutral(state, progress, value)
        corners = _corners(state)
        motion = replace(
            motion, noise=motion.noise + np.where(motion.moves, _of_places(state, corners), 0.0)
        )
        rest = progress.after(zones, motion, corners, value, opened is not None)
        if rest.reached and not let_go and not loose:
            if motion.turn is not None and state.whole.iteration is not None:
                told = _by_iteration(state.whole, state.whole.iteration, signs, unit, motion, rest)
                if told is None:
                    return _neutral(state, progress, value)
                motion, rest = told
            return _found(state, progress, rest, motion, value, bounded_ends)
        beyond, found = (
            _beyond_domain(zones, equation, motion.delta),
            value if opened is not None else None,
        )
        hopeless = (
            progress.is_hopeless(motion.certain)
            or (equation.grows and state.unresolved)
            or (near and not progress.is_near())
        )
        if hopeless or beyond.at_limit or len(progress.trace) > max_steps:
            reason = _why_not(state, progress, motion, beyond)
            return Free(
                state,
                False,
                rest.error,
                rest.rounding,
                tuple(progress.trace),
                found,
                abs(motion.change),
                reason=reason,
            )
        value += motion.change
        closes, vanishes = _closes(zones, equation, motion.delta), _vanishes(zones, motion, drops)
        outward = _limit(zones, state.equation, motion.delta)
        zones = _held_at(zones.moved(outward, keeps), limits)
        lost, met = progress.vanished(
            zones, modes.gaps(zones, equation.kernel)[1], vanishes, closes
        )
        changes = len(lost) + len(met)
        if drops and 0 < changes < len(zones) and not zones.symmetric:
            # What is lost bore little: the search goes on from the others.
            (zones, kept), unit = zones.changed(lost, met, equation.kernel.period), None
            sizes = sizes.of(kept)
            progress.goes_on(zones, modes.gaps(zones, equation.kernel)[1], kept)
        elif changes:
            reason = "; ".join(
                filter(
                    None,
                    [
                        "a zone has shrunk away" if len(lost) else "a gap has closed",
                        progress.past_fold,
                    ],
                )
            )
            return Free(
                state,
                False,
                rest.error,
                rest.rounding,
                tuple(progress.trace),
                value,
                abs(motion.change),
                lost,
                met,
                reason=reason,
            )
        # Of many zones its sums take as much memory as those of the next one.
        del state


def _state(equation: Equation, zones: Zones, decay: float, sizes: Sizes, value: float) -> AnyState:
    """The density on these zones, at the open condition's value, if there is one."""
    state, opened = solve_zones(equation, zones, decay, sizes), equation.open_condition
    return (
        state
        if opened is None or value == 0.0 or state.iterated
        else state.with_value(opened, value)
    )


def _neutral(state: AnyState, progress: Progress, value: float) -> Free:
    """Intensities that do not tell the ends."""
    nowhere = np.full((len(state.density.zones), 2), np.inf)
    return Free(state, False, nowhere, nowhere, tuple(progress.trace), value, reason=_NEUTRAL)


def _by_iteration(
    state: State,
    iteration: Iterative,
    signs: tuple[float, float],
    unit: AnyDensity | None,
    motion: Motion,
    rest: Rest,
) -> tuple[Motion, Rest] | None:
    """A step to rest and what it tells, with what iteration tells of them; None where the
    intensities do not tell the ends.
    """
    motions, zones, side = (
        IteratedMotions(state, iteration),
        state.density.zones,
        np.array(signs, dtype=float)[:, None],
    )
    more = motions.amplification()
    if more > _AMPLIFIED or motion.turn is None:
        return None
    uncertain = (more * (motion.noise + STEP * np.abs(motion.delta)) / (zones.b - zones.a)).T
    motion = replace(motion, turn=replace(motion.turn, growth=_growth(motions, side, unit)))
    return motion, replace(rest, error=rest.error + uncertain, rounding=rest.rounding + uncertain)


def _found(
    state: AnyState,
    progress: Progress,
    rest: Rest,
    motion: Motion,
    value: float,
    bounded_ends: bool,
) -> Free:
    """The ends that have come to rest."""
    opened = state.equation.open_condition
    if opened is not None and not state.iterated:
        # The ends are at rest, and so is the value after its own last step. By iteration that would
        # be another solution.
        state, value = state.with_value(opened, motion.change), value + motion.change
    state = state.with_bounded_ends() if bounded_ends else state
    found = value if opened is not None else None
    stable = motion.turn is None or motion.turn.growth < 0.0
    reason = _FOUND if stable else _UNSTABLE
    return Free(
        state,
        True,
        rest.error,
        rest.rounding,
        tuple(progress.trace),
        found,
        abs(motion.change),
        stable=stable,
        reason=reason,
        left=_limit(state.density.zones, state.equation, motion.delta),
    )


@record
class Beyond:
    """at_limit: whether an end is as near to the border of the right side's domain as it goes, and
    would pass it; reason: in words, which ends would pass it; empty if none.
    """

    at_limit: bool
    reason: str


def _beyond_domain(zones: Zones, equation: Equation, delta: Array) -> Beyond:
    """What outward steps (2, Z) ask for beyond the domain of the right side."""
    names, near = [], False
    last = len(zones) - 1
    for side, zone, name in ((0, 0, "left end of zone 0"), (1, last, f"right end of zone {last}")):
        room = float(_room(zones, equation)[side, zone])
        if delta[side, zone] >= room:
            names.append(f"the {name} (counted from 0)")
            near |= room <= _AT_LIMIT * float(zones.b[zone] - zones.a[zone])
    if not names:
        return Beyond(False, "")
    low, high = equation.within
    where = (
        f": the root lies at or beyond it, or nearer to it than {_AT_LIMIT:g} of the zone"
        if near
        else ", and may come back"
    )
    return Beyond(
        near, f"{' and '.join(names)} would pass the limit within=({low:.6g}, {high:.6g}){where}"
    )


def _room(zones: Zones, equation: Equation) -> Array:
    """Distances (2, Z) of ends from the border of the right side's domain; infinite of all but the
    outermost ends.
    """
    room = np.full((2, len(zones)), np.inf)
    low, high = equation.within
    room[0, 0], room[1, -1] = zones.a[0] - low, high - zones.b[-1]
    return room


def _why_not(state: AnyState, progress: Progress, motion: Motion, beyond: Beyond) -> str:
    """Why the search is given up."""
    if state.equation.grows and state.unresolved:
        return _UNRESOLVED
    if beyond.at_limit:
        return beyond.reason
    told = progress.past_fold or f"the ends did not come to rest in {len(progress.trace)} steps"
    told = f"{told}; {beyond.reason}" if beyond.reason else told
    if motion.certain:
        return told
    zone = int(np.flatnonzero(motion.weak)[0])
    return (
        f"{told}; beside an end of zone {zone} (counted from 0) the density has not the sign given by `signs`: it takes other zones, other "
        "signs or more steps, or there is no such density"
    )


def _closes(zones: Zones, equation: Equation, delta: Array) -> Mask:
    """Whether the steps of both ends at the gap right of each zone would leave nothing of it."""
    gap = modes.gaps(zones, equation.kernel)[1]
    return np.asarray(delta[1] + np.roll(delta[0], -1) >= (1 - 1e-9) * gap)


def _vanishes(zones: Zones, motion: Motion, drops: bool) -> Mask:
    """Whether the steps of both ends of a zone would leave nothing of it; or, where it may be
    dropped, whether it is so much narrower than one beside it that others hardly feel it, and does
    not push outward: all would wait for it to go, and signs tell if it is there.
    """
    width = np.pad(zones.b - zones.a, 1)
    slight = drops & (width[1:-1] < _SLIGHT * np.maximum(width[:-2], width[2:]))
    return np.asarray((motion.delta.sum(axis=0) <= zones.a - zones.b) | (motion.weak & slight))


def _safe_slopes(
    density: AnyDensity, natural: Array, signs: tuple[float, float]
) -> tuple[Array, Mask]:
    """(A to divide by, where it is no guide). The bounded solution's slope at an end has the sign
    of the density; where the guess is far off, only K tells. natural: size of the coefficients
    beyond the first.
    """
    a, root = np.array(density.edge_slopes), np.sqrt(density.zones.half)
    side = np.array(signs)[:, None]
    weak = side * a <= 1e-8 * natural / root
    return np.where(weak, side * (natural / root + 1e-300), a), weak


def _corners(state: AnyState) -> Array:
    """Distance of a corner from each end (2, Z), within the zone or beyond: over it the density
    changes; infinite without one.
    """
    equation, zones = state.equation, state.density.zones
    if state.density.slit_count or len(equation.forcing.kinks[0]) == 0:
        return np.full((2, len(zones)), np.inf)
    return corner_distances(equation.forcing, zones, equation.kernel.period)


def _of_places(state: AnyState, corners: Array) -> Array:
    """What ends (2, Z) are off by since the right side is known at places rounded to a unit in
    their last digit, e: K by about sqrt(w / 2) g' e, where A is sqrt(2 w) g' if it comes from the
    smooth part of g alone. What comes from corners within a zone does not count, since the ends'
    distances from these are known.
    """
    zones = state.density.zones
    if state.equation.forcing.resolution.exact_places:
        return np.zeros((2, len(zones)))
    rounding = 2 * np.spacing(np.abs([zones.a, zones.b]))
    if state.density.slit_count or not np.isfinite(corners).any():
        return rounding
    # An end at a corner, as far as positions tell, is known by its distance from there.
    rounding = np.where(corners < 4 * rounding, 0.0, rounding)
    cornered, g = state.whole.density.jumps.kinked, state.whole.system.g
    smooth = _SMOOTH * (np.abs(g) @ np.arange(g.shape[1])) * np.sqrt(2 / zones.half) + 1e-300
    known = smooth / np.maximum(np.abs(np.array(state.density.edge_slopes)), smooth)
    rounding[:, cornered] *= known[:, cornered]
    return np.asarray(rounding)


def _held_at(zones: Zones, limits: tuple[float, float]) -> Zones:
    """Ends that went past a limit are put there and held, singular."""
    low, high = zones.a[0] <= limits[0], zones.b[-1] >= limits[1]
    if not (low or high):
        return zones
    a, b, rest = zones.a.copy(), zones.b.copy(), zones.rest.copy()
    left, right = list(zones.left), list(zones.right)
    if low:
        a[0], rest[0, 0], left[0] = limits[0], 0.0, SINGULAR
    if high:
        b[-1], rest[1, -1], right[-1] = limits[1], 0.0, SINGULAR
    return replace(zones, a=a, b=b, rest=rest, left=left, right=right)


def _let_go(
    zones: Zones, limits: tuple[float, float], density: AnyDensity, limited: End
) -> tuple[Zones, bool]:
    """Ends held at a limit where the intensity is below that of free ones (negative, the density
    pulls) become free; whether any did.
    """
    if not np.isfinite(limits).any():
        return zones, False
    k_left, k_right = density.intensities
    least = limited.intensity if limited.moves and limited.intensity is not None else 0.0
    low = zones.left[0] == SINGULAR and zones.a[0] == limits[0] and k_left[0] < least
    high = zones.right[-1] == SINGULAR and zones.b[-1] == limits[1] and k_right[-1] < least
    if not (low or high):
        return zones, False
    left, right = (
        [limited, *zones.left[1:]] if low else zones.left,
        [*zones.right[:-1], limited] if high else zones.right,
    )
    return replace(zones, left=left, right=right), True


def _newton(
    state: AnyState, zones: Zones, signs: tuple[float, float], unit: AnyDensity | None
) -> Motion:
    """The next step of ends of these kinds. unit: what a unit of the open condition's value makes,
    if there is one.
    """
    moves = zones.moves
    equation = state.equation
    density = state.density
    k = np.array(density.intensities)
    a = np.array(density.edge_slopes)
    w = density.zones.half
    side = np.array(signs)[:, None]
    natural = state.natural
    noise_k = state.intensity_noise
    residual = np.where(moves, k - zones.intensities, 0.0)
    if zones.follow_ends:
        whole = state.whole  # no slits where intensities are prescribed
        delta, noise, change, growth = _full_newton(equation, whole, residual, noise_k, unit, side)
        return Motion(
            moves,
            delta,
            noise,
            change,
            np.zeros(len(zones), dtype=bool),
            Turn(float(np.abs(residual).max()), growth),
        )
    safe, weak = _safe_slopes(density, natural, signs)
    delta = np.where(moves, 2 * residual / safe, 0.0)
    noise = np.where(moves, 2 * noise_k / np.abs(safe), 0.0)
    change = 0.0
    if unit is not None:
        k_unit = np.array(unit.intensities)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            slope = np.where(moves, 2 * k_unit / safe, 0.0)
        delta, change = _bordered(equation, density.zones, delta, slope, INWARD, OUTWARD)
        residual = np.where(moves, residual + change * k_unit, 0.0)
        a = a + change * np.array(unit.edge_slopes)
    gaps = np.array(modes.gaps(density.zones, equation.kernel))
    jumps = equation.forcing.density_jumps
    tips = tips_between(equation.forcing, density.zones, equation.kernel.period) if jumps else 0.0
    across, holds = gap_steps(
        gaps, 2 * w, moves, side * residual, side * a, signs[0] == signs[1], tips
    )
    delta, weak = np.where(holds, across, delta), weak & ~holds
    noise = np.where(holds, 2 * noise_k / np.abs(np.where(holds, a, 1.0)), noise)
    if len(equation.forcing.jumps):
        toward, slopes = side * residual, np.where(weak, 0.0, side * a)
        bent = bent_steps(
            equation.forcing,
            density.zones,
            equation.kernel.period,
            toward,
            slopes,
            delta,
            INWARD,
            OUTWARD,
        )
        bent = np.where(moves & ~(holds & jumps), bent, delta)
        # A corner that shortens the step shortens what rounding of K does.
        noise = noise * np.minimum(np.abs(bent) / np.maximum(np.abs(delta), 1e-300), 1.0)
        delta = bent
    return Motion(moves, delta, noise, change, np.asarray((weak & moves).any(axis=0)))


def _moved(state: AnyState, response: AnyDensity) -> float:
    """By what part of all widths the ends have moved from where a response was found, or those of
    wide zones; infinite where other gaps are slits.
    """
    tables = [
        (one.zones.table, other.zones.table)
        for one, other in ((state.density, response), (state.whole.density, response.whole))
    ]
    if any(len(now) != len(then) for now, then in tables):
        return np.inf
    return max(float(np.abs(now - then).sum() / np.diff(then).sum()) for now, then in tables)


def _bordered(
    equation: Equation,
    zones: Zones,
    delta: Array,
    slope: Array,
    inward: float = np.inf,
    outward: float = np.inf,
) -> tuple[Array, float]:
    """(moves, change of the unknown value) that meet the condition on the ends; slope: moves by a
    unit change; inward, outward: parts of its zone's width that an end moves by at most.

    Moves count for the condition as far as they will be made: else an end beside which the
    density's slope all but vanishes, as one of a zone about to be lost, would tell the value on its
    own.
    """
    miss, by_left, by_right = equation.end_conditions[0].residual(zones)
    gradient = np.array([by_left, by_right])
    width = zones.b - zones.a
    free = np.ones(delta.shape, dtype=bool)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        change = -(miss + np.sum(gradient * delta)) / np.sum(gradient * slope)
        for _ in range(_BORDERINGS):
            wanted = delta + change * slope
            made = np.clip(wanted, -inward * width, outward * width)
            cut, free = free, made == wanted
            by_change = np.sum((gradient * slope)[free])
            if np.array_equal(cut, free) or by_change == 0.0:
                break
            change = -(miss + np.sum(np.where(free, gradient * delta, gradient * made))) / by_change
        return delta + change * slope, float(change)


def _limit(zones: Zones, equation: Equation, delta: Array) -> Array:
    """Moves cut to what widths and gaps allow. An end that would close its gap waits until the
    others about it have come to rest within that gap: their remaining errors, squared, are what
    pushes it.
    """
    width = zones.b - zones.a
    room = np.minimum(
        INTO_GAP * np.array(modes.gaps(zones, equation.kernel)), INTO_LIMIT * _room(zones, equation)
    )
    cut = delta > room
    others = np.pad(np.abs(np.where(cut, 0.0, delta)).max(axis=0), _FELT, mode="edge")
    largest = sliding_window_view(others, 2 * _FELT + 1).max(axis=1)
    limited = np.clip(delta, -INWARD * width, np.minimum(OUTWARD * width, room))
    return np.where(cut & (largest > room), 0.0, limited)


def _full_newton(
    equation: Equation,
    state: State,
    residual: Array,
    noise_k: Array,
    unit: AnyDensity | None,
    signs: Array,
) -> tuple[Array, Array, float, float]:
    """Outward moves (2, Z), their roundoff, the change of the open condition's value and the growth
    of a push (`Free.stable`; not a number by iteration, where it is left open) by Newton with the
    full Jacobian dK_i/d(end_j), for prescribed intensities.

    The rates are those of `end_rates`; of a mirrored pair of ends, the right one stands for both.
    """
    motions = motions_of(state)
    delta, noise, change = (
        motions.spread(motions.meeting(-motions.of(residual))),
        motions.local(noise_k),
        0.0,
    )
    if unit is not None:
        slope = motions.spread(motions.meeting(-motions.of(np.array(unit.intensities))))
        delta, change = _bordered(equation, state.density.zones, delta, slope)
    return delta, noise, change, math.nan if state.iterated else _growth(motions, signs, unit)


def _growth(
    motions: DirectMotions | IteratedMotions, signs: Array, unit: AnyDensity | None
) -> float:
    """How a push of the ends grows; with a condition on the ends, which the unknown value keeps: of
    motions along it.
    """
    if unit is None:
        return motions.growth(signs[:, 0])
    _, by_left, by_right = motions.state.equation.end_conditions[0].residual(motions.zones)
    by_value = motions.of(signs * np.array(unit.intensities))
    return motions.growth(signs[:, 0], motions.of(np.array([by_left, by_right])), by_value)
