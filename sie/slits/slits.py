"""Narrow gaps between zones as slits of wide zones.

Consider two zones with a gap g between them. The series of either zone's density has a singularity
at the near end of the other zone. So it needs n ~ sqrt(width / g) modes. A wide zone therefore
spans both zones and the gap, which becomes a *slit* of the wide zone. Without the share of the
slit, the density on the wide zone is as smooth as the right side.

On a wide zone with slits the equation is T[phi] = g - s, where T is the transform. The slack s is
an unknown function. It vanishes off the slits, and its integral over each slit is zero. The density
is phi = c + P[s]: c is smooth, and P[s] is the density that the slack causes. With X = sqrt(1 -
t^2), sigma = s X and z the slit's own coordinate from -1 to 1,

    X P[s] = (1/pi) PV int sigma / (t - tau) dtau,          T[P[s]] = -s on the zone.

On each slit let sigma be sum d_l T_l(z) / sqrt(1 - z^2). The condition phi = 0 on the slits is then
a singular integral equation of the same kind for sigma:

    sum d_l U_(l-1)(z) = sum c_k T_k(t) + X (jumps) + (field of the zone's other slits),
    int sigma / X = 0.

The field of P[s] on other zones depends only on the coefficients s_k = (2/pi) int s sin(k phi)
dtau. This follows from sum sin(k phi) cos(k theta) = sin(phi) / 2 (cos(theta) - cos(phi)), see
docs/theory.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from sie.basis import chebyshev
from sie.basis.data import DIGITS, TINY, Array, Index, Kept, Mask, record, sum_error, wrapped
from sie.basis.interval import Outside, decay_rate, root_weight, theta, transform_of
from sie.basis.weight import needs_half
from sie.basis.zones import Zones
from sie.dense.lu import Factored
from sie.dense.modes import OPTIONS as MODES
from sie.dense.modes import gaps
from sie.equation.conditions import BUILT_IN, Condition, ZoneTotals
from sie.equation.equation import Equation
from sie.jumps.formulas import HIGHEST
from sie.jumps.right_side import ForcingJumps
from sie.slits.kinks import SlitKink


@dataclass(frozen=True)
class SlitOptions:
    """Widths below which gaps become slits, and limits for the unknown functions in slits.
    A slit is a narrow gap that is treated as part of a wide zone.
    """

    # Gaps narrower than this fraction of the wider adjacent zone may be treated as slits.
    max_gap: float = 0.02
    # An existing slit remains a slit up to `max_gap` times this factor. A gap that is not a slit
    # becomes a slit below `max_gap` divided by this factor. Without this hysteresis, slits come and
    # go in every Newton step.
    hysteresis: float = 1.5
    # Largest width of a slit that contains a jump of the second derivative of the right side, or a
    # point s of a term |x - s|^p in the right side. The width is divided by the width of the
    # narrower adjacent zone. This limit is stricter than `max_gap`, because a spline may have
    # hundreds of such jumps.
    max_gap_with_jumps: float = 0.003
    # Largest number of Chebyshev modes of the unknown function in one slit.
    max_modes: int = 512
    # The unknown function in a slit gets at least this many coefficients when its field on other
    # wide zones is computed.
    min_slack_modes: int = 48
    # Largest accepted change of the solution in the last step of the iteration between wide zones
    # and slits, relative to the solution's largest coefficient. A smaller change is added to the
    # stated error. A larger change raises `SlitsNotConverged`.
    max_change: float = 1e-10


OPTIONS = SlitOptions()


@record
class SlitGeometry(Kept):
    """Zones with narrow gaps, and the wide zones that each join several zones and their gaps.

    pieces: the zones as given, which are pieces of the wide zones. wide: zones that span narrow
    gaps; slits: these gaps; slit_zone: index of the wide zone of each slit. piece_zone: index of
    the wide zone of each piece; shift: length, zero or one period, that moves a piece into its wide
    zone; cut_off: round-off of the shifted ends of the pieces (2, n).
    """

    pieces: Zones
    wide: Zones
    slits: Zones
    slit_zone: Index
    piece_zone: Index
    shift: Array
    cut_off: Array

    @cached_property
    def start(self) -> Array:
        """Distance of each zone's left end from the left end of the wide zone that contains it.
        A wide zone joins several zones and the narrow gaps (slits) between them.
        """
        return self.wide.beyond_a(self.pieces.a + self.shift, self.piece_zone) + self.cut_off[0]

    @cached_property
    def stop(self) -> Array:
        """Distance of each zone's right end from the left end of the wide zone that contains it.
        A wide zone joins several zones and the narrow gaps (slits) between them.
        """
        return self.wide.beyond_a(self.pieces.b + self.shift, self.piece_zone) + self.cut_off[1]

    @cached_property
    def rest(self) -> Array:
        """Distance of each zone's right end from the right end of the wide zone that contains it.
        A wide zone joins several zones and the narrow gaps (slits) between them.
        """
        return self.wide.before_b(self.pieces.b + self.shift, self.piece_zone) - self.cut_off[1]

    @cached_property
    def slit_before(self) -> Index:
        """For each zone of the problem, the index of the slit on its left; -1 if there is none."""
        return self._slit_at(self.slits.b, self.pieces.a + self.shift)

    @cached_property
    def slit_after(self) -> Index:
        """For each zone of the problem, the index of the slit on its right; -1 if there is none."""
        return self._slit_at(self.slits.a, self.pieces.b + self.shift)

    @cached_property
    def next_to_slit(self) -> Mask:
        """Whether each zone of the problem has a slit (a narrow gap in a wide zone) next to it."""
        return (self.slit_before >= 0) | (self.slit_after >= 0)

    def _slit_at(self, ends: Array, at: Array) -> Index:
        """For each place `at`, the index of the slit that has an end exactly there, or -1."""
        place = np.minimum(np.searchsorted(ends, at), len(ends) - 1)
        return np.where(ends[place] == at, place, -1)


def merge(equation: Equation, pieces: Zones, before: Mask | None = None) -> SlitGeometry | None:
    """The zones with narrow gaps treated as slits of wide zones; None if no gap can be a slit.
    A wide zone joins several zones and the gaps between them.

    No gap can be a slit if no gap is narrow, or if the equation does not allow slits. before: mask
    of the zones whose gap on the right was a slit in a previous solution on similar zones. For such
    a gap the limit of the width is larger (hysteresis).
    """
    if len(pieces) < 2 or not _allows_slits(equation, pieces):
        return None
    after = gaps(pieces, equation.kernel)[1]
    narrow = _narrow(equation, pieces, after, before)
    if not narrow.any():
        return None
    needs_half(pieces.weight, "narrow gaps as slits")
    count = len(pieces)
    first = 0
    if narrow[-1]:
        # The period is cut at the widest gap that is not a slit. If all gaps are narrow, it is cut
        # at the first gap, which then is no slit.
        first = (int(np.argmax(np.where(narrow, -np.inf, after))) + 1) % count
        if narrow.all():
            narrow[first - 1] = False
    order = (first + np.arange(count)) % count
    shift = np.where(np.arange(count) < first, equation.kernel.period or 0.0, 0.0)
    return _joined(pieces, order, shift, narrow[order[:-1]])


def _allows_slits(equation: Equation, pieces: Zones) -> bool:
    """Whether the equation has a solution on wide zones, with narrow gaps as slits."""
    # The right side, or a column (a term of unknown amplitude), may be singular between zones. Then
    # no gap becomes a slit, because the wide zone around it would contain the singular point.
    singular = len(equation.forcing.jumps.singular_at) > 0 or any(
        column.resolution.modes is None and not column.resolution.smooth_between
        for column in equation.columns
    )
    return (
        not singular
        and not pieces.have_values
        and _one_level(equation.conditions)
        and _zero_intensities(pieces)
    )


def _narrow(equation: Equation, pieces: Zones, after: Array, before: Mask | None) -> Mask:
    """Mask of the zones whose gap on the right, of the width `after`, becomes a slit.

    before: as for `merge`.
    """
    width = pieces.b - pieces.a
    following = np.roll(width, -1)
    # A narrow gap becomes a slit only where this needs fewer modes. A slit needs more modes the
    # wider it is relative to the adjacent zones. Without slits, a zone needs more modes the wider
    # it is relative to the gap next to it.
    most = OPTIONS.max_gap * (
        1.0
        if before is None or len(before) != len(pieces)
        else np.where(before, OPTIONS.hysteresis, 1 / OPTIONS.hysteresis)
    )
    narrow = (after < most * np.maximum(width, following)) & (after**2 < width * following)
    narrow &= pieces.moves[1] & np.roll(pieces.moves[0], -1)
    if equation.kernel.period is None or pieces.symmetric:
        narrow[-1] = False
    return narrow & (
        ~_jumps_inside(equation, pieces, after)
        | (after < OPTIONS.max_gap_with_jumps * np.minimum(width, following))
    )


def _joined(pieces: Zones, order: Index, shift: Array, joined: Mask) -> SlitGeometry:
    """The wide zones and slits of zones that are joined across narrow gaps.

    order: indices of the zones from left to right, once they are moved by `shift`; joined: mask of
    the zones in this order, without the last one, that are joined to the next zone.
    """
    a, b, count = (pieces.a + shift)[order], (pieces.b + shift)[order], len(pieces)
    starts = np.concatenate(([0], np.flatnonzero(~joined) + 1))
    stops = np.concatenate((starts[1:], [count])) - 1
    zone = np.empty(count, dtype=np.intp)
    zone[order] = np.repeat(np.arange(len(starts)), stops - starts + 1)
    left = [pieces.left[order[s]] for s in starts]
    right = [pieces.right[order[s]] for s in stops]
    cut_off = pieces.rest + np.array([sum_error(ends, shift) for ends in (pieces.a, pieces.b)])
    rest = np.array([cut_off[0][order[starts]], cut_off[1][order[stops]]])
    wide = Zones(a[starts], b[stops], left, right, pieces.symmetric, rest)
    at = np.flatnonzero(joined)
    slits = replace(
        Zones.of(np.column_stack((b[at], a[at + 1]))),
        rest=np.array([cut_off[1][order[at]], cut_off[0][order[at + 1]]]),
    )
    return SlitGeometry(pieces, wide, slits, zone[order[at]], zone, shift, cut_off)


def _one_level(conditions: Sequence[Condition]) -> bool:
    """Whether all zones share one potential constant, and no condition is about a single zone.

    Only with one common level does the slack integrate to zero over each slit. A user's own
    condition may be about single zones, and there are fewer wide zones than given ones.
    """
    rows = [type(condition).rows for condition in conditions]
    one_by_one = ZoneTotals.rows in rows or any(one not in BUILT_IN for one in rows)
    return not one_by_one and any(condition.levels for condition in conditions)


def _zero_intensities(pieces: Zones) -> bool:
    """Whether each end of `pieces` either has no prescribed intensity K, or is free with K = 0.
    K is the coefficient of 1 / sqrt(distance).
    """
    return all(
        end.intensity is None or (end.moves and end.intensity == 0.0)
        for end in (*pieces.left, *pieces.right)
    )


def _jumps_inside(equation: Equation, pieces: Zones, after: Array) -> Mask:
    """Whether each gap contains a jump of g'' or a point s of a term |x - s|^p; g: right side."""
    jumps = equation.forcing.jumps
    at = jumps.at[np.asarray(jumps.orders) > 1] if not jumps.of_density else np.zeros(0)
    if jumps.algebraic is not None:
        at = np.concatenate((at, np.asarray(jumps.algebraic.at)))
    at = wrapped(at, pieces.a[0], equation.kernel.period)
    i = np.searchsorted(pieces.a, at, side="right") - 1
    within = (i >= 0) & (at >= pieces.b[i]) & (at <= pieces.b[i] + after[i])
    found = np.zeros(len(pieces), dtype=bool)
    found[i[within]] = True
    return found


@record
class Slit(Kept):
    """One slit, that is, a narrow gap between zones that are joined to one wide zone.

    start, rest: distances of its left end from the zone's left end, and of its right end from the
    zone's right end; half: half width of the slit. All three are divided by the zone's half width.
    width: half width of the slit in units of length; modes: highest order of its series.
    """

    start: float
    rest: float
    half: float
    width: float
    modes: int

    def angle(self, left: Array, right: Array) -> Array:
        """Angle theta of places in the slit; t = cos(theta) is the wide zone's coordinate.

        left, right: distances from the slit's ends, in half widths of the slit.
        """
        from_left, from_right = self.start + self.half * left, self.rest + self.half * right
        return theta(from_left, from_right)

    def root(self, left: Array, right: Array) -> Array:
        """sqrt(1 - t^2) at places in the slit, with the coordinate t of the wide zone.

        left, right: distances from the slit's ends, in half widths of the slit.
        """
        return root_weight(self.start + self.half * left, self.rest + self.half * right)

    @cached_property
    def nodes(self) -> int:
        """Number of Gauss nodes for means of functions over the slit."""
        return 2 * self.modes + 16

    @cached_property
    def theta(self) -> Array:
        """Angles theta of the slit's Gauss nodes x.
        t = cos(theta) is the coordinate of x on the wide zone, which contains the slit.
        """
        return self.angle(*chebyshev.gauss_sides(self.nodes))

    @cached_property
    def x_root(self) -> Array:
        """sqrt(1 - t^2) at the slit's Gauss nodes, with the coordinate t of the wide zone."""
        return self.root(*chebyshev.gauss_sides(self.nodes))

    def means(self, values: Array) -> Array:
        """Means over the slit of a function times T_l(z), l = 0 ... `modes`.
        values: values of the function at the slit's Gauss nodes, along the last axis. The means
        have the weight 1 / sqrt(1 - z^2), with the slit's coordinate z.
        """
        return chebyshev.t_means(values, self.modes + 1)

    def at_gauss(self, d: Array) -> Array:
        """Values of the series sum d_l T_l at the slit's Gauss nodes."""
        return np.asarray(chebyshev.t_matrix(self.nodes, len(d)) @ d)

    def over(self, d: Array, power: int) -> Array:
        """Chebyshev series, in the slit's coordinate, of the function (sum d_l T_l) / X^power.
        X = sqrt(1 - t^2), with the coordinate t of the wide zone.
        """
        values = self.at_gauss(d) / self.x_root**power
        out = 2 * chebyshev.t_means(values)
        out[0] *= 0.5
        return np.asarray(out)

    @cached_property
    def mean_row(self) -> Array:
        """Row vector r for which r @ d is the mean of the slit's opening over the wide zone.
        The opening is the integral of the slack s, the unknown function in the slit. d: series of
        s sqrt(1 - t^2) on the slit. The mean has the weight 1 / sqrt(1 - t^2).
        """
        middle = self.angle(np.ones(1), np.ones(1))
        return self.width * self.means((self.theta - middle) / self.x_root)

    def slack_matrix(self, count: int) -> Array:
        """Matrix from a slit's series d to the sine coefficients s_k of the slack on the wide zone.
        The slack is the unknown function in the slit, and k = 0 ... `count`.
        """
        k = np.arange(count + 1)[:, None]
        return 2 * self.half * self.means(np.sin(k * self.theta) / self.x_root)


