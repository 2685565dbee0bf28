"""Check of the form of a user's profile, once, when a scene is made.

A wrong shape of an array is reported here. Otherwise numpy would raise an error in the middle of a
solution. `contact.testing.check_profile` checks whether the values agree with each other.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np

from contact.errors import SceneError, shown
from contact.model.checks import as_array, of_author, positive_or_none
from contact.model.profiles.base import Profile
from contact.model.profiles.derive import DETAIL
from contact.model.profiles.noise import ROUND_OFF
from sie import Array

# Names of the columns of each array that a profile declares. Each row describes one place.
_COLUMNS = {
    "kinks": ("position", "jump of the slope"),
    "jumps": ("position", "order", "jump of that derivative"),
    "algebraic_points": (
        "position",
        "exponent",
        "the coefficients of the power of the distance on the left",
        "on the right",
    ),
}


def require_declared(profile: Profile) -> None:
    """Raise a SceneError that names the first attribute or method of the profile that has a
    wrong form.
    """
    require_declarations(profile)
    x = _places(profile)
    _require_by_elements(profile, "height", x)
    _require_heights(profile, x)
    _require_by_elements(profile, "slope", x)
    _require_tables(profile)


def _require_tables(profile: Profile) -> None:
    """Raise SceneError if an author's method `tables` returns something that a scene file cannot
    hold.
    """
    if type(profile).tables is Profile.tables:
        return
    with of_author("profile.tables()", "profile"):
        tables: Any = profile.tables()
    tabled = isinstance(tables, Mapping) and all(isinstance(t, Mapping) for t in tables.values())
    if not (tabled and "shape" in tables.get("profile", {})):
        allowed = 'a dictionary of tables, such as {"profile": {"shape": "cosh", "scale": 1.0}}'
        raise SceneError.of("profile.tables()", tables, allowed)


def _require_heights(profile: Profile, x: Array) -> None:
    """Raise SceneError if heights are not numbers, or are so large that their squares overflow.

    x: positions of the heights if the profile has no ends.
    """
    ends = profile.known or profile.support
    x = np.linspace(*ends, DETAIL.samples + 1) if ends is not None else x
    with of_author("profile.height(x)", "height"):
        heights = np.asarray(profile.height(x.copy()), dtype=np.float64)
    # A profile whose `ends` are None is infinitely long. Its heights far from 0 are checked later,
    # where the contact is searched for.
    if ends is not None:
        require_numbers(x, heights)
    central = heights if ends is not None else heights[np.abs(x) <= np.median(np.abs(x))]
    with np.errstate(over="ignore"):
        finite = central[np.isfinite(central)]
        size = float(np.ptp(finite)) if finite.size else 0.0
    largest = float(np.cbrt(np.finfo(np.float64).max))
    if not size < largest:
        reason = (
            f"profile.height(x) varies by {size:.3g} m around x = {np.median(x):.3g} m, but "
            f"heights above {largest:.0e} m exceed the range of floating-point numbers in the "
            "computation: check that heights and x are in metres"
        )
        raise SceneError(reason, "height", size)


def require_numbers(x: Array, heights: Array) -> None:
    """Raise a SceneError that names the first place at which a height is NaN or -inf."""
    lost = np.isnan(heights) | np.isneginf(heights)
    if lost.any():
        x, heights = x[lost], heights[lost]
        k = int(np.argmin(x))
        reason = (
            f"profile.height(x) is {heights.ravel()[k]} at x = {x.ravel()[k]:.9g} m: "
            "it must be a number, or +inf where there is no body"
        )
        raise SceneError(reason, "height", float(heights.ravel()[k]))


def require_declarations(profile: Profile) -> None:
    """Raise a SceneError that names the first attribute of the profile that has a wrong form."""
    positive_or_none("profile.period", _read(profile, "period"))
    for name in ("support", "extent"):
        ends = _read(profile, name)
        if ends is not None and not (
            _is_real(ends, 1) and np.shape(ends) == (2,) and ends[0] < ends[1]
        ):
            raise SceneError.of(
                f"profile.{name}", ends, "None, or a left and a larger right end [m]"
            )
    positive_or_none("profile.resolution", _read(profile, "resolution"))
    for name, columns in _COLUMNS.items():
        table, count = _read(profile, name), len(columns)
        if not (isinstance(table, np.ndarray) and _is_real(table, 2) and table.shape[1] == count):
            meaning = f"{', '.join(columns[:-1])} and {columns[-1]}"
            allowed = (
                f"a numpy array whose rows are {count} finite numbers: {meaning} (a property, not "
                "a method)"
            )
            raise SceneError.of(f"profile.{name}", table, allowed)
    low = profile.algebraic_points[profile.algebraic_points[:, 1] <= 1.0]
    if len(low):
        allowed = (
            "rows whose exponent is above 1 (the exponent 1 is a kink: declare it in kinks; below "
            "1 the profile is infinitely steep)"
        )
        raise SceneError.of("profile.algebraic_points", low[0].tolist(), allowed)
    tips = _read(profile, "summits")
    if tips is not None and not (_is_real(tips, 1) and np.size(tips)):
        raise SceneError.of(
            "profile.summits", tips, "None, or a one-dimensional array of positions [m]"
        )
    if not isinstance(symmetric := _read(profile, "symmetric"), (bool, np.bool_)):
        raise SceneError.of(
            "profile.symmetric", symmetric, "True or False (a property, not a method)"
        )


def _read(profile: Profile, name: str) -> Any:
    with of_author(f"profile.{name}", f"profile.{name}"):
        value = getattr(profile, name)
    return value


def _is_real(value: Any, axes: int) -> bool:
    array = as_array(value)
    return array.dtype.kind in "iuf" and array.ndim == axes and bool(np.isfinite(array).all())


def _places(profile: Profile) -> Array:
    """Six places, as an array (2, 3), at which a profile's methods are tried.
    The profile should have heights there.
    """
    ends = profile.known if profile.period is not None else profile.support or profile.extent
    spread = np.random.default_rng(0).uniform(-0.5, 0.5, (2, 3))
    if ends is not None:
        return np.asarray(0.5 * (ends[0] + ends[1]) + (ends[1] - ends[0]) * spread)
    # The size of the shape is unknown. Therefore the three columns have places at very different
    # distances from 0, in the ratios 1, 1e-4 and 1e-8.
    return np.asarray((profile.resolution or 1.0) * spread * ROUND_OFF ** (np.arange(3) / 3))


def _require_by_elements(profile: Profile, name: str, x: Array) -> None:
    for given in (x, x.ravel()):
        hint = "; it must work on arrays, element by element (numpy's functions, not math's)"
        with (
            of_author(f"profile.{name}(x)", name, f" for an array of shape {given.shape}", hint),
            warnings.catch_warnings(),
        ):
            warnings.simplefilter("ignore")
            value = np.asarray(getattr(profile, name)(given.copy()))
        if value.dtype.kind not in "iuf" or value.shape != given.shape:
            got = (
                f"for x of shape {given.shape} gives {shown(value)}, of type {value.dtype} and "
                f"shape {value.shape}"
            )
            raise SceneError(
                f"profile.{name}(x) {got}: it must be real and of the shape of x", name, value
            )
        if not (np.isfinite(value) | (np.isposinf(value) & (name == "height"))).any():
            raise SceneError(
                f"profile.{name}(x) is not finite at any of the places x = {x.ravel().tolist()}",
                name,
                value,
            )
