"""`Tolerances`: the numbers of the certificate and of the stated error."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Tolerances:
    """Numbers of the certificate and of the stated error, all relative."""

    # Errors that the certificate allows.
    # error of load and moment: far above rounding, far below that of a wrong solution
    balance: float = 1e-9
    # error of the intensity at an end, or of the gap where a cohesive tension ends
    edge_condition: float = 1e-7
    # a minimum of the pressure this small, relative to the zone's largest value, is noise
    dip_rounding: float = 1e-14
    gap_margin: float = 100.0  # factor on the gap that the density's error causes on the zones
    # largest contradiction of height and slope, relative to the height
    shape_mismatch: float = 1e-6

    # Contributions to the stated error.
    # of a sum of some hundred terms, relative to the largest one: the smallest error stated
    rounding: float = 4e-14
    singular_end: float = 8.0  # pressure at a singular end, divided by the mean pressure
    # rounding of the half-plane's kernel: several times the largest that was observed
    compliance_rounding: float = 4e-15
    neglected_modes: float = 5.0  # factor on the size of the modes that are left out, on layers
    relief_shift: float = 2.0  # an uneven error of R moves the ends of a gap in opposite ways
    unresolved_distance: float = 1e-7  # of the period: no statement about pressures nearer to a gap
    # error of a gap's ends relative to its width above which its place is uncertain
    unresolved_gap: float = 1e-4
    tip_distance: float = 0.01  # of the half width: no statement about pressures nearer to a tip
    max_kernel_lengths: float = 3000.0  # width of a zone: 20,000 unknowns, more than 5 s


TOLERANCES = Tolerances()
