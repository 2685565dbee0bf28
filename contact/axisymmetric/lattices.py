"""The places of the spots: hexagonal and square lattices, or only a density.

A ring is the set of all spots at the same distance from a given spot.
"""

from dataclasses import dataclass
from math import isinf, pi, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact.errors import SceneError
from contact.model.checks import keep, positive
from contact.model.profiles.noise import ROUND_OFF
from sie import Array

Site = tuple[float, float]


@dataclass(frozen=True)
class Density:
    """Number of spots per unit area, for spots at unknown places.

    Only the first step of the localization (`rings=0`) can use it.

    Parameters
    ----------
    value : float
        Spots per unit area [1/m^2].

    Attributes
    ----------
    density : float
        The value [1/m^2].

    Raises
    ------
    SceneError
        If the value is not positive and finite.

    Examples
    --------
    With `rings=0` only the density of a lattice matters.

    >>> import numpy as np
    >>> from contact.axisymmetric import Density, Sphere, Square, solve_spot
    >>> places = (Density(1e8), Square(1e-4))
    >>> spots = [solve_spot(Sphere(1e-3), 1e11, place, load=0.01) for place in places]
    >>> bool(np.isclose(spots[0].radius, spots[1].radius))
    True
    """

    value: float

    def __post_init__(self) -> None:
        keep(self, positive, "value")

    @property
    def density(self) -> float:
        """Number of spots per unit area [1/m^2]."""
        return self.value


@dataclass(frozen=True)
class Lattice:
    """Base class of the lattices; a subclass defines the two basis vectors.

    Parameters
    ----------
    spacing : float
        Distance l of nearest spots [m].

    Attributes
    ----------
    unit_basis : array, (2, 2)
        The basis vectors as rows, in units of l; defined by the subclass.
    unit_area : float
        Area of the cell, divided by l^2.
    density : float
        Spots per unit area [1/m^2].
    neighbours, distances : callable
        Radii [m] and numbers of spots of the first rings; distances of lattice points, divided by
        l, up to a given distance.

    Raises
    ------
    SceneError
        If the spacing is not positive and finite.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.axisymmetric import Lattice
    >>> class Bricks(Lattice):
    ...     unit_basis = np.array([[1.0, 0.0], [0.5, 2.0]])
    >>> radii, counts = Bricks(1e-4).neighbours(2)
    >>> bool(np.allclose(radii, [1e-4, 2e-4])), counts.tolist(), Bricks(1e-4).unit_area
    (True, [2, 2], 2.0)
    """

    spacing: float

    def __post_init__(self) -> None:
        keep(self, positive, "spacing")

    @property
    def unit_basis(self) -> Array:
        """The two basis vectors of the lattice, divided by its spacing, as the rows of a matrix."""
        raise NotImplementedError(f"{type(self).__name__} must define unit_basis")

    @property
    def unit_area(self) -> float:
        """Area of the cell, divided by the square of the spacing."""
        return float(abs(np.linalg.det(self.unit_basis)))

    @property
    def density(self) -> float:
        """Number of cells per unit area [1/m^2]; each cell has one spot."""
        return 1.0 / (self.unit_area * self.spacing**2)

    def distances(self, shift: Site, reach: float) -> Array:
        """Ascending distances of a shifted lattice's points from the origin, in spacings.

        They are |R + shift|/l, above 0 and up to `reach`. R runs over all lattice points, and l is
        the spacing.

        The shift is in fractions of the basis vectors.
        """
        basis = self.unit_basis
        # If a lattice point is within the distance `reach` of the origin, its cell indices are at
        # most `reach` times the norms of the inverse basis's columns. The margin of 2 allows for
        # the shift.
        count = np.ceil(reach * np.linalg.norm(np.linalg.inv(basis), axis=0)).astype(int) + 2
        i, j = np.meshgrid(*(np.arange(-n, n + 1) for n in count), indexing="ij")
        points = np.stack([i.ravel() + shift[0], j.ravel() + shift[1]], axis=1) @ basis
        length = np.sort(np.hypot(points[:, 0], points[:, 1]))
        return length[(length > ROUND_OFF) & (length <= reach * (1 + ROUND_OFF))]

    def neighbours(self, rings: int) -> tuple[Array, NDArray[np.int64]]:
        """(radii [m], numbers of spots) of the first `rings` rings of neighbours of one spot."""
        radii, counts = self._first_rings([(0.0, 0.0)], rings)
        return radii * self.spacing, counts

    def rings(self, shifts: list[Site], reach: float) -> tuple[Array, NDArray[np.int64]]:
        """(radii of the rings of shifted lattices, in spacings; number of lattice points on each).
        A ring is a circle about the origin on which points of the lattices lie.

        The radii are ascending, and at most `reach`.
        """
        found = np.sort(np.concatenate([self.distances(s, reach) for s in shifts]))
        first = np.flatnonzero(np.diff(found, prepend=-1.0) > ROUND_OFF)
        return found[first], np.diff(np.append(first, found.size))

    def _first_rings(self, shifts: list[Site], count: int) -> tuple[Array, NDArray[np.int64]]:
        reach = 1.0 + sqrt(count)
        while len((found := self.rings(shifts, reach))[0]) <= count:
            reach *= 1.5
        return found[0][:count], found[1][:count]

    def cut(self, shifts: list[Site], rings: float) -> float:
        """Radius of ring number `rings`, divided by the spacing; 0 for ring 0, inf for ring inf.
        A ring is a circle about the origin on which lattice points lie.
        """
        return (
            rings
            if rings == 0 or isinf(rings)
            else float(self._first_rings(shifts, int(rings))[0][-1])
        )

    def holds(self, shift: Site) -> bool:
        """Whether a point, given in fractions of the basis vectors, is a lattice point."""
        rest = np.array(shift) - np.round(shift)
        return float(np.hypot(*(rest @ self.unit_basis))) < ROUND_OFF


