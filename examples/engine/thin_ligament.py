"""Two cracks with a thin ligament between them: stress intensity factors, against closed forms.

Cracks k < |x| < 1 stand in a plate under the stress s across them. Their dislocation density phi
solves (1/pi) PV int phi / (x - xi) dxi = s, int phi = 0 on each; beside a tip it is K / sqrt(d),
and K_I = sqrt(2 pi) |K|. With elliptic integrals E, K of the modulus sqrt(1 - k^2) and c = E/K (T.
J. Willmore, Quart. J. Mech. Appl. Math. 2 (1949) 53), K_I = s sqrt(pi/(1 - k^2)) (1 - c) at outer
and s sqrt(pi/(1 - k^2)) (c - k^2)/sqrt(k) at inner tips. As k falls the inner ones grow as
1/(sqrt(k) log(4/k)), and the outer ones come close to one long crack's sqrt(pi) s, but slowly.
"""

import numpy as np
from scipy.special import ellipe, ellipkm1

import sie

LIGAMENTS = 10.0 ** -np.arange(2, 9)  # the width 2 k; the zones get coordinates graded towards it


def willmore(k):
    """K_I at an outer and at an inner tip, over the stress."""
    ratio = ellipe(1 - k * k) / ellipkm1(k * k)
    return np.sqrt(np.pi / (1 - k * k)) * np.array([1 - ratio, (ratio - k * k) / np.sqrt(k)])


def main():
    cracks = sie.Equation(sie.cauchy(), np.ones_like, sie.ZoneTotals(0.0))
    rows = []
    for width in LIGAMENTS:
        zones = sie.Zones.of([[-1.0, -width / 2], [width / 2, 1.0]], sie.SINGULAR, sie.SINGULAR)
        found = sie.solve(cracks, zones, tol=1e-11)
        tips = np.sqrt(2 * np.pi) * np.abs(found.density.intensities)[:, 0]
        rows.append((found, tips, willmore(width / 2)))
        print(f"ligament {width:.0e}: K_I {tips}, closed form {rows[-1][2]}")
    print(f"stated errors at most {max(found.error for found, *_ in rows):.0e}")
    return rows


if __name__ == "__main__":
    main()
