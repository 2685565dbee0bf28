"""Adhesion of one symmetric zone: single states, and curves of equilibria.

The pressure of an adhesive state is the pressure of the frictionless zone of the same half width,
minus the pressure of flat punches whose displacement is constant in the zone. The equilibria at a
fixed work of adhesion form a curve. With M the compliance of the machine that loads the body (0:
prescribed approach, inf: prescribed load), an equilibrium is stable if approach + M load grows
along the curve as the contact grows; stability changes at turning points (K. L. Johnson, Int. J.
Solids Struct. 32 (1995) 423-430, doi 10.1016/0020-7683(94)00111-9; with a machine, derived here).
"""

from dataclasses import dataclass
from math import inf, isfinite, nan
from typing import Generic, TypeVar

from contact.errors import OutOfRange, SceneError
from contact.model.checks import finite, keep, one_of, positive, positive_or_none
from contact.reference.exact.base import IsolatedZone, PeriodicZone, SymmetricZone
from contact.reference.exact.numerics import Array, integrated, root, roots
from contact.reference.exact.parabola import HertzLine
from contact.reference.exact.sinusoid import Westergaard


class AdhesiveZone(SymmetricZone):
    """One adhesive zone |x| <= a, built on the `zone` of the same half width without adhesion.

    Along a curve of equilibria d energy = load d approach (K. L. Johnson, Int. J. Solids Struct. 32
    (1995) 423-430, doi 10.1016/0020-7683(94)00111-9). Fields are in `SymmetricZone`.

    Attributes
    ----------
    zone : IsolatedZone or PeriodicZone
        The solution without adhesion, such as `HertzLine` or `Westergaard`.
    work : float
        Work of adhesion w [J/m^2].
    load, approach : float
        P [N/m] and approach [m], of any sign.
    elastic_energy, surface_energy, energy : float
        Energy of the body, of the interface, and their sum [J/m], per period if there is one. An
        isolated zone needs a datum.
    mean_gap : float or None
        Mean of the gap over the period [m]; None without a period.

    Raises
    ------
    SceneError
        If the zone is no frictionless solution; from the energies, without a datum.

    Examples
    --------
    The derivative of the energy by the approach is the load.

    >>> import numpy as np
    >>> from contact.exact import AdhesiveZone, JKRWave
    >>> curve = JKRWave(amplitude=1e-6, period=1e-4, E_star=1e9, work=0.5)
    >>> before, state, after = (curve.at(a) for a in (1.9999e-5, 2e-5, 2.0001e-5))
    >>> slope = (after.energy - before.energy) / (after.approach - before.approach)
    >>> isinstance(state, AdhesiveZone), bool(np.isclose(slope, state.load, rtol=1e-5))
    (True, True)
    """

    zone: IsolatedZone | PeriodicZone
    work: float

    half_width = property(lambda self: self.zone.half_width)  # type: ignore[assignment]
    E_star = property(lambda self: self.zone.E_star)  # type: ignore[assignment]
    period = property(lambda self: self.zone.period)  # type: ignore[assignment]
    datum = property(lambda self: self.zone.datum)  # type: ignore[assignment]

    def _check_zone(self) -> None:
        if not isinstance(self.zone, IsolatedZone | PeriodicZone):
            raise SceneError.of(
                "zone", self.zone, "an exact frictionless contact with one zone and free ends"
            )

    def _height(self, r: Array) -> Array:
        return self.zone._height(r)

    def _slope(self, r: Array) -> Array:
        return self.zone._slope(r)

    # The gap and the approach are those of the frictionless zone, unless a subclass changes them.
    def _gap(self, e: Array) -> Array:
        return self.zone._gap(e)

    def _approach(self) -> float:
        return self.zone._approach()

    def _approach_rate(self, load: float, at_load: float) -> float:
        """Derivative of the approach by the parameter of the equilibria; nan without a datum.
        load: derivative of the load. at_load: derivative of the approach at constant load. Both are
        derivatives by the same parameter.
        """
        return nan if self.punch_compliance is None else self.punch_compliance * load + at_load

    def rates(self) -> tuple[float, float]:
        """(derivative of the load, derivative of the approach) by the parameter of the equilibria.

        The derivative of the approach is nan without a datum.
        """
        raise NotImplementedError

    @property
    def elastic_energy(self) -> float:
        """Elastic energy (1/2) int p u dx [J/m], with displacement u; per period, if periodic."""
        return frictionless_energy(self.zone)

    @property
    def surface_energy(self) -> float:
        """Surface energy [J/m], per period if periodic; 0 if the surfaces are far apart."""
        raise NotImplementedError

    @property
    def energy(self) -> float:
        """Elastic plus surface energy [J/m]. Along the equilibria, d(energy) = load d(approach)."""
        return self.elastic_energy + self.surface_energy

    @property
    def mean_gap(self) -> float | None:
        """Mean gap [m] over the period: mean profile minus approach; None without a period."""
        if self.period is None:
            return None
        half = 0.5 * self.period
        return float(integrated(lambda x, _: self.height(x), half)) / half - self._approach()


