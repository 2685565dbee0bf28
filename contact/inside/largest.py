r"""The largest equivalent stress in the body of a solution, and its place.

The search covers all depths, from the finest detail of the pressure to the widest zone. Without
friction, a pressure between 0 and P causes a shear stress of at most P/pi in the plane, and a mean
stress of at most P. For a point at the depth y, let P1 be the highest pressure within the distance
k y along x. Pressures farther away are seen from the point under an angle of 2 arccot(k) only. So

    shear <= P1/pi + (P - P1) 2 arccot(k)/pi,     mean <= P1 + (P - P1) 2 arccot(k)/pi.

Points at which these bounds are below a stress that has already been found are left out.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from contact.errors import SceneError
from contact.formulation.protocol import Fields
from contact.formulation.tolerances import TOLERANCES
from contact.inside.stress import LATERAL, Stress
from contact.model.scene import Scene
from sie import Array


@dataclass(frozen=True)
class LargestOptions:
    """Options of the search for the largest stress in the body."""

    # Ratio of successive depths of the scan. From one depth to the next, a stress changes by some
    # per cent. After the scan, the search therefore refines the places of the largest stress.
    depth_ratio: float = 1.3
    places_per_depth: float = 2.0  # places scanned in a length equal to the depth
    # Number of samples of the pressure in the smallest length over which the profile varies.
    samples_per_length: float = 4.0
    zone_samples: int = 24  # least number of samples of the pressure on a zone
    # Least depth of the scan, divided by the length over which the pressure varies. Below a smooth
    # peak of the pressure, the largest stress is at 0.3 to 0.8 of the peak's half width.
    first_depth: float = 0.1
    reach: float = 8.0  # k in the bounds of the stresses (head of this module)
    bound_margin: float = 1.1  # factor on the bounds, for peaks of the pressure between its samples
    refined: int = 48  # largest number of places that are refined
    near_best: float = 0.8  # least stress of a refined place, in units of the largest
    # Largest number of refinements, and of loads tried for first yield; fewer are usual.
    max_steps: int = 80


OPTIONS = LargestOptions()

# Step [rad] of the angles at which stresses beside a corner are compared. Near its maximum a stress
# varies like the square of the angle, so that the step's square bounds the relative error.
CORNER_STEP = 1e-4


class Body(Protocol):
    """The members of a solution that the search for first yield uses."""

    @property
    def scene(self) -> Scene: ...
    @property
    def zones(self) -> Array: ...
    @property
    def fields(self) -> Fields: ...
    @property
    def load(self) -> float: ...
    @property
    def error(self) -> float: ...
    @property
    def max_pressure(self) -> float: ...
    def pressure(self, x: ArrayLike) -> Array: ...
    def stress(self, x: ArrayLike, y: ArrayLike, lateral: str, nu: float | None) -> Stress: ...


@dataclass(frozen=True)
class Criterion:
    """A yield criterion, which gives the equivalent stress.
    The body yields where this stress reaches the strength.

    name: "mises", "tresca", or "shear", the largest shear stress in the plane.
    """

    name: str
    nu: float
    lateral: str

    def of(self, stress: Stress) -> Array:
        if self.name == "shear":
            return stress.shear
        return stress.mises(self.nu) if self.name == "mises" else stress.tresca(self.nu)

    def branch(self, stress: Stress) -> int:
        """Index of the planes of largest shear: 0 for planes parallel to the z axis, 1 for others.
        It is always 0 unless the criterion is Tresca's.
        """
        return int(self.name == "tresca" and float(self.of(stress)) > float(stress.shear))

    def of_branch(self, stress: Stress, branch: int) -> Array:
        """The equivalent stress for shear on one set of planes (`branch`).
        It is a smooth function of the stress. For "mises" the branch does not matter.
        """
        if self.name == "mises":
            return stress.mises(self.nu)
        mean = 0.5 * np.abs(stress.xx + stress.yy)
        return 0.5 * ((1 - 2 * self.nu) * mean + stress.shear) if branch else stress.shear

    def slopes(self, stress: Stress, branch: int) -> Array:
        """Derivatives (3,) of the equivalent stress with respect to the stresses xx, yy and xy.
        The stresses are those at one point; for `branch` see `of_branch`.
        """
        one, both = np.array([0.5, -0.5, 0.0]), np.array([0.5, 0.5, 0.0])
        away, mean = 0.5 * (stress.xx - stress.yy), 0.5 * (stress.xx + stress.yy)
        plane, skew = float(stress.shear), 1 - 2 * self.nu
        of_plane = away * one + stress.xy * np.array([0.0, 0.0, 1.0])  # of shear^2 / 2
        if self.name == "mises":
            whole = 3 * of_plane + skew**2 * mean * both
            return np.asarray(whole / (float(stress.mises(self.nu)) or 1.0))
        of_shear = of_plane / (plane or 1.0)
        return 0.5 * (skew * np.sign(mean) * both + of_shear) if branch else of_shear

    @property
    def at_corner(self) -> float:
        """Largest equivalent stress beside a step of the pressure from 1 to 0.

        The stresses are those of a uniform pressure on one half of the surface. They depend only on
        `angle`, measured at the step from the free half of the surface.
        """
        angle = np.arange(0.0, np.pi, CORNER_STEP)
        plane, turned = angle / np.pi, np.sin(2 * angle) / (2 * np.pi)
        shear, none = np.sin(angle) ** 2 / np.pi, np.zeros(len(angle))
        return float(self.of(Stress(-plane - turned, -plane + turned, shear, none)).max())

    def at(self, body: Body, x: Array, y: Array) -> Array:
        """The equivalent stress at points; 0 where it is not known or infinite."""
        return np.nan_to_num(self.of(body.stress(x, y, self.lateral, self.nu)), posinf=0.0)

    def bound(self, highest: Array, anywhere: float, deep: float) -> Array:
        """Upper bound of the equivalent stress at points in the body.
        It follows from the largest pressure near each point and the largest pressure overall.

        The bound holds for surfaces without friction. highest: largest pressure near each point;
        anywhere: largest pressure of all; deep: pressure far below the surface.
        """
        angle = 2 * np.arctan(1 / OPTIONS.reach) / np.pi
        beyond = angle * np.maximum(anywhere - highest, 0.0)
        shear = highest / np.pi + beyond + 0.5 * deep
        mean = highest + beyond + 0.5 * deep
        if self.name == "shear":
            return shear
        if self.name == "mises":
            return np.hypot(np.sqrt(3) * shear, (1 - 2 * self.nu) * mean)
        return np.asarray(np.maximum(shear, 0.5 * (shear + (1 - 2 * self.nu) * mean)))


@dataclass(frozen=True)
class Peak:
    """The largest equivalent stress [Pa] in a body, its error, and its place [m]."""

    stress: float
    error: float
    x: float
    y: float


def largest(body: Body, criterion: Criterion) -> Peak:
    """The largest equivalent stress in the body."""
    return max(peaks(body, criterion), key=lambda one: one.stress)


def peaks(body: Body, criterion: Criterion) -> list[Peak]:
    """Places in the body with the largest equivalent stresses; some may be the same place."""
    samples = _Samples.of(body)
    if samples.highest == 0.0 and body.fields.deep_pressure == 0.0:
        return [Peak(0.0, 0.0, 0.0, 0.0)]
    on_surface = criterion.at(body, samples.x, np.zeros(len(samples.x)))
    places = [(samples.x, np.zeros(len(samples.x)), on_surface, samples.scale)]
    best = float(on_surface.max(initial=0.0))
    deep = abs(body.fields.deep_pressure) if criterion.lateral != LATERAL[0] else 0.0
    for depth in samples.depths():
        x = samples.at_depth(depth)
        if not body.fields.problem.law.shear_ratio:
            highest = samples.near(x, OPTIONS.reach * depth)
            bound = criterion.bound(highest, samples.highest, deep)
            x = x[OPTIONS.bound_margin * bound >= best]
        if len(x):
            y = np.full(len(x), depth)
            value = criterion.at(body, x, y)
            best = max(best, float(value.max()))
            places.append((x, y, value, y))
    x, y, value, size = (np.concatenate(part) for part in zip(*places, strict=True))
    x, y, size = _separated(x, y, value, size)
    return _refined(body, criterion, x, y, size) + _at_corners(body, criterion)


def _at_corners(body: Body, criterion: Criterion) -> list[Peak]:
    """The largest stresses beside sharp corners in contact, if the law limits the pressure.

    The interval at a corner in which the pressure is at its limit may be far narrower than the
    smallest depth of the scan.
    """
    limits, support = body.scene.law.pressure_range, body.scene.profile.support
    if support is None or not limits.has_limit:
        return []
    stress = limits.highest * criterion.at_corner
    least = limits.highest * (1 - TOLERANCES.rounding)
    at = [x for x in support if body.pressure(np.array([x]))[0] >= least]
    return [Peak(stress, CORNER_STEP**2 * stress, x, 0.0) for x in at]


@dataclass(frozen=True)
class _Samples:
    """Samples of the contact pressure at ascending positions x on the surface.

    x: places [m]; pressure: absolute values [Pa]; scale: the length over which the pressure varies
    there [m]; period: [m] or None; span: the widest zone [m], or the period. table: entry k has the
    largest pressure among each 2^k successive samples. In periodic contact, the samples in `table`
    are repeated by one period on both sides.
    """

    x: Array
    pressure: Array
    scale: Array
    period: float | None
    span: float
    table: list[Array]

    @classmethod
    def of(cls, body: Body) -> "_Samples":
        scene, zones = body.scene, body.zones
        period, detail = scene.period, scene.profile.resolution or np.inf
        if len(zones) == 0:
            if period is None:
                raise SceneError("the surfaces do not touch, so they do not yield", "load")
            zones = scene.profile.x0 + np.array([[0.0, period]])
            detail = min(detail, period / 16)
        parts, scales = [], []
        for a, b in zones:
            half = 0.5 * (b - a)
            count = max(OPTIONS.zone_samples, int(OPTIONS.samples_per_length * 2 * half / detail))
            angle = np.pi * (np.arange(count) + 0.5) / count
            even = a + 2 * half * (np.arange(count) + 0.5) / count
            parts.append(np.concatenate((0.5 * (a + b) - half * np.cos(angle), even)))
            scales.append(np.full(2 * count, min(half, detail)))
            # With friction, the largest stress may be a tension at the end of a zone, so the ends
            # are also sampled.
            parts.append(np.array([a, b]))
            scales.append(np.full(2, half))
        # The pressure has a cusp at the tip of a power-law profile, so tips are also sampled.
        tips = np.asarray(scene.profile.algebraic_points, dtype=float)[:, 0]
        parts.append(tips)
        scales.append(np.full(len(tips), min(detail, float(np.diff(zones, axis=1).min()))))
        gaps = zones[1:, 0] - zones[:-1, 1]
        parts.append(0.5 * (zones[1:, 0] + zones[:-1, 1]))
        scales.append(gaps)
        x, scale = np.concatenate(parts), np.concatenate(scales)
        order = np.argsort(x)
        x, scale = x[order], scale[order]
        pressure = np.abs(body.pressure(x))
        pressure = np.where(np.isfinite(pressure), pressure, 0.0)
        span = float(np.diff(zones, axis=1).max())
        whole = pressure
        if period is not None:
            whole = np.tile(pressure, 3)
        table = [whole]
        while 2 ** len(table) <= len(whole):
            step, last = 2 ** (len(table) - 1), table[-1]
            table.append(np.maximum(last[:-step], last[step:]))
        return cls(x, pressure, scale, period, span, table)

    @property
    def highest(self) -> float:
        return float(self.pressure.max(initial=0.0))

    def depths(self) -> Array:
        """Depths [m] to scan, from the widest zone down to a part of the shortest length.
        They run from `span` to `first_depth` times the smallest `scale`.
        """
        least = OPTIONS.first_depth * float(self.scale.min())
        count = int(np.ceil(np.log(self.span / least) / np.log(OPTIONS.depth_ratio)))
        return self.span / OPTIONS.depth_ratio ** np.arange(count + 1.0)

    def at_depth(self, depth: float) -> Array:
        """The sample positions x below which stresses are computed at this depth.
        There is at most one position in each cell of the width depth / `places_per_depth`.

        A sample is left out at depths below `first_depth` times its `scale`.
        """
        x = self.x[OPTIONS.first_depth * self.scale <= depth]
        cell = np.floor(x * (OPTIONS.places_per_depth / depth))
        return x[np.diff(cell, prepend=-np.inf) > 0]

    def near(self, x: Array, reach: float) -> Array:
        """The largest pressure within the distance `reach` of each position x on the surface."""
        at = self.x
        if self.period is not None:
            if 2 * reach >= self.period:
                return np.full(len(x), self.highest)
            at = np.concatenate((at - self.period, at, at + self.period))
        first = np.searchsorted(at, x - reach)
        count = np.maximum(np.searchsorted(at, x + reach, side="right") - first, 1)
        level = np.floor(np.log2(count)).astype(np.intp)
        out = np.zeros(len(x))
        for k in np.unique(level).tolist():
            here = np.flatnonzero(level == k)
            one, size = self.table[k], 2**k
            start = np.minimum(first[here], len(one) - 1)
            end = np.clip(first[here] + count[here] - size, 0, len(one) - 1)
            out[here] = np.maximum(one[start], one[end])
        return out


def _separated(x: Array, y: Array, value: Array, size: Array) -> tuple[Array, Array, Array]:
    """(x, y, size) of places with a large stress, without those close to a larger stress.
    `size` is the length below which places count as close.
    """
    order = np.argsort(-value)
    order = order[value[order] >= OPTIONS.near_best * value[order[0]]]
    kept: list[int] = []
    while len(order) and len(kept) < OPTIONS.refined:
        best = order[0]
        kept.append(int(best))
        close = (np.abs(x[order] - x[best]) < size[best]) & (
            np.abs(y[order] - y[best]) < size[best]
        )
        close[0] = True
        order = order[~close]
    return x[kept], y[kept], size[kept]


def _refined(body: Body, criterion: Criterion, x: Array, y: Array, size: Array) -> list[Peak]:
    """The largest stresses near given places, by a search with decreasing steps.

    A paraboloid, fitted to the values around each place, proposes the next place. If a place moves
    by less than half a step, its step is halved.
    """
    dx, dy = (part.ravel() for part in np.meshgrid([-1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]))
    step = 0.25 * size
    smallest = 1e-4 * size
    for _ in range(OPTIONS.max_steps):
        around_x = x + step * dx[:, None]
        around_y = np.maximum(y + step * dy[:, None], 0.0)
        value = criterion.at(body, around_x, around_y)
        move_x, move_y = _vertex(value, dx, dy)
        there_x, there_y = x + step * move_x, np.maximum(y + step * move_y, 0.0)
        there = criterion.at(body, there_x, there_y)
        best = np.argmax(value, axis=0)
        of_grid = np.take_along_axis(value, best[None], axis=0)[0]
        by_vertex = there >= of_grid
        new_x = np.where(by_vertex, there_x, x + step * dx[best])
        new_y = np.where(by_vertex, there_y, np.maximum(y + step * dy[best], 0.0))
        moved = np.maximum(np.abs(new_x - x), np.abs(new_y - y))
        x, y = new_x, new_y
        step = np.maximum(np.where(moved < 0.5 * step, 0.5 * step, step), smallest)
        if np.all((step <= smallest) & (moved < smallest)):
            break
    found = body.stress(x, y, criterion.lateral, criterion.nu)
    numbers = np.array([criterion.of(found), 2.0 * found.error, x, y])
    return [Peak(*column) for column in numbers.T.tolist()]


def _vertex(value: Array, dx: Array, dy: Array) -> tuple[Array, Array]:
    """(move_x, move_y) to the top of a paraboloid fitted to 3 x 3 values, in grid spacings.
    Each move is at most 1.
    """
    columns = np.column_stack((np.ones(9), dx, dy, 0.5 * dx * dx, dx * dy, 0.5 * dy * dy))
    _, gx, gy, xx, xy, yy = np.linalg.pinv(columns) @ value
    determinant = xx * yy - xy * xy
    peaked = (xx < 0) & (determinant > 0)
    safe = np.where(peaked, determinant, 1.0)
    move_x = np.where(peaked, (xy * gy - yy * gx) / safe, np.sign(gx))
    move_y = np.where(peaked, (xy * gx - xx * gy) / safe, np.sign(gy))
    return np.clip(move_x, -1.0, 1.0), np.clip(move_y, -1.0, 1.0)
