"""A wheel: creepage and slip of a railway wheel that drives, against Carter's closed form.

The contact sticks at its leading edge and slips at its trailing one. The last wheel has a worn band in its tread.
"""

import math

import contact

RADIUS, FRICTION, E_STAR, LOAD = 0.46, 0.3, 1.15e11, 8e6


def main():
    scene = contact.Scene(contact.Parabola(RADIUS), E_STAR, contact.Isolated(), load=LOAD)
    wheel = contact.solve(scene, tol=1e-10)
    half = 0.5 * wheel.zone_widths[0]
    slips = []
    for part in (0.25, 0.5, 0.75, 0.95):
        slip = contact.rolling(wheel, FRICTION, part * FRICTION * LOAD)
        carter = FRICTION * half / RADIUS * (1 - math.sqrt(1 - part))
        sticks = slip.stick_zones[0, 1] - slip.stick_zones[0, 0]
        print(f"Q = {part:.2f} of the sliding load: creepage {1e3 * slip.creepage:.4f} per mille", end=" ")
        print(f"({1e3 * carter:.4f}), {0.5 * sticks / half:.4f} of the contact sticks")
        slips.append(slip)
    worn = contact.Polynomial([0, 2e-3, -1.0, 0, 5e3])
    track = contact.solve(contact.Scene(worn, E_STAR, contact.Isolated(), load=LOAD), tol=1e-9)
    slip = contact.rolling(track, FRICTION, 0.6 * FRICTION * LOAD)
    print(f"worn: {len(track.zones)} zones, {len(slip.stick_zones)} of them stick,", end=" ")
    print(f"creepage {1e3 * slip.creepage:.4f} per mille")
    return [*slips, slip]


if __name__ == "__main__":
    main()
