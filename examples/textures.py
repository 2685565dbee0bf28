"""Five textures under the same pressures: contact, largest pressure, stiffness and the room that is left between the surfaces.

All have a period of 100 um and a depth of 1 um, on an elastic half-plane of E* = 1.1e11 Pa; the flats rise without end."""

import numpy as np

import contact

L, DEPTH = 1e-4, 1e-6
TEXTURES = {
    "wave": contact.Sinusoid(amplitude=DEPTH / 2, period=L),
    "two tips": contact.Biquadratic(radius=(L**2 / 4 - 4e-10) ** 2 / (8 * 4e-10 * DEPTH), spacing=4e-5, period=L),
    "wedge": contact.Wedge(slope=2 * DEPTH / L, period=L),
    "rounded flats": contact.Fourier(period=L, cosine=[-0.566e-6, -0.142e-6, 0.063e-6, 0.035e-6]),
    "flats": contact.Flat(width=4e-5, period=L),
}


def main():
    solutions = {}
    print(f"{'':14}{'pressure':>9}{'zones':>6}{'contact':>9}{'largest p [MPa]':>17}{'stiffness [MPa/um]':>19}{'room [nm]':>11}{'error':>9}")
    for name, profile in TEXTURES.items():
        for pressure in (1e7, 1e8, 5e8):
            scene = contact.Scene(profile, 1.1e11, contact.Periodic(), mean_pressure=pressure)
            solution = solutions[name, pressure] = contact.solve(scene, tol=1e-9)
            room = "infinite" if np.isinf(solution.mean_gap) else f"{1e9 * solution.mean_gap:.2f}"
            largest, stiffness = solution.max_pressure / 1e6, solution.stiffness / L / 1e12
            told = f"{name:14}{pressure / 1e6:5.0f} MPa{len(solution.zones):6}{solution.contact_fraction:9.4f}"
            print(f"{told}{largest:17.2f}{stiffness:19.2f}{room:>11}{solution.error:9.0e}")
    return solutions


if __name__ == "__main__":
    main()
