"""A body of one's own by its symbol alone: coats on a half-plane, by matrices from the base up; E_star is that of the outermost coat."""

from dataclasses import dataclass

import numpy as np

import contact


def modes(k, s):
    """2 mu u and t/q (..., 2, 2) of the waves exp(-qy) of an elastic body at depth s = qy, u = (u_x / i, u_y), k = 3 - 4 nu."""
    u, t = np.array([[1 + 0 * s, -s], [0 * s - 1, k + s]]), np.array([[0 * s - 1, (k - 1) / 2 + s], [1 + 0 * s, -(k + 1) / 2 - s]])
    return np.moveaxis(u, (0, 1), (-2, -1)), np.moveaxis(t, (0, 1), (-2, -1))


@contact.register_substrate("coats")
@dataclass(frozen=True)
class Coats(contact.Substrate):
    """Thicknesses [m] and moduli over that of the base, from the base outwards; all of one Poisson ratio."""
    thicknesses: tuple[float, ...]
    moduli: tuple[float, ...]
    nu: float = 0.3

    def symbol(self, q):
        k, mirror, mu, (u, t) = 3 - 4 * self.nu, np.diag([1.0, -1.0]), 1.0, modes(3 - 4 * self.nu, 0 * q)
        stiffness = t @ np.linalg.inv(u)  # t/q over 2u at the surface of the base
        for h, mu in zip(self.thicknesses, self.moduli, strict=True):
            (deep_u, deep_t), e = modes(k, q * h), np.exp(-q * h)[..., None, None]
            up = np.linalg.solve(-mu * mirror @ t - stiffness @ mirror @ u, (stiffness @ deep_u - mu * deep_t) * e)  # what is sent back
            stiffness = mu * (t - mirror @ deep_t @ up * e) @ np.linalg.inv(u + mirror @ deep_u @ up * e)
        return -2 * mu / (k + 1) * np.linalg.inv(stiffness)[..., 1, 1]


def main():
    body = Coats(thicknesses=(1e-6, 2e-6), moduli=(2.0, 4.0))
    return contact.solve(contact.Scene(contact.Parabola(1e-3), E_star=4e11, interaction=contact.Isolated(), substrate=body, load=1e3))


if __name__ == "__main__":
    print(main().zones)
