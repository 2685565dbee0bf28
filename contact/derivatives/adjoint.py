r"""The derivative of one number by all heights at once, from one solve of an adjoint equation.

Let f' be a change of the profile f, and p' the derivative of the pressure p along this change. Let
V phi(x) be the potential of a density phi on the zones, and T phi its transform, d(V phi)/dx. In
scaled variables V p' = f' + const on the zones, and the load of p' is given. The operator V is
symmetric. So a number J(p') that is linear in p' is the integral of W f' over the zones. The
density W is the adjoint weight of J. On the zones V W is, up to a constant:

    load of a zone      V W = 1 on this zone, 0 on the others
    approach            V W = 0, and W has the integral 1
    F(z) in the body    V W = K(z - x) / pi, for the transform F of p' with the kernel K
    p'(x*)              V W = a unit source at x*
    intensity at an end V W = 0, with W ~ d^(-3/2) at the distance d from this end

For the last two numbers, W has a singular part -w' = -dw/dt in closed form. It lies on the zone of
the place x* or of the end. Let t be the scaled position in this zone, from -1 to 1, and z the same
coordinate outside the zone; t* belongs to x*:

    p'(x*):     w ~ sqrt(1 - t^2) / (t - t*),        T w ~ 1 - sqrt(z^2 - 1) / (z - t*)
    right end:  w ~ sqrt((1 + t) / (1 - t)),         T w ~ sqrt((z + 1) / (z - 1)) - 1
    left end:   w ~ sqrt((1 - t) / (1 + t)),         T w ~ 1 - sqrt((z - 1) / (z + 1))

On the zone itself T w is 1, -1, 1. The rest of W solves the equation of the zones, with T w in
place of the change of the profile. The part -w' contributes the integral of w times the slope of
the change, a principal value.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.polynomial import Chebyshev

import sie
from contact.derivatives.rates import held
from contact.derivatives.sources import InnerPoint, Source, cotangents
from contact.errors import SceneError
from contact.formulation.controls import Load
from contact.formulation.fields import ZoneFields
from contact.formulation.full_contact import FullFields
from contact.formulation.gaps import GapFields
from contact.formulation.problem import Problem
from contact.formulation.quadrature import gauss, over_period
from contact.formulation.tolerances import TOLERANCES
from sie import Array, record

# Number of Gauss nodes on each panel of an integral. Panels are so short that this number of nodes
# is exact to round-off.
NODES = 16


@dataclass(frozen=True)
class Functional:
    """A linear functional of the derivative of a contact along a change of its profile.
    It is a sum of terms, and its value is the derivative of one number. Each field is the factor of
    one derivative.

    ends: of the outward motions of the zones' ends [m] (n, 2). loads: of the loads of the zones
    (n,). approach: of the approach, counted from height 0 of the profile. mean: of the mean height
    of the profile. peak: a place [m], and the factor of the pressure there. tip: of the height at
    the profile's lowest place. slope: a place [m], and the factor of the profile's slope there.
    inside: a point of the body [m], and the factors A, B of Re(A F + B F'), with the transform F of
    the pressure. Zones are in the order of the fields.
    """

    ends: Array
    loads: Array
    approach: float = 0.0
    mean: float = 0.0
    peak: tuple[float, float] | None = None
    tip: float = 0.0
    slope: tuple[float, float] | None = None
    inside: tuple[complex, complex, complex] | None = None

    def at_places(self, tip: float) -> Part:
        """The terms of the functional with the height at `tip`, and with the slope at a place."""
        place, factor = self.slope or (tip, 0.0)
        return np.array([tip, place]), np.array([self.tip, 0.0]), np.array([0.0, factor])

    def plus(self, other: Functional, factor: float) -> Functional:
        """This functional plus `factor` times `other`, which has no peak, slope or inside."""
        return replace(
            self,
            ends=self.ends + factor * other.ends,
            loads=self.loads + factor * other.loads,
            approach=self.approach + factor * other.approach,
            mean=self.mean + factor * other.mean,
            tip=self.tip + factor * other.tip,
        )


# Places x, and the weights of heights and of slopes there.
Part = tuple[Array, Array, Array]


@record
class Weights:
    """A linear functional of a change of the profile.
    It is a weighted sum of the heights and of the slopes of the change at points x.

    x: places [m]. heights, slopes: their weights. error: relative error of the sum.
    """

    x: Array
    heights: Array
    slopes: Array
    error: float

    @classmethod
    def summed(cls, parts: list[Part], error: float) -> Weights:
        """The sum of functionals, each given by its places, height weights and slope weights."""
        x, heights, slopes = (np.concatenate(one) for one in zip(*parts, strict=True))
        return cls(x, heights, slopes, error)

    def of(self, height: Callable[[Array], Array], slope: Callable[[Array], Array]) -> float:
        """Value of the functional for a change of the profile with this height and this slope."""
        return float(self.heights @ height(self.x) + self.slopes @ slope(self.x))


def weights_of(fields: Any, functional: Functional, tip: float) -> Weights:
    """A functional as a sum of weights times heights and slopes of a change of the profile.
    The weights follow from the adjoint equation on the zones of `fields`.

    tip: lowest place of the profile [m].
    """
    if isinstance(fields, GapFields):
        zones = sie.Zones.of(fields.zones, sie.SINGULAR, sie.SINGULAR)
        slopes = np.abs(np.array(fields.gap_slope.edge_slopes))
        slopes = np.array([slopes[1], np.roll(slopes[0], -1)])
        moves = np.ones(slopes.shape, dtype=bool)
    else:
        assert isinstance(fields, ZoneFields)
        solved = fields.solved_zones
        zones, slopes, moves = held(solved), np.array(fields.density.edge_slopes), solved.moves
    with np.errstate(divide="ignore", invalid="ignore"):
        steps = np.where(moves, zones.weight.end_step(1.0, slopes), 0.0)
    return _Adjoint(fields.problem, zones).weights(functional, steps, tip)


@dataclass(frozen=True)
class _Adjoint:
    """The adjoint equation on given zones; its solution gives the weights of a functional."""

    problem: Problem
    zones: sie.Zones
    sources: list[Source] = field(default_factory=list)
    series: list[Chebyshev] = field(default_factory=list)

    def weights(self, functional: Functional, steps: Array, tip: float) -> Weights:
        problem, zones, units = self.problem, self.zones, self.problem.units
        out_of = functional.ends.T * steps * units.length
        root = np.sqrt(zones.half / 2) / np.pi
        for side, end in enumerate((-1, 1)):
            for zone in np.flatnonzero(out_of[side]).tolist():
                factor = -end * out_of[side, zone] * root[zone]
                self.sources.append(Source(zone, float(factor), end))
        if functional.peak is not None:
            self.sources.append(self._at(*functional.peak))
        state = self._solved(functional)
        density = state.density
        found = [self._on_zone(density, k, int(density.sampling[k])) for k in range(len(zones))]
        parts = [(units.x(x), f / units.height, slope / units.slope) for x, f, slope in found]
        if functional.mean:
            x, _, share = over_period(problem.profile)
            parts.append((x, functional.mean * share, np.zeros(len(x))))
        parts.append(functional.at_places(tip))
        return Weights.summed(parts, state.density_error + TOLERANCES.rounding)

    def _at(self, x: float, factor: float) -> Source:
        """The `Source` for `factor` times the derivative of the pressure [Pa] at x [m]."""
        zones, period = self.zones, self.problem.period
        at = np.asarray(self.problem.units.scaled(np.array([x])))
        if period is not None:
            at = sie.wrapped(at, float(zones.a[0]), period)
        zone = int(np.argmin(np.abs(at - zones.middle) / zones.half))
        left = float((at[0] - zones.a[zone]) / zones.half[zone])
        right = float((zones.b[zone] - at[0]) / zones.half[zone])
        factor = factor * self.problem.units.pressure / (np.pi * np.sqrt(left * right))
        return Source(zone, factor, 0, 0.5 * (left - right))

    def _solved(self, functional: Functional) -> sie.AnyState:
        """The part of the weight that has no closed form, as a density on the zones.
        It solves the contact equation with the field of all sources as the change of the profile.
        """
        units = self.problem.units
        jump = functional.loads * units.load
        own = np.array(jump)
        for one in self.sources:
            own[one.zone] += one.on_zone / self.zones.half[one.zone]

        inner = [] if functional.inside is None else [self._inner(*functional.inside)]

        def value(x: Array) -> Array:
            return self._field(x, True) + sum(one.field(x, True) for one in inner)

        def primitive(x: Array) -> Array:
            field = self._field(x, False) + own[self._zone_of(x)]
            return np.asarray(field + sum(one.field(x, False) for one in inner))

        # The whole weight has the moment 0, so that a tilt of the profile does not change the
        # number.
        moment = None if self.problem.moment is None else -sum(one.area for one in self.sources)
        equation = replace(self.problem, moment=moment).equation(
            Load(functional.approach * units.height)
        )
        forcing = sie.Forcing(value, primitive).trusted()
        try:
            return sie.solve_zones(
                replace(equation, forcing=forcing), self.zones, TOLERANCES.rounding
            )
        except (ValueError, sie.SingularSystem) as error:
            raise SceneError(
                f"derivatives by all heights at once could not be computed ({error}): use "
                "`of(number, to=...)` for one parameter at a time, such as "
                "to='profile.height[0]'",
                "number",
            ) from error

    def _inner(self, z: complex, value: complex, rise: complex) -> InnerPoint:
        """The `InnerPoint` of a point z [m] of the body with its two factors, in scaled units."""
        units = self.problem.units
        scaled = complex(float(units.scaled(np.array([z.real]))[0]), z.imag / units.length)
        return InnerPoint(
            scaled,
            value * units.pressure,
            rise * units.pressure / units.length,
            self.problem.period,
        )

    def _zone_of(self, x: Array) -> Any:
        # Every x is assigned to the zone in whose cell it lies. Cells meet in the middles of the
        # gaps. So an end of a zone is assigned correctly even if round-off has moved it out of the
        # zone.
        return np.searchsorted(self._cells[1:-1], x)

    @cached_property
    def _cells(self) -> Array:
        """Borders of the zones' cells: the middles of the gaps, and one outer border on each side.
        With a period, an outer border is in the middle of the outer gap. Without, its distance from
        the zones is half of their total span.
        """
        zones, period = self.zones, self.problem.period
        span = float(zones.b[-1] - zones.a[0])
        rim = 0.5 * (span if period is None else period - span)
        middles = 0.5 * (zones.b[:-1] + zones.a[1:])
        return np.concatenate(([zones.a[0] - rim], middles, [zones.b[-1] + rim]))

    def _field(self, x: Array, slope: bool) -> Array:
        """Sum of T w at x over all sources, or its derivative by x if `slope` is true.
        T w is the transform of the weight w of a source. On the source's own zone it is a constant,
        which is left out here.
        """
        zones, kernel, out = self.zones, self.problem.kernel, np.zeros(np.shape(x))
        of = self._zone_of(x)
        for one in self.sources:
            half = zones.half[one.zone]
            for shift in kernel.poles:
                left = (x - shift - zones.a[one.zone]) / half
                right = (x - shift - zones.b[one.zone]) / half
                away = (of != one.zone) if shift == 0.0 else np.ones(np.shape(x), dtype=bool)
                part = one.field(left[away], right[away], slope)
                out[away] += part / half ** (2 if slope else 1)
        return out + self._smooth(x, slope) if kernel.regular and self.sources else out

    def _smooth(self, x: Array, slope: bool) -> Array:
        """The field `_regular` of all sources at x, or its derivative by x if `slope` is true.
        It is taken from one Chebyshev series for each panel.
        """
        panels, out = self._panels, np.zeros(np.shape(x))
        if not self.series:
            self.series.extend(map(self._series, panels[:-1], panels[1:]))
        of = np.searchsorted(panels[1:-1], x)
        for panel in np.unique(of).tolist():
            here, series = of == panel, self.series[panel]
            out[here] = (series.deriv() if slope else series)(x[here])
        return out

    @cached_property
    def _panels(self) -> Array:
        """Ends of panels that cover all cells and are at most as wide as the kernel's length.
        On a half-plane the regular part of the kernel varies over the period only: one panel is
        enough.
        """
        lo, hi = float(self._cells[0]), float(self._cells[-1])
        length = self.problem.kernel.length
        count = int(np.ceil((hi - lo) / length)) if np.isfinite(length) else 1
        return np.linspace(lo, hi, count + 1)

    def _series(self, lo: float, hi: float) -> Chebyshev:
        """Chebyshev series on [lo, hi] of `_regular`, the smooth part of all sources' field.

        Its degree is doubled until it has settled.
        """
        degree = NODES
        while True:
            found = Chebyshev.interpolate(self._regular, degree, (lo, hi))
            coefficients = np.abs(found.coef)
            last = float(coefficients[-4:].max())
            if last <= TOLERANCES.rounding * coefficients.max() or degree > NODES**2:
                return found
            degree *= 2

    def _regular(self, x: Array) -> Array:
        """Field of all sources at x (n,) with the kernel's regular part, that is, without poles."""
        regular = self.problem.kernel.regular
        assert regular is not None
        xi, weight = self._spread
        return np.asarray(regular(x[:, None], xi) @ weight)

    @cached_property
    def _spread(self) -> tuple[Array, Array]:
        """(scaled positions, weights / pi) of the sums that replace integrals over the sources."""
        zones, length = self.zones, self.problem.kernel.length
        places, weights = [], []
        for one in self.sources:
            half, middle = zones.half[one.zone], zones.middle[one.zone]
            count = 2 * NODES + int(4 * half / length) if np.isfinite(length) else 2 * NODES
            t, weight, at_place = self._rule(one, np.array([0.0, np.pi]), count)
            if at_place is not None:
                t, weight = np.append(t, one.place), np.append(weight, at_place)
            places.append(middle + half * t)
            weights.append(weight / np.pi)
        return np.concatenate(places), np.concatenate(weights)

    def _rule(self, one: Source, cuts: Array, count: int) -> tuple[Array, Array, float | None]:
        """Quadrature of the integral of w g dt on a zone, with a source's singular weight w.
        The function g is smooth. The result is the nodes t, their weights, and the weight of
        g(place), which is None for an end.

        cuts: angles between which g is smooth. count: least number of nodes from 0 to pi.
        """
        if one.end:
            t, weight = _gauss(cuts, count)
            return t, weight * one.weight(t), None
        angle = np.arccos(np.clip(one.place, -1, 1))
        t, weight = _gauss(np.union1d(cuts, _graded(angle, cuts[0], cuts[-1])), count)
        weight = weight * one.weight(t)
        return t, weight, one.area - float(weight.sum())

    def _on_zone(self, density: sie.AnyDensity, zone: int, count: int) -> Part:
        """(scaled positions, weights of the heights, weights of the slopes) on one zone.
        The heights and the slopes are those of a change of the profile.
        """
        half, middle = self.zones.half[zone], self.zones.middle[zone]
        breaks = self._breaks(zone)
        cuts = np.unique(np.concatenate(([0.0, np.pi], np.arccos(np.clip(breaks, -1, 1)))))
        t, weight = _gauss(cuts, count)
        sine = np.sqrt((1 - t) * (1 + t))
        found = [(t, half * weight * sine * density.at_t(zone, t), np.zeros(len(t)))]
        for one in self.sources:
            if one.zone == zone:
                at, slopes, at_place = self._rule(one, cuts, count)
                found.append((at, np.zeros(len(at)), slopes))
                if at_place is not None:
                    found.append((np.array([one.place]), np.zeros(1), np.array([at_place])))
        x, heights, slopes = (np.concatenate(part) for part in zip(*found, strict=True))
        return middle + half * x, heights, slopes

    def _breaks(self, zone: int) -> Array:
        """Positions t on a zone at which the profile is not smooth."""
        problem = self.problem
        at = np.asarray(problem.units.scaled(np.asarray(problem.profile.breakpoints, dtype=float)))
        if problem.period is not None and len(at):
            at = sie.wrapped(at, float(self.zones.a[zone]), problem.period)
        t = (at - self.zones.middle[zone]) / self.zones.half[zone]
        return np.asarray(t[np.abs(t) < 1])


def _graded(place: float, lo: float, hi: float) -> Array:
    """Points of [lo, hi] at distances from `place` that are halved again and again, and `place`.

    They are ends of panels. If a knot of the profile is close to `place`, the integrand beyond the
    knot is a polynomial divided by the distance from `place`. This is nearly singular, so panels
    must be short there.
    """
    away = (hi - lo) * 0.5 ** np.arange(1, 2 * NODES)
    at = np.concatenate(([lo, place, hi], place - away, place + away))
    return np.asarray(np.unique(at[(at >= lo) & (at <= hi)]))


def _gauss(cuts: Array, count: int) -> tuple[Array, Array]:
    """Gauss nodes t = cos(angle) between the `cuts`, and weights for integrals over the angle.
    From 0 to pi there are at least `count` nodes.
    """
    shortest = NODES * np.pi / max(count, 2 * NODES)
    pieces = np.maximum(1, np.ceil(np.diff(cuts) / shortest)).astype(int)
    edges = [np.linspace(a, b, n + 1)[:-1] for a, b, n in zip(cuts, cuts[1:], pieces, strict=False)]
    angle, weights = gauss(np.append(np.concatenate(edges), cuts[-1]), NODES)
    return np.cos(angle), weights


def full_weights(fields: FullFields, functional: Functional, tip: float) -> Weights:
    """Weights of a functional in full contact on a half-plane, where p' = - (E*/2) H f''.
    Here p' is the change of the pressure, f' that of the profile, f'' the slope of f', and H the
    Hilbert transform.

    H f''(x*) is the principal value of (1/L) int f''(x) cot(pi (x* - x) / L) dx. At a point z of
    the body, the transform of p' is (i E* / 2 L) int f''(x) cot(pi (z - x) / L) dx.
    """
    profile, modulus = fields.problem.profile, fields.problem.units.E_star
    period = profile.period
    assert period is not None
    x, _, share = over_period(profile)
    mean = (x, (functional.mean + functional.approach) * share, np.zeros(len(x)))
    parts = [mean, functional.at_places(tip)]

    def around(place: float) -> tuple[Array, Array]:
        """(x - place at nodes x of one period, weights); nodes are denser near `place`."""
        breaks = np.asarray(profile.breakpoints, dtype=float)
        count = max(4 * NODES, int(2 * period / (profile.resolution or period)))
        cuts = (np.append(breaks, np.linspace(0, period, count)) - place) % period
        edges = np.union1d(cuts, _graded(0.0, 0.0, period))
        return gauss(np.union1d(edges, _graded(period, 0.0, period)), NODES)

    if functional.peak is not None:
        place, factor = functional.peak
        at, weight = around(place)
        weight = weight * factor * modulus / (2 * period)
        weight = weight / np.tan(np.pi * at / period)
        at, weight = np.append(place + at, place), np.append(weight, -weight.sum())
        parts.append((at, np.zeros(len(at)), weight))
    if functional.inside is not None:
        z, value, rise = functional.inside
        at, weight = around(z.real)
        first, second, _ = cotangents(1j * z.imag - at, period)
        weight = weight * (0.5j * modulus / np.pi * (value * first + rise * second)).real
        parts.append((z.real + at, np.zeros(len(at)), weight))
    return Weights.summed(parts, TOLERANCES.rounding)
