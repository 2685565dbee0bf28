"""The most even pressure of a texture of given smoothness: its largest pressure is as small as possible.

The first wave is 1 um high. The others may be chosen within bounds that fall like k^(-3/2), the smoothness of a
rough surface. At the best texture several places have the largest pressure, and no step lowers all of them.
"""

import numpy as np

import contact

MEAN = 8e7


def main():
    print("waves  largest pressure / mean  optimality")
    best = None
    for many in (1, 2, 3, 6):
        bounds = np.append(1e-11, 6e-7 / np.arange(2, many + 1) ** 1.5)
        middle = np.append(-1e-6, np.zeros(many - 1))
        scene = contact.Scene(
            contact.Fourier(period=1e-4, cosine=middle), 1e10, contact.Periodic(), mean_pressure=MEAN
        )
        best = contact.optimize(scene, "max_pressure", over={"profile.cosine": (middle - bounds, middle + bounds)})
        highest = contact.solve(best.scene).max_pressure
        print(f"{many:5}  {highest / MEAN:23.3f}  {best.optimality:10.0e}")
    print("waves", np.round(1e6 * best.data["profile.cosine"], 3), "um")
    return best
