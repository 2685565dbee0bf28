r"""Plane stresses in a half-plane y > 0 from the tractions on its surface.

The pressure p and the shear q (along +x) on the surface have the transforms

    G(z) = (1/pi) int p(xi) K(z - xi) dxi,    H(z) = (1/pi) int q(xi) K(z - xi) dxi,    z = x + iy,

with K(z) = 1/z, or (pi/L) cot(pi z/L) in periodic contact. With tension positive,

    s_xx = Im G + y Re G' - 2 Re H + y Im H',
    s_yy = Im G - y Re G' - y Im H',
    s_xy =      - y Im G' +   Im H + y Re H'.

On the surface Im G = -p and Im H = -q. This is the Kolosov-Muskhelishvili form of Flamant's
integrals (N. I. Muskhelishvili, Some Basic Problems of the Mathematical Theory of Elasticity,
1953).
"""

from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from contact.errors import SceneError
from contact.model.checks import one_of, poisson_ratio
from sie import Array, Complex

LATERAL = ("as loaded", "free", "confined")

# The Cauchy transform [Pa] of a surface traction, and its derivative [Pa/m], at points of the body.
Transform = tuple[Complex, Complex]


@dataclass(frozen=True)
class Stress:
    """Plane stresses [Pa] at points of the body, positive in tension.

    Parameters
    ----------
    xx, yy, xy : ndarray
        The stresses, all of one shape. Body 1 is y > 0.
    error : ndarray
        Bounds [Pa] of the errors of these stresses, in an array of the same shape.

    Examples
    --------
    The largest shear stress below a cylinder is 0.30028 p_0 at 0.78615 half widths.

    >>> import contact
    >>> scene = contact.Scene(contact.Parabola(1.0), 2.0, contact.Isolated(), half_width=1.0)
    >>> found = contact.solve(scene).stress(0.0, 0.7861513778)
    >>> round(float(found.shear), 10)
    0.300283106
    """

    xx: Array
    yy: Array
    xy: Array
    error: Array = field(repr=False)

    # At a tip on the surface s_xx and s_yy are infinite, and their difference is nan.
    @property
    @np.errstate(invalid="ignore")
    def shear(self) -> Array:
        """Largest shear stress [Pa] in the plane: the radius of Mohr's circle.
        It is nan at a tip on the surface, where the pressure is infinite.
        """
        return np.asarray(np.hypot(0.5 * (self.xx - self.yy), self.xy))

    def zz(self, nu: float) -> Array:
        """Stress [Pa] out of the plane in plane strain, with Poisson's ratio nu."""
        return np.asarray(poisson_ratio("nu", nu) * (self.xx + self.yy))

    @np.errstate(invalid="ignore")
    def mises(self, nu: float) -> Array:
        """Von Mises stress [Pa] in plane strain, with Poisson's ratio nu."""
        mean, out = 0.5 * (self.xx + self.yy), self.zz(nu)
        return np.asarray(np.hypot(np.sqrt(3) * self.shear, mean - out))

    @np.errstate(invalid="ignore")
    def tresca(self, nu: float) -> Array:
        """Largest shear stress [Pa] on any plane in plane strain, with Poisson's ratio nu."""
        mean, radius = 0.5 * (self.xx + self.yy), self.shear
        return np.asarray(np.maximum(radius, 0.5 * (np.abs(mean - self.zz(nu)) + radius)))

    def with_tension(self, along: float) -> Self:
        """These stresses plus a uniform tension `along` [Pa] parallel to the surface."""
        return replace(self, xx=self.xx + along) if along else self


def stress_from(
    y: Array, normal: Transform, tangential: Transform | None, error: ArrayLike = 0.0
) -> Stress:
    """Stresses at the depths y [m] from the transforms of pressure and shear.

    Parameters
    ----------
    y : ndarray
        Depths [m], 0 on the surface.
    normal, tangential : tuple
        The transform F of the pressure p, and of the shear q along +x on body 1, with the
        derivative F' of each, at x + iy. `tangential` is None without friction.
    error : array_like
        Bound [Pa] of the error of each stress.

    Returns
    -------
    Stress
        The stresses [Pa], of the shape of y.
    """
    value, slope = normal[0], _times_depth(y, normal[1])
    xx, yy, xy = value.imag + slope.real, value.imag - slope.real, -slope.imag
    if tangential is not None:
        value, slope = tangential[0], _times_depth(y, tangential[1])
        xx = xx - 2 * value.real + slope.imag
        yy, xy = yy - slope.imag, xy + value.imag + slope.real
    return Stress(xx, yy, xy, np.broadcast_to(np.asarray(error, dtype=float), y.shape))


def _times_depth(y: Array, slope: Complex) -> Complex:
    """Depth y times the derivative F' of a transform.
    It is 0 on the surface, where F' may be infinite.
    """
    return np.asarray(np.where(y == 0, 0.0, y * np.where(y == 0, 0.0, slope)))


def tension_along(lateral: str, deep: float, nu: float | None) -> float:
    """Uniform stress s_xx [Pa] that is added to the stresses caused by the surface tractions.

    Far below a periodic contact, the stresses caused by the tractions are a uniform pressure, the
    mean pressure `deep` [Pa]. With the added stress, the mean of s_xx is zero ("free"), or the mean
    of the strain e_xx is zero ("confined").
    """
    one_of("lateral", lateral, LATERAL)
    if lateral == "confined":
        if nu is None:
            raise SceneError.of("nu", nu, "Poisson's ratio, since lateral = 'confined' needs it")
        nu = poisson_ratio("nu", nu)
        return deep * (1 - 2 * nu) / (1 - nu)
    return deep if lateral == "free" else 0.0
