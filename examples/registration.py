"""Two textured faces, one slid along the other: contact, largest pressure and room between them over the shift.

A wave and a row of rounded flats of the same period, under 100 MPa on E* = 1.1e11 Pa. Tips on tips touch on little and leave much room;
tips in valleys mate. Only the sum of both heights counts, so that each place is one scene of one profile, `contact.Combined`."""

import numpy as np

import contact

L = 1e-4
BODY = contact.Sinusoid(amplitude=0.5e-6, period=L)
COUNTER = contact.Fourier(period=L, cosine=[-0.566e-6, -0.142e-6, 0.063e-6, 0.035e-6])


def main():
    solutions = []
    print(f"{'shift [um]':>10}{'zones':>6}{'contact':>9}{'largest p [MPa]':>17}{'room [nm]':>11}{'error':>9}")
    for shift in np.linspace(0, L / 2, 9):
        pair = contact.Combined(BODY, COUNTER, shift=shift)
        solution = contact.solve(contact.Scene(pair, 1.1e11, contact.Periodic(), mean_pressure=1e8), tol=1e-9)
        told = f"{1e6 * shift:10.2f}{len(solution.zones):6}{solution.contact_fraction:9.4f}{solution.max_pressure / 1e6:17.2f}"
        print(f"{told}{1e9 * solution.mean_gap:11.2f}{solution.error:9.0e}")
        solutions.append(solution)
    return solutions


if __name__ == "__main__":
    main()
