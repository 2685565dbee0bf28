"""Inverse design under JKR adhesion: exact contacts of any given zones with p ~ -sqrt(E*
w/pi)/sqrt(d) at every end.

With X^2 the product over all zone ends (see product.py, whose factors are meant by x - e here) the
function

    X R,   R = M + sum_e q_e/(x - e),   q_e = +-(2/E*) sqrt(E* w/pi)/sqrt(prod of the other factors at e),

is f' - (2/E*)(1/pi) int p/(x - xi) dxi, f' its polynomial part: in the gaps it is the slope of the
gap, on the zones p = +-(E*/2)|X| R. The polynomial M (degree n - 1 alone; with a period the n + 1
cosines and sines of pi k x/L, k = n, n - 2, .., and cosines for poles where n is even) makes int X
R vanish over every gap, so that all zones have one approach, and carries the load: linear
equations. Derived from the general solution of N. I. Muskhelishvili, Singular Integral Equations
(1953), ch. 11, with its solutions that are unbounded at the ends, and the intensity of JKR (K. L.
Johnson, Int. J. Solids Struct. 32 (1995) 423, doi 10.1016/0020-7683(94)00111-9).

Local stability under a held load, by the second variation of the energy by the ends: an end that
moves outward by ds releases G ds and costs w ds, G = (pi/E*) K^2 of the end's own intensity, so
that the potential's second derivatives are dG_i/ds_j = 2 w d ln K_i/ds_j. Moving the end e_j at a
held load adds to X R (see adhesive.py) the field

    (A/(x - e_j) + T)/X,   A = +-(product of the other factors) q_j/2,

which has the power -3/2 at e_j; T, of degree n - 2 (with a period of the frequencies n - 2, n - 4,
..), keeps the approaches of all zones equal: the finite part of its integral over every gap
vanishes. Derived here; the matrix is symmetric because it is a second derivative, which nothing in
its making supposes.
"""

from dataclasses import dataclass
from functools import cached_property
from math import pi, sqrt
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray

from contact.model.checks import finite, keep, positive
from contact.model.profiles.fourier import Fourier
from contact.reference.inverse.designed import DesignedProfile, GivenZones, exp_of_power_sums
from contact.reference.inverse.product import CutProduct
from sie import Array, Mask