def frictionless_energy(zone: SymmetricZone) -> float:
    """Elastic energy of a frictionless zone [J/m], (1/2) int p (approach - profile) dx."""
    moment = integrated(lambda r, d: zone._pressure(r, d) * zone._height(r), zone.half_width)
    return 0.5 * zone.load * zone._approach() - float(moment)


State = TypeVar("State", bound=AdhesiveZone)


class Equilibria(Generic[State]):
    """The curve of equilibria of one profile, with a parameter that grows with the zone.

    Turning points cut the curve into branches. `stable` is the first stable branch, `narrow` the
    one before it and `wide` the one after it. `last` is the branch at the end of the curve.
    """

    work: float

    def __post_init__(self) -> None:
        for name in vars(self):
            keep(self, positive_or_none if name == "datum" else positive, name)

    def _frictionless(self, half_width: float) -> HertzLine | Westergaard:
        """The contact zone of this half width without friction and adhesion."""
        raise NotImplementedError

    def at(self, parameter: float) -> State:
        """The equilibrium at this parameter of the curve."""
        raise NotImplementedError

    def _carrying(self, load: float, parameter: float) -> State:
        """The equilibrium at `parameter`, which was found by searching for the given load.

        A subclass may correct the state so that it carries the load to round-off.
        """
        return self.at(parameter)

    def _samples(self) -> Array:
        """Parameters along the whole curve, with at most one turning point between two of them."""
        raise NotImplementedError

    def _rates(self, parameter: float) -> tuple[float, float]:
        """(derivative of the load, derivative of the approach) by the parameter of the curve.

        The derivative of the approach is nan without a datum.
        """
        return self.at(parameter).rates()

    def _rate(self, parameter: float, machine_compliance: float) -> float:
        """Derivative of approach + `machine_compliance` * load, by the parameter of the curve.

        It is positive for a stable equilibrium. For an infinite machine compliance it is the
        derivative of the load.
        """
        load, approach = self._rates(parameter)
        if machine_compliance == inf:
            return load
        if not (isfinite(machine_compliance) and machine_compliance >= 0.0):
            raise SceneError.of(
                "machine_compliance",
                machine_compliance,
                "a number >= 0, or inf for a prescribed load",
            )
        return approach + machine_compliance * load

    def is_stable(self, parameter: float, machine_compliance: float = inf) -> bool:
        """Whether an equilibrium is stable in a machine of the given compliance.

        The compliance is inf at prescribed load and 0 at prescribed approach.
        """
        return self._rate(parameter, machine_compliance) > 0.0

    def turning_points(self, machine_compliance: float = inf) -> list[float]:
        """Values of the curve's parameter at which stability changes, in ascending order."""
        return roots(lambda s: self._rate(s, machine_compliance), self._samples())

    def pull_off(self, machine_compliance: float = inf) -> State:
        """The equilibrium at which the surfaces separate on unloading.

        Raises OutOfRange if no state is stable.
        """
        return self.at(self._part("stable", machine_compliance)[0])

    def _parts(self, machine_compliance: float) -> tuple[list[tuple[float, float]], list[bool]]:
        """First and last parameter of each branch, and for each branch whether it is stable."""
        samples = self._samples()
        ends = [float(samples[0]), *self.turning_points(machine_compliance), float(samples[-1])]
        parts = list(zip(ends[:-1], ends[1:], strict=True))
        return parts, [self._rate(0.5 * (lo + hi), machine_compliance) > 0.0 for lo, hi in parts]

    def _part(self, branch: str, machine_compliance: float) -> tuple[float, float]:
        """First and last parameter of a named branch; OutOfRange if the branch does not exist."""
        parts, grows = self._parts(machine_compliance)
        first = grows.index(True) if True in grows else len(parts)
        numbers = {"narrow": first - 1, "stable": first, "wide": first + 1, "last": len(parts) - 1}
        number = numbers[one_of("branch", branch, numbers)]
        if (first == len(parts) and branch != "last") or not 0 <= number < len(parts):
            raise OutOfRange(f"the {branch} branch does not exist for this work of adhesion")
        return parts[number]

    def at_load(self, load: float, branch: str = "stable") -> State:
        """The equilibrium at a given load (per period) on a branch; OutOfRange if there is none."""
        return self._carrying(load, self._solve("load", finite("load", load), branch, inf))

    def at_approach(self, approach: float, branch: str = "stable") -> State:
        """The equilibrium at a given approach on a branch; OutOfRange if there is none."""
        return self.at(self._solve("approach", finite("approach", approach), branch, 0.0))

    def _solve(self, control: str, value: float, branch: str, machine_compliance: float) -> float:
        """Parameter on a branch at which the load or the approach (`control`) equals `value`."""
        lo, hi = self._part(branch, machine_compliance)

        def residual(s: float) -> float:
            return float(getattr(self.at(s), control)) - value

        low, high = residual(lo), residual(hi)
        if low * high > 0.0:
            ends = sorted((low + value, high + value))
            raise OutOfRange(
                f"{control} = {value:.6g} is out of range: "
                f"the {branch} branch goes from {ends[0]:.6g} to {ends[1]:.6g}"
            )
        return root(residual, lo, hi)

    def _stable_parts(self) -> list[tuple[float, float, float, float]]:
        """Parameters and loads at both ends of each branch that is stable at prescribed load.
        Each row is (first parameter, last parameter, load at the first, load at the last).
        """
        return [
            (lo, hi, self.at(lo).load, self.at(hi).load)
            for (lo, hi), grows in zip(*self._parts(inf), strict=True)
            if grows
        ]

    def advancing(self, load: float) -> State | None:
        """The equilibrium that loading from first touch reaches at `load`; None: full contact.
        Raises OutOfRange past pull-off.
        """
        load = finite("load", load)
        parts = self._stable_parts()
        reached = [i for i, part in enumerate(parts) if part[3] >= max(load, 0.0)]
        return self._lowered(parts[: reached[0] + 1], load) if reached else None

    def receding(self, load: float) -> State | None:
        """The equilibrium that unloading reaches at `load`; None: the contact is still full.
        Raises OutOfRange past pull-off.
        """
        load = finite("load", load)
        parts = self._stable_parts()
        if self.stays_closed or not parts or load > parts[-1][3]:
            return None
        return self._lowered(parts, load)

    # True means that full contact does not open at any load.
    stays_closed = False

    def _lowered(self, parts: list[tuple[float, float, float, float]], load: float) -> State:
        """The equilibrium at `load` on the last branch of `parts` that has a state at this load.
        A branch of `parts` is given by its end parameters and the loads at them.
        """
        for lo, hi, least, most in reversed(parts):
            if least <= load <= most:
                return self._carrying(load, root(lambda s: self.at(s).load - load, lo, hi))
        pull_off = min(part[2] for part in parts)
        raise OutOfRange(
            f"load = {load:.6g} N/m is out of range: pull-off is at {pull_off:.6g} N/m"
        )

    def all_at_load(self, load: float) -> list[State]:
        """All equilibria at a given load, stable or not, by ascending parameter of the curve."""
        load = finite("load", load)
        return [
            self._carrying(load, s)
            for s in roots(lambda s: self.at(s).load - load, self._samples())
        ]


@dataclass(frozen=True)
class Cylinder:
    """Data of an isolated parabola f = x^2/2R with adhesion, for its curves of equilibria."""

    radius: float
    E_star: float
    work: float

    def _frictionless(self, half_width: float) -> HertzLine:
        # The field `datum` has a default and must come last. Therefore every subclass declares it.
        datum: float | None = self.datum  # type: ignore[attr-defined]
        return HertzLine(self.radius, self.E_star, half_width, datum)


@dataclass(frozen=True)
class Wave:
    """Data of a periodic wave Delta (1 - cos(2 pi x/L)) with adhesion, for its equilibria."""

    amplitude: float
    period: float
    E_star: float
    work: float

    def _frictionless(self, half_width: float) -> Westergaard:
        return Westergaard(self.amplitude, self.period, self.E_star, half_width)
