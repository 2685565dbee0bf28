"""A flat punch with rounded edges: its curvature jumps where the shoulders begin, and says so."""

from dataclasses import dataclass

import numpy as np

import contact


@dataclass(frozen=True)
class RoundedPunch(contact.Profile):
    """Flat for |x| <= b, parabolic shoulders of that radius beyond."""

    b: float
    radius: float
    symmetric = True

    def height(self, x):
        return np.maximum(np.abs(x) - self.b, 0.0) ** 2 / (2 * self.radius)

    def slope(self, x):
        return np.sign(x) * np.maximum(np.abs(x) - self.b, 0.0) / self.radius

    @property
    def jumps(self):
        return np.array([[-self.b, 2, -1 / self.radius], [self.b, 2, 1 / self.radius]])


def main():
    punch = RoundedPunch(b=1e-3, radius=5e-3)
    return [contact.solve(contact.Scene(punch, 1e11, contact.Isolated(), load=load)) for load in (1e3, 1e5, 1e7)]


if __name__ == "__main__":
    for solution in main():
        print(f"{solution.load:.0e} N/m  a = {solution.zones[0, 1]:.6e} m  peak {solution.max_pressure:.4e} Pa")
