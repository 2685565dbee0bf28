"""Where the spots stand: hexagonal and square lattices, or a mere number per unit area.

A ring is all the spots at one distance from the spot looked at.
"""

from dataclasses import dataclass
from math import isinf, pi, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact.errors import SceneError
from contact.model.checks import keep, positive
from sie import Array

Site = tuple[float, float]

_SAME = 1e-9  # distances that differ by less, relative to the spacing, are one ring


@dataclass(frozen=True)
class Density:
    """So many spots per unit area, their places unknown: the first step of the localization only.

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
    Without neighbours in their places a lattice says no more than its density.

    >>> import numpy as np
    >>> from contact.axisymmetric import Density, Sphere, Square, solve_spot
    >>> spots = [solve_spot(Sphere(1e-3), 1e11, place, load=0.01) for place in (Density(1e8), Square(1e-4))]
    >>> bool(np.isclose(spots[0].radius, spots[1].radius))
    True
    """

    value: float

    def __post_init__(self) -> None:
        keep(self, positive, "value")

    @property
    def density(self) -> float:
        """Spots per unit area [1/m^2]."""
        return self.value


@dataclass(frozen=True)
class Lattice:
    """Spots that repeat in the plane; the base of the lattices: a subclass names its two unit
    vectors.

    Parameters
    ----------
    spacing : float
        Distance l of the nearest spots [m].

    Attributes
    ----------
    unit_basis : array, (2, 2)
        The unit vectors as rows, in units of l; what a subclass defines.
    unit_area : float
        Area of the cell over l^2.
    density : float
        Spots per unit area [1/m^2].
    neighbours, distances : callable
        Radii [m] and numbers of spots of the first rings; distances over l up to a reach.

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
        """The unit vectors as rows, in units of the spacing."""
        raise NotImplementedError(f"{type(self).__name__} must define unit_basis")

    @property
    def unit_area(self) -> float:
        """Area of the cell over l^2."""
        return float(abs(np.linalg.det(self.unit_basis)))

    @property
    def density(self) -> float:
        """Cells per unit area [1/m^2]: the spots', one a cell."""
        return 1.0 / (self.unit_area * self.spacing**2)

    def distances(self, shift: Site, reach: float) -> Array:
        """|R + shift|/l up to `reach`, ascending, over all cells R; the shift in fractions of the
        unit vectors.

        The distance 0, the spot's own, is left out.
        """
        basis = self.unit_basis
        # The rows of the inverse bound the fractions of any point within the reach.
        count = np.ceil(reach * np.linalg.norm(np.linalg.inv(basis), axis=0)).astype(int) + 2
        i, j = np.meshgrid(*(np.arange(-n, n + 1) for n in count), indexing="ij")
        points = np.stack([i.ravel() + shift[0], j.ravel() + shift[1]], axis=1) @ basis
        length = np.sort(np.hypot(points[:, 0], points[:, 1]))
        return length[(length > _SAME) & (length <= reach * (1 + _SAME))]

    def neighbours(self, rings: int) -> tuple[Array, NDArray[np.int64]]:
        """Distances [m] of the first `rings` rings, and how many spots each has."""
        radii, counts = self._first_rings([(0.0, 0.0)], rings)
        return radii * self.spacing, counts

    def rings(self, shifts: list[Site], reach: float) -> tuple[Array, NDArray[np.int64]]:
        """Radius/l and number of spots of the rings up to a reach, of the lattice's points moved by
        all the shifts.
        """
        found = np.sort(np.concatenate([self.distances(s, reach) for s in shifts]))
        first = np.flatnonzero(np.diff(found, prepend=-1.0) > _SAME)
        return found[first], np.diff(np.append(first, found.size))

    def _first_rings(self, shifts: list[Site], count: int) -> tuple[Array, NDArray[np.int64]]:
        reach = 1.0 + sqrt(count)
        while len((found := self.rings(shifts, reach))[0]) <= count:
            reach *= 1.5
        return found[0][:count], found[1][:count]

    def cut(self, shifts: list[Site], rings: float) -> float:
        """Distance/l of the last ring kept, rings counted over the lattice's points moved by all
        the shifts; inf: all are kept.
        """
        return (
            rings
            if rings == 0 or isinf(rings)
            else float(self._first_rings(shifts, int(rings))[0][-1])
        )

    def holds(self, shift: Site) -> bool:
        """Whether it is a point of the lattice, in fractions of the unit vectors."""
        rest = np.array(shift) - np.round(shift)
        return float(np.hypot(*(rest @ self.unit_basis))) < _SAME


@dataclass(frozen=True)
class Hexagonal(Lattice):
    """Spots at the corners of equal triangles of side l: 2/(sqrt(3) l^2) of them per unit area.

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
    """Spots at the corners of squares of side l: 1/l^2 of them per unit area.

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
    """A = (pi N)^(-1/2), the circle whose area is a spot's share.

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
    """A lattice or a density, or None: a spot alone."""
    if value is None or isinstance(value, (Lattice, Density)):
        return value
    raise SceneError.of(
        "lattice", value, "Hexagonal(spacing), Square(spacing), Density(value) or None"
    )
