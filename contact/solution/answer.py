"""What a scene comes to: zones, fields and numbers in SI units, with their error, certificate and
plan.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from numbers import Integral
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

import sie
from contact.errors import SceneError
from contact.formulation.energy import Fields, elastic_energy
from contact.formulation.fields import ZoneFields
from contact.formulation.roots import maximum
from contact.formulation.tables import in_cell
from contact.model.checks import real
from contact.model.controls import Quantity
from contact.model.parts import Told
from contact.model.scene import Scene
from contact.solution.plan import Plan
from contact.verify.certificate import Certificate
from sie import Array, Index, record, wrapped


@record
class PullOff:
    """The last equilibrium before the surfaces come apart altogether, as the control falls: load
    [N/m] (per period where there is one), approach [m] (None without), zones [m] there.
    """

    load: float
    approach: float | None
    zones: Array = field(repr=False)


@dataclass(frozen=True)
class Energy:
    """What pressing has stored, and what closing has released; their changes add up to the work of
    the load.

    Parameters
    ----------
    elastic : float
        (1/2) int p u dx, u the displacement of which `Solution.approach` is one [J/m], per period
        where there is one.
    surface : float
        -w times the width in contact, w the law's work of adhesion [J/m]; 0 without adhesion.

    Examples
    --------
    A wave in full contact: pi E* amplitude^2/4 - w period (K. L. Johnson, Int. J. Solids Struct.
    32, 1995, 423).

    >>> import contact
    >>> import numpy as np
    >>> wave = contact.Scene(contact.Sinusoid(1e-2, 1.0), 1.0, contact.Periodic(), law=contact.JKR(1e-5), load=1.0)
    >>> energy = contact.solve(wave).energy
    >>> bool(np.isclose(energy.elastic, np.pi * 1e-4 / 4)), energy.surface, bool(energy.total == energy.elastic - 1e-5)
    (True, -1e-05, True)
    """

    elastic: float
    surface: float

    @property
    def total(self) -> float:
        return self.elastic + self.surface


@dataclass(frozen=True, eq=False)
class Answer(sie.Kept):
    """Zones, fields and numbers of a solved scene in SI units: see `Solution`. None is a quantity
    that the scene does not define.
    """

    scene: Scene
    zones: Array
    fields: Fields = field(repr=False)
    error: float
    certificate: Certificate = field(repr=False)
    plan: Plan = field(repr=False)
    trace: tuple[Any, ...] = field(default=(), repr=False)
    branch: str | None = None
    parting: Callable[[ZoneFields], PullOff] | None = field(default=None, repr=False)

    @classmethod
    def unfolding(
        cls,
        scene: Scene,
        zones: Array,
        fields: Fields,
        error: float,
        made: Mapping[str, Callable[[], Any]],
    ) -> Self:
        """A solution whose certificate and plan are written down when they are asked for. made:
        how, by name.
        """
        self = cls.__new__(cls)
        self.__dict__.update(
            scene=scene, zones=zones, fields=fields, error=error, trace=(), _made=made
        )
        return self

    def __getattr__(self, name: str) -> Any:
        # Reached by what is not there yet.
        made = self.__dict__.get("_made")
        if made is None or name not in made:
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
        self.__dict__[name] = made[name]()
        return self.__dict__[name]

    def __getstate__(self) -> Any:
        for name in self.__dict__.get("_made", ()):
            getattr(self, name)
        kept = super().__getstate__()
        kept.pop("_made", None)
        return kept

    # fields
    # -----------------------------------------------------------------------------------------------------------
    def pressure(self, x: ArrayLike) -> Array:
        """Contact pressure [Pa] at x [m], any shape; 0 outside the zones."""
        return self.fields.pressure(real("x", x))

    def pressure_at(self, t: ArrayLike, zone: int = 0) -> Array:
        """Contact pressure [Pa] at normalised positions t in [-1, 1] of one zone, without loss of
        digits at its ends.
        """
        if len(self.zones) == 0:
            raise SceneError.of(
                "zone",
                zone,
                "left alone: full contact, or surfaces apart, have no zones, use pressure(x)",
            )
        count = len(self.zones)
        if not isinstance(zone, Integral) or not -count <= zone < count:
            raise SceneError.of(
                "zone",
                zone,
                f"a whole number from 0 to {count - 1}, there being {count} zone{'s' * (count > 1)}",
            )
        t = real("t", t)
        if np.any(np.abs(t) > 1):
            raise SceneError.of("t", t, "from -1 to 1, the ends of the zone")
        return self.fields.pressure_at(int(self._order[zone]), t)

    def gap(self, x: ArrayLike) -> Array:
        """Gap [m] at x [m], any shape; 0 inside the zones, inf where there is no profile."""
        return self.fields.gap(real("x", x))

    def displacement(self, x: ArrayLike) -> Array:
        """Displacement into the body [m]; for an isolated punch without a datum, less the approach."""
        return self.fields.displacement(real("x", x))

    # numbers
    # ----------------------------------------------------------------------------------------------------------
    @cached_property
    def _order(self) -> Index:
        """Place among the fields' own zones of each zone of `zones`."""
        return np.argsort(
            wrapped(self.fields.zone_table[:, 0], self.scene.profile.x0, self.scene.period)
        )

    @property
    def load(self) -> float:
        """Load [N/m], per period where there is one: as given, else off by at most 3 error p times
        the width in contact.
        """
        return self.fields.load

    @property
    def mean_pressure(self) -> float | None:
        """Load per period over the period [Pa]; None without a period."""
        period = self.scene.profile.period
        return None if period is None else self.load / period

    @property
    def zone_loads(self) -> Array:
        """Load of each zone (n,) [N/m], off by at most 3 error p times its width; their sum is the
        load to rounding.
        """
        return np.asarray(self.fields.loads[self._order])

    @property
    def zone_remainders(self) -> Array:
        """What rounding has cut off the ends in `zones` (n, 2) [m], where that is known, else 0: of
        very fine roughness, whose zones are narrow beside a unit in the last digit of their places,
        it is the ends zones + zone_remainders that `error` speaks of.
        """
        return np.zeros(self.zones.shape) if self._cut_off is None else self._cut_off

    @cached_property
    def _cut_off(self) -> Array | None:
        told = self.fields.cut_off
        return None if told is None else told(self.zones, self._order)

    @property
    def zone_widths(self) -> Array:
        """Width of each zone (n,) [m], off by at most 2 error of itself."""
        widths, rest = self.zones[:, 1] - self.zones[:, 0], self._cut_off
        return widths if rest is None else widths + np.diff(rest)[:, 0]

    @cached_property
    def zone_peaks(self) -> Array:
        """Highest pressure of each zone (n,) [Pa], off by at most error p; inf under a sharp corner
        or a tip with a kink.
        """
        return peaks(self.scene, self.zones, self.pressure_at)

    @property
    def max_pressure(self) -> float:
        """Highest pressure [Pa], off by at most error of itself; inf under a sharp corner or a tip
        with a kink.
        """
        return self.fields.max_pressure

    @property
    def approach(self) -> float | None:
        """Approach [m], off by at most about 3 error p L / E* (L: the period); None for an isolated
        punch without a datum.
        """
        return self.fields.approach

    @property
    def contact_fraction(self) -> float | None:
        """Width in contact over the period, off by at most 2 error of itself; None without a
        period.
        """
        if self.scene.period is None:
            return None
        return self.fields.contact_fraction

    @cached_property
    def energy(self) -> Energy | None:
        """Elastic energy and that of the interface [J/m], per period where there is one; None where
        there is no approach, and for localized contact, whose strip is not all of the body.
        """
        elastic, period = elastic_energy(self.fields), self.scene.period
        if elastic is None:
            return None
        width = (
            float(np.sum(self.zone_widths))
            if period is None
            else self.fields.contact_fraction * period
        )
        told = Told("law.surface_energy(fields, width)", "law")
        return Energy(elastic, told.number(self.scene.law.surface_energy, self.fields, width) + 0.0)

    @property
    def stiffness(self) -> float | None:
        """d load / d approach [N/m^2], at the given moment where one is given, else at the tilt;
        inf in full contact, None where there is no approach. Its inverse is off by about 4 error /
        E*, times the width of zones over that of narrower gaps beside them.
        """
        return self.fields.stiffness

    @cached_property
    def pull_off(self) -> PullOff | None:
        """Where the contact comes apart as its load (or its approach, where that is given) falls,
        under a law that bears tension; None for full contact, which does not open, and for surfaces
        apart. Parts of it may come apart before: it is where the last do.
        """
        law = self.scene.law
        if law.bare is None or self.scene.held(Quantity.HALF_WIDTH) is not None:
            what = f"the law {law.name}" if law.bare is None else "a given half width"
            raise SceneError(
                f"there is no pull-off under {what}: it is that of adhesion under a load or an approach",
                "pull_off",
            )
        if not isinstance(self.fields, ZoneFields):
            if law.tension:
                raise SceneError(
                    "pull-off is told of contact that is not nearly full: ask for it under a smaller load",
                    "pull_off",
                )
            return None
        if self.parting is None:
            raise SceneError("there is no pull-off of a state that did not converge", "pull_off")
        return self.parting(self.fields)

    @property
    def cohesive(self) -> Array:
        """Intervals [m], (m, 2), in which the gap is below the reach of the law's tension, contact
        within them included: all of it is pulled, and the pressure beside the contact is minus that
        tension. (0, 2) under laws that do nothing beside the contact.
        """
        table, period = self.fields.cohesive, self.scene.period
        return (
            table
            if period is None or len(table) == 0
            else in_cell(table, self.scene.profile.x0, period)
        )

    @property
    def tilt(self) -> float | None:
        """By how much the body is turned [rad]: the gap at zero load is f(x) - tilt x; None for
        what repeats.
        """
        return None if self._lone is None else self._lone.tilt

    @property
    def moment(self) -> float | None:
        """int p x dx, about x = 0 [N], off as the loads of the zones are at their distances; None
        for what repeats.
        """
        return None if self._lone is None else self._lone.moment

    @property
    def rotational_stiffness(self) -> float | None:
        """d moment / d tilt at the given load [N]; None for what repeats."""
        return None if self._lone is None else self._lone.rotational_stiffness

    @property
    def _lone(self) -> ZoneFields | None:
        """The fields of a body that may turn."""
        return (
            self.fields
            if self.scene.interaction.turns and isinstance(self.fields, ZoneFields)
            else None
        )

    @property
    def mean_gap(self) -> float | None:
        """Mean of the gap over a period [m], off by at most about 3 error p L / E* (L: the period);
        None without one.
        """
        return None if self.scene.period is None else self.fields.mean_gap


