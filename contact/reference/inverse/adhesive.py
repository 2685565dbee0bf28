"""Inverse design under JKR adhesion: p ~ -sqrt(E* w/pi)/sqrt(d) at every end.

Here d is the distance from the end and w the work of adhesion. X^2 is the product of the factors of
all zone ends e, written x - e here (see product.py). The function

    X R,   R = M + sum_e q_e/(x - e),
    q_e = +-(2/E*) sqrt(E* w/pi)/sqrt(product of the other factors at e),

equals f' - (2/E*)(1/pi) int p/(x - xi) dxi, and f' is the polynomial part of X R. In the gaps X R
is the slope of the gap; on the zones p = +-(E*/2)|X| R. M is a polynomial of degree n - 1. With a
period M is a sum of the n + 1 cosines and sines of pi k x/L, k = n, n - 2, .., and the poles
1/(x - e) are replaced by those of `CutProduct.poles`. Linear equations determine M: int X R
vanishes over every gap, so that all zones have one approach, and the pressure carries the load.
Derived from the general solution of N. I. Muskhelishvili, Singular Integral Equations (1953), ch.
11, with its solutions that are unbounded at the ends, and the intensity of JKR (K. L. Johnson, Int.
J. Solids Struct. 32 (1995) 423, doi 10.1016/0020-7683(94)00111-9).

Local stability at prescribed load follows from the second variation of the energy by the outward
movements s_i of the ends. An end that moves outward changes the energy at the rate G_i - w, where
G_i = (pi/E*) K_i^2 with the intensity K_i of p ~ -K_i/sqrt(d). In equilibrium G_i = w, so the
second derivatives are dG_i/ds_j = 2 w d ln K_i/ds_j. Moving the end e_j at a prescribed load adds
to X R the field

    (A/(x - e_j) + T)/X,   A = +-(product of the other factors) q_j/2,

which has the power -3/2 at e_j. T is a polynomial of degree n - 2, or with a period a sum of waves
of the frequencies n - 2, n - 4, .. It keeps the approaches of all zones equal: the finite part of
the integral of the field over every gap vanishes. Derived here. The matrix is symmetric, as a
second derivative is; its computation does not assume that.
"""

from dataclasses import dataclass
from functools import cached_property
from math import pi, sqrt
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from contact.model.checks import finite, keep, positive
from contact.model.profiles.fourier import Fourier
from contact.reference.inverse.designed import DesignedProfile, GivenZones, exp_of_power_sums
from contact.reference.inverse.product import CutProduct
from sie import Array, Mask


