"""What lies under the spikes of a trace: the largest stresses below ground steel, and the load at which it first yields.

The spikes of 8 GPa in the pressure of stylus.toml are those of a surface that never yields: hardened bearing steel
yields at a fifth of that load.
"""

from pathlib import Path

import contact

SCENE = Path(__file__).parent / "stylus.toml"
STRENGTH, NU = 2.0e9, 0.3  # bearing steel, in tension [Pa]


def state(solution):
    pressures = f"mean pressure {1e-6 * solution.mean_pressure:.4f} MPa, peak {1e-9 * solution.max_pressure:.4f} GPa"
    return f"{pressures}, {len(solution.zones)} zones"


def main():
    solution = contact.solve(contact.load_scene(SCENE))
    found = solution.first_yield(STRENGTH, NU)
    stress = solution.stress(found.x, found.y)
    print(f"the scene: {state(solution)}")
    print(f"first yield: {state(found.solution)}")
    print(f"at x = {1e3 * found.x:.4f} mm, {1e9 * found.y:.1f} nm below the surface")
    print(f"there at the load of the scene: von Mises {1e-9 * float(stress.mises(NU)):.4f} GPa")
    print(f"stated error of the load of first yield {found.error:.0e}")
    return found


if __name__ == "__main__":
    main()
