"""JKR adhesion of one symmetric zone: p ~ -sqrt(E* w/pi)/sqrt(d) at its ends.

Here d is the distance from the end and w the work of adhesion. A state is the solution of the
frictionless zone minus that of a flat punch. At the corners of the punch, its pressure tends to
sqrt(E* w/pi)/sqrt(d). The load of the punch is

    Q = sqrt(2 pi E* a w) isolated,   Q = sqrt(2 E* w L tan(pi a/L)) with a period L.

Cylinder: M. Barquins, J. Adhesion 26 (1988) 1-12. Wave: K. L. Johnson, Int. J. Solids Struct. 32
(1995) 423-430, doi 10.1016/0020-7683(94)00111-9. The formulas of other profiles, and all approaches
and energies, are derived here from the same difference.
"""

from dataclasses import dataclass
from functools import cached_property
from math import pi, sqrt

import numpy as np

from contact.model.checks import positive
from contact.reference.exact.adhesion import AdhesiveZone, Cylinder, Equilibria, Wave
from contact.reference.exact.base import IsolatedZone, PeriodicZone, with_datum
from contact.reference.exact.flat import IsolatedPunch, PeriodicPunch
from contact.reference.exact.numerics import Array


@dataclass(frozen=True)
class JKRZone(AdhesiveZone):
    """JKR adhesion of one zone: the frictionless solution minus the solution of a flat punch.

    The index 0 is that of the frictionless zone. Q, q and C are the load, pressure and compliance
    of the punch, and p ~ -sqrt(E* w/pi)/sqrt(d) at the distance d from an end:

    p = p_0 - q,   gap = g_0 + (2Q/pi E*) arcosh(x/a) (periodic: arcosh(sin(pi x/L)/sin(pi a/L))),
    load = P_0 - Q,   approach = d_0 - C Q,   elastic energy = U_0 - C Q P_0 + C Q^2/2,
    surface energy = -2 a w.

    Energies are in `AdhesiveZone`, fields in `SymmetricZone`. M. Barquins, J. Adhesion 26 (1988)
    1-12; K. L. Johnson, Int. J. Solids Struct. 32 (1995) 423-430,
    doi 10.1016/0020-7683(94)00111-9.

    Parameters
    ----------
    zone : IsolatedZone or PeriodicZone
        The frictionless solution of the same half width, such as `HertzLine` or `Westergaard`.
    work : float
        Work of adhesion w [J/m^2].

    Attributes
    ----------
    intensity : float
        sqrt(E* w/pi) [Pa m^(1/2)].
    punch : IsolatedPunch or PeriodicPunch
        The flat punch whose pressure is subtracted.

    Raises
    ------
    SceneError
        If the zone is no frictionless solution, or the work not positive and finite.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.exact import HertzLine, JKRZone
    >>> state = JKRZone(HertzLine(radius=1e-3, E_star=1e9, half_width=1e-5), work=0.05)
    >>> p = state.pressure_at(1 - 1e-9)  # at the distance d = 1e-9 a from the end
    >>> bool(np.isclose(p * np.sqrt(1e-9 * 1e-5), -state.intensity, rtol=1e-5))
    True
    """

    zone: IsolatedZone | PeriodicZone
    work: float

    def __post_init__(self) -> None:
        self._check_zone()
        positive("work", self.work)

    @property
    def intensity(self) -> float:
        """Intensity of the tension next to an end: p ~ -intensity/sqrt(d) at the distance d.

        It is sqrt(E* work/pi) [Pa m^(1/2)].
        """
        return sqrt(self.E_star * self.work / pi)

    @cached_property
    def punch(self) -> IsolatedPunch | PeriodicPunch:
        """The flat punch whose pressure is subtracted from that of the adhesionless zone."""
        a, load = self.half_width, sqrt(2.0 * pi * self.E_star * self.work * self.tangent)
        if self.period is None:
            return IsolatedPunch(a, self.E_star, load, self.datum)
        return PeriodicPunch(a, self.period, self.E_star, load)

    @property
    def tangent(self) -> float:
        """The length (L/pi) tan(pi a/L) [m] for half width a and period L; a without a period."""
        return self._sine_unit * self._sine() / self._cosine()

    def _pressure(self, r: Array, d: Array) -> Array:
        return self.zone._pressure(r, d) - self.punch._pressure(r, d)

    def _gap(self, e: Array) -> Array:
        return super()._gap(e) + self.punch._depth(e)

    def _approach(self) -> float:
        compliance = with_datum("the approach", self.punch_compliance)
        return super()._approach() - self.punch.load * compliance

    @property
    def load(self) -> float:
        return self.zone.load - self.punch.load

    @property
    def elastic_energy(self) -> float:
        punch, compliance = self.punch.load, with_datum("the approach", self.punch_compliance)
        return super().elastic_energy + compliance * punch * (0.5 * punch - self.zone.load)

    @property
    def surface_energy(self) -> float:
        return -2.0 * self.half_width * self.work

    def rates(self) -> tuple[float, float]:
        """Derivatives of load and approach by the half width along the curve of equilibria.

        The derivative of the approach is nan without a datum.
        """
        punch = self.punch.load
        load = float(self.zone.load_rate(np.array(self.half_width)))
        load -= 0.5 * punch / (self.tangent * self._cosine() ** 2)
        # At constant load, the derivative of the approach by a is -Q dC/da. Q is the load and C the
        # compliance of the punch. dC/da is -2/(pi E* a) for an isolated zone, and
        # -2/(E* L) cot(pi a/L) with the period L.
        return load, self._approach_rate(load, 2.0 * punch / (pi * self.E_star * self.tangent))