# Even angles of a zone that is smooth, for each length over which the profile varies, and at the
# most.
_ANGLES = 48
_PER_FEATURE = 12
_MOST = 2**14


def peaks(scene: Scene, zones: Array, pressure_at: Callable[[Array, int], Array]) -> Array:
    """Sampled closer than the profile varies and followed below the sampling; inf where a tip with
    a kink is in contact.

    zones (n, 2) [m]; pressure_at(t, zone) [Pa] at normalised positions of one of them.
    """
    found = np.empty(len(zones))
    tips = _tips(scene)
    resolution = scene.profile.resolution or np.inf
    for zone, (left, right) in enumerate(zones):
        if np.any((left < tips) & (tips < right)):
            found[zone] = np.inf
            continue
        count = int(min(_ANGLES + _PER_FEATURE * (right - left) / resolution, _MOST))

        def over_angle(angle: Array, zone: int = zone) -> Array:
            return pressure_at(np.clip(np.cos(angle), -1.0, 1.0), zone)

        # A zone's pressure is smooth in the angle.
        found[zone] = maximum(over_angle, np.linspace(0.0, np.pi, count + 1), levels=7)[1]
    return found


def _tips(scene: Scene) -> Array:
    """Where the slope of the profile jumps upwards, and the images of these: zones lie within a
    period and the next.
    """
    kinks = np.reshape(scene.profile.kinks, (-1, 2))
    places = kinks[kinks[:, 1] > 0, 0]
    return (
        places
        if scene.period is None
        else np.concatenate([places + turn * scene.period for turn in (-1, 0, 1)])
    )
