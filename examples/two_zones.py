"""A texture with two tips a period: two zones that grow and become one."""

import numpy as np

import contact

PERIOD = 1e-4


def main():
    profile = contact.Biquadratic(radius=1e-3, spacing=4e-5, period=PERIOD)
    solutions = []
    print("mean pressure   zones   contact   mean gap")
    for mean_pressure in np.array([2.0, 5.0, 10.0, 20.0, 40.0]) * 1e6:
        scene = contact.Scene(profile, E_star=1e10, interaction=contact.Periodic(), mean_pressure=mean_pressure)
        solution = contact.solve(scene)
        print(
            f"{mean_pressure / 1e6:9.0f} MPa {len(solution.zones):7d} {solution.contact_fraction:9.4f}"
            f" {1e9 * solution.mean_gap:7.2f} nm"
        )
        solutions.append(solution)
    return solutions


if __name__ == "__main__":
    main()
