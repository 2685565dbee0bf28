"""A substrate of your own, by its symbol: a body that long waves find softer, from light load to full contact."""

from dataclasses import dataclass

import numpy as np

import contact
from contact.testing import check_substrate


@contact.register_substrate("soft-below")
@dataclass(frozen=True)
class SoftBelow(contact.Substrate):
    """L = 1 + eps exp(-q depth): as the half-plane for waves shorter than the depth [m], softer by 1 + eps for long ones."""

    eps: float
    depth: float

    def symbol(self, q):
        return 1 + self.eps * np.exp(-q * self.depth)


def main():
    body = SoftBelow(eps=0.8, depth=1e-5)
    print(check_substrate(body))
    wave, E_star = contact.Sinusoid(amplitude=1e-6, period=1e-4), 1e11
    half, full = (
        contact.solve(contact.Scene(wave, E_star, contact.Periodic(), substrate=body, contact_fraction=share)) for share in (0.5, 1.0)
    )
    q = 2 * np.pi / wave.period
    closed = E_star * q * wave.amplitude / (2 * body.symbol(q))  # p_q = -E* q f_q / (2 L)
    print(f"half contact at {half.mean_pressure:.6e} Pa, full contact at {full.mean_pressure:.6e} Pa ({closed:.6e} in closed form)")
    return half, full, closed


if __name__ == "__main__":
    main()
