"""A row of flat punches: infinite pressure at the corners, so errors are measured by the mean contact pressure."""

import numpy as np

import contact
from contact.reference import exact


def main():
    profile = contact.Flat(width=4e-5, period=1e-4)
    solution = contact.solve(contact.Scene(profile, E_star=1e9, interaction=contact.Periodic(), load=1000.0))
    closed = exact.PeriodicPunch(half_width=2e-5, period=1e-4, E_star=1e9, load=1000.0)
    t = np.linspace(-0.999, 0.999, 201)
    off = np.max(np.abs(solution.pressure_at(t) / closed.pressure_at(t) - 1))
    print(f"approach {1e6 * solution.approach:.6f} um ({1e6 * closed.approach:.6f} in closed form)")
    print(f"largest relative difference of the pressure {off:.1e}, stated error {solution.error:.1e}")
    return solution, closed


if __name__ == "__main__":
    main()
