"""A texture designed as a Fourier series: the load on each of its zones, and how stiff the joint is."""

import numpy as np

import contact


def main():
    # Five waves a period, of unequal height: the lower ones come into contact later.
    profile = contact.Fourier(
        period=5e-4,
        cosine=[-0.10e-6, 0.0, 0.0, 0.0, -0.50e-6],
        sine=[0.06e-6, -0.05e-6],
    )
    solutions = []
    for mean_pressure in (1e6, 1e7, 5e7):
        scene = contact.Scene(profile, E_star=7e10, interaction=contact.Periodic(), mean_pressure=mean_pressure)
        solution = contact.solve(scene)
        share = solution.zone_loads / solution.load
        print(f"{mean_pressure:.0e} Pa: {len(solution.zones)} zones, stiffness {solution.stiffness / 1e9:.4g} kN/mm^2")
        for (left, right), part in zip(1e6 * solution.zones, share, strict=True):
            print(f"    {left:9.3f} ... {right:9.3f} um carries {100 * part:6.2f} %")
        assert np.isclose(share.sum(), 1.0)
        solutions.append(solution)
    return solutions


if __name__ == "__main__":
    main()
