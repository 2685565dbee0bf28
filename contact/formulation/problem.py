"""`Problem`: a scene as a scaled integral equation.

Lengths are in units of `length`, slopes in units of `slope`, pressures in units of E* slope / 2
(`Units`). Equations (5) and (6) of docs/theory become (1/pi) PV int phi K = f' / slope =: g for the
scaled pressure phi. With F = f / (slope length), the potential V of phi, and terms C (columns) of
amplitude lambda,

    V - lambda C - F = level on every zone,    level = -approach / (slope length).

If the moment is given, the tilt is unknown. Then F is the profile at a first guess of the tilt. The
column C = -x, whose slope is -1, turns the body by the rest of the tilt, which is its amplitude.
The body turns about x = 0, where the approach is measured.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

import sie
from contact.extras import require
from contact.formulation.controls import Control
from contact.formulation.units import Units
from contact.model.interactions.base import Interaction
from contact.model.laws.base import Law
from contact.model.operator import Operator
from contact.model.plugin_checks.forms import AuthorMethod
from contact.model.profiles.base import Profile, onto
from contact.model.profiles.noise import ROUND_OFF
from contact.model.profiles.tilted import Tilted
from contact.model.substrates.base import Substrate
from sie import Array, Index, nearest_image, record

Conditions = tuple[sie.Condition, ...]


# The module for bodies that slide and differ elastically; only such scenes import it.
MISMATCH = "contact.formulation.mismatch"


def minus_one(x: Array) -> Array:
    """The slope -1 that a unit tilt adds, at places x; the unknown tilt multiplies this slope."""
    return np.full(np.shape(x), -1.0)


@record
class Problem(sie.Kept):
    """Profile, interaction, substrate and law in scaled variables.

    centre: centre of the localized model's strip. amplitude: amplitude of the strip's column (the
    nominal pressure outside the strip) if it is given; then the column belongs to the right side.
    reference: whether this is a single strip of a profile that repeats; its zones may cross the
    border of the cell and end at the borders of the strip. moment: scaled moment about x = 0; None
    if the tilt is not an unknown.
    """

    profile: Profile
    interaction: Interaction
    substrate: Substrate
    law: Law
    units: Units
    lowest: float
    centre: float = 0.0
    amplitude: float | None = None
    reference: bool = False
    moment: float | None = None

    @property
    def tilt(self) -> float:
        """Angle by which the profile is turned; only a first guess if the moment is given."""
        return self.profile.tilt if isinstance(self.profile, Tilted) else 0.0

    @property
    def period(self) -> float | None:
        """Scaled period of the solution; None if the solution does not repeat."""
        return self.cell if self.interaction.needs_period else None

    @property
    def repeat_length(self) -> float:
        """Scaled period of the solution, which must have a period."""
        assert self.period is not None
        return self.period

    @property
    def cell(self) -> float | None:
        """Scaled period of the profile itself; None if the profile has no period."""
        return None if self.profile.period is None else self.profile.period / self.units.length

    @cached_property
    def operator(self) -> Operator:
        return Operator(
            self.interaction,
            self.substrate,
            self.profile.period if self.interaction.needs_period else None,
        )

    @cached_property
    def kernel(self) -> sie.Kernel:
        return self.operator.kernel(self.units.length)

    @cached_property
    def inverse_kernel(self) -> sie.Kernel:
        return self.operator.inverse_kernel(self.units.length)

    @cached_property
    def corners(self) -> tuple[float, float]:
        """Scaled sharp corners of the profile, or borders of a single strip; infinite if none."""
        lo, hi = -np.inf, np.inf
        if self.profile.support is not None:
            lo, hi = (float(self.units.scaled(np.array(s))) for s in self.profile.support)
        return (max(lo, self.cut[0]), min(hi, self.cut[1])) if self.reference else (lo, hi)

    def position(self, place: float) -> float:
        """Position [m] of a scaled place, moved into the profile's cell; 0 if it rounds to 0."""
        x = float(self.profile.wrap(self.units.x(np.array(place))))
        return x if abs(x) > ROUND_OFF * self.units.length else 0.0

    @property
    def cut(self) -> tuple[float, float]:
        """Scaled borders of the cell, which is the period of the profile around `centre`."""
        assert self.cell is not None
        return self.centre - 0.5 * self.cell, self.centre + 0.5 * self.cell

    @property
    def round(self) -> float | None:
        """Scaled period if zones may cross the border of the cell.
        It is None if the profile has sharp corners or no period.
        """
        return self.period if self.corners == (-np.inf, np.inf) else None

    @cached_property
    def borders(self) -> tuple[float, float]:
        """Scaled ends of the interval in which the profile is known; infinite if there are no ends.

        No zone may touch these ends. The interval is that of a measured profile without a period,
        or the one cell of a periodic profile that is solved without its images.
        """
        known = None if self.period is not None or self.reference else self.profile.known
        if known is None:
            return -np.inf, np.inf
        lo, hi = (float(self.units.scaled(np.array(s))) for s in known)
        return lo, hi

    @property
    def detail(self) -> float:
        """Smallest scaled length over which the profile varies; infinite if none is stated."""
        resolution = self.profile.resolution
        return np.inf if resolution is None else resolution / self.units.length

    @cached_property
    def forcing(self) -> sie.Forcing:
        units, profile = self.units, self.profile
        # Kinks without a jump are left out: their logarithm would be 0 times infinity, which is no
        # number.
        kinks, jumps = profile.kinks[profile.kinks[:, 1] != 0.0], profile.jumps
        at = np.asarray(units.scaled(np.concatenate((kinks[:, 0], jumps[:, 0]))))
        # A jump of the n-th derivative of the profile is a jump of the (n - 1)-th derivative of the
        # slope.
        orders = np.concatenate(
            (np.zeros(len(kinks), dtype=np.intp), jumps[:, 1].astype(np.intp) - 1)
        )
        heights = np.concatenate((kinks[:, 1], jumps[:, 2])) * units.length**orders / units.slope
        at = nearest_image(at, self.centre, self.cell if self.reference else self.period)
        resolution = None if profile.resolution is None else self.detail
        exact = profile.exact_places
        whole = sie.Forcing(
            self.slope,
            self.shape,
            sie.Jumps(at, heights, orders, algebraic=self.algebraic),
            resolution=sie.Resolution(
                length=resolution,
                rounded_place=units.placed,
                exact_places=exact,
                rounding=profile.slope_rounding / units.slope,
            ),
        )
        # With a given amplitude, the displacement due to the pressure outside the strip is part of
        # the right side. Near the border of the strip this displacement varies over arbitrarily
        # short lengths. So no shortest length is stated.
        if not self.amplitude:
            return whole
        return replace(
            whole,
            jumps=replace(whole.jumps, spline=self._profile_slope),
            resolution=replace(whole.resolution, length=None),
        )

    @cached_property
    def algebraic(self) -> sie.AlgebraicPoints | None:
        """Points near which the scaled slope is a power of the distance; None if there are none."""
        points, units = np.asarray(self.profile.algebraic_points), self.units
        if not len(points) or self.kappa:
            return None  # with kappa the law admits even powers only, which are smooth
        at, exponents, left, right = points.T
        at = nearest_image(
            np.asarray(units.scaled(at)), self.centre, self.cell if self.reference else self.period
        )
        factor = exponents * units.length ** (exponents - 1.0) / units.slope
        if self.cell is not None and self.kernel.period is None:
            # An algebraic point on the border of the cell lies at both ends of the cell. So the
            # copies one cell to the left and to the right are added, as symmetric zones require.
            at, exponents, left, right, factor = (
                np.tile(part, 3) for part in (at, exponents, left, right, factor)
            )
            at = at + np.repeat([-self.cell, 0.0, self.cell], len(points))
        return sie.AlgebraicPoints(at, exponents - 1.0, -factor * left, factor * right)

    def slope(self, x: Array) -> Array:
        """Scaled slope of the profile, plus the slope that a pressure outside the strip causes.

        The amplitude of this pressure is given, so that the slope belongs to the right side. The
        right side may have as many modes as it needs near the border of a strip. Columns with an
        unknown amplitude are coupled to all zones and are truncated earlier.
        """
        slope = self._profile_slope(x)
        return slope + self.amplitude * self.columns[0].value(x) if self.amplitude else slope

    def _profile_slope(self, x: Array) -> Array:
        return np.asarray(self.profile.slope(self.units.x(x))) / self.units.slope

    def shape(self, x: Array) -> Array:
        """Scaled profile F = (f - min f) / unit of height, plus the displacement `raised` if any.
        A given pressure outside the localized model's strip causes this displacement.
        """
        shape = self._profile_shape(x)
        return shape + self.raised(x) if self.amplitude else shape

    def raised(self, x: Array) -> Array:
        """Scaled displacement that a given pressure outside the localized model's strip causes."""
        primitive = self.columns[0].primitive
        assert primitive is not None and self.amplitude is not None
        return np.asarray(self.amplitude * primitive(x))

    def _profile_shape(self, x: Array) -> Array:
        at, ends = self.units.x(x), self.profile.support
        if ends is not None:
            at = onto(ends, at, 4 * np.finfo(float).eps * (ends[1] - ends[0] + np.abs(at)))
        with np.errstate(
            over="ignore"
        ):  # heights far away may overflow to inf: nothing touches there
            return np.asarray(
                (np.asarray(self.profile.height(at)) - self.lowest) / self.units.height
            )

    def shape_rounding(self, x: Array) -> float:
        """Largest round-off of the scaled profile F at scaled places x.

        It is the largest deviation of F from a straight line over a few units in the last digit of
        x, at least EPS times F.
        """
        at = self.units.x(x)
        near = at[:, None] + 4 * np.spacing(np.abs(at))[:, None] * np.arange(-4, 5)
        height = np.asarray(self.profile.height(near)) / self.units.height
        with np.errstate(invalid="ignore"):
            bend = 0.5 * np.abs(np.diff(height, 2, axis=1))
            least = np.finfo(float).eps * np.abs(height)
        return float(max(np.max(a[np.isfinite(a)], initial=0.0) for a in (bend, least)))

    @cached_property
    def columns(self) -> tuple[sie.Forcing, ...]:
        return self.operator.columns(self.centre, self.units.length, self.units.scaled)

    @property
    def unknown_columns(self) -> tuple[sie.Forcing, ...]:
        """Terms of the right side of the equation whose amplitudes are unknown."""
        columns = self.columns if self.amplitude is None else ()
        if not self.kappa or self.period is None:
            return columns
        return (*columns, require(MISMATCH).MEAN)

    @property
    def kappa(self) -> float:
        """Factor of p itself in T p + kappa p = (E*/2) f'; 0 unless different bodies slide."""
        return self.law.kappa

    @property
    def skew(self) -> complex:
        """Factor 1 / (1 + i kappa) by which a slope's transform enters the pressure."""
        return 1 / (1 + 1j * self.kappa) if self.kappa else 1.0

    @cached_property
    def compression(self) -> float:
        """Scaled displacement under the uniform pressure 1; 0 if the substrate gives none."""
        return (self.operator.compression or 0.0) / self.units.length

    def bearing(
        self, density: sie.AnyDensity, zone: Index | int, left: Array, right: Array
    ) -> Array:
        """The pressure that must be positive in contact, at places in zones.
        A place is given by its distances from both ends of its zone.

        The distances are divided by the half width of the zone.
        """
        return np.asarray(density.at(zone, left, right))

    def borne(self, density: sie.AnyDensity) -> float:
        """Integral, over all zones, of the pressure that must be positive in contact."""
        return density.total

    @cached_property
    def end(self) -> sie.End:
        """Kind of a free end of a zone: it moves, and the law prescribes its intensity."""
        return sie.free_with_intensity(self._intensity)

    @cached_property
    def held_end(self) -> sie.End:
        """Kind of a fixed end of a zone: its place is given."""
        return sie.End(moves=False, intensity=self._intensity)

    @property
    def _intensity(self) -> float:
        return self.law.intensity(self.units.E_star) / self.units.intensity

    def equation(self, control: Control) -> sie.Equation:
        """The integral equation with the side conditions of the control."""
        closure: Conditions = ()
        columns = self.unknown_columns
        if self.amplitude is None and self.interaction.follows_isolated:
            closure = (sie.Amplitude(0, 0.0),)
        elif self.amplitude is None:
            method = AuthorMethod("interaction.side_conditions(period)", "interaction")
            closure = method.rows(
                sie.Condition, self.interaction.placed_conditions, self.period, self.units.scaled
            )
        conditions, ends = control.conditions()
        if self.kappa:
            conditions, closure = self._with_mismatch(conditions, closure)
        if self.moment is not None:
            # The term added to the right side is the slope of a unit tilt. The unknown amplitude of
            # this term is the correction of the tilt.
            closure = (*closure, sie.moment(self.moment, about=-self.units.lever))
            columns = (
                *columns,
                sie.Forcing(minus_one, self.units.minus_place, resolution=sie.Resolution(modes=1)),
            )
        return sie.Equation(
            self.kernel, self.forcing, (*conditions, *closure), columns, ends, self.kappa
        )

    def _with_mismatch(self, conditions: Conditions, closure: Conditions) -> tuple[Conditions, ...]:
        """Side conditions for sliding: each `sie.Level` condition is replaced by a `MeanLevel`.

        With a period, `closure` gets one more condition: the amplitude of the last column is kappa
        times the mean pressure.
        """
        kappa, period = self.kappa, self.period
        mean_level = require(MISMATCH).MeanLevel
        conditions = tuple(
            mean_level(one.value, kappa, period) if isinstance(one, sie.Level) else one
            for one in conditions
        )
        if period is None:
            return conditions, closure
        mean = sie.Amplitude(len(self.unknown_columns) - 1, 0.0, per_total=kappa / period)
        return conditions, (*closure, mean)

    def with_amplitude(self, amplitude: float) -> Problem:
        return replace(self, amplitude=amplitude)

    def about(self, centre: float) -> Problem:
        return replace(self, centre=centre)