@dataclass(frozen=True)
class Hexagonal(Lattice):
    """A hexagonal lattice: triangles of side l, with 2/(sqrt(3) l^2) spots per unit area.

    Parameters
    ----------
    spacing : float
        l [m].

    Attributes
    ----------
    density : float
        Spots per unit area [1/m^2].
    neighbours : callable
        Radii [m] and numbers of spots of the first rings.

    Raises
    ------
    SceneError
        If the spacing is not positive and finite.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.axisymmetric import Hexagonal
    >>> radii, counts = Hexagonal(spacing=1.0).neighbours(3)
    >>> bool(np.allclose(radii, [1.0, np.sqrt(3), 2.0])), counts.tolist()
    (True, [6, 6, 6])
    """

    unit_basis = np.array([[1.0, 0.0], [0.5, 0.5 * sqrt(3.0)]])  # type: ignore[assignment]


@dataclass(frozen=True)
class Square(Lattice):
    """A square lattice of side l, with 1/l^2 spots per unit area.

    Parameters
    ----------
    spacing : float
        l [m].

    Attributes
    ----------
    density : float
        Spots per unit area [1/m^2].
    neighbours : callable
        Radii [m] and numbers of spots of the first rings.

    Raises
    ------
    SceneError
        If the spacing is not positive and finite.

    Examples
    --------
    >>> import numpy as np
    >>> from contact.axisymmetric import Square
    >>> radii, counts = Square(spacing=1.0).neighbours(4)
    >>> bool(np.allclose(radii, np.sqrt([1, 2, 4, 5]))), counts.tolist()
    (True, [4, 4, 4, 8])
    """

    unit_basis = np.eye(2)  # type: ignore[assignment]


def own_radius(density: float) -> float:
    """Radius A = (pi N)^(-1/2) of a circle whose area is the area per spot.
    N is the number of spots per unit area.

    Parameters
    ----------
    density : float
        N spots per unit area [1/m^2].

    Returns
    -------
    float
        [m].

    Examples
    --------
    >>> import numpy as np
    >>> from contact.axisymmetric import Hexagonal, own_radius
    >>> bool(np.isclose(np.pi * own_radius(Hexagonal(1e-4).density) ** 2, np.sqrt(0.75) * 1e-8))
    True
    """
    return 1.0 / sqrt(pi * density)


def as_lattice(value: Any) -> Lattice | Density | None:
    """`value` itself if it is a lattice, a density or None (a single spot).
    Any other value raises SceneError.
    """
    if value is None or isinstance(value, (Lattice, Density)):
        return value
    raise SceneError.of(
        "lattice", value, "Hexagonal(spacing), Square(spacing), Density(value) or None"
    )