def outside_slit(excess: Array, sign: Array | float, d: Array) -> Array:
    """Transform (1/pi) int sigma(tau) / (t - tau) dtau, off a slit, of sigma on the slit.

    d: Chebyshev series of sigma. excess: |z| - 1 at the points, the distance from the slit in its
    half widths; sign: 1 right of the slit, -1 left of it.
    """
    return transform_of(
        *chebyshev.bounded_part(d[None]),
        Outside(sign, excess),
        np.zeros(len(excess), dtype=np.intp),
    )


def _within(
    jumps: ForcingJumps, zone: int, start: Array, length: Array
) -> tuple[Index, ForcingJumps]:
    """The jumps, of the right side or the density, that lie in the slits of a wide zone.

    Returns (indices in `jumps` of single jumps, jumps at knots of the wide zone's spline).

    start, length: distance of each slit from the zone's left end and width of the slit, both
    divided by the zone's half width.
    """

    def inside(left: Array) -> Mask:
        slit = np.maximum(np.searchsorted(start, left, side="right") - 1, 0)
        return np.asarray((left >= start[slit]) & (left <= start[slit] + length[slit]))

    closed = jumps.by_zone.get(zone, np.zeros(0, dtype=np.intp))
    closed = closed[inside(jumps.left[closed])]
    spline = jumps.splines.get(zone)
    if spline is None:
        return closed, ForcingJumps.none()
    some = np.flatnonzero(inside(spline.knots))
    left = spline.knots[some]
    count = len(some)
    return closed, ForcingJumps(
        np.full(count, zone), left, 2 - left, spline.jumps[some], np.full(count, HIGHEST)
    )


