"""A porous plate with a flap in a stream: its lift, against the closed form.

Air seeps through the plate with a speed that grows with the difference of pressure (Darcy), and so
with the vortex sheet gamma: kappa gamma/2, in a stream of speed one. So the sheet solves
kappa gamma + (1/pi) PV int gamma / (x - xi) dxi = 2 i, which jumps at the hinge; beside the
trailing edge it vanishes as distance^alpha, cot(pi alpha) = kappa (P. J. Baddoo, R. Hajian, J. W.
Jaworski, Unsteady aerodynamics of porous aerofoils, arXiv:1911.07382). With the incidence i in
front, i + d on the flap, the hinge at the part h of the chord, and the adjoint equation's solution
sin(pi alpha) (x/(1 - x))^alpha: c_L = 4 pi alpha (i + d (1 - I_h(1 + alpha, 1 - alpha))), I the
regularized incomplete beta function. A solid plate has kappa = 0 (H. Glauert, 1927).
"""

import numpy as np
from scipy.special import betainc

import sie

INCIDENCE, FLAP, HINGE = np.radians(2), np.radians(8), 0.75
POROSITY = (0.0, 0.1, 0.5, 2.0)  # kappa = 2 density speed permeability / (viscosity thickness)


def main():
    jump = sie.Jumps([HINGE], [2 * FLAP])
    right = sie.Forcing(lambda x: 2 * INCIDENCE + 2 * FLAP * (x > HINGE), jumps=jump)
    plate = sie.Zones.of([[0.0, 1.0]], left=sie.SINGULAR, right=sie.BOUNDED)
    rows = []
    for kappa in POROSITY:
        found = sie.solve(sie.Equation(sie.cauchy(), right, kappa=kappa), plate, tol=1e-12)
        alpha = np.arctan2(1.0, kappa) / np.pi
        effective = INCIDENCE + FLAP * (1 - betainc(1 + alpha, 1 - alpha, HINGE))
        rows.append((kappa, found, 2 * found.density.totals[0], 4 * np.pi * alpha * effective))
        print("kappa = {}: lift coefficient {:.12f} ({:.12f})".format(kappa, *rows[-1][2:]))
    print(f"stated errors at most {max(found.error for _, found, *_ in rows):.0e}")
    return rows


if __name__ == "__main__":
    main()
