"""A shape of your own: a rounded wedge, checked, registered and pressed to a load."""

from dataclasses import dataclass

import numpy as np

import contact
from contact.testing import check_profile


@contact.register_profile("rounded-wedge")
@dataclass(frozen=True)
class RoundedWedge(contact.Profile):
    """f = tangent (sqrt(x^2 + r^2) - r): a parabola of radius r/tangent at the tip, a wedge far from it."""

    tangent: float
    r: float

    def height(self, x):
        return self.tangent * (np.hypot(x, self.r) - self.r)

    def slope(self, x):
        return self.tangent * np.asarray(x) / np.hypot(x, self.r)

    symmetric = True
    summits = np.zeros(1)  # one tip, at 0: nothing is searched for


def main():
    profile = RoundedWedge(tangent=0.05, r=1e-5)
    print(check_profile(profile))
    solution = contact.solve(contact.Scene(profile, E_star=1e11, interaction=contact.Isolated(), load=2e4))
    print(f"half width {1e6 * solution.zones[0, 1]:.4f} um, peak {1e-9 * solution.max_pressure:.4f} GPa")
    return solution


if __name__ == "__main__":
    main()
