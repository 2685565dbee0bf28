"""Compiled sums of the fields of near zones on each zone (see `sie.fast.zone_sums`)."""

import math
from typing import Any

import numpy as np
from numba import njit


@njit(cache=True, nogil=True, fastmath={"contract"}, error_model="numpy")
def near_fields(begin: int, end: int, pairs: Any, series: Any, nodes: Any, fields: Any) -> None:
    """Set the fields of near zones on the target zones begin ... end - 1.

    pairs: (first pair of each target, then for each pair: first coefficient of the source, number
    of terms, sign, gap, half width of the source, half width of the target). The sign is 1 if the
    target lies to the right of the source, else -1. series: coefficients of the densities on all
    zones. nodes: (first node of each target; distances of the nodes from the left and from the
    right end of the target, divided by its half width). fields: the transform at the nodes.
    """
    first, start, terms, sign, gap, half, width = pairs
    first_node, from_left, from_right = nodes
    # Horner's rule is applied at four nodes at a time, so that the processor need not wait for
    # each product.
    rho, front, value = np.empty(4), np.empty(4), np.empty(4)
    for target in range(begin, end):
        lo, hi = first_node[target], first_node[target + 1]
        fields[lo:hi] = 0.0
        for p in range(first[target], first[target + 1]):
            away = from_left if sign[p] > 0.0 else from_right
            g, w, side = gap[p] / half[p], width[p] / half[p], sign[p]
            for i in range(lo, hi, 4):
                here = min(4, hi - i)
                for b in range(4):
                    excess = g + w * away[i + min(b, here - 1)]
                    root = math.sqrt(excess * (excess + 2.0))
                    rho[b] = side / (1.0 + excess + root)
                    front[b] = side / root
                r0, r1, r2, r3 = rho[0], rho[1], rho[2], rho[3]
                v0 = v1 = v2 = v3 = 0.0
                for k in range(start[p] + terms[p] - 1, start[p] - 1, -1):
                    c = series[k]
                    v0, v1, v2, v3 = v0 * r0 + c, v1 * r1 + c, v2 * r2 + c, v3 * r3 + c
                value[0], value[1], value[2], value[3] = v0, v1, v2, v3
                for b in range(here):
                    fields[i + b] += value[b] * front[b]
