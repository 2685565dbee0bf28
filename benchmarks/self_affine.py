"""Self-affine roughness from a hundred zones to ten thousand: python benchmarks/self_affine.py [KMAX ...].

Hurst exponent 0.8, harmonics 4 ... kmax with random phases, rms slope 0.1, mean pressure 0.05 E* slope, tolerance 1e-8. Each size in
a process of its own, for its peak memory. Prints a table and the exponent fitted to processor time over the number of zones.
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import time

import numpy as np

import contact
from contact.terminal import show_table

SIZES = (1_000, 3_000, 10_000, 30_000, 100_000)
SLOPE, PRESSURE, HURST, FIRST = 0.1, 0.05, 0.8, 4


def profile(kmax: int, seed: int = 0) -> contact.Fourier:
    """Amplitudes k^-(H + 1/2), scaled to the rms slope; the period is 1 m."""
    k = np.arange(FIRST, kmax + 1)
    phase = np.random.default_rng(seed).uniform(0, 2 * np.pi, len(k))
    amplitude = k ** -(HURST + 0.5)
    amplitude *= SLOPE / np.sqrt(0.5 * np.sum((2 * np.pi * k * amplitude) ** 2))
    cosine, sine = np.zeros(kmax), np.zeros(kmax)
    cosine[FIRST - 1 :], sine[FIRST - 1 :] = amplitude * np.cos(phase), amplitude * np.sin(phase)
    return contact.Fourier(1.0, cosine, sine)


def measure(kmax: int, tol: float = 1e-8) -> dict[str, float | bool]:
    """One solution: zones, processor time [s], peak memory [GB], stated error, whether the certificate holds."""
    scene = contact.Scene(profile(kmax), 1.0, contact.Periodic(), mean_pressure=PRESSURE * SLOPE)
    start = time.process_time()
    solution = contact.solve(scene, tol=tol)
    return {
        "kmax": kmax, "zones": len(solution.zones), "seconds": time.process_time() - start,
        "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20, "error": solution.error,
        "holds": solution.certificate.holds,
    }


def main(sizes: tuple[int, ...]) -> None:
    rows = []
    for kmax in sizes:
        run = subprocess.run([sys.executable, __file__, "--one", str(kmax)], check=True, capture_output=True, text=True)
        rows.append(json.loads(run.stdout))
    names = ("kmax", "zones", "processor time [s]", "peak memory [GB]", "stated error", "certificate")
    table = [
        (f"{r['kmax']}", f"{r['zones']}", f"{r['seconds']:.2f}", f"{r['memory']:.2f}", f"{r['error']:.1e}", str(r["holds"]))
        for r in rows
    ]
    show_table("self-affine roughness", names, table, numeric=range(5))
    if len(rows) > 1:
        growth = np.polyfit(np.log([r["zones"] for r in rows]), np.log([r["seconds"] for r in rows]), 1)[0]
        print(f"processor time grows as zones^{growth:.2f}")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--one"]:
        print(json.dumps(measure(int(sys.argv[2]))))
    else:
        main(tuple(map(int, sys.argv[1:])) or SIZES)
