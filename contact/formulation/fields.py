"""`ZoneFields`: pressure, gap, displacement and numbers, from the density on the zones."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import sie
from contact.extras import require
from contact.formulation.controls import Load
from contact.formulation.problem import MISMATCH, Problem
from contact.formulation.quadrature import cuts_between, over_period, panels, sides
from contact.formulation.roots import maximum, reaches
from contact.formulation.tolerances import allowed_overlap
from contact.model.profiles.derive import DETAIL, detail_of
from contact.model.profiles.noise import ROUND_OFF
from sie import Array, Complex, Index, Mask, nearest_image, record, wrapped


@dataclass(frozen=True)
class FieldOptions:
    """Options for sampling the pressure and the gap, and the tolerance of their derivatives."""

    peak_zones: int = 16  # zones in which the largest pressure is located between samples
    # Distance from the zones, divided by their total span, up to which the gap is sampled closely.
    # Farther out, the samples are spaced logarithmically, up to the span divided by round-off.
    far_from: float = 1e3
    guess_tolerance: float = 1e-4  # tolerance of derivatives that serve only as first guesses


OPTIONS = FieldOptions()


class NoPlateaus:
    """Members of `Fields` for contacts in which the pressure is nowhere at the law's limit."""

    plateaus = np.zeros((0, 2))

    def overlap(self, x: ArrayLike) -> Array:
        return np.zeros(np.shape(x))


class NoZones(NoPlateaus, sie.Kept):
    """Members of `Fields` that have the same values for all contacts without zones."""

    loads = levels = np.zeros(0)
    zone_table = cohesive = np.zeros((0, 2))
    widening_rate = gap_rounding = borne_beside = 0.0
    pressure_bound = math.inf
    tilt = moment = rotational_stiffness = None

    def end_remainders(self, table: Array, order: Index) -> Array | None:
        return None

    def pressure_at(self, zone: int, t: ArrayLike) -> Array:
        raise IndexError("there are no zones: use pressure(x)")


def has_tips(density: sie.AnyDensity, problem: Problem) -> bool:
    """Whether the pressure is infinite at a convex kink inside a zone."""
    if problem.kappa:
        kinks, heights = problem.forcing.kinks
        return bool(density.locate(kinks[heights > 0])[2].any())
    return bool(np.any((density.jumps.height > 0) & (density.jumps.order == 0)))


def moved_ends(
    state: sie.AnyState,
    condition: int = 0,
    response: sie.AnyDensity | None = None,
    tolerance: float = 0.0,
) -> Array:
    """Derivatives (2, Z) of the zones' ends, outward, by the value of a side condition.
    They are 0 for fixed ends.

    A derivative is 2 K / A, as in a Newton step. K is the intensity of the response, and A is the
    edge slope: at the distance d from an end, the pressure contains A sqrt(d). If the intensities
    are prescribed, `sie.end_motions` gives the derivatives. response: the solution for a unit of
    the condition's value, if it is known already. tolerance: tolerance of the iteration that finds
    the response.
    """
    zones = state.density.zones
    response = state.response(state.values(condition), tolerance) if response is None else response
    if zones.follow_ends:
        return sie.end_motions(state.whole, -np.array(response.intensities))[0]
    return moves_by(response, state.density)


