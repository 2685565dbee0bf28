"""How far the neighbours matter: one wave by the isolated, the localized and the exact model, at the same width."""

import contact

MODELS = {
    "isolated": contact.Isolated(),
    "localized, first-order": contact.Localized(),
    "localized, self-consistent": contact.Localized(closure="self-consistent"),
    "one neighbour each side": contact.Localized(closure="self-consistent", neighbours=1),
    "exact": contact.Periodic(),
}


def main():
    profile = contact.Sinusoid(amplitude=1e-6, period=1e-4)
    loads = {}
    for fraction in (0.2, 0.5, 0.7):
        for name, model in MODELS.items():
            scene = contact.Scene(profile, 1.1e11, model, half_width=0.5 * fraction * profile.period)
            loads[fraction, name] = contact.solve(scene).load
        print(f"contact fraction {fraction}")
        for name in MODELS:
            off = loads[fraction, name] / loads[fraction, "exact"] - 1
            print(f"  {name:27}{loads[fraction, name]:12.6g} N/m {100 * off:+9.4f} %")
    return loads


if __name__ == "__main__":
    main()
