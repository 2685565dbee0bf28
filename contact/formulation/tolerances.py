"""`Tolerances`: the numbers of the certificate, on every route, with the allowed overlap.

The stated error shares the round-off and the constants below; its bounds are derived in
contact.verify.error.
"""

from dataclasses import dataclass

from contact.model.profiles.noise import EPS


@dataclass(frozen=True)
class Tolerances:
    """Relative tolerances of the certificate, and constants of the stated error."""

    # Round-off of a sum of some hundred terms, relative to the largest term. It is the smallest
    # error that is stated, and the smallest pressure or gap whose sign is known.
    rounding: float = 4e-14
    # Largest noise of the data. Larger contradictions in the data are faults. The noise bounds how
    # negative a pressure may be, and how much the slope and the height of a profile may differ.
    noise: float = 1e-6

    # The terms of the allowed overlap, see `allowed_overlap`. A gap that is the integral of a
    # series has the term `rounding` in place of the first two.
    # Round-off of a gap that is a sum of heights, relative to the largest height.
    height_rounding: float = 64 * EPS
    # Bound of the noise of a gap, over a sample of the noise of the heights.
    noise_multiple: float = 8.0
    # The gap computed on the zones, where the exact gap is zero, is a sample of the error of all
    # gaps. The error elsewhere may be this many times larger.
    on_zones_multiple: float = 2.0
    # Overlap of surfaces that a tension pulls but that do not touch, relative to the reach of the
    # tension: round-off times a condition number of 1e3.
    apart_rounding: float = 1e-12
    # The stated error uses the likely error of a gap. The bound of this error is larger by this
    # factor.
    rounding_margin: float = 16.0
    # Round-off of the slope of the gap in closed form, relative to its terms. A gap that falls at a
    # smaller rate counts as rising.
    slope_rounding: float = 16 * EPS

    # Bound of the error of the pressure's samples, over the noise of the zone's right side.
    pressure_noise_multiple: float = 2.0
    # A gap over a concave kink is left out if its half width is below this fraction of the period,
    # or of the zone next to it. The certificate says so. The round-off of the gap's ends is about
    # as large.
    narrowest_gap: float = 1e-13

    # Largest allowed error of load and moment. It is far above rounding, and far below the error of
    # a wrong solution.
    balance: float = 1e-9
    # Largest allowed error of the intensity at an end, or of the gap where a cohesive tension ends,
    # relative to the reach of the tension.
    edge_condition: float = 1e-7
    # Bound of the round-off of the gap at an end of a tension, over the round-off of other gaps.
    reach_multiple: float = 4.0
    # Nearer to an end of a tension than this, relative to the width of the interval of tension, the
    # certificate does not compare the gap with the reach.
    reach_distance: float = 1e-9
    gap_margin: float = 100.0  # factor on the gap that the density's error causes on the zones

    # Factor on error estimates that neglect terms of the same order, as for a truncated series.
    margin: float = 10.0
    closed_form_rounding: float = 1e-13  # of full contact, and of surfaces that do not touch
    singular_end: float = 8.0  # pressure at a singular end, divided by the mean pressure
    unresolved_distance: float = 1e-7  # of the period: no statement about pressures nearer to a gap
    tip_distance: float = 0.01  # of the half width: no statement about pressures nearer to a tip
    max_kernel_lengths: float = 3000.0  # width of a zone: 20,000 unknowns, more than 5 s

    # Bound of the pressure's relative error divided by the relative error of the ends of a tension.
    # Pressures are compared at equal normalised positions in a zone. The bound holds as strips of
    # tension move with their zones, and as the pressure's normalised slope next to an end is below
    # it.
    tension_factor: float = 16.0
    # Least angle [rad] from the ends of a zone at which the slope of the zone's pressure is
    # sampled. The cosine of the angle is the normalised position.
    least_angle: float = 0.3

    @property
    def kernel_rounding(self) -> float:
        """Rounding of the half-plane's kernel, whose sums have a tenth as many terms as the other
        sums.
        """
        return self.rounding / 10


TOLERANCES = Tolerances()


def allowed_overlap(
    heights: float = 0.0,
    noise: float = 0.0,
    series: float = 0.0,
    on_zones: float = 0.0,
    reach: float = 0.0,
) -> float:
    """Largest negative gap that counts as round-off of a gap; all lengths in the same unit.

    Every route passes the sizes that its gap has. heights: largest term of a gap that is a sum of
    heights. noise: of these heights. series: largest term of a gap that is the integral of a
    series. on_zones: gap computed on the zones. reach: of a tension between surfaces that do not
    touch.
    """
    return (
        TOLERANCES.height_rounding * heights
        + TOLERANCES.noise_multiple * noise
        + TOLERANCES.rounding * series
        + TOLERANCES.on_zones_multiple * on_zones
        + TOLERANCES.apart_rounding * reach
    )
