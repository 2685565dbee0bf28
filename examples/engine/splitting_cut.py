"""Eigenvalues of a random matrix whose cut splits in two: the wells of its potential deepen.

The equilibrium measure phi of total 1 solves (1/pi) PV int phi / (x - xi) dxi = V' / 2 pi on its
cuts and vanishes at their ends. With V = x^4/4 - t x^2/2 (P. M. Bleher, A. R. Its, Ann. Math. 150
(1999) 185) there is one cut for t < 2, phi = (x^2 + b^2/2 - t) sqrt(b^2 - x^2) / 2 pi,
b^2 = 2/3 (t + sqrt(t^2 + 12)), and there are two for t > 2, between sqrt(t - 2) and sqrt(t + 2) on
either side. The engine is given the number of cuts. A density of one cut that is negative inside is
no measure: then there are two.
"""

import numpy as np

import sie


def equilibrium(t):
    """The measure on one cut if it is positive there, or else on two."""
    right = np.polynomial.Polynomial([0, -t, 0, 1]) / (2 * np.pi)
    right = sie.Forcing(right, right.integ())
    one = sie.Equation(sie.cauchy(), right, sie.Total(1.0))
    found = sie.solve(one, sie.Zones.of([[-2.5, 2.4]]), tol=1e-12)
    if found.density(0.0) > -1e-11:
        return found
    two = sie.Equation(sie.cauchy(), right, (sie.Total(1.0), sie.EqualPotential()))
    return sie.solve(two, sie.Zones.of([[-2.2, -0.7], [0.6, 2.3]]), tol=1e-12)


def main():
    rows = []
    for t in (1.0, 1.9, 2.0, 2.1, 3.0):
        found = equilibrium(t)
        ends = np.sqrt([t - 2, t + 2] if t > 2 else [2 / 3 * (t + np.sqrt(t * t + 12))])
        rows.append((t, found, ends))
        cuts = found.zones.table.round(9).tolist()
        print(f"t = {t}: {cuts}, closed form +-{ends.round(9).tolist()}")
    return rows


if __name__ == "__main__":
    main()
