"""`Tolerances`: the numbers of the certificate for every method of solution.

`allowed_overlap` is the largest negative gap that counts as round-off. The stated error uses the
numbers, too; its bounds are derived in contact.verify.error.
"""

from dataclasses import dataclass

from contact.model.profiles.noise import EPS


@dataclass(frozen=True)
class Tolerances:
    """Relative tolerances of the certificate, and constants of the stated error."""

    # Round-off of a sum of some hundred terms, relative to the largest term. It is the smallest
    # error that is stated, and the smallest pressure or gap whose sign is known.
    rounding: float = 4e-14
    # Largest relative noise that the data may have; a larger contradiction is a fault. It limits
    # how negative a pressure may be, and how far slope and heights of a profile may disagree.
    noise: float = 1e-6

    # The next four fields are factors in `allowed_overlap`. The first one is the round-off of a gap
    # that is a sum of heights, relative to the largest height.
    height_rounding: float = 64 * EPS
    # Bound of a gap's noise, divided by the noise that is measured from samples of the heights.
    noise_multiple: float = 8.0
    # Bound of the error of the gap at all places, divided by the gap computed on the contact zones.
    # The exact gap on the zones is zero, so the gap computed there is an error.
    on_zones_multiple: float = 2.0
    # Allowed overlap of surfaces that attract each other without contact, divided by the largest
    # gap at which the tension acts. It is round-off times a condition number of 1e3.
    apart_rounding: float = 1e-12
    # Bound of a gap's round-off, divided by the likely size of this round-off. The stated error
    # contains the likely size.
    rounding_margin: float = 16.0
    # In contact.closed: round-off of the gap's slope, relative to the terms of the slope. A
    # negative slope within this round-off counts as zero.
    slope_rounding: float = 16 * EPS

    # Bound of the error of sampled pressures in a zone, divided by the noise of the right side of
    # the integral equation in that zone.
    pressure_noise_multiple: float = 2.0
    # Smallest half width of a gap over a concave kink, relative to the period or to the zone next
    # to it. Narrower gaps are left out, since they are no wider than the round-off of their ends.
    # The certificate reports that gaps are left out.
    narrowest_gap: float = 1e-13

    # Largest allowed relative error of load and moment. It is far above rounding, and far below the
    # error of a wrong solution.
    balance: float = 1e-9
    # Largest allowed relative error of the edge intensity, which is the factor of 1/sqrt(distance)
    # in the pressure near an end of a zone. With a cohesive law: largest allowed error of the gap
    # at the end of an interval of tension, divided by the largest gap at which the tension acts.
    edge_condition: float = 1e-7
    # Allowed round-off of the gap at the end of an interval of tension, divided by the round-off of
    # the gap elsewhere.
    reach_multiple: float = 4.0
    # Distance from an end of an interval of tension, relative to the width of the interval. Only at
    # places farther away than this, the certificate compares the gap with the largest gap at which
    # the tension acts.
    reach_distance: float = 1e-9
    # Safety factor in the bound of the gap that is computed on the contact zones, where the exact
    # gap is zero. The computed gap is caused by round-off and by the error of the density (the
    # unknown function of the integral equation).
    gap_margin: float = 100.0

    # Safety factor on an error estimate that neglects terms as large as the estimate itself, such
    # as the estimate for a truncated series.
    margin: float = 10.0
    # Relative round-off of the closed forms of full contact and of surfaces that do not touch.
    closed_form_rounding: float = 1e-13
    # Factor of the stated error if the pressure is infinite at an end of a zone. It is a typical
    # pressure next to such an end, divided by the mean pressure.
    singular_end: float = 8.0
    # No error of the pressure is stated closer to a gap than this fraction of the period.
    unresolved_distance: float = 1e-7
    # No error of the pressure is stated closer to a tip than this fraction of the half width of the
    # zone.
    tip_distance: float = 0.01
    # Largest width of a zone, divided by the length over which the kernel varies. At this width
    # there are 20,000 unknowns, and the solution takes more than 5 s.
    max_kernel_lengths: float = 3000.0

    # Bound of the pressure's relative error, divided by the relative error of the ends of intervals
    # of tension. Pressures are compared at equal normalised positions in a zone, and next to an end
    # the pressure's normalised slope is below this number.
    tension_factor: float = 16.0
    # Smallest angle [rad] from a zone's ends at which the slope of the zone's pressure is sampled.
    # The cosine of the angle is the normalised position.
    least_angle: float = 0.3

    @property
    def kernel_rounding(self) -> float:
        """Round-off of sums with the half-plane's kernel, relative to the largest term.

        These sums have a tenth as many terms as the sums that `rounding` describes.
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
    """Largest overlap (negative gap) that counts as round-off; all lengths in the same unit.

    A method of solution passes the sizes that exist for its gap. heights: largest term of a gap
    that is a sum of heights. noise: noise of these heights. series: largest term of a gap that is
    the integral of a series. on_zones: gap computed on the zones. reach: largest gap at which a
    tension acts between surfaces that do not touch.
    """
    return (
        TOLERANCES.height_rounding * heights
        + TOLERANCES.noise_multiple * noise
        + TOLERANCES.rounding * series
        + TOLERANCES.on_zones_multiple * on_zones
        + TOLERANCES.apart_rounding * reach
    )
