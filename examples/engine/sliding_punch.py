"""Punches that slide with friction: exponents, intensities and ends, against closed forms.

A rigid punch f slides to the right on an elastic half plane, with the coefficient of friction mu.
Its pressure p solves kappa p + (1/pi) PV int p / (x - xi) dxi = E* f'/2. With cot(pi alpha) = kappa
(N. I. Muskhelishvili, Some Basic Problems of the Mathematical Theory of Elasticity, 1953) a flat
punch on (a, b) has p = P sin(pi alpha)/pi (b - x)^(alpha - 1) (x - a)^(-alpha), and a cylinder
touches from -2 alpha l to 2 (1 - alpha) l, where P = pi alpha (1 - alpha) E* l^2/R.
"""

import numpy as np

import sie

MODULUS, POISSON, LOAD, RADIUS = 3000.0, 0.3, 100.0, 10.0  # E* in MPa; P in N/mm; R in mm


def slid(mu, shape, zones):
    kappa = -mu * (1 - 2 * POISSON) / (2 - 2 * POISSON)  # -mu times Dundurs' beta
    equation = sie.Equation(sie.cauchy(), shape, sie.Total(LOAD), kappa=kappa)
    return np.arctan2(1.0, kappa) / np.pi, sie.solve(equation, zones, tol=1e-12)


def main():
    rows = []
    for mu in (0.0, 0.5, 1.0):
        alpha, flat = slid(mu, np.zeros_like, sie.Zones.of([[-1, 1]], sie.SINGULAR, sie.SINGULAR))
        edge = LOAD * np.sin(np.pi * alpha) / np.pi * 2 ** np.array([alpha - 1, -alpha])
        shown = np.ravel([flat.density.exponents, flat.density.intensities])
        print("mu = {}: p ~ K d^{:.6f} left, K d^{:.6f} right".format(mu, *shown[:2]))
        print("  K {:.9f}, {:.9f} ({:.9f}, {:.9f})".format(*shown[2:], *edge))
        _, cylinder = slid(mu, lambda x: MODULUS * x / (2 * RADIUS), sie.Zones.of([[-0.5, 0.6]]))
        half = np.sqrt(LOAD * RADIUS / (np.pi * alpha * (1 - alpha) * MODULUS))
        ends = half * np.array([-2 * alpha, 2 - 2 * alpha])
        print("  cylinder {:.9f}, {:.9f} ({:.9f}, {:.9f})".format(*cylinder.zones.table[0], *ends))
        rows.append((mu, flat, edge, cylinder, ends))
    return rows


if __name__ == "__main__":
    main()
