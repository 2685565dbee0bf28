"""Maugis-Dugdale adhesion of one zone |x| <= a: a tension s acts on a < |x| < c.

The pressure is bounded at the ends of the zone. The gap at c is w/s, w the work of adhesion. In the
superposition of base.py the tension is a set of flat punches of negative load, whose half widths
lie between a and c. Their total load is -2 s B. The formulas use the length B and the numbers l
and r. With u = pi x/L, A = pi a/L, C = pi c/L,

    isolated    B = sqrt(c^2 - a^2)                 l = arcosh(c/a)            r = ln(c/a)
    periodic    B = (L/pi) arccos(cos C/cos A)      l = arcosh(sin C/sin A)    r = ln(tan C/tan A)

    pressure    p = p_0 - (2s/pi) arctan(sqrt((c^2 - a^2)/(a^2 - x^2)))
                p = p_0 - (2s/pi) arctan((cos u/cos C) sqrt((sin^2 C - sin^2 A)/(sin^2 A - sin^2
                u)))
    gap         g = g_0 + (4s/pi E*) int_a^x artanh(X or 1/X) dx,
                X = sqrt((x^2 - a^2)/(c^2 - a^2)) isolated,
                X = cos C sqrt(cos^2 A - cos^2 u)/(cos u sqrt(cos^2 A - cos^2 C))
    at c        d g/dc = g_0' + (4s/pi E*)(l dB/dc - r),   d g/da = -(2/pi E*) l d P/da
    approach    d_0 - 2s int K dB,   d/dc = -2s (K dB/dc - (2/pi E*) l),   d/da = K d P/da

Here p_0, g_0 and d_0 are the pressure, gap and approach of the frictionless zone of half width a,
and P_0 its load, so that P = P_0 - 2 s B. K is the compliance of the flat punch of half width a. In
the integral, K belongs to the punch that is added in the step dB; its half width lies between a and
c. The artanh is taken of X or of 1/X, whichever is below 1. D. Maugis, J. Colloid Interface Sci.
150 (1992) 243-269, doi 10.1016/0021-9797(92)90285-T; cylinder: J. M. Baney & C.-Y. Hui, J. Adhes.
Sci. Technol. 11 (1997) 393-406, derived again; periodic wave: derived here. When c reaches L/2 the
tension acts on the whole gap: the state is then the frictionless zone under a uniform tension.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import atan2, exp, log, pi, sqrt

import numpy as np
from numpy.typing import ArrayLike

from contact.errors import OutOfRange, SceneError
from contact.model.checks import between, positive
from contact.reference.exact.adhesion import AdhesiveZone, Cylinder, Equilibria, Wave
from contact.reference.exact.base import IsolatedZone, PeriodicZone
from contact.reference.exact.numerics import (
    Array,
    arcosh1p,
    cosine,
    integrated,
    root,
    sine,
    sine_excess,
)


class _DugdaleState(AdhesiveZone):
    """Base class of the equilibria of one contact zone with a uniform tension next to it."""

    stress: float
    cohesive_end: float

    def pressure(self, x: ArrayLike) -> Array:
        """Pressure p(x) [Pa], negative where the tension acts.
        It is -`stress` for half width <= |x| < `cohesive_end`, and 0 farther out.
        """
        r = np.abs(self._reduced(x))
        cohesive = (r >= self.half_width) & (r < self.cohesive_end)
        return np.where(cohesive, -self.stress, super().pressure(x))


@dataclass(frozen=True)
class DugdaleZone(_DugdaleState):
    """Maugis-Dugdale adhesion of one zone |x| <= a, with the tension s on a < |x| < c.

    The pressure is bounded at the ends; the work of adhesion is the stress times the gap at c. With
    the pressure p_0 and the load P_0 of the frictionless zone, the isolated zone has
    p = p_0 - (2s/pi) arctan(sqrt((c^2 - a^2)/(a^2 - x^2))) and P = P_0 - 2 s sqrt(c^2 - a^2). The
    formulas with a period are at the head of this module. Energies are in `AdhesiveZone`, fields in
    `SymmetricZone`. D. Maugis, J. Colloid Interface Sci. 150 (1992) 243-269, doi
    10.1016/0021-9797(92)90285-T; in the plane J. M. Baney & C.-Y. Hui, J. Adhes. Sci. Technol. 11
    (1997) 393-406, derived again.

    Parameters
    ----------
    zone : IsolatedZone or PeriodicZone
        The frictionless solution of the same half width, such as `HertzLine` or `Westergaard`.
    stress : float
        Cohesive stress s [Pa].
    cohesive_end : float
        c, above a, and below L/2 with a period [m].

    Attributes
    ----------
    work : float
        Work of adhesion of this state [J/m^2].
    end_gap : float
        The gap at c [m].
    rates : callable
        d load/dc and d approach/dc along the curve of equilibria.

    Raises
    ------
    SceneError
        If the zone is no frictionless solution, the stress not positive and finite, or c not above
        a.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.exact import DugdaleZone, HertzLine
    >>> hertz = HertzLine(radius=1e-3, E_star=1e9, half_width=3e-5)
    >>> state = DugdaleZone(hertz, stress=1e5, cohesive_end=5e-5)
    >>> bool(np.isclose(state.load, hertz.load - 2e5 * 4e-5))
    True
    >>> bool(np.isclose(state.pressure(4e-5), -1e5))
    True
    """

    zone: IsolatedZone | PeriodicZone
    stress: float
    cohesive_end: float

    def __post_init__(self) -> None:
        self._check_zone()
        positive("stress", self.stress)
        widest = 1e300 if self.period is None else 0.5 * self.period
        between("cohesive_end", self.cohesive_end, self.half_width, widest)

    # The next methods evaluate the closed forms at the head of this file.
    @property
    def root(self) -> float:
        """The root sqrt(c^2 - a^2) of the half width a and the end c of the tension.

        With a period it is sqrt(sin^2(pi c/L) - sin^2(pi a/L)).
        """
        a, c = self.half_width, self.cohesive_end
        return sqrt(float(sine(c - a, self.period) * sine(c + a, self.period)))

    @property
    def share(self) -> float:
        """The length B in the load P = P_0 - 2 s B, where the tension s contributes -2 s B."""
        if self.period is None:
            return self.root
        return self._sine_unit * atan2(self.root, float(cosine(self.cohesive_end, self.period)))

    def opening_rate(self, e: Array, f: Array) -> Array:
        """Slope at x = a + e of the gap that the tension s adds, divided by 4s/(pi E*).

        It is artanh(X), or artanh(1/X) if X > 1. X is sqrt((x^2 - a^2)/(c^2 - a^2)) for an isolated
        zone, with the zone's end a, the end c of the tension and the point x. The arguments are the
        distances e = x - a and f = c - x. X^2 and |1 - X^2| are formed from the distances, so that
        nothing cancels near a or c.
        """
        a, c, length = self.half_width, self.cohesive_end, self.period
        x = a + e
        scale = sine(c - a, length) * sine(c + a, length)
        scale = scale * np.maximum(cosine(x, length), 1e-100) ** 2
        square = sine(e, length) * sine(x + a, length) * cosine(c, length) ** 2 / scale
        rest = np.abs(sine(f, length)) * sine(c + x, length) * cosine(a, length) ** 2 / scale
        # `square` is X^2 and `rest` is |1 - X^2|. So artanh is computed as arsinh:
        # artanh X = arsinh(X/sqrt(1 - X^2)) and artanh(1/X) = arsinh(1/sqrt(X^2 - 1)).
        return np.asarray(np.arcsinh(np.sqrt(np.minimum(square, 1.0) / np.maximum(rest, 1e-300))))

    @property
    def end_gap(self) -> float:
        """The gap [m] at the end c of the tension, which acts on a < |x| < c."""
        return float(self._gap(np.array(self.cohesive_end - self.half_width)))

    @property
    def work(self) -> float:  # type: ignore[override]
        """The work of adhesion of this equilibrium [J/m^2]: stress times the gap where tension
        ends.
        """
        return self.stress * self.end_gap

    def _pressure(self, r: Array, d: Array) -> Array:
        a, length = self.half_width, self.period
        depth = np.sqrt(sine(d, length) * sine(a + r, length)) * cosine(self.cohesive_end, length)
        side = self.root * cosine(a, length, d)
        return self.zone._pressure(r, d) - 2.0 * self.stress / pi * np.arctan2(side, depth)

    def _gap(self, e: Array) -> Array:
        # The integrand is singular at the end c of the tension, so the integral is split at c.
        length = self.cohesive_end - self.half_width
        e = np.asarray(e, dtype=float)
        inside, outside = np.minimum(e, length), np.maximum(e - length, 0.0)
        to_end = (length - inside)[..., None]
        before = integrated(lambda y, rest: self.opening_rate(y, to_end + rest), inside)
        after = integrated(lambda y, _: self.opening_rate(length + y, y), outside)
        return super()._gap(e) + self._unit * (before + after)

    @property
    def _unit(self) -> float:
        """The factor 4s/(pi E*) in the formula for the gap that the tension s adds."""
        return 4.0 * self.stress / (pi * self.E_star)

    @property
    def load(self) -> float:
        return self.zone.load - 2.0 * self.stress * self.share

    @property
    def load_by_half_width(self) -> float:
        """Derivative of the load by the half width a, at a fixed end c of the tension.

        With A = pi a/L, C = pi c/L, dB/da = -cos C sin A/(cos A sqrt(sin(C - A) sin(C + A))).
        """
        a, c, length = self.half_width, self.cohesive_end, self.period
        rate = -float(cosine(c, length) * sine(a, length) / cosine(a, length)) / self.root
        return float(self.zone.load_rate(np.array(a))) - 2.0 * self.stress * rate

    def _compliance_at(self, q: Array) -> Array:
        """Compliance of the flat punch for which the length B (the property `share`) equals q.
        The half width of this punch lies between a and c.

        The end c of the tension is fixed. The half width is sqrt(c^2 - q^2) for an isolated zone,
        and S L/pi with cos S = cos(pi c/L)/cos(pi q/L) with a period.
        """
        c = self.cohesive_end
        root = np.sqrt(sine(c - q, self.period) * sine(c + q, self.period))
        if self.period is None:
            return self._compliance_of(root)
        return self._compliance_of(self._sine_unit * np.arctan2(root, cosine(c, self.period)))

    def _approach(self) -> float:
        integral = float(integrated(lambda _, q: self._compliance_at(q), self.share))
        return super()._approach() - 2.0 * self.stress * integral

    @property
    def elastic_energy(self) -> float:
        def work_rate(length: Array, q: Array) -> Array:
            return (self.zone.load - 2.0 * self.stress * length) * self._compliance_at(q)

        released = 2.0 * self.stress * float(integrated(work_rate, self.share))
        return super().elastic_energy - released

    @property
    def surface_energy(self) -> float:
        """Energy of the interface [J/m]: 2 stress int_a^c gap dx - 2 c work.
        The tension acts on a < |x| < c, with the zone's end a.
        """

        def gap(e: Array, f: Array) -> Array:
            # The gap that the tension adds is int_a^x F(y) dy, where F is the slope of this gap.
            # The order of the integrals over x and y is exchanged:
            # int_a^c int_a^x F(y) dy dx = int_a^c (c - y) F(y) dy.
            return self.zone._gap(e) + self._unit * f * self.opening_rate(e, f)

        area = float(integrated(gap, self.cohesive_end - self.half_width))
        return 2.0 * (self.stress * area - self.cohesive_end * self.work)

    def rates(self) -> tuple[float, float]:
        """Derivatives of (load, approach) by the end c of the tension, along the equilibria.

        The rate of the approach is nan without a datum.
        """
        # The variables arcosh, log_ratio and share_rate are l, r and dB/dc of the head of this
        # file. In r, tan C/tan A - 1 is computed as sin(C - A)/(cos C sin A).
        a, c, length = self.half_width, self.cohesive_end, self.period
        arcosh = float(arcosh1p(sine_excess(a, c - a, length)))
        log_ratio = float(np.log1p(sine(c - a, length) / (cosine(c, length) * sine(a, length))))
        share_rate = float(sine(c, length)) / self.root
        opening = self._unit * (arcosh * share_rate - log_ratio)
        gap_rate = float(self.zone._gap_slope(np.array(c - a))) + opening
        # Along the equilibria the gap g at c stays equal to work/stress, so dg/dc + (dg/da)(da/dc)
        # = 0. With dg/da = -(2/pi E*) `arcosh` (dP/da) this gives (dP/da)(da/dc), the part of the
        # change of the load P that is due to a.
        load = 0.5 * pi * self.E_star * gap_rate / arcosh - 2.0 * self.stress * share_rate
        return load, self._approach_rate(load, self._unit * arcosh)


@dataclass(frozen=True)
class MetDugdaleZone(_DugdaleState):
    """An equilibrium with tension on the whole gap: a frictionless zone plus uniform tension.

    A uniform tension leaves the gap as it is, and P = P_0 - s L with the frictionless load P_0. The
    work of adhesion is at least the stress times the gap at L/2. Energies are in `AdhesiveZone`,
    fields in `SymmetricZone`. Derived here, after D. Maugis, J. Colloid Interface Sci. 150 (1992)
    243-269, doi 10.1016/0021-9797(92)90285-T.

    Parameters
    ----------
    zone : PeriodicZone
        The frictionless solution of the same half width, such as `Westergaard`.
    stress : float
        Cohesive stress s [Pa].
    work : float
        Work of adhesion w [J/m^2].

    Attributes
    ----------
    end_gap : float
        The gap at L/2 [m].
    cohesive_end : float
        L/2 [m].
    rates : callable
        d load/da and d approach/da.

    Raises
    ------
    SceneError
        If the zone has no period, or the stress or the work is not positive and finite.
    OutOfRange
        If the gap at L/2 is too large for the tension to act there at this work.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.exact import MetDugdaleZone, Westergaard
    >>> wave = Westergaard(amplitude=1e-6, period=1e-4, E_star=1e9, half_width=3e-5)
    >>> state = MetDugdaleZone(wave, stress=1e6, work=10.0)
    >>> bool(np.isclose(state.mean_pressure, wave.mean_pressure - 1e6))
    True
    >>> bool(np.isclose(state.approach, wave.approach))
    True
    """

    zone: PeriodicZone
    stress: float
    work: float

    def __post_init__(self) -> None:
        self._check_zone()
        if self.zone.period is None:
            raise SceneError.of("zone", self.zone, "a zone with a period")
        positive("stress", self.stress)
        positive("work", self.work)
        if self.work < self.stress * self.end_gap * (1.0 - 1e-12):
            raise OutOfRange(
                f"work = {self.work:.6g} J/m^2 is out of range: the cohesive intervals meet only "
                f"if it is at least {self.stress * self.end_gap:.6g} J/m^2"
            )

    @property
    def cohesive_end(self) -> float:  # type: ignore[override]
        """End of the cohesive intervals (where the tension acts) [m].
        Here it is L/2, the middle of the gap.
        """
        return 0.5 * self._length()

    @property
    def end_gap(self) -> float:
        """The gap in the middle between two neighbouring zones [m]."""
        return float(self.zone._gap(np.array(0.5 * self._length() - self.half_width)))

    def _pressure(self, r: Array, d: Array) -> Array:
        return self.zone._pressure(r, d) - self.stress

    @property
    def load(self) -> float:
        return self.zone.load - self.stress * self._length()

    @property
    def surface_energy(self) -> float:
        """Energy of the interface [J/m]: stress times area of the gap minus work times period."""
        mean_gap = self.mean_gap
        assert mean_gap is not None
        return (self.stress * mean_gap - self.work) * self._length()

    def rates(self) -> tuple[float, float]:
        """Derivatives of (load, approach) by the half width a of the zone, along the equilibria."""
        load = float(self.zone.load_rate(np.array(self.half_width)))
        return load, self._approach_rate(load, 0.0)


class _DugdaleEquilibria(Equilibria[_DugdaleState]):
    """The curve of equilibria, whose parameter is the end c of the tension (on a < |x| < c).

    Once c reaches L/2, the tension acts on the whole gap. From then on the parameter is L/2 plus
    the growth of the half width of the zone.
    """

    stress: float

    @property
    def end_gap(self) -> float:
        """Largest gap [m] at which the tension acts: work of adhesion divided by stress."""
        return self.work / self.stress

    def _half_width(self, c: float) -> float:
        """Half width a at which the gap at the end c of the tension is work/stress.

        This half width is unique: the gap at c falls as a grows, and is 0 at a = c.
        """

        def excess(a: float) -> float:
            return DugdaleZone(self._frictionless(a), self.stress, c).end_gap - self.end_gap

        return _root_below(c, excess)

    def at(self, parameter: float) -> _DugdaleState:
        """The equilibrium whose tension, on a < |x| < c, ends at c = `parameter`."""
        return DugdaleZone(self._frictionless(self._half_width(parameter)), self.stress, parameter)

    def _carrying(self, load: float, parameter: float) -> _DugdaleState:
        # If the interval a < |x| < c of the tension is wide, the gap at c hardly depends on the
        # half width `a`. So the half width that was found from this gap is inaccurate. One Newton
        # step of the half width corrects the load.
        found = self.at(parameter)
        if not isinstance(found, DugdaleZone):
            return found
        a = found.half_width + (load - found.load) / found.load_by_half_width
        return DugdaleZone(self._frictionless(a), self.stress, parameter)


@dataclass(frozen=True)
class DugdaleCylinder(Cylinder, _DugdaleEquilibria):
    """The equilibria of an isolated parabola under Maugis-Dugdale adhesion (Baney & Hui 1997).

    The parameter is the end c of the cohesive intervals.

    With a in units of (8 R^2 w/pi E*)^(1/3), P in units of (pi E* w^2 R)^(1/3), m = c/a,
    mu = sqrt(m^2 - 1) and lambda = 4s/(pi^2 E*^2 w/R)^(1/3),

    P = a^2 - lambda a mu,
    (lambda a^2/2)(m mu - ln(m + mu)) + (lambda^2 a/2)(mu ln(m + mu) - m ln m) = 1.

    The curve has states in contact only, not attraction without contact. J. M. Baney & C.-Y. Hui,
    J. Adhes. Sci. Technol. 11 (1997) 393-406, derived again.

    Parameters
    ----------
    radius : float
        Radius R [m].
    E_star : float
        Reduced modulus [Pa].
    work : float
        Work of adhesion w [J/m^2].
    stress : float
        Cohesive stress s [Pa].
    datum : float or None
        Distance at which the far field of u is zero [m]; without it there is no approach.

    Attributes
    ----------
    tabor : float
        lambda; large values are JKR's limit.
    end_gap : float
        w/s, the largest gap with tension [m].
    least_cohesive_end : float
        The end c at a = 0, where contact begins [m].
    at, at_load, at_approach, all_at_load : callable
        The state at a parameter; at a load [N/m] or an approach [m] on a branch ("stable",
        "narrow", "wide", "last"); all states at a load.
    advancing, receding : callable
        The state at a load, reached from first touch or from the largest contact; None: full
        contact.
    pull_off, turning_points, is_stable : callable
        The state at pull-off, and the parameters at which stability changes, for a machine
        compliance [m^2/N]: inf at prescribed load (the default), 0 at prescribed approach.

    Raises
    ------
    SceneError
        If a number is not positive and finite.
    OutOfRange
        From the methods, if there is no such state, for instance past pull-off.

    Examples
    --------
    For a large stress the pull-off load is that of JKR.

    >>> from contact.exact import DugdaleCylinder, JKRCylinder
    >>> curve = DugdaleCylinder(radius=1e-3, E_star=1e9, work=0.05, stress=2e8)
    >>> jkr = JKRCylinder(radius=1e-3, E_star=1e9, work=0.05)
    >>> curve.tabor > 50, bool(abs(curve.pull_off().load / jkr.pull_off_load - 1) < 1e-6)
    (True, True)
    """

    stress: float
    datum: float | None = None

    @property
    def tabor(self) -> float:
        """Maugis's parameter 4 stress/(pi^2 E*^2 work/radius)^(1/3); at large values, JKR holds."""
        cube = pi**2 * self.E_star**2 * self.work / self.radius
        return 4.0 * self.stress / float(cube ** (1.0 / 3.0))

    @property
    def least_cohesive_end(self) -> float:
        """End c of the tension at the beginning of contact, where the half width a of the zone is
        0.

        It is the root of c^2/2R + (4s/pi E*) c ln 2 = w/s.
        """
        half = 4.0 * self.stress * log(2.0) / (pi * self.E_star)
        height = 2.0 * self.end_gap / self.radius
        return self.radius * height / (half + sqrt(half * half + height))

    def _samples(self) -> Array:
        least = self.least_cohesive_end
        unit = (self.radius**2 * self.work / self.E_star) ** (1.0 / 3.0)
        most = 1e3 * max(least, unit) if self.datum is None else self.datum
        return least + np.geomspace(1e-9 * least, most - least, 60)


