"""The formulation by zones: the pressure is positive inside zones, the gap is positive outside."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import sie
from contact.errors import SceneError
from contact.formulation import input_checks
from contact.formulation.controls import Control, Load
from contact.formulation.fields import ZoneFields
from contact.formulation.problem import Problem
from contact.formulation.tables import parted_at_wide
from contact.formulation.tolerances import TOLERANCES
from contact.model.units import quantity
from contact.search.options import SEARCH
from contact.search.topology.failure import EXACT, WrongTopology
from contact.search.topology.intervals import (
    distance_to_nearest,
    half_width_of_new,
    united,
    without,
)
from contact.search.topology.loop import NewtonSettings, Round, end_errors
from contact.verify.certificate import Certificate, Solved, certify
from contact.verify.error import SolvedZones, too_thin
from sie import Array, record, wrapped


@record
class PressureForm:
    """A scaled contact problem with the pressure on its zones as the unknown function."""

    problem: Problem
    what: str = "zone"
    most_steps: int = 40

    def intervals(self, control: Control, table: Array) -> sie.Zones:
        """The zones with the kind of each end: free, fixed, or pinned at a sharp corner.
        Raises WrongTopology for impossible zones.
        """
        if len(table) == 0:
            raise WrongTopology("all zones vanished", None)
        _within_strip(self.problem, table)
        if thin := too_thin(self.problem, table):
            raise WrongTopology(thin, None, at_border=True)
        return kinds(self.problem, control, table)

    def begun(self, table: Array) -> Array:
        """The proposed zones, ordered so that the period begins in a wide gap.

        The equation makes the levels (displacement plus height) of successive zones equal, so that
        rounding errors add up towards the border of the period. Their sum would disturb a narrow
        zone at the border.
        """
        problem = self.problem
        bounded = bool(np.isfinite(problem.corners).any())
        if (
            problem.period is None
            or problem.interaction.strip
            or bounded
            or len(table) < 2
            or is_symmetric(problem, table)
        ):
            return table
        return parted_at_wide(table, problem.period)

    def moved(self, control: Control, zones: sie.Zones, newton: NewtonSettings) -> sie.Free:
        """The zones, with their ends found by Newton's method."""
        problem = self.problem
        return newton.ends(
            problem.equation(control),
            zones,
            self.most_steps,
            limits=problem.corners,
            released_end=problem.end,
            decay=newton.decay,
        )

    def formal(
        self, load: float, table: Array, tolerance: float, decay: float | None = None
    ) -> ZoneFields:
        """Pressure and gap, of any sign, under a load, with as many zones as `table` has.

        decay: see `sie.NewtonOptions`.
        """
        control = Load(load)
        zones, equation = kinds(self.problem, control, table), self.problem.equation(control)
        try:
            free = sie.find_ends(
                equation,
                zones,
                tolerance,
                sie.NewtonOptions(
                    limits=self.problem.corners,
                    released_end=self.problem.end,
                    decay=decay,
                    bounded_ends=False,
                ),
            )
        except sie.SingularSystem as failure:
            raise WrongTopology(
                f"the integral equation has no solution on these zones ({failure})", None
            ) from failure
        if not free.converged:
            raise WrongTopology("the zones could not be continued to this load", free)
        return ZoneFields(self.problem, free.state)

    def refuse(self, table: Array, free: sie.Free) -> None:
        """Raise WrongTopology if Newton's method lost a narrow gap over the kink of a valley."""
        valley = _narrow_valley(self.problem, table, free)
        if valley is not None:
            length = valley * self.problem.units.length
            raise WrongTopology(
                f"a gap of about {quantity(length, 'm', 2)} over the kink of a valley "
                "is too narrow to be found",
                free,
            )

    def fields(self, control: Control, free: sie.Free, tolerance: float) -> ZoneFields:
        """Pressure and gap (fields) under the total load that the search found with the zones."""
        problem, zones = self.problem, free.density.zones
        _within_borders(problem, zones)
        if control.load is not None:
            return ZoneFields(problem, free.state)
        total = free.density.total if free.value is None else free.value
        left, right = (
            [problem.end if end == problem.held_end else end for end in side]
            for side in (zones.left, zones.right)
        )
        ends = replace(zones, left=left, right=right)
        # The zones are unchanged, so they need the same numbers of modes. An iterative solve begins
        # from the previous solution on these zones.
        sizes = replace(free.state.sizes, value=0.0)
        state = sie.solve_zones(
            problem.equation(Load(total)), ends, max(0.1 * tolerance, 3e-16), sizes
        )
        return ZoneFields(problem, state.with_bounded_ends())

    def certificate(self, fields: ZoneFields, control: Control, few: float = 0.0) -> Certificate:
        """The check of the load, and of the signs of pressure and gap on the whole line."""
        return certify(fields, control.load, control, few)

    def corrected(self, zones: sie.Zones, certificate: Certificate) -> Array:
        """The zones without parts of negative pressure, and a new zone where the bodies overlap.

        A new zone reaches the corner or the border at which its overlap begins or ends.
        """
        if len(certificate.negative) == 0 and len(certificate.overlaps) == 0:
            if rounded := input_checks.height_rounding(self.problem, zones.table):
                raise SceneError(rounded, "profile", self.problem.profile)
            raise WrongTopology(certificate.note or "the load or the moment is not balanced", None)
        (left, right), (lo, hi) = certificate.overlaps.T, self.problem.corners
        width = right - left
        middle = 0.5 * (left + right)
        ends = zones.table.ravel()
        if self.problem.period is not None:
            ends = np.append(ends, zones.a[0] + self.problem.period)
        half = half_width_of_new(0.5 * width, distance_to_nearest(ends, middle))
        narrow = SEARCH.doubtful_part * width
        # A new zone at a corner has one pinned end, and may be much narrower than the overlap. So
        # it begins narrow, and Newton's method moves its free end away from the corner.
        new = np.where(
            (left <= lo)[:, None],
            np.column_stack((left, left + narrow)),
            np.column_stack((middle - half, middle + half)),
        )
        new = np.where((right >= hi)[:, None], np.column_stack((right - narrow, right)), new)
        table = united(
            np.concatenate((without(zones.table, certificate.negative), new)),
            self.problem.period,
            False,
            self.what,
        )
        if len(table) > 4 * len(zones) + 64:  # no correction of a contact adds so many
            raise WrongTopology("pressure or gap has the wrong sign in too many places", None)
        return table

    def solved(self, round: Round[SolvedZones]) -> SolvedZones:
        """The solution made from the last round of Newton's method and of the check of signs."""
        return SolvedZones(
            round.free,
            round.fields,
            round.certificate,
            round.number,
            round.control,
            round.tolerance,
        )

    def is_slight(self, found: Solved) -> bool:
        """Whether a pressure minimum, or the width of a gap between zones, is below its own error.

        Then the number of zones is doubtful. For a reference solution this does not matter.
        """
        if self.problem.reference:
            return False
        zones = found.free.density.zones
        reach = end_errors(found.free, found.fields.state.end_truncation)
        narrow = zones.a[1:] - zones.b[:-1] <= reach[1:, 0] + reach[:-1, 1]
        dip = TOLERANCES.margin * found.tolerance
        return found.certificate.dip <= dip or bool(np.any(narrow))


