"""Two tips that adhere: pressed on, and pulled off. The higher one jumps in at no load, the other by a tension of finite range, and lets
go at far less than that: at one load between there are two contacts, and which it is depends on the way."""

import contact


def main():
    profile = contact.Fourier(1e-4, cosine=[-1.5e-8, -2e-7], sine=[0.0, 0.0])
    law = contact.Dugdale(work=0.02, stress=4e6)  # J/m^2, Pa: the surfaces pull up to a gap of 5 nm
    scene = contact.Scene(profile, E_star=1e9, interaction=contact.Periodic(), law=law, load=5.0)
    for branch in ("advancing", "receding"):
        solution = contact.solve(scene, branch=branch)
        print(f"{branch:9} at 5 N/m: {len(solution.zones)} zones, {100 * solution.contact_fraction:.3f} % in contact")
    loop = contact.path(scene, [-30.0, 25.0, -30.0])
    for event in loop.events:
        print(f"{event.kind:8} at {event.load:7.4f} N/m, approach {1e9 * event.approach:7.3f} nm, loses {1e9 * event.lost:.3f} nJ/m")
    print(f"work of the load {1e9 * loop.work:.3f} nJ/m, lost {1e9 * loop.dissipated:.3f} nJ/m")
    return loop


if __name__ == "__main__":
    main()
