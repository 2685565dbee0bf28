"""A punch under a load off its middle: it turns, and from a quarter of its width on it lifts off at the other corner."""

import contact
from contact.reference.exact.tilted import TiltedPunch


def main():
    corner, load = 5e-5, 100.0
    found = []
    for centre in (0.0, 1e-5, 2.5e-5, 4e-5):
        scene = contact.Scene(
            contact.Flat(width=2 * corner), E_star=1e9, interaction=contact.Isolated(), load=load, moment=load * centre
        )
        solution = contact.solve(scene, tol=1e-9)
        closed = TiltedPunch(corner, 1e9, load, load * centre)
        a, b = 1e6 * solution.zones[0]
        print(f"load at {1e6 * centre:4.0f} um: contact from {a:5.1f} to {b:4.1f} um, tilt {1e3 * solution.tilt:.5f} mrad", end="")
        print(f" ({1e3 * closed.tilt:.5f} in closed form)")
        found.append((solution, closed))
    return found


if __name__ == "__main__":
    main()
