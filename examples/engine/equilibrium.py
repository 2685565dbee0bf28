"""Eigenvalues of a random matrix in a double well: the equilibrium measure on two cuts whose ends are unknown.

The measure phi of total 1 that minimizes - int int log|x - y| phi phi + int V phi solves (1/pi) PV int phi / (x - xi) dxi = V' / 2 pi, has
the same potential on both cuts, and vanishes at their ends. For V = x^4/4 - a x^2/2, a > 2, these are +-sqrt(a -+ 2)
(P. M. Bleher, A. R. Its, Ann. Math. 150 (1999) 185).
"""

import numpy as np

import sie

A = 2.5


def main():
    half_slope = sie.Forcing(
        value=lambda x: (x**3 - A * x) / (2 * np.pi),
        primitive=lambda x: (x**4 / 4 - A * x**2 / 2) / (2 * np.pi),
    )
    equation = sie.Equation(sie.cauchy(), half_slope, (sie.Total(1.0), sie.EqualPotential()))
    guess = sie.Zones.of([[-2.0, -1.0], [0.9, 2.2]], left=sie.FREE, right=sie.FREE)
    found = sie.solve(equation, guess, tol=1e-12)
    ends = np.sqrt([A - 2, A + 2])
    print(f"cuts {found.zones.table.round(12).tolist()}, sqrt(a -+ 2) = {ends.round(12).tolist()}")
    x = np.linspace(-2.2, 2.2, 8)
    closed = np.abs(x) * np.sqrt(np.maximum(0, (x**2 - A + 2) * (A + 2 - x**2))) / (2 * np.pi)
    print(f"largest difference of the density from its closed form {np.abs(found.density(x) - closed).max():.0e}")
    print(f"shares of the two wells {found.density.totals.round(12).tolist()}, stated error {found.error:.0e}")
    return found, ends


if __name__ == "__main__":
    main()