@dataclass(frozen=True, eq=False)
class AdhesiveDesign(GivenZones):
    """An exact JKR contact of given zones, load and work of adhesion, with p ~ -sqrt(E*
    w/pi)/sqrt(d) at every end.

    Whether the surfaces keep apart between the zones is `is_admissible`: weak loads with strong
    adhesion may not be. Derived from the general solution of N. I. Muskhelishvili, Singular
    Integral Equations (1953), ch. 11, and the intensity of K. L. Johnson, Int. J. Solids Struct. 32
    (1995) 423, doi 10.1016/0020-7683(94)00111-9; see the head of this module.

    Parameters
    ----------
    zones : array_like, (n, 2)
        Ends of the zones [m], ascending; within one period if there is one.
    E_star : float
        Reduced modulus [Pa].
    load : float
        P of all zones, of any sign, per unit thickness, per period if there is one [N/m].
    work : float
        Work of adhesion w [J/m^2].
    period : float or None
        Period L [m]; None: the body is alone.

    Attributes
    ----------
    profile : DesignedProfile or Fourier
        The shape that has this contact.
    is_admissible : bool
        Whether the surfaces keep apart outside the zones.
    intensity : float
        sqrt(E* w/pi) [Pa m^(1/2)].
    max_pressure : float
        Greatest pressure [Pa].
    zone_loads, zone_widths : array, (n,)
        Load [N/m] and width [m] of every zone.
    mean_pressure, contact_fraction : float or None
        P/L [Pa], and the share of the period in contact; None without a period.
    nearness : float
        Narrowest gap over widest zone: what makes a problem hard.
    approach, mean_gap : float or None
        From min f = 0 and mean u = 0 [m]; None without a period.
    pressure, gap, gap_slope, displacement, height, slope : callable
        p [Pa], gap [m], its slope, u [m] (with a period), f [m] up to a constant and f' at
        positions x [m] of any shape.
    pressure_at : callable
        p [Pa] at normalised positions t in [-1, 1] of a zone, to rounding up to its ends.

    Raises
    ------
    SceneError
        If the modulus, the work or the period is not positive and finite, the load not finite, or
        the zones not strictly ascending and within one period.

    Examples
    --------
    One zone alone is that of a cylinder: P = pi E* a^2/4R - sqrt(2 pi E* a w).

    >>> import numpy as np
    >>> from contact.inverse import AdhesiveDesign
    >>> load = np.pi / 4 - np.sqrt(2 * np.pi * 0.01)
    >>> cylinder = AdhesiveDesign(np.array([[-1.0, 1.0]]), E_star=1.0, load=load, work=0.01)
    >>> bool(np.isclose(cylinder.profile.coefficients[2], 0.5)), cylinder.is_admissible  # R = 1
    (True, True)
    """

    work: float
    period: float | None = None

    def __post_init__(self) -> None:
        keep(self, positive, "E_star", "work")
        keep(self, finite, "load")
        self._check()

    @property
    def intensity(self) -> float:
        """sqrt(E* w/pi) [Pa m^(1/2)]."""
        return sqrt(self.E_star * self.work / pi)

    def _side(self, i: int) -> float:
        """Sign of X on the gap i, or of p over |X| R on the zone i: + on the last."""
        return -1.0 if (len(self.zones) - (i // 2 + 1)) % 2 else 1.0

    @property
    def _signs(self) -> Array:
        """Of X in the gap beside every end."""
        return np.array([self._side(e if e % 2 else e - 1) for e in range(2 * len(self.zones))])

    # R
    @cached_property
    def _poles(self) -> NDArray[np.floating]:
        """q_e."""
        product = self._long
        per_length = 1.0 / product._unit if self.period is None else 2.0 * product._turn
        size = 2.0 * np.sqrt(np.longdouble(self.work) / (product.pi * self.E_star))
        return np.asarray(self._signs * size * np.sqrt(per_length / product.end_factors()))

    def _modes(self, product: CutProduct, i: int, dl: Any, dr: Any) -> Any:
        """The functions of which M is made, (..., count)."""
        n, ends = len(self.zones), product.zones.ravel()
        if self.period is None:
            # The local coordinate from the nearer end of the hull: x itself is rounded, but M is
            # smooth.
            half = 2.0 * product._unit
            x = ends[0] - dr if i < 0 else ends[i] + dl
            return chebyshev.chebvander(((x - ends[0]) - (ends[-1] - x)) / (2.0 * half), n - 1)
        x = product._turn * (ends[i] + dl)
        modes = [f(k * x) for k in range(n, 0, -2) for f in (np.cos, np.sin)]
        return np.stack(modes if n % 2 else [*modes, np.ones_like(x)], axis=-1)

    def _integrals(self, i: int) -> tuple[Any, Any]:
        """int |X| modes dx and int |X| sum q_e/(x - e) dx over an interval."""
        dl, dr, weight = self._long.nodes(i)
        weight = weight * self._long.root(i, dl, dr)
        return weight @ self._modes(self._long, i, dl, dr), weight @ (
            self._long.poles(i, dl, dr) @ self._poles
        )

    @cached_property
    def _zone_integrals(self) -> tuple[Any, Any]:
        """Zone loads by modes, and by the poles."""
        half = np.longdouble(self.E_star) / 2
        each = [
            (self._side(i) * half, *self._integrals(i)) for i in range(0, 2 * len(self.zones), 2)
        ]
        return np.array([s * m for s, m, _ in each]), np.array([s * q for s, _, q in each])

    @cached_property
    def _smooth(self) -> Any:
        """Coefficients of M."""
        modes, poles = self._zone_integrals
        gaps = [self._integrals(g) for g in self._long.gaps]
        matrix = np.array([*(m for m, _ in gaps), np.sum(modes, axis=0)])
        right = np.array([*(-q for _, q in gaps), self.load - np.sum(poles)])
        size = np.max(np.abs(matrix), axis=1)
        matrix, right = matrix / size[:, None], right / size
        solution = np.zeros_like(right)
        for _ in range(4):  # refined in the long precision
            step = np.linalg.solve(matrix.astype(float), (right - matrix @ solution).astype(float))
            solution = solution + step
        return solution

    def _ratio(self, i: int, dl: Any, dr: Any) -> Any:
        """R in double precision."""
        smooth = self._modes(self._product, i, dl, dr) @ self._smooth.astype(float)
        return smooth + self._product.poles(i, dl, dr) @ self._poles.astype(float)

    # The profile: the polynomial part of X R
    @cached_property
    def profile(self) -> DesignedProfile | Fourier:
        """The shape with this contact."""
        n, ends = len(self.zones), self._long.zones.ravel()
        hull = (float(ends[0]), float(ends[-1]))
        if self.period is None:
            # x = middle + half (v + 1/v)/2 maps (x - e)/unit to v (1 - e^{i phi}/v)(1 - e^{-i
            # phi}/v).
            phi = 2.0 * np.arctan2(np.sqrt(ends[-1] - ends), np.sqrt(ends - ends[0]))
            root = exp_of_power_sums(np.array([np.sum(np.cos(k * phi)) for k in range(2 * n)])).real
            ratio = np.zeros(2 * n, dtype=np.longdouble)  # of v^(n-1), .., v^-n
            ratio[n - 1 :: -1] += 0.5 * self._smooth
            ratio[n - 1 : -1] += 0.5 * self._smooth
            # unit/(x - e) = sum U_k(cos phi) v^(-k-1)
            second, older = np.ones_like(phi), np.zeros_like(phi)
            for k in range(n):
                ratio[n + k] += np.sum(self._poles * second)
                second, older = 2.0 * np.cos(phi) * second - older, second
            series = 2.0 * np.convolve(root, ratio)[: 2 * n][::-1]
            series[0] *= 0.5
            return DesignedProfile(series.astype(float), hull)
        # Above the axis, w = e^{2 pi i z/L}: 2 sin(pi (z - e)/L) = i e^{-i pi (z - e)/L} (1 - w
        # e^{-2 pi i e/L}).
        angle = self._long._turn * ends
        power_sums = np.array([0.5 * np.sum(np.exp(-2j * k * angle)) for k in range(n + 1)])
        root = np.exp(0.5j * (np.sum(angle) + n * self._long.pi)) * exp_of_power_sums(power_sums)
        ratio = np.zeros(n + 1, dtype=np.clongdouble)  # of e^{i pi z (2j - n)/L}
        count = (n + 1) // 2
        cosine, sine = self._smooth[: 2 * count].reshape(count, 2).T
        ratio[:count] = 0.5 * (cosine + 1j * sine)
        ratio[: n - count : -1] = 0.5 * (cosine - 1j * sine)
        if n % 2 == 0:
            ratio[count] = self._smooth[-1] - 0.5j * np.sum(self._poles)
        above = np.arange(n // 2 + 1, n + 1)
        ratio[above] -= 1j * (np.exp(-1j * np.outer(2 * above - n, angle)) @ self._poles)
        return self._of_slope(np.convolve(root, ratio)[:n][::-1])

    @cached_property
    def zone_loads(self) -> Array:
        """Load of every zone [N/m]."""
        modes, poles = self._zone_integrals
        return np.asarray(modes @ self._smooth + poles, dtype=float)

    def _zone_pressure(self, i: int, dl: Array, dr: Array) -> Array:
        with np.errstate(invalid="ignore"):
            p = 0.5 * self.E_star * self._opening(i, dl, dr)
        return np.asarray(np.where(np.isnan(p), -np.inf, p), dtype=float)

    def _opening(self, i: int, dl: Array, dr: Array) -> Array:
        """Slope of the gap in the gap i (-1: left of all zones), or p/(E*/2) on a zone."""
        return np.asarray(self._side(i) * self._product.root(i, dl, dr) * self._ratio(i, dl, dr))

    def _from_left(self, i: int, dl: Array, dr: Array) -> Mask:
        """From the nearer end."""
        return np.asarray((dl <= dr) | np.isnan(dr)) if i >= 0 else np.zeros(dl.shape, dtype=bool)

    @cached_property
    def max_pressure(self) -> float:
        """Greatest pressure [Pa]."""
        return self._greatest(1e-6, 257)

    @cached_property
    def is_admissible(self) -> bool:
        """Whether the surfaces keep apart outside the zones: by sums of the gap's slope over 400
        angles from either end, beyond the zones by the slope's sign.
        """
        ends = self._product.zones.ravel()
        phi = pi * (np.arange(400) + 0.5) / 400
        for g in self._product.gaps:
            h = float(self._product.steps[g])
            rise = np.sin(phi) * self._opening(
                g, h * np.sin(0.5 * phi) ** 2, h * np.cos(0.5 * phi) ** 2
            )
            if min(np.min(np.cumsum(rise[:200])), np.min(np.cumsum(-rise[:199:-1]))) <= 0.0:
                return False
        if self.period is not None:
            return True
        beyond = float(ends[-1] - ends[0]) * np.geomspace(1e-9, 1e6, 400)
        return bool(
            np.all(self.gap_slope(ends[-1] + beyond) > 0.0)
            and np.all(self.gap_slope(ends[0] - beyond) < 0.0)
        )


def adhesive_design(
    zones: ArrayLike, E_star: float, load: float, work: float, period: float | None = None
) -> AdhesiveDesign:
    """The exact JKR contact with these zones, this load (per period) and this work of adhesion.

    Parameters
    ----------
    zones : array_like, (n, 2)
        Ends of the zones [m], ascending; within one period if there is one.
    E_star : float
        Reduced modulus [Pa].
    load : float
        P of all zones, of any sign, per unit thickness, per period if there is one [N/m].
    work : float
        Work of adhesion w [J/m^2].
    period : float or None
        Period L [m]; None: the body is alone.

    Returns
    -------
    AdhesiveDesign
        With its `profile`, to be given to `contact.Scene` under `contact.JKR(work)`.

    Raises
    ------
    SceneError
        If the modulus, the work or the period is not positive and finite, the load not finite, or
        the zones not strictly ascending and within one period.

    Examples
    --------
    At every end p sqrt(d) tends to -sqrt(E* w/pi).

    >>> import numpy as np
    >>> from contact.inverse import adhesive_design
    >>> made = adhesive_design([[-2.0, -1.0], [0.5, 3.0]], E_star=1.0, load=0.1, work=1e-4)
    >>> p = [made.pressure_at(-1 + 2e-9, 0) * np.sqrt(1e-9), made.pressure_at(1 - 1e-9, 1) * np.sqrt(1.25e-9)]
    >>> bool(np.allclose(p, -made.intensity, rtol=1e-4))
    True
    """
    return AdhesiveDesign(np.asarray(zones), E_star, load, work, period)


def second_variation(design: AdhesiveDesign) -> Array:
    """Second derivatives of the energy of a designed JKR contact by its ends, d^2 energy/ds_i ds_j,
    at a held load.

    The contact is locally stable under that load where the matrix is positive definite. Derived
    here, see the head of this module.

    Parameters
    ----------
    design : AdhesiveDesign
        The contact, of n zones.

    Returns
    -------
    array, (2 n, 2 n)
        [J/m^3], by the outward movements of the ends in ascending order.

    Examples
    --------
    At pull-off of a cylinder, a^3 = 2 R^2 w/(pi E*), the zone can widen on both sides without
    force.

    >>> import numpy as np
    >>> from contact.inverse import adhesive_design, second_variation
    >>> load = np.pi / 4 - np.pi  # R = E* = a = 1 and w = pi/2
    >>> matrix = second_variation(adhesive_design([[-1.0, 1.0]], E_star=1.0, load=load, work=np.pi / 2))
    >>> bool(np.allclose(matrix, matrix.T)), bool(abs(np.sum(matrix)) < 1e-9 * np.max(np.abs(matrix)))
    (True, True)
    """
    product, m, q = design._product, 2 * len(design.zones), design._poles.astype(float)
    outward, sigma = np.where(np.arange(m) % 2, 1.0, -1.0), design._signs
    unit = float(product._unit) if design.period is None else design.period / (2.0 * pi)
    others = product.end_factors()
    root = np.sqrt(others)
    k = outward * sigma * root * q  # X R ~ k/sqrt|factor| in the gap beside the end
    places = [product.at_end(e) for e in range(m)]
    poles = np.array(
        [product.poles(*place)[0] for place in places]
    )  # [i, j]: that of end j seen from end i
    np.fill_diagonal(poles, 0.0)
    modes = np.array([design._modes(product, *place)[0] for place in places])
    slow_modes = _slow(design, modes)
    strength = outward * others * q / (2.0 * unit)
    answers = _slow_parts(design, strength, unit)
    regular = modes @ design._smooth.astype(float) + poles @ q
    change = np.empty((m, m))  # d k_i/d e_j
    for j in range(m):
        slow = slow_modes @ answers[j]
        change[:, j] = sigma / root * (strength[j] * poles[:, j] + slow)
        # The next power of X R at the end, half of which the moved root gives; the bend of the
        # other factors cancels.
        change[j, j] = sigma[j] * (
            outward[j] * root[j] * regular[j] / (2.0 * unit) + slow[j] / root[j]
        )
    return np.asarray(2.0 * design.work * change / k[:, None] * outward, dtype=float)


def is_stable(design: AdhesiveDesign) -> bool:
    """Whether a designed JKR contact is locally stable under a held load: the second variation is
    positive definite.

    Derived here, see the head of this module.

    Parameters
    ----------
    design : AdhesiveDesign
        The contact.

    Returns
    -------
    bool

    Examples
    --------
    A cylinder is stable where its zone is wider than at pull-off, a^3 = 2 R^2 w/(pi E*).

    >>> import numpy as np
    >>> from contact.inverse import adhesive_design, is_stable
    >>> works = [1.5, 1.6]  # R = E* = a = 1: pull-off at w = pi/2
    >>> loads = [np.pi / 4 - np.sqrt(2 * np.pi * w) for w in works]
    >>> [is_stable(adhesive_design([[-1.0, 1.0]], 1.0, load, w)) for load, w in zip(loads, works)]
    [True, False]
    """
    matrix = second_variation(design)
    return bool(np.min(np.linalg.eigvalsh(0.5 * (matrix + matrix.T))) > 0.0)


def _slow(design: AdhesiveDesign, modes: Array) -> Array:
    """The functions of which T is made, (..., n - 1): those of M without the fastest."""
    return modes[..., :-1] if design.period is None else modes[..., 2:]


def _slow_parts(design: AdhesiveDesign, strength: Array, unit: float) -> Array:
    """Coefficients of T for every end moved, (2n, n - 1)."""
    product, n = design._product, len(design.zones)
    others = product.end_factors()
    m, gaps = (
        2 * n,
        list(design._product.gaps)[: n - 1],
    )  # with a period the last gap closes by itself
    matrix, given = np.zeros((n - 1, n - 1)), np.zeros((n - 1, m))
    for row, g in enumerate(gaps):
        dl, dr, weight = product.nodes(g)
        x_root = product.root(g, dl, dr)
        matrix[row] = weight / x_root @ _slow(design, design._modes(product, g, dl, dr))
        poles = product.poles(g, dl, dr)
        for j in range(m):
            field = strength[j] * poles[:, j] / x_root
            if j in (g, (g + 1) % m):
                # Less a multiple of d/dx (X pole), whose integral has no finite part, it is
                # integrable.
                share = (-2.0 if j == g else 2.0) * unit * strength[j] / others[j]
                field = field - share * _exact_slope(design, g, dl, dr, j, poles[:, j], x_root)
            given[row, j] = -np.sum(weight * field)
    return np.asarray(np.linalg.solve(matrix, given).T) if n > 1 else np.zeros((m, 0))


def _exact_slope(
    design: AdhesiveDesign, g: int, dl: Array, dr: Array, j: int, pole: Any, x_root: Any
) -> Array:
    """d/dx (|X| pole_j) in the gap g."""
    product = design._product
    ends = product.zones.ravel()
    x = ends[g] + dl
    ahead = x[:, None] - ends
    ahead[:, g] = dl
    other = (g + 1) % len(ends)
    ahead[:, other] = -dr
    if design.period is None:
        bends, fall = 1.0 / ahead, -pole / ahead[:, j]
    else:
        turn = pi / design.period
        bends = turn / np.tan(turn * ahead)
        own = turn * ahead[:, j]
        fall = (
            -pole * turn / np.tan(own) if len(design.zones) % 2 else -0.5 * turn / np.sin(own) ** 2
        )
    return np.asarray(x_root * (0.5 * np.sum(bends, axis=1) * pole + fall))
