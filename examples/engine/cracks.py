"""Cracks in a row in a plate pulled across them: their stress intensity factors, against closed forms.

The dislocation density phi of cracks under the stress s solves (1/pi) PV int phi K dxi = s, int phi = 0 on each; beside a tip it is
K / sqrt(d), and K_I = sqrt(2 pi) |K|. Two cracks a < |x| < b: T. J. Willmore, Quart. J. Mech. Appl. Math. 2 (1949) 53,
with E = E(k), K = K(k), k^2 = 1 - (a/b)^2; a row: W. T. Koiter, Ingenieur-Archiv 28 (1959) 168.
"""

import numpy as np
from scipy.special import ellipe, ellipk

import sie


def factors(kernel, cracks):
    """(K_I at left tips, at right tips) under unit stress, and their stated relative error."""
    stress = sie.Forcing(lambda x: np.ones_like(x))
    zones = sie.Zones.of(cracks, sie.SINGULAR, sie.SINGULAR)
    found = sie.solve(sie.Equation(kernel, stress, (sie.ZoneTotals(0.0),)), zones, tol=1e-12)
    left, right = found.density.intensities
    return np.sqrt(2 * np.pi) * left, -np.sqrt(2 * np.pi) * right, found.error


def main():
    a, b = 0.2, 1.0
    inner, outer, error = factors(sie.cauchy(), [[-b, -a], [a, b]])
    ratio = ellipe(1 - (a / b) ** 2) / ellipk(1 - (a / b) ** 2)
    root = np.sqrt(np.pi / (b * (b * b - a * a)))
    closed = b * b * (ratio - (a / b) ** 2) * root * np.sqrt(b / a), b * b * (1 - ratio) * root
    print(f"two cracks: inner tip {inner[1]:.10f} ({closed[0]:.10f}), outer {outer[1]:.10f} ({closed[1]:.10f})")
    half, period = 0.3, 1.0
    _, row, row_error = factors(sie.hilbert(period), [[-half, half]])
    tangent = np.sqrt(period * np.tan(np.pi * half / period))
    print(f"a row: {row[0]:.12f} ({tangent:.12f}); stated errors {error:.0e}, {row_error:.0e}")
    return (inner[1], outer[1], row[0]), (*closed, tangent), max(error, row_error)


if __name__ == "__main__":
    main()
