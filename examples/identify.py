"""A texture identified from its load curve: two waves and the modulus, with their deviations.

The approach is measured under four mean pressures, to 0.2 %. Least squares finds the data that
fit best, and the derivatives there give the covariance of what is found.
"""

import numpy as np

import contact


def joint(waves, E_star):
    profile = contact.Fourier(period=1e-4, cosine=waves)
    return contact.Scene(profile, E_star, contact.Periodic(), mean_pressure=1e8)


def main():
    rng, pressures = np.random.default_rng(1), 2.5e7 * np.arange(1, 5)
    true = joint([-1e-6, 1.5e-7], 7e9)
    exact = np.array([contact.solve(true.under("mean_pressure", p)).approach for p in pressures])
    best = contact.optimize(
        joint([-9e-7, 1e-7], 8e9),
        contact.Measured("approach", exact + 0.002 * exact * rng.standard_normal(4), 0.002 * exact),
        over={
            "profile.cosine": ([-2e-6, -3e-7], [-7e-7, 3e-7]),
            "material.E_star": (1e9, 2e10),
        },
        at=pressures,
    )
    found = *best.data["profile.cosine"], best.data["material.E_star"]
    deviations = np.sqrt(np.diag(best.covariance))
    names = ("first wave", "second wave", "E*")
    for name, value, deviation in zip(names, found, deviations, strict=True):
        print(f"{name}: {value:.4g} +- {deviation:.2g}")
    print(f"sum of squares: {best.objective:.3g}")
    contact.solve(best.scene)
    return best
