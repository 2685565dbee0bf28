"""Stresses around a row of cracks, from the transform and its derivative at complex points.

Z(z) = s - F(z) is Westergaard's function of cracks under the stress s all around; beside them the stresses are Re Z -+ y Im Z' and
- y Re Z'. For a row of cracks |x| < a with period L, Z = s sin(pi z/L) / sqrt(sin(pi z/L)^2 - sin(pi a/L)^2)
(H. M. Westergaard, J. Appl. Mech. 6 (1939) A49).
"""

import numpy as np

import sie

HALF, PERIOD = 0.3, 1.0


def closed(z):
    """Z and Z'."""
    turn = np.pi / PERIOD
    edge, sine, cosine = np.sin(turn * HALF), np.sin(turn * z), np.cos(turn * z)
    root = np.sqrt(np.sin(turn * (z - HALF)) * np.sin(turn * (z + HALF)))
    root = root * np.sign((root * np.conj(sine)).real)  # the branch that is sin(pi z/L) far away
    return sine / root, -turn * cosine * edge**2 / root**3


def main():
    cracks = sie.Equation(sie.hilbert(PERIOD), sie.Forcing(np.ones_like), (sie.ZoneTotals(0.0),))
    found = sie.solve(cracks, sie.Zones.of([[-HALF, HALF]], sie.SINGULAR, sie.SINGULAR), tol=1e-12)
    z = np.array([0.1 + 0.05j, HALF + 1e-8j, 0.35 - 0.2j, 0.49 + 1j, 0.2 + 1e-6j])
    got = 1 - found.density.transform(z), -found.density.transform_slope(z)
    for at, value, slope in zip(z, *got, strict=True):
        across, along, shear = value.real + at.imag * slope.imag, value.real - at.imag * slope.imag, -at.imag * slope.real
        print(f"z = {at:.3g}: across {across:.6g}, along {along:.6g}, shear {shear:.6g}")
    off = [np.max(np.abs(one / other - 1)) for one, other in zip(got, closed(z), strict=True)]
    print(f"largest relative differences of Z and Z' from the closed form {off[0]:.0e}, {off[1]:.0e}; stated error {found.error:.0e}")
    return off, found.error


if __name__ == "__main__":
    main()
