"""`Solution`: zones, fields and numbers of a solved scene, and its files and figures."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from numbers import Integral
from os import PathLike
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import ArrayLike

import sie
from contact.errors import SceneError, unwarned
from contact.extras import require
from contact.formulation.energy import elastic_energy
from contact.formulation.fields import ZoneFields
from contact.formulation.protocol import Fields
from contact.formulation.tables import in_cell
from contact.model.checks import real
from contact.model.controls import Quantity
from contact.model.plugin_checks.forms import AuthorMethod
from contact.model.scene import Scene
from contact.model.units import counted
from contact.solution.plan import Plan
from contact.solution.quantities import Energy, PullOff, peaks
from contact.verify.certificate import Certificate
from sie import Array, Index, wrapped

if TYPE_CHECKING:
    from contact.inside.stress import Stress
    from contact.inside.yielding import Yield

# Names of modules that are imported only when a solution is drawn, written, or asked for warnings.
_INSIDE = "contact.inside.field"
_YIELDING = "contact.inside.yielding"
_FIGURES = "contact.solution.plotting"
_WORN = "contact.plastic.worn"
_FILES = "contact.solution.export"
_REPORT = "contact.solution.report"
_WARNINGS = "contact.solution.model_warnings"


@dataclass(frozen=True, eq=False)
class Solution(sie.Kept):
    """Zones, fields and numbers of a solved scene, SI units; returned by `contact.solve`.

    The description of each number states its error in terms of `error` and p. Here p is the largest
    pressure, or the mean contact pressure where the peak is infinite; see docs/errors.md. A
    quantity that the scene does not define is None.

    Parameters
    ----------
    scene : Scene
        The scene that was solved.
    zones : ndarray
        Zone ends [m], (n, 2), ascending; with a period, left ends in [x0, x0 + L); (0, 2) in full
        contact.
    fields : Fields
        Pressure, gap and displacement as functions (`contact.formulation.protocol.Fields`).
    error : float
        Stated bound of two relative errors: (i) the error of the pressure, divided by p, at equal
        normalised positions in corresponding zones; (ii) the error of each end, divided by the
        width of its zone.
    certificate : Certificate
        The checks on the whole line, with the values that were found.
    plan : Plan
        The parts that ran or were left out, with reasons and times.
    trace : tuple
        The Newton steps.
    branch : str or None
        Which of several equilibria this is: "advancing" if the control was raised to its value,
        "receding" if it was lowered to it; the plan states from where. None under laws with one
        equilibrium, and where the zones are given.
    find_pull_off : callable or None
        Computes `pull_off` from the fields, under laws with several equilibria.

    Examples
    --------
    >>> import contact
    >>> scene = contact.Scene(
    ...     contact.Parabola(radius=1.0), 1e9, contact.Isolated(datum=1.0), load=1e4
    ... )
    >>> solution = contact.solve(scene)
    >>> solution.zones.round(9).tolist()
    [[-0.003568248, 0.003568248]]
    >>> solution.pressure([0.0, 1.0]).round(-3).tolist(), solution.gap(0.0).tolist()
    ([1784000.0, 0.0], 0.0)
    """

    scene: Scene
    zones: Array
    fields: Fields = field(repr=False)
    error: float
    certificate: Certificate = field(repr=False)
    plan: Plan = field(repr=False)
    trace: tuple[Any, ...] = field(default=(), repr=False)
    branch: str | None = None
    find_pull_off: Callable[[ZoneFields], PullOff] | None = field(default=None, repr=False)

    @classmethod
    def deferred(
        cls,
        scene: Scene,
        zones: Array,
        fields: Fields,
        error: float,
        builders: Mapping[str, Callable[[], Any]],
    ) -> Self:
        """A solution whose certificate and plan are built at first use, by the given functions."""
        self = cls.__new__(cls)
        self.__dict__.update(
            scene=scene, zones=zones, fields=fields, error=error, trace=(), _builders=builders
        )
        return self

    def __getattr__(self, name: str) -> Any:
        # Python calls `__getattr__` only for attributes that have not been built yet.
        builders = self.__dict__.get("_builders")
        if builders is None or name not in builders:
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
        self.__dict__[name] = builders[name]()
        return self.__dict__[name]

    def __getstate__(self) -> Any:
        for name in self.__dict__.get("_builders", ()):
            getattr(self, name)
        state = super().__getstate__()
        state.pop("_builders", None)
        return state

    def pressure(self, x: ArrayLike) -> Array:
        """Contact pressure [Pa] at x [m], any array shape; 0 outside the zones."""
        return self.fields.pressure(real("x", x))

    def pressure_at(self, t: ArrayLike, zone: int = 0) -> Array:
        """Contact pressure [Pa] at normalised positions t in [-1, 1] of one zone.

        No digits are lost near the ends of the zone.
        """
        if len(self.zones) == 0:
            raise SceneError.of(
                "zone",
                zone,
                "the number of a zone, but in full contact or with the surfaces apart there are no "
                "zones: use pressure(x)",
            )
        count = len(self.zones)
        if not isinstance(zone, Integral) or not -count <= zone < count:
            raise SceneError.of(
                "zone",
                zone,
                f"a whole number from 0 to {count - 1}: the solution has {counted(count, 'zone')}",
            )
        t = real("t", t)
        if np.any(np.abs(t) > 1):
            raise SceneError.of("t", t, "from -1 to 1, the ends of the zone")
        return self.fields.pressure_at(int(self._order[zone]), t)

    def shear(self, x: ArrayLike) -> Array:
        """Shear traction on body 1 along +x [Pa] at x [m], any shape; 0 without friction.

        In sliding it is direction * friction * pressure, with the relative error of the pressure.
        """
        return self.scene.law.shear_ratio * self.pressure(x) + 0.0

    @property
    def tangential_load(self) -> float:
        """Tangential load on body 1 along +x [N/m], per period if periodic; 0 without friction."""
        return self.scene.law.shear_ratio * self.load + 0.0

    def gap(self, x: ArrayLike) -> Array:
        """Gap [m] at x [m], any shape; 0 inside the zones, inf where no profile is given."""
        return self.fields.gap(real("x", x))

    def displacement(self, x: ArrayLike) -> Array:
        """Displacement into the body [m] at x [m].
        It is relative to the approach if no point of zero displacement (datum) is given.

        On plateaus it includes the depth by which the body has yielded, `overlap`.
        """
        return self.fields.displacement(real("x", x))

    @cached_property
    def _order(self) -> Index:
        """For each zone of `zones`, the index of the same zone in `fields` (in another order)."""
        return np.argsort(
            wrapped(self.fields.zone_table[:, 0], self.scene.profile.x0, self.scene.period)
        )

    @property
    def load(self) -> float:
        """Load [N/m], per period if the scene is periodic.

        A given load is exact. Otherwise the error of the load is at most 3 error p times the width
        in contact.
        """
        return self.fields.load

    @property
    def mean_pressure(self) -> float | None:
        """Load per period divided by the period [Pa]; None without a period."""
        period = self.scene.profile.period
        return None if period is None else self.load / period

    @property
    def zone_loads(self) -> Array:
        """Load of each zone (n,) [N/m].

        Its error is at most 3 `error` times the largest pressure times the width of the zone. The
        sum of these loads is the load to rounding.
        """
        return np.asarray(self.fields.loads[self._order])

    @property
    def zone_remainders(self) -> Array:
        """Exact ends minus rounded ends of `zones` (n, 2) [m]; 0 where exact ends are unknown.

        Zones of very fine roughness may be only some units in the last digit of x wide. For such
        zones, `error` is the error of the ends zones + zone_remainders.
        """
        return np.zeros(self.zones.shape) if self._remainders is None else self._remainders

    @cached_property
    def _remainders(self) -> Array | None:
        if not self.scene.profile.exact_places:
            return None
        return self.fields.end_remainders(self.zones, self._order)

    @property
    def zone_widths(self) -> Array:
        """Width of each zone (n,) [m]; its relative error is at most twice `error`."""
        widths, rest = self.zones[:, 1] - self.zones[:, 0], self._remainders
        return widths if rest is None else widths + np.diff(rest)[:, 0]

    @cached_property
    def zone_peaks(self) -> Array:
        """Largest pressure of each zone (n,) [Pa]; its error is at most `error` times the peak.

        It is inf at a sharp corner or a convex kink.
        """
        found = peaks(self.scene, self.zones, self.pressure_at)
        return np.minimum(found, self.scene.law.pressure_range.highest)

    @property
    def max_pressure(self) -> float:
        """Largest pressure [Pa]; its relative error is at most `error`.

        It is inf at a sharp corner or a convex kink.
        """
        return self.fields.max_pressure

    @property
    def approach(self) -> float | None:
        """Approach of the bodies [m].

        Its error is at most about 3 `error` p L / E*, with the largest pressure p and the period L.

        None in isolated contact on a half-plane without a datum.
        """
        return self.fields.approach

    @property
    def contact_fraction(self) -> float | None:
        """Width in contact divided by the period; None without a period.

        The relative error is at most 2 error.
        """
        if self.scene.period is None:
            return None
        return self.fields.contact_fraction

    @cached_property
    def energy(self) -> Energy | None:
        """Elastic and surface energy [J/m], per period if the scene is periodic.

        None without an approach, and for localized contact, whose strip is not the whole body. None
        also with friction or plateaus, as the energies of shear and yield are not computed.
        """
        if self.scene.law.shear_ratio or len(self.fields.plateaus):
            return None
        elastic, period = elastic_energy(self.fields), self.scene.period
        if elastic is None:
            return None
        width = (
            float(np.sum(self.zone_widths))
            if period is None
            else self.fields.contact_fraction * period
        )
        method = AuthorMethod("law.surface_energy(fields, width)", "law")
        return Energy(
            elastic, method.number(self.scene.law.surface_energy, self.fields, width) + 0.0
        )

    @property
    def stiffness(self) -> float | None:
        """Derivative dP/d(approach) of the load P [N/m^2], at the given moment or the given tilt.

        It is inf in full contact on a half-plane, None without an approach. The error of its
        inverse is about 4 error / E*. If a gap is narrower than a zone next to it, the error is
        multiplied by the ratio of the two widths.
        """
        return self.fields.stiffness

    @cached_property
    def pull_off(self) -> PullOff | None:
        """The last equilibrium under adhesion as the load, or the given approach, falls.

        Parts of the contact may separate before this point. It is None in full contact, which does
        not open, and for surfaces that are apart.
        """
        law = self.scene.law
        if not law.equilibria.several or self.scene.held(Quantity.HALF_WIDTH) is not None:
            what = f"the law {law.name}" if not law.equilibria.several else "a given half width"
            raise SceneError(
                f"there is no pull-off under {what}: use a law of adhesion, and give a load, a "
                "mean pressure or an approach",
                "pull_off",
            )
        if not isinstance(self.fields, ZoneFields):
            if law.tension:
                raise SceneError(
                    "the pull-off is computed only if there are zones of contact and contact is "
                    "not nearly full: use a solution under another load",
                    "pull_off",
                )
            return None
        if self.find_pull_off is None:
            raise SceneError(
                "the pull-off of a state that did not converge is not computed", "pull_off"
            )
        return self.find_pull_off(self.fields)

    def stress(
        self, x: ArrayLike, y: ArrayLike, lateral: str = "as loaded", nu: float | None = None
    ) -> "Stress":
        """Plane stresses [Pa] in body 1 at points (x, y) [m], y >= 0 into the body.

        The body is a half-plane. Far below a periodic contact, the stresses that the contact
        pressure causes tend to a uniform pressure: the normal stress along the surface, too, tends
        to minus the mean pressure.

        Parameters
        ----------
        x, y : array_like
            Places and depths [m], of shapes that broadcast to one.
        lateral : str
            How a periodic body is held along the surface. "as loaded" adds nothing to the stresses
            that the contact pressure causes; "free" makes the mean of s_xx zero; "confined" makes
            the mean of the strain e_xx zero. Without a period, all are the same.
        nu : float or None
            Poisson's ratio; "confined" needs it.

        Returns
        -------
        Stress
            `xx`, `yy`, `xy` [Pa], positive in tension, with their `error`, and `shear`, `zz(nu)`,
            `mises(nu)`, `tresca(nu)`.

        Raises
        ------
        SceneError
            If y < 0, `lateral` is unknown, or the body is not a half-plane.

        Examples
        --------
        >>> import contact
        >>> wave = contact.Scene(contact.Sinusoid(1.0, 1.0), 1.0, contact.Periodic(), load=1.0)
        >>> solution = contact.solve(wave)
        >>> for lateral in ("as loaded", "free"):
        ...     print(lateral, solution.stress(0.0, 9.0, lateral).xx.round(6))
        as loaded -1.0
        free 0.0
        """
        inside = require(_INSIDE)
        places = inside.body_points(x, y)
        found: Stress = inside.stress_of(self.fields, *places, self.error, lateral, nu)
        return found

    def first_yield(
        self,
        strength: float,
        nu: float,
        criterion: str = "mises",
        lateral: str = "as loaded",
        tol: float = 1e-9,
    ) -> "Yield":
        """Load and place of first yield, found by a change of the scene's control.

        Parameters
        ----------
        strength : float
            Yield strength [Pa]: in tension for "mises", in shear for "tresca".
        nu : float
            Poisson's ratio of body 1.
        criterion : str
            "mises", or "tresca": the largest shear stress on any plane.
        lateral : str
            As for `stress`.
        tol : float
            Tolerance of the contacts that are solved.

        Returns
        -------
        Yield
            `load` [N/m], `x`, `y` [m], `error` and `solution`. Next to sharp corners, sharp tips
            and ends under JKR's law the stress is infinite: there the load is 0, and `note` says
            so.

        Raises
        ------
        SceneError
            If the criterion is unknown, a number is out of its range, the body is not a half-plane,
            or the law has an attraction and the body yields under a smaller control.
        OutOfRange
            If no value of the control reaches the strength.
        """
        yielding = require(_YIELDING)
        control = yielding.changed_control(self.scene)
        curve = require("contact.sweeps.curve").Curve(self.scene, control, tol)
        rule = yielding.Criterion(criterion, nu, lateral)
        with unwarned():
            found: Yield = yielding.first_yield(self, curve.at, strength, rule)
        return found

    @property
    def cohesive(self) -> Array:
        """Intervals [m], (m, 2), in which the gap is so small that the law's tension acts.

        Each interval includes the contact inside it. Around the contact the pressure is minus the
        tension.
        The table is empty under laws without tension outside the contact.
        """
        table, period = self.fields.cohesive, self.scene.period
        return (
            table
            if period is None or len(table) == 0
            else in_cell(table, self.scene.profile.x0, period)
        )

    @property
    def plateaus(self) -> Array:
        """Intervals (n, 2) [m], within the zones, on which the pressure equals the hardness.

        The table is empty under laws without a limit of the pressure, and if the pressure reaches
        the limit nowhere.
        """
        return in_cell(self.fields.plateaus, self.scene.profile.x0, self.scene.period)

    def overlap(self, x: ArrayLike) -> Array:
        """Depth [m] by which the body has yielded at x [m], any shape; 0 where it has not yielded.

        It is approach - profile - elastic displacement: surfaces that stay elastic would overlap by
        this depth.
        """
        return self.fields.overlap(real("x", x))

    def worn(self) -> Any:
        """The profile that yielding leaves: height plus `overlap`; unchanged if nothing yields.

        Under the same load, the elastic contact of this profile has the same pressure. During
        unloading, and during loading again up to the same load, the contact is the elastic contact
        of this profile.

        Returns
        -------
        Profile

        Raises
        ------
        SceneError
            If the profile has sharp corners and has yielded.
        """
        return require(_WORN).worn(self)

    @property
    def tilt(self) -> float | None:
        """Angle by which the body is turned [rad]: at zero load, the gap is profile - tilt x.

        None unless the contact is isolated.
        """
        return self.fields.tilt if self.scene.interaction.turns else None

    @property
    def moment(self) -> float | None:
        """Moment of the pressure p about x = 0, int p x dx [N]; None unless isolated.

        Its error is that of the zone loads times their distances from x = 0.
        """
        return self.fields.moment if self.scene.interaction.turns else None

    @property
    def rotational_stiffness(self) -> float | None:
        """Derivative d(moment)/d(tilt) [N] at the given load; None unless isolated."""
        return self.fields.rotational_stiffness if self.scene.interaction.turns else None

    @property
    def mean_gap(self) -> float | None:
        """Mean gap over a period [m]; None without a period.

        The error is at most about 3 error p L / E*, with L the period.
        """
        return None if self.scene.period is None else self.fields.mean_gap

    @cached_property
    def warnings(self) -> list[str]:
        """Warnings about slopes, pressures, modulus and trace for which the model is doubtful.

        They are also issued as ModelWarnings.
        """
        messages: list[str] = require(_WARNINGS).all_warnings(self)
        return messages

    def plot(self) -> Any:
        """A matplotlib figure of surfaces and pressure; raises MissingExtra without matplotlib."""
        return require(_FIGURES).plot(self)

    def to_dataset(self) -> Any:
        """An xarray.Dataset of zones, fields and numbers; raises MissingExtra without xarray."""
        return require(_FILES).to_xarray(self)

    def __str__(self) -> str:
        """The numbers with units and stated errors, and the zones, as a table."""
        text: str = require(_REPORT).report(self)
        return text

    def _repr_html_(self) -> str:
        return require(_FIGURES).to_html(self)

    def zone_table(self) -> Any:
        """One row for each zone: ends and width [m], load [N/m], mean and largest pressure [Pa].

        Returns
        -------
        pandas.DataFrame
            With the units of the columns in `attrs["units"]`.

        Raises
        ------
        MissingExtra
            Without pandas, which the extra `io` installs.
        """
        return require(_FILES).zone_frame(self)

    def save(self, path: str | PathLike[str], overwrite: bool = False) -> None:
        """Write zones, numbers and scene as JSON (.json), or with the fields as netCDF (.nc).

        Raises
        ------
        SceneError
            If the name ends otherwise, or the file is there and `overwrite` is not given.
        """
        files = require(_FILES)
        file = files.new_file(path, overwrite, (".json", ".nc"))
        write = files.write_json if file.suffix.lower() == ".json" else files.write_netcdf
        write(self, file, overwrite)

    def save_zones(self, path: str | PathLike[str], overwrite: bool = False) -> None:
        """Write the zone table as CSV, in SI units and full precision.

        An existing file is replaced only with `overwrite`.
        """
        require(_FILES).write_csv(self, path, overwrite)

    def save_fields(self, path: str | PathLike[str], overwrite: bool = False) -> None:
        """Write x, pressure, gap, displacement and profile as CSV, in SI units and full precision.

        An existing file is replaced only with `overwrite`.
        """
        require(_FILES).write_fields(self, path, overwrite)

    def to_dict(self) -> dict[str, Any]:
        """The solution as a dictionary of plain types; None for infinite or undefined values."""
        return require(_FILES).to_dict(self)


def limit_of_approach(solution: Solution, tol: float) -> str:
    """Message if the digits of a given approach do not fix the load to `tol`; "" if they do.

    Near full contact the approach is the mean of the profile minus the mean gap. The mean gap is
    proportional to the square of the width of narrow gaps over kinks, and to the fourth power of
    the width of other gaps. Therefore the load depends on the last digits of the approach.
    """
    approach, stiffness = solution.scene.held(Quantity.APPROACH), solution.stiffness
    if approach is None or stiffness is None or not np.isfinite(stiffness):
        return ""
    condition = abs(approach * stiffness / solution.load)
    rounding = float(np.finfo(np.float64).eps) * condition
    if rounding <= 0.1 * tol:
        return ""
    return (
        f"rounding of the approach in its last digit changes the load by {rounding:.1e} of its "
        f"value (condition {condition:.0e}): give a load, a mean pressure or a contact fraction "
        "instead"
    )
