"""The stresses of a solution at points of its body, with a bound of their errors.

The stresses at a point are integrals of the pressure times kernels. The integral of a kernel's
absolute value is at most 1. So an error of the pressure at equal normalised positions causes no
larger error of the stresses. An error of a zone's end also shifts the pressure next to the end.
There the pressure grows like the square root of the distance from the end, so the stresses close to
the end change most.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from contact.errors import SceneError
from contact.formulation.protocol import Fields
from contact.inside.stress import Stress, Transform, stress_from, tension_along
from contact.model.checks import real
from contact.model.operator import Operator
from sie import Array, nearest_image


@dataclass(frozen=True)
class FieldErrorOptions:
    """Factors in the bound of the errors of the stresses."""

    # The kernels of s_xx and s_yy do not change sign, and their integrals are 1 in absolute value.
    # The factor 2 also bounds the effect of errors of a zone's two ends, where the pressure grows
    # like the square root of the distance.
    of_pressure: float = 2.0
    # The absolute values of the shear's kernels have infinite integrals. So an error of the shear
    # that varies over short distances causes a larger error of the stresses.
    of_shear: float = 8.0
    # Round-off of the pressure's transform F and of y F', in units of the last digit.
    rounding_margin: float = 64.0


OPTIONS = FieldErrorOptions()


def body_points(x: ArrayLike, y: ArrayLike) -> tuple[Array, Array]:
    """Points (x, y) [m] as arrays of one shape; SceneError names a depth y < 0."""
    x, y = real("x", x), real("y", y)
    if np.any(y < 0):
        raise SceneError.of("y", float(y[y < 0].ravel()[0]), "at least 0, since y is the depth")
    try:
        x, y = np.broadcast_arrays(x, y)
    except ValueError:
        raise SceneError(
            f"x and y must have shapes that broadcast together, not {x.shape} and {y.shape}", "y"
        ) from None
    return x, y


def needs_half_plane(operator: Operator) -> None:
    """Raise SceneError unless the body is a half-plane, whose inside is known."""
    if operator.is_own or operator.own_columns:
        raise SceneError(
            "stresses in the body are not available with your own interaction, which describes the "
            "surface only: use contact.Isolated() or contact.Periodic()",
            "interaction",
        )
    if not operator.is_plain:
        raise SceneError(
            f"stresses in the body are not available for the substrate {operator.substrate.name}, "
            "whose symbol describes the surface only: use contact.HalfPlane()",
            "substrate",
        )


def stress_of(
    fields: Fields, x: Array, y: Array, error: float, lateral: str, nu: float | None
) -> Stress:
    """Stresses in the body at points (x, y) [m]; in full sliding also those due to the shear.
    The arrays x and y have the same shape.

    error: relative error of the pressure at equal normalised positions, and of ends.
    """
    found, normal = exact_stress(fields, x, y, lateral, nu)
    with np.errstate(divide="ignore", invalid="ignore"):
        bound = error_at(fields, x, y, normal, error)
    ratio = fields.problem.law.shear_ratio
    return replace(found, error=bound * (1 + OPTIONS.of_shear * abs(ratio)))


# On the surface, at the ends of zones, the transforms are infinite or nan.
@np.errstate(divide="ignore", invalid="ignore")
def exact_stress(
    fields: Fields, x: Array, y: Array, lateral: str, nu: float | None
) -> tuple[Stress, Transform]:
    """(stresses without their error bound, transform of the pressure) at points (x, y) [m]."""
    needs_half_plane(fields.problem.operator)
    along = tension_along(lateral, fields.deep_pressure, nu)
    normal = fields.pressure_transform(x, y)
    unknown = np.isnan(normal[0]) & (y == 0)
    if unknown.any():
        # At the tip of a power law the transform is NaN. On the surface, Im F = -p replaces it.
        normal[0][unknown] = -1j * fields.pressure(x[unknown])
    ratio = fields.problem.law.shear_ratio
    tangential = (ratio * normal[0], ratio * normal[1]) if ratio else None
    return stress_from(y, normal, tangential).with_tension(along), normal


def error_at(fields: Fields, x: Array, y: Array, normal: Transform, error: float) -> Array:
    """Bound of the errors of stresses [Pa] computed from the pressure's transform `normal`."""
    local = np.abs(normal[0]) + np.where(y == 0, 0.0, y * np.abs(normal[1]))
    size = unit_pressure(fields)
    eps = np.finfo(float).eps
    rounding = OPTIONS.rounding_margin * eps
    steep = _near_ends(fields, x, y, error)
    # Close to the tip of a kink, the round-off of the place x changes the stresses.
    widest = float(np.diff(fields.zone_table, axis=1).max(initial=0.0))
    places = eps * (np.abs(x) + (widest or fields.problem.units.length))
    shifted = np.where(np.isfinite(normal[1]), places * np.abs(normal[1]), 0.0)
    return np.asarray(
        error * OPTIONS.of_pressure * size * (1 + np.sqrt(steep))
        + error * local * (OPTIONS.of_pressure + (steep if _singular(fields) else 0.0))
        + rounding * (local + size)
        + OPTIONS.of_pressure * shifted
    )


def unit_pressure(fields: Fields) -> float:
    """Unit of relative errors of the pressure [Pa]: the peak; if this is infinite, the mean."""
    if np.isfinite(fields.max_pressure):
        return max(fields.max_pressure, abs(fields.deep_pressure))
    table = fields.zone_table
    width = float(np.diff(table, axis=1).sum()) or fields.problem.profile.period or 1.0
    return abs(fields.load) / width


def _singular(fields: Fields) -> bool:
    """Whether the pressure is infinite at the free ends of zones."""
    return bool(fields.problem.end.intensity)


def _near_ends(fields: Fields, x: Array, y: Array, error: float) -> Array:
    """Largest ratio, over all zone ends, of the zone's width to a point's distance from the end.

    Two ends on each side of the point are compared. The error of the end is added to the distance.
    """
    table = fields.zone_table
    out = np.zeros(x.shape)
    if len(table) == 0:
        return out
    period = fields.problem.profile.period if fields.problem.interaction.needs_period else None
    table = table[np.argsort(table[:, 0])]
    width = np.repeat(table[:, 1] - table[:, 0], 2)
    ends = table.ravel()
    if period is not None:
        x = nearest_image(x, 0.5 * (ends[0] + ends[-1]), period)
        ends = np.concatenate((ends - period, ends, ends + period))
        width = np.tile(width, 3)
    after = np.searchsorted(ends, x)
    for step in (-2, -1, 0, 1):
        i = np.clip(after + step, 0, len(ends) - 1)
        away = np.hypot(x - ends[i], y)
        out = np.maximum(out, width[i] / (away + error * width[i]))
    return out
