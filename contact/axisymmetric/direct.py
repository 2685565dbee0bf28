r"""The paper's own form (1) with the kernel (3), by quadrature: nothing of the Abel transforms is used.

    p_f(r)    = (E*/4 pi) int_0^a Laplacian f(s) H1(r, s) ds
    H1(r, s)  = int_0^2pi (2 s/(pi D)) arctan(sqrt(a^2 - r^2) sqrt(a^2 - s^2)/(a D)) dtheta,
    D^2       = r^2 - 2 r s cos theta + s^2

The paper prints E*/(4 pi^2); with H1 as printed f = r^2/(2R) gives Hertz only with E*/(4 pi).
"""

from math import pi
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from contact.axisymmetric.profiles import as_profile
from contact.axisymmetric.quadrature import panels
from contact.errors import SceneError
from contact.model.checks import finite_array, positive
from contact.reference.exact.base import FROM_LEFT, FROM_RIGHT, WEIGHT
from sie import Array


def direct_kernel(r: ArrayLike, s: ArrayLike, a: float, apart: ArrayLike | None = None) -> Array:
    """The paper's kernel (3) by quadrature: H1(r, s) = int_0^2pi (2 s/(pi D)) arctan(sqrt(a^2 - r^2) sqrt(a^2 - s^2)/(a D)) dtheta.

    D^2 = r^2 - 2 r s cos theta + s^2. It is infinite where r = s.

    Parameters
    ----------
    r, s : array_like
        Radii below a that broadcast together [m].
    a : float
        Radius of the spot [m].
    apart : array_like or None
        |r - s| where it is known better than the difference [m].

    Returns
    -------
    array
        Without unit, of the shape of r and s together.

    Examples
    --------
    From the middle, r = 0, it is 4 arctan(sqrt(a^2 - s^2)/s).

    >>> import numpy as np
    >>> from contact.axisymmetric import direct_kernel
    >>> s = np.array([0.2, 0.7])
    >>> bool(np.allclose(direct_kernel(0.0, s, 1.0), 4 * np.arctan(np.sqrt(1 - s**2) / s)))
    True
    """
    r, s = np.broadcast_arrays(np.asarray(r, dtype=np.float64), np.asarray(s, dtype=np.float64))
    d = np.abs(r - s) if apart is None else np.asarray(apart, dtype=np.float64)
    # D^2 = d^2 + 4 r s sin^2(theta/2) is nearly singular at theta = 0: the panel ends where D has grown to sqrt(d).
    scale = np.sqrt(np.clip(d / np.maximum(r + s, 1e-300), 1e-30, 1.0))
    theta, weight = panels([np.zeros_like(d), pi * scale**2, pi * scale, np.full_like(d, pi)])
    D = np.sqrt(d[..., None] ** 2 + 4.0 * (r * s)[..., None] * np.sin(0.5 * theta) ** 2)
    reach = (np.sqrt((a - r) * (a + r)) * np.sqrt((a - s) * (a + s)))[..., None]
    inner = np.arctan2(reach, a * D) / np.maximum(D, 1e-300)
    return np.asarray(4.0 * s / pi * np.sum(weight * inner, axis=-1))


def direct_pressure(profile: Any, E_star: float, a: float, r: ArrayLike) -> Array:
    """The pressure of an isolated spot by the paper's own form, p_f(r) = (E*/4 pi) int_0^a Laplacian f(s) H1(r, s) ds, by quadrature.

    It uses nothing of the Abel transforms the solver is made of, and is what that is judged by.

    Parameters
    ----------
    profile : AxisymmetricProfile or callable
        The shape, or f(r) [m], without edges inside the spot.
    E_star : float
        Reduced modulus [Pa].
    a : float
        Radius of the spot [m].
    r : array_like
        Radii of any shape, 0 < r < a [m].

    Returns
    -------
    array
        [Pa], of the shape of r.

    Raises
    ------
    SceneError
        If a number is not positive and finite, a radius not in the spot, or there is an edge inside it.

    Examples
    --------
    Hertz, by hundreds of points and no formula of his.

    >>> import numpy as np
    >>> from contact.axisymmetric import Sphere, direct_pressure
    >>> r = np.array([0.3, 0.6])
    >>> bool(np.allclose(direct_pressure(Sphere(1.0), 1.0, 1.0, r), 2 / np.pi * np.sqrt(1 - r**2), rtol=1e-8))
    True
    """
    shape, E, a = as_profile(profile), positive("E_star", E_star), positive("a", a)
    r = finite_array("r", r, None)
    if np.any(r <= 0) or np.any(r >= a):
        raise SceneError.of("r", r, "above 0 and below a")
    if np.any(shape.breakpoints < a):
        raise SceneError.of("profile", profile, "smooth inside the spot: (1) has no term for an edge")
    total = np.zeros(r.shape)
    for width, border, sign in ((r, 0.0, -1.0), (a - r, a, 1.0)):
        # On either side of r, by the distance from it.
        apart = width[..., None] * FROM_LEFT
        s = np.where(FROM_RIGHT < 0.5, border - sign * width[..., None] * FROM_RIGHT, r[..., None] + sign * apart)
        weight = width[..., None] * WEIGHT
        kernel = direct_kernel(np.broadcast_to(r[..., None], s.shape), s, a, apart)
        total = total + np.sum(weight * shape.r_laplacian(s) / s * kernel, axis=-1)
    return np.asarray(E / (4.0 * pi) * total)
