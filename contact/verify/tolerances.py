"""`Tolerances`: the one place for what the certificate allows and what the stated error adds."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Tolerances:
    """Numbers of the certificate and of the stated error, all relative."""

    # What the certificate allows.
    balance: float = 1e-9  # of load and moment: far above rounding, far below any real mistake
    edge_condition: float = 1e-7  # intensity at an end, or gap at the end of a tension
    dip_rounding: float = 1e-14  # a minimum of the pressure over its zone's largest value is noise
    gap_margin: float = 100.0  # times the gap that the density's error makes on the zones
    shape_mismatch: float = 1e-6  # part of the height by which height and slope may contradict

    # What the stated error adds.
    rounding: float = 4e-14  # of a sum of some hundred terms over the largest: the least error
    singular_end: float = 8.0  # pressure at a singular end over the mean pressure
    compliance_rounding: float = 4e-15  # of the half-plane's kernel, several times what is seen
    neglected_modes: float = 5.0  # times the modes that are left out, on layers
    relief_shift: float = 2.0  # an uneven error of R moves the ends of a gap in opposite ways
    unresolved_distance: float = 1e-7  # of the period: no statement about pressures nearer to a gap
    unresolved_gap: float = 1e-4  # of its width: ends so uncertain may not tell where the gap is
    tip_distance: float = 0.01  # of the half width: no statement about pressures nearer to a tip
    max_kernel_lengths: float = 3000.0  # width of a zone: 20,000 unknowns, more than 5 s


TOLERANCES = Tolerances()