def moves_by(density: sie.AnyDensity, on: sie.AnyDensity) -> Array:
    """Derivatives (2, Z) of the ends, outward, by c at c = 0, for density `on` + c `density`.

    The derivative for an end is 2 K / A. At the distance d from the end, `density` contains K /
    sqrt(d), and `on` contains A sqrt(d). With kappa (bodies that slide and differ elastically), the
    factor is not 2 (`sie.basis.weight`). For a fixed end the derivative is 0.
    Both densities are on the same zones. The ends have no prescribed intensities.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        k, slopes = np.array(density.intensities), np.array(on.edge_slopes)
        return np.where(on.zones.moves, on.zones.weight.end_step(k, slopes), 0.0)


def by_nominal_pressure(problem: Problem, zones: sie.Zones, tolerance: float) -> sie.AnyState:
    """Solution on given zones for zero load and the nominal pressure 1 outside the strip.
    The strip is the one period of the profile that the localized model solves.
    """
    equation = sie.Equation(
        problem.kernel, problem.columns[0], (sie.Total(0.0), sie.EqualPotential())
    )
    return sie.solve_zones(equation, zones, tolerance)


@record
class ZoneFields(NoPlateaus, sie.Kept):
    """Fields of a contact whose unknown is the pressure on its zones.

    The members of the protocol `Fields` take places in metres, all others take scaled places.
    Pickles and copies leave out `state` with its matrices; members that depend on `state` are
    computed before.
    """

    problem: Problem
    state: sie.AnyState = field(repr=False)
    amplitude_rate: float = 0.0
    centring: float = 0.0
    cohesive = np.zeros((0, 2))
    borne_beside = 0.0

    def __getstate__(self) -> dict[str, Any]:
        kept = {name: value for name, value in super().__getstate__().items() if name != "state"}
        kept |= {"density": self.density, "levels": self.levels, "stiffness": self.stiffness}
        return (
            kept
            if self.problem.moment is None
            else kept | {"rotational_stiffness": self.rotational_stiffness}
        )

    @cached_property
    def density(self) -> sie.AnyDensity:
        """The scaled pressure; its `transform` at complex points gives the stresses in the body."""
        return self.state.density

    @property
    def solved_zones(self) -> sie.Zones:
        """The scaled zones, on which the pressure is the unknown."""
        return self.density.zones

    @cached_property
    def levels(self) -> Array:
        """Scaled level (minus the approach) of each zone; in a solution all levels are equal."""
        zones = self.density.zones
        if len(zones) == 1:
            end = zones.b
            return -(self._relative_displacement(end) + self.standing_shape(end))
        levels = self.state.levels
        return levels - self._shift(self.density) if self.problem.kappa else levels

    def _shift(self, density: sie.AnyDensity) -> float:
        """Constant c of the displacement under the pressure `density`, for sliding bodies.
        The formula is in `contact.formulation.mismatch`.
        """
        problem = self.problem
        shift: float = require(MISMATCH).shift(
            problem.kappa, problem.period, density.total, density.moment()
        )
        return shift

    @cached_property
    def level(self) -> float:
        return float(self.levels.mean())

    @property
    def approach(self) -> float | None:
        """Approach [m]; None if no point is given from which displacements are measured."""
        if not self.problem.operator.has_approach:
            return None
        return 0.0 - self.level * self.problem.units.height

    @cached_property
    def stiffness(self) -> float | None:
        """Derivative of the load by the approach [N/m^2]; None if the approach is undefined.

        The given tilt or moment stays constant.

        The ends are kept fixed where their motion does not change the density at first order. In
        the first-order localized model the nominal pressure changes with the load at the rate
        `amplitude_rate`. If the centre of the strip moves with the load, each unit of load adds
        `centring` to the approach.
        """
        if self.approach is None:
            return None
        state, values = self.state, self.state.values()
        rate = self.centring - float(state.level_rates(values).mean())
        if self.problem.kappa:
            rate += self._shift(state.response(values))
        if self.amplitude_rate:
            rate -= self.amplitude_rate * float(
                by_nominal_pressure(self.problem, self.density.zones, ROUND_OFF).levels.mean()
            )
        if self.density.zones.follow_ends:
            k = np.array(state.response(state.values()).intensities)
            rate -= float(sie.end_motions(state.whole, -k)[1].mean())
        units = self.problem.units
        return units.load / (units.height * rate)

    @property
    def load_size(self) -> float:
        """The scaled force relative to which an error of the load is stated.

        It is the load, or the force of the prescribed intensities if that is larger.
        """
        zones = self.density.zones
        wanted = abs(self.problem.end.intensity or 0.0)
        return max(abs(self.density.total), np.pi * wanted * float(np.sqrt(2 * zones.half).sum()))

    @property
    def bending(self) -> float:
        """Largest end intensity that one coefficient causes, divided by the prescribed intensity.

        Each coefficient of the pressure's series alone causes an intensity at the ends of its zone.
        """
        zones, wanted = self.density.zones, self.problem.end.intensity
        assert wanted
        return float(
            (np.abs(self.density.coefficients).max(axis=1) * np.sqrt(zones.half / 2)).max()
        ) / abs(wanted)

    def second_variation(self, compliance: float | None = None) -> Array:
        """Scaled Hessian (2 Z, 2 Z) of the energy by outward displacements of all free zone ends.

        Row i, column j is dG_i/ds_j / (2 w) times the square roots of both zones' widths. Here G =
        w (K/K*)^2 is the energy release rate at end i, with the work of adhesion w, the intensity K
        and the prescribed one K*; s_j is the motion of end j. Ends at sharp corners do not move and
        are left out. compliance: d approach / d load of the loading device; None if it prescribes
        the load.
        """
        zones, wanted = self.density.zones, self.problem.end.intensity
        assert wanted
        whole = sie.Zones.of(zones.table, self.problem.end, self.problem.end)
        state = sie.solve_zones(
            self.problem.equation(Load(self.density.total)), whole, ROUND_OFF
        ).whole
        rates = sie.end_rates(state)
        matrix = rates.intensities
        if compliance is not None:
            by_load = np.concatenate(state.response(state.values()).intensities)
            matrix = matrix - np.outer(by_load, rates.levels.mean(axis=0)) / (
                float(state.level_rates(state.values()).mean()) - compliance
            )
        root = np.sqrt(np.tile(zones.b - zones.a, 2))
        moves = zones.moves.ravel()
        return np.asarray((root[:, None] * matrix * root / wanted)[np.ix_(moves, moves)])

    @cached_property
    def mean_gap(self) -> float:
        """Mean gap over a period [m]: mean of the profile + mean displacement - approach.

        For a strip, the mean gap is computed by quadrature.
        """
        units = self.problem.units
        if self.problem.corners != (-np.inf, np.inf):
            return np.inf
        if not self.problem.interaction.strip:
            return (mean_shape(self.problem) + self.mean_displacement + self.level) * units.height
        total, breaks = 0.0, self.problem.forcing.jumps.broken_at
        for lo, hi, _, _ in self.open_intervals():
            x, weights = panels(
                cuts_between(lo, hi, max(0.5 * self.spacing, (hi - lo) / DETAIL.samples), breaks)
            )
            total += float(self.scaled_gap(x) @ weights)
        return total / self.problem.repeat_length * units.height

    @property
    def mean_displacement(self) -> float:
        """Scaled mean displacement over a period; 0 if the substrate has no `compression`."""
        return self.problem.compression * self.density.total / self.problem.repeat_length

    def end_remainders(self, table: Array, order: Index) -> Array | None:
        """Exact ends of zones minus the rounded ends in a table [m]; None if unknown.

        order: the zone of each row.
        """
        if not self.problem.forcing.resolution.exact_places:
            return None
        units, period, zones = (
            self.problem.units,
            self.problem.profile.period or 1.0,
            self.density.zones,
        )
        at, rest = units.length * zones.table[order], units.length * zones.rest.T[order]
        turns = np.round((table - (units.origin + at)) / period) * period
        terms = zip(at.ravel(), turns.ravel(), table.ravel(), strict=True)
        left = np.array(
            [math.fsum((one, units.origin, turn, -rounded)) for one, turn, rounded in terms]
        ).reshape(table.shape)
        return np.asarray(left + rest)

    def inside(self, x: Array) -> Mask:
        """Whether scaled points lie in a zone."""
        return self.density.locate(x)[2]

    def scaled_gap(self, x: Array) -> Array:
        """The scaled gap at scaled places x; exactly zero on the zones.

        Between the zones, it is F - V + lambda C + level. F is the scaled profile, V the potential
        of the pressure, and lambda C the additional terms C with their amplitudes lambda.
        """
        return np.where(self.inside(x), 0.0, self.formal_gap(x))

    def formal_gap(self, x: Array) -> Array:
        """Formula of the scaled gap outside the zones, evaluated at all x, in the zones as well.

        On the zones, where the gap is zero, the values of this formula show its error.
        """
        gap = np.asarray(self.standing_shape(x) + self.level + self._relative_displacement(x))
        # In narrow gaps, `gap` loses digits by cancellation, so `opening` replaces `gap`.
        narrow, opening = self.density.opening(x)
        return np.where(narrow, opening, gap) if narrow.any() else gap

    def formal_pressure(self, x: Array) -> Array:
        """Scaled pressure at scaled places x; where the solution is wrong, it may be negative."""
        return np.asarray(self.density(x))

    def standing_shape(self, x: Array) -> Array:
        """The scaled profile F at scaled places x, turned by the given or the solved tilt."""
        shape = self.problem.shape(x)
        return (
            shape
            if self.problem.moment is None
            else shape - self._missing_tilt * (x + self.problem.units.lever)
        )

    @property
    def _missing_tilt(self) -> float:
        return float(self.density.amplitudes[-1])

    def _relative_displacement(self, x: Array) -> Array:
        """Scaled displacement at scaled places x, up to a constant.
        It is the sum of the terms of unknown amplitude (`unknown_columns`), minus the pressure's
        potential.

        Each column is multiplied by its solved amplitude.
        """
        raised = self._raised(x, self.density.potential(x))
        return raised + self._sheared(x, self.density) if self.problem.kappa else raised

    def _sheared(self, x: Array, density: sie.AnyDensity) -> Array:
        """Scaled displacement due to shear, without the part that grows with the mean pressure.
        `_with_columns` adds this part.
        """
        place, zone, inside = density.locate(x)
        totals, passed = density.totals, place > density.zones.b[zone]
        before = (np.cumsum(totals) - totals)[zone] + np.where(passed, totals[zone], 0.0)
        before = np.where(inside, before + density.integral(x), before)
        # The term lambda x of the mean pressure is linear in x and does not repeat. So the pressure
        # is integrated up to x, and not only up to the image `place` of x in the period.
        if self.problem.period is not None:
            before = before + np.round((x - place) / self.problem.period) * density.total
        return np.asarray(self._shift(density) - self.problem.kappa * before)

    def _raised(self, x: Array, potential: Array) -> Array:
        return self._with_columns(x, potential, self.density.amplitudes)

    def _with_columns(self, x: Array, potential: Array, amplitudes: Array) -> Array:
        out = -potential
        columns = self.problem.unknown_columns
        for amplitude, column in zip(amplitudes[: len(columns)], columns, strict=True):
            assert column.primitive is not None
            out = out + amplitude * column.primitive(x)
        return np.asarray(out)

    @cached_property
    def spacing(self) -> float:
        """Smallest scaled length over which the profile, and therefore the gap, varies."""
        units, profile, ends = (
            self.problem.units,
            self.problem.profile,
            self.density.zones.table[[0, -1], [0, 1]],
        )
        return (
            profile.resolution or detail_of(profile.height, *units.x(ends).tolist())
        ) / units.length

    @cached_property
    def tips(self) -> Array:
        """Scaled places of convex kinks, ascending; with a period, also their nearest images.

        At these places a gap may have a minimum where its slope is not zero.
        """
        kinks, heights = self.problem.forcing.kinks
        at = kinks[heights > 0]
        period = self.problem.period
        if period is not None:
            at = wrapped(at, self.density.zones.a[0], period)
            at = np.concatenate((at - period, at, at + period))
        return np.sort(at)

    @cached_property
    def gap_rounding(self) -> float:
        """Scaled error of the gap due to round-off."""
        ends = np.concatenate((self.density.zones.a, self.density.zones.b))
        some = ends[:: max(1, len(ends) // (2 * OPTIONS.peak_zones))]
        return allowed_overlap(heights=self.largest_shape, noise=self.problem.shape_rounding(some))

    @cached_property
    def largest_shape(self) -> float:
        """Estimate of the largest scaled displacement: |height| at zones' ends plus |approach|."""
        zones = self.density.zones
        return float(np.abs(self.problem.shape(np.concatenate((zones.a, zones.b)))).max()) + abs(
            self.level
        )

    def open_intervals(self) -> Iterator[tuple[float, float, bool, bool]]:
        """Yield scaled open intervals: left end, right end, and whether each is the end of a zone.

        A half-line is cut off at the distance `far_from` times the span of the zones.
        """
        zones, problem = self.density.zones, self.problem
        for right, left in zip(zones.b[:-1], zones.a[1:], strict=True):
            yield float(right), float(left), True, True
        first, last = float(zones.a[0]), float(zones.b[-1])
        if problem.interaction.strip:
            # The localized model solves one period, the strip. Only the gap within the strip
            # counts.
            lo, hi = (
                problem.centre - 0.5 * problem.repeat_length,
                problem.centre + 0.5 * problem.repeat_length,
            )
        elif problem.period is not None:
            if first + problem.period > last:
                yield last, first + problem.period, True, True
            return
        else:
            reach = OPTIONS.far_from * (last - first)
            lo, hi = self._limits
            lo, hi = (
                lo if np.isfinite(lo) else first - reach,
                hi if np.isfinite(hi) else last + reach,
            )
        if lo < first:
            yield lo, first, False, True
        if hi > last:
            yield last, hi, True, False

    @property
    def _limits(self) -> tuple[float, float]:
        """Scaled left and right limit for zones: an end of the known profile or a sharp corner.
        A limit is infinite on a side without an end or corner.
        """
        problem = self.problem
        return max(problem.borders[0], problem.corners[0]), min(
            problem.borders[1], problem.corners[1]
        )

    @property
    def is_bounded(self) -> bool:
        return self.problem.period is not None or bool(np.all(np.isfinite(self._limits)))

    def far_stretches(self) -> Iterator[Array]:
        """Yield scaled, logarithmically spaced places left and right of all `open_intervals`.
        There are none if the profile has a period, or ends on both sides.
        """
        if self.is_bounded:
            return
        zones, (lo, hi) = self.density.zones, self._limits
        first, last = float(zones.a[0]), float(zones.b[-1])
        away = (last - first) * np.geomspace(OPTIONS.far_from, 1 / ROUND_OFF, DETAIL.samples)
        if not np.isfinite(lo):
            yield first - away[::-1]
        if not np.isfinite(hi):
            yield last + away

    def _scaled(self, x: ArrayLike) -> Array:
        # x is moved by whole periods to the period around the zones. `self.density` does not do so
        # in a localized model's strip, whose density has no period.
        zones = self.density.zones
        middle = 0.5 * float(zones.a[0] + zones.b[-1])
        return nearest_image(
            self.problem.units.scaled(np.asarray(x, dtype=float)), middle, self.problem.period
        )

    @property
    def load(self) -> float:
        return self.density.total * self.problem.units.load

    @cached_property
    def loads(self) -> Array:
        return self.density.totals * self.problem.units.load

    @property
    def zone_table(self) -> Array:
        """Ends of the zones [m] (n, 2)."""
        return np.asarray(self.problem.units.x(self.density.zones.table))

    @property
    def zones(self) -> Array:
        """Ends of the zones, scaled (n, 2)."""
        return np.asarray(self.density.zones.table)

    @cached_property
    def spreading(self) -> Array:
        """Derivatives of the ends of the zones by ln(load), outward positive [m] (n, 2)."""
        return moved_ends(self.state).T * self.problem.units.length * self.density.total

    def rates(self, x: Array, tolerance: float = OPTIONS.guess_tolerance) -> tuple[Array, Array]:
        """Scaled derivatives by ln(load): of the zones' ends, outward (n, 2), and of the gap at x.

        tolerance: tolerance of the iteration for the response to the load, if one is needed. The
        default is sufficient for a first guess.
        """
        response = self.state.response(self.state.values(), tolerance)
        zones, load = self.density.zones, self.density.total
        places = np.append(zones.middle[0], x)
        sunk = self._with_columns(places, response.potential(places), response.amplitudes)
        if self.problem.kappa:
            sunk = sunk + self._sheared(places, response)
        opens = sunk[1:] - sunk[0]
        return moved_ends(self.state, 0, response).T * load, np.asarray(opens * load)

    def pressure_rates(self, x: Array, tolerance: float) -> Array:
        """Derivatives by ln(load) of the scaled pressure at scaled places in contact.

        tolerance: tolerance of the iteration for the response to the load, if one is needed.
        """
        response = self.state.response(self.state.values(), tolerance)
        return np.asarray(response(x) * self.density.total)

    @property
    def tilt(self) -> float:
        """Angle by which the body is turned [rad]."""
        if self.problem.moment is None:
            return self.problem.tilt
        return self.problem.tilt + self._missing_tilt * self.problem.units.slope

    @property
    def scaled_moment(self) -> float:
        """Scaled moment of the pressure p about x = 0, int p x dx."""
        return self.density.moment(about=-self.problem.units.lever)

    @property
    def moment(self) -> float:
        """Moment of the pressure p about x = 0, int p x dx [N]."""
        return self.scaled_moment * self.problem.units.moment

    @cached_property
    def rotational_stiffness(self) -> float:
        """Derivative of the moment by the tilt at the given load [N].

        It is one divided by the tilt per unit of moment.

        The ends are kept fixed, as for `stiffness`.
        """
        problem, density = self.problem, self.density
        if problem.moment is None:
            whole = replace(density.zones, symmetric=False)
            equation = replace(problem, moment=self.scaled_moment).equation(Load(density.total))
            state = sie.solve_zones(equation, whole, ROUND_OFF)
        else:
            state = self.state
        values = np.zeros(len(state.condition_scale))
        values[-1] = 1.0
        return problem.units.moment / (
            problem.units.slope * float(state.response(values).amplitudes[-1])
        )

    @property
    def contact_fraction(self) -> float:
        zones = self.density.zones
        return float((zones.b - zones.a).sum()) / self.problem.repeat_length

    @cached_property
    def widening_rate(self) -> float:
        """Derivative of the contact fraction by the load [m/N]."""
        return (
            float(moved_ends(self.state).sum())
            / self.problem.repeat_length
            / self.problem.units.load
        )

    def pressure_at(self, zone: int, t: ArrayLike) -> Array:
        return self.density.at_t(zone, t) * self.problem.units.pressure

    @cached_property
    def _is_infinite(self) -> bool:
        """Whether the pressure is infinite at a sharp corner or at a convex kink."""
        density = self.density
        if any(end.intensity is None for end in (*density.zones.left, *density.zones.right)):
            left, right = density.intensities
            if max(left.max(), right.max()) > ROUND_OFF * np.abs(density.coefficients).max():
                return True
        return has_tips(density, self.problem)

    @cached_property
    def _sampled(self) -> tuple[Array, float]:
        """(upper bounds (Z,) of the scaled pressure on zones from samples, the highest sample)."""
        density = self.density
        counts, reach, peak = density.sampling, np.empty(len(density.zones)), -np.inf
        for n in np.unique(counts):
            group = np.flatnonzero(counts == n)
            theta = (np.arange(n) + 0.5) * np.pi / n
            values = density.at(group[:, None], *sides(theta))
            reach[group], peak = reaches(values).max(axis=1), max(peak, float(values.max()))
        return reach, peak

    @property
    def pressure_bound(self) -> float:
        """Upper bound of the pressure [Pa] from its series; from samples if the pressure jumps."""
        if self._is_infinite:
            return math.inf
        bound = self.density.upper_bound
        if math.isinf(bound) and self.problem.algebraic is None:
            bound = float(self._sampled[0].max())
        return bound * self.problem.units.pressure

    @cached_property
    def max_pressure(self) -> float:
        """Largest pressure [Pa]: at samples on all zones, and at maxima between the samples.

        Maxima between samples are sought on the zones that may have the largest pressure.
        """
        if self._is_infinite:
            return math.inf
        counts, (reach, peak) = self.density.sampling, self._sampled
        zones = np.argsort(reach)[-OPTIONS.peak_zones :]
        highest = max(
            self._highest_on(int(zone), int(counts[zone])) for zone in zones[reach[zones] >= peak]
        )
        if self.problem.algebraic is not None:
            # At the tip of a power-law profile, the pressure has a cusp, which samples may miss.
            highest = max(highest, float(self.density(np.asarray(self.problem.algebraic.at)).max()))
        return highest * self.problem.units.pressure

    def _highest_on(self, zone: int, count: int) -> float:
        return maximum(
            lambda angle: self.density.at(zone, *sides(angle)),
            np.linspace(0, np.pi, count + 1),
            levels=7,
        )[1]

    def pressure(self, x: ArrayLike) -> Array:
        return self.density(self._scaled(x)) * self.problem.units.pressure

    def pressure_transform(self, x: Array, y: Array) -> tuple[Complex, Complex]:
        units = self.problem.units
        z = self._scaled(x) + 1j * (y / units.length)
        value, slope = self.density.transform_with_slope(z)
        if self._nominal:
            # The strip and its copies fill the interval (a, b). The nominal pressure P acts outside
            # (a, b), and its transform is -P (i + (1/pi) ln((z - a)/(z - b))).
            half = (self.problem.interaction.neighbours + 0.5) * self.problem.repeat_length
            left, right = z - (self.problem.centre - half), z - (self.problem.centre + half)
            value = value - self._nominal * np.asarray(1j + np.log(left / right) / np.pi)
            slope = slope - self._nominal / np.pi * (1 / left - 1 / right)
        return value * units.pressure, slope * (units.pressure / units.length)

    @property
    def _nominal(self) -> float:
        """Scaled nominal pressure outside the strip of a localized model; 0 without a strip."""
        if not self.problem.interaction.strip:
            return 0.0
        given = self.problem.amplitude
        return float(self.density.amplitudes[0]) if given is None else given

    @property
    def deep_pressure(self) -> float:
        if self.problem.operator.is_periodic:
            return self.load / (self.problem.repeat_length * self.problem.units.length)
        return self._nominal * self.problem.units.pressure

    def _beyond(self, x: Array) -> Mask:
        lo, hi = self.problem.borders
        return (x < lo) | (x > hi)

    def gap(self, x: ArrayLike) -> Array:
        scaled = self._scaled(x)
        gap = self.scaled_gap(scaled) * self.problem.units.height
        return np.where(self._beyond(scaled), np.inf, np.maximum(gap, 0.0))

    def displacement(self, x: ArrayLike) -> Array:
        scaled = self._scaled(x)
        inside = self.inside(scaled)
        shape = np.where(
            inside, self.standing_shape(np.where(inside, scaled, self.density.zones.middle[0])), 0.0
        )
        zero = self.level if self.approach is None else 0.0
        u = np.where(inside, -self.level - shape, self._relative_displacement(scaled)) + zero
        if self.problem.amplitude:
            # The profile F of the equation contains the displacement that a given nominal pressure
            # causes (`Problem.raised`). This displacement is part of u, so it is added here.
            u = u + self.problem.raised(scaled)
        return np.asarray(u * self.problem.units.height)


def mean_shape(problem: Problem) -> float:
    """Mean of the scaled profile F over the period, by Gauss panels between breakpoints."""
    x, _, weights = over_period(problem.profile)
    return float(problem.shape(problem.units.scaled(x)) @ weights)
