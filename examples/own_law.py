"""A law of your own: adhesion of small range, by the intensity of the pressure at the ends of zones, against the closed form."""

from dataclasses import dataclass

import numpy as np

import contact


@contact.register_law("adhesive")
@dataclass(frozen=True)
class Adhesive(contact.Law):
    """Bodies that adhere with the work of adhesion [J/m^2] (K. L. Johnson, K. Kendall & A. D. Roberts, Proc. R. Soc. A 324 (1971) 301):
    at distance d from the end of a zone the pressure is -sqrt(E* work / pi / d)."""

    work: float
    allows = ("load", "mean_pressure", "half_width")
    pulls = True

    def intensity(self, E_star):
        return -np.sqrt(E_star * self.work / np.pi)


def main():
    wave, E_star, a = contact.Sinusoid(amplitude=1e-6, period=1e-4), 1e9, 2e-5
    law = Adhesive(work=0.05)
    solution = contact.solve(contact.Scene(wave, E_star, contact.Periodic(), law=law, half_width=a), tol=1e-10)
    # K. L. Johnson, Int. J. Solids Struct. 32 (1995) 423.
    angle, L = np.pi * a / wave.period, wave.period
    closed = np.pi * E_star * wave.amplitude / L * np.sin(angle) ** 2 + law.intensity(E_star) * np.sqrt(2 * np.pi * np.tan(angle) / L)
    print(f"mean pressure {solution.mean_pressure:.8e} Pa ({closed:.8e} in closed form)")
    return solution, closed


if __name__ == "__main__":
    main()
