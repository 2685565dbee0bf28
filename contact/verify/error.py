"""What is stated of a solution's error, and what keeps it from being smaller.

The error bounds (docs/errors.md) the ends' errors over the width of their zone, and the pressure's
at equal normalised position over the peak. Ends are off by what Newton has left to do, by what
truncated series shift them by, and by rounding; a zone's pressure follows its ends
(`sie.Density.sensitivity`), and is off itself by the series' truncation.

Of nearly full contact the gaps have passed, and the error is that of the contact between them.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

import sie
from contact.formulation.fields import ZoneFields, moved_ends
from contact.formulation.gaps import GapFields
from contact.formulation.problem import Problem
from contact.formulation.quadrature import chebyshev_nodes, sides
from contact.formulation.tables import located
from contact.formulation.units import EPS
from contact.verify.certificate import Solved
from contact.verify.tolerances import TOLERANCES
from sie import Array, record, wrapped


@record
class SolvedZones(Solved):
    """Zones that passed. off: how far the control may have been missed, in ends over the width of
    their zones; rounded: whether rounding is what keeps that from being less.
    """

    fields: ZoneFields
    rounded: bool = False

    @property
    def ends(self) -> Array:
        """How far the ends may be off, over the widths of their zones (Z, 2)."""
        return np.asarray(self.free.end_error + self.free.end_truncation + self.off)

    @cached_property
    def error(self) -> float:
        fields, state, ends = self.fields, self.fields.state, self.ends
        density, problem, units = state.density, fields.problem, fields.problem.units
        _, by_left, by_right = density.sensitivity
        singular, peak = (
            _is_singular(density),
            reference(density, problem.end, problem.borne(density)),
        )
        moved = float((ends[:, 0] * by_left + ends[:, 1] * by_right).max(initial=0.0)) / peak
        on_zones = (TOLERANCES.singular_end if singular else 1) * (
            state.density_error * state.size / peak + TOLERANCES.rounding
        ) + _of_jumps(density) / peak
        error = max(
            float(ends.max(initial=0.0)) + TOLERANCES.rounding,
            position_rounding(self) + TOLERANCES.rounding,
            moved + on_zones,
        ) + _of_body(self)
        if self.control.approach is None:
            return error
        # A stiff contact turns the rounding of its level into load.
        assert fields.stiffness is not None
        rounding = fields.gap_rounding / 16 + 2 * EPS * abs(density.total)
        return error + abs(
            rounding * fields.stiffness * units.height / (units.load * fields.load_size)
        )

    @property
    def main_cause(self) -> str:
        """What a law adds, in words, where that is most of the error; else empty."""
        return ""


def _of_body(found: SolvedZones) -> float:
    """What a body that is no half-plane adds: its smooth part, where it nearly cancels the line
    load of the half-plane, as that of a thin layer does, leaves rounding and neglected modes that
    are large beside the little that remains.
    """
    operator = found.fields.problem.operator
    if operator.is_plain or operator.is_own or found.fields.state.density.slit_count:
        return 0.0
    state = found.fields.state.whole
    left = state.field_tail if np.isfinite(state.system.equation.kernel.length) else 0.0
    return TOLERANCES.neglected_modes * left + _cancelled(
        found.fields.problem, state.density.zones.table
    )


def _cancelled(problem: Problem, table: Array) -> float:
    """Rounding of the half-plane's kernel over the compliance of a body at the longest wave of the
    widest of scaled zones (n, 2).
    """
    width = float((table[:, 1] - table[:, 0]).max()) * problem.units.length
    return TOLERANCES.compliance_rounding / float(
        problem.operator.substrate.symbol(np.array([np.pi / width]))[0]
    )


def body_limit(problem: Problem, table: Array, tolerance: float) -> str:
    """Why the body's kernel does not let scaled zones (n, 2) be found to a tolerance; empty if it
    does.
    """
    operator = problem.operator
    if (
        operator.is_plain
        or operator.is_own
        or len(table) == 0
        or not _cancelled(problem, table) > tolerance
    ):
        return ""
    part = TOLERANCES.compliance_rounding / _cancelled(problem, table)
    return (
        f"under a zone as wide as this {problem.substrate.name} gives way by {part:.1e} of what a "
        "half-plane does, and the rounding of the "
        "rest is large beside that: ask for a larger tolerance, or for narrower zones"
    )


def too_thin(problem: Problem, table: Array) -> str:
    """Why scaled zones (n, 2) are too wide for the body's kernel to be solved in seconds; empty if
    they are not.
    """
    kernel, unit = problem.kernel, problem.units.length
    width = float((table[:, 1] - table[:, 0]).max(initial=0.0))
    if not width > TOLERANCES.max_kernel_lengths * kernel.length:
        return ""
    reason = (
        f"a zone {width * unit:.3g} m wide is {width / kernel.length:.0f} times as wide as the "
        f"length {kernel.length * unit:.2g} m over which the kernel of {problem.substrate.name} "
        f"varies, and more than {TOLERANCES.max_kernel_lengths:.0f} times takes too long: ask for "
        "narrower zones"
    )
    if not problem.operator.compression:
        return reason
    return (
        f"{reason}. Away from the ends the pressure is E_star (approach - f) / (2 compression) "
        "there, as of springs"
    )


def position_rounding(found: SolvedZones) -> float:
    """What the ends, given as positions, are rounded to over their zone's width: of narrow zones
    far from x = 0 more is known. Nothing, where what is cut off the positions is told too.
    """
    if found.fields.problem.forcing.resolution.exact_places:
        return 0.0
    units, zones = found.fields.problem.units, found.fields.density.zones
    rounding = np.spacing(np.abs(units.x(zones.table))).max(axis=1) / units.length
    return float((0.5 * rounding / zones.half).max())


def _of_jumps(density: sie.AnyDensity) -> float:
    """Rounding of the logarithms at kinks, which may cancel to a pressure far below the height of
    the kinks. Beside an end they are small themselves.
    """
    steps = density.jumps
    return 2 * EPS * float((np.abs(steps.height) * steps.sine).max(initial=0.0))


def _is_singular(density: sie.AnyDensity) -> bool:
    return any(end.intensity != 0.0 for end in (*density.zones.left, *density.zones.right))


def reference(density: sie.AnyDensity, free: sie.End, borne: float | None = None) -> float:
    """What errors of the pressure are referred to: its peak, or the mean contact pressure where the
    peak is infinite; where free ends pull, the largest p sqrt(1 - t^2), which is finite, and not
    less than such an end makes of it. free: the kind of free ends; borne: by all zones, where that
    is not the density's total.
    """
    if free.intensity is not None and free.intensity < 0.0:
        angle = np.arccos(chebyshev_nodes(64))
        highest = float(
            np.abs(
                density.at(np.arange(len(density.zones))[:, None], *sides(angle)) * np.sin(angle)
            ).max()
        )
        return max(highest, abs(free.intensity) * float(np.sqrt(2 / density.zones.half).max()))
    if _is_singular(density) or np.any((density.jumps.height > 0) & (density.jumps.order == 0)):
        return abs(density.total if borne is None else borne) / float(
            (density.zones.b - density.zones.a).sum()
        )
    return float(density.sensitivity[0].max())


def limit(
    free: sie.Free,
    tol: float,
    of: str,
    positions: float = 0.0,
    end: sie.End = sie.FREE,
    error: float = 0.0,
) -> str:
    """What keeps the ends of zones (of: "zone" or "gap") from being known to `tol`, in words; empty
    where it is not rounding. positions: see `position_rounding`; end: the kind of free ends; error:
    stated of a contact by its gaps.
    """
    if positions > 0.5 * tol:
        return (
            f"positions so far from x = 0 are rounded to {positions:.1e} of a zone's width; put "
            "the origin nearer, or allow a larger tol"
        )
    density, rounding = free.density, free.rounding
    width = density.zones.b - density.zones.a
    zone = int(rounding.max(axis=1).argmax())
    worst = float(rounding[zone].max())
    if worst > 0.5 * tol:
        return (
            f"rounding of heights and slopes leaves the ends of a {of} of "
            f"{width[zone] / width.max():.1e} of the widest one's "
            f"width uncertain by {worst:.1e} of it (condition {worst / EPS:.0e})"
        )
    if of != "zone":  # the density is the slope of the gap, and no pressure to refer to
        if worst < 0.5 * float(free.end_error.max()):
            return ""
        return (
            f"rounding of heights and slopes leaves the ends of gaps uncertain by {worst:.1e} of "
            "their width, and narrow zones and the "
            f"pressure beside them follow that {error / worst:.0e} times; allow a larger tol"
        )
    _, by_left, by_right = density.sensitivity
    moved = float((rounding[:, 0] * by_left + rounding[:, 1] * by_right).max()) / reference(
        density, end
    )
    if moved > 0.25 * tol:
        return (
            f"rounding leaves ends uncertain by {worst:.1e} of a width, and beside a corner so "
            "close to an end the pressure follows "
            f"them {moved / worst:.0e} times"
        )
    return ""


@record
class SolvedGaps(Solved):
    """Gaps that passed. off: how far the mean pressure may be off where it was found from another
    control.
    """

    fields: GapFields

    @cached_property
    def error(self) -> float:
        """Estimated error of the pressure over its unit and of the zones' ends over their width."""
        return self._error(self.fields.relief.error)

    @property
    def main_cause(self) -> str:
        """Cause of the error of R, in words, where that is most of the error; else empty."""
        return self.fields.relief.relief.limit if self._error(0.0) < 0.5 * self.error else ""

    def _error(self, of_relief: float) -> float:
        """The error under such an error of R.

        An end of a gap off by delta shifts the normalised positions in the zone beside it, by delta
        over its width; the pressure there by delta times its slope, beside a tip J / pi over the
        distance; and the pressure beside the gap, which is of the size of its slope on the length
        of its width, by delta over that width.
        """
        # The total of every gap is given: there are no slits.
        fields, state, gaps = self.fields, self.fields.state.whole, self.fields.gap_slope.zones
        units, profile = fields.problem.units, fields.problem.profile
        width = (gaps.b - gaps.a)[:, None]
        moved = self.free.end_error + state.end_truncation
        # An error of R moves the ends as a change of the mean pressure does, within a small factor.
        off = self.off + TOLERANCES.relief_shift * of_relief
        if off:
            moved = moved + off * self.widening / width
        shift = np.maximum(moved * width, self._adrift[:, None])
        # The zone before the first gap is the last.
        zones = fields.zones[:, 1] - fields.zones[:, 0]
        ends = float((shift / np.column_stack((np.roll(zones, 1), zones))).max())
        varies = (profile.resolution or units.length * fields.period) / units.length / (2 * np.pi)
        unit = fields.unit_pressure / units.pressure
        if not unit > 0.0:
            return np.inf  # zones so narrow that no sample lies in them
        slope = min(fields.steepest / unit, 1 / varies)
        # Away from a gap this falls as the square of width over distance.
        seen = (
            np.minimum((gaps.b - gaps.a) / (TOLERANCES.unresolved_distance * fields.period), 1.0)
            ** 2
        )
        beside = float((moved.sum(axis=1) * state.zone_sizes * seen).max()) / unit
        # Beside a kink the logarithms that cancel are several times the pressure.
        rounding = (3 if len(fields.relief.at) else 1) * TOLERANCES.rounding * (
            1 + abs(fields.mean) / unit
        ) + of_relief / unit
        on_zones = state.density_error * state.size / unit + rounding
        tips = (
            float((np.maximum(shift[:, 1], np.roll(shift[:, 0], -1)) * self._steepest).max()) / unit
        )
        return 2 * (ends + float(shift.max()) * slope + beside + tips) + on_zones

    @property
    def _adrift(self) -> Array:
        """How far each gap may be from its place where its ends do not tell: on a smooth top of R
        of curvature k it may be anywhere where R is within rounding r of the top, by sqrt(2 r / k).
        0 for gaps wider than that, and for those over kinks.
        """
        fields, profile = self.fields, self.fields.problem.profile
        gaps, relief = fields.gap_slope.zones, fields.relief
        out = np.zeros(len(gaps))
        _, gap, inside = fields.gap_slope.locate(relief.at)
        narrow = np.flatnonzero(self.free.end_error.max(axis=1) > TOLERANCES.unresolved_gap)
        some = np.setdiff1d(narrow, gap[inside & (relief.heights < 0)])
        if len(some):
            step = (
                (profile.resolution or fields.problem.units.length * fields.period)
                / fields.problem.units.length
                / 64
            )
            middle = gaps.middle[some]
            top, beside = relief(middle), 0.5 * (relief(middle - step) + relief(middle + step))
            curvature = 2 * np.maximum(top - beside, 0.0) / step**2
            rounding = 8 * EPS * (abs(fields.mean) + np.abs(top)) + relief.error
            reach = np.sqrt(2 * rounding / np.maximum(curvature, 2 * rounding / step**2))
            out[some] = np.where(reach > 0.5 * gaps.half[some], reach, 0.0)
        return out

    @property
    def _steepest(self) -> Array:
        """Slope of the pressure in each zone beside the largest of its tips, no nearer than stated
        (J / pi over the distance).
        """
        fields = self.fields
        zones, convex = fields.zones, fields.relief.heights > 0
        at, heights = fields.relief.at[convex], fields.relief.heights[convex]
        zone = located(zones, wrapped(at, zones[0, 0], fields.period))[0]
        count, largest = np.bincount(zone, minlength=len(zones)), np.zeros(len(zones))
        np.maximum.at(largest, zone, heights)
        nearest = (
            np.minimum(TOLERANCES.tip_distance, 0.25 / np.maximum(count, 1))
            * 0.5
            * (zones[:, 1] - zones[:, 0])
        )
        return np.asarray(largest / (np.pi * nearest))

    @property
    def widening(self) -> Array:
        """How far each end of the gaps (n, 2) moves by a unit of mean pressure."""
        return np.asarray(np.abs(moved_ends(self.fields.state)).T)
