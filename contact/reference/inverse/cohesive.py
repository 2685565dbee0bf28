r"""Inverse design under a tension of finite range: exact contacts of given zones beside which a
stress s pulls on given intervals.

With X^2 the product over all zone ends, p = -s on the strips between the zones and the ends of
their intervals, and p bounded, the function

    X R,   R = M + (2 s/E*)(1/pi) int over the strips of d xi/(X(xi) (z - xi)),

is f' - (2/E*)(1/pi) int p/(z - xi) d xi, f' its polynomial part: beside the zones it is the slope
of the gap, on the zones p = +-(E*/2)|X| R. M is a polynomial. Its lower coefficients follow from
linear conditions: one approach of all zones, and the reach w/s as the gap at every end of an
interval; its highest one is free and says how sharply the body curves away. Derived from the
general solution of N. I. Muskhelishvili, Singular Integral Equations (1953), ch. 11, which is
bounded at the ends, and the tension of D. S. Dugdale, J. Mech. Phys. Solids 8 (1960) 100, doi
10.1016/0022-5096(60)90013-2.

At a strip of width w the integral over it is, with zeta the root of the distance from the zone's
end over w and 1/X = h/root(distance),

    (2/root(w)) [int_0^1 (h(tau) - h(zeta))/(zeta^2 - tau^2) d tau + (h(zeta)/zeta) artanh(zeta or
    1/zeta)],

whose first part is smooth, and whose second, times X, is 2 artanh(zeta or 1/zeta), with an integral
in closed form.
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

# Gauss's nodes on a strip, on a way to the gap at a place, and places at which signs are looked at.
_NODES = 64
_WAY = 90
_LOOKS = 200
_FEW_LOOKS = 12
# Over what the intervals span, how far beyond it is looked at.
_BEYOND = np.geomspace(1e-3, 30.0, 60)


@dataclass(frozen=True)
class _Strip:
    """A strip from a zone's end outward (direction +-1), or a whole gap between two zones (0), in
    scaled coordinates. gap: in which (0: left of all zones); ends: those of zones that it is at;
    nodes, weights: of 1/X on it; h: 1/X there times the roots of the distances from its ends.
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
        """int d xi/(X (t - xi)) at places away from it."""
        return np.asarray((1.0 / (t[..., None] - self.nodes)) @ self.weights)


