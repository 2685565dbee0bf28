"""A rough surface that yields: the pressure is at most the hardness, and summits get plateaus."""

import contact

STEEL = contact.E_star(210e9, 0.3)
HARDNESS = 2.5e9
ROUGH = contact.Fourier(
    period=1e-4, cosine=[4e-7, 0.0, 1.5e-7, 0.0, 5e-8], sine=[0.0, 2e-7, 0.0, 1e-7, 4e-8]
)


def main():
    found = []
    for pressure in (0.1e9, 0.5e9, 1.5e9, 2.4e9):
        scene = contact.Scene(ROUGH, STEEL, contact.Periodic(), mean_pressure=pressure)
        elastic = contact.solve(scene)
        law = contact.Plastic(HARDNESS)
        solution = contact.solve(
            contact.Scene(ROUGH, STEEL, contact.Periodic(), law=law, mean_pressure=pressure)
        )
        yielded = (solution.plateaus[:, 1] - solution.plateaus[:, 0]).sum() / 1e-4
        middles = solution.plateaus.mean(axis=1)
        depth = solution.overlap(middles).max(initial=0.0)
        print(
            f"mean {pressure / 1e9:.1f} GPa: peak {elastic.max_pressure / 1e9:.2f} GPa if elastic; "
            f"contact {solution.contact_fraction:.4f} ({elastic.contact_fraction:.4f} if elastic), "
            f"{len(solution.plateaus)} plateaus on {yielded:.4f}, to {depth * 1e9:.1f} nm"
        )
        found.append((elastic, solution))
    return found


if __name__ == "__main__":
    main()
