"""Fretting of a rough line: what sticks as the tangential load grows, and what a cycle of it costs.

A rough steel surface is pressed on another one and pulled to and fro. The lightly loaded zones slip first.
"""

import numpy as np

import contact

PERIOD, FRICTION = 1e-4, 0.6


def main():
    rng = np.random.default_rng(7)
    waves = np.arange(1, 33)
    size = 1.2e-7 * waves**-1.3
    angle = rng.uniform(0, 2 * np.pi, len(waves))
    profile = contact.Fourier(PERIOD, size * np.cos(angle), size * np.sin(angle))
    scene = contact.Scene(profile, 1.15e11, contact.Periodic(), mean_pressure=4e8)
    solution = contact.solve(scene, tol=1e-9)
    load, width = solution.load, np.diff(solution.zones).sum()
    print(f"{len(solution.zones)} zones, {width / PERIOD:.1%} of the surface in contact")
    slips = []
    for part in (0.1, 0.5, 0.9):
        shear = part * FRICTION * load
        slip = contact.partial_slip(solution, FRICTION, shear)
        cycle = contact.load_history(scene, FRICTION, [(load, shear), (load, -shear), (load, shear)])
        sticks = np.diff(slip.stick_zones).sum() / width
        print(f"Q = {part:.1f} of the sliding load: {sticks:.3f} of the contact sticks,", end=" ")
        print(f"in {len(slip.stick_zones)} zones; a half cycle costs {cycle[2].dissipated:.3e} J/m")
        slips.append(slip)
    return [slips[2], slips[0], slips[1]]


if __name__ == "__main__":
    main()
