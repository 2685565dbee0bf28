"""A cut that is born: eigenvalues of a random matrix enter the higher well of a potential.

With weights exp(-N tr V / T) their density is phi / T; phi, of total T, vanishes at the ends of its
cuts and solves (1/pi) PV int phi / (x - xi) dxi = V' / 2 pi. Its potential less V / 2 pi is one
level there, and nowhere higher: elsewhere a cut is born (B. Eynard, arXiv:math-ph/0605064).
"""

import numpy as np
from scipy.optimize import brentq

import sie

SLOPE = np.polynomial.Polynomial([0.3, -2.5, 0, 1]) / (2 * np.pi)  # V = x^4/4 - 5 x^2/4 + 3 x/10
RIGHT = sie.Forcing(SLOPE, SLOPE.integ())


def measure(total, cuts):
    conditions = (sie.Total(total), sie.EqualPotential())[:cuts]
    guess = sie.Zones.of([[-1.9, -1.3], [1.4, 1.7]][:cuts])
    return sie.solve(sie.Equation(sie.cauchy(), RIGHT, conditions), guess, tol=1e-10)


def summit(one):
    """Place in the other well where potential less V / 2 pi is highest, and its height there."""
    at = brentq(lambda x: one.density.transform(x) - SLOPE(x), 1.2, 2.0, xtol=1e-14)
    level = [one.density.potential(x) - RIGHT.primitive(x) for x in (one.zones.middle[0], at)]
    return at, level[1] - level[0]  # above the level on the cut


def main():
    birth = brentq(lambda total: summit(measure(total, 1))[1], 0.1, 0.2, xtol=1e-13)
    at, _ = summit(measure(birth, 1))
    print(f"at T = {birth:.9f} a cut is born at x = {at:.9f}")
    rows = [measure(r * birth, cuts) for r, cuts in ((0.8, 1), (1.001, 2), (1.1, 2), (4, 2))]
    print(*(f"cuts {one.zones.table.round(6).tolist()}" for one in rows), sep="\n")
    return birth, at, rows


if __name__ == "__main__":
    main()
