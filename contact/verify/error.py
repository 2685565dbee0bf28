"""The stated error of a solution, and a description of what limits it.

The stated error bounds two relative errors (docs/errors.md): the error of the ends, divided by the
width of their zone, and the error of the pressure at equal normalised positions, divided by the
peak. Errors of ends come from the residual of Newton's method, from truncation of the series and
from rounding. The pressure has an error because the ends of its zone have errors
(`sie.Density.sensitivity`), and an error from truncation.

If the unknown is the slope of the gaps, the stated error still bounds the errors of the zones and
the pressure.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

import sie
from contact.formulation.fields import ZoneFields, has_tips, moved_ends
from contact.formulation.gaps import GapFields
from contact.formulation.problem import Problem
from contact.formulation.quadrature import chebyshev_nodes, sides
from contact.formulation.tables import located
from contact.formulation.tolerances import TOLERANCES
from contact.model.profiles.noise import EPS
from contact.model.units import quantity
from contact.verify.certificate import Solved
from sie import Array, record, wrapped


@record
class SolvedZones(Solved):
    """Contact zones that passed the certificate, with their stated error.

    control_error: errors of the ends, divided by the width of their zones, that the error of the
    control may cause. rounded: whether round-off prevents smaller errors of the ends.
    """

    fields: ZoneFields
    rounded: bool = False

    @property
    def ends(self) -> Array:
        """Errors of the ends (Z, 2), divided by the width of the zone of each end."""
        return np.asarray(self.free.end_error + self.free.end_truncation + self.control_error)

    @cached_property
    def error(self) -> float:
        fields, state, ends = self.fields, self.fields.state, self.ends
        density, problem, units = state.density, fields.problem, fields.problem.units
        _, by_left, by_right = density.sensitivity
        singular, peak = (
            _is_singular(density),
            reference(density, problem.end, problem.borne(density), has_tips(density, problem)),
        )
        follows = ~self.free.narrow_rims
        changes = (ends[:, 0] * by_left + ends[:, 1] * by_right)[follows]
        # The errors of a zone's ends are relative to a length `end_scales`. It is the width of the
        # zone. For a rim (a zone with different pressures at its two ends), it is the width of the
        # gap or plateau beside the rim. The factor makes the errors relative to the zone's width.
        changes = changes * (self.free.end_scales / (2 * density.zones.half))[follows]
        moved = float(changes.max(initial=0.0)) / peak
        on_zones = (TOLERANCES.singular_end if singular else 1) * (
            self._density_error / peak + TOLERANCES.rounding
        ) + _kink_rounding(density) / peak
        of_rims = _bent_rims(self)
        error = max(
            float((ends + of_rims[0]).max(initial=0.0)) + TOLERANCES.rounding,
            position_rounding(self) + TOLERANCES.rounding,
            moved + on_zones,
            float(of_rims[1].max()) / peak,
        ) + _error_of_body(self)
        if self.control.approach is None:
            return error
        # Under a given approach, the rounding error of displacement plus height adds an error of
        # the load. This error of the load is large in a stiff contact.
        assert fields.stiffness is not None
        rounding = fields.gap_rounding / TOLERANCES.rounding_margin + 2 * EPS * abs(density.total)
        return error + abs(
            rounding * fields.stiffness * units.height / (units.load * fields.load_size)
        )

    @property
    def _density_error(self) -> float:
        """Error of the pressure at fixed normalised positions in the zones.

        Narrow rims are left out; a rim is a zone with different pressures at its two ends. On a
        narrow rim, the pressure at equal normalised positions does not depend on the place and the
        width of the rim. A uniform error of the pressure only moves the rim.
        """
        state, narrow = self.fields.state, self.free.narrow_rims
        if not narrow.any():
            return float(state.density_error * state.size)
        return float((state.whole.zone_errors * state.whole.zone_sizes)[~narrow].max(initial=0.0))

    def error_with(self, slopes: float) -> float:
        """The stated error if the profile's slopes have the relative error `slopes`.

        If all slopes are multiplied by a factor, the ends move as if the load were divided by it.
        """
        if not slopes > 0.0:
            return self.error
        density = self.fields.density
        width = (density.zones.b - density.zones.a)[:, None]
        moved = np.abs(moved_ends(self.fields.state)).T * abs(density.total) / width
        return replace(self, control_error=self.control_error + slopes * moved).error + slopes

    @property
    def main_cause(self) -> str:
        """Message about what causes most of the error; empty unless a subclass overrides it."""
        return ""


def _bent_rims(found: SolvedZones) -> tuple[Array, Array]:
    """Errors of places (Z, 1) and of the pressure (Z,) that the widths of narrow rims cause.
    A rim is a zone with different pressures at its two ends.

    On a narrow rim the pressure is a linear function of the angle arccos(t), plus a deviation that
    is proportional to the width; t is the normalised position. The true width may be less than the
    width of the zone (`Zones.depth`), or have an error. The integral of the deviation moves the rim
    by a fraction of its width.
    """
    density, scales = found.fields.state.density, found.free.end_scales
    zones, none = density.zones, np.zeros(len(density.zones))
    narrow = np.flatnonzero(found.free.narrow_rims)
    if len(narrow) == 0:
        return none[:, None], none
    value, width = np.abs(zones.values[:, narrow]).max(axis=0), 2 * zones.half[narrow]
    bent, too_wide = found.free.bent_rims[narrow], -np.expm1(zones.depth[narrow])
    of_width = found.ends[narrow].sum(axis=1) * scales[narrow] / width
    # An error of the rim's place, as a multiple of the rim's width, changes the right side of the
    # equation by the same multiple of its variation over the rim.
    of_width = found.tolerance + of_width * bent / value
    part = np.minimum(of_width + bent / value * too_wide, 1.0)
    pressures, places = none.copy(), none.copy()
    pressures[narrow] = TOLERANCES.margin * bent * part * np.exp(zones.depth[narrow])
    places[narrow] = too_wide * bent / value * width / scales[narrow]
    return places[:, None], pressures


def _error_of_body(found: SolvedZones) -> float:
    """Relative error due to the smooth part of the body's kernel; 0 for a half-plane.

    The smooth part of a thin layer's kernel nearly cancels the half-plane's kernel. Their sum is so
    small that rounding and the neglected terms of series are large relative to the sum.
    """
    operator = found.fields.problem.operator
    if operator.is_plain or operator.is_own or found.fields.state.density.slit_count:
        return 0.0
    state = found.fields.state.whole
    left = state.field_tail if np.isfinite(state.system.equation.kernel.length) else 0.0
    return TOLERANCES.margin * left + _kernel_rounding(
        found.fields.problem, state.density.zones.table
    )


def _kernel_rounding(problem: Problem, table: Array) -> float:
    """Rounding error of the half-plane's kernel, divided by the symbol of the body.

    The symbol is the body's compliance relative to a half-plane. It is taken at a wavelength of
    twice the width of the widest zone in the scaled `table` (n, 2).
    """
    width = float((table[:, 1] - table[:, 0]).max()) * problem.units.length
    return TOLERANCES.kernel_rounding / float(
        problem.operator.substrate.symbol(np.array([np.pi / width]))[0]
    )


def body_limit(problem: Problem, table: Array, tolerance: float) -> str:
    """Message that rounding of the body's kernel prevents the tolerance; empty if it does not.
    `table` holds the scaled zones (n, 2).
    """
    operator = problem.operator
    if (
        operator.is_plain
        or operator.is_own
        or len(table) == 0
        or not _kernel_rounding(problem, table) > tolerance
    ):
        return ""
    part = TOLERANCES.kernel_rounding / _kernel_rounding(problem, table)
    return (
        f"under zones of this width the compliance of the {problem.substrate.name} substrate is "
        f"only {part:.1e} of that of a half-plane, and the rounding of the kernel is large "
        "compared with it: use a larger tol, or a control that gives narrower zones"
    )


def too_thin(problem: Problem, table: Array) -> str:
    """Message that the scaled zones `table` (n, 2) would take too long to solve; empty if not."""
    kernel, unit = problem.kernel, problem.units.length
    width = float((table[:, 1] - table[:, 0]).max(initial=0.0))
    if not width > TOLERANCES.max_kernel_lengths * kernel.length:
        return ""
    wide = quantity(width * unit, "m", 3)
    length = quantity(kernel.length * unit, "m", 2)
    reason = (
        f"a zone {wide} wide is {width / kernel.length:.0f} times as wide as the length {length} "
        f"over which the kernel of the {'interaction' if problem.operator.is_own else 'substrate'} "
        "varies, and more than "
        f"{TOLERANCES.max_kernel_lengths:.0f} times takes too long: use a control that gives "
        "narrower zones"
    )
    if not problem.operator.compression:
        return reason
    return (
        f"{reason}. Far from its ends, such a zone has the pressure E_star (approach - f) / "
        "(2 compression), as on independent springs"
    )


def position_rounding(found: SolvedZones) -> float:
    """Largest rounding error of an end in the coordinate x [m], divided by the width of its zone.

    Far from x = 0, the scaled ends of narrow zones are more precise than x. The result is 0 if the
    digits that rounding cuts off are known (`Solution.zone_remainders`).
    """
    if found.fields.problem.forcing.resolution.exact_places:
        return 0.0
    units, zones = found.fields.problem.units, found.fields.density.zones
    rounding = np.spacing(np.abs(units.x(zones.table))).max(axis=1) / units.length
    return float((rounding / found.free.end_scales).max())


def _kink_rounding(density: sie.AnyDensity) -> float:
    """Rounding error of the pressure, from its logarithms at kinks of the profile.

    The logarithms may nearly cancel each other, and leave a pressure far smaller than each of them.
    The logarithm of a kink next to an end is small.
    """
    steps = density.jumps
    return 2 * EPS * float((np.abs(steps.height) * steps.sine).max(initial=0.0))


def _is_singular(density: sie.AnyDensity) -> bool:
    return any(end.intensity != 0.0 for end in (*density.zones.left, *density.zones.right))


def reference(
    density: sie.AnyDensity, free: sie.End, borne: float | None = None, tips: bool | None = None
) -> float:
    """The pressure by which errors of pressure are divided: the peak, or the mean contact pressure.

    The mean is taken if the peak is infinite. If free ends have a singular tension, the largest
    absolute value of p sqrt(1 - t^2) is taken, with the pressure p at the normalised position t;
    this includes its limits at the ends. free: kind of the free ends. borne: load of all zones, if
    it is not the density's total. tips: whether convex kinks lie in the zones, if that is known.
    """
    if tips is None:
        tips = bool(np.any((density.jumps.height > 0) & (density.jumps.order == 0)))
    if free.intensity is not None and free.intensity < 0.0:
        angle = np.arccos(chebyshev_nodes(64))
        highest = float(
            np.abs(
                density.at(np.arange(len(density.zones))[:, None], *sides(angle)) * np.sin(angle)
            ).max()
        )
        return max(highest, abs(free.intensity) * float(np.sqrt(2 / density.zones.half).max()))
    if _is_singular(density) or tips:
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
    """Message that rounding prevents ends with the tolerance `tol`; empty if it does not.

    of: "zone" or "gap". positions: see `position_rounding`. end: kind of the free ends. error:
    stated error of a contact whose unknowns are the gaps.
    """
    if positions > 0.5 * tol:
        return (
            f"positions so far from x = 0 have a rounding error of {positions:.1e} of a zone's "
            "width; put x = 0 nearer to the zones, or use a larger tol"
        )
    density, rounding = free.density, free.rounding
    width = density.zones.b - density.zones.a
    zone = int(rounding.max(axis=1).argmax())
    worst = float(rounding[zone].max())
    if worst > 0.5 * tol:
        return (
            f"rounding of heights and slopes makes the ends of a {of} uncertain by {worst:.1e} of "
            f"its width (condition {worst / EPS:.0e}); this {of} has "
            f"{width[zone] / width.max():.1e} of the width of the widest {of}"
        )
    if of != "zone":  # the density is no pressure, but the slope of the gap
        if worst < 0.5 * float(free.end_error.max()):
            return ""
        return (
            f"rounding of heights and slopes makes the ends of gaps uncertain by {worst:.1e} of "
            "their width, and the errors of narrow zones and of the pressure beside them are "
            f"{error / worst:.0e} times this value; use a larger tol"
        )
    _, by_left, by_right = density.sensitivity
    moved = float((rounding[:, 0] * by_left + rounding[:, 1] * by_right).max()) / reference(
        density, end
    )
    if moved > 0.25 * tol:
        return (
            f"rounding makes ends uncertain by {worst:.1e} of the width of a zone, and the error "
            f"of the pressure beside a corner so close to an end is {moved / worst:.0e} times this "
            "value"
        )
    return ""


@record
class SolvedGaps(Solved):
    """Gaps between contact zones that passed the certificate, with their stated error.

    control_error: possible error of the mean pressure, if it was found from another control.
    """

    fields: GapFields

    @cached_property
    def error(self) -> float:
        """Bound of the relative errors of the pressure and of the ends of the zones."""
        return self._error(self.fields.relief.error)

    def error_with(self, slopes: float) -> float:
        """The stated error if the profile's slopes have the relative error `slopes`.

        The relief R (contact.formulation.gaps) is proportional to the slopes. Near full contact,
        the scaled mean pressure is nearly the largest R.
        """
        if not slopes > 0.0:
            return self.error
        return self._error(self.fields.relief.error + slopes * abs(self.fields.mean))

    @property
    def main_cause(self) -> str:
        """Message about the error of the relief R; empty unless it causes most of the stated error.

        The relief is R = G f', see contact.formulation.gaps.
        """
        return self.fields.relief.relief.limit if self._error(0.0) < 0.5 * self.error else ""

    def _error(self, of_relief: float) -> float:
        """The stated error of the solution, for a given error of the relief R.

        An error delta of an end of a gap has three effects. (i) Normalised positions in the zone
        next to the gap shift by delta divided by the zone's width. (ii) The pressure in the zone
        changes by delta times the slope of the pressure. Next to a tip (a convex kink of the
        profile with a jump J of the slope) the slope of the pressure is J / pi divided by the
        distance from the tip. (iii) Close to the gap, where the pressure varies over the width of
        the gap, its relative change is delta divided by this width.
        """
        # The unknown of this equation lies on the gaps of the contact. So the zones of `sie` are
        # these gaps, and the spaces between the zones are in contact. `sie` can treat a narrow
        # space as a slit in a wide zone, with an unknown function in the slit (sie.slits). There
        # are no slits here, because the total over every zone is given (sie.ZoneTotals). So `state`
        # is the solution on the gaps themselves.
        fields, state, gaps = self.fields, self.fields.state.whole, self.fields.gap_slope.zones
        units, profile = fields.problem.units, fields.problem.profile
        width = (gaps.b - gaps.a)[:, None]
        moved = self.free.end_error + state.end_truncation
        # A uniform error of the relief R moves the ends like a change of the mean pressure. The
        # factor 2 is for an error that is not uniform.
        mean_error = self.control_error + 2 * of_relief
        if mean_error:
            moved = moved + mean_error * self.widening / width
        shift = np.maximum(moved * width, self._place_error[:, None])
        # The contact is periodic, so the zone to the left of the first gap is the last zone.
        zones = fields.zones[:, 1] - fields.zones[:, 0]
        ends = float((shift / np.column_stack((np.roll(zones, 1), zones))).max())
        varies = (profile.resolution or units.length * fields.period) / units.length / (2 * np.pi)
        unit = fields.unit_pressure / units.pressure
        if not unit > 0.0:
            return np.inf  # the zones are so narrow that the pressure was not sampled in them
        slope = min(fields.steepest / unit, 1 / varies)
        # If the ends of a gap move, the change of the pressure falls with the distance from the
        # gap, as (width of the gap / distance)^2.
        seen = (
            np.minimum((gaps.b - gaps.a) / (TOLERANCES.unresolved_distance * fields.period), 1.0)
            ** 2
        )
        near_gaps = float((moved.sum(axis=1) * state.zone_sizes * seen).max()) / unit
        # With kinks (`relief.at`), the pressure is a sum of logarithms that partly cancel. They are
        # several times larger than the pressure, so the bound of the rounding is tripled.
        rounding = (3 if len(fields.relief.at) else 1) * TOLERANCES.rounding * (
            1 + abs(fields.mean) / unit
        ) + of_relief / unit
        on_zones = state.density_error * state.size / unit + rounding
        tips = (
            float((np.maximum(shift[:, 1], np.roll(shift[:, 0], -1)) * self._steepest).max()) / unit
        )
        return 2 * (ends + float(shift.max()) * slope + near_gaps + tips) + on_zones

    @property
    def _place_error(self) -> Array:
        """Largest possible error of the scaled position of each narrow gap.

        A narrow gap lies at a smooth maximum of the relief R. With the curvature k of R and the
        rounding r of R, the gap may lie anywhere within sqrt(2 r / k) of this maximum. The error is
        0 for wider gaps and for gaps over kinks.
        """
        fields, profile = self.fields, self.fields.problem.profile
        gaps, relief = fields.gap_slope.zones, fields.relief
        out = np.zeros(len(gaps))
        _, gap, inside = fields.gap_slope.locate(relief.at)
        some = np.setdiff1d(np.arange(len(gaps)), gap[inside & (relief.heights < 0)])
        if len(some):
            step = (
                (profile.resolution or fields.problem.units.length * fields.period)
                / fields.problem.units.length
                / 64
            )
            middle = gaps.middle[some]
            top, sides_of_top = (
                relief(middle),
                0.5 * (relief(middle - step) + relief(middle + step)),
            )
            curvature = 2 * np.maximum(top - sides_of_top, 0.0) / step**2
            rounding = 8 * EPS * (abs(fields.mean) + np.abs(top)) + relief.error
            reach = np.sqrt(2 * rounding / np.maximum(curvature, 2 * rounding / step**2))
            out[some] = np.where(reach > 0.5 * gaps.half[some], reach, 0.0)
        return out

    @property
    def _steepest(self) -> Array:
        """Slope of the pressure next to a tip, a convex kink of the profile, for each zone.
        It is taken at the least distance from a tip for which an error is stated.

        The slope is J / pi divided by the distance from the tip. J is the largest jump of f' at the
        tips in the zone. At smaller distances the stated error does not hold.
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
        """|d end / d mean pressure| of each end of the gaps (n, 2)."""
        return np.asarray(np.abs(moved_ends(self.fields.state)).T)
