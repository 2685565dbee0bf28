r"""The transform of a density, its derivative, and the potential at complex points.

    F(z) = (1/pi) int phi K(z - xi) dxi,      F'(z),
    W(z) = (1/pi) int phi Lambda(z - xi) dxi,   W' = F.

phi(xi) is the density, K the kernel and Lambda the potential of the kernel. F is analytic off the
zones. On the upper side of the zones, F is the transform on the line minus i phi (J. Plemelj,
Monatsh. Math. Phys. 19, 1908, 205-210). Everything is computed in the closed upper half plane. The
density is real, so that the lower half plane has the conjugate values.

The series on zones are summed by powers of rho (see `sie.basis.interval`). Let zeta be z relative
to a zone: -1 and 1 at its ends. The closed forms of a jump at s = cos(phi), with an angle phi (see
`sie.jumps`), contain A = 1 - rho e^(i phi) and B = 1 - rho e^(-i phi). With p = sqrt(zeta + 1) and
m = sqrt(zeta - 1),

    B = 2 e^(-i phi/2) (cos(phi/2) m + i sin(phi/2) p) / (p + m),     A B = 2 rho (zeta - s),
    sum (2/j) rho^j sin(j phi) = -i log(B / A),      log(1 - 2 rho cos(phi) + rho^2) = log(A B).

Many zones are summed by a tree (`sie.trees`): the field of a node at points with a small |rho|
follows from its first moments.
"""

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from sie.basis import chebyshev
from sie.basis.data import Array, Index
from sie.basis.interval import (
    Complex,
    InPlane,
    What,
    complex_of,
    of_t,
    transform_of,
    transform_slope_of,
)
from sie.basis.kernels import Regular
from sie.basis.sums import Grouped, pair_blocks
from sie.density.series import Series, by_quadrature
from sie.jumps.formulas import OPTIONS as JUMPS
from sie.jumps.right_side import ForcingJumps
from sie.jumps.spline import OPTIONS as SPLINES
from sie.trees.far import Nested
from sie.trees.plane import HilbertRest, fields_of_tree
from sie.trees.tree import TERMS, Tree


class Plane:
    """Transform of a density, the transform's derivative, and the potential, at complex z."""

    def __init__(self, density: Series) -> None:
        self.density = density
        zones = density.zones
        self.nested = Nested(Tree.over(zones.a, zones.b), kept=False)
        c = density.first(TERMS)
        twice = np.where(np.arange(TERMS), 2.0, 1.0)
        tree = self.nested.tree
        self.series = (
            self.nested.upward(c * zones.half[:, None] / twice) * twice / tree.half[:, None]
        )
        self.total = float(np.pi * (c[:, 0] @ zones.half))

    def __call__(self, z: Complex, what: What) -> Complex:
        """The density's transform, the transform's derivative, or the potential, at complex z.

        The points may lie in any period.
        """
        x, y = z.real, np.abs(z.imag)
        place = self.density.into_period(x)
        (out,) = self.poles(place, y, (what,))
        out = self._with_regular(out, complex_of(place, y), what)
        if what == "potential":
            turns = np.full(len(x), float(sum(shift > 0 for shift in self.density.kernel.poles)))
            if self.density.kernel.period is not None:
                turns += np.round((x - place) / self.density.kernel.period)
            out = out - 1j * self.total * turns
        return np.where(z.imag < 0, np.conj(out), out)

    def with_slope(self, z: Complex) -> tuple[Complex, Complex]:
        """The transform and its derivative at points z (n,), Im z >= 0, in any period."""
        place = complex_of(self.density.into_period(z.real), z.imag)
        value, slope = self.poles(place.real, place.imag, ("transform", "derivative"))
        return (
            self._with_regular(value, place, "transform"),
            self._with_regular(slope, place, "derivative"),
        )

    def _with_regular(self, out: Complex, z: Complex, what: What) -> Complex:
        regular = self.regular(z, what)
        return out if regular is None else np.asarray(out + regular)

    # The methods below give the part of the fields that the kernel's poles cause, without the
    # regular part.
    def poles(self, x: Array, y: Array, whats: Sequence[What]) -> list[Complex]:
        """Fields (transforms or potentials) at x + i y that the kernel's poles cause.
        A tree computes the sum over the zones (`sie.trees`).
        """
        return fields_of_tree(
            self.nested.tree, self.series, self.density.kernel, (x, y), whats, self.of_zones
        )

    def of_zones(self, x: Array, y: Array, zone: Index, whats: Sequence[What]) -> list[Complex]:
        """Fields (transforms or potentials) of one zone at each point x + i y.
        zone: for each point, the index of this zone.
        """
        density = self.density
        zones, w = density.zones, density.zones.half[zone]
        seen = InPlane.of(zones.beyond_a(x, zone) / w, -zones.before_b(x, zone) / w, y / w)
        values = []
        for what in whats:
            if what == "potential":
                value = of_t(density.coefficients, seen, w, density.kernel.datum, zone, what)
            else:
                bounded = density.bounded
                value = (
                    transform_slope_of(*bounded, seen, zone) / w
                    if what == "derivative"
                    else transform_of(*bounded, seen, zone)
                )
            values.append(np.array(value, dtype=complex))
        if len(density.jumps):
            for i, here in Grouped.by(zone).places().items():
                if i in density.jumps.by_zone:
                    some = seen[here]
                    for value, what in zip(values, whats, strict=True):
                        value[here] += self._jumps(i, some, what)
        return values

    def _jumps(self, zone: int, seen: InPlane, what: What) -> Complex:
        """Field of the density that jumps of the right side in one zone cause, at given points."""
        w, datum, jumps = (
            float(self.density.zones.half[zone]),
            self.density.kernel.datum,
            self.density.jumps,
        )
        out = np.empty(seen.left.shape, dtype=complex)
        far = np.abs(seen.rho) < JUMPS.far_rho[0]
        out[far] = of_t(
            self._of_jumps[[zone]],
            seen[far],
            np.full(int(far.sum()), w),
            datum,
            np.zeros(int(far.sum()), np.intp),
            what,
        )
        near = np.flatnonzero(~far)
        k = jumps.by_zone[zone]
        for here in pair_blocks(len(near), max(1, len(k), 2 * len(jumps.poles.of_zone(zone)))):
            some = seen[near[here]]
            value = of_jumps(jumps, k, some, what) + jumps.near.in_plane(
                jumps.near.of_zone(zone), some, what
            )
            value = value + jumps.poles.in_plane(jumps.poles.of_zone(zone), some, what)
            spline = jumps.splines.get(zone)
            if spline is not None and what == "potential":
                c, row = (
                    spline.t_coefficients(
                        min(SPLINES.coefficients_per_knot * len(spline.knots), 1 << 15)
                    )[None],
                    np.zeros(len(value), dtype=np.intp),
                )
                value = value + of_t(c, some, np.ones(len(row)), 1.0, row, what)
            elif spline is not None:
                value = value + spline.in_plane(some, what)
            out[near[here]] = value
        if what == "potential":
            # The series for far points already contains the logarithm of the half width w. The
            # closed forms for near points lack this logarithm, so it is added here.
            out[near] = w * (out[near] + self._of_jumps[zone, 0] * np.log(w / datum))
        elif what == "derivative":
            out[near] /= w
        return out

    @cached_property
    def _of_jumps(self) -> Array:
        """First coefficients, in T_l / sqrt(1 - t^2), of the density that each zone's jumps cause.

        They give the field of this density at points far from the zone.
        """
        return self.density.jumps.t_coefficients(self.density.zones, int(JUMPS.far_terms[0]))

    # The methods below give the part of the fields that the kernel's regular part causes.
    def regular(self, z: Complex, what: What) -> Complex | None:
        """Field at z that the kernel's regular part causes; None if there is no such part."""
        kernel = self.density.kernel
        regular = kernel.regular_of(what)
        if regular is None:
            return None
        if kernel.sure:
            return self._rest(z, what)
        _check_analytic(regular, z, self.density.zones.middle)
        return by_quadrature(self.density.quadrature, z, regular)

    @cached_property
    def _rest(self) -> HilbertRest:
        tree = self.nested.tree
        middle = 0.5 * float(tree.lo[0] + tree.hi[0])
        return HilbertRest(self.density.kernel, middle, self._central_nodes)

    @cached_property
    def _central_nodes(self) -> list[tuple[Array, Array]]:
        """Nodes on the interval that spans all zones, and weights that replace the density there.

        The weights have the same first moments as the density. This is enough if the kernel's
        regular part is smooth over a period.
        """
        tree, half = self.nested.tree, self.nested.tree.half[0]
        xi = 0.5 * (tree.lo[0] + tree.hi[0]) + half * chebyshev.gauss(TERMS)
        return [(xi, chebyshev.t_matrix(TERMS, TERMS) @ self.series[0] * (half / TERMS))]