class Slits(Kept):
    """The slits of one wide zone (several zones joined across narrow gaps), and their equations."""

    def __init__(self, geometry: SlitGeometry, zone: int, modes: int, jumps: ForcingJumps) -> None:
        self.zone = zone
        self.which = np.flatnonzero(geometry.slit_zone == zone)
        a, b = geometry.slits.a[self.which], geometry.slits.b[self.which]
        w = self.w = float(geometry.wide.half[zone])
        # `start` and `stop` are the distances of the slits' left and right ends from the left end
        # of the zone. `rest` is the distance of the slits' right ends from the zone's right end.
        every, (cut_a, cut_b) = np.full(len(a), zone), geometry.slits.rest[:, self.which]
        self.start, self.stop = (
            geometry.wide.beyond_a(a, every) + cut_a,
            geometry.wide.beyond_a(b, every) + cut_b,
        )
        self.rest = geometry.wide.before_b(b, every) - cut_b
        start, rest, half = self.start / w, self.rest / w, geometry.slits.half[self.which]
        self._inside, self._knots = _within(jumps, zone, start, 2 * half / w)
        self.kinks: list[tuple[int, SlitKink]] = []
        for within in (jumps.chosen(self._inside), self._knots):
            for k, i in enumerate((np.searchsorted(start, within.left, side="right") - 1).tolist()):
                slit = (float(start[i]), float(rest[i]), float(half[i]) / w)
                place = (float(within.left[k]), float(within.right[k]), int(within.order[k]))
                self.kinks.append((i, SlitKink(float(within.height[k]), *slit, *place)))
        # The unknown function of a slit has two singular points outside the slit. They are the far
        # ends of the zones next to it on the left and on the right. `before` and `after` are the
        # distances of the slit from these two points.
        gaps_between = a[1:] - b[:-1]
        before = np.concatenate(([self.start[0]], gaps_between))
        after = np.concatenate((gaps_between, [self.rest[-1]]))
        middle = theta(start + half / w, rest + half / w)
        waves = modes * half / w / np.sin(middle)
        nearest = np.minimum(before, after) / half
        need = self._modes_needed(jumps, start + half / w, half / w, nearest, 2 * waves)
        size = np.clip(np.ceil(need), MODES.first_nodes, OPTIONS.max_modes).astype(int)
        self.slits = [
            Slit(float(s), float(r), float(h) / w, float(h), int(n))
            for s, r, h, n in zip(start, rest, half, size, strict=True)
        ]
        self.a, self.b = a, b
        self.offset = np.concatenate(([0], np.cumsum([slit.modes + 1 for slit in self.slits])))
        self.modes = modes
        nodes = (chebyshev.lobatto(slit.modes) for slit in self.slits)
        self._angles = [(left[1:-1], right[1:-1]) for _, right, left in nodes]

    def _modes_needed(
        self, jumps: ForcingJumps, middle: Array, half: Array, nearest: Array, waves: Array
    ) -> Array:
        """Number of modes that each slit's unknown function needs.
        Chebyshev coefficients of this function beyond the number are below round-off.

        The number follows from the nearest singularities: far ends of the adjacent given zones, and
        jumps outside the slits. middle, half: middles and half widths of the slits, divided by the
        zone's half width; nearest: distance to the nearest far end, divided by the slit's half
        width; waves: modes needed for the zone's own series over the slit.
        """
        sharp = np.setdiff1d(
            np.flatnonzero((jumps.zone == self.zone) & (jumps.order == 0)), self._inside
        )
        if len(sharp):
            away = np.abs(jumps.left[sharp][:, None] - middle) / half - 1
            nearest = np.minimum(nearest, away.min(axis=0))
        need = DIGITS / decay_rate(np.maximum(nearest, TINY)) + waves
        if self.zone not in jumps.by_zone:
            return np.asarray(need)
        # A jump outside the slit is a weak singularity. The coefficients that it causes decay
        # slowly but are small, so that half of the largest number of modes is enough.
        place = jumps.places(self.zone)[0]
        place = place[~np.isin(place, np.append(jumps.left[self._inside], self._knots.left))]
        away = np.maximum(np.abs(place[:, None] - middle) / half - 1, TINY)
        most = OPTIONS.max_modes / 2
        of_jumps = np.minimum(DIGITS / decay_rate(away), most).max(axis=0, initial=0.0)
        return np.maximum(need, of_jumps)

    @cached_property
    def by_coefficients(self) -> Array:
        """Matrix from coefficients c_k of the smooth density to right sides of equations in slits.
        The smooth density is the density on the wide zone without the part that the slits cause.
        """
        return self._rows(
            lambda slit, left, right: np.cos(
                slit.angle(left, right)[:, None] * np.arange(self.modes + 1)
            )
        )

    def of_jumps(self, jumps: ForcingJumps) -> Array:
        """The part of the right sides of the slits' equations that jumps on the wide zone cause.

        A jump in a slit is included together with its slack psi, see `sie.slits.kinks`.
        """
        if self.zone not in jumps.by_zone:
            return np.zeros(self.offset[-1])
        # `rest`: the jumps on this wide zone outside its slits. Jumps in other zones contribute
        # nothing, and jumps in slits are added as `kinks`.
        rest = jumps.chosen(
            np.setdiff1d(np.flatnonzero(jumps.zone == self.zone), self._inside, assume_unique=True)
        )

        def values(slit: Slit, left: Array, right: Array) -> Array:
            from_left, from_right = slit.start + slit.half * left, slit.rest + slit.half * right
            density = rest.density(self.zone, from_left, from_right)
            if len(self._knots):
                density -= self._knots.density(self.zone, from_left, from_right)
            out = slit.root(left, right) * density
            for _, kink in self.kinks:
                z = (
                    0.5 * (left - right)
                    if slit.start == kink.start
                    else (from_left - kink.start) / kink.half - 1
                )
                out += kink.in_slit(from_left, from_right, z)
            return out[:, None]

        out = self._rows(values)[:, 0]
        for i, kink in self.kinks:
            # The unknown function in a slit has the integral zero over the slit. A part psi of it,
            # which the jump of `kink` causes, is known. So the integral of psi goes to the right
            # side.
            out[self.offset[i]] -= kink.total
        return out

    def _rows(self, values) -> Array:  # type: ignore[no-untyped-def]
        """For each slit, a row of zeros, then rows with coefficients of the functions `values`.
        These are the coefficients in the Chebyshev polynomials U_(l-1), l = 1, 2, ...
        The row of zeros belongs to the condition on the integral of the slit's slack.
        """
        blocks = []
        for slit, (left, right) in zip(self.slits, self._angles, strict=True):
            rows = chebyshev.project_rows(values(slit, left, right))
            blocks.append(np.concatenate((np.zeros((1, rows.shape[1])), rows)))
        return np.concatenate(blocks)

    @cached_property
    def solve(self) -> Factored:
        """LU factors of the matrix of the equations for the unknown functions in all slits.

        Applied to right sides of these equations, they give the series coefficients d of all slits.
        """
        matrix = np.zeros((self.offset[-1], self.offset[-1]))
        for i, slit in enumerate(self.slits):
            rows = slice(self.offset[i] + 1, self.offset[i + 1])
            left, right = self._angles[i]
            for j, other in enumerate(self.slits):
                columns = slice(self.offset[j], self.offset[j + 1])
                if i == j:
                    # The slit's first row gives the integral of the slit's unknown function over
                    # the slit. The other rows give the coefficients d_l of U_(l-1).
                    matrix[self.offset[i], columns] = slit.means(1 / slit.x_root)
                    matrix[rows, columns] = np.eye(slit.modes, slit.modes + 1, 1)
                    continue
                if j < i:
                    away, sign = self.start[i] - self.stop[j] + slit.width * left, 1.0
                else:
                    away, sign = self.start[j] - self.stop[i] + slit.width * right, -1.0
                matrix[rows, columns] = -chebyshev.project_rows(
                    Outside(sign, away / other.width).transforms(other.modes + 1)
                )
        return Factored.of(matrix)

    @cached_property
    def slack_matrix(self) -> Array:
        """Matrix from the series d of all slits to sine coefficients s_k of the slack.
        The slack is the unknown function in the slits. k runs from 0 to the larger of `modes` and
        `min_slack_modes`.
        """
        return np.concatenate(
            [slit.slack_matrix(max(self.modes, OPTIONS.min_slack_modes)) for slit in self.slits],
            axis=1,
        )

    @cached_property
    def slack_of_kinks(self) -> Array:
        """Sine coefficients s_k of psi, the part of the slack that jumps inside slits cause.
        The slack is the unknown function in the slits; k: order of the sine on the wide zone.
        """
        count = max(self.modes, OPTIONS.min_slack_modes)
        return np.sum(
            [np.zeros(count + 1), *(kink.slack_coefficients(count) for _, kink in self.kinks)],
            axis=0,
        )

    @property
    def mean_of_kinks(self) -> float:
        """Mean over the wide zone of the integral of psi, the known part of the slack.
        Jumps of the right side inside the slits cause psi, see `SlitKink.slope`.
        """
        return self.w * sum(kink.mean_opening for _, kink in self.kinks)

    @cached_property
    def mean_row(self) -> Array:
        """Row vector r for which r @ d is the mean of the slits' openings over the wide zone.
        The opening is the integral of the slack, the unknown function in the slits. d: the series
        of all slits, one after the other; see `Slit.mean_row`.
        """
        return np.concatenate([slit.mean_row for slit in self.slits])
