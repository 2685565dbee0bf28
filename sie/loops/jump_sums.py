"""Compiled sums of closed forms over the jumps of a zone (see `sie.jumps.formulas`)."""

import math
from typing import Any

from numba import njit


@njit(cache=True, nogil=True, fastmath={"contract"}, error_model="numpy")
def densities(begin: int, end: int, jumps: Any, lists: Any, points: Any, out: Any) -> None:
    """For the points begin ... end - 1, sum the densities of all jumps in each point's zone.

    jumps: (distance from the zone's left end, square root of this distance, square root of the
    distance from the right end, order, weight) of each jump. lists: (indices of the jumps, zone
    after zone; position of each zone's first jump in this list; number of each zone's jumps).
    points: (zone, distances from both ends of the zone).
    """
    at, root_left, root_right, order, weight = jumps
    members, first, count = lists
    zone, left, right = points
    for i in range(begin, end):
        z, from_left, from_right = zone[i], math.sqrt(left[i]), math.sqrt(right[i])
        total = 0.0
        for place in range(first[z], first[z] + count[z]):
            k = members[place]
            away, q = left[i] - at[k], order[k]
            if away == 0.0 and q > 0:
                continue
            # The function `kappa`; close to an end, 2 artanh(small / large) keeps all digits.
            up, vp = from_right * root_left[k], from_left * root_right[k]
            small, large = min(up, vp), max(up, vp)
            if small < 0.5 * large:
                shape = math.log1p(2.0 * small / (large - small))
            else:
                shape = math.log((up + vp) ** 2 / (2.0 * abs(away)))
            for _ in range(q):
                shape *= away
            total += weight[k] * shape
        out[i] = total
