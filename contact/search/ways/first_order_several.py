"""The first-order closure of several zones: the nominal pressure is the mean load of the profile alone at the same total width.

    W(pbar, c, P) = W0(pbar L, c),    c = the middle of the outermost ends

W: total width of the zones of the strip about c under the load P; W0: of those of its profile alone, cut off at the borders of the strip,
under the load pbar L. Both are contacts under a load, so that W0 grows with it and every search is for a convex problem's only solution.
Grids tell where the root is, and that there is none (contact.search.grid.closure); from there Newton's steps, by how the ends of either
contact follow the loads, the nominal pressure and the centre (2 K / A), corrected by secants on the way (C. G. Broyden, Math. Comp. 19,
1965, 577-593, doi 10.1090/S0025-5718-1965-0198670-6); near full contact those by the gaps (first_order_gaps), after which the strip
is solved by its zones once. An approach is that of a load, found in turn.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

import sie
from contact.errors import ContactError, NotConverged, OutOfRange
from contact.formulation.controls import Load
from contact.formulation.fields import ZoneFields
from contact.formulation.problem import Problem
from contact.formulation.strip_turn import StripTurn
from contact.model.interactions.isolated import Isolated
from contact.search.grid.centring import Unrest
from contact.search.grid.closure import AtPressure, ClosureGrid
from contact.search.grid.scaling import ScaledScene
from contact.search.task import LEAST, Task
from contact.search.topology.by_pressure import ByPressure
from contact.search.topology.loop import Newton, refine_topology
from contact.search.topology.missed import Missed, WrongTopology
from contact.search.ways.first_order_contacts import At, Place, Rates, StripRates, table_of, width_of
from contact.search.ways.first_order_gaps import GapClosure, Lost, Root
from contact.search.ways.guesses import EXACT, no_rest
from contact.verify.accuracy import Found
from contact.verify.certificate import NOT_CHECKED
from sie import Array, record

# How often the signs are looked at at the root; a fall of the steps that is slow, or is rounding.
_LOOKS, _SLOW = 6, 0.5
# Steps of all ends and unknowns at once, the largest move over the width of a zone or a gap from which they start, after which rates are
# found anew, and which is as good as none; slow steps in a row after which zones are made sure of, and after which that is given up; part
# of a width or a gap that may go.
_TOGETHER, _BOLDEST, _NEARBY, _LAST_OF_ALL, _SLOW_FREELY, _SLOW_SURELY, _HALF = 20, 1.0, 1e-2, 1e-4, 1, 3, 0.4
# Largest move that is sure of its zones; change of the width by all of the nominal pressure that is its rounding.
_SURE, _UNTOLD = 0.1, 64 * float(np.finfo(float).eps)
# Part of a width or a gap that is foreseen to go in a step.
_PART = 0.1
# How often zones of the profile alone are put right, and what part of their width does not matter on the way.
_CORRECTIONS, _MINOR = 3, 1e-4
# Largest change of the load in a step; a load that is off by more is looked for by grids.
_LARGEST = 0.1
# Loads tried for an approach; how near one is, over it, for Newton's steps on the load, and for contacts under it that are found closely;
# by what part it changes at the most before.
_LOADS, _NEAR, _NEARLY_SO, _LEAST_PART = 12, 2e-2, 1e-3, 0.3
# Steps of the load from either side over the bracket, where the approach jumps in it.
_JUMPED = 3.0
# Tolerance of the grids that zones are taken from, and of how many more points: a zone or gap that is missed takes longer than these.
_CLOSELY, _FINER_GRID = 1e-5, 4
# Points of the finest grid, of a profile of few features.
_FINEST = 2**13
# Tolerance of the ends at first, and of later ones over the step of the unknowns, as long as that is not one of the last.
_ROUGHLY, _FINER, _LAST = 1e-6, 1e-2, 1e-5
# How often a contact is solved more tightly than its ends ask for, and how much more, since coefficients that are left out move the ends.
_SHARPENED, _SHARPER, _LEAST_DECAY = 2, 1e-3, 3e-16
# Contact of more than this part of the strip is solved by its gaps; their tolerance, and that of the zones there, over the one asked for.
_NEARLY_FULL, _OF_GAPS, _OF_ZONES = 0.9, 1e-3, 0.3
# Zones of both that are too many for that.
_MANY = 48
# What is left after the last step, over what it is estimated as.
_MARGIN = 2.0


@record
class Closed(Found):
    """The zones of the strip, and at: the contacts that they and the nominal pressure are of, of gaps None; told: what the ends are
    off as these tell it."""

    at: At | None = None
    told: Array | float = math.inf

    @property
    def ends(self) -> Array:
        return np.minimum(super().ends, self.told)


class FirstOrderOfSeveral:
    """The search under the scene's own control."""

    def __init__(self, task: Task, scaled: ScaledScene) -> None:
        self.task, self.scaled, self.problem = task, scaled, scaled.problem
        assert self.problem.period is not None
        self.period = self.problem.period
        self.sharpness, self.wanted, self.again, self.rounded = 1.0, task.tolerance, False, False
        # The last contacts, of the strip and of its profile alone.
        self.likes: dict[bool, sie.AnyState] = {}

    def found(self, grid: ClosureGrid, first: AtPressure) -> Found:
        """The zones that carry the control, from grids under about its load."""
        control = self.scaled.control
        if control.load is not None:
            return self._under_load(grid, first)
        assert control.approach is not None
        low, high = 0.0, math.inf
        refused: Unrest | None = None
        for _ in range(_LOADS):
            rough = self._rough(grid, first, True)
            step = math.nan
            if rough.unrest is not None:
                high, refused = grid.load, rough.unrest
            else:
                at = self._started(grid, rough)
                rates = Rates.of(at, 0.0)
                step = (control.approach + at.strip.fields.level) / float(rates.approach @ rates.following)
                if abs(step) < _NEAR * grid.load:
                    return self._exact(at)
                if control.approach > -at.strip.fields.level:
                    low = grid.load
                else:
                    high, refused = grid.load, None
            if high - low < _NEAR * high:
                break
            load = grid.load + step
            inside = max(low, _LEAST_PART * grid.load) < load < min(high, grid.load / _LEAST_PART)
            between = 0.5 * (low + high) if low > 0.0 and high < math.inf else 0.5 * grid.load if low == 0.0 else 2 * grid.load
            grid = ClosureGrid(self.scaled, self.problem, load if inside else between)
            first = grid.first()
        if refused is not None:
            raise self._refused(refused)
        raise NotConverged(f"not converged: no load was found that has the {control.told(self.problem.units)}; {EXACT}")

    def closer(self, found: Closed) -> Found:
        """The same more tightly."""
        assert found.at is not None  # else rounding alone is left
        self.wanted, self.again = self._wanted(found.at.strip), True
        return self._exact(self._at(Place(found.at.unknowns, found.at.table, table_of(found.at.alone)), self.task.tolerance, 0.0))

    def _under_load(self, grid: ClosureGrid, first: AtPressure) -> Found:
        """Nearly full contact by its gaps alone, where these serve, else by its zones."""
        by_gaps = StripTurn.serves(self.problem)
        rough = self._at_rest(grid, first, by_gaps and self._nearly_full(first))
        if not (by_gaps and self._nearly_full(rough)):
            return self._by_zones(grid, rough)
        if len(rough.strip.zones) + len(rough.alone.zones) > _MANY:
            raise self._refused(Unrest.MANY)
        try:
            return self._by_gaps(self._place(grid, rough))
        except Lost as lost:
            raise self._refused(lost.why) from lost

    def _nearly_full(self, rough: AtPressure) -> bool:
        return rough.widths[0] > _NEARLY_FULL * self.period

    def _by_zones(self, grid: ClosureGrid, rough: AtPressure) -> Found:
        """From grids, ever finer ones where these do not lead on: the profile alone may seem to fill the strip on a coarse one, or have a
        zone at its border that is not seen, and the steps of the nominal pressure have nothing to go by."""
        while True:
            try:
                return self._exact(self._started(grid, rough))
            except NotConverged:
                if grid.finest >= _FINEST:
                    raise
            grid.finest *= _FINER_GRID
            rough = self._at_rest(grid, rough, True)

    def _at_rest(self, grid: ClosureGrid, first: AtPressure, finely: bool) -> AtPressure:
        """The grids' root, with a strip that stays."""
        rough = self._rough(grid, first, finely)
        if rough.unrest is not None:
            raise self._refused(rough.unrest)
        return rough

    def _rough(self, grid: ClosureGrid, first: AtPressure, finely: bool) -> AtPressure:
        with self.task.plan.timed("coarse search"):
            return grid.root(first, finely)

    def _refused(self, why: Unrest) -> OutOfRange:
        return no_rest(self.problem, self.scaled.control, why)

    def _started(self, grid: ClosureGrid, rough: AtPressure) -> At:
        """The contacts under the nominal pressure of the grids, from zones of finer ones."""
        try:
            return self._from_grid(grid, rough, _FINER_GRID * grid.points)
        except NotConverged:
            # Beside the border a finer grid may tell zones that the exact contact does not have.
            return self._from_grid(grid, rough, grid.points)

    def _by_gaps(self, place: Place) -> Closed:
        """The strip at the root, from some zones near by."""
        tolerance, load = self.task.tolerance, float(place.unknowns[2])
        with self.task.plan.timed("zone ends"):
            root = GapClosure(self.problem, load, _OF_GAPS * tolerance).root(place)
        (centre, pressure), problem = root.place.unknowns[:2], self.problem
        problem = problem.with_amplitude(float(pressure)).about(float(centre))
        with self.task.plan.timed("zone ends"):
            newton = Newton(max(_OF_ZONES * tolerance, LEAST), off=_ROUGHLY)
            found = self._closed(root, self._contact(problem, load, root.place.strip, newton, False))
            if found.error > self.task.tol:
                newton = Newton(self._wanted(found), off=tolerance)
                found = self._closed(root, self._contact(problem, load, table_of(found), newton, False))
        return found

    def _closed(self, root: Root, found: Found) -> Closed:
        """Zones of the strip at the root, and what their ends are off, since this is not known better; told: what they are off the gaps,
        and these off the root."""
        rates, widths = StripRates(found, 0.0), np.diff(table_of(found), axis=1)
        fields = replace(found.fields, amplitude_rate=float(root.following[1]), centring=float(rates.approach[0] * root.following[0]))
        unsure, told = _MARGIN * root.unsure, np.full(widths.shape, np.inf)
        if len(widths) == len(root.place.strip):
            told = np.abs(table_of(found) - root.place.strip) / widths + root.ends
        else:
            # A zone or a gap too narrow for the one or the other to tell.
            unsure[0] += abs(width_of(found) - float(np.diff(root.place.strip).sum()))
        moved = sum(np.abs(rates.of_strip(np.append(by, 0.0))) * missed for by, missed in zip(root.inverse.T, unsure, strict=True))
        off = np.asarray(moved).T / widths
        known = {**vars(found), "fields": fields, "control": self.scaled.control, "off": off, "rounded": True}
        return Closed(**known, told=np.asarray(told + off))

    def _place(self, grid: ClosureGrid, fine: AtPressure) -> Place:
        strip, alone = (self.problem.units.scaled(each.zones) for each in (fine.strip, fine.alone))
        return Place(np.array([fine.centre, fine.amplitude, grid.load]), strip, alone)

    def _from_grid(self, grid: ClosureGrid, rough: AtPressure, points: int) -> At:
        part = self.task.plan["coarse search"]
        part.used = True
        with self.task.plan.timed("coarse search"):
            fine = grid.closer(rough, points, _CLOSELY)
        place = self._place(grid, fine)
        part.detail = f"{points} points, {len(place.strip)} zones proposed"
        return self._begun(place, 1.0)

    def _begun(self, place: Place, off: float) -> At:
        centre = float(place.unknowns[0])
        if self.problem.profile.symmetric and abs(centre) < 0.25 * float(np.diff(place.strip).min()):
            place.unknowns[0] = 0.0
        at = self._at(place, off, _ROUGHLY)
        self.wanted = self._wanted(at.strip)
        return at

    def _wanted(self, strip: Found) -> float:
        """Tolerance of the ends with which the pressure has that of the task: beside the border it is steep."""
        peak, by_left, by_right = strip.free.density.sensitivity
        return max(LEAST, self.task.tolerance / max(1.0, float(max(by_left.max(), by_right.max()) / peak.max())))

    def _at(self, place: Place, off: float, tolerance: float) -> At:
        """The contacts of the strip and of its profile alone from about their zones, whatever the signs. off: what ends are off by
        over the widths of their zones; tolerance: of the ends."""
        about, pressure, load = (float(unknown) for unknown in place.unknowns)
        newton = Newton(max(self.wanted, tolerance), off=off)
        with self.task.plan.timed("zone ends"):
            of_strip = self._contact(self.problem.with_amplitude(pressure).about(about), load, place.strip, newton, True)
        with self.task.plan.timed("isolated reference"):
            return At(place.unknowns, of_strip, self._contact(self._alone(about), pressure * self.period, place.alone, newton, True))

    def _contact(self, problem: Problem, load: float, table: Array, newton: Newton, formal: bool) -> Found:
        task = self.task
        sharpened = 0
        while True:
            # The nominal pressure goes to infinity so near to ends beside the border that coefficients fall slowly.
            like = self.likes.get(problem.reference)
            decay = max(0.1 * self.sharpness * newton.tolerance, _LEAST_DECAY)
            how = replace(newton, decay=decay, like=like)
            found = refine_topology(ByPressure(problem), Load(load), table, how, task.progress, formal, task.plan.timed)
            if isinstance(found, Missed):
                what = "its profile alone" if problem.reference else "the strip"
                reason = f"the contact of {what} was not found: {found.reason}; {EXACT}"
                raise task.error(replace(found, beyond=False, reason=reason), problem)
            self.likes[problem.reference] = found.fields.state
            cut_short = float(found.fields.state.end_truncation.max())
            if cut_short <= newton.tolerance or decay == _LEAST_DECAY or sharpened == _SHARPENED:
                return replace(found, tolerance=newton.tolerance)
            self.sharpness *= _SHARPER
            newton, table, sharpened = replace(newton, off=cut_short), table_of(found), sharpened + 1

    def _seen(self, at: At, closely: bool) -> At:
        return replace(at, strip=self._looked_at(at.strip, closely), alone=self._looked_at(at.alone, closely))

    def _looked_at(self, found: Found, closely: bool) -> Found:
        """With other zones where signs fail; closely: where so little tells their number that a tighter solution is asked for, too."""
        form = ByPressure(found.fields.problem)
        with self.task.plan.timed("certificate"):
            looked = replace(found, certificate=form.certificate(found.fields, found.control))
        if looked.certificate.holds and not (closely and form.is_slight(looked)):
            return looked
        if form.problem.reference:
            return self._put_right(looked, self.task.tolerance if closely else _MINOR)
        return self._contact(form.problem, found.control.value, table_of(found), Newton(found.tolerance), False)

    def _put_right(self, alone: Found, minor: float) -> Found:
        """The profile alone with zones where they are missing and without those that pull, but for a minor part of their total width: a
        zone about to be born may be lost again."""
        problem, newton = alone.fields.problem, Newton(alone.tolerance)
        for _ in range(_CORRECTIONS):
            if _failing(alone) <= minor * width_of(alone):
                break
            form = ByPressure(problem)
            try:
                table = form.corrected(alone.free.density.zones, alone.certificate)
                found = self._contact(problem, alone.control.value, table, newton, True)
            except (WrongTopology, ContactError):
                break
            found = replace(found, certificate=form.certificate(found.fields, found.control))
            if _failing(found) > 0.5 * _failing(alone):
                break
            alone = found
        return alone

    def _exact(self, at: At) -> Found:
        """From contacts near the root to those at it, with the zones that there are, under the load that has the approach."""
        approach, size, before, closely = self.scaled.control.approach, float(at.unknowns[2]), math.inf, False
        # Loads below and above, and by what these are off by their rates.
        low, high, asked_low, asked_high = 0.0, math.inf, 0.0, 0.0
        for _ in range(_LOADS):
            at, rates, off = self._signed(at, closely or approach is None)
            follows = rates.following
            if approach is None:
                missed = np.append(off, 0.0)
                break
            rate = float(rates.approach @ follows)
            load = (approach + at.strip.fields.level) / rate
            # The load that has the approach is off by what centre and nominal pressure are, and these by what it is.
            missed = np.append(off, 0.0) + np.abs(follows) * (_MARGIN * abs(load) + float(np.abs(rates.approach[:2]) @ off) / abs(rate))
            settled = rates.of_ends(load * follows).max() <= self.task.tolerance
            if closely and (settled or (abs(load) > _SLOW * before and before < self.task.tol * size)):
                break
            here = float(at.unknowns[2])
            if load > 0.0:
                low, asked_low = here, load
            else:
                high, asked_high = here, -load
            if min(asked_low, asked_high) > max(_JUMPED * (high - low), self.task.tol * size):
                raise self._refused(Unrest.JUMP)
            before, asked = abs(load), abs(load) / size
            closely = asked < _NEARLY_SO
            load *= min(1.0, _LARGEST / asked)
            load = load if low < here + load < high else 0.5 * (low + high) - here
            at = self._at(at.after(load * follows, rates, _PART).place, asked, min(_FINER * asked, _ROUGHLY) if asked > _LAST else 0.0)
        else:
            raise self._unsettled("the load", at)
        fields: ZoneFields = replace(
            at.strip.fields, amplitude_rate=float(follows[1]), centring=float(rates.approach[0] * follows[0])
        )
        found = replace(at.strip, fields=fields, control=self.scaled.control, off=rates.of_ends(missed))
        return Closed(**{**vars(found), "rounded": self.rounded}, at=at)

    def _signed(self, at: At, to_the_end: bool) -> tuple[At, Rates, Array]:
        """`_together`, with the signs of what it has come to: roughly until these are right, then closely, if to_the_end."""
        closely, rates = False, Rates.of(at, _ROUGHLY)
        for look in range(_LOOKS):
            # Once a zone or a gap was missing steps are sure of those that there are.
            at, rates, off = self._together(at, rates, look > 0, closely)
            looked = self._seen(at, closely)
            if looked.same_zones(at):
                if closely or not to_the_end:
                    # Zones of the profile alone that are too narrow to be put right make it wider or narrower.
                    return looked, rates, off + np.abs(np.linalg.inv(rates.matrix)[:, 0]) * _failing(looked.alone)
                closely = True
            else:
                rates = Rates.of(looked, _ROUGHLY)
            at = looked
        raise self._unsettled("the zones", at)

    def _unsettled(self, what: str, at: At) -> ContactError:
        missed = Missed(f"{what} of the first-order closure did not settle; {EXACT}", at.strip.free)
        return self.task.error(missed, at.strip.fields.problem)

    def _together(self, at: At, rates: Rates, surely: bool, closely: bool) -> tuple[At, Rates, Array]:
        """(contacts at the root under their load, from some near by; rates near it; what centre and nominal pressure are off): Newton's
        steps of all ends, the centre and the nominal pressure at once, each with one solution of the strip and one of its profile alone.
        rates: from near by; surely: with the zones that their signs ask for, in a bracket of the nominal pressure; closely: to the
        tolerance, of zones whose signs were looked at, with rates from there, else only nearly."""
        before, slow, looked, last, anew = math.inf, 0, closely, False, surely
        low: At | None = None
        high: At | None = None
        matrix, size = rates.matrix, np.array([self.period, at.unknowns[1]])
        if abs(matrix[0, 1]) * size[1] <= _UNTOLD * width_of(at.strip):
            raise OutOfRange(
                "under the first-order closure the zones reach from corner to corner, where every isolated load has their width: none is "
                f"told from others; closure='self-consistent' or {EXACT}"
            )
        for _ in range(_TOGETHER):
            step = np.append(-np.linalg.solve(matrix, at.misses), 0.0)
            off = float(rates.of_ends(step).max())
            if last:
                self.rounded = self.again and off > self.wanted
                return at, rates, _MARGIN * np.abs(step[:2]) + np.abs(np.linalg.inv(matrix)[:, 0]) * self._rounding(at)
            if surely and anew:
                low, high = (at, high) if at.misses[0] > 0.0 else (low, at)
            clipped = _within(at, float(step[1]), low, high) if surely else step[1]
            beyond, step[1] = clipped != step[1], clipped
            moved = at.after(step, rates, _HALF)
            place, largest, bold = moved.place, moved.largest, moved.bold
            if bold > _BOLDEST:
                step *= _HALF / bold
                place = at.after(step, rates, _HALF).place
            slow = slow + 1 if largest > _SLOW * before else 0
            settled = largest <= _LAST_OF_ALL and (not closely or off <= self.wanted or slow > 0)
            last = settled and closely
            if not math.isfinite(largest) or (surely and slow > _SLOW_SURELY):
                break
            surely = surely or slow > _SLOW_FREELY
            try:
                # A zone or a gap that is asked to go may be lost: both contacts are found anew, and looked at.
                anew = beyond or largest > (_SURE if surely else _BOLDEST)
                there = self._at(place, min(largest, _HALF), 0.0 if last else _ROUGHLY) if last or anew else self._once(place, moved.off)
                if (surely or bold <= _NEARBY) and (anew or not looked):
                    there, looked = self._seen(there, closely), True
            except (NotConverged, WrongTopology, sie.SingularSystem):
                break
            if last or anew or not there.same_zones(at):
                rates = Rates.of(there, 0.0 if last else _ROUGHLY)
                matrix = rates.matrix
            elif step.any():
                matrix = matrix + _secant(matrix, step[:2], there.misses - at.misses, size)
            at, before = there, largest
            if settled and not closely:
                return at, rates, np.zeros(2)
        raise self._refused(Unrest.LOST) if surely else self._unsettled("the nominal pressure", at)

    def _once(self, place: Place, off: float) -> At:
        """The contacts on zones as they are. off: what ends are off by over the widths of their zones."""
        about, pressure, load = (float(unknown) for unknown in place.unknowns)

        def solved(problem: Problem, load: float, table: Array) -> Found:
            control, form = Load(load), ByPressure(problem)
            tolerance = min(max(_FINER * off * off, self.wanted), _ROUGHLY)
            free = sie.find_ends(
                problem.equation(control), form.intervals(control, table), tolerance, 0, limits=problem.corners, off=off,
                like=self.likes.get(problem.reference), limited=problem.end, bounded_ends=False,
            )
            self.likes[problem.reference] = free.state
            return Found(free, ZoneFields(problem, free.state), NOT_CHECKED, 1, control, tolerance)

        with self.task.plan.timed("zone ends"):
            strip = solved(self.problem.with_amplitude(pressure).about(about), load, place.strip)
            return At(place.unknowns, strip, solved(self._alone(about), pressure * self.period, place.alone))

    def _alone(self, centre: float) -> Problem:
        return replace(self.problem, interaction=Isolated(), amplitude=None, reference=True, centre=centre)

    def _rounding(self, at: At) -> float:
        """What the difference of the widths may be off."""
        missed = 0.0
        for found in (at.strip, at.alone):
            missed += float(((found.free.end_error + found.fields.state.end_truncation) * np.diff(table_of(found), axis=1)).sum())
        return missed


def _secant(matrix: Array, step: Array, change: Array, size: Array) -> Array:
    """What a matrix lacks of the change of the misses in a step, by Broyden's rule. size: of the unknowns."""
    return np.asarray(np.outer(change - matrix @ step, step / size**2) / float(((step / size) ** 2).sum()))


def _within(at: At, step: float, low: At | None, high: At | None) -> float:
    """A step of the nominal pressure that stays between those of two contacts of other zones, or goes to their middle."""
    here, least, most = (0.0 if one is None else float(one.unknowns[1]) for one in (at, low, high))
    falls = here + step <= least and (low is None or not low.same_zones(at))
    rises = high is not None and here + step >= most and not high.same_zones(at)
    return 0.5 * (least + (here if high is None else most)) - here if falls or rises else step


def _failing(found: Found) -> float:
    """Width of all places where signs fail: zones put right there would be wider or narrower by about that."""
    return float(sum((places[:, 1] - places[:, 0]).sum() for places in (found.certificate.negative, found.certificate.overlaps)))