class _JKREquilibria(Equilibria[JKRZone]):
    """The curve of JKR equilibria, with the half width as parameter."""

    def at(self, parameter: float) -> JKRZone:
        """The equilibrium whose half width is `parameter`."""
        return JKRZone(self._frictionless(parameter), self.work)

    @property
    def jump_in(self) -> JKRZone:
        """The equilibrium at zero load that the surfaces jump into at first touch."""
        return self.at_load(0.0)


@dataclass(frozen=True)
class JKRCylinder(Cylinder, _JKREquilibria):
    """The equilibria of an isolated parabola f = x^2/2R under JKR adhesion.
    The parameter of the curve of equilibria is the half width a of the zone.

    P = pi E* a^2/4R - sqrt(2 pi E* a w), and with a datum d
    approach = (a^2/2R)(ln(2d/a) + 1/2) - (2/pi E*) sqrt(2 pi E* a w) ln(2d/a).

    Pull-off at prescribed load: a^3 = 2 R^2 w/(pi E*), P = -3 (pi E* w^2 R/16)^(1/3). M.
    Barquins, J. Adhesion 26 (1988) 1-12.

    Parameters
    ----------
    radius : float
        Radius R [m].
    E_star : float
        Reduced modulus [Pa].
    work : float
        Work of adhesion w [J/m^2].
    datum : float or None
        Distance at which the far field of u is zero [m]; without it there is no approach.

    Attributes
    ----------
    pull_off_load : float
        -3 (pi E* w^2 R/16)^(1/3) [N/m].
    jump_in : JKRZone
        The state at zero load that the contact jumps to at first touch.
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
    >>> import numpy as np
    >>> from contact.exact import JKRCylinder
    >>> torn = JKRCylinder(radius=1e-3, E_star=1e9, work=0.05).pull_off()
    >>> bool(np.isclose(torn.half_width**3, 2e-6 * 0.05 / (np.pi * 1e9)))
    True
    >>> bool(np.isclose(torn.load, -3 * (np.pi * 1e9 * 0.05**2 * 1e-3 / 16) ** (1 / 3)))
    True
    """

    datum: float | None = None

    @property
    def pull_off_load(self) -> float:
        """Load [N/m] at pull-off if the load is prescribed: -3 (pi E* work^2 radius/16)^(1/3)."""
        return float(-3.0 * (pi * self.E_star * self.work**2 * self.radius / 16.0) ** (1.0 / 3.0))

    def _samples(self) -> Array:
        unit = (2.0 * self.radius**2 * self.work / (pi * self.E_star)) ** (1.0 / 3.0)
        # With a datum d, the curve ends at the half width a = d. For wider zones the approach has
        # no meaning: from about a = 2d on, it even falls with a.
        widest = 1e6 * unit if self.datum is None else self.datum
        return np.geomspace(min(1e-12 * unit, 1e-6 * widest), widest, 200)