def _check_analytic(regular: Regular, z: Complex, places: Array) -> None:
    """Raise ValueError if a user's regular part is not analytic.

    At most three of the points z are tested. The regular part counts as analytic at a point if its
    difference quotients along the real and the imaginary direction agree.
    """
    for at in z[:: max(1, len(z) // 3)][:3]:
        xi, h = places[:1], 1e-4 * (1 + abs(at))
        points = at + h * np.array([1, -1, 1j, -1j])
        f = np.asarray(regular(points[:, None], xi)).ravel()  # type: ignore[arg-type]
        along, across = (f[0] - f[1]) / (2 * h), (f[2] - f[3]) / (2j * h)
        if abs(along - across) > 1e-4 * (abs(along) + abs(across)) + 1e-10 * np.abs(f).max() / h:
            raise ValueError(
                "at complex points the kernel's regular part must be the analytic continuation of "
                "its values at real points"
            )


# The function below sums the closed-form fields of jumps of the right side.
def of_jumps(jumps: ForcingJumps, k: Index, seen: InPlane, what: What) -> Complex:
    """Field of the density that jumps of the right side in a zone cause, close to the zone.

    k: indices of the jumps. The derivative is multiplied by the half width w. The potential is
    divided by w and lacks the term c_0 log(w), where c_0 is the coefficient of T_0 / sqrt(1 - t^2)
    in this density.
    """
    if len(k) == 0:
        return np.zeros(seen.left.shape, dtype=complex)
    away, q = seen.left[:, None] - jumps.left[k], jumps.order[k]
    log = jumps.logarithm(k, seen, away)
    if what == "potential":
        # At the jump itself the logarithm is infinite, but the power of the distance that
        # multiplies it is zero.
        return jumps.plane_potential(k, seen, away, np.where((away == 0) & (q >= 0), 0.0, log))
    with np.errstate(invalid="ignore", divide="ignore"):
        if what == "transform":
            value = np.where((away == 0) & (q > 0), 0.0, away**q * log) - jumps.polynomial(
                k, seen.zeta[:, None]
            )
        else:
            value = away**q * jumps.logarithm_slope(k, seen, away) - jumps.line[1][k]
            value = value + np.where(q > 0, q * away ** np.maximum(q - 1, 0) * log, 0.0)
    return np.asarray(value @ (jumps.height[k] / np.pi))
