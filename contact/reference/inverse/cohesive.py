r"""Inverse design under Dugdale's law, for given zones and given cohesive intervals.

A tension s acts on the strips, the parts of the cohesive intervals outside the zones: p = -s there.
X^2 is the product of z - e over all zone ends e, and p is bounded. The function

    X R,   R = M + (2 s/E*)(1/pi) int over the strips of d xi/(X(xi) (z - xi)),

is f' - (2/E*)(1/pi) int p/(z - xi) d xi, and f' is the polynomial part of X R. Outside the zones
X R is the slope of the gap; on the zones p = +-(E*/2)|X| R. M is a polynomial. Linear conditions
determine all coefficients of M but the highest: all zones have one approach, and the gap at every
end of a cohesive interval is the reach w/s, with the work of adhesion w. The highest coefficient is
free and sets the curvature of the body outside the zones. Derived from the solution of N. I.
Muskhelishvili, Singular Integral Equations (1953), ch. 11, that is bounded at the ends, and the
tension of D. S. Dugdale, J. Mech. Phys. Solids 8 (1960) 100, doi 10.1016/0022-5096(60)90013-2.

If z is close to a strip, the integral over this strip is nearly singular. Let b be the width of the
strip, and b zeta^2 and b tau^2 the distances of z and xi from the zone's end. Near this end, 1/X is
a smooth function h divided by the square root of the distance. Then the integral is

    (2/sqrt(b)) [int_0^1 (h(tau) - h(zeta))/(zeta^2 - tau^2) d tau + (h(zeta)/zeta) artanh(zeta or
    1/zeta)].

The first part is smooth. The second part times X is 2 artanh(zeta or 1/zeta), whose integral has a
closed form.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from math import pi

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

from contact.errors import SceneError
from contact.model.checks import finite_or_none, keep, positive
from contact.model.profiles.polynomial import Polynomial
from contact.reference.inverse.designed import exp_of_power_sums
from sie import Array, Mask


@dataclass(frozen=True)
class CohesiveOptions:
    """Number of quadrature nodes, and number of points at which signs are checked."""

    # Number of Gauss nodes of each integral, over a strip of tension or from a zone's end to a
    # point of the gap. The integrals are accurate to 1e-10.
    nodes: int = 90
    sign_points: int = 200  # points in every zone, gap and strip


_OPTIONS = CohesiveOptions()


@dataclass(frozen=True)
class _Strip:
    """A strip of tension, in the coordinate that maps the hull of the zones to [-1, 1].

    It goes from a zone's end outward (direction +-1), or fills a gap between two zones (0). `gap`
    is the number of its gap (0: left of all zones), and `ends` are the zone ends next to it.
    `nodes` and `weights` are a quadrature rule for functions times 1/X over the strip. `h` is 1/X
    at the nodes times the square roots of the distances from `ends`.
    """

    end: float
    width: float
    direction: int
    gap: int
    ends: tuple[float, ...]
    nodes: Array
    weights: Array
    h: Array

    def far(self, t: Array) -> Array:
        """Cauchy integral of 1/X over the strip; X^2 is the product of t - e over all zone ends e.

        The points t of evaluation lie away from the strip.
        """
        return np.asarray((1.0 / (t[..., None] - self.nodes)) @ self.weights)


@dataclass(frozen=True, eq=False)
class CohesiveDesign:
    """An exact isolated contact of given zones and cohesive intervals under Dugdale's law.

    Derived from the general solution of N. I. Muskhelishvili, Singular Integral Equations (1953),
    ch. 11; see the head of this module.

    Parameters
    ----------
    zones : array_like, (n, 2)
        Ends of the zones [m], ascending.
    cohesive : array_like, (m, 2)
        Ends of the cohesive intervals [m], ascending, each with one zone or more strictly inside.
    E_star : float
        Reduced modulus [Pa].
    work : float
        Work of adhesion [J/m^2].
    stress : float
        Tension [Pa]; its reach is work/stress.
    rise : float
        Highest coefficient of M as a Chebyshev series over the hull of the zones; it sets the
        curvature of the body outside.
    given_load : float or None
        The load [N/m], or None. A given load adds one coefficient to M. If the profile would then
        fall to minus infinity on one side, the load adds two, and the second highest coefficient of
        M is zero.

    Attributes
    ----------
    profile : Polynomial
        The profile whose exact contact this is.
    load : float
        Load of all zones less that of the tension [N/m].
    condition : float
        Condition number of the linear conditions for M.
    is_admissible : bool
        Whether p > -stress on the zones, the surfaces are separate outside of them, and the gap is
        below the reach on the intervals only.
    pressure, gap : callable
        p [Pa] and the gap [m] at positions x [m].

    Raises
    ------
    SceneError
        If a value is not positive and finite, or an interval has no zone inside.

    Examples
    --------
    One zone, nearly that of a cylinder.

    >>> import numpy as np
    >>> from contact.inverse import CohesiveDesign
    >>> law = dict(work=2.5e-4, stress=0.02)
    >>> made = CohesiveDesign([[-1.0, 1.0]], [[-1.2, 1.2]], E_star=1.0, rise=0.1, **law)
    >>> bool(np.isclose(made.gap(1.2), 2.5e-4 / 0.02)), float(made.pressure(1.1))
    (True, -0.02)
    """

    zones: Array
    cohesive: Array
    E_star: float
    work: float
    stress: float
    rise: float
    given_load: float | None = None

    def __post_init__(self) -> None:
        keep(self, positive, "E_star", "work", "stress", "rise")
        keep(self, finite_or_none, "given_load")
        for name in ("zones", "cohesive"):
            table = np.array(getattr(self, name), dtype=float)
            shaped = table.ndim == 2 and table.shape[1] == 2 and len(table) > 0
            if not (shaped and np.all(np.diff(table.ravel()) > 0)):
                raise SceneError.of(
                    name, table.tolist(), "an (n, 2) array of ends, strictly increasing"
                )
            object.__setattr__(self, name, table)
        left, right = self.zones.T
        inside = [int(np.sum((left > a) & (right < b))) for a, b in self.cohesive]
        if min(inside) < 1 or sum(inside) != len(self.zones):
            raise SceneError.of(
                "cohesive",
                self.cohesive.tolist(),
                "intervals that each contain a zone, and together contain all zones",
            )

    @property
    def reach(self) -> float:
        """Work of adhesion divided by the tension `stress` [m]: the largest gap with tension."""
        return self.work / self.stress

    # The scaled coordinate is t = (x - middle)/half; it maps the hull of the zones to [-1, 1].
    @cached_property
    def _frame(self) -> tuple[float, float]:
        lo, hi = float(self.zones[0, 0]), float(self.zones[-1, 1])
        return 0.5 * (lo + hi), 0.5 * (hi - lo)

    def _scaled(self, x: ArrayLike) -> Array:
        middle, half = self._frame
        return (np.asarray(x, dtype=float) - middle) / half

    @cached_property
    def _ends(self) -> Array:
        return self._scaled(self.zones).ravel()

    @property
    def _tension(self) -> float:
        """The factor 2 s/(pi E*) in the part of the gap's slope that the tension s causes."""
        return 2 * self.stress / (self.E_star * pi)

    @cached_property
    def _strips(self) -> list[_Strip]:
        starts, stops = self._scaled(self.cohesive).T
        borders = [-np.inf, *self._ends, np.inf]
        found = []
        for gap in range(len(self.zones) + 1):
            left, right = borders[2 * gap : 2 * gap + 2]
            if np.any((starts < left) & (right < stops)):
                found.append(self._strip((left, right), right - left, 0, gap))
                continue
            if gap > 0:
                width = min(stops[stops > left]) - left
                found.append(self._strip((left,), width, 1, gap))
            if gap < len(self.zones):
                width = right - max(starts[starts < right])
                found.append(self._strip((right,), width, -1, gap))
        return found

    def _strip(self, ends: tuple[float, ...], width: float, direction: int, gap: int) -> _Strip:
        if direction:
            tau, weights = _gauss(_OPTIONS.nodes)
            nodes, weights = ends[0] + direction * width * tau**2, 2 * np.sqrt(width) * weights
        else:
            count = _OPTIONS.nodes
            nodes = ends[0] + 0.5 * width * (1 - np.cos((np.arange(count) + 0.5) * pi / count))
            weights = np.full(count, pi / count)
        h = 1.0 / self._root(nodes, ends)
        return _Strip(ends[0], width, direction, gap, ends, nodes, weights * h, h)

    def _root(self, t: Array, without: tuple[float, ...] = ()) -> Array:
        """Signed square root X of the product of t - e over all zone ends e except `without`.

        The points t lie outside the zones.
        """
        ends_right = np.sum(t[..., None] < self._ends, axis=-1)
        factors = [np.ones(t.shape), *(np.abs(t - end) for end in self._ends if end not in without)]
        sign = np.where((ends_right + 1) // 2 % 2, -1.0, 1.0)
        return np.sqrt(np.prod(factors, axis=0)) * sign

    def _smooth_in_own_gap(self, strip: _Strip, t: Array) -> Array:
        """X times the smooth part of the Cauchy integral of 1/X over a strip of tension.
        X is the signed root given by `_root`.

        The points t lie in the strip's own gap. The part in closed form,
        2 direction artanh(zeta or 1/zeta), is left out: see the head of this module.
        """
        difference = 1.0 - 1.0 / (self._root(t, strip.ends)[..., None] * strip.h)
        integral = (difference / (t[..., None] - strip.nodes)) @ strip.weights
        return self._root(t) * np.asarray(integral)

    @cached_property
    def _count(self) -> int:
        """Number of conditions on the polynomial M (head of this module).
        A given `rise` and a given load are not counted.
        """
        return 3 * len(self.cohesive) - 1 + sum(strip.direction == 0 for strip in self._strips)

    def _smooth_slope(self, gap: int, t: Array) -> tuple[Array, Array]:
        """The two parts of the slope of the gap at points t: from M, and from the tension.
        M is the polynomial at the head of this module.

        The first part has one column for each coefficient of M. The artanh of the strips in this
        gap (head of this module) is left out; `_gap_parts` integrates it.
        """
        by_tension = np.zeros(t.shape)
        for strip in self._strips:
            if strip.gap == gap:
                by_tension += self._smooth_in_own_gap(strip, t)
            else:
                by_tension += self._root(t) * strip.far(t)
        modes = chebyshev.chebvander(t, self._degree) * self._root(t)[..., None]
        return modes, self._tension * by_tension

    def _gap_parts(self, gap: int, start: float, stop: Array) -> tuple[Array, Array]:
        """(part of the gap at `stop` from the polynomial M, part from the tension of the strips).
        M is defined at the head of this module.

        Both are integrals of the slope from `start`, the end of a zone. The first has one row for
        each of the P points, and one column for each coefficient of M.
        """
        u, weight = _gauss(_OPTIONS.nodes)
        half = 0.5 * (stop - start)[:, None]
        t = start + half * (1 - np.cos(pi * u))
        modes, rest = self._smooth_slope(gap, t)
        weight = weight * half * pi * np.sin(pi * u)
        out = np.sum(weight * rest, axis=1)
        for strip in self._strips:
            if strip.gap == gap and strip.direction:
                first = _artanh_integral(strip.direction * (start - strip.end), strip.width)
                last = _artanh_integral(strip.direction * (stop - strip.end), strip.width)
                out = out + 2 * self._tension * (last - first)
        return np.einsum("pw,pwk->pk", weight, modes), out

    @cached_property
    def _conditions(self) -> tuple[Array, Array]:
        """(matrix, right side) of the linear conditions on the coefficients of M (module head)."""
        half = self._frame[1]
        conditions = []
        for strip in self._strips:
            if strip.direction:
                stop = np.array([strip.end + strip.direction * strip.width])
                per_mode, rest = self._gap_parts(strip.gap, strip.end, stop)
                conditions.append((per_mode[0], self.reach / half - rest[0]))
        for gap in range(1, len(self.zones)):
            start, stop = self._ends[2 * gap - 1], self._ends[2 * gap : 2 * gap + 1]
            per_mode, rest = self._gap_parts(gap, start, stop)
            conditions.append((per_mode[0], -rest[0]))
        units = np.eye(self._degree + 1)
        conditions.append((units[-1], self.rise))
        if self.given_load is not None:
            # The load times `_load_unit` is the coefficient of 1/t in the series of X R, the slope
            # of the gap. This coefficient is linear in the coefficients of the polynomial M.
            per_mode = np.array([self._series_of(unit, 0.0)[-1] for unit in units])
            of_tension = self._series_of(0.0 * units[0], self._tension)[-1]
            conditions.append((per_mode, self._load_unit * self.given_load - of_tension))
        if len(conditions) < len(units):
            conditions.append((units[-2], 0.0))
        matrix, values = (np.array(part) for part in zip(*conditions, strict=True))
        size = np.abs(matrix).max(axis=1)
        return matrix / size[:, None], values / size

    @cached_property
    def _smooth(self) -> Array:
        """Coefficients of the polynomial M (module head): a Chebyshev series on the zones' hull."""
        return np.asarray(np.linalg.solve(*self._conditions))

    @property
    def condition(self) -> float:
        """Condition number of the matrix of conditions; the largest entry of each row is one."""
        return float(np.linalg.cond(self._conditions[0]))

    @property
    def _degree(self) -> int:
        """Degree of the polynomial M in the slope of the gap (head of this module)."""
        if self.given_load is None:
            return self._count
        return self._count + 1 + (len(self.zones) + self._count) % 2

    @property
    def _load_unit(self) -> float:
        return -1.0 / (pi * self._frame[1] * 0.5 * self.E_star)

    @cached_property
    def _series(self) -> Array:
        return self._series_of(self._smooth, self._tension)

    def _series_of(self, smooth: Array, tension: float) -> Array:
        """Coefficients of the slope of the gap, in powers of t from the highest down to t^-1.

        `smooth` are the coefficients of M, and `tension` is the factor of the strips' integrals.
        """
        nodes = np.concatenate([strip.nodes for strip in self._strips])
        weights = np.concatenate([strip.weights for strip in self._strips])
        moments = weights @ np.vander(nodes, len(self.zones) + 1, increasing=True)
        ratio = np.concatenate([chebyshev.cheb2poly(smooth)[::-1], tension * moments])
        power_sums = np.array([0.5 * np.sum(self._ends**k) for k in range(len(ratio))])
        root = exp_of_power_sums(power_sums).real
        return np.asarray(np.convolve(root, ratio)[: len(ratio)])

    @cached_property
    def profile(self) -> Polynomial:
        """The profile whose exact contact this is."""
        middle, half = self._frame
        slope = np.polynomial.Polynomial(self._series[:-1][::-1], (middle - half, middle + half))
        return Polynomial(slope.integ(lbnd=middle).convert(domain=(-1.0, 1.0)).coef)

    @property
    def load(self) -> float:
        """Load [N/m]: the force that the zones carry, minus the integral of the strips' tension."""
        return float(self._series[-1] / self._load_unit)

    def pressure(self, x: ArrayLike) -> Array:
        """Pressure p(x) [Pa]: -stress on the strips, 0 outside the cohesive intervals."""
        t = self._scaled(x)
        zone = np.searchsorted(self._ends, t)
        out, inside = np.where(self._is_cohesive(x), -self.stress, 0.0), zone % 2 == 1
        if inside.any():
            inner = t[inside]
            size = np.sqrt(np.prod(np.abs(inner[:, None] - self._ends), axis=1))
            sign = np.where((len(self.zones) - (zone[inside] + 1) // 2) % 2, -1.0, 1.0)
            by_tension = sum(self._on_zones(strip, inner) for strip in self._strips)
            ratio = chebyshev.chebval(inner, self._smooth) + self._tension * by_tension
            out[inside] = 0.5 * self.E_star * sign * size * ratio
        return out

    def _is_cohesive(self, x: ArrayLike) -> Mask:
        """Mask of the points in the cohesive intervals."""
        x = np.asarray(x, dtype=float)[..., None]
        return np.any((x >= self.cohesive[:, 0]) & (x <= self.cohesive[:, 1]), axis=-1)

    def _on_zones(self, strip: _Strip, t: Array) -> Array:
        """Cauchy integral of 1/X over a strip; X^2 is the product of t - e over all zone ends e.

        The points t lie on the zones. The integral is accurate up to the end of the strip.
        """
        distance = np.min([np.abs(t - end) for end in strip.ends], axis=0)
        low, high = np.sort([strip.end, strip.end + (strip.direction or 1) * strip.width])
        close = (distance < 0.5 * strip.width) & ((t > high) | (t < low))
        if strip.direction:
            close &= (t - strip.end) * strip.direction < 0
        out = strip.far(t)
        if close.any():
            at = t[close]
            # Near the strip, 1/X is a smooth factor h divided by a square root (X: see `_root`).
            # Here h is evaluated at points of the zone next to the strip.
            factors = [np.abs(at - end) for end in self._ends if end not in strip.ends]
            h = np.sign(strip.h[0]) / np.sqrt(np.prod(factors, axis=0))
            difference = (1 - h[:, None] / strip.h) / (at[:, None] - strip.nodes)
            out[close] = difference @ strip.weights
            if strip.direction:
                # On the zone the scaled distance zeta^2 (head of this module) is negative, so that
                # artanh becomes arctan.
                eta = np.sqrt(distance[close] / strip.width)
                unit = strip.direction * 2 / np.sqrt(strip.width)
                out[close] -= unit * h * np.arctan(1 / eta) / eta
            else:
                root = np.sqrt(np.abs((at - low) * (at - high)))
                out[close] += np.sign(at - low) * pi * h / root
        return out

    def gap(self, x: ArrayLike) -> Array:
        """The gap [m]: the integral of the slope of the gap from the end of the nearest zone."""
        t = np.atleast_1d(self._scaled(x)).ravel()
        out, interval = np.zeros(t.shape), np.searchsorted(self._ends, t)
        for i in np.unique(interval[interval % 2 == 0]):
            ends = [self._ends[k] for k in (i - 1, i) if 0 <= k < len(self._ends)]
            nearest = np.argmin([np.abs(t - end) for end in ends], axis=0)
            for which, start in enumerate(ends):
                here = (interval == i) & (nearest == which)
                if here.any():
                    per_mode, rest = self._gap_parts(int(i) // 2, float(start), t[here])
                    out[here] = self._frame[1] * (per_mode @ self._smooth + rest)
        return np.asarray(out.reshape(np.shape(x)))

    @cached_property
    def is_admissible(self) -> bool:
        """Whether Dugdale's law holds at sample points of every zone, gap and strip.

        Points outside all cohesive intervals are checked as well.
        """
        points = _OPTIONS.sign_points
        u = 0.5 - 0.5 * np.cos(pi * (np.arange(points) + 0.5) / points)
        inner = (self.zones[:, :1] + np.diff(self.zones) * u).ravel()
        if not np.all(self.pressure(inner) > -self.stress):
            return False
        lo, hi = self.cohesive[0, 0], self.cohesive[-1, 1]
        distance = (hi - lo) * np.geomspace(1e-3, 30.0, min(points, 60))
        outside = np.concatenate((hi + distance, lo - distance))
        if not np.all(self.gap(outside) > self.reach):
            return False
        ends = self.zones.ravel()
        for a, b in zip(ends[1:-1:2], ends[2::2], strict=True):
            x = a + (b - a) * u
            gap = self.gap(x)
            if not (np.all(gap > 0) and np.all((gap < self.reach) == self._is_cohesive(x))):
                return False
        strips = np.concatenate((lo + (ends[0] - lo) * u, hi - (hi - ends[-1]) * u))
        gap = self.gap(strips)
        return bool(np.all(gap > 0) and np.all(gap < self.reach))


@lru_cache(maxsize=64)
def _gauss(count: int) -> tuple[Array, Array]:
    """Nodes and weights of the Gauss-Legendre rule on (0, 1)."""
    x, weight = np.polynomial.legendre.leggauss(count)
    return 0.5 * (1 + x), 0.5 * weight


def _artanh_integral(y: ArrayLike, width: float) -> Array:
    """Integral over s from 0 to y of artanh(sqrt(s/w)), or of artanh(sqrt(w/s)) where s > w.

    Here w is the width; the integral has a closed form.
    """
    y = np.asarray(y, dtype=float)
    ratio = np.minimum(y, width) / np.maximum(y, width)
    with np.errstate(divide="ignore", invalid="ignore"):
        rest = (y - width) * np.arctanh(np.sqrt(ratio))
    return np.asarray(np.where(np.isfinite(rest), rest, 0.0) + np.sqrt(width * np.maximum(y, 0.0)))