@dataclass(frozen=True)
class JKRWave(Wave, _JKREquilibria):
    """The equilibria of a wave f = Delta (1 - cos(2 pi x/L)) under JKR adhesion.
    The parameter of the curve of equilibria is the half width a of the zone.

    With A = pi a/L, p* = pi E* Delta/L and alpha^2 = 2 w L/(pi^2 E* Delta^2) (Johnson 1995),

    mean pressure = p* (sin^2 A - alpha sqrt(tan A)),
    approach = Delta sin^2 A (1 - ln sin^2 A) + alpha Delta sqrt(tan A) ln sin^2 A.

    As the contact grows, the mean pressure falls to pull-off, rises to the jump into full contact,
    and falls without bound. For alpha < 27^(1/4)/4 = 0.5699 the jump is at a positive load; from
    alpha = 4 (3/8)^(3/4) (5/8)^(5/4) = 1.0652 on, the pressure does not rise at all. At prescribed
    approach the wave closes without a jump. K. L. Johnson, Int. J.
    Solids Struct. 32 (1995) 423-430, doi 10.1016/0020-7683(94)00111-9.

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

    Attributes
    ----------
    alpha : float
        Johnson's parameter.
    self_closing_work, last_partial_work : float
        The work w above which contact becomes full at zero load, and the one above which no partial
        contact is stable at a prescribed load [J/m^2].
    jump_in, jump_into_full_contact : JKRZone
        The state at zero load that the contact jumps to at first touch, and the partial contact
        with the largest load.
    full_contact_energy : float
        Elastic plus surface energy of full contact per period [J/m].
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
    With half of the period in contact sin^2 A = 1/2 and tan A = 1.

    >>> import numpy as np
    >>> from contact.exact import JKRWave
    >>> wave = JKRWave(amplitude=1e-6, period=1e-4, E_star=1e9, work=5.0)
    >>> bool(np.isclose(wave.at(2.5e-5).mean_pressure, np.pi * 1e7 * (0.5 - wave.alpha)))
    True
    """

    # Full contact has no zone end at which a gap could begin. So no load opens it without a flaw.
    stays_closed = True

    @property
    def alpha(self) -> float:
        """Johnson's parameter sqrt(2 w L/(pi^2 E* Delta^2)) with the work w and amplitude Delta."""
        return sqrt(2.0 * self.work * self.period / self.E_star) / (pi * self.amplitude)

    def _work_of(self, alpha: float) -> float:
        return 0.5 * self.E_star / self.period * (pi * self.amplitude * alpha) ** 2

    @property
    def self_closing_work(self) -> float:
        """Work of adhesion [J/m^2] above which the surfaces jump into full contact at zero load.

        At this work the largest load of partial contact is 0, at sin^2(pi a/L) = 3/4.
        """
        return self._work_of(27.0**0.25 / 4.0)

    @property
    def last_partial_work(self) -> float:
        """Work of adhesion [J/m^2] above which partial contact is unstable at every given load.

        At this work the two turning points of the load meet, at tan^2(pi a/L) = 3/5.
        """
        return self._work_of(4.0 * 0.375**0.75 * 0.625**1.25)

    @property
    def jump_into_full_contact(self) -> JKRZone:
        """The partial contact with the largest load; above this load the contact is full."""
        return self.at(self._part("stable", float("inf"))[1])

    @property
    def full_contact_energy(self) -> float:
        """Elastic plus surface energy of full contact per period [J/m].

        It is pi E* Delta^2/4 - w L, with the amplitude Delta, the work w and the period L.
        """
        return 0.25 * pi * self.E_star * self.amplitude**2 - self.work * self.period

    def _samples(self) -> Array:
        # The samples of tan(pi a/L) reach from 1e-9 to 1e9. They include sqrt(0.6), where the two
        # turning points of the load meet.
        tangent = np.append(np.geomspace(1e-9, 1e9, 400), sqrt(0.6))
        return self.period / pi * np.arctan(np.sort(tangent))