@dataclass(frozen=True, eq=False)
class CohesiveDesign:
    """An exact contact of given zones with a constant tension beside them, on given intervals that
    hold the zones; the body is alone.

    Derived from the general solution of N. I. Muskhelishvili, Singular Integral Equations (1953),
    ch. 11; see the head of this module.

    Parameters
    ----------
    zones : array_like, (n, 2)
        Ends of the zones [m], ascending.
    cohesive : array_like, (m, 2)
        Ends of the intervals on which the surfaces pull [m], ascending, each with one zone or more
        strictly within.
    E_star : float
        Reduced modulus [Pa].
    work : float
        Work of adhesion [J/m^2].
    stress : float
        Tension [Pa]; its reach is work/stress.
    rise : float
        Highest coefficient of M, in Chebyshev polynomials over the hull of the zones: how sharply
        the body curves away from it.
    given_load : float or None
        The load [N/m], where M has a coefficient more for it; or two, of which one is zero, so that
        the body rises on either side.

    Attributes
    ----------
    profile : Polynomial
        The shape that has this contact.
    load : float
        Of all zones less the tension [N/m].
    condition : float
        Condition number of the linear conditions that M follows from.
    is_admissible : bool
        Whether the surfaces press on the zones with more than -stress, keep apart elsewhere, and
        are nearer than the reach on the intervals alone.
    pressure, gap : callable
        p [Pa] and the gap [m] at positions x [m].

    Raises
    ------
    SceneError
        If a value is not positive and finite, zones and intervals do not lie as they must.

    Examples
    --------
    One zone alone, nearly that of a cylinder.

    >>> import numpy as np
    >>> from contact.inverse import CohesiveDesign
    >>> made = CohesiveDesign([[-1.0, 1.0]], [[-1.2, 1.2]], E_star=1.0, work=2.5e-4, stress=0.02, rise=0.1)
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
            if (
                table.ndim != 2
                or table.shape[1] != 2
                or not len(table)
                or not np.all(np.diff(table.ravel()) > 0)
            ):
                raise SceneError.of(
                    name, table.tolist(), "an (n, 2) array of ends, strictly increasing"
                )
            object.__setattr__(self, name, table)
        held = [
            int(np.sum((self.zones[:, 0] > a) & (self.zones[:, 1] < b))) for a, b in self.cohesive
        ]
        if min(held) < 1 or sum(held) != len(self.zones):
            raise SceneError.of(
                "cohesive",
                self.cohesive.tolist(),
                "intervals that each hold a zone, and together all of them",
            )

    @property
    def reach(self) -> float:
        """Work over stress [m]."""
        return self.work / self.stress

    # scaled: t = (x - middle)/half over the hull of the zones
    # -------------------------------------------------------------------
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
        """Of the slope: 2 s/(E* pi)."""
        return 2 * self.stress / (self.E_star * pi)

    @cached_property
    def _strips(self) -> list[_Strip]:
        intervals = self._scaled(self.cohesive)
        beyond = [-np.inf, *self._ends, np.inf]
        found = []
        for gap in range(len(self.zones) + 1):
            left, right = beyond[2 * gap : 2 * gap + 2]
            if np.any((intervals[:, 0] < left) & (right < intervals[:, 1])):
                found.append(self._strip((left, right), right - left, 0, gap))
                continue
            if gap > 0:
                found.append(
                    self._strip((left,), min(b for b in intervals[:, 1] if b > left) - left, 1, gap)
                )
            if gap < len(self.zones):
                found.append(
                    self._strip(
                        (right,), right - max(a for a in intervals[:, 0] if a < right), -1, gap
                    )
                )
        return found

    def _strip(self, ends: tuple[float, ...], width: float, direction: int, gap: int) -> _Strip:
        if direction:
            tau, weights = _gauss(_NODES)
            nodes, weights = ends[0] + direction * width * tau**2, 2 * np.sqrt(width) * weights
        else:
            nodes = ends[0] + 0.5 * width * (1 - np.cos((np.arange(_WAY) + 0.5) * pi / _WAY))
            weights = np.full(_WAY, pi / _WAY)
        h = 1.0 / self._root(nodes, ends)
        return _Strip(ends[0], width, direction, gap, ends, nodes, weights * h, h)

    def _root(self, t: Array, without: tuple[float, ...] = ()) -> Array:
        """X off the zones, but for the roots of the distances from some ends."""
        past = np.sum(t[..., None] < self._ends, axis=-1)
        factors = [np.ones(t.shape), *(np.abs(t - end) for end in self._ends if end not in without)]
        return np.sqrt(np.prod(factors, axis=0)) * np.where((past + 1) // 2 % 2, -1.0, 1.0)

    def _near(self, strip: _Strip, t: Array) -> Array:
        """X times the same in the strip's own gap, but for 2 direction artanh."""
        away = 1.0 - 1.0 / (self._root(t, strip.ends)[..., None] * strip.h)
        return self._root(t) * np.asarray((away / (t[..., None] - strip.nodes)) @ strip.weights)

    @cached_property
    def _count(self) -> int:
        """Conditions on M, one less than its coefficients."""
        return 3 * len(self.cohesive) - 1 + sum(strip.direction == 0 for strip in self._strips)

    def _smooth_slope(self, gap: int, t: Array) -> tuple[Array, Array]:
        """Slope of the gap but for the artanh of strips in the same gap: (by the coefficients of M,
        by the tension).
        """
        by_tension = np.zeros(t.shape)
        for strip in self._strips:
            by_tension += self._near(strip, t) if strip.gap == gap else self._root(t) * strip.far(t)
        modes = chebyshev.chebvander(t, self._degree) * self._root(t)[..., None]
        return modes, self._tension * by_tension

    def _risen(self, gap: int, start: float, stop: Array) -> tuple[Array, Array]:
        """int of the slope from the end of a zone to places (P,) of the gap beside it: by the
        coefficients, and by the tension.
        """
        u, weight = _gauss(_WAY)
        half = 0.5 * (stop - start)[:, None]
        t = start + half * (1 - np.cos(pi * u))
        modes, rest = self._smooth_slope(gap, t)
        weight = weight * half * pi * np.sin(pi * u)
        out = np.sum(weight * rest, axis=1)
        for strip in self._strips:
            if strip.gap == gap and strip.direction:
                before, after = (
                    _risen(strip.direction * (place - strip.end), strip.width)
                    for place in (np.array(start), stop)
                )
                out = out + 2 * self._tension * (after - before)
        return np.einsum("pw,pwk->pk", weight, modes), out

    @cached_property
    def _conditions(self) -> tuple[Array, Array]:
        """(matrix, right side) of the coefficients of M."""
        half = self._frame[1]
        conditions = []
        for strip in self._strips:
            if strip.direction:
                by, rest = self._risen(
                    strip.gap, strip.end, np.array([strip.end + strip.direction * strip.width])
                )
                conditions.append((by[0], self.reach / half - rest[0]))
        for gap in range(1, len(self.zones)):
            by, rest = self._risen(gap, self._ends[2 * gap - 1], self._ends[2 * gap : 2 * gap + 1])
            conditions.append((by[0], -rest[0]))
        every = np.eye(self._degree + 1)
        conditions.append((every[-1], self.rise))
        if self.given_load is not None:
            # Of the last coefficient of the series, which is the load, what each of M's and the
            # tension make.
            by_load = np.array([self._series_of(unit, 0.0)[-1] for unit in every])
            conditions.append(
                (
                    by_load,
                    self._load_unit * self.given_load
                    - self._series_of(0.0 * every[0], self._tension)[-1],
                )
            )
        if len(conditions) < len(every):
            conditions.append((every[-2], 0.0))
        matrix, values = (np.array(part) for part in zip(*conditions, strict=True))
        size = np.abs(matrix).max(axis=1)
        return matrix / size[:, None], values / size

    @cached_property
    def _smooth(self) -> Array:
        """Coefficients of M."""
        return np.asarray(np.linalg.solve(*self._conditions))

    @property
    def condition(self) -> float:
        """Condition number of the linear conditions, the largest entry of each being one."""
        return float(np.linalg.cond(self._conditions[0]))

    @property
    def _degree(self) -> int:
        """Of M."""
        if self.given_load is None:
            return self._count
        return self._count + 1 + (len(self.zones) + self._count) % 2

    @property
    def _load_unit(self) -> float:
        return -1.0 / (pi * self._frame[1] * 0.5 * self.E_star)

    # what it comes to
    # -------------------------------------------------------------------------------------------------------------
    @cached_property
    def _series(self) -> Array:
        return self._series_of(self._smooth, self._tension)

    def _series_of(self, smooth: Array, tension: float) -> Array:
        """Coefficients of X R, of t^N, t^(N-1), ..., t^-1, of an M and a tension."""
        nodes = np.concatenate([strip.nodes for strip in self._strips])
        weights = np.concatenate([strip.weights for strip in self._strips])
        moments = weights @ np.vander(nodes, len(self.zones) + 1, increasing=True)
        ratio = np.concatenate([chebyshev.cheb2poly(smooth)[::-1], tension * moments])
        root = exp_of_power_sums(
            np.array([0.5 * np.sum(self._ends**k) for k in range(len(ratio))])
        ).real
        return np.asarray(np.convolve(root, ratio)[: len(ratio)])

    @cached_property
    def profile(self) -> Polynomial:
        """The shape with this contact."""
        middle, half = self._frame
        slope = np.polynomial.Polynomial(self._series[:-1][::-1], (middle - half, middle + half))
        return Polynomial(slope.integ(lbnd=middle).convert(domain=(-1.0, 1.0)).coef)

    @property
    def load(self) -> float:
        """Of all zones less the tension [N/m]."""
        return float(self._series[-1] / self._load_unit)

    def pressure(self, x: ArrayLike) -> Array:
        """p [Pa]."""
        t = self._scaled(x)
        zone = np.searchsorted(self._ends, t)
        out, on = np.where(self._pulled(x), -self.stress, 0.0), zone % 2 == 1
        if on.any():
            inner = t[on]
            size = np.sqrt(np.prod(np.abs(inner[:, None] - self._ends), axis=1))
            sign = np.where((len(self.zones) - (zone[on] + 1) // 2) % 2, -1.0, 1.0)
            ratio = chebyshev.chebval(inner, self._smooth) + self._tension * sum(
                self._beside(strip, inner) for strip in self._strips
            )
            out[on] = 0.5 * self.E_star * sign * size * ratio
        return out

    def _pulled(self, x: ArrayLike) -> Mask:
        """Whether places are on the intervals."""
        x = np.asarray(x, dtype=float)[..., None]
        return np.any((x >= self.cohesive[:, 0]) & (x <= self.cohesive[:, 1]), axis=-1)

    def _beside(self, strip: _Strip, t: Array) -> Array:
        """int d xi/(X (t - xi)) on zones, however near to the strip."""
        away = np.min([np.abs(t - end) for end in strip.ends], axis=0)
        low, high = np.sort([strip.end, strip.end + (strip.direction or 1) * strip.width])
        near = (away < 0.5 * strip.width) & ((t > high) | (t < low))
        if strip.direction:
            near &= (t - strip.end) * strip.direction < 0
        out = strip.far(t)
        if near.any():
            at = t[near]
            # h, continued from the strip onto the zones that it begins at.
            others = np.prod(
                [np.abs(at - end) for end in self._ends if end not in strip.ends], axis=0
            )
            value = np.sign(strip.h[0]) / np.sqrt(others)
            out[near] = (
                (1 - value[:, None] / strip.h) / (at[:, None] - strip.nodes)
            ) @ strip.weights
            if strip.direction:
                # zeta is imaginary: the same form, an arcus tangens.
                eta = np.sqrt(away[near] / strip.width)
                out[near] -= (
                    strip.direction * 2 / np.sqrt(strip.width) * value * np.arctan(1 / eta) / eta
                )
            else:
                out[near] += (
                    np.sign(at - low) * pi * value / np.sqrt(np.abs((at - low) * (at - high)))
                )
        return out

    def gap(self, x: ArrayLike) -> Array:
        """The gap [m], from the end of the nearest zone on."""
        t = np.atleast_1d(self._scaled(x)).ravel()
        out, zone = np.zeros(t.shape), np.searchsorted(self._ends, t)
        for beside in np.unique(zone[zone % 2 == 0]):
            ends = [self._ends[k] for k in (beside - 1, beside) if 0 <= k < len(self._ends)]
            nearest = np.argmin([np.abs(t - end) for end in ends], axis=0)
            for which, start in enumerate(ends):
                here = (zone == beside) & (nearest == which)
                if here.any():
                    by, rest = self._risen(int(beside) // 2, float(start), t[here])
                    out[here] = self._frame[1] * (by @ self._smooth + rest)
        return np.asarray(out.reshape(np.shape(x)))

    @cached_property
    def is_admissible(self) -> bool:
        """By signs at many places; at a few of them first."""
        return self._signs_are_right(_FEW_LOOKS) and self._signs_are_right(_LOOKS)

    def _signs_are_right(self, looks: int) -> bool:
        u = 0.5 - 0.5 * np.cos(pi * (np.arange(looks) + 0.5) / looks)
        inner = (self.zones[:, :1] + np.diff(self.zones) * u).ravel()
        if not np.all(self.pressure(inner) > -self.stress):
            return False
        lo, hi = self.cohesive[0, 0], self.cohesive[-1, 1]
        beyond = (hi - lo) * _BEYOND[:: len(_BEYOND) // min(looks, len(_BEYOND))]
        if not (
            np.all(self.gap(hi + beyond) > self.reach)
            and np.all(self.gap(lo - beyond) > self.reach)
        ):
            return False
        ends = self.zones.ravel()
        for a, b in zip(ends[1:-1:2], ends[2::2], strict=True):
            x = a + (b - a) * u
            gap = self.gap(x)
            if not (np.all(gap > 0) and np.all((gap < self.reach) == self._pulled(x))):
                return False
        strips = np.concatenate((lo + (ends[0] - lo) * u, hi - (hi - ends[-1]) * u))
        gap = self.gap(strips)
        return bool(np.all(gap > 0) and np.all(gap < self.reach))


@lru_cache(maxsize=64)
def _gauss(count: int) -> tuple[Array, Array]:
    """Gauss's rule on (0, 1)."""
    x, weight = np.polynomial.legendre.leggauss(count)
    return 0.5 * (1 + x), 0.5 * weight


def _risen(y: Array, width: float) -> Array:
    """int_0^y artanh of the root of y/w or w/y."""
    ratio = np.minimum(y, width) / np.maximum(y, width)
    with np.errstate(divide="ignore", invalid="ignore"):
        rest = (y - width) * np.arctanh(np.sqrt(ratio))
    return np.asarray(np.where(np.isfinite(rest), rest, 0.0) + np.sqrt(width * np.maximum(y, 0.0)))
