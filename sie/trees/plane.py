"""Fields at points of the plane, summed over the nodes of a tree of intervals."""

from collections.abc import Callable

import numpy as np

from sie.basis.data import Array, Index
from sie.basis.interval import Complex, InPlane, What, decay_rate, of_t
from sie.basis.kernels import Kernel
from sie.basis.sums import OPTIONS as BLOCKS
from sie.trees.tree import SEPARATION, Tree

# Limit of |rho| for far points. Here rho = zeta - sqrt(zeta^2 - 1), and zeta is the point's
# position from the middle of a tree node, in half widths. Below this limit, the node's field
# follows from its first TERMS moments.
_FAR = float(np.exp(-decay_rate(SEPARATION)))

# The field of one interval at each point x + iy, for pairs of a point and an interval.
OfLeaves = Callable[[Array, Array, Index, What], Complex]


def field_of_tree(
    tree: Tree,
    series: Array,
    kernel: Kernel,
    points: tuple[Array, Array],
    what: What,
    leaf: OfLeaves,
) -> Complex:
    """Field at the points x + iy that the kernel's poles cause.

    For each point, nodes are split from the root down until they are far or are a single interval.

    series: first moments of each node, coefficients of T_l / sqrt(1 - t^2). leaf: the field of one
    interval that is near.
    """
    x, y = points
    out = np.zeros(len(x), dtype=complex)
    for shift in kernel.poles:
        block = max(1, BLOCKS.memory_pairs // len(tree))
        for start in range(0, len(x), block):
            point = np.arange(start, min(start + block, len(x)))
            node = np.zeros(len(point), dtype=np.intp)
            while len(point):
                at, w = x[point] - shift, tree.half[node]
                seen = InPlane.of((at - tree.lo[node]) / w, (at - tree.hi[node]) / w, y[point] / w)
                far = np.abs(seen.rho) < _FAR
                value = of_t(series, seen[far], w[far], kernel.datum, node[far], what)
                np.add.at(out, point[far], value)
                near = ~far & (tree.item[node] >= 0)
                if near.any():
                    i = point[near]
                    np.add.at(out, i, leaf(x[i] - shift, y[i], tree.item[node[near]], what))
                split = ~far & ~near
                point = np.repeat(point[split], 2)
                node = np.column_stack((tree.left[node[split]], tree.right[node[split]])).ravel()
    return out
