"""Cracks between unlike bodies: complex exponents and stress intensities, against closed forms.

Under a traction s (tension plus i times shear), the slope of the opening plus i times that of the
slip, both by E*/2 over 1 - beta^2, solve -i beta phi + (1/pi) PV int phi / (x - xi) dxi = s, with
Dundurs' beta. Next to a tip phi oscillates as d^(-1/2 +- i eps), pi eps = artanh(beta) (M. L.
Williams, Bull. Seism. Soc. Am. 49, 1959, 199-204). Ahead of it the traction is K r^(i eps) /
sqrt(2 pi r); one crack has K = s sqrt(pi a) (1 + 2 i eps) (2 a)^(-i eps) (J. R. Rice & G. C. Sih,
J. Appl. Mech. 32, 1965, 418-423). Two cracks with a ligament of their half length follow.
"""

import numpy as np

import sie

TRACTION, HALF = 1.0, 1.0


def cracks(beta, ends):
    equation = sie.Equation(
        sie.cauchy(), lambda x: TRACTION + 0 * x, sie.ZoneTotals(0.0), kappa=-1j * beta
    )
    return sie.solve(equation, sie.Zones.of(ends, sie.SINGULAR, sie.SINGULAR), tol=1e-12)


def main():
    rows = []
    for beta in (0.0, 0.2, 0.45):
        eps = np.arctanh(beta) / np.pi
        one = cracks(beta, [[-HALF, HALF]])
        exact = TRACTION * np.sqrt(np.pi * HALF) * (1 + 2j * eps) * (2 * HALF) ** (-1j * eps)
        two = cracks(beta, [[-2.5 * HALF, -0.5 * HALF], [0.5 * HALF, 2.5 * HALF]])
        k = [-np.sqrt(2 * np.pi) / np.cosh(np.pi * eps) * f.density.intensities[1] for f in (one, two)]
        print(f"beta = {beta}: exponent {one.density.exponents[1, 0]:.9f}, K {k[0][0]:.9f}")
        print(f"  closed form {exact:.9f}; of two cracks at the inner tip {k[1][0]:.6f}")
        rows.append((beta, one, k[0][0], exact, two, k[1]))
    return rows


if __name__ == "__main__":
    main()
