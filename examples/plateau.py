"""A texture that keeps its contact fraction over a wide range of loads.

A wave touches the more the more it is pressed. Here its harmonics are chosen so that the contact
fraction is as near to 0.3 as possible at three mean pressures.
"""

import numpy as np

import contact


def away_from_it(fractions):
    away = np.array(fractions) - 0.3
    return away @ away, list(2 * away)


def main():
    pressures = (4e7, 8e7, 1.6e8)
    wave = contact.Fourier(period=1e-4, cosine=[-2e-6])
    scene = contact.Scene(wave, 1e10, contact.Periodic(), mean_pressure=pressures[0])
    size = np.array([5e-7, 4e-7, 1e-7])
    middle = np.array([-2e-6, 0.0, 0.0])
    best = contact.optimize(
        scene,
        contact.Objective("contact_fraction", away_from_it),
        over={"profile.cosine": (middle - size, middle + size)},
        at=pressures,
    )
    for shape in (scene, best.scene):
        loaded = [contact.solve(shape.under("mean_pressure", p)) for p in pressures]
        print("contact fractions", np.round([one.contact_fraction for one in loaded], 4))
    print("waves", np.round(1e6 * best.data["profile.cosine"], 4), "um")
    return best
