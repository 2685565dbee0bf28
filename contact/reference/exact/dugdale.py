"""Maugis-Dugdale adhesion of one symmetric zone, alone and in a row: traction -s (the stress)
beside the zone, a < |x| < c.

Contact ends are bounded; the gap at c is w/s. In the superposition of base.py the cohesive
tractions are punches of negative load between a and c, all together -2 s B, where, with u = pi x/L,
A = pi a/L, C = pi c/L,

    alone       B = sqrt(c^2 - a^2)                 l = arcosh(c/a)            r = ln(c/a)
    periodic    B = (L/pi) arccos(cos C/cos A)      l = arcosh(sin C/sin A)    r = ln(tan C/tan A)

    pressure    p = p_0 - (2s/pi) arctan(sqrt((c^2 - a^2)/(a^2 - x^2)))
                p = p_0 - (2s/pi) arctan((cos u/cos C) sqrt((sin^2 C - sin^2 A)/(sin^2 A - sin^2
                u)))
    gap         g = g_0 + (4s/pi E*) int_a^x artanh(X or 1/X) dx,   X = sqrt((x^2 - a^2)/(c^2 - a^2)),
                X = cos C sqrt(cos^2 A - cos^2 u)/(cos u sqrt(cos^2 A - cos^2 C))
    at c        d g/dc = g_0' + (4s/pi E*)(l dB/dc - r),   d g/da = -(2/pi E*) l d P/da
    approach    d_0 - 2s int K dB,   d/dc = -2s (K dB/dc - (2/pi E*) l),   d/da = K d P/da

with K the compliance of the punch at a, in the integral of each one between a and c. D. Maugis, J.
Colloid Interface Sci. 150 (1992) 243-269, doi 10.1016/0021-9797(92)90285-T; cylinder: J. M. Baney &
C.-Y. Hui, J. Adhes. Sci. Technol. 11 (1997) 393-406, derived again; row of waves: derived here. As
c reaches L/2 the tension acts everywhere: what is left is the frictionless zone under a uniform
tension.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import atan2, exp, log, pi, sqrt

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from contact.errors import OutOfRange, SceneError
from contact.model.checks import between, positive
from contact.reference.exact import base
from contact.reference.exact.adhesion import AdhesiveZone, Cylinder, Equilibria, Wave
from contact.reference.exact.base import Array, arcosh1p, cosine, integrated, sine, sine_excess
from contact.reference.exact.roots import root


class _DugdaleState(AdhesiveZone):
    """An equilibrium, its cohesive intervals apart or meeting."""

    stress: float
    cohesive_end: float

    def pressure(self, x: ArrayLike) -> Array:
        """p(x) [Pa]: -stress on the cohesive intervals, 0 beyond."""
        r = np.abs(self._reduced(x))
        pulled = (r >= self.half_width) & (r < self.cohesive_end)
        return np.where(pulled, -self.stress, super().pressure(x))


@dataclass(frozen=True)
class DugdaleZone(_DugdaleState):
    """Maugis-Dugdale adhesion of one zone: a frictionless zone of half width a under the tension s
    on a < |x| < c beside it.

    The ends are bounded, and the work of adhesion is the stress times the gap at c. Alone p = p_0 -
    (2s/pi) arctan(sqrt((c^2 - a^2)/(a^2 - x^2))), P = P_0 - 2 s sqrt(c^2 - a^2); with a period: the
    head of this module. D. Maugis, J. Colloid Interface Sci. 150 (1992) 243-269, doi
    10.1016/0021-9797(92)90285-T; in the plane J. M. Baney & C.-Y. Hui, J. Adhes. Sci. Technol. 11
    (1997) 393-406, derived again.

    Parameters
    ----------
    zone : IsolatedZone or PeriodicZone
        The frictionless solution of the same half width, `HertzLine` or `Westergaard` for instance.
    stress : float
        Cohesive stress s [Pa].
    cohesive_end : float
        c, above a, and below L/2 with a period [m].

    Attributes
    ----------
    work : float
        Work of adhesion this state belongs to [J/m^2].
    end_gap : float
        The gap at c [m].
    cohesive_intervals : array, (2, 2)
        [[-c, -a], [a, c]] [m].
    load, approach, energy : float
        As in `AdhesiveZone`.
    rates : callable
        d load/dc and d approach/dc along the curve of equilibria.
    pressure, gap, zones, approach : as in `SymmetricZone`
        What every such zone has, and what else is there.

    Raises
    ------
    SceneError
        If the zone is no frictionless solution, the stress not positive and finite, or c not beyond
        a.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.exact import DugdaleZone, HertzLine
    >>> hertz = HertzLine(radius=1e-3, E_star=1e9, half_width=3e-5)
    >>> state = DugdaleZone(hertz, stress=1e5, cohesive_end=5e-5)
    >>> bool(np.isclose(state.load, hertz.load - 2e5 * 4e-5)), bool(np.isclose(state.pressure(4e-5), -1e5))
    (True, True)
    """

    zone: base.IsolatedZone | base.PeriodicZone
    stress: float
    cohesive_end: float

    def __post_init__(self) -> None:
        self._check_zone()
        positive("stress", self.stress)
        widest = 1e300 if self.period is None else 0.5 * self.period
        between("cohesive_end", self.cohesive_end, self.half_width, widest)

    # The closed forms of the head of this file, of a and c alone.
    @property
    def root(self) -> float:
        """sqrt(c^2 - a^2), or of the squared sines."""
        a, c = self.half_width, self.cohesive_end
        return sqrt(float(sine(c - a, self.period) * sine(c + a, self.period)))

    @property
    def share(self) -> float:
        """B."""
        if self.period is None:
            return self.root
        return self._turn * atan2(self.root, float(cosine(self.cohesive_end, self.period)))

    def opening_rate(self, e: Array, f: Array) -> Array:
        """artanh(X or 1/X) at x = a + e = c - f, from both distances: X^2 and |1 - X^2| without
        cancellation.
        """
        a, c, length = self.half_width, self.cohesive_end, self.period
        x = a + e
        scale = (
            sine(c - a, length) * sine(c + a, length) * np.maximum(cosine(x, length), 1e-100) ** 2
        )
        square = sine(e, length) * sine(x + a, length) * cosine(c, length) ** 2 / scale
        rest = np.abs(sine(f, length)) * sine(c + x, length) * cosine(a, length) ** 2 / scale
        # artanh X = asinh(X/sqrt(1 - X^2)), and artanh(1/X) = asinh(1/sqrt(X^2 - 1)).
        return np.asarray(np.arcsinh(np.sqrt(np.minimum(square, 1.0) / np.maximum(rest, 1e-300))))

    @property
    def end_gap(self) -> float:
        """The gap at c [m]."""
        return float(self._gap(np.array(self.cohesive_end - self.half_width)))

    @property
    def work(self) -> float:  # type: ignore[override]
        """The work of adhesion this state belongs to [J/m^2]."""
        return self.stress * self.end_gap

    def _pressure(self, r: Array, d: Array) -> Array:
        a, length = self.half_width, self.period
        depth = np.sqrt(sine(d, length) * sine(a + r, length)) * cosine(self.cohesive_end, length)
        side = self.root * cosine(a, length, d)
        return self.zone._pressure(r, d) - 2.0 * self.stress / pi * np.arctan2(side, depth)

    def _gap(self, e: Array) -> Array:
        # The integral is broken at c.
        length = self.cohesive_end - self.half_width
        e = np.asarray(e, dtype=float)
        near, far = np.minimum(e, length), np.maximum(e - length, 0.0)
        before = integrated(
            lambda y, rest: self.opening_rate(y, (length - near)[..., None] + rest), near
        )
        beyond = integrated(lambda y, _: self.opening_rate(length + y, y), far)
        return super()._gap(e) + self._unit * (before + beyond)

    @property
    def _unit(self) -> float:
        return 4.0 * self.stress / (pi * self.E_star)

    @property
    def load(self) -> float:
        return self.zone.load - 2.0 * self.stress * self.share

    @property
    def load_by_half_width(self) -> float:
        """d load/da at fixed c; dB/da = -cos C sin A/(cos A sqrt(sin(C - A) sin(C + A)))."""
        a, c, length = self.half_width, self.cohesive_end, self.period
        share = float(cosine(c, length) * sine(a, length) / cosine(a, length)) / self.root
        return float(self.zone.load_rate(np.array(a))) + 2.0 * self.stress * share

    def _compliance_behind(self, q: Array) -> Array:
        """Compliance of the punch of the cohesive load behind which the share q is still to come:
        of the half width s with B(s, c) = q.
        """
        c = self.cohesive_end
        root = np.sqrt(sine(c - q, self.period) * sine(c + q, self.period))
        # cos S = cos C/cos(pi q/L)
        return self._compliance_of(
            root if self.period is None else self._turn * np.arctan2(root, cosine(c, self.period))
        )

    def _approach(self) -> float:
        return super()._approach() - 2.0 * self.stress * float(
            integrated(lambda _, q: self._compliance_behind(q), self.share)
        )

    @property
    def elastic_energy(self) -> float:
        def taken(share: Array, q: Array) -> Array:
            return (self.zone.load - 2.0 * self.stress * share) * self._compliance_behind(q)

        return super().elastic_energy - 2.0 * self.stress * float(integrated(taken, self.share))

    @property
    def surface_energy(self) -> float:
        """-2 c w + 2 stress int_a^c gap dx."""

        def gap(near: Array, far: Array) -> Array:
            # int_a^c int_a^x = int_a^c (c - x)
            return self.zone._gap(near) + self._unit * far * self.opening_rate(near, far)

        area = float(integrated(gap, self.cohesive_end - self.half_width))
        return 2.0 * (self.stress * area - self.cohesive_end * self.work)

    def rates(self) -> tuple[float, float]:
        """d load/dc and d approach/dc along the curve of equilibria of this work (approach: nan
        without a datum).
        """
        # l, r and dB/dc of the head of this file.
        a, c, length = self.half_width, self.cohesive_end, self.period
        widening = float(arcosh1p(sine_excess(a, c - a, length)))
        # tan C/tan A - 1 = sin(C - A)/(cos C sin A)
        logarithm = float(np.log1p(sine(c - a, length) / (cosine(c, length) * sine(a, length))))
        share = float(sine(c, length)) / self.root
        opened = float(self.zone._gap_slope(np.array(c - a))) + self._unit * (
            widening * share - logarithm
        )
        # What a takes back from the gap at c it adds to the load: d g/da = -(2/pi E*) l d P/da.
        load = 0.5 * pi * self.E_star * opened / widening - 2.0 * self.stress * share
        return load, self._approach_rate(load, self._unit * widening)


@dataclass(frozen=True)
class MetDugdaleZone(_DugdaleState):
    """Cohesive intervals that meet at L/2: the frictionless zone under a uniform tension, which
    moves no surface; P = P_0 - s L.

    The work of adhesion has to be at least stress times the gap at L/2. Derived here, after D.
    Maugis, J. Colloid Interface Sci. 150 (1992) 243-269, doi 10.1016/0021-9797(92)90285-T.

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
    load, approach, energy : float
        As in `AdhesiveZone`.
    rates : callable
        d load/da and d approach/da.
    pressure, gap, zones, approach : as in `SymmetricZone`
        What every such zone has, and what else is there.

    Raises
    ------
    SceneError
        If the zone has no period, or the stress or the work is not positive and finite.
    OutOfRange
        If the intervals do not meet at this work.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.exact import MetDugdaleZone, Westergaard
    >>> wave = Westergaard(amplitude=1e-6, period=1e-4, E_star=1e9, half_width=3e-5)
    >>> state = MetDugdaleZone(wave, stress=1e6, work=10.0)
    >>> bool(np.isclose(state.mean_pressure, wave.mean_pressure - 1e6)), bool(np.isclose(state.approach, wave.approach))
    (True, True)
    """

    zone: base.PeriodicZone
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
                f"work = {self.work:.6g} J/m^2 is out of range: cohesive intervals meet from "
                f"{self.stress * self.end_gap:.6g} J/m^2 on"
            )

    @property
    def cohesive_end(self) -> float:  # type: ignore[override]
        """L/2 [m]."""
        return 0.5 * self._length()

    @property
    def end_gap(self) -> float:
        """The gap at L/2 [m]."""
        return float(self.zone._gap(np.array(0.5 * self._length() - self.half_width)))

    def _pressure(self, r: Array, d: Array) -> Array:
        return self.zone._pressure(r, d) - self.stress

    @property
    def load(self) -> float:
        return self.zone.load - self.stress * self._length()

    @property
    def surface_energy(self) -> float:
        """-w L + stress times the area of the gap."""
        mean_gap = self.mean_gap
        assert mean_gap is not None
        return (self.stress * mean_gap - self.work) * self._length()

    def rates(self) -> tuple[float, float]:
        """d load/da and d approach/da."""
        load = float(self.zone.load_rate(np.array(self.half_width)))
        return load, self._approach_rate(load, 0.0)


class _DugdaleEquilibria(Equilibria[_DugdaleState]):
    """Equilibria by the end c of the cohesive intervals; past L/2, where they have met, by L/2 plus
    what a has grown since.
    """

    stress: float

    @property
    def end_gap(self) -> float:
        """w/s, up to which the surfaces pull."""
        return self.work / self.stress

    def _half_width(self, c: float) -> float:
        """a at which the gap at c is w/s: it falls from its value without contact to zero at a = c."""
        return _within(
            c, lambda a: DugdaleZone(self._frictionless(a), self.stress, c).end_gap - self.end_gap
        )

    def at(self, parameter: float) -> _DugdaleState:
        """The equilibrium of a parameter."""
        return DugdaleZone(self._frictionless(self._half_width(parameter)), self.stress, parameter)

    def _carrying(self, load: float, parameter: float) -> _DugdaleState:
        # Beside wide intervals the gap at c hardly tells a, which the load does to all digits.
        found = self.at(parameter)
        if not isinstance(found, DugdaleZone):
            return found
        a = found.half_width + (load - found.load) / found.load_by_half_width
        return DugdaleZone(self._frictionless(a), self.stress, parameter)


@dataclass(frozen=True)
class DugdaleCylinder(Cylinder, _DugdaleEquilibria):
    """The equilibria of f = x^2/2R alone under Maugis-Dugdale adhesion, by the end c of the
    cohesive intervals (Baney & Hui 1997).

    With a in (8 R^2 w/pi E*)^(1/3), P in (pi E* w^2 R)^(1/3), m = c/a, mu = sqrt(m^2 - 1) and
    lambda = 4s/(pi^2 E*^2 w/R)^(1/3),

    P = a^2 - lambda a mu,   (lambda a^2/2)(m mu - ln(m + mu)) + (lambda^2 a/2)(mu ln(m + mu) - m ln
    m) = 1.

    Only states in contact: attraction without contact is not here. J. M. Baney & C.-Y. Hui, J.
    Adhes. Sci. Technol. 11 (1997) 393-406, derived again.

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
        Distance at which the far field of u is zero [m]; without it (None) there is no approach.

    Attributes
    ----------
    tabor : float
        lambda; JKR where it is large.
    end_gap : float
        w/s, up to which the surfaces pull [m].
    least_cohesive_end : float
        c where contact begins, a = 0 [m].
    at, at_load, at_approach, all_at_load : callable
        The state of a parameter; at a load [N/m] or an approach [m] on a branch ("stable",
        "narrow", "wide", "last"); all states at a load.
    advancing, receding : callable
        The state at a load, reached from first touch or from the greatest contact; None: full
        contact.
    pull_off, turning_points, is_stable : callable
        Where unloading tears the surfaces apart, and where stability changes, for a machine's
        compliance [m^2/N]: inf under a held load (the default), 0 under a held approach.

    Raises
    ------
    SceneError
        If a number is not positive and finite.
    OutOfRange
        From the calls, if no state answers, such as past pull-off.

    Examples
    --------
    Under a large stress the pull-off load is that of JKR.

    >>> from contact.exact import DugdaleCylinder, JKRCylinder
    >>> curve = DugdaleCylinder(radius=1e-3, E_star=1e9, work=0.05, stress=2e8)
    >>> curve.tabor > 50, bool(abs(curve.pull_off().load / JKRCylinder(1e-3, 1e9, 0.05).pull_off_load - 1) < 1e-6)
    (True, True)
    """

    stress: float
    datum: float | None = None

    @property
    def tabor(self) -> float:
        """lambda = 4s/(pi^2 E*^2 w/R)^(1/3): JKR where it is large."""
        return (
            4.0
            * self.stress
            / float((pi**2 * self.E_star**2 * self.work / self.radius) ** (1.0 / 3.0))
        )

    @property
    def least_cohesive_end(self) -> float:
        """c where contact begins, a = 0: c^2/2R + (4s/pi E*) c ln 2 = w/s."""
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
    """The equilibria of f = Delta (1 - cos(2 pi x/L)) in a row under Maugis-Dugdale adhesion
    (derived), by the end c of the intervals.

    While the cohesive intervals are apart

    mean pressure = p* sin^2 A - (2s/pi) arccos(cos C/cos A), gap at c = 2 Delta (sin C sqrt(sin^2 C
    - sin^2 A) - sin^2 A arcosh(sin C/sin A)) + (4s/pi E*) int_a^c artanh X dx = w/s,

    and p* sin^2 A - s once they have met; from there on the parameter is L/2 plus what a has grown
    since. Full contact opens at the mean pressure p* - s, where the valley's traction is -s. After
    D. Maugis, J. Colloid Interface Sci. 150 (1992) 243-269, doi 10.1016/0021-9797(92)90285-T.

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
        w/s, up to which the surfaces pull [m].
    opening_mean_pressure : float
        p* - s, the least mean pressure of full contact [Pa].
    least_cohesive_end, meeting_half_width : float
        c from which on there is contact, and a at which the intervals meet (0 if they have always
        met) [m].
    at, at_load, at_approach, all_at_load : callable
        The state of a parameter; at a load [N/m] or an approach [m] on a branch ("stable",
        "narrow", "wide", "last"); all states at a load.
    advancing, receding : callable
        The state at a load, reached from first touch or from the greatest contact; None: full
        contact.
    pull_off, turning_points, is_stable : callable
        Where unloading tears the surfaces apart, and where stability changes, for a machine's
        compliance [m^2/N]: inf under a held load (the default), 0 under a held approach.

    Raises
    ------
    SceneError
        If a number is not positive and finite.
    OutOfRange
        From the calls, if no state answers, such as past pull-off.

    Examples
    --------
    Every state pulls up to the gap w/s.

    >>> import numpy as np
    >>> from contact.exact import DugdaleWave
    >>> curve = DugdaleWave(amplitude=1e-6, period=1e-4, E_star=1e9, work=0.5, stress=2e6)
    >>> state = curve.at(4e-5)
    >>> bool(np.isclose(state.end_gap, 2.5e-7)), bool(np.isclose(state.pressure(3.99e-5), -2e6))
    (True, True)
    """

    stress: float

    @property
    def opening_mean_pressure(self) -> float:
        """p* - s, the least mean pressure of full contact."""
        return pi * self.E_star * self.amplitude / self.period - self.stress

    @cached_property
    def meeting_half_width(self) -> float:
        """a at which the cohesive intervals meet: the frictionless gap at L/2 is w/s; 0 if that is
        never reached.
        """
        if self.end_gap >= 2.0 * self.amplitude:
            return 0.0
        half = 0.5 * self.period
        return _within(
            half, lambda a: float(self._frictionless(a)._gap(np.array(half - a))) - self.end_gap
        )

    def touching_gap(self, c: float) -> float:
        """The gap at c where contact begins, a = 0: f(c) + (4s/pi E*) int_0^c ln(2 cos(pi x/L)) dx."""
        integral = float(integrated(lambda _, rest: np.log(2.0 * cosine(c, self.period, rest)), c))
        return (
            float(self._frictionless(0.25 * self.period).height(c))
            + 4.0 * self.stress / (pi * self.E_star) * integral
        )

    @cached_property
    def least_cohesive_end(self) -> float:
        """c from which on there is contact up to c = L/2; L/2 if cohesive intervals have always
        met.
        """
        half = 0.5 * self.period
        if self.meeting_half_width == 0.0:
            return half
        shares = half / (1.0 + np.geomspace(1e-9, 1e9, 400))
        gaps = np.array([self.touching_gap(float(c)) - self.end_gap for c in shares])
        i = int(np.flatnonzero(gaps < 0.0)[0])
        return root(lambda c: self.touching_gap(c) - self.end_gap, shares[i], shares[i - 1])

    def at(self, parameter: float) -> _DugdaleState:
        """The equilibrium of a parameter."""
        half = 0.5 * self.period
        if parameter < half:
            return super().at(parameter)
        grown = self.meeting_half_width + (parameter - half)
        return MetDugdaleZone(self._frictionless(grown), self.stress, self.work)

    def _samples(self) -> Array:
        half, least, met = 0.5 * self.period, self.least_cohesive_end, self.meeting_half_width
        share = 1.0 / (1.0 + np.geomspace(1e9, 1e-9, 60))
        apart = least + (half - least) * share if least < half else np.empty(0)
        together = half + (half - met) * share
        return np.concatenate([apart, together])


def _within(most: float, function: Callable[[float], float]) -> float:
    """The root a between 0 and `most` of a function that falls from one to the other, by the
    logarithm of a/(most - a).
    """

    def place(log_ratio: float) -> float:
        return most / (1.0 + exp(-log_ratio))

    # From a = 1e-15 to most - a = 1e-14, of `most`.
    return place(
        brentq(lambda log_ratio: function(place(log_ratio)), -34.0, 32.0, xtol=1e-14, rtol=1e-15)
    )
