"""Two flat plates in tandem in a stream: the lift of each, against the closed form.

The vortex sheet gamma of thin plates at the angle alpha, in a stream of speed one, solves (1/pi) PV int gamma / (x - xi) dxi = 2 alpha
and is bounded at trailing ends b (Kutta), singular at leading ends a. Closed form (N. I. Muskhelishvili, Singular Integral Equations,
1953, ch. 11): gamma = 2 alpha sqrt(|prod (x - b) / (x - a)|); together they lift as much as two plates far apart.
"""

import numpy as np
from scipy.special import roots_jacobi

import sie

ALPHA = np.radians(3)
PLATES = np.array([[0.0, 1.0], [1.2, 1.7]])


def closed(plate):
    """Circulation of a plate by Gauss's rule for sqrt((1 - t) / (1 + t))."""
    (a, b), (other_a, other_b) = PLATES[plate], PLATES[1 - plate]
    t, weight = roots_jacobi(80, 0.5, -0.5)
    x, half = 0.5 * (a + b) + 0.5 * (b - a) * t, 0.5 * (b - a)
    return 2 * ALPHA * half * weight @ np.sqrt((x - other_b) / (x - other_a))


def main():
    downwash = sie.Forcing(lambda x: np.full_like(x, 2 * ALPHA))
    zones = sie.Zones.of(PLATES, left=sie.SINGULAR, right=sie.BOUNDED)
    found = sie.solve(sie.Equation(sie.cauchy(), downwash, ()), zones, tol=1e-12)
    lifts = 2 * found.density.totals / np.diff(PLATES)[:, 0]  # coefficients; of a single plate: 2 pi alpha
    exact = 2 * np.array([closed(0), closed(1)]) / np.diff(PLATES)[:, 0]
    for name, lift, true in zip(("front", "rear"), lifts, exact, strict=True):
        print(f"{name} plate: lift coefficient {lift:.12f} ({true:.12f}), {lift / (2 * np.pi * ALPHA):.4f} of a single plate's")
    print(f"stated error {found.error:.0e}")
    return lifts, exact, found.error


if __name__ == "__main__":
    main()
