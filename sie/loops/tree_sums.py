"""Compiled loops of the fast sums over a tree (see `sie.trees.far`).

No matrix and no table is stored. The loops compute again the matrices that the array versions keep
between sums. This takes about as long as reading them from memory.
"""

import math
from typing import Any

import numpy as np
from numba import njit

# Number of nodes of a tree that are treated together, by vector operations of the processor. The
# rows of the nodes' matrices fit into the processor's fastest cache. With 16 nodes the loops take
# twice as long.
LANES = 64


@njit(cache=True, nogil=True, fastmath={"contract"}, error_model="numpy")
def far_fields(begin: int, end: int, pairs: Any, moments: Any, nodes: Any, fields: Any) -> None:
    """Add the fields of far tree nodes (sources) at the target nodes begin ... end - 1.

    pairs: (first pair of each target, targets, then for each pair: source, sign, gap, half width of
    the source, half width of the target, `rho` and `first` as in `Outside` for the target's middle
    relative to the source). The sign is 1 if the target lies to the right of the source, else -1.
    moments: moments of order k of the sources, doubled for k > 0; and these divided by k. fields:
    the transform at the Chebyshev `nodes` of the targets (targets, terms), and the potential at the
    middles of the targets.
    """
    first, target, source, sign, gap, half, width, centre, log = pairs
    doubled, divided = moments
    values, middle = fields
    terms = len(nodes)
    rho, front = np.empty(terms), np.empty(terms)
    for number in range(begin, end):
        place = target[number]
        potential = 0.0
        for p in range(first[number], first[number + 1]):
            s, side = source[p], sign[p]
            g, w, scale = gap[p] / half[p], width[p] / half[p], side / half[p]
            for i in range(terms):
                excess = g + w * (1.0 + side * nodes[i])
                root = math.sqrt(excess * (excess + 2.0))
                rho[i] = side / (1.0 + excess + root)
                front[i] = scale / root
            # Horner's rule is applied at four nodes at a time, so that all numbers stay in
            # registers.
            for i in range(0, terms, 4):
                r0, r1, r2, r3 = rho[i], rho[i + 1], rho[i + 2], rho[i + 3]
                v0 = v1 = v2 = v3 = 0.0
                for k in range(terms - 1, -1, -1):
                    c = doubled[s, k]
                    v0, v1, v2, v3 = v0 * r0 + c, v1 * r1 + c, v2 * r2 + c, v3 * r3 + c
                values[place, i] += v0 * front[i]
                values[place, i + 1] += v1 * front[i + 1]
                values[place, i + 2] += v2 * front[i + 2]
                values[place, i + 3] += v3 * front[i + 3]
            near = 0.0
            for k in range(terms - 1, 0, -1):
                near = (near + divided[s, k]) * centre[p]
            potential += doubled[s, 0] * log[p] - near
        middle[place] += potential


@njit(cache=True, nogil=True, fastmath={"contract"})
def _next_row(j: int, alpha: Any, beta: Any, rows: Any) -> None:
    """Compute row j of the matrices A with T_j(alpha + beta s) = sum_k A_jk T_k(s).
    The rows must be computed in ascending order.

    rows (3, terms + 3, LANES): three successive rows of one matrix for each of the LANES nodes. The
    coefficient of T_k is at index k + 1, and that of T_0 is doubled. The coefficient of T_1 is
    repeated at index 0. So one recurrence holds for all k.
    """
    new, row, before = rows[j % 3], rows[(j - 1) % 3], rows[(j - 2) % 3]
    if j == 1:
        new[1] = 2.0 * alpha
        new[2] = beta
    else:
        for k in range(1, j + 2):
            for b in range(LANES):
                new[k, b] = (
                    2.0 * alpha[b] * row[k, b]
                    + beta[b] * (row[k - 1, b] + row[k + 1, b])
                    - before[k, b]
                )
    new[0] = new[2]


@njit(cache=True, nogil=True, fastmath={"contract"})
def upward(structure: Any, alpha: Any, beta: Any, moments: Any) -> None:
    """Add the moments (nodes, terms) of every node of a tree to those of its parent.

    structure: (first node of every level, then the number of all nodes; parents). alpha, beta: see
    `Nested._place`.
    """
    levels, parent = structure
    terms = moments.shape[1]
    own, total, a, w = np.zeros((terms, LANES)), np.empty(LANES), np.zeros(LANES), np.zeros(LANES)
    for level in range(len(levels) - 2, 0, -1):
        for start in range(levels[level], levels[level + 1], LANES):
            here = min(LANES, levels[level + 1] - start)
            rows = np.zeros((3, terms + 3, LANES))
            rows[0, 1] = 2.0
            for b in range(here):
                a[b], w[b] = alpha[start + b], beta[start + b]
                for k in range(terms):
                    own[k, b] = moments[start + b, k]
                own[0, b] *= 0.5
            for j in range(terms):
                if j:
                    _next_row(j, a, w, rows)
                row = rows[j % 3]
                total[:] = 0.0
                for k in range(j + 1):
                    for b in range(LANES):
                        total[b] += row[k + 1, b] * own[k, b]
                for b in range(here):
                    moments[parent[start + b], j] += total[b]


@njit(cache=True, nogil=True, fastmath={"contract"})
def downward(structure: Any, alpha: Any, beta: Any, rises: Any, fields: Any) -> None:
    """Add the field series of every node of a tree to those of its children, level by level.

    structure, alpha, beta: see `upward`. rises: see `Nested.rises`. fields: series of the transform
    (nodes, terms), potential at the nodes' middles and its round-off.
    """
    levels, parent = structure
    series, middle, rest = fields
    terms = series.shape[1]
    above, total = np.zeros((terms, LANES)), np.empty((terms, LANES))
    a, w = np.zeros(LANES), np.zeros(LANES)
    for level in range(1, len(levels) - 1):
        for start in range(levels[level], levels[level + 1], LANES):
            here = min(LANES, levels[level + 1] - start)
            rows = np.zeros((3, terms + 3, LANES))
            rows[0, 1] = 2.0
            for b in range(here):
                a[b], w[b] = alpha[start + b], beta[start + b]
                rise = 0.0
                for k in range(terms):
                    above[k, b] = series[parent[start + b], k]
                    rise += rises[start + b, k] * above[k, b]
                # The round-off error of each sum is stored in `rest` (see
                # `sie.basis.data.sum_error`).
                before = middle[parent[start + b]]
                added = middle[start + b] + rise + rest[parent[start + b]]
                whole = before + added
                large = whole - before
                middle[start + b] = whole
                rest[start + b] = (before - (whole - large)) + (added - large)
            total[:] = 0.0
            for j in range(terms):
                if j:
                    _next_row(j, a, w, rows)
                row = rows[j % 3]
                for k in range(j + 1):
                    for b in range(LANES):
                        total[k, b] += row[k + 1, b] * above[j, b]
            for b in range(here):
                series[start + b, 0] += 0.5 * total[0, b]
                for k in range(1, terms):
                    series[start + b, k] += total[k, b]
