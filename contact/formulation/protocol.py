"""`Fields`: the protocol of the results of every method of solution.

`Solution`, its files, pictures and warnings ask for these members only, and need not know how a
contact was found. Values are in SI units. Values that are called scaled are in the units of
`problem.units`. The unknown of the method, the pressure or the slope of the gap, is not part of the
protocol.

    ZoneFields            the pressure on zones                  contact.formulation.fields
    ClosedFields          one symmetric zone in closed form      contact.closed.fields
    GapFields             the slope of the gap on gaps           contact.formulation.gaps
    FullFields            full contact                           contact.formulation.full_contact
    ApartFields           surfaces that do not touch             contact.formulation.full_contact
    PlasticFields         zones with plateaus at a limit         contact.plastic.fields
    CohesiveFields        zones with tension around them         contact.adhesion.cohesive_fields
    CohesiveGapFields     gaps, with tension everywhere          contact.adhesion.cohesive_fields
    SeparatedFields       tension without contact                contact.adhesion.separated_fields

Places are on the line, except those of `pressure_transform`, from which the stresses in the body
follow (contact.inside).
"""

from typing import Protocol

from numpy.typing import ArrayLike

from contact.formulation.problem import Problem
from sie import Array, Complex, Index


class Fields(Protocol):
    """Pressure, gap, displacement and summary numbers of a solved contact.

    Zones are in the order of `zone_table`, which `Solution` sorts by position.
    """

    @property
    def problem(self) -> Problem:
        """The problem of the scene in scaled variables."""

    # The next members are functions of the place x [m], an array of any shape.

    def pressure(self, x: ArrayLike) -> Array:
        """Pressure [Pa]; 0 at places where the surfaces neither touch nor attract each other."""

    def pressure_at(self, zone: int, t: ArrayLike) -> Array:
        """Pressure [Pa] in a zone at positions t from -1 to 1, accurate up to the zone's ends."""

    def gap(self, x: ArrayLike) -> Array:
        """Gap [m]: 0 in contact, inf at places where the profile is not defined."""

    def displacement(self, x: ArrayLike) -> Array:
        """Displacement into the body [m]."""

    # The next members concern the body below the surface.

    def pressure_transform(self, x: Array, y: Array) -> tuple[Complex, Complex]:
        """Transform F [Pa] of the pressure and its derivative [Pa/m] at points z = x + iy [m].

        F(z) = (1/pi) int p(xi) K(z - xi) dxi, with the pressure p and the kernel K of a half-plane.
        On the surface F is the limit from inside the body, so that Im F = -p. y must not be
        negative, and x and y have the same shape.
        """

    @property
    def deep_pressure(self) -> float:
        """Limit of -Im F [Pa] far below the surface, with F as in `pressure_transform`.
        It is the mean or nominal pressure, and 0 if there is neither.
        """

    # The next members describe the zones.

    @property
    def zone_table(self) -> Array:
        """Ends of the zones [m], (n, 2)."""

    @property
    def loads(self) -> Array:
        """Load of each zone [N/m], (n,)."""

    @property
    def levels(self) -> Array:
        """Minus the scaled approach, computed at each zone; the values differ by errors only."""

    def end_remainders(self, table: Array, order: Index) -> Array | None:
        """Exact ends of zones minus the ends in `table`, which are rounded [m]; None if unknown.

        Row k of `table` is row order[k] of `zone_table`, moved by whole periods.
        """

    @property
    def cohesive(self) -> Array:
        """Intervals (n, 2) [m] in which a tension acts, including the contact inside them."""

    @property
    def plateaus(self) -> Array:
        """Intervals (n, 2) [m] within the zones, on which the pressure is at its limit."""

    def overlap(self, x: ArrayLike) -> Array:
        """Overlap of the elastic surfaces [m] at x [m]; 0 off the plateaus."""

    # The next members are numbers of the whole contact.

    @property
    def load(self) -> float:
        """Load [N/m]; in a periodic contact, the load on one period."""

    @property
    def approach(self) -> float | None:
        """Approach [m]; None if the displacement of the body has no datum."""

    @property
    def stiffness(self) -> float | None:
        """Derivative of the load by the approach [N/m^2]; None without an approach."""

    @property
    def contact_fraction(self) -> float:
        """Total width of the zones divided by the period."""

    @property
    def widening_rate(self) -> float:
        """Derivative of the contact fraction by the load [m/N]."""

    @property
    def mean_gap(self) -> float:
        """Mean gap over the period [m]."""

    @property
    def max_pressure(self) -> float:
        """Largest pressure [Pa]; inf if a sharp corner or a convex kink is in contact."""

    @property
    def pressure_bound(self) -> float:
        """An upper bound of the pressure [Pa] that takes little time; inf if none is known."""

    @property
    def gap_rounding(self) -> float:
        """Size of the error of the scaled gap that is due to round-off."""

    @property
    def borne_beside(self) -> float:
        """Scaled integral of p (F - gap) over all places outside contact.
        Here p is the pressure (a tension outside contact) and F the height of the profile.

        The elastic energy contains this integral.
        """

    # The next members concern the rotation of the body. They are None in `GapFields` and `NoZones`.

    @property
    def tilt(self) -> float | None:
        """Angle by which the body is turned [rad]."""

    @property
    def moment(self) -> float | None:
        """Moment of the pressure p about x = 0, int p x dx [N]."""

    @property
    def rotational_stiffness(self) -> float | None:
        """Derivative of the moment by the tilt at the given load [N]."""
