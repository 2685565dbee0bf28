"""GMRES without restarts, for an operator that is close to the identity.

See Y. Saad and M. H. Schultz, SIAM J. Sci. Stat. Comput. 7, 1986, 856-869.
"""

from collections.abc import Callable

import numpy as np
from scipy.linalg import norm, solve_triangular

from sie.basis.data import Array, record


@record
class Iterated:
    """Result of GMRES, with the solution x, the norm of the residual, and the number of steps."""

    x: Array
    residual: float
    steps: int


def gmres(apply: Callable[[Array], Array], b: Array, tolerance: float, most: int = 200) -> Iterated:
    """The solution x of A x = b by GMRES from the start x = 0, with |b - A x| <= tolerance.

    If round-off or the limit of `most` steps prevents this, the result is the best x found.
    """
    beta = float(norm(b))
    if beta <= tolerance:
        return Iterated(np.zeros_like(b), beta, 0)
    basis = np.empty((min(most, 16) + 1, len(b)))
    basis[0] = b / beta
    # `upper` is the matrix R in the QR decomposition of the Hessenberg matrix by Givens rotations.
    # `right` is the rotated right side.
    upper = np.zeros((most, most))
    cos, sin = np.zeros(most), np.zeros(most)
    right = np.zeros(most + 1)
    right[0] = beta
    steps = 0
    for k in range(most):
        if k + 1 == len(basis):
            basis = np.concatenate(
                (basis, np.empty((min(len(basis), most + 1 - len(basis)), len(b))))
            )
        w = apply(basis[k])
        size = float(norm(w))
        h = basis[: k + 1] @ w
        w -= h @ basis[: k + 1]
        below = float(norm(w))
        if 2 * below * below < size * size:
            # If more than half of the new vector's squared norm has cancelled, the vector's
            # round-off is not orthogonal to the basis. So the vector is orthogonalized again (L.
            # Giraud, J. Langou and M. Rozloznik, Comput. Math. Appl. 50, 2005, 1069-1075).
            again = basis[: k + 1] @ w
            w -= again @ basis[: k + 1]
            h += again
            below = float(norm(w))
        for j in range(k):
            h[j], h[j + 1] = cos[j] * h[j] + sin[j] * h[j + 1], cos[j] * h[j + 1] - sin[j] * h[j]
        radius = float(np.hypot(h[k], below))
        if not np.isfinite(radius) or radius <= 1e-15 * size:
            break
        cos[k], sin[k] = h[k] / radius, below / radius
        upper[: k + 1, k] = h
        upper[k, k] = radius
        right[k + 1], right[k] = -sin[k] * right[k], cos[k] * right[k]
        steps = k + 1
        if abs(right[k + 1]) <= tolerance or below <= 1e-15 * size:
            break
        basis[k + 1] = w / below
    y = (
        solve_triangular(upper[:steps, :steps], right[:steps], check_finite=False)
        if steps
        else np.zeros(0)
    )
    return Iterated(y @ basis[:steps], abs(float(right[steps])), steps)
