"""An interaction of your own, by its kernel: the longest wave of the period finds the body softer by a half, against the closed form."""

from dataclasses import dataclass

import numpy as np

import contact
import sie


@contact.register_interaction("bed")
@dataclass(frozen=True)
class Bed(contact.Interaction):
    """L = 1 + eps for the longest wave of the period, 1 for all others."""

    eps: float = 0.5
    needs_period = True

    def kernel(self, period, unit):  # lengths are counted in `unit` metres, the period is scaled already
        k = 2 * np.pi / period
        return sie.hilbert(period) + sie.Smooth(
            lambda x, xi: self.eps * k * np.sin(k * (x - xi)), lambda x, xi: -self.eps * np.cos(k * (x - xi))
        )


def main():
    wave, E_star, load = contact.Sinusoid(amplitude=1e-6, period=1e-4), 1e11, 1e5
    solution = contact.solve(contact.Scene(wave, E_star, Bed(), load=load), tol=1e-10)
    # A wave under the first harmonic of its own pressure stays a wave: Westergaard's contact of another amplitude.
    part = np.sin(np.pi * solution.zones[0, 1] / wave.period) ** 2
    amplitude = wave.amplitude - 0.5 * (2 - part) * load / (np.pi * E_star)
    closed = np.pi * E_star * amplitude * part
    print(f"contact on {solution.contact_fraction:.6f} of the period under {load:.6e} N/m ({closed:.6e} in closed form)")
    return solution, closed


if __name__ == "__main__":
    main()
