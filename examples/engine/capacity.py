"""Logarithmic capacity of two intervals, against elliptic functions.

The equilibrium charge phi of total 1 makes (1/pi) PV int phi / (x - xi) dxi = 0 and holds both intervals at one potential,
log(capacity). For [-1, alpha] and [beta, 1] N. I. Achieser (1930; see K. Schiefermayr, Complex Var. Elliptic Equ. 53 (2008) 65):
capacity = (1 + beta) / (2 (1 + alpha)) (theta_4(0) / theta_4(lambda))^4, k^2 = 2 (beta - alpha) / ((1 - alpha)(1 + beta)),
sn^2(lambda) = (1 - alpha) / 2.
"""

import numpy as np
from scipy.special import ellipk, ellipkinc

import sie


def achieser(alpha, beta):
    m = 2 * (beta - alpha) / ((1 - alpha) * (1 + beta))
    nome = np.exp(-np.pi * ellipk(1 - m) / ellipk(m))
    angle = np.pi * ellipkinc(np.arcsin(np.sqrt((1 - alpha) / 2)), m) / ellipk(m)
    n = np.arange(1, 12)
    theta = [1 + 2 * np.sum((-1.0) ** n * nome ** (n * n) * np.cos(n * turn)) for turn in (0.0, angle)]
    return (1 + beta) / (2 * (1 + alpha)) * (theta[0] / theta[1]) ** 4


def main():
    charge = sie.Equation(sie.cauchy(), sie.Forcing(np.zeros_like, np.zeros_like), (sie.Total(1.0), sie.EqualPotential()))
    rows = []
    for alpha, beta in [(-0.5, 0.2), (0.1, 0.4), (0.3, 0.301)]:
        found = sie.solve(charge, sie.Zones.of([[-1, alpha], [beta, 1]], sie.SINGULAR, sie.SINGULAR), tol=1e-10)
        rows.append((np.exp(np.pi * found.levels[0]), achieser(alpha, beta), found.error))
        print(f"[-1, {alpha}] and [{beta}, 1]: {rows[-1][0]:.14f} ({rows[-1][1]:.14f}), stated error {found.error:.0e}")
    return rows


if __name__ == "__main__":
    main()