@dataclass(frozen=True)
class DugdaleWave(Wave, _DugdaleEquilibria):
    """The equilibria of a wave f = Delta (1 - cos(2 pi x/L)) under Maugis-Dugdale adhesion.

    The parameter is the end c of the cohesive intervals. Once these intervals meet, the parameter
    is L/2 plus the growth of a since then. While the intervals are separate,

    mean pressure = p* sin^2 A - (2s/pi) arccos(cos C/cos A),
    gap at c = 2 Delta (sin C sqrt(sin^2 C - sin^2 A) - sin^2 A arcosh(sin C/sin A))
               + (4s/pi E*) int_a^c artanh X dx = w/s;

    once the intervals have met, the mean pressure is p* sin^2 A - s. Full contact opens at the mean
    pressure p* - s, at which the traction in the valley is -s. Derived here, after D. Maugis, J.
    Colloid Interface Sci. 150 (1992) 243-269, doi 10.1016/0021-9797(92)90285-T.

    Parameters
    ----------
    amplitude : float
        Delta, half of the height from valley to crest [m].
    period : float
        Period L [m].
    E_star : float
        Reduced modulus [Pa].
    work : float
        Work of adhesion w [J/m^2].
    stress : float
        Cohesive stress s [Pa].

    Attributes
    ----------
    end_gap : float
        w/s, the largest gap with tension [m].
    opening_mean_pressure : float
        p* - s, the smallest mean pressure of full contact [Pa].
    least_cohesive_end, meeting_half_width : float
        The end c at which contact begins, and the half width a at which the intervals meet [m]; the
        latter is 0 if they meet in all states.
    at, at_load, at_approach, all_at_load : callable
        The state at a parameter; at a load [N/m] or an approach [m] on a branch ("stable",
        "narrow", "wide", "last"); all states at a load.
    advancing, receding : callable
        The state at a load, reached from first touch or from the largest contact; None: full
        contact.
    pull_off, turning_points, is_stable : callable
        The state at pull-off, and the parameters at which stability changes, for a machine
        compliance [m^2/N]: inf at prescribed load (the default), 0 at prescribed approach.

    Raises
    ------
    SceneError
        If a number is not positive and finite.
    OutOfRange
        From the methods, if there is no such state, for instance past pull-off.

    Examples
    --------
    The tension of every state ends at the gap w/s.

    >>> import numpy as np
    >>> from contact.exact import DugdaleWave
    >>> curve = DugdaleWave(amplitude=1e-6, period=1e-4, E_star=1e9, work=0.5, stress=2e6)
    >>> state = curve.at(4e-5)
    >>> bool(np.isclose(state.end_gap, 2.5e-7))
    True
    >>> bool(np.isclose(state.pressure(3.99e-5), -2e6))
    True
    """

    stress: float

    @property
    def opening_mean_pressure(self) -> float:
        """Smallest mean pressure of full contact [Pa]: pi E* amplitude/period - stress."""
        return pi * self.E_star * self.amplitude / self.period - self.stress

    @cached_property
    def meeting_half_width(self) -> float:
        """Half width of the zone at which the tension first acts on the whole gap.
        The cohesive intervals (where it acts) then meet in the middle of the gap.

        At this half width the frictionless gap is work/stress in its middle. The result is 0 if the
        frictionless gap in the middle is at most work/stress for all half widths.
        """
        if self.end_gap >= 2.0 * self.amplitude:
            return 0.0
        half = 0.5 * self.period
        return _root_below(
            half, lambda a: float(self._frictionless(a)._gap(np.array(half - a))) - self.end_gap
        )

    def touching_gap(self, c: float) -> float:
        """Gap at the end c of the tension when contact begins and the zone has half width 0.

        The gap is f(c) + (4s/pi E*) int_0^c ln(2 cos(pi x/L)) dx with the profile f.
        """
        integral = float(integrated(lambda _, rest: np.log(2.0 * cosine(c, self.period, rest)), c))
        height = float(self._frictionless(0.25 * self.period).height(c))
        return height + 4.0 * self.stress / (pi * self.E_star) * integral

    @cached_property
    def least_cohesive_end(self) -> float:
        """End c of the tension in the state in which the bodies first touch.

        It is half the period if the tension acts on the whole gap in all states.
        """
        half = 0.5 * self.period
        if self.meeting_half_width == 0.0:
            return half
        ends = half / (1.0 + np.geomspace(1e-9, 1e9, 400))
        gaps = np.array([self.touching_gap(float(c)) - self.end_gap for c in ends])
        i = int(np.flatnonzero(gaps < 0.0)[0])
        return root(lambda c: self.touching_gap(c) - self.end_gap, ends[i], ends[i - 1])

    def at(self, parameter: float) -> _DugdaleState:
        """The equilibrium with this `parameter`: the end c of the tension, up to half a period.
        Above half a period the tension acts on the whole gap. Then `parameter` minus half a period
        is the growth of the zone's half width since the tension reached the middle of the gap.
        """
        half = 0.5 * self.period
        if parameter < half:
            return super().at(parameter)
        grown = self.meeting_half_width + (parameter - half)
        return MetDugdaleZone(self._frictionless(grown), self.stress, self.work)

    def _samples(self) -> Array:
        half, least, met = 0.5 * self.period, self.least_cohesive_end, self.meeting_half_width
        fraction = 1.0 / (1.0 + np.geomspace(1e9, 1e-9, 60))
        separate = least + (half - least) * fraction if least < half else np.empty(0)
        return np.concatenate([separate, half + (half - met) * fraction])


def _root_below(most: float, function: Callable[[float], float]) -> float:
    """Root a, 0 < a < `most`, of a decreasing function.
    It is accurate even if a is close to 0 or to `most`.

    The unknown of the search is ln(a/(most - a)). Its range -34 to 32 reaches from
    a = 1e-15 most to most - a = 1e-14 most.
    """

    def at(log_ratio: float) -> float:
        return most / (1.0 + exp(-log_ratio))

    return at(root(lambda log_ratio: function(at(log_ratio)), -34.0, 32.0, xtol=1e-14))