@dataclass(frozen=True, eq=False)
class AdhesiveDesign(GivenZones):
    """An exact contact with JKR adhesion for given zones, load and work of adhesion.
    The profile of the body follows from them.

    At every end p ~ -sqrt(E* w/pi)/sqrt(d).

    `is_admissible` says whether the surfaces stay separate between the zones; for small loads with
    strong adhesion they may overlap. Derived from the general solution of N. I. Muskhelishvili,
    Singular Integral Equations (1953), ch. 11, and the intensity of K. L. Johnson, Int. J. Solids
    Struct. 32 (1995) 423, doi 10.1016/0020-7683(94)00111-9; see the head of this module.

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
        Period L [m]; None: the body is isolated.

    Attributes
    ----------
    profile : DesignedProfile or Fourier
        The profile that has this contact.
    is_admissible : bool
        Whether the surfaces stay separate outside the zones.
    intensity : float
        sqrt(E* w/pi) [Pa m^(1/2)].
    max_pressure : float
        Largest pressure [Pa].
    zone_loads, zone_widths : array, (n,)
        Load [N/m] and width [m] of every zone.
    mean_pressure, contact_fraction : float or None
        P/L [Pa], and the part of the period in contact; None without a period.
    nearness : float
        Width of the narrowest gap divided by that of the widest zone; the problem is hard if it is
        small.
    approach, mean_gap : float or None
        With min f = 0 and mean u = 0 [m]; None without a period.
    pressure, gap, gap_slope, displacement, height, slope : callable
        p [Pa], gap [m], its slope, u [m] (with a period), f [m] up to a constant and f' at
        positions x [m] of any shape.
    pressure_at : callable
        p [Pa] at normalised positions t in [-1, 1] of a zone, accurate up to its ends.

    Raises
    ------
    SceneError
        If the modulus, the work or the period is not positive and finite, the load not finite, or
        the zones not strictly ascending and within one period.

    Examples
    --------
    One isolated zone is that of a cylinder: P = pi E* a^2/4R - sqrt(2 pi E* a w).

    >>> import numpy as np
    >>> from contact.inverse import AdhesiveDesign
    >>> load = np.pi / 4 - np.sqrt(2 * np.pi * 0.01)  # R = 1
    >>> cylinder = AdhesiveDesign(np.array([[-1.0, 1.0]]), E_star=1.0, load=load, work=0.01)
    >>> bool(np.isclose(cylinder.profile.coefficients[2], 0.5)), cylinder.is_admissible
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
        """Intensity sqrt(E* w/pi) [Pa m^(1/2)] of the pressure at every end.
        It is the factor of 1/sqrt(distance); w is the work of adhesion `work`.
        """
        return sqrt(self.E_star * self.work / pi)

    def _side(self, i: int) -> float:
        """Factor +-1 by which |X| R (head of this module) becomes the slope of the gap in gap i.

        On zone i it turns (E*/2)|X| R into the pressure. It is 1 on the last zone.
        """
        return -1.0 if (len(self.zones) - (i // 2 + 1)) % 2 else 1.0

    @property
    def _signs(self) -> Array:
        """Sign of X in the gap next to each zone end.
        X^2 is the product of the factors x - e of all ends e.
        """
        return np.array([self._side(e if e % 2 else e - 1) for e in range(2 * len(self.zones))])

    @cached_property
    def _poles(self) -> NDArray[np.floating]:
        """Coefficients q_e of the poles in R = M + sum_e q_e/(x - e), with M smooth.
        The slope of the gap is +-|X| R, where X^2 is the product of the factors x - e of all ends
        e.
        """
        product = self._extended
        per_length = 1.0 / product._unit if self.period is None else 2.0 * product._turn
        size = 2.0 * np.sqrt(np.longdouble(self.work) / (product.pi * self.E_star))
        return np.asarray(self._signs * size * np.sqrt(per_length / product.end_factors()))

    def _modes(self, product: CutProduct, i: int, dl: Any, dr: Any) -> Any:
        """Values of the basis functions of M at points of interval i.
        M is the smooth part of the function R = M + poles at the head of this module.

        The array is (..., number of functions).
        """
        n, ends = len(self.zones), product.zones.ravel()
        if self.period is None:
            # Unlike the distances dl and dr, the position x has a rounding error. This does no
            # harm, as the polynomial M (see the head of this file) is smooth.
            half = 2.0 * product._unit
            x = ends[0] - dr if i < 0 else ends[i] + dl
            return chebyshev.chebvander(((x - ends[0]) - (ends[-1] - x)) / (2.0 * half), n - 1)
        x = product._turn * (ends[i] + dl)
        modes = [f(k * x) for k in range(n, 0, -2) for f in (np.cos, np.sin)]
        return np.stack(modes if n % 2 else [*modes, np.ones_like(x)], axis=-1)

    def _integrals(self, i: int) -> tuple[Any, Any]:
        """(integrals of |X| times each basis function of M, integral of |X| times the poles of R).
        They are over interval i, a zone or a gap. X, M and R: head of this module.

        The first result is a row with one entry for each coefficient of M, the second is a number.
        """
        dl, dr, weight = self._extended.nodes(i)
        weight = weight * self._extended.root(i, dl, dr)
        return weight @ self._modes(self._extended, i, dl, dr), weight @ (
            self._extended.poles(i, dl, dr) @ self._poles
        )

    @cached_property
    def _zone_integrals(self) -> tuple[Any, Any]:
        """(loads of all zones due to each basis function of M, loads due to the poles of R).
        The pressure is +-(E*/2)|X| R, with R = M + poles (head of this module).

        The first array, (n, count), has one column for each coefficient of M; the second is (n,).
        """
        half = np.longdouble(self.E_star) / 2
        each = [
            (self._side(i) * half, *self._integrals(i)) for i in range(0, 2 * len(self.zones), 2)
        ]
        return np.array([s * m for s, m, _ in each]), np.array([s * q for s, _, q in each])

    @cached_property
    def _smooth(self) -> Any:
        """Coefficients of M in R = M + poles (head of this module), for the given load.
        All zones get the same approach, since the integral of X R over each gap is 0.
        """
        modes, poles = self._zone_integrals
        gaps = [self._integrals(g) for g in self._extended.gaps]
        matrix = np.array([*(m for m, _ in gaps), np.sum(modes, axis=0)])
        right = np.array([*(-q for _, q in gaps), self.load - np.sum(poles)])
        size = np.max(np.abs(matrix), axis=1)
        matrix, right = matrix / size[:, None], right / size
        solution = np.zeros_like(right)
        for _ in range(4):  # iterative refinement in extended precision
            step = np.linalg.solve(matrix.astype(float), (right - matrix @ solution).astype(float))
            solution = solution + step
        return solution

    def _ratio(self, i: int, dl: Any, dr: Any) -> Any:
        """The function R (head of this module) at points of interval i, in double precision.
        It is the smooth part M plus the poles, sum_e q_e/(x - e).
        """
        smooth = self._modes(self._product, i, dl, dr) @ self._smooth.astype(float)
        return smooth + self._product.poles(i, dl, dr) @ self._poles.astype(float)

    @cached_property
    def profile(self) -> DesignedProfile | Fourier:
        """The profile of the body that has this contact.

        Its slope is the polynomial part of the function X R (head of this module).
        """
        n, ends = len(self.zones), self._extended.zones.ravel()
        hull = (float(ends[0]), float(ends[-1]))
        if self.period is None:
            # X and R (head of this module) become series in powers of v, with x = middle +
            # half (v + 1/v)/2. Here middle is the hull's middle, and half is its half width. An end
            # is e = middle + half cos(phi). In units of `CutProduct._unit` = half/2, its factor in
            # X^2 is
            #     (x - e)/unit = v (1 - e^{i phi}/v)(1 - e^{-i phi}/v).
            # Hence X = v^n `root`, where `root` is a series in powers of 1/v.
            phi = 2.0 * np.arctan2(np.sqrt(ends[-1] - ends), np.sqrt(ends - ends[0]))
            root = exp_of_power_sums(np.array([np.sum(np.cos(k * phi)) for k in range(2 * n)])).real
            ratio = np.zeros(2 * n, dtype=np.longdouble)  # coefficients of v^(n-1), .., v^-n
            ratio[n - 1 :: -1] += 0.5 * self._smooth
            ratio[n - 1 : -1] += 0.5 * self._smooth
            # Each pole of R, unit/(x - e), is the series sum_k U_k(cos phi) v^(-k-1), k >= 0. The
            # U_k are the Chebyshev polynomials of the second kind.
            second, older = np.ones_like(phi), np.zeros_like(phi)
            for k in range(n):
                ratio[n + k] += np.sum(self._poles * second)
                second, older = 2.0 * np.cos(phi) * second - older, second
            series = 2.0 * np.convolve(root, ratio)[: 2 * n][::-1]
            series[0] *= 0.5
            return DesignedProfile(series.astype(float), hull)
        # Let z be a complex point above the real axis and w = e^{2 pi i z/L}. The factor of an end
        # e is then 2 sin(pi (z - e)/L) = i e^{-i pi (z - e)/L} (1 - w e^{-2 pi i e/L}).
        angle = self._extended._turn * ends
        power_sums = np.array([0.5 * np.sum(np.exp(-2j * k * angle)) for k in range(n + 1)])
        root = np.exp(0.5j * (np.sum(angle) + n * self._extended.pi)) * exp_of_power_sums(
            power_sums
        )
        ratio = np.zeros(n + 1, dtype=np.clongdouble)  # coefficients of e^{i pi z (2j - n)/L}
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
        """Array of the loads [N/m] of the zones, from left to right."""
        modes, poles = self._zone_integrals
        return np.asarray(modes @ self._smooth + poles, dtype=float)

    def _zone_pressure(self, i: int, dl: Array, dr: Array) -> Array:
        with np.errstate(invalid="ignore"):
            p = 0.5 * self.E_star * self._opening(i, dl, dr)
        return np.asarray(np.where(np.isnan(p), -np.inf, p), dtype=float)

    def _opening(self, i: int, dl: Array, dr: Array) -> Array:
        """Slope of the gap in interval i if it is a gap (-1: left of all zones).
        If interval i is a zone, the value is the pressure times 2/E*.
        """
        return np.asarray(self._side(i) * self._product.root(i, dl, dr) * self._ratio(i, dl, dr))

    def _from_left(self, i: int, dl: Array, dr: Array) -> Mask:
        """Mask of the points of gap i for which the slope is integrated from the left end.
        For all other points it is integrated from the right end.

        The points of the mask are nearer to the left end than to the right end.
        """
        return np.asarray((dl <= dr) | np.isnan(dr)) if i >= 0 else np.zeros(dl.shape, dtype=bool)

    @cached_property
    def max_pressure(self) -> float:
        """Largest pressure [Pa] of all zones; the infinite tension at the ends does not count."""
        return self._greatest(1e-6, 257)

    @cached_property
    def is_admissible(self) -> bool:
        """Whether the surfaces stay apart outside the zones.
        Only then is the designed contact possible.

        In every gap the slope is summed from both ends to the middle, at 400 angles: all partial
        sums must be positive. Outside all zones the slope must have the sign of an opening gap.
        """
        ends = self._product.zones.ravel()
        phi = pi * (np.arange(400) + 0.5) / 400
        for g in self._product.gaps:
            h = float(self._product.steps[g])
            dl, dr = h * np.sin(0.5 * phi) ** 2, h * np.cos(0.5 * phi) ** 2
            rise = np.sin(phi) * self._opening(g, dl, dr)
            if min(np.min(np.cumsum(rise[:200])), np.min(np.cumsum(-rise[:199:-1]))) <= 0.0:
                return False
        if self.period is not None:
            return True
        distance = float(ends[-1] - ends[0]) * np.geomspace(1e-9, 1e6, 400)
        return bool(
            np.all(self.gap_slope(ends[-1] + distance) > 0.0)
            and np.all(self.gap_slope(ends[0] - distance) < 0.0)
        )


def second_variation(design: AdhesiveDesign) -> Array:
    """Second derivatives of a designed JKR contact's energy by the zone ends, at fixed load.

    The contact is locally stable if the matrix d^2 energy/ds_i ds_j is positive definite. Derived
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

    >>> import contact
    >>> import numpy as np
    >>> from contact.inverse import design, second_variation
    >>> load = np.pi / 4 - np.pi  # R = E* = a = 1 and w = pi/2
    >>> cylinder = design([[-1.0, 1.0]], E_star=1.0, load=load, law=contact.JKR(np.pi / 2))
    >>> matrix = second_variation(cylinder)
    >>> bool(np.allclose(matrix, matrix.T))
    True
    >>> bool(abs(np.sum(matrix)) < 1e-9 * np.max(np.abs(matrix)))
    True
    """
    product, m, q = design._product, 2 * len(design.zones), design._poles.astype(float)
    outward, sigma = np.where(np.arange(m) % 2, 1.0, -1.0), design._signs
    unit = float(product._unit) if design.period is None else design.period / (2.0 * pi)
    others = product.end_factors()
    root = np.sqrt(others)
    k = outward * sigma * root * q  # X R ~ k/sqrt|factor| next to the end
    at_ends = [product.at_end(e) for e in range(m)]
    # `poles`: entry [i, j] is the value at end i of the pole of end j, which is 1/(x - e_j) without
    # a period.
    poles = np.array([product.poles(*at)[0] for at in at_ends])
    np.fill_diagonal(poles, 0.0)
    modes = np.array([design._modes(product, *at)[0] for at in at_ends])
    # All motions of ends are to the right here; the last line of this function turns them outward.
    strength = outward * others * q / (2.0 * unit)  # the coefficient A of every end
    # `smooth`: entry [i, j] is the value at end i of the polynomial T that belongs to a motion of
    # end j (head of this module).
    smooth = _low_modes(design, modes) @ _low_coefficients(design, strength, unit).T
    regular = modes @ design._smooth.astype(float) + poles @ q
    change = (sigma / root)[:, None] * (strength * poles + smooth)  # change of k at end i by end j
    # Change of k at the moved end itself. Let F be the factor of this end in X^2. Next to the end,
    # X R = k/sqrt|F| + b sqrt|F| with a constant b. A motion of the end changes F. So the term with
    # b changes by a multiple of 1/sqrt|F|, and contributes outward b/(2 unit) to the change of k.
    # Of b only the part sigma root `regular` remains, where `regular` is R without the pole of this
    # end. The rest of b is due to the factors of the other ends. It cancels against a part of the
    # field at the head of this module. The polynomial T of this field contributes sigma T/root.
    own = outward * root * regular / (2.0 * unit) + np.diagonal(smooth) / root
    np.fill_diagonal(change, sigma * own)
    return np.asarray(2.0 * design.work * change / k[:, None] * outward, dtype=float)


def is_stable(design: AdhesiveDesign) -> bool:
    """Whether a designed JKR contact is locally stable at prescribed load.

    It is stable if the second variation is positive definite. Derived here, see the head of this
    module.

    Parameters
    ----------
    design : AdhesiveDesign
        The contact.

    Returns
    -------
    bool

    Examples
    --------
    A cylinder is stable if its zone is wider than at pull-off, a^3 = 2 R^2 w/(pi E*).

    >>> import contact
    >>> import numpy as np
    >>> from contact.inverse import design, is_stable
    >>> zone, works = [[-1.0, 1.0]], [1.5, 1.6]  # R = E* = a = 1: pull-off at w = pi/2
    >>> loads = [np.pi / 4 - np.sqrt(2 * np.pi * w) for w in works]
    >>> [is_stable(design(zone, 1.0, p, law=contact.JKR(w))) for p, w in zip(loads, works)]
    [True, False]
    """
    matrix = second_variation(design)
    return bool(np.min(np.linalg.eigvalsh(0.5 * (matrix + matrix.T))) > 0.0)


def _low_modes(design: AdhesiveDesign, modes: Array) -> Array:
    """Values (..., n - 1) of the basis functions of the polynomial T (head of this module).
    They are the basis functions of M, given as `modes`, without the highest polynomial. With a
    period, the highest cosine and the highest sine are left out instead.
    """
    return modes[..., :-1] if design.period is None else modes[..., 2:]


def _low_coefficients(design: AdhesiveDesign, strength: Array, unit: float) -> Array:
    """Coefficients of the polynomial T (head of this module); shape (2n, n - 1).
    Row j belongs to a unit motion of end j to the right. T is a part of the field that this motion
    causes, and makes the integral of the field vanish over every gap.
    """
    product, n = design._product, len(design.zones)
    others, m = product.end_factors(), 2 * len(design.zones)
    gaps = list(product.gaps)[: n - 1]  # with a period the last condition follows from the others
    matrix, given = np.zeros((n - 1, n - 1)), np.zeros((n - 1, m))
    for row, g in enumerate(gaps):
        dl, dr, weight = product.nodes(g)
        x_root = product.root(g, dl, dr)
        matrix[row] = weight / x_root @ _low_modes(design, design._modes(product, g, dl, dr))
        poles = product.poles(g, dl, dr)
        for j in range(m):
            field = strength[j] * poles[:, j] / x_root
            if j in (g, (g + 1) % m):
                # The field that a motion of end j causes is not integrable at this end. So a
                # multiple of d(|X| pole)/dx is subtracted, where `pole` is the pole of R at end j.
                # The rest is integrable. The integral of the subtracted term has the finite part
                # zero (Hadamard).
                share = (-2.0 if j == g else 2.0) * unit * strength[j] / others[j]
                field = field - share * _pole_slope(design, g, (dl, dr), j, poles[:, j]) * x_root
            given[row, j] = -np.sum(weight * field)
    return np.asarray(np.linalg.solve(matrix, given).T) if n > 1 else np.zeros((m, 0))


def _pole_slope(
    design: AdhesiveDesign, g: int, at: tuple[Array, Array], j: int, pole: Any
) -> Array:
    """Derivative of |X| times `pole` by x, divided by |X|, at points x in gap g.
    `pole` is the pole of R at end j, which is 1/(x - e_j) without a period.

    X, R: head of this module. at: distances of the points from the ends of the gap.
    """
    ends = design._product.zones.ravel()
    distance = (ends[g] + at[0])[:, None] - ends
    distance[:, g], distance[:, (g + 1) % len(ends)] = at[0], -at[1]
    if design.period is None:
        log_slopes, pole_slope = 1.0 / distance, -pole / distance[:, j]
    else:
        turn = pi / design.period
        log_slopes, own = turn / np.tan(turn * distance), turn * distance[:, j]
        if len(design.zones) % 2:
            pole_slope = -pole * turn / np.tan(own)
        else:
            pole_slope = -0.5 * turn / np.sin(own) ** 2
    return np.asarray(0.5 * np.sum(log_slopes, axis=1) * pole + pole_slope)
