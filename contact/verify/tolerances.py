"""`Tolerances`: the numbers of the certificate and of the stated error, on every route."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Tolerances:
    """Relative tolerances of the certificate, and constants of the stated error."""

    # Round-off of a sum of some hundred terms, relative to the largest term. It is the smallest
    # error that is stated, and the smallest pressure or gap whose sign is known.
    rounding: float = 4e-14
    # Largest noise of the data. Larger contradictions in the data are faults. The noise bounds how
    # negative a pressure may be, and how much the slope and the height of a profile may differ.
    noise: float = 1e-6

    # Largest allowed error of load and moment. It is far above rounding, and far below the error of
    # a wrong solution.
    balance: float = 1e-9
    # Largest allowed error of the intensity at an end, or of the gap where a cohesive tension ends.
    edge_condition: float = 1e-7
    gap_margin: float = 100.0  # factor on the gap that the density's error causes on the zones

    # Factor on error estimates that neglect terms of the same order, as for a truncated series.
    margin: float = 10.0
    singular_end: float = 8.0  # pressure at a singular end, divided by the mean pressure
    unresolved_distance: float = 1e-7  # of the period: no statement about pressures nearer to a gap
    tip_distance: float = 0.01  # of the half width: no statement about pressures nearer to a tip
    max_kernel_lengths: float = 3000.0  # width of a zone: 20,000 unknowns, more than 5 s

    @property
    def kernel_rounding(self) -> float:
        """Rounding of the half-plane's kernel, whose sums have a tenth as many terms as others."""
        return self.rounding / 10


TOLERANCES = Tolerances()