def kinds(problem: Problem, control: Control, table: Array) -> sie.Zones:
    """The zones `table` with the kind of each end: free, fixed, or pinned at a sharp corner.

    Ends are pinned at sharp corners, and fixed if the half width is given; other ends have the kind
    that the law prescribes.
    """
    count = len(table)
    end = problem.end if control.half_width is None else problem.held_end
    left, right = [end] * count, [end] * count
    lo, hi = problem.corners
    table = np.clip(table, lo, hi)
    if not np.all(table[:, 0] < table[:, 1]):
        raise WrongTopology(
            "a contact zone lies beyond the sharp corners of the body, "
            "or beyond the border of the strip",
            None,
        )
    symmetric = is_symmetric(problem, table)
    if symmetric:
        table = 0.5 * (table - table[::-1, ::-1])
    if table[0, 0] == lo:
        left[0] = sie.SINGULAR
    if table[-1, 1] == hi:
        right[-1] = sie.SINGULAR
    return sie.Zones.of(table, left, right, symmetric=symmetric)


def is_symmetric(problem: Problem, table: Array) -> bool:
    """Whether profile and zones are symmetric about the origin. Then only one half is solved."""
    if (
        not problem.profile.symmetric
        or problem.units.origin != 0.0
        or problem.centre != 0.0
        or problem.operator.own_columns
        or problem.kappa != 0.0
    ):
        return False
    if problem.cell is not None and max(-table[0, 0], table[-1, 1]) >= 0.5 * problem.cell:
        return False
    width = table[:, 1] - table[:, 0]
    # A guessed zone counts as the mirror image of another one if no end is off by more than a
    # quarter of the narrower width.
    return bool(
        np.all(np.abs(table + table[::-1, ::-1]) <= 0.25 * np.minimum(width, width[::-1])[:, None])
    )


def _within_strip(problem: Problem, table: Array) -> None:
    """Raise WrongTopology if a zone leaves the strip of a localized model."""
    if problem.interaction.strip and problem.period is not None and not problem.reference:
        if float(np.abs(table - problem.centre).max()) >= 0.5 * problem.period:
            raise WrongTopology(
                f"a contact zone reaches the border of the strip of the localized model; {EXACT}",
                None,
                at_border=True,
            )


def _within_borders(problem: Problem, zones: sie.Zones) -> None:
    """Raise WrongTopology if zones leave the known part of the profile, or fill the period."""
    lo, hi = problem.borders
    if zones.a[0] <= lo or zones.b[-1] >= hi:
        raise WrongTopology(
            "a contact zone reaches the border of the known part of the profile: give the profile "
            "over a longer interval, or reduce the contact",
            None,
            at_border=True,
        )
    if problem.period is not None and zones.b[-1] - zones.a[0] >= problem.period:
        instead = f"; {EXACT}" if problem.interaction.strip else ""
        raise WrongTopology(f"the zones fill the period{instead}", None)


def _narrow_valley(problem: Problem, table: Array, free: sie.Free) -> float | None:
    """Width of the narrow gap over a valley's kink if Newton's method lost this gap, else None.

    Such a gap narrows as exp(-pressure) but never closes. It is lost for lack of digits if it is
    much narrower than the zones beside it, and if Newton's method closed it or moved it away from
    its kink.
    """
    kinks, heights = problem.forcing.kinks
    if not np.any(heights < 0) or len(table) < 2 or len(free.density.zones) < len(table):
        return None
    at = wrapped(kinks[heights < 0], table[0, 0], problem.period)
    i = np.searchsorted(table[:, 0], at, side="right") - 1
    inner = (i >= 0) & (i < len(table) - 1)
    at, i = at[inner], i[inner]
    lo, hi = table[i, 1], table[i + 1, 0]
    width = np.diff(table)[:, 0]
    narrow = (at > lo) & (at < hi) & (hi - lo < SEARCH.rough * np.minimum(width[i], width[i + 1]))
    now = free.density.zones
    lost = narrow & (np.isin(i, free.met) | (now.b[i] >= at) | (now.a[i + 1] <= at))
    return float((hi - lo)[lost].min()) if lost.any() else None
