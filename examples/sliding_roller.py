"""A steel roller dragged over a polymer: friction moves its contact and makes it skew. The load that
makes it so wide, and the place of its middle, are those of the closed form.
"""

import math

import contact


def main():
    radius, load = 0.01, 2e4
    E_star = contact.E_star(E1=2e9, nu1=0.35, E2=210e9, nu2=0.3)
    beta = contact.dundurs_beta(E1=2e9, nu1=0.35, E2=210e9, nu2=0.3)
    found = []
    for friction in (0.0, 0.4, 0.8):
        law = contact.Sliding(friction, beta, direction=1)
        scene = contact.Scene(
            contact.Parabola(radius), E_star, contact.Isolated(), law=law, load=load
        )
        solution = contact.solve(scene, tol=1e-10)
        alpha = 0.5 - math.atan(law.kappa) / math.pi
        half = math.sqrt(load * radius / (math.pi * alpha * (1 - alpha) * E_star))
        a, b = 1e6 * solution.zones[0]
        print(f"friction {friction:.1f}: contact from {a:7.2f} to {b:6.2f} um,", end=" ")
        print(f"half width {0.5 * (b - a):.3f} ({1e6 * half:.3f} in closed form),", end=" ")
        print(f"tangential load {1e-3 * solution.tangential_load:4.1f} N/mm")
        found.append((solution, half, half * (1 - 2 * alpha)))
    return found


if __name__ == "__main__":
    main()
