"""The stiffest joint at a limit of the pressure: the harmonics of a texture of given waviness.

The first wave is at least 1 um high. The second and third may be chosen; nowhere may the pressure exceed
the hardness. `contact.optimize` makes the stiffness at the given load as large as this allows.
"""

import numpy as np

import contact


def main():
    wave = contact.Fourier(period=1e-4, cosine=[-1.05e-6, 0.0, 0.0])
    scene = contact.Scene(wave, E_star=1e10, interaction=contact.Periodic(), mean_pressure=8e7)
    bounds = [-1.1e-6, -3e-7, -3e-7], [-1e-6, 3e-7, 3e-7]
    for hardness in (3e8, 2.4e8, 2.0e8):
        best = contact.optimize(
            scene,
            "-stiffness",
            over={"profile.cosine": bounds},
            subject_to=[("max_pressure", None, hardness)],
        )
        solution = contact.solve(best.scene)
        print(
            f"H = {hardness / 1e6:.0f} MPa: waves {np.round(1e6 * best.data['profile.cosine'], 4)} um, stiffness "
            f"{solution.stiffness / 1e9:.4g} kN/mm^2, largest pressure {solution.max_pressure / 1e6:.1f} MPa"
        )
    return best
